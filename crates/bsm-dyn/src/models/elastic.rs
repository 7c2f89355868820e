//! The elastic model: gross slip on elastic contacts. Friction is saturated at the contact centers,
//! and contact angles depend on load and speed.
//!
//! Theory: `docs/theory/08-elastic.md`, equations (S1) to (S6), (S11).

mod curve;
mod forces;
mod sensitivities;
mod states;
mod steady;

use bsm_kin::{BallFrame, Motion, Over, Scalar};
use bsm_newton::{EvalError, Options, Report, Scales, solve};
use nalgebra::Vector3;

use self::curve::root;
pub use self::states::{SlidingBall, SlidingMotion, SlidingState};
pub use self::steady::SlidingRoot;
use self::steady::rotation;
use crate::contact::{Coulomb, DOES_NOT_ORBIT, Wrench, friction_against, friction_force, torque};
use crate::cost;
use crate::models::ball::equation::MOMENT;
use crate::models::ball::unknown::{
    NUT_LOAD, PRECESSION, SCREW_LOAD, SLIP, SLIP_ANGLE, SPIN, TILT,
};
use crate::models::ball::{
    BALL_UNKNOWNS, BallLoads, EQUATION_NAMES, ElasticContacts, ElasticPoint, Model, Reason,
    Solution, SolveFailure, SolveInfo, SteadyState, Workspace, domain_error, equations,
    friction_power, weight,
};

/// Minimum ratio of inertia force to friction force (dimensionless). Above this ratio, rounding
/// errors of the loads do not affect the derivatives of the slip.
const MIN_INERTIA: f64 = 1e-5;

/// Inputs of the elastic model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elastic<D = f64> {
    /// The screw at its operating point. The friction coefficient must be positive.
    pub screw: ElasticPoint<D>,
}

/// Reusable buffers for solving elastic models.
#[derive(Default)]
pub struct ElasticWorkspace(Workspace);

/// Contacts and motion of a ball in gross slip, with slips and wrenches, for given unknowns.
#[derive(Debug)]
struct GrossSlipState<D> {
    loaded: BallLoads<D>,
    /// Motion relative to the nut.
    to_nut: Motion<D>,
    /// Absolute precession rate `$P/W$`.
    precession: D,
    /// Slip velocities at the nut and the screw.
    slip: [Vector3<D>; 2],
    /// Wrenches (force and moment) of the nut and the screw on the ball.
    wrench: [Wrench<D>; 2],
}

/// The seven equations of a ball with saturated friction at both contacts. The unknowns are
/// `$Q_A/F_a,\; \nu,\; Q_B/F_a,\; p,\; \lambda,\; \theta,\; s$` (S1).
struct GrossSlipEquations<'a, P = f64>(&'a ElasticContacts<P>);

