//! Newton's method on the equations of a ball.
//!
//! Theory: `docs/theory/09-traction.md`, equations (T3), (T26) to (T31).

use std::cell::{Ref, RefCell, RefMut};

use bsm_newton::{Equations, EvalError, Report, Scales, solve};

use super::columns::EquationValues;
use super::equations::SlipBall;
use super::slips::first_part;
use crate::models::ball::{BALL, ROWS, Workspace};

/// The equations of a ball, and where they were last evaluated.
pub(super) struct LastEvaluation<'a> {
    pub(super) ball: &'a SlipBall<'a>,
    last: RefCell<(Option<[f64; BALL]>, EquationValues)>,
}

impl<'a> LastEvaluation<'a> {
    pub(super) fn new(ball: &'a SlipBall<'a>) -> Self {
        Self { ball, last: RefCell::new((None, EquationValues::zero(0.0))) }
    }

    /// What belongs to a state.
    fn evaluated<const JACOBIAN: bool>(
        &self,
        y: &[f64; BALL],
    ) -> Result<RefMut<'_, EquationValues>, EvalError> {
        let mut last = self.last.borrow_mut();
        last.0 = None;
        self.ball.evaluate::<JACOBIAN>(y, &mut last.1)?;
        last.0 = Some(*y);
        Ok(RefMut::map(last, |(_, found)| found))
    }

    /// What belongs to a state, which mostly was the last one, with the derivatives where they were last asked for.
    pub(super) fn at(&self, y: &[f64; BALL]) -> Result<Ref<'_, EquationValues>, EvalError> {
        let is_last = |last: [f64; BALL]| last.map(f64::to_bits) == y.map(f64::to_bits);
        if !self.last.borrow().0.is_some_and(is_last) {
            self.evaluated::<false>(y)?;
        }
        Ok(Ref::map(self.last.borrow(), |(_, found)| found))
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
        Ok(self.evaluated::<false>(x)?.residual)
    }

    fn linearize(
        &self,
        x: &[f64; BALL],
        rows: &mut [[f64; BALL]; BALL],
    ) -> Result<[f64; BALL], EvalError> {
        let found = self.evaluated::<true>(x)?;
        for (to, from) in rows.iter_mut().zip(&found.rows) {
            to.copy_from_slice(&from[..BALL]);
        }
        Ok(found.residual)
    }

    fn equation(&self, i: usize) -> String {
        ROWS[i].to_owned()
    }
}
