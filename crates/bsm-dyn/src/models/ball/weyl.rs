//! Low-discrepancy points in the unit hypercube.

/// Prime numbers. Their square roots are linearly independent over the rational numbers, so
/// multiples of these roots modulo 1 are equidistributed.
const PRIMES: [f64; 12] = [2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0, 29.0, 31.0, 37.0];

/// Returns point `number` of the Weyl sequence in the unit hypercube with `N` dimensions (at most
/// 12).
pub(crate) fn weyl_point<const N: usize>(number: u32) -> [f64; N] {
    std::array::from_fn(|i| (f64::from(number) * PRIMES[i].sqrt()).fract())
}
