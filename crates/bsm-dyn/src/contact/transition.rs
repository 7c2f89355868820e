//! The position along a chord at which the friction coefficient of an oil changes its slope.
//!
//! Theory: `docs/theory/17-lubricant.md`, equation (Y34).

use std::f64::consts::FRAC_PI_2;

use bsm_simd::{Lane, Simd};

use crate::contact::lubricant::oil::PRESSURE_SLOPE;

/// Numbers below this limit are not used as divisors.
const TINY: f64 = 1e-300;

/// The transition of a friction coefficient along a line, at the pressure at which the oil
/// stiffens.
#[derive(Debug, Clone, Copy)]
pub struct Transition {
    /// Twice the argument of (Y11) for a slip of one.
    pub(super) shear: f64,
    /// `$a_p$` divided by the largest pressure.
    pub(super) scale: f64,
}

impl Transition {
    /// Transition of a coefficient that changes slowly with the pressure.
    pub(crate) const SMOOTH: Self = Self { shear: 1.0, scale: 1.0 };

    /// Returns the position of the transition for a slip, and the distance of its poles, as
    /// fractions of the largest pressure.
    ///
    /// * `square`: square of the slip.
    #[inline(always)]
    pub(crate) fn pressure<S: Simd>(&self, square: Lane<S>, part: Lane<S>) -> (Lane<S>, Lane<S>) {
        let one = square.constant(1.0);
        // p* = a_p l/(1 − b_p l),  l = −ln[2 η s/(h τ_E)]                 (Y34)
        let log = (square * (self.shear * self.shear)).max(one.constant(TINY)).ln() * -0.5;
        let log = log.max(one.constant(0.0)).min(one.constant(40.0));
        let room = (-(log * PRESSURE_SLOPE) + 1.0).recip();
        let largest = part.max(one.constant(1e-4)).recip() * self.scale;
        // The poles are π/2 away in l: dp*/dl = a_p/(1 − b_p l)²
        (log * room * largest, room * room * largest * FRAC_PI_2)
    }
}
