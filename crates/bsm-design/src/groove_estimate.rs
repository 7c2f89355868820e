//! Estimate of the groove of a screw from one row of a catalog: nominal diameter, lead and load
//! ratings.
//!
//! Ratings by ISO 3408-5 follow from the groove. This module inverts the formulas: it enumerates
//! the balls, turns and ball returns that manufacturers use, and weights each combination by its
//! [`prior`] and by how well its ratings fit the catalog row.
//!
//! Theory: `docs/theory/21-groove-from-ratings.md`, equations (AB1) to (AB13).

mod prior;

use std::f64::consts::{FRAC_PI_4, SQRT_2};
use std::sync::LazyLock;

use bsm_dyn::Material;
use rayon::prelude::*;

use self::prior::{RatingFit, unprinted};
use crate::Nut;
use crate::nut::turn_length;
use crate::statistics::{ln_sum, normal_quantile, quantile};

pub use self::prior::{BallReturn, KnownGroove, Prior};

/// Logarithm of the evidence below which a catalog row is unusual.
pub const UNUSUAL_EVIDENCE: f64 = -4.0;

/// Logarithm of the evidence below which a catalog row is rejected.
pub const MIN_EVIDENCE: f64 = -7.0;

/// Logarithm of the evidence above which another [`Reading`] of a rejected row is suggested.
const READING_EVIDENCE: f64 = -3.0;

/// Excess of the dynamic rating above which it counts as raised for clean steel.
const CLEAN_STEEL_EXCESS: f64 = 0.15;

/// Probability of the balls in [`GrooveEstimate::likely_balls`].
const SET_PROBABILITY: f64 = 0.9;

/// Conformity of nut and screw in the ratings and in the best groove.
const CONFORMITY: f64 = 0.52;

/// Contact angle \[rad\] in the ratings and in the best groove.
const CONTACT_ANGLE: f64 = FRAC_PI_4;

/// Steel of trial nuts. Load ratings do not depend on the steel.
const STEEL: Material = Material { youngs_modulus: 206e9, poisson_ratio: 0.3 };

/// Millimeters per meter: the prior is in mm.
const PER_M: f64 = 1e3;

/// One row of a catalog: everything that is known about a screw and its nut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CatalogLine {
    /// Nominal diameter \[m\], positive.
    pub nominal_diameter: f64,
    /// Lead \[m\], positive.
    pub lead: f64,
    /// Dynamic axial load rating \[N\], positive.
    pub dynamic_rating: f64,
    /// Static axial load rating \[N\], positive.
    pub static_rating: Option<f64>,
    /// Ball diameter \[m\], positive.
    pub ball_diameter: Option<f64>,
    /// Pitch circle diameter \[m\], positive.
    pub pitch_diameter: Option<f64>,
    /// Core diameter of the screw \[m\], positive.
    pub core: Option<f64>,
    /// Loaded turns of all circuits together, positive.
    pub turns: Option<f64>,
    /// Conformities of nut and screw, above 1/2.
    pub conformity: (Option<f64>, Option<f64>),
    /// Contact angle \[rad\], in (0, π/2).
    pub contact_angle: Option<f64>,
}

/// One combination of ball, loaded turns and ball return.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hypothesis {
    /// Ball diameter \[m\].
    pub ball_diameter: f64,
    /// Loaded turns.
    pub turns: f64,
    /// Ball return.
    pub ball_return: BallReturn,
    /// Number of loaded balls, which may be a fraction (AB2).
    pub loaded_balls: f64,
    /// Excess of the dynamic over the static rating (AB1), `None` without a static rating.
    pub excess: Option<f64>,
    /// Probability among all hypotheses.
    pub probability: f64,
}

/// A ball diameter with its probability.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BallProbability {
    /// Ball diameter \[m\].
    pub ball_diameter: f64,
    /// Sum of the probabilities of its hypotheses.
    pub probability: f64,
}

