//! `bsm validate`: compares the program with published results.

use bsm_case::Content;
use bsm_report::format_number;
use bsm_validate::{PublishedData, Report, Verdict};

use crate::answer::{Pictures, Reply};
use crate::args::ValidateArgs;
use crate::failure::Failure;
use crate::files::InputFiles;
use crate::progress::show_spinner;
use crate::table;

pub(crate) fn run(args: &ValidateArgs) -> Result<(), Failure> {
    let published: Vec<_> = match &args.from {
        Some(folder) => PublishedData::FILES.iter().map(|file| folder.join(file)).collect(),
        None => Vec::new(),
    };
    let inputs = InputFiles::of(published.iter().map(|path| Some(path.as_path())));
    let to = args.out.check(&["json", "html"], inputs)?;
    let published = match &args.from {
        Some(folder) => PublishedData::read(folder)?,
        None => PublishedData::default(),
    };
    let line = show_spinner("calculating the published results");
    let report = bsm_validate::run(&published);
    drop(line);
    let mut report = report?;
    if let Some(key) = &args.only {
        report.checks.retain(|check| check.key.contains(key.as_str()));
        if report.checks.is_empty() {
            let text = format!(
                "--only {key}: no check has a key that contains this text; bsm validate prints all keys"
            );
            return Err(Failure::Input(text));
        }
    }
    let answer = report.answer().with_shown(Content::Text("", Some(describe(&report))));
    Reply::of(answer).deliver(&to, || {
        let figures = bsm_validate::figures(&published)?;
        let page = Some(bsm_validate::validation_page(&report, &figures)?);
        Ok(Pictures { figures, page, ..Pictures::default() })
    })
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
                check.claimed.map_or_else(String::new, format_number),
                format_number(check.measured),
                check.unit.clone(),
                check.note.clone(),
            ]
        })
        .collect();
    let header = ["", "check", "reference", "calculated", "unit", "where"];
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
