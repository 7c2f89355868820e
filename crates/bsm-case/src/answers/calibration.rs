//! Several inputs from a table of measured points.
//!
//! Theory: `docs/theory/12-sensitivities.md`, equations (V6) to (V8).

use std::cmp::Ordering;

use bsm_design::{LeastSquares, SignRuns, least_squares};
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
    /// Measured value, in the unit of the vocabulary.
    value: f64,
    /// Standard deviation of the measured value, or what is proportional to it.
    error: f64,
}

/// How the errors of measured values are assumed to differ between points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MeasurementError {
    /// Errors are proportional to the measured values.
    #[default]
    Relative,
    /// Errors are equal at all points.
    Absolute,
}

impl MeasurementError {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Relative, Self::Absolute];

    /// Name on the command line and in Python.
    pub fn name(self) -> &'static str {
        match self {
            Self::Relative => "relative",
            Self::Absolute => "absolute",
        }
    }

    /// The one of that name.
    ///
    /// # Errors
    ///
    /// [`CaseError`] for another name.
    pub fn named(name: &str) -> Result<Self, CaseError> {
        let found = Self::ALL.into_iter().find(|error| error.name() == name);
        found.ok_or_else(|| bad("errors", format!("{name} is neither relative nor absolute")))
    }

    /// Weighting error of a measured value.
    fn of(self, output: &Output, value: f64) -> Result<f64, CaseError> {
        match self {
            Self::Absolute => Ok(1.0),
            Self::Relative if value != 0.0 => Ok(value.abs()),
            Self::Relative => Err(CaseError::Invalid(format!(
                "{0} is 0, which has no relative error; take absolute errors, or give a column {0}{ERROR}",
                output.name
            ))),
        }
    }
}

/// What follows the name of the output in the name of the column of its errors.
const ERROR: &str = "_error";

/// Probability of as few runs of signs below which residuals are called systematic, over the number of orders that are tried.
const SYSTEMATIC: f64 = 0.05;

/// A fit: case, measured output and inputs to fit.
#[derive(Debug, Clone)]
pub struct Calibration {
    inputs: Vec<(InputKey, (f64, f64))>,
    output: &'static Output,
    /// Assumed errors; `None` if the table has a column of them.
    errors: Option<MeasurementError>,
    points: Vec<MeasuredPoint>,
    /// Inputs that are columns of the table.
    columns: Vec<InputKey>,
}

/// The inputs that come closest to all points.
#[derive(Debug, Clone, PartialEq)]
pub struct CalibrationReport {
    /// Their values, deviations and conditioning; residuals over the errors of the points.
    pub found: LeastSquares,
    /// Root mean square of the residuals in the unit of the output.
    pub scatter: f64,
    /// Root mean square of the residuals over the errors of the points.
    pub weighted_scatter: f64,
}

impl Calibration {
    /// Why there is no report.
    pub const LOST: &str = "a point has no solution with values on the way, or the search does not settle; give \
                            narrower ranges to the inputs";

