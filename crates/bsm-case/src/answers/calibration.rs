//! Several inputs from a table of measured points.

use bsm_design::{LeastSquares, least_squares};
use bsm_dyn::ModelWorkspace;
use serde_json::json;

use crate::answers::fit::{exact, measurable, measured, sought};
use crate::vocabulary::cells::Cells;
use crate::vocabulary::error::bad;
use crate::vocabulary::number::{count, number};
use crate::vocabulary::units::convert;
use crate::{Answer, Case, CaseError, Content, InputKey, Output, Settings, Table, TableFormat};

/// Columns of the inputs that are found, and of the measured points.
pub(crate) const FOUND: &str = "=input | value | standard_deviation:number?=standard deviation";
pub(crate) const POINTS: &str = "=point | measured | fitted | =difference";

/// A measured point.
#[derive(Debug, Clone)]
struct MeasuredPoint {
    /// Its inputs.
    case: Case,
    /// Measured values, in the unit of the vocabulary.
    value: f64,
}

/// A fit: case, measured output and inputs to fit.
#[derive(Debug, Clone)]
pub struct Calibration {
    inputs: Vec<(InputKey, (f64, f64))>,
    output: &'static Output,
    points: Vec<MeasuredPoint>,
}

/// The inputs that come closest to all points.
#[derive(Debug, Clone, PartialEq)]
pub struct CalibrationReport {
    /// Their values, deviations and conditioning; residuals in the unit of the output.
    pub found: LeastSquares,
    /// Root mean square of the residuals.
    pub scatter: f64,
}

impl Calibration {
    /// Why there is no report.
    pub const LOST: &str = "a point has no solution with values on the way, or the search does not settle; give \
                            narrower ranges to the inputs";

    /// Seeks `inputs`, each `name` or `name=low:high`, from a CSV table: a column of the output that was measured,
    /// and columns of inputs, in any known units.
    ///
    /// # Errors
    ///
    /// [`CaseError`] for unknown names, invalid ranges, and cells that are not numbers.
    pub fn new(
        base: &Case,
        inputs: &[String],
        output: &str,
        table: &[u8],
        format: &TableFormat,
    ) -> Result<Self, CaseError> {
        let output = measurable(output)?;
        let inputs = inputs.iter().map(|text| sought(base, text)).collect::<Result<_, _>>()?;
        let points = points(base, output, table, format)?;
        Ok(Self { inputs, output, points })
    }

