//! HTML pages that show the validation report and the measurement of speed and accuracy.

use bsm_report::{Figure, Page};
use serde::Serialize;

use crate::tradeoff::Tradeoff;
use crate::{Check, Report, ValidateError, Verdict};

/// Data that the template of the validation page displays.
#[derive(Serialize)]
struct PageContent<'a> {
    passed: usize,
    failed: usize,
    findings: usize,
    checks: &'a [Check],
}

/// Returns the HTML page that shows all checks and figures.
///
/// # Errors
///
/// Returns [`ValidateError::Report`] if the template is invalid.
pub fn validation_page(report: &Report, figures: &[Figure]) -> Result<String, ValidateError> {
    let page = Page {
        title: "Ball screw motion: checks against published results",
        command: "bsm validate --figures DIR",
        template: include_str!("../templates/validation.html"),
        figures,
    };
    Ok(page.html(&PageContent {
        passed: report.count(Verdict::Pass),
        failed: report.count(Verdict::Fail),
        findings: report.count(Verdict::Finding),
        checks: &report.checks,
    })?)
}

/// Returns the HTML page that shows the measured speed and accuracy.
///
/// # Errors
///
/// Returns [`ValidateError::Report`] if the template is invalid.
pub fn tradeoff_page(tradeoff: &Tradeoff) -> Result<String, ValidateError> {
    let page = Page {
        title: "Ball screw motion: speed against accuracy",
        command: "bsm tradeoff --figures DIR",
        template: include_str!("../templates/tradeoff.html"),
        figures: &tradeoff.figures(),
    };
    Ok(page.html(tradeoff)?)
}
