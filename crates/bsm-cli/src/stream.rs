//! From points to a table or a folder of tables: the arguments, the bar and the words of the batch pipeline.

use std::fs;
use std::io::{self, IsTerminal};
use std::path::Path;

use bsm_batch::dataset::{self, DatasetError, Event, Filling, Points};
use bsm_batch::{
    Answers, Chunk, Count, Format, NumberColumn, NumberSink, RunError, Source, TableError, Task,
    Workers,
};
use bsm_case::Output as Column;
use indicatif::{HumanCount, ProgressBar, ProgressState, ProgressStyle};

use crate::args::TableArgs;
use crate::failure::{Failure, warn};
use crate::files::{self, Output};
use crate::unfinished;

/// What all rows have in common, and where they go.
pub(crate) struct Job<'a> {
    pub(crate) task: Task,
    table: &'a TableArgs,
}

impl<'a> Job<'a> {
    pub(crate) fn new(task: Task, table: &'a TableArgs) -> Self {
        Self { task, table }
    }

    /// Solves all rows into a table, or into a folder of tables, and tells how many have no result;
    /// `each` sees the watched output of every chunk that is solved.
    ///
    /// * `source`: the rows.
    /// * `points`: where they come from, for a folder.
    pub(crate) fn run(
        &self,
        source: &mut dyn Source,
        points: &Points,
        workers: &Workers<'_>,
        mut each: impl FnMut(&Chunk, &[f64]),
    ) -> Result<(), Failure> {
        let TableArgs { output, quiet, .. } = self.table;
        let folder = is_folder(self.table)?;
        let mut watch = |chunk: &Chunk, answers: &Answers| {
            if let (Some(_), Some(watched)) = (self.task.watched, answers.columns.last()) {
                each(chunk, watched);
            }
        };
        let Count { rows, failed, several } = if folder {
            self.fill_folder(points, workers, &mut watch)?
        } else {
            let bar = progress(source.len_hint(), "rows", *quiet);
            let count = self.write_file(source, workers, &mut |chunk, answers| {
                bar.inc(chunk.len as u64);
                watch(chunk, answers);
            });
            bar.finish_and_clear();
            count?
        };
        if several > 0 {
            let have = if several == 1 { "has" } else { "have" };
            warn(
                "note",
                &format!("{several} of {rows} rows {have} another solution; see other_solutions"),
            );
        }
        if failed == 0 {
            return Ok(());
        }
        warn(
            "note",
            &format!(
                "{failed} of {rows} rows have no result; they say why in {}",
                output.display()
            ),
        );
        if self.table.keep_going { Ok(()) } else { Err(Failure::Unsolved) }
    }

    fn write_file(
        &self,
        source: &mut dyn Source,
        workers: &Workers<'_>,
        seen: &mut dyn FnMut(&Chunk, &Answers),
    ) -> Result<Count, Failure> {
        let path = self.table.output.as_path();
        let format = format_of(path, "--output")?;
        let run = self.task.write(source, format, Output::create(path)?, workers, seen);
        let (out, count) = run.map_err(|error| match error {
            RunError::Read(error) => Failure::Table(error),
            RunError::Write(error) => unwritable(path, &error),
            RunError::Thread(error) => Failure::no_thread(&error),
            RunError::Stopped => Failure::Files(error.to_string()),
        })?;
        out.complete()?;
        Ok(count)
    }

    fn fill_folder(
        &self,
        points: &Points,
        workers: &Workers<'_>,
        watch: &mut dyn FnMut(&Chunk, &Answers),
    ) -> Result<Count, Failure> {
        let TableArgs { output: folder, resume, rows_per_shard, quiet, .. } = self.table;
        let how = Filling {
            resume: *resume,
            rows_per_shard: *rows_per_shard,
            make: |file| unfinished::create_temporary(file),
        };
        let mut bar = ProgressBar::hidden();
        let mut tell = |event: Event<'_>| match event {
            Event::Foreign(files) => {
                let text = format!(
                    "{} is no part of this table, and is left alone; programs that read the folder read it too",
                    files[0].display()
                );
                warn("warning", &text);
            }
            Event::Planned(rows) => bar = progress(Some(rows), "rows", *quiet),
            Event::Found(rows) => bar.inc(rows),
            Event::Solved(chunk, answers) => {
                bar.inc(chunk.len as u64);
                watch(chunk, answers);
            }
        };
        let count = dataset::fill(folder, &self.task, points, how, workers, &mut tell);
        bar.finish_and_clear();
        count.map_err(|error| failed(folder, error))
    }
}

/// The outputs to write.
pub(crate) fn outputs(table: &TableArgs) -> Result<Vec<&'static Column>, Failure> {
    Answers::select(table.columns.as_deref()).map_err(|e| Failure::Input(format!("--columns: {e}")))
}

