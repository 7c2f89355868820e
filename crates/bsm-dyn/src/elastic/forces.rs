//! All states of force that a ball with saturated friction can have, at any inertia: a curve.
//!
//! Theory: `docs/theory/08-elastic.md`, equations (S13) to (S28).

use bsm_kin::{Jet, Scalar};
use nalgebra::Vector3;

use crate::ball_unknowns::BALL;
use crate::ball_unknowns::unknown::{
    NUT_LOAD, PRECESSION, SCREW_LOAD, SLIP, SLIP_ANGLE, SPIN, TILT,
};
use crate::cost;
use crate::elastic_ball::ElasticBall;

/// Newton steps to a state of force; more means that the guess was not near it.
const MOST_STEPS: usize = 12;

/// Newton steps to where the curve begins; four are usual. Halving alone takes some 60 from the whole
/// range of angles to the last digit, and every second step halves.
const MOST_LEVEL_STEPS: usize = 120;

/// What may be left of (S20) before the last Newton step to the begin of the curve.
const LEVEL: f64 = 1e-6;

/// Range of the cotangent of a loaded contact angle. The load turns the ball to a steeper angle, up to
/// next to 90 deg on soft material; an unloaded angle of next to 0 has none that is a number.
const COTANGENT: (f64, f64) = (1e-12, 1e12);

/// What a state of force may leave of (S14) and (S20), both of size one; Newton leaves rounding.
const CLOSED: f64 = 1e-10;

/// Place on the curve: `$\ln q$`, the `$x$` of one contact, `$c$`.
pub(super) type Place = Vector3<f64>;

/// A point in scaled units, in the terms of the curve.
pub(super) struct Forces<'a> {
    pair: &'a ElasticBall,
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

/// A state of force; pairs are of nut and screw.
#[derive(Debug, Clone, Copy)]
pub(super) struct State<D> {
    /// `$x$`.
    pub(super) across: [D; 2],
    /// Sines of the contact angles.
    pub(super) sin: [D; 2],
    /// Cosines of the contact angles.
    pub(super) cos: [D; 2],
    /// `$Q/F_a$`.
    loads: [D; 2],
    /// `$Y$`.
    along: D,
    /// `$M$`.
    pub(super) centrifugal: D,
    /// Sine and cosine of `$2\nu$`.
    turn: (D, D),
}

/// How a ball in a state of force moves.
#[derive(Debug, Clone, Copy)]
pub(super) struct Kinematics<D> {
    /// Slips at nut and screw against friction, over `$r_b|W|$`.
    pub(super) slip: [D; 2],
    /// `$1 - g$`.
    pub(super) inertia: D,
    /// `$\pi/d + \Omega_n/W$`.
    pub(super) drive: D,
}

