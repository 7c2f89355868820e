//! Tests of the elastic model: the roots on the equilibrium curve are compared with the seven
//! equations, with limiting cases, and with searches from many starting values.

use std::f64::consts::{FRAC_PI_2, PI};

use approx::assert_relative_eq;
use bsm_sample::Sample;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use bsm_newton::Convergence;

use super::*;
use crate::extreme::random_extreme_screw;
use crate::{Status, angles::Angles};

/// Returns random starting values of the unknowns (S1) for which the nut contact carries the axial
/// load.
fn random_start(contacts: &ElasticContacts, rng: &mut impl Rng) -> Option<[f64; BALL_UNKNOWNS]> {
    let (sin, cos) = contacts.helix.lead_angle.sin_cos();
    let friction = contacts.directed_friction();
    let mut log = |low: f64, high: f64| rng.log_uniform(low, high);
    let (mu, spread) = (contacts.inertia_ratio(), log(1e-9, 1.0));
    let (circling, slip, noise) = (log(1e-9, 1e3), log(1e-4, 30.0), log(1e-4, 1.0));
    let nut = rng.random_range(0.0..FRAC_PI_2);
    let tilt = 0.5 * spread * rng.random_range(-0.2..1.0) * (FRAC_PI_2 - nut);
    // The slip direction is the direction of (R12) plus random noise.
    let along = (sin / cos).atan2(nut.cos()) + noise * rng.random_range(-PI..PI);
    let effect = nut.sin() * cos - friction * (along.cos() * cos * nut.cos() + along.sin() * sin);
    let load = effect.recip();
    // The precession rate is either drawn from a range of a few times the relative speed W or
    // calculated from a random centrifugal force.
    let rate = if rng.random_bool(0.5) {
        rng.random_range(-1.5..2.0) + contacts.scaled.nut_speed
    } else {
        (circling / mu).sqrt() * if rng.random_bool(0.5) { 1.0 } else { -1.0 }
    };
    let mut y = [0.0; BALL_UNKNOWNS];
    y[NUT_LOAD] = load;
    y[SCREW_LOAD] = load * (1.0 + spread * rng.random_range(-1.0..0.2));
    y[TILT] = tilt;
    y[PRECESSION] = rate - contacts.scaled.nut_speed;
    y[SLIP] = contacts.scaled.arc * slip;
    y[SLIP_ANGLE] = along;
    y[SPIN] = -2.0 * friction * load * along.sin() / sin * rng.random_range(0.5..1.5);
    (load > 0.0).then_some(y)
}

/// Searches from random starting values for an admissible root of the seven equations, and returns
/// the root or `None`.
fn root_from_random_starts(
    contacts: &ElasticContacts,
    starts: usize,
    rng: &mut impl Rng,
    newton: &mut Workspace,
) -> Option<[f64; BALL_UNKNOWNS]> {
    (0..starts).find_map(|_| {
        let mut y = random_start(contacts, rng)?;
        let scales = Scales { x: &[1.0; BALL_UNKNOWNS], f: &weights(contacts, &y) };
        let convergence =
            Convergence { residual_tol: 1e-11, max_steps: 60, ..Convergence::default() };
        let options = Options { convergence, ..Options::default() };
        let report = solve(&GrossSlipEquations(contacts), &mut y, &scales, &options, newton);
        let state = GrossSlipEquations(contacts).state(&y).ok()?;
        let flanks = state.loaded.angles.iter().all(|angle| (0.0..FRAC_PI_2).contains(angle));
        // With the weights of the starting value, any state with P → 0 or P → ∞ would look like a
        // root. Therefore, the residuals are compared with the forces at the final state: the
        // moments with the friction force, and the moment about the mean normal with the inertia
        // force.
        let residual = GrossSlipEquations(contacts).residual(&y).ok()?;
        let load = y[NUT_LOAD].max(y[SCREW_LOAD]);
        let force = load
            .max(contacts.inertia_ratio() * (y[PRECESSION] + contacts.scaled.nut_speed).powi(2));
        let is_root = [0, 1, 2, 6].into_iter().all(|i| residual[i].abs() < 1e-9 * force)
            && [3, 5].into_iter().all(|i| residual[i].abs() < 1e-6 * contacts.friction * load)
            && (residual[MOMENT[1]] * weights(contacts, &y)[MOMENT[1]]).abs() < 1e-6;
        // If the slip is smaller than the rounding error of the moment about N (R23), its direction
        // is undefined.
        let rate = y[PRECESSION] + contacts.scaled.nut_speed;
        let resolved =
            contacts.inertia_ratio() * rate * rate > 1e-9 * contacts.friction && y[SLIP] > 1e-6;
        (report.converged() && is_root && y[SLIP] > 0.0 && flanks && resolved).then_some(y)
    })
}

