//! Tests of the traction model: the status `no_solution` is compared with searches from many
//! starting points, and both sets of unknowns, error bounds and derivatives are checked. Difficult
//! operating points are stored in `validation/hard`.

use std::f64::consts::FRAC_PI_2;

use approx::assert_relative_eq;
use bsm_kin::Jet;
use bsm_sample::campaign;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::equations::{Evaluation, OMEGA};
use super::*;
use crate::contact::{Wrench, torque};
use crate::extreme::{random_extreme_screw, random_practical_screw};
use crate::models::ball::unknown::{PRECESSION, TILT};
use crate::models::ball::{BALL_UNKNOWNS, to_both, variables};
use crate::{Coulomb, Status, hertz::Quadrature};

/// Returns the random extreme operating point with a given number in the sequence of a given seed.
fn random_extreme_point(seed: u64, number: u64) -> ElasticPoint {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(number);
    random_extreme_screw(&mut rng)
}

fn solved(screw: ElasticPoint, work: &mut TractionWorkspace) -> Solution {
    Traction { screw, accuracy: Traction::ACCURACY, creep: Traction::CREEP }.solve(work)
}

/// Returns random unknowns of a ball that approximately rolls or orbits very slowly.
fn random_state(ball: &SlipBall<'_>, rng: &mut impl Rng) -> [f64; BALL_UNKNOWNS] {
    let contacts = ball.contacts;
    let (unloaded, mu) = (contacts.contact_angle, contacts.inertia_ratio());
    let mut part = |low: f64, high: f64| low + rng.random::<f64>() * (high - low);
    let [nut, screw] = match part(0.0, 3.0) {
        ..1.0 => [part(0.0, FRAC_PI_2), part(0.0, FRAC_PI_2)],
        1.0..2.0 => [part(0.0, unloaded), part(unloaded, FRAC_PI_2)],
        _ => {
            let spread = part(-0.2, 0.2) * contacts.friction;
            [unloaded - spread, unloaded + spread]
        }
    };
    let cos = contacts.helix.lead_angle.cos();
    let slow = if part(0.0, 1.0) < 0.5 { contacts.friction / mu } else { mu.recip().sqrt() };
    let rate = if part(0.0, 1.0) < 0.5 {
        contacts.scaled.nut_speed + part(-0.5, 1.5)
    } else {
        (slow * part(-8.0, 1.0).exp()).min(1.0) * part(-1.0, 1.0).signum()
    };
    let mut y = [0.0; BALL_UNKNOWNS];
    y[NUT_LOAD] = part(-1.0, 1.0).exp() / (nut.sin().max(1e-6) * cos);
    y[SCREW_LOAD] = part(-1.0, 1.0).exp() / (screw.sin().max(1e-6) * cos);
    y[TILT] = 0.5 * (screw - nut);
    y[PRECESSION] = rate - ball.offset();
    y[OMEGA[0]] = (contacts.scaled.nut_speed - rate) * contacts.scaled.arc * part(0.0, 1.5);
    y[OMEGA[1]] = contacts.scaled.arc * part(-3.0, 3.0);
    y[OMEGA[2]] = part(-0.6, 0.6);
    y
}

/// Searches from random starting points for a root with both contacts on their flanks, and returns
/// the root or `None`.
fn root_from_random_starts(
    ball: &SlipBall<'_>,
    starts: usize,
    rng: &mut impl Rng,
) -> Option<SlipRoot> {
    let mut newton = Workspace::default();
    let end = ball.creep.ln();
    (0..starts).find_map(|_| {
        let mut y = random_state(ball, rng);
        let begin = end + rng.random::<f64>() * (ball.lever(&y).ln() - end).max(0.0);
        let control = bsm_newton::Continuation { first_step: 1.5, min_step: 0.05 };
        let arrived = bsm_newton::follow(&mut y, (begin, end), control, |log, y| {
            SlipBall { creep: log.exp(), ..*ball }.run(y, &mut newton).converged()
        });
        let root = ball.with_nut_angle(y, 0.0, &mut newton, &mut 0);
        (arrived.is_ok() && ball.is_admissible(&root) && ball.is_balanced(&root)).then_some(root)
    })
}

