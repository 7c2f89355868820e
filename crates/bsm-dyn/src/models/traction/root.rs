//! Where the root of a point is looked for, and when there is none.
//!
//! Theory: `docs/theory/09-traction.md`, equation (T10), sections "Starts" and "Existence".

use std::cell::OnceCell;

use super::columns::{LastEvaluation, PowerFlow};
use super::multistart::{MANY, STARTS};
use super::path::{PathResult, STEP_CONTROL, are_on_flanks};
use super::{FrozenRule, OMEGA, SlipBall, SlipState};
use bsm_newton::{Continuation, follow};
use bsm_simd::Block;

use crate::contact::{POWER_BALANCE_TOL, Power, ideal_torque};
use crate::models::ball::{
    Attempt, BALL, BallLoads, Evidence, Reason, Unsolved, Workspace, first_answer,
};
use crate::models::elastic::GrossSlip;
use crate::models::raceway_control::RollingBall;

/// Onset number from which the skidding ball is the nearer start.
pub const SKID_ONSET: f64 = 0.5;

/// Newton steps and halvings of a step of a solve after which others may do better; of most points the solve after a
/// step at [`LEVEL`] takes full steps.
pub(super) const BRIEF: (usize, u32) = (12, 6);
pub(super) const FULL_STEPS: (usize, u32) = (12, 2);

/// Creep speeds over `$r_b|W|$` that are solved for before the asked one, in the order of the tries of a table; single solves have
/// tried the first, and take it last: against them friction is nearly linear in the slips of most starts.
pub(super) const LEVELS: [&[f64]; 2] = [&[LEVEL], &[0.3, 0.01]];
const LEVEL: f64 = 0.1;

/// Residual from which a level is left.
pub(super) const LEFT: f64 = 0.1;

/// No ball turns that fast: friction takes the power that the screw puts in.
pub(super) const FASTEST: f64 = 1e9;

/// Inertia over friction below which a path that leaves the flanks is not asked about twice.
const SMALL_INERTIA: f64 = 1e-3;

/// Centrifugal force over the load from which the contact angle at the nut has less than ten digits as
/// a difference of two others.
pub(super) const LARGE_INERTIA: f64 = 1e6;

/// A root of the equations of a point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SlipRoot {
    pub(super) unknowns: [f64; BALL],
    /// The unknowns are those of a ball under a high centrifugal load (T10).
    pub(super) nut_chart: bool,
    pub(super) residual: f64,
}

/// A root with what belongs to it.
pub(super) struct RootWithPower {
    pub(super) root: SlipRoot,
    pub(super) transmitted: PowerFlow,
    /// Derivatives of the torque by the unknowns, near the root.
    pub(super) torque_slope: Block,
    /// Its contacts.
    pub(super) loaded: BallLoads<f64>,
}

