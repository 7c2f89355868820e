//! Dual numbers for automatic differentiation: numbers or SIMD vectors with `N` partial
//! derivatives. The Jacobian of a ball needs derivatives with respect to seven unknowns, and
//! formulas for SIMD vectors need derivatives with respect to one to three variables.
//!
//! The crate num-dual is more general, and the tests compare this module with it. For the seven
//! equations of a ball, num-dual is slower (benchmark: `cargo bench -p bsm-benches --
//! rigid/linearize`).

use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use num_traits::{One, Zero};

use crate::{Real, Scalar, parts};

/// A value and its partial derivatives with respect to `N` variables.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jet<const N: usize, F = f64> {
    /// Value without derivatives.
    pub re: F,
    /// Partial derivatives with respect to each variable.
    pub eps: [F; N],
}

impl<const N: usize, F: Real> Jet<N, F> {
    /// Creates a constant, whose derivatives are all zero.
    #[inline(always)]
    pub fn fixed(re: F) -> Self {
        Self { re, eps: [re.constant(0.0); N] }
    }

    /// Creates a value that depends only on variable `i` and has the derivative `rate` with respect
    /// to this variable.
    #[inline(always)]
    pub fn along(re: F, i: usize, rate: F) -> Self {
        let mut variable = Self::fixed(re);
        variable.eps[i] = rate;
        variable
    }

    /// Creates the independent variable with index `i` and the given value.
    #[inline(always)]
    pub fn variable(re: F, i: usize) -> Self {
        Self::along(re, i, re.constant(1.0))
    }

    /// Applies the chain rule: returns a function of `self`, given the value `re` and the
    /// derivative `slope` of this function at `self`.
    #[inline(always)]
    #[must_use]
    pub fn chain(self, re: F, slope: F) -> Self {
        Self { re, eps: parts!(self.eps, N, i, self.eps[i] * slope) }
    }

    /// Returns the jet with value `re` and derivatives `a * self.eps + b * other.eps`.
    #[inline(always)]
    fn combine(self, a: F, other: Self, b: F, re: F) -> Self {
        Self { re, eps: parts!(self.eps, N, i, a * self.eps[i] + b * other.eps[i]) }
    }
}

impl<const N: usize, F: Real> Real for Jet<N, F> {
    type Mask = F::Mask;

    #[inline(always)]
    fn constant(self, x: f64) -> Self {
        Self::fixed(self.re.constant(x))
    }

    #[inline(always)]
    fn select(mask: F::Mask, yes: Self, no: Self) -> Self {
        let eps = parts!(no.eps, N, i, F::select(mask, yes.eps[i], no.eps[i]));
        Self { re: F::select(mask, yes.re, no.re), eps }
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.re.sqrt();
        self.chain(root, root.constant(0.5) / root)
    }

    #[inline(always)]
    fn cbrt(self) -> Self {
        let root = self.re.cbrt();
        self.chain(root, (root * 3.0 * root).recip())
    }

    #[inline(always)]
    fn recip(self) -> Self {
        let inverse = self.re.recip();
        self.chain(inverse, -inverse * inverse)
    }

    #[inline(always)]
    fn powf(self, exponent: f64) -> Self {
        let power = self.re.powf(exponent);
        self.chain(power, power * exponent / self.re)
    }

    #[inline(always)]
    fn exp(self) -> Self {
        let exp = self.re.exp();
        self.chain(exp, exp)
    }

    #[inline(always)]
    fn ln(self) -> Self {
        self.chain(self.re.ln(), self.re.recip())
    }

    #[inline(always)]
    fn asinh(self) -> Self {
        self.chain(self.re.asinh(), (self.re.square() + 1.0).sqrt().recip())
    }

    #[inline(always)]
    fn atan2(self, other: Self) -> Self {
        let square = self.re.square() + other.re.square();
        self.combine(other.re / square, other, -self.re / square, self.re.atan2(other.re))
    }

    #[inline(always)]
    fn lt(self, other: Self) -> F::Mask {
        self.re.lt(other.re)
    }

    #[inline(always)]
    fn le(self, other: Self) -> F::Mask {
        self.re.le(other.re)
    }

    #[inline(always)]
    fn any(mask: F::Mask) -> bool {
        F::any(mask)
    }
}

impl<const N: usize> Scalar for Jet<N> {
    fn re(&self) -> f64 {
        self.re
    }

