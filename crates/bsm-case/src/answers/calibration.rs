//! Fit of several inputs to a table of measured points.
//!
//! Theory: `docs/theory/12-sensitivities.md`, equations (V6) to (V8).

use std::cmp::Ordering;

use bsm_design::Range;
use bsm_design::groove::FEW_DRAWS;
use bsm_design::search::grid_point;
use bsm_design::statistics::{LeastSquares, SignRuns, least_squares};
use bsm_dyn::ModelWorkspace;
use thiserror::Error;

use crate::answers::fit::{exact, measurable, measured};
use crate::vocabulary::cells::Cells;
use crate::vocabulary::error::invalid_input;
use crate::vocabulary::members::{Data, Keyed, Label, Rows, Word, answer, row};
use crate::vocabulary::names::{GivenNames, unknown_key};
use crate::vocabulary::number::{count, format_number};
use crate::vocabulary::units::{UnitChange, convert};
use crate::{
    Answer, Case, CaseError, FittedInput, InputKey, InputSet, Output, Settings, TableFormat,
};

row! {
    /// A fitted input.
    pub(crate) struct FoundRow {
        [skip] input: &'static str = "input";
        value: f64 = "value";
        standard_deviation: Option<f64> = "standard deviation";
    }
}

row! {
    /// A measured point.
    pub(crate) struct PointRow {
        [skip] point: usize = "point";
        measured: f64 = "measured";
        fitted: f64 = "fitted";
        [skip] difference: f64 = "difference";
    }
}

answer! {
    /// Inputs fitted to a table of points.
    pub(crate) struct CalibrationMembers {
        /// Name of the measured output.
        output: Data<&'static str>;
        found: Keyed<FoundRow>;
        /// Assumed errors.
        errors: Word;
        /// RMS residual.
        root_mean_square: Data<f64>;
        /// Root mean square of the residuals, each divided by its measurement error.
        weighted_root_mean_square: Data<f64>;
        degrees_of_freedom: Data<usize>;
        /// Condition number of the fit.
        #[schemars(with = "Option<f64>")]
        condition: Data<f64>;
        [skip] shown_residual: Word;
        [skip] shown_weighted: Label;
        [skip] shown_condition: Word;
        points: Rows<PointRow>;
    }
}

/// A row of the measurement table: an operating point with its measured value.
#[derive(Debug, Clone)]
struct MeasuredPoint {
    /// Inputs of the measured operating point.
    case: Case,
    /// Measured value, in the unit of the output.
    value: f64,
    /// Standard deviation of the measured value, or a number proportional to it.
    error: f64,
}

/// Assumption about the errors of the measured values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MeasurementError {
    /// The measurement errors are proportional to the measured values.
    #[default]
    Relative,
    /// The measurement errors are equal at all points.
    Absolute,
}

impl MeasurementError {
    /// All kinds of measurement errors.
    pub const ALL: [Self; 2] = [Self::Relative, Self::Absolute];

    /// Returns the name that the command line and Python use for this kind of measurement error.
    pub fn name(self) -> &'static str {
        match self {
            Self::Relative => "relative",
            Self::Absolute => "absolute",
        }
    }

    /// Returns the kind of measurement error with the given name.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] if no kind of measurement error has the given name.
    pub fn named(name: &str) -> Result<Self, CaseError> {
        let found = Self::ALL.into_iter().find(|error| error.name() == name);
        found.ok_or_else(|| {
            invalid_input("errors", format!("is {name}, but must be relative or absolute"))
        })
    }

    /// Returns the measurement error by which the residual of a measured value is divided.
    fn of(self, output: &Output, value: f64) -> Result<f64, CaseError> {
        match self {
            Self::Absolute => Ok(1.0),
            Self::Relative if value != 0.0 => Ok(value.abs()),
            Self::Relative => Err(CaseError::Invalid(format!(
                "{0} is 0, so its error cannot be relative; use absolute errors, or add a column {0}{ERROR}",
                output.name
            ))),
        }
    }
}

/// Suffix that distinguishes the column of measurement errors from the column of the measured
/// output.
const ERROR: &str = "_error";

