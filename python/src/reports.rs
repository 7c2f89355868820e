//! Reports as JSON, in the names of the program.

use bsm_case::{
    Analysis, CATALOGUE_COLUMNS, CapacityReport, CaseError, Catalogue, CatalogueColumn, Condition,
    DesignReport, Fit, Moving, NutProblem, OptimumReport, Record, RequirementFile, Samples,
    SizeReport, Spectrum,
};
use bsm_dyn::{Model, ModelWorkspace};
use pyo3::prelude::*;
use pyo3_arrow::buffer::PyArrowBuffer;
use serde_json::{Value, json};

use crate::errors;
use crate::scene::{How, Scene};
use crate::table::shared;

/// A report, and whether it found what it looked for.
type Report = (String, bool);

fn refused(error: CaseError) -> PyErr {
    errors::input(&error)
}

/// Slip or jamming of a solved motion.
#[pyfunction]
pub(crate) fn analysis(
    py: Python<'_>,
    kind: &str,
    scene: &Bound<'_, Scene>,
    how: How,
) -> PyResult<Report> {
    let scene = &scene.get().0;
    let settings = how.settings()?;
    let jams = kind == "jam";
    let report = py.detach(|| -> Result<Report, CaseError> {
        let work = &mut ModelWorkspace::default();
        let found = scene.problem(&settings)?.solve(work);
        let Moving { settings, solution, .. } = Moving::of(scene, &settings, found, work)?;
        if solution.reason().is_some() {
            return Ok((Value::Object(Record::new(solution).to_json()).to_string(), false));
        }
        let report = if jams {
            Analysis::jam(scene, &solution)?
        } else {
            Analysis::slip(scene, &settings, &solution)?
        };
        Ok((Value::Object(report.to_json()).to_string(), true))
    });
    report.map_err(refused)
}

/// Ratings of a nut.
///
/// * `spectrum`: a load spectrum as CSV.
#[pyfunction]
pub(crate) fn capacity(scene: &Bound<'_, Scene>, spectrum: Option<&[u8]>) -> PyResult<Report> {
    let spectrum = spectrum.map(Spectrum::from_csv).transpose().map_err(refused)?;
    let report = CapacityReport::of(&scene.get().0, spectrum.as_ref()).map_err(refused)?;
    Ok((report.to_json().to_string(), true))
}

/// All balls of a nut: the report, rows of its balls, rows of its curve.
#[pyfunction]
pub(crate) fn nut(
    py: Python<'_>,
    scene: &Bound<'_, Scene>,
    how: How,
) -> PyResult<(Report, Vec<Vec<f64>>, Vec<Vec<f64>>)> {
    let problem = NutProblem::of(&scene.get().0, &how.settings()?).map_err(refused)?;
    Ok(py.detach(|| match problem.solve() {
        Ok(report) => {
            let rows = |rows: Vec<Vec<f64>>| rows;
            let balls = report.balls().into_iter().map(Into::into).collect();
            let curve = report.curve().into_iter().map(Into::into).collect();
            let mut map = report.to_json();
            map.insert("warnings".to_owned(), json!(report.warnings()));
            ((Value::Object(map).to_string(), true), rows(balls), rows(curve))
        }
        Err(none) => {
            let map = json!({ "status": none.status().name(), "message": none.to_string() });
            ((map.to_string(), false), Vec::new(), Vec::new())
        }
    }))
}

/// Columns of the balls and of the curve of a nut: name and unit.
#[pyfunction]
pub(crate) fn nut_columns() -> (Vec<(&'static str, &'static str)>, Vec<(&'static str, &'static str)>)
{
    (bsm_case::BALL_COLUMNS.to_vec(), bsm_case::CURVE_COLUMNS.to_vec())
}

