//! Runs the batch pipeline from points to a table or a dataset folder, and prints its messages.

use std::collections::HashSet;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

#[cfg(feature = "xlsx")]
use bsm_batch::Cell;
#[cfg(feature = "parquet")]
use bsm_batch::dataset::{self, Dataset, Event, Plan, RunOptions};
use bsm_batch::dataset::{DatasetError, PartDefect, Points, sha256};
use bsm_batch::{
    AnswerSink, Answers, Chunk, ColumnHead, ColumnUnits, ConvertingSink, Count, CsvSource, Format,
    RunError, Source, TableError, TableFormat, TableSink, Task, Workers,
};
use bsm_case::{
    ColumnValues, DisplayUnits, Grid, GridAxis, ModelChoice, Output, ShownColumn, format_exact,
};
use bsm_dyn::Status;
use bsm_report::PROGRAM;
#[cfg(feature = "parquet")]
use indicatif::{HumanBytes, ProgressBar};
use serde_json::{Value, json};

use crate::args::SweepArgs;
use crate::console::print_message;
use crate::failure::{Failure, table_error_text};
use crate::files::{self, OutputFile, ending_of, is_stdout, pretty_json};
use crate::progress::progress;
#[cfg(feature = "parquet")]
use crate::unfinished;
#[cfg(feature = "xlsx")]
use crate::workbook::{self, Workbook};

/// File extensions of output tables.
pub(crate) const TABLES: [&str; 4] = ["csv", "jsonl", "parquet", "xlsx"];

/// Number of rows above which the program recommends calculating the results again instead of
/// storing them. Reading a terabyte from files takes longer than calculating these rows again.
#[cfg(feature = "parquet")]
const MANY_ROWS: u64 = 10_000_000_000;

/// File extensions of input tables. Workbooks cannot be read.
const POINTS: [&str; 3] = ["csv", "jsonl", "parquet"];

/// A batch run: its task, command-line options and output files.
pub(crate) struct Job<'a> {
    pub(crate) task: Task,
    pub(crate) args: &'a SweepArgs,
    /// Output table, or `None` if only plots are requested.
    pub(crate) table: Option<&'a Path>,
    /// JSON file that describes the origin of the table.
    pub(crate) about: Option<&'a Path>,
    /// Format of CSV output: separators and decimal sign.
    pub(crate) table_format: TableFormat,
    /// Units of the table columns.
    pub(crate) units: ColumnUnits,
}

/// A sink that discards rows, for runs that only draw plots.
struct Discard;

impl AnswerSink for Discard {
    fn write(&mut self, _: Chunk, _: Answers) -> Result<(), TableError> {
        Ok(())
    }
}

