//! Tests of screws for which only the ratings are known, and of accuracy grades.

use std::f64::consts::TAU;

use approx::assert_relative_eq;
use bsm_case::{
    AxisReport, Case, CaseError, Catalog, ColumnValues, Content, ManufacturerNut, ManufacturerRow,
    NutProblem, Output, Record, RequirementFile, Settings, TableFormat, Verdict, output,
};
use bsm_dyn::ModelWorkspace;
use serde_json::json;

use crate::named;

/// A case that contains four catalog values of a screw and the motion of its axis.
const FOUR: &str = r#"{"nominal_diameter_mm": 40, "lead_mm": 20, "rated_dynamic_load_N": 52000, "rated_static_load_N": 88000, "estimate_groove": false,
    "axial_load_N": 5000, "feed_m_min": 10, "stroke_mm": 1000}"#;

fn sheet(case: &str, settings: &[&str]) -> Result<AxisReport, CaseError> {
    let mut case = Case::from_json(case.as_bytes())?;
    case.apply(settings)?;
    AxisReport::of(&case, &Settings::default())
}

fn number(report: &AxisReport, name: &str) -> f64 {
    report.number(named(name)).unwrap_or_else(|| panic!("no {name}"))
}

fn has_note(report: &AxisReport, words: &str) -> bool {
    report.answer.notes.iter().any(|note| note.contains(words))
}

/// An audit found that the catalog data "40 x 20, 52 kN, 88 kN" could not be entered. The axis
/// sheet must contain every result that can be calculated without the groove, and must list each
/// omitted result once.
#[test]
fn four_catalog_values_suffice_for_an_axis_sheet() {
    let report = sheet(FOUR, &[]).expect("a sheet");
    // The life is (C_a/F)³ million revolutions, apart from rounding errors.
    let life = (52.0_f64 / 5.0).powi(3) * 1e6;
    assert_relative_eq!(number(&report, "cycle_life_revolutions"), life, max_relative = 1e-12);
    assert_relative_eq!(number(&report, "static_safety_factor"), 17.6, max_relative = 1e-12);
    for name in [
        "critical_speed_ratio",
        "buckling_safety",
        "yield_load_N",
        "screw_mass_kg",
        "rms_motor_torque_Nm",
    ] {
        number(&report, name);
    }
    // Without preload and seals, the screw torque at an efficiency of 0.9 is F h/0.9, with h = lead
    // / (2 pi).
    let torque = 5000.0 * 0.02 / TAU / 0.9;
    assert_relative_eq!(number(&report, "screw_torque_Nm"), torque, max_relative = 1e-12);
    assert_eq!(report.phases[0].contacts, "catalog efficiency");
    for absent in ["cycle_life_by_balls_h", "nut_stiffness_at_largest_load_N_um", "limit_load_N"] {
        assert_eq!(report.number(named(absent)), None, "{absent}");
    }
    let left_out = report.answer.notes.iter().filter(|note| note.contains("omitted")).count();
    assert_eq!(left_out, 1, "{:?}", report.answer.notes);
    // The core diameters of 40 x 20 screws are taken from the lists of THK and HIWIN.
    for estimated in
        ["shaft_diameter_mm", "pitch_circle_diameter_mm", "screw_mass_kg_m", "nut_length_mm"]
    {
        assert!(
            has_note(&report, &format!("{estimated} ")),
            "{estimated}: {:?}",
            report.answer.notes
        );
    }
    assert!(has_note(&report, "smallest core diameter in manufacturers' lists"));
    // For a size that is not listed, the core diameter is estimated as 0.84 times the nominal
    // diameter of 41 mm.
    let unlisted = sheet(FOUR, &["nominal_diameter_mm=41"]).expect("a sheet");
    assert_relative_eq!(number(&unlisted, "shaft_diameter_mm"), 34.44, max_relative = 1e-12);
    // If the load drives the screw, the default efficiency is 0.8. Given efficiencies take
    // precedence.
    let back = sheet(FOUR, &["feed_m_min=-10", "catalog_back_efficiency=0.7"]).expect("a sheet");
    let torque = 0.7 * 5000.0 * 0.02 / TAU;
    assert_relative_eq!(number(&back, "screw_torque_Nm"), torque, max_relative = 1e-12);
    // A catalog stiffness K is used only if its reference load is given. The stiffness is then 0.8
    // K (F/0.3 C_a)^(1/3).
    let stiff =
        sheet(FOUR, &["rated_rigidity_N_um=600", "rated_rigidity_at=0.3 Ca"]).expect("a sheet");
    let expected = 480.0 * (5000.0_f64 / 15_600.0).cbrt();
    let name = "nut_stiffness_at_largest_load_N_um";
    assert_relative_eq!(number(&stiff, name), expected, max_relative = 1e-12);
    let why = sheet(FOUR, &["rated_rigidity_N_um=600"]).expect_err("where").to_string();
    assert!(why.contains("rated_rigidity_at"), "{why}");
}

/// The axis sheet explains why results that need the groove are omitted.
#[test]
fn axis_sheet_explains_why_results_are_omitted_if_the_groove_is_unknown() {
    let case = Case::from_json(FOUR.as_bytes()).expect("a case");
    let settings = Settings::default();
    let refused = [
        case.problem(&settings).map(|_| ()).expect_err("solve"),
        NutProblem::of(&case, &settings).map(|_| ()).expect_err("nut"),
        bsm_case::ratings(&case).map(|_| ()).expect_err("ratings"),
    ];
    for why in refused.map(|why| why.to_string()) {
        assert!(
            why.contains("only the ratings are known") && why.contains("contact_angle_deg"),
            "{why}"
        );
    }
    let partly = sheet(FOUR, &["contact_angle_deg=45"]).expect("a sheet");
    assert!(has_note(&partly, "not given in full"), "{:?}", partly.answer.notes);
    let other = sheet(FOUR, &["shaft_diameter_mm=90"]).expect_err("another screw").to_string();
    assert!(other.contains("nominal_diameter_mm"), "{other}");
}

