//! Errors in case files and settings. Each error states the key, the value and the violated
//! requirement.

use std::io;
use std::path::PathBuf;

use bsm_dyn::Model;
use bsm_nut::NutError;
use bsm_nut::thermal::NoSteadyState;
use thiserror::Error;

use super::units::units_of_stem;
use crate::{InputKey, OtherSeparator, format_exact, nearest};

/// Error in a case, a setting or a grid.
///
/// The message does not contain the name of the file, command or option. The caller adds this name.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CaseError {
    /// The file cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Unreadable {
        /// Path of the file that cannot be read.
        path: PathBuf,
        /// Error that the operating system reported.
        source: io::Error,
    },
    /// The file is not valid JSON.
    #[error("is not valid JSON: {0}")]
    Syntax(#[source] serde_json::Error),
    /// The name of an input, an output or a column is unknown.
    #[error("{} `{}`{}", kind.text(), brief(name), nearest_hint(name, nearest.as_deref()))]
    Unknown {
        /// Kind of the unknown name.
        kind: NameKind,
        /// The unknown name.
        name: String,
        /// Known name that is most similar to the unknown name.
        nearest: Option<String>,
    },
    /// The column names of a table are separated by an unexpected character.
    #[error(transparent)]
    Separator(OtherSeparator),
    /// A number is outside its permitted range or outside the range of a model.
    #[error("`{key}` = {} must be {rule}{}", format_exact(*value), for_model(*model))]
    OutOfRange {
        /// Name of the input or setting with the invalid value.
        key: String,
        /// Invalid value.
        value: f64,
        /// Permitted range as a phrase that follows "must be".
        rule: String,
        /// Name of the model that limits the range, if the range depends on the model.
        model: Option<&'static str>,
    },
    /// An input is invalid or missing.
    #[error("{what}")]
    Entry {
        /// Name of the invalid or missing input.
        key: String,
        /// Message about the invalid or missing input.
        what: String,
    },
    /// An axis has no warm steady state.
    #[error("no warm steady state: {0}{hint}", hint = remedy_of_no_state(.0))]
    NoWarmState(Box<NoSteadyState>),
    /// A nut cannot carry its load, or its preload cannot be set.
    #[error("{0}")]
    Nut(NutError),
    /// No typical groove has the given load ratings, so no groove can be estimated.
    #[error("{0}")]
    NoGroove(String),
    /// The default search range of an input is not known.
    #[error("`{key}` has no value in the case, and no search range is given")]
    NoRange {
        /// Name of the input without a search range.
        key: &'static str,
    },
    /// The inputs contradict each other, or no result can be calculated from them.
    #[error("{0}")]
    Invalid(String),
    /// A row of a table is invalid.
    #[error("row {row}: {error}")]
    InRow {
        /// Number of the row, counted from 1.
        row: usize,
        /// Error that occurred in this row.
        error: Box<Self>,
    },
}

/// Kinds of names that can be unknown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NameKind {
    /// Names of the inputs of a case.
    Input,
    /// Names of the lists that a catalog contains.
    List,
    /// Names of the columns in a list of nuts.
    Column,
    /// Names of the columns in a manufacturer's table.
    TableColumn,
    /// Names of the keys of a requirement.
    Requirement,
    /// Names of the numeric outputs.
    Output,
}

impl NameKind {
    fn text(self) -> &'static str {
        match self {
            Self::Input | Self::List | Self::Requirement => "unknown key",
            Self::Column => "no column is named",
            Self::TableColumn => "unknown column",
            Self::Output => "no numeric output is named",
        }
    }
}

/// Predicate of the message about a model that supports only a friction coefficient.
pub(crate) const NO_LUBRICANT: &str = "does not support a lubricant, but models raceway-control and traction do; otherwise, set \
    friction_coefficient to the equivalent_friction_coefficient of their result";

impl CaseError {
    /// Creates the error for a result outside the range of double precision.
    pub(crate) fn beyond_double(output: &str) -> Self {
        Self::Invalid(format!(
            "{output} is outside the range of double precision; check the magnitudes of the inputs"
        ))
    }

