//! Many operating points: rows in, rows out, in the same order, on all cores.
//!
//! A [`Source`] gives rows in chunks, a [`Task`] answers a chunk, a [`Sink`] writes it; [`Task::run`] does so
//! from end to end with [`Workers`], and a [`dataset`] in parts that can be stopped and gone on with. Nothing
//! here depends on the number of rows, so that memory stays flat whatever the size, nor on the
//! number of threads, so that results do not either.

#![expect(
    clippy::inline_always,
    reason = "code takes the instruction set of its caller only inline"
)]

pub mod dataset;
mod error;
mod kernel;
mod lines;
mod numbers;
mod operand;
mod pages;
mod parquet_table;
mod pipeline;
mod rows;
mod solve;
mod source;
mod table;
mod text;

pub use error::TableError;
pub use kernel::exists as has_kernel;
pub use numbers::{NumberColumn, NumberRows, NumberSink};
pub use parquet_table::{ParquetSink, ParquetSource, decodes_parquet};
pub use pipeline::{Count, RunError, Task, Workers};
pub use rows::{Answers, Cell, Chunk, Column, Columns, Verdict};
pub use source::{GridSource, Source};
pub use table::{Format, TableSink};
pub use text::{CsvSink, CsvSource, JsonSink, JsonSource};

/// Where answered rows go.
pub trait Sink {
    /// Writes the rows of a chunk with their answers.
    ///
    /// # Errors
    ///
    /// [`TableError`] if they cannot be written.
    fn write(&mut self, chunk: Chunk, answers: Answers) -> Result<(), TableError>;
}
