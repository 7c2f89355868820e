//! Tests of cases with catalog data only, whose grooves are estimated from the load ratings.

use std::fs;
use std::path::Path;

use approx::assert_relative_eq;
use bsm_case::{
    Answer, AxisReport, Case, CaseError, ColumnValues, DRAWS, FEW_DRAWS, Fit, ListColumn,
    ManufacturerNut, ManufacturerRow, NutFilter, NutProblem, NutReport, Record, RequirementFile,
    Samples, Settings, Supplement, TableFormat, Verdict, comparison, output, ratings,
    with_groove_intervals,
};
use bsm_dyn::ModelWorkspace;
use serde_json::json;

use crate::named;

/// Screw SFU1605-4 of TBI, loaded with a tenth of its dynamic load rating.
const SFU1605: &str = r#"{"nominal_diameter_mm": 16, "lead_mm": 5, "rated_dynamic_load_N": 13533,
    "rated_static_load_N": 29930, "axial_load_N": 1353.3, "screw_speed_rpm": 500, "friction_coefficient": 0.08}"#;

/// Screw R40-20K4-FSC of HIWIN, loaded with a tenth of its dynamic load rating.
const R40: &str = r#"{"nominal_diameter_mm": 40, "lead_mm": 20, "rated_dynamic_load_N": 51300,
    "rated_static_load_N": 144400, "axial_load_N": 5130, "screw_speed_rpm": 500, "friction_coefficient": 0.08}"#;

fn case(text: &str, settings: &[&str]) -> Case {
    let mut case = Case::from_json(text.as_bytes()).expect("a case");
    case.apply(settings).expect("inputs");
    case
}

/// Returns the answer for the motion of one ball, with intervals over all possible grooves.
fn motion(case: &Case) -> Answer {
    let case = case.with_groove().expect("a groove");
    let settings = Settings::default();
    let answer = |case: &Case| -> Result<Answer, CaseError> {
        let record = Record::new(case.problem(&settings)?.solve(&mut ModelWorkspace::default()));
        Ok(record.answer("test", case, &settings, &Supplement::default()))
    };
    with_groove_intervals(&case, DRAWS, answer).expect("a solution")
}

fn groove_error(case: &Case) -> String {
    case.with_groove().expect_err("no groove").to_string()
}

/// A case with a complete groove is returned unchanged, so the estimate does not affect its
/// results. If diameter and ratings are also given, they have no effect.
#[test]
fn complete_grooves_are_not_changed_by_the_estimate() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let mut complete = 0;
    for entry in fs::read_dir(folder).expect("examples") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|ending| ending != "json") {
            continue;
        }
        let given = Case::read(&path).expect("an example");
        if given.nominal_diameter_mm.is_some() {
            continue;
        }
        assert_eq!(given.with_groove().expect("as given"), given, "{}", path.display());
        let stated = ["nominal_diameter_mm=40", "lead_mm=20", "rated_dynamic_load_N=51300"];
        let mut rated = given.clone();
        rated.apply(&stated).expect("inputs");
        // The incomplete groove of an example may contradict these ratings, and the example is then
        // skipped.
        let Ok(found) = rated.with_groove() else { continue };
        if !found.has_estimated_groove() {
            complete += 1;
            assert_eq!(found, rated, "{}", path.display());
        }
    }
    // The examples of feed drives, jamming and nuts all have complete grooves.
    assert!(complete >= 10, "{complete}");
}

/// The best groove for SFU1605-4 agrees with an independent implementation. If the case is written
/// to a file and read again, its groove is estimated again.
#[test]
fn groove_estimated_from_catalog_ratings_matches_an_independent_implementation() {
    let line = case(SFU1605, &[]);
    let found = line.with_groove().expect("a groove");
    assert_eq!(found.ball_diameter_mm, Some(3.175));
    assert_relative_eq!(
        found.pitch_circle_diameter_mm.expect("a pitch"),
        16.794,
        max_relative = 1e-4
    );
    let others = [found.nut_conformity, found.screw_conformity, found.contact_angle_deg];
    assert_eq!(others, [Some(0.52), Some(0.52), Some(45.0)]);
    assert_eq!([found.loaded_turns, found.loaded_balls_per_turn], [Some(4.0), Some(16.0)]);
    assert_eq!(found.entries.estimated_inputs.as_ref().map(Vec::len), Some(7));
    assert_eq!(found.without_estimates(), line);
    let again = Case::from_json(found.to_json().to_string().as_bytes()).expect("a case");
    assert_eq!(again.with_groove().expect("a groove"), found);
}

/// The rating for a travel of 100 km at a lead of 20 mm is (10^6 x 20 mm / 10^5 m)^(1/3) times the
/// rating for one million revolutions (BB8).
#[test]
fn travel_rating_and_equivalent_revolution_rating_give_the_same_groove() {
    let in_revolutions = case(R40, &[]).with_groove().expect("a groove");
    let stated = 51_300.0 / 5.0_f64.cbrt();
    let settings = [&format!("rated_dynamic_load_N={stated}"), "rating_basis=100 km"];
    let in_travel = case(R40, &settings).with_groove().expect("a groove");
    let [one, other] = [&in_revolutions, &in_travel].map(|case| {
        let report = AxisReport::of(case, &Settings::default()).expect("an axis");
        let life = report.number(output!(cycle_life_revolutions)).expect("a life");
        let rating = ratings(case).expect("ratings").number(output!(dynamic_load_rating_N));
        (case.ball_diameter_mm, life, rating.expect("a rating"))
    });
    assert_eq!(one.0, other.0);
    // The tolerance allows for the rounding error of the cube root.
    assert_relative_eq!(one.1, other.1, max_relative = 1e-12);
    assert_relative_eq!(one.2, other.2, max_relative = 1e-12);
}

