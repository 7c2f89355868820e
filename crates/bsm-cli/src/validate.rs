//! `bsm validate`: published results against ours.

use bsm_report::number;
use bsm_validate::{Published, Report, Verdict};

use crate::args::{Format, ValidateArgs};
use crate::failure::Failure;
use crate::files::{pretty_json, print, write_report};
use crate::table;

pub(crate) fn run(args: &ValidateArgs) -> Result<(), Failure> {
    let published = match &args.data {
        Some(folder) => Published::read(folder)?,
        None => Published::default(),
    };
    let report = bsm_validate::run(&published)?;
    let results = report.to_json();
    if let Some(folder) = &args.out {
        let figures = bsm_validate::figures(&published)?;
        let page = bsm_validate::validation_page(&report, &figures)?;
        write_report(folder, page, &results, &figures)?;
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
                check.claimed.map_or_else(String::new, number),
                number(check.measured),
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
        "{}{}\n\n{} passed, {} failed, {} findings (no reference value, or a published trend that does not hold)",
        table::plain(Some(&header), &rows, usize::MAX),
        failures.concat(),
        report.count(Verdict::Pass),
        report.count(Verdict::Fail),
        report.count(Verdict::Finding),
    )
}
