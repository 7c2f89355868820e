//! Comparison of all models at one operating point.

use std::borrow::Cow;
use std::time::Instant;

use bsm_design::groove::FEW_DRAWS;
use bsm_dyn::{Model, ModelWorkspace, Status};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Serialize;
use serde_json::{Map, Value};

use crate::answers::schema::RecordJson;
use crate::case::problem::has_lubricant;
use crate::vocabulary::error::{NO_LUBRICANT, list};
use crate::vocabulary::members::{Data, Label, Rows, Sentences, TableRow, answer, row};
use crate::{Answer, Case, CaseError, Column, Content, ModelChoice, Record, output};

/// Number of timed solver runs per model. The shortest time is reported.
const REPEATS: usize = 20;

row! {
    /// Solution of a model.
    pub(crate) struct ModelRow {
        [flatten] record: RecordCells;
        /// Efficiency minus the efficiency of the reference model. It is null if a model has no
        /// solution.
        efficiency_deviation: Option<f64>;
        /// Loss (1 minus the efficiency) minus the loss of the reference model, relative to the
        /// loss of the reference model. It is null if a model has no solution, or if the reference
        /// model has no loss.
        loss_deviation: Option<f64>;
        [skip] shown_efficiency_deviation: String = "efficiency deviation";
        [skip] shown_loss_deviation: String = "loss deviation %";
        /// Time of one solve \[µs\].
        time_us: f64;
        [skip] shown_time: String = "time us";
    }
}

answer! {
    /// Solutions of all models.
    pub(crate) struct ModelsCompared {
        regime: Label;
        /// Model to which the deviations refer: `traction` or, if `traction` has no solution, the
        /// solved model with the most inputs.
        reference_model: Label;
        models: Rows<ModelRow>;
    }
}

/// A model that is not compared.
#[derive(Serialize, JsonSchema)]
pub(crate) struct LeftOut {
    /// Name of the model.
    model: &'static str,
    /// Reason why the model is omitted, without its name.
    reason: String,
}

answer! {
    /// Models that are not compared.
    pub(crate) struct ModelsLeftOut {
        /// Models that are omitted, each with the reason.
        left_out: Data<Vec<LeftOut>>;
        [skip] shown_reasons: Sentences;
    }
}

/// Columns of a record that are shown on the screen, with their headings.
const SHOWN: [(&str, &str); 8] = [
    ("model", "model"),
    ("status", "status"),
    ("efficiency", "efficiency"),
    ("ball_torque_Nm", "torque N m"),
    ("nut_normal_load_N", "Q nut N"),
    ("screw_normal_load_N", "Q screw N"),
    ("nut_contact_angle_deg", "angle nut deg"),
    ("screw_contact_angle_deg", "angle screw deg"),
];

/// Outputs of a record as cells of a row.
#[derive(Debug, Clone)]
pub(crate) struct RecordCells(Map<String, Value>);

impl JsonSchema for RecordCells {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        RecordJson::schema_name()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        RecordJson::json_schema(generator)
    }
}

impl TableRow for RecordCells {
    fn columns() -> Vec<Column> {
        let head = |name: &str| Some(SHOWN.iter().find(|(own, _)| *own == name)?.1);
        RecordJson::names().map(|name| Column::new(name, head(name))).collect()
    }

    fn cells(&self) -> Vec<Value> {
        RecordJson::names().map(|name| self.0[name].clone()).collect()
    }
}

/// Solves a case with all models whose inputs are given, ordered by the number of inputs, and
/// measures the time of one solver run \[µs\]. The answer states why other models are omitted. If
/// the groove is estimated, the numbers have 90 % intervals.
///
/// # Errors
///
/// Returns [`CaseError`] if a value violates a rule, or if an input of the model with the fewest
/// inputs is missing.
pub fn comparison(case: &Case) -> Result<Answer, CaseError> {
    let answer = compared(case, REPEATS)?;
    // The solver time is measured only for the best groove and therefore has no interval.
    Ok(answer.with_groove_intervals(case, FEW_DRAWS, |possible| compared(possible, 0).ok()))
}

