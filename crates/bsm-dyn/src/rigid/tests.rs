//! Denials against searches from many starts, and points that once had no answer.

use std::f64::consts::PI;

use bsm_kin::{BallFrame, Motion};
use bsm_newton::{Options, Scales, Workspace, solve};
use nalgebra::{Matrix4, Vector3, Vector4};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;

/// Directions of slip that are tried at one point, and Newton solves among them.
const DIRECTIONS: usize = 20_000;
const STARTS: usize = 200;

/// Denials that are put to the test.
const DENIED: usize = 100;

/// A screw of the ranges of the extremes.
fn extreme(rng: &mut impl Rng) -> Rigid {
    let mut log = |low: f64, high: f64| (low.ln() + rng.random::<f64>() * (high / low).ln()).exp();
    let (ball, size) = (log(0.05e-3, 0.1), log(0.01, 0.45));
    let (axial, speed, other) = (log(1e-6, 1e6), log(1e-4, 1e5), log(1e-4, 1e5));
    let (friction, density) = (log(1e-6, 1.0), log(500.0, 2e4));
    let mut flip = |x: f64| if rng.random_bool(0.5) { x } else { -x };
    let (speed, other) = (flip(speed), flip(other));
    let (screw_speed, nut_speed) = match rng.random_range(0..5) {
        0 | 1 => (speed, 0.0),
        2 | 3 => (0.0, speed),
        _ => (speed, other),
    };
    Rigid {
        helix: Helix {
            radius: ball / size,
            lead_angle: rng.random_range(0.05_f64..85.0).to_radians(),
        },
        contact_angle: rng.random_range(1.0_f64..89.0).to_radians(),
        ball: Ball::of_density(ball, density),
        friction,
        drive: Drive { screw_speed, nut_speed },
        load: Load { axial, balls: 1.0 },
    }
}

/// A start from random directions of slip at A, A' and B: the loads and the rate follow from the force
/// balance, the slip at A from the direction at B, the spin from the moment about t. `None` if a load
/// would pull.
fn start(case: &Scaled<f64>, rng: &mut impl Rng) -> Option<(Unknowns<f64>, bool)> {
    let angles: [f64; 3] = std::array::from_fn(|_| rng.random_range(-PI..PI));
    let friction = case.friction * case.sign;
    let slips: [_; 3] = std::array::from_fn(|i| {
        case.contacts[i].across * angles[i].cos() + BallFrame::tangent() * angles[i].sin()
    });
    let forces: [_; 3] = std::array::from_fn(|i| case.contacts[i].normal - slips[i] * friction);
    let mut balance = Matrix4::zeros();
    for (i, force) in forces.iter().enumerate() {
        balance.fixed_view_mut::<3, 1>(0, i).copy_from(force);
        balance[(3, i)] = if i < 2 { force.dot(&case.frame.k) } else { 0.0 };
    }
    balance.fixed_view_mut::<3, 1>(0, 3).copy_from(&-case.frame.n);
    let loads = balance.lu().solve(&Vector4::new(0.0, 0.0, 0.0, 1.0))?;
    if loads.iter().any(|load| *load <= 0.0) {
        return None;
    }
    let side = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
    let rate = side * (loads[3] / case.inertia_ratio()).sqrt();
    let p = rate - case.nut_speed * case.sign;
    let points = case.contacts.map(|c| c.point(1.0));
    let at_screw = |slip: f64| {
        let tau = slip * angles[0].sin() - p * case.arc;
        let motion =
            Motion { precession: p, omega: Vector3::new(-slip * angles[0].cos(), 0.0, tau) };
        motion.relative_to(1.0, &case.frame).slip_velocity(case.arc, &points[2])
    };
    let (none, one) = (at_screw(0.0), at_screw(1.0) - at_screw(0.0));
    let normal = case.contacts[2].normal;
    let slip = -none.cross(&slips[2]).dot(&normal) / one.cross(&slips[2]).dot(&normal);
    let moment: f64 = (0..3).map(|i| points[i].cross(&(slips[i] * -friction * loads[i])).x).sum();
    let tau = slip * angles[0].sin() - p * case.arc;
    let gyroscopic = case.ball.inertia() * rate * tau * case.frame.k.y;
    let spin = (gyroscopic - moment) / case.frame.k.z;
    let from_ground = rate.abs() < p.abs();
    let counted = if from_ground { rate } else { p };
    let y = [loads[0], loads[1], loads[2], counted, slip.abs(), angles[0], spin];
    Some((Unknowns::from(y), from_ground))
}

/// An admissible root from random starts, if one is found.
fn many_starts(
    (rigid, case): (&Rigid, &Scaled<f64>),
    rng: &mut impl Rng,
    newton: &mut Workspace,
) -> Option<Unknowns<f64>> {
    let mut started = 0;
    for _ in 0..DIRECTIONS {
        let Some((mut y, from_ground)) = start(case, rng) else { continue };
        let case = case.counted(from_ground);
        started += 1;
        for _ in 0..3 {
            // The weights follow the root.
            let weights = case.own_weights(&y);
            let scales = Scales { x: &[1.0; BALL], f: &weights };
            let options = Options { max_steps: 30, ..Options::default() };
            let report = solve(&case, y.as_mut_slice(), &scales, &options, newton).ok()?;
            let pushes = [NUT_LOAD, MINOR_LOAD, SCREW_LOAD, SLIP].into_iter().all(|i| y[i] > 0.0);
            if report.converged() && report.steps.is_empty() && pushes {
                // The root at infinity does not balance the powers.
                let root = Root { unknowns: y, from_ground, steps: 0, residual: report.residual };
                let imbalance = rigid.outputs(&case, &root).power_balance;
                return imbalance.is_some_and(|x| x.abs() < 1e-6).then_some(y);
            }
        }
        if started == STARTS {
            break;
        }
    }
    None
}

/// Where a root is denied, searches from many starts find none; where one is found, they mostly find
/// it too.
#[test]
fn many_starts_find_no_root_where_one_is_denied() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let (mut work, mut newton) = (RigidWorkspace::default(), Workspace::new(BALL));
    let (mut denied, mut found, mut seen) = (0, 0, 0);
    let mut refuted = Vec::new();
    while denied < DENIED {
        let rigid = extreme(&mut rng);
        let Ok(case) = rigid.scaled() else { continue };
        let answer = root::find(&case, &mut work);
        // Without inertia the first order is a proof.
        if case.inertia_ratio() < 1e-3 * case.friction {
            continue;
        }
        match answer {
            Err(NoRoot { status: Status::NoSolution, reason }) => {
                denied += 1;
                if let Some(y) = many_starts((&rigid, &case), &mut rng, &mut newton) {
                    refuted.push((rigid, reason, y));
                }
            }
            Ok(_) if found < denied => {
                found += 1;
                seen += usize::from(many_starts((&rigid, &case), &mut rng, &mut newton).is_some());
            }
            _ => {}
        }
    }
    println!("{denied} denied, {} refuted, {seen} of {found} seen", refuted.len());
    assert!(refuted.is_empty(), "{refuted:#?}");
    assert!(seen * 10 > found * 7, "{seen} of {found}");
}
