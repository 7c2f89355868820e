//! Kinds of failure, one type each: misuse, model domain, singular matrix, no solution.

use thiserror::Error;

use crate::Report;

/// A vector does not have the size of the system. A bug in the caller; no iteration was done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("`{name}` has length {found}, the system has {expected} unknowns")]
pub struct DimensionError {
    /// Name of the argument.
    pub name: &'static str,
    /// Length that it should have.
    pub expected: usize,
    /// Length that it has.
    pub found: usize,
}

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
#[error("pivot {pivot} of the matrix is zero or not finite")]
pub struct Singular {
    /// Number of the pivot in the order of elimination.
    pub pivot: usize,
}

/// The solve ended without a solution; the report says how.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{0}")]
pub struct NotConverged(pub Box<Report>);
