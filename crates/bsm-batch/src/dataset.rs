//! Folders of parts: one plan, self-checking parts, in any order, more than once, by any process.
//!
//! ```text
//! map/
//!   plan.json                  written first, never changed
//!   data/part-000000.parquet   finished parts and nothing else
//!   tmp/                       unfinished files
//!   parts.parquet             written last: what the footers of the parts say
//! ```
//!
//! The bytes of a part depend on the plan only. A part is there because its footer, its length and its
//! hash say so; any other file of that name is reported and kept.

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
pub use self::plan::{Estimate, MOST_PARTS, Plan, RESULTS};
pub use self::points::{Points, sha256};

use self::folder::{Folder, complete};
use self::part::{HashingWriter, kind, list_parts, verify, write_footer};
use crate::table::MemorySink;
use crate::{
    Answers, Chunk, Count, Format, RunError, Source, TableError, TableFormat, TableSink, Task,
    Workers,
};

/// A part that is written and has no name yet.
type TempFile = BufWriter<NamedTempFile>;

/// Events of a run.
#[derive(Debug, Clone, Copy)]
pub enum Event<'a> {
    /// Files among the parts that are none, and that programs which read Parquet files do not read. They are left alone.
    UnknownFiles(&'a [PathBuf]),
    /// Rows that the folder is to hold; comes before any that are found or solved.
    Planned(u64),
    /// A part that was there.
    Found(&'a Part),
    /// Rows that were solved.
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
    /// The parts that a plan has and the folder has not, as ranges of their numbers.
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

    /// Returns true if every part of a plan is there and nothing among the parts is damaged.
    pub fn is_complete(&self, plan: &Plan) -> bool {
        self.missing(plan).is_empty() && self.damaged.is_empty()
    }

    /// The other plan that the parts are of: more than are of this plan, and all of the same one.
    pub fn other_plan(&self) -> Option<&str> {
        let mut others = self.damaged.iter().filter_map(|(_, damage)| match damage {
            PartDefect::OtherPlan(id) => Some(id.as_str()),
            _ => None,
        });
        let (count, id) = (others.clone().count(), others.next()?);
        (count > self.parts.len() && others.all(|other| other == id)).then_some(id)
    }

    /// Rows, and how many of them have no result or several.
    pub fn count(&self) -> Count {
        self.parts.values().fold(Count::default(), |count, part| Count {
            rows: count.rows + part.rows,
            failed: count.failed + part.failed,
            several: count.several + part.several,
        })
    }
}

/// How a folder is filled.
#[derive(Debug, Clone, Copy)]
pub struct RunOptions {
    /// Goes on with a folder of the same plan, whose parts are trusted when their bytes are as they were
    /// written; else the folder must be new or empty.
    pub resume: bool,
    /// Rows of a part; follow from the task unless given.
    pub rows_per_part: Option<NonZeroU64>,
    /// Makes unfinished files.
    pub make: MakeTemporary,
}

/// Solves all points into a folder.
///
/// # Errors
///
/// [`DatasetError`]; the parts that are finished stay.
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
/// [`DatasetError`].
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

/// Reason that ended the solve of a part.
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
    /// Begins a folder, which must be new or empty.
    ///
    /// # Errors
    ///
    /// [`DatasetError`].
    pub fn create(folder: &Path, plan: Plan, make: MakeTemporary) -> Result<Self, DatasetError> {
        let this = Self { folder: Folder::new(folder, make), plan };
        this.begin()?;
        Ok(this)
    }

    /// Goes on with a folder of the same plan, or begins it.
    ///
    /// # Errors
    ///
    /// [`DatasetError`].
    pub fn resume(folder: &Path, plan: Plan, make: MakeTemporary) -> Result<Self, DatasetError> {
        let this = Self { folder: Folder::new(folder, make), plan };
        // Somebody else may begin it at the same moment.
        if let Err(error) = this.begin()
            && !this.is_begun()
        {
            return Err(error);
        }
        this.compare()?;
        this.folder.make_folders()?;
        Ok(this)
    }

    /// Opens a folder with the plan that is in it.
    ///
    /// # Errors
    ///
    /// [`DatasetError`].
    pub fn open(folder: &Path, make: MakeTemporary) -> Result<Self, DatasetError> {
        let folder = Folder::new(folder, make);
        let plan = Plan::from_text(&folder.read_plan()?)
            .map_err(|why| DatasetError::NotAPlan { path: folder.plan(), why })?;
        Ok(Self { folder, plan })
    }

    /// The plan.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Where a part is once it is finished.
    pub fn part_file(&self, number: u64) -> PathBuf {
        self.folder.part(number)
    }

    /// Whether something has the name of the plan.
    fn is_begun(&self) -> bool {
        fs::symlink_metadata(self.folder.plan()).is_ok()
    }

    /// Compares the plan with that of the folder.
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

    /// Makes the folder and writes the plan.
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

    /// Looks at everything among the parts.
    ///
    /// * `deep`: whether the hash of all bytes is taken, or that of the footers only.
    ///
    /// # Errors
    ///
    /// [`DatasetError`] if the folder cannot be read, or the workers are stopped. What is wrong with a part
    /// is no error here.
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

    /// The parts whose names stand in the folder, and what else stands among them.
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

    /// Refuses parts that the plan does not have: programs that read the folder read them too.
    ///
    /// # Errors
    ///
    /// [`DatasetError::Damaged`] with these parts, [`DatasetError::Io`].
    pub fn check_names(&self) -> Result<(), DatasetError> {
        match self.listed()?.1.damaged {
            none if none.is_empty() => Ok(()),
            many => Err(DatasetError::Damaged(many)),
        }
    }

    /// The points of the plan; a table is read to see that it is the one that the plan was made for.
    ///
    /// * `table`: where it is; unless given, beside the folder under its name.
    ///
    /// # Errors
    ///
    /// As [`Plan::points`].
    pub fn points(
        &self,
        table: Option<&Path>,
        workers: &Workers<'_>,
    ) -> Result<Points, DatasetError> {
        let beside = |name: &str| self.folder.path.join("..").join(name);
        let found = |name: &str| table.map_or_else(|| beside(name), Path::to_owned);
        self.plan.points(found, workers)
    }

    /// The part of a number, if it is there and whole.
    ///
    /// * `deep`: whether all bytes are looked at, or those of the footer only.
    ///
    /// # Errors
    ///
    /// [`PartDefect`] of what stands there and is not the part; [`DatasetError::Stopped`].
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

    /// Solves one part into a file without its name.
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

    /// Gives a part that is solved its name.
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
            // Somebody else may have finished it in the meantime, and may have tidied up.
            Err(error) => match self.find(part.number, false, workers)? {
                Ok(Some(there)) if there == part => Ok(there),
                _ => Err(DatasetError::io("write", &path, error)),
            },
        }
    }

    /// Solves the missing parts of a list in order. Damaged parts are reported at the end; the others
    /// are solved.
    ///
    /// * `numbers`: their numbers, growing. * `repair`: whether all bytes of those that are there are looked at, and
    ///   what is no part is replaced, unless it is another plan that most of them are of. The list of the parts is renewed too.
    ///
    /// # Errors
    ///
    /// [`DatasetError`]; the parts that are finished stay.
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
                "{} has parts of another plan, {}, beside its plan.json; put the plan.json of these parts back, or \
                 take another folder",
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
                // The disk takes its time, in which the next part is solved.
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

    /// Renews the list of the parts if there is one; removes the list if a part is missing or damaged.
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

    /// Solves all parts that are not there, in their order, and finishes the folder.
    ///
    /// # Errors
    ///
    /// [`DatasetError`]; the parts that are finished stay.
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

    /// Writes the list of the parts, and removes unfinished files of this plan.
    ///
    /// * `parts`: all of the plan.
    ///
    /// # Errors
    ///
    /// [`DatasetError`].
    pub fn finish(&self, parts: &BTreeMap<u64, Part>) -> Result<(), DatasetError> {
        self.write_list(parts)?;
        self.folder.tidy(self.plan.id())
    }

    /// Writes the list of the parts, unless it is written.
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
        // Somebody else may finish at the same moment, and tidy up.
        if !is_written()
            && let Err(error) = write()
            && !is_written()
        {
            return Err(error);
        }
        Ok(())
    }
}

/// Returns true if programs that read the folder take an entry for a part: a Parquet file or a folder. Names that begin with a
/// dot are hidden from these programs.
fn is_read_as_part(entry: &fs::DirEntry) -> bool {
    let name = entry.file_name().to_string_lossy().to_ascii_lowercase();
    !name.starts_with('.') && (name.ends_with(".parquet") || entry.path().is_dir())
}
