//! Tests of the machine around the screw, compared with an independent calculation: lengths of nut
//! and thread, driven nuts, two fixed bearings, and temperatures.

use approx::assert_relative_eq;
use bsm_case::{AxisReport, Case, CaseError, RequirementFile, Settings, output};
use serde_json::{Map, Value, json};

use crate::named;

const CASES: &str = include_str!("machine.json");

/// Returns catalog inputs that the reference cases lack and that do not affect the compared
/// outputs.
fn neutral_catalog_inputs() -> Value {
    json!({
        "nominal_diameter_mm": 40, "pitch_circle_diameter_mm": 40, "rated_dynamic_load_N": 50e3,
        "rated_static_load_N": 100e3, "axial_load_N": 100
    })
}

fn reference_cases(kind: &str) -> Vec<Value> {
    let all: Value = serde_json::from_str(CASES).expect("JSON");
    let cases = all["cases"].as_array().expect("cases").clone();
    let found: Vec<_> = cases.into_iter().filter(|case| case["kind"] == kind).collect();
    assert!(!found.is_empty(), "{kind}");
    found
}

fn with_inputs(base: &Value, more: &Value) -> Map<String, Value> {
    let mut all = base.as_object().expect("an object").clone();
    all.extend(more.as_object().expect("an object").clone());
    all
}

/// Creates a case from inputs. Each dwell is converted to a phase without feed.
fn case_from_inputs(inputs: &Map<String, Value>) -> Case {
    let mut inputs = inputs.clone();
    if let Some(cycle) = inputs.get_mut("cycle") {
        for phase in cycle.as_array_mut().expect("phases") {
            if let Some(time) = phase.as_object_mut().expect("a phase").remove("dwell_s") {
                *phase = json!({"time_s": time, "feed_m_min": 0});
            }
        }
        inputs.remove("axial_load_N");
    }
    inputs.insert("estimate_groove".to_owned(), json!(false));
    let text = Value::Object(inputs).to_string();
    Case::from_json(text.as_bytes()).unwrap_or_else(|why| panic!("{why}: {text}"))
}

fn sheet(inputs: &Map<String, Value>) -> Result<AxisReport, CaseError> {
    AxisReport::of(&case_from_inputs(inputs), &Settings::default())
}

fn number(report: &AxisReport, name: &str) -> f64 {
    let screw = report.answer.number(named(name));
    report.number(named(name)).or(screw).unwrap_or_else(|| panic!("no {name}"))
}

/// Compares all outputs with the expected values, with a relative tolerance of 1e-6. If the
/// expected value is zero, the output must be missing or below 1e-9.
fn assert_matches_reference(report: &AxisReport, reference: &Value, skip: &[&str]) {
    let name = reference["name"].as_str().expect("a name");
    for (key, expected) in reference["expected"].as_object().expect("numbers") {
        let expected = expected.as_f64().expect("a number");
        if skip.contains(&key.as_str()) {
            continue;
        }
        if expected.abs() < 1e-300 {
            let found = report.number(named(key)).unwrap_or(0.0);
            assert!(found.abs() < 1e-9, "{name}: {key} {found}");
            continue;
        }
        let found = number(report, key);
        let off = (found / expected - 1.0).abs();
        assert!(off < 1e-6, "{name}: {key} {found}, expected {expected}");
    }
}

/// The lengths of nut set and thread determine the critical speed. This is tested for single nuts,
/// for nut pairs and for a nut with a lead offset.
#[test]
fn nut_length_and_overrun_determine_thread_length_and_critical_speed() {
    for reference in reference_cases("nut_length") {
        let mut inputs = with_inputs(&neutral_catalog_inputs(), &reference["inputs"]);
        // The screw is kept cold, because constrained thermal expansion would reduce the critical
        // speed.
        inputs.insert("screw_temperature_rise_K".into(), json!(1e-9));
        let report = sheet(&inputs).expect("a sheet");
        assert_matches_reference(&report, &reference, &[]);
    }
}

