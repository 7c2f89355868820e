//! Prior distribution of the grooves that manufacturers produce.
//!
//! Source: rounded results of a fit to 205 catalog rows of HIWIN, TBI and THK
//! (`validation/published/groove`) with equal weight for each manufacturer. The values for metric
//! balls, conformity and contact angle are based on judgment, because catalogs do not print them.
//!
//! All lengths are in mm as in the catalogs, so the evidence is calculated from probability
//! densities per millimeter.

use super::catalog_line::{CatalogLine, PER_M};
use crate::statistics::{Normal, ln_mixture};

/// Parameters of the prior distribution that are fitted to catalog rows. All other parameters in
/// this file are based on judgment, or are widths and tail weights that are not refitted.
#[derive(Debug, Clone, PartialEq)]
pub struct Prior {
    /// Ball diameters \[mm\], each with its weight (popularity).
    balls: [(f64, f64); 33],
    /// Numbers of loaded turns, each with its weight for every [`BallReturn`] in the order of
    /// [`BallReturn::ALL`].
    turns: [(f64, [f64; 3]); 23],
    /// Factors for lead and nominal diameter. The smaller of the two products is the typical ball
    /// diameter.
    usual_ball: (f64, f64),
    /// Median and logarithmic standard deviation of the loaded fraction of a turn, for every
    /// [`BallReturn`] in the order of [`BallReturn::ALL`].
    loaded_shares: [(f64, f64); 3],
}

/// A catalog row with a known groove, used to fit a [`Prior`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownGroove {
    /// Catalog row with both load ratings.
    pub line: CatalogLine,
    /// Ball diameter \[m\].
    pub ball_diameter: f64,
    /// Number of loaded turns.
    pub turns: f64,
    /// Type of ball return.
    pub ball_return: BallReturn,
    /// Weight of the row in the fit.
    pub weight: f64,
}

/// Ball diameters \[mm\], each with its weight (popularity).
const BALLS: [(f64, f64); 33] = [
    (0.8, 0.0),
    (1.0, 0.0),
    (1.2, 0.0),
    (1.5, 0.033),
    (1.588, 0.0),
    (2.0, 0.02),
    (2.381, 0.033),
    (2.5, 0.02),
    (2.778, 0.033),
    (3.0, 0.04),
    (3.175, 0.246),
    (3.5, 0.02),
    (3.969, 0.107),
    (4.0, 0.01),
    (4.5, 0.0),
    (4.763, 0.074),
    (5.0, 0.01),
    (5.556, 0.008),
    (6.0, 0.03),
    (6.35, 0.18),
    (6.5, 0.01),
    (7.0, 0.0),
    (7.144, 0.025),
    (7.938, 0.049),
    (8.0, 0.01),
    (9.0, 0.0),
    (9.525, 0.041),
    (10.0, 0.01),
    (11.112, 0.0),
    (12.7, 0.0),
    (15.081, 0.0),
    (15.875, 0.0),
    (19.05, 0.0),
];

/// Fraction of the popularity that is distributed equally among all balls.
const ALIKE_BALLS: f64 = 0.05;

/// Diameters of metric balls \[mm\], each with its popularity. The popularity is chosen by judgment
/// because catalogs that print ball diameters use inch sizes. The popularity of all other balls is
/// fitted to catalog rows.
const METRIC_BALLS: [(f64, f64); 10] = [
    (2.0, 0.02),
    (2.5, 0.02),
    (3.0, 0.04),
    (3.5, 0.02),
    (4.0, 0.01),
    (5.0, 0.01),
    (6.0, 0.03),
    (6.5, 0.01),
    (8.0, 0.01),
    (10.0, 0.01),
];

/// Numbers of loaded turns, each with its weight for every [`BallReturn`] in the order of
/// [`BallReturn::ALL`].
const TURNS: [(f64, [f64; 3]); 23] = [
    (1.5, [0.0, 0.0, 0.0]),
    (1.6, [0.03, 0.0, 0.0]),
    (1.8, [0.07, 0.0, 0.0]),
    (2.0, [0.06, 0.0, 0.0]),
    (2.5, [0.0, 0.29, 0.0]),
    (2.65, [0.0, 0.0, 0.0]),
    (2.8, [0.07, 0.0, 0.0]),
    (3.0, [0.11, 0.14, 0.37]),
    (3.3, [0.03, 0.0, 0.0]),
    (3.5, [0.0, 0.09, 0.0]),
    (3.6, [0.12, 0.0, 0.0]),
    (3.8, [0.08, 0.0, 0.0]),
    (4.0, [0.28, 0.0, 0.43]),
    (4.5, [0.0, 0.04, 0.0]),
    (5.0, [0.1, 0.3, 0.03]),
    (5.3, [0.0, 0.0, 0.0]),
    (5.6, [0.03, 0.0, 0.0]),
    (6.0, [0.02, 0.01, 0.17]),
    (7.0, [0.0, 0.0, 0.0]),
    (7.2, [0.02, 0.0, 0.0]),
    (7.5, [0.0, 0.12, 0.0]),
    (8.0, [0.0, 0.0, 0.0]),
    (10.0, [0.0, 0.0, 0.0]),
];

