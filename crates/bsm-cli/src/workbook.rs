//! Tables as workbooks: rows below names and units, and a sheet that says what they are made from; the only file
//! that names the library.

use std::sync::atomic::Ordering;
use std::{env, io};

use bsm_batch::{Answers, Cell, Chunk, Columns, Sink, TableError, caught};
use bsm_case::Output;
use rust_xlsxwriter::{Format, Workbook as Book, Worksheet, XlsxError};
use serde_json::Value;

use crate::files::FILE_TOO_LARGE;

/// Rows that a sheet has below names and units.
pub(crate) const MOST_ROWS: u64 = 1_048_574;

/// Width of a column in letters, at least and at most.
const WIDTHS: (u16, u16) = (10, 40);

/// A workbook that is being written, a row after the other; what is written is not held in memory.
pub(crate) struct Workbook {
    book: Book,
    row: u32,
    outputs: Vec<&'static Output>,
}

/// A cell.
pub(crate) enum Entry<'a> {
    Nothing,
    Number(f64),
    Text(&'a str),
    Flag(bool),
}

impl Workbook {
    /// A sheet with the names of the columns, and their units below.
    pub(crate) fn new<'a>(
        headings: impl Iterator<Item = (&'a str, &'a str)>,
    ) -> Result<Self, TableError> {
        let mut book = Book::new();
        let sheet = book.add_worksheet_with_constant_memory().map_err(|e| failed(&e))?;
        let bold = Format::new().set_bold();
        let written = || -> Result<(), XlsxError> {
            sheet.set_name("table")?.set_freeze_panes(2, 0)?;
            let headings: Vec<_> = headings.collect();
            for (column, (name, _)) in (0..).zip(&headings) {
                let letters = u16::try_from(name.len()).unwrap_or(WIDTHS.1);
                sheet.set_column_width(column, letters.clamp(WIDTHS.0, WIDTHS.1))?;
                sheet.write_string_with_format(0, column, *name, &bold)?;
            }
            for (column, (_, unit)) in (0..).zip(&headings) {
                sheet.write_string(1, column, *unit)?;
            }
            Ok(())
        };
        written().map_err(|e| failed(&e))?;
        Ok(Self { book, row: 2, outputs: Vec::new() })
    }

    /// A table of answers.
    pub(crate) fn of_answers(
        columns: &Columns,
        outputs: &[&'static Output],
    ) -> Result<Self, TableError> {
        let headings: Vec<_> = columns.headings(outputs).collect();
        let this = Self::new(headings.iter().map(|heading| (heading.name, heading.unit)))?;
        Ok(Self { outputs: outputs.to_vec(), ..this })
    }

    /// Writes a row.
    pub(crate) fn row<'a>(
        &mut self,
        entries: impl Iterator<Item = Entry<'a>>,
    ) -> Result<(), TableError> {
        if u64::from(self.row) >= MOST_ROWS + 2 {
            return Err(TableError::Io(io::Error::other(too_many("more"))));
        }
        let row = self.row;
        written(|| {
            let sheet = self.book.worksheet_from_index(0)?;
            (0..).zip(entries).try_for_each(|(column, entry)| write(sheet, row, column, &entry))
        })?;
        self.row += 1;
        Ok(())
    }

    /// The bytes of the file.
    ///
    /// * `about`: what the table is made from; a sheet of its own.
    pub(crate) fn finish(mut self, about: &Value) -> Result<Vec<u8>, TableError> {
        let mut leaves = Vec::new();
        flatten(String::new(), about, &mut leaves);
        written(|| {
            let sheet = self.book.add_worksheet();
            sheet.set_name("about")?.set_column_width(0, WIDTHS.1)?;
            for (row, (name, leaf)) in (0..).zip(leaves) {
                sheet.write_string(row, 0, name)?;
                match leaf {
                    Value::Number(number) => {
                        sheet.write_number(row, 1, number.as_f64().unwrap_or(f64::NAN))?
                    }
                    Value::Null => continue,
                    Value::String(text) => sheet.write_string(row, 1, text)?,
                    other => sheet.write_string(row, 1, other.to_string())?,
                };
            }
            self.book.save_to_buffer()
        })
    }
}

