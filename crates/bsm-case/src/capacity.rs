//! Ratings of a nut in the vocabulary.

use bsm_design::{
    Body, Duty, DynamicRating, Nut, PRELOAD, ROLLING_LEVER, Rigidity, StaticRating, life,
};
use serde_json::{Map, Value, json};

use crate::nut::balls_and_turns;
use crate::reader::lead_mm;
use crate::record::message;
use crate::units::{DEG, MM, RPM, UM};
use crate::{CaseError, InputKey, Scene, Spectrum, exact};

/// Conformities that the fits behind the ratings were made for.
const CONFORMITIES: (f64, f64) = (0.51, 0.57);

/// A number with its name and unit.
type Row = (&'static str, &'static str, f64);

/// Ratings, rigidity, mass, life and efficiency of a nut.
#[derive(Debug, Clone, PartialEq)]
pub struct CapacityReport {
    rows: Vec<Row>,
    steps: Vec<Row>,
    preloaded: bool,
    warnings: Vec<String>,
}

impl CapacityReport {
    /// Ratings of the nut of a scene: a pair of nuts under `preload_N`, or one nut under
    /// `axial_load_N`; a pair under 0.15 of the dynamic rating unless one of them is given.
    ///
    /// Life is that under a spectrum, or else under axial load and speed of the scene.
    ///
    /// # Errors
    ///
    /// [`CaseError`] if an input is missing or breaks its rule, or the grooves leave no ellipse.
    pub fn of(scene: &Scene, spectrum: Option<&Spectrum>) -> Result<Self, CaseError> {
        scene.check()?;
        let nut = nut(scene)?;
        let body = body(scene, &nut)?;
        let (dynamic, static_) = (nut.dynamic_rating(), nut.static_rating());
        let (force, preloaded) = match (scene.preload_N, scene.axial_load_N) {
            (None, Some(load)) => (load, false),
            (preload, _) => (preload.unwrap_or(PRELOAD * dynamic.rating), true),
        };
        let rigidity = nut
            .rigidity(&body, force, preloaded)
            .map_err(|reason| CaseError::NotRated(message(&reason)))?;
        let lever = scene.rolling_friction_mm.map_or(ROLLING_LEVER, |lever| lever * MM);
        let pitch_mm = nut.pitch_diameter / MM;
        let limit = scene.value_or_default(InputKey::speed_number_limit_mm_min).unwrap_or(f64::NAN);
        let mut rows = vec![
            ("dynamic_load_rating_N", "N", dynamic.rating),
            ("static_load_rating_N", "N", static_.rating),
            ("rigidity_characteristic_N_um15", "N/um^1.5", rigidity.turn * 1e-9),
            (if preloaded { "preload_N" } else { "axial_load_N" }, "N", force),
            ("axial_displacement_um", "um", rigidity.displacement / UM),
            ("contact_rigidity_N_um", "N/um", rigidity.contacts * UM),
            ("body_rigidity_N_um", "N/um", rigidity.bodies * UM),
            ("total_rigidity_N_um", "N/um", rigidity.total * UM),
            ("efficiency", "", nut.rolling_efficiency(lever)),
            ("nut_outer_diameter_mm", "mm", body.outer / MM),
            ("nut_length_mm", "mm", body.length / MM),
            ("mass_kg", "kg", body.mass(&nut)),
            ("permissible_speed_rpm", "rpm", limit / pitch_mm),
        ];
        let speed = scene.speeds_rpm().map(|(screw, nut)| (screw - nut).abs());
        rows.extend(speed.map(|rpm| ("speed_number_mm_min", "mm/min", rpm * pitch_mm)));
        let duty = match (spectrum, scene.axial_load_N, speed) {
            (Some(spectrum), ..) => Some(spectrum.0.clone()),
            (None, Some(load), Some(rpm)) => Some(vec![Duty { load, speed: rpm * RPM, time: 1.0 }]),
            _ => None,
        };
        let preload = preloaded.then_some(force);
        let life = duty.and_then(|duty| life(dynamic.rating, preload, &duty));
        rows.extend(life.iter().flat_map(|life| {
            [
                ("mean_load_N", "N", life.mean_load),
                ("mean_speed_rpm", "rpm", life.mean_speed / RPM),
                ("life_revolutions", "", life.revolutions),
                ("life_h", "h", life.time / 3600.0),
            ]
        }));
        let steps = steps(&nut, &dynamic, &static_, &rigidity);
        if let Some(&(output, ..)) = rows.iter().chain(&steps).find(|(.., x)| !x.is_finite()) {
            return Err(CaseError::BeyondDouble { output });
        }
        // A load of a spectrum may leave no life that a number could tell.
        if let Some(&(output, ..)) = rows.iter().find(|(name, _, x)| is_life(name) && *x <= 0.0) {
            return Err(CaseError::BeyondDouble { output });
        }
        let mut warnings = scene.warnings();
        warnings.extend(doubts(&nut, &body));
        let heaviest = life.map_or(force, |life| life.mean_load.max(force));
        if heaviest > dynamic.rating {
            warnings.push(format!(
                "a force of {} N is more than the dynamic rating of {:.0} N",
                exact(heaviest.round()),
                dynamic.rating
            ));
        }
        if let Some(rpm) = speed.filter(|rpm| *rpm * pitch_mm > limit) {
            warnings.push(format!(
                "speed number {:.0} mm/min at {rpm} rpm: above speed_number_limit_mm_min = {limit} \
                 the return of the balls is at risk",
                rpm * pitch_mm
            ));
        }
        Ok(Self { rows, steps, preloaded, warnings })
    }

