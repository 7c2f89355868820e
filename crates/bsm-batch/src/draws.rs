//! Random operating points. Each random number depends only on the seed, the input and the row, so
//! any machine can generate any row without generating the others.

use std::f64::consts::TAU;
use std::fmt::{self, Display, Formatter};
use std::ops::Range;

use bsm_case::{AxisValues, CaseError, Grid, GridAxis, InputKey};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::source::{PointSet, PointSource};

/// Probability distribution of an input value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Distribution {
    /// A uniform distribution between two bounds.
    Uniform {
        /// Lower bound of the distribution.
        low: f64,
        /// Upper bound of the distribution.
        high: f64,
    },
    /// A normal distribution with a given mean and standard deviation.
    Normal {
        /// Mean of the distribution.
        mean: f64,
        /// Standard deviation of the distribution.
        deviation: f64,
    },
}

/// An input whose value is random, and its probability distribution.
#[derive(Debug, Clone, PartialEq)]
pub struct RandomInput {
    key: InputKey,
    distribution: Distribution,
}

impl RandomInput {
    /// Parses `name=uniform:low:high` or `name=normal:mean:deviation`. The name may end with any
    /// unit that is supported for the input.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] if the text does not have one of these forms, or an error of
    /// [`new`](Self::new).
    pub fn parse(text: &str) -> Result<Self, CaseError> {
        let form = "name=uniform:low:high with low < high, or name=normal:mean:deviation with a deviation > 0, \
                    all finite";
        let bad = || CaseError::bad_setting(text, form);
        let (name, words) = text.split_once('=').ok_or_else(bad)?;
        let [word, first, second] = words.split(':').collect::<Vec<_>>()[..] else {
            return Err(bad());
        };
        let number = |text: &str| text.trim().parse().ok();
        let (first, second) = number(first).zip(number(second)).ok_or_else(bad)?;
        let distribution = match word.trim() {
            "uniform" => Distribution::Uniform { low: first, high: second },
            "normal" => Distribution::Normal { mean: first, deviation: second },
            _ => return Err(bad()),
        };
        Self::new(name.trim(), distribution)
    }

    /// Assigns a probability distribution to an input.
    ///
    /// * `name`: name of the input, which may end with any supported unit.
    /// * `distribution`: probability distribution of the value, in the unit at the end of `name`.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] if the input is unknown, a number is not finite, the bounds are not in
    /// ascending order, the standard deviation is not positive, or the input does not permit one of
    /// the bounds or the mean.
    pub fn new(name: &str, distribution: Distribution) -> Result<Self, CaseError> {
        let (key, change) = InputKey::in_unit(name)?;
        let wrong = |what: String| {
            let (key, what) = (key.name().to_owned(), format!("`{}`: {what}", key.name()));
            Err(CaseError::Entry { key, what })
        };
        let check = |value| key.input().rule.check(key.name(), value);
        let distribution = match distribution {
            Distribution::Uniform { low, high } => {
                let (low, high) = (change.value(low), change.value(high));
                if !(low < high && (high - low).is_finite()) {
                    return wrong(format!(
                        "a uniform distribution has the bounds {low} and {high}, but must have finite bounds low < high"
                    ));
                }
                check(low)?;
                check(high)?;
                Distribution::Uniform { low, high }
            }
            Distribution::Normal { mean, deviation } => {
                let (mean, deviation) = (change.value(mean), change.difference(deviation));
                if !(mean.is_finite() && deviation.is_finite() && deviation > 0.0) {
                    return wrong(format!(
                        "a normal distribution has the mean {mean} and the deviation {deviation}, but must have a finite \
                         mean and a finite deviation > 0"
                    ));
                }
                check(mean)?;
                Distribution::Normal { mean, deviation }
            }
        };
        Ok(Self { key, distribution })
    }
}

