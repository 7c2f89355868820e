//! Lin's closed-form model: efficiency, slip directions, optimum and self-locking as functions of
//! lead angle and contact angle.
//!
//! Theory: `docs/theory/03-closed-form.md`, equations (C1) to (C20).

use bsm_kin::{Real, Scalar};

use crate::contact::{Angles, Coulomb, Load, Power, ideal_torque, torque_of};
use crate::models::ball::{
    BallState, Direction, Model, Performance, Solution, SteadyState, Transmission,
};

/// Size and load of a screw. Models without inertia need them for the torque, but not for the
/// efficiency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScrewSize<D = f64> {
    /// Pitch circle radius `$r_m$` \[m\].
    pub pitch_radius: D,
    /// External load on the balls.
    pub load: Load<D>,
    /// Relative speed `$W$` \[rad/s\], if known; required for the powers.
    pub relative_speed: Option<D>,
}

/// Returns true if the screw can be turned, that is, if it is not self-locking.
///
/// * `back`: true if the load back-drives the screw.
/// * `load_ratio`: normal load divided by axial load per ball.
#[inline(always)]
pub(crate) fn turns<F: Real>(back: F::Mask, efficiency: F, load_ratio: F) -> F::Mask {
    (back | efficiency.above(0.0)) & load_ratio.above(0.0) & load_ratio.below(f64::INFINITY)
}

impl<F: Real> ScrewSize<F> {
    /// Returns the torque of the frictionless screw and the torque of the screw with friction. Both
    /// are NaN if the screw cannot be turned.
    ///
    /// * `back`: true if the load back-drives the screw.
    /// * `tan_a`: tangent of the lead angle.
    #[inline(always)]
    fn torques(&self, turns: F::Mask, (back, tan_a): (F::Mask, F), efficiency: F) -> (F, F) {
        let ideal = ideal_torque(self.load.axial, self.pitch_radius, tan_a);
        let ideal = F::select(turns, ideal, tan_a.constant(f64::NAN));
        (ideal, torque_of(back, ideal, efficiency))
    }
}

/// Returns the given efficiency together with the torque, which is calculated from the efficiency
/// and from the ratio of normal load to axial load.
pub(crate) fn performance<D: Scalar>(
    efficiency: D,
    load_ratio: D,
    size: Option<ScrewSize<D>>,
    (direction, tan_a): (Direction, D),
) -> Performance<D> {
    let back = direction.is_back();
    let size = size.filter(|_| turns(back, efficiency.re(), load_ratio.re()));
    let torque = |size: ScrewSize<D>| size.torques(true, (back, tan_a), efficiency).1;
    Performance { efficiency, screw_torque: size.map(torque) }
}

/// Calculates the steady state from the efficiency and the ratio of normal load to axial load.
/// Torque and loads are NaN if the screw cannot be turned.
///
/// * `back`: true if the load back-drives the screw.
/// * `tan_a`: tangent of the lead angle.
#[inline(always)]
pub fn transmitted<F: Real>(
    mut ball: BallState<F>,
    (efficiency, self_locking): (F, F::Mask),
    load_ratio: F,
    size: Option<ScrewSize<F>>,
    (back, tan_a): (F::Mask, F),
) -> SteadyState<F> {
    let mut transmission = Transmission {
        efficiency,
        self_locking,
        screw_torque: None,
        power: None,
        power_balance: None,
    };
    if let Some(size) = size {
        let turns = turns(back, efficiency, load_ratio);
        let (ideal, torque) = size.torques(turns, (back, tan_a), efficiency);
        transmission.screw_torque = Some(torque);
        if let Some(speed) = size.relative_speed {
            transmission.power = Some(Power::transmitted(torque, ideal, speed));
        }
        let load = load_ratio * size.load.per_ball();
        let load = F::select(turns, load, load.constant(f64::NAN));
        (ball.nut.load, ball.screw.load) = (Some(load), Some(load));
    }
    SteadyState::new(&ball, transmission)
}

/// Returns the result of [`transmitted`] for a single point. If the screw cannot be turned, torque
/// and loads are `None`.
pub(crate) fn steady_state(
    ball: &BallState,
    (efficiency, self_locking): (f64, bool),
    load_ratio: f64,
    size: Option<ScrewSize>,
    (direction, tan_a): (Direction, f64),
) -> SteadyState {
    let back = direction.is_back();
    let size = size.filter(|_| turns(back, efficiency, load_ratio));
    transmitted(*ball, (efficiency, self_locking), load_ratio, size, (back, tan_a))
}

