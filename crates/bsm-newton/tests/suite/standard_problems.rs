//! Tests with standard nonlinear systems. They limit the cost of the solves and include problems on
//! which the solver is expected to fail.
//!
//! The problems, their numbers and their roots come from Moré, Garbow and Hillstrom, *Testing
//! Unconstrained Optimization Software*, ACM Trans. Math. Softw. 7 (1981).

use bsm_newton::{
    Convergence, Equations, EvalError, JacobianUpdate, Linearized, NoSlopes, Options, Report,
    Scales, Singular, Termination, Workspace, WorstEquation, implicit_slopes, path_direction,
    solve,
};

/// Residual and rows of the Jacobian at a point.
type Values<const N: usize> = Result<([f64; N], [[f64; N]; N]), EvalError>;

/// A system of equations, given by a function that returns its residual and its Jacobian.
struct Problem<F>(F);

impl<const N: usize, F> Equations<N> for Problem<F>
where
    F: Fn(&[f64; N]) -> Values<N>,
{
    /// Point at which the residual was evaluated.
    type Details = [f64; N];
    /// Point at which the Jacobian was evaluated.
    type Slopes = [f64; N];

    fn residual(&self, x: &[f64; N]) -> Result<([f64; N], [f64; N]), EvalError> {
        Ok((self.0(x)?.0, *x))
    }

    fn linearize(&self, x: &[f64; N], rows: &mut [[f64; N]; N]) -> Linearized<N, Self> {
        let values;
        (values, *rows) = self.0(x)?;
        Ok((values, *x, *x))
    }

    fn equation(&self, i: usize) -> String {
        format!("row {i} of {N}")
    }
}

fn solve_equations<const N: usize, F>(function: F, x: &mut [f64; N]) -> Report
where
    F: Fn(&[f64; N]) -> Values<N>,
{
    let ones = [1.0; N];
    let scales = Scales { x: &ones, f: &ones };
    solve(&Problem(function), x, &scales, &Options::default(), &mut Workspace::default()).report
}

#[expect(clippy::unnecessary_wraps, reason = "all problems have the same signature")]
fn rosenbrock(x: &[f64; 2]) -> Values<2> {
    Ok(([10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]], [[-20.0 * x[0], 10.0], [-1.0, 0.0]]))
}

#[expect(clippy::unnecessary_wraps, reason = "all problems have the same signature")]
fn powell_badly_scaled(x: &[f64; 2]) -> Values<2> {
    let (e0, e1) = ((-x[0]).exp(), (-x[1]).exp());
    Ok(([1e4 * x[0] * x[1] - 1.0, e0 + e1 - 1.0001], [[1e4 * x[1], 1e4 * x[0]], [-e0, -e1]]))
}

#[expect(clippy::unnecessary_wraps, reason = "all problems have the same signature")]
fn powell_singular(x: &[f64; 4]) -> Values<4> {
    let (s5, s10) = (5.0_f64.sqrt(), 10.0_f64.sqrt());
    let (a, b) = (x[1] - 2.0 * x[2], x[0] - x[3]);
    Ok((
        [x[0] + 10.0 * x[1], s5 * (x[2] - x[3]), a * a, s10 * b * b],
        [
            [1.0, 10.0, 0.0, 0.0],
            [0.0, 0.0, s5, -s5],
            [0.0, 2.0 * a, -4.0 * a, 0.0],
            [2.0 * s10 * b, 0.0, 0.0, -2.0 * s10 * b],
        ],
    ))
}

/// The equation ln x = 0, which returns an error for x ≤ 0.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "all problems have the same signature")]
fn logarithm(x: &[f64; 1]) -> Values<1> {
    if x[0] > 0.0 {
        Ok(([x[0].ln()], [[1.0 / x[0]]]))
    } else {
        Err(EvalError { quantity: "x", value: x[0], requirement: "x > 0" })
    }
}

/// Problem 1 (Rosenbrock): the monotone line search follows the curved valley.
#[test]
fn rosenbrock_needs_at_most_ten_steps() {
    let mut x = [-1.2, 1.0];
    let report = solve_equations(rosenbrock, &mut x);
    assert_eq!(report.status, Termination::Converged, "{report:?}");
    assert!((x[0] - 1.0).abs() < 1e-14 && (x[1] - 1.0).abs() < 1e-14, "{x:?}");
    // These limits are the numbers of steps and evaluations that the monotone line search of Dennis
    // and Schnabel needs.
    assert!(report.steps.len() <= 10 && report.n_residual <= 33, "{report:?}");
    assert_eq!(report.n_jacobian, report.steps.len(), "{report:?}");
}

