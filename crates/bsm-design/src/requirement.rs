//! Requirements that a screw must meet, and checks that show whether a design meets them.

use std::f64::consts::{PI, TAU};

use bsm_dyn::{Direction, DrivenPart, Materials, angles::Optimum, hertz::Hertz};

use crate::catalog::{Candidate, Size};
use crate::drive::MachineTable;
use crate::life::{Life, RatingFactors, RequiredLife};
use crate::motion::{DutySpeed, Phase, PhasePoint, ProfileSegment, phases};
use crate::{
    Axis, Bounds, Grade, Make, Mount, Nut, NutBody, NutSet, PreloadMethod, PreloadSize, Range,
    Thread,
};

/// Default upper limit of the number of loaded turns.
///
/// Source: upper end of the typical range of two to six turns (`docs/theory/11-ratings.md`). With
/// more turns, the outer turns carry little load, which the load ratings do not take into account.
const DEFAULT_MAX_TURNS: f64 = 6.0;

/// Load on the screw, specified by the duty cycle of the machine or by a torque.
#[derive(Debug, Clone, PartialEq)]
pub enum LoadCase {
    /// Forces and speeds of the phases. The axis must move in at least one phase.
    Cycle(Vec<ProfileSegment>),
    /// A torque on the screw without friction, from which the axial load follows (L1).
    Torque {
        /// Torque on the screw \[N·m\].
        torque: f64,
        /// Speed of the screw or of the nut.
        speed: DutySpeed,
    },
}

impl LoadCase {
    /// Returns the phases of the duty cycle with the resulting axial loads.
    fn phases(&self, carriage: &MachineTable, nut: &Nut) -> Vec<Phase> {
        match self {
            Self::Cycle(motions) => phases(motions, carriage, nut.lead),
            Self::Torque { torque, speed } => {
                let (radius, speed) = (0.5 * nut.pitch_diameter, speed.speed(nut.lead));
                // F = M / (r_m tanα)                                      (L1)
                let load = torque / (radius * nut.lead_angle().tan());
                phases(
                    &[ProfileSegment::constant(1.0, DutySpeed::of_rotation(speed), load)],
                    &MachineTable::NONE,
                    nut.lead,
                )
            }
        }
    }
}

/// Lead of a screw, specified directly or as a lead angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pitch {
    /// Lead \[m\].
    Lead(f64),
    /// Lead angle \[rad\].
    Angle(f64),
}

impl Pitch {
    /// Returns the lead \[m\] for the given pitch circle diameter \[m\].
    pub(crate) fn lead(self, pitch_diameter: f64) -> f64 {
        match self {
            Self::Lead(lead) => lead,
            Self::Angle(angle) => PI * pitch_diameter * angle.tan(),
        }
    }
}

/// Length of the screw, specified directly or by the stroke.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Travel {
    /// Length of the screw \[m\]. The stroke is this length minus the nut length, without overruns.
    /// Unless the mount specifies the unsupported length, the whole screw is unsupported.
    Screw(f64),
    /// Stroke of the nut \[m\].
    Stroke(f64),
}

/// Quantity that the design optimizes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Objective {
    /// Maximize the efficiency.
    Efficiency,
    /// Maximize the dynamic load rating.
    Capacity,
    /// Minimize the mass of nut and screw.
    Mass,
    /// Minimize the moment of inertia of the screw.
    Inertia,
    /// Minimize the input power.
    Power,
}

impl Objective {
    /// Returns the design quantity that the objective optimizes.
    pub fn quantity(self) -> DesignQuantity {
        match self {
            Self::Efficiency => DesignQuantity::Efficiency,
            Self::Capacity => DesignQuantity::DynamicRating,
            Self::Mass => DesignQuantity::Mass,
            Self::Inertia => DesignQuantity::Inertia,
            Self::Power => DesignQuantity::InputPower,
        }
    }

    /// Returns true if the objective depends on the efficiency, which requires a ball model.
    pub(crate) fn asks_efficiency(self) -> bool {
        matches!(self, Self::Efficiency | Self::Power)
    }
}

/// Design variables with fixed values. All variables that are `None` are free.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FixedValues {
    /// Pitch circle diameter \[m\].
    pub pitch_diameter: Option<f64>,
    /// Ball diameter \[m\].
    pub ball: Option<f64>,
    /// Contact angle \[rad\].
    pub contact_angle: Option<f64>,
    /// Conformity of nut and screw.
    pub conformity: Option<f64>,
    /// Number of loaded turns.
    pub turns: Option<f64>,
}

