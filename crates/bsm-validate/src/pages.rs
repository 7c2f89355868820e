//! The pages of the checks and of the measurement.

use bsm_case::exact;
use bsm_report::{Figure, Page, ReportError};
use serde::Serialize;
use serde_json::Value;

use crate::tradeoff::Tradeoff;
use crate::{Check, Report, ValidateError, Verdict};

/// What the page of the checks shows.
#[derive(Serialize)]
struct Shown<'a> {
    passed: usize,
    failed: usize,
    findings: usize,
    checks: &'a [Check],
}

/// The files of a report, by their paths in its folder: page, numbers, and each figure as SVG and as a table.
///
/// # Errors
///
/// [`ReportError`] if a table of a figure cannot be written.
pub fn report_files(
    page: String,
    results: &Value,
    figures: &[Figure],
) -> Result<Vec<(String, String)>, ReportError> {
    let mut files = Vec::new();
    for figure in figures {
        files.push((format!("figures/{}.svg", figure.key), figure.svg()));
        files.push((format!("figures/{}.csv", figure.key), figure.csv(exact)?));
    }
    files.push(("results.json".to_owned(), format!("{results:#}\n")));
    files.push(("report.html".to_owned(), page));
    Ok(files)
}

/// Page of the checks and their figures.
///
/// # Errors
///
/// [`ValidateError::Report`] if a template is wrong.
pub fn validation_page(report: &Report, figures: &[Figure]) -> Result<String, ValidateError> {
    let page = Page {
        title: "Ball screw motion: checks against published results",
        command: "bsm validate --figures DIR",
        template: include_str!("../templates/validation.html"),
        figures,
    };
    Ok(page.html(&Shown {
        passed: report.count(Verdict::Pass),
        failed: report.count(Verdict::Fail),
        findings: report.count(Verdict::Finding),
        checks: &report.checks,
    })?)
}

/// Page of the measurement of speed against accuracy.
///
/// # Errors
///
/// [`ValidateError::Report`] if a template is wrong.
pub fn tradeoff_page(tradeoff: &Tradeoff) -> Result<String, ValidateError> {
    let page = Page {
        title: "Ball screw motion: speed against accuracy",
        command: "bsm tradeoff --figures DIR",
        template: include_str!("../templates/tradeoff.html"),
        figures: &tradeoff.figures(),
    };
    Ok(page.html(tradeoff)?)
}
