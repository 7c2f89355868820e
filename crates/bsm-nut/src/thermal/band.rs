//! Uncertainty of a warm state due to estimated conductances and unknown heat sources.
//!
//! Theory: `docs/theory/19-warm-state.md`, equation (I21).

use super::{Estimate, NoSteadyState, SteadyState, ThermalAxis, WarmNut};

/// Results that are calculated from a warm state, together with their uncertainty band.
#[derive(Debug, Clone)]
pub struct StateInterval {
    /// Results calculated with the estimated values of all quantities.
    pub values: Vec<f64>,
    /// Lower and upper limit of the uncertainty band for each result. Changed estimates for which
    /// no steady state exists do not contribute to the band.
    pub limits: Vec<[f64; 2]>,
    /// Changed estimates for which no steady state exists. Each entry contains the estimated
    /// quantity, the factor by which it was multiplied, and the reason.
    pub failures: Vec<(Estimate, f64, NoSteadyState)>,
    /// Reason why no steady state exists if the missing heat sources have their typical values;
    /// `None` if a steady state exists.
    pub complete_failure: Option<NoSteadyState>,
}

/// Returns the uncertainty band of the results (I21). Each estimated quantity is multiplied and
/// divided by its uncertainty factor, one quantity at a time. If missing heat sources with their
/// typical values increase a result, the increase is added to the upper limit; a decrease is
/// subtracted from the lower limit.
///
/// * `with_estimate`: function that calculates the results with one estimated quantity multiplied
///   by a factor.
/// * `complete`: function that calculates the results with typical values of the missing heat
///   sources.
pub(super) fn interval(
    middle: Vec<f64>,
    estimates: impl Iterator<Item = Estimate>,
    with_estimate: impl Fn((Estimate, f64)) -> Result<Vec<f64>, NoSteadyState>,
    complete: impl Fn() -> Result<Vec<f64>, NoSteadyState>,
) -> StateInterval {
    // The closure returns the amounts by which each result decreases and increases when one
    // quantity is changed.
    let changes = |found: &[f64]| -> Vec<[f64; 2]> {
        let change =
            |(found, middle): (&f64, &f64)| [(middle - found).max(0.0), (found - middle).max(0.0)];
        found.iter().zip(&middle).map(change).collect()
    };
    let mut squares = vec![[0.0_f64; 2]; middle.len()];
    let mut failures = Vec::new();
    for estimate in estimates {
        let mut most = vec![[0.0_f64; 2]; middle.len()];
        for factor in [estimate.uncertainty_factor().recip(), estimate.uncertainty_factor()] {
            match with_estimate((estimate, factor)) {
                Ok(found) => {
                    for (most, by) in most.iter_mut().zip(changes(&found)) {
                        *most = [most[0].max(by[0]), most[1].max(by[1])];
                    }
                }
                Err(why) => failures.push((estimate, factor, why)),
            }
        }
        for (squares, most) in squares.iter_mut().zip(most) {
            *squares = [squares[0] + most[0].powi(2), squares[1] + most[1].powi(2)];
        }
    }
    let (shifts, complete_failure) = match complete() {
        Ok(found) => (changes(&found), None),
        Err(why) => (vec![[0.0; 2]; middle.len()], Some(why)),
    };
    // upper limit = value + shift + √(Σ largest increase²); the lower limit is analogous (I21)
    let limits_of = |((middle, [down, up]), [less, more]): ((&f64, &[f64; 2]), [f64; 2])| {
        [middle - less - down.sqrt(), middle + more + up.sqrt()]
    };
    let limits = middle.iter().zip(&squares).zip(shifts).map(limits_of).collect();
    StateInterval { values: middle, limits, failures, complete_failure }
}

impl WarmNut<'_> {
    /// Returns the uncertainty band of results that are calculated from a warm state (I21).
    ///
    /// * `missing`: typical torques of the seals and of all support bearings \[N·m\], or zero if
    ///   the torques are given.
    /// * `numbers`: function that calculates the results from a nut and its warm state. The number
    ///   of results must always be the same.
    pub fn band(
        &self,
        state: &SteadyState,
        missing: (f64, f64),
        numbers: impl Fn(&WarmNut<'_>, &SteadyState) -> Vec<f64>,
    ) -> StateInterval {
        let at = |other: &WarmNut<'_>| Ok(numbers(other, &other.steady()?));
        let surfaces = &self.axis.surfaces;
        let estimates = Estimate::ALL.into_iter().filter(|estimate| !estimate.is_given(surfaces));
        let with_estimate = |changed_estimate| {
            let axis = ThermalAxis { changed_estimate: Some(changed_estimate), ..self.axis };
            at(&WarmNut { axis, ..self.clone() })
        };
        let complete = || {
            let (seal, bearings) = (self.seal + missing.0, self.bearings + missing.1);
            if missing == (0.0, 0.0) {
                return Ok(numbers(self, state));
            }
            at(&WarmNut { seal, bearings, ..self.clone() })
        };
        interval(numbers(self, state), estimates, with_estimate, complete)
    }
}
