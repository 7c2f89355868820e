//! Tests of motion and loads of an axis: moves, ramps, dwells, load at rest, brake and stop.

use approx::assert_relative_eq;
use bsm_case::{AxisReport, Case, CaseError, Numbers, Settings, Verdict, output};
use serde_json::{Map, Value, json};

use crate::named;

/// Adds a catalog screw without inertia to inputs that specify no screw. None of the compared
/// outputs depends on the screw.
fn with_catalog_screw(inputs: &Map<String, Value>) -> Map<String, Value> {
    let mut all = inputs.clone();
    let screw = [
        ("nominal_diameter_mm", 20.0),
        ("rated_dynamic_load_N", 1e4),
        ("rated_static_load_N", 1e4),
        ("guide_force_N", 1.0),
    ];
    let is_loaded = ["moved_mass_kg", "guide_force_N", "preload_N", "axial_load_N", "cycle"];
    let is_loaded = is_loaded.iter().any(|key| inputs.contains_key(*key));
    for (key, value) in screw {
        if key != "guide_force_N" || !is_loaded {
            all.entry(key).or_insert(json!(value));
        }
    }
    if !inputs.contains_key("screw_mass_kg_m") {
        all.insert("screw_inertia_kg_m2_m".to_owned(), json!(1e-30));
    }
    all
}

fn report(inputs: &Value) -> Result<AxisReport, CaseError> {
    let inputs = Value::Object(with_catalog_screw(inputs.as_object().expect("inputs")));
    let case = Case::from_json(inputs.to_string().as_bytes())?;
    AxisReport::of(&case, &Settings::default())
}

fn solved(inputs: &Value) -> AxisReport {
    report(inputs).unwrap_or_else(|why| panic!("{inputs}: {why}"))
}

fn near(report: &AxisReport, name: &str, expected: f64) {
    let value = report.number(named(name)).unwrap_or_else(|| panic!("no {name}"));
    let scale = expected.abs().max(1e-9);
    assert!((value - expected).abs() <= 1e-6 * scale, "{name}: {value}, expected {expected}");
}

/// Returns a horizontal axis with a lead of 10 mm, a mass of 100 kg and a guide friction of 20 N,
/// to which the given inputs are added.
fn axis(more: &Value) -> Value {
    let mut all = json!({ "lead_mm": 10, "moved_mass_kg": 100, "guide_force_N": 20 });
    for (key, value) in more.as_object().expect("inputs") {
        all[key] = value.clone();
    }
    all
}

/// The expected values were calculated independently of the program. All outputs agree to 1e-6.
#[test]
fn axis_results_match_independent_values() {
    let cases: Vec<Value> = serde_json::from_str(include_str!("motion.json")).expect("cases");
    assert_eq!(cases.len(), 23);
    for case in &cases {
        let report = solved(&case["inputs"]);
        for (name, expected) in case["expected"].as_object().expect("expected") {
            let what = format!("{}: {name}", case["name"]);
            if let Some(word) = expected.as_str() {
                let answer = report.answer.to_json();
                assert_eq!(answer[name], word, "{what}");
                continue;
            }
            let expected = expected.as_f64().expect("a number");
            let value = report.number(named(name)).unwrap_or_else(|| panic!("{what} is missing"));
            // If the expected value is zero, the error must be below 1e-9 in the unit of the
            // output.
            let error = (value - expected).abs();
            assert!(error <= 1e-6 * expected.abs() + 1e-9, "{what}: {value}, expected {expected}");
        }
    }
}

/// All forms of a required life are equivalent: a required life slightly below the calculated life
/// passes, and a required life slightly above it fails, in every unit.
#[test]
fn all_forms_of_the_required_life_are_equivalent() {
    let cycle = json!([
        { "distance_mm": 300, "time_s": 1.5, "acceleration_m_s2": 1.0, "force_N": 500 },
        { "distance_mm": -300, "time_s": 1.5, "acceleration_m_s2": 1.0 },
        { "dwell_s": 2.0 },
    ]);
    let of = |more: Value| {
        let mut all = json!({ "cycle": cycle, "stroke_mm": 300, "operating_h_day": 16, "operating_days_year": 250 });
        for (key, value) in more.as_object().expect("inputs") {
            all[key] = value.clone();
        }
        solved(&axis(&all))
    };
    let free = of(json!({}));
    let reached: Vec<_> = ["h", "revolutions", "km", "cycles", "strokes", "years"]
        .map(|unit| (unit, free.number(named(&format!("cycle_life_{unit}"))).expect(unit)))
        .into();
    for (unit, life) in reached {
        // The rule passes just below the calculated life and fails just above it.
        for (factor, passes) in [(0.999, true), (1.001, false)] {
            let report = of(json!({ format!("required_life_{unit}"): factor * life }));
            let rules = &report.answer.rules;
            let rule = rules.iter().find(|rule| rule.title == "life").expect("a rule");
            assert_eq!(rule.passes(), passes, "{unit} {factor}");
            let needed = report.number(output!(required_dynamic_load_N)).expect("a rating");
            let rating = report.number(output!(modified_dynamic_rating_N)).expect("a rating");
            let ratio = (needed / rating).powi(3) / factor;
            // The tolerance allows for rounding errors of the ratings, whose ratio is raised to the
            // third power.
            assert!((ratio - 1.0).abs() < 1e-12, "{unit}: {ratio}");
        }
    }
}

