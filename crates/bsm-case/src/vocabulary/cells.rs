//! Tables that users provide, as column names and rows of cells.

use std::borrow::Cow;

use crate::vocabulary::column_values::ColumnValues;
use crate::vocabulary::lines::{Lines, OtherSeparator, TextError, check_width, split};
use crate::vocabulary::names::GivenNames;
use crate::vocabulary::units::UnitChange;
use crate::{CaseError, TableFormat};

/// Name of the quantity in a column, and the conversion to the unit of this quantity.
pub(crate) type NamedColumn = (&'static str, UnitChange);

/// A table in text form, as read from a file.
pub(crate) struct Cells {
    heads: Vec<String>,
    rows: Vec<Vec<String>>,
    decimal: char,
}

impl Cells {
    /// Reads a table with at least one row.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError::Invalid`] with the number of the line that cannot be read, and
    /// [`CaseError::Separator`] if the columns are separated by an unexpected character.
    pub(crate) fn read(table: &[u8], format: &TableFormat) -> Result<Self, CaseError> {
        let wrong = |error: TextError| CaseError::Invalid(error.to_string());
        let mut lines = Lines::new(table);
        let mut rows: Vec<Vec<String>> = Vec::new();
        loop {
            let (line, mut row) = (lines.number() + 1, Vec::new());
            let Some(text) = lines.next_line().map_err(wrong)? else { break };
            let other = OtherSeparator::of(text, format.delimiter);
            if let Some(other) = other.filter(|_| rows.is_empty()) {
                return Err(CaseError::Separator(other));
            }
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

    /// Returns the names of the columns.
    pub(crate) fn heads(&self) -> &[String] {
        &self.heads
    }

    /// Returns the quantity in each column and the conversion to the unit of this quantity, or
    /// `None` for a column that is ignored. Two columns must not contain the same quantity.
    ///
    /// * `column`: function that returns the quantity in the column with a given name.
    ///
    /// # Errors
    /// Returns the same errors as `column`, and [`CaseError::Entry`] if two columns contain the
    /// same quantity.
    pub(crate) fn columns(
        &self,
        column: impl Fn(&str) -> Result<Option<NamedColumn>, CaseError>,
    ) -> Result<Vec<Option<NamedColumn>>, CaseError> {
        let mut given = GivenNames::default();
        let read = |head: &String| {
            let found = column(head)?;
            if let Some((quantity, _)) = found {
                given.add(quantity, head)?;
            }
            Ok(found)
        };
        self.heads.iter().map(read).collect()
    }

    /// Returns the columns whose name satisfies `wanted`, with all their cells. A column is numeric
    /// if none of its cells contains text that is not a number.
    ///
    /// * `wanted`: function that decides whether a column is returned. Its arguments are the name
    ///   of the column, and whether at least one cell contains text that is not a number.
    pub(crate) fn kept(&self, wanted: impl Fn(&str, bool) -> bool) -> Vec<(String, ColumnValues)> {
        let column = |place: usize| {
            let cells = || self.rows.iter().map(|row| row[place].as_str());
            let number = |cell: &str| match cell {
                "" => Some(f64::NAN),
                cell => self.number(cell).ok(),
            };
            match cells().map(number).collect() {
                Some(numbers) => ColumnValues::Numbers(numbers),
                None => ColumnValues::Texts(
                    cells().map(|cell| (!cell.is_empty()).then(|| cell.to_owned())).collect(),
                ),
            }
        };
        let columns = self.heads.iter().enumerate().map(|(place, head)| (head, column(place)));
        let kept =
            columns.filter(|(head, values)| wanted(head, matches!(values, ColumnValues::Texts(_))));
        kept.map(|(head, values)| (head.clone(), values)).collect()
    }

    /// Calls a function once per row with the cells of the row that are neither empty nor in an
    /// ignored column.
    pub(crate) fn each<R>(
        &self,
        columns: &[Option<NamedColumn>],
        make: impl Fn(usize, &mut dyn Iterator<Item = (NamedColumn, &str)>) -> Result<R, CaseError>,
    ) -> Result<Vec<R>, CaseError> {
        let row = |(row, cells): (usize, &Vec<String>)| {
            let cells = columns.iter().zip(cells.iter().map(String::as_str));
            let cells = cells.filter(|(_, text)| !text.is_empty());
            let mut read = cells.filter_map(|(column, text)| Some(((*column)?, text)));
            make(row, &mut read).map_err(|e| e.in_row(row))
        };
        (1..).zip(&self.rows).map(row).collect()
    }

    /// Parses the number in a cell.
    pub(crate) fn number(&self, text: &str) -> Result<f64, CaseError> {
        decimal_number(text, self.decimal).ok_or_else(|| {
            let is_other =
                |sign: char| sign != self.decimal && decimal_number(text, sign).is_some();
            let hint = match (is_other(','), is_other('.')) {
                (true, _) => "; for decimal commas, add --decimal comma",
                (_, true) => "; for decimal points, add --decimal point",
                _ => "",
            };
            CaseError::Invalid(format!("`{text}` is not a number{hint}"))
        })
    }
}

/// Parses a number with the given decimal sign. Returns `None` if the text contains the other
/// decimal sign (point or comma).
pub fn decimal_number(text: &str, decimal: char) -> Option<f64> {
    let other = if decimal == ',' { '.' } else { ',' };
    if text.contains(other) {
        return None;
    }
    text.replace(decimal, ".").parse().ok().filter(|value: &f64| value.is_finite())
}
