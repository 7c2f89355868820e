//! Exponential function, natural logarithm and inverse hyperbolic sine for SIMD vectors.
//!
//! No library provides these functions for vectors whose width is selected at run time.

use std::f64::consts::{LN_2, LOG2_E, SQRT_2};

use pulp::Simd;

use crate::Lane;
use crate::polynomial::polynomial;

/// The number `$2^{52}$`, for which the unit in the last place is 1.
const TWO_TO_52: f64 = 4_503_599_627_370_496.0;

/// Constant that rounds a number to an integer when it is added to the number. The low bits of the
/// sum then contain this integer.
const ROUNDING_CONSTANT: f64 = 1.5 * TWO_TO_52;

/// High part of `$\ln 2$`, rounded to 33 bits so that multiples by small integers are exact.
/// `LN_2_LOW` is the remainder.
const LN_2_HIGH: f64 = 0.693_147_180_369_123_8;
const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;

/// Returns two raised to the integer in the low bits of `sum`.
#[inline(always)]
fn power_of_two(sum: f64) -> f64 {
    f64::from_bits(sum.to_bits().wrapping_add(1023) << 52)
}

/// Returns the binary exponent of a normal number.
#[inline(always)]
fn exponent(x: f64) -> f64 {
    // The exponent bits replace the low bits of 2⁵², and 2⁵² is then subtracted.
    f64::from_bits(x.to_bits() >> 52 | 0x4330_0000_0000_0000) - (TWO_TO_52 + 1023.0)
}

/// Returns the mantissa of a number, which is in [1, 2). It is the number divided by two raised to
/// the exponent of the number.
#[inline(always)]
fn mantissa(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & 0x000f_ffff_ffff_ffff | 0x3ff0_0000_0000_0000)
}

impl<S: Simd, const N: usize> Lane<S, N> {
    /// Returns `e` raised to the power of each number, with an error of at most two units in the
    /// last place. The numbers must be between -700 and 700; for other numbers, the result is
    /// meaningless.
    #[inline(always)]
    #[must_use]
    pub fn exp(self) -> Self {
        let sum = self.mul_add(self.constant(LOG2_E), self.constant(ROUNDING_CONSTANT));
        let whole = sum - ROUNDING_CONSTANT;
        let high = whole.neg_mul_add(self.constant(LN_2_HIGH), self);
        let x = whole.neg_mul_add(self.constant(LN_2_LOW), high);
        // The Taylor series is used for |x| ≤ ln 2/2. The first omitted term is then at most
        // 0.35¹⁴/14! = 4e-18.
        polynomial(&INVERSE_FACTORIALS, x) * sum.each(power_of_two)
    }

    /// Returns the natural logarithm. The error is at most 2e-16 times the larger of 1 and the
    /// absolute result. The numbers must be positive and normal; for other numbers, the result is
    /// meaningless.
    #[inline(always)]
    #[must_use]
    pub fn ln(self) -> Self {
        let (exponent, mantissa) = (self.each(exponent), self.each(mantissa));
        let upper = mantissa.gt(self.constant(SQRT_2));
        let x = upper.select(mantissa * 0.5, mantissa);
        let exponent = upper.select(exponent + 1.0, exponent);
        // The series ln x = 2 artanh s with s = (x − 1)/(x + 1) and |s| ≤ 0.172 is truncated. The
        // first omitted term is s²⁴/25 ≤ 2e-20, relative to the first term.
        let s = (x - 1.0) / (x + 1.0);
        let series = polynomial(&INVERSE_ODDS, s * s);
        exponent.mul_add(self.constant(LN_2), s * 2.0 * series)
    }

    /// Returns the inverse hyperbolic sine of numbers with absolute values up to 1e150. The error
    /// is at most 1e-15 times the larger of 1 and the absolute result.
    #[inline(always)]
    #[must_use]
    pub fn arsinh(self) -> Self {
        let size = self.abs();
        let result = (size + size.mul_add(size, self.constant(1.0)).sqrt()).ln();
        self.lt(self.constant(0.0)).select(-result, result)
    }
}

/// Reciprocals of the factorials 0! to 13!.
const INVERSE_FACTORIALS: [f64; 14] = [
    1.0,
    1.0,
    0.5,
    0.166_666_666_666_666_66,
    4.166_666_666_666_666_4e-2,
    8.333_333_333_333_333e-3,
    1.388_888_888_888_889e-3,
    1.984_126_984_126_984e-4,
    2.480_158_730_158_73e-5,
    2.755_731_922_398_589_3e-6,
    2.755_731_922_398_589e-7,
    2.505_210_838_544_171_7e-8,
    2.087_675_698_786_81e-9,
    1.605_904_383_682_161_5e-10,
];

/// Reciprocals of the odd numbers 1 to 23.
const INVERSE_ODDS: [f64; 12] = [
    1.0,
    1.0 / 3.0,
    1.0 / 5.0,
    1.0 / 7.0,
    1.0 / 9.0,
    1.0 / 11.0,
    1.0 / 13.0,
    1.0 / 15.0,
    1.0 / 17.0,
    1.0 / 19.0,
    1.0 / 21.0,
    1.0 / 23.0,
];

#[cfg(test)]
mod tests {
    use std::f64::consts::SQRT_2;

    use proptest::prelude::*;
    use pulp::Arch;

    use crate::tests::by_lanes;

    by_lanes!(Both { x, positive } -> 3: [x.exp(), positive.ln(), x.arsinh()]);

    proptest! {
        /// The results match the standard library, whose relative error is at most 1.1e-16.
        #[test]
        fn exponentials_and_logarithms_match_the_standard_library(
            x in proptest::array::uniform8(-700.0..700.0_f64),
            small in proptest::array::uniform8(-2.0..2.0_f64),
        ) {
            for x in [x, small] {
                let positive = x.map(f64::exp);
                let [exp, ln, arsinh] = Arch::new().dispatch(Both { x, positive });
                for (i, x) in x.into_iter().enumerate() {
                    prop_assert!((exp[i] / x.exp() - 1.0).abs() <= 4.5e-16, "exp {x}");
                    let log = positive[i].ln();
                    prop_assert!((ln[i] - log).abs() <= 4.5e-16 * log.abs().max(1.0), "ln {x}");
                    let error = (arsinh[i] - x.asinh()).abs();
                    prop_assert!(error <= 1e-15 * x.asinh().abs().max(1.0), "arsinh {x}");
                }
            }
        }
    }

    /// The results are bit-identical on every instruction set.
    #[test]
    fn exponentials_are_bit_identical_on_every_instruction_set() {
        let x = [-600.0, -1.0, -1e-9, 0.0, 1e-3, 0.9, 33.0, 650.0];
        let positive = [1e-300, 1e-3, 0.5, 1.0, SQRT_2 - 1e-5, SQRT_2 + 1e-5, 33.0, 1e300];
        let bits = |arch: Arch| arch.dispatch(Both { x, positive }).map(|b| b.map(f64::to_bits));
        for arch in crate::instruction_sets() {
            assert_eq!(bits(arch), bits(Arch::Scalar), "{arch:?}");
        }
    }
}
