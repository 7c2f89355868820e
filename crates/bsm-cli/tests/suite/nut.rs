//! Tests of `bsm nut` on the command line.

use std::fs;

use crate::program::{bsm, example, folder, root, stderr, stdout};
use serde_json::{Value, json};

/// Runs `bsm nut` and returns the exit code, the JSON answer and standard error.
fn answer(case: &str, args: &[&str]) -> (Option<i32>, Value, String) {
    let dir = folder();
    let output = bsm(dir.path(), &[&["nut", "-", "--json"], args].concat(), case);
    let json = serde_json::from_str(&stdout(&output)).unwrap_or(Value::Null);
    (output.status.code(), json, stderr(&output))
}

/// Runs `bsm nut` for a case that must be rejected, and returns the message.
fn rejection_message(change: &Value, args: &[&str]) -> String {
    let mut case = single_nut();
    case.as_object_mut().expect("object").extend(change.as_object().expect("object").clone());
    let (code, _, words) = answer(&case.to_string(), args);
    assert_eq!(code, Some(2), "{change}: {words}");
    words
}

fn single_nut() -> Value {
    json!({
        "ball_diameter_mm": 6.35, "pitch_circle_diameter_mm": 41.336, "lead_mm": 10,
        "contact_angle_deg": 45, "nut_conformity": 0.5203, "screw_conformity": 0.5203,
        "youngs_modulus_GPa": 206, "loaded_turns": 3, "loaded_balls_per_turn": 20,
        "axial_load_N": 6340
    })
}

/// Converts a reference case to a case of this program in which the loads are inputs.
fn case_from_reference(reference: &Value) -> Value {
    let mut case = reference["case"].clone();
    let loads = reference["load_SI"].as_object().expect("loads");
    for (dof, word) in [
        ("uz", "axial_load_N"),
        ("ux", "radial_load_x_N"),
        ("uy", "radial_load_y_N"),
        ("px", "moment_x_Nm"),
        ("py", "moment_y_Nm"),
    ] {
        if let Some(load) = loads.get(dof) {
            case[word] = load.clone();
        }
    }
    if loads.len() > 1 {
        case["nut_guidance"] = json!("free");
    }
    if let Some(ratings) = reference["ratings"].as_object() {
        case.as_object_mut().expect("case").extend(ratings.clone());
    }
    let map = case.as_object_mut().expect("case");
    if let Some(bars) = map.remove("bars") {
        for (body, bar) in bars.as_object().expect("bars") {
            for (name, value) in bar.as_object().expect("a bar") {
                map.insert(format!("{body}_{name}"), value.clone());
            }
        }
    }
    if let Some(ring) = map.remove("ring") {
        map.insert("ring_expansion".to_owned(), json!(true));
        map.insert("nut_outer_diameter_mm".to_owned(), ring["outer_diameter_mm"].clone());
    }
    case
}

/// Every number in `expect` must agree with the number of the same name in the answer. The
/// reference case states the relative tolerance (1e-9). Because some numbers are zero by symmetry,
/// the reference value for the tolerance is at least a thousandth of the largest number in the same
/// list or, for forces that cancel, a thousandth of the sum of all ball loads. For ball loads, the
/// reference value is at least a millionth of the largest load (chapter 11.10 of the source of the
/// reference cases).
#[test]
fn nut_results_match_the_reference_cases() {
    let cases = fs::read_to_string(root().join("validation/published/nut/public.json"));
    let cases: Vec<Value> = serde_json::from_str(&cases.expect("cases")).expect("JSON");
    assert_eq!(cases.len(), 14);
    for reference in &cases {
        let name = reference["name"].as_str().expect("name");
        let (code, found, words) = answer(&case_from_reference(reference).to_string(), &[]);
        if reference["case"]["lead_mm"] == 0.0 {
            // This program does not accept a bearing as a case. The tests of bsm-nut compare the
            // results for this bearing.
            assert_eq!(code, Some(2), "{name}: {words}");
            assert!(words.contains("`lead_mm` = 0 must be a finite number > 0"), "{words}");
            continue;
        }
        assert_eq!(code, Some(0), "{name}: {words}");
        // The inner diameter of the ring is 45.82613 mm in this program and 45.826 mm in the
        // reference cases. This relative difference of 3e-6 slightly affects the stiffness.
        let has_ring = !reference["case"]["ring"].is_null();
        let exact = reference["rel_tol"].as_f64().expect("tolerance");
        let tolerance = if has_ring { 1e-5 } else { exact };
        let expect = reference["expect"].as_object().expect("expected");
        let sum: f64 = ["nut_plus_N", "nut_minus_N"]
            .iter()
            .flat_map(|key| expect[*key].as_array().expect("loads"))
            .map(|load| load.as_f64().expect("load"))
            .sum();
        let largest = expect["max_contact_load_N"].as_f64().expect("load");
        for (key, expected) in expect.iter().filter(|(key, _)| *key != "iterations") {
            let list = |value: &Value| value.as_array().cloned().unwrap_or(vec![value.clone()]);
            let (expected, found) = (list(expected), list(&found[name_in_program(key)]));
            assert_eq!(expected.len(), found.len(), "{name} {key}");
            let size =
                expected.iter().filter_map(Value::as_f64).fold(0.0, |m: f64, x| m.max(x.abs()));
            let floor = match key.as_str() {
                "reaction_SI" | "body_axial_N" => 1e-3 * size.max(sum),
                key if key.ends_with("us_N") => 1e-6 * largest,
                _ => 1e-3 * size,
            };
            for (i, (expected, found)) in expected.iter().zip(&found).enumerate() {
                let (Some(expected), Some(found)) = (expected.as_f64(), found.as_f64()) else {
                    assert_eq!(expected, found, "{name} {key}[{i}]");
                    continue;
                };
                // The displacements of an unloaded pair are zero apart from rounding errors of
                // 1e-15 m.
                let floor = if key == "displacement_um" { floor.max(1.0) } else { floor };
                let allowed = tolerance * expected.abs().max(floor);
                assert!(
                    (found - expected).abs() <= allowed,
                    "{name} {key}[{i}]: {found} {expected}"
                );
            }
        }
    }
}

