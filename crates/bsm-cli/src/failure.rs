//! How a command can fail, and the exit code of each.

use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use bsm_case::CaseError;
use bsm_validate::ValidateError;
use thiserror::Error;

#[derive(Debug, Error)]
pub(crate) enum Failure {
    /// Bad input or usage.
    #[error("{0}")]
    Input(String),
    /// A file or disk problem.
    #[error("{0}")]
    Files(String),
    /// Ran, but a point has no solution or a check failed; the words are printed already.
    #[error("unsolved")]
    Unsolved,
    /// A table of points that cannot be read on.
    #[error("{0}")]
    Table(String),
    /// The user has interrupted the work; nothing unfinished is left under a final name.
    #[error("interrupted; nothing unfinished was kept (a folder goes on with --resume)")]
    Interrupted,
    /// The reader of standard output has gone: nothing is left to do.
    #[error("closed pipe")]
    ClosedPipe,
}

impl Failure {
    /// A complaint about a scene, with its file in front.
    pub(crate) fn scene(path: &Path, error: &CaseError) -> Self {
        if error.is_io() {
            return Self::Files(error.to_string());
        }
        Self::in_scene(path, &error.to_string())
    }

    /// Bad input with its file in front.
    pub(crate) fn in_scene(path: &Path, text: &str) -> Self {
        let name = if path.as_os_str() == "-" {
            "standard input".to_owned()
        } else {
            path.display().to_string()
        };
        Self::Input(format!("{name}: {text}"))
    }

    /// What was being done, to what, and what the system said.
    pub(crate) fn files(doing: &str, path: &Path, error: &io::Error) -> Self {
        Self::Files(format!("cannot {doing} {}: {error}", path.display()))
    }

    /// Prints the failure to standard error.
    pub(crate) fn report(&self) -> ExitCode {
        let code = match self {
            Self::ClosedPipe => return ExitCode::SUCCESS,
            Self::Unsolved => return ExitCode::from(3),
            Self::Files(_) => 1,
            Self::Input(_) | Self::Table(_) => 2,
            Self::Interrupted => 130,
        };
        warn("error", &self.to_string());
        ExitCode::from(code)
    }
}

impl From<ValidateError> for Failure {
    fn from(error: ValidateError) -> Self {
        match error {
            ValidateError::File { .. } | ValidateError::Page(_) | ValidateError::Threads(_) => {
                Self::Files(error.to_string())
            }
            ValidateError::NoReference => {
                warn("error", &error.to_string());
                Self::Unsolved
            }
            _ => Self::Input(error.to_string()),
        }
    }
}

/// One paragraph to standard error; nobody is left to tell if that fails.
pub(crate) fn warn(kind: &str, text: &str) {
    let _ = writeln!(io::stderr(), "{kind}: {text}");
}
