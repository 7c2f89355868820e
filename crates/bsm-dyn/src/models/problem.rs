//! Inputs of any model at one operating point.

use bsm_kin::Jet;

use crate::models::auto::Auto;
use crate::models::ball::{Performance, Solution, SolveFailure, SteadyState};
use crate::models::closed_form::ClosedForm;
use crate::models::elastic::Elastic;
use crate::models::gothic::GothicBall;
use crate::models::lubricated::{LossInterval, LubricatedBall};
use crate::models::lubricated_arch::LubricatedArch;
use crate::models::quasi_static::QuasiStatic;
use crate::models::raceway_control::RacewayControl;
use crate::models::rigid::Rigid;
use crate::models::traction::Traction;
use crate::models::workspace::ModelWorkspace;

/// Inputs of one model at one operating point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Problem<D = f64> {
    /// Inputs of [`Model::ClosedForm`](crate::Model::ClosedForm).
    ClosedForm(ClosedForm<D>),
    /// Inputs of [`Model::QuasiStatic`](crate::Model::QuasiStatic).
    QuasiStatic(QuasiStatic<D>),
    /// Inputs of [`Model::Rigid`](crate::Model::Rigid).
    Rigid(Rigid<D>),
    /// Inputs of [`Model::RacewayControl`](crate::Model::RacewayControl).
    RacewayControl(RacewayControl<D>),
    /// Inputs of [`Model::Elastic`](crate::Model::Elastic).
    Elastic(Elastic<D>),
    /// Inputs of [`Model::Traction`](crate::Model::Traction).
    Traction(Traction<D>),
    /// Inputs of [`Model::Traction`](crate::Model::Traction) for gothic arches with a given axial
    /// play.
    GothicArch(GothicBall<D>),
    /// Inputs of the model `auto`, which chooses the model automatically.
    Auto(Auto<D>),
    /// Inputs of [`Model::RacewayControl`](crate::Model::RacewayControl) or
    /// [`Model::Traction`](crate::Model::Traction) with a lubricant.
    Lubricated(LubricatedBall<D>),
    /// Inputs of a lubricated model for gothic arches with a given axial play.
    LubricatedArch(LubricatedArch<D>),
}

impl Problem {
    /// Solves the problem. The buffers in `work` can be reused for the next operating point.
    pub fn solve(&self, work: &mut ModelWorkspace) -> Solution {
        match self {
            Self::ClosedForm(p) => p.solve(),
            Self::QuasiStatic(p) => p.solve(),
            Self::Rigid(p) => p.solve(&mut work.rigid),
            Self::RacewayControl(p) => p.solve(&mut work.raceway),
            Self::Elastic(p) => p.solve(&mut work.elastic),
            Self::Traction(p) => p.solve(&mut work.traction),
            Self::GothicArch(p) => p.solution(&mut work.gothic),
            Self::Auto(p) => p.solve(work),
            Self::Lubricated(p) => p.solve(work),
            Self::LubricatedArch(p) => p.solve(work),
        }
    }

    /// Returns all steady states on the branch of increasing inertia that begins at a ball without
    /// inertia, or `None` if the model does not follow branches. Only [`Rigid`] and [`Traction`]
    /// follow branches.
    pub fn branch(
        &self,
        work: &mut ModelWorkspace,
    ) -> Option<Result<Vec<SteadyState>, SolveFailure>> {
        match self {
            Self::Rigid(problem) => Some(problem.branch(&mut work.rigid)),
            Self::Traction(problem) => Some(problem.branch(&mut work.traction)),
            _ => None,
        }
    }

    /// Returns the uncertainty interval of the power loss in lubricated contacts for a solved
    /// point; `None` without a lubricant.
    pub fn loss_interval(
        &self,
        solved: &SteadyState,
        work: &mut ModelWorkspace,
    ) -> Option<LossInterval> {
        match self {
            Self::Lubricated(problem) => problem.loss_interval(solved, work),
            Self::LubricatedArch(problem) => problem.ball.loss_interval(solved, work),
            _ => None,
        }
    }
}

impl<const M: usize> Problem<Jet<M>> {
    /// Solves the problem, and returns efficiency and torque with their derivatives with respect to
    /// the `M` variables of the inputs.
    ///
    /// ```math
    /// \frac{dy}{dp} = \frac{\partial y}{\partial p}
    ///   - \frac{\partial y}{\partial x} J^{-1} \frac{\partial F}{\partial p}
    /// ```
    ///
    /// Some discrete choices stay fixed: the controlling raceway, the direction of the drive, and
    /// the model and accuracy that [`Auto`](crate::model::Auto) chooses. At a point where one of
    /// these choices changes, the derivatives are one-sided.
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`], which contains the status and the reason, if there is no solution.
    pub fn sensitivities(
        &self,
        work: &mut ModelWorkspace,
    ) -> Result<Performance<Jet<M>>, SolveFailure> {
        // dy/dp = ∂y/∂p + ∂y/∂x dx/dp, evaluated in jets of x and p       (V3)
        match self {
            Self::ClosedForm(p) => Ok(p.transmitted()),
            Self::QuasiStatic(p) => p.require_balance().map(|()| p.transmitted()),
            Self::Rigid(p) => p.sensitivities(&mut work.rigid),
            Self::RacewayControl(p) => p.sensitivities(&mut work.raceway),
            Self::Elastic(p) => p.sensitivities(&mut work.elastic),
            Self::Traction(p) => p.sensitivities(&mut work.traction),
            Self::GothicArch(p) => p.sensitivities(&mut work.gothic),
            Self::Auto(p) => p.sensitivities(work),
            Self::Lubricated(p) => p.sensitivities(work),
            Self::LubricatedArch(p) => p.sensitivities(work),
        }
    }
}
