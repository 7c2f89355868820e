//! The rigid model: published steady-state equations with three point contacts, equal and fixed
//! contact angles, and saturated friction (Lin, Velinsky and Ravani, Equations 5 to 9).
//!
//! Theory: `docs/theory/04-rigid.md`.

mod ball;
mod branch;
mod equations;
mod first_order;
mod fixed_point;
mod root;
mod sensitivities;
mod sweep;

use bsm_kin::{Motion, Over, Real, Scalar};
use bsm_newton::EvalError;

pub use self::ball::{Plane, RigidBall, RigidMotion};
use self::equations::RigidEquations;
pub use self::equations::Unknowns;
pub use self::first_order::FirstOrder;
pub use self::fixed_point::FixedPoint;
use self::root::BallRoot;
pub use self::root::RigidWorkspace;
use crate::contact::Angles;
use crate::models::ball::{
    BALL_UNKNOWNS, BallState, ContactState, EQUATION_NAMES, Model, OperatingPoint, ResultUnits,
    ScaledPoint, Slip, Solution, SolveFailure, SolveInfo, SteadyState, equations, friction_angle,
};

/// Inputs of the rigid model. All three contacts have the contact angle of the operating point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rigid<D = f64> {
    /// Geometry, friction, speeds and load.
    pub point: OperatingPoint<D>,
}

/// A root of the equations of the rigid model, expressed in the unknowns (R2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidRoot {
    /// Ratio `$Q_A/F_a$` of the load at A (loaded flank of the nut) to the axial load per ball.
    pub nut_load: f64,
    /// Ratio `$Q_{A'}/F_a$` of the load at A' (unloaded flank of the nut) to the axial load per
    /// ball.
    pub unloaded_flank_load: f64,
    /// Ratio `$Q_B/F_a$` of the load at B (loaded flank of the screw) to the axial load per ball.
    pub screw_load: f64,
    /// Precession rate relative to the nut `$p = (P - \Omega_n)/W$`.
    pub p: f64,
    /// Component `$u$` of the scaled angular velocity `$(\omega - \Omega_n k)/W$` along the
    /// tangent.
    pub u: f64,
    /// Component `$\tau$` of the scaled angular velocity `$(\omega - \Omega_n k)/W$` along `$e_x$`.
    pub tau: f64,
    /// Spin moment `$s = I P\sigma/(r_b F_a)$`, where `$\sigma$` is the spin about the common
    /// normal.
    pub s: f64,
    /// Number of sweeps of the fixed-point iteration, or number of Newton steps if the root was
    /// found by continuation and then refined.
    pub steps: usize,
    /// Largest scaled residual of the equations.
    pub residual: f64,
}

/// The equations of the rigid model at one operating point, for use with [`bsm_newton::solve`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidSystem {
    /// Weights of the equations. The weights of the unknowns are one.
    pub weights: [f64; BALL_UNKNOWNS],
    /// Starting value of Newton's method, which is the first-order solution.
    pub start: [f64; BALL_UNKNOWNS],
    equations: RigidEquations<f64>,
}

impl RigidSystem {
    /// Creates the equations at an operating point in scaled units, which are based on the ball
    /// radius, the axial load per ball and the relative speed. Returns `None` without friction or
    /// without relative speed.
    pub fn of(case: &Rigid) -> Option<Self> {
        let ball = case.ball().ok()?;
        let first = ball.first_order();
        let (weights, start) = (ball.weights(first.rate), ball.start_of(&first).into());
        Some(Self { weights, start, equations: RigidEquations { ball, uses_absolute_rate: false } })
    }

    /// Returns the residuals of the seven equations (R8) for any scalar type.
    ///
    /// # Errors
    ///
    /// Returns [`EvalError`] if the direction of friction or of the gyroscopic moment is undefined.
    pub fn evaluate<D: Over<f64>>(&self, y: &Unknowns<D>) -> Result<Unknowns<D>, EvalError> {
        self.equations.residual(y)
    }

    fn residual_at<D: Over<f64>>(
        &self,
        x: &[D; BALL_UNKNOWNS],
    ) -> Result<[D; BALL_UNKNOWNS], EvalError> {
        self.equations.residual_at(x)
    }
}

equations!(RigidSystem, BALL_UNKNOWNS, RigidSystem::residual_at, EQUATION_NAMES);

