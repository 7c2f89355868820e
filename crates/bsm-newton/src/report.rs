//! Status, cost and path of a solve.

use std::error::Error;
use std::fmt;

use crate::Options;

/// Why the iteration ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Termination {
    /// The scaled residual met `residual_tol` (N1).
    Converged,
    /// The maximum number of steps was taken.
    MaxSteps,
    /// No step length gave a sufficient decrease (N5).
    LineSearchFailed,
    /// The step fell below 1e-15 of the sizes of the unknowns with the residual still above its tolerance (N3).
    Stalled,
    /// The Jacobian is singular to working precision, or not finite.
    SingularJacobian,
    /// The residual is NaN or infinite.
    NotFinite,
    /// A scale is zero, negative or not finite; no step was taken.
    BadScale,
    /// The model cannot be evaluated at the starting point, or not linearized.
    OutsideDomain,
}

impl Termination {
    /// Returns the status as text.
    pub fn describe(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::MaxSteps => "the step limit was reached",
            Self::LineSearchFailed => "no step length lowers the residual",
            Self::Stalled => "the steps became too small",
            Self::SingularJacobian => "the Jacobian is singular",
            Self::NotFinite => "the residual is not finite",
            Self::BadScale => "a scale is not positive and finite",
            Self::OutsideDomain => "the model refused the starting point",
        }
    }
}

impl fmt::Display for Termination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.describe())
    }
}

/// A status other than [`Converged`](Self::Converged) may be passed on as an error.
impl Error for Termination {}

/// One accepted Newton step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// `$\lVert D_F F(x_k) \rVert_2$` before the step.
    pub residual: f64,
    /// `$\lVert D_x\,\delta x_k \rVert_\infty$` of the full Newton step.
    pub step: f64,
    /// Accepted `$\lambda_k \in (0, 1]$`.
    pub lambda: f64,
}

/// Status, cost and path of a solve.
#[derive(Debug, Clone, PartialEq)]
#[must_use = "a report may say that the solve did not converge"]
pub struct Report {
    /// Why the iteration ended.
    pub status: Termination,
    /// Final `$\lVert D_F F(x) \rVert_2$`.
    pub residual: f64,
    /// Index of the equation with the largest scaled residual.
    pub worst_equation: usize,
    /// That equation as text, from its
    /// [`equation`](crate::Equations::equation); empty if the solve converged.
    pub worst_equation_name: String,
    /// Evaluations of the residual alone.
    pub n_residual: usize,
    /// Evaluations of the residual with its Jacobian.
    pub n_jacobian: usize,
    /// The accepted steps, in order.
    pub steps: Vec<Step>,
}

impl Report {
    /// Reserves the memory of a solve, so that nothing is allocated during the iteration.
    pub(crate) fn new(options: &Options) -> Self {
        Self {
            status: Termination::BadScale,
            residual: f64::INFINITY,
            worst_equation: 0,
            worst_equation_name: String::new(),
            n_residual: 0,
            n_jacobian: 0,
            steps: Vec::with_capacity(options.convergence.max_steps),
        }
    }

    /// Returns true if the scaled residual met its tolerance.
    pub fn converged(&self) -> bool {
        self.status == Termination::Converged
    }
}
