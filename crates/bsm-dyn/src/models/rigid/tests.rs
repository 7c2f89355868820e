//! Tests of the rigid model: sweeps are compared with the continuation, and the status
//! `no_solution` with searches from many starting values. Other tests solve points for which
//! earlier versions had no result or a wrong result.

use std::f64::consts::PI;

use approx::assert_relative_eq;
use bsm_kin::{BallFrame, Contact, Drive, Helix, Motion, Site};
use bsm_newton::{Convergence, Options, Scales, solve};
use bsm_sample::{Sample, campaign};
use nalgebra::{Matrix4, Vector3, Vector4};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::ball::RigidCoordinates;
use super::first_order::{
    MIN_STEEP_SINE, UNIQUE_INERTIA, UNIQUE_MAX_FRICTION, UNIQUE_MIN_RATE, UNIQUE_MULTIPLICITY,
};
use super::*;
use crate::extreme::random_extreme_screw;
use crate::models::ball::Workspace;
use crate::{Ball, Coulomb, Evidence, Load, Reason, Status};

/// Number of random slip directions that are tested at each operating point.
const DIRECTIONS: usize = 20_000;
/// Number of Newton solves at each operating point.
const STARTS: usize = 200;

/// Number of operating points without a solution that the test examines.
const NO_SOLUTION: usize = 100;

/// Returns a random screw within the extreme ranges of the inputs.
fn random_extreme_point(rng: &mut impl Rng) -> OperatingPoint {
    random_extreme_screw(rng).point
}

/// Returns a starting value from random slip directions at the contacts A, A' and B, or `None` if a
/// contact would act in tension. Loads and precession rate are calculated from the force balance,
/// the slip at A from the slip direction at B, and the spin from the moment balance about t.
fn random_start(
    point: &OperatingPoint,
    ball: &RigidBall,
    rng: &mut impl Rng,
) -> Option<(RigidEquations<f64>, Unknowns<f64>)> {
    let angles: [f64; 3] = std::array::from_fn(|_| rng.random_range(-PI..PI));
    let friction = ball.signed;
    let frame = BallFrame::turned(point.helix.lead_angle, point.contact_angle);
    let contacts = [Site::Nut, Site::NutUnloaded, Site::Screw]
        .map(|site| Contact::new(site, point.contact_angle, &frame));
    let slips: [_; 3] = std::array::from_fn(|i| {
        contacts[i].transverse * angles[i].cos() + BallFrame::tangent() * angles[i].sin()
    });
    let forces: [_; 3] = std::array::from_fn(|i| contacts[i].normal - slips[i] * friction);
    let mut balance = Matrix4::zeros();
    for (i, force) in forces.iter().enumerate() {
        balance.fixed_view_mut::<3, 1>(0, i).copy_from(force);
        balance[(3, i)] = if i < 2 { force.dot(&frame.k) } else { 0.0 };
    }
    balance.fixed_view_mut::<3, 1>(0, 3).copy_from(&-frame.n);
    let loads = balance.lu().solve(&Vector4::new(0.0, 0.0, 0.0, 1.0))?;
    if loads.iter().any(|load| *load <= 0.0) {
        return None;
    }
    let side = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
    let rate = side * (loads[3] / ball.inertia_ratio).sqrt();
    let p = rate - ball.nut_speed;
    let points = contacts.map(|c| c.point(1.0));
    let at_screw = |slip: f64| {
        let tau = slip * angles[0].sin() - p * ball.arc;
        let motion =
            Motion { precession: p, omega: Vector3::new(-slip * angles[0].cos(), 0.0, tau) };
        motion.relative_to(1.0, &frame).slip_velocity(ball.arc, &points[2])
    };
    let (none, one) = (at_screw(0.0), at_screw(1.0) - at_screw(0.0));
    let normal = contacts[2].normal;
    let slip = -none.cross(&slips[2]).dot(&normal) / one.cross(&slips[2]).dot(&normal);
    let moment: f64 = (0..3).map(|i| points[i].cross(&(slips[i] * -friction * loads[i])).x).sum();
    let tau = slip * angles[0].sin() - p * ball.arc;
    let gyroscopic = ball.inertia * rate * tau * frame.k.y;
    let spin = (gyroscopic - moment) / frame.k.z;
    let (sin, cos) = angles[0].sin_cos();
    let motion = ball.motion(RigidCoordinates {
        loads: [loads[0], loads[1], loads[2]],
        precession: p,
        rate,
        slip: slip.abs(),
        slip_direction: [cos, sin],
        spin_moment: spin,
    });
    Some(RigidEquations::at(ball, &motion))
}

