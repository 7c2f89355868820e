//! Motion of an axis: moves, ramps, phases of the duty cycle, and exact integrals over the phases.
//!
//! Theory: `docs/theory/18-axis.md`, equations (BB1) to (BB3).

use std::f64::consts::TAU;
use std::num::NonZeroUsize;

use bsm_newton::Bracket;
use gauss_quad::GaussLegendre;

use crate::drive::{DriveTrain, MachineTable};
use crate::life::{Duty, UNLOADING_RATIO};
use crate::phase_point::direction_of;

pub use crate::phase_point::PhasePoint;

/// Relative tolerance for the shortest duration of a move. It allows for rounding errors of decimal
/// inputs.
const ROUNDING: f64 = 1e-12;

/// Fraction of the largest speed of a phase below which friction is constant. The transition from
/// standstill is not modeled.
/// This constant also applies to loads: without a preload, friction is assumed to vary linearly
/// with the load for all loads below this fraction of the largest load of the phase.
const CREEP: f64 = 1e-3;

/// Number of Gauss nodes that represent a ramp if each friction calculation is expensive.
const SAMPLES: usize = 4;

/// Relative accuracy with which friction is interpolated over speed or load.
const ACCURACY: f64 = 1e-9;

/// Maximum number of intervals between the Chebyshev nodes for the interpolation of friction.
const MAX_INTERVALS: usize = 32;

/// Number of nodes of the Gauss rule, which is exact for polynomials up to degree 31.
const NODES: usize = 16;

/// Speed of a screw as the sum of a rotational speed and a feed speed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DutySpeed {
    /// Relative rotational speed between screw and nut \[rad/s\].
    rotation: f64,
    /// Velocity of the nut along the screw \[m/s\].
    feed: f64,
}

impl DutySpeed {
    /// Speed of a screw at standstill.
    pub const REST: Self = Self { rotation: 0.0, feed: 0.0 };

    /// Creates a speed from a relative rotational speed between screw and nut \[rad/s\].
    pub fn of_rotation(rotation: f64) -> Self {
        Self { rotation, feed: 0.0 }
    }

    /// Creates a speed from a velocity of the nut along the screw \[m/s\].
    pub fn of_feed(feed: f64) -> Self {
        Self { rotation: 0.0, feed }
    }

    /// Returns true if the rotational part is zero, so that the feed speed does not depend on the
    /// lead.
    pub fn has_only_feed(self) -> bool {
        self.rotation == 0.0
    }

    /// Returns the sum of this speed and a feed speed \[m/s\].
    #[must_use]
    pub fn plus_feed(self, feed: f64) -> Self {
        Self { feed: self.feed + feed, ..self }
    }

    /// Returns the relative rotational speed between screw and nut \[rad/s\] for a given lead
    /// \[m\].
    pub fn speed(self, lead: f64) -> f64 {
        // With zero feed, the lead has no effect and may be unknown.
        if self.feed == 0.0 { self.rotation } else { self.rotation + self.feed * TAU / lead }
    }
}

/// Top speed and durations of a move that starts and ends at standstill.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Move {
    /// Top speed \[m/s\].
    pub speed: f64,
    /// Durations of acceleration, constant speed and deceleration \[s\].
    pub times: [f64; 3],
}

impl Move {
    /// Creates a move in which acceleration, constant speed and deceleration take one third of the
    /// time each.
    ///
    /// * `distance`: travel of the move \[m\], positive.
    /// * `time`: duration of the move \[s\].
    pub fn trapezoidal(distance: f64, time: f64) -> Self {
        Self { speed: 1.5 * distance / time, times: [time / 3.0; 3] }
    }

    /// Creates a move that accelerates for half of the time and decelerates for the other half.
    ///
    /// * `distance`: travel of the move \[m\], positive.
    /// * `time`: duration of the move \[s\].
    pub fn triangular(distance: f64, time: f64) -> Self {
        Self { speed: 2.0 * distance / time, times: [0.5 * time, 0.0, 0.5 * time] }
    }