    /// Name, unit and value of each number.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// Name, unit and value of what lies between, for a check by hand; docs/theory/11-ratings.md
    /// has the formulas.
    pub fn steps(&self) -> &[Row] {
        &self.steps
    }

    /// What an engineer should know before using the numbers.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// JSON object of the numbers, and those of [`steps`](Self::steps) as an object in it.
    pub fn to_json(&self) -> Value {
        let object = |rows: &[Row]| -> Map<String, Value> {
            rows.iter().map(|(name, _, value)| ((*name).to_owned(), json!(value))).collect()
        };
        let mut map = object(&self.rows);
        map.insert("preloaded".to_owned(), json!(self.preloaded));
        map.insert("steps".to_owned(), Value::Object(object(&self.steps)));
        map.insert("warnings".to_owned(), json!(self.warnings));
        Value::Object(map)
    }
}

/// True for a life, which no load makes zero.
fn is_life(name: &str) -> bool {
    ["life_revolutions", "life_h"].contains(&name)
}

/// The body of the nut of a scene, which must hold its balls.
pub(crate) fn body(scene: &Scene, nut: &Nut) -> Result<Body, CaseError> {
    let mut body = Body::usual(nut, nut.pitch_diameter);
    if let Some(outer) = scene.nut_outer_diameter_mm {
        body.outer = outer * MM;
    }
    if let Some(length) = scene.nut_length_mm {
        body.length = length * MM;
    }
    let widest = nut.pitch_diameter + nut.ball_diameter;
    if body.outer <= widest {
        let (value, rule) = (body.outer / MM, format!("> {} mm, where the balls are", widest / MM));
        return Err(CaseError::OutOfRange { key: "nut_outer_diameter_mm".to_owned(), value, rule });
    }
    let turn = nut.turn_length() / nut.ball_diameter;
    if nut.balls_per_turn > turn * (1.0 + 1e-9) {
        let (value, rule) = (nut.balls_per_turn, format!("<= {turn:.3}, which fill a turn"));
        return Err(CaseError::OutOfRange { key: "loaded_balls_per_turn".to_owned(), value, rule });
    }
    Ok(body)
}

/// What lies between the inputs and the ratings.
fn steps(
    nut: &Nut,
    dynamic: &DynamicRating,
    static_: &StaticRating,
    rigidity: &Rigidity,
) -> Vec<Row> {
    vec![
        ("lead_angle_deg", "deg", nut.lead_angle() / DEG),
        ("gamma", "", dynamic.gamma),
        ("f_c", "", dynamic.shape),
        ("C_s_N", "N", dynamic.screw),
        ("C_s_over_C_n", "", dynamic.ratio),
        ("screw_curvature_along_1_mm", "1/mm", static_.curvatures.along * MM),
        ("screw_curvature_across_1_mm", "1/mm", static_.curvatures.across * MM),
        ("k_0_N_mm2", "N/mm2", static_.factor),
        ("nut_approach_um_N23", "um/N^(2/3)", rigidity.approaches[0] / UM),
        ("screw_approach_um_N23", "um/N^(2/3)", rigidity.approaches[1] / UM),
    ]
}

/// What makes the numbers of a nut doubtful.
fn doubts(nut: &Nut, body: &Body) -> Vec<String> {
    let mut warnings = Vec::new();
    if body.length < nut.turns * nut.lead {
        warnings.push(format!(
            "a nut of {:.3} mm has no room for {} loaded turns of {:.3} mm",
            body.length / MM,
            nut.turns,
            nut.lead / MM
        ));
    }
    if body.mass(nut) <= 0.0 {
        warnings
            .push("the grooves of this nut are larger than its body: no mass is given".to_owned());
    }
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
    warnings
}

/// The nut of a scene.
pub(crate) fn nut(scene: &Scene) -> Result<Nut, CaseError> {
    let mut missing = Vec::new();
    let mut need = |name: &str, value: Option<f64>| {
        value.unwrap_or_else(|| {
            missing.push(name.to_owned());
            f64::NAN
        })
    };
    let pitch_mm = need("pitch_circle_diameter_mm", scene.pitch_circle_diameter_mm);
    let (balls_per_turn, turns) = balls_and_turns(scene);
    let lead_mm = scene.lead_mm.or_else(|| Some(lead_mm(scene.lead_angle_deg? * DEG, pitch_mm)));
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
        balls_per_turn: need("loaded_balls_per_turn", balls_per_turn),
        turns: need("loaded_turns", turns),
    };
    if missing.is_empty() { Ok(nut) } else { Err(CaseError::MissingForRatings { missing }) }
}
