//! Rolling, partial and gross slip in one model: friction integrated over the contact ellipses.
//!
//! Theory: `docs/theory/09-traction.md`, equations (T1) to (T5), (T9) to (T11).

mod columns;
mod lubricated;
mod many;
mod multistart;
mod path;
mod root;
mod sensitivities;
mod slips;
mod train;

use std::array::from_fn;
use std::cell::OnceCell;

use bsm_kin::{Field, Helix, Motion, Scalar};
use bsm_newton::{EvalError, JacobianUpdate, Options, Report, Scales, solve};
use bsm_simd::{Block, Compare};

pub use self::columns::TractionPoint;
use self::columns::{EquationValues, LastEvaluation, PowerFlow, lever, sizes};
pub use self::many::{NumberRows, TractionMany, TractionRoot, TractionStart};
use self::root::RootWithPower;
pub use self::root::SKID_ONSET;
pub(crate) use self::root::SlipRoot;
use self::train::Push;
pub use self::train::{TrainBall, TrainMotion};
use crate::contact::{Wrench, ideal_torque};
use crate::cost;
use crate::ellipse::{FrozenRule, Integrate, Local, Placement, Quadrature, Rules};
use crate::models::ball::unknown::{NUT_LOAD, PRECESSION, SCREW_LOAD, TILT};
use crate::models::ball::{
    BALL, BallLoads, EhlLoss, EhlPoint, ElasticContacts, ElasticPoint, ErrorBound, Model, Solution,
    SolveInfo, Solved, Status, Unsolved, Workspace, quadrature_error, to_both, weight,
};
use crate::models::raceway_control::{RollingBall, STATIC};

/// Places of the angular velocity along `$k$`, `$n$` and `$k \times n$` (T4).
const OMEGA: [usize; 3] = [4, 5, 6];

/// Accuracies of the quadrature: of the first try, and of the search for what it does not find, whose sums
/// change smoothly enough to be followed.
const COARSE: f64 = 1e-4;
const SEARCH: f64 = 1e-6;
/// Residual from which the first try is left to the quadrature that is asked for.
const NEAR: f64 = 1e-3;
/// Residual from which a last step, which is not evaluated, leads to the root.
const ROOT: f64 = 1e-10;
/// Residual below which steps keep the Jacobian; that whose square is enough, if it is larger.
const KEEP: f64 = 1e-3;

/// Nut speed over the relative speed from which the unknown of the precession leaves it out.
pub const FAST_NUT: f64 = 2.0;

/// A solve may take this many steps and halvings of a step.
const LIMITS: (usize, u32) = (20, 20);

/// Inputs of the traction model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Traction<D = f64> {
    /// The screw at its operating point; friction positive.
    pub at: ElasticPoint<D>,
    /// Accuracy of the quadrature over the ellipses: its error over the friction.
    pub accuracy: f64,
    /// Creep speed `$v_e$` over `$r_b |W|$`, positive.
    pub creep: f64,
}

impl Traction {
    /// Accuracy that leaves an error below 1e-7 in the efficiency.
    pub const ACCURACY: f64 = 1e-8;
    /// Accuracies of the choice by error bounds, one after the other. At 1e-4 the stated error is above 0.01 for one in
    /// six balls in partial skid, and what that saves for the others is less.
    pub const ACCURACIES: [f64; 2] = [1e-6, Self::ACCURACY];
    /// Creep speed that moves the efficiency of most screws by less than 1e-6.
    pub const CREEP: f64 = 1e-4;
}

/// Bound of the error of the efficiency, with that of the creep speed, from that of the quadrature (A6).
///
/// * `by_creep`: what the creep speed may change of the friction power, relative, from 0 to 1 (A8).
#[inline(always)]
pub fn integrated_error<F: Compare>(by_quadrature: F, efficiency: F, by_creep: F) -> F {
    // |δη| ≤ |δη|_rule + |1 − η| |δP_f|/P_f                               (A6)
    by_quadrature + (-efficiency + 1.0).abs() * by_creep
}