    /// Creates a move with a given duration \[s\] (BB1).
    ///
    /// ```math
    /// v = \frac{t - \sqrt{t^2 - 2cS}}{c}, \qquad c = \frac1a + \frac1d
    /// ```
    ///
    /// * `distance`: travel of the move \[m\], positive.
    /// * `ramps`: acceleration and deceleration \[m/s²\], positive.
    ///
    /// # Errors
    ///
    /// Returns the shortest possible duration \[s\] if `time` is shorter than this duration.
    pub fn in_time(distance: f64, time: f64, ramps: [f64; 2]) -> Result<Self, f64> {
        let c = ramps[0].recip() + ramps[1].recip();
        let least = (2.0 * c * distance).sqrt();
        if time < least * (1.0 - ROUNDING) {
            return Err(least);
        }
        let root = ((time - least) * (time + least)).max(0.0).sqrt();
        // v = 2 S/[t + √(t² − 2cS)], which avoids cancellation for small c (BB1)
        Ok(Self::with_top(2.0 * distance / (time + root), time, ramps))
    }

    /// Creates a move with a speed limit. If the distance is too short to reach the limit, the move
    /// is triangular.
    ///
    /// * `distance`: travel of the move \[m\], positive.
    /// * `limit`: upper limit of the speed \[m/s\].
    /// * `ramps`: acceleration and deceleration \[m/s²\], positive.
    pub fn up_to_speed(distance: f64, limit: f64, ramps: [f64; 2]) -> Self {
        let c = ramps[0].recip() + ramps[1].recip();
        // v = min(v_max, √(2S/c)),  t = S/v + v c/2                        (BB1)
        let speed = limit.min((2.0 * distance / c).sqrt());
        Self::with_top(speed, distance / speed + 0.5 * speed * c, ramps)
    }

    fn with_top(speed: f64, time: f64, ramps: [f64; 2]) -> Self {
        let [up, down] = ramps.map(|ramp| speed / ramp);
        let constant = time - up - down;
        let constant = if constant > ROUNDING * time { constant } else { 0.0 };
        Self { speed, times: [up, constant, down] }
    }
}

/// A segment of the machine's duty cycle: a linear ramp, motion at constant speed, or a standstill.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProfileSegment {
    /// Index of the corresponding entry in the duty cycle, from 0; `None` for a standstill that
    /// fills the rest of the cycle.
    pub entry: Option<usize>,
    /// Duration \[s\], or share of the cycle time.
    pub time: f64,
    /// Speeds at the start and at the end.
    pub speeds: [DutySpeed; 2],
    /// Process forces at the start and at the end \[N\], positive if they oppose a positive feed.
    /// In between, the force varies linearly with the travel.
    pub force: [f64; 2],
    /// Load factor used to calculate the life.
    pub load_factor: f64,
}

impl ProfileSegment {
    /// Creates a segment with constant speed and constant force \[N\].
    pub fn constant(time: f64, speed: DutySpeed, force: f64) -> Self {
        Self { entry: Some(0), time, speeds: [speed; 2], force: [force; 2], load_factor: 1.0 }
    }

    /// Returns the phases of the screw during this segment. A segment that passes through
    /// standstill is split into two phases at standstill.
    ///
    /// * `lead`: lead of the screw \[m\].
    fn phases(&self, table: &MachineTable, lead: f64) -> impl Iterator<Item = Phase> {
        let [start, end] = self.speeds.map(|speed| speed.speed(lead));
        let crosses = (start > 0.0 && end < 0.0) || (start < 0.0 && end > 0.0);
        let before = if crosses { start / (start - end) } else { 1.0 };
        let change = if self.speeds[0] == self.speeds[1] { 0.0 } else { end - start };
        // Without a change of speed, the lead has no effect and may be unknown.
        let acceleration = if change == 0.0 { 0.0 } else { change * lead / TAU / self.time };
        let phase = move |time: f64, speed: [f64; 2], force: [f64; 2]| {
            let direction = direction_of(speed);
            Phase {
                entry: self.entry,
                time,
                load: force.map(|force| table.load(force, direction, acceleration)),
                speed,
                acceleration,
                load_factor: self.load_factor,
            }
        };
        let [first, last] =
            if crosses { [[start, 0.0], [0.0, end]].map(Some) } else { [Some([start, end]), None] };
        let first = first.map(|speed| phase(before * self.time, speed, self.force));
        let last = last.map(|speed| phase((1.0 - before) * self.time, speed, self.force));
        [first, last].into_iter().flatten()
    }
}

