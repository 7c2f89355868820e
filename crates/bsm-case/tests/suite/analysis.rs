//! Tests of general properties of the analyses of the ball motion. Published trends are checked by
//! `bsm validate`.

use bsm_case::{
    AnalysisKind, Answer, Case, CaseError, Catalog, EllipseFields, INPUTS, ModelChoice,
    MotionAnswer, OUTPUTS, Output, Record, Scope, Settings, candidate_json, output,
};
use bsm_dyn::{Model, ModelWorkspace, Solution};

use crate::named;

const XU: &[u8] = include_bytes!("../../../../examples/xu2015.json");
const DONG: &[u8] = include_bytes!("../../../../examples/dong2020.json");

fn case(json: &[u8], changes: &[(&str, f64)]) -> Case {
    let mut case = Case::from_json(json).expect("an example");
    for (name, value) in changes {
        case.set(name, *value).expect("known name");
    }
    case
}

fn solved(case: &Case, settings: &Settings) -> Solution {
    let problem = case.problem(settings).expect("complete");
    let solution = problem.solve(&mut ModelWorkspace::default());
    assert!(solution.reason().is_none(), "{:?}", solution.reason());
    solution
}

fn slip(case: &Case, model: Model) -> Answer {
    let settings = model.into();
    bsm_case::slip(case, &settings, &solved(case, &settings)).expect("a motion")
}

fn jam(case: &Case, model: Model) -> Answer {
    bsm_case::jam(case, &solved(case, &model.into())).expect("a motion")
}

fn number(report: &Answer, name: &str) -> f64 {
    report.number(named(name)).unwrap_or_else(|| panic!("{name}: {report:?}"))
}

/// Slip and spin in the slip report equal the outputs of the model. This is tested for a turning
/// screw, a turning nut, and both.
#[test]
fn slip_report_matches_the_model() {
    for (screw, nut) in [(5000.0, 0.0), (-3000.0, 0.0), (0.0, 1500.0), (2500.0, -1700.0)] {
        let case = case(XU, &[("screw_speed_rpm", screw), ("nut_speed_rpm", nut)]);
        for model in [Model::RacewayControl, Model::Traction] {
            let o = solved(&case, &model.into()).result.expect("a solution").ball;
            let report = slip(&case, model);
            for (name, value) in [
                ("nut_differential_slip_m_s", o.nut.slip.map(|slip| slip.speed)),
                ("screw_differential_slip_m_s", o.screw.slip.map(|slip| slip.speed)),
                ("nut_spin_rad_s", o.nut.slip.map(|slip| slip.spin)),
                ("screw_spin_rad_s", o.screw.slip.map(|slip| slip.spin)),
            ] {
                let expected = value.expect("elastic model");
                // The tolerance allows for rounding errors of speeds of 10 m/s and of angular
                // velocities of 3000 rad/s.
                let scale = expected.abs().max(1.0);
                assert!((number(&report, name) - expected).abs() <= 1e-10 * scale, "{name}");
            }
            assert!(number(&report, "power_difference").abs() < 1e-9);
        }
    }
}

/// The slip powers add up to the dissipated power for a given accuracy and creep speed, and for the
/// accuracy that `auto` chooses.
#[test]
fn slip_powers_add_up_to_the_dissipated_power() {
    let case = case(XU, &[("screw_speed_rpm", 12000.0)]);
    let coarse = Settings { accuracy: 1e-4, creep: 1e-2, ..Model::Traction.into() };
    let fine = Settings { tolerance: 1e-5, ..Settings::default() };
    for settings in [coarse, fine] {
        let solution = solved(&case, &settings);
        assert_eq!(solution.model, Model::Traction);
        let report = bsm_case::slip(&case, &settings, &solution).expect("a motion");
        // The model keeps its quadrature nodes fixed in the last iterations, while the report uses
        // the nodes of the final motion. The resulting difference is at most a thousandth of the
        // requested accuracy.
        let apart = f64::max(1e-9, 1e-3 * settings.accuracy);
        assert!(number(&report, "power_difference").abs() < apart);
        assert!(report.warnings.iter().all(|w| !w.contains("add up")), "{:?}", report.warnings);
    }
}

