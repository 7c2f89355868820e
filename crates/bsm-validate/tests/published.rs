//! Every published check passes.

use bsm_validate::{Verdict, run};

#[test]
fn published_results_hold() {
    let report = run().expect("compiled-in data");
    for c in &report.checks {
        println!("{c:?}");
    }
    let failed: Vec<_> = report.checks.iter().filter(|c| c.verdict == Verdict::Fail).collect();
    assert!(failed.is_empty(), "{failed:#?}");
    // Every number is one: a search that found nothing would leave a NaN.
    assert!(report.checks.iter().all(|c| c.measured.is_finite()));
    assert!(report.count(Verdict::Pass) >= 20);
}
