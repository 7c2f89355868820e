//! Analyses of a motion: published trends are in `bsm validate`, here what must hold for all.

use bsm_case::{
    Analysis, AnalysisKind, CaseError, INPUTS, ModelChoice, Moving, OUTPUTS, Of, Output, Record,
    Scene, Settings,
};
use bsm_dyn::{Model, ModelWorkspace, Solution};

const XU: &[u8] = include_bytes!("../../../examples/xu2015.json");
const DONG: &[u8] = include_bytes!("../../../examples/dong2020.json");

fn scene(json: &[u8], changes: &[(&str, f64)]) -> Scene {
    let mut scene = Scene::from_json(json).expect("an example");
    for (name, value) in changes {
        scene.set(name, *value).expect("known name");
    }
    scene
}

fn solved(scene: &Scene, settings: &Settings) -> Solution {
    let problem = scene.problem(settings).expect("complete");
    let solution = problem.solve(&mut ModelWorkspace::default());
    assert!(solution.reason().is_none(), "{:?}", solution.reason());
    solution
}

fn slip(scene: &Scene, model: Model) -> Analysis {
    let settings = model.into();
    Analysis::slip(scene, &settings, &solved(scene, &settings)).expect("a motion")
}

fn jam(scene: &Scene, model: Model) -> Analysis {
    Analysis::jam(scene, &solved(scene, &model.into())).expect("a motion")
}

fn number(report: &Analysis, name: &str) -> f64 {
    report.number(name).unwrap_or_else(|| panic!("{name}: {report:?}"))
}

/// Slip and spin of the report are the outputs of the model, whichever drives.
#[test]
fn slip_is_what_the_model_says() {
    for (screw, nut) in [(5000.0, 0.0), (-3000.0, 0.0), (0.0, 1500.0), (2500.0, -1700.0)] {
        let scene = scene(XU, &[("screw_speed_rpm", screw), ("nut_speed_rpm", nut)]);
        for model in [Model::RacewayControl, Model::Traction] {
            let o = solved(&scene, &model.into()).answer.expect("a solution").ball;
            let report = slip(&scene, model);
            for (name, value) in [
                ("nut_differential_slip_m_s", o.nut.slip.map(|slip| slip.speed)),
                ("screw_differential_slip_m_s", o.screw.slip.map(|slip| slip.speed)),
                ("nut_spin_rad_s", o.nut.slip.map(|slip| slip.spin)),
                ("screw_spin_rad_s", o.screw.slip.map(|slip| slip.spin)),
            ] {
                let expected = value.expect("elastic model");
                // Rounding of speeds of 10 m/s and of rates of 3000 rad/s.
                let scale = expected.abs().max(1.0);
                assert!((number(&report, name) - expected).abs() <= 1e-10 * scale, "{name}");
            }
            assert!(number(&report, "power_difference").abs() < 1e-9);
        }
    }
}

/// The power adds up with the quadrature and the creep speed that the model was given, and with
/// the order that `auto` has found.
#[test]
fn powers_add_up_with_the_dials() {
    let scene = scene(XU, &[("screw_speed_rpm", 12000.0)]);
    let order = std::num::NonZeroUsize::new(5).expect("positive");
    let coarse = Settings { quadrature: order, creep: 1e-2, ..Model::Traction.into() };
    let fine = Settings { tolerance: 1e-5, ..Settings::default() };
    for settings in [coarse, fine] {
        let solution = solved(&scene, &settings);
        assert_eq!(solution.model, Model::Traction);
        let report = Analysis::slip(&scene, &settings, &solution).expect("a motion");
        assert!(number(&report, "power_difference").abs() < 1e-9);
        assert!(report.warnings.iter().all(|w| !w.contains("add up")), "{:?}", report.warnings);
    }
}

/// The rigid model has three contacts and no ellipses: said, not filled in.
#[test]
fn rigid_has_no_ellipses() {
    let mut scene = scene(XU, &[("lead_mm", 40.0)]);
    (scene.nut_conformity, scene.screw_conformity) = (None, None);
    let report = slip(&scene, Model::Rigid);
    assert!(report.number("minor_differential_slip_m_s").is_some());
    assert!(report.number("nut_spin_slip_m_s").is_none());
    assert!(report.lacks[0].contains("nut_conformity"), "{:?}", report.lacks);
    let report = jam(&scene, Model::Rigid);
    assert!(report.lacks.iter().any(|l| l.contains("contact state")), "{:?}", report.lacks);
    assert!(number(&report, "wedge_angle_deg").abs() < 1e-15);
    assert!(report.number("locking_ratio").is_none());
}

/// A part of the jamming report that lacks an input names it, and the other parts stay.
#[test]
fn what_jamming_lacks_is_named() {
    let names = [
        "race_yield_strength_MPa",
        "drag_coefficient",
        "apex_half_angle_deg",
        "return_angle_deg",
        "loaded_balls_per_turn",
    ];
    let full = jam(&scene(DONG, &[]), Model::RacewayControl);
    assert!(full.lacks.is_empty());
    let text = String::from_utf8(DONG.to_vec()).expect("UTF-8");
    for name in names {
        let without: Vec<_> = text.lines().filter(|line| !line.contains(name)).collect();
        let json = without.join("\n").replace(",\n}", "\n}");
        let report = jam(&scene(json.as_bytes(), &[]), Model::RacewayControl);
        assert_eq!(report.lacks.len(), 1, "{name}: {:?}", report.lacks);
        assert!(report.lacks[0].ends_with(&format!(": {name}")), "{:?}", report.lacks);
        assert!(report.number("wedge_angle_deg").is_some());
    }
}

