//! Reads and writes text tables, which are CSV or JSON Lines files.

use std::io::{self, Read, Write};
use std::ops::Range;

use arrow_array::RecordBatch;
use arrow_schema::{FieldRef, SchemaRef};
use bsm_case::{
    InputKey, Lines, OtherSeparator, brief, check_width, decimal_number, entries, split,
    write_exact,
};
use csv::WriterBuilder;
use rayon::prelude::*;
use serde_json::{Map, Value};

use crate::columns::{Columns, is_answer};
use crate::rows::{Cell, Chunk, ChunkBuilder, MAX_TEXT_BYTES, RowCells};
use crate::{Source, TableError, TableFormat};

/// Parses the text of a table cell.
fn parse(text: &str, decimal: char) -> Cell<'_> {
    let text = text.trim();
    if text.is_empty() {
        return Cell::Missing;
    }
    let number = if decimal == '.' { text.parse().ok() } else { decimal_number(text, decimal) };
    number.map_or(Cell::Text(text), Cell::Number)
}

/// Reads the rows of a CSV table. The first line contains the column names, and every other line is
/// a row.
pub struct CsvSource<R> {
    lines: Lines<R>,
    columns: Columns,
    /// For each cell of a line, the input or the copied column to which the cell belongs.
    targets: Vec<CellTarget>,
    delimiter: char,
    decimal: char,
    row: u64,
}

/// Input or copied column to which a cell belongs.
#[derive(Debug, Clone, Copy)]
enum CellTarget {
    Nothing,
    Input(usize),
    Kept(usize),
}

impl<R: Read> CsvSource<R> {
    /// Reads the first line of the table, which contains the column names.
    ///
    /// * `table_format`: separators, decimal sign and column names.
    ///
    /// # Errors
    ///
    /// Returns [`TableError`] if a column is neither an input nor in `keep`.
    pub fn new(reader: R, keep: &[String], table_format: &TableFormat) -> Result<Self, TableError> {
        let TableFormat { delimiter, decimal, .. } = *table_format;
        let mut lines = Lines::new(reader);
        let header = lines.next_line()?.ok_or_else(TableError::no_header)?;
        let mut names = Vec::new();
        let width =
            split(header, delimiter, 1, |_, name| names.push(name)).map_err(TableError::from);
        let sorted = width.and_then(|width| {
            Ok((Columns::sort(names.iter().map(AsRef::as_ref), keep, table_format)?, width))
        });
        let other = || OtherSeparator::of(header, delimiter).map(TableError::from);
        let (columns, width) = sorted.map_err(|error| other().unwrap_or(error))?;
        let mut targets = vec![CellTarget::Nothing; width];
        for (input, index) in columns.input_places.iter().enumerate() {
            targets[*index] = CellTarget::Input(input);
        }
        for (kept, index) in columns.kept_places.iter().enumerate() {
            targets[*index] = CellTarget::Kept(kept);
        }
        Ok(Self { lines, columns, targets, delimiter, decimal, row: 0 })
    }
}

impl<R: Read + Send> Source for CsvSource<R> {
    fn columns(&self) -> &Columns {
        &self.columns
    }

    fn next(&mut self, rows: usize) -> Result<Option<Chunk>, TableError> {
        let Self { lines, columns, targets, delimiter, decimal, .. } = self;
        let mut chunk = ChunkBuilder::new(self.row + 1, columns, rows);
        let mut text_bytes = 0;
        // In a table with a single text column, a line of spaces is a row with one cell. In all
        // other tables, a line that consists only of delimiters is a row of empty cells.
        let is_text = matches!(targets[..], [CellTarget::Kept(_)]);
        while chunk.len() < rows && text_bytes < MAX_TEXT_BYTES {
            let line = lines.number() + 1;
            let is_blank = |line: &[u8]| {
                let is_row = is_text && !line.is_empty() || line.contains(&(*delimiter as u8));
                !is_row && line.trim_ascii().is_empty()
            };
            let Some(row) = lines.next_line_where_blank(is_blank)? else { break };
            text_bytes += row.len();
            let found = split(row, *delimiter, line, |index, cell| match targets.get(index) {
                Some(CellTarget::Input(input)) => chunk.input(*input, &parse(&cell, *decimal)),
                Some(CellTarget::Kept(column)) => chunk.keep(*column, Some(&cell)),
                Some(CellTarget::Nothing) | None => {}
            })?;
            check_width(found, targets.len(), line)?;
            chunk.end_row();
        }
        self.row += chunk.len() as u64;
        Ok(chunk.finish())
    }
}

