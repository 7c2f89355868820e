//! Optimum contact angles and self-locking limits in the vocabulary.

use std::cell::RefCell;

use bsm_design::search::minimum_inside;
use bsm_dyn::{Angles, Direction, Model, ModelWorkspace, Optimum};
use serde_json::{Map, Value, json};

use crate::requirement::USUAL_CONTACT_ANGLES_DEG;
use crate::units::DEG;
use crate::{CaseError, Scene, Settings};

/// Both directions at one lead angle and friction coefficient.
#[derive(Debug, Clone, PartialEq)]
pub struct OptimumReport {
    best: [Option<Optimum>; 2],
    best_efficiency: f64,
    locking_deg: [Option<f64>; 2],
    /// Efficiency at the scene's own contact angle, if it has one.
    own_efficiency: Option<[f64; 2]>,
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
            let mut missing = Vec::new();
            if scene.lead_angle().is_none() {
                missing
                    .push("lead_angle_deg (or lead_mm with pitch_circle_diameter_mm)".to_owned());
            }
            if scene.friction_coefficient.is_none() {
                missing.push("friction_coefficient".to_owned());
            }
            return Err(CaseError::Missing { missing, model: "closed-form" });
        };
        let own = scene.contact_angle_deg.map(|deg| Angles { lead, contact: deg * DEG });
        Ok(Self {
            best: DIRECTIONS.map(|d| Optimum::of(d, lead, friction)),
            best_efficiency: Optimum::best_efficiency(friction),
            locking_deg: DIRECTIONS
                .map(|d| Angles::locking_contact_angle(d, lead, friction).map(|b| b / DEG)),
            own_efficiency: own.map(|angles| DIRECTIONS.map(|d| angles.efficiency(d, friction))),
            by_model,
        })
    }

    /// Label, unit and values for rotary to linear and linear to rotary.
    pub fn rows(&self) -> Vec<(&'static str, &'static str, [Option<f64>; 2])> {
        let angle = self.best.map(|best| best.map(|b| b.contact_angle / DEG));
        let efficiency = self.best.map(|best| best.map(|b| b.efficiency));
        let mut rows = vec![
            ("contact angle of best efficiency", "deg", angle),
            ("efficiency there", "", efficiency),
            ("self-locking: contact angle up to (rl), from (lr)", "deg", self.locking_deg),
        ];
        if let Some(own) = self.own_efficiency {
            rows.push(("efficiency at the scene's contact angle", "", own.map(Some)));
        }
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
            let best = self.best[i];
            let entry = json!({
                "optimum_contact_angle_deg": best.map(|b| b.contact_angle / DEG),
                "optimum_efficiency": best.map(|b| b.efficiency),
                "self_locking_contact_angle_deg": self.locking_deg[i],
                "efficiency": self.own_efficiency.map(|own| own[i]),
            });
            map.insert(name.to_owned(), entry);
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
    let (low, high) = USUAL_CONTACT_ANGLES_DEG;
    let deg = best_deg.filter(|deg| !(low..=high).contains(deg))?;
    Some(format!(
        "{motion}: a contact angle of {deg:.1} deg is hard to make; {low:.0} to {high:.0} deg is usual"
    ))
}