/// Inputs of the closed-form model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClosedForm<D = f64> {
    /// Lead angle and contact angle.
    pub angles: Angles<D>,
    /// Coulomb friction coefficient `$f \ge 0$`.
    pub friction: Coulomb<D>,
    /// Direction of the power flow (driving or back-driving).
    pub direction: Direction,
    /// Size and load of the screw; required for the torque.
    pub size: Option<ScrewSize<D>>,
}

impl<D: Scalar> ClosedForm<D> {
    /// Returns the efficiency, and also the torque if size and load are given.
    pub(crate) fn transmitted(&self) -> Performance<D> {
        let (sines, f, back) = (self.angles.sines(), self.friction.0, self.direction.is_back());
        let (efficiency, ratio) = (sines.efficiency(back, f), sines.load_ratio(back, f));
        performance(efficiency, ratio, self.size, (self.direction, sines.tan_a()))
    }
}

impl ClosedForm {
    /// Evaluates the closed form, which gives an efficiency for all valid inputs.
    pub fn solve(&self) -> Solution {
        let (sines, f, back) = (self.angles.sines(), self.friction.0, self.direction.is_back());
        let mut ball = BallState::at_angle(self.angles.contact);
        [ball.nut.slip_angle, ball.screw.slip_angle] = sines.slip_angles(back).map(Some);
        let found = (sines.efficiency(back, f), sines.self_locking(back, f));
        let (ratio, lead) = (sines.load_ratio(back, f), (self.direction, sines.tan_a()));
        let solved = steady_state(&ball, found, ratio, self.size, lead);
        Solution::new(Model::ClosedForm, Ok(solved))
    }
}

#[cfg(test)]
mod tests {
    use crate::angles::Optimum;
    use std::f64::consts::{FRAC_PI_2, PI};

    use approx::assert_relative_eq;
    use bsm_kin::{BallFrame, Contact, Site};
    use nalgebra::Vector3;
    use proptest::prelude::*;

    use super::*;
    use crate::contact::{Wrench, axial_force, efficiency, torque};

    /// Efficiency of Lin's example (dimensionless), calculated in decimal arithmetic with 40
    /// digits.
    const ETA_LIN: f64 = 0.860_111_653_874_581_8;
    /// Both directions of the power flow: driving and back-driving.
    const BOTH: [Direction; 2] = [Direction::RotaryToLinear, Direction::LinearToRotary];

    #[test]
    fn efficiency_of_lins_example_agrees_with_decimal_arithmetic() {
        let angles = Angles { lead: 10.0_f64.to_radians(), contact: 45.0_f64.to_radians() };
        let eta = angles.efficiency(Direction::RotaryToLinear, 0.075);
        assert_relative_eq!(eta, ETA_LIN, max_relative = 1e-14);
    }

    /// In an earlier version, the load was infinite exactly at the limit of self-locking.
    #[test]
    fn torque_and_load_are_finite_at_the_limit_of_self_locking() {
        let angles = Angles { lead: 10.0_f64.to_radians(), contact: 45.0_f64.to_radians() };
        let friction = angles.contact.sin() / angles.slip_factor();
        let load = Load { axial: 2113.0, balls: 1.0 };
        let size = ScrewSize { pitch_radius: 24.3e-3, load, relative_speed: None };
        let case = ClosedForm {
            angles,
            friction: Coulomb(friction),
            direction: Direction::RotaryToLinear,
            size: Some(size),
        };
        let solution = case.solve();
        let torque = solution.steady_state().expect("converged").transmission.screw_torque;
        let load = solution.contact(Site::Nut).expect("a contact").load;
        for value in [torque, load].into_iter().flatten() {
            // The friction coefficient is one rounding error away from the limit of self-locking,
            // so torque and load are large but finite.
            assert!(value.is_finite() && value > 0.0, "{solution:?}");
        }
    }

    /// The end points of Figure 5 in the paper of Lin, Velinsky and Ravani (slip across and along
    /// the groove) agree with a hand calculation.
    #[test]
    fn slip_across_the_groove_costs_less_power_than_slip_along_it() {
        let angles = Angles { lead: 10.0_f64.to_radians(), contact: 45.0_f64.to_radians() };
        let at = |psi| angles.efficiency_at(Direction::RotaryToLinear, 0.075, 0.1, psi);
        // Hand calculation with six digits for slip across the groove: (0.707107 − 0.0530330) /
        // (0.707107 + 0.075 (0.1 − 0.707107)).
        assert_relative_eq!(at(0.0), 0.654_073_8 / 0.661_573_8, epsilon = 1e-6);
        // Hand calculation for slip along the groove: (0.707107 − 0.0132245) / (0.707107 + 0.075 ×
        // 0.929289 / 0.176327).
        assert_relative_eq!(at(FRAC_PI_2), 0.693_882_3 / 1.102_376_4, epsilon = 1e-6);
    }

