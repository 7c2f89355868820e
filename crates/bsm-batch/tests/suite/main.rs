//! Tables in and out, folders, and kernels against their models.

mod alike;
mod columns;
mod dataset;
mod kernels;
mod parquet_in;
mod rows;
mod text;
