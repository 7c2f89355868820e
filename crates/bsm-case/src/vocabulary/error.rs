//! Errors of a case. They state the key, the value and the requirement.

use std::io;
use std::path::PathBuf;

use bsm_dyn::Model;
use bsm_nut::NutError;
use thiserror::Error;

use super::units::units_of_stem;
use crate::{InputKey, OtherSeparator, exact, nearest};

/// A case, a setting or a grid that cannot be used.
///
/// Messages name neither the file nor a command or an option. The caller adds them.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CaseError {
    /// The file cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Unreadable {
        /// Path of the file.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// The file is not valid JSON.
    #[error("is not valid JSON: {0}")]
    Syntax(#[source] serde_json::Error),
    /// An unknown name.
    #[error("{} `{}`{}", known.text(), brief(name), nearest_hint(name, nearest.as_deref()))]
    Unknown {
        /// Kind of the name.
        known: Known,
        /// The unknown name.
        name: String,
        /// The most similar known name.
        nearest: Option<String>,
    },
    /// The names of the columns of a table are separated by an unexpected character.
    #[error(transparent)]
    Separator(OtherSeparator),
    /// A number outside its range or outside the range of a model.
    #[error("`{key}` = {} must be {rule}{}", exact(*value), for_model(*model))]
    OutOfRange {
        /// The key.
        key: String,
        /// Its value.
        value: f64,
        /// The rule as text.
        rule: String,
        /// The model that does not cover the value, if a model limits the range.
        model: Option<&'static str>,
    },
    /// An input that is invalid or missing.
    #[error("{what}")]
    Entry {
        /// The key.
        key: String,
        /// Message.
        what: String,
    },
    /// An axis has no warm steady state.
    #[error("no warm steady state: {0}")]
    NoWarmState(Box<bsm_nut::thermal::NoSteadyState>),
    /// A nut does not carry its load, or its preload cannot be set.
    #[error("{0}")]
    Nut(NutError),
    /// Load ratings that no usual groove has, so that no groove can be estimated.
    #[error("{0}")]
    NoGroove(String),
    /// The search range of an input is unknown.
    #[error("`{key}` is not in the case, and no range to search is given")]
    NoRange {
        /// The input.
        key: &'static str,
    },
    /// The inputs contradict each other, or have no result.
    #[error("{0}")]
    Invalid(String),
    /// A row of a table is invalid.
    #[error("row {row}: {error}")]
    InRow {
        /// Number of the row, from 1.
        row: usize,
        /// Error in the row.
        error: Box<Self>,
    },
}

/// Kinds of names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Known {
    /// Inputs of a case.
    Input,
    /// Lists of the catalog.
    List,
    /// Columns of the catalog.
    Column,
    /// Columns of a manufacturer's table.
    TableColumn,
    /// Keys of a requirement.
    Requirement,
    /// Numeric outputs.
    Output,
}

impl Known {
    fn text(self) -> &'static str {
        match self {
            Self::Input | Self::List | Self::Requirement => "unknown key",
            Self::Column => "no column is named",
            Self::TableColumn => "unknown column",
            Self::Output => "no numeric output is named",
        }
    }
}

impl CaseError {
    /// Reports a result outside the range of double precision.
    pub(crate) fn beyond_double(output: &str) -> Self {
        Self::Invalid(format!(
            "{output} is outside the range of double precision; check the magnitudes of the inputs"
        ))
    }

    /// Reports a model that supports only a friction coefficient.
    pub(crate) fn no_lubricant(model: Model) -> Self {
        let model = model.name();
        Self::Invalid(format!(
            "model {model} does not support a lubricant, but models raceway-control and traction do; otherwise, set \
             friction_coefficient to the equivalent_friction_coefficient of their result"
        ))
    }

    /// Reports a number outside its range.
    pub(crate) fn out_of_range(
        key: impl Into<String>,
        value: f64,
        rule: impl Into<String>,
    ) -> Self {
        Self::OutOfRange { key: key.into(), value, rule: rule.into(), model: None }
    }

