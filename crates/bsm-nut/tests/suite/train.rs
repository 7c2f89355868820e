//! The ball train: reference cases of an independent solution, identities and limits (theory 20).

use std::f64::consts::PI;

use bsm_dyn::{
    ElasticPoint, Lubricated, LubricatedModel, ModelWorkspace, Traction, TrainBall, ZERO_CELSIUS,
};
use bsm_kin::Drive;
use bsm_nut::{
    Advance, BallNut, Equilibrium, Exit, ExitPush, Freedom, Rolling, Support, Train, TrainError,
    TrainInputs,
};
use serde_json::Value;

use crate::public::{number, nut};
use crate::warm::oil_68;

const CASES: &str = include_str!("../../../../validation/published/nut/ball_train.json");

/// A nut with the inputs of its train.
#[derive(Clone)]
struct Case {
    nut: BallNut,
    support: Support,
    /// Coefficient; none of the oil.
    friction: Option<f64>,
    oil: Option<f64>,
    drive: Drive<f64>,
    inputs: TrainInputs,
}

impl Case {
    fn of(scene: &Value) -> Self {
        let value = |key| number(scene, key).unwrap_or(0.0);
        let nut = nut(scene);
        let loaded = [
            ("axial_load_N", 1.0),
            ("", 0.0),
            ("", 0.0),
            ("moment_x_Nm", 1.0),
            ("moment_y_Nm", 1.0),
        ]
        .map(|(key, unit)| Freedom::Loaded(value(key) * unit));
        let free = scene["nut_guidance"] == "free";
        let held = [0.0, value("radial_x_um") * 1e-6, 0.0, 0.0, value("tilt_y_urad") * 1e-6];
        let mut support = Support(loaded);
        if !free {
            for i in 1..5 {
                support.0[i] = Freedom::Held(held[i]);
            }
        }
        let oil = number(scene, "lubricant_temperature_C").map(|celsius| celsius + ZERO_CELSIUS);
        let push = match number(scene, "return_entry_force_N") {
            Some(step) => ExitPush::AtEntry(step),
            None => ExitPush::AtExit(value("return_push_N")),
        };
        let inputs = TrainInputs {
            gaps: vec![value("ball_gap_mm") * 1e-3; nut.circuits.len()],
            spacer: value("spacer_thickness_mm") * 1e-3,
            contact_friction: value("ball_contact_friction"),
            exit: Exit {
                push,
                bend: value("return_bend_deg") * PI / 180.0,
                friction: value("return_friction_coefficient"),
            },
            idle_drag: 0.0,
        };
        let friction = number(scene, "friction_coefficient").filter(|_| oil.is_none());
        let drive = Drive { screw_speed: value("screw_speed_rpm") * PI / 30.0, nut_speed: 0.0 };
        Self { nut, support, friction, oil, drive, inputs }
    }

    fn found(&self) -> Equilibrium {
        self.nut.solve(&self.support).expect("a nut in balance")
    }

    fn model(&self, at: ElasticPoint) -> Result<Traction, Lubricated> {
        let traction = Traction { at, accuracy: Traction::ACCURACY, creep: Traction::CREEP };
        let Some(kelvin) = self.oil else { return Ok(traction) };
        let lubricant = oil_68(kelvin).expect("an oil");
        Err(Lubricated { lubricant, model: LubricatedModel::Traction(traction) })
    }

    fn in_train(&self, at: ElasticPoint, work: &mut ModelWorkspace) -> Option<TrainBall> {
        match self.model(at) {
            Ok(dry) => dry.in_train(self.inputs.contact_friction, work),
            Err(oiled) => oiled.in_train(self.inputs.contact_friction, work),
        }
    }

    fn train(&self) -> Result<Train, TrainError> {
        let ball = |at, work: &mut ModelWorkspace| self.in_train(at, work);
        self.nut.train(&self.found(), self.friction, &self.drive, &self.inputs, ball)
    }

    /// The advance, and the friction torque of the balls as they are solved alone.
    fn advance(&self) -> (Advance, f64) {
        let (found, mut work) = (self.found(), ModelWorkspace::default());
        let solve = |at| match self.model(at) {
            Ok(dry) => bsm_dyn::Problem::Traction(dry).solve(&mut work),
            Err(oiled) => oiled.solve(&mut work),
        };
        let friction = self.nut.friction(&found, self.friction, &self.drive, 0.0, solve);
        let spacer = self.inputs.spacer;
        let advance = self.nut.advance(&found, &friction.motions, &self.drive, spacer);
        (advance.expect("balls that move"), friction.torque.expect("a torque"))
    }
}

