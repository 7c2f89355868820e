//! The search for the root of a point, and the criteria for `no_solution`.
//!
//! Theory: `docs/theory/09-traction.md`, sections "Starting values" and "Existence".

use bsm_kin::Motion;
use bsm_newton::Continuation;
use nalgebra::Vector3;

use super::equations::SlipBall;
use super::multistart::{MANY, STARTS};
use super::path::{PathResult, STEP_CONTROL};
use super::root::{LEVELS, START_LIMITS, SlipRoot};
use crate::models::ball::{Attempt, BALL, Evidence, NoAnswer, Reason, Workspace, first_answer};
use crate::models::elastic::GrossSlip;
use crate::models::raceway_control::RollingBall;

/// Onset number from which the skidding ball is the nearer start.
const SKID_ONSET: f64 = 0.5;

/// Inertia over friction below which a path that leaves the flanks is not asked about twice.
const SMALL_INERTIA: f64 = 1e-3;

impl SlipBall<'_> {
    /// True if inertia forces are too small against friction to move the ball to another root.
    fn has_small_inertia(&self) -> bool {
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
    /// Where the path of growing inertia has led to.
    path: PathResult,
    /// Starts of the multistart, which have led to no root.
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
        first_answer(&mut search, &SlipRootSearch::LOCAL).ok()
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
    ) -> Result<SlipRoot, NoAnswer> {
        let mut search = SlipRootSearch::new(*self, rolling_ball, newton, steps);
        let near = first_answer(&mut search, &SlipRootSearch::LOCAL);
        near.or_else(|_| first_answer(&mut search, &SlipRootSearch::GLOBAL))
    }
}

impl<'a> SlipRootSearch<'a> {
    /// Where one start fails the other one mostly takes a few evaluations, and levels take dozens.
    const LOCAL: [fn(&mut Self) -> Attempt<SlipRoot>; 6] = [
        Self::likely_start,
        Self::other_start,
        Self::levels_of_likely_start,
        Self::levels_of_other_start,
        Self::at_rest_in_nut,
        Self::falling_creep,
    ];
    const GLOBAL: [fn(&mut Self) -> Attempt<SlipRoot>; 3] =
        [Self::growing_inertia, Self::multistart, Self::result_of_path];

    fn new(
        ball: SlipBall<'a>,
        rolling_ball: &'a RollingBall,
        newton: &'a mut Workspace,
        steps: &'a mut usize,
    ) -> Self {
        Self { ball, rolling_ball, newton, steps, path: PathResult::Nothing, starts: 0 }
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

    /// The skidding ball.
    fn skidding(&mut self) -> Option<[f64; BALL]> {
        let skid = GrossSlip::start(self.ball.contacts).ok()?;
        *self.steps += skid.steps();
        Some(self.ball.unknowns(skid.state().0, skid.state().1))
    }

    /// From the nearer one of the rolling and the skidding ball.
    fn likely_start(&mut self) -> Attempt<SlipRoot> {
        self.start(self.is_skidding())
    }

    fn other_start(&mut self) -> Attempt<SlipRoot> {
        self.start(!self.is_skidding())
    }

    fn levels_of_likely_start(&mut self) -> Attempt<SlipRoot> {
        self.levels_of(self.is_skidding())
    }

    fn levels_of_other_start(&mut self) -> Attempt<SlipRoot> {
        self.levels_of(!self.is_skidding())
    }

    /// From a ball that skids, whose slips are nearly those of the root, or from the rolling one, which has none.
    fn start(&mut self, skidding: bool) -> Attempt<SlipRoot> {
        if skidding {
            let y = self.skidding()?;
            self.direct(y)
        } else {
            self.without_slips(self.rolling())
        }
    }

    fn levels_of(&mut self, skidding: bool) -> Attempt<SlipRoot> {
        let y = if skidding { self.skidding()? } else { self.rolling() };
        self.levels(y)
    }

    /// From a ball that stands still in the nut: inertia beyond that of a ball that skids presses it there until it is held.
    fn at_rest_in_nut(&mut self) -> Attempt<SlipRoot> {
        let contacts = self.ball.contacts;
        let [nut, screw, tilt] = contacts.static_balance(contacts.scaled.nut_speed);
        let loaded = contacts.loaded([nut, screw], tilt).ok()?;
        let still = Motion { precession: 0.0, omega: Vector3::zeros() };
        let y = self.ball.unknowns(&loaded, &still);
        self.without_slips(y).or_else(|| self.levels(y))
    }

    /// After a step at a high creep speed.
    fn without_slips(&mut self, y: [f64; BALL]) -> Attempt<SlipRoot> {
        let predicted = self.ball.predicted(&y, self.newton);
        *self.steps += usize::from(predicted.is_some());
        predicted.and_then(|y| self.direct(y))
    }

    /// By Newton.
    fn direct(&mut self, y: [f64; BALL]) -> Attempt<SlipRoot> {
        let ball = SlipBall { limits: START_LIMITS, ..self.ball };
        ball.solved(y, self.newton, self.steps).ok().map(Ok)
    }

    /// Over a few levels of the creep speed.
    fn levels(&mut self, y: [f64; BALL]) -> Attempt<SlipRoot> {
        let Self { ball, newton, steps, .. } = self;
        LEVELS.iter().find_map(|levels| ball.descended(y, levels, newton, steps)).map(Ok)
    }

    /// From friction that is nearly proportional to the slip.
    fn falling_creep(&mut self) -> Attempt<SlipRoot> {
        crate::cost::searched();
        let control = Continuation { first: 1.0, shortest: 0.05 };
        self.ball.by_falling_creep(self.rolling(), 0.0, control, self.newton, self.steps).map(Ok)
    }

    /// Along the path of growing inertia.
    fn growing_inertia(&mut self) -> Attempt<SlipRoot> {
        let Self { ball, newton, steps, .. } = self;
        self.path = ball.followed(newton, steps);
        if matches!(self.path, PathResult::Nothing) {
            // It may be the digits that were lost.
            self.path = SlipBall { nut_chart: true, ..*ball }.followed(newton, steps);
        }
        match self.path {
            PathResult::SlipRoot(root) => ball.is_balanced(&root).then_some(Ok(root)),
            _ => None,
        }
    }

    /// From starts spread over what a ball can do.
    fn multistart(&mut self) -> Attempt<SlipRoot> {
        self.starts = match self.path {
            PathResult::OffFlank(_) if self.ball.has_small_inertia() => 0,
            PathResult::Ended(_) => MANY,
            _ => STARTS,
        };
        self.ball.multistart(self.starts, self.newton, self.steps).map(Ok)
    }

    /// Where the path has led to, where no start leads to a root.
    fn result_of_path(&mut self) -> Attempt<SlipRoot> {
        match self.path {
            // Rounding has eaten it, which its powers will show.
            PathResult::SlipRoot(root) => Some(Ok(root)),
            PathResult::OffFlank([nut, screw]) | PathResult::Ended([nut, screw]) => {
                let evidence = match self.starts {
                    0 => Evidence::Traced { resolution: STEP_CONTROL.longest },
                    starts => Evidence::Sampled { starts },
                };
                Some(Err(NoAnswer::none(evidence, Reason::BallLeavesFlank { nut, screw })))
            }
            PathResult::Nothing => None,
        }
    }
}
