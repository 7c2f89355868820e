//! Errors in a table as a whole.

use std::io;

use bsm_case::{OtherSeparator, TextError, brief};

/// Reason why a table cannot be read or written. An invalid row does not cause this error, but is
/// reported in the status of the row.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// The file cannot be read or written.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The first line of a CSV table uses an unexpected separator.
    #[error(transparent)]
    Separator(#[from] OtherSeparator),
    /// The file is not a Parquet file or is incomplete.
    #[error("not a Parquet table: {0}")]
    Parquet(String),
    /// Some columns of the table are not inputs.
    #[error("{}", match &names[..] {
        [one] => format!("column `{}` is not an input{}", brief(&one.name), meant(one.nearest)),
        several => format!("columns {} are not inputs", all_of(several)),
    })]
    UnknownColumns {
        /// Unknown column names, at least one and at most [`NAMED`](UnknownName::NAMED).
        names: Vec<UnknownName>,
    },
    /// Some requested outputs do not exist.
    #[error("{}", match &names[..] {
        [one] => format!("no output is named `{}`{}", brief(&one.name), meant(one.nearest)),
        several => format!("no outputs are named {}", all_of(several)),
    })]
    UnknownOutputs {
        /// Unknown output names, at least one.
        names: Vec<UnknownName>,
    },
    /// A column cannot be used for a reason that no other variant describes.
    #[error("{message}")]
    Column {
        /// Name of the column.
        name: String,
        /// Reason why the column cannot be used, including its name.
        message: String,
    },
    /// The lines or rows do not form a table.
    #[error("{0}")]
    Malformed(String),
}

/// An unknown name, with the known name that the user may have intended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnknownName {
    /// The unknown name as it was given.
    pub name: String,
    /// The known name that is most similar to the unknown name.
    pub nearest: Option<&'static str>,
}

impl UnknownName {
    /// Maximum number of unknown names that a message lists.
    pub const NAMED: usize = 8;
}

/// Formats unknown names as a list, each with the most similar known name.
fn all_of(names: &[UnknownName]) -> String {
    let one = |unknown: &UnknownName| {
        let near = unknown.nearest.map(|near| format!(" (did you mean `{near}`?)"));
        format!("`{}`{}", brief(&unknown.name), near.unwrap_or_default())
    };
    names.iter().map(one).collect::<Vec<_>>().join(", ")
}

impl TableError {
    /// Returns the error for a table without a header row.
    pub(crate) fn no_header() -> Self {
        Self::Malformed(
            "the table is empty; the first row must contain the names of the columns".to_owned(),
        )
    }

    /// Returns the error for a column with lists, maps or structures, which cannot be copied to the
    /// results.
    pub fn nested_column(name: &str) -> Self {
        let message = format!(
            "the cells of column `{}` are lists, maps or structures, which cannot be copied; omit the column, or split \
             it",
            brief(name)
        );
        Self::Column { name: name.to_owned(), message }
    }

    /// Returns the error for a table that uses an unsupported Parquet feature.
    #[cfg(feature = "parquet")]
    pub(crate) fn unsupported(kind: &str) -> Self {
        Self::Malformed(format!(
            "the Parquet table uses {kind}, which is not supported; write it without encryption, and with \
             Snappy, Zstandard, gzip, LZ4 or no compression"
        ))
    }

    /// Returns the error for a column name that appears twice, or for two columns with the same
    /// input.
    pub(crate) fn repeated(one: &str, other: &str) -> Self {
        let [first, second] = [one, other].map(brief);
        let message = if one == other {
            format!("column `{first}` appears twice")
        } else {
            format!("columns `{first}` and `{second}` are the same input; remove one of them")
        };
        Self::Column { name: other.to_owned(), message }
    }
}

fn meant(nearest: Option<&str>) -> String {
    nearest.map_or_else(String::new, |name| format!("; did you mean `{name}`?"))
}

impl From<TextError> for TableError {
    fn from(error: TextError) -> Self {
        match error {
            TextError::Io(error) => Self::Io(error),
            TextError::Malformed(text) => Self::Malformed(text),
        }
    }
}

#[cfg(feature = "parquet")]
impl From<parquet::errors::ParquetError> for TableError {
    fn from(error: parquet::errors::ParquetError) -> Self {
        use parquet::errors::ParquetError;
        match error {
            ParquetError::External(inner) => match inner.downcast::<io::Error>() {
                Ok(io) => Self::Io(*io),
                Err(other) => Self::Parquet(other.to_string()),
            },
            ParquetError::General(text) if text.contains("encrypted footer") => {
                Self::unsupported("encryption")
            }
            ParquetError::General(text) => Self::Parquet(text),
            ParquetError::NYI(text) => Self::unsupported(&format!("another feature ({text})")),
            other => Self::Parquet(other.to_string()),
        }
    }
}

impl From<arrow_schema::ArrowError> for TableError {
    fn from(error: arrow_schema::ArrowError) -> Self {
        match error {
            // The parquet crate reports its errors only as text, which begins with the kind of the
            // error.
            arrow_schema::ArrowError::ParquetError(text) => {
                let text = ["Parquet error: ", "External: "]
                    .iter()
                    .find_map(|kind| text.strip_prefix(kind))
                    .unwrap_or(&text);
                Self::Parquet(text.to_owned())
            }
            other => Self::Parquet(other.to_string()),
        }
    }
}
