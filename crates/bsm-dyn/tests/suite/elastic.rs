//! Tests of the elastic models: limits, failures, and campaigns over random screws.

mod campaign;
mod limits;
pub(crate) mod screws;
