//! Raceway control by lanes.

mod balance;
mod friction;
mod oil;

use bsm_case::{InputKey, OutputKey};
use bsm_dyn::internals::{
    cross_slip, friction_power, ideal_torque, onset_number, rolling, rolling_torque, skid_number,
};
use bsm_dyn::{Ball, Control, Model, Transmission};
use bsm_kin::{relative_rotation, spin_at_nut};
use bsm_simd::{NullaryFnOnce, Simd};

pub(super) use self::balance::{BalanceCall, Precession};
use self::friction::Ellipse;
use self::oil::OilLane;
use crate::closed_form::transmission;
use crate::contacts::{ContactRow, Contacts, InUnits};
use crate::operand::{Lane, LaneInputs, Mask};
use crate::rigid::ball_motion;
use crate::units::Units;
use crate::{Kernel, Sink};

pub(super) struct Raceway {
    /// The controlling raceway; `None` decides by (W7).
    pub(super) control: Option<Control>,
}

impl Kernel for Raceway {
    const MODEL: Model = Model::RacewayControl;

    #[inline(always)]
    fn solve<S: Simd>(&self, given: &LaneInputs<'_, S>, out: &mut Sink<'_, '_>) -> Mask<S> {
        let (units, contacts) = given.simd.vectorize(InUnits(given));
        let control = self.control;
        let ball = given.simd.vectorize(RacewayRow {
            given,
            units: &units,
            contacts: &contacts,
            control,
            out,
        });
        ball.found & ball.unique
    }
}

/// The answers of a lane of points: a call of its own, as the choice by error bounds begins with them.
pub(super) struct RacewayRow<'a, 'b, 'c, 'd, S: Simd> {
    pub(super) given: &'a LaneInputs<'b, S>,
    pub(super) units: &'a Units<S>,
    pub(super) contacts: &'a Contacts<S>,
    pub(super) control: Option<Control>,
    pub(super) out: &'a mut Sink<'c, 'd>,
}

/// What the choice by error bounds asks of rolling balls.
pub(super) struct RacewayNumbers<S: Simd> {
    pub(super) efficiency: Lane<S>,
    /// Onset number and cross slip.
    pub(super) skid: [Lane<S>; 2],
    /// Where it is the first one, and where there is no other.
    pub(super) found: Mask<S>,
    pub(super) unique: Mask<S>,
}

impl<S: Simd> NullaryFnOnce for RacewayRow<'_, '_, '_, '_, S> {
    type Output = RacewayNumbers<S>;

    #[inline(always)]
    fn call(self) -> RacewayNumbers<S> {
        let Self { given, units, contacts, control, out } = self;
        let state = given.simd.vectorize(BalanceCall { contacts, control });
        let (zero, unique) = (state.residual.constant(0.0), state.unique);
        if !state.found.any() {
            return RacewayNumbers {
                efficiency: zero,
                skid: [zero; 2],
                found: state.found,
                unique,
            };
        }
        let motion = Motion::of(contacts, &state);
        let sides = &state.sides;
        given.simd.vectorize(ContactRow { out: &mut *out, units, contacts, sides });
        motion.outputs(out, units, contacts);
        let (resolved, efficiency, friction) =
            transmit(out, given, (units, contacts), (&state, &motion));
        let skid = regime(out, friction, (units, contacts), (&state, &motion));
        out.set_all(OutputKey::iterations, [state.steps, state.residual]);
        out.set(OutputKey::controlling_raceway, state.by_nut.select(zero, zero + 1.0));
        // With a lubricant the model looks for no other solutions.
        if given.inputs.lubricant.is_none() {
            if control.is_none() {
                out.set(OutputKey::control_consistent, zero + 1.0);
            }
            out.set_unique(zero);
        }
        RacewayNumbers { efficiency, skid, found: state.found & resolved, unique }
    }
}

/// Motion of the ball relative to the nut over `$W$`.
pub(super) struct Motion<S: Simd> {
    pub(super) p: Lane<S>,
    /// Angular velocity along n and b; along t it is `$\sin\alpha/2$` (W3).
    pub(super) omega: [Lane<S>; 2],
    /// Speed of the centre, relative to nut and screw; the ball turns about `$t \times N$` against it.
    speed: [Lane<S>; 2],
    /// Angular velocity about `$N$`, relative to nut and screw.
    spin: [Lane<S>; 2],
}

impl<S: Simd> Motion<S> {
    #[inline(always)]
    pub(super) fn of(contacts: &Contacts<S>, state: &Precession<S>) -> Self {
        let ([a, b], by_nut, one) = (&state.sides, state.by_nut, contacts.constant(1.0));
        let lead = contacts.scaled.lead;
        let (p, to_nut) =
            rolling(by_nut, lead, contacts.scaled.arc, [(a.sin, a.cos), (b.sin, b.cos)]);
        let (zero, to_screw) = (contacts.constant(0.0), relative_rotation(to_nut, one, lead));
        let nut_spin = spin_at_nut(to_nut, (a.sin, a.cos));
        let screw_spin = -spin_at_nut(to_screw, (b.sin, b.cos));
        Self {
            p,
            omega: [to_nut[1], to_nut[2]],
            speed: [p * contacts.scaled.arc, (p - 1.0) * contacts.scaled.arc],
            spin: [by_nut.select(zero, nut_spin), by_nut.select(screw_spin, zero)],
        }
    }

