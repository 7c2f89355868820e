//! Ratings of a nut as named quantities with units.

mod warnings;

use bsm_design::life::{Duty, Life, life, pair_loads};
use bsm_design::{
    DynamicRating, Elasticity, Nut, NutBody, PRELOAD, ROLLING_LEVER, StaticRating, Thread,
    in_series,
};

use crate::answers::record::message;
use crate::answers::section::beyond_the_flanks;
use crate::case::axis_inputs::speed_number_limit;
use crate::case::rated_nut::{assumed_preload, body, load_ratings, nut, thread};
use crate::vocabulary::members::{Data, NumbersOf, answer, number_tables};
use crate::vocabulary::number::format_trimmed;
use crate::vocabulary::quantity::quantities;
use crate::vocabulary::units::{DEG, MM, RPM, UM};
use crate::vocabulary::warning::Warning;
use crate::{Answer, Case, CaseError, Catalog, INPUTS, Numbers, format_exact};

/// Title of the table with the intermediate results between the inputs and the ratings.
pub(crate) const STEPS: &str = "steps";

number_tables! {
    /// Ratings and results of a nut.
    pub(crate) RatingNumbers = QUANTITIES.iter().filter(|quantity| quantity.title != STEPS);
    /// Inputs, including default values for missing inputs.
    pub(crate) InputsAsUsed = AS_USED.iter();
    /// Intermediate values of the ratings.
    pub(crate) RatingSteps = QUANTITIES.iter().filter(|quantity| quantity.title == STEPS);
}

answer! {
    /// Ratings of a nut.
    pub(crate) struct RatingMembers {
        [flatten] numbers: NumbersOf<RatingNumbers>;
        [flatten] as_used: NumbersOf<InputsAsUsed>;
        /// True for a preloaded pair, false for a single nut.
        preloaded: Data<bool>;
        steps: NumbersOf<RatingSteps>;
    }
}

