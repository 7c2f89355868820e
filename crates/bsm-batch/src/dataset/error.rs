//! Errors of a folder of parts.

use std::io;
use std::path::{Path, PathBuf};

use crate::TableError;

/// The reason why a folder cannot be created, continued or finished.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DatasetError {
    /// Error of the disk.
    #[error("cannot {doing} {}: {error}", path.display())]
    Io {
        /// The operation.
        doing: &'static str,
        /// The file or folder.
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
        /// The reason.
        error: TableError,
    },
    /// A thread cannot be started.
    #[error("cannot start a thread: {0}")]
    Thread(io::Error),
    /// The run was stopped.
    #[error("stopped")]
    Stopped,
    /// The folder contains a run that was begun before.
    #[error("{} holds the parts of {} task", folder.display(), if *same { "this" } else { "another" })]
    Begun {
        /// The folder.
        folder: PathBuf,
        /// True if the plan of the folder is the given plan.
        same: bool,
    },
    /// The file in place of the plan is not a plan.
    #[error("{} is not the plan of this task: {why}", path.display())]
    NotAPlan {
        /// The file.
        path: PathBuf,
        /// The reason.
        why: String,
    },
    /// A file in place of a part does not belong to this plan.
    #[error("{}", first_few(.0))]
    Damaged(Vec<(PathBuf, PartDefect)>),
    /// Parts or points do not belong to the plan.
    #[error("{0}")]
    NotOfThePlan(String),
    /// The request cannot be fulfilled.
    #[error("{0}")]
    Refused(String),
}

/// Defect of a file that has the name of a part.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PartDefect {
    /// The file cannot be read.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The entry is not a file.
    #[error("is {0}, not a file")]
    NotAFile(&'static str),
    /// The plan has no such part.
    #[error("the plan has no part with this name")]
    NotInThePlan,
    /// The file is empty.
    #[error("is empty")]
    Empty,
    /// The file has no footer, or its footer is not the footer of a part.
    #[error("is truncated, changed, or not a part of bsm, because its footer is invalid")]
    Footer,
    /// The file is a part of another plan.
    #[error("is a part of another plan")]
    OtherPlan(
        /// The id of the other plan.
        String,
    ),
    /// The file is another part of the plan.
    #[error("is a copy of part {0}")]
    OtherPart(String),
    /// The bytes before the footer do not agree with the hash in the footer.
    #[error("has been changed, because its bytes do not match the SHA-256 of its footer")]
    Changed,
}

impl DatasetError {
    pub(super) fn io(doing: &'static str, path: &Path, error: io::Error) -> Self {
        Self::Io { doing, path: path.to_owned(), error }
    }
}

/// Lists the first few defects.
fn first_few(damaged: &[(PathBuf, PartDefect)]) -> String {
    const SHOWN: usize = 3;
    let shown = damaged.iter().take(SHOWN).map(|(path, why)| format!("{} {why}", path.display()));
    let more = damaged.len().checked_sub(SHOWN).filter(|more| *more > 0);
    shown.chain(more.map(|more| format!("and {more} more"))).collect::<Vec<_>>().join("; ")
}
