//! A table row must give the same result as `bsm solve --set` for the same point.

use std::path::Path;

use crate::program::{bsm, folder, stderr, stdout};

/// Regression test: row 1 of a table was solved with the lead of the base case instead of the lead
/// in the row. The test runs the command that revealed this error.
#[test]
fn rows_with_empty_lead_cells_match_single_solves() {
    let dir = folder();
    let drive = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/feed_drive.json");
    let drive = drive.display().to_string();
    for model in ["raceway-control", "rigid", "closed-form", "quasi-static", "auto"] {
        let common = ["--model", model];
        let batch = [
            "sweep",
            &drive,
            "--points",
            "-",
            "-o",
            "-",
            "--columns",
            "efficiency",
            "--keep-going",
        ];
        let table = "lead_angle_deg,lead_mm\n6,\n,10\n6,10\n";
        let output = bsm(dir.path(), &[&batch[..], &common].concat(), table);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let text = stdout(&output);
        let rows = csv::Reader::from_reader(text.as_bytes()).into_records();
        let rows: Vec<_> = rows.collect::<Result<_, _>>().expect("CSV");
        for (row, setting) in rows.iter().zip(["lead_angle_deg=6", "lead_mm=10"]) {
            let solve = ["solve", &drive, "--json", "--set", setting];
            let single = stdout(&bsm(dir.path(), &[&solve[..], &common].concat(), ""));
            let single: serde_json::Value = serde_json::from_str(&single).expect("JSON");
            let known = single["efficiency"].as_f64();
            // The rounding errors of a batch kernel differ from the rounding errors of the model.
            let same = match (row[5].parse::<f64>(), known) {
                (Ok(found), Some(known)) => (found - known).abs() <= 1e-10 * known.abs(),
                (found, known) => found.is_err() && known.is_none(),
            };
            assert!(same && single["status"] == row[3], "{model}, {setting}: {text} {single}");
        }
        assert_eq!(&rows[2][3], "invalid_input", "{text}");
        assert!(rows[2][4].contains("lead_angle_deg = 6 and lead_mm = 10 disagree"), "{text}");
        let both = ["solve", &drive, "--set", "lead_angle_deg=6", "--set", "lead_mm=10"];
        let refused = bsm(dir.path(), &[&both[..], &common].concat(), "");
        assert_eq!(refused.status.code(), Some(2), "{}", stderr(&refused));
        assert!(stderr(&refused).contains(&rows[2][4]), "{}", stderr(&refused));
    }
}