/// Refuses points for a folder that cannot be read twice, before anything is read.
pub(crate) fn needs_a_file(table: &TableArgs, points: &Path) -> Result<(), Failure> {
    let once = points.as_os_str() == "-" || fs::metadata(points).is_ok_and(|p| !p.is_file());
    if is_folder(table)? && once {
        return Err(Failure::Input(format!(
            "{}: a folder of parts needs points that can be read twice, from a file",
            if points.as_os_str() == "-" {
                "standard input".into()
            } else {
                points.to_string_lossy()
            }
        )));
    }
    Ok(())
}

/// A folder if the path ends like one or is one, else a file.
fn is_folder(table: &TableArgs) -> Result<bool, Failure> {
    let path = table.output.as_path();
    if path.as_os_str().to_string_lossy().ends_with(['/', '\\']) || path.is_dir() {
        return Ok(true);
    }
    if table.resume {
        let folder = if path.as_os_str() == "-" { Path::new("map") } else { path };
        return Err(Failure::Input(format!(
            "--resume cannot continue {}: a single table appears when it is complete, and a run \
             that is stopped leaves nothing; write a folder of parts, --output {}/, which --resume \
             can continue",
            if path.as_os_str() == "-" { "standard output".into() } else { path.to_string_lossy() },
            folder.with_extension("").display()
        )));
    }
    if table.rows_per_shard.is_some() {
        let text = "--rows-per-shard is for folders, such as --output map/";
        return Err(Failure::Input(text.to_owned()));
    }
    Ok(false)
}

/// What is wrong with a folder, with the exit code of its kind.
fn failed(folder: &Path, error: DatasetError) -> Failure {
    match error {
        DatasetError::Read(error) => Failure::Table(error),
        DatasetError::Write { path, error } => unwritable(&path, &error),
        DatasetError::Io { doing, path, error } => Failure::files(doing, &path, &error),
        DatasetError::Thread(error) => Failure::no_thread(&error),
        DatasetError::Stopped => Failure::Files(error.to_string()),
        DatasetError::Damaged(_) => Failure::Check(error.to_string()),
        DatasetError::AnotherPlan { .. } => Failure::Input(format!("--resume: {error}")),
        DatasetError::NotAPlan { .. } => Failure::Input(format!(
            "{error}; take another folder than {}, or put the plan back",
            folder.display()
        )),
        other => Failure::Input(other.to_string()),
    }
}

/// A table that cannot be written.
pub(crate) fn unwritable(path: &Path, error: &TableError) -> Failure {
    match error {
        TableError::Io(e) => Output::failure(path, e),
        TableError::Parquet(why) => files::refused(path, why),
        other => files::refused(path, &other.to_string()),
    }
}

/// Writes a table of numbers, part by part.
pub(crate) fn write_numbers(
    path: &Path,
    format: Format,
    columns: &[NumberColumn],
    parts: impl Iterator<Item = Vec<Vec<f64>>>,
) -> Result<(), Failure> {
    let out = Output::create(path)?;
    let written = || {
        let mut table = match format {
            Format::Csv => NumberSink::csv(out, columns)?,
            Format::JsonLines => NumberSink::json_lines(out, columns),
            Format::Parquet => NumberSink::parquet(out, columns)?,
        };
        for part in parts {
            table.write(&part)?;
        }
        table.finish()
    };
    written().map_err(|error| unwritable(path, &error))?.complete()
}

/// The form of a table by the ending of its name; `-` is CSV.
pub(crate) fn format_of(path: &Path, what: &str) -> Result<Format, Failure> {
    let stream = (path.as_os_str() == "-").then_some(Format::Csv);
    Format::of(path).or(stream).ok_or_else(|| {
        Failure::Input(format!(
            "{what} {}: the file must end in .csv, .jsonl or .parquet, or be - for CSV on the standard \
             streams",
            path.display()
        ))
    })
}

/// A bar on a terminal, nothing elsewhere.
pub(crate) fn progress(total: Option<u64>, what: &str, quiet: bool) -> ProgressBar {
    if quiet || !io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let (bar, template) = match total {
        Some(total) => (
            ProgressBar::new(total),
            format!("{{wide_bar}} {{human_pos}}/{{human_len}} {what}, {{rate}}, {{eta}} left"),
        ),
        None => (ProgressBar::new_spinner(), format!("{{spinner}} {{human_pos}} {what}, {{rate}}")),
    };
    let style = ProgressStyle::with_template(&template)
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .with_key("rate", |state: &ProgressState, text: &mut dyn std::fmt::Write| {
            // A bar that cannot be drawn is ignored.
            let _ = text.write_str(&rate(state.per_sec()));
        });
    bar.with_style(style)
}

/// Rows a second in whole numbers.
fn rate(per_second: f64) -> String {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a rate to look at"
    )]
    let whole = per_second.round() as u64;
    let mut text = HumanCount(whole).to_string();
    text.push_str("/s");
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Found by a user: `20,083.5883/s`.
    #[test]
    fn progress_is_in_whole_numbers() {
        assert_eq!(rate(20_083.588_3), "20,084/s");
        assert_eq!(rate(0.2), "0/s");
    }
}
