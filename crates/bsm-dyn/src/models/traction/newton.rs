//! Newton's method for the traction equations of one ball.
//!
//! Theory: `docs/theory/09-traction.md`, equations (T3), (T26) to (T31).

use bsm_kin::Jet;
use bsm_newton::{Equations, EvalError, Linearized, Outcome, Scales, solve};

use super::equations::{Evaluation, PowerFlow, SlipBall};
use super::slips::first_part;
use crate::models::ball::{BALL, ROWS, Workspace, variables};

impl SlipBall<'_> {
    /// Solves the equations with the damped Newton method, starting from `y`.
    pub(super) fn run(&self, y: &mut [f64; BALL], newton: &mut Workspace) -> Outcome<BALL, Self> {
        let weights = self.weights(y);
        let scales = Scales { x: &[1.0; BALL], f: &weights };
        solve(self, y, &scales, &self.options(), newton)
    }
}

impl Equations<BALL> for SlipBall<'_> {
    /// Torque on the screw, total friction power, and sliding powers.
    type Details = PowerFlow;
    /// Derivatives of the torque on the screw with respect to the unknowns.
    type Slopes = [f64; BALL];

    fn residual(&self, x: &[f64; BALL]) -> Result<([f64; BALL], PowerFlow), EvalError> {
        let found: Evaluation = self.evaluated(x)?;
        Ok((found.residual, found.power_flow()))
    }

    fn linearize(&self, x: &[f64; BALL], rows: &mut [[f64; BALL]; BALL]) -> Linearized<BALL, Self> {
        let found: Evaluation<Jet<BALL>> = self.evaluated(&variables(x))?;
        *rows = found.residual.map(|row| row.eps);
        Ok((found.residual.map(|row| row.re), found.power_flow(), found.torque.eps))
    }

    fn retract(&self, x: &[f64; BALL], dx: &[f64; BALL], lambda: f64) -> [f64; BALL] {
        self.with_slips(x, &dx.map(|dx| lambda * dx))
    }

    fn max_step_length(&self, x: &[f64; BALL], dx: &[f64; BALL]) -> f64 {
        first_part(self.contacts.scaled.lead, x, dx)
    }

    fn equation(&self, i: usize) -> String {
        ROWS[i].to_owned()
    }
}
