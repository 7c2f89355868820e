//! Tests of requirements for a screw, and of fits to measured values.

use bsm_case::{
    AxisReport, Case, CaseError, Catalog, ColumnValues, DesignReport, Fit, FittedInput, ListColumn,
    NutFilter, NutProblem, RequirementFile, SelectionLimit, Settings, output, ratings,
};
use bsm_dyn::{Model, ModelWorkspace, Status};
use serde_json::json;

use crate::named;

const REQUIREMENT: &[u8] = include_bytes!("../../../../examples/requirements/feed_drive.json");

fn requirement(settings: &[&str]) -> Result<RequirementFile, CaseError> {
    read(REQUIREMENT, settings)
}

/// Returns the example requirement without its lead.
fn requirement_without_lead(settings: &[&str]) -> Result<RequirementFile, CaseError> {
    read(include_bytes!("../../../../examples/requirements/free_lead.json"), settings)
}

fn read(json: &[u8], settings: &[&str]) -> Result<RequirementFile, CaseError> {
    let settings: Vec<_> = settings.iter().map(ToString::to_string).collect();
    let standard = Catalog::standard().expect("compiled in").lists;
    RequirementFile::from_json(json, &settings, standard)
}

fn value(report: &DesignReport, name: &str) -> f64 {
    let row = report.rows.iter().find(|row| row.name == name);
    row.and_then(|row| row.value).unwrap_or_else(|| panic!("{name}: {report:?}"))
}

fn assert_error_contains(settings: &[&str], words: &str) {
    let error = requirement(settings).expect_err(words).to_string();
    assert!(error.contains(words), "{error}");
}

/// The case of the selected screw meets the requirement according to both the model and the ratings
/// of its nut.
#[test]
fn case_of_the_selected_screw_meets_the_requirement() {
    let report = DesignReport::of(&requirement(&[]).expect("an example"));
    assert!(report.found, "{:?}", report.reasons);
    assert!(report.rows.iter().all(|row| row.passes));
    let case = Case::from_json(report.case.to_json().to_string().as_bytes()).expect("a case");
    assert_eq!(case, report.case);
    let problem = case.problem(&Settings::default()).expect("complete");
    let solution = problem.solve(&mut ModelWorkspace::default());
    assert_eq!(solution.status(), Status::Converged);
    let step = |name: &str| report.rows.iter().find(|r| r.name == name).and_then(|r| r.value);
    let same = |a: Option<f64>, b: Option<f64>| {
        let (a, b) = (a.expect("a number"), b.expect("a number"));
        // The conformity is rounded to 5e-7. The life depends on the third power of the difference
        // between conformity and 1/2, and this difference is 0.02.
        assert!((a / b - 1.0).abs() < 1e-4, "{a} {b}");
    };
    same(solution.efficiency(), step("screw_efficiency"));
    let capacity = ratings(&case).expect("a nut");
    let rating = |name: &str| capacity.number(named(name));
    same(rating("dynamic_load_rating_N"), step("dynamic_load_rating_N"));
    same(rating("rating_life_h"), step("cycle_life_h"));
    assert!(rating("rating_life_h").expect("a life") > 0.999e4);
}

/// In a linear-to-rotary motion, the load turns the screw backward.
#[test]
fn speed_of_a_screw_selected_for_linear_to_rotary_motion_is_negative() {
    let requirement =
        requirement(&["motion=linear-to-rotary", "model=closed-form", "allow_warnings=true"])
            .expect("a requirement");
    let report = DesignReport::of(&requirement);
    assert!(report.found && report.case.screw_speed_rpm == Some(-1500.0), "{report:?}");
}

