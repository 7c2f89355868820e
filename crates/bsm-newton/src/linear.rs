//! Matrices with their structure, and what the Newton iteration asks of them.

mod bordered;
mod dense;
mod dynamic;

use crate::Singular;

pub use bordered::{Block, Bordered};
pub use dense::Dense;
pub use dynamic::DynamicDense;

/// A square matrix that is filled, factorized in place and solved with, in memory of its own: none
/// of the methods but [`zeros`](Self::zeros) allocates.
pub trait LinearSolver {
    /// A vector of the size of the matrix.
    type Vector: AsRef<[f64]> + AsMut<[f64]> + Clone;

    /// A vector of zeros.
    fn zeros(&self) -> Self::Vector;

    /// Multiplies row `i` by `scale[i]`.
    fn scale_rows(&mut self, scale: &Self::Vector);

    /// Factorizes the matrix.
    ///
    /// Small pivots are no reason to give up: an unknown may legitimately act a hundred million
    /// times more weakly than the others, and the residual decides about success.
    ///
    /// # Errors
    ///
    /// [`Singular`] if a pivot is zero or not finite.
    fn factorize(&mut self) -> Result<(), Singular>;

    /// Overwrites `rhs` with the solution. Before [`factorize`](Self::factorize) has succeeded the
    /// result means nothing.
    fn solve(&mut self, rhs: &mut Self::Vector);
}