impl<P: Scalar> GrossSlipEquations<'_, P> {
    /// Returns the contacts, the motion, the slips and the wrenches for given unknowns.
    ///
    /// # Errors
    ///
    /// Returns [`EvalError`] if a contact is lost, or if the direction of friction or of the
    /// gyroscopic moment is undefined.
    fn state<D: Over<P>>(&self, y: &[D; BALL_UNKNOWNS]) -> Result<GrossSlipState<D>, EvalError> {
        cost::count_evaluation();
        let contacts = self.0;
        let loaded = contacts.loaded([y[NUT_LOAD], y[SCREW_LOAD]], y[TILT])?;
        let [nut, screw] = loaded.contacts;
        // P = Ω_n + p W                                                   (S2)
        let precession = y[PRECESSION] + contacts.scaled.nut_speed;
        if precession.re() == 0.0 {
            return Err(DOES_NOT_ORBIT);
        }
        // V_A = W r_b λ (cosθ e_xA + sinθ t)                              (S4)
        let (sin, cos) = y[SLIP_ANGLE].sin_cos();
        let tangent = BallFrame::tangent();
        let along = nut.transverse * cos + tangent * sin;
        let spin = (y[SPIN], precession * contacts.scaled.ball().inertia());
        let tilt = (nut.transverse.y, nut.transverse.z);
        let omega = rotation(
            contacts.scaled.arc,
            [y[SLIP] * cos, y[SLIP] * sin],
            y[PRECESSION],
            spin,
            tilt,
        );
        let omega = Vector3::from(omega);
        let to_nut = Motion { precession: y[PRECESSION], omega };

        let points = loaded.contacts.map(|c| c.point(D::from(1.0)));
        // In this sum, the spin, which is of order 1/P, appears only multiplied by the tilt, so no
        // digits are lost by cancellation.
        // V_A + V_B = d (2p − 1) W t + ω' × (r_A + r_B) − W k × r_B       (S11)
        let arc = tangent * ((y[PRECESSION] * 2.0 - 1.0) * contacts.scaled.arc);
        let both = arc + omega.cross(&(points[0] + points[1])) - loaded.frame.k.cross(&points[1]);
        let at_screw = both - along * y[SLIP];
        // The slip component along the contact normal is zero except for rounding errors, so it is
        // omitted.
        let slip_screw = screw.transverse * at_screw.dot(&screw.transverse) + tangent * at_screw.x;
        let slip = [along * y[SLIP], slip_screw];
        let friction = D::from(contacts.directed_friction());
        let friction = [
            friction_against(&along, y[NUT_LOAD] * friction),
            friction_force(&Coulomb(friction), y[SCREW_LOAD], &slip[1])?,
        ];
        let wrench = std::array::from_fn(|i| {
            let normal = &loaded.contacts[i].normal;
            Wrench::at_contact(normal, &points[i], loaded.loads[i], &friction[i])
        });
        Ok(GrossSlipState { loaded, to_nut, precession, slip, wrench })
    }

    /// Returns the residuals of the seven equations (P5).
    ///
    /// # Errors
    /// Returns an error if [`state`](Self::state) fails.
    fn residual<D: Over<P>>(
        &self,
        y: &[D; BALL_UNKNOWNS],
    ) -> Result<[D; BALL_UNKNOWNS], EvalError> {
        let (contacts, state) = (self.0, self.state(y)?);
        // The nut speed is along k and causes no gyroscopic moment, so it is omitted to avoid
        // rounding errors.
        let motion = Motion { precession: state.precession, ..state.to_nut };
        Ok(contacts.balance(&state.loaded, &motion, &state.wrench))
    }
}

equations!(GrossSlipEquations<'_>, BALL_UNKNOWNS, GrossSlipEquations::residual, EQUATION_NAMES);

/// A root of the equations of the elastic model.
#[derive(Debug)]
pub(crate) struct GrossSlip {
    state: GrossSlipState<f64>,
    steps: usize,
    residual: f64,
}

impl GrossSlip {
    /// Returns the loaded contacts at the root, and the motion of the ball relative to the nut.
    pub(crate) fn state(&self) -> (&BallLoads<f64>, &Motion<f64>) {
        (&self.state.loaded, &self.state.to_nut)
    }

    /// Returns the total number of Newton steps.
    pub(crate) fn steps(&self) -> usize {
        self.steps
    }

    /// Returns a root that serves as a starting value. This root is usually the first root on the
    /// equilibrium curve.
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`] if no root is found.
    pub(crate) fn start(contacts: &ElasticContacts) -> Result<Self, SolveFailure> {
        let (y, steps) = root(contacts, true)?;
        let state = GrossSlipEquations(contacts).state(&y).map_err(domain_error)?;
        Ok(Self { state, steps, residual: f64::NAN })
    }

    /// Returns the first root on the equilibrium curve (the curve of states whose forces balance).
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`] if no root exists or if the search fails.
    pub(crate) fn of(
        contacts: &ElasticContacts,
        newton: &mut Workspace,
    ) -> Result<Self, SolveFailure> {
        let (y, steps, residual) = find(contacts, newton)?;
        let state = GrossSlipEquations(contacts).state(&y).map_err(domain_error)?;
        Ok(Self { state, steps, residual })
    }
}

/// Unknowns at a root, total number of Newton steps, and residual.
type ElasticRoot = ([f64; BALL_UNKNOWNS], usize, f64);

