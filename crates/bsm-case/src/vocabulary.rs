//! Names of inputs and outputs with their units, rules and meanings, and the tables of quantities
//! from which answers are built.

pub(crate) mod answer;
pub(crate) mod cells;
pub(crate) mod column_values;
pub(crate) mod display;
pub(crate) mod entries;
pub(crate) mod error;
pub(crate) mod input;
pub(crate) mod input_set;
pub(crate) mod lines;
pub(crate) mod members;
pub(crate) mod names;
pub(crate) mod number;
pub(crate) mod output;
pub(crate) mod phase;
pub(crate) mod quantity;
pub(crate) mod rules;
pub(crate) mod table_format;
pub mod units;
pub(crate) mod warning;
