//! What can go wrong with a folder of parts.

use std::io;
use std::num::NonZeroU64;
use std::path::{Path, PathBuf};

use super::folder::OLD_PLAN;
use super::{MOST_PARTS, PartDefect};
use crate::TableError;

/// A folder that cannot be made, gone on with or finished.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DatasetError {
    /// The disk.
    #[error("cannot {doing} {}: {error}", path.display())]
    Io {
        /// The operation.
        doing: &'static str,
        /// To what.
        path: PathBuf,
        /// Message of the system.
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
        /// Its kind.
        found: &'static str,
    },
    /// Points with fewer rows than before.
    #[error(
        "the points have changed while they were solved: part {number} has {found} of {rows} rows"
    )]
    PointsChanged {
        /// The part.
        number: u64,
        /// Its rows by the plan.
        rows: u64,
        /// The existing ones.
        found: u64,
    },
    /// Points of a plan that name nothing.
    #[error("the points of the plan: {0}")]
    NotPoints(String),
    /// A table that is not the one of the plan.
    #[error("{} is not the table of points that the plan was made for ({name}): its contents differ",
        path.display())]
    OtherTable {
        /// The file.
        path: PathBuf,
        /// Name of the table of the plan.
        name: String,
    },
    /// Parts that the plan does not have.
    #[error("the plan has parts 0 to {}, and none of the number {number}", parts - 1)]
    NoSuchPart {
        /// The request.
        number: u64,
        /// Number of parts.
        parts: u64,
    },
    /// More parts than a folder takes.
    #[error(
        "{rows} rows in parts of {rows_per_part} are more than {MOST_PARTS} parts; take at least \
        {least} rows for a part"
    )]
    TooManyParts {
        /// All rows.
        rows: u64,
        /// Rows of a part.
        rows_per_part: NonZeroU64,
        /// The fewest that are possible.
        least: u64,
    },
    /// A folder of something else.
    #[error("{} is a folder with something else in it", .0.display())]
    SomethingElse(PathBuf),
    /// A folder of an older version.
    #[error("{} holds the parts of an older version of bsm ({OLD_PLAN}), which this one cannot continue; \
        take another folder", .0.display())]
    Older(PathBuf),
    /// A folder that was begun before.
    #[error("{} holds the parts of {} task", folder.display(), if *same { "this" } else { "another" })]
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
    /// Parts that agree on another plan than the one beside them.
    #[error("{} has parts of another plan, {}, beside its plan.json; put the plan.json of these parts back, \
        or take another folder", folder.display(), &other[..other.len().min(12)])]
    PartsOfAnotherPlan {
        /// The folder.
        folder: PathBuf,
        /// The id of their plan.
        other: String,
    },
    /// The file in place of the plan is no plan.
    #[error("{} is not the plan of this task: {why}", path.display())]
    NotAPlan {
        /// The file.
        path: PathBuf,
        /// Why not.
        why: String,
    },
    /// A file in place of a part is not of this plan.
    #[error("{}", words(.0))]
    Damaged(Vec<(PathBuf, PartDefect)>),
}

impl DatasetError {
    pub(super) fn io(doing: &'static str, path: &Path, error: io::Error) -> Self {
        Self::Io { doing, path: path.to_owned(), error }
    }
}

/// The first few of what is wrong.
fn words(damaged: &[(PathBuf, PartDefect)]) -> String {
    const SHOWN: usize = 3;
    let shown = damaged.iter().take(SHOWN).map(|(path, why)| format!("{} {why}", path.display()));
    let more = damaged.len().checked_sub(SHOWN).filter(|more| *more > 0);
    shown.chain(more.map(|more| format!("and {more} more"))).collect::<Vec<_>>().join("; ")
}
