//! JSON schemas of cases and results, generated from the same tables that the program uses for
//! checking and output.

use std::borrow::Cow;

use schemars::generate::{Contract, SchemaSettings};
use schemars::transform::RecursiveTransform;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::axis::{AxisMembers, AxisRemarks};
use super::calibration::CalibrationMembers;
use super::comparison::{ModelsCompared, ModelsLeftOut};
use super::design::DesignMembers;
use super::ellipses::EllipseMembers;
use super::fit::FitMembers;
use super::groove::EstimateJson;
use super::jam::JamNumbers;
use super::manufacturers::COMPARED;
use super::motion::MotionMembers;
use super::nut::{NutMembers, UnsolvedNut};
use super::offers::OfferMembers;
use super::optimum::OptimumMembers;
use super::ratings::RatingMembers;
use super::record::MotionResult;
use super::samples::SampleMembers;
use super::slip::SlipNumbers;
use super::warm::WarmMembers;
use crate::vocabulary::answer::{NotGivenRow, RuleRow};
use crate::vocabulary::members::{property, with_unit};
use crate::{
    AnalysisKind, CATALOG, CaseEntries, INPUTS, InputKey, OUTPUTS, Output, Rule, sheet_columns,
};

const DIALECT: &str = "https://json-schema.org/draft/2020-12/schema";

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
    let settings =
        SchemaSettings::draft2020_12().with(|settings| settings.inline_subschemas = true);
    let mut entries = settings.into_generator().into_root_schema_for::<CaseEntries>();
    if let Some(Value::Object(entries)) = entries.remove("properties") {
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
        let about =
            format!("results of {}, which can be selected as columns of bsm sweep", kind.name());
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

/// Solution of a model in JSON.
#[derive(Debug, Clone, Serialize)]
#[serde(transparent)]
pub(crate) struct RecordJson(pub(crate) Map<String, Value>);

/// Case in JSON.
#[derive(Debug, Clone, Serialize)]
#[serde(transparent)]
pub(crate) struct CaseJson(pub(crate) Value);

impl RecordJson {
    /// Returns the names of the JSON members.
    pub(crate) fn names() -> impl Iterator<Item = &'static str> {
        let texts = ["model", "status", "message", "choice", "without_error_bound"];
        texts.into_iter().chain(OUTPUTS.iter().map(|output| output.name))
    }
}

impl JsonSchema for RecordJson {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Record".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let mut schema = output_schema();
        let (properties, required) = (schema["properties"].take(), schema["required"].take());
        json_schema!({ "type": "object", "properties": properties, "required": required })
    }
}

impl JsonSchema for CaseJson {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Case".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "object", "properties": input_schema()["properties"].take() })
    }
}

/// Schema of a JSON object, which is composed of the members of several types.
#[derive(Debug, Clone, Default)]
pub struct ObjectSchema {
    properties: Map<String, Value>,
    required: Vec<Value>,
}

impl ObjectSchema {
    /// Returns the schema of an answer that contains the members of `T`, notes and warnings.
    pub fn answer<T: JsonSchema>() -> Self {
        Self::default().and::<T>().member::<Vec<String>>("notes").member::<Vec<String>>("warnings")
    }

    /// Adds the members of a type to the schema.
    #[must_use]
    pub fn and<T: JsonSchema>(mut self) -> Self {
        let mut schema = schema_of::<T>();
        if let Some(Value::Object(properties)) = schema.remove("properties") {
            self.properties.extend(properties);
        }
        if let Some(Value::Array(required)) = schema.remove("required") {
            self.required.extend(required);
        }
        self
    }

    /// Adds a member to the schema.
    #[must_use]
    pub fn member<T: JsonSchema>(mut self, name: &str) -> Self {
        self.required.push(name.into());
        self.optional_member::<T>(name)
    }

    /// Adds an optional member to the schema.
    #[must_use]
    fn optional_member<T: JsonSchema>(mut self, name: &str) -> Self {
        self.properties.insert(name.to_owned(), schema_of::<T>().into());
        self
    }

    /// Adds outputs to the schema as optional members.
    #[must_use]
    fn optional_outputs(mut self, outputs: impl Iterator<Item = &'static Output>) -> Self {
        self.properties.extend(outputs.map(property));
        self
    }

    /// Adds outputs.
    #[must_use]
    fn outputs(mut self, outputs: impl Iterator<Item = &'static Output> + Clone) -> Self {
        self.required.extend(outputs.clone().map(|output| output.name.into()));
        self.optional_outputs(outputs)
    }

    /// Adds the members that an answer about a case contains: missing inputs, and the estimated
    /// groove.
    #[must_use]
    fn about_a_case(self) -> Self {
        self.optional_member::<Vec<NotGivenRow>>("not_given")
            .optional_member::<EstimateJson>("groove_estimate")
    }

    /// Returns the schema as JSON.
    pub fn json(self) -> Value {
        json!({
            "type": "object",
            "properties": self.properties,
            "required": self.required,
            "additionalProperties": false,
        })
    }
}

