//! Derivatives of the efficiency and the torque at a solved point, calculated with the implicit
//! function theorem.
//!
//! Each input is a jet, which contains a value and its derivatives. Theory:
//! `docs/theory/12-sensitivities.md`, equations (V1) to (V3), (V5).

use std::array::from_fn;

use bsm_kin::{Jet, Scalar};
use bsm_newton::{Equations, EvalError, NoSlopes, implicit_slopes};

use super::equations::Workspace;
use crate::outcome::{Reason, SolveFailure, domain_error};

/// Efficiency and torque of a screw at an operating point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Performance<D> {
    /// Efficiency of the screw.
    pub efficiency: D,
    /// Torque of all balls on the screw \[N·m\]; `None` if the model does not calculate the torque.
    pub screw_torque: Option<D>,
}

impl<D: Scalar> Performance<D> {
    /// Extrapolates linearly from `far` through `self` to a point beyond `self`. The distance of
    /// this point from `self` is `ratio` times the difference between `self` and `far`.
    fn extrapolated(&self, far: &Self, ratio: f64) -> Self {
        let extrapolated = |near: D, far: D| near + (near - far) * ratio;
        let torques = self.screw_torque.zip(far.screw_torque);
        Self {
            efficiency: extrapolated(self.efficiency, far.efficiency),
            screw_torque: torques.map(|(near, far)| extrapolated(near, far)),
        }
    }
}

/// Returns the root `x` of `system` with its derivatives with respect to the inputs (V1), (V2).
///
/// * `weights`: weights of the equations, which must equal the weights with which the root was
///   found.
/// * `residual`: function that evaluates the equations of `system` for inputs with derivatives.
///
/// # Errors
///
/// Returns [`Reason::SingularRoot`] if the Jacobian is singular, and [`Reason::Refused`] if the
/// equations cannot be evaluated.
pub(crate) fn moving_root<const N: usize, const M: usize>(
    system: &impl Equations<N>,
    x: &[f64; N],
    weights: &[f64; N],
    residual: impl FnOnce(&[Jet<M>; N]) -> Result<[Jet<M>; N], EvalError>,
    newton: &mut Workspace<N>,
) -> Result<[Jet<M>; N], SolveFailure> {
    // F_p = ∂F(x, p)/∂p at constant x                                     (V1)
    let by_inputs = residual(&x.map(Jet::from)).map_err(domain_error)?;
    let mut columns: [[f64; N]; M] = from_fn(|i| from_fn(|row| by_inputs[row].eps[i]));
    // dx/dp = −J⁻¹ F_p                                                    (V2)
    implicit_slopes(system, x, weights, &mut columns, newton).map_err(|error| match error {
        NoSlopes::Refused(error) => domain_error(error),
        NoSlopes::Singular(_) => SolveFailure::not_converged(Reason::SingularRoot),
    })?;
    Ok(from_fn(|row| Jet { re: x[row], eps: from_fn(|i| columns[i][row]) }))
}

/// Returns the performance at an operating point. If `factor` is above one, the inertia forces at
/// this point are too small compared with the rounding errors of the loads. The result is then
/// extrapolated from two points with `factor` and `2 factor` times the inertia (V5).
///
/// * `at`: function that returns the performance with the inertia multiplied by its argument.
///
/// # Errors
/// Returns the first error that the function `at` returns.
pub(crate) fn inertia_limit<D: Scalar, E>(
    factor: f64,
    mut at: impl FnMut(f64) -> Result<Performance<D>, E>,
) -> Result<Performance<D>, E> {
    if factor <= 1.0 {
        return at(1.0);
    }
    // T(1) = T(k) + (T(k) − T(2k))(1 − 1/k)                               (V5)
    Ok(at(factor)?.extrapolated(&at(2.0 * factor)?, 1.0 - factor.recip()))
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use approx::assert_relative_eq;

    use super::*;

    /// Returns a performance whose efficiency and torque depend linearly on the inertia.
    fn linear(factor: f64) -> Performance<f64> {
        Performance { efficiency: 0.9 - 1e-4 * factor, screw_torque: Some(2.0 + 3e-3 * factor) }
    }

    #[test]
    fn extrapolation_to_the_actual_inertia_is_exact_for_linear_functions() {
        for factor in [1.5, 10.0, 1e4] {
            let mut factors = Vec::new();
            let found = inertia_limit(factor, |factor| {
                factors.push(factor);
                Ok::<_, Infallible>(linear(factor))
            });
            let (Ok(found), expected) = (found, linear(1.0));
            assert_eq!(factors, [factor, 2.0 * factor]);
            // The values at the far point are up to 30 times as large as the result.
            assert_relative_eq!(found.efficiency, expected.efficiency, max_relative = 1e-13);
            let torques = found.screw_torque.zip(expected.screw_torque).expect("two torques");
            assert_relative_eq!(torques.0, torques.1, max_relative = 1e-13);
        }
    }

    #[test]
    fn sufficient_inertia_is_evaluated_once_without_extrapolation() {
        for factor in [0.0, 0.5, 1.0] {
            let mut factors = Vec::new();
            let found = inertia_limit(factor, |factor| {
                factors.push(factor);
                Ok::<_, Infallible>(linear(factor))
            });
            assert_eq!((found, factors), (Ok(linear(1.0)), vec![1.0]));
        }
    }
}
