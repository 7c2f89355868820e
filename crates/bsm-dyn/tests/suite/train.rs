//! Tests of a single ball that is pushed by its neighbors (see chapter 20 of the theory).

use std::f64::consts::{FRAC_PI_4, PI};

use bsm_dyn::{
    Ball, Conformities, Coulomb, ElasticPoint, Load, Material, Materials, ModelWorkspace,
    OperatingPoint, Problem,
    model::Traction,
    train::{TrainBall, TrainMotion},
};
use bsm_kin::{Drive, Helix};

/// Friction coefficient between balls.
const BALLS: f64 = 0.1;

/// Returns the operating point of the reference cases.
fn ball(screw_rpm: f64) -> ElasticPoint {
    let (radius, lead) = (20.668e-3, 10e-3);
    let steel = Material { youngs_modulus: 206e9, poisson_ratio: 0.3 };
    let point = OperatingPoint {
        helix: Helix { radius, lead_angle: f64::atan2(lead, 2.0 * PI * radius) },
        contact_angle: FRAC_PI_4,
        ball: Ball::of_density(3.175e-3, 7800.0),
        friction: Coulomb(0.06),
        drive: Drive { screw_speed: screw_rpm * PI / 30.0, nut_speed: 0.0 },
        load: Load { axial: 50.0, balls: 1.0 },
    };
    ElasticPoint {
        point,
        conformity: Conformities::alike(0.5203),
        material: Materials::alike(steel),
    }
}

/// Creates a ball in a ball train and solves it with the traction model.
///
/// * `friction`: friction coefficient between balls.
fn train_ball(at: ElasticPoint, friction: f64, work: &mut ModelWorkspace) -> TrainBall {
    let traction = Traction { screw: at, accuracy: Traction::ACCURACY, creep: Traction::CREEP };
    let solution = Problem::Traction(traction).solve(work);
    let free = solution.steady_state().expect("a steady ball").ball;
    traction.in_train(&free, friction, work).expect("a ball that moves")
}

/// Screw speed \[rpm\], push forces \[N\], precession rate, and three results: torque \[N·m\],
/// power loss at the raceways \[W\], and angular speed relative to the neighbors \[rad/s\].
type Reference = (f64, [f64; 2], f64, [f64; 3]);

const REFERENCES: [Reference; 9] = [
    (100.0, [0.0, 0.0], 0.446_182_258, [0.080_939_8, 1.426_627e-2, 3.408_293e1]),
    (100.0, [1.0, 0.0], 0.443_348_010, [0.091_063_1, 1.443_199e-2, 3.431_961e1]),
    (100.0, [0.0, 1.0], 0.450_496_048, [0.072_781_9, 1.447_729e-2, 3.428_679e1]),
    (100.0, [2.0, 1.5], 0.445_312_695, [0.089_111_2, 1.431_094e-2, 3.408_544e1]),
    (100.0, [1.0, 1.0], 0.446_855_648, [0.083_002_7, 1.427_972e-2, 3.404_064e1]),
    (-100.0, [0.0, 0.0], 0.446_685_068, [0.078_493_3, 1.135_387e-2, 3.371_076e1]),
    (-100.0, [1.0, 0.0], 0.444_768_742, [0.068_355_2, 1.157_023e-2, 3.368_468e1]),
    (-100.0, [0.0, 1.0], 0.448_724_185, [0.086_631_6, 1.156_002e-2, 3.373_047e1]),
    (-100.0, [1.0, 1.0], 0.446_611_475, [0.076_452_3, 1.135_536e-2, 3.369_890e1]),
];

fn assert_near(name: &str, got: f64, want: f64, digits: f64) {
    assert!((got - want).abs() <= digits * want.abs(), "{name}: {got} instead of {want}");
}

