//! The arithmetic that a formula needs to hold for one point and for many.

use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use num_dual::{DualNum, DualNumCopy};

use crate::root::cube_root;

/// What a formula is written in that is evaluated for one point, with or without derivatives, and
/// for several points side by side: every [`Scalar`](crate::Scalar), and the lanes of `bsm-simd`.
///
/// Such a formula is `#[inline(always)]`, since a lane's code takes the instruction set of its caller
/// only inline.
pub trait Field:
    Copy
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    /// Yes or no, for each point.
    type Mask: Copy
        + Debug
        + PartialEq
        + BitAnd<Output = Self::Mask>
        + BitOr<Output = Self::Mask>
        + Not<Output = Self::Mask>;

    /// The same number at every point.
    #[must_use]
    fn constant(self, x: f64) -> Self;
    /// `yes` where the mask is true, `no` elsewhere.
    #[must_use]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// Square root.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Cube root; of lanes only of normal positive numbers.
    #[must_use]
    fn cbrt(self) -> Self;
    /// One over the value.
    #[must_use]
    fn recip(self) -> Self;
    /// The exponential.
    #[must_use]
    fn exp(self) -> Self;
    /// The natural logarithm; of lanes only of normal positive numbers.
    #[must_use]
    fn ln(self) -> Self;
    /// The number whose hyperbolic sine this is.
    #[must_use]
    fn asinh(self) -> Self;
    /// The value to a constant power; of lanes only of normal positive numbers.
    #[must_use]
    fn powf(self, exponent: f64) -> Self;

    /// The value times itself.
    #[inline(always)]
    #[must_use]
    fn square(self) -> Self {
        self * self
    }
}

/// Field that constants of the type `P` enter: a number or a lane, or either with derivatives.
pub trait FieldOver<P>:
    Field + Add<P, Output = Self> + Sub<P, Output = Self> + Mul<P, Output = Self>
{
}

impl<P, D> FieldOver<P> for D where
    D: Field + Add<P, Output = D> + Sub<P, Output = D> + Mul<P, Output = D>
{
}

impl<T: DualNumCopy + DualNum<Primitive = f64>> Field for T {
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
}

/// The same for each of a few parts, without a closure or a short loop: the one is a call where the instruction set differs,
/// and of loops a kernel would have thousands, which take the compiler minutes to unroll.
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
