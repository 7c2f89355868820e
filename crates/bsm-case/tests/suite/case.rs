//! Tests of cases: conversion of units, choice of the model, and rejection of invalid inputs.

use std::path::Path;

use approx::assert_relative_eq;
use bsm_case::{
    Case, CaseError, Grid, GridAxis, InputKey, ModelChoice, NutProblem, OutputName, Record, Rule,
    Scope, Settings, input_schema, output, output_schema,
};
use bsm_dyn::{Control, Model, ModelWorkspace, Problem};
use proptest::prelude::*;
use serde_json::Value;

use crate::named;

const LIN: &str = include_str!("../../../../examples/lin1994.json");

fn case(json: &str) -> Case {
    Case::from_json(json.as_bytes()).expect("valid case")
}

/// Returns the error message of a case that is rejected by the parser or by the check.
fn error_text(json: &str) -> String {
    let result = Case::from_json(json.as_bytes())
        .and_then(|case| case.problem(&Settings::default()).map(|_| ()));
    result.expect_err(json).to_string()
}

/// The error message for an unknown input recognizes the name of an output. The program used to
/// suggest the input `seal_torque_Nm` in place of `screw_torque_Nm`, because the names are similar
/// although their meanings differ.
#[test]
fn result_given_as_an_input_is_not_mistaken_for_an_input_of_similar_spelling() {
    let text = error_text(r#"{"screw_torque_Nm": 2}"#);
    assert!(
        text.contains("`screw_torque_Nm` is a result, not an input; `bsm fit --measured"),
        "{text}"
    );
    assert!(!text.contains("did you mean"), "{text}");
}

/// For the unknown grade P2, the program used to suggest only the finest grade, P0.
#[test]
fn grades_on_both_sides_of_an_unknown_grade_are_suggested() {
    for (grade, suggestion) in [
        ("P2", "did you mean `P1` or `P3`?"),
        ("c4", "did you mean `C3` or `C5`?"),
        ("T12", "did you mean `T10`?"),
        ("grade", "did you mean"),
    ] {
        let text = error_text(&format!(r#"{{"accuracy_grade": "{grade}"}}"#));
        let is_suggested = text.contains(suggestion);
        assert_eq!(is_suggested, grade != "grade", "{text}");
    }
}

#[test]
fn units_round_trip_through_si() {
    let lin = case(LIN);
    let Problem::Rigid(rigid) = lin.problem(&Settings::default()).expect("complete case") else {
        panic!("auto takes the most complete model");
    };
    assert_relative_eq!(rigid.point.helix.radius, 24.3e-3, max_relative = 1e-15);
    assert_relative_eq!(rigid.point.helix.lead_angle, 0.174_532_925_199_433, max_relative = 1e-15);
    assert_relative_eq!(rigid.point.ball.radius, 4.37e-3, max_relative = 1e-15);
    assert_relative_eq!(rigid.point.ball.mass, 2.726_638e-3, max_relative = 1e-6);
    assert_relative_eq!(rigid.point.drive.screw_speed, 209.439_510_239_319_6, max_relative = 1e-15);
    assert_relative_eq!(rigid.point.load.per_ball(), 2113.0);

    let record = Record::new(Problem::Rigid(rigid).solve(&mut ModelWorkspace::default()));
    let number = |name: OutputName| record.number(name).expect("a number");
    assert_relative_eq!(number(output!(nut_contact_angle_deg)), 45.0, max_relative = 1e-15);
    // ψ_B = atan(tan 10° / cos 45°) = 14.00°, apart from the effect of inertia.
    assert_relative_eq!(number(output!(screw_slip_angle_deg)), 14.0, epsilon = 0.02);
    // The reference table contains P = 0.4345 × 2000 rpm.
    let rpm = number(output!(ball_precession_rad_s)) * 30.0 / std::f64::consts::PI;
    assert_relative_eq!(rpm, 0.434_502_536 * 2000.0, max_relative = 1e-8);
}

/// `auto` chooses each model as soon as the inputs of this model are given. The error message of a
/// model names the missing inputs.
#[test]
fn auto_chooses_the_most_complete_model() {
    let mut given = Case::default();
    let mut chosen = Vec::new();
    for (name, value) in [
        ("lead_angle_deg", 10.0),
        ("contact_angle_deg", 45.0),
        ("friction_coefficient", 0.075),
        ("ball_diameter_mm", 8.74),
        ("pitch_circle_diameter_mm", 48.6),
        ("screw_speed_rpm", 2000.0),
        ("axial_load_N", 2113.0),
        ("loaded_balls", 1.0),
        ("nut_conformity", 0.53),
        ("screw_conformity", 0.54),
    ] {
        given.set(name, value).expect("known name");
        chosen.push(given.choose(ModelChoice::Auto).ok());
    }
    let rigid = Model::Rigid;
    let [closed, quasi, gross_skid] =
        [Model::ClosedForm, Model::QuasiStatic, rigid].map(|m| Some(ModelChoice::Fixed(m)));
    // If both conformities are given, the error of each model is bounded, so `auto` chooses the
    // model for each point, and the choice is not replaced by a fixed model.
    let auto = Some(ModelChoice::Auto);
    assert_eq!(
        chosen,
        [None, None, closed, closed, quasi, quasi, quasi, gross_skid, gross_skid, auto]
    );

    let lacking = Case { loaded_balls: None, ..given };
    let error = lacking.problem(&rigid.into()).expect_err("no balls").to_string();
    assert_eq!(error, "loaded_balls is required by model rigid");
    let unknown = ModelChoice::from_name("rigdi").expect_err("no such model");
    assert!(
        unknown
            .to_string()
            .starts_with("unknown model `rigdi`; did you mean `rigid`? The models are"),
        "{unknown}"
    );
    let named = Settings::named("rigid", Some("screw"), None).expect("names");
    assert_eq!(named, Settings { control: Some(Control::Screw), ..Model::Rigid.into() });
    let unknown = Settings::named("rigid", Some("ball"), None);
    let unknown = unknown.expect_err("no such raceway").to_string();
    assert_eq!(unknown, "unknown raceway `ball`; the raceways are nut, screw");
    let unknown =
        Settings::named("rigid", None, Some("dry")).expect_err("no such place").to_string();
    assert_eq!(unknown, "unknown friction `dry`; the frictions are local, contact");
}

#[test]
fn lead_and_lead_angle_are_equivalent() {
    let by_angle = case(LIN);
    let lead_mm = 48.6 * std::f64::consts::PI * 10.0_f64.to_radians().tan();
    let by_lead = Case { lead_angle_deg: None, lead_mm: Some(lead_mm), ..by_angle.clone() };
    let lead = |case: &Case| match case.problem(&Settings::default()) {
        Ok(Problem::Rigid(rigid)) => rigid.point.helix.lead_angle,
        other => panic!("{other:?}"),
    };
    assert_relative_eq!(lead(&by_angle), lead(&by_lead), max_relative = 1e-15);
    let both = Case { lead_mm: Some(lead_mm), ..by_angle.clone() };
    assert!(both.check().is_ok());
    let off = Case { lead_mm: Some(lead_mm * (1.0 + 1e-7)), ..by_angle };
    let error = off.check().expect_err("two leads").to_string();
    assert!(error.contains("disagree: on this pitch circle"), "{error}");
    let no_pitch = case(r#"{"lead_mm": 10, "contact_angle_deg": 45, "friction_coefficient": 0.1}"#);
    let error = no_pitch.problem(&Settings::default()).expect_err("no pitch circle").to_string();
    assert!(
        error.starts_with("pitch_circle_diameter_mm (to convert lead_mm to an angle)"),
        "{error}"
    );
}

/// Every error message states the key, the value and the permitted range.
#[test]
fn errors_state_key_value_and_permitted_range() {
    for (json, parts) in [
        ("", &["is empty", "JSON object"][..]),
        (" \n", &["is empty"]),
        ("{", &["not valid JSON", "line 1 column 1"]),
        (r#"{"friction_coefficient": NaN}"#, &["not valid JSON", "line 1"]),
        ("[1, 2]", &["a list", "JSON object"]),
        ("3", &["a number", "JSON object"]),
        (
            r#"{"ball_diamter_mm": 3}"#,
            &["unknown key `ball_diamter_mm`", "did you mean `ball_diameter_mm`?"],
        ),
        (r#"{"axial_load_n": 3}"#, &["did you mean `axial_load_N`?"]),
        (r#"{"friction": 0.1}"#, &["did you mean `friction_coefficient`?"]),
        (r#"{"qqqqqqqqqqqqqqqqqqqqqqqqqqqq": 3}"#, &["unknown key `qqqq"]),
        (r#"{"lead": 3}"#, &["did you mean `lead_mm`?"]),
        (r#"{"lead_angle": 3}"#, &["did you mean `lead_angle_deg`?"]),
        (r#"{"lead_mm": 3, "lead_mm": 4}"#, &["`lead_mm` is given twice"]),
        (r#"{"lead_mm": "3"}"#, &["`lead_mm` is the text \"3\"", "must be a number"]),
        (r#"{"lead_mm": [3]}"#, &["`lead_mm` is a list", "must be a number"]),
        (r#"{"description": 3}"#, &["`description` is a number", "must be text"]),
        (
            r#"{"ball_diameter_mm": -3.5}"#,
            &["`ball_diameter_mm` = -3.5 must be a finite number > 0"],
        ),
        ("{\"a\\nb\\u001b\": 1}", &[r"unknown key `a\nb\u{1b}`"]),
        (r#"{"contact_angle_deg": 90}"#, &["`contact_angle_deg` = 90 must be between 0 and 90"]),
        (r#"{"nut_conformity": 0.5}"#, &["`nut_conformity` = 0.5 must be a finite number > 0.5"]),
        (r#"{"ball_diameter_mm": 1e999}"#, &["number out of range"]),
        (
            r#"{"ball_diameter_mm": 30, "pitch_circle_diameter_mm": 48.6}"#,
            &["ball_diameter_mm = 30", "24.3"],
        ),
        (
            r#"{"ball_diameter_mm": 6.35, "pitch_circle_diameter_mm": 40, "lead_mm": 20, "loaded_balls_per_turn": 25}"#,
            &[
                "`loaded_balls_per_turn` = 25 must be <= 20.039, the number of balls that fill a turn",
            ],
        ),
        (
            r#"{"ball_diameter_mm": 6.35, "pitch_circle_diameter_mm": 40, "lead_angle_deg": 9, "loaded_balls_per_turn": 21}"#,
            &["must be <= 20.036, the number of balls that fill a turn"],
        ),
        (r#"{"screw_speed_rpm": 500, "nut_speed_rpm": 500}"#, &["must not be 0"]),
        (r#"{"screw_speed_rpm": 0}"#, &["must not be 0"]),
        (
            "{}",
            &[
                "lead_angle_deg (or lead_mm), contact_angle_deg and friction_coefficient (or iso_vg and lubricant_temperature_C) are required even by the simplest model, closed-form",
            ],
        ),
    ] {
        let text = error_text(json);
        for part in parts {
            assert!(text.contains(part), "{json}: {text} lacks {part}");
        }
        assert!(!text.contains('\n'), "{text}");
    }
    let missing = Case::read(Path::new("no/such/file.json")).expect_err("no file");
    assert!(missing.is_io() && missing.to_string().contains("no/such/file.json"), "{missing}");
}

/// A review found that inputs outside the range of a model were rejected only after the
/// calculation.
#[test]
fn values_outside_the_model_range_are_rejected_before_solving() {
    let mut lin = case(LIN);
    lin.apply(&["friction_coefficient=0"]).expect("known name");
    let rigid = lin.problem(&Model::Rigid.into()).expect_err("no friction").to_string();
    assert!(rigid.contains("`friction_coefficient` = 0 must be > 0"), "{rigid}");
    assert!(rigid.contains("for model rigid"), "{rigid}");
    assert_eq!(lin.choose(ModelChoice::Auto).ok(), Some(Model::QuasiStatic.into()));
    lin.apply(&["nut_speed_rpm=-100"]).expect("known name");
    assert_eq!(lin.choose(ModelChoice::Auto).ok(), Some(Model::ClosedForm.into()));
    let dual = lin.problem(&Model::QuasiStatic.into()).expect_err("dual").to_string();
    assert!(dual.contains("no dual drive"), "{dual}");
}

/// `auto` solves the case with a model whose error bound is below the tolerance, and states the
/// reason.
#[test]
fn auto_states_error_bound_and_reason_of_its_choice() {
    let mut lin = case(LIN);
    for setting in ["nut_conformity=0.53", "screw_conformity=0.53"] {
        lin.apply(&[setting]).expect("known name");
    }
    let mut work = ModelWorkspace::default();
    let mut solve = |tolerance, load: &str| {
        let mut lin = lin.clone();
        lin.apply(&[load]).expect("known name");
        let settings = Settings { tolerance, ..Settings::default() };
        let record = Record::new(lin.problem(&settings).expect("complete").solve(&mut work));
        let bound = record.number(output!(efficiency_error_bound)).expect("a bound");
        assert!(bound <= tolerance, "{bound} {tolerance}");
        let why = record.choice().expect("a reason");
        // An audit found that some outputs were printed with five digits next to an error bound
        // that did not apply to them.
        let json = record.to_json();
        let marked = json["without_error_bound"].as_array().map_or(0, |names| {
            assert!(names.iter().any(|name| name == "axial_displacement_um"));
            assert!(names.iter().all(|name| json[name.as_str().expect("a name")].is_number()));
            names.len()
        });
        assert_eq!(marked > 0, record.model().name() != "traction");
        (record.model().name(), why)
    };
    for (tolerance, load, model, part) in [
        (0.02, "axial_load_N=2113", "raceway-control", "the ball rolls (skid onset"),
        (1e-4, "axial_load_N=2113", "traction", "integrated with"),
        (0.02, "axial_load_N=1", "elastic", "gross skid (skid onset"),
    ] {
        let (name, why) = solve(tolerance, load);
        assert_eq!(name, model, "{why}");
        assert!(why.contains(part), "{why}");
    }
}

/// A byte order mark used to be reported as a syntax error.
#[test]
fn a_byte_order_mark_is_skipped() {
    let mut bytes = b"\xef\xbb\xbf".to_vec();
    bytes.extend(LIN.as_bytes());
    assert_eq!(Case::from_json(&bytes).expect("valid case"), case(LIN));
}

#[test]
fn settings_add_and_replace_inputs_of_a_case() {
    let mut lin = case(LIN);
    lin.apply(&["friction_coefficient=0.1"]).expect("known name");
    lin.apply(&[" lead_angle_deg = 12.5 "]).expect("spaces do not matter");
    assert_eq!((lin.friction_coefficient, lin.lead_angle_deg), (Some(0.1), Some(12.5)));
    // A lead in the settings replaces the lead angle of the case.
    lin.apply(&["lead_mm=20"]).expect("known name");
    assert_eq!((lin.lead_mm, lin.lead_angle_deg), (Some(20.0), None));
    assert!(lin.check().is_ok());
    for (setting, part) in [
        ("friction", "name=value"),
        ("=3", "unknown key ``"),
        ("frction_coefficient=0.1", "did you mean `friction_coefficient`?"),
        ("friction_coefficient=much", "`friction_coefficient` is `much`, but must be a number"),
    ] {
        let error = lin.apply(&[setting]).expect_err(setting).to_string();
        assert!(error.contains(part), "{error}");
    }
    // A setting can contain NaN, but the check of the case rejects this value.
    lin.apply(&["friction_coefficient=NaN"]).expect("a float");
    assert!(matches!(lin.check(), Err(CaseError::OutOfRange { .. })));
}

#[test]
fn overriding_inputs_by_a_case_or_by_numbers_gives_the_same_case() {
    let base = case(LIN);
    let numbers = [
        (InputKey::lead_mm, 12.0),
        (InputKey::viscosity_40C_mm2_s, 46.0),
        (InputKey::preload_N, 900.0),
    ];
    let mut settings = Case::default();
    for (key, value) in numbers {
        settings[key] = Some(value);
    }
    let (mut by_case, mut by_numbers) = (base.clone(), base);
    by_case.override_with(&settings);
    by_numbers.override_with_numbers(&numbers);
    assert_eq!(by_case, by_numbers);
    // A lead replaces a lead angle, and a lubricant replaces a friction coefficient.
    assert_eq!((by_numbers.lead_angle_deg, by_numbers.friction_coefficient), (None, None));
    assert_eq!(by_numbers.lead_mm, Some(12.0));
}

#[test]
fn grids_are_cartesian_products_with_exact_range_ends() {
    let grid = Grid::new(vec![
        GridAxis::parse("lead_angle_deg=1:2:3").expect("range"),
        GridAxis::parse("friction_coefficient=0.1,0.3").expect("list"),
    ])
    .expect("two axes");
    assert_eq!(grid.len(), 6);
    let points: Vec<_> = (0..6).map(|i| grid.point(i)).collect();
    let expected =
        [[1.0, 0.1], [1.0, 0.3], [1.5, 0.1], [1.5, 0.3], [2.0, 0.1], [2.0, 0.3]].map(Vec::from);
    assert_eq!(points, expected);
    assert_eq!(grid.case(&case(LIN), &grid.point(3)).friction_coefficient, Some(0.3));
    // Filling a range of points at once, within a period of the fast axis or across periods, gives
    // the same values as individual points.
    for (first, end) in (0..=6).flat_map(|first| (first..=6).map(move |end| (first, end))) {
        for axis in 0..2 {
            let mut column = vec![f64::NAN];
            grid.append_values(axis, first..end, &mut column);
            let one_by_one: Vec<_> = points[first..end].iter().map(|point| point[axis]).collect();
            assert_eq!(column[1..], one_by_one, "axis {axis}, points {first} to {end}");
        }
    }
    // The end of the range is exactly 0.1, although adding rounded steps would not give this
    // number.
    let tenth = GridAxis::parse("friction_coefficient=0:0.1:8").expect("range");
    assert_eq!(tenth.value(7).to_bits(), 0.1_f64.to_bits());
    // Successive values have equal ratios, and the ends are exact.
    let log = GridAxis::parse("axial_load_N=1:1000:4:log").expect("range");
    let values: Vec<_> = (0..4).map(|i| log.value(i)).collect();
    assert_eq!([values[0], values[3]].map(f64::to_bits), [1.0_f64, 1000.0].map(f64::to_bits));
    // The tolerance allows for rounding errors of the logarithms.
    assert!((values[1] / 10.0 - 1.0).abs() < 1e-14 && (values[2] / 100.0 - 1.0).abs() < 1e-14);
    assert_eq!(GridAxis::parse(&log.to_string()).expect("its own form"), log);

    for (text, part) in [
        ("lead_angle_deg", "name=start:stop:count"),
        ("lead_angle_deg=1:2", "name=start:stop:count"),
        ("lead_angle_deg=1:2:1", "at least 2"),
        ("lead_angle_deg=1:inf:3", "finite"),
        ("lead_angle_deg=", "finite"),
        ("axial_load_N=0:9:3:log", "must have both ends of a logarithmic range above 0"),
        ("lead_angle_deg=1:2:3:exp", "name=start:stop:count:log"),
        ("lead_angel_deg=1:2:3", "did you mean `lead_angle_deg`?"),
        ("lead_angle_deg=0:20:3", "`lead_angle_deg` = 0 must be between 0 and 90"),
    ] {
        let error = GridAxis::parse(text).expect_err(text).to_string();
        assert!(error.contains(part), "{error}");
    }
    // If both forms of the lead were given, the second form used to replace the first form without
    // a message.
    let leads = ["lead_mm=10,20", "lead_angle_deg=8,30"].map(|a| GridAxis::parse(a).expect("list"));
    let error = Grid::new(leads.to_vec()).expect_err("two forms").to_string();
    assert_eq!(error, "give either lead_angle_deg or lead_mm; both are given");
    // A grid of nut speeds used to be rejected if the base case was at standstill.
    let nut =
        Grid::new(vec![GridAxis::parse("nut_speed_rpm=100,200").expect("list")]).expect("grid");
    let base = Case { screw_speed_rpm: Some(0.0), ..case(LIN) };
    assert!(base.check().is_err() && nut.check(&base).is_ok());
    assert!(nut.case(&base, &nut.point(1)).check().is_ok());
    let axis = GridAxis::parse("lead_angle_deg=1:2:3").expect("range");
    let error = Grid::new(vec![axis.clone(), axis]).expect_err("twice").to_string();
    assert_eq!(error, "`lead_angle_deg` is given twice; give it once");
    let huge = |name| GridAxis::parse(&format!("{name}=1:2:4294967296")).expect("range");
    let grid = Grid::new(vec![huge("lead_angle_deg"), huge("density_kg_m3")]);
    let error = grid.expect_err("too many").to_string();
    assert!(error.starts_with("the grid has more than"), "{error}");
}

/// If a quantity has several forms, only one form may be given, under any of its names. This rule
/// applies to cases, settings and grids. Lead and lead angle are an exception: both may be given if
/// they are consistent.
#[test]
fn error_about_two_forms_of_a_quantity_states_both_names() {
    for (forms, names) in [
        (["screw_speed_rpm=1500", "feed_m_min=20"], "screw_speed_rpm and feed_m_min"),
        (["speed_1_min=1500", "feed_mm_s=20"], "screw_speed_rpm and feed_m_min"),
        (
            ["contact_angle_deg=45", "groove_bottom_distance_mm=9"],
            "contact_angle_deg and groove_bottom_distance_mm",
        ),
        (["iso_vg=68", "viscosity_40C_mm2_s=68"], "viscosity_40C_mm2_s and iso_vg"),
        (
            ["heat_transfer_W_K=9", "lubricant_temperature_C=40"],
            "heat_transfer_W_K and lubricant_temperature_C",
        ),
        (["axial_load_N=500", "load_kN=0.5"], "axial_load_N and load_kN"),
    ] {
        let names: Vec<_> = names.split(" and ").map(|name| format!("`{name}`")).collect();
        let expected = format!("{} are the same input; give one of them", names.join(" and "));
        // If an input is given in two units, the message states that both are the same input. If
        // different inputs define the same quantity, the message states that only one of them may
        // be given.
        let expected = if names.iter().any(|name| name.contains("load_kN")) {
            expected
        } else {
            format!("give either {}; both are given", names.join(" or ").replace('`', ""))
        };
        let mut case = Case::default();
        let checked = case.apply(&forms).and_then(|()| case.check());
        assert_eq!(checked.expect_err("two forms").to_string(), expected);
        let json = forms.map(|form| format!("\"{}", form.replace('=', "\":")));
        let read = Case::from_json(format!("{{{}}}", json.join(",")).as_bytes());
        let read = read.and_then(|case| case.check());
        assert_eq!(read.expect_err("two forms").to_string(), expected);
        let varied = Grid::parse(&forms).expect_err("two forms").to_string();
        assert!(varied == expected || varied.contains("`axial_load_N` is given twice"), "{varied}");
        // A later setting replaces earlier settings that give the same quantity in another form.
        let mut case = Case::default();
        case.apply(&forms[..1]).and_then(|()| case.apply(&forms[1..])).expect("a setting");
        case.check().expect("one of them");
    }
    let error = Case::default().apply(&["lead_mm=5", "lead_mm=6"]).expect_err("twice").to_string();
    assert_eq!(error, "`lead_mm` is given twice; give it once");
}

/// The schemas contain every input with its rule, and every key of a result.
#[test]
fn schemas_contain_all_inputs_and_outputs() {
    let input = input_schema();
    let friction = &input["properties"]["friction_coefficient"];
    assert_eq!(
        (&friction["minimum"], &input["additionalProperties"]),
        (&0.0.into(), &false.into())
    );
    assert_eq!(
        input["properties"].as_object().map(serde_json::Map::len),
        Some(bsm_case::INPUTS.len() + bsm_case::CaseEntries::KEYS.len() + 1)
    );
    let solved = case(LIN).problem(&Settings::default()).expect("complete");
    let record = Record::new(solved.solve(&mut ModelWorkspace::default())).to_json();
    let output = output_schema();
    let names = output["properties"].as_object().expect("object");
    assert!(record.keys().eq(names.keys()));
    for (key, value) in &record {
        let kind = match value {
            Value::Null => "null",
            Value::Bool(_) => "boolean",
            Value::String(_) => "string",
            Value::Number(n) if n.is_u64() => "integer",
            Value::Array(_) => "array",
            _ => "number",
        };
        let allowed = &names[key]["type"];
        let fits = key == "status"
            || *allowed == kind
            || allowed.as_array().is_some_and(|list| list.iter().any(|a| a == kind));
        assert!(fits, "{key} is {kind}, schema {allowed}");
    }
}

/// The result for a point without a solution has a message instead of numeric outputs.
#[test]
fn result_of_an_unsolved_point_states_the_reason() {
    let mut lin = case(LIN);
    lin.apply(&["lead_angle_deg=5"]).expect("known name");
    let problem = lin.problem(&Settings::default()).expect("complete");
    let record = Record::new(problem.solve(&mut ModelWorkspace::default()));
    assert_eq!(record.status_name(), "no_solution");
    let message = record.message().expect("a reason");
    assert!(message.contains("rolls on the nut"), "{message}");
    let json = record.to_json();
    assert_eq!(json["evidence"], "bound");
    let numbers = json.iter().filter(|(key, value)| {
        !["model", "status", "message", "evidence"].contains(&key.as_str()) && !value.is_null()
    });
    assert_eq!(numbers.count(), 0);
}

#[test]
fn warns_about_overlapping_turns() {
    let mut lin = case(LIN);
    assert!(lin.warnings().is_empty());
    lin.apply(&["lead_angle_deg=3"]).expect("known name");
    assert!(lin.warnings()[0].contains("neighboring turns"), "{:?}", lin.warnings());
}

/// The contact ellipse has a semi-axis of 0.81 ball radii, which corresponds to 54 deg of the
/// groove. At a contact angle of 61 deg, the ellipse extends to 115 deg.
#[test]
fn warns_about_a_contact_ellipse_wider_than_its_flank() {
    let warnings = |load: &str| {
        let mut drive = case(include_str!("../../../../examples/feed_drive.json"));
        drive.apply(&[load]).expect("known name");
        let problem = drive.problem(&Model::RacewayControl.into()).expect("complete");
        Record::new(problem.solve(&mut ModelWorkspace::default())).warnings(&drive)
    };
    assert!(warnings("axial_load_N=8e3").is_empty());
    let heavy = warnings("axial_load_N=1e6");
    assert!(heavy.iter().any(|w| w.contains("truncates the ellipse")), "{heavy:?}");
}

proptest! {
    /// The parser does not panic on arbitrary bytes.
    #[test]
    fn parser_survives_arbitrary_bytes(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let _ = Case::from_json(&bytes);
    }

    /// The parser does not panic on JSON with known or unknown keys.
    #[test]
    fn parser_survives_arbitrary_keys(key in "[a-z_]{0,30}", value in any::<f64>()) {
        let json = serde_json::json!({ key: value });
        if let Ok(case) = Case::from_json(json.to_string().as_bytes()) {
            let _ = case.problem(&Settings::default());
        }
        prop_assert!(!Rule::Above(0.0).holds(f64::NAN));
    }
}

/// The table shows the values of each contact in the column of this contact. It used to show the
/// ellipses of nut and screw under each other's headings.
#[test]
fn contact_columns_show_values_of_their_own_contact() {
    let json = include_bytes!("../../../../examples/feed_drive_oil.json");
    let case = Case::from_json(json).expect("an example");
    let problem = case.problem(&Settings::default()).expect("complete");
    let record = Record::new(problem.solve(&mut ModelWorkspace::default()));
    let rows = record.rows(&case);
    let rows: Vec<_> = rows.rows().filter(|row| row.quantity.scope == Scope::Contacts).collect();
    assert!(rows.len() > 10, "{rows:?}");
    for row in rows {
        let tail = row.quantity.name.strip_prefix("nut_").expect("of the nut first");
        let columns = row.quantity.columns.iter();
        for ((head, column), value) in Scope::Contacts.members().iter().zip(columns).zip(row.values)
        {
            let contact = if *head == "far flank" { "unloaded_flank" } else { head };
            assert_eq!(column.name, format!("{contact}_{tail}"));
            assert_eq!(
                value.is_some(),
                record.number(named(column.name)).is_some(),
                "{}",
                column.name
            );
        }
    }
}

/// The error names the smallest set of missing inputs with which a result can be calculated: inputs
/// of a catalog line if fewer of them are missing, otherwise inputs of the groove.
#[test]
fn error_names_the_smallest_set_of_missing_inputs() {
    let refusal = |json: &str| {
        let case = Case::from_json(json.as_bytes()).expect("a case");
        let error = NutProblem::of(&case, &Settings::default()).expect_err("inputs are missing");
        error.to_string()
    };
    let line = refusal(r#"{"nominal_diameter_mm": 16, "lead_mm": 5, "axial_load_N": 1200}"#);
    assert!(
        line.starts_with("rated_dynamic_load_N (or 7 inputs of the groove: ball_diameter_mm, "),
        "{line}"
    );
    let nothing = refusal(r#"{"lead_mm": 5, "axial_load_N": 1200}"#);
    for part in [
        "nominal_diameter_mm",
        "rated_dynamic_load_N",
        "(or 7 inputs of the groove: ball_diameter_mm, ",
    ] {
        assert!(nothing.contains(part) && !nothing.starts_with("ball"), "{nothing}");
    }
    let groove = refusal(
        r#"{"ball_diameter_mm": 3.175, "pitch_circle_diameter_mm": 16.75, "lead_mm": 5, "contact_angle_deg": 45,
        "nut_conformity": 0.52, "loaded_balls_per_turn": 15, "axial_load_N": 1200}"#,
    );
    assert!(!groove.contains("rated_dynamic_load_N"), "{groove}");
    assert!(
        groove.contains("screw_conformity and loaded_turns (or circuits) are required"),
        "{groove}"
    );
}