/// Xu and Tang print a formula for the spin slip of each contact that uses the contact angle of the
/// opposite contact. If both angles are equal, the printed and the corrected results are equal.
/// Otherwise, the printed results equal the corrected spin slip with the contacts exchanged. There
/// is no printed formula for the unloaded flank.
#[test]
fn printed_spin_slip_formula_uses_the_angle_of_the_other_contact() {
    let report = slip(&case(XU, &[]), Model::Rigid);
    for form in ["spin", "orbit"] {
        for contact in ["nut", "screw"] {
            let printed = number(&report, &format!("{contact}_{form}_slip_printed_m_s"));
            let corrected = number(&report, &format!("{contact}_{form}_slip_corrected_m_s"));
            assert!((printed / corrected - 1.0).abs() < 1e-12, "{contact} {form}");
        }
        assert!(report.number(named(&format!("unloaded_flank_{form}_slip_printed_m_s"))).is_none());
    }
    let report = slip(&case(XU, &[]), Model::Traction);
    let [printed, corrected] = ["printed", "corrected"].map(|form| {
        ["nut", "screw"].map(|c| number(&report, &format!("{c}_spin_slip_{form}_m_s")))
    });
    assert!((printed[0] / corrected[1] - 1.0).abs() < 1e-12, "{printed:?} {corrected:?}");
    assert!((printed[1] / corrected[0] - 1.0).abs() < 1e-12, "{printed:?} {corrected:?}");
    assert!((printed[0] / corrected[0] - 1.0).abs() > 1e-2, "{printed:?} {corrected:?}");
}

/// The `rigid` model has three contacts, but no contact ellipses. The report states this fact and
/// contains no values that depend on contact ellipses.
#[test]
fn rigid_model_reports_no_contact_ellipses() {
    let mut case = case(XU, &[("lead_mm", 40.0)]);
    (case.nut_conformity, case.screw_conformity) = (None, None);
    let report = slip(&case, Model::Rigid);
    assert!(report.number(output!(unloaded_flank_differential_slip_m_s)).is_some());
    assert!(report.number(output!(nut_spin_slip_m_s)).is_none());
    assert!(report.texts("lacks")[0].contains("nut_conformity"), "{:?}", report.texts("lacks"));
    let report = jam(&case, Model::Rigid);
    assert!(
        report.texts("lacks").iter().any(|l| l.contains("wedge angle")),
        "{:?}",
        report.texts("lacks")
    );
    assert!(number(&report, "wedge_angle_deg").abs() < 1e-15);
    assert!(report.number(output!(locking_ratio)).is_none());
}

/// If an input is missing, the jamming report names this input in place of the results that need
/// it. All other results are still calculated.
#[test]
fn jamming_report_names_missing_inputs() {
    let names = [
        "raceway_yield_strength_MPa",
        "drag_coefficient",
        "apex_half_angle_deg",
        "return_angle_deg",
        "loaded_balls_per_turn",
    ];
    let full = jam(&case(DONG, &[]), Model::RacewayControl);
    assert!(full.texts("lacks").is_empty());
    let text = String::from_utf8(DONG.to_vec()).expect("UTF-8");
    for name in names {
        let without: Vec<_> = text.lines().filter(|line| !line.contains(name)).collect();
        let json = without.join("\n").replace(",\n}", "\n}");
        let report = jam(&case(json.as_bytes(), &[]), Model::RacewayControl);
        assert_eq!(report.texts("lacks").len(), 1, "{name}: {:?}", report.texts("lacks"));
        assert!(
            report.texts("lacks")[0].ends_with(&format!(": {name}")),
            "{:?}",
            report.texts("lacks")
        );
        assert!(report.number(output!(wedge_angle_deg)).is_some());
    }
}

fn verdict_on(report: &Answer, name: &str) -> (bool, String) {
    let verdict = &report.to_json()["verdicts"][name];
    (verdict["answer"].as_bool().expect("a statement"), verdict["words"].to_string())
}

/// The verdict depends on the ball-return margin, which is calculated from the friction of stopped
/// balls. An earlier criterion was based on the friction along the track in steady motion. This
/// friction is zero for a rolling ball, so jamming was reported for any push force in the ball
/// return.
#[test]
fn rolling_balls_do_not_jam_at_any_thrust() {
    for model in [Model::Elastic, Model::RacewayControl, Model::Traction] {
        let report = jam(&case(DONG, &[]), model);
        let (jams, words) = verdict_on(&report, "jams");
        assert!(!jams && number(&report, "ball_return_margin") > 1.0, "{words}");
        let report = jam(&case(DONG, &[("step_normal_force_N", 1e5)]), model);
        let (jams, words) = verdict_on(&report, "jams");
        assert!(jams && number(&report, "ball_return_margin") < 1.0, "{words}");
    }
    let rolls = jam(&case(DONG, &[]), Model::RacewayControl);
    assert!(number(&rolls, "published_margin").abs() < f64::EPSILON);
}

