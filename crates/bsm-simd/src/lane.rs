//! As many numbers as an instruction takes.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use pulp::Simd;

/// Numbers of a few points, as many as the instruction set takes at once.
#[derive(Clone, Copy)]
pub struct Lane<S: Simd> {
    pub(crate) simd: S,
    pub(crate) x: S::f64s,
}

/// Yes or no for each number of a [`Lane`].
#[derive(Clone, Copy)]
pub struct Mask<S: Simd> {
    simd: S,
    m: S::m64s,
}

impl<S: Simd> Lane<S> {
    /// The same number in every place.
    #[inline(always)]
    pub fn splat(simd: S, x: f64) -> Self {
        Self { simd, x: simd.splat_f64s(x) }
    }

    /// Numbers as the instruction set holds them.
    #[inline(always)]
    pub fn of(simd: S, x: S::f64s) -> Self {
        Self { simd, x }
    }

    /// The first numbers of a slice, zero beyond its end.
    #[inline(always)]
    pub fn load(simd: S, from: &[f64]) -> Self {
        let (whole, rest) = S::as_simd_f64s(from);
        match whole.first() {
            Some(x) => Self { simd, x: *x },
            None => Self { simd, x: simd.partial_load_f64s(rest) },
        }
    }

    /// Writes the numbers to the front of a slice, as many as it has places for.
    #[inline(always)]
    pub fn store(self, to: &mut [f64]) {
        let (whole, rest) = S::as_mut_simd_f64s(to);
        match whole.first_mut() {
            Some(place) => *place = self.x,
            None => self.simd.partial_store_f64s(rest, self.x),
        }
    }

    /// The same number as another constant.
    #[inline(always)]
    #[must_use]
    pub fn constant(self, x: f64) -> Self {
        Self::splat(self.simd, x)
    }

    /// The numbers one by one.
    #[inline(always)]
    pub fn as_slice(&self) -> &[f64] {
        pulp::bytemuck::cast_slice(std::slice::from_ref(&self.x))
    }

    /// A function of each number, one after the other.
    #[inline(always)]
    #[must_use]
    pub fn each(mut self, f: impl Fn(f64) -> f64) -> Self {
        let numbers: &mut [f64] = pulp::bytemuck::cast_slice_mut(std::slice::from_mut(&mut self.x));
        for x in numbers {
            *x = f(*x);
        }
        self
    }

    /// A function of each number and that of another lane, one after the other.
    #[inline(always)]
    #[must_use]
    pub fn zip(mut self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let numbers: &mut [f64] = pulp::bytemuck::cast_slice_mut(std::slice::from_mut(&mut self.x));
        for (x, y) in numbers.iter_mut().zip(other.as_slice()) {
            *x = f(*x, *y);
        }
        self
    }

    /// One over the number.
    #[inline(always)]
    #[must_use]
    pub fn recip(self) -> Self {
        self.constant(1.0) / self
    }

    /// Square root.
    #[inline(always)]
    #[must_use]
    pub fn sqrt(self) -> Self {
        Self { x: self.simd.sqrt_f64s(self.x), ..self }
    }

    /// Absolute value; of -0 it is -0.
    #[inline(always)]
    #[must_use]
    pub fn abs(self) -> Self {
        self.lt(self.constant(0.0)).select(-self, self)
    }

    /// The larger number.
    #[inline(always)]
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        self.lt(other).select(other, self)
    }

    /// The smaller number.
    #[inline(always)]
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        self.lt(other).select(self, other)
    }

    /// Where the number is less than another; never for NaN.
    #[inline(always)]
    pub fn lt(self, other: Self) -> Mask<S> {
        Mask { simd: self.simd, m: self.simd.less_than_f64s(self.x, other.x) }
    }

    /// Where the number is at most another; never for NaN.
    #[inline(always)]
    pub fn le(self, other: Self) -> Mask<S> {
        Mask { simd: self.simd, m: self.simd.less_than_or_equal_f64s(self.x, other.x) }
    }

    /// Where the number is greater than another; never for NaN.
    #[inline(always)]
    pub fn gt(self, other: Self) -> Mask<S> {
        other.lt(self)
    }
}

impl<S: Simd> Mask<S> {
    /// One number where true, another where false.
    #[inline(always)]
    pub fn select(self, yes: Lane<S>, no: Lane<S>) -> Lane<S> {
        Lane { x: self.simd.select_f64s(self.m, yes.x, no.x), ..yes }
    }

    /// 1 where true, 0 where false.
    #[inline(always)]
    pub fn to_numbers(self) -> Lane<S> {
        let one = Lane::splat(self.simd, 1.0);
        self.select(one, one.constant(0.0))
    }

    /// True if true anywhere.
    #[inline(always)]
    pub fn any(self) -> bool {
        self.simd.first_true_m64s(self.m) < S::F64_LANES
    }

    /// Writes the answers to the front of a slice, as many as it has places for.
    #[inline(always)]
    pub fn store(self, to: &mut [bool]) {
        for (to, x) in to.iter_mut().zip(self.to_numbers().as_slice()) {
            *to = *x > 0.5;
        }
    }
}

macro_rules! lanewise {
    ($($trait:ident $method:ident $lanes:ident;)*) => {$(
        impl<S: Simd> $trait for Lane<S> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self { x: self.simd.$lanes(self.x, other.x), ..self }
            }
        }

        impl<S: Simd> $trait<f64> for Lane<S> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: f64) -> Self {
                self.$method(self.constant(other))
            }
        }
    )*};
}

lanewise! {
    Add add add_f64s;
    Sub sub sub_f64s;
    Mul mul mul_f64s;
    Div div div_f64s;
}

impl<S: Simd> Neg for Lane<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        // The same for every number; the negation of pulp is a call.
        self.constant(-0.0) - self
    }
}

macro_rules! maskwise {
    ($($trait:ident $method:ident $masks:ident;)*) => {$(
        impl<S: Simd> $trait for Mask<S> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self { m: self.simd.$masks(self.m, other.m), ..self }
            }
        }
    )*};
}

maskwise! {
    BitAnd bitand and_m64s;
    BitOr bitor or_m64s;
}

impl<S: Simd> Not for Mask<S> {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        Self { m: self.simd.not_m64s(self.m), ..self }
    }
}
