//! Loads of an axis in its cycle, torque of its motor, inertia.
//!
//! Theory: `docs/theory/18-axis.md`, equations (Z7) to (Z13).

use std::f64::consts::{FRAC_PI_2, TAU};

use crate::body::STEEL;

/// Acceleration of free fall \[m/s²\], standard.
pub(crate) const GRAVITY: f64 = 9.806_65;

/// Moved mass and inclination of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MachineTable {
    /// Moved mass \[kg\].
    pub mass: f64,
    /// Inclination `$\varphi$` of the axis \[rad\]: 0 level, π/2 upwards along the feed.
    pub inclination: f64,
    /// Friction coefficient of the guides.
    pub friction: f64,
}

impl MachineTable {
    /// Axial load of the screw \[N\], positive against a positive feed (Z7).
    ///
    /// ```math
    /// F = F_p + m g\sin\varphi + \mu\,m g\cos\varphi\,\mathrm{sgn}\,v + m a
    /// ```
    ///
    /// * `process`: force on the carriage \[N\], positive against a positive feed. * `feed`: velocity
    ///   \[m/s\]. * `acceleration`: along the positive feed \[m/s²\].
    ///
    /// Source: THK, "Calculating the permissible axial load", horizontal and vertical mount.
    pub fn load(&self, process: f64, feed: f64, acceleration: f64) -> f64 {
        let weight = self.mass * GRAVITY;
        let way = if feed == 0.0 { 0.0 } else { feed.signum() };
        // F = F_p + m g sinφ + μ m g cosφ sgn v + m a                     (Z7)
        process
            + weight * self.inclination.sin()
            + way * self.guide_friction()
            + self.mass * acceleration
    }

    /// Friction of the guides \[N\].
    pub fn guide_friction(&self) -> f64 {
        // The cosine, which is zero upright.
        self.friction * self.mass * GRAVITY * (FRAC_PI_2 - self.inclination).sin().max(0.0)
    }
}

/// Friction torque of a preload by manufacturers' rule \[N·m\] (Z8).
///
/// ```math
/// T_p = K_p\,\frac{F_w P_h}{2\pi}, \qquad K_p = 0.05\,(\tan\alpha)^{-1/2}
/// ```
///
/// * `preload` \[N\]; * `lead` \[m\]; * `lead_angle` \[rad\].
///
/// Valid: lubricated nuts with wipers off, at some 100 rpm. Makers allow 20 to 50 % on either side; HIWIN
/// states 0.1 to 0.3 for `$K_p$`. Source: JIS B 1192; THK, "Studying the rotational torque".
pub fn drag_torque(preload: f64, lead: f64, lead_angle: f64) -> f64 {
    // T_p = 0.05 F_w P_h/(2π √tanα)                                       (Z8)
    0.05 * preload * lead / (TAU * lead_angle.tan().sqrt())
}

/// Torque of a brake over that of the load without friction, usual value.
pub const BRAKE_SAFETY: f64 = 1.5;

/// Drag of preload, seals and bearings at rest over that of motion, at most; usual value.
const AT_REST: f64 = 2.0;

/// What a load does to a screw whose motor has no power.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BackDriving {
    /// It turns the screw.
    Turns,
    /// Friction may hold it or not.
    Undecided,
    /// Friction holds it.
    Holds,
}

impl BackDriving {
    /// Least and largest torque with which a load drives the screw \[N·m\], and what follows (Z18).
    ///
    /// ```math
    /// T_{b,lo} = T_{lo} - 2\,T_d, \qquad T_{b,hi} = T_{hi} - T_d
    /// ```
    ///
    /// * `of_load`: torque of the load less the friction of the contacts \[N·m\], at the largest and at the least friction.
    /// * `drag`: of preload, seals and support bearings in motion \[N·m\]; twice that at rest.
    ///
    /// Source: the torque of HIWIN BS-08-2, F 3.16, less the drag.
    pub fn of(of_load: [f64; 2], drag: f64) -> ([f64; 2], Self) {
        // T_b = T_lo − 2 T_d,  T_hi − T_d                                 (Z18)
        let torques = [of_load[0] - AT_REST * drag, of_load[1] - drag];
        let what = match torques {
            [low, _] if low > 0.0 => Self::Turns,
            [_, high] if high <= 0.0 => Self::Holds,
            _ => Self::Undecided,
        };
        (torques, what)
    }
}

