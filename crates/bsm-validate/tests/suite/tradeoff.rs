//! Tests of the measurement of speed and accuracy, and of the committed reference data.

use std::sync::LazyLock;

use bsm_batch::{CsvSource, TableFormat};
use bsm_case::{Output, Settings};
use bsm_dyn::{Model, ModelWorkspace, Status, solution::SlipRegime};
use bsm_validate::tradeoff::{self, Group, OneCore, Points, Tradeoff};
use bsm_validate::{ValidateError, tradeoff_page};

const GOLDEN: &str = include_str!("../../../../validation/golden/tradeoff/accuracy-1e-10.csv");

/// Solutions with an accuracy of 1e-10 must agree with the data in the repository. These data were
/// created by `bsm sweep --points validation/golden/tradeoff/cases.csv --model traction --accuracy
/// 1e-10 --creep 1e-5 --columns efficiency,... -o validation/golden/tradeoff/accuracy-1e-10.csv`.
#[test]
fn solutions_of_the_tradeoff_study_match_the_committed_data() {
    let points = Points::committed().expect("compiled-in table");
    let mut table = csv::Reader::from_reader(GOLDEN.as_bytes());
    let header = table.headers().expect("a header").clone();
    let outputs: Vec<_> = (0..header.len())
        .filter_map(|place| Some((place, Output::named(&header[place])?)))
        .collect();
    assert_eq!(outputs.len(), 7);
    let settings = Settings { accuracy: 1e-10, creep: 1e-5, ..Model::Traction.into() };
    let mut work = ModelWorkspace::default();
    let mut motions = Vec::new();
    for (case, row) in points.cases().iter().zip(table.records()) {
        let row = row.expect("a row");
        let solution = case.problem(&settings).expect("complete").solve(&mut work);
        assert_eq!(solution.status(), Status::Converged);
        motions.extend(solution.steady_state().and_then(|solved| solved.skid?.regime()));
        let record = bsm_case::Record::new(solution);
        for (place, output) in &outputs {
            let golden: f64 = row[*place].parse().expect("a number");
            let ours = record.number((*output).into()).expect("a number");
            // The tolerance allows for the residuals of 1e-10 at which the solver stops, and for
            // the different rounding errors of other processors.
            let off = (ours - golden).abs() / golden.abs();
            assert!(off < 1e-8, "{}: {ours} for {golden}", output.name);
        }
    }
    for motion in SlipRegime::ALL {
        assert_eq!(motions.iter().filter(|m| **m == motion).count(), 100, "{motion:?}");
    }
}

/// Results that were measured at ten points from the repository and at one point that no model can
/// solve.
static MEASURED: LazyLock<Tradeoff> = LazyLock::new(|| {
    let mut rows: Vec<&str> = GOLDEN.lines().step_by(30).collect();
    // At this point, a friction coefficient of 1 across steep grooves would move the ball off its
    // flanks.
    rows.push("40,8,30,85,1,0.53,0.53,0,100,100,1,,,,,,,,,,");
    let points = read(&rows.join("\n")).expect("points");
    let mut heard = (0, 0);
    let measured = tradeoff::run(&points, |done, all| heard = (done, all)).expect("a measurement");
    assert!(heard.0 > 0 && heard.0 == heard.1, "{heard:?}");
    measured
});

fn read(table: &str) -> Result<Points, ValidateError> {
    Points::read(&mut CsvSource::new(table.as_bytes(), &[], &TableFormat::default())?)
}

