//! Damped Newton iteration for small systems.

use std::array::from_fn;

use crate::{
    Backtracking, Dense, Equations, EvalError, Options, Progress, Report, Scales, Singular, Step,
    Termination, WorstEquation,
};

/// Scaled size of a Newton step below which the iteration has stalled (N3) (dimensionless).
const STEP_TOL: f64 = 1e-15;

/// Reusable buffers for solving systems of `N` equations.
#[derive(Debug, Clone)]
pub struct Workspace<const N: usize> {
    /// Weights of the equations in the latest solve.
    d_f: [f64; N],
    pub(crate) linear: Dense<N>,
    content: Content,
}

/// Content of the matrix in a workspace.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Content {
    /// The matrix contains no valid data.
    Stale,
    /// The matrix contains the Jacobian at the last iterate or trial point.
    Jacobian,
    /// The matrix contains the LU factors of the latest Jacobian or of an earlier one.
    Factors,
}

impl<const N: usize> Default for Workspace<N> {
    fn default() -> Self {
        Self { d_f: [0.0; N], linear: Dense::default(), content: Content::Stale }
    }
}

impl<const N: usize> Workspace<N> {
    /// Factorizes the Jacobian after scaling it with the weights of the equations.
    pub(crate) fn factorize(&mut self) -> Result<(), Singular> {
        self.linear.scale_rows(&self.d_f);
        self.content = Content::Stale;
        self.linear.factorize()?;
        self.content = Content::Factors;
        Ok(())
    }

    /// Factorizes the Jacobian unless its factors are already known.
    fn ensure_factors(&mut self) -> Result<(), Singular> {
        match self.content {
            Content::Stale => Err(Singular),
            Content::Jacobian => self.factorize(),
            Content::Factors => Ok(()),
        }
    }

    /// Returns the Newton step `$-J^{-1} r$` for a residual `$r$`. It uses the Jacobian of the last
    /// call of [`linearize`](Self::linearize) or [`solve`].
    ///
    /// # Errors
    ///
    /// Returns [`Singular`] if there is no valid Jacobian or it cannot be factorized.
    pub fn correction(&mut self, residual: &[f64; N]) -> Result<[f64; N], Singular> {
        self.ensure_factors()?;
        // D_F J(x_k) δx_k = −D_F F(x_k)
        let mut step = from_fn(|i| residual[i] * -self.d_f[i]);
        self.linear.solve(&mut step);
        Ok(step)
    }

    /// Returns the direction of the curve that is defined by all equations except the last one
    /// (N8). Returns `None` if the Jacobian is singular.
    ///
    /// The last equation must define a plane that intersects the curve. The method uses the
    /// Jacobian from the last call of [`linearize`](Self::linearize) or [`solve`].
    pub(crate) fn direction(&mut self) -> Option<[f64; N]> {
        self.ensure_factors().ok()?;
        // D_F J t = sgn(det J) e_N                                        (N8)
        let mut direction = [0.0; N];
        if let Some(last) = direction.last_mut() {
            *last = self.linear.determinant_sign();
        }
        self.linear.solve(&mut direction);
        direction.iter().all(|t| t.is_finite()).then_some(direction)
    }

    /// Stores the Jacobian at `x` and returns the residual.
    ///
    /// * `f_scale`: reciprocals of the typical magnitudes of the residuals, as in [`Scales::f`].
    ///
    /// # Errors
    ///
    /// Returns the same errors as [`Equations::linearize`].
    pub fn linearize<E: Equations<N> + ?Sized>(
        &mut self,
        equations: &E,
        x: &[f64; N],
        f_scale: &[f64; N],
    ) -> Result<[f64; N], EvalError> {
        self.d_f = *f_scale;
        self.content = Content::Stale;
        let (residual, ..) = equations.linearize(x, self.linear.rows_mut())?;
        self.content = Content::Jacobian;
        Ok(residual)
    }
}

/// Residual and [details](Equations::Details) at a point.
type Evaluated<const N: usize, E> = ([f64; N], <E as Equations<N>>::Details);

/// Result of a Newton iteration: the report, and the residual and details at the returned point.
#[must_use = "a report may state that the iteration did not converge"]
pub struct Outcome<const N: usize, E: Equations<N> + ?Sized> {
    /// Status, cost and steps of the iteration.
    pub report: Report,
    /// Residual and [details](Equations::Details) at the returned point. `None` if the scaling
    /// factors are invalid, or if the equations could not be evaluated at the starting point.
    pub last: Option<([f64; N], E::Details)>,
    /// [Slopes](Equations::Slopes) at the point of the last Jacobian; `None` if no Jacobian was
    /// evaluated.
    pub slopes: Option<E::Slopes>,
}

