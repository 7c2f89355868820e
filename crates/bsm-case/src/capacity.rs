//! Ratings of a nut in the vocabulary.

use bsm_design::{
    Body, Duty, DynamicRating, Elasticity, LIMIT_LOAD, Life, Limits, Nut, OPENS_AT, PRELOAD,
    ROLLING_LEVER, Thread, in_series, life, pair_loads,
};
use serde_json::{Map, Value, json};

use crate::input_set::{CONTACT_ANGLE, LEAD};
use crate::nut::balls_and_turns;
use crate::problem::Needs;
use crate::quantity::{Whole, quantities};
use crate::reader::lead_mm;
use crate::record::message;
use crate::units::{DEG, MM, RPM, UM};
use crate::{
    AnalysisKind, CaseError, Catalogue, InputKey, InputSet, Numbers, Scene, Spectrum, exact,
};

/// What a nut is rated from.
pub(crate) const NEEDS: Needs = Needs {
    all: InputSet::of(&[
        InputKey::ball_diameter_mm,
        InputKey::pitch_circle_diameter_mm,
        InputKey::nut_conformity,
        InputKey::screw_conformity,
        InputKey::loaded_balls_per_turn,
        InputKey::loaded_turns,
    ]),
    quantities: &[LEAD, CONTACT_ANGLE],
};

/// Title of what lies between the inputs and the ratings.
const STEPS: &str = "steps";

quantities! { Capacity;
    "ratings" {
        dynamic_load_rating_N ["N"] Whole, "dynamic axial load rating";
        static_load_rating_N ["N"] Whole, "static axial load rating";
        edge_load_N ["N"] Whole,
            "axial load of one nut under which a contact ellipse reaches the end of its flank";
        rigidity_characteristic_N_um15 ["N/um^1.5"] Whole, "rigidity characteristic of one turn";
        preload_displacement_um ["um"] Whole,
            "displacement of the contacts of a nut under the preload";
        contact_displacement_um ["um"] Whole needs [axial_load_N],
            "axial displacement of the contacts under the axial load, of one nut or of the preloaded pair";
        secant_contact_rigidity_N_um ["N/um"] Whole needs [axial_load_N],
            "rigidity of the contacts of one nut without preload, load over displacement";
        tangent_contact_rigidity_N_um ["N/um"] Whole needs [axial_load_N],
            "rigidity of the contacts of one nut without preload, for a small change of the load";
        preloaded_contact_rigidity_N_um ["N/um"] Whole,
            "rigidity of the contacts of a preloaded pair";
        body_rigidity_N_um ["N/um"] Whole, "rigidity of the body of a nut, or of both of a pair";
        secant_rigidity_N_um ["N/um"] Whole needs [axial_load_N],
            "secant rigidity of one nut without preload, contacts and body";
        tangent_rigidity_N_um ["N/um"] Whole needs [axial_load_N],
            "tangent rigidity of one nut without preload, contacts and body";
        preloaded_rigidity_N_um ["N/um"] Whole,
            "rigidity of a preloaded pair, contacts and bodies";
        rolling_efficiency [""] Whole, "efficiency of balls that have rolling resistance only";
        mass_kg ["kg"] Whole, "mass of the nut";
        permissible_speed_rpm ["rpm"] Whole, "speed that the speed number limit permits";
        speed_number_mm_min ["mm/min"] Whole needs [screw_speed_rpm], "speed number";
        mean_load_N ["N"] Whole needs [axial_load_N, screw_speed_rpm],
            "load that takes the same life if it stays";
        mean_speed_rpm ["rpm"] Whole needs [axial_load_N, screw_speed_rpm],
            "speed that takes the same revolutions if it stays";
        rating_life_revolutions [""] Whole needs [axial_load_N, screw_speed_rpm], "rating life";
        life_h ["h"] Whole needs [axial_load_N, screw_speed_rpm], "rating life";
    }
    "thread" {
        ball_gap_mm ["mm"] Whole, "gap in a turn full of balls, all gaps together";
        nut_groove_radius_mm ["mm"] Whole,
            "groove radius, nut";
        screw_groove_radius_mm ["mm"] Whole,
            "groove radius, screw";
        nut_groove_offset_mm ["mm"] Whole,
            "distance of the arc centres from the middle of the groove, nut";
        screw_groove_offset_mm ["mm"] Whole,
            "distance of the arc centres from the middle of the groove, screw";
        nut_core_diameter_mm ["mm"] Whole,
            "calculated core diameter, at the bottom of the full arcs, nut";
        screw_core_diameter_mm ["mm"] Whole,
            "calculated core diameter, at the bottom of the full arcs, screw";
        nut_root_diameter_mm ["mm"] Whole,
            "root diameter, where the two arcs meet, nut";
        screw_root_diameter_mm ["mm"] Whole,
            "root diameter, where the two arcs meet, screw";
    }
    "steps" {
        nut_edge_angle_deg ["deg"] Whole,
            "angle from the radial direction at which the groove ends, nut";
        screw_edge_angle_deg ["deg"] Whole,
            "angle from the radial direction at which the groove ends, screw";
        nut_groove_section_mm2 ["mm2"] Whole,
            "section of the groove, nut";
        screw_groove_section_mm2 ["mm2"] Whole,
            "section of the groove, screw";
        gamma [""] Whole, "ball diameter times cosine of the contact angle, over pitch circle diameter";
        f_c [""] Whole, "geometry factor of the dynamic load rating";
        C_s_N ["N"] Whole, "dynamic load rating of a turn of the screw";
        C_s_over_C_n [""] Whole, "dynamic load rating of the screw over that of the nut";
        C_i_N ["N"] Whole, "dynamic load rating of a turn";
        screw_curvature_along_1_mm ["1/mm"] Whole,
            "relative curvature along the track of the screw, for the static load rating";
        screw_curvature_across_1_mm ["1/mm"] Whole,
            "relative curvature across the groove of the screw, for the static load rating";
        k_0_N_mm2 ["N/mm2"] Whole, "static load of a ball over its diameter squared";
        nut_approach_um_N23 ["um/N^(2/3)"] Whole,
            "Hertz approach at unit load, nut";
        screw_approach_um_N23 ["um/N^(2/3)"] Whole,
            "Hertz approach at unit load, screw";
    }
}

