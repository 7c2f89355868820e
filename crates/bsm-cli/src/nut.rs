//! `bsm nut`: solves all balls of a nut.

use std::path::Path;

use bsm_case::{
    Case, ColumnValues, Columns, NutProblem, NutReport, Samples, ShownColumn, TableFormat,
};
use bsm_report::sheets::nut_figures;
use rayon::prelude::*;

use crate::answer::{Pictures, Reply, WriteTable};
use crate::args::{NutArgs, NutTable};
use crate::failure::Failure;
use crate::files::InputFiles;
use crate::progress::show_spinner;
use crate::table_job::write_columns;

pub(crate) fn run(args: &NutArgs) -> Result<(), Failure> {
    let in_file = args.case.failure();
    let case = args.case.read()?;
    let endings: &[&'static str] = if args.samples.is_some() {
        &["json"]
    } else {
        &["csv", "jsonl", "parquet", "xlsx", "json"]
    };
    let to = args.out.check(endings, InputFiles::of([Some(args.case.path())]))?;
    let settings = args.model.settings()?;
    let line = show_spinner("calculating all balls of the nut");
    let problem = NutProblem::of(&case, &settings).map_err(in_file)?;
    let settings = problem.settings();
    let (mut figures, mut table) = (Vec::new(), None);
    let answer = if let Some(number) = args.samples {
        let samples = Samples::new(&problem, number, args.seed).map_err(in_file)?;
        let nuts: Vec<_> = (0..number).into_par_iter().map(|i| samples.solve(i)).collect();
        let answer = Samples::answer(&nuts, &case);
        Samples::with_groove_intervals(answer, &case, &settings, number, args.seed)
    } else {
        let answer = match problem.solve() {
            Err(none) => NutProblem::unsolved(&case, &none),
            Ok(report) => {
                if !args.out.output.is_empty() {
                    table = Some(match args.show {
                        NutTable::Balls => report.balls(),
                        NutTable::Curve => report.curve(),
                    });
                }
                if args.out.figures.is_some() {
                    let units = case.display_units();
                    let drawn = nut_figures(&report).into_iter();
                    figures = drawn.map(|figure| figure.in_units(units)).collect();
                }
                report.answer()
            }
        };
        NutReport::with_groove_intervals(answer, &case, &settings)
    };
    drop(line);
    let reply = Reply {
        table: table.map(|table| table_writer(table, &case)),
        ..Reply::about(&case, answer)
    };
    reply.deliver(&to, || Ok(Pictures { figures, ..Pictures::default() }))
}

/// Returns a function that writes the given columns and the case from which they were calculated.
pub(crate) fn table_writer(table: Columns, case: &Case) -> WriteTable<'_> {
    Box::new(move |path| write(path, &table, case))
}

fn write(path: &Path, table: &Columns, case: &Case) -> Result<(), Failure> {
    let heads: Vec<_> = table.heads.iter().map(|head| (head.name.to_owned(), head.unit)).collect();
    let shown = ShownColumn::select(&heads, None, case.display_units());
    let shown = shown.map_err(|e| Failure::Input(e.to_string()))?;
    let values = |column: usize| table.rows.iter().map(|row| row[column]).collect();
    let values = (0..heads.len()).map(|column| ColumnValues::Numbers(values(column))).collect();
    let format = TableFormat::default();
    write_columns(path, &shown, std::iter::once(values), &case.to_json(), &format)
}