    /// Seeks `inputs`, each `name` or `name=low:high`, from a CSV table: a column of the output that was measured,
    /// and columns of inputs, in any known units; a column named as that of the output with `_error` at its end has the
    /// standard deviation of each measured value.
    ///
    /// * `errors`: assumed without that column; [`MeasurementError::Relative`] unless given.
    ///
    /// # Errors
    ///
    /// [`CaseError`] for unknown names, invalid ranges, cells that are not numbers, errors that are not positive, and assumed
    /// errors beside a column of them.
    pub fn new(
        base: &Case,
        inputs: &[String],
        output: &str,
        errors: Option<MeasurementError>,
        table: &[u8],
        format: &TableFormat,
    ) -> Result<Self, CaseError> {
        let output = measurable(output)?;
        let inputs = inputs.iter().map(|text| sought(base, text)).collect::<Result<_, _>>()?;
        let cells = Cells::read(table, format)?;
        let columns = cells.columns(|name| ColumnContent::of(name, output))?;
        let count_of = |wanted: fn(&ColumnContent) -> bool| {
            columns.iter().filter(|column| wanted(column)).count()
        };
        if count_of(|column| matches!(column, ColumnContent::Measured(_))) != 1 {
            return Err(bad(output.name, "must be one column of the table of measurements"));
        }
        let errors = match (count_of(|column| matches!(column, ColumnContent::Error(_))), errors) {
            (0, errors) => Some(errors.unwrap_or_default()),
            (1, None) => None,
            (1, Some(errors)) => {
                let what = format!(
                    "is a column of the table, and errors are said to be {}; give one of both",
                    errors.name()
                );
                return Err(bad(format!("{}{ERROR}", output.name), what));
            }
            _ => {
                let key = format!("{}{ERROR}", output.name);
                return Err(bad(key, "must be at most one column of the table of measurements"));
            }
        };
        let points =
            cells.each(&columns, |_, row| MeasuredPoint::of(base, output, errors, &cells, row))?;
        let columns = columns.iter().filter_map(ColumnContent::input).collect();
        Ok(Self { inputs, output, errors, points, columns })
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
                    Some(ours) => left.push((ours - point.value) / point.error),
                    None => return Ok(None),
                }
            }
            Ok::<_, CaseError>(Some(left))
        };
        let found = least_squares(&mut residuals, &start, &bounds)?;
        Ok(found.map(|found| {
            let root_mean_square = |of: &mut dyn Iterator<Item = f64>| {
                let square: f64 = of.map(|x| x * x).sum();
                (square / count(self.points.len())).sqrt()
            };
            let weighted_scatter = root_mean_square(&mut found.residuals.iter().copied());
            let scatter = root_mean_square(&mut self.residuals(&found));
            CalibrationReport { found, scatter, weighted_scatter }
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

    /// Fitted less measured values, in the unit of the output.
    fn residuals(&self, found: &LeastSquares) -> impl Iterator<Item = f64> {
        self.points.iter().zip(&found.residuals).map(|(point, weighted)| point.error * weighted)
    }

    /// Measured and fitted value of each point.
    pub fn fitted(&self, report: &CalibrationReport) -> impl Iterator<Item = (f64, f64)> {
        let points = self.points.iter().zip(self.residuals(&report.found));
        points.map(|(point, left)| (point.value, point.value + left))
    }

    /// The input along which the signs of the residuals have fewest runs for random residuals, if there are too few of them.
    pub fn systematic(&self, report: &CalibrationReport) -> Option<(InputKey, SignRuns)> {
        let of = |key: InputKey| self.points.iter().map(move |point| point.case[key]);
        let varied = |key: &InputKey| of(*key).any(|value| value != self.points[0].case[*key]);
        let keys: Vec<InputKey> = self.columns.iter().copied().filter(varied).collect();
        let level = SYSTEMATIC / count(keys.len());
        let along = |key: InputKey| {
            let mut points: Vec<_> = of(key).zip(&report.found.residuals).collect();
            points.sort_by(|(a, _), (b, _)| a.partial_cmp(b).unwrap_or(Ordering::Equal));
            Some((key, SignRuns::of(points.into_iter().map(|(_, residual)| *residual))?))
        };
        let tried = keys.into_iter().filter_map(along);
        let fewest = tried.min_by(|(_, a), (_, b)| a.probability.total_cmp(&b.probability));
        fewest.filter(|(_, runs)| runs.probability < level)
    }

    /// How the errors are meant, in words.
    fn errors(&self) -> &'static str {
        self.errors.map_or("column", MeasurementError::name)
    }

    fn warnings(&self, case: &Case, report: &CalibrationReport) -> Vec<String> {
        let mut warnings = case.warnings();
        if let Some((key, SignRuns { runs, probability })) = self.systematic(report) {
            warnings.push(format!(
                "The residuals are systematic along {}: their signs have {runs} runs in {} points, and random \
                 residuals have as few in {:.2} % of all fits. The model or another input differs from the \
                 measurement, and the standard deviations are too small.",
                key.name(),
                self.points.len(),
                100.0 * probability
            ));
        }
        warnings
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
        let label = match self.errors {
            Some(MeasurementError::Relative) => "relative RMS residual:",
            Some(MeasurementError::Absolute) => "",
            None => "RMS residual over the given errors:",
        };
        let weighted = (!label.is_empty()).then(|| number(report.weighted_scatter).to_string());
        let free = self.points.len().saturating_sub(self.inputs.len());
        Answer { warnings: self.warnings(case, report), ..Answer::default() }
            .with("output", Content::Json(self.output.name.into()))
            .with("found", Content::Table(found))
            .with("errors", Content::Text("errors:", Some(self.errors().to_owned())))
            .with("root_mean_square", Content::Json(json!(report.scatter)))
            .with("weighted_root_mean_square", Content::Json(json!(report.weighted_scatter)))
            .with("degrees_of_freedom", Content::Json(json!(free)))
            .with("condition", Content::Json(json!(condition)))
            .with_shown(Content::Text(
                "RMS residual:",
                Some(format!("{} ({})", number(report.scatter), self.output.name)),
            ))
            .with_shown(Content::Text(label, weighted))
            .with_shown(Content::Text(
                "condition:",
                Some(format!("{}{caution}", number(condition))),
            ))
            .with("points", Content::Table(points))
    }
}

/// Content of a column: an input, the measured output or its error, times a factor.
enum ColumnContent {
    Input(InputKey, f64),
    Measured(f64),
    Error(f64),
}

impl ColumnContent {
    /// That of a column by its name.
    fn of(name: &str, output: &'static Output) -> Result<Self, CaseError> {
        let factor = |name: &str| {
            let converted = || Some(convert(name, &std::iter::once(output.name))?.1);
            (name == output.name).then_some(1.0).or_else(converted)
        };
        if let Some(factor) = name.strip_suffix(ERROR).and_then(factor) {
            return Ok(Self::Error(factor));
        }
        if name == output.name {
            return Ok(Self::Measured(1.0));
        }
        match InputKey::in_unit(name) {
            Ok((key, factor)) => Ok(Self::Input(key, factor)),
            Err(unknown) => factor(name).map(Self::Measured).ok_or(unknown),
        }
    }

    /// The input, if it is one.
    fn input(&self) -> Option<InputKey> {
        match self {
            Self::Input(key, _) => Some(*key),
            Self::Measured(_) | Self::Error(_) => None,
        }
    }
}

impl MeasuredPoint {
    /// That of a row of the table.
    fn of(
        base: &Case,
        output: &'static Output,
        errors: Option<MeasurementError>,
        cells: &Cells,
        row: &mut dyn Iterator<Item = (&ColumnContent, &str)>,
    ) -> Result<Self, CaseError> {
        let (mut case, mut value, mut error) = (base.clone(), None, None);
        for (column, text) in row {
            let number = cells.number(text)?;
            match column {
                ColumnContent::Input(key, factor) => case.set(key.name(), number * factor)?,
                ColumnContent::Measured(factor) => value = Some(number * factor),
                ColumnContent::Error(factor) => error = Some(number * factor),
            }
        }
        case.check()?;
        let missing = |what: &str| CaseError::Invalid(format!("has no {what}"));
        let value = value.ok_or_else(|| missing(output.name))?;
        let column = format!("{}{ERROR}", output.name);
        let error = match (errors, error) {
            (Some(errors), _) => errors.of(output, value)?,
            (None, Some(error)) if error > 0.0 => error,
            (None, Some(error)) => {
                return Err(bad(column, format!("is {error}, but must be positive")));
            }
            (None, None) => return Err(missing(&column)),
        };
        Ok(Self { case, value, error })
    }
}
