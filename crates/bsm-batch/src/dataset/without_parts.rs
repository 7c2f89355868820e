//! Points and their descriptions, for builds without Parquet. Folders of parts require Parquet.

mod digest;
mod error;
mod plan;
mod points;

pub use self::error::{DatasetError, PartDefect};
pub use self::plan::{Estimate, MAX_PARTS, Plan, RESULTS};
pub use self::points::{Points, sha256};
