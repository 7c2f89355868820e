//! Solves random points in extreme ranges with every model, as a short version of `just extremes`.
//! No model may panic, converged solutions must be consistent, and general identities must hold.

use std::f64::consts::PI;

use approx::assert_relative_eq;
use bsm_dyn::{
    Ball, Conformities, Control, Coulomb, Direction, ElasticPoint, Load, Material, Materials,
    Model, ModelWorkspace, OperatingPoint, Problem, Reason, Solution, Status,
    angles::Angles,
    model::{Auto, Elastic, RacewayControl, Rigid, Traction},
};
use bsm_kin::{Drive, Helix, Site};
use bsm_sample::{Sample, campaign};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::elastic::screws::{lin, with};

/// Number of inputs that the test sets to extreme values, one at a time.
const INPUTS: usize = 12;

/// Returns random screws in extreme ranges of the inputs. Speeds, loads, sizes and elastic moduli
/// vary over orders of magnitude.
fn extreme_screws(seed: u64) -> impl Iterator<Item = ElasticPoint> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    std::iter::from_fn(move || {
        let mut log = |low: f64, high: f64| rng.log_uniform(low, high);
        let (ball, size) = (log(0.05e-3, 0.1), log(0.01, 0.45));
        let (axial, speed, other) = (log(1e-6, 1e6), log(1e-4, 1e5), log(1e-4, 1e5));
        let friction = log(1e-6, 1.0);
        let conformity = Conformities { nut: 0.5 + log(1e-3, 0.3), screw: 0.5 + log(1e-3, 0.3) };
        let mut steel = || Material { youngs_modulus: log(1e7, 1e12), poisson_ratio: 0.3 };
        let material = Materials { raceways: steel(), ball: steel() };
        let mut flip = |x: f64| if rng.random_bool(0.5) { x } else { -x };
        let (speed, other) = (flip(speed), flip(other));
        let (screw_speed, nut_speed) = match rng.random_range(0..3) {
            0 => (speed, 0.0),
            1 => (0.0, speed),
            _ => (speed, other),
        };
        Some(ElasticPoint {
            point: OperatingPoint {
                helix: Helix {
                    radius: ball / size,
                    lead_angle: rng.random_range(0.05_f64..85.0).to_radians(),
                },
                contact_angle: rng.random_range(1.0_f64..89.0).to_radians(),
                ball: Ball::of_density(ball, 7800.0),
                friction: Coulomb(friction),
                drive: Drive { screw_speed, nut_speed },
                load: Load { axial, balls: 1.0 },
            },
            conformity,
            material,
        })
    })
}

fn rigid(screw: &ElasticPoint) -> Problem {
    Problem::Rigid(Rigid { point: screw.point })
}

fn raceway_control(screw: ElasticPoint, control: Option<Control>) -> Problem {
    Problem::RacewayControl(RacewayControl { screw, control })
}

/// Checks that a converged solution is consistent. Returns true if the point has a solution or if
/// there is evidence that no solution exists.
fn is_consistent(screw: &ElasticPoint, solution: &Solution) -> bool {
    let o = match &solution.result {
        Ok(solved) => solved,
        Err(none) => return none.evidence().is_some(),
    };
    let words = format!("{o:?}");
    let mut tokens = words.split(|c: char| !c.is_alphanumeric());
    assert!(!tokens.any(|token| ["NaN", "inf"].contains(&token)), "{screw:?} {words}");
    // The closed form evaluates a formula instead of solving equations, so it has no residual.
    let closed = solution.model == Model::ClosedForm;
    assert!(o.info.map_or(closed, |info| info.residual <= 1e-10), "{screw:?} {words}");
    assert!(o.transmission.power_balance.unwrap_or(0.0).abs() <= 1e-9, "{screw:?} {words}");
    assert!(o.transmission.efficiency <= 1.0, "{screw:?} {words}");
    let contacts = || [Some(o.ball.nut), Some(o.ball.screw), o.ball.unloaded].into_iter().flatten();
    assert!(contacts().all(|c| c.load.is_none_or(|q| q > 0.0)), "{screw:?} {words}");
    assert!(contacts().all(|c| (0.0..=0.5 * PI).contains(&c.angle)), "{screw:?} {words}");
    true
}