/// What a creep speed may change of the friction power, relative, at most 1 (A8).
///
/// * `pulls`: `$f Q$` at nut and screw. * `sliding`: the power that it takes.
#[inline(always)]
pub(crate) fn creep_effect<F: Compare>(creep: F, pulls: [F; 2], sliding: [F; 2]) -> F {
    // |δP_f|/P_f ≤ 4 v_e² Σ (f Q)²/P_f,j / Σ P_f,j                        (A8)
    let slow = pulls[0].square() / sliding[0] + pulls[1].square() / sliding[1];
    let effect = creep.square() * slow / (sliding[0] + sliding[1]) * 4.0;
    let one = effect.constant(1.0);
    F::select(effect.lt(one), effect, one)
}

/// Memory of the solves.
#[derive(Default)]
pub struct TractionWorkspace {
    statics: Workspace<STATIC>,
    newton: Workspace,
    rules: Rules,
}

/// The equations of a point.
#[derive(Clone, Copy)]
struct SlipBall<'a, P = f64> {
    contacts: &'a ElasticContacts<P>,
    quadrature: &'a Quadrature,
    /// Numbers of nodes near a root; by the slip elsewhere.
    plans: Option<&'a [OnceCell<FrozenRule>; 2]>,
    creep: f64,
    /// The residual that is small enough for a root, and the one that is aimed at.
    enough: f64,
    /// The unknowns are those of a ball under a high centrifugal load (T10).
    nut_chart: bool,
    /// What friction comes from, unless it has one coefficient.
    lubrication: Option<Lubrication<'a, P>>,
    /// Of its neighbours.
    push: Option<Push>,
    /// Steps and halvings of a step after which a solve is given up.
    limits: (usize, u32),
}

/// Friction by a lubricant.
#[derive(Clone, Copy)]
struct Lubrication<'a, P = f64> {
    ehl: &'a EhlPoint<P>,
    /// Part of the friction that comes from it; the rest has one coefficient.
    fraction: f64,
    /// Derivatives of all that changes, by jets; else without those that hardly matter, by hand.
    complete: bool,
}

struct SlipState<D> {
    loaded: BallLoads<D>,
    to_nut: Motion<D>,
    wrench: [Wrench<D>; 2],
    /// That friction takes, and that of sliding at nut and screw; without derivatives.
    power: f64,
    sliding: [f64; 2],
    /// What a lubricant does.
    losses: Option<[EhlLoss<D>; 2]>,
}

