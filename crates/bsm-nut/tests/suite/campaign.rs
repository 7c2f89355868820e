//! Tests with random nuts and random combinations of all features. For each nut, the solver must
//! find the equilibrium or report that the nut cannot carry the load.

use crate::nuts;

use std::f64::consts::{PI, TAU};

use bsm_dyn::{Ball, Conformities, Material, Materials};
use bsm_kin::Helix;
use bsm_nut::{
    BallInGrooves, BallNut, Bar, Circuit, Equilibrium, Errors, Flanks, Freedom, LeadError,
    NutError, Ring, Support,
};
use bsm_sample::Sample;
use nuts::with_circuits;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Returns a random nut with 1 to 400 balls and randomly selected features.
pub(crate) fn nut(rng: &mut impl Rng) -> BallNut {
    let ball = rng.log_uniform(1e-3, 12e-3);
    let pitch = ball * rng.random_range(4.0..16.0);
    let lead = ball * rng.random_range(1.1..4.0);
    let steel = Material { youngs_modulus: 206e9, poisson_ratio: 0.3 };
    let count = rng.random_range(1..=5_usize);
    let pair = rng.random_bool(0.3);
    let mut start = 0.0;
    let mut circuits = Vec::new();
    for number in 0..count {
        let arc = rng.random_range(0.3..3.0) * TAU;
        let body = usize::from(pair && 2 * number >= count);
        let flanks = match (pair, rng.random_range(0..3)) {
            (true, 0) => [Flanks::Plus, Flanks::Minus][body],
            (false, 0) => Flanks::Plus,
            _ => Flanks::Both,
        };
        let offset = if pair { rng.random_range(-20e-6..20e-6) } else { 0.0 };
        let balls = rng.random_range(1..=80);
        circuits.push(Circuit { start, arc, balls, thread: 0, body, flanks, offset });
        start += arc + rng.random_range(0.0..1.0) * TAU;
    }
    let mut nut = BallNut {
        helix: Helix { radius: 0.5 * pitch, lead_angle: (lead / (PI * pitch)).atan() },
        ball: Ball::of_density(0.5 * ball, 7800.0),
        contact_angle: rng.random_range(25.0_f64..65.0).to_radians(),
        conformity: Conformities {
            nut: rng.random_range(0.51..0.57),
            screw: rng.random_range(0.51..0.57),
        },
        material: Materials::alike(steel),
        ..with_circuits(circuits)
    };
    let balls = nut.balls();
    let size = rng.log_uniform(1e-6, 20e-6);
    let mut errors = Errors::default();
    if rng.random_bool(0.5) {
        errors.balls = (0..balls).map(|_| size * rng.random_range(-0.5..0.5)).collect();
    }
    if rng.random_bool(0.3) {
        errors.oversize = size * rng.random_range(-1.0..1.0);
    }
    if rng.random_bool(0.5) {
        let phase = rng.random_range(0.0..TAU);
        errors.lead.push(LeadError::Wave { amplitude: size, order: 1.0, phase });
        errors.lead.push(LeadError::Slope { slope: 1e-5, origin: 0.0 });
    }
    if rng.random_bool(0.3) {
        errors.gap = size;
    }
    nut.errors = errors;
    let length = lead * start / TAU;
    let area = 0.25 * PI * pitch * pitch;
    if rng.random_bool(0.5) {
        let anchor = rng.random_range(-0.5..1.5) * length;
        nut.nut_bar = Some(Bar { stiffness: 206e9 * area, anchor });
    }
    if rng.random_bool(0.5) {
        let anchor = rng.random_range(-0.5..1.5) * length;
        nut.screw_bar = Some(Bar { stiffness: 206e9 * 0.7 * area, anchor });
    }
    if rng.random_bool(0.5) {
        let inner = pitch + 0.7 * ball;
        nut.ring = Some(Ring {
            outer_diameter: 1.5 * inner,
            inner_diameter: inner,
            youngs_modulus: 206e9,
        });
    }
    if rng.random_bool(0.2) {
        nut.precession = rng.log_uniform(1.0, 600.0);
    }
    nut
}