/// Short forms of inputs must be equivalent to complete objects. The axial stiffness values of nut
/// and screw are calculated from anchors and diameters (chapter 16). The nut pair of case P06 is
/// calculated from its preload; its results must agree to within 1e-8, the tolerance of the preload
/// search.
#[test]
fn short_forms_of_nut_inputs_are_equivalent_to_complete_json_objects() {
    let same = |short: &Value, long: &Value, tolerance: f64| {
        let run = |change: &Value| {
            let mut case = single_nut();
            let map = case.as_object_mut().expect("object");
            map.extend(change.as_object().expect("object").clone());
            map.retain(|_, value| !value.is_null());
            let (code, found, words) = answer(&case.to_string(), &[]);
            assert_eq!(code, Some(0), "{change}: {words}");
            found
        };
        let (short, long) = (run(short), run(long));
        for key in [
            "max_contact_load_N",
            "max_over_mean",
            "nut_displacement_um",
            "life_by_balls_revolutions",
        ] {
            let (a, b) = (short[key].as_f64().expect(key), long[key].as_f64().expect(key));
            assert!((a - b).abs() <= tolerance * b.abs().max(1e-6), "{key}: {a} {b}");
        }
    };
    let (middle, across) = (41.336_f64, 6.35 * 0.5_f64.sqrt());
    let area =
        |outer: f64, inner: f64| 0.25 * std::f64::consts::PI * (outer.powi(2) - inner.powi(2));
    let of_nut = 206e3 * area(70.0, middle + across);
    let of_screw = 206e3 * area(middle - across, 0.0);
    same(
        &json!({ "nut_outer_diameter_mm": 70, "nut_anchor": "low", "screw_anchor": "high",
                 "ring_expansion": true, "nut_guidance": "free" }),
        &json!({ "nut_outer_diameter_mm": 70, "nut_EA_N": of_nut, "nut_anchor": "low",
                 "screw_EA_N": of_screw, "screw_anchor": "high",
                 "ring_expansion": true, "nut_guidance": "free" }),
        1e-12,
    );
    let nothing = json!({ "loaded_turns": null, "loaded_balls_per_turn": null });
    let circuits = |list: Value| {
        let mut change = nothing.clone();
        change["circuits"] = list;
        change
    };
    same(
        &json!({ "circuits_count": 3, "gap_deg": 30, "phase_deg": 72, "loaded_turns": null }),
        &circuits(json!([
            { "start_deg": 0, "arc_deg": 330, "balls": 18 },
            { "start_deg": 432, "arc_deg": 330, "balls": 18 },
            { "start_deg": 864, "arc_deg": 330, "balls": 18 }
        ])),
        1e-12,
    );
    let offset = 5.861_478_210_1;
    let mut pair = circuits(json!([
        { "start_deg": 0, "arc_deg": 1080, "balls": 60, "body": 0, "offset_um": -offset },
        { "start_deg": 1440, "arc_deg": 1080, "balls": 60, "body": 1, "offset_um": offset }
    ]));
    pair["axial_load_N"] = json!(3000);
    same(&json!({ "preload_N": 3000, "axial_load_N": 3000 }), &pair, 1e-8);
}

/// Ambiguous or contradictory inputs must be rejected. The message must state the JSON path of the
/// invalid input.
#[test]
fn contradictory_nut_inputs_are_rejected() {
    let circuit = json!({ "start_deg": 0, "arc_deg": 330, "balls": 18 });
    let with = |key: &str, value: Value| {
        let mut other = circuit.clone();
        other[key] = value;
        json!({ "circuits": [circuit, other], "loaded_turns": null, "loaded_balls_per_turn": null })
    };
    for (change, words) in [
        (with("bals", json!(3)), "`circuits[1].bals`: unknown field"),
        (with("balls", json!(0)), "`circuits[1].balls` = 0 must be"),
        (with("arc_deg", json!(-1)), "`circuits[1].arc_deg` = -1 must be a finite number > 0"),
        (with("start", json!(1)), "`circuits[1].start` = 1 must be below the number of starts, 1"),
        (with("body", json!(2)), "contains no circuit for nut body 1"),
        (with("flank", json!("up")), "`circuits[1].flank`: `up` is not one of `+`, `-`"),
        (json!({ "circuits": [circuit] }), "give either circuits or loaded_turns; both are given"),
        (json!({ "ring_expansion": 1 }), "`ring_expansion`: invalid type: integer"),
        (json!({ "nut_gidance": "free" }), "did you mean `nut_guidance`?"),
        (json!({ "nut_guidance": "loose" }), "`nut_guidance`: `loose` is not one of"),
        (
            json!({ "nut_EA_N": 1e8 }),
            "needs the position at which the force is transmitted: nut_anchor",
        ),
        (
            json!({ "nut_anchor": "low", "nut_anchor_z_mm": 3 }),
            "either nut_anchor or nut_anchor_z_mm",
        ),
        (
            json!({ "screw_torsion": true }),
            "`screw_torsion` needs the position where force and torque",
        ),
        (
            json!({ "screw_torsion": true, "screw_EA_N": 1e8, "screw_anchor": "low" }),
            "either screw_torsion or screw_EA_N",
        ),
        (
            json!({ "loaded_balls_per_turn": 0.1 }),
            "is 0.1, which leaves each of 1 circuits of 1080.0 deg without a ball",
        ),
        (json!({ "lead_error": [{ "amplitude_um": 1 }] }), "`lead_error[0]` must be a wave"),
        (json!({ "ball_deviation_um": [1, 2] }), "has 2 numbers, but the nut has 60 balls"),
        (json!({ "radial_load_x_N": 10 }), "because the guides prevent the displacement"),
        (
            json!({ "radial_load_x_N": 10, "radial_x_um": 1 }),
            "either radial_load_x_N or radial_x_um",
        ),
        (json!({ "preload_N": 10, "ball_oversize_um": 1 }), "either preload_N or ball_oversize_um"),
        (json!({ "starts": 1.5 }), "`starts` = 1.5 must be a whole number, 1 or more"),
        (json!({ "loaded_turns": null }), "loaded_turns (or circuits) is required for a nut"),
    ] {
        let said = rejection_message(&change, &[]);
        assert!(said.contains(words), "{change}: {said}");
    }
    assert!(
        rejection_message(&json!({}), &["--model", "rigid"])
            .contains("model rigid does not calculate the balls of a nut")
    );
    assert!(rejection_message(&json!({}), &["--samples", "5"]).contains("ball_deviation_sd_um"));
}