impl<'a> Forces<'a> {
    pub(super) fn new(pair: &'a ElasticBall) -> Self {
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

    /// `$F\tan\alpha$`.
    pub(super) fn friction_term(&self) -> f64 {
        self.friction / self.cot
    }

    /// `$\mu$` of the point.
    pub(super) fn inertia_ratio(&self) -> f64 {
        self.pair.inertia_ratio()
    }

    /// `$(r_b/d)\sin\alpha$`, below which `$-x_A$` stays.
    pub(super) fn least(&self) -> f64 {
        self.sin / self.pair.arc
    }

    /// The state of `$q$`, `$c$` and the `$x$` of the contact `known`, nut (0) or screw (1), and what
    /// it leaves of (S14) and (S20); none if no forces belong to them.
    fn state<D: Scalar>(&self, known: usize, [q, x, c]: [D; 3]) -> Option<(State<D>, [D; 2])> {
        cost::evaluated();
        let (f, v) = (self.friction, 1.0 + self.friction * self.friction);
        // δ = q (2c + q)/(1 + c²),  x_A² = (1 + δ) x_B² + δ/(1 + F²)      (S19)
        let beyond = (c * 2.0 + q) * q / (c.square() + 1.0);
        let more = if known == 1 { beyond } else { -beyond / (beyond + 1.0) };
        let square = x.square() * (more + 1.0) + more * v.recip();
        if square.re() < 0.0 {
            return None;
        }
        let other = square.sqrt();
        let across @ [nut, screw] = if known == 1 { [other, x] } else { [x, other] };
        let w = across.map(|x| (x.square() + 1.0).sqrt());
        // E = R_B/√(1 + c²),  m_A = E (c + q),  m_B = E c                 (S18)
        let e = ((screw.square() * v + 1.0) / (c.square() + 1.0)).sqrt();
        let m = [e * (c + q), e * c];
        let r = m.map(|m| e.square() + m.square());
        // cosβ = (w m − F x E)/R²,  sinβ = (w E + F x m)/R²               (S17)
        let cos = [0, 1].map(|i| (w[i] * m[i] - across[i] * e * f) / r[i]);
        let sin = [0, 1].map(|i| (w[i] * e + across[i] * m[i] * f) / r[i]);
        // Y = 1/(E cosα − F sinα)                                         (S15)
        let along = (e * self.cos - D::from(f * self.sin)).recip();
        if !(along.re() > 0.0 && along.re().is_finite()) {
            return None;
        }
        // Q = Y w                                                         (S13)
        let loads = w.map(|w| along * w);
        // sin(φ_A − φ_B) and sin(η_B − η_A) without differences; 2ν is the difference  (S21)
        let apart = beyond * r[1] * (f / v) / (nut * w[1] + screw * w[0]);
        let level = w[0] * w[1] + nut * screw * (f * f);
        let (s, k) = (e.square() * q, m[0] * m[1] + e.square());
        let both = r[0] * r[1];
        let turn = ((s * level - k * apart) / both, (k * level + s * apart) / both);
        // M = Y E q                                                       (S16)
        let state = State { across, sin, cos, loads, along, centrifugal: along * e * q, turn };
        let jones = &self.pair.jones;
        let offsets = [jones.nut_offset, jones.screw_offset];
        let [a, b] = [0, 1].map(|i| (self.pair.approach_of(i, loads[i]) + offsets[i]) * cos[i]);
        let left = [
            // cosβ_A + cosβ_B = (x_A + x_B) tanα                          (S14)
            (cos[0] + cos[1]) * self.cot / (nut + screw) - D::from(1.0),
            // l_A cosβ_A + l_B cosβ_B = A₂, Eq (J7)                       (S20)
            (a + b) * self.reach.recip() - 1.0,
        ];
        Some((state, left))
    }

    /// The motion of a state.
    ///
    /// Assumes: `$r_m > 1.21\,r_b$`, so that slips against friction have `$Y > 0$`.
    pub(super) fn kinematics<D: Scalar>(&self, s: &State<D>) -> Kinematics<D> {
        let (d, [x_a, x_b]) = (self.pair.arc, s.across);
        let share = ((x_a + x_b) * (x_a * x_b + 1.0)).recip();
        // |V_A| = w_A [x_B (d − cosα cosβ_B) − sinα]/[(x_A + x_B)(1 + x_A x_B)]  (S22)
        let nut = (x_b * (-s.cos[1] * self.cos + d) - self.sin) * share;
        // |V_B| = w_B [x_A (d + cosα cosβ_A) + sinα]/[(x_A + x_B)(1 + x_A x_B)]  (S23)
        let screw = (x_a * (s.cos[0] * self.cos + d) + self.sin) * share;
        // π = |V_A| (1 + x_A cotα cosβ_A)/w_A                             (S24)
        let rolling = nut * (x_a * s.cos[0] * self.cot + 1.0) / D::from(d);
        // g = (5/2) F Y cotα sin2ν/M                                      (S25)
        let g = s.along * (2.5 * self.friction * self.cot) * s.turn.0 / s.centrifugal;
        let slip = [nut * s.loads[0] / s.along, screw * s.loads[1] / s.along];
        Kinematics { slip, inertia: -g + 1.0, drive: rolling + self.nut_speed }
    }

    /// What is left of (S26) for `$P/W > 0$` and for `$P/W < 0$`.
    pub(super) fn excess(&self, s: &State<f64>, k: &Kinematics<f64>) -> [f64; 2] {
        // (1 − g) √(M/μ) = ± (π/d + Ω_n/W)                                (S26)
        let circling = k.inertia * (s.centrifugal / self.inertia_ratio()).sqrt();
        [circling - k.drive, circling + k.drive]
    }

    /// Logarithm of the `$\mu$` with which the state is that of a steady motion.
    pub(super) fn log_inertia(s: &State<f64>, k: &Kinematics<f64>) -> f64 {
        // μ = M [(1 − g)/(π/d + Ω_n/W)]²                                  (S27)
        s.centrifugal.ln() + 2.0 * (k.inertia / k.drive).abs().ln()
    }

    /// Unknowns (S1) of a root of (S26), `sign` that of `$P/W$`.
    pub(super) fn unknowns(&self, s: &State<f64>, k: &Kinematics<f64>, sign: f64) -> [f64; BALL] {
        let rate = sign * (s.centrifugal / self.inertia_ratio()).sqrt();
        let tilt = 0.5 * s.turn.0.atan2(s.turn.1);
        let mean = s.sin[0].atan2(s.cos[0]) + tilt;
        let mut y = [0.0; BALL];
        [y[NUT_LOAD], y[SCREW_LOAD]] = s.loads;
        y[TILT] = tilt;
        y[PRECESSION] = rate - self.nut_speed;
        y[SLIP] = k.slip[0];
        y[SLIP_ANGLE] = 1.0_f64.atan2(s.across[0]);
        // s = −2 F Y cosν/sinα − (I P/W) |V_A| cosθ_A cotα sinβ           (S28)
        y[SPIN] = -2.0 * self.friction * s.along * tilt.cos() / self.sin
            - self.pair.ball.inertia()
                * rate
                * k.slip[0]
                * y[SLIP_ANGLE].cos()
                * self.cot
                * mean.sin();
        y
    }

    /// What is a large step from a place, where `$x_A + x_B$` is `sum`.
    pub(super) fn scale(&self, place: &Place, sum: f64) -> Place {
        let [_, x, c] = (*place).into();
        Place::new(1.0, 0.3 * (x.abs() + self.least()), 0.3 * (c.abs() + sum / (1.0 + sum)))
    }

    /// The state next to a guess, in the plane across `direction`; counts Newton steps.
    pub(super) fn closed(
        &self,
        known: usize,
        guess: Place,
        direction: &Place,
        scale: &Place,
        steps: &mut usize,
    ) -> Option<(Place, State<f64>)> {
        let across = direction.component_div(scale).component_div(scale);
        // Steps stay in the plane.
        self.newton(known, guess, scale, steps, |_| (0.0, across))
    }

    /// The steady motion of the point next to a guess by the `$x$` of the screw; counts Newton steps.
    pub(super) fn steady(
        &self,
        guess: Place,
        scale: &Place,
        steps: &mut usize,
    ) -> Option<(Place, State<f64>)> {
        self.newton(1, guess, scale, steps, |s| {
            let Kinematics { inertia: i, drive: d, .. } = self.kinematics(s);
            // 0 = ln[(M/μ) ((1 − g)/(π/d + Ω_n/W))²], to the last digit of its argument  (S27)
            let left = (s.centrifugal.re / self.inertia_ratio() * (i.re / d.re).powi(2)).ln();
            let slope = |jet: Jet<3>| Place::from(jet.eps) / jet.re;
            (left, slope(s.centrifugal) + (slope(i) - slope(d)) * 2.0)
        })
    }

    /// The state next to a guess that fulfils one condition more: what that leaves, and its gradient.
    fn newton(
        &self,
        known: usize,
        guess: Place,
        scale: &Place,
        steps: &mut usize,
        condition: impl Fn(&State<Jet<3>>) -> (f64, Place),
    ) -> Option<(Place, State<f64>)> {
        let (mut place, mut step) = (guess, Place::zeros());
        for _ in 0..MOST_STEPS {
            *steps += 1;
            let q = place[0].exp();
            let q = Jet { re: q, eps: [q, 0.0, 0.0] };
            let jets = [q, Jet::variable(place[1], 1), Jet::variable(place[2], 2)];
            let Some((state, [a, b])) = self.state(known, jets) else {
                // Half the way back; a guess without forces stays there.
                step *= 0.5;
                place -= step;
                continue;
            };
            let (left, across) = condition(&state);
            let [by_a, by_b] = [Place::from(a.eps), Place::from(b.eps)];
            let (one, two) = (by_b.cross(&across), across.cross(&by_a));
            step = -(one * a.re + two * b.re + by_a.cross(&by_b) * left) / by_a.dot(&one);
            let size = step.component_div(scale).amax();
            if !size.is_finite() {
                return None;
            }
            step *= (2.0 / size).min(1.0);
            place += step;
            // A step leaves an error of about its square: rounding.
            if size < 1e-8 {
                let (state, [a, b]) = self.state(known, [place[0].exp(), place[1], place[2]])?;
                // Where friction all but holds the load, Y is one over a small difference.
                let tolerance = CLOSED.max(16.0 * f64::EPSILON * state.along);
                return (a.abs().max(b.abs()) < tolerance).then_some((place, state));
            }
        }
        None
    }

    /// `$x$` and `$c$` of equal contact angles, from the cotangent of the angle.
    fn level<D: Scalar>(&self, cot: D) -> Option<[D; 2]> {
        let sin = (cot.square() + 1.0).sqrt().recip();
        let (cos, f) = (cot * sin, self.friction);
        let x = cos * self.cot;
        let w = (x.square() + 1.0).sqrt();
        let effect = w * sin - x * cos * f;
        (effect.re() > 0.0).then(|| [x, (w * cos + x * sin * f) / effect])
    }

    /// `$x$` and `$c$` where the curve begins, without inertia; counts Newton steps.
    pub(super) fn begin(&self, steps: &mut usize) -> Option<[f64; 2]> {
        // What (S20) leaves at the angle whose cotangent has this logarithm; none if friction holds.
        let mut left = |log: f64| {
            *steps += 1;
            let cot = log.exp();
            let [x, c] = self.level(Jet { re: cot, eps: [cot] })?;
            let (_, [_, left]) = self.state(1, [Jet::from(0.0), x, c])?;
            left.re.is_finite().then_some((left.re, left.eps[0]))
        };
        let (mut low, mut high) = (COTANGENT.0.ln(), COTANGENT.1.ln());
        if left(low).is_none_or(|(left, _)| left >= 0.0) {
            return None;
        }
        let (mut log, mut last) = (-self.pair.jones.contact_angle.tan().ln(), high - low);
        log = log.clamp(low, high);
        for _ in 0..MOST_LEVEL_STEPS {
            let tried = left(log);
            let is_short = tried.is_some_and(|(left, _)| left < 0.0);
            *(if is_short { &mut low } else { &mut high }) = log;
            let mut step = tried.map_or(f64::INFINITY, |(left, slope)| -left / slope);
            if tried.is_some_and(|(left, _)| left.abs() <= LEVEL) {
                return self.level((log + step).exp());
            }
            // Where friction all but holds the load, angles have no digits between too short and held.
            if high - low <= 4.0 * f64::EPSILON * low.abs().max(1.0) {
                return self.level(low.exp());
            }
            // Newton where it stays inside and halves its step, else the middle.
            let inside = low < log + step && log + step < high;
            if !(inside && step.abs() <= 0.5 * last) {
                step = 0.5 * (low + high) - log;
            }
            (log, last) = (log + step, step.abs());
        }
        None
    }
}