/// Returns the schema of a type in its serialized form. The schema permits only the declared
/// members.
fn schema_of<T: JsonSchema>() -> Schema {
    let settings = SchemaSettings::draft2020_12()
        .with(|settings| {
            settings.contract = Contract::Serialize;
            settings.inline_subschemas = true;
            settings.meta_schema = None;
        })
        .with_transform(RecursiveTransform(|schema: &mut Schema| {
            schema.remove("format");
            if schema.get("properties").is_some() {
                schema.insert("additionalProperties".to_owned(), false.into());
            }
        }));
    settings.into_generator().into_root_schema_for::<T>()
}

/// An answer and its JSON schema.
#[derive(Debug, Clone, Copy)]
pub struct AnswerSchema {
    /// Name of the schema.
    pub name: &'static str,
    /// Command that prints the answer.
    pub command: &'static str,
    /// Returns the schemas of the alternative forms that the answer can have.
    pub forms: fn() -> Vec<Value>,
}

impl AnswerSchema {
    /// Answers that are calculated from a case, from a requirement or from a list of nuts.
    pub const ALL: [Self; 11] = [
        Self::of("solve", "solve", || vec![solve()]),
        Self::of("models", "solve --model all", || {
            let models = ObjectSchema::answer::<ModelsCompared>().and::<ModelsLeftOut>();
            vec![models.about_a_case().json()]
        }),
        // If there is no solution, the command prints the answer of `solve`, which states the
        // reason.
        Self::of("slip", "solve --show slip", || {
            vec![about_a_case::<MotionMembers<SlipNumbers>>(), solve()]
        }),
        Self::of("ellipses", "solve --show ellipses", || {
            vec![about_a_case::<EllipseMembers>(), solve()]
        }),
        Self::of("jam", "solve --show jam", || {
            vec![about_a_case::<MotionMembers<JamNumbers>>(), solve()]
        }),
        Self::of("optimum", "solve --show optimum", || vec![about_a_case::<OptimumMembers>()]),
        Self::of("ratings", "solve --show ratings", || vec![about_a_case::<RatingMembers>()]),
        Self::of("nut", "nut", || {
            let nut = ObjectSchema::answer::<NutMembers>().and::<WarmMembers>();
            vec![
                nut.about_a_case().json(),
                about_a_case::<UnsolvedNut>(),
                about_a_case::<SampleMembers>(),
            ]
        }),
        Self::of("axis", "axis", || {
            let sheet = ObjectSchema::answer::<AxisMembers>()
                .and::<WarmMembers>()
                .and::<AxisRemarks>()
                .member::<String>("program")
                .member::<Vec<RuleRow>>("rules")
                .optional_member::<Option<String>>("back_driving");
            vec![sheet.about_a_case().json(), ObjectSchema::answer::<OfferMembers>().json()]
        }),
        Self::of("select", "select", || {
            let sizes = ObjectSchema::default()
                .outputs(CATALOG.iter().flat_map(|quantity| quantity.columns))
                .optional_outputs(sheet_columns())
                .optional_member::<Option<String>>("make")
                .optional_member::<Option<String>>("manufacturer");
            let nuts = ObjectSchema::default()
                .optional_outputs(InputKey::ALL.into_iter().map(Output::input))
                .outputs(COMPARED.iter().flat_map(|quantity| quantity.columns))
                .optional_outputs(sheet_columns())
                .member::<String>("nut")
                .optional_member::<Option<bool>>("passes")
                .optional_member::<Vec<String>>("failed_rules")
                .optional_member::<Option<String>>("groove")
                .optional_member::<Value>("intervals")
                .optional_member::<Vec<String>>("notes")
                .optional_member::<Value>("texts");
            let list = |row: ObjectSchema| json!({ "type": "array", "items": row.json() });
            vec![ObjectSchema::answer::<DesignMembers>().json(), list(sizes), list(nuts)]
        }),
        Self::of("fit", "fit", || {
            vec![about_a_case::<FitMembers>(), about_a_case::<CalibrationMembers>()]
        }),
    ];

    /// Creates the schema of an answer.
    ///
    /// * `forms`: function that returns the schemas of the alternative forms that the answer can
    ///   have.
    pub const fn of(name: &'static str, command: &'static str, forms: fn() -> Vec<Value>) -> Self {
        Self { name, command, forms }
    }

    /// Returns the schema.
    pub fn json(&self) -> Value {
        let mut schema = Map::new();
        schema.insert("$schema".to_owned(), DIALECT.into());
        schema.insert("title".to_owned(), json!(format!("result of bsm {}", self.command)));
        let mut forms = (self.forms)();
        match &mut forms[..] {
            [Value::Object(only)] => schema.append(only),
            several => drop(schema.insert("anyOf".to_owned(), json!(several))),
        }
        Value::Object(schema)
    }
}

/// Returns the schema of an answer about a case.
fn about_a_case<T: JsonSchema>() -> Value {
    ObjectSchema::answer::<T>().about_a_case().json()
}

/// Returns the schema of the answer about the motion of a ball.
fn solve() -> Value {
    about_a_case::<MotionResult>()
}
