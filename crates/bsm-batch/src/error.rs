//! Errors of tables.

use std::io;

use bsm_case::{TextError, brief};

/// The reason why a whole table cannot be read or written. An invalid row is not an error, but a
/// row with a status.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// Error of the file or the disk.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The cells are separated by an unexpected character.
    #[error("the names of the columns are separated by `{}`, but cells are expected to be separated by `{}`",
        found.escape_debug(), expected.escape_debug())]
    Separator {
        /// The character found.
        found: char,
        /// The expected character.
        expected: char,
    },
    /// The file is not a Parquet file, or it is incomplete.
    #[error("not a Parquet table: {0}")]
    Parquet(String),
    /// Some columns are not inputs.
    #[error("{}", match &names[..] {
        [one] => format!("column `{}` is not an input{}", brief(&one.name), meant(one.nearest)),
        several => format!("columns {} are not inputs", all_of(several)),
    })]
    UnknownColumns {
        /// The names, at least one and at most [`NAMED`](UnknownName::NAMED).
        names: Vec<UnknownName>,
    },
    /// Some outputs do not exist.
    #[error("{}", match &names[..] {
        [one] => format!("no output is named `{}`{}", brief(&one.name), meant(one.nearest)),
        several => format!("no outputs are named {}", all_of(several)),
    })]
    UnknownOutputs {
        /// The names, at least one.
        names: Vec<UnknownName>,
    },
    /// Another column cannot be used.
    #[error("{message}")]
    Column {
        /// Name of the column.
        name: String,
        /// The reason, including the name.
        message: String,
    },
    /// The lines or rows are not a table.
    #[error("{0}")]
    Malformed(String),
}

/// An unknown name with a suggestion.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnknownName {
    /// The name.
    pub name: String,
    /// The most similar known name.
    pub nearest: Option<&'static str>,
}

impl UnknownName {
    /// Maximum number of names in a message.
    pub const NAMED: usize = 8;
}

/// Formats names as a list, each with the most similar known name.
fn all_of(names: &[UnknownName]) -> String {
    let one = |unknown: &UnknownName| {
        let near = unknown.nearest.map(|near| format!(" (did you mean `{near}`?)"));
        format!("`{}`{}", brief(&unknown.name), near.unwrap_or_default())
    };
    names.iter().map(one).collect::<Vec<_>>().join(", ")
}

impl TableError {
    /// Reports that the table has no row with column names.
    pub(crate) fn no_header() -> Self {
        Self::Malformed(
            "the table is empty; the first row must contain the names of the columns".to_owned(),
        )
    }

    /// Reports that a copied column contains lists, maps or structures.
    pub fn not_text(name: &str) -> Self {
        let message = format!(
            "the cells of column `{}` are lists, maps or structures, which cannot be copied; leave it out, or take it \
             apart",
            brief(name)
        );
        Self::Column { name: name.to_owned(), message }
    }

    /// Reports that the kind of Parquet file is not supported.
    #[cfg(feature = "parquet")]
    pub(crate) fn unread(kind: &str) -> Self {
        Self::Malformed(format!(
            "the Parquet table is written with {kind}, which is not read here; write it without encryption, and with \
             Snappy, Zstandard, gzip, LZ4 or no compression"
        ))
    }

    /// Reports that a column appears twice, or an input in two units.
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
                Self::unread("encryption")
            }
            ParquetError::General(text) => Self::Parquet(text),
            ParquetError::NYI(text) => Self::unread(&format!("something else ({text})")),
            other => Self::Parquet(other.to_string()),
        }
    }
}

impl From<arrow_schema::ArrowError> for TableError {
    fn from(error: arrow_schema::ArrowError) -> Self {
        match error {
            // The parquet crate states its errors as text.
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
