//! The requirement for a screw, and the checks of a design.

use std::f64::consts::{PI, TAU};

use bsm_dyn::{Direction, DrivenPart, Material, angles::Optimum, hertz::Hertz};

use crate::{
    Axis, DutySpeed, Grade, Life, MachineTable, Make, Mount, Nut, NutBody, NutSet, Phase,
    PhasePoint, PreloadMethod, PreloadSize, ProfileSegment, RatingFactors, RequiredLife, phases,
};

/// The cycle of the machine, or a torque.
#[derive(Debug, Clone, PartialEq)]
pub enum LoadCase {
    /// Forces and speeds of at least one phase. At least one of the phases moves.
    Cycle(Vec<ProfileSegment>),
    /// Torque on the screw \[N·m\], and its speed.
    Torque(f64, DutySpeed),
}

impl LoadCase {
    /// Returns the loads of a screw.
    fn phases(&self, carriage: &MachineTable, nut: &Nut) -> Vec<Phase> {
        match self {
            Self::Cycle(motions) => phases(motions, carriage, nut.lead),
            Self::Torque(torque, pace) => {
                let (radius, speed) = (0.5 * nut.pitch_diameter, pace.speed(nut.lead));
                // F = M / (r_m tanα)                                      (L1)
                let load = torque / (radius * nut.lead_angle().tan());
                phases(
                    &[ProfileSegment::constant(1.0, DutySpeed::of_turns(speed), load)],
                    &MachineTable::NONE,
                    nut.lead,
                )
            }
        }
    }
}

/// Lead or lead angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pitch {
    /// Lead \[m\].
    Lead(f64),
    /// Lead angle \[rad\].
    Angle(f64),
}

impl Pitch {
    /// Returns the lead \[m\] for a pitch circle diameter \[m\].
    pub(crate) fn lead(self, pitch_diameter: f64) -> f64 {
        match self {
            Self::Lead(lead) => lead,
            Self::Angle(angle) => PI * pitch_diameter * angle.tan(),
        }
    }
}

/// Length of the screw, or of its stroke.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Travel {
    /// Length of the screw \[m\].
    Screw(f64),
    /// Travel of the nut \[m\].
    Stroke(f64),
}

/// Objective of the design.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Objective {
    /// The largest efficiency.
    Efficiency,
    /// The largest dynamic load rating.
    Capacity,
    /// The smallest mass of nut and screw.
    Mass,
    /// The smallest moment of inertia of the screw.
    Inertia,
    /// The smallest input power.
    Power,
}

impl Objective {
    /// Returns the quantity of the objective.
    pub fn quantity(self) -> Quantity {
        match self {
            Self::Efficiency => Quantity::Efficiency,
            Self::Capacity => Quantity::DynamicRating,
            Self::Mass => Quantity::Mass,
            Self::Inertia => Quantity::Inertia,
            Self::Power => Quantity::InputPower,
        }
    }

    /// Returns true if the objective requires the efficiency of a model.
    pub(crate) fn asks_efficiency(self) -> bool {
        matches!(self, Self::Efficiency | Self::Power)
    }
}

/// Fixed values. All other variables are free.
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
    /// Loaded turns.
    pub turns: Option<f64>,
}

/// Limits of a screw: smallest and largest value of each quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ranges {
    /// Contact angle \[rad\].
    pub contact_angle: (f64, f64),
    /// Smallest ratio of pitch circle radius to screw length, if it is limited.
    pub slimmest: Option<f64>,
    /// Ratio of ball radius to pitch circle radius, as far as it is limited.
    pub ball_over_radius: (Option<f64>, Option<f64>),
    /// Ratio of ball radius to groove radius, as far as it is limited.
    pub ball_over_groove: (Option<f64>, Option<f64>),
}

impl Ranges {
    /// Range of the ratio of ball radius to pitch circle radius in Lin's step 5.
    pub const LIN_BALL_OVER_RADIUS: (f64, f64) = (0.07, 0.2);

    /// Range of the ratio of ball radius to groove radius in Lin's step 6.
    pub const LIN_BALL_OVER_GROOVE: (f64, f64) = (0.95, 0.97);

    /// Returns the range of the ratio of ball radius to pitch circle radius for a search of
    /// continuous sizes.
    pub(crate) fn searched_ball_over_radius(&self) -> (f64, f64) {
        searched(self.ball_over_radius, Self::LIN_BALL_OVER_RADIUS)
    }

