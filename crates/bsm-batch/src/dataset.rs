//! Datasets: folders that contain a plan and the part files into which the results are divided.
//! Part files verify themselves. Any process may solve any part, in any order and more than once.
//!
//! ```text
//! map/
//!   plan.json                  written first, never changed
//!   data/part-000000.parquet   finished parts and nothing else
//!   tmp/                       unfinished files
//!   parts.parquet             written last; lists the contents of all part footers
//! ```
//!
//! The bytes of a part depend only on the plan. A part counts as finished only if its footer,
//! length and hash are correct. Any other file with the name of a part is reported and kept.

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

use self::error::kind;
use self::folder::{Folder, complete};
use self::part::{HashingWriter, list_parts, verify, write_footer};
use crate::table::MemorySink;
use crate::{
    Answers, Chunk, Count, Format, RunError, Source, TableError, TableFormat, TableSink, Task,
    Workers,
};

/// A complete part file that does not have its final name yet.
type TempFile = BufWriter<NamedTempFile>;

/// Progress events of a run.
#[derive(Debug, Clone, Copy)]
pub enum Event<'a> {
    /// Files in the data folder that are not parts and that Parquet readers ignore. These files are
    /// left alone.
    UnknownFiles(&'a [PathBuf]),
    /// Number of rows in the dataset. This event precedes the `Found` and `Solved` events.
    Planned(u64),
    /// A part that had already been finished by an earlier run.
    Found(&'a Part),
    /// Newly solved rows.
    Solved(&'a Chunk, &'a Answers),
}

/// Contents of a dataset folder.
#[derive(Debug, Default)]
pub struct FolderScan {
    /// Finished parts, indexed by part number.
    pub parts: BTreeMap<u64, Part>,
    /// Files that have the name of a part but are damaged.
    pub damaged: Vec<(PathBuf, PartDefect)>,
    /// Other files in the data folder.
    pub unknown_files: Vec<PathBuf>,
}

impl FolderScan {
    /// Returns the ranges of part numbers that are in the plan but missing from the folder.
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

    /// Returns true if every part of the plan is finished and no file is damaged.
    pub fn is_complete(&self, plan: &Plan) -> bool {
        self.missing(plan).is_empty() && self.damaged.is_empty()
    }

    /// Returns the id of another plan if more part files belong to that plan than to the plan of
    /// the folder.
    pub fn other_plan(&self) -> Option<&str> {
        let mut others = self.damaged.iter().filter_map(|(_, damage)| match damage {
            PartDefect::OtherPlan(id) => Some(id.as_str()),
            _ => None,
        });
        let (count, id) = (others.clone().count(), others.next()?);
        (count > self.parts.len() && others.all(|other| other == id)).then_some(id)
    }

    /// Counts all rows, the rows without a result and the rows with several solutions.
    pub fn count(&self) -> Count {
        self.parts.values().fold(Count::default(), |count, part| Count {
            rows: count.rows + part.rows,
            failed: count.failed + part.failed,
            several: count.several + part.several,
        })
    }
}

/// Options for [`fill`].
#[derive(Debug, Clone, Copy)]
pub struct RunOptions {
    /// True to continue a dataset that has the same plan; existing parts are accepted if their
    /// footers are intact. If false, the folder must be new or empty.
    pub resume: bool,
    /// Number of rows per part. The default depends on the task.
    pub rows_per_part: Option<NonZeroU64>,
    /// Function that creates temporary files.
    pub make: MakeTemporary,
}

/// Solves all points and writes the results to a dataset folder.
///
/// # Errors
///
/// [`DatasetError`] if a part cannot be solved or written. Finished parts are kept.
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

/// Solves one part of a plan in memory.
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

/// Converts the error that stopped a part from being solved.
fn not_solved(error: RunError, unwritable: impl Fn(TableError) -> DatasetError) -> DatasetError {
    match error {
        RunError::Read(error) => DatasetError::Read(error),
        RunError::Write(error) => unwritable(error),
        RunError::Thread(error) => DatasetError::Thread(error),
        RunError::Stopped => DatasetError::Stopped,
    }
}

/// A dataset folder together with its plan.
#[derive(Debug)]
pub struct Dataset {
    folder: Folder,
    plan: Plan,
}

impl Dataset {
    /// Creates a dataset. The folder must be new or empty.
    ///
    /// # Errors
    ///
    /// [`DatasetError`] if the folder contains other files or cannot be created.
    pub fn create(folder: &Path, plan: Plan, make: MakeTemporary) -> Result<Self, DatasetError> {
        let this = Self { folder: Folder::new(folder, make), plan };
        this.begin()?;
        Ok(this)
    }

    /// Continues a dataset that has the same plan, or creates a new dataset.
    ///
    /// # Errors
    ///
    /// [`DatasetError`] if the folder contains another plan or cannot be created.
    pub fn resume(folder: &Path, plan: Plan, make: MakeTemporary) -> Result<Self, DatasetError> {
        let this = Self { folder: Folder::new(folder, make), plan };
        // Another process may be creating the folder at the same time.
        if let Err(error) = this.begin()
            && !this.is_begun()
        {
            return Err(error);
        }
        this.compare()?;
        this.folder.make_folders()?;
        Ok(this)
    }

    /// Opens an existing dataset and reads its plan.
    ///
    /// # Errors
    ///
    /// [`DatasetError`] if the folder contains no valid plan.
    pub fn open(folder: &Path, make: MakeTemporary) -> Result<Self, DatasetError> {
        let folder = Folder::new(folder, make);
        let plan = Plan::from_text(&folder.read_plan()?)
            .map_err(|why| DatasetError::NotAPlan { path: folder.plan(), why })?;
        Ok(Self { folder, plan })
    }

    /// Returns the plan of the dataset.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Returns the path of a part file.
    pub fn part_file(&self, number: u64) -> PathBuf {
        self.folder.part(number)
    }

    /// Returns true if the folder contains an entry with the name of the plan file.
    fn is_begun(&self) -> bool {
        fs::symlink_metadata(self.folder.plan()).is_ok()
    }

    /// Checks that the folder contains the same plan.
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

    /// Creates the folder and writes the plan file.
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

    /// Examines all entries of the data folder.
    ///
    /// * `deep`: true to verify the hash of all bytes, false to verify only the footers.
    ///
    /// # Errors
    ///
    /// [`DatasetError`] if the folder cannot be read or if the run is stopped. Defects of parts are
    /// not errors, but are included in the result.
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

    /// Lists the data folder: returns the numbers of the parts that are present, and the other
    /// entries.
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

    /// Rejects part files that are not in the plan, because programs that read the folder would
    /// read these files, too.
    ///
    /// # Errors
    ///
    /// [`DatasetError::Damaged`] with the rejected files, or [`DatasetError::Io`].
    pub fn check_names(&self) -> Result<(), DatasetError> {
        match self.listed()?.1.damaged {
            none if none.is_empty() => Ok(()),
            many => Err(DatasetError::Damaged(many)),
        }
    }

    /// Returns the points of the plan. If the points come from a table, checks that the table has
    /// not changed since the plan was made.
    ///
    /// * `table`: path of the table. By default, the table is searched by name in the parent folder
    ///   of the dataset.
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

    /// Returns the part with the given number if it is finished and intact, or `None` if its file
    /// does not exist.
    ///
    /// * `deep`: true to verify all bytes, false to verify only the footer.
    ///
    /// # Errors
    ///
    /// [`PartDefect`] if the file is not this part, or [`DatasetError::Stopped`].
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

    /// Solves one part and writes it to a temporary file.
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

    /// Renames the temporary file of a solved part to its final name.
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
            // In the meantime, another process may have finished the same part and removed the
            // temporary file.
            Err(error) => match self.find(part.number, false, workers)? {
                Ok(Some(there)) if there == part => Ok(there),
                _ => Err(DatasetError::io("write", &path, error)),
            },
        }
    }

    /// Solves the missing parts of a list in order. Damaged parts do not stop the run; they are
    /// reported at the end.
    ///
    /// * `numbers`: part numbers in ascending order.
    /// * `repair`: true to verify all bytes of existing parts, to replace damaged files and to
    ///   rewrite the list of parts. Nothing is replaced if most files belong to one other plan.
    ///
    /// # Errors
    ///
    /// [`DatasetError`] if a part cannot be solved or written. Finished parts are kept.
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
                // The next part is solved while this part is written to disk.
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

    /// Rewrites an existing list of parts, or removes it if a part is missing or damaged.
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

    /// Solves all missing parts in order and completes the dataset.
    ///
    /// # Errors
    ///
    /// [`DatasetError`] if a part cannot be solved or written. Finished parts are kept.
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

    /// Writes the list of parts and removes the temporary files of this plan.
    ///
    /// * `parts`: all parts of the plan.
    ///
    /// # Errors
    ///
    /// [`DatasetError`] if the list of parts cannot be written.
    pub fn finish(&self, parts: &BTreeMap<u64, Part>) -> Result<(), DatasetError> {
        self.write_list(parts)?;
        self.folder.tidy(self.plan.id())
    }

    /// Writes the list of parts, unless the file already has the correct contents.
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
        // Another process may be finishing the dataset and removing temporary files at the same
        // time.
        if !is_written()
            && let Err(error) = write()
            && !is_written()
        {
            return Err(error);
        }
        Ok(())
    }
}

/// Returns true if other programs would read an entry of the data folder as a part: a Parquet file
/// or a folder whose name does not begin with a dot.
fn is_read_as_part(entry: &fs::DirEntry) -> bool {
    let name = entry.file_name().to_string_lossy().to_ascii_lowercase();
    !name.starts_with('.') && (name.ends_with(".parquet") || entry.path().is_dir())
}
