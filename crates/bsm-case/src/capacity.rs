//! Ratings of a nut in the vocabulary.

use bsm_design::{
    Body, Duty, DynamicRating, Elasticity, LIMIT_LOAD, Limits, Nut, OPENS_AT, PRELOAD,
    ROLLING_LEVER, StaticRating, Thread, in_series, life, pair_loads,
};
use serde_json::{Map, Value, json};

use crate::input_set::CONTACT_ANGLE;
use crate::reader::lead_mm;
use crate::record::message;
use crate::units::{DEG, MM, RPM, UM};
use crate::{CaseError, Catalogue, InputKey, Scene, Spectrum, exact};

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
        let thread = thread(scene, &nut)?;
        let body = body(scene, &nut, &thread)?;
        let (dynamic, static_) = (nut.dynamic_rating(), nut.static_rating());
        let (force, preloaded) = match (scene.preload_N, scene.axial_load_N) {
            (None, Some(load)) => (load, false),
            (preload, _) => (preload.unwrap_or(PRELOAD * dynamic.rating), true),
        };
        let elasticity =
            nut.elasticity(&body).map_err(|reason| CaseError::NotRated(message(&reason)))?;
        let edge_load = nut.edge_load(&thread, &elasticity.hertz);
        let lever = scene.rolling_friction_mm.map_or(ROLLING_LEVER, |lever| lever * MM);
        let pitch_mm = nut.pitch_diameter / MM;
        let limit = scene.value_or_default(InputKey::speed_number_limit_mm_min).unwrap_or(f64::NAN);
        let mut rows = vec![
            ("dynamic_load_rating_N", "N", dynamic.rating),
            ("static_load_rating_N", "N", static_.rating),
            ("edge_load_N", "N", edge_load),
            ("rigidity_characteristic_N_um15", "N/um^1.5", elasticity.turn * 1e-9),
        ];
        rows.extend(if preloaded {
            of_pair(&elasticity, force, scene.axial_load_N)
        } else {
            of_single(&elasticity, force)
        });
        rows.extend([
            ("efficiency", "", nut.rolling_efficiency(lever)),
            ("nut_outer_diameter_mm", "mm", body.outer / MM),
            ("nut_length_mm", "mm", body.length / MM),
            ("mass_kg", "kg", body.mass(&nut, &thread)),
            ("ball_gap_mm", "mm", nut.ball_gap() / MM),
            ("axial_play_um", "um", thread.play / UM),
        ]);
        rows.extend(grooves(&thread));
        rows.push(("permissible_speed_rpm", "rpm", limit / pitch_mm));
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
        let steps = steps(&nut, &dynamic, &static_, &elasticity, &thread);
        if let Some(&(output, ..)) = rows.iter().chain(&steps).find(|(.., x)| !x.is_finite()) {
            return Err(CaseError::BeyondDouble { output });
        }
        // A load of a spectrum may leave no life that a number could tell.
        if let Some(&(output, ..)) = rows.iter().find(|(name, _, x)| is_life(name) && *x <= 0.0) {
            return Err(CaseError::BeyondDouble { output });
        }
        let mut warnings = scene.warnings();
        let loads = scene.axial_load_N.into_iter();
        let loads =
            loads.chain(spectrum.iter().flat_map(|s| s.0.iter().map(|duty| duty.load.abs())));
        let load = loads.reduce(f64::max);
        let limits = Catalogue::standard()?.limits;
        warnings.extend(doubts(&nut, &thread, &body, &limits));
        if preloaded {
            warnings.extend(doubts_of_pair(&elasticity, force, load, dynamic.rating));
        }
        let busier = if preloaded { pair_loads(force, load.unwrap_or(0.0)).0 } else { force };
        warnings.extend(off_the_flank(edge_load, busier.max(load.unwrap_or(0.0))));
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

/// Displacement and rigidity of a preloaded pair, and under a load.
fn of_pair(elasticity: &Elasticity, preload: f64, load: Option<f64>) -> Vec<Row> {
    let contacts = elasticity.preloaded(preload);
    let mut rows = vec![
        ("preload_N", "N", preload),
        ("preload_displacement_um", "um", elasticity.displacement(preload) / UM),
    ];
    rows.extend(load.into_iter().flat_map(|load| {
        // w = F_m / j_w                                                   (D20)
        [("axial_load_N", "N", load), ("axial_displacement_um", "um", load / contacts / UM)]
    }));
    rows.extend([
        ("preloaded_contact_rigidity_N_um", "N/um", contacts * UM),
        ("body_rigidity_N_um", "N/um", 2.0 * elasticity.body * UM),
        ("preloaded_rigidity_N_um", "N/um", elasticity.preloaded_pair(preload) * UM),
    ]);
    rows
}

