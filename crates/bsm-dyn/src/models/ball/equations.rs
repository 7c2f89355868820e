//! From formulas in any scalar to the equations that [`bsm_newton`] solves.

use bsm_kin::Jet;
use bsm_newton::EvalError;

use super::ball_unknowns::BALL;

/// Memory of a solve of `N` unknowns.
pub(crate) type Workspace<const N: usize = BALL> = bsm_newton::Workspace<N>;

/// Numbers as variables of jets.
pub(crate) fn variables<const N: usize>(x: &[f64; N]) -> [Jet<N>; N] {
    std::array::from_fn(|i| Jet::variable(x[i], i))
}

/// Values and exact Jacobian of `N` functions of `M` unknowns, by evaluating them once in jets.
pub(crate) fn linear<const N: usize, const M: usize>(
    x: &[f64; M],
    residual: impl FnOnce(&[Jet<M>; M]) -> Result<[Jet<M>; N], EvalError>,
) -> Result<([f64; N], [[f64; M]; N]), EvalError> {
    let f = residual(&variables(x))?;
    Ok((std::array::from_fn(|i| f[i].re), std::array::from_fn(|i| f[i].eps)))
}

/// Makes `$n` equations of a type from its residual, a function that is generic over the scalar, and
/// their names.
macro_rules! equations {
    ($system:ty, $n:ident, $residual:path, $names:expr) => {
        impl bsm_newton::Equations<$n> for $system {
            fn residual(&self, x: &[f64; $n]) -> Result<[f64; $n], bsm_newton::EvalError> {
                $residual(self, x)
            }

            fn linearize(
                &self,
                x: &[f64; $n],
                rows: &mut [[f64; $n]; $n],
            ) -> Result<[f64; $n], bsm_newton::EvalError> {
                let values;
                (values, *rows) = $crate::models::ball::linear(x, |x| $residual(self, x))?;
                Ok(values)
            }

            fn equation(&self, i: usize) -> String {
                let names: [&str; $n] = $names;
                names[i].to_owned()
            }
        }
    };
}
pub(crate) use equations;
