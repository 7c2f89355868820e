//! The equilibrium curve: all states, for any inertia, in which the forces on a ball with saturated
//! friction balance.
//!
//! Theory: `docs/theory/08-elastic.md`, equations (S13), (S14), (S19), (S20), (S26) to (S28).

use bsm_kin::{Jet, Over, Real, Scalar};
use bsm_newton::{Bracket, CurveEquations, EvalError, FunctionValue};

use super::states::{SlidingBall, SlidingPoint, SlidingState};
use super::steady::rounding_floor;
use crate::models::ball::unknown::{
    NUT_LOAD, PRECESSION, SCREW_LOAD, SLIP, SLIP_ANGLE, SPIN, TILT,
};
use crate::models::ball::{BALL_UNKNOWNS, linear};

/// Residual tolerance of (S20) for the starting value of the Newton iteration that finds the
/// beginning of the equilibrium curve (dimensionless).
const START_RESIDUAL_TOL: f64 = 1e-9;

/// Minimum and maximum cotangent of a loaded contact angle (dimensionless). The load increases the
/// contact angle, up to nearly 90 degrees on soft materials. The upper limit excludes unloaded
/// contact angles whose cotangent overflows.
const COTANGENT_RANGE: [f64; 2] = [1e-12, 1e12];

/// Number of equations of the equilibrium curve: (S14), (S19) and (S20).
pub(super) const CURVE_EQUATIONS: usize = 3;

/// Number of unknowns of the equilibrium curve: `$\ln q$`, `$x_A$`, `$x_B$` and `$c$`.
pub(super) const CURVE_UNKNOWNS: usize = CURVE_EQUATIONS + 1;

/// Error that is returned at points where the forces cannot be in equilibrium.
const NO_FORCES: EvalError = EvalError {
    quantity: "ratio of normal load to axial load",
    value: f64::NAN,
    requirement: "must be positive",
};

impl CurveEquations<CURVE_EQUATIONS, CURVE_UNKNOWNS> for SlidingBall<f64> {
    fn residual(&self, z: &[f64; CURVE_UNKNOWNS]) -> Result<[f64; CURVE_EQUATIONS], EvalError> {
        self.state_at(z).map(|(_, residual)| residual).ok_or(NO_FORCES)
    }

    fn linearize(
        &self,
        z: &[f64; CURVE_UNKNOWNS],
    ) -> Result<([f64; CURVE_EQUATIONS], [[f64; CURVE_UNKNOWNS]; CURVE_EQUATIONS]), EvalError> {
        linear(z, |z| self.state_at(z).map(|(_, residual)| residual).ok_or(NO_FORCES))
    }

    fn weights(&self, z: &[f64; CURVE_UNKNOWNS]) -> [f64; CURVE_EQUATIONS] {
        let w = self.state_at(z).map_or(1.0, |(state, _)| rounding_floor(&state).recip());
        [w, w, (z[1] * z[1] + z[2] * z[2]).recip()]
    }

    fn sizes(&self, &[_, nut, screw, c]: &[f64; CURVE_UNKNOWNS]) -> [f64; CURVE_UNKNOWNS] {
        let [nut, screw, c] = self.scale([nut, screw], c);
        [1.0, nut, screw, c]
    }
}

impl SlidingBall<f64> {
    /// Returns the state of the ball at a point of the equilibrium curve, together with the
    /// residuals of (S14), (S20) and (S19). Returns `None` if the forces cannot be in equilibrium.
    pub(super) fn state_at<D: Over<f64>>(
        &self,
        &[log, nut, screw, c]: &[D; CURVE_UNKNOWNS],
    ) -> Option<(SlidingState<D>, [D; CURVE_EQUATIONS])> {
        let q = log.re().exp();
        let q = (log - D::from(log.re())) * q + q;
        let (load_excess, square) = self.nut_cotangent_square([q, screw, c]);
        let (state, [rotation, closure]) = self.state_of([nut, screw], load_excess, q, c)?;
        Some((state, [rotation, closure, nut.square() - square]))
    }

    /// Returns the state of the ball for given cotangents of the slip angles (`$x_A$`, `$x_B$`) and
    /// given values of `$\delta$`, `$q$` and `$c$` in (S18) and (S19), together with the residuals
    /// of (S14) and (S20). Returns `None` if the forces cannot be in equilibrium.
    fn state_of<D: Over<f64>>(
        &self,
        across: [D; 2],
        load_excess: D,
        q: D,
        c: D,
    ) -> Option<(SlidingState<D>, [D; 2])> {
        let (state, residual) = self.state(across, load_excess, q, c);
        let along = state.load_parameter.re();
        (along > 0.0 && along.is_finite()).then_some((state, residual))
    }

    /// Returns the unknowns (S1) of the ball at a root of (S26).
    ///
    /// * `sign`: sign of `$P/W$`.
    pub(super) fn unknowns(&self, at: &SlidingPoint<f64>, sign: f64) -> [f64; BALL_UNKNOWNS] {
        let (s, k) = (&at.state, &at.motion);
        let rate = sign * (s.centrifugal / self.inertia_ratio).sqrt();
        let tilt = 0.5 * s.angle_difference.0.atan2(s.angle_difference.1);
        let mean = s.sin[0].atan2(s.cos[0]) + tilt;
        let mut y = [0.0; BALL_UNKNOWNS];
        [y[NUT_LOAD], y[SCREW_LOAD]] = s.loads;
        y[TILT] = tilt;
        y[PRECESSION] = rate - self.nut_speed;
        y[SLIP] = k.slip[0];
        y[SLIP_ANGLE] = 1.0_f64.atan2(s.slip_cotangents[0]);
        y[SPIN] = self.spin_moment(at, rate, (tilt.cos(), mean.sin()));
        y
    }

    /// Estimates the cotangent `$x$` of the slip angles and the unknown `$c$` at the beginning of
    /// the equilibrium curve, where inertia is zero. Returns `None` if no estimate is found.
    ///
    /// * `unloaded`: unloaded contact angle \[rad\].
    /// * `steps`: counter of function evaluations.
    pub(super) fn beginning(&self, unloaded: f64, steps: &mut usize) -> Option<[f64; 2]> {
        let bracket = Bracket {
            start: Some(-unloaded.tan().ln()),
            x_tol: 4.0 * f64::EPSILON,
            f_tol: START_RESIDUAL_TOL,
            ..Bracket::new(COTANGENT_RANGE.map(f64::ln), [f64::NEG_INFINITY, f64::INFINITY])
        };
        // The residual of (S20) is evaluated as a function of the logarithm of the cotangent. The
        // residual is infinite if friction holds the load.
        let found = bracket.root(|log| {
            *steps += 1;
            let cot = log.exp();
            let residual =
                load_carrying(self.equal_angles(Jet { re: cot, eps: [cot] })).and_then(|[x, c]| {
                    let q = Jet::from(0.0);
                    let (load_excess, square) = self.nut_cotangent_square([q, x, c]);
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
        load_carrying(self.equal_angles(found.root()?.x.exp()))
    }
}

/// Returns `$x$` and `$c$` (cotangent of the slip angles, and unknown of (S18)) for equal contact
/// angles, or `None` if contacts at these angles cannot carry the load.
fn load_carrying<D: Scalar>((point, effect): ([D; 2], D)) -> Option<[D; 2]> {
    (effect.re() > 0.0).then_some(point)
}