/// The order data of a nut pair contain both nuts and a thread that is long enough for both nuts.
/// The longer thread makes the screw heavier.
#[test]
fn ordering_data_of_a_nut_pair_include_both_nuts_and_the_thread() {
    let single = json!({"lead_mm": 10, "loaded_turns": 5, "stroke_mm": 700, "feed_m_min": 20});
    let single = with_inputs(&neutral_catalog_inputs(), &single);
    let mut pair = single.clone();
    pair.insert("preload_N".into(), json!(1450));
    pair.insert("unsupported_length_mm".into(), json!(1000));
    let report = sheet(&pair).expect("a sheet");
    let order = report.order.to_string();
    for words in ["double nut, length 170 mm", "thread 890 mm", "length between bearings 1000 mm"] {
        assert!(order.contains(words), "{words}: {order}");
    }
    pair.remove("unsupported_length_mm");
    let masses =
        [&single, &pair].map(|case| number(&sheet(case).expect("a sheet"), "screw_mass_kg"));
    // The thread is 800 mm long for the single nut and 890 mm long for the pair.
    assert_relative_eq!(masses[1] / masses[0], 890.0 / 800.0, max_relative = 1e-12);
    // If the bearings are closer together, the thread only fits with a shorter overrun.
    pair.insert("unsupported_length_mm".into(), json!(880));
    let why = sheet(&pair).expect_err("too long").to_string();
    assert!(why.contains("890") && why.contains("overrun_mm"), "{why}");
    pair.insert("overrun_mm".into(), json!(5));
    sheet(&pair).expect("it fits");
}

/// The example axis has two nuts with 6 turns each.
#[test]
fn length_of_a_double_nut_includes_both_nuts() {
    let example = include_str!("../../../../examples/axis.json");
    let case = Case::from_json(example.as_bytes()).expect("an example");
    let report = AxisReport::of(&case, &Settings::default()).expect("a sheet");
    for (name, expected) in [("nut_length_mm", 380.0), ("thread_length_mm", 1620.0)] {
        assert_relative_eq!(number(&report, name), expected, max_relative = 1e-12);
    }
    assert!(report.order.to_string().contains("2 nuts x "), "{}", report.order);
}

/// If the nut is driven, the screw is at rest, so it has no critical speed and no inertia. The nut
/// has its own inertia.
#[test]
fn inertia_of_the_nut_replaces_inertia_of_the_screw_if_the_nut_is_driven() {
    for reference in reference_cases("nut_driven") {
        let mut inputs = with_inputs(&neutral_catalog_inputs(), &reference["inputs"]);
        inputs.insert("driven_part".into(), json!("nut"));
        let report = sheet(&inputs).expect("a sheet");
        assert_matches_reference(&report, &reference, &["screw_speed_rpm"]);
        for absent in ["critical_speed_ratio", "inertia_of_screw_kg_m2"] {
            assert_eq!(report.number(named(absent)), None, "{absent}");
        }
        let rules = report.answer.rules.iter().filter(|rule| rule.title == "critical speed");
        assert_eq!(rules.count(), 0);
        let estimated = report.answer.notes.iter().any(|note| note.contains("nut_inertia_kg_m2"));
        assert_eq!(estimated, !inputs.contains_key("nut_inertia_kg_m2"));
        // If the nut speed replaces the inputs `driven_part` and `feed_m_min`, the results are the
        // same.
        let speed = number(&report, "largest_speed_rpm");
        inputs.remove("driven_part");
        inputs.remove("feed_m_min");
        inputs.insert("nut_speed_rpm".into(), json!(-speed));
        let by_speed = sheet(&inputs).expect("a sheet");
        assert_matches_reference(&by_speed, &reference, &["screw_speed_rpm"]);
        inputs.insert("screw_speed_rpm".into(), json!(1));
        let why = sheet(&inputs).expect_err("both turn").to_string();
        assert!(why.contains("one driven part"), "{why}");
        inputs.remove("nut_speed_rpm");
        inputs.insert("driven_part".into(), json!("nut"));
        let why = sheet(&inputs).expect_err("the screw turns").to_string();
        assert!(why.contains("driven_part is nut"), "{why}");
    }
}

/// A driven nut can excite its screw between 0.8 and 1.25 times the critical speed.
#[test]
fn driven_nut_warns_near_the_critical_speed_of_its_screw() {
    let reference = &reference_cases("nut_driven")[0];
    let mut inputs = with_inputs(&neutral_catalog_inputs(), &reference["inputs"]);
    inputs.insert("driven_part".into(), json!("nut"));
    let mut warns = |ratio: f64| {
        // At a lead of 40 mm, the critical speed is 262.088 rpm.
        inputs.insert("feed_m_min".into(), json!(0.04 * 262.088_183_285_415 * ratio));
        let report = sheet(&inputs).expect("a sheet");
        report.answer.warnings.iter().any(|warning| warning.contains("damper"))
    };
    for (ratio, near) in [(0.79, false), (0.81, true), (1.0, true), (1.24, true), (1.26, false)] {
        assert_eq!(warns(ratio), near, "{ratio}");
    }
}

