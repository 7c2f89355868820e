//! Newton's method for states on the equilibrium curve and for steady motions, for one operating
//! point or for several points side by side in a SIMD vector. The method finds the first steady
//! motion if the curve is nearly straight up to this motion.
//!
//! Theory: `docs/theory/08-elastic.md`, equations (S2) to (S6), (S12), (S27), (S28).

use bsm_kin::{Jet, Real, RealOver};
use bsm_newton::{LaneEquations, LaneIterate, LaneNewton, LaneStep, cramer};

use super::states::{SlidingBall, SlidingMotion, SlidingPoint, SlidingState};
use crate::contact::unit_ball_torque;
use crate::models::ball::{friction_power, is_in_range};

/// Value of `$\ln q$` (dimensionless) that represents zero inertia. This value is close to the
/// logarithm of the smallest normal floating-point number.
pub(super) const LOG_NO_INERTIA: f64 = -700.0;

/// Maximum relative change of the factors of (S27) from the beginning of the equilibrium curve
/// (dimensionless). Up to this change, the curve is treated as straight. On a straight curve,
/// inertia increases monotonically.
pub(super) const STRAIGHTNESS_TOL: f64 = 0.1;

/// Maximum change of `$x_A$`, `$x_B$` and `$c$` along a section of the equilibrium curve that is
/// treated as straight, in units of [`STRAIGHTNESS_TOL`] times the scale of the coordinate
/// (dimensionless). The scale is about a third of the coordinate.
const MAX_POSITION_CHANGE: f64 = 3.0;

/// Residual tolerance of (S14) and (S20) for a final result (dimensionless). Newton's method
/// reduces the residual until only rounding errors remain.
const RESIDUAL_TOL: f64 = 1e-10;

/// Residual tolerance of (S14) and (S20) for an intermediate state (dimensionless).
const PREDICTOR_RESIDUAL_TOL: f64 = 1e-7;

/// Limits of Newton's method for a state on the equilibrium curve. Step lengths are relative to the
/// scales of the coordinates. After a step of 1e-8, the error is of the order of the square of the
/// step, which is smaller than the rounding errors. If Newton's method does not converge within 8
/// steps, the starting value was not close to the curve.
const STATE_NEWTON: LaneNewton = LaneNewton { step_tol: 1e-8, max_length: 2.0, max_steps: 8 };

/// Limits of Newton's method for the contact angle at zero inertia. Step lengths are changes of the
/// logarithm of the cotangent (dimensionless). The result needs only three digits, because it is
/// the starting value for the state at zero inertia.
const ANGLE_NEWTON: LaneNewton = LaneNewton { step_tol: 1e-4, max_length: 1.0, max_steps: 8 };

/// Largest ratio of normal load to axial load (dimensionless) at which a root found directly by
/// Newton's method is accepted. Above this ratio, friction alone can nearly hold the axial load,
/// and rounding errors affect the result.
const MAX_ACCURATE_LOAD_RATIO: f64 = 1e3;

/// Largest ratio of nut speed to relative speed (dimensionless) at which a root found directly by
/// Newton's method is accepted. Above this ratio, rounding errors of the two speeds dominate the
/// residual.
const MAX_NUT_SPEED: f64 = 1e4;

/// Distance in `$\ln\mu$` (dimensionless) between the first state of the continuation and the root.
const START_DISTANCE: f64 = 3.0;

/// Initial step length of the continuation in `$\ln q$` (dimensionless).
const FIRST_STEP: f64 = 1.0;

/// Maximum step length of the continuation in `$\ln q$` (dimensionless).
const MAX_STEP: f64 = 1.5;

/// Maximum number of steps of the continuation, including rejected steps.
const MAX_CONTINUATION_STEPS: usize = 12;

/// Maximum ratio of the step in `$\ln q$` to the step in `$\ln\mu$` (dimensionless). This limit is
/// twice the largest ratio along a straight curve.
const MAX_SLOPE: f64 = 4.0;

/// Step length at which Newton's method stops for an intermediate state, in units of the scales of
/// the coordinates (dimensionless).
const PREDICTOR_STEP_TOL: f64 = 1e-4;

/// Coordinates `$\ln q$`, `$x_B$` and `$c$` of a state. The fourth coordinate `$x_A$` is calculated
/// from (S19).
pub(super) type Coordinates<F> = [F; 3];

