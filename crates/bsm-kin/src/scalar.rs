//! The scalar that every formula is generic over; the only file that names the traits of the
//! dual-number crate.

use std::ops::{Add, Mul, Neg, Sub};

use nalgebra::{ClosedAddAssign, ClosedDivAssign, ClosedMulAssign, ClosedSubAssign};
use num_dual::{DualNum, DualNumCopy};
use num_traits::{One, Zero};

/// Scalar of every equation: `f64`, a [`Jet`](crate::Jet), or any dual number of num-dual.
pub trait Scalar:
    nalgebra::Scalar
    + Copy
    + From<f64>
    + Zero
    + One
    + Neg<Output = Self>
    + ClosedAddAssign
    + ClosedSubAssign
    + ClosedMulAssign
    + ClosedDivAssign
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    /// The value without derivatives.
    fn re(&self) -> f64;
    /// Sine and cosine.
    fn sin_cos(&self) -> (Self, Self);
    /// Square root.
    #[must_use]
    fn sqrt(&self) -> Self;
    /// Cube root.
    #[must_use]
    fn cbrt(&self) -> Self;
    /// One over the value.
    #[must_use]
    fn recip(&self) -> Self;
    /// The value to a constant power.
    #[must_use]
    fn powf(&self, exponent: f64) -> Self;
    /// Angle of this tangent.
    #[must_use]
    fn atan(&self) -> Self;
    /// Angle of the point (`other`, `self`) from the first axis.
    #[must_use]
    fn atan2(&self, other: Self) -> Self;

    /// Sine.
    #[must_use]
    fn sin(&self) -> Self {
        self.sin_cos().0
    }
    /// Cosine.
    #[must_use]
    fn cos(&self) -> Self {
        self.sin_cos().1
    }
    /// Tangent.
    #[must_use]
    fn tan(&self) -> Self {
        let (sin, cos) = self.sin_cos();
        sin / cos
    }
    /// The value times itself.
    #[must_use]
    fn square(&self) -> Self {
        *self * *self
    }
}

/// Scalar that constants of the type `P` enter: a jet in the unknowns over numbers, or the same jet
/// over constants that are jets themselves.
pub trait Over<P>:
    Scalar + From<P> + Add<P, Output = Self> + Sub<P, Output = Self> + Mul<P, Output = Self>
{
}

impl<P, D> Over<P> for D where
    D: Scalar + From<P> + Add<P, Output = D> + Sub<P, Output = D> + Mul<P, Output = D>
{
}

impl<T: DualNumCopy + DualNum<Primitive = f64>> Scalar for T {
    fn re(&self) -> f64 {
        num_dual::DualStruct::re(self)
    }

    fn sin_cos(&self) -> (Self, Self) {
        DualNum::sin_cos(self)
    }

    fn sqrt(&self) -> Self {
        DualNum::sqrt(self)
    }

    fn cbrt(&self) -> Self {
        DualNum::cbrt(self)
    }

    fn recip(&self) -> Self {
        DualNum::recip(self)
    }

    fn powf(&self, exponent: f64) -> Self {
        DualNum::powf(self, exponent)
    }

    fn atan(&self) -> Self {
        DualNum::atan(self)
    }

    fn atan2(&self, other: Self) -> Self {
        DualNum::atan2(self, other)
    }
}
