//! Denials against searches from many starts, and both sets of unknowns; points that were hard are scenes in
//! `validation/hard`.

use std::f64::consts::FRAC_PI_2;

use approx::assert_relative_eq;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;
use crate::Status;
use crate::extreme::extreme;

/// The point of a seed and a number.
fn point(seed: u64, number: u64) -> ElasticScrew {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(number);
    extreme(&mut rng)
}

fn solved(screw: ElasticScrew, work: &mut TractionWorkspace) -> Solution {
    Traction { screw, accuracy: Traction::ACCURACY, creep: Traction::CREEP }.solve(work)
}

/// A random state, of a ball that rolls more or less or hardly circles.
fn state(ball: &Rolling<'_>, rng: &mut impl Rng) -> [f64; BALL] {
    let pair = ball.pair;
    let (unloaded, mu) = (pair.jones.contact_angle, pair.inertia_ratio());
    let mut part = |low: f64, high: f64| low + rng.random::<f64>() * (high - low);
    let [nut, screw] = match part(0.0, 3.0) {
        ..1.0 => [part(0.0, FRAC_PI_2), part(0.0, FRAC_PI_2)],
        1.0..2.0 => [part(0.0, unloaded), part(unloaded, FRAC_PI_2)],
        _ => {
            let turn = part(-0.2, 0.2) * pair.friction;
            [unloaded - turn, unloaded + turn]
        }
    };
    let cos = pair.helix.lead_angle.cos();
    let slow = if part(0.0, 1.0) < 0.5 { pair.friction / mu } else { mu.recip().sqrt() };
    let rate = if part(0.0, 1.0) < 0.5 {
        pair.nut_speed + part(-0.5, 1.5) * pair.sign()
    } else {
        (slow * part(-8.0, 1.0).exp()).min(1.0) * part(-1.0, 1.0).signum()
    };
    let mut y = [0.0; BALL];
    y[NUT_LOAD] = part(-1.0, 1.0).exp() / (nut.sin().max(1e-6) * cos);
    y[SCREW_LOAD] = part(-1.0, 1.0).exp() / (screw.sin().max(1e-6) * cos);
    y[TILT] = 0.5 * (screw - nut);
    y[PRECESSION] = rate - ball.offset();
    y[OMEGA[0]] = (pair.nut_speed - rate) * pair.arc * part(0.0, 1.5);
    y[OMEGA[1]] = pair.arc * part(-3.0, 3.0);
    y[OMEGA[2]] = part(-0.6, 0.6);
    y
}

/// A root on the flanks from random states, if one is found.
fn search(ball: &Rolling<'_>, starts: usize, rng: &mut impl Rng) -> Option<Root> {
    let mut newton = Workspace::default();
    let end = ball.creep.ln();
    (0..starts).find_map(|_| {
        let mut y = state(ball, rng);
        let begin = end + rng.random::<f64>() * (ball.lever(&y).ln() - end).max(0.0);
        let stride = crate::continuation::Stride { first: 1.5, shortest: 0.05 };
        let arrived = crate::continuation::follow(&mut y, (begin, end), stride, |log, y| {
            Rolling { creep: log.exp(), ..*ball }.run(y, &mut newton).converged()
        });
        let root = ball.thrown(y, 0.0, &mut newton, &mut 0);
        (arrived.is_ok() && ball.is_admissible(&root) && ball.is_balanced(&root)).then_some(root)
    })
}

/// Counts of points and, among them, those where the search found a root.
#[derive(Debug, Default)]
struct Confirmed {
    denied: [usize; 2],
    undecided: [usize; 2],
    /// The first hundred roots.
    found: [usize; 2],
    /// Further ones that no start of Newton led to.
    hard: [usize; 2],
}

