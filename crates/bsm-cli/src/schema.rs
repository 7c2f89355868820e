//! `bsm schema`: JSON Schemas of files and answers, and the unit suffixes that input names may
//! have. The schemas are derived from the same structs and tables as the answers.

#[cfg(any(feature = "parquet", feature = "validate"))]
use bsm_case::ObjectSchema;
use bsm_case::units::units_by_quantity;
use bsm_case::{AnswerSchema, input_schema, output_schema};
#[cfg(feature = "validate")]
use bsm_validate::ReportJson;
use serde_json::{Value, json};

use crate::failure::Failure;
use crate::files::{pretty_json, print};
#[cfg(feature = "parquet")]
use crate::parts::PartsJson;
#[cfg(feature = "validate")]
use crate::tradeoff::TradeoffJson;

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
