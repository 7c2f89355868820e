//! Names in user files: known names, suggestions for unknown names, and repeated names.

use std::cell::RefCell;
use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value};

use super::error::{NameKind, brief};
use super::units::{is_unit, long_name};
use crate::{CaseEntries, CaseError, INPUTS, InputKey, Output};

/// Words that denote a case in messages about invalid files.
const CASE_DESCRIPTION: &str =
    "a case is a JSON object of inputs such as {\"ball_diameter_mm\": 6.35}";

/// Quantities that a single source specifies, such as a case, the settings of a command or the
/// header of a table. Each quantity is stored with the name that the source uses. The source may
/// specify a quantity only once, in any unit.
#[derive(Debug, Default)]
pub(crate) struct GivenNames(Vec<(&'static str, String)>);

impl GivenNames {
    /// Adds a quantity together with the name by which the source specifies this quantity.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError::Entry`] with both names if the quantity is already present.
    pub(crate) fn add(&mut self, quantity: &'static str, name: &str) -> Result<(), CaseError> {
        if let Some((_, former)) = self.0.iter().find(|(known, _)| *known == quantity) {
            return Err(CaseError::same_input(former, name));
        }
        self.0.push((quantity, name.to_owned()));
        Ok(())
    }
}

/// Returns the members of a JSON object in the order in which they appear in the text.
///
/// # Errors
///
/// Returns [`CaseError`] for invalid syntax, and for a key that occurs twice in an object at any
/// depth.
pub fn entries(json: &[u8]) -> Result<Vec<(String, Value)>, CaseError> {
    // Some editors write a byte order mark at the beginning of a file.
    let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
    if json.iter().all(u8::is_ascii_whitespace) {
        return Err(CaseError::Invalid(format!("is empty; {CASE_DESCRIPTION}")));
    }
    match json_value(json)? {
        Value::Object(entries) => Ok(entries.into_iter().collect()),
        other => {
            Err(CaseError::Invalid(format!("is JSON {}, but {CASE_DESCRIPTION}", kind(&other))))
        }
    }
}

/// Converts a value from any input format to a JSON value.
///
/// # Errors
/// Returns the errors of the deserializer. Also returns an error for a number that is not finite,
/// and for a key that occurs twice in an object.
pub fn json_value_of<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Value, D::Error> {
    UniqueKeys(&RefCell::default()).deserialize(deserializer)
}

/// Parses the value of a setting as JSON. A text that is not valid JSON is treated as a string
/// without quotes.
///
/// # Errors
///
/// Returns [`CaseError::Entry`] for a key that occurs twice in an object.
pub(crate) fn json_or_text(text: &str) -> Result<Value, CaseError> {
    match json_value(text.as_bytes()) {
        Err(CaseError::Syntax(_)) => Ok(Value::from(text)),
        read => read,
    }
}

/// Parses a JSON value and rejects repeated keys. The crate `serde_json` would silently keep the
/// last value of a repeated key.
fn json_value(json: &[u8]) -> Result<Value, CaseError> {
    let repeated = RefCell::default();
    let mut reader = serde_json::Deserializer::from_slice(json);
    let value = UniqueKeys(&repeated).deserialize(&mut reader);
    let value = value.and_then(|value| reader.end().map(|()| value));
    value.map_err(|error| match repeated.take() {
        Some(key) => CaseError::given_twice([&key, &key]),
        None => CaseError::Syntax(error),
    })
}

/// Deserializer for any JSON value. It rejects a key that occurs twice in an object, and stores
/// this key.
#[derive(Clone, Copy)]
struct UniqueKeys<'a>(&'a RefCell<Option<String>>);

impl<'de> DeserializeSeed<'de> for UniqueKeys<'_> {
    type Value = Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Value, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for UniqueKeys<'_> {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Value, E> {
        if value.is_finite() {
            Ok(value.into())
        } else {
            Err(E::custom(format!("{value} is not a finite number")))
        }
    }

    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Value, A::Error> {
        let mut values = Vec::new();
        while let Some(value) = list.next_element_seed(self)? {
            values.push(value);
        }
        Ok(Value::Array(values))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Value, A::Error> {
        let mut entries = Map::new();
        while let Some(key) = map.next_key::<String>()? {
            if entries.contains_key(&key) {
                self.0.replace(Some(key));
                return Err(A::Error::custom("a key occurs twice"));
            }
            entries.insert(key, map.next_value_seed(self)?);
        }
        Ok(Value::Object(entries))
    }
}

