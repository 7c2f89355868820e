//! Tests of ball trains (theory chapter 20): reference cases from an independent solution,
//! identities and limiting cases.

use std::f64::consts::PI;

use bsm_dyn::{
    ElasticPoint, ModelWorkspace, Problem,
    lubrication::{LubricatedBall, LubricatedModel, ZERO_CELSIUS},
    model::Traction,
    solution::BallState,
};
use bsm_kin::Drive;
use bsm_newton::Bracket;
use bsm_nut::friction::{FlankFriction, FreeMotion, NutFriction};
use bsm_nut::train::{Advance, Exit, ExitPush, Rolling, Train, TrainError, TrainInputs};
use bsm_nut::{BallNut, Circuit, Equilibrium, Flanks, Freedom, Support};
use bsm_sample::Sample;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;

use crate::campaign;
use crate::public::{number, nut};
use crate::warm::oil_68;

const CASES: &str = include_str!("../../../../validation/published/nut/ball_train.json");

/// A nut together with the inputs of its ball train.
#[derive(Debug, Clone)]
struct Case {
    nut: BallNut,
    support: Support,
    /// Friction coefficient; `None` if the nut is lubricated with oil.
    friction: Option<f64>,
    oil: Option<f64>,
    drive: Drive<f64>,
    inputs: TrainInputs,
}

impl Case {
    fn from_reference(case: &Value) -> Self {
        let value = |key| number(case, key).unwrap_or(0.0);
        let nut = nut(case);
        let loaded = [
            ("axial_load_N", 1.0),
            ("", 0.0),
            ("", 0.0),
            ("moment_x_Nm", 1.0),
            ("moment_y_Nm", 1.0),
        ]
        .map(|(key, unit)| Freedom::Loaded(value(key) * unit));
        let free = case["nut_guidance"] == "free";
        let held = [0.0, value("radial_x_um") * 1e-6, 0.0, 0.0, value("tilt_y_urad") * 1e-6];
        let mut support = Support(loaded);
        if !free {
            for (freedom, held) in support.0.iter_mut().zip(held).skip(1) {
                *freedom = Freedom::Held(held);
            }
        }
        let oil = number(case, "lubricant_temperature_C").map(|celsius| celsius + ZERO_CELSIUS);
        let push = match number(case, "return_entry_force_N") {
            Some(step) => ExitPush::AtEntry(step),
            None => ExitPush::AtExit(value("return_push_N")),
        };
        let inputs = TrainInputs {
            gaps: vec![value("ball_gap_mm") * 1e-3; nut.circuits.len()],
            spacer: value("spacer_thickness_mm") * 1e-3,
            contact_friction: value("ball_contact_friction"),
            exit: Exit {
                push,
                bend_angle: value("return_bend_deg") * PI / 180.0,
                friction: value("return_friction_coefficient"),
            },
            idle_drag: 0.0,
        };
        let friction = number(case, "friction_coefficient").filter(|_| oil.is_none());
        let drive = Drive { screw_speed: value("screw_speed_rpm") * PI / 30.0, nut_speed: 0.0 };
        Self { nut, support, friction, oil, drive, inputs }
    }

    fn equilibrium(&self) -> Equilibrium {
        self.nut.solve(&self.support).expect("a nut in balance")
    }

    fn model(&self, at: ElasticPoint) -> Problem {
        let traction = Traction { screw: at, accuracy: Traction::ACCURACY, creep: Traction::CREEP };
        let Some(kelvin) = self.oil else { return Problem::Traction(traction) };
        let lubricant = oil_68(kelvin).expect("an oil");
        Problem::Lubricated(LubricatedBall {
            lubricant,
            model: LubricatedModel::Traction(traction),
        })
    }

    /// Returns the friction of all balls under the assumption that neighboring balls do not push
    /// against each other.
    fn friction_without_push_forces(&self, found: &Equilibrium) -> NutFriction {
        let mut work = ModelWorkspace::default();
        let solve = |at| self.model(at).solve(&mut work);
        self.nut.friction(found, self.flank_friction(), &self.drive, 0.0, solve)
    }

    fn flank_friction(&self) -> FlankFriction {
        FlankFriction { loaded: self.friction, far: None }
    }

    fn train(&self) -> Result<Train, TrainError> {
        self.train_from_equilibrium(&self.equilibrium())
    }

    fn train_from_equilibrium(&self, found: &Equilibrium) -> Result<Train, TrainError> {
        let friction = self.inputs.contact_friction;
        let ball = |at, free: &BallState, work: &mut ModelWorkspace| match self.model(at) {
            Problem::Traction(dry) => dry.in_train(free, friction, work),
            Problem::Lubricated(oiled) => oiled.in_train(free, friction, work),
            _ => None,
        };
        let motions = self.friction_without_push_forces(found).motions;
        self.nut.train(found, &motions, self.friction, &self.drive, &self.inputs, ball)
    }