    /// Returns the range of the ratio of ball radius to groove radius for a search of continuous
    /// sizes.
    pub(crate) fn searched_ball_over_groove(&self) -> (f64, f64) {
        searched(self.ball_over_groove, Self::LIN_BALL_OVER_GROOVE)
    }
}

/// Returns the given limits. A missing limit is replaced by the limit of Lin.
fn searched((low, high): (Option<f64>, Option<f64>), lin: (f64, f64)) -> (f64, f64) {
    (low.unwrap_or(lin.0), high.unwrap_or(lin.1))
}

/// Requirement of a screw.
#[derive(Debug, Clone, PartialEq)]
pub struct Requirement {
    /// Forces and speeds, or a torque.
    pub demand: LoadCase,
    /// Moved mass, whose weight, friction and inertia are added to the forces.
    pub carriage: MachineTable,
    /// Preload of a nut.
    pub preload: Option<PreloadSize>,
    /// Preload method.
    pub method: PreloadMethod,
    /// Gap between the nuts of a pair \[m\]; defaults to one pitch.
    pub nut_gap: Option<f64>,
    /// The part that the motor drives.
    pub driven: DrivenPart,
    /// Life divided by the life that 90 % of all nuts reach (Z14).
    pub reliability: f64,
    /// Factors of the load ratings (Z36).
    pub factors: RatingFactors,
    /// Side that drives.
    pub direction: Direction,
    /// Leads or lead angles to choose from, at least one.
    pub pitches: Vec<Pitch>,
    /// Length of the screw, or stroke.
    pub travel: Travel,
    /// End supports and length of the screw.
    pub mount: Mount,
    /// Largest ratio of speed to critical speed.
    pub speed_ratio: f64,
    /// Smallest ratio of buckling load to the largest load.
    pub buckling_safety: f64,
    /// Smallest static safety factor.
    pub static_safety: f64,
    /// Required life.
    pub life: Option<RequiredLife>,
    /// Coulomb friction coefficient.
    pub friction: f64,
    /// Elastic constants of raceways and balls.
    pub material: (Material, Material),
    /// Largest Hertz pressure \[Pa\].
    pub pressure: f64,
    /// Largest speed number \[m·rad/s\]; defaults to the limit of the make.
    pub speed_number: Option<f64>,
    /// Make of the screw.
    pub make: Make,
    /// Accuracy grade, which limits the length of a ground screw.
    pub grade: Option<&'static Grade>,
    /// Ratio of motor speed to screw speed, and the largest motor speed \[rad/s\].
    pub motor: (f64, Option<f64>),
    /// Largest ratio of ball diameter to lead.
    pub ball_over_lead: f64,
    /// Largest pitch circle diameter \[m\].
    pub largest_diameter: f64,
    /// Largest number of loaded turns, if it is limited.
    pub largest_turns: Option<f64>,
    /// Smallest efficiency.
    pub least_efficiency: Option<f64>,
    /// Largest input power \[W\], which is the motor power if the motor drives the screw.
    pub largest_power: Option<f64>,
    /// Limits of the screw.
    pub ranges: Ranges,
    /// Objective.
    pub objective: Objective,
    /// Fixed values.
    pub fixed: FixedValues,
    /// Available ball diameters \[m\].
    pub stock: Vec<f64>,
}

/// A quantity of a design, in the order of Lin's steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "said by the names; SI units")]
pub enum Quantity {
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

impl Quantity {
    /// Returns true if the quantity depends only on pitch circle, ball and lead.
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

/// Relative rounding error at which a limit counts as met, because inputs are decimal numbers.
pub(crate) const ROUNDING: f64 = 1e-9;

/// A quantity of a design, and its limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Check {
    /// Step of Lin's procedure; 11 for quantities that are not part of the procedure.
    pub step: u8,
    /// The quantity.
    pub quantity: Quantity,
    /// Value of the quantity; NaN if the quantity has no value.
    pub value: f64,
    /// Lower limit.
    pub least: Option<f64>,
    /// Upper limit.
    pub most: Option<f64>,
}

impl Check {
    /// Returns true if the quantity has no limit or meets its limit.
    pub fn passes(&self) -> bool {
        self.violation().is_none_or(|violation| violation <= ROUNDING)
    }

