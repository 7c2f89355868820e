//! Ratings of a nut in the vocabulary.

mod described;
mod doubts;

use bsm_design::{
    Body, Duty, DynamicRating, Elasticity, Life, Nut, PRELOAD, ROLLING_LEVER, Thread, in_series,
    life, pair_loads,
};
use serde_json::{Map, Value, json};

pub(crate) use described::{body, nut, thread};
use doubts::{doubts, doubts_of_pair, off_the_flank};

use crate::input_set::{CONTACT_ANGLE, LEAD};
use crate::problem::Needs;
use crate::quantity::{Whole, quantities};
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
        body_rigidity_N_um ["N/um"] Whole, "rigidity of the body of a nut";
        preloaded_body_rigidity_N_um ["N/um"] Whole, "rigidity of the bodies of a preloaded pair";
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
            (preloaded_body_rigidity_N_um, 2.0 * elasticity.body * UM),
            (preloaded_rigidity_N_um, elasticity.preloaded_pair(preload) * UM),
        ];
        let displacement = |load| elasticity.preloaded_displacement(preload, load) / UM;
        numbers.extend(load.map(|load| (contact_displacement_um, displacement(load))));
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
        warnings.extend(scene.load_of_the_mass());
        if self.preloaded && scene.has_rises() {
            warnings.push(
                "rises of temperature change the preload, which these ratings do not follow: the nut with all its \
                 balls does (bsm nut)"
                    .to_owned(),
            );
        }
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
