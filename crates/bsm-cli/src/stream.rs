//! From a source of rows to a table: chunks solved on all cores, with progress.

use std::fs::{self, File, TryLockError};
use std::io::{self, IsTerminal, Read, Write};
use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;

use bsm_batch::{
    Answers, Chunk, Columns, CsvSink, JsonSink, ParquetSink, Sink, Source, TableError, solve,
};
use bsm_case::{Output as Column, Scene, Settings};
use bsm_dyn::Status;
use bsm_validate::PROGRAM;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;

use crate::args::TableArgs;
use crate::failure::{Failure, warn};
use crate::files::{self, Output};

/// Rows that are in memory at a time.
const ROWS: usize = 1 << 16;

/// What all rows have in common, and where they go.
pub(crate) struct Task<'a> {
    base: Scene,
    settings: &'a Settings,
    /// Outputs to write.
    outputs: Vec<&'static Column>,
    /// An output that is only looked at.
    pub(crate) watched: Option<&'static Column>,
    table: &'a TableArgs,
}

/// How many rows there were, and how many of them have no result or several.
#[derive(Debug, Default, Clone, Copy)]
struct Count {
    rows: u64,
    failed: u64,
    /// Rows that are known to have other solutions.
    several: u64,
}

impl<'a> Task<'a> {
    pub(crate) fn new(
        base: &Scene,
        settings: &'a Settings,
        table: &'a TableArgs,
    ) -> Result<Self, Failure> {
        let outputs = Answers::select(table.columns.as_deref())
            .map_err(|e| Failure::Input(format!("--columns: {e}")))?;
        let base = Scene { description: None, ..base.clone() };
        Ok(Self { base, settings, outputs, watched: None, table })
    }

    /// Solves all rows of `source` into a table, or into a folder of tables, and tells how many
    /// have no result; `each` sees the watched output of every chunk that is solved.
    ///
    /// * `origin`: what the rows are made from, in words that change if it does; asked for folders
    ///   only.
    pub(crate) fn run(
        &self,
        source: &mut dyn Source,
        origin: impl FnOnce() -> Result<String, Failure>,
        each: impl FnMut(&Chunk, &[f64]),
    ) -> Result<(), Failure> {
        let target = Target::of(&self.table.output, self.table.resume, origin)?;
        let Count { rows, failed, several } = self.solve(source, &target, each)?;
        if several > 0 {
            let have = if several == 1 { "has" } else { "have" };
            warn(
                "note",
                &format!("{several} of {rows} rows {have} another solution; see other_solutions"),
            );
        }
        if failed > 0 {
            warn("note", &format!("{failed} of {rows} rows have no result; they say why"));
            if self.table.strict {
                return Err(Failure::Unsolved);
            }
        }
        Ok(())
    }

    fn solve(
        &self,
        source: &mut dyn Source,
        target: &Target<'_>,
        mut each: impl FnMut(&Chunk, &[f64]),
    ) -> Result<Count, Failure> {
        let bar = progress(source.len_hint(), "rows", self.table.quiet);
        let mut count = Count::default();
        let lock = target.parts(source, self)?;
        let parts = lock.is_some();
        let mut done = Ok(true);
        for part in 0_u64.. {
            let path = target.file(part);
            if parts && path.exists() {
                source.skip(PART)?;
                bar.inc(PART);
                continue;
            }
            let limit = if parts { PART } else { u64::MAX };
            done = self.write(source, &path, limit, &mut |chunk, answers| {
                let verdicts = &answers.verdicts;
                count.rows += verdicts.len() as u64;
                let failed = verdicts.iter().filter(|v| v.status != Status::Converged).count();
                count.failed += failed as u64;
                count.several += verdicts.iter().filter(|v| v.has_others).count() as u64;
                bar.inc(verdicts.len() as u64);
                if let (Some(_), Some(watched)) = (self.watched, answers.columns.last()) {
                    each(chunk, watched);
                }
            });
            if !parts || !matches!(done, Ok(true)) {
                break;
            }
        }
        bar.finish_and_clear();
        done.map(|_| count)
    }

