//! Scenes.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::PathBuf;

use bsm_case::{InputKey, Settings};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors;

/// One operating point, immutable.
#[pyclass(frozen, subclass, module = "ballscrew._core")]
pub(crate) struct Scene(pub(crate) bsm_case::Scene);

#[pymethods]
impl Scene {
    /// * `base`: what is not given is taken from it. * `numbers`: inputs by name. * `words`: JSON of the
    ///   others.
    #[new]
    #[pyo3(signature = (base, numbers, words=None))]
    fn new(
        base: Option<&Bound<'_, Self>>,
        numbers: &Bound<'_, PyDict>,
        words: Option<&str>,
    ) -> PyResult<Self> {
        let mut scene = base.map_or_else(bsm_case::Scene::default, |base| base.get().0.clone());
        let mut given = match words {
            Some(words) => {
                bsm_case::Scene::from_json(words.as_bytes()).map_err(|e| errors::input(&e))?
            }
            None => bsm_case::Scene::default(),
        };
        for (name, value) in numbers {
            let key = InputKey::named(name.cast()?.to_str()?).map_err(|e| errors::input(&e))?;
            given[key] = Some(value.extract()?);
        }
        scene.override_with(&given);
        scene.description = given.description.or(scene.description);
        Self::checked(scene)
    }

    #[staticmethod]
    fn read(path: PathBuf) -> PyResult<Self> {
        Self::checked(bsm_case::Scene::read(&path).map_err(|e| errors::input(&e))?)
    }

    #[staticmethod]
    fn of_json(text: &str) -> PyResult<Self> {
        Self::checked(bsm_case::Scene::from_json(text.as_bytes()).map_err(|e| errors::input(&e))?)
    }

    /// The value of an input, if it is given.
    fn number(&self, place: usize) -> Option<f64> {
        self.0[*InputKey::ALL.get(place)?]
    }

    fn to_json(&self) -> String {
        format!("{:#}", self.0.to_json())
    }

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

impl Scene {
    fn checked(scene: bsm_case::Scene) -> PyResult<Self> {
        scene.check().map_err(|e| errors::input(&e))?;
        Ok(Self(scene))
    }
}

/// Model, tolerance, accuracy, creep, controlling raceway, and where friction of a lubricant is computed.
#[derive(FromPyObject, IntoPyObject)]
pub(crate) struct How(String, f64, f64, f64, Option<String>, String);

impl From<Settings> for How {
    fn from(settings: Settings) -> Self {
        let Settings { model, tolerance, accuracy, creep, control, friction } = settings;
        let control = control.map(|raceway| raceway.name().to_owned());
        Self(model.name().into(), tolerance, accuracy, creep, control, friction.name().into())
    }
}

impl How {
    /// As settings, checked.
    pub(crate) fn settings(self) -> PyResult<Settings> {
        let Self(model, tolerance, accuracy, creep, control, friction) = self;
        let named = Settings::named(&model, control.as_deref(), Some(&friction));
        let named = named.map_err(|e| errors::input(&e))?;
        let settings = Settings { tolerance, accuracy, creep, ..named };
        settings.check().map_err(|e| errors::input(&e))?;
        Ok(settings)
    }
}
