//! Operating points of a grid, random operating points, or operating points from a table. All three
//! kinds can be generated or read repeatedly.

use std::fmt::Display;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use bsm_case::{Grid, GridAxis};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::error::describe_entry;
use super::{DatasetError, digest};
use crate::rows::ROWS_PER_CHUNK;
use crate::{
    Format, GridSource, PointSet, RandomPoints, RandomSource, Source, TableError, TableFormat,
    Workers,
};

/// Operating points that can be generated or read repeatedly.
#[derive(Debug, Clone)]
pub enum Points {
    /// The points of a grid.
    Grid(Grid),
    /// Random points.
    Random(RandomPoints),
    /// The rows of a table file.
    Table {
        /// Path of the table file.
        path: PathBuf,
        /// Names of the columns that are copied to the results.
        keep: Vec<String>,
        /// Separators, decimal sign and column names of the table.
        table_format: TableFormat,
    },
}

impl Points {
    /// Returns a source of rows that starts at the first row.
    ///
    /// # Errors
    ///
    /// Returns [`TableError`] if the table cannot be opened.
    pub fn open(&self) -> Result<Box<dyn Source>, TableError> {
        match self {
            Self::Grid(grid) => Ok(Box::new(GridSource::new(grid.clone()))),
            Self::Random(draws) => Ok(Box::new(RandomSource::new(draws.clone()))),
            Self::Table { path, keep, table_format } => {
                let format = Format::of(path).ok_or_else(|| {
                    let words = "the name of a table must end with .csv, .jsonl or .parquet";
                    io::Error::new(io::ErrorKind::InvalidInput, words)
                })?;
                format.open(path, keep, table_format)
            }
        }
    }

    /// Returns the description of the points for a plan, and the number of points. A table file is
    /// read completely to calculate its hash. Its rows are counted, unless the file states the
    /// number of rows in its footer.
    pub(super) fn entry(&self, workers: &Workers<'_>) -> Result<(PointsEntry, u64), DatasetError> {
        let (path, keep, table_format) = match self {
            Self::Grid(grid) => return Ok((grid_entry(grid), grid.len() as u64)),
            Self::Random(draws) => return Ok((random_entry(draws), draws.count())),
            Self::Table { path, keep, table_format } => (path, keep, table_format),
        };
        let (name, sha256, bytes) = name_hash_and_length(path, workers)?;
        let mut source = self.open().map_err(DatasetError::Read)?;
        let known = source.len_hint();
        let mut rows = known.unwrap_or(0);
        while known.is_none()
            && let Some(chunk) = source.next(ROWS_PER_CHUNK).map_err(DatasetError::Read)?
        {
            rows += chunk.len as u64;
            if workers.stopped() {
                return Err(DatasetError::Stopped);
            }
        }
        let (keep, table_format) = (keep.clone(), table_format.clone());
        let table = TableEntry { name, bytes, sha256, rows, keep, table_format };
        Ok((PointsEntry::Table(table), rows))
    }

    /// Returns a description of the points for the metadata of a table. For a pipe, the description
    /// contains neither a name nor a hash.
    ///
    /// # Errors
    ///
    /// Returns [`DatasetError`] if a table cannot be read.
    pub fn about(&self, workers: &Workers<'_>) -> Result<Value, DatasetError> {
        Ok(match self {
            Self::Grid(grid) => json!(grid_entry(grid)),
            Self::Random(draws) => json!(random_entry(draws)),
            Self::Table { path, keep, .. } if !path.is_file() => {
                json!({ "table": { "name": null, "keep": keep } })
            }
            Self::Table { path, keep, table_format } => {
                let (name, sha256, bytes) = name_hash_and_length(path, workers)?;
                let table = json!({ "name": name, "bytes": bytes, "sha256": sha256, "keep": keep, "dialect": table_format });
                json!({ "table": table })
            }
        })
    }
}

/// Returns the error for invalid points in a plan.
pub(super) fn invalid_points(why: impl Display) -> DatasetError {
    DatasetError::Refused(format!("the points in the plan are invalid: {why}"))
}

fn grid_entry(grid: &Grid) -> PointsEntry {
    PointsEntry::Grid(grid.axes().iter().map(ToString::to_string).collect())
}

fn random_entry(draws: &RandomPoints) -> PointsEntry {
    let of = draws.inputs().iter().map(ToString::to_string).collect();
    PointsEntry::Random(RandomEntry { seed: draws.seed(), count: draws.count(), of })
}

