//! The plan of a dataset, which contains everything that determines the bytes of the part files,
//! and nothing else.

use std::num::{NonZeroU32, NonZeroU64};
use std::path::{Path, PathBuf};

use bsm_case::{Case, CaseError, ModelChoice, Output, OutputType, Settings};
use bsm_dyn::Model;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};
use thiserror::Error;

#[cfg(feature = "parquet")]
use super::part::PartRange;
use super::points::{Points, PointsEntry};
use super::{DatasetError, digest};
use crate::{Answers, Columns, Heading, TableError, Task, Workers};

/// Version number of the results. It is incremented with every change of the program that changes a
/// calculated number, so that a dataset never contains parts with different results.
pub const RESULTS: u32 = 93;

/// Version number of the file formats of plans and parts. It is part of the plan, because the plan
/// must determine every byte of the part files.
const FORMAT: u32 = 6;

/// Maximum number of parts in a dataset.
pub const MAX_PARTS: u64 = 100_000;

/// Plan of a dataset, which determines all bytes of the part files.
#[derive(Debug, Clone)]
pub struct Plan {
    written: PlanFile,
    text: String,
}

/// Contents of a plan file. The keys in the file have the same order as these fields.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PlanFile {
    format: u32,
    program: Program,
    points: PointsEntry,
    base: Value,
    model: Value,
    columns: Vec<String>,
    rows: u64,
    rows_per_part: NonZeroU64,
    /// Id of the plan, which is the SHA-256 hash of the file text with an empty id.
    #[serde(default)]
    sha256: String,
}

impl PlanFile {
    /// Returns the text of the plan file.
    fn text(&self) -> serde_json::Result<String> {
        Ok(serde_json::to_string(self)? + "\n")
    }

    /// Sets the id of the plan to the hash of the text.
    fn sealed(mut self) -> serde_json::Result<Self> {
        self.sha256.clear();
        self.sha256 = digest::of_bytes(self.text()?.as_bytes());
        Ok(self)
    }
}

/// Estimated time and disk space that a dataset takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Calculation time on a single core \[s\].
    pub core_seconds: f64,
    /// Upper bound on the total size of all part files \[B\]. Repeated values take less space than
    /// this bound assumes.
    pub bytes: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Program {
    name: String,
    version: String,
    results: u32,
}

/// Reason why a text is not a valid plan of this program.
#[derive(Debug, Error)]
pub enum PlanError {
    /// The text does not have the structure of a plan.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    /// The plan was made by another program or by another version of this program.
    #[error("it was made by {made_by}, but this is {this}")]
    OtherProgram {
        /// Program that made the plan.
        made_by: String,
        /// This program.
        this: String,
    },
    /// The text of the plan was changed after the plan had been written.
    #[error("it has been changed: its text does not match its SHA-256")]
    Changed,
    /// The case or the settings of the plan are invalid.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// The plan contains unknown columns.
    #[error(transparent)]
    Columns(#[from] TableError),
}

impl Program {
    fn this() -> Self {
        let (name, version) = ("bsm".to_owned(), env!("CARGO_PKG_VERSION").to_owned());
        Self { name, version, results: RESULTS }
    }
}

impl Plan {
    /// Creates the plan of a dataset from a task and its points.
    ///
    /// * `rows_per_part`: number of rows per part. By default, it depends on the number of rows and
    ///   on the model.
    ///
    /// # Errors
    ///
    /// Returns [`DatasetError`] if the points cannot be read, or if there would be more than
    /// [`MAX_PARTS`] parts.
    pub fn new(
        task: &Task,
        points: &Points,
        rows_per_part: Option<NonZeroU64>,
        workers: &Workers<'_>,
    ) -> Result<Self, DatasetError> {
        let (points, rows) = points.entry(workers)?;
        let rule = || rows_of_a_part(rows, task.settings.model);
        let rows_per_part = rows_per_part.unwrap_or_else(rule);
        if rows.div_ceil(rows_per_part.get()) > MAX_PARTS {
            let least = rows.div_ceil(MAX_PARTS);
            return Err(DatasetError::Refused(format!(
                "{rows} rows with {rows_per_part} rows per part make more than {MAX_PARTS} parts; use at least {least} rows \
                 per part"
            )));
        }
        let base = Case { description: None, ..task.base.clone() };
        let written = PlanFile {
            format: FORMAT,
            program: Program::this(),
            points,
            base: base.to_json(),
            model: task.settings.to_json(),
            columns: task.outputs.iter().map(|output| output.name.to_owned()).collect(),
            rows,
            rows_per_part,
            sha256: String::new(),
        };
        let write_error =
            |e: serde_json::Error| DatasetError::io("write", Path::new("plan.json"), e.into());
        let written = written.sealed().map_err(write_error)?;
        Ok(Self { text: written.text().map_err(write_error)?, written })
    }

