//! Tables as Excel workbooks: a sheet with column names, units and rows, and a sheet that describes
//! the origin of the table. Only this module uses the workbook library.

use std::sync::atomic::Ordering;
use std::{env, io};

use bsm_batch::{
    AnswerSink, Answers, Cell, Chunk, ColumnUnits, Columns, RowCells, TableError, catch_panic,
    unit_of,
};
use bsm_case::Output;
use rust_xlsxwriter::{Format, Workbook as Book, Worksheet, XlsxError};
use serde_json::{Number, Value};

use crate::unfinished::FILE_TOO_LARGE;

/// Maximum number of data rows in a sheet, not counting the rows with names and units.
pub(crate) const MAX_ROWS: u64 = 1_048_574;

/// Minimum and maximum column width \[characters\].
const WIDTHS: (u16, u16) = (10, 40);

/// A workbook that is written row by row. Written rows are not held in memory.
pub(crate) struct Workbook {
    book: Book,
    row: u32,
    columns: Columns,
    units: ColumnUnits,
    outputs: Vec<&'static Output>,
}

impl Workbook {
    /// Starts a sheet with the column names in the first row and the units in the second row.
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
        let (columns, units) = (Columns::default(), ColumnUnits::default());
        Ok(Self { book, row: 2, columns, units, outputs: Vec::new() })
    }

    /// Starts a sheet for a table of results.
    pub(crate) fn of_answers(
        units: &ColumnUnits,
        columns: &Columns,
        outputs: &[&'static Output],
    ) -> Result<Self, TableError> {
        let schema = units.schema(columns, outputs);
        let fields = schema.fields().iter();
        let this = Self::new(fields.map(|field| (field.name().as_str(), unit_of(field))))?;
        let (columns, units) = (columns.clone(), units.clone());
        Ok(Self { columns, units, outputs: outputs.to_vec(), ..this })
    }

    /// Writes one row of cells to the sheet.
    pub(crate) fn row<'a>(
        &mut self,
        entries: impl Iterator<Item = Cell<'a>>,
    ) -> Result<(), TableError> {
        if u64::from(self.row) >= MAX_ROWS + 2 {
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

    /// Completes the workbook and returns the bytes of its file.
    ///
    /// * `about`: description of the table's origin, which is written to a separate sheet.
    pub(crate) fn finish(mut self, about: &Value) -> Result<Vec<u8>, TableError> {
        let mut leaves = Vec::new();
        flatten(String::new(), about, &mut leaves);
        written(|| {
            let sheet = self.book.add_worksheet();
            sheet.set_name("about")?.set_column_width(0, WIDTHS.1)?;
            for (row, (name, leaf)) in (0..).zip(leaves) {
                sheet.write_string(row, 0, name)?;
                match leaf {
                    Value::Number(number) => write_digits(sheet, row, 1, number)?,
                    Value::Null => continue,
                    Value::String(text) => sheet.write_string(row, 1, text)?,
                    other => sheet.write_string(row, 1, other.to_string())?,
                };
            }
            self.book.save_to_buffer()
        })
    }
}

/// Calls the workbook library and converts its panics to errors. The library panics if there is no
/// disk space for its temporary file.
fn written<T>(write: impl FnOnce() -> Result<T, XlsxError>) -> Result<T, TableError> {
    let done = catch_panic(write).ok_or_else(|| {
        // The temporary file may exceed the limit of `ulimit -f`. The flag prevents the signal from
        // ending the program before this error is reported.
        FILE_TOO_LARGE.store(true, Ordering::Relaxed);
        let folder = env::temp_dir();
        let text =
            format!("not enough space for a temporary file in {} (TMPDIR)", folder.display());
        TableError::Io(io::Error::other(text))
    })?;
    done.map_err(|e| failed(&e))
}

impl AnswerSink for Workbook {
    fn write(&mut self, chunk: Chunk, answers: Answers) -> Result<(), TableError> {
        let schema = self.units.schema(&self.columns, &self.outputs);
        let table = answers.table(&chunk, &schema, &self.outputs)?;
        let cells = RowCells::of(&table, &chunk)?;
        (0..chunk.len).try_for_each(|row| self.row(cells.row(row)))
    }
}

/// Returns the message that a table has too many rows for a sheet.
pub(crate) fn too_many(rows: &str) -> String {
    format!(
        "a sheet has at most {MAX_ROWS} rows, but this table has {rows}; write .csv or .parquet"
    )
}

fn write(sheet: &mut Worksheet, row: u32, column: u16, entry: &Cell<'_>) -> Result<(), XlsxError> {
    match entry {
        Cell::Missing => return Ok(()),
        // Spreadsheets cannot represent NaN or infinity.
        Cell::Number(value) if !value.is_finite() => return Ok(()),
        Cell::Number(value) => sheet.write_number(row, column, *value)?,
        Cell::Digits(number) => write_digits(sheet, row, column, number)?,
        Cell::Text(text) => sheet.write_string(row, column, *text)?,
        Cell::Flag(yes) => sheet.write_boolean(row, column, *yes)?,
    };
    Ok(())
}

/// Largest magnitude up to which doubles represent every integer exactly. Spreadsheets store all
/// numbers as doubles.
const MAX_EXACT_INTEGER: u64 = 1 << f64::MANTISSA_DIGITS;

/// Writes a number. An integer that a spreadsheet would round is written as text.
fn write_digits<'a>(
    sheet: &'a mut Worksheet,
    row: u32,
    column: u16,
    number: &Number,
) -> Result<&'a mut Worksheet, XlsxError> {
    let magnitude = number.as_u64().or_else(|| number.as_i64().map(i64::unsigned_abs));
    match number.as_f64() {
        Some(value) if magnitude.is_none_or(|whole| whole <= MAX_EXACT_INTEGER) => {
            sheet.write_number(row, column, value)
        }
        _ => sheet.write_string(row, column, number.to_string()),
    }
}

/// Collects the leaf values of a JSON value. The name of a leaf contains the names of all its
/// parents.
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
