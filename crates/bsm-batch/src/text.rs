//! Tables as text: CSV and JSON Lines.

use std::io::{self, Read, Write};
use std::ops::Range;

use arrow_array::RecordBatch;
use arrow_schema::{FieldRef, SchemaRef};
use bsm_case::{InputKey, Lines, brief, check_width, decimal_number, entries, split, write_exact};
use rayon::prelude::*;
use serde_json::{Map, Value};

use crate::columns::{Columns, is_answer};
use crate::rows::{Cell, Cells, Chunk, ChunkBuilder, TEXT};
use crate::{Source, TableError, TableFormat};

/// A value as it stands in a text cell.
fn parse(text: &str, decimal: char) -> Cell<'_> {
    let text = text.trim();
    if text.is_empty() {
        return Cell::Missing;
    }
    let number = if decimal == '.' { text.parse().ok() } else { decimal_number(text, decimal) };
    number.map_or(Cell::Text(text), Cell::Number)
}

/// Rows of a CSV table; the first line names the columns, and every other line is a row.
pub struct CsvSource<R> {
    lines: Lines<R>,
    columns: Columns,
    /// Use of each cell of a line.
    targets: Vec<CellTarget>,
    delimiter: char,
    decimal: char,
    row: u64,
}

/// Where a cell goes, if it is not passed over.
#[derive(Debug, Clone, Copy)]
enum CellTarget {
    Nothing,
    Input(usize),
    Kept(usize),
}

impl<R: Read> CsvSource<R> {
    /// Reads the names of the columns.
    ///
    /// * `table_format`: its signs and names.
    ///
    /// # Errors
    ///
    /// [`TableError`] if they are not those of inputs or of `keep`.
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
        let (columns, width) = sorted.map_err(|error| {
            let other = header.chars().find(|c| [',', ';', '\t', '|'].contains(c));
            match other.filter(|_| !header.contains(delimiter)) {
                Some(found) => TableError::Separator { found, expected: delimiter },
                None => error,
            }
        })?;
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
        let mut text = 0;
        // A cell may be a space, and a row its delimiters.
        let is_text = matches!(targets[..], [CellTarget::Kept(_)]);
        while chunk.len() < rows && text < TEXT {
            let line = lines.number() + 1;
            let is_blank = |line: &[u8]| {
                let is_row = is_text && !line.is_empty() || line.contains(&(*delimiter as u8));
                !is_row && line.trim_ascii().is_empty()
            };
            let Some(row) = lines.next_but(is_blank)? else { break };
            text += row.len();
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

/// An object of JSON, in its order.
type Object = Vec<(String, Value)>;

/// Rows of JSON Lines: one object a line; the first one names the columns, a later one may leave
/// some out.
pub struct JsonSource<R> {
    lines: Lines<R>,
    first: Option<Object>,
    columns: Columns,
    row: u64,
}

impl<R: Read> JsonSource<R> {
    /// Reads the first line.
    ///
    /// * `table_format`: its names.
    ///
    /// # Errors
    ///
    /// [`TableError`] if it is no object, or has keys that are neither inputs nor in `keep`.
    pub fn new(reader: R, keep: &[String], table_format: &TableFormat) -> Result<Self, TableError> {
        let mut lines = Lines::new(reader);
        let (first, _) = object(&mut lines)?.ok_or_else(TableError::no_header)?;
        let columns = Columns::sort(first.iter().map(|(key, _)| key.as_str()), keep, table_format)?;
        Ok(Self { lines, first: Some(first), columns, row: 0 })
    }
}

/// The object of the next line, and the length of the line.
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
        let mut text = 0;
        while chunk.len() < rows && text < TEXT {
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
            // A number of an earlier answer may have the name of an input: it is one only if the first line had it.
            let passed_over = |name: &String| {
                columns.unread.contains(name) || is_answer(name) && InputKey::in_unit(name).is_err()
            };
            if let Some(name) = object.keys().find(|name| !passed_over(name)) {
                let (line, name) = (lines.number(), brief(name));
                let message = format!("line {line}: `{name}` is not in the first line");
                return Err(TableError::Malformed(message));
            }
            chunk.end_row();
            text += length;
        }
        self.row += chunk.len() as u64;
        Ok(chunk.finish())
    }
}

/// Rows whose text one thread makes at a time, and how many such texts there are at a time.
const SLICE: usize = 512;
const SLICES: usize = 32;

/// Separator and decimal sign of a written CSV table; both are ASCII.
#[derive(Debug, Clone, Copy)]
struct CsvFormat {
    delimiter: u8,
    decimal: u8,
}

impl CsvFormat {
    /// Appends a text as a cell of CSV, which [`split`] reads.
    fn text(self, to: &mut Vec<u8>, text: &str) {
        let odd = |byte| byte == self.delimiter || matches!(byte, b'"' | b'\n' | b'\r');
        if text.bytes().any(odd) {
            to.extend([b"\"", text.replace('"', "\"\"").as_bytes(), b"\""].concat());
        } else {
            to.extend_from_slice(text.as_bytes());
        }
    }

