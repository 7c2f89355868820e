//! Scalar type over which every formula is generic. Only this file uses the traits of the crate
//! num-dual.

use nalgebra::{ClosedAddAssign, ClosedDivAssign, ClosedMulAssign, ClosedSubAssign};
use num_dual::{DualNum, DualNumCopy};
use num_traits::{One, Zero};

use crate::{Real, RealOver};

/// Scalar type of all equations: `f64`, [`Jet`](crate::Jet), or any dual number of the crate
/// num-dual.
pub trait Scalar:
    Real<Mask = bool>
    + nalgebra::Scalar
    + From<f64>
    + Zero
    + One
    + ClosedAddAssign
    + ClosedSubAssign
    + ClosedMulAssign
    + ClosedDivAssign
{
    /// Returns the value without derivatives.
    fn re(&self) -> f64;
    /// Returns sine and cosine.
    fn sin_cos(&self) -> (Self, Self);
    /// Returns the arctangent.
    #[must_use]
    fn atan(&self) -> Self;

    /// Returns the sine.
    #[must_use]
    fn sin(&self) -> Self {
        self.sin_cos().0
    }
    /// Returns the cosine.
    #[must_use]
    fn cos(&self) -> Self {
        self.sin_cos().1
    }
    /// Returns the tangent.
    #[must_use]
    fn tan(&self) -> Self {
        let (sin, cos) = self.sin_cos();
        sin / cos
    }
}

/// A scalar that supports arithmetic with constants of type `P`. For example, the constants in a
/// formula for jets can be plain numbers or other jets.
pub trait Over<P>: Scalar + RealOver<P> + From<P> {}

impl<P, D: Scalar + RealOver<P> + From<P>> Over<P> for D {}

impl<T: DualNumCopy + DualNum<Primitive = f64>> Scalar for T {
    fn re(&self) -> f64 {
        num_dual::DualStruct::re(self)
    }

    fn sin_cos(&self) -> (Self, Self) {
        DualNum::sin_cos(self)
    }

    fn atan(&self) -> Self {
        DualNum::atan(self)
    }
}