/// A state on the equilibrium curve, together with the residual and the number of Newton steps of
/// the solve.
#[derive(Clone, Copy)]
pub(super) struct CurveState<F: Real> {
    pub(super) point: Coordinates<F>,
    /// Forces on the ball, and its motion.
    pub(super) at: SlidingPoint<F>,
    /// Largest residual of (S14) and (S20).
    pub(super) residual: F,
    /// Number of Newton steps.
    pub(super) steps: F,
    /// True if Newton's method converged.
    pub(super) converged: F::Mask,
}

/// A steady motion of a ball that slides at both contacts.
#[derive(Clone, Copy)]
pub struct SlidingRoot<F: Real> {
    /// Ball, friction and speeds at the operating point.
    pub ball: SlidingBall<F>,
    /// Forces on the ball, and its motion.
    pub at: SlidingPoint<F>,
    /// Absolute precession rate `$P/W$`.
    pub rate: F,
    /// Sine and cosine of the tilt `$\nu$`.
    pub tilt: (F, F),
    /// Number of Newton steps.
    pub steps: F,
    /// Largest scaled residual of the equations.
    pub residual: F,
    /// True if the result is a steady motion and can serve as a starting value.
    pub steady: F::Mask,
    /// True if the result is certainly the first steady motion on the equilibrium curve.
    pub is_first_root: F::Mask,
}

/// Returns the angular velocity relative to the nut, divided by `$W$`, in the triad of the mean
/// contact normal (S3), (S5), (S6).
///
/// * `[across, along]`: slip at the nut across and along the groove.
/// * `(moment, gyration)`: spin moment `$s$`, and the factor `$I P/(r_b F_a)$`.
/// * `(sin, cos)`: sine and cosine of the tilt `$\nu$`.
#[inline(always)]
pub(super) fn rotation<P, D: RealOver<P>>(
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

impl<F: Real> CurveState<F> {
    /// Returns true if the equilibrium curve is straight from `start` to this state. On a straight
    /// curve, the centrifugal force is proportional to `$q$`, and all other factors of (S27) and
    /// all other coordinates are constant within a relative tolerance `change`.
    #[inline(always)]
    pub(super) fn is_straight_from(&self, start: &Self, scale: &[F; 3], change: f64) -> F::Mask {
        let rise = self.point[0] - start.point[0];
        let limit = rise.constant(-LOG_NO_INERTIA);
        let growth = F::select(rise.lt(limit), rise, limit).exp();
        // Checking the factors of (S27) is not enough, because these factors may have equal values
        // at a distant point of the curve.
        let max_change = MAX_POSITION_CHANGE * change;
        let [x, begin] = [self.at.state.slip_cotangents[0], start.at.state.slip_cotangents[0]];
        self.at.has_only_grown(&start.at, growth, change)
            & (x - begin).abs().le(scale[0] * max_change)
            & (self.point[1] - start.point[1]).abs().le(scale[1] * max_change)
            & (self.point[2] - start.point[2]).abs().le(scale[2] * max_change)
    }

    /// Returns true if this state is at most one continuation step away from a given point of the
    /// equilibrium curve.
    #[inline(always)]
    fn is_within(&self, point: &Coordinates<F>, &[_, by_screw, by_c]: &[F; 3]) -> F::Mask {
        (self.point[0] - point[0]).abs().at_most(MAX_STEP)
            & (self.point[1] - point[1]).abs().le(by_screw)
            & (self.point[2] - point[2]).abs().le(by_c)
    }

    /// Returns the scales of `$x_A$`, `$x_B$` and `$c$`.
    #[inline(always)]
    pub(super) fn scale(&self, ball: &SlidingBall<F>) -> [F; 3] {
        let [nut, screw] = self.at.state.slip_cotangents;
        ball.scale([nut, screw], self.point[2])
    }
}

/// Returns the ratio of the rounding errors of the residuals to [`RESIDUAL_TOL`], but at least one.
/// Rounding errors are large if friction alone can nearly hold the load, because `$Y$` is then the
/// reciprocal of a small difference.
#[inline(always)]
pub(super) fn rounding_floor<F: Real>(state: &SlidingState<F>) -> F {
    let one = state.load_parameter.constant(1.0);
    (state.load_parameter * (16.0 * f64::EPSILON / RESIDUAL_TOL)).larger(one)
}

impl<F: Real> SlidingBall<F> {
    /// Returns true if the contacts can carry an axial load at some contact angle (S12).
    #[inline(always)]
    pub fn can_carry_load(&self) -> F::Mask {
        // F tanα < 1; otherwise, no contact angles carry an axial load    (S12)
        self.friction.lt(self.cot)
    }

    /// Returns the scales of `$x_A$`, `$x_B$` and `$c$`. Each scale is about one third of the
    /// magnitude of its coordinate.
    #[inline(always)]
    pub(super) fn scale(&self, [nut, screw]: [F; 2], c: F) -> [F; 3] {
        // sinα/d is an upper limit of −x_A.
        let (sum, least) = (nut + screw, self.sin / self.arc);
        [
            (nut.abs() + least) * 0.3,
            (screw.abs() + least) * 0.3,
            (c.abs() + sum / (sum + 1.0)) * 0.3,
        ]
    }

    /// Returns the factor `$I P/(r_b F_a)$` for the precession rate `$P/W$`.
    #[inline(always)]
    fn gyration(&self, rate: F) -> F {
        self.inertia_ratio / (self.arc * self.cos) * 0.4 * rate
    }

    /// Returns the spin moment `$s$` of a steady motion (S28).
    ///
    /// * `tilt`: cosine of the tilt angle `$\nu$`.
    /// * `mean`: sine of the mean contact angle.
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
        -(self.friction * state.load_parameter * tilt * 2.0 / self.sin)
            - self.gyration(rate) * across * self.cot * mean
    }
}

