//! Campaigns that each solve ten thousand random operating points. Every point must converge or
//! have no solution.

use bsm_dyn::{
    Ball, Coulomb, Load, OperatingPoint, Status,
    model::{Rigid, RigidWorkspace},
};
use bsm_kin::{Drive, Helix};
use bsm_sample::Sample;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Numbers of points with each outcome of a campaign.
#[derive(Debug, Default)]
struct Tally {
    converged: usize,
    no_solution: usize,
    not_converged: usize,
    /// Number of roots that exist although the first-order solution excludes them.
    against: usize,
    /// Number of points without a root although the first-order solution predicts a root.
    refuted: usize,
    /// Largest relative margin by which the first-order solution excludes an existing root, divided
    /// by min(1, inertia/friction).
    farthest: f64,
    /// Smallest ratio of inertia force to friction force among the points that did not converge.
    calmest: f64,
    most_steps: usize,
    more_than_twelve: usize,
    worst_balance: f64,
    worst_residual: f64,
}

impl Tally {
    fn add(&mut self, case: &OperatingPoint, work: &mut RigidWorkspace) {
        let start = Rigid { point: *case }.first_order().expect("friction and speed are positive");
        let solution = Rigid { point: *case }.solve(work);
        match &solution.result {
            Ok(o) => {
                self.converged += 1;
                let steps = o.info.expect("an iteration").steps;
                self.most_steps = self.most_steps.max(steps);
                self.more_than_twelve += usize::from(steps > 12);
                let balance = o.transmission.power_balance.expect("a balance of forces").abs();
                self.worst_balance = self.worst_balance.max(balance);
                self.worst_residual =
                    self.worst_residual.max(o.info.expect("an iteration").residual);
                assert!(o.transmission.efficiency < 1.0, "{case:?} {o:?}");
                assert!(
                    o.ball.unloaded.is_some_and(|unloaded| unloaded.load > Some(0.0)),
                    "{case:?} {o:?}"
                );
                if start.load > 0.0 && start.unloaded > 0.0 && start.sliding_margin < 0.0 {
                    self.against += 1;
                    let relative =
                        start.sliding_margin / (start.precession * case.helix.lead_angle.tan());
                    let inertia = (start.inertia_scale / case.friction.0).min(1.0);
                    self.farthest = self.farthest.max(relative.abs() / inertia);
                }
            }
            Err(none) if none.status() == Status::NoSolution => {
                self.no_solution += 1;
                self.refuted += usize::from(start.root_exists());
            }
            Err(_) => {
                self.not_converged += 1;
                self.calmest = self.calmest.min(start.inertia_scale / case.friction.0);
            }
        }
    }
}

/// Solves random operating points within the ranges for which the rigid model is specified. `pitch`
/// returns a random pitch circle radius.
fn solve_random_screws(count: usize, seed: u64, pitch: impl Fn(&mut ChaCha8Rng) -> f64) -> Tally {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut work = RigidWorkspace::default();
    let mut tally = Tally { calmest: f64::INFINITY, ..Tally::default() };
    for _ in 0..count {
        let radius = pitch(&mut rng);
        let speed = rng.random_range(50.0..6000.0) * std::f64::consts::PI / 30.0;
        let speed = if rng.random_bool(0.5) { speed } else { -speed };
        let drive = if rng.random_bool(0.5) {
            Drive { screw_speed: speed, nut_speed: 0.0 }
        } else {
            Drive { screw_speed: 0.0, nut_speed: speed }
        };
        let case = OperatingPoint {
            helix: Helix { radius, lead_angle: rng.random_range(3.0_f64..45.0).to_radians() },
            contact_angle: rng.random_range(20.0_f64..80.0).to_radians(),
            ball: Ball::of_density(radius * rng.random_range(0.07..0.2), 7800.0),
            friction: Coulomb(rng.random_range(0.01..0.15)),
            drive,
            load: Load { axial: rng.random_range(20.0..3000.0), balls: 1.0 },
        };
        tally.add(&case, &mut work);
    }
    tally
}

