//! Estimate of the groove geometry of a screw from one catalog row with nominal diameter, lead and
//! load ratings.
//!
//! ISO 3408-5 calculates load ratings from the groove geometry. This module solves the inverse
//! problem. It enumerates the combinations of balls, turns and ball returns that manufacturers use,
//! and weights each combination by its [prior probability](Prior) and by how well its ratings match
//! the catalog row.
//!
//! Theory: `docs/theory/21-groove-from-ratings.md`, equations (AB1) to (AB13).

mod catalog_line;
mod prior;

use std::f64::consts::{FRAC_PI_4, SQRT_2};
use std::sync::LazyLock;

use bsm_dyn::{Conformities, Material, Materials};
use rayon::prelude::*;

use self::catalog_line::PER_M;
use self::prior::{RatingFit, unprinted};
use crate::Nut;
use crate::drive::GRAVITY;
use crate::nut::turn_length;
use crate::statistics::{ln_sum, normal_quantile};

pub use self::catalog_line::CatalogLine;
pub use self::prior::{BallReturn, KnownGroove, Prior};

/// Log evidence below which a catalog row is reported as unusual.
pub const UNUSUAL_EVIDENCE: f64 = -4.0;

/// Log evidence below which a catalog row is rejected.
pub const MIN_EVIDENCE: f64 = -7.0;

/// Log evidence above which a corrected [`CatalogMistake`] of a rejected row is suggested.
const MISTAKE_EVIDENCE: f64 = -3.0;

/// Limit for the excess of the dynamic rating relative to the static rating (logarithm, AB1). Above
/// this limit, the rating is assumed to be raised for clean steel.
const CLEAN_STEEL_EXCESS: f64 = 0.15;

/// Minimum total probability of the balls in [`GrooveEstimate::likely_balls`].
const SET_PROBABILITY: f64 = 0.9;

/// Conformities of nut and screw that are assumed for the load ratings and for the best groove.
const CONFORMITY: f64 = 0.52;

/// Contact angle \[rad\] that is assumed for the load ratings and for the best groove.
const CONTACT_ANGLE: f64 = FRAC_PI_4;

/// Elastic constants of trial nuts. They do not influence the load ratings.
const STEEL: Material = Material { youngs_modulus: 206e9, poisson_ratio: 0.3 };

/// One combination of ball diameter, loaded turns and ball return.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hypothesis {
    /// Ball diameter \[m\].
    pub ball_diameter: f64,
    /// Number of loaded turns.
    pub turns: f64,
    /// Type of ball return.
    pub ball_return: BallReturn,
    /// Number of loaded balls, which may be a fraction (AB2).
    pub loaded_balls: f64,
    /// Excess of the dynamic rating relative to the static rating (AB1), as a logarithm; `None`
    /// without a static rating.
    pub excess: Option<f64>,
    /// Posterior probability of this hypothesis.
    pub probability: f64,
}

/// A ball diameter together with its posterior probability.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BallProbability {
    /// Ball diameter \[m\].
    pub ball_diameter: f64,
    /// Sum of the probabilities of all hypotheses with this ball diameter.
    pub probability: f64,
}

/// A complete groove geometry, including the number of loaded balls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EstimatedGroove {
    /// Ball diameter \[m\].
    pub ball_diameter: f64,
    /// Pitch circle diameter \[m\].
    pub pitch_diameter: f64,
    /// Conformities of nut and screw.
    pub conformity: Conformities,
    /// Contact angle \[rad\].
    pub contact_angle: f64,
    /// Number of loaded turns.
    pub turns: f64,
    /// Number of loaded balls (an integer).
    pub loaded_balls: f64,
}

