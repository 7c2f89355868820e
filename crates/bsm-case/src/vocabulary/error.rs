//! What can be wrong with a scene: which key, which value, what is required.

use std::io;
use std::path::PathBuf;

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
    /// There is nothing in it.
    #[error("is empty; a scene is a JSON object of inputs such as {{\"ball_diameter_mm\": 6.35}}")]
    Empty,
    /// Not JSON.
    #[error("is not valid JSON: {0}")]
    Syntax(#[source] serde_json::Error),
    /// JSON, but not an object.
    #[error(
        "is JSON {found}, but a scene is a JSON object of inputs such as {{\"ball_diameter_mm\": 6.35}}"
    )]
    NotAnObject {
        /// Kind of JSON value found.
        found: &'static str,
    },
    /// A name that is not known.
    #[error("{} `{}`{}", known.words(), brief(name), nearest_hint(nearest.as_deref()))]
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
    /// Friction by a coefficient, and from a lubricant.
    #[error(
        "give friction_coefficient or a lubricant, not both: friction_coefficient and {key} are given"
    )]
    FrictionTwice {
        /// The first input of the lubricant.
        key: &'static str,
    },
    /// A model in which friction is a coefficient.
    #[error(
        "model {model} takes no lubricant: models raceway-control and traction do; others take the \
         equivalent_friction_coefficient of their result as friction_coefficient"
    )]
    NoLubricant {
        /// The model.
        model: &'static str,
    },
    /// Jamming with a lubricant.
    #[error(
        "jam compares one friction coefficient with the critical ones, and a lubricant has several{found}; give one as \
         friction_coefficient in place of the lubricant"
    )]
    OiledJam {
        /// The coefficients, if they are known.
        found: String,
    },
    /// An oil that is thicker when it is hotter.
    #[error(
        "viscosity_100C_mm2_s = {hot} must be below viscosity_40C_mm2_s = {warm}: viscosity decreases with temperature"
    )]
    OilThickens {
        /// At 40 C.
        warm: f64,
        /// At 100 C.
        hot: f64,
    },
    /// An axis has no warm steady state.
    #[error("no warm steady state: {0}")]
    NoWarmState(Box<bsm_nut::thermal::NoSteadyState>),
    /// A nut that does not carry its load, or whose preload cannot be set.
    #[error("{0}")]
    Nut(NutError),
    /// A model whose ball is not one of a nut.
    #[error(
        "model {model} does not calculate the balls of a nut: models auto, raceway-control, elastic and traction give \
         the friction of the balls of a nut"
    )]
    NoBallOfANut {
        /// The model.
        model: &'static str,
    },
    /// Ratings of another nut than that of the groove.
    #[error(
        "`{key}` = {stated} N, but the groove has {calculated:.0} N: the geometry is that of another nut; correct it, leave it \
         out, or set keep_ratings=true"
    )]
    RatingsDiffer {
        /// The rating.
        key: &'static str,
        /// As the manufacturer states it \[N\].
        stated: f64,
        /// By the geometry \[N\].
        calculated: f64,
    },
    /// One of two keys is needed.
    #[error("give one of {} and {}; {found} given", keys[0], keys[1])]
    OneOfTwo {
        /// The keys.
        keys: [&'static str; 2],
        /// Which are given, with the verb.
        found: &'static str,
    },
    /// No lead angle makes a contact angle the best one.
    #[error(
        "no lead angle has its best efficiency at contact_angle_deg = {contact_angle_deg}; give a larger one, lead_mm or \
         lead_angle_deg"
    )]
    NoBestLead {
        /// The contact angle.
        contact_angle_deg: f64,
    },
    /// Conformities that differ.
    #[error(
        "nut_conformity = {nut} and screw_conformity = {screw} differ; a design has one for both: give \
         only one of them"
    )]
    TwoConformities {
        /// At the nut.
        nut: f64,
        /// At the screw.
        screw: f64,
    },
    /// An output that a model does not have.
    #[error(
        "model {model} gives no {output} here{}",
        if missing.is_empty() { String::new() } else { format!("; {} required by model traction", list(missing)) }
    )]
    NoOutput {
        /// The output.
        output: &'static str,
        /// The model.
        model: &'static str,
        /// Missing inputs of the most complete model.
        missing: Vec<String>,
    },
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
    /// A table that cannot be used.
    #[error("{what}")]
    Table {
        /// Which row, and what is required.
        what: String,
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
    /// A row of a table that cannot be used.
    #[error("row {row}: {error}")]
    InRow {
        /// Its number, from 1.
        row: usize,
        /// Why.
        error: Box<Self>,
    },
    /// A column that no row could fill.
    #[error("column {column} would be empty: {} required for it", list(missing))]
    EmptyColumn {
        /// The column.
        column: &'static str,
        /// Inputs that lack.
        missing: Vec<String>,
    },
    /// The grooves leave no contact that can be rated.
    #[error("{0}")]
    NotRated(String),
    /// Lead and lead angle disagree.
    #[error(
        "lead_angle_deg = {lead_angle_deg} and lead_mm = {lead_mm} disagree: on this pitch circle \
         a lead of {lead_mm} mm is an angle of {implied_deg} deg; give one of the two"
    )]
    LeadConflict {
        /// The angle given.
        lead_angle_deg: f64,
        /// The lead given.
        lead_mm: f64,
        /// The angle that the lead means.
        implied_deg: f64,
    },
    /// The balls do not fit on the pitch circle.
    #[error(
        "ball_diameter_mm = {ball_diameter_mm} must be smaller than the radius of the pitch circle, \
         pitch_circle_diameter_mm / 2 = {pitch_radius_mm}"
    )]
    BallTooLarge {
        /// The ball.
        ball_diameter_mm: f64,
        /// Half the pitch circle diameter.
        pitch_radius_mm: f64,
    },
    /// Screw and nut turn together.
    #[error(
        "screw_speed_rpm = {screw_rpm} and nut_speed_rpm = {nut_rpm} are equal: their difference \
         must not be 0"
    )]
    NoRelativeSpeed {
        /// Screw speed.
        screw_rpm: f64,
        /// Nut speed.
        nut_rpm: f64,
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
    /// A result that no double holds.
    #[error(
        "{output} is outside the range of double precision; check the magnitudes of the inputs"
    )]
    BeyondDouble {
        /// The output.
        output: &'static str,
    },
    /// More points than can be counted.
    #[error("the grid has more than {limit} points; use fewer values per axis")]
    GridTooLarge {
        /// The limit.
        limit: usize,
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
    fn words(self) -> &'static str {
        match self {
            Self::Input | Self::List | Self::Requirement => "unknown key",
            Self::Column => "no column is named",
            Self::Output => "no numeric output is named",
        }
    }
}