#[test]
fn motions_of_pushed_balls_match_the_reference() {
    let work = &mut ModelWorkspace::default();
    for (rpm, pushes, rate, [torque, power, rotation]) in REFERENCES {
        let ball = train_ball(ball(rpm), BALLS, work);
        let moved = ball.pushed(ball.free(), pushes, work).expect("a motion");
        // Precession rates from different quadratures differ by about 1e-8, and the reference rates
        // are accurate to 1e-7. The other reference values are given to six or seven digits.
        assert_near("rate", moved.rate, rate, 1e-7);
        assert_near("torque", moved.screw_torque, torque, 1e-6);
        assert_near("power", moved.raceway_power, power, 1e-6);
        assert_near("rotation", moved.rotation, rotation, 1e-6);
    }
}

/// A nut with twelve balls carries twelve times the load of a nut with one ball. Each of its balls
/// moves like the single ball, with the same push forces.
#[test]
fn motion_of_a_pushed_ball_depends_on_the_load_per_ball() {
    let work = &mut ModelWorkspace::default();
    let one = ball(100.0);
    let load = Load { axial: 12.0 * one.point.load.axial, balls: 12.0 };
    let many = ElasticPoint { point: OperatingPoint { load, ..one.point }, ..one };
    let [one, many] = [one, many].map(|at| {
        let ball = train_ball(at, BALLS, work);
        ball.pushed(ball.free(), [2.0, 1.5], work).expect("a motion")
    });
    // In both cases, the load per ball is 50 N, so the results can differ only by rounding errors.
    assert_near("rate", many.rate, one.rate, 1e-9);
    assert_near("torque", many.screw_torque, one.screw_torque, 1e-9);
    assert_near("power", many.raceway_power, one.raceway_power, 1e-9);
    assert_near("axial force of the neighbors", many.axial_push, one.axial_push, 1e-9);
}

#[test]
fn push_forces_at_a_given_precession_rate_match_the_reference() {
    let work = &mut ModelWorkspace::default();
    for (rpm, rate, back, torque, power) in [
        (100.0, 0.445_289_893_3, 0.690_948_6, 0.085_503_6, 1.428_459e-2),
        (-100.0, 0.445_791_698_4, 0.621_007_9, 0.073_379_4, 1.139_787e-2),
    ] {
        let ball = train_ball(ball(rpm), BALLS, work);
        let held = ball.at_rate(ball.free(), rate, 1.0, work).expect("a motion");
        // The reference values are given to six or seven digits.
        assert_near("push behind", held.pushes[1], back, 1e-6);
        assert_near("torque", held.screw_torque, torque, 1e-6);
        assert_near("power", held.raceway_power, power, 1e-6);
    }
}

/// Returns the error of the power balance (O4), divided by the power loss at the raceways.
fn power_balance_error(rpm: f64, at: &ElasticPoint, moved: &TrainMotion) -> f64 {
    let speed = rpm * PI / 30.0;
    let (helix, radius) = (at.point.helix, at.point.ball.radius);
    let TrainMotion { rate, screw_torque, raceway_power, rotation, pushes, axial_push, .. } = moved;
    let [front, back] = pushes;
    let per_radian = helix.lead() / (2.0 * PI);
    let put_in = (screw_torque - per_radian * (at.point.load.axial + axial_push)) * speed;
    let travel = helix.arc_length_per_radian() * rate * speed.abs();
    // T W = h (F_j + F_b·k) W + P_raceways + f_b r_b (N_f + N_b)|w| − (N_b − N_f) v     (O4)
    let lost = raceway_power + BALLS * radius * (front + back) * rotation - (back - front) * travel;
    (put_in - lost) / raceway_power
}

#[test]
fn pushed_ball_satisfies_power_balance() {
    let work = &mut ModelWorkspace::default();
    for rpm in [100.0, -100.0] {
        let at = ball(rpm);
        let ball = train_ball(at, BALLS, work);
        for pushes in [[0.0; 2], [1.0, 0.0], [0.3, 2.0], [3.0, 2.5]] {
            let moved = ball.pushed(ball.free(), pushes, work).expect("a motion");
            // The residual of the equations is 1e-10, and the losses are about a hundredth of the
            // transmitted power.
            assert!(power_balance_error(rpm, &at, &moved).abs() < 1e-9, "{rpm} {pushes:?}");
        }
    }
}

