//! Tests of motor, brake and preload on the axis sheet.

use bsm_case::{
    AxisReport, Case, Catalog, DesignReport, NutProblem, RequirementFile, Settings, output,
};

use crate::size::{AXIS, axis, near, number};

fn rule<'a>(report: &'a AxisReport, title: &str) -> &'a bsm_case::Criterion {
    let found = report.answer.rules.iter().find(|rule| rule.title == title);
    found.unwrap_or_else(|| panic!("no {title}"))
}

/// The loads match the example of THK, A-722 to A-746. The horizontal axis moves 80 kg, accelerates
/// to 1 m/s in 0.15 s, and has a guide friction coefficient of 0.003 and a resistance of 15 N
/// (printed 550, 17, -516, -550, -17, 516 N). The vertical axis moves 50 kg, accelerates to 0.3 m/s
/// in 0.2 s, and has a resistance of 20 N (printed 585, 510, 435, 395, 470, 545 N). The expected
/// values in the test have five digits.
#[test]
fn loads_of_two_transfer_axes_match_the_thk_catalog() {
    let cycle = |feed: f64, acceleration: f64| {
        let time = feed / 60.0 / acceleration;
        let phase = |feed: f64, a: f64| {
            format!(r#"{{"time_s":{time},"feed_m_min":{feed},"acceleration_m_s2":{a}}}"#)
        };
        let way = |sign: f64| {
            [acceleration, 0.0, -acceleration].map(|a| phase(sign * feed, sign * a)).join(",")
        };
        format!("cycle=[{},{}]", way(1.0), way(-1.0))
    };
    for (settings, cycle, loads) in [
        (
            ["moved_mass_kg=80", "guide_friction=0.003", "guide_force_N=15", "inclination_deg=0"],
            cycle(60.0, 1.0 / 0.15),
            [550.69, 17.354, -515.98, -550.69, -17.354, 515.98],
        ),
        (
            ["moved_mass_kg=50", "guide_friction=0.003", "guide_force_N=20", "inclination_deg=90"],
            cycle(18.0, 0.3 / 0.2),
            [585.33, 510.33, 435.33, 395.33, 470.33, 545.33],
        ),
    ] {
        let report = axis(&[&settings[..], &[&cycle, "preload_N=500"]].concat());
        for (phase, load) in report.phases.iter().zip(loads) {
            near(phase.number(output!(screw_load_N)).expect("a load"), load, 3e-5, "load");
        }
    }
}

/// Motor limits are checked by rules with remedies. Without motor limits, these rules are omitted.
#[test]
fn motor_limits_are_checked_by_rules() {
    let titles = |more: &[&str]| -> Vec<_> {
        let report = axis(more);
        report.answer.rules.iter().map(|rule| (rule.title, rule.passes())).collect()
    };
    assert!(!titles(&[]).iter().any(|(title, _)| title.contains("of the motor")));
    let cycle = r#"cycle=[{"time_s":0.25,"feed_m_min":30,"acceleration_m_s2":2},{"time_s":1,"feed_m_min":30},{"time_s":2}]"#;
    let report = axis(&[
        cycle,
        "motor_max_speed_rpm=1000",
        "motor_peak_torque_Nm=12",
        "motor_rated_torque_Nm=1",
        "motor_rated_power_W=9000",
        "largest_inertia_ratio=1",
    ]);
    // The feed rate is 30 m/min at a lead of 20 mm.
    near(number(&report, "motor_speed_rpm"), 1500.0, 1e-9, "speed");
    let speed = rule(&report, "motor speed");
    assert!(
        speed.remedy.as_ref().is_some_and(|help| help.contains("lead_mm of at least 30.0")),
        "{speed:?}"
    );
    assert!(!rule(&report, "rated torque of the motor").passes());
    assert!(rule(&report, "power of the motor").passes());
    assert!(!rule(&report, "inertia ratio").passes());
    // The shortest ramp in the cycle takes v/a = 0.25 s. The shortest possible ramp at peak torque
    // takes J (2 pi 25 rad/s)/(T_peak - T_load).
    near(number(&report, "shortest_ramp_s"), 0.25, 1e-12, "ramp");
    let inertia = number(&report, "inertia_at_motor_kg_m2") + 0.01;
    let steady = report.phases[1].number(output!(motor_torque_Nm)).expect("a torque");
    let least = inertia * 50.0 * std::f64::consts::PI / (12.0 - steady);
    near(number(&report, "least_acceleration_time_s"), least, 1e-12, "time");
    // HIWIN requires 1.5 times the acceleration time at the rated torque. With a rated torque of 1
    // N m, the axis cannot accelerate at all.
    assert_eq!(report.number(output!(least_rated_acceleration_time_s)), None);
    let rated = axis(&[cycle, "motor_rated_torque_Nm=12"]);
    near(number(&rated, "least_rated_acceleration_time_s"), 1.5 * least, 1e-12, "rated time");
    // With a gear, the motor turns faster, and the gear losses increase the motor torque.
    let (plain, geared) = (axis(&[]), axis(&["gear_ratio=2", "gear_efficiency=0.8"]));
    near(number(&geared, "motor_speed_rpm"), 3000.0, 1e-9, "gear");
    let half = number(&plain, "peak_motor_torque_Nm") / 2.0 / 0.8;
    near(number(&geared, "peak_motor_torque_Nm"), half, 1e-9, "gear");
}

/// For a vertical axis that moves 250 kg, the brake torque is checked without friction. The sheet
/// also states the stopping distance and the speed after a fall.
#[test]
fn brake_torque_is_checked_by_a_rule() {
    let with = |more: &[&str]| {
        let upright = ["inclination_deg=90", "moved_mass_kg=250", "guide_friction=0"];
        axis(&[&upright, more].concat())
    };
    let report = with(&["brake_torque_Nm=20"]);
    let ideal = 250.0 * 9.806_65 * 20e-3 / std::f64::consts::TAU;
    near(number(&report, "holding_torque_frictionless_Nm"), ideal, 1e-12, "weight");
    near(number(&report, "required_brake_torque_Nm"), 1.5 * ideal, 1e-12, "brake");
    assert!(rule(&report, "brake").passes() && number(&report, "stopping_distance_mm") > 0.0);
    let [low, nominal, high] =
        ["_low", "", "_high"].map(|end| number(&report, &format!("back_driving_torque{end}_Nm")));
    assert!(low < nominal && nominal < high && high < ideal, "{low} {nominal} {high} {ideal}");
    let fall = number(&report, "fall_acceleration_m_s2");
    let feed = (2.0_f64 * fall * 1.2).sqrt();
    near(number(&report, "fall_speed_rpm"), feed * 60.0 / 20e-3, 1e-12, "fall");
    let weak = with(&["brake_torque_Nm=7"]);
    assert!(!rule(&weak, "brake").passes() && weak.number(output!(stopping_distance_mm)).is_none());
    assert!(weak.answer.notes.iter().any(|note| note.contains("brake is too weak")));
    // The load on a horizontal axis cannot fall.
    assert!(axis(&["brake_torque_Nm=1"]).answer.rules.iter().all(|rule| rule.title != "brake"));
}

/// The preload can be given by its class, or it can be calculated from the load: a load of 10 049 N
/// requires a preload of 3552.9 N, which is rounded up to 3600 N, the next step in catalogs. The
/// same preload is used on the axis sheet, in the nut with all its balls, and in a selection.
#[test]
fn preload_can_be_specified_by_class_or_derived_from_the_load() {
    let case = |more: &[&str]| {
        let mut case = Case::from_json(AXIS).expect("an example");
        case.preload_N = None;
        case.apply(more).expect("settings");
        case
    };
    let sheet = |more: &[&str]| AxisReport::of(&case(more), &Settings::default());
    for words in [r#"preload_N="auto""#, "preload_class=auto"] {
        let report = sheet(&[words]).expect("an axis");
        near(number(&report, "cold_preload_N"), 3600.0, 1e-12, words);
        // With the smallest sufficient preload, the remaining preload calculated with all balls is
        // within a few percent of its limit.
        assert!(rule(&report, "remaining preload").margin().expect("a limit") > 0.95);
    }
    let medium = case(&["preload_class=P3"]);
    let report = AxisReport::of(&medium, &Settings::default()).expect("an axis");
    let rating = number(&report, "dynamic_load_rating_N");
    near(number(&report, "cold_preload_N"), 0.05 * rating, 1e-12, "medium");
    let nut = NutProblem::of(&medium, &Settings::default()).expect("a nut").solve();
    let nut = nut.expect("a solution");
    near(nut.number(output!(cold_preload_N)).expect("a preload"), 0.05 * rating, 1e-12, "nut");
    // A nut that is preloaded by an offset or by oversize balls may have at most half the preload
    // of a double nut.
    assert!(rule(&report, "preload").passes());
    let limit = rule(&report, "preload").limit.expect("a limit");
    near(limit, 0.1 * rating, 1e-12, "double nut");
    let offset = sheet(&["preload_class=P4", "preload_by=offset"]).expect("an axis");
    let broken = rule(&offset, "preload");
    let help = broken.remedy.as_deref().expect("it fails");
    assert!(help.contains("with which one nut unloads above"), "{help}");
    for (settings, words) in [
        (&["preload_class=P3", "preload_N=1000"][..], "preload_class"),
        (&["preload_class=P9"], "not one of auto"),
    ] {
        let mut both = case(&[]);
        let refused = both
            .apply(settings)
            .and_then(|()| AxisReport::of(&both, &Settings::default()).map(|_| ()));
        let refused = refused.expect_err("refused").to_string();
        assert!(refused.contains(words), "{refused}");
    }
    let one_ball = medium.problem(&Settings::default()).expect_err("of one ball").to_string();
    assert!(one_ball.contains("`axis`"), "{one_ball}");
    // The preload is calculated for each candidate and written to the case as a force.
    let catalog = Catalog::standard().expect("compiled in");
    let json = br#"{"axial_load_N": 5000, "feed_m_min": 15, "stroke_mm": 500, "required_life_h": 10000, "preload_N": "auto",
        "friction_coefficient": 0.05, "motor_max_speed_rpm": 1000}"#;
    let requirement = RequirementFile::from_json(json, &[], catalog.lists.clone()).expect("keys");
    let report = DesignReport::standard(&requirement, &catalog).expect("sizes");
    assert!(report.found, "{:?}", report.reasons);
    // The preload of 5000/2.828 = 1767.8 N is rounded up to the next catalog step.
    assert_eq!(report.case.preload_N, Some(1800.0));
    let speed = report.rows.iter().find(|row| row.name == "motor_speed_rpm").expect("a row");
    assert!(speed.value.is_some_and(|rpm| rpm <= 1000.0) && speed.requirement.is_some());
}

/// The position resolution of a motor and the stopping distance of an axis can be calculated
/// without load and ratings.
#[test]
fn resolution_and_stopping_distance_need_no_load() {
    let sheet = |json: &str| {
        let case = Case::from_json(json.as_bytes()).expect("a case");
        AxisReport::of(&case, &Settings::default()).expect("a sheet")
    };
    let steps = sheet(r#"{"lead_mm": 5, "motor_steps_per_turn": 200, "microsteps_count": 16}"#);
    // The expected value is 5 mm / 3200 steps. The tolerance allows for one rounding error.
    assert!((steps.number(output!(travel_per_step_um)).expect("a step") - 1.5625).abs() < 1e-12);
    let stop = sheet(r#"{"lead_mm": 10, "feed_m_min": 15, "stop_deceleration_m_s2": 5}"#);
    // Hand calculation: 0.25 m/s for 50 ms, and then (0.25 m/s)^2 / (2 * 5 m/s^2).
    assert!((stop.number(output!(stopping_distance_mm)).expect("a distance") - 18.75).abs() < 1e-9);
}
