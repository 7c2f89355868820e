//! From points to a table or a folder of tables: the arguments, the bar and the words of the batch pipeline.

use std::fs;
use std::io::{self, IsTerminal};
use std::path::Path;

use bsm_batch::dataset::{Dataset, DatasetError, Event, Plan, Points};
use bsm_batch::{
    Answers, Chunk, Count, Format, RunError, Source, TableError, TableSink, Task, Workers,
};
use bsm_case::{Output as Column, Scene, Settings};
use indicatif::{HumanCount, ProgressBar, ProgressState, ProgressStyle};

use crate::args::TableArgs;
use crate::failure::{Failure, warn};
use crate::files::{self, Output};
use crate::unfinished;

/// What all rows have in common, and where they go.
pub(crate) struct Job<'a> {
    task: Task,
    table: &'a TableArgs,
}

impl<'a> Job<'a> {
    pub(crate) fn new(
        base: &Scene,
        settings: &Settings,
        table: &'a TableArgs,
    ) -> Result<Self, Failure> {
        let outputs = Answers::select(table.columns.as_deref())
            .map_err(|e| Failure::Input(format!("--columns: {e}")))?;
        Ok(Self { task: Task::new(base.clone(), *settings, outputs), table })
    }

    /// An output that is shown and not written.
    pub(crate) fn watch(&mut self, output: &'static Column) {
        self.task.watched = Some(output);
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
        let folder = self.is_folder()?;
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

    /// Refuses points for a folder that cannot be read twice, before anything is read.
    pub(crate) fn needs_a_file(&self, points: &Path) -> Result<(), Failure> {
        let once = points.as_os_str() == "-" || fs::metadata(points).is_ok_and(|p| !p.is_file());
        if self.is_folder()? && once {
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
    fn is_folder(&self) -> Result<bool, Failure> {
        let path = self.table.output.as_path();
        if path.as_os_str().to_string_lossy().ends_with(['/', '\\']) || path.is_dir() {
            return Ok(true);
        }
        if self.table.resume {
            let folder = if path.as_os_str() == "-" { Path::new("map") } else { path };
            return Err(Failure::Input(format!(
                "--resume cannot continue {}: a single table appears when it is complete, and a run \
                 that is stopped leaves nothing; write a folder of parts, --output {}/, which --resume \
                 can continue",
                if path.as_os_str() == "-" {
                    "standard output".into()
                } else {
                    path.to_string_lossy()
                },
                folder.with_extension("").display()
            )));
        }
        if self.table.rows_per_shard.is_some() {
            let text = "--rows-per-shard is for folders, such as --output map/";
            return Err(Failure::Input(text.to_owned()));
        }
        Ok(false)
    }

    fn write_file(
        &self,
        source: &mut dyn Source,
        workers: &Workers<'_>,
        seen: &mut dyn FnMut(&Chunk, &Answers),
    ) -> Result<Count, Failure> {
        let path = self.table.output.as_path();
        let format = format_of(path, "--output")?;
        let failed = |e: TableError| unwritable(path, &e);
        let out = Output::create(path)?;
        let sink = TableSink::new(format, out, source.columns(), &self.task.outputs);
        let run = self.task.run(source, sink.map_err(failed)?, u64::MAX, workers, seen);
        let (sink, count) = run.map_err(|error| match error {
            RunError::Read(error) => Failure::Table(error),
            RunError::Write(error) => failed(error),
            RunError::Thread(error) => Failure::no_thread(&error),
            RunError::Stopped => Failure::Files(error.to_string()),
        })?;
        sink.finish().map_err(failed)?.complete()?;
        Ok(count)
    }

    fn fill_folder(
        &self,
        points: &Points,
        workers: &Workers<'_>,
        watch: &mut dyn FnMut(&Chunk, &Answers),
    ) -> Result<Count, Failure> {
        let TableArgs { output: folder, resume, rows_per_shard, quiet, .. } = self.table;
        let failed = |error: DatasetError| dataset(folder, error);
        let plan = Plan::new(&self.task, points, *rows_per_shard, workers).map_err(failed)?;
        let begin = if *resume { Dataset::resume } else { Dataset::create };
        let parts =
            begin(folder, plan, |file| unfinished::create_temporary(file)).map_err(failed)?;
        // Parts are trusted when their bytes are as they were written.
        let found = parts.survey(true, workers).map_err(failed)?;
        if let Some(one) = found.foreign.first() {
            let text = format!(
                "{} is no part of this table, and is left alone; programs that read the folder read it too",
                one.display()
            );
            warn("warning", &text);
        }
        let bar = progress(Some(parts.plan().rows()), "rows", *quiet);
        let count = parts.run(&self.task, points, found, workers, &mut |event| match event {
            Event::Found(rows) => bar.inc(rows),
            Event::Solved(chunk, answers) => {
                bar.inc(chunk.len as u64);
                watch(chunk, answers);
            }
        });
        bar.finish_and_clear();
        count.map_err(failed)
    }
}

/// What is wrong with a folder, with the exit code of its kind.
fn dataset(folder: &Path, error: DatasetError) -> Failure {
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