/// Writes the text that [`RandomInput::parse`] reads, with as few digits as are needed to reproduce the
/// numbers exactly.
impl Display for RandomInput {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let number = |value: f64| format!("{value:?}").trim_end_matches(".0").to_owned();
        let (word, first, second) = match self.distribution {
            Distribution::Uniform { low, high } => ("uniform", low, high),
            Distribution::Normal { mean, deviation } => ("normal", mean, deviation),
        };
        write!(f, "{}={word}:{}:{}", self.key.name(), number(first), number(second))
    }
}

/// A set of random operating points.
#[derive(Debug, Clone, PartialEq)]
pub struct RandomPoints {
    seed: u64,
    count: u64,
    inputs: Vec<RandomInput>,
}

impl RandomPoints {
    /// Creates random points from the texts that [`RandomInput::parse`] reads.
    ///
    /// # Errors
    ///
    /// Returns the same errors as [`RandomInput::parse`] and [`new`](Self::new).
    pub fn parse<T: AsRef<str>>(seed: u64, count: u64, inputs: &[T]) -> Result<Self, CaseError> {
        let inputs = inputs.iter().map(|draw| RandomInput::parse(draw.as_ref()));
        Self::new(seed, count, inputs.collect::<Result<_, _>>()?)
    }

    /// Creates random points whose inputs are statistically independent.
    ///
    /// # Errors
    ///
    /// Returns [`CaseError`] if an input appears twice.
    pub fn new(seed: u64, count: u64, inputs: Vec<RandomInput>) -> Result<Self, CaseError> {
        let this = Self { seed, count, inputs };
        this.corners()?;
        Ok(this)
    }

    /// Returns the seed of the random number generator.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Returns the random inputs and their distributions.
    pub fn inputs(&self) -> &[RandomInput] {
        &self.inputs
    }

    /// Returns a grid of the bounds of all uniform distributions and the means of all normal
    /// distributions. A task is valid for the random points if it is valid for this grid.
    ///
    /// # Errors
    ///
    /// Returns the same errors as [`Grid::new`].
    pub fn corners(&self) -> Result<Grid, CaseError> {
        let axis = |draw: &RandomInput| {
            let values = match draw.distribution {
                Distribution::Uniform { low, high } => vec![low, high],
                Distribution::Normal { mean, .. } => vec![mean],
            };
            GridAxis::new(draw.key.name(), AxisValues::List(values))
        };
        Grid::new(self.inputs.iter().map(axis).collect::<Result<_, _>>()?)
    }

    /// Returns the random inputs, each with its values at all points.
    pub fn columns(&self) -> impl Iterator<Item = (InputKey, Vec<f64>)> {
        self.inputs.iter().enumerate().map(|(index, draw)| {
            let mut values = Vec::new();
            self.append_values(index, 0..self.count, &mut values);
            (draw.key, values)
        })
    }
}

impl PointSet for RandomPoints {
    fn inputs(&self) -> Vec<InputKey> {
        self.inputs.iter().map(|draw| draw.key).collect()
    }

    fn count(&self) -> u64 {
        self.count
    }

    fn append_values(&self, index: usize, rows: Range<u64>, to: &mut Vec<f64>) {
        /// Number of 32-bit words that the random number generator needs for one number between 0
        /// and 1.
        const WORDS: u128 = 2;
        let distribution = self.inputs[index].distribution;
        let numbers = if matches!(distribution, Distribution::Uniform { .. }) { 1 } else { 2 };
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        rng.set_stream(index as u64);
        rng.set_word_pos(WORDS * numbers * u128::from(rows.start));
        to.extend(rows.map(|_| match distribution {
            Distribution::Uniform { low, high } => low + (high - low) * rng.random::<f64>(),
            Distribution::Normal { mean, deviation } => {
                // The Box-Muller transform generates a normally distributed number from two uniform
                // numbers, the first of which is never 0. Logarithm and cosine come from a crate,
                // because the math libraries of operating systems give different results.
                let (size, turn) = (1.0 - rng.random::<f64>(), rng.random::<f64>());
                mean + deviation * (-2.0 * libm::log(size)).sqrt() * libm::cos(TAU * turn)
            }
        }));
    }
}

/// A source whose rows are random points.
pub type RandomSource = PointSource<RandomPoints>;