/// Returns the phases of a screw during a duty cycle. Their durations are shares of the cycle time.
///
/// * `lead`: lead of the screw \[m\].
pub fn phases(segments: &[ProfileSegment], table: &MachineTable, lead: f64) -> Vec<Phase> {
    let time: f64 = segments.iter().map(|segment| segment.time).sum();
    let phases = segments.iter().flat_map(|segment| segment.phases(table, lead));
    phases.map(|phase| Phase { time: phase.time / time, ..phase }).collect()
}

/// A phase of the screw's duty cycle in which the direction of motion does not change: a linear
/// ramp, motion at constant speed, or a standstill. The load is constant or, at constant speed,
/// varies linearly with the travel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Phase {
    /// Index of the corresponding entry in the duty cycle, from 0; `None` for a standstill that
    /// fills the rest of the cycle.
    pub entry: Option<usize>,
    /// Duration as a share of the cycle time.
    pub time: f64,
    /// Axial loads on the screw at the start and at the end \[N\], positive if they oppose a
    /// positive feed.
    pub load: [f64; 2],
    /// Speeds of the screw relative to the nut at the start and at the end \[rad/s\].
    pub speed: [f64; 2],
    /// Acceleration in the direction of positive feed \[m/s²\].
    pub acceleration: f64,
    /// Load factor `$f_w$` for shocks and vibration, used only for life and equivalent load.
    pub load_factor: f64,
}

impl Phase {
    /// Returns the mean speed \[rad/s\], including its sign.
    pub fn mean_speed(&self) -> f64 {
        0.5 * (self.speed[0] + self.speed[1])
    }

    /// Returns the largest absolute speed \[rad/s\].
    pub fn fastest(&self) -> f64 {
        self.speed[0].abs().max(self.speed[1].abs())
    }

    /// Returns the direction of motion: 1, -1, or 0 at standstill.
    pub fn direction(&self) -> f64 {
        direction_of(self.speed)
    }

    /// Returns true if the screw rotates.
    pub fn moves(&self) -> bool {
        self.direction() != 0.0
    }

    /// Returns true if load and speed are constant.
    fn is_steady(&self) -> bool {
        self.has_constant_load() && self.has_constant_speed()
    }

    fn has_constant_load(&self) -> bool {
        self.load[0].total_cmp(&self.load[1]).is_eq()
    }

    fn has_constant_speed(&self) -> bool {
        self.speed[0].total_cmp(&self.speed[1]).is_eq()
    }

    /// Returns the operating point after a given share of the duration, from 0 to 1.
    fn at(&self, share: f64) -> PhasePoint {
        let between = |[start, end]: [f64; 2]| (1.0 - share) * start + share * end;
        let speed = between(self.speed);
        let friction_speed = self.direction() * speed.abs().max(CREEP * self.fastest());
        PhasePoint {
            load: between(self.load),
            speed,
            friction_speed,
            acceleration: self.acceleration,
            load_factor: self.load_factor,
        }
    }

    /// Returns the operating points at the start and at the end.
    pub fn ends(&self) -> [PhasePoint; 2] {
        [self.at(0.0), self.at(1.0)]
    }

    /// Returns the end point with the larger absolute load (see [`PhasePoint::heavier`]).
    pub fn heavier_end(&self) -> PhasePoint {
        let [start, end] = self.ends();
        start.heavier(end)
    }

    /// Returns loads, mean speeds and times that give the same life as the phase (BB2). A constant
    /// load gives a single item. A load that varies linearly with the travel gives the nodes of a
    /// Gauss rule on each interval between the loads at which a nut of a pair loses contact or the
    /// load changes sign.
    ///
    /// * `preload`: preload of a nut pair \[N\].
    pub fn duty(&self, preload: Option<f64>) -> Vec<Duty> {
        let [start, end] = self.load.map(|load| self.load_factor * load);
        let speed = self.mean_speed();
        if self.has_constant_load() || !self.moves() {
            return vec![Duty { load: start, speed, time: self.time }];
        }
        let opens = UNLOADING_RATIO * preload.unwrap_or(0.0);
        let share_of = |load: f64| (load - start) / (end - start);
        let parts = intervals(&[-opens, 0.0, opens].map(share_of));
        let nodes = parts.flat_map(gauss);
        nodes
            .map(|(share, weight)| Duty {
                load: start + share * (end - start),
                speed,
                time: weight * self.time,
            })
            .collect()
    }

