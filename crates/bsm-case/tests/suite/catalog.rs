//! Tests of the nut catalog and of the nut life.

use bsm_case::{
    Case, Catalog, Condition, ListColumn, ManufacturerNut, ManufacturerRow, NutFilter,
    RequirementFile, TableFormat, candidate_case, ratings,
};
use bsm_design::Make;
use bsm_design::catalog::Candidate;

use crate::named;

/// Short lists of sizes as JSON text. Lists that are missing in the text have their standard
/// values.
const SMALL: &[u8] =
    br#"{"nominal_diameter_mm": [20, 63, 100], "lead_mm": [5, 20], "ball_diameter_mm": [3, 10],
    "nut_conformity": [0.52, 0.55], "largest_ball_over_lead": 0.6}"#;

/// Returns the columns that a list of sizes has if no requirement is given.
fn columns() -> Vec<ListColumn> {
    ListColumn::of_sizes(false)
}

fn all_nuts(catalog: &Catalog) -> Vec<Candidate> {
    catalog.map(&catalog.indices(), |_, nut| Some(*nut))
}

/// The catalog contains the published rows with the printed values, rounded to newtons, millimeters
/// and percent (as in `bsm validate`). More than 50 000 standard nuts meet the limits.
#[test]
fn catalog_contains_the_published_nuts() {
    let catalog = Catalog::from_json(SMALL).expect("lists");
    let all = all_nuts(&catalog);
    let has = |conditions: &[&str]| {
        let conditions: Vec<_> = conditions
            .iter()
            .map(|c| Condition::parse(c, &columns()).expect("a condition"))
            .collect();
        all.iter().filter(|nut| conditions.iter().all(|c| c.is_met(nut, &catalog, &[]))).count()
    };
    let small = ["nominal_diameter_mm=20", "lead_mm=5", "loaded_turns=2", "nut_conformity=0.52"];
    assert_eq!(has(&small), 1);
    let numbers = ["dynamic_load_rating_N>=6781", "dynamic_load_rating_N<=6783"];
    assert_eq!(has(&[small.as_slice(), &numbers].concat()), 1);
    let large = ["ball_diameter_mm=10", "loaded_turns=6", "nut_conformity=0.55"];
    let numbers =
        ["pitch_circle_diameter_mm=63.35", "preloaded_stiffness_N_um>=3234", "nut_mass_kg<=7.3"];
    assert_eq!(has(&[large.as_slice(), &numbers].concat()), 1);
    assert!(Catalog::standard().expect("compiled in").indices().len() > 50_000);
}

/// ISO 3408-2 covers diameters from 6 to 200 mm, and the catalog contains nuts for every diameter.
/// The standard lists used to cover only 8 to 100 mm.
#[test]
fn catalog_contains_nuts_for_every_standard_diameter() {
    const ISO_3408_2: [f64; 16] = [
        6.0, 8.0, 10.0, 12.0, 16.0, 20.0, 25.0, 32.0, 40.0, 50.0, 63.0, 80.0, 100.0, 125.0, 160.0,
        200.0,
    ];
    let catalog = Catalog::standard().expect("compiled in");
    let diameters: Vec<_> = catalog.lists.diameters.iter().map(|d| (1e3 * d).round()).collect();
    assert_eq!(diameters, ISO_3408_2);
    let found = catalog.map(&catalog.indices(), |_, nut| Some((1e3 * nut.size.diameter).round()));
    for diameter in ISO_3408_2 {
        assert!(found.iter().any(|d| (d - diameter).abs() < 1e-9), "{diameter} mm");
    }
}

/// With the size lists of Sobolewski's paper, the catalog contains each printed row exactly once,
/// with its calculated diameter. An audit found that these lists gave only six of the thirteen
/// printed rows.
#[test]
fn size_lists_of_sobolewski_give_every_printed_row() {
    let lists = include_bytes!("../../../../validation/published/ratings/parkon.json");
    let all = all_nuts(&Catalog::from_json(lists).expect("lists"));
    let table = include_str!("../../../../validation/published/ratings/sobolewski.csv");
    let mut rows = 0;
    for line in table.lines().skip(1) {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
        let printed = |nut: &&Candidate| {
            let size = &nut.size;
            let sizes = [
                (1e3 * size.diameter, cells[0]),
                (1e3 * nut.nut.pitch_diameter, cells[1]),
                (1e3 * size.lead, cells[2]),
                (size.turns, cells[3]),
                (1e3 * size.ball, cells[4]),
                (size.conformity, cells[6]),
            ];
            sizes.iter().all(|(ours, printed)| (ours - printed).abs() < 1e-6)
        };
        assert_eq!(all.iter().filter(printed).count(), 1, "{line}");
        rows += 1;
    }
    assert_eq!(rows, 13);
}