#[test]
fn error_states_why_a_required_life_cannot_be_checked() {
    let refused = |more: Value, part: &str| {
        let why = report(&axis(&more)).expect_err(part).to_string();
        assert!(why.contains(part), "{why}");
    };
    refused(json!({ "feed_m_min": 10, "required_life_cycles": 1e5 }), "needs a cycle");
    refused(json!({ "feed_m_min": 10, "required_life_strokes": 1e5 }), "needs stroke_mm");
    refused(json!({ "feed_m_min": 10, "required_life_years": 5 }), "needs operating_h_day");
    refused(
        json!({ "feed_m_min": 10, "required_life_km": 5, "required_life_h": 5 }),
        "both are given",
    );
}

#[test]
fn motor_curve_replaces_motor_torques_and_limits_the_speed() {
    let row = |speed: f64, torque: f64| json!({ "speed_rpm": speed, "peak_torque_Nm": 2.0 * torque, "continuous_torque_Nm": torque });
    let curve = json!([row(0.0, 2.0), row(3000.0, 1.0)]);
    let refused = |more: Value, part: &str| {
        let why = report(&axis(&more)).expect_err(part).to_string();
        assert!(why.contains(part), "{why}");
    };
    refused(
        json!({ "feed_m_min": 40, "motor_curve": curve }),
        "ends at 3000 rpm, but the motor turns at 4000 rpm",
    );
    refused(
        json!({ "feed_m_min": 10, "motor_curve": curve, "motor_peak_torque_Nm": 3 }),
        "both are given",
    );
    refused(
        json!({ "feed_m_min": 10, "motor_curve": [row(3000.0, 1.0), row(0.0, 2.0)] }),
        "in order of increasing speed_rpm",
    );
    let report = solved(&axis(&json!({ "feed_m_min": 15, "motor_curve": curve })));
    // In the hand calculation, the mean speed is halfway between two rows of the motor curve.
    near(&report, "continuous_torque_at_mean_speed_Nm", 1.5);
    let ratio = report.number(output!(peak_motor_torque_Nm)).expect("a torque") / 3.0;
    near(&report, "peak_torque_utilization", ratio);
    assert!(report.answer.rules.iter().any(|rule| rule.name == "rms_torque_utilization"));
}

/// Many catalogs state only the peak torque as a function of speed.
#[test]
fn motor_curve_without_continuous_torque_checks_only_the_peak_torque() {
    let curve = json!([[0.0, 4.0], [3000.0, 2.0]]);
    let report = solved(&axis(&json!({ "feed_m_min": 15, "motor_curve": curve })));
    let ratio = report.number(output!(peak_motor_torque_Nm)).expect("a torque") / 3.0;
    near(&report, "peak_torque_utilization", ratio);
    assert_eq!(report.number(named("continuous_torque_at_mean_speed_Nm")), None);
    let is_checked = |name| report.answer.rules.iter().any(|rule| rule.name == name);
    assert!(is_checked("peak_torque_utilization") && !is_checked("rms_torque_utilization"));
}

