//! Traction model: friction is integrated over the contact ellipses, which covers the whole range
//! from rolling to gross slip.
//!
//! Theory: `docs/theory/09-traction.md`, equations (T1) to (T5), (T9) to (T11).

mod equations;
mod lubricated;
mod newton;
mod path;
mod push;
mod root;
mod search;
mod sensitivities;
mod slips;
mod train;

pub(crate) use self::equations::{COARSE_ACCURACY, COARSE_RESIDUAL, SEARCH_ACCURACY, turned};
use self::equations::{ROOT_RESIDUAL, SlipBall};
use self::root::RefinedRoot;
pub(crate) use self::root::SlipRoot;
pub use self::train::{TrainBall, TrainMotion};
use crate::ellipse::{RulePair, Rules};
use crate::models::ball::unknown::{NUT_LOAD, SCREW_LOAD};
use crate::models::ball::{
    ElasticContacts, ElasticPoint, ErrorBound, Model, Solution, SolveFailure, SolveInfo,
    SteadyState, Workspace, creep_effect, integrated_error,
};
use crate::models::raceway_control::{RollingBall, STATIC_UNKNOWNS};

/// Inputs of the traction model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Traction<D = f64> {
    /// Screw at its operating point; the friction coefficient must be positive.
    pub screw: ElasticPoint<D>,
    /// Permitted quadrature error divided by the friction force (dimensionless), positive.
    pub accuracy: f64,
    /// Creep speed `$v_e$` divided by `$r_b |W|$` (dimensionless), positive.
    pub creep: f64,
}

impl Traction {
    /// Default accuracy of the quadrature. The resulting quadrature error of the efficiency is at
    /// most 1e-7.
    pub const ACCURACY: f64 = 1e-8;
    /// Accuracies of the quadrature, which are used one after the other until the error bound is
    /// small enough. An accuracy of 1e-4 is not worth trying first, because its error bound exceeds
    /// 0.01 for one in six balls in partial skid.
    pub const ACCURACIES: [f64; 2] = [1e-6, Self::ACCURACY];
    /// Default creep speed, which changes the efficiency of most screws by less than 1e-6.
    pub const CREEP: f64 = 1e-4;
}

/// Reusable buffers for solving traction models.
#[derive(Default)]
pub struct TractionWorkspace {
    statics: Workspace<STATIC_UNKNOWNS>,
    newton: Workspace,
    rules: Rules,
}

impl Traction {
    /// Solves for the steady motion of the ball with friction integrated over the contact ellipses.
    ///
    /// The root is found with a coarse quadrature and then refined with a quadrature of the
    /// requested accuracy. If either step fails, a search with a finer quadrature, which includes
    /// continuation, decides whether a root exists.
    pub fn solve(&self, work: &mut TractionWorkspace) -> Solution {
        Solution::new(Model::Traction, self.root(work).map(|found| found.solved))
    }

    /// Finds the root, starting from the solution for a rolling ball, and its steady state.
    fn root(&self, work: &mut TractionWorkspace) -> Result<FoundRoot, SolveFailure> {
        self.screw.point.require_friction()?;
        let contacts = self.screw.scaled()?;
        let rolling_ball = RollingBall::of(&contacts, None, &mut work.statics);
        let start = RollingStart::new(&contacts, rolling_ball.ok().as_ref())?;
        self.find(&start, None, work).map_err(NotFound::failure)
    }

    /// Solves with increasingly accurate quadratures until the error bound of the efficiency is at
    /// most `tolerance`.
    ///
    /// The error bound includes the effect of the creep speed. If the root cannot be refined with a
    /// more accurate quadrature, the last root is returned, and its error bound is set to the whole
    /// power loss. If the search finds a root that cannot be refined with the first quadrature,
    /// this root is the starting value for the next quadrature.
    pub(crate) fn solve_to(
        &self,
        start: &RollingStart<'_>,
        tolerance: f64,
        work: &mut TractionWorkspace,
    ) -> Result<Integrated, SolveFailure> {
        let bound = |found: &FoundRoot| {
            integrated_error(found.error, found.solved.transmission.efficiency, found.by_creep)
        };
        let [first, finer @ ..] = Self::ACCURACIES;
        let mut case = Self { accuracy: first, ..*self };
        let mut found = case.find(start, None, work);
        for accuracy in finer {
            let from = match &found {
                Ok(found) if bound(found) <= tolerance => break,
                Ok(found) => found.root,
                Err(NotFound { near: Some(root), .. }) => **root,
                Err(_) => break,
            };
            let finer = Self { accuracy, ..case };
            match (finer.find(start, Some(&from), work), &mut found) {
                (Ok(mut next), former) => {
                    let before = match former {
                        Ok(former) => former.solved.info.map_or(0, |info| info.steps),
                        Err(lost) => lost.steps,
                    };
                    if let Some(info) = &mut next.solved.info {
                        info.steps += before;
                    }
                    (case, found) = (finer, Ok(next));
                }
                (Err(_), Ok(found)) => {
                    found.error = (1.0 - found.solved.transmission.efficiency).abs();
                    break;
                }
                (Err(_), Err(_)) => {}
            }
        }
        let found = found.map_err(NotFound::failure)?;
        let error = bound(&found);
        Ok(Integrated { found, accuracy: case.accuracy, error })
    }

