//! `bsm solve`: one operating point.

use std::path::Path;

use bsm_case::{CaseError, Record, Scene};
use bsm_dyn::{ModelWorkspace, Solution, Status};
use serde_json::Value;

use crate::args::{Format, SolveArgs};
use crate::failure::{Failure, warn};
use crate::files::{self, pretty_json, read_scene};
use crate::table;

pub(crate) fn run(args: &SolveArgs) -> Result<(), Failure> {
    let scene = read_scene(&args.scene.scene, &args.scene.settings)?;
    let in_file = |e: CaseError| Failure::scene(&args.scene.scene, &e);
    let settings = args.model.settings().map_err(in_file)?;
    let problem = scene.problem(&settings).map_err(in_file)?;
    let solution = problem.solve(&mut ModelWorkspace::default());
    print(&args.scene.scene, &scene, solution, args.format)
}

/// Prints a solution, or why there is none.
pub(crate) fn print(
    path: &Path,
    scene: &Scene,
    solution: Solution,
    format: Format,
) -> Result<(), Failure> {
    let record = Record::new(solution);
    if record.status() == Status::InvalidInput {
        let text = record.message().unwrap_or("the model refuses the input");
        return Err(Failure::in_scene(path, text));
    }
    for warning in scene.warnings().into_iter().chain(record.warnings()) {
        warn("warning", &warning);
    }
    match format {
        Format::Json => files::print(&pretty_json(&Value::Object(record.to_json())))?,
        Format::Table => {
            let title =
                scene.description.as_deref().map_or_else(String::new, |d| format!("{d}\n\n"));
            files::print(&format!("{title}{}", table::record(&record)))?;
        }
    }
    match record.status() {
        Status::Converged => Ok(()),
        _ => Err(Failure::Unsolved),
    }
}