/// Searches from random starting values for admissible roots and returns at most `most` of them.
fn roots_from_random_starts(
    (rigid, ball): (&OperatingPoint, &RigidBall),
    most: usize,
    rng: &mut impl Rng,
    newton: &mut Workspace,
) -> Vec<BallRoot> {
    let (mut started, mut found) = (0, Vec::<BallRoot>::new());
    for _ in 0..DIRECTIONS {
        let Some((case, mut y)) = random_start(rigid, ball, rng) else { continue };
        started += 1;
        for _ in 0..3 {
            // The weights of the equations are recalculated for every iterate.
            let Ok(motion) = case.motion(&y) else { break };
            let weights = ball.own_weights(&motion, 1.0);
            let scales = Scales { x: &[1.0; BALL_UNKNOWNS], f: &weights };
            let convergence = Convergence { max_steps: 30, ..Convergence::default() };
            let options = Options { convergence, ..Options::default() };
            let report = solve(&case, &mut y.data.0[0], &scales, &options, newton).report;
            if report.converged() && report.steps.is_empty() && motion.is_admissible() {
                // Spurious roots at infinity do not satisfy the power balance.
                let solved = ball.steady_state(&motion, &rigid.units(), rigid.contact_angle, false);
                let imbalance = solved.transmission.power_balance;
                let root =
                    BallRoot { motion, steps: 0, residual: report.residual, alternatives: None };
                let balances = imbalance.is_some_and(|x| x.abs() < 1e-6);
                if balances && !found.iter().any(|other| other.is_near(&root)) {
                    found.push(root);
                }
                break;
            }
        }
        if started == STARTS || found.len() == most {
            break;
        }
    }
    found
}

/// At practical points without a solution, random starting values lead to no root. At points with a
/// solution, they usually lead to a root.
#[test]
fn random_starts_find_no_root_where_there_is_no_solution() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let (mut work, mut newton) = (RigidWorkspace::default(), Workspace::default());
    let (mut no_solution, mut found, mut seen) = (0, 0, 0);
    let mut refuted = Vec::new();
    while no_solution < campaign(NO_SOLUTION) {
        let rigid = practical_point(&mut rng);
        let Ok(case) = Rigid { point: rigid }.ball() else { continue };
        let result = root::find(&case, &mut work);
        // If inertia is negligible, the first-order solution already proves that there is no root.
        if case.inertia_ratio < 1e-3 * case.friction() {
            continue;
        }
        match result {
            Err(failure) if failure.status() == Status::NoSolution => {
                no_solution += 1;
                let roots = roots_from_random_starts((&rigid, &case), 1, &mut rng, &mut newton);
                refuted
                    .extend(roots.into_iter().map(|root| (rigid, failure.reason().clone(), root)));
            }
            Ok(_) if found < no_solution => {
                found += 1;
                seen += roots_from_random_starts((&rigid, &case), 1, &mut rng, &mut newton).len();
            }
            _ => {}
        }
    }
    println!("{no_solution} no_solution, {} refuted, {seen} of {found} seen", refuted.len());
    assert!(refuted.is_empty(), "{refuted:#?}");
    assert!(seen * 10 > found * 7, "{seen} of {found}");
}