    /// Returns the ball advance, the friction torque, and the motion of the first ball, all
    /// calculated without push forces.
    fn advance(&self) -> (Advance, f64, Option<FreeMotion>) {
        let found = self.equilibrium();
        let friction = self.friction_without_push_forces(&found);
        let spacer = self.inputs.spacer;
        let advance = self.nut.advance(&found, &friction.motions, &self.drive, spacer);
        let torque = friction.torque.expect("a torque");
        (advance.expect("balls that move"), torque, friction.motions[0])
    }
}

#[test]
fn push_forces_and_losses_of_ball_trains_match_the_reference() {
    let file: Value = serde_json::from_str(CASES).expect("JSON");
    let cases = file["cases"].as_array().expect("cases");
    assert_eq!(cases.len(), 6);
    for one in cases {
        let name = one["id"].as_str().expect("name");
        let reference = Case::from_reference(&one["case"]);
        let expected = &one["expected"];
        // The reference file states the tolerances: absolute for precession rates, relative to the
        // friction torque for torques, and relative to the largest push force for push forces.
        let [rates, torques, pushes] =
            if reference.oil.is_some() { [1e-5, 1e-4, 1e-3] } else { [1e-7, 1e-6, 1e-5] };
        let near = |what: &str, got: f64, want: f64, allowed: f64| {
            assert!((got - want).abs() <= allowed, "{name} {what}: {got} instead of {want}");
        };
        let (advance, ..) = reference.advance();
        near("spread", advance.spread, number(expected, "advance_spread").expect("spread"), rates);
        let train = reference.train().unwrap_or_else(|error| panic!("{name}: {error}"));
        let friction = number(expected, "friction_torque_Nm").expect("torque");
        for (key, got) in [
            ("contact_torque_free_Nm", train.free_torque),
            ("contact_torque_Nm", train.raceway_torque),
            ("ball_contact_torque_Nm", train.contact_torque),
            ("return_torque_Nm", train.return_torque),
            ("catching_torque_Nm", train.catching_torque),
            ("friction_torque_Nm", train.torque()),
        ] {
            near(key, got, number(expected, key).expect("torque"), torques * friction);
        }
        let largest = number(expected, "max_push_N").expect("push");
        near("largest push", train.largest_push, largest, pushes * largest);
        for (key, got) in [
            ("touching_contacts", train.touching_contacts),
            ("idle_balls", train.number_of(Rolling::Idle)),
            ("blocked_balls", train.number_of(Rolling::Blocked)),
        ] {
            assert_eq!(expected[key], got, "{name} {key}");
        }
        // In the solutions with and without oil, the residuals of the forces are 1e-10 of the
        // forces.
        near("power balance", train.power_balance, 0.0, 1e-9);
        let (circuits, touch_angle) = (&expected["circuits"], advance.touch_angle);
        let circuits = circuits.as_array().expect("circuits");
        for ((found, advance), expected) in
            train.circuits.iter().zip(&advance.circuits).zip(circuits)
        {
            let value = |key| number(expected, key).expect("number");
            near("touch angle", touch_angle * 180.0 / PI, value("touch_angle_deg"), 1e-7);
            // The needed gap is a sum of about a hundred differences between precession rates, so
            // its tolerance is larger than the tolerance of a single rate.
            near("needed gap", advance.needed_gap * 1e3, value("needed_gap_mm"), rates * 600.0);
            near("rate", found.rate, value("train_rate"), rates);
            near("flux", found.flux, value("flux_1_s"), rates * 200.0);
            near("exit", found.end_pushes[0], value("exit_push_N"), pushes * largest);
            near("entry", found.end_pushes[1], value("entry_push_N"), pushes * largest);
            for (i, ball) in found.balls.iter().enumerate() {
                let listed = |key: &str| expected[key][i].as_f64();
                let same = |key, got: Option<f64>, allowed| match (got, listed(key)) {
                    (Some(got), Some(want)) => near(&format!("{key}[{i}]"), got, want, allowed),
                    (_, None) => assert_eq!(ball.rolling, Rolling::Idle, "{name} {key}[{i}]"),
                    (None, Some(_)) => panic!("{name} {key}[{i}] is missing"),
                };
                same("free_rate", advance.balls[i].map(|ball| ball.rate), rates);
                same("rate", Some(ball.rate), rates);
                same("front_push_N", Some(ball.pushes[0]), pushes * largest);
                same("back_push_N", Some(ball.pushes[1]), pushes * largest);
            }
        }
    }
}

