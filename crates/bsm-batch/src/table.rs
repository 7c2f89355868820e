//! Reads and writes tables. The extension of the file name determines the file format.

use std::fs::File;
use std::io::{BufReader, Read, Write};
use std::path::Path;
use std::sync::Arc;

use arrow_array::{ArrayRef, RecordBatch, StringArray};
use arrow_schema::{DataType, Field, Schema, SchemaRef};
use bsm_case::{ColumnValues, Output};

use crate::columns::{Columns, field};
#[cfg(feature = "parquet")]
use crate::parquet_table::ParquetSink;
use crate::rows::{Answers, Chunk, numbers};
use crate::text::TextSink;
use crate::{AnswerSink, CsvSource, JsonSource, Source, TableError, TableFormat};

/// Key in the metadata of a Parquet table. Its value is JSON that describes how the table was
/// calculated.
pub const METADATA_KEY: &str = "bsm";

/// File format of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// A text file in which each line is a row, and separators divide a row into cells.
    Csv,
    /// A text file with one JSON object per line.
    JsonLines,
    /// A binary file that stores the values of each column together.
    #[cfg(feature = "parquet")]
    Parquet,
}

impl Format {
    /// Returns the format for the extension of a file name, or `None` if the extension is unknown.
    pub fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        match ending.as_str() {
            "csv" => Some(Self::Csv),
            "jsonl" | "ndjson" => Some(Self::JsonLines),
            #[cfg(feature = "parquet")]
            "parquet" => Some(Self::Parquet),
            _ => None,
        }
    }

    /// Opens a table of this format, and returns a source of its rows.
    ///
    /// * `table_format`: assignment of column names to inputs; for text files, also the separator
    ///   and the decimal sign.
    ///
    /// # Errors
    ///
    /// Returns [`TableError`] if the file cannot be opened, or if a column is neither an input nor
    /// in `keep`.
    pub fn open(
        self,
        path: &Path,
        keep: &[String],
        table_format: &TableFormat,
    ) -> Result<Box<dyn Source>, TableError> {
        let file = File::open(path)?;
        Ok(match self {
            Self::Csv => {
                let reader: Box<dyn Read + Send> = Box::new(file);
                Box::new(CsvSource::new(reader, keep, table_format)?)
            }
            Self::JsonLines => Box::new(JsonSource::new(BufReader::new(file), keep, table_format)?),
            #[cfg(feature = "parquet")]
            Self::Parquet => Box::new(crate::ParquetSource::new(file, keep, table_format)?),
        })
    }
}

/// Name, unit and type of a column in a table that does not contain solved points.
#[derive(Debug, Clone, Copy)]
pub struct ColumnHead<'a> {
    /// Column name.
    pub name: &'a str,
    /// Unit of the column as text.
    pub unit: &'a str,
    /// True if the column contains text instead of numbers.
    pub is_text: bool,
}

/// Writes a CSV, JSON Lines or Parquet table.
pub struct TableSink<W: Write + Send> {
    schema: SchemaRef,
    outputs: Vec<&'static Output>,
    encoder: Encoder<W>,
}

enum Encoder<W: Write + Send> {
    Text(TextSink<W>),
    #[cfg(feature = "parquet")]
    Parquet(Box<ParquetSink<W>>),
}

