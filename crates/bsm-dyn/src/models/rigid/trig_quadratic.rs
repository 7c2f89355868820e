//! Zeros of a quadratic form on the unit circle, for one form and for several side by side.

#![expect(clippy::needless_range_loop, reason = "closures do not take the instruction set")]

use std::f64::consts::FRAC_1_SQRT_2;

use bsm_kin::Field;
use bsm_simd::Compare;

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

/// Last step of a root: the error behind it is of the order of its cube, of two equal roots of its own.
const LAST_STEP: f64 = 1e-7;
const MOST_HALLEY_STEPS: usize = 80;

/// `$a_0 + a_1 c + a_2 s$` of a direction `(c, s)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LinearForm<F>(pub(super) [F; 3]);

/// `$a_0 + a_1 c + a_2 s + a_3 c^2 + a_4 c s + a_5 s^2$` of a direction `(c, s)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Quadratic<F>(pub(super) [F; 6]);

impl<F: Field> LinearForm<F> {
    #[inline(always)]
    pub(super) fn at(&self, [c, s]: [F; 2]) -> F {
        self.0[0] + self.0[1] * c + self.0[2] * s
    }

    /// `self` times `x` plus `other` times `y`.
    #[inline(always)]
    pub(super) fn combined(&self, x: F, other: &Self, y: F) -> Self {
        let mut sum = *self;
        for i in 0..3 {
            sum.0[i] = self.0[i] * x + other.0[i] * y;
        }
        sum
    }

    /// One line where the mask is true, another elsewhere.
    #[inline(always)]
    pub(super) fn select(mask: F::Mask, yes: &Self, no: &Self) -> Self {
        let mut line = *yes;
        for i in 0..3 {
            line.0[i] = F::select(mask, yes.0[i], no.0[i]);
        }
        line
    }

    #[inline(always)]
    pub(super) fn times(&self, other: &Self) -> Quadratic<F> {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Quadratic([a * x, a * y + b * x, a * z + c * x, b * y, b * z + c * y, c * z])
    }
}

impl<F: Field> Quadratic<F> {
    #[inline(always)]
    pub(super) fn at(&self, [c, s]: [F; 2]) -> F {
        let a = &self.0;
        a[0] + c * (a[1] + a[3] * c + a[4] * s) + s * (a[2] + a[5] * s)
    }

    /// `self` times `x` plus `other` times `y`.
    #[inline(always)]
    pub(super) fn combined(&self, x: F, other: &Self, y: F) -> Self {
        let mut sum = *self;
        for i in 0..6 {
            sum.0[i] = self.0[i] * x + other.0[i] * y;
        }
        sum
    }

    #[inline(always)]
    pub(super) fn scaled(&self, x: F) -> Self {
        let mut scaled = *self;
        for i in 0..6 {
            scaled.0[i] = self.0[i] * x;
        }
        scaled
    }

    /// The same values as a form of directions that are turned by the angle of `[cos, sin]`.
    #[inline(always)]
    fn turned(&self, [cos, sin]: [F; 2]) -> Self {
        // c = cosφ c' − sinφ s',  s = sinφ c' + cosφ s'
        let a = &self.0;
        Self([
            a[0],
            a[1] * cos + a[2] * sin,
            a[2] * cos - a[1] * sin,
            a[3] * cos * cos + a[4] * cos * sin + a[5] * sin * sin,
            (a[5] - a[3]) * cos * sin * 2.0 + a[4] * (cos * cos - sin * sin),
            a[3] * sin * sin - a[4] * cos * sin + a[5] * cos * cos,
        ])
    }
}

impl<F: Compare> Quadratic<F> {
    /// The directions on which the form vanishes, at most four; `NaN` for those that are missing.
    #[inline(always)]
    pub(super) fn zeros(&self) -> [[F; 2]; 4] {
        // t = tan(φ/2) sends the direction of largest value to infinity: all zeros are finite.
        let one = self.0[0].constant(1.0);
        let mut rotation = [one, one * 0.0];
        let mut most = -one;
        for [c, s] in DIRECTIONS {
            let (c, s) = (one.constant(c), one.constant(s));
            let value = self.at([-c, -s]).abs();
            let more = value.gt(most);
            rotation = [F::select(more, c, rotation[0]), F::select(more, s, rotation[1])];
            most = F::select(more, value, most);
        }
        let a = self.turned(rotation).0;
        let quartic = [
            a[0] + a[1] + a[3],
            (a[2] + a[4]) * 2.0,
            (a[0] - a[3]) * 2.0 + a[5] * 4.0,
            (a[2] - a[4]) * 2.0,
            a[0] - a[1] + a[3],
        ];
        let mut zeros = [rotation; 4];
        let roots = real_roots(&quartic);
        for i in 0..4 {
            let t = roots[i];
            let unit = (t * t + 1.0).recip();
            let (c, s) = ((one - t * t) * unit, t * 2.0 * unit);
            zeros[i] = [rotation[0] * c - rotation[1] * s, rotation[1] * c + rotation[0] * s];
        }
        zeros
    }
}

