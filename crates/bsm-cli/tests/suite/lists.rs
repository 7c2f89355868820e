//! Tests of the list options of `bsm select`, and of display units.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::program::{bsm, example, folder, json, stderr, stdout};

/// Runs the program, checks that it succeeds, and returns its standard output.
fn run(folder: &Path, args: &[&str]) -> String {
    let output = bsm(folder, args, "");
    assert_eq!(output.status.code(), Some(0), "{args:?}: {}", stderr(&output));
    stdout(&output)
}

/// Catalog lines with a stiffness, the load at which the stiffness is stated, and additional text
/// columns.
const LINES: &str = "nut,supplier,nominal_diameter_mm,lead_mm,rated_dynamic_load_N,rated_static_load_N,rated_rigidity_N_um,rated_rigidity_at
small,A,40,20,52000,88000,700,0.3 Ca
large,B,50,20,80000,150000,900,0.28 Ca
slow,C,40,10,60000,120000,800,0.3 Ca
";

/// Filters, sorting, column units and table formats must work for a manufacturer's table in the
/// same way as for standard sizes. Text columns must be kept, and the case of the first nut must
/// contain its order code.
#[test]
fn options_for_lists_apply_to_a_table_of_nuts() {
    let dir = folder();
    let path = dir.path();
    fs::write(path.join("lines.csv"), LINES).expect("a table");
    let requirement =
        r#"{"axial_load_N": 3000, "feed_m_min": 10, "stroke_mm": 500, "required_life_h": 1000}"#;
    fs::write(path.join("need.json"), requirement).expect("a requirement");
    let base = ["select", "need.json", "--from", "lines.csv"];
    let with = |more: &[&str]| run(path, &[&base[..], more].concat());
    let list = with(&[
        "--where",
        "lead_in>=0.7",
        "--sort",
        "-cycle_life_h",
        "--columns",
        "nut,lead_in,supplier,cycle_life_h",
        "-o",
        "list.csv",
        "-o",
        "list.xlsx",
        "-o",
        "list.jsonl",
        "-o",
        "list.parquet",
        "-o",
        "nut.json",
    ]);
    let heads: Vec<_> = list.lines().next().expect("heads").split_whitespace().collect();
    assert_eq!(heads, ["nut", "lead_in", "supplier", "cycle_life_h"]);
    let csv = fs::read_to_string(path.join("list.csv")).expect("a table");
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some("nut,lead_in,supplier,cycle_life_h"));
    let cells: Vec<_> = lines.map(|line| line.split(',').take(3).collect::<Vec<_>>()).collect();
    assert_eq!(cells.len(), 2, "{csv}");
    assert_eq!([cells[0][0], cells[0][2], cells[1][0]], ["large", "B", "small"]);
    let lead: f64 = cells[0][1].parse().expect("a number");
    // The conversion to inches is a single division, so only a rounding error is permitted.
    assert!((lead - 20.0 / 25.4).abs() < 1e-12, "{lead}");
    for name in ["list.xlsx", "list.jsonl", "list.parquet"] {
        assert!(fs::metadata(path.join(name)).expect("a file").len() > 50, "{name}");
    }
    let case = json(&fs::read_to_string(path.join("nut.json")).expect("a case"));
    assert_eq!(
        (&case["order_code"], &case["rated_rigidity_at"]),
        (&Value::from("large"), &Value::from("0.28 Ca"))
    );
    // The stiffness stated in the catalog must be used.
    let rows = json(&with(&["--first", "1", "--sort", "lead_mm", "--json"]));
    let row = &rows.as_array().expect("rows")[0];
    assert_eq!((&row["nut"], &row["texts"]["supplier"]), (&Value::from("slow"), &Value::from("C")));
    let front = json(&with(&["--pareto", "--json"]));
    assert!((1..=3).contains(&front.as_array().expect("rows").len()));
    let none = bsm(path, &[&base[..], &["--where", "lead_mm>=30"]].concat(), "");
    assert_eq!(none.status.code(), Some(3));
    assert!(
        stdout(&none).contains("lead_mm>=30: the nearest of 3 nuts has 20"),
        "{}",
        stdout(&none)
    );
    let misspelled = bsm(path, &[&base[..], &["--columns", "lead_mn"]].concat(), "");
    assert_eq!(misspelled.status.code(), Some(2));
    assert!(stderr(&misspelled).contains("lead_mm"), "{}", stderr(&misspelled));
}

