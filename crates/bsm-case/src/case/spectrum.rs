//! Loads that change, as a table.

use bsm_design::Duty;

use crate::CaseError;
use crate::vocabulary::cells::Cells;
use crate::vocabulary::units::RPM;

/// The columns of a spectrum.
const COLUMNS: [&str; 3] = ["axial_load_N", "screw_speed_rpm", "time_share"];

/// Axial load, speed and time of the stretches of a duty.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum(pub(crate) Vec<Duty>);

impl Spectrum {
    /// Reads a CSV table with the columns `axial_load_N`, `screw_speed_rpm` and `time_share`.
    ///
    /// The speed is that of the screw against the nut. Shares of time need not sum up to one.
    ///
    /// # Errors
    ///
    /// [`CaseError::Table`] with the row, if a value is missing, no finite number, or a negative
    /// time, or nothing ever turns, or with the line of a quote, which neither numbers nor the names
    /// of the columns need: none can join numbers or rows.
    pub fn from_csv(table: &[u8]) -> Result<Self, CaseError> {
        let quote = |line: &[u8]| line.contains(&b'"');
        if let Some(lines) = table.split(|byte| *byte == b'\n').position(quote) {
            let what = format!("line {} has a quote; take the quotes out", lines + 1);
            return Err(CaseError::Table { what });
        }
        let wrong = |what: &str| {
            let what = format!("{what}; the columns are {}", COLUMNS.join(", "));
            CaseError::Table { what }
        };
        let cells = Cells::read(table, b',', '.')?;
        let places = cells.columns(|head| {
            let known = COLUMNS.iter().position(|column| *column == head);
            known.ok_or_else(|| wrong(&format!("unknown field `{head}`")))
        })?;
        let duty = cells.each(&places, |_, row| {
            let mut values = [None; 3];
            for (place, text) in row {
                values[*place] = Some(cells.number(text).map_err(|e| wrong(&e.to_string()))?);
            }
            let [Some(load), Some(rpm), Some(time)] = values else {
                return Err(wrong("a value is missing"));
            };
            if time < 0.0 {
                return Err(wrong(&format!("time_share = {time} must be >= 0")));
            }
            Ok(Duty { load, speed: rpm * RPM, time })
        })?;
        if duty.iter().all(|d| d.speed * d.time == 0.0) {
            return Err(wrong("nothing turns"));
        }
        Ok(Self(duty))
    }
}