impl<P: Scalar> SlipBall<'_, P> {
    fn state<D: Integrate<P>>(&self, y: &[D; BALL]) -> Result<SlipState<D>, EvalError> {
        self.contact_wrenches(y, D::from(self.contacts.friction))
    }

    /// Contacts of a state.
    fn loaded<D: Integrate<P>>(&self, y: &[D; BALL]) -> Result<BallLoads<D>, EvalError> {
        let loads = [y[NUT_LOAD], y[SCREW_LOAD]];
        if self.nut_chart {
            // (Q_A/F_a, β_A, Q_B/F_a, (P − Ω_n)/W, …)                     (T10)
            self.contacts.loaded_by_nut_angle(loads, y[TILT])
        } else {
            self.contacts.loaded(loads, y[TILT])
        }
    }

    /// Motion relative to the nut.
    fn motion_to_nut<D: Integrate<P>>(&self, y: &[D; BALL], loaded: &BallLoads<D>) -> Motion<D> {
        // ω' = ω'_k k + ω'_n n + ω'_c k × n                               (T4)
        let [k, n] = [loaded.frame.k, loaded.frame.n];
        let [along, radial, around] = OMEGA.map(|i| y[i]);
        let omega = k * along + n * radial + k.cross(&n) * around;
        Motion {
            precession: y[PRECESSION] + (self.offset() - self.contacts.scaled.nut_speed),
            omega,
        }
    }

    /// The state with another friction coefficient.
    fn contact_wrenches<D: Integrate<P>>(
        &self,
        y: &[D; BALL],
        friction: D,
    ) -> Result<SlipState<D>, EvalError> {
        cost::evaluated();
        let (contacts, loaded) = (self.contacts, self.loaded(y)?);
        let to_nut = self.motion_to_nut(y, &loaded);
        let motions = to_both(&to_nut, &loaded.frame);
        let (mut power, mut sliding) = (0.0, [0.0; 2]);
        let fraction = self.lubrication.map_or(0.0, |lubrication| lubrication.fraction);
        let mut wrench = [Wrench::zero(); 2];
        if fraction < 1.0 {
            wrench = from_fn(|i| {
                let contact = &loaded.contacts[i];
                let local = Local::of(&motions[i], contact, D::from(contacts.scaled.arc));
                let ellipse = contacts.ellipse(i, &loaded);
                let (unit, unit_power) = D::integrate(&ellipse, &local, self.creep, self.nodes(i));
                let pull = loaded.loads[i] * contacts.signed(friction);
                // P_f = Σ f Q ∫ dP                                        (P7)
                sliding[i] = pull.re() * unit_power;
                power += sliding[i];
                // f Q ∫ dF,  f Q ∫ dM                                     (T2)
                unit.wrench(contact) * (pull * (1.0 - fraction))
            });
        }
        let losses = self.lubrication.map(|Lubrication { ehl, .. }| {
            let of = (contacts, &loaded);
            from_fn(|i| ehl.loss(i, of, &motions[i], self.creep, self.nodes(i)))
        });
        if let Some(losses) = &losses {
            // ∫ dF + F_h,  ∫ r × dF + r × F_h + C_h                       (Y32)
            wrench = from_fn(|i| wrench[i] + losses[i].wrench * D::from(fraction));
            sliding = losses.each_ref().map(|loss| loss.sliding.re());
            power = losses.iter().map(|loss| (loss.sliding + loss.rolling).re()).sum();
        }
        // F = Q N + f Q ∫ dF                                              (T2)
        for (wrench, (contact, load)) in
            wrench.iter_mut().zip(loaded.contacts.iter().zip(loaded.loads))
        {
            wrench.force = contact.normal * load + wrench.force;
        }
        Ok(SlipState { loaded, to_nut, wrench, power, sliding, losses })
    }

    /// The nodes at nut (0) or screw (1).
    fn nodes(&self, i: usize) -> Placement<'_> {
        let (rule, plan) = (self.quadrature, self.plans.map(|plans| &plans[i]));
        Placement { rule, plan, coarse: self.is_first_try() && self.lubrication.is_none() }
    }

    /// True if its root is only a start for another quadrature or creep speed.
    fn is_first_try(&self) -> bool {
        self.enough >= NEAR
    }

    /// What the unknown of the precession leaves out of its rate: the nut's speed where that is far
    /// above the relative speed, so that neither the rate nor the slip loses its digits, or where the
    /// ball all but sticks to the nut.
    fn offset(&self) -> P {
        let nut = self.contacts.scaled.nut_speed;
        if self.nut_chart || nut.re().abs() > FAST_NUT { nut } else { P::from(0.0) }
    }

    fn residual<D: Integrate<P>>(&self, y: &[D; BALL]) -> Result<[D; BALL], EvalError> {
        let rate = y[PRECESSION] + self.offset();
        Ok(self.residual_of(y, &self.state(y)?, rate))
    }

    /// What the balance leaves over, with the inertia forces of a precession rate.
    fn residual_of<D: Integrate<P>>(
        &self,
        y: &[D; BALL],
        state: &SlipState<D>,
        rate: D,
    ) -> [D; BALL] {
        // k × ω = ω'_n k × n − ω'_c n                                     (T5)
        let [_, radial, around] = OMEGA.map(|i| y[i]);
        let n = state.loaded.frame.n;
        let omega = n * radial + state.loaded.frame.k.cross(&n) * around;
        let mut residual = self.contacts.balance(
            &state.loaded,
            &Motion { precession: rate, omega },
            &state.wrench,
        );
        if let Some(push) = &self.push {
            push.add_to(&mut residual, self.contacts, (&state.loaded, &state.to_nut));
        }
        residual
    }
}

