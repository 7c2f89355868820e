//! Tests of commands whose case contains only the data of one catalog line.

use std::fs;

use serde_json::Value;

use crate::program::{bsm, example, folder, json, stderr, stdout};

const SETTINGS: [&str; 6] = [
    "--set",
    "axial_load_N=5130",
    "--set",
    "screw_speed_rpm=500",
    "--set",
    "friction_coefficient=0.08",
];

/// Two catalog lines: R40-20K4-FSC from HIWIN and SFU1605-4 from TBI. In each case, the axial load
/// is a tenth of the dynamic load rating.
const LINES: &str =
    "nominal_diameter_mm,lead_mm,rated_dynamic_load_N,rated_static_load_N,axial_load_N
40,20,51300,144400,5130
16,5,13533,29930,1353.3
50,5,24900,10117,2490
";

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

/// Writes the example case of a screw that is specified by its load ratings, without its load cycle
/// and lubricant.
fn write_catalog_line(folder: &std::path::Path) {
    let text = fs::read_to_string(example("catalog_line.json")).expect("an example");
    let mut case: Value = serde_json::from_str(&text).expect("JSON");
    let map = case.as_object_mut().expect("an object");
    map.retain(|name, _| ["nominal", "lead_", "rated_"].iter().any(|head| name.starts_with(head)));
    fs::write(folder.join("line.json"), case.to_string()).expect("a case");
}

/// Table columns must contain the same results and intervals as the answers of `nut` and `solve`.
/// The groove is estimated separately for each row. If no groove is consistent with the ratings in
/// a row, the message of the row must say so.
#[test]
fn table_columns_contain_interval_bounds() {
    let dir = folder();
    write_catalog_line(dir.path());
    fs::write(dir.path().join("lines.csv"), LINES).expect("a table");
    let columns =
        "ball_torque_Nm,nut_stiffness_N_um,nut_stiffness_low_N_um,nut_stiffness_high_N_um";
    let args = ["sweep", "--points", "lines.csv", "--columns", columns, "-o", "out.jsonl"];
    let output = bsm(dir.path(), &[&args[..], &SETTINGS[2..], &["--keep-going"]].concat(), "");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(
        stderr(&output).contains("In rows that do not specify the groove completely"),
        "{}",
        stderr(&output)
    );
    let text = fs::read_to_string(dir.path().join("out.jsonl")).expect("rows");
    let rows: Vec<Value> = text.lines().map(json).collect();
    assert!(
        rows[2]["message"].as_str().is_some_and(|why| why.contains("nearest groove")),
        "{text}"
    );
    assert!(number(&rows[1]["ball_torque_Nm"]) < number(&rows[0]["ball_torque_Nm"]));
    let nut = bsm(dir.path(), &[&["nut", "line.json", "--json"][..], &SETTINGS].concat(), "");
    let nut = json(&stdout(&nut));
    let interval = &nut["groove_estimate"]["intervals"]["nut_stiffness_N_um"];
    // The table and the command perform the same calculation, so the results must be equal.
    assert_eq!(rows[0]["nut_stiffness_N_um"], nut["nut_stiffness_N_um"]);
    assert_eq!(rows[0]["nut_stiffness_low_N_um"], interval[0]);
    assert_eq!(rows[0]["nut_stiffness_high_N_um"], interval[1]);
    // If only the load varies, the groove is the same at all points, and a batch kernel can solve
    // all points together.
    let grid = [
        "sweep",
        "line.json",
        "--vary",
        "axial_load_N=5130,6000",
        "--columns",
        "ball_torque_Nm",
        "-o",
        "-",
    ];
    let output = bsm(dir.path(), &[&grid[..], &SETTINGS[2..]].concat(), "");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains("ball 6.35 mm"), "{}", stderr(&output));
    // If the case contains the groove geometry, the results must have no intervals.
    let given = [
        "sweep",
        &example("feed_drive.json"),
        "--vary",
        "axial_load_N=5000,6000",
        "--columns",
        "efficiency,efficiency_low",
        "-o",
        "-",
    ];
    let output = bsm(dir.path(), &given, "");
    assert!(stdout(&output).lines().skip(1).all(|row| row.ends_with(',')), "{}", stdout(&output));
}

/// Estimated inputs must be marked as estimated in the JSON, on the screen and on the sheet. Each
/// interval must directly follow the number to which it belongs.
#[test]
fn estimates_are_marked_in_every_output() {
    let dir = folder();
    write_catalog_line(dir.path());
    let solved = bsm(dir.path(), &[&["solve", "line.json", "--json"][..], &SETTINGS].concat(), "");
    let solved = json(&stdout(&solved));
    let estimated = solved["inputs"]["estimated_inputs"].as_array().expect("a list");
    assert!(
        estimated.contains(&"ball_diameter_mm".into()) && estimated.len() == 7,
        "{estimated:?}"
    );
    let [low, high] =
        [0, 1].map(|end| number(&solved["groove_estimate"]["intervals"]["ball_torque_Nm"][end]));
    let torque = number(&solved["ball_torque_Nm"]);
    assert!(low < torque && torque < high, "{low} {torque} {high}");
    let axis = ["axis", "line.json", "--set", "stroke_mm=500", "-o", "sheet.html"];
    let output = bsm(dir.path(), &[&axis[..], &SETTINGS].concat(), "");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    for text in
        [stdout(&output), fs::read_to_string(dir.path().join("sheet.html")).expect("a sheet")]
    {
        let row = text.lines().find(|line| line.contains("mean heat of nut")).expect("the heat");
        assert!(row.contains(" to ") && row.contains('('), "{row}");
        assert!(text.contains("The groove is estimated from the load ratings: ball 6.35 mm"));
    }
}

