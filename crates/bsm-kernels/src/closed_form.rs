//! Closed-form model, vectorized over the points of a block, Eqs (C1) to (C11).

use bsm_case::units::{DEG, MM};
use bsm_case::{InputKey, SolutionOutput};
use bsm_dyn::lanes::transmitted;
use bsm_dyn::{
    Load, Model,
    solution::{BallState, ScrewSize},
};
use bsm_kin::Real;
use bsm_simd::Simd;

use crate::inputs::{Lane, LaneInputs, Mask};
use crate::kernel::{Kernel, Sink};

pub(super) struct ClosedFormKernel;

impl Kernel for ClosedFormKernel {
    const MODEL: Model = Model::ClosedForm;

    #[inline(always)]
    fn solve<S: Simd>(&self, given: &LaneInputs<'_, S>, out: &mut Sink<'_, '_>) -> Mask<S> {
        let sines = given.sines();
        let f = given.get(InputKey::friction_coefficient);
        let back = is_back_driving(given);
        let mut ball = BallState::at_angle(given.get(InputKey::contact_angle_deg) * DEG);
        if out.wants(&[SolutionOutput::nut_slip_angle_deg, SolutionOutput::screw_slip_angle_deg]) {
            let [nut, screw] = sines.slip_angles(back);
            (ball.nut.slip_angle, ball.screw.slip_angle) = (Some(nut), Some(screw));
        }
        let found = (sines.efficiency(back, f), sines.self_locking(back, f));
        let (ratio, lead) = (sines.load_ratio(back, f), (back, sines.tan_a()));
        out.store(&transmitted(ball, found, ratio, screw_size(given), lead));
        f.mask(true)
    }
}

/// Returns a mask that is true for points at which the load back-drives the screw. If the speeds
/// are missing, the mask is false for all points.
#[inline(always)]
pub(super) fn is_back_driving<S: Simd>(given: &LaneInputs<'_, S>) -> Mask<S> {
    let zero = Lane::splat(given.simd, 0.0);
    given.drive().map_or(zero.mask(false), |drive| drive.relative_speed().below(0.0))
}

/// Returns pitch circle radius, load and speed of the screw, or `None` if radius or load is
/// missing.
#[inline(always)]
pub(super) fn screw_size<S: Simd>(given: &LaneInputs<'_, S>) -> Option<ScrewSize<Lane<S>>> {
    let pitch_radius = given.try_get(InputKey::pitch_circle_diameter_mm)? * (0.5 * MM);
    let axial = given.try_get(InputKey::axial_load_N)?;
    let load = Load { axial, balls: given.try_get(InputKey::loaded_balls)? };
    let mut size = ScrewSize { pitch_radius, load, relative_speed: None };
    if let Some(drive) = given.drive() {
        size.relative_speed = Some(drive.relative_speed());
    }
    Some(size)
}
