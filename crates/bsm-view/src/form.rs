//! What the form of the page is made from: inputs by group, with their units and rules, and the names of all choices.

use bsm_case::units::{other_units, words};
use bsm_case::{INPUTS, ModelChoice, OUTPUTS, Settings, input_schema, output_schema};
use bsm_dyn::{Control, RacewayFriction};
use serde_json::{Value, json};

use crate::answer::MOST_POINTS;

/// Inputs by group; those of the nut are all others.
const GROUPS: [(&str, &[&str]); 5] = [
    (
        "screw",
        &[
            "ball_diameter_mm",
            "pitch_circle_diameter_mm",
            "lead_mm",
            "lead_angle_deg",
            "contact_angle_deg",
            "nut_running_contact_angle_deg",
            "screw_running_contact_angle_deg",
            "nut_conformity",
            "screw_conformity",
            "starts",
            "density_kg_m3",
            "youngs_modulus_GPa",
            "poisson_ratio",
            "ball_youngs_modulus_GPa",
            "ball_poisson_ratio",
            "groove_bottom_distance_mm",
            "axial_play_um",
            "nut_bore_mm",
            "screw_outer_diameter_mm",
        ],
    ),
    ("nut", &[]),
    (
        "operating point",
        &[
            "screw_speed_rpm",
            "feed_m_min",
            "nut_speed_rpm",
            "axial_load_N",
            "loaded_balls",
            "friction_coefficient",
            "rolling_friction_mm",
        ],
    ),
    (
        "lubricant",
        &[
            "iso_vg",
            "viscosity_40C_mm2_s",
            "viscosity_100C_mm2_s",
            "lubricant_temperature_C",
            "ambient_temperature_C",
            "heat_transfer_W_K",
            "lubricant_density_kg_m3",
            "pressure_viscosity_1_GPa",
            "limiting_shear_ratio",
            "boundary_friction_coefficient",
            "ball_roughness_um",
            "nut_roughness_um",
            "screw_roughness_um",
            "film_factor",
            "rolling_factor",
            "hysteresis_loss",
            "seal_torque_Nm",
            "ball_contact_force_N",
            "ball_contact_friction",
            "return_circuits",
            "return_loss_coefficient",
            "drag_coefficient",
        ],
    ),
    (
        "axis",
        &[
            "stroke_mm",
            "unsupported_length_mm",
            "shaft_diameter_mm",
            "moved_mass_kg",
            "inclination_deg",
            "guide_friction",
            "motor_inertia_kg_m2",
            "coupling_inertia_kg_m2",
            "gear_ratio",
            "support_bearing_torque_Nm",
            "support_bearing_rigidity_N_um",
            "housing_rigidity_N_um",
            "reliability_percent",
            "axis_heat_transfer_W_K",
            "rated_dynamic_load_N",
            "rated_static_load_N",
            "speed_number_limit_mm_min",
            "required_life_h",
            "required_static_safety",
            "required_critical_speed_ratio",
            "required_buckling_safety",
        ],
    ),
];

/// Schemas of scene and result, and the other data of the form.
pub(crate) fn schema() -> Value {
    let group = |name: &str| {
        let found = GROUPS.iter().find(|(_, names)| names.contains(&name));
        found.map_or("nut", |(group, _)| *group)
    };
    let inputs = INPUTS.iter().map(|input| {
        let label = words(input.name, "");
        let label = words(input.name, input.unit).split(',').next().map_or(label, str::to_owned);
        let units: Vec<_> = other_units(input.name)
            .into_iter()
            .map(|(unit, factor)| json!([unit, factor]))
            .collect();
        json!({
            "name": input.name,
            "label": label,
            "unit": input.unit,
            "about": input.about,
            "rule": input.rule.describe(),
            "default": input.default,
            "group": group(input.name),
            "units": units,
        })
    });
    let outputs = OUTPUTS.iter().filter(|output| output.json_type == "number").map(
        |output| json!({ "name": output.name, "label": words(output.name, output.unit), "about": output.about }),
    );
    json!({
        "input": input_schema(),
        "output": output_schema(),
        "groups": GROUPS.map(|(name, _)| name),
        "inputs": inputs.collect::<Vec<_>>(),
        "outputs": outputs.collect::<Vec<_>>(),
        "models": ModelChoice::names().collect::<Vec<_>>(),
        "controls": Control::ALL.map(Control::name),
        "frictions": RacewayFriction::ALL.map(RacewayFriction::name),
        "settings": Settings::default().to_json(),
        "points": MOST_POINTS,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A name that is misspelt would show up among those of the nut.
    #[test]
    fn the_groups_name_inputs() {
        for name in GROUPS.iter().flat_map(|(_, names)| *names) {
            assert!(INPUTS.iter().any(|input| input.name == *name), "{name}");
        }
    }
}