#[test]
fn invalid_requirements_are_rejected() {
    assert_error_contains(
        &["screw_torque_Nm=3"],
        "give either axial_load_N or screw_torque_Nm; both are given",
    );
    assert_error_contains(
        &["screw_length_mm=900"],
        "give either screw_length_mm or stroke_mm; both are given",
    );
    assert_error_contains(
        &["motion=sideways"],
        "must be one of rotary-to-linear, linear-to-rotary",
    );
    assert_error_contains(&["stroke_mm=-1"], "`stroke_mm` = -1 must be a finite number > 0");
    assert_error_contains(&["life=10"], "did you mean `required_life_h`?");
    assert_error_contains(
        &["nut_conformity=0.52", "screw_conformity=0.53"],
        "a design uses one conformity for both",
    );
    assert_error_contains(&["screw_speed_rpm=0"], "must not be 0");
    assert_error_contains(&["pressure_limit_MPa=much"], "must be a number");
    let bare = read(b"{\"axial_load_N\": 1, \"lead_mm\": 5, \"stroke_mm\": 9}", &[]);
    let error = bare.expect_err("incomplete").to_string();
    assert!(error.contains("(or feed_m_min) is required"), "{error}");
}

/// If only load, motion and stroke are specified, the lightest screw is selected, with a note on
/// the assumed friction.
#[test]
fn load_motion_and_stroke_are_sufficient_to_select_a_screw() {
    let bare = br#"{"axial_load_N": 10000, "feed_m_min": 30, "required_life_h": 20000, "stroke_mm": 1200}"#;
    let standard = Catalog::standard().expect("compiled in");
    let report = |settings: &[&str]| {
        let requirement = read(bare, settings).expect("complete");
        DesignReport::standard(&requirement, &standard).expect("standard sizes")
    };
    let (usual, same) = (report(&[]), report(&["friction_coefficient=0.06", "objective=mass"]));
    assert!(usual.found, "{usual:?}");
    assert_eq!((&usual.rows, &usual.case), (&same.rows, &same.case));
    assert!(usual.notes[0].contains("friction_coefficient = 0.06 is assumed"), "{:?}", usual.notes);
    // The only note explains the number of loaded balls.
    assert!(
        matches!(&same.notes[..], [note] if note.contains("in the ball return")),
        "{:?}",
        same.notes
    );
}

/// If every command would reject the case of a screw, the screw is not reported as found. If a
/// lubricant is given, it replaces the friction coefficient of the requirement.
#[test]
fn screw_with_a_rejected_case_is_not_reported_as_found() {
    let report = DesignReport::of(&requirement(&["pretension_K=3"]).expect("a requirement"));
    let why = report.reasons.join("; ");
    assert!(!report.found && why.contains("needs support fixed-fixed"), "{why}");
    let oiled = requirement(&["iso_vg=68", "lubricant_temperature_C=40"]).expect("a requirement");
    let report = DesignReport::of(&oiled);
    assert!(report.found && report.case.friction_coefficient.is_none(), "{:?}", report.reasons);
}

/// An extremely large load is a valid input, but no screw can carry it.
#[test]
fn requirement_with_an_extreme_load_is_reported_as_infeasible() {
    let report = DesignReport::of(&requirement(&["axial_load_N=1e30"]).expect("a number"));
    assert!(!report.found);
    assert!(
        report
            .reasons
            .iter()
            .any(|r| r.contains("largest pressure at the nut, with equal load sharing")),
        "{report:?}"
    );
    assert!(report.reasons.iter().any(|r| r.contains("life under the cycle")), "{report:?}");
}

/// Lead and lead angle together determine the pitch circle diameter.
#[test]
fn lead_and_lead_angle_determine_the_pitch_circle() {
    let report = DesignReport::of(
        &requirement(&["lead_angle_deg=4", "required_life_h=100"]).expect("consistent"),
    );
    let case = report.case;
    let expected = 10.0 / (std::f64::consts::PI * 4.0_f64.to_radians().tan());
    // The pitch circle diameter in the case is rounded to one micrometer.
    assert!((case.pitch_circle_diameter_mm.expect("fixed") - expected).abs() < 1e-6);
}

fn feed_drive() -> Case {
    Case::from_json(include_bytes!("../../../../examples/feed_drive.json")).expect("an example")
}

