//! Tables as text: CSV and JSON Lines.

use std::borrow::Cow;
use std::io::{Read, Write};
use std::mem;

use bsm_case::{Output, brief, entries, write_exact};
use serde_json::{Map, Value, json};

use crate::lines::Lines;
use crate::rows::{ANSWERS, Answers, Cell, Chunk, Columns, TEXT, is_answer};
use crate::{Sink, Source, TableError};

/// A value as it stands in a text cell.
fn parse(text: &str) -> Cell {
    let text = text.trim();
    if text.is_empty() {
        return Cell::Missing;
    }
    text.parse().map_or_else(|_| Cell::Text(text.to_owned()), Cell::Number)
}

/// Rows of a CSV table; the first line names the columns, and every other line is a row.
pub struct CsvSource<R> {
    lines: Lines<R>,
    columns: Columns,
    /// Number of columns, those that are passed over too.
    width: usize,
    row: u64,
}

impl<R: Read> CsvSource<R> {
    /// Reads the names of the columns.
    ///
    /// # Errors
    ///
    /// [`TableError`] if they are not those of inputs or of `keep`.
    pub fn new(reader: R, keep: &[String]) -> Result<Self, TableError> {
        let mut lines = Lines::new(reader);
        let header = lines.next()?.ok_or(TableError::NoHeader)?;
        let sorted = split(header, 1).and_then(|names| {
            let columns = Columns::sort(names.iter().map(AsRef::as_ref), keep)?;
            Ok((columns, names.len()))
        });
        let (columns, width) = sorted.map_err(|error| {
            let separator = header.chars().find(|c| [';', '\t', '|'].contains(c));
            match separator.filter(|_| !header.contains(',')) {
                Some(separator) => TableError::Separator { separator },
                None => error,
            }
        })?;
        Ok(Self { lines, columns, width, row: 0 })
    }
}

/// The cells of a line of CSV. A cell that begins with a quote ends with one, may hold commas, and
/// quotes twice; no other cell holds a quote. So no quote that is forgotten or one too many can join
/// cells or lines.
fn split(text: &str, line: u64) -> Result<Vec<Cow<'_, str>>, TableError> {
    if memchr::memchr(b'"', text.as_bytes()).is_none() {
        return Ok(text.split(',').map(Cow::Borrowed).collect());
    }
    let mut cells = Vec::new();
    let mut rest = Some(text);
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
            if !(after.is_empty() || after.starts_with(',')) {
                return Err(TableError::StrayQuote { line });
            }
            (Cow::Owned(cell.replace("\"\"", "\"")), after.strip_prefix(','))
        } else {
            let (cell, after) = match text.split_once(',') {
                Some((cell, after)) => (cell, Some(after)),
                None => (text, None),
            };
            if cell.contains('"') {
                return Err(TableError::StrayQuote { line });
            }
            (Cow::Borrowed(cell), after)
        };
        cells.push(cell);
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
        let mut text = 0;
        while chunk.len < rows && text < TEXT {
            let line = self.lines.number() + 1;
            let Some(row) = self.lines.next()? else { break };
            let mut cells = split(row, line)?;
            if cells.len() != self.width {
                let (found, columns) = (cells.len(), self.width);
                return Err(TableError::Ragged { line, found, columns });
            }
            text += row.len();
            for (values, place) in chunk.inputs.iter_mut().zip(&self.columns.input_places) {
                values.push(parse(&cells[*place]));
            }
            for (texts, place) in chunk.kept.iter_mut().zip(&self.columns.kept_places) {
                texts.push(mem::take(&mut cells[*place]).into_owned());
            }
            chunk.len += 1;
        }
        self.row += chunk.len as u64;
        Ok(chunk.filled())
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
    /// # Errors
    ///
    /// [`TableError`] if it is no object, or has keys that are neither inputs nor in `keep`.
    pub fn new(reader: R, keep: &[String]) -> Result<Self, TableError> {
        let mut lines = Lines::new(reader);
        let (first, _) = object(&mut lines)?.ok_or(TableError::NoHeader)?;
        let columns = Columns::sort(first.iter().map(|(key, _)| key.as_str()), keep)?;
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
            for (cells, name) in chunk.kept.iter_mut().zip(&self.columns.kept) {
                cells.push(match object.remove(name) {
                    None | Some(Value::Null) => String::new(),
                    Some(Value::String(text)) => text,
                    Some(other) => other.to_string(),
                });
            }
            if let Some(name) = object.keys().find(|name| !is_answer(name)) {
                let reason = format!("`{}` is not in the first line", brief(name));
                return Err(TableError::Json { line: self.lines.number(), reason });
            }
            chunk.len += 1;
            text += length;
        }
        self.row += chunk.len as u64;
        Ok(chunk.filled())
    }
}

/// CSV with the columns of the source, then model, status, message and outputs.
pub struct CsvSink<W: Write> {
    writer: csv::Writer<W>,
    outputs: Vec<&'static Output>,
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
        let mut writer = csv::Writer::from_writer(writer);
        let kept = columns.kept.iter().map(String::as_str);
        let names = kept.chain(columns.inputs.iter().map(|key| key.name()));
        writer.write_record(names.chain(ANSWERS).chain(outputs.iter().map(|o| o.name)))?;
        Ok(Self { writer, outputs: outputs.to_vec() })
    }

    /// The writer, all rows written.
    ///
    /// # Errors
    ///
    /// [`TableError::Io`].
    pub fn finish(self) -> Result<W, TableError> {
        self.writer.into_inner().map_err(|e| TableError::Io(e.into_error()))
    }
}

impl<W: Write> Sink for CsvSink<W> {
    fn write(&mut self, chunk: Chunk, answers: Answers) -> Result<(), TableError> {
        let mut digits = Vec::new();
        for (row, verdict) in answers.verdicts.iter().enumerate() {
            for texts in &chunk.kept {
                self.writer.write_field(&texts[row])?;
            }
            for column in &chunk.inputs {
                match column.cell(row) {
                    Cell::Missing => self.writer.write_field("")?,
                    Cell::Number(value) => {
                        digits.clear();
                        write_exact(&mut digits, value)?;
                        self.writer.write_field(&digits)?;
                    }
                    Cell::Text(text) => self.writer.write_field(text)?,
                }
            }
            self.writer.write_field(verdict.model.name())?;
            self.writer.write_field(verdict.status.name())?;
            self.writer.write_field(answers.message(row).unwrap_or_default())?;
            for (output, column) in self.outputs.iter().zip(&answers.columns) {
                digits.clear();
                match json(output, column[row]) {
                    Value::Null => {}
                    Value::Number(number) if number.is_f64() => {
                        write_exact(&mut digits, column[row])?;
                    }
                    value => write!(digits, "{value}")?,
                }
                self.writer.write_field(&digits)?;
            }
            self.writer.write_record(None::<&[u8]>)?;
        }
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
        for (row, verdict) in answers.verdicts.iter().enumerate() {
            let mut line = Map::new();
            for (name, texts) in self.columns.kept.iter().zip(&chunk.kept) {
                line.insert(name.clone(), json!(texts[row]));
            }
            for (key, column) in self.columns.inputs.iter().zip(&chunk.inputs) {
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
            for (output, column) in self.outputs.iter().zip(&answers.columns) {
                line.insert(output.name.to_owned(), json(output, column[row]));
            }
            writeln!(self.writer, "{}", Value::Object(line))?;
        }
        Ok(())
    }
}
