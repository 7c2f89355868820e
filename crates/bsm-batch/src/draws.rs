//! Random points: each number follows from the seed, its input and its row, so that any row can be drawn
//! alone, anywhere.

use std::f64::consts::TAU;
use std::fmt::{self, Display, Formatter};
use std::ops::Range;

use bsm_case::{Axis, CaseError, Grid, InputKey};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::source::{PointSet, PointSource};

/// How an input scatters.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Law {
    Uniform { low: f64, high: f64 },
    Normal { mean: f64, deviation: f64 },
}

/// An input that is drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Draw {
    key: InputKey,
    law: Law,
}

impl Draw {
    /// Parses `name=uniform:low:high` or `name=normal:mean:deviation`, in any unit of the name.
    ///
    /// # Errors
    ///
    /// [`CaseError`] for another form, an unknown input, or ends or a mean that break its rule.
    pub fn parse(text: &str) -> Result<Self, CaseError> {
        let form = "name=uniform:low:high with low < high, or name=normal:mean:deviation with a deviation > 0, \
                    all finite";
        let bad = || CaseError::bad_setting(text, form);
        let (name, law) = text.split_once('=').ok_or_else(bad)?;
        let (key, factor) = InputKey::in_unit(name.trim())?;
        let [word, first, second] = law.split(':').collect::<Vec<_>>()[..] else {
            return Err(bad());
        };
        let number = |text: &str| text.trim().parse().ok().map(|x: f64| factor * x);
        let (first, second) = number(first).zip(number(second)).ok_or_else(bad)?;
        let check = |value| key.input().rule.check(key.name(), value);
        let law = match word.trim() {
            "uniform" if first < second && (second - first).is_finite() => {
                check(first)?;
                check(second)?;
                Law::Uniform { low: first, high: second }
            }
            "normal" if first.is_finite() && second > 0.0 && second.is_finite() => {
                check(first)?;
                Law::Normal { mean: first, deviation: second }
            }
            _ => return Err(bad()),
        };
        Ok(Self { key, law })
    }
}

/// The form that [`Draw::parse`] reads, with the shortest digits that give the same numbers.
impl Display for Draw {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let number = |value: f64| format!("{value:?}").trim_end_matches(".0").to_owned();
        let (word, first, second) = match self.law {
            Law::Uniform { low, high } => ("uniform", low, high),
            Law::Normal { mean, deviation } => ("normal", mean, deviation),
        };
        write!(f, "{}={word}:{}:{}", self.key.name(), number(first), number(second))
    }
}

/// So many random points.
#[derive(Debug, Clone, PartialEq)]
pub struct Draws {
    seed: u64,
    count: u64,
    of: Vec<Draw>,
}

impl Draws {
    /// As [`new`](Self::new), of inputs in the form of [`Draw::parse`].
    ///
    /// # Errors
    ///
    /// As [`Draw::parse`] and [`new`](Self::new).
    pub fn parse<T: AsRef<str>>(seed: u64, count: u64, of: &[T]) -> Result<Self, CaseError> {
        let of = of.iter().map(|draw| Draw::parse(draw.as_ref()));
        Self::new(seed, count, of.collect::<Result<_, _>>()?)
    }

    /// Points whose inputs are drawn independently of one another.
    ///
    /// # Errors
    ///
    /// [`CaseError`] if an input appears twice.
    pub fn new(seed: u64, count: u64, of: Vec<Draw>) -> Result<Self, CaseError> {
        let this = Self { seed, count, of };
        this.corners()?;
        Ok(this)
    }

    /// The seed.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// The drawn inputs.
    pub fn of(&self) -> &[Draw] {
        &self.of
    }

    /// The grid of ends and means: a task for it is one for the draws.
    ///
    /// # Errors
    ///
    /// As [`Grid::new`].
    pub fn corners(&self) -> Result<Grid, CaseError> {
        let axis = |draw: &Draw| {
            let values = match draw.law {
                Law::Uniform { low, high } => format!("{low:?},{high:?}"),
                Law::Normal { mean, .. } => format!("{mean:?}"),
            };
            Axis::parse(&format!("{}={values}", draw.key.name()))
        };
        Grid::new(self.of.iter().map(axis).collect::<Result<_, _>>()?)
    }

    /// Each drawn input with its values at all points.
    pub fn columns(&self) -> impl Iterator<Item = (InputKey, Vec<f64>)> {
        self.of.iter().enumerate().map(|(index, draw)| {
            let mut values = Vec::new();
            self.fill(index, 0..self.count, &mut values);
            (draw.key, values)
        })
    }
}

impl PointSet for Draws {
    fn inputs(&self) -> Vec<InputKey> {
        self.of.iter().map(|draw| draw.key).collect()
    }

    fn count(&self) -> u64 {
        self.count
    }

    fn fill(&self, index: usize, rows: Range<u64>, to: &mut Vec<f64>) {
        /// Words of 32 bits of a number between 0 and 1.
        const WORDS: u128 = 2;
        let law = self.of[index].law;
        let numbers = if matches!(law, Law::Uniform { .. }) { 1 } else { 2 };
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        rng.set_stream(index as u64);
        rng.set_word_pos(WORDS * numbers * u128::from(rows.start));
        to.extend(rows.map(|_| match law {
            Law::Uniform { low, high } => low + (high - low) * rng.random::<f64>(),
            Law::Normal { mean, deviation } => {
                // By Box and Muller; the first is never 0. Logarithm and cosine of this crate are the same
                // everywhere, those of the system are not.
                let (size, turn) = (1.0 - rng.random::<f64>(), rng.random::<f64>());
                mean + deviation * (-2.0 * libm::log(size)).sqrt() * libm::cos(TAU * turn)
            }
        }));
    }
}