/// Permitted ranges of the design quantities.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ranges {
    /// Contact angle \[rad\].
    pub contact_angle: Range,
    /// Lower limit of the ratio of pitch circle radius to screw length, if there is a limit.
    pub slimmest: Option<f64>,
    /// Limits of the ratio of ball radius to pitch circle radius.
    pub ball_over_radius: Bounds,
    /// Limits of the ratio of ball radius to groove radius.
    pub ball_over_groove: Bounds,
}

impl Ranges {
    /// Range of the ratio of ball radius to pitch circle radius in step 5 of Lin's procedure.
    pub const LIN_BALL_OVER_RADIUS: Range = Range { low: 0.07, high: 0.2 };

    /// Range of the ratio of ball radius to groove radius in step 6 of Lin's procedure.
    pub const LIN_BALL_OVER_GROOVE: Range = Range { low: 0.95, high: 0.97 };

    /// Returns the range of the ratio of ball radius to pitch circle radius that a search over
    /// continuous sizes covers.
    pub(crate) fn searched_ball_over_radius(&self) -> Range {
        self.ball_over_radius.range_or(Self::LIN_BALL_OVER_RADIUS)
    }

    /// Returns the range of the ratio of ball radius to groove radius that a search over continuous
    /// sizes covers.
    pub(crate) fn searched_ball_over_groove(&self) -> Range {
        self.ball_over_groove.range_or(Self::LIN_BALL_OVER_GROOVE)
    }
}

/// Transmission between motor and screw, with the speed limit of the motor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotorLimit {
    /// Ratio of motor speed to screw speed, positive.
    pub gear_ratio: f64,
    /// Upper limit of the motor speed \[rad/s\]; `None` without a limit.
    pub max_speed: Option<f64>,
}

/// All requirements that a screw must meet.
#[derive(Debug, Clone, PartialEq)]
pub struct Requirement {
    /// Forces and speeds of the duty cycle, or a torque.
    pub demand: LoadCase,
    /// Moving mass, whose weight, friction and inertia are added to the process forces.
    pub carriage: MachineTable,
    /// Requested preload; `None` for a nut without preload.
    pub preload: Option<PreloadSize>,
    /// Preload method.
    pub method: PreloadMethod,
    /// Gap between the nuts of a pair \[m\]; defaults to one pitch.
    pub nut_gap: Option<f64>,
    /// Part that the motor drives, either the screw or the nut.
    pub driven: DrivenPart,
    /// Ratio of the life at the required reliability to the life that 90 % of all nuts reach (Z14).
    pub reliability: f64,
    /// Factors by which the load ratings are modified (Z36).
    pub factors: RatingFactors,
    /// Direction of power flow.
    pub direction: Direction,
    /// Allowed leads or lead angles, at least one.
    pub pitches: Vec<Pitch>,
    /// Length or stroke of the screw.
    pub travel: Travel,
    /// End supports and length of the screw.
    pub mount: Mount,
    /// Upper limit of the ratio of speed to critical speed.
    pub speed_ratio: f64,
    /// Lower limit of the ratio of buckling load to largest load.
    pub buckling_safety: f64,
    /// Lower limit of the static safety factor.
    pub static_safety: f64,
    /// Required life.
    pub life: Option<RequiredLife>,
    /// Coulomb friction coefficient.
    pub friction: f64,
    /// Elastic constants of raceways and balls.
    pub material: Materials,
    /// Upper limit of the Hertzian contact pressure \[Pa\].
    pub pressure: f64,
    /// Upper limit of the speed number \[m·rad/s\]; defaults to the limit for the manufacturing
    /// process or the type of ball return.
    pub speed_number: Option<f64>,
    /// Manufacturing process or type of ball return. If it is `None`, a screw from a list of sizes
    /// has the make that the list states, and other screws are ground.
    pub make: Option<Make>,
    /// Accuracy grade, which limits the length of ground screws.
    pub grade: Option<&'static Grade>,
    /// Gear ratio and speed limit of the motor.
    pub motor: MotorLimit,
    /// Upper limit of the ratio of ball diameter to lead.
    pub ball_over_lead: f64,
    /// Upper limit of the pitch circle diameter \[m\].
    pub largest_diameter: f64,
    /// Upper limit of the number of loaded turns; `None` without a limit.
    pub largest_turns: Option<f64>,
    /// Lower limit of the efficiency; `None` without a limit.
    pub least_efficiency: Option<f64>,
    /// Upper limit of the input power \[W\]. If the motor drives the screw, this is the motor
    /// power.
    pub largest_power: Option<f64>,
    /// Permitted ranges of further design quantities.
    pub ranges: Ranges,
    /// Quantity that the search optimizes.
    pub objective: Objective,
    /// Design variables whose values are fixed.
    pub fixed: FixedValues,
    /// Available ball diameters \[m\].
    pub stock: Vec<f64>,
}

