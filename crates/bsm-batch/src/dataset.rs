//! Folders of parts: one plan, parts that prove themselves, in any order, more than once, by anybody.
//!
//! ```text
//! map/
//!   plan.json                  written first, never changed
//!   data/part-000000.parquet   finished parts and nothing else
//!   tmp/                       unfinished files
//!   shards.parquet             written last: what the footers of the parts say
//! ```
//!
//! The bytes of a part depend on the plan only. A part is there because its footer, its length and its
//! hash say so; whatever else stands under its name is told and left alone.

mod digest;
mod part;
mod plan;

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Read, Write};
use std::num::NonZeroU64;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use arrow_array::{ArrayRef, RecordBatch, StringArray, UInt64Array};
use parquet::arrow::ArrowWriter;
use rayon::prelude::*;
use tempfile::NamedTempFile;

pub use self::part::{Damage, Part};
pub use self::plan::{MOST_SHARDS, Plan, Points, RESULTS};

use self::part::{Place, Proving, kind, prove, seal};
use crate::{Answers, Chunk, Count, ParquetSink, RunError, Source, TableError, Task, Workers};

/// Names in a folder.
const PLAN: &str = "plan.json";
const DATA: &str = "data";
const UNFINISHED: &str = "tmp";
const SHARDS: &str = "shards.parquet";
/// What older versions wrote in place of a plan.
const OLD_PLAN: &str = "parts.json";

/// Letters at the end of the name of an unfinished file, and of the id of the plan in it.
const RANDOM: usize = 8;
const SHORT_ID: usize = 12;

/// A folder that cannot be made, gone on with or finished.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DatasetError {
    /// The disk.
    #[error("cannot {doing} {}: {error}", path.display())]
    Io {
        /// What was being done.
        doing: &'static str,
        /// To what.
        path: PathBuf,
        /// What the system said.
        error: io::Error,
    },
    /// The points cannot be read.
    #[error(transparent)]
    Read(TableError),
    /// A part cannot be written.
    #[error("cannot write {}: {error}", path.display())]
    Write {
        /// The part.
        path: PathBuf,
        /// Why.
        error: TableError,
    },
    /// A thread cannot be started.
    #[error("cannot start a thread: {0}")]
    Thread(io::Error),
    /// It was asked to stop.
    #[error("stopped")]
    Stopped,
    /// Points that are gone once they are read.
    #[error("{} is {found}: a folder of parts needs points that can be read twice, from a file",
        path.display())]
    NotReadTwice {
        /// The points.
        path: PathBuf,
        /// What it is.
        found: &'static str,
    },
    /// Points with fewer rows than before.
    #[error(
        "the points have changed while they were solved: part {shard} has {found} of {rows} rows"
    )]
    PointsChanged {
        /// The part.
        shard: u64,
        /// Its rows by the plan.
        rows: u64,
        /// Those that there were.
        found: u64,
    },
    /// More parts than a folder takes.
    #[error(
        "{rows} rows in parts of {rows_per_shard} are more than {MOST_SHARDS} parts; take at least \
        {least} rows for a part"
    )]
    TooManyShards {
        /// All rows.
        rows: u64,
        /// Rows of a part.
        rows_per_shard: NonZeroU64,
        /// The fewest that are possible.
        least: u64,
    },
    /// A folder of something else.
    #[error("{} is a folder with something else in it", .0.display())]
    SomethingElse(PathBuf),
    /// A folder of an older version.
    #[error("{} holds the parts of an older version of bsm ({OLD_PLAN}), which this one cannot go on with; \
        take another folder", .0.display())]
    Older(PathBuf),
    /// A folder that was begun before.
    #[error("{} holds the parts of {} task; go on with --resume, or take another folder", folder.display(),
        if *same { "this" } else { "another" })]
    Begun {
        /// The folder.
        folder: PathBuf,
        /// Whether its plan is the one that was given.
        same: bool,
    },
    /// A folder with another plan.
    #[error("{} holds the parts of another task, which differs in: {differences}", folder.display())]
    AnotherPlan {
        /// The folder.
        folder: PathBuf,
        /// Keys of the plan that are not the same.
        differences: String,
    },
    /// What stands in place of the plan is none.
    #[error("{} is not the plan of this task: {why}", path.display())]
    NotAPlan {
        /// The file.
        path: PathBuf,
        /// Why not.
        why: String,
    },
    /// What stands in place of parts is none of the plan's.
    #[error("{}; move {} away, and it is solved again with --resume",
        words(.0), if .0.len() == 1 { "it" } else { "each" })]
    Damaged(Vec<(PathBuf, Damage)>),
}

