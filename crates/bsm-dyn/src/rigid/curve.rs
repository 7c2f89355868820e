//! The rigid equations solved down to one unknown, for any inertia.
//!
//! Theory: `docs/theory/04-rigid.md`, equations (R33) to (R42).

use super::ball::{RigidBall, RigidMotion};
use super::trig_quadratic::{Line, Quadratic};
use crate::{Sines, cost};

/// What does not change along the curve; speeds over `$W$` with its sign, lengths in `$r_b$`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Curve {
    /// `$F = f$` with the sign of `$W$`.
    signed: f64,
    /// `$r_m/r_b$` and `$d/r_b$`.
    radius: f64,
    arc: f64,
    /// `$\omega = \Omega_n/W$`.
    nut: f64,
    /// `$\mu$`.
    pub(super) inertia: f64,
    /// `$C_0$`.
    gyration: f64,
    /// Sine and cosine of `$\beta$` and `$\psi$`.
    contact: [f64; 2],
    psi: [f64; 2],
    /// The axis in `(e_x, t)`: `$(\cos\alpha\cos\beta, \sin\alpha)$`.
    axis: [f64; 2],
    /// `$\cos\alpha\sin\beta$`.
    thrust: f64,
}

/// All states with a given direction of slip at B, as functions of the direction `c` of friction at
/// the lesser of the nut's contacts: A' where `$g > 0$`, else A.
#[derive(Debug, Clone, Copy)]
struct Fan {
    turn: f64,
    /// True if the direction is that at A.
    at_nut: bool,
    /// Direction of the slip at B.
    b: [f64; 2],
    /// `$|g|$` and `$K$`.
    gap: f64,
    curvature: f64,
    /// Axial load over the load of B.
    axial: f64,
    /// `$B_0$`.
    drive: f64,
    /// `$\Delta$`, `$X$`, `$\Delta M$` and the friction of the other contact times `$\Delta$`.
    reach: Line,
    cross: Line,
    centrifugal: Line,
    other: [Line; 2],
    /// `$S$`, `$N_1$` and `$N_2$`.
    slip: [Quadratic; 2],
    advance: Quadratic,
    resistance: Quadratic,
}

/// The states with one direction of slip at B.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub(super) turn: f64,
    /// `$B_0$`; near its zero the slip at A' turns fast.
    pub(super) drive: f64,
    pub(super) sheets: [Option<Point>; 4],
}

/// A state of the ball that solves all equations but the one for its inertia (R42).
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    /// `$\delta$`: turn of the slip at B against the ball without inertia \[rad\].
    pub(super) turn: f64,
    /// The direction that it was found by, and whether it is that at A.
    direction: [f64; 2],
    at_nut: bool,
    /// Friction vectors of A and A' over `$F Q_B$`, and their loads over that of B.
    friction: [[f64; 2]; 2],
    loads: [f64; 2],
    /// Axial load and centrifugal force over the load of B.
    axial: f64,
    centrifugal: f64,
    /// `$p$` and `$P/W$`.
    precession: f64,
    rate: f64,
    /// Slip at A over `$r_b W$`.
    slip: [f64; 2],
    /// What an admissible state must not have, a bit for each: loads that pull, slips against their
    /// directions.
    pub(super) broken: u16,
    /// Both sides of (R42): the inertia that there is, and the one that makes it a root.
    inertia: [f64; 2],
    /// Changes sign with `$P$`.
    pub(super) sense: f64,
}

impl Point {
    /// Excess of the inertia over the one that would make this a root, from -1 to 1.
    pub(super) fn excess(&self) -> f64 {
        let [given, wanted] = self.inertia;
        (given - wanted) / (given.abs() + wanted)
    }

    /// The inertia ratio `$\mu$` that would make this a root.
    pub(super) fn inertia_ratio(&self) -> f64 {
        // μ = M/[A (P/W)²]                                                (R42)
        self.centrifugal / (self.axial * self.rate * self.rate)
    }