/// Compares outputs of an axis sheet with printed values, with a tolerance of half a unit in the
/// last printed digit.
fn assert_printed_values(report: &AxisReport, values: &[(&str, &str)]) {
    for (name, text) in values {
        assert_printed_value(number(report, name), text, name);
    }
}

fn assert_printed_value(ours: f64, text: &str, name: &str) {
    let value: f64 = text.parse().expect("a number");
    let (digits, power) = text.split_once('e').unwrap_or((text, "0"));
    let decimals = digits.split_once('.').map_or("", |(_, decimals)| decimals);
    let decimals = i32::try_from(decimals.len()).expect("few");
    let half = 0.5 * 10_f64.powi(power.parse::<i32>().expect("a power") - decimals);
    // The tolerance is increased by one millionth to allow for rounding errors.
    assert!((ours - value).abs() <= half * (1.0 + 1e-6), "{name}: {ours}, printed {text}");
}

/// The feed axis of a machining center is example E of the specification. Its values were
/// calculated independently with the catalog efficiency: preload, torques, heat, and the screw
/// tension that remains from a pretension of 3 K.
#[test]
fn machining_center_with_catalog_data_matches_the_reference() {
    let report = sheet(FEED_AXIS, &[r#"preload_N="auto""#]).expect("a sheet");
    assert_printed_values(&report, &[("cold_preload_N", "2500"), ("preload_torque_percent", "30")]);
    for (name, expected) in [
        ("screw_torque_Nm", ["13.399", "6.3257", "1.9047", "1.9047"]),
        ("heat_W", ["23.650", "48.727", "232.25", "232.25"]),
    ] {
        for (phase, expected) in report.phases.iter().zip(expected) {
            assert_printed_value(
                phase.number(named(name)).expect("a number").abs(),
                expected,
                name,
            );
        }
    }
    // When warm, the screw is compressed between its bearings. The pretension is 6605.3 N for 3 K.
    // The temperature rise of 13.979 K from the thermal network was calculated independently.
    let pressed = 6605.3 / 3.0 * 13.979_30 - 6605.3;
    // Each number in this hand calculation has five digits.
    let safety = 265_885.0 / (7000.0 + pressed);
    assert_relative_eq!(number(&report, "buckling_safety"), safety, max_relative = 3e-5);
    let slack = report.answer.rules.iter().find(|rule| rule.title == "remaining pretension");
    let help = slack.and_then(|rule| rule.remedy.as_deref()).expect("it is slack");
    assert!(help.contains("above a temperature rise of 3.0 K"), "{help}");
    assert!(report.order.to_string().contains("preload 2500 N, C3"), "{}", report.order);
    assert!(
        report.order.to_string().contains("T_p0 0.72 N m +-30 %, T = -0.035/1000"),
        "{}",
        report.order
    );
}

/// The vertical axis with a rolled screw is example F of the specification. `bsm validate` checks
/// the values of this example.
#[test]
fn vertical_axis_with_catalog_data_matches_the_reference() {
    let report = sheet(UPRIGHT, &[]).expect("a sheet");
    assert!(report.answer.notes.iter().any(|note| note.contains("a brake is needed")));
}

/// Screw of example F in the specification.
const UPRIGHT: &str =
    include_str!("../../../../validation/published/manufacturers/upright_axis.json");

/// The drag torque that is measured to verify the preload matches THK BNFN4010-5, THK A-689
/// (example C), for grade C3, a preload of 3000 N and a thread of 1300 mm. THK prints 0.865 N m, 30
/// %, and 0.606 to 1.125 N m, calculated with rounded numbers.
#[test]
fn preload_torque_matches_the_thk_catalog() {
    let report =
        sheet(FEED_AXIS, &["preload_N=3000", "unsupported_length_mm=1300"]).expect("a sheet");
    let (torque, share) = (number(&report, "preload_torque_measured_Nm"), 3000.0 * 0.01 / TAU);
    assert_printed_value(torque, "0.864599", "torque");
    assert_printed_value(torque / share, "0.181081", "K_p");
    assert_printed_value((0.05 * share / torque).powi(2), "0.076242", "tan beta");
    assert_printed_values(
        &report,
        &[
            ("preload_torque_percent", "30"),
            ("preload_torque_measured_low_Nm", "0.605219"),
            ("preload_torque_measured_high_Nm", "1.123978"),
        ],
    );
}

/// Screw THK BNFN4010-5, described only by its ratings.
const FEED_AXIS: &str =
    include_str!("../../../../validation/published/manufacturers/machining_center.json");

/// If the groove is given in addition to the ratings, it must match the rated nut. If the
/// calculated and the given rating differ by a factor of 1.7, a warning is given. If they differ by
/// a factor of 2.1, the case is rejected unless the user confirms the ratings.
#[test]
fn contradiction_between_ratings_and_groove_is_reported() {
    let groove = include_str!("../../../../examples/axis.json");
    let own = sheet(groove, &["preload_N=1"]).expect("a sheet");
    let of_nut = bsm_case::ratings(&Case::from_json(groove.as_bytes()).expect("an example"));
    let rating = of_nut.expect("a nut").number(output!(static_load_rating_N)).expect("a rating");
    let stated = |times: f64, more: &[&str]| {
        let setting = format!("rated_static_load_N={}", rating / times);
        sheet(groove, &[&["preload_N=1", &*setting], more].concat())
    };
    let warned =
        |report: &AxisReport| report.answer.warnings.iter().any(|w| w.contains("rated nut"));
    assert!(!warned(&own) && !warned(&stated(1.2, &[]).expect("usual")));
    let other = stated(1.7, &[]).expect("a sheet");
    assert!(other.answer.warnings.iter().any(|w| w.contains("(1.70 times the given value)")));
    let why = stated(2.1, &[]).expect_err("another nut").to_string();
    assert!(why.contains("keep_ratings"), "{why}");
    assert!(warned(&stated(2.1, &["keep_ratings=true"]).expect("as meant")));
}

/// If a row of a manufacturer's table contains only ratings, the nut is checked with the same axis
/// sheet as the other nuts.
#[test]
fn manufacturer_table_may_contain_only_ratings() {
    let table = b"nut,nominal_diameter_mm,lead_mm,dynamic_load_rating_N,static_load_rating_N,core_diameter_mm
small,40,20,52000,88000,34\nlarge,50,20,80000,150000,44";
    let nuts = ManufacturerNut::from_csv(table, &TableFormat::default()).expect("ratings suffice");
    let catalog = Catalog::standard().expect("compiled in");
    let requirement =
        br#"{"axial_load_N": 5000, "feed_m_min": 10, "stroke_mm": 1000, "required_life_h": 20000}"#;
    let requirement =
        RequirementFile::from_json(requirement, &[], catalog.lists).expect("a requirement");
    let rows = ManufacturerRow::all(&nuts, Some(&requirement)).expect("sheets");
    // A load of 5 kN at 500 rpm gives a life of at least 37 497 h.
    assert!(rows.iter().all(|row| row.verdict == Some(Verdict::Passes)), "{rows:?}");
    assert_eq!(rows.iter().map(|row| &*row.name).collect::<Vec<_>>(), ["small", "large"]);
    let small = AxisReport::of(&rows[0].case, &Settings::default()).expect("a sheet");
    for name in ["cycle_life_h", "screw_mass_kg", "buckling_safety"] {
        assert_eq!(rows[0].value(named(name)), small.number(named(name)), "{name}");
    }
    assert_relative_eq!(number(&small, "shaft_diameter_mm"), 34.0, max_relative = 1e-12);
    // The rows are sorted by the mass of screw and nut together. The screw and nut masses are about
    // 10 and 30 kg in one row, and 17 and 2 kg in the other row.
    let mut heavy = nuts;
    heavy[0].case.nut_mass_kg = Some(30.0);
    heavy[1].case.nut_mass_kg = Some(2.0);
    let rows = ManufacturerRow::all(&heavy, Some(&requirement)).expect("sheets");
    let masses: Vec<_> =
        rows.iter().map(|row| (&*row.name, row.value(output!(nut_mass_kg)))).collect();
    assert_eq!(masses, [("large", Some(2.0)), ("small", Some(30.0))]);
    for row in &rows {
        let [nut, screw, both] =
            [output!(nut_mass_kg), output!(screw_mass_kg), output!(mass_of_nut_and_screw_kg)]
                .map(|name| row.value(name).expect("a mass"));
        assert_relative_eq!(nut + screw, both, max_relative = 1e-12);
    }
}

/// A usability test found that a list of nuts did not name the rules that were violated.
#[test]
fn failing_table_rows_name_the_failed_rules() {
    let table = b"nut,nominal_diameter_mm,lead_mm,dynamic_load_rating_N,static_load_rating_N,core_diameter_mm
weak,40,20,12000,7000,34\nstrong,50,20,80000,150000,44";
    let nuts = ManufacturerNut::from_csv(table, &TableFormat::default()).expect("ratings suffice");
    let catalog = Catalog::standard().expect("compiled in");
    let requirement =
        br#"{"axial_load_N": 5000, "feed_m_min": 10, "stroke_mm": 1000, "required_life_h": 20000}"#;
    let requirement =
        RequirementFile::from_json(requirement, &[], catalog.lists).expect("a requirement");
    let rows = ManufacturerRow::all(&nuts, Some(&requirement)).expect("sheets");
    let failed: Vec<_> = rows.iter().map(|row| (&*row.name, &row.failed_rules[..])).collect();
    assert_eq!(failed, [("strong", &[][..]), ("weak", &["static safety", "life"])]);
    let rows: Vec<_> = rows.iter().collect();
    let columns = ManufacturerRow::table(&rows);
    let (.., cells) = columns.iter().find(|(name, ..)| name == "failed_rules").expect("a column");
    let texts = ColumnValues::Texts(vec![None, Some("static safety; life".to_owned())]);
    assert_eq!(*cells, texts);
    let answer = ManufacturerRow::answer(&rows, 2, |_| true);
    let Content::Table(shown) = &answer.sections[0].content else { panic!("{answer:?}") };
    let heads: Vec<_> = shown.columns.iter().filter_map(|column| column.head.as_deref()).collect();
    assert!(heads.contains(&"failed rules"), "{heads:?}");
    assert_eq!(answer.to_json()[1]["failed_rules"], json!(["static safety", "life"]));
}

/// A usability test found that the column `stiffness_N_um` of a table had no effect on the axis.
/// Tables state the stiffness at 0.3 of the dynamic load rating, so the stiffness of the nut is 0.8
/// K (F/0.3 C_a)^(1/3).
#[test]
fn axis_stiffness_includes_the_nut_stiffness_from_a_manufacturer_table() {
    let catalog = Catalog::standard().expect("compiled in");
    let requirement = br#"{"axial_load_N": 2000, "feed_m_min": 6, "stroke_mm": 500}"#;
    let requirement =
        RequirementFile::from_json(requirement, &[], catalog.lists).expect("a requirement");
    let row = |heads: &str, cells: &str| {
        let table = format!(
            "nut,nominal_diameter_mm,lead_mm,ball_diameter_mm,loaded_turns,rated_dynamic_load_N,rated_static_load_N{heads}\n\
             SFU2510-4,25,10,4.762,4,28969,71540{cells}"
        );
        let nuts = ManufacturerNut::from_csv(table.as_bytes(), &TableFormat::default());
        let rows = ManufacturerRow::all(&nuts.expect("a row"), Some(&requirement));
        rows.expect("a sheet").remove(0)
    };
    let stiffness =
        |row: &ManufacturerRow| row.value(output!(axis_stiffness_N_um)).expect("a number");
    let stated = row(",stiffness_N_um", ",490");
    assert_eq!(stated.value(output!(stiffness_N_um)), Some(490.0));
    let sheet = AxisReport::of(&stated.case, &Settings::default()).expect("a sheet");
    let of_nut = 0.8 * 490.0 * (2000.0_f64 / (0.3 * 28969.0)).cbrt();
    let name = "nut_stiffness_at_largest_load_N_um";
    assert_relative_eq!(number(&sheet, name), of_nut, max_relative = 1e-12);
    assert_relative_eq!(
        number(&sheet, "axis_stiffness_N_um"),
        stiffness(&stated),
        max_relative = 1e-12
    );
    // The stated stiffness does not depend on the estimated groove.
    assert_eq!(stated.band(output!(axis_stiffness_N_um)), None);
    let estimated = row("", "");
    assert!(
        stiffness(&estimated) > stiffness(&stated)
            && estimated.value(output!(stiffness_N_um)).is_none()
    );
    // The inputs `rated_rigidity_N_um` and `rated_rigidity_at` are equivalent to the column
    // `stiffness_N_um`.
    let by_input = row(",rated_rigidity_N_um,rated_rigidity_at", ",490,0.3 Ca");
    assert_eq!(by_input.value(output!(stiffness_N_um)), Some(490.0));
    assert_eq!(stiffness(&by_input).to_bits(), stiffness(&stated).to_bits());
}

/// A usability test found that the remedy for a motor torque did not state the permitted load, but
/// recommended less acceleration for an axis without acceleration.
#[test]
fn remedy_for_excessive_motor_torque_states_the_permitted_load() {
    let lift = r#"{"nominal_diameter_mm": 16, "lead_mm": 5, "rated_dynamic_load_N": 13000, "estimate_groove": false,
        "seal_torque_Nm": 0.1, "feed_m_min": 1.5, "axial_load_N": 3000}"#;
    let rule = |load: &str, limit: &str, title: &str| {
        let report = sheet(lift, &[load, limit]).expect("a sheet");
        let found = report.answer.rules.iter().find(|rule| rule.title == title).cloned();
        found.expect("a rule")
    };
    // The torque is h F/0.9 + 0.1 N m, with h = lead / (2 pi).
    let most = ((1.9 - 0.1) * 0.9 * TAU / 5e-3).floor();
    for (limit, title) in [
        ("motor_peak_torque_Nm=1.9", "peak torque of the motor"),
        ("motor_rated_torque_Nm=1.9", "rated torque of the motor"),
    ] {
        let remedy = rule("axial_load_N=3000", limit, title).remedy.expect("a remedy");
        let load = format!("an axial load of at most {most} N instead of 3000 N");
        assert_eq!(remedy, format!("a larger motor, a smaller lead, or {load}"));
        assert!(rule(&format!("axial_load_N={most}"), limit, title).passes());
        assert!(!rule(&format!("axial_load_N={}", most + 1.0), limit, title).passes());
    }
    let cycle = r#"cycle=[{"distance_mm": 300, "time_s": 1, "profile": "trapezoidal", "force_N": 3000}, {"distance_mm": -300, "time_s": 1, "profile": "trapezoidal", "force_N": 3000}]"#;
    let moved =
        sheet(lift, &[cycle, "stroke_mm=300", "moved_mass_kg=10", "motor_peak_torque_Nm=1.9"]);
    let moved = moved.expect("a sheet");
    let rules = &moved.answer.rules;
    let remedy = rules.iter().find(|rule| rule.title == "peak torque of the motor");
    let remedy = remedy.and_then(|rule| rule.remedy.clone()).expect("a remedy");
    assert!(remedy.ends_with(", or less acceleration"), "{remedy}");
}

/// The travel error is limited by the accuracy grade. For C3 over 1 m, it is 21 + 15/2 um, which
/// exceeds the required 25 um. The sheet suggests a sufficient grade. If the standard contains no
/// value, the rule is violated.
#[test]
fn travel_error_is_checked_by_a_rule() {
    let of = |settings: &[&str]| sheet(FEED_AXIS, settings).expect("a sheet");
    let rule = |report: &AxisReport| {
        let found = report.answer.rules.iter().find(|rule| rule.title == "travel error").cloned();
        found.map(|rule| (rule.passes(), rule.remedy.unwrap_or_default()))
    };
    let c3 = of(&[]);
    for (name, um) in [
        ("travel_deviation_um", 21.0),
        ("travel_variation_um", 15.0),
        ("travel_variation_300_um", 8.0),
        ("travel_variation_2pi_um", 6.0),
        ("travel_error_worst_um", 28.5),
    ] {
        assert_relative_eq!(number(&c3, name), um, max_relative = 1e-12);
    }
    assert_eq!(rule(&c3), None);
    assert_eq!(rule(&of(&["required_travel_error_um=28.5"])), Some((true, String::new())));
    let failed = rule(&of(&["required_travel_error_um=25"]));
    assert_eq!(failed, Some((false, "accuracy_grade C2".to_owned())));
    let long = of(&["required_travel_error_um=500", "accuracy_grade=P3", "useful_travel_mm=5001"]);
    assert_eq!(rule(&long).map(|(passes, _)| passes), Some(false));
    assert!(
        has_note(&long, "P3 specifies no v_up for a travel of 5001 mm"),
        "{:?}",
        long.answer.notes
    );
}

/// Feed axis of a machining center, with its oil and load factors. `bsm validate` checks the lives
/// of this axis.
const OILED_AXIS: &str =
    include_str!("../../../../validation/published/manufacturers/machining_center_oil.json");

/// Lubricant and contamination modify the life. The smaller of the basic life and the modified life
/// must exceed the required life.
#[test]
fn life_is_modified_by_load_factors_and_lubricant() {
    let of = |settings: &[&str]| sheet(OILED_AXIS, settings).expect("a sheet");
    let typical = of(&["contamination=typical"]);
    let ratios =
        typical.phases.iter().map(|phase| phase.number(output!(viscosity_ratio)).expect("oil"));
    for (ours, expected) in ratios.zip(["0.232075", "0.577615", "2.27061", "2.27061"]) {
        assert_printed_value(ours, expected, "viscosity ratio");
    }
    // The modified life is also available as a column. A contamination class can replace the
    // contamination factor.
    let mut case = Case::from_json(OILED_AXIS.as_bytes()).expect("a case");
    case.apply(&["contamination=typical"]).expect("a class");
    let column = Output::named("modified_life_h").expect("a column");
    column.check(&case, case.stated(), Settings::default().model).expect("a life");
    let factor = of(&["contamination_factor=0.2", "reliability_percent=95"]);
    assert_eq!(
        factor.number(output!(modified_life_low_h)),
        factor.number(output!(modified_life_h))
    );
    // The load factor does not affect static safety, buckling or torque.
    for name in ["static_safety_factor", "buckling_safety", "peak_motor_torque_Nm"] {
        let plain = sheet(FEED_AXIS, &[]).expect("a sheet");
        assert_eq!(typical.number(named(name)), plain.number(named(name)), "{name}");
    }
    let passes = |hours: &str| {
        let report = of(&["contamination=typical", hours]);
        let rules = report.answer.rules.iter().filter(|rule| rule.title.contains("life"));
        rules.map(|rule| (rule.title, rule.passes())).collect::<Vec<_>>()
    };
    assert_eq!(passes("required_life_h=20000"), [("life", true), ("modified life", true)]);
    assert_eq!(passes("required_life_h=30000"), [("life", true), ("modified life", false)]);
    // If only contamination or only the lubricant is given, the life is not modified, and a note
    // says so. If the oil is too thin for a modification factor, the rule for the required life is
    // violated.
    assert!(has_note(&of(&[]), "contamination is not given"));
    let dry = sheet(FEED_AXIS, &["contamination=high"]).expect("a sheet");
    assert!(
        has_note(&dry, "viscosity and lubricant_temperature_C are not given")
            && dry.number(output!(modified_life_h)).is_none()
    );
    let thin = [
        "viscosity_40C_mm2_s=5",
        "viscosity_100C_mm2_s=2",
        "contamination=high",
        "required_life_h=1",
    ];
    let thin = sheet(OILED_AXIS, &thin).expect("a sheet");
    assert!(
        has_note(&thin, "below 0.1")
            && thin.number(output!(modified_life_h)).is_none()
            && !thin.passes()
    );
    let both =
        sheet(FEED_AXIS, &["contamination=high", "contamination_factor=1"]).expect_err("both");
    assert!(both.to_string().contains("contamination_factor"), "{both}");
}

/// If groove and roughness are known, the viscosity ratio is the smaller of the two film thickness
/// ratios, at the nut and at the screw, raised to the power of 1.3. The expected film thickness is
/// calculated with the formulas of Hamrock and Dowson and the values of one ball.
#[test]
fn a_known_film_thickness_determines_the_viscosity_ratio() {
    let text = include_str!("../../../../validation/published/nut/feed_axis.json");
    let mut case = Case::from_json(text.as_bytes()).expect("a case");
    case.apply(&["warm_state=false", "lubricant_temperature_C=40"]).expect("inputs");
    case.preload_N = None;
    let settings = Settings::default();
    let problem = case.problem(&settings).expect("one ball");
    let record = Record::new(problem.solve(&mut ModelWorkspace::default()));
    let of = |name: &str| record.number(named(name)).unwrap_or_else(|| panic!("no {name}"));
    let (ball, pitch, modulus) = (3.175e-3, 20.668e-3, 207e9 / 0.91);
    let least = ["nut", "screw"].map(|raceway| {
        let of = |name: &str| of(&format!("{raceway}_{name}"));
        let way = if raceway == "nut" { 1.0 } else { -1.0 };
        let cosine = of("contact_angle_deg").to_radians().cos();
        // 1/R_x = 1/r_b ∓ cosβ/(r_m ± r_b cosβ)
        let radius = ball * (1.0 + way * ball * cosine / pitch);
        let rate =
            record.number(output!(viscosity_mPas)).expect("oil") * 1e-3 * of("entrainment_m_s")
                / (modulus * radius);
        let stiffening =
            record.number(output!(pressure_viscosity_1_GPa)).expect("oil") * 1e-9 * modulus;
        let weight = of("normal_load_N") / (modulus * radius * radius);
        let aspect = of("ellipse_a_mm") / of("ellipse_b_mm");
        let film = |factor: f64, powers: [f64; 3], end: f64| {
            factor
                * rate.powf(powers[0])
                * stiffening.powf(powers[1])
                * weight.powf(powers[2])
                * end
        };
        let central = film(2.69, [0.67, 0.53, -0.067], 1.0 - 0.61 * (-0.73 * aspect).exp());
        let edge = film(3.63, [0.68, 0.49, -0.073], 1.0 - (-0.68 * aspect).exp());
        of("film_ratio") * edge / central
    });
    let expected = least[0].min(least[1]).powf(1.3);
    case.apply(&["contamination=normal"]).expect("a word");
    let report = AxisReport::of(&case, &settings).expect("a sheet");
    let ratio =
        |report: &AxisReport| report.phases[0].number(output!(viscosity_ratio)).expect("oil");
    // The radius of curvature along the helix is larger than R_x by sin²α, which is about 1 %. The
    // film thickness is proportional to this radius raised to an exponent of at most 0.02.
    assert_relative_eq!(ratio(&report), expected, max_relative = 3e-4);
    let film = number(&report, "modified_life_h");
    assert!(film > 0.0 && film < 50.0 * number(&report, "cycle_life_h"), "{film}");
    // On request, the viscosity ratio is calculated from the viscosity alone: ν/ν₁ according to
    // (Z38), for ISO VG 68 at 40 °C.
    case.apply(&["kappa_by=viscosity"]).expect("a word");
    let report = AxisReport::of(&case, &settings).expect("a sheet");
    let rpm = report.phases[0].number(output!(screw_speed_rpm)).expect("a speed").abs();
    let reference = if rpm < 1000.0 { 45e3 * rpm.powf(-0.83) } else { 4500.0 * rpm.powf(-0.5) };
    let expected = 68.0 / (reference * (2e3 * pitch).powf(-0.5));
    assert_relative_eq!(ratio(&report), expected, max_relative = 1e-12);
}

/// The expected values were calculated by hand. Manufacturers' ratings already include the effect
/// of the accuracy grade. A calculated rating is multiplied by 0.7 for grade 10, which reduces the
/// life to 0.343 of its value. A hardness of 50 HRC gives factors of (50/60)² and (50/60)³.
/// Catalogs recommend load factors of 1 to 1.2 at 10 m/min.
#[test]
fn rating_and_load_factors_match_hand_calculation() {
    let of = |settings: &[&str]| sheet(FOUR, settings).expect("a sheet");
    let plain = of(&[]);
    let rated = of(&["accuracy_grade=T10"]);
    assert_eq!(rated.number(output!(cycle_life_h)), plain.number(output!(cycle_life_h)));
    assert!(has_note(&rated, "the catalog value for grade T10"));
    let soft = of(&["hardness_HRC=50", "accuracy_factor=0.9", "steel=electro-slag"]);
    let near = |name: &str, expected: f64| {
        assert_relative_eq!(number(&soft, name), expected, max_relative = 1e-12);
    };
    near("modified_dynamic_rating_N", 52_000.0 * 0.9);
    near("modified_static_rating_N", 88_000.0 * 0.9 * (5.0_f64 / 6.0).powi(3));
    near("cycle_life_h", 0.729 * number(&plain, "cycle_life_h"));
    let both =
        sheet(FOUR, &["hardness_HRC=50", "hardness_HV10=500"]).expect_err("both").to_string();
    assert!(both.contains("hardness_HV10"), "{both}");
    // The life is (52/5)³ million revolutions at 500 rpm. With a load factor of 1.2, it is divided
    // by 1.2³.
    let lacks = plain.answer.lacks("cycle_life_h").unwrap_or_default();
    assert!(
        lacks.contains("recommend 1 to 1.2 at this speed, which gives lives of 21699 to 37495 h"),
        "{lacks}"
    );
    let shocks = of(&["load_factor=2"]);
    assert_relative_eq!(
        number(&shocks, "cycle_life_h"),
        number(&plain, "cycle_life_h") / 8.0,
        max_relative = 1e-12
    );
    assert_eq!(shocks.answer.lacks("cycle_life_h"), None);
    let groove = include_str!("../../../../examples/axis.json");
    let own = |grade: &str| sheet(groove, &["preload_N=1", grade]).expect("a sheet");
    let (fine, coarse) = (own("accuracy_grade=T5"), own("accuracy_grade=T10"));
    let ratio =
        number(&coarse, "modified_dynamic_rating_N") / number(&fine, "modified_dynamic_rating_N");
    assert_relative_eq!(ratio, 0.7, max_relative = 1e-12);
}

/// The life matches the example of THK, A-722 to A-735. With loads in both directions, each flank
/// has a life of 4.0868e9 revolutions, and both flanks together have 2.1901e9 revolutions. One
/// flank reaches 170 285 h.
#[test]
fn life_of_a_transfer_axis_matches_the_thk_catalog() {
    let ramp = |force: f64, feed: f64, acceleration: f64| {
        format!(
            r#"{{"time_s": 0.15, "force_N": {force}, "feed_m_min": {feed}, "acceleration_m_s2": {acceleration}}}"#
        )
    };
    let steady = |force: f64, feed: f64| {
        format!(r#"{{"time_s": 0.85, "force_N": {force}, "feed_m_min": {feed}}}"#)
    };
    let a = 1.0 / 0.15;
    let phases = [
        ramp(15.0, 60.0, a),
        steady(15.0, 60.0),
        ramp(15.0, 60.0, -a),
        ramp(-15.0, -60.0, -a),
        steady(-15.0, -60.0),
        ramp(-15.0, -60.0, a),
        r#"{"time_s": 5.2}"#.to_owned(),
    ];
    let case = format!(
        r#"{{"nominal_diameter_mm": 20, "lead_mm": 40, "rated_dynamic_load_N": 5400, "rated_static_load_N": 13600, "moved_mass_kg": 80,
            "guide_friction": 0.003, "load_factor": 1.5, "cycle": [{}]}}"#,
        phases.join(", ")
    );
    let report = sheet(&case, &[]).expect("a sheet");
    let loads =
        report.phases.iter().map(|phase| phase.number(output!(screw_load_N)).expect("a load"));
    for (ours, expected) in loads.zip([550.69, 17.354, -515.98, -550.69, -17.354, 515.98]) {
        // The expected values have five digits. The tolerance is half a unit of the last digit.
        assert_relative_eq!(ours, expected, max_relative = 5e-5);
    }
    let one_way = 1e6 * (5400.0 / number(&report, "equivalent_load_N")).powi(3);
    assert_relative_eq!(number(&report, "equivalent_load_N"), 337.75, max_relative = 2e-5);
    assert_relative_eq!(one_way, 4.0868e9, max_relative = 2e-5);
    assert_relative_eq!(number(&report, "cycle_life_revolutions"), 2.1901e9, max_relative = 3e-5);
    let hours =
        number(&report, "cycle_life_h") * one_way / number(&report, "cycle_life_revolutions");
    assert_relative_eq!(hours, 170_285.0, max_relative = 1e-5);
}

