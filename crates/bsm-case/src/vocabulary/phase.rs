//! Duty cycle of an axis, which consists of moves, phases and dwells. It is read from JSON or from
//! a table.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::Rule::{Above, Any, Within};
use crate::vocabulary::cells::{Cells, NamedColumn};
use crate::vocabulary::entries::Named;
use crate::vocabulary::names::GivenNames;
use crate::vocabulary::quantity::keys;
use crate::vocabulary::units::{UnitChange, convert};
use crate::{CaseError, TableFormat, nearest};

/// Speed profile of a move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MoveProfile {
    /// Acceleration, constant speed and deceleration each take one third of the time.
    Trapezoidal,
    /// Acceleration and deceleration each take half of the time.
    Triangular,
}

macro_rules! phase {
    ($($name:ident [$unit:literal $($symbol:literal)?] $rule:expr, $default:expr, $about:literal;)*) => {
        keys! {
            /// Keys of a cycle entry with numeric values.
            pub(crate) PHASE_INPUTS;
            $($name [$unit $($symbol)?] $rule, $default, $about;)*
        }

        /// An entry of a cycle: a phase, a move or a dwell.
        #[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[schemars(!try_from, deny_unknown_fields)]
        #[serde(try_from = "Map<String, Value>")]
        #[expect(non_snake_case, reason = "the names end with units, and some unit symbols are capital letters")]
        pub struct PhaseEntry {
            $(
                #[doc = $about]
                #[serde(skip_serializing_if = "Option::is_none")]
                pub $name: Option<f64>,
            )*
            /// speed profile of a move with time_s: trapezoidal, with a third of the time each for
            /// acceleration, constant speed and deceleration; or triangular
            #[serde(skip_serializing_if = "Option::is_none")]
            pub profile: Option<Named<MoveProfile>>,
        }

        impl Default for PhaseEntry {
            fn default() -> Self {
                Self { $($name: $default,)* profile: None }
            }
        }

        impl PhaseEntry {
            /// Returns the keys that the cycle entry contains.
            fn given(&self) -> impl Iterator<Item = &'static str> {
                let profile = self.profile.map(|_| PROFILE);
                let all = [$(self.$name.map(|_| stringify!($name)),)* profile];
                all.into_iter().flatten()
            }

            /// Returns true if the entry is a phase with an acceleration but without a speed, so that
            /// it starts at rest.
            pub(crate) fn starts_at_rest(&self) -> bool {
                let speeds = [
                    self.feed_m_min,
                    self.start_feed_m_min,
                    self.end_feed_m_min,
                    self.screw_speed_rpm,
                    self.distance_mm,
                ];
                self.acceleration_m_s2.is_some() && speeds.iter().all(Option::is_none)
            }

            fn set(&mut self, key: &str, value: f64) {
                match key {
                    $(stringify!($name) => self.$name = Some(value),)*
                    _ => {}
                }
            }
        }
    };
}

phase! {
    time_s ["s" "t"] Above(0.0), None, "time of a move or a phase";
    share [""] Above(0.0), None, "share of the cycle time; replaces time_s. If the sum of all shares is below 1, the rest is standstill. A sum of 100 means percentages";
    distance_mm ["mm" "S"] Any, None, "signed distance of a move that starts and ends at standstill";
    max_feed_m_min ["m/min"] Above(0.0), None, "highest speed of a move; replaces time_s";
    deceleration_m_s2 ["m/s2" "d"] Above(0.0), None, "deceleration of a move; defaults to acceleration_m_s2";
    dwell_s ["s"] Above(0.0), None, "time of a standstill";
    force_N ["N" "F"] Any, None, "process force, positive if it opposes a positive feed; defaults to 0, or to hold_force_N at standstill";
    end_force_N ["N"] Any, None, "process force at the end of a phase with constant speed; the force changes linearly along the travel. Defaults to force_N";
    feed_m_min ["m/min" "v"] Any, None, "velocity of the nut along the screw; defaults to 0";
    start_feed_m_min ["m/min"] Any, None, "feed at the start of a ramp; defaults to 0";
    end_feed_m_min ["m/min"] Any, None, "feed at the end of a ramp; defaults to 0";
    screw_speed_rpm ["rpm" "n"] Any, None, "speed of the screw; replaces feed_m_min";
    acceleration_m_s2 ["m/s2" "a"] Any, None, "acceleration of a move or of a ramp; in a phase, the acceleration in the direction of positive feed. feed_m_min is the end speed of an accelerating ramp and the start speed of a decelerating ramp";
    load_factor ["" "f_w"] Within(1.0, 5.0), None, "factor on the load for life and equivalent load; defaults to load_factor of the case";
}