    /// Makes the digits behind a place a cell.
    fn number(self, to: &mut Vec<u8>, begin: usize) {
        if self.decimal == b'.' {
            return;
        }
        let point = to[begin..].iter().position(|byte| *byte == b'.');
        if let Some(point) = point {
            to[begin + point] = self.decimal;
            if self.decimal == self.delimiter {
                to.insert(begin, b'"');
                to.push(b'"');
            }
        }
    }

    /// Appends a cell of CSV.
    fn cell(self, to: &mut Vec<u8>, cell: &Cell<'_>) -> io::Result<()> {
        let begin = to.len();
        match cell {
            Cell::Missing => return Ok(()),
            Cell::Text(text) => {
                self.text(to, text);
                return Ok(());
            }
            Cell::Number(value) => write_exact(to, *value)?,
            Cell::Digits(number) => write!(to, "{number}")?,
            Cell::Flag(flag) => write!(to, "{flag}")?,
        }
        self.number(to, begin);
        Ok(())
    }
}

/// Appends a cell of JSON.
fn json(to: &mut Vec<u8>, cell: &Cell<'_>) -> io::Result<()> {
    Ok(match cell {
        Cell::Missing => serde_json::to_writer(to, &()),
        Cell::Text(text) => serde_json::to_writer(to, text),
        Cell::Number(value) => serde_json::to_writer(to, value),
        Cell::Digits(number) => serde_json::to_writer(to, number),
        Cell::Flag(flag) => serde_json::to_writer(to, flag),
    }?)
}

/// The number that a column had last, and where its digits stand: in a grid most are those of the row above.
#[derive(Clone, Default)]
struct LastCell(u64, Range<usize>);

/// How a row is written.
struct RowForm {
    /// Signs of CSV; JSON Lines have none.
    csv: Option<CsvFormat>,
    /// What stands before each cell, and at the end.
    before: Vec<Vec<u8>>,
    end: &'static [u8],
}

impl RowForm {
    fn text(&self, cells: &Cells<'_>, rows: Range<usize>) -> io::Result<Vec<u8>> {
        let mut to = Vec::new();
        let mut last = vec![LastCell::default(); self.before.len()];
        for row in rows {
            let begin = to.len();
            let columns = cells.row(row).zip(&self.before).zip(&mut last);
            for ((cell, before), LastCell(bits, digits)) in columns {
                to.extend_from_slice(before);
                let begin = to.len();
                match (&cell, self.csv) {
                    (Cell::Number(x), _) if x.to_bits() == *bits && digits.end > 0 => {
                        to.extend_from_within(digits.clone());
                        continue;
                    }
                    (_, Some(csv)) => csv.cell(&mut to, &cell)?,
                    (_, None) => json(&mut to, &cell)?,
                }
                if let Cell::Number(x) = cell {
                    (*bits, *digits) = (x.to_bits(), begin..to.len());
                }
            }
            if to.len() == begin {
                // An empty cell alone would be a blank line.
                to.extend(b"\"\"");
            }
            to.extend_from_slice(self.end);
        }
        Ok(to)
    }
}

/// A table of text that is being written.
pub(crate) struct TextSink<W> {
    writer: W,
    form: RowForm,
}

impl<W: Write> TextSink<W> {
    /// CSV; writes the names of the columns.
    pub(crate) fn csv(
        mut writer: W,
        schema: &SchemaRef,
        table_format: &TableFormat,
    ) -> Result<Self, TableError> {
        let [delimiter, decimal] =
            [table_format.delimiter, table_format.decimal].map(|sign| sign as u8);
        let csv = CsvFormat { delimiter, decimal };
        let (mut head, mut before) = (Vec::new(), Vec::new());
        for field in schema.fields() {
            before.push(if before.is_empty() { Vec::new() } else { vec![delimiter] });
            head.extend(&before[before.len() - 1]);
            csv.text(&mut head, field.name());
        }
        head.push(b'\n');
        writer.write_all(&head)?;
        Ok(Self { writer, form: RowForm { csv: Some(csv), before, end: b"\n" } })
    }

    /// One JSON object a line.
    pub(crate) fn json_lines(writer: W, schema: &SchemaRef) -> Self {
        let name = |(index, field): (usize, &FieldRef)| {
            let sign = if index == 0 { '{' } else { ',' };
            format!("{sign}{}:", Value::from(field.name().as_str())).into_bytes()
        };
        let before = schema.fields().iter().enumerate().map(name).collect();
        Self { writer, form: RowForm { csv: None, before, end: b"}\n" } }
    }

    /// Writes the table of a chunk: texts of its rows are made side by side and written in order.
    pub(crate) fn write(&mut self, table: &RecordBatch, chunk: &Chunk) -> Result<(), TableError> {
        let (cells, rows, form) = (Cells::of(table, chunk)?, table.num_rows(), &self.form);
        for first in (0..rows).step_by(SLICE * SLICES) {
            let slice = |i: usize| {
                let from = (first + i * SLICE).min(rows);
                form.text(&cells, from..(from + SLICE).min(rows))
            };
            let texts: io::Result<Vec<_>> = (0..SLICES).into_par_iter().map(slice).collect();
            texts?.iter().try_for_each(|text| self.writer.write_all(text))?;
        }
        Ok(())
    }

    /// The writer, all rows written.
    pub(crate) fn finish(mut self) -> Result<W, TableError> {
        self.writer.flush()?;
        Ok(self.writer)
    }
}