impl<F: Real> SlidingBall<F>
where
    Jet<1, F>: RealOver<F> + Real<Mask = F::Mask>,
    Jet<3, F>: RealOver<F> + Real<Mask = F::Mask>,
{
    /// Estimates the cotangents `$x$` of the slip angles and the value of `$c$` at the beginning of
    /// the equilibrium curve. Also returns the number of Newton steps, and a mask that is true if
    /// the estimate was found.
    ///
    /// * `unloaded`: cotangent of the unloaded contact angle.
    /// * `expected`: mask of the points for which an estimate is requested.
    #[inline(always)]
    pub(super) fn static_beginning(&self, unloaded: F, expected: F::Mask) -> ([F; 2], F, F::Mask) {
        let mut at = LaneIterate::starting_at([unloaded.ln()], expected);
        ANGLE_NEWTON.iterate(&StaticAngle { ball: self }, &mut at);
        let (found, effect) = self.equal_angles(at.x[0].exp());
        (found, at.steps, expected & at.has_ended & effect.above(0.0))
    }

    /// Finds the force equilibrium at zero inertia, starting from an estimate of `$x$` and `$c$`.
    #[inline(always)]
    pub(super) fn state_without_inertia(&self, [x, c]: [F; 2], expected: F::Mask) -> CurveState<F> {
        let guess = [x.constant(LOG_NO_INERTIA), x, c];
        self.iterate::<false>(guess, &self.scale([x, x], c), expected)
    }

    /// Finds the first steady motion, provided that the inertia (S27) increases monotonically from
    /// the beginning of the equilibrium curve to this motion. If the curve is straight, the motion
    /// is found by Newton's method, otherwise by continuation.
    ///
    /// * `any`: true if any root is acceptable because it only serves as a starting value.
    #[inline(always)]
    pub(super) fn first(&self, start: &CurveState<F>, any: bool) -> SlidingRoot<F> {
        let (zero, one, scale) =
            (self.friction.constant(0.0), self.friction.constant(1.0), start.scale(self));
        // Where the equilibrium curve is straight, M is proportional to q. If the nut and the screw
        // turn at nearly the same speed, the inertia at the beginning of the curve underflows, but
        // the logarithm of the inertia does not.
        let root = self.inertia_ratio.ln() - start.at.log_inertia() + LOG_NO_INERTIA;
        let inside = start.converged & root.below(START_DISTANCE) & root.above(LOG_NO_INERTIA);
        let (mut guess, mut expected) = ([root, start.point[1], start.point[2]], inside);
        let (mut steady, mut is_first_root, mut steps) =
            (zero.mask(false), zero.mask(false), start.steps);
        let mut continued = false;
        let (node, residual) = loop {
            let node = self.iterate::<true>(guess, &scale, expected);
            let back = (node.at.motion.drive * node.at.motion.inertia).below(0.0);
            let [forwards, backwards] = self.inertia_residuals(&node.at);
            let residual = (F::select(back, backwards, forwards) / node.at.motion.drive).abs();
            // `rounding` is an upper limit of the rounding errors of the terms and of the logarithm
            // of q.
            let rounding = node.point[0].abs().larger(one) * (16.0 * f64::EPSILON);
            let admissible = node.converged & node.at.is_admissible();
            let near = if continued {
                node.is_within(&guess, &scale)
            } else {
                node.is_straight_from(start, &scale, STRAIGHTNESS_TOL)
            };
            steady = steady & !expected | admissible;
            is_first_root = is_first_root & !expected | admissible & near & residual.le(rounding);
            steps = steps + node.steps;
            let rest = inside & !(if any { steady } else { is_first_root });
            if continued || !F::any(rest) {
                break (node, residual);
            }
            continued = true;
            let (above, arrived, more_steps) = self.continued(start, root, &scale, rest);
            for k in 0..3 {
                guess[k] = F::select(arrived, above[k], node.point[k]);
            }
            (expected, steps) = (arrived, steps + more_steps);
        };
        let size = (node.at.state.centrifugal / self.inertia_ratio).sqrt();
        let back = (node.at.motion.drive * node.at.motion.inertia).below(0.0);
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
            is_first_root,
        }
    }

    /// Estimates the first steady motion by continuation in inertia. Also returns a mask that is
    /// true if the motion was found, and the number of Newton steps. The continuation begins at a
    /// steady motion on the straight part of the equilibrium curve. The continuation stops if a
    /// step is long compared with the scales of the coordinates or if the inertia does not
    /// increase.
    ///
    /// * `root`: value that `$\ln q$` would have at the root if the curve were straight.
    #[inline(always)]
    fn continued(
        &self,
        start: &CurveState<F>,
        root: F,
        scale: &[F; 3],
        expected: F::Mask,
    ) -> (Coordinates<F>, F::Mask, F) {
        let (zero, one) = (root.constant(0.0), root.constant(1.0));
        let (mut point, mut before) = (start.point, start.point);
        // `below` is the distance to the root in ln μ, `slope` is the ratio of the step in ln q to
        // the step in ln μ, and `length` is the step in ln q.
        let (mut below, mut slope, mut length) = (zero, one, one * FIRST_STEP);
        let (mut steps, mut active, mut arrived) = (zero, expected, zero.mask(false));
        for step in 0..=MAX_CONTINUATION_STEPS {
            let (mut guess, mut to) =
                ([root - START_DISTANCE, point[1], point[2]], one * START_DISTANCE);
            if step > 0 {
                to = (below - length / slope).larger(zero);
                let rise = (below - to) * slope;
                // x_B and c are extrapolated linearly as functions of q.
                let growth = (rise.exp() - 1.0) / (-(before[0] - point[0]).exp() + 1.0);
                guess[0] = point[0] + rise;
                for k in 1..3 {
                    guess[k] = point[k] + (point[k] - before[k]) * growth;
                }
            }
            let tolerances = (PREDICTOR_STEP_TOL, PREDICTOR_RESIDUAL_TOL);
            let next = self.iterate_to::<true>(tolerances, (guess, to), scale, active);
            steps = steps + next.steps;
            let near = if step == 0 {
                active =
                    active & next.converged & next.is_straight_from(start, scale, STRAIGHTNESS_TOL);
                active
            } else {
                let (rise, rise_of_inertia) = (next.point[0] - point[0], below - to);
                let rises = rise.above(0.0) & rise.lt(rise_of_inertia * MAX_SLOPE);
                let near = next.converged & next.is_within(&point, &next.scale(self)) & rises;
                slope = F::select(near, rise / rise_of_inertia, slope);
                length = F::select(near, length, length * 0.5);
                near
            };
            for k in 0..3 {
                before[k] = F::select(near, point[k], before[k]);
                point[k] = F::select(near, next.point[k], point[k]);
            }
            below = F::select(near, to, below);
            arrived = arrived | active & near & to.at_most(0.0);
            active = active & !arrived;
            if !F::any(active) {
                break;
            }
        }
        (point, arrived, steps)
    }

    /// Finds a force equilibrium near a starting value: a steady motion if `STEADY` is true, and
    /// otherwise the equilibrium for the value of `$q$` in `guess`.
    #[inline(always)]
    pub(super) fn iterate<const STEADY: bool>(
        &self,
        guess: Coordinates<F>,
        scale: &[F; 3],
        expected: F::Mask,
    ) -> CurveState<F> {
        let at = (guess, guess[0].constant(0.0));
        self.iterate_to::<STEADY>((STATE_NEWTON.step_tol, RESIDUAL_TOL), at, scale, expected)
    }

    /// Finds a force equilibrium near a starting value, with the given tolerances.
    ///
    /// * `below`: `$\ln\mu$` of the ball minus `$\ln\mu$` of the steady motion.
    #[inline(always)]
    fn iterate_to<const STEADY: bool>(
        &self,
        (step_tol, residual_tol): (f64, f64),
        (guess, below): (Coordinates<F>, F),
        &[_, by_screw, by_c]: &[F; 3],
        expected: F::Mask,
    ) -> CurveState<F> {
        let equations = StateEquations::<F, STEADY> { ball: self, scale: [by_screw, by_c], below };
        let mut at = LaneIterate::starting_at(guess, expected);
        LaneNewton { step_tol, ..STATE_NEWTON }.iterate(&equations, &mut at);
        let LaneIterate { x: point, steps, has_ended } = at;
        let q = point[0].exp();
        let (load_excess, square) = self.nut_cotangent_square([q, point[1], point[2]]);
        let (state, [a, b]) = self.state([square.sqrt(), point[1]], load_excess, q, point[2]);
        let at = SlidingPoint { state, motion: self.motion(&state) };
        let residual = a.abs().larger(b.abs());
        let converged = expected
            & has_ended
            & residual.lt(rounding_floor(&state) * residual_tol)
            & state.load_parameter.above(0.0)
            & state.load_parameter.below(f64::INFINITY);
        CurveState { point, at, residual, steps, converged }
    }

    /// Finds the first steady motion by Newton's method from the beginning of the equilibrium
    /// curve. The field `is_first_root` of the result is false if another root could precede the
    /// result or if rounding errors could affect the result.
    ///
    /// * `unloaded`: cotangent of the unloaded contact angle.
    /// * `requested`: mask of the points to solve.
    /// * `any`: true if any root is acceptable because it only serves as a starting value.
    #[inline(always)]
    pub fn direct_root(&self, unloaded: F, requested: F::Mask, any: bool) -> SlidingRoot<F> {
        let requested = requested
            & is_in_range(self.friction.abs(), self.inertia_ratio)
            & self.nut_speed.abs().below(MAX_NUT_SPEED)
            & self.can_carry_load();
        let (beginning, steps, found) = self.static_beginning(unloaded, requested);
        let start = self.state_without_inertia(beginning, found);
        let root = self.first(&start, any);
        let is_accurate = root.at.state.load_parameter.below(MAX_ACCURATE_LOAD_RATIO);
        let (steady, is_first_root) = (root.steady & is_accurate, root.is_first_root & is_accurate);
        SlidingRoot { steps: root.steps + steps, steady, is_first_root, ..root }
    }
}

