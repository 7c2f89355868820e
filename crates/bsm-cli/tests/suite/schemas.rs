//! Tests that the JSON output of every command conforms to its schema.

use std::fs;
use std::path::Path;

use jsonschema::Validator;
use serde_json::Value;

use crate::program::{bsm, example, folder, stderr, stdout};

fn json(folder: &Path, args: &[&str]) -> Value {
    let output = bsm(folder, args, "");
    let told = stderr(&output);
    serde_json::from_str(&stdout(&output)).unwrap_or_else(|e| panic!("{args:?}: {e}: {told}"))
}

fn schema(folder: &Path, name: &str) -> Validator {
    let schema = json(folder, &["schema", name]);
    jsonschema::meta::validate(&schema).unwrap_or_else(|e| panic!("{name} is no schema: {e}"));
    jsonschema::validator_for(&schema).unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn assert_valid(schema: &Validator, result: &Value, what: &[&str]) {
    let errors: Vec<_> =
        schema.iter_errors(result).take(5).map(|e| format!("{}: {e}", e.instance_path())).collect();
    assert!(errors.is_empty(), "{what:?}:\n{}", errors.join("\n"));
}

/// Actual results, with and without a solution and with all options, must be valid under their
/// schemas. A result with an unknown key must be invalid.
#[test]
fn results_are_valid_under_their_schemas() {
    let dir = folder();
    fs::write(
        dir.path().join("lists.json"),
        "{\"nominal_diameter_mm\": [50, 63], \"lead_mm\": [20]}",
    )
    .expect("lists");
    let measured = "axial_load_kN,screw_torque_Nm\n4,12.9\n8,25.9\n12,38.7\n";
    fs::write(dir.path().join("measured.csv"), measured).expect("measurements");
    let [drive, oil, lin, nut, axis, jamming, manufacturers, requirement, double, train, line] = [
        "feed_drive.json",
        "feed_drive_oil.json",
        "lin1994.json",
        "nut.json",
        "axis.json",
        "jamming.json",
        "manufacturer_table.csv",
        "requirements/axis.json",
        "nut_double.json",
        "nut_train.json",
        "catalog_line.json",
    ]
    .map(example);
    let lines = "nut,nominal_diameter_mm,lead_mm,dynamic_load_rating_N,static_load_rating_N\na,40,20,51300,144400\n";
    fs::write(dir.path().join("lines.csv"), lines).expect("a table");
    // Only the plan of the dataset is written; no part is solved.
    let plan = ["--vary=axial_load_N=1:9:3", "-o", "map/", "--plan"];
    assert!(bsm(dir.path(), &[&["sweep", &drive][..], &plan].concat(), "").status.success());
    let runs: &[&[&str]] = &[
        &["solve", &drive],
        &["solve", &drive, "--show", "sensitivities", "--model", "traction"],
        &["solve", &oil],
        &["solve", &axis],
        &["solve", &line, "--set", "axial_load_N=5000", "--set", "screw_speed_rpm=500"],
        &["solve", &line, "--show", "ratings"],
        &["nut", &line],
        &["axis", &line],
        &["select", "--from", "lines.csv"],
        &["solve", &lin, "--set", "lead_angle_deg=5"],
        &["solve", &drive, "--model", "all"],
        &["solve", &lin, "--show", "optimum"],
        &["solve", &drive, "--show", "optimum", "--model", "quasi-static"],
        &["solve", &nut, "--show", "ratings"],
        &["nut", &double],
        &["nut", &train],
        &["nut", &double, "--set", "axial_load_MN=5"],
        &[
            "nut",
            &double,
            "--set",
            "axial_load_kN=5",
            "--set",
            "ball_deviation_sd_um=0.5",
            "--samples",
            "3",
        ],
        &["axis", &axis],
        &["axis", &axis, "--set", "axis_heat_transfer_W_K=5", "--set", "accuracy_grade=3"],
        &["fit", &drive, "--measured", "screw_torque_Nm=26"],
        &["fit", &drive, "--measured", "screw_torque_Nm=1"],
        &["fit", &drive, "--measured", "screw_torque_Nm", "--points", "measured.csv"],
        &["select", &requirement],
        &["select", &requirement, "--set", "required_life_h=1e9"],
        &["select", "--from", "lists.json", "--first", "3"],
        &["select", "--from", "lists.json", "--first", "3", &requirement],
        &["select", "--from", &manufacturers],
        &["solve", &drive, "--show", "slip"],
        &["solve", &lin, "--show", "slip", "--set", "lead_angle_deg=5"],
        &["solve", &drive, "--show", "ellipses", "--points", "3"],
        &["solve", &jamming, "--show", "jam"],
        &["validate"],
        &["parts", "check", "map"],
    ];
    for args in runs {
        let result = json(dir.path(), &[args, &["--json"][..]].concat());
        let after = |word: &str| {
            let place = args.iter().position(|arg| *arg == word)?;
            args.get(place + 1).copied()
        };
        // `solve` can print different answers, each with its own schema.
        let name = match (after("--show"), after("--model")) {
            (Some(show), _) if show != "sensitivities" => show,
            (_, Some("all")) => "models",
            _ => args[0],
        };
        let schema = schema(dir.path(), name);
        assert_valid(&schema, &result, args);
        let mut other = result.clone();
        let object = if other.is_array() { other.get_mut(0) } else { Some(&mut other) };
        object.expect("a result")["no such key"] = "a text".into();
        assert!(!schema.is_valid(&other), "{args:?}: a key that is in no schema");
    }
    let args = ["solve", &axis, "--show", "motion,slip,ratings", "--json"];
    let several = json(dir.path(), &args);
    for (member, name) in [("motion", "solve"), ("slip", "slip"), ("ratings", "ratings")] {
        assert_valid(&schema(dir.path(), name), &several[member], &[member]);
    }
    // Cases must be valid under the schema `input`, and table rows under the schema `output`.
    let input = schema(dir.path(), "input");
    for name in ["feed_drive.json", "nut_double.json", "axis.json", "feed_drive_oil.json"] {
        let case = fs::read(example(name)).expect("an example");
        assert_valid(&input, &serde_json::from_slice(&case).expect("JSON"), &[name]);
    }
}
