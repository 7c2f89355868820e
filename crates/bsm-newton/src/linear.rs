//! Matrices with their structure. Each is filled, factorized in place and solved with, in memory of its own.
//!
//! Small pivots are no reason to give up: an unknown may legitimately act a hundred million times more weakly than the
//! others, and the residual decides about success.

mod bordered;
mod dense;
mod dynamic;

pub use bordered::{BorderedBlock, BorderedMatrix};
pub use dense::Dense;
pub use dynamic::DynamicDense;