impl Job<'_> {
    /// Solves all rows, writes them to a table or a dataset folder, and reports the number of rows
    /// without a result. The function `each` is called for every solved chunk, with the values of
    /// the plotted output.
    ///
    /// * `source`: source of the rows to solve.
    /// * `points`: description of the points, which is stored in the plan of a dataset.
    pub(crate) fn run(
        &self,
        source: &mut dyn Source,
        points: &Points,
        workers: &Workers<'_>,
        mut each: impl FnMut(&Chunk, &Answers, &[f64]),
    ) -> Result<(), Failure> {
        let mut changes = match points {
            Points::Grid(grid) if self.task.settings.model == ModelChoice::Auto => {
                Some(Changes::along(grid))
            }
            _ => None,
        };
        let mut watch = |chunk: &Chunk, answers: &Answers| {
            if let Some(changes) = &mut changes {
                changes.add(chunk, answers);
            }
            if let Some(index) = self.task.watched_index() {
                each(chunk, answers, &answers.columns[index]);
            }
        };
        let folder = self.table.filter(|path| is_folder(path));
        if let Some(folder) = folder.filter(|_| self.args.plan) {
            return self.plan(folder, points, workers);
        }
        let Count { rows, failed, with_other_solutions } = if let Some(folder) = folder {
            self.fill_folder(folder, points, workers, &mut watch)?
        } else {
            let bar = progress(source.len_hint(), "rows", self.args.work.quiet);
            let mut seen = |chunk: &Chunk, answers: &Answers| {
                bar.inc(chunk.len as u64);
                watch(chunk, answers);
            };
            let count = if let Some(path) = self.table {
                self.write_file(path, source, points, workers, &mut seen)
            } else {
                let run = self.task.run(source, Discard, u64::MAX, workers, &mut seen);
                run.map(|(_, count)| count).map_err(|error| run_failure(Path::new("-"), error))
            };
            bar.finish_and_clear();
            count?
        };
        if let Some(text) = changes.and_then(|changes| changes.note()) {
            print_message("note", &text);
        }
        if with_other_solutions > 0 {
            let have = if with_other_solutions == 1 { "has" } else { "have" };
            let is_written = self.task.outputs.iter().any(|o| o.name == "other_solutions");
            let hint = if is_written { "see the column" } else { "list them with --columns" };
            let text = format!(
                "{with_other_solutions} of {rows} rows {have} other solutions; {hint} other_solutions"
            );
            print_message("note", &text);
        }
        if failed == 0 {
            return Ok(());
        }
        let why = match self.table {
            Some(path) => format!("see column `message` in {}", path.display()),
            None => "write a table to see the reasons".to_owned(),
        };
        print_message("note", &format!("{failed} of {rows} rows have no result; {why}"));
        if self.args.keep_going { Ok(()) } else { Err(Failure::Unsolved) }
    }

    fn write_file(
        &self,
        path: &Path,
        source: &mut dyn Source,
        points: &Points,
        workers: &Workers<'_>,
        seen: &mut dyn FnMut(&Chunk, &Answers),
    ) -> Result<Count, Failure> {
        let form = form_of(path)?;
        // Text formats cannot store metadata. The metadata that describe how the table was made are
        // created only if they are needed, because creating them requires reading the whole table
        // of points.
        let is_text = matches!(form, Form::Table(Format::Csv | Format::JsonLines));
        let mut about = if is_text && self.about.is_none() {
            Value::Null
        } else {
            let points = points.about(workers).map_err(|error| dataset_failure(path, error))?;
            self.task.about(&points, source.columns())
        };
        let failed = |error| run_failure(path, error);
        let outputs = &self.task.outputs;
        let count = match form {
            Form::Table(format) => {
                let out = OutputFile::create(path)?;
                let columns = (self.units.schema(source.columns(), outputs), &outputs[..]);
                let sink = TableSink::with_schema(format, out, columns, &self.table_format);
                let sink = sink.map_err(|error| write_error(path, &error))?;
                let sink = self.units.converting(sink, source.columns(), outputs);
                let run = self.task.run(source, sink, u64::MAX, workers, seen);
                let (ConvertingSink { sink, .. }, count) = run.map_err(failed)?;
                let out = sink.finish(Some(&about.to_string()));
                out.map_err(|error| write_error(path, &error))?.complete()?;
                count
            }
            #[cfg(feature = "xlsx")]
            Form::Workbook => {
                if let Some(rows) = source.len_hint().filter(|rows| *rows > workbook::MAX_ROWS) {
                    return Err(files::refused(path, &workbook::too_many(&rows.to_string())));
                }
                let out = OutputFile::create(path)?;
                let book = Workbook::of_answers(&self.units, source.columns(), outputs);
                let book = book.map_err(|error| write_error(path, &error))?;
                let book = self.units.converting(book, source.columns(), outputs);
                let run = self.task.run(source, book, u64::MAX, workers, seen);
                let (ConvertingSink { sink: book, .. }, count) = run.map_err(failed)?;
                let bytes = book.finish(&about).map_err(|error| write_error(path, &error))?;
                files::write_bytes(out, path, &bytes)?;
                count
            }
        };
        if let Some(beside) = self.about {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let (hash, bytes) =
                sha256(path).map_err(|e| Failure::file_operation("read", path, &e))?;
            if let Some(commit) = option_env!("BSM_COMMIT") {
                about["program"]["commit"] = commit.into();
            }
            about["table"] = json!({ "name": name, "bytes": bytes, "sha256": hash });
            files::write(beside, &(pretty_json(&about) + "\n"))?;
        }
        Ok(count)
    }

    /// Returns the error for builds that cannot write a folder of parts.
    #[cfg(not(feature = "parquet"))]
    fn plan(&self, _: &Path, _: &Points, _: &Workers<'_>) -> Result<(), Failure> {
        Err(Failure::not_built("parquet"))
    }

    /// Returns an error, because a folder of parts requires the feature `parquet`.
    #[cfg(not(feature = "parquet"))]
    fn fill_folder(
        &self,
        _: &Path,
        _: &Points,
        _: &Workers<'_>,
        _: &mut dyn FnMut(&Chunk, &Answers),
    ) -> Result<Count, Failure> {
        Err(Failure::not_built("parquet"))
    }

    /// Creates the dataset folder, or checks that an existing folder contains the plan of this run.
    /// Prints the plan and its estimated cost.
    #[cfg(feature = "parquet")]
    fn plan(&self, folder: &Path, points: &Points, workers: &Workers<'_>) -> Result<(), Failure> {
        let plan = Plan::new(&self.task, points, self.args.rows_per_part, workers);
        let begun =
            plan.and_then(|plan| Dataset::resume(folder, plan, unfinished::create_temporary));
        print_plan(folder, begun.map_err(|error| dataset_failure(folder, error))?.plan())
    }

    #[cfg(feature = "parquet")]
    fn fill_folder(
        &self,
        folder: &Path,
        points: &Points,
        workers: &Workers<'_>,
        watch: &mut dyn FnMut(&Chunk, &Answers),
    ) -> Result<Count, Failure> {
        let SweepArgs { resume, rows_per_part, .. } = *self.args;
        let how = RunOptions { resume, rows_per_part, make: unfinished::create_temporary };
        let mut bar = ProgressBar::hidden();
        let mut tell = |event: Event<'_>| match event {
            Event::UnknownFiles(files) => {
                let text = format!(
                    "{} does not belong to this table and was left in place; programs that read the folder will also read this file",
                    files[0].display()
                );
                print_message("warning", &text);
            }
            Event::Planned(rows) => bar = progress(Some(rows), "rows", self.args.work.quiet),
            Event::Found(part) => bar.inc(part.rows),
            Event::Solved(chunk, answers) => {
                bar.inc(chunk.len as u64);
                watch(chunk, answers);
            }
        };
        let count = dataset::fill(folder, &self.task, points, how, workers, &mut tell);
        bar.finish_and_clear();
        count.map_err(|error| dataset_failure(folder, error))
    }
}