    /// Creates the error for a model that supports only a friction coefficient.
    pub(crate) fn no_lubricant(model: Model) -> Self {
        Self::Invalid(format!("model {} {NO_LUBRICANT}", model.name()))
    }

    /// Creates the error for a number outside its permitted range.
    pub(crate) fn out_of_range(
        key: impl Into<String>,
        value: f64,
        rule: impl Into<String>,
    ) -> Self {
        Self::OutOfRange { key: key.into(), value, rule: rule.into(), model: None }
    }

    /// Creates the error for a value outside the range of a model.
    pub(crate) fn not_covered(key: InputKey, value: f64, rule: &str, model: Model) -> Self {
        let (key, rule) = (key.name().to_owned(), rule.to_owned());
        Self::OutOfRange { key, value, rule, model: Some(model.name()) }
    }

    fn entry(key: &str, what: String) -> Self {
        Self::Entry { key: key.to_owned(), what }
    }

    /// Creates the error for missing inputs. `by` is a phrase that names the model or analysis that
    /// requires them.
    pub(crate) fn missing(missing: &[String], by: &str) -> Self {
        let what = format!("{} required {by}", list(missing));
        match missing {
            [] => Self::Invalid(what),
            [first, ..] => Self::entry(first, what),
        }
    }

    /// Creates the error for an analysis of the ball motion with a model that does not calculate
    /// the ball motion.
    ///
    /// * `missing`: missing inputs of the simplest model that calculates the motion of the ball.
    pub(crate) fn no_motion(model: Model, missing: &[String]) -> Self {
        let others = match missing {
            [] => "use model rigid, raceway-control, elastic or traction".to_owned(),
            missing => {
                format!(
                    "{} required by model rigid, the simplest model that calculates the motion",
                    list(missing)
                )
            }
        };
        let model = model.name();
        Self::Invalid(format!(
            "model {model} does not calculate the motion of the ball, which this analysis needs; {others}"
        ))
    }

    /// Creates the error for a text that is not one of the known values. The message suggests the
    /// most similar known value.
    ///
    /// * `key`: name of the option.
    /// * `kind`: noun that the message uses for the values, such as "model".
    pub(crate) fn unknown_word(key: &str, kind: &str, name: &str, known: &[&str]) -> Self {
        let near = nearest(name, known.iter().copied());
        let hint =
            near.map_or_else(|| "the".to_owned(), |near| format!("did you mean `{near}`? The"));
        let known = known.join(", ");
        Self::entry(key, format!("unknown {kind} `{name}`; {hint} {kind}s are {known}"))
    }

    /// Creates the error for a setting or a grid axis that cannot be parsed.
    pub fn bad_setting(text: &str, form: &str) -> Self {
        Self::Invalid(format!("`{}` does not have the form {form}", brief(text)))
    }

    /// Creates the error for a value of the wrong type.
    pub(crate) fn wrong_type(key: &str, found: &str, expected: &str) -> Self {
        Self::entry(key, format!("`{key}` is {found}, but must be {expected}"))
    }

    /// Creates the error for a grid with too many points to count.
    pub(crate) fn grid_too_large(limit: usize) -> Self {
        Self::Invalid(format!("the grid has more than {limit} points; use fewer values per axis"))
    }

    /// Creates the error for an unknown name. The message suggests the most similar known name.
    pub(crate) fn unknown(kind: NameKind, name: &str, nearest: Option<&str>) -> Self {
        Self::Unknown { kind, name: name.to_owned(), nearest: nearest.map(str::to_owned) }
    }

    /// Creates the error for two alternative keys that are both missing.
    pub(crate) fn neither([one, other]: [&str; 2]) -> Self {
        Self::Invalid(format!("give either {one} or {other}; neither is given"))
    }

    /// Creates the error for an input that is given in two units, or twice with the same name.
    pub(crate) fn same_input(one: &str, other: &str) -> Self {
        if one == other {
            return Self::given_twice([one, other]);
        }
        let [first, second] = [one, other].map(brief);
        let what = format!("`{first}` and `{second}` are the same input; give one of them");
        Self::entry(other, what)
    }

