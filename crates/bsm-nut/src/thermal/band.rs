//! Uncertainty of a warm state due to estimated conductances and missing heat sources.
//!
//! Theory: `docs/theory/19-warm-state.md`, equation (I21).

use super::{Guess, NoSteadyState, Steady, ThermalAxis, WarmNut};

/// Uncertainty band of results of a warm state.
#[derive(Debug, Clone)]
pub struct StateInterval {
    /// The results themselves.
    pub values: Vec<f64>,
    /// Lower and upper end for each result, from the estimates for which a state exists.
    pub ends: Vec<[f64; 2]>,
    /// Estimates for which no state exists, with their factors.
    pub none: Vec<(Guess, f64, NoSteadyState)>,
    /// The reason why no state exists with usual values of the heat sources that are not given.
    pub none_complete: Option<NoSteadyState>,
}

/// Returns the uncertainty band of results (I21). Each estimated quantity is multiplied and divided
/// by its factor, one at a time. The change due to heat sources that are not given is added to the
/// end in its direction.
///
/// * `guessed`: calculates the results with one estimated quantity multiplied by a factor.
/// * `complete`: calculates the results with usual values of the missing sources.
pub(super) fn interval(
    middle: Vec<f64>,
    guesses: impl Iterator<Item = Guess>,
    guessed: impl Fn((Guess, f64)) -> Result<Vec<f64>, NoSteadyState>,
    complete: impl Fn() -> Result<Vec<f64>, NoSteadyState>,
) -> StateInterval {
    // Changes of the results toward lower and higher values in another state.
    let changes = |found: &[f64]| -> Vec<[f64; 2]> {
        let change =
            |(found, middle): (&f64, &f64)| [(middle - found).max(0.0), (found - middle).max(0.0)];
        found.iter().zip(&middle).map(change).collect()
    };
    let mut squares = vec![[0.0_f64; 2]; middle.len()];
    let mut none = Vec::new();
    for guess in guesses {
        let mut most = vec![[0.0_f64; 2]; middle.len()];
        for factor in [guess.range().recip(), guess.range()] {
            match guessed((guess, factor)) {
                Ok(found) => {
                    for (most, by) in most.iter_mut().zip(changes(&found)) {
                        *most = [most[0].max(by[0]), most[1].max(by[1])];
                    }
                }
                Err(why) => none.push((guess, factor, why)),
            }
        }
        for (squares, most) in squares.iter_mut().zip(most) {
            *squares = [squares[0] + most[0].powi(2), squares[1] + most[1].powi(2)];
        }
    }
    let (shifts, none_complete) = match complete() {
        Ok(found) => (changes(&found), None),
        Err(why) => (vec![[0.0; 2]; middle.len()], Some(why)),
    };
    // upper = value + shift + √(Σ largest rise²), lower likewise          (I21)
    let end = |((middle, [down, up]), [less, more]): ((&f64, &[f64; 2]), [f64; 2])| {
        [middle - less - down.sqrt(), middle + more + up.sqrt()]
    };
    let ends = middle.iter().zip(&squares).zip(shifts).map(end).collect();
    StateInterval { values: middle, ends, none, none_complete }
}

impl WarmNut<'_> {
    /// Returns the uncertainty band of results of the state (I21).
    ///
    /// * `missing`: usual values of the torques of seals and of all support bearings that are not
    ///   given \[N·m\].
    /// * `numbers`: calculates the results from a state of a nut; the count of results is constant.
    pub fn band(
        &self,
        state: &Steady,
        missing: (f64, f64),
        numbers: impl Fn(&WarmNut<'_>, &Steady) -> Vec<f64>,
    ) -> StateInterval {
        let at = |other: &WarmNut<'_>| Ok(numbers(other, &other.steady()?));
        let surfaces = &self.axis.surfaces;
        let guesses = Guess::ALL.into_iter().filter(|guess| !guess.is_given(surfaces));
        let guessed = |off| {
            let axis = ThermalAxis { off: Some(off), ..self.axis };
            at(&WarmNut { axis, ..self.clone() })
        };
        let complete = || {
            let (seal, bearings) = (self.seal + missing.0, self.bearings + missing.1);
            if missing == (0.0, 0.0) {
                return Ok(numbers(self, state));
            }
            at(&WarmNut { seal, bearings, ..self.clone() })
        };
        interval(numbers(self, state), guesses, guessed, complete)
    }
}
