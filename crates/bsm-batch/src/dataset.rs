//! Datasets: folders that contain a plan, and part files with the results. The contents of a part
//! file can be verified without any other file. Any process may solve any part, in any order, and
//! repeatedly.
//!
//! ```text
//! map/
//!   plan.json                  written first, never changed
//!   data/part-000000.parquet   finished parts and nothing else
//!   tmp/                       unfinished files
//!   parts.parquet             written last; lists the contents of all part footers
//! ```
//!
//! The bytes of a part file depend only on the plan. A part counts as finished only if its footer,
//! length and hash are correct. Any other file that has the name of a part is reported, and is
//! overwritten only on request.

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
pub use self::plan::{Estimate, MAX_PARTS, Plan, PlanError, RESULTS};
pub use self::points::{Points, sha256};

use self::error::describe_entry;
use self::folder::{Folder, complete};
use self::part::{HashingWriter, list_parts, verify, write_footer};
use crate::table::MemorySink;
use crate::{
    Answers, Chunk, Count, Format, RunError, Source, TableError, TableFormat, TableSink, Task,
    Workers,
};

/// A complete part file that still has a temporary name.
type TempFile = BufWriter<NamedTempFile>;

/// Events that report the progress of a run.
#[derive(Debug, Clone, Copy)]
pub enum Event<'a> {
    /// Files in the data folder that are not parts and that Parquet readers ignore. The program
    /// does not change these files.
    UnknownFiles(&'a [PathBuf]),
    /// Number of rows in the dataset. This event comes before all `Found` and `Solved` events.
    Planned(u64),
    /// A part that an earlier run had already finished.
    Found(&'a Part),
    /// A chunk of rows that has just been solved, and its results.
    Solved(&'a Chunk, &'a Answers),
}

/// Contents of the data folder of a dataset.
#[derive(Debug, Default)]
pub struct FolderScan {
    /// Finished parts, by part number.
    pub parts: BTreeMap<u64, Part>,
    /// Files that have the name of a part but are damaged or are not in the plan.
    pub damaged: Vec<(PathBuf, PartDefect)>,
    /// Files in the data folder that do not have the name of a part.
    pub unknown_files: Vec<PathBuf>,
}

impl FolderScan {
    /// Returns the ranges of part numbers whose parts are in the plan but not in the folder.
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

    /// Returns the id of another plan if more part files belong to that plan than to the plan in
    /// the folder.
    pub fn other_plan(&self) -> Option<&str> {
        let mut others = self.damaged.iter().filter_map(|(_, damage)| match damage {
            PartDefect::OtherPlan(id) => Some(id.as_str()),
            _ => None,
        });
        let (count, id) = (others.clone().count(), others.next()?);
        (count > self.parts.len() && others.all(|other| other == id)).then_some(id)
    }

    /// Returns the total number of rows in the finished parts, the number of rows without a result,
    /// and the number of rows with further solutions.
    pub fn count(&self) -> Count {
        self.parts.values().fold(Count::default(), |count, part| Count {
            rows: count.rows + part.rows,
            failed: count.failed + part.failed,
            with_other_solutions: count.with_other_solutions + part.with_other_solutions,
        })
    }
}

/// Options for [`fill`].
#[derive(Debug, Clone, Copy)]
pub struct RunOptions {
    /// If true, a dataset with the same plan is continued, and existing parts are accepted if their
    /// footers are intact. If false, the folder must be new or empty.
    pub resume: bool,
    /// Number of rows per part. By default, it depends on the number of rows and on the model.
    pub rows_per_part: Option<NonZeroU64>,
    /// Function that creates temporary files.
    pub make: MakeTemporary,
}

/// Solves all points and writes the results to a dataset folder.
///
/// # Errors
///
/// Returns [`DatasetError`] if a part cannot be solved or written. Finished parts are kept.
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

/// Solves one part of a plan and returns its rows without writing them to a file.
///
/// # Errors
///
/// Returns [`DatasetError`] if the part cannot be read or solved.
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
    let (sink, count) = run.map_err(|error| run_error(error, DatasetError::Read))?;
    range.check(count)?;
    Ok((sink.schema, sink.tables))
}

