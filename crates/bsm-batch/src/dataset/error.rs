//! Errors that occur when a dataset is created, continued or finished.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::TableError;

/// Reason why a dataset cannot be created, continued or finished.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DatasetError {
    /// An operation on a file or folder failed.
    #[error("cannot {doing} {}: {error}", path.display())]
    Io {
        /// Failed operation, in the form that follows "cannot", such as "write".
        doing: &'static str,
        /// Path of the file or folder.
        path: PathBuf,
        /// Error of the operating system.
        error: io::Error,
    },
    /// The points of the dataset cannot be read.
    #[error(transparent)]
    Read(TableError),
    /// A part file cannot be written.
    #[error("cannot write {}: {error}", path.display())]
    Write {
        /// Path of the part file.
        path: PathBuf,
        /// Reason why the part file cannot be written.
        error: TableError,
    },
    /// The operating system did not start a thread.
    #[error("cannot start a thread: {0}")]
    Thread(io::Error),
    /// The stop flag of the workers became true.
    #[error("stopped")]
    Stopped,
    /// The folder already contains the plan of an earlier run.
    #[error("{} holds the parts of {} task", folder.display(), if *same { "this" } else { "another" })]
    AlreadyExists {
        /// Path of the dataset folder.
        folder: PathBuf,
        /// True if the plan in the folder equals the plan of the new run.
        same: bool,
    },
    /// The file `plan.json` does not contain a valid plan.
    #[error("{} is not the plan of this task: {why}", path.display())]
    NotAPlan {
        /// Path of the plan file.
        path: PathBuf,
        /// Reason why the plan is invalid.
        why: String,
    },
    /// Some part files are damaged or do not belong to the plan.
    #[error("{}", describe_damage(.0))]
    Damaged(Vec<(PathBuf, PartDefect)>),
    /// The part files or the points do not belong to the plan in the folder.
    #[error("{0}")]
    NotOfThePlan(String),
    /// The program refuses to calculate the dataset as requested; the text states the reason.
    #[error("{0}")]
    Refused(String),
}

/// Reason why a file with the name of a part is not a valid part.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PartDefect {
    /// The part file cannot be read.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The entry is not a file but, for example, a folder.
    #[error("is {0}, not a file")]
    NotAFile(&'static str),
    /// The plan contains no part with this file name.
    #[error("the plan has no part with this name")]
    NotInThePlan,
    /// The part file is empty.
    #[error("is empty")]
    Empty,
    /// The file does not end with the valid footer of a part.
    #[error("has an invalid footer: it is truncated, changed, or not a part file of bsm")]
    Footer,
    /// The file is a part of another plan.
    #[error("is a part of another plan")]
    OtherPlan(
        /// Id of the plan to which the part file belongs.
        String,
    ),
    /// The file is a copy of another part of the same plan. The field contains the number of the
    /// other part.
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

/// Describes the first few damaged files in one line of text.
fn describe_damage(damaged: &[(PathBuf, PartDefect)]) -> String {
    const SHOWN: usize = 3;
    let shown = damaged.iter().take(SHOWN).map(|(path, why)| format!("{} {why}", path.display()));
    let more = damaged.len().checked_sub(SHOWN).filter(|more| *more > 0);
    shown.chain(more.map(|more| format!("and {more} more"))).collect::<Vec<_>>().join("; ")
}

/// Returns a description of an entry that is not a file, such as "a folder".
pub(super) fn describe_entry(found: &fs::Metadata) -> &'static str {
    if found.is_dir() {
        "a folder"
    } else if found.is_symlink() {
        "a link"
    } else {
        "a pipe or a device"
    }
}