    /// Returns operating points that represent the phase if each friction calculation is expensive,
    /// each with its share of the cycle time. A ramp gives the four nodes of a Gauss rule, and a
    /// steady phase gives a single point.
    pub fn samples(&self) -> Vec<(f64, PhasePoint)> {
        if self.is_steady() || !self.moves() {
            return vec![(self.time, self.at(0.0))];
        }
        rule(SAMPLES)
            .into_iter()
            .map(|(share, weight)| (weight * self.time, self.at(share)))
            .collect()
    }

    /// Returns time averages over the phase (BB3), or `None` if `friction` returns `None` for any
    /// point.
    ///
    /// Friction that depends on speed or load is interpolated between Chebyshev nodes with a
    /// relative accuracy of 1e-9. The resulting polynomials are integrated with a Gauss rule on
    /// each interval between sign changes of load and torque.
    ///
    /// * `preload`: preload of a nut pair \[N\].
    /// * `friction`: function that returns the friction torque opposing the motion, at the screw
    ///   \[N·m\].
    pub fn means(
        &self,
        drive: &DriveTrain,
        preload: Option<f64>,
        mut friction: impl FnMut(&PhasePoint) -> Option<f64>,
    ) -> Option<PhaseMeans> {
        if self.is_steady() || !self.moves() {
            let point = self.at(0.0);
            return Some(PhaseMeans::at(drive, &point, friction(&point)?));
        }
        let mut sum = PhaseMeans::default();
        for part in self.parts_of_friction(preload) {
            let curve = FrictionCurve::of(self, part, preload, &mut friction)?;
            let torques = |place: f64| {
                let (point, friction) = curve.at(self, place);
                [drive.coupling_torque(&point, friction), drive.motor_torque(&point, friction)]
            };
            for part in intervals_between(curve.ends, &changes_of_sign(curve.ends, torques)) {
                for (place, weight) in gauss(part) {
                    let (point, friction) = curve.at(self, place);
                    let weight = weight * curve.time_for_place(place);
                    sum = sum.plus(weight, PhaseMeans::at(drive, &point, friction));
                }
            }
        }
        Some(sum)
    }

    /// Divides the phase into parts within which friction is a smooth function. Each part is given
    /// by its start and its end, as fractions of the duration.
    fn parts_of_friction(&self, preload: Option<f64>) -> Vec<[f64; 2]> {
        let [start, end] = if self.has_constant_load() { self.speed } else { self.load };
        let most = start.abs().max(end.abs());
        let kinks = match preload.filter(|_| !self.has_constant_load()) {
            Some(preload) => [-UNLOADING_RATIO * preload, 0.0, UNLOADING_RATIO * preload],
            None => [-CREEP * most, 0.0, CREEP * most],
        };
        intervals(&kinks.map(|value| (value - start) / (end - start))).collect()
    }
}

/// Time averages over a phase.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PhaseMeans {
    /// Mean heat generation due to friction \[W\].
    pub heat: f64,
    /// Mean square of the motor torque \[N²·m²\].
    pub squared_torque: f64,
    /// Mean power that the motor returns to the drive \[W\].
    pub regenerated: f64,
}

impl PhaseMeans {
    /// Returns the heat generation, the squared motor torque and the regenerated power at an
    /// operating point.
    fn at(drive: &DriveTrain, point: &PhasePoint, friction: f64) -> Self {
        let torque = drive.motor_torque(point, friction);
        // Q̇ = T_f |Ω|,  T_rms² = mean T²,  E_reg/t = max(0, −s T) i_g |Ω|  (BB3)
        Self {
            heat: friction * point.speed.abs(),
            squared_torque: torque.powi(2),
            regenerated: (-torque * drive.gear_ratio * point.speed).max(0.0),
        }
    }

    fn plus(self, weight: f64, other: Self) -> Self {
        Self {
            heat: self.heat + weight * other.heat,
            squared_torque: self.squared_torque + weight * other.squared_torque,
            regenerated: self.regenerated + weight * other.regenerated,
        }
    }
}

/// Friction torque over a part of a phase as a polynomial of a coordinate. The coordinate is the
/// time, or the cube root of the varying speed or load. As a function of this root, the friction of
/// lubricant films and of Hertzian contacts is smooth.
struct FrictionCurve {
    /// Coordinates of both ends of this part of the phase.
    ends: [f64; 2],
    /// Speeds or loads at the start and at the end of the phase if the coordinate is their cube
    /// root. If `None`, the coordinate is the share of the duration.
    root_of: Option<[f64; 2]>,
    /// Coordinates of the Chebyshev nodes, each with the friction torque \[N·m\].
    nodes: Vec<(f64, f64)>,
}

