use bsm_kin::{Drive, Helix};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;
use crate::{Ball, Load, Material};

pub(super) fn draw(seed: u64, number: u64) -> ElasticScrew {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(number);
    let mut log = |low: f64, high: f64| (low.ln() + rng.random::<f64>() * (high / low).ln()).exp();
    let (ball, ratio) = (0.5e-3 * log(0.1, 200.0), log(0.01, 0.45));
    let (load, speed, other) = (log(1e-6, 1e6), log(1e-3, 1e6), log(1e-3, 1e6));
    let friction = log(1e-6, 1.0);
    let (modulus, ball_modulus, density) = (log(1e7, 1e12), log(1e7, 1e12), log(500.0, 2e4));
    let (nut, screw) = (0.5 + log(1e-3, 0.3), 0.5 + log(1e-3, 0.3));
    let mut flip = |x: f64| if rng.random_bool(0.5) { x } else { -x };
    let rpm = std::f64::consts::PI / 30.0;
    let (speed, other) = (flip(speed) * rpm, flip(other) * rpm);
    let (screw_speed, nut_speed) = match rng.random_range(0..5) {
        0 | 1 => (speed, 0.0),
        2 | 3 => (0.0, speed),
        _ => (speed, other),
    };
    let m = |e| Material { youngs_modulus: e, poisson_ratio: 0.3 };
    ElasticScrew {
        helix: Helix {
            radius: ball / ratio,
            lead_angle: rng.random_range(0.05_f64..85.0).to_radians(),
        },
        contact_angle: rng.random_range(1.0_f64..89.0).to_radians(),
        ball: Ball::of_density(ball, density),
        conformity: (nut, screw),
        material: (m(modulus), m(ball_modulus)),
        friction,
        drive: Drive { screw_speed, nut_speed },
        load: Load { axial: load, balls: 1.0 },
    }
}

fn env(name: &str, default: u64) -> u64 {
    std::env::var(name).ok().and_then(|x| x.parse().ok()).unwrap_or(default)
}

#[test]
fn statistics() {
    let mut work = TractionWorkspace::default();
    let (mut bins, mut n) = (std::collections::BTreeMap::<String, [usize; 3]>::new(), 0);
    for number in 0..env("POINTS", 4000) {
        let screw = draw(env("SEED", 8), number);
        let Ok(pair) = screw.pair() else { continue };
        n += 1;
        let case = Traction { screw, order: Traction::ORDER, creep: Traction::CREEP };
        let s = case.solve(&mut work);
        let a = pair.semi_axes[0].0.max(pair.semi_axes[1].0);
        let l = |x: f64| x.log10().floor().clamp(-6.0, 6.0) as i32;
        let place = match s.status { Status::Converged => 0, Status::NoSolution => 1, _ => 2 };
        let rate = pair.nut_speed.abs().max(1.0);
        for key in [
            format!("a {:3}", l(a)),
            format!("f {:3}", l(pair.friction)),
            format!("mu {:3}", l(pair.inertia_ratio())),
            format!("muP2 {:3}", l(pair.inertia_ratio() * rate * rate)),
            format!("small mu, a {:3}", if pair.inertia_ratio() < 0.01 { l(a) } else { 99 }),
            format!("small mu, small a, f {:3}", if pair.inertia_ratio() < 0.01 && a < 1.0 { l(pair.friction) } else { 99 }),
        ] {
            bins.entry(key).or_default()[place] += 1;
        }
    }
    for (key, [a, b, c]) in &bins {
        println!("{key:30} {a:6} {b:6} {c:6}   {:.2} % of all, {:.1} % of class", 100.0 * *c as f64 / n as f64, 100.0 * *c as f64 / (a + b + c) as f64);
    }
}

