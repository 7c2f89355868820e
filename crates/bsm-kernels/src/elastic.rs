//! Saturated friction on elastic contacts by lanes: the straight beginning of the curve of all states of
//! force, Eqs (S13) to (S28).

use bsm_case::{InputKey, OutputKey};
use bsm_dyn::balance::ideal_torque;
use bsm_dyn::{Model, POWER_BALANCE_TOL, SlidingBall, SlidingMotion, SlidingState, takes};
use bsm_simd::{Simd, Slopes, WithSimd};

use crate::closed_form::{power_balance, transmit_torque};
use crate::operand::{Given, Lane, Mask};
use crate::pair::{Contacts, InUnits, Pair};
use crate::rigid::slip_angle;
use crate::units::Units;
use crate::{Kernel, Out};

pub(super) struct Elastic;

/// Newton steps to the angle without inertia, and to a state, before a point is left to the model.
const MOST_TO_ANGLE: usize = 8;
const MOST_STEPS: usize = 6;

/// Last steps: of the logarithm of the cotangent, from which the state without inertia is three digits
/// away, and of a state in its own scale, which leaves rounding.
const NEAR: f64 = 1e-4;
const SETTLED: f64 = 1e-8;

/// Loads over the axial load beyond which friction all but holds it, and rounding decides.
const MOST_LOAD: f64 = 1e3;

/// Speed of the nut over the relative speed, beyond which the residual of the model is the rounding of both speeds.
const MOST_NUT_SPEED: f64 = 1e4;

impl Kernel for Elastic {
    const MODEL: Model = Model::Elastic;

    #[inline(always)]
    fn solve<S: Simd>(&self, given: &Given<'_, S>, out: &mut Out<'_, '_>) -> Mask<S> {
        let (units, pair) = given.simd.vectorize(InUnits(given));
        let friction = given.get(InputKey::friction_coefficient);
        let back = units.speed.lt(friction.constant(0.0));
        let skid = Skid::of(given.simd, &pair, back.select(-friction, friction));
        if !skid.found.any() {
            return skid.found;
        }
        let [(q_a, sin_a, cos_a), (q_b, sin_b, cos_b)] = skid.contacts();
        let sides = [pair.loaded(0, q_a, (sin_a, cos_a)), pair.loaded(1, q_b, (sin_b, cos_b))];
        given.simd.vectorize(Contacts { out, units: &units, pair: &pair, sides: &sides });
        skid.turns(&pair).outputs(out, &units, &pair);
        let imbalance = skid.outputs(out, &units, &pair, back);
        out.set(OutputKey::iterations, skid.steps);
        out.set(OutputKey::residual_norm, skid.residual);
        skid.found & imbalance.abs().le(imbalance.constant(POWER_BALANCE_TOL))
    }
}

/// Balls that slide on both flanks.
pub(super) struct Skid<S: Simd> {
    ball: SlidingBall<Lane<S>>,
    state: SlidingState<Lane<S>>,
    motion: SlidingMotion<Lane<S>>,
    /// `$P/W$`.
    pub(super) rate: Lane<S>,
    /// Sine and cosine of the tilt `$\nu$`.
    pub(super) tilt: (Lane<S>, Lane<S>),
    pub(super) steps: Lane<S>,
    residual: Lane<S>,
    /// Where it is a root, and where it is the first one on the curve.
    pub(super) steady: Mask<S>,
    found: Mask<S>,
}

/// Rotation relative to the nut over `$W$`, in the triad of the mean normal.
pub(super) struct Turns<S: Simd> {
    /// Along t, the mean normal and `$e_x$`.
    pub(super) omega: [Lane<S>; 3],
    /// Sine and cosine of the mean contact angle, and of the tilt.
    pub(super) mean: (Lane<S>, Lane<S>),
    pub(super) tilt: (Lane<S>, Lane<S>),
}