/// Lower limit of the fitted logarithmic standard deviation of the loaded fraction of a turn. It
/// corresponds to rounding to a whole number of balls in a turn of 20 balls.
const MIN_SHARE_DEVIATION: f64 = 0.05;

/// Fraction of the prior probability of a ball return that is distributed equally among all numbers
/// of turns.
const ALIKE_TURNS: f64 = 0.02;

/// Minimum weight of every ball return if the number of turns is given.
const MIN_RETURN_WEIGHT: f64 = 1e-3;

/// Distribution of the logarithm of the ball diameter divided by the typical ball diameter. The
/// first component describes most balls, and the second component is a wide tail.
const BALL_SIZE: [(f64, Normal); 2] =
    [(0.94, Normal { mean: 0.0, deviation: 0.13 }), (0.06, Normal { mean: 0.0, deviation: 0.35 })];

/// Distribution of the excess `$e$` of the dynamic rating relative to the static rating. Its
/// components describe ratings according to ISO 3408-5, a wide tail, and ratings that are raised
/// for clean steel.
const EXCESS: [(f64, Normal); 3] = [
    (0.82, Normal { mean: 0.0, deviation: 0.028 }),
    (0.08, Normal { mean: -0.10, deviation: 0.15 }),
    (0.10, Normal { mean: 0.30, deviation: 0.06 }),
];

/// Variance of the excess \[-\] of the dynamic rating relative to the static rating. It is used
/// instead of the distribution [`EXCESS`] if only the dynamic rating is known.
const EXCESS_VARIANCE: f64 = 0.028 * 0.028 + 0.05 * 0.05;

/// Distribution of the difference between nominal and core diameter divided by the ball diameter.
/// The first component describes typical grooves, and the second component is a wide tail.
const CORE_DEPTH: [(f64, Normal); 2] =
    [(0.9, Normal { mean: 0.85, deviation: 0.055 }), (0.1, Normal { mean: 0.85, deviation: 0.25 })];

/// Distribution of the difference between pitch circle and nominal diameter, divided by the ball
/// diameter.
pub(super) const PITCH_RISE: Normal = Normal { mean: 0.25, deviation: 0.03 };

/// Median of the conformity minus 1/2. The logarithm of this difference has the standard deviation
/// [`CONFORMITY_LN_DEVIATION`].
const CONFORMITY_OVER_HALF: f64 = 0.02;

/// Standard deviation of the logarithm of the conformity minus 1/2.
const CONFORMITY_LN_DEVIATION: f64 = 0.35;

/// Smallest and largest conformity that a random groove geometry (draw) may have.
const CONFORMITIES: (f64, f64) = (0.505, 0.56);

/// Distribution of the contact angle \[deg\].
const CONTACT_ANGLE: Normal = Normal { mean: 45.0, deviation: 2.5 };

/// Standard deviation of the logarithm of the ratio between the actual number of loaded balls and
/// the number that follows from the ratings.
const LOADED_BALLS_LN_DEVIATION: f64 = 0.05;

/// Type of ball return, which determines the loaded fraction of a turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BallReturn {
    /// Ball returns by cassettes and end caps, with which nearly all balls of a turn are loaded.
    FullTurn,
    /// Return tubes.
    Tube,
    /// Ball returns by deflectors, each of which returns the balls of a single turn.
    Deflector,
}

impl BallReturn {
    /// All types of ball return.
    pub const ALL: [Self; 3] = [Self::FullTurn, Self::Tube, Self::Deflector];

    /// Returns the prior probability of the ball return.
    fn probability(self) -> f64 {
        match self {
            Self::FullTurn => 0.5,
            Self::Tube | Self::Deflector => 0.25,
        }
    }
}

impl Prior {
    /// The prior that estimates use by default.
    pub const USUAL: Self = Self {
        balls: BALLS,
        turns: TURNS,
        usual_ball: (0.635, 0.159),
        loaded_shares: [(0.91, 0.18), (0.72, 0.09), (0.60, 0.12)],
    };

