//! Ratings of a nut: published values are in `bsm validate`, here what must hold for all.

use bsm_case::{CapacityReport, CaseError, Scene, Settings};
use bsm_dyn::{Model, ModelWorkspace};

const NUT: &[u8] = include_bytes!("../../../examples/nut.json");

fn nut(changes: &[(&str, f64)]) -> Scene {
    let mut scene = Scene::from_json(NUT).expect("an example");
    for (name, value) in changes {
        scene.set(name, *value).expect("known name");
    }
    scene
}

fn numbers(scene: &Scene) -> impl Fn(&str) -> f64 + use<> {
    let rows = CapacityReport::of(scene, None).expect("complete").rows().to_vec();
    move |name| rows.iter().find(|(n, ..)| *n == name).map_or(f64::NAN, |row| row.2)
}

/// More turns carry more: C_a as i^0.86, C_0a and rigidity as i (at the load of one turn each).
#[test]
fn turns_add_up() {
    let one = numbers(&nut(&[("loaded_turns", 1.0), ("axial_load_N", 1000.0)]));
    let four = numbers(&nut(&[("loaded_turns", 4.0), ("axial_load_N", 4000.0)]));
    let ratio = |name: &str| four(name) / one(name);
    // Powers and products of exact factors: rounding only.
    assert!((ratio("dynamic_load_rating_N") - 4.0_f64.powf(0.86)).abs() < 1e-12);
    assert!((ratio("static_load_rating_N") - 4.0).abs() < 1e-12);
    assert!((ratio("axial_displacement_um") - 1.0).abs() < 1e-12);
    assert!((ratio("total_rigidity_N_um") - 4.0).abs() < 1e-12);
}

/// Rigidity is the slope of load over displacement.
#[test]
fn rigidity_is_a_derivative() {
    let displacement = |load| numbers(&nut(&[("axial_load_N", load)]))("axial_displacement_um");
    let (load, step) = (2e4, 1.0);
    let slope = 2.0 * step / (displacement(load + step) - displacement(load - step));
    let rigidity = numbers(&nut(&[("axial_load_N", load)]))("contact_rigidity_N_um");
    // The difference errs by (step/load)², its rounding by 1e-16 of 2e4.
    assert!((slope / rigidity - 1.0).abs() < 1e-8, "{slope} {rigidity}");
}

/// Under a small load contact angles do not change, and the elastic model of the balls gives the same
/// displacement; it takes that across the groove (J2), the ratings that along the axis.
#[test]
fn small_loads_displace_as_the_model_says() {
    let load = 10.0;
    let scene = nut(&[
        ("axial_load_N", load),
        ("loaded_balls", 96.0),
        ("friction_coefficient", 0.0),
        ("screw_speed_rpm", 1.0),
    ]);
    let settings: Settings = Model::RacewayControl.into();
    let solution =
        scene.problem(&settings).expect("complete").solve(&mut ModelWorkspace::default());
    let model = 1e6 * solution.answer.expect("converged").ball.axial_displacement.expect("elastic");
    let ours = numbers(&scene)("axial_displacement_um");
    let across = ours * (20.0 / (std::f64::consts::PI * 63.35)).atan().cos();
    // Angles turn by the approach over the distance of the arc centres, 1e-4 here.
    assert!((model / across - 1.0).abs() < 3e-4, "{model} {across}");
}

#[test]
fn what_cannot_be_rated_is_told() {
    let mut scene = nut(&[]);
    scene.loaded_turns = None;
    scene.screw_conformity = None;
    let error = CapacityReport::of(&scene, None).expect_err("inputs are missing").to_string();
    assert!(error.contains("screw_conformity and loaded_turns are required"), "{error}");
    let scene = nut(&[("loaded_turns", -1.0)]);
    assert!(matches!(CapacityReport::of(&scene, None), Err(CaseError::OutOfRange { .. })));
    let flat = nut(&[("nut_conformity", 50.0), ("screw_conformity", 50.0)]);
    let error = CapacityReport::of(&flat, None).expect_err("no ellipse").to_string();
    assert!(error.contains("towards 0.52"), "{error}");
    let heavy = CapacityReport::of(&nut(&[("axial_load_N", 2e5)]), None).expect("complete");
    assert!(heavy.warnings()[0].contains("more than the dynamic rating"), "{heavy:?}");
}
