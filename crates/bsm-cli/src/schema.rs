//! `bsm schema`: JSON Schemas of files and answers, and the units that input names may have. The
//! schemas are derived from the same tables as the answers.

#[cfg(feature = "validate")]
use bsm_case::derived_schema;
use bsm_case::units::units_by_quantity;
use bsm_case::{
    AnalysisKind, CATALOG, Column, INPUTS, OUTPUTS, Scope, TABLES, input_schema, output_schema,
    sheet_columns,
};
#[cfg(feature = "validate")]
use bsm_validate::{Check, tradeoff::Tradeoff};
#[cfg(feature = "validate")]
use schemars::generate::Contract;
use serde_json::{Map, Value, json};

use crate::failure::Failure;
use crate::files::{pretty_json, print};

/// For each schema of an answer: its name, the command that prints the answer, and the kind of the
/// JSON value (see [`kind`]). Bars separate alternatives.
///
/// Names with `@` refer to tables of quantities or to the [`TABLES`], which are the sections of an
/// [`Answer`](bsm_case::Answer). Only two answers have a different structure: the answer of `fit`
/// has a member for each input that the user chose, and the vectors of `nut` have the names used in
/// the published comparison cases (`validation/published/nut/public.json`).
const ANSWERS: &[(&str, &str, &str)] = &[
    (
        "solve",
        "solve",
        "@output, program string, inputs @case?, settings settings, regime string?, not_given? [lacking], @said, \
         sensitivities? *derivatives, band? *interval, band_model? string, torque_parts? torque, groove_estimate? groove",
    ),
    (
        "models",
        "solve --model all",
        "regime string?, models [model], left_out texts, groove_estimate? groove, @said",
    ),
    // If there is no solution, the JSON value is the answer of `solve`, which states the reason.
    (
        "slip",
        "solve --show slip",
        "model string, @slip, verdicts *verdict, lacks texts, groove_estimate? groove, @said | solve",
    ),
    (
        "ellipses",
        "solve --show ellipses",
        "model string, contacts [ellipse], groove_estimate? groove, @said | solve",
    ),
    (
        "jam",
        "solve --show jam",
        "model string, @jam, verdicts *verdict, lacks texts, groove_estimate? groove, @said | solve",
    ),
    (
        "optimum",
        "solve --show optimum",
        "@optimum, model? string, by_model? best, groove_estimate? groove, @said",
    ),
    (
        "ratings",
        "solve --show ratings",
        "@ratings, @as used, preloaded boolean, steps steps, groove_estimate? groove, @said",
    ),
    (
        "nut",
        "nut",
        "@nut, status string, message string?, model string?, displacement_um numbers, tilt_urad numbers, reaction_SI numbers, \
         stiffness_SI numbers, body_axial_N numbers, K_series_SI? number, K_nut_SI? number, K_screw_SI? number, iterations integer, \
         nut_plus_N [number?], nut_minus_N [number?], screw_plus_N [number?], screw_minus_N [number?], nut_plus_deg [number?], \
         nut_minus_deg [number?], screw_plus_deg [number?], screw_minus_deg [number?], not_given? [lacking], warm? warm, \
         conductances? *conductance, circuits? [circuit], groove_estimate? groove, @said \
         | status string, message string, groove_estimate? groove, @said \
         | carried integer, failed integer, quantiles **number, groove_estimate? groove, @said",
    ),
    (
        "axis",
        "axis",
        "program string, passes? boolean?, inputs @case?, screw screw, results @axis, warm? warm, conductances? *conductance, \
         band? *range, rules [rule], not_given? [lacking], phases [phase], not_modeled texts, back_driving? string?, groove_estimate? groove, @said \
         | offers texts, rules [offered rule], numbers [offered number], inputs [offered input], @said",
    ),
    (
        "select",
        "select",
        "found boolean, reasons texts, steps [step], case @case?, @said \
         | [@catalog, @sheet?] | [nut string, @input?, @manufacturer, @sheet?, passes? boolean?, groove? string?, intervals? any, notes? texts, texts? any]",
    ),
    (
        "fit",
        "fit",
        "measured? measured, limit? string, kept? [numbers], found [fitted], reachable [number?]?, message string, @said \
         | output string, found *value, errors string, root_mean_square number, \
         weighted_root_mean_square number, degrees_of_freedom integer, condition number?, points [point], groove_estimate? groove, @said",
    ),
    (
        "parts",
        "parts check",
        "plan string, parts integer, finished integer, complete boolean, deep boolean, missing texts, damaged [damage], \
         foreign texts, rows integer, failed integer, several integer, @said",
    ),
    #[cfg(feature = "validate")]
    ("validate", "validate", "program string, passed boolean, checks [check], @said"),
    #[cfg(feature = "validate")]
    ("tradeoff", "tradeoff", "program string, tradeoff measurement, @said"),
];

