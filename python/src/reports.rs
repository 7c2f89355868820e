//! Functions that return reports. The names in a report are the names of the program's JSON output.

use std::collections::BTreeMap;
use std::path::PathBuf;

use bsm_batch::{ColumnHead, TableError, TableSink};
use bsm_case::{
    Answer, AxisReport, CATALOG, Calibration, CaseError, Catalog, ColumnValues, Content, DRAWS,
    DesignReport, EllipseFields, Fit, FittedInput, ListColumn, ManufacturerNut, ManufacturerRow,
    Measurement, MeasurementError, ModelChoice, MotionAnswer, NutFilter, NutProblem, NutReport,
    Output, Record, RequirementFile, Samples, Settings, TableFormat, sheet_columns,
    with_groove_intervals,
};
use bsm_dyn::{ModelWorkspace, Solution};
use bsm_report::sheets::{size_figures, size_page, size_results};
use bsm_report::{ReportError, report_files};
use bsm_validate::{PublishedData, ValidateError, validation_page};
use pyo3::prelude::*;
use pyo3_arrow::buffer::PyArrowBuffer;
use rayon::prelude::*;
use serde_json::{Value, json};

use crate::case::{Case, How};
use crate::errors::{Error, Result};
use crate::objects::{Entries, Object, case_of};
use crate::points::{beside, format_of, watched};
use crate::table::{NumberArray, shared};

/// A report: its entries, whether it has a result, and its warnings.
type Report = (Object, bool, Vec<String>);

/// Converts an answer of the program to a report for Python.
fn told(answer: &Answer) -> Report {
    (Object(answer.to_json()), !answer.fails, answer.warnings.clone())
}

/// Runs `work` on the threads of this process. The global threads of Rayon must not be used,
/// because a forked process would wait for them forever.
fn on_threads<R: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> Result<R, CaseError> + Send,
) -> Result<R> {
    watched(py, false, 0, None, None, |_, _| work())
}

/// Calculates the slip at the contacts of a ball.
#[pyfunction]
pub(crate) fn slip(py: Python<'_>, case: &Bound<'_, Case>, how: How) -> Result<Report> {
    motion_report(py, case, &how, bsm_case::slip)
}

/// Analyzes whether the balls jam in the nut or at the ball return.
#[pyfunction]
pub(crate) fn jam(py: Python<'_>, case: &Bound<'_, Case>, how: How) -> Result<Report> {
    motion_report(py, case, &how, |case, _, solution| bsm_case::jam(case, solution))
}

/// Calculates pressure, slip and friction over the contact ellipses.
///
/// * `points`: number of grid points on each semi-axis.
#[pyfunction]
pub(crate) fn ellipses(
    py: Python<'_>,
    case: &Bound<'_, Case>,
    how: How,
    points: u32,
) -> Result<Report> {
    motion_report(py, case, &how, |case, settings, solution| {
        Ok(EllipseFields::of(case, settings, solution, points)?.answer())
    })
}

/// Runs an analysis of a solved motion.
fn motion_report(
    py: Python<'_>,
    case: &Bound<'_, Case>,
    how: &How,
    analysis: impl Fn(&bsm_case::Case, &Settings, &Solution) -> Result<Answer, CaseError> + Sync + Send,
) -> Result<Report> {
    let case = &case.get().with_groove()?;
    on_threads(py, || {
        let work = &mut ModelWorkspace::default();
        let MotionAnswer { settings, solution } = MotionAnswer::of(case, &how.0, work)?;
        if solution.reason().is_some() {
            let record = Record::new(solution).to_json();
            return Ok((Object(Value::Object(record)), false, Vec::new()));
        }
        let answer = analysis(case, &settings, &solution)?;
        let found = answer.with_groove_intervals(case, DRAWS, |possible| {
            let work = &mut ModelWorkspace::default();
            let motion = MotionAnswer::of(possible, &how.0, work).ok()?;
            analysis(possible, &settings, &motion.solution).ok()
        });
        Ok(told(&found))
    })
}

