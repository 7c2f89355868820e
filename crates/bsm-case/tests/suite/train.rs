//! Tests of the ball train of a nut that is given as a case: the reference cases of
//! `validation/published/nut`, and invalid inputs.

use bsm_case::{AxisReport, Case, CaseError, NutProblem, NutReport, Settings, output};
use bsm_dyn::Model;
use serde_json::{Value, json};

use crate::named;

const CASES: &str = include_str!("../../../../validation/published/nut/ball_train.json");

fn reference_cases() -> Vec<Value> {
    let file: Value = serde_json::from_str(CASES).expect("JSON");
    file["cases"].as_array().expect("cases").clone()
}

/// Solves the nut of a case with changed inputs.
fn nut(case: &Value, change: &Value, settings: &Settings) -> Result<NutReport, CaseError> {
    let mut case = case.clone();
    case.as_object_mut().expect("a case").extend(change.as_object().expect("entries").clone());
    let case = Case::from_json(case.to_string().as_bytes())?;
    NutProblem::of(&case, settings)?.solve().map_err(CaseError::Nut)
}

fn number(report: &NutReport, name: &str) -> f64 {
    report.number(named(name)).unwrap_or_else(|| panic!("{name}"))
}

/// The tolerances of torques are relative to the friction torque, and the tolerance of the largest
/// push force is relative to this force.
#[test]
fn ball_train_matches_reference_cases() {
    for reference in reference_cases() {
        let name = reference["id"].as_str().expect("name");
        let settings = Settings::default();
        let report = nut(&reference["case"], &json!({}), &settings).expect("a nut");
        let expected = |key: &str| reference["expected"][key].as_f64().expect("number");
        let is_oiled = reference["case"].get("iso_vg").is_some();
        let [rates, torques, pushes] =
            if is_oiled { [1e-5, 1e-4, 1e-3] } else { [1e-7, 1e-6, 1e-5] };
        let friction = expected("friction_torque_Nm");
        let largest = expected("max_push_N");
        let circuits = reference["expected"]["circuits"].as_array().expect("circuits");
        let needed = circuits.iter().filter_map(|circuit| circuit["needed_gap_mm"].as_f64());
        for (ours, want, allowed) in [
            ("advance_spread", expected("advance_spread"), rates),
            // The needed gap is a sum of one hundred differences between the precession speeds of
            // balls.
            ("needed_gap_mm", needed.fold(0.0, f64::max), 600.0 * rates),
            ("contact_torque_free_Nm", expected("contact_torque_free_Nm"), torques * friction),
            ("contact_torque_Nm", expected("contact_torque_Nm"), torques * friction),
            ("ball_contact_torque_Nm", expected("ball_contact_torque_Nm"), torques * friction),
            ("return_push_torque_Nm", expected("return_torque_Nm"), torques * friction),
            ("catching_torque_Nm", expected("catching_torque_Nm"), torques * friction),
            ("friction_torque_Nm", friction, torques * friction),
            ("max_push_N", largest, pushes * largest),
            ("touching_contacts", expected("touching_contacts"), 0.0),
            ("idle_balls", expected("idle_balls"), 0.0),
            ("blocked_balls", expected("blocked_balls"), 0.0),
        ] {
            let found = number(&report, ours);
            assert!((found - want).abs() <= allowed, "{name} {ours}: {found}, not {want}");
        }
        let touch = if expected("touching_contacts") > 0.0 { "touch:" } else { "do not touch:" };
        let line = format!("The balls {touch}");
        assert!(report.notes().iter().any(|note| note.starts_with(&line)), "{name}");
    }
}

