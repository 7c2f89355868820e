//! The catalogue in the vocabulary, and the life of a nut.

use bsm_case::{CapacityReport, Catalogue, CatalogueColumn, Condition, Scene, Spectrum};
use bsm_design::Candidate;

/// Small lists; what they do not give is standard.
const SMALL: &[u8] =
    br#"{"nominal_diameter_mm": [20, 63], "lead_mm": [5, 20], "ball_diameter_mm": [3, 10],
    "conformity": [0.52, 0.55], "largest_ball_over_lead": 0.6}"#;

fn all(catalogue: &Catalogue) -> Vec<Candidate> {
    catalogue.map(&catalogue.places(), |_, nut| Some(*nut))
}

/// The published rows are in it with their numbers (to the newton, millimetre and per cent that
/// `bsm validate` holds them to); more than 50 000 standard nuts keep the limits.
#[test]
fn published_nuts_are_in_the_catalogue() {
    let all = all(&Catalogue::from_json(SMALL).expect("lists"));
    let has = |conditions: &[&str]| {
        let conditions: Vec<_> =
            conditions.iter().map(|c| Condition::parse(c).expect("a condition")).collect();
        all.iter().filter(|nut| conditions.iter().all(|c| c.is_met(nut))).count()
    };
    let small = ["nominal_diameter_mm=20", "lead_mm=5", "loaded_turns=2", "nut_conformity=0.52"];
    assert_eq!(has(&small), 1);
    let numbers = ["dynamic_load_rating_N>=6781", "dynamic_load_rating_N<=6783"];
    assert_eq!(has(&[small.as_slice(), &numbers].concat()), 1);
    let large = ["ball_diameter_mm=10", "loaded_turns=6", "nut_conformity=0.55"];
    let numbers = ["pitch_circle_diameter_mm=63.35", "total_rigidity_N_um>=3234", "mass_kg<=7.3"];
    assert_eq!(has(&[large.as_slice(), &numbers].concat()), 1);
    assert!(Catalogue::standard().expect("compiled in").places().len() > 50_000);
}

/// None of the front beats another of it.
#[test]
fn the_front_is_smaller_and_keeps_the_best() {
    let catalogue = Catalogue::from_json(SMALL).expect("lists");
    let all = all(&catalogue);
    let front = catalogue.map(&catalogue.pareto(&catalogue.places()), |_, nut| Some(*nut));
    let best = |nuts: &[Candidate]| nuts.iter().map(|nut| nut.dynamic_rating).fold(0.0, f64::max);
    assert!(front.len() < all.len() && (best(&front) - best(&all)).abs() < 1e-9);
}

#[test]
fn lists_are_checked() {
    for (json, words) in [
        ("{\"led_mm\": [5]}", "did you mean `lead_mm`?"),
        ("{\"lead_mm\": 5}", "lead_mm"),
        ("{\"lead_mm\": []}", "the list is empty"),
        ("{\"lead_mm\": [-5]}", "`lead_mm` = -5 must be > 0"),
        ("{\"ball_diameter_mm\": [1e-310]}", "`ball_diameter_mm` = 1e-310 must be >= 0.001"),
        ("{\"conformity_range\": [0.4, 0.6]}", "must be > 0.5"),
        ("{\"lead_mm\": [5}", "not valid JSON"),
    ] {
        let error = Catalogue::from_json(json.as_bytes()).expect_err(words).to_string();
        assert!(error.contains(words), "{error}");
    }
    for (text, words) in [
        ("mass>=1", "did you mean `mass_kg`?"),
        ("mass_kg>1", "is not of the form"),
        ("mass_kg>=heavy", "is not of the form"),
        ("mass_kg", "is not of the form"),
    ] {
        let error = Condition::parse(text).expect_err(words).to_string();
        assert!(error.contains(words), "{error}");
    }
    assert!(CatalogueColumn::named("efficiency").is_ok());
}

fn numbers(scene: &Scene, spectrum: Option<&str>) -> impl Fn(&str) -> f64 + use<> {
    let spectrum = spectrum.map(|table| Spectrum::from_csv(table.as_bytes()).expect("a spectrum"));
    let report = CapacityReport::of(scene, spectrum.as_ref()).expect("complete");
    let rows = report.rows().to_vec();
    move |name| rows.iter().find(|(n, ..)| *n == name).map_or(f64::NAN, |row| row.2)
}

/// One stretch is the operating point of the scene; two with half the turns each have the cube mean.
#[test]
fn a_spectrum_is_a_life() {
    let nut = Scene::from_json(include_bytes!("../../../examples/nut.json")).expect("an example");
    let mut busy = nut.clone();
    (busy.axial_load_N, busy.screw_speed_rpm) = (Some(9e3), Some(750.0));
    let one = numbers(&busy, None);
    let head = "axial_load_N,screw_speed_rpm,time_share\n";
    let same = numbers(&busy, Some(&format!("{head}9000,-750,0.3\n")));
    assert!((one("life_h") / same("life_h") - 1.0).abs() < 1e-12);
    let rating = one("dynamic_load_rating_N");
    let hours = (rating / 9e3).powi(3) * 1e6 / (60.0 * 750.0);
    assert!((one("life_h") / hours - 1.0).abs() < 1e-12, "{}", one("life_h"));
    // Half the turns at 9 kN, half at none: twice the life in revolutions.
    let half = numbers(&busy, Some(&format!("{head}9000,500,1\n0,250,2\n")));
    assert!((half("life_revolutions") / one("life_revolutions") - 2.0).abs() < 1e-12);
    assert!((half("mean_speed_rpm") - 1000.0 / 3.0).abs() < 1e-9);
    for (table, words) in [
        ("axial_load_N,screw_speed_rpm\n1,2\n", "time_share"),
        ("axial_load_N,screw_speed_rpm,time_share\n1,fast,2\n", "row 1"),
        ("axial_load_N,screw_speed_rpm,time_share\n1,2,3\n1,2,-3\n", "row 2: time_share = -3"),
        ("axial_load_N,screw_speed_rpm,time_share\n1,0,3\n", "nothing turns"),
        ("load,screw_speed_rpm,time_share\n1,2,3\n", "the columns are axial_load_N"),
        // `"5"6` was read as 56.
        ("axial_load_N,screw_speed_rpm,time_share\n1,2,3\n\"5\"6,2,3\n", "line 3 has a quote"),
    ] {
        let error = Spectrum::from_csv(table.as_bytes()).expect_err(words).to_string();
        assert!(error.contains(words), "{error}");
    }
}

/// A preload takes life without load, and beyond 2.83 times it a pair is a nut.
#[test]
fn preload_costs_life() {
    let mut nut =
        Scene::from_json(include_bytes!("../../../examples/nut.json")).expect("an example");
    (nut.axial_load_N, nut.screw_speed_rpm) = (Some(1e3), Some(100.0));
    let single = numbers(&nut, None)("life_h");
    nut.preload_N = Some(5e3);
    let pair = numbers(&nut, None);
    assert!(pair("life_h") < 0.02 * single && pair("mean_load_N") > 5e3);
    nut.preload_N = Some(100.0);
    assert!((numbers(&nut, None)("life_h") / single - 1.0).abs() < 1e-12);
}
