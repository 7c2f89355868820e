//! Tests of the screw as a shaft on the axis sheet: pretension, buckling, hollow screws, short
//! strokes and speed number.

use bsm_case::{AxisReport, Case, output};

use crate::size::{axis, near, number};

/// Screw of a machining center, THK BNFN4010-5 between two fixed bearings, for which the expected
/// values were calculated independently.
const CENTER: [&str; 8] = [
    "pitch_circle_diameter_mm=41.75",
    "lead_mm=10",
    "ball_diameter_mm=6.35",
    "screw_outer_diameter_mm=40",
    "youngs_modulus_GPa=206",
    "shaft_diameter_mm=34.4",
    "unsupported_length_mm=1450",
    "stroke_mm=1000",
];

/// Stiffness of nearly rigid bearings, whose compliance does not change the first ten digits of any
/// result.
const RIGID: &str = "support_bearing_stiffness_N_um=1e12";

fn center(more: &[&str]) -> AxisReport {
    axis(&[&CENTER[..], &["support=fixed-fixed", "feed_m_min=20"], more].concat())
}

fn rule<'a>(report: &'a AxisReport, title: &str) -> &'a bsm_case::Criterion {
    let found = report.answer.rules.iter().find(|rule| rule.title == title);
    found.unwrap_or_else(|| panic!("no {title}"))
}

fn has_note(report: &AxisReport, words: &str) -> bool {
    report.answer.notes.iter().any(|note| note.contains(words))
}

/// The expected values are accurate to five digits. The deformation of bearings with a stiffness of
/// 750 N/um is not negligible.
#[test]
fn pretension_force_is_calculated_and_checked_by_a_rule() {
    let report = center(&[RIGID, "pretension_K=3", "screw_temperature_rise_K=2"]);
    for (name, value) in [
        ("critical_speed_rpm", 4476.7),
        ("critical_speed_ratio", 0.446_75),
        ("buckling_load_N", 265_885.0),
        ("screw_stiffness_N_um", 528.16),
        ("pretension_N", 6605.3),
        ("stretch_um", 50.025),
        ("travel_compensation_um", -34.5),
        ("screw_tension_N", 6605.3 / 3.0),
        // The expected value from a hand calculation is 4476.7 √(1 + 6605.3/265885).
        ("stretched_critical_speed_rpm", 4531.96),
    ] {
        near(number(&report, name), value, 2e-5, name);
    }
    assert!(rule(&report, "remaining pretension").passes());
    let soft = center(&["pretension_K=3", "support_bearing_stiffness_N_um=750"]);
    near(number(&soft, "pretension_N"), 4885.2, 1e-5, "soft bearings");
    near(number(&soft, "stretch_um"), 36.998, 2e-5, "soft bearings");
    // At 8 K above the bed, the screw has lost its tension, and its compression reduces the
    // buckling safety.
    let warm = center(&[RIGID, "pretension_K=3", "screw_temperature_rise_K=8"]);
    near(number(&warm, "screw_tension_N"), -11_008.8, 1e-5, "warm");
    let slack = rule(&warm, "remaining pretension");
    let help = slack.remedy.as_deref().expect("it fails");
    assert!(help.contains("pretension_K 8, because the screw loses its pretension above a temperature rise of 3.0 K"), "{help}");
    let pressed = number(&warm, "largest_load_N") + 11_008.8;
    let safety = number(&warm, "buckling_load_N") / pressed;
    near(number(&warm, "buckling_safety"), safety, 1e-5, "buckling");
    // A pretension that is given as a force has the same effect as the equivalent temperature
    // difference.
    let by_force = center(&[RIGID, "pretension_N=6605.3", "screw_temperature_rise_K=2"]);
    near(number(&by_force, "pretension_K"), 3.0, 1e-5, "kelvin");
    let bearings = center(&["pretension_K=3", "support_bearing_axial_load_N=10000"]);
    assert!(!rule(&bearings, "support bearings").passes());
    for (more, words) in [
        (&["pretension_K=3", "support=fixed-supported"][..], "fixed-fixed"),
        (&["pretension_K=3", "pretension_N=1"], "both are"),
        (&["screw_bore_mm=28"], "0.8 of the core"),
        (&["fold_search_factor=3"], "no effect unless warm_state"),
        (&["end_conductance_W_K=3", "axis_heat_transfer_W_K=5"], "replaces the thermal network"),
    ] {
        let mut case = Case::from_json(super::size::AXIS).expect("an example");
        case.apply(&[&CENTER[..], &["support=fixed-fixed"]].concat()).expect("settings");
        case.apply(more).expect("settings");
        let refused = AxisReport::of(&case, &bsm_case::Settings::default());
        let refused = refused.expect_err("refused").to_string();
        assert!(refused.contains(words), "{refused}");
    }
}

