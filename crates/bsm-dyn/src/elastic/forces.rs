//! All states of force that a skidding ball can have, at any inertia: a curve.
//!
//! Theory: `docs/theory/08-elastic.md`, equations (S13) to (S24).

use bsm_kin::{Jet, Scalar};
use nalgebra::Vector3;

use crate::layout::BALL;
use crate::layout::unknown::{NUT_LOAD, PRECESSION, SCREW_LOAD, SLIP, SLIP_ANGLE, SPIN, TILT};
use crate::pair::Pair;

/// Newton steps to a state of force; more means that the guess was not near it.
const MOST_STEPS: usize = 12;

/// What a state of force may leave of its two equations.
const CLOSED: f64 = 1e-10;

/// A point in scaled units, in the terms of the curve.
pub(super) struct Forces<'a> {
    pair: &'a Pair,
    /// `$F$`.
    friction: f64,
    sin: f64,
    cos: f64,
    /// `$\cot\alpha$`.
    cot: f64,
    /// `$\Omega_n/W$`.
    nut_speed: f64,
    /// `$A_2$`.
    reach: f64,
}

/// `$\ln q$`, the `$x$` of one contact, `$c$`.
pub(super) type Place = Vector3<f64>;

/// A state of force; at nut (0) and screw (1).
#[derive(Debug, Clone, Copy)]
pub(super) struct State<D> {
    /// `$x_A,\; x_B$`.
    pub(super) across: [D; 2],
    /// Sines and cosines of the contact angles.
    pub(super) sin: [D; 2],
    pub(super) cos: [D; 2],
    pub(super) loads: [D; 2],
    /// `$Y$`.
    along: D,
    /// `$M$`.
    pub(super) centrifugal: D,
    /// Sine and cosine of the difference of the contact angles.
    turn: (D, D),
}

/// How a state can move.
#[derive(Debug, Clone, Copy)]
pub(super) struct Kinematics {
    /// Slip at nut and screw against friction, over `$r_b|W|$`.
    pub(super) slip: [f64; 2],
    /// `$1 - a$`.
    gyroscopic: f64,
    /// `$a$`.
    pub(super) inertia: f64,
    /// `$\pi/d$`.
    rolling: f64,
    /// `$b$`.
    pub(super) drive: f64,
}

impl<'a> Forces<'a> {
    pub(super) fn new(pair: &'a Pair) -> Self {
        let (sin, cos) = pair.helix.lead_angle.sin_cos();
        let jones = &pair.jones;
        Self {
            pair,
            friction: pair.friction * pair.sign(),
            sin,
            cos,
            cot: cos / sin,
            nut_speed: pair.nut_speed * pair.sign(),
            reach: (jones.nut_offset + jones.screw_offset) * jones.contact_angle.cos(),
        }
    }

    /// The state of `$q$`, `$c$` and the `$x$` of one contact, nut (0) or screw (1), and what it
    /// leaves of (S20) and (S21); none if no directions of friction belong to them.
    pub(super) fn state<D: Scalar>(&self, known: usize, [q, x, c]: [D; 3]) -> Option<(State<D>, [D; 2])> {
        let f = self.friction;
        let v = 1.0 + f * f;
        // R_A²/R_B² − 1
        let beyond = (c * 2.0 + q) * q / (c.square() + 1.0);
        let more = if known == 1 { beyond } else { -beyond / (beyond + 1.0) };
        let square = x.square() * (more + 1.0) + more * v.recip();
        if !(square.re() >= 0.0) {
            return None;
        }
        let other = square.sqrt();
        let [nut, screw] = if known == 1 { [other, x] } else { [x, other] };
        let sum = (nut + screw) * self.cot.recip();
        let across = [nut, screw];
        let w = across.map(|x| (x.square() + 1.0).sqrt());
        let e = ((screw.square() * v + 1.0) / (c.square() + 1.0)).sqrt();
        let m = [e * (c + q), e * c];
        let square = m.map(|m| e.square() + m.square());
        let at = |i: usize, normal: D, along: D| (w[i] * normal + across[i] * along * f) / square[i];
        let cos = [0, 1].map(|i| at(i, m[i], -e));
        let sin = [0, 1].map(|i| at(i, e, m[i]));
        let along = (e * self.cos - D::from(f * self.sin)).recip();
        let loads = w.map(|w| along * w);
        let both = square[0] * square[1];
        // R_A² − R_B² over v, over the sum that makes it a difference
        let apart = beyond * square[1] * (f / v) / (nut * w[1] + screw * w[0]);
        let level = w[0] * w[1] + nut * screw * (f * f);
        let (s, k) = (e.square() * q, m[0] * m[1] + e.square());
        let turn = ((s * level - k * apart) / both, (k * level + s * apart) / both);
        if !(along.re() > 0.0 && along.re().is_finite()) {
            return None;
        }
        let state = State { across, sin, cos, loads, along, centrifugal: along * e * q, turn };
        let jones = &self.pair.jones;
        let offsets = [jones.nut_offset, jones.screw_offset];
        let [a, b] = [0, 1].map(|i| (self.pair.approach_of(i, loads[i]) + offsets[i]) * cos[i]);
        let left = [(cos[0] + cos[1]) / sum - D::from(1.0), (a + b) * self.reach.recip() - 1.0];
        Some((state, left))
    }

