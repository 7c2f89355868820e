//! Tests that elastic models agree in their common limiting cases, and tests of their failures.

use super::screws::{inertia_ratio, lin, real_screws, with};
use approx::assert_relative_eq;
use bsm_dyn::{
    Ball, Conformities, Coulomb, ElasticPoint, Materials, Model, ModelWorkspace, Reason, Solution,
    Status, SteadyState,
    model::{
        Auto, Elastic, ElasticWorkspace, RacewayControl, RacewayWorkspace, Traction,
        TractionWorkspace,
    },
};
use proptest::prelude::*;

fn expect_solution(solution: Solution) -> SteadyState {
    solution.result.expect("a solution")
}

fn with_friction(friction: f64, screw: ElasticPoint) -> ElasticPoint {
    with(screw, |screw| screw.point.friction = Coulomb(friction))
}

fn onset_number(solution: &Solution) -> Option<f64> {
    solution.steady_state()?.skid?.onset_number()
}

fn traction(screw: ElasticPoint, accuracy: f64, creep: f64) -> SteadyState {
    let case = Traction { screw, accuracy, creep };
    expect_solution(case.solve(&mut TractionWorkspace::default()))
}

fn solve_elastic(screw: ElasticPoint) -> SteadyState {
    expect_solution(Elastic { screw }.solve(&mut ElasticWorkspace::default()))
}

/// At small inertia, the efficiency of the elastic model equals the closed form at the loaded
/// contact angle, with a tolerance of 2e-5.
#[test]
fn elastic_model_equals_the_closed_form_at_the_loaded_contact_angle() {
    for screw in [lin(10.0, 45.0, 2000.0, 2113.0), lin(20.0, 30.0, 2000.0, 200.0)] {
        let o = solve_elastic(screw);
        let loaded = 0.5 * (o.ball.nut.angle + o.ball.screw.angle);
        let angles =
            bsm_dyn::angles::Angles { lead: screw.point.helix.lead_angle, contact: loaded };
        let direction = bsm_dyn::Direction::RotaryToLinear;
        let eta = angles.efficiency(direction, screw.point.friction.0);
        assert_relative_eq!(o.transmission.efficiency, eta, epsilon = 2e-5);
    }
}

/// If the ball rolls and friction is too small to change the contact angles, traction agrees with
/// raceway control. The difference between the losses, divided by the loss, is of the order of the
/// friction coefficient.
#[test]
fn traction_agrees_with_raceway_control_for_rolling_balls() {
    let (mut memory, mut tried, mut apart) = (RacewayWorkspace::default(), 0, 0);
    let calm = |screw: &ElasticPoint| {
        screw.point.friction.0 < 0.03 && screw.point.helix.lead_angle > 10.0_f64.to_radians()
    };
    for screw in real_screws(31).filter(calm).take(400) {
        let rolling = RacewayControl { screw, control: None }.solve(&mut memory);
        if onset_number(&rolling).is_some_and(|s| s < 0.03) {
            tried += 1;
            let o = traction(screw, 1e-8, 1e-4);
            let difference = rolling.efficiency().expect("a root") - o.transmission.efficiency;
            apart += usize::from(difference.abs() > 1e-3);
        }
    }
    assert!(tried > 150, "{tried}");
    // In a larger sample of random screws, the efficiencies of raceway control and traction agree
    // at 98.6 % of the points.
    assert!(apart * 100 <= 3 * tried, "{apart} of {tried}");
}

/// If the ball skids, the traction model agrees with the elastic model, in which friction is
/// saturated.
#[test]
fn traction_agrees_with_elastic_for_skidding_balls() {
    let mut memory = RacewayWorkspace::default();
    let mut tried = 0;
    for screw in real_screws(32).filter(|screw| inertia_ratio(screw) < 1.0).take(2000) {
        let rolling = RacewayControl { screw, control: None }.solve(&mut memory);
        if onset_number(&rolling).is_some_and(|s| s > 3.0) {
            tried += 1;
            let difference = solve_elastic(screw).transmission.efficiency
                - traction(screw, 1e-8, 1e-4).transmission.efficiency;
            assert!(difference.abs() <= 5e-3, "{screw:?} {difference}");
        }
    }
    assert!(tried >= 20, "{tried}");
}

