//! Tests of tables, datasets and kernels.

mod alike;
mod arrow_column;
mod columns;
mod dataset;
mod draws;
mod kernels;
mod parquet_in;
mod parquet_out;
mod plan;
mod rows;
mod text;

// Private modules are included and tested directly. The library itself is compiled once, without
// these tests.
#[path = "../../src/dataset/digest.rs"]
mod digest;