/// A phase with an acceleration is converted to a ramp. Its feed rate is the end speed if the axis
/// accelerates, and the start speed otherwise. The expected values were calculated by hand.
#[test]
fn phase_with_acceleration_is_converted_to_a_ramp() {
    let report = solved(&axis(&json!({ "cycle": [
        { "time_s": 0.5, "feed_m_min": 30, "acceleration_m_s2": 1.0 },
        { "time_s": 0.5, "feed_m_min": 30, "acceleration_m_s2": -1.0 },
        { "time_s": 0.5, "feed_m_min": -30, "acceleration_m_s2": -1.0 },
        { "time_s": 0.5, "feed_m_min": -30, "acceleration_m_s2": 1.0 },
    ] })));
    let feeds = [(0.0, 30.0), (30.0, 0.0), (0.0, -30.0), (-30.0, 0.0)];
    for (phase, (start, end)) in report.phases.iter().zip(feeds) {
        for (name, expected) in [("start_feed_m_min", start), ("end_feed_m_min", end)] {
            let feed = phase.number(named(name)).expect("a feed");
            assert!((feed - expected).abs() < 1e-9, "{name}: {feed}, expected {expected}");
        }
    }
    near(&report, "travel_per_cycle_mm", 500.0);
    near(&report, "cycle_range_mm", 250.0);
    near(&report, "speed_jumps_count", 0.0);
    let note = "Entry 1 of the cycle has an acceleration, so it is a ramp from 0 to 30 m/min.";
    assert!(report.answer.notes.iter().any(|own| own == note), "{:?}", report.answer.notes);
    assert!(report.answer.warnings.iter().all(|w| !w.contains("cycle")));
}

/// A cycle of moves gives the same results as the equivalent cycle of ramps, which are given by
/// their start and end speeds.
#[test]
fn moves_and_equivalent_ramps_give_equal_results() {
    let moves = json!([
        { "distance_mm": 300, "time_s": 1.5, "acceleration_m_s2": 1.0, "force_N": 50 },
        { "dwell_s": 0.5 },
        { "distance_mm": -300, "max_feed_m_min": 30, "acceleration_m_s2": 2.0, "deceleration_m_s2": 1.0 },
    ]);
    let of_moves = solved(&axis(&json!({ "cycle": moves })));
    let top = (1.5 - (1.5_f64 * 1.5 - 1.2).sqrt()) / 2.0;
    let back = 0.5;
    let rest = (0.3 - 0.5 * back * (back / 2.0 + back)) / back;
    let ramp = |time: f64, start: f64, end: f64, force: f64| json!({ "time_s": time, "start_feed_m_min": 60.0 * start, "end_feed_m_min": 60.0 * end, "force_N": force });
    let of_ramps = solved(&axis(&json!({ "cycle": [
        ramp(top, 0.0, top, 50.0),
        ramp(1.5 - 2.0 * top, top, top, 50.0),
        ramp(top, top, 0.0, 50.0),
        { "dwell_s": 0.5 },
        ramp(0.25, 0.0, -back, 0.0),
        ramp(rest, -back, -back, 0.0),
        ramp(0.5, -back, 0.0, 0.0),
    ] })));
    for name in [
        "equivalent_load_N",
        "mean_heat_W",
        "rms_motor_torque_Nm",
        "peak_motor_torque_Nm",
        "peak_motor_power_W",
        "regenerated_energy_J",
        "travel_per_cycle_mm",
        "cycle_time_s",
        "cycle_life_h",
    ] {
        near(&of_ramps, name, of_moves.number(named(name)).expect("a number"));
    }
}

#[test]
fn error_states_what_is_wrong_with_a_cycle_entry() {
    let refused = |more: Value, part: &str| {
        let why = report(&axis(&more)).expect_err("refused").to_string();
        assert!(why.contains(part), "{why}: no {part}");
    };
    let cycle = |entry: Value| json!({ "cycle": [entry] });
    refused(
        cycle(json!({ "distance_mm": 300, "time_s": 0.5, "acceleration_m_s2": 1.0 })),
        "at least 1.0954 s",
    );
    refused(
        cycle(json!({ "distance_mm": 300, "time_s": 0.5 })),
        "either profile or acceleration_m_s2",
    );
    refused(
        cycle(json!({ "distance_mm": 300, "profile": "triangular" })),
        "either time_s or max_feed_m_min",
    );
    refused(cycle(json!({ "distance_mm": 300, "time_s": 1, "profile": "round" })), "`trapezoidal`");
    refused(
        cycle(json!({ "distance_mm": 300, "time_s": 1, "acceleration_m_s2": -1 })),
        "must be positive",
    );
    refused(
        cycle(json!({ "distance_mm": 0, "time_s": 1, "acceleration_m_s2": 1 })),
        "give dwell_s",
    );
    refused(cycle(json!({ "dwell_s": 1, "feed_m_min": 1 })), "cannot have feed_m_min");
    refused(
        cycle(json!({ "share": 1, "feed_m_min": 1, "acceleration_m_s2": 1 })),
        "cannot have a share",
    );
    refused(cycle(json!({ "share": 1, "end_feed_m_min": 1 })), "cannot have a share");
    refused(
        cycle(json!({ "time_s": 1, "feed_m_min": 6, "acceleration_m_s2": 1 })),
        "through standstill",
    );
    refused(cycle(json!({ "time_s": 1, "end_feed_m_min": 6, "end_force_N": 1 })), "constant speed");
    refused(
        json!({ "stroke_mm": 50, "cycle": [{ "time_s": 1, "feed_m_min": 6 }] }),
        "moves over 100 mm",
    );
    refused(
        json!({ "cycles_per_hour": 3601, "cycle": [{ "time_s": 1, "feed_m_min": 6 }] }),
        "at most 3600 cycles per hour",
    );
}

