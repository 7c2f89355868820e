//! Operating points of the comparison in user units.

use bsm_case::Case;

/// Inputs of the rigid model, in the order of a [`Point`].
pub(crate) const INPUTS: [&str; 10] = [
    "ball_diameter_mm",
    "pitch_circle_diameter_mm",
    "lead_angle_deg",
    "contact_angle_deg",
    "friction_coefficient",
    "density_kg_m3",
    "screw_speed_rpm",
    "nut_speed_rpm",
    "axial_load_N",
    "loaded_balls",
];

/// Values of the inputs in [`INPUTS`] at one operating point.
pub(crate) type Point = [f64; INPUTS.len()];

/// Returns the values of the inputs in [`INPUTS`] for a case.
pub(crate) fn point(case: &Case) -> Point {
    bsm_benches::values(case, &INPUTS)
}
