//! Screen output, JSON answers and schemas of the examples, compared with stored snapshots.
//!
//! Snapshots guard against unintended changes; they do not validate numbers. After an intended
//! change, `just snapshots` stores the new texts, and the difference shows in the commit.

use std::process::Output;

use serde_json::{Value, json};

use crate::program::{bsm, json as parsed, root, stderr, stdout};

/// Number of digits of numbers in snapshots. The last digits of solutions depend on the instruction
/// set of the processor.
const DIGITS: usize = 6;

/// Magnitude below which numbers in JSON snapshots are replaced by zero. Smaller numbers are mostly
/// differences of larger numbers, such as residual forces, and depend on the processor.
const ROUNDED_TO_ZERO: f64 = 1e-5;

/// Length above which a list in a JSON snapshot is replaced by its length. Longer lists contain one
/// number per ball, some of which are rounding errors.
const MAX_LIST: usize = 20;

/// Runs a command in the folder of the examples. Returns standard error followed by standard
/// output.
fn screen_of(args: &[&str]) -> String {
    let output = run(args);
    stderr(&output) + &stdout(&output)
}

/// Runs a command in the examples folder.
fn run(args: &[&str]) -> Output {
    bsm(&root().join("examples"), args, "")
}

/// Rounds all numbers of an answer, so that the answer is the same on all processors.
fn rounded(value: &Value) -> Value {
    match value {
        Value::Number(number) if number.is_f64() => {
            let number = number.as_f64().unwrap_or(f64::NAN);
            let text = format!("{number:.*e}", DIGITS - 1);
            let is_zero = number.abs() < ROUNDED_TO_ZERO;
            json!(if is_zero { 0.0 } else { text.parse().expect("a number") })
        }
        Value::Array(items) if items.len() > MAX_LIST => json!(format!("{} items", items.len())),
        Value::Array(items) => items.iter().map(rounded).collect(),
        Value::Object(members) => {
            members.iter().map(|(key, value)| (key.clone(), rounded(value))).collect()
        }
        other => other.clone(),
    }
}

/// Compares the screen output of a command with the snapshot of the given name.
fn assert_screen(name: &str, args: &[&str]) {
    let mut settings = insta::Settings::clone_current();
    settings.set_omit_expression(true);
    settings.set_description(format!("bsm {}", args.join(" ")));
    settings.add_filter(r"residual \S+", "residual [..]");
    // Rounding errors and the width of their columns depend on the processor.
    settings.add_filter(r" -?\d[\d.]*e-(?:9|[1-3]\d)\b", " [..]");
    settings.add_filter(r" {2,}", "  ");
    settings.bind(|| insta::assert_snapshot!(name, screen_of(args)));
}

/// Compares the rounded JSON answer of a command with the snapshot of the given name.
fn assert_json(name: &str, args: &[&str]) {
    let answer = rounded(&parsed(&stdout(&run(&[args, &["--json"]].concat()))));
    let text = serde_json::to_string_pretty(&answer).expect("JSON");
    let mut settings = insta::Settings::clone_current();
    settings.set_omit_expression(true);
    settings.set_description(format!("bsm {} --json", args.join(" ")));
    settings.bind(|| insta::assert_snapshot!(format!("{name}-json"), text));
}

#[test]
fn output_for_single_balls_is_unchanged() {
    let cases = ["feed_drive", "feed_drive_oil", "lin1994", "xu2015", "back_driving"];
    for case in cases {
        let args = ["solve", &format!("{case}.json")];
        assert_screen(&format!("solve-{case}"), &args);
        assert_json(&format!("solve-{case}"), &args);
    }
    for part in ["slip", "jam", "optimum", "ratings", "steps"] {
        assert_screen(&format!("show-{part}"), &["solve", "jamming.json", "--show", part]);
    }
}

#[test]
fn output_for_nuts_is_unchanged() {
    let cases = [
        "nut",
        "nut_double",
        "nut_free",
        "nut_guided",
        "nut_misaligned",
        "nut_oversize",
        "nut_train",
    ];
    for case in cases {
        let args = ["nut", &format!("{case}.json")];
        assert_screen(case, &args);
        assert_json(case, &args);
    }
}

#[test]
fn output_for_axes_is_unchanged() {
    for case in ["axis", "rated", "catalog_line"] {
        let args = ["axis", &format!("{case}.json")];
        assert_screen(&format!("axis-{case}"), &args);
        assert_json(&format!("axis-{case}"), &args);
    }
}

#[test]
fn output_for_selections_is_unchanged() {
    for requirement in ["axis", "feed_drive", "free_lead", "load_drives"] {
        let path = format!("requirements/{requirement}.json");
        let free: &[&str] = if requirement == "free_lead" { &["--free"] } else { &[] };
        assert_screen(&format!("select-{requirement}"), &[&["select", &path], free].concat());
    }
    let table = ["--from", "manufacturer_table.csv"];
    let select = ["select", "requirements/axis.json"];
    assert_screen("select-table", &[&select[..], &table].concat());
}

#[test]
fn schemas_are_unchanged() {
    for schema in ["input", "output", "units"] {
        let text = screen_of(&["schema", schema]);
        let mut settings = insta::Settings::clone_current();
        settings.set_omit_expression(true);
        settings.set_description(format!("bsm schema {schema}"));
        settings.bind(|| insta::assert_snapshot!(format!("schema-{schema}"), text));
    }
}
