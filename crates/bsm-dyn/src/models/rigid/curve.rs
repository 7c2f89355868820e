//! The rigid equations solved down to one unknown, for any inertia, for one state and for several side by
//! side.
//!
//! Theory: `docs/theory/04-rigid.md`, equations (R33) to (R42); windows by (R46), (R48).

#![expect(clippy::needless_range_loop, reason = "closures do not take the instruction set")]

use std::f64::consts::FRAC_PI_2;

use bsm_kin::Field;
use bsm_simd::{Arch, BLOCK, Block, Compare, Lane, Simd, WithSimd};

use super::ball::{RigidBall, RigidMotion};
use super::trig_quadratic::{LinearForm, Quadratic};
use crate::contact::Sines;
use crate::cost;

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
#[derive(Clone, Copy)]
struct BranchSet<F: Field> {
    /// True if the direction is that at A.
    at_nut: F::Mask,
    /// Direction of the slip at B.
    b: [F; 2],
    /// `$|g|$` and `$K$`.
    gap: F,
    curvature: F,
    /// Axial load over the load of B.
    axial: F,
    /// `$B_0$`.
    drive: F,
    /// `$\Delta$`, `$X$`, `$\Delta M$` and the friction of the other contact times `$\Delta$`.
    denominator: LinearForm<F>,
    cross: LinearForm<F>,
    centrifugal: LinearForm<F>,
    other: [LinearForm<F>; 2],
    /// `$S$`, `$N_1$` and `$N_2$`.
    slip: [Quadratic<F>; 2],
    advance: Quadratic<F>,
    resistance: Quadratic<F>,
}

/// The states with one direction of slip at B.
#[derive(Debug, Clone, Copy)]
pub(super) struct CurveSample {
    pub(super) slip_turn: f64,
    pub(super) branches: [Option<CurvePoint>; 4],
}

/// A state of the ball that solves all equations but the one for its inertia (R42).
#[derive(Debug, Clone, Copy)]
pub(super) struct CurvePoint {
    /// `$\delta$`: turn of the slip at B against the ball without inertia \[rad\].
    pub(super) slip_turn: f64,
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
    pub(super) violated: u16,
    /// Excess of the inertia that there is over the one that would make this a root (R42), from -1 to 1.
    pub(super) inertia_residual: f64,
    /// Changes sign with `$P$`.
    pub(super) rate_sign: f64,
}

/// Numbers of a [`CurvePoint`] but for its turn.
const NUMBERS: usize = 18;

impl CurvePoint {
    /// Of its numbers, as [`Curve::point`] has them.
    #[inline(always)]
    fn of(slip_turn: f64, numbers: &[f64; NUMBERS]) -> Self {
        let [c, s, at_nut, a_x, a_t, m_x, m_t, nut, unloaded, axial, centrifugal, ..] = *numbers;
        let [.., precession, rate, slip_x, slip_t, violated, inertia_residual, rate_sign] =
            *numbers;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "nine bits")]
        let violated = violated as u16;
        Self {
            slip_turn,
            direction: [c, s],
            at_nut: at_nut > 0.0,
            friction: [[a_x, a_t], [m_x, m_t]],
            loads: [nut, unloaded],
            axial,
            centrifugal,
            precession,
            rate,
            slip: [slip_x, slip_t],
            violated,
            inertia_residual,
            rate_sign,
        }
    }

    /// What changes sign with `$P$` where there is more inertia than a root has, else zero: around `$P = 0$` any is too little.
    pub(super) fn rate_sign_above(&self) -> f64 {
        if self.inertia_residual > 0.0 { self.rate_sign } else { 0.0 }
    }

    /// The inertia ratio `$\mu$` that would make this a root.
    pub(super) fn inertia_ratio(&self) -> f64 {
        // μ = M/[A (P/W)²]                                                (R42)
        self.centrifugal / (self.axial * self.rate * self.rate)
    }

    /// Distance of the directions of two points on the unit circle, squared.
    pub(super) fn distance(&self, other: &Self) -> f64 {
        let unloaded = |point: &Self| point.friction[1].map(|x| x / point.loads[1]);
        let (one, two) = if self.at_nut == other.at_nut {
            (self.direction, other.direction)
        } else {
            (unloaded(self), unloaded(other))
        };
        let distance = [one[0] - two[0], one[1] - two[1]];
        dot(distance, distance)
    }
}