impl<'a> SlipBall<'a> {
    /// In the unknowns (T1).
    fn of_contacts(contacts: &'a ElasticContacts, quadrature: &'a Quadrature, creep: f64) -> Self {
        let (plans, lubrication, push, nut_chart, limits) = (None, None, None, false, LIMITS);
        Self {
            contacts,
            quadrature,
            plans,
            creep,
            enough: 1e-12,
            nut_chart,
            lubrication,
            push,
            limits,
        }
    }
}

impl<'a> SlipBall<'a> {
    /// The same equations of a point with derivatives.
    fn over<P>(
        &self,
        contacts: &'a ElasticContacts<P>,
        lubrication: Option<Lubrication<'a, P>>,
    ) -> SlipBall<'a, P> {
        let Self { quadrature, plans, creep, enough, nut_chart, push, limits, .. } = *self;
        SlipBall {
            contacts,
            quadrature,
            plans,
            creep,
            enough,
            nut_chart,
            lubrication,
            push,
            limits,
        }
    }
}

impl SlipBall<'_> {
    /// Bound of the error of the efficiency of a root of another quadrature, from that of this one (T25).
    ///
    /// * `accuracy`: of the other one. * `found`: there, of this quadrature. * `slope`: of the torque by the unknowns. * `newton`: as the solve
    ///   for the root has left it.
    fn error(
        &self,
        accuracy: f64,
        found: Option<&EquationValues>,
        slope: &Block,
        efficiency: f64,
        newton: &mut Workspace,
    ) -> f64 {
        let other = found.and_then(|found| {
            // y' = y − J⁻¹ F'(y)                                          (T24)
            let step = newton.correction(&found.residual).ok()?;
            let further = step.iter().zip(slope).map(|(x, slope)| x * slope).sum::<f64>();
            let torque = found.transmitted.torque + further;
            let Helix { radius, lead_angle } = self.contacts.helix;
            let ideal = ideal_torque(1.0, radius, lead_angle.tan());
            Some(crate::contact::efficiency(self.contacts.direction.is_back(), ideal, torque))
        });
        let other = other.unwrap_or(f64::NAN);
        let error = quadrature_error(other - efficiency, accuracy);
        if error.is_finite() { error } else { (1.0 - efficiency).abs() }
    }

    /// The unknowns (T1) of a state.
    fn unknowns(&self, loaded: &BallLoads<f64>, to_nut: &Motion<f64>) -> [f64; BALL] {
        let mut y = [0.0; BALL];
        [y[NUT_LOAD], y[SCREW_LOAD]] = loaded.loads;
        y[TILT] = if self.nut_chart { loaded.angles[0] } else { loaded.tilt };
        y[PRECESSION] = to_nut.precession + self.contacts.scaled.nut_speed - self.offset();
        let [k, n] = [loaded.frame.k, loaded.frame.n];
        for (place, axis) in OMEGA.iter().zip([k, n, k.cross(&n)]) {
            y[*place] = to_nut.omega.dot(&axis);
        }
        y
    }

    /// Weights of the equations.
    fn weights(&self, y: &[f64; BALL]) -> [f64; BALL] {
        self.weights_of(y, self.contacts.friction, y[PRECESSION] + self.offset())
    }

    /// The same with the friction and the inertia forces of a path.
    fn weights_of(&self, y: &[f64; BALL], friction: f64, rate: f64) -> [f64; BALL] {
        let centrifugal = self.contacts.inertia_ratio() * rate * rate;
        let across = if self.nut_chart {
            centrifugal.min(self.friction_force(y, friction, centrifugal))
        } else {
            centrifugal
        };
        let (force, moment) = sizes(across, friction, self.lever(y));
        let [force, pressing, moment] = [force, centrifugal.max(1.0), moment].map(weight);
        [force, pressing, force, moment, moment, moment, force]
    }

    /// Size of the friction at the nut that the digits of its slip are worth.
    fn friction_force(&self, y: &[f64; BALL], friction: f64, load: f64) -> f64 {
        // f C (|P − Ω_n| r_m + |ω'|)/v_e                                  (T11)
        let turning = OMEGA.iter().map(|i| y[*i].abs()).sum::<f64>();
        let slip = y[PRECESSION].abs() * self.contacts.helix.radius + turning;
        friction * load * slip / self.creep
    }

    /// Lever arm of friction over the ball radius.
    fn lever(&self, y: &[f64; BALL]) -> f64 {
        let lengths = [(0, NUT_LOAD), (1, SCREW_LOAD)]
            .map(|(i, load)| self.contacts.scaled.semi_axes[i].0 * Field::cbrt(y[load]));
        lever(lengths, self.contacts.scaled.pressed_radius)
    }

    /// One damped Newton solve from `y`.
    fn run(&self, y: &mut [f64; BALL], newton: &mut Workspace) -> Report {
        LastEvaluation::new(self).run(y, newton)
    }
}

