//! `bsm schema`: JSON Schemas of files and answers, and the unit suffixes that input names may
//! have. The schemas are derived from the same structs and tables as the answers.

#[cfg(any(feature = "parquet", feature = "validate"))]
use bsm_case::ObjectSchema;
use bsm_case::units::units_by_quantity;
use bsm_case::{AnswerSchema, input_schema, output_schema};
#[cfg(feature = "validate")]
use bsm_validate::{ReportJson, tradeoff::Tradeoff};
#[cfg(any(feature = "parquet", feature = "validate"))]
use schemars::JsonSchema;
#[cfg(any(feature = "parquet", feature = "validate"))]
use serde::Serialize;
use serde_json::{Value, json};

use crate::failure::Failure;
use crate::files::{pretty_json, print};

/// State of the parts of a dataset, in JSON.
#[cfg(feature = "parquet")]
#[derive(Serialize, JsonSchema)]
pub(crate) struct PartsJson {
    /// Identifier of the plan.
    pub(crate) plan: String,
    /// Number of parts of the plan.
    pub(crate) parts: u64,
    /// Number of finished parts.
    pub(crate) finished: u64,
    /// True if all parts are finished.
    pub(crate) complete: bool,
    /// True if all bytes of the parts were read and verified.
    pub(crate) deep: bool,
    /// Ranges of the numbers of missing parts.
    pub(crate) missing: Vec<String>,
    pub(crate) damaged: Vec<Damage>,
    /// Files that do not belong to the dataset.
    pub(crate) foreign: Vec<String>,
    /// Number of rows in the finished parts.
    pub(crate) rows: u64,
    /// Number of rows without a result.
    pub(crate) failed: u64,
    /// Number of rows with several solutions.
    pub(crate) several: u64,
}

/// A damaged part.
#[cfg(feature = "parquet")]
#[derive(Serialize, JsonSchema)]
pub(crate) struct Damage {
    pub(crate) file: String,
    pub(crate) reason: String,
}

/// Measured times and errors, in JSON.
#[cfg(feature = "validate")]
#[derive(Serialize, JsonSchema)]
pub(crate) struct TradeoffJson<'a> {
    /// Name and version of the program.
    pub(crate) program: &'static str,
    pub(crate) tradeoff: &'a Tradeoff,
}

/// Schemas of the answers that are not calculated from a single case.
const OTHER_SCHEMAS: &[AnswerSchema] = &[
    #[cfg(feature = "parquet")]
    AnswerSchema::of("parts", "parts check", || vec![ObjectSchema::answer::<PartsJson>().json()]),
    #[cfg(feature = "validate")]
    AnswerSchema::of("validate", "validate", || {
        vec![ObjectSchema::answer::<ReportJson<'_>>().json()]
    }),
    #[cfg(feature = "validate")]
    AnswerSchema::of("tradeoff", "tradeoff", || {
        vec![ObjectSchema::answer::<TradeoffJson<'_>>().json()]
    }),
];

/// Returns the schemas of all answers.
fn answers() -> impl Iterator<Item = &'static AnswerSchema> {
    AnswerSchema::ALL.iter().chain(OTHER_SCHEMAS)
}

/// Returns the names of all JSON Schemas.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    ["input", "output", "units"].into_iter().chain(answers().map(|answer| answer.name))
}

pub(crate) fn run(name: Option<&str>) -> Result<(), Failure> {
    let Some(name) = name else { return print(&names().collect::<Vec<_>>().join("\n")) };
    print(&pretty_json(&match name {
        "input" => input_schema(),
        "output" => output_schema(),
        "units" => units(),
        other => match answers().find(|answer| answer.name == other) {
            Some(answer) => answer.json(),
            None => return Err(Failure::Input(format!("no schema is named {other}"))),
        },
    }))
}

/// Returns the unit suffixes for each quantity. The first suffix is the one used in the names of
/// inputs and outputs.
fn units() -> Value {
    units_by_quantity().map(|(quantity, units)| (quantity.to_owned(), json!(units))).collect()
}
