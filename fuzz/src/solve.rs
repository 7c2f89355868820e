//! Solves a case with every model and every analysis.

use bsm_case::{
    Case, Fit, ModelChoice, OUTPUTS, Record, Sensitivities, Settings, jam, optimum, ratings, slip,
};
use bsm_dyn::{Model, ModelWorkspace, Status};

/// Base cases, to which fuzzed input settings are applied.
pub(crate) const BASES: [(&str, &str); 5] = [
    ("feed_drive", include_str!("../../examples/feed_drive.json")),
    ("lin1994", include_str!("../../examples/lin1994.json")),
    ("dong2020", include_str!("../../examples/dong2020.json")),
    ("nut", include_str!("../../examples/nut.json")),
    ("back_driving", include_str!("../../examples/back_driving.json")),
];

/// Runs every calculation that is possible for a case.
pub(crate) fn everything(case: &Case) {
    let _ = case.warnings();
    let work = &mut ModelWorkspace::default();
    for name in ModelChoice::names() {
        let model = ModelChoice::from_name(name).expect("one of the names");
        let settings = Settings { model, ..Settings::default() };
        let Ok(problem) = case.problem(&settings) else { continue };
        let solution = problem.solve(work);
        let record = Record::new(solution.clone());
        let _ = (record.to_json(), record.regime(), record.warnings(case));
        if record.status() != Status::Converged {
            assert!(record.message().is_some(), "{name} states no reason: {case:?}");
            continue;
        }
        for output in OUTPUTS {
            let Some(number) = record.value(output) else { continue };
            assert!(number.is_finite(), "{name}: {} is {number} for {case:?}", output.name);
        }
        let _ = Sensitivities::of(case, &settings).map(|inputs| inputs.solve(work));
        for analysis in [slip(case, &settings, &solution), jam(case, &solution)] {
            let _ = analysis.map(|analysis| analysis.to_json());
        }
    }
    let _ = ratings(case).map(|answer| answer.to_json().to_string());
    for model in [None, Some(Model::RacewayControl)] {
        let _ = optimum(case, model).map(|answer| answer.to_json().to_string());
    }
    for (input, measured) in
        [("friction_coefficient", "screw_torque_Nm=26"), ("axial_load_N", "efficiency=0.9")]
    {
        if let Ok(fit) = Fit::parse(case, input, measured) {
            let report = fit.run(case, &Model::RacewayControl.into());
            let _ = report.map(|report| fit.answer(case, &report).to_json().to_string());
        }
    }
}
