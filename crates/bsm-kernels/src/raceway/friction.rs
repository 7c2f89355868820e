//! Friction power of rolling ellipses by lanes, Eqs (T12) to (T19), (E6), (P7).

use std::sync::LazyLock;

use bsm_dyn::internals::power_of_many;
use bsm_dyn::{EllipseSlip, Quadrature, RacewayControl};
use bsm_simd::Simd;

use crate::operand::{Lane, Mask};

static RULE: LazyLock<Quadrature> = LazyLock::new(|| Quadrature::of(RacewayControl::ACCURACY));

/// A rolling ellipse in units of ball radius and relative speed.
#[derive(Clone, Copy)]
pub(super) struct Ellipse<S: Simd> {
    /// `$Q/F_a$`.
    pub(super) load: Lane<S>,
    /// Across and along the groove.
    pub(super) semi_axes: (Lane<S>, Lane<S>),
    pub(super) pressed_radius: Lane<S>,
    /// Speed of the centre along `$t$`; angular velocity about `$t$`, `$N$` and `$t \times N$`.
    pub(super) speed: Lane<S>,
    pub(super) omega: [Lane<S>; 3],
}

impl<S: Simd> Ellipse<S> {
    /// Power over `$f Q$`, and where it is resolved; the model has finer panels elsewhere.
    #[inline(always)]
    pub(super) fn power(&self) -> (Lane<S>, Mask<S>) {
        let (one, creep) = (self.load.constant(1.0), self.load.constant(RacewayControl::CREEP));
        let radii = (self.pressed_radius, one);
        let slip = EllipseSlip::new(self.semi_axes, radii, self.speed, self.omega, creep);
        power_of_many(&RULE, &slip)
    }
}