/// Returns a random screw within slightly more than the practical ranges: pitch circle diameters of
/// 8 to 120 mm; screw drive, nut drive or both; 10 to 10 000 rpm in both directions; and 1 N to 10
/// kN per ball.
fn practical_point(rng: &mut impl Rng) -> OperatingPoint {
    let radius = rng.random_range(4e-3..60e-3);
    let rpm = rng.log_uniform(10.0, 1e4);
    let speed = if rng.random_bool(0.5) { rpm } else { -rpm } * PI / 30.0;
    let nut = [0.0, -1.0, rng.random_range(-1.0..1.0)][rng.random_range(0..3)];
    OperatingPoint {
        helix: Helix { radius, lead_angle: rng.random_range(2.0_f64..45.0).to_radians() },
        contact_angle: rng.random_range(30.0_f64..75.0).to_radians(),
        ball: Ball::of_density(radius * rng.random_range(0.07..0.3), 7800.0),
        friction: Coulomb(rng.log_uniform(3e-3, 0.2)),
        drive: Drive { screw_speed: speed * (1.0 + nut), nut_speed: speed * nut },
        load: Load { axial: rng.log_uniform(1.0, 1e4), balls: 1.0 },
    }
}

/// At the tested points, the inertia forces exceed the friction forces.
#[test]
fn random_starts_find_no_second_root_if_the_inertia_limits_exclude_a_second_root() {
    const POINTS: usize = 30;
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let (mut work, mut newton) = (RigidWorkspace::default(), Workspace::default());
    let (mut points, mut seen) = (0, 0);
    while points < POINTS {
        let rigid = practical_point(&mut rng);
        let Ok(case) = Rigid { point: rigid }.ball() else { continue };
        let first = case.first_order();
        if first.inertia_scale < case.friction() || !first.is_unique {
            continue;
        }
        let Ok(root) = root::find(&case, &mut work) else { continue };
        points += 1;
        for other in roots_from_random_starts((&rigid, &case), usize::MAX, &mut rng, &mut newton) {
            seen += 1;
            assert!(root.is_near(&other), "{rigid:?} {root:?} {other:?}");
        }
    }
    assert!(10 * seen > 7 * points, "{seen} of {points}");
}

/// If the limits of inertia exclude a second root, there is no second root on the branch. The test
/// covers practical and extreme points.
#[test]
fn branch_has_no_second_root_if_the_inertia_limits_exclude_a_second_root() {
    count_second_roots([4000, 2000].map(campaign));
}

/// Prints the numbers of second roots that are cited in `docs/evidence/robustness.md`.
#[test]
#[ignore = "takes a minute"]
fn branch_has_no_second_root_at_many_points_where_the_inertia_limits_exclude_a_second_root() {
    count_second_roots([100_000, 100_000]);
}

/// Solves many operating points and counts the points with a second root.
///
/// * `counts`: number of practical points and number of extreme points.
fn count_second_roots(counts: [usize; 2]) {
    let mut rng = ChaCha8Rng::seed_from_u64(45);
    let mut work = RigidWorkspace::default();
    let draws = [
        ("practice", practical_point as fn(&mut ChaCha8Rng) -> OperatingPoint),
        ("extremes", random_extreme_point),
    ];
    for ((name, draw), count) in draws.into_iter().zip(counts) {
        let (mut tried, mut several, mut unknown) = (0, 0, 0);
        let (mut least_inertia, mut least_multiplicity) = (f64::INFINITY, f64::INFINITY);
        while tried < count {
            let rigid = draw(&mut rng);
            let Ok(case) = Rigid { point: rigid }.ball() else { continue };
            let start = case.first_order();
            let friction = case.friction();
            // At very small inertia, rounding errors of the loads exceed the inertia forces.
            if start.inertia_scale < 1e-3 * friction {
                continue;
            }
            tried += 1;
            let Ok(root) = root::find_all(&case, &mut work) else { continue };
            let Some(alternatives) = root.alternatives else {
                unknown += 1;
                continue;
            };
            // Spurious roots at infinity do not satisfy the power balance.
            if count_balanced_roots(&rigid, &case, &alternatives) > 0 {
                several += 1;
                assert!(!start.is_unique, "{rigid:?} {alternatives:?}");
                if start.rate.abs() > UNIQUE_MIN_RATE {
                    if friction < UNIQUE_MAX_FRICTION {
                        least_inertia =
                            least_inertia.min(start.inertia_scale / (friction * friction));
                    }
                    if case.sines.sin_b > MIN_STEEP_SINE {
                        least_multiplicity = least_multiplicity.min(start.multiplicity);
                    }
                }
            }
        }
        println!(
            "{name}: {several} of {tried} points have several roots on the branch, {unknown} are \
             undecided; least inertia {least_inertia:.0} f^2, least C at steep contact angles \
             {least_multiplicity:.0}"
        );
        assert!(several >= count / 2000 && unknown * 20 <= count, "{several} {unknown}");
        assert!(least_inertia > UNIQUE_INERTIA && least_multiplicity > UNIQUE_MULTIPLICITY);
    }
}