/// Equation (S20) at zero inertia. Both contact angles are equal, and the unknown is the logarithm
/// of their cotangent.
struct StaticAngle<'a, F> {
    ball: &'a SlidingBall<F>,
}

impl<F: Real> LaneEquations<F, 1> for StaticAngle<'_, F>
where
    Jet<1, F>: RealOver<F> + Real<Mask = F::Mask>,
{
    #[inline(always)]
    fn newton_step(&self, &[log]: &[F; 1]) -> LaneStep<F, 1> {
        let cot = log.exp();
        let ([x, c], _) = self.ball.equal_angles(Jet::<1, F>::along(cot, 0, cot));
        let none = Jet::fixed(cot.constant(0.0));
        let (_, [_, residual]) = self.ball.state([x, x], none, none, c);
        let step = -(residual.re / residual.eps[0]);
        LaneStep { step: [step], length: step.abs(), is_defined: step.mask(true) }
    }
}

/// Equations (S14) and (S20), together with a third equation: (S27) for a steady motion, or a given
/// value of `$q$`.
struct StateEquations<'a, F, const STEADY: bool> {
    ball: &'a SlidingBall<F>,
    /// Scales of `$x_B$` and `$c$`; the scale of `$\ln q$` is one.
    scale: [F; 2],
    /// Difference between `$\ln\mu$` of the ball and `$\ln\mu$` of the steady motion.
    below: F,
}