/// Returns the SHA-256 hash and the length of a file.
///
/// # Errors
///
/// Returns [`io::Error`] if the file cannot be read.
pub fn sha256(path: &Path) -> io::Result<(String, u64)> {
    let hash = digest::of_reader(&mut File::open(path)?, || false)?;
    hash.ok_or_else(|| io::Error::other("never stopped"))
}

/// Returns the name, SHA-256 hash and length of a table file.
fn name_hash_and_length(
    path: &Path,
    workers: &Workers<'_>,
) -> Result<(String, String, u64), DatasetError> {
    let unreadable = |error: io::Error| DatasetError::io("read", path, error);
    let found = path.metadata().map_err(unreadable)?;
    if !found.is_file() {
        return Err(DatasetError::Refused(format!(
            "{} is {}, but the points for a folder of parts must come from a file, because the points are read twice",
            path.display(),
            describe_entry(&found)
        )));
    }
    let mut file = File::open(path).map_err(unreadable)?;
    let hash = digest::of_reader(&mut file, || workers.stopped()).map_err(unreadable)?;
    let (sha256, bytes) = hash.ok_or(DatasetError::Stopped)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    Ok((name, sha256, bytes))
}

/// Description of the points in a plan file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum PointsEntry {
    Grid(Vec<String>),
    Random(RandomEntry),
    Table(TableEntry),
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RandomEntry {
    seed: u64,
    count: u64,
    of: Vec<String>,
}

impl PointsEntry {
    /// Returns, for each input, the estimated size of one value in a part file \[B\].
    pub(super) fn inputs(&self) -> Vec<f64> {
        /// Size of an uncompressed number \[B\].
        const NUMBER: f64 = 8.0;
        /// Number of input columns that the estimate assumes for a table.
        const COLUMNS: usize = 4;
        /// Compressed size \[B\] of a number that is repeated within the 64 kB window in which
        /// Snappy finds repetitions. Measured sizes are 0.4 to 0.5 B.
        const REPEATED: f64 = 0.5;
        /// Maximum length of the innermost grid axis for which the estimate assumes that Snappy
        /// compression finds the repeated values of this axis.
        const REPEATING: usize = 1 << 14;
        match self {
            // On outer axes, the same value occurs in many consecutive rows; on the innermost axis,
            // the values repeat periodically.
            Self::Grid(axes) => {
                let bytes = |(range, text): (usize, &String)| match GridAxis::parse(text) {
                    Ok(axis) if range == 0 && axis.len() > REPEATING => NUMBER,
                    _ => REPEATED,
                };
                axes.iter().rev().enumerate().map(bytes).collect()
            }
            Self::Random(draws) => vec![NUMBER; draws.of.len()],
            Self::Table(table) => vec![NUMBER; COLUMNS + table.keep.len()],
        }
    }

    /// Returns the points of the plan. If the points come from a table, the file must be identical
    /// to the file for which the plan was created.
    ///
    /// * `table`: function that returns the path of the table with the given name.
    pub(super) fn read(
        &self,
        table: impl FnOnce(&str) -> PathBuf,
        workers: &Workers<'_>,
    ) -> Result<Points, DatasetError> {
        match self {
            Self::Grid(axes) => Ok(Points::Grid(Grid::parse(axes).map_err(invalid_points)?)),
            Self::Random(RandomEntry { seed, count, of }) => {
                Ok(Points::Random(RandomPoints::parse(*seed, *count, of).map_err(invalid_points)?))
            }
            Self::Table(written) => {
                let path = table(&written.name);
                let (keep, table_format) = (written.keep.clone(), written.table_format.clone());
                let len = path.metadata().map_err(|e| DatasetError::io("read", &path, e))?.len();
                // If the lengths differ, the file is rejected without calculating its hash.
                if len != written.bytes || name_hash_and_length(&path, workers)?.1 != written.sha256
                {
                    return Err(DatasetError::Refused(format!(
                        "{} is not identical to the table of points in the plan ({})",
                        path.display(),
                        written.name
                    )));
                }
                Ok(Points::Table { path, keep, table_format })
            }
        }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TableEntry {
    name: String,
    bytes: u64,
    sha256: String,
    rows: u64,
    keep: Vec<String>,
    #[serde(rename = "dialect", default, skip_serializing_if = "TableFormat::is_standard")]
    table_format: TableFormat,
}
