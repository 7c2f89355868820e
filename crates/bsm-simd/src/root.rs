//! Roots of positive numbers, calculated without the square root and division instructions of the
//! processor.
//!
//! No library provides the cube root for vectors whose width is selected at run time. The
//! reciprocal square root and fourth root take one third of the time that square root and division
//! instructions take.

use pulp::Simd;

use crate::Lane;

/// Estimates `$x^{-1/2}$` by halving the exponent. The error is at most 4 %.
#[inline(always)]
fn inverse_root_guess(x: f64) -> f64 {
    f64::from_bits(0x5fe6_e872_b020_c800_u64.wrapping_sub(x.to_bits() >> 1))
}

/// Estimates `$x^{-1/3}$` by dividing the exponent by three. The error is at most 4 %.
#[inline(always)]
fn inverse_cube_root_guess(x: f64) -> f64 {
    f64::from_bits(0x553f_0000_0000_0000_u64.wrapping_sub(x.to_bits() / 3))
}

/// Estimates `$x^{-1/4}$` by dividing the exponent by four. The error is at most 4 %.
#[inline(always)]
fn inverse_fourth_root_guess(x: f64) -> f64 {
    f64::from_bits(0x4feb_028f_5c28_f800_u64.wrapping_sub(x.to_bits() >> 2))
}

impl<S: Simd, const N: usize> Lane<S, N> {
    /// Returns the reciprocal square root with an error of at most three units in the last place.
    /// The numbers must be positive and normal; for other numbers, the result is meaningless.
    #[inline(always)]
    #[must_use]
    pub fn recip_sqrt(self) -> Self {
        self.inverse_root_from(self.rough_recip_sqrt())
    }

    /// Returns the reciprocal square root with a relative error of at most 1e-5. The numbers must
    /// be positive and normal; for other numbers, the result is meaningless.
    #[inline(always)]
    #[must_use]
    pub fn rough_recip_sqrt(self) -> Self {
        self.inverse_root_from(self.each(inverse_root_guess))
    }

    /// Refines an approximation `r` of `$x^{-1/2}$` once.
    #[inline(always)]
    fn inverse_root_from(self, r: Self) -> Self {
        let e = (self * r).neg_mul_add(r, self.constant(1.0));
        r.refined(e, [1.0 / 2.0, 3.0 / 8.0, 5.0 / 16.0])
    }

    /// Returns the reciprocal fourth root with an error of at most three units in the last place.
    /// The numbers must be positive and normal; for other numbers, the result is meaningless.
    #[inline(always)]
    #[must_use]
    pub fn recip_fourth_root(self) -> Self {
        let mut r = self.each(inverse_fourth_root_guess);
        for _ in 0..2 {
            let square = r * r;
            let e = (self * square).neg_mul_add(square, self.constant(1.0));
            r = r.refined(e, [1.0 / 4.0, 5.0 / 32.0, 15.0 / 128.0]);
        }
        r
    }

    /// Returns the cube root with an error of at most three units in the last place. The numbers
    /// must be positive and normal; for other numbers, the result is meaningless.
    #[inline(always)]
    #[must_use]
    pub fn cbrt_positive(self) -> Self {
        let mut r = self.each(inverse_cube_root_guess);
        for _ in 0..2 {
            let e = self.constant(1.0) - self * (r * r * r);
            r = r.refined(e, [1.0 / 3.0, 2.0 / 9.0, 14.0 / 81.0]);
        }
        self * (r * r)
    }

    /// Returns `$r (1 - e)^{-1/n}$`, calculated from the first terms of its power series. The first
    /// step reduces the relative error from 4e-2 to 4e-5, and the second step reduces it to
    /// rounding errors.
    #[inline(always)]
    fn refined(self, e: Self, [first, second, third]: [f64; 3]) -> Self {
        let series = e.mul_add(self.constant(third), self.constant(second));
        let series = series.mul_add(e, self.constant(first));
        (self * e).mul_add(series, self)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use pulp::Arch;

    use crate::tests::by_lanes;

    by_lanes!(CubeRoot { x } -> 1: [x.cbrt_positive()]);
    by_lanes!(InverseRoots { x } -> 2: [x.recip_sqrt(), x.rough_recip_sqrt()]);

    proptest! {
        /// The results differ from those of the standard library by at most three units in the last
        /// place, plus one unit for each of the two rounding errors of the standard library.
        #[test]
        fn inverse_roots_have_the_stated_accuracy(
            logs in proptest::array::uniform8(-100.0..100.0_f64),
        ) {
            let x = logs.map(f64::exp);
            let [fine, rough] = Arch::new().dispatch(InverseRoots { x });
            for (i, x) in x.into_iter().enumerate() {
                let root = x.sqrt().recip();
                prop_assert!((fine[i] / root - 1.0).abs() <= 5.0 * f64::EPSILON, "{x}");
                prop_assert!((rough[i] / root - 1.0).abs() <= 1e-5, "{x}");
            }
        }

        /// The results differ by at most four units in the last place from those of the standard
        /// library, whose error is at most one unit.
        #[test]
        fn cube_roots_match_the_standard_library(
            logs in proptest::array::uniform8(-100.0..100.0_f64),
        ) {
            let x = logs.map(f64::exp);
            let [roots] = Arch::new().dispatch(CubeRoot { x });
            for (root, x) in roots.into_iter().zip(x) {
                let unit = x.cbrt().next_up() - x.cbrt();
                prop_assert!((root - x.cbrt()).abs() <= 4.0 * unit, "{x}");
            }
        }
    }

    /// The results are bit-identical on every instruction set.
    #[test]
    fn cube_roots_are_bit_identical_on_every_instruction_set() {
        let x = [1e-300, 0.017, 0.9, 1.0, 1.1, 3.0, 8.0, 1e300];
        let bits = |arch: Arch| arch.dispatch(CubeRoot { x })[0].map(f64::to_bits);
        for arch in crate::instruction_sets() {
            assert_eq!(bits(arch), bits(Arch::Scalar), "{arch:?}");
        }
    }

    /// Invalid numbers at some positions of a SIMD vector do not affect the results at other
    /// positions.
    #[test]
    fn invalid_number_in_one_simd_lane_does_not_affect_other_lanes() {
        let x = [-1.0, f64::NAN, f64::INFINITY, 0.0, -0.0, f64::MIN, -f64::NAN, 8.0];
        let [roots] = Arch::new().dispatch(CubeRoot { x });
        assert!((roots[7] - 2.0).abs() <= 1e-15, "{roots:?}");
    }
}
