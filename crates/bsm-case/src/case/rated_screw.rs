//! A screw for which only nominal diameter, lead and load ratings are known. Its other dimensions
//! are estimated from lists and rules of manufacturers.

use bsm_design::catalog::OfferedSize;
use bsm_design::drive::rod_inertia;
use bsm_design::{NutBody, Screw};

use crate::case::axis_inputs::nut_set;
use crate::case::manufacturer_sizes::offered_sizes;
use crate::case::nut::NutTurns;
use crate::case::rated_nut;
use crate::vocabulary::error::invalid_input;
use crate::vocabulary::input_set::inputs;
use crate::vocabulary::number::format_trimmed;
use crate::vocabulary::units::MM;
use crate::{Case, CaseError, InputKey, InputSet};

/// Inputs for the load ratings in a catalog. Results for an axis need at least one of these
/// ratings.
const RATINGS: InputSet = inputs! { rated_dynamic_load_N rated_static_load_N };

/// Results that are omitted from the axis sheet if only catalog data are given for the screw.
pub(crate) const LEFT_OUT: &str = "These results need the groove and are omitted: pressure; load of each ball, and life from the loads of all \
    balls; edge load of the contact ellipse; stiffness of the nut, unless rated_rigidity_N_um is given; friction \
    from a ball model, and lubricant film; ball return, and jamming.";

impl InputSet {
    /// Describes the results for which inputs are missing, and names the command for which the
    /// given inputs are sufficient.
    pub(crate) fn purpose(self, purpose: &str) -> String {
        let known = if self.has_ratings_only() {
            "; for this nut, only the ratings are known, which suffice for `axis`"
        } else {
            ""
        };
        format!("{purpose}{known}")
    }

    /// Returns true if at least one input of the groove is missing.
    pub(crate) fn lacks_groove(self) -> bool {
        !rated_nut::NEEDS.are_met(self)
    }

    /// Returns true if catalog ratings are given, but at least one input of the groove is missing.
    fn has_ratings_only(self) -> bool {
        self.intersects(RATINGS) && self.lacks_groove()
    }
}

impl Case {
    /// Returns true if at least one input of the groove is missing, so that the axis is calculated
    /// from catalog data.
    pub(crate) fn lacks_groove(&self) -> bool {
        rated_nut::given(self).lacks_groove()
    }
}

/// Dimensions of a screw and its nut body \[m\]. Unknown dimensions are NaN, and results that need
/// them are omitted.
pub(crate) struct RatedScrew {
    pub(crate) screw: Screw,
    pub(crate) body: NutBody,
    /// Notes on the dimensions that were estimated.
    pub(crate) assumed: Vec<String>,
}