/// A usability test found that the label of F_m described it as the constant load with the same
/// life, although both flanks carried load. Hand calculation: half of all revolutions occur under 3
/// kN, the other half under -2 kN, so the equivalent loads are 3 kN and 2 kN divided by the cube
/// root of 2.
#[test]
fn life_follows_from_the_equivalent_loads_of_both_flanks() {
    let cycle = |second: f64| {
        let json = format!(
            r#"{{"nominal_diameter_mm": 40, "lead_mm": 20, "rated_dynamic_load_N": 52000, "rated_static_load_N": 88000, "load_factor": 1,
                "cycle": [{{"time_s": 1, "feed_m_min": 10, "force_N": 3000}}, {{"time_s": 1, "feed_m_min": -10, "force_N": {second}}}]}}"#
        );
        sheet(&json, &["estimate_groove=false"]).expect("a sheet")
    };
    let life = |report: &AxisReport| number(report, "cycle_life_revolutions");
    let of = |load: f64| 1e6 * (52000.0 / load).powi(3);
    let both = cycle(-2000.0);
    let names = ["equivalent_load_N", "equivalent_load_of_other_flank_N"];
    let loads = names.map(|name| number(&both, name));
    for (load, expected) in loads.into_iter().zip([3e3, 2e3]) {
        assert_relative_eq!(load, expected / 2.0_f64.cbrt(), max_relative = 1e-12);
    }
    let [one, other] = loads.map(of);
    let by_hand = (one.powf(-10.0 / 9.0) + other.powf(-10.0 / 9.0)).powf(-0.9);
    assert_relative_eq!(life(&both), by_hand, max_relative = 1e-12);
    // If only one flank carries load, its equivalent load is the constant load with the same life.
    let one_flank = cycle(2000.0);
    assert_eq!(one_flank.number(output!(equivalent_load_of_other_flank_N)), None);
    assert_relative_eq!(life(&one_flank), of(number(&one_flank, names[0])), max_relative = 1e-12);
}

