//! SIMD vectors that are as wide as the instruction set permits.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use bsm_kin::{Jet, Real, parts};
use pulp::Simd;

/// True if the target has no fused multiply-add instructions. Emulating them would take several
/// times as long as a separate multiplication and addition. The additional rounding changes results
/// by about 1e-16.
const WITHOUT_FUSED_OPERATIONS: bool = cfg!(target_family = "wasm");

/// A vector with one number for each of several points. It consists of `N` SIMD vectors of the
/// instruction set, so that the processor can work on one SIMD vector while it waits for another.
#[derive(Clone, Copy)]
pub struct Lane<S: Simd, const N: usize = 1> {
    simd: S,
    x: [S::f64s; N],
}

/// A truth value for every number of a [`Lane`].
#[derive(Clone, Copy, Debug)]
pub struct Mask<S: Simd, const N: usize = 1> {
    simd: S,
    m: [S::m64s; N],
}

impl<S: Simd, const N: usize> Lane<S, N> {
    /// Number of elements in a [`Lane`].
    pub const LEN: usize = N * S::F64_LANES;

    /// Creates a [`Lane`] in which all numbers are equal to `x`.
    #[inline(always)]
    pub fn splat(simd: S, x: f64) -> Self {
        Self { simd, x: [simd.splat_f64s(x); N] }
    }

    /// Creates a [`Lane`] from SIMD vectors of the instruction set.
    #[inline(always)]
    pub fn of(simd: S, x: [S::f64s; N]) -> Self {
        Self { simd, x }
    }

    /// Loads the first numbers of a slice into a [`Lane`]. If the slice is too short, the remaining
    /// numbers are zero.
    #[inline(always)]
    pub fn load(simd: S, from: &[f64]) -> Self {
        let (whole, rest) = S::as_simd_f64s(from);
        if let Some(whole) = whole.first_chunk::<N>() {
            return Self { simd, x: *whole };
        }
        let zero = simd.splat_f64s(0.0);
        let mut x = [zero; N];
        for i in 0..N {
            if i < whole.len() {
                x[i] = whole[i];
            } else if i == whole.len() {
                x[i] = simd.partial_load_f64s(rest);
            }
        }
        Self { simd, x }
    }

    /// Writes the numbers to the beginning of a slice. If the slice is too short, the remaining
    /// numbers are not written.
    #[inline(always)]
    pub fn store(self, to: &mut [f64]) {
        let (whole, rest) = S::as_mut_simd_f64s(to);
        if let Some(whole) = whole.first_chunk_mut::<N>() {
            *whole = self.x;
            return;
        }
        for i in 0..N {
            if i < whole.len() {
                whole[i] = self.x[i];
            } else if i == whole.len() {
                self.simd.partial_store_f64s(rest, self.x[i]);
            }
        }
    }

    /// Returns a [`Lane`] of the same width in which all numbers are equal to `x`.
    #[inline(always)]
    #[must_use]
    pub fn constant(self, x: f64) -> Self {
        Self::splat(self.simd, x)
    }

    /// Loads the first numbers of a slice into a [`Lane`] of the same width, like
    /// [`load`](Self::load).
    #[inline(always)]
    #[must_use]
    pub fn load_like(self, from: &[f64]) -> Self {
        Self::load(self.simd, from)
    }

    /// Returns the numbers as a slice.
    #[inline(always)]
    pub fn as_slice(&self) -> &[f64] {
        pulp::bytemuck::cast_slice(&self.x)
    }

    /// Applies a scalar function to each number of the vector.
    #[inline(always)]
    #[must_use]
    pub fn each(mut self, f: impl Fn(f64) -> f64) -> Self {
        let numbers: &mut [f64] = pulp::bytemuck::cast_slice_mut(&mut self.x);
        for x in numbers {
            *x = f(*x);
        }
        self
    }

    /// Applies a scalar function to each pair of corresponding numbers in two vectors.
    #[inline(always)]
    #[must_use]
    pub fn zip(mut self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let numbers: &mut [f64] = pulp::bytemuck::cast_slice_mut(&mut self.x);
        for (x, y) in numbers.iter_mut().zip(other.as_slice()) {
            *x = f(*x, *y);
        }
        self
    }

    /// Returns the reciprocals of the numbers.
    #[inline(always)]
    #[must_use]
    pub fn recip(self) -> Self {
        self.constant(1.0) / self
    }

    /// Returns `self × b + c` with a single rounding, except in WebAssembly.
    #[inline(always)]
    #[must_use]
    pub fn mul_add(self, b: Self, c: Self) -> Self {
        if WITHOUT_FUSED_OPERATIONS {
            return self * b + c;
        }
        let simd = self.simd;
        Self { x: parts!(c.x, N, i, simd.mul_add_f64s(self.x[i], b.x[i], c.x[i])), ..self }
    }

    /// Returns `c − self × b` with a single rounding, except in WebAssembly.
    #[inline(always)]
    #[must_use]
    pub fn neg_mul_add(self, b: Self, c: Self) -> Self {
        if WITHOUT_FUSED_OPERATIONS {
            return c - self * b;
        }
        let simd = self.simd;
        Self { x: parts!(c.x, N, i, simd.negate_mul_add_f64s(self.x[i], b.x[i], c.x[i])), ..self }
    }

