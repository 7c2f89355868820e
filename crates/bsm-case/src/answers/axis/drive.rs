//! Motor of an axis, and motion of the load after a loss of motor power.

use bsm_design::drive::{
    BackDrivenScrew, BackDriving, DriveTrain, least_acceleration_time, stopping_distance,
};
use bsm_design::motion::{PhasePoint, speed_jumps};
use bsm_dyn::ModelWorkspace;

use super::contacts::{self, contacts};
use super::state::AxisState;
use super::torques::{PhaseTorques, Torques};
use crate::case::axis::AxisModel;
use crate::vocabulary::units::{MM, RPM};
use crate::{Case, InputKey, format_trimmed};

/// Effect that the load at standstill has on the screw after a loss of motor power.
pub(super) struct PowerLoss {
    /// Back-driving torque at the screw, calculated with the given friction \[N·m\].
    pub(super) nominal: f64,
    /// Torque that is needed at the screw to hold the load with the help of contact friction
    /// \[N·m\].
    pub(super) holding: f64,
    /// Smallest and largest back-driving torque at the screw \[N·m\].
    pub(super) torques: [f64; 2],
    pub(super) back_driving: BackDriving,
}

/// Deceleration and distance of a stop from the largest feed rate.
pub(super) struct Stop {
    /// Deceleration \[m/s²\].
    pub(super) deceleration: f64,
    /// Stopping distance \[m\].
    pub(super) distance: f64,
}

/// The start or end of a phase at which the motor torque, or the utilization of the motor, reaches
/// its maximum.
pub(super) struct MotorPeak {
    /// Axial load, including the force that accelerates the moved mass \[N\].
    pub(super) load: f64,
    /// Magnitude of the motor torque \[N·m\].
    torque: f64,
    /// Part of the motor torque that does not depend on the load \[N·m\], positive in the direction
    /// of the motor torque.
    without_load: f64,
}

impl MotorPeak {
    /// Returns the absolute axial load at which the motor torque is `ratio` times the torque at
    /// this peak \[N\]. Assumes that contact friction without preload is proportional to the load.
    /// Returns `None` if no load causes this torque.
    pub(super) fn load_at(&self, ratio: f64) -> Option<f64> {
        let of_load = self.torque - self.without_load;
        let share = (ratio * self.torque - self.without_load) / of_load;
        (of_load > 0.0 && share > 0.0).then(|| share * self.load.abs())
    }
}

