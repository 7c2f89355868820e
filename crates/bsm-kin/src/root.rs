//! Cube root of a single number.

/// Returns the cube root with an error of at most one unit in the last place.
///
/// The standard library's cube root is correctly rounded, but takes five times as long.
///
/// Source: function `cbrt` of FreeBSD's C library, after Kahan and Bergman.
#[inline]
pub(crate) fn cube_root(x: f64) -> f64 {
    /// Coefficients of a polynomial that approximates the reciprocal cube root near 1 to within
    /// 2^{-23.5}.
    const P: [f64; 5] = [
        1.875_951_824_271_77,
        -1.884_979_795_433_771_7,
        1.621_429_720_105_354_5,
        -0.758_397_934_778_766,
        0.145_996_192_886_612_45,
    ];
    if !x.is_normal() {
        return x.cbrt();
    }
    // Dividing the bits of exponent and mantissa by three gives an initial guess with an accuracy
    // of five bits.
    let high = ((x.to_bits() >> 32) & 0x7fff_ffff) / 3 + 715_094_163;
    let guess = f64::from_bits(high << 32).copysign(x);
    let r = guess * guess * (guess / x);
    let better = guess * ((P[0] + r * (P[1] + r * P[2])) + (r * r * r) * (P[3] + r * P[4]));
    // The improved guess is rounded to 23 bits so that its square is exact.
    let t = f64::from_bits((better.to_bits() + 0x8000_0000) & 0xffff_ffff_c000_0000);
    let r = x / (t * t);
    t + t * ((r - t) / (t + t + r))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn cube_roots_match_the_standard_library(log in -700.0..700.0_f64, sign in proptest::bool::ANY) {
            let x = if sign { log.exp() } else { -log.exp() };
            let unit = x.cbrt().abs().next_up() - x.cbrt().abs();
            prop_assert!((cube_root(x) - x.cbrt()).abs() <= unit, "{x}");
        }
    }

    #[test]
    fn subnormal_and_special_numbers_match_the_standard_library() {
        for x in [0.0, -0.0, 5e-324, -1e-310, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(cube_root(x).to_bits(), x.cbrt().to_bits(), "{x}");
        }
        assert!(cube_root(f64::NAN).is_nan());
    }
}