/// Collects the points along the last axis of a grid at which `auto` switches to another model.
struct Changes<'a> {
    axis: &'a GridAxis,
    /// Row, value and model of the preceding point.
    before: Option<(u64, f64, ModelChoice)>,
    /// Descriptions of the first few changes of the model.
    first: Vec<String>,
    /// Changes of the model: index of the point on the axis, and the names of both models.
    found: HashSet<(u64, [&'static str; 2])>,
}

impl<'a> Changes<'a> {
    /// Maximum number of model changes that the note lists.
    const NAMED: usize = 4;

    fn along(grid: &'a Grid) -> Self {
        let axis = grid.axes().last().expect("a grid has an axis");
        Self { axis, before: None, first: Vec::new(), found: HashSet::new() }
    }

    fn add(&mut self, chunk: &Chunk, answers: &Answers) {
        let Some(values) = chunk.inputs.last() else { return };
        for (i, (value, outcome)) in values.values().iter().zip(&answers.outcomes).enumerate() {
            let row = chunk.first - 1 + i as u64;
            let begins = row.is_multiple_of(self.axis.len() as u64);
            if let Some((former, from, model)) = self.before.filter(|_| !begins)
                && former + 1 == row
                && model != outcome.model
            {
                let [model, other] = [model, outcome.model].map(ModelChoice::name);
                let place = row % self.axis.len() as u64;
                if self.found.insert((place, [model, other])) && self.first.len() < Self::NAMED {
                    let [from, to] = [from, *value].map(format_exact);
                    self.first.push(format!("{from} and {to} ({model}, {other})"));
                }
            }
            let solved = outcome.status == Status::Converged;
            self.before = solved.then_some((row, *value, outcome.model));
        }
    }

    fn note(&self) -> Option<String> {
        let more = Some(self.found.len() - self.first.len()).filter(|more| *more > 0);
        let more = more.map_or_else(String::new, |more| format!(", and {more} more"));
        (!self.first.is_empty()).then(|| {
            format!(
                "model auto switches models between {} {}{more}; the results may have a step there, \
                 within their error bounds",
                self.axis.key.name(),
                self.first.join(", ")
            )
        })
    }
}

/// Returns the requested outputs. The requested names may end with any unit.
pub(crate) fn outputs(columns: Option<&[String]>) -> Result<Vec<&'static Output>, Failure> {
    let own = |name: &String| {
        Output::in_unit(name).map_or_else(|| name.clone(), |(output, _)| output.name.to_owned())
    };
    let columns: Option<Vec<_>> = columns.map(|names| names.iter().map(own).collect());
    let selected = Answers::select(columns.as_deref());
    selected.map_err(|e| Failure::Input(format!("--columns: {}", table_error_text(&e))))
}

