//! `bsm solve`: one operating point.

use bsm_case::{CaseError, Record, Sensitivities, Sensitivity};
use bsm_dyn::{ModelWorkspace, Solution, Status};
use serde_json::{Map, Value};

use crate::args::{Format, SolveArgs};
use crate::failure::{Failure, warn};
use crate::files::{pretty_json, print, read_scene};
use crate::table;

pub(crate) fn run(args: &SolveArgs) -> Result<(), Failure> {
    let scene = read_scene(&args.scene.scene, &args.scene.settings)?;
    let in_file = |e: CaseError| Failure::scene(&args.scene.scene, &e);
    let settings = args.model.settings().map_err(in_file)?;
    let problem = scene.problem(&settings).map_err(in_file)?;
    let mut work = ModelWorkspace::default();
    let record = Record::new(problem.solve(&mut work));

    if record.status() == Status::InvalidInput {
        let text = record.message().unwrap_or("the model refuses the input");
        return Err(Failure::in_scene(&args.scene.scene, text));
    }
    for warning in scene.warnings().into_iter().chain(record.warnings()) {
        warn("warning", &warning);
    }
    let mut solved = record.status() == Status::Converged;
    let mut rows = None;
    if args.sensitivities && solved {
        let inputs = Sensitivities::of(&scene, &settings).map_err(in_file)?;
        match inputs.problem.sensitivities(&mut work) {
            Ok(answer) => rows = Some(inputs.rows(&answer)),
            Err((status, reason)) => {
                let failed = Record::new(Solution::failed(record.solved_by(), status, reason));
                warn("no sensitivities", failed.message().unwrap_or_default());
                solved = false;
            }
        }
    }
    match args.format {
        Format::Json => {
            let mut map = record.to_json();
            if let Some(rows) = &rows {
                map.insert("sensitivities".to_owned(), by_name(rows));
            }
            print(&pretty_json(&Value::Object(map)))?;
        }
        Format::Table => {
            let blocks = [
                scene.description.clone(),
                Some(table::record(&record)),
                rows.map(|rows| table::sensitivities(&rows)),
            ];
            print(&blocks.into_iter().flatten().collect::<Vec<_>>().join("\n\n"))?;
        }
    }
    if solved { Ok(()) } else { Err(Failure::Unsolved) }
}

fn by_name(rows: &[Sensitivity]) -> Value {
    let entry = |row: &Sensitivity| (row.input.name.to_owned(), row.to_json());
    Value::Object(rows.iter().map(entry).collect::<Map<_, _>>())
}
