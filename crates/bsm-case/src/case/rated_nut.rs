//! Nut of a case: balls, thread and nut body.

use bsm_design::{DynamicRating, Nut, NutBody, PRELOAD, StaticRating, StiffnessAt, Thread};
use bsm_dyn::Conformities;

use crate::case::axis_inputs::{nut_set, rated_dynamic_load};
use crate::case::nut::NutTurns;
use crate::case::problem::Needs;
use crate::vocabulary::entries::Named;
use crate::vocabulary::input_set::{CONTACT_ANGLE, LEAD, inputs, lead_mm};
use crate::vocabulary::units::{DEG, MM, UM};
use crate::{Case, CaseError, InputKey, InputSet};

/// Inputs that are required to calculate the ratings of a nut.
pub(crate) const NEEDS: Needs = Needs {
    all: inputs! {
        ball_diameter_mm pitch_circle_diameter_mm nut_conformity screw_conformity
        loaded_balls_per_turn loaded_turns
    },
    quantities: &[LEAD, CONTACT_ANGLE],
};

impl Case {
    /// Returns the catalog stiffness of a single nut under a load \[N/µm\], or `None` if no stiffness
    /// is given or if the given stiffness applies to a preloaded nut.
    pub(crate) fn rigidity_of_one_nut(&self) -> Option<f64> {
        let is_of_one = matches!(self.entries.rated_rigidity_at, Some(Named(StiffnessAt::Load(_))));
        self.rated_rigidity_N_um.filter(|_| is_of_one)
    }
}

/// Returns the inputs of a case, including the inputs that follow from its circuits.
pub(crate) fn given(case: &Case) -> InputSet {
    let NutTurns { balls_per_turn, turns } = NutTurns::of(case);
    let stated =
        [(InputKey::loaded_balls_per_turn, balls_per_turn), (InputKey::loaded_turns, turns)];
    let stated = stated.iter().filter(|(_, value)| value.is_some()).map(|(key, _)| *key);
    case.given().union(stated.collect())
}

/// Returns the nut of a case with the data that its ratings require.
pub(crate) fn nut(case: &Case) -> Result<Nut, CaseError> {
    nut_for(case, || case.given().purpose("for the ratings of a nut"))
}

/// Returns the nut of a case. If inputs are missing, the error message states the purpose for which
/// they are needed.
pub(crate) fn nut_for(case: &Case, purpose: impl FnOnce() -> String) -> Result<Nut, CaseError> {
    case.given().check_forms()?;
    let NutTurns { balls_per_turn, turns } = NutTurns::of(case);
    let missing = NEEDS.missing(given(case));
    if !missing.is_empty() {
        return Err(CaseError::missing(&missing, &purpose()));
    }
    let value = |key: InputKey| case[key].expect("required inputs were checked");
    let pitch_mm = value(InputKey::pitch_circle_diameter_mm);
    let lead = case.lead_mm.unwrap_or_else(|| {
        lead_mm(case.lead_angle().expect("required inputs were checked"), pitch_mm)
    });
    let nut = Nut {
        ball_diameter: value(InputKey::ball_diameter_mm) * MM,
        pitch_diameter: pitch_mm * MM,
        lead: lead * MM,
        contact_angle: case.contact_angle_deg.map_or(f64::NAN, |deg| deg * DEG),
        conformity: Conformities {
            nut: value(InputKey::nut_conformity),
            screw: value(InputKey::screw_conformity),
        },
        material: case.reader().materials(),
        balls_per_turn: balls_per_turn.unwrap_or(f64::NAN),
        turns: turns.unwrap_or(f64::NAN),
        starts: case.number(InputKey::starts),
    };
    let Some(bottoms) = case.groove_bottom_distance_mm else { return Ok(nut) };
    let contact_angle = nut.contact_angle_of(bottoms * MM).ok_or_else(|| {
        let radii = nut.conformity.sum() * nut.ball_diameter;
        CaseError::out_of_range(
            "groove_bottom_distance_mm",
            bottoms,
            format!(
                "between the ball diameter of {:.4} mm and the sum of the groove radii, {:.4} mm",
                nut.ball_diameter / MM,
                radii / MM
            ),
        )
    })?;
    Ok(Nut { contact_angle, ..nut })
}

/// Returns the load ratings of the nut. The ratings are calculated from the groove. If the groove
/// itself was estimated from given ratings, the given ratings are returned.
///
/// # Errors
///
/// Returns [`CaseError`] if the basis of the dynamic load rating is given without the rating, or if
/// the lead is missing.
pub(crate) fn load_ratings(
    case: &Case,
    nut: &Nut,
) -> Result<(DynamicRating, StaticRating), CaseError> {
    let (dynamic, rated) = (nut.dynamic_rating(), nut.static_rating());
    if !case.has_estimated_groove() {
        return Ok((dynamic, rated));
    }
    let given = (rated_dynamic_load(case)?, case.rated_static_load_N);
    Ok((
        given.0.map_or(dynamic, |rating| dynamic.scaled_to(rating)),
        given.1.map_or(rated, |rating| rated.scaled_to(rating)),
    ))
}

