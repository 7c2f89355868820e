//! Inputs that each result of an axis needs. A result with missing inputs is omitted, and a note
//! names the missing inputs.

use super::state::AxisState;
use crate::{Case, CaseError, Numbers, OutputName, output};

/// A required input, or several inputs of which one is sufficient.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Need {
    Lead,
    Load,
    Speed,
    DynamicRating,
    StaticRating,
    Length,
    Core,
    PitchCircle,
}

use Need::{Core, DynamicRating, Lead, Length, Load, PitchCircle, Speed, StaticRating};

/// Label, output and required inputs of each result. The label of a result that a rule limits begins
/// with the title of the rule.
const RESULTS: [(&str, OutputName, &[Need]); 7] = [
    ("life", output!(cycle_life_h), &[DynamicRating, Load, Speed]),
    ("static safety", output!(static_safety_factor), &[StaticRating, Load]),
    ("screw torque", output!(screw_torque_Nm), &[Lead, Load, Speed]),
    ("critical speed", output!(critical_speed_ratio), &[Core, Length, Speed]),
    ("buckling safety", output!(buckling_safety), &[Core, Length, Load]),
    ("core stress", output!(yield_load_N), &[Core, Load]),
    ("speed number", output!(largest_speed_number_mm_min), &[PitchCircle, Speed]),
];

/// Output for the torque. If the friction coefficient is constant or a catalog efficiency is used,
/// the torque does not depend on the speed.
const TORQUE: OutputName = output!(screw_torque_Nm);

/// Results that depend neither on the screw nor on its load, such as the position resolution of a
/// motor.
const OTHER_RESULTS: [OutputName; 3] =
    [output!(stopping_distance_mm), output!(travel_per_step_um), output!(travel_per_count_um)];

impl Need {
    /// Returns the name of the required input, or the names of the alternative inputs.
    fn inputs(self) -> &'static str {
        match self {
            Lead => "lead_mm",
            Load => "axial_load_N (or cycle)",
            Speed => "screw_speed_rpm or feed_m_min (or cycle)",
            DynamicRating => "rated_dynamic_load_N",
            StaticRating => "rated_static_load_N",
            Length => "stroke_mm or unsupported_length_mm",
            Core => "shaft_diameter_mm (or nominal_diameter_mm)",
            PitchCircle => "pitch_circle_diameter_mm (or nominal_diameter_mm)",
        }
    }

    /// Returns true if the case contains the required input or one of the alternative inputs.
    ///
    /// * `has_groove`: true if the groove is completely given, so that ratings, core diameter and
    ///   pitch circle can be calculated.
    fn is_met(self, case: &Case, has_groove: bool) -> bool {
        if has_groove && ![Load, Speed, Length].contains(&self) {
            return true;
        }
        let cycles = case.entries.cycle.is_some();
        let nominal = case.nominal_diameter_mm.or(case.screw_outer_diameter_mm).is_some();
        match self {
            Lead => case.lead().is_some(),
            Load => {
                cycles || case.is_loaded() || case.moved_mass_kg.or(case.guide_force_N).is_some()
            }
            Speed => case.has_speed(),
            DynamicRating => case.rated_dynamic_load_N.is_some(),
            StaticRating => case.rated_static_load_N.is_some(),
            Length => case.unsupported_length_mm.or(case.stroke_mm).is_some(),
            Core => nominal || case.shaft_diameter_mm.is_some(),
            PitchCircle => nominal || case.pitch_circle_diameter_mm.is_some(),
        }
    }
}

impl AxisState<'_> {
    /// Returns a sentence for each result that is omitted because of missing inputs.
    pub(super) fn left_out(&self) -> Vec<String> {
        let has_groove = self.machine.groove.is_some() && !self.case.has_estimated_groove();
        let is_met = |need: &Need| {
            // If the load cycle states durations, the stroke follows from its speeds and durations.
            let has_stroke = *need == Length && self.machine.stroke.is_some();
            has_stroke || need.is_met(self.case, has_groove)
        };
        let has_torque = self.torque_at_largest_load().is_some();
        let line = |(label, name, needs): &(&str, OutputName, &[Need])| {
            if has_torque && *name == TORQUE {
                return None;
            }
            let missing: Vec<_> =
                needs.iter().filter(|need| !is_met(need)).map(|need| need.inputs()).collect();
            (!missing.is_empty()).then(|| {
                format!(
                    "The {label} is not calculated, because inputs are missing: {}.",
                    missing.join(", ")
                )
            })
        };
        RESULTS.iter().filter_map(line).collect()
    }
}

/// Returns the required inputs of a rule that the case lacks.
///
/// * `rule`: title of the rule.
pub(crate) fn missing_for_rule(case: &Case, rule: &str) -> Vec<String> {
    let results = RESULTS.iter().filter(|(label, ..)| label.starts_with(rule));
    results.flat_map(|(.., needs)| missing(case, needs)).map(str::to_owned).collect()
}

/// Returns the required inputs that the case lacks.
fn missing(case: &Case, needs: &[Need]) -> Vec<&'static str> {
    let has_groove = !case.lacks_groove() && !case.has_estimated_groove();
    let missing = needs.iter().filter(|need| !need.is_met(case, has_groove));
    missing.map(|need| need.inputs()).collect()
}

/// Checks that at least one result can be calculated.
///
/// # Errors
/// Returns a [`CaseError`] that names the smallest set of missing inputs for which a result could
/// be calculated. If several results need equally few inputs, the error names the inputs of all
/// these results.
pub(super) fn check(case: &Case, numbers: &Numbers) -> Result<(), CaseError> {
    let has_result = |(_, number, needs): &(&str, OutputName, &[Need])| {
        let is_sufficient = *number == TORQUE || missing(case, needs).is_empty();
        is_sufficient && numbers.number(*number).is_some()
    };
    let is_known = |number: &OutputName| numbers.number(*number).is_some();
    if RESULTS.iter().any(has_result) || OTHER_RESULTS.iter().any(is_known) {
        return Ok(());
    }
    let ways: Vec<_> =
        RESULTS.iter().map(|(label, _, needs)| (label, missing(case, needs))).collect();
    let fewest = ways.iter().map(|(_, missing)| missing.len()).min().unwrap_or_default();
    let shortest = ways.iter().filter(|(_, missing)| missing.len() == fewest);
    let shortest: Vec<_> = shortest
        .map(|(label, missing)| format!("for the {label}, give {}", missing.join(", ")))
        .collect();
    Err(CaseError::Invalid(format!("no result can be calculated; {}", shortest.join("; "))))
}