/// JSON objects in answers that are not generated from tables, with their members.
const OBJECTS: [(&str, &str); 8] = [
    (
        "settings",
        "name string, tolerance number, accuracy number, creep number, control string?, friction string",
    ),
    ("torque", "@torques, contacts string"),
    ("model", "@output, time_us number"),
    ("phase", "@phase, @torques, contacts string, body_axial_N numbers?"),
    ("measured", "@solution?, screw_torque_Nm? number"),
    (
        "fitted",
        "@input?, relative_response number?, groove_interval numbers?, result? output, result_intervals? any",
    ),
    ("damage", "file string, reason string"),
    // The object `intervals` contains the members of the answer that depend on the groove.
    (
        "groove",
        "ln_evidence number, balls [numbers], ball_set_90 numbers, loaded_balls numbers, draws integer, without_result integer, \
         grooves_with_number *integer, intervals any",
    ),
];

/// Returns the names of all schemas.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    ["input", "output", "units"].into_iter().chain(ANSWERS.iter().map(|(name, ..)| *name))
}

pub(crate) fn run(name: Option<&str>) -> Result<(), Failure> {
    let Some(name) = name else { return print(&names().collect::<Vec<_>>().join("\n")) };
    print(&pretty_json(&match name {
        "input" => input_schema(),
        "output" => output_schema(),
        "units" => units(),
        other => answer(other),
    }))
}

/// Returns the unit suffixes for each quantity. The first suffix is the one used in the names of
/// inputs and outputs.
fn units() -> Value {
    units_by_quantity().map(|(quantity, units)| (quantity.to_owned(), json!(units))).collect()
}

/// Returns the JSON Schema for the answer of a command.
fn answer(name: &str) -> Value {
    let (_, command, shapes) = ANSWERS.iter().find(|(own, ..)| *own == name).unwrap_or(&ANSWERS[0]);
    let mut schema = Map::new();
    schema.insert("$schema".to_owned(), input_schema()["$schema"].clone());
    schema.insert("title".to_owned(), json!(format!("result of bsm {command}")));
    let shapes: Vec<_> = shapes.split(" | ").map(kind).collect();
    match &shapes[..] {
        [Value::Object(only)] => schema.extend(only.clone()),
        several => drop(schema.insert("anyOf".to_owned(), json!(several))),
    }
    Value::Object(schema)
}