impl AxisState<'_> {
    /// Returns the load and the motor torques at the point where a quantity has its largest
    /// magnitude. The starts and ends of all phases are considered.
    pub(super) fn motor_peak(
        &self,
        number: impl Fn(&Self, &Torques) -> Option<f64>,
    ) -> Option<MotorPeak> {
        let size = |end: &&Torques| number(self, end).map_or(f64::NEG_INFINITY, f64::abs);
        let ends = self.torques.iter().flat_map(|torques| &torques.ends);
        let end = ends.max_by(|a, b| size(a).total_cmp(&size(b)))?;
        let torque = self.motor_torque(end)?;
        let preloaded = self.preload.as_ref().and_then(|preload| preload.of_contacts);
        let friction = end.friction()? - end.contacts.friction? + preloaded.unwrap_or(0.0);
        let unloaded = PhasePoint { load: 0.0, ..end.point };
        let without_load = torque.signum() * self.machine.drive.motor_torque(&unloaded, friction);
        Some(MotorPeak { load: end.point.load, torque: torque.abs(), without_load })
    }

    /// Returns the largest magnitude of a quantity at the starts and ends of all phases, or `None` if
    /// a value is unknown.
    pub(super) fn peak(&self, number: impl Fn(&Self, &Torques) -> Option<f64>) -> Option<f64> {
        let ends = self.torques.iter().flat_map(|torques| &torques.ends);
        let all: Option<Vec<f64>> = ends.map(|torques| number(self, torques)).collect();
        let all = all.filter(|all| all.iter().all(|number| number.is_finite()))?;
        Some(all.into_iter().map(f64::abs).fold(0.0, f64::max))
    }

    pub(super) fn rms_torque(&self) -> Option<f64> {
        self.mean(|torques| Some(torques.means?.squared_torque)).map(f64::sqrt)
    }

    /// Returns the duration of the cycle \[s\].
    pub(super) fn cycle_time(&self) -> Option<f64> {
        self.machine.cycle.map(|(time, _)| time)
    }

    /// Returns the energy that is returned to the drive per cycle \[J\].
    pub(super) fn regenerated_energy(&self) -> Option<f64> {
        let time = self.cycle_time()?;
        self.mean(|torques| Some(torques.means?.regenerated)).map(|power| power * time)
    }

    /// Returns the number of speed jumps in the cycle, or `None` if no cycle is given.
    pub(super) fn speed_jumps(&self) -> Option<usize> {
        self.case.entries.cycle.as_ref().map(|_| speed_jumps(&self.axis().phases).len())
    }

    pub(super) fn inertia_at_motor(&self) -> Option<f64> {
        self.machine.has_inertia().then(|| self.machine.drive.load_inertia())
    }

    /// Returns the data for calculating how the load at standstill drives the screw after a loss of
    /// motor power.
    pub(super) fn back_driven_screw(&self) -> BackDrivenScrew {
        self.machine.drive.back_driven_screw(self.machine.rest_load.abs())
    }

    /// Returns the holding torque of the motor without friction \[N·m\].
    pub(super) fn holding_torque(&self) -> f64 {
        let DriveTrain { screws, gear_ratio, .. } = self.machine.drive;
        screws * self.back_driven_screw().torque / gear_ratio
    }

    /// Returns the required brake torque at the motor \[N·m\]. The calculation neglects friction.
    pub(super) fn required_brake(&self) -> Option<f64> {
        let safety = self.case.value_or_default(InputKey::brake_safety)?;
        Some(safety * self.holding_torque())
    }

    /// Calculates how the axis stops from its largest feed rate in the direction of the load at
    /// standstill. The deceleration is either given or calculated from the brake torque. Returns
    /// `None` if neither is given, or if the brake cannot hold the load.
    pub(super) fn stop(&self) -> Option<Stop> {
        let delay = self.case.value_or_default(InputKey::brake_delay_s)?;
        let feed = self.axis().fastest() * self.machine.advance();
        if let Some(deceleration) = self.case.stop_deceleration_m_s2 {
            return Some(Stop {
                deceleration,
                distance: stopping_distance(feed, delay, deceleration),
            });
        }
        let DriveTrain { screws, gear_ratio, .. } = self.machine.drive;
        let brake = self.case.brake_torque_Nm? * gear_ratio / screws;
        let back_driven_screw = self.back_driven_screw();
        Some(Stop {
            deceleration: back_driven_screw.braking(brake)?,
            distance: back_driven_screw.stopping_distance(brake, delay, feed)?,
        })
    }

    /// Returns the kinetic energy at the largest feed rate, including the energy of the motor
    /// \[J\].
    pub(super) fn stop_energy(&self) -> Option<f64> {
        self.machine.screw?;
        let speed = self.axis().fastest() * self.machine.drive.gear_ratio;
        (speed > 0.0).then(|| 0.5 * self.machine.drive.inertia() * speed.powi(2))
    }

    pub(super) fn power_loss(&self) -> Option<&PowerLoss> {
        self.power_loss.get_or_init(|| self.at_power_loss()).as_ref()
    }

    /// Returns the acceleration of a falling load \[m/s²\] and the screw speed after the load has
    /// fallen over the full stroke \[rpm\], or `None` if friction holds the load.
    pub(super) fn fall(&self) -> Option<(f64, f64)> {
        let driving = self.power_loss()?.nominal;
        let acceleration = self.back_driven_screw().acceleration(driving);
        let feed = (2.0 * acceleration * self.machine.stroke?).sqrt();
        (driving > 0.0).then(|| (acceleration, feed / self.machine.advance() / RPM))
    }

    /// Returns the time that a given motor torque takes to accelerate the axis to its largest speed
    /// \[s\].
    pub(super) fn least_ramp(&self, torque: f64) -> Option<f64> {
        let AxisModel { drive, axis, .. } = &self.machine;
        let is_steady =
            |torques: &&PhaseTorques| torques.phase.moves() && torques.phase.acceleration == 0.0;
        let steady = self.torques.iter().filter(is_steady).flat_map(|torques| &torques.ends);
        let loads = steady.map(|torques| Some(self.motor_torque(torques)?.abs()));
        let load = loads.collect::<Option<Vec<_>>>()?.into_iter().reduce(f64::max)?;
        let speed = axis.fastest() * drive.gear_ratio;
        if !self.machine.has_inertia() {
            return None;
        }
        least_acceleration_time(drive.inertia(), speed, torque, load)
    }

    /// Returns the time that the axis takes to reach its largest speed at the largest acceleration
    /// of the cycle \[s\].
    pub(super) fn shortest_ramp(&self) -> Option<f64> {
        let sizes = self.axis().phases.iter().map(|phase| phase.acceleration.abs());
        let most = sizes.fold(0.0, f64::max);
        (most > 0.0).then(|| self.axis().fastest() * self.machine.advance() / most)
    }

    pub(super) fn motor_torque(&self, torques: &Torques) -> Option<f64> {
        Some(self.machine.drive.motor_torque(&torques.point, torques.friction()?))
    }

    pub(super) fn motor_power(&self, torques: &Torques) -> Option<f64> {
        let speed = torques.point.speed * self.machine.drive.gear_ratio;
        Some(self.motor_torque(torques)? * speed)
    }

    /// Returns the ratio of the motor torque to the peak torque of the motor curve at the same
    /// speed.
    pub(super) fn torque_utilization(&self, torques: &Torques) -> Option<f64> {
        let speed = (torques.point.speed * self.machine.drive.gear_ratio).abs();
        let at = self.machine.motor_curve.as_ref()?.at(speed)?;
        Some(self.motor_torque(torques)? / at.peak)
    }

    /// Returns the continuous torque that the motor curve permits at the mean speed of the motor
    /// \[N·m\], or `None` if the curve does not state it.
    pub(super) fn continuous_torque(&self) -> Option<f64> {
        let speed = self.axis().mean_speed() * self.machine.drive.gear_ratio;
        self.machine.motor_curve.as_ref()?.at(speed)?.continuous
    }

    /// Returns the regenerative power that the motor feeds back to the drive \[W\].
    pub(super) fn regenerated_power(&self, torques: &Torques) -> Option<f64> {
        Some((-self.motor_power(torques)?).max(0.0))
    }

    /// Determines whether the load at standstill back-drives the screw after a loss of motor power
    /// (BB5).
    pub(super) fn at_power_loss(&self) -> Option<PowerLoss> {
        /// Largest and smallest ratio of the actual friction coefficient to the given friction
        /// coefficient. The range is wide, because the given coefficient is rarely based on
        /// measurements.
        const FRICTION_RANGE: [f64; 2] = [2.0, 0.5];
        let (settings, advance) = (self.settings, self.machine.advance());
        let load = self.machine.rest_load.abs();
        if load == 0.0 {
            let back_driving = BackDriving::None;
            return Some(PowerLoss { nominal: 0.0, holding: 0.0, torques: [0.0; 2], back_driving });
        }
        let speed = -self.axis().fastest().max(RPM);
        // Guide friction can hold a part of the load.
        let left = (load - self.machine.carriage.guide_friction()).max(0.0);
        let [whole, left] = [load, left].map(|load| PhasePoint::steady(load, speed));
        let work = &mut ModelWorkspace::default();
        let mut friction = |case: &Case, point: &PhasePoint| {
            contacts(case, settings, advance, point, work).ok()?.friction
        };
        let nominal = friction(self.case, &whole)?;
        let torque = |point: &PhasePoint| advance * point.load;
        let by_catalog = self.machine.groove.is_none()
            || contacts::takes_catalog_efficiency(self.case, self.settings);
        let [most, least] = if by_catalog {
            let most = contacts::usual_frictions(torque(&left), true)[0];
            let least = contacts::usual_frictions(torque(&whole), true)[1];
            [Some(most.max(friction(self.case, &left)?)), Some(least.min(nominal))]
        } else if let Some(coefficient) = self.case.friction_coefficient {
            let mut at = |factor: f64, point: &PhasePoint| {
                let friction_coefficient = Some(factor * coefficient);
                friction(&Case { friction_coefficient, ..self.case.clone() }, point)
            };
            [at(FRICTION_RANGE[0], &left), at(FRICTION_RANGE[1], &whole)]
        } else {
            let of_left = friction(self.case, &left)?;
            let [low, high] = contacts::band(self.case, settings, &whole, work)?;
            [Some(high * of_left), Some(low * nominal)]
        };
        let value = |key| self.case.value_or_default(key).unwrap_or(0.0);
        let drag = self.preload.as_ref().map_or(0.0, |preload| preload.drag_beyond_contacts)
            + value(InputKey::seal_torque_Nm)
            + value(InputKey::support_bearing_torque_Nm);
        let (torques, back_driving) =
            BackDriving::of([torque(&left) - most?, torque(&whole) - least?], drag);
        let holding = (torque(&whole) - nominal).max(0.0);
        Some(PowerLoss { nominal: torque(&whole) - nominal - drag, holding, torques, back_driving })
    }

    /// Returns a word that states whether the load at standstill back-drives the screw.
    pub(super) fn back_driving(&self) -> Option<&'static str> {
        Some(self.power_loss()?.back_driving.name())
    }

    /// Returns a sentence that states whether the load at standstill back-drives the screw, and
    /// which brake torque is required.
    pub(super) fn back_driving_note(&self) -> Option<String> {
        let PowerLoss { torques: [low, high], back_driving, .. } = self.power_loss()?;
        let load = self.machine.rest_load;
        let consequence = match back_driving {
            BackDriving::None => {
                let none =
                    "No force acts at rest, so the axis needs no holding torque and no brake.";
                return Some(format!("{none}{}", self.force_during_motion()));
            }
            BackDriving::Turns => "The load at rest back-drives the screw; a brake is needed.",
            BackDriving::Undecided => "The load at rest may back-drive the screw; use a brake.",
            BackDriving::Holds => {
                "Friction holds the load at rest, but vibration can release the load, so do not rely on friction for safety."
            }
        };
        let brake = self.required_brake()?;
        let safety = self.case.value_or_default(InputKey::brake_safety)?;
        let holds = match (self.case.brake_torque_Nm, self.stop()) {
            (_, Some(stop)) => format!(" The axis stops within {:.1} mm.", stop.distance / MM),
            (Some(_), None) => " The specified brake is too weak.".to_owned(),
            (None, None) => String::new(),
        };
        Some(format!(
            "Without motor power, an axial load of {load:.0} N acts at rest, with a back-driving torque of {low:.3} to {high:.3} N m at the \
             screw. {consequence} The brake needs a torque of at least {brake:.3} N m at the motor, {safety} times the torque of the load without \
             friction.{holds}{}",
            self.force_during_motion()
        ))
    }

    /// Returns a sentence about the process force that is assumed to act only during motion, or an
    /// empty string if there is no such force.
    fn force_during_motion(&self) -> String {
        let is_at_rest = self.case.hold_force_N.is_some() || self.case.entries.cycle.is_some();
        match self.case.axial_load_N.filter(|load| *load != 0.0 && !is_at_rest) {
            Some(load) => format!(
                " axial_load_N is assumed to act only during motion; if the {} N also act at rest, give hold_force_N.",
                format_trimmed(load.abs())
            ),
            None => String::new(),
        }
    }
}
