//! The curve of all states of balanced forces of a ball with saturated friction, for any inertia.
//!
//! Theory: `docs/theory/08-elastic.md`, equations (S13), (S14), (S19), (S20), (S26) to (S28).

use bsm_kin::{Field, Jet, Over, Scalar};
use bsm_newton::{Bracket, EvalError, FunctionValue, Homotopy};

use super::states::{SlidingBall, SlidingPoint, SlidingState};
use super::steady::rounding_floor;
use crate::models::ball::unknown::{
    NUT_LOAD, PRECESSION, SCREW_LOAD, SLIP, SLIP_ANGLE, SPIN, TILT,
};
use crate::models::ball::{BALL, linear};

/// What may be left of (S20) before the Newton steps to the begin of the curve.
const LEVEL: f64 = 1e-9;

/// Range of the cotangent of a loaded contact angle. The load turns the ball to a steeper angle, up to
/// next to 90 deg on soft material; an unloaded angle of next to 0 has none that is a number.
const COTANGENT: [f64; 2] = [1e-12, 1e12];

/// Equations and unknowns of the curve: `$\ln q$`, `$x_A$`, `$x_B$`, `$c$`.
pub(super) const HELD: usize = 3;
pub(super) const CURVE: usize = HELD + 1;

/// No forces belong to a place.
const NO_FORCES: EvalError = EvalError {
    quantity: "the load over the axial load",
    value: f64::NAN,
    requirement: "positive",
};

impl Homotopy<HELD, CURVE> for SlidingBall<f64> {
    fn residual(&self, z: &[f64; CURVE]) -> Result<[f64; HELD], EvalError> {
        self.state_at(z).map(|(_, residual)| residual).ok_or(NO_FORCES)
    }

    fn linearize(
        &self,
        z: &[f64; CURVE],
    ) -> Result<([f64; HELD], [[f64; CURVE]; HELD]), EvalError> {
        linear(z, |z| self.state_at(z).map(|(_, residual)| residual).ok_or(NO_FORCES))
    }

    fn weights(&self, z: &[f64; CURVE]) -> [f64; HELD] {
        let w = self.state_at(z).map_or(1.0, |(state, _)| rounding_floor(&state).recip());
        [w, w, (z[1] * z[1] + z[2] * z[2]).recip()]
    }

    fn sizes(&self, &[_, nut, screw, c]: &[f64; CURVE]) -> [f64; CURVE] {
        let [nut, screw, c] = self.scale([nut, screw], c);
        [1.0, nut, screw, c]
    }
}

impl SlidingBall<f64> {
    /// The state at a point of the curve, and what it leaves of (S14), (S20) and (S19).
    pub(super) fn state_at<D: Over<f64>>(
        &self,
        &[log, nut, screw, c]: &[D; CURVE],
    ) -> Option<(SlidingState<D>, [D; HELD])> {
        let q = log.re().exp();
        let q = (log - D::from(log.re())) * q + q;
        let (load_excess, square) = self.nut_square([q, screw, c]);
        let (state, [triangle, radial_distance]) =
            self.state_of([nut, screw], load_excess, q, c)?;
        Some((state, [triangle, radial_distance, nut.square() - square]))
    }

    /// The state of `$x$` at nut and screw, `$\delta$`, `$q$` and `$c$`.
    fn state_of<D: Over<f64>>(
        &self,
        across: [D; 2],
        load_excess: D,
        q: D,
        c: D,
    ) -> Option<(SlidingState<D>, [D; 2])> {
        let (state, residual) = self.state(across, load_excess, q, c);
        let along = state.push.re();
        (along > 0.0 && along.is_finite()).then_some((state, residual))
    }

    /// Unknowns (S1) of a root of (S26), `sign` that of `$P/W$`.
    pub(super) fn unknowns(&self, at: &SlidingPoint<f64>, sign: f64) -> [f64; BALL] {
        let (s, k) = (&at.state, &at.motion);
        let rate = sign * (s.centrifugal / self.inertia_ratio).sqrt();
        let tilt = 0.5 * s.angle_difference.0.atan2(s.angle_difference.1);
        let mean = s.sin[0].atan2(s.cos[0]) + tilt;
        let mut y = [0.0; BALL];
        [y[NUT_LOAD], y[SCREW_LOAD]] = s.loads;
        y[TILT] = tilt;
        y[PRECESSION] = rate - self.nut_speed;
        y[SLIP] = k.slip[0];
        y[SLIP_ANGLE] = 1.0_f64.atan2(s.slip_cotangents[0]);
        y[SPIN] = self.spin_moment(at, rate, (tilt.cos(), mean.sin()));
        y
    }

    /// `$x$` and `$c$` where the curve begins, without inertia: a guess; counts evaluations.
    ///
    /// * `unloaded`: contact angle \[rad\].
    pub(super) fn begin(&self, unloaded: f64, steps: &mut usize) -> Option<[f64; 2]> {
        let bracket = Bracket {
            start: Some(-unloaded.tan().ln()),
            x_tol: 4.0 * f64::EPSILON,
            f_tol: LEVEL,
            ..Bracket::new(COTANGENT.map(f64::ln), [f64::NEG_INFINITY, f64::INFINITY])
        };
        // What (S20) leaves at the angle whose cotangent has this logarithm; too much if friction holds.
        let found = bracket.root(|log| {
            *steps += 1;
            let cot = log.exp();
            let residual =
                carried(self.equal_angles(Jet { re: cot, eps: [cot] })).and_then(|[x, c]| {
                    let q = Jet::from(0.0);
                    let (load_excess, square) = self.nut_square([q, x, c]);
                    if square.re < 0.0 {
                        return None;
                    }
                    let (_, [_, residual]) =
                        self.state_of([square.sqrt(), x], load_excess, q, c)?;
                    let [slope] = residual.eps;
                    residual.re.is_finite().then_some(FunctionValue::from((residual.re, slope)))
                });
            residual.unwrap_or(f64::INFINITY.into())
        });
        carried(self.equal_angles(found.root()?.x.exp()))
    }
}

/// `$x$` and `$c$` of equal contact angles, if they carry the load.
fn carried<D: Scalar>((point, effect): ([D; 2], D)) -> Option<[D; 2]> {
    (effect.re() > 0.0).then_some(point)
}
