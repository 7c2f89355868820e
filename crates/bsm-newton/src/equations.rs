//! What a model provides.

use std::array::from_fn;

use crate::EvalError;

/// `N` equations `$F(x) = 0$` of `N` unknowns, a handful, with a dense Jacobian.
///
/// Implementations are pure: equal `x` gives bit-equal output.
pub trait Equations<const N: usize> {
    /// `$F(x)$`.
    ///
    /// # Errors
    ///
    /// [`EvalError`] if `x` is outside the model's domain. The solver then shortens the step and
    /// tries again.
    fn residual(&self, x: &[f64; N]) -> Result<[f64; N], EvalError>;

    /// `$F(x)$`; writes the rows of its Jacobian `$J_{ij} = \partial F_i/\partial x_j$`.
    ///
    /// # Errors
    ///
    /// As [`residual`](Self::residual).
    fn linearize(&self, x: &[f64; N], rows: &mut [[f64; N]; N]) -> Result<[f64; N], EvalError>;

    /// Where a part `lambda` of the Newton step `dx` leads to (N15).
    ///
    /// On a straight line, unless another curve with the same tangent at `lambda = 0` is nearer to the solution.
    fn retract(&self, x: &[f64; N], dx: &[f64; N], lambda: f64) -> [f64; N] {
        from_fn(|i| x[i] + lambda * dx[i])
    }

    /// The part of the Newton step `dx` that is tried first, at most one.
    fn first_part(&self, _x: &[f64; N], _dx: &[f64; N]) -> f64 {
        1.0
    }

    /// Name of equation `i`, for reports.
    fn equation(&self, i: usize) -> String {
        format!("equation {i}")
    }
}