/// Returns an operating point with large inertia whose efficiency jumps at a certain contact angle.
fn point_near_a_jump(contact_angle_deg: f64) -> OperatingPoint {
    let rpm = PI / 30.0;
    OperatingPoint {
        helix: Helix {
            radius: 0.5 * 96.970_829_287_513_72e-3,
            lead_angle: 21.833_579_108_750_985_f64.to_radians(),
        },
        contact_angle: contact_angle_deg.to_radians(),
        ball: Ball::of_density(0.5 * 22.510_703_287_064_903e-3, 7800.0),
        friction: Coulomb(0.026_685_642_355_053_593),
        drive: Drive {
            screw_speed: 591.824_023_668_092 * rpm,
            nut_speed: -987.429_642_734_032_8 * rpm,
        },
        load: Load { axial: 375.929_716_302_149_2, balls: 47.0 },
    }
}

/// Returns the number of roots that satisfy the power balance.
fn count_balanced_roots(rigid: &OperatingPoint, ball: &RigidBall, roots: &[BallRoot]) -> usize {
    let rigid = Rigid { point: *rigid };
    roots.iter().filter(|root| rigid.balanced(ball, root).is_ok()).count()
}

/// Between contact angles of 55.12 and 55.13 degrees, the efficiency jumps from 0.92698 to 0.92168.
/// An earlier version did not report the second steady motion.
#[test]
fn second_solution_is_reported_where_the_efficiency_jumps() {
    let mut work = RigidWorkspace::default();
    let answered = |angle: f64, work: &mut _| {
        let branch = Rigid { point: point_near_a_jump(angle) }.branch(work).expect("a branch");
        let (first, others) = branch.split_first().expect("a root");
        let first = first.transmission.efficiency;
        let far = |eta: &f64| (eta - first).abs();
        let others: Vec<_> = others.iter().map(|other| other.transmission.efficiency).collect();
        let farthest = others.iter().max_by(|a, b| far(a).total_cmp(&far(b))).copied();
        (first, others.len(), farthest)
    };
    // This operating point has three roots: two whose efficiencies are checked below, and one
    // between them.
    let (eta, alternatives, other) = answered(54.5, &mut work);
    assert_eq!(alternatives, 2);
    // The expected efficiencies are printed results with six digits.
    assert_relative_eq!(eta, 0.931_044, epsilon = 1e-6);
    assert_relative_eq!(other.expect("another"), 0.921_331, epsilon = 1e-6);
    // At the jump of the efficiency, two of the three roots merge and vanish. The third root
    // persists.
    let (before, alternatives, goes_on) = answered(55.12, &mut work);
    assert_eq!(alternatives, 2);
    let (after, alternatives, _) = answered(55.13, &mut work);
    assert_eq!(alternatives, 0);
    assert_relative_eq!(before, 0.92698, epsilon = 2e-4);
    // A change of the contact angle by 0.01 degrees changes the efficiency of the third root by
    // less than a hundredth of the jump.
    assert_relative_eq!(goes_on.expect("another"), after, epsilon = 5e-5);
}

/// The screw is at rest, and the inertia forces are 1.5 times the friction forces. On an isolated
/// curve, there is a second root with the opposite slip direction at contact A. This root must not
/// be the result, but the model must not claim that it does not exist.
#[test]
fn solver_does_not_return_the_root_on_an_isolated_solution_curve() {
    let rigid = operating_point(
        [0.474_482_528_367_515, 0.536_916_895_777_574_3],
        [0.006_280_477_531_758_016_5, 0.023_603_688_672_616_797, 0.008_093_962_926_287_675],
        0.015_592_426_029_401_482,
        [0.0, -27.856_407_067_407_805],
        6.527_150_674_132_145,
    );
    let case = Rigid { point: rigid }.ball().expect("in the domain");
    assert!(!case.first_order().is_unique);
    let root = root::find(&case, &mut RigidWorkspace::default()).expect("a root");
    let [transverse, _] = root.motion.directions[0];
    assert!(transverse > -0.99, "{transverse}");
    assert_eq!(root.alternatives, None);
}

