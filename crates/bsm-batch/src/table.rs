//! Tables. The file format is determined by the file extension.

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

/// Key in the metadata of a Parquet table. Its value describes the origin of the table as JSON.
pub const ABOUT: &str = "bsm";

/// File format of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// CSV: text with separated cells.
    Csv,
    /// JSON Lines: one JSON object per line.
    JsonLines,
    /// Parquet: binary columns.
    #[cfg(feature = "parquet")]
    Parquet,
}

impl Format {
    /// Returns the format for the file extension, or `None` if the extension is unknown.
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

    /// Opens a table of this format and returns its rows.
    ///
    /// * `table_format`: assignment of column names to inputs, and the separators and decimal sign
    ///   of a text file.
    ///
    /// # Errors
    ///
    /// [`TableError`] if the file cannot be opened, or if a column is neither an input nor in
    /// `keep`.
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

/// Header of a column in a table that does not contain solved points.
#[derive(Debug, Clone, Copy)]
pub struct TableHead<'a> {
    /// Column name.
    pub name: &'a str,
    /// Unit of the column as text.
    pub unit: &'a str,
    /// True for a text column.
    pub is_text: bool,
}

/// A CSV, JSON Lines or Parquet table that is being written.
pub struct TableSink<W: Write + Send> {
    schema: SchemaRef,
    outputs: Vec<&'static Output>,
    file: Form<W>,
}

enum Form<W: Write + Send> {
    Text(TextSink<W>),
    #[cfg(feature = "parquet")]
    Parquet(Box<ParquetSink<W>>),
}

impl<W: Write + Send> TableSink<W> {
    /// Starts a table and writes its column names: first the columns of the source, then model,
    /// status, message and outputs.
    ///
    /// * `table_format`: separators and decimal sign of a CSV file.
    ///
    /// # Errors
    ///
    /// [`TableError`] if the table cannot be written.
    pub fn new(
        format: Format,
        out: W,
        columns: &Columns,
        outputs: &[&'static Output],
        table_format: &TableFormat,
    ) -> Result<Self, TableError> {
        Self::with_schema(format, out, (columns.schema(outputs), outputs), table_format)
    }

    /// Works like [`new`](Self::new), with other names and units of the columns.
    ///
    /// # Errors
    ///
    /// [`TableError`].
    pub fn with_schema(
        format: Format,
        out: W,
        (schema, outputs): (SchemaRef, &[&'static Output]),
        table_format: &TableFormat,
    ) -> Result<Self, TableError> {
        let this = Self::of_schema(format, out, schema, table_format)?;
        Ok(Self { outputs: outputs.to_vec(), ..this })
    }

    /// Starts a table that does not contain solved points.
    ///
    /// # Errors
    ///
    /// [`TableError`] if the table cannot be written.
    pub fn of_columns<'a>(
        format: Format,
        out: W,
        heads: impl IntoIterator<Item = TableHead<'a>>,
    ) -> Result<Self, TableError> {
        let fields = heads.into_iter().map(|TableHead { name, unit, is_text }| {
            if is_text { Field::new(name, DataType::Utf8, true) } else { field(name, unit) }
        });
        let schema = Arc::new(Schema::new(fields.collect::<Vec<_>>()));
        Self::of_schema(format, out, schema, &TableFormat::default())
    }

    fn of_schema(
        format: Format,
        out: W,
        schema: SchemaRef,
        table_format: &TableFormat,
    ) -> Result<Self, TableError> {
        let file = match format {
            Format::Csv => Form::Text(TextSink::csv(out, &schema, table_format)?),
            Format::JsonLines => Form::Text(TextSink::json_lines(out, &schema)),
            #[cfg(feature = "parquet")]
            Format::Parquet => Form::Parquet(Box::new(ParquetSink::new(out, schema.clone())?)),
        };
        Ok(Self { schema, outputs: Vec::new(), file })
    }

    /// Writes rows that are given as columns of equal length.
    ///
    /// # Errors
    ///
    /// [`TableError`] if the rows cannot be written.
    pub fn write_columns(&mut self, columns: Vec<ColumnValues>) -> Result<(), TableError> {
        let arrays = columns.into_iter().map(|values| match values {
            ColumnValues::Numbers(values) => Arc::new(numbers(values)) as ArrayRef,
            ColumnValues::Texts(texts) => Arc::new(StringArray::from(texts)) as ArrayRef,
        });
        let table = RecordBatch::try_new(self.schema.clone(), arrays.collect())?;
        self.write_table(&table, &Chunk::default())
    }

    fn write_table(&mut self, table: &RecordBatch, chunk: &Chunk) -> Result<(), TableError> {
        match &mut self.file {
            Form::Text(sink) => sink.write(table, chunk),
            #[cfg(feature = "parquet")]
            Form::Parquet(sink) => sink.write(table),
        }
    }

    /// Writes the end of the table and returns the writer.
    ///
    /// * `about`: description of the table's origin, which is stored in the metadata of a Parquet
    ///   file with the key [`ABOUT`].
    ///
    /// # Errors
    ///
    /// [`TableError`] if the end of the table cannot be written.
    pub fn finish(self, about: Option<&str>) -> Result<W, TableError> {
        self.finish_with(|_| about.map(|text| (ABOUT, text.to_owned())).into_iter().collect())
    }

    /// Same as [`finish`](Self::finish), but writes several metadata keys to a Parquet file. `keys`
    /// is called after everything before the footer has been written.
    #[cfg_attr(
        not(feature = "parquet"),
        expect(unused_variables, reason = "text files have no metadata")
    )]
    pub(crate) fn finish_with(
        self,
        keys: impl FnOnce(&mut W) -> Vec<(&'static str, String)>,
    ) -> Result<W, TableError> {
        match self.file {
            Form::Text(sink) => sink.finish(),
            #[cfg(feature = "parquet")]
            Form::Parquet(sink) => sink.finish(keys),
        }
    }
}

impl<W: Write + Send> AnswerSink for TableSink<W> {
    fn write(&mut self, chunk: Chunk, answers: Answers) -> Result<(), TableError> {
        let table = answers.table(&chunk, &self.schema, &self.outputs)?;
        self.write_table(&table, &chunk)
    }
}

/// A sink that keeps results in memory, with one table for each chunk.
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
