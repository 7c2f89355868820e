//! Searches along one variable, by argmin.

use argmin::core::{CostFunction, Executor};
use argmin::solver::brent::{BrentOpt, BrentRoot};

use crate::ValidateError;

/// A function of one variable for argmin.
struct OneVariable<F>(F);

impl<F: Fn(f64) -> Result<f64, ValidateError>> CostFunction for OneVariable<F> {
    type Param = f64;
    type Output = f64;

    fn cost(&self, x: &f64) -> Result<f64, argmin::core::Error> {
        self.0(*x).map_err(argmin::core::Error::from)
    }
}

/// Root of `function` between two points of different sign.
pub(crate) fn root_of(
    function: impl Fn(f64) -> Result<f64, ValidateError>,
    low: f64,
    high: f64,
) -> Result<f64, ValidateError> {
    let solver = BrentRoot::new(low, high, 1e-10);
    let found = Executor::new(OneVariable(function), solver)
        .configure(|state| state.param(0.5 * (low + high)).max_iters(200))
        .run()?;
    Ok(found.state.best_param.unwrap_or(f64::NAN))
}

/// Minimum of `function` between two points.
pub(crate) fn minimum_of(
    function: impl Fn(f64) -> Result<f64, ValidateError>,
    low: f64,
    high: f64,
) -> Result<f64, ValidateError> {
    let found =
        Executor::new(OneVariable(function), BrentOpt::new(low, high).set_tolerance(1e-9, 1e-12))
            .configure(|state| state.max_iters(200))
            .run()?;
    Ok(found.state.best_param.unwrap_or(f64::NAN))
}
