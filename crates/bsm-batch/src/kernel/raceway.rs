//! Raceway control by lanes, Eqs (W1) to (W11).

mod balance;
mod friction;
mod hertz;

use bsm_case::units::{DEG, MM, MPA, UM};
use bsm_case::{InputKey, OutputKey};
use bsm_dyn::{Control, Member, Model};
use bsm_simd::Simd;

use self::balance::{Grip, Pair};
use self::friction::Ellipse;
use self::hertz::{ElasticContact, Screw};
use super::closed_form::transmit_torque;
use super::units::Units;
use super::{Kernel, Out};
use crate::operand::{Given, Lane, Mask};

pub(super) struct Raceway {
    /// The controlling race; `None` decides by (W7).
    pub(super) control: Option<Control>,
}

impl Kernel for Raceway {
    const MODEL: Model = Model::RacewayControl;

    #[inline(always)]
    fn solve<S: Simd>(&self, given: &Given<'_, S>, out: &mut Out<'_, '_>) -> Mask<S> {
        let units = Units::of(given);
        let pair = Pair::of(given, &units);
        let grip = Grip::of(&pair, self.control);
        if !grip.found.any() {
            return grip.found;
        }
        let motion = Motion::of(&pair, &grip);
        contacts(out, &units, &pair, &grip);
        motion.outputs(out, &units, &pair);
        let resolved = transmit(out, given, (&units, &pair), (&grip, &motion));
        regime(out, given, (&units, &pair), (&grip, &motion));
        out.set(OutputKey::iterations, grip.steps);
        out.set(OutputKey::residual_norm, grip.residual);
        let (zero, by_nut) = (grip.residual.constant(0.0), grip.by_nut);
        out.set(OutputKey::controlling_race, by_nut.select(zero, zero + 1.0));
        if self.control.is_none() {
            out.set(OutputKey::control_consistent, zero + 1.0);
        }
        out.set_unique(zero);
        grip.found & resolved
    }
}

impl<S: Simd> Pair<S> {
    #[inline(always)]
    fn of(given: &Given<'_, S>, units: &Units<S>) -> Self {
        let (sin_a, cos_a) = given.lead();
        let (sin_b, cos_b) = given.sin_cos(InputKey::contact_angle_deg);
        // Lengths in r_b, forces in F_a, speeds in W                      (P1)
        let radius = units.pitch / units.ball;
        let arc = radius / cos_a;
        let modulus = hertz::modulus(given, units);
        let screw = Screw { radius, tan_a: sin_a / cos_a, cos_b, modulus };
        let pressed = [
            ElasticContact::of(Member::Nut, given.get(InputKey::nut_conformity), &screw),
            ElasticContact::of(Member::Screw, given.get(InputKey::screw_conformity), &screw),
        ];
        let inertia_ratio = units.mass * radius;
        let [least, infinity] = [f64::MIN_POSITIVE, f64::INFINITY].map(|x| arc.constant(x));
        let regular = pressed[0].regular
            & pressed[1].regular
            & units.mass.gt(least)
            & inertia_ratio.gt(least)
            & inertia_ratio.lt(infinity);
        Self {
            sin_a,
            cos_a,
            sin_b,
            cos_b,
            arc,
            lever: cos_a / arc,
            inertia_ratio,
            nut_speed: units.nut_speed / units.speed,
            pressed,
            regular,
        }
    }
}

/// Motion of the ball relative to the nut over `$W$`.
struct Motion<S: Simd> {
    p: Lane<S>,
    /// Angular velocity along n and b; along t it is `$\sin\alpha/2$` (W3).
    omega: [Lane<S>; 2],
    /// Speed of the centre, relative to nut and screw; the ball turns about `$t \times N$` against it.
    speed: [Lane<S>; 2],
    /// Angular velocity about `$N$`, relative to nut and screw.
    spin: [Lane<S>; 2],
}

impl<S: Simd> Motion<S> {
    #[inline(always)]
    fn of(pair: &Pair<S>, grip: &Grip<S>) -> Self {
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
        // ψ = atan2(−V_y, −V_x)                                           (K15)
        let zero = w.constant(0.0);
        let angle = w.lt(zero).select(zero.constant(180.0), zero);
        out.set(OutputKey::nut_slip_angle_deg, angle);
        out.set(OutputKey::screw_slip_angle_deg, angle);
    }
}

