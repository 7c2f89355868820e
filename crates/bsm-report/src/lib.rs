//! Figures, HTML pages and tables, and the reports that consist of them.

mod dxf;
mod error;
mod figure;
mod map;
mod page;
pub mod sheets;

pub use bsm_case::{number, short};
pub use dxf::groove_dxf;
pub use error::ReportError;
pub use figure::{Axis, Curve, Figure, MAX_CURVES, Stroke};
pub use map::{MAX_CELLS, Map};
pub use page::{PROGRAM, Page, STYLE, figure_files, report_files};