impl<S: Simd> Turns<S> {
    #[inline(always)]
    fn outputs(&self, out: &mut Out<'_, '_>, units: &Units<S>, pair: &Pair<S>) {
        let (w, nut_speed) = (units.speed, units.nut_speed);
        let ([along, normal, across], (sin, cos), (s, c)) = (self.omega, self.mean, self.tilt);
        // ω = Ω_n k + ω'                                                  (K12)
        out.set(OutputKey::ball_omega_t_rad_s, along * w + nut_speed * pair.sin_a);
        out.set(OutputKey::ball_omega_n_rad_s, (cos * normal - sin * across) * w);
        let omega_b = (sin * normal + cos * across) * w + nut_speed * pair.cos_a;
        out.set(OutputKey::ball_omega_b_rad_s, omega_b);
        // ω_spin = (ω − Ω k)·N                                            (K14)
        out.set(OutputKey::nut_spin_rad_s, (normal * c - across * s) * w);
        let [k_n, k_e] = [pair.cos_a * sin, pair.cos_a * cos];
        out.set(OutputKey::screw_spin_rad_s, -((normal - k_n) * c + (across - k_e) * s) * w);
    }
}

impl<S: Simd> Skid<S> {
    /// The first roots, if they are where the curve is straight, of a friction with the sign of the speed.
    #[inline(always)]
    pub(super) fn of(simd: S, pair: &Pair<S>, friction: Lane<S>) -> Self {
        // A call of its own: the code is long.
        simd.vectorize(Call { simd, pair, friction })
    }

    #[inline(always)]
    fn first(simd: S, pair: &Pair<S>, friction: Lane<S>) -> Self {
        let one = pair.constant(1.0);
        let [nut, screw] = &pair.pressed;
        let ball = SlidingBall {
            friction,
            sin: pair.sin_a,
            cos: pair.cos_a,
            cot: pair.cos_a / pair.sin_a,
            arc: pair.arc,
            inertia_ratio: pair.inertia_ratio,
            nut_speed: pair.nut_speed,
            offsets: [nut.offset, screw.offset],
            approaches: [nut.hertz.compliance, screw.hertz.compliance],
            reach: pair.reach(),
        };
        let expected = pair.regular
            & takes(friction.abs(), pair.inertia_ratio)
            // F tanα < 1                                                  (S12)
            & friction.lt(ball.cot)
            & pair.nut_speed.abs().lt(one * MOST_NUT_SPEED);
        let curve = Curve { simd, ball };
        let (level, scale) = curve.begin(pair.cos_b / pair.sin_b, expected);
        // ln μ = ln M + 2 ln |(1 − g)/(π/d + Ω_n/W)|                      (S27)
        let ratio = (level.motion.inertia / level.motion.drive).abs();
        let here = level.state.centrifugal.ln() + ratio.ln() * 2.0;
        let root = pair.inertia_ratio.ln() - here + bsm_dyn::Elastic::NO_INERTIA;
        let inside = level.found & root.lt(one * 0.0) & root.gt(one * bsm_dyn::Elastic::NO_INERTIA);
        let guess = [root, level.place[1], level.place[2]];
        let node = curve.settle::<true>(guess, &scale, inside);

        let sign = (level.motion.drive * level.motion.inertia).lt(one * 0.0);
        let [forwards, backwards] = ball.excess(&node.state, &node.motion);
        let left = (sign.select(backwards, forwards) / node.motion.drive).abs();
        // What the logarithm of q has no finer digits than.
        let digit = node.place[0].abs().max(one) * (4.0 * f64::EPSILON);
        let steady = node.found
            & node.state.is_admissible(&node.motion)
            & node.state.along.lt(one * MOST_LOAD);
        let found = steady & node.is_straight_from(&level, &scale) & left.le(digit);
        let size = (node.state.centrifugal / pair.inertia_ratio).sqrt();
        let (sin, cos) = node.state.turn;
        let half = ((cos + 1.0) * 0.5).sqrt();
        Self {
            ball,
            state: node.state,
            motion: node.motion,
            rate: sign.select(-size, size),
            tilt: (sin * 0.5 / half, half),
            steps: level.steps + node.steps,
            residual: node.left.max(left),
            steady,
            found,
        }
    }

