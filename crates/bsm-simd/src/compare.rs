//! What rules are written in: a number, or several of them side by side.

use std::ops::{BitAnd, BitOr, Mul, Sub};

use pulp::Simd;

use crate::{Lane, Mask};

/// A number or a [`Lane`] of them, and yes or no for each.
pub trait Compare: Copy + Sub<Output = Self> + Mul<f64, Output = Self> {
    /// Yes or no.
    type Mask: Copy + BitAnd<Output = Self::Mask> + BitOr<Output = Self::Mask>;

    /// The same number in every place.
    #[must_use]
    fn constant(self, x: f64) -> Self;
    /// Absolute value.
    #[must_use]
    fn abs(self) -> Self;
    /// A function of each number and that of another one.
    #[must_use]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self;
    /// Where the number is less than another; never for NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// Where the number is at most another; never for NaN.
    fn le(self, other: Self) -> Self::Mask;

    /// Where the number is greater than another; never for NaN.
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        other.lt(self)
    }
}

impl Compare for f64 {
    type Mask = bool;

    #[inline(always)]
    fn constant(self, x: f64) -> Self {
        x
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        f(self, other)
    }

    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self < other
    }

    #[inline(always)]
    fn le(self, other: Self) -> bool {
        self <= other
    }
}

impl<S: Simd, const N: usize> Compare for Lane<S, N> {
    type Mask = Mask<S, N>;

    #[inline(always)]
    fn constant(self, x: f64) -> Self {
        self.constant(x)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        self.zip(other, f)
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Mask<S, N> {
        self.lt(other)
    }

    #[inline(always)]
    fn le(self, other: Self) -> Mask<S, N> {
        self.le(other)
    }
}
