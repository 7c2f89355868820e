//! Errors that occur when figures and pages are created.

/// The reason why a figure or a page cannot be created.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// A table cannot be written.
    #[error("table: {0}")]
    Table(#[from] csv::Error),
    /// An image cannot be drawn.
    #[error("picture: {0}")]
    Picture(String),
    /// The program was built without the feature that draws pictures.
    #[error("this program was built without the feature `plot`; build bsm with this feature")]
    NotBuilt,
    /// An HTML page cannot be created.
    #[error("page: {0}")]
    Page(#[from] minijinja::Error),
    /// A point of a figure is not a valid operating point.
    #[error("point of a figure: {0}")]
    Case(#[from] bsm_case::CaseError),
    /// A search for the minimum or root of a function failed.
    #[error("search: {0}")]
    Search(#[from] bsm_design::search::SearchError),
}