/// Compares all models whose inputs the case contains.
#[pyfunction]
pub(crate) fn compare(py: Python<'_>, case: &Bound<'_, Case>) -> Result<Report> {
    let case = &case.get().with_groove()?;
    on_threads(py, || Ok(told(&bsm_case::comparison(case)?)))
}

/// Calculates the load ratings of a nut.
#[pyfunction]
pub(crate) fn ratings(py: Python<'_>, case: &Bound<'_, Case>) -> Result<Report> {
    let case = &case.get().with_groove()?;
    on_threads(py, || Ok(told(&with_groove_intervals(case, DRAWS, bsm_case::ratings)?)))
}

/// Rows of a table of numbers.
type Lines = Vec<Vec<f64>>;

/// Solves all balls of a nut. Returns the report, the rows of the table of balls, and the rows of
/// the load-displacement curve.
#[pyfunction]
pub(crate) fn nut(
    py: Python<'_>,
    case: &Bound<'_, Case>,
    how: How,
) -> Result<(Report, Lines, Lines)> {
    let case = &case.get().with_groove()?;
    on_threads(py, || {
        let problem = NutProblem::of(case, &how.0)?;
        let settings = problem.settings();
        match problem.solve() {
            Ok(report) => {
                let answer = NutReport::with_groove_intervals(report.answer(), case, &settings);
                Ok((told(&answer), report.balls().rows, report.curve().rows))
            }
            Err(none) => Ok((told(&NutProblem::unsolved(case, &none)), Vec::new(), Vec::new())),
        }
    })
}

/// Names and units of the columns of a table.
type NamesAndUnits = Vec<(&'static str, &'static str)>;

/// Returns the names and units of the columns in two tables of a nut: the table of balls and the
/// load-displacement curve.
#[pyfunction]
pub(crate) fn nut_columns() -> (NamesAndUnits, NamesAndUnits) {
    let named = |columns: Vec<&'static Output>| columns.iter().map(|c| (c.name, c.unit)).collect();
    (named(NutReport::ball_columns()), named(NutReport::curve_columns()))
}

/// Calculates quantiles of the results for nuts with random ball diameters.
#[pyfunction]
pub(crate) fn nut_samples(
    py: Python<'_>,
    case: &Bound<'_, Case>,
    how: How,
    number: u64,
) -> Result<Report> {
    let case = &case.get().with_groove()?;
    on_threads(py, || {
        let problem = NutProblem::of(case, &how.0)?;
        let samples = Samples::new(&problem, number, None)?;
        let nuts: Vec<_> = (0..number).into_par_iter().map(|i| samples.solve(i)).collect();
        let answer = Samples::answer(&nuts, case);
        Ok(told(&Samples::with_groove_intervals(answer, case, &problem.settings(), number, None)))
    })
}

/// An input to find: its name, and the search range in the unit of this name.
type Sought = (String, Option<(f64, f64)>);

fn fitted_input((name, range): Sought) -> FittedInput {
    FittedInput { name, range }
}

/// Condition that determines an input: either the name and value of a measured output, or the title
/// of a rule that must be at its limit.
#[derive(FromPyObject)]
pub(crate) enum Target {
    Measured(String, f64),
    Limit(String),
}

/// Finds the values of an input at which an output has its measured value or a rule is at its
/// limit.
#[pyfunction]
pub(crate) fn fit(
    py: Python<'_>,
    case: &Bound<'_, Case>,
    how: How,
    input: Sought,
    target: Target,
) -> Result<Report> {
    let case = &case.get().with_groove()?;
    let input = fitted_input(input);
    on_threads(py, || {
        let fit = match target {
            Target::Measured(name, value) => Fit::new(case, &input, &Measurement { name, value })?,
            Target::Limit(rule) => Fit::of_limit(case, &input, &rule)?,
        };
        let report = fit.run(case, &how.0)?;
        Ok(told(&fit.answer(case, &report)))
    })
}

