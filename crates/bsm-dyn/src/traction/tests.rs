//! Denials against searches from many starts, and points that were hard.

use std::f64::consts::{FRAC_PI_2, PI};

use approx::assert_relative_eq;
use bsm_kin::{Drive, Helix};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;
use crate::extreme::extreme;
use crate::{Ball, Load, Material, Reason, Status};

/// The point of a seed and a number.
fn point(seed: u64, number: u64) -> ElasticScrew {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(number);
    extreme(&mut rng)
}

fn solved(screw: ElasticScrew, work: &mut TractionWorkspace) -> Solution {
    Traction { screw, order: Traction::ORDER, creep: Traction::CREEP }.solve(work)
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
        let place = work.quadrature(Traction::ORDER);
        let creep = Traction::CREEP * pair.slip_scale();
        let quadrature = &work.quadratures[place].1;
        let ball = Rolling { pair: &pair, quadrature, creep, at_nut: false };
        let steps = solution.solved().and_then(|solved| Some(solved.info?.steps));
        let count = match solution.status() {
            Status::NoSolution => &mut counts.denied,
            Status::NotConverged => &mut counts.undecided,
            Status::Converged if counts.found[0] < 100 => &mut counts.found,
            Status::Converged if steps > Some(150) => &mut counts.hard,
            _ => continue,
        };
        count[0] += 1;
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

/// Found by the campaign of the extremes: points without an answer, or with a power balance that
/// rounding had eaten.
#[test]
fn hard_points_are_solved() {
    let mut work = TractionWorkspace::default();
    for (seed, number, what) in [
        (8, 22, "an ellipse longer than the ball"),
        (8, 278, "an ellipse a hundred times longer than the ball"),
        (8, 63, "a rate near zero beside a turning nut"),
        (8, 318, "inertia forces thousands of times the load"),
        (8, 137, "a ball that turns about the axis of the screw"),
        (8, 175, "no guess of the gripping ball"),
        (3, 222, "a ball that goes round with the nut at 2e8 loads, angle without digits"),
        (3, 867, "a ball that goes round with the nut, path lost"),
        (3, 2200, "a ball that goes round with the nut at 5e9 loads, path lost"),
        (2031, 2483, "two roots within a step of the path, balls that hardly circle"),
        (2031, 1922, "the same at an inertia ratio of 5e11"),
    ] {
        let solution = solved(point(seed, number), &mut work);
        let place = format!("{seed} {number}, {what}: {:?}", solution.reason());
        assert_eq!(solution.status(), Status::Converged, "{place}");
    }
}

/// Denied once, between speeds at which they were solved: strong friction, balls that hardly circle.
#[test]
fn strong_friction_has_roots_that_only_starts_lead_to() {
    let material = Material { youngs_modulus: 206e9, poisson_ratio: 0.3 };
    let screw =
        |[ball, pitch, lead, contact]: [f64; 4], conformity, friction, load, rpm: [f64; 2]| {
            let [screw_speed, nut_speed] = rpm.map(|rpm| rpm * PI / 30.0);
            ElasticScrew {
                helix: Helix { radius: 0.5e-3 * pitch, lead_angle: lead.to_radians() },
                contact_angle: contact.to_radians(),
                ball: Ball::of_density(0.5e-3 * ball, 7800.0),
                conformity,
                material: (material, material),
                friction,
                drive: Drive { screw_speed, nut_speed },
                load: Load { axial: load, balls: 1.0 },
            }
        };
    let mut work = TractionWorkspace::default();
    for screw in [
        screw(
            [41.480_347_672_9, 99.790_490_489_8, 76.528_496_368, 14.279_940_078_7],
            (0.799_177_170_97, 0.776_885_308_19),
            0.365_451_064_10,
            0.005_236_698_200_8,
            [-81.563_097_984_6, 57.094_168_589_2],
        ),
        screw(
            [11.365_161_020_2, 59.258_571_664_7, 21.207_023_132_4, 5.563_086_325_5],
            (0.502_446_362_02, 0.508_335_509_33),
            0.297_702_054_26,
            1.111_893_871_1,
            [0.0, 50_493.148_990_886],
        ),
    ] {
        assert_eq!(solved(screw, &mut work).status(), Status::Converged, "{screw:?}");
    }
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
        let case = Traction { screw, order: Traction::ORDER, creep: Traction::CREEP };
        let Found { root, ball: found, .. } = case.found(&start, None, &mut work).unwrap();
        let place = work.quadrature(Traction::ORDER);
        let creep = Traction::CREEP * pair.slip_scale();
        let ball =
            Rolling { pair: &pair, quadrature: &work.quadratures[place].1, creep, at_nut: false };
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

/// A ball that goes round with the nut and is pressed so deep into it that the screw touches beyond
/// 90 deg; two of the contact angles differ from 0 by rounding only.
#[test]
fn a_ball_pressed_through_its_groove_has_no_root() {
    let mut work = TractionWorkspace::default();
    for number in [1255, 2595] {
        let solution = solved(point(3, number), &mut work);
        let Some(Reason::BallLeavesFlank { screw, .. }) = solution.reason() else {
            panic!("{number}: {solution:?}")
        };
        assert!(solution.status() == Status::NoSolution && *screw > FRAC_PI_2, "{number}: {screw}");
    }
}

/// Next to no inertia: friction of steep spin turns a contact angle beyond 90 deg.
#[test]
fn friction_turns_a_ball_off_its_flanks() {
    let mut work = TractionWorkspace::default();
    let solution = solved(point(8, 53), &mut work);
    assert_eq!(solution.status(), Status::NoSolution, "{solution:?}");
    let Some(Reason::BallLeavesFlank { screw, .. }) = solution.reason() else { panic!() };
    assert!(*screw > FRAC_PI_2, "{screw}");
}