/// The lands of each nut must retain its balls under the preload. An audit found that the nut bore
/// was larger than the circle around the balls in 17 255 of 88 515 nuts. In 40 705 nuts, the balls
/// touched the lands at 45 deg.
#[test]
fn lands_of_every_catalog_nut_retain_its_balls() {
    let catalog = Catalog::standard().expect("compiled in");
    let places = catalog.indices();
    assert!(places.len() > 50_000);
    let bad = catalog.map(&places, |place, nut| {
        let contact = nut.nut.ball_diameter * nut.nut.contact_angle.cos();
        let between = nut.thread.nut.land >= nut.nut.pitch_diameter + contact
            || nut.thread.screw.land <= nut.nut.pitch_diameter - contact;
        (between || nut.edge_load < nut.preload || nut.mass <= 0.0).then_some(place)
    });
    assert!(bad.is_empty(), "{bad:?}");
}

/// The gap between balls and the axial play can each be set by a single number. A smaller gap
/// requires a larger pitch circle, and a play moves the arc centers closer together.
#[test]
fn ball_gap_and_axial_play_can_be_set() {
    let with = |key: &str, value: f64| {
        let mut lists: serde_json::Value = serde_json::from_slice(SMALL).expect("JSON");
        lists[key] = value.into();
        all_nuts(&Catalog::from_json(lists.to_string().as_bytes()).expect("lists"))
    };
    let (usual, tight) = (
        all_nuts(&Catalog::from_json(SMALL).expect("lists")),
        with("largest_ball_gap_over_ball", 0.02),
    );
    assert!(tight.iter().all(|nut| nut.nut.ball_gap() <= 0.0201 * nut.nut.ball_diameter));
    let wide = with("largest_ball_gap_over_ball", 0.9);
    assert!(wide.iter().any(|nut| nut.nut.ball_gap() > 0.5 * nut.nut.ball_diameter));
    // A turn with a pitch circle of 101.66 mm has room for 31.99999 balls. This number counts as 32
    // balls without a gap.
    let full = usual.iter().map(|nut| nut.nut.ball_gap() / nut.nut.ball_diameter);
    assert!(full.clone().all(|gap| gap <= 0.1001), "{:?}", full.fold(0.0, f64::max));
    let loose = with("axial_play_um", 20.0);
    let offset = |nuts: &[Candidate]| nuts[0].thread.nut.offset;
    // With equal grooves, each of the four arcs contributes a quarter of the play.
    assert!((offset(&usual) - offset(&loose) - 5e-6).abs() < 1e-12);
    assert!(Catalog::from_json(b"{\"largest_ball_gap_over_ball\": 1}").is_err());
}

/// No nut on the Pareto front dominates another nut on the front.
#[test]
fn pareto_front_contains_no_dominated_nut() {
    let catalog = Catalog::from_json(SMALL).expect("lists");
    let all = all_nuts(&catalog);
    let front = catalog.map(&catalog.pareto(&catalog.indices()), |_, nut| Some(*nut));
    let best = |nuts: &[Candidate]| nuts.iter().map(|nut| nut.dynamic_rating).fold(0.0, f64::max);
    assert!(front.len() < all.len() && (best(&front) - best(&all)).abs() < 1e-9);
}

#[test]
fn invalid_lists_and_conditions_are_rejected() {
    for (json, words) in [
        ("{\"led_mm\": [5]}", "did you mean `lead_mm`?"),
        ("{\"lead_mm\": 5}", "lead_mm"),
        ("{\"lead_mm\": []}", "must not be empty"),
        ("{\"lead_mm\": [-5]}", "`lead_mm` = -5 must be from 0.001 to 10000"),
        ("{\"ball_diameter_mm\": [1e-310]}", "must be from 0.001 to 1000"),
        ("{\"nut_conformity_range\": [0.4, 0.6]}", "must be a finite number > 0.5"),
        ("{\"lead_mm\": [5}", "not valid JSON"),
    ] {
        let error = Catalog::from_json(json.as_bytes()).expect_err(words).to_string();
        assert!(error.contains(words), "{error}");
    }
    for (text, words) in [
        ("mass>=1", "did you mean `nut_mass_kg`?"),
        ("nut_mass_kg>1", "does not have the form"),
        ("nut_mass_kg>=heavy", "`heavy` is not a number"),
        ("passes=true", "conditions and sorting need a column of numbers"),
        ("nut_mass_kg", "does not have the form"),
    ] {
        let error = Condition::parse(text, &columns()).expect_err(words).to_string();
        assert!(error.contains(words), "{error}");
    }
}

