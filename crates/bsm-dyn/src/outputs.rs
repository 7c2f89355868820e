//! The numbers of an answer, and how they follow from a state of the ball.

use bsm_kin::{BallFrame, Contact, Motion, Site};
use nalgebra::Vector3;

use crate::balance::{Power, efficiency};
use crate::{Control, Direction};

/// Outputs in SI units and radians; a model leaves empty what it does not have.
///
/// Loads are per ball, torque and powers for all loaded balls together.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[expect(missing_docs, reason = "names and meanings are those of docs/theory/00-notation.md")]
pub struct Outputs {
    pub efficiency: Option<f64>,
    pub screw_torque: Option<f64>,
    pub nut_normal_load: Option<f64>,
    pub screw_normal_load: Option<f64>,
    pub minor_normal_load: Option<f64>,
    pub nut_contact_angle: Option<f64>,
    pub screw_contact_angle: Option<f64>,
    pub nut_slip_angle: Option<f64>,
    pub screw_slip_angle: Option<f64>,
    pub minor_slip_angle: Option<f64>,
    pub nut_slip_velocity: Option<f64>,
    pub screw_slip_velocity: Option<f64>,
    pub minor_slip_velocity: Option<f64>,
    pub nut_spin: Option<f64>,
    pub screw_spin: Option<f64>,
    pub precession: Option<f64>,
    pub omega_t: Option<f64>,
    pub omega_n: Option<f64>,
    pub omega_b: Option<f64>,
    pub nut_max_pressure: Option<f64>,
    pub screw_max_pressure: Option<f64>,
    pub nut_ellipse_a: Option<f64>,
    pub nut_ellipse_b: Option<f64>,
    pub screw_ellipse_a: Option<f64>,
    pub screw_ellipse_b: Option<f64>,
    pub nut_approach: Option<f64>,
    pub screw_approach: Option<f64>,
    pub axial_displacement: Option<f64>,
    pub input_power: Option<f64>,
    pub output_power: Option<f64>,
    pub dissipated_power: Option<f64>,
    pub power_balance: Option<f64>,
    pub iterations: Option<usize>,
    pub residual_norm: Option<f64>,
    pub self_locking: Option<bool>,
    /// Bound of the error of the efficiency against the traction model, which 99 % of all points
    /// keep.
    pub error_bound: Option<f64>,
    /// Gyroscopic over friction moment of the gripping motion (W9).
    pub skid_number: Option<f64>,
    /// The slip across the grooves that the lead forces, over the slip of spin (W10).
    pub cross_slip: Option<f64>,
    /// Skid number of a ball whose friction is already spent on that slip (W11): below 0.1 the
    /// ball grips, above 2 friction is nearly saturated.
    pub onset_number: Option<f64>,
    /// The race at which the ball does not spin.
    pub controlling_race: Option<Control>,
    /// True if the decision (W7), asked at this solution, names the race that controls; `None` if
    /// the race was given.
    pub control_consistent: Option<bool>,
    /// Number of other admissible solutions that are known; `None` where none was looked for.
    pub other_solutions: Option<usize>,
    /// Efficiency of the one of them that differs most.
    pub other_solution_efficiency: Option<f64>,
}

impl Outputs {
    /// Stores torque, efficiency and powers, and returns the powers.
    ///
    /// * `torque`, `ideal`: torque on the screw and that of the frictionless screw \[N·m\].
    /// * `speed`: relative speed `$W$` \[rad/s\].
    pub(crate) fn set_transmission(
        &mut self,
        direction: Direction,
        ideal: f64,
        torque: f64,
        speed: f64,
    ) -> Power {
        let power = Power::transmitted(torque, ideal, speed);
        let eta = efficiency(direction, ideal, torque);
        self.efficiency = Some(eta);
        self.screw_torque = Some(torque);
        self.self_locking = Some(eta <= 0.0);
        self.set_power(&power);
        power
    }

    /// Stores the numbers that tell gripping from skidding.
    pub(crate) fn set_regime(&mut self, skid_number: f64, cross_slip: f64) {
        // Without friction, or without spin, they have no meaning.
        let finite = |x: f64| x.is_finite().then_some(x);
        self.skid_number = finite(skid_number);
        self.cross_slip = finite(cross_slip);
        // S = G √(1 + χ²)                                                 (W11)
        self.onset_number = finite(skid_number * cross_slip.hypot(1.0));
    }

    /// Stores what is known of other solutions, by their efficiencies.
    pub(crate) fn set_others(&mut self, efficiencies: &[f64]) {
        let far = |eta: &f64| (eta - self.efficiency.unwrap_or(f64::NAN)).abs();
        let farthest = efficiencies.iter().max_by(|a, b| far(a).total_cmp(&far(b))).copied();
        self.other_solutions = Some(efficiencies.len());
        self.other_solution_efficiency = farthest;
    }

    /// Stores the three powers.
    pub(crate) fn set_power(&mut self, power: &Power) {
        self.input_power = Some(power.input);
        self.output_power = Some(power.output);
        self.dissipated_power = Some(power.dissipated);
    }

    /// Stores the absolute motion of the ball, of speeds over `unit` \[rad/s\].
    pub(crate) fn set_motion(&mut self, motion: &Motion<f64>, frame: &BallFrame<f64>, unit: f64) {
        let omega = frame.to_frenet(&motion.omega) * unit;
        self.precession = Some(motion.precession * unit);
        self.omega_t = Some(omega.x);
        self.omega_n = Some(omega.y);
        self.omega_b = Some(omega.z);
    }

    /// Stores slip and spin of a contact.
    ///
    /// * `motion`: relative to the body of the contact, of speeds over `unit` \[rad/s\].
    /// * `slip`: velocity at the contact centre \[m/s\].
    pub(crate) fn set_contact(
        &mut self,
        contact: &Contact<f64>,
        motion: &Motion<f64>,
        slip: &Vector3<f64>,
        unit: f64,
    ) {
        let (angle, speed) = (Some(contact.slip_angle(slip)), Some(slip.norm()));
        let spin = Some(motion.spin(contact) * unit);
        match contact.site {
            Site::Nut => {
                (self.nut_slip_angle, self.nut_slip_velocity, self.nut_spin) = (angle, speed, spin);
            }
            Site::NutMinor => (self.minor_slip_angle, self.minor_slip_velocity) = (angle, speed),
            Site::Screw => {
                (self.screw_slip_angle, self.screw_slip_velocity) = (angle, speed);
                self.screw_spin = spin;
            }
        }
    }
}