/// Quantiles over random balls.
#[pyfunction]
pub(crate) fn nut_samples(
    py: Python<'_>,
    scene: &Bound<'_, Scene>,
    how: How,
    number: u64,
    seed: Option<u64>,
) -> PyResult<Report> {
    let problem = NutProblem::of(&scene.get().0, &how.settings()?).map_err(refused)?;
    let samples = py.detach(|| Samples::of(&problem, number, seed)).map_err(refused)?;
    Ok((samples.to_json().to_string(), true))
}

/// An input from a measured output.
#[pyfunction]
pub(crate) fn fit(
    py: Python<'_>,
    scene: &Bound<'_, Scene>,
    how: How,
    input: &str,
    measured: &str,
    range: Option<(f64, f64)>,
) -> PyResult<Report> {
    let (scene, settings) = (&scene.get().0, how.settings()?);
    let fit = Fit::new(scene, input, range, measured).map_err(refused)?;
    let report = py.detach(|| fit.run(scene, &settings)).map_err(refused)?;
    Ok((fit.to_json(&report).to_string(), !report.found.is_empty()))
}

/// A screw for a requirement.
#[pyfunction]
pub(crate) fn design(py: Python<'_>, requirement: &str) -> PyResult<Report> {
    let report = py.detach(|| {
        let standard = Catalogue::standard()?.lists;
        let wish = RequirementFile::from_json(requirement.as_bytes(), &[], standard)?;
        Ok(DesignReport::of(&wish))
    });
    let report = report.map_err(refused)?;
    Ok((report.to_json().to_string(), report.found))
}

/// Best contact angle and self-locking limits.
#[pyfunction]
pub(crate) fn optimum(scene: &Bound<'_, Scene>, model: Option<&str>) -> PyResult<Report> {
    let model = model.and_then(Model::from_name);
    let report = OptimumReport::of(&scene.get().0, model).map_err(refused)?;
    Ok((report.to_json().to_string(), true))
}

/// The axis around a screw.
#[pyfunction]
pub(crate) fn size(py: Python<'_>, scene: &Bound<'_, Scene>, how: How) -> PyResult<Report> {
    let (scene, settings) = (&scene.get().0, how.settings()?);
    let report = py.detach(|| SizeReport::of(scene, &settings)).map_err(refused)?;
    Ok((report.to_json().to_string(), report.passes()))
}

/// Nuts of standard sizes: name, unit and values of each column.
///
/// * `lists`: JSON of the sizes, the standard ones unless given.
#[pyfunction]
pub(crate) fn catalog(
    py: Python<'_>,
    lists: Option<&str>,
    require: Vec<String>,
    pareto: bool,
    sort: Option<&str>,
    descending: bool,
    first: Option<usize>,
) -> PyResult<Vec<(&'static str, &'static str, PyArrowBuffer)>> {
    let chosen = py.detach(|| -> Result<Vec<_>, CaseError> {
        let catalogue = match lists {
            Some(lists) => Catalogue::from_json(lists.as_bytes())?,
            None => Catalogue::standard()?,
        };
        let require: Vec<_> =
            require.iter().map(|text| Condition::parse(text)).collect::<Result<_, _>>()?;
        let order = sort.map(CatalogueColumn::named).transpose()?;
        let all = catalogue.places();
        let meets = |nut: &_| require.iter().all(|condition| condition.is_met(nut));
        let mut chosen = catalogue.map(&all, |place, nut| meets(nut).then_some(place));
        if pareto {
            chosen = catalogue.pareto(&chosen);
        }
        let mut nuts = catalogue.map(&chosen, |_, nut| Some(*nut));
        if let Some(column) = order {
            nuts.sort_by(|a, b| (column.read)(a).total_cmp(&(column.read)(b)));
            if descending {
                nuts.reverse();
            }
        }
        nuts.truncate(first.unwrap_or(usize::MAX));
        Ok(nuts)
    });
    let nuts = chosen.map_err(refused)?;
    let column = |c: &CatalogueColumn| {
        let values: Vec<f64> = nuts.iter().map(c.read).collect();
        (c.name, c.unit, shared(values))
    };
    Ok(CATALOGUE_COLUMNS.iter().map(column).collect())
}
