//! The published steady-state equations by lanes: direct sweeps.
//!
//! Theory: `docs/theory/04-rigid.md`, section on direct sweeps.

use bsm_case::units::direction_deg;
use bsm_case::{InputKey, OutputKey};
use bsm_dyn::Model;
use bsm_dyn::internals::{Plane, RigidBall, RigidMotion, friction_angle};
use bsm_simd::Simd;

use crate::closed_form::{balance, contact_angles};
use crate::kernel::{Kernel, Sink};
use crate::operand::{Lane, LaneInputs, Mask};
use crate::units::Units;

pub(super) struct Rigid;

impl Kernel for Rigid {
    const MODEL: Model = Model::Rigid;

    #[inline(always)]
    fn solve<S: Simd>(&self, given: &LaneInputs<'_, S>, out: &mut Sink<'_, '_>) -> Mask<S> {
        let si = Units::of(given);
        let (friction, zero) = (given.get(InputKey::friction_coefficient), si.speed.constant(0.0));
        let signed = si.speed.lt(zero).select(-friction, friction);
        let (radius, nut_speed) = (si.pitch / si.ball, si.nut_speed / si.speed);
        let ball = RigidBall::new(given.sines(), radius, si.mass, nut_speed, signed);
        let first = ball.first_order();
        let swept = ball.sweeps(&first);
        let found = ball.is_covered() & swept.converged & swept.motion.is_admissible();
        if !found.any() {
            return found;
        }
        let balanced = outputs(out, &si, &ball, &swept.motion);
        contact_angles(given, out);
        out.set_all(OutputKey::iterations, [swept.count, swept.residual]);
        // Unknown where no search is made.
        let others = first.is_unique().select(zero, zero.constant(f64::NAN));
        out.set(OutputKey::other_solutions, others);
        found & balanced
    }
}

/// Stores what is wanted of a motion, and returns where its powers balance.
#[inline(always)]
fn outputs<S: Simd>(
    out: &mut Sink<'_, '_>,
    si: &Units<S>,
    ball: &RigidBall<Lane<S>>,
    motion: &RigidMotion<Lane<S>>,
) -> Mask<S> {
    let [q_a, q_m, q_b] = motion.loads;
    out.set_all(OutputKey::nut_normal_load_N, [q_a * si.load, q_b * si.load, q_m * si.load]);

    let unit = si.ball * si.axial;
    let (zero, one) = (unit.constant(0.0), unit.constant(1.0));
    let back = si.speed.lt(zero);
    let torques = (ball.torque(motion), ball.ideal_torque());
    let of = balance(out, si.speed, torques, ball.friction_power(motion), unit);

    let [v_a, v_m, v_b] = motion.speeds;
    let slip = si.speed.abs() * si.ball;
    out.set_all(OutputKey::nut_slip_velocity_m_s, [v_a * slip, v_b * slip, v_m * slip]);
    let [nut_spin, _, screw_spin] = ball.spins(motion);
    out.set_all(OutputKey::nut_spin_rad_s, [nut_spin * si.speed, screw_spin * si.speed]);
    ball_motion(out, si.speed, motion.rate, ball.angular_velocity(motion));

    let (against, [a, unloaded, b]) = (back.select(one, -one), motion.directions);
    slip_angle(out, OutputKey::nut_slip_angle_deg, [against * a[0], against * a[1]]);
    slip_angle(
        out,
        OutputKey::unloaded_flank_slip_angle_deg,
        [against * unloaded[0], against * unloaded[1]],
    );
    slip_angle(out, OutputKey::screw_slip_angle_deg, [against * b[0], against * b[1]]);
    of.is_balanced()
}

/// Stores precession and angular velocity of the ball, both over the relative speed.
#[inline(always)]
pub(super) fn ball_motion<S: Simd>(
    out: &mut Sink<'_, '_>,
    speed: Lane<S>,
    precession: Lane<S>,
    [t, n, b]: [Lane<S>; 3],
) {
    let motion = [precession * speed, t * speed, n * speed, b * speed];
    out.set_all(OutputKey::ball_precession_rad_s, motion);
}

/// Stores the direction of friction, by its parts across the groove and along the helix.
#[inline(always)]
pub(super) fn slip_angle<S: Simd>(
    out: &mut Sink<'_, '_>,
    key: OutputKey,
    friction: Plane<Lane<S>>,
) {
    if out.wants(&[key]) {
        out.set(key, friction_angle(friction).each(direction_deg));
    }
}