impl FrictionCurve {
    /// Interpolates the friction torque over a part of a phase. Returns `None` if `friction`
    /// returns `None` for any point.
    ///
    /// * `part`: limits of the part, as shares of the duration of the phase.
    fn of(
        phase: &Phase,
        part: [f64; 2],
        preload: Option<f64>,
        friction: &mut impl FnMut(&PhasePoint) -> Option<f64>,
    ) -> Option<Self> {
        let by_speed = phase.has_constant_load();
        let range = if by_speed { phase.speed } else { phase.load };
        let most = range[0].abs().max(range[1].abs());
        let value = |share: f64| (1.0 - share) * range[0] + share * range[1];
        // Below the creep speed, friction is constant. Without a preload, friction varies linearly
        // with the load below the fraction `CREEP` of the largest load.
        let middle = value(0.5 * (part[0] + part[1])).abs();
        let is_small = middle < CREEP * most;
        let is_rooted = !is_small && (by_speed || preload.is_none());
        let root_of = is_rooted.then_some(range);
        let ends = if is_rooted { part.map(|share| value(share).cbrt()) } else { part };
        let mut curve = Self { ends, root_of, nodes: Vec::new() };
        let mut evaluate = |place: f64| {
            let point = phase.at(curve_share(root_of, place));
            if !is_small || by_speed || preload.is_some() {
                return friction(&point);
            }
            let floor = CREEP * most;
            let unloaded = friction(&PhasePoint { load: 0.0, ..point })?;
            let load = floor * value(0.5 * (part[0] + part[1])).signum();
            let at_floor = friction(&PhasePoint { load, ..point })?;
            Some(unloaded + point.load.abs() / floor * (at_floor - unloaded))
        };
        let mut intervals = 2;
        let place = |node: usize, of: usize| chebyshev(ends, node, of);
        for node in 0..=intervals {
            curve.nodes.push((place(node, intervals), evaluate(place(node, intervals))?));
        }
        loop {
            let largest = curve.nodes.iter().map(|(_, value)| value.abs()).fold(0.0, f64::max);
            let mut error: f64 = 0.0;
            let mut finer = Vec::with_capacity(2 * intervals + 1);
            for node in 0..=2 * intervals {
                if node % 2 == 0 {
                    finer.push(curve.nodes[node / 2]);
                } else {
                    let place = place(node, 2 * intervals);
                    let value = evaluate(place)?;
                    error = error.max((curve.value(place) - value).abs());
                    finer.push((place, value));
                }
            }
            curve.nodes = finer;
            intervals *= 2;
            if error <= ACCURACY * largest || intervals >= MAX_INTERVALS {
                return Some(curve);
            }
        }
    }

    /// Returns the friction torque \[N·m\] at a coordinate of the curve, calculated by barycentric
    /// interpolation.
    fn value(&self, place: f64) -> f64 {
        let (mut above, mut below) = (0.0, 0.0);
        let last = self.nodes.len() - 1;
        for (number, (node, value)) in self.nodes.iter().enumerate() {
            let distance = place - node;
            if distance == 0.0 {
                return *value;
            }
            let half = if number == 0 || number == last { 0.5 } else { 1.0 };
            let weight = half * if number % 2 == 0 { 1.0 } else { -1.0 } / distance;
            above += weight * value;
            below += weight;
        }
        above / below
    }

    /// Returns the operating point at a coordinate of the curve, and the friction torque at this
    /// point.
    fn at(&self, phase: &Phase, place: f64) -> (PhasePoint, f64) {
        (phase.at(curve_share(self.root_of, place)), self.value(place))
    }

    /// Returns the derivative of the share of the duration with respect to the coordinate.
    fn time_for_place(&self, place: f64) -> f64 {
        self.root_of.map_or(1.0, |[start, end]| 3.0 * place.powi(2) / (end - start)).abs()
    }
}

/// Converts a coordinate of a friction curve into a share of the duration of the phase.
fn curve_share(root_of: Option<[f64; 2]>, place: f64) -> f64 {
    root_of.map_or(place, |[start, end]| (place.powi(3) - start) / (end - start))
}