fn reference(name: &str) -> Case {
    let file: Value = serde_json::from_str(CASES).expect("JSON");
    let cases = file["cases"].as_array().expect("cases");
    let one = cases.iter().find(|one| one["id"] == name).expect("a reference of this name");
    Case::from_reference(&one["case"])
}

/// Returns a nut with 38 balls, which all have the same speed and a load of 65 N. The ball return
/// requires a push force.
fn nut_with_equal_balls(return_push: f64) -> Case {
    let mut reference = reference("T01");
    reference.nut.circuits[0].arc = 4.0 * PI;
    reference.nut.circuits[0].balls = 38;
    reference.support = Support::guided(38.0 * 65.0);
    reference.inputs.exit.push = ExitPush::AtExit(return_push);
    reference
}

/// Returns a nut that is back-driven by its load. A moment acts on the nut, and the ball return
/// requires no push force.
fn back_driven_nut() -> Case {
    let mut reference = reference("T05");
    reference.inputs.contact_friction = 0.1;
    reference.inputs.spacer = 0.0;
    reference.inputs.exit = Exit { push: ExitPush::AtExit(0.0), bend_angle: 0.0, friction: 0.0 };
    reference
}

fn solve_train(reference: &Case) -> Train {
    reference.train().unwrap_or_else(|error| panic!("{error}"))
}

/// Returns the push forces that act on all balls from behind, in the order of the circuit.
fn push_forces_from_behind(train: &Train) -> Vec<f64> {
    train.circuits.iter().flat_map(|circuit| &circuit.balls).map(|ball| ball.pushes[1]).collect()
}

#[test]
fn push_force_from_the_ball_return_decreases_linearly_along_equally_loaded_balls() {
    let push = 0.02;
    let mut reference = nut_with_equal_balls(push);
    reference.inputs.contact_friction = 1e-5;
    reference.inputs.gaps = vec![1e-10];
    let train = solve_train(&reference);
    let behind = push_forces_from_behind(&train);
    assert!(
        (train.circuits[0].end_pushes[0] - push).abs() < 1e-12,
        "{:?}",
        train.circuits[0].end_pushes
    );
    let fall = (push - behind[1]) / 37.0;
    for (number, got) in (0_u8..).zip(&behind).skip(1) {
        let want = push - fall * f64::from(38 - number);
        // At each ball, the friction between balls changes the push force by the fraction 1.6 f_b.
        // Over all balls, these changes add up to 6e-4 of the push force.
        assert!((got - want).abs() < 1e-3 * push, "{number}: {got} instead of {want}");
    }
    // At the first ball, the push force from behind is at most the decrease per ball. At the second
    // ball, it is at most twice this decrease.
    assert!(behind[0] <= fall && behind[1] <= 2.0 * fall, "{behind:?}");
    // The friction power is f_b Z N_x r_b |w|, because the sum of N_f + N_b over all balls is Z
    // N_x, except for the contribution of the first of the 38 balls.
    let motion = reference.advance().2.expect("a motion");
    let speed = reference.drive.relative_speed();
    let power = 1e-5 * 38.0 * push * reference.nut.ball.radius * motion.rotation;
    let ratio = train.contact_torque * speed / power;
    assert!((ratio - 1.0).abs() < 1.0 / 38.0, "{ratio}");
}

#[test]
fn friction_equals_the_sum_over_single_balls_if_the_balls_do_not_touch() {
    let mut reference = back_driven_nut();
    let (advance, friction, _) = reference.advance();
    let needed = advance.circuits[0].needed_gap;
    reference.inputs.gaps = vec![1.001 * needed];
    let train = solve_train(&reference);
    assert_eq!((train.touching_contacts, train.largest_push), (0, 0.0));
    // The ball-train calculation and the calculation for single balls solve the same equations for
    // the same balls, with residuals of 1e-10.
    assert!((train.torque() / friction - 1.0).abs() < 1e-9, "{} {friction}", train.torque());
    let gaps: f64 = train.circuits[0].balls.iter().map(|ball| ball.gap).sum();
    assert!((gaps / needed - 1.001).abs() < 1e-9, "{gaps:e} of {needed:e}");
    reference.inputs.gaps = vec![0.99 * needed];
    assert!(solve_train(&reference).touching_contacts > 0);
}