    /// Writes one table of at most `limit` rows; false if the source ended before its first row.
    ///
    /// One thread reads ahead and one writes behind those that solve.
    fn write(
        &self,
        source: &mut dyn Source,
        path: &Path,
        limit: u64,
        each: &mut dyn FnMut(&Chunk, &Answers),
    ) -> Result<bool, Failure> {
        let first = source.next(ROWS)?;
        if first.is_none() && limit < u64::MAX {
            return Ok(false);
        }
        let columns = source.columns().clone();
        let sink = TableFile::create(path, &columns, &self.outputs)?;
        let outputs: Vec<_> = self.outputs.iter().copied().chain(self.watched).collect();
        let (read, chunks) = sync_channel(1);
        let (solved, answered) = sync_channel(1);
        thread::scope(|scope| {
            let no_thread = |e: io::Error| Failure::no_thread(&e);
            thread::Builder::new()
                .spawn_scoped(scope, move || read_ahead(source, first, limit, &read))
                .map_err(no_thread)?;
            let writer = thread::Builder::new()
                .spawn_scoped(scope, move || write_behind(sink, &answered))
                .map_err(no_thread)?;
            let mut done = Ok(());
            for chunk in chunks {
                let chunk = match chunk {
                    Ok(chunk) => chunk,
                    Err(error) => {
                        done = Err(Failure::from(error));
                        break;
                    }
                };
                let answers = solve(&chunk, &columns, &self.base, self.settings, &outputs);
                each(&chunk, &answers);
                if solved.send((chunk, answers)).is_err() {
                    // The writer has failed, and says why itself.
                    break;
                }
            }
            drop(solved);
            let file = writer.join().unwrap_or_else(|panic| resume_unwind(panic));
            done?;
            file.map_err(|error| unwritable(path, &error))?.complete()?;
            Ok(true)
        })
    }
}

/// Sends the rows of a source, at most `limit`, until it ends, fails, or nobody listens.
fn read_ahead(
    source: &mut dyn Source,
    mut first: Option<Chunk>,
    limit: u64,
    to: &SyncSender<Result<Chunk, TableError>>,
) {
    let mut rows = 0;
    while rows < limit {
        let most = usize::try_from(limit - rows).unwrap_or(ROWS).min(ROWS);
        let Some(chunk) =
            first.take().map_or_else(|| source.next(most).transpose(), |c| Some(Ok(c)))
        else {
            break;
        };
        rows += chunk.as_ref().map_or(limit, |chunk| chunk.len as u64);
        if to.send(chunk).is_err() {
            break;
        }
    }
}

/// Writes what comes, and then the end of the table.
fn write_behind(
    mut file: TableFile,
    from: &Receiver<(Chunk, Answers)>,
) -> Result<Output, TableError> {
    for (chunk, answers) in from {
        file.sink().write(chunk, answers)?;
    }
    file.finish()
}

/// A table that cannot be written.
pub(crate) fn unwritable(path: &Path, error: &TableError) -> Failure {
    match error {
        TableError::Io(e) => Output::failure(path, e),
        TableError::Parquet(why) => files::refused(path, why),
        other => files::refused(path, &other.to_string()),
    }
}

/// Where a table goes.
enum Target<'a> {
    /// One file, or standard output.
    File(&'a Path),
    /// A folder of Parquet files of [`PART`] rows.
    Folder {
        path: &'a Path,
        /// What the rows are made from, in words that change if it does.
        origin: String,
        /// Keep the parts that are there.
        resume: bool,
    },
}

/// Rows of a part.
const PART: u64 = 1 << 20;

/// Name of the file in a folder that says what its parts are.
const MANIFEST: &str = "parts.json";

impl<'a> Target<'a> {
    /// A folder if the path ends like one, else a file.
    fn of(
        path: &'a Path,
        resume: bool,
        origin: impl FnOnce() -> Result<String, Failure>,
    ) -> Result<Self, Failure> {
        let ends_like_one = path.as_os_str().to_string_lossy().ends_with(['/', '\\']);
        if ends_like_one || path.is_dir() {
            return Ok(Self::Folder { path, origin: origin()?, resume });
        }
        if resume {
            return Err(Failure::Input(format!(
                "--resume works on folders, such as --output {}/",
                path.with_extension("").display()
            )));
        }
        Ok(Self::File(path))
    }

    fn file(&self, part: u64) -> PathBuf {
        match self {
            Self::File(path) => path.to_path_buf(),
            Self::Folder { path, .. } => path.join(format!("part-{part:06}.parquet")),
        }
    }