/// Solves `count` points and returns the number of points that have neither a solution nor evidence
/// that no solution exists.
fn count_unsolved_points(count: usize, problem: impl Fn(ElasticPoint) -> Problem) -> usize {
    let mut work = ModelWorkspace::default();
    let solve = |screw: ElasticPoint| is_consistent(&screw, &problem(screw).solve(&mut work));
    extreme_screws(1994).take(count).map(solve).filter(|answered| !answered).count()
}

/// For each choice of the controlling raceway, every point has a root or evidence that no root
/// exists.
#[test]
fn raceway_control_solves_every_point_or_excludes_a_solution() {
    for control in [None, Some(Control::Nut), Some(Control::Screw)] {
        assert_eq!(
            count_unsolved_points(4000, |screw| raceway_control(screw, control)),
            0,
            "{control:?}"
        );
    }
}

#[test]
fn rigid_results_at_extreme_points_are_consistent() {
    // About 0.25 % of the points are known to fail, because the continuation fails at extreme
    // inertia or friction.
    assert!(count_unsolved_points(4000, |screw| rigid(&screw)) <= 20);
}

#[test]
fn elastic_solutions_at_extreme_points_are_consistent() {
    // About 0.1 % of the points are known to fail, because friction nearly holds the load.
    assert!(count_unsolved_points(4000, |screw| Problem::Elastic(Elastic { screw })) <= 12);
}

#[test]
fn traction_solutions_at_extreme_points_are_consistent() {
    let traction = |screw| Problem::Traction(Traction { screw, accuracy: 1e-4, creep: 1e-4 });
    let count = campaign(300);
    let unsolved = count_unsolved_points(count, traction);
    // At the points that are known to fail, the inertia forces far exceed load and friction. Either
    // path tracking fails, or a root is inaccurate due to rounding errors.
    assert!(unsolved <= 1 + count / 150, "{unsolved}");
}

/// An earlier elastic model returned no result within 30 s for a contact angle of 1e-307 deg, whose
/// cotangent is infinite. The test sets one input at a time to extreme values, up to the smallest
/// and the largest positive numbers.
#[test]
fn every_model_returns_within_the_time_limit_for_extreme_inputs() {
    const ABSURD: [f64; 8] = [5e-324, 1e-310, 1e-307, 1e-150, 1e-30, 1e30, 1e150, f64::MAX];
    let absurd = move |input: usize, value: f64| {
        let mut screw = lin(10.0, 45.0, 2000.0, 100.0);
        *[
            &mut screw.point.contact_angle,
            &mut screw.point.helix.lead_angle,
            &mut screw.point.helix.radius,
            &mut screw.point.ball.radius,
            &mut screw.point.ball.mass,
            &mut screw.conformity.nut,
            &mut screw.material.raceways.youngs_modulus,
            &mut screw.point.friction.0,
            &mut screw.point.drive.screw_speed,
            &mut screw.point.drive.nut_speed,
            &mut screw.point.load.axial,
            &mut screw.point.load.balls,
        ][input] = value;
        screw
    };
    let problems = move |screw: ElasticPoint| {
        [
            rigid(&screw),
            raceway_control(screw, None),
            Problem::Elastic(Elastic { screw }),
            Problem::Traction(Traction { screw, accuracy: 1e-4, creep: 1e-4 }),
        ]
    };
    for (input, value) in (0..INPUTS).flat_map(|input| ABSURD.map(|value| (input, value))) {
        for (model, problem) in problems(absurd(input, value)).into_iter().enumerate() {
            let (done, answer) = std::sync::mpsc::channel();
            std::thread::spawn(move || {
                // Sending fails if the result comes too late, because the receiver no longer
                // exists.
                let _ = done.send(problem.solve(&mut ModelWorkspace::default()));
            });
            // The slowest solve takes a quarter of a second in a release build and about twenty
            // times as long in a debug build. Other tests run at the same time.
            let answer = answer.recv_timeout(std::time::Duration::from_secs(60));
            let solution = answer.unwrap_or_else(|e| panic!("{input} {value:e} {model}: {e}"));
            let answered = solution.efficiency().is_some_and(f64::is_finite);
            assert_eq!(
                answered,
                solution.status() == Status::Converged,
                "{input} {value:e} {model}"
            );
        }
    }
}

