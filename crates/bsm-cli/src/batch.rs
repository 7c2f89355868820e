//! `bsm batch`: one row in, one row out.

use std::io::{self, Read};
use std::path::Path;

use bsm_batch::dataset::Points;
use bsm_batch::{CsvSource, Dialect, Source, TableError, Task, Workers};
use bsm_case::Scene;

use crate::args::BatchArgs;
use crate::failure::{Failure, note_unused};
use crate::files::{self, read_scene};
use crate::stream::{Job, format_of, needs_a_file, outputs};

pub(crate) fn run(args: &BatchArgs, workers: &Workers<'_>) -> Result<(), Failure> {
    let mut base = Scene::default();
    if let Some(path) = &args.base {
        base = read_scene(path, &[])?;
        files::keep(path, Some(&args.table.output))?;
    }
    files::apply(&mut base, &args.settings)?;
    let settings = args.model.settings().map_err(|e| Failure::Input(e.to_string()))?;
    let outputs = outputs(&args.table)?;
    needs_a_file(&args.table, &args.points)?;
    let signs = &args.signs;
    let names = files::names_of_columns(signs.columns_from.as_deref())?;
    let (delimiter, decimal) = (char::from(signs.delimiter.byte()), signs.decimal.sign());
    let dialect = Dialect { delimiter, decimal, names };
    let signs = if args.same_signs { dialect.clone() } else { Dialect::default() };
    let mut source = open(&args.points, &args.keep, &dialect)?;
    let task = Task::over_table(base, settings, outputs, source.columns()).map_err(|error| {
        let points = args.points.display();
        Failure::Input(format!("{points}: {error}; add columns, a --base scene or --set"))
    })?;
    note_unused(task.base.given() | source.columns().set());
    let points = Points::Table { path: args.points.clone(), keep: args.keep.clone(), dialect };
    let mut job = Job::new(task, &args.table);
    job.signs = signs;
    job.run(source.as_mut(), &points, workers, |_, _, _| {}).map_err(|e| match e {
        Failure::Table(error) => Failure::table(&args.points, &error),
        other => other,
    })
}

/// Opens a table by the ending of its name; `-` is CSV on standard input.
pub(crate) fn open(
    path: &Path,
    keep: &[String],
    dialect: &Dialect,
) -> Result<Box<dyn Source>, Failure> {
    let format = format_of(path, "POINTS")?;
    let source: Result<Box<dyn Source>, TableError> = if path.as_os_str() == "-" {
        let reader: Box<dyn Read + Send> = Box::new(io::stdin());
        CsvSource::with(reader, keep, dialect).map(|source| Box::new(source) as Box<dyn Source>)
    } else {
        format.open_as(path, keep, dialect)
    };
    source.map_err(|e| Failure::table(path, &e))
}