/// Temperatures, thermal expansion, bearing loads, critical speed and buckling are calculated with
/// the thermal network without feedback.
#[test]
fn thermal_network_gives_temperatures_and_bearing_loads() {
    for reference in reference_cases("thermal") {
        let inputs = reference["inputs"].as_object().expect("inputs");
        let report = sheet(inputs).expect("a sheet");
        assert_matches_reference(&report, &reference, &["balance_W"]);
        let named = report.answer.texts("not_modeled");
        assert!(named.iter().all(|text| !text.starts_with("temperatures")), "{named:?}");
    }
}

/// If no load limit is given for the bearings, compression due to constrained thermal expansion
/// causes a warning with a remedy. If a load limit is given, a rule checks the compression.
#[test]
fn constrained_expansion_causes_a_warning_or_is_checked_by_a_rule() {
    let reference = reference_cases("thermal").into_iter().nth(2).expect("two fixed bearings");
    let mut inputs = reference["inputs"].as_object().expect("inputs").clone();
    let report = sheet(&inputs).expect("a sheet");
    let warned = |report: &AxisReport| {
        report.answer.warnings.iter().any(|warning| {
            warning.contains(
                "compresses the screw with a force of 36.0 kN; pretension_K = 16.3 would keep it in tension",
            )
        })
    };
    assert!(warned(&report), "{:?}", report.answer.warnings);
    inputs.insert("support_bearing_axial_load_N".into(), json!(12_000));
    let judged = sheet(&inputs).expect("a sheet");
    let rule = judged.answer.rules.iter().find(|rule| rule.title == "support bearings");
    assert!(!rule.expect("a limit").passes() && !warned(&judged));
    // The pretension that the remedy states prevents the compression. The cold bearings must carry
    // this pretension.
    inputs.insert("pretension_K".into(), json!(16.3));
    let tight = sheet(&inputs).expect("a sheet");
    assert!(number(&tight, "screw_tension_N") > 0.0);
    assert!(
        number(&tight, "support_bearing_load_cold_N")
            > number(&tight, "support_bearing_load_warm_N")
    );
}

/// Two fixed bearings of 750 N/um act in parallel if the nut is in the middle.
#[test]
fn two_fixed_bearings_share_the_load_of_the_nut() {
    let inputs = json!({
        "lead_mm": 40, "shaft_diameter_mm": 34.4, "unsupported_length_mm": 1450, "support": "fixed-fixed",
        "feed_m_min": 1, "rated_rigidity_N_um": 750, "rated_rigidity_at": "0.3 Ca", "axial_load_N": 15e3
    });
    let mut inputs = with_inputs(&neutral_catalog_inputs(), &inputs);
    let rigid = 1.0 / number(&sheet(&inputs).expect("a sheet"), "axis_stiffness_N_um");
    inputs.insert("support_bearing_stiffness_N_um".into(), json!(750));
    let two = 1.0 / number(&sheet(&inputs).expect("a sheet"), "axis_stiffness_N_um");
    assert_relative_eq!(two - rigid, 1.0 / 1500.0, max_relative = 1e-9);
    // The stiffnesses of screw (530.724 N/um), nut (600 N/um) and bearings (750 N/um) are taken
    // from the reference.
    assert_relative_eq!(two, 1.0 / 237.104_465_953_820_78, max_relative = 1e-6);
    inputs.insert("support".into(), json!("fixed-supported"));
    let one = 1.0 / number(&sheet(&inputs).expect("a sheet"), "axis_stiffness_N_um");
    inputs.remove("support_bearing_stiffness_N_um");
    let rigid = 1.0 / number(&sheet(&inputs).expect("a sheet"), "axis_stiffness_N_um");
    assert_relative_eq!(one - rigid, 1.0 / 750.0, max_relative = 1e-9);
}