/// A number with its name and unit.
type Row = (&'static str, &'static str, f64);

/// Ratings, rigidity, thread, mass, life and efficiency of a nut.
#[derive(Debug, Clone, PartialEq)]
pub struct CapacityReport {
    numbers: Numbers,
    /// Inputs as they were used, given or by rule.
    sizes: Vec<Row>,
    preloaded: bool,
    warnings: Vec<String>,
}

/// A nut that is rated.
struct Rated {
    nut: Nut,
    thread: Thread,
    body: Body,
    elasticity: Elasticity,
    dynamic: DynamicRating,
    edge_load: f64,
    /// Preload of a pair, or the axial load of one nut \[N\].
    force: f64,
    preloaded: bool,
}

impl Rated {
    /// The nut of a scene: a pair of nuts under `preload_N`, or one nut under `axial_load_N`; a pair
    /// under 0.15 of the dynamic rating unless one of them is given.
    fn of(scene: &Scene) -> Result<Self, CaseError> {
        scene.check()?;
        let nut = nut(scene)?;
        let thread = thread(scene, &nut)?;
        let body = body(scene, &nut, &thread)?;
        let dynamic = nut.dynamic_rating();
        let (force, preloaded) = match (scene.preload_N, scene.axial_load_N) {
            (None, Some(load)) => (load, false),
            (preload, _) => (preload.unwrap_or(PRELOAD * dynamic.rating), true),
        };
        let elasticity =
            nut.elasticity(&body).map_err(|reason| CaseError::NotRated(message(&reason)))?;
        let edge_load = nut.edge_load(&thread, &elasticity.hertz);
        Ok(Self { nut, thread, body, elasticity, dynamic, edge_load, force, preloaded })
    }

    /// The life under a spectrum, or else under axial load and speed of the scene.
    fn life(&self, scene: &Scene, spectrum: Option<&Spectrum>) -> Option<Life> {
        let duty = match (spectrum, scene.axial_load_N, rpm(scene)) {
            (Some(spectrum), ..) => spectrum.0.clone(),
            (None, Some(load), Some(rpm)) => vec![Duty { load, speed: rpm * RPM, time: 1.0 }],
            _ => return None,
        };
        life(self.dynamic.rating, self.preloaded.then_some(self.force), &duty)
    }