    #[inline(always)]
    fn outputs(&self, out: &mut Sink<'_, '_>, units: &Units<S>, contacts: &Contacts<S>) {
        let w = units.speed;
        let to_nut = [contacts.scaled.lead.0 * 0.5, self.omega[0], self.omega[1]];
        let omega = relative_rotation(to_nut, -contacts.scaled.nut_speed, contacts.scaled.lead);
        ball_motion(out, w, self.p + contacts.scaled.nut_speed, omega);
        out.set_all(OutputKey::nut_spin_rad_s, [self.spin[0] * w, self.spin[1] * w]);
        // Both centres roll; the slip of the lead is shared, against friction along e_x.
        let slip = contacts.scaled.lead.0 * 0.5 * w.abs() * units.ball;
        out.set_all(OutputKey::nut_slip_velocity_m_s, [slip; 2]);
        // Friction is along e_x, or against it where the load drives.
        let zero = w.constant(0.0);
        let angle = w.lt(zero).select(zero.constant(180.0), zero);
        out.set_all(OutputKey::nut_slip_angle_deg, [angle; 2]);
    }
}

/// The ellipse at nut (0) or screw (1) and the motion over it.
#[inline(always)]
fn ellipse<S: Simd>(
    i: usize,
    contacts: &Contacts<S>,
    state: &Precession<S>,
    motion: &Motion<S>,
) -> Ellipse<S> {
    let (side, pressed) = (&state.sides[i], &contacts.pressed[i]);
    let speed = motion.speed[i];
    Ellipse {
        load: side.load,
        semi_axes: side.semi_axes(pressed),
        pressed_radius: pressed.pressed_radius,
        speed,
        // Both centres roll, and share the slip of the lead.
        omega: [contacts.scaled.lead.0 * 0.5, motion.spin[i], -speed],
    }
}

/// Torque, efficiency and powers by the friction of both ellipses; where it is resolved, which must not
/// depend on the outputs that are wanted; the efficiency and the friction coefficient.
#[inline(always)]
fn transmit<S: Simd>(
    out: &mut Sink<'_, '_>,
    given: &LaneInputs<'_, S>,
    (units, contacts): (&Units<S>, &Contacts<S>),
    (state, motion): (&Precession<S>, &Motion<S>),
) -> (Mask<S>, Lane<S>, Lane<S>) {
    let (nut, screw) = (ellipse(0, contacts, state, motion), ellipse(1, contacts, state, motion));
    let ((nut_power, at_nut), (screw_power, at_screw)) = (nut.power(), screw.power());
    let zero = nut_power.constant(0.0);
    let back = units.speed.lt(zero);
    let lubricated = OilLane::of(
        given,
        (units, contacts),
        (state, motion),
        [(nut, nut_power), (screw, screw_power)],
    );
    let (loss, friction) = if let Some(lubricated) = &lubricated {
        (lubricated.loss(), lubricated.friction_scale())
    } else {
        let friction = given.get(InputKey::friction_coefficient);
        (friction_power(friction, [nut.load, screw.load], [nut_power, screw_power]), friction)
    };
    let ideal =
        ideal_torque(units.axial, units.pitch, contacts.scaled.lead.0 / contacts.scaled.lead.1);
    let mut torque = rolling_torque(ideal, back.select(-loss, loss), units.ball, units.axial);
    if let Some(lubricated) = &lubricated {
        torque = torque + lubricated.outside.torque(units.speed);
    }
    let of = Transmission::of(back, ideal, torque, units.speed);
    transmission(out, &of);
    let eta = of.efficiency;
    if let Some(lubricated) = &lubricated {
        lubricated.outputs(out, (units, contacts), (back, eta));
    }
    let finite = torque.abs().lt(zero.constant(f64::INFINITY));
    (at_nut & at_screw & finite, eta, friction)
}

/// Stores skid number and onset number where they have a meaning, and returns the latter with the cross slip.
#[inline(always)]
pub(super) fn regime<S: Simd>(
    out: &mut Sink<'_, '_>,
    friction: Lane<S>,
    (units, contacts): (&Units<S>, &Contacts<S>),
    (state, motion): (&Precession<S>, &Motion<S>),
) -> [Lane<S>; 2] {
    let [a, b] = &state.sides;
    let rate = motion.p + contacts.scaled.nut_speed;
    let ball = Ball { radius: contacts.constant(1.0), mass: units.mass };
    let gyroscopic = ball.inertia() * (rate * motion.omega[0]).abs();
    let skid = skid_number(gyroscopic, friction, [a.load, b.load]);
    let [slip_a, slip_b] = &motion.spin;
    let slip_a = slip_a.abs() * a.semi_axes(&contacts.pressed[0]).0;
    let slip_b = slip_b.abs() * b.semi_axes(&contacts.pressed[1]).0;
    let cross = cross_slip(contacts.scaled.lead.0, [slip_a, slip_b]);
    let onset = onset_number(skid, cross);
    let (none, beyond) = (skid.constant(f64::NAN), skid.constant(f64::INFINITY));
    let stated = [skid.lt(beyond).select(skid, none), onset.lt(beyond).select(onset, none)];
    out.set_all(OutputKey::skid_number, stated);
    [onset, cross]
}