/// The contributions to the torque add up to the total exactly, and the driving torque is
/// calculated from the total.
#[test]
fn torque_parts_add_up_to_the_total() {
    let reference = &reference_cases()[1];
    let report = nut(&reference["case"], &json!({"seal_torque_Nm": 0.2}), &Settings::default());
    let report = report.expect("a nut");
    let parts = [
        "contact_torque_Nm",
        "ball_contact_torque_Nm",
        "return_push_torque_Nm",
        "catching_torque_Nm",
    ];
    let sum: f64 = parts.iter().map(|part| number(&report, part)).sum();
    let whole = number(&report, "friction_torque_Nm");
    assert!((sum - whole).abs() <= 1e-15 * whole, "{sum} {whole}");
    let ideal = 6340.0 * 10e-3 / std::f64::consts::TAU;
    let drive = number(&report, "drive_torque_Nm");
    // The tolerance corresponds to the residual of the nut equilibrium, which is 1e-10 of the load.
    assert!((drive - ideal - whole - 0.2).abs() < 1e-9 * drive, "{drive}");
}

/// The losses add up to the total, apart from rounding errors. This is tested with oil, drag and a
/// given force between the balls, with and without a gap.
#[test]
fn losses_of_an_oiled_nut_add_up_to_the_total() {
    let case = &reference_cases()[5]["case"];
    let drag =
        json!({"drag_coefficient": 1.0, "return_circuits": 2, "return_loss_coefficient": 2.0});
    for change in [
        json!({}),
        json!({"ball_gap_mm": null, "return_push_N": null, "ball_contact_force_N": 0.5}),
    ] {
        let mut change = change;
        change.as_object_mut().expect("entries").extend(drag.as_object().expect("entries").clone());
        let report = nut(case, &change, &Settings::default()).expect("a nut");
        let parts = [
            "contact_torque_Nm",
            "ball_contact_torque_Nm",
            "return_push_torque_Nm",
            "catching_torque_Nm",
            "drag_torque_Nm",
        ];
        let sum: f64 = parts.iter().filter_map(|part| report.number(named(part))).sum();
        let whole = number(&report, "friction_torque_Nm");
        assert!((sum - whole).abs() <= 1e-12 * whole, "{sum} {whole}");
        for part in ["ball_contact_torque_Nm", "drag_torque_Nm", "return_torque_Nm"] {
            assert!(number(&report, part) > 0.0, "{part}");
        }
    }
}

/// If no balls touch, the torque equals the torque of balls that are solved individually, to within
/// the residual of each solution, 1e-10.
#[test]
fn torque_matches_sum_over_individually_solved_balls_if_the_balls_do_not_touch() {
    let reference = &reference_cases()[2];
    let settings = Settings::from(Model::Traction);
    let with = nut(&reference["case"], &json!({}), &settings).expect("a nut");
    let without = nut(&reference["case"], &json!({"ball_gap_mm": null}), &settings).expect("a nut");
    for name in ["friction_torque_Nm", "nut_efficiency", "needed_gap_mm"] {
        let [a, b] = [&with, &without].map(|report| number(report, name));
        assert!((a - b).abs() <= 1e-9 * b, "{name}: {a} {b}");
    }
    assert!(without.number(output!(max_push_N)).is_none());
    // The bound for the torque of assumed ball-to-ball contacts is 0 for a sufficient gap, and
    // positive for an unknown gap.
    assert_eq!(with.number(output!(ball_contact_band_Nm)), Some(0.0));
    assert!(number(&without, "ball_contact_band_Nm") > 0.0);
}

/// The range of torques due to assumed push forces used to be 36 kN m with the `elastic` model, in
/// which balls spin without friction. The ranges with raceway control and with the `traction` model
/// differ by a few percent.
#[test]
fn torque_range_for_assumed_push_forces_is_calculated_with_traction_or_raceway_control() {
    let case = &reference_cases()[1]["case"];
    let band = |model: Model| {
        let report = nut(case, &json!({}), &Settings::from(model)).expect("a nut");
        number(&report, "ball_contact_band_Nm")
    };
    let traction = band(Model::Traction);
    // The rotations of most balls are interpolated from the rotations of a few balls, with an error
    // of 1e-4.
    assert!((band(Model::Elastic) / traction - 1.0).abs() < 1e-4);
    // In raceway control, the ball spins at one raceway, which tilts its axis of rotation by a few
    // degrees.
    assert!((band(Model::RacewayControl) / traction - 1.0).abs() < 0.02);
}

