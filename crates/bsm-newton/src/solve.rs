//! The iteration.

use std::array::from_fn;

use crate::{
    Dense, Equations, EvalError, JacobianUpdate, Options, Report, Scales, Singular, Step,
    Termination,
};

/// Sufficient-decrease constant `$\gamma$` of (N5).
pub const ARMIJO: f64 = 1e-4;

/// Scaled size of a Newton step below which the iteration has stalled (N3).
const STEP_TOL: f64 = 1e-15;

/// Memory of a solve of `N` unknowns, reused by the next one; nothing is allocated per step.
#[derive(Debug, Clone)]
pub struct Workspace<const N: usize> {
    r: [f64; N],
    dx: [f64; N],
    x_trial: [f64; N],
    /// Weights of the equations of the last solve.
    d_f: [f64; N],
    pub(crate) linear: Dense<N>,
    matrix: Matrix,
}

impl<const N: usize> Default for Workspace<N> {
    fn default() -> Self {
        let [r, dx, x_trial, d_f] = [[0.0; N]; 4];
        Self { r, dx, x_trial, d_f, linear: Dense::default(), matrix: Matrix::Stale }
    }
}

impl<const N: usize> Workspace<N> {
    /// Factors of the Jacobian with the weights of the solve.
    pub(crate) fn factorize(&mut self) -> Result<(), Singular> {
        self.linear.scale_rows(&self.d_f);
        self.matrix = Matrix::Stale;
        self.linear.factorize()?;
        self.matrix = Matrix::Factors;
        Ok(())
    }

    /// The step `$-J^{-1} r$` of a residual, with the Jacobian as [`linearize`](Self::linearize) or the last solve left it.
    ///
    /// # Errors
    ///
    /// [`Singular`] if that could not be factorized.
    pub fn correction(&mut self, residual: &[f64; N]) -> Result<[f64; N], Singular> {
        match self.matrix {
            Matrix::Stale => return Err(Singular),
            Matrix::Jacobian => self.factorize()?,
            Matrix::Factors => {}
        }
        let mut step = from_fn(|i| residual[i] * -self.d_f[i]);
        self.linear.solve(&mut step);
        Ok(step)
    }

    /// Takes the Jacobian at `x`, and returns the residual there.
    ///
    /// * `f_scale`: what counts as one unit of each equation, as in [`Scales::f`].
    ///
    /// # Errors
    ///
    /// As [`Equations::linearize`].
    pub fn linearize<E: Equations<N> + ?Sized>(
        &mut self,
        equations: &E,
        x: &[f64; N],
        f_scale: &[f64; N],
    ) -> Result<[f64; N], EvalError> {
        (self.matrix, self.d_f) = (Matrix::Stale, *f_scale);
        let residual = equations.linearize(x, self.linear.rows_mut())?;
        self.matrix = Matrix::Jacobian;
        Ok(residual)
    }
}

/// What the matrix of a solve holds: nothing of use, the Jacobian of the last point or trial, or the factors of this or an
/// earlier one.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Matrix {
    Stale,
    Jacobian,
    Factors,
}

/// Solves a few equations `$F(x) = 0$` by Newton steps `$\delta x$` damped by `$\lambda$`.
///
/// ```math
/// J(x_k)\,\delta x_k = -F(x_k), \qquad x_{k+1} = x_k + \lambda_k\,\delta x_k
/// ```
///
/// * `x`: initial guess on entry, best iterate on return.
/// * `scales`: what counts as one unit of each unknown and equation.
///
/// A solve that fails to converge is a [`Report`], not an error. The only memory taken is the
/// report's list of steps, at the start.
///
/// Source: Dennis and Schnabel, *Numerical Methods for Unconstrained Optimization and Nonlinear
/// Equations*, §6.3 and §6.5 (backtracking on the squared residual).
pub fn solve<const N: usize, E: Equations<N> + ?Sized>(
    equations: &E,
    x: &mut [f64; N],
    scales: &Scales<'_, [f64; N]>,
    options: &Options,
    work: &mut Workspace<N>,
) -> Report {
    let mut report = Report {
        status: Termination::BadScale,
        residual: f64::INFINITY,
        worst_equation: 0,
        worst_equation_name: String::new(),
        n_residual: 0,
        n_jacobian: 0,
        steps: Vec::with_capacity(options.max_steps),
    };
    let bad = |d: &[f64; N]| d.iter().position(|d| !(*d > 0.0 && d.is_finite()));
    match [scales.x, scales.f].into_iter().find_map(bad) {
        Some(index) => report.worst_equation = index,
        None => report.status = iterate(equations, x, scales, options, work, &mut report),
    }
    if !report.converged() {
        report.worst_equation_name = equations.equation(report.worst_equation);
    }
    report
}

