//! One operating point in every model that it has inputs for.

use std::time::Instant;

use bsm_dyn::{Model, ModelWorkspace, Status};
use serde_json::{Value, json};

use crate::{Answer, CaseError, Column, Content, ModelChoice, Record, Scene, Table};

/// Solves of a model, of which the fastest counts.
const REPEATS: usize = 20;

/// The answer of one model.
#[derive(Debug)]
pub struct ModelAnswer {
    /// The answer.
    pub record: Record,
    /// Time of one solve \[µs\].
    pub time: f64,
}

/// The answers of all models that a scene has inputs for.
#[derive(Debug)]
pub struct Comparison {
    /// By the number of inputs.
    pub answers: Vec<ModelAnswer>,
    /// Why each of the others does not answer.
    pub left_out: Vec<String>,
    /// Inputs that are not in the balance of one ball.
    pub notes: Vec<String>,
    /// Warnings.
    pub warnings: Vec<String>,
}

impl Comparison {
    /// Solves the scene with every model.
    ///
    /// # Errors
    ///
    /// [`CaseError`] if a value breaks a rule, or not even the cheapest model has its inputs.
    pub fn of(scene: &Scene) -> Result<Self, CaseError> {
        scene.check()?;
        let mut work = ModelWorkspace::default();
        let (mut answers, mut left_out) = (Vec::new(), Vec::new());
        for model in Model::ALL {
            match scene.choose(ModelChoice::Fixed(model)) {
                Ok(_) => answers.push(ModelAnswer::of(scene, model, &mut work)?),
                Err(error) => left_out.push(error.to_string()),
            }
        }
        if answers.is_empty() {
            // The cheapest model needs the fewest inputs: what it lacks, all lack.
            scene.choose(ModelChoice::Fixed(Model::ClosedForm))?;
        }
        // What saturated friction leaves out shows in the table already.
        let rolls = |a: &&ModelAnswer| {
            [Model::RacewayControl, Model::Traction].map(Into::into).contains(&a.record.model())
        };
        let of_answers = answers.iter().filter(rolls).flat_map(|a| {
            let model = a.record.model().name();
            a.record.warnings(scene).into_iter().map(move |text| format!("{model}: {text}"))
        });
        let warnings = scene.warnings().into_iter().chain(of_answers).collect();
        let notes = scene.given().unused_by_models().collect();
        Ok(Self { answers, left_out, notes, warnings })
    }

    /// The regime by the most complete model that solved the point.
    pub fn regime(&self) -> Option<&'static str> {
        self.answers.iter().rev().find_map(|answer| answer.record.regime())
    }

    /// True if every model has a solution.
    pub fn is_solved(&self) -> bool {
        self.answers.iter().all(|answer| answer.record.status() == Status::Converged)
    }

    /// The answer: the models side by side.
    pub fn answer(&self) -> Answer {
        /// Outputs of the table for people, with their heads.
        const SHOWN: [(&str, &str); 6] = [
            ("efficiency", "efficiency"),
            ("ball_torque_Nm", "torque N m"),
            ("nut_normal_load_N", "Q nut N"),
            ("screw_normal_load_N", "Q screw N"),
            ("nut_contact_angle_deg", "angle nut deg"),
            ("screw_contact_angle_deg", "angle screw deg"),
        ];
        let shown = SHOWN.map(|(name, head)| Column::headed(name, head));
        let columns = std::iter::once(Column::named("model")).chain(shown);
        let columns =
            columns.chain([Column::headed("", "time us"), Column::named("status")]).collect();
        let row = |ModelAnswer { record, time }: &ModelAnswer| {
            let numbers = SHOWN.map(|(name, _)| json!(record.number(name)));
            let ends = [json!(format!("{time:.2}")), json!(record.status_name())];
            std::iter::once(json!(record.model().name())).chain(numbers).chain(ends).collect()
        };
        let table = Table { columns, rows: self.answers.iter().map(row).collect(), keyed: false };
        let model = |ModelAnswer { record, time }: &ModelAnswer| {
            let mut map = record.to_json();
            map.insert("time_us".to_owned(), json!(time));
            Value::Object(map)
        };
        let mut answer = Answer {
            notes: self.notes.clone(),
            warnings: self.warnings.clone(),
            fails: !self.is_solved(),
            ..Answer::default()
        }
        .with("regime", Content::Text("regime ", self.regime().map(str::to_owned)))
        .with("models", Content::Json(self.answers.iter().map(model).collect()))
        .with_shown(Content::Table(table));
        for ModelAnswer { record, .. } in &self.answers {
            let why = record.message().map(str::to_owned);
            answer = answer.with_shown(Content::Text(record.model().name(), why));
        }
        answer.with("left_out", Content::Texts("not compared", self.left_out.clone()))
    }
}

impl ModelAnswer {
    fn of(scene: &Scene, model: Model, work: &mut ModelWorkspace) -> Result<Self, CaseError> {
        let problem = scene.problem(&model.into())?;
        let mut solution = problem.solve(work);
        let mut time = f64::INFINITY;
        for _ in 0..REPEATS {
            let start = Instant::now();
            solution = problem.solve(work);
            time = time.min(1e6 * start.elapsed().as_secs_f64());
        }
        Ok(Self { record: Record::new(solution), time })
    }
}
