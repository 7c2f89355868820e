//! What a model provides.

use faer::MatMut;

use crate::EvalError;

/// A square system `$F(x) = 0$`, `$F: \mathbb{R}^n \to \mathbb{R}^n$`.
///
/// Implementations are pure: equal `x` gives bit-equal output.
pub trait System {
    /// Number of unknowns and equations `$n$`.
    fn dim(&self) -> usize;

    /// Writes `$F(x)$` into `r`; `x` and `r` have length [`dim`](Self::dim).
    ///
    /// # Errors
    ///
    /// [`EvalError`] if `x` is outside the model's domain. The solver then shortens the step and
    /// tries again.
    fn residual(&self, x: &[f64], r: &mut [f64]) -> Result<(), EvalError>;

    /// Writes `$F(x)$` into `r` and `$J_{ij} = \partial F_i/\partial x_j$` into `jac` (`n`×`n`).
    ///
    /// # Errors
    ///
    /// As [`residual`](Self::residual).
    fn linearize(&self, x: &[f64], r: &mut [f64], jac: MatMut<'_, f64>) -> Result<(), EvalError>;

    /// Equation `i` in words, for reports.
    fn equation(&self, i: usize) -> String {
        format!("equation {i}")
    }
}