/// Eq. 21 is evaluated at the screw contact. At 8 kN and 2500 rpm, the verdict of the published
/// criterion would be reversed if the contact with less friction were used.
#[test]
fn published_jamming_criterion_uses_the_screw_contact() {
    let report = jam(&case(DONG, &[("axial_load_N", 8000.0)]), Model::Traction);
    let [screw, weaker] =
        ["published_margin", "weaker_contact_margin"].map(|name| number(&report, name));
    assert!(screw > weaker, "{screw} {weaker}");
    let ratio =
        number(&report, "screw_track_friction_N") / number(&report, "weaker_track_friction_N");
    // Each margin is a friction force divided by the same thrust, so the ratio of the margins
    // equals the ratio of the friction forces.
    assert!((screw / weaker / ratio - 1.0).abs() < 1e-12);
}

/// In steady motion, a ball never needs more friction across the grooves than is available.
/// Therefore, the ball always meets the wedge criterion, and the analysis reports no jamming.
#[test]
fn ball_in_steady_motion_meets_the_wedge_criterion() {
    for model in [Model::RacewayControl, Model::Traction] {
        for (speed, load) in [(100.0, 2e4), (2500.0, 8e3), (5000.0, 2.4e4), (-2500.0, 8e3)] {
            let changes = [("screw_speed_rpm", speed), ("axial_load_N", load)];
            let report = jam(&case(DONG, &changes), model);
            assert!(
                number(&report, "wedge_angle_deg").abs() <= number(&report, "widest_wedge_deg")
            );
            assert!(!verdict_on(&report, "self_locking_under_load").0);
        }
    }
}

/// A screw is self-locking if friction alone holds the load. The margin decreases as friction
/// increases. It increases with the load, because the load makes the contact angles steeper.
#[test]
fn self_locking_margin_depends_on_friction_and_load() {
    let at = |changes: &[(&str, f64)]| {
        let report = jam(&case(DONG, changes), Model::RacewayControl);
        (number(&report, "locking_margin"), verdict_on(&report, "self_locking_under_load").0)
    };
    let (healthy, locks) = at(&[]);
    assert!(healthy > 10.0 && !locks, "{healthy}");
    assert!(at(&[("friction_coefficient", 0.2)]).0 < 0.51 * healthy);
    assert!(at(&[("axial_load_N", 24_000.0)]).0 > healthy);
    // The screw is self-locking, because sin 5° / √(cos² 5° + tan² 6.8°) is less than the friction
    // coefficient of 0.1. The load is too small to increase the contact angle.
    let (margin, locks) =
        at(&[("contact_angle_deg", 5.0), ("axial_load_N", 1.0), ("screw_speed_rpm", 10.0)]);
    assert!(margin < 1.0 && locks, "{margin}");
}

const JAMMING: &[u8] = include_bytes!("../../../../examples/jamming.json");
const FEED: &[u8] = include_bytes!("../../../../examples/feed_drive.json");

/// The analysis reports jamming for a case that was designed to jam. The jamming margin decreases
/// with increasing speed, return angle and step height. It increases with load and friction,
/// because both increase the force with which the loaded balls push.
#[test]
fn jamming_is_reported_for_a_case_designed_to_jam() {
    let margin = |changes: &[(&str, f64)]| {
        let report = jam(&case(JAMMING, changes), Model::RacewayControl);
        let (jams, words) = verdict_on(&report, "jams");
        let margin = number(&report, "ball_return_margin");
        assert_eq!(jams, margin <= 1.0, "{words}");
        margin
    };
    let base = margin(&[]);
    assert!(base < 1.0, "{base}");
    assert!(margin(&[("screw_speed_rpm", 6000.0)]) < base);
    assert!(margin(&[("return_angle_deg", 84.0)]) < base);
    assert!(margin(&[("axial_load_N", 800.0)]) > base);
    assert!(margin(&[("friction_coefficient", 0.15)]) > base);
    let healthy = [("return_angle_deg", 30.0), ("screw_speed_rpm", 1000.0)];
    assert!(margin(&healthy) > 1.0);
    // The balls can pass a step of half the ball radius, but not a step of the full ball radius.
    let high = jam(
        &case(JAMMING, &[("step_height_mm", 1.75), ("axial_load_N", 5e4)]),
        Model::RacewayControl,
    );
    let (jams, words) = verdict_on(&high, "jams");
    assert!(jams && words.contains("No thrust lifts"), "{words}");
}

