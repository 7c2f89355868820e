//! Traction model with lubricated contacts.
//!
//! Theory: `docs/theory/17-lubricant.md`, equation (Y32).

use std::cell::OnceCell;

use bsm_kin::{Helix, Jet};
use bsm_newton::{Continuation, follow};

use super::equations::{
    COARSE_ACCURACY, COARSE_RESIDUAL, Lubrication, NewtonLimits, SEARCH_ACCURACY, SlipBall,
};
use super::root::{RefinedRoot, SlipRoot};
use super::{RollingStart, Traction, TractionWorkspace};
use crate::contact::ideal_torque;
use crate::ellipse::{FrozenRule, RulePair};
use crate::models::ball::{
    EhlPoint, ElasticContacts, LubricatedState, LubricatedWorkspace, SolveFailure, SolveInfo,
    SteadyRoot, Workspace, domain_error, moving_root, to_both,
};
use crate::models::raceway_control::RollingBall;
use crate::models::workspace::ModelWorkspace;

/// Scaled residual up to which a lubricated root is refined. At this residual, the power imbalance
/// is at most a tenth of its tolerance.
pub(super) const LUBRICATED_RESIDUAL_GOAL: f64 = 1e-11;

/// Limits for each step of the continuation in which the lubricant friction is increased.
const SHARE_LIMITS: NewtonLimits = NewtonLimits { max_steps: 12, max_halvings: 6 };

impl<'a> SlipBall<'a> {
    /// Returns the equations with lubricant friction.
    fn lubricated(&self, ehl: &'a EhlPoint) -> Self {
        Self { lubrication: Some(Lubrication { ehl, fraction: 1.0, complete: false }), ..*self }
    }
}

