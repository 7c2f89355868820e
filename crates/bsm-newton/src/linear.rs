//! Structured matrices. Each matrix is filled, factorized in place, and then used to solve linear
//! systems.
//!
//! Small pivots are not an error, because the effect of one unknown may be a hundred million times
//! smaller than the effects of the other unknowns. The residual shows whether a solution is
//! accurate.

mod bordered;
mod dense;
mod dynamic;

pub use bordered::{BorderedBlock, BorderedMatrix};
pub use dense::Dense;
pub use dynamic::DynamicDense;