    fn sin_cos(&self) -> (Self, Self) {
        let (sin, cos) = self.re.sin_cos();
        (self.chain(sin, cos), self.chain(cos, -sin))
    }

    fn atan(&self) -> Self {
        self.chain(self.re.atan(), (1.0 + self.re * self.re).recip())
    }
}

impl<const N: usize> From<f64> for Jet<N> {
    fn from(re: f64) -> Self {
        Self::fixed(re)
    }
}

impl<const N: usize> Zero for Jet<N> {
    fn zero() -> Self {
        Self::from(0.0)
    }

    fn is_zero(&self) -> bool {
        *self == Self::zero()
    }
}

impl<const N: usize> One for Jet<N> {
    fn one() -> Self {
        Self::from(1.0)
    }
}

impl<const N: usize, F: Real> Neg for Jet<N, F> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { re: -self.re, eps: parts!(self.eps, N, i, -self.eps[i]) }
    }
}

impl<const N: usize, F: Real> Mul for Jet<N, F> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.combine(other.re, other, self.re, self.re * other.re)
    }
}

impl<const N: usize, F: Real> Div for Jet<N, F> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let inverse = other.re.recip();
        let quotient = self.re * inverse;
        self.combine(inverse, other, -quotient * inverse, quotient)
    }
}

macro_rules! sums {
    ($($trait:ident $method:ident $op:tt;)*) => {$(
        impl<const N: usize, F: Real> $trait for Jet<N, F> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                let eps = parts!(self.eps, N, i, self.eps[i] $op other.eps[i]);
                Self { re: self.re $op other.re, eps }
            }
        }

        impl<const N: usize, F: Real> $trait<f64> for Jet<N, F> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: f64) -> Self {
                Self { re: self.re $op other, ..self }
            }
        }
    )*};
}

sums! {
    Add add +;
    Sub sub -;
}

impl<const N: usize, F: Real> Mul<f64> for Jet<N, F> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        self.chain(self.re * other, self.re.constant(other))
    }
}

impl<const N: usize, F: Real> Div<f64> for Jet<N, F> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: f64) -> Self {
        self.chain(self.re / other, self.re.constant(other.recip()))
    }
}

macro_rules! assign {
    ($($trait:ident $method:ident $op:tt;)*) => {$(
        impl<const N: usize> $trait for Jet<N> {
            fn $method(&mut self, other: Self) {
                *self = *self $op other;
            }
        }
    )*};
}

assign! {
    AddAssign add_assign +;
    SubAssign sub_assign -;
    MulAssign mul_assign *;
    DivAssign div_assign /;
}

#[cfg(test)]
mod tests {
    use num_dual::DualSVec64;
    use proptest::prelude::*;

    use super::*;

    /// Evaluates an expression that uses all operations of [`Scalar`].
    fn evaluate_all_operations<D: Scalar>(x: D, y: D) -> D {
        let (sin, cos) = (x * y).sin_cos();
        let mut z = (sin / (cos + 2.0) - y.recip()) * (x.square() + y.square()).sqrt();
        z += x.atan2(y) * 0.3 - x.atan() * y.powf(-1.5) - 1.5;
        z -= -x.tan();
        z *= x.cos() + D::one() * y.sin() + y.cbrt();
        z += (-y).exp() * y.ln() + (x + y).asinh();
        z /= y + D::from(3.0);
        z + D::zero()
    }

    proptest! {
        #[test]
        fn jets_agree_with_num_dual(x in -1.4..1.4_f64, y in 0.1..2.0_f64) {
            let ours = evaluate_all_operations(Jet::<2>::variable(x, 0), Jet::variable(y, 1));
            let (value, slopes) = num_dual::gradient(
                |v: nalgebra::Vector2<DualSVec64<2>>| evaluate_all_operations(v[0], v[1]),
                &nalgebra::Vector2::new(x, y),
            );
            // The tolerance allows for rounding errors of values up to about ten near the poles of
            // the tangent.
            let scale = 1.0 + value.abs() + slopes.norm();
            prop_assert!((ours.re - value).abs() <= 1e-13 * scale);
            prop_assert!((ours.re - evaluate_all_operations(x, y)).abs() <= 1e-13 * scale);
            for i in 0..2 {
                prop_assert!((ours.eps[i] - slopes[i]).abs() <= 1e-12 * scale, "{i}");
            }
            prop_assert!(!ours.is_zero());
        }
    }
}
