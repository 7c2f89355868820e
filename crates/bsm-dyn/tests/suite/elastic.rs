//! Tests of the elastic models: limiting cases, failures, and campaigns over random screws.

mod campaign;
mod limits;
pub(crate) mod screws;
