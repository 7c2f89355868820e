//! Solves one operating point of a feed drive in SI units with three models of increasing detail,
//! and prints efficiency and losses. Run the example with
//! `cargo run --release --example operating_point`.

use std::f64::consts::PI;
use std::io::{Error, Write as _, stdout};

use bsm_dyn::{
    Ball, Conformities, Coulomb, ElasticPoint, Load, Material, Materials, ModelWorkspace,
    OperatingPoint, Problem,
    model::{RacewayControl, Rigid, Traction},
};
use bsm_kin::{Drive, Helix};

fn main() -> Result<(), Error> {
    let (radius, lead) = (20.75e-3, 20e-3);
    let steel = Material { youngs_modulus: 207e9, poisson_ratio: 0.3 };
    let point = OperatingPoint {
        helix: Helix { radius, lead_angle: f64::atan2(lead, 2.0 * PI * radius) },
        contact_angle: PI / 4.0,
        ball: Ball::of_density(3.175e-3, 7800.0),
        friction: Coulomb(0.06),
        drive: Drive { screw_speed: 50.0 * PI, nut_speed: 0.0 },
        load: Load { axial: 8000.0, balls: 70.0 },
    };
    let screw = ElasticPoint {
        point,
        conformity: Conformities::alike(0.53),
        material: Materials::alike(steel),
    };

    // One [`ModelWorkspace`] can be reused for all points that a thread solves.
    let mut workspace = ModelWorkspace::default();
    for problem in [
        Problem::Rigid(Rigid { point }),
        Problem::RacewayControl(RacewayControl { screw, control: None }),
        Problem::Traction(Traction { screw, accuracy: Traction::ACCURACY, creep: Traction::CREEP }),
    ] {
        let solution = problem.solve(&mut workspace);
        let model = solution.model.name();
        match solution.result {
            Ok(state) => {
                let efficiency = state.transmission.efficiency;
                write!(stdout(), "{model:16} efficiency {efficiency:.5}")?;
                if let Some(power) = state.transmission.power {
                    write!(stdout(), ", losses {:.2} W", power.dissipated)?;
                }
                writeln!(stdout())?;
            }
            Err(none) => writeln!(stdout(), "{model:16} no result: {none:?}")?,
        }
    }
    Ok(())
}
