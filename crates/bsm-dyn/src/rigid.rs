//! The published steady-state equations: three point contacts, equal and fixed contact angles,
//! saturated friction (Lin, Velinsky and Ravani, Eqs 5-9).
//!
//! Theory: `docs/theory/04-rigid.md`.

mod curve;
pub(crate) mod first_order;
mod root;
mod scaled;
mod search;
mod sensitivities;
mod trig_quadratic;

use bsm_kin::{Motion, Scalar, Site};
use bsm_newton::{Equations, EvalError, Linear};

pub use self::first_order::{FirstOrder, SEARCHED_FROM, UNIQUE_BELOW};
pub use self::root::RigidWorkspace;
use self::root::Root;
pub use self::scaled::Unknowns;
use self::scaled::{Scaled, State};
use crate::balance::{POWER_BALANCE_TOL, torque};
use crate::ball_unknowns::BALL;
use crate::ball_unknowns::unknown::{MINOR_LOAD, NUT_LOAD, SCREW_LOAD, SLIP, SLIP_ANGLE, SPIN};
use crate::operating_point::OwnUnits;
use crate::state::in_frenet;
use crate::{
    BallState, ContactState, Direction, Model, OperatingPoint, Reason, Solution, SolveInfo, Solved,
    Transmission, Unsolved,
};

/// Inputs of the rigid model: the contact angle is that of all three contacts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rigid<D = f64> {
    /// Geometry, friction, speeds and load.
    pub point: OperatingPoint<D>,
}

/// A root of the rigid equations in the unknowns of the theory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidRoot {
    /// `$Q_A/F_a$`.
    pub nut_load: f64,
    /// `$Q_{A'}/F_a$`.
    pub minor_load: f64,
    /// `$Q_B/F_a$`.
    pub screw_load: f64,
    /// `$p = (P - \Omega_n)/W$`.
    pub p: f64,
    /// `$u$`: tangential part of `$\omega - \Omega_n k$` over `$W$`.
    pub u: f64,
    /// `$\tau$`: part of `$\omega - \Omega_n k$` along `$e_x$` over `$W$`.
    pub tau: f64,
    /// `$s = I P\sigma/(r_b F_a)$`, `$\sigma$` the spin about the common normal.
    pub s: f64,
    /// Newton steps of all solves.
    pub steps: usize,
    /// Scaled residual.
    pub residual: f64,
}

/// The rigid equations of one point for [`bsm_newton::solve`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidSystem {
    /// Weights of the equations; the unknowns have weight one.
    pub weights: [f64; BALL],
    /// First-order start.
    pub start: [f64; BALL],
    equations: Scaled<f64>,
}

impl RigidSystem {
    /// The equations of a point in the model's own units, with their weights and their first-order
    /// start.
    ///
    /// `None` without friction or relative speed.
    pub fn of(case: &Rigid) -> Option<Self> {
        let equations = case.scaled().ok()?;
        let first = FirstOrder::of(&equations);
        let (weights, start) = (equations.weights(first.normal_moment()), first.unknowns().into());
        Some(Self { weights, start, equations })
    }

    /// The seven equations (R8) in any scalar.
    ///
    /// # Errors
    ///
    /// [`EvalError`] where friction or the gyroscopic moment has no direction.
    pub fn evaluate<D: Scalar>(&self, y: &Unknowns<D>) -> Result<Unknowns<D>, EvalError> {
        self.equations.lift().residual(y)
    }
}

impl Equations<BALL> for RigidSystem {
    fn residual(&self, x: &[f64; BALL]) -> Result<[f64; BALL], EvalError> {
        Equations::residual(&self.equations, x)
    }

    fn linearize(&self, x: &[f64; BALL]) -> Result<Linear<BALL>, EvalError> {
        self.equations.linearize(x)
    }

    fn equation(&self, i: usize) -> String {
        self.equations.equation(i)
    }
}

impl<D: Scalar> Rigid<D> {
    /// The point in the model's own units, or why there is none.
    fn scaled(&self) -> Result<Scaled<D>, Unsolved> {
        let OwnUnits { helix, ball, nut_speed, direction } = self.point.in_own_units()?;
        self.point.require_friction()?;
        let (angle, signed) = (self.point.contact_angle, self.point.friction.0 * direction.sign());
        Ok(Scaled::new(helix, angle, signed, ball.mass, nut_speed))
    }

    /// Which side drives.
    fn direction(&self) -> Direction {
        Direction::of(self.point.drive.relative_speed().re()).expect("the point was scaled")
    }

    /// Torques of the frictionless screw and on the screw.
    fn torques(&self, case: &Scaled<D>, state: &State<D>) -> (D, D) {
        let ideal = self.point.ideal_torque();
        let moment = self.point.ball.radius * self.point.load.per_ball();
        let screw = torque(&state.wrench[2], case.helix.radius, &case.frame);
        (ideal, screw * moment * self.point.load.balls)
    }
}