/// Problem 3 (Powell, badly scaled): the published root is (1.098e-5, 9.106). The monotone line
/// search first follows a narrow valley in small steps. Refining the solution below the tolerance
/// then takes only a few more steps.
#[test]
fn powell_badly_scaled_finds_the_published_root() {
    let ones = [1.0; 2];
    let mut path = Vec::new();
    for residual_goal in [1e-10, 0.0] {
        let convergence = Convergence { max_steps: 300, residual_goal, ..Convergence::default() };
        let options = Options { convergence, ..Options::default() };
        let mut x = [0.0, 1.0];
        let scales = Scales { x: &ones, f: &ones };
        let system = Problem(powell_badly_scaled);
        let report = solve(&system, &mut x, &scales, &options, &mut Workspace::default()).report;
        assert_eq!(report.status, Termination::Converged, "{report:?}");
        // The tolerance is the rounding error of the published four digits.
        assert!((x[0] - 1.098e-5).abs() < 5e-9 && (x[1] - 9.106).abs() < 5e-4, "{x:?}");
        path.push(report);
    }
    assert!(path[0].n_jacobian <= 53, "{:?}", path[0]);
    // The tolerance is the rounding error of 1e4 x y − 1. At most two more steps are needed to
    // reach this tolerance.
    assert!(path[1].residual <= 1e-15, "{:?}", path[1]);
    assert!(path[1].steps.len() <= path[0].steps.len() + 2, "{:?}", path[1]);
}

/// Problem 13 (Powell, singular): the Jacobian is singular at the root, so convergence is only
/// linear, with a factor of 1/4 per step.
#[test]
fn powell_singular_converges_linearly() {
    let mut x = [3.0, -1.0, 0.0, 1.0];
    let report = solve_equations(powell_singular, &mut x);
    assert_eq!(report.status, Termination::Converged, "{report:?}");
    for pair in report.steps.windows(2).skip(1) {
        let ratio = pair[1].residual / pair[0].residual;
        // In exact arithmetic, each step reduces the residual to one quarter.
        assert!((ratio - 0.25).abs() < 1e-3, "{report:?}");
    }
    assert!(report.n_jacobian <= 19, "{report:?}");
}

#[test]
fn newton_converges_quadratically_near_the_root() {
    let report = solve_equations(logarithm, &mut [1.1]);
    assert_eq!(report.status, Termination::Converged);
    let r: Vec<f64> = report.steps.iter().map(|s| s.residual).collect();
    assert!(r.len() >= 3, "{report:?}");
    for pair in r.windows(2) {
        assert!(pair[1] <= pair[0].powi(2), "{r:?}");
    }
}

#[test]
fn newton_step_out_of_the_domain_is_halved() {
    let mut x = [4.0];
    let report = solve_equations(logarithm, &mut x);
    assert_eq!(report.status, Termination::Converged);
    assert!((x[0] - 1.0).abs() < 1e-10);
    assert!(report.steps[0].lambda < 1.0);
    assert_eq!(report.n_jacobian, report.steps.len());
}

/// The residual and the details belong to the returned point, even if a refining step was rejected.
/// The slopes belong to the point at which the last Jacobian was evaluated.
#[test]
fn outcome_contains_residual_and_details_at_the_returned_point() {
    let rough = |x: &[f64; 1]| {
        let noise = if x[0].to_bits().is_multiple_of(2) { 1e-13 } else { -1e-13 };
        Ok(([x[0] * x[0] - 2.0 + noise], [[2.0 * x[0]]]))
    };
    for jacobian in [JacobianUpdate::EveryStep, JacobianUpdate::EveryTrial { chord_below: 0.1 }] {
        let convergence = Convergence { residual_goal: 0.0, ..Convergence::default() };
        let options = Options { convergence, jacobian, ..Options::default() };
        let (mut x, ones, system) = ([1.0], [1.0], Problem(rough));
        let scales = Scales { x: &ones, f: &ones };
        let outcome = solve(&system, &mut x, &scales, &options, &mut Workspace::default());
        assert!(outcome.converged(), "{:?}", outcome.report);
        let (residual, details) = outcome.last.expect("evaluated");
        assert_eq!(details.map(f64::to_bits), x.map(f64::to_bits));
        let again = system.residual(&x).expect("in the domain").0;
        assert_eq!(residual.map(f64::to_bits), again.map(f64::to_bits));
        let [at] = outcome.slopes.expect("a Jacobian");
        // The chord method uses the Jacobian from a nearby point.
        assert!((at - x[0]).abs() < 0.1, "{at} {x:?}");
    }
}