/// Converts the error that ended the calculation of a part to a [`DatasetError`].
fn run_error(error: RunError, write_error: impl Fn(TableError) -> DatasetError) -> DatasetError {
    match error {
        RunError::Read(error) => DatasetError::Read(error),
        RunError::Write(error) => write_error(error),
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
    /// Returns [`DatasetError`] if the folder contains other files or cannot be created.
    pub fn create(folder: &Path, plan: Plan, make: MakeTemporary) -> Result<Self, DatasetError> {
        let this = Self { folder: Folder::new(folder, make), plan };
        this.write_plan()?;
        Ok(this)
    }

    /// Continues a dataset whose plan equals the given plan. If the folder does not contain a plan,
    /// a new dataset is created.
    ///
    /// # Errors
    ///
    /// Returns [`DatasetError`] if the folder contains another plan or cannot be created.
    pub fn resume(folder: &Path, plan: Plan, make: MakeTemporary) -> Result<Self, DatasetError> {
        let this = Self { folder: Folder::new(folder, make), plan };
        // Creating the dataset may fail because another process is creating it at the same time.
        if let Err(error) = this.write_plan()
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
    /// Returns [`DatasetError`] if the folder contains no valid plan.
    pub fn open(folder: &Path, make: MakeTemporary) -> Result<Self, DatasetError> {
        let folder = Folder::new(folder, make);
        let plan = Plan::from_text(&folder.read_plan()?)
            .map_err(|why| DatasetError::NotAPlan { path: folder.plan(), why: why.to_string() })?;
        Ok(Self { folder, plan })
    }

    /// Returns the plan of the dataset.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Returns the path of the part file with the given number.
    pub fn part_file(&self, number: u64) -> PathBuf {
        self.folder.part(number)
    }

    /// Returns true if the folder contains an entry with the name of the plan file.
    fn is_begun(&self) -> bool {
        fs::symlink_metadata(self.folder.plan()).is_ok()
    }

    /// Checks that the plan in the folder equals the plan of this dataset.
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
    fn write_plan(&self) -> Result<(), DatasetError> {
        let already_exists = || {
            let same = self.compare().is_ok();
            DatasetError::AlreadyExists { folder: self.folder.path.clone(), same }
        };
        if self.is_begun() {
            return Err(already_exists());
        }
        self.folder.create()?;
        let path = self.folder.plan();
        let mut file = self.folder.unfinished(&path, self.plan.id())?;
        file.write_all(self.plan.text().as_bytes())
            .and_then(|()| complete(file, &path, false))
            .map_err(|e| match e.kind() {
                ErrorKind::AlreadyExists => already_exists(),
                _ => DatasetError::io("write", &path, e),
            })
    }

    /// Verifies all parts in the data folder, and lists all other files.
    ///
    /// * `deep`: if true, the hash of all bytes is verified; if false, only the footers are
    ///   verified.
    ///
    /// # Errors
    ///
    /// Returns [`DatasetError`] if the folder cannot be read or if the run is stopped. Defects of
    /// parts are not errors; the result contains them.
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

    /// Lists the data folder without reading the files. Returns the numbers of the parts in the
    /// folder, and a scan that contains all other entries.
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

    /// Checks that the plan contains all part files in the data folder, because programs that read
    /// the folder would also read part files that are not in the plan.
    ///
    /// # Errors
    ///
    /// Returns [`DatasetError::Damaged`] with the files that are not in the plan, or
    /// [`DatasetError::Io`].
    pub fn check_names(&self) -> Result<(), DatasetError> {
        match self.listed()?.1.damaged {
            none if none.is_empty() => Ok(()),
            many => Err(DatasetError::Damaged(many)),
        }
    }

    /// Returns the points of the plan. If the points come from a table, the table must not have
    /// changed since the plan was created.
    ///
    /// * `table`: path of the table. By default, a table with the name in the plan is expected in
    ///   the parent folder of the dataset.
    ///
    /// # Errors
    ///
    /// Returns the same errors as [`Plan::points`].
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
    /// * `deep`: if true, all bytes are verified; if false, only the footer is verified.
    ///
    /// # Errors
    ///
    /// Returns [`PartDefect`] as the inner error if the file is damaged or is not the requested
    /// part, and [`DatasetError::Stopped`] if the run is stopped.
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
        let write_error = |error| DatasetError::Write { path: path.clone(), error };
        let file = self.folder.unfinished(&path, self.plan.id())?;
        let out = HashingWriter::new(BufWriter::new(file));
        let mut seen = |chunk: &Chunk, answers: &Answers| notify(Event::Solved(chunk, answers));
        let (columns, table_format) = (source.columns(), TableFormat::default());
        let sink = TableSink::new(Format::Parquet, out, columns, &task.outputs, &table_format);
        let run = task.run(source, sink.map_err(write_error)?, range.rows, workers, &mut seen);
        let (sink, count) = run.map_err(|error| run_error(error, write_error))?;
        range.check(count)?;
        write_footer(sink, range, count).map_err(write_error)
    }

    /// Gives the temporary file of a solved part its final name.
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
            // Renaming may fail because another process has finished the same part and removed the
            // temporary file.
            Err(error) => match self.find(part.number, false, workers)? {
                Ok(Some(there)) if there == part => Ok(there),
                _ => Err(DatasetError::io("write", &path, error)),
            },
        }
    }

    /// Solves the requested parts that are missing from the folder. Damaged parts do not end the
    /// run; they are reported when all other parts are finished.
    ///
    /// * `numbers`: numbers of the requested parts, in ascending order.
    /// * `repair`: if true, all bytes of existing parts are verified, damaged files are replaced,
    ///   and the list of parts is rewritten. Nothing is replaced if most files belong to another
    ///   plan.
    ///
    /// # Errors
    ///
    /// Returns [`DatasetError`] if a part cannot be solved or written. Finished parts are kept.
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
                "{} contains parts of another plan, {}, in addition to its own plan.json; restore the plan.json of these parts, or \
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
                // This part is written to disk while the next part is being solved.
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

    /// Rewrites the list of parts if it exists. If a part is missing or damaged, the list is
    /// removed instead.
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
            // Another process may have removed the list in the meantime, so a missing list is not
            // an error.
            Err(error) if error.kind() != ErrorKind::NotFound => {
                Err(DatasetError::io("remove", &path, error))
            }
            _ => Ok(()),
        }
    }

    /// Solves all missing parts in order, and writes the list of parts.
    ///
    /// # Errors
    ///
    /// Returns [`DatasetError`] if a part cannot be solved or written. Finished parts are kept.
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
    /// * `parts`: all parts of the plan, by part number.
    ///
    /// # Errors
    ///
    /// Returns [`DatasetError`] if the list of parts cannot be written.
    pub fn finish(&self, parts: &BTreeMap<u64, Part>) -> Result<(), DatasetError> {
        self.write_list(parts)?;
        self.folder.remove_temporary_files(self.plan.id())
    }

    /// Writes the list of parts, unless the file already contains this list.
    fn write_list(&self, parts: &BTreeMap<u64, Part>) -> Result<(), DatasetError> {
        let path = self.folder.list();
        let list =
            list_parts(parts).map_err(|error| DatasetError::Write { path: path.clone(), error })?;
        let write_error = |error| DatasetError::io("write", &path, error);
        if let Ok(found) = fs::symlink_metadata(&path)
            && !found.is_file()
        {
            return Err(write_error(io::Error::other(format!("it is {}", describe_entry(&found)))));
        }
        let is_written = || fs::read(&path).is_ok_and(|found| found == list);
        let write = || {
            let mut file = self.folder.unfinished(&path, self.plan.id())?;
            file.write_all(&list).and_then(|()| complete(file, &path, true)).map_err(write_error)
        };
        // Writing may fail because another process is finishing the dataset and removing temporary
        // files at the same time.
        if !is_written()
            && let Err(error) = write()
            && !is_written()
        {
            return Err(error);
        }
        Ok(())
    }
}

/// Returns true if programs that read the data folder would read an entry as a part. Such an entry
/// is a Parquet file or a folder, and its name does not begin with a dot.
fn is_read_as_part(entry: &fs::DirEntry) -> bool {
    let name = entry.file_name().to_string_lossy().to_ascii_lowercase();
    !name.starts_with('.') && (name.ends_with(".parquet") || entry.path().is_dir())
}
