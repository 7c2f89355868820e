//! Tests of the rigid model: identities, limiting cases, invariances and expected failures.

use approx::assert_relative_eq;
use bsm_dyn::{
    Ball, Coulomb, Direction, Evidence, Load, OperatingPoint, Reason, Solution, Status,
    SteadyState,
    angles::Angles,
    model::{Rigid, RigidWorkspace},
};
use bsm_kin::{BallFrame, Contact, Drive, Helix, Site};
use nalgebra::Vector3;
use proptest::prelude::*;

use crate::elastic::screws;

/// Returns Lin's operating point: 2000 rpm, lead angle 10°, contact angle 45°, 2113 N on one ball.
fn lin() -> OperatingPoint {
    screws::lin(10.0, 45.0, 2000.0, 2113.0).point
}

fn expect_solution(case: &OperatingPoint) -> SteadyState {
    let solution = Rigid { point: *case }.solve(&mut RigidWorkspace::default());
    solution.result.unwrap_or_else(|failure| panic!("{case:?} {failure:?}"))
}

fn status_and_reason(case: &OperatingPoint) -> (Status, Reason) {
    let none = Rigid { point: *case }
        .solve(&mut RigidWorkspace::default())
        .result
        .expect_err("no solution");
    (none.status(), none.reason().clone())
}

/// The root satisfies the published equations as printed, with components along (t, n, b) and in SI
/// units. The test calculates forces and moments independently of the model, and friction from the
/// slip velocities.
#[test]
fn root_satisfies_the_published_equations() {
    for (screw, nut) in [(209.4, 0.0), (-209.4, 0.0), (0.0, -209.4), (314.0, -105.0)] {
        let case = OperatingPoint { drive: Drive { screw_speed: screw, nut_speed: nut }, ..lin() };
        let o = expect_solution(&case);
        let motion = o.ball.motion.expect("a motion");
        let (a, b) = (case.helix.lead_angle, case.contact_angle);
        let (r_m, r_b, f_a) = (case.helix.radius, case.ball.radius, case.load.per_ball());
        let frame = BallFrame::turned(a, 0.0);
        let (mut force, mut moment, mut nut_force) =
            (Vector3::zeros(), Vector3::zeros(), Vector3::zeros());
        for (site, told, speed) in [
            (Site::Nut, o.ball.nut, nut),
            (Site::NutUnloaded, o.ball.unloaded.expect("a contact on the unloaded flank"), nut),
            (Site::Screw, o.ball.screw, screw),
        ] {
            let contact = Contact::new(site, b, &frame);
            let r = contact.normal * -r_b;
            let v = motion.relative_to(speed, &frame).slip_velocity(r_m / a.cos(), &r);
            let psi = (-v.x).atan2(-v.dot(&contact.transverse));
            let friction = contact.transverse * psi.cos() + Vector3::x() * psi.sin();
            let total = (contact.normal + friction * case.friction.0) * told.load.expect("a load");
            force += total;
            moment += r.cross(&total);
            if site != Site::Screw {
                nut_force += total;
            }
        }
        let centripetal = case.ball.mass * r_m * motion.precession.powi(2);
        let gyroscopic = frame.k.cross(&motion.omega) * (case.ball.inertia() * motion.precession);
        // In these coordinates, the spin terms in the slip at both loaded contacts cancel only up
        // to rounding errors. The spin terms are up to 1e4 times the slip, so the tolerance is
        // 1e-11 instead of 1e-15.
        assert!((force - Vector3::y() * centripetal).norm() <= 1e-11 * f_a);
        assert!((moment - gyroscopic).norm() <= 1e-11 * r_b * f_a);
        assert_relative_eq!(nut_force.dot(&frame.k), f_a, max_relative = 1e-13);
    }
}

/// If the load is large compared with the inertia forces, the result equals the closed form for
/// driving and back-driving. The error is proportional to the inertia ratio.
#[test]
fn rigid_model_approaches_the_closed_form_at_small_inertia() {
    for (speed, direction) in
        [(209.4, Direction::RotaryToLinear), (-209.4, Direction::LinearToRotary)]
    {
        let at = |axial| OperatingPoint {
            drive: Drive { screw_speed: speed, nut_speed: 0.0 },
            load: Load { axial, balls: 1.0 },
            ..lin()
        };
        let angles = Angles { lead: lin().helix.lead_angle, contact: lin().contact_angle };
        let closed = angles.efficiency(direction, 0.075);
        let error = |axial| (expect_solution(&at(axial)).transmission.efficiency - closed).abs();
        let (coarse, fine) = (error(1e3), error(1e5));
        assert!(coarse < 1e-4, "{coarse}");
        // The error is proportional to the inertia ratio, so a load that is 100 times as large
        // gives an error that is 100 times as small.
        assert_relative_eq!(coarse / fine, 100.0, max_relative = 0.02);
        assert!(error(1e8) < 1e-9);
    }
}