#[test]
fn specified_input_replaces_its_estimate() {
    let mut found = case(SFU1605, &[]).with_groove().expect("a groove");
    found.apply(&["ball_diameter_mm=3", "nut_conformity=0.515"]).expect("inputs");
    let found = found.with_groove().expect("a groove");
    assert_eq!((found.ball_diameter_mm, found.nut_conformity), (Some(3.0), Some(0.515)));
    assert!(!found.estimates("ball_diameter_mm") && found.estimates("screw_conformity"));
    // The estimate for balls of 3.175 mm contains 64 balls. With smaller balls, the number is
    // larger, because N D_w² is constant.
    let balls = found.loaded_balls_per_turn.expect("balls") * found.loaded_turns.expect("turns");
    assert!((balls - 64.0 * (3.175_f64 / 3.0).powi(2)).abs() < 2.0, "{balls}");
}

/// The intervals agree with the intervals of an independent implementation for the same 128 grooves
/// to within 1 % (`validation/published/groove/public.json`).
#[test]
fn intervals_from_catalog_data_match_an_independent_implementation() {
    // The torque without friction is the product of load and lead, divided by 2 pi.
    let ideal = [1353.3 * 0.005, 5130.0 * 0.02].map(|work| work / std::f64::consts::TAU);
    for (text, ideal, [low, high], [least, most]) in [
        (SFU1605, ideal[0], [0.02521, 0.032_751], [0.97049, 0.97713]),
        (R40, ideal[1], [0.28349, 0.33533], [0.97988, 0.98294]),
    ] {
        let answer = motion(&case(text, &[]));
        let torque = answer.band("ball_torque_Nm").expect("an interval");
        assert_relative_eq!(torque.low - ideal, low, max_relative = 0.01);
        assert_relative_eq!(torque.high - ideal, high, max_relative = 0.01);
        // A 1 % error in the loss corresponds to a 0.03 % error in the efficiency.
        let efficiency = answer.band("efficiency").expect("an interval");
        assert_relative_eq!(efficiency.low, least, max_relative = 3e-4);
        assert_relative_eq!(efficiency.high, most, max_relative = 3e-4);
    }
}

/// A given input is not estimated, so it narrows the intervals. According to the specification, the
/// median ratio of interval ends is 1.41 with catalog data only, and 1.03 if ball, conformity and
/// contact angle are given.
#[test]
fn specified_groove_inputs_narrow_the_intervals_of_results_from_catalog_data() {
    let width = |settings: &[&str]| {
        let answer = motion(&case(R40, settings));
        let ideal = 5130.0 * 0.02 / std::f64::consts::TAU;
        let band = answer.band("ball_torque_Nm").expect("an interval");
        (band.high - ideal) / (band.low - ideal)
    };
    let conformity = ["nut_conformity=0.52", "screw_conformity=0.52"];
    let all = [&conformity[..], &["ball_diameter_mm=6.35", "contact_angle_deg=45"]].concat();
    let widths = [width(&[]), width(&conformity), width(&all)];
    assert!(widths[0] > widths[1] && widths[1] > widths[2] && widths[2] < 1.1, "{widths:?}");
}

/// The catalog prints a rating of 10 117 N for R50-5T6-FSI of HIWIN, instead of 101 170 N.
#[test]
fn error_about_unreachable_ratings_states_the_nearest_groove() {
    let misprint = r#"{"nominal_diameter_mm": 50, "lead_mm": 5, "rated_dynamic_load_N": 24900, "rated_static_load_N": 10117}"#;
    let why = groove_error(&case(misprint, &[]));
    for part in [
        "rated_static_load_N = 10117 N",
        "rated_dynamic_load_N = 24900 N",
        "the nearest groove has",
        "rated_static_load_N were 10 times as large",
        "keep_ratings=true",
    ] {
        assert!(why.contains(part), "{part}: {why}");
    }
    let kept = case(misprint, &["keep_ratings=true"]).with_groove().expect("the nearest groove");
    assert!(kept.has_estimated_groove());
    let no_ball = groove_error(&case(SFU1605, &["lead_mm=0.5"]));
    assert!(
        no_ball.contains("no standard ball diameter fits") && no_ball.contains("lead_mm = 0.5 mm"),
        "{no_ball}"
    );
    let starts = groove_error(&case(SFU1605, &["starts=2"]));
    assert!(starts.contains("one start"), "{starts}");
    let wrong = case(SFU1605, &["rated_dynamic_load_N=-5"]).with_groove().expect_err("a sign");
    assert!(matches!(wrong, CaseError::OutOfRange { .. }), "{wrong}");
}

/// The life of an axis can be calculated without groove data.
#[test]
fn axis_life_is_calculated_even_if_no_groove_matches_the_ratings() {
    let line = case(R40, &["rated_static_load_N=1444000", "stroke_mm=500"]);
    let report = AxisReport::of(&line, &Settings::default()).expect("a sheet");
    // The life is (C_a/F)³ million revolutions.
    assert_relative_eq!(
        report.number(output!(cycle_life_revolutions)).expect("a life"),
        1e9,
        max_relative = 1e-12
    );
    let warned =
        report.answer.warnings.iter().any(|text| text.contains("rated_static_load_N were a tenth"));
    assert!(warned, "{:?}", report.answer.warnings);
    assert!(report.answer.section("groove_estimate").is_none());
}

