//! Policies of the Newton solver (stopping rules, damping, Jacobian updates), and scales of
//! unknowns and equations.

use crate::Termination;

/// Constant `$\gamma$` of the sufficient-decrease condition (N5) (dimensionless).
pub const ARMIJO: f64 = 1e-4;

/// Policies of the Newton solver. All numbers are dimensionless.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Options {
    /// Rules for stopping the iteration.
    pub convergence: Convergence,
    /// Rule for selecting the step length.
    pub damping: Backtracking,
    /// Rule that decides when the Jacobian is evaluated.
    pub jacobian: JacobianUpdate,
}

/// Stopping rules of the Newton iteration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Convergence {
    /// Maximum scaled residual `$\lVert D_F F(x) \rVert_2$` of a solution (N1). Defaults to
    /// [`RESIDUAL_TOL`](Self::RESIDUAL_TOL).
    pub residual_tol: f64,
    /// Scaled residual below which a solution is not refined further (N2). A solution with a larger
    /// residual is refined with full steps as long as each step at least halves the residual.
    /// Defaults to the default of `residual_tol`, so solutions are not refined.
    pub residual_goal: f64,
    /// Maximum number of Newton steps. Defaults to `50`.
    pub max_steps: usize,
}

impl Default for Convergence {
    fn default() -> Self {
        let tol = Self::RESIDUAL_TOL;
        Self { residual_tol: tol, residual_goal: tol, max_steps: 50 }
    }
}

/// State of an iteration between two steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// The point is not yet a solution.
    Iterating,
    /// The point is a solution, but further steps may refine it.
    Refining,
    /// The iteration ends at this point.
    Ended(Termination),
}

impl Progress {
    /// Returns the status of an iteration that cannot take another step for the given reason.
    ///
    /// An iteration that was only refining a solution has converged, regardless of the reason why
    /// it ended.
    pub(crate) fn ended_by(self, reason: Termination) -> Termination {
        if self == Self::Refining { Termination::Converged } else { reason }
    }
}

impl Convergence {
    /// Default of the maximum scaled residual of a solution (dimensionless, N1).
    pub const RESIDUAL_TOL: f64 = 1e-10;

    /// Maximum ratio of the residual after a refining step to the residual before the step (N2).
    const MAX_REFINING_RATIO: f64 = 0.5;

    /// Decides whether the iteration continues.
    ///
    /// * `residual`: scaled norm of the residual.
    /// * `previous`: scaled norm of the residual before the last step, if a step was taken.
    /// * `steps`: number of accepted steps.
    pub fn check(&self, residual: f64, previous: Option<f64>, steps: usize) -> Progress {
        if !residual.is_finite() {
            return Progress::Ended(Termination::NotFinite);
        }
        let is_exhausted = steps == self.max_steps;
        // ‖D_F F(x_k)‖₂ ≤ residual_tol                                    (N1)
        if residual > self.residual_tol {
            let max_steps = Progress::Ended(Termination::MaxSteps);
            return if is_exhausted { max_steps } else { Progress::Iterating };
        }
        // ‖D_F F(x_k)‖₂ ≤ residual_goal, or the last step did not halve the residual (N2)
        let is_refined = residual <= self.residual_goal
            || previous.is_some_and(|previous| residual > Self::MAX_REFINING_RATIO * previous);
        let converged = Progress::Ended(Termination::Converged);
        if is_refined || is_exhausted { converged } else { Progress::Refining }
    }
}

/// Backtracking line search, which halves the step until the squared residual decreases
/// sufficiently.
///
/// Source: Dennis and Schnabel, *Numerical Methods for Unconstrained Optimization and Nonlinear
/// Equations*, §6.3.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Backtracking {
    /// Maximum number of halvings of a step (N6). Defaults to `20`; `0` accepts full steps only.
    pub max_halvings: u32,
}

impl Default for Backtracking {
    fn default() -> Self {
        Self { max_halvings: 20 }
    }
}

impl Backtracking {
    /// Policy that accepts full steps only.
    pub(crate) const NONE: Self = Self { max_halvings: 0 };

    /// Returns true if a fraction `lambda` of a Newton step decreases the scaled residual
    /// sufficiently (N5).
    ///
    /// * `before`, `after`: scaled norms of the residual before and after the step.
    pub fn accepts(lambda: f64, before: f64, after: f64) -> bool {
        // φ(λ) = ½ ‖D_F F(x + λ δx)‖₂²,  φ'(0) = −2 φ(0) along a Newton step   (N4)
        let [phi_0, phi] = [before, after].map(|norm| 0.5 * norm.powi(2));
        // φ(λ) ≤ (1 − 2 γ λ) φ(0)                                         (N5)
        phi <= (1.0 - 2.0 * ARMIJO * lambda) * phi_0
    }
}

/// Rule that decides when the Jacobian is evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum JacobianUpdate {
    /// Evaluates the Jacobian at every accepted point, as in Newton's method.
    #[default]
    EveryStep,
    /// Evaluates the Jacobian together with the residual at every trial point. This is efficient
    /// for models that calculate both at once and rarely reject a trial point.
    EveryTrial {
        /// Scaled residual below which the chord method is used. Trial points are then evaluated
        /// without the Jacobian, and steps use the latest LU factors as long as each step reduces
        /// the residual to at most one tenth of its previous value. Zero disables the chord method.
        chord_below: f64,
    },
}

impl JacobianUpdate {
    /// Maximum ratio of the residual after a step to the residual before this step at which the
    /// next step may reuse the LU factors.
    const MAX_CHORD_RATIO: f64 = 0.1;

    /// Returns true if the Jacobian is evaluated together with the residual at the starting point.
    pub(crate) fn at_start(self) -> bool {
        self != Self::EveryStep
    }

    /// Returns true if trial points are evaluated together with the Jacobian. The argument is the
    /// scaled residual before the step.
    pub(crate) fn at_trials(self, residual: f64) -> bool {
        match self {
            Self::EveryStep => false,
            Self::EveryTrial { chord_below } => residual > chord_below,
        }
    }

    /// Returns true if the next step may use the LU factors from an earlier point.
    pub(crate) fn keeps_factors(self, residual: f64, previous: Option<f64>) -> bool {
        self != Self::EveryStep
            && previous.is_some_and(|previous| residual <= Self::MAX_CHORD_RATIO * previous)
    }
}

/// Diagonals of the scaling matrices `$D_x$` and `$D_F$`.
///
/// `x[j]` is the reciprocal of the typical magnitude of unknown `j`, and `f[i]` is the reciprocal
/// of the typical magnitude of residual `i`. The scales give equal weight to unknowns and equations
/// with different units.
#[derive(Debug, Clone, PartialEq)]
pub struct Scales<'a, V> {
    /// Diagonal of the scaling matrix `$D_x$`, positive.
    pub x: &'a V,
    /// Diagonal of the scaling matrix `$D_F$`, positive.
    pub f: &'a V,
}