#[test]
fn push_forces_decrease_with_larger_gap_and_increase_with_return_force() {
    // The residuals are 1e-10 of the load and 2e-11 of the precession rate. They cause errors of
    // 1e-9 f Q in the push forces.
    let not_above = |low: &[f64], high: &[f64]| {
        for (number, (low, high)) in low.iter().zip(high).enumerate() {
            assert!(*low <= high + 1e-6, "ball {number}: {low} above {high}");
        }
    };
    // The gaps in this test are larger than 0.05 mm. At a gap of 0.05 mm, the back-driven nut has
    // push forces of 14 % of a ball load, and several flows are possible. The effect of the push
    // force that the ball return requires is tested only with equal balls, which form a single
    // queue. In a nut with several queues and a given ball gap, a larger push force in one queue
    // reduces the push forces in the other queues.
    for (mut reference, has_one_queue) in
        [(back_driven_nut(), false), (nut_with_equal_balls(0.5), true)]
    {
        let mut tighter = None;
        for gap in [0.1e-3, 0.2e-3, 0.4e-3, 0.8e-3] {
            reference.inputs.gaps = vec![gap];
            let behind = push_forces_from_behind(&solve_train(&reference));
            if let Some(tighter) = tighter.replace(behind.clone()) {
                not_above(&behind, &tighter);
            }
        }
        reference.inputs.gaps = vec![0.2e-3];
        let mut weaker = None;
        for push in [0.0, 0.2, 0.4, 0.8, 1.6].into_iter().filter(|_| has_one_queue) {
            reference.inputs.exit.push = ExitPush::AtExit(push);
            let behind = push_forces_from_behind(&solve_train(&reference));
            if let Some(weaker) = weaker.replace(behind.clone()) {
                not_above(&weaker, &behind);
            }
        }
    }
}

#[test]
fn power_is_lost_only_at_raceways_and_ball_return_if_ball_to_ball_friction_is_zero() {
    let mut reference = back_driven_nut();
    reference.inputs.contact_friction = 0.0;
    reference.inputs.gaps = vec![0.2e-3];
    reference.inputs.exit.push = ExitPush::AtExit(0.5);
    let train = solve_train(&reference);
    assert!(train.touching_contacts > 5 && train.return_torque > 0.0, "{train:?}");
    assert!(train.contact_torque.abs() <= 0.0, "{}", train.contact_torque);
    assert!(train.power_balance.abs() < 1e-9, "{}", train.power_balance);
}

/// Returns the nut after a rotation by 180 deg about the x axis.
fn nut_turned_about_x_axis(reference: &Case) -> Case {
    let mut turned = reference.clone();
    let sign = [-1.0, 1.0, -1.0, 1.0, -1.0];
    for (freedom, sign) in turned.support.0.iter_mut().zip(sign) {
        match freedom {
            Freedom::Loaded(load) | Freedom::Sprung { load, .. } => *load *= sign,
            Freedom::Held(at) => *at *= sign,
        }
    }
    for circuit in &mut turned.nut.circuits {
        circuit.start = -(circuit.start + circuit.arc);
        circuit.offset = -circuit.offset;
        circuit.flanks = match circuit.flanks {
            Flanks::Plus => Flanks::Minus,
            Flanks::Minus => Flanks::Plus,
            Flanks::Both => Flanks::Both,
        };
    }
    turned.drive.screw_speed = -turned.drive.screw_speed;
    turned.drive.nut_speed = -turned.drive.nut_speed;
    turned
}

fn assert_same_train(one: &Train, other: &Train, [length, force]: [f64; 2], reversed: bool) {
    let torque = length * force;
    for (name, [one, other]) in [
        ("raceways", [one.raceway_torque, other.raceway_torque]),
        ("balls", [one.contact_torque, other.contact_torque]),
        ("return", [one.return_torque, other.return_torque]),
    ] {
        // The residuals are 1e-10 of the loads, and the losses are about one hundredth of the
        // transmitted power, so torques are accurate to 1e-8.
        assert!((one * torque - other).abs() <= 1e-7 * other.abs(), "{name}: {one} {other}");
    }
    for (one, other) in one.circuits.iter().zip(&other.circuits) {
        assert!((one.rate / other.rate - 1.0).abs() < 1e-9, "{} {}", one.rate, other.rate);
    }
    let [one_largest, mut behind] = [one.largest_push, 0.0].map(|push| push);
    let (one, mut other) = (push_forces_from_behind(one), push_forces_from_behind(other));
    if reversed {
        other.reverse();
    }
    for (one, other) in one.iter().zip(&other) {
        behind = f64::max(behind, *one);
        // Errors of the push forces result from residuals of 1e-10 of a load of about a hundred
        // newtons, and from relative errors of 1e-11 of the precession rates. Even a push force of
        // 0.02 N is much larger than these errors.
        assert!((one * force - other).abs() < 1e-6 * one_largest * force, "{one} {other}");
    }
    assert!(behind > 0.0);
}