impl CaseError {
    /// A name that is not known, with the nearest that is.
    pub(crate) fn unknown(known: Known, name: &str, nearest: Option<&str>) -> Self {
        Self::Unknown { known, name: name.to_owned(), nearest: nearest.map(str::to_owned) }
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

    /// The input or column that it is about, if it is about one.
    pub fn key(&self) -> Option<&str> {
        Some(match self {
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
            Self::InRow { error, .. } => return error.key(),
            _ => return None,
        })
    }

    /// The value that breaks a rule.
    pub fn value(&self) -> Option<f64> {
        match self {
            Self::OutOfRange { value, .. } | Self::NotCovered { value, .. } => Some(*value),
            Self::InRow { error, .. } => error.value(),
            _ => None,
        }
    }

    /// The rule that a value breaks, after "must be".
    pub fn rule(&self) -> Option<&str> {
        match self {
            Self::OutOfRange { rule, .. } => Some(rule),
            Self::NotCovered { rule, .. } => Some(rule),
            Self::InRow { error, .. } => error.rule(),
            _ => None,
        }
    }

    /// The known name that is nearest to an unknown one.
    pub fn nearest(&self) -> Option<&str> {
        match self {
            Self::Unknown { nearest, .. } => nearest.as_deref(),
            Self::InRow { error, .. } => error.nearest(),
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
fn list(keys: &[String]) -> String {
    match keys {
        [] => "nothing is".to_owned(),
        [one] => format!("{one} is"),
        [rest @ .., last] => format!("{} and {last} are", rest.join(", ")),
    }
}
