//! The class `Case` of the Python package.

use std::hash::{DefaultHasher, Hash, Hasher};

use bsm_case::{CaseError, InputKey, Settings};
use pyo3::prelude::*;

use crate::errors::{Error, Result};
use crate::objects::{Entries, Object};

/// One operating point. The object is immutable.
#[pyclass(frozen, subclass, module = "ballscrew._core")]
pub(crate) struct Case(pub(crate) bsm_case::Case);

#[pymethods]
impl Case {
    /// * `base`: case that provides the inputs that `inputs` does not contain.
    /// * `inputs`: inputs by name. `None` removes an input of `base`.
    #[new]
    fn new(base: Option<&Bound<'_, Self>>, inputs: Entries) -> Result<Self> {
        let mut case = base.map_or_else(bsm_case::Case::default, |base| base.get().0.clone());
        for (name, _) in inputs.0.iter().filter(|(_, value)| value.is_null()) {
            case.remove(name)?;
        }
        let given = bsm_case::Case::from_entries(inputs.0)?;
        case.override_with(&given);
        case.description = given.description.or(case.description);
        Self::checked(case)
    }

    #[staticmethod]
    fn of_json(text: &str) -> Result<Self> {
        Self::checked(bsm_case::Case::from_json(text.as_bytes())?)
    }

    /// Returns the input with the given index, or `None` if the case does not contain it.
    #[pyo3(name = "_number")]
    fn number(&self, place: usize) -> Option<f64> {
        self.0[*InputKey::ALL.get(place)?]
    }

    /// Returns an input that is not a number, or `None` if the case does not contain it.
    #[pyo3(name = "_entry")]
    fn entry(&self, name: &str) -> Result<Object> {
        let unknown = || Error::from(format!("no input is named `{name}`"));
        self.0.entries.get(name).map(Object).ok_or_else(unknown)
    }

    #[pyo3(name = "_to_dict")]
    fn to_dict(&self) -> Object {
        Object(self.0.to_json())
    }

    fn to_json(&self) -> String {
        format!("{:#}", self.0.to_json())
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        let unused = self.0.given().unused_by_models();
        self.0.warnings().into_iter().chain(unused).collect()
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| other.get().0 == self.0)
    }

    pub(crate) fn __hash__(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        self.0.to_json().to_string().hash(&mut hasher);
        hasher.finish()
    }
}

impl Case {
    /// Returns the case with a complete groove. Missing groove inputs are estimated.
    pub(crate) fn with_groove(&self) -> Result<bsm_case::Case, CaseError> {
        self.0.with_groove()
    }

    pub(crate) fn checked(case: bsm_case::Case) -> Result<Self> {
        case.check()?;
        Ok(Self(case))
    }
}

/// Solver settings as passed from Python: model, tolerance, accuracy, creep speed, controlling
/// raceway, and where the friction of a lubricant is calculated.
pub(crate) type Keywords = (String, f64, f64, f64, Option<String>, String);

/// Checked solver settings, converted from Python.
pub(crate) struct How(pub(crate) Settings);

impl<'py> FromPyObject<'_, 'py> for How {
    type Error = Error;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> Result<Self> {
        let (model, tolerance, accuracy, creep, control, friction): Keywords = object.extract()?;
        let named = Settings::named(&model, control.as_deref(), Some(&friction))?;
        Ok(Self(Settings { tolerance, accuracy, creep, ..named }.checked()?))
    }
}

/// Converts settings to a tuple, which [`How`] can convert back to settings.
pub(crate) fn keywords(settings: Settings) -> Keywords {
    let Settings { model, tolerance, accuracy, creep, control, friction } = settings;
    let control = control.map(|raceway| raceway.name().to_owned());
    (model.name().into(), tolerance, accuracy, creep, control, friction.name().into())
}