/// Displacement and rigidity of one nut under a load.
fn of_single(elasticity: &Elasticity, load: f64) -> Vec<Row> {
    let (secant, tangent) = (elasticity.secant(load), elasticity.tangent(load));
    vec![
        ("axial_load_N", "N", load),
        ("axial_displacement_um", "um", elasticity.displacement(load) / UM),
        ("secant_contact_rigidity_N_um", "N/um", secant * UM),
        ("tangent_contact_rigidity_N_um", "N/um", tangent * UM),
        ("body_rigidity_N_um", "N/um", elasticity.body * UM),
        ("secant_rigidity_N_um", "N/um", in_series(secant, elasticity.body) * UM),
        ("tangent_rigidity_N_um", "N/um", in_series(tangent, elasticity.body) * UM),
    ]
}

/// Sizes of the grooves.
fn grooves(thread: &Thread) -> [Row; 10] {
    let Thread { nut, screw, .. } = thread;
    [
        ("nut_groove_radius_mm", "mm", nut.radius / MM),
        ("screw_groove_radius_mm", "mm", screw.radius / MM),
        ("nut_groove_offset_mm", "mm", nut.offset / MM),
        ("screw_groove_offset_mm", "mm", screw.offset / MM),
        ("nut_core_diameter_mm", "mm", nut.core / MM),
        ("screw_core_diameter_mm", "mm", screw.core / MM),
        ("nut_root_diameter_mm", "mm", nut.root / MM),
        ("screw_root_diameter_mm", "mm", screw.root / MM),
        ("nut_bore_mm", "mm", nut.land / MM),
        ("screw_outer_diameter_mm", "mm", screw.land / MM),
    ]
}

/// The thread of the nut of a scene, whose play arcs must be able to have, and whose screw must fit in.
fn thread(scene: &Scene, nut: &Nut) -> Result<Thread, CaseError> {
    let (bore, outside) = nut.usual_lands();
    let bore = scene.nut_bore_mm.map_or(bore, |mm| mm * MM);
    let outside = scene.screw_outer_diameter_mm.map_or(outside, |mm| mm * MM);
    let refuse = |key: &str, value: f64, rule: String| {
        Err(CaseError::OutOfRange { key: key.to_owned(), value, rule })
    };
    let play = scene.axial_play_um.unwrap_or(0.0);
    let most = nut.monoarc_play() / UM;
    if play > most {
        let rule =
            format!("<= {most:.3} um, the play of grooves of a single arc at this contact angle");
        return refuse("axial_play_um", play, rule);
    }
    if bore <= outside {
        let rule = format!("> {} mm, the outer diameter of the screw", outside / MM);
        return refuse("nut_bore_mm", bore / MM, rule);
    }
    Ok(nut.thread(play * UM, (bore, outside)))
}

