//! The nut of the tests: 40 x 10, balls of 6.35 mm, 98 of them on 4.81 turns.

use std::f64::consts::PI;

use bsm_dyn::{Ball, Material};
use bsm_kin::Helix;
use bsm_nut::{BallNut, Circuit, Errors, Flanks};

const DEG: f64 = PI / 180.0;
const STEEL: Material = Material { youngs_modulus: 206e9, poisson_ratio: 0.3 };

pub(crate) fn circuit(start_deg: f64, arc_deg: f64, balls: usize, flanks: Flanks) -> Circuit {
    let (start, arc) = (start_deg * DEG, arc_deg * DEG);
    Circuit { start, arc, balls, thread: 0, body: 0, flanks, offset: 0.0 }
}

pub(crate) fn with_circuits(circuits: Vec<Circuit>) -> BallNut {
    let (pitch, lead, radius) = (41.336e-3, 10e-3, 3.175e-3_f64);
    BallNut {
        helix: Helix { radius: 0.5 * pitch, lead_angle: (lead / (PI * pitch)).atan() },
        starts: 1,
        ball: Ball { radius, mass: 4.0 / 3.0 * PI * radius.powi(3) * 7800.0 },
        contact_angle: 45.0 * DEG,
        conformity: (0.5203, 0.5203),
        material: (STEEL, STEEL),
        circuits,
        errors: Errors::default(),
        nut_bar: None,
        screw_bar: None,
        ring: None,
        reference: None,
        precession: 0.0,
    }
}

/// One circuit, both flanks.
pub(crate) fn nut_a() -> BallNut {
    with_circuits(vec![circuit(0.0, 1731.6, 98, Flanks::Both)])
}

/// Two bodies against each other, without offset.
pub(crate) fn pair() -> BallNut {
    let second = Circuit { body: 1, ..circuit(1440.0, 1080.0, 60, Flanks::Minus) };
    with_circuits(vec![circuit(0.0, 1080.0, 60, Flanks::Plus), second])
}
