//! Tests of the reports that `validate` and `tradeoff` write.

use crate::data;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::program::{bsm, folder, stderr, stdout};
use data::copy_published;

fn validation() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation")
}

#[test]
fn validate_passes_and_writes_its_report() {
    let dir = folder();
    let output = bsm(dir.path(), &["validate", "--figures", "report"], "");
    assert_eq!(output.status.code(), Some(0), "{}", stdout(&output));
    assert!(stdout(&output).contains(" 0 failed"));
    let read = |file: &str| fs::read_to_string(dir.path().join("report").join(file)).expect(file);
    // The figure shows three models at three loads and 61 speeds.
    assert_eq!(read("figures/transition.csv").lines().count(), 1 + 9 * 61);
    let transition = read("figures/transition.svg");
    assert!(transition.contains(">traction<") && transition.contains(">20 N<"), "a legend");
    assert!(read("report.html").contains("0 fail"));
    let results: Value = serde_json::from_str(&read("results.json")).expect("JSON");
    assert_eq!(results["passed"], true);
    assert!(results["checks"].as_array().expect("list").len() >= 25);
    // This command runs only the selected checks and writes a page that contains only these checks.
    let some = ["validate", "--only", "elastic/", "--json", "-o", "some.html", "-o", "some.json"];
    let output = bsm(dir.path(), &some, "");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let some: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    let keys = some["checks"].as_array().expect("list").iter().map(|check| check["key"].as_str());
    assert!(keys.clone().count() > 0 && keys.flatten().all(|key| key.contains("elastic/")));
    let read = |file: &str| fs::read_to_string(dir.path().join(file)).expect(file);
    assert_eq!(serde_json::from_str::<Value>(&read("some.json")).expect("JSON"), some);
    assert!(read("some.html").contains("hertz-nut-ratio"));
    assert!(!read("some.html").contains("lin1994&#x2f;"));
    let output = bsm(dir.path(), &["validate", "--only", "nothing"], "");
    assert_eq!(output.status.code(), Some(2));
}

/// If the fifth digit of a reference value is changed, the corresponding check must fail on the
/// screen and on the page.
#[test]
fn check_fails_if_its_reference_value_is_changed() {
    let dir = folder();
    let data = copy_published(dir.path());
    let args = ["validate", "--from", "data", "--figures", "report"];
    let output = bsm(dir.path(), &args[..3], "");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));

    let file = data.join("checks.csv");
    let table = fs::read_to_string(&file).expect("a table");
    let row = table.lines().find(|row| row.starts_with("elastic/hertz-nut-ratio,")).expect("a row");
    // In each row, the reference value precedes the tolerance.
    let value = row.rsplit(',').filter_map(|cell| cell.parse::<f64>().ok()).nth(1);
    let value = value.expect("a number");
    let perturbed =
        table.replace(row, &row.replace(&value.to_string(), &(1.0001 * value).to_string()));
    assert_ne!(perturbed, table);
    fs::write(&file, perturbed).expect("written");
    let output = bsm(dir.path(), &args, "");
    assert_eq!(output.status.code(), Some(3), "{}", stdout(&output));
    assert!(stdout(&output).contains("FAIL elastic/hertz-nut-ratio"), "{}", stdout(&output));
    let page = fs::read_to_string(dir.path().join("report/report.html")).expect("a page");
    assert_eq!(page.matches("class=\"failed\"").count(), 1);
    assert!(page.contains("hertz-nut-ratio\" class=\"failed\">"));

    fs::write(&file, table.lines().next().expect("a header")).expect("written");
    let output = bsm(dir.path(), &args, "");
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("checks.csv: the table contains no rows"),
        "{}",
        stderr(&output)
    );
    fs::remove_file(&file).expect("removed");
    let output = bsm(dir.path(), &args, "");
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("checks.csv"), "{}", stderr(&output));
}

#[test]
fn command_tradeoff_measures_only_the_points_of_a_table() {
    let dir = folder();
    let cases = fs::read_to_string(validation().join("golden/tradeoff/cases.csv")).expect("data");
    let few: Vec<_> = cases.lines().take(4).collect();
    fs::write(dir.path().join("few.csv"), few.join("\n")).expect("written");
    let output = bsm(dir.path(), &["tradeoff", "--points", "few.csv", "--figures", "report"], "");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    for part in ["points: all 3", "traction --accuracy 1e-8", "auto --tolerance 1e-3", "0.01 %"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let read = |file: &str| fs::read_to_string(dir.path().join("report").join(file)).expect(file);
    assert!(read("report.html").contains("speed against accuracy"));
    assert!(read("figures/pareto-single.svg").contains("raceway-control"));
    let results: Value = serde_json::from_str(&read("results.json")).expect("JSON");
    assert_eq!(results["tradeoff"]["points"][0]["points"], 3);

    fs::write(dir.path().join("short.csv"), "lead_angle_deg\n10\n").expect("written");
    let output = bsm(dir.path(), &["tradeoff", "--points", "short.csv"], "");
    assert_eq!(output.status.code(), Some(2));
    let text = stderr(&output);
    assert!(text.contains("short.csv: row 1") && text.contains("nut_conformity"), "{text}");
    // No model solves this point, so there is no reference solution from which errors could be
    // calculated.
    let hopeless = format!("{}\n40,8,30,85,1,0.53,0.53,0,100,100,1\n", few[0]);
    fs::write(dir.path().join("hopeless.csv"), hopeless).expect("written");
    let output = bsm(dir.path(), &["tradeoff", "--points", "hopeless.csv"], "");
    assert_eq!(output.status.code(), Some(3));
    assert!(stderr(&output).contains("no reference"), "{}", stderr(&output));
    let output = bsm(dir.path(), &["tradeoff", "--points", "none.csv"], "");
    assert_eq!(output.status.code(), Some(1));
}
