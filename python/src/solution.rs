//! The class `Solution` of the Python package.

use std::cell::RefCell;
use std::num::NonZeroUsize;
use std::sync::OnceLock;
use std::sync::atomic::Ordering;

use bsm_case::{
    Answer, CaseError, DRAWS, InputKey, InputSet, OUTPUTS, Record, Sensitivities, Settings,
    Supplement, derived_input, torque_parts,
};
use bsm_dyn::ModelWorkspace;
use bsm_report::PROGRAM;
use pyo3::prelude::*;
use pyo3_arrow::buffer::PyArrowBuffer;
use rayon::prelude::*;

use crate::case::{Case, How, Keywords, keywords};
use crate::errors::{Error, Result};
use crate::objects::Object;
use crate::points::watched;
use crate::table::{NumberArray, shared};

thread_local! {
    /// Reusable memory of the models, one instance per thread.
    static WORK: RefCell<ModelWorkspace> = RefCell::default();
}

/// The solution of one operating point.
#[pyclass(frozen, subclass, module = "ballscrew._core")]
pub(crate) struct Solution {
    case: Py<Case>,
    /// The case with a complete groove. Missing groove inputs are estimated.
    solved: bsm_case::Case,
    settings: Settings,
    record: Record,
    /// Torque of the whole screw \[N·m\], calculated on first access, or the reason why it cannot be
    /// calculated. The torque is NaN if load, speed or friction is missing.
    screw_torque: OnceLock<Result<f64, CaseError>>,
}

#[pymethods]
impl Solution {
    #[new]
    fn new(case: Bound<'_, Case>, how: How) -> Result<Self> {
        let settings = how.0;
        let solved = case.get().with_groove()?;
        let problem = solved.problem(&settings)?;
        let record = WORK.with_borrow_mut(|work| Record::new(problem.solve(work)));
        Ok(Self { case: case.unbind(), solved, settings, record, screw_torque: OnceLock::new() })
    }

    #[getter]
    fn case(&self, py: Python<'_>) -> Py<Case> {
        self.case.clone_ref(py)
    }

    /// Returns the model and the solver settings.
    #[getter]
    fn how(&self) -> Keywords {
        keywords(self.settings)
    }

    /// Solutions of the same case with the same settings are equal.
    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| {
            let other = other.get();
            self.settings == other.settings && self.case.get().0 == other.case.get().0
        })
    }

    fn __hash__(&self) -> u64 {
        self.case.get().__hash__()
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
        self.record.all_warnings(&self.solved)
    }

    /// Returns the numeric output with the given index, or NaN if it is missing.
    #[pyo3(name = "_number")]
    fn number(&self, place: usize) -> f64 {
        self.value(place).unwrap_or(f64::NAN)
    }

    /// Returns the boolean output with the given index.
    #[pyo3(name = "_flag")]
    fn flag(&self, place: usize) -> Option<bool> {
        self.value(place).map(|flag| flag > 0.5)
    }

    /// Returns the text output with the given index.
    #[pyo3(name = "_word")]
    fn word(&self, place: usize) -> Option<&'static str> {
        OUTPUTS.get(place)?.word(self.number(place))
    }

    /// Returns the torque of the whole screw \[N·m\], or NaN if load, speed or friction is missing.
    fn screw_torque(&self, py: Python<'_>) -> Result<f64> {
        let solve = || {
            let work = &mut ModelWorkspace::default();
            let Some(parts) = torque_parts(&self.solved, &self.settings, work)? else {
                return Ok(f64::NAN);
            };
            let reason = &parts.contacts;
            parts.torque().ok_or_else(|| {
                CaseError::Invalid(format!("the screw torque is not calculated: {reason}"))
            })
        };
        let torque = py.detach(|| self.screw_torque.get_or_init(solve));
        torque.as_ref().copied().map_err(Error::from)
    }

    /// Returns the JSON that the program prints with `--show band --json`.
    fn to_json(&self, py: Python<'_>) -> String {
        format!("{:#}", self.answer(py).to_json())
    }

    #[pyo3(name = "_to_dict")]
    fn to_dict(&self, py: Python<'_>) -> Object {
        Object(self.answer(py).to_json())
    }
}

impl Solution {
    /// Returns the answer that the program prints with `--show band`.
    fn answer(&self, py: Python<'_>) -> Answer {
        let (case, settings) = (&self.solved, &self.settings);
        let supplement = Supplement { band: true, parts: true, sensitivities: None };
        py.detach(|| {
            let answer = self.record.answer(PROGRAM, case, settings, &supplement);
            answer.with_groove_intervals(case, DRAWS, |possible| {
                let problem = possible.problem(settings).ok()?;
                let record = Record::new(problem.solve(&mut ModelWorkspace::default()));
                let supplement = Supplement { parts: true, ..Supplement::default() };
                Some(record.answer(PROGRAM, possible, settings, &supplement))
            })
        })
    }

    fn value(&self, place: usize) -> Option<f64> {
        self.record.value(OUTPUTS.get(place)?)
    }
}