impl<P> SlipBall<'_, P> {
    /// Of a Newton solve.
    fn options(&self) -> Options {
        let (max_steps, max_halvings) = self.limits;
        let by_jets = self.lubrication.as_ref().is_some_and(|lubrication| lubrication.complete);
        let chord_below = if by_jets { 0.0 } else { self.enough.sqrt().max(KEEP) };
        Options {
            residual_tol: self.enough.max(ROOT),
            residual_goal: self.enough,
            max_steps,
            max_halvings,
            jacobian: JacobianUpdate::EveryTrial { chord_below },
        }
    }
}

impl LastEvaluation<'_> {
    fn run(&self, y: &mut [f64; BALL], newton: &mut Workspace) -> Report {
        let weights = self.ball.weights(y);
        let scales = Scales { x: &[1.0; BALL], f: &weights };
        solve(self, y, &scales, &self.ball.options(), newton)
    }
}

impl Traction {
    /// Solves for the steady motion of the ball.
    ///
    /// The root is searched with a coarse quadrature, which decides whether there is one, and refined
    /// with that of the accuracy.
    pub fn solve(&self, work: &mut TractionWorkspace) -> Solution {
        let found = self.at.point.require_friction().and_then(|()| {
            let contacts = self.at.scaled()?;
            let rolling_ball = RollingBall::of(&contacts, None, &mut work.statics);
            let start = Start::new(&contacts, rolling_ball.ok().as_ref())?;
            Ok(self.found(&start, None, work).map_err(NotFound::why)?.solved)
        });
        Solution::new(Model::Traction, found)
    }