/// Numbers of operating points. In each array, the first number counts all points of a kind, and
/// the second number counts the points at which the random search found a root.
#[derive(Debug, Default)]
struct SearchCounts {
    no_solution: [usize; 2],
    undecided: [usize; 2],
    /// Numbers of points among the first hundred operating points that have a solution.
    found: [usize; 2],
    /// Counts for further points that have a solution. At these points, Newton's method found no
    /// solution from its first starting values.
    hard: [usize; 2],
}

fn search_counts(seed: u64, points: usize, starts: usize) -> SearchCounts {
    let mut work = TractionWorkspace::default();
    let mut rng = ChaCha8Rng::seed_from_u64(seed + 1);
    let mut counts = SearchCounts::default();
    for number in 0..points as u64 {
        let screw = random_extreme_point(seed, number);
        let Ok(contacts) = screw.scaled() else { continue };
        let solution = solved(screw, &mut work);
        let creep = Traction::CREEP * contacts.slip_scale();
        let [RulePair { rule: quadrature, .. }] = work.rules.dry([SEARCH_ACCURACY]);
        let ball = SlipBall::of_contacts(&contacts, quadrature, creep);
        let steps = solution.steady_state().and_then(|solved| Some(solved.info?.steps));
        let count = match solution.status() {
            Status::NoSolution => &mut counts.no_solution,
            Status::NotConverged => &mut counts.undecided,
            Status::Converged if counts.found[0] < 100 => &mut counts.found,
            Status::Converged if steps > Some(150) => &mut counts.hard,
            _ => continue,
        };
        count[0] += 1;
        if solution.status() == Status::NotConverged {
            println!("undecided: {number} {:?}", solution.reason());
        }
        if let Some(root) = root_from_random_starts(&ball, starts, &mut rng) {
            count[1] += 1;
            if solution.status() == Status::NoSolution {
                println!("refuted: {number} {screw:?} {root:?}");
            }
        }
    }
    println!("seed {seed}, {points} points, {starts} starts: {counts:?}");
    counts
}

/// A search from many starting points rarely finds a root at points with the status `no_solution`,
/// and usually finds a root at points with a solution. The model does not search isolated branches.
/// On the branch that starts without inertia, 737 extreme points have no solution, but three of
/// these points have a root on another branch.
#[test]
fn random_starts_rarely_find_a_root_at_points_reported_as_unsolvable() {
    let points = campaign(250);
    let SearchCounts { no_solution, found, .. } = search_counts(12, points, 40);
    assert!(no_solution[1] * 50 <= no_solution[0], "{no_solution:?}");
    assert!(
        no_solution[0] * 25 > 3 * points && found[1] * 2 > found[0],
        "{no_solution:?} {found:?}"
    );
}

/// Repeats the test of `no_solution` with more points. Command: `cargo test --release -p bsm-dyn
/// --lib random_starts_rarely_find_a_root_at_many_points -- --ignored --nocapture`.
#[test]
#[ignore = "takes minutes: 3000 points with 300 starting values each"]
fn random_starts_rarely_find_a_root_at_many_points_reported_as_unsolvable() {
    let SearchCounts { no_solution, .. } = search_counts(2031, 3000, 300);
    assert!(no_solution[1] * 50 <= no_solution[0], "{no_solution:?}");
    assert!(no_solution[0] > 500, "{no_solution:?}");
}

