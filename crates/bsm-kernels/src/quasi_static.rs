//! Quasi-static model, vectorized over the points of a block, Eqs (Q1) to (Q4).

use bsm_case::InputKey;
use bsm_case::units::DEG;
use bsm_dyn::lanes::transmitted;
use bsm_dyn::{Model, gothic::TwoContacts, solution::BallState};
use bsm_kin::Real;
use bsm_simd::Simd;

use crate::closed_form::{is_back_driving, screw_size};
use crate::inputs::{LaneInputs, Mask};
use crate::kernel::{Kernel, Sink};

pub(super) struct QuasiStaticKernel;

impl Kernel for QuasiStaticKernel {
    const MODEL: Model = Model::QuasiStatic;

    #[inline(always)]
    fn solve<S: Simd>(&self, given: &LaneInputs<'_, S>, out: &mut Sink<'_, '_>) -> Mask<S> {
        let ball = given.get(InputKey::ball_diameter_mm);
        let (back, zero) = (is_back_driving(given), ball.constant(0.0));
        let sign = back.select(zero.constant(-1.0), zero.constant(1.0));
        let contacts = TwoContacts {
            sines: given.sines(),
            friction: sign * given.get(InputKey::friction_coefficient),
            rolling_ratio: sign * given.get(InputKey::rolling_friction_mm) / (ball * 0.5),
            size_ratio: ball / given.get(InputKey::pitch_circle_diameter_mm),
            nut_turns: given
                .drive()
                .map_or(zero.mask(false), |drive| drive.screw_speed.abs().at_most(0.0)),
        };
        let (eta, ratio) = (contacts.efficiency(back), contacts.load_ratio());

        let ball = BallState::at_angle(given.get(InputKey::contact_angle_deg) * DEG);
        let (found, lead) = ((eta, eta.at_most(0.0)), (back, contacts.sines.tan_a()));
        out.store(&transmitted(ball, found, ratio, screw_size(given), lead));
        ratio.above(0.0)
    }
}
