//! Settings whose speed and accuracy are measured: models, quadrature accuracies, creep speeds, and
//! tolerances of `auto`.

use bsm_case::{ModelChoice, Settings};
use bsm_dyn::Model;
use schemars::JsonSchema;
use serde::Serialize;

/// A model, and the settings with which it is measured.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Setting {
    /// Name of the model.
    pub model: &'static str,
    /// Options of `bsm solve` that differ from the defaults. The text is empty for the default
    /// settings.
    pub options: String,
    /// Solver settings that correspond to `options`.
    #[serde(skip)]
    pub settings: Settings,
}

impl Setting {
    fn of(settings: Settings, options: String) -> Self {
        Self { model: settings.model.name(), options, settings }
    }

    /// Returns the model and the options as text.
    pub fn name(&self) -> String {
        format!("{} {}", self.model, self.options).trim_end().to_owned()
    }
}

/// Quadrature accuracies with which `traction` is measured, including the default.
const ACCURACIES: [f64; 4] = [1e-4, 1e-6, 1e-8, 1e-10];

/// Creep speeds with which `traction` is measured, in addition to the default.
const CREEPS: [f64; 3] = [1e-2, 1e-3, 1e-5];

/// Tolerances of the efficiency with which `auto` is measured.
const TOLERANCES: [f64; 4] = [1e-1, 1e-2, 1e-3, 1e-4];

/// Returns all settings that are measured, beginning with the fastest models.
pub(super) fn all() -> Vec<Setting> {
    let mut list: Vec<_> = Model::ALL
        .into_iter()
        .filter(|model| *model != Model::Traction)
        .map(|model| Setting::of(model.into(), String::new()))
        .collect();
    for accuracy in ACCURACIES {
        let settings = Settings { accuracy, ..Model::Traction.into() };
        list.push(Setting::of(settings, format!("--accuracy {accuracy:e}")));
    }
    for creep in CREEPS {
        let settings = Settings { creep, ..Model::Traction.into() };
        list.push(Setting::of(settings, format!("--creep {creep:e}")));
    }
    for tolerance in TOLERANCES {
        let settings = Settings { model: ModelChoice::Auto, tolerance, ..Settings::default() };
        list.push(Setting::of(settings, format!("--tolerance {tolerance:e}")));
    }
    list
}