impl<W: Write + Send> TableSink<W> {
    /// Starts a table and writes its column names. The columns are the columns of the source,
    /// followed by model, status, message and the outputs.
    ///
    /// * `table_format`: separator and decimal sign of a CSV file.
    ///
    /// # Errors
    ///
    /// Returns [`TableError`] if the table cannot be written.
    pub fn new(
        format: Format,
        out: W,
        columns: &Columns,
        outputs: &[&'static Output],
        table_format: &TableFormat,
    ) -> Result<Self, TableError> {
        Self::with_schema(format, out, (columns.schema(outputs), outputs), table_format)
    }

    /// Starts a table like [`new`](Self::new), but with the names and units in `schema`.
    ///
    /// # Errors
    ///
    /// Returns [`TableError`] if the table cannot be written.
    pub fn with_schema(
        format: Format,
        out: W,
        (schema, outputs): (SchemaRef, &[&'static Output]),
        table_format: &TableFormat,
    ) -> Result<Self, TableError> {
        let this = Self::of_schema(format, out, schema, table_format)?;
        Ok(Self { outputs: outputs.to_vec(), ..this })
    }

    /// Starts a table with arbitrary columns, for rows that are not solved points.
    ///
    /// # Errors
    ///
    /// Returns [`TableError`] if the table cannot be written.
    pub fn of_columns<'a>(
        format: Format,
        out: W,
        heads: impl IntoIterator<Item = ColumnHead<'a>>,
        table_format: &TableFormat,
    ) -> Result<Self, TableError> {
        let fields = heads.into_iter().map(|ColumnHead { name, unit, is_text }| {
            if is_text { Field::new(name, DataType::Utf8, true) } else { field(name, unit) }
        });
        let schema = Arc::new(Schema::new(fields.collect::<Vec<_>>()));
        Self::of_schema(format, out, schema, table_format)
    }

    fn of_schema(
        format: Format,
        out: W,
        schema: SchemaRef,
        table_format: &TableFormat,
    ) -> Result<Self, TableError> {
        let encoder = match format {
            Format::Csv => Encoder::Text(TextSink::csv(out, &schema, table_format)?),
            Format::JsonLines => Encoder::Text(TextSink::json_lines(out, &schema)),
            #[cfg(feature = "parquet")]
            Format::Parquet => Encoder::Parquet(Box::new(ParquetSink::new(out, schema.clone())?)),
        };
        Ok(Self { schema, outputs: Vec::new(), encoder })
    }

    /// Writes rows. The values of each column are given as a list, and all lists have the same
    /// length.
    ///
    /// # Errors
    ///
    /// Returns [`TableError`] if the rows cannot be written.
    pub fn write_columns(&mut self, columns: Vec<ColumnValues>) -> Result<(), TableError> {
        let arrays = columns.into_iter().map(|values| match values {
            ColumnValues::Numbers(values) => Arc::new(numbers(values)) as ArrayRef,
            ColumnValues::Texts(texts) => Arc::new(StringArray::from(texts)) as ArrayRef,
        });
        let table = RecordBatch::try_new(self.schema.clone(), arrays.collect())?;
        self.write_table(&table, &Chunk::default())
    }

    fn write_table(&mut self, table: &RecordBatch, chunk: &Chunk) -> Result<(), TableError> {
        match &mut self.encoder {
            Encoder::Text(sink) => sink.write(table, chunk),
            #[cfg(feature = "parquet")]
            Encoder::Parquet(sink) => sink.write(table),
        }
    }

    /// Writes the remaining rows and the end of the table, and returns the underlying writer.
    ///
    /// * `about`: description of how the table was calculated. It is stored in the metadata of a
    ///   Parquet file with the key [`METADATA_KEY`].
    ///
    /// # Errors
    ///
    /// Returns [`TableError`] if the end of the table cannot be written.
    pub fn finish(self, about: Option<&str>) -> Result<W, TableError> {
        self.finish_with(|_| {
            about.map(|text| (METADATA_KEY, text.to_owned())).into_iter().collect()
        })
    }

    /// Finishes a table like [`finish`](Self::finish), but writes several metadata keys to a
    /// Parquet file. The function `keys` is called after everything before the footer has been
    /// written.
    #[cfg_attr(
        not(feature = "parquet"),
        expect(unused_variables, reason = "text files have no metadata")
    )]
    pub(crate) fn finish_with(
        self,
        keys: impl FnOnce(&mut W) -> Vec<(&'static str, String)>,
    ) -> Result<W, TableError> {
        match self.encoder {
            Encoder::Text(sink) => sink.finish(),
            #[cfg(feature = "parquet")]
            Encoder::Parquet(sink) => sink.finish(keys),
        }
    }
}

impl<W: Write + Send> AnswerSink for TableSink<W> {
    fn write(&mut self, chunk: Chunk, answers: Answers) -> Result<(), TableError> {
        let table = answers.table(&chunk, &self.schema, &self.outputs)?;
        self.write_table(&table, &chunk)
    }
}

/// A sink that stores the results in memory, as one table per chunk.
#[cfg(feature = "parquet")]
pub(crate) struct MemorySink {
    pub(crate) schema: SchemaRef,
    pub(crate) tables: Vec<RecordBatch>,
    outputs: Vec<&'static Output>,
}

#[cfg(feature = "parquet")]
impl MemorySink {
    pub(crate) fn new(columns: &Columns, outputs: &[&'static Output]) -> Self {
        Self { schema: columns.schema(outputs), tables: Vec::new(), outputs: outputs.to_vec() }
    }
}

#[cfg(feature = "parquet")]
impl AnswerSink for MemorySink {
    fn write(&mut self, chunk: Chunk, answers: Answers) -> Result<(), TableError> {
        self.tables.push(answers.table(&chunk, &self.schema, &self.outputs)?);
        Ok(())
    }
}
