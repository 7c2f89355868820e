//! Figures, pages and numbers for people to read; knows no ball screw.

mod error;
mod figure;
mod number;
mod page;

pub use error::ReportError;
pub use figure::{Axis, Curve, Figure, MOST_CURVES, Stroke};
pub use number::{number, short};
pub use page::{PROGRAM, Page};