/// A complete groove with its loaded balls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EstimatedGroove {
    /// Ball diameter \[m\].
    pub ball_diameter: f64,
    /// Pitch circle diameter \[m\].
    pub pitch_diameter: f64,
    /// Conformities of nut and screw.
    pub conformity: (f64, f64),
    /// Contact angle \[rad\].
    pub contact_angle: f64,
    /// Loaded turns.
    pub turns: f64,
    /// Number of loaded balls, a whole number.
    pub loaded_balls: f64,
}

impl EstimatedGroove {
    /// Returns the nut with this groove, one start and elastic constants of raceways and balls.
    pub fn nut(&self, lead: f64, material: (Material, Material)) -> Nut {
        Nut {
            ball_diameter: self.ball_diameter,
            pitch_diameter: self.pitch_diameter,
            lead,
            contact_angle: self.contact_angle,
            conformity: self.conformity,
            material,
            balls_per_turn: self.loaded_balls / self.turns,
            turns: self.turns,
            starts: 1.0,
        }
    }
}

/// Groove of a catalog row with its uncertainty.
#[derive(Debug, Clone, PartialEq)]
pub struct GrooveEstimate {
    /// The catalog row.
    pub line: CatalogLine,
    /// Logarithm of the evidence, the probability density of such a row under the prior.
    pub ln_evidence: f64,
    /// All hypotheses, sorted by ball and number of loaded balls.
    pub hypotheses: Vec<Hypothesis>,
    /// All balls, beginning with the most likely ball.
    pub balls: Vec<BallProbability>,
}

/// A mistake in a catalog row that explains why the row is rejected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reading {
    /// The ratings are in kgf.
    RatingsInKilogramForce,
    /// The ratings are in lbf.
    RatingsInPoundForce,
    /// The ratings are exchanged.
    RatingsSwapped,
    /// The static rating is 10 times the printed value.
    StaticRatingTimesTen,
    /// The static rating is a tenth of the printed value.
    StaticRatingOverTen,
    /// The lead is 10 times the printed value.
    LeadTimesTen,
    /// The lead is a tenth of the printed value.
    LeadOverTen,
}

/// A catalog row whose ratings are not explained by any groove of the prior.
#[derive(Debug, Clone, PartialEq)]
pub struct RefusedLine {
    /// The nearest groove, `None` if no ball fits nominal diameter and lead.
    pub nearest: Option<Box<GrooveEstimate>>,
    /// Readings of the row that a groove explains, with the logarithm of their evidence, beginning
    /// with the most likely reading.
    pub readings: Vec<(Reading, f64)>,
}

impl Reading {
    const ALL: [Self; 7] = [
        Self::RatingsInKilogramForce,
        Self::RatingsInPoundForce,
        Self::RatingsSwapped,
        Self::StaticRatingTimesTen,
        Self::StaticRatingOverTen,
        Self::LeadTimesTen,
        Self::LeadOverTen,
    ];

    /// Returns the row in this reading, or `None` if the reading concerns a static rating that the
    /// row does not have.
    fn of(self, line: &CatalogLine) -> Option<CatalogLine> {
        let ratings = |factor: f64| CatalogLine {
            dynamic_rating: factor * line.dynamic_rating,
            static_rating: line.static_rating.map(|rating| factor * rating),
            ..*line
        };
        let with_static = |factor: f64| {
            let rating = factor * line.static_rating?;
            Some(CatalogLine { static_rating: Some(rating), ..*line })
        };
        let with_lead = |factor: f64| CatalogLine { lead: factor * line.lead, ..*line };
        Some(match self {
            Self::RatingsInKilogramForce => ratings(9.806_65),
            Self::RatingsInPoundForce => ratings(4.448_222),
            Self::RatingsSwapped => CatalogLine {
                dynamic_rating: line.static_rating?,
                static_rating: Some(line.dynamic_rating),
                ..*line
            },
            Self::StaticRatingTimesTen => with_static(10.0)?,
            Self::StaticRatingOverTen => with_static(0.1)?,
            Self::LeadTimesTen => with_lead(10.0),
            Self::LeadOverTen => with_lead(0.1),
        })
    }
}

