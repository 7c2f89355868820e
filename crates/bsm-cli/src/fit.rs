//! `bsm fit`: an input from a measured output.

use bsm_case::Fit;

use crate::args::{FitArgs, Format};
use crate::failure::{Failure, note_unused};
use crate::files::{pretty_json, print, read_scene};
use crate::table;

pub(crate) fn run(args: &FitArgs) -> Result<(), Failure> {
    let path = &args.scene.scene;
    let in_file = |e| Failure::scene(path, &e);
    let scene = read_scene(path, &args.scene.settings)?;
    let settings = args.model.settings().map_err(in_file)?;
    let fit = Fit::new(&scene, &args.input, args.range, &args.measured)
        .map_err(|e| Failure::Input(e.to_string()))?;
    note_unused(scene.given());
    let report = fit.run(&scene, &settings).map_err(in_file)?;
    match args.format {
        Format::Json => print(&pretty_json(&fit.to_json(&report)))?,
        Format::Table => {
            let records = report.found.iter().map(|found| table::record(&scene, &found.record));
            let blocks: Vec<_> = std::iter::once(fit.describe(&report)).chain(records).collect();
            print(&blocks.join("\n\n"))?;
        }
    }
    if report.found.is_empty() { Err(Failure::Unsolved) } else { Ok(()) }
}
