//! Optimum contact angles and self-locking limits in the vocabulary.

use std::cell::RefCell;

use bsm_design::CONTACT_ANGLES;
use bsm_design::search::minimum_inside;
use bsm_dyn::{Angles, Direction, Model, ModelWorkspace, Optimum};
use serde_json::{Map, Value, json};

use crate::input_set::LEAD;
use crate::problem::Needs;
use crate::quantity::quantities;
use crate::units::DEG;
use crate::{AnalysisKind, CaseError, InputKey, InputSet, Numbers, Quantity, Scene, Settings};

quantities! { Optimum;
    "closed form" {
        optimum_contact_angle_deg ["deg"] Directions, "contact angle of best efficiency";
        optimum_efficiency [""] Directions, "efficiency at the contact angle of best efficiency";
        self_locking_contact_angle_deg ["deg"] Directions,
            "self-locking: contact angle up to which (rotary to linear), or from which (linear to rotary)";
        efficiency [""] Directions needs [contact_angle_deg],
            "efficiency at the scene's contact angle";
    }
}

/// What it needs.
pub(crate) const NEEDS: Needs =
    Needs { all: InputSet::of(&[InputKey::friction_coefficient]), quantities: &[LEAD] };

/// Both directions at one lead angle and friction coefficient.
#[derive(Debug, Clone, PartialEq)]
pub struct OptimumReport {
    /// What is known in closed form.
    pub numbers: Numbers,
    best: [Option<Optimum>; 2],
    best_efficiency: f64,
    /// The optimum that a model finds in the direction of the scene's speeds.
    by_model: Option<ByModel>,
}

/// Best contact angle of a model.
#[derive(Debug, Clone, Copy, PartialEq)]
struct ByModel {
    model: Model,
    direction: Direction,
    /// `None` if the model has no solution at any contact angle, or the best one is an end of the range.
    best: Option<Optimum>,
}

/// Contact angles among which a model's best one is looked for \[deg\].
const SEARCHED_DEG: (f64, f64) = (5.0, 85.0);

const DIRECTIONS: [Direction; 2] = [Direction::RotaryToLinear, Direction::LinearToRotary];

impl OptimumReport {
    /// Optimum and limits for lead angle and friction coefficient of a scene in closed form; with a
    /// model, its best contact angle in the direction of the scene's speeds besides.
    ///
    /// # Errors
    ///
    /// [`CaseError`] if one of them is missing or breaks its rule.
    pub fn of(scene: &Scene, model: Option<Model>) -> Result<Self, CaseError> {
        scene.check()?;
        let by_model = model.map(|model| ByModel::of(scene, model)).transpose()?;
        let (Some(lead), Some(friction)) = (scene.lead_angle(), scene.friction_coefficient) else {
            let missing = NEEDS.missing(scene.given());
            return Err(CaseError::Missing { missing, model: Model::ClosedForm.name() });
        };
        let best = DIRECTIONS.map(|d| Optimum::of(d, lead, friction));
        let own = scene.contact_angle_deg.map(|deg| Angles { lead, contact: deg * DEG });
        let mut numbers = Numbers::new(AnalysisKind::Optimum);
        numbers.directions(
            optimum_contact_angle_deg,
            best.map(|best| best.map(|b| b.contact_angle / DEG)),
        );
        numbers.directions(optimum_efficiency, best.map(|best| best.map(|b| b.efficiency)));
        let locking = |d| Angles::locking_contact_angle(d, lead, friction).map(|b| b / DEG);
        numbers.directions(self_locking_contact_angle_deg, DIRECTIONS.map(locking));
        let at_own = |d| own.map(|angles| angles.efficiency(d, friction));
        numbers.directions(efficiency, DIRECTIONS.map(at_own));
        let numbers = numbers.finite()?;
        Ok(Self { numbers, best, best_efficiency: Optimum::best_efficiency(friction), by_model })
    }