impl CatalogLine {
    /// Estimates the groove.
    ///
    /// # Errors
    ///
    /// [`RefusedLine`] if no ball fits nominal diameter and lead, or the logarithm of the evidence is below
    /// [`MIN_EVIDENCE`].
    pub fn estimate(&self) -> Result<GrooveEstimate, RefusedLine> {
        self.estimate_with(&Prior::USUAL)
    }

    /// Does the same as [`estimate`](Self::estimate), with another prior.
    ///
    /// # Errors
    ///
    /// [`RefusedLine`] as for [`estimate`](Self::estimate).
    pub fn estimate_with(&self, prior: &Prior) -> Result<GrooveEstimate, RefusedLine> {
        match self.weighted(prior) {
            Some(estimate) if estimate.ln_evidence >= MIN_EVIDENCE => Ok(estimate),
            nearest => {
                Err(RefusedLine { nearest: nearest.map(Box::new), readings: self.readings(prior) })
            }
        }
    }

    /// Returns the readings of the row that a groove explains, beginning with the most likely
    /// reading.
    fn readings(&self, prior: &Prior) -> Vec<(Reading, f64)> {
        let evidence = |reading: Reading| {
            let estimate = reading.of(self)?.weighted(prior)?;
            Some((reading, estimate.ln_evidence))
        };
        let mut readings: Vec<_> = Reading::ALL.into_iter().filter_map(evidence).collect();
        readings.retain(|(_, ln_evidence)| *ln_evidence > READING_EVIDENCE);
        readings.sort_by(|one, other| other.1.total_cmp(&one.1));
        readings
    }

    /// Weights all hypotheses; `None` if no ball fits.
    fn weighted(&self, prior: &Prior) -> Option<GrooveEstimate> {
        let mut weighted = Vec::new();
        for (ball, ln_prior) in self.balls(prior) {
            self.add_hypotheses(prior, (ball, ln_prior), &mut weighted);
        }
        // A given ball that overlaps the screw axis has no rating.
        weighted.retain(|(_, ln_weight)| ln_weight.is_finite());
        let ln_evidence = ln_sum(weighted.iter().map(|(_, ln_weight)| *ln_weight));
        let normalized = |(hypothesis, ln_weight): (Hypothesis, f64)| Hypothesis {
            probability: (ln_weight - ln_evidence).exp(),
            ..hypothesis
        };
        let mut hypotheses: Vec<_> = weighted.into_iter().map(normalized).collect();
        hypotheses.sort_by(|one, other| {
            let by_ball = one.ball_diameter.total_cmp(&other.ball_diameter);
            by_ball.then(one.loaded_balls.total_cmp(&other.loaded_balls))
        });
        let mut balls: Vec<_> = hypotheses
            .chunk_by(|one, other| one.ball_diameter.total_cmp(&other.ball_diameter).is_eq())
            .map(|of_ball| BallProbability {
                ball_diameter: of_ball[0].ball_diameter,
                probability: of_ball.iter().map(|hypothesis| hypothesis.probability).sum(),
            })
            .collect();
        balls.sort_by(|one, other| other.probability.total_cmp(&one.probability));
        (!balls.is_empty()).then_some(GrooveEstimate {
            line: *self,
            ln_evidence,
            hypotheses,
            balls,
        })
    }

    /// Returns the balls to try \[m\], each with the logarithm of its prior.
    fn balls(&self, prior: &Prior) -> Vec<(f64, f64)> {
        let [nominal, lead] = [self.nominal_diameter, self.lead].map(|length| length * PER_M);
        let tried: Vec<_> = match self.ball_diameter {
            Some(ball) => vec![(ball * PER_M, 0.0)],
            None => prior.fitting_balls(nominal, lead).collect(),
        };
        let with_sizes = |(ball, ln_popularity): (f64, f64)| {
            let ln_core = self.core.map(|core| prior::ln_core(core * PER_M, nominal, ball));
            let ln_pitch = self
                .pitch_diameter
                .map(|pitch| prior::ln_pitch_diameter(pitch * PER_M, nominal, ball));
            let ln_given = ln_core.unwrap_or(0.0) + ln_pitch.unwrap_or(0.0);
            (ball / PER_M, ln_popularity + prior.ln_ball_size(ball, nominal, lead) + ln_given)
        };
        tried.into_iter().map(with_sizes).collect()
    }