impl SlipBall<'_> {
    /// The root near one of another quadrature, if it is on the flanks, with the numbers of nodes that it
    /// has there: a root may lie where they change. `newton` keeps its Jacobian.
    ///
    /// * `plans`: filled.
    pub(super) fn refined(
        &self,
        near: &SlipRoot,
        plans: &[OnceCell<FrozenRule>; 2],
        newton: &mut Workspace,
        steps: &mut usize,
    ) -> Option<RootWithPower> {
        let mut unknowns = near.unknowns;
        let ball = SlipBall { plans: Some(plans), ..self.of(near) };
        let watched = LastEvaluation::new(&ball);
        let report = watched.run(&mut unknowns, newton);
        *steps += report.steps.len();
        if !report.converged() {
            return None;
        }
        let found = watched.at(&unknowns).ok()?;
        let (mut transmitted, torque_slope) = (found.transmitted, found.slope);
        // The last step is far below what a torque has as digits beyond its first order.
        for (k, step) in newton.correction(&found.residual).ok()?.into_iter().enumerate() {
            unknowns[k] += step;
            transmitted.torque += step * torque_slope[k];
        }
        let root = SlipRoot { unknowns, residual: report.residual, ..*near };
        let loaded = self.admitted(&root)?;
        Some(RootWithPower { root, transmitted, torque_slope, loaded })
    }

    /// Where a Newton step at the creep speed [`LEVEL`] leads to.
    fn predicted(&self, y: &[f64; BALL], newton: &mut Workspace) -> Option<[f64; BALL]> {
        let level = Self { creep: LEVEL.max(self.creep), ..*self };
        let residual = newton.linearize(&LastEvaluation::new(&level), y, &level.weights(y)).ok()?;
        level.stepped(y, &residual, newton)
    }

    /// Where the step of a residual leads to, with the Jacobian that `newton` has.
    fn stepped(
        &self,
        y: &[f64; BALL],
        residual: &[f64; BALL],
        newton: &mut Workspace,
    ) -> Option<[f64; BALL]> {
        Some(self.slid(y, &newton.correction(residual).ok()?))
    }

    /// The root that Newton finds from `y` over a few levels of the creep speed, if it is on the flanks.
    fn descended(
        &self,
        mut y: [f64; BALL],
        levels: &[f64],
        newton: &mut Workspace,
        steps: &mut usize,
    ) -> Option<SlipRoot> {
        let brief = Self { limits: BRIEF, ..*self };
        for level in levels.iter().filter(|level| **level > self.creep) {
            let report = Self { creep: *level, enough: LEFT, ..brief }.run(&mut y, newton);
            *steps += report.steps.len();
            if !report.converged() {
                return None;
            }
        }
        brief.solved(y, newton, steps).ok()
    }

    /// The root that Newton finds from `y`, if it is on the flanks.
    pub(super) fn solved(
        &self,
        mut y: [f64; BALL],
        newton: &mut Workspace,
        steps: &mut usize,
    ) -> Result<SlipRoot, Reason> {
        let watched = LastEvaluation::new(self);
        let report = watched.run(&mut y, newton);
        *steps += report.steps.len();
        if report.converged() {
            if self.is_first_try() {
                // As in tables, the last step is taken without an evaluation.
                let found = watched.at(&y).ok();
                let last = found.and_then(|found| self.stepped(&y, &found.residual, newton));
                y = last.unwrap_or(y);
            }
            let root = self.in_nut_chart(y, report.residual, newton, steps);
            if self.is_admissible(&root) {
                return Ok(root);
            }
        }
        Err(report.into())
    }

    /// The root that `y` leads to while the logarithm of the creep speed goes from `begin` to its own, if
    /// it is on the flanks.
    pub(super) fn by_falling_creep(
        &self,
        mut y: [f64; BALL],
        begin: f64,
        control: Continuation,
        newton: &mut Workspace,
        steps: &mut usize,
    ) -> Option<SlipRoot> {
        let mut residual = f64::INFINITY;
        let arrived = follow(&mut y, (begin, self.creep.ln()), control, |log, y| {
            let report = Self { creep: log.exp(), ..*self }.run(y, newton);
            *steps += report.steps.len();
            residual = report.residual;
            report.converged()
        });
        arrived.ok()?;
        let root = self.in_nut_chart(y, residual, newton, steps);
        self.is_admissible(&root).then_some(root)
    }

    /// The root with these unknowns; in the unknowns (T10) if the centrifugal load is high.
    pub(super) fn in_nut_chart(
        &self,
        y: [f64; BALL],
        residual: f64,
        newton: &mut Workspace,
        steps: &mut usize,
    ) -> SlipRoot {
        let root = SlipRoot { unknowns: y, nut_chart: self.nut_chart, residual };
        let rate = self.rate(&y);
        if self.nut_chart || self.contacts.inertia_ratio() * rate * rate <= LARGE_INERTIA {
            return root;
        }
        let Ok(SlipState { loaded, to_nut, .. }) = self.state(&y) else { return root };
        let ball = Self { nut_chart: true, ..*self };
        let mut unknowns = ball.unknowns(&loaded, &to_nut);
        let report = ball.run(&mut unknowns, newton);
        *steps += report.steps.len();
        let charted = SlipRoot { unknowns, nut_chart: true, residual: report.residual };
        if report.converged() { charted } else { root }
    }

    /// The equations in the unknowns of a root.
    pub(super) fn of(&self, root: &SlipRoot) -> Self {
        Self { nut_chart: root.nut_chart, ..*self }
    }

    /// True for a root with both contacts on their flanks.
    pub(super) fn is_admissible(&self, root: &SlipRoot) -> bool {
        self.admitted(root).is_some()
    }

    /// The contacts of a root that has both on their flanks.
    fn admitted(&self, root: &SlipRoot) -> Option<BallLoads<f64>> {
        let y = &root.unknowns;
        let loaded = self.of(root).loaded(y).ok()?;
        let slow = OMEGA.iter().all(|i| y[*i].abs() < FASTEST);
        (slow && are_on_flanks(loaded.angles, 0.0)).then_some(loaded)
    }

    /// True for a root whose powers balance. Where a ball turns faster and faster about the axis the
    /// residual vanishes without a root, and the powers do not balance.
    pub(super) fn is_balanced(&self, root: &SlipRoot) -> bool {
        let contacts = self.contacts;
        self.of(root).evaluated::<false>(&root.unknowns).is_ok_and(|found| {
            let ideal = ideal_torque(1.0, contacts.helix.radius, contacts.helix.lead_angle.tan());
            let PowerFlow { torque, power, .. } = found.transmitted;
            let imbalance = Power::transmitted(torque, ideal, 1.0).imbalance(power);
            imbalance.abs() <= POWER_BALANCE_TOL
        })
    }

    /// True if inertia forces are too small against friction to move the ball to another root.
    fn is_calm(&self) -> bool {
        let rate = self.contacts.scaled.nut_speed.abs().max(1.0);
        self.contacts.inertia_ratio() * rate * rate < SMALL_INERTIA * self.contacts.friction
    }
}

