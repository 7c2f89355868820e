//! One operating point in every model that it has inputs for.

use std::time::Instant;

use bsm_dyn::{Model, ModelWorkspace, Status};
use serde_json::{Value, json};

use crate::{CaseError, ModelChoice, Record, Scene};

/// Solves of a model, of which the fastest counts.
const REPEATS: usize = 20;

/// The answer of one model.
#[derive(Debug)]
pub struct Compared {
    /// The answer.
    pub record: Record,
    /// Time of one solve \[µs\].
    pub time: f64,
}

/// The answers of all models that a scene has inputs for.
#[derive(Debug)]
pub struct Comparison {
    /// By the number of inputs.
    pub answers: Vec<Compared>,
    /// Why each of the others does not answer.
    pub left_out: Vec<String>,
    /// What an engineer should know before using the numbers.
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
                Ok(_) => answers.push(Compared::of(scene, model, &mut work)?),
                Err(error) => left_out.push(error.to_string()),
            }
        }
        if answers.is_empty() {
            // The cheapest model needs the fewest inputs: what it lacks, all lack.
            scene.choose(ModelChoice::Fixed(Model::ClosedForm))?;
        }
        // What saturated friction leaves out shows in the table already.
        let rolls = |a: &&Compared| {
            [Model::RacewayControl, Model::Traction].map(Into::into).contains(&a.record.model())
        };
        let of_answers = answers.iter().filter(rolls).flat_map(|a| {
            let model = a.record.model().name();
            a.record.warnings(scene).into_iter().map(move |text| format!("{model}: {text}"))
        });
        let warnings = scene.warnings().into_iter().chain(of_answers).collect();
        Ok(Self { answers, left_out, warnings })
    }

    /// The regime in the words of the most complete model that solved the point.
    pub fn regime(&self) -> Option<&'static str> {
        self.answers.iter().rev().find_map(|answer| answer.record.regime())
    }

    /// True if every model has a solution.
    pub fn is_solved(&self) -> bool {
        self.answers.iter().all(|answer| answer.record.status() == Status::Converged)
    }

    /// JSON object of the regime and of the answers, each with its time.
    pub fn to_json(&self) -> Value {
        let model = |answer: &Compared| {
            let mut map = answer.record.to_json();
            map.insert("time_us".to_owned(), json!(answer.time));
            Value::Object(map)
        };
        let models: Vec<_> = self.answers.iter().map(model).collect();
        json!({ "regime": self.regime(), "models": models })
    }
}

impl Compared {
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