fn confirmed(seed: u64, points: u64, starts: usize) -> Confirmed {
    let mut work = TractionWorkspace::default();
    let mut rng = ChaCha8Rng::seed_from_u64(seed + 1);
    let mut counts = Confirmed::default();
    for number in 0..points {
        let screw = point(seed, number);
        let Ok(pair) = screw.scaled() else { continue };
        let solution = solved(screw, &mut work);
        let place = work.rules(SEARCH);
        let creep = Traction::CREEP * pair.slip_scale();
        let quadrature = &work.rules[place].rule;
        let ball = Rolling::of_pair(&pair, quadrature, creep);
        let steps = solution.solved().and_then(|solved| Some(solved.info?.steps));
        let count = match solution.status() {
            Status::NoSolution => &mut counts.denied,
            Status::NotConverged => &mut counts.undecided,
            Status::Converged if counts.found[0] < 100 => &mut counts.found,
            Status::Converged if steps > Some(150) => &mut counts.hard,
            _ => continue,
        };
        count[0] += 1;
        if solution.status() == Status::NotConverged {
            println!("undecided: {number} {:?}", solution.reason());
        }
        if let Some(root) = search(&ball, starts, &mut rng) {
            count[1] += 1;
            if solution.status() == Status::NoSolution {
                println!("refuted: {number} {screw:?} {root:?}");
            }
        }
    }
    println!("seed {seed}, {points} points, {starts} starts: {counts:?}");
    counts
}

/// Where a root is denied, searches from many starts find none; where there is one they mostly find
/// it.
#[test]
fn many_starts_find_no_root_where_one_is_denied() {
    let Confirmed { denied, found, .. } = confirmed(12, 250, 40);
    assert_eq!(denied[1], 0, "{denied:?}");
    assert!(denied[0] > 30 && found[1] * 2 > found[0], "{denied:?} {found:?}");
}

/// The same at length: `cargo test --release -p bsm-dyn --lib denied_at_length -- --ignored --nocapture`.
#[test]
#[ignore = "minutes"]
fn many_starts_find_no_root_where_one_is_denied_at_length() {
    let Confirmed { denied, .. } = confirmed(2031, 3000, 300);
    assert!(denied[1] == 0 && denied[0] > 500, "{denied:?}");
}

/// Identity: the unknowns of a ball that is thrown against the nut are other names for the same root.
#[test]
fn both_sets_of_unknowns_have_the_same_roots() {
    let (mut work, mut newton) = (TractionWorkspace::default(), Workspace::default());
    let mut seen = 0;
    for number in 0..60 {
        let screw = point(8, number);
        let solution = solved(screw, &mut work);
        let Ok(pair) = screw.scaled() else { continue };
        // More inertia eats the digits of one set, none those of the other.
        let inertia = pair.inertia_ratio();
        if solution.status() != Status::Converged || !(1e-6..1e2).contains(&inertia) {
            continue;
        }
        let grip = Grip::of(&pair, None, &mut work.statics);
        let start = Start::new(&pair, grip.ok().as_ref()).unwrap();
        let case = Traction { screw, accuracy: Traction::ACCURACY, creep: Traction::CREEP };
        let Found { root, ball: found, .. } = case.found(&start, None, &mut work).unwrap();
        let place = work.rules(Traction::ACCURACY);
        let creep = Traction::CREEP * pair.slip_scale();
        let ball = Rolling::of_pair(&pair, &work.rules[place].rule, creep);
        let state = ball.state(&root.unknowns).unwrap();
        let thrown = Rolling { at_nut: true, ..ball };
        let mut y = thrown.unknowns(&state.loaded, &state.to_nut);
        assert!(thrown.run(&mut y, &mut newton).converged(), "{number}");
        let angles = thrown.angles(&y);
        // Roots are known to 1e-10 of the forces, contact angles of 1 deg to a hundredth of that.
        assert_relative_eq!(angles[0], found.nut.angle, max_relative = 1e-8);
        assert_relative_eq!(angles[1], found.screw.angle, max_relative = 1e-8);
        assert_relative_eq!(y[NUT_LOAD], root.unknowns[NUT_LOAD], max_relative = 1e-8);
        seen += 1;
    }
    assert!(seen > 10, "{seen}");
}
