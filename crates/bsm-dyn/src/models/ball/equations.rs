//! Implementations of [`bsm_newton::Equations`] for formulas that are generic over the scalar type.

use bsm_kin::Jet;
use bsm_newton::EvalError;

use super::ball_unknowns::BALL_UNKNOWNS;

/// Reusable buffers for solving `N` equations with Newton's method.
pub(crate) type Workspace<const N: usize = BALL_UNKNOWNS> = bsm_newton::Workspace<N>;

/// Converts the values of unknowns into jets that contain the derivatives with respect to these
/// unknowns.
pub(crate) fn variables<const N: usize>(x: &[f64; N]) -> [Jet<N>; N] {
    std::array::from_fn(|i| Jet::variable(x[i], i))
}

/// Returns the values and the exact Jacobian of `N` functions of `M` unknowns from one evaluation
/// with jets.
///
/// # Errors
/// Returns the error that `residual` returns.
pub(crate) fn linear<const N: usize, const M: usize>(
    x: &[f64; M],
    residual: impl FnOnce(&[Jet<M>; M]) -> Result<[Jet<M>; N], EvalError>,
) -> Result<([f64; N], [[f64; M]; N]), EvalError> {
    let f = residual(&variables(x))?;
    Ok((std::array::from_fn(|i| f[i].re), std::array::from_fn(|i| f[i].eps)))
}

/// Implements [`bsm_newton::Equations`] with `$n` equations for a type. The arguments of the macro
/// are a residual function that is generic over the scalar type, and the names of the equations.
macro_rules! equations {
    ($system:ty, $n:ident, $residual:path, $names:expr) => {
        impl bsm_newton::Equations<$n> for $system {
            type Details = ();
            type Slopes = ();

            fn residual(&self, x: &[f64; $n]) -> Result<([f64; $n], ()), bsm_newton::EvalError> {
                Ok(($residual(self, x)?, ()))
            }

            fn linearize(
                &self,
                x: &[f64; $n],
                rows: &mut [[f64; $n]; $n],
            ) -> bsm_newton::Linearized<$n, Self> {
                let values;
                (values, *rows) = $crate::models::ball::linear(x, |x| $residual(self, x))?;
                Ok((values, (), ()))
            }

            fn equation(&self, i: usize) -> String {
                let names: [&str; $n] = $names;
                names[i].to_owned()
            }
        }
    };
}
pub(crate) use equations;