impl SlipBall<'_> {
    /// Returns the equations in which the given fraction of the friction comes from the lubricant,
    /// with all derivatives.
    fn complete(&self, fraction: f64) -> Self {
        let complete = |lubrication| Lubrication { fraction, complete: true, ..lubrication };
        Self { lubrication: self.lubrication.map(complete), ..*self }
    }

    /// Returns the lubricated root near a given root with a constant friction coefficient.
    ///
    /// If Newton's method fails, a continuation follows the root while the fraction of lubricant
    /// friction increases from 0 to 1.
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`] if both methods fail.
    fn search_lubricated(
        &self,
        near: &SlipRoot,
        newton: &mut Workspace,
        steps: &mut usize,
    ) -> Result<SlipRoot, SolveFailure> {
        let here = self.of(near);
        let mut failure = SolveFailure::SEARCH_FAILED;
        for ball in [here, here.complete(1.0)] {
            match ball.solved(near.unknowns, newton, steps) {
                Ok(root) => return Ok(root),
                Err(reason) => failure = SolveFailure::not_converged(reason),
            }
        }
        crate::cost::count_search();
        let mut y = near.unknowns;
        let control = Continuation { first_step: 0.25, min_step: 0.01 };
        let arrived = follow(&mut y, (0.0, 1.0), control, |fraction, y| {
            let report =
                SlipBall { limits: SHARE_LIMITS, ..here.complete(fraction) }.run(y, newton).report;
            *steps += report.steps.len();
            report.converged()
        });
        let root = arrived.ok().and_then(|()| here.solved(y, newton, steps).ok());
        root.ok_or(failure)
    }
}

/// Root of the traction equations for a lubricated ball, its operating point, and the rolling ball
/// from which the solver started. The friction coefficient of the operating point is the friction
/// scale.
struct ScaledRoot {
    contacts: ElasticContacts,
    rolling_ball: RollingBall,
    refined: RefinedRoot,
    frozen_rules: [OnceCell<FrozenRule>; 2],
    steps: usize,
    /// Error bound of the efficiency due to the quadrature over the contact ellipses (T25)
    /// (dimensionless).
    error: f64,
}

impl Traction {
    /// Finds the lubricated root near the root with a constant friction coefficient, and refines it
    /// with a quadrature of the requested accuracy.
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`] if no root is found.
    fn lubricated_root(
        &self,
        ehl: &EhlPoint,
        work: &mut TractionWorkspace,
        oil: &mut LubricatedWorkspace,
    ) -> Result<ScaledRoot, SolveFailure> {
        let contacts = self.screw.scaled()?;
        let rolling_ball = RollingBall::of(&contacts, None, &mut work.statics);
        let RollingStart { rolling_ball, .. } =
            RollingStart::new(&contacts, rolling_ball.ok().as_ref())?;
        let creep = self.creep * contacts.slip_scale();
        let scale =
            ehl.friction_scale(&contacts, &rolling_ball.loaded, &rolling_ball.to_nut, creep);
        let contacts = contacts.with_friction(scale);
        let TractionWorkspace { newton, rules, .. } = work;
        let [coarse, search] = rules
            .dry([COARSE_ACCURACY, SEARCH_ACCURACY])
            .map(|pair| SlipBall::of_contacts(&contacts, &pair.rule, creep));
        let pairs = oil.rules.of_oil([COARSE_ACCURACY, SEARCH_ACCURACY, self.accuracy]);
        let [rough, smooth, fine] =
            pairs.map(|pair| SlipBall::of_contacts(&contacts, &pair.rule, creep).lubricated(ehl));
        let [.., RulePair { check, .. }] = pairs;
        let (coarse, rough) = (
            SlipBall { residual_goal: COARSE_RESIDUAL, ..coarse },
            SlipBall { residual_goal: COARSE_RESIDUAL, ..rough },
        );
        let mut steps = rolling_ball.steps;
        let near = coarse.direct(&rolling_ball, newton, &mut steps);
        let found = near.and_then(|near| rough.search_lubricated(&near, newton, &mut steps).ok());
        let root = if let Some(root) = found {
            root
        } else {
            // A lubricated root may exist even if there is no root with a constant friction
            // coefficient.
            let near = search
                .search(&rolling_ball, newton, &mut steps)
                .map_err(|_| SolveFailure::SEARCH_FAILED)?;
            smooth.search_lubricated(&near, newton, &mut steps)?
        };
        let frozen_rules = Default::default();
        let fine = SlipBall { residual_goal: LUBRICATED_RESIDUAL_GOAL, ..fine };
        let refined = fine
            .refined(&root, &frozen_rules, newton, &mut steps)
            .or_else(|| fine.complete(1.0).refined(&root, &frozen_rules, newton, &mut steps))
            .ok_or(SolveFailure::SEARCH_FAILED)?;
        let RefinedRoot { root, transmitted, torque_slope, .. } = &refined;
        let checked = SlipBall { quadrature: check, ..fine.of(root) };
        let other = checked.evaluated(&root.unknowns).ok();
        let Helix { radius, lead_angle } = contacts.helix;
        let ideal = ideal_torque(1.0, radius, lead_angle.tan());
        let torque = transmitted.torque;
        let efficiency = crate::contact::efficiency(contacts.direction.is_back(), ideal, torque);
        let error = checked.error(self.accuracy, other.as_ref(), torque_slope, efficiency, newton);
        Ok(ScaledRoot { contacts, rolling_ball, refined, frozen_rules, steps, error })
    }

    /// Returns the steady state of the ball with lubricated contacts.
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`] if no root is found.
    pub(crate) fn lubricated(
        &self,
        ehl: &EhlPoint,
        work: &mut TractionWorkspace,
        oil: &mut LubricatedWorkspace,
    ) -> Result<SteadyRoot, SolveFailure> {
        let ScaledRoot { contacts, rolling_ball, refined, steps, error, .. } =
            self.lubricated_root(ehl, work, oil)?;
        let RefinedRoot { root, transmitted, loaded, .. } = refined;
        let creep = self.creep * contacts.slip_scale();
        let [_, dry] = oil.rules.oil_and_dry(self.accuracy);
        let ball = SlipBall::of_contacts(&contacts, dry, creep).of(&root);
        let to_nut = ball.motion_to_nut(&root.unknowns, &loaded);
        let motions = to_both(&to_nut, &loaded.frame);
        let losses = std::array::from_fn(|i| {
            ehl.loss_of(i, (&contacts, &loaded), &motions[i], creep, transmitted.sliding[i])
        });
        let unit = contacts.unit_powers(&loaded, &to_nut, creep, [0, 1].map(|i| ball.nodes(i)));
        let torque = transmitted.torque * self.screw.point.units().torque;
        let info = SolveInfo { steps, residual: root.residual };
        let steady = LubricatedState { loaded, to_nut, losses, torque };
        let (skid, error) = (rolling_ball.skid(&contacts), Some(error));
        Ok(SteadyRoot { contacts, steady, unit, skid, info, control: None, error })
    }
}

impl<const M: usize> Traction<Jet<M>> {
    /// Returns the inputs of the model without derivatives.
    pub(crate) fn values(&self) -> Traction {
        let Self { screw, accuracy, creep } = *self;
        Traction { screw: screw.values(), accuracy, creep }
    }

    /// Returns the operating point in scaled units and the steady state of the lubricated ball,
    /// both with derivatives with respect to the inputs.
    ///
    /// * `values`: the lubrication data `ehl` without derivatives.
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`] if no root is found or the Jacobian is singular at the root.
    pub(crate) fn lubricated_slopes(
        &self,
        ehl: &EhlPoint<Jet<M>>,
        values: &EhlPoint,
        ModelWorkspace { traction, lubricated, .. }: &mut ModelWorkspace,
    ) -> Result<(ElasticContacts<Jet<M>>, LubricatedState<Jet<M>>), SolveFailure> {
        let inputs = self.screw.scaled()?;
        let ScaledRoot { contacts, refined: RefinedRoot { root, .. }, frozen_rules, .. } =
            self.values().lubricated_root(values, traction, lubricated)?;
        let creep = self.creep * contacts.slip_scale();
        let [quadrature, _] = lubricated.rules.oil_and_dry(self.accuracy);
        let newton = &mut traction.newton;
        let ball = SlipBall::of_contacts(&contacts, quadrature, creep).of(&root);
        let system =
            SlipBall { frozen_rules: Some(&frozen_rules), ..ball.lubricated(values).complete(1.0) };
        let moving = SlipBall {
            frozen_rules: Some(&frozen_rules),
            lubrication: Some(Lubrication { ehl, fraction: 1.0, complete: true }),
            ..SlipBall::of_contacts(&inputs, quadrature, creep).of(&root)
        };
        let weights = ball.weights(&root.unknowns);
        let y = moving_root(&system, &root.unknowns, &weights, |y| moving.residual(y), newton)?;
        let found = moving.evaluated(&y).map_err(domain_error)?;
        let loaded = moving.loaded(&y).map_err(domain_error)?;
        let to_nut = moving.motion_to_nut(&y, &loaded);
        let motions = to_both(&to_nut, &loaded.frame);
        let losses = std::array::from_fn(|i| {
            ehl.loss_of(i, (&inputs, &loaded), &motions[i], creep, found.sliding[i])
        });
        let torque = found.torque * self.screw.point.units().torque;
        Ok((inputs, LubricatedState { loaded, to_nut, losses, torque }))
    }
}
