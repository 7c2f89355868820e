//! Derivatives of the efficiency and the torque of the traction model.
//!
//! Theory: `docs/theory/12-sensitivities.md`.

use bsm_kin::Jet;

use super::equations::SlipBall;
use super::root::SlipRoot;
use super::{Traction, TractionWorkspace};
use crate::ellipse::RulePair;
use crate::models::ball::{Performance, SolveFailure, domain_error, moving_root};

impl<const M: usize> Traction<Jet<M>> {
    /// Returns the efficiency and the torque with their derivatives with respect to the inputs, for
    /// the accuracy and the creep speed of the model.
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`] if no root is found or the Jacobian is singular at the root.
    pub(crate) fn sensitivities(
        &self,
        work: &mut TractionWorkspace,
    ) -> Result<Performance<Jet<M>>, SolveFailure> {
        let screw = self.screw.values();
        let case = Traction { screw, accuracy: self.accuracy, creep: self.creep };
        let root = case.root(work)?.root;
        self.sensitivities_at(&root, work)
    }

    /// Returns the efficiency and the torque with their derivatives with respect to the inputs, at
    /// a root that is already known.
    pub(crate) fn sensitivities_at(
        &self,
        root: &SlipRoot,
        work: &mut TractionWorkspace,
    ) -> Result<Performance<Jet<M>>, SolveFailure> {
        let (inputs, point) = (self.screw.scaled()?, self.screw.values().scaled()?);
        let TractionWorkspace { newton, rules, .. } = work;
        let [RulePair { rule, .. }] = rules.dry([self.accuracy]);
        let creep = self.creep * point.slip_scale();
        let unknowns = &root.unknowns;
        let system = SlipBall::of_contacts(&point, rule, creep).of(root);
        let equations = SlipBall::of_contacts(&inputs, rule, creep).of(root);
        let residual = |y: &_| equations.residual(y);
        let y = moving_root(&system, unknowns, &system.weights(unknowns), residual, newton)?;
        let torque = equations.evaluated(&y).map_err(domain_error)?.torque;
        Ok(self.screw.transmitted_torque(&inputs, torque))
    }
}