/// Numbers of operating points at which random searches confirm or refute the result of the model.
#[derive(Debug, Default)]
struct Tally {
    no_solution: usize,
    found: usize,
    seen: usize,
    refuted: Vec<(ElasticPoint, Reason, [f64; BALL_UNKNOWNS])>,
}

/// Runs random searches at `points` points with a solution and at the same number of points without
/// a solution.
fn compare_with_random_searches(seed: u64, points: usize, starts: usize) -> Tally {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut newton = Workspace::default();
    let mut tally = Tally::default();
    while tally.no_solution < points || tally.found < points {
        let screw = random_extreme_screw(&mut rng);
        let Ok(contacts) = screw.scaled() else { continue };
        // The random search cannot resolve the roots of balls with very small inertia.
        if contacts.inertia_ratio() < 1e-8 * contacts.friction {
            continue;
        }
        match find(&contacts, &mut newton) {
            Err(failure)
                if failure.status() == Status::NoSolution && tally.no_solution < points =>
            {
                tally.no_solution += 1;
                if let Some(y) = root_from_random_starts(&contacts, starts, &mut rng, &mut newton) {
                    tally.refuted.push((screw, failure.reason().clone(), y));
                }
            }
            Ok((y, ..)) if tally.found < points => {
                let rate = y[PRECESSION] + contacts.scaled.nut_speed;
                if contacts.inertia_ratio() * rate * rate > 1e-9 * contacts.friction {
                    tally.found += 1;
                    let seen = root_from_random_starts(&contacts, starts, &mut rng, &mut newton);
                    tally.seen += usize::from(seen.is_some());
                }
            }
            _ => {}
        }
    }
    tally
}

/// If there is no solution, random starting values lead to no root; otherwise they usually lead to
/// a root.
#[test]
fn random_starts_find_no_root_where_there_is_no_solution() {
    let tally = compare_with_random_searches(12, 12, 100);
    assert!(tally.refuted.is_empty(), "{tally:#?}");
    assert!(tally.seen * 2 > tally.found, "{tally:?}");
}

#[test]
#[ignore = "takes minutes: 1000 points with 1000 starting values each"]
fn thousands_of_random_starts_find_no_root_where_there_is_no_solution() {
    let tally = compare_with_random_searches(2026, 500, 1000);
    println!(
        "{} no_solution, {} refuted, {} of {} seen",
        tally.no_solution,
        tally.refuted.len(),
        tally.seen,
        tally.found
    );
    assert!(tally.refuted.is_empty(), "{:#?}", tally.refuted);
}