/// The error bound of the model `auto` is finite even if the screw would be self-locking with
/// saturated friction.
#[test]
fn auto_solutions_at_extreme_points_are_consistent() {
    count_unsolved_points(campaign(300), |screw| Problem::Auto(Auto { screw, tolerance: 1e-2 }));
}

/// Results do not depend on the units of length, force and time: inputs with the same dimensionless
/// ratios give the same efficiency.
#[test]
fn results_do_not_depend_on_units() {
    let mut work = ModelWorkspace::default();
    let (mut compared, mut differ) = ([0; 3], [0; 3]);
    for screw in extreme_screws(7).take(1000) {
        // Lengths are multiplied by 4, elastic moduli by 8, and times by 1/2. Multiplication by a
        // power of two is exact.
        let other = with(screw, |ElasticPoint { point, material, .. }| {
            point.helix.radius *= 4.0;
            point.ball.radius *= 4.0;
            point.ball.mass *= 8.0;
            point.drive.screw_speed *= 2.0;
            point.drive.nut_speed *= 2.0;
            point.load.axial *= 128.0;
            material.raceways.youngs_modulus *= 8.0;
            material.ball.youngs_modulus *= 8.0;
        });
        let pairs = [
            (rigid(&screw), rigid(&other)),
            (raceway_control(screw, None), raceway_control(other, None)),
            (Problem::Elastic(Elastic { screw }), Problem::Elastic(Elastic { screw: other })),
        ];
        for (model, (one, two)) in pairs.into_iter().enumerate() {
            let (one, two) = (one.solve(&mut work), two.solve(&mut work));
            differ[model] += usize::from(one.status() != two.status());
            // The efficiencies may differ slightly because the cube roots are rounded differently.
            if let Some((a, b)) = one.efficiency().zip(two.efficiency()) {
                assert_relative_eq!(a, b, max_relative = 1e-6, epsilon = 1e-6);
                compared[model] += 1;
            }
        }
    }
    // The status could differ at points near the limit of a tolerance, but no such point is known.
    assert_eq!(differ, [0; 3]);
    assert!(compared.into_iter().all(|count| count > 500), "{compared:?}");
}

/// Friction does not affect the force balance of a rolling ball, so back-driving has the same loss
/// as driving: `1/η − 1 = 1 − η'`. In the closed form, back-driving is equivalent to driving with
/// the friction coefficient `-f`.
#[test]
fn rolling_balls_have_equal_losses_in_driving_and_back_driving() {
    let mut work = ModelWorkspace::default();
    let mut tried = 0;
    for screw in extreme_screws(3).take(2000) {
        let Drive { screw_speed, nut_speed } = screw.point.drive;
        let drive = Drive { screw_speed: -screw_speed, nut_speed: -nut_speed };
        let [one, other] = [screw, with(screw, |screw| screw.point.drive = drive)]
            .map(|screw| raceway_control(screw, None).solve(&mut work));
        assert_eq!(one.status(), other.status(), "{screw:?}");
        if let Some((one, other)) = one.efficiency().zip(other.efficiency()) {
            let forward = screw.point.drive.relative_speed() > 0.0;
            let (driving, driven) = if forward { (one, other) } else { (other, one) };
            let (lost, loss) = (driving.recip() - 1.0, 1.0 - driven);
            // The absolute tolerance allows for cancellation if the loss is very small.
            assert_relative_eq!(lost, loss, max_relative = 1e-9, epsilon = 1e-12);
            tried += 1;
        }
        let angles =
            Angles { lead: screw.point.helix.lead_angle, contact: screw.point.contact_angle };
        let driving = angles.efficiency(Direction::RotaryToLinear, -screw.point.friction.0);
        let driven = angles.efficiency(Direction::LinearToRotary, screw.point.friction.0);
        assert_relative_eq!(driven, driving.recip(), max_relative = 1e-9, epsilon = 1e-12);
    }
    assert!(tried > 1000, "{tried}");
}

