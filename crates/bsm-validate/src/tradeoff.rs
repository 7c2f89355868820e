//! Measures speed and accuracy of all models with various settings at a set of points.
//!
//! The reference solution is calculated by model `traction` with an accuracy of 1e-12 and a creep
//! speed of 1e-5. Errors are determined for the most important outputs. Times are measured on this
//! machine. The time of a point is the median over several rounds. All settings are measured once
//! per round, so that a disturbance affects all of them.

mod advice;
mod clock;
mod errors;
mod pareto;
mod settings;

use bsm_batch::{Chunk, Columns, CsvSource, Source, TableFormat};
use bsm_case::{Case, CaseError, Settings};
use bsm_dyn::{Model, ModelWorkspace};
use bsm_report::Figure;
use schemars::JsonSchema;
use serde::Serialize;

pub use self::advice::Advice;
pub use self::clock::{OneCore, Times};
pub use self::errors::{Distribution, Errors, Group};
pub use self::settings::Setting;

use self::errors::Reference;
use crate::ValidateError;

/// Table of points in the repository: a hundred points with rolling, a hundred with partial skid
/// and a hundred with gross skid.
const CASES: &str = include_str!("../../../validation/golden/tradeoff/cases.csv");

/// Tolerances of the efficiency error. A setting is recommended for each tolerance.
pub const TOLERANCES: [f64; 3] = [1e-2, 1e-3, 1e-4];

/// Operating points at which speed and accuracy are measured.
#[derive(Debug, Clone)]
pub struct Points {
    chunk: Chunk,
    columns: Columns,
    cases: Vec<Case>,
}

impl Points {
    /// Returns the points in the repository. `crates/bsm-validate/examples/case_set.rs` describes
    /// their ranges.
    ///
    /// # Errors
    /// Returns the same errors as [`Points::read`]. None of these errors occurs for the table in
    /// the repository.
    pub fn committed() -> Result<Self, ValidateError> {
        Self::read(&mut CsvSource::new(CASES.as_bytes(), &[], &TableFormat::default())?)
    }

    /// Reads all points from a table.
    ///
    /// # Errors
    ///
    /// Returns [`ValidateError`] if a row cannot be read, or if an input of model `traction` is
    /// missing in a row.
    pub fn read(source: &mut dyn Source) -> Result<Self, ValidateError> {
        let columns = source.columns().clone();
        let none = "the table has no rows, but must have at least one operating point";
        let chunk = source.next(MAX_POINTS + 1)?;
        let chunk = chunk.ok_or_else(|| ValidateError::Invalid(none.to_owned()))?;
        if chunk.len > MAX_POINTS {
            return Err(ValidateError::Invalid(format!(
                "the table has more than {MAX_POINTS} rows; use a sample of the rows"
            )));
        }
        let mut cases = Vec::with_capacity(chunk.len);
        for row in 0..chunk.len {
            let place = format!("row {}", chunk.first + row as u64);
            let in_row = |error: CaseError| ValidateError::of(&place, error);
            let case = chunk.case(&columns, &Case::default(), row).map_err(in_row)?;
            case.problem(&Model::Traction.into()).map_err(in_row)?;
            cases.push(case);
        }
        Ok(Self { chunk, columns, cases })
    }

    /// Returns the operating points as cases.
    pub fn cases(&self) -> &[Case] {
        &self.cases
    }
}

/// Maximum number of points. Measuring more points would take minutes without additional
/// information.
const MAX_POINTS: usize = 3000;

/// Quadrature accuracy of the reference solution.
const FINE: f64 = 1e-12;

/// Returns the settings of the reference solution.
fn reference_settings() -> Settings {
    Settings { accuracy: FINE, creep: 1e-5, ..Model::Traction.into() }
}

/// Returns the settings of the reference solution as command-line options of `bsm solve`.
pub fn reference() -> String {
    let Settings { model, accuracy, creep, .. } = reference_settings();
    format!("--model {} --accuracy {accuracy:e} --creep {creep:e}", model.name())
}