/// A fit to the calculated output of a model recovers the friction coefficient, and the reported
/// sensitivity agrees with a finite difference of the model.
#[test]
fn fit_recovers_the_friction_coefficient() {
    let mut case = feed_drive();
    case.friction_coefficient = Some(0.0713);
    for model in [Model::ClosedForm, Model::RacewayControl, Model::Traction] {
        let settings = Settings::from(model);
        let at = |case: &Case| {
            let solution =
                case.problem(&settings).expect("complete").solve(&mut ModelWorkspace::default());
            solution.result.expect("converged").transmission.screw_torque.expect("a load")
        };
        let torque = at(&case);
        let measured = format!("screw_torque_Nm={torque}");
        let fit = Fit::parse(&case, "friction_coefficient", &measured).expect("names");
        let report = fit.run(&case, &settings).expect("complete");
        assert_eq!(report.found.len(), 1, "{}", fit.answer(&case, &report).to_json()["message"]);
        let found = &report.found[0];
        // Brent's method stops at 1e-10 of the search range, whose width is 0.5.
        assert!((found.value - 0.0713).abs() < 1e-8, "{}", found.value);
        let mut more = case.clone();
        more.friction_coefficient = Some(0.0713 * 1.001);
        let response = 1e-3 / (at(&more) / torque - 1.0);
        // The reference is a one-sided finite difference with a relative step of 1e-3.
        assert!((found.response / response - 1.0).abs() < 5e-3, "{} {response}", found.response);
    }
}

/// A fit to an output of the axis sheet finds all values of the input. The values agree with
/// independent results to 1e-6.
#[test]
fn fit_to_an_axis_output_finds_all_values_of_the_input() {
    let lift = json!([{ "distance_mm": 100, "time_s": 0.438, "profile": "triangular" }]);
    for (case, input, measured, expected) in [
        (
            json!({ "lead_mm": 5, "nominal_diameter_mm": 16, "screw_speed_rpm": 100, "axial_load_N": 100 }),
            "axial_load_N=1:1e5",
            "screw_torque_Nm=1.9",
            &[2_148.849_375_055_418_5][..],
        ),
        (
            json!({ "lead_mm": 8, "pitch_circle_diameter_mm": 32, "nominal_diameter_mm": 32, "screw_speed_rpm": 100,
                "rated_dynamic_load_N": 1e6, "rated_static_load_N": 1e6, "axial_load_N": 1, "preload_N": 100 }),
            "preload_N=10:1e5",
            "preload_torque_measured_Nm=0.3985",
            &[1_765.807_148_964_620_2],
        ),
        (
            json!({ "lead_mm": 4, "shaft_diameter_mm": 9.5, "support": "fixed-supported", "feed_m_min": 3.6 }),
            "unsupported_length_m=0.05:20",
            "critical_speed_ratio=0.8",
            &[1_263.378_049_266_122_4],
        ),
        (
            json!({ "lead_mm": 20, "shaft_diameter_mm": 34.4, "support": "fixed-fixed", "unsupported_length_mm": 3000 }),
            "feed_m_min=0.1:1000",
            "critical_speed_ratio=0.8",
            &[16.773_643_730_266_564],
        ),
        (
            json!({ "lead_mm": 10, "moved_mass_kg": 12.47, "inclination_deg": 90, "screw_mass_kg_m": 1.25,
                "unsupported_length_mm": 250, "motor_inertia_kg_m2": 3e-5, "cycle": lift }),
            "lead_mm=2:60",
            "peak_motor_torque_Nmm=250",
            &[2.823_037_255_435_018_7, 6.710_472_455_290_664],
        ),
        (
            json!({ "lead_mm": 10, "rated_dynamic_load_N": 52700, "feed_m_min": 8, "axial_load_N": 1000 }),
            "axial_load_N=10:1e5",
            "cycle_life_h=20000",
            &[5_342.200_752_778_641],
        ),
    ] {
        let case = Case::from_json(case.to_string().as_bytes()).expect("a case");
        let fit = Fit::parse(&case, input, measured).expect("names");
        let report = fit.run(&case, &Settings::default()).expect("an axis");
        let found: Vec<_> = report.found.iter().map(|found| found.value).collect();
        assert_eq!(found.len(), expected.len(), "{measured}: {found:?}");
        for (found, expected) in found.iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-6, "{measured}: {found}");
        }
    }
}

