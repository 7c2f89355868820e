//! Ratings of a nut in the vocabulary.

use std::f64::consts::PI;

use bsm_design::{Body, Nut};
use bsm_dyn::Reason;
use serde_json::{Map, Value, json};

use crate::record::message;
use crate::units::{DEG, MM};
use crate::{CaseError, Scene};

/// Preload over the dynamic rating unless one is given (Sobolewski 2002).
const PRELOAD: f64 = 0.15;

/// Lever arm of rolling resistance unless one is given \[m\] (Sobolewski 2002).
const LEVER: f64 = 0.005 * MM;

/// Conformities that the fits behind the ratings were made for.
const CONFORMITIES: (f64, f64) = (0.51, 0.57);

/// Ratings, rigidity and efficiency of a nut.
#[derive(Debug, Clone, PartialEq)]
pub struct CapacityReport {
    dynamic: f64,
    static_: f64,
    /// Of one turn \[N/m^1.5\].
    turn: f64,
    /// Preload or load \[N\], and whether it is a preload.
    force: f64,
    preloaded: bool,
    displacement: f64,
    contacts: f64,
    total: f64,
    efficiency: f64,
    warnings: Vec<String>,
}

impl CapacityReport {
    /// Ratings of the nut of a scene: a pair of nuts under `preload_N`, or one nut under
    /// `axial_load_N`; a pair under 0.15 of the dynamic rating unless one of them is given.
    ///
    /// # Errors
    ///
    /// [`CaseError`] if an input is missing or breaks its rule, or the grooves leave no ellipse.
    pub fn of(scene: &Scene) -> Result<Self, CaseError> {
        scene.check()?;
        let nut = nut(scene)?;
        let hertz = |reason: Reason| CaseError::NotRated(message(&reason));
        let dynamic = nut.dynamic_rating();
        let (force, preloaded) = match (scene.preload_N, scene.axial_load_N) {
            (None, Some(load)) => (load, false),
            (preload, _) => (preload.unwrap_or(PRELOAD * dynamic), true),
        };
        let (displacement, contacts) = nut.contacts_under(force).map_err(hertz)?;
        let outer = nut.pitch_diameter + 4.0 * nut.ball_diameter;
        let body = Body { outer, youngs_modulus: nut.material.0.youngs_modulus };
        // Two nuts against each other have twice the rigidity of one.
        let nuts = if preloaded { 2.0 } else { 1.0 };
        let (contacts, bodies) = (nuts * contacts, nuts * nut.body_rigidity(&body));
        let mut warnings = scene.warnings();
        for (name, conformity) in
            [("nut_conformity", nut.conformity.0), ("screw_conformity", nut.conformity.1)]
        {
            let (low, high) = CONFORMITIES;
            if !(low..=high).contains(&conformity) {
                warnings.push(format!(
                    "{name} = {conformity}: the ratings were fitted for {low} to {high}"
                ));
            }
        }
        if force > dynamic {
            warnings.push(format!(
                "{} of {force:.0} N is more than the dynamic rating of {dynamic:.0} N",
                if preloaded { "a preload" } else { "a load" }
            ));
        }
        let lever = scene.rolling_friction_mm.map_or(LEVER, |lever| lever * MM);
        Ok(Self {
            dynamic,
            static_: nut.static_rating(),
            turn: nut.turn_rigidity().map_err(hertz)?,
            force,
            preloaded,
            displacement,
            contacts,
            total: (contacts.recip() + bodies.recip()).recip(),
            efficiency: nut.rolling_efficiency(lever),
            warnings,
        })
    }

    /// Name, unit and value of each number.
    pub fn rows(&self) -> Vec<(&'static str, &'static str, f64)> {
        let force = if self.preloaded { "preload_N" } else { "axial_load_N" };
        vec![
            ("dynamic_load_rating_N", "N", self.dynamic),
            ("static_load_rating_N", "N", self.static_),
            ("rigidity_characteristic_N_um15", "N/um^1.5", self.turn * 1e-9),
            (force, "N", self.force),
            ("axial_displacement_um", "um", self.displacement * 1e6),
            ("contact_rigidity_N_um", "N/um", self.contacts * 1e-6),
            ("total_rigidity_N_um", "N/um", self.total * 1e-6),
            ("efficiency", "", self.efficiency),
        ]
    }

    /// What an engineer should know before using the numbers.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// JSON object of the numbers.
    pub fn to_json(&self) -> Value {
        let mut map: Map<String, Value> = self
            .rows()
            .into_iter()
            .map(|(name, _, value)| (name.to_owned(), json!(value)))
            .collect();
        map.insert("preloaded".to_owned(), json!(self.preloaded));
        map.insert("warnings".to_owned(), json!(self.warnings));
        Value::Object(map)
    }
}

/// The nut of a scene.
fn nut(scene: &Scene) -> Result<Nut, CaseError> {
    let mut missing = Vec::new();
    let mut need = |name: &str, value: Option<f64>| {
        value.unwrap_or_else(|| {
            missing.push(name.to_owned());
            f64::NAN
        })
    };
    let pitch_mm = need("pitch_circle_diameter_mm", scene.pitch_circle_diameter_mm);
    let lead_angle = scene.lead_angle_deg.map(|deg| deg * DEG);
    let lead_mm = scene.lead_mm.or_else(|| Some(PI * pitch_mm * lead_angle?.tan()));
    let nut = Nut {
        ball_diameter: need("ball_diameter_mm", scene.ball_diameter_mm) * MM,
        pitch_diameter: pitch_mm * MM,
        lead: need("lead_mm (or lead_angle_deg)", lead_mm) * MM,
        contact_angle: need("contact_angle_deg", scene.contact_angle_deg) * DEG,
        conformity: (
            need("nut_conformity", scene.nut_conformity),
            need("screw_conformity", scene.screw_conformity),
        ),
        material: scene.reader().materials(),
        balls_per_turn: need("loaded_balls_per_turn", scene.loaded_balls_per_turn),
        turns: need("loaded_turns", scene.loaded_turns),
    };
    if missing.is_empty() { Ok(nut) } else { Err(CaseError::MissingForRatings { missing }) }
}
