//! Figures and pages that show the results of the commands.

mod catalog;
mod jam;
mod lin;
mod nut;
mod offers;
mod size;
mod slip;
mod study;
mod table;
mod warm;

pub use catalog::catalog_figures;
pub use lin::{Getter, efficiency_as_printed, lin_figures, lin_figures_with_fig5_case, points};
pub use nut::nut_figures;
pub use offers::offers_page;
pub use size::{size_figures, size_page, size_results, size_table};
pub use study::{NamedCurve, Study};
pub use table::table_figures;
pub use warm::{warm_figures, warm_preload};
