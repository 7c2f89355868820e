//! Zeros of a quadratic form on the unit circle.

use std::array;
use std::f64::consts::FRAC_1_SQRT_2;

use bsm_newton::Bracket;

/// Eight directions around the circle.
const DIRECTIONS: [[f64; 2]; 8] = [
    [1.0, 0.0],
    [FRAC_1_SQRT_2, FRAC_1_SQRT_2],
    [0.0, 1.0],
    [-FRAC_1_SQRT_2, FRAC_1_SQRT_2],
    [-1.0, 0.0],
    [-FRAC_1_SQRT_2, -FRAC_1_SQRT_2],
    [0.0, -1.0],
    [FRAC_1_SQRT_2, -FRAC_1_SQRT_2],
];

/// `$a_0 + a_1 c + a_2 s$` of a direction `(c, s)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Line(pub(super) [f64; 3]);

/// `$a_0 + a_1 c + a_2 s + a_3 c^2 + a_4 c s + a_5 s^2$` of a direction `(c, s)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Quadratic(pub(super) [f64; 6]);

impl Line {
    pub(super) fn at(&self, [c, s]: [f64; 2]) -> f64 {
        self.0[0] + self.0[1] * c + self.0[2] * s
    }

    /// `self` times `x` plus `other` times `y`.
    pub(super) fn combined(&self, x: f64, other: &Self, y: f64) -> Self {
        Self(array::from_fn(|i| self.0[i] * x + other.0[i] * y))
    }

    pub(super) fn times(&self, other: &Self) -> Quadratic {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Quadratic([a * x, a * y + b * x, a * z + c * x, b * y, b * z + c * y, c * z])
    }
}

impl Quadratic {
    pub(super) fn at(&self, [c, s]: [f64; 2]) -> f64 {
        let a = &self.0;
        a[0] + c * (a[1] + a[3] * c + a[4] * s) + s * (a[2] + a[5] * s)
    }

    /// `self` times `x` plus `other` times `y`.
    pub(super) fn combined(&self, x: f64, other: &Self, y: f64) -> Self {
        Self(array::from_fn(|i| self.0[i] * x + other.0[i] * y))
    }

    pub(super) fn scaled(&self, x: f64) -> Self {
        Self(self.0.map(|a| a * x))
    }

    /// The same values as a form of directions that are turned by the angle of `[cos, sin]`.
    fn turned(&self, [cos, sin]: [f64; 2]) -> Self {
        // c = cosφ c' − sinφ s',  s = sinφ c' + cosφ s'
        let a = &self.0;
        Self([
            a[0],
            a[1] * cos + a[2] * sin,
            a[2] * cos - a[1] * sin,
            a[3] * cos * cos + a[4] * cos * sin + a[5] * sin * sin,
            2.0 * (a[5] - a[3]) * cos * sin + a[4] * (cos * cos - sin * sin),
            a[3] * sin * sin - a[4] * cos * sin + a[5] * cos * cos,
        ])
    }

    /// The directions on which the form vanishes, at most four; `NaN` for those that are missing.
    pub(super) fn zeros(&self) -> [[f64; 2]; 4] {
        // t = tan(φ/2) sends the direction of largest value to infinity: all zeros are finite.
        let (mut turn, mut most) = (DIRECTIONS[0], -1.0);
        for direction in DIRECTIONS {
            let value = self.at([-direction[0], -direction[1]]).abs();
            if value > most {
                (turn, most) = (direction, value);
            }
        }
        let a = self.turned(turn).0;
        let quartic = [
            a[0] + a[1] + a[3],
            2.0 * (a[2] + a[4]),
            2.0 * (a[0] - a[3]) + 4.0 * a[5],
            2.0 * (a[2] - a[4]),
            a[0] - a[1] + a[3],
        ];
        real_roots(&quartic).map(|t| {
            let unit = (1.0 + t * t).recip();
            let (c, s) = ((1.0 - t * t) * unit, 2.0 * t * unit);
            [turn[0] * c - turn[1] * s, turn[1] * c + turn[0] * s]
        })
    }
}

/// Real roots of a quartic with its coefficients from the constant upwards, in ascending order;
/// `NaN` for those that are missing.
fn real_roots(a: &[f64; 5]) -> [f64; 4] {
    let slope = [a[1], 2.0 * a[2], 3.0 * a[3], 4.0 * a[4]];
    let bend = [a[2], 3.0 * a[3], 6.0 * a[4]];
    // All roots of a polynomial and of its derivatives are within Cauchy's bound.
    let bound = 1.0 + a[..4].iter().fold(0.0_f64, |most, x| most.max((x / a[4]).abs()));
    // Between the places where its derivative vanishes a polynomial has at most one root.
    let root = (bend[1] * bend[1] - 4.0 * bend[0] * bend[2]).sqrt();
    let q = -0.5 * (bend[1] + root.copysign(bend[1]));
    let (one, two) = (q / bend[2], bend[0] / q);
    let turns = if root.is_nan() { [f64::NAN; 2] } else { [one.min(two), one.max(two)] };
    let flat: [f64; 3] = isolated(&slope, &turns, bound);
    isolated(a, &flat, bound)
}

/// The `N` roots of a polynomial of degree `N` between the places `flat` where its slope vanishes.
fn isolated<const N: usize>(a: &[f64], flat: &[f64], bound: f64) -> [f64; N] {
    let mut roots = [f64::NAN; N];
    let (mut low, mut at_low, mut found) = (-bound, horner(a, -bound).0, 0);
    for high in flat.iter().copied().filter(|t| t.abs() < bound).chain([bound]) {
        let at_high = horner(a, high).0;
        if found < N && (at_low > 0.0) != (at_high > 0.0) {
            let start = Some(0.5 * (low + high));
            let bracket =
                Bracket { start, x_tol: 1e-15, ..Bracket::new([low, high], [at_low, at_high]) };
            roots[found] = bracket.root(|t| horner(a, t)).root().map_or(f64::NAN, |root| root.x);
            found += 1;
        }
        (low, at_low) = (high, at_high);
    }
    roots
}

/// A polynomial, its coefficients from the constant upwards, and its slope.
fn horner(a: &[f64], t: f64) -> (f64, f64) {
    a.iter().rev().fold((0.0, 0.0), |(value, slope), x| (value * t + x, slope * t + value))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// As many zeros as sign changes on a fine grid, each a zero.
        #[test]
        fn all_zeros_are_found(a in proptest::array::uniform6(-1.0..1.0_f64)) {
            let form = Quadratic(a);
            let count = u32::try_from(form.zeros().iter().filter(|z| !z[0].is_nan()).count())?;
            for z in form.zeros().into_iter().filter(|z| !z[0].is_nan()) {
                // Rounding, magnified where the polynomial is steep.
                prop_assert!(form.at(z).abs() <= 1e-12, "{z:?}");
            }
            let value = |i: u32| {
                let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 1e4).sin_cos();
                form.at([cos, sin])
            };
            let changes = (0..10_000).filter(|i| value(*i) * value(*i + 1) < 0.0).count();
            // A pair of zeros may hide between two places of the grid.
            prop_assert!(count as usize >= changes && (count - u32::try_from(changes)?) % 2 == 0);
        }
    }
}
