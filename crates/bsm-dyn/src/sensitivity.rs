//! Derivatives of efficiency and torque at a solved point, by the implicit function theorem.
//!
//! The inputs are jets, one variable each. Theory: `docs/theory/12-sensitivities.md`, equations (V1)
//! to (V3), (V5).

use std::array::from_fn;

use bsm_kin::{Jet, Scalar};
use bsm_newton::{Equations, EvalError, implicit_slopes};

use crate::elastic_ball::refused;
use crate::equations::Workspace;
use crate::{ModelWorkspace, Problem, Reason, Unsolved};

/// What a designer asks of a screw at an operating point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transmitted<D> {
    /// Efficiency.
    pub efficiency: D,
    /// Torque on the screw, all balls \[N·m\], if the model has it.
    pub screw_torque: Option<D>,
}

impl<D: Scalar> Transmitted<D> {
    /// On the line from `far` through `self`, as much further as `reach` of the way between them.
    fn beyond(&self, far: &Self, reach: f64) -> Self {
        let beyond = |near: D, far: D| near + (near - far) * reach;
        let torques = self.screw_torque.zip(far.screw_torque);
        Self {
            efficiency: beyond(self.efficiency, far.efficiency),
            screw_torque: torques.map(|(near, far)| beyond(near, far)),
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
) -> Result<[Jet<M>; N], Unsolved> {
    // F_p = ∂F(x, p)/∂p at constant x                                     (V1)
    let by_inputs = residual(&x.map(Jet::from)).map_err(refused)?;
    let mut columns: [[f64; N]; M] = from_fn(|i| from_fn(|row| by_inputs[row].eps[i]));
    // dx/dp = −J⁻¹ F_p                                                    (V2)
    let status = implicit_slopes(system, x, weights, &mut columns, newton);
    if status != bsm_newton::Status::Converged {
        let (residual, worst_equation) = (f64::NAN, String::new());
        return Err(Unsolved::not_converged(Reason::Newton { status, residual, worst_equation }));
    }
    Ok(from_fn(|row| Jet { re: x[row], eps: from_fn(|i| columns[i][row]) }))
}

/// The answer of a point whose inertia must be `factor` times as large for loads in double precision
/// to tell it from none: on the line through the answers of `factor` and twice `factor` as much
/// inertia (V5). With a factor of at most one, the answer of the point itself.
///
/// * `at`: the answer with the inertia multiplied by its argument.
pub(crate) fn told_by_inertia<D: Scalar, E>(
    factor: f64,
    mut at: impl FnMut(f64) -> Result<Transmitted<D>, E>,
) -> Result<Transmitted<D>, E> {
    if factor <= 1.0 {
        return at(1.0);
    }
    // T(1) = T(k) + (T(k) − T(2k))(1 − 1/k)                               (V5)
    Ok(at(factor)?.beyond(&at(2.0 * factor)?, 1.0 - factor.recip()))
}

impl<const M: usize> Problem<Jet<M>> {
    /// Solves the problem of the values, and returns efficiency and torque with their derivatives
    /// with respect to the `M` variables of the inputs.
    ///
    /// ```math
    /// \frac{dy}{dp} = \frac{\partial y}{\partial p}
    ///   - \frac{\partial y}{\partial x} J^{-1} \frac{\partial F}{\partial p}
    /// ```
    ///
    /// Choices are kept: the model of [`Auto`](crate::Auto) and its accuracy, the controlling race, the direction.
    /// Where a choice is about to change the derivatives are one-sided.
    ///
    /// # Errors
    ///
    /// Status and reason if there is no solution.
    pub fn sensitivities(
        &self,
        work: &mut ModelWorkspace,
    ) -> Result<Transmitted<Jet<M>>, Unsolved> {
        // dy/dp = ∂y/∂p + ∂y/∂x dx/dp: the outputs of x and p in jets     (V3)
        match self {
            Self::ClosedForm(p) => Ok(p.transmitted()),
            Self::QuasiStatic(p) => p.require_balance().map(|()| p.transmitted()),
            Self::Rigid(p) => p.sensitivities(&mut work.rigid),
            Self::RacewayControl(p) => p.sensitivities(&mut work.raceway),
            Self::Elastic(p) => p.sensitivities(&mut work.elastic),
            Self::Traction(p) => p.sensitivities(&mut work.traction),
            Self::Auto(p) => p.sensitivities(work),
            Self::Lubricated(p) => p.sensitivities(work),
        }
    }
}