/// If the sweeps converge, they find the first root of the branch that begins at zero inertia.
#[test]
fn sweeps_that_converge_find_the_same_root_as_continuation() {
    let mut rng = ChaCha8Rng::seed_from_u64(50);
    let (mut compared, mut lost) = (0, 0);
    for number in 0..campaign(4000) {
        let rigid = if number % 2 == 0 {
            practical_point(&mut rng)
        } else {
            random_extreme_point(&mut rng)
        };
        let Ok(case) = Rigid { point: rigid }.ball() else { continue };
        let first = case.first_order();
        let swept = case.fixed_point(&first);
        if first.inertia_scale < 0.2 * case.friction()
            || !(swept.converged && swept.motion.is_admissible())
        {
            continue;
        }
        let Some(found) = case.follow_branch(&first).motions.first().copied() else {
            lost += 1;
            continue;
        };
        compared += 1;
        // The root on the branch is located to within a thousandth of a step.
        assert_relative_eq!(found.loads[2], swept.motion.loads[2], max_relative = 0.02);
    }
    assert!(compared > campaign(500) && lost * 100 <= compared, "{compared} {lost}");
}

/// Creates an operating point from the lead angle and the contact angle \[rad\], the ball radius
/// and the pitch circle radius \[m\], the mass \[kg\], the friction coefficient, the speeds of the
/// screw and the nut \[rad/s\], and the axial load \[N\].
fn operating_point(
    [lead_angle, contact_angle]: [f64; 2],
    [ball, radius, mass]: [f64; 3],
    friction: f64,
    [screw_speed, nut_speed]: [f64; 2],
    axial: f64,
) -> OperatingPoint {
    OperatingPoint {
        helix: Helix { radius, lead_angle },
        contact_angle,
        ball: Ball { radius: ball, mass },
        friction: Coulomb(friction),
        drive: Drive { screw_speed, nut_speed },
        load: Load { axial, balls: 1.0 },
    }
}

/// Returns practical operating points whose balls orbit very slowly.
fn slowly_orbiting_points() -> [OperatingPoint; 4] {
    [
        operating_point(
            [0.439_627_372_287_971_6, 1.230_144_154_782_304],
            [0.001_877_737_949_846_261_7, 0.009_725_065_009_945_334, 0.000_216_315_760_563_808_9],
            0.003_488_189_292_802_163_6,
            [-21.760_639_807_236_178, 15.951_468_366_983_681],
            87.599_813_997_478_28,
        ),
        operating_point(
            [0.445_345_311_434_297_56, 0.584_861_456_659_291],
            [0.013_188_815_622_635_847, 0.055_722_540_188_501_66, 0.074_954_999_017_559_53],
            0.027_657_600_582_681_42,
            [1.406_859_428_894_927_7, -0.911_951_294_715_453_3],
            40.574_949_387_015_4,
        ),
        operating_point(
            [0.153_776_798_451_591_7, 0.547_019_224_739_093_9],
            [0.002_295_392_258_188_638, 0.011_228_734_436_105_866, 0.000_395_142_687_765_794_26],
            0.005_590_038_423_049_845,
            [0.633_938_887_324_042_7, -0.444_077_963_813_085_8],
            56.132_255_466_280_42,
        ),
        operating_point(
            [0.118_720_397_410_165_5, 0.943_034_475_804_505_8],
            [0.002_217_533_678_632_065_3, 0.011_457_438_584_403_287, 0.000_356_282_002_892_958_3],
            0.010_807_370_284_090_968,
            [184.997_531_548_016_87, -146.331_073_295_548_46],
            1_032.653_808_748_723_2,
        ),
    ]
}

