//! Tables as text: CSV and JSON Lines.

use std::borrow::Cow;
use std::io::{self, Read, Write};
use std::ops::Range;
use std::sync::Arc;

use arrow_array::ArrayRef;
use arrow_array::builder::StringBuilder;
use bsm_case::{InputKey, Output, brief, decimal_number, entries, write_exact};
use rayon::prelude::*;
use serde_json::{Map, Value, json};

use crate::lines::Lines;
use crate::rows::{ANSWERS, Answers, Cell, Chunk, Columns, TEXT, is_answer};
use crate::{Dialect, Sink, Source, TableError};

/// A value as it stands in a text cell.
fn parse(text: &str, decimal: char) -> Cell {
    let text = text.trim();
    if text.is_empty() {
        return Cell::Missing;
    }
    let number = if decimal == '.' { text.parse().ok() } else { decimal_number(text, decimal) };
    number.map_or_else(|| Cell::Text(text.to_owned()), Cell::Number)
}

/// Rows of a CSV table; the first line names the columns, and every other line is a row.
pub struct CsvSource<R> {
    lines: Lines<R>,
    columns: Columns,
    /// What becomes of each cell of a line.
    takes: Vec<Take>,
    delimiter: char,
    decimal: char,
    row: u64,
}

/// Where a cell goes, if it is not passed over.
#[derive(Debug, Clone, Copy)]
enum Take {
    Nothing,
    Input(usize),
    Kept(usize),
}

impl<R: Read> CsvSource<R> {
    /// Reads the names of the columns.
    ///
    /// # Errors
    ///
    /// [`TableError`] if they are not those of inputs or of `keep`.
    pub fn new(reader: R, keep: &[String]) -> Result<Self, TableError> {
        Self::with(reader, keep, &Dialect::default())
    }

    /// [`new`](Self::new) for a table with other signs or names.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new).
    pub fn with(reader: R, keep: &[String], dialect: &Dialect) -> Result<Self, TableError> {
        let Dialect { delimiter, decimal, .. } = *dialect;
        let mut lines = Lines::new(reader);
        let header = lines.next()?.ok_or(TableError::NoHeader)?;
        let mut names = Vec::new();
        let sorted = split(header, delimiter, 1, |_, name| names.push(name)).and_then(|width| {
            Ok((Columns::sort_as(names.iter().map(AsRef::as_ref), keep, dialect)?, width))
        });
        let (columns, width) = sorted.map_err(|error| {
            let other = header.chars().find(|c| [',', ';', '\t', '|'].contains(c));
            match other.filter(|_| !header.contains(delimiter)) {
                Some(found) => TableError::Separator { found, expected: delimiter },
                None => error,
            }
        })?;
        let mut takes = vec![Take::Nothing; width];
        for (input, place) in columns.input_places.iter().enumerate() {
            takes[*place] = Take::Input(input);
        }
        for (kept, place) in columns.kept_places.iter().enumerate() {
            takes[*place] = Take::Kept(kept);
        }
        Ok(Self { lines, columns, takes, delimiter, decimal, row: 0 })
    }
}

/// Gives the cells of a line of CSV with their places, and returns their number. A cell that begins with a quote ends with one, may hold delimiters, and
/// quotes twice; no other cell holds a quote. So no quote that is forgotten or one too many can join
/// cells or lines.
fn split<'a>(
    text: &'a str,
    delimiter: char,
    line: u64,
    mut each: impl FnMut(usize, Cow<'a, str>),
) -> Result<usize, TableError> {
    let (mut rest, mut cells) = (Some(text), 0);
    if memchr::memchr(b'"', text.as_bytes()).is_none() {
        let mut begin = 0;
        // A delimiter is ASCII.
        for end in memchr::memchr_iter(delimiter as u8, text.as_bytes()) {
            each(cells, Cow::Borrowed(&text[begin..end]));
            (begin, cells) = (end + 1, cells + 1);
        }
        rest = Some(&text[begin..]);
    }
    while let Some(text) = rest {
        let (cell, after) = if let Some(quoted) = text.strip_prefix('"') {
            // Quotes in pairs belong to the cell; the first one alone ends it.
            let mut end = 0;
            loop {
                end += quoted[end..].find('"').ok_or(TableError::OpenQuote { line })?;
                if !quoted[end + 1..].starts_with('"') {
                    break;
                }
                end += 2;
            }
            let (cell, after) = (&quoted[..end], &quoted[end + 1..]);
            if !(after.is_empty() || after.starts_with(delimiter)) {
                return Err(TableError::StrayQuote { line });
            }
            (Cow::Owned(cell.replace("\"\"", "\"")), after.strip_prefix(delimiter))
        } else {
            let (cell, after) = match text.split_once(delimiter) {
                Some((cell, after)) => (cell, Some(after)),
                None => (text, None),
            };
            if cell.contains('"') {
                return Err(TableError::StrayQuote { line });
            }
            (Cow::Borrowed(cell), after)
        };
        each(cells, cell);
        cells += 1;
        rest = after;
    }
    Ok(cells)
}

