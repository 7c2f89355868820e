//! Derivatives of the efficiency and the torque of the elastic model.
//!
//! Theory: `docs/theory/12-sensitivities.md`.

use bsm_kin::Jet;

use super::{Elastic, ElasticWorkspace, GrossSlipEquations, find, inertia_factor, weights};
use crate::models::ball::{Performance, SolveFailure, domain_error, inertia_limit, moving_root};

impl<const M: usize> Elastic<Jet<M>> {
    /// Returns the efficiency and the torque with their derivatives with respect to the inputs.
    pub(crate) fn sensitivities(
        &self,
        ElasticWorkspace(newton): &mut ElasticWorkspace,
    ) -> Result<Performance<Jet<M>>, SolveFailure> {
        self.screw.point.require_friction()?;
        let (inputs, point) = (self.screw.scaled()?, self.screw.values().scaled()?);
        let (root, ..) = find(&point, newton)?;
        inertia_limit(inertia_factor(&point, &root), |factor| {
            let (inputs, point) = (inputs.with_inertia(factor), point.with_inertia(factor));
            let (root, ..) = find(&point, newton)?;
            let weights = weights(&point, &root);
            let residual = |y: &_| GrossSlipEquations(&inputs).residual(y);
            let y = moving_root(&GrossSlipEquations(&point), &root, &weights, residual, newton)?;
            let state = GrossSlipEquations(&inputs).state(&y).map_err(domain_error)?;
            Ok(self.screw.transmitted(&inputs, &state.loaded.frame, &state.wrench[1]))
        })
    }
}
