//! Derivatives of the efficiency and the torque of the rigid model.
//!
//! Theory: `docs/theory/12-sensitivities.md`.

use bsm_kin::Jet;

use super::equations::{MIN_INERTIA, RigidEquations};
use super::{Rigid, RigidWorkspace, root};
use crate::contact::efficiency;
use crate::models::ball::{
    BALL_UNKNOWNS, Performance, SolveFailure, domain_error, inertia_limit, moving_root,
};

impl<const M: usize> Rigid<Jet<M>> {
    /// Returns the efficiency and the torque with their derivatives with respect to the inputs.
    pub(crate) fn sensitivities(
        &self,
        work: &mut RigidWorkspace,
    ) -> Result<Performance<Jet<M>>, SolveFailure> {
        let (inputs, values) = (self.ball()?, Rigid { point: self.point.values() }.ball()?);
        let first = values.first_order();
        inertia_limit(MIN_INERTIA * values.friction() / first.inertia_scale, |factor| {
            let (inputs, values) = (inputs.with_inertia(factor), values.with_inertia(factor));
            let motion = root::find(&values, work)?.motion;
            let (equations, unknowns) = RigidEquations::at(&values, &motion);
            let weights = values.own_weights(&motion, 1.0);
            let moved =
                RigidEquations { ball: inputs, uses_absolute_rate: equations.uses_absolute_rate };
            let residual = |y: &[_; BALL_UNKNOWNS]| Ok(moved.residual(&(*y).into())?.into());
            let unknowns =
                moving_root(&equations, &unknowns.into(), &weights, residual, &mut work.0)?;
            let motion = moved.motion(&unknowns.into()).map_err(domain_error)?;
            let (ideal, torque) = (inputs.ideal_torque(), inputs.torque(&motion));
            let efficiency = efficiency(self.point.drive.relative_speed().re < 0.0, ideal, torque);
            Ok(Performance { efficiency, screw_torque: Some(torque * self.point.units().torque) })
        })
    }
}
