//! `bsm schema`: what files and results look like, from the tables that results are made from.

use bsm_case::{
    AnalysisKind, BALL_COLUMNS, CATALOGUE_COLUMNS, INPUTS, LISTED, OUTPUTS, Of, input_schema,
    output_schema, sheet_columns,
};
use clap::ValueEnum;
use serde_json::{Map, Value, json};

use crate::args::SchemaName;
use crate::failure::Failure;
use crate::files::{pretty_json, print};

pub(crate) fn run(name: Option<SchemaName>) -> Result<(), Failure> {
    let Some(name) = name else {
        let names = SchemaName::value_variants().iter().filter_map(ValueEnum::to_possible_value);
        let names: Vec<_> = names.map(|name| name.get_name().to_owned()).collect();
        return print(&names.join("\n"));
    };
    let (command, schema) = match name {
        SchemaName::Input => return print(&pretty_json(&input_schema())),
        SchemaName::Output => return print(&pretty_json(&output_schema())),
        SchemaName::Solve => ("solve", solve()),
        SchemaName::Models => ("solve --model all", compare()),
        SchemaName::Slip => ("solve --show slip", analysis(AnalysisKind::Slip)),
        SchemaName::Jam => ("solve --show jam", analysis(AnalysisKind::Jam)),
        SchemaName::Optimum => ("solve --show optimum", optimum()),
        SchemaName::Ratings => ("solve --show ratings", capacity()),
        SchemaName::Nut => ("nut", nut()),
        SchemaName::Axis => ("axis", size()),
        SchemaName::Select => ("select", any_of([design(), catalogue(), makers()])),
        SchemaName::Fit => ("fit", any_of([fit(), calibration()])),
        SchemaName::Parts => ("parts check", verify()),
        SchemaName::Validate => ("validate", validate()),
        SchemaName::Tradeoff => ("tradeoff", tradeoff()),
    };
    print(&pretty_json(&titled(command, schema)))
}

/// Properties of an object.
type Properties = Vec<(String, Value)>;

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

fn any_of<const N: usize>(schemas: [Value; N]) -> Value {
    json!({ "anyOf": Vec::from(schemas) })
}

fn or_null(schema: Value) -> Value {
    any_of([schema, json!({ "type": "null" })])
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
    closed([
        ("name", text()),
        ("tolerance", number()),
        ("accuracy", number()),
        ("creep", number()),
        ("control", text_or_null()),
        ("friction", text()),
    ])
}

fn solve() -> Value {
    let mut required = record();
    required.extend(properties([
        ("program", text()),
        ("inputs", scene()),
        ("settings", settings()),
        ("regime", text_or_null()),
        ("notes", texts()),
        ("warnings", texts()),
    ]));
    let derivatives = closed([
        ("efficiency", number()),
        ("screw_torque_Nm", number_or_null()),
        ("efficiency_relative", number_or_null()),
        ("screw_torque_relative", number_or_null()),
    ]);
    let sensitivities: Properties =
        INPUTS.iter().map(|input| (input.name.to_owned(), derivatives.clone())).collect();
    let range = json!({ "type": "array", "items": number(), "minItems": 2, "maxItems": 2 });
    let band = closed([
        ("contact_loss_ratio", range.clone()),
        ("screw_torque_Nm", range.clone()),
        ("efficiency", range),
    ]);
    let optional = properties([
        ("sensitivities", object(Properties::new(), sensitivities)),
        ("band", band),
        ("torque_parts", phase()),
    ]);
    object(required, optional)
}

fn compare() -> Value {
    let mut model = record();
    model.push(("time_us".to_owned(), number()));
    let model = object(model, Properties::new());
    closed([("regime", text_or_null()), ("models", list(&model))])
}