/// A point on the way to its root.
struct SlipRootSearch<'a> {
    ball: SlipBall<'a>,
    rolling_ball: &'a RollingBall,
    newton: &'a mut Workspace,
    steps: &'a mut usize,
    /// What the path of growing inertia has shown.
    shown: PathResult,
    /// Scattered starts that have led to no root.
    starts: u32,
}

impl SlipBall<'_> {
    /// The root that is found without a search along a path.
    pub(super) fn search_near(
        &self,
        rolling_ball: &RollingBall,
        newton: &mut Workspace,
        steps: &mut usize,
    ) -> Option<SlipRoot> {
        let mut search = SlipRootSearch::new(*self, rolling_ball, newton, steps);
        first_answer(&mut search, &SlipRootSearch::NEAR).ok()
    }

    /// The root by all strategies.
    ///
    /// Where the roots of the path are all beyond the flanks, and no start leads to another, the
    /// answer is that there is none.
    pub(super) fn search(
        &self,
        rolling_ball: &RollingBall,
        newton: &mut Workspace,
        steps: &mut usize,
    ) -> Result<SlipRoot, Unsolved> {
        let mut search = SlipRootSearch::new(*self, rolling_ball, newton, steps);
        first_answer(&mut search, &SlipRootSearch::ALL)
    }
}

impl<'a> SlipRootSearch<'a> {
    const NEAR: [fn(&mut Self) -> Attempt<SlipRoot>; 3] =
        [Self::likely_start, Self::other_start, Self::falling_creep];
    const ALL: [fn(&mut Self) -> Attempt<SlipRoot>; 6] = {
        let [likely, other, creep] = Self::NEAR;
        [likely, other, creep, Self::growing_inertia, Self::scattered_starts, Self::what_is_shown]
    };

    fn new(
        ball: SlipBall<'a>,
        rolling_ball: &'a RollingBall,
        newton: &'a mut Workspace,
        steps: &'a mut usize,
    ) -> Self {
        Self { ball, rolling_ball, newton, steps, shown: PathResult::Nothing, starts: 0 }
    }