impl RatedScrew {
    /// Returns the screw of a checked case, calculated from catalog data without a groove. All
    /// inputs are optional.
    ///
    /// * `estimated_turns`: number of loaded turns of an estimated groove.
    pub(crate) fn of(case: &Case, estimated_turns: Option<f64>) -> Result<Self, CaseError> {
        if case.rated_rigidity_N_um.is_some() && case.entries.rated_rigidity_at.is_none() {
            let what = "needs rated_rigidity_at (0.3 Ca, 0.28 Ca or preload 0.1 Ca), the load for which the catalog states the rigidity".to_owned();
            return Err(invalid_input("rated_rigidity_N_um", what));
        }
        let nominal_mm =
            case.nominal_diameter_mm.or(case.screw_outer_diameter_mm).unwrap_or(f64::NAN);
        let (nominal, lead) = (nominal_mm * MM, case.lead().unwrap_or(f64::NAN) * MM);
        let same = |a: f64, b: f64| (a - b).abs() < 1e-9 * MM;
        let is_ours = |size: &&OfferedSize| same(size.diameter, nominal) && same(size.lead, lead);
        let offered = || offered_sizes().sizes.iter().filter(is_ours);
        let mut assumed = Vec::new();
        let mut given_or_estimated = |key: InputKey, estimate: f64, unit: f64, by: &str| {
            case[key].map_or_else(
                || {
                    if !estimate.is_nan() {
                        let (name, value) = (key.name(), format_trimmed(estimate / unit));
                        assumed.push(format!("{name} = {value} is estimated from {by}."));
                    }
                    estimate
                },
                |given| given * unit,
            )
        };
        let listed = offered().find_map(|size| size.pitch_diameter);
        let by = if listed.is_some() { "manufacturers' lists" } else { "the nominal diameter" };
        let pitch = listed.unwrap_or(nominal);
        let pitch = given_or_estimated(InputKey::pitch_circle_diameter_mm, pitch, MM, by);
        let least = offered().filter_map(|size| size.core).min_by(f64::total_cmp);
        let by_rule = || Screw::usual_core(nominal, lead, case.ball_diameter_mm.map(|mm| mm * MM));
        let by = if least.is_some() {
            "the smallest core diameter in manufacturers' lists"
        } else {
            "nominal diameter and lead (Z30)"
        };
        let core = least.unwrap_or_else(by_rule);
        let core = given_or_estimated(InputKey::shaft_diameter_mm, core, MM, by);
        let mass = Screw::usual_mass_per_length(nominal, core);
        let mass = given_or_estimated(
            InputKey::screw_mass_kg_m,
            mass,
            1.0,
            "core and nominal diameter, accurate to 20 % (Z31)",
        );
        let starts = case.number(InputKey::starts);
        let given_turns = NutTurns::of(case).turns;
        let turns = given_turns.or(estimated_turns);
        let usual = NutBody::of_ratings(nominal, lead / starts, turns, nut_set(case));
        let by = match (given_turns, estimated_turns) {
            (Some(_), _) => "loaded_turns (D10), (BB6)".to_owned(),
            (None, Some(turns)) => {
                format!(
                    "the {} loaded turns of the estimated groove (D10), (BB6)",
                    format_trimmed(turns)
                )
            }
            (None, None) => {
                let turns = NutBody::TURNS_OF_RATINGS;
                format!("{turns} loaded turns, because loaded_turns is not given (D10), (BB6)")
            }
        };
        let length = given_or_estimated(InputKey::nut_length_mm, usual.length, MM, &by);
        let outer = given_or_estimated(
            InputKey::nut_outer_diameter_mm,
            usual.outer,
            MM,
            "the nominal diameter",
        );
        for (key, size) in
            [(InputKey::shaft_diameter_mm, core), (InputKey::pitch_circle_diameter_mm, pitch)]
        {
            // If a dimension is at most half of the nominal diameter or at least twice as large, it
            // is assumed to belong to another screw.
            if size >= 2.0 * nominal || size <= 0.5 * nominal {
                let rule = format!("between half and twice nominal_diameter_mm = {nominal_mm}");
                return Err(CaseError::out_of_range(key.name(), size / MM, rule));
            }
        }
        let screw = Screw {
            lead,
            pitch_diameter: pitch,
            core,
            outer: case.screw_outer_diameter_mm.map_or(nominal, |mm| mm * MM),
            mass_per_length: mass,
            inertia_per_length: rod_inertia(1.0, mass),
            youngs_modulus: case.reader().materials().raceways.youngs_modulus,
        };
        Ok(Self { screw, body: NutBody { outer, length }, assumed })
    }

    /// Works like [`of`](Self::of), but adds a note if the groove of the case is incomplete.
    pub(crate) fn without_groove(case: &Case) -> Result<Self, CaseError> {
        let mut size = Self::of(case, None)?;
        if case.given().intersects(inputs! { contact_angle_deg nut_conformity screw_conformity }) {
            let missing = rated_nut::NEEDS.missing(rated_nut::given(case)).join(", ");
            size.assumed.push(format!(
                "The groove is not given in full and is ignored; missing: {missing}."
            ));
        }
        Ok(size)
    }
}

/// Returns the typical length of the nut set \[mm\], or `None` if the lead or the number of loaded
/// turns is unknown.
pub(crate) fn usual_nut_length_mm(case: &Case) -> Option<f64> {
    let starts = case.number(InputKey::starts);
    let (pitch, turns) = (case.lead()? * MM / starts, NutTurns::of(case).turns?);
    Some(nut_set(case).usual_length(pitch, turns) / MM)
}