/// A usability test found two errors. The axis sheet stated the torque for lowering instead of the
/// torque for lifting, because the load is the same in both phases and lowering comes later in the
/// cycle. The torque of a press was negative, because its feed is negative.
#[test]
fn axis_sheet_states_the_largest_screw_torque_at_the_largest_load() {
    let cycle = |phases: &str| {
        let json = format!(
            r#"{{"nominal_diameter_mm": 16, "lead_mm": 5, "rated_dynamic_load_N": 9000, "rated_static_load_N": 15000, "estimate_groove": false,
                "seal_torque_Nm": 0.15, "cycle": [{phases}]}}"#
        );
        sheet(&json, &[]).expect("a sheet")
    };
    let lift = r#"{"time_s": 1, "feed_m_min": 9, "force_N": 98}"#;
    let lower = r#"{"time_s": 1, "feed_m_min": -18, "force_N": 98}"#;
    for phases in [[lift, lower], [lower, lift]] {
        let report = cycle(&phases.join(","));
        // The torque is h F/0.9, with h = lead / (2 pi), plus the torque of the seals.
        let torque = 98.0 * 5e-3 / TAU / 0.9 + 0.15;
        assert_relative_eq!(number(&report, "screw_torque_Nm"), torque, max_relative = 1e-12);
        let efficiency = report.phases.iter().filter_map(|p| p.number(output!(screw_efficiency)));
        assert_eq!(report.number(output!(screw_efficiency)), efficiency.reduce(f64::max));
        let note =
            report.answer.notes.iter().find(|note| note.contains("typical efficiencies give"));
        // Usual efficiencies are 0.85 to 0.95.
        let range = [0.95, 0.85].map(|eta| 98.0 * 5e-3 / TAU / eta + 0.15);
        let range = format!("{:.3} to {:.3} N m", range[0], range[1]);
        assert!(note.is_some_and(|note| note.contains(&range)), "{note:?}, not {range}");
    }
    let press = cycle(r#"{"time_s": 1, "feed_m_min": -9, "force_N": -98}"#);
    let torque = press.phases[0].torque().expect("a torque");
    assert!(torque < 0.0, "{torque}");
    assert_relative_eq!(number(&press, "screw_torque_Nm"), -torque, max_relative = 1e-12);
    // The screw torque is positive if it acts against the load, even if the largest load occurs
    // only while the load is lowered.
    let heavy = r#"{"time_s": 1, "feed_m_min": -9, "force_N": 9800}"#;
    let torque = number(&cycle(heavy), "screw_torque_Nm");
    assert_relative_eq!(torque, 9800.0 * 5e-3 / TAU * 0.8 - 0.15, max_relative = 1e-12);
}

