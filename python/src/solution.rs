//! Solutions of one point.

use std::cell::RefCell;

use bsm_case::{Cell, OUTPUTS, Record, Sensitivities};
use bsm_dyn::ModelWorkspace;
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use serde_json::Value;

use crate::errors;
use crate::scene::{How, Scene};

thread_local! {
    /// Memory of the models.
    static WORK: RefCell<ModelWorkspace> = RefCell::default();
}

/// The answer for one point.
#[pyclass(frozen, subclass, module = "ballscrew._core")]
pub(crate) struct Solution {
    scene: Py<Scene>,
    record: Record,
}

#[pymethods]
impl Solution {
    #[new]
    fn new(scene: Bound<'_, Scene>, how: How) -> PyResult<Self> {
        let record = answer(&scene.get().0, how)?;
        Ok(Self { scene: scene.unbind(), record })
    }

    #[getter]
    fn scene(&self, py: Python<'_>) -> Py<Scene> {
        self.scene.clone_ref(py)
    }

    #[getter]
    fn status(&self) -> &'static str {
        self.record.status_name()
    }

    #[getter]
    fn model(&self) -> &'static str {
        self.record.model().name()
    }

    #[getter]
    fn message(&self) -> Option<&str> {
        self.record.message()
    }

    #[getter]
    fn choice(&self) -> Option<String> {
        self.record.choice()
    }

    #[getter]
    fn regime(&self) -> Option<&'static str> {
        self.record.regime()
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        let scene = &self.scene.get().0;
        scene.warnings().into_iter().chain(self.record.warnings(scene)).collect()
    }

    /// An output by its place: a number, a flag, a word, or `None`.
    fn value(&self, py: Python<'_>, place: usize) -> PyResult<Option<Py<PyAny>>> {
        let Some(cell) = OUTPUTS.get(place).and_then(|output| self.record.cell(output)) else {
            return Ok(None);
        };
        Ok(Some(match cell {
            Cell::Number(number) => number.into_py_any(py)?,
            Cell::Count(count) => count.into_py_any(py)?,
            Cell::Flag(flag) => flag.into_py_any(py)?,
            Cell::Race(race) => race.name().into_py_any(py)?,
            Cell::Evidence(evidence) => evidence.name().into_py_any(py)?,
        }))
    }

    fn to_json(&self) -> String {
        format!("{:#}", Value::Object(self.record.to_json()))
    }
}

fn answer(scene: &bsm_case::Scene, how: How) -> PyResult<Record> {
    let problem = scene.problem(&how.settings()?).map_err(|e| errors::input(&e))?;
    Ok(WORK.with_borrow_mut(|work| Record::new(problem.solve(work))))
}

/// Derivatives of efficiency and torque by every input that the model uses: name, value, efficiency,
/// torque, both relative; `None` without a solution.
#[pyfunction]
pub(crate) fn sensitivities(
    scene: &Bound<'_, Scene>,
    how: How,
) -> PyResult<Option<Vec<(&'static str, f64, f64, Option<f64>, Option<f64>, Option<f64>)>>> {
    let inputs =
        Sensitivities::of(&scene.get().0, &how.settings()?).map_err(|e| errors::input(&e))?;
    let answer = WORK.with_borrow_mut(|work| inputs.problem.sensitivities(work));
    let row = |r: bsm_case::Sensitivity| {
        let relative = (r.relative_efficiency, r.relative_torque);
        (r.input.name, r.value, r.efficiency, r.screw_torque, relative.0, relative.1)
    };
    Ok(answer.ok().map(|answer| inputs.rows(&answer).into_iter().map(row).collect()))
}
