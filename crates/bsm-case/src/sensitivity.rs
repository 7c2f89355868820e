//! Derivatives of efficiency and torque in the vocabulary.

use std::cell::Cell;

use bsm_dyn::{Problem, Transmitted};
use bsm_kin::Jet;
use serde_json::{Map, Value, json};

use crate::reader::Reader;
use crate::{CaseError, INPUTS, Input, InputKey, Scene, Settings};

/// A number with its derivatives by all [`INPUTS`], each in its unit.
pub type Jets = Jet<{ INPUTS.len() }>;

/// A scene whose inputs are variables, and the ones that its model uses.
///
/// `problem.sensitivities(..)` solves it; [`rows`](Self::rows) reads the answer.
#[derive(Debug, Clone)]
pub struct Sensitivities {
    /// The SI problem.
    pub problem: Problem<Jets>,
    /// Places and values of the inputs that it was made from.
    used: Vec<(usize, f64)>,
}

/// How much an answer depends on one input.
#[derive(Debug, Clone, Copy)]
pub struct Sensitivity {
    /// The input.
    pub input: &'static Input,
    /// Its value, given or default.
    pub value: f64,
    /// Change of the efficiency per unit of the input.
    pub efficiency: f64,
    /// Change of the torque on the screw per unit of the input \[N m\], if there is a torque.
    pub screw_torque: Option<f64>,
    /// Per cent of the efficiency for each per cent of the input; `None` if one of them is zero.
    pub relative_efficiency: Option<f64>,
    /// Per cent of the torque for each per cent of the input; `None` if one of them is zero.
    pub relative_torque: Option<f64>,
}

impl Sensitivities {
    /// The problem of a scene with its inputs as variables; a value that another input defaults to
    /// counts for both.
    ///
    /// # Errors
    ///
    /// As [`Scene::problem`].
    pub fn of(scene: &Scene, settings: &Settings) -> Result<Self, CaseError> {
        let model = scene.ask(settings)?;
        let asked = Cell::new([None; INPUTS.len()]);
        let reader = Reader(
            |key: InputKey| {
                let value = scene.value_or_default(key)?;
                let mut values = asked.get();
                values[key as usize] = Some(value);
                asked.set(values);
                Some(Jets::variable(value, key as usize))
            },
            scene.base_oil(),
        );
        let problem = reader.problem(model, settings);
        let values = asked.get().into_iter().enumerate();
        Ok(Self { problem, used: values.filter_map(|(place, v)| Some((place, v?))).collect() })
    }

    /// A row for each input that the model uses, the most important for the efficiency first.
    pub fn rows(&self, answer: &Transmitted<Jets>) -> Vec<Sensitivity> {
        let row = |&(place, value): &(usize, f64)| {
            let relative = |output: &Jets| {
                let share = output.eps[place] * value / output.re;
                (value != 0.0 && share.is_finite()).then_some(share)
            };
            Sensitivity {
                input: &INPUTS[place],
                value,
                efficiency: answer.efficiency.eps[place],
                screw_torque: answer.screw_torque.map(|torque| torque.eps[place]),
                relative_efficiency: relative(&answer.efficiency),
                relative_torque: answer.screw_torque.as_ref().and_then(relative),
            }
        };
        let mut rows: Vec<_> = self.used.iter().map(row).collect();
        let size = |row: &Sensitivity| row.relative_efficiency.map_or(-1.0, f64::abs);
        rows.sort_by(|a, b| size(b).total_cmp(&size(a)));
        rows
    }
}

impl Sensitivity {
    /// JSON object of the derivatives.
    pub fn to_json(&self) -> Value {
        let mut map = Map::new();
        for (name, value) in [
            ("efficiency", Some(self.efficiency)),
            ("screw_torque_Nm", self.screw_torque),
            ("efficiency_relative", self.relative_efficiency),
            ("screw_torque_relative", self.relative_torque),
        ] {
            map.insert(name.to_owned(), json!(value));
        }
        Value::Object(map)
    }
}
