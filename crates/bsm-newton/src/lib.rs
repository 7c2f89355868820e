//! Damped Newton iteration for any square system `$F(x) = 0$`.
//!
//! Problem ([`System`], [`Scales`]), algorithm ([`solve`]), memory ([`Workspace`]), options
//! ([`Options`]) and outcome ([`Report`]) are separate types. The crate knows nothing of what the
//! equations mean, prints nothing, and allocates nothing inside the iteration; it is the only
//! one that names faer.
//!
//! Theory: `docs/theory/05-newton.md`, inequalities (N1) to (N6) and equation (N7).

mod error;
mod implicit;
mod lu;
mod options;
mod report;
mod solve;
mod system;

pub use error::{EvalError, NotConverged, UsageError};
pub use faer::MatMut;
pub use implicit::implicit_slopes;
pub use options::{Options, Scales};
pub use report::{Report, Status, Step};
pub use solve::{Workspace, solve};
pub use system::System;
