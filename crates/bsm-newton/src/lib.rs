//! Algorithms for nonlinear equations that are independent of the physical problem.
//!
//! * [`solve`]: damped Newton iteration for small systems of [`Equations`]. Its policies are
//!   separate objects: [`Convergence`] decides when the iteration stops, [`Backtracking`] selects
//!   the step length, and [`JacobianUpdate`] decides when the Jacobian is evaluated.
//! * [`Dense`], [`BorderedMatrix`]: dense matrices, and block tridiagonal matrices with a border.
//! * [`Bracket`]: root of a function of one variable between two points at which the function
//!   values have opposite signs.
//! * [`LaneNewton`]: Newton's method for several points side by side in SIMD vectors.
//! * [`implicit_slopes`]: derivatives of a root with respect to parameters.
//! * [`follow`], [`trace`]: natural parameter continuation, and pseudo-arclength continuation
//!   through folds.
//!
//! Problem ([`Equations`]), algorithm ([`solve`]), buffers ([`Workspace`]), policies ([`Options`])
//! and result ([`Outcome`]) are separate types. The crate prints nothing, does not allocate memory
//! during an iteration, and reports every failure in its return value. No other crate depends
//! directly on faer.
//!
//! Theory: `docs/theory/05-newton.md`, (N1) to (N17).
//!
//! This example calculates an intersection of the circle `$x^2 + y^2 = 2$` and the line `$x = y$`:
//!
//! ```
//! use bsm_newton::{Equations, EvalError, Linearized, Options, Scales, Workspace, solve};
//!
//! struct CircleAndLine;
//!
//! impl Equations<2> for CircleAndLine {
//!     type Details = ();
//!     type Slopes = ();
//!
//!     fn residual(&self, &[x, y]: &[f64; 2]) -> Result<([f64; 2], ()), EvalError> {
//!         Ok(([x * x + y * y - 2.0, x - y], ()))
//!     }
//!
//!     fn linearize(&self, z: &[f64; 2], rows: &mut [[f64; 2]; 2]) -> Linearized<2, Self> {
//!         let [x, y] = *z;
//!         *rows = [[2.0 * x, 2.0 * y], [1.0, -1.0]];
//!         Ok((self.residual(z)?.0, (), ()))
//!     }
//! }
//!
//! let (mut z, ones) = ([3.0, 0.5], [1.0; 2]);
//! let scales = Scales { x: &ones, f: &ones };
//! let work = &mut Workspace::default();
//! let outcome = solve(&CircleAndLine, &mut z, &scales, &Options::default(), work);
//! assert!(outcome.converged() && (z[0] - 1.0).abs() < 1e-9);
//! ```

mod bracket;
mod continuation;
mod equations;
mod error;
mod implicit;
mod lanes;
mod linear;
mod options;
mod path;
mod report;
mod solve;

pub use bracket::{Bracket, FunctionValue, Root, RootResult};
pub use continuation::{Continuation, follow};
pub use equations::{Equations, Linearized};
pub use error::{EvalError, NoSlopes, Singular};
pub use implicit::implicit_slopes;
pub use lanes::{LaneEquations, LaneIterate, LaneNewton, LaneStep, cramer};
pub use linear::{BorderedBlock, BorderedMatrix, Dense, DynamicDense};
pub use options::{ARMIJO, Backtracking, Convergence, JacobianUpdate, Options, Progress, Scales};
pub use path::{
    CurveEquations, EventRoot, PathEnd, Seed, StepControl, Trace, path_direction, trace,
};
pub use report::{Report, Step, Termination, WorstEquation};
pub use solve::{Outcome, Workspace, solve};