    /// True if the skidding ball is nearer than the rolling one.
    fn is_skidding(&self) -> bool {
        let onset = self.rolling_ball.skid(self.ball.contacts).onset_number();
        onset.is_some_and(|onset| onset > SKID_ONSET)
    }

    /// The rolling ball.
    fn rolling(&self) -> [f64; BALL] {
        self.ball.unknowns(&self.rolling_ball.loaded, &self.rolling_ball.to_nut)
    }

    /// From the nearer one of the rolling and the skidding ball.
    fn likely_start(&mut self) -> Attempt<SlipRoot> {
        self.start(self.is_skidding())
    }

    fn other_start(&mut self) -> Attempt<SlipRoot> {
        self.start(!self.is_skidding())
    }

    /// By Newton from a ball that skids, whose slips are nearly those of the root, or from the rolling one, which has none
    /// and takes a step at a high creep speed first.
    fn start(&mut self, skidding: bool) -> Attempt<SlipRoot> {
        let (rolling, Self { ball, newton, steps, .. }) = (self.rolling(), self);
        let (y, near) = if skidding {
            let skid = GrossSlip::start(ball.contacts).ok()?;
            **steps += skid.steps();
            let y = ball.unknowns(skid.state().0, skid.state().1);
            (y, Some(y))
        } else {
            let predicted = ball.predicted(&rolling, newton);
            **steps += usize::from(predicted.is_some());
            (rolling, predicted)
        };
        if let Some(y) = near {
            let direct = SlipBall { limits: FULL_STEPS, ..*ball };
            if let Ok(root) = direct.solved(y, newton, steps) {
                return Some(Ok(root));
            }
        }
        // The step to the first of them has not led to the root.
        let mut levels = LEVELS.into_iter().rev();
        levels.find_map(|levels| ball.descended(y, levels, newton, steps)).map(Ok)
    }

    /// From friction that is nearly proportional to the slip.
    fn falling_creep(&mut self) -> Attempt<SlipRoot> {
        let control = Continuation { first: 1.0, shortest: 0.05 };
        self.ball.by_falling_creep(self.rolling(), 0.0, control, self.newton, self.steps).map(Ok)
    }

    /// Along the path of growing inertia.
    fn growing_inertia(&mut self) -> Attempt<SlipRoot> {
        let Self { ball, newton, steps, .. } = self;
        self.shown = ball.followed(newton, steps);
        if matches!(self.shown, PathResult::Nothing) {
            // It may be the digits that were lost.
            self.shown = SlipBall { nut_chart: true, ..*ball }.followed(newton, steps);
        }
        match self.shown {
            PathResult::SlipRoot(root) => ball.is_balanced(&root).then_some(Ok(root)),
            _ => None,
        }
    }

    /// From starts spread over what a ball can do.
    fn scattered_starts(&mut self) -> Attempt<SlipRoot> {
        self.starts = match self.shown {
            PathResult::OffFlank(_) if self.ball.is_calm() => 0,
            PathResult::Ended(_) => MANY,
            _ => STARTS,
        };
        self.ball.multistart(self.starts, self.newton, self.steps).map(Ok)
    }

    /// What the path has shown where no start leads to a root.
    fn what_is_shown(&mut self) -> Attempt<SlipRoot> {
        match self.shown {
            // Rounding has eaten it, which its powers will show.
            PathResult::SlipRoot(root) => Some(Ok(root)),
            PathResult::OffFlank([nut, screw]) | PathResult::Ended([nut, screw]) => {
                let evidence = match self.starts {
                    0 => Evidence::Traced { resolution: STEP_CONTROL.longest },
                    starts => Evidence::Sampled { starts },
                };
                Some(Err(Unsolved::none(evidence, Reason::BallLeavesFlank { nut, screw })))
            }
            PathResult::Nothing => None,
        }
    }
}