/// If the slope of the function has changed sign, a chord step increases the residual or leads to
/// NaN. The next step then uses the Jacobian at the current point, and its residual is compared
/// with the residual at the current point.
#[test]
fn chord_step_that_increases_the_residual_is_followed_by_a_newton_step() {
    let bent = |x: &[f64; 1]| match x[0] {
        x if x >= 0.5 => Ok(([x], [[1.0]])),
        x if x >= -0.01 => Ok(([0.05 - 10.0 * x], [[-10.0]])),
        _ => Ok(([f64::NAN], [[f64::NAN]])),
    };
    let (mut x, ones) = ([1.0], [1.0]);
    let jacobian = JacobianUpdate::EveryTrial { chord_below: f64::INFINITY };
    let options = Options { jacobian, ..Options::default() };
    let scales = Scales { x: &ones, f: &ones };
    let report = solve(&Problem(bent), &mut x, &scales, &options, &mut Workspace::default()).report;
    assert_eq!(report.status, Termination::Converged, "{report:?}");
    // The tolerance is the rounding error of the last step.
    assert!((x[0] - 0.005).abs() < 1e-17, "{x:?}");
    assert_eq!((report.n_jacobian, report.n_residual), (2, 3), "{report:?}");
    assert_eq!(report.steps.iter().map(|s| s.residual).collect::<Vec<_>>(), [1.0, 0.05]);
}

/// The failure is expected: x² + 1 has no root, so the line search ends near the minimum of the
/// squared residual.
#[test]
fn equation_without_root_ends_with_a_failed_line_search() {
    let report =
        solve_equations(|x: &[f64; 1]| Ok(([x[0] * x[0] + 1.0], [[2.0 * x[0]]])), &mut [0.7]);
    assert_eq!(report.status, Termination::LineSearchFailed, "{report:?}");
    assert!(report.residual >= 1.0);
}

/// The failure is expected because the Jacobian has a zero column.
#[test]
fn singular_jacobian_is_reported() {
    let report = solve_equations(
        |x: &[f64; 2]| Ok(([x[0] - 1.0, x[0] - 2.0], [[1.0, 0.0], [1.0, 0.0]])),
        &mut [0.0, 0.0],
    );
    assert_eq!(report.status, Termination::SingularJacobian);
    let worst = WorstEquation { index: 1, name: "row 1 of 2".to_owned() };
    assert_eq!(report.worst, Some(worst));
    assert_eq!(report.steps.len(), 0);
}

/// The failure is expected because the model returns NaN, which the solver detects.
#[test]
fn nan_residual_is_reported() {
    let report = solve_equations(
        |x: &[f64; 2]| Ok(([x[0], f64::NAN], [[1.0, 0.0], [0.0, 1.0]])),
        &mut [1.0, 1.0],
    );
    assert_eq!(report.status, Termination::NotFinite);
    assert_eq!(report.worst.map(|worst| worst.index), Some(1));
}

/// The failure is expected because the starting point is outside the domain.
#[test]
fn start_outside_the_domain_is_reported() {
    let report = solve_equations(logarithm, &mut [-1.0]);
    assert_eq!(report.status, Termination::OutsideDomain);
    assert_eq!(report.worst, None);
}

/// The failure is expected because the step falls below the limit of (N3) while the residual still
/// exceeds its tolerance.
#[test]
fn iteration_with_tiny_steps_is_reported_as_stalled() {
    let report = solve_equations(|x: &[f64; 1]| Ok(([1.0 + 0.0 * x[0]], [[1e20]])), &mut [1.0]);
    assert_eq!(report.status, Termination::Stalled, "{report:?}");
}

/// The failure is expected because the maximum number of steps is too small.
#[test]
fn step_limit_is_reported() {
    let ones = [1.0; 4];
    let convergence = Convergence { max_steps: 3, ..Convergence::default() };
    let options = Options { convergence, ..Options::default() };
    let scales = Scales { x: &ones, f: &ones };
    let mut x = [3.0, -1.0, 0.0, 1.0];
    let system = Problem(powell_singular);
    let report = solve(&system, &mut x, &scales, &options, &mut Workspace::default()).report;
    assert_eq!(report.status, Termination::MaxSteps);
    assert_eq!(report.steps.len(), 3);
    let name = report.worst.map(|worst| worst.name);
    assert!(name.is_some_and(|name| name.starts_with("row ")));
}

/// The failure is expected because a scaling factor is not positive and finite.
#[test]
fn invalid_scale_is_reported() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let (good, bad) = ([1.0; 2], [1.0, bad]);
        for scales in [Scales { x: &good, f: &bad }, Scales { x: &bad, f: &good }] {
            let mut x = [0.0; 2];
            let (system, work) = (Problem(rosenbrock), &mut Workspace::default());
            let report = solve(&system, &mut x, &scales, &Options::default(), work).report;
            assert_eq!(report.status, Termination::BadScale, "{bad:?}");
            assert_eq!((report.worst, report.n_residual), (None, 0));
        }
    }
}

