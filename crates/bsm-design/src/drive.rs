//! Axial loads during the duty cycle of an axis, motor torque, and moments of inertia.
//!
//! Theory: `docs/theory/18-axis.md`, equations (Z8) to (Z12), (BB4) and (BB5).

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::phase_point::PhasePoint;
use crate::screw::STEEL;

/// Standard acceleration of gravity \[m/s²\].
pub(crate) const GRAVITY: f64 = 9.806_65;

/// Moving mass of an axis and all loads other than the process force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MachineTable {
    /// Moving mass `$m$` \[kg\].
    pub mass: f64,
    /// Inclination `$\theta$` of the axis \[rad\]. Zero is horizontal; at π/2, the positive feed
    /// points upward.
    pub inclination: f64,
    /// Friction coefficient of the guides.
    pub friction: f64,
    /// Constant resistance of the guides \[N\] due to seals, scrapers and preload. It does not
    /// depend on the load.
    pub resistance: f64,
    /// Mass of a vertically suspended counterweight `$m_c$` \[kg\] that moves with the axis.
    pub counterweight: f64,
    /// Force of a counterbalance such as a gas spring, `$F_b$` \[N\]. It is positive if it acts in
    /// the direction of positive feed.
    pub counterbalance: f64,
    /// Fraction `$x$` of all loads that acts on the most heavily loaded screw.
    pub share: f64,
}

impl MachineTable {
    /// Carriage without mass and without forces, driven by a single screw.
    pub const NONE: Self = Self {
        mass: 0.0,
        inclination: 0.0,
        friction: 0.0,
        resistance: 0.0,
        counterweight: 0.0,
        counterbalance: 0.0,
        share: 1.0,
    };

    /// Returns the axial load on the screw \[N\], which is positive if it opposes a positive feed
    /// (BB4).
    ///
    /// ```math
    /// F = xF_p + w - xF_b + s\,x(\mu mg\cos\theta + F_g) + x(m + m_c)\,a, \qquad w = x\,[mg\sin\theta - m_cg]
    /// ```
    ///
    /// * `process`: process force on the carriage \[N\], positive if it opposes a positive feed.
    /// * `direction`: direction of motion (1 or -1, or 0 at standstill).
    /// * `acceleration`: acceleration in the direction of positive feed \[m/s²\].
    ///
    /// Source: THK, "Calculating the permissible axial load", horizontal and vertical mount.
    pub fn load(&self, process: f64, direction: f64, acceleration: f64) -> f64 {
        // F = x F_p + w − x F_b + s x (μ m g cosθ + F_g) + x (m + m_c) a  (BB4)
        self.rest_load(process)
            + direction * self.guide_friction()
            + self.share * self.moved_mass() * acceleration
    }

    /// Returns the axial load on the screw at standstill \[N\], which consists of weight,
    /// counterweight, counterbalance and process force (BB4).
    ///
    /// * `process`: process force, as in [`load`](Self::load).
    pub fn rest_load(&self, process: f64) -> f64 {
        let weight = self.mass * GRAVITY * self.inclination.sin() - self.counterweight * GRAVITY;
        // F_rest = x (F_c − F_b) + w                                      (BB4)
        self.share * (process - self.counterbalance + weight)
    }

    /// Returns the guide friction that acts on the most heavily loaded screw \[N\], including the
    /// constant resistance.
    pub fn guide_friction(&self) -> f64 {
        // Unlike `cos`, this form is exactly zero for a vertical axis.
        let cosine = (FRAC_PI_2 - self.inclination).sin().max(0.0);
        self.share * (self.friction * self.mass * GRAVITY * cosine + self.resistance)
    }

    /// Returns the total moving mass \[kg\].
    pub fn moved_mass(&self) -> f64 {
        self.mass + self.counterweight
    }

    /// Returns true if the moving mass, the guides or the counterbalance can load the screw.
    pub fn is_loaded(&self) -> bool {
        [self.mass, self.resistance, self.counterweight, self.counterbalance]
            .into_iter()
            .any(|load| load != 0.0)
    }
}