    /// Finds the root and its steady state. If `from` is given, it is a root for a different
    /// quadrature and serves as the starting value.
    fn find(
        &self,
        RollingStart { contacts, rolling_ball }: &RollingStart<'_>,
        from: Option<&SlipRoot>,
        work: &mut TractionWorkspace,
    ) -> Result<FoundRoot, NotFound> {
        let TractionWorkspace { newton, rules, .. } = work;
        let pairs = rules.dry([COARSE_ACCURACY, SEARCH_ACCURACY, self.accuracy]);
        let creep = self.creep * contacts.slip_scale();
        let [coarse, search, ball] =
            pairs.map(|pair| SlipBall::of_contacts(contacts, &pair.rule, creep));
        let (coarse, ball) = (
            SlipBall { residual_goal: COARSE_RESIDUAL, ..coarse },
            SlipBall { residual_goal: ROOT_RESIDUAL, ..ball },
        );
        let [.., RulePair { check, .. }] = pairs;
        let frozen_rules = Default::default();
        let mut steps = 0;
        let near = if let Some(root) = from {
            Some(*root)
        } else {
            steps += rolling_ball.steps;
            coarse.direct(rolling_ball, newton, &mut steps)
        };
        let refined = near.and_then(|near| ball.refined(&near, &frozen_rules, newton, &mut steps));
        let refined = match (refined, from) {
            (Some(refined), _) => refined,
            (None, Some(_)) => return Err(SolveFailure::SEARCH_FAILED.into()),
            (None, None) => {
                let near = search.search(rolling_ball, newton, &mut steps)?;
                let frozen_rules = Default::default();
                let refined = ball.refined(&near, &frozen_rules, newton, &mut steps);
                let lost = || NotFound {
                    near: Some(Box::new(near)),
                    steps,
                    failure: SolveFailure::SEARCH_FAILED,
                };
                refined.ok_or_else(lost)?
            }
        };
        let RefinedRoot { root, transmitted, torque_slope, .. } = refined;
        let tractions = [NUT_LOAD, SCREW_LOAD].map(|load| contacts.friction * root.unknowns[load]);
        let by_creep = creep_effect(creep, tractions, transmitted.sliding.map(f64::abs));
        let steady = self.steady(&ball, &refined)?;
        let checked = SlipBall { quadrature: check, ..ball.of(&root) };
        let other = checked.evaluated(&root.unknowns).ok();
        let (other, efficiency) = (other.as_ref(), steady.transmission.efficiency);
        let error = checked.error(self.accuracy, other, &torque_slope, efficiency, newton);
        let solved = SteadyState {
            skid: Some(rolling_ball.skid(contacts)),
            info: Some(SolveInfo { steps, residual: root.residual }),
            error: Some(ErrorBound::of(contacts.direction, efficiency, error)),
            ..steady
        };
        Ok(FoundRoot { solved, root, error, by_creep })
    }

    /// Converts a root into a steady state in SI units.
    ///
    /// * `ball`: equations with which the root was refined.
    fn steady(
        &self,
        ball: &SlipBall<'_>,
        found: &RefinedRoot,
    ) -> Result<SteadyState, SolveFailure> {
        let RefinedRoot { root, transmitted, loaded, .. } = found;
        let to_nut = ball.of(root).motion_to_nut(&root.unknowns, loaded);
        let state = self.screw.ball_state(ball.contacts, loaded, &to_nut, true)?;
        let transmission = self.screw.transmission_at(transmitted.torque, transmitted.power)?;
        Ok(SteadyState::new(&state, transmission))
    }