impl<R: Read + Send> Source for CsvSource<R> {
    fn columns(&self) -> &Columns {
        &self.columns
    }

    fn next(&mut self, rows: usize) -> Result<Option<Chunk>, TableError> {
        let mut chunk = Chunk::empty(self.row + 1, &self.columns, rows);
        let mut kept = texts(&self.columns);
        let mut text = 0;
        // A cell may be a space, and a row its delimiters.
        let (is_text, delimiter) = (matches!(self.takes[..], [Take::Kept(_)]), self.delimiter);
        while chunk.len < rows && text < TEXT {
            let line = self.lines.number() + 1;
            let is_blank = |line: &[u8]| {
                let is_row = is_text && !line.is_empty() || line.contains(&(delimiter as u8));
                !is_row && line.trim_ascii().is_empty()
            };
            let Some(row) = self.lines.next_but(is_blank)? else { break };
            text += row.len();
            let Self { takes, delimiter, decimal, .. } = self;
            let found = split(row, *delimiter, line, |place, cell| match takes.get(place) {
                Some(Take::Input(input)) => chunk.inputs[*input].push(parse(&cell, *decimal)),
                Some(Take::Kept(column)) => kept[*column].append_value(cell),
                Some(Take::Nothing) | None => {}
            })?;
            let columns = self.takes.len();
            if found != columns {
                return Err(TableError::Ragged { line, found, columns });
            }
            chunk.len += 1;
        }
        self.row += chunk.len as u64;
        chunk.kept = finished(kept);
        Ok(chunk.filled())
    }
}

/// Room for the texts of the columns that are carried through.
fn texts(columns: &Columns) -> Vec<StringBuilder> {
    columns.kept.iter().map(|_| StringBuilder::new()).collect()
}

fn finished(texts: Vec<StringBuilder>) -> Vec<ArrayRef> {
    texts.into_iter().map(|mut texts| Arc::new(texts.finish()) as ArrayRef).collect()
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
    /// # Errors
    ///
    /// [`TableError`] if it is no object, or has keys that are neither inputs nor in `keep`.
    pub fn new(reader: R, keep: &[String]) -> Result<Self, TableError> {
        Self::with(reader, keep, &Dialect::default())
    }

    /// [`new`](Self::new) for a table with other names.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new).
    pub fn with(reader: R, keep: &[String], dialect: &Dialect) -> Result<Self, TableError> {
        let mut lines = Lines::new(reader);
        let (first, _) = object(&mut lines)?.ok_or(TableError::NoHeader)?;
        let columns = Columns::sort_as(first.iter().map(|(key, _)| key.as_str()), keep, dialect)?;
        Ok(Self { lines, first: Some(first), columns, row: 0 })
    }
}

/// The object of the next line, and the length of the line.
fn object<R: Read>(lines: &mut Lines<R>) -> Result<Option<(Object, usize)>, TableError> {
    let Some(text) = lines.next()? else { return Ok(None) };
    let (read, length) = (entries(text.as_bytes()), text.len());
    match read {
        Ok(object) => Ok(Some((object, length))),
        Err(e) => Err(TableError::Json { line: lines.number(), reason: e.to_string() }),
    }
}

impl<R: Read + Send> Source for JsonSource<R> {
    fn columns(&self) -> &Columns {
        &self.columns
    }

