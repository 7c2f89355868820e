//! `bsm capacity`: ratings of a nut.

use std::path::Path;

use bsm_case::{CapacityReport, Spectrum};
use bsm_report::number;

use crate::args::{CapacityArgs, Format};
use crate::failure::{Failure, warn};
use crate::files::{MOST_OF_A_SPECTRUM, keep, pretty_json, print, read, read_scene};
use crate::stream::write_rows;
use crate::table;

pub(crate) fn run(args: &CapacityArgs) -> Result<(), Failure> {
    let path = &args.scene.scene;
    let scene = read_scene(path, &args.scene.settings)?;
    let spectrum = match &args.spectrum {
        Some(table) => Some(read_spectrum(table)?),
        None => None,
    };
    let report =
        CapacityReport::of(&scene, spectrum.as_ref()).map_err(|e| Failure::scene(path, &e))?;
    if let Some(output) = &args.output {
        let mut rows = report.rows();
        if args.steps {
            rows.extend(report.steps());
        }
        keep(path, Some(output))?;
        write_rows(output, &rows, &scene.to_json())?;
    }
    match args.format {
        Format::Json => print(&pretty_json(&report.to_json())),
        Format::Table => {
            for warning in report.warnings() {
                warn("warning", warning);
            }
            let mut rows = table_rows(&report.rows());
            if args.steps {
                rows.extend(table_rows(&report.steps()));
            }
            print(&table::plain(None, &rows, 2))
        }
    }
}

fn table_rows(rows: &[(&str, &str, f64)]) -> Vec<Vec<String>> {
    let row = |(name, unit, value): &(&str, &str, f64)| {
        vec![(*name).to_owned(), (*unit).to_owned(), number(*value)]
    };
    rows.iter().map(row).collect()
}

fn read_spectrum(path: &Path) -> Result<Spectrum, Failure> {
    Spectrum::from_csv(&read(path, MOST_OF_A_SPECTRUM)?).map_err(|e| Failure::scene(path, &e))
}
