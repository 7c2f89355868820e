//! Tables of nuts from a manufacturer's list.

use bsm_case::{ManufacturerRow, exact};

use crate::ReportError;
use crate::figure::text_of_table;

/// Returns the rows of a manufacturer's list as CSV. Additional columns contain the bounds of the
/// intervals.
///
/// # Errors
///
/// [`ReportError::Table`] if the table cannot be written.
pub fn manufacturers_table(rows: &[ManufacturerRow]) -> Result<String, ReportError> {
    let columns = ManufacturerRow::columns(rows);
    let mut table = csv::Writer::from_writer(Vec::new());
    let names = columns.iter().map(|(name, ..)| name.as_str());
    table.write_record(std::iter::once("nut").chain(names).chain(["passes", "groove"]))?;
    for (place, row) in rows.iter().enumerate() {
        let cell = |value: f64| if value.is_nan() { String::new() } else { exact(value) };
        let numbers = columns.iter().map(|(.., values)| cell(values[place]));
        let passes = row.passes.map_or_else(String::new, |passes| passes.to_string());
        let groove = row.groove.as_deref().unwrap_or("given").to_owned();
        table.write_record(
            std::iter::once(row.name.clone()).chain(numbers).chain([passes, groove]),
        )?;
    }
    text_of_table(table)
}
