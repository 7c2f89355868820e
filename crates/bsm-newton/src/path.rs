//! Curves that are one equation short of a point.

use crate::{Dense, Equations, LinearSolver, Status, Workspace};

/// Direction of the curve of the first `N − 1` equations at `z`, where the last equation is a plane
/// across it (N8).
///
/// ```math
/// J\,t = \operatorname{sgn}(\det J)\,e_N
/// ```
///
/// The sense is the same all along a curve, through folds too, as long as the normal of the plane
/// points along it: with another plane the determinant changes its sign where `t` turns against the
/// normal. The length is arbitrary.
///
/// * `f_scale`: what counts as one unit of each equation, as in [`Scales::f`](crate::Scales::f).
///
/// # Errors
///
/// [`Status::ModelRefused`] or [`Status::SingularJacobian`]: there is no direction, as where the
/// curve branches or the plane touches it.
pub fn path_direction<const N: usize, E: Equations<N> + ?Sized>(
    equations: &E,
    z: &[f64; N],
    f_scale: &[f64; N],
    work: &mut Workspace<Dense<N>>,
) -> Result<[f64; N], Status> {
    let (_, rows) = equations.linearize(z).map_err(|_| Status::ModelRefused)?;
    *work.linear.rows_mut() = rows;
    work.linear.scale_rows(f_scale);
    work.linear.factorize().map_err(|_| Status::SingularJacobian)?;
    // D_F J t = sgn(det J) e_N                                            (N8)
    let mut direction = [0.0; N];
    if let Some(last) = direction.last_mut() {
        *last = work.linear.determinant_sign();
    }
    work.linear.solve(&mut direction);
    let finite = direction.iter().all(|t| t.is_finite());
    if finite { Ok(direction) } else { Err(Status::SingularJacobian) }
}
