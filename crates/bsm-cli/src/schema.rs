//! `bsm schema`: what files and results look like, from the tables that results are made from.

use bsm_case::{
    AnalysisKind, BALL_COLUMNS, CATALOGUE_COLUMNS, INPUTS, LISTED, OUTPUTS, Of, input_schema,
    output_schema, sheet_columns,
};
use clap::ValueEnum;
use serde_json::{Map, Value, json};

use crate::args::SchemaKind;
use crate::failure::Failure;
use crate::files::{pretty_json, print};

pub(crate) fn run(kind: SchemaKind) -> Result<(), Failure> {
    let schema = match kind {
        SchemaKind::Input => input_schema(),
        SchemaKind::Output => output_schema(),
        command => {
            let name = command.to_possible_value();
            name.and_then(|name| result_schema(name.get_name())).unwrap_or(Value::Bool(true))
        }
    };
    print(&pretty_json(&schema))
}

/// Properties of an object.
type Properties = Vec<(String, Value)>;

/// Schema of the JSON that a command prints; `None` if it prints none, or what is not known here.
fn result_schema(command: &str) -> Option<Value> {
    let schema = match command {
        "solve" => solve(),
        "compare" => compare(),
        "slip" => analysis(AnalysisKind::Slip),
        "jam" => analysis(AnalysisKind::Jam),
        "optimum" => optimum(),
        "capacity" => capacity(),
        "nut" => nut(),
        "size" => size(),
        "fit" => fit(),
        "design" => design(),
        "catalog" => json!({ "anyOf": [catalogue(), makers()] }),
        "validate" => validate(),
        "tradeoff" => tradeoff(),
        _ => return None,
    };
    Some(titled(command, schema))
}

/// A schema with its head.
fn titled(command: &str, schema: Value) -> Value {
    let mut head = Map::new();
    head.insert("$schema".to_owned(), input_schema()["$schema"].clone());
    head.insert("title".to_owned(), json!(format!("result of bsm {command}")));
    if let Value::Object(schema) = schema {
        head.extend(schema);
    }
    Value::Object(head)
}

/// An object with these properties and no other.
fn object(required: Properties, optional: Properties) -> Value {
    let names: Vec<_> = required.iter().map(|(name, _)| name.clone()).collect();
    let properties: Map<_, _> = required.into_iter().chain(optional).collect();
    json!({
        "type": "object",
        "properties": properties,
        "required": names,
        "additionalProperties": false,
    })
}

fn properties<const N: usize>(list: [(&str, Value); N]) -> Properties {
    list.map(|(name, schema)| (name.to_owned(), schema)).into()
}

/// An object of these properties.
fn closed<const N: usize>(list: [(&str, Value); N]) -> Value {
    object(properties(list), Properties::new())
}

fn integer() -> Value {
    json!({ "type": "integer" })
}

fn number() -> Value {
    json!({ "type": "number" })
}

fn number_or_null() -> Value {
    json!({ "type": ["number", "null"] })
}

fn text() -> Value {
    json!({ "type": "string" })
}

fn text_or_null() -> Value {
    json!({ "type": ["string", "null"] })
}

fn flag() -> Value {
    json!({ "type": "boolean" })
}

fn texts() -> Value {
    list(&text())
}

fn list(items: &Value) -> Value {
    json!({ "type": "array", "items": items })
}

/// An object whose names are not known beforehand.
fn map_of(values: &Value) -> Value {
    json!({ "type": "object", "additionalProperties": values })
}

/// A scene as it is written.
fn scene() -> Value {
    let schema = input_schema();
    json!({
        "type": "object",
        "properties": schema["properties"],
        "additionalProperties": false,
    })
}

/// Properties of the result of a model.
fn record() -> Properties {
    let schema = output_schema();
    let properties = schema["properties"].as_object().into_iter().flatten();
    properties.map(|(name, schema)| (name.clone(), schema.clone())).collect()
}

/// Numbers of an analysis, by the names of its columns.
fn columns(kind: AnalysisKind) -> Properties {
    let schema = output_schema();
    let all = &schema["$defs"][kind.name()]["properties"];
    let numbers = kind.columns().filter(|column| column.json_type == "number");
    numbers.map(|column| (column.name.to_owned(), all[column.name].clone())).collect()
}

fn settings() -> Value {
    let dials = [
        ("name", text()),
        ("tolerance", number()),
        ("accuracy", number()),
        ("creep", number()),
        ("control", text_or_null()),
        ("friction", text()),
    ];
    object(properties(dials), Properties::new())
}