/// Key of a requirement whose value is one of several words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RequirementChoice {
    /// Driving motion.
    Motion,
    /// Quantity that the search optimizes.
    Objective,
    /// Model that calculates the efficiency.
    Model,
    /// Permission to exceed the recommended temperature rise.
    AllowWarnings,
}

impl RequirementChoice {
    /// All keys, in the order of the documentation.
    pub const ALL: [Self; 4] = [Self::Motion, Self::Objective, Self::Model, Self::AllowWarnings];

    /// Returns the key with the given name.
    pub(crate) fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|choice| choice.name() == name)
    }

    /// Returns the name of the key.
    pub fn name(self) -> &'static str {
        match self {
            Self::Motion => "motion",
            Self::Objective => "objective",
            Self::Model => "model",
            Self::AllowWarnings => "allow_warnings",
        }
    }

    /// Returns the meaning of the key.
    pub fn about(self) -> &'static str {
        match self {
            Self::Motion => "driving motion: rotation of the screw, or linear motion of the nut",
            Self::Objective => "quantity that the search optimizes",
            Self::Model => "model that calculates the efficiency",
            Self::AllowWarnings => {
                "true: a selected screw may exceed the recommended limit of 40 K for the temperature rise"
            }
        }
    }
}

/// Beginnings of keys with which users often mean `rated_rigidity_N_um`.
const RIGIDITY_SYNONYMS: [&str; 4] = ["stiffness_", "nut_stiffness_", "rigidity_", "nut_rigidity_"];

pub(crate) fn unknown_key(key: &str) -> CaseError {
    if RequirementChoice::from_name(key).is_some() {
        let what = format!(
            "`{key}` is a key of a requirement, which `bsm select` reads, and not an input of a case"
        );
        return CaseError::Entry { key: key.to_owned(), what };
    }
    if RIGIDITY_SYNONYMS.iter().any(|beginning| key.starts_with(beginning)) {
        let meant = InputKey::rated_rigidity_N_um.name();
        return CaseError::unknown(NameKind::Input, key, Some(meant));
    }
    if Output::all().any(|output| output.name == key) {
        let what = format!(
            "`{key}` is a result, not an input; `bsm fit --measured {key}=VALUE --input NAME` finds the input that gives this result"
        );
        return CaseError::Entry { key: key.to_owned(), what };
    }
    CaseError::unknown(NameKind::Input, key, nearest_input(key))
}

/// Returns the input whose name is most similar to `key`, if a name is similar enough.
pub fn nearest_input(key: &str) -> Option<&'static str> {
    // The name may be correct except for its missing unit.
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

/// Returns the name that is most similar to `key`, if a name is similar enough.
pub(crate) fn nearest<'a>(key: &str, names: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    // If the text is much longer than a name, the text and the name are not similar, and comparing
    // them would be slow.
    let names = names.filter(|name| key.len() <= 2 * name.len());
    let key = key.to_lowercase();
    let part = if key.len() < 3 { "no part of a name" } else { key.as_str() };
    let ranked = names.enumerate().map(|(place, name)| {
        let lower = name.to_lowercase();
        let distance = strsim::damerau_levenshtein(&key, &lower);
        let (begins, has) = (name.starts_with(part), name.contains(part));
        // The text may consist of only some words of the name, such as `max_pressure` for
        // nut_max_pressure_MPa.
        let short =
            key.contains('_') && key.split('_').all(|word| lower.split('_').any(|w| w == word));
        let distance = match has {
            _ if short => distance.min(2),
            true if name.split('_').any(|word| word == part) => distance.min(1),
            true => distance.min(3),
            false => distance,
        };
        // If several names contain the text, names that begin with it are preferred, and then names
        // that are declared earlier.
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