#[test]
fn push_forces_do_not_change_if_the_nut_is_turned_about_a_transverse_axis() {
    for mut reference in [back_driven_nut(), nut_with_equal_balls(0.5)] {
        reference.inputs.gaps = vec![0.2e-3];
        assert_same_train(
            &solve_train(&reference),
            &solve_train(&nut_turned_about_x_axis(&reference)),
            [1.0; 2],
            true,
        );
    }
}

#[test]
fn push_forces_without_inertia_are_equal_for_a_rotating_nut_and_a_rotating_screw() {
    let mut reference = back_driven_nut();
    reference.nut.ball.mass *= 1e-7;
    reference.inputs.gaps = vec![0.2e-3];
    let mut driven = reference.clone();
    driven.drive = Drive { screw_speed: 0.0, nut_speed: -reference.drive.screw_speed };
    assert_same_train(&solve_train(&reference), &solve_train(&driven), [1.0; 2], false);
}

#[test]
fn push_forces_of_a_scaled_nut_are_proportional_to_the_square_of_the_scale() {
    let mut reference = back_driven_nut();
    reference.nut.ball.mass *= 1e-7;
    reference.inputs.gaps = vec![0.2e-3];
    reference.inputs.exit.push = ExitPush::AtExit(0.3);
    let length: f64 = 3.0;
    let force = length * length;
    let mut scaled = reference.clone();
    scaled.nut.helix.radius *= length;
    scaled.nut.ball.radius *= length;
    let units = [force, force, force, force * length, force * length];
    for (freedom, unit) in scaled.support.0.iter_mut().zip(units) {
        if let Freedom::Loaded(load) = freedom {
            *load *= unit;
        }
    }
    scaled.inputs.gaps = vec![0.2e-3 * length];
    scaled.inputs.exit.push = ExitPush::AtExit(0.3 * force);
    assert_same_train(&solve_train(&reference), &solve_train(&scaled), [length, force], false);
}

#[test]
fn zero_gap_and_excessive_return_force_are_rejected() {
    let mut reference = back_driven_nut();
    reference.inputs.gaps = vec![1e-16];
    assert_eq!(reference.train(), Err(TrainError::NoGap { circuit: 0 }));
    let mut reference = nut_with_equal_balls(0.0);
    reference.inputs.gaps = vec![0.2e-3];
    // Each contact of a ball carries 50 to 100 N. In full sliding with a friction coefficient of
    // 0.06, the two contacts provide a push force of 6 to 12 N per ball. The friction between two
    // balls is one tenth of the push force between them. If a push force exceeds 30 to 60 N, this
    // friction stops the rotation of the ball, which then only transmits the push force to the next
    // ball.
    reference.inputs.exit.push = ExitPush::AtExit(1e3);
    let refused = reference.train();
    let Err(TrainError::Return { needed, available }) = refused else { panic!("{refused:?}") };
    assert!(needed > available && available > 30.0 && available < 60.0, "{needed} {available}");
}

#[test]
fn balls_that_cannot_rotate_transmit_the_push_force() {
    // In a tilted nut, some balls next to the idle balls carry such small loads that friction with
    // the neighboring balls stops their rotation.
    let mut reference = reference("T04");
    reference.inputs.contact_friction = 0.3;
    reference.inputs.idle_drag = 0.05;
    reference.inputs.exit.push = ExitPush::AtExit(0.5);
    let train = solve_train(&reference);
    let [blocked, idle] = [Rolling::Blocked, Rolling::Idle].map(|rolling| train.number_of(rolling));
    assert!(blocked > 0 && idle > 0, "{blocked} {idle}");
    let balls = &train.circuits[0].balls;
    for ball in balls.iter().filter(|ball| ball.rolling != Rolling::Rolls) {
        assert!((ball.pushes[1] - ball.pushes[0] - 0.05).abs() < 1e-15, "{ball:?}");
    }
    assert!(train.power_balance.abs() < 1e-9, "{}", train.power_balance);
}

fn as_number(number: usize) -> f64 {
    f64::from(u32::try_from(number).expect("small"))
}

