//! Folders of parts. A folder has one plan. Its parts verify themselves, and any process may solve
//! them in any order, also repeatedly.
//!
//! ```text
//! map/
//!   plan.json                  written first, never changed
//!   data/part-000000.parquet   finished parts and nothing else
//!   tmp/                       unfinished files
//!   parts.parquet             written last: what the footers of the parts say
//! ```
//!
//! The bytes of a part depend on the plan only. A part counts as finished if its footer, its length
//! and its hash prove it. Any other file with the name of a part is reported and kept.

mod digest;
mod error;
mod folder;
mod part;
mod plan;
mod points;

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, BufWriter, ErrorKind, Write};
use std::num::NonZeroU64;
use std::ops::Range;
use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::thread::{self, ScopedJoinHandle};

use arrow_array::RecordBatch;
use arrow_schema::SchemaRef;
use rayon::prelude::*;
use tempfile::NamedTempFile;

pub use self::error::{DatasetError, PartDefect};
pub use self::folder::MakeTemporary;
pub use self::part::Part;
pub use self::plan::{Estimate, MAX_PARTS, Plan, RESULTS};
pub use self::points::{Points, sha256};

use self::folder::{Folder, complete};
use self::part::{HashingWriter, kind, list_parts, verify, write_footer};
use crate::table::MemorySink;
use crate::{
    Answers, Chunk, Count, Format, RunError, Source, TableError, TableFormat, TableSink, Task,
    Workers,
};

/// A complete part without its final name.
type TempFile = BufWriter<NamedTempFile>;