    /// Returns the square roots of the numbers.
    #[inline(always)]
    #[must_use]
    pub fn sqrt(self) -> Self {
        Self { x: parts!(self.x, N, i, self.simd.sqrt_f64s(self.x[i])), ..self }
    }

    /// Returns the sum of all numbers. The second half of the SIMD vectors is repeatedly added to
    /// the first half until only one vector remains.
    #[inline(always)]
    pub fn sum(mut self) -> f64 {
        let mut parts = N;
        while parts > 1 {
            parts /= 2;
            for i in 0..parts {
                self.x[i] = self.simd.add_f64s(self.x[i], self.x[i + parts]);
            }
        }
        self.simd.reduce_sum_f64s(self.x[0])
    }

    /// Returns the absolute values of the numbers.
    #[inline(always)]
    #[must_use]
    pub fn abs(self) -> Self {
        let simd = self.simd;
        // The sign bit is cleared with a bit mask, because pulp's `abs` function is not inlined.
        let size = simd.splat_f64s(f64::from_bits(u64::MAX >> 1));
        Self { x: parts!(self.x, N, i, simd.and_f64s(size, self.x[i])), ..self }
    }

    /// Returns the larger number of each pair of corresponding numbers.
    #[inline(always)]
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        self.lt(other).select(other, self)
    }

    /// Returns the smaller number of each pair of corresponding numbers.
    #[inline(always)]
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        self.lt(other).select(self, other)
    }

    /// Returns a mask that is true where the number in `self` is less than the number in `other`,
    /// and false where one of them is NaN.
    #[inline(always)]
    pub fn lt(self, other: Self) -> Mask<S, N> {
        let simd = self.simd;
        let none = [simd.less_than_f64s(self.x[0], other.x[0]); N];
        Mask { simd, m: parts!(none, N, i, simd.less_than_f64s(self.x[i], other.x[i])) }
    }

    /// Returns a mask that is true where the number in `self` is less than or equal to the number
    /// in `other`, and false where one of them is NaN.
    #[inline(always)]
    pub fn le(self, other: Self) -> Mask<S, N> {
        let simd = self.simd;
        let none = [simd.less_than_or_equal_f64s(self.x[0], other.x[0]); N];
        Mask { simd, m: parts!(none, N, i, simd.less_than_or_equal_f64s(self.x[i], other.x[i])) }
    }

    /// Returns a mask that is true where the number in `self` is greater than the number in
    /// `other`, and false where one of them is NaN.
    #[inline(always)]
    pub fn gt(self, other: Self) -> Mask<S, N> {
        other.lt(self)
    }
}

impl<S: Simd, const N: usize> Mask<S, N> {
    /// Returns a [`Lane`] with the numbers of `yes` where the mask is true and the numbers of `no`
    /// where it is false.
    #[inline(always)]
    pub fn select(self, yes: Lane<S, N>, no: Lane<S, N>) -> Lane<S, N> {
        let simd = self.simd;
        Lane { x: parts!(no.x, N, i, simd.select_f64s(self.m[i], yes.x[i], no.x[i])), ..yes }
    }

    /// Returns a [`Lane`] that contains 1 where the mask is true and 0 where it is false.
    #[inline(always)]
    pub fn to_numbers(self) -> Lane<S, N> {
        let one = Lane::splat(self.simd, 1.0);
        self.select(one, one.constant(0.0))
    }

    /// Returns true if the mask is true for at least one number.
    #[inline(always)]
    pub fn any(self) -> bool {
        let mut any = false;
        for m in self.m {
            any |= self.simd.first_true_m64s(m) < S::F64_LANES;
        }
        any
    }

    /// Writes the truth values to the beginning of a slice. If the slice is too short, the
    /// remaining values are not written.
    #[inline(always)]
    pub fn store(self, to: &mut [bool]) {
        for (to, x) in to.iter_mut().zip(self.to_numbers().as_slice()) {
            *to = *x > 0.5;
        }
    }
}

impl<S: Simd, const N: usize> PartialEq for Mask<S, N> {
    fn eq(&self, other: &Self) -> bool {
        self.to_numbers().as_slice() == other.to_numbers().as_slice()
    }
}

/// Implements trait methods by forwarding to the inherent methods of [`Lane`] with the same names.
macro_rules! own_methods {
    ($($name:ident($($x:ident: $kind:ty),*) -> $out:ty;)*) => {$(
        #[inline(always)]
        fn $name(self, $($x: $kind),*) -> $out {
            self.$name($($x),*)
        }
    )*};
}

impl<S: Simd, const N: usize> Real for Lane<S, N> {
    type Mask = Mask<S, N>;

    own_methods! {
        constant(x: f64) -> Self;
        sqrt() -> Self;
        recip() -> Self;
        exp() -> Self;
        ln() -> Self;
        abs() -> Self;
        mul_add(b: Self, c: Self) -> Self;
        neg_mul_add(b: Self, c: Self) -> Self;
        lt(other: Self) -> Mask<S, N>;
        le(other: Self) -> Mask<S, N>;
    }