/// Returns the first root on the equilibrium curve, expressed in the unknowns (S1).
///
/// # Errors
///
/// Returns [`SolveFailure`] if no root exists or if the search fails.
fn find(contacts: &ElasticContacts, newton: &mut Workspace) -> Result<ElasticRoot, SolveFailure> {
    let (mut y, steps) = root(contacts, false)?;
    let report = run(contacts, &mut y, newton);
    if report.converged() {
        return Ok((y, steps + report.steps.len(), report.residual));
    }
    Err(SolveFailure::not_converged(Reason::from(report)))
}

/// Returns the factor by which the inertia must be multiplied so that the ratio of inertia force to
/// friction force at a root equals [`MIN_INERTIA`].
fn inertia_factor(contacts: &ElasticContacts, root: &[f64; BALL_UNKNOWNS]) -> f64 {
    let rate = root[PRECESSION] + contacts.scaled.nut_speed;
    MIN_INERTIA / (contacts.inertia_ratio() * rate * rate / contacts.friction)
}

/// Returns the weights of the equations near `y`, which are the reciprocals of the largest term of
/// each equation. The weights are finite even if the ball stops orbiting (P → 0).
fn weights(contacts: &ElasticContacts, y: &[f64; BALL_UNKNOWNS]) -> [f64; BALL_UNKNOWNS] {
    let rate = (y[PRECESSION] + contacts.scaled.nut_speed).abs();
    let centrifugal = contacts.inertia_ratio() * rate * rate;
    let force = centrifugal.max(y[NUT_LOAD]).max(y[SCREW_LOAD]).max(1.0);
    // In the moment balance about the mean normal, all terms are of the order of the gyroscopic
    // moment I P ω of the rolling ball.
    let gyroscopic =
        contacts.scaled.ball().inertia() * rate * (1.0 + y[PRECESSION].abs() * contacts.scaled.arc);
    let mut weights = [weight(force); BALL_UNKNOWNS];
    let across = weight(force.max(gyroscopic));
    for (row, weight) in MOMENT.into_iter().zip([across, weight(gyroscopic), across]) {
        weights[row] = weight;
    }
    weights
}

/// Runs Newton's method from the starting value `y`.
fn run(contacts: &ElasticContacts, y: &mut [f64; BALL_UNKNOWNS], newton: &mut Workspace) -> Report {
    let weights = weights(contacts, y);
    let scales = Scales { x: &[1.0; BALL_UNKNOWNS], f: &weights };
    solve(&GrossSlipEquations(contacts), y, &scales, &Options::default(), newton).report
}

impl Elastic {
    /// Solves for the steady motion of a ball in gross slip.
    pub fn solve(&self, work: &mut ElasticWorkspace) -> Solution {
        let solved = self
            .screw
            .point
            .require_friction()
            .and_then(|()| self.screw.scaled())
            .and_then(|contacts| self.steady_state(&contacts, work));
        Solution::new(Model::Elastic, solved)
    }

    /// Returns the steady state at the first root on the equilibrium curve.
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`] if no root exists, if the search fails, or if the power balance is
    /// violated.
    pub(crate) fn steady_state(
        &self,
        contacts: &ElasticContacts,
        work: &mut ElasticWorkspace,
    ) -> Result<SteadyState, SolveFailure> {
        let GrossSlip { state, steps, residual } = GrossSlip::of(contacts, &mut work.0)?;
        let ball = self.screw.ball_state(contacts, &state.loaded, &state.to_nut, true)?;
        let slips = state.slip.map(|slip| slip.norm());
        let friction_power =
            friction_power(contacts.directed_friction(), state.loaded.loads, slips);
        let torque = torque(&state.wrench[1], contacts.helix.radius, &state.loaded.frame);
        let transmission = self.screw.transmission_at(torque, friction_power)?;
        let info = Some(SolveInfo { steps, residual });
        Ok(SteadyState { info, ..SteadyState::new(&ball, transmission) })
    }
}

#[cfg(test)]
mod tests;
