//! Errors of a case. They state the key, the value and the requirement.

use std::io;
use std::path::PathBuf;

use bsm_dyn::Model;
use bsm_nut::NutError;
use thiserror::Error;

use crate::{InputKey, exact};

/// A case, a setting or a grid that cannot be used.
///
/// Messages name neither the file nor a command or an option: the caller that knows them does.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CaseError {
    /// The file cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Unreadable {
        /// Which file.
        path: PathBuf,
        /// Message of the system.
        source: io::Error,
    },
    /// Not JSON.
    #[error("is not valid JSON: {0}")]
    Syntax(#[source] serde_json::Error),
    /// A name that is not known.
    #[error("{} `{}`{}", known.text(), brief(name), nearest_hint(nearest.as_deref()))]
    Unknown {
        /// Kind of the name.
        known: Known,
        /// The name.
        name: String,
        /// The nearest known one.
        nearest: Option<String>,
    },
    /// A number outside its range, or outside that of a model.
    #[error("`{key}` = {} must be {rule}{}", exact(*value), for_model(*model))]
    OutOfRange {
        /// The key.
        key: String,
        /// Its value.
        value: f64,
        /// The rule as text.
        rule: String,
        /// The model that does not cover the value, if it is one.
        model: Option<&'static str>,
    },
    /// An entry that cannot be used, or is not there.
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
    /// A nut that does not carry its load, or whose preload cannot be set.
    #[error("{0}")]
    Nut(NutError),
    /// Load ratings that no usual groove has, so that no groove can be estimated.
    #[error("{0}")]
    NoGroove(String),
    /// Where to look for an input is not known.
    #[error("`{key}` is not in the case, and no range to search is given")]
    NoRange {
        /// The input.
        key: &'static str,
    },
    /// What the inputs mean together cannot be, or has no answer.
    #[error("{0}")]
    Invalid(String),
    /// A row of a table that cannot be used.
    #[error("row {row}: {error}")]
    InRow {
        /// Its number, from 1.
        row: usize,
        /// Why.
        error: Box<Self>,
    },
}

/// Kinds of names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Known {
    /// Inputs of a case.
    Input,
    /// Lists of the catalogue.
    List,
    /// Columns of the catalogue.
    Column,
    /// Keys of a requirement.
    Requirement,
    /// Outputs that are numbers.
    Output,
}

impl Known {
    fn text(self) -> &'static str {
        match self {
            Self::Input | Self::List | Self::Requirement => "unknown key",
            Self::Column => "no column is named",
            Self::Output => "no numeric output is named",
        }
    }
}

impl CaseError {
    /// A result that no double holds.
    pub(crate) fn beyond_double(output: &str) -> Self {
        Self::Invalid(format!(
            "{output} is outside the range of double precision; check the magnitudes of the inputs"
        ))
    }

    /// A model in which friction is a coefficient.
    pub(crate) fn no_lubricant(model: Model) -> Self {
        let model = model.name();
        Self::Invalid(format!(
            "model {model} takes no lubricant: models raceway-control and traction do; others take the \
             equivalent_friction_coefficient of their result as friction_coefficient"
        ))
    }

    /// A number outside its range.
    pub(crate) fn out_of_range(
        key: impl Into<String>,
        value: f64,
        rule: impl Into<String>,
    ) -> Self {
        Self::OutOfRange { key: key.into(), value, rule: rule.into(), model: None }
    }

    /// A value that a model does not cover.
    pub(crate) fn not_covered(key: InputKey, value: f64, rule: &str, model: Model) -> Self {
        let (key, rule) = (key.name().to_owned(), rule.to_owned());
        Self::OutOfRange { key, value, rule, model: Some(model.name()) }
    }

    fn entry(key: &str, what: String) -> Self {
        Self::Entry { key: key.to_owned(), what }
    }

    /// Inputs that are not given, and by what or what for they are required.
    pub(crate) fn missing(missing: &[String], by: &str) -> Self {
        let what = format!("{} required {by}", list(missing));
        match missing {
            [] => Self::Invalid(what),
            [first, ..] => Self::entry(first, what),
        }
    }

    /// A model without a motion of the ball, where one is to be analysed.
    ///
    /// * `missing`: inputs of the simplest model with a motion.
    pub(crate) fn no_motion(model: Model, missing: &[String]) -> Self {
        let others = match missing {
            [] => "models rigid, raceway-control, elastic and traction have one".to_owned(),
            missing => {
                format!("{} required by model rigid, the simplest that has one", list(missing))
            }
        };
        let model = model.name();
        Self::Invalid(format!(
            "model {model} has no motion of the ball, which this analysis needs; {others}"
        ))
    }

    /// A word that is none of a few.
    pub(crate) fn unknown_word(kind: &str, name: &str, known: &[&str]) -> Self {
        let known = known.join(", ");
        Self::entry(name, format!("unknown {kind} `{name}`; the {kind}s are {known}"))
    }

