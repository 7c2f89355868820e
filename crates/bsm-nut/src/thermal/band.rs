//! How far a warm state may be off where conductances are guessed.
//!
//! Theory: `docs/theory/19-warm-state.md`, equation (I21).

use super::{Guess, NoSteadyState, Steady, WarmNut};

/// Between what numbers of a warm state lie.
#[derive(Debug, Clone)]
pub struct StateInterval {
    /// The numbers themselves.
    pub values: Vec<f64>,
    /// Lower and upper end of each number by the guesses that have a state.
    pub ends: Vec<[f64; 2]>,
    /// Guesses with which there is no state, and the factor on them.
    pub none: Vec<(Guess, f64, NoSteadyState)>,
}

impl WarmNut<'_> {
    /// The band of some numbers of its state by what is guessed (I21): each that is not given, more and less by its range, one at a
    /// time.
    ///
    /// * `numbers`: of a state of a nut, always as many.
    pub fn band(
        &self,
        state: &Steady,
        numbers: impl Fn(&WarmNut<'_>, &Steady) -> Vec<f64>,
    ) -> StateInterval {
        let middle = numbers(self, state);
        let mut squares = vec![[0.0_f64; 2]; middle.len()];
        let mut none = Vec::new();
        for guess in Guess::ALL.into_iter().filter(|guess| !guess.is_given(&self.surfaces)) {
            let mut most = vec![[0.0_f64; 2]; middle.len()];
            for factor in [guess.range().recip(), guess.range()] {
                let other = WarmNut { off: Some((guess, factor)), ..self.clone() };
                match other.steady() {
                    Ok(found) => {
                        let found = numbers(&other, &found);
                        for (most, (found, middle)) in
                            most.iter_mut().zip(found.iter().zip(&middle))
                        {
                            *most = [most[0].max(middle - found), most[1].max(found - middle)];
                        }
                    }
                    Err(why) => none.push((guess, factor, why)),
                }
            }
            for (squares, most) in squares.iter_mut().zip(most) {
                *squares = [squares[0] + most[0].powi(2), squares[1] + most[1].powi(2)];
            }
        }
        // upper = value + √(Σ largest rise²), lower likewise              (I21)
        let end =
            |(middle, [down, up]): (&f64, &[f64; 2])| [middle - down.sqrt(), middle + up.sqrt()];
        let ends = middle.iter().zip(&squares).map(end).collect();
        StateInterval { values: middle, ends, none }
    }
}
