//! Random values of the quantities that vary from nut to nut.

use std::f64::consts::TAU;

use bsm_nut::{BallNut, LeadError};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Draws random ball radii, and random phases for the lead errors of a nut.
///
/// * `deviation`: standard deviation of the ball radius \[m\].
/// * `number`: index of the nut in the sequence of nuts with this seed.
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

/// Draws a number from the standard normal distribution by the Box–Muller method.
fn normal(rng: &mut impl Rng) -> f64 {
    // `size` is never 0, so its logarithm is finite.
    let (size, turn) = (1.0 - rng.random::<f64>(), rng.random::<f64>());
    (-2.0 * size.ln()).sqrt() * (TAU * turn).cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For N = 20 000 draws, the mean deviates from 0 by at most 5/√N, and the standard deviation
    /// deviates from 1 by at most 5/√(2N). These limits are five standard errors.
    #[test]
    fn normal_random_numbers_have_mean_0_and_standard_deviation_1() {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let draws: Vec<_> = (0..20_000).map(|_| normal(&mut rng)).collect();
        let mean = draws.iter().sum::<f64>() / 2e4;
        let square = draws.iter().map(|x| x * x).sum::<f64>() / 2e4;
        assert!(mean.abs() < 0.036, "{mean}");
        assert!((square.sqrt() - 1.0).abs() < 0.025, "{square}");
    }
}
