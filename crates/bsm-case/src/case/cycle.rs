//! Conversion of the duty cycle of a case to ramps, constant speeds and standstills in SI units.

use bsm_design::drive::MachineTable;
use bsm_design::motion::{CycleTravel, DutySpeed, Move, ProfileSegment, phases};

use crate::vocabulary::entries::Named;
use crate::vocabulary::error::invalid_input;
use crate::vocabulary::number::format_trimmed;
use crate::vocabulary::phase::MoveProfile;
use crate::vocabulary::units::{MM, RPM};
use crate::{Case, CaseError, InputKey, InputSet, PhaseEntry};

/// Largest accepted deviation of the sum of all time shares from 1 or 100. It allows for rounding
/// errors of the inputs.
const SHARE_ROUNDING: f64 = 0.01;

/// Largest speed ratio of the slower end to the faster end of a ramp for which the slower end is
/// treated as standstill. A tolerance is needed because times and accelerations are usually given
/// with only two or three digits.
const STANDSTILL: f64 = 0.01;

/// The duty cycle of an axis, or its single operating point.
#[derive(Debug, Clone)]
pub(crate) struct Cycle {
    /// Segments in chronological order.
    pub(crate) segments: Vec<ProfileSegment>,
    /// Duration of the cycle \[s\]; `None` for time shares and for a single operating point.
    pub(crate) time: Option<f64>,
    /// Process force that acts at standstill \[N\]. It is positive if it acts against a positive
    /// feed.
    pub(crate) rest_force: f64,
    /// Notes on assumptions about the cycle.
    pub(crate) notes: Vec<String>,
}

/// Speed of a screw whose speed is not given \[rad/s\]. It determines only the direction of motion,
/// because results that depend on the speed are then omitted (see [`Case::has_speed`]).
const UNKNOWN_SPEED: f64 = RPM;

impl Case {
    /// Returns true if the case contains a speed, a feed or a cycle.
    pub(crate) fn has_speed(&self) -> bool {
        self.entries.cycle.is_some()
            || self.feed_m_min.is_some()
            || self.nut_speed_rpm.is_some()
            || self.speeds_rpm().is_some()
    }
}

