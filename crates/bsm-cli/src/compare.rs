//! `bsm compare`: one operating point, every model.

use bsm_case::{CaseError, Compared, Comparison, Scene};
use bsm_report::number;

use crate::args::{CompareArgs, Format};
use crate::failure::{Failure, note_unused, warn};
use crate::files::{pretty_json, print, read_scene};
use crate::table;

/// Columns: label, output.
const COLUMNS: &[(&str, &str)] = &[
    ("efficiency", "efficiency"),
    ("torque N m", "screw_torque_Nm"),
    ("Q nut N", "nut_normal_load_N"),
    ("Q screw N", "screw_normal_load_N"),
    ("angle nut deg", "nut_contact_angle_deg"),
    ("angle screw deg", "screw_contact_angle_deg"),
];

pub(crate) fn run(args: &CompareArgs) -> Result<(), Failure> {
    let path = &args.scene.scene;
    let scene = read_scene(path, &args.scene.settings)?;
    let compared = Comparison::of(&scene).map_err(|e: CaseError| Failure::scene(path, &e))?;
    note_unused(scene.given());
    for warning in &compared.warnings {
        warn("warning", warning);
    }
    match args.format {
        Format::Json => print(&pretty_json(&compared.to_json()))?,
        Format::Table => print(&text(&scene, &compared))?,
    }
    if compared.is_solved() { Ok(()) } else { Err(Failure::Unsolved) }
}

fn text(scene: &Scene, compared: &Comparison) -> String {
    let Comparison { answers, left_out, .. } = compared;
    let header: Vec<_> = ["model"]
        .into_iter()
        .chain(COLUMNS.iter().map(|(label, _)| *label))
        .chain(["time us", "status"])
        .collect();
    let rows: Vec<_> = answers
        .iter()
        .map(|Compared { record, time }| {
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
    if let Some(regime) = compared.regime() {
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
