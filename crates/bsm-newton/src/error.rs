//! Three kinds of failure, three types: misuse, model domain, no solution.

use thiserror::Error;

use crate::Report;

/// The call was wrong; no iteration was done. A bug in the caller.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum UsageError {
    /// A slice or workspace does not have the size of the system.
    #[error("`{name}` has length {found}, the system has {expected} unknowns")]
    Dimension {
        /// Name of the argument.
        name: &'static str,
        /// Length that it should have.
        expected: usize,
        /// Length that it has.
        found: usize,
    },
    /// A scale is zero, negative or not finite.
    #[error("scale `{name}[{index}]` = {value} is not positive and finite")]
    Scale {
        /// `x` or `f`.
        name: &'static str,
        /// Index of the entry.
        index: usize,
        /// Its value.
        value: f64,
    },
}

/// The model cannot be evaluated at this `x`; a shorter step may do.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error("{quantity} = {value:e} is outside the model's domain: {requirement}")]
pub struct EvalError {
    /// Quantity that left its range, with its unit, such as `slip speed at A [m/s]`.
    pub quantity: &'static str,
    /// Its value.
    pub value: f64,
    /// What it must satisfy.
    pub requirement: &'static str,
}

/// The solve ended without a solution; the report says how.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{0}")]
pub struct NotConverged(pub Box<Report>);
