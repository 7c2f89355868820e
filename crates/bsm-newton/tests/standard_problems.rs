//! Standard nonlinear systems with pinned costs, and the failures that must occur.
//!
//! Problems and roots: Moré, Garbow and Hillstrom, *Testing Unconstrained Optimization Software*,
//! ACM Trans. Math. Softw. 7 (1981), by their numbers there.

use bsm_newton::{
    EvalError, MatMut, NotConverged, Options, Report, Scales, Status, System, UsageError,
    Workspace, implicit_slopes, solve,
};

/// A system given by a function that returns values and rows of the Jacobian.
struct Given<const N: usize, F>(F);

impl<const N: usize, F> System for Given<N, F>
where
    F: Fn(&[f64]) -> Result<([f64; N], [[f64; N]; N]), EvalError>,
{
    fn dim(&self) -> usize {
        N
    }

    fn residual(&self, x: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        r.copy_from_slice(&self.0(x)?.0);
        Ok(())
    }

    fn linearize(
        &self,
        x: &[f64],
        r: &mut [f64],
        mut jac: MatMut<'_, f64>,
    ) -> Result<(), EvalError> {
        let (f, j) = self.0(x)?;
        r.copy_from_slice(&f);
        for (i, row) in j.iter().enumerate() {
            for (k, entry) in row.iter().enumerate() {
                jac[(i, k)] = *entry;
            }
        }
        Ok(())
    }

    fn equation(&self, i: usize) -> String {
        format!("row {i} of {N}")
    }
}

fn run<const N: usize, F>(function: F, x: &mut [f64; N]) -> Report
where
    F: Fn(&[f64]) -> Result<([f64; N], [[f64; N]; N]), EvalError>,
{
    let ones = [1.0; N];
    let scales = Scales { x: &ones, f: &ones };
    solve(&Given(function), x, &scales, &Options::default(), &mut Workspace::new(N))
        .expect("sizes match")
}

type Values<const N: usize> = Result<([f64; N], [[f64; N]; N]), EvalError>;

#[expect(clippy::unnecessary_wraps, reason = "the shape that a model has")]
fn rosenbrock(x: &[f64]) -> Values<2> {
    Ok(([10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]], [[-20.0 * x[0], 10.0], [-1.0, 0.0]]))
}

#[expect(clippy::unnecessary_wraps, reason = "the shape that a model has")]
fn powell_badly_scaled(x: &[f64]) -> Values<2> {
    let (e0, e1) = ((-x[0]).exp(), (-x[1]).exp());
    Ok(([1e4 * x[0] * x[1] - 1.0, e0 + e1 - 1.0001], [[1e4 * x[1], 1e4 * x[0]], [-e0, -e1]]))
}