    /// Adds the hypotheses of one ball, each with the logarithm of its weight.
    fn add_hypotheses(
        &self,
        prior: &Prior,
        (ball, ln_prior): (f64, f64),
        weighted: &mut Vec<(Hypothesis, f64)>,
    ) {
        let balls_per_turn = self.balls_of_a_full_turn(ball);
        let rated_balls = self.rated_balls(ball);
        for (turns, ball_return, ln_turns) in prior.turns_and_returns(self.turns) {
            // r_a = ln(C_a/C_a1),  r₀ = ln(C_0a/C_01)                     (AB1)
            let ratio = self.dynamic_rating
                / self.trial(ball, balls_per_turn, turns).dynamic_rating().rating;
            let full = balls_per_turn * turns;
            let ln_static = rated_balls.map(|rated| (rated / full).ln());
            let share = prior.ln_loaded_share(ball_return);
            let fit = RatingFit::new(ratio.ln(), ln_static, share);
            let hypothesis = Hypothesis {
                ball_diameter: ball,
                turns,
                ball_return,
                // N = n i e^{r₀}                                          (AB2)
                loaded_balls: rated_balls.unwrap_or_else(|| full * fit.ln_loaded_share.exp()),
                excess: fit.excess,
                probability: f64::NAN,
            };
            weighted.push((hypothesis, ln_prior + ln_turns + fit.ln_likelihood));
        }
    }

    /// Returns a trial nut with the conformity and contact angle of the ratings.
    fn trial(&self, ball: f64, balls_per_turn: f64, turns: f64) -> Nut {
        Nut {
            ball_diameter: ball,
            pitch_diameter: self.pitch_diameter_of(ball, prior::PITCH_RISE.mean),
            lead: self.lead,
            contact_angle: CONTACT_ANGLE,
            conformity: (CONFORMITY, CONFORMITY),
            material: (STEEL, STEEL),
            balls_per_turn,
            turns,
            starts: 1.0,
        }
    }

    /// Returns the number of balls of a diameter \[m\] that fill a turn.
    fn balls_of_a_full_turn(&self, ball: f64) -> f64 {
        turn_length(self.pitch_diameter_of(ball, prior::PITCH_RISE.mean), self.lead) / ball
    }

    /// Returns the number of loaded balls that have the static rating of the row; `None` without a static rating.
    fn rated_balls(&self, ball: f64) -> Option<f64> {
        let one_ball = self.trial(ball, 1.0, 1.0).static_rating().rating;
        Some(self.static_rating? / one_ball)
    }

    /// Returns the logarithm of the loaded share of a turn of a known groove, `$r_0$` of (AB1).
    fn ln_loaded_share(
        &self,
        KnownGroove { ball_diameter, turns, .. }: &KnownGroove,
    ) -> Option<f64> {
        let full = turns * self.balls_of_a_full_turn(*ball_diameter);
        Some((self.rated_balls(*ball_diameter)? / full).ln())
    }

    /// Returns the pitch circle diameter \[m\] of a ball: the given diameter, or the nominal
    /// diameter plus a part of the ball.
    fn pitch_diameter_of(&self, ball: f64, rise: f64) -> f64 {
        self.pitch_diameter.unwrap_or(self.nominal_diameter + rise * ball)
    }

    /// Completes a groove with the given quantities and with the quantities that no catalog prints.
    fn complete(
        &self,
        hypothesis: &Hypothesis,
        loaded_balls: f64,
        unprinted: &prior::Unprinted,
    ) -> EstimatedGroove {
        let (nut, screw) = self.conformity;
        EstimatedGroove {
            ball_diameter: hypothesis.ball_diameter,
            pitch_diameter: self.pitch_diameter_of(hypothesis.ball_diameter, unprinted.pitch_rise),
            conformity: (
                nut.unwrap_or(unprinted.conformity),
                screw.unwrap_or(unprinted.conformity),
            ),
            contact_angle: self.contact_angle.unwrap_or(unprinted.contact_angle),
            turns: hypothesis.turns,
            loaded_balls: loaded_balls.round().max(1.0),
        }
    }
}

