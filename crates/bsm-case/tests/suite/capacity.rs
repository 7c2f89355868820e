//! Tests of general properties of nut ratings. Published values are checked by `bsm validate`.

use bsm_case::{Case, CaseError, NutProblem, Settings, output, ratings};
use bsm_dyn::{Model, ModelWorkspace};

use crate::named;

const NUT: &[u8] = include_bytes!("../../../../examples/nut.json");

fn nut(changes: &[(&str, f64)]) -> Case {
    let mut case = Case::from_json(NUT).expect("an example");
    for (name, value) in changes {
        case.set(name, *value).expect("known name");
    }
    case
}

fn numbers(case: &Case) -> impl Fn(&str) -> f64 + use<> {
    let answer = ratings(case).expect("complete");
    move |name| answer.number(named(name)).unwrap_or(f64::NAN)
}

/// More turns carry more load: at the same load per turn, C_a is proportional to i^0.86, and C_0a
/// and the stiffness are proportional to i.
#[test]
fn ratings_grow_with_the_number_of_turns() {
    let one = numbers(&nut(&[("loaded_turns", 1.0), ("axial_load_N", 1000.0)]));
    let four = numbers(&nut(&[("loaded_turns", 4.0), ("axial_load_N", 4000.0)]));
    let ratio = |name: &str| four(name) / one(name);
    // Between the two cases, both the load and the number of turns change by a factor of exactly 4,
    // so the ratios of the results differ from the exact values only by rounding errors.
    assert!((ratio("dynamic_load_rating_N") - 4.0_f64.powf(0.86)).abs() < 1e-12);
    assert!((ratio("static_load_rating_N") - 4.0).abs() < 1e-12);
    assert!((ratio("contact_displacement_um") - 1.0).abs() < 1e-12);
    assert!((ratio("single_nut_tangent_stiffness_N_um") - 4.0).abs() < 1e-12);
}

/// The tangent stiffness equals a finite difference of the load-displacement curve, and the secant
/// stiffness equals the load divided by the displacement.
#[test]
fn tangent_stiffness_is_the_derivative_of_load_with_respect_to_displacement() {
    let displacement = |load| numbers(&nut(&[("axial_load_N", load)]))("contact_displacement_um");
    let (load, step) = (2e4, 1.0);
    let slope = 2.0 * step / (displacement(load + step) - displacement(load - step));
    let numbers = numbers(&nut(&[("axial_load_N", load)]));
    let stiffness = numbers("tangent_contact_stiffness_N_um");
    let secant = load / numbers("contact_displacement_um");
    assert!((secant / numbers("secant_contact_stiffness_N_um") - 1.0).abs() < 1e-12);
    // The relative truncation error of the finite difference is (step/load)², and its rounding
    // error is 1e-16 times 2e4.
    assert!((slope / stiffness - 1.0).abs() < 1e-8, "{slope} {stiffness}");
}

/// A small load does not change the contact angles, so the elastic model gives the same
/// displacement as the rating formulas.
#[test]
fn displacement_at_small_load_matches_the_elastic_model() {
    let load = 10.0;
    let case = nut(&[
        ("axial_load_N", load),
        ("loaded_balls", 96.0),
        ("friction_coefficient", 0.0),
        ("screw_speed_rpm", 1.0),
    ]);
    let settings: Settings = Model::RacewayControl.into();
    let solution = case.problem(&settings).expect("complete").solve(&mut ModelWorkspace::default());
    let model = 1e6 * solution.result.expect("converged").ball.axial_displacement.expect("elastic");
    let ours = numbers(&case)("contact_displacement_um");
    // The contact angles change by the ratio of the contact deformation to the distance between the
    // arc centers, here 1e-4.
    assert!((model / ours - 1.0).abs() < 3e-4, "{model} {ours}");
}

/// The displacement is measured along the axis. Measured along the binormal, the displacement would
/// be multiplied by the cosine of the lead angle, which reduces the displacement by 0.3 % and 4.4 %
/// at the two leads.
#[test]
fn solve_and_nut_commands_report_the_same_axial_displacement() {
    let settings: Settings = Model::RacewayControl.into();
    for lead in [10.0, 40.0] {
        let json = include_bytes!("../../../../examples/feed_drive.json");
        let mut case = Case::from_json(json).expect("an example");
        for (name, value) in [("lead_mm", lead), ("screw_speed_rpm", 1.0)] {
            case.set(name, value).expect("known name");
        }
        let problem = case.problem(&settings).expect("complete");
        let solution = problem.solve(&mut ModelWorkspace::default());
        let of_solve =
            solution.result.expect("converged").ball.axial_displacement.expect("elastic");
        let nut = NutProblem::of(&case, &settings).expect("a nut").solve().expect("a state");
        let of_nut = nut.number(output!(nut_displacement_um)).expect("a displacement");
        // The tolerance is ten times the ratio of centrifugal force to load, which is 1e-9 at 1
        // rpm.
        assert!((1e6 * of_solve / of_nut - 1.0).abs() < 1e-8, "{lead}: {of_solve} {of_nut}");
    }
}

#[test]
fn nuts_that_cannot_be_rated_are_reported() {
    let mut case = nut(&[]);
    case.loaded_turns = None;
    case.screw_conformity = None;
    let error = ratings(&case).expect_err("inputs are missing").to_string();
    assert!(error.contains("screw_conformity and loaded_turns are required"), "{error}");
    let case = nut(&[("loaded_turns", -1.0)]);
    assert!(matches!(ratings(&case), Err(CaseError::OutOfRange { .. })));
    let flat = nut(&[("nut_conformity", 50.0), ("screw_conformity", 50.0)]);
    let error = ratings(&flat).expect_err("no ellipse").to_string();
    assert!(error.contains("towards 0.52"), "{error}");
    let heavy = ratings(&nut(&[("axial_load_N", 2e5)])).expect("complete");
    assert!(heavy.warnings[0].contains("exceeds the dynamic load rating"), "{heavy:?}");
}

