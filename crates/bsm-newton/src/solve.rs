//! The iteration.

use crate::lu::DenseLu;
use crate::{Options, Report, Scales, Status, Step, System, UsageError};

/// Memory of a solve, reused by the next one; nothing is allocated per step.
pub struct Workspace {
    pub(crate) r: Vec<f64>,
    dx: Vec<f64>,
    x_trial: Vec<f64>,
    pub(crate) lu: DenseLu,
}

impl Workspace {
    /// Memory for systems of `n` unknowns.
    pub fn new(n: usize) -> Self {
        Self { r: vec![0.0; n], dx: vec![0.0; n], x_trial: vec![0.0; n], lu: DenseLu::new(n) }
    }

    /// Sign of the determinant of the Jacobian that was factorized last; 1 before the first. Along a
    /// path whose last equation is a plane across it, the sign changes where the plane meets the
    /// path from the other side.
    pub fn orientation(&self) -> f64 {
        self.lu.determinant_sign()
    }
}

/// Solves `$F(x) = 0$` by Newton steps `$\delta x$` damped by `$\lambda$`.
///
/// ```math
/// J(x_k)\,\delta x_k = -F(x_k), \qquad x_{k+1} = x_k + \lambda_k\,\delta x_k
/// ```
///
/// * `x`: initial guess on entry, best iterate on return; length `n`.
/// * `scales`: what counts as one unit of each unknown and equation.
/// * `work`: memory for `n` unknowns.
///
/// A solve that fails to converge is a [`Report`], not an error. The only memory taken is the
/// report's list of steps, at the start.
///
/// Source: Dennis and Schnabel, *Numerical Methods for Unconstrained Optimization and Nonlinear
/// Equations*, §6.3 and §6.5 (backtracking on the squared residual).
///
/// # Errors
///
/// [`UsageError`] if a length is not `n` or a scale is not positive and finite.
pub fn solve<S: System + ?Sized>(
    system: &S,
    x: &mut [f64],
    scales: &Scales<'_>,
    options: &Options,
    work: &mut Workspace,
) -> Result<Report, UsageError> {
    check(system.dim(), x, scales, work)?;
    let mut report = Report {
        status: Status::ModelRefused,
        residual: f64::INFINITY,
        worst_equation: 0,
        worst_equation_name: String::new(),
        n_residual: 0,
        n_jacobian: 0,
        refusal: None,
        steps: Vec::with_capacity(options.max_steps),
    };
    report.status = iterate(system, x, scales, options, work, &mut report);
    if !report.converged() {
        report.worst_equation_name = system.equation(report.worst_equation);
    }
    Ok(report)
}

fn iterate<S: System + ?Sized>(
    system: &S,
    x: &mut [f64],
    scales: &Scales<'_>,
    options: &Options,
    work: &mut Workspace,
    report: &mut Report,
) -> Status {
    report.n_residual += 1;
    if let Err(refusal) = system.residual(x, &mut work.r) {
        report.refusal = Some(refusal);
        return Status::ModelRefused;
    }
    loop {
        // ‖D_F F(x_k)‖₂ ≤ residual_tol                                    (N1)
        (report.residual, report.worst_equation) = scaled_norm(&work.r, scales.f);
        if !report.residual.is_finite() {
            return Status::NotFinite;
        }
        let solved = report.residual <= options.residual_tol;
        // ‖D_F F(x_k)‖₂ ≤ residual_goal, or the last step no longer halved it  (N2)
        let refined = report.residual <= options.residual_goal
            || report.steps.last().is_some_and(|s| report.residual > 0.5 * s.residual);
        let exhausted = report.steps.len() == options.max_steps;
        if solved && (refined || exhausted) {
            return Status::Converged;
        }
        if exhausted {
            return Status::MaxSteps;
        }

        let ended = |status| if solved { Status::Converged } else { status };
        report.n_jacobian += 1;
        if let Err(refusal) = system.linearize(x, &mut work.r, work.lu.matrix()) {
            report.refusal = Some(refusal);
            return ended(Status::ModelRefused);
        }
        // D_F J(x_k) δx_k = −D_F F(x_k)
        work.lu.scale_rows(scales.f);
        for ((dx, r), d) in work.dx.iter_mut().zip(&work.r).zip(scales.f) {
            *dx = -r * d;
        }
        if !work.lu.solve(&mut work.dx) {
            return ended(Status::SingularJacobian);
        }

        // ‖D_x δx_k‖∞ < step_tol                                          (N3)
        let step = work.dx.iter().zip(scales.x).fold(0.0, |m: f64, (v, d)| m.max((v * d).abs()));
        if step < options.step_tol {
            return ended(Status::Stalled);
        }

        let Some(lambda) = backtrack(system, x, scales, options, work, report, solved) else {
            return ended(Status::LineSearchFailed);
        };
        x.copy_from_slice(&work.x_trial);
        report.steps.push(Step { residual: report.residual, step, lambda });
    }
}