/// Quantities of a design that may have limits, in the order of the steps of Lin's procedure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names state the quantities; all values are in SI units")]
pub enum DesignQuantity {
    LeadAngle,
    BestContactAngle,
    ContactAngle,
    ScrewLength,
    RadiusOverLength,
    PitchDiameter,
    BallOverRadius,
    BallOverLead,
    BallOverGroove,
    Conformity,
    Turns,
    LargestLoad,
    NormalLoad,
    Lead,
    Stroke,
    StrokeTurns,
    Advance,
    SpeedNumber,
    MotorSpeed,
    NutPressure,
    ScrewPressure,
    EllipseEnd,
    Efficiency,
    InputPower,
    OutputPower,
    DynamicRating,
    EquivalentLoad,
    Life,
    StaticSafety,
    Preload,
    CriticalSpeedRatio,
    BucklingSafety,
    UnsupportedLength,
    Inertia,
    Mass,
}

impl DesignQuantity {
    /// Returns true if the quantity depends only on pitch circle, ball diameter and lead.
    pub(crate) fn is_of_size(self) -> bool {
        matches!(
            self,
            Self::RadiusOverLength
                | Self::PitchDiameter
                | Self::BallOverRadius
                | Self::BallOverLead
                | Self::SpeedNumber
                | Self::MotorSpeed
                | Self::UnsupportedLength
        )
    }
}

/// A quantity of a design with its limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Check {
    /// Step of Lin's procedure that introduces the quantity, or 11 for additional quantities.
    pub step: u8,
    /// Quantity that is compared with its limits.
    pub quantity: DesignQuantity,
    /// Value of the quantity, or NaN if it cannot be calculated.
    pub value: f64,
    /// Limits of the quantity.
    pub bounds: Bounds,
}

impl Check {
    fn new(step: u8, quantity: DesignQuantity, value: f64, bounds: Bounds) -> Self {
        Self { step, quantity, value, bounds }
    }

    /// Creates a quantity without limits.
    fn unlimited(step: u8, quantity: DesignQuantity, value: f64) -> Self {
        Self::new(step, quantity, value, Bounds::default())
    }

    /// Returns true if the quantity has no limits or meets them.
    pub fn passes(&self) -> bool {
        self.bounds.are_met_by(self.value)
    }

    /// Returns the violation relative to the limit (see [`Bounds::violation`]).
    pub fn violation(&self) -> Option<f64> {
        self.bounds.violation(self.value)
    }
}

impl Requirement {
    /// Default upper limit of the ratio of ball diameter to groove spacing. The remaining part of
    /// the spacing is the land between neighboring grooves.
    pub const BALL_OVER_LEAD: f64 = 0.8;

    /// Returns the required make of a screw or, if none is required, the make in the list of sizes.
    /// Without either, the screw is ground.
    ///
    /// * `size`: size of the screw in a list of sizes; `None` for continuous sizes.
    fn make_of(&self, size: Option<&Size>) -> Make {
        self.make.or_else(|| size?.make()).unwrap_or(Make::Ground)
    }

    /// Returns true if the make and the grade of the requirement permit the make that a list of
    /// sizes states.
    ///
    /// * `listed`: make in the list of sizes; `None` if the list does not state it.
    pub fn permits_make(&self, listed: Option<Make>) -> bool {
        Make::may_be_selected(listed, self.make, self.grade)
    }

    /// Returns the largest number of loaded turns that a search over continuous sizes tries.
    pub(crate) fn searched_turns(&self) -> f64 {
        self.largest_turns.unwrap_or(DEFAULT_MAX_TURNS)
    }

