//! Error types of evaluations and factorizations.

use thiserror::Error;

/// The model cannot be evaluated at this `x`; a shorter step may do.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error("{quantity} = {value:e} is outside the model's domain: {requirement}")]
pub struct EvalError {
    /// Quantity that left its range, with its unit, such as `clearance [m]`.
    pub quantity: &'static str,
    /// Its value.
    pub value: f64,
    /// What it must satisfy.
    pub requirement: &'static str,
}

/// A matrix has a pivot that is zero or not finite.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("a pivot of the matrix is zero or not finite")]
pub struct Singular;