impl GrooveEstimate {
    /// Returns true if the row is accepted although its ratings are unusual.
    pub fn is_unusual(&self) -> bool {
        self.ln_evidence < UNUSUAL_EVIDENCE
    }

    /// Returns the best groove: the most likely ball with its most likely turns and mean number of loaded balls.
    pub fn best(&self) -> EstimatedGroove {
        let ball = self.balls[0];
        let of_ball = |hypothesis: &&Hypothesis| {
            hypothesis.ball_diameter.total_cmp(&ball.ball_diameter).is_eq()
        };
        let hypotheses = || self.hypotheses.iter().filter(of_ball);
        let probability_of_turns = |turns: f64| {
            let same = hypotheses().filter(|other| other.turns.total_cmp(&turns).is_eq());
            same.map(|hypothesis| hypothesis.probability).sum::<f64>()
        };
        let best = hypotheses()
            .max_by(|one, other| {
                let [one, other] = [one, other].map(|of| probability_of_turns(of.turns));
                one.total_cmp(&other)
            })
            // Every ball has hypotheses.
            .unwrap_or(&self.hypotheses[0]);
        let ln_sum: f64 = hypotheses().map(|of| of.probability * of.loaded_balls.ln()).sum();
        let loaded_balls = (ln_sum / ball.probability).exp();
        self.line.complete(best, loaded_balls, &unprinted([0.0; 4]))
    }

    /// Returns the most likely balls that together have a probability of at least 90 %.
    pub fn likely_balls(&self) -> &[BallProbability] {
        let mut sum = 0.0;
        let reaches = |ball: &BallProbability| {
            sum += ball.probability;
            sum >= SET_PROBABILITY
        };
        let last = self.balls.iter().position(reaches).unwrap_or(self.balls.len() - 1);
        &self.balls[..=last]
    }

    /// Returns the number of loaded balls below which the hypotheses lie with a given probability.
    pub fn loaded_balls_quantile(&self, probability: f64) -> f64 {
        let mut hypotheses: Vec<_> = self.hypotheses.iter().collect();
        hypotheses.sort_by(|one, other| one.loaded_balls.total_cmp(&other.loaded_balls));
        let mut sum = 0.0;
        let reaches = |hypothesis: &&&Hypothesis| {
            sum += hypothesis.probability;
            sum >= probability
        };
        // Rounding may leave the sum just below one.
        let at = hypotheses.iter().find(reaches).or(hypotheses.last());
        at.map_or(f64::NAN, |hypothesis| hypothesis.loaded_balls)
    }

    /// Returns the probability that the dynamic rating is raised for clean steel; zero without a static rating.
    pub fn clean_steel_probability(&self) -> f64 {
        let raised = |hypothesis: &&Hypothesis| {
            hypothesis.excess.is_some_and(|excess| excess > CLEAN_STEEL_EXCESS)
        };
        self.hypotheses.iter().filter(raised).map(|hypothesis| hypothesis.probability).sum()
    }

    /// Returns `count` grooves, at most [`DRAWS`], that represent the uncertainty. They are always
    /// the same for the same row.
    pub fn draws(&self, count: usize) -> Vec<EstimatedGroove> {
        let running = self.hypotheses.iter().scan(0.0, |sum, hypothesis| {
            *sum += hypothesis.probability;
            Some(*sum)
        });
        let cumulative: Vec<f64> = running.collect();
        let draw = |(pick, normals): &(f64, [f64; 4])| {
            let place = cumulative.partition_point(|sum| sum < pick);
            // Rounding may leave the last sum just below one.
            let hypothesis = &self.hypotheses[place.min(self.hypotheses.len() - 1)];
            let unprinted = unprinted(*normals);
            let loaded_balls = hypothesis.loaded_balls * unprinted.loaded_balls_factor;
            self.line.complete(hypothesis, loaded_balls, &unprinted)
        };
        DRAW_POINTS.iter().take(count).map(draw).collect()
    }

