//! Tests of tables, datasets and vectorized kernels.

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

// Private modules are included here and tested directly, so that the library is compiled only once,
// without tests.
#[path = "../../src/dataset/digest.rs"]
mod digest;