/// Largest `$\lambda = 2^{-m}$` with a sufficient decrease; leaves the point in `x_trial`.
///
/// A trial that the model refuses counts as no decrease: the step is halved. A point that
/// already is a solution is only refined by full steps.
fn backtrack<S: System + ?Sized>(
    system: &S,
    x: &[f64],
    scales: &Scales<'_>,
    options: &Options,
    work: &mut Workspace,
    report: &mut Report,
    solved: bool,
) -> Option<f64> {
    // φ(λ) = ½ ‖D_F F(x + λ δx)‖₂²,  φ'(0) = −2 φ(0) along a Newton step   (N4)
    let phi_0 = 0.5 * report.residual.powi(2);
    let mut lambda = 1.0;
    for _ in 0..=if solved { 0 } else { options.max_halvings } {
        for ((t, x), dx) in work.x_trial.iter_mut().zip(x).zip(&work.dx) {
            *t = x + lambda * dx;
        }
        report.n_residual += 1;
        match system.residual(&work.x_trial, &mut work.r) {
            // φ(λ) ≤ (1 − 2 γ λ) φ(0)                                     (N5)
            Ok(()) => {
                let phi = 0.5 * scaled_norm(&work.r, scales.f).0.powi(2);
                if phi <= (1.0 - 2.0 * options.armijo * lambda) * phi_0 {
                    return Some(lambda);
                }
            }
            Err(refusal) => report.refusal = Some(refusal),
        }
        // λ ← λ/2                                                         (N6)
        lambda *= 0.5;
    }
    None
}

/// `$\lVert D v \rVert_2$` and the index of the largest term; a NaN makes it infinite.
fn scaled_norm(v: &[f64], d: &[f64]) -> (f64, usize) {
    let (mut sum, mut max, mut at) = (0.0, 0.0, 0);
    for (i, (v, d)) in v.iter().zip(d).enumerate() {
        let square = (v * d).powi(2);
        if square.is_nan() {
            return (f64::INFINITY, i);
        }
        sum += square;
        if square > max {
            (max, at) = (square, i);
        }
    }
    (sum.sqrt(), at)
}

fn check(n: usize, x: &[f64], scales: &Scales<'_>, work: &Workspace) -> Result<(), UsageError> {
    let lengths = [
        ("x", x.len()),
        ("scales.x", scales.x.len()),
        ("scales.f", scales.f.len()),
        ("work", work.r.len()),
    ];
    for (name, found) in lengths {
        if found != n {
            return Err(UsageError::Dimension { name, expected: n, found });
        }
    }
    for (name, diagonal) in [("x", scales.x), ("f", scales.f)] {
        for (index, &value) in diagonal.iter().enumerate() {
            if !(value > 0.0 && value.is_finite()) {
                return Err(UsageError::Scale { name, index, value });
            }
        }
    }
    Ok(())
}