    /// Distance of the directions of two points on the unit circle, squared.
    pub(super) fn apart(&self, other: &Self) -> f64 {
        let minor = |point: &Self| point.friction[1].map(|x| x / point.loads[1]);
        let (one, two) = if self.at_nut == other.at_nut {
            (self.direction, other.direction)
        } else {
            (minor(self), minor(other))
        };
        let apart = [one[0] - two[0], one[1] - two[1]];
        dot(apart, apart)
    }
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

impl Curve {
    pub(super) fn of(ball: &RigidBall<f64>) -> Self {
        let Sines { sin_a, sin_b, cos_b, .. } = ball.sines;
        Self {
            signed: ball.signed,
            gyration: 5.0 * ball.signed * sin_b * cos_b * ball.radius,
            radius: ball.radius,
            arc: ball.arc,
            nut: ball.nut_speed,
            inertia: ball.inertia_ratio,
            contact: [sin_b, cos_b],
            psi: [ball.sin_psi, ball.cos_psi],
            axis: [ball.k_e, sin_a],
            thrust: ball.k_n,
        }
    }

    /// True if the axial load and the loads of A and A' can be positive with this turn.
    pub(super) fn bears(&self, turn: f64) -> bool {
        let fan = self.fan(turn);
        fan.axial > 0.0 && fan.curvature > 0.0
    }

    /// Everything that the direction of slip at B tells.
    fn fan(&self, turn: f64) -> Fan {
        let Self { signed: f, contact: [sin_b, cos_b], psi: [sin_psi, cos_psi], axis, .. } = *self;
        let [k_e, k_t] = axis;
        let (sin, cos) = turn.sin_cos();
        // b = −(cos(ψ + δ), sin(ψ + δ)),  ξ = 2 sinδ / sinψ               (R33)
        let b = [sin_psi * sin - cos_psi * cos, -sin_psi * cos - cos_psi * sin];
        let xi = 2.0 * sin / sin_psi;
        // ℓ = (ξ, 0) − b,  g = 1 + F ξ cotβ                               (R34)
        let ell = [xi - b[0], -b[1]];
        let lean = f * cos_b / sin_b;
        let gap = 1.0 + lean * xi;
        // K = ξ [ξ (1 − F² cot²β)/2 − b_x − F cotβ],  Δ = |g| + ℓ·c       (R35)
        let curvature = xi * (0.5 * xi * (1.0 - lean * lean) - b[0] - lean);
        let at_nut = gap < 0.0;
        let gap = gap.abs();
        let reach = Line([gap, ell[0], ell[1]]);
        let own = [Line([0.0, 1.0, 0.0]), Line([0.0, 0.0, 1.0])];
        let scaled = own.map(|c| Line(c.0.map(|x| curvature * x)));
        let other: [Line; 2] = std::array::from_fn(|i| reach.combined(ell[i], &own[i], -curvature));
        let minor = if at_nut { other } else { scaled };
        // A = cosα sinβ − F h cosδ                                        (R36)
        let axial = self.thrust + f * dot(axis, b);
        // Δ M = Δ [ξ F/sinβ + 2 Q' cosβ] − 2 F sinβ Δ f'_x                (R37)
        let minor_load = Line([curvature, 0.0, 0.0]);
        let minor_load = if at_nut { minor_load.combined(1.0, &reach, gap) } else { minor_load };
        let centrifugal = reach.combined(xi * f / sin_b, &minor_load, 2.0 * cos_b).combined(
            1.0,
            &minor[0],
            -2.0 * f * sin_b,
        );
        // X = ± c × ℓ                                                     (R38)
        let side = if at_nut { -1.0 } else { 1.0 };
        let sideways = Line([0.0, side * ell[1], -side * ell[0]]);
        // S = −(2 b_t/k_t) Δ² f'_x f_A/K                                  (R38)
        let pull = -2.0 * b[1] / k_t;
        let slip: [Quadratic; 2] = std::array::from_fn(|i| {
            let (one, two) = if at_nut { (other[0], own[i]) } else { (own[0], other[i]) };
            one.times(&two).scaled(pull)
        });
        // N₁ = k·S − Δ f'_t X,  N₂ = b × S − 2 b_x N₁/k_t                 (R39)
        let advance =
            slip[0].combined(k_e, &slip[1], k_t).combined(1.0, &minor[1].times(&sideways), -1.0);
        let resistance =
            slip[1].combined(b[0], &slip[0], -b[1]).combined(1.0, &advance, -2.0 * b[0] / k_t);
        // B₀ = k_t b_t + (k_e − d/r_b) b_x                                (R40)
        let drive = k_t * b[1] + (k_e - self.arc) * b[0];
        Fan {
            turn,
            at_nut,
            b,
            gap,
            curvature,
            axial,
            drive,
            reach,
            cross: sideways,
            centrifugal,
            other,
            slip,
            advance,
            resistance,
        }
    }

