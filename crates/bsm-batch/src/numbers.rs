//! Tables of numbers only, written some rows at a time.

use std::collections::HashMap;
use std::io::{self, Write};
use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, RecordBatch};
use arrow_schema::{DataType, Field, Schema};
use bsm_case::write_exact;
use parquet::arrow::ArrowWriter;
use parquet::file::metadata::KeyValue;
use serde_json::{Map, json};

use crate::{ABOUT, TableError};

/// A column of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NumberColumn {
    /// Name.
    pub name: &'static str,
    /// Unit, for the metadata.
    pub unit: &'static str,
}

/// Rows of numbers, the values of each column; NaN is a gap.
pub type NumberRows = [Vec<f64>];

/// A table of numbers that is being written.
pub enum NumberSink<W: Write + Send> {
    /// Comma-separated values.
    Csv(Box<csv::Writer<W>>),
    /// One JSON object a line.
    JsonLines(W, Vec<NumberColumn>),
    /// Parquet, units in the metadata of the columns.
    Parquet(Box<ArrowWriter<W>>, Arc<Schema>),
}

impl<W: Write + Send> NumberSink<W> {
    /// Writes the names of the columns as CSV.
    ///
    /// # Errors
    ///
    /// [`TableError`].
    pub fn csv(writer: W, columns: &[NumberColumn]) -> Result<Self, TableError> {
        let mut table = csv::Writer::from_writer(writer);
        table.write_record(columns.iter().map(|column| column.name))?;
        Ok(Self::Csv(Box::new(table)))
    }

    /// JSON Lines of these columns.
    pub fn json_lines(writer: W, columns: &[NumberColumn]) -> Self {
        Self::JsonLines(writer, columns.to_vec())
    }

    /// Parquet of these columns.
    ///
    /// # Errors
    ///
    /// [`TableError`].
    pub fn parquet(writer: W, columns: &[NumberColumn]) -> Result<Self, TableError> {
        let field = |column: &NumberColumn| {
            let unit = HashMap::from([("unit".to_owned(), column.unit.to_owned())]);
            Field::new(column.name, DataType::Float64, true).with_metadata(unit)
        };
        let schema = Arc::new(Schema::new(columns.iter().map(field).collect::<Vec<_>>()));
        let table = ArrowWriter::try_new(writer, schema.clone(), None)?;
        Ok(Self::Parquet(Box::new(table), schema))
    }

    /// Writes rows; all columns have the same length.
    ///
    /// # Errors
    ///
    /// [`TableError`].
    pub fn write(&mut self, rows: &NumberRows) -> Result<(), TableError> {
        let count = rows.first().map_or(0, Vec::len);
        match self {
            Self::Csv(table) => {
                let mut digits = Vec::new();
                for row in 0..count {
                    for values in rows {
                        digits.clear();
                        if !values[row].is_nan() {
                            write_exact(&mut digits, values[row])?;
                        }
                        table.write_field(&digits)?;
                    }
                    table.write_record(None::<&[u8]>)?;
                }
            }
            Self::JsonLines(writer, columns) => {
                for row in 0..count {
                    let cell = |(column, values): (&NumberColumn, &Vec<f64>)| {
                        (column.name.to_owned(), json!(values[row]))
                    };
                    let line: Map<_, _> = columns.iter().zip(rows).map(cell).collect();
                    serde_json::to_writer(&mut *writer, &line).map_err(io::Error::from)?;
                    writeln!(writer)?;
                }
            }
            Self::Parquet(table, schema) => {
                let array = |values: &Vec<f64>| {
                    Arc::new(
                        values
                            .iter()
                            .map(|x| (!x.is_nan()).then_some(*x))
                            .collect::<Float64Array>(),
                    ) as ArrayRef
                };
                let arrays = rows.iter().map(array).collect();
                table.write(&RecordBatch::try_new(schema.clone(), arrays)?)?;
            }
        }
        Ok(())
    }

    /// Says what the table is made from, in the metadata of Parquet under [`ABOUT`]; other forms have no place
    /// for it.
    pub fn describe(&mut self, about: String) {
        if let Self::Parquet(table, _) = self {
            table.append_key_value_metadata(KeyValue::new(ABOUT.to_owned(), about));
        }
    }

    /// Writes the end of the table and returns the writer.
    ///
    /// # Errors
    ///
    /// [`TableError`].
    pub fn finish(self) -> Result<W, TableError> {
        match self {
            Self::Csv(table) => table.into_inner().map_err(|e| TableError::Io(e.into_error())),
            Self::JsonLines(writer, _) => Ok(writer),
            Self::Parquet(table, _) => Ok(table.into_inner()?),
        }
    }
}