/// The onset number separates rolling balls from sliding balls at every lead angle; the skid number
/// does not.
#[test]
fn onset_number_separates_rolling_from_sliding() {
    let (mut rolling, mut sliding) = (RacewayWorkspace::default(), ElasticWorkspace::default());
    let mut points = Vec::new();
    for screw in real_screws(33).take(4000) {
        let rolling_ball = RacewayControl { screw, control: None }.solve(&mut rolling);
        let skid = Elastic { screw }.solve(&mut sliding);
        let (Some(g), Some(s)) = (rolling_ball.efficiency(), skid.efficiency()) else { continue };
        let numbers = rolling_ball
            .steady_state()
            .and_then(|rolling_ball| rolling_ball.skid)
            .expect("raceway control");
        // If spin causes almost all of the loss, the efficiency of raceway control is not a useful
        // reference.
        if numbers.cross_slip.is_some_and(|chi| chi > 0.7) {
            let share = (g - traction(screw, 1e-6, 1e-4).transmission.efficiency) / (g - s);
            let [skid, onset] = [numbers.skid_number, numbers.onset_number()];
            points.push((skid.expect("G"), onset.expect("S"), share));
        }
    }
    let shares = |belongs: &dyn Fn(f64, f64) -> bool| {
        let mut shares: Vec<_> =
            points.iter().filter(|(g, s, _)| belongs(*g, *s)).map(|p| p.2).collect();
        shares.sort_by(f64::total_cmp);
        let at = |percent: usize| shares[shares.len() * percent / 100];
        (shares.len(), at(1), at(50), at(99))
    };
    for (low, high) in [(0.0, 0.1), (0.1, 0.2), (0.2, 0.5), (0.5, 1.0), (1.0, 2.0), (2.0, 1e9)] {
        println!("S in {low}-{high}: {:.3?}", shares(&|_, s| (low..high).contains(&s)));
    }
    println!("G in 0.05-0.2: {:.3?}", shares(&|g, _| (0.05..0.2).contains(&g)));
    // `share` is 0 for rolling balls and 1 for sliding balls. Friction changes the contact angles,
    // which changes `share` by about 2 %.
    let (_, low, _, high) = shares(&|_, s| s < 0.1);
    assert!(low > -0.03 && high < 0.03, "{low} {high}");
    assert!(shares(&|_, s| s > 2.0).1 > 0.9);
    let (_, low, _, high) = shares(&|g, _| (0.05..0.2).contains(&g));
    assert!(low < 0.05 && high > 0.8, "{low} {high}");
}

/// Results do not depend on the units of length and force, so a scaled screw has the same motion.
#[test]
fn screw_scaled_in_length_and_force_has_the_same_dimensionless_motion() {
    let screw = lin(10.0, 45.0, 6000.0, 20.0);
    let large = with(screw, |ElasticPoint { point, .. }| {
        point.helix.radius *= 3.0;
        point.ball.radius *= 3.0;
        point.ball.mass *= 3.0;
        point.load.axial *= 9.0;
    });
    for (one, other) in [
        (traction(screw, 1e-6, 1e-4), traction(large, 1e-6, 1e-4)),
        (solve_elastic(screw), solve_elastic(large)),
    ] {
        // The two screws are identical in scaled units, so their results differ only by rounding
        // errors.
        assert_relative_eq!(
            one.transmission.efficiency,
            other.transmission.efficiency,
            max_relative = 1e-11
        );
        assert_relative_eq!(
            one.ball.motion.expect("omega").omega.y,
            other.ball.motion.expect("omega").omega.y,
            max_relative = 1e-9
        );
    }
}

/// Operating points without a solution report the correct reason, such as self-locking or a ball
/// that leaves its flank.
#[test]
fn points_without_a_solution_report_the_correct_reason() {
    let drive = bsm_kin::Drive { screw_speed: 10.0, nut_speed: 10.0 };
    let still = with(lin(10.0, 45.0, 1.0, 100.0), |screw| screw.point.drive = drive);
    let smooth = with_friction(0.0, lin(10.0, 45.0, 100.0, 100.0));
    for (screw, reason) in [(still, Reason::NoRelativeSpeed), (smooth, Reason::Frictionless)] {
        let solutions = [
            Elastic { screw }.solve(&mut ElasticWorkspace::default()),
            Traction { screw, accuracy: 1e-4, creep: 1e-4 }
                .solve(&mut TractionWorkspace::default()),
        ];
        for solution in solutions {
            assert_eq!(solution.status(), Status::InvalidInput);
            assert_eq!(solution.reason(), Some(&reason));
            assert!(solution.efficiency().is_none());
        }
    }
    // Friction holds any load, because sin β = 0.71 is less than f D = 1.08.
    let locked = with_friction(0.5, lin(64.0, 45.0, 2000.0, 100.0));
    let solution = Elastic { screw: locked }.solve(&mut ElasticWorkspace::default());
    assert_eq!(solution.status(), Status::NoSolution);
    assert!(matches!(solution.reason(), Some(Reason::SelfLocking { .. })), "{solution:?}");
}