quantities! { pub(crate) QUANTITIES, read(&NutRatings<'_>) of Ratings;
    "ratings" {
        dynamic_load_rating_N ["N" "C_a"] Scalar(|r| r.dynamic.rating), "dynamic axial load rating";
        static_load_rating_N ["N" "C_0a"] Scalar(|r| r.static_rating.rating), "static axial load rating";
        edge_load_N ["N"] Scalar(|r| r.edge_load),
            "edge load: axial load at which a contact ellipse reaches the end of its flank";
        stiffness_characteristic_N_um15 ["N/um^1.5" "k"] Scalar(|r| r.elasticity.turn_constant * 1e-9),
            "stiffness characteristic of one turn";
        preload_displacement_um ["um"] Scalar(|r| r.for_pair(|e| e.displacement(r.force) / UM)),
            "axial contact displacement of one nut under the preload";
        contact_displacement_um ["um"] Scalar(|r| r.displacement()) needs [axial_load_N],
            "axial contact displacement of one nut, or of the preloaded pair, under the axial load";
        secant_contact_stiffness_N_um ["N/um"] Scalar(|r| r.for_single_nut(|e| e.secant(r.force) * UM)) needs [axial_load_N],
            "secant stiffness of the contacts of one nut without preload, load / displacement";
        tangent_contact_stiffness_N_um ["N/um"] Scalar(|r| r.for_single_nut(|e| e.tangent(r.force) * UM)) needs [axial_load_N],
            "tangent stiffness of the contacts of one nut without preload, for a small change of the load";
        preloaded_contact_stiffness_N_um ["N/um"] Scalar(|r| r.for_pair(|e| e.preloaded(r.force) * UM)),
            "stiffness of the contacts of a preloaded pair";
        body_stiffness_N_um ["N/um"] Scalar(|r| r.for_single_nut(|e| e.body * UM)), "stiffness of the body of a nut";
        preloaded_body_stiffness_N_um ["N/um"] Scalar(|r| r.for_pair(|e| 2.0 * e.body * UM)),
            "stiffness of the bodies of a preloaded pair";
        single_nut_secant_stiffness_N_um ["N/um"] Scalar(|r| r.for_single_nut(|e| in_series(e.secant(r.force), e.body) * UM)) needs [axial_load_N],
            "secant stiffness of one nut without preload, including contacts and body";
        single_nut_tangent_stiffness_N_um ["N/um"] Scalar(|r| r.for_single_nut(|e| in_series(e.tangent(r.force), e.body) * UM)) needs [axial_load_N],
            "tangent stiffness of one nut without preload, including contacts and body";
        preloaded_stiffness_N_um ["N/um" "R_nu"] Scalar(|r| r.for_pair(|e| e.preloaded_pair(r.force) * UM)),
            "stiffness of a preloaded pair, including contacts and bodies";
        rolling_efficiency [""] Scalar(|r| r.nut.rolling_efficiency(r.lever())), "catalog efficiency, with rolling resistance and without slip";
        nut_mass_kg = INPUTS Scalar(|r| r.case.nut_mass_kg.unwrap_or_else(|| r.body.mass(&r.nut, &r.thread)));
        permissible_speed_rpm ["rpm"] Scalar(|r| speed_number_limit(r.case, r.nut.lead, r.thread.screw.land) / r.pitch_mm()), "permissible speed according to the speed number limit";
        speed_number_mm_min ["mm/min" "d_pw n"] Scalar(|r| Some(rpm(r.case)? * r.pitch_mm())) needs [screw_speed_rpm], "speed number";
        rating_life_revolutions ["" "L_10"] Scalar(|r| Some(r.life.as_ref()?.revolutions)) needs [axial_load_N, screw_speed_rpm], "rating life";
        rating_life_h ["h" "L_10h"] Scalar(|r| Some(r.life.as_ref()?.time / 3600.0)) needs [axial_load_N, screw_speed_rpm], "rating life";
    }
    "thread" {
        clearance_per_turn_mm ["mm"] Scalar(|r| r.nut.ball_gap() / MM), "total ball clearance per turn";
        nut_groove_radius_mm ["mm" "r_n"] Scalar(|r| r.thread.nut.radius / MM),
            "groove radius of the nut";
        screw_groove_radius_mm ["mm" "r_s"] Scalar(|r| r.thread.screw.radius / MM),
            "groove radius of the screw";
        nut_groove_offset_mm ["mm"] Scalar(|r| r.thread.nut.offset / MM),
            "distance of the arc centers from the middle of the nut groove";
        screw_groove_offset_mm ["mm"] Scalar(|r| r.thread.screw.offset / MM),
            "distance of the arc centers from the middle of the screw groove";
        nut_core_diameter_mm ["mm"] Scalar(|r| r.thread.nut.core / MM),
            "calculated core diameter of the nut; at the bottom of the complete groove arcs";
        screw_core_diameter_mm ["mm" "d_3"] Scalar(|r| r.thread.screw.core / MM),
            "calculated core diameter of the screw; at the bottom of the complete groove arcs";
        nut_root_diameter_mm ["mm"] Scalar(|r| r.thread.nut.root / MM),
            "root diameter of the nut, where the two groove arcs meet";
        screw_root_diameter_mm ["mm"] Scalar(|r| r.thread.screw.root / MM),
            "root diameter of the screw, where the two groove arcs meet";
    }
    "steps" {
        nut_edge_angle_deg ["deg"] Scalar(|r| r.thread.nut.edge / DEG),
            "angle from the radial direction at which the nut groove ends";
        screw_edge_angle_deg ["deg"] Scalar(|r| r.thread.screw.edge / DEG),
            "angle from the radial direction at which the screw groove ends";
        nut_groove_section_mm2 ["mm2"] Scalar(|r| r.thread.nut.section() / (MM * MM)),
            "cross-sectional area of the nut groove";
        screw_groove_section_mm2 ["mm2"] Scalar(|r| r.thread.screw.section() / (MM * MM)),
            "cross-sectional area of the screw groove";
        gamma ["" "gamma"] Scalar(|r| r.dynamic.gamma), "ball diameter times cosine of the contact angle / pitch circle diameter";
        f_c ["" "f_c"] Scalar(|r| r.dynamic.shape), "geometry factor of the dynamic load rating";
        C_s_N ["N" "C_s"] Scalar(|r| r.dynamic.screw), "dynamic load rating of a turn of the screw";
        C_s_over_C_n ["" "C_s/C_n"] Scalar(|r| r.dynamic.ratio), "dynamic load rating of the screw / dynamic load rating of the nut";
        C_i_N ["N" "C_i"] Scalar(|r| r.dynamic.turn), "dynamic load rating of a turn";
        screw_curvature_along_1_mm ["1/mm"] Scalar(|r| r.static_rating.curvatures.longitudinal * MM),
            "relative curvature along the screw track, for the static load rating";
        screw_curvature_across_1_mm ["1/mm"] Scalar(|r| r.static_rating.curvatures.transverse * MM),
            "relative curvature across the screw groove, for the static load rating";
        k_0_N_mm2 ["N/mm2" "k_0"] Scalar(|r| r.static_rating.factor), "static load of a ball / square of the ball diameter";
        nut_approach_um_N23 ["um/N^(2/3)"] Scalar(|r| r.elasticity.hertz[0].compliance / UM),
            "Hertz approach at the nut under unit load";
        screw_approach_um_N23 ["um/N^(2/3)"] Scalar(|r| r.elasticity.hertz[1].compliance / UM),
            "Hertz approach at the screw under unit load";
    }
}

quantities! { pub(crate) AS_USED, as_used(&NutRatings<'_>);
    "inputs as used" {
        lead_angle_deg = INPUTS Scalar(|r| r.nut.lead_angle() / DEG);
        contact_angle_deg = INPUTS Scalar(|r| r.nut.contact_angle / DEG);
        axial_play_um = INPUTS Scalar(|r| r.thread.play / UM);
        nut_bore_mm = INPUTS Scalar(|r| r.thread.nut.land / MM);
        screw_outer_diameter_mm = INPUTS Scalar(|r| r.thread.screw.land / MM);
        nut_outer_diameter_mm = INPUTS Scalar(|r| r.body.outer / MM);
        nut_length_mm = INPUTS Scalar(|r| r.body.length / MM);
        preload_N = INPUTS Scalar(|r| r.preloaded.then_some(r.force));
        axial_load_N = INPUTS Scalar(|r| r.case.axial_load_N);
    }
}

/// Results for a nut: ratings, stiffness, thread, mass, life and efficiency.
pub(crate) struct NutRatings<'a> {
    case: &'a Case,
    nut: Nut,
    thread: Thread,
    body: NutBody,
    elasticity: Elasticity,
    dynamic: DynamicRating,
    static_rating: StaticRating,
    edge_load: f64,
    /// Preload of a nut pair, or axial load of a single nut \[N\].
    force: f64,
    preloaded: bool,
    /// Life at the axial load and speed of the case.
    life: Option<Life>,
}

impl<'a> NutRatings<'a> {
    /// Calculates the nut of a case, either as a pair with the preload `preload_N` or as a single
    /// nut under `axial_load_N`. If neither input is given, the nut is a pair with a preload of
    /// 0.15 times the dynamic load rating.
    fn of(case: &'a Case) -> Result<Self, CaseError> {
        case.check()?;
        let nut = nut(case)?;
        let thread = thread(case, &nut)?;
        let body = body(case, &nut, &thread)?;
        let (dynamic, static_rating) = load_ratings(case, &nut)?;
        let (force, preloaded) = match (case.preload_N, case.axial_load_N) {
            (None, Some(load)) => (load, false),
            (preload, _) => (preload.unwrap_or(PRELOAD * dynamic.rating), true),
        };
        let elasticity =
            nut.elasticity(&body).map_err(|reason| CaseError::Invalid(message(&reason)))?;
        let edge_load = nut.edge_load(&thread, &elasticity.hertz);
        let duty = case.axial_load_N.zip(rpm(case));
        let duty = duty.map(|(load, rpm)| Duty { load, speed: rpm * RPM, time: 1.0 });
        let life = life(dynamic.rating, preloaded.then_some(force), duty.as_slice());
        Ok(Self {
            case,
            nut,
            thread,
            body,
            elasticity,
            dynamic,
            static_rating,
            edge_load,
            force,
            preloaded,
            life,
        })
    }

    /// Returns the results as an answer without notes and warnings.
    fn answer(&self) -> Result<Answer, CaseError> {
        let all = self.numbers()?;
        let part =
            |is_step: bool| all.clone().filter(|quantity| (quantity.title == STEPS) == is_step);
        Ok(Answer::default().with_members(RatingMembers {
            numbers: NumbersOf::new(part(false), "nut"),
            as_used: NumbersOf::new(as_used(self, |_| true), "nut"),
            preloaded: Data(self.preloaded),
            steps: NumbersOf::new(part(true), "nut"),
        }))
    }

    fn numbers(&self) -> Result<Numbers, CaseError> {
        let numbers = read(self, |_| true).finite()?;
        // The life under an extreme load can underflow to zero.
        let lost = |life: &Life| life.revolutions <= 0.0 || life.time <= 0.0;
        if self.life.as_ref().is_some_and(lost) {
            return Err(CaseError::beyond_double("rating_life_h"));
        }
        Ok(numbers)
    }

    /// Returns the value of `number` for a preloaded pair, and `None` for a single nut.
    fn for_pair(&self, number: impl Fn(&Elasticity) -> f64) -> Option<f64> {
        self.preloaded.then(|| number(&self.elasticity))
    }

    /// Returns the value of `number` for a single nut, and `None` for a preloaded pair.
    fn for_single_nut(&self, number: impl Fn(&Elasticity) -> f64) -> Option<f64> {
        (!self.preloaded).then(|| number(&self.elasticity))
    }

    /// Returns the axial displacement of the contacts under the axial load \[µm\].
    fn displacement(&self) -> Option<f64> {
        let of_pair = || {
            let load = self.case.axial_load_N?;
            Some(self.elasticity.preloaded_displacement(self.force, load) / UM)
        };
        self.for_single_nut(|e| e.displacement(self.force) / UM).or_else(of_pair)
    }

    fn lever(&self) -> f64 {
        self.case.rolling_friction_mm.map_or(ROLLING_LEVER, |lever| lever * MM)
    }

    fn pitch_mm(&self) -> f64 {
        self.nut.pitch_diameter / MM
    }

    /// Returns warnings about contact ellipses that extend beyond their flanks in the more heavily
    /// loaded nut. All balls are assumed to carry equal loads.
    fn beyond_the_flanks(&self) -> Vec<String> {
        let Self { case, nut, thread, elasticity, force, .. } = self;
        let of_pair = || pair_loads(*force, case.axial_load_N.unwrap_or(0.0)).0;
        let load = if self.preloaded { of_pair() } else { *force };
        let direction = nut.contact_angle.sin() * nut.lead_angle().cos();
        let ball = load / (nut.balls_per_turn * nut.turns * direction);
        beyond_the_flanks(thread, &elasticity.hertz, [Some((ball, nut.contact_angle)); 2])
    }

    /// Returns a note on the assumed preload if neither load nor preload is given.
    fn assumed_preload(&self) -> Option<String> {
        (!self.case.is_loaded()).then(|| assumed_preload(self.force))
    }

    /// Returns warnings about unfavorable proportions and about inputs outside the limits of the
    /// formulas.
    fn warnings(&self) -> Result<Vec<Warning>, CaseError> {
        let Self { case, nut, thread, body, elasticity, dynamic, force, life, .. } = self;
        let load = case.axial_load_N;
        let mut texts = case.warnings();
        texts.extend(case.load_of_the_mass());
        if self.preloaded && case.is_warm() {
            texts.push(
                "Temperature rises change the preload. These ratings do not include this effect, but `bsm nut` \
                 does."
                    .to_owned(),
            );
        }
        let proportions = warnings::limit_warnings(nut, thread, body, &Catalog::standard()?.limits);
        if self.preloaded {
            texts.extend(warnings::preload_warnings(elasticity, *force, load, dynamic.rating));
        }
        let heaviest = life.as_ref().map_or(*force, |life| life.mean_load.max(*force));
        if heaviest > dynamic.rating {
            texts.push(format!(
                "The force of {} N exceeds the dynamic load rating of {:.0} N.",
                format_exact(heaviest.round()),
                dynamic.rating
            ));
        }
        let limit = speed_number_limit(case, nut.lead, thread.screw.land);
        let pitch_mm = nut.pitch_diameter / MM;
        if let Some(rpm) = rpm(case).filter(|rpm| *rpm * pitch_mm > limit * (1.0 + 1e-9)) {
            texts.push(format!(
                "The speed number is {:.0} mm/min at {} rpm. Above the limit of {limit:.0} mm/min, \
                 the ball return may be damaged.",
                rpm * pitch_mm,
                format_trimmed(rpm)
            ));
        }
        Ok(texts.into_iter().map(Warning::advice).chain(proportions).collect())
    }
}

/// Returns the speed of the screw relative to the nut \[rpm\], if it is given.
fn rpm(case: &Case) -> Option<f64> {
    case.speeds_rpm().map(|(screw, nut)| (screw - nut).abs())
}

/// Calculates the ratings without notes and warnings.
pub(crate) fn numbers(case: &Case) -> Result<Numbers, CaseError> {
    NutRatings::of(case)?.numbers()
}

/// Calculates the ratings of a nut, either as a pair with the preload `preload_N` or as a single
/// nut under `axial_load_N`. If neither input is given, the nut is a pair with a preload of 0.15
/// times the dynamic load rating.
/// The life applies to the axial load and the speed of the case. The life under a duty cycle is
/// calculated for the axis sheet.
///
/// # Errors
/// Returns [`CaseError`] if an input is missing or violates its rule, or if no contact ellipse can
/// exist in the grooves.
pub fn ratings(case: &Case) -> Result<Answer, CaseError> {
    let rated = NutRatings::of(case)?;
    let mut answer = rated.answer()?;
    answer.notes.extend(rated.assumed_preload());
    answer.warnings.extend(rated.warnings()?.into_iter().map(|warning| warning.text));
    answer.warnings.extend(rated.beyond_the_flanks());
    Ok(answer)
}

/// Returns the load ratings of the nut of a case, and the warnings about the nut, each with its
/// selection limit if there is one. The contact ellipses are not checked here, because the nut
/// model checks the ellipses of all balls. There are no warnings for an estimated groove, because
/// its proportions may differ from the proportions of the real groove.
pub(crate) fn ratings_and_warnings(case: &Case) -> Result<(Answer, Vec<Warning>), CaseError> {
    let rated = NutRatings::of(case)?;
    let warnings = if case.has_estimated_groove() { Vec::new() } else { rated.warnings()? };
    Ok((rated.answer()?, warnings))
}
