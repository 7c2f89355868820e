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

/// Properties from their names, each with its type: `number`, `integer`, `string`, `boolean`, `texts` or `numbers`, with
/// `?` if it may be null; or with `*` for the next of `others`.
fn properties<const N: usize>(text: &str, others: [Value; N]) -> Properties {
    let mut others = others.into_iter();
    let property = |entry: &str| {
        let (name, kind) = entry.trim().split_once(' ').expect("a name and a type");
        let schema = match kind {
            "*" => others.next().expect("a schema"),
            "texts" => list(&json!({ "type": "string" })),
            "numbers" => list(&json!({ "type": "number" })),
            _ => kind
                .strip_suffix('?')
                .map_or_else(|| json!({ "type": kind }), |kind| json!({ "type": [kind, "null"] })),
        };
        (name.to_owned(), schema)
    };
    text.split(',').map(property).collect()
}

/// An object of [`properties`] and no other.
fn closed<const N: usize>(text: &str, others: [Value; N]) -> Value {
    object(properties(text, others), Properties::new())
}

fn any_of<const N: usize>(schemas: [Value; N]) -> Value {
    json!({ "anyOf": Vec::from(schemas) })
}

fn list(items: &Value) -> Value {
    json!({ "type": "array", "items": items })
}

fn number() -> Value {
    json!({ "type": "number" })
}

fn number_or_null() -> Value {
    json!({ "type": ["number", "null"] })
}

/// The same schema under each of these names.
fn each<'a>(names: impl Iterator<Item = &'a str>, schema: &Value) -> Properties {
    names.map(|name| (name.to_owned(), schema.clone())).collect()
}

/// Names of the inputs.
fn inputs() -> impl Iterator<Item = &'static str> {
    INPUTS.iter().map(|input| input.name)
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

fn solve() -> Value {
    let settings = closed(
        "name string, tolerance number, accuracy number, creep number, control string?, friction string",
        [],
    );
    let mut required = record();
    required.extend(properties(
        "program string, inputs *, settings *, regime string?, notes texts, warnings texts",
        [scene(), settings],
    ));
    let derivatives = "efficiency number, screw_torque_Nm number?, efficiency_relative number?, \
                       screw_torque_relative number?";
    let sensitivities = each(inputs(), &closed(derivatives, []));
    let range = json!({ "type": "array", "items": number(), "minItems": 2, "maxItems": 2 });
    let band = closed(
        "contact_loss_ratio *, screw_torque_Nm *, efficiency *",
        [range.clone(), range.clone(), range],
    );
    let optional = properties(
        "sensitivities *, band *, torque_parts *",
        [object(Properties::new(), sensitivities), band, phase()],
    );
    object(required, optional)
}

fn compare() -> Value {
    let mut model = record();
    model.extend(properties("time_us number", []));
    closed("regime string?, models *", [list(&object(model, Properties::new()))])
}

fn analysis(kind: AnalysisKind) -> Value {
    let statements = kind.quantities().iter().filter(|quantity| quantity.of == Of::Statement);
    let verdict = closed("answer boolean, words string", []);
    let verdicts = each(statements.map(|quantity| quantity.key), &verdict);
    let required = properties(
        "model string, verdicts *, lacks texts, warnings texts",
        [object(Properties::new(), verdicts)],
    );
    // Without a solution there is nothing to analyse: it says why.
    any_of([object(required, columns(kind)), solve()])
}

fn optimum() -> Value {
    let keys = AnalysisKind::Optimum.quantities().iter().map(|quantity| quantity.key);
    let direction = object(each(keys, &number_or_null()), Properties::new());
    let by_model =
        closed("model string, optimum_contact_angle_deg number?, optimum_efficiency number?", []);
    let required = properties(
        "rotary_to_linear *, linear_to_rotary *, warnings texts",
        [direction.clone(), direction],
    );
    object(required, properties("by_model *", [by_model]))
}

fn capacity() -> Value {
    let steps = object(Properties::new(), columns(AnalysisKind::Capacity));
    let required = properties("preloaded boolean, steps *, warnings texts", [steps]);
    // Sizes that were given, or taken.
    let mut optional = each(inputs(), &number());
    optional.extend(columns(AnalysisKind::Capacity));
    object(required, optional)
}

fn nut() -> Value {
    let keys = AnalysisKind::Nut.quantities().iter().map(|quantity| quantity.key);
    let mut required = each(keys, &number_or_null());
    required
        .extend(each(BALL_COLUMNS[LISTED].iter().map(|(name, _)| *name), &list(&number_or_null())));
    required.extend(properties(
        "status string, message string?, displacement_um numbers, tilt_urad numbers, reaction_SI numbers, \
         stiffness_SI numbers, body_axial_N numbers, iterations integer, model string?, notes texts, warnings texts",
        [],
    ));
    let series = properties("K_series_SI number, K_nut_SI number, K_screw_SI number", []);
    let none = closed("status string, message string", []);
    let samples =
        closed("carried integer, failed integer, quantiles *", [map_of(&map_of(&number()))]);
    any_of([object(required, series), none, samples])
}