    /// Returns the results of `f` for the first `count` grooves of [`draws`](Self::draws), in their
    /// order. The function is called on all cores, with the number of the draw and its groove.
    pub fn map<T: Send>(
        &self,
        count: usize,
        f: impl Fn(usize, &EstimatedGroove) -> T + Sync,
    ) -> Vec<T> {
        let draws = self.draws(count);
        let numbered: Vec<_> = draws.iter().enumerate().collect();
        on_all_cores(&numbered, |(place, groove)| f(*place, groove))
    }

    /// Returns the excess of the dynamic over the static rating (AB1) as a factor, the weighted
    /// mean of all hypotheses; `None` without a static rating.
    pub fn excess_factor(&self) -> Option<f64> {
        let weighted = |of: &Hypothesis| Some(of.probability * of.excess?);
        Some(self.hypotheses.iter().map(weighted).sum::<Option<f64>>()?.exp())
    }
}

/// Returns the results of `f` for all items, in their order. The function is called on all cores.
pub fn on_all_cores<T: Sync, U: Send>(items: &[T], f: impl Fn(&T) -> U + Sync) -> Vec<U> {
    items.par_iter().map(&f).collect()
}

/// Returns the coordinate in (0, 1) of a draw for a quantity that is not a part of the groove.
///
/// * `draw`: number of the draw, from 0.
pub fn beside_groove(draw: usize) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "at most 128")]
    let j = (draw + 1) as f64;
    // u_j = frac(½ + j √2)                                                (AB13)
    (0.5 + j * SQRT_2).fract()
}

/// Number of draws of a groove for the bands of most results.
pub const DRAWS: usize = 128;

/// Number of draws of a groove for results that take long to calculate.
pub const FEW_DRAWS: usize = 32;

/// Draws, each with the probability that selects the hypothesis, and with standard normal numbers
/// for the other quantities.
static DRAW_POINTS: LazyLock<Vec<(f64, [f64; 4])>> = LazyLock::new(|| {
    // The ratio is the real root of φ⁶ = φ + 1.
    let ratio: f64 = 1.134_724_138_401_519_4;
    let point = |j: usize| {
        #[expect(clippy::cast_precision_loss, reason = "at most 128")]
        let j = j as f64;
        // u_jk = frac(½ + j φ^−k)                                         (AB11)
        let coordinate = |k: i32| (0.5 + j * ratio.powi(-k)).fract();
        (coordinate(1), [2, 3, 4, 5].map(|k| normal_quantile(coordinate(k))))
    };
    (1..=DRAWS).map(point).collect()
});

/// Range of a result over the draws of a groove.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// 5 % quantile.
    pub low: f64,
    /// 95 % quantile.
    pub high: f64,
}

impl Band {
    /// Returns the band of the values at the draws, `None` if there are no values.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut sorted: Vec<f64> = values.into_iter().collect();
        sorted.sort_by(f64::total_cmp);
        let at = |probability: f64| quantile(&sorted, probability);
        (!sorted.is_empty()).then(|| Self { low: at(0.05), high: at(0.95) })
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    /// Returns a catalog row with nominal diameter and lead \[mm\] and ratings \[N\].
    fn line(nominal: f64, lead: f64, dynamic_rating: f64, static_rating: f64) -> CatalogLine {
        CatalogLine {
            nominal_diameter: nominal / PER_M,
            lead: lead / PER_M,
            dynamic_rating,
            static_rating: Some(static_rating),
            ball_diameter: None,
            pitch_diameter: None,
            core: None,
            turns: None,
            conformity: (None, None),
            contact_angle: None,
        }
    }