/// Inertia forces are proportional to the square of the precession rate, so inertia cannot reverse
/// the precession. In an earlier version, the continuation began beyond the root of the first
/// operating point. A search that varied the inertia over its whole range also failed: the load at
/// the unloaded flank of the nut is 1e-18 times the axial load and was lost in rounding errors.
#[test]
fn slowly_orbiting_ball_has_a_root() {
    for point in slowly_orbiting_points() {
        let first = Rigid { point }.first_order().expect("friction");
        assert!(first.rate.abs() < 0.3 * first.inertia_scale / point.friction.0);
        let root = balanced_root(&point);
        // The relative effect of inertia on the precession rate is at most the ratio of inertia to
        // friction, which is 0.04.
        let rate = root.p + point.drive.nut_speed / point.drive.relative_speed();
        assert_relative_eq!(rate, first.rate, max_relative = 0.1);
    }
}

/// At this operating point, the ratio of inertia forces to friction forces is 0.0098. In an earlier
/// version, the branch began at a ratio of 0.01.
#[test]
fn followed_branch_begins_below_the_actual_inertia() {
    let [point, ..] = slowly_orbiting_points();
    let ball = Rigid { point }.ball().expect("in the domain");
    let first = ball.first_order();
    let swept = ball.fixed_point(&first);
    let branch = ball.follow_branch(&first);
    let found = branch.motions.first().expect("a root");
    // The root on the branch is located to within a thousandth of a step.
    assert_relative_eq!(found.rate, swept.motion.rate, max_relative = 0.01);
    assert_relative_eq!(found.loads[2], swept.motion.loads[2], max_relative = 0.01);
}

/// If the inertia forces are much larger than friction, the ball of a nut drive nearly rolls on the
/// nut. Slips and loads are powers of the inertia, so the branch is straight in logarithmic
/// unknowns. With the loads and slips themselves as unknowns, the continuation did not reach this
/// root in 400 steps.
#[test]
fn branch_reaches_the_root_of_a_nut_drive_with_large_inertia() {
    let point = operating_point(
        [0.005_127_989_799_851_236, 0.817_852_369_290_836_2],
        [0.099_590_571_306_133_2, 0.821_862_120_667_516_8, 35.730_066_958_160_904],
        0.000_118_020_912_081_780_53,
        [0.0, 451.163_491_707_351_8],
        46.693_249_083_717_21,
    );
    let first = Rigid { point }.first_order().expect("friction");
    assert!(first.inertia_scale > 1e8 * point.friction.0);
    let (root, cost) = crate::cost::cost_of(|| balanced_root(&point));
    // The expected value comes from a search that varied the inertia over its whole range and used
    // a different reduction of the equations.
    assert_relative_eq!(
        root.screw_load,
        63.992_277_951_219_11 / 46.693_249_083_717_21,
        max_relative = 1e-9
    );
    // The limit is about twice the cost of two solves, each with about 80 points on the branch and
    // up to ten evaluations per point. Without logarithmic unknowns, at least 400 points were
    // necessary.
    assert!(cost.evaluations < 4000, "{cost:?}");
}

/// At the tested practical operating point, the first-order solution predicts that the ball rolls
/// on the nut. The root belongs to a branch that begins at half of the actual inertia, where the
/// slip at the loaded flank of the nut vanishes. Random starting values confirm this behavior: they
/// lead to a root at the actual inertia, but not at smaller inertia.
#[test]
fn solver_does_not_return_a_root_on_a_branch_that_begins_at_finite_inertia() {
    let point = operating_point(
        [0.226_055_957_774_747_85, 1.301_645_438_765_080_7],
        [0.010_724_184_593_065_744, 0.057_641_502_279_837_054, 0.040_297_309_822_086_74],
        0.149_332_879_668_617_9,
        [-353.894_623_405_007_17, 167.673_748_475_566_55],
        89.946_768_614_895_59,
    );
    let solution = Rigid { point }.solve(&mut RigidWorkspace::default());
    assert!(matches!(solution.evidence(), Some(Evidence::Traced { .. })), "{solution:?}");
    let mut rng = ChaCha8Rng::seed_from_u64(66);
    let mut newton = Workspace::default();
    for (part, exists) in [(1.0, true), (0.4, false), (0.2, false), (0.1, false)] {
        let load = Load { axial: point.load.axial / part, ..point.load };
        let point = OperatingPoint { load, ..point };
        let ball = Rigid { point }.ball().expect("in the domain");
        let roots = roots_from_random_starts((&point, &ball), 1, &mut rng, &mut newton);
        assert_eq!(!roots.is_empty(), exists, "{part} {roots:?}");
    }
}

