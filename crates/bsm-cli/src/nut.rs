//! `bsm nut`: all balls of a nut.

use std::path::Path;

use bsm_batch::NumberColumn;
use bsm_case::{BALL_COLUMNS, CURVE_COLUMNS, NutProblem, Samples, Scene};
use bsm_report::sheets::nut_figures;
use serde_json::{Value, json};

use crate::answer::{Answer, Drawn};
use crate::args::{NutArgs, NutTable};
use crate::failure::Failure;
use crate::stream::{form_of, write_numbers};
use crate::table;

pub(crate) fn run(args: &NutArgs) -> Result<(), Failure> {
    let in_file = args.scene.failure();
    let scene = args.scene.read()?;
    let endings: &[&'static str] = if args.samples.is_some() {
        &["json"]
    } else {
        &["csv", "jsonl", "parquet", "xlsx", "json"]
    };
    args.out.check(endings, &[Some(args.scene.path())])?;
    let settings = args.model.settings().map_err(in_file)?;
    let problem = NutProblem::of(&scene, &settings).map_err(in_file)?;
    let mut figures = Vec::new();
    let answer = if let Some(number) = args.samples {
        quantiles(&Samples::of(&problem, number, args.seed).map_err(in_file)?)
    } else {
        match problem.solve() {
            Err(none) => unsolved(none.status().name(), &none.to_string()),
            Ok(report) => {
                for path in args.out.tables() {
                    match args.show {
                        NutTable::Balls => write(path, &BALL_COLUMNS, &report.balls(), &scene)?,
                        NutTable::Curve => write(path, &CURVE_COLUMNS, &report.curve(), &scene)?,
                    }
                }
                if args.out.figures.is_some() {
                    figures = nut_figures(&report);
                }
                let notes =
                    report.notes().iter().map(|note| format!("note: {note}")).collect::<Vec<_>>();
                Answer {
                    text: format!(
                        "{}\n\n{}",
                        table::nut(&report.numbers(|_| true)),
                        notes.join("\n")
                    ),
                    json: Value::Object(report.to_json()),
                    warnings: report.warnings(),
                    ..Answer::default()
                }
            }
        }
    };
    let warnings = scene.warnings().into_iter().chain(answer.warnings).collect();
    let answer = Answer { warnings, ..answer };
    Answer::of_parts(&scene, vec![("nut", answer)])
        .give(&args.out, || Ok(Drawn { figures, page: None }))
}

/// There is none: why.
fn unsolved(status: &str, message: &str) -> Answer {
    Answer {
        text: format!("status   {status}\nmessage  {message}"),
        json: json!({ "status": status, "message": message }),
        failed: true,
        ..Answer::default()
    }
}

fn write<const N: usize>(
    path: &Path,
    columns: &[(&'static str, &'static str); N],
    rows: &[[f64; N]],
    scene: &Scene,
) -> Result<(), Failure> {
    let named = columns.map(|(name, unit)| NumberColumn { name, unit });
    let values = |column: usize| rows.iter().map(|row| row[column]).collect();
    let values = std::iter::once((0..N).map(values).collect());
    write_numbers(path, form_of(path)?, &named, values, &scene.to_json())
}

/// Quantiles of drawn nuts.
fn quantiles(samples: &Samples) -> Answer {
    let cells = |(_, unit, about, quantiles): &(&str, &str, &str, [f64; 5])| {
        let words = [*about, *unit].map(str::to_owned);
        [words.to_vec(), quantiles.map(table::count_or_number).to_vec()].concat()
    };
    let rows: Vec<_> = samples.rows.iter().map(cells).collect();
    let parts = Samples::PARTS.map(|part| format!("{:.0} %", 100.0 * part));
    let mut header = vec!["quantiles", ""];
    header.extend(parts.iter().map(String::as_str));
    let count = format!("{} nuts carry the load, {} do not", samples.carried, samples.failed);
    Answer {
        text: format!("{}\n\n{count}", table::plain(Some(&header), &rows, 2)),
        json: samples.to_json(),
        failed: samples.failed > 0,
        ..Answer::default()
    }
}