/// A constant process force on a horizontal axis has the same effect as an equal weight on a
/// vertical axis.
#[test]
fn constant_process_force_acts_like_a_weight() {
    let sheet = |more: &[&str]| sheet(UPRIGHT, more).expect("a sheet");
    let upright = sheet(&[]);
    // The process force equals the weight of a mass of 250 kg, which is 250 kg times 9.80665 m/s2.
    let level = sheet(&["moved_mass_kg=0", "inclination_deg=0", "hold_force_N=2451.6625"]);
    for name in [
        "holding_torque_frictionless_Nm",
        "required_brake_torque_Nm",
        "back_driving_torque_Nm",
        "back_driving_torque_low_Nm",
        "back_driving_torque_high_Nm",
    ] {
        let [a, b] = [&upright, &level].map(|sheet| sheet.number(named(name)).expect(name));
        // The values for the vertical and the horizontal axis differ only by rounding errors.
        assert!((a - b).abs() <= 1e-12 * a.abs(), "{name}: {a} {b}");
    }
}

/// The torque of a catalog screw does not depend on the speed. Without a speed, results that depend
/// on it must be omitted, not calculated for standstill.
#[test]
fn torque_is_calculated_without_a_speed() {
    let line = r#"{"nominal_diameter_mm": 16, "lead_mm": 5, "axial_load_N": 1000}"#;
    let torque = |settings: &[&str]| {
        let report = sheet(line, settings).expect("a sheet");
        (report.number(output!(peak_motor_torque_Nm)), report)
    };
    let (moving, _) = torque(&["screw_speed_rpm=100"]);
    let (unknown, report) = torque(&[]);
    assert_eq!(moving, unknown);
    // T = F P / (2 pi eta) with the catalog efficiency of 0.9.
    let expected = 1000.0 * 5e-3 / (2.0 * std::f64::consts::PI * 0.9);
    assert_relative_eq!(unknown.expect("a torque"), expected, max_relative = 1e-12);
    for omitted in [
        output!(largest_speed_rpm),
        output!(critical_speed_ratio),
        output!(peak_motor_power_W),
        output!(mean_heat_W),
    ] {
        assert_eq!(report.number(omitted), None, "{}", omitted.name());
    }
    let (_, tight) = torque(&["motor_peak_torque_Nm=0.82", "motor_max_speed_rpm=3000"]);
    let fails = |title: &str| tight.answer.rules.iter().any(|r| r.title == title && !r.passes());
    assert!(fails("peak torque of the motor"));
    assert!(!tight.answer.rules.iter().any(|rule| rule.title == "motor speed" && rule.passes()));
}

