//! Names in what people write: which are known, which is near, what appears twice.

use std::collections::BTreeSet;
use std::fmt;

use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use serde_json::Value;

use super::error::{Known, brief};
use super::units::{is_unit, long_name};
use crate::{CaseEntries, CaseError, INPUTS};

/// What a case is.
const OF_INPUTS: &str = "a case is a JSON object of inputs such as {\"ball_diameter_mm\": 6.35}";

/// The entries of a JSON object, in order, none twice.
///
/// # Errors
///
/// [`CaseError`] for syntax and repeated keys.
pub fn entries(json: &[u8]) -> Result<Vec<(String, Value)>, CaseError> {
    // Some editors begin a file with a byte order mark.
    let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
    if json.iter().all(u8::is_ascii_whitespace) {
        return Err(CaseError::Invalid(format!("is empty; {OF_INPUTS}")));
    }
    let entries = match serde_json::from_slice::<Entries>(json) {
        Ok(entries) => entries.0,
        Err(error) => {
            return Err(match serde_json::from_slice::<Value>(json) {
                Ok(other) => {
                    CaseError::Invalid(format!("is JSON {}, but {OF_INPUTS}", kind(&other)))
                }
                Err(_) => CaseError::Syntax(error),
            });
        }
    };
    let mut seen = BTreeSet::new();
    match entries.iter().find(|(key, _)| !seen.insert(key.as_str())) {
        Some((key, _)) => Err(CaseError::given_twice([key, key])),
        None => Ok(entries),
    }
}

pub(crate) fn unknown_key(key: &str) -> CaseError {
    CaseError::unknown(Known::Input, key, nearest_input(key))
}

/// The known input whose name is nearest to `key`, if any is near.
pub fn nearest_input(key: &str) -> Option<&'static str> {
    // All but the unit.
    let whole = long_name(key).unwrap_or(key);
    let meant = |name: &&str| {
        let unit = name.strip_prefix(whole).and_then(|rest| rest.strip_prefix('_'));
        unit.is_some_and(is_unit)
    };
    if let Some(name) = INPUTS.iter().map(|input| input.name).find(meant) {
        return Some(name);
    }
    nearest(key, INPUTS.iter().map(|input| input.name).chain(CaseEntries::KEYS.iter().copied()))
}

/// The name that is nearest to `key`, if any is near.
pub(crate) fn nearest<'a>(key: &str, names: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    // What is so long is not near anything, and would take as long to compare.
    let names = names.filter(|name| key.len() <= 2 * name.len());
    let key = key.to_lowercase();
    let part = if key.len() < 3 { "no part of a name" } else { key.as_str() };
    let ranked = names.enumerate().map(|(place, name)| {
        let lower = name.to_lowercase();
        let distance = strsim::damerau_levenshtein(&key, &lower);
        let (begins, has) = (name.starts_with(part), name.contains(part));
        // Words left out, as `max` of nut_max_pressure_MPa.
        let short =
            key.contains('_') && key.split('_').all(|word| lower.split('_').any(|w| w == word));
        let distance = match has {
            _ if short => distance.min(2),
            true if name.split('_').any(|word| word == part) => distance.min(1),
            true => distance.min(3),
            false => distance,
        };
        // Of several that have it as a part, one that begins with it, and of those the first.
        ((distance, !begins, !has, place), name)
    });
    ranked
        .min()
        .filter(|((distance, ..), name)| *distance <= name.len().max(key.len()) / 2)
        .map(|(_, name)| name)
}

pub(crate) fn wrong_type(key: &str, value: &Value, expected: &str) -> CaseError {
    let found = match value {
        Value::String(text) => format!("the text \"{}\"", brief(text)),
        other => kind(other).to_owned(),
    };
    CaseError::wrong_type(key, &found, expected)
}

fn kind(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "true or false",
        Value::Number(_) => "a number",
        Value::String(_) => "text",
        Value::Array(_) => "a list",
        Value::Object(_) => "an object",
    }
}

/// The entries of a JSON object in order, repeated keys included.
struct Entries(Vec<(String, Value)>);

impl<'de> Deserialize<'de> for Entries {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct InOrder;

        impl<'de> Visitor<'de> for InOrder {
            type Value = Entries;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a JSON object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Entries, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                Ok(Entries(entries))
            }
        }

        deserializer.deserialize_map(InOrder)
    }
}