/// Returns the friction torque due to preload according to the manufacturers' rule \[N·m\] (Z8).
///
/// ```math
/// T_p = K_p\,\frac{F_w P_h}{2\pi}, \qquad K_p = 0.05\,(\tan\alpha)^{-1/2}
/// ```
///
/// * `preload`, `lead`, `lead_angle`: preload \[N\], lead \[m\] and lead angle \[rad\].
///
/// Valid for lubricated nuts without wipers at about 100 rpm. Manufacturers permit deviations of ±
/// 20 to 50 %; HIWIN states 0.1 to 0.3 for `$K_p$`. Source: JIS B 1192; THK, "Studying the
/// rotational torque".
pub fn drag_torque(preload: f64, lead: f64, lead_angle: f64) -> f64 {
    // T_p = 0.05 F_w P_h/(2π √tanα)                                       (Z8)
    0.05 * preload * lead / (TAU * lead_angle.tan().sqrt())
}

/// Typical ratio of the brake torque to the load torque without friction.
pub const BRAKE_SAFETY: f64 = 1.5;

/// Typical upper limit of the ratio of breakaway torque to running torque, for the friction of
/// preload, seals and bearings.
const AT_REST: f64 = 2.0;

/// Response of a screw to its load at standstill if the motor has no power.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BackDriving {
    /// No load acts at standstill.
    None,
    /// The load back-drives the screw.
    Turns,
    /// It is uncertain whether friction can hold the load.
    Undecided,
    /// Friction holds the load.
    Holds,
}

impl BackDriving {
    /// Returns the smallest and the largest torque with which the load back-drives the screw
    /// \[N·m\], and the resulting state (BB5).
    ///
    /// ```math
    /// T_{b,lo} = T_{lo} - 2\,T_d, \qquad T_{b,hi} = T_{hi} - T_d
    /// ```
    ///
    /// * `of_load`: load torque minus contact friction \[N·m\]. The first value assumes the largest
    ///   friction, and only the part of the load that is not held by guide friction. The second
    ///   value assumes the smallest friction and the whole load.
    /// * `drag`: drag torque of preload, seals and support bearings in motion \[N·m\]. The
    ///   breakaway torque may be twice as large.
    ///
    /// Source: HIWIN BS-08-2, F 3.16, with the drag torque subtracted.
    pub fn of(of_load: [f64; 2], drag: f64) -> ([f64; 2], Self) {
        // T_b = T_lo − 2 T_d,  T_hi − T_d                                 (BB5)
        let torques = [of_load[0] - AT_REST * drag, of_load[1] - drag];
        let what = match torques {
            [low, _] if low > 0.0 => Self::Turns,
            [_, high] if high <= 0.0 => Self::Holds,
            _ => Self::Undecided,
        };
        (torques, what)
    }

    /// Returns the name of the state as it is printed.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Turns => "back-drives",
            Self::Undecided => "undecided",
            Self::Holds => "holds",
        }
    }
}

/// Returns the moment of inertia of a screw about its axis \[kg·m²\] if only its length and mass
/// are known (Z9). The screw is treated as a solid steel rod.
///
/// Assumes that the mass is distributed as in a rod. The groove removes material near the surface,
/// so the moment of inertia of a screw with the same mass and a groove ([`Nut::screw`]) is up to 5
/// % larger. Source for the rod: HIWIN BS-08-2, F 3.20.
///
/// [`Nut::screw`]: crate::Nut::screw
pub fn rod_inertia(length: f64, mass: f64) -> f64 {
    // J_s = m_s²/(2π ρ l)                                                 (Z9)
    mass.powi(2) / (TAU * STEEL * length)
}

/// Returns the mass per unit length of a solid steel rod \[kg/m\].
///
/// * `diameter`: rod diameter \[m\].
pub fn rod_mass_per_length(diameter: f64) -> f64 {
    0.25 * PI * STEEL * diameter.powi(2)
}

/// Moments of inertia and transmission ratios between motor and carriage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriveTrain {
    /// Lead \[m\].
    pub lead: f64,
    /// Moment of inertia \[kg·m²\] of the driven part (screw or nut), including everything that
    /// rotates with it.
    pub driven_inertia: f64,
    /// Mass moved by one screw \[kg\]: the share of this screw in the moving mass and the
    /// counterweight.
    pub mass: f64,
    /// Ratio of motor speed to screw speed, positive.
    pub gear_ratio: f64,
    /// Efficiency of the gearbox.
    pub gear_efficiency: f64,
    /// Moment of inertia of the motor \[kg·m²\].
    pub motor_inertia: f64,
    /// Moment of inertia of the gearbox, referred to the motor shaft \[kg·m²\].
    pub gear_inertia: f64,
    /// Number of screws `$j$` that the motor drives.
    pub screws: f64,
    /// True if a brake holds the load at standstill, so that the motor torque is zero.
    pub brake_at_rest: bool,
}

