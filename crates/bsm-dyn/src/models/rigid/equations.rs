//! The seven equations of the rigid model in a form for Newton's method.
//!
//! Theory: `docs/theory/04-rigid.md`, equations (R2) to (R11).

use bsm_kin::{Over, Scalar};
use bsm_newton::EvalError;
use nalgebra::SVector;

use super::ball::{RigidBall, RigidCoordinates, RigidMotion};
use super::first_order::FirstOrder;
use crate::contact::{DOES_NOT_ORBIT, Sines, sliding};
use crate::cost;
use crate::models::ball::equation::MOMENT;
use crate::models::ball::unknown::{
    NUT_LOAD, PRECESSION, SCREW_LOAD, SLIP, SLIP_ANGLE, SPIN, UNLOADED_FLANK_LOAD,
};
use crate::models::ball::{BALL_UNKNOWNS, EQUATION_NAMES, equations, weight};

/// Minimum ratio of inertia force to friction force (dimensionless). Below this ratio, rounding
/// errors of the loads would determine the slip at contact A in (R8).
pub(super) const MIN_INERTIA: f64 = 1e-6;

/// The equations of the rigid model at one operating point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RigidEquations<P> {
    pub(super) ball: RigidBall<P>,
    /// True if the unknown is the absolute precession rate `$P/W$` instead of the rate `$p$`
    /// relative to the nut. For slowly orbiting balls, the sum `$p + \Omega_n/W$` would suffer from
    /// cancellation.
    pub(super) uses_absolute_rate: bool,
}

/// The seven unknowns of the rigid model (R2): `$Q_A/F_a,\; Q_{A'}/F_a,\; Q_B/F_a,\; p,\;
/// \lambda,\; \theta,\; s$`.
pub type Unknowns<D> = SVector<D, BALL_UNKNOWNS>;

impl<P: Scalar> RigidEquations<P> {
    /// Returns the precession rates `$p$` and `$P/W$` from the precession unknown, which is one of
    /// these two rates.
    pub(super) fn rates<D: Over<P>>(&self, unknown: D) -> [D; 2] {
        let nut = self.ball.nut_speed;
        // P = Ω_n + p W                                                   (R3)
        if self.uses_absolute_rate { [unknown - nut, unknown] } else { [unknown, unknown + nut] }
    }

    /// Returns the motion and the loads of the ball for given unknowns.
    ///
    /// # Errors
    ///
    /// Returns [`EvalError`] if the direction of friction or of the gyroscopic moment is undefined.
    pub(super) fn motion<D: Over<P>>(&self, y: &Unknowns<D>) -> Result<RigidMotion<D>, EvalError> {
        let [precession, rate] = self.rates(y[PRECESSION]);
        if rate.re() == 0.0 {
            return Err(DOES_NOT_ORBIT);
        }
        // V_A = W r_b λ (cosθ e_x + sinθ t); the friction direction does not depend on λ  (R7)
        let (sin, cos) = y[SLIP_ANGLE].sin_cos();
        let motion = self.ball.motion(RigidCoordinates {
            loads: [y[NUT_LOAD], y[UNLOADED_FLANK_LOAD], y[SCREW_LOAD]],
            precession,
            rate,
            slip: y[SLIP],
            slip_direction: [cos, sin],
            spin_moment: y[SPIN],
        });
        sliding(motion.speeds[1])?;
        sliding(motion.speeds[2])?;
        Ok(motion)
    }

    /// Returns the residuals of the seven equations (R8): force and moment balance in `$(t, N,
    /// e_x)$`, and axial load.
    ///
    /// # Errors
    /// Returns an error if [`motion`](Self::motion) fails.
    pub(super) fn residual<D: Over<P>>(&self, y: &Unknowns<D>) -> Result<Unknowns<D>, EvalError> {
        cost::count_evaluation();
        // The motion is passed by reference, because a motion with derivatives takes several
        // kilobytes.
        let motion = self.motion(y);
        let motion = motion.as_ref().map_err(|error| *error)?;
        Ok(self.ball.residual(motion).into())
    }
}

impl RigidEquations<f64> {
    /// Returns the residuals for an array of unknowns.
    ///
    /// # Errors
    ///
    /// Returns the errors of [`motion`](Self::motion).
    pub(super) fn residual_at<D: Over<f64>>(
        &self,
        y: &[D; BALL_UNKNOWNS],
    ) -> Result<[D; BALL_UNKNOWNS], EvalError> {
        Ok(self.residual(&Unknowns::from(*y))?.into())
    }

