//! Quasi-static model of a ball with two contacts. The model neglects inertia, but includes slip in
//! the normal plane and rolling resistance.
//!
//! Theory: `docs/theory/03-closed-form.md`, equations (Q1) to (Q4).

use bsm_kin::{Real, Scalar};

use crate::contact::{Angles, Coulomb, Sines};
use crate::models::ball::{
    BallState, Direction, Evidence, Model, Performance, Reason, Solution, SolveFailure,
};
use crate::models::closed_form::{ScrewSize, performance, steady_state};

/// Inputs of the quasi-static model of a ball with two contacts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QuasiStatic<D = f64> {
    /// Lead angle and contact angle.
    pub angles: Angles<D>,
    /// Coulomb friction coefficient `$f \ge 0$`.
    pub friction: Coulomb<D>,
    /// Ratio of ball radius to pitch circle radius `$r_b/r_m$`.
    pub size_ratio: D,
    /// Ratio of the lever arm of rolling resistance to the ball radius `$f_r/r_b \ge 0$`.
    pub rolling_ratio: D,
    /// Rotating body, on which the torque acts.
    pub driven: DrivenBody,
    /// Direction of the power flow (driving or back-driving).
    pub direction: Direction,
    /// Size and load of the screw, if the torque is requested.
    pub size: Option<ScrewSize<D>>,
}

/// The rotating body: screw, nut or both.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DrivenBody {
    /// Only the screw rotates.
    Screw,
    /// Only the nut rotates.
    Nut,
    /// Both the screw and the nut rotate. The quasi-static equations do not cover this case.
    Both,
}

/// Quantities in the force balance of a ball with two contacts. The friction terms are negative if
/// the load back-drives the screw.
#[derive(Debug, Clone, Copy)]
pub struct TwoContacts<D: Real> {
    /// Sines and cosines of the lead angle and the contact angle.
    pub sines: Sines<D>,
    /// Signed friction coefficient `$f$`.
    pub friction: D,
    /// Signed ratio of the lever arm of rolling resistance to the ball radius `$f_r/r_b$`.
    pub rolling_ratio: D,
    /// Ratio of ball radius to pitch circle radius `$r_b/r_m$`.
    pub size_ratio: D,
    /// True if the nut rotates instead of the screw.
    pub nut_turns: D::Mask,
}

/// Returns the tangent of the angle of rolling resistance `$\tan\rho$` (Q1).
///
/// * `ratio`: ratio of the lever arm of rolling resistance to the ball radius `$f_r/r_b$`.
/// * `sin`: sine of the contact angle.
#[inline(always)]
pub fn rolling_tangent<D: Real>(ratio: D, sin: D) -> D {
    // tanρ = f_r / (r_b sinβ)                                             (Q1)
    ratio / sin
}

impl<D: Real> TwoContacts<D> {
    #[inline(always)]
    fn tan_rho(&self) -> D {
        rolling_tangent(self.rolling_ratio, self.sines.sin_b)
    }

    /// Returns the efficiency for the conversion of rotary to linear motion (Q1) to (Q3).
    ///
    /// ```math
    /// \eta = 1 - \frac{f(r_b/r_m + \epsilon) + \tan\rho/(\cos\alpha\sin\alpha)}
    ///   {\sin\beta + f(r_b/r_m \mp \cos\beta) + \tan\rho/\tan\alpha}, \qquad
    /// \tan\rho = \frac{f_r}{r_b\sin\beta}
    /// ```
    /// In the equations above, the upper sign and `$\epsilon = 0$` apply if the screw rotates. The
    /// lower sign and `$\epsilon = 2\cos\beta$` apply if the nut rotates.
    ///
    /// Source: Lin, Velinsky and Ravani, ASME J. Mech. Des. 116 (1994), Eqs 1-4.
    #[inline(always)]
    fn forward_efficiency(&self) -> D {
        let Sines { sin_a, cos_a, sin_b, cos_b } = self.sines;
        let (f, size, tan_rho) = (self.friction, self.size_ratio, self.tan_rho());
        // Screw drive: loss f r_b/r_m, lever r_b/r_m − cosβ               (Q2)
        // Nut drive: loss f (r_b/r_m + 2 cosβ), lever r_b/r_m + cosβ      (Q3)
        let loss = f * D::select(self.nut_turns, size + cos_b * 2.0, size);
        let lever = D::select(self.nut_turns, size + cos_b, size - cos_b);
        let effort = sin_b + f * lever + tan_rho * cos_a / sin_a;
        -((loss + tan_rho / (cos_a * sin_a)) / effort) + 1.0
    }

