//! Many nuts like one: what scattered balls and errors of the lead make of it.

use std::f64::consts::TAU;

use bsm_nut::{BallNut, LeadError};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use serde_json::{Map, Value, json};

use super::problem::NutProblem;
use super::report::QUANTITIES;
use crate::CaseError;

/// Quantities of the samples: those of a nut that its errors change.
const SAMPLED: [&str; 6] = [
    "max_contact_load_N",
    "max_over_mean",
    "unloaded_balls",
    "max_pressure_MPa",
    "nut_stiffness_N_um",
    "life_revolutions",
];

/// Samples at most.
const MOST: u64 = 1_000_000;

/// Numbers of many nuts whose balls, and the phases of whose lead errors, are drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    /// Nuts that carry their load.
    pub carried: usize,
    /// Nuts that do not, or whose preload cannot be set.
    pub failed: usize,
    /// Name, unit, meaning and quantiles of each quantity.
    pub rows: Vec<(&'static str, &'static str, &'static str, [f64; 5])>,
}

impl Samples {
    /// The parts of the samples that lie below the quantiles.
    pub const PARTS: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];

    /// Solves `number` nuts like the one of a problem; each follows from the seed and its own number
    /// alone, whatever the threads.
    ///
    /// # Errors
    ///
    /// [`CaseError::BadEntry`] if nothing of the nut scatters, [`CaseError::OutOfRange`] for no samples
    /// or too many.
    pub fn of(problem: &NutProblem, number: u64, seed: Option<u64>) -> Result<Self, CaseError> {
        if number == 0 || number > MOST {
            let rule = format!("from 1 to {MOST}");
            #[expect(clippy::cast_precision_loss, reason = "a number in a message")]
            let value = number as f64;
            return Err(CaseError::OutOfRange { key: "samples".to_owned(), value, rule });
        }
        let wave =
            |(i, error): (usize, &LeadError)| matches!(error, LeadError::Wave { .. }).then_some(i);
        let waves: Vec<_> = problem.nut.errors.lead.iter().enumerate().filter_map(wave).collect();
        if !problem.scatters() && waves.is_empty() {
            let what =
                "is required by samples, or a wave in lead_error: without them all nuts are alike";
            let key = "ball_deviation_sd_um".to_owned();
            return Err(CaseError::BadEntry { key, what: what.to_owned() });
        }
        let seed = seed.unwrap_or(problem.seed);
        let solved: Vec<_> = (0..number)
            .into_par_iter()
            .map(|i| {
                let one = problem.drawn(seed, i, &waves);
                Some(one.some(one.carried().ok()?, &SAMPLED))
            })
            .collect();
        let carried: Vec<_> = solved.iter().flatten().collect();
        let quantity = |(i, name): (usize, &&'static str)| {
            let quantity = QUANTITIES.iter().find(|quantity| quantity.key == *name)?;
            let mut values: Vec<_> = carried.iter().filter_map(|numbers| numbers[i]).collect();
            values.sort_by(f64::total_cmp);
            let quantiles = Self::PARTS.map(|part| quantile(&values, part));
            (!values.is_empty()).then_some((quantity.key, quantity.unit, quantity.about, quantiles))
        };
        Ok(Self {
            carried: carried.len(),
            failed: solved.len() - carried.len(),
            rows: SAMPLED.iter().enumerate().filter_map(quantity).collect(),
        })
    }

    /// JSON object: each quantity with its quantiles.
    pub fn to_json(&self) -> Value {
        let row = |(name, _, _, quantiles): &(&str, _, _, [f64; 5])| {
            let parts =
                Self::PARTS.iter().map(|part| format!("{part}")).zip(quantiles.map(|q| json!(q)));
            ((*name).to_owned(), Value::Object(parts.collect()))
        };
        let rows: Map<_, _> = self.rows.iter().map(row).collect();
        json!({ "carried": self.carried, "failed": self.failed, "quantiles": rows })
    }
}

/// Between the two nearest of sorted values.
fn quantile(sorted: &[f64], part: f64) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "numbers of samples")]
    let place = part * sorted.len().saturating_sub(1) as f64;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place")]
    let low = place as usize;
    let share = place.fract();
    let at = |place: usize| sorted.get(place).or(sorted.last()).copied().unwrap_or(f64::NAN);
    at(low) * (1.0 - share) + at(low + 1) * share
}

/// Draws the balls of a nut and the phases of some errors of its lead.
///
/// * `deviation`: standard deviation of the excess of the radius \[m\]. * `number`: of the nut among those
///   of the seed.
pub(super) fn draw(nut: &mut BallNut, deviation: f64, waves: &[usize], seed: u64, number: u64) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(number);
    if deviation > 0.0 {
        nut.errors.balls = (0..nut.balls()).map(|_| deviation * normal(&mut rng)).collect();
    }
    for wave in waves {
        if let LeadError::Wave { phase, .. } = &mut nut.errors.lead[*wave] {
            *phase = rng.random_range(0.0..TAU);
        }
    }
}

/// A draw of the standard normal distribution, by Box and Muller.
fn normal(rng: &mut impl Rng) -> f64 {
    // The first is never 0.
    let (size, turn) = (1.0 - rng.random::<f64>(), rng.random::<f64>());
    (-2.0 * size.ln()).sqrt() * (TAU * turn).cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: places between the values share them.
    #[test]
    fn quantiles_lie_between_values() {
        assert!((quantile(&[1.0, 2.0, 4.0], 0.25) - 1.5).abs() < 1e-15);
        assert!((quantile(&[1.0, 2.0, 4.0], 0.75) - 3.0).abs() < 1e-15);
        assert!((quantile(&[3.0], 0.95) - 3.0).abs() < 1e-15);
    }

    /// Mean and deviation of 20 000 draws within five standard errors, 5/√N and 5/√(2N).
    #[test]
    fn draws_are_normal() {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let draws: Vec<_> = (0..20_000).map(|_| normal(&mut rng)).collect();
        let mean = draws.iter().sum::<f64>() / 2e4;
        let square = draws.iter().map(|x| x * x).sum::<f64>() / 2e4;
        assert!(mean.abs() < 0.036, "{mean}");
        assert!((square.sqrt() - 1.0).abs() < 0.025, "{square}");
    }
}