impl<const N: usize, E: Equations<N> + ?Sized> Outcome<N, E> {
    /// Returns true if the scaled residual is within the tolerance.
    pub fn converged(&self) -> bool {
        self.report.converged()
    }
}

/// Solves a small system `$F(x) = 0$` by a damped Newton iteration with Newton steps `$\delta x_k$`
/// and damping factors `$\lambda_k$`.
///
/// ```math
/// J(x_k)\,\delta x_k = -F(x_k), \qquad x_{k+1} = x_k + \lambda_k\,\delta x_k
/// ```
///
/// * `x`: initial guess on entry, and best iterate on return.
/// * `scales`: reciprocals of the typical magnitudes of the unknowns and of the residuals.
///
/// If the iteration does not converge, the [`Report`] states the reason. The function allocates
/// memory for the list of steps in the report before the first step, and for the name of the worst
/// equation after an iteration that did not converge, but not during the iteration.
///
/// Source: Dennis and Schnabel, *Numerical Methods for Unconstrained Optimization and Nonlinear
/// Equations*, §6.3 and §6.5 (backtracking on the squared residual).
pub fn solve<const N: usize, E: Equations<N> + ?Sized>(
    equations: &E,
    x: &mut [f64; N],
    scales: &Scales<'_, [f64; N]>,
    options: &Options,
    work: &mut Workspace<N>,
) -> Outcome<N, E> {
    let report = Report::new(options);
    let mut newton = Newton { equations, work, report, worst: None, slopes: None };
    let (status, last) = match newton.start(x, scales, options) {
        Ok(start) => newton.iterate(x, start, scales, options),
        Err(status) => (status, None),
    };
    let Newton { mut report, worst, slopes, .. } = newton;
    report.status = status;
    if !report.converged() {
        let named = |index| WorstEquation { index, name: equations.equation(index) };
        report.worst = worst.map(named);
    }
    Outcome { report, last, slopes }
}

/// State of a Newton iteration.
struct Newton<'a, const N: usize, E: Equations<N> + ?Sized> {
    equations: &'a E,
    work: &'a mut Workspace<N>,
    report: Report,
    /// Index of the equation with the largest scaled residual at the last iterate, `None` before
    /// the first evaluation.
    worst: Option<usize>,
    slopes: Option<E::Slopes>,
}