/// Returns a random nut and its equilibrium. The nut has at most 60 balls of equal size with gaps
/// of 0 to 1 % of the ball diameter per ball, and its ball return may require a push force.
fn random_nut(rng: &mut impl Rng) -> (Case, Equilibrium) {
    loop {
        let mut nut = campaign::nut(rng);
        nut.errors.balls.clear();
        if nut.balls() > 60 {
            continue;
        }
        let support = campaign::support(rng, &nut);
        let Ok(found) = nut.solve(&support) else { continue };
        let load = found.max_load();
        let way = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
        let speed = way * rng.log_uniform(0.1, 100.0);
        let drive = match rng.random_range(0..3) {
            0 => Drive { screw_speed: 0.0, nut_speed: speed },
            _ => Drive { screw_speed: speed, nut_speed: 0.0 },
        };
        let gap = |circuit: &Circuit| {
            as_number(circuit.balls) * 2.0 * nut.ball.radius * 0.01 * rng.random_range(0.0..1.0)
        };
        let gaps = nut.circuits.iter().map(gap).collect();
        let push = if rng.random_bool(0.5) { load * rng.log_uniform(1e-5, 0.05) } else { 0.0 };
        let push =
            if rng.random_bool(0.5) { ExitPush::AtExit(push) } else { ExitPush::AtEntry(push) };
        let inputs = TrainInputs {
            gaps,
            spacer: if rng.random_bool(0.3) { 0.1 * nut.ball.radius } else { 0.0 },
            contact_friction: if rng.random_bool(0.2) { 0.0 } else { rng.log_uniform(0.01, 0.3) },
            exit: Exit { push, bend_angle: rng.random_range(0.0..PI), friction: 0.1 },
            idle_drag: if rng.random_bool(0.2) { 1e-4 * load } else { 0.0 },
        };
        let friction = Some(rng.log_uniform(0.01, 0.15));
        return (Case { nut, support, friction, oil: None, drive, inputs }, found);
    }
}

/// Returns a description of a defect of a ball train, or `None` if the ball train has no defect.
/// The check uses only precession rates and push forces.
fn defect_of(reference: &Case, train: &Train) -> Option<String> {
    let pitch = reference.nut.helix.arc_length_per_radian()
        * reference.nut.touch_angle(reference.inputs.spacer);
    for (circuit, room) in train.circuits.iter().zip(&reference.inputs.gaps) {
        let gaps: f64 = circuit.balls.iter().map(|ball| ball.gap).sum();
        // The residual of a ball train is at most 1e-6 of the ball gap, or 1e-11 of the precession
        // rate for each ball.
        let allowed = 1e-6 * room + 1e-9 * pitch;
        if (gaps - room).abs() > allowed {
            return Some(format!("gaps of {gaps:e} m in a room of {room:e} m"));
        }
        for ball in &circuit.balls {
            let [front, back] = ball.pushes;
            if !(front >= 0.0 && back >= 0.0 && ball.gap >= -1e-9 * pitch) {
                return Some(format!("{ball:?}"));
            }
            if back > 0.0 && ball.gap > 1e-9 * pitch {
                return Some(format!("a ball that is pushed is faster than the train: {ball:?}"));
            }
        }
    }
    let balance = train.power_balance.abs();
    (balance > 1e-8).then(|| format!("power is out of balance by {balance:e}"))
}

/// For each random nut, the solver returns either a ball train, which is checked independently, or
/// the reason why no ball train exists.
#[test]
fn random_ball_trains_are_solved_or_rejected_with_a_reason() {
    let mut rng = ChaCha8Rng::seed_from_u64(43);
    let points = bsm_sample::campaign(2_000);
    let (mut solved, mut touching, mut refused, mut lost) = (0, 0, [0; 5], Vec::new());
    for point in 0..points {
        let (reference, found) = random_nut(&mut rng);
        match reference.train_from_equilibrium(&found) {
            Ok(train) => {
                solved += 1;
                touching += usize::from(train.touching_contacts > 0);
                if let Some(wrong) = defect_of(&reference, &train) {
                    panic!("{point}: {wrong} {reference:?}");
                }
            }
            Err(TrainError::BothFlanks) => refused[0] += 1,
            Err(TrainError::Return { .. }) => refused[1] += 1,
            Err(TrainError::Unloaded { .. }) => refused[2] += 1,
            Err(TrainError::NoMotion { .. }) => refused[3] += 1,
            Err(TrainError::LargePush { .. }) => refused[4] += 1,
            Err(other) => lost.push(format!("{point}: {other}")),
        }
    }
    eprintln!(
        "{solved} solved, {touching} of them touch, {refused:?} refused, {} not found {:?}",
        lost.len(),
        &lost[..lost.len().min(10)]
    );
    assert!(solved > points / 2 && touching > points / 10, "{solved} {touching}");
    assert!(lost.is_empty(), "{lost:?}");
}

