//! Status, cost and steps of a Newton iteration.

use std::fmt;

use crate::Options;

/// Reason why the iteration ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Termination {
    /// The scaled residual does not exceed `residual_tol` (N1).
    Converged,
    /// The iteration ended because it reached the maximum number of steps.
    MaxSteps,
    /// No tested step length decreased the residual sufficiently (N5).
    LineSearchFailed,
    /// The scaled step is less than 1e-15, but the residual exceeds its tolerance (N3).
    Stalled,
    /// The Jacobian is singular to working precision, or not finite.
    SingularJacobian,
    /// The residual is NaN or infinite.
    NotFinite,
    /// A scaling factor is zero, negative or not finite, so no step was taken.
    BadScale,
    /// The model cannot be evaluated at the starting point, or it cannot be linearized at an
    /// iterate.
    OutsideDomain,
}

impl Termination {
    /// Returns a short description of the status.
    pub fn describe(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::MaxSteps => "the step limit was reached",
            Self::LineSearchFailed => "no step length decreases the residual",
            Self::Stalled => "the steps became too small",
            Self::SingularJacobian => "the Jacobian is singular",
            Self::NotFinite => "the residual is not finite",
            Self::BadScale => "a scaling factor is not positive and finite",
            Self::OutsideDomain => "the model cannot be evaluated",
        }
    }
}

impl fmt::Display for Termination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.describe())
    }
}

/// One accepted Newton step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Scaled residual before the step, `$\lVert D_F F(x_k) \rVert_2$`.
    pub residual: f64,
    /// Scaled length of the full Newton step, `$\lVert D_x\,\delta x_k \rVert_\infty$`.
    pub step: f64,
    /// Accepted fraction of the Newton step, `$\lambda_k \in (0, 1]$`.
    pub lambda: f64,
}

/// The equation with the largest scaled residual.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WorstEquation {
    /// Index of the equation, starting at zero.
    pub index: usize,
    /// Name of the equation, from [`Equations::equation`](crate::Equations::equation).
    pub name: String,
}

/// Status, cost and steps of a Newton iteration.
#[derive(Debug, Clone, PartialEq)]
#[must_use = "a report may state that the iteration did not converge"]
pub struct Report {
    /// Reason why the iteration ended.
    pub status: Termination,
    /// Final scaled residual, `$\lVert D_F F(x) \rVert_2$`.
    pub residual: f64,
    /// Equation with the largest scaled residual at the last iterate. `None` if the iteration
    /// converged, or if the equations could not be evaluated at the starting point.
    pub worst: Option<WorstEquation>,
    /// Number of residual evaluations without the Jacobian.
    pub n_residual: usize,
    /// Number of Jacobian evaluations, with or without the residual.
    pub n_jacobian: usize,
    /// Accepted steps, in order.
    pub steps: Vec<Step>,
}

impl Report {
    /// Creates an empty report with enough capacity for all steps, so that the iteration does not
    /// allocate memory.
    pub(crate) fn new(options: &Options) -> Self {
        Self {
            status: Termination::BadScale,
            residual: f64::INFINITY,
            worst: None,
            n_residual: 0,
            n_jacobian: 0,
            steps: Vec::with_capacity(options.convergence.max_steps),
        }
    }

    /// Returns true if the scaled residual is within the tolerance.
    pub fn converged(&self) -> bool {
        self.status == Termination::Converged
    }
}
