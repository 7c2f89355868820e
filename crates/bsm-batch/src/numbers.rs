//! Tables of numbers only, written at once.

use std::collections::HashMap;
use std::io::{self, Write};
use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, RecordBatch};
use arrow_schema::{DataType, Field, Schema};
use parquet::arrow::ArrowWriter;
use serde_json::{Map, json};

use crate::TableError;

/// A column of numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct NumberColumn {
    /// Name.
    pub name: &'static str,
    /// Unit, for the metadata.
    pub unit: &'static str,
    /// Values.
    pub values: Vec<f64>,
}

/// A table of numbers; all columns have the same length.
#[derive(Debug, Clone, PartialEq)]
pub struct Numbers(pub Vec<NumberColumn>);

impl Numbers {
    fn rows(&self) -> usize {
        self.0.first().map_or(0, |column| column.values.len())
    }

    /// Writes it as CSV and returns the writer.
    ///
    /// # Errors
    ///
    /// [`TableError`].
    pub fn write_csv<W: Write>(&self, writer: W) -> Result<W, TableError> {
        let mut table = csv::Writer::from_writer(writer);
        table.write_record(self.0.iter().map(|column| column.name))?;
        for row in 0..self.rows() {
            table.write_record(self.0.iter().map(|column| column.values[row].to_string()))?;
        }
        table.into_inner().map_err(|e| io::Error::from(e.error().kind()).into())
    }

    /// Writes it as JSON Lines and returns the writer.
    ///
    /// # Errors
    ///
    /// [`TableError`].
    pub fn write_json_lines<W: Write>(&self, mut writer: W) -> Result<W, TableError> {
        for row in 0..self.rows() {
            let cell = |c: &NumberColumn| (c.name.to_owned(), json!(c.values[row]));
            let line: Map<_, _> = self.0.iter().map(cell).collect();
            serde_json::to_writer(&mut writer, &line).map_err(io::Error::from)?;
            writeln!(writer)?;
        }
        Ok(writer)
    }

    /// Writes it as Parquet, units in the metadata of the columns, and returns the writer.
    ///
    /// # Errors
    ///
    /// [`TableError`].
    pub fn write_parquet<W: Write + Send>(self, writer: W) -> Result<W, TableError> {
        let field = |column: &NumberColumn| {
            let unit = HashMap::from([("unit".to_owned(), column.unit.to_owned())]);
            Field::new(column.name, DataType::Float64, false).with_metadata(unit)
        };
        let schema = Arc::new(Schema::new(self.0.iter().map(field).collect::<Vec<_>>()));
        let mut table = ArrowWriter::try_new(writer, schema.clone(), None)?;
        let array = |c: NumberColumn| Arc::new(Float64Array::from(c.values)) as ArrayRef;
        table.write(&RecordBatch::try_new(schema, self.0.into_iter().map(array).collect())?)?;
        Ok(table.into_inner()?)
    }
}