/// Life, static safety and the limits of the screw follow from the catalog data and have no
/// intervals. Torque, heat, temperature and stiffness depend on the estimated groove and have
/// intervals.
#[test]
fn axis_results_from_catalog_data_have_intervals() {
    let of = |settings: &[&str]| {
        AxisReport::of(&case(R40, settings), &Settings::default()).expect("a sheet")
    };
    // Without `nut_length_mm`, the nut length would be calculated from the turns of the estimated
    // groove.
    let given = ["stroke_mm=500", "nut_length_mm=90"];
    let report = of(&given);
    let plain = of(&[&given[..], &["estimate_groove=false"]].concat());
    for name in [
        "cycle_life_h",
        "static_safety_factor",
        "critical_speed_rpm",
        "shaft_diameter_mm",
        "screw_mass_kg",
    ] {
        assert_eq!(report.number(named(name)), plain.number(named(name)), "{name}");
        assert_eq!(report.answer.band(name), None, "{name}");
    }
    let dependent = [
        "screw_torque_Nm",
        "screw_efficiency",
        "mean_heat_W",
        "steady_temperature_rise_K",
        "nut_stiffness_at_largest_load_N_um",
        "axis_stiffness_N_um",
    ];
    for name in dependent {
        let (value, band) = (report.number(named(name)), report.answer.band(name));
        let band = band.unwrap_or_else(|| panic!("no interval of {name}"));
        // The result for the best groove lies within the interval over the possible grooves.
        let value = value.unwrap_or_else(|| panic!("no {name}"));
        assert!(band.low < value && value < band.high, "{name}: {value} {band:?}");
    }
    let phase = &report.answer.to_json()["groove_estimate"]["intervals"]["phases"][0];
    assert!(phase["screw_torque_Nm"].is_array(), "{phase}");
    let note = report.answer.notes.first().expect("a note");
    for part in [
        "estimated from the load ratings",
        "ball 6.35 mm",
        "77 loaded balls in 4 turns",
        "nut_conformity",
    ] {
        assert!(note.contains(part), "{part}: {note}");
    }
}

/// If friction is not given, the torque is calculated from the catalog efficiency of 0.9. Its
/// interval is calculated from efficiencies of 0.85 to 0.95. The 5 % and 95 % quantiles of these
/// efficiencies are 0.855 and 0.945, to within the spacing of the 32 draws.
#[test]
fn torque_interval_follows_from_catalog_efficiency_range_if_friction_is_missing() {
    let mut line = case(R40, &["stroke_mm=500"]);
    line.friction_coefficient = None;
    let report = AxisReport::of(&line, &Settings::default()).expect("a sheet");
    let ideal = 5130.0 * 0.02 / std::f64::consts::TAU;
    assert_relative_eq!(
        report.number(output!(screw_torque_Nm)).expect("a torque"),
        ideal / 0.9,
        max_relative = 1e-12
    );
    let band = report.answer.band("screw_torque_Nm").expect("an interval");
    // The tolerance is the distance between neighboring draws, 1/32 of the range.
    assert!((ideal / band.high - 0.855).abs() < 0.1 / 32.0, "{band:?}");
    assert!((ideal / band.low - 0.945).abs() < 0.1 / 32.0, "{band:?}");
    line.apply(&["catalog_efficiency=0.9", "catalog_back_efficiency=0.8"]).expect("inputs");
    let report = AxisReport::of(&line, &Settings::default()).expect("a sheet");
    assert_eq!(report.answer.band("screw_torque_Nm"), None);
}

/// The results of a warm state have intervals over the warm states for all possible grooves.
#[test]
fn warm_state_from_catalog_data_has_intervals() {
    let line = case(R40, &["stroke_mm=800", "warm_state=true"]);
    let report = AxisReport::of(&line, &Settings::default()).expect("a warm axis");
    let names = [
        "nut_temperature_C",
        "balls_temperature_C",
        "steady_heat_W",
        "loop_gain",
        "screw_growth_um",
        "screw_torque_Nm",
    ];
    for name in names {
        let value = report.number(named(name)).unwrap_or_else(|| panic!("no {name}"));
        let band = report.answer.band(name).unwrap_or_else(|| panic!("{name}: no interval"));
        assert!(band.low <= value && value <= band.high, "{name}: {value} {band:?}");
    }
    let json = report.answer.to_json();
    assert_eq!(json["groove_estimate"]["draws"], 16);
    assert_eq!(json["groove_estimate"]["without_result"], 0);
    let given = line.with_groove().expect("a groove");
    let nut =
        NutProblem::of(&given, &Settings::default()).expect("a nut").solve().expect("a state");
    let answer = NutReport::with_groove_intervals(nut.answer(), &given, &Settings::default());
    assert_eq!(answer.band("nut_temperature_C"), report.answer.band("nut_temperature_C"));
}

/// If the warm state of an axis with catalog data does not exist, the reason is reported as for a
/// given groove. The message used to ask for the inputs of the groove instead of stating the
/// reason.
#[test]
fn nonexistent_warm_state_from_catalog_data_is_reported() {
    let hot = case(R40, &["stroke_mm=800", "warm_state=true", "screw_speed_rpm=300000"]);
    let why = AxisReport::of(&hot, &Settings::default()).expect_err("too hot").to_string();
    assert!(why.contains("a temperature exceeds 180 C"), "{why}");
    let refused = case(R40, &["rated_static_load_N=1444", "stroke_mm=800", "warm_state=true"]);
    let why = AxisReport::of(&refused, &Settings::default()).expect_err("no groove").to_string();
    assert!(why.contains("the nearest groove has"), "{why}");
}

