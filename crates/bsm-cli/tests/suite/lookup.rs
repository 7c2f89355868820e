//! Tests of lookup tables for drive models.

use std::fs;
use std::path::Path;

use crate::program::{bsm, folder, stderr, stdout};

/// Runs a sweep of an example case in `folder` and returns the exit code and standard error.
fn sweep(folder: &Path, case: &str, options: &[&str]) -> (Option<i32>, String) {
    let case = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(case);
    let case = case.display().to_string();
    let output = bsm(folder, &[&["sweep", &case][..], options].concat(), "");
    (output.status.code(), stdout(&output) + &stderr(&output))
}

const SPEED: [&str; 2] = ["--vary", "screw_speed_rpm=500:1500:3"];
const LOAD: [&str; 2] = ["--vary", "axial_load_N=2000,8000"];

fn matrix(lines: &[&str], between: char) -> Vec<Vec<f64>> {
    let row =
        |line: &&str| line.split(between).map(|cell| cell.parse().expect("a number")).collect();
    lines.iter().map(row).collect()
}

/// The lookup table must contain the same numbers as the ordinary table. Its rows must correspond
/// to the first varied input and its columns to the second varied input.
#[test]
fn values_in_a_lookup_table_match_the_ordinary_table() {
    let dir = folder();
    // A model is selected because `auto` would write a message into each row, and messages may
    // contain commas.
    let columns = ["--columns", "efficiency,ball_torque_Nm", "--model", "raceway-control"];
    for out in ["map.txt", "map.csv"] {
        let options = [&SPEED[..], &LOAD, &columns, &["-o", out]].concat();
        assert_eq!(sweep(dir.path(), "feed_drive.json", &options), (Some(0), String::new()));
    }
    let one =
        ["--columns", "efficiency", "--model", "raceway-control", "-o", "efficiency.grid.csv"];
    let options = [&SPEED[..], &LOAD, &one].concat();
    assert_eq!(sweep(dir.path(), "feed_drive.json", &options).0, Some(0));

    let read = |name: &str| fs::read_to_string(dir.path().join(name)).expect("written");
    let long = read("map.csv");
    let long: Vec<Vec<&str>> = long.lines().skip(1).map(|row| row.split(',').collect()).collect();
    let text = read("map.txt");
    let lines: Vec<_> = text.lines().collect();
    assert_eq!(lines[0], "#1");
    for (table, column) in [("efficiency", 5), ("ball_torque_Nm", 6)] {
        let head = format!("double {table}(4,3)");
        let first = lines.iter().position(|line| *line == head).expect("a table") + 1;
        let found = matrix(&lines[first..first + 4], ' ');
        assert_eq!(found[0], [0.0, 2000.0, 8000.0]);
        for (row, cells) in long.iter().enumerate() {
            let (down, right) = (row / 2 + 1, row % 2 + 1);
            assert_eq!(found[down][0].to_string(), cells[0]);
            assert_eq!(found[down][right].to_string(), cells[column]);
        }
    }
    let grid = read("efficiency.grid.csv");
    let first =
        lines.iter().position(|line| *line == "double efficiency(4,3)").expect("a table") + 1;
    let lines: Vec<_> = lines[first..first + 4].iter().map(|line| line.replace(' ', ",")).collect();
    assert_eq!(grid.lines().collect::<Vec<_>>(), lines);
}

/// With one varied input, a single table must contain all outputs.
#[test]
fn lookup_table_of_one_varied_input_contains_all_outputs() {
    let dir = folder();
    let options =
        [&SPEED[..], &["--columns", "efficiency,ball_torque_Nm", "-o", "map.txt"]].concat();
    assert_eq!(sweep(dir.path(), "feed_drive.json", &options), (Some(0), String::new()));
    let text = fs::read_to_string(dir.path().join("map.txt")).expect("written");
    let lines: Vec<_> = text.lines().collect();
    assert_eq!(lines[1], "# screw_speed_rpm [rpm]: efficiency, ball_torque_Nm [N m]");
    assert_eq!(lines[2], "double map(3,3)");
    let rows = matrix(&lines[3..], ' ');
    assert_eq!(rows.iter().map(|row| row[0]).collect::<Vec<_>>(), [500.0, 1000.0, 1500.0]);
    assert!(rows.iter().all(|row| (0.9..1.0).contains(&row[1])), "{rows:?}");
}

/// A lookup table with gaps must not be written, because a drive model could not use it.
#[test]
fn lookup_table_with_missing_values_is_rejected() {
    let dir = folder();
    let refused = |options: &[&str], code: i32, words: &str| {
        let (found, told) = sweep(dir.path(), "feed_drive.json", options);
        assert!(found == Some(code) && told.contains(words), "{found:?}: {told}");
        assert_eq!(fs::read_dir(dir.path()).expect("the folder").count(), 0, "{options:?}");
    };
    let out = ["--columns", "efficiency", "-o", "map.txt"];
    let falls = ["--vary", "axial_load_N=8000,2000"];
    refused(&[&SPEED[..], &falls, &out].concat(), 2, "axial_load_N must increase");
    let third = ["--vary", "lead_mm=10,20"];
    refused(&[&SPEED[..], &LOAD, &third, &out].concat(), 2, "one or two varied inputs");
    let grid = ["-o", "map.grid.csv"];
    refused(&[&SPEED[..], &LOAD, &grid].concat(), 2, "two varied inputs and one output");
    let all = ["-o", "map.txt", "--model", "rigid"];
    refused(&[&SPEED[..], &LOAD, &all].concat(), 2, "model rigid has no");
    let steep = ["--vary", "friction_coefficient=0.1,2", "--model", "rigid", "--set", "lead_mm=2"];
    refused(&[&steep[..], &out].concat(), 3, "have no result");
}
