//! Numbers or lanes with derivatives.

use std::ops::{Add, Div, Mul, Neg, Sub};

use bsm_kin::Field;
use pulp::Simd;

use crate::Lane;
use crate::lane::parts;

/// Numbers, or a [`Lane`] of them, and their partial derivatives with respect to `K` variables.
#[derive(Clone, Copy)]
pub struct DualNumber<F, const K: usize> {
    /// The values.
    pub re: F,
    /// The partial derivatives.
    pub eps: [F; K],
}

/// The same for each derivative.
macro_rules! each {
    ($like:expr, $i:ident, $slope:expr) => {
        parts!($like, K, $i, $slope)
    };
}

impl<F: Field, const K: usize> DualNumber<F, K> {
    /// A value that does not change.
    #[inline(always)]
    pub fn fixed(re: F) -> Self {
        Self { re, eps: [re.constant(0.0); K] }
    }

    /// A value that changes with variable number `i` at this rate.
    #[inline(always)]
    pub fn along(re: F, i: usize, rate: F) -> Self {
        let mut variable = Self::fixed(re);
        variable.eps[i] = rate;
        variable
    }

    /// Variable number `i` with this value.
    #[inline(always)]
    pub fn variable(re: F, i: usize) -> Self {
        Self::along(re, i, re.constant(1.0))
    }

    /// A function with these values and slopes at `self` (chain rule).
    #[inline(always)]
    fn chain(self, re: F, slope: F) -> Self {
        Self { re, eps: each!(self.eps, i, self.eps[i] * slope) }
    }
}

impl<F: Field, const K: usize> Field for DualNumber<F, K> {
    type Mask = F::Mask;

    #[inline(always)]
    fn constant(self, x: f64) -> Self {
        Self::fixed(self.re.constant(x))
    }

    #[inline(always)]
    fn select(mask: F::Mask, yes: Self, no: Self) -> Self {
        let eps = each!(no.eps, i, F::select(mask, yes.eps[i], no.eps[i]));
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
        self.chain(root, (root * root * 3.0).recip())
    }

    #[inline(always)]
    fn recip(self) -> Self {
        let inverse = self.re.recip();
        self.chain(inverse, -(inverse * inverse))
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
        self.chain(self.re.asinh(), (self.re * self.re + 1.0).sqrt().recip())
    }

    #[inline(always)]
    fn powf(self, exponent: f64) -> Self {
        (self.ln() * exponent).exp()
    }
}

impl<F: Field, const K: usize> Neg for DualNumber<F, K> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { re: -self.re, eps: each!(self.eps, i, -self.eps[i]) }
    }
}

impl<F: Field, const K: usize> Mul for DualNumber<F, K> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let eps = each!(self.eps, i, self.eps[i] * other.re + other.eps[i] * self.re);
        Self { re: self.re * other.re, eps }
    }
}

impl<F: Field, const K: usize> Div for DualNumber<F, K> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let inverse = other.re.recip();
        let quotient = self.re * inverse;
        let eps = each!(self.eps, i, (self.eps[i] - quotient * other.eps[i]) * inverse);
        Self { re: quotient, eps }
    }
}

macro_rules! sums {
    ($($trait:ident $method:ident $op:tt;)*) => {$(
        impl<F: Field, const K: usize> $trait for DualNumber<F, K> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                let eps = each!(self.eps, i, self.eps[i] $op other.eps[i]);
                Self { re: self.re $op other.re, eps }
            }
        }

        impl<S: Simd, const N: usize, const K: usize> $trait<Lane<S, N>> for DualNumber<Lane<S, N>, K> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Lane<S, N>) -> Self {
                Self { re: self.re $op other, ..self }
            }
        }

        impl<F: Field, const K: usize> $trait<f64> for DualNumber<F, K> {
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

impl<S: Simd, const N: usize, const K: usize> Mul<Lane<S, N>> for DualNumber<Lane<S, N>, K> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Lane<S, N>) -> Self {
        self.chain(self.re * other, other)
    }
}

impl<F: Field, const K: usize> Mul<f64> for DualNumber<F, K> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        self.chain(self.re * other, self.re.constant(other))
    }
}

#[cfg(test)]
mod tests {
    use bsm_kin::{Jet, Over};
    use proptest::prelude::*;
    use pulp::Arch;

    use super::*;
    use crate::BLOCK;
    use crate::tests::by_lanes;

    /// Every operation in one expression.
    #[inline(always)]
    fn everything<D: bsm_kin::FieldOver<P>, P>(x: D, y: D, p: P) -> D
    where
        P: Copy,
    {
        let z = (x * y + p) / (y * p + 2.0) - (x - p).square() * 0.5;
        let both = (y.ln() * x.asinh()).exp() - y.powf(0.7);
        both + (z.square() + 1.0).sqrt().recip() + y.cbrt() - (-x) * x.constant(0.3) - 1.5
    }

    by_lanes!(Both { x, y } -> 3: {
        let (x, y, p) = (DualNumber::<_, 2>::variable(x, 0), DualNumber::variable(y, 1), x.constant(0.7));
        let z = everything(x, y, p);
        [z.re, z.eps[0], z.eps[1]]
    });

    fn jets<D: Over<f64>>(x: D, y: D) -> D {
        everything(x, y, 0.7)
    }

    proptest! {
        #[test]
        fn lanes_with_slopes_are_jets(
            x in proptest::array::uniform8(-2.0..2.0_f64), y in proptest::array::uniform8(0.1..2.0_f64),
        ) {
            let found = Arch::new().dispatch(Both { x, y });
            for i in 0..BLOCK {
                let jet = jets(Jet::<2>::variable(x[i], 0), Jet::variable(y[i], 1));
                // Rounding of a handful of terms of at most ten.
                prop_assert!((found[0][i] - jet.re).abs() <= 1e-14 * (1.0 + jet.re.abs()));
                for k in 0..2 {
                    let error = (found[k + 1][i] - jet.eps[k]).abs();
                    prop_assert!(error <= 1e-13 * (1.0 + jet.eps[k].abs()), "{error}");
                }
            }
        }
    }
}
