//! Evaluation of polynomials for SIMD vectors.

use pulp::Simd;

use crate::Lane;

/// Evaluates a polynomial. The even and odd powers are summed separately, which halves the length
/// of the dependency chain.
///
/// * `coefficients`: at least two coefficients in the order of increasing powers.
#[inline(always)]
pub fn polynomial<S: Simd, const N: usize, const M: usize>(
    coefficients: &[f64; M],
    x: Lane<S, N>,
) -> Lane<S, N> {
    const { assert!(M >= 2, "a polynomial needs at least two coefficients") };
    let square = x * x;
    let mut sums = [coefficients[M - 1], coefficients[M - 2]].map(|c| x.constant(c));
    for (i, c) in coefficients.iter().rev().enumerate().skip(2) {
        sums[i % 2] = sums[i % 2].mul_add(square, x.constant(*c));
    }
    sums[M % 2].mul_add(x, sums[(M - 1) % 2])
}
