//! `bsm nut` as a user meets it.

use crate::program;

use std::fs;
use std::path::{Path, PathBuf};

use program::{bsm, folder, stderr, stdout};
use serde_json::{Value, json};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn example(name: &str) -> String {
    root().join("examples").join(name).display().to_string()
}

/// The answer in JSON, and the exit code.
fn answer(scene: &str, args: &[&str]) -> (Option<i32>, Value, String) {
    let dir = folder();
    let output = bsm(dir.path(), &[&["nut", "-", "--format", "json"], args].concat(), scene);
    let json = serde_json::from_str(&stdout(&output)).unwrap_or(Value::Null);
    (output.status.code(), json, stderr(&output))
}

/// The message of a scene that is refused.
fn refusal(change: &Value, args: &[&str]) -> String {
    let mut scene = single();
    scene.as_object_mut().expect("object").extend(change.as_object().expect("object").clone());
    let (code, _, words) = answer(&scene.to_string(), args);
    assert_eq!(code, Some(2), "{change}: {words}");
    words
}

fn single() -> Value {
    json!({
        "ball_diameter_mm": 6.35, "pitch_circle_diameter_mm": 41.336, "lead_mm": 10,
        "contact_angle_deg": 45, "nut_conformity": 0.5203, "screw_conformity": 0.5203,
        "youngs_modulus_GPa": 206, "loaded_turns": 3, "loaded_balls_per_turn": 20,
        "axial_load_N": 6340
    })
}

/// The scene of a reference case with its loads in the words of a scene.
fn scene_of(case: &Value) -> Value {
    let mut scene = case["scene"].clone();
    let loads = case["load_SI"].as_object().expect("loads");
    for (dof, word) in [
        ("uz", "axial_load_N"),
        ("ux", "radial_load_x_N"),
        ("uy", "radial_load_y_N"),
        ("px", "moment_x_Nm"),
        ("py", "moment_y_Nm"),
    ] {
        if let Some(load) = loads.get(dof) {
            scene[word] = load.clone();
        }
    }
    if loads.len() > 1 {
        scene["nut_guidance"] = json!("free");
    }
    if let Some(ratings) = case["ratings"].as_object() {
        scene.as_object_mut().expect("scene").extend(ratings.clone());
    }
    scene
}