    fn next(&mut self, rows: usize) -> Result<Option<Chunk>, TableError> {
        let mut chunk = Chunk::empty(self.row + 1, &self.columns, rows);
        let mut kept = texts(&self.columns);
        let mut text = 0;
        while chunk.len < rows && text < TEXT {
            let next = match self.first.take() {
                Some(first) => Some((first, 0)),
                None => object(&mut self.lines)?,
            };
            let Some((object, length)) = next else { break };
            let mut object: Map<String, Value> = object.into_iter().collect();
            for (cells, (name, _)) in chunk.inputs.iter_mut().zip(&self.columns.units) {
                cells.push(match object.remove(name) {
                    None | Some(Value::Null) => Cell::Missing,
                    Some(Value::Number(n)) => n.as_f64().map_or(Cell::Missing, Cell::Number),
                    Some(other) => Cell::Text(other.to_string()),
                });
            }
            for (cells, name) in kept.iter_mut().zip(&self.columns.kept) {
                match object.remove(name) {
                    None | Some(Value::Null) => cells.append_null(),
                    Some(Value::String(text)) => cells.append_value(text),
                    Some(other) => cells.append_value(other.to_string()),
                }
            }
            // A number of an earlier answer may have the name of an input: it is one only if the first line had it.
            let passed_over = |name: &String| {
                self.columns.unread.contains(name)
                    || is_answer(name) && InputKey::in_unit(name).is_err()
            };
            if let Some(name) = object.keys().find(|name| !passed_over(name)) {
                let reason = format!("`{}` is not in the first line", brief(name));
                return Err(TableError::Json { line: self.lines.number(), reason });
            }
            chunk.len += 1;
            text += length;
        }
        self.row += chunk.len as u64;
        chunk.kept = finished(kept);
        Ok(chunk.filled())
    }
}

/// Rows whose text one thread makes at a time, and how many such texts there are at a time.
const SLICE: usize = 512;
const SLICES: usize = 32;

/// Writes rows: their texts are made side by side and written in order.
fn write_rows(
    to: &mut impl Write,
    rows: usize,
    text: impl Fn(Range<usize>, &mut Vec<u8>) -> io::Result<()> + Sync,
) -> io::Result<()> {
    for first in (0..rows).step_by(SLICE * SLICES) {
        let slice = |i: usize| {
            let (from, mut made) = ((first + i * SLICE).min(rows), Vec::new());
            text(from..(from + SLICE).min(rows), &mut made)?;
            Ok(made)
        };
        let texts: io::Result<Vec<_>> = (0..SLICES).into_par_iter().map(slice).collect();
        texts?.iter().try_for_each(|text| to.write_all(text))?;
    }
    Ok(())
}

/// What separates the cells of a CSV table that is written, and its decimal sign; both are ASCII.
#[derive(Debug, Clone, Copy)]
struct Signs {
    delimiter: u8,
    decimal: u8,
}