/// Key for the speed profile of a move.
const PROFILE: &str = "profile";

/// A kind of cycle entry, with its permitted keys.
struct EntryKind {
    name: &'static str,
    keys: &'static [&'static str],
}

/// A move over a distance, which starts and ends at standstill.
const MOVE: EntryKind = EntryKind {
    name: "a move (distance_mm)",
    keys: &[
        "distance_mm",
        "time_s",
        "max_feed_m_min",
        PROFILE,
        "acceleration_m_s2",
        "deceleration_m_s2",
        "force_N",
        "load_factor",
    ],
};

/// A standstill for a given time.
const DWELL: EntryKind =
    EntryKind { name: "a dwell (dwell_s)", keys: &["dwell_s", "force_N", "load_factor"] };

/// A phase with constant speed or a ramp.
const PHASE: EntryKind = EntryKind {
    name: "a phase",
    keys: &[
        "time_s",
        "share",
        "feed_m_min",
        "screw_speed_rpm",
        "start_feed_m_min",
        "end_feed_m_min",
        "acceleration_m_s2",
        "force_N",
        "end_force_N",
        "load_factor",
    ],
};

/// Value of a key in a cycle entry.
enum EntryValue {
    Number(f64),
    Profile(Named<MoveProfile>),
}

impl EntryValue {
    /// Parses the name of a speed profile.
    fn profile(name: Value) -> Result<Self, String> {
        serde_json::from_value(name).map(Self::Profile).map_err(|e| format!("`{PROFILE}`: {e}"))
    }
}

impl TryFrom<Map<String, Value>> for PhaseEntry {
    type Error = String;

    fn try_from(map: Map<String, Value>) -> Result<Self, String> {
        let mut given = GivenNames::default();
        let mut entry = |(key, value): (&String, &Value)| {
            let column = phase_key(key)?;
            given.add(column.0, key).map_err(|error| error.to_string())?;
            if column.0 == PROFILE {
                return Ok((column, EntryValue::profile(value.clone())?));
            }
            let number = value.as_f64().ok_or_else(|| format!("`{key}` must be a number"))?;
            Ok((column, EntryValue::Number(number)))
        };
        let entries: Vec<_> = map.iter().map(&mut entry).collect::<Result<_, String>>()?;
        Self::of(entries)
    }
}

/// Returns the key of a cycle entry to which `name` refers, and the conversion to the unit of the
/// key. The unit at the end of `name` may differ from the unit of the key.
fn phase_key(name: &str) -> Result<NamedColumn, String> {
    let names = PHASE_INPUTS.iter().map(|input| input.name).chain([PROFILE]);
    let known = names.clone().find(|known| *known == name).map(|known| (known, UnitChange::NONE));
    let numbers = PHASE_INPUTS.iter().map(|input| input.name);
    known.or_else(|| convert(name, numbers)).ok_or_else(|| {
        let near = nearest(name, names.clone());
        let hint = near.map_or(String::new(), |near| format!("; did you mean `{near}`?"));
        let all = names.clone().collect::<Vec<_>>().join(", ");
        format!("unknown key `{name}`{hint}; an entry of a cycle has {all}")
    })
}

impl PhaseEntry {
    /// Creates a cycle entry from its keys and values.
    fn of(entries: impl IntoIterator<Item = (NamedColumn, EntryValue)>) -> Result<Self, String> {
        let mut phase = Self::default();
        for ((word, change), value) in entries {
            let value = match value {
                EntryValue::Number(value) => change.value(value),
                EntryValue::Profile(profile) => {
                    phase.profile = Some(profile);
                    continue;
                }
            };
            let input = PHASE_INPUTS.iter().find(|input| input.name == word);
            let rule = input.map_or(Any, |input| input.rule);
            rule.check(word, value).map_err(|error| error.to_string())?;
            phase.set(word, value);
        }
        phase.check_keys()?;
        Ok(phase)
    }

