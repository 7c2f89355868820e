//! `bsm validate`: published results against ours.

use std::fs;

use bsm_validate::{Report, Verdict};
use serde_json::json;

use crate::args::{Format, ValidateArgs};
use crate::failure::{Failure, warn};
use crate::files::{self, pretty_json, print};
use crate::table;

pub(crate) fn run(args: &ValidateArgs) -> Result<(), Failure> {
    let report = bsm_validate::run().map_err(|e| Failure::Files(e.to_string()))?;
    let results = json!({
        "program": concat!("bsm ", env!("CARGO_PKG_VERSION")),
        "passed": report.passed(),
        "checks": report.checks,
    });
    if let Some(folder) = &args.out {
        fs::create_dir_all(folder).map_err(|e| Failure::files("make folder", folder, &e))?;
        let path = folder.join("results.json");
        files::write(&path, &(pretty_json(&results) + "\n"))?;
        warn("note", &format!("wrote {}", path.display()));
    }
    match args.format {
        Format::Json => print(&pretty_json(&results))?,
        Format::Table => print(&describe(&report))?,
    }
    if report.passed() { Ok(()) } else { Err(Failure::Unsolved) }
}

fn describe(report: &Report) -> String {
    let rows: Vec<_> = report
        .checks
        .iter()
        .map(|check| {
            let verdict = match check.verdict {
                Verdict::Pass => "pass",
                Verdict::Fail => "FAIL",
                Verdict::Finding => "-",
            };
            vec![
                verdict.to_owned(),
                check.key.clone(),
                check.claimed.map_or_else(String::new, table::number),
                table::number(check.measured),
                check.unit.clone(),
                check.note.clone(),
            ]
        })
        .collect();
    let header = ["", "check", "claimed", "measured", "unit", "where"];
    let failed = report.checks.iter().filter(|c| c.verdict == Verdict::Fail);
    let failures: Vec<_> = failed
        .map(|c| {
            format!(
                "\n\nFAIL {}: {}\n  {} {} must be {}\n  source: {}",
                c.key, c.claim, c.measured, c.unit, c.criterion, c.source
            )
        })
        .collect();
    format!(
        "{}{}\n\n{} passed, {} failed, {} findings without a claim to hold against",
        table::plain(Some(&header), &rows, usize::MAX),
        failures.concat(),
        report.count(Verdict::Pass),
        report.count(Verdict::Fail),
        report.count(Verdict::Finding),
    )
}