/// A circle of radius r and a line of slope p intersect at x = r/√(1 + p²), y = p x.
#[test]
fn derivatives_of_a_root_match_the_closed_form() {
    let (r, p) = (1.7_f64, 0.6_f64);
    let root = (1.0 + p * p).sqrt();
    let x = [r / root, p * r / root];
    let system = Problem(move |x: &[f64; 2]| {
        let f = [x[0] * x[0] + x[1] * x[1] - r * r, x[1] - p * x[0]];
        Ok((f, [[2.0 * x[0], 2.0 * x[1]], [-p, 1.0]]))
    });
    // The columns are ∂F/∂r and ∂F/∂p. The scaling factors must not influence the result.
    let mut columns = [[-2.0 * r, 0.0], [0.0, -x[0]]];
    let mut work = Workspace::default();
    implicit_slopes(&system, &x, &[1e-3, 50.0], &mut columns, &mut work).expect("a regular root");
    let cube = root.powi(3);
    let expected = [x[0] / r, x[1] / r, -p * r / cube, r / root - p * p * r / cube];
    for (slope, expected) in columns.iter().flatten().zip(expected) {
        // The tolerance allows for rounding errors of two equations with a condition number of 10.
        assert!((slope - expected).abs() <= 1e-14, "{columns:?}");
    }
}

/// The solution curve is the line 2x = 0, 3y = 0, and the last row of the Jacobian belongs to the
/// plane -z/2 = 0, which intersects the curve. For either order of the first two rows, the
/// component of the tangent along the normal of the plane has the sign of the determinant. The
/// length of the tangent is the reciprocal of the coefficient of the plane.
#[test]
fn orientation_of_the_path_tangent_follows_the_sign_of_the_jacobian_determinant() {
    let rows = [[2.0, 0.0, 0.0], [0.0, 3.0, 0.0]];
    for (order, sense) in [([0, 1], 1.0), ([1, 0], -1.0)] {
        let system = Problem(|_: &[f64; 3]| {
            Ok(([0.0; 3], [rows[order[0]], rows[order[1]], [0.0, 0.0, -0.5]]))
        });
        let work = &mut Workspace::default();
        let direction = path_direction(&system, &[0.0; 3], &[1.0; 3], work).expect("regular");
        // The determinant is -3 · sense, so t_z = sgn(det) / (-0.5) = 2 · sense.
        assert!((direction[2] - 2.0 * sense).abs() < 1e-15, "{direction:?}");
        assert!(direction[0].abs() + direction[1].abs() == 0.0, "{direction:?}");
    }
    let touching = Problem(|_: &[f64; 2]| Ok(([0.0; 2], [[1.0, 0.0], [1.0, 0.0]])));
    let work = &mut Workspace::default();
    let none = path_direction(&touching, &[0.0; 2], &[1.0; 2], work);
    assert_eq!(none, None);
}

#[test]
fn missing_derivatives_of_a_root_are_reported() {
    let work = &mut Workspace::default();
    let singular =
        implicit_slopes(&Problem(powell_singular), &[0.0; 4], &[1.0; 4], &mut [[1.0; 4]], work);
    assert_eq!(singular, Err(NoSlopes::Singular(Singular)));
    let work = &mut Workspace::<1>::default();
    let refused = implicit_slopes(&Problem(logarithm), &[-1.0], &[1.0], &mut [[1.0]], work);
    assert!(matches!(refused, Err(NoSlopes::Refused(_))), "{refused:?}");
}

/// The list of steps is the only memory allocation, regardless of the number of steps.
#[test]
fn newton_iteration_allocates_only_the_list_of_steps() {
    let ones = [1.0; 4];
    let scales = Scales { x: &ones, f: &ones };
    let mut work = Workspace::default();
    let system = Problem(powell_singular);
    for max_steps in [1, 40] {
        let convergence = Convergence { max_steps, ..Convergence::default() };
        let options = Options { convergence, ..Options::default() };
        let mut x = [3.0, -1.0, 0.0, 1.0];
        let mut steps = 0;
        let info = allocation_counter::measure(|| {
            let report = solve(&system, &mut x, &scales, &options, &mut work).report;
            steps = report.steps.len();
        });
        // If the iteration fails, creating and formatting the name of the worst equation also
        // allocates memory.
        let allowed = if max_steps == 1 { 3 } else { 1 };
        assert!(steps == 1 || steps == 19, "{steps}");
        assert!(info.count_total <= allowed, "{} allocations in {steps} steps", info.count_total);
    }
}