/// In an earlier version, roots at a millionth of practical speeds were obtained by extrapolation
/// and violated the power balance.
#[test]
fn power_balance_holds_at_very_low_speed_with_saturated_friction() {
    for rpm in [1e-1, 1e-3, 1e-5, 1e-7] {
        let screw = with_friction(0.39, lin(16.0, 50.0, -rpm, 3e3));
        let balance = solve_elastic(screw).transmission.power_balance.expect("a balance of forces");
        assert!(balance.abs() <= 1e-10, "{rpm} rpm: {balance}");
    }
}

/// If the branch of roots that begins at small inertia ends in a fold, another root may exist
/// further along the curve. Above the largest inertia on the curve, there is no root.
#[test]
fn no_solution_exists_above_the_largest_inertia_on_the_solution_curve() {
    let mut work = ElasticWorkspace::default();
    let (mut roots, mut most) = (0, 0.0);
    for step in 0..200 {
        let screw = lin(10.0, 45.0, 500.0 * 1.05_f64.powi(step), 20.0);
        let inertia = inertia_ratio(&screw);
        let solution = Elastic { screw }.solve(&mut work);
        match solution.reason() {
            None => (roots, most) = (roots + 1, inertia),
            Some(Reason::NoSkidAtInertia { max, inertia_ratio: own, .. }) => {
                assert_eq!(solution.status(), Status::NoSolution);
                assert!(*own > *max, "{own} {max}");
            }
            other => panic!("{other:?}"),
        }
    }
    assert!(roots > 50 && most > 0.5, "{roots} {most}");
}

/// In an earlier version, the iteration that started from small inertia lost its root at a very
/// small load. The ball still slides, but orbits very slowly.
#[test]
fn a_ball_under_very_small_load_slides() {
    let screw = lin(10.0, 45.0, 60_000.0, 1.0);
    let o = solve_elastic(screw);
    assert!(o.ball.motion.expect("P").precession.abs() < 0.1 * screw.point.drive.screw_speed);
    assert!(o.transmission.power_balance.expect("a balance of forces").abs() <= 1e-10);
}

/// An earlier version rejected a very soft material as invalid input if the contact angle
/// approached 90 deg under load. At such a contact angle, the ball would travel against the drive.
#[test]
fn a_very_soft_screw_has_no_solution() {
    let soft = bsm_dyn::Material { youngs_modulus: 1e7, poisson_ratio: 0.3 };
    let screw = ElasticPoint { material: Materials::alike(soft), ..lin(10.0, 45.0, 2000.0, 1e6) };
    let solution = Elastic { screw }.solve(&mut ElasticWorkspace::default());
    assert_eq!(solution.status(), Status::NoSolution);
    assert!(matches!(solution.reason(), Some(Reason::SlipAlongFriction { .. })), "{solution:?}");
}

/// In an earlier version, the solver panicked if the friction was smaller than the rounding errors
/// of the loads.
#[test]
fn friction_below_the_rounding_error_of_the_loads_is_treated_as_zero() {
    let screw = with_friction(1e-310, lin(10.0, 45.0, 2000.0, 2113.0));
    let case = Traction { screw, accuracy: 1e-4, creep: 1e-4 };
    let solution = case.solve(&mut TractionWorkspace::default());
    assert_eq!(solution.reason(), Some(&Reason::Frictionless));
    // Without friction, the skid number must be `None`, not infinite.
    let rolling = RacewayControl { screw: with_friction(0.0, screw), control: None };
    let o = expect_solution(rolling.solve(&mut RacewayWorkspace::default()));
    let skid = o.skid.expect("raceway control");
    assert_eq!((skid.skid_number, skid.onset_number()), (None, None));
}

/// An earlier version accepted roots with contact angles below 0 or above 90 deg as converged.
#[test]
fn root_beyond_the_flank_is_not_a_solution() {
    let solution = Traction { screw: lin(5.0, 45.0, -30_000.0, 5.0), accuracy: 1e-6, creep: 1e-4 }
        .solve(&mut TractionWorkspace::default());
    assert_eq!(solution.status(), Status::NoSolution);
    let Some(Reason::BallLeavesFlank { nut, .. }) = solution.reason() else {
        panic!("{solution:?}")
    };
    assert!(*nut < 0.0, "{nut}");
}

/// In an earlier version, the slip at the screw lost accuracy at low speed, because large terms
/// with the spin, which is of order 1/P, canceled. As a result, an accurate root violated the power
/// balance.
#[test]
fn power_balance_holds_at_low_speed_with_saturated_friction() {
    for rpm in [300.0, 30.0, 3.0] {
        let screw = with_friction(0.15, lin(1.1, 55.0, rpm, 3000.0));
        let screw = ElasticPoint { conformity: Conformities { nut: 0.52, screw: 0.56 }, ..screw };
        let balance = solve_elastic(screw).transmission.power_balance.expect("a balance of forces");
        assert!(balance.abs() <= 1e-9, "{rpm} rpm: {balance}");
    }
}