/// The expected values are from THK, A-726. The section between bearing and nut is clamped at both
/// ends and can carry 1.96 times the load of a section that can tilt at one end. If the screw can
/// tilt at both bearings, both ends of the section are assumed to tilt.
#[test]
fn buckling_is_checked_between_bearing_and_nut() {
    let load = |more: &[&str]| number(&axis(more), "buckling_load_N");
    let tilting = load(&["buckling_support=fixed-supported"]);
    // The ratio is 4 divided by 2.0457, which follows from the first root of tan x = x.
    near(load(&[]) / tilting, 4.0 / 2.045_748_515_938_296, 1e-12, "fixed-fixed");
    near(
        load(&["support=supported-supported"]) / tilting,
        1.0 / 2.045_748_515_938_296,
        1e-12,
        "tilts",
    );
    near(
        load(&["buckling_length_mm=710"]) / load(&["buckling_length_mm=1420"]),
        4.0,
        1e-12,
        "length",
    );
    let source = |settings: &[&str]| {
        let report = axis(settings);
        let rule = report.answer.rules.iter().find(|rule| rule.title == "buckling");
        rule.expect("a rule").source.clone().into_owned()
    };
    assert!(source(&[]).contains("fixed-fixed (default)"));
    assert!(!source(&["buckling_support=fixed-fixed"]).contains("(default)"));
}

/// A bore of 20 mm reduces the cross section, moment of inertia and mass of the screw by the values
/// of a rod with this diameter.
#[test]
fn screw_bore_reduces_area_inertia_and_mass() {
    let (solid, hollow) = (axis(&[]), axis(&["screw_bore_mm=20"]));
    let change = |name: &str| number(&solid, name) - number(&hollow, name);
    let (rod, length) =
        (std::f64::consts::PI / 4.0 * 400.0, number(&solid, "unsupported_length_mm"));
    let mass = 7850e-9 * rod * length;
    near(change("screw_mass_kg"), mass, 1e-9, "mass");
    near(change("inertia_of_screw_kg_m2"), mass * 400e-6 / 8.0, 1e-9, "inertia");
    near(change("yield_load_N"), 147.0 * rod, 1e-9, "section");
    assert!(change("critical_speed_rpm") < 0.0 && change("buckling_load_N") > 0.0);
    let stated = axis(&["screw_inertia_kg_m2_m=0.01"]);
    assert!(has_note(&stated, "Catalogs often state the moment of inertia of a solid rod"));
    near(number(&stated, "inertia_of_screw_kg_m2"), 0.01e-3 * length, 1e-12, "as stated");
}

/// A note is given for a stroke below three nut lengths, for a stroke below one ball circulation,
/// and for a stroke below half a turn.
#[test]
fn axis_sheet_contains_a_note_about_short_strokes() {
    // The two nuts are 380 mm long in total.
    let with = |stroke: &str| axis(&[stroke, "unsupported_length_mm=1620"]);
    assert!(!has_note(&with("stroke_mm=1200"), "stroke of less"));
    assert!(has_note(&with("stroke_mm=500"), "three nut lengths"));
    assert!(has_note(&with("stroke_mm=200"), "does not circulate"));
    let still = with("stroke_mm=9");
    assert!(has_note(&still, "false brinelling") && still.number(output!(cycle_life_h)).is_none());
    // If the life cannot be calculated, the rule for the required life is violated.
    let life = rule(&still, "life");
    assert!(!life.passes() && life.remedy.is_none(), "{life:?}");
}

/// The manufacturing method determines the speed number limit of the ball return. The limit for a
/// rolled screw also depends on the lead: a lead of 20 mm is less than half of the screw diameter,
/// 62 mm.
#[test]
fn limit_of_the_speed_number_depends_on_the_manufacturing_method() {
    let limit = |make: &str| {
        let given: Vec<_> = [make].into_iter().filter(|make| !make.is_empty()).collect();
        let mut case = Case::from_json(super::size::AXIS).expect("an example");
        case.speed_number_limit_mm_min = None;
        case.apply(&given).expect("settings");
        let report = AxisReport::of(&case, &bsm_case::Settings::default()).expect("an axis");
        rule(&report, "speed number").limit.expect("a limit")
    };
    for (make, least) in [
        ("", 70e3),
        ("screw_make=rolled", 50e3),
        ("screw_make=ground", 70e3),
        ("screw_make=caged", 130e3),
        ("screw_make=high-speed", 160e3),
    ] {
        near(limit(make), least, 1e-12, make);
    }
}
