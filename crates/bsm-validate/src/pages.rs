//! HTML pages of the validation report and of the trade-off measurement.

use bsm_report::{Figure, Page};
use serde::Serialize;

use crate::tradeoff::Tradeoff;
use crate::{Check, Report, ValidateError, Verdict};

/// Data for the template of the validation page.
#[derive(Serialize)]
struct PageContent<'a> {
    passed: usize,
    failed: usize,
    findings: usize,
    checks: &'a [Check],
}

/// Returns the HTML page with all checks and figures.
///
/// # Errors
///
/// [`ValidateError::Report`] if the template is invalid.
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

/// Returns the HTML page with the measured speed and accuracy.
///
/// # Errors
///
/// [`ValidateError::Report`] if the template is invalid.
pub fn tradeoff_page(tradeoff: &Tradeoff) -> Result<String, ValidateError> {
    let page = Page {
        title: "Ball screw motion: speed against accuracy",
        command: "bsm tradeoff --figures DIR",
        template: include_str!("../templates/tradeoff.html"),
        figures: &tradeoff.figures(),
    };
    Ok(page.html(tradeoff)?)
}