    /// Returns the violation relative to the limit, which is not positive if the check passes.
    /// Returns `None` without a limit.
    pub fn violation(&self) -> Option<f64> {
        let below = self.least.map(|least| 1.0 - self.value / least);
        let above = self.most.map(|most| self.value / most - 1.0);
        let violation = match (below, above) {
            (Some(below), Some(above)) => below.max(above),
            (one, other) => one.or(other)?,
        };
        Some(if self.value.is_nan() { 1.0 } else { violation })
    }
}

/// A quantity with its value, its lower limit and its upper limit.
type Bounds = (Quantity, f64, Option<f64>, Option<f64>);

impl Requirement {
    /// Default of the largest ratio of ball diameter to the pitch of the grooves. The rest of the
    /// pitch is land.
    pub const BALL_OVER_LEAD: f64 = 0.8;

    /// Returns the largest number of loaded turns in a search of continuous sizes.
    pub(crate) fn searched_turns(&self) -> f64 {
        self.largest_turns.unwrap_or(6.0)
    }

    /// Returns the requirement with the usual limit of loaded turns if it has no limit.
    ///
    /// * `listed`: the limit of a list of sizes, infinite if the list has none.
    #[must_use]
    pub fn with_usual_turns(&self, listed: f64) -> Self {
        let usual = self.searched_turns();
        let largest = if listed.is_finite() { listed.max(usual) } else { usual };
        Self { largest_turns: self.largest_turns.or(Some(largest)), ..self.clone() }
    }

    /// Returns the requirement in which missing limits of shapes and turns are replaced by the
    /// limits for a search of continuous sizes. Sizes from lists do not need these limits.
    #[must_use]
    pub fn of_any_size(&self) -> Self {
        let both = |(low, high)| (Some(low), Some(high));
        let ranges = Ranges {
            ball_over_radius: both(self.ranges.searched_ball_over_radius()),
            ball_over_groove: both(self.ranges.searched_ball_over_groove()),
            ..self.ranges
        };
        Self { ranges, largest_turns: Some(self.searched_turns()), ..self.clone() }
    }

    /// Returns the rules of an axis that do not need the loads of all balls.
    ///
    /// * `calculated`: dynamic load rating without factors \[N\].
    fn rules(&self, axis: &Axis, calculated: f64) -> Vec<Bounds> {
        let (rating, life) = (axis.dynamic_rating, axis.life());
        let of_life = |number: &dyn Fn(&Life) -> f64| life.as_ref().map_or(f64::NAN, number);
        let lead = axis.screw.lead;
        let required = self.life.zip(life.as_ref());
        let required = required.map(|(required, life)| required.time(lead, life.mean_speed));
        let mut rules = vec![
            (Quantity::DynamicRating, calculated, None, None),
            // C_a ≥ F_m                                                   (L10)
            (Quantity::EquivalentLoad, of_life(&|life| life.mean_load), None, Some(rating)),
            (Quantity::Life, of_life(&|life| life.time), required, None),
            (Quantity::StaticSafety, axis.static_safety(), Some(self.static_safety), None),
        ];
        let preload = axis.preload;
        let most = self.method.share() * rating;
        // F_pr ≤ φ C_a                                                    (AA6)
        rules.extend(preload.map(|x| (Quantity::Preload, x, None, Some(most))));
        let ratio = axis.critical_speed_ratio();
        rules
            .extend(ratio.map(|x| (Quantity::CriticalSpeedRatio, x, None, Some(self.speed_ratio))));
        let safety = axis.buckling_safety();
        rules.extend(
            safety.map(|x| (Quantity::BucklingSafety, x, Some(self.buckling_safety), None)),
        );
        rules
    }
}

/// A screw for a requirement.
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    /// The nut.
    pub nut: Nut,
    /// The moment for which the efficiency is calculated: the moment with the largest load among
    /// the phases that move.
    pub phase: PhasePoint,
    /// The quantities of the steps.
    pub checks: Vec<Check>,
}

/// Returns the efficiency of a nut at a moment of a phase by the chosen model, if it has one.
pub type EfficiencyOf<'a> = &'a (dyn Fn(&Nut, &PhasePoint) -> Option<f64> + Sync);