    /// Reports a value that a model does not cover.
    pub(crate) fn not_covered(key: InputKey, value: f64, rule: &str, model: Model) -> Self {
        let (key, rule) = (key.name().to_owned(), rule.to_owned());
        Self::OutOfRange { key, value, rule, model: Some(model.name()) }
    }

    fn entry(key: &str, what: String) -> Self {
        Self::Entry { key: key.to_owned(), what }
    }

    /// Reports missing inputs, with the model or analysis that requires them as a phrase.
    pub(crate) fn missing(missing: &[String], by: &str) -> Self {
        let what = format!("{} required {by}", list(missing));
        match missing {
            [] => Self::Invalid(what),
            [first, ..] => Self::entry(first, what),
        }
    }

    /// Reports that an analysis of the motion needs a model with a motion of the ball.
    ///
    /// * `missing`: inputs of the simplest model with a motion of the ball that the case lacks.
    pub(crate) fn no_motion(model: Model, missing: &[String]) -> Self {
        let others = match missing {
            [] => "models rigid, raceway-control, elastic and traction do".to_owned(),
            missing => {
                format!("{} required by model rigid, the simplest model that does", list(missing))
            }
        };
        let model = model.name();
        Self::Invalid(format!(
            "model {model} does not calculate the motion of the ball, which this analysis needs; {others}"
        ))
    }

    /// Reports a text that is not one of the known values, with the most similar known value.
    pub(crate) fn unknown_word(kind: &str, name: &str, known: &[&str]) -> Self {
        let near = nearest(name, known.iter().copied());
        let hint =
            near.map_or_else(|| "the".to_owned(), |near| format!("did you mean `{near}`? The"));
        let known = known.join(", ");
        Self::entry(name, format!("unknown {kind} `{name}`; {hint} {kind}s are {known}"))
    }

    /// Reports a setting or a grid axis that cannot be parsed.
    pub fn bad_setting(text: &str, form: &str) -> Self {
        Self::Invalid(format!("`{}` does not have the form {form}", brief(text)))
    }

    /// Reports a value of the wrong type.
    pub(crate) fn wrong_type(key: &str, found: &str, expected: &str) -> Self {
        Self::entry(key, format!("`{key}` is {found}, but must be {expected}"))
    }

    /// Reports more points than can be counted.
    pub(crate) fn grid_too_large(limit: usize) -> Self {
        Self::Invalid(format!("the grid has more than {limit} points; use fewer values per axis"))
    }

    /// Reports an unknown name, with the most similar known name.
    pub(crate) fn unknown(known: Known, name: &str, nearest: Option<&str>) -> Self {
        Self::Unknown { known, name: name.to_owned(), nearest: nearest.map(str::to_owned) }
    }

    /// Reports that neither of two alternative keys is given.
    pub(crate) fn neither([one, other]: [&str; 2]) -> Self {
        Self::Invalid(format!("give one of {one} and {other}; neither is given"))
    }

    /// Reports an input that is given in two units, or twice under one name.
    pub(crate) fn same_input(one: &str, other: &str) -> Self {
        if one == other {
            return Self::given_twice([one, other]);
        }
        let [first, second] = [one, other].map(brief);
        let what = format!("`{first}` and `{second}` are the same input; give one of them");
        Self::entry(other, what)
    }

    /// Reports a quantity that is given in two forms, or an input that is given twice under one
    /// name.
    pub(crate) fn given_twice([one, other]: [&str; 2]) -> Self {
        let what = if one == other {
            format!("`{}` is given twice; give it once", brief(one))
        } else {
            format!("give one of {one} and {other}; both are given")
        };
        Self::entry(other, what)
    }

    /// Reports the error of a value, as stated by the reader of the value.
    pub(crate) fn of_value(key: &str, error: &str) -> Self {
        Self::entry(key, format!("`{key}`: {error}"))
    }

