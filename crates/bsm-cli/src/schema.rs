//! `bsm schema`: JSON Schemas of files and answers, and the unit suffixes that input names may
//! have. The schemas are derived from the same structs and tables as the answers.

use bsm_case::units::units_by_quantity;
use bsm_case::{AnswerSchema, ObjectSchema, input_schema, output_schema};
use bsm_validate::ReportJson;
use serde_json::{Value, json};

use crate::failure::Failure;
use crate::files::{pretty_json, print};
use crate::parts::PartsJson;
use crate::tradeoff::TradeoffJson;

/// Schemas of the answers that are not calculated from a case.
const OTHERS: [AnswerSchema; 3] = [
    AnswerSchema::of("parts", "parts check", || vec![ObjectSchema::answer::<PartsJson>().json()]),
    AnswerSchema::of("validate", "validate", || {
        vec![ObjectSchema::answer::<ReportJson<'_>>().json()]
    }),
    AnswerSchema::of("tradeoff", "tradeoff", || {
        vec![ObjectSchema::answer::<TradeoffJson<'_>>().json()]
    }),
];

/// Returns the schemas of all answers.
fn answers() -> impl Iterator<Item = AnswerSchema> {
    AnswerSchema::ALL.into_iter().chain(OTHERS)
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
