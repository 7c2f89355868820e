//! The arithmetic operations that a formula needs in order to hold for one point and for many
//! points.

use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use num_dual::{DualNum, DualNumCopy};

use crate::root::cube_root;

/// The scalar of formulas that are evaluated for one point, with or without derivatives, or for
/// several points side by side. Every [`Scalar`](crate::Scalar) and the lanes of `bsm-simd`
/// implement it.
///
/// Functions that are generic over this trait must be `#[inline(always)]`, because the code of a
/// lane is compiled for the instruction set of its caller only if it is inlined.
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
    /// A truth value for each point.
    type Mask: Copy
        + Debug
        + PartialEq
        + BitAnd<Output = Self::Mask>
        + BitOr<Output = Self::Mask>
        + Not<Output = Self::Mask>;

    /// Returns the same number at every point.
    #[must_use]
    fn constant(self, x: f64) -> Self;
    /// Returns `yes` where the mask is true and `no` elsewhere.
    #[must_use]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// Returns the square root.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Returns the cube root. A lane must contain normal positive numbers.
    #[must_use]
    fn cbrt(self) -> Self;
    /// Returns the reciprocal.
    #[must_use]
    fn recip(self) -> Self;
    /// Returns the exponential function.
    #[must_use]
    fn exp(self) -> Self;
    /// Returns the natural logarithm. A lane must contain normal positive numbers.
    #[must_use]
    fn ln(self) -> Self;
    /// Returns the inverse hyperbolic sine.
    #[must_use]
    fn asinh(self) -> Self;
    /// Returns the value raised to a constant power. A lane must contain normal positive numbers.
    #[must_use]
    fn powf(self, exponent: f64) -> Self;

    /// Returns the square.
    #[inline(always)]
    #[must_use]
    fn square(self) -> Self {
        self * self
    }
}

/// A field that accepts constants of the type `P`: a number or a lane, or either of them with
/// derivatives.
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

/// Applies the same expression to each of a few parts, without a closure and without a loop. A
/// closure would be a call if the instruction set differs. A kernel would have thousands of short
/// loops, which take the compiler minutes to unroll.
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
