//! Random numbers for tests, examples and benchmarks, and the number of points in test campaigns.
//! Other crates use this crate only as a development dependency.

use rand::{Rng, RngExt};

/// Additional random distributions for the generators of the crate `rand`.
pub trait Sample: Rng {
    /// Returns a random number between two positive bounds. Its logarithm is uniformly distributed,
    /// so that every order of magnitude is equally likely.
    fn log_uniform(&mut self, low: f64, high: f64) -> f64 {
        (low.ln() + self.random::<f64>() * (high / low).ln()).exp()
    }
}

impl<R: Rng + ?Sized> Sample for R {}

/// Returns the number of points in a test campaign. It is a tenth of `whole`, or `whole` itself if
/// the environment variable `CAMPAIGNS` is set to `whole` (as in `just campaigns`).
pub fn campaign(whole: usize) -> usize {
    if std::env::var("CAMPAIGNS").is_ok_and(|value| value == "whole") {
        whole
    } else {
        whole.div_ceil(10)
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// Each decade from 1e-6 to 1e4 must contain a tenth of the random numbers, and no number may
    /// be outside the bounds.
    #[test]
    fn log_uniform_random_numbers_are_equally_frequent_in_every_decade() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut decades = [0_u32; 10];
        for _ in 0..10_000 {
            let x = rng.log_uniform(1e-6, 1e4);
            let decade = (0..10).find(|d| x < 10.0_f64.powi(d - 5)).expect("not above");
            assert!(x >= 1e-6, "{x}");
            decades[usize::try_from(decade).expect("not below")] += 1;
        }
        // The tolerance is four standard deviations of the binomial distribution. One standard
        // deviation is sqrt(10_000 · 0.1 · 0.9) = 30.
        assert!(decades.iter().all(|count| count.abs_diff(1000) < 120), "{decades:?}");
    }
}