    /// Fits the prior to catalog rows. If there are no rows with a certain type of ball return, all
    /// numbers of turns get equal weights for this type, and its loaded fraction of a turn keeps
    /// the default value.
    pub fn fitted(rows: &[KnownGroove]) -> Self {
        let total = |wanted: &dyn Fn(&KnownGroove) -> bool| -> f64 {
            rows.iter().filter(|row| wanted(row)).map(|row| row.weight).sum()
        };
        let all = total(&|_| true);
        let metric: f64 = METRIC_BALLS.iter().map(|(_, weight)| weight).sum();
        let balls = BALLS.map(|(ball, _)| {
            let is_same = |other: f64| other.total_cmp(&ball).is_eq();
            let of_ball = total(&|row| is_same(nearest_ball(row.ball_diameter * PER_M)));
            let own = METRIC_BALLS.iter().find(|(own, _)| is_same(*own)).map_or(0.0, |own| own.1);
            (ball, own + (1.0 - metric) * of_ball / all)
        });
        let turns = TURNS.map(|(turns, _)| {
            let weights = BallReturn::ALL.map(|kind| {
                let is_same = |row: &KnownGroove| (row.turns - turns).abs() < 1e-9;
                total(&|row| row.ball_return == kind && is_same(row))
            });
            (turns, weights)
        });
        let loaded_shares = BallReturn::ALL.map(|kind| {
            let usual = Self::USUAL.loaded_shares[kind as usize];
            let of_kind = rows.iter().filter(|row| row.ball_return == kind);
            let shares: Vec<_> = of_kind
                .filter_map(|row| Some((row.line.ln_loaded_share(row)?, row.weight)))
                .collect();
            let weights: f64 = shares.iter().map(|(_, weight)| weight).sum();
            if weights <= 0.0 {
                return usual;
            }
            let mean = shares.iter().map(|(ln, weight)| weight * ln).sum::<f64>() / weights;
            let square = |(ln, weight): &(f64, f64)| weight * (ln - mean).powi(2);
            let variance = shares.iter().map(square).sum::<f64>() / weights;
            (mean.exp(), variance.sqrt().max(MIN_SHARE_DEVIATION))
        });
        let usual_ball = Self::fitted_usual_ball(rows);
        Self { balls, turns, usual_ball, loaded_shares }
    }

    /// Returns the pair of factors in (AB3), for lead and for nominal diameter, that has the
    /// largest likelihood. The search grid has steps of 0.005 for the first factor and 0.001 for
    /// the second factor.
    fn fitted_usual_ball(rows: &[KnownGroove]) -> (f64, f64) {
        let likelihood = |usual_ball: (f64, f64)| -> f64 {
            let trial = Self { usual_ball, ..Self::USUAL };
            let of_row = |KnownGroove { line, ball_diameter, weight, .. }: &KnownGroove| {
                let [ball, nominal, lead] =
                    [*ball_diameter, line.nominal_diameter, line.lead].map(|length| length * PER_M);
                weight * trial.ln_ball_size(ball, nominal, lead)
            };
            rows.iter().map(of_row).sum()
        };
        let grid = (100..160)
            .flat_map(|a| (120..200).map(move |b| (0.005 * f64::from(a), 0.001 * f64::from(b))));
        let best = grid.max_by(|one, other| likelihood(*one).total_cmp(&likelihood(*other)));
        best.unwrap_or(Self::USUAL.usual_ball)
    }

    /// Returns the probability distribution of the logarithm of the loaded fraction of a turn, for
    /// the given type of ball return.
    pub(super) fn ln_loaded_share(&self, kind: BallReturn) -> Normal {
        let (share, deviation) = self.loaded_shares[kind as usize];
        Normal { mean: share.ln(), deviation }
    }

    /// Returns the joint prior probability of a type of ball return and a number of loaded turns
    /// (AB5).
    #[expect(clippy::cast_precision_loss, reason = "23 numbers of turns")]
    fn turns_prior(&self, kind: BallReturn, turns: f64) -> f64 {
        let weight = |(_, weights): &(f64, [f64; 3])| weights[kind as usize];
        let sum: f64 = self.turns.iter().map(weight).sum();
        let alike = 1.0 / self.turns.len() as f64;
        let own = self.turns.iter().find(|(listed, _)| (listed - turns).abs() < 1e-9);
        let share = if sum > 0.0 { own.map_or(0.0, weight) / sum } else { alike };
        // q_t [0.98 v_ti/Σ v_ti + 0.02/23]                                (AB5)
        kind.probability() * ((1.0 - ALIKE_TURNS) * share + ALIKE_TURNS * alike)
    }