/// Solves the case with all models whose inputs are given, without intervals.
///
/// * `repeats`: number of timed solver runs per model.
fn compared(case: &Case, repeats: usize) -> Result<Answer, CaseError> {
    case.check()?;
    let mut work = ModelWorkspace::default();
    let (mut answers, mut left_out, mut shown_reasons) = (Vec::new(), Vec::new(), Vec::new());
    for model in Model::ALL {
        match case.choose(ModelChoice::Fixed(model)) {
            Ok(_) => answers.push(timed(case, model, repeats, &mut work)?),
            Err(error) => {
                shown_reasons.push(error.to_string());
                let reason = reason_without_model(case, model, error);
                left_out.push(LeftOut { model: model.name(), reason });
            }
        }
    }
    if answers.is_empty() {
        // No model can be solved, so the error names the missing inputs of the model with the
        // fewest inputs.
        case.choose(ModelChoice::Fixed(Model::ClosedForm))?;
    }
    // Only models of rolling balls contribute warnings. The table shows where the models with
    // saturated friction do not apply.
    let rolls = |(record, _): &&(Record, f64)| {
        [Model::RacewayControl, Model::Traction].map(Into::into).contains(&record.model())
    };
    let of_answers = answers.iter().filter(rolls).flat_map(|(record, _)| {
        let model = record.model().name();
        record.warnings(case).into_iter().map(move |text| format!("{model}: {text}"))
    });
    let reference = reference_of(&answers);
    let row = |(record, time): &(Record, f64)| {
        let [efficiency_deviation, loss_deviation] =
            reference.as_ref().map_or([None; 2], |reference| reference.deviations(record));
        let is_reference = reference.as_ref().is_some_and(|it| it.model == record.model().name());
        let shown = |deviation: Option<f64>, text: fn(f64) -> String| match deviation {
            Some(_) if is_reference => "reference".to_owned(),
            Some(deviation) => text(deviation),
            None => String::new(),
        };
        ModelRow {
            shown_efficiency_deviation: shown(efficiency_deviation, |it| format!("{it:+.5}")),
            shown_loss_deviation: shown(loss_deviation, |it| format!("{:+.2}", 100.0 * it)),
            record: RecordCells(record.to_json()),
            efficiency_deviation,
            loss_deviation,
            time_us: *time,
            shown_time: format!("{time:.2}"),
        }
    };
    let models = Rows(answers.iter().map(row).collect());
    // The regime is taken from the most complete model that solved the point.
    let regime = answers.iter().rev().find_map(|(record, _)| record.regime());
    let mut notes: Vec<_> = case.given().unused_by_models().chain(case.unused_cycle()).collect();
    let reference_model = reference.map(|reference| reference.model);
    if let Some(name) = reference_model.filter(|name| *name != Model::Traction.name()) {
        notes.push(format!(
            "The deviations refer to model {name}, because model traction has no result here."
        ));
    }
    let mut answer = Answer {
        notes,
        warnings: case.warnings().into_iter().chain(of_answers).collect(),
        fails: answers.iter().any(|(record, _)| record.status() != Status::Converged),
        ..Answer::default()
    }
    .with_members(ModelsCompared {
        regime: Label("regime ", regime.map(str::to_owned)),
        reference_model: Label("reference model ", reference_model.map(str::to_owned)),
        models,
    });
    for (record, _) in &answers {
        let why = record.message().map(str::to_owned);
        answer = answer.with_shown(Content::Text(record.model().name(), why));
    }
    Ok(answer.with_members(ModelsLeftOut {
        left_out: Data(left_out),
        shown_reasons: Sentences("not compared", shown_reasons),
    }))
}

/// The model to which the deviations of the other models refer.
struct Reference {
    /// Name of the model.
    model: &'static str,
    efficiency: f64,
}

impl Reference {
    /// Returns the deviations of a solution from the reference: the difference of the efficiencies,
    /// and the relative difference of the losses.
    fn deviations(&self, record: &Record) -> [Option<f64>; 2] {
        let Some(efficiency) = record.number(output!(efficiency)) else { return [None; 2] };
        let loss = 1.0 - self.efficiency;
        let relative = (loss > 0.0).then(|| (1.0 - efficiency) / loss - 1.0);
        [Some(efficiency - self.efficiency), relative]
    }
}

/// Returns the reference model: `traction` or, if `traction` has no solution, the solved model with
/// the most inputs.
fn reference_of(answers: &[(Record, f64)]) -> Option<Reference> {
    let reference = |(record, _): &(Record, f64)| {
        let efficiency = record.number(output!(efficiency))?;
        Some(Reference { model: record.model().name(), efficiency })
    };
    let is_traction = |(record, _): &&(Record, f64)| record.model() == Model::Traction.into();
    let traction = answers.iter().find(is_traction).and_then(reference);
    traction.or_else(|| answers.iter().rev().find_map(reference))
}

/// Converts the error of [`Case::choose`] for a model to a text that does not name the model, so
/// that the text is the same for all models with the same limitation.
fn reason_without_model(case: &Case, model: Model, error: CaseError) -> String {
    let given = case.stated();
    if given.is_lubricated() && !has_lubricant(model) {
        return NO_LUBRICANT.to_owned();
    }
    let missing = case.missing(model);
    if !missing.is_empty() {
        return format!("{} required{}", list(&missing), given.purpose(""));
    }
    match error {
        CaseError::OutOfRange { key, value, rule, .. } => {
            CaseError::out_of_range(key, value, rule).to_string()
        }
        error => error.to_string(),
    }
}

/// Returns the answer of a model and the time of one solver run \[µs\]. If the number of timed runs
/// is zero, the time is infinite.
fn timed(
    case: &Case,
    model: Model,
    repeats: usize,
    work: &mut ModelWorkspace,
) -> Result<(Record, f64), CaseError> {
    let problem = case.problem(&model.into())?;
    let mut solution = problem.solve(work);
    let mut time = f64::INFINITY;
    for _ in 0..repeats {
        let start = Instant::now();
        solution = problem.solve(work);
        time = time.min(1e6 * start.elapsed().as_secs_f64());
    }
    Ok((Record::new(solution), time))
}
