//! The nut and screw that the tests use: nominal diameter 40 mm, lead 10 mm, ball diameter 6.35 mm.

use std::f64::consts::PI;

use bsm_dyn::{Ball, Conformities, Material, Materials};
use bsm_kin::Helix;
use bsm_nut::{BallNut, Circuit, Errors};

const STEEL: Material = Material { youngs_modulus: 206e9, poisson_ratio: 0.3 };

pub(crate) fn with_circuits(circuits: Vec<Circuit>) -> BallNut {
    let (pitch, lead, radius) = (41.336e-3, 10e-3, 3.175e-3_f64);
    BallNut {
        helix: Helix { radius: 0.5 * pitch, lead_angle: (lead / (PI * pitch)).atan() },
        starts: 1,
        ball: Ball { radius, mass: 4.0 / 3.0 * PI * radius.powi(3) * 7800.0 },
        contact_angle: 45_f64.to_radians(),
        conformity: Conformities::alike(0.5203),
        material: Materials::alike(STEEL),
        circuits,
        errors: Errors::default(),
        nut_bar: None,
        screw_bar: None,
        ring: None,
        reference: None,
        precession: 0.0,
    }
}
