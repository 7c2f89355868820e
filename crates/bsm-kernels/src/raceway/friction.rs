//! Friction power in rolling contact ellipses, vectorized over the points of a block, Eqs (T12) to
//! (T19), (E6), (P7).

use std::sync::LazyLock;

use bsm_dyn::lanes::{Patch, lubricated_powers, power_of_many};
use bsm_dyn::{
    hertz::Quadrature,
    lubrication::MixedFriction,
    model::{RacewayControl, Traction},
};
use bsm_simd::Simd;

use crate::inputs::{Lane, Mask};

static RULE: LazyLock<Quadrature> = LazyLock::new(|| Quadrature::of(RacewayControl::ACCURACY));

/// Quadrature rules for lubricated friction, and for dry friction with a constant coefficient.
static RULES: LazyLock<[Quadrature; 2]> =
    LazyLock::new(|| [Quadrature::of_oil(Traction::ACCURACY), Quadrature::of(Traction::ACCURACY)]);

/// A rolling contact ellipse. Its quantities are nondimensionalized with the ball radius, the
/// relative speed and the axial load per ball.
#[derive(Clone, Copy)]
pub(super) struct Ellipse<S: Simd> {
    /// Normal load, `$Q/F_a$`.
    pub(super) load: Lane<S>,
    /// Semi-axes of the ellipse, across and along the groove.
    pub(super) semi_axes: (Lane<S>, Lane<S>),
    pub(super) pressed_radius: Lane<S>,
    /// Speed of the ball center along `$t$`, and angular velocities about `$t$`, `$N$` and `$t
    /// \times N$`.
    pub(super) speed: Lane<S>,
    pub(super) omega: [Lane<S>; 3],
}

impl<S: Simd> Ellipse<S> {
    #[inline(always)]
    fn patch(&self) -> Patch<Lane<S>> {
        let Self { semi_axes, pressed_radius, speed, omega: [w_t, w_n, w_c], .. } = *self;
        let (ball_radius, creep) = (speed.constant(1.0), speed.constant(RacewayControl::CREEP));
        Patch { semi_axes, pressed_radius, ball_radius, motion: [speed, w_t, w_n, w_c], creep }
    }

    /// Returns the friction power divided by `$f Q$`, and a mask that is true for points at which
    /// the quadrature panels are fine enough. For all other points, the scalar solver uses finer
    /// panels.
    #[inline(always)]
    pub(super) fn power(&self) -> (Lane<S>, Mask<S>) {
        power_of_many(&RULE, &self.patch().slip())
    }

    /// Returns the friction powers at nut and screw, divided by `$Q$`. The first pair of powers is
    /// calculated with lubricant films, and the second with a friction coefficient of one.
    #[inline(always)]
    pub(super) fn lubricated_powers(
        simd: S,
        [nut, screw]: [&Self; 2],
        laws: [&MixedFriction<Lane<S>>; 2],
        wanted: Mask<S>,
    ) -> [[Lane<S>; 2]; 2] {
        lubricated_powers(simd, &[nut.patch(), screw.patch()], laws, wanted, RULES.each_ref())
    }
}