    /// Solves with finer and finer quadratures until the error that they state for the efficiency, with
    /// that of the creep speed, is at most `tolerance`; returns the root, its accuracy and the error.
    ///
    /// Where a finer one has no root, the last one that has is returned, with the whole loss as its error; where the
    /// coarse one loses a root that the search has found, a finer one may hold it.
    pub(crate) fn solve_to(
        &self,
        start: &Start<'_>,
        tolerance: f64,
        work: &mut TractionWorkspace,
    ) -> Result<(SlipResult, f64, f64), Unsolved> {
        let bound = |found: &SlipResult| {
            integrated_error(found.error, found.solved.transmission.efficiency, found.by_creep)
        };
        let [first, finer @ ..] = Self::ACCURACIES;
        let mut case = Self { accuracy: first, ..*self };
        let mut found = case.found(start, None, work);
        for accuracy in finer {
            let from = match &found {
                Ok(found) if bound(found) <= tolerance => break,
                Ok(found) => found.root,
                Err(NotFound { near: Some(root), .. }) => **root,
                Err(_) => break,
            };
            let finer = Self { accuracy, ..case };
            match (finer.found(start, Some(&from), work), &mut found) {
                (Ok(mut next), former) => {
                    let before = former.as_ref().ok().and_then(|former| former.solved.info);
                    if let (Some(info), Some(before)) = (&mut next.solved.info, before) {
                        info.steps += before.steps;
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
        let found = found.map_err(NotFound::why)?;
        let error = bound(&found);
        Ok((found, case.accuracy, error))
    }

    /// The root and its answer, from the root of another accuracy if there is one.
    fn found(
        &self,
        Start { contacts, rolling_ball }: &Start<'_>,
        from: Option<&SlipRoot>,
        work: &mut TractionWorkspace,
    ) -> Result<SlipResult, NotFound> {
        let TractionWorkspace { newton, rules, .. } = work;
        let rules = rules.dry([COARSE, SEARCH, Self::ACCURACY, self.accuracy]);
        let creep = self.creep * contacts.slip_scale();
        let [coarse, search, smooth, ball] =
            rules.map(|[rule, _]| SlipBall::of_contacts(contacts, rule, creep));
        let (coarse, ball) =
            (SlipBall { enough: NEAR, ..coarse }, SlipBall { enough: ROOT, ..ball });
        let [.., [_, check]] = rules;
        let plans = Default::default();
        let mut steps = 0;
        let near = if let Some(root) = from {
            Some(*root)
        } else {
            steps += rolling_ball.steps;
            coarse.search_near(rolling_ball, newton, &mut steps)
        };
        let refined = near.and_then(|near| ball.refined(&near, &plans, newton, &mut steps));
        let refined = match (refined, from) {
            (Some(refined), _) => refined,
            (None, Some(_)) => return Err(Unsolved::LOST.into()),
            (None, None) => {
                let mut near = search.search(rolling_ball, newton, &mut steps);
                if near.as_ref().is_err_and(|none| none.status() == Status::NotConverged) {
                    // The steps of its sums may be what a path was lost over.
                    near = smooth.search(rolling_ball, newton, &mut steps);
                }
                let near = near?;
                let lost = || NotFound { near: Some(Box::new(near)), why: Unsolved::LOST };
                let plans = Default::default();
                ball.refined(&near, &plans, newton, &mut steps).ok_or_else(lost)?
            }
        };
        let RootWithPower { root, transmitted, torque_slope, loaded } = refined;
        let PowerFlow { torque, power, sliding } = transmitted;
        let pulls = [NUT_LOAD, SCREW_LOAD].map(|load| contacts.friction * root.unknowns[load]);
        let by_creep = creep_effect(creep, pulls, sliding.map(f64::abs));
        let ball = ball.of(&root);
        let to_nut = ball.motion_to_nut(&root.unknowns, &loaded);
        let steady = self.at.ball_state(contacts, &loaded, &to_nut)?;
        let transmission = self.at.transmission_at(torque, power)?;
        let checked = SlipBall { quadrature: check, ..ball };
        let other = checked.evaluated::<false>(&root.unknowns).ok();
        let (other, efficiency) = (other.as_ref(), transmission.efficiency);
        let error = checked.error(self.accuracy, other, &torque_slope, efficiency, newton);
        let solved = Solved {
            skid: Some(rolling_ball.skid(contacts)),
            info: Some(SolveInfo { steps, residual: root.residual }),
            error: Some(ErrorBound::of(contacts.direction, efficiency, error)),
            ..Solved::new(&steady, transmission)
        };
        Ok(SlipResult { solved, root, error, by_creep })
    }
}

/// A point and the rolling ball that it starts from: what does not depend on the quadrature.
pub(crate) struct Start<'a> {
    contacts: &'a ElasticContacts,
    rolling_ball: RollingBall,
}

impl<'a> Start<'a> {
    /// From a rolling ball, or from a guess where there is none.
    pub(crate) fn new(
        contacts: &'a ElasticContacts,
        rolling_ball: Option<&RollingBall>,
    ) -> Result<Self, Unsolved> {
        // Centrifugal forces may be beyond a guess; the ball without them is one too.
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

/// A root and its answer.
pub(crate) struct SlipResult {
    pub(crate) solved: Solved,
    pub(crate) root: SlipRoot,
    /// What the quadrature may leave in the efficiency (T25).
    error: f64,
    /// What the creep speed may leave in the friction power, relative (A8).
    by_creep: f64,
}

/// Why a point has no root of an accuracy.
#[derive(Debug)]
struct NotFound {
    why: Unsolved,
    /// The root of the search that this accuracy has lost.
    near: Option<Box<SlipRoot>>,
}

impl NotFound {
    fn why(self) -> Unsolved {
        self.why
    }
}

impl From<Unsolved> for NotFound {
    fn from(why: Unsolved) -> Self {
        Self { why, near: None }
    }
}

#[cfg(test)]
mod tests;