    /// Reports a text instead of a number.
    pub fn not_a_number(key: &str, text: &str) -> Self {
        Self::wrong_type(key, &format!("`{}`", brief(text)), "a number")
    }

    /// Returns the error in the row of a table, or the error itself.
    fn of_row(&self) -> &Self {
        match self {
            Self::InRow { error, .. } => error.of_row(),
            _ => self,
        }
    }

    /// Returns the input or column that caused the error, if there is one.
    pub fn key(&self) -> Option<&str> {
        match self.of_row() {
            Self::OutOfRange { key, .. } | Self::Entry { key, .. } => Some(key),
            Self::NoRange { key } => Some(key),
            Self::Unknown { name, .. } => Some(name),
            _ => None,
        }
    }

    /// Returns the value that violates a rule.
    pub fn value(&self) -> Option<f64> {
        match self.of_row() {
            Self::OutOfRange { value, .. } => Some(*value),
            _ => None,
        }
    }

    /// Returns the rule that a value violates, as text after "must be".
    pub fn rule(&self) -> Option<&str> {
        match self.of_row() {
            Self::OutOfRange { rule, .. } => Some(rule),
            _ => None,
        }
    }

    /// Returns the known name that is most similar to an unknown name.
    pub fn nearest(&self) -> Option<&str> {
        match self.of_row() {
            Self::Unknown { nearest, .. } => nearest.as_deref(),
            _ => None,
        }
    }

    /// Returns the invalid row of a table, counted from 1.
    pub fn row(&self) -> Option<usize> {
        match self {
            Self::InRow { row, .. } => Some(*row),
            _ => None,
        }
    }

    /// Returns the error as an error in a row of a table, counted from 1.
    #[must_use]
    pub fn in_row(self, row: usize) -> Self {
        Self::InRow { row, error: Box::new(self) }
    }

    /// Returns true if the file system caused the error.
    pub fn is_io(&self) -> bool {
        matches!(self, Self::Unreadable { .. })
    }
}

/// Reports an invalid entry.
///
/// * `what`: predicate of a sentence about the key, such as "must be positive".
pub(crate) fn bad(key: impl Into<String>, what: impl Into<String>) -> CaseError {
    let (key, what) = (key.into(), what.into());
    CaseError::Entry { what: format!("`{key}` {what}"), key }
}

/// Returns the beginning of a user's text for a message, with control characters escaped.
pub fn brief(text: &str) -> String {
    // About one line. Names of inputs are at most half as long.
    const MAX_CHARACTERS: usize = 60;
    match text.char_indices().nth(MAX_CHARACTERS) {
        Some((end, _)) => format!("{}…", text[..end].escape_debug()),
        None => text.escape_debug().to_string(),
    }
}

/// Escapes characters that change the behavior of a terminal: control characters except for line
/// ends, and characters that change the writing direction.
pub fn printable(text: &str) -> String {
    let obeyed = |c: char| {
        (c.is_control() && c != '\n')
            || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    let mut printable = String::with_capacity(text.len());
    for c in text.chars() {
        if obeyed(c) {
            printable.extend(c.escape_default());
        } else {
            printable.push(c);
        }
    }
    printable
}

fn for_model(model: Option<&str>) -> String {
    model.map_or_else(String::new, |model| format!(" for model {model}"))
}

fn nearest_hint(name: &str, nearest: Option<&str>) -> String {
    let Some(nearest) = nearest else { return String::new() };
    match units_of_stem(name, nearest) {
        Some(units) => format!("; did you mean `{nearest}`? Its unit can be {}", units.join(", ")),
        None => format!("; did you mean `{nearest}`?"),
    }
}

/// Formats a list such as "a is", "a and b are" or "a, b and c are".
pub(crate) fn list(keys: &[String]) -> String {
    match keys {
        [] => "nothing is".to_owned(),
        [one] => format!("{one} is"),
        [rest @ .., last] => format!("{} and {last} are", rest.join(", ")),
    }
}
