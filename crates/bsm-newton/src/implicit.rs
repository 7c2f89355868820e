//! Derivatives of a root with respect to parameters of its equations.

use crate::{Equations, Termination, Workspace};

/// Overwrites derivatives of the equations with derivatives of the root `x`, by the implicit
/// function theorem (N7).
///
/// ```math
/// F(x(p), p) = 0 \quad\Rightarrow\quad J\,\frac{dx}{dp} = -\frac{\partial F}{\partial p}
/// ```
///
/// * `f_scale`: reciprocals of the typical sizes of the equations, as in
///   [`Scales::f`](crate::Scales::f).
/// * `columns`: `$\partial F/\partial p$` at the root for each `$p$` on entry, `$dx/dp$` on return.
///
/// The status is [`Termination::Converged`] if the derivatives exist, and otherwise
/// [`Termination::OutsideDomain`] or [`Termination::SingularJacobian`]. After a failure, some
/// columns may be unchanged.
pub fn implicit_slopes<const N: usize, E: Equations<N> + ?Sized>(
    equations: &E,
    x: &[f64; N],
    f_scale: &[f64; N],
    columns: &mut [[f64; N]],
    work: &mut Workspace<N>,
) -> Termination {
    if work.linearize(equations, x, f_scale).is_err() {
        return Termination::OutsideDomain;
    }
    for column in columns {
        // D_F J dx/dp = −D_F ∂F/∂p                                        (N7)
        match work.correction(column) {
            Ok(slopes) if slopes.iter().all(|slope| slope.is_finite()) => *column = slopes,
            _ => return Termination::SingularJacobian,
        }
    }
    Termination::Converged
}
