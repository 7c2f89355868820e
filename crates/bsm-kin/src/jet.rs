//! A value with `N` partial derivatives, for Jacobians of small systems.
//!
//! num-dual does the same in general, and is what this is tested against. On the seven equations
//! of a ball it is the slower of the two: `cargo bench -p bsm-benches -- rigid/linearize` times
//! both.

use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use num_traits::{One, Zero};

use crate::root::cube_root;
use crate::{Field, Scalar};

/// A value and its partial derivatives with respect to `N` variables.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jet<const N: usize> {
    /// The value.
    pub re: f64,
    /// The partial derivatives.
    pub eps: [f64; N],
}

impl<const N: usize> Jet<N> {
    /// Variable number `i` with this value.
    pub fn variable(re: f64, i: usize) -> Self {
        let mut eps = [0.0; N];
        eps[i] = 1.0;
        Self { re, eps }
    }

    /// A function with this value and slope at `self` (chain rule).
    fn chain(self, re: f64, slope: f64) -> Self {
        Self { re, eps: self.eps.map(|e| e * slope) }
    }

    /// Linear combination of the derivatives of two jets.
    fn combine(self, a: f64, other: Self, b: f64, re: f64) -> Self {
        Self { re, eps: std::array::from_fn(|i| a * self.eps[i] + b * other.eps[i]) }
    }
}

impl<const N: usize> Field for Jet<N> {
    type Mask = bool;

    fn constant(self, x: f64) -> Self {
        Self::from(x)
    }

    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }

    fn sqrt(self) -> Self {
        let root = self.re.sqrt();
        self.chain(root, 0.5 / root)
    }

    fn cbrt(self) -> Self {
        let root = cube_root(self.re);
        self.chain(root, (3.0 * root * root).recip())
    }

    fn recip(self) -> Self {
        let inverse = self.re.recip();
        self.chain(inverse, -inverse * inverse)
    }

    fn powf(self, exponent: f64) -> Self {
        let power = self.re.powf(exponent);
        self.chain(power, exponent * power / self.re)
    }

    fn exp(self) -> Self {
        let exp = self.re.exp();
        self.chain(exp, exp)
    }

    fn ln(self) -> Self {
        self.chain(self.re.ln(), self.re.recip())
    }

    fn asinh(self) -> Self {
        self.chain(self.re.asinh(), self.re.hypot(1.0).recip())
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

    fn atan2(&self, other: Self) -> Self {
        let square = self.re * self.re + other.re * other.re;
        self.combine(other.re / square, other, -self.re / square, self.re.atan2(other.re))
    }
}

impl<const N: usize> From<f64> for Jet<N> {
    fn from(re: f64) -> Self {
        Self { re, eps: [0.0; N] }
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

impl<const N: usize> Neg for Jet<N> {
    type Output = Self;

    fn neg(self) -> Self {
        self.chain(-self.re, -1.0)
    }
}

impl<const N: usize> Add for Jet<N> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, eps: std::array::from_fn(|i| self.eps[i] + other.eps[i]) }
    }
}

impl<const N: usize> Sub for Jet<N> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self { re: self.re - other.re, eps: std::array::from_fn(|i| self.eps[i] - other.eps[i]) }
    }
}

impl<const N: usize> Mul for Jet<N> {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        self.combine(other.re, other, self.re, self.re * other.re)
    }
}

impl<const N: usize> Div for Jet<N> {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let inverse = other.re.recip();
        let quotient = self.re * inverse;
        self.combine(inverse, other, -quotient * inverse, quotient)
    }
}

impl<const N: usize> Add<f64> for Jet<N> {
    type Output = Self;

    fn add(self, other: f64) -> Self {
        Self { re: self.re + other, ..self }
    }
}

impl<const N: usize> Sub<f64> for Jet<N> {
    type Output = Self;

    fn sub(self, other: f64) -> Self {
        Self { re: self.re - other, ..self }
    }
}

impl<const N: usize> Mul<f64> for Jet<N> {
    type Output = Self;

    fn mul(self, other: f64) -> Self {
        self.chain(self.re * other, other)
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

    /// Every operation of [`Scalar`] in one expression.
    fn everything<D: Scalar>(x: D, y: D) -> D {
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
            let ours = everything(Jet::<2>::variable(x, 0), Jet::variable(y, 1));
            let (value, slopes) = num_dual::gradient(
                |v: nalgebra::Vector2<DualSVec64<2>>| everything(v[0], v[1]),
                &nalgebra::Vector2::new(x, y),
            );
            // Rounding of values up to about ten times the poles of the tangent.
            let scale = 1.0 + value.abs() + slopes.norm();
            prop_assert!((ours.re - value).abs() <= 1e-13 * scale);
            prop_assert!((ours.re - everything(x, y)).abs() <= 1e-13 * scale);
            for i in 0..2 {
                prop_assert!((ours.eps[i] - slopes[i]).abs() <= 1e-12 * scale, "{i}");
            }
            prop_assert!(!ours.is_zero());
        }
    }
}
