//! Tables by the ending of their names.

use std::fs::File;
use std::io::{BufReader, Read, Write};
use std::path::Path;

use bsm_case::Output;

use crate::rows::{Answers, Chunk, Columns};
use crate::{
    CsvSink, CsvSource, JsonSink, JsonSource, ParquetSink, ParquetSource, Sink, Source, TableError,
};

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
        let file = File::open(path)?;
        Ok(match self {
            Self::Csv => {
                let reader: Box<dyn Read + Send> = Box::new(file);
                Box::new(CsvSource::new(reader, keep)?)
            }
            Self::JsonLines => Box::new(JsonSource::new(BufReader::new(file), keep)?),
            Self::Parquet => Box::new(ParquetSource::new(file, keep)?),
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
    /// # Errors
    ///
    /// [`TableError`].
    pub fn finish(self) -> Result<W, TableError> {
        match self {
            Self::Csv(sink) => sink.finish(),
            Self::Json(sink) => Ok(sink.finish()),
            Self::Parquet(sink) => sink.finish(),
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