/// All points have the pitch circle of Lin's screw.
#[test]
fn screws_with_the_pitch_circle_from_the_paper_by_lin_converge_or_have_no_solution() {
    let tally = solve_random_screws(10_000, 1994, |_| 24.3e-3);
    println!("{tally:#?}");
    assert_eq!(tally.not_converged, 0, "{tally:#?}");
    assert!(tally.more_than_twelve * 100 < tally.converged, "{tally:#?}");
    // The sweeps stop when only rounding errors remain, or when the friction directions change by
    // less than 1e-12.
    assert!(tally.worst_balance <= 1e-11 && tally.worst_residual <= 1e-11, "{tally:#?}");
    assert_agreement_with_the_first_order_solution(&tally);
}

/// The pitch circle diameters range from 8 to 100 mm.
#[test]
fn screws_with_catalog_pitch_circles_converge_or_have_no_solution() {
    let tally = solve_random_screws(10_000, 2026, |rng| rng.random_range(4e-3..50e-3));
    println!("{tally:#?}");
    assert_eq!(tally.not_converged, 0, "{tally:#?}");
    // At 6000 rpm and 20 N, larger balls have inertia ratios of up to 30. The starting value is
    // then far from the root.
    assert!(tally.more_than_twelve * 25 < tally.converged, "{tally:#?}");
    assert!(tally.worst_balance <= 1e-9 && tally.worst_residual <= 1e-10, "{tally:#?}");
    assert_agreement_with_the_first_order_solution(&tally);
}

/// Checks that roots exist where the first-order solution predicts them. Points near the limit of
/// existence are excluded if their distance from the limit is less than the error of the
/// first-order solution. The solver assumes an error of 0.1 when it excludes a root.
fn assert_agreement_with_the_first_order_solution(tally: &Tally) {
    assert!(tally.against + tally.refuted <= 20, "{tally:#?}");
    assert!(tally.farthest <= 0.08, "{tally:#?}");
    assert!(tally.no_solution > 1000 && tally.converged > 8000, "{tally:#?}");
}

/// The ranges are far beyond practice: screw and nut both rotate at 1e-3 to 1e5 rpm, with 1e-3 to
/// 1e6 N per ball, balls of 0.5 to 40 mm and friction coefficients of 1e-4 to 1. Almost every point
/// must converge or have no solution.
#[test]
fn nearly_all_extreme_screws_converge_or_have_no_solution() {
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    let mut work = RigidWorkspace::default();
    let mut tally = Tally { calmest: f64::INFINITY, ..Tally::default() };
    for _ in 0..10_000 {
        let radius = rng.log_uniform(1e-3, 0.1);
        let mut speed =
            || rng.log_uniform(1e-4, 1e4) * if rng.random_bool(0.5) { 1.0 } else { -1.0 };
        let drive = Drive { screw_speed: speed(), nut_speed: speed() };
        let case = OperatingPoint {
            helix: Helix { radius, lead_angle: rng.random_range(0.05_f64..80.0).to_radians() },
            contact_angle: rng.random_range(2.0_f64..88.0).to_radians(),
            ball: Ball::of_density(radius * rng.random_range(0.05..0.4), 7800.0),
            friction: Coulomb(rng.log_uniform(1e-4, 1.0)),
            drive,
            load: Load { axial: rng.log_uniform(1e-3, 1e6), balls: 1.0 },
        };
        tally.add(&case, &mut work);
    }
    println!("{tally:#?}");
    assert!(tally.worst_balance <= 1e-9 && tally.worst_residual <= 1e-10, "{tally:#?}");
    // The continuation fails for one screw with nut drive and extremely large inertia, close to a
    // point at which a slip velocity changes sign.
    assert!(tally.not_converged <= 1, "{tally:#?}");
    assert!(tally.converged > 7000 && tally.no_solution > 2000, "{tally:#?}");
}