    /// Returns the catalog row of SFU1605-4 of TBI.
    fn sfu() -> CatalogLine {
        line(16.0, 5.0, 13_533.0, 29_930.0)
    }

    /// Hypotheses, best groove and evidence of one nut agree with an independent implementation.
    #[test]
    fn sfu1605_matches_independent_numbers() {
        let estimate = sfu().estimate().expect("usual ratings");
        // The evidence is printed with three decimals.
        assert!((estimate.ln_evidence - 0.413).abs() < 1e-3, "{}", estimate.ln_evidence);
        let of = |ball_return: BallReturn| {
            let is = |of: &&Hypothesis| {
                (of.ball_diameter * PER_M - 3.175).abs() < 1e-9
                    && (of.turns - 4.0).abs() < 1e-9
                    && of.ball_return == ball_return
            };
            *estimate.hypotheses.iter().find(is).expect("a listed combination")
        };
        let full = of(BallReturn::FullTurn);
        // The probabilities are printed with four and three digits.
        assert!((full.probability - 0.3808).abs() < 5e-5, "{full:?}");
        assert!((of(BallReturn::Deflector).probability - 2.20e-4).abs() < 5e-7);
        assert_relative_eq!(full.loaded_balls, 64.07, max_relative = 1e-4);
        assert!((full.excess.expect("a static rating") + 0.00294).abs() < 5e-6);
        let best = estimate.best();
        assert_relative_eq!(best.ball_diameter, 3.175e-3, max_relative = 1e-12);
        assert_relative_eq!(best.pitch_diameter, 16.794e-3, max_relative = 1e-4);
        assert_eq!((best.turns, best.loaded_balls, best.conformity), (4.0, 64.0, (0.52, 0.52)));
    }

    /// The evidence with further items agrees with an independent implementation to three printed
    /// decimals.
    #[test]
    fn given_items_change_the_evidence_as_published() {
        let near = |line: CatalogLine, expected: f64| {
            let evidence = line.estimate().expect("usual ratings").ln_evidence;
            assert!((evidence - expected).abs() < 1e-3, "{evidence} {expected}");
        };
        near(CatalogLine { ball_diameter: Some(3.175e-3), ..sfu() }, 1.539);
        near(CatalogLine { turns: Some(4.0), ..sfu() }, 1.001);
        near(CatalogLine { static_rating: None, ..sfu() }, -1.016);
        near(line(40.0, 20.0, 51_300.0, 144_400.0), 1.504);
    }

    /// The row prints a static rating of 10 117 N instead of 101 170 N.
    #[test]
    fn misprint_is_refused_with_the_right_reading() {
        let refused = line(50.0, 5.0, 24_900.0, 10_117.0).estimate().expect_err("a misprint");
        let nearest = refused.nearest.expect("balls fit the sizes");
        // The evidence is printed with one decimal.
        assert!((nearest.ln_evidence + 107.2).abs() < 0.05, "{}", nearest.ln_evidence);
        let (reading, evidence) = refused.readings[0];
        assert_eq!(reading, Reading::StaticRatingTimesTen);
        assert!((evidence - 0.85).abs() < 5e-3, "{evidence}");
    }

    /// Ratings in kgf that are read as N are rejected, and so are exchanged ratings.
    #[test]
    fn wrong_units_and_swapped_ratings_are_recognized() {
        let right = sfu();
        let kgf = 1.0 / 9.806_65;
        let cases = [
            (line(16.0, 5.0, kgf * 13_533.0, kgf * 29_930.0), Reading::RatingsInKilogramForce),
            (line(16.0, 5.0, 29_930.0, 13_533.0), Reading::RatingsSwapped),
            (line(16.0, 5.0, 13_533.0, 299_300.0), Reading::StaticRatingOverTen),
        ];
        let ln_right = right.estimate().expect("usual ratings").ln_evidence;
        for (wrong, reading) in cases {
            let refused = wrong.estimate().expect_err("a mistake");
            let found = refused.readings.iter().find(|(found, _)| *found == reading);
            let (_, ln_evidence) = found.expect("the mistake");
            assert_relative_eq!(*ln_evidence, ln_right, max_relative = 1e-9);
        }
    }