/// Returns a random support, which is free, guided or elastic. The axial load is at most about half
/// of the dynamic load rating. Transverse loads and moments also act on the nut.
pub(crate) fn support(rng: &mut impl Rng, nut: &BallNut) -> Support {
    // For Z balls, half of C_a is about 250 N/mm² times the square of the ball diameter times
    // Z^0.8.
    let most = 250e6
        * 4.0
        * nut.ball.radius.powi(2)
        * nut.positions().iter().map(|_| 1.0_f64).sum::<f64>().powf(0.8);
    let axial = most * rng.random_range(-1.0..1.0);
    let side = 0.2 * axial.abs();
    let arms = [1.0, 1.0, nut.helix.radius, nut.helix.radius];
    let mut support = Support::guided(axial);
    let kind = rng.random_range(0..3);
    for (freedom, arm) in support.0[1..].iter_mut().zip(arms) {
        let load = side * arm * rng.random_range(-1.0..1.0);
        *freedom = match kind {
            0 => Freedom::Held(0.0),
            1 => Freedom::Loaded(load),
            _ => Freedom::Sprung { stiffness: 1e8 * arm * arm, load },
        };
    }
    support
}

/// Checks that the stiffness equals the slope of the forces as functions of the displacement. The
/// prescribed displacement is a combination of all degrees of freedom.
fn assert_stiffness_equals_slope_of_forces(nut: &BallNut, found: &Equilibrium, point: u32) {
    let radius = nut.helix.radius;
    let arms = [1.0, -1.0, 1.0, 1.0 / radius, -1.0 / radius];
    // The step of one nanometer is small compared with the elastic approaches, which are of the
    // order of micrometers.
    let step = 1e-9;
    let held = |sign: f64| {
        let at = |i: usize| Freedom::Held(found.displacement[i] + sign * step * arms[i]);
        nut.solve(&Support(std::array::from_fn(at)))
    };
    let [above, below] = [1.0, -1.0].map(|sign| {
        held(sign).unwrap_or_else(|error| panic!("{point}, at {:?}: {error}", found.displacement))
    });
    let forces: f64 = found.balls.iter().map(BallInGrooves::max_load).sum();
    for i in 0..5 {
        let arm = arms[i].abs();
        let along =
            |of: &Equilibrium| -> f64 { (0..5).map(|k| of.stiffness[i][k] * arms[k]).sum() };
        let slope = (above.carried[i] - below.carried[i]) / (2.0 * step);
        // The slope is a mean stiffness over the step, because contacts may open or close within
        // the step. In each of about ten equations, the forces are balanced to 1e-12 of their sum.
        let changes = (along(&above) - along(found)).abs() + (along(&below) - along(found)).abs();
        let allowed = changes + 1e-11 * forces / step / arm;
        let off = (slope - along(found)).abs();
        assert!(off <= allowed, "{point}, freedom {i}: {off:e} of {slope:e}, {allowed:e} allowed");
    }
}

/// Solves random nuts. Returns the number of solved nuts, the number of nuts that cannot carry
/// their load, the largest residual and the largest number of steps.
///
/// * `every`: interval `n` for checking stiffnesses: the stiffness of every `n`-th nut is compared
///   with finite differences.
fn solve_random_nuts(points: u32, seed: u64, every: u32) -> (u32, u32, f64, usize) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (mut solved, mut nothing, mut worst, mut most) = (0, 0, 0.0_f64, 0);
    for point in 0..points {
        let nut = nut(&mut rng);
        let support = support(&mut rng, &nut);
        match nut.solve(&support) {
            Ok(found) => {
                solved += 1;
                worst = worst.max(found.residual);
                most = most.max(found.steps);
                for i in 0..5 {
                    for k in 0..i {
                        let k5 = found.stiffness;
                        let size = (k5[i][i] * k5[k][k]).sqrt();
                        // The tolerance allows for rounding errors in a sum over a hundred balls.
                        let off = (k5[i][k] - k5[k][i]).abs();
                        assert!(off <= 1e-9 * size, "{point}: {off:e} of {size:e}");
                    }
                }
                if point % every == 0 {
                    assert_stiffness_equals_slope_of_forces(&nut, &found, point);
                }
                let numbers = found.balls.iter().flat_map(|b| b.loads).chain(found.displacement);
                assert!(numbers.into_iter().all(f64::is_finite), "{point}");
            }
            // In a nut that cannot carry its load, the balls can be loaded on only one flank, or
            // the nut has few balls, all of which are far from the line of action of the load.
            Err(
                NutError::NothingCarries { .. }
                | NutError::BallLeavesFlank { .. }
                | NutError::BallTooLarge { .. },
            ) => nothing += 1,
            Err(other) => panic!("{point}: {other} {nut:?} {support:?}"),
        }
    }
    (solved, nothing, worst, most)
}