    /// Returns a copy of the requirement with an upper limit on the number of loaded turns. If the
    /// requirement has no such limit, the default limit is used.
    ///
    /// * `listed`: largest number of turns in a list of sizes, or infinity. If it is finite and
    ///   larger than the default limit, it replaces the default limit.
    #[must_use]
    pub fn with_usual_turns(&self, listed: f64) -> Self {
        let usual = self.searched_turns();
        let largest = if listed.is_finite() { listed.max(usual) } else { usual };
        Self { largest_turns: self.largest_turns.or(Some(largest)), ..self.clone() }
    }

    /// Returns a copy of the requirement in which missing limits of ratios and turns are replaced
    /// by the limits for a search over continuous sizes. A search over lists of sizes does not need
    /// these limits.
    #[must_use]
    pub fn of_any_size(&self) -> Self {
        let ranges = Ranges {
            ball_over_radius: self.ranges.searched_ball_over_radius().into(),
            ball_over_groove: self.ranges.searched_ball_over_groove().into(),
            ..self.ranges
        };
        Self { ranges, largest_turns: Some(self.searched_turns()), ..self.clone() }
    }

    /// Returns those design rules of the axis that do not require the loads of all balls.
    ///
    /// * `calculated`: calculated dynamic load rating without modifying factors \[N\].
    fn rules(&self, axis: &Axis, calculated: f64) -> Vec<Check> {
        let (rating, life) = (axis.dynamic_rating, axis.life());
        let of_life = |number: &dyn Fn(&Life) -> f64| life.as_ref().map_or(f64::NAN, number);
        let lead = axis.screw.lead;
        let required = self.life.zip(life.as_ref());
        let required = required.map(|(required, life)| required.time(lead, life.mean_speed));
        let (most, least) = (Bounds::at_most, Bounds::at_least);
        let rule = |quantity, value, bounds| Check::new(11, quantity, value, bounds);
        let mut rules = vec![
            rule(DesignQuantity::DynamicRating, calculated, Bounds::default()),
            // C_a ≥ F_m                                                   (L10)
            rule(
                DesignQuantity::EquivalentLoad,
                of_life(&|life| life.mean_load),
                most(Some(rating)),
            ),
            rule(DesignQuantity::Life, of_life(&|life| life.time), least(required)),
            rule(
                DesignQuantity::StaticSafety,
                axis.static_safety(),
                least(Some(self.static_safety)),
            ),
        ];
        let largest = most(Some(self.method.share() * rating));
        // F_pr ≤ q C_a                                                    (AA6)
        rules.extend(axis.preload.map(|x| rule(DesignQuantity::Preload, x, largest)));
        let (ratio, largest) = (axis.critical_speed_ratio(), most(Some(self.speed_ratio)));
        rules.extend(ratio.map(|x| rule(DesignQuantity::CriticalSpeedRatio, x, largest)));
        let safety = if self.mount.may_be_unguided() {
            axis.buckling_safety_of_support()
        } else {
            axis.buckling_safety()
        };
        let smallest = least(Some(self.buckling_safety));
        rules.extend(safety.map(|x| rule(DesignQuantity::BucklingSafety, x, smallest)));
        rules
    }
}

/// A screw designed for a requirement, with all its checks.
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    /// The nut with its groove geometry.
    pub nut: Nut,
    /// Size in the lists from which the nut was chosen; `None` in a search over continuous sizes.
    pub size: Option<Size>,
    /// Operating point for which the efficiency is calculated. It has the largest load of all
    /// phases with motion.
    pub phase: PhasePoint,
    /// Quantities of all steps with their limits.
    pub checks: Vec<Check>,
}

/// Function that returns the efficiency of a design at its operating point, or `None` if the
/// selected model has no solution. The checks of the design contain no efficiency.
pub type EfficiencyOf<'a> = &'a (dyn Fn(&Design) -> Option<f64> + Sync);

/// Reason why a design does not meet the rules that depend on the loads of all balls.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Rejection {
    /// The design violates the rules with these names.
    Rules(Vec<&'static str>),
    /// The rules could not be calculated. The text states the reason.
    NotCalculated(String),
}

/// Function that checks a design against the rules that depend on the loads of all balls.
pub type AcceptedBy<'a> = &'a (dyn Fn(&Design) -> Result<(), Rejection> + Sync);