/// The published critical lead angle is 7.08 degrees, for small inertia at f = 0.075 and β = 45°.
#[test]
fn no_solution_exists_below_the_critical_lead_angle() {
    let at = |degrees: f64| OperatingPoint {
        helix: Helix { lead_angle: degrees.to_radians(), ..lin().helix },
        ..lin()
    };
    let (status, why) = status_and_reason(&at(5.0));
    assert_eq!(status, Status::NoSolution);
    assert!(matches!(why, Reason::NutContactWouldRoll { .. }), "{why:?}");
    let critical = Rigid { point: at(5.0) }.critical_lead_angle().expect("critical angle");
    // The published value has three digits. At this load, inertia changes only the fourth digit.
    assert_relative_eq!(critical.to_degrees(), 7.08, epsilon = 5e-3);

    // At the critical lead angle, the slip at the loaded flank of the nut vanishes. A root exists
    // just above the critical lead angle, but not just below it.
    let above = expect_solution(&at(critical.to_degrees() + 1e-6));
    assert!(above.ball.nut.slip.is_some_and(|slip| slip.speed < 1e-6), "{above:?}");
    assert_eq!(status_and_reason(&at(critical.to_degrees() - 1e-6)).0, Status::NoSolution);
    let again = Rigid { point: at(6.0) }.critical_lead_angle().expect("critical angle");
    assert_relative_eq!(again, critical, max_relative = 1e-9);
}

/// In an earlier version, rounding errors of the loads determined the slip at the nut at 0.005 rpm.
/// In a sweep of the lead angle across the critical lead angle, roots appeared and disappeared 43
/// times.
#[test]
fn slow_screws_have_a_single_critical_lead_angle() {
    let mut work = RigidWorkspace::default();
    for rpm in [1e-3, 5e-3, 0.02, 0.05, 0.2, 1.0, 20.0] {
        let speed = rpm * std::f64::consts::PI / 30.0;
        let at = |degrees: f64| OperatingPoint {
            helix: Helix { lead_angle: degrees.to_radians(), ..lin().helix },
            drive: Drive { screw_speed: speed, nut_speed: 0.0 },
            ..lin()
        };
        let found: Vec<_> = (0..400)
            .map(|i| Rigid { point: at(7.0 + 0.15 * f64::from(i) / 399.0) }.root(&mut work).ok())
            .collect();
        let border = found.iter().position(Option::is_some).expect("a root at 7.15 deg");
        assert!(border > 0 && found[border..].iter().all(Option::is_some), "{rpm} rpm");
        // Within this short range of lead angles, the slip at the nut increases linearly from zero,
        // apart from a small curvature.
        let u: Vec<_> = found[border..].iter().flatten().map(|root| root.u).collect();
        let slope = (u[u.len() - 1] - u[0]) / f64::from(u32::try_from(u.len() - 1).unwrap());
        for pair in u.windows(2) {
            assert_relative_eq!(pair[1] - pair[0], slope, max_relative = 0.01);
        }
    }
}

/// In an earlier version, overflowing numbers caused a panic.
#[test]
fn inputs_with_forces_outside_the_range_of_double_precision_are_rejected() {
    for (speed, axial) in [(1e200, 1.0), (1e-200, 1.0), (1.0, 1e-320), (1.0, 1e308)] {
        let drive = Drive { screw_speed: speed, nut_speed: 0.0 };
        let case = OperatingPoint { drive, load: Load { axial, balls: 1.0 }, ..lin() };
        let (status, why) = status_and_reason(&case);
        let domain_error = matches!(why, Reason::InertiaOutOfRange { .. } | Reason::Newton { .. });
        assert!(status != Status::Converged && domain_error, "{speed} {axial} {why:?}");
    }
}