    /// A setting or axis that cannot be read.
    pub fn bad_setting(text: &str, form: &str) -> Self {
        Self::Invalid(format!("`{}` is not of the form {form}", brief(text)))
    }

    /// A value of the wrong type.
    pub(crate) fn wrong_type(key: &str, found: &str, expected: &str) -> Self {
        Self::entry(key, format!("`{key}` is {found}, but must be {expected}"))
    }

    /// More points than can be counted.
    pub(crate) fn grid_too_large(limit: usize) -> Self {
        Self::Invalid(format!("the grid has more than {limit} points; use fewer values per axis"))
    }

    /// A name that is not known, with the nearest that is.
    pub(crate) fn unknown(known: Known, name: &str, nearest: Option<&str>) -> Self {
        Self::Unknown { known, name: name.to_owned(), nearest: nearest.map(str::to_owned) }
    }

    /// None of two keys, one of which is needed.
    pub(crate) fn neither([one, other]: [&str; 2]) -> Self {
        Self::Invalid(format!("give one of {one} and {other}; neither is given"))
    }

    /// An input that is given by two names which differ in their units, or twice by one name.
    pub(crate) fn same_input(one: &str, other: &str) -> Self {
        if one == other {
            return Self::given_twice([one, other]);
        }
        let [first, second] = [one, other].map(brief);
        let what = format!("`{first}` and `{second}` are the same input; give one of them");
        Self::entry(other, what)
    }

    /// A quantity that is given in two forms, or an input that is given twice by one name.
    pub(crate) fn given_twice([one, other]: [&str; 2]) -> Self {
        let what = if one == other {
            format!("`{}` is given twice; give it once", brief(one))
        } else {
            format!("give one of {one} and {other}; both are given")
        };
        Self::entry(other, what)
    }

    /// An input whose value is some text.
    pub fn not_a_number(key: &str, text: &str) -> Self {
        Self::wrong_type(key, &format!("`{}`", brief(text)), "a number")
    }

    /// The error of a row of a table without its place.
    fn of_row(&self) -> &Self {
        match self {
            Self::InRow { error, .. } => error.of_row(),
            _ => self,
        }
    }

    /// The input or column that it is about, if it is about one.
    pub fn key(&self) -> Option<&str> {
        match self.of_row() {
            Self::OutOfRange { key, .. } | Self::Entry { key, .. } => Some(key),
            Self::NoRange { key } => Some(key),
            Self::Unknown { name, .. } => Some(name),
            _ => None,
        }
    }

    /// The value that breaks a rule.
    pub fn value(&self) -> Option<f64> {
        match self.of_row() {
            Self::OutOfRange { value, .. } => Some(*value),
            _ => None,
        }
    }

    /// The rule that a value breaks, after "must be".
    pub fn rule(&self) -> Option<&str> {
        match self.of_row() {
            Self::OutOfRange { rule, .. } => Some(rule),
            _ => None,
        }
    }

    /// The known name that is nearest to an unknown one.
    pub fn nearest(&self) -> Option<&str> {
        match self.of_row() {
            Self::Unknown { nearest, .. } => nearest.as_deref(),
            _ => None,
        }
    }

    /// The row of a table that is wrong, from 1.
    pub fn row(&self) -> Option<usize> {
        match self {
            Self::InRow { row, .. } => Some(*row),
            _ => None,
        }
    }

    /// The same error, of a row of a table, from 1.
    #[must_use]
    pub fn in_row(self, row: usize) -> Self {
        Self::InRow { row, error: Box::new(self) }
    }

    /// True if the file system is at fault, not the input.
    pub fn is_io(&self) -> bool {
        matches!(self, Self::Unreadable { .. })
    }
}

/// An entry of a file that cannot be used, and why.
pub(crate) fn bad(key: impl Into<String>, what: impl Into<String>) -> CaseError {
    let (key, what) = (key.into(), what.into());
    CaseError::Entry { what: format!("`{key}`: {what}"), key }
}

/// A text of a user as a message shows it: its beginning, nothing that a terminal obeys.
pub fn brief(text: &str) -> String {
    // About a line; names of the vocabulary are half as long.
    const MOST: usize = 60;
    match text.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}…", text[..end].escape_debug()),
        None => text.escape_debug().to_string(),
    }
}

/// A text with nothing in it that a terminal obeys: control characters, but for line ends, and those
/// that turn the direction of writing stand as their numbers.
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

fn nearest_hint(nearest: Option<&str>) -> String {
    nearest.map_or_else(String::new, |key| format!("; did you mean `{key}`?"))
}

/// "a is", "a and b are", "a, b and c are".
pub(crate) fn list(keys: &[String]) -> String {
    match keys {
        [] => "nothing is".to_owned(),
        [one] => format!("{one} is"),
        [rest @ .., last] => format!("{} and {last} are", rest.join(", ")),
    }
}