    /// Returns the efficiency for driving or back-driving.
    ///
    /// * `back`: true if the load back-drives the screw.
    #[inline(always)]
    pub fn efficiency(&self, back: D::Mask) -> D {
        let forward = self.forward_efficiency();
        D::select(back, forward.recip(), forward)
    }

    /// Returns the ratio of normal load to axial load per ball (Q4), which is not positive if
    /// friction alone can hold any axial load.
    #[inline(always)]
    pub fn load_ratio(&self) -> D {
        let Sines { sin_a, cos_a, sin_b, cos_b } = self.sines;
        // Q/F_a = 1 / [cosα (sinβ − f cosβ) − sinα tanρ]                  (Q4)
        (cos_a * (sin_b - self.friction * cos_b) - sin_a * self.tan_rho()).recip()
    }
}

impl<D: Scalar> QuasiStatic<D> {
    /// Creates the two contacts. The signs of the friction terms depend on the direction of power
    /// flow.
    fn contacts(&self) -> TwoContacts<D> {
        let sign = self.direction.sign();
        TwoContacts {
            sines: self.angles.sines(),
            friction: self.friction.0 * sign,
            rolling_ratio: self.rolling_ratio * sign,
            size_ratio: self.size_ratio,
            nut_turns: self.driven == DrivenBody::Nut,
        }
    }

    /// Returns the efficiency for the given direction of power flow. Back-driving reverses the sign
    /// of every friction term.
    pub fn efficiency(&self) -> D {
        self.contacts().efficiency(self.direction.is_back())
    }

    /// Returns the ratio of normal load to axial load per ball, after checking that the equations
    /// apply.
    ///
    /// # Errors
    /// Returns [`Reason::DualDrive`] if both bodies rotate, and [`Reason::FrictionHoldsLoad`] if
    /// friction alone can hold any axial load.
    fn load_ratio(&self, contacts: &TwoContacts<D>) -> Result<D, SolveFailure> {
        if self.driven == DrivenBody::Both {
            return Err(SolveFailure::invalid(Reason::DualDrive));
        }
        let ratio = contacts.load_ratio();
        let load_ratio = ratio.re();
        if load_ratio <= 0.0 {
            return Err(SolveFailure::no_solution(
                Evidence::Proof,
                Reason::FrictionHoldsLoad { load_ratio },
            ));
        }
        Ok(ratio)
    }

    /// Checks that the force balance of the contacts has a solution.
    ///
    /// # Errors
    ///
    /// Returns [`Reason::DualDrive`] if both bodies rotate, and [`Reason::FrictionHoldsLoad`] if
    /// friction holds any axial load.
    pub(crate) fn require_balance(&self) -> Result<(), SolveFailure> {
        self.load_ratio(&self.contacts()).map(drop)
    }

    /// Returns the efficiency, and also the torque if size and load are given.
    pub(crate) fn transmitted(&self) -> Performance<D> {
        let contacts = self.contacts();
        let efficiency = contacts.efficiency(self.direction.is_back());
        let lead = (self.direction, contacts.sines.tan_a());
        performance(efficiency, contacts.load_ratio(), self.size, lead)
    }
}

impl QuasiStatic {
    /// Evaluates the equations of the quasi-static model.
    pub fn solve(&self) -> Solution {
        let contacts = self.contacts();
        let ratio = match self.load_ratio(&contacts) {
            Ok(ratio) => ratio,
            Err(failure) => return Solution::new(Model::QuasiStatic, Err(failure)),
        };
        let eta = contacts.efficiency(self.direction.is_back());
        let ball = BallState::at_angle(self.angles.contact);
        let lead = (self.direction, contacts.sines.tan_a());
        let solved = steady_state(&ball, (eta, eta <= 0.0), ratio, self.size, lead);
        // The solution is built in place, because copying it would take as long as evaluating the
        // formulas.
        Solution::new(Model::QuasiStatic, Ok(solved))
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_4, PI};

