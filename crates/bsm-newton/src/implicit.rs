//! How a root moves with what its equations depend on.

use crate::{Status, System, UsageError, Workspace};

/// Overwrites derivatives of the equations with those of the root `x`, by the implicit function
/// theorem (N7).
///
/// ```math
/// F(x(p), p) = 0 \quad\Rightarrow\quad J\,\frac{dx}{dp} = -\frac{\partial F}{\partial p}
/// ```
///
/// * `f_scale`: what counts as one unit of each equation, as in [`Scales::f`](crate::Scales::f).
/// * `columns`: `$\partial F/\partial p$` at the root, `n` numbers for each `$p$`, one column after
///   the other; on return `$dx/dp$`.
///
/// The status is [`Status::Converged`], or says why there are no derivatives:
/// [`Status::ModelRefused`], [`Status::SingularJacobian`].
///
/// # Errors
///
/// [`UsageError`] if a length is not `n`, or that of `columns` not a multiple of it.
pub fn implicit_slopes<S: System + ?Sized>(
    system: &S,
    x: &[f64],
    f_scale: &[f64],
    columns: &mut [f64],
    work: &mut Workspace,
) -> Result<Status, UsageError> {
    let n = system.dim();
    let whole = if columns.len().is_multiple_of(n) { n } else { columns.len() };
    let lengths =
        [("x", x.len()), ("f_scale", f_scale.len()), ("columns", whole), ("work", work.r.len())];
    for (name, found) in lengths {
        if found != n {
            return Err(UsageError::Dimension { name, expected: n, found });
        }
    }
    if system.linearize(x, &mut work.r, work.lu.matrix()).is_err() {
        return Ok(Status::ModelRefused);
    }
    // D_F J dx/dp = −D_F ∂F/∂p                                            (N7)
    work.lu.scale_rows(f_scale);
    for column in columns.chunks_exact_mut(n) {
        for (entry, d) in column.iter_mut().zip(f_scale) {
            *entry *= -d;
        }
    }
    let regular = work.lu.solve(columns);
    Ok(if regular { Status::Converged } else { Status::SingularJacobian })
}