/// The body of the nut of a scene, which must have its grooves within.
fn body(scene: &Scene, nut: &Nut, thread: &Thread) -> Result<Body, CaseError> {
    let mut body = Body::usual(nut);
    if let Some(outer) = scene.nut_outer_diameter_mm {
        body.outer = outer * MM;
    }
    if let Some(length) = scene.nut_length_mm {
        body.length = length * MM;
    }
    let widest = thread.nut.root;
    if body.outer <= widest {
        let (value, rule) =
            (body.outer / MM, format!("> {:.3} mm, where the groove is", widest / MM));
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
    elasticity: &Elasticity,
    thread: &Thread,
) -> Vec<Row> {
    let [at_nut, at_screw] = elasticity.hertz.map(|hertz| hertz.compliance / UM);

    vec![
        ("lead_angle_deg", "deg", nut.lead_angle() / DEG),
        ("contact_angle_deg", "deg", nut.contact_angle / DEG),
        ("nut_edge_angle_deg", "deg", thread.nut.edge / DEG),
        ("screw_edge_angle_deg", "deg", thread.screw.edge / DEG),
        ("nut_groove_section_mm2", "mm2", thread.nut.section() / (MM * MM)),
        ("gamma", "", dynamic.gamma),
        ("f_c", "", dynamic.shape),
        ("C_s_N", "N", dynamic.screw),
        ("C_s_over_C_n", "", dynamic.ratio),
        ("C_i_N", "N", dynamic.turn),
        ("screw_curvature_along_1_mm", "1/mm", static_.curvatures.along * MM),
        ("screw_curvature_across_1_mm", "1/mm", static_.curvatures.across * MM),
        ("k_0_N_mm2", "N/mm2", static_.factor),
        ("nut_approach_um_N23", "um/N^(2/3)", at_nut),
        ("screw_approach_um_N23", "um/N^(2/3)", at_screw),
    ]
}

/// What makes the numbers of a nut doubtful, or the nut poor: the limits of the catalogue, and more.
fn doubts(nut: &Nut, thread: &Thread, body: &Body, limits: &Limits) -> Vec<String> {
    let mut warnings = Vec::new();
    if body.length < nut.turns * nut.lead {
        warnings.push(format!(
            "a nut of {:.3} mm has no room for {} loaded turns of {:.3} mm",
            body.length / MM,
            nut.turns,
            nut.lead / MM
        ));
    }
    let (few, many) = limits.turns;
    if nut.turns < few || nut.turns > many {
        warnings.push(format!(
            "loaded_turns = {}: {few} to {many} are usual. Fewer guide the screw poorly, and of more the \
             outer ones carry little, which the load ratings do not know",
            nut.turns
        ));
    }
    let over_lead = nut.ball_diameter / nut.lead;
    if over_lead > limits.ball_over_lead * (1.0 + 1e-9) {
        warnings.push(format!(
            "the ball diameter is {over_lead:.3} of the lead: above {} little land is left between the turns",
            limits.ball_over_lead
        ));
    }
    let root = thread.screw.root;
    if nut.ball_diameter >= limits.ball_over_root * root {
        warnings.push(format!(
            "the ball diameter is {:.3} of the root diameter of the screw, {:.3} mm: it should be below {}",
            nut.ball_diameter / root,
            root / MM,
            limits.ball_over_root
        ));
    }
    if body.mass(nut, thread) <= 0.0 {
        warnings
            .push("the grooves of this nut are larger than its body: no mass is given".to_owned());
    }
    for (name, conformity) in
        [("nut_conformity", nut.conformity.0), ("screw_conformity", nut.conformity.1)]
    {
        let (low, high) = limits.conformity;
        if !(low..=high).contains(&conformity) {
            warnings.push(format!(
                "{name} = {conformity}: the ratings were fitted for {low} to {high}"
            ));
        }
    }
    warnings
}

/// Where the preload of a pair is more than it should be (D22), or less than the load wants (D23).
fn doubts_of_pair(
    elasticity: &Elasticity,
    preload: f64,
    load: Option<f64>,
    rating: f64,
) -> Vec<String> {
    let mut warnings = Vec::new();
    // F_w ≤ 0.15 C_a                                                      (D22)
    if preload > PRELOAD * rating * (1.0 + 1e-9) {
        warnings.push(format!(
            "preload_N is {:.3} of the dynamic rating: above {PRELOAD} it costs life",
            preload / rating
        ));
    }
    // F_m ≤ 3 F_w                                                         (D23)
    if let Some(load) = load.filter(|load| *load > LIMIT_LOAD * preload * (1.0 + 1e-9)) {
        let alone = elasticity.displacement(load) - elasticity.displacement(preload);
        warnings.push(format!(
            "a load of {} N is more than {LIMIT_LOAD} times the preload: from {:.0} N on one nut is free, \
             the rigidity of the pair does not hold, and the displacement is that of the other nut alone, \
             {:.3} um",
            exact(load.round()),
            OPENS_AT * preload,
            alone / UM
        ));
    }
    warnings
}

/// A warning if a contact reaches over the end of its flank.
fn off_the_flank(edge_load: f64, force: f64) -> Option<String> {
    if edge_load <= 0.0 {
        return Some(
            "this nut cannot hold its balls: their contacts are beyond the land of nut or screw; see \
             nut_bore_mm and screw_outer_diameter_mm"
                .to_owned(),
        );
    }
    (force > edge_load).then(|| {
        format!(
            "under {} N on one nut a contact ellipse reaches over the end of its flank, which it does from \
             {edge_load:.0} N on: Hertz's theory does not hold there",
            exact(force.round())
        )
    })
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
    let lead_mm = scene.lead_mm.or_else(|| Some(lead_mm(scene.lead_angle_deg? * DEG, pitch_mm)));
    let contact_angle = match (scene.contact_angle_deg, scene.groove_bottom_distance_mm) {
        (Some(_), Some(_)) => {
            let keys = ["contact_angle_deg", "groove_bottom_distance_mm"];
            return Err(CaseError::OneOfTwo { keys, found: "both are" });
        }
        // It follows below.
        (None, Some(_)) => Some(f64::NAN),
        (angle, None) => angle,
    };
    let mut nut = Nut {
        ball_diameter: need("ball_diameter_mm", scene.ball_diameter_mm) * MM,
        pitch_diameter: pitch_mm * MM,
        lead: need("lead_mm (or lead_angle_deg)", lead_mm) * MM,
        contact_angle: need(CONTACT_ANGLE.words, contact_angle) * DEG,
        conformity: (
            need("nut_conformity", scene.nut_conformity),
            need("screw_conformity", scene.screw_conformity),
        ),
        material: scene.reader().materials(),
        balls_per_turn: need("loaded_balls_per_turn", scene.loaded_balls_per_turn),
        turns: need("loaded_turns", scene.loaded_turns),
    };
    if !missing.is_empty() {
        return Err(CaseError::MissingForRatings { missing });
    }
    if let Some(value) = scene.groove_bottom_distance_mm {
        let radii = (nut.conformity.0 + nut.conformity.1) * nut.ball_diameter;
        let rule = format!(
            "between {:.4} mm, the ball, and {:.4} mm, the sum of the groove radii",
            nut.ball_diameter / MM,
            radii / MM
        );
        let key = "groove_bottom_distance_mm".to_owned();
        let wrong = CaseError::OutOfRange { key, value, rule };
        nut.contact_angle = nut.contact_angle_of(value * MM).ok_or(wrong)?;
    }
    Ok(nut)
}