/// Returns the schema for the description of a kind. A kind is `number`, `integer`, `string`,
/// `boolean`, `texts`, `numbers`, an enumeration of texts `a/b`, `solve`, the name of an entry in
/// [`OBJECTS`] or [`TABLES`], or the name of a table of numbers. `[kind]` is a list, `*kind` is an
/// object with arbitrary names, and `kind?` also allows null. A comma-separated list of members
/// describes an object (see [`object`]).
fn kind(word: &str) -> Value {
    if let Some(items) = word.strip_prefix('[').and_then(|word| word.strip_suffix(']')) {
        return json!({ "type": "array", "items": kind(items) });
    }
    if word.contains(", ") || word.starts_with('@') {
        return object(word.split(", "));
    }
    if let Some(known) = word.strip_suffix('?') {
        let mut schema = kind(known);
        schema["type"] = json!([schema["type"].take(), "null"]);
        return schema;
    }
    if let Some(known) = word.strip_prefix('*') {
        return json!({ "type": "object", "additionalProperties": kind(known) });
    }
    if word.contains('/') {
        return json!({ "enum": word.split('/').collect::<Vec<_>>() });
    }
    match word {
        "number" | "integer" | "string" | "boolean" => return json!({ "type": word }),
        "any" => {
            let types = ["number", "string", "boolean", "array", "object", "null"];
            return json!({ "type": types });
        }
        "texts" => return kind("[string]"),
        "numbers" => return kind("[number]"),
        "solve" => return kind(ANSWERS[0].2),
        _ => {}
    }
    let of = |(own, _): &(&str, &str)| *own == word;
    if let Some((_, members)) = OBJECTS.into_iter().find(of) {
        return kind(members);
    }
    match TABLES.into_iter().find(of) {
        Some((_, columns)) => {
            let named = Column::all_of(columns).filter(|column| !column.name.is_empty());
            let members: Vec<_> =
                named.map(|Column { name, kind, .. }| format!("{name} {kind}")).collect();
            object(members.iter().map(String::as_str))
        }
        None => object([format!("@{word}").as_str()]),
    }
}

/// Returns the schema of an object from descriptions of its members. A description consists of the
/// member's name and kind. A name that ends with `?` is optional. `@table` stands for all numbers
/// of a table or all members of a type; `@table?` makes them optional.
fn object<'a>(members: impl IntoIterator<Item = &'a str>) -> Value {
    let (mut properties, mut required) = (Map::new(), Vec::new());
    for member in members {
        let (own, always) = if let Some(table) = member.strip_prefix('@') {
            (numbers(table.trim_end_matches('?')), !table.ends_with('?'))
        } else {
            let (name, known) = member.split_once(' ').unwrap_or((member, "string"));
            let own = name.trim_end_matches('?');
            (vec![(own.to_owned(), kind(known))], own == name)
        };
        required.extend(own.iter().filter(|_| always).map(|(name, _)| name.clone()));
        properties.extend(own);
    }
    json!({ "type": "object", "properties": properties, "required": required, "additionalProperties": false })
}

/// Returns the names and schemas of all numbers of a table.
fn numbers(table: &str) -> Vec<(String, Value)> {
    let all = output_schema();
    let each =
        |names: &mut dyn Iterator<Item = &'static str>, schema: &str| -> Vec<(String, Value)> {
            names.map(|name| (name.to_owned(), kind(schema))).collect()
        };
    let entries = |properties: &Value| {
        let entries = properties.as_object().into_iter().flatten();
        entries.map(|(name, schema)| (name.clone(), schema.clone())).collect()
    };
    match table {
        "said" => ["notes", "warnings"].map(|name| (name.to_owned(), kind("texts"))).to_vec(),
        "output" => entries(&all["properties"]),
        "case" => entries(&input_schema()["properties"]),
        #[cfg(feature = "validate")]
        "check" => entries(&derived_schema::<Check>(Contract::Serialize)),
        #[cfg(feature = "validate")]
        "measurement" => entries(&derived_schema::<Tradeoff>(Contract::Serialize)),
        "solution" => each(&mut OUTPUTS.iter().map(|output| output.name), "number"),
        "input" => each(&mut INPUTS.iter().map(|input| input.name), "number?"),
        "catalog" => each(&mut CATALOG.iter().map(|column| column.name), "number"),
        "sheet" => each(&mut sheet_columns().map(|column| column.name), "number?"),
        _ => {
            let known =
                bsm_case::table(table).filter(|quantity| quantity.scope != Scope::Statement);
            let columns = known.flat_map(|quantity| quantity.columns);
            let schema = |column: &bsm_case::Output| {
                let of_kind = |kind: AnalysisKind| &all["$defs"][kind.name()]["properties"];
                let found = column.analysis().map(|kind| of_kind(kind)[column.name].clone());
                found.filter(|schema| !schema.is_null()).unwrap_or_else(
                    || json!({ "type": ["number", "null"], "description": column.about }),
                )
            };
            columns.map(|column| (column.name.to_owned(), schema(column))).collect()
        }
    }
}