/// In the limit of small inertia, the root agrees with the first-order solution.
#[test]
fn root_at_small_inertia_agrees_with_the_first_order_solution() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let mut newton = Workspace::default();
    let mut tried = 0;
    while tried < 300 {
        let Ok(contacts) = random_extreme_screw(&mut rng).scaled() else { continue };
        let contacts = contacts.with_inertia(1e-12 / contacts.inertia_ratio());
        let Ok((y, ..)) = find(&contacts, &mut newton) else { continue };
        let loaded = GrossSlipEquations(&contacts).state(&y).expect("a root").loaded;
        let (alpha, beta) = (contacts.helix.lead_angle, loaded.angles[0] + y[TILT]);
        let ((sin_a, cos_a), (sin_b, cos_b)) = (alpha.sin_cos(), beta.sin_cos());
        let angles = Angles { lead: alpha, contact: beta };
        let (signed, load) = (contacts.directed_friction(), y[NUT_LOAD]);
        // tanψ = tanα/cosβ                                                (R12)
        let d = angles.slip_factor();
        let (sin_psi, cos_psi) = (sin_a / cos_a / d, cos_b / d);
        // p = 1/2 − (r_b cosα / 2 r_m)(cosα cosβ + sinα tanψ)             (R13)
        let lever = cos_a * cos_b + sin_a * sin_a / (cos_a * cos_b);
        let rigid = 0.5 - 0.5 * cos_a * lever / contacts.helix.radius;
        // γ = sinβ − F (cosβ + F cosψ sinβ)/[cosψ (1 + F²)]               (S7)
        let gamma = sin_b
            - signed * (cos_b + signed * cos_psi * sin_b) / (cos_psi * (1.0 + signed * signed));
        // g = (5/2) F γ / D,  p = (p_R + g Ω_n/W)/(1 − g)                 (S8)
        let g = 2.5 * signed * gamma / d;
        let p = (rigid + g * contacts.scaled.nut_speed) / (1.0 - g);
        let rate = p + contacts.scaled.nut_speed;
        let inertia = contacts.inertia_ratio() * rate * rate;
        // Near resonance (g = 1) and near self-locking, the first-order solution is valid only for
        // smaller inertia.
        if inertia > 1e-8 || (1.0 - g).abs() < 0.1 || load > 20.0 || cos_b < 0.05 {
            continue;
        }
        // ν = m r_m P² γ / (2 Q)                                          (S9)
        let tilt = 0.5 * inertia * gamma / load;
        // λ = p_R d T / (cosψ + T sinψ),  T = tanα/cosβ                   (S10)
        let tangent = sin_a / (cos_a * cos_b);
        let slip = tangent * contacts.scaled.arc * rigid / (cos_psi + tangent * sin_psi);
        // The relative error of the first-order solution is of the order of the inertia (at most
        // 1e-8), divided by the smallest cosine and by the resonance term.
        let close = |x: f64, y: f64| {
            assert_relative_eq!(x, y, max_relative = 1e-4, epsilon = 1e-4 * inertia);
        };
        close(y[PRECESSION], p);
        close(y[TILT], tilt);
        close(y[SLIP], slip);
        close(y[SLIP_ANGLE], sin_psi.atan2(cos_psi));
        // s = −2 F q cosψ / (cosα cosβ)                                       (R20)
        close(y[SPIN], -2.0 * signed * load / (d * cos_a));
        tried += 1;
    }
}

/// In an earlier version, points with P → 0 or P → ∞ were accepted as roots, because their residual
/// vanished with the weights of the starting value. At a root on the equilibrium curve, the
/// precession rate must match the centrifugal force.
#[test]
fn precession_of_a_root_matches_its_centrifugal_force() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let mut newton = Workspace::default();
    for _ in 0..300 {
        let Ok(contacts) = random_extreme_screw(&mut rng).scaled() else { continue };
        let Ok((y, ..)) = find(&contacts, &mut newton) else { continue };
        let state = GrossSlipEquations(&contacts).state(&y).expect("a root");
        let rate = y[PRECESSION] + contacts.scaled.nut_speed;
        // The centrifugal force is the difference between the radial components of the loads.
        let held = state.wrench[0].force + state.wrench[1].force;
        let held = held.dot(&state.loaded.frame.n) / contacts.inertia_ratio();
        let rounding = 1e-13 * y[NUT_LOAD] / contacts.inertia_ratio();
        assert_relative_eq!(held, rate * rate, max_relative = 1e-9, epsilon = rounding);
        assert!(rate.abs() > 0.0 && rate.is_finite());
    }
}

/// If the nut and the screw rotate at nearly equal speeds, the inertia ratio on the equilibrium
/// curve underflows. An earlier version found no solution in this case.
#[test]
fn solution_exists_if_nut_and_screw_rotate_at_nearly_equal_speeds() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let mut work = ElasticWorkspace::default();
    let mut converged = 0;
    for _ in 0..1000 {
        let mut screw = random_extreme_screw(&mut rng);
        let speed = screw.point.drive.relative_speed();
        let apart = rng.log_uniform(1e-12, 0.1);
        screw.point.drive = bsm_kin::Drive { screw_speed: speed, nut_speed: speed * (1.0 - apart) };
        let solution = Elastic { screw }.solve(&mut work);
        converged += usize::from(solution.status() == Status::Converged);
        if let Some(Reason::NoSkidAtInertia { inertia_ratio, min, max }) = solution.reason() {
            assert!(!(min..=max).contains(&inertia_ratio), "{inertia_ratio} {min} {max} {screw:?}");
        }
    }
    assert!(converged > 200, "{converged}");
}