/// Time-domain simulation of balls on a closed track, without friction between balls. The speed of
/// each ball depends on its position and on the push forces. The angle between two balls is never
/// smaller than the touch angle.
struct Track<'a> {
    /// Angle of the whole track \[rad\], and angle between the centers of two touching balls
    /// \[rad\].
    length: f64,
    touch: f64,
    /// Precession rates for each section of the track, in the direction of travel. The track is
    /// divided into equal sections. The list for a section contains the rates of a ball in the
    /// middle of the section for several push forces from behind. The middle element of the list is
    /// the rate for a push force of 0.
    rates: &'a [Vec<f64>],
    pushes: &'a [f64],
    positions: Vec<f64>,
}

impl Track<'_> {
    /// Returns a function that maps the index of a push force to the rate of a ball at the given
    /// position. Rates are interpolated linearly between the sections.
    fn rate_law(&self, position: f64) -> impl Fn(usize) -> f64 {
        let parts = self.rates.len();
        let along = position.rem_euclid(self.length) / self.length * as_number(parts) - 0.5;
        let part = (1..parts - 1).take_while(|part| as_number(*part) <= along).count();
        move |push| {
            let [here, next] = [part, part + 1].map(|part| self.rates[part][push]);
            here + (along - as_number(part)) * (next - here)
        }
    }

    /// Returns the push force from behind that makes a ball at a given position travel at a given
    /// rate.
    fn push(&self, position: f64, rate: f64) -> f64 {
        let law = self.rate_law(position);
        let numbers: Vec<_> = (1..self.pushes.len() - 1).collect();
        let k = numbers.partition_point(|k| law(*k) <= rate);
        let step = self.pushes[k + 1] - self.pushes[k];
        self.pushes[k] + step * (rate - law(k)) / (law(k + 1) - law(k))
    }

    /// Returns the gap between a ball and the next ball, which is the angle between them minus the
    /// touch angle \[rad\].
    fn gap(&self, ball: usize) -> f64 {
        let ahead = (ball + 1) % self.positions.len();
        let turn = if ahead == 0 { self.length } else { 0.0 };
        self.positions[ahead] + turn - self.positions[ball] - self.touch
    }

    /// Returns the rates of all balls. Balls that touch must not come closer to each other. Balls
    /// that push against each other have a common rate, at which the sum of their push forces is
    /// zero.
    fn rates(&self) -> Vec<f64> {
        let balls = self.positions.len();
        let touches: Vec<_> = (0..balls).map(|ball| self.gap(ball) <= 1e-12).collect();
        let first = touches.iter().position(|touches| !touches).expect("room") + 1;
        // A pool is a set of touching balls. Each tuple contains the common rate of the balls in a
        // pool and the number of these balls.
        let mut pools = Vec::<(f64, usize)>::new();
        let mut begins = 0;
        for number in first..first + balls {
            let mut pool =
                (self.rate_law(self.positions[number % balls])(self.pushes.len() / 2), 1);
            // If the pool behind is faster, it pushes the pool in front, and the two pools are
            // merged.
            while pools.len() > begins && pools[pools.len() - 1].0 > pool.0 {
                let behind = pools.pop().expect("a pool");
                let all = behind.1 + pool.1;
                let missing = |rate: f64| -> f64 {
                    let positions = (0..all).map(|back| self.positions[(number - back) % balls]);
                    positions.map(|position| self.push(position, rate)).sum()
                };
                let ends = [pool.0, behind.0];
                let bracket = Bracket { x_tol: 1e-9, ..Bracket::new(ends, ends.map(missing)) };
                pool = (bracket.root(missing).root().expect("a rate").x, all);
            }
            pools.push(pool);
            if !touches[number % balls] {
                begins = pools.len();
            }
        }
        let mut rates: Vec<_> =
            pools.iter().flat_map(|(rate, balls)| std::iter::repeat_n(*rate, *balls)).collect();
        rates.rotate_right(first % balls);
        rates
    }

    /// Moves all balls until two of them touch, but not farther than a fraction of the touch angle.
    /// Returns the elapsed time.
    fn step(&mut self, part: f64) -> f64 {
        let (rates, balls) = (self.rates(), self.positions.len());
        let mut time = part * self.touch / rates[0];
        for ball in 0..balls {
            let closing = rates[ball] - rates[(ball + 1) % balls];
            if closing > 0.0 && self.gap(ball) > 1e-12 {
                time = time.min(self.gap(ball) / closing);
            }
        }
        for (position, rate) in self.positions.iter_mut().zip(rates) {
            *position += rate * time;
        }
        time
    }
}