/// A fit to the limit of a rule finds the range of the input in which the rule is met, and the
/// limit of this range.
#[test]
fn fit_finds_the_input_range_that_meets_a_rule() {
    let case = json!({ "lead_mm": 4, "shaft_diameter_mm": 9.5, "support": "fixed-supported", "feed_m_min": 3.6 });
    let case = Case::from_json(case.to_string().as_bytes()).expect("a case");
    let input = FittedInput::parse("unsupported_length_mm=50:20000").expect("an input");
    let fit = Fit::of_limit(&case, &input, "critical speed").expect("a rule");
    let report = fit.run(&case, &Settings::default()).expect("an axis");
    let longest = 1_263.378_049_266_122_4;
    let [(low, high)] = report.ranges_within_limit[..] else { panic!("{report:?}") };
    // The reference value is accurate to 1e-6.
    assert!((high / longest - 1.0).abs() < 1e-6 && low < 50.001, "{low} {high}");
    let why = Fit::of_limit(&case, &input, "critical sped");
    let why = why.expect_err("no rule").to_string();
    assert!(why.contains("did you mean `critical speed`?"), "{why}");
}

/// Any input can be fitted. If the measured value is unreachable, the message states the reachable
/// range.
#[test]
fn error_of_a_fit_states_the_reachable_range() {
    let case = feed_drive();
    let settings = Settings::from(Model::RacewayControl);
    let fit = Fit::parse(&case, "axial_load_N", "nut_max_pressure_MPa=1500").expect("names");
    let found = fit.run(&case, &settings).expect("complete").found;
    assert_eq!(found.len(), 1);
    let record = found[0].record.as_ref().expect("a ball in motion");
    let pressure = record.number(output!(nut_max_pressure_MPa)).expect("converged");
    // The pressure depends only weakly on the load. A change of the load by 1e-10 of the search
    // range therefore changes the pressure by a fraction far below 1e-6.
    assert!((pressure / 1500.0 - 1.0).abs() < 1e-6, "{pressure}");
    let fit = Fit::parse(&case, "friction_coefficient", "screw_torque_Nm=1").expect("names");
    let report = fit.run(&case, &settings).expect("complete");
    assert!(
        report.found.is_empty()
            && fit.answer(&case, &report).to_json()["message"].to_string().contains("not 1")
    );
    for (input, measured, words) in [
        ("friction", "screw_torque_Nm=1", "did you mean `friction_coefficient`?"),
        ("friction_coefficient", "torque=1", "no numeric output is named `torque`"),
        ("friction_coefficient", "screw_torque_Nm", "does not have the form"),
        ("rolling_friction_mm", "screw_torque_Nm=1", "no search range is given"),
    ] {
        let error = Fit::parse(&case, input, measured).expect_err(words).to_string();
        assert!(error.contains(words), "{error}");
    }
    let error = Fit::parse(&case, "friction_coefficient=-1:1", "screw_torque_Nm=1");
    assert!(error.expect_err("negative friction").to_string().contains("-1 to 1 is not"));
}