/// Returns true if the path ends with a separator, or if it is an existing folder without the
/// extension of a table.
pub(crate) fn is_folder(path: &Path) -> bool {
    path.as_os_str().to_string_lossy().ends_with(['/', '\\'])
        || path.is_dir() && ending_of("-o", path, &TABLES).is_err()
}

/// Opens a table of points in the format of its file extension. The path `-` means CSV on standard
/// input.
pub(crate) fn open(
    path: &Path,
    keep: &[String],
    table_format: &TableFormat,
) -> Result<Box<dyn Source>, Failure> {
    let source: Result<Box<dyn Source>, TableError> = if is_stdout(path) {
        let reader: Box<dyn Read + Send> = Box::new(io::stdin());
        CsvSource::new(reader, keep, table_format).map(|source| Box::new(source) as Box<dyn Source>)
    } else {
        ending_of("--points", path, &POINTS)?;
        Format::of(path).unwrap_or(Format::Csv).open(path, keep, table_format)
    };
    source.map_err(|e| Failure::table(path, &e))
}

/// Converts an error of a dataset to a failure with an exit code.
pub(crate) fn dataset_failure(folder: &Path, error: DatasetError) -> Failure {
    match error {
        DatasetError::Read(error) => Failure::Table(error),
        DatasetError::Write { path, error } => write_error(&path, &error),
        DatasetError::Io { doing, path, error } => Failure::file_operation(doing, &path, &error),
        DatasetError::Thread(error) => Failure::no_thread(&error),
        DatasetError::Stopped => Failure::Files(error.to_string()),
        DatasetError::Damaged(ref damaged) => {
            Failure::Check(format!("{error}; {}", repair_advice(folder, damaged)))
        }
        DatasetError::AlreadyExists { .. } => {
            Failure::Input(format!("{error}; continue with --resume, or use another folder"))
        }
        DatasetError::NotAPlan { .. } => Failure::Input(format!(
            "{error}; use a folder other than {}, or restore the plan",
            folder.display()
        )),
        other => Failure::Input(other.to_string()),
    }
}

