//! Transition of the friction coefficient of an oil: the position on a chord of a contact ellipse
//! at which the slope of the coefficient changes.
//!
//! Theory: `docs/theory/17-lubricant.md`, equation (Y34).

use std::f64::consts::FRAC_PI_2;

use bsm_simd::{Lane, Simd};

use crate::contact::lubricant::oil::PRESSURE_SLOPE;

/// Lower limit of the argument of the logarithm, which prevents a logarithm of zero.
const TINY: f64 = 1e-300;

/// Transition of the friction coefficient along a chord of a contact ellipse. It occurs at the
/// pressure at which the shear stress of the oil reaches about half of the Eyring stress.
#[derive(Debug, Clone, Copy)]
pub struct Transition {
    /// Twice the argument of the inverse hyperbolic sine in (Y11) at a slip speed of one.
    pub(super) shear: f64,
    /// Pressure parameter `$a_p$` divided by the maximum pressure.
    pub(super) scale: f64,
}

impl Transition {
    /// Transition for a friction coefficient that varies slowly with pressure.
    pub(crate) const SMOOTH: Self = Self { shear: 1.0, scale: 1.0 };

    /// Returns the pressure at the transition for a given slip speed, and the distance from this
    /// pressure to the complex poles of the friction coefficient. Both are divided by the maximum
    /// pressure on the chord.
    ///
    /// * `square`: square of the slip speed.
    /// * `part`: maximum pressure on the chord, divided by the maximum pressure in the contact.
    #[inline(always)]
    pub(crate) fn line_pressure<S: Simd>(
        &self,
        square: Lane<S>,
        part: Lane<S>,
    ) -> (Lane<S>, Lane<S>) {
        let one = square.constant(1.0);
        // p* = a_p l/(1 − b_p l),  l = −ln[2 η s/(h τ_E)]                 (Y34)
        let log = (square * (self.shear * self.shear)).max(one.constant(TINY)).ln() * -0.5;
        let log = log.max(one.constant(0.0)).min(one.constant(40.0));
        let room = (-(log * PRESSURE_SLOPE) + 1.0).recip();
        let largest = part.max(one.constant(1e-4)).recip() * self.scale;
        // In the variable l, the complex poles are at a distance of π/2. The factor
        // dp*/dl = a_p/(1 − b_p l)² converts this distance to pressure.
        (log * room * largest, room * room * largest * FRAC_PI_2)
    }
}