fn numbers(case: &Case) -> impl Fn(&str) -> f64 + use<> {
    let report = ratings(case).expect("complete");
    move |name| report.number(named(name)).unwrap_or(f64::NAN)
}

/// The life is (C_a / F)^3 million revolutions at the speed of the case.
#[test]
fn rating_life_refers_to_the_operating_point() {
    let mut nut =
        Case::from_json(include_bytes!("../../../../examples/nut.json")).expect("an example");
    (nut.axial_load_N, nut.screw_speed_rpm) = (Some(9e3), Some(-750.0));
    let one = numbers(&nut);
    let hours = (one("dynamic_load_rating_N") / 9e3).powi(3) * 1e6 / (60.0 * 750.0);
    // The tolerance allows for the rounding errors of a few operations.
    assert!((one("rating_life_h") / hours - 1.0).abs() < 1e-12, "{}", one("rating_life_h"));
}

/// A preload reduces the life even without a load. If the load exceeds 2.83 times the preload, the
/// life of a pair equals the life of a single nut.
#[test]
fn preload_reduces_the_life() {
    let mut nut =
        Case::from_json(include_bytes!("../../../../examples/nut.json")).expect("an example");
    (nut.axial_load_N, nut.screw_speed_rpm) = (Some(1e3), Some(100.0));
    let single = numbers(&nut)("rating_life_h");
    nut.preload_N = Some(5e3);
    let pair = numbers(&nut);
    assert!(pair("rating_life_h") < 0.02 * single);
    nut.preload_N = Some(100.0);
    assert!((numbers(&nut)("rating_life_h") / single - 1.0).abs() < 1e-12);
}

/// The standard sizes used to contain 0.8 mm balls for a 40 mm screw. The most common sizes of all
/// manufacturers were missing, because their ball diameter exceeds half of the lead.
#[test]
fn catalogs_contain_common_sizes_with_typical_proportions() {
    let manufacturers = Catalog::manufacturers().expect("compiled in");
    // The table has 208 rows from THK and HIWIN, and each row has at least one number of turns. The
    // 34 sizes in the eight rows that are offered in both makes count twice.
    assert_eq!(manufacturers.lists.offered.len(), 463 + 34);
    for catalog in [manufacturers, Catalog::standard().expect("compiled in")] {
        let all = all_nuts(&catalog);
        let outside = all.iter().filter(|nut| {
            let share = nut.size.ball / nut.size.diameter;
            !(0.06 - 1e-9..=0.27 + 1e-9).contains(&share)
        });
        assert_eq!(outside.count(), 0);
        for (diameter, lead) in [(16.0, 5.0), (25.0, 5.0), (32.0, 10.0), (40.0, 10.0)] {
            let is_it = |nut: &&Candidate| {
                let near = |a: f64, b: f64| (1e3 * a - b).abs() < 1e-9;
                near(nut.size.diameter, diameter) && near(nut.size.lead, lead)
            };
            assert!(all.iter().any(|nut| is_it(&nut)), "{diameter} x {lead}");
        }
    }
}