    fn numbers(&self, scene: &Scene, life: Option<&Life>) -> Result<Numbers, CaseError> {
        let Self { nut, thread, body, elasticity, dynamic, .. } = self;
        let mut numbers = Numbers::new(AnalysisKind::Capacity);
        let static_ = nut.static_rating();
        let lever = scene.rolling_friction_mm.map_or(ROLLING_LEVER, |lever| lever * MM);
        let pitch_mm = nut.pitch_diameter / MM;
        let whole = [
            (dynamic_load_rating_N, dynamic.rating),
            (static_load_rating_N, static_.rating),
            (edge_load_N, self.edge_load),
            (rigidity_characteristic_N_um15, elasticity.turn * 1e-9),
            (rolling_efficiency, nut.rolling_efficiency(lever)),
            (mass_kg, body.mass(nut, thread)),
            (permissible_speed_rpm, speed_limit(scene) / pitch_mm),
            (ball_gap_mm, nut.ball_gap() / MM),
            (gamma, dynamic.gamma),
            (f_c, dynamic.shape),
            (C_s_N, dynamic.screw),
            (C_s_over_C_n, dynamic.ratio),
            (C_i_N, dynamic.turn),
            (screw_curvature_along_1_mm, static_.curvatures.along * MM),
            (screw_curvature_across_1_mm, static_.curvatures.across * MM),
            (k_0_N_mm2, static_.factor),
            (nut_groove_radius_mm, thread.nut.radius / MM),
            (screw_groove_radius_mm, thread.screw.radius / MM),
            (nut_groove_offset_mm, thread.nut.offset / MM),
            (screw_groove_offset_mm, thread.screw.offset / MM),
            (nut_core_diameter_mm, thread.nut.core / MM),
            (screw_core_diameter_mm, thread.screw.core / MM),
            (nut_root_diameter_mm, thread.nut.root / MM),
            (screw_root_diameter_mm, thread.screw.root / MM),
            (nut_edge_angle_deg, thread.nut.edge / DEG),
            (screw_edge_angle_deg, thread.screw.edge / DEG),
            (nut_groove_section_mm2, thread.nut.section() / (MM * MM)),
            (screw_groove_section_mm2, thread.screw.section() / (MM * MM)),
            (nut_approach_um_N23, elasticity.hertz[0].compliance / UM),
            (screw_approach_um_N23, elasticity.hertz[1].compliance / UM),
        ];
        let under_load =
            if self.preloaded { self.of_pair(scene.axial_load_N) } else { self.of_single() };
        let of_life = life.map(|life| {
            [
                (mean_load_N, life.mean_load),
                (mean_speed_rpm, life.mean_speed / RPM),
                (rating_life_revolutions, life.revolutions),
                (life_h, life.time / 3600.0),
            ]
        });
        for (place, value) in
            whole.into_iter().chain(under_load).chain(of_life.into_iter().flatten())
        {
            numbers.whole(place, value);
        }
        numbers.whole(speed_number_mm_min, rpm(scene).map(|rpm| rpm * pitch_mm));
        let numbers = numbers.finite()?;
        // A load of a spectrum may leave no life that a number could tell.
        let lost = |life: &&Life| life.revolutions <= 0.0 || life.time <= 0.0;
        match life.filter(lost) {
            Some(_) => Err(CaseError::BeyondDouble { output: "life_h" }),
            None => Ok(numbers),
        }
    }

    /// Displacement and rigidity of a preloaded pair, and under a load.
    fn of_pair(&self, load: Option<f64>) -> Vec<(Whole, f64)> {
        let (elasticity, preload) = (&self.elasticity, self.force);
        let contacts = elasticity.preloaded(preload);
        let mut numbers = vec![
            (preload_displacement_um, elasticity.displacement(preload) / UM),
            (preloaded_contact_rigidity_N_um, contacts * UM),
            (body_rigidity_N_um, 2.0 * elasticity.body * UM),
            (preloaded_rigidity_N_um, elasticity.preloaded_pair(preload) * UM),
        ];
        // w = F_m / j_w                                                   (D20)
        numbers.extend(load.map(|load| (contact_displacement_um, load / contacts / UM)));
        numbers
    }

