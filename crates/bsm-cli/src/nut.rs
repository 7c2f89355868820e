//! `bsm nut`: all balls of a nut.

use std::path::Path;

use bsm_batch::NumberColumn;
use bsm_case::{BALL_COLUMNS, CURVE_COLUMNS, NutProblem, NutReport, Samples, Scene};
use bsm_report::sheets::nut_figures;
use serde_json::{Value, json};

use crate::args::{Format, NutArgs};
use crate::failure::{Failure, warn};
use crate::files::{keep, pretty_json, print, read_scene, write_figures};
use crate::stream::{Form, form_of, write_numbers};
use crate::table;

pub(crate) fn run(args: &NutArgs) -> Result<(), Failure> {
    let path = &args.scene.scene;
    let in_file = |e| Failure::scene(path, &e);
    let scene = read_scene(path, &args.scene.settings)?;
    let format = |path: &Option<_>, what| path.as_deref().map(|p| form_of(p, what)).transpose();
    let (balls, curve) = (format(&args.table, "--table")?, format(&args.output, "--output")?);
    for output in [&args.table, &args.output] {
        keep(path, output.as_deref())?;
    }
    let settings = args.model.settings().map_err(in_file)?;
    let problem = NutProblem::of(&scene, &settings).map_err(in_file)?;
    for warning in scene.warnings() {
        warn("warning", &warning);
    }
    if let Some(number) = args.samples {
        let samples = Samples::of(&problem, number, args.seed).map_err(in_file)?;
        return print_samples(&scene, &samples, args.format);
    }
    let report = match problem.solve() {
        Ok(report) => report,
        Err(none) => return unsolved(none.status().name(), &none.to_string(), args.format),
    };
    if let (Some(path), Some(format)) = (&args.table, balls) {
        write(path, format, &BALL_COLUMNS, &report.balls(), &scene)?;
    }
    let on_stdout = |path: &Path| path.as_os_str() == "-";
    if let (Some(path), Some(format)) = (&args.output, curve) {
        write(path, format, &CURVE_COLUMNS, &report.curve(), &scene)?;
    }
    if let Some(folder) = &args.plot {
        write_figures(folder, &nut_figures(&report))?;
        warn("note", &format!("wrote figures as SVG and CSV in {}", folder.display()));
    }
    if [&args.table, &args.output].into_iter().flatten().any(|path| on_stdout(path)) {
        return Ok(());
    }
    match args.format {
        Format::Json => print(&pretty_json(&Value::Object(report.to_json()))),
        Format::Table => print_report(&scene, &report),
    }
}

fn print_report(scene: &Scene, report: &NutReport) -> Result<(), Failure> {
    for warning in report.warnings() {
        warn("warning", &warning);
    }
    let title = table::title(scene).map_or_else(String::new, |title| format!("{title}\n\n"));
    let tables = table::nut(&report.numbers(|_| true));
    let mut parts = vec![format!("{title}{tables}\n")];
    parts.extend(report.notes().iter().map(|note| format!("note: {note}")));
    print(&parts.join("\n"))
}

/// There is none: why.
fn unsolved(status: &str, message: &str, format: Format) -> Result<(), Failure> {
    match format {
        Format::Json => print(&pretty_json(&json!({ "status": status, "message": message })))?,
        Format::Table => print(&format!("status   {status}\nmessage  {message}"))?,
    }
    Err(Failure::Unsolved)
}

fn write<const N: usize>(
    path: &Path,
    form: Form,
    columns: &[(&'static str, &'static str); N],
    rows: &[[f64; N]],
    scene: &Scene,
) -> Result<(), Failure> {
    let named = columns.map(|(name, unit)| NumberColumn { name, unit });
    let values = |column: usize| rows.iter().map(|row| row[column]).collect();
    let values = std::iter::once((0..N).map(values).collect());
    write_numbers(path, form, &named, values, &scene.to_json())
}

fn print_samples(scene: &Scene, samples: &Samples, format: Format) -> Result<(), Failure> {
    match format {
        Format::Json => print(&pretty_json(&samples.to_json()))?,
        Format::Table => {
            let cells = |(_, unit, about, quantiles): &(&str, &str, &str, [f64; 5])| {
                let words = [*about, *unit].map(str::to_owned);
                [words.to_vec(), quantiles.map(table::count_or_number).to_vec()].concat()
            };
            let rows: Vec<_> = samples.rows.iter().map(cells).collect();
            let parts = Samples::PARTS.map(|part| format!("{:.0} %", 100.0 * part));
            let mut header = vec!["quantiles", ""];
            header.extend(parts.iter().map(String::as_str));
            let title =
                table::title(scene).map_or_else(String::new, |title| format!("{title}\n\n"));
            let count =
                format!("{} nuts carry the load, {} do not", samples.carried, samples.failed);
            print(&format!("{title}{}\n\n{count}", table::plain(Some(&header), &rows, 2)))?;
        }
    }
    if samples.failed > 0 { Err(Failure::Unsolved) } else { Ok(()) }
}