/// Describes how to repair damaged parts, or what to do with files that are named like a part but
/// are not in the plan.
pub(crate) fn repair_advice(folder: &Path, damaged: &[(PathBuf, PartDefect)]) -> String {
    let them = if damaged.len() == 1 { "it" } else { "them" };
    if damaged.iter().all(|(_, why)| matches!(why, PartDefect::NotInThePlan)) {
        return format!("move {them} elsewhere");
    }
    format!(
        "move {them} elsewhere and solve the missing parts again with --resume, or replace {them} with \
         `bsm parts run {} --repair`",
        folder.display()
    )
}

/// Reports why a run that writes a table ended early.
pub(crate) fn run_failure(path: &Path, error: RunError) -> Failure {
    match error {
        RunError::Read(error) => Failure::Table(error),
        RunError::Write(error) => write_error(path, &error),
        RunError::Thread(error) => Failure::no_thread(&error),
        RunError::Stopped => Failure::Files(error.to_string()),
    }
}

/// Reports that a table cannot be written.
pub(crate) fn write_error(path: &Path, error: &TableError) -> Failure {
    match error {
        TableError::Io(e) => OutputFile::failure(path, e),
        TableError::Parquet(why) => files::refused(path, why),
        other => files::refused(path, &other.to_string()),
    }
}

/// Writes a table of numbers and text, one block of rows at a time.
///
/// * `columns`: columns of the table in display units.
/// * `parts`: blocks of rows; each block contains the values of all columns.
/// * `about`: description of the table's origin.
/// * `table_format`: format of a CSV table.
pub(crate) fn write_columns<'a>(
    path: &Path,
    columns: &'a [ShownColumn],
    parts: impl Iterator<Item = Vec<ColumnValues>>,
    about: &Value,
    table_format: &TableFormat,
) -> Result<(), Failure> {
    let shown = |part: Vec<ColumnValues>| -> Vec<ColumnValues> {
        columns.iter().map(|column| column.values(&part)).collect()
    };
    let mut parts = parts.map(shown).peekable();
    match form_of(path)? {
        Form::Table(format) => {
            let out = OutputFile::create(path)?;
            let written = move || {
                let head = |ShownColumn { name, unit, .. }: &'a ShownColumn| ColumnHead {
                    name,
                    unit: unit.text,
                    is_text: false,
                };
                let mut heads: Vec<_> = columns.iter().map(head).collect();
                // The type of a column is taken from the first block. In an empty table, all
                // columns are numeric.
                for (head, values) in heads.iter_mut().zip(parts.peek().into_iter().flatten()) {
                    head.is_text = matches!(values, ColumnValues::Texts(_));
                }
                let mut table = TableSink::of_columns(format, out, heads, table_format)?;
                for part in parts {
                    table.write_columns(part)?;
                }
                table.finish(Some(&made_from(about).to_string()))
            };
            written().map_err(|error| write_error(path, &error))?.complete()
        }
        #[cfg(feature = "xlsx")]
        Form::Workbook => {
            let heads = columns.iter().map(|column| (column.name.as_str(), column.unit.text));
            write_book(path, heads, about, |book| {
                for part in parts {
                    for row in 0..part.first().map_or(0, ColumnValues::len) {
                        book.row(part.iter().map(|values| cell(values, row)))?;
                    }
                }
                Ok(())
            })
        }
    }
}

/// Returns a workbook cell for a value.
#[cfg(feature = "xlsx")]
fn cell(values: &ColumnValues, row: usize) -> Cell<'_> {
    match values {
        ColumnValues::Numbers(values) => Cell::Number(values[row]),
        ColumnValues::Texts(texts) => texts[row].as_deref().map_or(Cell::Missing, Cell::Text),
    }
}

/// Returns the metadata of a table: the program and the description of the table's origin.
fn made_from(about: &Value) -> Value {
    json!({ "program": PROGRAM, "made_from": about })
}

/// Name, unit and value of a quantity.
pub(crate) type NumberRow = (&'static str, &'static str, f64);

