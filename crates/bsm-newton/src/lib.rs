//! Algorithms for nonlinear equations that know nothing of what the equations mean.
//!
//! * [`solve`]: damped Newton iteration, for a few [`Equations`].
//! * [`Dense`], [`BorderedMatrix`]: the matrices, dense or of many small blocks with a border.
//! * [`Bracket`]: the root of one variable between two places of different sign.
//! * [`implicit_slopes`], [`follow`], [`trace`]: how a root moves with its parameters, a little, far, and through folds.
//!
//! Problem, algorithm, memory ([`Workspace`]), options ([`Options`]) and outcome ([`Report`]) are
//! separate types. Nothing is printed, nothing is allocated inside an iteration, and every outcome
//! is data. The crate is the only one that names faer.
//!
//! Theory: `docs/theory/05-newton.md`, (N1) to (N15).

mod bracket;
mod continuation;
mod equations;
mod error;
mod implicit;
mod linear;
mod options;
mod path;
mod report;
mod solve;

pub use bracket::{Bracket, FunctionValue, Root, RootResult};
pub use continuation::{Continuation, follow};
pub use equations::Equations;
pub use error::{EvalError, Singular};
pub use implicit::implicit_slopes;
pub use linear::{BorderedBlock, BorderedMatrix, Dense, DynamicDense};
pub use options::{JacobianUpdate, Options, Scales};
pub use path::{EventRoot, Homotopy, PathEnd, Seed, StepControl, Trace, path_direction, trace};
pub use report::{Report, Step, Termination};
pub use solve::{ARMIJO, Workspace, solve};