/// A nut in the axis of a requirement, with the loads and motions of the requirement.
struct Evaluated {
    nut: Nut,
    body: NutBody,
    thread: Thread,
    axis: Axis,
    /// Operating point with the largest load among the phases with motion.
    phase: PhasePoint,
    /// Length of the screw \[m\], or NaN if it is not known.
    length: f64,
    /// Stroke of the nut \[m\].
    stroke: f64,
    /// Calculated dynamic load rating without modifying factors \[N\].
    dynamic_rating: f64,
}

impl Evaluated {
    fn of(requirement: &Requirement, nut: Nut) -> Self {
        let method = requirement.preload.map(|_| requirement.method);
        let body = NutBody::usual(&nut, NutSet::of(method, requirement.nut_gap));
        let thread = nut.thread(0.0, nut.usual_lands());
        let (screw, dynamic_rating) = (nut.screw(&thread), nut.dynamic_rating().rating);
        let mut mount = requirement.mount;
        let stroke = match requirement.travel {
            Travel::Screw(length) => {
                mount.length = mount.length.or(Some(length));
                length - body.length
            }
            Travel::Stroke(stroke) => stroke,
        };
        let shaft = mount.shaft(&screw, body.length, Some(stroke));
        let length = match requirement.travel {
            Travel::Screw(length) => length,
            Travel::Stroke(_) => shaft.map_or(f64::NAN, |shaft| shaft.length),
        };
        let mut axis = Axis {
            screw,
            shaft,
            phases: requirement.demand.phases(&requirement.carriage, &nut),
            dynamic_rating: requirement.factors.dynamic_rating * dynamic_rating,
            static_rating: requirement.factors.static_rating * nut.static_rating().rating,
            preload: None,
            driven: requirement.driven,
            compression: 0.0,
            reliability: requirement.reliability,
        };
        let force = |preload: PreloadSize| preload.force(axis.largest_load(), axis.dynamic_rating);
        axis.preload = requirement.preload.map(force);
        let phase = axis.heaviest_moving().unwrap_or(PhasePoint::REST);
        Self { nut, body, thread, axis, phase, length, stroke, dynamic_rating }
    }

    /// Returns the travel of the nut per radian of screw rotation \[m\].
    fn travel_per_radian(&self) -> f64 {
        0.5 * self.nut.pitch_diameter * self.nut.lead_angle().tan()
    }

    /// Returns the speed of the nut along the screw \[m/s\] (L6).
    fn advance(&self) -> f64 {
        // v = r_m tanα W                                                  (L6)
        self.travel_per_radian() * self.phase.speed.abs()
    }

    /// Returns the normal load of a ball with equal load sharing \[N\] (L2).
    fn normal_load(&self) -> f64 {
        let balls = self.nut.balls_per_turn * self.nut.turns;
        // Q = F_a / (Z cosα sinβ)                                         (L2)
        self.axis.larger_nut_load()
            / (balls * self.nut.lead_angle().cos() * self.nut.contact_angle.sin())
    }

    /// Returns the quantities of steps 1 to 7, which describe the geometry of the screw and its
    /// largest loads.
    fn geometry_checks(&self, requirement: &Requirement) -> Vec<Check> {
        let Requirement { direction, friction, ranges, .. } = *requirement;
        let Self { nut, axis, length, .. } = self;
        let (lead, beta) = (nut.lead_angle(), nut.contact_angle);
        let (radius, ball) = (0.5 * nut.pitch_diameter, 0.5 * nut.ball_diameter);
        let best = Optimum::of(direction, lead, friction);
        let best = best.map_or(f64::NAN, |best| best.contact_angle);
        let most = requirement.largest_turns.filter(|_| requirement.fixed.turns.is_none());
        vec![
            Check::unlimited(1, DesignQuantity::LeadAngle, lead),
            Check::unlimited(2, DesignQuantity::BestContactAngle, best),
            Check::new(2, DesignQuantity::ContactAngle, beta, ranges.contact_angle.into()),
            Check::unlimited(3, DesignQuantity::ScrewLength, *length),
            // r_m ≥ l/60                                                  (L3)
            Check::new(
                4,
                DesignQuantity::RadiusOverLength,
                radius / length,
                Bounds::at_least(ranges.slimmest),
            ),
            Check::new(
                4,
                DesignQuantity::PitchDiameter,
                nut.pitch_diameter,
                Bounds::at_most(Some(requirement.largest_diameter)),
            ),
            // 0.07 ≤ r_b/r_m ≤ 0.2                                        (L4)
            Check::new(5, DesignQuantity::BallOverRadius, ball / radius, ranges.ball_over_radius),
            Check::new(
                5,
                DesignQuantity::BallOverLead,
                nut.ball_diameter / nut.pitch(),
                Bounds::at_most(Some(requirement.ball_over_lead)),
            ),
            // 0.95 ≤ r_b/r_2 ≤ 0.97,  r_2 = 2 f r_b                       (L5)
            Check::new(
                6,
                DesignQuantity::BallOverGroove,
                0.5 / nut.conformity.nut,
                ranges.ball_over_groove,
            ),
            Check::unlimited(6, DesignQuantity::Conformity, nut.conformity.nut),
            Check::new(7, DesignQuantity::Turns, nut.turns, Bounds::at_most(most)),
            Check::new(
                7,
                DesignQuantity::LargestLoad,
                axis.largest_load(),
                Bounds::at_most(axis.yield_load()),
            ),
            Check::unlimited(7, DesignQuantity::NormalLoad, self.normal_load()),
        ]
    }

