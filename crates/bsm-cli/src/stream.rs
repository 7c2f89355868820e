//! From a source of rows to a table: chunks solved on all cores, progress, clean interruption.

use std::io::{self, IsTerminal};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use bsm_batch::{Answers, Chunk, CsvSink, JsonSink, ParquetSink, Sink, Source, TableError, solve};
use bsm_case::{Output as Column, Record, Scene, Settings};
use bsm_dyn::Status;
use indicatif::{ProgressBar, ProgressStyle};

use crate::failure::Failure;
use crate::files::Output;

/// Rows that are in memory at a time.
const ROWS: usize = 4096;

/// Set by an interrupt.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// What all rows have in common.
pub(crate) struct Task<'a> {
    pub(crate) base: &'a Scene,
    pub(crate) settings: &'a Settings,
    pub(crate) outputs: &'a [&'static Column],
    pub(crate) quiet: bool,
}

/// How many rows there were, and how many of them have no result.
#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct Count {
    pub(crate) rows: u64,
    pub(crate) failed: u64,
}

impl Task<'_> {
    /// Solves all rows of `source` into the table at `path`; `each` sees every chunk on its way.
    pub(crate) fn run(
        &self,
        source: &mut dyn Source,
        path: &Path,
        mut each: impl FnMut(&Chunk, &[Record]),
    ) -> Result<Count, Failure> {
        // A second interrupt ends the program at once. Where handlers exist already, the default
        // one ends it at the first.
        let _ = ctrlc::set_handler(|| {
            if INTERRUPTED.swap(true, Ordering::Relaxed) {
                std::process::exit(130);
            }
        });
        let table = |error: TableError| match error {
            TableError::Io(e) => Output::failure(path, &e),
            other => Failure::Files(format!("cannot write {}: {other}", path.display())),
        };
        let base = Scene { description: None, ..self.base.clone() };
        let mut sink = TableFile::create(path, source, self.outputs)?;
        let bar = progress(source.len_hint(), self.quiet);
        let mut count = Count::default();
        while let Some(chunk) = source.next(ROWS).map_err(|e| Failure::Table(e.to_string()))? {
            let records = solve(&chunk, source.columns(), &base, self.settings);
            let answers = Answers { records: &records, outputs: self.outputs };
            sink.sink().write(&chunk, &answers).map_err(table)?;
            each(&chunk, &records);
            count.rows += records.len() as u64;
            let failed = records.iter().filter(|r| r.status() != Status::Converged).count();
            count.failed += failed as u64;
            bar.set_position(count.rows);
            if INTERRUPTED.load(Ordering::Relaxed) {
                bar.finish_and_clear();
                return Err(Failure::Interrupted(count.rows));
            }
        }
        bar.finish_and_clear();
        sink.finish().map_err(table)?.complete()?;
        Ok(count)
    }
}

/// A table that is being written, by the ending of its name.
enum TableFile {
    Csv(Box<CsvSink<Output>>),
    Json(JsonSink<Output>),
    Parquet(Box<ParquetSink<Output>>),
}

impl TableFile {
    fn create(path: &Path, source: &dyn Source, outputs: &[&Column]) -> Result<Self, Failure> {
        let kind = Kind::of(path, "--output")?;
        let out = Output::create(path)?;
        let columns = source.columns();
        let failed =
            |e: TableError| Failure::Files(format!("cannot write {}: {e}", path.display()));
        Ok(match kind {
            Kind::Csv => Self::Csv(Box::new(CsvSink::new(out, columns, outputs).map_err(failed)?)),
            Kind::JsonLines => Self::Json(JsonSink::new(out, columns.clone())),
            Kind::Parquet => {
                Self::Parquet(Box::new(ParquetSink::new(out, columns, outputs).map_err(failed)?))
            }
        })
    }

    fn sink(&mut self) -> &mut dyn Sink {
        match self {
            Self::Csv(sink) => sink.as_mut(),
            Self::Json(sink) => sink,
            Self::Parquet(sink) => sink.as_mut(),
        }
    }

    fn finish(self) -> Result<Output, TableError> {
        match self {
            Self::Csv(sink) => sink.finish(),
            Self::Json(sink) => Ok(sink.finish()),
            Self::Parquet(sink) => sink.finish(),
        }
    }
}

/// Forms of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Csv,
    JsonLines,
    Parquet,
}

impl Kind {
    /// By the ending of the name; `-` is CSV.
    pub(crate) fn of(path: &Path, what: &str) -> Result<Self, Failure> {
        let ending = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
        match ending.as_deref() {
            Some("csv") => Ok(Self::Csv),
            Some("jsonl" | "ndjson") => Ok(Self::JsonLines),
            Some("parquet") => Ok(Self::Parquet),
            _ if path.as_os_str() == "-" => Ok(Self::Csv),
            _ => Err(Failure::Input(format!(
                "{what} {}: the file must end in .csv, .jsonl or .parquet, or be - for CSV on the \
                 standard streams",
                path.display()
            ))),
        }
    }
}

/// A bar on a terminal, nothing elsewhere.
fn progress(total: Option<u64>, quiet: bool) -> ProgressBar {
    if quiet || !io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let (bar, template) = match total {
        Some(total) => (
            ProgressBar::new(total),
            "{wide_bar} {human_pos}/{human_len} rows, {per_sec}, {eta} left",
        ),
        None => (ProgressBar::new_spinner(), "{spinner} {human_pos} rows, {per_sec}"),
    };
    let style = ProgressStyle::with_template(template);
    bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