    /// The output that was measured.
    pub fn output(&self) -> &'static str {
        self.output.name
    }

    /// Searches from the values of the case.
    ///
    /// In place of model auto the most complete one is taken. `None` if a point has no solution on the way, or the
    /// search does not settle.
    ///
    /// # Errors
    ///
    /// [`CaseError`] if the points have no inputs for the model, or it does not give the output.
    pub fn run(
        &self,
        base: &Case,
        settings: &Settings,
    ) -> Result<Option<CalibrationReport>, CaseError> {
        let start: Vec<_> = self
            .inputs
            .iter()
            .map(|(key, (low, high))| {
                let known = base.value_or_default(*key).filter(|x| low < x && x < high);
                known.unwrap_or(0.5 * (low + high))
            })
            .collect();
        let (bounds, mut work): (Vec<_>, _) =
            (self.inputs.iter().map(|(_, range)| *range).collect(), ModelWorkspace::default());
        let mut residuals = |values: &[f64]| {
            let mut left = Vec::with_capacity(self.points.len());
            for point in &self.points {
                match self.solve(&point.case, settings, values, &mut work)? {
                    Some(ours) => left.push(ours - point.value),
                    None => return Ok(None),
                }
            }
            Ok::<_, CaseError>(Some(left))
        };
        let found = least_squares(&mut residuals, &start, &bounds)?;
        Ok(found.map(|found| {
            let square: f64 = found.residuals.iter().map(|x| x * x).sum();
            let scatter = (square / count(found.residuals.len())).sqrt();
            CalibrationReport { found, scatter }
        }))
    }

    /// The output of a point with these values of the inputs, if it has a solution.
    fn solve(
        &self,
        case: &Case,
        settings: &Settings,
        values: &[f64],
        work: &mut ModelWorkspace,
    ) -> Result<Option<f64>, CaseError> {
        let mut case = case.clone();
        for ((key, _), value) in self.inputs.iter().zip(values) {
            case.set(key.name(), *value)?;
        }
        let settings = exact(&case, settings)?;
        measured(self.output, &case, &settings, work)
    }

    /// Rows of input, value and standard deviation.
    pub fn rows(&self, report: &CalibrationReport) -> Vec<(&'static str, f64, Option<f64>)> {
        let deviation = |i: usize| report.found.deviations.as_ref().map(|all| all[i]);
        let rows = self.inputs.iter().zip(&report.found.at).enumerate();
        rows.map(|(i, ((key, _), value))| (key.name(), *value, deviation(i))).collect()
    }

    /// Measured and fitted value of each point.
    pub fn fitted(&self, report: &CalibrationReport) -> impl Iterator<Item = (f64, f64)> {
        let points = self.points.iter().zip(&report.found.residuals);
        points.map(|(point, left)| (point.value, point.value + left))
    }

    /// The answer: the values, what they leave over, and each point.
    pub fn answer(&self, case: &Case, report: &CalibrationReport) -> Answer {
        let condition = report.found.condition;
        let row = |(name, value, deviation): (&str, f64, Option<f64>)| {
            vec![json!(name), json!(value), json!(deviation)]
        };
        let found = Table::of(FOUND, self.rows(report).into_iter().map(row)).keyed();
        let point = |(place, (measured, fitted)): (usize, (f64, f64))| {
            vec![json!(place), json!(measured), json!(fitted), json!(fitted - measured)]
        };
        let points = (1..).zip(self.fitted(report)).map(point);
        let points = Table::of(POINTS, points);
        let caution = if condition > 1e3 { ": the inputs are poorly determined" } else { "" };
        Answer { warnings: case.warnings(), ..Answer::default() }
            .with("output", Content::Json(self.output.name.into()))
            .with("found", Content::Table(found))
            .with("root_mean_square", Content::Json(json!(report.scatter)))
            .with("condition", Content::Json(json!(condition)))
            .with_shown(Content::Text(
                "RMS residual:",
                Some(format!("{} ({})", number(report.scatter), self.output.name)),
            ))
            .with_shown(Content::Text(
                "condition:",
                Some(format!("{}{caution}", number(condition))),
            ))
            .with("points", Content::Table(points))
    }
}

/// Content of a column: an input or the measured output, times a factor.
enum ColumnContent {
    Input(InputKey, f64),
    Measured(f64),
}

fn points(
    base: &Case,
    output: &'static Output,
    table: &[u8],
    format: &TableFormat,
) -> Result<Vec<MeasuredPoint>, CaseError> {
    let cells = Cells::read(table, format)?;
    let outputs = std::iter::once(output.name);
    let columns = cells.columns(|name| {
        if name == output.name {
            return Ok(ColumnContent::Measured(1.0));
        }
        match InputKey::in_unit(name) {
            Ok((key, factor)) => Ok(ColumnContent::Input(key, factor)),
            Err(unknown) => match convert(name, &outputs) {
                Some((_, factor)) => Ok(ColumnContent::Measured(factor)),
                None => Err(unknown),
            },
        }
    })?;
    if columns.iter().filter(|column| matches!(column, ColumnContent::Measured(_))).count() != 1 {
        return Err(bad(output.name, "must be one column of the table of measurements"));
    }
    cells.each(&columns, |_, row| {
        let (mut case, mut value) = (base.clone(), None);
        for (column, text) in row {
            let number = cells.number(text)?;
            match column {
                ColumnContent::Input(key, factor) => case.set(key.name(), number * factor)?,
                ColumnContent::Measured(factor) => value = Some(number * factor),
            }
        }
        case.check()?;
        let value = value.ok_or_else(|| CaseError::Invalid(format!("has no {}", output.name)))?;
        Ok(MeasuredPoint { case, value })
    })
}
