//! Quantiles and intervals of results, least squares, and the runs test for residuals.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

use bsm_newton::Bracket;

pub use crate::least_squares::{LeastSquares, least_squares};
pub use crate::runs::SignRuns;

/// A normal distribution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Normal {
    /// Mean.
    pub(crate) mean: f64,
    /// Standard deviation, positive.
    pub(crate) deviation: f64,
}

impl Normal {
    /// Returns the logarithm of the probability density at `x`.
    pub(crate) fn ln_density(self, x: f64) -> f64 {
        let z = (x - self.mean) / self.deviation;
        -0.5 * (z * z + TAU.ln()) - self.deviation.ln()
    }
}

/// Returns the logarithm of a weighted sum of normal densities at `x`. The result is finite even if
/// `x` is far from all means.
pub(crate) fn ln_mixture<const N: usize>(parts: &[(f64, Normal); N], x: f64) -> f64 {
    ln_sum(parts.map(|(weight, normal)| weight.ln() + normal.ln_density(x)))
}

/// Returns the logarithm of the sum of numbers whose logarithms are given. Returns minus infinity
/// if there are no numbers.
pub(crate) fn ln_sum(logarithms: impl IntoIterator<Item = f64, IntoIter: Clone>) -> f64 {
    let logarithms = logarithms.into_iter();
    let largest = logarithms.clone().fold(f64::NEG_INFINITY, f64::max);
    if largest == f64::NEG_INFINITY {
        return largest;
    }
    largest + logarithms.map(|ln| (ln - largest).exp()).sum::<f64>().ln()
}

/// Returns the quantile of the standard normal distribution for a probability between 1e-18 and 1 -
/// 1e-15.
pub(crate) fn normal_quantile(probability: f64) -> f64 {
    // The derivative is the probability density, which lets the root finder use Newton steps.
    let excess = |z: f64| {
        let cumulative = 0.5 * libm::erfc(-z * FRAC_1_SQRT_2);
        (cumulative - probability, Normal { mean: 0.0, deviation: 1.0 }.ln_density(z).exp())
    };
    // At the ends of the bracket, the cumulative probabilities are 1.1e-19 and 1 (in double
    // precision).
    let ends = [-9.0, 9.0];
    let bracket = Bracket { start: Some(0.0), ..Bracket::new(ends, ends.map(|z| excess(z).0)) };
    bracket.root(excess).root().expect("the probability is inside the bracket").x
}

/// Returns the quantile of sorted values for a probability in \[0, 1\], interpolated linearly
/// between the two neighboring values. Returns NaN if there are no values.
pub fn quantile(sorted: &[f64], probability: f64) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "far below 2^53 values")]
    let place = probability * sorted.len().saturating_sub(1) as f64;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the value is an index into the slice"
    )]
    let low = place as usize;
    let share = place.fract();
    let at = |place: usize| sorted.get(place).or(sorted.last()).copied().unwrap_or(f64::NAN);
    at(low) * (1.0 - share) + at(low + 1) * share
}

/// Interval that contains 90 % of the values of a result.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Lower end of the band (5 % quantile).
    pub low: f64,
    /// Upper end of the band (95 % quantile).
    pub high: f64,
}

impl Band {
    /// Returns the band of the given values, or `None` if there are no values.
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

    /// Hand calculation: quantiles between two values are interpolated linearly.
    #[test]
    fn quantiles_are_interpolated_linearly() {
        assert!((quantile(&[1.0, 2.0, 4.0], 0.25) - 1.5).abs() < 1e-15);
        assert!((quantile(&[1.0, 2.0, 4.0], 0.75) - 3.0).abs() < 1e-15);
        assert!((quantile(&[3.0], 0.95) - 3.0).abs() < 1e-15);
        assert!(quantile(&[], 0.5).is_nan());
    }

    /// The quantiles match all ten digits in the table of Abramowitz and Stegun (26.5).
    #[test]
    fn normal_quantiles_match_tables() {
        for (probability, expected) in [
            (0.5, 0.0),
            (0.95, 1.644_853_627),
            (0.025, -1.959_963_985),
            (0.999, 3.090_232_306),
            (1e-10, -6.361_340_902),
        ] {
            assert!((normal_quantile(probability) - expected).abs() < 1e-9, "{probability}");
        }
    }

    /// At a distance of 1000 standard deviations from both means, the density underflows, but its
    /// logarithm is still finite.
    #[test]
    fn log_density_of_a_mixture_is_finite_far_from_its_means() {
        let [one, other] =
            [(0.0, 1.0), (1.0, 2.0)].map(|(mean, deviation)| Normal { mean, deviation });
        let mixture = [(0.3, one), (0.7, other)];
        let at = |x: f64| 0.3 * one.ln_density(x).exp() + 0.7 * other.ln_density(x).exp();
        assert_relative_eq!(ln_mixture(&mixture, 0.5), at(0.5).ln(), max_relative = 1e-14);
        assert_relative_eq!(
            ln_mixture(&mixture, 2e3),
            0.7_f64.ln() + other.ln_density(2e3),
            max_relative = 1e-14
        );
        assert!(ln_sum([]).is_infinite());
    }
}