    #[test]
    fn screw_without_friction_has_no_loss() {
        let angles = Angles { lead: 0.17, contact: 0.8 };
        for direction in BOTH {
            assert_relative_eq!(angles.efficiency(direction, 0.0), 1.0);
            let ideal = 1.0 / (0.17_f64.cos() * 0.8_f64.sin());
            assert_relative_eq!(angles.load_ratio(direction, 0.0), ideal, max_relative = 1e-15);
            assert!(!angles.self_locking(direction, 0.0));
        }
    }

    proptest! {
        /// The efficiency of back-driving is the reciprocal of the efficiency of driving with
        /// negative friction: η_lr(f) = 1/η_rl(−f).
        #[test]
        fn back_driving_equals_driving_with_negative_friction(a in 0.01..1.4_f64, b in 0.05..1.5_f64, f in 0.0..0.5_f64) {
            let angles = Angles { lead: a, contact: b };
            let back = angles.efficiency(Direction::LinearToRotary, f);
            let mirrored = angles.efficiency(Direction::RotaryToLinear, -f);
            // The results differ only by rounding errors, except near the pole of the mirrored
            // formula, which is excluded.
            prop_assume!(mirrored.abs() < 1e3);
            prop_assert!((back * mirrored - 1.0).abs() <= 1e-10, "{back} {mirrored}");
        }

        /// The equivalent wedge (C16) has the angle φ with sinφ = cosα sinβ.
        #[test]
        fn efficiency_equals_wedge_efficiency(a in 0.01..1.4_f64, b in 0.05..1.5_f64, f in 0.0..0.5_f64) {
            let angles = Angles { lead: a, contact: b };
            let (phi, rho) = ((a.cos() * b.sin()).asin(), f.atan());
            let forward = (phi - rho).tan() / phi.tan();
            let back = phi.tan() / (phi + rho).tan();
            // The tolerance allows for the loss of digits in the arcsine near π/2.
            let close = |x: f64, y: f64| (x - y).abs() <= 1e-9 * (1.0 + y.abs());
            prop_assert!(close(angles.efficiency(Direction::RotaryToLinear, f), forward));
            prop_assert!(close(angles.efficiency(Direction::LinearToRotary, f), back));
        }

        /// The efficiency is exactly zero at the limit of self-locking and negative beyond it.
        #[test]
        fn screw_is_self_locking_if_its_efficiency_is_not_positive(a in 0.01..1.4_f64, b in 0.05..1.5_f64, f in 0.0..1.0_f64) {
            let angles = Angles { lead: a, contact: b };
            for direction in BOTH {
                let eta = angles.efficiency(direction, f);
                prop_assume!(eta.abs() > 1e-12);
                prop_assert_eq!(angles.self_locking(direction, f), eta < 0.0);
                prop_assert_eq!(f >= angles.locking_friction(direction), eta < 0.0);
                let border = angles.locking_friction(direction);
                // At the limit of self-locking, rounding errors are proportional to the friction
                // coefficient.
                prop_assert!(angles.efficiency(direction, border).abs() <= 1e-12 * border.max(1.0));
            }
        }

        /// The screw is self-locking on one side of the limit angle, and not on the other side.
        #[test]
        fn self_locking_changes_at_the_limit_angle(a in 0.01..1.4_f64, f in 0.01..1.0_f64) {
            let locks = |d, contact: f64| Angles { lead: a, contact }.self_locking(d, f);
            let Some(border) = Angles::locking_contact_angle(Direction::RotaryToLinear, a, f) else {
                panic!("friction locks the screw at some contact angle");
            };
            prop_assert!(locks(Direction::RotaryToLinear, border * (1.0 - 1e-9)));
            prop_assert!(border > 1.57 || !locks(Direction::RotaryToLinear, border * (1.0 + 1e-9)));
            match Angles::locking_contact_angle(Direction::LinearToRotary, a, f) {
                None => prop_assert!(!locks(Direction::LinearToRotary, FRAC_PI_2)),
                Some(border) => {
                    prop_assert!(border > 1.570 || locks(Direction::LinearToRotary, border + 1e-9));
                    prop_assert!(!locks(Direction::LinearToRotary, border - 1e-6));
                }
            }
        }

        /// For the slip direction of (C5), Equation 11 of the paper agrees with the closed form for
        /// balls of any size, and the numerator of Equation 11 vanishes at the limit of
        /// self-locking.
        #[test]
        fn efficiency_formulas_agree_at_the_closed_form_slip_angle(
            a in 0.02..1.3_f64, b in 0.1..1.5_f64, f in 0.0..0.15_f64, size in 0.0..0.3_f64,
        ) {
            let angles = Angles { lead: a, contact: b };
            for direction in BOTH {
                let psi = angles.screw_slip_angle(direction);
                let at = angles.efficiency_at(direction, f, size, psi);
                let eta = angles.efficiency(direction, f);
                // Rounding errors are amplified near self-locking, where the efficiency approaches
                // zero.
                prop_assert!((at - eta).abs() <= 1e-11 * (1.0 + eta.abs()), "{at} {eta}");
            }
            let border = b.sin() / angles.slip_factor();
            let psi = angles.screw_slip_angle(Direction::RotaryToLinear);
            let (force, torque) = angles.transmitted_at(border, size, psi);
            prop_assert!(force.abs() <= 1e-12 && torque > 1.0, "{force} {torque}");
        }

        /// The optimal contact angle as a function of the lead angle is the inverse of the optimal
        /// lead angle as a function of the contact angle. The limit angles of self-locking are
        /// inverse functions of each other, too.
        #[test]
        fn optimal_and_limit_angles_are_inverse_functions(a in 0.01..1.4_f64, f in 0.001..0.5_f64) {
            for direction in BOTH {
                if let Some(best) = Optimum::of(direction, a, f) {
                    let lead = Optimum::lead_angle(direction, best.contact_angle, f);
                    // Near α = 0, the lead angle is calculated from a cosine, which loses half of
                    // the digits.
                    prop_assert!(lead.is_some_and(|lead| (lead - a).abs() < 1e-12 / a), "{lead:?} {a}");
                }
                let border = Angles::locking_contact_angle(direction, a, f);
                if let Some(border) = border.filter(|border| *border < 1.57) {
                    let lead = Angles::locking_lead_angle(direction, border, f);
                    prop_assert!(lead.is_some_and(|lead| (lead - a).abs() < 1e-9), "{lead:?} {a}");
                }
            }
        }

        /// The contact angle of the closed-form optimum gives a better efficiency than neighboring
        /// angles. The efficiency at this angle equals the stated efficiency, and the angle
        /// satisfies the published conditions (15) and (18).
        #[test]
        fn closed_form_optimum_is_a_maximum(a in 0.01..0.75_f64, f in 0.001..0.3_f64) {
            for direction in BOTH {
                let Some(best) = Optimum::of(direction, a, f) else { continue };
                let at = |contact| Angles { lead: a, contact };
                let eta = at(best.contact_angle).efficiency(direction, f);
                prop_assert!((eta - best.efficiency).abs() <= 1e-13, "{eta} {}", best.efficiency);
                // Near the optimum, η is constant to second order; at a distance of 1e-4, it
                // changes by about 1e-9.
                for step in [-1e-4, 1e-4] {
                    prop_assert!(at(best.contact_angle + step).efficiency(direction, f) <= eta + 1e-15);
                }
                let (d, s) = (at(best.contact_angle).slip_factor(), best.contact_angle.sin());
                let condition = match direction {
                    // D² + 2 f sinβ D = sin²β  (C12),  D² = sin²β + 2 f sinβ D  (C13)
                    Direction::RotaryToLinear => d * d + 2.0 * f * s * d - s * s,
                    Direction::LinearToRotary => d * d - 2.0 * f * s * d - s * s,
                };
                prop_assert!(condition.abs() <= 1e-13, "{condition}");
            }
        }

        /// With the loads and slip directions of the closed form, the contact forces transmit the
        /// axial load and require the torque that corresponds to the efficiency, for a ball of any
        /// size.
        #[test]
        fn efficiency_agrees_with_the_contact_forces(
            a in 0.02..0.8_f64, b in 0.2..1.4_f64, f in 0.0..0.15_f64, size in 0.0..0.3_f64,
        ) {
            let angles = Angles { lead: a, contact: b };
            prop_assume!(b.sin() > 1.05 * f * angles.slip_factor());
            for direction in BOTH {
                let frame = BallFrame::turned(a, 0.0);
                let psi = angles.screw_slip_angle(direction);
                let q = angles.load_ratio(direction, f);
                let wrench = |site, psi: f64| {
                    let contact = Contact::new(site, b, &frame);
                    let friction = (contact.transverse * psi.cos() + Vector3::x() * psi.sin()) * (f * q);
                    Wrench::at_contact(&contact.normal, &contact.point(size), q, &friction)
                };
                let axial = axial_force(&wrench(Site::Nut, psi + PI).force, &frame);
                prop_assert!((axial - 1.0).abs() <= 1e-12, "{axial}");
                let screw = torque(&wrench(Site::Screw, psi), 1.0, &frame);
                let eta = efficiency(direction.is_back(), ideal_torque(1.0, 1.0, a.tan()), screw);
                prop_assert!((eta - angles.efficiency(direction, f)).abs() <= 1e-12, "{eta}");
            }
        }
    }
}
