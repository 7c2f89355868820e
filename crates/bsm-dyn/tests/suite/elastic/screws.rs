//! Random screws within the ranges of inputs for which the elastic models are intended.

use std::f64::consts::PI;

use bsm_dyn::{
    Ball, Conformities, Coulomb, ElasticPoint, Load, Material, Materials, OperatingPoint,
};
use bsm_kin::{Drive, Helix};
use bsm_sample::Sample;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

pub(crate) const STEEL: Material = Material { youngs_modulus: 207e9, poisson_ratio: 0.3 };

/// Returns Lin's screw with conformities of 0.53 and with a single ball.
pub(crate) fn lin(lead_deg: f64, contact_deg: f64, rpm: f64, axial: f64) -> ElasticPoint {
    ElasticPoint {
        point: OperatingPoint {
            helix: Helix { radius: 24.3e-3, lead_angle: lead_deg.to_radians() },
            contact_angle: contact_deg.to_radians(),
            ball: Ball::of_density(4.37e-3, 7800.0),
            friction: Coulomb(0.075),
            drive: Drive { screw_speed: rpm * PI / 30.0, nut_speed: 0.0 },
            load: Load { axial, balls: 1.0 },
        },
        conformity: Conformities::alike(0.53),
        material: Materials::alike(STEEL),
    }
}

/// Returns a copy of a screw with changed inputs.
pub(crate) fn with(
    mut screw: ElasticPoint,
    change: impl FnOnce(&mut ElasticPoint),
) -> ElasticPoint {
    change(&mut screw);
    screw
}

/// Returns an infinite sequence of random screws with pitch circle diameters of 8 to 100 mm.
///
/// The ranges are: static pressure 0.2 to 5 GPa, lead angle 1 to 40 deg, speed 10 to 30 000 rpm in
/// both directions with screw drive or nut drive, contact angle 30 to 60 deg, conformity 0.51 to
/// 0.56, friction coefficient 0.01 to 0.15, and ratio of ball radius to pitch circle radius 0.07 to
/// 0.2.
pub(crate) fn screws(seed: u64) -> impl Iterator<Item = ElasticPoint> {
    let usual = Ranges { lead: (1.0, 40.0), contact: (30.0, 60.0), friction: 0.01, ball: 0.07 };
    random_screws(seed, usual)
}

/// Returns random screws in wider ranges: lead angles of 0.3 to 55 deg, contact angles of 25 to 65
/// deg, friction coefficients of at least 0.002, and ratios of ball radius to pitch circle radius
/// of at least 0.03.
pub(crate) fn unusual_screws(seed: u64) -> impl Iterator<Item = ElasticPoint> {
    let wide = Ranges { lead: (0.3, 55.0), contact: (25.0, 65.0), friction: 0.002, ball: 0.03 };
    random_screws(seed, wide).filter(|screw| inertia_ratio(screw) <= 3.0)
}

#[derive(Clone, Copy)]
struct Ranges {
    lead: (f64, f64),
    contact: (f64, f64),
    friction: f64,
    ball: f64,
}

fn random_screws(seed: u64, ranges: Ranges) -> impl Iterator<Item = ElasticPoint> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    std::iter::from_fn(move || {
        let radius = rng.random_range(4e-3..50e-3);
        let rpm = rng.log_uniform(10.0, 30_000.0);
        let speed = if rng.random_bool(0.5) { rpm } else { -rpm } * PI / 30.0;
        let (screw_speed, nut_speed) =
            if rng.random_bool(0.5) { (speed, 0.0) } else { (0.0, -speed) };
        let mut screw = ElasticPoint {
            point: OperatingPoint {
                helix: Helix {
                    radius,
                    lead_angle: rng.random_range(ranges.lead.0..ranges.lead.1).to_radians(),
                },
                contact_angle: rng.random_range(ranges.contact.0..ranges.contact.1).to_radians(),
                ball: Ball::of_density(radius * rng.random_range(ranges.ball..0.2), 7800.0),
                friction: Coulomb(rng.random_range(ranges.friction..0.15)),
                drive: Drive { screw_speed, nut_speed },
                load: Load { axial: 1.0, balls: 1.0 },
            },
            conformity: Conformities {
                nut: rng.random_range(0.51..0.56),
                screw: rng.random_range(0.51..0.56),
            },
            material: Materials::alike(STEEL),
        };
        let pressure = rng.log_uniform(0.2e9, 5e9);
        let of_one_newton = screw.hertz().expect("an ellipse")[0].max_pressure(1.0);
        // The maximum pressure is proportional to Q^{1/3}, and the normal load Q follows from Q
        // cosα sinβ = F_a.
        let normal = (pressure / of_one_newton).powi(3);
        screw.point.load.axial =
            normal * screw.point.helix.lead_angle.cos() * screw.point.contact_angle.sin();
        Some(screw)
    })
}

/// Returns the inertia ratio `$m r_m W^2/F_a$`.
pub(crate) fn inertia_ratio(screw: &ElasticPoint) -> f64 {
    let speed = screw.point.drive.relative_speed();
    screw.point.ball.mass * screw.point.helix.radius * speed * speed / screw.point.load.per_ball()
}

/// Returns random screws that can be operated in practice. Their centrifugal force `$m r_m P^2$`,
/// about a third of `$m r_m W^2$`, is below the axial load. A larger centrifugal force would move
/// the ball to the bottom of the nut groove, where the opposite flank also carries load.
pub(crate) fn real_screws(seed: u64) -> impl Iterator<Item = ElasticPoint> {
    screws(seed).filter(|screw| inertia_ratio(screw) <= 3.0)
}