/// What the library writes; it panics where the temporary file that it holds rows in has no room.
fn written<T>(write: impl FnOnce() -> Result<T, XlsxError>) -> Result<T, TableError> {
    let done = caught(write).ok_or_else(|| {
        // The end of a write beyond `ulimit -f` is told here.
        FILE_TOO_LARGE.store(true, Ordering::Relaxed);
        let folder = env::temp_dir();
        let text = format!("no room for a temporary file in {} (TMPDIR)", folder.display());
        TableError::Io(io::Error::other(text))
    })?;
    done.map_err(|e| failed(&e))
}

impl Sink for Workbook {
    fn write(&mut self, chunk: Chunk, answers: Answers) -> Result<(), TableError> {
        let (outputs, kept) = (self.outputs.clone(), chunk.kept_values()?);
        for row in 0..chunk.len {
            let inputs: Vec<_> = chunk.inputs.iter().map(|column| column.cell(row)).collect();
            let inputs = inputs.iter().map(|cell| match cell {
                Cell::Missing => Entry::Nothing,
                Cell::Number(value) => Entry::Number(*value),
                Cell::Text(text) => Entry::Text(text),
            });
            let verdict = answers.verdicts[row];
            let message = answers.message(row).map_or(Entry::Nothing, Entry::Text);
            let verdict =
                [Entry::Text(verdict.model.name()), Entry::Text(verdict.status.name()), message];
            let outputs = outputs.iter().zip(&answers.columns).map(|(output, column)| {
                match (output.json_type, column[row]) {
                    (_, value) if value.is_nan() => Entry::Nothing,
                    ("boolean", value) => Entry::Flag(value > 0.5),
                    ("string", value) => output.word(value).map_or(Entry::Nothing, Entry::Text),
                    (_, value) => Entry::Number(value),
                }
            });
            let kept = kept.iter().map(|values| match &values[row] {
                Value::Null => Entry::Nothing,
                Value::Number(number) => Entry::Number(number.as_f64().unwrap_or(f64::NAN)),
                Value::Bool(yes) => Entry::Flag(*yes),
                other => Entry::Text(other.as_str().unwrap_or_default()),
            });
            self.row(kept.chain(inputs).chain(verdict).chain(outputs))?;
        }
        Ok(())
    }
}

/// Why a table does not go into a sheet.
pub(crate) fn too_many(rows: &str) -> String {
    format!("a sheet has {MOST_ROWS} rows, and this table has {rows}; write .csv or .parquet")
}

fn write(sheet: &mut Worksheet, row: u32, column: u16, entry: &Entry<'_>) -> Result<(), XlsxError> {
    match entry {
        Entry::Nothing => return Ok(()),
        // A sheet has no sign for what is not finite.
        Entry::Number(value) if !value.is_finite() => return Ok(()),
        Entry::Number(value) => sheet.write_number(row, column, *value)?,
        Entry::Text(text) => sheet.write_string(row, column, *text)?,
        Entry::Flag(yes) => sheet.write_boolean(row, column, *yes)?,
    };
    Ok(())
}

/// The leaves of a value with the names of all above them.
fn flatten<'a>(name: String, value: &'a Value, to: &mut Vec<(String, &'a Value)>) {
    let below = |key: &str| if name.is_empty() { key.to_owned() } else { format!("{name}.{key}") };
    match value {
        Value::Object(map) => map.iter().for_each(|(key, value)| flatten(below(key), value, to)),
        leaf => to.push((name, leaf)),
    }
}

fn failed(error: &XlsxError) -> TableError {
    TableError::Io(io::Error::other(error.to_string()))
}
