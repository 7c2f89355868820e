//! Derivatives of efficiency and torque at a solved point, by the implicit function theorem.
//!
//! The inputs are jets with one variable each. Theory: `docs/theory/12-sensitivities.md`, equations
//! (V1) to (V3), (V5).

use std::array::from_fn;

use bsm_kin::{Jet, Scalar};
use bsm_newton::{Equations, EvalError, implicit_slopes};

use super::equations::Workspace;
use crate::outcome::{NoAnswer, Reason, domain_error};

/// What a designer asks of a screw at an operating point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Performance<D> {
    /// Efficiency.
    pub efficiency: D,
    /// Torque on the screw, all balls \[N·m\], if the model has it.
    pub screw_torque: Option<D>,
}

impl<D: Scalar> Performance<D> {
    /// On the line from `far` through `self`, as much further as `ratio` of the way between them.
    fn extrapolated(&self, far: &Self, ratio: f64) -> Self {
        let extrapolated = |near: D, far: D| near + (near - far) * ratio;
        let torques = self.screw_torque.zip(far.screw_torque);
        Self {
            efficiency: extrapolated(self.efficiency, far.efficiency),
            screw_torque: torques.map(|(near, far)| extrapolated(near, far)),
        }
    }
}

/// The root `x` of `system` as a function of what the `residual`, the same equations in jets,
/// depends on (V1), (V2).
///
/// * `weights`: of the equations, as in the solve.
pub(crate) fn moving_root<const N: usize, const M: usize>(
    system: &impl Equations<N>,
    x: &[f64; N],
    weights: &[f64; N],
    residual: impl FnOnce(&[Jet<M>; N]) -> Result<[Jet<M>; N], EvalError>,
    newton: &mut Workspace<N>,
) -> Result<[Jet<M>; N], NoAnswer> {
    // F_p = ∂F(x, p)/∂p at constant x                                     (V1)
    let by_inputs = residual(&x.map(Jet::from)).map_err(domain_error)?;
    let mut columns: [[f64; N]; M] = from_fn(|i| from_fn(|row| by_inputs[row].eps[i]));
    // dx/dp = −J⁻¹ F_p                                                    (V2)
    let status = implicit_slopes(system, x, weights, &mut columns, newton);
    if status != bsm_newton::Termination::Converged {
        let (residual, worst_equation) = (f64::NAN, String::new());
        return Err(NoAnswer::not_converged(Reason::Newton { status, residual, worst_equation }));
    }
    Ok(from_fn(|row| Jet { re: x[row], eps: from_fn(|i| columns[i][row]) }))
}

/// The answer of a point whose inertia must be `factor` times as large for loads in double precision
/// to tell it from none: on the line through the answers of `factor` and twice `factor` as much
/// inertia (V5). With a factor of at most one, the answer of the point itself.
///
/// * `at`: the answer with the inertia multiplied by its argument.
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
