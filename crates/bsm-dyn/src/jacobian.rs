//! From a generic residual to values and Jacobian, for [`bsm_newton::System::linearize`].

use bsm_kin::Jet;
use bsm_newton::{EvalError, MatMut};

/// Value and exact Jacobian of `N` functions of `N` unknowns, by evaluating them once in jets.
pub(crate) fn linearize<const N: usize, F: AsRef<[Jet<N>]>>(
    function: impl FnOnce([Jet<N>; N]) -> Result<F, EvalError>,
    x: &[f64],
    r: &mut [f64],
    mut jac: MatMut<'_, f64>,
) -> Result<(), EvalError> {
    let f = function(std::array::from_fn(|i| Jet::variable(x[i], i)))?;
    for (row, f) in f.as_ref().iter().enumerate() {
        r[row] = f.re;
        for (col, slope) in f.eps.iter().enumerate() {
            jac[(row, col)] = *slope;
        }
    }
    Ok(())
}
