//! Derivatives of a root with respect to parameters of its equations.

use crate::{Equations, NoSlopes, Singular, Workspace};

/// Calculates the derivatives of the root `x` with respect to parameters by the implicit function
/// theorem (N7).
///
/// ```math
/// F(x(p), p) = 0 \quad\Rightarrow\quad J\,\frac{dx}{dp} = -\frac{\partial F}{\partial p}
/// ```
///
/// * `f_scale`: reciprocals of the typical magnitudes of the residuals, as in
///   [`Scales::f`](crate::Scales::f).
/// * `columns`: `$\partial F/\partial p$` at the root on entry, `$dx/dp$` on return, one column per
///   parameter `$p$`.
///
/// # Errors
///
/// Returns [`NoSlopes`] if the equations cannot be linearized at the root or the Jacobian is
/// singular. Some columns may then be unchanged.
pub fn implicit_slopes<const N: usize, E: Equations<N> + ?Sized>(
    equations: &E,
    x: &[f64; N],
    f_scale: &[f64; N],
    columns: &mut [[f64; N]],
    work: &mut Workspace<N>,
) -> Result<(), NoSlopes> {
    work.linearize(equations, x, f_scale).map_err(NoSlopes::Refused)?;
    for column in columns {
        // D_F J dx/dp = −D_F ∂F/∂p                                        (N7)
        match work.correction(column) {
            Ok(slopes) if slopes.iter().all(|slope| slope.is_finite()) => *column = slopes,
            _ => return Err(NoSlopes::Singular(Singular)),
        }
    }
    Ok(())
}