impl DatasetError {
    fn io(doing: &'static str, path: &Path, error: io::Error) -> Self {
        Self::Io { doing, path: path.to_owned(), error }
    }
}

/// The first few of what is wrong.
fn words(damaged: &[(PathBuf, Damage)]) -> String {
    const SHOWN: usize = 3;
    let shown = damaged.iter().take(SHOWN).map(|(path, why)| format!("{} {why}", path.display()));
    let more = damaged.len().checked_sub(SHOWN).filter(|more| *more > 0);
    shown.chain(more.map(|more| format!("and {more} more"))).collect::<Vec<_>>().join("; ")
}

/// Makes an unfinished file. A program that is interrupted makes it known before, so that it is removed.
pub type MakeTemporary =
    fn(&mut dyn FnMut() -> io::Result<NamedTempFile>) -> io::Result<NamedTempFile>;

/// What happens in a run.
#[derive(Debug, Clone, Copy)]
pub enum Event<'a> {
    /// Rows of a part that was there.
    Found(u64),
    /// Rows that were solved.
    Solved(&'a Chunk, &'a Answers),
}

/// What is in a folder.
#[derive(Debug, Default)]
pub struct Survey {
    /// Finished parts, by their number.
    pub parts: BTreeMap<u64, Part>,
    /// What stands in place of parts and is none.
    pub damaged: Vec<(PathBuf, Damage)>,
    /// Other files among the parts.
    pub foreign: Vec<PathBuf>,
}

/// A folder and its plan.
#[derive(Debug)]
pub struct Dataset {
    folder: PathBuf,
    plan: Plan,
    make: MakeTemporary,
}

impl Dataset {
    /// Begins a folder, which must be new or empty.
    ///
    /// # Errors
    ///
    /// [`DatasetError`].
    pub fn create(folder: &Path, plan: Plan, make: MakeTemporary) -> Result<Self, DatasetError> {
        let this = Self { folder: folder.to_owned(), plan, make };
        if fs::symlink_metadata(this.plan_file()).is_ok() {
            let same = this.compare().is_ok();
            return Err(DatasetError::Begun { folder: this.folder, same });
        }
        this.begin()?;
        Ok(this)
    }

    /// Goes on with a folder of the same plan, or begins it.
    ///
    /// # Errors
    ///
    /// [`DatasetError`].
    pub fn resume(folder: &Path, plan: Plan, make: MakeTemporary) -> Result<Self, DatasetError> {
        let this = Self { folder: folder.to_owned(), plan, make };
        let begun = || fs::symlink_metadata(this.plan_file()).is_ok();
        if !begun()
            && let Err(error) = this.begin()
            && !begun()
        {
            return Err(error);
        }
        // Somebody else may have begun it in the meantime.
        this.compare()?;
        this.make_folders()?;
        Ok(this)
    }

    /// Opens a folder with the plan that is in it.
    ///
    /// # Errors
    ///
    /// [`DatasetError`].
    pub fn open(folder: &Path, make: MakeTemporary) -> Result<Self, DatasetError> {
        let path = folder.join(PLAN);
        let text = read_plan(&path)?;
        let plan = Plan::from_text(&text).map_err(|why| DatasetError::NotAPlan { path, why })?;
        Ok(Self { folder: folder.to_owned(), plan, make })
    }