/// The conformity in Sobolewski's tables is outside the range that Lin's step 6 permits. A
/// requirement can widen this range.
#[test]
fn requirement_can_widen_the_ranges_permitted_by_lin() {
    let tables = ["nut_conformity=0.53", "required_life_h=3000"];
    let narrow = DesignReport::of(&requirement(&tables).expect("a requirement"));
    let blocks = |r: &String| r.contains("ball radius / groove radius");
    assert!(!narrow.found && narrow.reasons.iter().any(blocks), "{:?}", narrow.reasons);
    let wider = "smallest_ball_radius_over_groove_radius=0.94";
    let wide =
        DesignReport::of(&requirement(&[tables[0], tables[1], wider]).expect("a requirement"));
    assert!(wide.found, "{:?}", wide.reasons);
    // The expected value from a hand calculation is 0.5 / 0.53.
    assert!((value(&wide, "ball_radius_over_groove_radius") - 0.943_396).abs() < 1e-6);
    assert_error_contains(
        &["largest_contact_angle_deg=20"],
        "must be > smallest_contact_angle_deg = 30",
    );
    assert_error_contains(
        &["largest_contact_angle_deg=30"],
        "`largest_contact_angle_deg` = 30 must be >",
    );
    assert_error_contains(&["largest_ball_radius_over_pitch_radius=2"], "must be between 0 and 1");
    let flat = ["largest_contact_angle_deg=40", "smallest_contact_angle_deg=20"];
    let flat = DesignReport::of(&requirement(&flat).expect("a requirement"));
    assert!(flat.found && value(&flat, "contact_angle_deg") <= 40.0 + 1e-3, "{:?}", flat.rows);
}

/// Lin's step 1 requires a lead. If no lead is given, the program chooses a standard lead, and the
/// selected screw has the same mass as if this lead were given. Screws with other leads are at most
/// 1 % lighter.
#[test]
fn missing_lead_is_chosen_from_standard_leads() {
    let free = DesignReport::of(&requirement_without_lead(&[]).expect("a requirement"));
    assert!(free.found, "{:?}", free.reasons);
    let lead = value(&free, "lead_mm");
    let mass = |report: &DesignReport| value(report, "mass_of_nut_and_screw_kg");
    let given =
        DesignReport::of(&requirement(&[&format!("lead_mm={lead}")]).expect("a requirement"));
    // The searches with and without a given lead consider the same sizes.
    assert!((mass(&free) / mass(&given) - 1.0).abs() < 1e-9);
    for other in ["lead_mm=8", "lead_mm=12", "lead_mm=16"] {
        let other = DesignReport::of(&requirement(&[other]).expect("a requirement"));
        // The number of balls is an integer, so a screw with another lead can be slightly lighter.
        assert!(!other.found || mass(&free) <= 1.01 * mass(&other), "lead {lead} mm");
    }
}

/// For linear-to-rotary motion, Lin's rule chooses the largest contact angle, and calculates the
/// lead angle with Eq 18.
#[test]
fn lead_angle_of_a_screw_driven_by_its_load_satisfies_eq_18_of_lin() {
    let motion = "motion=linear-to-rotary";
    let back = requirement_without_lead(&[
        motion,
        "objective=efficiency",
        "model=closed-form",
        "required_life_h=100",
    ]);
    let report = DesignReport::of(&back.expect("a requirement"));
    assert!((value(&report, "contact_angle_deg") - 75.0).abs() < 1e-6, "{:?}", report.rows);
    // The expected value from a hand calculation is cosα = √y*/sinβ with y* = (1 − f/√(1+f²))/2 at
    // f = 0.05 and 75 deg.
    let y = 0.5 * (1.0 - 0.05 / 1.0025_f64.sqrt());
    let lead = (y.sqrt() / 75.0_f64.to_radians().sin()).acos().to_degrees();
    // The angles in the case are rounded to microdegrees, which also affects the lead angle.
    assert!((value(&report, "lead_angle_deg") - lead).abs() < 1e-6);
    assert!((value(&report, "optimum_contact_angle_deg") - 75.0).abs() < 1e-6);
    let error =
        requirement_without_lead(&[motion, "contact_angle_deg=40"]).expect_err("no lead is best");
    assert!(error.to_string().contains("no lead angle has its best efficiency"), "{error}");
}

