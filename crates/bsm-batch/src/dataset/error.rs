//! Errors of dataset folders.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::TableError;

/// The reason why a dataset cannot be created, continued or finished.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DatasetError {
    /// A file operation failed.
    #[error("cannot {doing} {}: {error}", path.display())]
    Io {
        /// The operation that failed.
        doing: &'static str,
        /// Path of the file or folder.
        path: PathBuf,
        /// Error of the operating system.
        error: io::Error,
    },
    /// The points cannot be read.
    #[error(transparent)]
    Read(TableError),
    /// A part file cannot be written.
    #[error("cannot write {}: {error}", path.display())]
    Write {
        /// The part file.
        path: PathBuf,
        /// The reason why the part cannot be written.
        error: TableError,
    },
    /// A thread cannot be started.
    #[error("cannot start a thread: {0}")]
    Thread(io::Error),
    /// The run was stopped.
    #[error("stopped")]
    Stopped,
    /// The folder already contains the plan of an earlier run.
    #[error("{} holds the parts of {} task", folder.display(), if *same { "this" } else { "another" })]
    Begun {
        /// The dataset folder.
        folder: PathBuf,
        /// True if the plan in the folder is identical to the given plan.
        same: bool,
    },
    /// The plan file does not contain a valid plan.
    #[error("{} is not the plan of this task: {why}", path.display())]
    NotAPlan {
        /// The plan file.
        path: PathBuf,
        /// The reason why the plan is invalid.
        why: String,
    },
    /// Some part files are damaged or do not belong to this plan.
    #[error("{}", first_few(.0))]
    Damaged(Vec<(PathBuf, PartDefect)>),
    /// Some parts or points do not belong to the plan.
    #[error("{0}")]
    NotOfThePlan(String),
    /// The request cannot be carried out.
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
    /// The entry is a folder or another entry that is not a file.
    #[error("is {0}, not a file")]
    NotAFile(&'static str),
    /// The plan contains no part with this file name.
    #[error("the plan has no part with this name")]
    NotInThePlan,
    /// The file is empty.
    #[error("is empty")]
    Empty,
    /// The file has no valid footer of a part.
    #[error("has an invalid footer: it is truncated, changed, or not a part file of bsm")]
    Footer,
    /// The file is a part of another plan.
    #[error("is a part of another plan")]
    OtherPlan(
        /// The id of the other plan.
        String,
    ),
    /// The file is a copy of another part of the same plan.
    #[error("is a copy of part {0}")]
    OtherPart(String),
    /// The bytes before the footer do not match the hash in the footer.
    #[error("has been changed: its bytes do not match the SHA-256 in its footer")]
    Changed,
}

impl DatasetError {
    pub(super) fn io(doing: &'static str, path: &Path, error: io::Error) -> Self {
        Self::Io { doing, path: path.to_owned(), error }
    }
}

/// Lists the first few damaged files.
fn first_few(damaged: &[(PathBuf, PartDefect)]) -> String {
    const SHOWN: usize = 3;
    let shown = damaged.iter().take(SHOWN).map(|(path, why)| format!("{} {why}", path.display()));
    let more = damaged.len().checked_sub(SHOWN).filter(|more| *more > 0);
    shown.chain(more.map(|more| format!("and {more} more"))).collect::<Vec<_>>().join("; ")
}

/// Returns a description of an entry that is not a file, such as "a folder".
pub(super) fn kind(found: &fs::Metadata) -> &'static str {
    if found.is_dir() {
        "a folder"
    } else if found.is_symlink() {
        "a link"
    } else {
        "a pipe or a device"
    }
}