#[test]
fn reference_cases() {
    let file: Value = serde_json::from_str(CASES).expect("JSON");
    let cases = file["cases"].as_array().expect("cases");
    assert_eq!(cases.len(), 6);
    for one in cases {
        let name = one["case"].as_str().expect("name");
        let case = Case::of(&one["scene"]);
        let expected = &one["expected"];
        // Those of the file: rates, torques over the friction torque, pushes over the largest.
        let [rates, torques, pushes] =
            if case.oil.is_some() { [1e-5, 1e-4, 1e-3] } else { [1e-7, 1e-6, 1e-5] };
        let near = |what: &str, got: f64, want: f64, allowed: f64| {
            assert!((got - want).abs() <= allowed, "{name} {what}: {got} in place of {want}");
        };
        let (advance, _) = case.advance();
        near("spread", advance.spread, number(expected, "advance_spread").expect("spread"), rates);
        let train = case.train().unwrap_or_else(|error| panic!("{name}: {error}"));
        let friction = number(expected, "friction_torque_Nm").expect("torque");
        for (key, got) in [
            ("contact_torque_free_Nm", train.free_torque),
            ("contact_torque_Nm", train.race_torque),
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
            ("touching_contacts", train.touching),
            ("idle_balls", train.number_of(Rolling::Idle)),
            ("blocked_balls", train.number_of(Rolling::Blocked)),
        ] {
            assert_eq!(expected[key], got, "{name} {key}");
        }
        // Heat in is heat out (17.4); torques of oiled balls balance to a tenth of what a converged point must.
        let balanced = if case.oil.is_some() { 1e-8 } else { 1e-9 };
        near("power balance", train.power_balance, 0.0, balanced);
        let circuits = expected["circuits"].as_array().expect("circuits");
        for ((found, advance), expected) in
            train.circuits.iter().zip(&advance.circuits).zip(circuits)
        {
            let value = |key| number(expected, key).expect("number");
            near("touch angle", advance.touch_angle * 180.0 / PI, value("touch_angle_deg"), 1e-7);
            // A room is a sum of a hundred differences of rates.
            near("needed gap", advance.needed_gap * 1e3, value("needed_gap_mm"), rates * 600.0);
            near("rate", found.rate, value("train_rate"), rates);
            near("flux", found.flux, value("flux_1_s"), rates * 200.0);
            near("exit", found.ends[0], value("exit_push_N"), pushes * largest);
            near("entry", found.ends[1], value("entry_push_N"), pushes * largest);
            for (i, ball) in found.balls.iter().enumerate() {
                let listed = |key: &str| expected[key][i].as_f64();
                let same = |key, got: Option<f64>, allowed| match (got, listed(key)) {
                    (Some(got), Some(want)) => near(&format!("{key}[{i}]"), got, want, allowed),
                    (_, None) => assert_eq!(ball.rolling, Rolling::Idle, "{name} {key}[{i}]"),
                    (None, Some(_)) => panic!("{name} {key}[{i}] is missing"),
                };
                same("free_rate", ball.free_rate, rates);
                same("rate", Some(ball.rate), rates);
                same("front_push_N", Some(ball.pushes[0]), pushes * largest);
                same("back_push_N", Some(ball.pushes[1]), pushes * largest);
            }
        }
    }
}

fn case(name: &str) -> Case {
    let file: Value = serde_json::from_str(CASES).expect("JSON");
    let cases = file["cases"].as_array().expect("cases");
    let one = cases.iter().find(|one| one["case"] == name).expect("a case of this name");
    Case::of(&one["scene"])
}

/// 38 balls of one speed, with a load of 65 N each, that a return pushes on.
fn equal_balls(return_push: f64) -> Case {
    let mut case = case("T01");
    case.nut.circuits[0].arc = 4.0 * PI;
    case.nut.circuits[0].balls = 38;
    case.support = Support::guided(38.0 * 65.0);
    case.inputs.exit.push = ExitPush::AtExit(return_push);
    case
}

/// A nut that its load drives, 38 balls under a moment, without a push of the return.
fn driven_back() -> Case {
    let mut case = case("T05");
    case.inputs.contact_friction = 0.1;
    case.inputs.spacer = 0.0;
    case.inputs.exit = Exit { push: ExitPush::AtExit(0.0), bend: 0.0, friction: 0.0 };
    case
}

fn solved(case: &Case) -> Train {
    case.train().unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn with_room_enough_friction_is_that_of_the_balls_alone() {
    let mut case = driven_back();
    let (advance, friction) = case.advance();
    let needed = advance.circuits[0].needed_gap;
    case.inputs.gaps = vec![1.001 * needed];
    let train = solved(&case);
    assert_eq!((train.touching, train.largest_push), (0, 0.0));
    // The same balls by the same equations, whose roots leave 1e-10.
    assert!((train.torque() / friction - 1.0).abs() < 1e-9, "{} {friction}", train.torque());
    let gaps: f64 = train.circuits[0].balls.iter().map(|ball| ball.gap).sum();
    assert!((gaps / needed - 1.001).abs() < 1e-9, "{gaps:e} of {needed:e}");
    case.inputs.gaps = vec![0.99 * needed];
    assert!(solved(&case).touching > 0);
}

#[test]
fn without_friction_of_the_balls_on_each_other_races_and_return_are_all() {
    let mut case = driven_back();
    case.inputs.contact_friction = 0.0;
    case.inputs.gaps = vec![0.2e-3];
    case.inputs.exit.push = ExitPush::AtExit(0.5);
    let train = solved(&case);
    assert!(train.touching > 5 && train.return_torque > 0.0, "{train:?}");
    assert_eq!(train.contact_torque, 0.0);
    assert!(train.power_balance.abs() < 1e-9, "{}", train.power_balance);
}

#[test]
fn no_room_and_a_return_that_takes_too_much_are_errors() {
    let mut case = driven_back();
    case.inputs.gaps = vec![1e-16];
    assert_eq!(case.train(), Err(TrainError::NoRoom { circuit: 0 }));
    let mut case = equal_balls(0.0);
    case.inputs.gaps = vec![0.2e-3];
    // Both contacts of a ball carry some 50 N, and slide at 0.06 of it each: 6 N a ball.
    case.inputs.exit.push = ExitPush::AtExit(1e3);
    let refused = case.train();
    let Err(TrainError::Return { needed, available }) = refused else { panic!("{refused:?}") };
    assert!(needed > available && available > 38.0 * 6.0, "{needed} {available}");
}