/// Significance level of the runs test for the residuals. The points are sorted by each varied
/// input one after the other, so the level is divided by the number of varied inputs. Residuals are
/// reported as systematic if the probability that random residuals have so few sign changes is
/// below the resulting level.
const SYSTEMATIC: f64 = 0.05;

/// A fit of several inputs to measured values of one output.
#[derive(Debug, Clone)]
pub struct Calibration {
    inputs: Vec<(InputKey, (f64, f64))>,
    output: &'static Output,
    /// Assumed measurement errors; `None` if the table has a column of errors.
    errors: Option<MeasurementError>,
    points: Vec<MeasuredPoint>,
    /// Inputs that have a column in the table.
    columns: Vec<InputKey>,
}

/// Number of steps over the search range of an input at which the output is calculated to find the
/// reachable values.
const REACH_STEPS: u32 = 8;

/// Reason why the fit to a table failed.
#[derive(Debug, Clone, Error, PartialEq)]
pub enum NoFit {
    /// The search ended without a result. The message lists the possible reasons.
    #[error(
        "a point has no solution for some values of the fitted inputs, or the search does not converge; \
         give narrower ranges for the inputs"
    )]
    NotConverged,
    /// The sum of the squared residuals is not finite.
    #[error(
        "the squared residuals are outside the range of double precision, because measured {output} reaches {largest:e}; check \
         its column"
    )]
    NotFinite {
        /// Name of the measured output.
        output: &'static str,
        /// Largest magnitude of the measured values.
        largest: f64,
    },
}

/// A fitted input that ended at a limit of its search range. The fit then fails.
#[derive(Debug, Clone, PartialEq)]
pub struct InputAtLimit {
    /// Name of the input.
    key: InputKey,
    /// Limit of the search range that the fitted input has reached.
    limit: f64,
    /// Search range of the input.
    range: (f64, f64),
    /// Smallest and largest output over all points and over the search range of the input.
    reachable: Option<(f64, f64)>,
}

/// Result of the fit to all measured points.
#[derive(Debug, Clone, PartialEq)]
pub struct CalibrationReport {
    /// Values, standard deviations and conditioning of the fitted inputs, and the residual of each
    /// point divided by its measurement error.
    pub found: LeastSquares,
    /// Root mean square of the residuals, in the unit of the output.
    pub scatter: f64,
    /// Root mean square of the residuals, each divided by the measurement error of its point.
    pub weighted_scatter: f64,
    /// Inputs that ended at a limit of their search range. If the list is not empty, the fit fails.
    pub at_limit: Vec<InputAtLimit>,
}

