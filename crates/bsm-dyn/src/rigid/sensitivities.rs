//! Derivatives of the rigid model's efficiency and torque.
//!
//! Theory: `docs/theory/12-sensitivities.md`.

use bsm_kin::Jet;

use super::first_order::FirstOrder;
use super::root::{self, SLOW};
use super::{Rigid, RigidWorkspace};
use crate::balance::efficiency;
use crate::ball_unknowns::BALL;
use crate::elastic_ball::refused;
use crate::sensitivity::{moving_root, told_by_inertia};
use crate::{Transmitted, Unsolved};

impl<const M: usize> Rigid<Jet<M>> {
    /// Efficiency and torque with their derivatives.
    pub(crate) fn sensitivities(
        &self,
        work: &mut RigidWorkspace,
    ) -> Result<Transmitted<Jet<M>>, Unsolved> {
        let inputs = self.scaled()?;
        let start = FirstOrder::of(&inputs.map(|x| x.re));
        told_by_inertia(SLOW * self.point.friction.0.re / start.size, |factor| {
            let inputs = inputs.with_inertia(factor);
            let point = inputs.map(|x| x.re);
            let root = root::find(&point, work)?;
            let (point, inputs) =
                (point.counted(root.from_ground), inputs.counted(root.from_ground));
            let weights = point.own_weights(&root.unknowns);
            let residual = |y: &[_; BALL]| Ok(inputs.residual(&(*y).into())?.into());
            let unknowns =
                moving_root(&point, &root.unknowns.into(), &weights, residual, &mut work.0)?;
            let state = inputs.state(&unknowns.into()).map_err(refused)?;
            let (ideal, torque) = self.torques(&inputs, &state);
            let efficiency = efficiency(self.direction(), ideal, torque);
            Ok(Transmitted { efficiency, screw_torque: Some(torque) })
        })
    }
}