/// Since printed ratings are used with every possible groove, ratings and lives equal the catalog
/// values. The stiffness depends on the groove.
#[test]
fn life_does_not_depend_on_the_estimated_groove() {
    let line = case(R40, &[]).with_groove().expect("a groove");
    let answer = with_groove_intervals(&line, FEW_DRAWS, ratings).expect("ratings");
    assert_relative_eq!(
        answer.number(output!(dynamic_load_rating_N)).expect("a rating"),
        51_300.0,
        max_relative = 1e-12
    );
    assert_relative_eq!(
        answer.number(output!(static_load_rating_N)).expect("a rating"),
        144_400.0,
        max_relative = 1e-12
    );
    for name in ["dynamic_load_rating_N", "static_load_rating_N", "rating_life_h"] {
        assert_eq!(answer.band(name), None, "{name}");
    }
    assert!(answer.band("single_nut_secant_stiffness_N_um").is_some());
    let nut = |case: &Case| -> Result<Answer, CaseError> {
        let problem = NutProblem::of(case, &Settings::default())?;
        Ok(problem.solve().map_err(CaseError::Nut)?.answer())
    };
    let answer = with_groove_intervals(&line, FEW_DRAWS, nut).expect("a nut");
    // The life is (C_a/F)³ million revolutions.
    assert_relative_eq!(
        answer.number(output!(iso_life_revolutions)).expect("a life"),
        1e9,
        max_relative = 1e-9
    );
    let ratio = answer.number(output!(life_ratio)).expect("a ratio");
    // With equal ball loads, the life calculated from the loads of all balls is a few percent
    // longer than the life according to ISO 3408-5.
    assert!((1.0..1.15).contains(&ratio), "{ratio}");
    assert!(
        answer.band("nut_stiffness_N_um").is_some() && answer.band("max_pressure_MPa").is_some()
    );
}

/// The groove of each table row is estimated separately. If no groove has the ratings in a row, or
/// if the given groove has different ratings, the row is kept, and a message states the given and
/// the calculated ratings.
#[test]
fn table_rows_get_estimated_grooves_and_contradictions_are_reported() {
    let table = b"nut,nominal_diameter_mm,lead_mm,ball_diameter_mm,circuits,core_diameter_mm,dynamic_load_rating_N,static_load_rating_N
line,40,20,,,,51300,144400
misprint,50,5,,,,24900,10117
ball,40,20,6.35,,,51300,144400
other,16,10,3.175,3,12.32,96000,193000
given,15,10,3.175,3,12.32,9600,19300";
    let nuts = ManufacturerNut::from_csv(table, &TableFormat::default()).expect("rows");
    let rows = ManufacturerRow::all(&nuts, None).expect("ratings");
    let row = |name: &str| rows.iter().find(|row| row.name == name).expect("a row");
    assert_eq!(
        row("line").groove.as_deref(),
        Some("estimated together with the ball diameter of 6.35 mm")
    );
    assert_eq!(
        row("ball").groove.as_deref(),
        Some("estimated for the given ball diameter of 6.35 mm")
    );
    assert_eq!(row("misprint").groove.as_deref(), Some("none"));
    assert_eq!((&row("given").groove, &row("given").contradiction), (&None, &None));
    assert!(
        row("line").value(output!(our_stiffness_N_um)).is_some_and(|stiffness| stiffness > 300.0)
    );
    let of = |name: &str| row(name).contradiction.clone().unwrap_or_default();
    assert!(
        of("misprint").contains("10117") && of("misprint").contains("nearest groove"),
        "{}",
        of("misprint")
    );
    assert!(of("other").contains("96000 N, but the rating of the groove is"), "{}", of("other"));
    let unusual = b"nut,nominal_diameter_mm,lead_mm,ball_diameter_mm,loaded_turns,dynamic_load_rating_kgf,static_load_rating_kgf
SFU03205,32,5,2.381,4,1922,6343
SFU02505,25,5,3.175,4,1724,4904";
    let unusual = ManufacturerNut::from_csv(unusual, &TableFormat::default()).expect("rows");
    let unusual = ManufacturerRow::all(&unusual, None).expect("ratings");
    let named: Vec<_> =
        unusual.iter().map(|row| (&*row.name, row.contradiction.is_some())).collect();
    assert!(
        named.contains(&("SFU03205", true)) && named.contains(&("SFU02505", false)),
        "{named:?}"
    );
    // If a requirement is given, the contradictory row fails, and the other rows are checked
    // against the rules for the axis.
    let requirement = br#"{"axial_load_N": 1000, "feed_m_min": 5, "stroke_mm": 300}"#;
    let lists = bsm_case::Catalog::standard().expect("compiled in").lists;
    let requirement = RequirementFile::from_json(requirement, &[], lists).expect("a requirement");
    let judged = ManufacturerRow::all(&nuts, Some(&requirement)).expect("sheets");
    let verdict = |name: &str| judged.iter().find(|row| row.name == name).expect("a row").verdict;
    assert_eq!((verdict("other"), verdict("line")), (Some(Verdict::Fails), Some(Verdict::Passes)));
    let stiffness = judged.iter().find(|row| row.name == "line").expect("a row");
    assert!(stiffness.value(output!(axis_stiffness_N_um)).is_some());
}