/// The reference values were calculated for two axes with nut stiffnesses of 600 and 700 N/um.
#[test]
fn natural_frequencies_match_independent_values() {
    for (more, expected) in [
        (
            json!({
                "lead_mm": 10, "support": "fixed-supported", "rated_rigidity_N_um": 875, "support_bearing_stiffness_N_um": 800,
                "housing_stiffness_N_um": 2000, "moved_mass_kg": 500, "guide_friction": 0.01, "guide_force_N": 60, "axial_play_um": 30,
                "axial_load_N": 14890.967
            }),
            [93.323_287, 2_980.042_1, 68.759_094, 67.707_105, 32.336_678],
        ),
        (
            json!({
                "lead_mm": 40, "support": "fixed-fixed", "rated_rigidity_N_um": 750, "support_bearing_stiffness_N_um": 750,
                "moved_mass_kg": 300, "guide_friction": 0.005, "axial_load_N": 14985.290
            }),
            [237.104_47, 372.505_26, 141.491_18, 110.603_69, 0.124_080_12],
        ),
    ] {
        let shared = json!({
            "shaft_diameter_mm": 34.4, "unsupported_length_mm": 1450, "rated_rigidity_at": "0.3 Ca", "feed_m_min": 1
        });
        let inputs =
            with_inputs(&Value::Object(with_inputs(&neutral_catalog_inputs(), &shared)), &more);
        let sheet = sheet(&inputs).expect("a sheet");
        let names = [
            "axis_stiffness_N_um",
            "torsional_stiffness_N_um",
            "natural_frequency_Hz",
            "natural_frequency_with_torsion_Hz",
            "lost_motion_um",
        ];
        for (name, expected) in names.into_iter().zip(expected) {
            // The tolerance corresponds to the number of printed digits.
            assert_relative_eq!(number(&sheet, name), expected, max_relative = 2e-7);
        }
    }
}

/// Film conductance and heat are averaged over the whole time, including standstill. During a
/// dwell, the screw is cooled by still air, and the temperature rise decreases because the mean
/// heat is smaller.
#[test]
fn average_film_conductance_includes_standstill() {
    let cases = reference_cases("thermal");
    let of = |place: usize| {
        sheet(cases[place].get("inputs").and_then(Value::as_object).expect("inputs"))
    };
    let [full, part] = [0, 1].map(|place| of(place).expect("a sheet"));
    let ratio = |name: &str| number(&part, name) / number(&full, name);
    assert_relative_eq!(ratio("mean_heat_W"), 0.6, max_relative = 1e-12);
    // Equation (I9) gives the film conductance at standstill, which lasts for 40 % of the time.
    let film = 0.6 * number(&full, "screw_film_W_m2K") + 0.4 * 5.234_725_013_676_082;
    assert_relative_eq!(number(&part, "screw_film_W_m2K"), film, max_relative = 1e-6);
    assert!(ratio("steady_temperature_rise_K") < 0.75, "{}", ratio("steady_temperature_rise_K"));
}

/// If the torques of seals and bearings are not given, these inputs are named next to the mean
/// heat. The upper bound of the temperature rise includes typical values for these torques.
#[test]
fn axis_sheet_names_missing_heat_sources() {
    let reference = &reference_cases("thermal")[0];
    let mut inputs = reference["inputs"].as_object().expect("inputs").clone();
    let note = |report: &AxisReport| report.answer.lacks("mean_heat_W");
    let given = sheet(&inputs).expect("a sheet");
    assert_eq!(note(&given), None);
    let [seal, bearings] = ["seal_torque_Nm", "support_bearing_torque_Nm"].map(|key| {
        inputs.remove(key);
        sheet(&inputs).expect("a sheet")
    });
    let words = note(&seal).expect("named");
    assert!(words.contains("seal_torque_Nm is not given") && !words.contains("bearing"), "{words}");
    let words = note(&bearings).expect("named");
    let both = "seal_torque_Nm and support_bearing_torque_Nm are not given";
    assert!(words.contains(both), "{words}");
    let notes = bearings.answer.notes.join("\n");
    assert!(notes.contains("the upper end includes"), "{notes}");
    // For a 40 mm screw, the typical torques of seals and bearings are 0.2 and 0.3 N m.
    inputs.insert("seal_torque_Nm".into(), json!(0.2));
    inputs.insert("support_bearing_torque_Nm".into(), json!(0.3));
    let usual = sheet(&inputs).expect("a sheet");
    let high = number(&bearings, "steady_temperature_rise_high_K");
    assert!(high > number(&usual, "steady_temperature_rise_K"), "{high}");
}

/// The film conductance to the air is smaller for a screw at rest than for a turning screw: about 5
/// instead of 21 W/(m2 K).
#[test]
fn film_conductance_of_a_screw_at_rest_equals_the_value_for_still_air() {
    let all: Value = serde_json::from_str(CASES).expect("JSON");
    let still = all["films_of_a_40_mm_screw_W_m2K"]["0"].as_f64().expect("a film");
    assert!((5.0..5.5).contains(&still));
    let reference = reference_cases("thermal").into_iter().next_back().expect("a driven nut");
    let report = sheet(reference["inputs"].as_object().expect("inputs")).expect("a sheet");
    // The expected value was calculated for a diameter of 41.75 mm. The film conductance in still
    // air does not depend on the diameter.
    assert_relative_eq!(number(&report, "screw_film_W_m2K"), still, max_relative = 1e-12);
}