/// Solves for the root and returns it after checking its power balance.
fn balanced_root(rigid: &OperatingPoint) -> RigidRoot {
    let mut work = RigidWorkspace::default();
    let rigid = Rigid { point: *rigid };
    let solution = rigid.solve(&mut work);
    assert_eq!(solution.status(), Status::Converged, "{rigid:?} {:?}", solution.reason());
    rigid.root(&mut work).expect("it converged")
}

/// For friction coefficients of order one, an earlier version excluded roots on isolated curves
/// because of the first-order solution.
#[test]
fn first_order_solution_does_not_exclude_roots_at_large_friction() {
    let screw = operating_point(
        [0.676_723_890_5, 0.436_508_972_9],
        [0.094_159_373_29, 7.007_599_528, 49.385_638_61],
        0.547_734_725_2,
        [-0.037_968_384_84, 0.0],
        0.001_652_936_937,
    );
    let calm = operating_point(
        [0.878_405_142_2, 0.136_486_880_8],
        [0.000_882_365_986_0, 0.011_052_574_74, 5.406_855_918e-5],
        0.709_692_565_0,
        [-5_056.834_461, 0.0],
        122.066_740_4,
    );
    for point in [screw, calm] {
        assert!(Rigid { point }.first_order().expect("friction").sliding_margin < 0.0);
        let solution = Rigid { point }.solve(&mut RigidWorkspace::default());
        let evidence = solution.evidence();
        // Only the branch that begins at zero inertia is followed; isolated curves are not searched
        // for roots.
        assert!(matches!(evidence, None | Some(Evidence::Traced { .. })), "{solution:?}");
    }
}

/// Near self-locking, the loads are 2e5 times the axial load, while the inertia forces are very
/// small. In an earlier version, rounding errors of these loads made the load at the unloaded flank
/// of the nut negative at some speeds.
#[test]
fn load_on_the_opposite_flank_is_positive_near_self_locking() {
    for screw_speed in [-0.1, -0.1047, -0.104_770_5, -0.105, -0.11] {
        let ball = Ball::of_density(0.419_112_6e-3, 17_715.02);
        let screw = operating_point(
            [79.733_729_770_937_25_f64.to_radians(), 11.604_331_974_590_215_f64.to_radians()],
            [ball.radius, 7.013_433_224_199_717e-3, ball.mass],
            0.035_868_4,
            [screw_speed, -360.684_3].map(|rpm| rpm * PI / 30.0),
            14_065.66,
        );
        let first = Rigid { point: screw }.first_order().expect("friction");
        let root = balanced_root(&screw);
        assert!(root.nut_load > 1e5, "{root:?}");
        // The relative error of the first-order solution is 2e5 times ι/f, which is 2e-2 at this
        // point.
        assert_relative_eq!(
            root.unloaded_flank_load,
            first.unloaded * first.inertia,
            max_relative = 0.03
        );
    }
}

/// The inertia ratio is 4e5, but the ball orbits so slowly that its inertia forces are small. An
/// earlier version divided the residual by the inertia ratio, so the loads were accurate to only
/// five digits.
#[test]
fn loads_are_accurate_at_a_large_inertia_ratio() {
    let rigid = operating_point(
        [0.071_506_181_892_471_68, 1.530_087_035_562_457_4],
        [0.046_891_536_867_857_21, 0.635_982_153_956_677_9, 4.194_819_626_895_116],
        0.000_884_817_032_225_969_9,
        [3_256.930_551_240_045, 0.0],
        71.492_862_198_963_3,
    );
    let root = balanced_root(&rigid);
    assert_relative_eq!(root.nut_load, 1.261_712_569, max_relative = 1e-8);
    assert_relative_eq!(root.p, 2.337_439_703e-4, max_relative = 1e-8);
}