/// `--set` must accept text values for a nut, and a load of zero, which is not valid for a single
/// ball.
#[test]
fn option_set_accepts_text_values() {
    let (_, found, words) = answer(&single_nut().to_string(), &["--set", "nut_guidance=free"]);
    assert!(found["nut_tilt_urad"].as_f64().expect("a tilt") > 1.0, "{words}");
    let pulled = ["--set", "axial_load_N=-6340"];
    let (_, pulled, _) = answer(&single_nut().to_string(), &pulled);
    let (_, pushed, _) = answer(&single_nut().to_string(), &[]);
    // Both flanks have the same shape, so a reversed load changes only signs.
    for key in ["max_contact_load_N", "life_by_balls_revolutions"] {
        assert_eq!(pulled[key], pushed[key], "{key}");
    }
    let (code, none, _) = answer(
        &single_nut().to_string(),
        &["--set", "axial_load_N=-500", "--set", "loaded_turns=1", "--set", "nut_guidance=free"],
    );
    assert_eq!(code, Some(0), "{none}");
    // A circuit that is loaded on one flank cannot carry a load in the opposite direction.
    let mut case = single_nut();
    let map = case.as_object_mut().expect("object");
    map.retain(|key, _| !key.starts_with("loaded"));
    case["circuits"] = json!([{ "start_deg": 0, "arc_deg": 720, "balls": 40, "flank": "+" }]);
    case["axial_load_N"] = json!(-500);
    let (code, none, _) = answer(&case.to_string(), &[]);
    assert_eq!((code, none["status"].as_str()), (Some(3), Some("no_solution")), "{none}");
    assert!(
        none["message"].as_str().expect("words").contains("no ball can carry the load"),
        "{none}"
    );
}