/// Motor torques at one speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotorPoint {
    /// Motor speed \[rad/s\], which must not be negative.
    pub speed: f64,
    /// Peak torque \[N·m\].
    pub peak: f64,
    /// Continuous torque \[N·m\], or `None` if it is unknown.
    pub continuous: Option<f64>,
}

/// Torque-speed curve of a motor, interpolated linearly between points.
#[derive(Debug, Clone, PartialEq)]
pub struct MotorCurve(Vec<MotorPoint>);

impl MotorCurve {
    /// Creates a curve. Returns `None` if there are no points, or if their speeds are not strictly
    /// increasing.
    pub fn new(points: Vec<MotorPoint>) -> Option<Self> {
        let increases = points.windows(2).all(|two| two[0].speed < two[1].speed);
        (increases && !points.is_empty()).then_some(Self(points))
    }

    /// Returns the motor torques at a given speed \[rad/s\]. Below the first point, the torques of
    /// the first point apply. Returns `None` above the last point.
    pub fn at(&self, speed: f64) -> Option<MotorPoint> {
        let after = self.0.iter().position(|point| point.speed >= speed)?;
        let (Some(before), end) = (after.checked_sub(1), self.0[after]) else {
            return Some(MotorPoint { speed, ..self.0[after] });
        };
        let start = self.0[before];
        let part = (speed - start.speed) / (end.speed - start.speed);
        let between = |from: f64, to: f64| from + part * (to - from);
        Some(MotorPoint {
            speed,
            peak: between(start.peak, end.peak),
            continuous: start.continuous.zip(end.continuous).map(|(from, to)| between(from, to)),
        })
    }

    /// Returns the largest speed of the curve \[rad/s\].
    pub fn fastest(&self) -> f64 {
        self.0.last().map_or(0.0, |point| point.speed)
    }
}

impl DriveTrain {
    /// Returns the moment of inertia that is equivalent to the moving mass, referred to the screw
    /// \[kg·m²\] (Z10).
    pub fn mass_inertia(&self) -> f64 {
        // J_m = m (P_h/2π)²                                               (Z10)
        self.mass * (self.lead / TAU).powi(2)
    }

    /// Returns the moment of inertia of all driven parts and moving masses, referred to the motor
    /// shaft \[kg·m²\] (Z11).
    pub fn load_inertia(&self) -> f64 {
        // J_L = j (J_s + J_m)/i_g²                                        (Z11)
        self.screws * (self.driven_inertia + self.mass_inertia()) / self.gear_ratio.powi(2)
    }

    /// Returns the travel per radian of screw rotation \[m\].
    fn advance(&self) -> f64 {
        self.lead / TAU
    }

    /// Returns the drive torque of one screw \[N·m\], including the torque that accelerates the
    /// moment of inertia of the screw.
    ///
    /// * `friction`: friction torque that opposes the motion, at the screw \[N·m\].
    pub(crate) fn coupling_torque(&self, point: &PhasePoint, friction: f64) -> f64 {
        let turning = point.acceleration / self.advance();
        self.advance() * point.load + point.direction() * friction + self.driven_inertia * turning
    }

    /// Returns the motor torque \[N·m\] (Z12).
    ///
    /// ```math
    /// T = \frac{j\,(T_s + J_s\dot\Omega)}{i_g\,\eta_g^{\pm1}} + (J_{mot} + J_g)\,i_g\dot\Omega
    /// ```
    /// In this formula, the exponent of `$\eta_g$` is 1 if the motor drives the screw, and -1 if
    /// the screw drives the motor. At standstill, the motor holds the load without the help of
    /// friction, unless a brake holds the load.
    ///
    /// * `point`: operating point, whose load includes the force that accelerates the moving mass.
    /// * `friction`: friction torque that opposes the motion, at one screw \[N·m\].
    ///
    /// Source: HIWIN BS-08-2, F 3.17 to F 3.22.
    pub fn motor_torque(&self, point: &PhasePoint, friction: f64) -> f64 {
        let of_screws = self.screws * self.coupling_torque(point, friction);
        let direction = point.direction();
        if direction == 0.0 {
            return if self.brake_at_rest { 0.0 } else { of_screws / self.gear_ratio };
        }
        let loss = if of_screws * direction < 0.0 {
            self.gear_efficiency
        } else {
            self.gear_efficiency.recip()
        };
        let turning = point.acceleration / self.advance();
        // T = j (T_s + J_s Ω̇)/(i_g η_g^±1) + (J_mot + J_g) i_g Ω̇          (Z12)
        of_screws / self.gear_ratio * loss
            + (self.motor_inertia + self.gear_inertia) * self.gear_ratio * turning
    }