/// A load of 8 kN at 250 mm/s requires 2 kW at the nut.
#[test]
fn selected_screw_meets_the_input_power_limit() {
    let report = DesignReport::of(&requirement(&[]).expect("an example"));
    assert!((value(&report, "screw_output_power_W") - 2000.0).abs() < 1e-6);
    let input = value(&report, "screw_input_power_W");
    assert!((input - 2000.0 / value(&report, "screw_efficiency")).abs() < 1e-6);
    assert!((value(&report, "turns_for_stroke") - 70.0).abs() < 1e-9);
    let weak = ["largest_input_power_W=1990", "model=closed-form"];
    let weak = DesignReport::of(&requirement(&weak).expect("a requirement"));
    assert!(
        !weak.found
            && weak
                .reasons
                .iter()
                .any(|r| r.starts_with("input power of the screw must be <= 1990"))
    );
}

/// A level axis without friction and process force carries no load. Life and safety factors are then
/// unlimited, so they are not limits, and no text contains NaN.
#[test]
fn unloaded_screw_is_selected_because_no_limit_of_life_or_safety_applies() {
    let catalog = Catalog::manufacturers().expect("compiled in");
    let json = br#"{"moved_mass_kg":35,"feed_m_min":6,"axial_load_N":0,"stroke_mm":400,"required_life_h":10000}"#;
    let requirement =
        RequirementFile::from_json(json, &[], catalog.lists.clone()).expect("a requirement");
    let report = DesignReport::standard(&requirement, &catalog).expect("sizes");
    assert!(report.found, "{:?}", report.reasons);
    for name in ["cycle_life_h", "static_safety_factor", "buckling_safety"] {
        let mut rows = report.rows.iter().filter(|row| row.name == name);
        assert!(rows.all(|row| row.value.is_none() && row.requirement.is_none()));
    }
    assert!(report.notes.iter().any(|note| note.starts_with("No axial load acts on the screw")));
    let texts = [&report.reasons, &report.notes, &report.warnings].map(|texts| texts.join(" "));
    assert!(texts.iter().all(|text| !text.contains("NaN")), "{texts:?}");
}

