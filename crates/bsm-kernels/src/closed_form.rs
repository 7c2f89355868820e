//! Lin's closed form by lanes, Eqs (C1) to (C11).

use bsm_case::units::{MM, direction_deg};
use bsm_case::{InputKey, OutputKey};
use bsm_dyn::internals::{ideal_torque, torque_of, turns};
use bsm_dyn::{Model, Power, Transmission};
use bsm_simd::Simd;

use crate::kernel::{Kernel, Sink};
use crate::operand::{Lane, LaneInputs, Mask};

pub(super) struct ClosedForm;

impl Kernel for ClosedForm {
    const MODEL: Model = Model::ClosedForm;

    #[inline(always)]
    fn solve<S: Simd>(&self, given: &LaneInputs<'_, S>, out: &mut Sink<'_, '_>) -> Mask<S> {
        let sines = given.sines();
        let f = given.get(InputKey::friction_coefficient);
        let back = backwards(given);
        let (eta, ratio) = (sines.efficiency(back, f), sines.load_ratio(back, f));

        contact_angles(given, out);
        if out.wants(&[OutputKey::nut_slip_angle_deg, OutputKey::screw_slip_angle_deg]) {
            let [nut, screw] = sines.slip_angles(back);
            let angles = [nut.each(direction_deg), screw.each(direction_deg)];
            out.set_all(OutputKey::nut_slip_angle_deg, angles);
        }
        let locks = sines.self_locking(back, f);
        transmit(given, out, (back, sines.tan_a()), (eta, locks), ratio);
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

/// Efficiency and, if size and load are given, torque, loads and powers; none where the screw cannot be turned.
///
/// * `ratio`: normal load over axial load per ball.
#[inline(always)]
pub(super) fn transmit<S: Simd>(
    given: &LaneInputs<'_, S>,
    out: &mut Sink<'_, '_>,
    (back, tan_a): (Mask<S>, Lane<S>),
    (efficiency, self_locking): (Lane<S>, Mask<S>),
    ratio: Lane<S>,
) {
    let mut of = Transmission {
        efficiency,
        self_locking,
        screw_torque: None,
        power: None,
        power_balance: None,
    };
    if let (Some(pitch), Some(load), Some(balls)) = (
        given.try_get(InputKey::pitch_circle_diameter_mm),
        given.try_get(InputKey::axial_load_N),
        given.try_get(InputKey::loaded_balls),
    ) {
        let (turns, none) = (turns(back, efficiency, ratio), ratio.constant(f64::NAN));
        let normal = turns.select(ratio * load / balls, none);
        out.set_all(OutputKey::nut_normal_load_N, [normal; 2]);
        let ideal = turns.select(ideal_torque(load, pitch * (0.5 * MM), tan_a), none);
        let torque = torque_of(back, ideal, efficiency);
        of.screw_torque = Some(torque);
        if let Some(drive) = given.drive() {
            of.power = Some(Power::transmitted(torque, ideal, drive.relative_speed()));
        }
    }
    transmission(out, &of);
}

/// Stores what a torque on the screw and that of the frictionless screw make, over `unit`, and returns it.
///
/// * `lost`: friction power over `unit` and the size of the speed.
#[inline(always)]
pub(super) fn balance<S: Simd>(
    out: &mut Sink<'_, '_>,
    speed: Lane<S>,
    (torque, ideal): (Lane<S>, Lane<S>),
    lost: Lane<S>,
    unit: Lane<S>,
) -> Transmission<Lane<S>> {
    let (zero, one) = (speed.constant(0.0), speed.constant(1.0));
    let back = speed.lt(zero);
    let scaled = Transmission::of(back, ideal, torque, back.select(-one, one)).against(lost);
    let power = Some(Power::transmitted(torque * unit, ideal * unit, speed));
    let of = Transmission { screw_torque: Some(torque * unit), power, ..scaled };
    transmission(out, &of);
    of
}

/// Stores efficiency, self-locking, torque and powers.
#[inline(always)]
pub(super) fn transmission<S: Simd>(out: &mut Sink<'_, '_>, of: &Transmission<Lane<S>>) {
    out.set(OutputKey::efficiency, of.efficiency);
    out.set_flag(OutputKey::self_locking, of.self_locking);
    if let Some(torque) = of.screw_torque {
        out.set(OutputKey::ball_torque_Nm, torque);
    }
    if let Some(Power { input, output, dissipated }) = of.power {
        out.set_all(OutputKey::input_power_W, [input, output, dissipated]);
    }
    if let Some(imbalance) = of.power_balance {
        out.set(OutputKey::power_balance, imbalance);
    }
}