/// The rows of random points.
pub type DrawSource = PointSource<Draws>;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Source;

    fn draws(of: &[&str]) -> Draws {
        let of = of.iter().map(|text| Draw::parse(text).expect("a draw")).collect();
        Draws::new(2026, 20_000, of).expect("draws")
    }

    fn column(draws: &Draws, index: usize, rows: Range<u64>) -> Vec<f64> {
        let mut values = Vec::new();
        draws.fill(index, rows, &mut values);
        values
    }

    /// A row is the same number alone, in any chunk and behind any skip.
    #[test]
    fn a_row_is_a_function_of_seed_input_and_number() {
        let draws = draws(&["axial_load_kN=uniform:2:8", "lead_mm=normal:20:0.01"]);
        for index in 0..2 {
            let all = column(&draws, index, 0..5000);
            for rows in [0..1, 4999..5000, 17..18, 1000..1300, 1..5000] {
                let [from, to] =
                    [rows.start, rows.end].map(|row| usize::try_from(row).expect("few"));
                assert_eq!(column(&draws, index, rows), all[from..to]);
            }
        }
        let far = column(&draws, 1, u64::MAX / 2..u64::MAX / 2 + 2);
        assert_eq!(far[1..], column(&draws, 1, u64::MAX / 2 + 1..u64::MAX / 2 + 2));
        let mut source = DrawSource::new(draws.clone());
        source.skip(19_990).expect("never fails");
        let chunk = source.next(100).expect("never fails").expect("rows");
        assert_eq!((chunk.first, chunk.len), (19_991, 10));
        assert_eq!(chunk.inputs[0].values()[..], column(&draws, 0, 19_990..20_000));
        assert!(source.next(1).expect("never fails").is_none());
    }

    /// Guards the numbers themselves: a folder that was begun by one build is gone on with by another.
    #[test]
    fn the_numbers_are_those_of_before() {
        let draws = draws(&["axial_load_N=uniform:1:2", "friction_coefficient=normal:0.5:0.25"]);
        let found = [column(&draws, 0, 7..9), column(&draws, 1, 7..9)].concat();
        let expected =
            "[1.596729512357534, 1.0897310778964324, 0.389121999909511, 0.6329336788937058]";
        assert_eq!(format!("{found:?}"), expected);
    }

    /// Mean and deviation of 20 000 draws within five standard errors: 5 σ/√N, and of the deviation 5 σ/√(2N) if
    /// normal, less if uniform; two inputs are not correlated, 5/√N.
    #[test]
    fn draws_have_the_laws_that_are_asked_for() {
        let draws = draws(&["axial_load_N=uniform:3:5", "friction_coefficient=normal:0.1:0.01"]);
        let columns = [column(&draws, 0, 0..20_000), column(&draws, 1, 0..20_000)];
        let mean = |values: &[f64]| values.iter().sum::<f64>() / 2e4;
        let standard = |values: &[f64]| {
            let middle = mean(values);
            let squares: Vec<_> = values.iter().map(|x| (x - middle).powi(2)).collect();
            let deviation = mean(&squares).sqrt();
            let scaled: Vec<_> = values.iter().map(|x| (x - middle) / deviation).collect();
            (middle, deviation, scaled)
        };
        let (uniform, spread, a) = standard(&columns[0]);
        let (normal, deviation, b) = standard(&columns[1]);
        assert!(columns[0].iter().all(|x| (3.0..5.0).contains(x)));
        assert!((uniform - 4.0).abs() < 0.02, "{uniform}");
        // Of width 2: 2/√12.
        assert!((spread - 0.577_35).abs() < 0.015, "{spread}");
        assert!((normal - 0.1).abs() < 3.6e-4 && (deviation - 0.01).abs() < 2.5e-4, "{normal}");
        let product: Vec<_> = a.iter().zip(&b).map(|(a, b)| a * b).collect();
        assert!(mean(&product).abs() < 0.036);
        // 68.3 % of a normal law lie within one deviation: 5 √(0.683·0.317/N).
        let within = b.iter().filter(|x| x.abs() < 1.0).map(|_| 1.0).sum::<f64>() / 2e4;
        assert!((within - 0.6827).abs() < 0.017, "{within}");
    }

    #[test]
    fn a_draw_is_read_as_it_is_written() {
        for text in ["axial_load_N=uniform:2000:8000", "lead_mm=normal:20:0.01"] {
            assert_eq!(Draw::parse(text).expect("a draw").to_string(), text);
        }
        let kilo = Draw::parse("axial_load_kN = uniform : 2 : 8").expect("a draw");
        assert_eq!(kilo.to_string(), "axial_load_N=uniform:2000:8000");
        for (text, part) in [
            ("lead_mm", "name=uniform:low:high"),
            ("lead_mm=uniform:2", "name=uniform:low:high"),
            ("lead_mm=uniform:3:2", "name=uniform:low:high"),
            ("lead_mm=normal:3:0", "name=uniform:low:high"),
            ("lead_mm=normal:nan:1", "name=uniform:low:high"),
            ("lead_mm=cauchy:3:1", "name=uniform:low:high"),
            ("ball_diameter_mm=uniform:-1:1", "ball_diameter_mm"),
            ("leed_mm=uniform:1:2", "lead_mm"),
        ] {
            let said = Draw::parse(text).expect_err(text).to_string();
            assert!(said.contains(part), "{text}: {said}");
        }
        let twice = ["lead_mm=uniform:1:2", "lead_mm=normal:1:2"];
        let twice = twice.map(|text| Draw::parse(text).expect("a draw")).to_vec();
        assert!(Draws::new(1, 1, twice).is_err());
    }
}