impl Cycle {
    /// Converts the duty cycle of a case. If the case has no cycle, converts its operating point. If
    /// no speed is given, the screw moves slowly forward ([`UNKNOWN_SPEED`]).
    pub(crate) fn of(case: &Case) -> Result<Self, CaseError> {
        let load_factor = case.number(InputKey::load_factor);
        let Some(entries) = &case.entries.cycle else {
            if case.cycles_per_hour.is_some() {
                return Err(invalid_input("cycles_per_hour", cycle_to_give(case)));
            }
            let speed = match (case.feed_m_min, case.speeds_rpm()) {
                (Some(feed), _) if case.nut_speed_rpm.is_none() => {
                    Some(DutySpeed::of_feed(feed / 60.0))
                }
                // If no screw speed is given, the screw is assumed to be at rest.
                (_, None) => case.nut_speed_rpm.map(|nut| DutySpeed::of_rotation(-nut * RPM)),
                (_, speeds) => {
                    speeds.map(|(screw, nut)| DutySpeed::of_rotation((screw - nut) * RPM))
                }
            };
            let force = case.axial_load_N.unwrap_or(0.0);
            let speed = speed.unwrap_or_else(|| DutySpeed::of_rotation(UNKNOWN_SPEED));
            let point = ProfileSegment::constant(1.0, speed, force);
            let segments = vec![ProfileSegment { load_factor, ..point }];
            let rest_force = case.hold_force_N.unwrap_or(0.0);
            return Ok(Self { segments, time: None, rest_force, notes: Vec::new() });
        };
        if entries.is_empty() {
            return Err(invalid_input("cycle", "needs at least one entry"));
        }
        let with_share = entries.iter().filter(|entry| entry.share.is_some()).count();
        if with_share > 0 && with_share < entries.len() {
            return Err(invalid_input(
                "cycle",
                "has entries with `share` and entries with `time_s`; use the same key in all entries",
            ));
        }
        let mut notes = Vec::new();
        let rest_force = rest_force(case, entries, &mut notes);
        let mut segments = Vec::new();
        for (place, entry) in entries.iter().enumerate() {
            let standstill = if entry.dwell_s.is_some() { case.hold_force_N } else { None };
            let force = entry.force_N.or(standstill).unwrap_or(0.0);
            let of_entry = SegmentBuilder {
                place,
                force: [force, entry.end_force_N.unwrap_or(force)],
                load_factor: entry.load_factor.unwrap_or(load_factor),
            };
            segments.extend(of_entry.segments(case, entry, &mut notes)?);
        }
        let sum: f64 = segments.iter().map(|segment| segment.time).sum();
        if !sum.is_finite() {
            return Err(invalid_input(
                "cycle",
                "has times whose sum is too large; give shorter times",
            ));
        }
        let rest = |time: f64| {
            let still = ProfileSegment::constant(time, DutySpeed::REST, rest_force);
            ProfileSegment { entry: None, load_factor, ..still }
        };
        if with_share > 0 {
            if case.cycles_per_hour.is_some() {
                return Err(invalid_input(
                    "cycles_per_hour",
                    "needs a cycle with times instead of shares",
                ));
            }
            if sum < 1.0 - SHARE_ROUNDING {
                segments.push(rest(1.0 - sum));
                notes.push(format!(
                    "The shares of the cycle sum to {}. The axis is at standstill for the remaining share of {}.",
                    format_trimmed(sum),
                    format_trimmed(1.0 - sum)
                ));
            } else if (sum - 100.0).abs() <= 100.0 * SHARE_ROUNDING {
                notes.push("The shares of the cycle are percentages.".to_owned());
            } else if sum > 1.0 + SHARE_ROUNDING {
                let what = format!(
                    "has shares that sum to {}, but the sum must be at most 1, or 100 for percentages",
                    format_trimmed(sum)
                );
                return Err(invalid_input("cycle", what));
            }
            return Ok(Self { segments, time: None, rest_force, notes });
        }
        let Some(cycles) = case.cycles_per_hour else {
            return Ok(Self { segments, time: Some(sum), rest_force, notes });
        };
        let time = 3600.0 / cycles;
        // The duration of the cycle may exceed the available time by one millionth, because the
        // inputs are rounded.
        if time < sum * (1.0 - 1e-6) {
            let what = format!(
                "is {}, but the cycle takes {} s, so at most {} cycles per hour are possible",
                format_trimmed(cycles),
                format_trimmed(sum),
                format_trimmed(3600.0 / sum)
            );
            return Err(invalid_input("cycles_per_hour", what));
        }
        if time > sum {
            segments.push(rest(time - sum));
        }
        Ok(Self { segments, time: Some(time.max(sum)), rest_force, notes })
    }

    /// Returns true if all speeds of the cycle are given as feed rates.
    pub(crate) fn has_only_feeds(&self) -> bool {
        self.segments.iter().flat_map(|segment| segment.speeds).all(DutySpeed::has_only_feed)
    }

    /// Returns the travel of the cycle, or `None` if the cycle has no durations.
    ///
    /// * `lead`: lead \[m\].
    pub(crate) fn travel(&self, lead: f64) -> Option<CycleTravel> {
        let phases = phases(&self.segments, &MachineTable::NONE, lead);
        Some(CycleTravel::of(&phases, lead / std::f64::consts::TAU, self.time?))
    }
}

