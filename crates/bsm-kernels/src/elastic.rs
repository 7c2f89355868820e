//! Saturated friction on elastic contacts by lanes: the beginning of the curve of all states of force, up to where the
//! inertia falls.

use bsm_case::{InputKey, OutputKey};
use bsm_dyn::Model;
use bsm_dyn::internals::{SlidingBall, SlidingRoot, ideal_torque, takes};
use bsm_kin::{relative_rotation, spin_at_nut};
use bsm_simd::{NullaryFnOnce, Simd};

use crate::closed_form::balance;
use crate::contacts::{ContactRow, Contacts, InUnits};
use crate::kernel::{Kernel, Sink};
use crate::operand::{Lane, LaneInputs, Mask};
use crate::rigid::{ball_motion, slip_angle};
use crate::units::Units;

pub(super) struct Elastic;

/// Loads over the axial load beyond which friction all but holds it, and rounding decides.
const MOST_LOAD: f64 = 1e3;

/// Speed of the nut over the relative speed, beyond which the residual of the model is the rounding of both speeds.
const MOST_NUT_SPEED: f64 = 1e4;

impl Kernel for Elastic {
    const MODEL: Model = Model::Elastic;

    #[inline(always)]
    fn solve<S: Simd>(&self, given: &LaneInputs<'_, S>, out: &mut Sink<'_, '_>) -> Mask<S> {
        let (units, contacts) = given.simd.vectorize(InUnits(given));
        let friction = given.get(InputKey::friction_coefficient);
        let back = units.speed.lt(friction.constant(0.0));
        let signed = back.select(-friction, friction);
        let skid =
            given.simd.vectorize(GrossSlip { contacts: &contacts, friction: signed, any: false });
        if !skid.found.any() {
            return skid.found;
        }
        let ([q_a, q_b], [sin_a, sin_b], [cos_a, cos_b]) =
            (skid.state.loads, skid.state.sin, skid.state.cos);
        let sides =
            [contacts.loaded(0, q_a, (sin_a, cos_a)), contacts.loaded(1, q_b, (sin_b, cos_b))];
        given.simd.vectorize(ContactRow { out, units: &units, contacts: &contacts, sides: &sides });
        let balanced = outputs(&skid, out, &units, &contacts);
        out.set_all(OutputKey::iterations, [skid.steps, skid.residual]);
        skid.found & balanced
    }
}

/// The first roots, if the inertia only rises up to them, of a friction with the sign of the speed: a call of its
/// own, as the code is long.
pub(super) struct GrossSlip<'a, S: Simd> {
    pub(super) contacts: &'a Contacts<S>,
    pub(super) friction: Lane<S>,
    /// One that serves as a start is enough.
    pub(super) any: bool,
}

impl<S: Simd> NullaryFnOnce for GrossSlip<'_, S> {
    type Output = SlidingRoot<Lane<S>>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        let Self { contacts, friction, any } = self;
        let ball = SlidingBall::of(&contacts.scaled, friction);
        let expected = contacts.regular
            & takes(friction.abs(), contacts.scaled.inertia_ratio())
            & contacts.scaled.nut_speed.abs().lt(contacts.constant(MOST_NUT_SPEED));
        let root = ball.first_root(contacts.cos_b / contacts.sin_b, expected, any);
        let sure = root.state.push.lt(contacts.constant(MOST_LOAD));
        SlidingRoot { steady: root.steady & sure, found: root.found & sure, ..root }
    }
}

/// Stores motion, slips, torque, efficiency and powers, and returns where they balance.
#[inline(always)]
fn outputs<S: Simd>(
    skid: &SlidingRoot<Lane<S>>,
    out: &mut Sink<'_, '_>,
    units: &Units<S>,
    contacts: &Contacts<S>,
) -> Mask<S> {
    let (w, lead) = (units.speed, contacts.scaled.lead);
    let to_nut = skid.rotation();
    ball_motion(out, w, skid.rate, relative_rotation(to_nut, -contacts.scaled.nut_speed, lead));
    let ([sin_a, sin_b], [cos_a, cos_b]) = (skid.state.sin, skid.state.cos);
    let to_screw = relative_rotation(to_nut, contacts.constant(1.0), lead);
    let spins = [spin_at_nut(to_nut, (sin_a, cos_a)), -spin_at_nut(to_screw, (sin_b, cos_b))];
    out.set_all(OutputKey::nut_spin_rad_s, [spins[0] * w, spins[1] * w]);
    let ([v_a, v_b], speed) = (skid.motion.slip, w.abs() * units.ball);
    out.set_all(OutputKey::nut_slip_velocity_m_s, [v_a * speed, v_b * speed]);
    let [at_nut, at_screw] = skid.friction();
    slip_angle(out, OutputKey::nut_slip_angle_deg, at_nut);
    slip_angle(out, OutputKey::screw_slip_angle_deg, at_screw);
    let ideal = ideal_torque(contacts.constant(1.0), contacts.scaled.arc * lead.1, lead.0 / lead.1);
    let torques = (skid.torque(), ideal);
    balance(out, w, torques, skid.friction_power(), units.ball * units.axial).is_balanced()
}