/// Returns the thread of the nut. Fails if the groove arcs do not permit the given play, or if the
/// screw does not fit into the nut.
pub(crate) fn thread(case: &Case, nut: &Nut) -> Result<Thread, CaseError> {
    let (bore, outside) = nut.usual_lands();
    let bore = case.nut_bore_mm.map_or(bore, |mm| mm * MM);
    let outside = case.screw_outer_diameter_mm.map_or(outside, |mm| mm * MM);
    let refuse =
        |key: &str, value: f64, rule: String| Err(CaseError::out_of_range(key, value, rule));
    let play = case.axial_play_um.unwrap_or(0.0);
    let most = nut.monoarc_play() / UM;
    if play > most {
        let rule =
            format!("<= {most:.3} um, the play of circular-arc grooves at this contact angle");
        return refuse("axial_play_um", play, rule);
    }
    if bore <= outside {
        let rule = format!("> {} mm, the outer diameter of the screw", outside / MM);
        return refuse("nut_bore_mm", bore / MM, rule);
    }
    Ok(nut.thread(play * UM, (bore, outside)))
}

/// Returns the nut body. Fails if the body does not enclose its grooves.
pub(crate) fn body(case: &Case, nut: &Nut, thread: &Thread) -> Result<NutBody, CaseError> {
    let mut body = NutBody::usual(nut, nut_set(case));
    if let Some(outer) = case.nut_outer_diameter_mm {
        body.outer = outer * MM;
    }
    if let Some(length) = case.nut_length_mm {
        body.length = length * MM;
    }
    let widest = thread.nut.root;
    if body.outer <= widest {
        let (value, rule) = (
            body.outer / MM,
            format!("> {:.3} mm, the largest diameter of the groove", widest / MM),
        );
        return Err(CaseError::out_of_range("nut_outer_diameter_mm", value, rule));
    }
    Ok(body)
}

/// Compares the manufacturer's ratings with the ratings calculated from the groove, and returns a
/// note if they differ.
///
/// # Errors
///
/// Returns [`CaseError::Invalid`] if the ratings differ by more than a factor of 2, unless
/// `keep_ratings` is true.
pub(crate) fn compared(case: &Case, nut: &Nut) -> Result<Option<String>, CaseError> {
    /// Ranges of the ratio of calculated to stated rating, for the dynamic and the static rating.
    /// Within these ranges, no note is given, because the formulas of different manufacturers
    /// differ by this much.
    const USUAL: [(f64, f64); 2] = [(0.85, 1.18), (0.80, 1.25)];
    /// If the ratio of calculated to stated rating is outside this range, the ratings are assumed
    /// to belong to another nut.
    const OTHER: (f64, f64) = (0.5, 2.0);
    let within = |(low, high): (f64, f64), ratio: f64| (low..=high).contains(&ratio);
    let (dynamic, rated) = (nut.dynamic_rating().rating, nut.static_rating().rating);
    let ratings = [
        (InputKey::rated_dynamic_load_N, dynamic, USUAL[0]),
        (InputKey::rated_static_load_N, rated, USUAL[1]),
    ];
    let mut differ = Vec::new();
    for (key, calculated, usual) in ratings {
        let stated = match key {
            InputKey::rated_dynamic_load_N => rated_dynamic_load(case)?,
            _ => case[key],
        };
        let Some(stated) = stated else { continue };
        let ratio = calculated / stated;
        if !within(OTHER, ratio) && case.entries.keep_ratings != Some(true) {
            return Err(CaseError::Invalid(format!(
                "`{}` = {stated} N, but the rating of the groove is {calculated:.0} N, so the geometry belongs to another nut; correct the \
                 geometry, omit it, or set keep_ratings=true",
                key.name()
            )));
        }
        if !within(usual, ratio) {
            let name = key.name();
            differ.push(format!(
                "{name} is {stated:.0} N, but the calculated rating is {calculated:.0} N ({ratio:.2} times the given value)"
            ));
        }
    }
    Ok((!differ.is_empty()).then(|| {
        format!(
            "The geometry does not match the rated nut: {}. Life and static safety follow from the given ratings; pressures and ball \
             loads follow from the geometry.",
            differ.join(", ")
        )
    }))
}

/// Returns a note on the preload that is assumed if neither load nor preload is given.
///
/// * `force`: assumed preload \[N\].
pub(crate) fn assumed_preload(force: f64) -> String {
    format!(
        "Neither a load nor a preload is given, so a double nut with a preload of {force:.0} N is assumed, which is {PRELOAD} times its dynamic load rating (D22). `axis` permits at most 0.1 times the rating."
    )
}