    /// Checks that the given keys together describe a move, a dwell or a phase.
    fn check_keys(&self) -> Result<(), String> {
        let kind = match (self.distance_mm, self.dwell_s) {
            (Some(_), _) => &MOVE,
            (None, Some(_)) => &DWELL,
            (None, None) => &PHASE,
        };
        if let Some(other) = self.given().find(|key| !kind.keys.contains(key)) {
            return Err(format!(
                "{} cannot have {other}; it can have {}",
                kind.name,
                kind.keys.join(", ")
            ));
        }
        let one_of = |name: &str, keys: [&str; 2]| {
            let given = self.given().filter(|key| keys.contains(key)).count();
            let [one, other] = keys;
            (given == 1).then_some(()).ok_or(format!("{name} needs either {one} or {other}"))
        };
        if self.dwell_s.is_some() {
            return Ok(());
        }
        if let Some(distance) = self.distance_mm {
            one_of("a move", ["time_s", "max_feed_m_min"])?;
            one_of("a move", [PROFILE, "acceleration_m_s2"])?;
            if distance == 0.0 {
                return Err("distance_mm is 0; for a standstill, give dwell_s".to_owned());
            }
            if let Some(acceleration) = self.acceleration_m_s2.filter(|a| *a <= 0.0) {
                return Err(format!(
                    "acceleration_m_s2 of a move is {acceleration}, but must be positive"
                ));
            }
            if self.profile.is_some() && self.time_s.is_none() {
                return Err("a move with a profile needs time_s".to_owned());
            }
            if self.profile.and(self.deceleration_m_s2).is_some() {
                return Err(
                    "deceleration_m_s2 requires acceleration_m_s2 and cannot be combined with profile".to_owned()
                );
            }
            return Ok(());
        }
        one_of("a phase", ["time_s", "share"])?;
        let is_ramp = self.start_feed_m_min.or(self.end_feed_m_min).is_some();
        let speeds = [
            (self.feed_m_min.is_some(), "feed_m_min"),
            (self.screw_speed_rpm.is_some(), "screw_speed_rpm"),
            (is_ramp, "start_feed_m_min and end_feed_m_min"),
        ];
        let given: Vec<_> =
            speeds.iter().filter(|(given, _)| *given).map(|(_, key)| *key).collect();
        if given.len() > 1 {
            return Err(format!("a phase can contain only one of {}", given.join(" and ")));
        }
        let accelerates = self.acceleration_m_s2.is_some_and(|acceleration| acceleration != 0.0);
        if is_ramp && self.acceleration_m_s2.is_some() {
            return Err(
                "start_feed_m_min and end_feed_m_min determine the acceleration of a phase; \
                        remove acceleration_m_s2"
                    .to_owned(),
            );
        }
        if (is_ramp || accelerates) && self.share.is_some() {
            return Err(
                "a phase with acceleration cannot have a share; give time_s to all entries, and dwell_s for the standstill"
                    .to_owned(),
            );
        }
        if (is_ramp || accelerates) && self.end_force_N.is_some() {
            return Err("end_force_N needs a constant speed".to_owned());
        }
        Ok(())
    }

    /// Reads a cycle from a CSV table with one row per entry. The columns are named after the keys
    /// of an entry, in any unit.
    ///
    /// # Errors
    /// Returns [`CaseError::Invalid`] with the number of the row that contains the error.
    pub fn from_csv(table: &[u8], format: &TableFormat) -> Result<Vec<Self>, CaseError> {
        let cells = Cells::read(table, format)?;
        let key = |name: &str| phase_key(name).map_err(CaseError::Invalid);
        let columns = cells.columns(|head| format.input_of(head).map(key).transpose())?;
        cells.each(&columns, |_, row| {
            let entry = |(column, text): (NamedColumn, &str)| {
                let value = if column.0 == PROFILE {
                    EntryValue::profile(text.into()).map_err(CaseError::Invalid)?
                } else {
                    EntryValue::Number(cells.number(text)?)
                };
                Ok((column, value))
            };
            let row: Vec<_> = row.map(entry).collect::<Result<_, CaseError>>()?;
            Self::of(row).map_err(CaseError::Invalid)
        })
    }
}
