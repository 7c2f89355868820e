//! What can be wrong with a scene: which key, which value, what is required.

use std::io;
use std::path::PathBuf;

use bsm_dyn::Model;
use bsm_nut::NutError;
use thiserror::Error;

use crate::exact;

/// A scene, a setting or a grid that cannot be used.
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
    /// An input under the same name twice, in two units, or in two forms.
    #[error("{}", twice(names))]
    GivenTwice {
        /// Both names.
        names: [String; 2],
    },
    /// A value of the wrong type.
    #[error("`{key}` is {found}, but must be {expected}")]
    WrongType {
        /// The key.
        key: String,
        /// Found.
        found: String,
        /// Expected.
        expected: String,
    },
    /// A number outside its range.
    #[error("`{key}` = {} must be {rule}", exact(*value))]
    OutOfRange {
        /// The key.
        key: String,
        /// Its value.
        value: f64,
        /// The rule as text.
        rule: String,
    },
    /// An entry of a file that cannot be used.
    #[error("`{key}`: {what}")]
    BadEntry {
        /// The key.
        key: String,
        /// Reason.
        what: String,
    },
    /// Inputs are not given.
    #[error("{} required {by}", list(missing))]
    Missing {
        /// The keys.
        missing: Vec<String>,
        /// By what, or what for.
        by: String,
    },
    /// An axis has no warm steady state.
    #[error("no warm steady state: {0}")]
    NoWarmState(Box<bsm_nut::thermal::NoSteadyState>),
    /// A nut that does not carry its load, or whose preload cannot be set.
    #[error("{0}")]
    Nut(NutError),
    /// Where to look for an input is not known.
    #[error("`{key}` is not in the scene, and no range to search is given")]
    NoRange {
        /// The input.
        key: &'static str,
    },
    /// A range that is empty or outside the allowed values.
    #[error("range: {low} to {high} is not a range of allowed values of `{key}`")]
    BadRange {
        /// The input.
        key: &'static str,
        /// Its beginning.
        low: f64,
        /// Its end.
        high: f64,
    },
    /// A model without a motion of the ball, where one is to be analysed.
    #[error(
        "model {model} has no motion of the ball, which this analysis needs; {}",
        if missing.is_empty() {
            "models rigid, raceway-control, elastic and traction have one".to_owned()
        } else {
            format!("{} required by model rigid, the simplest that has one", list(missing))
        }
    )]
    NoMotion {
        /// The model.
        model: &'static str,
        /// Missing inputs of the simplest model with a motion.
        missing: Vec<String>,
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
    /// A word that is none of a few.
    #[error("unknown {kind} `{name}`; the {kind}s are {known}")]
    UnknownWord {
        /// Of what.
        kind: &'static str,
        /// The word.
        name: String,
        /// All possible texts.
        known: String,
    },
    /// A setting or axis on the command line that cannot be read.
    #[error("`{}` is not of the form {form}", brief(text))]
    BadSetting {
        /// Given value.
        text: String,
        /// Expected value.
        form: &'static str,
    },
    /// A model does not cover what the scene asks for.
    #[error("`{key}` = {} must be {rule} for model {model}", exact(*value))]
    NotCovered {
        /// The key.
        key: &'static str,
        /// Its value.
        value: f64,
        /// Range of the model.
        rule: &'static str,
        /// The model.
        model: &'static str,
    },
}

/// Kinds of names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Known {
    /// Inputs of a scene.
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
        Self::OutOfRange { key: key.into(), value, rule: rule.into() }
    }

    /// Inputs that are not given, and by what or what for they are required.
    pub(crate) fn missing(missing: Vec<String>, by: impl Into<String>) -> Self {
        Self::Missing { missing, by: by.into() }
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

    /// An input that is given by these names.
    pub(crate) fn given_twice(names: [&str; 2]) -> Self {
        Self::GivenTwice { names: names.map(str::to_owned) }
    }

    /// An input whose value is some text.
    pub fn not_a_number(key: &str, text: &str) -> Self {
        let found = format!("`{}`", brief(text));
        Self::WrongType { key: key.to_owned(), found, expected: "a number".to_owned() }
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
        Some(match self.of_row() {
            Self::WrongType { key, .. }
            | Self::OutOfRange { key, .. }
            | Self::BadEntry { key, .. } => key,
            Self::NoRange { key } | Self::BadRange { key, .. } | Self::NotCovered { key, .. } => {
                key
            }
            Self::GivenTwice { names: [_, name] }
            | Self::Unknown { name, .. }
            | Self::UnknownWord { name, .. } => name,
            Self::Missing { missing, .. } => missing.first()?,
            _ => return None,
        })
    }

    /// The value that breaks a rule.
    pub fn value(&self) -> Option<f64> {
        match self.of_row() {
            Self::OutOfRange { value, .. } | Self::NotCovered { value, .. } => Some(*value),
            _ => None,
        }
    }

    /// The rule that a value breaks, after "must be".
    pub fn rule(&self) -> Option<&str> {
        match self.of_row() {
            Self::OutOfRange { rule, .. } => Some(rule),
            Self::NotCovered { rule, .. } => Some(rule),
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
    CaseError::BadEntry { key: key.into(), what: what.into() }
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

fn twice([one, other]: &[String; 2]) -> String {
    if one == other {
        format!("`{}` is given twice; give it once", brief(one))
    } else {
        format!("give one of {one} and {other}; both are given")
    }
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
