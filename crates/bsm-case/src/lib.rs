//! Vocabulary, units and scene files: what a person reads and writes.
//!
//! The only place that knows millimetres, degrees and rpm. A [`Scene`] is one operating point in
//! the vocabulary; [`Scene::problem`] turns it into the SI problem of a model, [`Record`] turns
//! the answer back. Nothing here solves anything.

mod capacity;
mod error;
mod grid;
mod input;
mod optimum;
mod output;
mod problem;
mod reader;
mod record;
mod scene;
mod schema;
mod sensitivity;
pub mod units;

pub use capacity::CapacityReport;
pub use error::CaseError;
pub use grid::{Axis, Grid};
pub use input::{INPUTS, Input, InputKey, Rule, Scene};
pub use optimum::OptimumReport;
pub use output::{Cell, OUTPUTS, Output, OutputKey};
pub use problem::{ModelChoice, Settings, required_inputs};
pub use record::Record;
pub use scene::nearest_input;
pub use schema::{input_schema, output_schema};
pub use sensitivity::{Jets, Sensitivities, Sensitivity};