impl Calibration {
    /// Prepares a fit of `inputs` to a CSV table. The table has a column with the measured output,
    /// and columns with inputs in any known units. An optional column, named after the output with
    /// the suffix `_error`, contains the standard deviation of each measured value.
    ///
    /// * `errors`: assumed errors if the table has no `_error` column. Defaults to
    ///   [`MeasurementError::Relative`].
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] for unknown names, invalid ranges, cells that are not numbers, and
    /// errors that are not positive. A table with an `_error` column is also rejected if `errors`
    /// is given.
    pub fn new(
        base: &Case,
        inputs: &[FittedInput],
        output: &str,
        errors: Option<MeasurementError>,
        table: &[u8],
        format: &TableFormat,
    ) -> Result<Self, CaseError> {
        let (output, _) = measurable(output)?;
        let inputs: Vec<_> =
            inputs.iter().map(|input| input.of_points(base)).collect::<Result<_, _>>()?;
        let keys = keys_of(&inputs)?;
        let cells = Cells::read(table, format)?;
        let Measurements { points, assumed_errors, columns } =
            points(base, output, keys, errors, &cells)?;
        Ok(Self { inputs, output, errors: assumed_errors, points, columns })
    }

    /// If the groove of the case is estimated, adds the 90 % intervals of the fitted values to the
    /// answer.
    ///
    /// * `prepare`: function that prepares the same fit for a case with another possible groove.
    pub fn with_groove_intervals(
        answer: Answer,
        case: &Case,
        settings: &Settings,
        prepare: impl Fn(&Case) -> Result<Self, CaseError> + Sync,
    ) -> Answer {
        let mut answer = answer.with_groove_intervals(case, FEW_DRAWS, |possible| {
            let fit = prepare(possible).ok()?;
            let report = fit.run(possible, settings).ok()?.ok()?;
            Some(fit.answer(possible, &report))
        });
        if case.has_estimated_groove() {
            answer.notes.push(
                "The intervals of the fitted inputs contain the uncertainty of the estimated groove, but not the measurement errors. The \
                 standard deviations contain the measurement errors, but not the uncertainty of the groove."
                    .to_owned(),
            );
        }
        answer
    }

    /// Returns the name of the output that was measured.
    pub fn output(&self) -> &'static str {
        self.output.name
    }

    /// Fits the inputs, starting from the values of the case.
    /// The choice `auto` is replaced by the most complete model.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] if the points lack inputs of the model, or the model does not
    /// calculate the output.
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
                    Some(ours) => left.push((ours - point.value) / point.error),
                    None => return Ok(None),
                }
            }
            Ok::<_, CaseError>(Some(left))
        };
        let found = least_squares(&mut residuals, &start, &bounds)?;
        let Some(found) = found else { return Ok(Err(NoFit::NotConverged)) };
        let root_mean_square = |of: &mut dyn Iterator<Item = f64>| {
            let square: f64 = of.map(|x| x * x).sum();
            (square / count(self.points.len())).sqrt()
        };
        let weighted_scatter = root_mean_square(&mut found.residuals.iter().copied());
        let scatter = root_mean_square(&mut self.residuals(&found));
        if !(scatter.is_finite() && weighted_scatter.is_finite()) {
            let values = self.points.iter().map(|point| point.value.abs());
            let (output, largest) = (self.output.name, values.fold(0.0, f64::max));
            return Ok(Err(NoFit::NotFinite { output, largest }));
        }
        let is_held = |place: &usize| found.at_bound[*place];
        let at_limit = (0..self.inputs.len()).filter(is_held);
        let at_limit = at_limit
            .map(|place| self.input_at_limit(place, &found.parameters, settings, &mut work));
        let at_limit = at_limit.collect::<Result<_, _>>()?;
        Ok(Ok(CalibrationReport { found, scatter, weighted_scatter, at_limit }))
    }

    /// Calculates the range of reachable outputs if one input varies over its search range and the
    /// other inputs keep their fitted values.
    fn input_at_limit(
        &self,
        place: usize,
        fitted: &[f64],
        settings: &Settings,
        work: &mut ModelWorkspace,
    ) -> Result<InputAtLimit, CaseError> {
        let (key, range) = self.inputs[place];
        let (mut values, mut reachable) = (fitted.to_vec(), None);
        for step in 0..=REACH_STEPS {
            values[place] = grid_point(Range { low: range.0, high: range.1 }, step, REACH_STEPS);
            for point in &self.points {
                let Some(output) = self.solve(&point.case, settings, &values, work)? else {
                    continue;
                };
                let (low, high) = reachable.unwrap_or((output, output));
                reachable = Some((output.min(low), output.max(high)));
            }
        }
        Ok(InputAtLimit { key, limit: fitted[place], range, reachable })
    }

    /// Returns a sentence that reports an input at a limit of its search range, and states the
    /// reachable outputs.
    fn describe(&self, input: &InputAtLimit) -> String {
        let InputAtLimit { key, limit, range: (low, high), reachable } = input;
        let (input, output) = (key.name(), self.output.name);
        let measured = self.points.iter().map(|point| point.value);
        let (least, most) =
            measured.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        let reach = reachable.map_or_else(String::new, |(a, b)| {
            let [a, b, least, most] = [a, b, least, most].map(format_number);
            format!(
                ". With {input} from {low} to {high}, the model gives {output} from {a} to {b} at these points, but the measured \
                 values are {least} to {most}"
            )
        });
        format!("the fit fails, because {input} = {limit:.6} is at the end of its range{reach}")
    }

    /// Returns the output at a point for the given values of the fitted inputs, or `None` if the
    /// point has no solution.
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

    /// Returns one row per fitted input with its name, value and standard deviation.
    pub fn rows(&self, report: &CalibrationReport) -> Vec<(&'static str, f64, Option<f64>)> {
        let deviation = |i: usize| report.found.deviations.as_ref().map(|all| all[i]);
        let rows = self.inputs.iter().zip(&report.found.parameters).enumerate();
        rows.map(|(i, ((key, _), value))| (key.name(), *value, deviation(i))).collect()
    }

    /// Returns the fitted value minus the measured value of each point, in the unit of the output.
    fn residuals(&self, found: &LeastSquares) -> impl Iterator<Item = f64> {
        self.points.iter().zip(&found.residuals).map(|(point, weighted)| point.error * weighted)
    }

    /// Returns the measured and the fitted value of each point.
    pub fn fitted(&self, report: &CalibrationReport) -> impl Iterator<Item = (f64, f64)> {
        let points = self.points.iter().zip(self.residuals(&report.found));
        points.map(|(point, left)| (point.value, point.value + left))
    }

    /// Returns the input on which the residuals depend systematically, or `None` if there is none.
    /// The points are sorted by each varied input in turn, and the runs of residuals with equal
    /// signs are counted. The input whose number of runs is least probable is returned, provided
    /// that this probability is too small for random residuals.
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

    /// Returns the name of the assumed kind of measurement error.
    fn errors(&self) -> &'static str {
        self.errors.map_or("column", MeasurementError::name)
    }

    fn warnings(&self, case: &Case, report: &CalibrationReport) -> Vec<String> {
        let mut warnings = case.warnings();
        if let Some((key, SignRuns { runs, probability })) = self.systematic(report) {
            warnings.push(format!(
                "The residuals depend systematically on {}: sorted by this input, the signs of the residuals form only {runs} runs in {} points; with random residuals, only {:.2} % of all fits would have so few runs. The model or another input differs from the \
                 measurement, and the standard deviations are too small.",
                key.name(),
                self.points.len(),
                100.0 * probability
            ));
        }
        warnings
    }

    /// Returns the answer: the fitted values, the residuals and the points.
    pub fn answer(&self, case: &Case, report: &CalibrationReport) -> Answer {
        let condition = report.found.condition;
        let row =
            |(input, value, standard_deviation)| FoundRow { input, value, standard_deviation };
        let found = self.rows(report).into_iter().map(row).collect();
        let point = |(point, (measured, fitted)): (usize, (f64, f64))| PointRow {
            point,
            measured,
            fitted,
            difference: fitted - measured,
        };
        let points = (1..).zip(self.fitted(report)).map(point).collect();
        let caution = if condition > 1e3 { ": the inputs are poorly determined" } else { "" };
        let label = match self.errors {
            Some(MeasurementError::Relative) => "relative RMS residual:",
            Some(MeasurementError::Absolute) => "",
            None => "RMS residual relative to the given errors:",
        };
        let weighted = (!label.is_empty()).then(|| format_number(report.weighted_scatter));
        let free = self.points.len().saturating_sub(self.inputs.len());
        let mut warnings = self.warnings(case, report);
        warnings.extend(report.at_limit.iter().map(|at_limit| self.describe(at_limit)));
        let residual = format!("{} ({})", format_number(report.scatter), self.output.name);
        let of = Answer { warnings, fails: !report.at_limit.is_empty(), ..Answer::default() };
        of.with_members(CalibrationMembers {
            output: Data(self.output.name),
            found: Keyed(found),
            errors: Word("errors:", self.errors().to_owned()),
            root_mean_square: Data(report.scatter),
            weighted_root_mean_square: Data(report.weighted_scatter),
            degrees_of_freedom: Data(free),
            condition: Data(condition),
            shown_residual: Word("RMS residual:", residual),
            shown_weighted: Label(label, weighted),
            shown_condition: Word(
                "condition number:",
                format!("{}{caution}", format_number(condition)),
            ),
            points: Rows(points),
        })
    }
}

