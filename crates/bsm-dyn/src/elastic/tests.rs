//! Denials against searches from many starts.

use std::f64::consts::{FRAC_PI_2, PI};

use bsm_kin::{Drive, Helix};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;
use crate::{Ball, Load, Material};

/// Starts of the search of one point.
const STARTS: usize = 300;

/// A screw of the ranges of the extremes.
pub(super) fn extreme(rng: &mut impl Rng) -> ElasticScrew {
    let mut log = |low: f64, high: f64| (low.ln() + rng.random::<f64>() * (high / low).ln()).exp();
    let (ball, size) = (log(0.05e-3, 0.1), log(0.01, 0.45));
    let (axial, speed, other) = (log(1e-6, 1e6), log(1e-4, 1e5), log(1e-4, 1e5));
    let friction = log(1e-6, 1.0);
    let conformity = (0.5 + log(1e-3, 0.3), 0.5 + log(1e-3, 0.3));
    let density = log(500.0, 2e4);
    let mut steel = || Material { youngs_modulus: log(1e7, 1e12), poisson_ratio: 0.3 };
    let material = (steel(), steel());
    let mut flip = |x: f64| if rng.random_bool(0.5) { x } else { -x };
    let (speed, other) = (flip(speed), flip(other));
    let (screw_speed, nut_speed) = match rng.random_range(0..5) {
        0 | 1 => (speed, 0.0),
        2 | 3 => (0.0, speed),
        _ => (speed, other),
    };
    ElasticScrew {
        helix: Helix {
            radius: ball / size,
            lead_angle: rng.random_range(0.05_f64..85.0).to_radians(),
        },
        contact_angle: rng.random_range(1.0_f64..89.0).to_radians(),
        ball: Ball::of_density(ball, density),
        conformity,
        material,
        friction,
        drive: Drive { screw_speed, nut_speed },
        load: Load { axial, balls: 1.0 },
    }
}

/// A screw of little inertia.
fn calm(rng: &mut impl Rng) -> ElasticScrew {
    let ball = Ball::of_density(3e-3, 7800.0);
    let radius = ball.radius / rng.random_range(0.02..0.45);
    let friction = 10.0_f64.powf(rng.random_range(-3.0..0.0));
    let inertia = 10.0_f64.powf(rng.random_range(-4.0..-1.3)) * friction;
    let speed = (inertia * 100.0 / (ball.mass * radius)).sqrt();
    let speed = if rng.random_bool(0.5) { speed } else { -speed };
    let steel = Material { youngs_modulus: 207e9, poisson_ratio: 0.3 };
    ElasticScrew {
        helix: Helix { radius, lead_angle: rng.random_range(1.0_f64..85.0).to_radians() },
        contact_angle: rng.random_range(3.0_f64..87.0).to_radians(),
        ball,
        conformity: (rng.random_range(0.51..0.6), rng.random_range(0.51..0.6)),
        material: (steel, steel),
        friction,
        drive: Drive { screw_speed: speed, nut_speed: 0.0 },
        load: Load { axial: 100.0, balls: 1.0 },
    }
}

/// An admissible root from random starts, if one is found.
fn search(pair: &Pair, rng: &mut impl Rng, newton: &mut Workspace) -> Option<[f64; BALL]> {
    let size = pair.arc;
    (0..STARTS).find_map(|_| {
        let mut y = [0.0; BALL];
        let load = pair.helix.lead_angle.cos().recip() * rng.random_range(0.0..1.5_f64).exp();
        // Tilt and difference of the loads are of the size of the inertia.
        let inertia = 3.0 * pair.inertia_ratio();
        y[NUT_LOAD] = load + rng.random_range(-inertia..inertia);
        y[SCREW_LOAD] = load;
        y[TILT] = rng.random_range(-inertia..inertia);
        y[PRECESSION] = rng.random_range(-1.5..2.0);
        y[SLIP] = size * rng.random_range(-5.0..2.0_f64).exp();
        y[SLIP_ANGLE] = rng.random_range(-PI..PI);
        y[SPIN] = rng.random_range(-2.5..2.5_f64) * pair.friction * load;
        let weights = weights(pair, &y);
        let scales = Scales { x: &[1.0; BALL], f: &weights };
        let options = Options { residual_tol: 1e-11, max_steps: 60, ..Options::default() };
        let report = solve(&Saturated(pair), &mut y, &scales, &options, newton).ok()?;
        let angles = Saturated(pair).state(&y).ok()?.loaded.angles;
        let flanks = angles.iter().all(|angle| (0.0..FRAC_PI_2).contains(angle));
        // The root at infinity: a ball that hardly circles, P → 0, and spins without bounds.
        let rate = y[PRECESSION] * pair.sign() + pair.nut_speed;
        let finite = rate.abs() > 1e-6 && y[SLIP] < 10.0 * size && y[PRECESSION].abs() < 10.0;
        (report.converged() && y[SLIP] > 0.0 && flanks && finite).then_some(y)
    })
}

/// Where a root is denied, searches from many starts find none; where one is found, they mostly find
/// it too.
#[test]
fn many_starts_find_no_root_where_one_is_denied() {
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    let mut newton = Workspace::new(BALL);
    let (mut denied, mut found, mut seen) = (0, 0, 0);
    let mut refuted = Vec::new();
    for _ in 0..200 {
        let screw = calm(&mut rng);
        let Ok(pair) = screw.pair() else { continue };
        match Skid::of(&pair, &mut newton) {
            Err((Status::NoSolution, reason)) => {
                denied += 1;
                if let Some(y) = search(&pair, &mut rng, &mut newton) {
                    refuted.push((screw, reason, y));
                }
            }
            Ok(_) if found < 15 => {
                found += 1;
                seen += usize::from(search(&pair, &mut rng, &mut newton).is_some());
            }
            _ => {}
        }
    }
    println!("{denied} denied, {} refuted, {seen} of {found} seen", refuted.len());
    assert!(refuted.is_empty(), "{refuted:#?}");
    assert!(denied > 10 && seen * 2 > found, "{denied} {seen} {found}");
}
