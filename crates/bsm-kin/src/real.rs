//! Arithmetic interface for formulas that are evaluated either for a single point or for several
//! points at once.

use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use num_dual::{DualNum, DualNumCopy};

use crate::root::cube_root;

/// Number type for formulas that are evaluated for a single point, with or without derivatives, or
/// for several points side by side. It is implemented by every [`Scalar`](crate::Scalar) and by the
/// SIMD vectors (`Lane`) of the crate `bsm-simd`. Comparisons consider only the values and ignore
/// derivatives.
///
/// Functions that are generic over this trait must be `#[inline(always)]`, because the code for
/// SIMD vectors uses the instruction set of its caller only if it is inlined.
pub trait Real:
    Copy
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
{
    /// Type of a mask, which contains one truth value per point.
    type Mask: Copy
        + Debug
        + PartialEq
        + BitAnd<Output = Self::Mask>
        + BitOr<Output = Self::Mask>
        + Not<Output = Self::Mask>;

    /// Returns the same constant for every point.
    #[must_use]
    fn constant(self, x: f64) -> Self;
    /// Returns `yes` for points where the mask is true, and `no` for all other points.
    #[must_use]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// Returns the square root.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Returns the cube root. All numbers in a SIMD vector must be positive and normal.
    #[must_use]
    fn cbrt(self) -> Self;
    /// Returns the reciprocal.
    #[must_use]
    fn recip(self) -> Self;
    /// Returns `e` raised to the power of `self`.
    #[must_use]
    fn exp(self) -> Self;
    /// Returns the natural logarithm. All numbers in a SIMD vector must be positive and normal.
    #[must_use]
    fn ln(self) -> Self;
    /// Returns the inverse hyperbolic sine.
    #[must_use]
    fn asinh(self) -> Self;
    /// Returns the number raised to a constant power. All numbers in a SIMD vector must be positive
    /// and normal.
    #[must_use]
    fn powf(self, exponent: f64) -> Self;

    /// Returns the polar angle of the point with coordinates (`other`, `self`) \[rad\].
    #[must_use]
    fn atan2(self, other: Self) -> Self;
    /// Returns a mask that is true for points where `self` is less than `other`, and false where
    /// one of them is NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// Returns a mask that is true for points where `self` is less than or equal to `other`, and
    /// false where one of them is NaN.
    fn le(self, other: Self) -> Self::Mask;
    /// Returns true if the mask is true for at least one point.
    fn any(mask: Self::Mask) -> bool;

    /// Returns a mask that is true for points where `self` is greater than `other`, and false where
    /// one of them is NaN.
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        other.lt(self)
    }

    /// Returns a mask that is true for points where `self` is less than a constant, and false where
    /// `self` is NaN.
    #[inline(always)]
    fn below(self, limit: f64) -> Self::Mask {
        self.lt(self.constant(limit))
    }

    /// Returns a mask that is true for points where `self` is less than or equal to a constant, and
    /// false where `self` is NaN.
    #[inline(always)]
    fn at_most(self, limit: f64) -> Self::Mask {
        self.le(self.constant(limit))
    }

    /// Returns a mask that is true for points where `self` is greater than a constant, and false
    /// where `self` is NaN.
    #[inline(always)]
    fn above(self, limit: f64) -> Self::Mask {
        self.gt(self.constant(limit))
    }

    /// Returns a mask that is true for points where `self` is greater than or equal to a constant,
    /// and false where `self` is NaN.
    #[inline(always)]
    fn at_least(self, limit: f64) -> Self::Mask {
        self.constant(limit).le(self)
    }

    /// Returns a mask with the same truth value for every point.
    #[inline(always)]
    fn mask(self, value: bool) -> Self::Mask {
        let zero = self.constant(0.0);
        if value { zero.le(zero) } else { zero.lt(zero) }
    }

    /// Returns the larger of two numbers.
    #[inline(always)]
    #[must_use]
    fn larger(self, other: Self) -> Self {
        Self::select(self.lt(other), other, self)
    }

    /// Returns the absolute value.
    #[inline(always)]
    #[must_use]
    fn abs(self) -> Self {
        Self::select(self.below(0.0), -self, self)
    }

    /// Returns the square.
    #[inline(always)]
    #[must_use]
    fn square(self) -> Self {
        self * self
    }

    /// Returns `self × b + c`. For SIMD vectors, this is a fused operation, which rounds only once.
    #[inline(always)]
    #[must_use]
    fn mul_add(self, b: Self, c: Self) -> Self {
        self * b + c
    }

    /// Returns `c − self × b`. For SIMD vectors, this is a fused operation, which rounds only once.
    #[inline(always)]
    #[must_use]
    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        c - self * b
    }
}

/// A [`Real`] that supports arithmetic with constants of type `P`. Both types are single numbers or
/// SIMD vectors, with or without derivatives.
pub trait RealOver<P>:
    Real + Add<P, Output = Self> + Sub<P, Output = Self> + Mul<P, Output = Self>
{
}

impl<P, D> RealOver<P> for D where
    D: Real + Add<P, Output = D> + Sub<P, Output = D> + Mul<P, Output = D>
{
}

impl<T: DualNumCopy + DualNum<Primitive = f64>> Real for T {
    type Mask = bool;

    #[inline(always)]
    fn constant(self, x: f64) -> Self {
        T::from(x)
    }

    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        DualNum::sqrt(&self)
    }

    #[inline(always)]
    fn cbrt(self) -> Self {
        if T::NDERIV == 0 { T::from(cube_root(self.re())) } else { DualNum::cbrt(&self) }
    }

    #[inline(always)]
    fn recip(self) -> Self {
        DualNum::recip(&self)
    }

    #[inline(always)]
    fn exp(self) -> Self {
        DualNum::exp(&self)
    }

    #[inline(always)]
    fn ln(self) -> Self {
        DualNum::ln(&self)
    }

    #[inline(always)]
    fn asinh(self) -> Self {
        DualNum::asinh(&self)
    }

    #[inline(always)]
    fn powf(self, exponent: f64) -> Self {
        DualNum::powf(&self, exponent)
    }

    #[inline(always)]
    fn atan2(self, other: Self) -> Self {
        DualNum::atan2(&self, other)
    }

    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self.re() < other.re()
    }

    #[inline(always)]
    fn le(self, other: Self) -> bool {
        self.re() <= other.re()
    }

    #[inline(always)]
    fn any(mask: bool) -> bool {
        mask
    }
}

/// Evaluates an expression for each of a few indices without a closure or a loop. A closure is not
/// inlined into a function that is compiled for another instruction set. With loops, each numerical
/// kernel would contain thousands of short loops, which the compiler would take minutes to unroll.
#[doc(hidden)]
#[macro_export]
macro_rules! parts {
    ($value:expr, $count:ident, $i:ident, $part:expr) => {{
        let mut parts = $value;
        if $count > 4 {
            for $i in 0..$count {
                parts[$i] = $part;
            }
        } else {
            if $count > 0 {
                let $i = 0;
                parts[$i] = $part;
            }
            if $count > 1 {
                let $i = 1;
                parts[$i] = $part;
            }
            if $count > 2 {
                let $i = 2;
                parts[$i] = $part;
            }
            if $count > 3 {
                let $i = 3;
                parts[$i] = $part;
            }
        }
        parts
    }};
}