/// Returns the set of fitted inputs, or an error if an input is given twice or a quantity is given
/// in two forms.
fn keys_of(inputs: &[(InputKey, (f64, f64))]) -> Result<InputSet, CaseError> {
    let mut given = GivenNames::default();
    inputs.iter().try_for_each(|(key, _)| given.add(key.name(), key.name()))?;
    let keys: InputSet = inputs.iter().map(|(key, _)| *key).collect();
    match keys.two_forms().next() {
        Some(forms) => Err(CaseError::given_twice(forms.map(InputKey::name))),
        None => Ok(keys),
    }
}

/// Measured points that were read from a table.
struct Measurements {
    points: Vec<MeasuredPoint>,
    /// Assumed errors; `None` if the table has a column of errors.
    assumed_errors: Option<MeasurementError>,
    /// Inputs that have a column in the table.
    columns: Vec<InputKey>,
}

/// Reads the measured points of a table.
///
/// * `sought`: fitted inputs. A column must contain neither a fitted input nor an alternative input
///   for the same quantity.
/// * `errors`: assumed kind of measurement errors, if given.
fn points(
    base: &Case,
    output: &'static Output,
    sought: InputSet,
    errors: Option<MeasurementError>,
    cells: &Cells,
) -> Result<Measurements, CaseError> {
    let columns = cells.columns(|name| {
        let measured = |name: &str| {
            let same = (name == output.name).then_some((output.name, UnitChange::NONE));
            same.or_else(|| convert(name, [output.name]))
        };
        if let Some((_, change)) = name.strip_suffix(ERROR).and_then(measured) {
            return Ok(Some((ERROR, UnitChange { zero: 0.0, ..change })));
        }
        if name == output.name {
            return Ok(Some((output.name, UnitChange::NONE)));
        }
        match InputKey::known_in_unit(name) {
            Some((key, _)) if sought.replaced().contains(key) => {
                let what = "is replaced by an input that the fit determines; remove the column";
                Err(invalid_input(name, what))
            }
            Some((key, change)) => Ok(Some((key.name(), change))),
            None => measured(name).map(Some).ok_or_else(|| unknown_key(name)),
        }
    })?;
    if !columns.iter().flatten().any(|(name, _)| *name == output.name) {
        return Err(invalid_input(output.name, "must be one column of the table of measurements"));
    }
    let has_errors = columns.iter().flatten().any(|(name, _)| *name == ERROR);
    let errors = match (has_errors, errors) {
        (false, errors) => Some(errors.unwrap_or_default()),
        (true, None) => None,
        (true, Some(errors)) => {
            let what = format!(
                "is a column of the table, but the option for errors is also set (to {}); use only one of them",
                errors.name()
            );
            return Err(invalid_input(format!("{}{ERROR}", output.name), what));
        }
    };
    let inputs = columns.iter().flatten().filter_map(|(name, _)| InputKey::named(name).ok());
    let inputs = inputs.collect();
    let points = cells.each(&columns, |_, row| {
        let (mut case, mut settings) = (base.clone(), Case::default());
        let (mut value, mut error) = (None, None);
        for ((name, change), text) in row {
            let number = Some(change.value(cells.number(text)?));
            if name == output.name {
                value = number;
            } else if name == ERROR {
                error = number;
            } else {
                settings[InputKey::named(name)?] = number;
            }
        }
        case.override_with(&settings);
        case.check()?;
        let missing = |what: &str| CaseError::Invalid(format!("has no {what}"));
        let value = value.ok_or_else(|| missing(output.name))?;
        let column = format!("{}{ERROR}", output.name);
        let error = match (errors, error) {
            (Some(errors), _) => errors.of(output, value)?,
            (None, Some(error)) if error > 0.0 => error,
            (None, Some(error)) => {
                return Err(invalid_input(column, format!("is {error}, but must be positive")));
            }
            (None, None) => return Err(missing(&column)),
        };
        Ok(MeasuredPoint { case, value, error })
    })?;
    Ok(Measurements { points, assumed_errors: errors, columns: inputs })
}