    /// Returns the quantities of step 8, which describe the motion of the nut.
    ///
    /// * `make`: make of the screw, from which the default limit of the speed number follows.
    fn motion_checks(&self, requirement: &Requirement, make: Make) -> Vec<Check> {
        let Self { nut, thread, axis, stroke, .. } = self;
        // s = r_m tanα φ                                                  (L7)
        let lead = self.travel_per_radian() * TAU;
        let most = requirement
            .speed_number
            .unwrap_or_else(|| make.speed_number(nut.lead, thread.screw.land));
        let MotorLimit { gear_ratio, max_speed } = requirement.motor;
        vec![
            Check::unlimited(8, DesignQuantity::Lead, lead),
            Check::unlimited(8, DesignQuantity::Stroke, *stroke),
            Check::unlimited(8, DesignQuantity::StrokeTurns, stroke / lead),
            Check::unlimited(8, DesignQuantity::Advance, self.advance()),
            Check::new(
                8,
                DesignQuantity::SpeedNumber,
                axis.speed_number(),
                Bounds::at_most(Some(most)),
            ),
            Check::new(
                8,
                DesignQuantity::MotorSpeed,
                gear_ratio * axis.fastest(),
                Bounds::at_most(max_speed),
            ),
        ]
    }

    /// Returns the quantities of steps 9 and 10, which describe the contacts and the power.
    fn contact_and_power_checks(&self, requirement: &Requirement, efficiency: f64) -> Vec<Check> {
        let Self { nut, thread, phase, .. } = self;
        let (normal, hertz) = (self.normal_load(), nut.hertz().ok());
        let pressed = |number: &dyn Fn(&Hertz) -> f64| match &hertz {
            Some(both) => both.each_ref().map(number),
            None => [f64::NAN; 2],
        };
        let [at_nut, at_screw] = pressed(&|hertz| hertz.max_pressure(normal));
        let semi_axes = pressed(&|hertz| hertz.semi_axes(normal).0);
        let pressure = Bounds::at_most(Some(requirement.pressure));
        // β + a/R ≤ θ                                                     (L9)
        let end = nut.contact_angle + semi_axes[0].max(semi_axes[1]) / thread.nut.radius;
        // P_out = η P_in; F_a v is the power at the nut                   (L8)
        let nut_power = phase.load.abs() * self.advance();
        let (input, output) = match requirement.direction {
            Direction::RotaryToLinear => (nut_power / efficiency, nut_power),
            Direction::LinearToRotary => (nut_power, nut_power * efficiency),
        };
        vec![
            Check::new(9, DesignQuantity::NutPressure, at_nut, pressure),
            Check::new(9, DesignQuantity::ScrewPressure, at_screw, pressure),
            Check::new(9, DesignQuantity::EllipseEnd, end, Bounds::at_most(Some(thread.nut.edge))),
            Check::new(
                10,
                DesignQuantity::Efficiency,
                efficiency,
                Bounds::at_least(requirement.least_efficiency),
            ),
            Check::new(
                10,
                DesignQuantity::InputPower,
                input,
                Bounds::at_most(requirement.largest_power),
            ),
            Check::unlimited(10, DesignQuantity::OutputPower, output),
        ]
    }