/// If a misprinted rating is not consistent with any groove, commands that need the groove must
/// exit with code 2. `axis` must still calculate the life and print a warning. The HTML page and
/// `fit` must work with an estimated groove.
#[test]
fn commands_accept_a_catalog_line_or_report_why_they_cannot() {
    let dir = folder();
    write_catalog_line(dir.path());
    let run = |args: &[&str]| {
        let output = bsm(dir.path(), &[args, &SETTINGS].concat(), "");
        (output.status.code(), stdout(&output) + &stderr(&output))
    };
    let misprint = ["--set", "rated_static_load_N=14440"];
    for command in ["solve", "nut"] {
        let (code, text) = run(&[&[command, "line.json"][..], &misprint].concat());
        assert!(
            code == Some(2) && text.contains("rated_static_load_N were 10 times as large"),
            "{text}"
        );
    }
    let (code, text) =
        run(&[&["axis", "line.json", "--set", "stroke_mm=500"][..], &misprint].concat());
    assert!(
        code == Some(0)
            && text.contains("warning: No typical groove")
            && text.contains("life under the cycle"),
        "{text}"
    );
    let (code, text) = run(&["fit", "line.json", "--measured", "screw_torque_Nm=16.65"]);
    assert!(code == Some(0) && text.contains("over the possible grooves"), "{text}");
    let (code, text) = run(&["view", "line.json", "-o", "page.html"]);
    // If the build does not contain the solver for saved pages, the command checks its inputs and
    // then refuses to write a page.
    assert!(code == Some(0) || text.contains("cannot write a page, because"), "{text}");
}

/// A table of screws that are specified only by their load ratings must contain intervals in JSON
/// and CSV. The comparison of two such screws, with `axis` and in the browser, must also contain
/// intervals.
#[test]
fn lists_and_offers_from_catalog_data_contain_intervals() {
    let dir = folder();
    write_catalog_line(dir.path());
    let rows = LINES.lines().zip(["nut", "R40", "SFU", "misprint"]);
    let lines: Vec<_> = rows
        .map(|(row, name)| format!("{name},{}", row.rsplit_once(',').expect("columns").0))
        .collect();
    fs::write(dir.path().join("lines.csv"), lines.join("\n") + "\n").expect("a table");
    let run = |args: &[&str]| {
        let output = bsm(dir.path(), args, "");
        assert_eq!(output.status.code(), Some(0), "{args:?}: {}", stderr(&output));
        (stdout(&output), stderr(&output))
    };
    let (text, _) = run(&["select", "--from", "lines.csv", "--json"]);
    let rows = json(&text);
    let row = rows.as_array().expect("rows").iter().find(|row| row["nut"] == "R40").expect("R40");
    let [low, high] = [0, 1].map(|end| number(&row["intervals"]["our_stiffness_N_um"][end]));
    assert!(low < number(&row["our_stiffness_N_um"]) && number(&row["our_stiffness_N_um"]) < high);
    let (shown, said) = run(&["select", "--from", "lines.csv", "-o", "list.csv"]);
    assert!(
        shown.contains(" to ") && said.contains("misprint: No typical groove"),
        "{shown}{said}"
    );
    // On the screen, too, the intervals of selected columns must be shown in the selected unit.
    let columns = ["--columns", "nut,our_stiffness_N_um,our_stiffness_kgf_um"];
    let (selected, _) = run(&[&["select", "--from", "lines.csv"][..], &columns].concat());
    let row = selected.lines().find(|line| line.contains("R40")).expect("R40");
    assert_eq!(row.matches(" to ").count(), 2, "{row}");
    let csv = fs::read_to_string(dir.path().join("list.csv")).expect("a table");
    assert!(csv.starts_with("nut,") && csv.contains(",our_stiffness_low_N_um,"), "{csv}");
    assert!(csv.contains("estimated together with the ball diameter of 6.35 mm"), "{csv}");
    let heavier = fs::read_to_string(dir.path().join("line.json")).expect("a case");
    fs::write(dir.path().join("other.json"), heavier.replace("51300", "48000")).expect("a case");
    let axis = ["axis", "line.json", "other.json", "--set", "stroke_mm=500", "--json"];
    let (text, _) = run(&[&axis[..], &SETTINGS].concat());
    let numbers = json(&text)["numbers"].as_array().expect("numbers").clone();
    let heat = numbers.iter().find(|row| row["number"] == "mean_heat_W").expect("the heat");
    for offer in ["first", "second"] {
        let interval = &heat[format!("{offer}_interval")];
        let value = number(&heat[offer]);
        assert!(number(&interval[0]) < value && value < number(&interval[1]), "{heat}");
    }
    // The table of rules must contain the bounds of the intervals.
    let rules = ["axis", "line.json", "--set", "stroke_mm=500", "-o", "rules.csv"];
    run(&[&rules[..], &SETTINGS].concat());
    let rules = fs::read_to_string(dir.path().join("rules.csv")).expect("rules");
    assert!(rules.starts_with("rule,symbol,value,low,high,unit,"), "{rules}");
}