impl<D: Scalar> Rigid<D> {
    /// Returns the operating point in scaled units, which are based on the ball radius, the axial
    /// load per ball and the relative speed.
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`] if the model does not accept the inputs.
    fn ball(&self) -> Result<RigidBall<D>, SolveFailure> {
        let ScaledPoint { helix, mass, nut_speed, direction } = self.point.scaled()?;
        self.point.require_friction()?;
        let angles = Angles { lead: helix.lead_angle, contact: self.point.contact_angle };
        let signed = self.point.friction.0 * direction.sign();
        Ok(RigidBall::new(angles.sines(), helix.radius, mass, nut_speed, signed))
    }
}

impl Rigid {
    /// Returns the first-order solution, which also indicates whether a root exists. Returns `None`
    /// without friction or without relative speed.
    pub fn first_order(&self) -> Option<FirstOrder> {
        self.ball().ok().map(|ball| ball.first_order())
    }

    /// Returns the smallest lead angle \[rad\] at which the equations have a root, among all lead
    /// angles above the lead angle of this operating point.
    ///
    /// Returns `None` if the operating point itself has a root, if no such lead angle is found, or
    /// if there is no friction or no relative speed.
    pub fn critical_lead_angle(&self) -> Option<f64> {
        root::critical_lead_angle(&self.ball().ok()?)
    }

    /// Finds a root of the equations of the rigid model, expressed in the unknowns (R2).
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`] with status and reason if there is no root.
    pub fn root(&self, work: &mut RigidWorkspace) -> Result<RigidRoot, SolveFailure> {
        let BallRoot { motion, steps, residual, .. } = root::find(&self.ball()?, work)?;
        let ([nut_load, unloaded_flank_load, screw_load], [u, _, tau]) =
            (motion.loads, motion.omega);
        let (p, s) = (motion.precession, motion.spin_moment);
        Ok(RigidRoot { nut_load, unloaded_flank_load, screw_load, p, u, tau, s, steps, residual })
    }

    /// Solves for the steady motion of the ball.
    pub fn solve(&self, work: &mut RigidWorkspace) -> Solution {
        let root = self.ball().and_then(|ball| Ok((ball, root::find(&ball, work)?)));
        Solution::new(
            Model::Rigid,
            root.and_then(|(ball, root)| self.state_with_alternatives(&ball, &root)),
        )
    }

    /// Returns all steady states on the branch of increasing inertia that begins at a ball without
    /// inertia. [`solve`](Self::solve) returns only the first of these states. It counts the other
    /// states only if it has to follow the branch anyway.
    ///
    /// # Errors
    ///
    /// Returns the [`SolveFailure`] of [`solve`](Self::solve), or a failure with the status
    /// `not_converged` if the branch cannot be followed to its end.
    pub fn branch(&self, work: &mut RigidWorkspace) -> Result<Vec<SteadyState>, SolveFailure> {
        let ball = self.ball()?;
        let root = root::find_all(&ball, work)?;
        let others = root.alternatives.as_ref().ok_or(SolveFailure::SEARCH_FAILED)?;
        let others = others.iter().filter_map(|other| self.balanced(&ball, other).ok());
        Ok(std::iter::once(self.balanced(&ball, &root)?).chain(others).collect())
    }

    /// Converts a root and its alternatives into a steady state in SI units.
    fn state_with_alternatives(
        &self,
        ball: &RigidBall,
        root: &BallRoot,
    ) -> Result<SteadyState, SolveFailure> {
        let solved = self.balanced(ball, root)?;
        let Some(alternatives) = &root.alternatives else { return Ok(solved) };
        let alternatives = alternatives.iter().filter_map(|other| self.balanced(ball, other).ok());
        Ok(solved.with_alternatives(alternatives))
    }

    /// Converts a root into a steady state after checking its power balance.
    fn balanced(&self, ball: &RigidBall, root: &BallRoot) -> Result<SteadyState, SolveFailure> {
        let solved =
            ball.steady_state(&root.motion, &self.point.units(), self.point.contact_angle, true);
        solved.transmission.balanced()?;
        let info = SolveInfo { steps: root.steps, residual: root.residual };
        Ok(SteadyState { info: Some(info), ..solved })
    }
}

impl<F: Real> RigidBall<F> {
    /// Converts a motion of the ball into a steady state in SI units.
    ///
    /// * `contact_angle`: contact angle \[rad\].
    /// * `directions`: true if the directions of the friction forces are requested. Each direction
    ///   requires an arctangent.
    #[inline(always)]
    pub fn steady_state(
        &self,
        motion: &RigidMotion<F>,
        units: &ResultUnits<F>,
        contact_angle: F,
        directions: bool,
    ) -> SteadyState<F> {
        let (w, slip) = (units.speed, (units.speed * units.length).abs());
        let mut contacts = [ContactState::at_angle(contact_angle); 3];
        for (i, spin) in self.spins(motion).into_iter().enumerate() {
            let [across, along] = motion.directions[i];
            contacts[i].load = Some(motion.loads[i] * units.load);
            contacts[i].slip = Some(Slip { speed: motion.speeds[i] * slip, spin: spin * w });
            if directions {
                contacts[i].slip_angle = Some(friction_angle([across * -w, along * -w]));
            }
        }
        let [nut, unloaded, screw] = contacts;
        let [t, n, b] = self.angular_velocity(motion);
        let ball = BallState {
            motion: Some(Motion::new(motion.rate * w, [t * w, n * w, b * w])),
            nut,
            screw,
            unloaded: Some(unloaded),
            axial_displacement: None,
            threshold_play: None,
        };
        let power = self.friction_power(motion);
        let power = F::select(units.back(), -power, power);
        let ideal = self.ideal_torque() * units.torque;
        SteadyState::new(&ball, units.transmission(ideal, self.torque(motion), power))
    }
}

#[cfg(test)]
mod tests;
