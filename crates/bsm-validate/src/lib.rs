//! Published results, checked against the solver.
//!
//! Data lies under `validation/published/<key>`, each with its source, and is compiled in. Every
//! check names what is claimed, what we measure, and why its tolerance is what it is. Golden
//! files, which only guard against change, are not validation and not here.

mod elastic;
mod lin1994;
mod reference;
mod report;
mod search;
mod sweep;

pub use elastic::{TransitionCurve, transition_figure};
pub use report::{Check, Report, Verdict};

/// Something is wrong with the data that is compiled in.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ValidateError {
    /// A table cannot be read.
    #[error("validation data: {0}")]
    Data(#[from] csv::Error),
    /// A scene cannot be used.
    #[error("validation scene: {0}")]
    Scene(#[from] bsm_case::CaseError),
    /// A claim is missing in a table.
    #[error("validation data: no claim `{0}`")]
    NoClaim(&'static str),
    /// A one-dimensional search failed.
    #[error("search: {0}")]
    Search(#[from] argmin::core::Error),
}

/// Runs every check.
///
/// # Errors
///
/// [`ValidateError`] if the compiled-in data cannot be used; a check that fails is a result.
pub fn run() -> Result<Report, ValidateError> {
    let mut checks = reference::checks()?;
    checks.extend(lin1994::checks()?);
    checks.extend(elastic::checks()?);
    Ok(Report { checks })
}
