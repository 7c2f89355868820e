//! Points and their descriptions, for builds without Parquet. Folders of parts require Parquet.

#![expect(dead_code, reason = "only folders of parts use plans and hashes of byte strings")]

mod digest;
mod error;
mod plan;
mod points;

pub use self::error::{DatasetError, PartDefect};
pub use self::plan::RESULTS;
pub use self::points::{Points, sha256};
