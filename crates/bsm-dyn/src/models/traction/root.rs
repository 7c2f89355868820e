//! The root that a start leads to, and what makes it one.
//!
//! Theory: `docs/theory/09-traction.md`, equations (T10), (T24) and (T25).

use std::cell::OnceCell;
use std::f64::consts::FRAC_PI_2;

use bsm_kin::Helix;
use bsm_newton::Outcome;

use super::equations::{Evaluation, OMEGA, PowerFlow, SlipBall};
use crate::contact::{POWER_BALANCE_TOL, Power, ideal_torque};
use crate::ellipse::FrozenRule;
use crate::models::ball::{BALL, BallLoads, Reason, Workspace, quadrature_error};

/// Maximum Newton steps, and maximum halvings of a step, of a solve from a starting value. More
/// halvings cost more than the continuation.
pub(super) const START_LIMITS: (usize, u32) = (12, 2);

/// Creep speed over `$r_b|W|$` of the first step: against it, friction is nearly linear in the slips
/// of most starting values.
const LEVEL: f64 = 0.1;

/// Upper bound of the angular speed of a ball over `$W$`: the friction of a faster ball would exceed the power of the screw.
const MAX_ANGULAR_SPEED: f64 = 1e9;

/// Centrifugal force over the load from which the contact angle at the nut has less than ten digits as
/// a difference of two others.
pub(super) const LARGE_INERTIA: f64 = 1e6;

/// A root of the equations of a point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SlipRoot {
    pub(super) unknowns: [f64; BALL],
    /// The unknowns are those of a ball under a high centrifugal load (T10).
    pub(super) nut_chart: bool,
    pub(super) residual: f64,
}

/// A root with what belongs to it.
pub(super) struct RootWithPower {
    pub(super) root: SlipRoot,
    pub(super) transmitted: PowerFlow,
    /// Derivatives of the torque by the unknowns, near the root.
    pub(super) torque_slope: [f64; BALL],
    /// Its contacts.
    pub(super) loaded: BallLoads<f64>,
}

/// True if no contact is more than `margin` beyond its flank.
pub(super) fn are_on_flanks(angles: [f64; 2], margin: f64) -> bool {
    angles.iter().all(|angle| (-margin..FRAC_PI_2 + margin).contains(angle))
}

impl<P: Copy> SlipBall<'_, P> {
    /// The equations in the unknowns of a root.
    pub(super) fn of(&self, root: &SlipRoot) -> Self {
        Self { nut_chart: root.nut_chart, ..*self }
    }
}

