//! Interface between physical models and the Newton solver.

use std::array::from_fn;

use crate::EvalError;

/// A small system of `N` equations `$F(x) = 0$` in `N` unknowns with a dense Jacobian.
///
/// Implementations must be pure functions: identical inputs give bit-identical results.
pub trait Equations<const N: usize> {
    /// Additional quantities that are calculated together with the residual and that the caller
    /// needs at the solution, such as forces. Use `()` if there are none.
    type Details;

    /// Additional quantities that are calculated together with the Jacobian, such as derivatives of
    /// the details. Use `()` if there are none.
    type Slopes;

    /// Returns `$F(x)$` and the details.
    ///
    /// # Errors
    ///
    /// Returns [`EvalError`] if `x` is outside the domain of the model. The solver then tries a
    /// shorter step.
    fn residual(&self, x: &[f64; N]) -> Result<([f64; N], Self::Details), EvalError>;

    /// Writes the rows of the Jacobian `$J_{ij} = \partial F_i/\partial x_j$` and returns `$F(x)$`,
    /// the [details](Self::Details) and the [slopes](Self::Slopes).
    ///
    /// # Errors
    ///
    /// Returns the same errors as [`residual`](Self::residual).
    fn linearize(&self, x: &[f64; N], rows: &mut [[f64; N]; N]) -> Linearized<N, Self>;

    /// Writes the rows of the Jacobian at a point whose residual is already known. Returns the
    /// additional quantities that belong to the Jacobian ([`Slopes`](Self::Slopes)).
    ///
    /// The default implementation calls [`linearize`](Self::linearize), which evaluates the
    /// residual again.
    ///
    /// # Errors
    ///
    /// Returns the same errors as [`residual`](Self::residual).
    fn jacobian(&self, x: &[f64; N], rows: &mut [[f64; N]; N]) -> Result<Self::Slopes, EvalError> {
        let (_, _, slopes) = self.linearize(x, rows)?;
        Ok(slopes)
    }

    /// Returns the trial point for a fraction `lambda` of the Newton step `dx` (N15).
    ///
    /// The default implementation moves along a straight line. An implementation may follow another
    /// curve with the same tangent at `lambda = 0` if the curve passes closer to the solution.
    fn retract(&self, x: &[f64; N], dx: &[f64; N], lambda: f64) -> [f64; N] {
        from_fn(|i| x[i] + lambda * dx[i])
    }

    /// Returns the fraction of the Newton step `dx` that is tried first, in (0, 1].
    ///
    /// The default implementation returns 1, which is the full step.
    fn max_step_length(&self, _x: &[f64; N], _dx: &[f64; N]) -> f64 {
        1.0
    }

    /// Returns the name of equation `i` for reports.
    fn equation(&self, i: usize) -> String {
        format!("equation {i}")
    }
}

/// Result of [`Equations::linearize`]: the residual, the [details](Equations::Details) and the
/// [slopes](Equations::Slopes).
pub type Linearized<const N: usize, E> =
    Result<([f64; N], <E as Equations<N>>::Details, <E as Equations<N>>::Slopes), EvalError>;