/// On the axis sheet for a requirement, heat, torque and stiffness of a nut have intervals. Life
/// and safety follow from the ratings and have no intervals. In the table, each column with an
/// interval is followed by the columns for the two ends of the interval.
#[test]
fn numbers_that_depend_on_an_estimated_groove_have_columns_for_the_interval_ends() {
    let table = b"nut,nominal_diameter_mm,lead_mm,ball_diameter_mm,circuits,core_diameter_mm,dynamic_load_rating_N,static_load_rating_N
line,40,20,,,,51300,144400
given,15,10,3.175,3,12.32,9600,19300";
    let nuts = ManufacturerNut::from_csv(table, &TableFormat::default()).expect("rows");
    let requirement = br#"{"axial_load_N": 1000, "feed_m_min": 5, "stroke_mm": 300}"#;
    let lists = bsm_case::Catalog::standard().expect("compiled in").lists;
    let requirement = RequirementFile::from_json(requirement, &[], lists).expect("a requirement");
    let rows = ManufacturerRow::all(&nuts, Some(&requirement)).expect("sheets");
    let row = |name: &str| rows.iter().find(|row| row.name == name).expect("a row");
    let dependent = [
        output!(our_stiffness_N_um),
        output!(axis_stiffness_N_um),
        output!(peak_motor_torque_Nm),
        output!(mean_heat_W),
    ];
    for name in dependent {
        let (value, band) = (row("line").value(name), row("line").band(name));
        let (value, band) = (value.expect("a number"), band.expect("an interval"));
        assert!(band.low < value && value < band.high, "{name:?}: {value} {band:?}");
        assert_eq!(row("given").band(name), None, "{name:?}");
    }
    for name in
        [output!(cycle_life_h), output!(static_safety_factor), output!(critical_speed_ratio)]
    {
        assert_eq!(row("line").band(name), None, "{name:?}");
    }
    let listed: Vec<_> = rows.iter().collect();
    let columns = ManufacturerRow::table(&listed);
    let place = |name: &str| columns.iter().position(|(own, ..)| own == name).expect("a column");
    let [value, low, high] = ["mean_heat_W", "mean_heat_low_W", "mean_heat_high_W"].map(place);
    assert_eq!([low, high], [value + 1, value + 2]);
    let at = rows.iter().position(|row| row.name == "line").expect("a row");
    let band = row("line").band(output!(mean_heat_W)).expect("an interval");
    let numbers = |column: usize| match &columns[column].2 {
        ColumnValues::Numbers(values) => values.clone(),
        ColumnValues::Texts(_) => panic!("a column of numbers"),
    };
    let ends = [numbers(low)[at], numbers(high)[at]].map(f64::to_bits);
    assert_eq!(ends, [band.low, band.high].map(f64::to_bits));
    assert!(numbers(low)[1 - at].is_nan());
    let json = ManufacturerRow::answer(&listed, rows.len(), |_| true).to_json();
    assert_eq!(json[at]["intervals"]["mean_heat_W"], serde_json::json!([band.low, band.high]));
}

/// Columns that the program does not know, such as a price or a supplier, are kept. A column that
/// contains only numbers can also be sorted by and compared with a limit.
#[test]
fn offers_are_sorted_and_filtered_by_their_price() {
    let table = b"nut;nominal_diameter_mm;lead_mm;rated_dynamic_load_N;rated_static_load_N;price_EUR;supplier
A;32;10;33400;62100;245,50;Alpha
B;40;10;48000;107000;198,00;Beta
C;25;10;22000;42000;;Gamma";
    let format = TableFormat { delimiter: ';', decimal: ',', ..TableFormat::default() };
    let nuts = ManufacturerNut::from_csv(table, &format).expect("rows");
    let rows = ManufacturerRow::all(&nuts, None).expect("ratings");
    let columns = ListColumn::of_rows(&rows);
    let names = |filter: &NutFilter| -> Vec<String> {
        let list = filter.choose_rows(rows.clone());
        list.chosen.iter().map(|place| rows[*place as usize].name.clone()).collect()
    };
    let sorted = |descending| {
        NutFilter::default().sorted_by("price_EUR", descending, &columns).expect("a column")
    };
    // A nut without a price comes last in both directions.
    assert_eq!(names(&sorted(false)), ["B", "A", "C"]);
    assert_eq!(names(&sorted(true)), ["A", "B", "C"]);
    let cheap = NutFilter::new(&["price_EUR<=200".to_owned()], &columns, false);
    assert_eq!(names(&cheap.expect("a condition")), ["B"]);
    let by_text = NutFilter::default().sorted_by("supplier", false, &columns);
    let reason = by_text.expect_err("a column of text").to_string();
    assert!(reason.contains("`supplier` is a column of text"), "{reason}");
    let listed: Vec<_> = rows.iter().collect();
    let json = ManufacturerRow::answer(&listed, rows.len(), |_| true).to_json();
    let first = listed.iter().position(|row| row.name == "A").expect("a row");
    assert_eq!(json[first]["texts"], json!({"price_EUR": 245.5, "supplier": "Alpha"}));
}

/// Each model has its own intervals. The calculation time has no interval.
#[test]
fn model_comparison_from_catalog_data_states_intervals_for_each_model() {
    let line = case(R40, &[]).with_groove().expect("a groove");
    let answer = comparison(&line).expect("models").to_json();
    let models = answer["models"].as_array().expect("models");
    let intervals = &answer["groove_estimate"]["intervals"]["models"];
    let row = models.iter().position(|model| model["model"] == "raceway-control").expect("a model");
    let value = models[row]["ball_torque_Nm"].as_f64().expect("a torque");
    let [low, high] =
        [0, 1].map(|end| intervals[row]["ball_torque_Nm"][end].as_f64().expect("an interval"));
    assert!(low < value && value < high, "{low} {value} {high}");
    assert!(intervals[row]["time_us"].is_null(), "{intervals}");
}