/// Real roots of a quartic with its coefficients from the constant upwards, in ascending order;
/// `NaN` for those that are missing.
#[inline(always)]
fn real_roots<F: Compare>(a: &[F; 5]) -> [F; 4] {
    let slope = [a[1], a[2] * 2.0, a[3] * 3.0, a[4] * 4.0];
    let bend = [a[2], a[3] * 3.0, a[4] * 6.0];
    // All roots of a polynomial and of its derivatives are within Cauchy's bound.
    let mut bound = a[4] * 0.0;
    for i in 0..4 {
        bound = bound.larger((a[i] / a[4]).abs());
    }
    let bound = bound + 1.0;
    // Between the places where its derivative vanishes a polynomial has at most one root.
    let (zero, root) = (bound * 0.0, (bend[1] * bend[1] - bend[0] * bend[2] * 4.0).sqrt());
    let root = F::select(bend[1].lt(zero), -root, root);
    let q = (bend[1] + root) * -0.5;
    let (one, two) = (q / bend[2], bend[0] / q);
    let turns = [F::select(two.lt(one), two, one), F::select(two.lt(one), one, two)];
    let flat: [F; 3] = isolated(&slope, &turns, bound);
    isolated(a, &flat, bound)
}

/// The `N` roots of a polynomial of degree `N` between the places `flat` where its slope vanishes; `NaN` for
/// those that are missing.
#[inline(always)]
fn isolated<F: Compare, const A: usize, const B: usize, const N: usize>(
    a: &[F; A],
    flat: &[F; B],
    bound: F,
) -> [F; N] {
    let (mut low, mut high, mut end) = ([bound; N], [bound; N], -bound);
    for i in 0..N {
        low[i] = end;
        if i < B {
            // Where a place is missing, or beyond the bound, the interval before it goes on.
            let here = flat[i].abs().lt(bound) & end.le(flat[i]);
            high[i] = F::select(here, flat[i], end);
        }
        end = high[i];
    }
    between(a, low, high)
}

/// The roots of a polynomial between places where it has other signs, by Halley's steps within them; `NaN` where
/// the signs are the same. Steps of all roots are taken side by side, as each waits for its division.
#[inline(always)]
fn between<F: Compare, const A: usize, const N: usize>(
    a: &[F; A],
    mut low: [F; N],
    mut high: [F; N],
) -> [F; N] {
    let zero = a[0].constant(0.0);
    let no = zero.lt(zero);
    let (mut t, mut crosses, mut above, mut converged) = (low, [no; N], [no; N], [no; N]);
    for i in 0..N {
        let below = horner(a, low[i])[0].gt(zero);
        above[i] = horner(a, high[i])[0].gt(zero);
        crosses[i] = (below & !above[i]) | (above[i] & !below);
        converged[i] = !crosses[i];
        t[i] = (low[i] + high[i]) * 0.5;
    }
    for _ in 0..MOST_HALLEY_STEPS {
        let mut moving = no;
        for i in 0..N {
            moving = moving | !converged[i];
        }
        if !F::any(moving) {
            break;
        }
        for i in 0..N {
            let [value, slope, bend] = horner(a, t[i]);
            let positive = value.gt(zero);
            let is_high = (positive & above[i]) | (!positive & !above[i]);
            low[i] = F::select(is_high, low[i], t[i]);
            high[i] = F::select(is_high, t[i], high[i]);
            let halley = t[i] - value * slope / (slope * slope - value * bend);
            let inside = low[i].le(halley) & halley.le(high[i]);
            let next = F::select(inside, halley, (low[i] + high[i]) * 0.5);
            let step = (next - t[i]).abs();
            t[i] = F::select(converged[i], t[i], next);
            converged[i] = converged[i] | step.le((t[i].abs() + 1.0) * LAST_STEP);
        }
    }
    for i in 0..N {
        t[i] = F::select(crosses[i], t[i], zero.constant(f64::NAN));
    }
    t
}

/// A polynomial, its coefficients from the constant upwards, its slope, and half its second derivative.
#[inline(always)]
fn horner<F: Compare, const A: usize>(a: &[F; A], t: F) -> [F; 3] {
    let (mut value, mut slope, mut bend) = (a[A - 1], t.constant(0.0), t.constant(0.0));
    for i in 1..A {
        bend = bend.mul_add(t, slope);
        slope = slope.mul_add(t, value);
        value = value.mul_add(t, a[A - 1 - i]);
    }
    [value, slope, bend]
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
