//! Sine and cosine of angles in the first quadrant for SIMD vectors.
//!
//! No library provides these functions for vectors whose width is selected at run time.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use pulp::Simd;

use crate::Lane;
use crate::polynomial::polynomial;

/// Difference between π/2 and the nearest double-precision number.
const FRAC_PI_2_REST: f64 = 6.123_233_995_736_766e-17;

/// Coefficients of a minimax approximation of `$(\sin x - x)/x^3$` in powers of `$x^2$` on `[0,
/// π/4]`, with an error of 1.2e-20.
const SINE: [f64; 7] = [
    -0.166_666_666_666_666_66,
    0.008_333_333_333_333_331,
    -0.000_198_412_698_412_650_65,
    2.755_731_921_933_916_3e-06,
    -2.505_210_623_244_693_3e-08,
    1.605_853_161_888_396_4e-10,
    -7.586_697_111_683_407e-13,
];

/// Coefficients of a minimax approximation of `$(\cos x - 1 + x^2/2)/x^4$` in powers of `$x^2$` on
/// `[0, π/4]`, with an error of 1.3e-18.
const COSINE: [f64; 6] = [
    0.041_666_666_666_666_664,
    -0.001_388_888_888_888_739_8,
    2.480_158_729_876_568_6e-05,
    -2.755_731_727_172_921e-07,
    2.087_614_626_828_136e-09,
    -1.138_263_241_674_366_7e-11,
];

impl<S: Simd, const N: usize> Lane<S, N> {
    /// Returns sine and cosine of angles from 0 to π/2 \[rad\] with an error of at most one unit in
    /// the last place. For angles outside this range, the result is meaningless.
    #[inline(always)]
    #[must_use]
    pub fn sin_cos_first_quadrant(self) -> (Self, Self) {
        let steep = self.gt(self.constant(FRAC_PI_4));
        // The subtraction from π/2 is exact in the upper half of the quadrant.
        let complement = (self.constant(FRAC_PI_2) - self) + FRAC_PI_2_REST;
        let x = steep.select(complement, self);
        let z = x * x;
        let sine = (x * z).mul_add(polynomial(&SINE, z), x);
        let bend = (z * z).neg_mul_add(polynomial(&COSINE, z), z * 0.5);
        let cosine = self.constant(1.0) - bend;
        (steep.select(cosine, sine), steep.select(sine, cosine))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use pulp::Arch;

    use super::*;
    use crate::tests::by_lanes;

    by_lanes!(SinCos { angles } -> 2: <[_; 2]>::from(angles.sin_cos_first_quadrant()));

    fn ulp(x: f64) -> f64 {
        x.next_up() - x
    }

    proptest! {
        /// The results differ by at most 1.5 units in the last place from those of the standard
        /// library, whose error is at most half a unit.
        #[test]
        fn sines_and_cosines_match_the_standard_library(
            angles in proptest::array::uniform8(0.0..=FRAC_PI_2),
            shift in 1e-300..1e-3_f64,
        ) {
            let mut angles = angles;
            (angles[0], angles[1], angles[2]) = (shift, FRAC_PI_2 - shift, FRAC_PI_4 + shift);
            let [sin, cos] = Arch::new().dispatch(SinCos { angles });
            for (i, x) in angles.iter().enumerate() {
                prop_assert!((sin[i] - x.sin()).abs() <= 1.5 * ulp(x.sin()), "sin {x}");
                prop_assert!((cos[i] - x.cos()).abs() <= 1.5 * ulp(x.cos()), "cos {x}");
            }
        }
    }

    /// The results are bit-identical on every instruction set.
    #[test]
    fn sines_are_bit_identical_on_every_instruction_set() {
        let angles = [0.057, 0.247, 0.437, 0.627, 0.817, 1.007, 1.197, 1.387];
        let portable = Arch::Scalar.dispatch(SinCos { angles });
        for arch in crate::instruction_sets() {
            assert_eq!(arch.dispatch(SinCos { angles }), portable, "{arch:?}");
        }
    }
}