/// Rows whose ratings contradict their geometry must be named. In this table, one ball is too large
/// for the lead, and in one row, the ratio of calculated to stated rating is far from the median of
/// the table.
#[test]
fn table_rows_whose_ratings_or_balls_contradict_their_geometry_are_reported() {
    let dir = folder();
    let path = dir.path();
    let table = fs::read_to_string(example("manufacturer_table.csv")).expect("a table");
    let mut lines: Vec<String> = table.lines().map(str::to_owned).collect();
    let heads: Vec<_> = lines[0].split(',').collect();
    let place = |name: &str| heads.iter().position(|head| *head == name).expect("a column");
    let (rating, lead) = (place("dynamic_load_rating_N"), place("lead_mm"));
    let change = |line: &str, column: usize, cell: &str| {
        let mut cells: Vec<_> = line.split(',').collect();
        cells[0] = "changed";
        cells[column] = cell;
        cells.join(",")
    };
    let stated: f64 = lines[1].split(',').nth(rating).expect("a cell").parse().expect("a number");
    let misprint =
        change(&lines[1], rating, &(1.5 * stated).to_string()).replace("changed", "misprint");
    let crowded = change(&lines[1], lead, "3.5").replace("changed", "crowded");
    lines.extend([misprint, crowded]);
    fs::write(path.join("table.csv"), lines.join("\n")).expect("a table");
    let output = bsm(path, &["select", "--from", "table.csv"], "");
    let said = stderr(&output);
    let named: Vec<_> = said.lines().filter(|line| line.contains("warning")).collect();
    assert_eq!(named.len(), 2, "{said}");
    assert!(
        said.contains("misprint: the ratio of calculated to stated dynamic load rating is"),
        "{said}"
    );
    assert!(
        said.contains("crowded: ball_diameter_mm 3.175 is more than 0.8 times lead_mm 3.5"),
        "{said}"
    );
}

/// If inch units are selected, labels and numbers on the screen, on the sheet, in rules and in
/// columns must be converted, but JSON must keep metric units.
#[test]
fn answers_are_displayed_in_inch_units() {
    let dir = folder();
    let path = dir.path();
    let case = example("rated.json");
    let more = ["--set", "moved_mass_kg=100"];
    let axis = |more: &[&str]| run(path, &[&["axis", &case][..], more].concat());
    let metric = json(&axis(&[&more[..], &["--json"]].concat()));
    let same = json(&axis(&[&more[..], &["--units", "inch", "--json"]].concat()));
    assert_eq!(metric["results"], same["results"]);
    let shown =
        axis(&[&more[..], &["--units", "inch", "-o", "sheet.html", "-o", "rules.csv"]].concat());
    let line = |label: &str| {
        let found = shown
            .lines()
            .find(|line| line.contains(label))
            .unwrap_or_else(|| panic!("{label}: {shown}"));
        found.split_whitespace().map(str::to_owned).collect::<Vec<_>>()
    };
    let largest = line("largest axial load on the screw");
    assert!(largest.contains(&"lbf".to_owned()), "{largest:?}");
    let value: f64 = largest.last().expect("a number").parse().expect("a number");
    let newtons = metric["results"]["largest_load_N"].as_f64().expect("a load");
    // The tolerance allows for the rounding of printed numbers to five digits.
    assert!((value * 4.448_221_615 / newtons - 1.0).abs() < 1e-4, "{value} {newtons}");
    assert!(shown.contains("peak motor torque") && !shown.contains("  N m  "), "{shown}");
    let sheet = fs::read_to_string(path.join("sheet.html")).expect("a sheet");
    assert!(sheet.contains("lbf") && sheet.contains("axial load, klbf"), "{sheet}");
    assert!(!sheet.contains("axial load, kN"));
    let rules = fs::read_to_string(path.join("rules.csv")).expect("rules");
    assert!(rules.contains(",lbf,") && !rules.contains(",N,"), "{rules}");
    // Converting a temperature to °F adds an offset, but converting a temperature rise does not.
    let rise = line("steady-state temperature rise of the screw above the surroundings");
    assert!(rise.contains(&"degF".to_owned()), "{rise:?}");
    // The input `display_units` of a case has the same effect as the option `--units`.
    let set = axis(&[&more[..], &["--set", "display_units=inch"]].concat());
    assert_eq!(set, axis(&[&more[..], &["--units", "inch"]].concat()));
    let nut = example("nut.json");
    run(path, &["nut", &nut, "--units", "inch", "-o", "balls.csv"]);
    let balls = fs::read_to_string(path.join("balls.csv")).expect("a table");
    assert!(balls.lines().next().expect("heads").contains("_lbf"), "{balls}");
    let list = run(path, &["select", "--units", "inch", "--first", "1", "-o", "nuts.csv"]);
    assert!(list.contains("lead_in") && list.contains("dynamic_load_rating_lbf"), "{list}");
}