/// A JSON object whose keys are kept in their original order.
type Object = Vec<(String, Value)>;

/// Reads the rows of a JSON Lines table, which has one JSON object per line. The keys of the first
/// object define the columns. Later objects may omit some of these keys.
pub struct JsonSource<R> {
    lines: Lines<R>,
    first: Option<Object>,
    columns: Columns,
    row: u64,
}

impl<R: Read> JsonSource<R> {
    /// Reads the first line of the table, whose keys are the column names.
    ///
    /// * `table_format`: assignment of column names to inputs.
    ///
    /// # Errors
    ///
    /// Returns [`TableError`] if the first line is not an object, or if a key is neither an input
    /// nor in `keep`.
    pub fn new(reader: R, keep: &[String], table_format: &TableFormat) -> Result<Self, TableError> {
        let mut lines = Lines::new(reader);
        let (first, _) = object(&mut lines)?.ok_or_else(TableError::no_header)?;
        let columns = Columns::sort(first.iter().map(|(key, _)| key.as_str()), keep, table_format)?;
        Ok(Self { lines, first: Some(first), columns, row: 0 })
    }
}

/// Returns the JSON object in the next line, and the length of the line.
fn object<R: Read>(lines: &mut Lines<R>) -> Result<Option<(Object, usize)>, TableError> {
    let Some(text) = lines.next_line()? else { return Ok(None) };
    let (read, length) = (entries(text.as_bytes()), text.len());
    match read {
        Ok(object) => Ok(Some((object, length))),
        Err(e) => Err(TableError::Malformed(format!("line {}: {e}", lines.number()))),
    }
}

impl<R: Read + Send> Source for JsonSource<R> {
    fn columns(&self) -> &Columns {
        &self.columns
    }

    fn next(&mut self, rows: usize) -> Result<Option<Chunk>, TableError> {
        let Self { lines, columns, .. } = self;
        let mut chunk = ChunkBuilder::new(self.row + 1, columns, rows);
        let mut text_bytes = 0;
        while chunk.len() < rows && text_bytes < MAX_TEXT_BYTES {
            let next = match self.first.take() {
                Some(first) => Some((first, 0)),
                None => object(lines)?,
            };
            let Some((object, length)) = next else { break };
            let mut object: Map<String, Value> = object.into_iter().collect();
            for (index, (name, _)) in columns.units.iter().enumerate() {
                match object.remove(name) {
                    Some(Value::Number(n)) => {
                        chunk.input(index, &n.as_f64().map_or(Cell::Missing, Cell::Number));
                    }
                    None | Some(Value::Null) => chunk.input(index, &Cell::Missing),
                    Some(other) => chunk.input(index, &Cell::Text(&other.to_string())),
                }
            }
            for (index, name) in columns.kept.iter().enumerate() {
                match object.remove(name) {
                    None | Some(Value::Null) => chunk.keep(index, None),
                    Some(Value::String(text)) => chunk.keep(index, Some(&text)),
                    Some(other) => chunk.keep(index, Some(&other.to_string())),
                }
            }
            // An output of an earlier run may have the same name as an input. A key with such a
            // name is read as an input only if it occurs in the first line.
            let is_ignored = |name: &String| {
                columns.unread.contains(name) || is_answer(name) && InputKey::in_unit(name).is_err()
            };
            if let Some(name) = object.keys().find(|name| !is_ignored(name)) {
                let (line, name) = (lines.number(), brief(name));
                let message = format!("line {line}: key `{name}` is not in the first line");
                return Err(TableError::Malformed(message));
            }
            chunk.end_row();
            text_bytes += length;
        }
        self.row += chunk.len() as u64;
        Ok(chunk.finish())
    }
}

/// Number of rows that a thread converts to text at a time. These rows are called a slice.
const SLICE_ROWS: usize = 512;

/// Maximum number of slices whose text is held in memory at the same time.
const SLICES: usize = 32;

/// Format in which rows are written as text.
enum RowForm {
    Csv {
        /// Settings of the CSV writer, in a `Box` because they are large.
        writer: Box<WriterBuilder>,
        /// Character that is written as the decimal sign.
        decimal: u8,
    },
    JsonLines {
        /// Text before each cell: an opening brace or a comma, followed by the column name.
        before: Vec<Vec<u8>>,
    },
}