/// Returns the coordinate of a Chebyshev node on an interval. The nodes are the extrema of the
/// Chebyshev polynomial of the given degree.
#[expect(clippy::cast_precision_loss, reason = "a few nodes")]
fn chebyshev([start, end]: [f64; 2], node: usize, degree: usize) -> f64 {
    let cosine = (0.5 * TAU * node as f64 / degree as f64).cos();
    0.5 * ((1.0 + cosine) * start + (1.0 - cosine) * end)
}

/// Returns the coordinates inside an interval at which one of the quantities changes sign.
fn changes_of_sign<const N: usize>(ends: [f64; 2], of: impl Fn(f64) -> [f64; N]) -> Vec<f64> {
    /// Number of subintervals that are searched for a sign change.
    const PARTS: u32 = 16;
    let place = |part: u32| {
        let share = f64::from(part) / f64::from(PARTS);
        (1.0 - share) * ends[0] + share * ends[1]
    };
    let mut found = Vec::new();
    for part in 0..PARTS {
        let ends = [place(part), place(part + 1)];
        let values = ends.map(&of);
        for number in 0..N {
            let values = values.map(|values| values[number]);
            // A sign test on the product of the two values would miss a root at which one value is
            // exactly zero.
            if (values[0] < 0.0) != (values[1] < 0.0) {
                let bracket = Bracket::new(ends, values);
                let root = bracket.root(|place| of(place)[number]);
                found.extend(root.root().map(|root| root.x));
            }
        }
    }
    found
}

/// Returns the intervals into which the break points divide [0, 1]. Break points outside [0, 1] are
/// ignored.
fn intervals(breaks: &[f64]) -> impl Iterator<Item = [f64; 2]> + use<> {
    intervals_between([0.0, 1.0], breaks)
}

/// Returns the intervals into which the break points divide the range between two ends. Break
/// points outside the range are ignored.
fn intervals_between(ends: [f64; 2], breaks: &[f64]) -> impl Iterator<Item = [f64; 2]> + use<> {
    let [low, high] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
    let inside = breaks.iter().copied().filter(|at| low < *at && *at < high);
    let mut all: Vec<_> = inside.chain([low, high]).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    (1..all.len()).map(move |end| [all[end - 1], all[end]])
}

/// Returns the nodes and weights of the Gauss rule on an interval.
fn gauss([start, end]: [f64; 2]) -> impl Iterator<Item = (f64, f64)> {
    let nodes = rule(NODES).into_iter();
    nodes.map(move |(share, weight)| (start + share * (end - start), weight * (end - start)))
}

/// Returns nodes and weights of the Gauss-Legendre rule on [0, 1].
fn rule(nodes: usize) -> Vec<(f64, f64)> {
    let rule = GaussLegendre::new(NonZeroUsize::new(nodes).unwrap_or(NonZeroUsize::MIN));
    rule.iter().map(|(place, weight)| (0.5 * (place + 1.0), 0.5 * weight)).collect()
}

/// Travel of a duty cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CycleTravel {
    /// Total distance in both directions \[m\].
    pub distance: f64,
    /// Distance between the two extreme positions \[m\].
    pub range: f64,
    /// Signed distance from the start position to the end position of the cycle \[m\].
    pub end: f64,
}

impl CycleTravel {
    /// Calculates the travel of a duty cycle.
    ///
    /// * `advance`: travel per radian of screw rotation \[m\].
    /// * `time`: cycle time \[s\].
    pub fn of(phases: &[Phase], advance: f64, time: f64) -> Self {
        let (mut distance, mut low, mut high, mut at) = (0.0, 0.0_f64, 0.0_f64, 0.0);
        for phase in phases {
            let step = phase.mean_speed() * advance * (phase.time * time);
            distance += step.abs();
            at += step;
            low = low.min(at);
            high = high.max(at);
        }
        Self { distance, range: high - low, end: at }
    }
}