/// The static safety factor of a nut pair includes its preload, even if only ratings are given. The
/// hand calculation divides the rating of 100 kN by the load of the more heavily loaded nut (D14),
/// 4270 N or 3791 N.
#[test]
fn static_safety_of_a_pair_includes_its_preload() {
    for (preload, load, expected) in [(4000.0, 500.0, 23.4), (2000.0, 3000.0, 26.4)] {
        let inputs =
            json!({"lead_mm": 10, "preload_N": preload, "axial_load_N": load, "feed_m_min": 1});
        let report = sheet(&with_inputs(&neutral_catalog_inputs(), &inputs)).expect("a sheet");
        let size: f64 = load / (8.0_f64.sqrt() * preload);
        let by_hand = 100e3 / (preload * (1.0 + size).powf(1.5));
        let found = number(&report, "static_safety_factor");
        assert_relative_eq!(found, by_hand, max_relative = 1e-12);
        assert!((found - expected).abs() < 0.05, "{found}");
    }
}

/// If the thermal expansion is too small to have an effect and friction is dry, the axis sheet
/// contains the same temperatures with and without a warm state. The tolerance allows for two
/// errors: the interpolation of the friction in the warm state, 1e-9, and the residual of the heat
/// balance, 1e-10.
#[test]
fn axis_sheet_and_warm_state_use_the_same_thermal_network() {
    let mut case =
        Case::from_json(include_bytes!("../../../../validation/published/nut/feed_axis.json"))
            .expect("a case");
    let oil = ["iso_vg", "ball_roughness_um", "nut_roughness_um", "screw_roughness_um"];
    let mut inputs = case.to_json();
    let inputs = inputs.as_object_mut().expect("an object");
    for key in oil {
        inputs.remove(key);
    }
    inputs.insert("friction_coefficient".into(), json!(0.05));
    inputs.insert("thermal_expansion_um_m_K".into(), json!(1e-9));
    let settings = Settings::named("raceway-control", None, None).expect("a model");
    let mut of = |warm: bool| {
        inputs.insert("warm_state".into(), json!(warm));
        case =
            Case::from_json(Value::Object(inputs.clone()).to_string().as_bytes()).expect("a case");
        AxisReport::of(&case, &settings).expect("a sheet")
    };
    let (plain, warm) = (of(false), of(true));
    for name in [
        "nut_rise_K",
        "screw_rise_K",
        "end_1_rise_K",
        "end_2_rise_K",
        "mean_heat_W",
        "free_growth_um",
    ] {
        assert_relative_eq!(number(&plain, name), number(&warm, name), max_relative = 1e-8);
    }
}

/// For nut pairs, threads and driven nuts, `select` uses the same functions as `axis`, so that the
/// axis sheet of the selected screw contains the same values.
#[test]
fn select_and_axis_commands_agree_on_lengths_and_driven_part() {
    let catalog = bsm_case::Catalog::standard().expect("compiled in");
    let requirement = br#"{"axial_load_N": 3000, "feed_m_min": 20, "stroke_mm": 700, "lead_mm": 10, "preload_N": 1450,
        "driven_part": "nut", "nut_gap_mm": 6, "overrun_mm": 15}"#;
    let requirement =
        RequirementFile::from_json(requirement, &[], catalog.lists.clone()).expect("a requirement");
    let report = bsm_case::DesignReport::standard(&requirement, &catalog).expect("lists");
    assert!(report.found, "{:?}", report.reasons);
    let sheet = AxisReport::of(&report.case, &Settings::default()).expect("a sheet");
    let (turns, thread) =
        (report.case.loaded_turns.expect("turns"), number(&sheet, "thread_length_mm"));
    let starts = report.case.starts.unwrap_or(1.0);
    let length = 2.0 * 10.0 / starts * (turns + 3.0) + 6.0;
    assert_relative_eq!(number(&sheet, "nut_length_mm"), length, max_relative = 1e-12);
    assert_relative_eq!(thread, 700.0 + length + 30.0, max_relative = 1e-12);
    assert_eq!(sheet.number(output!(critical_speed_ratio)), None);
    let row = report.rows.iter().find(|row| row.name == "screw_length_mm").expect("a row");
    assert_relative_eq!(row.value.expect("a length"), thread, max_relative = 1e-12);
    assert!(report.rows.iter().all(|row| row.name != "critical_speed_ratio"));
}
