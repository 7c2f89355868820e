//! Validation: compares the program with published results.
//!
//! The published data and their sources are in `validation/published/<key>` and are compiled into
//! the program. A copy of the folder can be used instead. Every check states the published claim,
//! the calculated result, and the reason for its tolerance. Golden files only detect changes of
//! results. They validate nothing and are not part of this crate.

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

/// The reason why a validation or a trade-off measurement cannot be carried out.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ValidateError {
    /// Published data or a table of points is invalid.
    #[error("{0}")]
    Invalid(String),
    /// A check uses an invalid operating point.
    #[error("point of a check: {0}")]
    Point(#[from] bsm_case::CaseError),
    /// A file of published data cannot be read.
    #[error("{}: {error}", path.display())]
    File {
        /// Path of the file.
        path: std::path::PathBuf,
        /// Error of the operating system.
        error: std::io::Error,
    },
    /// A figure or a page cannot be created.
    #[error(transparent)]
    Report(#[from] bsm_report::ReportError),
    /// A table of points cannot be read.
    #[error(transparent)]
    Table(#[from] bsm_batch::TableError),
    /// None of the points has a reference solution.
    #[error("model traction has no solution at any of the points, so there is no reference")]
    NoReference,
    /// Threads cannot be started.
    #[error("threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// A search for the minimum or root of a function failed.
    #[error("search: {0}")]
    Search(#[from] bsm_design::search::SearchError),
}

impl ValidateError {
    /// Creates the error for an invalid file, check or row.
    fn of(place: impl Display, why: impl Display) -> Self {
        Self::Invalid(format!("{place}: {why}"))
    }
}

/// Runs all checks.
///
/// # Errors
///
/// [`ValidateError`] if the data cannot be used. A failed check is not an error, but part of the
/// report.
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