/// Inputs of a typical ball return for the jamming analysis.
const RETURN: [(&str, f64); 3] =
    [("apex_half_angle_deg", 60.0), ("return_angle_deg", 30.0), ("step_height_mm", 0.3)];

fn assert_no_alarm(case: &Case) {
    let settings = Settings::default();
    let mut work = ModelWorkspace::default();
    let moving = MotionAnswer::of(case, &settings, &mut work).expect("complete");
    let report = bsm_case::jam(case, &moving.solution).expect("a motion");
    let verdicts = &report.to_json()["verdicts"];
    let holds = |verdict: &serde_json::Value| verdict["answer"] == true;
    let alarms = verdicts.as_object().expect("verdicts").values().filter(|verdict| holds(verdict));
    assert_eq!(alarms.count(), 0, "{verdicts}: {case:?}");
    assert!(report.number(output!(ball_return_margin)).is_none_or(|margin| margin > 1.0));
}

/// The jamming analysis reports no jamming for healthy screws. It used to report self-locking balls
/// for every healthy screw.
#[test]
fn jamming_analysis_raises_no_alarm_for_healthy_screws() {
    assert_no_alarm(&case(FEED, &[]));
    assert_no_alarm(&case(FEED, &[&RETURN[..], &[("loaded_balls_per_turn", 20.0)]].concat()));
    let catalog = Catalog::standard().expect("lists");
    let places = catalog.indices();
    let ten: Vec<_> = (0..10).map(|i| places[(2 * i + 1) * places.len() / 20]).collect();
    let nuts = catalog.map(&ten, |_, nut| Some(candidate_json(nut)));
    assert_eq!(nuts.len(), 10);
    for nut in nuts {
        let number = |name: &str| nut[name].as_f64().expect("a number");
        let (balls, turns) = (number("loaded_balls_per_turn"), number("loaded_turns"));
        let healthy = [
            ("pitch_circle_diameter_mm", number("pitch_circle_diameter_mm")),
            ("lead_mm", number("lead_mm")),
            ("ball_diameter_mm", number("ball_diameter_mm")),
            ("contact_angle_deg", number("contact_angle_deg")),
            ("nut_conformity", number("nut_conformity")),
            ("screw_conformity", number("screw_conformity")),
            ("loaded_balls_per_turn", balls),
            ("loaded_balls", balls * turns),
            // The step height of the feed drive is used. For smaller balls, it is reduced in
            // proportion to the ball diameter.
            ("step_height_mm", (number("ball_diameter_mm") * 0.3 / 6.35).min(0.3)),
            // The load is one fifth of the dynamic load rating, and the speed is half of the
            // permissible speed.
            ("axial_load_N", 0.2 * number("dynamic_load_rating_N")),
            ("screw_speed_rpm", 35_000.0 / number("pitch_circle_diameter_mm")),
            // The yield strengths correspond to steel with a hardness of 60 HRC.
            ("raceway_yield_strength_MPa", 2200.0),
            ("ball_yield_strength_MPa", 2400.0),
        ];
        assert_no_alarm(&case(FEED, &[&RETURN[..], &healthy].concat()));
    }
}

/// If the speed is reversed, the wedging is also reversed: the ball climbs the opposite side of the
/// groove.
#[test]
fn reversing_the_speed_changes_the_sign_of_the_wedge_angle() {
    let wedge = |rpm| {
        let report = jam(&case(DONG, &[("screw_speed_rpm", rpm)]), Model::Traction);
        number(&report, "wedge_angle_deg")
    };
    let (forth, back) = (wedge(2500.0), wedge(-2500.0));
    // The wedge angle is large at both speeds. The centrifugal force acts in the same direction at
    // both speeds, but it changes the angle by only 0.002 deg.
    assert!(forth > 1.0 && back < -1.0, "{forth} {back}");
}

/// The push force due to the impact depends on the given inputs of the ball return.
#[test]
fn thrust_at_the_entry_step_depends_on_ball_return_inputs() {
    let thrust = |changes: &[(&str, f64)]| {
        let report = jam(&case(DONG, changes), Model::RacewayControl);
        number(&report, "step_thrust_N")
    };
    let base = thrust(&[("step_normal_force_N", 10.0)]);
    // The expected value from a hand calculation is 2 F_N / ((μ + 1/μ) cos 30°).
    assert!((base - 20.0 / (10.1 * 30.0_f64.to_radians().cos())).abs() < 1e-12);
    let speed = [("return_approach_speed_m_s", 1.0), ("return_stiffness_N_um15", 1.0)];
    let double = [("return_approach_speed_m_s", 2.0), ("return_stiffness_N_um15", 1.0)];
    // The impact force is proportional to v^{6/5} K^{2/5}.
    let ratio = thrust(&double) / thrust(&speed);
    assert!((ratio - 2.0_f64.powf(1.2)).abs() < 1e-12, "{ratio}");
    let stiff = [("return_approach_speed_m_s", 1.0), ("return_stiffness_N_um15", 32.0)];
    let ratio = thrust(&stiff) / thrust(&speed);
    assert!((ratio - 4.0).abs() < 1e-12, "{ratio}");
}

