//! Roots of the traction equations that Newton's method finds from starting values, and criteria
//! for accepting these roots.
//!
//! Theory: `docs/theory/09-traction.md`, equations (T10), (T24) and (T25).

use std::cell::OnceCell;
use std::f64::consts::FRAC_PI_2;

use bsm_kin::Helix;
use bsm_newton::Outcome;

use super::equations::{Evaluation, OMEGA, PowerFlow, SlipBall};
use crate::contact::{POWER_BALANCE_TOL, Power, ideal_torque};
use crate::ellipse::FrozenRule;
use crate::models::ball::{BALL_UNKNOWNS, BallLoads, Reason, Workspace, quadrature_error};

/// Minimum creep speed in the first Newton step, divided by `$r_b|W|$`. At this creep speed,
/// friction is nearly proportional to the slip for most starting values.
const FIRST_STEP_CREEP: f64 = 0.1;

/// Upper bound of the components of the angular velocity of a ball, divided by `$W$`. The friction
/// power of a faster ball would exceed the power of the screw.
const MAX_ANGULAR_SPEED: f64 = 1e9;

/// Ratio of centrifugal force to axial load above which the unknowns (T10) are used. Above this
/// ratio, the contact angle at the nut would be the difference of two nearly equal angles, with
/// fewer than ten significant digits.
pub(super) const LARGE_INERTIA: f64 = 1e6;

/// A root of the traction equations at an operating point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SlipRoot {
    pub(super) unknowns: [f64; BALL_UNKNOWNS],
    /// True if the unknowns for high centrifugal loads (T10) are used.
    pub(super) uses_nut_angle: bool,
    pub(super) residual: f64,
}

/// A root of the traction equations with its torque, powers and contacts.
pub(super) struct RefinedRoot {
    pub(super) root: SlipRoot,
    pub(super) transmitted: PowerFlow,
    /// Derivatives of the torque with respect to the unknowns, near the root.
    pub(super) torque_slope: [f64; BALL_UNKNOWNS],
    /// Loaded contacts at the root.
    pub(super) loaded: BallLoads<f64>,
}

/// Returns true if no contact angle is more than `margin` \[rad\] beyond its flank.
pub(super) fn are_on_flanks(angles: [f64; 2], margin: f64) -> bool {
    angles.iter().all(|angle| (-margin..FRAC_PI_2 + margin).contains(angle))
}

impl<P: Copy> SlipBall<'_, P> {
    /// Returns the equations, expressed in the same set of unknowns as the given root.
    pub(super) fn of(&self, root: &SlipRoot) -> Self {
        Self { uses_nut_angle: root.uses_nut_angle, ..*self }
    }
}

