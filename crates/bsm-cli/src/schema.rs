//! `bsm schema`: what files and results look like.

use bsm_case::{input_schema, output_schema, result_schema};
use clap::ValueEnum;
use serde_json::{Map, Value, json};

use crate::args::SchemaKind;
use crate::failure::Failure;
use crate::files::{pretty_json, print};

pub(crate) fn run(kind: SchemaKind) -> Result<(), Failure> {
    let schema = match kind {
        SchemaKind::Input => input_schema(),
        SchemaKind::Output => output_schema(),
        SchemaKind::Validate => validate(),
        SchemaKind::Tradeoff => tradeoff(),
        command => {
            let name = command.to_possible_value();
            name.and_then(|name| result_schema(name.get_name())).unwrap_or(Value::Bool(true))
        }
    };
    print(&pretty_json(&schema))
}

/// An object with these properties and no other.
fn object<const N: usize>(properties: [(&str, Value); N]) -> Value {
    let names = properties.each_ref().map(|(name, _)| *name);
    let properties: Map<_, _> =
        properties.into_iter().map(|(name, schema)| (name.to_owned(), schema)).collect();
    json!({
        "type": "object",
        "properties": properties,
        "required": names.to_vec(),
        "additionalProperties": false,
    })
}

fn of_type(name: &str) -> Value {
    json!({ "type": name })
}

fn or_null(name: &str) -> Value {
    json!({ "type": [name, "null"] })
}

fn list(items: &Value) -> Value {
    json!({ "type": "array", "items": items })
}

fn validate() -> Value {
    let texts = ["key", "source", "claim", "unit", "criterion", "note", "details"];
    let [key, source, claim, unit, criterion, note, details] =
        texts.map(|name| (name, of_type("string")));
    let check = object([
        key,
        source,
        claim,
        ("claimed", or_null("number")),
        ("measured", or_null("number")),
        unit,
        criterion,
        note,
        details,
        ("verdict", json!({ "enum": ["pass", "fail", "finding"] })),
    ]);
    object([
        ("program", of_type("string")),
        ("passed", of_type("boolean")),
        ("checks", list(&check)),
    ])
}

fn tradeoff() -> Value {
    let (text, number) = (|| of_type("string"), || of_type("number"));
    let quantiles = object([("median", number()), ("q99", number()), ("max", number())]);
    let quantiles = json!({ "anyOf": [quantiles, of_type("null")] });
    let errors = object([
        ("group", text()),
        ("solved", number()),
        ("efficiency", quantiles.clone()),
        ("torque", quantiles.clone()),
        ("loads", quantiles.clone()),
        ("angles_deg", quantiles),
        ("bound_broken", or_null("number")),
    ]);
    let one_core = object([("group", text()), ("single", number()), ("batch", number())]);
    let sets = json!({ "type": "array", "prefixItems": [text(), number()], "items": false });
    let times = object([
        ("one_core", list(&one_core)),
        ("all_cores", number()),
        ("instruction_sets", list(&sets)),
    ]);
    let dial = object([
        ("model", text()),
        ("options", text()),
        ("errors", list(&errors)),
        ("times", times),
    ]);
    let pick = object([("dial", text()), ("ns", number()), ("fails_where", list(&text()))]);
    let pick = json!({ "anyOf": [pick, of_type("null")] });
    let advice = object([
        ("tolerance", number()),
        ("group", text()),
        ("single", pick.clone()),
        ("batch", pick),
    ]);
    let measured = object([
        ("reference", text()),
        ("points", list(&object([("group", text()), ("points", of_type("integer"))]))),
        ("without_reference", list(&of_type("integer"))),
        ("instruction_set", text()),
        ("threads", of_type("integer")),
        ("dials", list(&dial)),
        ("advice", list(&advice)),
    ]);
    object([("program", text()), ("tradeoff", measured)])
}
