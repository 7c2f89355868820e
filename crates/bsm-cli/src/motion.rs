//! `bsm slip` and `bsm jam`: analyses of a solved motion.

use bsm_case::{Analysis, CaseError, Moving, Scene, Settings};
use bsm_dyn::{ModelWorkspace, Solution};
use bsm_report::ReportError;
use bsm_report::sheets::Study;
use serde_json::Value;

use crate::args::{AnalysisArgs, Format};
use crate::failure::{Failure, note_unused, warn};
use crate::files::{make_folder, pretty_json, print, read_scene, write_figures};
use crate::{solve, table};

/// An analysis of a solution.
type Analyse = fn(&Scene, &Settings, &Solution) -> Result<Analysis, CaseError>;

/// Its sweeps.
type Sweep = fn(&Scene, &Settings, &Solution) -> Result<Study, ReportError>;

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
    let Moving { settings, solution } =
        Moving::of(&scene, &settings, &mut ModelWorkspace::default()).map_err(in_file)?;
    if solution.reason().is_some() {
        return solve::print(path, &scene, &settings, solution, args.format);
    }
    let report = analyse(&scene, &settings, &solution).map_err(in_file)?;
    if let Some(folder) = &args.plot {
        let study = sweep(&scene, &settings, &solution)?;
        make_folder(folder)?;
        write_figures(folder, &study.figures)?;
        warn("note", &format!("wrote figures (SVG and CSV) in {}", folder.display()));
    }
    match args.format {
        Format::Json => print(&pretty_json(&Value::Object(report.to_json()))),
        Format::Table => {
            for warning in &report.warnings {
                warn("warning", warning);
            }
            let title = table::title(&scene).map_or_else(String::new, |t| format!("{t}\n\n"));
            print(&format!("{title}{}", table::analysis(&report)))
        }
    }
}