/// Without inertia, the results with saturated friction equal the closed form. For rigid contacts,
/// the closed form is evaluated at the given contact angle, and for elastic contacts, at the
/// contact angle under load.
#[test]
fn results_with_saturated_friction_and_without_inertia_equal_the_closed_form() {
    let mut work = ModelWorkspace::default();
    let mut tried = [0; 2];
    for screw in extreme_screws(5).take(2000) {
        let Drive { screw_speed, nut_speed } = screw.point.drive;
        let speed = screw.point.drive.relative_speed();
        let fastest = screw_speed.abs().max(nut_speed.abs());
        // The inertia force at the speed of the faster body (screw or nut) is 1e-8 times the
        // friction force.
        let mass = 1e-8 * screw.point.friction.0 * screw.point.load.axial
            / (screw.point.helix.radius * fastest.powi(2));
        let screw = with(screw, |screw| screw.point.ball.mass = mass);
        let direction = Direction::of(speed).expect("turning");
        for (i, case) in
            [rigid(&screw), Problem::Elastic(Elastic { screw })].into_iter().enumerate()
        {
            let Ok(o) = case.solve(&mut work).result else { continue };
            let eta = o.transmission.efficiency;
            let contact = 0.5 * (o.ball.nut.angle + o.ball.screw.angle);
            let angles = Angles { lead: screw.point.helix.lead_angle, contact };
            let closed = angles.efficiency(direction, screw.point.friction.0);
            // The error is proportional to the ratio of inertia force to friction force.
            assert_relative_eq!(eta, closed, max_relative = 1e-7, epsilon = 1e-7);
            tried[i] += 1;
        }
    }
    assert!(tried.iter().all(|tried| *tried > 800), "{tried:?}");
}

/// With nut control, the contact angles change in small steps when the speed increases, until the
/// flanks can no longer hold the ball. At higher speeds, the flanks never hold the ball again.
#[test]
fn contact_angles_change_continuously_with_speed() {
    let mut work = ModelWorkspace::default();
    let mut ended = 0;
    for screw in extreme_screws(11)
        .filter(|screw| screw.point.drive.nut_speed.total_cmp(&0.0).is_eq())
        .take(8)
    {
        let unit = screw.point.ball.mass * screw.point.helix.radius / screw.point.load.axial;
        let (mut before, mut left): (Option<f64>, bool) = (None, false);
        for i in 0..1500 {
            let inertia = 10.0_f64.powf(f64::from(i) / 250.0 - 4.0);
            let drive = Drive { screw_speed: (inertia / unit).sqrt(), nut_speed: 0.0 };
            let at = with(screw, |screw| screw.point.drive = drive);
            let solution = raceway_control(at, Some(Control::Nut)).solve(&mut work);
            match solution.status() {
                Status::Converged => {
                    assert!(!left, "{screw:?} {inertia}");
                    let angle = solution.contact(Site::Nut).expect("a contact").angle;
                    // The inertia ratio changes by about 1 % per step. A fold would cause the
                    // contact angle to jump by tenths of a radian.
                    let step = before.map_or(0.0, |before| before - angle);
                    assert!((-1e-9..0.03).contains(&step), "{screw:?} {inertia} {step}");
                    before = Some(angle);
                }
                Status::NoSolution => {
                    let reason = solution.reason().expect("a reason");
                    assert!(matches!(reason, Reason::FlanksCannotHold { .. }), "{reason:?}");
                    left = true;
                }
                other => panic!("{screw:?} {other:?}"),
            }
        }
        ended += usize::from(left);
    }
    assert!(ended > 0, "no ball left its flanks");
}