    /// Parses the text of a plan file.
    ///
    /// # Errors
    /// Returns [`PlanError`] if the text is not a plan, was made by another program version, or has
    /// been changed.
    pub fn from_text(text: &str) -> Result<Self, PlanError> {
        let written: PlanFile = serde_json::from_str(text)?;
        let this = Program::this();
        if (written.format, &written.program) != (FORMAT, &this) {
            let version = |Program { name, version, results }: Program, format| {
                format!("{name} {version} (results {results}, format {format})")
            };
            return Err(PlanError::OtherProgram {
                made_by: version(written.program, written.format),
                this: version(this, FORMAT),
            });
        }
        let written = written.sealed()?;
        let as_written = written.text()?;
        if as_written != text {
            return Err(PlanError::Changed);
        }
        Ok(Self { written, text: as_written })
    }

    /// Returns the task that calculates the dataset.
    ///
    /// # Errors
    ///
    /// Returns [`PlanError`] if the plan contains unknown names.
    pub fn task(&self) -> Result<Task, PlanError> {
        let base = Case::from_json(&serde_json::to_vec(&self.written.base)?)?;
        let settings = Settings::from_json(&self.written.model)?;
        let outputs: Vec<&'static Output> = Answers::select(Some(&self.written.columns))?;
        Ok(Task::new(base, settings, outputs))
    }

    /// Returns the points of the plan. If the points come from a table, the table must not have
    /// changed since the plan was created.
    ///
    /// * `table`: function that returns the path of the table with the given name.
    ///
    /// # Errors
    ///
    /// Returns [`DatasetError`] if the points are invalid, or if the table is missing or has
    /// changed.
    pub fn points(
        &self,
        table: impl FnOnce(&str) -> PathBuf,
        workers: &Workers<'_>,
    ) -> Result<Points, DatasetError> {
        self.written.points.read(table, workers)
    }

    /// Estimates the calculation time and the size of the dataset.
    ///
    /// # Errors
    ///
    /// Returns the same errors as [`task`](Self::task).
    pub fn estimate(&self) -> Result<Estimate, PlanError> {
        /// Size of the footer of a part file without its columns \[B\].
        const FOOTER: f64 = 1500.0;
        /// Size of the footer entry for one column \[B\].
        const COLUMN: f64 = 150.0;
        let task = self.task()?;
        let [rows, parts] = [self.rows(), self.parts()].map(approximate);
        let inputs = self.written.points.inputs();
        #[expect(clippy::cast_precision_loss, reason = "the table has only about fifty columns")]
        let columns = (inputs.len() + task.outputs.len()) as f64;
        let bytes = |output: &&Output| match output.output_type {
            OutputType::Number | OutputType::Integer => 8.0,
            OutputType::Boolean => 0.125,
            OutputType::Text => 0.5,
        };
        let outputs = task.outputs.iter().map(bytes).sum::<f64>();
        // If the model is `auto`, each row contains the reason why its model was chosen.
        let words = if task.settings.model == ModelChoice::Auto { 4.0 } else { 0.5 };
        let data = rows * (words + outputs + inputs.iter().sum::<f64>());
        let core_seconds = rows * seconds(task.settings.model);
        Ok(Estimate { core_seconds, bytes: data + parts * (FOOTER + COLUMN * columns) })
    }

    /// Returns the text of the plan file.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns the id of the plan, which is its SHA-256 hash.
    pub fn id(&self) -> &str {
        &self.written.sha256
    }

    /// Returns the number of rows in the dataset.
    pub fn rows(&self) -> u64 {
        self.written.rows
    }

    /// Returns the number of rows per part. The last part may have fewer rows.
    pub fn rows_per_part(&self) -> u64 {
        self.written.rows_per_part.get()
    }

    /// Returns the number of parts in the dataset. A dataset without rows has one part.
    pub fn parts(&self) -> u64 {
        self.rows().div_ceil(self.rows_per_part()).max(1)
    }