    /// Returns the total moment of inertia, referred to the motor shaft \[kg·m²\].
    pub fn inertia(&self) -> f64 {
        self.load_inertia() + self.motor_inertia + self.gear_inertia
    }

    /// Returns the moment of inertia per screw, including the share of the motor and the gearbox,
    /// referred to the screw \[kg·m²\].
    pub fn inertia_at_screw(&self) -> f64 {
        self.inertia() * self.gear_ratio.powi(2) / self.screws
    }

    /// Returns the additional mass on the carriage that would have the same kinetic energy as the
    /// rotating parts \[kg\] (BB9).
    pub fn reflected_mass(&self) -> f64 {
        // m_r = [J_s + (J_mot + J_g) i_g²/j]/h²                           (BB9)
        (self.inertia_at_screw() - self.mass_inertia()) / self.advance().powi(2)
    }

    /// Returns the travel of the carriage per increment of the motor angle \[m\].
    ///
    /// * `parts`: number of increments per motor revolution, such as motor steps or encoder counts.
    pub fn travel_per_part(&self, parts: f64) -> f64 {
        self.lead / (self.gear_ratio * parts)
    }

    /// Returns the data for calculating how the load at standstill back-drives the screw while the
    /// motor has no power.
    ///
    /// * `load`: absolute load at standstill \[N\].
    pub fn back_driven_screw(&self, load: f64) -> BackDrivenScrew {
        let advance = self.advance();
        BackDrivenScrew { torque: load * advance, advance, inertia: self.inertia_at_screw() }
    }
}

/// Returns the shortest time in which a motor reaches a given speed \[s\] (AA11), or `None` if the
/// peak torque does not exceed the load torque.
///
/// * `inertia`: total moment of inertia, referred to the motor shaft \[kg·m²\].
/// * `speed`: motor speed to reach \[rad/s\].
/// * `peak`, `load`: peak torque of the motor and load torque \[N·m\].
///
/// Source: THK, A-720; HIWIN BS-08-2, F 3.24, which uses the rated torque and a factor of 1.5.
pub fn least_acceleration_time(inertia: f64, speed: f64, peak: f64, load: f64) -> Option<f64> {
    // t_a = J Ω_max/(T_peak − T_load)                                     (AA11)
    (peak > load).then(|| inertia * speed / (peak - load))
}

/// A screw that is back-driven by the load at standstill while the motor has no power.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BackDrivenScrew {
    /// Load torque on the screw without friction \[N·m\].
    pub torque: f64,
    /// Travel per radian of screw rotation \[m\].
    advance: f64,
    /// Moment of inertia, referred to the screw \[kg·m²\].
    inertia: f64,
}

impl BackDrivenScrew {
    /// Returns the linear acceleration \[m/s²\] that results from a net driving torque at the screw
    /// \[N·m\] (AA12).
    pub fn acceleration(&self, driving: f64) -> f64 {
        // a = T h/J                                                       (AA12)
        driving * self.advance / self.inertia
    }

    /// Returns the deceleration due to a brake \[m/s²\] (AA13), or `None` if the brake cannot hold
    /// the load.
    ///
    /// * `brake`: brake torque at the screw \[N·m\].
    pub fn braking(&self, brake: f64) -> Option<f64> {
        // a_B = (T_B − F h) h/J                                           (AA13)
        Some(self.acceleration(brake - self.torque)).filter(|braking| *braking > 0.0)
    }