impl<F: Real, const STEADY: bool> LaneEquations<F, 3> for StateEquations<'_, F, STEADY>
where
    Jet<3, F>: RealOver<F> + Real<Mask = F::Mask>,
{
    #[inline(always)]
    fn newton_step(&self, x: &Coordinates<F>) -> LaneStep<F, 3> {
        let (q, ball) = (x[0].exp(), self.ball);
        let (zero, one) = (q.constant(0.0), q.constant(1.0));
        let jets = [Jet::<3, F>::along(q, 0, q), Jet::variable(x[1], 1), Jet::variable(x[2], 2)];
        let (load_excess, square) = ball.nut_cotangent_square(jets);
        let [q, screw, c] = jets;
        let (state, [rotation, closure]) = ball.state([square.sqrt(), screw], load_excess, q, c);
        let (mut residual, mut row) = (zero, [one, zero, zero]);
        if STEADY {
            let SlidingMotion { inertia: i, drive: d, .. } = ball.motion(&state);
            let (m, ratio) = (state.centrifugal, i.re / d.re);
            // 0 = ln[(M/μ) ((1 − g)/(π/d + Ω_n/W))²], without cancellation  (S27)
            residual = (m.re / ball.inertia_ratio * ratio * ratio).ln() + self.below;
            for (k, slope) in row.iter_mut().enumerate() {
                *slope = m.eps[k] / m.re + (i.eps[k] / i.re - d.eps[k] / d.re) * 2.0;
            }
        }
        let step = cramer([rotation.re, closure.re, residual], [rotation.eps, closure.eps, row]);
        let [by_screw, by_c] = self.scale;
        let length = step[0].abs().larger((step[1] / by_screw).abs());
        let length = length.larger((step[2] / by_c).abs());
        let load_parameter = state.load_parameter.re;
        let is_defined = square.re.at_least(0.0)
            & load_parameter.above(0.0)
            & load_parameter.below(f64::INFINITY);
        LaneStep { step, length, is_defined }
    }
}