    pub(super) fn kinematics(&self, s: &State<f64>) -> Kinematics {
        let d = self.pair.arc;
        let [x, y] = s.across;
        let unit = ((x + y) * (1.0 + x * y)).recip();
        let nut = (y * (d - self.cos * s.cos[1]) - self.sin) * unit;
        let screw = (x * (d + self.cos * s.cos[0]) + self.sin) * unit;
        let rolling = nut * (1.0 + x * self.cot * s.cos[0]) / d;
        let gyroscopic = 2.5 * self.friction * s.along * self.cot * s.turn.0 / s.centrifugal;
        let slip = [nut * s.loads[0] / s.along, screw * s.loads[1] / s.along];
        Kinematics {
            slip,
            gyroscopic,
            inertia: 1.0 - gyroscopic,
            rolling,
            drive: rolling + self.nut_speed,
        }
    }

    /// `$\sqrt{M/\mu}\,a - h\,b$` for both signs `$h$` of the precession.
    pub(super) fn excess(&self, s: &State<f64>, k: &Kinematics) -> [f64; 2] {
        let rate = (s.centrifugal / self.pair.inertia_ratio()).sqrt();
        [rate * k.inertia - k.drive, rate * k.inertia + k.drive]
    }

    /// `$\mu$` at which the state is that of a steady motion.
    pub(super) fn inertia(s: &State<f64>, k: &Kinematics) -> f64 {
        s.centrifugal * (k.inertia / k.drive).powi(2)
    }

    /// `$F\tan\alpha$`.
    pub(super) fn friction_term(&self) -> f64 {
        self.friction / self.cot
    }

    /// `$\mu$` of the point.
    pub(super) fn inertia_ratio(&self) -> f64 {
        self.pair.inertia_ratio()
    }

    /// Unknowns (S1) of a root with the precession of sign `h`.
    pub(super) fn unknowns(&self, s: &State<f64>, k: &Kinematics, h: f64) -> [f64; BALL] {
        let mu = self.pair.inertia_ratio();
        let rate = h * (s.centrifugal / mu).sqrt();
        let tilt = 0.5 * s.turn.0.atan2(s.turn.1);
        let mean = s.sin[0].atan2(s.cos[0]) + tilt;
        let inertia = self.pair.ball.inertia() * rate;
        let mut y = [0.0; BALL];
        y[NUT_LOAD] = s.loads[0];
        y[SCREW_LOAD] = s.loads[1];
        y[TILT] = tilt;
        y[PRECESSION] = rate - self.nut_speed;
        y[SLIP] = k.slip[0];
        y[SLIP_ANGLE] = 1.0_f64.atan2(s.across[0]);
        y[SPIN] = -2.0 * self.friction * s.along * tilt.cos() / self.sin
            - inertia * k.slip[0] * y[SLIP_ANGLE].cos() * self.cot * mean.sin();
        y
    }

    /// The state next to a guess, in the plane across `direction`, by Newton.
    pub(super) fn closed(&self, known: usize, guess: Place, direction: &Place, scale: &Place) -> Option<(Place, State<f64>)> {
        let across = direction.component_div(scale).component_div(scale);
        let (mut x, mut step) = (guess, Place::zeros());
        for _ in 0..MOST_STEPS {
            let q = x[0].exp();
            let jets = [Jet { re: q, eps: [q, 0.0, 0.0] }, Jet::variable(x[1], 1), Jet::variable(x[2], 2)];
            let Some((_, [a, b])) = self.state(known, jets) else {
                // Half the way back; a guess outside stays there.
                step *= 0.5;
                x -= step;
                continue;
            };
            let [by_a, by_b] = [Place::from(a.eps), Place::from(b.eps)];
            let (one, two) = (by_b.cross(&across), across.cross(&by_a));
            step = -(one * a.re + two * b.re) / by_a.dot(&one);
            let size = step.component_div(scale).amax();
            if !size.is_finite() {
                return None;
            }
            step *= (2.0 / size).min(1.0);
            x += step;
            // A step leaves an error of about its square.
            if size < 1e-7 {
                let (state, [a, b]) = self.state(known, [x[0].exp(), x[1], x[2]])?;
                return (a.abs().max(b.abs()) < CLOSED).then_some((x, state));
            }
        }
        None
    }

    /// `$(r_b/d)\sin\alpha$`.
    pub(super) fn least(&self) -> f64 {
        self.sin / self.pair.arc
    }

    /// What is a large step from a state.
    pub(super) fn scale(&self, place: &Place, sum: f64) -> Place {
        let [_, x, c] = (*place).into();
        Place::new(1.0, 0.3 * (x.abs() + self.least()), 0.3 * (c.abs() + sum / (1.0 + sum)))
    }

    /// Guess of the state of equal contact angles at the cotangent of the angle.
    pub(super) fn level(&self, cot: f64) -> [f64; 2] {
        let sin = cot.hypot(1.0).recip();
        let (cos, f) = (cot * sin, self.friction);
        let x = cos * self.cot;
        let w = x.hypot(1.0);
        [x, (w * cos + f * x * sin) / (w * sin - f * x * cos)]
    }

    /// The state without inertia.
    pub(super) fn begin(&self) -> Option<[f64; 2]> {
        let angle = self.pair.jones.contact_angle;
        // The load turns the ball to a steeper angle, up to next to 90 deg on soft material.
        let (mut low, mut high) = (1e-12, angle.cos() / angle.sin());
        let short = |cot: f64| {
            let [x, c] = self.level(cot);
            self.state(1, [0.0, x, c]).is_some_and(|(_, left)| left[1] < 0.0)
        };
        if !short(low) {
            return None;
        }
        while high > low * (1.0 + 1e-12) {
            // Evenly over the orders of magnitude at first.
            let middle = if high > 2.0 * low { (low * high).sqrt() } else { 0.5 * (low + high) };
            if short(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        Some(self.level(low))
    }
}