    /// Displacement and rigidity of one nut under its load.
    fn of_single(&self) -> Vec<(Whole, f64)> {
        let (elasticity, load) = (&self.elasticity, self.force);
        let (secant, tangent) = (elasticity.secant(load), elasticity.tangent(load));
        vec![
            (contact_displacement_um, elasticity.displacement(load) / UM),
            (secant_contact_rigidity_N_um, secant * UM),
            (tangent_contact_rigidity_N_um, tangent * UM),
            (body_rigidity_N_um, elasticity.body * UM),
            (secant_rigidity_N_um, in_series(secant, elasticity.body) * UM),
            (tangent_rigidity_N_um, in_series(tangent, elasticity.body) * UM),
        ]
    }

    /// Inputs as they were used.
    fn sizes(&self, scene: &Scene) -> Vec<Row> {
        let mut sizes = vec![
            ("lead_angle_deg", "deg", self.nut.lead_angle() / DEG),
            ("contact_angle_deg", "deg", self.nut.contact_angle / DEG),
            ("axial_play_um", "um", self.thread.play / UM),
            ("nut_bore_mm", "mm", self.thread.nut.land / MM),
            ("screw_outer_diameter_mm", "mm", self.thread.screw.land / MM),
            ("nut_outer_diameter_mm", "mm", self.body.outer / MM),
            ("nut_length_mm", "mm", self.body.length / MM),
        ];
        sizes.extend(self.preloaded.then_some(("preload_N", "N", self.force)));
        sizes.extend(scene.axial_load_N.map(|load| ("axial_load_N", "N", load)));
        sizes
    }

    /// What makes the numbers doubtful, or the nut poor.
    fn warnings(
        &self,
        scene: &Scene,
        spectrum: Option<&Spectrum>,
        life: Option<&Life>,
    ) -> Result<Vec<String>, CaseError> {
        let Self { nut, thread, body, elasticity, dynamic, force, .. } = self;
        let loads = spectrum.into_iter().flat_map(|s| s.0.iter().map(|duty| duty.load.abs()));
        let load = scene.axial_load_N.into_iter().chain(loads).reduce(f64::max);
        let mut warnings = scene.warnings();
        warnings.extend(doubts(nut, thread, body, &Catalogue::standard()?.limits));
        if self.preloaded {
            warnings.extend(doubts_of_pair(elasticity, *force, load, dynamic.rating));
        }
        let load = load.unwrap_or(0.0);
        let busier = if self.preloaded { pair_loads(*force, load).0 } else { load };
        warnings.extend(off_the_flank(self.edge_load, busier));
        let heaviest = life.map_or(*force, |life| life.mean_load.max(*force));
        if heaviest > dynamic.rating {
            warnings.push(format!(
                "a force of {} N is more than the dynamic rating of {:.0} N",
                exact(heaviest.round()),
                dynamic.rating
            ));
        }
        let (limit, pitch_mm) = (speed_limit(scene), nut.pitch_diameter / MM);
        if let Some(rpm) = rpm(scene).filter(|rpm| *rpm * pitch_mm > limit) {
            warnings.push(format!(
                "speed number {:.0} mm/min at {rpm} rpm: above speed_number_limit_mm_min = {limit} \
                 the return of the balls is at risk",
                rpm * pitch_mm
            ));
        }
        Ok(warnings)
    }
}

/// Relative speed of screw and nut \[rpm\], if it is given.
fn rpm(scene: &Scene) -> Option<f64> {
    scene.speeds_rpm().map(|(screw, nut)| (screw - nut).abs())
}

