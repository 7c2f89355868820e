//! `bsm slip` and `bsm jam`: analyses of a solved motion.

use std::path::Path;

use bsm_case::{Analysis, CaseError, Moving, Scene, Settings};
use bsm_dyn::{ModelWorkspace, Solution};
use bsm_validate::Study;
use serde_json::{Value, json};

use crate::args::{AnalysisArgs, Format};
use crate::failure::{Failure, note_unused, warn};
use crate::files::{make_folder, pretty_json, print, read_scene, write, write_figures};
use crate::{solve, table};

/// An analysis of a solution.
type Analyse = fn(&Scene, &Settings, &Solution) -> Result<Analysis, CaseError>;

/// Its sweeps.
type Sweep = fn(&Scene, &Settings, &Solution) -> Result<Study, bsm_validate::ValidateError>;

pub(crate) fn slip(args: &AnalysisArgs) -> Result<(), Failure> {
    run(args, Analysis::slip, Study::slip)
}

pub(crate) fn jam(args: &AnalysisArgs) -> Result<(), Failure> {
    run(args, |scene, _, solution| Analysis::jam(scene, solution), Study::jam)
}

fn run(args: &AnalysisArgs, analyse: Analyse, sweep: Sweep) -> Result<(), Failure> {
    let path = &args.scene.scene;
    let scene = read_scene(path, &args.scene.settings)?;
    let in_file = |e: CaseError| Failure::scene(path, &e);
    let settings = args.model.settings().map_err(in_file)?;
    note_unused(scene.given());
    let work = &mut ModelWorkspace::default();
    let found = scene.problem(&settings).map_err(in_file)?.solve(work);
    let Moving { settings, solution, note } =
        Moving::of(&scene, &settings, found, work).map_err(in_file)?;
    if let Some(words) = note {
        warn("note", &words);
    }
    if solution.reason().is_some() {
        return solve::print(path, &scene, &settings, solution, args.format);
    }
    let report = analyse(&scene, &settings, &solution).map_err(in_file)?;
    let study = match &args.plot {
        Some(_) => Some(sweep(&scene, &settings, &solution)?),
        None => None,
    };
    if let (Some(folder), Some(study)) = (&args.plot, &study) {
        plot(folder, study)?;
    }
    match args.format {
        Format::Json => {
            let mut map = report.to_json();
            if let Some(study) = &study {
                map.insert("trends".to_owned(), json!(study.trends));
            }
            print(&pretty_json(&Value::Object(map)))
        }
        Format::Table => {
            for warning in &report.warnings {
                warn("warning", warning);
            }
            let title = table::title(&scene).map_or_else(String::new, |t| format!("{t}\n\n"));
            let trends = study.map_or_else(String::new, |s| format!("\n\n{}", table::trends(&s)));
            print(&format!("{title}{}{trends}", table::analysis(&report)))
        }
    }
}

/// Writes figures and trends into a folder.
fn plot(folder: &Path, study: &Study) -> Result<(), Failure> {
    make_folder(folder)?;
    write_figures(folder, &study.figures)?;
    write(&folder.join("trends.csv"), &study.csv()?)?;
    warn("note", &format!("wrote figures (SVG and CSV) and trends.csv in {}", folder.display()));
    Ok(())
}
