//! Errors of the report.

/// A figure or a page cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// A table cannot be written.
    #[error("table: {0}")]
    Table(#[from] csv::Error),
    /// A picture cannot be made.
    #[error("picture: {0}")]
    Picture(String),
    /// A page cannot be made.
    #[error("page: {0}")]
    Page(#[from] minijinja::Error),
    /// A point of a figure cannot be asked.
    #[error("point of a figure: {0}")]
    Case(#[from] bsm_case::CaseError),
    /// A one-dimensional search failed.
    #[error("search: {0}")]
    Search(#[from] bsm_design::search::SearchError),
}
