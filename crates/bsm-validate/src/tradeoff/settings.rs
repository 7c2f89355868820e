//! The measured settings: models, quadrature accuracies, creep speeds, and tolerances of `auto`.

use bsm_case::{ModelChoice, Settings};
use bsm_dyn::Model;
use schemars::JsonSchema;
use serde::Serialize;

/// A model with certain settings.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Setting {
    /// Name of the model.
    pub model: &'static str,
    /// Options of `bsm solve` that differ from the defaults; empty for the default settings.
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

/// Quadrature accuracies for `traction`, including the default.
const ACCURACIES: [f64; 4] = [1e-4, 1e-6, 1e-8, 1e-10];

/// Creep speeds for `traction`, in addition to the default.
const CREEPS: [f64; 3] = [1e-2, 1e-3, 1e-5];

/// Tolerances for the model choice of `auto`.
const TOLERANCES: [f64; 4] = [1e-1, 1e-2, 1e-3, 1e-4];

/// Returns all models and settings, beginning with the fastest models.
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
