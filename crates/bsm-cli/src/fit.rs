//! `bsm fit`: inputs from measured outputs.

use std::path::Path;

use bsm_case::{Calibration, CalibrationReport, CaseError, Fit, Scene, Settings};
use bsm_report::{Axis, Curve, Figure, Stroke, number};

use crate::args::{FitArgs, Format};
use crate::failure::{Failure, note_unused, of_input};
use crate::files::{self, pretty_json, print, read_scene};
use crate::table;

/// More measurements than this are none \[B\].
const LARGEST: u64 = 16 << 20;

pub(crate) fn run(args: &FitArgs) -> Result<(), Failure> {
    let path = &args.scene.scene;
    let in_file = |e| Failure::scene(path, &e);
    let scene = read_scene(path, &args.scene.settings)?;
    let settings = args.model.settings().map_err(in_file)?;
    if let Some(data) = &args.data {
        return to_table(args, data, &scene, &settings);
    }
    let [input] = &args.input[..] else {
        let text = "one measured point gives one --input; several need --data";
        return Err(Failure::Input(text.to_owned()));
    };
    let fit = Fit::new(&scene, input, args.range, &args.measured)
        .map_err(|e| Failure::Input(of_input(&e)))?;
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

/// Inputs that come closest to all points of a table.
fn to_table(
    args: &FitArgs,
    data: &Path,
    scene: &Scene,
    settings: &Settings,
) -> Result<(), Failure> {
    let bytes = files::read(data, LARGEST)?;
    let usage = |e: CaseError| Failure::input(data.display(), &e);
    let fit = Calibration::new(scene, &args.input, &args.measured, &bytes[..]).map_err(usage)?;
    let Some(report) = fit.run(scene, settings).map_err(usage)? else {
        return Err(Failure::Check(format!("{}, --input NAME=LOW:HIGH", Calibration::LOST)));
    };
    if let Some(path) = &args.plot {
        files::write(path, &figure(&fit, &report).svg())?;
    }
    match args.format {
        Format::Json => print(&pretty_json(&fit.to_json(&report))),
        Format::Table => print(&words(&fit, &report)),
    }
}

/// The values, what they leave over, and each point.
fn words(fit: &Calibration, report: &CalibrationReport) -> String {
    let cell = |value: Option<f64>| value.map_or_else(String::new, number);
    let found: Vec<_> = fit
        .rows(report)
        .into_iter()
        .map(|(name, value, deviation)| vec![name.to_owned(), number(value), cell(deviation)])
        .collect();
    let points: Vec<_> = fit
        .fitted(report)
        .enumerate()
        .map(|(i, (measured, fitted))| {
            let numbers = [measured, fitted, fitted - measured].map(number);
            [vec![(i + 1).to_string()], numbers.to_vec()].concat()
        })
        .collect();
    let told = format!(
        "root mean square of what is left: {} ({})\ncondition: {}{}",
        number(report.scatter),
        fit.output(),
        number(report.found.condition),
        if report.found.condition > 1e3 { ": the points hardly tell the inputs apart" } else { "" }
    );
    let header = ["point", "measured", "fitted", "difference"];
    [
        table::plain(Some(&["input", "value", "standard deviation"]), &found, 1),
        told,
        table::plain(Some(&header), &points, 1),
    ]
    .join("\n\n")
}

/// Fitted over measured values, and the line on which they agree.
fn figure(fit: &Calibration, report: &CalibrationReport) -> Figure {
    let all: Vec<_> = fit.fitted(report).collect();
    let values = all.iter().flat_map(|(a, b)| [*a, *b]);
    let (low, high) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    let found: Vec<_> = fit
        .rows(report)
        .into_iter()
        .map(|(name, value, _)| format!("{name} = {}", number(value)))
        .collect();
    Figure {
        key: "fit".to_owned(),
        title: format!("{} with {}", fit.output(), found.join(", ")),
        caption: String::new(),
        x: Axis::linear(&format!("measured {}", fit.output())),
        y: Axis::linear(&format!("fitted {}", fit.output())),
        curves: vec![
            Curve::new("equal", 0, Stroke::Solid, vec![(low, low), (high, high)]),
            Curve::new("points", 1, Stroke::Circles, all),
        ],
    }
}
