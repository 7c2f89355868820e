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
mod error;
mod folder;
mod part;
mod plan;
mod points;

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, BufWriter, ErrorKind, Write};
use std::num::NonZeroU64;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

pub use self::error::DatasetError;
pub use self::folder::MakeTemporary;
pub use self::part::{Damage, Part};
pub use self::plan::{MOST_SHARDS, Plan, RESULTS};
pub use self::points::{Points, sha256};

use self::folder::{Folder, complete};
use self::part::{Proving, kind, list, prove, seal};
use crate::{Answers, Chunk, Count, ParquetSink, RunError, Source, Task, Workers};

/// What happens in a run.
#[derive(Debug, Clone, Copy)]
pub enum Event<'a> {
    /// Files among the parts that are none: they are left alone, and who reads the folder reads them too.
    Foreign(&'a [PathBuf]),
    /// Rows that the folder is to hold; comes before any that are found or solved.
    Planned(u64),
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

/// How a folder is filled.
#[derive(Debug, Clone, Copy)]
pub struct Filling {
    /// Goes on with a folder of the same plan, whose parts are trusted when their bytes are as they were
    /// written; else the folder must be new or empty.
    pub resume: bool,
    /// Rows of a part; follow from the task unless given.
    pub rows_per_shard: Option<NonZeroU64>,
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
    how: Filling,
    workers: &Workers<'_>,
    tell: &mut dyn FnMut(Event<'_>),
) -> Result<Count, DatasetError> {
    let Filling { resume, rows_per_shard, make } = how;
    let plan = Plan::new(task, points, rows_per_shard, workers)?;
    let begin = if resume { Dataset::resume } else { Dataset::create };
    let parts = begin(folder, plan, make)?;
    let found = parts.survey(true, workers)?;
    if !found.foreign.is_empty() {
        tell(Event::Foreign(&found.foreign));
    }
    tell(Event::Planned(parts.plan().rows()));
    parts.run(task, points, found, workers, tell)
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
    pub fn part_file(&self, shard: u64) -> PathBuf {
        self.folder.part(shard)
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
        Err(DatasetError::AnotherPlan { folder: self.folder.path.clone(), differences })
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
    pub fn survey(&self, deep: bool, workers: &Workers<'_>) -> Result<Survey, DatasetError> {
        let mut survey = Survey::default();
        let mut shards = Vec::new();
        for entry in self.folder.data()? {
            let name = entry.file_name();
            let name = name.to_string_lossy();
            let shard = name.strip_prefix("part-").and_then(|n| n.strip_suffix(".parquet"));
            match shard.map(str::parse) {
                Some(Ok(shard))
                    if shard < self.plan.shards() && self.part_file(shard) == entry.path() =>
                {
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
        let file = self.folder.unfinished(&path, self.plan.id())?;
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
            let (rows, found) = (place.rows, count.rows);
            return Err(DatasetError::PointsChanged { shard, rows, found });
        }
        let (out, part) = seal(sink, place, count).map_err(unwritable)?;
        let file = out.into_inner().map_err(io::IntoInnerError::into_error);
        match file.and_then(|file| complete(file, &path, false)) {
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
        let path = self.folder.shards();
        let list =
            list(parts).map_err(|error| DatasetError::Write { path: path.clone(), error })?;
        let unwritable = |error| DatasetError::io("write", &path, error);
        if let Ok(found) = fs::symlink_metadata(&path)
            && !found.is_file()
        {
            return Err(unwritable(io::Error::other(format!("it is {}", kind(&found)))));
        }
        let is_written = || fs::read(&path).is_ok_and(|bytes| bytes == list);
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
        self.folder.tidy(self.plan.id())
    }
}
