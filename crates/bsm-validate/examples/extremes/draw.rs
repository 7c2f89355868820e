//! Generates random operating points whose inputs are in extreme ranges.

use bsm_case::{Case, ModelChoice};
use bsm_dyn::{Model, angles::Angles};
use bsm_sample::Sample;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Returns the random point with the given number. The point depends on the seed and the number,
/// but not on the number of threads. If `edges` is true, the point is close to a value at which the
/// behavior changes.
pub(crate) fn point(seed: u64, number: usize, model: ModelChoice, edges: bool) -> Case {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(number as u64);
    let mut case = draw(&mut rng, model);
    if edges {
        move_to_an_edge(&mut case, &mut rng, model);
    }
    case
}

/// Moves one input close to a value at which the behavior changes.
fn move_to_an_edge(case: &mut Case, rng: &mut impl Rng, model: ModelChoice) {
    let far = rng.log_uniform(1e-12, 0.1);
    let next = if rng.random_bool(0.5) { 1.0 + far } else { 1.0 - far };
    let radians = |angle: Option<f64>| angle.expect("drawn").to_radians();
    let lead = radians(case.lead_angle_deg);
    let angles = Angles { lead, contact: radians(case.contact_angle_deg) };
    let turning = case.screw_speed_rpm.zip(case.nut_speed_rpm).map(|(screw, nut)| screw + nut);
    let together = rng.random_bool(0.5);
    // The speeds of screw and nut become almost equal. This is not possible in model
    // `quasi-static`, in which only one of them turns.
    if together && model != Model::QuasiStatic.into() {
        case.screw_speed_rpm = turning;
        case.nut_speed_rpm = turning.map(|speed| speed * next);
    } else {
        // Friction can just hold the load if f D = sinβ (Lin's Eq 16) or, at a contact angle of 90
        // deg, if f tanα = 1.
        let holds = angles.contact.sin() / angles.slip_factor();
        let steep = lead.tan() > 1.0 && rng.random_bool(0.5);
        let friction = if steep { lead.tan().recip() } else { holds };
        case.friction_coefficient = Some(friction * next);
    }
}

/// Returns a random point whose inputs are in the extreme ranges.
fn draw(rng: &mut impl Rng, model: ModelChoice) -> Case {
    let mut log = |low: f64, high: f64| {
        let x = rng.log_uniform(low, high);
        format!("{x:.6e}").parse().unwrap_or(x)
    };
    let (ball, ratio) = (log(0.1, 200.0), log(0.01, 0.45));
    let (load, speed, other) = (log(1e-6, 1e6), log(1e-3, 1e6), log(1e-3, 1e6));
    let friction = log(1e-6, 1.0);
    let (modulus, ball_modulus, density) = (log(1e-2, 1e3), log(1e-2, 1e3), log(500.0, 2e4));
    let (nut, screw) = (0.5 + log(1e-3, 0.3), 0.5 + log(1e-3, 0.3));
    let mut flip = |x: f64| if rng.random_bool(0.5) { x } else { -x };
    let (speed, other) = (flip(speed), flip(other));
    let (screw_speed, nut_speed) = match rng.random_range(0..5) {
        0 | 1 => (speed, 0.0),
        2 | 3 => (0.0, speed),
        // In model `quasi-static`, either the screw or the nut turns, but not both.
        _ if model == Model::QuasiStatic.into() => (speed, 0.0),
        _ => (speed, other),
    };
    // Models that include friction in the force balance reject a friction coefficient of zero.
    // Model `auto` also rejects it, because `auto` may choose such a model.
    let fixed = [Model::Rigid, Model::Elastic, Model::Traction].map(ModelChoice::from);
    let needs = model == ModelChoice::Auto || fixed.contains(&model);
    let friction = if !needs && rng.random_ratio(1, 50) { 0.0 } else { friction };
    Case {
        ball_diameter_mm: Some(ball),
        pitch_circle_diameter_mm: Some(ball / ratio),
        lead_angle_deg: Some(rng.random_range(0.05..85.0)),
        contact_angle_deg: Some(rng.random_range(1.0..89.0)),
        nut_conformity: Some(nut),
        screw_conformity: Some(screw),
        friction_coefficient: Some(friction),
        density_kg_m3: Some(density),
        youngs_modulus_GPa: Some(modulus),
        ball_youngs_modulus_GPa: Some(ball_modulus),
        screw_speed_rpm: Some(screw_speed),
        nut_speed_rpm: Some(nut_speed),
        axial_load_N: Some(load),
        loaded_balls: Some(1.0),
        ..Case::default()
    }
}
