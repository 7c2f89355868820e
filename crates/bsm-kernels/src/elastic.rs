//! Elastic model, vectorized over the points of a block.

use bsm_case::{InputKey, SolutionOutput};
use bsm_dyn::Model;
use bsm_dyn::lanes::{ElasticMotion, SlidingBall, SlidingRoot, SlidingState, ideal_torque};
use bsm_kin::{Real, relative_rotation, spin_at_nut};
use bsm_simd::{NullaryFnOnce, Simd};

use crate::contacts::{Contacts, ElasticResults, UnitsCall};
use crate::inputs::{Lane, LaneInputs, Mask};
use crate::kernel::{Kernel, Sink};
use crate::rigid::slip_angles;

pub(super) struct ElasticKernel;

impl Kernel for ElasticKernel {
    const MODEL: Model = Model::Elastic;

    #[inline(always)]
    fn solve<S: Simd>(&self, given: &LaneInputs<'_, S>, out: &mut Sink<'_, '_>) -> Mask<S> {
        let (units, contacts) = given.simd.vectorize(UnitsCall(given));
        let friction = given.get(InputKey::friction_coefficient);
        let back = units.speed.below(0.0);
        let signed = back.select(-friction, friction);
        let skid = given.simd.vectorize(GrossSlipCall { contacts: &contacts, friction: signed });
        if !skid.is_first_root.any() {
            return skid.is_first_root;
        }
        let SlidingState { loads, sin, cos, .. } = skid.at.state;
        let sides = [
            contacts.loaded(0, loads[0], (sin[0], cos[0])),
            contacts.loaded(1, loads[1], (sin[1], cos[1])),
        ];
        let (lead, to_nut) = (contacts.scaled.lead, skid.rotation());
        let to_screw = relative_rotation(to_nut, contacts.constant(1.0), lead);
        let spin =
            [spin_at_nut(to_nut, (sin[0], cos[0])), -spin_at_nut(to_screw, (sin[1], cos[1]))];
        let power = skid.friction_power();
        let ideal = ideal_torque(units.axial, units.pitch, lead.0 / lead.1);
        let transmission =
            &units.result_units().transmission(ideal, skid.torque(), back.select(-power, power));
        let slip_angles = slip_angles(out, skid.friction());
        let (slip, rate) = (skid.at.motion.slip, skid.rate);
        let motion =
            ElasticMotion { slip, spin, slip_angles, rate, to_nut, friction_in_balance: true };
        given.simd.vectorize(ElasticResults {
            out,
            units: &units,
            contacts: &contacts,
            sides: &sides,
            motion,
            transmission,
            error: None,
            film: None,
        });
        out.set(SolutionOutput::iterations, skid.steps);
        out.set(SolutionOutput::residual_norm, skid.residual);
        skid.is_first_root & transmission.is_balanced()
    }
}

/// Function object that calculates the direct solution of the elastic model. It is compiled as a
/// separate function because its code is long.
struct GrossSlipCall<'a, S: Simd> {
    contacts: &'a Contacts<S>,
    /// Friction coefficient, with the sign of the relative speed.
    friction: Lane<S>,
}

impl<S: Simd> NullaryFnOnce for GrossSlipCall<'_, S> {
    type Output = SlidingRoot<Lane<S>>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        let Self { contacts, friction } = self;
        let ball = SlidingBall::of(&contacts.scaled, friction);
        ball.direct_root(contacts.cos_b / contacts.sin_b, contacts.regular, false)
    }
}