/// The flow of balls in a queue equals the flow in a time-domain simulation, in which the speed of
/// each ball depends on its position.
#[test]
fn ball_flow_in_a_queue_matches_a_time_domain_simulation() {
    let mut reference = reference("T02");
    reference.nut.circuits[0].arc *= 38.0 / 98.0;
    reference.nut.circuits[0].balls = 38;
    reference.support.0[0] = Freedom::Loaded(6340.0 * 38.0 / 98.0);
    reference.support.0[4] = Freedom::Loaded(6.0);
    reference.inputs.contact_friction = 0.0;
    reference.inputs.gaps = vec![0.1e-3];
    let (train, found) = (solve_train(&reference), reference.equilibrium());
    let (motions, mut work) =
        (reference.friction_without_push_forces(&found).motions, ModelWorkspace::default());
    // The list contains push forces up to 1 N in both directions. For push forces of a few tenths
    // of a newton, the rate of a ball depends nonlinearly on the push force.
    let pushes: Vec<_> = (0..41).map(|k| 0.05 * (f64::from(k) - 20.0)).collect();
    let law = |number: usize| -> Vec<f64> {
        let at =
            reference.nut.ball_alone(&found, number, 0.06, &reference.drive).expect("one flank");
        let Problem::Traction(ball) = reference.model(at) else { panic!("dry") };
        let free = motions[number].and_then(|motion| motion.ball).expect("a state");
        let ball = ball.in_train(&free, 0.0, &mut work).expect("a ball");
        let rate = |push: &f64| {
            let pushed = ball.pushed(ball.free(), [0.0, *push], &mut work);
            pushed.expect("a motion").rate
        };
        pushes.iter().map(rate).collect()
    };
    let rates: Vec<_> = (0..motions.len()).map(law).collect();
    let balls = rates.len();
    let touch = reference.nut.touch_angle(0.0);
    let room = reference.inputs.gaps[0] / reference.nut.helix.arc_length_per_radian();
    let length = as_number(balls) * touch + room;
    let positions = (0..balls).map(|ball| as_number(ball) * length / as_number(balls)).collect();
    let mut track = Track { length, touch, rates: &rates, pushes: &pushes, positions };
    // The closure returns the mean rate of a ball during whole revolutions around the track.
    let mut round = |rounds: f64| {
        let (begin, mut time) = (track.positions[0], 0.0);
        while track.positions[0] < begin + rounds * length {
            time += track.step(0.1);
        }
        (track.positions[0] - begin) / time
    };
    round(2.0);
    let mean = round(1.0);
    // While one ball travels once around the track, every ball passes a given point once.
    let (rate, ours) = (mean * touch * as_number(balls) / length, train.circuits[0].rate);
    let free: f64 = motions.iter().flatten().map(|motion| motion.rate).sum();
    let apart = free / (as_number(balls) + room / touch);
    // In the model, the positions of the balls are fixed, whereas the balls of the simulation move
    // along the track. The resulting ball flows differ by 1.6e-5.
    assert!((rate / ours - 1.0).abs() < 1e-4, "{rate} in time, {ours}");
    // The test is meaningful only if the flow of balls without push forces would be different.
    assert!((apart / ours - 1.0).abs() > 5e-4, "{apart} {ours}");
}

/// The motions of many balls are interpolated from the motions of a few balls. No more balls are
/// added when the error is below 1e-7 at three consecutive nodes.
#[test]
fn motions_of_all_balls_without_push_forces_can_be_interpolated_from_a_few_balls() {
    // The largest ball load is 9 times the smallest in a nut under a moment, and 450 times the
    // smallest in a tilted nut. In the tilted nut, the rates of lightly loaded balls change rapidly
    // with the load.
    for (name, part) in [("T01", 0.05), ("T02", 0.25), ("T05", 0.6), ("T04", 0.6)] {
        let (reference, mut work) = (reference(name), ModelWorkspace::default());
        let (found, mut asked) = (reference.equilibrium(), 0.0);
        let solve = |at| {
            asked += 1.0;
            reference.model(at).solve(&mut work)
        };
        let few =
            reference.nut.free_motions(&found, reference.flank_friction(), &reference.drive, solve);
        let (few, all) =
            (few.expect("motions"), reference.friction_without_push_forces(&found).motions);
        for (number, (few, all)) in few.iter().zip(&all).enumerate() {
            // Idle balls have no interpolated motion, so only loaded balls are compared.
            let (Some(few), Some(all)) = (few, all) else { continue };
            assert!(
                (few.rate - all.rate).abs() < 3e-7 * all.rate,
                "{name} {number}: {few:?}, {all:?}"
            );
            let turned = (few.rotation - all.rotation).abs();
            assert!(turned < 3e-4 * all.rotation, "{name} {number}: {few:?}, {all:?}");
        }
        assert!(asked <= part * as_number(all.len()), "{name}: {asked} of {}", all.len());
    }
}
