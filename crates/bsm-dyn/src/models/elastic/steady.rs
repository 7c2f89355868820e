//! Newton's method for states of force and for steady motions. Where the curve of all states is
//! nearly straight, it finds the first steady motion, for one point or for several points side by
//! side.
//!
//! Theory: `docs/theory/08-elastic.md`, equations (S2) to (S6), (S12), (S27), (S28).

use bsm_kin::{Field, FieldOver, Jet};
use bsm_simd::Compare;

use super::states::{SlidingBall, SlidingMotion, SlidingPoint, SlidingState};
use crate::contact::friction_torque;
use crate::models::ball::friction_power;

/// Logarithm of a `$q$` without inertia: next to the smallest normal number.
pub(super) const NO_INERTIA: f64 = -700.0;

/// Relative changes of the factors of (S27) from where the curve begins, up to which the curve is
/// straight: the inertia has only risen up to there.
pub(super) const RISES: f64 = 0.1;

/// The scale of a place on the curve is some third of it: a third of a relative change in its units.
pub(super) const LARGE: f64 = 3.0;

/// What a state of force may leave of (S14) and (S20), both of size one: of a result, where Newton leaves rounding, and of a
/// state on the way to one.
const CLOSED: f64 = 1e-10;
const CLOSED_ON_THE_WAY: f64 = 1e-7;

/// Newton steps to a state; more means that the guess was not near it.
const MOST_TO_STATE: usize = 8;

/// Newton steps to the angle without inertia of several points, and their last one, from which the state
/// without inertia is three digits away.
const MOST_TO_ANGLE: usize = 8;
const LAST_ANGLE_STEP: f64 = 1e-4;

/// Of a walk up to a root along roots of growing inertia: `$\ln\mu$` of the first below that of the root, steps of `$\ln q$`
/// that are aimed at and the longest, their number with those that were too long, and the most growth of `$\ln q$` over
/// that of `$\ln\mu$`: twice what a straight curve has at most.
const BELOW: f64 = 3.0;
const UPWARDS: f64 = 1.0;
const LONGEST: f64 = 1.5;
const MOST_UPWARDS: usize = 12;
const MOST_SLOPE: f64 = 4.0;

/// A step in the scale of a state that leaves an error of about its square: of a result, rounding.
const STEP_TOLERANCE: f64 = 1e-8;
const STEP_ON_THE_WAY: f64 = 1e-4;

/// `$\ln q$`, `$x_B$`, `$c$`: the `$x$` of the nut follows.
pub(super) type Coordinates<F> = [F; 3];

/// A state on the curve.
#[derive(Clone, Copy)]
pub(super) struct CurveState<F: Field> {
    pub(super) point: Coordinates<F>,
    /// Forces and motion there.
    pub(super) at: SlidingPoint<F>,
    /// Residuals of (S14) and (S20).
    pub(super) residual: F,
    /// Newton steps.
    pub(super) steps: F,
    /// Where it is a state.
    pub(super) found: F::Mask,
}

/// A ball that slides on both flanks in steady motion.
#[derive(Clone, Copy)]
pub struct SlidingRoot<F: Field> {
    /// The ball.
    pub ball: SlidingBall<F>,
    /// Its forces and slips.
    pub at: SlidingPoint<F>,
    /// `$P/W$`.
    pub rate: F,
    /// Sine and cosine of the tilt `$\nu$`.
    pub tilt: (F, F),
    /// Newton steps.
    pub steps: F,
    /// Scaled residual.
    pub residual: F,
    /// Where it is a steady motion.
    pub steady: F::Mask,
    /// Where it is the first one on the curve.
    pub found: F::Mask,
}

/// Rotation relative to the nut in the triad of the mean normal (S3), (S5), (S6).
///
/// * `slip`: of the nut across the groove and along it. * `spin`: `$s$`, and `$I P/(r_b F_a)$`.
/// * `tilt`: sine and cosine of `$\nu$`.
#[inline(always)]
pub(super) fn rotation<P, D: FieldOver<P>>(
    arc: P,
    [across, along]: [D; 2],
    p: D,
    (moment, gyration): (D, D),
    (sin, cos): (D, D),
) -> [D; 3] {
    // σ = s r_b F_a / (I P), about the mean normal                        (S3)
    let sigma = moment / gyration;
    // ω'_t = −W λ cosθ,  ω'·e_xA = W (λ sinθ − p d/r_b)                   (S5)
    let turning = along - p * arc;
    // e_xA = sinν N + cosν e_x                                            (S6)
    [-across, sigma, (turning - sigma * sin) / cos]
}

