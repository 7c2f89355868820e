//! The cycle of an axis: its phases, from JSON and from a table.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use crate::units::convert;
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

    /// JSON Schema of a list of them.
    pub(crate) fn schema() -> Value {
        let words = WORDS.map(|word| (word.to_owned(), json!({ "type": "number" })));
        let properties: Map<_, _> = words.into_iter().collect();
        json!({
            "type": ["array", "null"],
            "items": { "type": "object", "properties": properties, "additionalProperties": false },
        })
    }

    /// Reads a cycle from a table, a row a phase: columns are the words of a phase, in any unit.
    ///
    /// * `separator`: between cells. * `decimal`: the decimal sign.
    ///
    /// # Errors
    ///
    /// [`CaseError::Spectrum`] with the row.
    pub fn from_csv(table: &[u8], separator: u8, decimal: char) -> Result<Vec<Self>, CaseError> {
        let wrong = |what: String| CaseError::Spectrum { what };
        let mut reader =
            csv::ReaderBuilder::new().trim(csv::Trim::All).delimiter(separator).from_reader(table);
        let header = reader.headers().map_err(|e| wrong(e.to_string()))?.clone();
        let mut phases = Vec::new();
        for (row, record) in (1_usize..).zip(reader.records()) {
            let in_row = |what: String| wrong(format!("row {row}: {what}"));
            let record = record.map_err(|e| in_row(e.to_string()))?;
            let cell = |(name, text): (&str, &str)| {
                let number = decimal_number(text, decimal);
                number
                    .ok_or_else(|| in_row(format!("`{text}` is no number")))
                    .map(|n| (name.to_owned(), n))
            };
            let cells: Vec<_> = header
                .iter()
                .zip(&record)
                .filter(|(_, text)| !text.is_empty())
                .map(cell)
                .collect::<Result<_, _>>()?;
            let phase = Self::of(cells.iter().map(|(name, number)| (name.as_str(), *number)));
            phases.push(phase.map_err(in_row)?);
        }
        if phases.is_empty() {
            return Err(wrong(format!("has no rows; the columns are {}", WORDS.join(", "))));
        }
        Ok(phases)
    }
}

/// A number with a decimal sign of one's choice; one that has another sign too is none.
pub fn decimal_number(text: &str, decimal: char) -> Option<f64> {
    let other = if decimal == ',' { '.' } else { ',' };
    if text.contains(other) {
        return None;
    }
    text.replace(decimal, ".").parse().ok().filter(|value: &f64| value.is_finite())
}