impl EstimatedGroove {
    /// Returns a single-start nut that has this groove and the given elastic constants of raceways
    /// and balls.
    pub fn nut(&self, lead: f64, material: Materials) -> Nut {
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

/// Estimated groove of a catalog row, with its uncertainty.
#[derive(Debug, Clone, PartialEq)]
pub struct GrooveEstimate {
    /// Catalog row from which the groove is estimated.
    pub line: CatalogLine,
    /// Log evidence: the logarithm of the probability density of this row under the prior.
    pub ln_evidence: f64,
    /// All hypotheses, sorted by ball diameter and then by number of loaded balls.
    pub hypotheses: Vec<Hypothesis>,
    /// All ball diameters, in descending order of probability.
    pub balls: Vec<BallProbability>,
}

/// A mistake in a catalog row that would explain why the ratings do not match any groove.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CatalogMistake {
    /// The ratings are stated in kgf instead of N.
    RatingsInKilogramForce,
    /// The ratings are stated in lbf instead of N.
    RatingsInPoundForce,
    /// The dynamic and static ratings are swapped.
    RatingsSwapped,
    /// The true static rating is 10 times the printed value.
    StaticRatingTimesTen,
    /// The true static rating is one tenth of the printed value.
    StaticRatingOverTen,
    /// The true lead is 10 times the printed value.
    LeadTimesTen,
    /// The true lead is one tenth of the printed value.
    LeadOverTen,
}

/// A rejected catalog row, whose ratings do not match any plausible groove.
#[derive(Debug, Clone, PartialEq)]
pub struct RejectedRow {
    /// Estimate for the row as printed in the catalog; `None` if no ball fits the nominal diameter
    /// and the lead.
    pub nearest: Option<Box<GrooveEstimate>>,
    /// Corrected readings of the row that match a plausible groove, each with its log evidence, in
    /// descending order of evidence.
    pub mistakes: Vec<(CatalogMistake, f64)>,
}

impl CatalogMistake {
    const ALL: [Self; 7] = [
        Self::RatingsInKilogramForce,
        Self::RatingsInPoundForce,
        Self::RatingsSwapped,
        Self::StaticRatingTimesTen,
        Self::StaticRatingOverTen,
        Self::LeadTimesTen,
        Self::LeadOverTen,
    ];

    /// Returns the catalog row with this mistake corrected. Returns `None` if the mistake concerns
    /// the static rating and the row has no static rating.
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
            Self::RatingsInKilogramForce => ratings(GRAVITY),
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
    /// Estimates the groove with the prior [`Prior::USUAL`].
    ///
    /// # Errors
    ///
    /// Returns [`RejectedRow`] if no ball fits the nominal diameter and the lead, or if the log
    /// evidence is below [`MIN_EVIDENCE`].
    pub fn estimate(&self) -> Result<GrooveEstimate, RejectedRow> {
        self.estimate_with(&Prior::USUAL)
    }

    /// Estimates the groove with a given prior, like [`estimate`](Self::estimate).
    ///
    /// # Errors
    ///
    /// Returns [`RejectedRow`] under the same conditions as [`estimate`](Self::estimate).
    pub fn estimate_with(&self, prior: &Prior) -> Result<GrooveEstimate, RejectedRow> {
        match self.weighted(prior) {
            Some(estimate) if estimate.ln_evidence >= MIN_EVIDENCE => Ok(estimate),
            nearest => {
                Err(RejectedRow { nearest: nearest.map(Box::new), mistakes: self.mistakes(prior) })
            }
        }
    }

    /// Returns the corrected readings that match a plausible groove, in descending order of
    /// evidence.
    fn mistakes(&self, prior: &Prior) -> Vec<(CatalogMistake, f64)> {
        let evidence = |mistake: CatalogMistake| {
            let estimate = mistake.of(self)?.weighted(prior)?;
            Some((mistake, estimate.ln_evidence))
        };
        let mut mistakes: Vec<_> = CatalogMistake::ALL.into_iter().filter_map(evidence).collect();
        mistakes.retain(|(_, ln_evidence)| *ln_evidence > MISTAKE_EVIDENCE);
        mistakes.sort_by(|one, other| other.1.total_cmp(&one.1));
        mistakes
    }