/// Fits inputs to a table of measured points.
///
/// * `measured`: name of the measured output.
/// * `errors`: whether the errors of the measured values are relative or absolute.
/// * `table`: measured points as CSV text.
#[pyfunction]
pub(crate) fn fit_table(
    py: Python<'_>,
    case: &Bound<'_, Case>,
    how: How,
    inputs: Vec<Sought>,
    measured: &str,
    errors: Option<&str>,
    table: &[u8],
) -> Result<Report> {
    let case = &case.get().with_groove()?;
    let inputs: Vec<_> = inputs.into_iter().map(fitted_input).collect();
    on_threads(py, || {
        let errors = errors.map(MeasurementError::named).transpose()?;
        let format = TableFormat::default();
        let prepare = |case: &bsm_case::Case| {
            Calibration::new(case, &inputs, measured, errors, table, &format)
        };
        let fit = prepare(case)?;
        let answer = match fit.run(case, &how.0)? {
            Ok(report) => {
                let answer = fit.answer(case, &report);
                Calibration::with_groove_intervals(answer, case, &how.0, prepare)
            }
            Err(none) => Answer { fails: true, warnings: case.warnings(), ..Answer::default() }
                .with("message", Content::Text("", Some(none.to_string()))),
        };
        Ok(told(&answer))
    })
}

/// Selects a screw for a requirement.
///
/// * `free`: true to treat dimensions as continuous variables.
/// * `lists`: see [`sizes`].
#[pyfunction]
pub(crate) fn select(
    py: Python<'_>,
    requirement: Entries,
    free: bool,
    lists: Option<Lists>,
) -> Result<Report> {
    on_threads(py, || {
        // A search over continuous dimensions uses standard ball diameters.
        let catalog = sizes(lists.or(free.then(|| Lists::Named("standard".to_owned()))))?;
        let lists = catalog.lists.clone();
        let requirement = RequirementFile::from_entries(requirement.0, &[], lists)?;
        let standard = if free { None } else { DesignReport::standard(&requirement, &catalog) };
        let report = standard.unwrap_or_else(|| DesignReport::of(&requirement));
        Ok(told(&report.answer()))
    })
}

/// Finds the best contact angle and the self-locking limits.
///
/// * `model`: model for which the best contact angle is also determined, unless the model is
///   `auto`.
#[pyfunction]
pub(crate) fn optimum(
    py: Python<'_>,
    case: &Bound<'_, Case>,
    model: Option<&str>,
) -> Result<Report> {
    let case = &case.get().with_groove()?;
    let model = match model.map(ModelChoice::from_name).transpose()? {
        Some(ModelChoice::Fixed(model)) => Some(model),
        Some(ModelChoice::Auto) | None => None,
    };
    let answer = |case: &bsm_case::Case| bsm_case::optimum(case, model);
    on_threads(py, || Ok(told(&with_groove_intervals(case, DRAWS, answer)?)))
}

/// Files of a report: the path within the folder of the report, and the contents.
type Files = Vec<(String, String)>;

/// Analyzes a feed axis: rules, torque, heat and life.
///
/// * `sheet`: true to also create the files of the axis sheet.
#[pyfunction]
pub(crate) fn axis(
    py: Python<'_>,
    case: &Bound<'_, Case>,
    how: How,
    sheet: bool,
) -> Result<(Report, Files)> {
    let case = &case.get().0;
    let report = on_threads(py, || AxisReport::of(case, &how.0))?;
    let made = || -> Result<Files, ReportError> {
        let (figures, results) = (size_figures(&report), size_results(&report));
        let page = size_page(&report, &figures, None)?;
        report_files(page, &results, &figures)
    };
    let files = if sheet { made()? } else { Vec::new() };
    Ok((told(&report.answer), files))
}

/// Compares the program with published results. Returns the checks and, if requested, the files of
/// the report.
///
/// * `data`: folder with published data. Defaults to the built-in data.
#[pyfunction]
pub(crate) fn validate(
    py: Python<'_>,
    page: bool,
    data: Option<PathBuf>,
) -> Result<(Object, Files)> {
    let run = || -> Result<(Object, Files), ValidateError> {
        let published = data.as_deref().map(PublishedData::read).transpose()?.unwrap_or_default();
        let report = bsm_validate::run(&published)?;
        let files = if page {
            let figures = bsm_validate::figures(&published)?;
            let page = validation_page(&report, &figures)?;
            report_files(page, &report.answer().to_json(), &figures)?
        } else {
            Vec::new()
        };
        Ok((Object(json!(report.checks)), files))
    };
    watched(py, false, 0, None, None, |_, _| run())
}

