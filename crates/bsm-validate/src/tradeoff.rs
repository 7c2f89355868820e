//! Comparison of the speed and accuracy of every model and setting on a set of points.
//!
//! The reference is traction with an accuracy of 1e-12 and a creep speed of 1e-5. Errors are
//! calculated for the results that users ask for. The times are measured on this machine. The time
//! of a point is the median over several rounds, in which the settings take turns, so that a
//! disturbance affects all of them.

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

/// The committed points: a hundred each in rolling, partial skid and gross skid.
const CASES: &str = include_str!("../../../validation/golden/tradeoff/cases.csv");

/// Errors of the efficiency for which a setting is recommended.
pub const TOLERANCES: [f64; 3] = [1e-2, 1e-3, 1e-4];

/// Operating points.
#[derive(Debug, Clone)]
pub struct Points {
    chunk: Chunk,
    columns: Columns,
    cases: Vec<Case>,
}

impl Points {
    /// Returns the committed points, in the ranges of `crates/bsm-validate/examples/case_set.rs`.
    ///
    /// # Errors
    ///
    /// The errors of [`Points::read`]. None of them occurs for the committed table.
    pub fn committed() -> Result<Self, ValidateError> {
        Self::read(&mut CsvSource::new(CASES.as_bytes(), &[], &TableFormat::default())?)
    }

    /// Reads all rows of a table.
    ///
    /// # Errors
    ///
    /// [`ValidateError`] if a row cannot be read, or lacks inputs of the model traction.
    pub fn read(source: &mut dyn Source) -> Result<Self, ValidateError> {
        let columns = source.columns().clone();
        let none = "the table has no rows; give at least one operating point";
        let chunk = source.next(MAX_POINTS + 1)?;
        let chunk = chunk.ok_or_else(|| ValidateError::Invalid(none.to_owned()))?;
        if chunk.len > MAX_POINTS {
            return Err(ValidateError::Invalid(format!(
                "more than {MAX_POINTS} rows; take a sample of them"
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

/// Maximum number of points. More points would take minutes without more information.
const MAX_POINTS: usize = 3000;

/// Accuracy of the quadrature of the reference.
const FINE: f64 = 1e-12;

/// Settings of the reference.
fn reference_settings() -> Settings {
    Settings { accuracy: FINE, creep: 1e-5, ..Model::Traction.into() }
}

/// Returns the reference setting as options of `bsm solve`.
pub fn reference() -> String {
    let Settings { model, accuracy, creep, .. } = reference_settings();
    format!("--model {} --accuracy {accuracy:e} --creep {creep:e}", model.name())
}

/// A setting, its errors and its times.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct SettingResult {
    /// The setting.
    #[serde(flatten)]
    pub setting: Setting,
    /// Errors over all points, then by motion of the balls, for groups that have points.
    pub errors: Vec<Errors>,
    /// Times of a point.
    pub times: Times,
}

impl SettingResult {
    /// Returns the errors over the points of a group, or `None` if the group has no points.
    pub fn errors_of(&self, group: Group) -> Option<&Errors> {
        self.errors.iter().find(|errors| errors.group == group)
    }
}

/// Number of points of a group.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Count {
    /// The group.
    pub group: Group,
    /// Number of points.
    pub points: usize,
}

/// The measurement.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct Tradeoff {
    /// Reference of the errors, as options of `bsm solve`.
    pub reference: String,
    /// The groups that have points. The group of all points comes first.
    pub points: Vec<Count>,
    /// Rows, counted from 1, that have no reference. They are not included in any result.
    pub without_reference: Vec<usize>,
    /// Widest instruction set of this machine.
    pub instruction_set: &'static str,
    /// Number of threads of the columns "all cores".
    pub threads: usize,
    /// All settings, beginning with the fastest models.
    pub settings: Vec<SettingResult>,
    /// Recommended setting for each tolerance.
    pub advice: Vec<Advice>,
}

impl Tradeoff {
    /// Figures of the efficiency error against the time: one by one and in batches over all points,
    /// then by motion of the balls.
    pub fn figures(&self) -> Vec<Figure> {
        pareto::figures(&self.settings)
    }
}

/// A setting and its errors, over all points and by motion of the balls.
pub type SettingErrors = (Setting, Vec<Errors>);

/// Returns the errors of every setting over `points`, without times. The group of all points comes
/// first.
///
/// # Errors
///
/// [`ValidateError`] if no point has a reference.
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

/// Measures every setting over `points`. `progress` is called with the number of completed steps
/// and the number of all steps.
///
/// # Errors
///
/// [`ValidateError`] if no point has a reference or threads cannot be started.
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
