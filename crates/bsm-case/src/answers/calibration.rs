//! Several inputs from a table of measured points.

use bsm_design::search::grid_point;
use bsm_design::{LeastSquares, least_squares};
use bsm_dyn::ModelWorkspace;
use serde_json::json;
use thiserror::Error;

use crate::answers::fit::{exact, measurable, measured, sought};
use crate::vocabulary::cells::Cells;
use crate::vocabulary::error::bad;
use crate::vocabulary::names::{GivenNames, unknown_key};
use crate::vocabulary::number::{count, number};
use crate::vocabulary::units::convert;
use crate::{
    Answer, Case, CaseError, Content, InputKey, InputSet, Output, Settings, Table, TableFormat,
};

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

/// Steps over the range of an input whose reachable outputs are listed.
const REACH_STEPS: u32 = 8;

/// Why a table gives no values of the inputs.
#[derive(Debug, Clone, Error, PartialEq)]
pub enum NoFit {
    /// The search ended without a result.
    #[error(
        "a point has no solution with values on the way, or the search does not settle; give narrower ranges to the \
         inputs"
    )]
    Lost,
    /// The sum of the squared residuals is not finite.
    #[error(
        "the squared residuals are outside the range of double precision: measured {output} goes up to {largest:e}; check \
         its column"
    )]
    NotFinite {
        /// Name of the measured output.
        output: &'static str,
        /// Its largest measured magnitude.
        largest: f64,
    },
}

/// An input that the end of its range holds back, so that the fit fails.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldInput {
    /// The input.
    key: InputKey,
    /// The end of its range where it is.
    at: f64,
    /// Its range.
    range: (f64, f64),
    /// Smallest and largest output of all points over this range.
    reachable: Option<(f64, f64)>,
}

/// The inputs that come closest to all points.
#[derive(Debug, Clone, PartialEq)]
pub struct CalibrationReport {
    /// Their values, deviations and conditioning; residuals in the unit of the output.
    pub found: LeastSquares,
    /// Root mean square of the residuals.
    pub scatter: f64,
    /// Inputs that an end of their range holds back; the fit fails if there is one.
    pub held: Vec<HeldInput>,
}

impl Calibration {
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
        let inputs: Vec<_> =
            inputs.iter().map(|text| sought(base, text)).collect::<Result<_, _>>()?;
        let keys = keys_of(&inputs)?;
        let points = points(base, output, keys, table, format)?;
        Ok(Self { inputs, output, points })
    }

    /// The output that was measured.
    pub fn output(&self) -> &'static str {
        self.output.name
    }

    /// Searches from the values of the case.
    ///
    /// In place of model auto the most complete one is taken.
    ///
    /// # Errors
    ///
    /// [`CaseError`] if the points have no inputs for the model, or it does not give the output.
    pub fn run(
        &self,
        base: &Case,
        settings: &Settings,
    ) -> Result<Result<CalibrationReport, NoFit>, CaseError> {
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
        let Some(found) = found else { return Ok(Err(NoFit::Lost)) };
        let square: f64 = found.residuals.iter().map(|x| x * x).sum();
        let scatter = (square / count(found.residuals.len())).sqrt();
        if !scatter.is_finite() {
            let values = self.points.iter().map(|point| point.value.abs());
            let (output, largest) = (self.output.name, values.fold(0.0, f64::max));
            return Ok(Err(NoFit::NotFinite { output, largest }));
        }
        let is_held = |place: &usize| found.held[*place];
        let held = (0..self.inputs.len()).filter(is_held);
        let held = held.map(|place| self.held(place, &found.at, settings, &mut work));
        let held = held.collect::<Result<_, _>>()?;
        Ok(Ok(CalibrationReport { found, scatter, held }))
    }

    /// Describes an input at the end of its range, where the other inputs have the fitted values.
    fn held(
        &self,
        place: usize,
        fitted: &[f64],
        settings: &Settings,
        work: &mut ModelWorkspace,
    ) -> Result<HeldInput, CaseError> {
        let (key, range) = self.inputs[place];
        let (mut values, mut reachable) = (fitted.to_vec(), None);
        for step in 0..=REACH_STEPS {
            values[place] = grid_point(range, step, REACH_STEPS);
            for point in &self.points {
                let Some(output) = self.solve(&point.case, settings, &values, work)? else {
                    continue;
                };
                let (low, high) = reachable.unwrap_or((output, output));
                reachable = Some((output.min(low), output.max(high)));
            }
        }
        Ok(HeldInput { key, at: fitted[place], range, reachable })
    }

    /// Says that an input is at the end of its range, and what is reachable.
    fn describe(&self, held: &HeldInput) -> String {
        let HeldInput { key, at, range: (low, high), reachable } = held;
        let (input, output) = (key.name(), self.output.name);
        let measured = self.points.iter().map(|point| point.value);
        let (least, most) =
            measured.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        let reach = reachable.map_or_else(String::new, |(a, b)| {
            let [a, b, least, most] = [a, b, least, most].map(number);
            format!(
                ". With {input} from {low} to {high} the model gives {output} from {a} to {b} at these points; measured \
                 are {least} to {most}"
            )
        });
        format!("the fit fails: {input} = {at:.6} is the end of its range{reach}")
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
        let mut warnings = case.warnings();
        warnings.extend(report.held.iter().map(|held| self.describe(held)));
        Answer { warnings, fails: !report.held.is_empty(), ..Answer::default() }
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

/// The inputs to find, none twice and none in two forms.
fn keys_of(inputs: &[(InputKey, (f64, f64))]) -> Result<InputSet, CaseError> {
    let mut given = GivenNames::default();
    inputs.iter().try_for_each(|(key, _)| given.add(key.name(), key.name()))?;
    let keys: InputSet = inputs.iter().map(|(key, _)| *key).collect();
    match keys.two_forms().next() {
        Some(forms) => Err(CaseError::given_twice(forms.map(InputKey::name))),
        None => Ok(keys),
    }
}

/// The measured points of a table.
///
/// * `sought`: the inputs to find, which no column may give or replace.
fn points(
    base: &Case,
    output: &'static Output,
    sought: InputSet,
    table: &[u8],
    format: &TableFormat,
) -> Result<Vec<MeasuredPoint>, CaseError> {
    let cells = Cells::read(table, format)?;
    let outputs = std::iter::once(output.name);
    let columns = cells.columns(|name| {
        let measured = || convert(name, &outputs);
        if name == output.name {
            return Ok(Some((output.name, 1.0)));
        }
        match InputKey::known_in_unit(name) {
            Some((key, _)) if sought.replaced().contains(key) => {
                let what = "is replaced by an input that the fit finds; leave the column out";
                Err(bad(name, what))
            }
            Some((key, factor)) => Ok(Some((key.name(), factor))),
            None => measured().map(Some).ok_or_else(|| unknown_key(name)),
        }
    })?;
    if !columns.iter().flatten().any(|(name, _)| *name == output.name) {
        return Err(bad(output.name, "must be one column of the table of measurements"));
    }
    cells.each(&columns, |_, row| {
        let (mut case, mut settings, mut value) = (base.clone(), Case::default(), None);
        for ((name, factor), text) in row {
            let number = Some(factor * cells.number(text)?);
            if name == output.name {
                value = number;
            } else {
                settings[InputKey::named(name)?] = number;
            }
        }
        case.override_with(&settings);
        case.check()?;
        let value = value.ok_or_else(|| CaseError::Invalid(format!("has no {}", output.name)))?;
        Ok(MeasuredPoint { case, value })
    })
}
