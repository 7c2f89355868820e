//! Bounded nonlinear least squares by the Levenberg-Marquardt method.
//!
//! Theory: `docs/theory/12-sensitivities.md`, equations (V6) and (V7).

use nalgebra::{DMatrix, DVector};

/// Maximum number of iterations.
const MAX_STEPS: usize = 60;
/// Step size at which the iteration stops, relative to the width between the bounds.
const STEP_TOLERANCE: f64 = 1e-9;

/// Step size of the finite differences, relative to the width between the bounds.
const DIFFERENCE_STEP: f64 = 1e-3;

/// Threshold of the outward Gauss-Newton step, relative to the width between the bounds. If the
/// step of a parameter at its bound is larger, the bound counts as active. Rounding errors of a
/// model change a parameter by less than 1e-8.
const FIXED_STEP: f64 = 1e-6;

/// A local minimum of the sum of squares.
#[derive(Debug, Clone, PartialEq)]
pub struct LeastSquares {
    /// Parameters at the minimum.
    pub parameters: Vec<f64>,
    /// Residuals at the minimum.
    pub residuals: Vec<f64>,
    /// Standard deviations of the parameters (V7) under the assumption that the residuals are
    /// random and have equal variances. `None` unless there are more residuals than parameters.
    pub deviations: Option<Vec<f64>>,
    /// Condition number of the Jacobian with respect to the parameters scaled by their bounds. If
    /// it exceeds a few thousand, the residuals do not determine the parameters.
    pub condition: f64,
    /// True for each parameter at an active bound, which means that the unconstrained minimum lies
    /// beyond this bound.
    pub at_bound: Vec<bool>,
}

/// Minimizes the sum of squared residuals, starting from `start`. Returns `None` if the residuals
/// cannot be evaluated at `start` or for a finite difference, or if the iteration does not
/// converge.
///
/// * `residuals`: function that returns the residuals for given parameters, or `None` if the model
///   has no solution. Each residual must be divided by the standard deviation of its measurement,
///   or by a number proportional to it.
///
/// # Errors
/// Returns the first error that `residuals` returns.
pub fn least_squares<E>(
    mut residuals: impl FnMut(&[f64]) -> Result<Option<Vec<f64>>, E>,
    start: &[f64],
    bounds: &[(f64, f64)],
) -> Result<Option<LeastSquares>, E> {
    let count = start.len();
    let number = |u: &[f64]| -> Vec<f64> {
        u.iter().zip(bounds).map(|(u, (low, high))| low + u * (high - low)).collect()
    };
    let mut u: Vec<_> =
        start.iter().zip(bounds).map(|(x, (low, high))| (x - low) / (high - low)).collect();
    let Some(mut residual) = residuals(&number(&u))? else { return Ok(None) };
    let mut damping = 1e-3;
    for _ in 0..MAX_STEPS {
        let mut slopes = DMatrix::zeros(residual.len(), count);
        for k in 0..count {
            let (mut below, mut above) = (u.clone(), u.clone());
            (below[k], above[k]) =
                ((u[k] - DIFFERENCE_STEP).max(0.0), (u[k] + DIFFERENCE_STEP).min(1.0));
            let ends = (residuals(&number(&below))?, residuals(&number(&above))?);
            let (Some(low), Some(high)) = ends else { return Ok(None) };
            for (i, (low, high)) in low.iter().zip(&high).enumerate() {
                slopes[(i, k)] = (high - low) / (above[k] - below[k]);
            }
        }
        let gradient = slopes.tr_mul(&DVector::from_column_slice(&residual));
        let normal = slopes.tr_mul(&slopes);
        let mut converged = true;
        for _ in 0..MAX_STEPS {
            let (mut damped, mut push) = (normal.clone(), -&gradient);
            for k in 0..count {
                damped[(k, k)] += damping * normal[(k, k)].max(f64::MIN_POSITIVE);
                // A parameter at its bound keeps its value if the gradient points outward.
                let stays =
                    (u[k] <= 0.0 && gradient[k] > 0.0) || (u[k] >= 1.0 && gradient[k] < 0.0);
                if stays {
                    damped.row_mut(k).fill(0.0);
                    (damped[(k, k)], push[k]) = (1.0, 0.0);
                }
            }
            let step = damped.lu().solve(&push);
            let Some(step) = step.filter(|step| step.iter().all(|x| x.is_finite())) else {
                return Ok(None);
            };
            let next: Vec<_> =
                u.iter().zip(step.iter()).map(|(u, step)| (u + step).clamp(0.0, 1.0)).collect();
            let moved = next.iter().zip(&u).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            if moved <= STEP_TOLERANCE {
                break;
            }
            let size = |residual: &[f64]| residual.iter().map(|x| x * x).sum::<f64>();
            match residuals(&number(&next))? {
                Some(better) if size(&better) < size(&residual) => {
                    (u, residual, converged) = (next, better, false);
                    damping = (damping * 0.1).max(1e-12);
                    break;
                }
                _ => damping *= 10.0,
            }
        }
        if converged {
            let is_held = |k: usize| {
                let outward = gradient[k] / normal[(k, k)];
                (u[k] <= 0.0 && outward > FIXED_STEP) || (u[k] >= 1.0 && outward < -FIXED_STEP)
            };
            let at_bound = (0..count).map(is_held).collect();
            return Ok(Some(outcome(&slopes, &number(&u), residual, bounds, at_bound)));
        }
    }
    Ok(None)
}