/// Torque by its parts.
fn phase() -> Value {
    json!({
        "type": "object",
        "properties": { "contacts": { "type": "string" } },
        "required": ["contacts"],
        "additionalProperties": number_or_null(),
    })
}

fn size() -> Value {
    let rule = closed(
        "rule string, name string, value number, must_be *, limit number?, margin number?, passes boolean, \
         source string, remedy string?",
        [json!({ "enum": [">=", "<="] })],
    );
    let results = object(Properties::new(), columns(AnalysisKind::Size));
    closed(
        "passes boolean, inputs *, screw *, results *, rules *, phases *, not_modelled texts, notes texts, \
         warnings texts, program string",
        [scene(), map_of(&number()), results, list(&rule), list(&phase())],
    )
}

fn fit() -> Value {
    let measured: Map<_, _> =
        each(OUTPUTS.iter().map(|output| output.name), &number()).into_iter().collect();
    let measured = json!({
        "type": "object", "properties": measured, "additionalProperties": false,
        "minProperties": 1, "maxProperties": 1,
    });
    let found =
        properties("relative_response number?, result *", [object(record(), Properties::new())]);
    let range = json!({ "type": ["array", "null"], "items": number_or_null() });
    closed(
        "measured *, found *, reachable *, message string",
        [measured, list(&object(found, each(inputs(), &number()))), range],
    )
}

/// A fit to a table.
fn calibration() -> Value {
    let value = closed("value number, standard_deviation number?", []);
    let point = closed("measured number, fitted number", []);
    closed(
        "output string, found *, root_mean_square number, condition number?, points *",
        [object(Properties::new(), each(inputs(), &value)), list(&point)],
    )
}

fn design() -> Value {
    let step = closed(
        "step *, name string, value number?, required string?, passes boolean",
        [json!({ "type": ["integer", "string"] })],
    );
    closed("found boolean, reasons texts, warnings texts, steps *, scene *", [list(&step), scene()])
}

/// Nuts of the catalogue.
fn catalogue() -> Value {
    let columns = each(CATALOGUE_COLUMNS.iter().map(|column| column.name), &number());
    list(&object(columns, each(sheet_columns().map(|column| column.name), &number_or_null())))
}

/// Nuts of a maker, beside ours.
fn makers() -> Value {
    list(&json!({
        "type": "object",
        "properties": { "nut": { "type": "string" }, "passes": { "type": "boolean" } },
        "required": ["nut"],
        "additionalProperties": number_or_null(),
    }))
}

fn validate() -> Value {
    let check = closed(
        "key string, source string, claim string, claimed number?, measured number?, unit string, \
         criterion string, note string, details string, verdict *",
        [json!({ "enum": ["pass", "fail", "finding"] })],
    );
    closed("program string, passed boolean, checks *", [list(&check)])
}

fn verify() -> Value {
    let damaged = closed("file string, reason string", []);
    closed(
        "plan string, parts integer, finished integer, complete boolean, deep boolean, missing texts, damaged *, \
         foreign texts, rows integer, failed integer, several integer",
        [list(&damaged)],
    )
}

fn tradeoff() -> Value {
    let or_null = |schema| any_of([schema, json!({ "type": "null" })]);
    let quantiles = || or_null(closed("median number, q99 number, max number", []));
    let errors = closed(
        "group string, solved number, efficiency *, torque *, loads *, angles_deg *, bound_broken number?",
        [quantiles(), quantiles(), quantiles(), quantiles()],
    );
    let one_core = closed("group string, single number, batch number", []);
    let sets =
        json!({ "type": "array", "prefixItems": [{ "type": "string" }, number()], "items": false });
    let times =
        closed("one_core *, all_cores number, instruction_sets *", [list(&one_core), list(&sets)]);
    let dial = closed("model string, options string, errors *, times *", [list(&errors), times]);
    let pick = || or_null(closed("dial string, ns number, fails_where texts", []));
    let advice = closed("tolerance number, group string, single *, batch *", [pick(), pick()]);
    let measured = closed(
        "reference string, points *, without_reference *, instruction_set string, threads integer, dials *, advice *",
        [
            list(&closed("group string, points integer", [])),
            list(&json!({ "type": "integer" })),
            list(&dial),
            list(&advice),
        ],
    );
    closed("program string, tradeoff *", [measured])
}