    /// Calculates the probabilities of all hypotheses. Returns `None` if no ball fits.
    fn weighted(&self, prior: &Prior) -> Option<GrooveEstimate> {
        let mut weighted = Vec::new();
        for (ball, ln_prior) in self.balls(prior) {
            self.add_hypotheses(prior, (ball, ln_prior), &mut weighted);
        }
        // If the given ball overlaps the screw axis, the load ratings are not finite.
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

    /// Returns the possible ball diameters \[m\], each with the logarithm of its prior.
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

    /// Appends the hypotheses for one ball diameter, each with the logarithm of its weight.
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

    /// Returns a trial nut with the conformity and the contact angle that are assumed for load
    /// ratings.
    fn trial(&self, ball: f64, balls_per_turn: f64, turns: f64) -> Nut {
        Nut {
            ball_diameter: ball,
            pitch_diameter: self.pitch_diameter_of(ball, prior::PITCH_RISE.mean),
            lead: self.lead,
            contact_angle: CONTACT_ANGLE,
            conformity: Conformities::alike(CONFORMITY),
            material: Materials::alike(STEEL),
            balls_per_turn,
            turns,
            starts: 1.0,
        }
    }

    /// Returns the number of balls with the given diameter \[m\] that fill one turn.
    fn balls_of_a_full_turn(&self, ball: f64) -> f64 {
        turn_length(self.pitch_diameter_of(ball, prior::PITCH_RISE.mean), self.lead) / ball
    }

    /// Returns the number of loaded balls for which the calculated static rating equals the static
    /// rating in the catalog row. Returns `None` without a static rating.
    fn rated_balls(&self, ball: f64) -> Option<f64> {
        let one_ball = self.trial(ball, 1.0, 1.0).static_rating().rating;
        Some(self.static_rating? / one_ball)
    }

    /// Returns the logarithm of the loaded fraction of a turn for a known groove (`$r_0$` in
    /// (AB1)).
    fn ln_loaded_share(
        &self,
        KnownGroove { ball_diameter, turns, .. }: &KnownGroove,
    ) -> Option<f64> {
        let full = turns * self.balls_of_a_full_turn(*ball_diameter);
        Some((self.rated_balls(*ball_diameter)? / full).ln())
    }

    /// Returns the pitch circle diameter \[m\] for a ball diameter. If the catalog row does not
    /// state the pitch circle diameter, the result is the nominal diameter plus `rise` times the
    /// ball diameter.
    fn pitch_diameter_of(&self, ball: f64, rise: f64) -> f64 {
        self.pitch_diameter.unwrap_or(self.nominal_diameter + rise * ball)
    }

    /// Completes a groove. Quantities that are missing in the catalog row are taken from
    /// `unprinted`.
    fn complete(
        &self,
        hypothesis: &Hypothesis,
        loaded_balls: f64,
        unprinted: &prior::Unprinted,
    ) -> EstimatedGroove {
        let Conformities { nut, screw } = self.conformity;
        EstimatedGroove {
            ball_diameter: hypothesis.ball_diameter,
            pitch_diameter: self.pitch_diameter_of(hypothesis.ball_diameter, unprinted.pitch_rise),
            conformity: Conformities {
                nut: nut.unwrap_or(unprinted.conformity),
                screw: screw.unwrap_or(unprinted.conformity),
            },
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

    /// Returns the best groove, which has the most likely ball diameter, the most likely number of
    /// turns for this ball, and the mean number of loaded balls.
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
            // Every ball diameter has at least one hypothesis, so this fallback is never used.
            .unwrap_or(&self.hypotheses[0]);
        let ln_sum: f64 = hypotheses().map(|of| of.probability * of.loaded_balls.ln()).sum();
        let loaded_balls = (ln_sum / ball.probability).exp();
        self.line.complete(best, loaded_balls, &unprinted([0.0; 4]))
    }

    /// Returns the most likely ball diameters, whose probabilities add up to at least 90 %.
    pub fn likely_balls(&self) -> &[BallProbability] {
        let mut sum = 0.0;
        let reaches = |ball: &BallProbability| {
            sum += ball.probability;
            sum >= SET_PROBABILITY
        };
        let last = self.balls.iter().position(reaches).unwrap_or(self.balls.len() - 1);
        &self.balls[..=last]
    }

    /// Returns the quantile of the number of loaded balls for a given cumulative probability.
    pub fn loaded_balls_quantile(&self, probability: f64) -> f64 {
        let mut hypotheses: Vec<_> = self.hypotheses.iter().collect();
        hypotheses.sort_by(|one, other| one.loaded_balls.total_cmp(&other.loaded_balls));
        let mut sum = 0.0;
        let reaches = |hypothesis: &&&Hypothesis| {
            sum += hypothesis.probability;
            sum >= probability
        };
        // The sum of all probabilities may be slightly less than one because of rounding.
        let at = hypotheses.iter().find(reaches).or(hypotheses.last());
        at.map_or(f64::NAN, |hypothesis| hypothesis.loaded_balls)
    }

    /// Returns the probability that the dynamic rating is raised for clean steel. Without a static
    /// rating, the probability is zero.
    pub fn clean_steel_probability(&self) -> f64 {
        let raised = |hypothesis: &&Hypothesis| {
            hypothesis.excess.is_some_and(|excess| excess > CLEAN_STEEL_EXCESS)
        };
        self.hypotheses.iter().filter(raised).map(|hypothesis| hypothesis.probability).sum()
    }

    /// Returns `count` grooves (at most [`DRAWS`]) that represent the uncertainty of the estimate.
    /// The same row always gives the same grooves.
    pub fn draws(&self, count: usize) -> Vec<EstimatedGroove> {
        let running = self.hypotheses.iter().scan(0.0, |sum, hypothesis| {
            *sum += hypothesis.probability;
            Some(*sum)
        });
        let cumulative: Vec<f64> = running.collect();
        let draw = |(pick, normals): &(f64, [f64; 4])| {
            let place = cumulative.partition_point(|sum| sum < pick);
            // The last cumulative probability may be slightly less than one because of rounding.
            let hypothesis = &self.hypotheses[place.min(self.hypotheses.len() - 1)];
            let unprinted = unprinted(*normals);
            let loaded_balls = hypothesis.loaded_balls * unprinted.loaded_balls_factor;
            self.line.complete(hypothesis, loaded_balls, &unprinted)
        };
        DRAW_POINTS.iter().take(count).map(draw).collect()
    }

    /// Applies `f` to the first `count` grooves of [`draws`](Self::draws) and returns the results
    /// in the same order. The function is called in parallel with the index of the draw and its
    /// groove.
    pub fn map<T: Send>(
        &self,
        count: usize,
        f: impl Fn(usize, &EstimatedGroove) -> T + Sync,
    ) -> Vec<T> {
        let draws = self.draws(count);
        let numbered: Vec<_> = draws.iter().enumerate().collect();
        on_all_cores(&numbered, |(place, groove)| f(*place, groove))
    }

    /// Returns the ratio of the dynamic rating to the rating expected from the static rating (AB1),
    /// as a weighted geometric mean over all hypotheses. Returns `None` without a static rating.
    pub fn excess_factor(&self) -> Option<f64> {
        let weighted = |of: &Hypothesis| Some(of.probability * of.excess?);
        Some(self.hypotheses.iter().map(weighted).sum::<Option<f64>>()?.exp())
    }
}

/// Returns the results of `f` for all items, in the order of the items. The function is called on
/// all cores in parallel.
pub fn on_all_cores<T: Sync, U: Send>(items: &[T], f: impl Fn(&T) -> U + Sync) -> Vec<U> {
    items.par_iter().map(&f).collect()
}

/// Returns a quasi-random number in (0, 1), which is used to draw a quantity that does not depend
/// on the groove.
///
/// * `draw`: index of the draw, from 0.
pub fn quasi_random_besides_groove(draw: usize) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "at most 128")]
    let j = (draw + 1) as f64;
    // u_j = frac(½ + j √2)                                                (AB13)
    (0.5 + j * SQRT_2).fract()
}

