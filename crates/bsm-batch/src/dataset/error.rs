//! Errors of a folder of parts.

use std::io;
use std::path::{Path, PathBuf};

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
    /// A folder that was begun before.
    #[error("{} holds the parts of {} task", folder.display(), if *same { "this" } else { "another" })]
    Begun {
        /// The folder.
        folder: PathBuf,
        /// Whether its plan is the one that was given.
        same: bool,
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
    #[error("{}", first_few(.0))]
    Damaged(Vec<(PathBuf, PartDefect)>),
    /// Parts or points that are not those of the plan.
    #[error("{0}")]
    NotOfThePlan(String),
    /// A request that cannot be met.
    #[error("{0}")]
    Refused(String),
}

/// Defect of a file with the name of a part.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PartDefect {
    /// It cannot be read.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// It is something else than a file.
    #[error("is {0}, not a file")]
    NotAFile(&'static str),
    /// The plan has no such part.
    #[error("the plan has no part of that name")]
    NotInThePlan,
    /// Nothing is in it.
    #[error("is empty")]
    Empty,
    /// It has no footer, or none of a part.
    #[error("is cut off, changed, or no part of bsm: its footer proves nothing")]
    Footer,
    /// A part of something else.
    #[error("is a part of another plan")]
    OtherPlan(
        /// The id of that plan.
        String,
    ),
    /// Another part of the plan.
    #[error("is a copy of part {0}")]
    OtherPart(String),
    /// The bytes before the footer are not those that the footer was made of.
    #[error("has been changed: its bytes do not have the SHA-256 of its footer")]
    Changed,
}

impl DatasetError {
    pub(super) fn io(doing: &'static str, path: &Path, error: io::Error) -> Self {
        Self::Io { doing, path: path.to_owned(), error }
    }
}

/// The first few of what is wrong.
fn first_few(damaged: &[(PathBuf, PartDefect)]) -> String {
    const SHOWN: usize = 3;
    let shown = damaged.iter().take(SHOWN).map(|(path, why)| format!("{} {why}", path.display()));
    let more = damaged.len().checked_sub(SHOWN).filter(|more| *more > 0);
    shown.chain(more.map(|more| format!("and {more} more"))).collect::<Vec<_>>().join("; ")
}
