//! Numbers and lanes that rules can compare.

use std::ops::Div;

use bsm_kin::Field;
use pulp::Simd;

use crate::lane::own_methods;
use crate::{Lane, Mask};

/// A number, or a [`Lane`] of numbers, with a truth value for each number.
pub trait Compare: Field + Div<f64, Output = Self> {
    /// True for lanes, which contain several numbers.
    const WIDE: bool;

    /// Returns the absolute value.
    #[must_use]
    fn abs(self) -> Self;
    /// Returns sine and cosine of an angle \[rad\]. The angles of a lane must lie between -π/2 and
    /// π/2.
    #[must_use]
    fn sin_cos_of_tilt(self) -> (Self, Self);
    /// Returns `self × b + c`, for lanes with a single rounding.
    #[must_use]
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// Returns `c − self × b`, for lanes with a single rounding.
    #[must_use]
    fn neg_mul_add(self, b: Self, c: Self) -> Self;
    /// Returns a mask with the same truth value for each number.
    #[inline(always)]
    fn mask(self, value: bool) -> Self::Mask {
        let zero = self.constant(0.0);
        if value { zero.le(zero) } else { zero.lt(zero) }
    }
    /// Returns true if the mask is true for any number.
    fn any(mask: Self::Mask) -> bool;
    /// Applies a function to each number and the corresponding number of another value.
    #[must_use]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self;
    /// Returns where the number is less than the other number; false for NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// Returns where the number is at most the other number; false for NaN.
    fn le(self, other: Self) -> Self::Mask;

    /// Returns where the number is greater than the other number; false for NaN.
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        other.lt(self)
    }

    /// Returns the larger of two numbers.
    #[inline(always)]
    #[must_use]
    fn larger(self, other: Self) -> Self {
        Self::select(self.lt(other), other, self)
    }
}

impl Compare for f64 {
    const WIDE: bool = false;

    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
    }

    #[inline(always)]
    fn sin_cos_of_tilt(self) -> (Self, Self) {
        self.sin_cos()
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        self * b + c
    }

    #[inline(always)]
    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        c - self * b
    }

    #[inline(always)]
    fn any(mask: bool) -> bool {
        mask
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
    const WIDE: bool = true;

    own_methods! {
        abs() -> Self;
        mul_add(b: Self, c: Self) -> Self;
        neg_mul_add(b: Self, c: Self) -> Self;
        zip(other: Self, f: impl Fn(f64, f64) -> f64) -> Self;
        lt(other: Self) -> Mask<S, N>;
        le(other: Self) -> Mask<S, N>;
    }

    #[inline(always)]
    fn sin_cos_of_tilt(self) -> (Self, Self) {
        let (sin, cos) = self.abs().sin_cos_first_quadrant();
        (self.lt(self.constant(0.0)).select(-sin, sin), cos)
    }

    #[inline(always)]
    fn any(mask: Mask<S, N>) -> bool {
        mask.any()
    }
}