/// Loads, angles, ellipses, approaches and displacement.
#[inline(always)]
fn contacts<S: Simd>(out: &mut Out<'_, '_>, units: &Units<S>, pair: &Pair<S>, grip: &Grip<S>) {
    const KEYS: [[OutputKey; 6]; 2] = [
        [
            OutputKey::nut_normal_load_N,
            OutputKey::nut_contact_angle_deg,
            OutputKey::nut_ellipse_a_mm,
            OutputKey::nut_ellipse_b_mm,
            OutputKey::nut_max_pressure_MPa,
            OutputKey::nut_approach_um,
        ],
        [
            OutputKey::screw_normal_load_N,
            OutputKey::screw_contact_angle_deg,
            OutputKey::screw_ellipse_a_mm,
            OutputKey::screw_ellipse_b_mm,
            OutputKey::screw_max_pressure_MPa,
            OutputKey::screw_approach_um,
        ],
    ];
    let ball = units.ball;
    for (i, [load, angle, long, short, pressure, approach]) in KEYS.into_iter().enumerate() {
        let (side, pressed) = (&grip.sides[i], &pair.pressed[i]);
        let q = side.load * units.load;
        out.set(load, q);
        if out.wants(&[angle]) {
            out.set(angle, side.sin.zip(side.cos, f64::atan2) / DEG);
        }
        // a ~ Q^{1/3}                                                     (P6)
        let a = side.growth * pressed.hertz.semi_axis * ball;
        let b = a * pressed.hertz.flatness;
        out.set(long, a / MM);
        out.set(short, b / MM);
        // p_max = 3 Q / (2 π a b)                                         (H10)
        out.set(pressure, q * 1.5 / (a * b * std::f64::consts::PI) / MPA);
        out.set(approach, side.approach * ball / UM);
    }
    let [a, b] = &grip.sides;
    // δ_a = l_A sinβ_A + l_B sinβ_B − (l_A0 + l_B0) sinβ₀                 (J8)
    let both = pair.pressed[0].offset + pair.pressed[1].offset;
    let displacement = a.length * a.sin + b.length * b.sin - both * pair.sin_b;
    out.set(OutputKey::axial_displacement_um, displacement * ball / UM);
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

/// Torque, efficiency and powers by the friction of both ellipses; where it is resolved.
#[inline(always)]
fn transmit<S: Simd>(
    out: &mut Out<'_, '_>,
    given: &Given<'_, S>,
    (units, pair): (&Units<S>, &Pair<S>),
    (grip, motion): (&Grip<S>, &Motion<S>),
) -> Mask<S> {
    if !out.wants(&[
        OutputKey::efficiency,
        OutputKey::screw_torque_Nm,
        OutputKey::input_power_W,
        OutputKey::output_power_W,
        OutputKey::dissipated_power_W,
        OutputKey::self_locking,
    ]) {
        return grip.found;
    }
    let (nut, screw) = (ellipse(0, pair, grip, motion), ellipse(1, pair, grip, motion));
    let ((nut_power, at_nut), (screw_power, at_screw)) = (nut.power(), screw.power());
    // P_f = Σ f Q ∫ dP                                                    (P7)
    let loss = given.get(InputKey::friction_coefficient)
        * (nut.load * nut_power + screw.load * screw_power);
    // T₀ = F_a r_m tanα,  T = T₀ + P_f/W                                  (B9), (W8)
    let ideal = units.axial * units.pitch * (pair.sin_a / pair.cos_a);
    let zero = loss.constant(0.0);
    let back = units.speed.lt(zero);
    let torque = ideal + back.select(-loss, loss) * units.ball * units.axial;
    transmit_torque(out, back, (torque, ideal), torque.constant(1.0), units.speed);
    at_nut & at_screw
}

/// Skid number and onset number, where they have a meaning.
#[inline(always)]
fn regime<S: Simd>(
    out: &mut Out<'_, '_>,
    given: &Given<'_, S>,
    (units, pair): (&Units<S>, &Pair<S>),
    (grip, motion): (&Grip<S>, &Motion<S>),
) {
    let [a, b] = &grip.sides;
    let rate = motion.p + pair.nut_speed;
    let friction = given.get(InputKey::friction_coefficient);
    // G = I |P ω_n| / (f Q r_b), I = (2/5) m r_b²                         (W9), (B2)
    let skid = units.mass * 0.4 * (rate * motion.omega[0]).abs() / (friction * a.load.min(b.load));
    let [slip_a, slip_b] = &motion.spin;
    let slip_a = slip_a.abs() * a.growth * pair.pressed[0].hertz.semi_axis;
    let slip_b = slip_b.abs() * b.growth * pair.pressed[1].hertz.semi_axis;
    // χ = r_b W sinα / (2 |ω_spin| a)                                     (W10)
    let cross_slip = pair.sin_a * 0.5 / slip_a.max(slip_b);
    // S = G √(1 + χ²)                                                     (W11)
    let onset = skid * (cross_slip * cross_slip + 1.0).sqrt();
    for (key, x) in [(OutputKey::skid_number, skid), (OutputKey::onset_number, onset)] {
        let finite = x.lt(x.constant(f64::INFINITY));
        out.set(key, finite.select(x, x.constant(f64::NAN)));
    }
}