/// If the time shares add up to less than 1, the axis is at standstill for the rest of the time. A
/// sum of 100 means percentages, and other sums above 1 are rejected. Results per cycle require
/// durations instead of time shares.
#[test]
fn axis_is_at_rest_for_the_time_not_covered_by_the_time_shares() {
    let of = |shares: [f64; 2]| {
        let phase = |share: f64, feed: f64| json!({ "share": share, "feed_m_min": feed });
        report(&axis(&json!({ "cycle": [phase(shares[0], 6.0), phase(shares[1], -6.0)] })))
    };
    let whole = of([0.5, 0.5]).expect("whole");
    let half = of([0.25, 0.25]).expect("half");
    let percent = of([50.0, 50.0]).expect("percent");
    let heat = whole.number(output!(mean_heat_W)).expect("heat");
    near(&half, "mean_heat_W", 0.5 * heat);
    near(&percent, "mean_heat_W", heat);
    near(&half, "cycle_life_h", 2.0 * whole.number(output!(cycle_life_h)).expect("life"));
    assert_eq!(half.phases.len(), 3);
    assert_eq!(half.number(output!(travel_per_cycle_mm)), None);
    assert_eq!(half.number(output!(regenerated_energy_J)), None);
    let note = "The shares of the cycle sum to 0.5. The axis is at standstill for the remaining share of 0.5.";
    assert!(half.answer.notes.iter().any(|own| own == note));
    assert!(of([0.6, 0.6]).expect_err("refused").to_string().contains("sum to 1.2"));
    assert!(of([1e308, 1e308]).is_err());
}

/// `cycles_per_hour` fills the time between cycles with standstill. Here the axis moves for 1 s out
/// of 10 s.
#[test]
fn standstill_fills_the_time_between_cycles() {
    let cycle = json!([{ "time_s": 0.5, "feed_m_min": 6 }, { "time_s": 0.5, "feed_m_min": -6 }]);
    let alone = solved(&axis(&json!({ "cycle": cycle })));
    let spaced = solved(&axis(&json!({ "cycle": cycle, "cycles_per_hour": 360 })));
    near(&spaced, "cycle_time_s", 10.0);
    near(&spaced, "mean_heat_W", 0.1 * alone.number(output!(mean_heat_W)).expect("heat"));
    near(&spaced, "cycle_life_h", 10.0 * alone.number(output!(cycle_life_h)).expect("life"));
    near(
        &spaced,
        "regenerated_energy_J",
        alone.number(output!(regenerated_energy_J)).expect("energy"),
    );
}

/// For two phases of 1e308 s, the program used to calculate time shares of 0 and no life. For two
/// phases of 1e300 s, it used to calculate a life of 0 h.
#[test]
fn long_phase_durations_do_not_overflow() {
    let of = |time: f64| {
        let phase = |feed: f64| json!({ "time_s": time, "feed_m_min": feed, "force_N": 5000 });
        report(&axis(&json!({ "stroke_mm": 1e305, "unsupported_length_mm": 1e306,
            "cycle": [phase(6.0), phase(-6.0)] })))
    };
    let why = of(1e308).expect_err("refused").to_string();
    assert!(why.contains("is too large"), "{why}");
    let long = of(1e300).expect("finite");
    let short = of(1.0).expect("finite");
    near(&long, "cycle_life_h", short.number(output!(cycle_life_h)).expect("life"));
    near(&long, "mean_heat_W", short.number(output!(mean_heat_W)).expect("heat"));
}

