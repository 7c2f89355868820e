//! Ten thousand seeded scenes: everything converges or is denied, and by what.

use bsm_dyn::{Ball, Load, Reason, Rigid, RigidWorkspace, Status};
use bsm_kin::{Drive, Helix};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Counts of a campaign.
#[derive(Debug, Default)]
struct Tally {
    converged: usize,
    denied: usize,
    not_converged: usize,
    /// Against the first-order test: (it says yes, we say no) and the reverse.
    disagree: (usize, usize),
    /// Largest |margin|/tanα of a disagreement over its ε/f.
    widest: f64,
    most_steps: usize,
    steps: [usize; 12],
    worst_balance: f64,
    worst_residual: f64,
}

/// Scenes of the ranges that the rigid model is specified for; `pitch` draws the pitch radius.
fn campaign(count: usize, seed: u64, pitch: impl Fn(&mut ChaCha8Rng) -> f64) -> Tally {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut work = RigidWorkspace::default();
    let mut tally = Tally::default();
    for _ in 0..count {
        let radius = pitch(&mut rng);
        let speed = rng.random_range(50.0..6000.0) * std::f64::consts::PI / 30.0;
        let speed = if rng.random_bool(0.5) { speed } else { -speed };
        let drive = if rng.random_bool(0.5) {
            Drive { screw_speed: speed, nut_speed: 0.0 }
        } else {
            Drive { screw_speed: 0.0, nut_speed: speed }
        };
        let case = Rigid {
            helix: Helix { radius, lead_angle: rng.random_range(3.0_f64..45.0).to_radians() },
            contact_angle: rng.random_range(20.0_f64..80.0).to_radians(),
            ball: Ball::of_density(radius * rng.random_range(0.07..0.2), 7800.0),
            friction: rng.random_range(0.01..0.15),
            drive,
            load: Load { axial: rng.random_range(20.0..3000.0), balls: 1.0 },
        };
        let start = case.first_order().expect("friction and speed are positive");
        let solution = case.solve(&mut work);
        let o = &solution.outputs;
        match solution.status {
            Status::Converged => {
                tally.converged += 1;
                let steps = o.iterations.expect("iterations");
                tally.most_steps = tally.most_steps.max(steps);
                tally.steps[steps.min(11)] += 1;
                tally.worst_balance =
                    tally.worst_balance.max(o.power_balance.expect("power balance").abs());
                tally.worst_residual = tally.worst_residual.max(o.residual_norm.expect("residual"));
            }
            Status::NoSolution => tally.denied += 1,
            Status::NotConverged | Status::InvalidInput => {
                tally.not_converged += 1;
            }
        }
        let exists = solution.status == Status::Converged;
        if exists != start.exists() && !matches!(solution.reason, Some(Reason::Newton { .. })) {
            if exists {
                tally.disagree.1 += 1;
            } else {
                tally.disagree.0 += 1;
            }
            let relative = start.margin.abs() / case.helix.lead_angle.tan();
            let width = relative / (start.inertia / case.friction);
            tally.widest = tally.widest.max(width);
        }
    }
    tally
}

/// Lin's pitch circle.
#[test]
fn lin_pitch_circle() {
    let tally = campaign(10_000, 1994, |_| 24.3e-3);
    assert_eq!(tally.not_converged, 0, "{tally:#?}");
    assert!(tally.most_steps <= 6);
    // Direct solves end at rounding: two decades of room on what was measured, 1e-13.
    assert!(tally.worst_balance <= 1e-11 && tally.worst_residual <= 1e-11);
    agrees_with_the_first_order(&tally);
}

/// Pitch circles of 8 to 100 mm.
#[test]
fn catalogue_pitch_circles() {
    let tally = campaign(10_000, 2026, |rng| rng.random_range(4e-3..50e-3));
    assert_eq!(tally.not_converged, 0, "{tally:#?}");
    assert!(tally.worst_balance <= 1e-9 && tally.worst_residual <= 1e-10);
    // Larger balls at 6000 rpm and 20 N reach inertia ratios of 30, where the start is far off
    // and the root is followed from smaller inertia.
    assert!(tally.steps[7..].iter().sum::<usize>() <= 20, "{tally:?}");
    agrees_with_the_first_order(&tally);
}

/// Existence is the first-order test but for a band around its border, as wide as its error:
/// `$\varepsilon/f$`, the ratio of inertia to friction forces.
fn agrees_with_the_first_order(tally: &Tally) {
    assert!(tally.disagree.0 + tally.disagree.1 <= 20, "{tally:?}");
    assert!(tally.widest <= 1.0, "{tally:?}");
    assert!(tally.denied > 1000 && tally.converged > 8000, "{tally:?}");
}
