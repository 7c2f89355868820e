//! `bsm nut`: all balls of a nut.

use std::path::Path;

use bsm_case::{Case, Columns, NutProblem, Samples};
use bsm_report::sheets::nut_figures;
use rayon::prelude::*;

use crate::answer::{Pictures, Reply};
use crate::args::{NutArgs, NutTable};
use crate::failure::Failure;
use crate::table_job::{form_of, write_numbers};

pub(crate) fn run(args: &NutArgs) -> Result<(), Failure> {
    let in_file = args.case.failure();
    let case = args.case.read()?;
    let endings: &[&'static str] = if args.samples.is_some() {
        &["json"]
    } else {
        &["csv", "jsonl", "parquet", "xlsx", "json"]
    };
    args.out.check(endings, &[Some(args.case.path())])?;
    let settings = args.model.settings()?;
    let problem = NutProblem::of(&case, &settings).map_err(in_file)?;
    let mut figures = Vec::new();
    let answer = if let Some(number) = args.samples {
        let samples = Samples::new(&problem, number, args.seed).map_err(in_file)?;
        let nuts: Vec<_> = (0..number).into_par_iter().map(|i| samples.solve(i)).collect();
        Samples::answer(&nuts, &case)
    } else {
        match problem.solve() {
            Err(none) => NutProblem::unsolved(&case, &none),
            Ok(report) => {
                for path in args.out.tables() {
                    let table = match args.show {
                        NutTable::Balls => report.balls(),
                        NutTable::Curve => report.curve(),
                    };
                    write_columns(path, &table, &case)?;
                }
                if args.out.figures.is_some() {
                    figures = nut_figures(&report);
                }
                report.answer()
            }
        }
    };
    Reply::about(&case, answer).give(&args.out, || Ok(Pictures { figures, ..Pictures::default() }))
}

pub(crate) fn write_columns(path: &Path, table: &Columns, case: &Case) -> Result<(), Failure> {
    let values = |column: usize| table.rows.iter().map(|row| row[column]).collect();
    let values = std::iter::once((0..table.heads.len()).map(values).collect());
    write_numbers(path, form_of(path)?, &table.heads, values, &case.to_json())
}