/// Largest speed number \[mm/min\].
fn speed_limit(scene: &Scene) -> f64 {
    scene.value_or_default(InputKey::speed_number_limit_mm_min).unwrap_or(f64::NAN)
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
        let rated = Rated::of(scene)?;
        let life = rated.life(scene, spectrum);
        Ok(Self {
            numbers: rated.numbers(scene, life.as_ref())?,
            sizes: rated.sizes(scene),
            preloaded: rated.preloaded,
            warnings: rated.warnings(scene, spectrum, life.as_ref())?,
        })
    }

    /// The numbers alone.
    pub(crate) fn numbers(scene: &Scene) -> Result<Numbers, CaseError> {
        let rated = Rated::of(scene)?;
        rated.numbers(scene, rated.life(scene, None).as_ref())
    }

    /// Name, unit and value of each number, and of the inputs behind them, given or by rule.
    pub fn rows(&self) -> Vec<Row> {
        self.titled(|title| title != STEPS).chain(self.sizes.iter().copied()).collect()
    }

    /// Name, unit and value of what lies between, for a check by hand; docs/theory/11-ratings.md
    /// has the formulas.
    pub fn steps(&self) -> Vec<Row> {
        self.titled(|title| title == STEPS).collect()
    }

    fn titled(&self, asked: impl Fn(&str) -> bool) -> impl Iterator<Item = Row> {
        let rows = self.numbers.rows().filter(move |(quantity, _)| asked(quantity.title));
        rows.flat_map(|(quantity, values)| {
            let columns = quantity.columns.iter().zip(values);
            columns.filter_map(|(column, value)| Some((column.name, column.unit, value?)))
        })
    }

    /// What an engineer should know before using the numbers.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// JSON object of the numbers, and those of [`steps`](Self::steps) as an object in it.
    pub fn to_json(&self) -> Value {
        let object = |rows: Vec<Row>| -> Map<String, Value> {
            rows.iter().map(|(name, _, value)| ((*name).to_owned(), json!(value))).collect()
        };
        let mut map = object(self.rows());
        map.insert("preloaded".to_owned(), json!(self.preloaded));
        map.insert("steps".to_owned(), Value::Object(object(self.steps())));
        map.insert("warnings".to_owned(), json!(self.warnings));
        Value::Object(map)
    }
}

/// The thread of the nut of a scene, whose play arcs must be able to have, and whose screw must fit in.
pub(crate) fn thread(scene: &Scene, nut: &Nut) -> Result<Thread, CaseError> {
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
pub(crate) fn body(scene: &Scene, nut: &Nut, thread: &Thread) -> Result<Body, CaseError> {
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
pub(crate) fn nut(scene: &Scene) -> Result<Nut, CaseError> {
    if let (Some(_), Some(_)) = (scene.contact_angle_deg, scene.groove_bottom_distance_mm) {
        let keys = ["contact_angle_deg", "groove_bottom_distance_mm"];
        return Err(CaseError::OneOfTwo { keys, found: "both are" });
    }
    let (balls_per_turn, turns) = balls_and_turns(scene);
    let told = [(InputKey::loaded_balls_per_turn, balls_per_turn), (InputKey::loaded_turns, turns)];
    let told: InputSet =
        told.iter().filter(|(_, value)| value.is_some()).map(|(key, _)| *key).collect();
    let missing = NEEDS.missing(scene.given() | told);
    if !missing.is_empty() {
        return Err(CaseError::MissingForRatings { missing });
    }
    let value = |key: InputKey| scene[key].expect("required inputs were checked");
    let pitch_mm = value(InputKey::pitch_circle_diameter_mm);
    let lead = scene.lead_mm.unwrap_or_else(|| {
        lead_mm(scene.lead_angle().expect("required inputs were checked"), pitch_mm)
    });
    let nut = Nut {
        ball_diameter: value(InputKey::ball_diameter_mm) * MM,
        pitch_diameter: pitch_mm * MM,
        lead: lead * MM,
        contact_angle: scene.contact_angle_deg.map_or(f64::NAN, |deg| deg * DEG),
        conformity: (value(InputKey::nut_conformity), value(InputKey::screw_conformity)),
        material: scene.reader().materials(),
        balls_per_turn: balls_per_turn.unwrap_or(f64::NAN),
        turns: turns.unwrap_or(f64::NAN),
    };
    let Some(bottoms) = scene.groove_bottom_distance_mm else { return Ok(nut) };
    let contact_angle = nut.contact_angle_of(bottoms * MM).ok_or_else(|| {
        let radii = (nut.conformity.0 + nut.conformity.1) * nut.ball_diameter;
        CaseError::OutOfRange {
            key: "groove_bottom_distance_mm".to_owned(),
            value: bottoms,
            rule: format!(
                "between {:.4} mm, the ball, and {:.4} mm, the sum of the groove radii",
                nut.ball_diameter / MM,
                radii / MM
            ),
        }
    })?;
    Ok(Nut { contact_angle, ..nut })
}
