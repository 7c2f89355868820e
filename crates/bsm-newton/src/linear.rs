//! Structured matrices. Each matrix is filled, factorized in place and used for solves in its own
//! memory.
//!
//! Small pivots are not an error: an unknown may legitimately have an effect a hundred million
//! times smaller than the others. The residual decides whether a solve succeeded.

mod bordered;
mod dense;
mod dynamic;

pub use bordered::{BorderedBlock, BorderedMatrix};
pub use dense::Dense;
pub use dynamic::DynamicDense;