#[test]
fn invalid_inputs_of_the_ball_train_are_rejected() {
    let case = &reference_cases()[1]["case"];
    let refused = |change: Value| {
        nut(case, &change, &Settings::default()).err().map(|why| why.to_string()).expect("an error")
    };
    // The arc of the circuit, 1731.6 degrees, is 626.5 mm long and has room for 98.6 balls.
    let none = refused(json!({"ball_gap_mm": 0.0}));
    let room = "`ball_gap_mm` = 0 must be a finite number > 0: circuit 0 is 626 mm long and has room for 98 balls with a diameter of 6.35 mm";
    assert_eq!(none, room);
    let both = refused(json!({"return_push_N": 1.0, "return_bend_deg": 180.0}));
    assert!(both.contains("return_push_N") && both.contains("return_bend_deg"), "{both}");
    let force = json!({
        "friction_coefficient": null, "iso_vg": 68, "lubricant_temperature_C": 40.0,
        "ball_roughness_um": 0.03, "nut_roughness_um": 0.2, "screw_roughness_um": 0.2,
        "ball_contact_force_N": 0.5,
    });
    assert!(refused(force).contains("ball_gap_mm"));
}

#[test]
fn reason_is_stated_if_push_forces_cannot_be_calculated() {
    let case = &reference_cases()[1]["case"];
    for (change, settings, says) in [
        (json!({}), Settings::from(Model::RacewayControl), "require model traction"),
        (json!({"ball_deviation_sd_um": 0.5}), Settings::default(), "unequal size"),
        (json!({"return_push_N": 1e4}), Settings::default(), "the ball return needs a push force"),
        // Balls are blocked if they have no steady motion just below the push force that stops them
        // (O6).
        (
            json!({"screw_speed_rpm": -100, "ball_gap_mm": 0.06}),
            Settings::default(),
            "6.8 % of the largest ball load",
        ),
        // A push force of 6 N acts on balls with loads of up to 190 N.
        (json!({"return_push_N": 6.0}), Settings::default(), "of the largest ball load"),
    ] {
        let report = nut(case, &change, &settings).expect("a nut");
        assert!(report.number(output!(friction_torque_Nm)).is_none(), "{says}");
        assert!(report.number(output!(needed_gap_mm)).is_some(), "{says}");
        assert!(report.notes().iter().any(|note| note.contains(says)), "{:?}", report.notes());
    }
}

/// In the last reference case, a push force is 3.7 % of the mean ball load and 2.1 % of the largest
/// ball load. The case is solved, but a warning is given.
#[test]
fn warns_about_push_forces_above_three_percent_of_the_mean_ball_load() {
    let report =
        nut(&reference_cases()[5]["case"], &json!({}), &Settings::default()).expect("a nut");
    assert!(report.warnings().iter().any(|note| note.contains("of the mean ball load")));
    assert!(report.number(output!(friction_torque_Nm)).is_some());
}

/// The circuits of a nut pair may have different gaps. If all gaps are sufficient, no balls touch.
#[test]
fn each_circuit_may_have_a_separate_gap() {
    let case = &reference_cases()[5]["case"];
    let touching = |gaps: [Value; 2], of_nut: Value| {
        let mut circuits = case["circuits"].clone();
        for (circuit, gap) in circuits.as_array_mut().expect("circuits").iter_mut().zip(gaps) {
            circuit["ball_gap_mm"] = gap;
        }
        let change = json!({"circuits": circuits, "ball_gap_mm": of_nut, "return_push_N": 0.0});
        let report = nut(case, &change, &Settings::default());
        report.map(|report| number(&report, "touching_contacts"))
    };
    // The needed gaps of the circuits are 0.98 and 0.95 mm.
    let (tight, wide) = (json!(0.4), json!(1.1));
    let both = touching([Value::Null, Value::Null], tight.clone()).expect("a nut");
    let first = touching([Value::Null, wide.clone()], tight.clone()).expect("a nut");
    let last = touching([wide.clone(), tight.clone()], wide.clone()).expect("a nut");
    assert!(
        first > 0.0 && last > 0.0 && (first + last - both).abs() < 0.5,
        "{first} {last} {both}"
    );
    assert!(touching([wide.clone(), wide.clone()], tight).expect("a nut").abs() < 0.5);
    for (gap, of_nut) in [(json!(0.0), json!(1.0)), (wide, Value::Null)] {
        let why = touching([gap, Value::Null], of_nut).expect_err("refused").to_string();
        assert!(why.contains("circuits[0].ball_gap_mm"), "{why}");
    }
}

