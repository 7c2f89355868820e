//! What can be wrong with a table.

use std::io;

/// A table that cannot be read or written as a whole; a row that is wrong is a row with a status.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// The file or the disk.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// Not CSV, or rows of different lengths.
    #[error("not a CSV table: {0}")]
    Csv(csv::Error),
    /// A line is no JSON object.
    #[error("row {row}: not a JSON object: {reason}")]
    Json {
        /// Number of the row, from 1.
        row: u64,
        /// Why.
        reason: String,
    },
    /// Not Parquet, or cut off.
    #[error("not a Parquet table: {0}")]
    Parquet(String),
    /// A column that is no input.
    #[error("column `{name}` is no input{}; leave it out, or carry it through with --keep {name}",
        nearest.as_ref().map_or_else(String::new, |n| format!(", did you mean `{n}`?")))]
    UnknownColumn {
        /// Its name.
        name: String,
        /// The nearest known input.
        nearest: Option<String>,
    },
    /// A column stands twice.
    #[error("column `{name}` stands twice")]
    RepeatedColumn {
        /// Its name.
        name: String,
    },
    /// A column to keep has the name of a column of the answers.
    #[error("--keep {name}: the answers have a column of that name; rename yours")]
    NameOfAnAnswer {
        /// The name.
        name: String,
    },
    /// A column has values that are no numbers.
    #[error("column `{name}` holds {found}, but must hold numbers")]
    NotNumbers {
        /// Its name.
        name: String,
        /// The type.
        found: String,
    },
    /// An output that does not exist.
    #[error("no output is named `{name}`; `bsm schema output` lists them")]
    UnknownOutput {
        /// The name.
        name: String,
    },
    /// A column to keep that the table does not have.
    #[error("--keep {name}: the table has no such column")]
    NothingToKeep {
        /// The name.
        name: String,
    },
    /// The table has no row of column names.
    #[error("the table is empty: the first row must name the columns")]
    NoHeader,
}

impl From<csv::Error> for TableError {
    fn from(error: csv::Error) -> Self {
        match error.kind() {
            csv::ErrorKind::Io(_) => match error.into_kind() {
                csv::ErrorKind::Io(io) => Self::Io(io),
                _ => unreachable!("the kind was asked"),
            },
            _ => Self::Csv(error),
        }
    }
}

impl From<parquet::errors::ParquetError> for TableError {
    fn from(error: parquet::errors::ParquetError) -> Self {
        Self::Parquet(error.to_string())
    }
}

impl From<arrow_schema::ArrowError> for TableError {
    fn from(error: arrow_schema::ArrowError) -> Self {
        Self::Parquet(error.to_string())
    }
}