    /// Label, unit and values for rotary to linear and linear to rotary.
    pub fn rows(&self) -> Vec<(&'static str, &'static str, [Option<f64>; 2])> {
        let row = |(quantity, [rotary, linear, _]): (&Quantity, [Option<f64>; 3])| {
            (quantity.about, quantity.unit, [rotary, linear])
        };
        let mut rows: Vec<_> = self.numbers.rows().map(row).collect();
        if let Some(found) = &self.by_model {
            let row = |value: fn(&Optimum) -> f64| {
                DIRECTIONS.map(|d| found.best.as_ref().filter(|_| d == found.direction).map(value))
            };
            rows.push((
                "contact angle of best efficiency by the model",
                "deg",
                row(|b| b.contact_angle / DEG),
            ));
            rows.push(("efficiency of the model there", "", row(|b| b.efficiency)));
        }
        rows
    }

    /// Optima that do not exist or are hard to make.
    pub fn warnings(&self) -> Vec<String> {
        let names = ["rotary to linear", "linear to rotary"];
        let mut warnings = Vec::new();
        if let Some(ByModel { model, best: None, .. }) = &self.by_model {
            let (low, high) = SEARCHED_DEG;
            warnings.push(format!(
                "model {}: no best contact angle between {low} and {high} deg; its efficiency is largest at \
                 an end of that range",
                model.name()
            ));
        }
        for (best, name) in self.best.iter().zip(names) {
            match best.map(|b| b.contact_angle / DEG) {
                None => warnings.push(format!(
                    "{name}: no contact angle reaches the best efficiency {:.4}; the lead angle is \
                     too large",
                    self.best_efficiency
                )),
                best => warnings.extend(hard_to_make(name, best)),
            }
        }
        warnings
    }

    /// JSON object, one entry per direction.
    pub fn to_json(&self) -> Value {
        let mut map = Map::new();
        for (i, name) in ["rotary_to_linear", "linear_to_rotary"].into_iter().enumerate() {
            let value = |quantity: &Quantity| self.numbers.value(&quantity.columns[i]);
            let entry = QUANTITIES.iter().map(|q| (q.key.to_owned(), json!(value(q))));
            map.insert(name.to_owned(), Value::Object(entry.collect()));
        }
        if let Some(found) = &self.by_model {
            let entry = json!({
                "model": found.model.name(),
                "optimum_contact_angle_deg": found.best.map(|b| b.contact_angle / DEG),
                "optimum_efficiency": found.best.map(|b| b.efficiency),
            });
            map.insert("by_model".to_owned(), entry);
        }
        map.insert("warnings".to_owned(), json!(self.warnings()));
        Value::Object(map)
    }
}

impl ByModel {
    /// The contact angle of least loss.
    fn of(scene: &Scene, model: Model) -> Result<Self, CaseError> {
        let settings = Settings::from(model);
        let speeds = scene.speeds_rpm().map_or(1.0, |(screw, nut)| screw - nut);
        let direction = Direction::of(speeds).unwrap_or(Direction::RotaryToLinear);
        let work = RefCell::new(ModelWorkspace::default());
        let loss = |deg: f64| -> Result<f64, CaseError> {
            let scene = Scene { contact_angle_deg: Some(deg), ..scene.clone() };
            let solution = scene.problem(&settings)?.solve(&mut work.borrow_mut());
            Ok(solution.efficiency().map_or(f64::NAN, |eta| 1.0 - eta))
        };
        // A screw that does not move has no best angle.
        let best = minimum_inside(loss, SEARCHED_DEG)?.filter(|(_, loss)| *loss < 1.0);
        let optimum = |(deg, loss)| Optimum { contact_angle: deg * DEG, efficiency: 1.0 - loss };
        Ok(Self { model, direction, best: best.map(optimum) })
    }
}

/// A warning if the optimum of a motion is hard to make.
pub(crate) fn hard_to_make(motion: &str, best_deg: Option<f64>) -> Option<String> {
    let (low, high) = CONTACT_ANGLES;
    let deg = best_deg.filter(|deg| !(low..=high).contains(&(deg * DEG)))?;
    let (low, high) = (low / DEG, high / DEG);
    Some(format!(
        "{motion}: a contact angle of {deg:.1} deg is hard to make; {low:.0} to {high:.0} deg is usual"
    ))
}