/// The margin turns the verdict; a ball that rolls has no friction along the track, and that is
/// said.
#[test]
fn jamming_has_three_answers() {
    let verdict = |model, changes: &[(&str, f64)]| {
        let report = jam(&scene(DONG, changes), model);
        let (_, jams, words) = report.statements().find(|v| v.0 == "jams").expect("a verdict");
        (jams, words.to_owned(), report.warnings.clone())
    };
    let (jams, words, _) = verdict(Model::Elastic, &[]);
    assert!(!jams, "{words}");
    let (jams, words, _) = verdict(Model::Elastic, &[("step_normal_force_N", 1e5)]);
    assert!(jams && words.contains("more than all friction"), "{words}");
    let (jams, words, warnings) = verdict(Model::RacewayControl, &[]);
    assert!(jams && words.contains("published criterion"), "{words}");
    assert!(warnings.iter().any(|w| w.contains("roll")), "{warnings:?}");
}

/// Thrust of an impact follows what is given of it.
#[test]
fn inputs_of_the_returner_are_used() {
    let thrust = |changes: &[(&str, f64)]| {
        let report = jam(&scene(DONG, changes), Model::RacewayControl);
        number(&report, "step_thrust_N")
    };
    let base = thrust(&[("step_normal_force_N", 10.0)]);
    // 2 F_N / ((μ + 1/μ) cos 30°), by hand.
    assert!((base - 20.0 / (10.1 * 30.0_f64.to_radians().cos())).abs() < 1e-12);
    let speed = [("return_approach_speed_m_s", 1.0), ("return_stiffness_N_um15", 1.0)];
    let double = [("return_approach_speed_m_s", 2.0), ("return_stiffness_N_um15", 1.0)];
    // F ~ v^{6/5} K^{2/5}.
    let ratio = thrust(&double) / thrust(&speed);
    assert!((ratio - 2.0_f64.powf(1.2)).abs() < 1e-12, "{ratio}");
    let stiff = [("return_approach_speed_m_s", 1.0), ("return_stiffness_N_um15", 32.0)];
    let ratio = thrust(&stiff) / thrust(&speed);
    assert!((ratio - 4.0).abs() < 1e-12, "{ratio}");
}

#[test]
fn models_without_a_motion_are_refused() {
    let scene = scene(XU, &[]);
    let settings = Model::QuasiStatic.into();
    let solution = solved(&scene, &settings);
    for refused in [Analysis::slip(&scene, &settings, &solution), Analysis::jam(&scene, &solution)]
    {
        let error = refused.expect_err("no motion");
        assert!(matches!(error, CaseError::NoMotion { .. }), "{error}");
        assert!(error.to_string().contains("models rigid, raceway-control"), "{error}");
    }
    // A fixed model stays what it is; auto goes on to one that has a motion.
    let mut work = ModelWorkspace::default();
    let fixed = Moving::of(&scene, &settings, solution.clone(), &mut work).expect("complete");
    assert_eq!((fixed.solution, fixed.note), (solution, None));
    let auto = Settings { tolerance: 0.9, ..Settings::default() };
    let chosen = solved(&scene, &auto);
    assert_eq!(chosen.model, Model::ClosedForm);
    let next = Moving::of(&scene, &auto, chosen, &mut work).expect("complete");
    assert_eq!(next.settings.model, ModelChoice::Fixed(Model::RacewayControl));
    assert_eq!(next.solution, solved(&scene, &next.settings));
    assert!(next.note.is_some_and(|words| words.contains("closed-form")));
}

/// Outputs of a solution that an analysis has too.
const SHARED: [&str; 3] = ["nut_spin_rad_s", "screw_spin_rad_s", "dissipated_power_W"];

/// A column has one meaning: no other analysis has its name, nor has an input; what an analysis shares
/// with a solution is the same number.
#[test]
fn a_column_has_one_meaning() {
    let mut names: Vec<_> = Output::all().map(|output| output.name).collect();
    let count = names.len();
    names.sort_unstable();
    let twice: Vec<_> = names.windows(2).filter(|two| two[0] == two[1]).map(|two| two[0]).collect();
    let mut shared = SHARED;
    shared.sort_unstable();
    assert_eq!(twice, shared);
    let inputs: Vec<_> = INPUTS.iter().filter(|i| names.contains(&i.name)).collect();
    assert!(inputs.is_empty(), "{inputs:?}");
    assert_eq!(
        count,
        OUTPUTS.len() + AnalysisKind::ALL.into_iter().flat_map(AnalysisKind::columns).count()
    );
    let scene = scene(XU, &[]);
    let record = Record::new(solved(&scene, &Model::Traction.into()));
    let report = slip(&scene, Model::Traction);
    for name in SHARED {
        let (there, here) = (record.number(name).expect("an output"), number(&report, name));
        // Rounding of spins of 100 rad/s that are differences of rates of 3000 rad/s.
        assert!((there - here).abs() <= 1e-10 * there.abs(), "{name}: {there} {here}");
    }
}

/// Every quantity has a name with its unit, words, and a place of its own.
#[test]
fn quantities_are_complete() {
    for kind in AnalysisKind::ALL {
        for (place, quantity) in kind.quantities().iter().enumerate() {
            let members = match quantity.of {
                Of::Whole | Of::Statement => 1,
                Of::Directions => 2,
                Of::Contacts => 3,
            };
            assert_eq!(quantity.columns.len(), members, "{}", quantity.key);
            assert!(!quantity.about.is_empty() && !quantity.title.is_empty());
            for column in quantity.columns {
                assert!(column.name.ends_with(quantity.key), "{}", column.name);
                assert_eq!(column.analysis(), Some(kind));
                let named = Output::named(column.name).expect("its name");
                assert!(SHARED.contains(&column.name) || named.about == column.about, "{place}");
            }
        }
    }
}
