//! Lin's closed form by lanes, Eqs (C1) to (C11).

use bsm_case::units::{MM, direction_deg};
use bsm_case::{InputKey, OutputKey};
use bsm_dyn::Model;
use bsm_dyn::balance::{Power, efficiency, ideal_torque};
use bsm_simd::Simd;

use crate::operand::{Lane, LaneInputs, Mask};
use crate::{Kernel, Sink};

pub(super) struct ClosedForm;

impl Kernel for ClosedForm {
    const MODEL: Model = Model::ClosedForm;

    #[inline(always)]
    fn solve<S: Simd>(&self, given: &LaneInputs<'_, S>, out: &mut Sink<'_, '_>) -> Mask<S> {
        let sines = given.sines();
        let f = given.get(InputKey::friction_coefficient);
        let back = backwards(given);
        let (eta, ratio) = (sines.efficiency(back, f), sines.load_ratio(back, f));

        out.set(OutputKey::efficiency, eta);
        contact_angles(given, out);
        if out.wants(&[OutputKey::nut_slip_angle_deg, OutputKey::screw_slip_angle_deg]) {
            let [nut, screw] = sines.slip_angles(back);
            let angles = [nut.each(direction_deg), screw.each(direction_deg)];
            out.set_all(OutputKey::nut_slip_angle_deg, angles);
        }
        out.set_flag(OutputKey::self_locking, sines.self_locking(back, f));
        transmit(given, out, (back, sines.tan_a()), (eta, ratio));
        let zero = f.constant(0.0);
        zero.le(zero)
    }
}

/// Where the load drives; nowhere without a speed.
#[inline(always)]
pub(super) fn backwards<S: Simd>(given: &LaneInputs<'_, S>) -> Mask<S> {
    let zero = Lane::splat(given.simd, 0.0);
    given.drive().map_or(zero.lt(zero), |drive| drive.relative_speed().lt(zero))
}

/// Contact angles that are given.
#[inline(always)]
pub(super) fn contact_angles<S: Simd>(given: &LaneInputs<'_, S>, out: &mut Sink<'_, '_>) {
    let angle = given.get(InputKey::contact_angle_deg);
    out.set_all(OutputKey::nut_contact_angle_deg, [angle; 2]);
}

/// Torque, loads and powers, if size and load are given; none where the screw cannot be turned.
///
/// * `ratio`: normal load over axial load per ball.
#[inline(always)]
pub(super) fn transmit<S: Simd>(
    given: &LaneInputs<'_, S>,
    out: &mut Sink<'_, '_>,
    (back, tan_a): (Mask<S>, Lane<S>),
    (eta, ratio): (Lane<S>, Lane<S>),
) {
    let (Some(pitch), Some(load), Some(balls)) = (
        given.try_get(InputKey::pitch_circle_diameter_mm),
        given.try_get(InputKey::axial_load_N),
        given.try_get(InputKey::loaded_balls),
    ) else {
        return;
    };
    let zero = eta.constant(0.0);
    let turns = (back | eta.gt(zero)) & ratio.gt(zero) & ratio.lt(zero.constant(f64::INFINITY));
    let none = zero.constant(f64::NAN);
    let normal = turns.select(ratio * load / balls, none);
    out.set_all(OutputKey::nut_normal_load_N, [normal; 2]);
    let ideal = ideal_torque(load, pitch * (0.5 * MM), tan_a);
    let torque = turns.select(back.select(ideal * eta, ideal / eta), none);
    out.set(OutputKey::ball_torque_Nm, torque);
    if let Some(drive) = given.drive() {
        powers(out, (torque, ideal), drive.relative_speed());
    }
}

/// Efficiency, self-locking, torque and powers of a torque on the screw and of that of the
/// frictionless screw, both over `unit`; returns the efficiency.
#[inline(always)]
pub(super) fn transmit_torque<S: Simd>(
    out: &mut Sink<'_, '_>,
    back: Mask<S>,
    (torque, ideal): (Lane<S>, Lane<S>),
    unit: Lane<S>,
    speed: Lane<S>,
) -> Lane<S> {
    let eta = efficiency(back, ideal, torque);
    out.set_all(OutputKey::efficiency, [eta, torque * unit]);
    out.set_flag(OutputKey::self_locking, eta.le(eta.constant(0.0)));
    powers(out, (torque * unit, ideal * unit), speed);
    eta
}

/// Stores the violation of the power balance by a friction power, all over the same unit, and returns it.
///
/// * `speed`: its sign tells which side drives.
#[inline(always)]
pub(super) fn power_balance<S: Simd>(
    out: &mut Sink<'_, '_>,
    speed: Lane<S>,
    (torque, ideal): (Lane<S>, Lane<S>),
    lost: Lane<S>,
) -> Lane<S> {
    let (zero, one) = (speed.constant(0.0), speed.constant(1.0));
    let sign = speed.lt(zero).select(-one, one);
    let imbalance = Power::transmitted(torque, ideal, sign).imbalance(lost);
    out.set(OutputKey::power_balance, imbalance);
    imbalance
}

/// Powers of a torque on the screw and of that of the frictionless screw.
#[inline(always)]
fn powers<S: Simd>(out: &mut Sink<'_, '_>, (torque, ideal): (Lane<S>, Lane<S>), speed: Lane<S>) {
    // Not a number where there is no torque.
    let Power { input, output, dissipated } =
        Power::transmitted(torque, ideal + torque * 0.0, speed);
    out.set_all(OutputKey::input_power_W, [input, output, dissipated]);
}
