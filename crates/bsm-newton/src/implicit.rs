//! How a root moves with what its equations depend on.

use crate::{Dense, Equations, LinearSolver, Status, Workspace};

/// Overwrites derivatives of the equations with those of the root `x`, by the implicit function
/// theorem (N7).
///
/// ```math
/// F(x(p), p) = 0 \quad\Rightarrow\quad J\,\frac{dx}{dp} = -\frac{\partial F}{\partial p}
/// ```
///
/// * `f_scale`: what counts as one unit of each equation, as in [`Scales::f`](crate::Scales::f).
/// * `columns`: `$\partial F/\partial p$` at the root for each `$p$`; on return `$dx/dp$`.
///
/// The status is [`Status::Converged`], or says why there are no derivatives:
/// [`Status::OutsideDomain`], [`Status::SingularJacobian`].
pub fn implicit_slopes<const N: usize, E: Equations<N> + ?Sized>(
    equations: &E,
    x: &[f64; N],
    f_scale: &[f64; N],
    columns: &mut [[f64; N]],
    work: &mut Workspace<Dense<N>>,
) -> Status {
    let Ok((_, rows)) = equations.linearize(x) else { return Status::OutsideDomain };
    *work.linear.rows_mut() = rows;
    // D_F J dx/dp = −D_F ∂F/∂p                                            (N7)
    work.linear.scale_rows(f_scale);
    if work.linear.factorize().is_err() {
        return Status::SingularJacobian;
    }
    for column in columns.iter_mut() {
        for (entry, d) in column.iter_mut().zip(f_scale) {
            *entry *= -d;
        }
        work.linear.solve(column);
    }
    let finite = columns.iter().flatten().all(|slope| slope.is_finite());
    if finite { Status::Converged } else { Status::SingularJacobian }
}