    use approx::assert_relative_eq;
    use proptest::prelude::*;

    use super::*;

    /// Example from the paper of Lin, Velinsky and Ravani (1994).
    const LIN: QuasiStatic = QuasiStatic {
        angles: Angles { lead: PI / 18.0, contact: FRAC_PI_4 },
        friction: Coulomb(0.075),
        size_ratio: 4.37 / 24.3,
        rolling_ratio: 0.0,
        driven: DrivenBody::Screw,
        direction: Direction::RotaryToLinear,
        size: None,
    };

    /// Hand calculation for the screw: 0.075 × 0.179835 / (0.707107 + 0.075 (0.179835 − 0.707107)).
    #[test]
    fn efficiency_of_lins_example_agrees_with_hand_calculation() {
        // The hand calculation was done with six digits.
        assert_relative_eq!(LIN.efficiency(), 1.0 - 0.020_204_4, epsilon = 1e-7);
        // Hand calculation for the nut: 0.075 (0.179835 + 1.414214) / (0.707107 + 0.075 ×
        // 0.886942).
        let nut = QuasiStatic { driven: DrivenBody::Nut, ..LIN };
        assert_relative_eq!(nut.efficiency(), 1.0 - 0.154_536_5, epsilon = 1e-7);
    }

    proptest! {
        /// In an earlier version, numerator and denominator became negative together, and the
        /// efficiency exceeded one.
        #[test]
        fn efficiency_never_exceeds_one(
            lead in 0.001..1.5_f64, contact in 0.01..1.56_f64, friction in 0.0..1.0_f64,
            size in 0.01..0.45_f64, rolling in 0.0..0.05_f64, nut in any::<bool>(), back in any::<bool>(),
        ) {
            let case = QuasiStatic {
                angles: Angles { lead, contact },
                friction: Coulomb(friction),
                size_ratio: size,
                rolling_ratio: rolling,
                driven: if nut { DrivenBody::Nut } else { DrivenBody::Screw },
                direction: if back { Direction::LinearToRotary } else { Direction::RotaryToLinear },
                size: None,
            };
            let solution = case.solve();
            let (eta, locked) = (solution.efficiency(), solution.self_locking());
            let fits = eta.map_or(locked == Some(true), |eta| eta <= 1.0 + 1e-12);
            prop_assert!(fits, "{case:?} {solution:?}");
        }
    }

    #[test]
    fn screw_without_friction_has_no_loss() {
        for direction in [Direction::RotaryToLinear, Direction::LinearToRotary] {
            for driven in [DrivenBody::Screw, DrivenBody::Nut] {
                let ideal = QuasiStatic { friction: Coulomb(0.0), direction, driven, ..LIN };
                assert_relative_eq!(ideal.efficiency(), 1.0);
            }
        }
    }

    /// Rolling resistance without sliding friction acts like a wedge with the friction angle ρ',
    /// where `$\tan\rho' = \tan\rho/\sin\beta$`: `$\eta = \tan\alpha/\tan(\alpha + \rho')$`.
    #[test]
    fn efficiency_with_only_rolling_resistance_equals_the_efficiency_of_a_wedge() {
        let rolling = QuasiStatic { friction: Coulomb(0.0), rolling_ratio: 2.3e-3, ..LIN };
        let (lead, contact) = (LIN.angles.lead, LIN.angles.contact);
        let rho = (2.3e-3 / contact.sin().powi(2)).atan();
        let wedge = lead.tan() / (lead + rho).tan();
        assert_relative_eq!(rolling.efficiency(), wedge, max_relative = 1e-14);
        let back = QuasiStatic { direction: Direction::LinearToRotary, ..rolling };
        let wedge = (lead - rho).tan() / lead.tan();
        assert_relative_eq!(back.efficiency(), wedge, max_relative = 1e-14);
    }

    #[test]
    fn dual_drive_is_rejected() {
        let solution = QuasiStatic { driven: DrivenBody::Both, ..LIN }.solve();
        assert_eq!(solution.status(), crate::Status::InvalidInput);
        assert_eq!(solution.self_locking(), None);
    }
}
