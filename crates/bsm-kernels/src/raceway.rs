//! Raceway control by lanes, Eqs (W1) to (W11).

mod balance;
mod friction;
mod oil;

use bsm_case::{InputKey, OutputKey};
use bsm_dyn::balance::ideal_torque;
use bsm_dyn::{Ball, Control, Model, cross_slip, onset_number, rolling_torque, skid_number};
use bsm_simd::Simd;

pub(super) use self::balance::{Balanced, Grip};
use self::friction::Ellipse;
use self::oil::Oiled;
use crate::closed_form::transmit_torque;
use crate::operand::{Given, Lane, Mask};
use crate::pair::{Contacts, InUnits, Pair};
use crate::units::Units;
use crate::{Kernel, Out};

pub(super) struct Raceway {
    /// The controlling race; `None` decides by (W7).
    pub(super) control: Option<Control>,
}

impl Kernel for Raceway {
    const MODEL: Model = Model::RacewayControl;

    #[inline(always)]
    fn solve<S: Simd>(&self, given: &Given<'_, S>, out: &mut Out<'_, '_>) -> Mask<S> {
        let (units, pair) = given.simd.vectorize(InUnits(given));
        let grip = given.simd.vectorize(Balanced { pair: &pair, control: self.control });
        if !grip.found.any() {
            return grip.found;
        }
        let motion = Motion::of(&pair, &grip);
        given.simd.vectorize(Contacts { out, units: &units, pair: &pair, sides: &grip.sides });
        motion.outputs(out, &units, &pair);
        let (resolved, friction) = transmit(out, given, (&units, &pair), (&grip, &motion));
        regime(out, friction, (&units, &pair), (&grip, &motion));
        out.set(OutputKey::iterations, grip.steps);
        out.set(OutputKey::residual_norm, grip.residual);
        let (zero, by_nut) = (grip.residual.constant(0.0), grip.by_nut);
        out.set(OutputKey::controlling_race, by_nut.select(zero, zero + 1.0));
        // With a lubricant the model looks for no other solutions.
        if given.operands.lubricant.is_none() {
            if self.control.is_none() {
                out.set(OutputKey::control_consistent, zero + 1.0);
            }
            out.set_unique(zero);
        }
        grip.found & resolved
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
    pub(super) fn of(pair: &Pair<S>, grip: &Grip<S>) -> Self {
        let [a, b] = &grip.sides;
        let (p, by_nut, zero) = (grip.rolling.p, grip.by_nut, pair.arc.constant(0.0));
        let (to_nut, to_screw) = (p * pair.arc, (p - 1.0) * pair.arc);
        // (ω'_n, ω'_b) = −p (d/r_b) (−sinβ_A, cosβ_A)                     (W5)
        let nut = [to_nut * a.sin, -(to_nut * a.cos)];
        // (ω'_n, ω'_b − cosα) = (p − 1)(d/r_b) (−sinβ_B, cosβ_B)          (W6)
        let screw = [-(to_screw * b.sin), to_screw * b.cos + pair.cos_a];
        // ω_spin = (ω − Ω k)·N                                            (K14)
        let nut_spin = pair.cos_a * a.sin - to_screw * grip.rolling.twist;
        let screw_spin = pair.cos_a * b.sin + to_nut * grip.rolling.twist;
        Self {
            p,
            omega: [by_nut.select(nut[0], screw[0]), by_nut.select(nut[1], screw[1])],
            speed: [to_nut, to_screw],
            spin: [by_nut.select(zero, nut_spin), by_nut.select(screw_spin, zero)],
        }
    }

    #[inline(always)]
    fn outputs(&self, out: &mut Out<'_, '_>, units: &Units<S>, pair: &Pair<S>) {
        let (w, nut_speed) = (units.speed, units.nut_speed);
        // P = Ω_n + p W,  ω = Ω_n k + ω' W                                (K12)
        out.set(OutputKey::ball_precession_rad_s, nut_speed + self.p * w);
        // ω'_t = W sinα / 2                                               (W3)
        out.set(OutputKey::ball_omega_t_rad_s, pair.sin_a * (w * 0.5 + nut_speed));
        let [n, b] = self.omega;
        out.set(OutputKey::ball_omega_n_rad_s, n * w);
        out.set(OutputKey::ball_omega_b_rad_s, b * w + nut_speed * pair.cos_a);
        out.set(OutputKey::nut_spin_rad_s, self.spin[0] * w);
        out.set(OutputKey::screw_spin_rad_s, self.spin[1] * w);
        // Both centres roll; the slip of the lead is shared, against friction along e_x.
        let slip = pair.sin_a * 0.5 * w.abs() * units.ball;
        out.set(OutputKey::nut_slip_velocity_m_s, slip);
        out.set(OutputKey::screw_slip_velocity_m_s, slip);
        // Friction is along e_x, or against it where the load drives.
        let zero = w.constant(0.0);
        let angle = w.lt(zero).select(zero.constant(180.0), zero);
        out.set(OutputKey::nut_slip_angle_deg, angle);
        out.set(OutputKey::screw_slip_angle_deg, angle);
    }
}

/// The ellipse at nut (0) or screw (1) and the motion over it.
#[inline(always)]
fn ellipse<S: Simd>(i: usize, pair: &Pair<S>, grip: &Grip<S>, motion: &Motion<S>) -> Ellipse<S> {
    let (side, pressed) = (&grip.sides[i], &pair.pressed[i]);
    // a ~ Q^{1/3}                                                         (P6)
    let a = side.growth * pressed.hertz.semi_axis;
    let speed = motion.speed[i];
    Ellipse {
        load: side.load,
        semi_axes: (a, a * pressed.hertz.flatness),
        pressed_radius: pressed.pressed_radius,
        speed,
        // Both centres roll, and share the slip of the lead.
        omega: [pair.sin_a * 0.5, motion.spin[i], -speed],
    }
}

/// Torque, efficiency and powers by the friction of both ellipses; where it is resolved, which must not
/// depend on the outputs that are wanted; and the friction coefficient.
#[inline(always)]
fn transmit<S: Simd>(
    out: &mut Out<'_, '_>,
    given: &Given<'_, S>,
    (units, pair): (&Units<S>, &Pair<S>),
    (grip, motion): (&Grip<S>, &Motion<S>),
) -> (Mask<S>, Lane<S>) {
    let (nut, screw) = (ellipse(0, pair, grip, motion), ellipse(1, pair, grip, motion));
    let ((nut_power, at_nut), (screw_power, at_screw)) = (nut.power(), screw.power());
    let zero = nut_power.constant(0.0);
    let back = units.speed.lt(zero);
    let oiled =
        Oiled::of(given, (units, pair), (grip, motion), [(nut, nut_power), (screw, screw_power)]);
    let (loss, friction) = if let Some(oiled) = &oiled {
        (oiled.loss(), oiled.friction_scale())
    } else {
        let friction = given.get(InputKey::friction_coefficient);
        // P_f = Σ f Q ∫ dP                                                (P7)
        (friction * (nut.load * nut_power + screw.load * screw_power), friction)
    };
    let ideal = ideal_torque(units.axial, units.pitch, pair.sin_a / pair.cos_a);
    let mut torque = rolling_torque(ideal, back.select(-loss, loss), units.ball, units.axial);
    if let Some(oiled) = &oiled {
        // T = Z T_ball + Σ P/W                                            (Y27)
        torque = torque + oiled.outside.of_balls() / units.speed;
    }
    let eta = transmit_torque(out, back, (torque, ideal), torque.constant(1.0), units.speed);
    if let Some(oiled) = &oiled {
        oiled.outputs(out, (units, pair), (back, eta));
    }
    let finite = torque.abs().lt(zero.constant(f64::INFINITY));
    (at_nut & at_screw & finite, friction)
}

/// Stores skid number and onset number where they have a meaning, and returns the latter.
#[inline(always)]
pub(super) fn regime<S: Simd>(
    out: &mut Out<'_, '_>,
    friction: Lane<S>,
    (units, pair): (&Units<S>, &Pair<S>),
    (grip, motion): (&Grip<S>, &Motion<S>),
) -> Lane<S> {
    let [a, b] = &grip.sides;
    let rate = motion.p + pair.nut_speed;
    let ball = Ball { radius: pair.constant(1.0), mass: units.mass };
    let gyroscopic = ball.inertia() * (rate * motion.omega[0]).abs();
    let skid = skid_number(gyroscopic, friction, [a.load, b.load]);
    let [slip_a, slip_b] = &motion.spin;
    let slip_a = slip_a.abs() * a.growth * pair.pressed[0].hertz.semi_axis;
    let slip_b = slip_b.abs() * b.growth * pair.pressed[1].hertz.semi_axis;
    let onset = onset_number(skid, cross_slip(pair.sin_a, [slip_a, slip_b]));
    for (key, x) in [(OutputKey::skid_number, skid), (OutputKey::onset_number, onset)] {
        let finite = x.lt(x.constant(f64::INFINITY));
        out.set(key, finite.select(x, x.constant(f64::NAN)));
    }
    onset
}