    /// Load over the axial load, sine and cosine of the contact angle, at nut and screw.
    #[inline(always)]
    pub(super) fn contacts(&self) -> [(Lane<S>, Lane<S>, Lane<S>); 2] {
        let SlidingState { loads, sin, cos, .. } = self.state;
        [(loads[0], sin[0], cos[0]), (loads[1], sin[1], cos[1])]
    }

    /// The rotation.
    #[inline(always)]
    pub(super) fn turns(&self, pair: &Pair<S>) -> Turns<S> {
        let SlidingState { sin: [sin_a, _], cos: [cos_a, _], across: [x, _], .. } = self.state;
        let (s, c) = self.tilt;
        // β = β_A + ν                                                     (P3)
        let mean = (sin_a * c + cos_a * s, cos_a * c - sin_a * s);
        // θ_A = atan2(1, x_A)
        let slip = self.motion.slip[0] / (x * x + 1.0).sqrt();
        let (slip_across, slip_along) = (slip * x, slip);
        let gyro = pair.inertia_ratio / (pair.arc * pair.cos_a) * 0.4 * self.rate;
        let SlidingBall { friction, cot, sin: lead, .. } = self.ball;
        // s = −2 F Y cosν/sinα − (I P/W) |V_A| cosθ_A cotα sinβ           (S28)
        let spin =
            -(friction * self.state.along * c * 2.0 / lead) - gyro * slip_across * cot * mean.0;
        // σ = s r_b F_a/(I P)                                             (S3)
        let sigma = spin / gyro;
        // ω'_t = −W λ cosθ,  ω'·e_xA = W (λ sinθ − p d/r_b)               (S5)
        let turning = slip_along - (self.rate - pair.nut_speed) * pair.arc;
        // e_xA = sinν N + cosν e_x                                        (S6)
        let omega = [-slip_across, sigma, (turning - sigma * s) / c];
        Turns { omega, mean, tilt: self.tilt }
    }

    /// Stores slips, torque, efficiency and powers, and returns the violation of the power balance.
    #[inline(always)]
    fn outputs(
        &self,
        out: &mut Out<'_, '_>,
        units: &Units<S>,
        pair: &Pair<S>,
        back: Mask<S>,
    ) -> Lane<S> {
        let SlidingState { across: [x_a, x_b], loads: [q_a, q_b], sin, cos, along, .. } =
            self.state;
        let ([v_a, v_b], one) = (self.motion.slip, pair.constant(1.0));
        let speed = units.speed.abs() * units.ball;
        out.set(OutputKey::nut_slip_velocity_m_s, v_a * speed);
        out.set(OutputKey::screw_slip_velocity_m_s, v_b * speed);
        // P = Ω_n + p W                                                   (S2)
        out.set(OutputKey::ball_precession_rad_s, self.rate * units.speed);
        // Friction is F Y (−x_A, −1) at A and F Y (x_B, 1) at B, across and along  (S13)
        let way = back.select(-one, one);
        slip_angle(out, OutputKey::nut_slip_angle_deg, [-(way * x_a), -way]);
        slip_angle(out, OutputKey::screw_slip_angle_deg, [way * x_b, way]);
        let push = self.ball.friction * along;
        let radius = pair.arc * pair.cos_a;
        // T = [(−r_m n) × F + M]·k of the wrench of the screw             (B7)
        let torque = radius
            * (pair.cos_a * push + pair.sin_a * (q_b * sin[1] - push * x_b * cos[1]))
            + push * x_b * pair.sin_a
            - push * pair.cos_a * cos[1];
        let ideal = ideal_torque(pair.constant(1.0), radius, pair.sin_a / pair.cos_a);
        transmit_torque(out, back, (torque, ideal), units.ball * units.axial, units.speed);
        // P_f = Σ f Q_c |V_c|                                             (R21)
        let lost = self.ball.friction.abs() * (q_a * v_a + q_b * v_b);
        power_balance(out, units.speed, (torque, ideal), lost)
    }
}