impl SlipBall<'_> {
    /// The root near one of another quadrature, if it is on the flanks, with the numbers of nodes that it
    /// has there: a root may lie where they change. `newton` keeps its Jacobian.
    ///
    /// * `frozen_rules`: filled.
    pub(super) fn refined(
        &self,
        near: &SlipRoot,
        frozen_rules: &[OnceCell<FrozenRule>; 2],
        newton: &mut Workspace,
        steps: &mut usize,
    ) -> Option<RootWithPower> {
        let mut unknowns = near.unknowns;
        let ball = SlipBall { frozen_rules: Some(frozen_rules), ..self.of(near) };
        let Outcome { report, last, slopes } = ball.run(&mut unknowns, newton);
        *steps += report.steps.len();
        if !report.converged() {
            return None;
        }
        let ((residual, mut transmitted), torque_slope) = last.zip(slopes)?;
        // The last step is far below what a torque has as digits beyond its first order.
        for (k, step) in newton.correction(&residual).ok()?.into_iter().enumerate() {
            unknowns[k] += step;
            transmitted.torque += step * torque_slope[k];
        }
        let root = SlipRoot { unknowns, residual: report.residual, ..*near };
        let loaded = self.admitted(&root)?;
        Some(RootWithPower { root, transmitted, torque_slope, loaded })
    }

    /// Takes one Newton step with the creep speed [`LEVEL`] from a ball without slips.
    pub(super) fn first_slips(
        &self,
        y: &[f64; BALL],
        newton: &mut Workspace,
        steps: &mut usize,
    ) -> Option<[f64; BALL]> {
        *steps += 1;
        let level = Self { creep: LEVEL.max(self.creep), ..*self };
        let residual = newton.linearize(&level, y, &level.weights(y)).ok()?;
        level.stepped(y, &residual, newton)
    }

    /// Where the step of a residual leads to, with the Jacobian that `newton` has.
    fn stepped(
        &self,
        y: &[f64; BALL],
        residual: &[f64; BALL],
        newton: &mut Workspace,
    ) -> Option<[f64; BALL]> {
        Some(self.slid(y, &newton.correction(residual).ok()?))
    }

    /// The root that Newton finds from `y`, if it is on the flanks.
    pub(super) fn solved(
        &self,
        mut y: [f64; BALL],
        newton: &mut Workspace,
        steps: &mut usize,
    ) -> Result<SlipRoot, Reason> {
        let Outcome { report, last, .. } = self.run(&mut y, newton);
        *steps += report.steps.len();
        if report.converged() {
            if self.is_first_try() {
                // The last step is taken without an evaluation.
                let next = last.and_then(|(residual, _)| self.stepped(&y, &residual, newton));
                y = next.unwrap_or(y);
            }
            let root = self.in_nut_chart(y, report.residual, newton, steps);
            if self.is_admissible(&root) {
                return Ok(root);
            }
        }
        Err(report.into())
    }

    /// The root with these unknowns; in the unknowns (T10) if the centrifugal load is high.
    pub(super) fn in_nut_chart(
        &self,
        y: [f64; BALL],
        residual: f64,
        newton: &mut Workspace,
        steps: &mut usize,
    ) -> SlipRoot {
        let root = SlipRoot { unknowns: y, nut_chart: self.nut_chart, residual };
        let rate = self.rate(&y);
        if self.nut_chart || self.contacts.inertia_ratio() * rate * rate <= LARGE_INERTIA {
            return root;
        }
        let Ok(loaded) = self.loaded(&y) else { return root };
        let to_nut = self.motion_to_nut(&y, &loaded);
        let ball = Self { nut_chart: true, ..*self };
        let mut unknowns = ball.unknowns(&loaded, &to_nut);
        let report = ball.run(&mut unknowns, newton).report;
        *steps += report.steps.len();
        let charted = SlipRoot { unknowns, nut_chart: true, residual: report.residual };
        if report.converged() { charted } else { root }
    }

    /// True for a root with both contacts on their flanks.
    pub(super) fn is_admissible(&self, root: &SlipRoot) -> bool {
        self.admitted(root).is_some()
    }

    /// The contacts of a root that has both on their flanks.
    fn admitted(&self, root: &SlipRoot) -> Option<BallLoads<f64>> {
        let y = &root.unknowns;
        let loaded = self.of(root).loaded(y).ok()?;
        let slow = OMEGA.iter().all(|i| y[*i].abs() < MAX_ANGULAR_SPEED);
        (slow && are_on_flanks(loaded.angles, 0.0)).then_some(loaded)
    }

    /// True for a root whose powers balance. Where a ball turns faster and faster about the axis the
    /// residual vanishes without a root, and the powers do not balance.
    pub(super) fn is_balanced(&self, root: &SlipRoot) -> bool {
        let contacts = self.contacts;
        self.of(root).evaluated(&root.unknowns).is_ok_and(|found: Evaluation| {
            let ideal = ideal_torque(1.0, contacts.helix.radius, contacts.helix.lead_angle.tan());
            let PowerFlow { torque, power, .. } = found.power_flow();
            let imbalance = Power::transmitted(torque, ideal, 1.0).imbalance(power);
            imbalance.abs() <= POWER_BALANCE_TOL
        })
    }

    /// Bound of the error of the efficiency of a root of another quadrature, from that of this one (T25).
    ///
    /// * `accuracy`: of the other one. * `found`: there, of this quadrature. * `slope`: of the torque by the unknowns. * `newton`: as the solve
    ///   for the root has left it.
    pub(super) fn error(
        &self,
        accuracy: f64,
        found: Option<&Evaluation>,
        slope: &[f64; BALL],
        efficiency: f64,
        newton: &mut Workspace,
    ) -> f64 {
        let other = found.and_then(|found| {
            // y' = y − J⁻¹ F'(y)                                          (T24)
            let step = newton.correction(&found.residual).ok()?;
            let further = step.iter().zip(slope).map(|(x, slope)| x * slope).sum::<f64>();
            let torque = found.torque + further;
            let Helix { radius, lead_angle } = self.contacts.helix;
            let ideal = ideal_torque(1.0, radius, lead_angle.tan());
            Some(crate::contact::efficiency(self.contacts.direction.is_back(), ideal, torque))
        });
        let other = other.unwrap_or(f64::NAN);
        let error = quadrature_error(other - efficiency, accuracy);
        if error.is_finite() { error } else { (1.0 - efficiency).abs() }
    }
}