impl Signs {
    /// Appends a text as a cell of CSV, which [`split`] reads.
    fn cell(self, to: &mut Vec<u8>, text: &str) {
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
}

/// The number that a column had last, and where its digits stand: in a grid most are those of the row above.
#[derive(Clone, Default)]
struct Last(u64, Range<usize>);

impl Last {
    fn write(&mut self, to: &mut Vec<u8>, value: f64, signs: Signs) -> io::Result<()> {
        let Self(bits, digits) = self;
        if *bits == value.to_bits() && digits.end > 0 {
            to.extend_from_within(digits.clone());
            return Ok(());
        }
        let begin = to.len();
        write_exact(to, value)?;
        signs.number(to, begin);
        (*bits, *digits) = (value.to_bits(), begin..to.len());
        Ok(())
    }
}

/// CSV with the columns of the source, then model, status, message and outputs.
pub struct CsvSink<W> {
    writer: W,
    outputs: Vec<&'static Output>,
    signs: Signs,
}

impl<W: Write> CsvSink<W> {
    /// Writes the names of the columns.
    ///
    /// # Errors
    ///
    /// [`TableError::Io`].
    pub fn new(
        writer: W,
        columns: &Columns,
        outputs: &[&'static Output],
    ) -> Result<Self, TableError> {
        Self::with(writer, columns, outputs, &Dialect::default())
    }

    /// [`new`](Self::new) with the signs of a dialect.
    ///
    /// # Errors
    ///
    /// [`TableError::Io`].
    pub fn with(
        mut writer: W,
        columns: &Columns,
        outputs: &[&'static Output],
        dialect: &Dialect,
    ) -> Result<Self, TableError> {
        let [delimiter, decimal] = [dialect.delimiter, dialect.decimal].map(|sign| sign as u8);
        let signs = Signs { delimiter, decimal };
        let kept = columns.kept.iter().map(String::as_str);
        let names = kept.chain(columns.inputs.iter().map(|key| key.name())).chain(ANSWERS);
        let mut header = Vec::new();
        for name in names.chain(outputs.iter().map(|output| output.name)) {
            signs.cell(&mut header, name);
            header.push(delimiter);
        }
        end_row(&mut header);
        writer.write_all(&header)?;
        Ok(Self { writer, outputs: outputs.to_vec(), signs })
    }

    /// The writer, all rows written.
    ///
    /// # Errors
    ///
    /// [`TableError::Io`].
    pub fn finish(mut self) -> Result<W, TableError> {
        self.writer.flush()?;
        Ok(self.writer)
    }
}

/// The sign behind the last cell becomes the end of the row.
fn end_row(text: &mut Vec<u8>) {
    text.pop();
    text.push(b'\n');
}

impl<W: Write> Sink for CsvSink<W> {
    fn write(&mut self, chunk: Chunk, answers: Answers) -> Result<(), TableError> {
        let Self { writer, outputs, signs } = self;
        let (signs, delimiter) = (*signs, signs.delimiter);
        let (inputs, numbers) = (chunk.inputs.len(), chunk.inputs.len() + outputs.len());
        let kept = chunk.kept_values()?;
        write_rows(writer, chunk.len, |rows, to| {
            let mut last = vec![Last::default(); numbers];
            for row in rows {
                for values in &kept {
                    match &values[row] {
                        Value::Null => {}
                        Value::String(text) => signs.cell(to, text),
                        value => {
                            let begin = to.len();
                            write!(to, "{value}")?;
                            signs.number(to, begin);
                        }
                    }
                    to.push(delimiter);
                }
                for (column, last) in chunk.inputs.iter().zip(&mut last) {
                    match column.cell(row) {
                        Cell::Missing => {}
                        Cell::Number(value) => last.write(to, value, signs)?,
                        Cell::Text(text) => signs.cell(to, &text),
                    }
                    to.push(delimiter);
                }
                let verdict = answers.verdicts[row];
                for name in [verdict.model.name(), verdict.status.name()] {
                    to.extend_from_slice(name.as_bytes());
                    to.push(delimiter);
                }
                signs.cell(to, answers.message(row).unwrap_or_default());
                to.push(delimiter);
                let columns = outputs.iter().zip(&answers.columns);
                for ((output, column), last) in columns.zip(&mut last[inputs..]) {
                    match json(output, column[row]) {
                        Value::Null => {}
                        Value::Number(number) if number.is_f64() => {
                            last.write(to, column[row], signs)?;
                        }
                        Value::String(word) => signs.cell(to, &word),
                        value => write!(to, "{value}")?,
                    }
                    to.push(delimiter);
                }
                end_row(to);
            }
            Ok(())
        })?;
        Ok(())
    }
}

/// A value of an output; null where there is none.
fn json(output: &Output, value: f64) -> Value {
    match output.json_type {
        _ if value.is_nan() => Value::Null,
        #[expect(clippy::cast_possible_truncation, reason = "small counts")]
        "integer" => json!(value as i64),
        "string" => json!(output.word(value)),
        "boolean" => json!(value > 0.5),
        _ => json!(value),
    }
}

/// One JSON object a line, with the names of the vocabulary.
pub struct JsonSink<W> {
    writer: W,
    columns: Columns,
    outputs: Vec<&'static Output>,
}

impl<W: Write> JsonSink<W> {
    /// Rows of these columns.
    pub fn new(writer: W, columns: Columns, outputs: &[&'static Output]) -> Self {
        Self { writer, columns, outputs: outputs.to_vec() }
    }

    /// The writer.
    pub fn finish(self) -> W {
        self.writer
    }
}

impl<W: Write> Sink for JsonSink<W> {
    fn write(&mut self, chunk: Chunk, answers: Answers) -> Result<(), TableError> {
        let Self { writer, columns, outputs } = self;
        let kept = chunk.kept_values()?;
        write_rows(writer, chunk.len, |rows, to| {
            for row in rows {
                let verdict = answers.verdicts[row];
                let mut line = Map::new();
                for (name, values) in columns.kept.iter().zip(&kept) {
                    line.insert(name.clone(), values[row].clone());
                }
                for (key, column) in columns.inputs.iter().zip(&chunk.inputs) {
                    line.insert(
                        key.name().to_owned(),
                        match column.cell(row) {
                            Cell::Missing => Value::Null,
                            Cell::Number(value) => json!(value),
                            Cell::Text(text) => json!(text),
                        },
                    );
                }
                line.insert("model".to_owned(), json!(verdict.model.name()));
                line.insert("status".to_owned(), json!(verdict.status.name()));
                line.insert("message".to_owned(), json!(answers.message(row)));
                for (output, column) in outputs.iter().zip(&answers.columns) {
                    line.insert(output.name.to_owned(), json(output, column[row]));
                }
                writeln!(to, "{}", Value::Object(line))?;
            }
            Ok(())
        })?;
        Ok(())
    }
}
