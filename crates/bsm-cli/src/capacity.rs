//! `bsm capacity`: ratings of a nut.

use bsm_case::CapacityReport;
use bsm_validate::number;

use crate::args::{CapacityArgs, Format};
use crate::failure::{Failure, warn};
use crate::files::{pretty_json, print, read_scene};
use crate::table;

pub(crate) fn run(args: &CapacityArgs) -> Result<(), Failure> {
    let path = &args.scene.scene;
    let scene = read_scene(path, &args.scene.settings)?;
    let report = CapacityReport::of(&scene).map_err(|e| Failure::scene(path, &e))?;
    match args.format {
        Format::Json => print(&pretty_json(&report.to_json())),
        Format::Table => {
            for warning in report.warnings() {
                warn("warning", warning);
            }
            let rows: Vec<_> = report
                .rows()
                .into_iter()
                .map(|(name, unit, value)| vec![name.to_owned(), unit.to_owned(), number(value)])
                .collect();
            print(&table::plain(None, &rows, 2))
        }
    }
}