    /// The states with this turn of the slip at B, at most four, with loads and speeds of any sign.
    pub(super) fn sample(&self, turn: f64) -> Sample {
        cost::evaluated();
        let fan = self.fan(turn);
        // B₀ X Δ M = C₀ (B₀ N₁/(k_t d) + ω N₂),  C₀ = 5 F sinβ cosβ r_m/r_b  (R41)
        let (drive, nut) = if self.nut == 0.0 { (1.0, 0.0) } else { (fan.drive, self.nut) };
        let moving = fan.advance.combined(drive / (self.axis[1] * self.arc), &fan.resistance, nut);
        let balance = fan.cross.times(&fan.centrifugal).combined(drive, &moving, -self.gyration);
        let sheets = balance.zeros().map(|c| (!c[0].is_nan()).then(|| self.point(&fan, c)));
        Sample { turn, drive: fan.drive, sheets }
    }

    /// The state of one direction of friction.
    fn point(&self, fan: &Fan, c: [f64; 2]) -> Point {
        let [k_e, k_t] = self.axis;
        let reach = fan.reach.at(c);
        let load = fan.curvature / reach;
        let own = [load * c[0], load * c[1]];
        let other = fan.other.map(|line| line.at(c) / reach);
        let (loads, friction) = if fan.at_nut {
            ([load, load + fan.gap], [own, other])
        } else {
            ([load + fan.gap, load], [other, own])
        };
        // V_A = B₀ S/N₂,  G = B₀ Δ X/N₂,  p = B₀ N₁/(k_t d N₂)            (R40)
        let (resistance, centrifugal, cross) =
            (fan.resistance.at(c), fan.centrifugal.at(c), fan.cross.at(c));
        let scale = fan.drive / resistance;
        let slip = fan.slip.map(|s| scale * s.at(c));
        let precession = scale * fan.advance.at(c) / (k_t * self.arc);
        let at_minor = [slip[0], slip[1] + 2.0 * scale * reach * cross * fan.b[1] / k_t];
        let at_screw = [-slip[0] - k_t, 2.0 * self.arc * precession - slip[1] + k_e - self.arc];
        // μ A (B₀ X)² Δ (Δ M) = (C₀ N₂)²                                  (R42)
        let sense = fan.drive * cross;
        let given =
            self.inertia * fan.axial * (sense / self.gyration).powi(2) * reach * centrifugal;
        let demands = [
            fan.curvature,
            reach,
            loads[0],
            loads[1],
            fan.axial,
            centrifugal,
            dot(slip, friction[0]),
            dot(at_minor, friction[1]),
            dot(at_screw, fan.b),
        ];
        let broken = demands.iter().fold(0, |bits, x| {
            let met = *x > 0.0;
            2 * bits + u16::from(!met)
        });
        Point {
            turn: fan.turn,
            direction: c,
            at_nut: fan.at_nut,
            friction,
            loads,
            axial: fan.axial,
            centrifugal: centrifugal / reach,
            precession,
            rate: precession + self.nut,
            slip,
            broken,
            inertia: [given, resistance * resistance],
            sense,
        }
    }

    /// The motion of a state.
    ///
    /// * `ball`: the one of this curve.
    pub(super) fn motion(&self, ball: &RigidBall<f64>, point: &Point) -> RigidMotion<f64> {
        let [sin_b, cos_b] = self.contact;
        let [nut, minor] = point.loads;
        let (sin, cos) = point.turn.sin_cos();
        let b_t = -self.psi[0] * cos - self.psi[1] * sin;
        let tau = point.slip[1] - self.arc * point.precession;
        // Q_B = F_a/A, or as it balances the inertia where A vanishes against its parts  (R42)
        let balanced = self.inertia * point.rate * point.rate / point.centrifugal;
        let lost = point.axial * (point.precession.abs() + self.nut.abs());
        let screw =
            if lost < self.thrust * point.rate.abs() { balanced } else { point.axial.recip() };
        // s = I P tanβ τ + 2 F Q_B b_t/k_t                                (R43)
        let gyroscopic = 0.4 * self.inertia / self.radius * point.rate * tau * sin_b / cos_b;
        let spin = gyroscopic + 2.0 * self.signed * screw * b_t / self.axis[1];
        let loads = [nut * screw, minor * screw, screw];
        let along = point.friction[0].map(|x| x / nut);
        let slip = point.slip[0].hypot(point.slip[1]);
        ball.motion(loads, [point.precession, point.rate], (slip, along), spin)
    }
}