/// A root in the unknowns (T1) is also a root in the unknowns for high centrifugal loads (T10).
#[test]
fn equations_have_the_same_roots_in_both_sets_of_unknowns() {
    let (mut work, mut newton) = (TractionWorkspace::default(), Workspace::default());
    let mut seen = 0;
    for number in 0..60 {
        let screw = random_extreme_point(8, number);
        let solution = solved(screw, &mut work);
        let Ok(contacts) = screw.scaled() else { continue };
        // Large inertia causes cancellation in the unknowns (T1), and zero inertia causes
        // cancellation in (T10).
        let inertia = contacts.inertia_ratio();
        if solution.status() != Status::Converged || !(1e-6..1e2).contains(&inertia) {
            continue;
        }
        let rolling_ball = RollingBall::of(&contacts, None, &mut work.statics);
        let start = RollingStart::new(&contacts, rolling_ball.ok().as_ref()).unwrap();
        let case = Traction { screw, accuracy: Traction::ACCURACY, creep: Traction::CREEP };
        let FoundRoot { root, solved, .. } = case.find(&start, None, &mut work).unwrap();
        let creep = Traction::CREEP * contacts.slip_scale();
        let [RulePair { rule: quadrature, .. }] = work.rules.dry([Traction::ACCURACY]);
        let ball = SlipBall::of_contacts(&contacts, quadrature, creep);
        let loaded = ball.loaded(&root.unknowns).unwrap();
        let converted = SlipBall { uses_nut_angle: true, ..ball };
        let mut y = converted.unknowns(&loaded, &ball.motion_to_nut(&root.unknowns, &loaded));
        assert!(converted.run(&mut y, &mut newton).converged(), "{number}");
        let angles = converted.angles(&y);
        // Residuals of at most 1e-10 times the forces determine contact angles of 1° to a relative
        // accuracy of 1e-8.
        assert_relative_eq!(angles[0], solved.ball.nut.angle, max_relative = 1e-8);
        assert_relative_eq!(angles[1], solved.ball.screw.angle, max_relative = 1e-8);
        assert_relative_eq!(y[NUT_LOAD], root.unknowns[NUT_LOAD], max_relative = 1e-8);
        seen += 1;
    }
    assert!(seen > 10, "{seen}");
}

/// Accuracies for which the error bound is compared with the true error. The true error is the
/// difference from a quadrature with an accuracy of 1e-12.
const ACCURACIES: [f64; 3] = [1e-4, 1e-6, 1e-8];

/// Returns the number of practical points with a solution. For each accuracy, also returns the
/// number of points whose error exceeds the error bound, and the largest error of the efficiency.
fn count_violated_error_bounds(seed: u64, points: usize) -> (usize, [usize; 3], [f64; 3]) {
    let (mut work, mut rng) = (TractionWorkspace::default(), ChaCha8Rng::seed_from_u64(seed));
    let (mut answered, mut broken, mut largest) = (0, [0; 3], [0.0_f64; 3]);
    for _ in 0..points {
        let screw = random_practical_screw(&mut rng);
        let mut solved = |accuracy| {
            let case = Traction { screw, accuracy, creep: Traction::CREEP };
            case.solve(&mut work).result.ok()
        };
        let Some(exact) = solved(1e-12) else { continue };
        answered += 1;
        for (i, accuracy) in ACCURACIES.into_iter().enumerate() {
            let found = solved(accuracy).expect("a root of the finer rule");
            let error = (found.transmission.efficiency - exact.transmission.efficiency).abs();
            broken[i] += usize::from(error > found.error.expect("a bound").efficiency);
            largest[i] = largest[i].max(error);
        }
    }
    println!("{answered} points: bound exceeded at {broken:?} points, errors up to {largest:?}");
    (answered, broken, largest)
}

/// The error bound exceeds the quadrature error at nearly all points, and the error at the default
/// accuracy is below 1e-7.
#[test]
fn reported_error_bound_exceeds_the_quadrature_error() {
    let (points, broken, largest) = count_violated_error_bounds(1994, 1000);
    assert!(points > 900);
    // At the coarsest accuracy, a quadrature with eight nodes is compared with a quadrature with
    // six nodes. In rare cases, the two have similar errors, and the error bound is too small.
    assert!(broken[0] * 100 <= points && broken[1] * 200 <= points && broken[2] * 1000 <= points);
    assert!(largest[2] <= 1e-7, "{largest:?}");
}

