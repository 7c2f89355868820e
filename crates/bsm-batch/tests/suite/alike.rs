//! Compares results of the batch with results of the model.

use bsm_batch::Answers;
use bsm_case::{Case, InputKey, Output, Record, output};
use bsm_dyn::{Ball, Status};

/// Outputs that describe the path to a root, not the root itself.
const OF_THE_WAY: [&str; 3] = ["iterations", "residual_norm", "power_balance"];

/// Outputs that bound an error. They are at least 1e-9 and ten times a difference of efficiencies.
/// Each efficiency is known to 1e-12 at a root with a residual of this size, so the bounds are
/// known to one per cent.
const BOUNDS: [&str; 2] = ["efficiency_error_bound", "loss_error_bound"];

/// Returns the absolute tolerance of an output, in addition to a tolerance relative to its size.
///
/// Newton's method of the model stops at 1e-13 of the load, or at 1e-12 of the inertia forces if
/// these are smaller, and rounding of the loads leaves about 1e-16. A result that depends on
/// inertia, which is `iota` of the load, is only known to this accuracy.
fn result_scatter(unit: &str, case: &Case) -> f64 {
    let value = |key| case.value_or_default(key).unwrap_or(f64::NAN);
    let ball = 0.5e-3 * value(InputKey::ball_diameter_mm);
    let pitch = 0.5e-3 * value(InputKey::pitch_circle_diameter_mm);
    let speed = (value(InputKey::screw_speed_rpm) - value(InputKey::nut_speed_rpm)).abs();
    let speed = speed * std::f64::consts::PI / 30.0;
    let axial = value(InputKey::axial_load_N);
    let load = axial / value(InputKey::loaded_balls);
    let mass = Ball::of_density(ball, value(InputKey::density_kg_m3)).mass;
    let iota = mass * pitch * speed * speed / load;
    let motion = 1e-10 + 1e-14 / iota;
    let scatter = match unit {
        "N" => 1e-13 * load,
        "deg" => 1e-10 * 90.0,
        // Slip is a difference of speeds of this magnitude.
        "rad/s" => motion * speed * pitch / ball,
        "m/s" => motion * speed * pitch,
        // Displacement is a difference of lengths of up to 1 mm.
        "um" => 1e-11,
        // Lost power is a difference of powers of this magnitude.
        "W" => 1e-12 * axial * pitch * speed,
        _ => 0.0,
    };
    // The value is NaN, and therefore 0, if inputs are missing.
    scatter.max(0.0)
}

/// Compares the answer of a row: the status must agree, and every output within 1e-10 of its size
/// plus its absolute tolerance. Returns true if the row converged.
pub(crate) fn assert_alike(
    what: &dyn Fn() -> String,
    (answers, row): (&Answers, usize),
    outputs: &[&Output],
    (expected, case): (&Record, &Case),
) -> bool {
    let status = answers.verdicts[row].status;
    assert_eq!(status, expected.status(), "{}", what());
    for (output, column) in outputs.iter().zip(&answers.columns) {
        if OF_THE_WAY.contains(&output.name) {
            continue;
        }
        let found = (!column[row].is_nan()).then_some(column[row]);
        let known = expected.value(output);
        let (name, unit) = (output.name, output.unit);
        assert_eq!(found.is_some(), known.is_some(), "{}, {name}", what());
        let (Some(found), Some(known)) = (found, known) else { continue };
        let part = if BOUNDS.contains(&name) { 1e-2 } else { 1e-10 };
        // Near a spin pole, a table and a single solve approach the root of the quadrature rule
        // from two sides. They agree within 1e-4 of their stated error.
        let stated = expected.number(output!(loss_error_bound)).unwrap_or(0.0).max(0.0);
        let tolerance = (part + 1e-4 * stated) * known.abs() + result_scatter(unit, case);
        let difference = (found - known).abs();
        assert!(difference <= tolerance, "{}, {name}: {found} {known}", what());
    }
    status == Status::Converged
}