/// For a preloaded nut, the three stiffness values must match their definitions, the preload that
/// remains at the limit load must be zero, and a note must explain the torque.
#[test]
fn sheet_of_a_preloaded_pair_states_stiffness_and_limit_load_and_drag() {
    let dir = folder();
    let case = example("nut_double.json");
    let output = bsm(dir.path(), &["nut", &case, "--json"], "");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let found: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    let of = |key: &str| found[key].as_f64().unwrap_or_else(|| panic!("{key}: {found}"));
    let two = of("preload_stiffness_2_N_um");
    assert!((of("preload_stiffness_3_N_um") / two - 1.5).abs() < 1e-12);
    assert!((of("preload_stiffness_2_83_N_um") / two - 2.0_f64.sqrt()).abs() < 1e-12);
    assert!((of("cold_preload_N") - 3000.0).abs() < 1e-4, "the bracket of the preload");
    // For the contact angles that occur at typical preloads, the ratio is 2.86 to 2.91 (chapter
    // 16).
    let ratio = of("limit_load_N") / of("cold_preload_N");
    assert!((2.8..2.95).contains(&ratio), "{ratio}");
    // For a dry friction coefficient of 0.06, K_p is 0.033, which is a third of the smallest
    // catalog value (chapter 16).
    let factor = of("preload_torque_factor");
    assert!((0.025..0.045).contains(&factor), "{factor}");
    let low = of("rule_torque_low_Nm");
    assert!((of("preload_torque_Nm") / low - factor / 0.1).abs() < 1e-12);
    assert!((of("rule_torque_high_Nm") / low - 3.0).abs() < 1e-12);
    assert!(of("preload_left_N") < of("cold_preload_N") && of("friction_torque_Nm") > 0.0);
    let output = bsm(dir.path(), &["nut", &case], "");
    let text = stdout(&output);
    for part in [
        "2^1.5 F_pr/delta_pr",
        "limit load",
        "K_p",
        "third contact",
        "life from the loads of all balls / life according to ISO 3408-5",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let set = format!("axial_load_N={}", 1.01 * of("limit_load_N"));
    let output = bsm(dir.path(), &["nut", &case, "--set", &set, "--json"], "");
    let beyond: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    assert!(beyond["preload_left_N"].as_f64().expect("N").abs() < 1e-9, "{beyond}");
    let solved = bsm(dir.path(), &["solve", &case], "");
    let words = stdout(&solved);
    assert!(
        words.contains("preload_N is not included in the results of the balls, because the model calculates one ball; `bsm nut`"),
        "{words}"
    );
}

#[test]
fn ball_table_displacement_curve_and_figures_are_written() {
    let dir = folder();
    let case = example("nut_oversize.json");
    for more in [
        &["-o", "balls.csv", "--figures", "figures"][..],
        &["--show", "curve", "-o", "curve.csv", "-o", "nut.json"],
    ] {
        let output = bsm(dir.path(), &[&["nut", &case], more].concat(), "");
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        assert!(stdout(&output).contains("preload"), "{}", stdout(&output));
    }
    let json = fs::read_to_string(dir.path().join("nut.json")).expect("numbers");
    let json: Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(json["status"], "converged");
    let rows = |name: &str| {
        let text = fs::read_to_string(dir.path().join(name)).expect(name);
        text.lines().map(str::to_owned).collect::<Vec<_>>()
    };
    let balls = rows("balls.csv");
    assert!(balls[0].starts_with("circuit,body,theta_deg,z_mm,nut_plus_N"), "{}", balls[0]);
    assert_eq!(balls.len(), 1 + 98);
    let curve = rows("curve.csv");
    assert!(curve[0].starts_with("axial_load_N,nut_displacement_um"), "{}", curve[0]);
    // As the load increases, the displacement must increase and the preload must decrease.
    let column = |i: usize| -> Vec<f64> {
        curve[1..]
            .iter()
            .map(|row| row.split(',').nth(i).expect("cell").parse().expect("number"))
            .collect()
    };
    assert!(column(1).windows(2).all(|pair| pair[0] < pair[1]), "{curve:?}");
    assert!(column(3).windows(2).all(|pair| pair[0] >= pair[1]), "{curve:?}");
    for name in
        ["nut-loads", "nut-developed", "nut-contact-angles", "nut-displacement", "nut-preload"]
    {
        let svg = fs::read_to_string(dir.path().join(format!("figures/{name}.svg"))).expect(name);
        roxmltree::Document::parse(&svg).expect("an SVG");
    }
}

/// Random samples must depend only on the seed and not on the number of threads. The first sample
/// must be the nut of the case itself.
#[test]
fn random_nuts_depend_only_on_the_seed() {
    let dir = folder();
    let case = example("nut_scattered.json");
    let run = |threads: &str, seed: &str| {
        let args = ["nut", &case, "--samples", "12", "--seed", seed, "--json"];
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_bsm"));
        let output = command.args(args).env("RAYON_NUM_THREADS", threads).current_dir(dir.path());
        let output = output.output().expect("the program runs");
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        stdout(&output)
    };
    let one = run("1", "5");
    assert_eq!(one, run("2", "5"));
    assert_ne!(one, run("1", "6"));
    let found: Value = serde_json::from_str(&one).expect("JSON");
    let quantiles = found["quantiles"]["max_over_mean"].as_object().expect("quantiles");
    let values: Vec<_> = quantiles.values().map(|x| x.as_f64().expect("number")).collect();
    assert!(values.len() == 5 && values.windows(2).all(|pair| pair[0] <= pair[1]), "{values:?}");
    assert!(values[0] > 1.1, "scattered balls share unevenly: {values:?}");
}

/// Nut results must be available as columns of a sweep, and a row must have the same results as
/// `bsm nut`.
#[test]
fn nut_results_are_available_as_sweep_columns() {
    let dir = folder();
    let case = example("nut_double.json");
    let columns = "max_over_mean,unloaded_balls,nut_stiffness_N_um,preload_left_N,life_by_balls_revolutions,iso_life_revolutions";
    let args =
        ["sweep", &case, "--vary", "axial_load_N=1000,4000", "--columns", columns, "-o", "-"];
    let output = bsm(dir.path(), &args, "");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    let row: Vec<_> = text.lines().nth(2).expect("two rows").split(',').collect();
    let header: Vec<_> = text.lines().next().expect("a header").split(',').collect();
    let args = ["nut", &case, "--set", "axial_load_N=4000", "--json"];
    let found: Value = serde_json::from_str(&stdout(&bsm(dir.path(), &args, ""))).expect("JSON");
    for name in columns.split(',') {
        let place = header.iter().position(|column| *column == name).expect(name);
        let cell: f64 = row[place].parse().unwrap_or_else(|_| panic!("{name}: {text}"));
        // The sweep and the command `nut` perform the same calculation, so the results are
        // bit-identical.
        assert_eq!(Some(cell.to_bits()), found[name].as_f64().map(f64::to_bits), "{name}: {text}");
    }
}

/// Returns the output name that corresponds to a name in the reference data.
fn name_in_program(key: &str) -> &str {
    if key == "life_revolutions" { "life_by_balls_revolutions" } else { key }
}

/// Returns a number from an answer. `key` is the name of the number in the reference data.
fn number(found: &Value, key: &str) -> f64 {
    found[name_in_program(key)].as_f64().unwrap_or_else(|| panic!("{key}: {found}"))
}

/// Returns a case with a nut pair of size 41.3 x 12 mm and a preload of 2500 N.
fn nut_pair(change: &Value) -> Value {
    let mut case = json!({
        "ball_diameter_mm": 6.35, "pitch_circle_diameter_mm": 41.336, "lead_mm": 12,
        "contact_angle_deg": 45, "nut_conformity": 0.53, "screw_conformity": 0.53,
        "youngs_modulus_GPa": 207, "loaded_turns": 3, "loaded_balls_per_turn": 19,
        "friction_coefficient": 0.06, "screw_speed_rpm": 500, "preload_N": 2500
    });
    let map = case.as_object_mut().expect("object");
    map.extend(change.as_object().expect("object").clone());
    map.retain(|_, value| !value.is_null());
    case
}

/// A preload force must apply to the cold nut, and temperatures must change the preload. Regression
/// test: temperatures changed only a preload that was given as an offset, whereas a given preload
/// force was treated as the preload of the warm nut, without a note. By default, the nuts of a pair
/// must be pushed apart (O arrangement). A given offset must keep its sign, and given flanks must
/// be used unchanged.
#[test]
fn a_preload_force_applies_to_the_cold_nut() {
    let warm = |change: Value| {
        let mut change = change;
        change["screw_temperature_rise_K"] = json!(5);
        let (code, found, words) = answer(&nut_pair(&change).to_string(), &[]);
        assert_eq!(code, Some(0), "{change}: {words}");
        found
    };
    let o = warm(json!({}));
    let x = warm(json!({ "preload_arrangement": "X" }));
    let by_offset = warm(json!({ "preload_N": null, "preload_offset_um": 11.784_697_060_5 }));
    let circuits = |first: Option<&str>, second: Option<&str>| {
        json!({ "loaded_turns": null, "loaded_balls_per_turn": null, "circuits": [
            { "start_deg": 0, "arc_deg": 1080, "balls": 57, "body": 0, "flank": first },
            { "start_deg": 1440, "arc_deg": 1080, "balls": 57, "body": 1, "flank": second }
        ] })
    };
    let listed = |first, second| warm(circuits(Some(first), Some(second)));
    let (listed_x, listed_o) = (listed("+", "-"), listed("-", "+"));
    let without_flanks = warm(circuits(None, None));
    // The reference values come from an independent solution (chapter 16). The search finds offsets
    // to within 1e-8.
    for (found, expected) in [
        (&o, 2_210.411_218),
        (&listed_o, 2_210.411_218),
        (&without_flanks, 2_210.411_218),
        (&x, 4_111.339_823),
        (&by_offset, 4_111.339_823),
        (&listed_x, 4_111.339_823),
    ] {
        assert!((number(found, "cold_preload_N") - 2500.0).abs() < 1e-4, "{found}");
        assert!((number(found, "warm_preload_N") / expected - 1.0).abs() < 1e-7, "{found}");
        let notes = found["notes"].to_string();
        assert!(
            notes.contains(&format!("2500 N if the nut is cold, and {expected:.0} N at")),
            "{notes}"
        );
    }
    assert!((number(&o, "preload_setting_um") + 11.784_697).abs() < 1e-5, "{o}");
    assert!((number(&x, "preload_setting_um") - 11.784_697).abs() < 1e-5, "{x}");
    // The drag torque according to the manufacturers' rule and the preload that remains without
    // external load are based on the warm preload.
    let ratio = number(&x, "rule_torque_low_Nm") / number(&o, "rule_torque_low_Nm");
    assert!((ratio - number(&x, "warm_preload_N") / number(&o, "warm_preload_N")).abs() < 1e-9);
    assert!((number(&x, "preload_left_N") / number(&x, "warm_preload_N") - 1.0).abs() < 1e-9);
    for (change, words) in [
        (json!({ "preload_arrangement": "Y" }), "`Y` is not one of"),
        (
            json!({ "preload_N": null, "preload_offset_um": 5, "preload_arrangement": "O" }),
            "contradicts preload_offset_um",
        ),
        (
            json!({ "preload_by": "oversize", "preload_arrangement": "X" }),
            "applies only to a pair of nuts",
        ),
    ] {
        let (code, _, said) = answer(&nut_pair(&change).to_string(), &[]);
        assert!(code == Some(2) && said.contains(words), "{change}: {said}");
    }
}

/// Regression test: for a load in the negative direction, a negative limit load was compared with
/// the magnitude of the load. Therefore, a symmetric pair failed the rule in this direction.
#[test]
fn remaining_preload_of_a_loaded_pair_does_not_depend_on_the_direction_of_the_load() {
    let margin = |load: f64| {
        let axis = json!({ "axial_load_N": load, "stroke_mm": 800, "support": "fixed-supported" });
        let dir = folder();
        let output = bsm(dir.path(), &["axis", "-", "--json"], &nut_pair(&axis).to_string());
        let sheet: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
        let rules = sheet["rules"].as_array().expect("rules");
        let rule = rules.iter().find(|rule| rule["rule"] == "remaining preload").expect("a rule");
        assert_eq!(rule["passes"], Value::Bool(true), "{rule}");
        number(rule, "margin")
    };
    // The two nuts of the pair are identical, so the margins differ only by the tolerance of the
    // search for the limit load.
    assert!((margin(-3000.0) / margin(3000.0) - 1.0).abs() < 1e-6);
}

/// Regression test: the axis sheet used temperature rises to calculate the lives, but stated that
/// the preload does not depend on the temperature.
#[test]
fn commands_nut_and_axis_agree_on_the_preload_of_a_warm_pair() {
    let axis = json!({
        "screw_temperature_rise_K": 5, "preload_arrangement": "X", "axial_load_N": 3000,
        "stroke_mm": 800, "support": "fixed-supported", "youngs_modulus_GPa": 207
    });
    let case = nut_pair(&axis).to_string();
    let (_, nut, _) = answer(&case, &[]);
    let dir = folder();
    let output = bsm(dir.path(), &["axis", "-", "--json"], &case);
    let sheet: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    for key in ["cold_preload_N", "warm_preload_N"] {
        assert_eq!(nut[key], sheet["screw"][key], "{key}");
    }
    assert_eq!(nut["limit_load_N"], sheet["results"]["limit_load_N"]);
    assert!(
        sheet["notes"]
            .to_string()
            .contains("2500 N if the nut is cold, and 4111 N at the operating temperatures"),
        "{sheet}"
    );
    let life = number(&sheet["results"], "cycle_life_revolutions");
    // The life of the warm pair according to ISO 3408-5 must equal the life from `bsm nut`, apart
    // from rounding errors.
    assert!((life / number(&nut, "iso_life_revolutions") - 1.0).abs() < 1e-9, "{life}");
}

/// Regression test: contact angles of 93.8 to 150.9 deg, -3.8 deg and -48.9 deg were accepted as
/// results.
#[test]
fn a_ball_outside_its_groove_is_rejected() {
    for (case, set) in [
        ("nut_guided.json", "radial_gap_um=200"),
        ("nut_guided.json", "radial_gap_um=500"),
        ("nut_guided.json", "radial_x_um=500"),
        ("nut_guided.json", "tilt_x_urad=10000"),
        ("nut_guided.json", "axial_load_N=2000000"),
        ("nut_oversize.json", "radial_gap_um=200"),
    ] {
        let case = fs::read_to_string(example(case)).expect("an example");
        let (code, found, words) = answer(&case, &["--set", set]);
        assert_eq!(code, Some(3), "{set}: {found} {words}");
        assert_ne!(found["status"], "converged", "{set}");
    }
}

/// Regression test: the search took 0.1 s for every ball without a solution, so that a nut with a
/// thousand balls was not solved within 200 s.
#[test]
fn solve_of_a_nut_stops_at_the_first_ball_without_a_solution() {
    let case = fs::read_to_string(example("nut_free.json")).expect("an example");
    let mut case: Value = serde_json::from_str(&case).expect("JSON");
    let map = case.as_object_mut().expect("object");
    map.retain(|key, _| {
        !["circuits_count", "gap_deg", "loaded_balls_per_turn"].contains(&key.as_str())
    });
    case["circuits"] = json!([{ "start_deg": 0, "arc_deg": 18000, "balls": 1000 }]);
    case["nut_speed_rpm"] = json!(-60000);
    case["axial_load_N"] = json!(1);
    let begun = std::time::Instant::now();
    let (code, found, words) = answer(&case.to_string(), &["--model", "elastic"]);
    // At 0.1 s per ball, the search would take 100 s. Even a slow machine should take only a few
    // seconds.
    assert!(begun.elapsed().as_secs() < 60, "{:?}", begun.elapsed());
    assert_eq!(code, Some(0), "{words}");
    assert!(found["friction_torque_Nm"].is_null(), "{found}");
    let notes = found["notes"].to_string();
    // The note must state why the torque is missing.
    assert!(
        notes.contains(
            "because ball 0 has no solution with model elastic: the ratio of inertia forces"
        ),
        "{notes}"
    );
}

/// Regression test: for a nut pair without preload, the upper bound of the contact load was
/// calculated as if both nuts carried the load. A contact load of 505.6 N exceeded its bound of
/// 476.8 N.
#[test]
fn no_upper_bound_on_contact_load_is_reported_for_a_pair_without_preload() {
    let case = fs::read_to_string(example("nut_double.json")).expect("an example");
    let mut case: Value = serde_json::from_str(&case).expect("JSON");
    let map = case.as_object_mut().expect("object");
    map.retain(|key, _| {
        !["preload_N", "loaded_turns", "loaded_balls_per_turn"].contains(&key.as_str())
    });
    case["circuits"] = json!([
        { "start_deg": 0, "arc_deg": 1080, "balls": 60, "body": 0 },
        { "start_deg": 1440, "arc_deg": 1080, "balls": 60, "body": 1, "offset_um": 3 }
    ]);
    case["preload_arrangement"] = json!("X");
    case["axial_load_N"] = json!(20000);
    let (code, found, words) = answer(&case.to_string(), &[]);
    assert_eq!(code, Some(0), "{words}");
    assert!(found["load_bound_N"].is_null(), "{found}");
    let guided = fs::read_to_string(example("nut_guided.json")).expect("an example");
    let (_, found, _) = answer(&guided, &[]);
    assert!(number(&found, "load_bound_N") >= number(&found, "max_contact_load_N"), "{found}");
}

/// Regression test: earlier versions printed an efficiency of -19 without mentioning self-locking,
/// and printed the message "NaN of their sum is left". They also accepted overlapping circuits, an
/// arc of 1e308 deg, and a converged nut in which a ball had no force balance.
#[test]
fn unusual_nut_inputs_are_rejected_or_cause_a_note() {
    let double = fs::read_to_string(example("nut_double.json")).expect("an example");
    let (_, found, _) = answer(&double, &["--set", "axial_load_N=-5"]);
    assert!(number(&found, "nut_efficiency") < 0.0, "{found}");
    assert!(found["notes"].to_string().contains("self-locking"), "{found}");
    let guided = fs::read_to_string(example("nut_guided.json")).expect("an example");
    let (code, found, _) = answer(&guided, &["--set", "tilt_x_urad=1e6"]);
    assert_eq!(code, Some(3), "{found}");
    assert!(!found["message"].to_string().contains("NaN"), "{found}");
    let nothing = json!({ "loaded_turns": null, "loaded_balls_per_turn": null });
    let with = |circuits: Value| {
        let mut case = single_nut();
        let map = case.as_object_mut().expect("object");
        map.extend(nothing.as_object().expect("object").clone());
        map.retain(|_, value| !value.is_null());
        case["circuits"] = circuits;
        answer(&case.to_string(), &[])
    };
    let (code, _, words) = with(json!([
        { "start_deg": 0, "arc_deg": 330, "balls": 18 },
        { "start_deg": 300, "arc_deg": 330, "balls": 18 }
    ]));
    assert!(code == Some(2) && words.contains("has overlapping circuits, 0 and 1"), "{words}");
    let (code, _, words) = with(json!([{ "start_deg": 0, "arc_deg": 1e308, "balls": 5 }]));
    assert!(code == Some(2) && words.contains("arc_deg"), "{words}");
    let oversize = fs::read_to_string(example("nut_oversize.json")).expect("an example");
    let sets = ["--set", "screw_conformity=0.500001", "--set", "nut_conformity=0.6"];
    let (code, found, _) = answer(&oversize, &sets);
    assert_eq!(code, Some(3), "{found}");
    let words = found["message"].as_str().expect("words");
    assert!(words.contains("is larger than its groove"), "{words}");
}

/// Regression test: `nut` calculated the number of balls from circuits and gaps. `solve` did not,
/// and therefore chose a model that calculates no loads.
#[test]
fn command_solve_counts_the_balls_of_circuits_with_gaps() {
    let dir = folder();
    let output = bsm(dir.path(), &["solve", &example("nut_free.json"), "--json"], "");
    let solved: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    assert!(
        ["raceway-control", "traction"].contains(&solved["model"].as_str().expect("a model")),
        "{solved}"
    );
    let free = fs::read_to_string(example("nut_free.json")).expect("an example");
    let (_, nut, _) = answer(&free, &[]);
    let (share, load) = (number(&nut, "equal_load_N"), number(&solved, "nut_normal_load_N"));
    // Centrifugal force and friction change the ball load by less than 2 %.
    assert!((share / load - 1.0).abs() < 0.02, "{share} {load}");
}

/// Regression test: the text "by model auto" named the requested model instead of the model with
/// which the torque was calculated.
#[test]
fn output_names_the_model_used_for_the_torque() {
    let double = fs::read_to_string(example("nut_double.json")).expect("an example");
    let (_, found, _) = answer(&double, &[]);
    let model = found["model"].as_str().expect("a model");
    assert!(model.split(" and ").all(|name| name != "auto"), "{model}");
    let (_, found, _) = answer(&double, &["--model", "traction"]);
    assert_eq!(found["model"], "traction");
    let (_, found, _) = answer(&double, &["--set", "screw_speed_rpm="]);
    assert!(found["model"].is_null(), "{found}");
}

/// Regression test: `bsm nut examples/nut.json` was rejected because of its load.
#[test]
fn the_example_nut_is_solved() {
    let nut = fs::read_to_string(example("nut.json")).expect("an example");
    let (code, found, words) = answer(&nut, &[]);
    assert_eq!(code, Some(0), "{words}");
    let dir = folder();
    let output =
        bsm(dir.path(), &["solve", &example("nut.json"), "--show", "ratings", "--json"], "");
    let rated: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    // The preload must be equal to the preload that `--show ratings` prints. The search determines
    // the preload with an error of up to 1e-8.
    let ratio = number(&found, "cold_preload_N") / number(&rated, "preload_N");
    assert!((ratio - 1.0).abs() < 1e-7, "{ratio}");
    assert!(
        found["notes"].to_string().contains("Neither a load nor a preload is given"),
        "{found}"
    );
}

/// Regression test: a nut with a moved mass and without an axial load was solved as a pair with an
/// assumed preload.
#[test]
fn nut_without_axial_load_carries_weight_and_guide_friction() {
    let nut = fs::read_to_string(example("nut.json")).expect("an example");
    let mass = ["--set", "moved_mass_kg=100", "--set", "screw_speed_rpm=500"];
    let (code, found, words) =
        answer(&nut, &[&mass[..], &["--set", "inclination_deg=90"]].concat());
    assert_eq!(code, Some(0), "{words}");
    let notes = found["notes"].to_string();
    assert!(notes.contains("mass, guides and counterbalance of the axis exert: 980.66"), "{notes}");
    assert!(!notes.contains("preload"), "{notes}");
    assert!(found["cold_preload_N"].is_null());
    let (code, found, words) = answer(&nut, &mass);
    assert_eq!(code, Some(2), "{found}");
    assert!(
        words.contains("the axis does not load the nut, which has no preload either"),
        "{words}"
    );
}

/// Regression test: with raceway control, the friction torque did not vanish at zero load but
/// approached 2.1e-4 N m. This torque was caused by the spin of balls that are pressed against the
/// nut only by inertia.
#[test]
fn nut_friction_vanishes_at_zero_load() {
    let nut = fs::read_to_string(example("feed_drive_oil.json")).expect("an example");
    for load in [1e-9, 1e-6, 1e-3] {
        let set = format!("axial_load_N={load}");
        let settings = ["--model", "raceway-control", "--set", &set];
        let (code, found, words) = answer(&nut, &settings);
        assert_eq!(code, Some(0), "{words}");
        let friction = number(&found, "friction_torque_Nm");
        // The upper limit is the torque of gross sliding at the pitch radius of 20.75 mm with the
        // boundary friction coefficient 0.12. The sum of the ball loads is less than twice the
        // axial load.
        assert!(friction > 0.0 && friction < 0.12 * 0.02075 * 2.0 * load, "{load} N: {friction}");
    }
}

/// Regression test: `nut` ignored the weight of the moved mass, whereas `axis` added it to the
/// axial load.
#[test]
fn commands_nut_and_axis_add_the_weight_to_the_axial_load() {
    let nut = fs::read_to_string(example("nut.json")).expect("an example");
    let words = [
        "axial_load_N=3000",
        "moved_mass_kg=100",
        "inclination_deg=90",
        "screw_speed_rpm=500",
        "stroke_mm=500",
    ];
    let settings: Vec<_> = words.iter().flat_map(|word| ["--set", word]).collect();
    let (code, found, told) = answer(&nut, &settings);
    assert_eq!(code, Some(0), "{told}");
    let notes = found["notes"].to_string();
    let load = "axial_load_N, mass, guides and counterbalance of the axis exert: 3980.7";
    assert!(notes.contains(load), "{notes}");
    let dir = folder();
    let case = example("nut.json");
    let args = [&["axis", &case, "--json"][..], &settings].concat();
    let axis: Value = serde_json::from_str(&stdout(&bsm(dir.path(), &args, ""))).expect("JSON");
    let largest = axis["results"]["largest_load_N"].as_f64().expect("a load");
    // The load consists of 3000 N and the weight of 100 kg at 9.80665 m/s².
    assert!((largest - 3980.665).abs() < 1e-9, "{largest}");
}

/// Regression test: `solve --show ratings` and `axis` rejected the example feed drive, because the
/// case does not state the number of loaded turns.
#[test]
fn ratings_axis_and_nut_accept_the_example_feed_drives() {
    let dir = folder();
    for case in ["feed_drive.json", "feed_drive_oil.json"] {
        for args in [
            &["solve", &example(case), "--show", "ratings"][..],
            &["axis", &example(case)],
            &["nut", &example(case)],
        ] {
            let output = bsm(dir.path(), args, "");
            assert_eq!(output.status.code(), Some(0), "{args:?}: {}", stderr(&output));
        }
    }
}

/// A centrifugal force of 1 % of the load requires no action by the user, so it must cause a note
/// and not a warning.
#[test]
fn small_centrifugal_force_causes_a_note_but_no_warning() {
    let guided = fs::read_to_string(example("nut_guided.json")).expect("an example");
    let at = |rpm: u32| answer(&guided, &["--set", &format!("screw_speed_rpm={rpm}")]).1;
    let said = |found: &Value, of: &str| found[of].to_string().contains("centrifugal");
    let (slow, medium, fast) = (at(100), at(8000), at(30000));
    assert!(!said(&slow, "notes") && !said(&slow, "warnings"), "{slow}");
    assert!(said(&medium, "notes") && !said(&medium, "warnings"), "{medium}");
    assert!(said(&fast, "warnings"), "{fast}");
}

/// Regression test: given losses of seals and ball returns were ignored without a message.
#[test]
fn specified_losses_are_included_in_the_drive_torque() {
    let double = fs::read_to_string(example("nut_double.json")).expect("an example");
    let (_, dry, _) = answer(&double, &[]);
    let (_, sealed, _) = answer(&double, &["--set", "seal_torque_Nm=0.1"]);
    let speed = 500.0 * std::f64::consts::PI / 30.0;
    // Both torques are sums of the same contributions, so they differ only by rounding errors.
    assert!(
        (number(&sealed, "drive_torque_Nm") - number(&dry, "drive_torque_Nm") - 0.1).abs() < 1e-12
    );
    assert!(
        (number(&sealed, "friction_heat_W") - number(&dry, "friction_heat_W") - 0.1 * speed).abs()
            < 1e-9
    );
    assert_eq!(sealed["nut_seal_torque_Nm"], 0.1);
    assert_eq!(sealed["friction_torque_Nm"], dry["friction_torque_Nm"]);
    let mut oiled: Value = serde_json::from_str(&double).expect("JSON");
    oiled.as_object_mut().expect("object").retain(|key, _| key != "friction_coefficient");
    for (key, value) in [
        ("iso_vg", 68.0),
        ("lubricant_temperature_C", 40.0),
        ("ball_roughness_um", 0.03),
        ("nut_roughness_um", 0.2),
        ("screw_roughness_um", 0.2),
    ] {
        oiled[key] = json!(value);
    }
    let (_, plain, words) = answer(&oiled.to_string(), &[]);
    (oiled["return_circuits"], oiled["return_loss_coefficient"]) = (json!(6), json!(2));
    let (_, returned, _) = answer(&oiled.to_string(), &[]);
    let returns = number(&returned, "return_torque_Nm");
    assert!(number(&plain, "return_torque_Nm").abs() <= 0.0, "{words}");
    // According to (Y26), each of the six ball returns dissipates twice the kinetic energy of every
    // ball that passes through it. The balls travel at half the speed of the screw.
    let (mass, travel) =
        (7800.0 * std::f64::consts::PI / 6.0 * 6.35e-3_f64.powi(3), 0.5 * speed * 20.73e-3);
    let power = 6.0 * 2.0 * 0.5 * mass * travel.powi(3) / 6.35e-3;
    // The orbital speed of a ball differs from half the screw speed by up to about 15 %, and the
    // power is proportional to the third power of the orbital speed.
    assert!((0.5..1.6).contains(&(returns * speed / power)), "{returns} {power}");
    let added = number(&returned, "drive_torque_Nm") - number(&plain, "drive_torque_Nm");
    assert!((added / returns - 1.0).abs() < 1e-6, "{added} {returns}");
}

/// Solves the example nut with oversize balls and the given settings.
fn solve_oversize_nut(sets: &[String]) -> Value {
    let case = fs::read_to_string(example("nut_oversize.json")).expect("an example");
    let args: Vec<_> = sets.iter().flat_map(|set| ["--set", set.as_str()]).collect();
    answer(&case, &[&args[..], &["--model", "traction"]].concat()).1
}

/// The friction torque must agree with an independent solution that includes friction in the force
/// balance of each ball. Regression test: friction was neglected in the calculation of the loads,
/// so that the torque dropped to 0.225 N m below the limit load and jumped to 0.312 N m above it.
#[test]
fn friction_torque_of_oversize_balls_matches_the_reference() {
    let at = |load: f64| solve_oversize_nut(&[format!("axial_load_N={load}")]);
    let limit = number(&at(3000.0), "limit_load_N");
    for (part, torque) in [(0.0, 0.557), (0.9, 0.747), (0.995, 0.805), (1.2, 0.917)] {
        let found = number(&at(part * limit), "friction_torque_Nm");
        // The reference values are rounded to three digits.
        assert!((found - torque).abs() < 6e-4, "{part}: {found} {torque}");
    }
}

#[test]
fn friction_torque_is_continuous_where_a_ball_leaves_its_second_flank() {
    let at = |load: f64, rpm: f64| {
        solve_oversize_nut(&[
            format!("axial_load_N={load}"),
            format!("screw_speed_rpm={rpm}"),
            "preload_N=1000".to_owned(),
            "loaded_turns=1".to_owned(),
        ])
    };
    let limit = number(&at(10.0, 50.0), "limit_load_N");
    for rpm in [50.0, -50.0] {
        let [before, after] =
            [0.9999, 1.0001].map(|part| number(&at(part * limit, rpm), "friction_torque_Nm"));
        // The relative change of the load is 2e-4, so the relative change of a continuous torque is
        // less than 5e-4.
        assert!((after / before - 1.0).abs() < 5e-4, "{before} {after}");
    }
}

#[test]
fn drag_torque_of_a_pair_with_play_matches_the_reference() {
    let pair = json!({
        "ball_diameter_mm": 6.35, "pitch_circle_diameter_mm": 41.5, "lead_mm": 10,
        "contact_angle_deg": 45, "nut_conformity": 0.53, "screw_conformity": 0.53,
        "youngs_modulus_GPa": 207, "density_kg_m3": 7800, "friction_coefficient": 0.1,
        "screw_speed_rpm": 100, "preload_N": 1200, "loaded_turns": 1, "loaded_balls_per_turn": 20
    });
    let with = |play: Option<f64>| {
        let mut pair = pair.clone();
        if let Some(play) = play {
            pair["axial_play_um"] = json!(play);
        }
        let (code, found, words) = answer(&pair.to_string(), &[]);
        assert_eq!(code, Some(0), "{words}");
        found
    };
    // The numbers in each row are the play, the drag torque coefficient, and the ratio of the
    // running preload to the given preload. The values come from validation/published/nut.
    for (play, running, force) in
        [(0.0, 0.205_056, 0.969_428), (10.0, 0.186_738, 1.024_71), (50.0, 0.052_749, 1.456_62)]
    {
        let found = with(Some(play));
        let preload = number(&found, "running_preload_N");
        let factor =
            number(&found, "running_preload_torque_Nm") / (preload * 10e-3 / std::f64::consts::TAU);
        // The reference values have six digits, and the contact ellipses are integrated with an
        // error of 1e-6.
        assert!((factor / running - 1.0).abs() < 2e-5, "{play}: {factor}");
        assert!((preload / 1200.0 - force).abs() < 2e-5, "{play}: {preload}");
        assert!(found["running_preload_torque_factor_without_play"].is_null(), "{found}");
    }
    let [wide, unknown] = [with(Some(200.0)), with(None)];
    let torque = number(&wide, "running_preload_torque_Nm");
    // With a play of 200 um and with unknown play, every ball has two contacts.
    assert!(
        (number(&unknown, "running_preload_torque_Nm") / torque - 1.0).abs() < 1e-9,
        "{torque}"
    );
    let none = number(&with(Some(0.0)), "running_preload_torque_factor");
    assert!(
        (number(&unknown, "running_preload_torque_factor_without_play") / none - 1.0).abs() < 1e-9,
        "{none}"
    );
    let rule = number(&unknown, "preload_torque_factor_rule");
    assert!((rule - 0.05 / (10.0 / (41.5 * std::f64::consts::PI)).sqrt()).abs() < 1e-12, "{rule}");
}

/// For warm pairs in X and O arrangement, the preloads, loads, stiffness and lives at the reference
/// temperatures must agree with an independent solution.
#[test]
fn warm_nut_pairs_match_an_independent_solution() {
    let cases = fs::read_to_string(root().join("validation/published/nut/warm.json"));
    let cases: Vec<Value> = serde_json::from_str(&cases.expect("cases")).expect("JSON");
    assert_eq!(cases.len(), 5);
    for reference in &cases {
        let (code, found, words) = answer(&reference["case"].to_string(), &[]);
        assert_eq!(code, Some(0), "{}: {words}", reference["id"]);
        for (key, expected) in reference["expect"].as_object().expect("numbers") {
            let (found, expected) = (number(&found, key), expected.as_f64().expect("a number"));
            // The reference temperatures and results have twelve digits. For comparison, a
            // temperature change of one degree would change the preload by several tens of percent.
            assert!(
                (found / expected - 1.0).abs() < 1e-9,
                "{} {key}: {found} {expected}",
                reference["id"]
            );
        }
    }
}
