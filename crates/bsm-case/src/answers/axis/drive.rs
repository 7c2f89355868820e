//! What the motor of an axis does, and its weight without power of the motor.

use bsm_design::{BackDriving, Fall, Phase, least_acceleration_time, root_mean_square};
use bsm_dyn::ModelWorkspace;

use super::contacts::{self, contacts};
use super::state::AxisState;
use super::torques::Torques;
use crate::case::axis::Machine;
use crate::vocabulary::units::{MM, RPM};
use crate::{Case, InputKey};

/// What the weight of an inclined axis, and a constant process force, do to the screw without power of the motor.
pub(super) struct PowerLoss {
    /// Torque that drives the screw at the friction of the case \[N·m\].
    pub(super) nominal: f64,
    /// Least and largest torque that drives it \[N·m\].
    pub(super) torques: [f64; 2],
    pub(super) what: BackDriving,
}

impl AxisState<'_> {
    /// The largest size of a number of all phases.
    pub(super) fn peak(&self, number: impl Fn(&Self, &Torques) -> Option<f64>) -> Option<f64> {
        let all: Option<Vec<f64>> =
            self.torques.iter().map(|torques| number(self, torques)).collect();
        Some(all?.into_iter().map(f64::abs).fold(0.0, f64::max))
    }

    pub(super) fn rms_torque(&self) -> Option<f64> {
        let timed = |torques| Some((self.motor_torque(torques)?, torques.phase.time));
        let all: Option<Vec<_>> = self.torques.iter().map(timed).collect();
        root_mean_square(all?.into_iter())
    }

    pub(super) fn inertia_at_motor(&self) -> Option<f64> {
        self.machine.has_inertia().then(|| self.machine.drive.load_inertia())
    }

    /// Load of its weight, and of a constant process force \[N\].
    fn held(&self) -> f64 {
        let process = self.case.value_or_default(InputKey::hold_force_N).unwrap_or(0.0);
        self.machine.carriage.load(0.0, 0.0, 0.0).abs() + process
    }

    /// That load, if it turns the screw.
    pub(super) fn falling(&self) -> Option<Fall> {
        let held = self.held();
        (held > 0.0).then(|| self.machine.drive.falling(held))
    }

    /// Torque of a brake at the motor: no friction is counted on.
    pub(super) fn required_brake(&self) -> Option<f64> {
        let safety = self.case.value_or_default(InputKey::brake_safety)?;
        Some(safety * self.falling()?.torque / self.machine.drive.gear_ratio)
    }

    pub(super) fn stopping_distance(&self) -> Option<f64> {
        let brake = self.case.brake_torque_Nm? * self.machine.drive.gear_ratio;
        let delay = self.case.value_or_default(InputKey::brake_delay_s)?;
        let feed = self.axis().fastest() * self.machine.advance();
        self.falling()?.stopping_distance(brake, delay, feed)
    }

    pub(super) fn power_loss(&self) -> Option<&PowerLoss> {
        self.power_loss.get_or_init(|| self.at_power_loss()).as_ref()
    }

    /// Acceleration of a fall \[m/s²\], and speed of the screw after the stroke \[rpm\]; `None` if friction holds.
    pub(super) fn fall(&self) -> Option<(f64, f64)> {
        let driving = self.power_loss()?.nominal;
        let acceleration = self.falling()?.acceleration(driving);
        let feed = (2.0 * acceleration * self.case.stroke_mm? * MM).sqrt();
        (driving > 0.0).then(|| (acceleration, feed / self.machine.advance() / RPM))
    }

    /// Time to the largest speed by a torque of the motor \[s\].
    pub(super) fn least_ramp(&self, torque: f64) -> Option<f64> {
        let Machine { drive, axis, .. } = &self.machine;
        let steady = self.torques.iter().filter(|torques| torques.phase.acceleration == 0.0);
        let loads = steady.map(|torques| Some(self.motor_torque(torques)?.abs()));
        let load = loads.collect::<Option<Vec<_>>>()?.into_iter().fold(0.0, f64::max);
        let speed = axis.fastest() * drive.gear_ratio;
        if !self.machine.has_inertia() {
            return None;
        }
        least_acceleration_time(drive.inertia(), speed, torque, load)
    }

    /// Time to the largest speed at the largest acceleration of the cycle \[s\].
    pub(super) fn shortest_ramp(&self) -> Option<f64> {
        let sizes = self.axis().phases.iter().map(|phase| phase.acceleration.abs());
        let most = sizes.fold(0.0, f64::max);
        (most > 0.0).then(|| self.axis().fastest() * self.machine.advance() / most)
    }

    pub(super) fn motor_torque(&self, torques: &Torques) -> Option<f64> {
        let Phase { speed, acceleration, .. } = torques.phase;
        Some(self.machine.drive.motor_torque(torques.at_screw()?, speed, acceleration))
    }

    pub(super) fn motor_power(&self, torques: &Torques) -> Option<f64> {
        let speed = torques.phase.speed * self.machine.drive.gear_ratio;
        Some(self.motor_torque(torques)? * speed)
    }

    /// Whether its weight turns the screw of an inclined axis when the motor has no power (Z18).
    pub(super) fn at_power_loss(&self) -> Option<PowerLoss> {
        /// Friction that is not measured, over that of the case.
        const FRICTION: [f64; 2] = [2.0, 0.5];
        let (axis, settings, advance) = (self.axis(), self.settings, self.machine.advance());
        let ideal = self.falling()?.torque;
        let speed = -axis.fastest().max(RPM);
        let phase =
            Phase { time: 1.0, load: self.held(), speed, acceleration: 0.0, load_factor: 1.0 };
        let work = &mut ModelWorkspace::default();
        let mut friction =
            |case: &Case| contacts(case, settings, advance, &phase, work).ok()?.friction;
        let nominal = friction(self.case)?;
        let [most, least] = if self.machine.groove.is_none() {
            let [most, least] = contacts::usual_frictions(ideal, true);
            [Some(most.max(nominal)), Some(least.min(nominal))]
        } else if let Some(coefficient) = self.case.friction_coefficient {
            FRICTION.map(|factor| {
                let friction_coefficient = Some(factor * coefficient);
                friction(&Case { friction_coefficient, ..self.case.clone() })
            })
        } else {
            let [low, high] = contacts::band(self.case, settings, &phase, work)?;
            [high, low].map(|factor| Some(factor * nominal))
        };
        let value = |key| self.case.value_or_default(key).unwrap_or(0.0);
        let drag = self.preload.as_ref().map_or(0.0, |preload| preload.beyond)
            + value(InputKey::seal_torque_Nm)
            + value(InputKey::support_bearing_torque_Nm);
        let (torques, what) = BackDriving::of([ideal - most?, ideal - least?], drag);
        Some(PowerLoss { nominal: ideal - nominal - drag, torques, what })
    }

    /// The same in words, with the brake; of an axis without weight whether its load drives the screw.
    pub(super) fn falls(&self) -> Option<String> {
        let Some(PowerLoss { torques: [low, high], what, .. }) = self.power_loss() else {
            let (load, holding) = (self.axis().largest_load(), self.holding?);
            return (load > 0.0).then(|| {
                if holding > 0.0 {
                    let by = match self.machine.groove {
                        Some(_) => "with friction of the contacts alone",
                        None => "by catalogue efficiency",
                    };
                    format!(
                        "the largest axial load, {load:.0} N, drives the screw back: {holding:.3} N m at the screw hold it, {by}"
                    )
                } else {
                    format!(
                        "the largest axial load, {load:.0} N, does not drive the screw back: friction of the contacts holds it; \
                         vibration can loosen it"
                    )
                }
            });
        };
        let is_weight = self.case.hold_force_N.is_none_or(|force| force == 0.0);
        let load = if is_weight { "the weight" } else { "the load" };
        let words = match what {
            BackDriving::Turns => format!("{load} turns the screw; a brake is needed"),
            BackDriving::Undecided => format!("{load} may turn the screw; take a brake"),
            BackDriving::Holds => format!(
                "friction holds {load}; vibration can loosen it, which is no safety function"
            ),
        };
        let brake = self.required_brake()?;
        let safety = self.case.value_or_default(InputKey::brake_safety)?;
        let holds = match (self.case.brake_torque_Nm, self.stopping_distance()) {
            (Some(_), Some(way)) => format!("; that given stops it within {:.1} mm", way / MM),
            (Some(_), None) => "; that given does not hold".to_owned(),
            (None, _) => String::new(),
        };
        Some(format!(
            "without power of the motor {words}: {low:.3} to {high:.3} N m drive the screw; brake of at least {brake:.3} N m \
             at the motor, {safety} times {load} without friction{holds}"
        ))
    }
}
