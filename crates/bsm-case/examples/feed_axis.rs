//! Sizes a feed axis from a case file with the names and units of the program `bsm`, and prints its
//! life, its torque and each rule that it violates. Run it with `cargo run --release --example
//! feed_axis`.

use std::error::Error;
use std::io::{Write as _, stdout};

use bsm_case::{AxisReport, Case, Settings, output};

const AXIS: &[u8] = br#"{
    "ball_diameter_mm": 10, "pitch_circle_diameter_mm": 63.35, "lead_mm": 20,
    "contact_angle_deg": 45, "nut_conformity": 0.52, "screw_conformity": 0.52,
    "loaded_balls_per_turn": 16, "loaded_turns": 6, "friction_coefficient": 0.06,
    "axial_load_N": 10000, "feed_m_min": 30, "stroke_mm": 1200, "support": "fixed-supported",
    "moved_mass_kg": 500, "required_life_h": 20000
}"#;

fn main() -> Result<(), Box<dyn Error>> {
    let case = Case::from_json(AXIS)?;
    let axis = AxisReport::of(&case, &Settings::default())?;
    for name in [output!(cycle_life_h), output!(screw_torque_Nm), output!(screw_efficiency)] {
        match axis.number(name) {
            Some(value) => writeln!(stdout(), "{:24} {value:.5}", name.name())?,
            None => {
                writeln!(stdout(), "{:24} cannot be calculated from these inputs", name.name())?;
            }
        }
    }
    writeln!(stdout(), "all rules pass: {}", axis.passes())?;
    Ok(())
}