#[test]
fn compliance_is_the_derivative_of_the_precession_rate() {
    let work = &mut ModelWorkspace::default();
    let ball = train_ball(ball(100.0), BALLS, work);
    let step = 1e-5;
    let there = ball.pushed(ball.free(), [0.0, step], work).expect("a motion");
    let slope = (there.rate - ball.free().rate) / step;
    // The step is a small fraction of f Q = 0.4 N. Over a tenth of f Q, the compliance changes by
    // 20 %, so over the step, it changes by 1e-4. The roots have an error of 1e-9.
    let [front, back] = ball.free().compliances();
    assert_near("compliance", back, slope, 1e-3);
    let there = ball.pushed(ball.free(), [step, 0.0], work).expect("a motion");
    assert_near("compliance at the front", front, (there.rate - ball.free().rate) / step, 1e-3);
    // The compliance must also be correct for a ball that is already pushed.
    let here = ball.pushed(ball.free(), [1.0, 2.0], work).expect("a motion");
    let there = ball.pushed(&here, [1.0, 2.0 + step], work).expect("a motion");
    let [_, back] = here.compliances();
    assert_near("compliance", back, (there.rate - here.rate) / step, 1e-3);
}

#[test]
fn given_precession_rate_and_given_push_force_lead_to_the_same_motion() {
    let work = &mut ModelWorkspace::default();
    let ball = train_ball(ball(100.0), BALLS, work);
    let pushed = ball.pushed(ball.free(), [0.8, 0.5], work).expect("a motion");
    let held = ball.at_rate(ball.free(), pushed.rate, 0.8, work).expect("a motion");
    // The solutions for the given push force and for the given precession rate both have residuals
    // of 1e-10.
    assert_near("push behind", held.pushes[1], 0.5, 1e-6);
    assert_near("torque", held.screw_torque, pushed.screw_torque, 1e-9);
    for (held, pushed) in held.compliances().into_iter().zip(pushed.compliances()) {
        // The tolerance is large because the solver no longer updates its Jacobian when the
        // residual is below 1e-3.
        assert_near("compliance", held, pushed, 1e-2);
    }
}

/// Returns the relative change of the precession rate \[%\] divided by `part`, and the relative
/// increase of the power loss at the raceways. The push force from behind is `part` times `f Q`,
/// without friction between balls.
fn relative_compliance(load: f64, rpm: f64, part: f64) -> (f64, f64) {
    let work = &mut ModelWorkspace::default();
    let mut at = ball(rpm);
    at.point.load.axial = load;
    let ball = train_ball(at, 0.0, work);
    let free = ball.free();
    let most = 0.06 * 0.5 * free.loads.iter().sum::<f64>();
    let moved = ball.pushed(free, [0.0, part * most], work).expect("a motion");
    (100.0 * (moved.rate / free.rate - 1.0) / part, moved.raceway_power / free.raceway_power - 1.0)
}

/// The reference table lists load, screw speed, compliance at several fractions of `f Q`, and
/// increase of the power loss at `f Q`.
#[test]
fn compliances_of_pushed_balls_match_the_reference_table() {
    let parts = [0.001, 0.01, 0.1, 0.3, 1.0, 1.5];
    for (load, rpm, slopes, growth) in [
        (10.0, 100.0, [51.0, 85.0, 13.0, 5.2, 3.4, 5.3], 0.57),
        (50.0, 100.0, [14.5, 17.6, 7.8, 3.7, 2.3, 2.8], 0.26),
        (500.0, 100.0, [2.15, 2.15, 2.15, 2.12, 2.23, 2.7], 0.20),
        (50.0, -100.0, [2.34, 2.35, 2.22, 1.85, 1.71, 2.8], 0.33),
    ] {
        for (part, slope) in parts.into_iter().zip(slopes) {
            let (got, lost) = relative_compliance(load, rpm, part);
            // The reference values are given with two digits.
            assert_near(&format!("{load} N, {rpm} rpm, {part} f Q"), got, slope, 0.03);
            if (part - 1.0).abs() < 1e-9 {
                assert!((lost - growth).abs() < 0.006, "{load} N, {rpm} rpm: {lost}");
            }
        }
    }
}
