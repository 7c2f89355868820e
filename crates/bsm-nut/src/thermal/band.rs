//! How far a warm state may be off where conductances are guessed.
//!
//! Theory: `docs/theory/19-warm-state.md`, equation (I21).

use super::{NoSteadyState, Steady, Surfaces, WarmNut};

/// A quantity that is guessed unless it is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Guess {
    /// What the nut gives to the air.
    Nut,
    /// The film of the screw.
    ScrewFilm,
    /// Gap and wipers.
    Gap,
    /// Contacts of the balls, both.
    Balls,
    /// Ends of the screw.
    Ends,
    /// Heat of contacts and drag.
    Heat,
}

impl Guess {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Nut, Self::ScrewFilm, Self::Gap, Self::Balls, Self::Ends, Self::Heat];

    /// Factor by which it may be more or less.
    pub fn range(self) -> f64 {
        match self {
            Self::Nut | Self::Balls => 2.0,
            Self::ScrewFilm => 1.4,
            Self::Gap | Self::Ends => 3.0,
            Self::Heat => 1.25,
        }
    }

    /// In words, after "runs away if".
    pub fn name(self) -> &'static str {
        match self {
            Self::Nut => "the nut gives away",
            Self::ScrewFilm => "the screw gives away",
            Self::Gap => "gap and wipers conduct",
            Self::Balls => "the balls conduct",
            Self::Ends => "the ends give away",
            Self::Heat => "contacts and drag heat",
        }
    }

    /// Factor on it where one guess is off.
    pub(super) fn factor(self, off: Option<(Self, f64)>) -> f64 {
        off.filter(|(guess, _)| *guess == self).map_or(1.0, |(_, by)| by)
    }

    /// True if a case gives it.
    fn is_given(self, of: &Surfaces) -> bool {
        match self {
            Self::Nut => of.nut.or(of.carriage).is_some(),
            Self::ScrewFilm => of.screw_film.is_some(),
            Self::Gap => of.gap.is_some(),
            Self::Balls => of.ball_nut.is_some() && of.ball_screw.is_some(),
            Self::Ends => of.end.is_some(),
            Self::Heat => false,
        }
    }
}

/// Between what numbers of a warm state lie.
#[derive(Debug, Clone)]
pub struct StateInterval {
    /// The numbers themselves.
    pub values: Vec<f64>,
    /// Lower and upper end of each number.
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