/// Returns the result, including standard deviations and the condition number.
fn outcome(
    slopes: &DMatrix<f64>,
    parameters: &[f64],
    residuals: Vec<f64>,
    bounds: &[(f64, f64)],
    at_bound: Vec<bool>,
) -> LeastSquares {
    let responses = slopes.singular_values();
    let condition = responses.max() / responses.min();
    let free = residuals.len().saturating_sub(parameters.len());
    #[expect(clippy::cast_precision_loss, reason = "a number of measurements")]
    let variance = residuals.iter().map(|x| x * x).sum::<f64>() / free as f64;
    let spread = slopes.tr_mul(slopes).try_inverse().filter(|_| free > 0);
    let deviations = spread.map(|spread| {
        // s_k² = [(JᵀJ)⁻¹]_kk Σ r²/(n − p)                                (V7)
        let of = |(k, (low, high)): (usize, &(f64, f64))| {
            (spread[(k, k)] * variance).sqrt() * (high - low)
        };
        bounds.iter().enumerate().map(of).collect()
    });
    LeastSquares { parameters: parameters.to_vec(), residuals, deviations, condition, at_bound }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    fn fit(
        start: &[f64],
        bounds: &[(f64, f64)],
        of: impl Fn(&[f64], f64) -> f64,
        data: &[(f64, f64)],
    ) -> LeastSquares {
        let residuals =
            |x: &[f64]| Ok::<_, ()>(Some(data.iter().map(|(t, y)| of(x, *t) - y).collect()));
        least_squares(residuals, start, bounds).unwrap().unwrap()
    }

    /// A fit to exact points recovers the parameters of the curve.
    #[test]
    fn fit_to_exact_points_recovers_the_parameters() {
        let of = |x: &[f64], t: f64| x[0] * (-x[1] * t).exp();
        let data: Vec<_> =
            (0..8).map(|i| f64::from(i) * 0.3).map(|t| (t, of(&[2.5, 1.3], t))).collect();
        let found = fit(&[1.0, 0.5], &[(0.1, 10.0), (0.1, 5.0)], of, &data);
        // The iteration stops at steps of 1e-9, relative to the width between the bounds.
        assert_relative_eq!(found.parameters[0], 2.5, epsilon = 1e-7);
        assert_relative_eq!(found.parameters[1], 1.3, epsilon = 1e-7);
    }

    /// For a straight line with scattered points, slope, offset and standard deviations match the
    /// results of linear regression.
    #[test]
    fn standard_deviations_of_a_fitted_line_match_linear_regression() {
        let data = [(0.0, 1.1), (1.0, 1.9), (2.0, 3.2), (3.0, 3.8)];
        let found =
            fit(&[0.5, 0.5], &[(-10.0, 10.0), (-10.0, 10.0)], |x, t| x[0] + x[1] * t, &data);
        // Hand calculation: the means are 1.5 for t and 2.5 for y, S_tt = 5 and S_ty = 4.7. The sum
        // of squared residuals is 0.082, and the variance is 0.041.
        assert_relative_eq!(found.parameters[1], 0.94, epsilon = 1e-7);
        assert_relative_eq!(found.parameters[0], 1.09, epsilon = 1e-7);
        let deviations = found.deviations.unwrap();
        assert_relative_eq!(deviations[1], (0.041_f64 / 5.0).sqrt(), max_relative = 1e-6);
    }

    /// If the minimum lies beyond the bound of one parameter, this parameter stays at its bound.
    /// The other parameter is optimal for the parameter value at the bound.
    #[test]
    fn a_parameter_beyond_its_bound_is_held_at_the_bound() {
        let data = [(0.0, 1.0), (1.0, 3.0), (2.0, 5.0)];
        let found = fit(&[0.5, 0.5], &[(-10.0, 10.0), (0.0, 1.0)], |x, t| x[0] + x[1] * t, &data);
        assert_relative_eq!(found.parameters[1], 1.0);
        assert_relative_eq!(found.parameters[0], 2.0, epsilon = 1e-7);
        assert_eq!(found.at_bound, [false, true]);
    }

    /// The exact solution lies on a bound, but the bound is not active.
    #[test]
    fn parameter_whose_exact_value_is_on_its_bound_is_not_held() {
        let data = [(0.0, 2.0), (1.0, 3.0), (2.0, 4.0)];
        let found = fit(&[0.5, 0.5], &[(-10.0, 10.0), (0.0, 1.0)], |x, t| x[0] + x[1] * t, &data);
        assert_relative_eq!(found.parameters[1], 1.0, epsilon = 1e-7);
        assert_eq!(found.at_bound, [false, false]);
    }
}