/// An earlier version did not report that a tolerance could not be met.
#[test]
fn auto_reports_an_error_bound_above_the_tolerance_if_the_tolerance_is_unattainable() {
    let screw = lin(10.0, 45.0, 2000.0, 2113.0);
    let exact = Auto { screw, tolerance: 1e-9 }.solve(&mut ModelWorkspace::default());
    let (choice, solved) =
        (exact.choice.expect("a choice"), exact.steady_state().expect("converged"));
    assert!(solved.error.expect("a bound").efficiency > choice.tolerance);
}

/// In an earlier version, raceway control claimed an error of at most 3.6e-3 relative to traction.
/// However, traction has no solution at these points, because friction would rotate the contact
/// angle at the screw to 90.05 and 92.0 deg.
#[test]
fn auto_reports_no_error_bound_where_traction_has_no_solution() {
    let mut work = ModelWorkspace::default();
    // The closure returns the feed drive that is used in the examples, with a given contact angle.
    let feed_drive = |contact_angle: f64| {
        let lead = (20.0 / (41.5 * std::f64::consts::PI)).atan().to_degrees();
        with(with_friction(0.06, lin(lead, contact_angle, 1500.0, 8000.0)), |screw| {
            screw.point.helix.radius = 20.75e-3;
            screw.point.ball = Ball::of_density(3.175e-3, 7800.0);
            screw.point.load.balls = 70.0;
        })
    };
    for contact_angle in [87.0, 89.0] {
        let at = feed_drive(contact_angle);
        let traction = Traction { screw: at, accuracy: 1e-8, creep: Traction::<f64>::CREEP };
        let traction = traction.solve(&mut TractionWorkspace::default());
        assert_eq!(traction.status(), Status::NoSolution, "{contact_angle}");
        let auto = Auto { screw: at, tolerance: 0.01 }.solve(&mut work);
        assert!(auto.steady_state().expect("a rolling ball").error.is_none(), "{contact_angle}");
    }
    // At these contact angles, friction does not rotate the contacts beyond the ends of their
    // flanks.
    for contact_angle in [20.0, 45.0, 80.0] {
        let auto = Auto { screw: feed_drive(contact_angle), tolerance: 0.01 }.solve(&mut work);
        assert_eq!(auto.model, Model::RacewayControl, "{contact_angle}");
        assert!(auto.steady_state().expect("a rolling ball").error.is_some(), "{contact_angle}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Friction increases the torque if the screw drives, and decreases the torque if the load
    /// back-drives the screw. The models `traction` and `elastic` satisfy the power balance in both
    /// cases.
    #[test]
    fn friction_causes_a_power_loss_and_power_balance_holds(
        lead in 2.0..30.0_f64, beta in 35.0..55.0_f64, rpm in 100.0..3000.0_f64,
        axial in 20.0..3000.0_f64, back in any::<bool>(),
    ) {
        let screw = lin(lead, beta, if back { -rpm } else { rpm }, axial);
        for o in [traction(screw, 1e-4, 1e-4), solve_elastic(screw)] {
            let torque = o.transmission.screw_torque.expect("torque");
            let speed = screw.point.drive.relative_speed();
            let ideal = axial * screw.point.helix.radius * screw.point.helix.lead_angle.tan();
            // Friction always causes a power loss.
            prop_assert!((torque - ideal) * speed > 0.0);
            // The tolerance follows from the residual of the equations, which is at most 1e-10. The
            // error of the power balance is given relative to the input power.
            prop_assert!(o.transmission.power_balance.expect("a balance of forces").abs() <= 1e-10);
            prop_assert!(o.info.expect("an iteration").residual <= 1e-10);
        }
    }

    /// Only the relative speed matters if inertia is negligible, so a slow nut drive has the same
    /// efficiency as a slow screw drive.
    #[test]
    fn slow_nut_drive_and_slow_screw_drive_have_equal_efficiency(axial in 50.0..2000.0_f64, rpm in 1.0..20.0_f64) {
        let driven = lin(10.0, 45.0, rpm, axial);
        let speed = driven.point.drive.screw_speed;
        let drive = bsm_kin::Drive { screw_speed: 0.0, nut_speed: -speed };
        let turned = with(driven, |screw| screw.point.drive = drive);
        let eta = |screw| traction(screw, 1e-6, 1e-4).transmission.efficiency;
        // The ratio of inertia force to friction force is at most 2e-6 for these screws.
        prop_assert!((eta(driven) - eta(turned)).abs() <= 1e-6);
    }
}
