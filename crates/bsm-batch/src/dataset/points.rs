//! Points that come from a grid or a table, and can come from it again.

use std::fs::File;
use std::io;
use std::path::PathBuf;

use bsm_case::Grid;
use serde::{Deserialize, Serialize};

use super::part::kind;
use super::{DatasetError, digest};
use crate::pipeline::ROWS;
use crate::{Format, GridSource, Source, TableError, Workers};

/// Rows that points come from, and can come from again.
#[derive(Debug, Clone)]
pub enum Points {
    /// A grid.
    Grid(Grid),
    /// A table.
    Table {
        /// The file.
        path: PathBuf,
        /// Columns to carry through.
        keep: Vec<String>,
    },
}

impl Points {
    /// All rows from the first on.
    ///
    /// # Errors
    ///
    /// [`TableError`] if the table cannot be opened.
    pub fn open(&self) -> Result<Box<dyn Source>, TableError> {
        match self {
            Self::Grid(grid) => Ok(Box::new(GridSource::new(grid.clone()))),
            Self::Table { path, keep } => {
                let format = Format::of(path).ok_or_else(|| {
                    let words = "a table ends in .csv, .jsonl or .parquet";
                    io::Error::new(io::ErrorKind::InvalidInput, words)
                })?;
                format.open(path, keep)
            }
        }
    }

    /// What a plan says of them, and their number. A table is read to its end for that: its hash, and its
    /// rows where no footer tells them.
    pub(super) fn written(
        &self,
        workers: &Workers<'_>,
    ) -> Result<(WrittenPoints, u64), DatasetError> {
        let (path, keep) = match self {
            Self::Grid(grid) => {
                let axes = grid.axes().iter().map(ToString::to_string).collect();
                return Ok((WrittenPoints::Grid(axes), grid.len() as u64));
            }
            Self::Table { path, keep } => (path, keep),
        };
        let unreadable = |error: io::Error| DatasetError::io("read", path, error);
        let found = path.metadata().map_err(unreadable)?;
        if !found.is_file() {
            let found = kind(&found);
            return Err(DatasetError::NotReadTwice { path: path.clone(), found });
        }
        let mut file = File::open(path).map_err(unreadable)?;
        let hash = digest::of_reader(&mut file, || workers.stopped()).map_err(unreadable)?;
        let (sha256, bytes) = hash.ok_or(DatasetError::Stopped)?;
        let mut source = self.open().map_err(DatasetError::Read)?;
        let known = source.len_hint();
        let mut rows = known.unwrap_or(0);
        while known.is_none()
            && let Some(chunk) = source.next(ROWS).map_err(DatasetError::Read)?
        {
            rows += chunk.len as u64;
            if workers.stopped() {
                return Err(DatasetError::Stopped);
            }
        }
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let table = WrittenTable { name, bytes, sha256, rows, keep: keep.clone() };
        Ok((WrittenPoints::Table(table), rows))
    }
}

/// Points as they stand in a plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum WrittenPoints {
    Grid(Vec<String>),
    Table(WrittenTable),
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WrittenTable {
    name: String,
    bytes: u64,
    sha256: String,
    rows: u64,
    keep: Vec<String>,
}