#[test]
fn warns_about_cycles_with_speed_jumps_or_without_return_to_start() {
    let report = solved(&axis(&json!({ "cycle": [
        { "time_s": 1, "feed_m_min": 6 }, { "time_s": 0.8, "feed_m_min": -6 },
    ] })));
    let has = |part: &str| report.answer.warnings.iter().any(|own| own.contains(part));
    assert!(has("but ends 20 mm away"), "{:?}", report.answer.warnings);
    assert!(
        has("jumps 2 times in the cycle. The largest jump is from 6 to -6 m/min"),
        "{:?}",
        report.answer.warnings
    );
    near(&report, "speed_jumps_count", 2.0);
}

/// The process force may be zero, missing or negative. Only an axis on which no load acts at all is
/// rejected.
#[test]
fn process_force_may_be_absent_zero_or_negative() {
    let mass =
        json!({ "lead_mm": 10, "moved_mass_kg": 35, "inclination_deg": 90, "feed_m_min": 6 });
    let weight = 35.0 * 9.806_65;
    near(&solved(&mass), "largest_load_N", weight);
    for (force, load) in [(0.0, weight), (-100.0, weight - 100.0), (-400.0, 400.0 - weight)] {
        let mut case = mass.clone();
        case["axial_load_N"] = json!(force);
        near(&solved(&case), "largest_load_N", load);
        // An axial load that is given without a cycle does not act at rest.
        near(&solved(&case), "rest_load_N", weight);
    }
    let nothing = json!({ "lead_mm": 10, "axial_load_N": 0, "feed_m_min": 6 });
    let why = report(&nothing).expect_err("refused").to_string();
    assert!(why.contains("no load acts on the screw"), "{why}");
}

/// A new load or speed used to have no effect on an axis with a cycle, so that a table with a
/// varied load contained the same results in all rows.
#[test]
fn a_new_load_or_speed_replaces_the_cycle() {
    let cycle = json!([{ "force_N": 2000, "screw_speed_rpm": 300, "time_s": 1 }]);
    let inputs = json!({ "lead_mm": 10, "cycle": cycle });
    let inputs = Value::Object(with_catalog_screw(inputs.as_object().expect("inputs")));
    let mut case = Case::from_json(inputs.to_string().as_bytes()).expect("a case");
    let load = |case: &Case| {
        let report = AxisReport::of(case, &Settings::default()).expect("a sheet");
        report.number(output!(largest_load_N)).expect("a load")
    };
    assert_relative_eq!(load(&case), 2000.0, max_relative = 1e-12);
    case.apply(&["axial_load_N=500", "screw_speed_rpm=100"]).expect("settings");
    assert_relative_eq!(load(&case), 500.0, max_relative = 1e-12);
    assert!(case.entries.cycle.is_none());
    case.apply(&[&format!("cycle={}", inputs["cycle"])]).expect("a cycle");
    let report = AxisReport::of(&case, &Settings::default()).expect("a sheet");
    let text = "These inputs have no effect beside a cycle: screw_speed_rpm, axial_load_N.";
    let warnings = &report.answer.warnings;
    assert!(warnings.iter().any(|warning| warning.contains(text)), "{warnings:?}");
}

/// The process force of a jack or a lift also acts at rest. The program cannot know this from
/// `axial_load_N`, so a note must state which assumption is made.
#[test]
fn axial_load_acts_at_rest_only_if_specified_as_hold_force() {
    let jack = |hold: Option<f64>| {
        let mut case = json!({ "lead_mm": 6, "axial_load_N": 12000, "screw_speed_rpm": 100 });
        case["hold_force_N"] = hold.into();
        solved(&case).answer.notes
    };
    let says = |notes: &[String], text: &str| notes.iter().any(|note| note.contains(text));
    let moving = jack(None);
    assert!(says(&moving, "No force acts at rest"), "{moving:?}");
    assert!(says(&moving, "if the 12000 N also act at rest, give hold_force_N"), "{moving:?}");
    let holding = jack(Some(12000.0));
    assert!(says(&holding, "12000 N acts at rest") && !says(&holding, "only during motion"));
}