impl<F: Real> SlidingRoot<F> {
    /// Returns the angular velocity relative to the nut, divided by `$W$`, in the Frenet-Serret
    /// triad `$(t, n, b)$`.
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

    /// Returns the precession rate `$p$` relative to the nut.
    #[inline(always)]
    pub fn precession(&self) -> F {
        // P = Ω_n + p W                                                   (S2)
        self.rate - self.ball.nut_speed
    }

    /// Returns the friction forces on the ball at the nut and the screw, divided by `$F_a$`. Each
    /// force has a component across the groove and a component along the groove.
    #[inline(always)]
    pub fn friction(&self) -> [[F; 2]; 2] {
        let SlidingState { slip_cotangents: [x_a, x_b], load_parameter, .. } = self.at.state;
        let friction = self.ball.friction * load_parameter;
        // The forces (across, along) are F Y (−x_A, −1) at A and F Y (x_B, 1) at B  (S13)
        [[-(friction * x_a), -friction], [friction * x_b, friction]]
    }

    /// Returns the torque on the screw per ball, divided by `$r_b F_a$`.
    #[inline(always)]
    pub fn torque(&self) -> F {
        let SlidingState { loads: [_, load], sin: [_, sin], cos: [_, cos], .. } = self.at.state;
        let SlidingBall { sin: sin_a, cos: cos_a, arc, .. } = self.ball;
        unit_ball_torque((load, self.friction()[1]), (sin_a, cos_a), (sin, cos), arc * cos_a)
    }

    /// Returns the friction power, divided by `$r_b F_a |W|$`.
    #[inline(always)]
    pub fn friction_power(&self) -> F {
        friction_power(self.ball.friction.abs(), self.at.state.loads, self.at.motion.slip)
    }
}
