//! Tables that people give: names of columns, and rows of cells under them.

use std::borrow::Cow;

use crate::vocabulary::lines::{Lines, TextError, check_width, split};
use crate::{CaseError, TableFormat};

/// A table as it is written.
pub(crate) struct Cells {
    heads: Vec<String>,
    rows: Vec<Vec<String>>,
    decimal: char,
}

impl Cells {
    /// Reads a table of at least one row.
    ///
    /// # Errors
    ///
    /// [`CaseError::Invalid`] with the line.
    pub(crate) fn read(table: &[u8], format: &TableFormat) -> Result<Self, CaseError> {
        let wrong = |error: TextError| CaseError::Invalid(error.to_string());
        let mut lines = Lines::new(table);
        let mut rows: Vec<Vec<String>> = Vec::new();
        loop {
            let (line, mut row) = (lines.number() + 1, Vec::new());
            let Some(text) = lines.next_line().map_err(wrong)? else { break };
            let cell = |_, cell: Cow<'_, str>| row.push(cell.trim().to_owned());
            let found = split(text, format.delimiter, line, cell).map_err(wrong)?;
            check_width(found, rows.first().map_or(found, Vec::len), line).map_err(wrong)?;
            rows.push(row);
        }
        let heads = if rows.is_empty() { Vec::new() } else { rows.remove(0) };
        if rows.is_empty() {
            let what = format!("has no rows; the columns are {}", heads.join(", "));
            return Err(CaseError::Invalid(what));
        }
        Ok(Self { heads, rows, decimal: format.decimal })
    }

    /// Names of its columns.
    pub(crate) fn heads(&self) -> &[String] {
        &self.heads
    }

    /// Type of each column, by its name.
    pub(crate) fn columns<C>(
        &self,
        column: impl Fn(&str) -> Result<C, CaseError>,
    ) -> Result<Vec<C>, CaseError> {
        self.heads.iter().map(|head| column(head)).collect()
    }

    /// Result of each row, from its cells that are not empty.
    pub(crate) fn each<C, R>(
        &self,
        columns: &[C],
        make: impl Fn(usize, &mut dyn Iterator<Item = (&C, &str)>) -> Result<R, CaseError>,
    ) -> Result<Vec<R>, CaseError> {
        let row = |(row, cells): (usize, &Vec<String>)| {
            let cells = columns.iter().zip(cells.iter().map(String::as_str));
            make(row, &mut cells.filter(|(_, text)| !text.is_empty())).map_err(|e| e.in_row(row))
        };
        (1..).zip(&self.rows).map(row).collect()
    }

    /// The number of a cell.
    pub(crate) fn number(&self, text: &str) -> Result<f64, CaseError> {
        decimal_number(text, self.decimal)
            .ok_or_else(|| CaseError::Invalid(format!("`{text}` is not a number")))
    }
}

/// A number with a decimal sign of one's choice; one that has another sign too is none.
pub fn decimal_number(text: &str, decimal: char) -> Option<f64> {
    let other = if decimal == ',' { '.' } else { ',' };
    if text.contains(other) {
        return None;
    }
    text.replace(decimal, ".").parse().ok().filter(|value: &f64| value.is_finite())
}
