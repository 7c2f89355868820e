//! Random samples for tests, examples and benchmarks, and the number of samples. No other crate
//! depends on this crate.

use rand::{Rng, RngExt};

/// Distributions that extend the distributions of `rand`.
pub trait Sample: Rng {
    /// Returns a random number between two positive bounds with a uniform logarithm, so that every
    /// order of magnitude has the same probability.
    fn log_uniform(&mut self, low: f64, high: f64) -> f64 {
        (low.ln() + self.random::<f64>() * (high / low).ln()).exp()
    }
}

impl<R: Rng + ?Sized> Sample for R {}

/// Returns the number of points of a campaign: a tenth of `whole`, or all of them with
/// `CAMPAIGNS=whole` in the environment (`just campaigns`).
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

    /// A tenth of the numbers from 1e-6 to 1e4 lies in each decade, and no number lies outside of
    /// the bounds.
    #[test]
    fn every_decade_has_the_same_share_of_numbers() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut decades = [0_u32; 10];
        for _ in 0..10_000 {
            let x = rng.log_uniform(1e-6, 1e4);
            let decade = (0..10).find(|d| x < 10.0_f64.powi(d - 5)).expect("not above");
            assert!(x >= 1e-6, "{x}");
            decades[usize::try_from(decade).expect("not below")] += 1;
        }
        // Four standard deviations of a binomial count, sqrt(10_000 · 0.1 · 0.9) = 30.
        assert!(decades.iter().all(|count| count.abs_diff(1000) < 120), "{decades:?}");
    }
}