    /// Makes the folder ready, and checks that the parts in it are of the same task; `None` for a
    /// file. Nobody else writes into the folder while what is returned is open.
    fn parts(&self, source: &dyn Source, task: &Task<'_>) -> Result<Option<File>, Failure> {
        let Self::Folder { path, origin, resume } = self else { return Ok(None) };
        let columns = source.columns();
        let manifest = format!(
            "{:#}\n",
            json!({
                "program": PROGRAM,
                "rows_of_a_part": PART,
                "origin": origin,
                "columns": columns.kept.iter().map(String::as_str)
                    .chain(columns.inputs.iter().map(|key| key.name())).collect::<Vec<_>>(),
                "base": format!("{:?}", task.base),
                "settings": format!("{:?}", task.settings),
                "outputs": task.outputs.iter().map(|o| o.name).collect::<Vec<_>>(),
            })
        );
        fs::create_dir_all(path).map_err(|e| Failure::files("make folder", path, &e))?;
        let file = path.join(MANIFEST);
        let entries = fs::read_dir(path).map_err(|e| Failure::files("read folder", path, &e))?;
        if !file.exists() && entries.count() > 0 {
            return Err(Failure::Input(format!(
                "{} is a folder with something else in it",
                path.display()
            )));
        }
        let failed = |e: io::Error| Failure::files("write", &file, &e);
        let open = File::options().read(true).write(true).create(true).truncate(false).open(&file);
        let mut open = open.map_err(failed)?;
        if matches!(open.try_lock(), Err(TryLockError::WouldBlock)) {
            return Err(files::refused(path, "another bsm is writing there"));
        }
        let mut found = Vec::new();
        open.read_to_end(&mut found).map_err(failed)?;
        let same = found == manifest.as_bytes();
        if found.is_empty() {
            let written = open.write_all(manifest.as_bytes()).and_then(|()| open.sync_all());
            if let Err(error) = written {
                // Half of it would pass for another task.
                let _ = open.set_len(0);
                return Err(failed(error));
            }
        } else if !resume {
            return Err(Failure::Input(format!(
                "{} holds the parts of {} task; go on with --resume, or take another folder",
                path.display(),
                if same { "this" } else { "another" }
            )));
        } else if !same {
            return Err(Failure::Input(format!(
                "--resume: {} holds the parts of another task (see {}): input, base scene, \
                 settings and columns must be the same",
                path.display(),
                file.display()
            )));
        }
        remove_unfinished(path)?;
        Ok(Some(open))
    }
}

/// Removes unfinished parts that a killed run has left behind.
fn remove_unfinished(folder: &Path) -> Result<(), Failure> {
    let entries = fs::read_dir(folder).map_err(|e| Failure::files("read folder", folder, &e))?;
    for entry in entries.flatten() {
        let name = entry.file_name();
        let is_part = |name: &str| name.starts_with("part-") && name.ends_with(".parquet");
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        if is_file && name.to_str().and_then(files::final_name).is_some_and(is_part) {
            fs::remove_file(entry.path())
                .map_err(|e| Failure::files("remove", &entry.path(), &e))?;
        }
    }
    Ok(())
}

/// A table that is being written, by the ending of its name.
enum TableFile {
    Csv(Box<CsvSink<Output>>),
    Json(JsonSink<Output>),
    Parquet(Box<ParquetSink<Output>>),
}

impl TableFile {
    fn create(
        path: &Path,
        columns: &Columns,
        outputs: &[&'static Column],
    ) -> Result<Self, Failure> {
        let kind = Kind::of(path, "--output")?;
        let out = Output::create(path)?;
        let failed = |e: TableError| unwritable(path, &e);
        Ok(match kind {
            Kind::Csv => Self::Csv(Box::new(CsvSink::new(out, columns, outputs).map_err(failed)?)),
            Kind::JsonLines => Self::Json(JsonSink::new(out, columns.clone(), outputs)),
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
pub(crate) fn progress(total: Option<u64>, what: &str, quiet: bool) -> ProgressBar {
    if quiet || !io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let (bar, template) = match total {
        Some(total) => (
            ProgressBar::new(total),
            format!("{{wide_bar}} {{human_pos}}/{{human_len}} {what}, {{per_sec}}, {{eta}} left"),
        ),
        None => {
            (ProgressBar::new_spinner(), format!("{{spinner}} {{human_pos}} {what}, {{per_sec}}"))
        }
    };
    let style = ProgressStyle::with_template(&template);
    bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