#[test]
fn analyses_reject_models_that_do_not_calculate_the_motion() {
    let case = case(XU, &[]);
    let settings = Model::QuasiStatic.into();
    let solution = solved(&case, &settings);
    for refused in [bsm_case::slip(&case, &settings, &solution), bsm_case::jam(&case, &solution)] {
        let error = refused.expect_err("no motion");
        assert!(error.to_string().contains("does not calculate the motion of the ball"), "{error}");
        assert!(error.to_string().contains("use model rigid, raceway-control"), "{error}");
    }
    let mut work = ModelWorkspace::default();
    let fixed = MotionAnswer::of(&case, &settings, &mut work).expect("complete");
    assert_eq!(fixed.solution, solution);
}

/// `auto` used to choose the model of an analysis based on the error of the efficiency, which does
/// not limit the errors of slip and wedge angle. As a result, the contact angle at the screw jumped
/// from 47 to 51 deg between 6 and 8 kN.
#[test]
fn model_choice_for_analyses_ignores_the_efficiency_error() {
    let mut work = ModelWorkspace::default();
    for (load, tolerance) in [(6e3, 1e-2), (8e3, 1e-2), (8e3, 0.9)] {
        let case = case(DONG, &[("axial_load_N", load), ("friction_coefficient", 0.06)]);
        let auto = Settings { tolerance, ..Settings::default() };
        let moving = MotionAnswer::of(&case, &auto, &mut work).expect("complete");
        assert_eq!(moving.solution.model, Model::Traction);
        assert_eq!(moving.settings.model, ModelChoice::Fixed(Model::Traction));
    }
    // Without conformities, only one model calculates the motion.
    let mut bare = case(XU, &[("lead_mm", 40.0)]);
    (bare.nut_conformity, bare.screw_conformity) = (None, None);
    let moving = MotionAnswer::of(&bare, &Settings::default(), &mut work).expect("complete");
    assert_eq!(moving.solution.model, Model::Rigid);
}

const OIL: &[u8] = include_bytes!("../../../../examples/feed_drive_oil.json");

/// Without lubricant film, rolling resistance and hysteresis, the jamming results for a lubricated
/// ball equal the results for a dry ball with the friction coefficient of the asperities. The
/// analysis used to reject lubricated balls.
#[test]
fn jamming_results_of_a_lubricated_ball_without_a_film_equal_those_of_a_dry_ball() {
    let bare = [("film_factor", 1e-9), ("rolling_factor", 0.0), ("hysteresis_loss", 0.0)];
    let oil = case(OIL, &[&bare[..], &RETURN].concat());
    let mut dry = case(include_bytes!("../../../../examples/feed_drive.json"), &RETURN);
    dry.friction_coefficient = Some(0.12);
    // The film carries a fraction of 2e-9 of the load. Model `traction` integrates the loss with a
    // stated error of 6e-5.
    for (model, error) in [(Model::RacewayControl, 1e-6), (Model::Traction, 1e-4)] {
        let [oil, dry] = [&oil, &dry].map(|case| jam(case, model));
        for name in [
            "wedge_angle_deg",
            "nut_friction_across_N",
            "holding_force_N",
            "widest_wedge_deg",
            "locking_margin",
            "apex_thrust_N",
            "step_thrust_N",
            "stopped_friction_coefficient",
            "ball_return_margin",
        ] {
            let [oil, dry] = [&oil, &dry].map(|report| number(report, name));
            assert!(
                (oil - dry).abs() <= error * dry.abs().max(1.0),
                "{model:?} {name}: {oil} {dry}"
            );
        }
    }
}