#[expect(clippy::unnecessary_wraps, reason = "the shape that a model has")]
fn powell_singular(x: &[f64]) -> Values<4> {
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

/// ln x = 0, refused for x <= 0.
fn logarithm(x: &[f64]) -> Values<1> {
    if x[0] > 0.0 {
        Ok(([x[0].ln()], [[1.0 / x[0]]]))
    } else {
        Err(EvalError { quantity: "x", value: x[0], requirement: "x > 0" })
    }
}

/// No. 1: the monotone line search follows the curved valley.
#[test]
fn rosenbrock_takes_the_known_path() {
    let mut x = [-1.2, 1.0];
    let report = run(rosenbrock, &mut x);
    assert_eq!(report.status, Status::Converged, "{report}");
    assert!((x[0] - 1.0).abs() < 1e-14 && (x[1] - 1.0).abs() < 1e-14, "{x:?}");
    assert_eq!((report.steps.len(), report.n_jacobian, report.n_residual), (10, 10, 33));
}

/// No. 3: the root in the paper is 1.098e-5, 9.106. The monotone line search creeps along a
/// narrow valley first; going on below the tolerance then costs steps only as long as they help.
#[test]
fn powell_badly_scaled_finds_the_published_root() {
    let ones = [1.0; 2];
    let mut path = Vec::new();
    for residual_goal in [1e-10, 0.0] {
        let options = Options { max_steps: 300, residual_goal, ..Options::default() };
        let mut x = [0.0, 1.0];
        let scales = Scales { x: &ones, f: &ones };
        let system = Given(powell_badly_scaled);
        let report =
            solve(&system, &mut x, &scales, &options, &mut Workspace::new(2)).expect("sizes match");
        assert_eq!(report.status, Status::Converged, "{report}");
        // Four printed digits.
        assert!((x[0] - 1.098e-5).abs() < 5e-9 && (x[1] - 9.106).abs() < 5e-4, "{x:?}");
        path.push(report);
    }
    assert_eq!(path[0].n_jacobian, 53, "{}", path[0]);
    // Rounding of 1e4 x y against 1, reached with at most two more steps.
    assert!(path[1].residual <= 1e-15, "{}", path[1]);
    assert!(path[1].steps.len() <= path[0].steps.len() + 2, "{}", path[1]);
}

/// No. 13: a singular Jacobian at the root leaves linear convergence, a factor of four a step.
#[test]
fn powell_singular_converges_linearly() {
    let mut x = [3.0, -1.0, 0.0, 1.0];
    let report = run(powell_singular, &mut x);
    assert_eq!(report.status, Status::Converged, "{report}");
    for pair in report.steps.windows(2).skip(1) {
        let ratio = pair[1].residual / pair[0].residual;
        // Exactly 1/4 in exact arithmetic.
        assert!((ratio - 0.25).abs() < 1e-3, "{report}");
    }
    assert_eq!(report.n_jacobian, 19, "{report}");
}

#[test]
fn convergence_is_quadratic_at_the_root() {
    let report = run(logarithm, &mut [1.1]);
    assert_eq!(report.status, Status::Converged);
    let r: Vec<f64> = report.steps.iter().map(|s| s.residual).collect();
    assert!(r.len() >= 3, "{report}");
    for pair in r.windows(2) {
        assert!(pair[1] <= pair[0].powi(2), "{r:?}");
    }
}

#[test]
fn a_step_out_of_the_domain_is_halved() {
    let mut x = [4.0];
    let report = run(logarithm, &mut x);
    assert_eq!(report.status, Status::Converged);
    assert!((x[0] - 1.0).abs() < 1e-10);
    assert!(report.steps[0].lambda < 1.0);
    assert_eq!(report.refusal.map(|e| e.requirement), Some("x > 0"));
    assert_eq!(report.n_jacobian, report.steps.len());
}

/// Expected failure: x² + 1 has no root; the line search ends at the minimum of its square.
#[test]
fn no_root_ends_in_the_line_search_or_a_singular_jacobian() {
    let report = run(|x| Ok(([x[0] * x[0] + 1.0], [[2.0 * x[0]]])), &mut [0.7]);
    assert_eq!(report.status, Status::LineSearchFailed, "{report}");
    assert!(report.residual >= 1.0);
}

/// Expected failure: a zero column.
#[test]
fn a_singular_jacobian_is_told() {
    let report = run(|x| Ok(([x[0] - 1.0, x[0] - 2.0], [[1.0, 0.0], [1.0, 0.0]])), &mut [0.0, 0.0]);
    assert_eq!(report.status, Status::SingularJacobian);
    assert_eq!(report.worst_equation, 1);
    assert_eq!(report.worst_equation_name, "row 1 of 2");
    assert_eq!(report.steps.len(), 0);
}

/// Expected failure: a NaN is caught by the driver, not by the model.
#[test]
fn a_nan_is_told() {
    let report = run(|x| Ok(([x[0], f64::NAN], [[1.0, 0.0], [0.0, 1.0]])), &mut [1.0, 1.0]);
    assert_eq!(report.status, Status::NotFinite);
    assert_eq!(report.worst_equation, 1);
}

/// Expected failure: the start is outside the domain.
#[test]
fn a_refused_start_is_told() {
    let report = run(logarithm, &mut [-1.0]);
    assert_eq!(report.status, Status::ModelRefused);
    assert_eq!(report.refusal.map(|e| e.value.to_bits()), Some((-1.0_f64).to_bits()));
}

/// Expected failure: steps that shrink below `step_tol` above a root of a discontinuous function.
#[test]
fn tiny_steps_stall() {
    let report = run(|x| Ok(([1.0 + 0.0 * x[0]], [[1e20]])), &mut [1.0]);
    assert_eq!(report.status, Status::Stalled, "{report}");
}

/// Expected failure: the step limit.
#[test]
fn the_step_limit_is_told() {
    let ones = [1.0; 4];
    let options = Options { max_steps: 3, ..Options::default() };
    let scales = Scales { x: &ones, f: &ones };
    let mut x = [3.0, -1.0, 0.0, 1.0];
    let report = solve(&Given(powell_singular), &mut x, &scales, &options, &mut Workspace::new(4))
        .expect("sizes match");
    assert_eq!(report.status, Status::MaxSteps);
    let text = NotConverged(Box::new(report)).to_string();
    assert!(text.contains("the step limit was reached after 3 steps"), "{text}");
    assert!(text.contains("largest in row"), "{text}");
}

#[test]
fn require_converged_keeps_the_report() {
    let report = run(rosenbrock, &mut [-1.2, 1.0]);
    assert_eq!(report.clone().require_converged(), Ok(report));
    let failed = run(logarithm, &mut [-1.0]);
    let error = failed.clone().require_converged().expect_err("refused");
    assert_eq!(*error.0, failed);
}

#[test]
fn misuse_is_an_error_with_the_numbers() {
    let system = Given(rosenbrock);
    let (ones, zero) = ([1.0; 2], [1.0, 0.0]);
    let call = |x: &mut [f64], fx: &[f64], ff: &[f64], n| {
        let scales = Scales { x: fx, f: ff };
        solve(&system, x, &scales, &Options::default(), &mut Workspace::new(n))
    };
    let wrong = |name, found| Err(UsageError::Dimension { name, expected: 2, found });
    assert_eq!(call(&mut [0.0; 3], &ones, &ones, 2), wrong("x", 3));
    assert_eq!(call(&mut [0.0; 2], &ones[..1], &ones, 2), wrong("scales.x", 1));
    assert_eq!(call(&mut [0.0; 2], &ones, &ones[..1], 2), wrong("scales.f", 1));
    assert_eq!(call(&mut [0.0; 2], &ones, &ones, 5), wrong("work", 5));
    assert_eq!(
        call(&mut [0.0; 2], &ones, &zero, 2),
        Err(UsageError::Scale { name: "f", index: 1, value: 0.0 })
    );
}

/// Circle of radius r through a line of slope p: x = r/√(1 + p²), y = p x, in closed form.
#[test]
fn a_root_moves_with_its_parameters() {
    let (r, p) = (1.7_f64, 0.6_f64);
    let root = (1.0 + p * p).sqrt();
    let x = [r / root, p * r / root];
    let system = Given(move |x: &[f64]| {
        let f = [x[0] * x[0] + x[1] * x[1] - r * r, x[1] - p * x[0]];
        Ok((f, [[2.0 * x[0], 2.0 * x[1]], [-p, 1.0]]))
    });
    // ∂F/∂r, then ∂F/∂p; the scales must not matter.
    let mut columns = [-2.0 * r, 0.0, 0.0, -x[0]];
    let mut work = Workspace::new(2);
    let moved = implicit_slopes(&system, &x, &[1e-3, 50.0], &mut columns, &mut work);
    assert_eq!(moved, Ok(Status::Converged));
    let cube = root.powi(3);
    let expected = [x[0] / r, x[1] / r, -p * r / cube, r / root - p * p * r / cube];
    for (slope, expected) in columns.iter().zip(expected) {
        // Rounding of a system of two equations of condition 10.
        assert!((slope - expected).abs() <= 1e-14, "{columns:?}");
    }
}

/// Sign of the determinant: of each order of the rows, and of a negative entry.
#[test]
fn the_jacobian_has_an_orientation() {
    let rows = [[2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, -0.5]];
    for (order, sign) in [([0, 1, 2], -1.0), ([1, 0, 2], 1.0), ([1, 2, 0], -1.0), ([2, 1, 0], 1.0)]
    {
        let system = Given(|_: &[f64]| Ok(([0.0; 3], order.map(|i| rows[i]))));
        let mut work = Workspace::new(3);
        let moved = implicit_slopes(&system, &[0.0; 3], &[1.0; 3], &mut [1.0; 3], &mut work);
        assert_eq!(moved, Ok(Status::Converged));
        assert!((work.orientation() - sign).abs() < f64::EPSILON, "{order:?}");
    }
}

#[test]
fn a_root_that_does_not_move_smoothly_is_told() {
    let ones = [1.0; 4];
    let moved = |x: &[f64], columns: &mut [f64], work: &mut Workspace| {
        implicit_slopes(&Given(powell_singular), x, &ones, columns, work)
    };
    let mut work = Workspace::new(4);
    assert_eq!(moved(&[0.0; 4], &mut [1.0; 4], &mut work), Ok(Status::SingularJacobian));
    let refused =
        implicit_slopes(&Given(logarithm), &[-1.0], &ones[..1], &mut [1.0], &mut Workspace::new(1));
    assert_eq!(refused, Ok(Status::ModelRefused));
    let wrong = |name, found| Err(UsageError::Dimension { name, expected: 4, found });
    assert_eq!(moved(&[0.0; 3], &mut [1.0; 4], &mut work), wrong("x", 3));
    assert_eq!(moved(&[0.0; 4], &mut [1.0; 6], &mut work), wrong("columns", 6));
    assert_eq!(moved(&[0.0; 4], &mut [1.0; 4], &mut Workspace::new(2)), wrong("work", 2));
}

/// The list of steps is the only allocation, however many steps are taken.
#[test]
fn the_iteration_allocates_nothing() {
    let ones = [1.0; 4];
    let scales = Scales { x: &ones, f: &ones };
    let mut work = Workspace::new(4);
    let system = Given(powell_singular);
    for max_steps in [1, 40] {
        let options = Options { max_steps, residual_tol: 1e-10, ..Options::default() };
        let mut x = [3.0, -1.0, 0.0, 1.0];
        let mut steps = 0;
        let info = allocation_counter::measure(|| {
            let report = solve(&system, &mut x, &scales, &options, &mut work);
            steps = report.map(|r| r.steps.len()).unwrap_or_default();
        });
        // The name of the worst equation, and its formatting, come on top when it fails.
        let allowed = if max_steps == 1 { 3 } else { 1 };
        assert!(steps == 1 || steps == 19, "{steps}");
        assert!(info.count_total <= allowed, "{} allocations in {steps} steps", info.count_total);
    }
}
