//! The cycle of an axis: its phases, from JSON and from a table.

use bsm_design::DutySpeed;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::Rule::{Above, Any, Within};
use crate::vocabulary::cells::{Cells, NamedColumn};
use crate::vocabulary::names::GivenNames;
use crate::vocabulary::quantity::keys;
use crate::vocabulary::units::{RPM, convert};
use crate::{CaseError, TableFormat, nearest};

macro_rules! phase {
    ($($name:ident [$unit:literal $($symbol:literal)?] $rule:expr, $default:expr, $about:literal;)*) => {
        keys! {
            /// Keys of a phase.
            pub(crate) PHASE_INPUTS;
            $($name [$unit $($symbol)?] $rule, $default, $about;)*
        }

        /// A phase of a cycle.
        #[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[schemars(!try_from, deny_unknown_fields)]
        #[serde(try_from = "Map<String, Value>")]
        #[expect(non_snake_case, reason = "names carry their unit as it is written")]
        pub struct PhaseEntry {
            $(
                #[doc = $about]
                #[serde(skip_serializing_if = "Option::is_none")]
                pub $name: Option<f64>,
            )*
        }

        impl Default for PhaseEntry {
            fn default() -> Self {
                Self { $($name: $default),* }
            }
        }

        impl PhaseEntry {
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
    time_s ["s" "t"] Above(0.0), None, "how long it lasts; or share";
    share [""] Above(0.0), None, "share of the time of the cycle; or time_s";
    force_N ["N" "F"] Any, Some(0.0), "process force; positive against a positive feed";
    feed_m_min ["m/min" "v"] Any, None, "velocity of the nut along the screw; 0 unless screw_speed_rpm is given";
    screw_speed_rpm ["rpm" "n"] Any, None, "speed of the screw, in place of feed_m_min";
    acceleration_m_s2 ["m/s2" "a"] Any, Some(0.0), "acceleration along a positive feed";
    load_factor ["" "f_w"] Within(1.0, 5.0), None, "factor of the load in life and equivalent load; that of the case unless given";
}

impl TryFrom<Map<String, Value>> for PhaseEntry {
    type Error = String;

    fn try_from(map: Map<String, Value>) -> Result<Self, String> {
        let mut given = GivenNames::default();
        let mut entry = |(key, value): (&String, &Value)| {
            let number = value.as_f64().ok_or_else(|| format!("`{key}` must be a number"))?;
            let column = phase_key(key)?;
            given.add(column.0, key).map_err(|error| error.to_string())?;
            Ok((column, number))
        };
        let entries: Vec<_> = map.iter().map(&mut entry).collect::<Result<_, String>>()?;
        Self::of(entries)
    }
}

/// The key of a phase that a name in any unit means, and the factor to its unit.
fn phase_key(name: &str) -> Result<NamedColumn, String> {
    let names = PHASE_INPUTS.iter().map(|input| input.name);
    let known = names.clone().find(|known| *known == name).map(|known| (known, 1.0));
    known.or_else(|| convert(name, &names)).ok_or_else(|| {
        let near = nearest(name, names.clone());
        let hint = near.map_or(String::new(), |near| format!("; did you mean `{near}`?"));
        let all = names.clone().collect::<Vec<_>>().join(", ");
        format!("unknown key `{name}`{hint}; a phase has {all}")
    })
}

impl PhaseEntry {
    /// A phase with these values, each in the unit of its name.
    fn of(entries: impl IntoIterator<Item = (NamedColumn, f64)>) -> Result<Self, String> {
        let mut phase = Self::default();
        for ((word, factor), value) in entries {
            let value = factor * value;
            let input = PHASE_INPUTS.iter().find(|input| input.name == word);
            let rule = input.map_or(Any, |input| input.rule);
            rule.check(word, value).map_err(|error| error.to_string())?;
            phase.set(word, value);
        }
        if phase.time_s.is_some() == phase.share.is_some() {
            return Err("a phase has one of time_s and share".to_owned());
        }
        if phase.feed_m_min.and(phase.screw_speed_rpm).is_some() {
            return Err("a phase has one of feed_m_min and screw_speed_rpm".to_owned());
        }
        Ok(phase)
    }

    /// Its time, or its share of the cycle.
    pub(crate) fn time(&self) -> f64 {
        self.time_s.or(self.share).unwrap_or(0.0)
    }

    /// How fast the nut moves, or the screw turns.
    pub(crate) fn pace(&self) -> DutySpeed {
        match self.screw_speed_rpm {
            Some(rpm) => DutySpeed::Turns(rpm * RPM),
            None => DutySpeed::Feed(self.feed_m_min.unwrap_or(0.0) / 60.0),
        }
    }

    /// Reads a cycle from a table, a row a phase: columns are the keys of a phase, in any unit.
    ///
    /// # Errors
    ///
    /// [`CaseError::Invalid`] with the row.
    pub fn from_csv(table: &[u8], format: &TableFormat) -> Result<Vec<Self>, CaseError> {
        let cells = Cells::read(table, format)?;
        let columns =
            cells.columns(|head| phase_key(head).map(Some).map_err(CaseError::Invalid))?;
        cells.each(&columns, |_, row| {
            let entry = |(column, text): (NamedColumn, &str)| Ok((column, cells.number(text)?));
            let row: Vec<_> = row.map(entry).collect::<Result<_, CaseError>>()?;
            Self::of(row).map_err(CaseError::Invalid)
        })
    }
}
