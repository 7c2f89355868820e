//! Tables in and out, folders, and kernels against their models.

mod alike;
mod arrow_column;
mod columns;
mod dataset;
mod draws;
mod kernels;
mod parquet_in;
mod plan;
mod rows;
mod text;

// Private files with tests of their own: the library is compiled once, without them.
#[path = "../../src/column_chunk.rs"]
mod column_chunk;
#[path = "../../src/dataset/digest.rs"]
mod digest;