    /// Returns the stopping distance with a brake \[m\] (AA13), or `None` if the brake cannot hold
    /// the load.
    ///
    /// ```math
    /// s = \frac{v + v_1}{2}t_B + \frac{v_1^2}{2a_B}, \qquad v_1 = v + \frac{F h^2}{J}t_B, \quad a_B = \frac{T_B - F h}{J}h
    /// ```
    ///
    /// * `brake`: brake torque at the screw \[N·m\].
    /// * `delay`: time until the brake engages \[s\].
    /// * `feed`: feed speed in the direction of the load when the power fails \[m/s\].
    pub fn stopping_distance(&self, brake: f64, delay: f64, feed: f64) -> Option<f64> {
        // v₁ = v + F h² t_B/J                                             (AA13)
        let reached = feed + self.acceleration(self.torque) * delay;
        // s = (v + v₁) t_B/2 + v₁²/(2 a_B)                                (AA13)
        Some(0.5 * (feed + reached) * delay + 0.5 * reached.powi(2) / self.braking(brake)?)
    }
}

/// Returns the stopping distance of an axis \[m\] if the drive decelerates it at a given rate after
/// a delay (BB5).
///
/// * `feed`: feed speed \[m/s\].
/// * `delay`: time until deceleration begins \[s\].
/// * `deceleration`: deceleration \[m/s²\], positive.
pub fn stopping_distance(feed: f64, delay: f64, deceleration: f64) -> f64 {
    // s = v t_B + v²/(2 a)                                                (BB5)
    feed * delay + 0.5 * feed.powi(2) / deceleration
}

#[cfg(test)]
mod tests {

    use approx::assert_relative_eq;

    use super::*;

    /// Hand calculation for a vertical axis that carries 250 kg on a screw with a lead of 10 mm, a
    /// drag torque of 0.25 N m and a back-driving efficiency of 0.75 to 0.85. Without friction, the
    /// load torque is 3.90194 N m. A screw with zero back-driving efficiency holds the load. For
    /// efficiencies between zero and 0.75, the result can depend on the uncertain drag torque.
    #[test]
    fn back_driving_torque_matches_a_hand_calculation() {
        let ideal = 250.0 * GRAVITY * 0.01 / TAU;
        assert_relative_eq!(ideal, 3.901_94, max_relative = 2e-6);
        let of = |efficiencies: [f64; 2], drag| {
            BackDriving::of(efficiencies.map(|eta| eta * ideal), drag)
        };
        let ([low, high], what) = of([0.75, 0.85], 0.25);
        // The hand calculation is accurate to four digits.
        assert_relative_eq!(low, 2.426_46, max_relative = 2e-6);
        assert_relative_eq!(high, 3.066_65, max_relative = 2e-6);
        assert_eq!(what, BackDriving::Turns);
        assert_relative_eq!(BRAKE_SAFETY * ideal, 5.852_91, max_relative = 2e-6);
        assert_eq!(of([-0.1, 0.0], 0.0).1, BackDriving::Holds);
        assert_eq!(of([0.2, 0.5], 1.0).1, BackDriving::Undecided);
    }

    /// On a horizontal axis, friction changes sign with the feed direction, and the weight does not
    /// load the screw. On a vertical axis, the load is the weight in both directions, and the
    /// guides carry no load. In a selection example by Nook, a weight of 5000 lb on guides with a
    /// friction coefficient of 0.0013 requires a force of 6.5 lb.
    #[test]
    fn carriage_load_follows_from_weight_and_friction() {
        let level = MachineTable { mass: 500.0, friction: 0.01, ..MachineTable::NONE };
        // Scrapers also cause friction on a vertical axis.
        let scraped = MachineTable { resistance: 15.0, inclination: FRAC_PI_2, ..level };
        assert_relative_eq!(scraped.load(0.0, -1.0, 0.0), 4903.325 - 15.0, max_relative = 1e-12);
        assert_relative_eq!(level.load(1e3, 1.0, 0.0), 1_049.033_25, max_relative = 1e-12);
        assert_relative_eq!(level.load(1e3, -1.0, 0.0), 950.966_75, max_relative = 1e-12);
        assert_relative_eq!(level.load(1e3, 0.0, 2.0), 2e3, max_relative = 1e-12);
        let upright = MachineTable { inclination: FRAC_PI_2, ..level };
        for direction in [1.0, -1.0] {
            assert_relative_eq!(upright.load(0.0, direction, 0.0), 4903.325, max_relative = 1e-12);
        }
        assert!(upright.guide_friction() <= 0.0, "guides of a vertical axis carry no load");
        let pounds = 0.453_592_37;
        let nook = MachineTable { mass: 5000.0 * pounds, friction: 0.0013, ..level };
        let in_pounds = nook.load(0.0, 1.0, 0.0) / (pounds * GRAVITY);
        assert_relative_eq!(in_pounds, 6.5, max_relative = 1e-12);
    }