/// For each quantile over nuts with random balls, the answer contains an interval over the possible
/// grooves. The intervals have the same layout as the quantiles.
#[test]
fn quantiles_over_random_nuts_with_estimated_grooves_have_intervals() {
    let line = case(R40, &["ball_deviation_sd_um=1"]).with_groove().expect("a groove");
    let settings = Settings::default();
    let problem = NutProblem::of(&line, &settings).expect("a nut");
    let samples = Samples::new(&problem, 20, Some(1)).expect("random balls");
    let nuts: Vec<_> = (0..20).map(|number| samples.solve(number)).collect();
    let answer = Samples::answer(&nuts, &line);
    let answer = Samples::with_groove_intervals(answer, &line, &settings, 20, Some(1)).to_json();
    let interval =
        &answer["groove_estimate"]["intervals"]["quantiles"]["max_contact_load_N"]["0.5"];
    let [low, high] = [0, 1].map(|end| interval[end].as_f64().expect("an interval"));
    let median = answer["quantiles"]["max_contact_load_N"]["0.5"].as_f64().expect("a median");
    assert!(low < median && median < high, "{low} {median} {high}");
}

/// A friction coefficient that is fitted to the mean heat generation of an axis has an interval.
#[test]
fn friction_coefficient_fitted_to_the_mean_heat_of_an_axis_has_an_interval() {
    let line = case(R40, &["stroke_mm=500"]).with_groove().expect("a groove");
    let settings = Settings::default();
    let fit = Fit::parse(&line, "friction_coefficient", "mean_heat_W=30").expect("a fit");
    let report = fit.run(&line, &settings).expect("values");
    let [found] = &report.found[..] else { panic!("{:?}", report.found) };
    let band = found.band.expect("an interval");
    assert!(band.low < found.value && found.value < band.high, "{found:?}");
    assert_eq!(found.grooves_without_value, 0);
    let message = fit.answer(&line, &report).to_json()["message"].to_string();
    assert!(message.contains("over the possible grooves"), "{message}");
}

/// For a case with a complete groove, the results are the same as before the program could estimate
/// grooves. `complete_groove.json` contains results of the last program version that did not
/// estimate grooves.
#[test]
fn results_for_a_complete_groove_match_the_stored_results() {
    const FROZEN: &str = include_str!("complete_groove.json");
    let frozen: serde_json::Value = serde_json::from_str(FROZEN).expect("JSON");
    let given = Case::from_json(frozen["case"].to_string().as_bytes()).expect("a case");
    let found = given.with_groove().expect("as given");
    assert_eq!(found, given);
    let settings = Settings::default();
    let record = Record::new(
        given.problem(&settings).expect("a problem").solve(&mut ModelWorkspace::default()),
    );
    let beside = Supplement { parts: true, ..Supplement::default() };
    let motion = record.answer("test", &given, &settings, &beside);
    let nut = NutProblem::of(&given, &settings).expect("a nut").solve().expect("a solution");
    let axis = AxisReport::of(&given, &settings).expect("an axis").answer;
    let mut compared = 0;
    for (part, answer) in [("solve", motion), ("nut", nut.answer()), ("axis", axis)] {
        assert!(answer.section("groove_estimate").is_none());
        let json = answer.to_json();
        let ours = if part == "axis" { &json["results"] } else { &json };
        for (name, value) in frozen[part].as_object().expect("numbers") {
            let (value, ours) = (value.as_f64().expect("a number"), ours[name].as_f64());
            let ours = ours.unwrap_or_else(|| panic!("{part}: no {name}"));
            // Other math libraries may differ in the last digits, and iterations amplify these
            // differences.
            assert_relative_eq!(ours, value, max_relative = 1e-9, epsilon = 1e-12);
            compared += 1;
        }
    }
    assert!(compared > 100, "{compared}");
}

/// The load at which a contact ellipse reaches the edge of its flank (edge load) depends on the
/// groove. For an estimated groove, the rule passes if the load is below the 90 % interval of the
/// edge load, and fails if the load is above this interval. If the load is within the interval, the
/// rule is undecided and names the inputs that would decide it.
#[test]
fn rule_is_undecided_if_the_interval_for_an_estimated_groove_contains_the_limit() {
    let line = r#"{"nominal_diameter_mm": 40, "lead_mm": 20, "rated_dynamic_load_N": 51300, "screw_speed_rpm": 100,
        "stroke_mm": 500}"#;
    let line = Case::from_json(line.as_bytes()).expect("a catalog line");
    let sheet = |load: f64| {
        let mut case = line.clone();
        case.axial_load_N = Some(load);
        AxisReport::of(&case, &Settings::default()).expect("a sheet")
    };
    let edge = |report: &AxisReport| {
        let mut rules = report.answer.rules.iter();
        rules.find(|rule| rule.name == "edge_load_N").expect("the rule").clone()
    };
    let band = edge(&sheet(1000.0)).band.expect("an interval");
    let margin = (band.high / band.low).powf(0.1);
    for (load, verdict) in [
        (band.low / margin, Verdict::Passes),
        (band.low * margin, Verdict::Undecided),
        (band.high / margin, Verdict::Undecided),
        (band.high * margin, Verdict::Fails),
    ] {
        let report = sheet(load);
        let rule = edge(&report);
        assert_eq!(rule.verdict(), verdict, "{load} {rule:?}");
        let json = report.answer.to_json();
        let rules = json["rules"].as_array().expect("rules");
        let row = rules.iter().find(|row| row["name"] == "edge_load_N").expect("a row");
        assert_eq!(row["passes"], serde_json::json!(verdict.passes()));
        assert_eq!(report.answer.fails, report.verdict() == Verdict::Fails);
        if report.verdict() == Verdict::Undecided {
            assert!(json["passes"].is_null() && !report.passes(), "{}", json["passes"]);
            let remedy = rule.remedy.expect("the inputs that decide the rule");
            assert!(remedy.contains("nut_conformity") && remedy.contains("to decide"), "{remedy}");
            let notes = &report.answer.notes;
            assert!(notes.iter().any(|note| note.contains("is undecided")), "{notes:?}");
        }
    }
    // If the groove is given, the rule is decided.
    let mut given = sheet(band.low * margin).case.with_groove().expect("a groove");
    given.entries.estimated_inputs = None;
    given.axial_load_N = Some(band.low * margin);
    let decided = AxisReport::of(&given, &Settings::default()).expect("a sheet");
    assert_ne!(edge(&decided).verdict(), Verdict::Undecided);
}