/// Solves random nuts, and checks the residuals, the numbers of steps, and the number of nuts that
/// cannot carry their load.
#[expect(clippy::print_stderr, reason = "the campaign prints its counts")]
fn check_campaign(points: u32, seed: u64, every: u32) {
    let (solved, nothing, worst, most) = solve_random_nuts(points, seed, every);
    eprintln!(
        "{solved} solved, {nothing} cannot carry their load, residual {worst:e}, {most} steps at most"
    );
    assert_eq!(solved + nothing, points);
    assert!(worst <= 1e-12 && most <= 60, "{worst:e} {most}");
    // A single flank carries loads in one direction only, so one twelfth of the nuts cannot carry
    // their load. In about one nut out of 25, a ball leaves its flank.
    assert!(nothing < points / 7, "{nothing}");
}

#[test]
fn random_nuts_reach_equilibrium_or_cannot_carry_their_load() {
    check_campaign(1_000, 1, 10);
}

/// To run this test, use `cargo test -p bsm-nut campaign:: -- --ignored --nocapture`.
#[test]
#[ignore = "ten thousand nuts take minutes"]
fn ten_thousand_random_nuts_reach_equilibrium_or_cannot_carry_their_load() {
    check_campaign(10_000, 2026, 1);
}

/// Returns an extreme nut, whose play, oversize, errors, conformities and speeds may be far outside
/// the practical range.
fn extreme_nut(rng: &mut impl Rng) -> BallNut {
    let mut nut = nut(rng);
    let mut conformity = || {
        let least = if rng.random_bool(0.1) { 1e-6 } else { 1e-2 };
        0.5 + rng.log_uniform(least, 0.2)
    };
    nut.conformity = Conformities { nut: conformity(), screw: conformity() };
    nut.contact_angle = rng.random_range(10.0_f64..80.0).to_radians();
    let size = nut.ball.radius;
    if rng.random_bool(0.4) {
        nut.errors.gap = size * rng.log_uniform(1e-5, 3e-2) * [1.0, -1.0][rng.random_range(0..2)];
    }
    if rng.random_bool(0.3) {
        nut.errors.oversize = size * rng.log_uniform(1e-6, 3e-3);
    }
    if rng.random_bool(0.3) {
        let rises = [(); 3].map(|()| rng.random_range(-200.0..200.0));
        nut = nut.warmed(rises, 11.5e-6);
    }
    if rng.random_bool(0.3) {
        nut.precession = rng.log_uniform(1.0, 1e4);
    }
    nut
}

/// Returns a random support with extreme values. Either the loads range over many orders of
/// magnitude, or the displacements are prescribed, with up to one percent of the ball radius and
/// corresponding tilts.
fn extreme_support(rng: &mut impl Rng, nut: &BallNut) -> Support {
    let mut support = support(rng, nut);
    let size = rng.log_uniform(1e-6, 10.0);
    for freedom in &mut support.0 {
        match freedom {
            Freedom::Loaded(load) | Freedom::Sprung { load, .. } => *load *= size,
            Freedom::Held(_) => {}
        }
    }
    if rng.random_bool(0.3) {
        let far = nut.ball.radius * rng.log_uniform(1e-6, 1e-2);
        let arms = [1.0, 1.0, nut.helix.radius, nut.helix.radius];
        for (freedom, arm) in support.0[1..].iter_mut().zip(arms) {
            *freedom = Freedom::Held(far / arm * rng.random_range(-1.0..1.0));
        }
    }
    support
}