    /// Hand calculation for a preload of 2 kN, a lead of 10 mm and tanα = 0.0796 (40 mm pitch
    /// circle): the drag torque is 0.1772 times 3.1831 N m.
    #[test]
    fn drag_torque_matches_a_hand_calculation() {
        let angle = (10.0_f64 / (PI * 40.0)).atan();
        assert!((drag_torque(2e3, 10e-3, angle) - 0.5642).abs() < 5e-5);
    }

    /// Hand calculation: a screw with a mass of 13.012 kg and a length of 1 m corresponds to a rod
    /// of 46 mm diameter, whose moment of inertia is 3.433e-3 kg m². For a rod of 30.164 mm
    /// diameter and the same length, the moment of inertia is 6.38007e-4 kg m².
    #[test]
    fn inertia_of_a_screw_with_known_mass_equals_inertia_of_a_rod() {
        let mass = STEEL * 0.25 * PI * 30.164e-3_f64.powi(2);
        assert_relative_eq!(rod_inertia(1.0, mass), 6.380_07e-4, max_relative = 1e-6);
        let inertia = rod_inertia(1.0, 13.012);
        assert_relative_eq!(inertia, 3.432_7e-3, max_relative = 2e-5);
        let diameter = (4.0 * 13.012 / (PI * STEEL)).sqrt();
        assert_relative_eq!(inertia, 13.012 * diameter.powi(2) / 8.0, max_relative = 1e-14);
    }

    /// Hand calculation: a rod of 1 m length and 40 mm diameter has a moment of inertia of 1.973e-3
    /// kg m², and a mass of 500 kg with a lead of 20 mm contributes 5.066e-3 kg m². At 2 m/s², the
    /// angular acceleration of the screw is 628.3 rad/s². With a gear ratio of 2, the motor must
    /// supply half the screw torque plus the torque that accelerates its own inertia at twice the
    /// angular acceleration.
    #[test]
    fn motor_inertia_and_torque_match_hand_calculations() {
        let screw = rod_inertia(1.0, STEEL * PI * 0.02_f64.powi(2));
        assert!((screw - 1.9729e-3).abs() < 5e-8, "{screw}");
        let drive = DriveTrain {
            lead: 20e-3,
            driven_inertia: screw,
            mass: 500.0,
            gear_ratio: 2.0,
            gear_efficiency: 1.0,
            motor_inertia: 1e-3,
            gear_inertia: 0.0,
            screws: 1.0,
            brake_at_rest: false,
        };
        assert!((drive.mass_inertia() - 5.0661e-3).abs() < 5e-8);
        assert_relative_eq!(
            4.0 * drive.load_inertia(),
            screw + drive.mass_inertia(),
            max_relative = 1e-14
        );
        // The load torque is 10 N m at the screw.
        let torque = |drive: &DriveTrain, speed: f64, acceleration: f64| {
            let load = 10.0 * TAU / drive.lead;
            let point = PhasePoint { acceleration, ..PhasePoint::steady(load, speed) };
            drive.motor_torque(&point, 0.0)
        };
        assert_relative_eq!(torque(&drive, 1.0, 0.0), 5.0, max_relative = 1e-14);
        let turning = 2.0 * TAU / 20e-3;
        let by_hand = 0.5 * (10.0 + screw * turning) + 2.0e-3 * turning;
        assert_relative_eq!(torque(&drive, 1.0, 2.0), by_hand, max_relative = 1e-14);
        // With a gear efficiency of 0.9, the driving side supplies the loss, so the torque is 5/0.9
        // forward and 5 · 0.9 backward.
        let lossy = DriveTrain { gear_efficiency: 0.9, gear_inertia: 1e-4, ..drive };
        assert_relative_eq!(torque(&lossy, 1.0, 0.0), 5.0 / 0.9, max_relative = 1e-14);
        assert_relative_eq!(torque(&lossy, -1.0, 0.0), 4.5, max_relative = 1e-14);
        // At standstill, there is no gear loss, and a brake can hold the load. Two screws on one
        // motor require twice the torque.
        assert_relative_eq!(torque(&lossy, 0.0, 0.0), 5.0, max_relative = 1e-14);
        let braked = DriveTrain { brake_at_rest: true, ..drive };
        assert_relative_eq!(torque(&braked, 0.0, 0.0), 0.0);
        let pair = DriveTrain { screws: 2.0, ..drive };
        assert_relative_eq!(torque(&pair, 1.0, 0.0), 10.0, max_relative = 1e-14);
        assert_relative_eq!(lossy.inertia() - drive.inertia(), 1e-4, max_relative = 1e-12);
    }

