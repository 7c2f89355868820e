//! Tables as text: CSV and JSON Lines.

use std::io::{self, BufRead, Read, Write};

use bsm_case::{CaseError, Output, brief, entries};
use serde_json::{Map, Value, json};

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

/// Bytes that a row may have: a quote that is not closed must not take the whole table.
const LONGEST: u64 = 16 << 20;

/// A reader that ends a row that is too long.
struct Limited<R> {
    reader: R,
    /// What the row may still take.
    left: u64,
}

impl<R: Read> Read for Limited<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.left == 0 {
            return Err(io::ErrorKind::FileTooLarge.into());
        }
        let read = self.reader.read(buffer)?;
        self.left = self.left.saturating_sub(read as u64);
        Ok(read)
    }
}

/// Rows of a CSV table; the first row names the columns.
pub struct CsvSource<R> {
    reader: csv::Reader<Limited<R>>,
    columns: Columns,
    row: u64,
}

impl<R: Read> CsvSource<R> {
    /// Reads the names of the columns.
    ///
    /// # Errors
    ///
    /// [`TableError`] if they are not those of inputs or of `keep`.
    pub fn new(reader: R, keep: &[String]) -> Result<Self, TableError> {
        let limited = Limited { reader, left: LONGEST };
        let reader = csv::ReaderBuilder::new().from_reader(limited);
        let mut source = Self { reader, columns: Columns::default(), row: 0 };
        let header = source.reader.headers().cloned();
        let header = header.map_err(|e| source.wrong(e, 0))?;
        if header.is_empty() {
            return Err(TableError::NoHeader);
        }
        // Some programs begin a file with a byte order mark.
        let names = header.iter().map(|name| name.trim_start_matches('\u{feff}'));
        source.columns = Columns::sort(names, keep).map_err(|error| match &header[0] {
            one if header.len() == 1 => {
                let separator = one.chars().find(|c| [';', '\t', '|', '\0'].contains(c));
                separator.map_or(error, |separator| TableError::Separator { separator })
            }
            _ => error,
        })?;
        Ok(source)
    }

    fn wrong(&self, error: csv::Error, row: u64) -> TableError {
        match self.reader.get_ref().left {
            0 => TableError::LongRow { row, most: LONGEST },
            _ => error.into(),
        }
    }
}

impl<R: Read + Send> Source for CsvSource<R> {
    fn columns(&self) -> &Columns {
        &self.columns
    }

    fn next(&mut self, rows: usize) -> Result<Option<Chunk>, TableError> {
        let mut chunk = Chunk::empty(self.row + 1, &self.columns, rows);
        let mut record = csv::StringRecord::new();
        let mut text = 0;
        while chunk.len < rows && text < TEXT {
            self.reader.get_mut().left = LONGEST;
            let row = chunk.first + chunk.len as u64;
            if !self.reader.read_record(&mut record).map_err(|e| self.wrong(e, row))? {
                break;
            }
            for (cells, place) in chunk.inputs.iter_mut().zip(&self.columns.input_places) {
                cells.push(parse(&record[*place]));
            }
            for (cells, place) in chunk.kept.iter_mut().zip(&self.columns.kept_places) {
                cells.push(record[*place].to_owned());
            }
            chunk.len += 1;
            text += record.as_slice().len();
        }
        self.row += chunk.len as u64;
        Ok(chunk.filled())
    }
}

/// Rows of JSON Lines: one object a line; the first one names the columns, a later one may leave
/// some out.
pub struct JsonSource<R> {
    reader: R,
    line: Vec<u8>,
    first: Option<Vec<(String, Value)>>,
    columns: Columns,
    row: u64,
}

impl<R: BufRead> JsonSource<R> {
    /// Reads the first line.
    ///
    /// # Errors
    ///
    /// [`TableError`] if it is no object, or has keys that are neither inputs nor in `keep`.
    pub fn new(reader: R, keep: &[String]) -> Result<Self, TableError> {
        let columns = Columns::default();
        let mut source = Self { reader, line: Vec::new(), first: None, columns, row: 0 };
        let first = source.object()?.ok_or(TableError::NoHeader)?;
        source.columns = Columns::sort(first.iter().map(|(key, _)| key.as_str()), keep)?;
        source.first = Some(first);
        source.row = 0;
        Ok(source)
    }

    /// The next object; empty lines are skipped.
    fn object(&mut self) -> Result<Option<Vec<(String, Value)>>, TableError> {
        if let Some(first) = self.first.take() {
            self.row += 1;
            return Ok(Some(first));
        }
        loop {
            self.line.clear();
            let read = self.reader.by_ref().take(LONGEST).read_until(b'\n', &mut self.line)? as u64;
            if read == 0 {
                return Ok(None);
            }
            if read == LONGEST {
                return Err(TableError::LongRow { row: self.row + 1, most: LONGEST });
            }
            return match entries(&self.line) {
                Err(CaseError::Empty) => continue,
                Ok(object) => {
                    self.row += 1;
                    Ok(Some(object))
                }
                Err(e) => Err(TableError::Json { row: self.row + 1, reason: e.to_string() }),
            };
        }
    }
}

impl<R: BufRead + Send> Source for JsonSource<R> {
    fn columns(&self) -> &Columns {
        &self.columns
    }

    fn next(&mut self, rows: usize) -> Result<Option<Chunk>, TableError> {
        let mut chunk = Chunk::empty(self.row + 1, &self.columns, rows);
        let mut text = 0;
        while chunk.len < rows && text < TEXT {
            let Some(object) = self.object()? else { break };
            let mut object: Map<String, Value> = object.into_iter().collect();
            for (cells, name) in chunk.inputs.iter_mut().zip(&self.columns.inputs) {
                cells.push(match object.remove(*name) {
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
                // A key that the first row does not have.
                let reason = format!("`{}` is not in the first row", brief(name));
                return Err(TableError::Json { row: self.row, reason });
            }
            chunk.len += 1;
            text += self.line.len();
        }
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
        let names = kept.chain(columns.inputs.iter().copied());
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
                        write!(digits, "{value}")?;
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
                    value => serde_json::to_writer(&mut digits, &value).map_err(io::Error::from)?,
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
            for (name, column) in self.columns.inputs.iter().zip(&chunk.inputs) {
                line.insert(
                    (*name).to_owned(),
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
