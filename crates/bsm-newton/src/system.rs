//! What a model provides.

use std::array::from_fn;

use crate::{Dense, EvalError, LinearSolver};

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

    /// Name of equation `i`, for reports.
    fn equation(&self, i: usize) -> String {
        format!("equation {i}")
    }
}

/// A square system `$F(x) = 0$` whose Jacobian has a structure of its own.
///
/// Implementations are pure: equal `x` gives bit-equal output.
pub trait System {
    /// The matrix that holds the Jacobian.
    type Jacobian: LinearSolver;

    /// Writes `$F(x)$` into `r`.
    ///
    /// # Errors
    ///
    /// [`EvalError`] if `x` is outside the model's domain, as in [`Equations::residual`].
    fn residual(&self, x: &VectorOf<Self>, r: &mut VectorOf<Self>) -> Result<(), EvalError>;

    /// Writes `$F(x)$` into `r` and every entry of its Jacobian into `jacobian`.
    ///
    /// # Errors
    ///
    /// As [`residual`](Self::residual).
    fn linearize(
        &self,
        x: &VectorOf<Self>,
        r: &mut VectorOf<Self>,
        jacobian: &mut Self::Jacobian,
    ) -> Result<(), EvalError>;

    /// Writes where a part `lambda` of the Newton step `dx` leads to, as [`Equations::retract`], into `to`.
    fn retract(
        &self,
        x: &VectorOf<Self>,
        dx: &VectorOf<Self>,
        lambda: f64,
        to: &mut VectorOf<Self>,
    ) {
        for ((to, x), dx) in to.as_mut().iter_mut().zip(x.as_ref()).zip(dx.as_ref()) {
            *to = x + lambda * dx;
        }
    }

    /// Name of equation `i`, for reports.
    fn equation(&self, i: usize) -> String {
        format!("equation {i}")
    }
}

/// Vector of the unknowns of a system.
pub type VectorOf<S> = <<S as System>::Jacobian as LinearSolver>::Vector;

/// Equations as a system with a dense matrix.
pub(crate) struct Square<'a, const N: usize, E: ?Sized>(pub(crate) &'a E);

impl<const N: usize, E: Equations<N> + ?Sized> System for Square<'_, N, E> {
    type Jacobian = Dense<N>;

    fn residual(&self, x: &[f64; N], r: &mut [f64; N]) -> Result<(), EvalError> {
        *r = self.0.residual(x)?;
        Ok(())
    }

    fn linearize(
        &self,
        x: &[f64; N],
        r: &mut [f64; N],
        jacobian: &mut Dense<N>,
    ) -> Result<(), EvalError> {
        *r = self.0.linearize(x, jacobian.rows_mut())?;
        Ok(())
    }

    fn retract(&self, x: &[f64; N], dx: &[f64; N], lambda: f64, to: &mut [f64; N]) {
        *to = self.0.retract(x, dx, lambda);
    }

    fn equation(&self, i: usize) -> String {
        self.0.equation(i)
    }
}
