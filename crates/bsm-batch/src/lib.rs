//! Solves many operating points on all cores, and returns the results in the order of the points.
//!
//! A [`Source`] provides rows in chunks, a [`Task`] solves each chunk, and an [`AnswerSink`] writes
//! the results. [`Task::run`] performs these three steps on the threads of [`Workers`]. A
//! [`dataset`] is divided into part files, so that an interrupted run can be resumed. Memory use
//! does not depend on the number of rows, and results do not depend on the number of threads.
//!
//! ```
//! use std::sync::atomic::AtomicBool;
//!
//! use bsm_batch::{Answers, Format, GridSource, Task, Workers};
//! use bsm_case::{GridAxis, Grid, Case, Settings};
//! use bsm_dyn::Model;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let screw = Case::from_json(
//!     br#"{
//!         "ball_diameter_mm": 6.35, "pitch_circle_diameter_mm": 41.5, "lead_mm": 20,
//!         "contact_angle_deg": 45, "friction_coefficient": 0.06,
//!         "axial_load_N": 8000, "loaded_balls": 70
//!     }"#,
//! )?;
//! let grid = Grid::new(vec![GridAxis::parse("screw_speed_rpm=500:1500:3")?])?;
//! let outputs = Answers::select(Some(&["efficiency".to_owned()]))?;
//! let task = Task::over_grid(screw, Settings::from(Model::Rigid), outputs, None, &grid)?;
//!
//! // Setting this flag from another thread stops the run.
//! let stop = AtomicBool::new(false);
//! let workers = Workers::start(None, &stop)?;
//! let mut points = GridSource::new(grid);
//! let (table, count) =
//!     task.write(&mut points, Format::Csv, Vec::new(), &workers, &mut |_chunk, _answers| {})?;
//!
//! assert_eq!((count.rows, count.failed), (3, 0));
//! let table = String::from_utf8(table)?;
//! let last = table.lines().last();
//! assert!(last.is_some_and(|row| row.starts_with("1500,rigid,converged,,0.88660")), "{table}");
//! # Ok(())
//! # }
//! ```

pub mod arrow_column;
mod column_plan;
mod columns;
#[cfg(feature = "parquet")]
pub mod dataset;
#[cfg(not(feature = "parquet"))]
#[path = "dataset/without_parts.rs"]
pub mod dataset;
mod draws;
mod error;
#[cfg(feature = "parquet")]
mod pages;
mod panics;
#[cfg(feature = "parquet")]
mod parquet_table;
mod pipeline;
mod rows;
mod solve;
mod source;
mod table;
mod task;
mod text;

pub use bsm_case::TableFormat;
pub use columns::{ColumnUnits, Columns, ConvertingSink, Heading, unit_of};
pub use draws::{Distribution, RandomInput, RandomPoints, RandomSource};
pub use error::{TableError, UnknownName};
pub use panics::{catch_panic, silence_caught_panics};
#[cfg(feature = "parquet")]
pub use parquet_table::ParquetSource;
pub use pipeline::{Count, RunError, Workers};
pub use rows::{Answers, Cell, Chunk, ROWS_PER_CHUNK, RowCells, RowOutcome};
pub use solve::{Buffers, RowReport};
pub use source::{GridSource, PointSet, PointSource, Source};
pub use table::{ColumnHead, Format, METADATA_KEY, TableSink};
pub use task::Task;
pub use text::{CsvSource, JsonSource};

/// A sink that writes or stores solved rows.
pub trait AnswerSink {
    /// Writes the rows of a chunk together with their results.
    ///
    /// # Errors
    ///
    /// Returns [`TableError`] if the rows cannot be written.
    fn write(&mut self, chunk: Chunk, answers: Answers) -> Result<(), TableError>;
}