    /// A lead of half a millimeter leaves no room for any ball.
    #[test]
    fn line_without_a_fitting_ball_is_refused() {
        let refused = line(16.0, 0.5, 13_533.0, 29_930.0).estimate().expect_err("no ball");
        assert_eq!(refused.nearest, None);
        assert_eq!(refused.readings.first().map(|found| found.0), Some(Reading::LeadTimesTen));
        // A given ball that overlaps the screw axis has no rating. Its result is an error instead
        // of NaN.
        let huge = CatalogLine { ball_diameter: Some(100e-3), ..sfu() };
        assert_eq!(huge.estimate().expect_err("no rating").nearest, None);
    }

    /// Given quantities are exact in the best groove and in every draw, and the set of balls
    /// becomes smaller.
    #[test]
    fn given_items_are_kept_exactly() {
        let given = CatalogLine {
            ball_diameter: Some(3.2e-3),
            pitch_diameter: Some(16.8e-3),
            turns: Some(4.1),
            conformity: (Some(0.53), None),
            contact_angle: Some(0.8),
            ..sfu()
        };
        let estimate = given.estimate().expect("usual ratings");
        assert_eq!(estimate.likely_balls().len(), 1);
        let grooves = estimate.draws(DRAWS);
        assert_eq!(grooves.len(), 128);
        for groove in grooves.into_iter().chain([estimate.best()]) {
            let kept = [groove.ball_diameter, groove.pitch_diameter, groove.turns];
            let kept = [kept.as_slice(), &[groove.conformity.0, groove.contact_angle]].concat();
            for (kept, given) in kept.into_iter().zip([3.2e-3, 16.8e-3, 4.1, 0.53, 0.8]) {
                // The ball is converted to millimeters and back.
                assert_relative_eq!(kept, given, max_relative = 1e-15);
            }
            let nut = groove.nut(given.lead, (STEEL, STEEL));
            assert_relative_eq!(
                nut.balls_per_turn * nut.turns,
                groove.loaded_balls,
                max_relative = 1e-14
            );
        }
    }

    /// The static rating of the best groove, at the estimated number of balls, agrees with the
    /// given rating to within half a ball.
    #[test]
    fn best_groove_has_the_static_rating_of_the_line() {
        let best = sfu().estimate().expect("usual ratings").best();
        let rating = best.nut(5e-3, (STEEL, STEEL)).static_rating().rating;
        assert_relative_eq!(rating, 29_930.0, max_relative = 0.5 / best.loaded_balls);
    }

    /// The first draws are the same for any number of draws.
    #[test]
    fn few_draws_are_the_first_of_many() {
        let estimate = sfu().estimate().expect("usual ratings");
        assert_eq!(estimate.draws(FEW_DRAWS), estimate.draws(DRAWS)[..FEW_DRAWS]);
    }

    /// The dynamic rating is 35 % above the rating of ISO 3408-5.
    #[test]
    fn clean_steel_is_recognized() {
        let raised = CatalogLine { dynamic_rating: 1.35 * sfu().dynamic_rating, ..sfu() };
        let probability =
            |line: CatalogLine| line.estimate().expect("accepted").clean_steel_probability();
        assert!(probability(raised) > 0.5 && probability(sfu()) < 0.01);
    }

    /// An estimate calculates the ratings of every combination once, so that the lists bound its
    /// cost.
    #[test]
    fn number_of_hypotheses_is_bounded() {
        for (nominal, lead) in [(8.0, 2.0), (16.0, 5.0), (40.0, 20.0), (100.0, 20.0)] {
            let estimate =
                line(nominal, lead, 1e4, 2e4).weighted(&Prior::USUAL).expect("balls fit");
            assert!(estimate.hypotheses.len() <= 33 * 23 * 3);
            let sum: f64 = estimate.hypotheses.iter().map(|of| of.probability).sum();
            assert_relative_eq!(sum, 1.0, max_relative = 1e-12);
        }
    }
}
