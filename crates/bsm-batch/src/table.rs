//! Tables by the ending of their names.

use std::fs::File;
use std::io::{BufReader, Read, Write};
use std::path::Path;

use bsm_case::Output;

use crate::parquet_table::finish_with;
use crate::rows::{Answers, Chunk, Columns};
use crate::{
    CsvSink, CsvSource, Dialect, JsonSink, JsonSource, ParquetSink, ParquetSource, Sink, Source,
    TableError,
};

/// Key of the metadata of a Parquet table that says what the table is made from, in JSON.
pub const ABOUT: &str = "bsm";

/// Forms of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Text with commas.
    Csv,
    /// One JSON object a line.
    JsonLines,
    /// Columns in binary.
    Parquet,
}

impl Format {
    /// By the ending of the name.
    pub fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        match ending.as_str() {
            "csv" => Some(Self::Csv),
            "jsonl" | "ndjson" => Some(Self::JsonLines),
            "parquet" => Some(Self::Parquet),
            _ => None,
        }
    }

    /// The rows of a file of this form.
    ///
    /// # Errors
    ///
    /// [`TableError`] if it cannot be opened, or its columns are neither inputs nor in `keep`.
    pub fn open(self, path: &Path, keep: &[String]) -> Result<Box<dyn Source>, TableError> {
        self.open_as(path, keep, &Dialect::default())
    }

    /// [`open`](Self::open) for a table with other signs, which only text has, or names.
    ///
    /// # Errors
    ///
    /// As [`open`](Self::open).
    pub fn open_as(
        self,
        path: &Path,
        keep: &[String],
        dialect: &Dialect,
    ) -> Result<Box<dyn Source>, TableError> {
        let file = File::open(path)?;
        Ok(match self {
            Self::Csv => {
                let reader: Box<dyn Read + Send> = Box::new(file);
                Box::new(CsvSource::with(reader, keep, dialect)?)
            }
            Self::JsonLines => Box::new(JsonSource::with(BufReader::new(file), keep, dialect)?),
            Self::Parquet => Box::new(ParquetSource::with(file, keep, dialect)?),
        })
    }
}

/// A table of answers, in one of the forms.
pub enum TableSink<W: Write + Send> {
    /// Text with commas.
    Csv(CsvSink<W>),
    /// One JSON object a line.
    Json(JsonSink<W>),
    /// Columns in binary.
    Parquet(Box<ParquetSink<W>>),
}

impl<W: Write + Send> TableSink<W> {
    /// Writes the names of the columns.
    ///
    /// # Errors
    ///
    /// [`TableError`].
    pub fn new(
        format: Format,
        out: W,
        columns: &Columns,
        outputs: &[&'static Output],
    ) -> Result<Self, TableError> {
        Ok(match format {
            Format::Csv => Self::Csv(CsvSink::new(out, columns, outputs)?),
            Format::JsonLines => Self::Json(JsonSink::new(out, columns.clone(), outputs)),
            Format::Parquet => Self::Parquet(Box::new(ParquetSink::new(out, columns, outputs)?)),
        })
    }

    /// Writes the end of the table, and returns the writer.
    ///
    /// * `about`: what the table is made from, for the metadata of Parquet under [`ABOUT`].
    ///
    /// # Errors
    ///
    /// [`TableError`].
    pub fn finish(self, about: Option<&str>) -> Result<W, TableError> {
        match self {
            Self::Csv(sink) => sink.finish(),
            Self::Json(sink) => Ok(sink.finish()),
            Self::Parquet(sink) => {
                let about = about.map(|text| (ABOUT, text.to_owned()));
                finish_with(sink.into_file()?, |_| about.into_iter().collect())
            }
        }
    }
}

impl<W: Write + Send> Sink for TableSink<W> {
    fn write(&mut self, chunk: Chunk, answers: Answers) -> Result<(), TableError> {
        match self {
            Self::Csv(sink) => sink.write(chunk, answers),
            Self::Json(sink) => sink.write(chunk, answers),
            Self::Parquet(sink) => sink.write(chunk, answers),
        }
    }
}