/// What [`Skid::of`] is asked for.
struct Call<'a, S: Simd> {
    simd: S,
    pair: &'a Pair<S>,
    friction: Lane<S>,
}

impl<S: Simd> WithSimd for Call<'_, S> {
    type Output = Skid<S>;

    #[inline(always)]
    fn with_simd<Same: Simd>(self, _: Same) -> Skid<S> {
        Skid::first(self.simd, self.pair, self.friction)
    }
}

/// What [`Curve::settle`] is asked for.
struct Settle<'a, S: Simd, const STEADY: bool> {
    curve: &'a Curve<S>,
    guess: [Lane<S>; 3],
    scale: &'a Scale<S>,
    expected: Mask<S>,
}

impl<S: Simd, const STEADY: bool> WithSimd for Settle<'_, S, STEADY> {
    type Output = Node<S>;

    #[inline(always)]
    fn with_simd<Same: Simd>(self, _: Same) -> Node<S> {
        self.curve.settled::<STEADY>(self.guess, self.scale, self.expected)
    }
}

/// The curve of all states of force.
struct Curve<S: Simd> {
    simd: S,
    ball: SlidingBall<Lane<S>>,
}

/// States on it.
struct Node<S: Simd> {
    /// `$\ln q$`, `$x_B$`, `$c$`.
    place: [Lane<S>; 3],
    state: SlidingState<Lane<S>>,
    motion: SlidingMotion<Lane<S>>,
    /// What is left of (S14) and (S20).
    left: Lane<S>,
    steps: Lane<S>,
    found: Mask<S>,
}

/// What is a large step, of `$x_A$`, `$x_B$` and `$c$`.
type Scale<S> = [Lane<S>; 3];

impl<S: Simd> Node<S> {
    /// Where the centrifugal force is proportional to `$q$` from `level` on, and nothing else changes.
    #[inline(always)]
    fn is_straight_from(&self, level: &Self, scale: &Scale<S>) -> Mask<S> {
        let most = self.left.constant(-bsm_dyn::Elastic::NO_INERTIA);
        let growth = (self.place[0] - level.place[0]).min(most).exp();
        let [nut, screw, c] = *scale;
        let large = bsm_dyn::Elastic::LARGE * bsm_dyn::Elastic::RISES;
        let begin = (&level.state, &level.motion);
        self.state.has_only_grown(&self.motion, begin, growth, bsm_dyn::Elastic::RISES)
            & (self.state.across[0] - level.state.across[0]).abs().le(nut * large)
            & (self.place[1] - level.place[1]).abs().le(screw * large)
            & (self.place[2] - level.place[2]).abs().le(c * large)
    }
}