#[inline(always)]
fn cross<F: Field>(a: &[F; 3], b: &[F; 3]) -> [F; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

impl<F: Compare> CurveState<F> {
    /// Where the centrifugal force is proportional to `$q$` from `start` to here, and nothing else in (S27)
    /// changes, nor the place but for `$q$`; to a relative `change`.
    #[inline(always)]
    pub(super) fn is_straight_from(&self, start: &Self, scale: &[F; 3], change: f64) -> F::Mask {
        let rise = self.point[0] - start.point[0];
        let most = rise.constant(-NO_INERTIA);
        let growth = F::select(rise.lt(most), rise, most).exp();
        // A place may be far from the begin and have the factors of the begin again.
        let large = LARGE * change;
        let [x, begin] = [self.at.state.slip_cotangents[0], start.at.state.slip_cotangents[0]];
        self.at.has_only_grown(&start.at, growth, change)
            & (x - begin).abs().le(scale[0] * large)
            & (self.point[1] - start.point[1]).abs().le(scale[1] * large)
            & (self.point[2] - start.point[2]).abs().le(scale[2] * large)
    }

    /// Where it is at most a step from a place.
    #[inline(always)]
    fn is_within(&self, point: &Coordinates<F>, &[_, by_screw, by_c]: &[F; 3]) -> F::Mask {
        (self.point[0] - point[0]).abs().le(by_c.constant(LONGEST))
            & (self.point[1] - point[1]).abs().le(by_screw)
            & (self.point[2] - point[2]).abs().le(by_c)
    }

    /// Scale of a state.
    #[inline(always)]
    pub(super) fn scale(&self, ball: &SlidingBall<F>) -> [F; 3] {
        let [nut, screw] = self.at.state.slip_cotangents;
        ball.scale([nut, screw], self.point[2])
    }
}

/// How many times more than [`CLOSED`] is rounding: where friction all but holds the load, `$Y$` is one over
/// a small difference.
#[inline(always)]
pub(super) fn rounding_floor<F: Compare>(state: &SlidingState<F>) -> F {
    let one = state.push.constant(1.0);
    (state.push * (16.0 * f64::EPSILON / CLOSED)).larger(one)
}

impl<F: Compare> SlidingBall<F> {
    /// Where the contacts carry an axial load at some angles.
    #[inline(always)]
    pub fn carries(&self) -> F::Mask {
        // F tanα < 1, or no contact angles carry an axial load            (S12)
        self.friction.lt(self.cot)
    }

    /// What is a large step of `$x_A$`, `$x_B$` and `$c$`.
    #[inline(always)]
    pub(super) fn scale(&self, [nut, screw]: [F; 2], c: F) -> [F; 3] {
        // Below this, −x_A stays.
        let (sum, least) = (nut + screw, self.sin / self.arc);
        [
            (nut.abs() + least) * 0.3,
            (screw.abs() + least) * 0.3,
            (c.abs() + sum / (sum + 1.0)) * 0.3,
        ]
    }

    /// `$I P/(r_b F_a)$` of a rate over `$W$`.
    #[inline(always)]
    fn gyration(&self, rate: F) -> F {
        self.inertia_ratio / (self.arc * self.cos) * 0.4 * rate
    }

    /// `$s$` of a steady motion.
    ///
    /// * `tilt`: cosine of `$\nu$`. * `mean`: sine of the mean contact angle.
    #[inline(always)]
    pub(super) fn spin_moment(
        &self,
        SlidingPoint { state, motion }: &SlidingPoint<F>,
        rate: F,
        (tilt, mean): (F, F),
    ) -> F {
        let x = state.slip_cotangents[0];
        let across = motion.slip[0] * x / (x.square() + 1.0).sqrt();
        // s = −2 F Y cosν/sinα − (I P/W) |V_A| cosθ_A cotα sinβ           (S28)
        -(self.friction * state.push * tilt * 2.0 / self.sin)
            - self.gyration(rate) * across * self.cot * mean
    }
}

impl<F: Compare> SlidingBall<F>
where
    Jet<1, F>: FieldOver<F> + Field<Mask = F::Mask>,
    Jet<3, F>: FieldOver<F> + Field<Mask = F::Mask>,
{
    /// `$x$` and `$c$` next to where the curve begins, from the cotangent of the unloaded contact angle,
    /// with Newton steps and where they are found.
    #[inline(always)]
    pub(super) fn unloaded_begin(&self, unloaded: F, expected: F::Mask) -> ([F; 2], F, F::Mask) {
        let mut log = unloaded.ln();
        let (mut steps, mut converged) = (log.constant(0.0), !expected);
        for _ in 0..MOST_TO_ANGLE {
            let cot = log.exp();
            let ([x, c], _) = self.equal_angles(Jet::<1, F>::along(cot, 0, cot));
            let none = Jet::fixed(cot.constant(0.0));
            let (_, [_, residual]) = self.state([x, x], none, none, c);
            let (one, step) = (cot.constant(1.0), residual.re / residual.eps[0]);
            let step = F::select(one.lt(step), one, step.larger(-one));
            log = F::select(converged, log, log - step);
            steps = F::select(converged, steps, steps + 1.0);
            converged = converged | step.abs().lt(one * LAST_ANGLE_STEP);
            if !F::any(!converged) {
                break;
            }
        }
        let (found, effect) = self.equal_angles(log.exp());
        (found, steps, expected & converged & effect.gt(effect.constant(0.0)))
    }

    /// The state without inertia next to `$x$` and `$c$`.
    #[inline(always)]
    pub(super) fn state_without_inertia(&self, [x, c]: [F; 2], expected: F::Mask) -> CurveState<F> {
        let guess = [x.constant(NO_INERTIA), x, c];
        self.iterate::<false>(guess, &self.scale([x, x], c), expected)
    }

    /// The first steady motion, if the inertia (S27) only rises up to there, so that no other root is before it: where
    /// the curve is straight, or by a walk along it.
    ///
    /// * `any`: one that serves as a start is enough.
    #[inline(always)]
    pub(super) fn first(&self, start: &CurveState<F>, any: bool) -> SlidingRoot<F> {
        let (zero, one, scale) =
            (self.friction.constant(0.0), self.friction.constant(1.0), start.scale(self));
        // M ~ q, up to where the curve bends. Where nut and screw turn together, the inertia of the begin
        // underflows, its logarithm does not.
        let root = self.inertia_ratio.ln() - start.at.log_inertia() + NO_INERTIA;
        let inside = start.found & root.lt(one * BELOW) & root.gt(one * NO_INERTIA);
        let (mut guess, mut expected) = ([root, start.point[1], start.point[2]], inside);
        let (mut steady, mut found, mut steps) = (zero.lt(zero), zero.lt(zero), start.steps);
        let mut walked = false;
        let (node, residual) = loop {
            let node = self.iterate::<true>(guess, &scale, expected);
            let back = (node.at.motion.drive * node.at.motion.inertia).lt(zero);
            let [forwards, backwards] = self.inertia_residuals(&node.at);
            let residual = (F::select(back, backwards, forwards) / node.at.motion.drive).abs();
            // Some roundings of the terms, and of the logarithm of q; where rounding decides, a search does its best.
            let rounding = node.point[0].abs().larger(one) * (16.0 * f64::EPSILON);
            let admissible = node.found & node.at.is_admissible();
            let near = if walked {
                node.is_within(&guess, &scale)
            } else {
                node.is_straight_from(start, &scale, RISES)
            };
            steady = steady & !expected | admissible;
            found = found & !expected | admissible & near & residual.le(rounding);
            steps = steps + node.steps;
            let rest = inside & !(if any { steady } else { found });
            if walked || !F::any(rest) {
                break (node, residual);
            }
            walked = true;
            let (above, arrived, more_steps) = self.upwards(start, root, &scale, rest);
            for k in 0..3 {
                guess[k] = F::select(arrived, above[k], node.point[k]);
            }
            (expected, steps) = (arrived, steps + more_steps);
        };
        let size = (node.at.state.centrifugal / self.inertia_ratio).sqrt();
        let back = (node.at.motion.drive * node.at.motion.inertia).lt(zero);
        let (sin, cos) = node.at.state.angle_difference;
        let half = ((cos + 1.0) * 0.5).sqrt();
        SlidingRoot {
            ball: *self,
            at: node.at,
            rate: F::select(back, -size, size),
            tilt: (sin * 0.5 / half, half),
            steps,
            residual: node.residual.larger(residual),
            steady,
            found,
        }
    }

    /// A guess of the first steady motion by those of growing inertia, from one where the curve is straight, while every step
    /// is short in the scale of the states and the inertia rises; and the Newton steps.
    ///
    /// * `root`: `$\ln q$` if the curve were straight.
    #[inline(always)]
    fn upwards(
        &self,
        start: &CurveState<F>,
        root: F,
        scale: &[F; 3],
        expected: F::Mask,
    ) -> (Coordinates<F>, F::Mask, F) {
        let (zero, one) = (root.constant(0.0), root.constant(1.0));
        let (mut point, mut before) = (start.point, start.point);
        // How far ln μ is below that of the root, the growth of ln q over that of ln μ, and the step of ln q.
        let (mut below, mut slope, mut length) = (zero, one, one * UPWARDS);
        let (mut steps, mut active, mut arrived) = (zero, expected, zero.lt(zero));
        for step in 0..=MOST_UPWARDS {
            let (mut guess, mut to) = ([root - BELOW, point[1], point[2]], one * BELOW);
            if step > 0 {
                to = (below - length / slope).larger(zero);
                let rise = (below - to) * slope;
                // x_B and c change with q.
                let growth = (rise.exp() - 1.0) / (-(before[0] - point[0]).exp() + 1.0);
                guess[0] = point[0] + rise;
                for k in 1..3 {
                    guess[k] = point[k] + (point[k] - before[k]) * growth;
                }
            }
            let tolerances = (STEP_ON_THE_WAY, CLOSED_ON_THE_WAY);
            let next = self.iterate_to::<true>(tolerances, (guess, to), scale, active);
            steps = steps + next.steps;
            let near = if step == 0 {
                active = active & next.found & next.is_straight_from(start, scale, RISES);
                active
            } else {
                let (rise, rise_of_inertia) = (next.point[0] - point[0], below - to);
                let rises = rise.gt(zero) & rise.lt(rise_of_inertia * MOST_SLOPE);
                let near = next.found & next.is_within(&point, &next.scale(self)) & rises;
                slope = F::select(near, rise / rise_of_inertia, slope);
                length = F::select(near, length, length * 0.5);
                near
            };
            for k in 0..3 {
                before[k] = F::select(near, point[k], before[k]);
                point[k] = F::select(near, next.point[k], point[k]);
            }
            below = F::select(near, to, below);
            arrived = arrived | active & near & to.le(zero);
            active = active & !arrived;
            if !F::any(active) {
                break;
            }
        }
        (point, arrived, steps)
    }

    /// The states next to a guess: steady motions, or with the same `$q$`.
    #[inline(always)]
    pub(super) fn iterate<const STEADY: bool>(
        &self,
        guess: Coordinates<F>,
        scale: &[F; 3],
        expected: F::Mask,
    ) -> CurveState<F> {
        let at = (guess, guess[0].constant(0.0));
        self.iterate_to::<STEADY>((STEP_TOLERANCE, CLOSED), at, scale, expected)
    }

    /// The same to a step and to what (S14) and (S20) may leave.
    ///
    /// * `below`: how far `$\ln\mu$` of the steady motions is below that of the ball.
    #[inline(always)]
    fn iterate_to<const STEADY: bool>(
        &self,
        (last_step, closed): (f64, f64),
        (guess, below): (Coordinates<F>, F),
        &[_, by_screw, by_c]: &[F; 3],
        expected: F::Mask,
    ) -> CurveState<F> {
        let (mut point, one) = (guess, guess[0].constant(1.0));
        let (zero, infinity) = (one.constant(0.0), one.constant(f64::INFINITY));
        let (mut steps, mut converged, mut last) = (zero, !expected, [zero; 3]);
        for _ in 0..MOST_TO_STATE {
            let q = point[0].exp();
            let jets = [
                Jet::<3, F>::along(q, 0, q),
                Jet::variable(point[1], 1),
                Jet::variable(point[2], 2),
            ];
            let (load_excess, square) = self.nut_square(jets);
            let [q, screw, c] = jets;
            let (state, [a, b]) = self.state([square.sqrt(), screw], load_excess, q, c);
            let (mut residual, mut across) = (zero, [one, zero, zero]);
            if STEADY {
                let SlidingMotion { inertia: i, drive: d, .. } = self.motion(&state);
                let (m, ratio) = (state.centrifugal, i.re / d.re);
                // 0 = ln[(M/μ) ((1 − g)/(π/d + Ω_n/W))²], to the last digit of its argument  (S27)
                residual = (m.re / self.inertia_ratio * ratio * ratio).ln() + below;
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
                step[k] = (one_way[k] * a.re + two[k] * b.re + three[k] * residual) * scale;
            }
            let size = step[0].abs().larger((step[1] / by_screw).abs());
            let size = size.larger((step[2] / by_c).abs());
            let fraction = one.constant(2.0) / size;
            let fraction = F::select(fraction.lt(one), fraction, one);
            // Half the way back where no forces belong to a place; a guess without forces stays there.
            let along = state.push.re;
            let real = zero.le(square.re) & along.gt(zero) & along.lt(infinity);
            for k in 0..3 {
                step[k] = F::select(real, step[k] * fraction, last[k] * -0.5);
                point[k] = F::select(converged, point[k], point[k] + step[k]);
                last[k] = F::select(real, step[k], -step[k]);
            }
            steps = F::select(converged, steps, steps + 1.0);
            let lost = !size.lt(infinity);
            converged = converged | real & (size.lt(one * last_step) | lost);
            if !F::any(!converged) {
                break;
            }
        }
        let q = point[0].exp();
        let (load_excess, square) = self.nut_square([q, point[1], point[2]]);
        let (state, [a, b]) = self.state([square.sqrt(), point[1]], load_excess, q, point[2]);
        let at = SlidingPoint { state, motion: self.motion(&state) };
        let residual = a.abs().larger(b.abs());
        let found = expected
            & converged
            & residual.lt(rounding_floor(&state) * closed)
            & state.push.gt(zero)
            & state.push.lt(infinity);
        CurveState { point, at, residual, steps, found }
    }

    /// The first steady motions of several points, where the inertia only rises up to them.
    ///
    /// * `unloaded`: cotangent of the unloaded contact angle. * `any`: one that serves as a start is enough.
    #[inline(always)]
    pub fn first_root(&self, unloaded: F, expected: F::Mask, any: bool) -> SlidingRoot<F> {
        let (begin, steps, found) = self.unloaded_begin(unloaded, expected & self.carries());
        let start = self.state_without_inertia(begin, found);
        let root = self.first(&start, any);
        SlidingRoot { steps: root.steps + steps, ..root }
    }
}

impl<F: Compare> SlidingRoot<F> {
    /// Rotation relative to the nut over `$W$`, in the Frenet-Serret triad `$(t, n, b)$`.
    #[inline(always)]
    pub fn rotation(&self) -> [F; 3] {
        let Self { ball, at, rate, tilt: (s, c), .. } = self;
        let SlidingState { sin: [sin_a, _], cos: [cos_a, _], slip_cotangents: [x, _], .. } =
            at.state;
        // β = β_A + ν                                                     (P3)
        let (sin, cos) = (sin_a * *c + cos_a * *s, cos_a * *c - sin_a * *s);
        // θ_A = atan2(1, x_A)
        let slip = at.motion.slip[0] / (x.square() + 1.0).sqrt();
        let moment = ball.spin_moment(at, *rate, (*c, sin));
        let spin = (moment, ball.gyration(*rate));
        let [along, normal, across] =
            rotation(ball.arc, [slip * x, slip], self.precession(), spin, self.tilt);
        [along, cos * normal - sin * across, sin * normal + cos * across]
    }

    /// Precession relative to the nut, `$p$`.
    #[inline(always)]
    pub fn precession(&self) -> F {
        // P = Ω_n + p W                                                   (S2)
        self.rate - self.ball.nut_speed
    }

    /// Friction on the ball over `$F_a$` at nut and screw, across the groove and along it.
    #[inline(always)]
    pub fn friction(&self) -> [[F; 2]; 2] {
        let SlidingState { slip_cotangents: [x_a, x_b], push, .. } = self.at.state;
        let pull = self.ball.friction * push;
        // Friction is F Y (−x_A, −1) at A and F Y (x_B, 1) at B, across and along  (S13)
        [[-(pull * x_a), -pull], [pull * x_b, pull]]
    }

    /// Torque on the screw per ball over `$r_b F_a$`.
    #[inline(always)]
    pub fn torque(&self) -> F {
        let SlidingState { loads: [_, load], sin: [_, sin], cos: [_, cos], .. } = self.at.state;
        let SlidingBall { sin: sin_a, cos: cos_a, arc, .. } = self.ball;
        friction_torque((load, self.friction()[1]), (sin_a, cos_a), (sin, cos), arc * cos_a)
    }

    /// Power lost in friction over `$r_b F_a |W|$`.
    #[inline(always)]
    pub fn friction_power(&self) -> F {
        friction_power(self.ball.friction.abs(), self.at.state.loads, self.at.motion.slip)
    }
}