    /// Returns the rows that belong to a part, or an error if the plan has no part with this
    /// number.
    #[cfg(feature = "parquet")]
    pub(super) fn range(&self, number: u64) -> Result<PartRange<'_>, DatasetError> {
        let parts = self.parts();
        (number < parts).then(|| self.range_of(number)).ok_or_else(|| {
            let last = parts - 1;
            let what = format!("the plan has parts 0 to {last}, but no part {number}");
            DatasetError::Refused(what)
        })
    }

    #[cfg(feature = "parquet")]
    pub(super) fn range_of(&self, number: u64) -> PartRange<'_> {
        let first_row = number * self.rows_per_part();
        let rows = self.rows_per_part().min(self.rows() - first_row);
        PartRange { plan: self.id(), number, first_row, rows }
    }

    /// Lists the keys whose values in this plan differ from the values in the text of another plan.
    /// For short values, both values are included. Returns `None` if the text is not a plan.
    pub fn differences(&self, other: &str) -> Option<String> {
        // The hash is not compared, because it differs whenever any other key differs.
        const HASH: &str = "sha256";
        let parse = |text: &str| match serde_json::from_str(text) {
            Ok(Value::Object(keys)) => Some(keys),
            _ => None,
        };
        let (this, other) = (parse(&self.text)?, parse(other)?);
        let all_there = this.keys().all(|key| other.contains_key(key));
        let differ = this.iter().filter(|(key, now)| *key != HASH && other.get(*key) != Some(*now));
        let words = differ.map(|(key, now)| {
            let then = other.get(key).unwrap_or(&Value::Null);
            match (now.to_string(), then.to_string()) {
                (now, then) if now.len() + then.len() < 60 => format!("{key} ({then}, now {now})"),
                _ => key.clone(),
            }
        });
        let words: Vec<_> = words.collect();
        (all_there && !words.is_empty()).then(|| words.join(", "))
    }
}

impl Task {
    /// Describes how a table of results was calculated: program, points, case, settings, and
    /// columns with their units.
    ///
    /// * `points`: description of the points from [`Points::about`].
    /// * `columns`: columns of the table of points.
    pub fn about(&self, points: &Value, columns: &Columns) -> Value {
        let column = |Heading { name, unit, about, .. }: Heading<'_>| {
            (name.to_owned(), json!({ "unit": unit, "about": about }))
        };
        let columns: Map<_, _> = columns.headings(&self.outputs).map(column).collect();
        json!({
            "program": Program::this(),
            "points": points,
            "case": self.base.to_json(),
            "settings": self.settings.to_json(),
            "columns": columns,
        })
    }
}

/// Converts a count to a floating-point number, which is sufficiently accurate for an estimate.
#[expect(clippy::cast_precision_loss, reason = "an estimate does not require exact counts")]
fn approximate(count: u64) -> f64 {
    count as f64
}

/// Returns the estimated time \[s\] that one core needs to solve and write a row with one output.
/// The estimate assumes that the balls roll without gross sliding.
fn seconds(model: ModelChoice) -> f64 {
    let microseconds = match model {
        ModelChoice::Fixed(Model::ClosedForm | Model::QuasiStatic) => 0.1,
        ModelChoice::Fixed(Model::Rigid) => 0.2,
        ModelChoice::Fixed(Model::Elastic) => 0.3,
        ModelChoice::Fixed(Model::RacewayControl) => 0.5,
        ModelChoice::Auto => 10.0,
        ModelChoice::Fixed(Model::Traction) => 20.0,
    };
    1e-6 * microseconds
}

/// Returns the default number of rows per part. It is the largest power of two for which
/// calculating a part takes only a few seconds, so that little work is lost if the run is killed.
/// If this leads to too many parts, the number of rows is doubled until the limit is met.
fn rows_of_a_part(rows: u64, model: ModelChoice) -> NonZeroU64 {
    /// Maximum number of rows per part. It is exceeded only if the dataset would otherwise have too
    /// many parts. A part of this size takes less than an hour even if every point takes a hundred
    /// times as long as estimated, for example with the `rigid` model and large inertia forces.
    const MAX_ROWS: u32 = 1 << 20;
    /// Maximum estimated time for calculating a part on one core \[s\].
    const MAX_SECONDS: f64 = 5.0;

    let mut count = MAX_ROWS;
    while f64::from(count) * seconds(model) > MAX_SECONDS {
        count /= 2;
    }
    let mut count = NonZeroU64::from(NonZeroU32::new(count).unwrap_or(NonZeroU32::MIN));
    while rows.div_ceil(count.get()) > MAX_PARTS {
        count = count.saturating_add(count.get());
    }
    count
}