    /// Creates the error for a quantity that is given in two forms, or for an input that is given
    /// twice with the same name.
    pub(crate) fn given_twice([one, other]: [&str; 2]) -> Self {
        let what = if one == other {
            format!("`{}` is given twice; give it once", brief(one))
        } else {
            format!("give either {one} or {other}; both are given")
        };
        Self::entry(other, what)
    }

    /// Creates the error for an invalid value, with the message of the parser that rejected the
    /// value.
    pub(crate) fn of_value(key: &str, error: &str) -> Self {
        Self::entry(key, format!("`{key}`: {error}"))
    }

    /// Creates the error for a text in place of a number.
    pub fn not_a_number(key: &str, text: &str) -> Self {
        Self::wrong_type(key, &format!("`{}`", brief(text)), "a number")
    }

    /// Returns the underlying error if this error belongs to a table row. Other errors are returned
    /// unchanged.
    fn of_row(&self) -> &Self {
        match self {
            Self::InRow { error, .. } => error.of_row(),
            _ => self,
        }
    }

    /// Returns the name of the input or column that caused the error, if the name is known.
    pub fn key(&self) -> Option<&str> {
        match self.of_row() {
            Self::OutOfRange { key, .. } | Self::Entry { key, .. } => Some(key),
            Self::NoRange { key } => Some(key),
            Self::Unknown { name, .. } => Some(name),
            _ => None,
        }
    }

    /// Returns the value that violates a rule, if the error is a range error.
    pub fn value(&self) -> Option<f64> {
        match self.of_row() {
            Self::OutOfRange { value, .. } => Some(*value),
            _ => None,
        }
    }

    /// Returns the violated rule as a phrase that follows "must be", if the error is a range error.
    pub fn rule(&self) -> Option<&str> {
        match self.of_row() {
            Self::OutOfRange { rule, .. } => Some(rule),
            _ => None,
        }
    }

    /// Returns the known name that is most similar to an unknown name, if the error suggests one.
    pub fn nearest(&self) -> Option<&str> {
        match self.of_row() {
            Self::Unknown { nearest, .. } => nearest.as_deref(),
            _ => None,
        }
    }

    /// Returns the number of the invalid table row, counted from 1.
    pub fn row(&self) -> Option<usize> {
        match self {
            Self::InRow { row, .. } => Some(*row),
            _ => None,
        }
    }

    /// Returns this error with the number of the table row in which it occurred. Rows are counted
    /// from 1.
    #[must_use]
    pub fn in_row(self, row: usize) -> Self {
        Self::InRow { row, error: Box::new(self) }
    }

    /// Returns true if the error comes from the file system.
    pub fn is_io(&self) -> bool {
        matches!(self, Self::Unreadable { .. })
    }
}

/// If no warm state exists because of the friction of the balls, describes changes of inputs with
/// which a warm state may exist.
fn remedy_of_no_state(why: &NoSteadyState) -> &'static str {
    use NoSteadyState::{Jump, NoFriction, NotFound};
    match why {
        NoFriction | Jump { .. } | NotFound => {
            ". Give a larger load or a preload, reduce the speed, or use model raceway-control."
        }
        _ => "",
    }
}

/// Creates the error for an invalid input.
///
/// * `what`: predicate of a sentence whose subject is the key, such as "must be positive".
pub(crate) fn invalid_input(key: impl Into<String>, what: impl Into<String>) -> CaseError {
    let (key, what) = (key.into(), what.into());
    CaseError::Entry { what: format!("`{key}` {what}"), key }
}

/// Returns the beginning of a text that the user entered, for use in a message. Control characters
/// are escaped.
pub fn brief(text: &str) -> String {
    // The limit corresponds to about one line of text, and to twice the length of the longest input
    // name.
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

/// Formats a list of names followed by "is" or "are", for example "a is", "a and b are" or "a, b
/// and c are".
pub(crate) fn list(keys: &[String]) -> String {
    match keys {
        [] => "nothing is".to_owned(),
        [one] => format!("{one} is"),
        [rest @ .., last] => format!("{} and {last} are", rest.join(", ")),
    }
}