/// Repeats the test of the error bound with more points. Command: `cargo test --release -p bsm-dyn
/// --lib quadrature_error_at_many_points -- --ignored --nocapture`.
#[test]
#[ignore = "takes minutes: 100 000 points"]
fn reported_error_bound_exceeds_the_quadrature_error_at_many_points() {
    let (points, broken, largest) = count_violated_error_bounds(2026, 100_000);
    assert!(points > 90_000);
    assert!(broken[2] * 1000 <= points, "{broken:?}");
    assert!(largest[2] <= 1e-7, "{largest:?}");
}

/// Compares the equations in contact coordinates with a calculation of forces and moments as
/// vectors in the ball triad, for both sets of unknowns.
#[test]
fn first_motion_on_the_branch_is_the_reported_motion() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let mut work = TractionWorkspace::default();
    let mut compared = 0;
    for _ in 0..60 {
        let at = random_practical_screw(&mut rng);
        let traction = Traction { screw: at, accuracy: Traction::ACCURACY, creep: Traction::CREEP };
        let Ok(reported) = traction.solve(&mut work).result else { continue };
        let branch = traction.branch(&mut work).expect("a complete branch");
        let [found, expected] = [branch[0], reported].map(|state| state.transmission.efficiency);
        // The two solutions are refined with the same quadrature to a residual of 1e-10.
        assert_relative_eq!(found, expected, epsilon = 1e-9);
        compared += 1;
    }
    assert!(compared > 50, "{compared}");
}

#[test]
fn equations_agree_with_force_and_moment_vectors() {
    let (mut work, mut rng) = (TractionWorkspace::default(), ChaCha8Rng::seed_from_u64(5));
    let [RulePair { rule: quadrature, .. }] = work.rules.dry([COARSE_ACCURACY]);
    let mut seen = [0; 2];
    for number in 0..400 {
        let screw = if number % 4 == 0 {
            random_extreme_screw(&mut rng)
        } else {
            random_practical_screw(&mut rng)
        };
        let Ok(contacts) = screw.scaled() else { continue };
        let creep = Traction::CREEP * contacts.slip_scale();
        let uses_nut_angle = number % 2 == 1;
        let ball =
            SlipBall { uses_nut_angle, ..SlipBall::of_contacts(&contacts, quadrature, creep) };
        let mut y = random_state(&ball, &mut rng);
        if uses_nut_angle {
            y[TILT] = rng.random_range(0.1..1.0);
            y[PRECESSION] = rng.random_range(-1.0..1.0);
        }
        let Ok(loaded) = ball.loaded(&y) else {
            assert!(ball.residual(&y).is_err(), "{number}");
            continue;
        };
        let found: Evaluation<Jet<BALL_UNKNOWNS>> = ball.evaluated(&variables(&y)).unwrap();
        let to_nut = ball.motion_to_nut(&y, &loaded);
        let law = Coulomb(contacts.directed_friction());
        let (mut wrench, mut power) = ([Wrench::zero(); 2], 0.0);
        for (i, motion) in to_both(&to_nut, &loaded.frame).iter().enumerate() {
            let ellipse = contacts.ellipse(i, &loaded);
            let (friction, lost) =
                ellipse.friction(motion, contacts.scaled.arc, &law, creep, quadrature);
            let normal = loaded.contacts[i].normal * loaded.loads[i];
            wrench[i] = Wrench { force: normal + friction.force, moment: friction.moment };
            power += lost;
        }
        let motion = contacts.absolute(&to_nut, &loaded.frame);
        let expected = contacts.balance(&loaded, &motion, &wrench);
        let rate = y[PRECESSION] + ball.offset();
        // In scaled units, the rounding error is proportional to the largest of four quantities:
        // the normal force, the inertia force, the friction moment and the gyroscopic moment.
        let turning = y[4..].iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        // The precession rate relative to the nut is the difference between the absolute precession
        // rate and the nut speed, so its rounding error depends on the magnitudes of the absolute
        // precession rate and of the nut speed.
        let rates = rate.abs() + contacts.scaled.nut_speed.abs();
        let centrifugal = contacts.inertia_ratio() * rate.abs() * rates;
        let gyroscopic = contacts.scaled.ball().inertia() * rates * turning;
        let size =
            (y[NUT_LOAD].max(y[SCREW_LOAD]) * ball.lever(&y)).max(centrifugal).max(gyroscopic);
        // The tolerance allows for rounding errors of the slip and of the angular velocities,
        // divided by the creep speed.
        let slip = 1.0 + (rate.abs() * contacts.scaled.arc).max(turning);
        let rounding = 1e-14 * size * (1.0 + contacts.friction * slip / creep);
        for i in 0..BALL_UNKNOWNS {
            let off = (found.residual[i].re - expected[i]).abs();
            assert!(off <= rounding, "{number} {i} {off:e} {rounding:e} {found:?} {expected:?}");
        }
        let expected = torque(&wrench[1], contacts.helix.radius, &loaded.frame);
        assert!((found.torque.re - expected).abs() <= rounding * contacts.helix.radius, "{number}");
        assert_relative_eq!(found.power_flow().power, power, max_relative = 1e-9);
        seen[usize::from(uses_nut_angle)] += 1;
    }
    assert!(seen.iter().all(|seen| *seen > 60), "{seen:?}");
}