fn solve() -> Value {
    let mut required = record();
    required.extend(properties([
        ("program", text()),
        ("inputs", scene()),
        ("settings", settings()),
        ("regime", text_or_null()),
        ("warnings", texts()),
    ]));
    let derivatives = properties([
        ("efficiency", number()),
        ("screw_torque_Nm", number_or_null()),
        ("efficiency_relative", number_or_null()),
        ("screw_torque_relative", number_or_null()),
    ]);
    let sensitivities: Properties = INPUTS
        .iter()
        .map(|input| (input.name.to_owned(), object(derivatives.clone(), Properties::new())))
        .collect();
    let range = json!({ "type": "array", "items": number(), "minItems": 2, "maxItems": 2 });
    let band = properties([
        ("contact_loss_ratio", range.clone()),
        ("screw_torque_Nm", range.clone()),
        ("efficiency", range),
    ]);
    let optional = properties([
        ("sensitivities", object(Properties::new(), sensitivities)),
        ("band", object(band, Properties::new())),
    ]);
    object(required, optional)
}

fn compare() -> Value {
    let mut model = record();
    model.push(("time_us".to_owned(), number()));
    let model = object(model, Properties::new());
    let required = properties([("regime", text_or_null()), ("models", list(&model))]);
    object(required, Properties::new())
}

fn analysis(kind: AnalysisKind) -> Value {
    let statements = kind.quantities().iter().filter(|quantity| quantity.of == Of::Statement);
    let verdict = object(properties([("answer", flag()), ("words", text())]), Properties::new());
    let verdicts = statements.map(|quantity| (quantity.key.to_owned(), verdict.clone())).collect();
    let required = properties([
        ("model", text()),
        ("choice", text_or_null()),
        ("verdicts", object(Properties::new(), verdicts)),
        ("lacks", texts()),
        ("warnings", texts()),
    ]);
    let mut optional = columns(kind);
    optional.push(("trends".to_owned(), list(&json!({ "type": "object" }))));
    // Without a solution there is nothing to analyse: it says why.
    json!({ "anyOf": [object(required, optional), solve()] })
}

fn optimum() -> Value {
    let kind = AnalysisKind::Optimum;
    let direction = kind.quantities().iter().map(|q| (q.key.to_owned(), number_or_null()));
    let direction = object(direction.collect(), Properties::new());
    let by_model = properties([
        ("model", text()),
        ("optimum_contact_angle_deg", number_or_null()),
        ("optimum_efficiency", number_or_null()),
    ]);
    let required = properties([
        ("rotary_to_linear", direction.clone()),
        ("linear_to_rotary", direction),
        ("warnings", texts()),
    ]);
    object(required, properties([("by_model", object(by_model, Properties::new()))]))
}

fn capacity() -> Value {
    let steps = object(Properties::new(), columns(AnalysisKind::Capacity));
    let required = properties([("preloaded", flag()), ("steps", steps), ("warnings", texts())]);
    // Sizes that were given, or taken.
    let mut optional: Properties =
        INPUTS.iter().map(|input| (input.name.to_owned(), number())).collect();
    optional.extend(columns(AnalysisKind::Capacity));
    object(required, optional)
}

fn nut() -> Value {
    let numbers = AnalysisKind::Nut.quantities().iter();
    let mut required: Properties =
        numbers.map(|quantity| (quantity.key.to_owned(), number_or_null())).collect();
    let lists = BALL_COLUMNS[LISTED].iter();
    required.extend(lists.map(|(name, _)| ((*name).to_owned(), list(&number_or_null()))));
    required.extend(properties([
        ("status", text()),
        ("message", text_or_null()),
        ("displacement_um", list(&number())),
        ("tilt_urad", list(&number())),
        ("reaction_SI", list(&number())),
        ("stiffness_SI", list(&number())),
        ("body_axial_N", list(&number())),
        ("iterations", integer()),
        ("model", text()),
        ("notes", texts()),
        ("warnings", texts()),
    ]));
    let series = ["K_series_SI", "K_nut_SI", "K_screw_SI"].map(|name| (name, number()));
    let solved = object(required, properties(series));
    let none = object(properties([("status", text()), ("message", text())]), Properties::new());
    let quantiles = map_of(&map_of(&number()));
    let samples =
        properties([("carried", integer()), ("failed", integer()), ("quantiles", quantiles)]);
    json!({ "anyOf": [solved, none, object(samples, Properties::new())] })
}

