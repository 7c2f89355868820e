//! The third contact of a ball, calculated from a case with an axial play.

use bsm_case::{Case, ModelChoice, Record, Settings};
use bsm_dyn::{Model, ModelWorkspace};
use serde_json::Value;

const CASES: &str = include_str!("../../../../validation/published/nut/third_contact.json");

/// Returns a reference ball as a case with changed inputs, and its expected results.
fn reference(name: &str, sets: &[&str]) -> (Case, Value) {
    let cases: Vec<Value> = serde_json::from_str(CASES).expect("JSON");
    let of = cases.into_iter().find(|case| case["name"] == name).expect("a reference case");
    let mut case = Case::from_json(of["case"].to_string().as_bytes()).expect("a case");
    case.apply(sets).expect("entries");
    (case, of["expect"].clone())
}

fn solved(case: &Case, settings: &Settings) -> Record {
    let problem = case.problem(settings).expect("a problem");
    Record::new(problem.solve(&mut ModelWorkspace::default()))
}

#[track_caller]
fn near(record: &Record, name: &str, expected: f64, tolerance: f64) {
    let found = record.number(name).unwrap_or_else(|| panic!("no {name}"));
    assert!((found - expected).abs() <= tolerance * expected.abs(), "{name} {found} {expected}");
}

/// Ten balls of reference V06 share ten times its load.
#[test]
fn a_play_below_the_threshold_gives_the_reference_third_contact() {
    let (case, expect) = reference("V06", &["axial_load_N=600", "loaded_balls=10"]);
    let record = solved(&case, &Settings::default());
    assert_eq!(record.model(), ModelChoice::Fixed(Model::Traction));
    let get = |key: &str| expect[key].as_f64().expect("a number");
    // Tolerance of the reference.
    near(&record, "nut_normal_load_N", get("nut_plus_N"), 1e-6);
    near(&record, "screw_normal_load_N", get("screw_plus_N"), 1e-6);
    near(&record, "third_contact_load_N", get("nut_minus_N"), 3e-5);
    near(&record, "ball_torque_Nm", 10.0 * get("screw_torque_Nm"), 1e-6);
    near(&record, "dissipated_power_W", 10.0 * get("dissipated_power_W"), 1e-6);
    near(&record, "efficiency", get("efficiency"), 1e-6);
    near(&record, "third_contact_power_share", get("third_contact_power_share"), 1e-6);
    let displacement = get("axial_displacement_um") - get("first_touch_um");
    near(&record, "axial_displacement_um", displacement, 1e-5);
    assert!(record.number("far_flank_gap_um").is_some_and(|gap| gap < 0.0));
    let warnings = record.warnings(&case).join(" ");
    let told =
        ["axial play of 10 um is below the threshold", "far flank of the nut", "by a factor of"];
    assert!(told.iter().all(|text| warnings.contains(text)), "{warnings}");
}

#[test]
fn a_ball_without_a_given_play_states_its_threshold() {
    let (mut case, _) = reference("V06", &[]);
    case.axial_play_um = None;
    let settings = Settings::from(Model::Traction);
    let record = solved(&case, &settings);
    let threshold = record.number("threshold_play_um").expect("a threshold");
    assert!(threshold > 10.0 && threshold < 40.0, "{threshold}");
    assert_eq!(record.number("far_flank_gap_um"), None);
    assert!(!record.warnings(&case).join(" ").contains("far flank"));
    // Above the threshold, the play only adds to the gap.
    let (above, _) = reference("V06", &[&format!("axial_play_um={}", threshold + 1.0)]);
    let wide = solved(&above, &settings);
    // Rounding of the contact angle.
    near(&wide, "ball_torque_Nm", record.number("ball_torque_Nm").expect("a torque"), 1e-12);
    assert_eq!(wide.number("third_contact_load_N"), None);
    assert!(wide.number("far_flank_gap_um").is_some_and(|gap| gap > 0.0));
    assert!(!wide.warnings(&above).join(" ").contains("far flank"));
}

/// In raceway control, friction does not affect the force balance of the ball.
#[test]
fn only_models_with_friction_in_the_balance_have_a_threshold() {
    let (mut case, _) = reference("V06", &[]);
    case.axial_play_um = None;
    for (model, has) in
        [(Model::RacewayControl, false), (Model::Elastic, true), (Model::Traction, true)]
    {
        let record = solved(&case, &Settings::from(model));
        assert_eq!(record.number("threshold_play_um").is_some(), has, "{}", model.name());
    }
}