/// The sheet must contain everything that an order requires: the manufacturer, the order code, the
/// process force of each phase, and fields for signatures.
#[test]
fn axis_sheet_contains_ordering_data_and_process_forces_and_signature_fields() {
    let dir = folder();
    let cycle = r#"cycle=[{"time_s": 1, "feed_m_min": 6, "force_N": 1234, "end_force_N": 2345}, {"time_s": 1, "feed_m_min": -6}]"#;
    let case = example("axis.json");
    run(
        dir.path(),
        &[
            "axis",
            &case,
            "--set",
            cycle,
            "--set",
            "manufacturer=THK",
            "--set",
            "order_code=BNFN 5010",
            "-o",
            "sheet.html",
        ],
    );
    let sheet = fs::read_to_string(dir.path().join("sheet.html")).expect("a sheet");
    for words in [
        "process force, N",
        "1234 to 2345",
        "BNFN 5010",
        "THK",
        "signature",
        "2 nuts x 6 turns",
        "\u{b5}m",
    ] {
        assert!(sheet.contains(words), "{words}");
    }
    // The value of an order entry must not repeat the title of the entry.
    assert!(!sheet.contains(">thread 1"), "{sheet}");
}

/// For a table of nuts, the program must draw figures of the ratings in display units.
#[test]
fn figures_are_written_for_a_table_of_nuts() {
    let dir = folder();
    let path = dir.path();
    let table = "nut,nominal_diameter_mm,lead_mm,dynamic_load_rating_N,static_load_rating_N\n\
                 a,16,5,13533,29930\nb,40,20,51300,144400\nc,50,20,80000,250000\n";
    fs::write(path.join("table.csv"), table).expect("a table");
    run(path, &["select", "--from", "table.csv", "--figures", "metric"]);
    let read = |folder: &str, name: &str| {
        fs::read_to_string(path.join(folder).join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    };
    let rating = read("metric", "nuts-dynamic-rating.csv");
    assert!(rating.contains("nominal diameter, mm") && rating.contains("13.533"), "{rating}");
    assert!(rating.contains("lead 20 mm"), "{rating}");
    run(path, &["select", "--from", "table.csv", "--units", "inch", "--figures", "inch"]);
    let rating = read("inch", "nuts-dynamic-rating.csv");
    assert!(rating.contains("nominal diameter, in") && rating.contains("rating, klbf"), "{rating}");
    // Only the nuts that meet the conditions must be drawn.
    run(path, &["select", "--from", "table.csv", "--where", "lead_mm>=20", "--figures", "some"]);
    assert!(!read("some", "nuts-dynamic-rating.csv").contains("13.533"));
}
