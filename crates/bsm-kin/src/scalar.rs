//! The one place that names the traits of the dual-number crate.

use num_dual::{DualNum, DualNumCopy};

/// Scalar of every equation: `f64`, or a dual number that carries derivatives.
pub trait Scalar: DualNumCopy + DualNum<Primitive = f64> {}

impl<T: DualNumCopy + DualNum<Primitive = f64>> Scalar for T {}
