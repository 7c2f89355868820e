//! Newton's method on the equations of a ball.
//!
//! Theory: `docs/theory/09-traction.md`, equations (T3), (T26) to (T31).

use std::cell::RefCell;

use bsm_kin::{Jet, Scalar};
use bsm_newton::{Equations, EvalError, Report, Scales, solve};

use super::equations::{Evaluation, PowerFlow, SlipBall};
use super::slips::first_part;
use crate::models::ball::{BALL, ROWS, Workspace, variables};

/// The equations of a ball, and where they were last evaluated.
pub(super) struct LastEvaluation<'a> {
    pub(super) ball: &'a SlipBall<'a>,
    last: RefCell<Option<LastState>>,
}

/// The last state.
#[derive(Clone, Copy)]
pub(super) struct LastState {
    unknowns: [f64; BALL],
    pub(super) residual: [f64; BALL],
    pub(super) transmitted: PowerFlow,
    /// Derivatives of the torque with respect to the unknowns, where the Jacobian was last asked for.
    pub(super) torque_slope: [f64; BALL],
}

impl<'a> LastEvaluation<'a> {
    pub(super) fn new(ball: &'a SlipBall<'a>) -> Self {
        Self { ball, last: RefCell::new(None) }
    }

    /// Remembers an evaluation; one without derivatives keeps the slope of the torque.
    fn remember<D: Scalar>(
        &self,
        unknowns: &[f64; BALL],
        found: &Evaluation<D>,
        torque_slope: Option<[f64; BALL]>,
    ) -> [f64; BALL] {
        let residual = found.residual.map(|x| x.re());
        let former = || self.last.borrow().map_or([f64::NAN; BALL], |last| last.torque_slope);
        let torque_slope = torque_slope.unwrap_or_else(former);
        let transmitted = found.power_flow();
        let last = LastState { unknowns: *unknowns, residual, transmitted, torque_slope };
        self.last.replace(Some(last));
        residual
    }

    /// The evaluation of a state, which mostly was the last one.
    pub(super) fn at(&self, y: &[f64; BALL]) -> Result<LastState, EvalError> {
        let is_same = |last: &LastState| last.unknowns.map(f64::to_bits) == y.map(f64::to_bits);
        if !self.last.borrow().as_ref().is_some_and(is_same) {
            self.residual(y)?;
        }
        Ok(self.last.borrow().expect("an evaluation"))
    }
}

impl SlipBall<'_> {
    /// One damped Newton solve from `y`.
    pub(super) fn run(&self, y: &mut [f64; BALL], newton: &mut Workspace) -> Report {
        LastEvaluation::new(self).run(y, newton)
    }
}

impl LastEvaluation<'_> {
    pub(super) fn run(&self, y: &mut [f64; BALL], newton: &mut Workspace) -> Report {
        let weights = self.ball.weights(y);
        let scales = Scales { x: &[1.0; BALL], f: &weights };
        solve(self, y, &scales, &self.ball.options(), newton)
    }
}

impl Equations<BALL> for LastEvaluation<'_> {
    fn retract(&self, x: &[f64; BALL], dx: &[f64; BALL], lambda: f64) -> [f64; BALL] {
        self.ball.slid(x, &dx.map(|dx| lambda * dx))
    }

    fn first_part(&self, x: &[f64; BALL], dx: &[f64; BALL]) -> f64 {
        first_part(self.ball.contacts.scaled.lead, x, dx)
    }

    fn residual(&self, x: &[f64; BALL]) -> Result<[f64; BALL], EvalError> {
        let found: Evaluation = self.ball.evaluated(x)?;
        Ok(self.remember(x, &found, None))
    }

    fn linearize(
        &self,
        x: &[f64; BALL],
        rows: &mut [[f64; BALL]; BALL],
    ) -> Result<[f64; BALL], EvalError> {
        let found: Evaluation<Jet<BALL>> = self.ball.evaluated(&variables(x))?;
        *rows = found.residual.map(|row| row.eps);
        Ok(self.remember(x, &found, Some(found.torque.eps)))
    }

    fn equation(&self, i: usize) -> String {
        ROWS[i].to_owned()
    }
}