/// Returns all pairs of consecutive phases between which the speed jumps. The last phase is
/// followed by the first phase.
///
/// Speed jumps of less than one part in ten thousand of the largest speed are ignored, because they
/// result from rounded times and accelerations.
pub fn speed_jumps(phases: &[Phase]) -> Vec<[Phase; 2]> {
    /// Minimum speed jump, divided by the largest speed (dimensionless).
    const MIN_JUMP: f64 = 1e-4;
    let fastest = phases.iter().map(Phase::fastest).fold(0.0, f64::max);
    let next = phases.iter().cycle().skip(1);
    let pairs = phases.iter().zip(next).map(|(one, next)| [*one, *next]);
    let jumps =
        |[one, next]: &[Phase; 2]| (one.speed[1] - next.speed[0]).abs() > MIN_JUMP * fastest;
    pairs.filter(jumps).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use approx::assert_relative_eq;

    use super::*;

    fn drive() -> DriveTrain {
        DriveTrain {
            lead: 10e-3,
            driven_inertia: 0.0,
            mass: 0.0,
            gear_ratio: 1.0,
            gear_efficiency: 1.0,
            motor_inertia: 0.0,
            gear_inertia: 0.0,
            screws: 1.0,
            brake_at_rest: false,
        }
    }

    fn ramp(speed: [f64; 2], load: [f64; 2]) -> Phase {
        Phase { entry: Some(0), time: 1.0, load, speed, acceleration: 0.0, load_factor: 1.0 }
    }

    /// Hand calculation: with ramps of 1.2 and 2 m/s², c = 1/1.2 + 1/2 = 4/3 s²/m. A move of 0.3 m
    /// in 1.5 s then has a top speed of v = (1.5 − √1.45)/(4/3) m/s. The shortest duration is √0.8
    /// s, for which the move is triangular.
    #[test]
    fn the_top_speed_of_a_move_follows_from_its_time() {
        let found = Move::in_time(0.3, 1.5, [1.2, 2.0]).expect("long enough");
        let speed = (1.5 - 1.45_f64.sqrt()) * 0.75;
        assert_relative_eq!(found.speed, speed, max_relative = 1e-13);
        let [up, constant, down] = found.times;
        let distance = speed * (0.5 * (up + down) + constant);
        assert_relative_eq!(distance, 0.3, max_relative = 1e-13);
        let least = Move::in_time(0.3, 0.8, [1.2, 2.0]).expect_err("too short");
        assert_relative_eq!(least, 0.8_f64.sqrt(), max_relative = 1e-14);
        let shortest = Move::in_time(0.3, least, [1.2, 2.0]).expect("just long enough");
        assert_eq!(shortest.times[1].to_bits(), 0.0_f64.to_bits());
        let limited = Move::up_to_speed(0.3, speed, [1.2, 2.0]);
        assert_relative_eq!(limited.times.iter().sum::<f64>(), 1.5, max_relative = 1e-13);
    }

    /// Hand calculation: during a ramp from standstill to 100 rad/s, a constant friction torque of
    /// 2 N m generates a mean heat of 200/2 W, and the mean squared torque is 4 N² m². If friction
    /// is proportional to Ω^(2/3), the mean heat is 2·100·100^(2/3)/(8/3) W.
    #[test]
    fn time_averages_over_ramps_are_exact() {
        let phase = ramp([0.0, 100.0], [0.0; 2]);
        let constant = phase.means(&drive(), None, |_| Some(2.0)).expect("friction");
        assert_relative_eq!(constant.heat, 100.0, max_relative = 1e-13);
        assert_relative_eq!(constant.squared_torque, 4.0, max_relative = 1e-13);
        let film = |point: &PhasePoint| Some(point.friction_speed.abs().powf(2.0 / 3.0));
        let found = phase.means(&drive(), None, film).expect("friction");
        let by_hand = 100.0_f64.powf(5.0 / 3.0) * 3.0 / 8.0;
        // Below one thousandth of the largest speed, friction is constant. The resulting relative
        // error of the heat is at most 1e-6 · (1e-3)^(2/3) = 1e-8.
        assert_relative_eq!(found.heat, by_hand, max_relative = 1e-7);
    }

    /// Hand calculation for a load from -1 to 3 kN at constant speed, with a lead of 10 mm and a
    /// friction torque of 0.1 |F| h, where h is the travel per radian. The motor returns power
    /// while the load drives, which is one quarter of the time. During this quarter, the mean power
    /// is 0.9 h 500 N Ω.
    #[test]
    fn motor_regenerates_while_the_load_back_drives_the_screw() {
        let phase = ramp([50.0; 2], [-1e3, 3e3]);
        let advance = 10e-3 / TAU;
        let friction = |point: &PhasePoint| Some(0.1 * advance * point.load.abs());
        let found = phase.means(&drive(), None, friction).expect("friction");
        let by_hand = 0.25 * 0.9 * 500.0 * advance * 50.0;
        assert_relative_eq!(found.regenerated, by_hand, max_relative = 1e-12);
        // The mean heat output is 0.1 h Ω (0.25·500 + 0.75·1500) N, where h is the travel per
        // radian.
        assert_relative_eq!(found.heat, 0.1 * advance * 50.0 * 1250.0, max_relative = 1e-12);
        let squares = 0.25 * (0.9 * 1e3_f64).powi(2) / 3.0 + 0.75 * (1.1 * 3e3_f64).powi(2) / 3.0;
        assert_relative_eq!(found.squared_torque, squares * advance.powi(2), max_relative = 1e-12);
    }

    /// Hand calculation: for a load from -1 to 3 kN, a friction torque of 0.1 |F| h + 0.3 N m has a
    /// mean of 0.1 h 1250 N + 0.3 N m, where h is the travel per radian. The constant drag remains
    /// when the load is zero.
    #[test]
    fn constant_drag_remains_when_the_load_changes_sign() {
        let phase = ramp([50.0; 2], [-1e3, 3e3]);
        let advance = 10e-3 / TAU;
        let friction = |point: &PhasePoint| Some(0.1 * advance * point.load.abs() + 0.3);
        let found = phase.means(&drive(), None, friction).expect("friction");
        assert_relative_eq!(
            found.heat,
            50.0 * (0.1 * advance * 1250.0 + 0.3),
            max_relative = 1e-12
        );
    }

    /// The search divides the range into 16 parts, so a root in the middle of the range coincides
    /// with an evaluated point.
    #[test]
    fn sign_change_at_an_evaluated_point_is_found() {
        for ends in [[-1.0, 1.0], [1.0, -1.0]] {
            for sign in [1.0, -1.0] {
                assert_eq!(changes_of_sign(ends, |place| [sign * place]), [0.0]);
            }
        }
    }

    /// Hand calculation: for a load from 0 to 20 kN, the mean of the cubed load is 20³/4. For a
    /// load from F₀ to F₁, it is (F₀ + F₁)(F₀² + F₁²)/4.
    #[test]
    fn equivalent_loads_reproduce_the_mean_cube_of_a_load_that_changes_linearly() {
        for load in [[0.0, 20e3], [3e3, 8e3], [-2e3, 5e3]] {
            let phase = ramp([10.0; 2], load);
            let duty = phase.duty(None);
            let cubes: f64 = duty.iter().map(|d| d.load.powi(3) * d.time).sum();
            let [from, to] = load;
            let by_hand = 0.25 * (from + to) * (from * from + to * to);
            assert_relative_eq!(cubes, by_hand, max_relative = 1e-12);
        }
        assert_eq!(ramp([0.0, 8.0], [3e3; 2]).duty(Some(1e3)).len(), 1);
    }

    /// A ramp through standstill becomes two phases, because guide friction changes sign. The hand
    /// calculation is for a ramp from 12 to -12 m/min in 0.4 s.
    #[test]
    fn speed_ramps_are_split_where_the_speed_is_zero() {
        let table = MachineTable { mass: 400.0, friction: 0.01, ..MachineTable::NONE };
        let feeds = [0.2, -0.2].map(DutySpeed::of_feed);
        let turned =
            ProfileSegment { speeds: feeds, ..ProfileSegment::constant(0.4, feeds[0], 800.0) };
        let found = phases(&[turned], &table, 10e-3);
        assert_eq!(found.len(), 2);
        let guides = 0.01 * 400.0 * 9.806_65;
        for (phase, sign) in found.iter().zip([1.0, -1.0]) {
            assert_relative_eq!(phase.time, 0.5, max_relative = 1e-14);
            assert_relative_eq!(phase.acceleration, -1.0, max_relative = 1e-14);
            assert_relative_eq!(phase.load[0], 800.0 - 400.0 + sign * guides, max_relative = 1e-14);
        }
        let travel = CycleTravel::of(&found, 10e-3 / TAU, 0.4);
        assert_relative_eq!(travel.range, 0.02, max_relative = 1e-13);
        assert!(travel.end.abs() < 1e-15, "{travel:?}");
        assert_eq!(speed_jumps(&found).len(), 1);
        assert_relative_eq!(found[0].speed[0], 40.0 * PI, max_relative = 1e-14);
    }
}