/// An earlier version reported self-locking or tension on the unloaded flank for points with large
/// inertia, although the first-order solution is not valid at such points.
#[test]
fn first_order_solution_does_not_exclude_roots_at_large_inertia() {
    let rpm = std::f64::consts::PI / 30.0;
    let locking = OperatingPoint {
        helix: Helix { radius: 42.9601e-3, lead_angle: 59.60875_f64.to_radians() },
        contact_angle: 30.5165_f64.to_radians(),
        ball: Ball::of_density(0.180_774 * 42.9601e-3, 7800.0),
        friction: Coulomb(0.31299),
        drive: Drive { screw_speed: 923.1028 * rpm, nut_speed: 0.0 },
        load: Load { axial: 0.6855, balls: 1.0 },
    };
    let pitch = 83.287_007e-3;
    let lead = (48.236_978e-3 / (std::f64::consts::PI * pitch)).atan();
    let pulling = OperatingPoint {
        helix: Helix { radius: 0.5 * pitch, lead_angle: lead },
        contact_angle: 75.86308_f64.to_radians(),
        ball: Ball::of_density(0.5 * 9.30229e-3, 7800.0),
        friction: Coulomb(0.210_719_7),
        drive: Drive { screw_speed: -8561.84345 * rpm, nut_speed: 4745.78072 * rpm },
        load: Load { axial: 10.483_234_1, balls: 1.0 },
    };
    // This screw is self-locking without inertia. At the given inertia, it has a root, but this
    // root is not on the branch that begins at small inertia.
    let none = Rigid { point: locking }
        .solve(&mut RigidWorkspace::default())
        .result
        .expect_err("an isolated root");
    assert!(matches!(none.evidence(), Some(Evidence::Traced { .. })), "{none}");
    // The operating point `pulling` has no root, but the first-order solution alone does not
    // exclude a root.
    let none =
        Rigid { point: pulling }.solve(&mut RigidWorkspace::default()).result.expect_err("no root");
    assert!(matches!(none.evidence(), Some(Evidence::Traced { .. })), "{none}");
}

/// Operating points without a solution report the correct reason, such as self-locking or a contact
/// in tension.
#[test]
fn points_without_a_solution_report_the_correct_reason() {
    let still = OperatingPoint { drive: Drive { screw_speed: 3.0, nut_speed: 3.0 }, ..lin() };
    assert_eq!(status_and_reason(&still), (Status::InvalidInput, Reason::NoRelativeSpeed));
    let ideal = OperatingPoint { friction: Coulomb(0.0), ..lin() };
    assert_eq!(status_and_reason(&ideal), (Status::InvalidInput, Reason::Frictionless));

    let flat = OperatingPoint { contact_angle: 4.0_f64.to_radians(), ..lin() };
    let (status, why) = status_and_reason(&flat);
    assert_eq!(status, Status::NoSolution);
    assert!(matches!(why, Reason::SelfLocking { .. }), "{why:?}");
    assert_eq!(
        Rigid { point: flat }.solve(&mut RigidWorkspace::default()).self_locking(),
        Some(true)
    );

    // With a steep contact angle, large friction and back-driving, the contact on the unloaded
    // flank would have to act in tension.
    let steep = OperatingPoint {
        contact_angle: 79.0_f64.to_radians(),
        helix: Helix { lead_angle: 40.0_f64.to_radians(), ..lin().helix },
        friction: Coulomb(0.15),
        drive: Drive { screw_speed: -200.0, nut_speed: 0.0 },
        ..lin()
    };
    let (status, why) = status_and_reason(&steep);
    assert_eq!(status, Status::NoSolution);
    assert!(matches!(why, Reason::UnloadedFlankWouldPull { .. }), "{why:?}");
}

/// If friction holds the load against back-driving, the efficiency of the closed form is negative,
/// and the full equations have no root because the ball would roll on the nut.
#[test]
fn self_locking_screw_under_a_back_driving_load_has_no_root() {
    let case = OperatingPoint {
        contact_angle: 70.0_f64.to_radians(),
        drive: Drive { screw_speed: -200.0, nut_speed: 0.0 },
        friction: Coulomb(0.45),
        helix: Helix { lead_angle: 8.0_f64.to_radians(), ..lin().helix },
        ..lin()
    };
    let angles = Angles { lead: case.helix.lead_angle, contact: case.contact_angle };
    assert!(angles.self_locking(Direction::LinearToRotary, case.friction.0));
    assert!(angles.efficiency(Direction::LinearToRotary, case.friction.0) < 0.0);
    let (status, why) = status_and_reason(&case);
    assert_eq!(status, Status::NoSolution);
    assert!(matches!(why, Reason::NutContactWouldRoll { .. }), "{why:?}");
}

/// For inertia ratios from 3e4 down to 3e-12, the model finds a root that satisfies the power
/// balance, and the efficiency changes smoothly between the limits of large and small inertia.
#[test]
fn efficiency_is_continuous_from_large_to_small_inertia() {
    let mut last = f64::NAN;
    for exponent in -40..=120 {
        let axial = 10.0_f64.powf(f64::from(exponent) / 10.0);
        let o = expect_solution(&OperatingPoint { load: Load { axial, balls: 1.0 }, ..lin() });
        let (eta, balance) =
            (o.transmission.efficiency, o.transmission.power_balance.expect("a balance of forces"));
        assert!(balance.abs() <= 1e-9, "{axial}: {balance}");
        // In the steepest part of the curve, the efficiency rises by 0.05 in a step of a tenth of a
        // decade.
        assert!(last.is_nan() || (eta - last).abs() < 0.06, "{axial}: {eta} after {last}");
        assert!((0.642..0.8602).contains(&eta), "{axial}: {eta}");
        last = eta;
    }
}

