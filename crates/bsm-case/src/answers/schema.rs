//! JSON schemas of cases and results, generated from the same tables that the program uses for
//! checking and output.

use schemars::JsonSchema;
use schemars::generate::{Contract, SchemaSettings};
use serde_json::{Map, Value, json};

use crate::{AnalysisKind, CaseEntries, INPUTS, OUTPUTS, Output, Rule};

const DIALECT: &str = "https://json-schema.org/draft/2020-12/schema";

/// Returns the JSON schemas of the members of a type that is read or written, as `contract` states.
pub fn derived_schema<T: JsonSchema>(contract: Contract) -> Value {
    let settings = SchemaSettings::draft2020_12().with(|settings| {
        settings.contract = contract;
        settings.inline_subschemas = true;
    });
    settings.into_generator().into_root_schema_for::<T>().remove("properties").unwrap_or_default()
}

/// Returns the JSON schema of a case.
pub fn input_schema() -> Value {
    let mut properties = Map::new();
    let text = json!({ "type": "string", "description": "free text" });
    properties.insert("description".to_owned(), text);
    for input in INPUTS {
        let kind = if matches!(input.rule, Rule::Whole(_)) { "integer" } else { "number" };
        let about = with_unit(input.about, input.unit);
        let mut property = json!({ "type": [kind, "null"], "description": about });
        let mut set = |name: &str, value: Value| property[name] = value;
        match input.rule {
            Rule::Any => {}
            Rule::OneOf(numbers) => {
                let numbers = numbers.iter().map(|number| json!(number));
                set("enum", numbers.chain([Value::Null]).collect());
            }
            Rule::Above(low) => set("exclusiveMinimum", json!(low)),
            Rule::AtLeast(low) | Rule::Whole(low) => set("minimum", json!(low)),
            Rule::Within(low, high) => {
                set("minimum", json!(low));
                set("maximum", json!(high));
            }
            Rule::Between(low, high) => {
                set("exclusiveMinimum", json!(low));
                set("exclusiveMaximum", json!(high));
            }
        }
        if let Some(default) = input.default {
            set("default", json!(default));
        }
        properties.insert(input.name.to_owned(), property);
    }
    if let Value::Object(entries) = derived_schema::<CaseEntries>(Contract::Deserialize) {
        properties.extend(entries);
    }
    json!({
        "$schema": DIALECT,
        "title": "bsm case",
        "description": "one operating point of a ball screw; each model states the inputs that it needs",
        "type": "object",
        "properties": properties,
        "additionalProperties": false,
    })
}

/// Returns the JSON schema of a result.
pub fn output_schema() -> Value {
    let of_the_solve = json!({
        "model": { "type": "string", "description": "model that calculated the result" },
        "status": {
            "enum": ["converged", "no_solution", "not_converged", "invalid_input"],
            "description": "status of the solution",
        },
        "message": {
            "type": ["string", "null"],
            "description": "reason why numbers are missing, otherwise null; in table rows, also the reason why model auto chose its model",
        },
        "choice": { "type": ["string", "null"], "description": "reason why model auto chose this model, otherwise null" },
        "without_error_bound": {
            "type": ["array", "null"],
            "items": { "type": "string" },
            "description": "outputs without an error bound in a result whose efficiency has an error bound; null if there are none",
        },
    });
    let mut properties = of_the_solve.as_object().cloned().unwrap_or_default();
    properties.extend(OUTPUTS.iter().map(property));
    let columns = |kind: AnalysisKind| {
        let about = format!("results of {}, which can be columns of bsm sweep", kind.name());
        let properties: Map<_, _> = kind.columns().map(property).collect();
        let columns = json!({ "type": "object", "description": about, "properties": properties });
        (kind.name().to_owned(), columns)
    };
    let analyses: Map<_, _> = AnalysisKind::ALL.into_iter().map(columns).collect();
    let required: Vec<_> = properties.keys().cloned().collect();
    json!({
        "$schema": DIALECT,
        "title": "bsm result",
        "description": "result of a model at one operating point; null for outputs that the model does not calculate",
        "type": "object",
        "properties": properties,
        "required": required,
        "$defs": analyses,
    })
}

/// Returns the name and the schema of an output.
fn property(output: &Output) -> (String, Value) {
    let mut property = json!({
        "type": [output.json_type, "null"],
        "description": with_unit(output.about, output.unit),
    });
    if !output.words.is_empty() {
        let words = output.words.iter().map(|word| json!(word));
        property["enum"] = words.chain([Value::Null]).collect();
    }
    (output.name.to_owned(), property)
}

fn with_unit(about: &str, unit: &str) -> String {
    if unit.is_empty() { about.to_owned() } else { format!("{about} [{unit}]") }
}