/// Number of random groove geometries (draws) for the uncertainty bands of most results.
pub const DRAWS: usize = 128;

/// Number of random groove geometries (draws) for results that take a long time to calculate.
pub const FEW_DRAWS: usize = 32;

/// Quasi-random points, each with the cumulative probability that selects a hypothesis and with
/// four standard normal numbers for the quantities that catalogs do not print.
static DRAW_POINTS: LazyLock<Vec<(f64, [f64; 4])>> = LazyLock::new(|| {
    // The ratio φ is the positive root of the equation φ⁶ = φ + 1.
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

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    /// Creates a catalog row from nominal diameter and lead \[mm\] and load ratings \[N\].
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
            conformity: Conformities::alike(None),
            contact_angle: None,
        }
    }

    /// Returns the catalog row of the TBI nut SFU1605-4.
    fn sfu() -> CatalogLine {
        line(16.0, 5.0, 13_533.0, 29_930.0)
    }

    /// Hypotheses, best groove and evidence of one nut match an independent implementation.
    #[test]
    fn groove_estimate_for_the_nut_sfu1605_matches_an_independent_implementation() {
        let estimate = sfu().estimate().expect("usual ratings");
        // The reference evidence is printed with three decimals.
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
        // The reference probabilities are printed with four and three significant digits.
        assert!((full.probability - 0.3808).abs() < 5e-5, "{full:?}");
        assert!((of(BallReturn::Deflector).probability - 2.20e-4).abs() < 5e-7);
        assert_relative_eq!(full.loaded_balls, 64.07, max_relative = 1e-4);
        assert!((full.excess.expect("a static rating") + 0.00294).abs() < 5e-6);
        let best = estimate.best();
        assert_relative_eq!(best.ball_diameter, 3.175e-3, max_relative = 1e-12);
        assert_relative_eq!(best.pitch_diameter, 16.794e-3, max_relative = 1e-4);
        assert_eq!(
            (best.turns, best.loaded_balls, best.conformity),
            (4.0, 64.0, Conformities::alike(0.52))
        );
    }

    /// For rows with additional or missing values, the evidence matches an independent
    /// implementation to the three printed decimals.
    #[test]
    fn evidence_for_rows_with_more_or_fewer_values_matches_an_independent_implementation() {
        let near = |line: CatalogLine, expected: f64| {
            let evidence = line.estimate().expect("usual ratings").ln_evidence;
            assert!((evidence - expected).abs() < 1e-3, "{evidence} {expected}");
        };
        near(CatalogLine { ball_diameter: Some(3.175e-3), ..sfu() }, 1.539);
        near(CatalogLine { turns: Some(4.0), ..sfu() }, 1.001);
        near(CatalogLine { static_rating: None, ..sfu() }, -1.016);
        near(line(40.0, 20.0, 51_300.0, 144_400.0), 1.504);
    }

    /// The catalog row states a static rating of 10 117 N instead of the correct 101 170 N.
    #[test]
    fn misprinted_row_is_rejected_with_the_correct_reading() {
        let refused = line(50.0, 5.0, 24_900.0, 10_117.0).estimate().expect_err("a misprint");
        let nearest = refused.nearest.expect("balls fit the sizes");
        // The reference evidence is printed with one decimal.
        assert!((nearest.ln_evidence + 107.2).abs() < 0.05, "{}", nearest.ln_evidence);
        let (mistake, evidence) = refused.mistakes[0];
        assert_eq!(mistake, CatalogMistake::StaticRatingTimesTen);
        assert!((evidence - 0.85).abs() < 5e-3, "{evidence}");
    }

    /// Rows with ratings in kgf instead of N, with swapped ratings or with a misplaced decimal
    /// point are rejected, and the mistake is identified.
    #[test]
    fn wrong_units_and_swapped_ratings_are_recognized() {
        let right = sfu();
        let kgf = 1.0 / 9.806_65;
        let cases = [
            (
                line(16.0, 5.0, kgf * 13_533.0, kgf * 29_930.0),
                CatalogMistake::RatingsInKilogramForce,
            ),
            (line(16.0, 5.0, 29_930.0, 13_533.0), CatalogMistake::RatingsSwapped),
            (line(16.0, 5.0, 13_533.0, 299_300.0), CatalogMistake::StaticRatingOverTen),
        ];
        let ln_right = right.estimate().expect("usual ratings").ln_evidence;
        for (wrong, mistake) in cases {
            let refused = wrong.estimate().expect_err("a mistake");
            let found = refused.mistakes.iter().find(|(found, _)| *found == mistake);
            let (_, ln_evidence) = found.expect("the mistake");
            assert_relative_eq!(*ln_evidence, ln_right, max_relative = 1e-9);
        }
    }

    /// A lead of 0.5 mm leaves no room for any ball.
    #[test]
    fn row_without_a_fitting_ball_is_rejected() {
        let refused = line(16.0, 0.5, 13_533.0, 29_930.0).estimate().expect_err("no ball");
        assert_eq!(refused.nearest, None);
        assert_eq!(
            refused.mistakes.first().map(|found| found.0),
            Some(CatalogMistake::LeadTimesTen)
        );
        // If the given ball overlaps the screw axis, the load rating is undefined, so the function
        // must return an error instead of NaN.
        let huge = CatalogLine { ball_diameter: Some(100e-3), ..sfu() };
        assert_eq!(huge.estimate().expect_err("no rating").nearest, None);
    }

    /// The best groove and every draw contain the given quantities exactly, and the set of likely
    /// balls is reduced to one.
    #[test]
    fn groove_estimate_keeps_specified_quantities_exactly() {
        let given = CatalogLine {
            ball_diameter: Some(3.2e-3),
            pitch_diameter: Some(16.8e-3),
            turns: Some(4.1),
            conformity: Conformities { nut: Some(0.53), screw: None },
            contact_angle: Some(0.8),
            ..sfu()
        };
        let estimate = given.estimate().expect("usual ratings");
        assert_eq!(estimate.likely_balls().len(), 1);
        let grooves = estimate.draws(DRAWS);
        assert_eq!(grooves.len(), 128);
        for groove in grooves.into_iter().chain([estimate.best()]) {
            let kept = [groove.ball_diameter, groove.pitch_diameter, groove.turns];
            let kept = [kept.as_slice(), &[groove.conformity.nut, groove.contact_angle]].concat();
            for (kept, given) in kept.into_iter().zip([3.2e-3, 16.8e-3, 4.1, 0.53, 0.8]) {
                // The ball diameter is converted to millimeters and back, which causes rounding
                // errors.
                assert_relative_eq!(kept, given, max_relative = 1e-15);
            }
            let nut = groove.nut(given.lead, Materials::alike(STEEL));
            assert_relative_eq!(
                nut.balls_per_turn * nut.turns,
                groove.loaded_balls,
                max_relative = 1e-14
            );
        }
    }

    /// With the estimated number of balls, the static rating of the best groove matches the given
    /// rating to within half a ball.
    #[test]
    fn best_groove_has_the_static_rating_of_the_row() {
        let best = sfu().estimate().expect("usual ratings").best();
        let rating = best.nut(5e-3, Materials::alike(STEEL)).static_rating().rating;
        assert_relative_eq!(rating, 29_930.0, max_relative = 0.5 / best.loaded_balls);
    }

    /// The first draws do not depend on the total number of draws.
    #[test]
    fn first_random_grooves_do_not_depend_on_the_total_number_of_random_grooves() {
        let estimate = sfu().estimate().expect("usual ratings");
        assert_eq!(estimate.draws(FEW_DRAWS), estimate.draws(DRAWS)[..FEW_DRAWS]);
    }

    /// The dynamic rating of this row is 35 % above the rating according to ISO 3408-5.
    #[test]
    fn rating_raised_for_clean_steel_is_recognized() {
        let raised = CatalogLine { dynamic_rating: 1.35 * sfu().dynamic_rating, ..sfu() };
        let probability =
            |line: CatalogLine| line.estimate().expect("accepted").clean_steel_probability();
        assert!(probability(raised) > 0.5 && probability(sfu()) < 0.01);
    }

    /// The ratings of each combination are calculated only once, so the cost of an estimate is
    /// limited by the lengths of the lists.
    #[test]
    fn number_of_groove_hypotheses_for_a_catalog_row_is_bounded() {
        for (nominal, lead) in [(8.0, 2.0), (16.0, 5.0), (40.0, 20.0), (100.0, 20.0)] {
            let estimate =
                line(nominal, lead, 1e4, 2e4).weighted(&Prior::USUAL).expect("balls fit");
            assert!(estimate.hypotheses.len() <= 33 * 23 * 3);
            let sum: f64 = estimate.hypotheses.iter().map(|of| of.probability).sum();
            assert_relative_eq!(sum, 1.0, max_relative = 1e-12);
        }
    }
}
