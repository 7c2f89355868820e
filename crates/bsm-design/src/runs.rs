//! Test of the runs of equal signs (Wald-Wolfowitz runs test), which shows whether residuals are
//! random or systematic.
//!
//! Theory: `docs/theory/12-sensitivities.md`, equation (V8).

/// Runs of equal signs in a sequence of residuals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SignRuns {
    /// Number of runs of equal signs.
    pub runs: usize,
    /// Probability that there are at most this many runs if all orders of the signs are equally
    /// likely (Wald and Wolfowitz).
    pub probability: f64,
}

impl SignRuns {
    /// Counts the runs of equal signs in a sequence of residuals. Residuals that are zero are
    /// skipped.
    ///
    /// Returns `None` unless both signs occur.
    pub fn of(residuals: impl IntoIterator<Item = f64>) -> Option<Self> {
        let signed = residuals.into_iter().filter(|residual| residual.abs() > 0.0);
        let above: Vec<bool> = signed.map(|residual| residual > 0.0).collect();
        let positive = above.iter().filter(|above| **above).count();
        let negative = above.len() - positive;
        if positive == 0 || negative == 0 {
            return None;
        }
        let runs = 1 + above.windows(2).filter(|pair| pair[0] != pair[1]).count();
        let probability = (2..=runs).map(|runs| part(runs, [positive, negative])).sum();
        Some(Self { runs, probability })
    }
}

/// Returns the fraction of all orders of the signs that have exactly the given number of runs.
fn part(runs: usize, signs: [usize; 2]) -> f64 {
    // Positive and negative runs alternate, so their numbers differ by at most one.
    let (few, many) = (runs / 2, runs - runs / 2);
    let ways = |of: [usize; 2]| -> f64 {
        (0..2).map(|i| ln_binomial(signs[i] - 1, of[i] - 1)).sum::<f64>()
    };
    // p(R) = Σ C(n₊ − 1, k − 1) C(n₋ − 1, R − k − 1)/C(n₊ + n₋, n₊)        (V8)
    let all = ln_binomial(signs[0] + signs[1], signs[0]);
    (ways([few, many]) - all).exp() + (ways([many, few]) - all).exp()
}

/// Returns the natural logarithm of the binomial coefficient of `n` and `k`, or minus infinity if
/// `k` exceeds `n`.
fn ln_binomial(n: usize, k: usize) -> f64 {
    if k > n {
        return f64::NEG_INFINITY;
    }
    #[expect(clippy::cast_precision_loss, reason = "a number of measurements")]
    let ratio = |i: usize| ((n - k + i) as f64 / i as f64).ln();
    (1..=k).map(ratio).sum()
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    /// Example of Wald and Wolfowitz: of the 70 arrangements of four positive and four negative
    /// signs, 2 have two runs, 6 have three runs and 18 have four runs.
    #[test]
    fn probabilities_of_the_number_of_runs_match_counted_sign_sequences() {
        let of = |signs: &[f64]| SignRuns::of(signs.iter().copied()).expect("both signs");
        let two = of(&[1.0, 2.0, 0.5, 1.0, -1.0, -3.0, -1.0, -0.1]);
        assert_eq!(two.runs, 2);
        // The tolerance allows for rounding errors of logarithms whose magnitude is about ten.
        assert_relative_eq!(two.probability, 2.0 / 70.0, max_relative = 1e-13);
        let three = of(&[-1.0, -1.0, 1.0, 1.0, 1.0, 1.0, 0.0, -1.0, -1.0]);
        assert_eq!(three.runs, 3);
        assert_relative_eq!(three.probability, 8.0 / 70.0, max_relative = 1e-13);
        let all = of(&[1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0]);
        assert_relative_eq!(all.probability, 1.0, max_relative = 1e-13);
        assert_eq!(SignRuns::of([1.0, 2.0, 0.0]), None);
    }
}