/// In a table, a nut with an undecided rule comes after the nuts that pass and before the nuts that
/// fail.
#[test]
fn undecided_nuts_of_a_table_come_between_passing_and_failing_nuts() {
    let line = br#"{"nominal_diameter_mm": 16, "lead_mm": 5, "rated_dynamic_load_N": 3500, "axial_load_N": 1000,
        "screw_speed_rpm": 100, "stroke_mm": 200}"#;
    let line = Case::from_json(line).expect("a catalog line");
    let report = AxisReport::of(&line, &Settings::default()).expect("a sheet");
    let edge = report.answer.rules.iter().find(|rule| rule.name == "edge_load_N");
    let band = edge.and_then(|rule| rule.band).expect("an interval");
    let load = (band.low * band.high).sqrt();
    let table = b"nut,nominal_diameter_mm,lead_mm,dynamic_load_rating_N
weak,8,2,500
open,16,5,3500
strong,40,20,51300";
    let nuts = ManufacturerNut::from_csv(table, &TableFormat::default()).expect("rows");
    let requirement =
        format!(r#"{{"axial_load_N": {load}, "screw_speed_rpm": 100, "stroke_mm": 200}}"#);
    let lists = bsm_case::Catalog::standard().expect("compiled in").lists;
    let requirement =
        RequirementFile::from_json(requirement.as_bytes(), &[], lists).expect("a requirement");
    let rows = ManufacturerRow::all(&nuts, Some(&requirement)).expect("sheets");
    let found: Vec<_> = rows.iter().map(|row| (&*row.name, row.verdict)).collect();
    let verdicts = [Verdict::Passes, Verdict::Undecided, Verdict::Fails].map(Some);
    assert_eq!(found, ["strong", "open", "weak"].into_iter().zip(verdicts).collect::<Vec<_>>());
    let listed: Vec<_> = rows.iter().collect();
    let answer = ManufacturerRow::answer(&listed, listed.len(), |_| true);
    assert!(
        answer.notes.iter().any(|note| note.contains("1 of 3 nuts neither pass nor fail")),
        "{:?}",
        answer.notes
    );
}

/// A highest speed with a thermal steady state (fold) exists only for some of the possible grooves.
/// The answer states the number of these grooves, and the interval of the fold over these grooves.
/// If the best groove has no fold, the answer used to contain nothing about a fold.
#[test]
fn thermal_fold_of_only_some_possible_grooves_is_reported_with_the_number_of_these_grooves() {
    let base = ["stroke_mm=800", "warm_state=true", "preload_N=2000", "screw_speed_rpm=1500"];
    let limit = |factor: f64| format!("fold_search_factor={factor}");
    let fold = |factor: f64| {
        let line = case(R40, &[&base[..], &[&limit(factor)]].concat());
        let report = AxisReport::of(&line, &Settings::default()).expect("a warm axis");
        let json = report.answer.to_json();
        let estimate = json["groove_estimate"].clone();
        (report.number(output!(fold_speed_factor)), estimate, report.answer.notes)
    };
    let (all, estimate, _) = fold(8.0);
    let all = all.expect("a fold");
    assert_eq!(estimate["grooves_with_number"]["fold_speed_factor"], json!(null));
    let interval = &estimate["intervals"]["fold_speed_factor"];
    let [low, high] = [0, 1].map(|end| interval[end].as_f64().expect("an end"));
    assert!(low < all && all < high, "{low} {all} {high}");
    // The search ends at a speed between the lowest fold and the fold of the best groove.
    let (none, estimate, notes) = fold(0.5 * (low + all));
    assert_eq!(none, None);
    let grooves = estimate["grooves_with_number"]["fold_speed_factor"].as_u64().expect("a count");
    assert!((1..16).contains(&grooves), "{estimate}");
    assert!(estimate["intervals"]["fold_speed_factor"].is_array(), "{estimate}");
    let text = format!("but {grooves} of 16 possible grooves have one");
    let is_stated = |note: &String| note.contains("fold_speed_factor") && note.contains(&text);
    assert!(notes.iter().any(is_stated), "{notes:?}");
    // The search ends between two speeds: the highest speed with a steady state for the best
    // estimate of the groove, and the highest such speed of all possible grooves.
    let (some, estimate, notes) = fold(0.5 * (all + high));
    assert!(some.is_some_and(|some| (some / all - 1.0).abs() < 1e-3), "{some:?}");
    let grooves = estimate["grooves_with_number"]["fold_speed_factor"].as_u64().expect("a count");
    let text = format!("Only {grooves} of 16 possible grooves have values for fold_speed_factor");
    assert!(notes.iter().any(|note| note.starts_with(&text)), "{notes:?}");
}

