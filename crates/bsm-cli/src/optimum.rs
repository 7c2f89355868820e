//! `bsm optimum`: best contact angle and self-locking limits.

use bsm_case::{CaseError, OptimumReport, Scene};
use bsm_dyn::Model;
use bsm_report::number;

use crate::args::{Format, OptimumArgs};
use crate::failure::{Failure, warn};
use crate::files::{apply, make_folder, pretty_json, print, read_scene, write_figures};
use crate::table;

pub(crate) fn run(args: &OptimumArgs) -> Result<(), Failure> {
    let scene = if let Some(path) = &args.scene {
        read_scene(path, &args.settings)?
    } else {
        let mut scene = Scene::default();
        apply(&mut scene, &args.settings)?;
        scene
    };
    let model = args.model.as_deref().and_then(Model::from_name);
    let report = OptimumReport::of(&scene, model).map_err(|e: CaseError| match &args.scene {
        Some(path) => Failure::scene(path, &e),
        None => Failure::Input(format!("{e}; give a scene file or --set")),
    })?;
    if let Some(folder) = &args.plot {
        make_folder(folder)?;
        let figures = bsm_report::sheets::lin_figures(&scene)?;
        write_figures(folder, &figures)?;
        let words =
            format!("wrote {} figures (SVG and CSV) in {}", figures.len(), folder.display());
        warn("note", &words);
    }
    match args.format {
        Format::Json => print(&pretty_json(&report.to_json())),
        Format::Table => {
            let rows: Vec<_> = report
                .rows()
                .into_iter()
                .map(|(label, unit, values)| {
                    let cells = values.map(|v| v.map_or_else(|| "none".to_owned(), number));
                    [vec![label.to_owned(), unit.to_owned()], cells.to_vec()].concat()
                })
                .collect();
            for warning in report.warnings() {
                warn("warning", &warning);
            }
            let header = ["closed form", "", "rotary to linear", "linear to rotary"];
            print(&table::plain(Some(&header), &rows, 2))
        }
    }
}
