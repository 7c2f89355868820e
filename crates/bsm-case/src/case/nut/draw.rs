//! Random draws of the quantities that vary from nut to nut.

use std::f64::consts::TAU;

use bsm_nut::{BallNut, LeadError};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Draws the ball radii of a nut and the phases of its lead errors.
///
/// * `deviation`: standard deviation of the ball radius \[m\].
/// * `number`: number of the nut among the nuts of a seed.
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

/// Draws from the standard normal distribution by the Box–Muller method.
fn normal(rng: &mut impl Rng) -> f64 {
    // The first random number is never 0 after this transformation, so that its logarithm is
    // finite.
    let (size, turn) = (1.0 - rng.random::<f64>(), rng.random::<f64>());
    (-2.0 * size.ln()).sqrt() * (TAU * turn).cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean and standard deviation of 20 000 draws are within five standard errors, 5/√N and
    /// 5/√(2N).
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
