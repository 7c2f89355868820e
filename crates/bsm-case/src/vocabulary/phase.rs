//! The cycle of an axis: its phases, from JSON and from a table.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::vocabulary::cells::Cells;
use crate::vocabulary::units::convert;
use crate::{CaseError, nearest};

/// The words of a phase.
const WORDS: [&str; 5] = ["time_s", "share", "force_N", "feed_m_min", "acceleration_m_s2"];

/// A phase of a cycle.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Map<String, Value>")]
#[expect(non_snake_case, reason = "names carry their unit as it is written")]
pub struct PhaseWords {
    /// How long it lasts; or `share`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_s: Option<f64>,
    /// Its share of the time of the cycle; or `time_s`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub share: Option<f64>,
    /// Process force, positive against a positive feed.
    pub force_N: f64,
    /// Velocity of the nut.
    pub feed_m_min: f64,
    /// Acceleration along a positive feed.
    pub acceleration_m_s2: f64,
}

impl TryFrom<Map<String, Value>> for PhaseWords {
    type Error = String;

    fn try_from(map: Map<String, Value>) -> Result<Self, String> {
        let entry = |(key, value): (&String, &Value)| {
            let number = value.as_f64().ok_or_else(|| format!("`{key}` must be a number"))?;
            Ok((key.clone(), number))
        };
        let entries: Vec<_> = map.iter().map(entry).collect::<Result<_, String>>()?;
        Self::of(entries.iter().map(|(key, number)| (key.as_str(), *number)))
    }
}

impl PhaseWords {
    /// From names in any unit, and values.
    fn of<'a>(entries: impl Iterator<Item = (&'a str, f64)>) -> Result<Self, String> {
        let mut phase = Self::default();
        for (name, value) in entries {
            let known = WORDS.iter().find(|known| **known == name).map(|known| (*known, 1.0));
            let (word, factor) =
                known.or_else(|| convert(name, &WORDS.into_iter())).ok_or_else(|| {
                    let near = nearest(name, WORDS.into_iter());
                    let hint =
                        near.map_or(String::new(), |near| format!("; did you mean `{near}`?"));
                    format!("unknown key `{name}`{hint}; a phase has {}", WORDS.join(", "))
                })?;
            let value = factor * value;
            if !value.is_finite() {
                return Err(format!("`{name}` must be finite"));
            }
            match word {
                "time_s" => phase.time_s = Some(value),
                "share" => phase.share = Some(value),
                "force_N" => phase.force_N = value,
                "feed_m_min" => phase.feed_m_min = value,
                _ => phase.acceleration_m_s2 = value,
            }
        }
        let ((Some(time), None) | (None, Some(time))) = (phase.time_s, phase.share) else {
            return Err("a phase has one of time_s and share".to_owned());
        };
        if time > 0.0 { Ok(phase) } else { Err("the time of a phase must be > 0".to_owned()) }
    }

    /// Its time, or its share of the cycle.
    pub(crate) fn time(&self) -> f64 {
        self.time_s.or(self.share).unwrap_or(0.0)
    }

    /// Velocity of the nut \[m/s\].
    pub(crate) fn feed(&self) -> f64 {
        self.feed_m_min / 60.0
    }

    /// Reads a cycle from a table, a row a phase: columns are the words of a phase, in any unit.
    ///
    /// * `separator`: between cells. * `decimal`: the decimal sign.
    ///
    /// # Errors
    ///
    /// [`CaseError::Table`] with the row.
    pub fn from_csv(table: &[u8], separator: u8, decimal: char) -> Result<Vec<Self>, CaseError> {
        let cells = Cells::read(table, separator, decimal)?;
        let heads = cells.columns(|head| Ok(head.to_owned()))?;
        cells.each(&heads, |_, row| {
            let entry = |(head, text): (&String, &str)| Ok((head.clone(), cells.number(text)?));
            let row: Vec<_> = row.map(entry).collect::<Result<_, CaseError>>()?;
            Self::of(row.iter().map(|(head, number)| (head.as_str(), *number)))
                .map_err(|what| CaseError::Table { what })
        })
    }
}