    /// Returns all steady states on the branch of increasing inertia that begins at a ball without
    /// inertia. These states contain neither error bounds nor skid numbers.
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`] if the model does not accept the inputs, if the branch cannot be
    /// followed to its end, or if a root on the branch cannot be refined.
    pub fn branch(&self, work: &mut TractionWorkspace) -> Result<Vec<SteadyState>, SolveFailure> {
        self.screw.point.require_friction()?;
        let contacts = self.screw.scaled()?;
        let TractionWorkspace { newton, rules, .. } = work;
        let [search, fine] = rules.dry([SEARCH_ACCURACY, self.accuracy]);
        let creep = self.creep * contacts.slip_scale();
        let search = SlipBall::of_contacts(&contacts, &search.rule, creep);
        let ball = SlipBall {
            residual_goal: ROOT_RESIDUAL,
            ..SlipBall::of_contacts(&contacts, &fine.rule, creep)
        };
        let with_nut_angle = SlipBall { uses_nut_angle: true, ..search };
        let roots = search.all_roots(newton).or_else(|| with_nut_angle.all_roots(newton));
        let mut states = Vec::<SteadyState>::new();
        for near in roots.ok_or(SolveFailure::SEARCH_FAILED)? {
            let refined = ball.refined(&near, &Default::default(), newton, &mut 0);
            let state = self.steady(&ball, &refined.ok_or(SolveFailure::SEARCH_FAILED)?)?;
            if !states.iter().any(|known| are_equal(known, &state)) {
                states.push(state);
            }
        }
        Ok(states)
    }
}

/// Relative difference of the precession rates and of the efficiencies below which two steady
/// states are considered equal. Roots are refined to ten digits. Except at a fold, different roots
/// on a branch differ by more than this value.
const SAME_STATE_TOL: f64 = 1e-6;

/// Returns true if two steady states are the same except for rounding errors.
fn are_equal(one: &SteadyState, other: &SteadyState) -> bool {
    let numbers = |state: &SteadyState| {
        let precession = state.ball.motion.map_or(f64::NAN, |motion| motion.precession);
        [precession, state.transmission.efficiency]
    };
    let pairs = numbers(one).into_iter().zip(numbers(other));
    pairs.into_iter().all(|(x, y)| (x - y).abs() <= SAME_STATE_TOL * x.abs().max(y.abs()))
}

/// An operating point and the solution for a rolling ball at this point. The solver starts from the
/// rolling ball unless it already knows a root for another quadrature rule.
pub(crate) struct RollingStart<'a> {
    contacts: &'a ElasticContacts,
    rolling_ball: RollingBall,
}

impl<'a> RollingStart<'a> {
    /// Creates the starting value from the solution for a rolling ball, or from an estimate if
    /// there is no rolling ball.
    pub(crate) fn new(
        contacts: &'a ElasticContacts,
        rolling_ball: Option<&RollingBall>,
    ) -> Result<Self, SolveFailure> {
        // If the centrifugal force is too large for the estimate of a rolling ball, the estimate
        // for a ball without inertia is used.
        let guess = || {
            RollingBall::guess(contacts)
                .or_else(|_| RollingBall::guess(&contacts.with_inertia(0.0)))
        };
        Ok(Self {
            contacts,
            rolling_ball: rolling_ball.map_or_else(guess, |rolling_ball| Ok(*rolling_ball))?,
        })
    }
}

/// A root of the traction equations together with its steady state.
pub(crate) struct FoundRoot {
    pub(crate) solved: SteadyState,
    pub(crate) root: SlipRoot,
    /// Error bound of the efficiency due to quadrature (T25) (dimensionless).
    error: f64,
    /// Error bound of the friction power due to the creep speed, relative to the friction power
    /// (A8).
    by_creep: f64,
}

/// A root of the traction equations that was found with increasingly accurate quadratures.
pub(crate) struct Integrated {
    pub(crate) found: FoundRoot,
    /// Accuracy of the quadrature with which the root was found.
    pub(crate) accuracy: f64,
    /// Error bound of the efficiency, which includes the effect of the creep speed (dimensionless).
    pub(crate) error: f64,
}

/// Information about a solve that found no root with a given accuracy.
#[derive(Debug)]
struct NotFound {
    failure: SolveFailure,
    /// Root that the search found but that could not be refined with the requested accuracy, if
    /// any.
    near: Option<Box<SlipRoot>>,
    /// Number of Newton steps of the search.
    steps: usize,
}

impl NotFound {
    fn failure(self) -> SolveFailure {
        self.failure
    }
}

impl From<SolveFailure> for NotFound {
    fn from(failure: SolveFailure) -> Self {
        Self { failure, near: None, steps: 0 }
    }
}

#[cfg(test)]
mod tests;
