//! `bsm validate`: published results against ours.

use std::fs;

use bsm_dyn::Model;
use bsm_validate::{Report, TransitionCurve, Verdict};
use serde_json::json;

use crate::args::{Format, ValidateArgs};
use crate::failure::{Failure, warn};
use crate::files::{self, pretty_json, print};
use crate::plot::{self, Curve, Frame, Stroke};
use crate::table;

pub(crate) fn run(args: &ValidateArgs) -> Result<(), Failure> {
    let report = bsm_validate::run().map_err(|e| Failure::Files(e.to_string()))?;
    let results = json!({
        "program": concat!("bsm ", env!("CARGO_PKG_VERSION")),
        "passed": report.passed(),
        "checks": report.checks,
    });
    if let Some(folder) = &args.out {
        fs::create_dir_all(folder).map_err(|e| Failure::files("make folder", folder, &e))?;
        files::write(&folder.join("results.json"), &(pretty_json(&results) + "\n"))?;
        let curves =
            bsm_validate::transition_figure().map_err(|e| Failure::Files(e.to_string()))?;
        files::write(&folder.join("transition.csv"), &transition_table(&curves)?)?;
        files::write(&folder.join("transition.svg"), &transition_plot(&curves))?;
        let named = ["results.json", "transition.csv", "transition.svg"].join(", ");
        warn("note", &format!("wrote {named} in {}", folder.display()));
    }
    match args.format {
        Format::Json => print(&pretty_json(&results))?,
        Format::Table => print(&describe(&report))?,
    }
    if report.passed() { Ok(()) } else { Err(Failure::Unsolved) }
}

fn describe(report: &Report) -> String {
    let rows: Vec<_> = report
        .checks
        .iter()
        .map(|check| {
            let verdict = match check.verdict {
                Verdict::Pass => "pass",
                Verdict::Fail => "FAIL",
                Verdict::Finding => "-",
            };
            vec![
                verdict.to_owned(),
                check.key.clone(),
                check.claimed.map_or_else(String::new, table::number),
                table::number(check.measured),
                check.unit.clone(),
                check.note.clone(),
            ]
        })
        .collect();
    let header = ["", "check", "claimed", "measured", "unit", "where"];
    let failed = report.checks.iter().filter(|c| c.verdict == Verdict::Fail);
    let failures: Vec<_> = failed
        .map(|c| {
            format!(
                "\n\nFAIL {}: {}\n  {} {} must be {}\n  source: {}",
                c.key, c.claim, c.measured, c.unit, c.criterion, c.source
            )
        })
        .collect();
    format!(
        "{}{}\n\n{} passed, {} failed, {} findings without a claim to hold against",
        table::plain(Some(&header), &rows, usize::MAX),
        failures.concat(),
        report.count(Verdict::Pass),
        report.count(Verdict::Fail),
        report.count(Verdict::Finding),
    )
}

/// The transition figure as CSV, one row a point; a point without a result has no efficiency.
fn transition_table(curves: &[TransitionCurve]) -> Result<String, Failure> {
    let mut table = csv::Writer::from_writer(Vec::new());
    let mut rows =
        vec![["model", "axial_load_N", "screw_speed_rpm", "efficiency"].map(String::from)];
    for curve in curves {
        rows.extend(curve.points.iter().map(|(speed, eta)| {
            let eta = if eta.is_finite() { eta.to_string() } else { String::new() };
            [curve.model.name().to_owned(), curve.load.to_string(), speed.to_string(), eta]
        }));
    }
    for row in rows {
        table.write_record(row).map_err(|e| Failure::Files(e.to_string()))?;
    }
    let bytes = table.into_inner().map_err(|e| Failure::Files(e.to_string()))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// The transition figure: a colour for each load, a stroke for each model.
fn transition_plot(curves: &[TransitionCurve]) -> String {
    let mut loads: Vec<f64> = curves.iter().map(|curve| curve.load).collect();
    loads.sort_by(|a, b| b.total_cmp(a));
    loads.dedup();
    let lines: Vec<_> = curves
        .iter()
        .map(|curve| Curve {
            label: Some(format!("{}, {} N", curve.model.name(), curve.load)),
            color: loads.iter().take_while(|load| **load > curve.load).count(),
            stroke: match curve.model {
                Model::Traction => Stroke::Solid,
                Model::RacewayControl => Stroke::Dashed,
                _ => Stroke::Dotted,
            },
            points: curve.points.clone(),
        })
        .collect();
    let frame = Frame {
        title: "From rolling to gross skid: Lin's screw, one ball",
        x_label: "screw speed, rpm",
        y_label: "efficiency",
        log_x: true,
    };
    plot::lines(&frame, &lines)
}