/// If the rounding error of the inertia forces at the screw speed exceeds the load, the result
/// equals the limit for large inertia.
#[test]
fn efficiency_at_extreme_inertia_equals_the_large_inertia_limit() {
    for exponent in -160..-40 {
        let axial = 10.0_f64.powf(f64::from(exponent) / 10.0);
        let eta = expect_solution(&OperatingPoint { load: Load { axial, balls: 1.0 }, ..lin() })
            .transmission
            .efficiency;
        // The difference between the efficiency and its large-inertia limit is proportional to the
        // square root of the load.
        assert_relative_eq!(eta, 0.642_7, epsilon = 1e-3);
    }
}

fn random_case() -> impl Strategy<Value = OperatingPoint> {
    (
        (8.0..45.0_f64, 30.0..70.0_f64, 0.01..0.1_f64, 0.07..0.2_f64),
        (50.0..6000.0_f64, 20.0..3000.0_f64, any::<bool>(), any::<bool>()),
    )
        .prop_map(|((lead, contact, friction, size), (rpm, axial, back, nut))| {
            let speed = rpm * std::f64::consts::PI / 30.0 * if back { -1.0 } else { 1.0 };
            let drive = if nut {
                Drive { screw_speed: 0.0, nut_speed: -speed }
            } else {
                Drive { screw_speed: speed, nut_speed: 0.0 }
            };
            OperatingPoint {
                helix: Helix { radius: 24.3e-3, lead_angle: lead.to_radians() },
                contact_angle: contact.to_radians(),
                ball: Ball::of_density(24.3e-3 * size, 7800.0),
                friction: Coulomb(friction),
                drive,
                load: Load { axial, balls: 1.0 },
            }
        })
}

proptest! {
    /// Whenever the model converges, the root satisfies the power balance and the residual is
    /// small.
    #[test]
    fn every_root_satisfies_the_power_balance(case in random_case()) {
        let solution = Rigid { point: case }.solve(&mut RigidWorkspace::default());
        prop_assert_ne!(solution.status(), Status::NotConverged, "{:?}", solution.reason());
        if solution.status() == Status::Converged {
            let o = solution.steady_state().expect("converged");
            // The tolerance allows for the rounding error of the friction power at the unloaded
            // flank, which is the product of a load of 1e-4 and a speed of 1e4.
            prop_assert!(o.transmission.power_balance.is_some_and(|x| x.abs() <= 1e-11), "{:?}", o);
            prop_assert!(o.info.is_some_and(|info| info.residual <= 1e-10), "{:?}", o);
        }
    }

    /// A screw of different size, density and load but with the same inertia ratio has the same
    /// efficiency and load ratios.
    #[test]
    fn screws_with_equal_inertia_ratio_have_equal_dimensionless_solutions(case in random_case(), length in 0.1..10.0_f64, force in 0.1..10.0_f64) {
        let scaled = OperatingPoint { helix: Helix { radius: case.helix.radius * length, ..case.helix }, ball: Ball {
                radius: case.ball.radius * length,
                mass: case.ball.mass * force / length,
            }, load: Load { axial: case.load.axial * force, ..case.load }, ..case };
        let (one, other) =
            (Rigid { point: case }.root(&mut RigidWorkspace::default()), Rigid { point: scaled }.root(&mut RigidWorkspace::default()));
        match (one, other) {
            (Ok(one), Ok(other)) => {
                prop_assert!((one.nut_load - other.nut_load).abs() <= 1e-12 * one.nut_load);
                prop_assert!((one.p - other.p).abs() <= 1e-9);
            }
            (Err(_), Err(_)) => {}
            (one, other) => prop_assert!(false, "{one:?} {other:?}"),
        }
    }

    /// Z balls under Z times the load have the same motion as one ball, and Z times the torque.
    #[test]
    fn torque_scales_with_load_and_number_of_balls(case in random_case(), balls in 2_u8..80) {
        let z = f64::from(balls);
        let many = OperatingPoint { load: Load { axial: case.load.axial * z, balls: z }, ..case };
        let mut work = RigidWorkspace::default();
        let (one, other) = (Rigid { point: case }.solve(&mut work), Rigid { point: many }.solve(&mut work));
        prop_assert_eq!(one.status(), other.status());
        let torque = |s: &Solution| s.steady_state()?.transmission.screw_torque;
        if let (Some(t), Some(t_z)) = (torque(&one), torque(&other)) {
            // The axial load per ball may differ in the last bit.
            prop_assert!((t * z - t_z).abs() <= 1e-11 * t_z.abs());
        }
    }
}