/// If one end of the screw is free, the load may be unguided, as in a jack. The buckling load of a
/// jack is a sixteenth of the buckling load with a guided table.
#[test]
fn buckling_rule_is_undecided_for_a_free_end_unless_buckling_support_is_given() {
    let jack = |load: f64, buckling: &str| {
        let mut case = json!({
            "lead_mm": 6, "axial_load_N": load, "screw_speed_rpm": 100,
            "support": "fixed-free", "unsupported_length_mm": 800, "shaft_diameter_mm": 16,
        });
        if !buckling.is_empty() {
            case["buckling_support"] = buckling.into();
        }
        let report = solved(&case);
        let rules = &report.answer.rules;
        let rule = rules.iter().find(|rule| rule.title == "buckling").expect("a rule").clone();
        (rule.verdict(), rule.remedy.unwrap_or_default())
    };
    // The Euler load of the jack is 0.25 pi^2 E I/l^2 = 2.56 kN. With a guided nut, it is 41 kN.
    assert_eq!(jack(12e3, "fixed-fixed").0, Verdict::Passes);
    assert_eq!(jack(12e3, "fixed-free").0, Verdict::Fails);
    let (verdict, remedy) = jack(12e3, "");
    assert_eq!(verdict, Verdict::Undecided);
    assert!(remedy.contains("buckling_support fixed-fixed"), "{remedy}");
    assert_eq!(jack(1e3, "").0, Verdict::Passes);
    assert_eq!(jack(30e3, "").0, Verdict::Fails);
}

/// The program used to report that guide friction back-drives a horizontal axis that moves 100 kg,
/// and that inertia back-drives an accelerated axis.
#[test]
fn friction_and_inertia_do_not_back_drive_the_screw() {
    let report = solved(&json!({
        "lead_mm": 10, "moved_mass_kg": 100, "guide_friction": 0.02, "guide_force_N": 28,
        "cycle": [{ "distance_mm": 300, "time_s": 1, "profile": "trapezoidal" },
                  { "distance_mm": -300, "time_s": 1, "profile": "trapezoidal" }],
    }));
    let note = "No force acts at rest, so the axis needs no holding torque and no brake.";
    assert!(report.answer.notes.iter().any(|own| own == note), "{:?}", report.answer.notes);
    assert!(report.answer.notes.iter().all(|own| !own.contains("back-driv")));
    // If no force acts at rest, the screen shows this note instead of seven outputs whose value is
    // zero. The zeros appear only in the JSON output.
    near(&report, "holding_torque_Nm", 0.0);
    near(&report, "required_brake_torque_Nm", 0.0);
    assert_eq!(report.answer.to_json()["back_driving"], "none");
    let at_rest = |name: &str| {
        ["rest_", "holding_", "required_brake", "back_driv"]
            .iter()
            .any(|part| name.starts_with(part))
    };
    let shown = report.answer.numbers().flat_map(Numbers::rows).map(|row| row.quantity.name);
    assert_eq!(shown.filter(|name| at_rest(name)).collect::<Vec<_>>(), Vec::<&str>::new());
    let upright = solved(
        &json!({ "lead_mm": 10, "moved_mass_kg": 100, "inclination_deg": 90, "feed_m_min": 6 }),
    );
    let shown = upright.answer.numbers().flat_map(Numbers::rows).map(|row| row.quantity.name);
    assert_eq!(shown.filter(|name| at_rest(name)).count(), 6);
}

/// For a vertical axis that moves 10 kg with a drag torque of 0.15 N m, the program used to report
/// an efficiency of -1.12.
#[test]
fn efficiency_is_null_if_the_drag_exceeds_the_load_torque() {
    let report = solved(&json!({
        "lead_mm": 5, "moved_mass_kg": 10, "inclination_deg": 90, "seal_torque_Nm": 0.15,
        "feed_m_min": -6,
    }));
    assert_eq!(report.number(output!(screw_efficiency)), None);
    assert!(report.number(output!(screw_torque_Nm)).expect("a torque") < 0.0);
}

/// `brake_at_rest` relieves the motor at standstill. The expected values were calculated by hand
/// for a vertical axis that moves 250 kg with a lead of 10 mm and is at rest for half of the time.
#[test]
fn holding_brake_relieves_the_motor_at_standstill() {
    let of = |brake: bool| {
        solved(&json!({
            "lead_mm": 10, "moved_mass_kg": 250, "inclination_deg": 90, "brake_at_rest": brake,
            "cycle": [{ "distance_mm": 100, "time_s": 1, "profile": "triangular" },
                      { "distance_mm": -100, "time_s": 1, "profile": "triangular" }, { "dwell_s": 2 }],
        }))
    };
    let square = |report: &AxisReport| {
        report.number(output!(rms_motor_torque_Nm)).expect("a torque").powi(2)
    };
    let holding = 250.0 * 9.806_65 * 0.01 / std::f64::consts::TAU;
    let difference = square(&of(false)) - square(&of(true));
    assert!((difference / (0.5 * holding * holding) - 1.0).abs() < 1e-9, "{difference}");
}