fn iterate<const N: usize, E: Equations<N> + ?Sized>(
    equations: &E,
    x: &mut [f64; N],
    scales: &Scales<'_, [f64; N]>,
    options: &Options,
    work: &mut Workspace<N>,
    report: &mut Report,
) -> Termination {
    let joint = options.jacobian != JacobianUpdate::EveryStep;
    work.matrix = Matrix::Stale;
    work.d_f = *scales.f;
    let into = (&mut work.r, &mut work.linear, &mut work.matrix);
    if evaluate(equations, x, joint, into, report).is_err() {
        return Termination::OutsideDomain;
    }
    loop {
        (report.residual, report.worst_equation) = scaled_norm(&work.r, scales.f);
        let convergence = Convergence::of(report, options);
        if let Convergence::Ended(status) = convergence {
            return status;
        }
        let is_solved = convergence == Convergence::Refinable;
        let ended = |status| if is_solved { Termination::Converged } else { status };

        let is_chord = joint && work.matrix == Matrix::Factors && report.is_quick();
        if !is_chord {
            if work.matrix != Matrix::Jacobian {
                let into = (&mut work.r, &mut work.linear, &mut work.matrix);
                if evaluate(equations, x, true, into, report).is_err() {
                    return ended(Termination::OutsideDomain);
                }
            }
            if work.factorize().is_err() {
                return ended(Termination::SingularJacobian);
            }
        }
        // D_F J(x_k) δx_k = −D_F F(x_k)
        work.dx = from_fn(|i| -work.r[i] * scales.f[i]);
        work.linear.solve(&mut work.dx);
        if !work.dx.iter().all(|dx| dx.is_finite()) {
            return ended(Termination::SingularJacobian);
        }
        // ‖D_x δx_k‖∞ < step_tol                                          (N3)
        let sizes = work.dx.iter().zip(scales.x);
        let step = sizes.fold(0.0, |m: f64, (v, d)| m.max((v * d).abs()));
        if step < STEP_TOL {
            return ended(Termination::Stalled);
        }

        let search = LineSearch {
            // A point that already is a solution is only refined by full steps, and a chord step need not lead down.
            max_halvings: if is_solved || is_chord { 0 } else { options.max_halvings },
            joint: match options.jacobian {
                JacobianUpdate::EveryStep => false,
                JacobianUpdate::EveryTrial { chord_below } => report.residual > chord_below,
            },
        };
        let Some(lambda) = search.step(equations, x, work, report) else {
            if is_chord && !is_solved {
                // Its own Jacobian may do; the trials have taken the place of its residual.
                let into = (&mut work.r, &mut work.linear, &mut work.matrix);
                if evaluate(equations, x, true, into, report).is_err() {
                    return Termination::OutsideDomain;
                }
                continue;
            }
            return ended(Termination::LineSearchFailed);
        };
        *x = work.x_trial;
        report.steps.push(Step { residual: report.residual, step, lambda });
    }
}

/// What the residual of a point says.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Convergence {
    /// No solution yet.
    Open,
    /// A solution that further steps may make more exact.
    Refinable,
    Ended(Termination),
}

impl Convergence {
    fn of(report: &Report, options: &Options) -> Self {
        let residual = report.residual;
        if !residual.is_finite() {
            return Self::Ended(Termination::NotFinite);
        }
        // ‖D_F F(x_k)‖₂ ≤ residual_tol                                    (N1)
        let is_solved = residual <= options.residual_tol;
        // ‖D_F F(x_k)‖₂ ≤ residual_goal, or the last step no longer halved it  (N2)
        let is_refined = residual <= options.residual_goal
            || report.steps.last().is_some_and(|s| residual > 0.5 * s.residual);
        let exhausted = report.steps.len() == options.max_steps;
        match (is_solved, is_refined || exhausted) {
            (true, true) => Self::Ended(Termination::Converged),
            (true, false) => Self::Refinable,
            (false, _) if exhausted => Self::Ended(Termination::MaxSteps),
            (false, _) => Self::Open,
        }
    }
}

impl Report {
    /// True if the last step has lowered the residual to a tenth.
    fn is_quick(&self) -> bool {
        self.steps.last().is_some_and(|s| self.residual <= 0.1 * s.residual)
    }
}

/// Evaluates the residual, with the Jacobian if `joint`.
fn evaluate<const N: usize, E: Equations<N> + ?Sized>(
    equations: &E,
    x: &[f64; N],
    joint: bool,
    (r, jacobian, matrix): (&mut [f64; N], &mut Dense<N>, &mut Matrix),
    report: &mut Report,
) -> Result<(), EvalError> {
    if joint {
        report.n_jacobian += 1;
        *matrix = Matrix::Stale;
        *r = equations.linearize(x, jacobian.rows_mut())?;
        *matrix = Matrix::Jacobian;
    } else {
        report.n_residual += 1;
        *r = equations.residual(x)?;
    }
    Ok(())
}

/// Backtracking along a step.
struct LineSearch {
    max_halvings: u32,
    /// Trials have a Jacobian.
    joint: bool,
}

impl LineSearch {
    /// Largest `$\lambda = 2^{-m} \lambda_0$` with a sufficient decrease; leaves the point in `x_trial`.
    ///
    /// A trial that the model refuses counts as no decrease: the step is halved.
    fn step<const N: usize, E: Equations<N> + ?Sized>(
        &self,
        equations: &E,
        x: &[f64; N],
        work: &mut Workspace<N>,
        report: &mut Report,
    ) -> Option<f64> {
        // φ(λ) = ½ ‖D_F F(x + λ δx)‖₂²,  φ'(0) = −2 φ(0) along a Newton step   (N4)
        let phi_0 = 0.5 * report.residual.powi(2);
        let mut lambda = equations.first_part(x, &work.dx);
        for _ in 0..=self.max_halvings {
            // R(λ δx_k), R(0) = x_k, R'(0) = δx_k                          (N15)
            work.x_trial = equations.retract(x, &work.dx, lambda);
            let into = (&mut work.r, &mut work.linear, &mut work.matrix);
            if evaluate(equations, &work.x_trial, self.joint, into, report).is_ok() {
                // φ(λ) ≤ (1 − 2 γ λ) φ(0)                                 (N5)
                let phi = 0.5 * scaled_norm(&work.r, &work.d_f).0.powi(2);
                if phi <= (1.0 - 2.0 * ARMIJO * lambda) * phi_0 {
                    return Some(lambda);
                }
            }
            // λ ← λ/2                                                     (N6)
            lambda *= 0.5;
        }
        None
    }
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