    /// Returns the ball diameters that are possible for a given nominal diameter and lead, each
    /// with the logarithm of its prior weight (AB4); lengths in mm.
    #[expect(clippy::cast_precision_loss, reason = "33 balls")]
    pub(super) fn fitting_balls(
        &self,
        nominal: f64,
        lead: f64,
    ) -> impl Iterator<Item = (f64, f64)> {
        let sum: f64 = self.balls.iter().map(|(_, weight)| weight).sum();
        // 0.05 d₀^¾ ≤ D_w ≤ min(0.82 P, 0.30 d₀)
        let sizes = 0.05 * nominal.powf(0.75)..=(0.82 * lead).min(0.30 * nominal);
        let fits = move |(ball, _): &(f64, f64)| sizes.contains(ball);
        self.balls.into_iter().filter(fits).map(move |(ball, weight)| {
            // 0.95 w/Σw + 0.05/33                                             (AB4)
            let popularity = (1.0 - ALIKE_BALLS) * weight / sum + ALIKE_BALLS / BALLS.len() as f64;
            (ball, popularity.ln())
        })
    }

    /// Returns the logarithm of the prior density of a ball diameter (AB3); lengths in mm.
    pub(super) fn ln_ball_size(&self, ball: f64, nominal: f64, lead: f64) -> f64 {
        let (of_lead, of_diameter) = self.usual_ball;
        // m = min(0.635 P, 0.159 d₀)                                          (AB3)
        ln_mixture(&BALL_SIZE, (ball / (of_lead * lead).min(of_diameter * nominal)).ln())
    }

    /// Returns all combinations of number of loaded turns and type of ball return, each with the
    /// logarithm of its prior probability. If the number of turns is given, only this number is
    /// used.
    pub(super) fn turns_and_returns(&self, given: Option<f64>) -> Vec<(f64, BallReturn, f64)> {
        let listed = self.turns.iter().map(|(turns, _)| *turns);
        let turns: Vec<f64> = given.map_or_else(|| listed.collect(), |turns| vec![turns]);
        let ln_prior = |kind: BallReturn, turns: f64| {
            if given.is_none() {
                return self.turns_prior(kind, turns).ln();
            }
            let weight = |kind: BallReturn| self.turns_prior(kind, turns) + MIN_RETURN_WEIGHT;
            // (v′ + 10⁻³)/Σ_t (v′ + 10⁻³)                                     (AB8)
            (weight(kind) / BallReturn::ALL.map(weight).iter().sum::<f64>()).ln()
        };
        let pairs = turns.into_iter().flat_map(|turns| BallReturn::ALL.map(|kind| (turns, kind)));
        pairs.map(|(turns, kind)| (turns, kind, ln_prior(kind, turns))).collect()
    }
}

/// Returns the listed ball diameter \[mm\] that is nearest to the given diameter \[mm\]. Catalogs
/// print rounded diameters.
fn nearest_ball(diameter: f64) -> f64 {
    let distance = |ball: f64| (ball / diameter).ln().abs();
    let sizes = BALLS.map(|(ball, _)| ball);
    sizes.into_iter().fold(
        sizes[0],
        |best, ball| {
            if distance(ball) < distance(best) { ball } else { best }
        },
    )
}

/// Result of comparing the given ratings with the ratings of a trial nut.
pub(super) struct RatingFit {
    /// Logarithm of the likelihood of the given ratings.
    pub(super) ln_likelihood: f64,
    /// Logarithm of the loaded fraction of a turn.
    pub(super) ln_loaded_share: f64,
    /// Excess `$e$` of the dynamic rating; `None` without a static rating.
    pub(super) excess: Option<f64>,
}