impl SlipBall<'_> {
    /// Refines a root that was found with another quadrature. Returns `None` if Newton's method
    /// fails or a contact is not on its flank.
    ///
    /// The node counts of the quadrature stay fixed during the solve, because the iteration could
    /// otherwise jump between different node counts near a root. On return, `newton` contains the
    /// Jacobian.
    ///
    /// * `frozen_rules`: empty on entry; contains the node counts on return.
    pub(super) fn refined(
        &self,
        near: &SlipRoot,
        frozen_rules: &[OnceCell<FrozenRule>; 2],
        newton: &mut Workspace,
        steps: &mut usize,
    ) -> Option<RefinedRoot> {
        let mut unknowns = near.unknowns;
        let ball = SlipBall { frozen_rules: Some(frozen_rules), ..self.of(near) };
        let Outcome { report, last, slopes } = ball.run(&mut unknowns, newton);
        *steps += report.steps.len();
        if !report.converged() {
            return None;
        }
        let ((residual, mut transmitted), torque_slope) = last.zip(slopes)?;
        // The last Newton step is so small that its second-order effect on the torque is
        // negligible.
        for (k, step) in newton.correction(&residual).ok()?.into_iter().enumerate() {
            unknowns[k] += step;
            transmitted.torque += step * torque_slope[k];
        }
        let root = SlipRoot { unknowns, residual: report.residual, ..*near };
        let loaded = self.admitted(&root).ok()?;
        Some(RefinedRoot { root, transmitted, torque_slope, loaded })
    }

    /// Takes one Newton step from a ball without slip. The creep speed is the specified creep
    /// speed, but at least [`FIRST_STEP_CREEP`]. Returns `None` if the equations cannot be
    /// evaluated or the Jacobian is singular.
    pub(super) fn first_slips(
        &self,
        y: &[f64; BALL_UNKNOWNS],
        newton: &mut Workspace,
        steps: &mut usize,
    ) -> Option<[f64; BALL_UNKNOWNS]> {
        *steps += 1;
        let level = Self { creep: FIRST_STEP_CREEP.max(self.creep), ..*self };
        let residual = newton.linearize(&level, y, &level.weights(y)).ok()?;
        level.stepped(y, &residual, newton)
    }

    /// Returns the unknowns after a Newton step for the given residual, using the Jacobian stored
    /// in `newton`. Returns `None` if the Jacobian is singular.
    fn stepped(
        &self,
        y: &[f64; BALL_UNKNOWNS],
        residual: &[f64; BALL_UNKNOWNS],
        newton: &mut Workspace,
    ) -> Option<[f64; BALL_UNKNOWNS]> {
        Some(self.with_slips(y, &newton.correction(residual).ok()?))
    }

    /// Returns the root to which Newton's method converges from the starting values `y`.
    ///
    /// # Errors
    ///
    /// Returns a [`Reason`] if Newton's method fails, a contact is not on its flank, or the ball
    /// rotates too fast.
    pub(super) fn solved(
        &self,
        mut y: [f64; BALL_UNKNOWNS],
        newton: &mut Workspace,
        steps: &mut usize,
    ) -> Result<SlipRoot, Reason> {
        let Outcome { report, last, .. } = self.run(&mut y, newton);
        *steps += report.steps.len();
        if !report.converged() {
            return Err(report.into());
        }
        if self.is_coarse_solve() {
            // The residual after the final step is not evaluated.
            let next = last.and_then(|(residual, _)| self.stepped(&y, &residual, newton));
            y = next.unwrap_or(y);
        }
        let root = self.with_nut_angle(y, report.residual, newton, steps);
        self.admitted(&root).map(|_| root)
    }

    /// Creates a root from the unknowns `y`. If the centrifugal load is high, the unknowns are
    /// converted to the set (T10), provided that the conversion succeeds.
    pub(super) fn with_nut_angle(
        &self,
        y: [f64; BALL_UNKNOWNS],
        residual: f64,
        newton: &mut Workspace,
        steps: &mut usize,
    ) -> SlipRoot {
        let root = SlipRoot { unknowns: y, uses_nut_angle: self.uses_nut_angle, residual };
        let rate = self.rate(&y);
        if self.uses_nut_angle || self.contacts.inertia_ratio() * rate * rate <= LARGE_INERTIA {
            return root;
        }
        let Ok(loaded) = self.loaded(&y) else { return root };
        let to_nut = self.motion_to_nut(&y, &loaded);
        let ball = Self { uses_nut_angle: true, ..*self };
        let mut unknowns = ball.unknowns(&loaded, &to_nut);
        let report = ball.run(&mut unknowns, newton).report;
        *steps += report.steps.len();
        let converted = SlipRoot { unknowns, uses_nut_angle: true, residual: report.residual };
        if report.converged() { converted } else { root }
    }

    /// Returns true if both contacts of a root are on their flanks.
    pub(super) fn is_admissible(&self, root: &SlipRoot) -> bool {
        self.admitted(root).is_ok()
    }

    /// Returns the loaded contacts at a root after checking that the root is admissible.
    ///
    /// # Errors
    ///
    /// Returns a [`Reason`] if a contact is not on its flank, or if the ball rotates faster than
    /// [`MAX_ANGULAR_SPEED`], because such a state is not a root.
    fn admitted(&self, root: &SlipRoot) -> Result<BallLoads<f64>, Reason> {
        let y = &root.unknowns;
        let loaded = self.of(root).loaded(y).map_err(|error| Reason::Refused { error })?;
        if !are_on_flanks(loaded.angles, 0.0) {
            let [nut, screw] = loaded.angles;
            return Err(Reason::BallLeavesFlank { nut, screw });
        }
        let is_slow = OMEGA.iter().all(|i| y[*i].abs() < MAX_ANGULAR_SPEED);
        if !is_slow {
            return Err(Reason::SearchFailed);
        }
        Ok(loaded)
    }

    /// Returns true if the root satisfies the power balance (B10).
    ///
    /// The residual also tends to zero for a ball that rotates faster and faster about the screw
    /// axis. Such a state is not a root, and it violates the power balance.
    pub(super) fn is_balanced(&self, root: &SlipRoot) -> bool {
        let contacts = self.contacts;
        self.of(root).evaluated(&root.unknowns).is_ok_and(|found: Evaluation| {
            let ideal = ideal_torque(1.0, contacts.helix.radius, contacts.helix.lead_angle.tan());
            let PowerFlow { torque, power, .. } = found.power_flow();
            let imbalance = Power::transmitted(torque, ideal, 1.0).imbalance(power);
            imbalance.abs() <= POWER_BALANCE_TOL
        })
    }

    /// Returns an error bound of the efficiency due to the quadrature (T25), estimated with a
    /// second quadrature rule. If the estimate fails, the whole power loss is returned as the error
    /// bound.
    ///
    /// * `accuracy`: accuracy of the quadrature with which the root was found.
    /// * `found`: residuals and torque at the root, evaluated with the second quadrature rule.
    /// * `slope`: derivatives of the torque with respect to the unknowns.
    /// * `efficiency`: efficiency at the root.
    /// * `newton`: buffers that contain the Jacobian at the root.
    pub(super) fn error(
        &self,
        accuracy: f64,
        found: Option<&Evaluation>,
        slope: &[f64; BALL_UNKNOWNS],
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