    /// Returns the unsupported length, the inertia and the mass, which follow from the length of
    /// the screw.
    ///
    /// * `make`: make of the screw, which limits its length.
    fn size_checks(&self, requirement: &Requirement, make: Make) -> Vec<Check> {
        let Self { nut, body, thread, axis, length, .. } = self;
        let (screw, shaft) = (&axis.screw, axis.shaft.as_ref());
        let longest = Bounds::at_most(make.longest(requirement.grade, screw.outer));
        let unsupported = shaft
            .map(|shaft| Check::new(11, DesignQuantity::UnsupportedLength, shaft.length, longest));
        let inertia =
            shaft.map_or(f64::NAN, |shaft| screw.inertia(shaft.bore.diameter, shaft.length));
        let bore = requirement.mount.bore.diameter;
        let mass = body.mass(nut, thread) + screw.mass(bore, *length);
        let mut checks = Vec::from_iter(unsupported);
        checks.push(Check::unlimited(11, DesignQuantity::Inertia, inertia));
        checks.push(Check::unlimited(11, DesignQuantity::Mass, mass));
        checks
    }
}

impl Design {
    /// Calculates the quantities (L1) to (L10) of a nut. Without `efficiency`, efficiency and power
    /// are NaN.
    ///
    /// Source: procedure of Lin, Velinsky and Ravani (1994) for both directions, extended by load
    /// rating and life according to ISO 3408-5.
    pub fn of(requirement: &Requirement, nut: Nut, efficiency: Option<EfficiencyOf<'_>>) -> Self {
        Self::of_size(requirement, nut, None, efficiency)
    }

    /// Calculates the quantities of a nut from the lists, as [`of`](Self::of) does, and stores its
    /// size.
    pub fn of_candidate(requirement: &Requirement, candidate: &Candidate) -> Self {
        Self::of_size(requirement, candidate.nut, Some(candidate.size), None)
    }

    /// Calculates the quantities of this design again, with the given efficiency.
    #[must_use]
    pub fn with_efficiency(&self, requirement: &Requirement, efficiency: EfficiencyOf<'_>) -> Self {
        Self::of_size(requirement, self.nut, self.size, Some(efficiency))
    }

    fn of_size(
        requirement: &Requirement,
        nut: Nut,
        size: Option<Size>,
        efficiency: Option<EfficiencyOf<'_>>,
    ) -> Self {
        let evaluated = Evaluated::of(requirement, nut);
        let phase = evaluated.phase;
        let make = requirement.make_of(size.as_ref());
        let mut checks = evaluated.geometry_checks(requirement);
        checks.extend(evaluated.motion_checks(requirement, make));
        let place = checks.len();
        let of_contacts = |efficiency| evaluated.contact_and_power_checks(requirement, efficiency);
        checks.extend(of_contacts(f64::NAN));
        checks.extend(requirement.rules(&evaluated.axis, evaluated.dynamic_rating));
        checks.extend(evaluated.size_checks(requirement, make));
        let mut design = Self { nut, size, phase, checks };
        if let Some(efficiency) = efficiency.and_then(|of| of(&design)) {
            let of_contacts = of_contacts(efficiency);
            design.checks[place..place + of_contacts.len()].copy_from_slice(&of_contacts);
        }
        design
    }

    /// Returns true if all checks pass.
    pub fn is_feasible(&self) -> bool {
        self.checks.iter().all(Check::passes)
    }

    /// Returns the preload of the nut \[N\], or `None` without a preload.
    pub fn preload(&self) -> Option<f64> {
        Some(self.value(DesignQuantity::Preload)).filter(|force| !force.is_nan())
    }

    /// Returns the value of a quantity, or NaN if the design does not contain it.
    pub fn value(&self, quantity: DesignQuantity) -> f64 {
        let found = self.checks.iter().find(|check| check.quantity == quantity);
        found.map_or(f64::NAN, |check| check.value)
    }

    /// Returns the objective as a number of order one, which the search minimizes.
    pub fn objective(&self, objective: Objective) -> f64 {
        match objective {
            Objective::Efficiency => 1.0 - self.value(DesignQuantity::Efficiency),
            Objective::Capacity => (self.value(DesignQuantity::LargestLoad)
                / self.value(DesignQuantity::DynamicRating))
            .ln(),
            Objective::Mass | Objective::Inertia | Objective::Power => {
                self.value(objective.quantity()).ln()
            }
        }
    }
}