/// Number of rows that are held in memory while a table is written. The program uses the same
/// number.
const PART: usize = 1 << 14;

/// Writes the columns of a list of nuts, of the balls of a nut or of its load-displacement curve,
/// in the format of the program.
#[pyfunction]
pub(crate) fn write_numbers(
    py: Python<'_>,
    columns: Vec<(String, NumberArray)>,
    path: PathBuf,
) -> Result<()> {
    let format = format_of(&path)?;
    let known = || {
        let catalog = CATALOG.iter().flat_map(|quantity| quantity.columns);
        let of_a_nut = NutReport::ball_columns().into_iter().chain(NutReport::curve_columns());
        catalog.chain(of_a_nut).chain(sheet_columns())
    };
    let named = |(name, _): &(String, NumberArray)| {
        let found = known().find(|column| column.name == name.as_str());
        found.ok_or_else(|| Error::from(format!("no table of the program has a column `{name}`")))
    };
    let names: Vec<_> = columns.iter().map(named).collect::<Result<_>>()?;
    let write = || -> Result<(), TableError> {
        let file = beside(&path)?;
        let heads =
            names.iter().map(|Output { name, unit, .. }| ColumnHead { name, unit, is_text: false });
        let mut sink = TableSink::of_columns(format, file, heads, &TableFormat::default())?;
        let len = columns.first().map_or(0, |(_, values)| values.0.len());
        for first in (0..len).step_by(PART) {
            let rows = first..len.min(first + PART);
            let part = |(_, values): &(String, NumberArray)| {
                ColumnValues::Numbers(values.0[rows.clone()].to_vec())
            };
            sink.write_columns(columns.iter().map(part).collect())?;
        }
        sink.finish(None)?.persist(&path).map_err(|e| TableError::Io(e.error))?;
        Ok(())
    };
    Ok(py.detach(write)?)
}

/// Name, unit and values of each column in a table.
type Table = Vec<(String, &'static str, PyArrowBuffer)>;

/// Nuts in a list. Each nut can be converted to a case.
#[pyclass(frozen, module = "ballscrew._core")]
pub(crate) struct Nuts(Box<dyn Fn(usize) -> Option<Value> + Send + Sync>);

#[pymethods]
impl Nuts {
    /// Returns the case of the nut in the given row.
    fn case(&self, row: usize) -> Result<Case> {
        let case = (self.0)(row).ok_or_else(|| Error::from(format!("no row {row}")))?;
        Case::checked(case_of(case)?)
    }
}

/// Sizes to choose from: the built-in list `manufacturers` or `standard`, or lists given by the
/// user.
pub(crate) enum Lists {
    Named(String),
    Given(Entries),
}

impl<'py> FromPyObject<'_, 'py> for Lists {
    type Error = Error;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> Result<Self> {
        match object.extract() {
            Ok(name) => Ok(Self::Named(name)),
            Err(_) => object.extract().map(Self::Given),
        }
    }
}

/// Returns the sizes to choose from. They default to the sizes of manufacturers.
fn sizes(lists: Option<Lists>) -> Result<Catalog, CaseError> {
    match lists {
        None => Catalog::manufacturers(),
        Some(Lists::Given(lists)) => Catalog::from_entries(lists.0),
        Some(Lists::Named(name)) => match name.as_str() {
            "manufacturers" => Catalog::manufacturers(),
            "standard" => Catalog::standard(),
            other => {
                let what = format!("`{other}` is neither \"manufacturers\" nor \"standard\"");
                Err(CaseError::Entry { key: "lists".to_owned(), what })
            }
        },
    }
}

/// Reads a requirement from the keys of a Python dict.
fn requirement_of(
    entries: Option<Entries>,
    catalog: &Catalog,
) -> Result<Option<RequirementFile>, CaseError> {
    let read =
        |entries: Entries| RequirementFile::from_entries(entries.0, &[], catalog.lists.clone());
    entries.map(read).transpose()
}