    /// Returns the equations whose unknown is the more accurate of the two precession rates,
    /// together with the values of the unknowns for the given motion.
    pub(super) fn at(ball: &RigidBall<f64>, motion: &RigidMotion<f64>) -> (Self, Unknowns<f64>) {
        let uses_absolute_rate = motion.rate.abs() < motion.precession.abs();
        let ([nut, unloaded, screw], [x, t]) = (motion.loads, motion.directions[0]);
        let precession = if uses_absolute_rate { motion.rate } else { motion.precession };
        let (slip, spin) = (motion.speeds[0], motion.spin_moment);
        let unknowns = [nut, unloaded, screw, precession, slip, t.atan2(x), spin];
        (Self { ball: *ball, uses_absolute_rate }, unknowns.into())
    }
}

impl RigidBall<f64> {
    /// Returns the unknowns of the first-order solution.
    pub(super) fn start_of(&self, first: &FirstOrder) -> Unknowns<f64> {
        let (load, angle) = (first.load, self.sin_psi.atan2(self.cos_psi));
        let unloaded = first.unloaded * first.inertia;
        [load, unloaded, load, first.precession, first.slip, angle, first.spin].into()
    }

    /// Returns the weights of the seven equations (R10) at a precession rate `$P/W$`.
    pub(super) fn weights(&self, rate: f64) -> [f64; BALL_UNKNOWNS] {
        let [unit, normal] = self.units(rate).map(weight);
        let mut weights = [unit; BALL_UNKNOWNS];
        weights[MOMENT[1]] = normal;
        weights
    }

    /// Returns the weights of the equations, calculated from the magnitudes of their terms at a
    /// root (R44). These weights are suitable for any ratio of inertia forces to load.
    ///
    /// * `load`: typical normal load in the force unit of the equations, of the order of the axial
    ///   load per ball.
    pub(super) fn own_weights(&self, motion: &RigidMotion<f64>, load: f64) -> [f64; BALL_UNKNOWNS] {
        let (p, rate) = (motion.precession.abs(), motion.rate.abs());
        // U = max(1, μ(P/W)²),  M = max(U, I |P/W| (|λ| + |p| d/r_b))     (R44)
        let force = (self.inertia_ratio * rate * rate).max(load);
        let moment = self.inertia * rate * (motion.speeds[0].abs() + p * self.arc);
        // M_N = μ |P/W| (|p| + f |P/W|)                                   (R44)
        let normal = self.inertia_ratio * rate * (p + self.friction() * rate);
        // D_F = diag(1/U, 1/U, 1/U, 1/M, 1/M_N, 1/M, 1/U)                 (R44)
        let [u, m, n] = [force, moment.max(force), normal].map(weight);
        [u, u, u, m, n, m, u]
    }

    /// Returns the ball with a different lead angle \[rad\].
    pub(super) fn with_lead_angle(&self, lead_angle: f64) -> Self {
        let (sin_a, cos_a) = lead_angle.sin_cos();
        let sines = Sines { sin_a, cos_a, ..self.sines };
        let mass = self.inertia_ratio / self.radius;
        Self::new(sines, self.radius, mass, self.nut_speed, self.signed)
    }
}

equations!(RigidEquations<f64>, BALL_UNKNOWNS, RigidEquations::residual_at, EQUATION_NAMES);

#[cfg(test)]
mod tests {
    use bsm_newton::{Convergence, Options, Scales, Workspace, solve};
    use num_dual::jacobian;
    use proptest::prelude::*;

    use bsm_kin::Jet;

    use super::*;
    use crate::angles::Angles;

    fn case(lead: f64, contact: f64, friction: f64, mass: f64, nut: f64) -> RigidEquations<f64> {
        let sines = Angles { lead, contact }.sines();
        RigidEquations {
            ball: RigidBall::new(sines, 5.56, mass, nut, friction),
            uses_absolute_rate: false,
        }
    }

    fn start(case: &RigidEquations<f64>) -> Unknowns<f64> {
        case.ball.start_of(&case.ball.first_order())
    }