/// Writes a table with one row per quantity. The columns are name, unit and value.
#[cfg_attr(
    not(feature = "xlsx"),
    expect(unused_variables, reason = "only workbooks contain metadata on how the table was made")
)]
pub(crate) fn write_rows(
    path: &Path,
    rows: &[NumberRow],
    display: DisplayUnits,
    about: &Value,
) -> Result<(), Failure> {
    let displayed = |(name, unit, value): &NumberRow| {
        let shown = display.of(unit);
        (shown.name(name), shown.text, shown.value(*value))
    };
    let rows: Vec<_> = rows.iter().map(displayed).collect();
    match form_of(path)? {
        #[cfg(feature = "xlsx")]
        Form::Workbook => {
            let heads = ["name", "unit", "value"].map(|name| (name, ""));
            write_book(path, heads.into_iter(), about, |book| {
                rows.iter().try_for_each(|(name, unit, value)| {
                    book.row([Cell::Text(name), Cell::Text(unit), Cell::Number(*value)].into_iter())
                })
            })
        }
        Form::Table(_) => {
            let line = |(name, unit, value): &(String, &str, f64)| {
                format!("{name},{unit},{}\n", format_exact(*value))
            };
            let lines: String = rows.iter().map(line).collect();
            files::write(path, &format!("name,unit,value\n{lines}"))
        }
    }
}

/// Writes a workbook with the rows and an additional sheet that describes their origin.
#[cfg(feature = "xlsx")]
fn write_book<'a>(
    path: &Path,
    heads: impl Iterator<Item = (&'a str, &'a str)>,
    about: &Value,
    rows: impl FnOnce(&mut Workbook) -> Result<(), TableError>,
) -> Result<(), Failure> {
    let out = OutputFile::create(path)?;
    let written = || {
        let mut book = Workbook::new(heads)?;
        rows(&mut book)?;
        book.finish(&made_from(about))
    };
    files::write_bytes(out, path, &written().map_err(|error| write_error(path, &error))?)
}

/// Format of an output table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Form {
    /// A CSV, JSON Lines or Parquet file.
    Table(Format),
    /// An Excel workbook.
    #[cfg(feature = "xlsx")]
    Workbook,
}

/// Chooses the format of an output table by its file extension. The path `-` means CSV.
pub(crate) fn form_of(path: &Path) -> Result<Form, Failure> {
    if is_stdout(path) {
        return Ok(Form::Table(Format::Csv));
    }
    match ending_of("-o", path, &TABLES)? {
        #[cfg(feature = "xlsx")]
        "xlsx" => Ok(Form::Workbook),
        _ => Ok(Form::Table(Format::of(path).unwrap_or(Format::Csv))),
    }
}

/// Prints a plan together with its estimated computing time and size.
#[cfg(feature = "parquet")]
fn print_plan(folder: &Path, plan: &Plan) -> Result<(), Failure> {
    let estimate = plan.estimate().map_err(|why| Failure::in_case(folder, &why.to_string()))?;
    let hours = estimate.core_seconds / 3600.0;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the number of bytes is only displayed"
    )]
    let bytes = HumanBytes(estimate.bytes as u64);
    let (parts, per_part) = (plan.parts(), plan.rows_per_part());
    files::print(&format!(
        "plan        {}\nrows        {}\nparts       {parts} of {per_part} rows\n\
         core-hours  {hours:.3}\nsize        {bytes} at most",
        plan.id(),
        plan.rows(),
    ))?;
    let folder = folder.display();
    let how = format!(
        "solve the plan with `bsm parts run {folder}` on one or more machines, and then run `bsm parts check {folder}`"
    );
    print_message("note", &how);
    if plan.rows() > MANY_ROWS {
        let text = "solving so many rows again is cheaper than storing and reading them; for \
                    statistics, the Python package solves parts of this plan in memory \
                    (ballscrew.solve_part)";
        print_message("note", text);
    }
    Ok(())
}