/// The screw and the nut both rotate, and the ball orbits very slowly. In an earlier version, the
/// precession rate P was a difference of large numbers, so no Newton step reduced the residual.
#[test]
fn precession_rate_of_a_slowly_orbiting_ball_is_accurate() {
    let rigid = operating_point(
        [0.626_999_675_0, 0.647_413_321_4],
        [0.024_599_681_13, 0.472_356_244_0, 0.061_325_760_58],
        0.002_251_451_520,
        [4_947.433_489, -2_687.953_720],
        8.922_003_487e-6,
    );
    let case = Rigid { point: rigid }.ball().expect("in the domain");
    let root = root::find(&case, &mut RigidWorkspace::default()).expect("a root");
    let (p, rate) = (root.motion.precession, root.motion.rate);
    assert!(rate.abs() < 1e-5 * p, "{p} {rate}");
    balanced_root(&rigid);
}

/// At the first operating point, the slip at contact A changes its direction while the slip
/// direction at contact B changes by only 1e-6 rad. At the second operating point, the load at
/// contact A nearly vanishes.
#[test]
fn root_is_found_near_sharp_turns_of_the_branch() {
    let turns = operating_point(
        [0.504_958_092_793_035_3, 1.512_811_586_775_128_8],
        [0.009_998_217_540_957_081, 0.856_559_715_426_631_5, 0.003_561_653_961_393_374],
        1.841_214_520_141_171_8e-6,
        [0.0, 737.698_156_451_659_8],
        1_227.824_831_781_715_4,
    );
    assert!(balanced_root(&turns).nut_load > 10.0);
    let vanishes = operating_point(
        [1.242_357_241_073_076_5, 0.073_531_098_267_995_63],
        [0.011_117_257_877_815_303, 0.490_749_956_487_772_03, 0.082_382_794_484_396_17],
        0.793_979_769_045_033_8,
        [-15.931_892_106_144_456, 0.0],
        2.788_951_625_334_748_4,
    );
    assert!(balanced_root(&vanishes).nut_load < 0.01);
}

#[test]
fn root_exists_at_reported_nearest_inertia() {
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    let mut work = RigidWorkspace::default();
    let mut named = 0;
    while named < 50 {
        let rigid = random_extreme_point(&mut rng);
        let solution = Rigid { point: rigid }.solve(&mut work);
        let Some(Reason::NoRootAtInertia { inertia_ratio, nearest_ratio }) = solution.reason()
        else {
            continue;
        };
        named += 1;
        // The branch ends at the reported inertia. The test uses an inertia on the branch that
        // differs from the reported inertia by 0.1 %.
        let back = if nearest_ratio < inertia_ratio { 0.999 } else { 1.001 };
        let axial = rigid.load.axial * inertia_ratio / (back * nearest_ratio);
        balanced_root(&OperatingPoint { load: Load { axial, ..rigid.load }, ..rigid });
    }
}

/// In the limit of large inertia, the precession rate of a screw drive is inversely proportional to
/// the square root of the inertia, and the loads are constant.
#[test]
fn precession_rate_scales_with_inverse_square_root_of_inertia_if_inertia_is_large() {
    let lin = |axial| {
        operating_point(
            [10.0_f64.to_radians(), 45.0_f64.to_radians()],
            [4.37e-3, 24.3e-3, 2.7266e-3],
            0.075,
            [209.439_510_2, 0.0],
            axial,
        )
    };
    let limit = balanced_root(&lin(1e-16));
    for axial in [1e-8_f64, 1e-10, 1e-12] {
        let root = balanced_root(&lin(axial));
        // The relative difference from the limit of infinite inertia is of the order of the
        // precession rate.
        let scale = (axial / 1e-16).sqrt();
        assert_relative_eq!(root.p, limit.p * scale, max_relative = 10.0 * root.p.abs());
        assert_relative_eq!(root.nut_load, limit.nut_load, max_relative = 10.0 * root.p.abs());
    }
}