/// The friction coefficients differ between contacts in motion, a stopped ball, and surfaces
/// without a film. A stopped ball slips at the speed of the screw groove.
#[test]
fn jamming_analysis_of_a_lubricated_ball_uses_local_friction_coefficients() {
    let oil = case(OIL, &RETURN);
    let solution = solved(&oil, &Model::Traction.into());
    let film = solution.steady_state().and_then(|solved| solved.film).expect("a lubricant");
    let report = bsm_case::jam(&oil, &solution).expect("a motion");
    let stopped = number(&report, "stopped_friction_coefficient");
    for coefficient in [film.nut.friction, film.screw.friction, stopped, 0.12] {
        assert!(
            report.notes.iter().any(|note| note.contains(&bsm_case::format_number(coefficient)))
        );
    }
    // The screw slides faster on a stopped ball than on a moving ball, so the friction coefficient
    // is larger, but it remains below the limit of the oil.
    assert!(film.screw.friction < stopped && stopped < film.screw.law.max_friction(), "{stopped}");
    let pushes = number(&report, "stopped_track_friction_N") / stopped;
    let load = number(&report, "screw_load_with_permanent_set_N");
    assert!((pushes / (20.0 * load) - 1.0).abs() < 1e-12, "the balls of a turn");
    // All results of the slip and jamming analyses are available as columns.
    for name in ["ball_return_margin", "stopped_friction_coefficient", "nut_spin_power_W"] {
        let column = Output::named(name).expect("a column");
        column.check(&oil, oil.stated(), ModelChoice::Auto).expect("of a lubricant too");
    }
}

/// The powers of the slip components add up to the sliding power of the model. The slip analysis
/// used to reject lubricated balls.
#[test]
fn slip_powers_of_a_lubricated_ball_add_up_to_the_sliding_power() {
    for speed in [30.0, 500.0, 3000.0] {
        let oil = case(OIL, &[("screw_speed_rpm", speed)]);
        for model in [Model::RacewayControl, Model::Traction] {
            let settings = model.into();
            let solution = solved(&oil, &settings);
            let film = solution.steady_state().and_then(|solved| solved.film).expect("a lubricant");
            let report = bsm_case::slip(&oil, &settings, &solution).expect("a motion");
            let total = number(&report, "total_friction_power_W");
            // The model and the slip analysis integrate the friction of the films at different
            // points. The tolerance equals the limit above which the slip analysis gives a warning.
            let difference = (total - film.sliding_power).abs();
            assert!(difference <= 1e-3 * film.sliding_power, "{speed} {model:?}: {difference}");
            assert!(!report.warnings.iter().any(|w| w.contains("add up")), "{:?}", report.warnings);
            assert!(
                number(&report, "dissipated_power_W") > total,
                "the dissipated power also includes rolling and drag"
            );
        }
    }
}

/// The integral of the pressure over the ellipses equals the load, and the integral of the friction
/// equals the friction force.
#[test]
fn ellipse_fields_integrate_to_load_and_friction_force() {
    /// Number of grid cells on each semi-axis.
    const POINTS: u32 = 100;
    let dry = include_bytes!("../../../../examples/feed_drive.json");
    for (json, model) in
        [(&dry[..], Model::Traction), (OIL, Model::Traction), (OIL, Model::RacewayControl)]
    {
        let (case, settings) = (case(json, &[]), model.into());
        let fields = EllipseFields::of(&case, &settings, &solved(&case, &settings), POINTS);
        let fields = fields.expect("elastic contacts");
        let answer = fields.answer().to_json();
        let table = fields.columns();
        for site in ["nut", "screw"] {
            let contact = answer["contacts"].as_array().expect("contacts");
            let contact = contact.iter().find(|c| c["contact"] == site).expect("a contact");
            let value = |at: &serde_json::Value| at.as_f64().expect("a number");
            let load = value(&contact["normal_load_N"]);
            let [a, b] = [0, 1].map(|i| value(&contact["semi_axes_mm"][i]));
            let cell = a * b / f64::from(POINTS * POINTS);
            let sum = |name: &str| -> f64 {
                let read = |row: &Vec<f64>| {
                    let pressure = table.cell(row, &format!("{site}_pressure_MPa"));
                    pressure
                        * if name.is_empty() {
                            1.0
                        } else {
                            table.cell(row, &format!("{site}_{name}"))
                        }
                };
                cell * table.rows.iter().map(read).sum::<f64>()
            };
            // Near the rim of the ellipse, the pressure falls to zero like a square root, so a cell
            // at the rim has an error of about (1/100)^1.5 = 1e-3. The errors of the 600 cells at
            // the rim average out to 4e-5 if they are random.
            let tolerance = 1e-4 * load;
            assert!((sum("") - load).abs() < tolerance, "{site}: {} for {load}", sum(""));
            for (i, name) in ["friction_across", "friction_along"].into_iter().enumerate() {
                let force = value(&contact["friction_force_N"][i]);
                assert!(
                    (sum(name) - force).abs() < tolerance,
                    "{site} {name}: {} for {force}",
                    sum(name)
                );
            }
        }
    }
}