/// Returns typical requirements of machine builders: a light lift with a long stroke, a feed axis
/// with a cycle, and a slow axis with a free screw end. The requirements differ in objective,
/// manufacturing method, preload and permitted warnings.
fn requirements_of_machine_builders() -> Vec<String> {
    let lift = r#""moved_mass_kg":7,"inclination_deg":90,"stroke_mm":1100,"required_life_h":2000,"support":"fixed-supported","cycle":[{"time_s":1,"feed_mm_s":100},{"time_s":1,"feed_mm_s":-100}]"#;
    let feed = r#""moved_mass_kg":450,"guide_friction":0.01,"stroke_mm":800,"support":"fixed-supported","required_life_h":20000,"cycle":[{"share":0.3,"force_N":4000,"feed_m_min":10},{"share":0.5,"force_N":0,"feed_m_min":30},{"share":0.2,"force_N":0,"feed_m_min":30}]"#;
    let slow = r#""axial_load_N":9000,"screw_speed_rpm":120,"stroke_mm":250,"required_life_h":1500,"support":"fixed-free""#;
    let mut all = Vec::new();
    for base in [lift, feed, slow] {
        for more in ["", r#","objective":"inertia""#, r#","screw_make":"rolled""#] {
            all.push(format!("{{{base}{more}}}"));
        }
    }
    all.push(format!(r#"{{{feed},"preload_class":"auto"}}"#));
    all.push(format!(r#"{{{slow},"allow_warnings":true}}"#));
    all
}

/// `select` prints every warning that `axis` prints for the selected screw. A warning that states a
/// selection limit occurs only if a requirement can permit this warning.
#[test]
fn select_command_prints_every_warning_of_the_axis_command() {
    let [own, standard] = [Catalog::manufacturers(), Catalog::standard()].map(Result::unwrap);
    let mut found = 0;
    for json in requirements_of_machine_builders() {
        let has_no_more = !json.contains("objective") && !json.contains("rolled");
        // The standard lists contain many sizes, so only one requirement of each kind is tested
        // with them.
        for catalog in [&own, &standard].into_iter().take(if has_no_more { 2 } else { 1 }) {
            let lists = catalog.lists.clone();
            let requirement =
                RequirementFile::from_json(json.as_bytes(), &[], lists).expect("a requirement");
            let report = DesignReport::standard(&requirement, catalog).expect("sizes");
            if !report.found {
                assert!(!report.reasons.is_empty(), "{json}");
                continue;
            }
            found += 1;
            let written = report.case.to_json().to_string();
            let case = Case::from_json(written.as_bytes()).expect("a case");
            let sheet = AxisReport::of(&case, &Settings::default()).expect("an axis");
            assert!(sheet.passes(), "{json}: {:?}", sheet.answer.rules);
            for warning in &sheet.warnings {
                assert!(report.warnings.contains(&warning.text), "{json}: {warning:?}");
                let is_allowed = warning.limit.is_none_or(SelectionLimit::can_be_allowed);
                assert!(is_allowed, "{json}: {warning:?}");
            }
        }
    }
    // Without this check, the test would pass even if no screw met any requirement.
    assert!(found >= 10, "{found}");
}

/// An audit found that the lightest screw for a length of 1100 mm was an 8 x 12 mm screw, which
/// manufacturers only list up to 250 mm.
#[test]
fn no_screw_longer_than_the_listed_lengths_is_selected() {
    let catalog = Catalog::manufacturers().expect("compiled in");
    let json = &requirements_of_machine_builders()[0];
    let requirement = RequirementFile::from_json(json.as_bytes(), &[], catalog.lists.clone());
    let report = DesignReport::standard(&requirement.expect("a requirement"), &catalog);
    let report = report.expect("sizes");
    assert!(report.found, "{:?}", report.reasons);
    let row = report.rows.iter().find(|row| row.name == "unsupported_length_mm").expect("a limit");
    assert!(row.passes && row.requirement.is_some(), "{row:?}");
    assert!(report.case.nominal_diameter_mm.is_some_and(|mm| mm >= 14.0), "{:?}", report.case);
}

/// A usability test found that the order data stated a nominal diameter of 16 mm for the chosen
/// size 15 x 10 mm, because 16 mm is closer to the pitch circle diameter of 15.75 mm.
#[test]
fn selected_case_and_order_data_state_the_nominal_diameter_of_the_catalog_size() {
    let catalog = Catalog::manufacturers().expect("compiled in");
    let json = br#"{"moved_mass_kg":7,"inclination_deg":90,"stroke_mm":1100,"required_life_h":2000,"objective":"mass",
        "support":"fixed-supported","cycle":[{"time_s":1,"feed_mm_s":100},{"time_s":1,"feed_mm_s":-100}]}"#;
    let requirement = RequirementFile::from_json(json, &[], catalog.lists.clone());
    let requirement = requirement.expect("a requirement");
    let report = DesignReport::standard(&requirement, &catalog).expect("sizes");
    let Case { nominal_diameter_mm, pitch_circle_diameter_mm, lead_mm, .. } = report.case;
    let chosen = (nominal_diameter_mm, pitch_circle_diameter_mm, lead_mm);
    assert_eq!(chosen, (Some(15.0), Some(15.75), Some(10.0)));
    let order = report.order.expect("a screw");
    assert!(order.starts_with("THK, 15 x 10 mm, 2 x 2.8 turns"), "{order}");
    // THK does not publish the ball diameter of this size.
    assert!(report.notes.iter().any(|note| note.contains("ball diameter is an estimate")));
    // Standard lists state the nominal diameter, too.
    let lists = Catalog::standard().expect("compiled in");
    let requirement = RequirementFile::from_json(json, &[], lists.lists.clone());
    let standard = DesignReport::standard(&requirement.expect("a requirement"), &lists);
    let standard = standard.expect("sizes");
    let nominal = standard.case.nominal_diameter_mm.expect("a listed size");
    assert!(lists.lists.diameters.iter().any(|listed| (listed * 1e3 - nominal).abs() < 1e-9));
    let order = standard.order.expect("a screw");
    assert!(order.starts_with(&format!("{nominal} x ")), "{order}");
}

/// A usability test found that a list of sizes could be sorted by the mass of the nut, but not by
/// the mass of nut and screw together.
#[test]
fn list_of_sizes_is_sorted_by_the_mass_of_nut_and_screw() {
    let catalog = Catalog::manufacturers().expect("compiled in");
    let requirement = RequirementFile::from_json(
        br#"{"axial_load_N": 500, "feed_m_min": 6, "stroke_mm": 300, "required_life_h": 1000}"#,
        &[],
        catalog.lists.clone(),
    );
    let (columns, name) = (ListColumn::of_sizes(true), "mass_of_nut_and_screw_kg");
    let filter = NutFilter::new(&["nominal_diameter_mm=20".to_owned()], &columns, false)
        .and_then(|filter| filter.sorted_by(name, false, &columns))
        .expect("columns");
    let list = filter.choose(catalog, Some(&requirement.expect("a requirement")));
    let values = list.values(0..list.chosen.len());
    let of = |name: &str| {
        let place = list.columns().iter().position(|column| column.name == name);
        match &values[place.expect("a column")] {
            ColumnValues::Numbers(values) => values.clone(),
            ColumnValues::Texts(_) => panic!("{name} is text"),
        }
    };
    let both = of(name);
    assert!(both.len() > 5 && both.is_sorted(), "{both:?}");
    for ((nut, screw), both) in of("nut_mass_kg").iter().zip(of("screw_mass_kg")).zip(both) {
        // The sizes of the case are rounded to 12 digits.
        assert!((nut + screw - both).abs() < 1e-9 * both, "{nut} {screw} {both}");
    }
}

/// An audit found that, for the case of a selected screw, `nut` ignored the duty cycle and assumed
/// a preloaded pair.
#[test]
fn nut_results_for_a_load_cycle_match_the_axis_sheet() {
    for (preload, is_pair) in [("", false), (r#","preload_N":2000"#, true)] {
        let json = format!(
            r#"{{"ball_diameter_mm":6.35,"pitch_circle_diameter_mm":41.5,"lead_mm":10,"contact_angle_deg":45,
            "nut_conformity":0.52,"screw_conformity":0.52,"loaded_balls_per_turn":18,"loaded_turns":4,
            "friction_coefficient":0.06,"moved_mass_kg":300,"guide_friction":0.02,"stroke_mm":500{preload},
            "cycle":[{{"time_s":2,"force_N":500,"feed_m_min":10}},{{"time_s":1,"force_N":6000,"feed_m_min":3}}]}}"#
        );
        let case = Case::from_json(json.as_bytes()).expect("a case");
        let sheet = AxisReport::of(&case, &Settings::default()).expect("an axis");
        let nut = NutProblem::of(&case, &Settings::default()).expect("a nut");
        let notes = nut.solve().expect("a solution").notes();
        assert!(notes[0].contains("largest load: 6058.8 N at 300 rpm"), "{notes:?}");
        let nut = NutProblem::of(&case, &Settings::default()).expect("a nut").solve().expect("one");
        // The commands `axis` and `nut` solve the same nut problem, so the stiffnesses are equal.
        let stiffness = sheet.number(output!(nut_stiffness_at_largest_load_N_um));
        assert_eq!(nut.number(output!(nut_stiffness_N_um)), stiffness);
        assert_eq!(nut.number(output!(cold_preload_N)).is_some(), is_pair);
    }
    let idle = br#"{"ball_diameter_mm":6.35,"pitch_circle_diameter_mm":41.5,"lead_mm":10,"contact_angle_deg":45,
        "nut_conformity":0.52,"screw_conformity":0.52,"loaded_balls_per_turn":18,"loaded_turns":4,
        "cycle":[{"time_s":2,"feed_m_min":10}]}"#;
    let idle = Case::from_json(idle).expect("a case");
    let error = NutProblem::of(&idle, &Settings::default()).expect_err("no load").to_string();
    assert!(error.contains("no load acts on the screw"), "{error}");
}