#[inline(always)]
fn cross<S: Simd>(a: &[Lane<S>; 3], b: &[Lane<S>; 3]) -> [Lane<S>; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

impl<S: Simd> Curve<S> {
    /// States without inertia, from the cotangent of the unloaded contact angle, and their scale.
    #[inline(always)]
    fn begin(&self, unloaded: Lane<S>, expected: Mask<S>) -> (Node<S>, Scale<S>) {
        let mut log = unloaded.ln();
        let (mut steps, mut settled) = (log.constant(0.0), !expected);
        for _ in 0..MOST_TO_ANGLE {
            let cot = log.exp();
            let ([x, c], _) = self.ball.level(Slopes::<S, _, 1>::along(cot, 0, cot));
            let none = Slopes::fixed(cot.constant(0.0));
            let (_, [_, left]) = self.ball.state([x, x], none, none, c);
            let one = cot.constant(1.0);
            let step = (left.re / left.eps[0]).max(-one).min(one);
            log = settled.select(log, log - step);
            steps = settled.select(steps, steps + 1.0);
            settled = settled | step.abs().lt(one * NEAR);
            if !(!settled).any() {
                break;
            }
        }
        let ([x, c], effect) = self.ball.level(log.exp());
        let found = expected & settled & effect.gt(x.constant(0.0));
        let scale = self.scale(x, x, c);
        let mut level =
            self.settle::<false>([x.constant(bsm_dyn::Elastic::NO_INERTIA), x, c], &scale, found);
        level.steps = level.steps + steps;
        let [nut, screw] = level.state.across;
        let scale = self.scale(nut, screw, level.place[2]);
        (level, scale)
    }

    #[inline(always)]
    fn scale(&self, nut: Lane<S>, screw: Lane<S>, c: Lane<S>) -> Scale<S> {
        let (sum, least) = (nut + screw, self.ball.sin / self.ball.arc);
        [
            (nut.abs() + least) * 0.3,
            (screw.abs() + least) * 0.3,
            (c.abs() + sum / (sum + 1.0)) * 0.3,
        ]
    }

    /// The states next to a guess: steady motions, or with the same `$q$`.
    #[inline(always)]
    fn settle<const STEADY: bool>(
        &self,
        guess: [Lane<S>; 3],
        scale: &Scale<S>,
        expected: Mask<S>,
    ) -> Node<S> {
        let call = Settle::<S, STEADY> { curve: self, guess, scale, expected };
        self.simd.vectorize(call)
    }

    #[inline(always)]
    fn settled<const STEADY: bool>(
        &self,
        guess: [Lane<S>; 3],
        &[_, by_screw, by_c]: &Scale<S>,
        expected: Mask<S>,
    ) -> Node<S> {
        let (mut place, one) = (guess, guess[0].constant(1.0));
        let zero = one.constant(0.0);
        let (mut steps, mut settled) = (zero, !expected);
        for _ in 0..MOST_STEPS {
            let q = place[0].exp();
            let jets = [
                Slopes::<S, _, 3>::along(q, 0, q),
                Slopes::variable(place[1], 1),
                Slopes::variable(place[2], 2),
            ];
            let (beyond, square) = self.ball.nut_square(jets);
            let [q, screw, c] = jets;
            let (state, [a, b]) = self.ball.state([square.sqrt(), screw], beyond, q, c);
            let (mut left, mut across) = (zero, [one, zero, zero]);
            if STEADY {
                let SlidingMotion { inertia: i, drive: d, .. } = self.ball.motion(&state);
                let (m, ratio) = (state.centrifugal, i.re / d.re);
                // 0 = ln[(M/μ) ((1 − g)/(π/d + Ω_n/W))²]                  (S27)
                left = (m.re / self.ball.inertia_ratio * ratio * ratio).ln();
                for (k, across) in across.iter_mut().enumerate() {
                    *across = m.eps[k] / m.re + (i.eps[k] / i.re - d.eps[k] / d.re) * 2.0;
                }
            }
            let (one_way, two) = (cross(&b.eps, &across), cross(&across, &a.eps));
            let three = cross(&a.eps, &b.eps);
            let size = a.eps[0] * one_way[0] + a.eps[1] * one_way[1] + a.eps[2] * one_way[2];
            let scale = -size.recip();
            let mut step = [zero; 3];
            for k in 0..3 {
                step[k] = (one_way[k] * a.re + two[k] * b.re + three[k] * left) * scale;
            }
            let size = step[0].abs().max((step[1] / by_screw).abs()).max((step[2] / by_c).abs());
            let part = (one.constant(2.0) / size).min(one);
            for k in 0..3 {
                place[k] = settled.select(place[k], place[k] + step[k] * part);
            }
            steps = settled.select(steps, steps + 1.0);
            settled = settled | size.lt(one * SETTLED);
            if !(!settled).any() {
                break;
            }
        }
        let q = place[0].exp();
        let (beyond, square) = self.ball.nut_square([q, place[1], place[2]]);
        let (state, [a, b]) = self.ball.state([square.sqrt(), place[1]], beyond, q, place[2]);
        let motion = self.ball.motion(&state);
        let left = a.abs().max(b.abs());
        let found =
            expected & settled & left.lt(one * bsm_dyn::Elastic::CLOSED) & state.along.gt(zero);
        Node { place, state, motion, left, steps, found }
    }
}
