//! What can be wrong with a table.

use std::io;

use bsm_case::brief;

/// A table that cannot be read or written as a whole; a row that is wrong is a row with a status.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// The file or the disk.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// A line with another number of cells than the first.
    #[error("line {line} has {found} cells, but the table has {columns} columns")]
    Ragged {
        /// Number of the line, from 1.
        line: u64,
        /// Cells of the line.
        found: usize,
        /// Columns of the table.
        columns: usize,
    },
    /// A line without a row before the last row.
    #[error(
        "line {line} is blank; a row is one line, so write an empty cell as \"\" or remove the line"
    )]
    BlankLine {
        /// Number of the line, from 1.
        line: u64,
    },
    /// A quoted cell without its second quote.
    #[error(
        "line {line}: a quoted cell does not end on its line; close the quote, or take the \
        line break out of the cell"
    )]
    OpenQuote {
        /// Number of the line, from 1.
        line: u64,
    },
    /// A quote in a cell that is not in quotes, or after the quote that ends it.
    #[error(
        "line {line}: a quote inside a cell; put the whole cell in quotes and double \
        those in it, or take the quotes out"
    )]
    StrayQuote {
        /// Number of the line, from 1.
        line: u64,
    },
    /// A byte of zero, which is no text.
    #[error("line {line} has a NUL byte; save the table as UTF-8 text")]
    Nul {
        /// Number of the line, from 1.
        line: u64,
    },
    /// A line that is not UTF-8.
    #[error("line {line} is not UTF-8 text; save the table as UTF-8")]
    NotUtf8 {
        /// Number of the line, from 1.
        line: u64,
    },
    /// A line that does not end.
    #[error("line {line} is longer than {} MiB; is an end of line missing?", most >> 20)]
    LongLine {
        /// Number of the line, from 1.
        line: u64,
        /// Bytes that a line may have.
        most: usize,
    },
    /// Cells that are separated by something else.
    #[error("the names of the columns are separated by `{}`, but cells are expected to be separated by `{}`",
        found.escape_debug(), expected.escape_debug())]
    Separator {
        /// By what.
        found: char,
        /// By what they should be.
        expected: char,
    },
    /// A line is no JSON object, or not one like the first.
    #[error("line {line}: {reason}")]
    Json {
        /// Number of the line, from 1.
        line: u64,
        /// Why.
        reason: String,
    },
    /// Not Parquet, or cut off.
    #[error("not a Parquet table: {0}")]
    Parquet(String),
    /// Parquet of a kind that is not read.
    #[error(
        "the Parquet table is written with {0}, which is not read here; write it without \
        encryption, and with Snappy, Zstandard, gzip, LZ4 or no compression"
    )]
    Unread(String),
    /// A Parquet table with fewer or more rows than it says.
    #[error("the table announces {announced} rows, but holds {found}; it is damaged")]
    LostRows {
        /// Rows by its footer.
        announced: u64,
        /// Rows that were read.
        found: u64,
    },
    /// A column to keep that holds lists, maps or structures.
    #[error(
        "the cells of column `{}` are lists, maps or structures, which cannot be copied; \
        leave it out, or take it apart",
        brief(name)
    )]
    NotText {
        /// Its name.
        name: String,
    },
    /// A column that is no input.
    #[error("column `{}` is not an input{}", brief(name), meant(nearest.as_deref()))]
    UnknownColumn {
        /// Its name.
        name: String,
        /// The nearest known input.
        nearest: Option<String>,
    },
    /// A column stands twice, or an input in two units.
    #[error("{}", twice(names))]
    RepeatedColumn {
        /// Both names.
        names: [String; 2],
    },
    /// A column to keep has the name of a column of the answers.
    #[error(
        "column `{}` cannot be kept: the results have a column of that name; rename yours",
        brief(name)
    )]
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
    #[error("no output is named `{}`{}", brief(name), meant(*nearest))]
    UnknownOutput {
        /// The name.
        name: String,
        /// The nearest known output.
        nearest: Option<&'static str>,
    },
    /// A column to keep that the table does not have.
    #[error("the table has no column `{}` to keep", brief(name))]
    NothingToKeep {
        /// The name.
        name: String,
    },
    /// A column to rename that the table does not have.
    #[error("the table has no column `{}` to rename", brief(name))]
    NothingToRename {
        /// The name.
        name: String,
    },
    /// The table has no row of column names.
    #[error("the table is empty: the first row must name the columns")]
    NoHeader,
}

fn meant(nearest: Option<&str>) -> String {
    nearest.map_or_else(String::new, |name| format!("; did you mean `{name}`?"))
}

fn twice([one, other]: &[String; 2]) -> String {
    if one == other {
        format!("column `{}` appears twice", brief(one))
    } else {
        format!(
            "columns `{}` and `{}` are the same input; leave one of them out",
            brief(one),
            brief(other)
        )
    }
}

impl From<parquet::errors::ParquetError> for TableError {
    fn from(error: parquet::errors::ParquetError) -> Self {
        use parquet::errors::ParquetError;
        match error {
            ParquetError::External(inner) => match inner.downcast::<io::Error>() {
                Ok(io) => Self::Io(*io),
                Err(other) => Self::Parquet(other.to_string()),
            },
            ParquetError::General(text) if text.contains("encrypted footer") => {
                Self::Unread("encryption".to_owned())
            }
            ParquetError::General(text) => Self::Parquet(text),
            ParquetError::NYI(text) => Self::Unread(format!("something else ({text})")),
            other => Self::Parquet(other.to_string()),
        }
    }
}

impl From<arrow_schema::ArrowError> for TableError {
    fn from(error: arrow_schema::ArrowError) -> Self {
        match error {
            // What the parquet crate says comes as text.
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
