//! Newton's method for one point or for several points side by side in a SIMD vector.

use bsm_kin::Real;

/// A system of `N` equations that calculates its own Newton steps, for a single point or for
/// several points side by side.
///
/// For a small system with an analytic Jacobian, a closed-form expression for the Newton step
/// requires fewer operations than a matrix factorization.
pub trait LaneEquations<F: Real, const N: usize> {
    /// Returns the Newton step at the point `x`.
    fn newton_step(&self, x: &[F; N]) -> LaneStep<F, N>;
}

/// Newton steps of several points side by side.
#[derive(Debug, Clone, Copy)]
pub struct LaneStep<F: Real, const N: usize> {
    /// Newton step of each point, `$-J^{-1} F$`.
    pub step: [F; N],
    /// Length of the Newton step, scaled by the typical magnitudes of the unknowns.
    pub length: F,
    /// Mask that is true for points at which the equations are defined.
    pub is_defined: F::Mask,
}

/// Iterates of several points side by side.
#[derive(Debug, Clone, Copy)]
pub struct LaneIterate<F: Real, const N: usize> {
    /// Values of the unknowns.
    pub x: [F; N],
    /// Number of steps that each point has taken.
    pub steps: F,
    /// Mask that is true for points whose iteration has ended because the last step was short or
    /// not finite. The caller must check the residual.
    pub has_ended: F::Mask,
}

impl<F: Real, const N: usize> LaneIterate<F, N> {
    /// Creates the starting point of an iteration.
    ///
    /// * `requested`: mask of the points to iterate. All other points remain unchanged.
    #[inline(always)]
    pub fn starting_at(x: [F; N], requested: F::Mask) -> Self {
        Self { x, steps: x[0].constant(0.0), has_ended: !requested }
    }
}

/// Settings of Newton's method for several points side by side. Lengths are scaled by the typical
/// magnitudes of the unknowns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LaneNewton {
    /// Step length below which the iteration ends.
    pub step_tol: f64,
    /// Maximum step length, to which longer Newton steps are shortened.
    pub max_length: f64,
    /// Maximum number of steps.
    pub max_steps: usize,
}

impl LaneNewton {
    /// Iterates each point until its Newton step is short or not finite, or until the maximum
    /// number of steps has been taken.
    ///
    /// If the equations are not defined at a new point, half of the last step is undone.
    #[inline(always)]
    pub fn iterate<F: Real, const N: usize>(
        &self,
        equations: &impl LaneEquations<F, N>,
        at: &mut LaneIterate<F, N>,
    ) {
        let one = at.x[0].constant(1.0);
        let mut last = [one.constant(0.0); N];
        for _ in 0..self.max_steps {
            if !F::any(!at.has_ended) {
                break;
            }
            let LaneStep { mut step, length, is_defined } = equations.newton_step(&at.x);
            // λ = min(1, L/‖δx‖)                                              (N16)
            let ratio = one.constant(self.max_length) / length;
            let lambda = F::select(ratio.below(1.0), ratio, one);
            for k in 0..N {
                step[k] = F::select(is_defined, step[k] * lambda, last[k] * -0.5);
                at.x[k] = F::select(at.has_ended, at.x[k], at.x[k] + step[k]);
                last[k] = F::select(is_defined, step[k], -step[k]);
            }
            at.steps = F::select(at.has_ended, at.steps, at.steps + 1.0);
            let is_finite = length.below(f64::INFINITY);
            let is_short = length.below(self.step_tol);
            at.has_ended = at.has_ended | is_defined & (is_short | !is_finite);
        }
    }
}

/// Returns the Newton step for three equations by Cramer's rule.
///
/// * `residual`: residuals of the equations.
/// * `rows`: rows of the Jacobian.
#[inline(always)]
pub fn cramer<F: Real>(residual: [F; 3], [a, b, c]: [[F; 3]; 3]) -> [F; 3] {
    // δx = −[F_1 (b × c) + F_2 (c × a) + F_3 (a × b)]/[a · (b × c)]           (N17)
    let (bc, ca, ab) = (cross(&b, &c), cross(&c, &a), cross(&a, &b));
    let determinant = a[0] * bc[0] + a[1] * bc[1] + a[2] * bc[2];
    let scale = -determinant.recip();
    let [f_1, f_2, f_3] = residual;
    let mut step = [scale; 3];
    for k in 0..3 {
        step[k] = (bc[k] * f_1 + ca[k] * f_2 + ab[k] * f_3) * scale;
    }
    step
}

/// Returns the cross product of two vectors.
#[inline(always)]
fn cross<F: Real>(a: &[F; 3], b: &[F; 3]) -> [F; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The equation `$\sqrt x = 2$`, which is defined only for positive `x`.
    struct Root;

    impl LaneEquations<f64, 1> for Root {
        fn newton_step(&self, &[x]: &[f64; 1]) -> LaneStep<f64, 1> {
            let root = x.sqrt();
            let step = (2.0 - root) * 2.0 * root;
            LaneStep { step: [step], length: step.abs(), is_defined: x > 0.0 }
        }
    }

    const NEWTON: LaneNewton = LaneNewton { step_tol: 1e-9, max_length: 100.0, max_steps: 20 };

    /// The first Newton step from 40 leads to -14, which is outside the domain.
    #[test]
    fn newton_step_out_of_the_domain_is_undone() {
        let mut at = LaneIterate::starting_at([40.0], true);
        NEWTON.iterate(&Root, &mut at);
        assert!(at.has_ended, "{at:?}");
        // After a step of 1e-9, the remaining error is of the order of the squared step.
        assert!((at.x[0] - 4.0_f64).abs() <= 4.0 * f64::EPSILON, "{at:?}");
    }

    #[test]
    fn long_newton_step_is_shortened() {
        let newton = LaneNewton { max_length: 0.5, max_steps: 1, ..NEWTON };
        let mut at = LaneIterate::starting_at([1.0], true);
        newton.iterate(&Root, &mut at);
        assert_eq!((at.x, at.steps, at.has_ended), ([1.5], 1.0, false));
    }

    #[test]
    fn point_that_is_not_requested_stays_unchanged() {
        let mut at = LaneIterate::starting_at([1.0], false);
        NEWTON.iterate(&Root, &mut at);
        assert_eq!((at.x, at.steps), ([1.0], 0.0));
    }

    #[test]
    fn cramer_solves_three_equations() {
        let rows = [[2.0, 1.0, -1.0], [0.5, 3.0, 2.0], [-1.0, 1.0, 4.0]];
        let x = [1.0, -2.0, 0.5];
        let residual = rows.map(|row| row[0] * x[0] + row[1] * x[1] + row[2] * x[2]);
        let step = cramer(residual, rows);
        for (step, x) in step.into_iter().zip(x) {
            // The tolerance allows for a few rounding errors of terms up to ten.
            assert!((step + x).abs() <= 1e-14, "{step} {x}");
        }
    }
}
