//! Datasets that are solved in parts: their plans, the parts, and the state of a folder.

use std::io;
use std::num::{NonZeroU64, NonZeroUsize};
use std::ops::Range;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use bsm_batch::dataset::{
    Dataset, DatasetError, Event, FolderScan, Part, Plan, PlanError, Points, solve_part,
};
use bsm_batch::{TableFormat, Task, Workers};
use bsm_case::Grid;
use pyo3::prelude::*;
use tempfile::NamedTempFile;

use crate::case::{Case, How};
use crate::errors::{Error, Result};
use crate::points::{AxisRange, Law, draws_of, format_of, grid_of, selected, watched};
use crate::table::Arrow;

/// Creates a temporary file, which is removed when its owner is dropped. The removal must not wait
/// for the end of the process, because a Python process may continue after a run has been
/// interrupted.
fn make(file: &mut dyn FnMut() -> io::Result<NamedTempFile>) -> io::Result<NamedTempFile> {
    file()
}

#[expect(clippy::needless_pass_by_value, reason = "the function is passed to map_err")]
fn planned(why: PlanError) -> Error {
    Error::from(format!("the plan: {why}"))
}

/// Data of a part: its number, first row, numbers of rows, of failed rows and of rows with several
/// results, number of bytes before the footer, and hash of these bytes.
type RowReport = (u64, u64, u64, u64, u64, u64, String);

fn told(part: &Part) -> RowReport {
    let Part {
        number,
        first_row,
        rows,
        failed,
        with_other_solutions: several,
        data_bytes,
        data_sha256,
    } = part.clone();
    (number, first_row, rows, failed, several, data_bytes, data_sha256)
}

/// State of a folder: its parts, ranges of missing parts, damaged files with the reason, and files
/// that do not belong to the plan.
type Survey = (Vec<RowReport>, Vec<(u64, u64)>, Vec<(PathBuf, String)>, Vec<PathBuf>);

/// Random points: the seed, the number of points, and the distributions of the inputs.
type Random = (u64, u64, Vec<(String, Law)>);

/// The plan of a dataset.
#[pyclass(frozen, subclass, name = "Plan", module = "ballscrew._core")]
pub(crate) struct PyPlan(Plan);

// The public Python class `Plan` inherits from this class. Methods whose names begin with an
// underscore are private.
#[pymethods]
impl PyPlan {
    /// * `axes`, `random`, `table`: source of the points, exactly one of which is given: the axes
    ///   of a grid, random points, or a table with columns to copy.
    #[staticmethod]
    #[pyo3(name = "_of")]
    #[expect(clippy::too_many_arguments, reason = "the arguments are keywords in Python")]
    fn of(
        py: Python<'_>,
        base: &Bound<'_, Case>,
        axes: Vec<(String, AxisRange)>,
        random: Option<Random>,
        table: Option<(PathBuf, Vec<String>)>,
        how: How,
        outputs: Option<Vec<String>>,
        rows_per_part: Option<NonZeroU64>,
    ) -> Result<Self> {
        let (base, settings) = (base.get().0.clone(), how.0);
        let outputs = selected(outputs)?;
        let of_grid =
            |grid: &Grid| Task::over_grid(base.clone(), settings, outputs.clone(), None, grid);
        let (task, points) = if let Some((path, keep)) = table {
            format_of(&path)?;
            let points = Points::Table { path, keep, table_format: TableFormat::default() };
            let source = points.open()?;
            (Task::over_table(base, settings, outputs, source.columns())?, points)
        } else if let Some((seed, count, of)) = random {
            let draws = draws_of(seed, count, of)?;
            let corners = draws.corners()?;
            (of_grid(&corners)?, Points::Random(draws))
        } else {
            let grid = grid_of(axes)?;
            (of_grid(&grid)?, Points::Grid(grid))
        };
        // To calculate the hash of a table, the whole table is read.
        let plan = watched(py, false, 0, Some(NonZeroUsize::MIN), None, |stop, _| {
            let workers = Workers::start(Some(NonZeroUsize::MIN), stop);
            let workers = workers.map_err(DatasetError::Thread)?;
            Plan::new(&task, &points, rows_per_part, &workers)
        })?;
        Ok(Self(plan))
    }

    #[new]
    fn from_text(text: &str) -> Result<Self> {
        Plan::from_text(text).map(Self).map_err(planned)
    }

    /// Reads the plan that is stored in a folder.
    #[staticmethod]
    #[pyo3(name = "_within")]
    fn within(folder: PathBuf) -> Result<Self> {
        Ok(Self(Dataset::open(&folder, make)?.plan().clone()))
    }

    /// Creates a folder for the plan, or checks that the existing folder has this plan.
    #[pyo3(name = "_begin")]
    fn begin(&self, folder: PathBuf) -> Result<()> {
        Ok(Dataset::resume(&folder, self.0.clone(), make).map(drop)?)
    }

    /// Returns the text of the file `plan.json`.
    #[getter]
    fn text(&self) -> &str {
        self.0.text()
    }

    /// Returns the SHA-256 hash of the text of `plan.json`.
    #[getter]
    fn id(&self) -> &str {
        self.0.id()
    }