/// In the case of Xu and Tang, the contact angle is 50 deg at the nut and 40 deg at the screw. The
/// program used to have no inputs for these angles.
#[test]
fn running_contact_angles_of_nut_and_screw_can_be_given() {
    let angles =
        [("nut_running_contact_angle_deg", 50.0), ("screw_running_contact_angle_deg", 40.0)];
    let given = case(XU, &angles);
    let nut_control =
        Settings { control: Some(bsm_dyn::Control::Nut), ..Model::RacewayControl.into() };
    let report =
        bsm_case::slip(&given, &nut_control, &solved(&given, &nut_control)).expect("a motion");
    // The expected values were calculated with the formulas in `xu2015.rs` of `bsm-validate` and
    // printed with four digits.
    for (name, expected) in [
        ("nut_orbit_slip_printed_m_s", 3.3210),
        ("screw_orbit_slip_printed_m_s", 3.9744),
        ("nut_orbit_slip_corrected_m_s", 3.8990),
        ("screw_orbit_slip_corrected_m_s", 3.2598),
    ] {
        assert!((number(&report, name) - expected).abs() < 5.1e-5, "{name}");
    }
    assert!(report.number(output!(nut_friction_power_W)).is_none());
    assert!(
        report.texts("lacks").iter().any(|lack| lack.contains("in equilibrium")),
        "{:?}",
        report.texts("lacks")
    );
    // Given angles are rejected for a model that calculates the angles and for the jamming
    // analysis. A case with only one of the two angles is also rejected.
    let traction = Model::Traction.into();
    let refused = bsm_case::slip(&given, &traction, &solved(&given, &traction));
    assert!(matches!(refused, Err(CaseError::OutOfRange { model: Some(_), .. })), "{refused:?}");
    assert!(bsm_case::jam(&given, &solved(&given, &nut_control)).is_err());
    let half = case(XU, &angles[..1]);
    let refused = half.problem(&nut_control);
    assert!(matches!(refused, Err(CaseError::Entry { .. })), "{refused:?}");
    let auto = MotionAnswer::of(&given, &Settings::default(), &mut ModelWorkspace::default());
    assert_eq!(auto.expect("complete").solution.model, Model::RacewayControl);
}

/// According to Eqs 12 and 14 of Dong et al., the friction moments of both contacts about the
/// tangent add up to the gyroscopic moment. The outputs used to lack these moments.
#[test]
fn tangential_friction_moments_balance_the_gyroscopic_moment() {
    let report = slip(&case(DONG, &[("screw_speed_rpm", 5000.0)]), Model::Traction);
    let [nut, screw] =
        ["nut", "screw"].map(|c| number(&report, &format!("{c}_tangent_friction_moment_Nmm")));
    let gyroscopic = number(&report, "gyroscopic_moment_Nmm");
    assert!(gyroscopic.abs() > 1e-4, "{gyroscopic}");
    // The moment balance is solved to 1e-10 of the product of load and ball radius, which is about
    // 500 N x 1.75 mm.
    assert!((nut + screw - gyroscopic).abs() < 1e-6, "{nut} {screw} {gyroscopic}");
}

/// The program used to contain three different criteria for self-locking. One of these criteria
/// considered only friction across the groove, used a contact angle that friction had already
/// changed, and ignored the lead angle.
#[test]
fn jamming_report_uses_the_closed_form_self_locking_criterion() {
    let steep = [("lead_mm", 50.27), ("friction_coefficient", 0.7)];
    for model in [Model::RacewayControl, Model::Traction] {
        let report = jam(&case(DONG, &steep), model);
        let (locks, words) = verdict_on(&report, "self_locking_under_load");
        let angle = 0.5
            * (number(&report, "nut_angle_with_permanent_set_deg")
                + number(&report, "screw_angle_with_permanent_set_deg"));
        let closed = bsm_dyn::angles::Angles {
            lead: case(DONG, &steep).lead_angle().expect("a lead"),
            contact: angle.to_radians(),
        };
        let direction = bsm_dyn::Direction::RotaryToLinear;
        assert_eq!(locks, closed.self_locking(direction, 0.7), "{words}");
        assert!(locks && number(&report, "locking_margin") < 1.0, "{words}");
    }
}

