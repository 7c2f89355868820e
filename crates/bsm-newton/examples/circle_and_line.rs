//! Calculates the intersection of a circle and a line with the damped Newton iteration.
//!
//! Run the example with `cargo run -p bsm-newton --example circle_and_line`.
#![expect(clippy::print_stdout, reason = "the result of an example")]

use bsm_newton::{Equations, EvalError, Linearized, Options, Scales, Workspace, solve};

/// Equations of the circle `$x^2 + y^2 = r^2$` and the line `$y = p x$`.
struct CircleAndLine {
    radius: f64,
    slope: f64,
}

impl Equations<2> for CircleAndLine {
    type Details = ();
    type Slopes = ();

    fn residual(&self, &[x, y]: &[f64; 2]) -> Result<([f64; 2], ()), EvalError> {
        Ok(([x * x + y * y - self.radius * self.radius, y - self.slope * x], ()))
    }

    fn linearize(&self, z: &[f64; 2], rows: &mut [[f64; 2]; 2]) -> Linearized<2, Self> {
        *rows = [[2.0 * z[0], 2.0 * z[1]], [-self.slope, 1.0]];
        let (residual, details) = self.residual(z)?;
        Ok((residual, details, ()))
    }
}

fn main() {
    let (mut z, ones) = ([3.0, 0.5], [1.0; 2]);
    let scales = Scales { x: &ones, f: &ones };
    let system = CircleAndLine { radius: 2.0, slope: 1.0 };
    let outcome = solve(&system, &mut z, &scales, &Options::default(), &mut Workspace::default());
    let report = &outcome.report;
    println!(
        "{} after {} steps: x = {:.9}, y = {:.9}",
        report.status,
        report.steps.len(),
        z[0],
        z[1]
    );
}