/// Sensitivity to an input: its name and value, the derivatives of efficiency and torque, and both
/// relative derivatives \[%/%\].
type Slopes = (&'static str, f64, f64, Option<f64>, Option<f64>, Option<f64>);

/// Returns the derivatives of efficiency and torque with respect to every input of the model, or
/// `None` if there is no solution.
#[pyfunction]
pub(crate) fn sensitivities(case: &Bound<'_, Case>, how: How) -> Result<Option<Vec<Slopes>>> {
    let inputs = Sensitivities::of(&case.get().with_groove()?, &how.0)?;
    let answer = WORK.with_borrow_mut(|work| inputs.solve(work));
    let row = |r: bsm_case::Sensitivity| {
        let relative = (r.relative_efficiency, r.relative_torque);
        (r.input.name, r.value, r.efficiency, r.screw_torque, relative.0, relative.1)
    };
    Ok(answer.ok().map(|(_, rows)| rows.into_iter().map(row).collect()))
}

/// Inputs that are calculated from other inputs if they are not given.
const DERIVED_INPUTS: [InputKey; 2] = [InputKey::screw_speed_rpm, InputKey::loaded_balls];

/// Returns the values of an output at many points, and its derivatives with respect to each input
/// in `wrt`, point by point. At a point without a solution, the value and the derivatives are NaN.
///
/// * `columns`: name of each column, and its value at each point.
/// * `torque`: true for the screw torque, false for the efficiency.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the arguments are keywords in Python")]
pub(crate) fn gradient(
    py: Python<'_>,
    base: &Bound<'_, Case>,
    columns: Vec<(String, NumberArray)>,
    len: usize,
    wrt: Vec<String>,
    torque: bool,
    how: How,
    threads: Option<NonZeroUsize>,
) -> Result<(PyArrowBuffer, PyArrowBuffer)> {
    let base = base.get().with_groove()?;
    let settings = how.0;
    let keys: Vec<_> =
        wrt.iter().map(|name| InputKey::named(name)).collect::<Result<_, CaseError>>()?;
    let named = |(name, values): (String, NumberArray)| Ok((InputKey::named(&name)?, values.0));
    let columns: Vec<_> = columns.into_iter().map(named).collect::<Result<_, CaseError>>()?;
    let case = |row: usize| {
        let (mut case, mut point) = (base.clone(), bsm_case::Case::default());
        for (key, values) in &columns {
            point[*key] = Some(values[row]);
        }
        case.override_with(&point);
        case
    };
    let sets = |target: InputKey, key: InputKey, case: &bsm_case::Case| {
        let without = |other: InputKey| case[other].filter(|_| other != key);
        case[target].is_none()
            && derived_input(target, |other| case[other]).is_some()
            && derived_input(target, without).is_none()
    };
    let first = if len > 0 { case(0) } else { base.clone() };
    for key in &keys {
        if first.value_or_default(*key).is_none() {
            let given = first.given();
            let other =
                InputSet::of(&[*key]).replaced().iter().find(|other| given.contains(*other));
            let instead =
                other.map_or_else(String::new, |other| format!(": {} is given", other.name()));
            return Err(Error::from(format!(
                "`{}` has no value in this case{instead}",
                key.name()
            )));
        }
        if let Some(target) = DERIVED_INPUTS.into_iter().find(|target| sets(*target, *key, &first))
        {
            let [key, target] = [*key, target].map(InputKey::name);
            return Err(Error::from(format!(
                "`{key}` also determines {target} in this case, but exact derivatives hold {target} constant; \
                 give {target}, or use method=\"difference\""
            )));
        }
    }
    let point = |row: usize| -> Result<(f64, Vec<f64>), CaseError> {
        let inputs = Sensitivities::by(&case(row), &settings, keys.iter().copied().collect());
        let inputs = inputs.map_err(|error| if len > 1 { error.in_row(row + 1) } else { error })?;
        let Ok((value, rows)) = WORK.with_borrow_mut(|work| inputs.solve(work)) else {
            return Ok((f64::NAN, vec![f64::NAN; keys.len()]));
        };
        let wanted = |efficiency: f64, screw_torque: Option<f64>| {
            let missing =
                || CaseError::Invalid("the model calculates no torque for these inputs".to_owned());
            if torque { screw_torque.ok_or_else(missing) } else { Ok(efficiency) }
        };
        let slope = |key: &InputKey| {
            let own = rows.iter().find(|own| own.input.name == key.name());
            // An input that the model does not use has no effect.
            own.map_or(Ok(0.0), |own| wanted(own.efficiency, own.screw_torque))
        };
        let slopes = keys.iter().map(slope).collect::<Result<_, _>>()?;
        Ok((wanted(value.efficiency, value.screw_torque)?, slopes))
    };
    let found: Vec<_> = if len == 1 {
        vec![py.detach(|| point(0))?]
    } else {
        watched(py, false, len, threads, None, |stop, _| {
            let rows = (0..len).into_par_iter();
            let live =
                |row| if stop.load(Ordering::Relaxed) { Ok((0.0, Vec::new())) } else { point(row) };
            rows.map(live).collect::<Result<_, CaseError>>()
        })?
    };
    let values = found.iter().map(|(value, _)| *value).collect();
    let slopes = found.into_iter().flat_map(|(_, slopes)| slopes).collect();
    Ok((shared(values), shared(slopes)))
}
