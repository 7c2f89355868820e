//! The elastic models: common limits, failures, and campaigns over seeded screws.

mod campaign;
mod limits;
pub(crate) mod screws;
