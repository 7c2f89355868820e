//! Validation of the program by comparison with published results.
//!
//! The published data and their sources are in `validation/published/<key>`. The data are compiled
//! into the program, but can also be read from a copy of this folder. Every check states the
//! published claim, the calculated result, and the reason for its tolerance. Golden files are not
//! part of this crate, because they only detect changes of results and validate nothing.
//!
//! [`run`] runs all checks.

mod dong2020;
mod elastic;
mod figures;
mod groove;
mod lin1994;
mod lubrication;
mod nut;
mod pages;
mod published;
mod ratings;
mod reference;
mod report;
mod table;
pub mod tradeoff;
mod trends;
mod xu2015;

pub use figures::figures;
pub use pages::{tradeoff_page, validation_page};
pub use published::PublishedData;
pub use report::{Check, Report, ReportJson, Verdict};

use std::fmt::Display;

/// Reason why a validation or a measurement of speed and accuracy cannot be carried out.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ValidateError {
    /// Published data or a table of points is invalid.
    #[error("{0}")]
    Invalid(String),
    /// The operating point of a check is invalid.
    #[error("invalid operating point of a check: {0}")]
    Point(#[from] bsm_case::CaseError),
    /// A file with published data cannot be read.
    #[error("{}: {error}", path.display())]
    File {
        /// Path of the file.
        path: std::path::PathBuf,
        /// Error of the operating system.
        error: std::io::Error,
    },
    /// A figure or an HTML page cannot be created.
    #[error(transparent)]
    Report(#[from] bsm_report::ReportError),
    /// A table of points cannot be read.
    #[error(transparent)]
    Table(#[from] bsm_batch::TableError),
    /// None of the points has a reference solution.
    #[error("model traction has no solution at any of the points, so there is no reference")]
    NoReference,
    /// The operating system did not start the threads.
    #[error("cannot start threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// A numerical search for a minimum or a root failed.
    #[error("a numerical search failed: {0}")]
    Search(#[from] bsm_design::search::SearchError),
}

impl ValidateError {
    /// Creates the error for an invalid file, check or table row. The argument `place` names the
    /// invalid item.
    fn of(place: impl Display, why: impl Display) -> Self {
        Self::Invalid(format!("{place}: {why}"))
    }
}

/// Runs all checks against the published data.
///
/// # Errors
///
/// Returns [`ValidateError`] if the published data are invalid. A failed check is not an error, but
/// is reported in the result.
pub fn run(published: &PublishedData) -> Result<Report, ValidateError> {
    let mut checks = reference::checks(published)?;
    checks.extend(lin1994::checks(published)?);
    checks.extend(elastic::checks(published)?);
    checks.extend(ratings::checks(published)?);
    checks.extend(groove::checks(published)?);
    checks.extend(nut::checks(published)?);
    checks.extend(xu2015::checks(published)?);
    checks.extend(dong2020::checks(published)?);
    checks.extend(lubrication::checks(published)?);
    checks.extend(table::checks(published)?);
    Ok(Report { checks })
}