impl RatingFit {
    /// Compares the given ratings with the ratings of a trial nut whose turns are completely filled
    /// with balls (AB1). `ln_dynamic` and `ln_static` are the logarithms of the given ratings
    /// divided by the ratings of the trial nut.
    ///
    /// * `share`: probability distribution of the logarithm of the loaded fraction of a turn.
    pub(super) fn new(ln_dynamic: f64, ln_static: Option<f64>, share: Normal) -> Self {
        if let Some(ln_static) = ln_static {
            // e = r_a − ⅔ r₀                                              (AB1)
            let excess = ln_dynamic - 2.0 / 3.0 * ln_static;
            return Self {
                // φ(r₀; ln s_t, σ_t) [0.82 φ(e; 0, 0.028) + …]            (AB6)
                ln_likelihood: share.ln_density(ln_static) + ln_mixture(&EXCESS, excess),
                ln_loaded_share: ln_static,
                excess: Some(excess),
            };
        }
        // S² = 4/9 σ_t² + 0.028² + 0.05²,
        // ln N/(n i) = ln s_t + 2σ_t²/(3 S²) (r_a − ⅔ ln s_t)              (AB7)
        let variance = 4.0 / 9.0 * share.deviation.powi(2) + EXCESS_VARIANCE;
        let known = Normal { mean: 2.0 / 3.0 * share.mean, deviation: variance.sqrt() };
        let gain = 2.0 * share.deviation.powi(2) / (3.0 * variance);
        Self {
            ln_likelihood: known.ln_density(ln_dynamic),
            ln_loaded_share: share.mean + gain * (ln_dynamic - known.mean),
            excess: None,
        }
    }
}

/// Returns the logarithm of the probability density of a core diameter (AB9); lengths in mm.
pub(super) fn ln_core(core: f64, nominal: f64, ball: f64) -> f64 {
    // [0.9 φ(x; 0.85, 0.055) + 0.1 φ(x; 0.85, 0.25)]/D_w,  x = (d₀ − d_core)/D_w   (AB9)
    ln_mixture(&CORE_DEPTH, (nominal - core) / ball) - ball.ln()
}

/// Returns the logarithm of the probability density of a pitch circle diameter (AB10); lengths in
/// mm.
pub(super) fn ln_pitch_diameter(pitch_diameter: f64, nominal: f64, ball: f64) -> f64 {
    // φ((D_pw − d₀)/D_w; 0.25, 0.03)/D_w                                  (AB10)
    PITCH_RISE.ln_density((pitch_diameter - nominal) / ball) - ball.ln()
}

/// Converts standard normal random numbers into the groove quantities that catalogs do not print
/// (AB12).
pub(super) fn unprinted([conformity, angle, pitch, balls]: [f64; 4]) -> Unprinted {
    // f = 0.5 + 0.02 e^{0.35 z},  β = 45° + 2.5° z,  D_pw = d₀ + (0.25 + 0.03 z) D_w,  N e^{0.05 z}   (AB12)
    let at = |normal: Normal, z: f64| normal.mean + normal.deviation * z;
    let over_half = CONFORMITY_OVER_HALF * (CONFORMITY_LN_DEVIATION * conformity).exp();
    Unprinted {
        conformity: (0.5 + over_half).clamp(CONFORMITIES.0, CONFORMITIES.1),
        contact_angle: at(CONTACT_ANGLE, angle).to_radians(),
        pitch_rise: at(PITCH_RISE, pitch),
        loaded_balls_factor: (LOADED_BALLS_LN_DEVIATION * balls).exp(),
    }
}

/// Groove quantities that catalogs do not print.
pub(super) struct Unprinted {
    /// Conformity.
    pub(super) conformity: f64,
    /// Contact angle \[rad\].
    pub(super) contact_angle: f64,
    /// Difference between pitch circle diameter and nominal diameter, divided by the ball diameter.
    pub(super) pitch_rise: f64,
    /// Random factor for the number of loaded balls.
    pub(super) loaded_balls_factor: f64,
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    /// The prior probabilities of all listed combinations of turns and ball return add up to one.
    /// For any given number of turns, the prior probabilities of the ball returns also add up to
    /// one.
    #[test]
    fn prior_probabilities_sum_to_one() {
        for given in [None, Some(4.0), Some(4.2)] {
            let sum: f64 =
                Prior::USUAL.turns_and_returns(given).iter().map(|(_, _, ln)| ln.exp()).sum();
            assert_relative_eq!(sum, 1.0, max_relative = 1e-12);
        }
    }

    /// The central 90 % of the conformities lie between 0.511 and 0.536, and the central 90 % of
    /// the contact angles lie between 41 and 49 deg.
    #[test]
    fn central_90_percent_of_quantities_missing_in_catalogs_lie_in_their_expected_ranges() {
        let [low, high] = [-1.644_854, 1.644_854].map(|z| unprinted([z, z, 0.0, 0.0]));
        assert!((low.conformity - 0.5112).abs() < 1e-4 && (high.conformity - 0.5356).abs() < 1e-4);
        assert!((low.contact_angle.to_degrees() - 40.888).abs() < 1e-3);
        assert!((high.contact_angle.to_degrees() - 49.112).abs() < 1e-3);
        assert!((unprinted([9.0, 0.0, 0.0, 0.0]).conformity - 0.56).abs() < 1e-15);
    }
}
