//! Random operating points for tests in practical and in extreme ranges, and the operating point of
//! a reference nut.

use std::f64::consts::PI;

use bsm_kin::{Drive, Helix};
use bsm_sample::Sample;
use rand::{Rng, RngExt};

use crate::{Ball, Conformities, Coulomb, ElasticPoint, Load, Material, Materials, OperatingPoint};

/// Returns a random screw in the practical ranges of the inputs, as in the benchmarks. For most of
/// these screws, the rigid model has a root.
pub(crate) fn random_practical_screw(rng: &mut impl Rng) -> ElasticPoint {
    let radius = 24.3e-3;
    let speed = rng.random_range(50.0..6000.0) * PI / 30.0;
    let speed = if rng.random_bool(0.5) { speed } else { -speed };
    let (screw_speed, nut_speed) = if rng.random_bool(0.5) { (speed, 0.0) } else { (0.0, speed) };
    let steel = Material { youngs_modulus: 207e9, poisson_ratio: 0.3 };
    ElasticPoint {
        point: OperatingPoint {
            helix: Helix { radius, lead_angle: rng.random_range(8.0_f64..45.0).to_radians() },
            contact_angle: rng.random_range(30.0_f64..70.0).to_radians(),
            ball: Ball::of_density(radius * rng.random_range(0.07..0.2), 7800.0),
            friction: Coulomb(rng.random_range(0.01..0.1)),
            drive: Drive { screw_speed, nut_speed },
            load: Load { axial: rng.random_range(20.0..3000.0), balls: 1.0 },
        },
        conformity: Conformities::alike(0.53),
        material: Materials::alike(steel),
    }
}

/// Returns a random screw in the extreme ranges of the inputs. The logarithms of speeds, loads,
/// sizes, moduli, friction coefficient and density are uniformly distributed.
pub(crate) fn random_extreme_screw(rng: &mut impl Rng) -> ElasticPoint {
    let mut log = |low: f64, high: f64| rng.log_uniform(low, high);
    let (radius, size) = (0.5e-3 * log(0.1, 200.0), log(0.01, 0.45));
    let (axial, speed, other) = (log(1e-6, 1e6), log(1e-3, 1e6), log(1e-3, 1e6));
    let friction = log(1e-6, 1.0);
    let (groove, ball, density) = (log(1e7, 1e12), log(1e7, 1e12), log(500.0, 2e4));
    let conformity = Conformities { nut: 0.5 + log(1e-3, 0.3), screw: 0.5 + log(1e-3, 0.3) };
    let mut flip = |x: f64| if rng.random_bool(0.5) { x } else { -x };
    let [speed, other] = [speed, other].map(|rpm| flip(rpm) * PI / 30.0);
    let (screw_speed, nut_speed) = match rng.random_range(0..5) {
        0 | 1 => (speed, 0.0),
        2 | 3 => (0.0, speed),
        _ => (speed, other),
    };
    let lead_angle = rng.random_range(0.05_f64..85.0).to_radians();
    let material = |youngs_modulus| Material { youngs_modulus, poisson_ratio: 0.3 };
    ElasticPoint {
        point: OperatingPoint {
            helix: Helix { radius: radius / size, lead_angle },
            contact_angle: rng.random_range(1.0_f64..89.0).to_radians(),
            ball: Ball::of_density(radius, density),
            friction: Coulomb(friction),
            drive: Drive { screw_speed, nut_speed },
            load: Load { axial, balls: 1.0 },
        },
        conformity,
        material: Materials { raceways: material(groove), ball: material(ball) },
    }
}

/// Returns the screw of a 40 mm x 10 mm nut with 6.35 mm balls, for which independent reference
/// solutions exist. The speed is in rad/s.
pub(crate) fn nut_operating_point(axial: f64, balls: f64, screw_speed: f64) -> ElasticPoint {
    let radius = 20.668e-3;
    let steel = Material { youngs_modulus: 206e9, poisson_ratio: 0.3 };
    ElasticPoint {
        point: OperatingPoint {
            helix: Helix { radius, lead_angle: (10e-3 / (2.0 * PI * radius)).atan() },
            contact_angle: 45.0_f64.to_radians(),
            ball: Ball::of_density(3.175e-3, 7850.0),
            friction: Coulomb(0.06),
            drive: Drive { screw_speed, nut_speed: 0.0 },
            load: Load { axial, balls },
        },
        conformity: Conformities::alike(0.5203),
        material: Materials::alike(steel),
    }
}