/// Without `screw_make`, every size has the make of its row: the 25 x 10 mm screw with 6.35 mm balls
/// is offered only as a rolled screw, so neither a ground screw nor a screw of grade P3 has this
/// size. With `screw_make`, only sizes of this make meet the requirement.
#[test]
fn a_size_is_selected_only_in_the_make_that_a_manufacturer_offers() {
    let manufacturers = Catalog::manufacturers().expect("compiled in");
    let selected = |settings: &[&str]| -> Vec<Candidate> {
        let json = br#"{"axial_load_N": 500, "feed_m_min": 5, "stroke_mm": 300}"#;
        let settings: Vec<_> = settings.iter().map(|text| (*text).to_owned()).collect();
        let requirement =
            RequirementFile::from_json(json, &settings, manufacturers.lists.clone()).expect("keys");
        let all = manufacturers.indices();
        manufacturers.map(&all, |_, nut| requirement.is_met_by(nut).then_some(*nut))
    };
    let makes = |nuts: &[Candidate]| -> Vec<_> {
        [Make::Ground, Make::Rolled]
            .into_iter()
            .filter(|make| nuts.iter().any(|nut| nut.size.make() == Some(*make)))
            .collect()
    };
    assert_eq!(makes(&selected(&[])), [Make::Ground, Make::Rolled]);
    assert_eq!(makes(&selected(&["screw_make=rolled"])), [Make::Rolled]);
    assert_eq!(makes(&selected(&["screw_make=ground"])), [Make::Ground]);
    assert_eq!(makes(&selected(&["screw_make=caged"])), [Make::Ground]);
    assert_eq!(makes(&selected(&["accuracy_grade=P3"])), [Make::Ground]);
    let near = |a: f64, b: f64| (1e3 * a - b).abs() < 1e-9;
    let is_rolled_only = |nut: &&Candidate| {
        near(nut.size.diameter, 25.0) && near(nut.nut.lead, 10.0) && near(nut.size.ball, 6.35)
    };
    let nuts = selected(&[]);
    let nut = nuts.iter().find(is_rolled_only).expect("a rolled screw");
    assert_eq!(nut.size.make(), Some(Make::Rolled));
    assert_eq!(candidate_case(nut, None)["screw_make"], "rolled");
    assert_eq!(selected(&["accuracy_grade=P3"]).iter().find(is_rolled_only), None);
    assert_eq!(selected(&["screw_make=ground"]).iter().find(is_rolled_only), None);
}

/// The nut of THK's 50 x 50 mm screw with 7.2 turns has four circuits of 1.8 turns, one on each of
/// four thread starts. The lead has room for all four circuits, and the case of the nut contains
/// the numbers of starts and circuits. The nut used to be 510 mm long, because all turns were
/// assumed to be on one thread.
#[test]
fn large_lead_nut_has_one_circuit_per_thread_start() {
    let manufacturers = Catalog::manufacturers().expect("compiled in");
    let is_large = |nut: &Candidate| {
        let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
        near(nut.nut.lead, 50e-3) && near(nut.nut.turns, 7.2) && near(nut.size.diameter, 50e-3)
    };
    let all = all_nuts(&manufacturers);
    let nut = all.iter().find(|nut| is_large(nut)).expect("in the list");
    assert!((nut.nut.starts - 4.0).abs() < 1e-12);
    assert!((nut.body.length - 12.5e-3 * 10.2).abs() < 1e-12, "{}", nut.body.length);
    assert!(all.iter().all(|nut| nut.nut.turns * nut.nut.pitch() < nut.body.length));
    let case = candidate_case(nut, None);
    let of = |name: &str| case[name].as_f64().expect("a number");
    // The values match the catalog digit for digit, because the conversion from meters adds no
    // rounding error.
    let given = ["starts", "circuits_count", "ball_diameter_mm"].map(|name| of(name).to_string());
    assert_eq!(given, ["4", "4", "7.938"]);
}

/// A condition on a column of text keeps the rows with exactly this text. If no row has the text,
/// the reason states the texts in the column.
#[test]
fn conditions_select_rows_by_text() {
    let table =
        b"nut,supplier,nominal_diameter_mm,lead_mm,rated_dynamic_load_N,rated_static_load_N\n\
        small,A,40,20,52000,88000\n\
        large,B,50,20,80000,150000\n";
    let nuts = ManufacturerNut::from_csv(table, &TableFormat::default()).expect("a table");
    let rows = ManufacturerRow::all(&nuts, None).expect("two nuts");
    let columns = ListColumn::of_rows(&rows);
    let filter = |condition: &str| NutFilter::new(&[condition.to_owned()], &columns, false);
    for (condition, name) in [("supplier=B", "large"), ("nut=small", "small")] {
        let list = filter(condition).expect("a condition").choose_rows(rows.clone());
        let names: Vec<_> = list.rows_within().iter().map(|row| row.name.clone()).collect();
        assert_eq!(names, [name], "{condition}");
    }
    let list = filter("supplier=C").expect("a condition").choose_rows(rows.clone());
    assert_eq!(list.reasons, ["supplier=C: the column of 2 nuts contains A, B"]);
    let error = filter("supplier>=B").expect_err("not a number").to_string();
    assert!(error.contains("has the form name=text"), "{error}");
    let error = NutFilter::default().sorted_by("supplier", false, &columns).expect_err("a text");
    assert!(error.to_string().contains("sorting needs a column of numbers"), "{error}");
}
