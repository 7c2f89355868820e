//! Solves the rigid model for Lin's screw, and shows why there is no solution at a small lead
//! angle.
//!
//! Run the example with `cargo run -p bsm-dyn --example lin_screw`.
#![expect(clippy::print_stdout, reason = "the result of an example")]

use std::f64::consts::PI;

use bsm_dyn::{
    Ball, Coulomb, Load, OperatingPoint,
    model::{Rigid, RigidWorkspace},
};
use bsm_kin::{Drive, Helix};

fn main() {
    let mut work = RigidWorkspace::default();
    for lead_angle_deg in [10.0_f64, 5.0] {
        let point = OperatingPoint {
            helix: Helix { radius: 24.3e-3, lead_angle: lead_angle_deg.to_radians() },
            contact_angle: PI / 4.0,
            ball: Ball::of_density(4.37e-3, 7800.0),
            friction: Coulomb(0.075),
            drive: Drive { screw_speed: 2000.0 * PI / 30.0, nut_speed: 0.0 },
            load: Load { axial: 2113.0, balls: 1.0 },
        };
        let solution = Rigid { point }.solve(&mut work);
        match solution.result {
            Ok(state) => println!("efficiency {:.4}", state.transmission.efficiency),
            Err(none) => println!("{none}"),
        }
    }
}