impl<const N: usize, E: Equations<N> + ?Sized> Newton<'_, N, E> {
    /// Checks the scaling factors and evaluates the equations at the starting point.
    fn start(
        &mut self,
        x: &[f64; N],
        scales: &Scales<'_, [f64; N]>,
        options: &Options,
    ) -> Result<Evaluated<N, E>, Termination> {
        let is_bad = |d: &f64| !(*d > 0.0 && d.is_finite());
        if scales.x.iter().chain(scales.f).any(is_bad) {
            return Err(Termination::BadScale);
        }
        self.work.content = Content::Stale;
        self.work.d_f = *scales.f;
        let with_jacobian = options.jacobian.at_start();
        self.evaluate(x, with_jacobian).map_err(|_| Termination::OutsideDomain)
    }

    /// Takes Newton steps until a policy ends the iteration.
    ///
    /// Returns the status, together with the residual and details at the last iterate.
    fn iterate(
        &mut self,
        x: &mut [f64; N],
        mut here: Evaluated<N, E>,
        scales: &Scales<'_, [f64; N]>,
        options: &Options,
    ) -> (Termination, Option<Evaluated<N, E>>) {
        let status = loop {
            let residual = self.record(&here.0);
            let previous = self.report.steps.last().map(|step| step.residual);
            let steps = self.report.steps.len();
            let progress = options.convergence.check(residual, previous, steps);
            if let Progress::Ended(status) = progress {
                break status;
            }

            let is_chord = self.work.content == Content::Factors
                && options.jacobian.keeps_factors(residual, previous);
            if !is_chord && let Err(reason) = self.renew_factors(x) {
                break progress.ended_by(reason);
            }

            let Some(dx) = self.step(&here.0) else {
                break progress.ended_by(Termination::SingularJacobian);
            };
            let step = scaled_size(&dx, scales.x);
            if step < STEP_TOL {
                break progress.ended_by(Termination::Stalled);
            }

            // A solution is refined only with full steps. A line search along a chord step is
            // useless, because the chord step need not be a descent direction.
            let full_steps = is_chord || progress == Progress::Refining;
            let damping = if full_steps { Backtracking::NONE } else { options.damping };
            let with_jacobian = options.jacobian.at_trials(residual);
            match self.backtrack((x, &dx), residual, damping, with_jacobian) {
                Some((lambda, next, there)) => {
                    (*x, here) = (next, there);
                    self.report.steps.push(Step { residual, step, lambda });
                }
                None if is_chord && progress == Progress::Iterating => {
                    // The Jacobian at this point may give a descent direction even if an earlier
                    // Jacobian does not.
                    match self.evaluate(x, true) {
                        Ok(again) => here = again,
                        Err(_) => break Termination::OutsideDomain,
                    }
                }
                None => break progress.ended_by(Termination::LineSearchFailed),
            }
        };
        (status, Some(here))
    }

    /// Stores the scaled norm of the residual in the report and returns it.
    fn record(&mut self, residual: &[f64; N]) -> f64 {
        let (norm, worst) = scaled_norm(residual, &self.work.d_f);
        (self.report.residual, self.worst) = (norm, Some(worst));
        norm
    }

    /// Factorizes the Jacobian at `x`. If the Jacobian was not evaluated together with the
    /// residual, it is evaluated first.
    fn renew_factors(&mut self, x: &[f64; N]) -> Result<(), Termination> {
        if self.work.content != Content::Jacobian {
            self.report.n_jacobian += 1;
            self.work.content = Content::Stale;
            let slopes = self.equations.jacobian(x, self.work.linear.rows_mut());
            self.slopes = Some(slopes.map_err(|_| Termination::OutsideDomain)?);
        }
        self.work.factorize().map_err(|_| Termination::SingularJacobian)
    }

    /// Returns the Newton step for a residual, or `None` if the step is not finite.
    fn step(&mut self, residual: &[f64; N]) -> Option<[f64; N]> {
        let dx = self.work.correction(residual).ok()?;
        dx.iter().all(|dx| dx.is_finite()).then_some(dx)
    }

    /// Returns the largest step length `$\lambda = 2^{-m} \lambda_0$` that decreases the residual
    /// sufficiently, with the trial point and the residual and details at this point. Returns
    /// `None` if there is no such step length.
    ///
    /// The step is also halved if the model cannot be evaluated at a trial point.
    fn backtrack(
        &mut self,
        (x, dx): (&[f64; N], &[f64; N]),
        before: f64,
        damping: Backtracking,
        with_jacobian: bool,
    ) -> Option<(f64, [f64; N], Evaluated<N, E>)> {
        let mut lambda = self.equations.max_step_length(x, dx);
        for _ in 0..=damping.max_halvings {
            // The trial point is R(λ δx_k), with R(0) = x_k and R'(0) = δx_k (N15)
            let trial = self.equations.retract(x, dx, lambda);
            if let Ok(there) = self.evaluate(&trial, with_jacobian) {
                let (after, _) = scaled_norm(&there.0, &self.work.d_f);
                if Backtracking::accepts(lambda, before, after) {
                    return Some((lambda, trial, there));
                }
            }
            // λ ← λ/2                                                     (N6)
            lambda *= 0.5;
        }
        None
    }

    /// Evaluates the equations, including the Jacobian if requested, and counts the evaluation.
    fn evaluate(
        &mut self,
        x: &[f64; N],
        with_jacobian: bool,
    ) -> Result<Evaluated<N, E>, EvalError> {
        if !with_jacobian {
            self.report.n_residual += 1;
            return self.equations.residual(x);
        }
        self.report.n_jacobian += 1;
        self.work.content = Content::Stale;
        let rows = self.work.linear.rows_mut();
        let (residual, details, slopes) = self.equations.linearize(x, rows)?;
        self.slopes = Some(slopes);
        self.work.content = Content::Jacobian;
        Ok((residual, details))
    }
}

/// Returns the scaled length of a step, `$\lVert D_x\,\delta x \rVert_\infty$`.
fn scaled_size<const N: usize>(dx: &[f64; N], d_x: &[f64; N]) -> f64 {
    // ‖D_x δx_k‖∞ < step_tol                                              (N3)
    dx.iter().zip(d_x).fold(0.0, |max: f64, (dx, d)| max.max((dx * d).abs()))
}

/// Returns `$\lVert D v \rVert_2$` and the index of the largest term. If any term is NaN, the norm
/// is infinite, and the index refers to the first NaN.
fn scaled_norm<const N: usize>(v: &[f64; N], d: &[f64; N]) -> (f64, usize) {
    let (mut sum, mut max, mut index) = (0.0, 0.0, 0);
    for (i, (v, d)) in v.iter().zip(d).enumerate() {
        let square = (v * d).powi(2);
        if square.is_nan() {
            return (f64::INFINITY, i);
        }
        sum += square;
        if square > max {
            (max, index) = (square, i);
        }
    }
    (sum.sqrt(), index)
}