/// Judges a nut by the rules that need the loads of all balls, and returns the names of the rules
/// that it violates.
pub type AcceptedBy<'a> = &'a (dyn Fn(&Nut) -> Result<(), Vec<&'static str>> + Sync);

impl Design {
    /// Returns the steps of a nut (L1) to (L10). The efficiency is omitted if it is not requested.
    ///
    /// Source: Lin, Velinsky and Ravani (1994), the procedure for both directions, with the
    /// addition of the load rating and the life of ISO 3408-5.
    #[expect(clippy::too_many_lines, reason = "a step of the procedure after the other")]
    pub fn of(requirement: &Requirement, nut: Nut, efficiency: Option<EfficiencyOf<'_>>) -> Self {
        let Requirement { direction, friction, ranges, .. } = *requirement;
        let (lead, beta) = (nut.lead_angle(), nut.contact_angle);
        let (radius, ball) = (0.5 * nut.pitch_diameter, 0.5 * nut.ball_diameter);
        let method = requirement.preload.map(|_| requirement.method);
        let body = NutBody::usual(&nut, NutSet::of(method, requirement.nut_gap));
        let thread = nut.thread(0.0, nut.usual_lands());
        let phases = requirement.demand.phases(&requirement.carriage, &nut);
        let (screw, dynamic) = (nut.screw(&thread), nut.dynamic_rating().rating);
        let stroke = match requirement.travel {
            Travel::Screw(length) => length - body.length,
            Travel::Stroke(stroke) => stroke,
        };
        let shaft = requirement.mount.shaft(&screw, body.length, Some(stroke));
        let length = match requirement.travel {
            Travel::Screw(length) => length,
            Travel::Stroke(_) => shaft.map_or(f64::NAN, |shaft| shaft.length),
        };
        let mut axis = Axis {
            screw,
            shaft,
            phases,
            dynamic_rating: requirement.factors.dynamic_rating * dynamic,
            static_rating: requirement.factors.static_rating * nut.static_rating().rating,
            preload: None,
            driven: requirement.driven,
            compression: 0.0,
            reliability: requirement.reliability,
        };
        let force = |preload: PreloadSize| preload.force(axis.largest_load(), axis.dynamic_rating);
        axis.preload = requirement.preload.map(force);
        let phase = axis.heaviest_moving().unwrap_or(PhasePoint::REST);
        let (largest, speed) = (axis.largest_load(), phase.speed.abs());
        let balls = nut.balls_per_turn * nut.turns;
        // Q = F_a / (Z cosα sinβ)                                         (L2)
        let normal = axis.larger_nut_load() / (balls * lead.cos() * beta.sin());
        let hertz = nut.hertz().ok();
        let pressed = |number: &dyn Fn(&Hertz) -> f64| match &hertz {
            Some(both) => both.each_ref().map(number),
            None => [f64::NAN; 2],
        };
        let pressures = pressed(&|hertz| hertz.max_pressure(normal));
        let semi_axes = pressed(&|hertz| hertz.semi_axes(normal).0);
        let best = Optimum::of(direction, lead, friction);
        let mut checks = Vec::new();
        let mut add = |step, quantity, value, least, most| {
            checks.push(Check { step, quantity, value, least, most });
        };
        add(1, Quantity::LeadAngle, lead, None, None);
        let best = best.map_or(f64::NAN, |best| best.contact_angle);
        add(2, Quantity::BestContactAngle, best, None, None);
        let (low, high) = ranges.contact_angle;
        add(2, Quantity::ContactAngle, beta, Some(low), Some(high));
        add(3, Quantity::ScrewLength, length, None, None);
        // r_m ≥ l/60                                                      (L3)
        add(4, Quantity::RadiusOverLength, radius / length, ranges.slimmest, None);
        add(
            4,
            Quantity::PitchDiameter,
            nut.pitch_diameter,
            None,
            Some(requirement.largest_diameter),
        );
        // 0.07 ≤ r_b/r_m ≤ 0.2                                            (L4)
        let (low, high) = ranges.ball_over_radius;
        add(5, Quantity::BallOverRadius, ball / radius, low, high);
        let over_lead = Some(requirement.ball_over_lead);
        add(5, Quantity::BallOverLead, nut.ball_diameter / nut.pitch(), None, over_lead);
        // 0.95 ≤ r_b/r_2 ≤ 0.97,  r_2 = 2 f r_b                           (L5)
        let (low, high) = ranges.ball_over_groove;
        let in_groove = 0.5 / nut.conformity.0;
        add(6, Quantity::BallOverGroove, in_groove, low, high);
        add(6, Quantity::Conformity, nut.conformity.0, None, None);
        let most = requirement.largest_turns.filter(|_| requirement.fixed.turns.is_none());
        add(7, Quantity::Turns, nut.turns, None, most);
        add(7, Quantity::LargestLoad, largest, None, axis.yield_load());
        add(7, Quantity::NormalLoad, normal, None, None);
        // s = r_m tanα φ                                                  (L7)
        let per_radian = radius * lead.tan();
        add(8, Quantity::Lead, per_radian * TAU, None, None);
        add(8, Quantity::Stroke, stroke, None, None);
        add(8, Quantity::StrokeTurns, stroke / (per_radian * TAU), None, None);
        // v = r_m tanα W                                                  (L6)
        let advance = per_radian * speed;
        add(8, Quantity::Advance, advance, None, None);
        let number = axis.speed_number();
        let most = requirement
            .speed_number
            .unwrap_or_else(|| requirement.make.speed_number(nut.lead, thread.screw.land));
        add(8, Quantity::SpeedNumber, number, None, Some(most));
        let (ratio, fastest) = requirement.motor;
        add(8, Quantity::MotorSpeed, ratio * axis.fastest(), None, fastest);
        for (quantity, pressure) in
            [Quantity::NutPressure, Quantity::ScrewPressure].into_iter().zip(pressures)
        {
            add(9, quantity, pressure, None, Some(requirement.pressure));
        }
        // β + a/R ≤ θ                                                     (L9)
        let end = beta + semi_axes[0].max(semi_axes[1]) / thread.nut.radius;
        add(9, Quantity::EllipseEnd, end, None, Some(thread.nut.edge));
        let efficiency = efficiency.and_then(|of| of(&nut, &phase)).unwrap_or(f64::NAN);
        add(10, Quantity::Efficiency, efficiency, requirement.least_efficiency, None);
        // P_out = η P_in; F_a v is the power at the nut                   (L8)
        let at_nut = phase.load.abs() * advance;
        let (input, output) = match direction {
            Direction::RotaryToLinear => (at_nut / efficiency, at_nut),
            Direction::LinearToRotary => (at_nut, at_nut * efficiency),
        };
        add(10, Quantity::InputPower, input, None, requirement.largest_power);
        add(10, Quantity::OutputPower, output, None, None);
        for (quantity, value, least, most) in requirement.rules(&axis, dynamic) {
            add(11, quantity, value, least, most);
        }
        let longest = requirement.make.longest(requirement.grade, screw.outer);
        if let Some(shaft) = &axis.shaft {
            add(11, Quantity::UnsupportedLength, shaft.length, None, longest);
        }
        let inertia = axis
            .shaft
            .as_ref()
            .map_or(f64::NAN, |shaft| screw.mass_and_inertia(shaft.bore, shaft.length).1);
        add(11, Quantity::Inertia, inertia, None, None);
        add(
            11,
            Quantity::Mass,
            body.mass(&nut, &thread) + screw.mass_and_inertia(requirement.mount.bore.0, length).0,
            None,
            None,
        );
        Self { nut, phase, checks }
    }

    /// Returns true if all checks pass.
    pub fn is_feasible(&self) -> bool {
        self.checks.iter().all(Check::passes)
    }

    /// Returns the preload of the nut \[N\], if it has one.
    pub fn preload(&self) -> Option<f64> {
        Some(self.value(Quantity::Preload)).filter(|force| !force.is_nan())
    }

    /// Returns the value of a quantity of the design.
    pub fn value(&self, quantity: Quantity) -> f64 {
        let found = self.checks.iter().find(|check| check.quantity == quantity);
        found.map_or(f64::NAN, |check| check.value)
    }

    /// Returns the objective as a number of order one that is minimized.
    pub fn objective(&self, objective: Objective) -> f64 {
        match objective {
            Objective::Efficiency => 1.0 - self.value(Quantity::Efficiency),
            Objective::Capacity => {
                (self.value(Quantity::LargestLoad) / self.value(Quantity::DynamicRating)).ln()
            }
            Objective::Mass | Objective::Inertia | Objective::Power => {
                self.value(objective.quantity()).ln()
            }
        }
    }
}