/// An admissible root from random starts, if one is found.
fn search(system: &Rolling, starts: usize, rng: &mut impl rand::Rng, newton: &mut Workspace) -> Option<[f64; BALL]> {
    use std::f64::consts::FRAC_PI_2;
    let pair = system.pair;
    let (lead, mu) = (pair.helix.lead_angle, pair.inertia_ratio());
    (0..starts).find_map(|_| {
        let mut y = [0.0; BALL];
        // Angles on the flanks, near 0 or 90 deg as well as between.
        let angle = |rng: &mut dyn rand::Rng| {
            let small = 10.0_f64.powf(rng.random_range(-4.0..0.0)) * 0.5 * FRAC_PI_2;
            match rng.random_range(0..4) { 0 => small, 1 => FRAC_PI_2 - small, _ => rng.random_range(0.0..FRAC_PI_2) }
        };
        let (a, b) = match rng.random_range(0..3) {
            0 => (angle(rng), angle(rng)),
            1 => { let beta = pair.jones.contact_angle; (beta * rng.random_range(0.0..1.0), beta + (FRAC_PI_2 - beta) * rng.random_range(0.0..1.0)) }
            _ => { let (q, m) = pair.static_load(|_| 0.0).ok()?; let t = rng.random_range(-0.2..0.2) * pair.friction.min(1.0); (m - t, m + t) }
        };
        let wild = |rng: &mut dyn rand::Rng| rng.random_range(-1.0..1.0_f64).exp();
        y[NUT_LOAD] = wild(rng) / (a.sin().max(1e-6) * lead.cos());
        y[SCREW_LOAD] = wild(rng) / (b.sin().max(1e-6) * lead.cos());
        y[TILT] = 0.5 * (b - a);
        // Rates between those of both members, or so slow that inertia is of the size of load or friction.
        let p = rng.random_range(-0.5..1.5) * pair.sign();
        let slow = (rng.random_range(-8.0..0.0_f64).exp() * if rng.random_bool(0.5) { pair.friction / mu } else { mu.recip().sqrt() }).min(1.0);
        let rate = if rng.random_bool(0.5) { pair.nut_speed + p } else { slow * p.signum() };
        y[PRECESSION] = rate - system.offset();
        // Rolling, more or less, with any spin.
        let spin = rng.random_range(-3.0..3.0) * pair.arc;
        y[OMEGA[0]] = -(rate - pair.nut_speed) * pair.arc * rng.random_range(0.0..1.5) + spin * rng.random_range(-0.1..0.1);
        y[OMEGA[1]] = spin * rng.random_range(-1.0..1.0);
        y[OMEGA[2]] = rng.random_range(-0.6..0.6);
        let begin = (0.0_f64).max(system.creep.ln() + 1.0) + pair.slip_scale().ln();
        let stride = Stride { first: 1.5, shortest: 0.05 };
        let begin = match rng.random_range(0..3) { 0 => system.creep.ln(), 1 => 0.5 * (system.creep.ln() + begin), _ => begin };
        let found = follow(&mut y, (begin, system.creep.ln()), stride, |log, y| {
            Rolling { creep: log.exp(), ..*system }.run(y, newton).converged()
        });
        let angles = system.state(&y).ok()?.loaded.angles;
        (found.is_ok() && y.iter().all(|y| y.abs() < 1e12) && angles.iter().all(|a| (0.0..FRAC_PI_2).contains(a))).then_some(y)
    })
}

#[test]
fn searches() {
    let mut work = TractionWorkspace::default();
    let mut rng = ChaCha8Rng::seed_from_u64(77);
    let mut bins = std::collections::BTreeMap::<String, [usize; 2]>::new();
    let starts = env("STARTS", 60) as usize;
    let limit = env("LIMIT", 1000000);
    for number in env("FROM", 0)..env("POINTS", 4000) {
        let screw = draw(env("SEED", 8), number);
        let Ok(pair) = screw.pair() else { continue };
        let case = Traction { screw, order: Traction::ORDER, creep: Traction::CREEP };
        let s = case.solve(&mut work);
        let hard = s.outputs.iterations.is_none_or(|n| n > 150);
        if !hard { continue }
        let place = work.quadrature(case.order);
        let system = Rolling { pair: &pair, quadrature: &work.quadratures[place].1, creep: case.creep * pair.slip_scale() };
        let found = search(&system, starts, &mut rng, &mut work.newton);
        let key = format!("{:?}", s.status);
        let bin = bins.entry(key.clone()).or_default();
        bin[0] += 1;
        bin[1] += usize::from(found.is_some());
        if let Some(y) = found {
            if s.status != Status::Converged {
                println!("{key} {number} mu {:.2e} f {:.2e} a {:.1e} {:?} {y:?} rate {:.3e} angles {:?}", pair.inertia_ratio(), pair.friction, pair.semi_axes[0].0, s.reason, y[PRECESSION] + system.offset(), system.angles(&y));
            }
        }
    }
    println!("{bins:#?}");
}

