//! Figures, HTML pages and tables, and the reports that consist of them.
//!
//! Start with [`report_files`], which creates the files of a report, or with [`Figure`], which
//! draws curves.

mod dxf;
mod error;
#[cfg(feature = "plot")]
mod figure;
#[cfg(feature = "plot")]
mod map;
#[cfg(not(feature = "plot"))]
mod no_plot;
mod page;
mod plots;
pub mod sheets;

pub use bsm_case::{format_number, format_short};
pub use dxf::groove_dxf;
pub use error::ReportError;
pub use page::{PROGRAM, Page, STYLE, figure_files, report_files};
pub use plots::{Curve, Figure, MAX_CELLS, MAX_CURVES, Map, PlotAxis, Stroke};
