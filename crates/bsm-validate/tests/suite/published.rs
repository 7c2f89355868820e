//! Tests that run all checks against published results.

use std::sync::LazyLock;

use bsm_validate::{PublishedData, Report, Verdict, figures, run, validation_page};

static REPORT: LazyLock<Report> =
    LazyLock::new(|| run(&PublishedData::default()).expect("compiled-in data"));

#[test]
fn results_agree_with_published_data_within_the_stated_limits() {
    let report = &*REPORT;
    for c in &report.checks {
        println!("{c:?}");
    }
    let failed: Vec<_> = report.checks.iter().filter(|c| c.verdict == Verdict::Fail).collect();
    assert!(failed.is_empty(), "{failed:#?}");
    // All results must be finite numbers, because a search that fails would return NaN.
    assert!(report.checks.iter().all(|c| c.measured.is_finite()));
    assert!(report.count(Verdict::Pass) >= 20);
}

#[test]
fn validation_page_contains_every_check_and_figure() {
    let published = PublishedData::default();
    let report = &*REPORT;
    let figures = figures(&published).expect("compiled-in data");
    let page = validation_page(report, &figures).expect("a page");
    assert_eq!(page.matches("<tr id=").count(), report.checks.len());
    assert_eq!(page.matches("<svg ").count(), figures.len());
    assert!(!page.contains("class=\"failed\""));
    for outside in ["<script", "<link", "src="] {
        assert!(!page.contains(outside), "{outside}: the page must stand alone");
    }
    // Each curve of each figure must have at least the expected number of points.
    for figure in &figures {
        for curve in &figure.curves {
            let there = curve.points.iter().filter(|(_, y)| y.is_finite()).count();
            // Three kinds of curves have few points: the load back-drives the screw only at a few
            // lead angles; the largest balls of Sobolewski (2002) fit only three of the leads in
            // the paper; and Eq 13 is a single point on the curve of Eq 11.
            let least = match (figure.key.as_str(), curve.label.as_deref()) {
                ("lin-efficiency-slip-angle", Some("slip angle of Eq 13")) => 1,
                // The curve of the folds has two points, one for each nut pair in X arrangement.
                ("feed-axis", Some("fold: no steady state above this speed")) => 2,
                (key, _) if key.starts_with("catalog-") => 3,
                _ => 5,
            };
            assert!(there >= least, "{}: {:?}", figure.key, curve.label);
        }
    }
}