/// Outputs of a solved motion that are also outputs of an analysis.
const SHARED: [&str; 3] = ["nut_spin_rad_s", "screw_spin_rad_s", "dissipated_power_W"];

/// Outputs of a nut or its balls that are also outputs of the axis sheet or the warm state.
const OF_A_NUT: [&str; 22] = [
    "limit_load_N",
    "nut_heat_W",
    "nut_conductance_W_K",
    "screw_film_W_m2K",
    "lubricant_temperature_C",
    "cold_preload_N",
    "preload_setting_um",
    "preload_torque_Nm",
    "preload_torque_reverse_Nm",
    "preload_torque_factor",
    "preload_torque_factor_rule",
    "running_preload_N",
    "running_preload_torque_Nm",
    "running_preload_torque_reverse_Nm",
    "running_preload_torque_factor",
    "running_preload_torque_over_rule",
    "running_preload_torque_factor_without_play",
    "third_contact_balls",
    "largest_third_contact_load_N",
    "third_contact_torque_share",
    "screw_tension_N",
    "warm_preload_N",
];

/// A column name refers to a single output: no other analysis and no input uses the same name.
/// Exceptions are outputs that an analysis shares with a solution, and outputs that an axis shares
/// with its nut. These outputs have the same value, unit and label in both places.
#[test]
fn column_names_are_unambiguous() {
    let mut names: Vec<_> = Output::all().map(|output| output.name).collect();
    let count = names.len();
    names.sort_unstable();
    let twice: Vec<_> = names.windows(2).filter(|two| two[0] == two[1]).map(|two| two[0]).collect();
    let mut shared = [&SHARED[..], &OF_A_NUT].concat();
    shared.sort_unstable();
    for name in OF_A_NUT {
        let said = |output: &&Output| (output.unit, output.about);
        let all: Vec<_> = Output::all().filter(|output| output.name == name).collect();
        assert_eq!(said(&all[0]), said(&all[1]), "{name}");
    }
    assert_eq!(twice, shared);
    let inputs: Vec<_> =
        INPUTS.iter().map(|input| input.name).filter(|name| names.contains(name)).collect();
    // The listed outputs have the names of inputs. They contain calculated values for inputs that
    // are not given.
    let same = [
        "pressure_viscosity_1_GPa",
        "lubricant_temperature_C",
        "nut_mass_kg",
        "unsupported_length_mm",
        "shaft_diameter_mm",
        "pretension_N",
        "pretension_K",
        "stop_deceleration_m_s2",
        "nut_inertia_kg_m2",
        "axis_heat_transfer_W_K",
        "required_life_revolutions",
        "nut_conductance_W_K",
        "screw_film_W_m2K",
        "gap_conductance_W_K",
        "ball_nut_conductance_W_K",
        "ball_screw_conductance_W_K",
        "end_conductance_W_K",
        "coolant_conductance_W_K",
        "screw_tension_N",
    ];
    assert_eq!(inputs, same);
    assert_eq!(
        count,
        OUTPUTS.len() + AnalysisKind::ALL.into_iter().flat_map(AnalysisKind::columns).count()
    );
    let case = case(XU, &[]);
    let record = Record::new(solved(&case, &Model::Traction.into()));
    let report = slip(&case, Model::Traction);
    for name in SHARED {
        let (there, here) = (record.number(named(name)).expect("an output"), number(&report, name));
        // The tolerance allows for rounding errors: spins of 100 rad/s are differences of angular
        // velocities of 3000 rad/s.
        assert!((there - here).abs() <= 1e-10 * there.abs(), "{name}: {there} {here}");
    }
}

/// Every quantity of an analysis has a title, a label, and one column for each member of its scope.
#[test]
fn quantities_have_labels_and_a_column_for_each_contact_or_direction() {
    for kind in AnalysisKind::ALL {
        for (place, quantity) in kind.quantities().iter().enumerate() {
            let members = match quantity.scope {
                Scope::Scalar | Scope::Statement => 1,
                Scope::Directions => 2,
                Scope::Contacts => 3,
            };
            assert_eq!(quantity.columns.len(), members, "{}", quantity.name);
            assert!(!quantity.about.is_empty() && !quantity.title.is_empty());
            for column in quantity.columns {
                assert!(column.name.ends_with(quantity.name), "{}", column.name);
                assert_eq!(column.analysis(), Some(kind));
                let named = Output::named(column.name).expect("its name");
                assert!(SHARED.contains(&column.name) || named.about == column.about, "{place}");
            }
        }
    }
}