fn size() -> Value {
    let rule = properties([
        ("rule", text()),
        ("name", text()),
        ("value", number()),
        ("must_be", json!({ "enum": [">=", "<="] })),
        ("limit", number_or_null()),
        ("margin", number_or_null()),
        ("passes", flag()),
        ("source", text()),
        ("remedy", text_or_null()),
    ]);
    let phase = json!({
        "type": "object",
        "properties": { "contacts": text() },
        "required": ["contacts"],
        "additionalProperties": number_or_null(),
    });
    let required = properties([
        ("passes", flag()),
        ("inputs", scene()),
        ("screw", map_of(&number())),
        ("results", object(Properties::new(), columns(AnalysisKind::Size))),
        ("rules", list(&object(rule, Properties::new()))),
        ("phases", list(&phase)),
        ("not_modelled", texts()),
        ("notes", texts()),
        ("warnings", texts()),
        ("program", text()),
    ]);
    object(required, Properties::new())
}

fn fit() -> Value {
    let one_number = |names: Properties| {
        let properties: Map<_, _> = names.into_iter().collect();
        json!({
            "type": "object", "properties": properties, "additionalProperties": false,
            "minProperties": 1, "maxProperties": 1,
        })
    };
    let outputs = OUTPUTS.iter().map(|output| (output.name.to_owned(), number())).collect();
    let found = properties([
        ("relative_response", number_or_null()),
        ("result", object(record(), Properties::new())),
    ]);
    let inputs = INPUTS.iter().map(|input| (input.name.to_owned(), number())).collect();
    let range = json!({ "type": ["array", "null"], "items": number_or_null() });
    let required = properties([
        ("measured", one_number(outputs)),
        ("found", list(&object(found, inputs))),
        ("reachable", range),
        ("message", text()),
    ]);
    object(required, Properties::new())
}

fn design() -> Value {
    let step = properties([
        ("step", json!({ "type": ["integer", "string"] })),
        ("name", text()),
        ("value", number_or_null()),
        ("required", text_or_null()),
        ("passes", flag()),
    ]);
    let required = properties([
        ("found", flag()),
        ("reasons", texts()),
        ("warnings", texts()),
        ("steps", list(&object(step, Properties::new()))),
        ("scene", scene()),
    ]);
    object(required, Properties::new())
}

/// Nuts of the catalogue.
fn catalogue() -> Value {
    let columns = CATALOGUE_COLUMNS.iter().map(|column| (column.name.to_owned(), number()));
    let sheet = sheet_columns().map(|column| (column.name.to_owned(), number_or_null()));
    list(&object(columns.collect(), sheet.collect()))
}

/// Nuts of a maker, beside ours.
fn makers() -> Value {
    json!({
        "type": "array",
        "items": {
            "type": "object",
            "properties": { "nut": text(), "passes": flag() },
            "required": ["nut"],
            "additionalProperties": number_or_null(),
        },
    })
}

fn validate() -> Value {
    let texts = ["key", "source", "claim", "unit", "criterion", "note", "details"];
    let [key, source, claim, unit, criterion, note, details] = texts.map(|name| (name, text()));
    let check = closed([
        key,
        source,
        claim,
        ("claimed", number_or_null()),
        ("measured", number_or_null()),
        unit,
        criterion,
        note,
        details,
        ("verdict", json!({ "enum": ["pass", "fail", "finding"] })),
    ]);
    closed([("program", text()), ("passed", flag()), ("checks", list(&check))])
}

fn tradeoff() -> Value {
    let quantiles = closed([("median", number()), ("q99", number()), ("max", number())]);
    let quantiles = json!({ "anyOf": [quantiles, json!({ "type": "null" })] });
    let errors = closed([
        ("group", text()),
        ("solved", number()),
        ("efficiency", quantiles.clone()),
        ("torque", quantiles.clone()),
        ("loads", quantiles.clone()),
        ("angles_deg", quantiles),
        ("bound_broken", number_or_null()),
    ]);
    let one_core = closed([("group", text()), ("single", number()), ("batch", number())]);
    let sets = json!({ "type": "array", "prefixItems": [text(), number()], "items": false });
    let times = closed([
        ("one_core", list(&one_core)),
        ("all_cores", number()),
        ("instruction_sets", list(&sets)),
    ]);
    let dial = closed([
        ("model", text()),
        ("options", text()),
        ("errors", list(&errors)),
        ("times", times),
    ]);
    let pick = closed([("dial", text()), ("ns", number()), ("fails_where", list(&text()))]);
    let pick = json!({ "anyOf": [pick, json!({ "type": "null" })] });
    let advice = closed([
        ("tolerance", number()),
        ("group", text()),
        ("single", pick.clone()),
        ("batch", pick),
    ]);
    let measured = closed([
        ("reference", text()),
        ("points", list(&closed([("group", text()), ("points", integer())]))),
        ("without_reference", list(&integer())),
        ("instruction_set", text()),
        ("threads", integer()),
        ("dials", list(&dial)),
        ("advice", list(&advice)),
    ]);
    closed([("program", text()), ("tradeoff", measured)])
}