/// Moment of inertia of a screw about its axis \[kg·m²\] (Z9): that of a solid steel rod of its length and mass.
///
/// Assumes: the groove takes nothing from the outside alone; with it the moment is up to 3 % larger. Source: HIWIN
/// BS-08-2, F 3.20, for the rod.
pub fn screw_inertia(length: f64, mass: f64) -> f64 {
    // J_s = m_s²/(2π ρ l)                                                 (Z9)
    mass.powi(2) / (TAU * STEEL * length)
}

/// Inertias between motor and carriage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Lead \[m\].
    pub lead: f64,
    /// Moment of inertia of the screw, with what turns with it \[kg·m²\].
    pub screw_inertia: f64,
    /// Moved mass \[kg\].
    pub mass: f64,
    /// Turns of the motor for one of the screw, positive.
    pub gear_ratio: f64,
    /// Moment of inertia of the motor \[kg·m²\].
    pub motor_inertia: f64,
}

impl Drive {
    /// Moment of inertia of the moved mass at the screw \[kg·m²\] (Z10).
    pub fn mass_inertia(&self) -> f64 {
        // J_m = m (P_h/2π)²                                               (Z10)
        self.mass * (self.lead / TAU).powi(2)
    }

    /// Moment of inertia of the load at the motor \[kg·m²\] (Z11).
    pub fn load_inertia(&self) -> f64 {
        // J_L = (J_s + J_m)/i_g²                                          (Z11)
        (self.screw_inertia + self.mass_inertia()) / self.gear_ratio.powi(2)
    }

    /// Torque of the motor \[N·m\] (Z12).
    ///
    /// ```math
    /// T = \frac{T_s + J_s\dot\Omega}{i_g} + J_{mot}\,i_g\dot\Omega
    /// ```
    ///
    /// * `at_screw`: torque that the screw takes at its speed \[N·m\], with the force that accelerates the moved
    ///   mass in its load. * `acceleration`: of the carriage \[m/s²\].
    ///
    /// Assumes: a gear without losses. Source: HIWIN BS-08-2, F 3.17 to F 3.22.
    pub fn motor_torque(&self, at_screw: f64, acceleration: f64) -> f64 {
        let turning = acceleration * TAU / self.lead;
        // T = (T_s + J_s Ω̇)/i_g + J_mot i_g Ω̇                             (Z12)
        (at_screw + self.screw_inertia * turning) / self.gear_ratio
            + self.motor_inertia * self.gear_ratio * turning
    }
}