fn analysis(kind: AnalysisKind) -> Value {
    let statements = kind.quantities().iter().filter(|quantity| quantity.of == Of::Statement);
    let verdict = closed([("answer", flag()), ("words", text())]);
    let verdicts = statements.map(|quantity| (quantity.key.to_owned(), verdict.clone())).collect();
    let required = properties([
        ("model", text()),
        ("verdicts", object(Properties::new(), verdicts)),
        ("lacks", texts()),
        ("warnings", texts()),
    ]);
    // Without a solution there is nothing to analyse: it says why.
    any_of([object(required, columns(kind)), solve()])
}

fn optimum() -> Value {
    let kind = AnalysisKind::Optimum;
    let direction = kind.quantities().iter().map(|q| (q.key.to_owned(), number_or_null()));
    let direction = object(direction.collect(), Properties::new());
    let by_model = closed([
        ("model", text()),
        ("optimum_contact_angle_deg", number_or_null()),
        ("optimum_efficiency", number_or_null()),
    ]);
    let required = properties([
        ("rotary_to_linear", direction.clone()),
        ("linear_to_rotary", direction),
        ("warnings", texts()),
    ]);
    object(required, properties([("by_model", by_model)]))
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
        ("model", text_or_null()),
        ("notes", texts()),
        ("warnings", texts()),
    ]));
    let series = ["K_series_SI", "K_nut_SI", "K_screw_SI"].map(|name| (name, number()));
    let solved = object(required, properties(series));
    let none = closed([("status", text()), ("message", text())]);
    let quantiles = map_of(&map_of(&number()));
    let samples = closed([("carried", integer()), ("failed", integer()), ("quantiles", quantiles)]);
    any_of([solved, none, samples])
}

/// Torque by its parts.
fn phase() -> Value {
    json!({
        "type": "object",
        "properties": { "contacts": text() },
        "required": ["contacts"],
        "additionalProperties": number_or_null(),
    })
}

fn size() -> Value {
    let rule = closed([
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
    closed([
        ("passes", flag()),
        ("inputs", scene()),
        ("screw", map_of(&number())),
        ("results", object(Properties::new(), columns(AnalysisKind::Size))),
        ("rules", list(&rule)),
        ("phases", list(&phase())),
        ("not_modelled", texts()),
        ("notes", texts()),
        ("warnings", texts()),
        ("program", text()),
    ])
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
    closed([
        ("measured", one_number(outputs)),
        ("found", list(&object(found, inputs))),
        ("reachable", range),
        ("message", text()),
    ])
}

/// A fit to a table.
fn calibration() -> Value {
    let value = closed([("value", number()), ("standard_deviation", number_or_null())]);
    let values = INPUTS.iter().map(|input| (input.name.to_owned(), value.clone())).collect();
    let point = closed([("measured", number()), ("fitted", number())]);
    closed([
        ("output", text()),
        ("found", object(Properties::new(), values)),
        ("root_mean_square", number()),
        ("condition", number_or_null()),
        ("points", list(&point)),
    ])
}

fn design() -> Value {
    let step = closed([
        ("step", json!({ "type": ["integer", "string"] })),
        ("name", text()),
        ("value", number_or_null()),
        ("required", text_or_null()),
        ("passes", flag()),
    ]);
    closed([
        ("found", flag()),
        ("reasons", texts()),
        ("warnings", texts()),
        ("steps", list(&step)),
        ("scene", scene()),
    ])
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

fn verify() -> Value {
    closed([
        ("plan", text()),
        ("shards", integer()),
        ("finished", integer()),
        ("complete", flag()),
        ("deep", flag()),
        ("missing", texts()),
        ("damaged", list(&closed([("file", text()), ("reason", text())]))),
        ("foreign", texts()),
        ("rows", integer()),
        ("failed", integer()),
        ("several", integer()),
    ])
}

fn tradeoff() -> Value {
    let quantiles = closed([("median", number()), ("q99", number()), ("max", number())]);
    let quantiles = or_null(quantiles);
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
    let pick = or_null(pick);
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