    #[inline(always)]
    fn atan2(self, other: Self) -> Self {
        self.zip(other, f64::atan2)
    }

    #[inline(always)]
    fn any(mask: Mask<S, N>) -> bool {
        mask.any()
    }

    #[inline(always)]
    fn select(mask: Mask<S, N>, yes: Self, no: Self) -> Self {
        mask.select(yes, no)
    }

    #[inline(always)]
    fn cbrt(self) -> Self {
        self.cbrt_positive()
    }

    #[inline(always)]
    fn asinh(self) -> Self {
        self.arsinh()
    }

    #[inline(always)]
    fn powf(self, exponent: f64) -> Self {
        (self.ln() * exponent).exp()
    }
}

macro_rules! lanewise {
    ($($trait:ident $method:ident $lanes:ident;)*) => {$(
        impl<S: Simd, const N: usize> $trait for Lane<S, N> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self { x: parts!(self.x, N, i, self.simd.$lanes(self.x[i], other.x[i])), ..self }
            }
        }

        impl<S: Simd, const N: usize> $trait<f64> for Lane<S, N> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: f64) -> Self {
                self.$method(self.constant(other))
            }
        }
    )*};
}

lanewise! {
    Add add add_f64s;
    Sub sub sub_f64s;
    Mul mul mul_f64s;
    Div div div_f64s;
}

impl<S: Simd, const N: usize> Neg for Lane<S, N> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        let (simd, sign) = (self.simd, self.simd.splat_f64s(-0.0));
        Self { x: parts!(self.x, N, i, simd.xor_f64s(sign, self.x[i])), ..self }
    }
}

macro_rules! maskwise {
    ($($trait:ident $method:ident $masks:ident;)*) => {$(
        impl<S: Simd, const N: usize> $trait for Mask<S, N> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self { m: parts!(self.m, N, i, self.simd.$masks(self.m[i], other.m[i])), ..self }
            }
        }
    )*};
}

maskwise! {
    BitAnd bitand and_m64s;
    BitOr bitor or_m64s;
}

impl<S: Simd, const N: usize> Not for Mask<S, N> {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        Self { m: parts!(self.m, N, i, self.simd.not_m64s(self.m[i])), ..self }
    }
}

macro_rules! constant_lanes {
    ($($trait:ident $method:ident $op:tt;)*) => {$(
        impl<S: Simd, const N: usize, const K: usize> $trait<Lane<S, N>> for Jet<K, Lane<S, N>> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Lane<S, N>) -> Self {
                Self { re: self.re $op other, ..self }
            }
        }
    )*};
}

constant_lanes! {
    Add add +;
    Sub sub -;
}

impl<S: Simd, const N: usize, const K: usize> Mul<Lane<S, N>> for Jet<K, Lane<S, N>> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Lane<S, N>) -> Self {
        self.chain(self.re * other, other)
    }
}

#[cfg(test)]
mod tests {
    use bsm_kin::{Over, RealOver};
    use proptest::prelude::*;
    use pulp::Arch;

    use super::*;
    use crate::BLOCK;
    use crate::tests::by_lanes;

    /// Evaluates an expression that uses all operations of [`Real`].
    #[inline(always)]
    fn evaluate_all_operations<D: RealOver<P>, P>(x: D, y: D, p: P) -> D
    where
        P: Copy,
    {
        let z = (x * y + p) / (y * p + 2.0) - (x - p).square() * 0.5;
        let both = (y.ln() * x.asinh()).exp() - y.powf(0.7);
        both + (z.square() + 1.0).sqrt().recip() + y.cbrt() - (-x) * x.constant(0.3) - 1.5
    }

    by_lanes!(Both { x, y } -> 3: {
        let (x, y, p) = (Jet::<2, _>::variable(x, 0), Jet::variable(y, 1), x.constant(0.7));
        let z = evaluate_all_operations(x, y, p);
        [z.re, z.eps[0], z.eps[1]]
    });

    fn jets<D: Over<f64>>(x: D, y: D) -> D {
        evaluate_all_operations(x, y, 0.7)
    }

    proptest! {
        #[test]
        fn simd_jets_match_scalar_jets(
            x in proptest::array::uniform8(-2.0..2.0_f64), y in proptest::array::uniform8(0.1..2.0_f64),
        ) {
            let found = Arch::new().dispatch(Both { x, y });
            for i in 0..BLOCK {
                let jet = jets(Jet::<2>::variable(x[i], 0), Jet::variable(y[i], 1));
                // The tolerance allows for rounding errors of a few terms with values up to ten.
                prop_assert!((found[0][i] - jet.re).abs() <= 1e-14 * (1.0 + jet.re.abs()));
                for k in 0..2 {
                    let error = (found[k + 1][i] - jet.eps[k]).abs();
                    prop_assert!(error <= 1e-13 * (1.0 + jet.eps[k].abs()), "{error}");
                }
            }
        }
    }
}
