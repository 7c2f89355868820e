//! Comparison of the solver with published results.
//!
//! The data is in `validation/published/<key>`, together with its source, and is compiled in. A
//! copy of the folder can be used instead. Every check states the claim, the result that is
//! compared with it, and the reason for its tolerance. Golden files only guard against change. They
//! are not validation and are not part of this crate.

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
pub use report::{Check, Report, Verdict};

use std::fmt::Display;

/// An error in the data, in a table of points or of the machine that prevents a validation.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ValidateError {
    /// Published data or a table of points cannot be used.
    #[error("{0}")]
    Invalid(String),
    /// A point of a check is not a valid operating point.
    #[error("point of a check: {0}")]
    Point(#[from] bsm_case::CaseError),
    /// A file of published data cannot be read.
    #[error("{}: {error}", path.display())]
    File {
        /// The file.
        path: std::path::PathBuf,
        /// The reason.
        error: std::io::Error,
    },
    /// A figure or a page cannot be created.
    #[error(transparent)]
    Report(#[from] bsm_report::ReportError),
    /// A table of points cannot be used.
    #[error(transparent)]
    Table(#[from] bsm_batch::TableError),
    /// No point has a reference solution.
    #[error("model traction has no solution at any of the points, so there is no reference")]
    NoReference,
    /// Threads cannot be started.
    #[error("threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// A one-dimensional search failed.
    #[error("search: {0}")]
    Search(#[from] bsm_design::search::SearchError),
}

impl ValidateError {
    /// Returns the error for a file, a check or a row that is rejected.
    fn of(place: impl Display, why: impl Display) -> Self {
        Self::Invalid(format!("{place}: {why}"))
    }
}

/// Runs every check.
///
/// # Errors
///
/// [`ValidateError`] if the data cannot be used. A check that fails is not an error, but a result.
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
