//! Newton's method for the traction equations of one ball.
//!
//! Theory: `docs/theory/09-traction.md`, equations (T3), (T26) to (T31).

use bsm_kin::Jet;
use bsm_newton::{Equations, EvalError, Linearized, Outcome, Scales, solve};

use super::equations::{Evaluation, PowerFlow, SlipBall};
use super::slips::max_step_fraction;
use crate::models::ball::{BALL_UNKNOWNS, EQUATION_NAMES, Workspace, variables};

impl SlipBall<'_> {
    /// Solves the equations with the damped Newton method, starting from `y`.
    pub(super) fn run(
        &self,
        y: &mut [f64; BALL_UNKNOWNS],
        newton: &mut Workspace,
    ) -> Outcome<BALL_UNKNOWNS, Self> {
        let weights = self.weights(y);
        let scales = Scales { x: &[1.0; BALL_UNKNOWNS], f: &weights };
        solve(self, y, &scales, &self.options(), newton)
    }
}

impl Equations<BALL_UNKNOWNS> for SlipBall<'_> {
    /// Torque on the screw, total friction power, and sliding powers.
    type Details = PowerFlow;
    /// Derivatives of the torque on the screw with respect to the unknowns.
    type Slopes = [f64; BALL_UNKNOWNS];

    fn residual(
        &self,
        x: &[f64; BALL_UNKNOWNS],
    ) -> Result<([f64; BALL_UNKNOWNS], PowerFlow), EvalError> {
        let found: Evaluation = self.evaluated(x)?;
        Ok((found.residual, found.power_flow()))
    }

    fn linearize(
        &self,
        x: &[f64; BALL_UNKNOWNS],
        rows: &mut [[f64; BALL_UNKNOWNS]; BALL_UNKNOWNS],
    ) -> Linearized<BALL_UNKNOWNS, Self> {
        let found: Evaluation<Jet<BALL_UNKNOWNS>> = self.evaluated(&variables(x))?;
        *rows = found.residual.map(|row| row.eps);
        Ok((found.residual.map(|row| row.re), found.power_flow(), found.torque.eps))
    }

    fn retract(
        &self,
        x: &[f64; BALL_UNKNOWNS],
        dx: &[f64; BALL_UNKNOWNS],
        lambda: f64,
    ) -> [f64; BALL_UNKNOWNS] {
        self.with_slips(x, &dx.map(|dx| lambda * dx))
    }

    fn max_step_length(&self, x: &[f64; BALL_UNKNOWNS], dx: &[f64; BALL_UNKNOWNS]) -> f64 {
        max_step_fraction(self.contacts.scaled.lead, x, dx)
    }

    fn equation(&self, i: usize) -> String {
        EQUATION_NAMES[i].to_owned()
    }
}