/// Compares the derivatives of the residual with respect to each unknown with central differences.
#[test]
fn jacobian_matches_finite_differences_of_the_residual() {
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    // The quadrature is so accurate that changes of its node counts have little effect. The creep
    // speed is of the order of the slip speeds, so friction is a smooth but nonlinear function of
    // the slip.
    let (quadrature, creep) = (Quadrature::of(1e-12), 0.3);
    let mut seen = 0;
    for number in 0..60 {
        let Ok(contacts) = random_practical_screw(&mut rng).scaled() else { continue };
        let uses_nut_angle = number % 2 == 1;
        let ball =
            SlipBall { uses_nut_angle, ..SlipBall::of_contacts(&contacts, &quadrature, creep) };
        let mut y = random_state(&ball, &mut rng);
        if uses_nut_angle {
            y[TILT] = rng.random_range(0.1..1.0);
            y[PRECESSION] = rng.random_range(-1.0..1.0);
        }
        let Ok(found) = ball.evaluated(&variables(&y)) else { continue };
        for k in 0..BALL_UNKNOWNS {
            let width = 1e-5 * (0.01 + y[k].abs());
            let at = |side: f64| {
                let mut y = y;
                y[k] += side * width;
                let found: Evaluation = ball.evaluated(&y).unwrap();
                (found.residual, found.torque)
            };
            let ((up, torque_up), (down, torque_down)) = (at(1.0), at(-1.0));
            let mut rows: Vec<_> =
                (0..BALL_UNKNOWNS).map(|i| (found.residual[i], up[i] - down[i])).collect();
            rows.push((found.torque, torque_up - torque_down));
            for (row, difference) in rows {
                let largest = row.eps.iter().fold(1.0_f64, |m, x| m.max(x.abs()));
                // The tolerance allows for the truncation error and the rounding error of the
                // central difference (1e-10 each), and for the effect of changing node counts.
                let off = (difference / (2.0 * width) - row.eps[k]).abs();
                assert!(off <= 1e-5 * largest, "{number} {k}: {off:e} {row:?}");
            }
        }
        seen += 1;
    }
    assert!(seen > 30, "{seen}");
}
