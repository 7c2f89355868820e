//! Loads that change, as a table.

use bsm_design::Duty;
use serde::Deserialize;

use crate::CaseError;
use crate::units::RPM;

/// The columns of a spectrum, for messages.
const COLUMNS: &str = "axial_load_N (negative: the other direction), screw_speed_rpm, time_share";

/// Axial load, speed and time of the stretches of a duty.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum(pub(crate) Vec<Duty>);

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(non_snake_case, reason = "names of the columns")]
struct Row {
    axial_load_N: f64,
    screw_speed_rpm: f64,
    time_share: f64,
}

impl Spectrum {
    /// Reads a CSV table with the columns `axial_load_N`, `screw_speed_rpm` and `time_share`.
    ///
    /// The speed is that of the screw against the nut. Shares of time need not sum up to one.
    ///
    /// # Errors
    ///
    /// [`CaseError::Spectrum`] with the row, if a value is missing, no finite number, or a negative
    /// time, or nothing ever turns, or with the line of a quote, which neither numbers nor the names
    /// of the columns need: none can join numbers or rows.
    pub fn from_csv(table: &[u8]) -> Result<Self, CaseError> {
        let quote = |line: &[u8]| line.contains(&b'"');
        if let Some(lines) = table.split(|byte| *byte == b'\n').position(quote) {
            let what = format!("line {} has a quote; take the quotes out", lines + 1);
            return Err(CaseError::Spectrum { what });
        }
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(table);
        let mut duty = Vec::new();
        for (row, read) in (1_usize..).zip(reader.deserialize::<Row>()) {
            let wrong = |what: String| CaseError::Spectrum {
                what: format!("row {row}: {what}; the columns are {COLUMNS}"),
            };
            let Row { axial_load_N, screw_speed_rpm, time_share } = read.map_err(|e| {
                wrong(match e.kind() {
                    csv::ErrorKind::Deserialize { err, .. } => err.to_string(),
                    _ => e.to_string(),
                })
            })?;
            if ![axial_load_N, screw_speed_rpm, time_share].iter().all(|x| x.is_finite()) {
                return Err(wrong("all values must be finite".to_owned()));
            }
            if time_share < 0.0 {
                return Err(wrong(format!("time_share = {time_share} must be >= 0")));
            }
            duty.push(Duty { load: axial_load_N, speed: screw_speed_rpm * RPM, time: time_share });
        }
        if duty.is_empty() {
            let what = format!("has no rows; the columns are {COLUMNS}");
            return Err(CaseError::Spectrum { what });
        }
        if duty.iter().all(|d| d.speed * d.time == 0.0) {
            let what = format!("nothing turns; the columns are {COLUMNS}");
            return Err(CaseError::Spectrum { what });
        }
        Ok(Self(duty))
    }
}