impl Rigid {
    /// The first-order solution, which also tells whether a root exists.
    ///
    /// `None` without friction or relative speed.
    pub fn first_order(&self) -> Option<FirstOrder> {
        self.scaled().ok().map(|case| FirstOrder::of(&case))
    }

    /// Smallest lead angle from this point's upwards at which the equations have a root \[rad\].
    ///
    /// `None` if none was found, or without friction or relative speed.
    pub fn critical_lead_angle(&self, work: &mut RigidWorkspace) -> Option<f64> {
        root::critical_lead_angle(&self.scaled().ok()?, work)
    }

    /// The root in the unknowns of the theory.
    ///
    /// # Errors
    ///
    /// Status and reason if there is none.
    pub fn root(&self, work: &mut RigidWorkspace) -> Result<RigidRoot, Unsolved> {
        let (case, Root { unknowns: y, steps, residual, .. }) = self.find(work)?;
        let (sin, cos) = y[SLIP_ANGLE].sin_cos();
        let (p, _) = case.rates(&y);
        Ok(RigidRoot {
            nut_load: y[NUT_LOAD],
            minor_load: y[MINOR_LOAD],
            screw_load: y[SCREW_LOAD],
            p,
            u: -y[SLIP] * cos,
            tau: y[SLIP] * sin - p * case.arc,
            s: y[SPIN],
            steps,
            residual,
        })
    }

    fn find(&self, work: &mut RigidWorkspace) -> Result<(Scaled<f64>, Root), Unsolved> {
        let case = self.scaled()?;
        let root = root::find(&case, work)?;
        Ok((case.counted(root.from_ground), root))
    }

    /// Solves for the steady motion of the ball.
    pub fn solve(&self, work: &mut RigidWorkspace) -> Solution {
        let solved = self.find(work);
        let answer =
            solved.and_then(|(case, root)| {
                let solved = self.balanced(&case, &root)?;
                let Some(others) = &root.others else { return Ok(solved) };
                let others = others.iter();
                Ok(solved.among(others.filter_map(|other| {
                    self.balanced(&case.counted(other.from_ground), other).ok()
                })))
            });
        Solution::new(Model::Rigid, answer)
    }

    /// The answer of a root whose powers balance.
    fn balanced(&self, case: &Scaled<f64>, root: &Root) -> Result<Solved, Unsolved> {
        let solved = self.solved(case, root);
        let imbalance = solved.transmission.power_balance.unwrap_or(f64::NAN);
        if imbalance.abs() <= POWER_BALANCE_TOL {
            return Ok(solved);
        }
        Err(Unsolved::not_converged(Reason::PowerDoesNotBalance { imbalance }))
    }

    /// The answer in SI units.
    fn solved(&self, case: &Scaled<f64>, root: &Root) -> Solved {
        let state = case.state(&root.unknowns).expect("the residual was evaluated at the root");
        let (w, r_b) = (self.point.drive.relative_speed(), self.point.ball.radius);
        let per_ball = self.point.load.per_ball();

        let to_nut = state.to_nut;
        let motion = to_nut.relative_to(-case.nut_speed, &case.frame);
        let motion = Motion { precession: state.precession, ..motion };
        let to_screw = to_nut.relative_to(1.0, &case.frame);
        // Of A, A' and B in the order of the unknowns.
        let [nut, minor, screw] = std::array::from_fn(|i| {
            let (contact, load) = (&case.contacts[i], root.unknowns[i] * per_ball);
            let motion = if contact.site == Site::Screw { &to_screw } else { &to_nut };
            let slip = state.slip[i] * (w * r_b);
            ContactState::sliding((self.point.contact_angle, load), contact, motion, &slip, w)
        });
        let ball = BallState {
            motion: Some(in_frenet(&motion, &case.frame, w)),
            nut,
            screw,
            minor: Some(minor),
            axial_displacement: None,
        };

        let (ideal, screw_torque) = self.torques(case, &state);
        let friction_power = friction_power(case, &state, &root.unknowns)
            * (r_b * per_ball)
            * w
            * self.point.load.balls;
        let transmission = Transmission::of(self.direction(), ideal, screw_torque, w);
        let transmission = transmission.against(friction_power);
        let info = SolveInfo { steps: root.steps, residual: root.residual };
        Solved { info: Some(info), ..Solved::new(&ball, transmission) }
    }
}

/// Friction power of all contacts `$\sum_c f Q_c |V_c|$` over `$W$`, in scaled units (R21).
fn friction_power(case: &Scaled<f64>, state: &State<f64>, y: &Unknowns<f64>) -> f64 {
    // P_f = Σ f Q_c |V_c|                                                 (R21)
    state.slip.iter().zip(y.iter()).map(|(v, q)| case.signed_friction * q * v.norm()).sum()
}

#[cfg(test)]
mod tests;
