//! Comparison of a table row with a single solve of the same operating point.

use bsm_batch::Answers;
use bsm_case::{Case, InputKey, Output, Record, output};
use bsm_dyn::{Ball, Status};

/// Outputs that describe the iteration instead of the solution. They are not compared.
const ITERATION_OUTPUTS: [&str; 3] = ["iterations", "residual_norm", "power_balance"];

/// Outputs that are error bounds. A bound is at least 1e-9 and equals ten times the difference
/// between two efficiencies. Each efficiency is accurate to 1e-12, so the relative error of the
/// bound is at most about one percent.
const BOUNDS: [&str; 2] = ["efficiency_error_bound", "loss_error_bound"];

/// Returns the absolute tolerance of an output, which is added to the relative tolerance.
///
/// Newton's method stops at a residual of 1e-13 times the load or 1e-12 times the inertia forces,
/// whichever is smaller. Rounding errors of the loads are about 1e-16. `iota` is the ratio of
/// inertia forces to load. Results that depend on inertia have errors that are proportional to
/// 1/`iota`.
fn absolute_tolerance(unit: &str, case: &Case) -> f64 {
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
        // The slip is a difference between large speeds, so its tolerance is proportional to these
        // speeds.
        "rad/s" => motion * speed * pitch / ball,
        "m/s" => motion * speed * pitch,
        // A displacement is a difference between lengths of up to 1 mm.
        "um" => 1e-11,
        // A power loss is a difference between large powers, so its tolerance is proportional to
        // these powers.
        "W" => 1e-12 * axial * pitch * speed,
        _ => 0.0,
    };
    // If inputs are missing, the tolerance is NaN, and 0 is returned instead.
    scatter.max(0.0)
}

/// Compares the results of a table row with a single solve of the same point. Both must have the
/// same status, and their outputs must agree to within 1e-10 of their value plus their absolute
/// tolerance. Returns true if the row converged.
pub(crate) fn assert_alike(
    what: &dyn Fn() -> String,
    (answers, row): (&Answers, usize),
    outputs: &[&Output],
    (expected, case): (&Record, &Case),
) -> bool {
    let status = answers.outcomes[row].status;
    assert_eq!(status, expected.status(), "{}", what());
    for (output, column) in outputs.iter().zip(&answers.columns) {
        if ITERATION_OUTPUTS.contains(&output.name) {
            continue;
        }
        let found = (!column[row].is_nan()).then_some(column[row]);
        let known = expected.value(output);
        let (name, unit) = (output.name, output.unit);
        assert_eq!(found.is_some(), known.is_some(), "{}, {name}", what());
        let (Some(found), Some(known)) = (found, known) else { continue };
        let part = if BOUNDS.contains(&name) { 1e-2 } else { 1e-10 };
        // Near a spin pole, the two calculations approach the solution of the discretized equations
        // from different sides, so their results differ slightly. The results agree to within 1e-4
        // of the error bound.
        let stated = expected.number(output!(loss_error_bound)).unwrap_or(0.0).max(0.0);
        let tolerance = (part + 1e-4 * stated) * known.abs() + absolute_tolerance(unit, case);
        let difference = (found - known).abs();
        assert!(difference <= tolerance, "{}, {name}: {found} {known}", what());
    }
    status == Status::Converged
}
