//! Failures of a command, with their exit codes.

use std::fmt::Display;
use std::io;
use std::path::Path;
use std::process::ExitCode;

use bsm_batch::TableError;
use bsm_case::{CaseError, InputSet, NameKind, OtherSeparator, brief};
use bsm_report::ReportError;
#[cfg(feature = "validate")]
use bsm_validate::ValidateError;
use thiserror::Error;

use crate::console::print_message;

/// Reason why a command failed.
#[derive(Debug, Error)]
pub(crate) enum Failure {
    /// The input or the command line is invalid.
    #[error("{0}")]
    Input(String),
    /// A file or disk operation failed.
    #[error("{0}")]
    Files(String),
    /// The command ran to completion, but a point has no solution or a check failed. The
    /// corresponding message has already been printed.
    #[error("unsolved")]
    Unsolved,
    /// Existing output differs from the expected output, a fit failed, or the temperatures of an
    /// axis have no steady state.
    #[error("{0}")]
    Check(String),
    /// A table of points contains an error.
    #[error("{}", table_error_text(.0))]
    Table(#[from] TableError),
    /// The program that reads standard output has closed the pipe, so this program ends.
    #[error("closed pipe")]
    ClosedPipe,
}

impl Failure {
    /// Reports an error in a case. The message begins with the name of the case file.
    pub(crate) fn case(path: &Path, error: &CaseError) -> Self {
        if error.is_io() {
            return Self::Files(error.to_string());
        }
        if let CaseError::NoWarmState(_) = error {
            return Self::Check(error.to_string());
        }
        Self::in_case(path, &input_error_text(error))
    }

    /// Reports an error in an option or a file. The message begins with `of`, the name of the
    /// option or file.
    pub(crate) fn input(of: impl Display, error: &CaseError) -> Self {
        Self::Input(format!("{of}: {}", input_error_text(error)))
    }

    /// Reports invalid input. The message begins with the name of the file.
    pub(crate) fn in_case(path: &Path, text: &str) -> Self {
        let name = if path.as_os_str() == "-" {
            "standard input".to_owned()
        } else {
            path.display().to_string()
        };
        Self::Input(format!("{name}: {text}"))
    }

    /// Reports that a table cannot be read, because of the file system or because of its contents.
    pub(crate) fn table(path: &Path, error: &TableError) -> Self {
        match error {
            TableError::Io(e) => Self::file_operation("read", path, e),
            other => Self::in_case(path, &table_error_text(other)),
        }
    }

    /// Reports a failed file operation with its path and the message of the operating system.
    pub(crate) fn file_operation(doing: &str, path: &Path, error: &io::Error) -> Self {
        let path = path.display();
        // The message omits the name of the temporary file, because users do not know this file.
        match error.get_ref().and_then(|inner| inner.source()) {
            Some(cause) => Self::Files(format!("cannot {doing} {path}: {cause}")),
            None => Self::Files(format!("cannot {doing} {path}: {error}")),
        }
    }

    /// Reports that the operating system refused to start another thread.
    pub(crate) fn no_thread(error: &io::Error) -> Self {
        Self::Files(format!(
            "cannot start a thread: {error}; raise the limits on processes and memory (ulimit -u, \
             ulimit -v), or use --threads 1"
        ))
    }

    /// Reports that this program was built without the feature that the command or the file needs.
    pub(crate) fn not_built(feature: &str) -> Self {
        Self::Input(format!(
            "this program was built without the feature `{feature}`; build bsm with this feature"
        ))
    }

    /// Prints the failure to standard error and returns the exit code.
    pub(crate) fn report(&self) -> ExitCode {
        let code = match self {
            Self::ClosedPipe => return ExitCode::SUCCESS,
            Self::Unsolved => return ExitCode::from(3),
            Self::Files(_) => 1,
            Self::Check(_) => 3,
            Self::Input(_) | Self::Table(_) => 2,
        };
        print_message("error", &self.to_string());
        ExitCode::from(code)
    }
}

/// Returns the message for an input error, followed by advice on a command or option.
pub(crate) fn input_error_text(error: &CaseError) -> String {
    fn help(error: &CaseError) -> &'static str {
        match error {
            CaseError::Unknown { kind, .. } => match kind {
                NameKind::Input => "`bsm schema input` lists all keys",
                NameKind::List => "`bsm select --show lists` prints all keys",
                NameKind::Column => "`bsm select --show columns` lists all columns",
                NameKind::TableColumn => {
                    "map your column names with --names MAP.json, a file such as {\"your name\": \"lead_mm\", \"other name\": null}"
                }
                NameKind::Requirement => "`bsm select --show keys` lists all keys",
                NameKind::Output => "`bsm schema output` lists all outputs",
            },
            CaseError::Separator(other) => delimiter_help(*other),
            CaseError::NoRange { .. } => "give a range with --input NAME=LOW:HIGH",
            CaseError::InRow { error, .. } => help(error),
            _ => "",
        }
    }
    with_help(&error.to_string(), help(error))
}

/// Returns advice on the options for reading a table with a different separator.
fn delimiter_help(other: OtherSeparator) -> &'static str {
    match other.found {
        ';' => "add --delimiter semicolon, and --decimal comma if numbers are written as 1,5",
        '\t' => "add --delimiter tab, and --decimal comma if numbers are written as 1,5",
        '|' => "add --delimiter bar, and --decimal comma if numbers are written as 1,5",
        _ => "add --delimiter comma",
    }
}

/// Appends advice to an error message. If the message ends with a question mark, the advice becomes
/// a separate sentence.
fn with_help(error: &str, help: &str) -> String {
    match help.chars().next() {
        None => error.to_owned(),
        Some(first) if error.ends_with('?') => {
            format!("{error} {}{}", first.to_uppercase(), &help[first.len_utf8()..])
        }
        Some(_) => format!("{error}; {help}"),
    }
}

/// Returns the message for a table error, followed by advice on a command or option.
pub(crate) fn table_error_text(error: &TableError) -> String {
    let help = match error {
        TableError::UnknownColumns { names } => {
            let it = if names.len() == 1 { "it" } else { "them" };
            let kept: Vec<_> = names.iter().map(|unknown| brief(&unknown.name)).collect();
            let kept = kept.join(",");
            format!(
                "remove {it}, copy {it} to the output with --keep {kept}, or map names with \
                 --names MAP.json, a file such as {{\"your name\": \"lead_mm\"}}",
            )
        }
        TableError::UnknownOutputs { .. } => "`bsm schema output` lists all outputs".to_owned(),
        TableError::Separator(other) => delimiter_help(*other).to_owned(),
        _ => String::new(),
    };
    with_help(&error.to_string(), &help)
}

impl From<ReportError> for Failure {
    fn from(error: ReportError) -> Self {
        match error {
            ReportError::Case(_) | ReportError::Search(_) => Self::Input(error.to_string()),
            _ => Self::Files(error.to_string()),
        }
    }
}

#[cfg(feature = "validate")]
impl From<ValidateError> for Failure {
    fn from(error: ValidateError) -> Self {
        match error {
            ValidateError::Report(error) => error.into(),
            ValidateError::File { .. } | ValidateError::Threads(_) => {
                Self::Files(error.to_string())
            }
            ValidateError::NoReference => {
                print_message("error", &error.to_string());
                Self::Unsolved
            }
            _ => Self::Input(error.to_string()),
        }
    }
}

/// Prints a note about inputs of the case that no ball model uses.
pub(crate) fn note_unused(given: InputSet) {
    for note in given.unused_by_models() {
        print_message("note", &note);
    }
}
