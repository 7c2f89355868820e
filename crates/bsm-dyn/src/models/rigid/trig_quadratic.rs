//! Zeros of a quadratic form on the unit circle, for one form and for several side by side.

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

/// Newton's steps for the factors of a quartic: from 1e-7 to rounding, and one for what rounding leaves of close roots.
const FACTOR_STEPS: usize = 2;

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

/// Real roots of a quartic with its coefficients from the constant upwards; `NaN` for those that are missing.
///
/// Those of two real quadratics whose product it is (Ferrari).
#[inline(always)]
fn real_roots<F: Compare>(a: &[F; 5]) -> [F; 4] {
    let monic = a[4].recip();
    let a = [a[0] * monic, a[1] * monic, a[2] * monic, a[3] * monic];
    let mut factors = real_factors(&a);
    for _ in 0..FACTOR_STEPS {
        factors = nearer(&a, factors);
    }
    let mut roots = [monic; 4];
    for i in 0..2 {
        let [c, b] = factors[i];
        let root = (b * b - c * 4.0).sqrt();
        (roots[2 * i], roots[2 * i + 1]) = ((b + root) * -0.5, (root - b) * 0.5);
    }
    roots
}

/// `$c$` and `$b$` of both factors `$t^2 + b t + c$` of `$t^4 + a_3 t^3 + a_2 t^2 + a_1 t + a_0$`, to 1e-7; those without
/// real roots may be `NaN`.
#[inline(always)]
fn real_factors<F: Compare>(a: &[F; 4]) -> [[F; 2]; 2] {
    let zero = a[0].constant(0.0);
    // t = y - a_3/4:  y^4 + p y^2 + q y + r
    let shift = a[3] * 0.25;
    let square = shift * shift;
    let p = a[2] - square * 6.0;
    let q = a[1] - shift * (a[2] - square * 4.0) * 2.0;
    let r = a[0] - shift * a[1] + square * (a[2] - square * 3.0);
    // (y^2 + w y + m - u) (y^2 - w y + m + u), where z = w^2 solves z^3 + 2 p z^2 + (p^2 - 4 r) z - q^2 = 0
    let slope = p * p - r * 4.0;
    let spread = p * p + r * 12.0;
    let skew = (p * p * 2.0 - r * 72.0) * p + q * q * 27.0;
    // Of its three roots the one that lies apart, or the only one: z = ±x - 2 p/3
    let (size, cube) = (skew.abs(), spread * spread * spread * 4.0);
    let discriminant = skew * skew - cube;
    let alone = zero.lt(discriminant);
    let v = size / cube.sqrt();
    // cos(arccos(v)/3), to 1e-4
    let cosine = ((v * 0.0099 - 0.0427) * v + 1.0 / 6.0) * v + 0.866_025;
    let root = (F::select(alone, size + discriminant.sqrt(), zero.constant(1.0)) * 0.5).cbrt();
    let x = F::select(alone, root + spread / root, cosine * spread.sqrt() * 2.0) * (1.0 / 3.0);
    let mut z = F::select(skew.lt(zero), -x, x) - p * (2.0 / 3.0);
    // Halley: 1e-4, 1e-12, rounding
    for _ in 0..2 {
        let value = ((z + p * 2.0) * z + slope) * z - q * q;
        let (rise, bend) = ((z * 3.0 + p * 4.0) * z + slope, z * 3.0 + p * 2.0);
        z = z - value * rise / (rise * rise - value * bend);
    }
    // Where it has three roots, and some are negative, the quartic has none.
    let none = !(alone | (p.lt(zero) & zero.lt(slope)));
    let z = F::select(none, zero.constant(f64::NAN), zero.larger(z));
    let (w, m) = (z.sqrt(), (p + z) * 0.5);
    let u = zero.larger(m * m - r).sqrt();
    let u = F::select(q.lt(zero), -u, u);
    [[square + shift * w + m - u, shift * 2.0 + w], [square - shift * w + m + u, shift * 2.0 - w]]
}

/// Newton's step for two factors of a quartic.
#[inline(always)]
fn nearer<F: Compare>(a: &[F; 4], [[c, b], [d, e]]: [[F; 2]; 2]) -> [[F; 2]; 2] {
    // (t^2 + b t + c) (t^2 + e t + d) less the quartic, without what changes of e and d take away
    let cubic = a[3] - b - e;
    let square = a[2] - c - d - b * e - b * cubic;
    let linear = a[1] - b * d - e * c - b * square - c * cubic;
    let constant = a[0] - c * d - c * square;
    let (of_b, of_c) = (b - e, c - d);
    let along = b * of_b - of_c;
    let resultant = c * of_b * of_b - of_c * along;
    let zero = resultant.constant(0.0);
    let per = F::select(zero.lt(resultant.abs()), resultant.recip(), zero);
    let more_b = (of_b * constant - of_c * linear) * per;
    let more_c = (along * constant - c * of_b * linear) * per;
    [[c + more_c, b + more_b], [d + (square - more_c + of_b * more_b), e + (cubic - more_b)]]
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
