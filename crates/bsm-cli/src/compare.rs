//! `bsm compare`: one operating point, every model.

use std::time::Instant;

use bsm_case::{CaseError, Record, Scene};
use bsm_dyn::{Model, ModelWorkspace, Status};
use bsm_report::number;
use serde_json::{Value, json};

use crate::args::{CompareArgs, Format};
use crate::failure::{Failure, note_unused, warn};
use crate::files::{pretty_json, print, read_scene};
use crate::table;

/// Solves of a model, of which the fastest is shown.
const REPEATS: usize = 20;

/// Columns: label, output.
const COLUMNS: &[(&str, &str)] = &[
    ("efficiency", "efficiency"),
    ("torque N m", "screw_torque_Nm"),
    ("Q nut N", "nut_normal_load_N"),
    ("Q screw N", "screw_normal_load_N"),
    ("angle nut deg", "nut_contact_angle_deg"),
    ("angle screw deg", "screw_contact_angle_deg"),
];

/// The answer of one model.
struct Answer {
    record: Record,
    /// Time of one solve \[µs\].
    time: f64,
}

pub(crate) fn run(args: &CompareArgs) -> Result<(), Failure> {
    let path = &args.scene.scene;
    let scene = read_scene(path, &args.scene.settings)?;
    let in_file = |e: CaseError| Failure::scene(path, &e);
    scene.check().map_err(in_file)?;
    // The cheapest model needs the fewest inputs: without them there is nothing to compare.
    scene.choose(bsm_case::ModelChoice::Fixed(Model::ClosedForm)).map_err(in_file)?;

    note_unused(scene.given());
    let mut work = ModelWorkspace::default();
    let (mut answers, mut left_out) = (Vec::new(), Vec::new());
    for model in Model::ALL {
        if scene.suits(model) {
            answers.push(solve(&scene, model, &mut work).map_err(in_file)?);
        } else {
            let error = scene.choose(bsm_case::ModelChoice::Fixed(model)).err();
            left_out.push(error.map_or_else(String::new, |e| e.to_string()));
        }
    }
    // What saturated friction leaves out shows in the table already.
    let rolls = |a: &&Answer| {
        [Model::RacewayControl, Model::Traction].map(Into::into).contains(&a.record.model())
    };
    let of_answers = answers.iter().filter(rolls).flat_map(|a| {
        let model = a.record.model().name();
        a.record.warnings(&scene).into_iter().map(move |text| format!("{model}: {text}"))
    });
    for warning in scene.warnings().into_iter().chain(of_answers) {
        warn("warning", &warning);
    }
    match args.format {
        Format::Json => {
            let models: Vec<_> = answers.iter().map(to_json).collect();
            print(&pretty_json(&json!({ "regime": regime(&answers), "models": models })))?;
        }
        Format::Table => print(&text(&scene, &answers, &left_out))?,
    }
    let solved = answers.iter().all(|answer| answer.record.status() == Status::Converged);
    if solved { Ok(()) } else { Err(Failure::Unsolved) }
}

fn solve(scene: &Scene, model: Model, work: &mut ModelWorkspace) -> Result<Answer, CaseError> {
    let problem = scene.problem(&model.into())?;
    let mut solution = problem.solve(work);
    let mut time = f64::INFINITY;
    for _ in 0..REPEATS {
        let start = Instant::now();
        solution = problem.solve(work);
        time = time.min(1e6 * start.elapsed().as_secs_f64());
    }
    Ok(Answer { record: Record::new(solution), time })
}

/// The regime in the words of the most complete model that solved the point.
fn regime(answers: &[Answer]) -> Option<&'static str> {
    answers.iter().rev().find_map(|answer| answer.record.regime())
}

fn to_json(answer: &Answer) -> Value {
    let mut map = answer.record.to_json();
    map.insert("time_us".to_owned(), json!(answer.time));
    Value::Object(map)
}

fn text(scene: &Scene, answers: &[Answer], left_out: &[String]) -> String {
    let header: Vec<_> = ["model"]
        .into_iter()
        .chain(COLUMNS.iter().map(|(label, _)| *label))
        .chain(["time us", "status"])
        .collect();
    let rows: Vec<_> = answers
        .iter()
        .map(|Answer { record, time }| {
            let cells = COLUMNS
                .iter()
                .map(|(_, name)| record.number(name).map_or_else(|| "-".to_owned(), number));
            std::iter::once(record.model().name().to_owned())
                .chain(cells)
                .chain([format!("{time:.2}"), record.status_name().to_owned()])
                .collect()
        })
        .collect();
    let mut blocks: Vec<_> = table::title(scene).into_iter().collect();
    if let Some(regime) = regime(answers) {
        blocks.push(format!("regime  {regime}"));
    }
    blocks.push(table::plain(Some(&header), &rows, 1));
    let reasons: Vec<_> = answers
        .iter()
        .filter_map(|a| Some(format!("{}: {}", a.record.model().name(), a.record.message()?)))
        .chain(left_out.iter().map(|why| format!("not compared: {why}")))
        .collect();
    if !reasons.is_empty() {
        blocks.push(reasons.join("\n"));
    }
    blocks.join("\n\n")
}