/// Events of a run.
#[derive(Debug, Clone, Copy)]
pub enum Event<'a> {
    /// Files among the parts that are not parts and that Parquet readers ignore. They are left
    /// alone.
    UnknownFiles(&'a [PathBuf]),
    /// Number of rows of the folder. This event precedes the events of found parts and solved rows.
    Planned(u64),
    /// A part that was already finished.
    Found(&'a Part),
    /// Solved rows.
    Solved(&'a Chunk, &'a Answers),
}

/// Content of a folder.
#[derive(Debug, Default)]
pub struct FolderScan {
    /// Finished parts, by their number.
    pub parts: BTreeMap<u64, Part>,
    /// Damaged files in place of parts.
    pub damaged: Vec<(PathBuf, PartDefect)>,
    /// Other files among the parts.
    pub unknown_files: Vec<PathBuf>,
}

impl FolderScan {
    /// Returns the parts of a plan that are missing in the folder, as ranges of their numbers.
    pub fn missing(&self, plan: &Plan) -> Vec<Range<u64>> {
        let mut missing = Vec::new();
        let mut next = 0;
        for number in self.parts.keys().copied().chain([plan.parts()]) {
            if next < number {
                missing.push(next..number);
            }
            next = number + 1;
        }
        missing
    }

    /// Returns true if every part of a plan is finished and no file is damaged.
    pub fn is_complete(&self, plan: &Plan) -> bool {
        self.missing(plan).is_empty() && self.damaged.is_empty()
    }

    /// Returns the id of another plan if more parts belong to this other plan than to the plan of
    /// the folder.
    pub fn other_plan(&self) -> Option<&str> {
        let mut others = self.damaged.iter().filter_map(|(_, damage)| match damage {
            PartDefect::OtherPlan(id) => Some(id.as_str()),
            _ => None,
        });
        let (count, id) = (others.clone().count(), others.next()?);
        (count > self.parts.len() && others.all(|other| other == id)).then_some(id)
    }

    /// Counts the rows, including rows without a result and rows with several results.
    pub fn count(&self) -> Count {
        self.parts.values().fold(Count::default(), |count, part| Count {
            rows: count.rows + part.rows,
            failed: count.failed + part.failed,
            several: count.several + part.several,
        })
    }
}

/// Options for filling a folder.
#[derive(Debug, Clone, Copy)]
pub struct RunOptions {
    /// True to continue a folder of the same plan. A part is trusted if its footer is intact. If
    /// false, the folder must be new or empty.
    pub resume: bool,
    /// Number of rows of a part. Defaults to a number that follows from the task.
    pub rows_per_part: Option<NonZeroU64>,
    /// Creates temporary files.
    pub make: MakeTemporary,
}

/// Solves all points into a folder.
///
/// # Errors
///
/// [`DatasetError`]. Finished parts are kept.
pub fn fill(
    folder: &Path,
    task: &Task,
    points: &Points,
    how: RunOptions,
    workers: &Workers<'_>,
    notify: &mut dyn FnMut(Event<'_>),
) -> Result<Count, DatasetError> {
    let RunOptions { resume, rows_per_part, make } = how;
    let plan = Plan::new(task, points, rows_per_part, workers)?;
    let begin = if resume { Dataset::resume } else { Dataset::create };
    let parts = begin(folder, plan, make)?;
    let found = parts.survey(true, workers)?;
    if !found.unknown_files.is_empty() {
        notify(Event::UnknownFiles(&found.unknown_files));
    }
    notify(Event::Planned(parts.plan().rows()));
    parts.run(task, points, found, workers, notify)
}

/// Solves a part of a plan in memory.
///
/// # Errors
///
/// [`DatasetError`] if the part cannot be read or solved.
pub fn solve_part(
    plan: &Plan,
    points: &Points,
    number: u64,
    workers: &Workers<'_>,
) -> Result<(SchemaRef, Vec<RecordBatch>), DatasetError> {
    let task = plan.task().map_err(points::invalid_points)?;
    let range = plan.range(number)?;
    let mut source = points.open().map_err(DatasetError::Read)?;
    source.skip(range.first_row).map_err(DatasetError::Read)?;
    let sink = MemorySink::new(source.columns(), &task.outputs);
    let run = task.run(source.as_mut(), sink, range.rows, workers, &mut |_, _| {});
    let (sink, count) = run.map_err(|error| not_solved(error, DatasetError::Read))?;
    range.check(count)?;
    Ok((sink.schema, sink.tables))
}

/// Converts the error that ended the solve of a part.
fn not_solved(error: RunError, unwritable: impl Fn(TableError) -> DatasetError) -> DatasetError {
    match error {
        RunError::Read(error) => DatasetError::Read(error),
        RunError::Write(error) => unwritable(error),
        RunError::Thread(error) => DatasetError::Thread(error),
        RunError::Stopped => DatasetError::Stopped,
    }
}

/// A folder and its plan.
#[derive(Debug)]
pub struct Dataset {
    folder: Folder,
    plan: Plan,
}

impl Dataset {
    /// Creates a folder, which must be new or empty.
    ///
    /// # Errors
    ///
    /// [`DatasetError`] if the folder contains files or cannot be created.
    pub fn create(folder: &Path, plan: Plan, make: MakeTemporary) -> Result<Self, DatasetError> {
        let this = Self { folder: Folder::new(folder, make), plan };
        this.begin()?;
        Ok(this)
    }

    /// Continues a folder of the same plan, or creates it.
    ///
    /// # Errors
    ///
    /// [`DatasetError`] if the folder has another plan or cannot be created.
    pub fn resume(folder: &Path, plan: Plan, make: MakeTemporary) -> Result<Self, DatasetError> {
        let this = Self { folder: Folder::new(folder, make), plan };
        // Another process may create the folder at the same moment.
        if let Err(error) = this.begin()
            && !this.is_begun()
        {
            return Err(error);
        }
        this.compare()?;
        this.folder.make_folders()?;
        Ok(this)
    }

    /// Opens a folder with the plan that it contains.
    ///
    /// # Errors
    ///
    /// [`DatasetError`] if the folder has no valid plan.
    pub fn open(folder: &Path, make: MakeTemporary) -> Result<Self, DatasetError> {
        let folder = Folder::new(folder, make);
        let plan = Plan::from_text(&folder.read_plan()?)
            .map_err(|why| DatasetError::NotAPlan { path: folder.plan(), why })?;
        Ok(Self { folder, plan })
    }

    /// Returns the plan.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Returns the path of a finished part.
    pub fn part_file(&self, number: u64) -> PathBuf {
        self.folder.part(number)
    }

    /// Returns true if the folder contains an entry with the name of the plan.
    fn is_begun(&self) -> bool {
        fs::symlink_metadata(self.folder.plan()).is_ok()
    }

    /// Compares the plan with the plan in the folder.
    fn compare(&self) -> Result<(), DatasetError> {
        let text = self.folder.read_plan()?;
        if text == self.plan.text() {
            return Ok(());
        }
        let not_a_plan = || {
            let why = "it is damaged".to_owned();
            DatasetError::NotAPlan { path: self.folder.plan(), why }
        };
        let differences = self.plan.differences(&text).ok_or_else(not_a_plan)?;
        Err(DatasetError::Refused(format!(
            "{} holds the parts of another task, which differs in: {differences}",
            self.folder.path.display()
        )))
    }

    /// Creates the folder and writes the plan.
    fn begin(&self) -> Result<(), DatasetError> {
        let begun = || {
            let same = self.compare().is_ok();
            DatasetError::Begun { folder: self.folder.path.clone(), same }
        };
        if self.is_begun() {
            return Err(begun());
        }
        self.folder.begin()?;
        let path = self.folder.plan();
        let mut file = self.folder.unfinished(&path, self.plan.id())?;
        file.write_all(self.plan.text().as_bytes())
            .and_then(|()| complete(file, &path, false))
            .map_err(|e| match e.kind() {
                ErrorKind::AlreadyExists => begun(),
                _ => DatasetError::io("write", &path, e),
            })
    }

    /// Examines all entries among the parts.
    ///
    /// * `deep`: true to verify the hash of all bytes, false to verify only the footers.
    ///
    /// # Errors
    ///
    /// [`DatasetError`] if the folder cannot be read, or if the workers are stopped. Defects of
    /// parts are part of the result.
    pub fn survey(&self, deep: bool, workers: &Workers<'_>) -> Result<FolderScan, DatasetError> {
        let (numbers, mut survey) = self.listed()?;
        let verified: Vec<_> = workers.pool.install(|| {
            let verify = |number: &u64| {
                let path = self.part_file(*number);
                let range = self.plan.range_of(*number);
                verify(&path, range, deep, workers).map_err(|why| (path, why))
            };
            numbers.par_iter().map(verify).collect()
        });
        for verified in verified {
            match verified {
                Ok(Some(part)) => {
                    survey.parts.insert(part.number, part);
                }
                Ok(None) => return Err(DatasetError::Stopped),
                Err(damaged) => survey.damaged.push(damaged),
            }
        }
        survey.damaged.sort_by(|(a, _), (b, _)| a.cmp(b));
        survey.unknown_files.sort();
        Ok(survey)
    }

    /// Returns the numbers of the parts whose names are in the folder, and the other entries.
    fn listed(&self) -> Result<(Vec<u64>, FolderScan), DatasetError> {
        let (mut numbers, mut survey) = (Vec::new(), FolderScan::default());
        for entry in self.folder.data()? {
            let name = entry.file_name();
            let name = name.to_string_lossy();
            let number = name.strip_prefix("part-").and_then(|n| n.strip_suffix(".parquet"));
            match number.map(str::parse) {
                Some(Ok(number))
                    if number < self.plan.parts() && self.part_file(number) == entry.path() =>
                {
                    numbers.push(number);
                }
                _ if is_read_as_part(&entry) => {
                    survey.damaged.push((entry.path(), PartDefect::NotInThePlan));
                }
                _ => survey.unknown_files.push(entry.path()),
            }
        }
        Ok((numbers, survey))
    }

    /// Rejects parts that are not in the plan, because programs that read the folder would read
    /// them, too.
    ///
    /// # Errors
    ///
    /// [`DatasetError::Damaged`] with these parts, or [`DatasetError::Io`].
    pub fn check_names(&self) -> Result<(), DatasetError> {
        match self.listed()?.1.damaged {
            none if none.is_empty() => Ok(()),
            many => Err(DatasetError::Damaged(many)),
        }
    }

    /// Returns the points of the plan. For a table, checks that it is the table for which the plan
    /// was made.
    ///
    /// * `table`: path of the table. Defaults to its name in the parent folder.
    ///
    /// # Errors
    ///
    /// The errors of [`Plan::points`].
    pub fn points(
        &self,
        table: Option<&Path>,
        workers: &Workers<'_>,
    ) -> Result<Points, DatasetError> {
        let beside = |name: &str| self.folder.path.join("..").join(name);
        let found = |name: &str| table.map_or_else(|| beside(name), Path::to_owned);
        self.plan.points(found, workers)
    }

    /// Returns the part with a number if it is finished and intact, or `None` if it does not exist.
    ///
    /// * `deep`: true to verify all bytes, false to verify only the footer.
    ///
    /// # Errors
    ///
    /// [`PartDefect`] of a file that is not the part, or [`DatasetError::Stopped`].
    fn find(
        &self,
        number: u64,
        deep: bool,
        workers: &Workers<'_>,
    ) -> Result<Result<Option<Part>, PartDefect>, DatasetError> {
        match verify(&self.part_file(number), self.plan.range_of(number), deep, workers) {
            Ok(None) => Err(DatasetError::Stopped),
            Ok(part) => Ok(Ok(part)),
            Err(PartDefect::Io(error)) if error.kind() == ErrorKind::NotFound => Ok(Ok(None)),
            Err(damage) => Ok(Err(damage)),
        }
    }

    /// Solves one part into a file without its final name.
    fn write_part(
        &self,
        number: u64,
        task: &Task,
        source: &mut dyn Source,
        workers: &Workers<'_>,
        notify: &mut dyn FnMut(Event<'_>),
    ) -> Result<(TempFile, Part), DatasetError> {
        let range = self.plan.range(number)?;
        let path = self.part_file(number);
        let unwritable = |error| DatasetError::Write { path: path.clone(), error };
        let file = self.folder.unfinished(&path, self.plan.id())?;
        let out = HashingWriter::new(BufWriter::new(file));
        let mut seen = |chunk: &Chunk, answers: &Answers| notify(Event::Solved(chunk, answers));
        let (columns, table_format) = (source.columns(), TableFormat::default());
        let sink = TableSink::new(Format::Parquet, out, columns, &task.outputs, &table_format);
        let run = task.run(source, sink.map_err(unwritable)?, range.rows, workers, &mut seen);
        let (sink, count) = run.map_err(|error| not_solved(error, unwritable))?;
        range.check(count)?;
        write_footer(sink, range, count).map_err(unwritable)
    }

    /// Gives a solved part its final name.
    fn keep(
        &self,
        file: TempFile,
        part: Part,
        replace: bool,
        workers: &Workers<'_>,
    ) -> Result<Part, DatasetError> {
        let path = self.part_file(part.number);
        let file = file.into_inner().map_err(io::IntoInnerError::into_error);
        match file.and_then(|file| complete(file, &path, replace)) {
            Ok(()) => Ok(part),
            // Another process may have finished the part and cleaned up in the meantime.
            Err(error) => match self.find(part.number, false, workers)? {
                Ok(Some(there)) if there == part => Ok(there),
                _ => Err(DatasetError::io("write", &path, error)),
            },
        }
    }

    /// Solves the missing parts of a list in order. Damaged parts do not stop the run and are
    /// reported at the end.
    ///
    /// * `numbers`: numbers of the parts in ascending order.
    /// * `repair`: true to verify all bytes of existing parts, to replace damaged files, and to
    ///   renew the list of the parts. Nothing is replaced if most files belong to the same other
    ///   plan.
    ///
    /// # Errors
    ///
    /// [`DatasetError`]. Finished parts are kept.
    pub fn run_parts(
        &self,
        task: &Task,
        points: &Points,
        numbers: impl IntoIterator<Item = u64>,
        repair: bool,
        workers: &Workers<'_>,
        notify: &mut dyn FnMut(Event<'_>),
    ) -> Result<BTreeMap<u64, Part>, DatasetError> {
        if repair && let Some(other) = self.survey(false, workers)?.other_plan() {
            return Err(DatasetError::NotOfThePlan(format!(
                "{} has parts of another plan, {}, beside its plan.json; restore the plan.json of these parts, or \
                 use another folder",
                self.folder.path.display(),
                &other[..other.len().min(12)]
            )));
        }
        self.folder.make_folders()?;
        let mut source = points.open().map_err(DatasetError::Read)?;
        let mut at = 0;
        let (mut parts, mut damaged) = (BTreeMap::new(), Vec::new());
        thread::scope(|scope| {
            let joined = |thread: ScopedJoinHandle<'_, Result<Part, _>>| {
                let kept = thread.join().unwrap_or_else(|panic| resume_unwind(panic));
                kept.map(|part| (part.number, part))
            };
            let mut behind = None;
            for number in numbers {
                let first = self.plan.range(number)?.first_row;
                let found = self.find(number, repair, workers)?;
                let replace = found.is_err();
                match found {
                    Ok(Some(part)) => {
                        notify(Event::Found(&part));
                        parts.insert(number, part);
                        continue;
                    }
                    Err(damage) if !repair => {
                        damaged.push((self.part_file(number), damage));
                        continue;
                    }
                    Ok(None) | Err(_) => {}
                }
                source.skip(first - at).map_err(DatasetError::Read)?;
                let (file, part) =
                    self.write_part(number, task, source.as_mut(), workers, notify)?;
                at = first + part.rows;
                // While the disk finishes the part, the next part is solved.
                let keep = move || self.keep(file, part, replace, workers);
                let keep = thread::Builder::new().spawn_scoped(scope, keep);
                let before = behind.replace(keep.map_err(DatasetError::Thread)?);
                parts.extend(before.map(joined).transpose()?);
            }
            parts.extend(behind.map(joined).transpose()?);
            Ok(())
        })?;
        if repair {
            self.repair_list(workers)?;
        }
        if damaged.is_empty() { Ok(parts) } else { Err(DatasetError::Damaged(damaged)) }
    }

    /// Renews the list of the parts if it exists, or removes it if a part is missing or damaged.
    fn repair_list(&self, workers: &Workers<'_>) -> Result<(), DatasetError> {
        let path = self.folder.list();
        if fs::symlink_metadata(&path).is_err() {
            return Ok(());
        }
        let found = self.survey(false, workers)?;
        if found.is_complete(&self.plan) {
            return self.write_list(&found.parts);
        }
        match fs::remove_file(&path) {
            // Another process may have removed the list in the meantime.
            Err(error) if error.kind() != ErrorKind::NotFound => {
                Err(DatasetError::io("remove", &path, error))
            }
            _ => Ok(()),
        }
    }

    /// Solves all missing parts in order, and finishes the folder.
    ///
    /// # Errors
    ///
    /// [`DatasetError`]. Finished parts are kept.
    pub fn run(
        &self,
        task: &Task,
        points: &Points,
        mut found: FolderScan,
        workers: &Workers<'_>,
        notify: &mut dyn FnMut(Event<'_>),
    ) -> Result<Count, DatasetError> {
        if !found.damaged.is_empty() {
            return Err(DatasetError::Damaged(found.damaged));
        }
        for part in found.parts.values() {
            notify(Event::Found(part));
        }
        let missing = found.missing(&self.plan).into_iter().flatten();
        found.parts.append(&mut self.run_parts(task, points, missing, false, workers, notify)?);
        self.finish(&found.parts)?;
        Ok(found.count())
    }

    /// Writes the list of the parts, and removes temporary files of this plan.
    ///
    /// * `parts`: all parts of the plan.
    ///
    /// # Errors
    ///
    /// [`DatasetError`] if the list cannot be written.
    pub fn finish(&self, parts: &BTreeMap<u64, Part>) -> Result<(), DatasetError> {
        self.write_list(parts)?;
        self.folder.tidy(self.plan.id())
    }

    /// Writes the list of the parts, unless it is already written.
    fn write_list(&self, parts: &BTreeMap<u64, Part>) -> Result<(), DatasetError> {
        let path = self.folder.list();
        let list =
            list_parts(parts).map_err(|error| DatasetError::Write { path: path.clone(), error })?;
        let unwritable = |error| DatasetError::io("write", &path, error);
        if let Ok(found) = fs::symlink_metadata(&path)
            && !found.is_file()
        {
            return Err(unwritable(io::Error::other(format!("it is {}", kind(&found)))));
        }
        let is_written = || fs::read(&path).is_ok_and(|found| found == list);
        let write = || {
            let mut file = self.folder.unfinished(&path, self.plan.id())?;
            file.write_all(&list).and_then(|()| complete(file, &path, true)).map_err(unwritable)
        };
        // Another process may finish the folder and clean up at the same moment.
        if !is_written()
            && let Err(error) = write()
            && !is_written()
        {
            return Err(error);
        }
        Ok(())
    }
}

/// Returns true if programs that read the folder take an entry for a part, which is the case for
/// Parquet files and folders. These programs ignore names that begin with a dot.
fn is_read_as_part(entry: &fs::DirEntry) -> bool {
    let name = entry.file_name().to_string_lossy().to_ascii_lowercase();
    !name.starts_with('.') && (name.ends_with(".parquet") || entry.path().is_dir())
}