/// Every number of `expect` by its name: to the tolerance of the cases, 1e-9, relative to the number, or, for what
/// symmetry makes zero, to a thousandth of the largest number of the list. Loads have their own floor, a millionth
/// of the largest (chapter 11.10 of the cases' origin); sums of forces that cancel have that of all loads.
#[test]
fn reference_cases_run_as_scenes() {
    let cases = fs::read_to_string(root().join("validation/published/nut/public.json"));
    let cases: Vec<Value> = serde_json::from_str(&cases.expect("cases")).expect("JSON");
    assert_eq!(cases.len(), 14);
    for case in &cases {
        let name = case["name"].as_str().expect("name");
        let (code, found, words) = answer(&scene_of(case).to_string(), &[]);
        assert_eq!(code, Some(0), "{name}: {words}");
        let tolerance = case["rel_tol"].as_f64().expect("tolerance");
        let expect = case["expect"].as_object().expect("expected");
        let sum: f64 = ["nut_plus_N", "nut_minus_N"]
            .iter()
            .flat_map(|key| expect[*key].as_array().expect("loads"))
            .map(|load| load.as_f64().expect("load"))
            .sum();
        let largest = expect["max_contact_load_N"].as_f64().expect("load");
        for (key, expected) in expect.iter().filter(|(key, _)| *key != "iterations") {
            let list = |value: &Value| value.as_array().cloned().unwrap_or(vec![value.clone()]);
            let (expected, found) = (list(expected), list(&found[key]));
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
                // Displacements of an unloaded pair are zero but for rounding, 1e-15 m.
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

/// The words mean what the objects mean: bars and ring from anchors and diameters (chapter 16), the pair of
/// case P06 from a preload, to the digits of the bracket of the preload, 1e-8.
#[test]
fn short_words_are_the_objects() {
    let same = |short: &Value, long: &Value, tolerance: f64| {
        let run = |change: &Value| {
            let mut scene = single();
            let map = scene.as_object_mut().expect("object");
            map.extend(change.as_object().expect("object").clone());
            map.retain(|_, value| !value.is_null());
            let (code, found, words) = answer(&scene.to_string(), &[]);
            assert_eq!(code, Some(0), "{change}: {words}");
            found
        };
        let (short, long) = (run(short), run(long));
        for key in
            ["max_contact_load_N", "max_over_mean", "nut_displacement_um", "life_revolutions"]
        {
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
        &json!({ "bars": { "nut": { "EA_N": of_nut, "anchor": "low" },
                           "screw": { "EA_N": of_screw, "anchor": "high" } },
                 "ring": { "outer_diameter_mm": 70, "inner_diameter_mm": middle + across },
                 "nut_guidance": "free" }),
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
        { "start_deg": 0, "arc_deg": 1080, "balls": 60, "body": 0, "offset_um": offset },
        { "start_deg": 1440, "arc_deg": 1080, "balls": 60, "body": 1, "offset_um": -offset }
    ]));
    pair["axial_load_N"] = json!(3000);
    same(&json!({ "preload_N": 3000, "axial_load_N": 3000 }), &pair, 1e-8);
}

/// What no two people would read alike is refused, with the path of what is wrong.
#[test]
fn words_that_cannot_be_meant_are_refused() {
    let circuit = json!({ "start_deg": 0, "arc_deg": 330, "balls": 18 });
    let with = |key: &str, value: Value| {
        let mut other = circuit.clone();
        other[key] = value;
        json!({ "circuits": [circuit, other], "loaded_turns": null, "loaded_balls_per_turn": null })
    };
    for (change, words) in [
        (with("bals", json!(3)), "`circuits[1].bals`: unknown field"),
        (with("balls", json!(0)), "`circuits[1].balls` = 0 must be"),
        (with("arc_deg", json!(-1)), "`circuits[1].arc_deg` = -1 must be finite and > 0"),
        (with("start", json!(1)), "`circuits[1].start` = 1 must be below the number of starts, 1"),
        (with("body", json!(2)), "no circuit belongs to body 1"),
        (with("flank", json!("up")), "`circuits[1].flank`: unknown variant `up`"),
        (json!({ "circuits": [circuit] }), "give one of circuits and loaded_turns; both are given"),
        (json!({ "ring_expansion": 1 }), "`ring_expansion`: invalid type: integer"),
        (json!({ "nut_gidance": "free" }), "did you mean `nut_guidance`?"),
        (json!({ "nut_guidance": "loose" }), "`nut_guidance`: unknown variant `loose`"),
        (
            json!({ "bars": { "nut": { "EA_N": 1e8, "anchor": "low" } }, "nut_anchor": "low" }),
            "bars and nut_anchor",
        ),
        (
            json!({ "bars": { "nut": { "EA_N": 1e8 } } }),
            "`bars.nut`: give one of anchor and anchor_z_mm",
        ),
        (json!({ "nut_EA_N": 1e8 }), "needs the place where the force leaves: nut_anchor"),
        (json!({ "nut_anchor": "low", "nut_anchor_z_mm": 3 }), "nut_anchor and nut_anchor_z_mm"),
        (
            json!({ "screw_torsion": true }),
            "`screw_torsion`: needs the place where force and torque",
        ),
        (
            json!({ "screw_torsion": true, "screw_EA_N": 1e8, "screw_anchor": "low" }),
            "screw_torsion and screw_EA_N",
        ),
        (
            json!({ "loaded_balls_per_turn": 0.1 }),
            "0.1 a turn leave each of 1 circuits of 1080.0 deg without a ball",
        ),
        (
            json!({ "ring": { "outer_diameter_mm": 30, "inner_diameter_mm": 40 } }),
            "`ring.outer_diameter_mm` = 30",
        ),
        (json!({ "lead_error": [{ "amplitude_um": 1 }] }), "`lead_error[0]`: must be a wave"),
        (json!({ "ball_deviation_um": [1, 2] }), "has 2 numbers, but the nut has 60 balls"),
        (json!({ "radial_load_x_N": 10 }), "acts on what the guides hold"),
        (json!({ "radial_load_x_N": 10, "radial_x_um": 1 }), "radial_load_x_N and radial_x_um"),
        (json!({ "preload_N": 10, "ball_oversize_um": 1 }), "preload_N and ball_oversize_um"),
        (json!({ "starts": 1.5 }), "`starts` = 1.5 must be a whole number, 1 or more"),
        (json!({ "axial_load_N": null }), "axial_load_N (or preload_N) is required for a nut"),
        (json!({ "loaded_turns": null }), "loaded_turns (or circuits) is required for a nut"),
    ] {
        let said = refusal(&change, &[]);
        assert!(said.contains(words), "{change}: {said}");
    }
    assert!(
        refusal(&json!({}), &["--model", "rigid"]).contains("model rigid has no loaded grooves")
    );
    assert!(refusal(&json!({}), &["--samples", "5"]).contains("ball_deviation_sd_um"));
}

/// A word on the command line, and a load of zero, which one ball does not have.
#[test]
fn settings_take_words() {
    let (_, found, words) = answer(&single().to_string(), &["--set", "nut_guidance=free"]);
    assert!(found["nut_tilt_urad"].as_f64().expect("a tilt") > 1.0, "{words}");
    let pulled = ["--set", "axial_load_N=-6340"];
    let (_, pulled, _) = answer(&single().to_string(), &pulled);
    let (_, pushed, _) = answer(&single().to_string(), &[]);
    // Two flanks of one shape: only signs differ.
    for key in ["max_contact_load_N", "life_revolutions"] {
        assert_eq!(pulled[key], pushed[key], "{key}");
    }
    let (code, none, _) = answer(
        &single().to_string(),
        &["--set", "axial_load_N=-500", "--set", "loaded_turns=1", "--set", "nut_guidance=free"],
    );
    assert_eq!(code, Some(0), "{none}");
    // A circuit with one flank carries nothing the other way.
    let mut scene = single();
    let map = scene.as_object_mut().expect("object");
    map.retain(|key, _| !key.starts_with("loaded"));
    scene["circuits"] = json!([{ "start_deg": 0, "arc_deg": 720, "balls": 40, "flank": "+" }]);
    scene["axial_load_N"] = json!(-500);
    let (code, none, _) = answer(&scene.to_string(), &[]);
    assert_eq!((code, none["status"].as_str()), (Some(3), Some("no_solution")), "{none}");
    assert!(
        none["message"].as_str().expect("words").contains("nothing carries the load"),
        "{none}"
    );
}

/// A preloaded nut: the three rigidities are as their names say, the limit load is where no preload is
/// left, and the torque comes with its remark.
#[test]
fn a_preloaded_pair_tells_rigidity_limit_and_drag() {
    let dir = folder();
    let scene = example("nut_double.json");
    let output = bsm(dir.path(), &["nut", &scene, "--format", "json"], "");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let found: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    let of = |key: &str| found[key].as_f64().unwrap_or_else(|| panic!("{key}: {found}"));
    let two = of("rigidity_2_N_um");
    assert!((of("rigidity_3_N_um") / two - 1.5).abs() < 1e-12);
    assert!((of("rigidity_2_83_N_um") / two - 2.0_f64.sqrt()).abs() < 1e-12);
    assert!((of("preload_set_N") - 3000.0).abs() < 1e-4, "the bracket of the preload");
    // 2.86 to 2.91 with the contact angles of real preloads (chapter 16).
    let ratio = of("limit_load_N") / of("preload_set_N");
    assert!((2.8..2.95).contains(&ratio), "{ratio}");
    // Dry friction of 0.06 gives K_p of 0.033, a third of the least that catalogues state (chapter 16).
    let factor = of("preload_torque_factor");
    assert!((0.025..0.045).contains(&factor), "{factor}");
    let low = of("rule_torque_low_Nm");
    assert!((of("preload_torque_Nm") / low - factor / 0.1).abs() < 1e-12);
    assert!((of("rule_torque_high_Nm") / low - 3.0).abs() < 1e-12);
    assert!(of("preload_left_N") < of("preload_set_N") && of("friction_torque_Nm") > 0.0);
    let output = bsm(dir.path(), &["nut", &scene], "");
    let text = stdout(&output);
    for part in [
        "2^1.5 F_p/delta_p",
        "limit load",
        "K_p",
        "3 to 10 times",
        "life by all balls over that of ISO",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let set = format!("axial_load_N={}", 1.01 * of("limit_load_N"));
    let output = bsm(dir.path(), &["nut", &scene, "--set", &set, "--format", "json"], "");
    let beyond: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    assert!(beyond["preload_left_N"].as_f64().expect("N").abs() < 1e-9, "{beyond}");
    let solved = bsm(dir.path(), &["solve", &scene], "");
    let words = stderr(&solved);
    assert!(words.contains("preload_N is not in the balance of one ball: see bsm nut"), "{words}");
}

#[test]
fn balls_curve_and_figures_are_written() {
    let dir = folder();
    let scene = example("nut_oversize.json");
    let args =
        ["nut", &scene, "--table", "balls.csv", "--curve", "-o", "curve.csv", "--plot", "figures"];
    let output = bsm(dir.path(), &args, "");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let rows = |name: &str| {
        let text = fs::read_to_string(dir.path().join(name)).expect(name);
        text.lines().map(str::to_owned).collect::<Vec<_>>()
    };
    let balls = rows("balls.csv");
    assert!(balls[0].starts_with("circuit,body,theta_deg,z_mm,nut_plus_N"), "{}", balls[0]);
    assert_eq!(balls.len(), 1 + 98);
    let curve = rows("curve.csv");
    assert!(curve[0].starts_with("axial_load_N,nut_displacement_um"), "{}", curve[0]);
    // Displacement rises with the load, preload falls.
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

/// Samples follow from the seed alone, whatever the threads; the scene's own nut is the first of them.
#[test]
fn samples_follow_from_their_seed() {
    let dir = folder();
    let scene = example("nut_scattered.json");
    let run = |threads: &str, seed: &str| {
        let args = ["nut", &scene, "--samples", "12", "--seed", seed, "--format", "json"];
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

/// The numbers of a nut are columns of a sweep, and one row of it is the nut itself.
#[test]
fn numbers_of_a_nut_are_columns() {
    let dir = folder();
    let scene = example("nut_double.json");
    let columns = "max_over_mean,unloaded_balls,nut_stiffness_N_um,preload_left_N,life_revolutions,iso_life_revolutions";
    let args =
        ["sweep", &scene, "--vary", "axial_load_N=1000,4000", "--columns", columns, "-o", "-"];
    let output = bsm(dir.path(), &args, "");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    let row: Vec<_> = text.lines().nth(2).expect("two rows").split(',').collect();
    let header: Vec<_> = text.lines().next().expect("a header").split(',').collect();
    let args = ["nut", &scene, "--set", "axial_load_N=4000", "--format", "json"];
    let found: Value = serde_json::from_str(&stdout(&bsm(dir.path(), &args, ""))).expect("JSON");
    for name in columns.split(',') {
        let place = header.iter().position(|column| *column == name).expect(name);
        let cell: f64 = row[place].parse().unwrap_or_else(|_| panic!("{name}: {text}"));
        // The same solve: to the last bit.
        assert_eq!(Some(cell.to_bits()), found[name].as_f64().map(f64::to_bits), "{name}: {text}");
    }
}
