//! What numbers add up to, in a form that can be added up further: counts, ends, sums with their rest, bins, and
//! the outermost rows.

use std::collections::BTreeMap;

/// Bits of the fraction of a double.
const FRACTION: u32 = 52;

/// Number of the bin of a value, growing with it; `bits` of the fraction tell bins apart.
pub(super) fn bin(value: f64, bits: u32) -> i64 {
    let place = (value.abs().to_bits() >> (FRACTION - bits)).cast_signed();
    if value < 0.0 { -1 - place } else { place }
}

/// The ends of a bin, the one nearer to zero being in it.
pub(super) fn edges(bin: i64, bits: u32) -> (f64, f64) {
    let edge = |place: i64| f64::from_bits(place.cast_unsigned() << (FRACTION - bits));
    if bin < 0 { (-edge(-bin), -edge(-1 - bin)) } else { (edge(bin), edge(bin + 1)) }
}

/// The bin that has these ends.
pub(super) fn bin_of((low, high): (f64, f64), bits: u32) -> i64 {
    if low < 0.0 { -1 - bin(-high, bits) } else { bin(low, bits) }
}

/// A sum and what rounding took from it, after Neumaier.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(super) struct Sum {
    pub(super) sum: f64,
    pub(super) rest: f64,
}

impl Sum {
    pub(super) fn add(&mut self, value: f64) {
        let sum = self.sum + value;
        self.rest += if self.sum.abs() >= value.abs() {
            (self.sum - sum) + value
        } else {
            (value - sum) + self.sum
        };
        self.sum = sum;
    }

    pub(super) fn merge(&mut self, other: Self) {
        self.add(other.sum);
        self.add(other.rest);
    }
}

/// A row at one end of the values.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Outer {
    pub(super) value: f64,
    pub(super) row: u64,
    pub(super) inputs: Vec<f64>,
}

/// The outermost rows at both ends.
#[derive(Debug, Default, Clone, PartialEq)]
pub(super) struct Ends {
    /// Values that grow, and values that fall; of equal ones the first row stands first.
    pub(super) lowest: Vec<Outer>,
    pub(super) highest: Vec<Outer>,
}

impl Ends {
    /// Takes a row in at the ends where it is among the first `most`.
    pub(super) fn push(
        &mut self,
        most: usize,
        value: f64,
        row: u64,
        inputs: impl Fn() -> Vec<f64>,
    ) {
        type Before = fn(f64, f64) -> bool;
        let ends: [(&mut Vec<Outer>, Before); 2] =
            [(&mut self.lowest, |a, b| a <= b), (&mut self.highest, |a, b| a >= b)];
        for (list, before) in ends {
            let place = list.partition_point(|other| before(other.value, value));
            if place < most {
                list.truncate(most - 1);
                list.insert(place, Outer { value, row, inputs: inputs() });
            }
        }
    }
}

/// What the values of an output add up to.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tally {
    pub(super) values: u64,
    pub(super) min: f64,
    pub(super) max: f64,
    pub(super) sum: Sum,
    pub(super) bins: BTreeMap<i64, u64>,
    pub(super) ends: Ends,
}

impl Tally {
    pub(super) fn new() -> Self {
        let (min, max) = (f64::INFINITY, f64::NEG_INFINITY);
        let (bins, ends) = (BTreeMap::new(), Ends::default());
        Self { values: 0, min, max, sum: Sum::default(), bins, ends }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bin holds its end nearer to zero, follows the one before, and is found again from its ends.
    #[test]
    fn bins_tile_the_numbers() {
        for bits in [0, 3, 12] {
            for value in [0.0, -0.0, 5e-324, 0.1, 0.886, 1.0, 1.5, 2.0 - 1e-15, 3e300, 1e-310] {
                for value in [value, -value] {
                    let place = bin(value, bits);
                    let (low, high) = edges(place, bits);
                    let inside = if value < 0.0 {
                        low < value && value <= high
                    } else {
                        low <= value && value < high
                    };
                    assert!(inside, "{low} {value} {high}");
                    assert_eq!(bin_of((low, high), bits), place, "{value}");
                    // Zero is the border of the first bins of both signs.
                    assert_eq!(Some(edges(place + 1, bits).0), Some(high), "{value}");
                }
            }
        }
        // Eight bins from 1 to 2.
        assert_eq!(edges(bin(1.3, 3), 3), (1.25, 1.375));
    }

    /// 1 + 1e100 - 1e100 is 1, in one sum and merged from two.
    #[test]
    fn sums_keep_what_rounding_takes() {
        let sum = |values: &[f64]| {
            let mut sum = Sum::default();
            for value in values {
                sum.add(*value);
            }
            sum
        };
        let whole = sum(&[1.0, 1e100, 1.0, -1e100]);
        assert!((whole.sum + whole.rest - 2.0).abs() < f64::EPSILON);
        let mut merged = sum(&[1.0, 1e100]);
        merged.merge(sum(&[1.0, -1e100]));
        assert!((merged.sum + merged.rest - 2.0).abs() < f64::EPSILON, "{merged:?}");
    }
}
