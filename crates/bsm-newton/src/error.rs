//! Error types of evaluations and factorizations.

use thiserror::Error;

/// Error of a model that cannot be evaluated at a point `x`.
///
/// The model may be defined at the end of a shorter step.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error("{quantity} = {value:e} is outside the model's domain: {requirement}")]
pub struct EvalError {
    /// Quantity that left its range, with its unit, such as `clearance [m]`.
    pub quantity: &'static str,
    /// Value of the quantity, in that unit.
    pub value: f64,
    /// Condition that the quantity must satisfy.
    pub requirement: &'static str,
}

/// Error of a factorization: a pivot of the matrix is zero or not finite.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("a pivot of the matrix is zero or not finite")]
pub struct Singular;
