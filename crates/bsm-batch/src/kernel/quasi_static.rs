//! Two contacts without inertia by lanes, Eqs (Q1) to (Q4).

use bsm_case::{InputKey, OutputKey};
use bsm_dyn::Model;
use bsm_simd::Simd;

use super::closed_form::{Transmitted, backwards, contact_angles, transmit};
use super::{Kernel, Out};
use crate::operand::{Given, Mask};

pub(super) struct QuasiStatic;

impl Kernel for QuasiStatic {
    const MODEL: Model = Model::QuasiStatic;

    #[inline(always)]
    fn solve<S: Simd>(&self, given: &Given<'_, S>, out: &mut Out<'_, '_>) -> Mask<S> {
        let (sin_a, cos_a) = given.lead();
        let (sin_b, cos_b) = given.sin_cos(InputKey::contact_angle_deg);
        let ball = given.get(InputKey::ball_diameter_mm);
        let size = ball / given.get(InputKey::pitch_circle_diameter_mm);
        let (back, zero) = (backwards(given), ball.constant(0.0));
        let sign = back.select(zero.constant(-1.0), zero.constant(1.0));
        let f = sign * given.get(InputKey::friction_coefficient);
        // tanρ = f_r / (r_b sinβ)                                         (Q1)
        let rolling = sign * given.get(InputKey::rolling_friction_mm);
        let tan_rho = rolling / (ball * 0.5) / sin_b;
        let nut_turns = given.speeds().map_or(zero.lt(zero), |(screw, _)| screw.abs().le(zero));
        // f r_b/r_m,  r_b/r_m − cosβ  or  f (r_b/r_m + 2 cosβ),  r_b/r_m + cosβ  (Q2), (Q3)
        let loss = f * nut_turns.select(size + cos_b * 2.0, size);
        let lever = nut_turns.select(size + cos_b, size - cos_b);
        let forward = zero.constant(1.0)
            - (loss + tan_rho / (cos_a * sin_a)) / (sin_b + f * lever + tan_rho * cos_a / sin_a);
        let eta = back.select(forward.recip(), forward);
        // Q/F_a = 1 / [cosα (sinβ − f cosβ) − sinα tanρ]                  (Q4)
        let ratio = (cos_a * (sin_b - f * cos_b) - sin_a * tan_rho).recip();

        out.set(OutputKey::efficiency, eta);
        contact_angles(given, out);
        out.set_flag(OutputKey::self_locking, eta.le(zero));
        transmit(given, out, &Transmitted { back, tan_a: sin_a / cos_a, eta, ratio });
        ratio.gt(zero)
    }
}