/// Errors and times that were measured for a setting.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct SettingResult {
    /// Model and settings that were measured.
    #[serde(flatten)]
    pub setting: Setting,
    /// Errors for each group that contains points. The first group contains all points.
    pub errors: Vec<Errors>,
    /// Calculation times per point.
    pub times: Times,
}

impl SettingResult {
    /// Returns the errors in a group of points, or `None` if the group contains no points.
    pub fn errors_of(&self, group: Group) -> Option<&Errors> {
        self.errors.iter().find(|errors| errors.group == group)
    }
}

/// Number of points in a group with the same slip regime.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Count {
    /// Group whose points are counted.
    pub group: Group,
    /// Number of points in the group.
    pub points: usize,
}

/// Results of a measurement of speed and accuracy.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct Tradeoff {
    /// Settings of the reference solution, as command-line options of `bsm solve`.
    pub reference: String,
    /// Number of points in each group that contains points. The first group contains all points.
    pub points: Vec<Count>,
    /// Numbers of the rows that have no reference solution, counted from 1. These rows are not
    /// included in any result.
    pub without_reference: Vec<usize>,
    /// Widest instruction set that this machine supports.
    pub instruction_set: &'static str,
    /// Number of threads with which the times for all cores were measured.
    pub threads: usize,
    /// Results for all models and settings, beginning with the fastest models.
    pub settings: Vec<SettingResult>,
    /// Recommended settings for each tolerance and each group of points.
    pub advice: Vec<Advice>,
}

impl Tradeoff {
    /// Returns plots of the efficiency error against the time. Two plots contain all points, solved
    /// one by one or as a table; the other plots contain the points of one slip regime, solved one
    /// by one.
    pub fn figures(&self) -> Vec<Figure> {
        pareto::figures(&self.settings)
    }
}

/// A setting, and its errors in each group of points.
pub type SettingErrors = (Setting, Vec<Errors>);

/// Calculates the errors of every setting at `points` without measuring times. For each setting,
/// the first entry contains the errors over all points.
///
/// # Errors
///
/// Returns [`ValidateError`] if no point has a reference solution.
pub fn accuracy(points: &Points) -> Result<Vec<SettingErrors>, ValidateError> {
    Ok(errors(points)?.1)
}

fn errors(points: &Points) -> Result<(Reference, Vec<SettingErrors>), ValidateError> {
    let mut work = ModelWorkspace::default();
    let reference = Reference::of(points.cases(), &mut work)?;
    let groups = reference.groups();
    let mut measured = Vec::new();
    for setting in settings::all() {
        let errors = reference.errors(points.cases(), &groups, &setting.settings, &mut work)?;
        measured.push((setting, errors));
    }
    Ok((reference, measured))
}

/// Measures the errors and times of every setting at `points`. The function `progress` is called
/// with the number of completed steps and the total number of steps.
///
/// # Errors
///
/// Returns [`ValidateError`] if no point has a reference solution, or if threads cannot be started.
pub fn run(
    points: &Points,
    mut progress: impl FnMut(usize, usize),
) -> Result<Tradeoff, ValidateError> {
    let (reference, errors) = errors(points)?;
    let groups = reference.groups();
    let (settings, errors): (Vec<_>, Vec<_>) = errors.into_iter().unzip();
    let times = clock::times(points, &groups, &settings, &mut progress)?;
    let measured: Vec<_> = settings
        .into_iter()
        .zip(errors)
        .zip(times)
        .map(|((setting, errors), times)| SettingResult { setting, errors, times })
        .collect();
    Ok(Tradeoff {
        reference: self::reference(),
        points: groups.iter().map(|(group, p)| Count { group: *group, points: p.len() }).collect(),
        without_reference: reference.missing(),
        instruction_set: bsm_simd::name(bsm_simd::Arch::new()),
        threads: std::thread::available_parallelism().map_or(1, Into::into),
        advice: advice::of(&measured, &groups.iter().map(|(group, _)| *group).collect::<Vec<_>>()),
        settings: measured,
    })
}