/// The ratings used to contain no note that temperature rises change the preload, or that the axial
/// load excludes the weight.
#[test]
fn ratings_report_warns_about_inputs_that_do_not_affect_the_ratings() {
    let told =
        |changes: &[(&str, f64)]| ratings(&nut(changes)).expect("complete").warnings.join("\n");
    let (warm, heavy) =
        ("Temperature rises change the preload", "without weight and guide friction");
    let preloaded = [("preload_N", 2000.0), ("screw_temperature_rise_K", 5.0)];
    assert!(told(&preloaded).contains(warm) && !told(&preloaded).contains(heavy));
    assert!(!told(&[("preload_N", 2000.0), ("screw_temperature_rise_K", 0.0)]).contains(warm));
    let moved = told(&[("axial_load_N", 2000.0), ("moved_mass_kg", 100.0)]);
    assert!(moved.contains(heavy) && !moved.contains(warm), "{moved}");
}

/// An audit found that the displacement of a preloaded pair was 13.71 um for every load. The
/// expected values were calculated by hand from eqs. 7 and 9 of Sobolewski (2002). All their digits
/// are compared.
#[test]
fn displacement_of_a_preloaded_pair_depends_on_the_load() {
    let pair = numbers(&nut(&[("preload_N", 15_500.0), ("axial_load_N", 30_000.0)]));
    assert!((pair("preload_displacement_um") - 13.692).abs() < 5e-4);
    assert!((pair("contact_displacement_um") - 8.8332).abs() < 5e-5);
    let ratio =
        30_000.0 / pair("contact_displacement_um") / pair("preloaded_contact_stiffness_N_um");
    assert!((ratio - 1.0).abs() < 1e-12);
    let alone = numbers(&nut(&[("preload_N", 15_500.0)]));
    assert!(alone("contact_displacement_um").is_nan());
}

/// An audit found that no warnings were given for a preload of 0.39 times the rating (eq. 6), a
/// load of five times the preload (eq. 8), nine turns, a large ball, and lands that do not retain
/// the balls.
#[test]
fn violated_recommendations_of_sobolewski_are_reported() {
    let warnings =
        |changes: &[(&str, f64)]| ratings(&nut(changes)).expect("complete").warnings.join("\n");
    assert_eq!(warnings(&[]), "");
    for (changes, words) in [
        (&[("preload_N", 40_000.0)][..], "preload_N is 0.386 times the dynamic load rating"),
        (
            &[("preload_N", 15_500.0), ("axial_load_N", 80_000.0)],
            "Above 43841 N (with equal ball loads), one nut is unloaded",
        ),
        (&[("loaded_turns", 9.0)], "loaded_turns = 9: 2 to 6 turns are typical"),
        (&[("lead_mm", 12.0)], "The ball diameter is 0.833 times the groove pitch"),
        (
            &[("pitch_circle_diameter_mm", 27.0), ("loaded_balls_per_turn", 6.0)],
            "times the root diameter",
        ),
        (
            &[("nut_conformity", 0.58)],
            "nut_conformity = 0.58, but the rating formulas were fitted for",
        ),
        (&[("nut_bore_mm", 72.0)], "the land begins at"),
        (&[("nut_bore_mm", 70.0)], "and truncates the ellipse"),
    ] {
        let told = warnings(changes);
        assert!(told.contains(words), "{changes:?}: {told}");
    }
}

/// The distance between the groove bottoms can be given instead of the contact angle. The following
/// inputs are rejected: both the distance and the angle, a distance for which no contact angle
/// exists, a play that the arcs do not permit, and a screw that is wider than the nut bore.
#[test]
fn groove_bottom_distance_can_replace_the_contact_angle() {
    let mut case = nut(&[]);
    let setting = |name: &str, value: f64| [format!("{name}={value}")];
    case.apply(&setting("groove_bottom_distance_mm", 10.5)).expect("a setting");
    let angle = ratings(&case).expect("complete").number(output!(contact_angle_deg));
    // The contact angle of 60 deg follows from the distance between the arc centers: cos 60 deg =
    // 1/2.
    assert!((angle.expect("a row") - 60.0).abs() < 1e-9, "{angle:?}");
    let thread = numbers(&case);
    let bottoms = 0.5 * (thread("nut_core_diameter_mm") - thread("screw_core_diameter_mm"));
    assert!((bottoms - 10.5).abs() < 1e-12, "{bottoms}");
    for (changes, words) in [
        (&[("axial_play_um", 1415.0)][..], "must be <= 1414.214 um"),
        (&[("screw_outer_diameter_mm", 65.0)], "> 65 mm, the outer diameter of the screw"),
    ] {
        let error = ratings(&nut(changes)).expect_err(words).to_string();
        assert!(error.contains(words), "{error}");
    }
    let both = Case { contact_angle_deg: Some(60.0), ..case.clone() };
    let error = ratings(&both).expect_err("two forms").to_string();
    assert!(error.contains("both are given"), "{error}");
    case.groove_bottom_distance_mm = Some(12.0);
    let error = ratings(&case).expect_err("no angle").to_string();
    assert!(
        error.contains(
            "between the ball diameter of 10.0000 mm and the sum of the groove radii, 11.0000 mm"
        ),
        "{error}"
    );
}