/// The drag of a preloaded nut does not depend on the speed if the friction coefficient is given, but
/// does depend on it if the friction is calculated from a lubricant.
#[test]
fn preload_torque_of_a_lubricated_nut_is_missing_without_a_speed() {
    let nut = r#"{"nominal_diameter_mm": 32, "lead_mm": 10, "rated_dynamic_load_N": 33400,
        "rated_static_load_N": 62100, "preload_N": 1500, "axial_load_N": 2000, "stroke_mm": 500}"#;
    let torque = |settings: &[&str]| {
        sheet(nut, settings).expect("a sheet").number(output!(preload_torque_Nm))
    };
    let oil = ["iso_vg=100", "lubricant_temperature_C=40"];
    assert!(torque(&["friction_coefficient=0.06"]).is_some());
    assert_eq!(torque(&oil), None);
    assert!(torque(&[oil[0], oil[1], "screw_speed_rpm=100"]).is_some());
}

#[test]
fn results_of_an_unknown_screw_are_missing_instead_of_nan() {
    let whirl = r#"{"shaft_diameter_mm": 25.4, "unsupported_length_mm": 2540,
        "support": "fixed-fixed", "screw_speed_rpm": 800}"#;
    let report = sheet(whirl, &[]).expect("a sheet");
    assert_eq!(report.number(output!(peak_motor_torque_Nm)), None);
    let text = format!("{} {:?}", report.order, report.answer.notes);
    assert!(!text.contains("NaN"), "{text}");
}
