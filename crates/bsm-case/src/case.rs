//! Conversion of case files to problems in SI units.

pub(crate) mod axis;
pub(crate) mod axis_inputs;
pub(crate) mod catalog;
pub(crate) mod catalog_keys;
pub(crate) mod catalog_line;
pub(crate) mod cycle;
pub(crate) mod file;
pub(crate) mod grid;
pub(crate) mod manufacturer_sizes;
pub(crate) mod nut;
pub(crate) mod problem;
pub(crate) mod rated_nut;
pub(crate) mod rated_screw;
pub(crate) mod reader;
pub(crate) mod requirement;
pub(crate) mod thermal;
pub(crate) mod warm;