#[inline(always)]
fn dot<F: Field>(a: [F; 2], b: [F; 2]) -> F {
    a[0] * b[0] + a[1] * b[1]
}

/// Samples at several turns, in place: they are large.
struct CurveSamples<'a>(&'a Curve, &'a [f64], &'a mut [Option<CurveSample>; BLOCK]);

impl WithSimd for CurveSamples<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self(curve, turns, samples) = self;
        let mut block: Block = [0.0; BLOCK];
        block[..turns.len()].copy_from_slice(turns);
        for first in (0..turns.len()).step_by(Lane::<S>::LEN) {
            let (sin, cos) = Lane::<S>::load(simd, &block[first..]).sin_cos_of_tilt();
            let branches = curve.states([sin, cos]);
            for i in first..turns.len().min(first + Lane::<S>::LEN) {
                let sample =
                    samples[i].insert(CurveSample { slip_turn: turns[i], branches: [None; 4] });
                for k in 0..4 {
                    // Most directions are none.
                    if branches[k][0].as_slice()[i - first].is_nan() {
                        continue;
                    }
                    let mut numbers = [0.0; NUMBERS];
                    for n in 0..NUMBERS {
                        numbers[n] = branches[k][n].as_slice()[i - first];
                    }
                    sample.branches[k] = Some(CurvePoint::of(turns[i], &numbers));
                }
            }
        }
    }
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

    /// `$f/\max(1, \mu)$`, which turns of the slip at B near the ends of the curve go with.
    pub(super) fn friction_over_inertia(&self) -> f64 {
        self.signed.abs() / self.inertia.max(1.0)
    }

    /// The turns that admissible states can have, below zero and above it; none where no state is admissible.
    pub(super) fn windows(&self) -> [Option<[f64; 2]>; 2] {
        let ([sin_psi, cos_psi], [k_e, k_t]) = (self.psi, self.axis);
        let lean = self.signed * self.contact[1] / self.contact[0];
        let psi = sin_psi.atan2(cos_psi);
        // tanφ_E = k_t/(d − k_e),  −φ_E < ψ + δ < π − φ_E                 (R47)
        let lost = k_t.atan2(self.arc - k_e);
        // K has the sign of δ [a sinδ + b cosδ − F cotβ],  a = (cos²ψ − F² cot²β)/sinψ,  b = cosψ
        let carries = cos_psi - lean;
        let (a, sum) = (carries * (cos_psi + lean) / sin_psi, cos_psi + lean);
        let [low, high] = if sum > 0.0 {
            let root = (a * a + carries * sum).sqrt();
            let low = if a > 0.0 { -carries / (a + root) } else { (a - root) / sum };
            let high = if a > 0.0 { (a + root) / sum } else { carries / (root - a) };
            [2.0 * low.atan(), 2.0 * high.atan()]
        } else {
            let wide = (lean / a.hypot(cos_psi)).max(-1.0).acos();
            [a.atan2(cos_psi) - wide, a.atan2(cos_psi) + wide]
        };
        // 0 < δ < min(π/2 − ψ − φ_E, δ_K), none where F cotβ ≥ cosψ       (R49)
        let end = high.min(FRAC_PI_2 - psi - lost);
        let above = (carries > 0.0 && end > 0.0).then_some([0.0, end]);
        // −ψ < δ < δ_K⁻, F > 0, where 2 cotψ > tanφ_E                     (R50)
        let steep = 2.0 * cos_psi * (self.arc - k_e) <= sin_psi * k_t;
        let (begin, end) =
            (-psi - if steep { lost } else { 0.0 }, if carries > 0.0 { low } else { 0.0 });
        let below = ((steep || self.signed > 0.0) && begin < end).then_some([begin, end]);
        [below, above]
    }

    /// Everything that the direction of slip at B tells, from the sine and cosine of its turn.
    #[inline(always)]
    fn branch_set<F: Compare>(&self, [sin, cos]: [F; 2]) -> BranchSet<F> {
        let Self { signed: f, contact: [sin_b, cos_b], psi: [sin_psi, cos_psi], axis, .. } = *self;
        let [k_e, k_t] = axis;
        let (zero, one) = (sin.constant(0.0), sin.constant(1.0));
        // b = −(cos(ψ + δ), sin(ψ + δ)),  ξ = 2 sinδ / sinψ               (R33)
        let b = [sin * sin_psi - cos * cos_psi, -(cos * sin_psi) - sin * cos_psi];
        let xi = sin * (2.0 / sin_psi);
        // ℓ = (ξ, 0) − b,  g = 1 + F ξ cotβ                               (R34)
        let ell = [xi - b[0], -b[1]];
        let lean = f * cos_b / sin_b;
        let gap = xi * lean + 1.0;
        // K = ξ [ξ (1 − F² cot²β)/2 − b_x − F cotβ],  Δ = |g| + ℓ·c       (R35)
        let curvature = xi * (xi * (0.5 * (1.0 - lean * lean)) - b[0] - lean);
        let at_nut = gap.lt(zero);
        let gap = gap.abs();
        let denominator = LinearForm([gap, ell[0], ell[1]]);
        let own = [LinearForm([zero, one, zero]), LinearForm([zero, zero, one])];
        let scaled = [LinearForm([zero, curvature, zero]), LinearForm([zero, zero, curvature])];
        let other = [
            denominator.combined(ell[0], &own[0], -curvature),
            denominator.combined(ell[1], &own[1], -curvature),
        ];
        let unloaded = [
            LinearForm::select(at_nut, &other[0], &scaled[0]),
            LinearForm::select(at_nut, &other[1], &scaled[1]),
        ];
        // A = cosα sinβ − F h cosδ                                        (R36)
        let axial = (b[0] * k_e + b[1] * k_t) * f + self.thrust;
        // Δ M = Δ [ξ F/sinβ + 2 Q' cosβ] − 2 F sinβ Δ f'_x                (R37)
        let unloaded_flank_load = LinearForm([curvature, zero, zero]);
        let unloaded_flank_load =
            unloaded_flank_load.combined(one, &denominator, F::select(at_nut, gap, zero));
        let centrifugal = denominator
            .combined(xi * (f / sin_b), &unloaded_flank_load, sin.constant(2.0 * cos_b))
            .combined(one, &unloaded[0], sin.constant(-2.0 * f * sin_b));
        // X = ± c × ℓ                                                     (R38)
        let side = F::select(at_nut, -one, one);
        let cross = LinearForm([zero, side * ell[1], -side * ell[0]]);
        // S = −(2 b_t/k_t) Δ² f'_x f_A/K                                  (R38)
        let pull = b[1] * (-2.0 / k_t);
        let one_way = LinearForm::select(at_nut, &other[0], &own[0]);
        let slip = [
            one_way.times(&LinearForm::select(at_nut, &own[0], &other[0])).scaled(pull),
            one_way.times(&LinearForm::select(at_nut, &own[1], &other[1])).scaled(pull),
        ];
        // N₁ = k·S − Δ f'_t X,  N₂ = b × S − 2 b_x N₁/k_t                 (R39)
        let advance = slip[0].combined(sin.constant(k_e), &slip[1], sin.constant(k_t)).combined(
            one,
            &unloaded[1].times(&cross),
            -one,
        );
        let resistance =
            slip[1].combined(b[0], &slip[0], -b[1]).combined(one, &advance, b[0] * (-2.0 / k_t));
        // B₀ = k_t b_t + (k_e − d/r_b) b_x                                (R40)
        let drive = b[1] * k_t + b[0] * (k_e - self.arc);
        BranchSet {
            at_nut,
            b,
            gap,
            curvature,
            axial,
            drive,
            denominator,
            cross,
            centrifugal,
            other,
            slip,
            advance,
            resistance,
        }
    }

    /// The states with a turn of the slip at B, at most four, with loads and speeds of any sign: of
    /// each the numbers of [`CurvePoint`].
    #[inline(always)]
    fn states<F: Compare>(&self, slip_turn: [F; 2]) -> [[F; NUMBERS]; 4] {
        cost::evaluated();
        let set = self.branch_set(slip_turn);
        let one = slip_turn[0].constant(1.0);
        // B₀ X Δ M = C₀ (B₀ N₁/(k_t d) + ω N₂),  C₀ = 5 F sinβ cosβ r_m/r_b  (R41)
        let drive = if self.nut == 0.0 { one } else { set.drive };
        let per_turn = drive * (1.0 / (self.axis[1] * self.arc));
        let moving = set.advance.combined(per_turn, &set.resistance, one * self.nut);
        let balance =
            set.cross.times(&set.centrifugal).combined(drive, &moving, one * -self.gyration);
        let zeros = balance.zeros();
        let mut branches = [[one.constant(f64::NAN); NUMBERS]; 4];
        for i in 0..4 {
            if F::any(zeros[i][0].lt(one + 1.0)) {
                branches[i] = self.point(&set, zeros[i]);
            }
        }
        branches
    }

    /// The numbers of the state of one direction of friction.
    #[inline(always)]
    fn point<F: Compare>(&self, set: &BranchSet<F>, c: [F; 2]) -> [F; NUMBERS] {
        let [k_e, k_t] = self.axis;
        let denominator = set.denominator.at(c);
        let per_denominator = denominator.recip();
        let load = set.curvature * per_denominator;
        let own = [load * c[0], load * c[1]];
        let other = [set.other[0].at(c) * per_denominator, set.other[1].at(c) * per_denominator];
        let (zero, larger) = (load.constant(0.0), load + set.gap);
        let loads = [F::select(set.at_nut, load, larger), F::select(set.at_nut, larger, load)];
        let mut friction = [own, other];
        for k in 0..2 {
            friction[0][k] = F::select(set.at_nut, own[k], other[k]);
            friction[1][k] = F::select(set.at_nut, other[k], own[k]);
        }
        // V_A = B₀ S/N₂,  G = B₀ Δ X/N₂,  p = B₀ N₁/(k_t d N₂)            (R40)
        let (resistance, centrifugal, cross) =
            (set.resistance.at(c), set.centrifugal.at(c), set.cross.at(c));
        let scale = set.drive / resistance;
        let slip = [scale * set.slip[0].at(c), scale * set.slip[1].at(c)];
        let precession = scale * set.advance.at(c) * (1.0 / (k_t * self.arc));
        let at_unloaded = [slip[0], slip[1] + scale * denominator * cross * set.b[1] * (2.0 / k_t)];
        let at_screw = [-slip[0] - k_t, precession * (2.0 * self.arc) - slip[1] + (k_e - self.arc)];
        // μ A (B₀ X)² Δ (Δ M) = (C₀ N₂)²                                  (R42)
        let rate_sign = set.drive * cross;
        let part = rate_sign * (1.0 / self.gyration);
        let given = set.axial * self.inertia * (part * part) * denominator * centrifugal;
        let wanted = resistance * resistance;
        let demands = [
            set.curvature,
            denominator,
            loads[0],
            loads[1],
            set.axial,
            centrifugal,
            dot(slip, friction[0]),
            dot(at_unloaded, friction[1]),
            dot(at_screw, set.b),
        ];
        let mut violated = zero;
        for demand in demands {
            let bit = F::select(demand.gt(zero), zero, zero.constant(1.0));
            violated = violated * 2.0 + bit;
        }
        [
            c[0],
            c[1],
            F::select(set.at_nut, zero.constant(1.0), zero),
            friction[0][0],
            friction[0][1],
            friction[1][0],
            friction[1][1],
            loads[0],
            loads[1],
            set.axial,
            centrifugal * per_denominator,
            precession,
            precession + self.nut,
            slip[0],
            slip[1],
            violated,
            (given - wanted) / (given.abs() + wanted),
            rate_sign,
        ]
    }

    /// The states with these turns of the slip at B, at most [`BLOCK`], in place of none.
    pub(super) fn samples(&self, turns: &[f64], samples: &mut [Option<CurveSample>; BLOCK]) {
        Arch::new().dispatch(CurveSamples(self, turns, samples));
    }

    /// The motion of a state.
    ///
    /// * `ball`: the one of this curve.
    pub(super) fn motion(&self, ball: &RigidBall<f64>, point: &CurvePoint) -> RigidMotion<f64> {
        let [sin_b, cos_b] = self.contact;
        let [nut, unloaded] = point.loads;
        let (sin, cos) = point.slip_turn.sin_cos();
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
        let loads = [nut * screw, unloaded * screw, screw];
        let along = point.friction[0].map(|x| x / nut);
        let slip = point.slip[0].hypot(point.slip[1]);
        ball.motion(loads, [point.precession, point.rate], (slip, along), spin)
    }
}
