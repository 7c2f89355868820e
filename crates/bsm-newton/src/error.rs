//! Errors of model evaluations and matrix factorizations.

use thiserror::Error;

/// Error returned if a model cannot be evaluated at a point `x`.
///
/// If the solver takes a shorter step, the evaluation may succeed.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error("{quantity} = {value:e} is outside the model's domain: {requirement}")]
pub struct EvalError {
    /// Quantity that is outside its range, with its unit, for example `clearance [m]`.
    pub quantity: &'static str,
    /// Value of the quantity, in the unit given in `quantity`.
    pub value: f64,
    /// Condition that the quantity must satisfy.
    pub requirement: &'static str,
}

/// Error returned if a factorization fails because a pivot of the matrix is zero or not finite.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("a pivot of the matrix is zero or not finite")]
pub struct Singular;

/// Reason why a root has no derivatives with respect to the parameters.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum NoSlopes {
    /// The equations cannot be linearized at the root.
    #[error(transparent)]
    Refused(EvalError),
    /// The Jacobian is singular at the root.
    #[error("the Jacobian is singular at the root")]
    Singular(Singular),
}