impl Case {
    /// Returns a warning about a given load or speed that has no effect on the axis, because the
    /// loads and speeds of all phases are given in its cycle.
    pub(crate) fn unused_with_cycle(&self) -> Option<String> {
        self.entries.cycle.as_ref()?;
        let unused = self.given().iter().filter(|key| InputSet::LOAD_AND_SPEED.contains(*key));
        let names: Vec<_> = unused.map(InputKey::name).collect();
        (!names.is_empty()).then(|| {
            format!(
                "These inputs have no effect beside a cycle: {}. Give force_N and feed_m_min (or screw_speed_rpm) in the entries of the cycle.",
                names.join(", ")
            )
        })
    }
}

/// Asks for a cycle. If the case contains a stroke and a feed, the text contains the cycle of a
/// motion back and forth over the stroke.
fn cycle_to_give(case: &Case) -> String {
    let (Some(stroke), Some(feed)) = (case.stroke_mm, case.feed_m_min) else {
        return "needs a cycle".to_owned();
    };
    let entry = |feed: f64| {
        let force = case.axial_load_N.filter(|force| *force != 0.0);
        let force = force
            .map_or_else(String::new, |force| format!(r#", "force_N": {}"#, format_trimmed(force)));
        let time = format_trimmed(60.0 * stroke * MM / feed.abs());
        format!(r#"{{"time_s": {time}, "feed_m_min": {}{force}}}"#, format_trimmed(feed))
    };
    format!(
        r#"needs a cycle. For a motion back and forth over the stroke, replace load and speed by "cycle": [{}, {}]"#,
        entry(feed),
        entry(-feed)
    )
}

/// Returns the process force at standstill: `hold_force_N` or, if it is not given, the process
/// force of the cycle entries, provided that all entries have the same process force.
fn rest_force(case: &Case, entries: &[PhaseEntry], notes: &mut Vec<String>) -> f64 {
    if let Some(force) = case.hold_force_N {
        return force;
    }
    let force = entries[0].force_N.unwrap_or(0.0);
    let same = |entry: &PhaseEntry| {
        let ends = [entry.force_N.unwrap_or(0.0), entry.end_force_N.unwrap_or(force)];
        ends.into_iter().all(|end| end.total_cmp(&force).is_eq())
    };
    if force == 0.0 || !entries.iter().all(same) {
        return 0.0;
    }
    notes.push(format!(
        "The process force of {} N is the same in all entries of the cycle, so it also acts at rest. To change this, give hold_force_N.",
        format_trimmed(force)
    ));
    force
}

/// Creates the segments of a cycle entry.
struct SegmentBuilder {
    /// Index of the entry, starting at 0.
    place: usize,
    force: [f64; 2],
    load_factor: f64,
}

impl SegmentBuilder {
    fn segment(&self, time: f64, speeds: [DutySpeed; 2]) -> ProfileSegment {
        let Self { place, force, load_factor } = *self;
        ProfileSegment { entry: Some(place), time, speeds, force, load_factor }
    }

    /// Returns an error message about the entry.
    fn error(&self, what: impl Into<String>) -> CaseError {
        let what: String = what.into();
        CaseError::of_value(&format!("cycle[{}]", self.place), &what)
    }

    fn segments(
        &self,
        case: &Case,
        entry: &PhaseEntry,
        notes: &mut Vec<String>,
    ) -> Result<Vec<ProfileSegment>, CaseError> {
        if let Some(time) = entry.dwell_s {
            return Ok(vec![self.segment(time, [DutySpeed::REST; 2])]);
        }
        if let Some(distance) = entry.distance_mm {
            return self.of_move(entry, distance * MM);
        }
        let time = entry.time_s.or(entry.share).unwrap_or(f64::NAN);
        if entry.start_feed_m_min.or(entry.end_feed_m_min).is_some() {
            let feeds = [entry.start_feed_m_min, entry.end_feed_m_min];
            let speeds = feeds.map(|feed| DutySpeed::of_feed(feed.unwrap_or(0.0) / 60.0));
            return Ok(vec![self.segment(time, speeds)]);
        }
        let speed = match entry.screw_speed_rpm {
            Some(rpm) => DutySpeed::of_rotation(rpm * RPM),
            None => DutySpeed::of_feed(entry.feed_m_min.unwrap_or(0.0) / 60.0),
        };
        match entry.acceleration_m_s2.filter(|acceleration| *acceleration != 0.0) {
            None => Ok(vec![self.segment(time, [speed; 2])]),
            Some(acceleration) => {
                let speeds = self.ramp(case, speed, acceleration * time, notes)?;
                Ok(vec![self.segment(time, speeds)])
            }
        }
    }

    /// Returns the segments of a move: acceleration, constant speed and deceleration.
    fn of_move(&self, entry: &PhaseEntry, distance: f64) -> Result<Vec<ProfileSegment>, CaseError> {
        let size = distance.abs();
        let acceleration = entry.acceleration_m_s2.unwrap_or(f64::NAN);
        let ramps = [acceleration, entry.deceleration_m_s2.unwrap_or(acceleration)];
        let found = match (entry.time_s, entry.profile) {
            (Some(time), Some(Named(MoveProfile::Trapezoidal))) => Move::trapezoidal(size, time),
            (Some(time), Some(Named(MoveProfile::Triangular))) => Move::triangular(size, time),
            (Some(time), None) => Move::in_time(size, time, ramps).map_err(|least| {
                self.error(format!(
                    "takes at least {} s for {} mm with these accelerations, but time_s is {}",
                    format_trimmed(least),
                    format_trimmed(size / MM),
                    format_trimmed(time)
                ))
            })?,
            (None, _) => {
                let limit = entry.max_feed_m_min.unwrap_or(f64::NAN) / 60.0;
                Move::up_to_speed(size, limit, ramps)
            }
        };
        let top = DutySpeed::of_feed(distance.signum() * found.speed);
        let rest = DutySpeed::REST;
        let parts = found.times.into_iter().zip([[rest, top], [top, top], [top, rest]]);
        let parts = parts.filter(|(time, _)| *time > 0.0);
        Ok(parts.map(|(time, speeds)| self.segment(time, speeds)).collect())
    }

    /// Returns the speeds at the start and the end of a phase with acceleration. The speed in the
    /// cycle entry is the end speed if the axis accelerates, and the start speed if it decelerates.
    ///
    /// * `change`: change of the feed rate over the phase \[m/s\].
    fn ramp(
        &self,
        case: &Case,
        speed: DutySpeed,
        change: f64,
        notes: &mut Vec<String>,
    ) -> Result<[DutySpeed; 2], CaseError> {
        // Without a lead, a speed in rpm cannot be converted to a feed rate, but the sign of the
        // feed rate is known.
        let lead = case.lead().map_or(std::f64::consts::TAU, |lead| lead * MM);
        let is_known = case.lead().is_some() || speed.has_only_feed();
        if speed.speed(lead) == 0.0 {
            return Ok([speed, speed.plus_feed(change)]);
        }
        let speeds_up = speed.speed(lead) * change > 0.0;
        let other = speed.plus_feed(if speeds_up { -change } else { change });
        let ratio = other.speed(lead) / speed.speed(lead);
        if is_known && ratio < -STANDSTILL {
            return Err(self.error(
                "passes through standstill with this acceleration_m_s2 and time_s: give start_feed_m_min and end_feed_m_min",
            ));
        }
        let is_rest = is_known && ratio.abs() <= STANDSTILL;
        let other = if is_rest { DutySpeed::REST } else { other };
        let ends = if speeds_up { [other, speed] } else { [speed, other] };
        if is_known {
            let [start, end] = ends
                .map(|end| format_trimmed(end.speed(lead) * lead / std::f64::consts::TAU * 60.0));
            notes.push(format!(
                "Entry {} of the cycle has an acceleration, so it is a ramp from {start} to {end} m/min.",
                self.place + 1
            ));
        }
        Ok(ends)
    }
}