    proptest! {
        /// Compares the Jacobian from jets with central differences and with num-dual, at points
        /// that are not roots. The spin must dominate the slip at A', because central differences
        /// are inaccurate if the slip at A' is close to zero.
        #[test]
        fn jacobian_matches_finite_differences(
            lead in 0.1..0.7_f64, contact in 0.4..1.2_f64, friction in 0.01..0.1_f64,
            log_mass in -5.0..-1.5_f64, nut in 0.0..1.5_f64, back in any::<bool>(),
            shift in proptest::array::uniform7(-0.05..0.05_f64),
        ) {
            let sign = if back { -1.0 } else { 1.0 };
            let case = case(lead, contact, friction * sign, 10.0_f64.powf(log_mass), nut);
            let mut y = start(&case);
            prop_assume!(y.iter().all(|v| v.is_finite()) && y[PRECESSION].abs() > 0.1);
            for (y, s) in y.iter_mut().zip(shift) {
                *y += s;
            }
            prop_assume!((nut + y[PRECESSION]).abs() > 0.2);
            // The third derivative of the friction direction is of the order of 1/slip³, so points
            // with small slip are skipped.
            let speeds = case.motion(&y).expect("in the domain").speeds;
            prop_assume!(speeds[1..].iter().all(|speed| *speed > 0.1));
            let exact = jacobian(|y| case.residual(&y), &y).expect("in the domain").1;
            let variables = Unknowns::from_fn(|i, _| Jet::<BALL_UNKNOWNS>::variable(y[i], i));
            let jets = case.residual(&variables).expect("in the domain");
            // The tolerance allows for the truncation error h²/6 F''', where F''' is at most 1e4,
            // and for the rounding error 1e-16/h.
            for j in 0..BALL_UNKNOWNS {
                // The last unknown is the product of spin and inertia (R5), so its step corresponds
                // to a step of 1e-4 in the spin.
                let h = if j == SPIN { 1e-4 * case.ball.inertia } else { 1e-6 };
                let at = |step: f64| {
                    let mut moved = y;
                    moved[j] += step;
                    case.residual(&moved).expect("in the domain")
                };
                let difference = (at(h) - at(-h)) / (2.0 * h);
                let scale = 1.0 + exact.norm();
                prop_assert!((difference - exact.column(j)).norm() <= 1e-6 * scale, "{j}");
                for i in 0..BALL_UNKNOWNS {
                    // The derivatives from `Jet` and from `jacobian` result from the same
                    // operations and differ only by rounding errors.
                    prop_assert!((jets[i].eps[j] - exact[(i, j)]).abs() <= 1e-12 * scale);
                }
            }
        }
    }

    /// Newton's method converges quadratically only if the Jacobian is exact.
    #[test]
    fn newton_converges_quadratically() {
        let case = case(0.3, 0.7, 0.08, 0.02, 0.0);
        let mut y = start(&case);
        y[SLIP_ANGLE] += 0.1;
        let weights = case.ball.weights(case.ball.first_order().rate);
        let scales = Scales { x: &[1.0; BALL_UNKNOWNS], f: &weights };
        let convergence = Convergence { residual_goal: 1e-14, ..Convergence::default() };
        let options = Options { convergence, ..Options::default() };
        let work = &mut Workspace::default();
        let report = solve(&case, &mut y.data.0[0], &scales, &options, work).report;
        assert!(report.converged(), "{report:?}");
        let small: Vec<f64> =
            report.steps.iter().map(|s| s.residual).filter(|r| (1e-6..1e-1).contains(r)).collect();
        assert!(small.len() >= 2, "{report:?}");
        for pair in small.windows(2) {
            // Each residual is about 10 times the square of the previous residual.
            assert!(pair[1] <= 100.0 * pair[0].powi(2), "{report:?}");
        }
    }

    /// The moment about the contact normal contains no large terms if it is calculated in the triad
    /// of the contact normal. With loads of order one and an inertia of 1e-12, the moment is of
    /// order 1e-12.
    #[test]
    fn residual_moment_about_the_contact_normal_is_of_the_order_of_inertia_forces() {
        let case = case(0.3, 0.7, 0.08, 1e-12, 0.0);
        let r = case.residual(&start(&case)).expect("in the domain");
        // In the first-order solution, the terms of order 1e-12 cancel. Only second-order terms and
        // the rounding errors of the canceled terms remain.
        assert!(r[MOMENT[1]].abs() <= 1e-20, "{r}");
    }
}