#[test]
fn tradeoff_study_reports_errors_and_times_of_every_setting() {
    let measured = &*MEASURED;
    assert_eq!(measured.without_reference, [11]);
    assert_eq!((measured.points[0].group, measured.points[0].points), (Group::All, 10));
    let of = |name: &str| {
        measured
            .settings
            .iter()
            .find(|r| r.setting.name() == name)
            .unwrap_or_else(|| panic!("{name}"))
    };
    for result in &measured.settings {
        let name = result.setting.name();
        assert!(result.times.all_cores > 0.0, "{name}");
        assert_eq!(result.times.one_core.len(), measured.points.len());
        for times in &result.times.one_core {
            assert!(times.single.median > 0.0 && times.row.median > 0.0, "{name}");
            assert!(times.batch > 0.0, "{name}");
            // The closed-form models solve no equations. All other models evaluate their equations
            // at least once per solver step.
            let steps = times.steps.map_or(0.0, |steps| steps.mean);
            assert!(steps <= times.evaluations.mean, "{name}: {times:?}");
            // At least half of the evaluations integrate friction over contact ellipses, each of
            // which has many quadrature nodes.
            if name.starts_with("traction") {
                assert!(times.nodes.mean > times.evaluations.mean, "{name}: {times:?}");
            }
            assert!(name != "rigid" || times.nodes.max == 0.0, "{name}: {times:?}");
            let OneCore { searches, searching, .. } = times;
            assert!((0.0..=1.0).contains(searching), "{name}: {times:?}");
            assert!(*searching <= searches.mean && searches.mean <= searches.max, "{name}");
        }
        for errors in &result.errors {
            for distribution in [errors.efficiency, errors.torque, errors.loads, errors.angles_deg]
            {
                let Some(q) = distribution else { continue };
                assert!(q.median <= q.q90 && q.q90 <= q.q99 && q.q99 <= q.max, "{name}: {q:?}");
                assert!(q.mean <= q.max, "{name}: {q:?}");
            }
        }
    }
    let max = |name: &str| of(name).errors[0].efficiency.expect("solved").max;
    // At this accuracy, the largest error is caused by the creep speed, which differs from the
    // creep speed of the reference.
    assert!(max("traction --accuracy 1e-10") < 1e-6);
    // A higher accuracy must not increase the error. The error stops decreasing when the effect of
    // the creep speed dominates.
    assert!(max("traction --accuracy 1e-8") <= max("traction --accuracy 1e-4"));
    // Models for rolling balls have errors of several percent if the balls slide, and models for
    // sliding balls have such errors if the balls roll.
    assert!(max("closed-form") > 1e-2 && max("raceway-control") > 1e-2);
    let single = |name: &str| of(name).times.of(Group::All).expect("timed").single.mean;
    assert!(single("closed-form") < single("traction --accuracy 1e-8"));
    assert!(!of("rigid").times.instruction_sets.is_empty());
    // At least one setting meets the largest tolerance, so settings must be recommended both for
    // points that are solved one by one and for tables.
    let advice = measured.advice.iter().find(|a| a.group == Group::All).expect("all points");
    assert!(advice.single.is_some() && advice.batch.is_some(), "{advice:?}");
}

#[test]
fn tradeoff_page_contains_every_setting_and_figure() {
    let measured = &*MEASURED;
    let page = tradeoff_page(measured).expect("a page");
    for result in &measured.settings {
        assert!(page.contains(&result.setting.options) && page.contains(result.setting.model));
    }
    assert_eq!(page.matches("<svg ").count(), measured.figures().len());
    for outside in ["<script", "<link", "src="] {
        assert!(!page.contains(outside), "{outside}: the page must stand alone");
    }
}

#[test]
fn tradeoff_study_rejects_tables_without_valid_points() {
    let error = read("lead_angle_deg\n").expect_err("no rows").to_string();
    assert!(error.starts_with("the table has no rows"), "{error}");
    let error = read("lead_angle_deg,contact_angle_deg\n10,45\n").expect_err("inputs are missing");
    let text = error.to_string();
    assert!(text.starts_with("row 1: ") && text.contains("nut_conformity"), "{text}");
    let error = read("lead_angle_deg\nten\n").expect_err("a text");
    assert!(error.to_string().contains("ten"), "{error}");
}
