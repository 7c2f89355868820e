//! Policies of a solve: when it stops, how it damps steps, when it renews the Jacobian; and the scales.

use crate::Termination;

/// Constant `$\gamma$` of the sufficient decrease (N5).
pub const ARMIJO: f64 = 1e-4;

/// Policies of a solve. Every number is dimensionless.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Options {
    /// When the iteration stops.
    pub convergence: Convergence,
    /// How far a step goes.
    pub damping: Backtracking,
    /// When the Jacobian is evaluated.
    pub jacobian: JacobianUpdate,
}

/// Stopping rules.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Convergence {
    /// Residual tolerance: the point is a solution if `$\lVert D_F F(x) \rVert_2 \le$` this (N1). Defaults to `1e-10`.
    pub residual_tol: f64,
    /// Residual below which a solution is not refined further. Above it full steps follow as long as each of them at
    /// least halves the residual (N2). Defaults to `1e-10`: a solution is not refined.
    pub residual_goal: f64,
    /// Maximum number of Newton steps. Defaults to `50`.
    pub max_steps: usize,
}

impl Default for Convergence {
    fn default() -> Self {
        Self { residual_tol: 1e-10, residual_goal: 1e-10, max_steps: 50 }
    }
}

/// State of an iteration between two steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// The point is no solution yet.
    Iterating,
    /// The point is a solution that further steps may refine.
    Refining,
    /// The iteration ends at this point.
    Ended(Termination),
}

impl Progress {
    /// Returns how an iteration ends that cannot take another step for this reason: a solution stays a solution.
    pub(crate) fn ended_by(self, reason: Termination) -> Termination {
        if self == Self::Refining { Termination::Converged } else { reason }
    }
}

impl Convergence {
    /// Largest ratio of the residuals after and before a step that refines a solution (N2).
    const MAX_REFINING_RATIO: f64 = 0.5;

    /// Decides whether the iteration goes on.
    ///
    /// * `residual`: scaled norm of the residual. * `previous`: the norm before the last step. * `steps`: number of steps taken.
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
        // ‖D_F F(x_k)‖₂ ≤ residual_goal, or the last step did not halve it  (N2)
        let is_refined = residual <= self.residual_goal
            || previous.is_some_and(|previous| residual > Self::MAX_REFINING_RATIO * previous);
        let converged = Progress::Ended(Termination::Converged);
        if is_refined || is_exhausted { converged } else { Progress::Refining }
    }
}

/// Backtracking line search on the squared residual: the step is halved until the residual decreases sufficiently.
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
    /// Full steps only.
    pub(crate) const NONE: Self = Self { max_halvings: 0 };

    /// Returns whether a step of length `lambda` lowers the scaled residual sufficiently.
    pub fn accepts(lambda: f64, before: f64, after: f64) -> bool {
        // φ(λ) = ½ ‖D_F F(x + λ δx)‖₂²,  φ'(0) = −2 φ(0) along a Newton step   (N4)
        let [phi_0, phi] = [before, after].map(|norm| 0.5 * norm.powi(2));
        // φ(λ) ≤ (1 − 2 γ λ) φ(0)                                         (N5)
        phi <= (1.0 - 2.0 * ARMIJO * lambda) * phi_0
    }
}

/// When the Jacobian is evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum JacobianUpdate {
    /// At every accepted point: Newton's method.
    #[default]
    EveryStep,
    /// With the residual at every trial point, for models that rarely reject a trial and compute both at once.
    EveryTrial {
        /// Residual below which trials are evaluated without the Jacobian and steps keep the last factors as long as each
        /// of them lowers the residual to a tenth: the chord method. Zero: never.
        chord_below: f64,
    },
}

impl JacobianUpdate {
    /// Largest ratio of the residuals after and before a step that lets the next step keep the factors.
    const MAX_CHORD_RATIO: f64 = 0.1;

    /// Returns whether the residual of the starting point is evaluated with the Jacobian.
    pub(crate) fn at_start(self) -> bool {
        self != Self::EveryStep
    }

    /// Returns whether trials from a point with this residual are evaluated with the Jacobian.
    pub(crate) fn at_trials(self, residual: f64) -> bool {
        match self {
            Self::EveryStep => false,
            Self::EveryTrial { chord_below } => residual > chord_below,
        }
    }

    /// Returns whether the next step may use the factors of an earlier point.
    pub(crate) fn keeps_factors(self, residual: f64, previous: Option<f64>) -> bool {
        self != Self::EveryStep
            && previous.is_some_and(|previous| residual <= Self::MAX_CHORD_RATIO * previous)
    }
}

/// Diagonals of the scaling matrices `$D_x$` and `$D_F$`.
///
/// `x[j]` is one over the typical size of unknown `j`, `f[i]` one over the typical size of
/// equation `i`, so that unknowns and equations of different units weigh alike.
#[derive(Debug, Clone, PartialEq)]
pub struct Scales<'a, V> {
    /// Diagonal of `$D_x$`, positive.
    pub x: &'a V,
    /// Diagonal of `$D_F$`, positive.
    pub f: &'a V,
}
