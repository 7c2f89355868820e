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

#[test]
fn paths() {
    let mut work = TractionWorkspace::default();
    let mut bins = std::collections::BTreeMap::<String, Vec<u64>>::new();
    let mut n = 0;
    let begin = std::time::Instant::now();
    let mut path_time = 0.0;
    let (mut worst, mut agree, mut differ) = (0.0_f64, 0, 0);
    let verbose = env("VERBOSE", 0) == 1;
    for number in env("FROM", 0)..env("POINTS", 4000) {
        let screw = draw(env("SEED", 8), number);
        let Ok(pair) = screw.pair() else { continue };
        n += 1;
        let case = Traction { screw, order: Traction::ORDER, creep: Traction::CREEP };
        let s = case.solve(&mut work);
        if s.status == Status::Converged && env("ALL", 0) == 0 { continue }
        let place = work.quadrature(case.order);
        let system = Rolling { pair: &pair, quadrature: &work.quadratures[place].1, creep: case.creep * pair.slip_scale() };
        let t0 = std::time::Instant::now();
        let mut trace = path::Trace::default();
        let r = system.followed(&mut work.newton, &mut trace);
        let t = t0.elapsed().as_secs_f64();
        path_time += t;
        worst = worst.max(t);
        let a = pair.semi_axes[0].0.max(pair.semi_axes[1].0);
        let long = if a > 100.0 { "a>100" } else if a > 10.0 { "a>10" } else if a > 1.0 { "a>1" } else { "" };
        let left = |[a, b]: [f64; 2]| a.is_nan() || a < 0.0 || b >= std::f64::consts::FRAC_PI_2 || b < 0.0 || a >= std::f64::consts::FRAC_PI_2;
        let key = match &r {
            Ok((y, _)) => {
                let st = system.state(y).unwrap();
                let out = left(st.loaded.angles);
                if s.status == Status::Converged {
                    let p = s.outputs.precession.unwrap() / screw.drive.relative_speed().abs();
                    let q = y[PRECESSION] + pair.nut_speed;
                    if (p - q).abs() <= 1e-6 * q.abs() { agree += 1 } else { differ += 1; println!("differ {number} {p} {q} {:?} {:?} mu {:.3e}", st.loaded.angles, (s.outputs.nut_contact_angle, s.outputs.screw_contact_angle), pair.inertia_ratio()); }
                }
                format!("ok {}", if out { "but left" } else if trace.other { "other sign" } else { "" })
            }
            Err(path::End::Guess(_)) => "guess".into(),
            Err(path::End::First(_)) => "first".into(),
            Err(path::End::Creep(_)) => "creep".into(),
            Err(path::End::Friction(_, angles)) => format!("friction {} ", if left(*angles) { "left" } else { "inside" }),
            Err(path::End::Rate(_, _, angles)) => format!("rate {} {}", if left(*angles) { "left" } else { "inside" }, if left(trace.static_angles) { "static left" } else { "" }),
            Err(path::End::Left(_, how)) => format!("NONE {how}"),
        };
        let key = format!("{} {key} {long}", if s.status == Status::Converged { "CONV" } else { "" });
        if verbose { println!("{number} {key} {:?} {:.3e} f {:.2e} a {a:.2e} steps {} points {} {:.1} ms {:?} {:?} nut speed {:.2e} static {:?} {}", r.as_ref().err(), pair.inertia_ratio(), pair.friction, trace.steps, trace.points, 1e3 * t, s.status, s.reason, pair.nut_speed, trace.static_angles, trace.static_rate); }
        bins.entry(key).or_default().push(number);
    }
    println!("{n} points, {:.1} s, path {path_time:.1} s, worst {:.1} ms; agree {agree}, differ {differ}", begin.elapsed().as_secs_f64(), 1e3 * worst);
    for (key, list) in &bins {
        println!("{key:40} {:6} {:.2} %  {:?}", list.len(), 100.0 * list.len() as f64 / n as f64, &list[..list.len().min(8)]);
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
        (found.is_ok() && y.iter().all(|y| y.abs() < 1e20) && angles.iter().all(|a| (0.0..FRAC_PI_2).contains(a))).then_some(y)
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
        if s.status == Status::Converged { continue }
        let place = work.quadrature(case.order);
        let system = Rolling { pair: &pair, quadrature: &work.quadratures[place].1, creep: case.creep * pair.slip_scale() };
        let mut trace = path::Trace::default();
        let r = system.followed(&mut work.newton, &mut trace);
        let key = match &r {
            Ok(_) => "known".to_owned(),
            Err(path::End::Left(_, how)) => format!("none {how}"),
            Err(_) => "undecided".to_owned(),
        };
        let found = search(&system, starts, &mut rng, &mut work.newton);
        let bin = bins.entry(key.clone()).or_default();
        bin[0] += 1;
        bin[1] += usize::from(found.is_some());
        if let Some(y) = found {
            if key != "known" {
                println!("{key} {number} mu {:.2e} f {:.2e} a {:.1e} static {:?} {:.2e} {:?} {y:?} rate {:.3e} angles {:?}", pair.inertia_ratio(), pair.friction, pair.semi_axes[0].0, trace.static_angles, trace.static_rate, r.err(), y[PRECESSION] + system.offset(), system.state(&y).unwrap().loaded.angles);
            }
        }
    }
    println!("{bins:#?}");
}

#[test]
fn component() {
    let mut work = TractionWorkspace::default();
    let mut rng = ChaCha8Rng::seed_from_u64(77);
    for number in [env("ONE", 383)] {
        let screw = draw(env("SEED", 8), number);
        let Ok(pair) = screw.pair() else { continue };
        let place = work.quadrature(Traction::ORDER);
        let system = Rolling { pair: &pair, quadrature: &work.quadratures[place].1, creep: Traction::CREEP * pair.slip_scale() };
        let found = search(&system, 2000, &mut rng, &mut work.newton).expect("found");
        println!("pair mu {:.3e} f {:.3e} nut {:.3e} alpha {:.2} beta {:.2} root {found:?} {:?}", pair.inertia_ratio(), pair.friction, pair.nut_speed, pair.helix.lead_angle.to_degrees(), pair.jones.contact_angle.to_degrees(), system.angles(&found));
        for sign in [1.0, -1.0] {
            println!("direction {sign}");
            system.show(&found, sign);
        }
        println!("from static");
        let mut trace = path::Trace::default();
        println!("{:?} {} {:?}", system.followed(&mut work.newton, &mut trace), trace.static_rate, trace.static_angles);
    }
}