impl RowForm {
    fn text(&self, cells: &RowCells<'_>, rows: Range<usize>) -> io::Result<Vec<u8>> {
        match self {
            Self::Csv { writer, decimal } => csv_rows(writer, *decimal, cells, rows),
            Self::JsonLines { before } => json_rows(before, cells, rows),
        }
    }
}

/// Converts rows to CSV text.
fn csv_rows(
    writer: &WriterBuilder,
    decimal: u8,
    cells: &RowCells<'_>,
    rows: Range<usize>,
) -> io::Result<Vec<u8>> {
    let (mut to, mut digits) = (Vec::new(), Vec::new());
    let mut writer = writer.from_writer(&mut to);
    for row in rows {
        for cell in cells.row(row) {
            digits.clear();
            match cell {
                Cell::Missing => {}
                Cell::Text(text) => {
                    writer.write_field(text)?;
                    continue;
                }
                Cell::Number(value) => write_exact(&mut digits, value)?,
                Cell::Digits(number) => write!(digits, "{number}")?,
                Cell::Flag(flag) => write!(digits, "{flag}")?,
            }
            if let Some(point) = digits.iter_mut().find(|byte| **byte == b'.') {
                *point = decimal;
            }
            writer.write_field(&digits)?;
        }
        writer.write_record(None::<&[u8]>)?;
    }
    writer.flush()?;
    drop(writer);
    Ok(to)
}

/// Converts rows to JSON Lines text, with one JSON object per line.
fn json_rows(before: &[Vec<u8>], cells: &RowCells<'_>, rows: Range<usize>) -> io::Result<Vec<u8>> {
    let mut to = Vec::new();
    for row in rows {
        for (cell, before) in cells.row(row).zip(before) {
            to.extend_from_slice(before);
            match cell {
                Cell::Missing => serde_json::to_writer(&mut to, &()),
                Cell::Text(text) => serde_json::to_writer(&mut to, text),
                Cell::Number(value) => serde_json::to_writer(&mut to, &value),
                Cell::Digits(number) => serde_json::to_writer(&mut to, &number),
                Cell::Flag(flag) => serde_json::to_writer(&mut to, &flag),
            }?;
        }
        to.extend_from_slice(b"}\n");
    }
    Ok(to)
}

/// Writes a CSV or JSON Lines table.
pub(crate) struct TextSink<W> {
    writer: W,
    form: RowForm,
}

impl<W: Write> TextSink<W> {
    /// Starts a CSV table and writes the column names.
    pub(crate) fn csv(
        mut writer: W,
        schema: &SchemaRef,
        table_format: &TableFormat,
    ) -> Result<Self, TableError> {
        let [delimiter, decimal] =
            [table_format.delimiter, table_format.decimal].map(|sign| sign as u8);
        let mut rows = WriterBuilder::new();
        rows.delimiter(delimiter);
        let mut head = rows.from_writer(&mut writer);
        head.write_record(schema.fields().iter().map(|field| field.name()))
            .map_err(io::Error::from)?;
        head.flush()?;
        drop(head);
        Ok(Self { writer, form: RowForm::Csv { writer: Box::new(rows), decimal } })
    }

    /// Starts a JSON Lines table, with one object per line.
    pub(crate) fn json_lines(writer: W, schema: &SchemaRef) -> Self {
        let name = |(index, field): (usize, &FieldRef)| {
            let sign = if index == 0 { '{' } else { ',' };
            format!("{sign}{}:", Value::from(field.name().as_str())).into_bytes()
        };
        let before = schema.fields().iter().enumerate().map(name).collect();
        Self { writer, form: RowForm::JsonLines { before } }
    }

    /// Writes the rows of a chunk. The rows are converted to text in parallel, and are written in
    /// their original order.
    pub(crate) fn write(&mut self, table: &RecordBatch, chunk: &Chunk) -> Result<(), TableError> {
        let (cells, rows, form) = (RowCells::of(table, chunk)?, table.num_rows(), &self.form);
        for first in (0..rows).step_by(SLICE_ROWS * SLICES) {
            let slice = |i: usize| {
                let from = (first + i * SLICE_ROWS).min(rows);
                form.text(&cells, from..(from + SLICE_ROWS).min(rows))
            };
            let texts: io::Result<Vec<_>> = (0..SLICES).into_par_iter().map(slice).collect();
            texts?.iter().try_for_each(|text| self.writer.write_all(text))?;
        }
        Ok(())
    }

    /// Flushes the underlying writer and returns it.
    pub(crate) fn finish(mut self) -> Result<W, TableError> {
        self.writer.flush()?;
        Ok(self.writer)
    }
}