    /// The THK examples (A-722 to A-746) divide the whole force by an efficiency of 0.9 and add the
    /// inertia torque separately. Horizontal axis: 80 kg, 1 m/s in 0.15 s, 17.354 N, lead 40 mm
    /// (printed results: 3.39e-3 kg m², 0.12 and 4.73 N m). Vertical axis: 50 kg, 0.3 m/s in 0.2 s,
    /// 510.33 N, lead 10 mm (printed results: 1.58e-4 kg m², 0.90 and 1.10 N m). THK calculates the
    /// moment of inertia of the screw with the nominal diameter.
    #[test]
    fn motor_torques_match_examples_of_thk() {
        for (rod, length, mass, lead, motor, speed, ramp, force, inertia, torques) in [
            (20e-3, 1.2, 80.0, 40e-3, 1e-3, 1.0, 0.15, 17.354, 3.390_2e-3, [0.122_75, 4.720_2]),
            (15e-3, 0.8, 50.0, 10e-3, 5e-5, 0.3, 0.2, 510.33, 1.578_6e-4, [0.902_47, 1.098_4]),
        ] {
            let weight = STEEL * PI * 0.25 * rod * rod * length;
            let drive = DriveTrain {
                lead,
                driven_inertia: rod_inertia(length, weight),
                mass,
                gear_ratio: 1.0,
                gear_efficiency: 1.0,
                motor_inertia: motor,
                gear_inertia: 0.0,
                screws: 1.0,
                brake_at_rest: false,
            };
            // The tolerance is half a unit in the fifth digit.
            assert_relative_eq!(drive.load_inertia(), inertia, max_relative = 3.2e-5);
            let steady = force * lead / TAU / 0.9;
            assert_relative_eq!(steady, torques[0], max_relative = 4.1e-5);
            let turning = speed / ramp * TAU / lead;
            let accelerating = steady + drive.inertia() * turning;
            assert_relative_eq!(accelerating, torques[1], max_relative = 3e-5);
            // A motor whose peak torque equals the torque during acceleration reaches the speed in
            // exactly the ramp time.
            let time =
                least_acceleration_time(drive.inertia(), speed * TAU / lead, accelerating, steady);
            assert_relative_eq!(time.expect("it can"), ramp, max_relative = 1e-12);
        }
        assert_eq!(least_acceleration_time(1.0, 1.0, 1.0, 2.0), None);
    }

    /// Hand calculation for 250 kg on a screw with a lead of 10 mm and a moment of inertia of
    /// 2.07126e-3 kg m². A brake of 9 N m that engages after 0.05 s stops a feed of 0.25 m/s within
    /// 36.66 mm. Without a brake, the axis falls with an acceleration of 2.20649 m/s², for an
    /// efficiency of 0.8 and a drag torque of 0.25 N m.
    #[test]
    fn brake_stopping_distance_matches_a_hand_calculation() {
        let drive = DriveTrain {
            lead: 10e-3,
            driven_inertia: 6.380_07e-4,
            mass: 250.0,
            gear_ratio: 1.0,
            gear_efficiency: 1.0,
            motor_inertia: 8e-4,
            gear_inertia: 0.0,
            screws: 1.0,
            brake_at_rest: false,
        };
        assert_relative_eq!(drive.inertia(), 2.071_26e-3, max_relative = 3e-6);
        let back_driven_screw = drive.back_driven_screw(250.0 * GRAVITY);
        let distance = back_driven_screw.stopping_distance(9.0, 0.05, 0.25).expect("it holds");
        // The hand calculation is accurate to four digits.
        assert_relative_eq!(distance, 36.66e-3, max_relative = 2e-4);
        assert_eq!(back_driven_screw.stopping_distance(3.9, 0.05, 0.25), None);
        let fall = back_driven_screw.acceleration(0.8 * back_driven_screw.torque - 0.25);
        assert_relative_eq!(fall, 2.206_49, max_relative = 5e-6);
        assert_relative_eq!((2.0 * fall * 0.5).sqrt(), 1.485_43, max_relative = 5e-6);
    }
}