/// Returns a description of a defect of an equilibrium, or `None` if the equilibrium has no defect.
/// The check uses only the loads and contact angles of the result.
fn defect_of(nut: &BallNut, support: &Support, found: &Equilibrium) -> Option<String> {
    let (sin_a, cos_a) = nut.helix.lead_angle.sin_cos();
    let outward = nut.ball.mass * nut.helix.radius * nut.precession * nut.precession;
    let middle = nut.reference_position();
    let (mut on_balls, mut forces) = ([0.0; 5], 0.0);
    for (number, (ball, position)) in found.balls.iter().zip(&found.positions).enumerate() {
        // The forces of each body on the ball are summed along binormal and principal normal.
        let (mut of_body, mut size) = ([[0.0; 2]; 2], outward);
        for c in 0..4 {
            let (load, angle) = (ball.loads[c], ball.angles[c]);
            if load < 0.0 || !load.is_finite() {
                return Some(format!("tension: ball {number} carries {load:e} N"));
            }
            if load == 0.0 {
                continue;
            }
            // Contact angles must be within the limits of a flank, with a tolerance for rounding
            // errors of the position.
            if !(-1e-6..=0.5 * PI + 1e-6).contains(&angle) {
                return Some(format!("ball {number} is at {:.3} deg", angle.to_degrees()));
            }
            let (flank, body) = ([1.0, -1.0][c % 2], [1.0, -1.0][c / 2]);
            of_body[c / 2][0] += body * flank * load * angle.sin();
            of_body[c / 2][1] += body * load * angle.cos();
            size += load;
        }
        let left = (of_body[0][0] + of_body[1][0]).hypot(of_body[0][1] + of_body[1][1] - outward);
        // The solver balances the forces on a ball to 1e-7 of the forces, or to within the effect
        // of rounding errors in the position, which is below 1e-6 of the forces in this test.
        if left > 1e-6 * size {
            return Some(format!("ball {number} is out of balance by {:e}", left / size));
        }
        forces += size;
        let [along, across] = of_body[0];
        let (sin, cos) = position.theta.sin_cos();
        let force = [
            along * sin_a * sin - across * cos,
            -along * sin_a * cos - across * sin,
            along * cos_a,
        ];
        let radius = nut.helix.radius;
        let arm = [radius * cos, radius * sin, position.z - middle];
        on_balls[0] += force[2];
        on_balls[1] += force[0];
        on_balls[2] += force[1];
        on_balls[3] += arm[1] * force[2] - arm[2] * force[1];
        on_balls[4] += arm[2] * force[0] - arm[0] * force[2];
    }
    let arms = [1.0, 1.0, 1.0, nut.helix.radius, nut.helix.radius];
    for (i, freedom) in support.0.iter().enumerate() {
        let load = match *freedom {
            Freedom::Held(_) => continue,
            Freedom::Loaded(load) => load,
            Freedom::Sprung { stiffness, load } => load - stiffness * found.displacement[i],
        };
        // The solver stops at a residual of 1e-12 of the sum of all forces, or of 1e-10 if the
        // bodies deform strongly.
        let left = (on_balls[i] - load).abs() / arms[i];
        if left > 1e-6 * (forces + load.abs() / arms[i]) {
            return Some(format!("freedom {i} is out of balance by {left:e} of {forces:e} N"));
        }
    }
    None
}

/// Checks that each extreme nut is either rejected with a reason, or is in equilibrium according to
/// its loads and contact angles. Prints the number of rejected nuts and the number of nuts in
/// equilibrium.
#[expect(clippy::print_stderr, reason = "the campaign prints its counts")]
fn check_extreme_campaign(points: u32, seed: u64) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (mut solved, mut refused) = (0, [0; 5]);
    for point in 0..points {
        let nut = extreme_nut(&mut rng);
        let support = extreme_support(&mut rng, &nut);
        match nut.solve(&support) {
            Ok(found) => {
                solved += 1;
                let wrong = defect_of(&nut, &support, &found);
                assert!(
                    wrong.is_none(),
                    "{point}: {} {nut:?} {support:?}",
                    wrong.unwrap_or_default()
                );
            }
            Err(NutError::NothingCarries { .. }) => refused[0] += 1,
            Err(NutError::BallLeavesFlank { .. }) => refused[1] += 1,
            Err(NutError::NotConverged { residual, .. }) => {
                assert!(residual.is_finite(), "{point}");
                refused[2] += 1;
            }
            Err(NutError::BallNotBalanced { .. }) => refused[3] += 1,
            Err(NutError::BallTooLarge { .. }) => refused[4] += 1,
            Err(other) => panic!("{point}: {other} {nut:?} {support:?}"),
        }
    }
    let [nothing, leaves, not_converged, ball, large] = refused;
    eprintln!(
        "{solved} in equilibrium; {nothing} cannot carry their load, a ball leaves its flank in \
         {leaves}, {not_converged} not converged, a ball is not balanced in {ball} and too large in \
         {large}"
    );
    // At least one third of the nuts must be able to carry their load.
    assert!(3 * solved >= points, "{solved} of {points}");
}

#[test]
fn extreme_nuts_are_in_equilibrium_or_rejected() {
    check_extreme_campaign(300, 37);
}

/// To run this test, use `cargo test -p bsm-nut campaign:: -- --ignored --nocapture`.
#[test]
#[ignore = "three thousand nuts take ten times as long as three hundred"]
fn three_thousand_extreme_nuts_are_in_equilibrium_or_rejected() {
    check_extreme_campaign(3_000, 1937);
}