    /// The plan.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    fn plan_file(&self) -> PathBuf {
        self.folder.join(PLAN)
    }

    /// Where a part is once it is finished.
    pub fn part_file(&self, shard: u64) -> PathBuf {
        self.folder.join(DATA).join(part_name(shard))
    }

    /// Compares the plan with that of the folder.
    fn compare(&self) -> Result<(), DatasetError> {
        let path = self.plan_file();
        let text = read_plan(&path)?;
        if text == self.plan.text() {
            return Ok(());
        }
        match self.plan.differences(&text) {
            Some(differences) => {
                Err(DatasetError::AnotherPlan { folder: self.folder.clone(), differences })
            }
            None => Err(DatasetError::NotAPlan { path, why: "it is damaged".to_owned() }),
        }
    }

    /// Makes the folder and writes the plan.
    fn begin(&self) -> Result<(), DatasetError> {
        let folder = &self.folder;
        fs::create_dir_all(folder).map_err(|e| DatasetError::io("make folder", folder, e))?;
        if folder.join(OLD_PLAN).exists() {
            return Err(DatasetError::Older(folder.clone()));
        }
        // A run that was killed in its first moments leaves empty folders and unfinished files.
        for entry in entries(folder)? {
            let name = entry.file_name();
            let own = match name.to_str() {
                Some(DATA) => is_folder(&entry) && entries(&entry.path())?.is_empty(),
                Some(UNFINISHED) => {
                    is_folder(&entry)
                        && entries(&entry.path())?.iter().all(|e| unfinished_id(e).is_some())
                }
                _ => false,
            };
            if !own {
                return Err(DatasetError::SomethingElse(folder.clone()));
            }
        }
        self.make_folders()?;
        let file = self.plan_file();
        let mut out = self.temporary("plan")?;
        out.write_all(self.plan.text().as_bytes())
            .and_then(|()| out.as_file().sync_all())
            .and_then(|()| out.persist_noclobber(&file).map_err(|e| e.error))
            .and_then(|_| sync_folder(folder))
            .map_err(|e| match e.kind() {
                ErrorKind::AlreadyExists => {
                    DatasetError::Begun { folder: folder.clone(), same: self.compare().is_ok() }
                }
                _ => DatasetError::io("write", &file, e),
            })
    }

    fn make_folders(&self) -> Result<(), DatasetError> {
        for name in [UNFINISHED, DATA] {
            let path = self.folder.join(name);
            fs::create_dir_all(&path).map_err(|e| DatasetError::io("make folder", &path, e))?;
        }
        Ok(())
    }

    /// An unfinished file, which is removed unless it gets another name.
    fn temporary(&self, name: &str) -> Result<NamedTempFile, DatasetError> {
        let folder = self.folder.join(UNFINISHED);
        let prefix = format!("{name}.{}.", &self.plan.id()[..SHORT_ID]);
        let mut builder = tempfile::Builder::new();
        builder.prefix(&prefix).rand_bytes(RANDOM);
        // Temporary files are private; a result gets what the user's mask leaves of 0666.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        (self.make)(&mut || builder.tempfile_in(&folder))
            .map_err(|e| DatasetError::io("write in folder", &folder, e))
    }

    /// Looks at everything among the parts.
    ///
    /// * `deep`: whether the hash of all bytes is taken, or that of the footers only.
    ///
    /// # Errors
    ///
    /// [`DatasetError`] if the folder cannot be read, or the workers are stopped. What is wrong with a part
    /// is no error here.
    pub fn survey(&self, deep: bool, workers: &Workers<'_>) -> Result<Survey, DatasetError> {
        let mut survey = Survey::default();
        let mut shards = Vec::new();
        for entry in entries(&self.folder.join(DATA))? {
            let name = entry.file_name();
            let name = name.to_string_lossy();
            let shard = name.strip_prefix("part-").and_then(|n| n.strip_suffix(".parquet"));
            match shard.map(str::parse) {
                Some(Ok(shard)) if shard < self.plan.shards() && part_name(shard) == name => {
                    shards.push(shard);
                }
                Some(_) => survey.damaged.push((entry.path(), Damage::NotInThePlan)),
                None => survey.foreign.push(entry.path()),
            }
        }
        let proven: Vec<_> = workers.pool.install(|| {
            let prove = |shard: &u64| {
                let path = self.part_file(*shard);
                prove(&path, self.plan.place(*shard), deep, workers).map_err(|why| (path, why))
            };
            shards.par_iter().map(prove).collect()
        });
        for proven in proven {
            match proven {
                Ok(Some(part)) => {
                    survey.parts.insert(part.shard, part);
                }
                Ok(None) => return Err(DatasetError::Stopped),
                Err(damaged) => survey.damaged.push(damaged),
            }
        }
        survey.damaged.sort_by(|(a, _), (b, _)| a.cmp(b));
        survey.foreign.sort();
        Ok(survey)
    }

    /// Solves one part, unless it is there.
    ///
    /// * `source`: rows from the first of the part on.
    ///
    /// # Errors
    ///
    /// [`DatasetError`]; nothing stays then.
    pub fn run_shard(
        &self,
        shard: u64,
        task: &Task,
        source: &mut dyn Source,
        workers: &Workers<'_>,
        tell: &mut dyn FnMut(Event<'_>),
    ) -> Result<Part, DatasetError> {
        let place = self.plan.place(shard);
        let path = self.part_file(shard);
        let unwritable = |error| DatasetError::Write { path: path.clone(), error };
        let name = part_name(shard);
        let file = self.temporary(name.strip_suffix(".parquet").unwrap_or(&name))?;
        let out = Proving::new(BufWriter::new(file));
        let sink = ParquetSink::new(out, source.columns(), &task.outputs).map_err(unwritable)?;
        let mut seen = |chunk: &Chunk, answers: &Answers| tell(Event::Solved(chunk, answers));
        let run = task.run(source, sink, place.rows, workers, &mut seen);
        let (sink, count) = run.map_err(|error| match error {
            RunError::Read(error) => DatasetError::Read(error),
            RunError::Write(error) => unwritable(error),
            RunError::Thread(error) => DatasetError::Thread(error),
            RunError::Stopped => DatasetError::Stopped,
        })?;
        if count.rows != place.rows {
            let Place { rows, .. } = place;
            return Err(DatasetError::PointsChanged { shard, rows, found: count.rows });
        }
        let (out, part) = seal(sink, place, count).map_err(unwritable)?;
        let named = || -> io::Result<()> {
            let file = out.into_inner().map_err(io::IntoInnerError::into_error)?;
            file.as_file().sync_all()?;
            file.persist_noclobber(&path).map_err(|e| e.error)?;
            sync_folder(&self.folder.join(DATA))
        };
        match named() {
            Ok(()) => Ok(part),
            // Somebody else may have finished it in the meantime, and may have tidied up.
            Err(error) => match prove(&path, place, false, workers) {
                Ok(Some(there)) if there == part => Ok(there),
                _ => Err(DatasetError::io("write", &path, error)),
            },
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
        found: Survey,
        workers: &Workers<'_>,
        tell: &mut dyn FnMut(Event<'_>),
    ) -> Result<Count, DatasetError> {
        if !found.damaged.is_empty() {
            return Err(DatasetError::Damaged(found.damaged));
        }
        let mut parts = found.parts;
        for part in parts.values() {
            tell(Event::Found(part.rows));
        }
        let mut source = points.open().map_err(DatasetError::Read)?;
        let mut at = 0;
        for shard in 0..self.plan.shards() {
            if parts.contains_key(&shard) {
                continue;
            }
            let first = self.plan.place(shard).first_row;
            source.skip(first - at).map_err(DatasetError::Read)?;
            let part = self.run_shard(shard, task, source.as_mut(), workers, tell)?;
            at = first + part.rows;
            parts.insert(shard, part);
        }
        self.finish(&parts)?;
        Ok(parts.values().fold(Count::default(), |count, part| Count {
            rows: count.rows + part.rows,
            failed: count.failed + part.failed,
            several: count.several + part.several,
        }))
    }

    /// Writes the list of all parts, and removes what killed runs of this plan have left.
    ///
    /// # Errors
    ///
    /// [`DatasetError`].
    pub fn finish(&self, parts: &BTreeMap<u64, Part>) -> Result<(), DatasetError> {
        let path = self.folder.join(SHARDS);
        let unwritable = |error| DatasetError::Write { path: path.clone(), error };
        let list = list(&parts.values()).map_err(unwritable)?;
        let write = || -> Result<(), DatasetError> {
            let mut out = self.temporary("shards")?;
            out.write_all(&list)
                .and_then(|()| out.as_file().sync_all())
                .and_then(|()| out.persist(&path).map_err(|e| e.error))
                .and_then(|_| sync_folder(&self.folder))
                .map_err(|e| DatasetError::io("write", &path, e))
        };
        let written = || fs::read(&path).is_ok_and(|bytes| bytes == list);
        match fs::symlink_metadata(&path) {
            Ok(found) if !found.is_file() => {
                let other = io::Error::other(format!("it is {}", kind(&found)));
                return Err(DatasetError::io("write", &path, other));
            }
            Ok(_) if written() => {}
            _ => match write() {
                // Somebody else may have finished in the meantime, and may have tidied up.
                Err(error) if !written() => return Err(error),
                _ => {}
            },
        }
        let unfinished = self.folder.join(UNFINISHED);
        for entry in entries(&unfinished)? {
            let ours = unfinished_id(&entry).is_some_and(|id| self.plan.id().starts_with(&id));
            if ours {
                match fs::remove_file(entry.path()) {
                    Err(error) if error.kind() != ErrorKind::NotFound => {
                        return Err(DatasetError::io("remove", &entry.path(), error));
                    }
                    _ => {}
                }
            }
        }
        Ok(())
    }
}

fn part_name(shard: u64) -> String {
    format!("part-{shard:06}.parquet")
}

/// The text of a plan: what cannot be one is not read.
fn read_plan(path: &Path) -> Result<String, DatasetError> {
    /// Longest plan \[B\], with axes of a million values.
    const LONGEST: u64 = 64 << 20;
    let unreadable = |error| DatasetError::io("read", path, error);
    let not_a_plan =
        |why: &str| DatasetError::NotAPlan { path: path.to_owned(), why: why.to_owned() };
    let found = fs::metadata(path).map_err(unreadable)?;
    if !found.is_file() {
        return Err(not_a_plan(&format!("it is {}", kind(&found))));
    }
    let mut text = Vec::new();
    let file = File::open(path).map_err(unreadable)?;
    file.take(LONGEST).read_to_end(&mut text).map_err(unreadable)?;
    if text.is_empty() {
        return Err(not_a_plan("it is empty"));
    }
    String::from_utf8(text).map_err(|_| not_a_plan("it is damaged"))
}

fn entries(folder: &Path) -> Result<Vec<fs::DirEntry>, DatasetError> {
    fs::read_dir(folder)
        .and_then(Iterator::collect)
        .map_err(|e| DatasetError::io("read folder", folder, e))
}

fn is_folder(entry: &fs::DirEntry) -> bool {
    entry.file_type().is_ok_and(|found| found.is_dir())
}

/// The id in the name of an unfinished file, if it has the form that [`Dataset::temporary`] gives it.
fn unfinished_id(entry: &fs::DirEntry) -> Option<String> {
    let name = entry.file_name().into_string().ok()?;
    let [what, id, random] = name.split('.').collect::<Vec<_>>()[..] else { return None };
    let part = what.strip_prefix("part-").is_some_and(|n| n.parse::<u64>().is_ok());
    let ours = (part || ["plan", "shards"].contains(&what))
        && id.len() == SHORT_ID
        && id.bytes().all(|b| b.is_ascii_hexdigit())
        && random.len() == RANDOM
        && entry.file_type().is_ok_and(|found| found.is_file());
    ours.then(|| id.to_owned())
}

/// The parts as a table.
fn list<'a>(parts: &(impl Iterator<Item = &'a Part> + Clone)) -> Result<Vec<u8>, TableError> {
    let numbers = |read: fn(&Part) -> u64| -> ArrayRef {
        Arc::new(parts.clone().map(read).collect::<UInt64Array>())
    };
    let hashes = StringArray::from_iter_values(parts.clone().map(|part| &part.data_sha256));
    let table = RecordBatch::try_from_iter([
        ("shard", numbers(|part| part.shard)),
        ("first_row", numbers(|part| part.first_row)),
        ("rows", numbers(|part| part.rows)),
        ("failed", numbers(|part| part.failed)),
        ("several", numbers(|part| part.several)),
        ("bytes", numbers(|part| part.data_bytes)),
        ("data_sha256", Arc::new(hashes)),
    ])?;
    let mut writer = ArrowWriter::try_new(Vec::new(), table.schema(), None)?;
    writer.write(&table)?;
    Ok(writer.into_inner()?)
}

/// Makes a new name last through a loss of power.
fn sync_folder(folder: &Path) -> io::Result<()> {
    // Elsewhere folders cannot be opened.
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}
