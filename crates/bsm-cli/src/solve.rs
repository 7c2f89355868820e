//! `bsm solve`: one operating point.

use std::path::Path;

use bsm_case::{
    CaseError, Record, Scene, Sensitivities, Sensitivity, Settings, SizePhase, torque_parts,
};
use bsm_dyn::{Band, ModelWorkspace, Problem, Solution, Status};
use bsm_report::PROGRAM;
use serde_json::{Map, Value};

use crate::args::{Format, SolveArgs, When};
use crate::failure::{Failure, note_unused, warn};
use crate::files::{self, pretty_json, read_scene};
use crate::table;

pub(crate) fn run(args: &SolveArgs) -> Result<(), Failure> {
    let path = &args.scene.scene;
    let scene = read_scene(path, &args.scene.settings)?;
    let in_file = |e: CaseError| Failure::scene(path, &e);
    let settings = args.model.settings().map_err(in_file)?;
    note_unused(scene.given());
    let problem = scene.problem(&settings).map_err(in_file)?;
    let mut work = ModelWorkspace::default();
    let solution = problem.solve(&mut work);
    let wanted = match args.band {
        When::Table => args.format == Format::Table,
        When::Always => true,
        When::Never => false,
    };
    let band = match (&problem, solution.solved()) {
        (Problem::Lubricated(case), Some(solved)) if wanted => case.band(solved, &mut work),
        _ => None,
    };
    let parts = torque_parts(&scene, &settings).unwrap_or_else(|why| {
        warn("note", &format!("no torque of the whole screw: {why}"));
        None
    });
    let also = Also { band, parts, sensitivities: None };
    let asked = (path.as_path(), &scene, &settings);
    if !args.sensitivities || solution.status() != Status::Converged {
        return print_with(asked, solution, &also, args.format);
    }
    let inputs = Sensitivities::of(&scene, &settings).map_err(in_file)?;
    match inputs.solve(&mut work) {
        Ok((_, rows)) => {
            let also = Also { sensitivities: Some(rows), ..also };
            print_with(asked, solution, &also, args.format)
        }
        Err(none) => {
            let failed = Record::new(Solution::new(solution.model, Err(none)));
            warn("no sensitivities", failed.message().unwrap_or_default());
            print_with(asked, solution, &also, args.format).and(Err(Failure::Unsolved))
        }
    }
}

/// What is printed with a solution.
#[derive(Default)]
struct Also {
    /// How sure a friction from the lubricant is.
    band: Option<Band>,
    /// The torque of the whole screw by its parts.
    parts: Option<SizePhase>,
    sensitivities: Option<Vec<Sensitivity>>,
}

/// Prints a solution, or why there is none.
pub(crate) fn print(
    path: &Path,
    scene: &Scene,
    settings: &Settings,
    solution: Solution,
    format: Format,
) -> Result<(), Failure> {
    print_with((path, scene, settings), solution, &Also::default(), format)
}

fn print_with(
    (path, scene, settings): (&Path, &Scene, &Settings),
    solution: Solution,
    Also { band, parts, sensitivities }: &Also,
    format: Format,
) -> Result<(), Failure> {
    let record = Record::new(solution);
    if record.status() == Status::InvalidInput {
        let text = record.message().unwrap_or("the model refuses the input");
        return Err(Failure::in_scene(path, text));
    }
    for warning in scene.warnings().into_iter().chain(record.warnings(scene)) {
        warn("warning", &warning);
    }
    for note in record.notes() {
        warn("note", &note);
    }
    match format {
        Format::Json => {
            let mut map = record.report(PROGRAM, scene, settings, band.as_ref(), parts.as_ref());
            if let Some(rows) = sensitivities {
                let entry = |row: &Sensitivity| (row.input.name.to_owned(), row.to_json());
                let rows: Map<_, _> = rows.iter().map(entry).collect();
                map.insert("sensitivities".to_owned(), Value::Object(rows));
            }
            files::print(&pretty_json(&Value::Object(map)))?;
        }
        Format::Table => {
            let blocks = [
                table::title(scene),
                parts.as_ref().map(table::torque_parts),
                Some(table::record(scene, &record)),
                band.as_ref().map(table::band),
                sensitivities.as_deref().map(table::sensitivities),
            ];
            files::print(&blocks.into_iter().flatten().collect::<Vec<_>>().join("\n\n"))?;
        }
    }
    match record.status() {
        Status::Converged => Ok(()),
        _ => Err(Failure::Unsolved),
    }
}