    /// Returns the number of rows of all parts.
    #[getter]
    fn rows(&self) -> u64 {
        self.0.rows()
    }

    /// Returns the number of parts of the plan.
    #[getter]
    fn parts(&self) -> u64 {
        self.0.parts()
    }

    /// Returns the number of rows of each part. The last part may have fewer rows.
    #[getter]
    fn rows_per_part(&self) -> u64 {
        self.0.rows_per_part()
    }

    /// Returns the estimated computing time on one core \[s\], and an upper bound of the size of
    /// all parts \[B\].
    #[pyo3(name = "_cost")]
    fn cost(&self) -> Result<(f64, f64)> {
        let estimate = self.0.estimate().map_err(planned)?;
        Ok((estimate.core_seconds, estimate.bytes))
    }

    /// Solves parts into a folder, which is created if necessary. Returns the data of the parts,
    /// and the numbers of the parts that existed before.
    ///
    /// * `numbers`: numbers of the parts in ascending order. `None` solves all parts and then
    ///   writes the list of parts.
    /// * `table`: path of the table that contains the points of the plan.
    #[pyo3(name = "_solve_into")]
    #[expect(clippy::too_many_arguments, reason = "the arguments are keywords in Python")]
    fn solve_into(
        &self,
        py: Python<'_>,
        folder: PathBuf,
        numbers: Option<Vec<u64>>,
        table: Option<PathBuf>,
        repair: bool,
        threads: Option<NonZeroUsize>,
        progress: Option<Py<PyAny>>,
    ) -> Result<(Vec<RowReport>, Vec<u64>)> {
        let plan = &self.0;
        let task = plan.task().map_err(planned)?;
        let len = numbers.as_ref().map_or(plan.rows(), |s| s.len() as u64 * plan.rows_per_part());
        let len = usize::try_from(len.min(plan.rows())).unwrap_or(usize::MAX);
        let solve = |stop: &AtomicBool, done: &AtomicU64| {
            let parts = Dataset::resume(&folder, plan.clone(), make)?;
            let workers = Workers::start(threads, stop).map_err(DatasetError::Thread)?;
            let points = parts.points(table.as_deref(), &workers)?;
            let mut there = Vec::new();
            let mut tell = |event: Event<'_>| match event {
                Event::Found(part) => {
                    there.push(part.number);
                    done.fetch_add(part.rows, Ordering::Relaxed);
                }
                Event::Solved(chunk, _) => {
                    done.fetch_add(chunk.len as u64, Ordering::Relaxed);
                }
                Event::UnknownFiles(_) | Event::Planned(_) => {}
            };
            let all = numbers.is_none();
            let numbers = numbers.unwrap_or_else(|| (0..plan.parts()).collect());
            let found = parts.run_parts(&task, &points, numbers, repair, &workers, &mut tell)?;
            if all {
                parts.check_names()?;
                parts.finish(&found)?;
            }
            Ok::<_, DatasetError>((found.values().map(told).collect(), there))
        };
        // The calling thread handles the signals of Python while other threads solve the parts.
        watched(py, false, len, Some(NonZeroUsize::MIN), progress, solve)
    }

    /// Solves one part of the plan and returns its rows in memory.
    ///
    /// * `table`: path of the table that contains the points of the plan.
    #[pyo3(name = "_solve")]
    fn solve(
        &self,
        py: Python<'_>,
        number: u64,
        table: Option<PathBuf>,
        threads: Option<NonZeroUsize>,
    ) -> Result<Arrow> {
        let solve = |stop: &AtomicBool, _: &AtomicU64| {
            let workers = Workers::start(threads, stop).map_err(DatasetError::Thread)?;
            let beside = |name: &str| table.unwrap_or_else(|| name.into());
            let points = self.0.points(beside, &workers)?;
            solve_part(&self.0, &points, number, &workers)
        };
        let (schema, batches) = watched(py, false, 0, Some(NonZeroUsize::MIN), None, solve)?;
        Ok(Arrow { schema, batches })
    }

    /// Returns the state of a folder: its parts, ranges of missing parts, damaged files with the
    /// reason, and files that do not belong to the plan.
    ///
    /// * `finish`: true to write the list of parts if all parts exist.
    #[pyo3(name = "_survey")]
    fn survey(&self, py: Python<'_>, folder: PathBuf, deep: bool, finish: bool) -> Result<Survey> {
        let survey = watched(py, false, 0, Some(NonZeroUsize::MIN), None, |stop, _| {
            let workers = Workers::start(None, stop).map_err(DatasetError::Thread)?;
            let folder = Dataset::resume(&folder, self.0.clone(), make)?;
            let survey = folder.survey(deep, &workers)?;
            if finish && survey.is_complete(&self.0) {
                folder.finish(&survey.parts)?;
            }
            Ok::<_, DatasetError>(survey)
        })?;
        let range = |Range { start, end }| (start, end);
        let missing = survey.missing(&self.0).into_iter().map(range).collect();
        let FolderScan { parts, damaged, unknown_files } = survey;
        let damaged = damaged.into_iter().map(|(path, why)| (path, why.to_string())).collect();
        Ok((parts.values().map(told).collect(), missing, damaged, unknown_files))
    }
}