/// A nut without preload has a warm state under light loads, because `auto` uses another model in
/// place of `traction` if the balls skid. The calculation of such a state used to fail with "a ball
/// has no friction torque".
#[test]
fn warm_state_exists_under_light_loads_at_high_speed() {
    let mut line = case(R40, &["stroke_mm=800", "warm_state=true", "iso_vg=100"]);
    line.friction_coefficient = None;
    let line = line.with_groove().expect("a groove");
    let mut last = f64::INFINITY;
    for load in [30.0, 3.0, 0.3] {
        let problem =
            NutProblem::of(&line_at(&line, load), &Settings::default()).expect("a warm nut");
        assert_eq!(problem.settings().model, bsm_dyn::Model::RacewayControl.into(), "{load} N");
        let report = problem.solve().expect("balls");
        let answer = report.answer();
        let nut = answer.number(output!(nut_temperature_C)).expect("a temperature");
        // The temperature of the surroundings is 20 °C, and a smaller load generates less heat.
        assert!(nut > 20.0 && nut < last, "{load} N: {nut} after {last}");
        last = nut;
        assert!(report.number(output!(friction_torque_Nm)).is_some_and(|torque| torque > 0.0));
        let is_stated = |text: &&String| text.contains("follow from model raceway-control");
        assert_eq!(answer.warnings.iter().filter(is_stated).count(), 1, "{:?}", answer.warnings);
    }
    // A model that the user chooses is never replaced, and the error message states a remedy.
    let traction = Settings::from(bsm_dyn::Model::Traction);
    let why = NutProblem::of(&line_at(&line, 3.0), &traction).expect_err("no friction").to_string();
    assert!(why.contains("use model raceway-control"), "{why}");
}

/// Returns a case under another axial load \[N\], at 1000 rpm.
fn line_at(line: &Case, load: f64) -> Case {
    let mut at = line.clone();
    at.apply(&[&format!("axial_load_N={load}"), "screw_speed_rpm=1000"]).expect("inputs");
    at
}

/// If the case contains no friction coefficient, the fitted coefficient still has an interval. The
/// fit used to fail for every possible groove, because the model was chosen without the
/// coefficient.
#[test]
fn fitted_friction_coefficient_has_an_interval_even_if_the_case_contains_no_friction_coefficient() {
    let mut line = case(R40, &[]);
    let fitted = |line: &Case| {
        let line = line.with_groove().expect("a groove");
        let fit = Fit::parse(&line, "friction_coefficient", "efficiency=0.97").expect("a fit");
        let report = fit.run(&line, &Settings::default()).expect("a value");
        let [found] = &report.found[..] else { panic!("{:?}", report.found) };
        assert_eq!(found.grooves_without_value, 0);
        let notes = fit.answer(&line, &report).notes;
        assert!(notes.iter().any(|note| note.contains("not for the error of the measured value")));
        (found.value, found.band)
    };
    let given = fitted(&line);
    line.friction_coefficient = None;
    let missing = fitted(&line);
    assert!(missing.1.is_some_and(|band| band.low < missing.0 && missing.0 < band.high));
    assert_eq!(given, missing);
}

/// A usability test found that the estimated groove had 7.5 turns with a lead of 5 mm, although the
/// nut was only 30 mm long, and that the order data did not mark this length as estimated.
#[test]
fn estimated_nut_length_fits_the_turns_of_the_estimated_groove() {
    let line = r#"{"nominal_diameter_mm": 32, "lead_mm": 5, "ball_diameter_mm": 2.381, "rated_dynamic_load_N": 18848, "rated_static_load_N": 62204,
        "axial_load_N": 2000, "feed_m_min": 6, "stroke_mm": 500}"#;
    let sheet = |settings: &[&str]| {
        AxisReport::of(&case(line, settings), &Settings::default()).expect("a sheet")
    };
    let report = sheet(&[]);
    let number = |name: &str| report.number(named(name)).expect("a number");
    // The length is P (i + 3) (D10).
    let (turns, length) = (number("loaded_turns"), number("nut_length_mm"));
    assert!(turns > 5.0, "{turns}");
    assert_relative_eq!(length, 5.0 * (turns + 3.0), max_relative = 1e-12);
    // The same nut length is used for all possible grooves, so lengths, and results that depend
    // only on lengths, have no intervals.
    assert!(report.answer.band("loaded_turns").is_some());
    for name in ["nut_length_mm", "thread_length_mm", "critical_speed_rpm", "screw_mass_kg"] {
        assert_eq!(report.answer.band(name), None, "{name}");
    }
    let note = report.answer.notes.iter().find(|note| note.starts_with("nut_length_mm"));
    assert!(note.is_some_and(|note| note.contains("loaded turns of the estimated groove")));
    // The order data mark the nut length and every length that includes the nut as estimated.
    assert_eq!(report.order.to_string().matches(" mm (estimated)").count(), 3, "{}", report.order);
    let given = sheet(&["nut_length_mm=53"]);
    let order = given.order.to_string();
    assert!(order.contains("single nut, length 53 mm, thread 563 mm, "), "{order}");
    let long = sheet(&["unsupported_length_mm=700"]).order.to_string();
    assert!(long.contains("length between bearings 700 mm, "), "{long}");
    // `ratings` gives the same nut length as the axis sheet.
    let nut = ratings(&case(line, &[]).with_groove().expect("a groove")).expect("ratings");
    assert_eq!(nut.number(output!(nut_length_mm)), Some(length));
}
