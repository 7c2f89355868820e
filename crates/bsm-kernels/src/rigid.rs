//! Rigid model, vectorized over the points of a block. The kernel solves the model directly, by an
//! iteration for the directions of friction.
//!
//! Theory: `docs/theory/04-rigid.md`, the section on direct sweeps.

use bsm_case::units::DEG;
use bsm_case::{InputKey, SolutionOutput};
use bsm_dyn::Model;
use bsm_dyn::lanes::{Plane, RigidBall, friction_angle};
use bsm_kin::Real;
use bsm_simd::Simd;

use crate::inputs::{Lane, LaneInputs, Mask};
use crate::kernel::{Kernel, Sink};
use crate::units::Units;

/// Outputs for the directions of friction. They are calculated only on request, because each
/// direction requires an arctangent.
const DIRECTIONS: [SolutionOutput; 3] = [
    SolutionOutput::nut_slip_angle_deg,
    SolutionOutput::screw_slip_angle_deg,
    SolutionOutput::unloaded_flank_slip_angle_deg,
];

/// Returns the directions of friction at nut and screw \[rad\], or `None` if no output needs them.
/// The arguments `nut` and `screw` are the friction components across the groove and along the
/// helix.
#[inline(always)]
pub(super) fn slip_angles<S: Simd>(
    out: &Sink<'_, '_>,
    [nut, screw]: [Plane<Lane<S>>; 2],
) -> Option<[Lane<S>; 2]> {
    if !out.wants(&DIRECTIONS) {
        return None;
    }
    Some([friction_angle(nut), friction_angle(screw)])
}

pub(super) struct RigidKernel;

impl Kernel for RigidKernel {
    const MODEL: Model = Model::Rigid;

    #[inline(always)]
    fn solve<S: Simd>(&self, given: &LaneInputs<'_, S>, out: &mut Sink<'_, '_>) -> Mask<S> {
        let si = Units::of(given);
        let (friction, zero) = (given.get(InputKey::friction_coefficient), si.speed.constant(0.0));
        let signed = si.speed.below(0.0).select(-friction, friction);
        let (radius, nut_speed) = (si.pitch / si.ball, si.nut_speed / si.speed);
        let ball = RigidBall::new(given.sines(), radius, si.mass, nut_speed, signed);
        let first = ball.first_order();
        let swept = ball.fixed_point(&first);
        let found = ball.is_covered() & first.is_accurate() & swept.is_root();
        if !found.any() {
            return found;
        }
        let angle = given.get(InputKey::contact_angle_deg) * DEG;
        let solved =
            ball.steady_state(&swept.motion, &si.result_units(), angle, out.wants(&DIRECTIONS));
        out.store(&solved);
        out.set(SolutionOutput::iterations, swept.count);
        out.set(SolutionOutput::residual_norm, swept.residual);
        // Unless the solution is known to be unique, the number of further solutions is unknown
        // (NaN), because the kernel does not search for them.
        let others = first.is_unique.select(zero, zero.constant(f64::NAN));
        out.set(SolutionOutput::other_solutions, others);
        found & solved.transmission.is_balanced()
    }
}
