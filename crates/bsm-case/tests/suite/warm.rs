//! The warm steady state of an axis, from its scene: the reference cases of `validation/published/nut`, and what a
//! scene may not say.

use bsm_case::{AxisReport, Scene, Settings};
use bsm_dyn::{Control, Model};
use serde_json::{Value, json};

const CASES: &str = include_str!("../../../../validation/published/nut/warm_state.json");

/// Inputs of a case that are entries of the warm state.
const WORDS: [&str; 8] = [
    "ambient_temperature_C",
    "coolant",
    "coolant_flow_l_min",
    "coolant_temperature_C",
    "drag_rule",
    "nut_conductance_W_K",
    "pretension_K",
    "screw_bore_mm",
];

fn settings() -> Settings {
    Settings { control: Some(Control::Nut), ..Settings::from(Model::RacewayControl) }
}

/// The scene of a reference case as entries of a scene, changed.
fn scene(id: &str, change: impl Fn(&mut Value)) -> (Scene, Value) {
    let all: Value = serde_json::from_str(CASES).expect("JSON");
    let case = all["cases"].as_array().expect("cases").iter().find(|case| case["id"] == id);
    let case = case.unwrap_or_else(|| panic!("{id}")).clone();
    let mut words = serde_json::Map::new();
    let mut scene = case["scene"].clone();
    let entries = scene.as_object_mut().expect("a scene");
    for key in WORDS {
        if let Some(value) = entries.remove(key) {
            words.insert(key.to_owned(), value);
        }
    }
    entries.insert("warm_state".to_owned(), Value::Object(words));
    // The name of the specification, and ours.
    if let Some(stiffness) = entries.remove("support_bearing_rigidity_N_um") {
        entries.insert("support_bearing_stiffness_N_um".to_owned(), stiffness);
    }
    // Phases have a feed.
    let lead = entries["lead_mm"].as_f64().expect("lead");
    for phase in entries["cycle"].as_array_mut().expect("cycle") {
        let phase = phase.as_object_mut().expect("phase");
        let rpm = phase.remove("screw_speed_rpm").and_then(|rpm| rpm.as_f64()).expect("speed");
        phase.insert("feed_m_min".to_owned(), json!(1e-3 * lead * rpm));
    }
    change(&mut scene);
    (Scene::from_json(scene.to_string().as_bytes()).expect("scene"), case)
}

/// To the tolerances of the cases, of rises over the ambient temperature, preload, heat and growth; of the gain 1e-4.
#[test]
fn reference_cases_from_scenes() {
    for id in ["WS-P1", "WS-P2", "WS-P4", "WS-P5"] {
        let (scene, case) =
            scene(id, |scene| scene["warm_state"]["fold_search_factor"] = json!(1.01));
        let report =
            AxisReport::of(&scene, &settings()).unwrap_or_else(|why| panic!("{id}: {why}"));
        let tolerance = case["rel_tol"].as_f64().expect("tolerance");
        let ambient = case["scene"]["ambient_temperature_C"].as_f64().unwrap_or(20.0);
        for (name, expected, from) in [
            ("nut_temperature_C", "nut_temperature_C", ambient),
            ("screw_temperature_C", "screw_temperature_C", ambient),
            ("balls_temperature_C", "balls_temperature_C", ambient),
            ("end_1_temperature_C", "end_1_temperature_C", ambient),
            ("end_2_temperature_C", "end_2_temperature_C", ambient),
            ("warm_state_preload_N", "warm_preload_N", 0.0),
            // The nut of the sheet is in that state.
            ("warm_preload_N", "warm_preload_N", 0.0),
            ("steady_heat_W", "heat_W", 0.0),
            ("screw_growth_um", "screw_growth_um", 0.0),
            ("screw_tension_N", "screw_tension_N", 0.0),
            ("loop_gain", "loop_gain", 0.0),
        ] {
            let Some(expected) = case["expect"][expected].as_f64() else { continue };
            let loaded = case["scene"]["cycle"][0]["force_N"].as_f64() != Some(0.0);
            if name == "warm_preload_N" && !loaded {
                continue;
            }
            let found = report.number(name).unwrap_or_else(|| panic!("{id} {name}"));
            let allowed =
                if name == "loop_gain" { 1e-4 } else { tolerance * (expected - from).abs() };
            assert!((found - expected).abs() <= allowed, "{id} {name}: {found}, not {expected}");
        }
    }
}

/// Above its fold WS-P3 has no state, and the rule says by how much: 1166.55 of 1500 rpm.
#[test]
fn above_the_fold_a_rule_fails() {
    let (scene, _) = scene("WS-P3", |scene| scene["cycle"][0]["feed_m_min"] = json!(18.0));
    let report = AxisReport::of(&scene, &settings()).expect("an axis");
    assert!(!report.passes());
    let factor = report.number("fold_speed_factor").expect("a fold");
    // The reference has it to 1e-5.
    assert!((factor - 1.166_546_72 / 1.5).abs() < 2e-5, "{factor}");
    assert_eq!(report.number("nut_temperature_C"), None);
    assert!(report.answer.warnings.iter().any(|words| words.contains("runs away above 0.78")));
}

#[test]
fn what_contradicts_itself_is_refused() {
    let refused = |id: &str, change: &dyn Fn(&mut Value), words: &str| {
        let (scene, _) = scene(id, change);
        let why = AxisReport::of(&scene, &settings()).expect_err(words).to_string();
        assert!(why.contains(words), "{why}");
    };
    let set = |key: &'static str, value: Value| {
        move |scene: &mut Value| scene["warm_state"][key] = value.clone()
    };
    refused("WS-P2", &set("nut_conductance_W_K", json!(0.0)), "nut_conductance_W_K");
    refused("WS-P3", &set("carriage_area_m2", json!(0.5)), "carriage_area_m2");
    refused("WS-P4", &set("pretension_N", json!(1e3)), "pretension_N");
    refused("WS-P2", &set("pretension_N", json!(1e3)), "fixed-fixed");
    refused("WS-P2", &set("coolant_flow_l_min", json!(4.0)), "needs screw_bore_mm");
    refused("WS-P5", &set("screw_bore_mm", json!(34.4)), "less than the core");
    refused("WS-P5", &set("coolant_conductance_W_K", json!(70.0)), "coolant_conductance_W_K");
    refused(
        "WS-P2",
        &|scene| scene["unsupported_length_mm"] = json!(920.0),
        "run into the bearings",
    );
    refused(
        "WS-P2",
        &|scene| scene["screw_temperature_rise_K"] = json!(5.0),
        "rises of temperature",
    );
    refused("WS-P2", &|scene| scene["axis_heat_transfer_W_K"] = json!(5.0), "one node");
}