/// RMS torque over time (Z13), which determines the heat of a motor; `None` without any time.
///
/// Source: THK, "Studying the driving motor", eq. 54.
pub fn root_mean_square(values: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let (mut squares, mut time) = (0.0, 0.0);
    for (value, share) in values {
        squares += value.powi(2) * share;
        time += share;
    }
    // T_rms = √(Σ T_j² t_j/Σ t_j)                                         (Z13)
    (time > 0.0).then(|| (squares / time).sqrt())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use approx::assert_relative_eq;

    use super::*;

    /// An upright axis of 250 kg on a screw of lead 10 mm, drag 0.25 N m, efficiency of 0.75 to 0.85 driven back, by hand: the
    /// load alone makes 3.90194 N m. A worm of efficiency zero holds, and drag makes the rest undecided.
    #[test]
    fn a_load_turns_a_screw_or_not() {
        let ideal = 250.0 * GRAVITY * 0.01 / TAU;
        assert_relative_eq!(ideal, 3.901_94, max_relative = 2e-6);
        let of = |efficiencies: [f64; 2], drag| {
            BackDriving::of(efficiencies.map(|eta| eta * ideal), drag)
        };
        let ([low, high], what) = of([0.75, 0.85], 0.25);
        // Four digits each.
        assert_relative_eq!(low, 2.426_46, max_relative = 2e-6);
        assert_relative_eq!(high, 3.066_65, max_relative = 2e-6);
        assert_eq!(what, BackDriving::Turns);
        assert_relative_eq!(BRAKE_SAFETY * ideal, 5.852_91, max_relative = 2e-6);
        assert_eq!(of([-0.1, 0.0], 0.0).1, BackDriving::Holds);
        assert_eq!(of([0.2, 0.5], 1.0).1, BackDriving::Undecided);
    }

    /// Level, the load turns with the feed and carries no weight; upright it is the weight either way,
    /// and the guides carry nothing. Nook's selection example: 5000 lb on guides of 0.0013 take 6.5 lb.
    #[test]
    fn loads_of_a_carriage() {
        let level = MachineTable { mass: 500.0, inclination: 0.0, friction: 0.01 };
        assert_relative_eq!(level.load(1e3, 0.1, 0.0), 1_049.033_25, max_relative = 1e-12);
        assert_relative_eq!(level.load(1e3, -0.1, 0.0), 950.966_75, max_relative = 1e-12);
        assert_relative_eq!(level.load(1e3, 0.0, 2.0), 2e3, max_relative = 1e-12);
        let upright = MachineTable { inclination: FRAC_PI_2, ..level };
        for feed in [0.3, -0.3] {
            assert_relative_eq!(upright.load(0.0, feed, 0.0), 4903.325, max_relative = 1e-12);
        }
        assert!(upright.guide_friction() <= 0.0, "guides of an upright axis carry nothing");
        let pounds = 0.453_592_37;
        let nook = MachineTable { mass: 5000.0 * pounds, inclination: 0.0, friction: 0.0013 };
        let in_pounds = nook.load(0.0, 1.0, 0.0) / (pounds * GRAVITY);
        assert_relative_eq!(in_pounds, 6.5, max_relative = 1e-12);
    }

    /// By hand: 2 kN on 10 mm at tanα = 0.0796 (40 mm): 0.1772 of 3.1831 N m.
    #[test]
    fn drag_by_the_rule() {
        let angle = (10.0_f64 / (PI * 40.0)).atan();
        assert!((drag_torque(2e3, 10e-3, angle) - 0.5642).abs() < 5e-5);
    }

    /// The moment of inertia was that of the pitch circle, half as much again. By hand: the metre of 50.53 mm pitch circle
    /// with grooves of 10 mm balls weighs 13.012 kg; a rod of that mass has 46 mm and 3.433e-3 kg m². Under the
    /// groove the exact integral has 3.5125e-3.
    #[test]
    fn the_inertia_of_a_screw_is_that_of_its_mass() {
        let inertia = screw_inertia(1.0, 13.012);
        assert_relative_eq!(inertia, 3.432_7e-3, max_relative = 2e-5);
        let diameter = (4.0 * 13.012 / (PI * STEEL)).sqrt();
        assert_relative_eq!(inertia, 13.012 * diameter.powi(2) / 8.0, max_relative = 1e-14);
    }

    /// By hand: a metre of 40 mm has 1.973e-3 kg m²; 500 kg on 20 mm a turn 5.066e-3 kg m². At 2 m/s² the screw
    /// gains 628.3 rad/s²; with a gear of 2 the motor takes half of the torque and twice its own.
    #[test]
    fn inertia_and_torque_of_the_motor() {
        let screw = screw_inertia(1.0, STEEL * PI * 0.02_f64.powi(2));
        assert!((screw - 1.9729e-3).abs() < 5e-8, "{screw}");
        let drive = Drive {
            lead: 20e-3,
            screw_inertia: screw,
            mass: 500.0,
            gear_ratio: 2.0,
            motor_inertia: 1e-3,
        };
        assert!((drive.mass_inertia() - 5.0661e-3).abs() < 5e-8);
        assert_relative_eq!(
            4.0 * drive.load_inertia(),
            screw + drive.mass_inertia(),
            max_relative = 1e-14
        );
        assert_relative_eq!(drive.motor_torque(10.0, 0.0), 5.0, max_relative = 1e-14);
        let turning = 2.0 * TAU / 20e-3;
        let torque = 0.5 * (10.0 + screw * turning) + 2.0e-3 * turning;
        assert_relative_eq!(drive.motor_torque(10.0, 2.0), torque, max_relative = 1e-14);
    }

    /// By hand: 3, 4 and 0 N m for a second, two and one: √(41/4).
    #[test]
    fn the_mean_of_squares_counts_time() {
        let torques = [(3.0, 1.0), (-4.0, 2.0), (0.0, 1.0)];
        let mean = root_mean_square(torques.into_iter()).expect("time");
        assert_relative_eq!(mean, (41.0_f64 / 4.0).sqrt(), max_relative = 1e-14);
        assert_eq!(root_mean_square([(1.0, 0.0)].into_iter()), None);
    }
}