/// The answer states the required gap and the ball flux of each circuit. The flux, which is the
/// number of balls that pass per second, is the precession speed of the ball train divided by the
/// angle between two touching balls (O8). Case T02 agrees with the reference to 1e-7.
#[test]
fn ball_flux_is_reported_for_each_circuit() {
    let reference =
        reference_cases().into_iter().find(|reference| reference["id"] == "T02").expect("T02");
    let report = nut(&reference["case"], &json!({}), &Settings::default()).expect("a nut");
    let circuit = &report.answer().to_json()["circuits"][0];
    let expected = &reference["expected"]["circuits"][0];
    for (ours, theirs, allowed) in [
        ("needed_gap_mm", "needed_gap_mm", 6e-5),
        ("train_rate", "train_rate", 1e-7),
        ("flux_1_s", "flux_1_s", 1e-5),
    ] {
        let [found, want] = [&circuit[ours], &expected[theirs]].map(|of| of.as_f64().expect(ours));
        assert!((found - want).abs() <= allowed, "{ours}: {found}, not {want}");
    }
}

/// If a circuit has too many balls, the message states how many balls fit.
#[test]
fn ball_count_above_capacity_is_reported() {
    let reference =
        reference_cases().into_iter().find(|reference| reference["id"] == "T02").expect("T02");
    let mut case = reference["case"].clone();
    case["circuits"][0]["balls"] = json!(120);
    let report = nut(&case, &json!({}), &Settings::default()).expect("a nut");
    let warnings = report.warnings().join("; ");
    // One turn is 129.86 mm long in the circumferential direction and 10 mm in the axial direction.
    // The arc of 1731.6 degrees is therefore 626.5 mm long and has room for 98.6 balls of 6.35 mm.
    assert!(
        warnings.contains(
            "120 balls are too many: circuit 0 is 626 mm long and has room for 98 balls with a diameter of 6.35 mm"
        ),
        "{warnings}"
    );
}

/// The axis sheet states whether the torque includes the friction between touching balls.
#[test]
fn axis_sheet_states_whether_its_torque_includes_ball_to_ball_friction() {
    let says = |change: Value| {
        let mut case = json!({
            "ball_diameter_mm": 6.35, "pitch_circle_diameter_mm": 41.336, "lead_mm": 12, "contact_angle_deg": 45,
            "nut_conformity": 0.53, "screw_conformity": 0.53, "loaded_balls_per_turn": 19, "loaded_turns": 3,
            "friction_coefficient": 0.06, "axial_load_N": 2000, "screw_speed_rpm": 100,
        });
        let entries = case.as_object_mut().expect("a case");
        entries.extend(change.as_object().expect("entries").clone());
        let case = Case::from_json(case.to_string().as_bytes()).expect("a case");
        let sheet = AxisReport::of(&case, &Settings::default()).expect("an axis");
        let torque = sheet.number(output!(screw_torque_Nm)).expect("a torque");
        (sheet.answer.to_json()["not_modeled"].to_string(), torque)
    };
    let (none, free) = says(json!({"preload_N": 2500}));
    assert!(none.contains("ball returns and ball-to-ball contact, which only"), "{none}");
    let (given, pushed) =
        says(json!({"preload_N": 2500, "ball_gap_mm": 1.0, "return_push_N": 0.5}));
    assert!(given.contains("the torque includes ball-to-ball contact"), "{given}");
    assert!(pushed > free, "{pushed} {free}");
    let (single, _) = says(json!({"ball_gap_mm": 1.0}));
    assert!(single.contains("in a nut without preload, which `bsm nut`"), "{single}");
}