/// Results for the nuts of a manufacturer's table. Python receives a dict.
#[derive(IntoPyObject)]
pub(crate) struct ManufacturerTable {
    /// Numeric columns.
    columns: Table,
    /// Name of each nut.
    names: Vec<String>,
    /// For each nut, whether it passes the rules of the requirement (`None` if undecided), and the
    /// names of the failed rules. The list is empty without a requirement.
    verdicts: Vec<(Option<bool>, Vec<&'static str>)>,
    /// How the groove of each nut was determined; `None` if the groove is given.
    grooves: Vec<Option<String>>,
    warnings: Vec<String>,
    /// The nuts as cases.
    nuts: Nuts,
}

/// Compares the catalog data in a manufacturer's table with calculated values.
///
/// * `table`: manufacturer's table as CSV text.
/// * `names`: map from the column names of the table to the names of the program.
/// * `requirement`: requirement that the nuts must meet.
#[pyfunction]
pub(crate) fn manufacturers(
    py: Python<'_>,
    table: &[u8],
    names: BTreeMap<String, Option<String>>,
    requirement: Option<Entries>,
) -> Result<ManufacturerTable> {
    let rows = on_threads(py, || {
        let nuts =
            ManufacturerNut::from_csv(table, &TableFormat { names, ..TableFormat::default() })?;
        let requirement = requirement_of(requirement, &sizes(None)?)?;
        Ok(ManufacturerRow::all(&nuts, requirement.as_ref()))
    })?;
    let rows = rows.map_err(|(name, error)| Error::from(format!("{name}: {error}")))?;
    let listed: Vec<_> = rows.iter().collect();
    let numbers = |(name, unit, values)| match values {
        ColumnValues::Numbers(values) => Some((name, unit, shared(values))),
        ColumnValues::Texts(_) => None,
    };
    let columns = ManufacturerRow::table(&listed).into_iter().filter_map(numbers).collect();
    let names = rows.iter().map(|row| row.name.clone()).collect();
    let verdict = |row: &ManufacturerRow| Some((row.verdict?.passes(), row.failed_rules.clone()));
    let verdicts = rows.iter().filter_map(verdict).collect();
    let grooves = rows.iter().map(|row| row.groove.clone()).collect();
    let warnings = ManufacturerRow::answer(&listed, 0, |_| true).warnings;
    let nuts = Nuts(Box::new(move |row| rows.get(row).map(|row| row.case.to_json())));
    Ok(ManufacturerTable { columns, names, verdicts, grooves, warnings, nuts })
}

/// Returns the name, unit and values of each column in a list of nuts.
///
/// * `lists`: see [`sizes`].
/// * `requirement`: requirement that the nuts must meet.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the arguments are keywords in Python")]
pub(crate) fn select_nuts(
    py: Python<'_>,
    lists: Option<Lists>,
    requirement: Option<Entries>,
    conditions: Vec<String>,
    pareto: bool,
    sort: Option<&str>,
    descending: bool,
    first: Option<usize>,
) -> Result<(Table, Nuts)> {
    let (columns, nuts) = on_threads(py, || {
        let catalog = sizes(lists)?;
        let requirement = requirement_of(requirement, &catalog)?;
        let known = ListColumn::of_sizes(requirement.is_some());
        let mut wanted = NutFilter::new(&conditions, &known, pareto)?;
        if let Some(sort) = sort {
            wanted = wanted.sorted_by(sort, descending, &known)?;
        }
        let list = wanted.choose(catalog, requirement.as_ref());
        let count = list.chosen.len().min(first.unwrap_or(usize::MAX));
        let columns: Vec<_> = list.heads().into_iter().zip(list.values(0..count)).collect();
        let case = move |row: usize| {
            let place = list.chosen.get(row).filter(|_| row < count)?;
            Some(list.case(*place, requirement.as_ref()))
        };
        Ok((columns, Nuts(Box::new(case))))
    })?;
    let column = |((name, unit), values)| match values {
        ColumnValues::Numbers(values) => Some((name, unit, shared(values))),
        ColumnValues::Texts(_) => None,
    };
    Ok((columns.into_iter().filter_map(column).collect(), nuts))
}
