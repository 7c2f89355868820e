//! Search for a root at an operating point by direct sweeps and by continuation. If no root exists,
//! the search determines the reason.
//!
//! Theory: `docs/theory/04-rigid.md`, sections on existence, direct sweeps and continuation in
//! inertia.

use std::iter::successors;

use bsm_newton::{Bracket, Convergence, Options, Scales, solve};

use super::ball::{RigidBall, RigidMotion};
use super::branch::{BranchRoots, MAX_BRANCH_STEP};
use super::equations::RigidEquations;
use super::first_order::FirstOrder;
use super::fixed_point::FixedPoint;
use crate::cost::count_of;
use crate::models::ball::{BALL_UNKNOWNS, Evidence, Reason, SolveFailure, Workspace};

/// Maximum ratio of inertia force to friction force (dimensionless) at which the first-order
/// solution may exclude a root.
const SMALL_INERTIA: f64 = 0.01;

/// Relative error of the first-order existence criterion, divided by the ratio of inertia force to
/// friction force (dimensionless).
const FIRST_ORDER_ERROR: f64 = 0.2;

/// Maximum number of Newton steps that refine a root. If more steps were necessary, the starting
/// value would not be near the root.
const MAX_REFINEMENT_STEPS: usize = 8;

/// Maximum relative difference between the loads of two roots that count as the same root.
const SAME_ROOT_TOL: f64 = 1e-6;

/// A root of the equations of the rigid model for one ball.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BallRoot {
    pub(crate) motion: RigidMotion<f64>,
    /// Number of sweeps of the fixed-point iteration, or number of Newton steps if the root was
    /// found by continuation and then refined.
    pub(crate) steps: usize,
    pub(crate) residual: f64,
    /// Other admissible roots on the branch; `None` if the branch was not followed to its end.
    pub(crate) alternatives: Option<Vec<BallRoot>>,
}

impl BallRoot {
    /// Returns true if two roots are equal except for rounding errors.
    pub(super) fn is_near(&self, other: &Self) -> bool {
        let loads = self.motion.loads.iter().zip(&other.motion.loads);
        loads.into_iter().all(|(x, y)| (x - y).abs() <= SAME_ROOT_TOL * x.abs().max(y.abs()))
    }
}

/// Reusable buffers for solving rigid models.
#[derive(Default)]
pub struct RigidWorkspace(pub(super) Workspace);

/// Finds the root on the branch that begins at zero inertia.
///
/// # Errors
///
/// Returns [`SolveFailure`] with the reason why the branch has no root at the actual inertia, or
/// why the search failed.
pub(crate) fn find(
    ball: &RigidBall<f64>,
    work: &mut RigidWorkspace,
) -> Result<BallRoot, SolveFailure> {
    let first = ball.first_order();
    if let Some(failure) = excluded_by_first_order(ball, &first) {
        return Err(failure);
    }

    // The first attempt uses sweeps from the first-order solution. If the sweeps converge, they
    // have found a root on the branch.
    let swept = ball.fixed_point(&first);
    if swept.is_root() {
        let alternatives = first.is_unique.then(Vec::new);
        let (steps, residual) = (count_of(swept.count), swept.residual);
        return Ok(BallRoot { motion: swept.motion, steps, residual, alternatives });
    }
    // If the sweeps converge to an inadmissible motion, the branch is inadmissible at the actual
    // inertia. If a second root is excluded, it is sufficient that the friction directions of the
    // sweeps become stationary at an inadmissible motion.
    if swept.converged || (swept.stationary && first.is_unique) {
        let reason = inadmissible(&swept);
        return Err(unless_first_order_contradicts(
            ball,
            &first,
            SolveFailure::no_solution(Evidence::Bound, reason),
        ));
    }

    // The second attempt follows the branch from the first-order solution to the actual inertia.
    let branch = ball.follow_branch(&first);
    if let Some(found) = first_root_on(ball, &branch, work) {
        return found;
    }

    // If the branch was followed completely, there is no root. Otherwise, the continuation failed.
    if !branch.is_complete {
        return Err(SolveFailure::SEARCH_FAILED);
    }
    let evidence = Evidence::Traced { resolution: MAX_BRANCH_STEP };
    let reason = no_root_reason(ball, &first, branch.nearest_inertia);
    Err(unless_first_order_contradicts(ball, &first, SolveFailure::no_solution(evidence, reason)))
}

/// Finds all roots on the branch at the actual inertia and returns the first root with the other
/// roots as alternatives.
///
/// # Errors
/// Returns an error if [`find`] fails.
pub(super) fn find_all(
    ball: &RigidBall<f64>,
    work: &mut RigidWorkspace,
) -> Result<BallRoot, SolveFailure> {
    let root = find(ball, work)?;
    if root.alternatives.is_some() {
        return Ok(root);
    }
    let branch = ball.follow_branch(&ball.first_order());
    let alternatives = match first_root_on(ball, &branch, work) {
        Some(Ok(first)) if first.is_near(&root) => first.alternatives,
        _ => None,
    };
    Ok(BallRoot { alternatives, ..root })
}

/// Returns the first root on a branch together with the other roots on this branch, or `None` if
/// the branch has no root.
fn first_root_on(
    ball: &RigidBall<f64>,
    branch: &BranchRoots,
    work: &mut RigidWorkspace,
) -> Option<Result<BallRoot, SolveFailure>> {
    let (first, others) = branch.motions.split_first()?;
    let first = match refined(ball, first, work) {
        Ok(first) if first.motion.is_admissible() => first,
        // If the refined motion is not admissible, Newton's method has converged to a different
        // root.
        Ok(_) => return Some(Err(SolveFailure::SEARCH_FAILED)),
        Err(failure) => return Some(Err(failure)),
    };
    let mut alternatives = Vec::<BallRoot>::new();
    for other in others {
        let known = |root: &BallRoot| {
            first.is_near(root) || alternatives.iter().any(|known| root.is_near(known))
        };
        match refined(ball, other, work) {
            Ok(root) if root.motion.is_admissible() && !known(&root) => alternatives.push(root),
            _ => return Some(Ok(first)),
        }
    }
    let alternatives = branch.is_complete.then_some(alternatives);
    Some(Ok(BallRoot { alternatives, ..first }))
}

/// Returns the reason why no root exists, or `None` if the first-order solution does not exclude a
/// root. The solution excludes a root only if inertia is small and if the existence criterion is
/// violated by more than the error of the solution.
///
/// The error is [`FIRST_ORDER_ERROR`] times the ratio of inertia force to friction force. The
/// constant was determined by random tests: `tests/suite/rigid_campaign.rs` checks that roots
/// differ from the first-order solution by at most 0.077 times this ratio.
fn excluded_by_first_order(ball: &RigidBall<f64>, first: &FirstOrder) -> Option<SolveFailure> {
    let inertia = first.inertia_scale / ball.friction();
    if inertia >= SMALL_INERTIA {
        return None;
    }
    let error = FIRST_ORDER_ERROR * inertia;
    let reason = if first.rate == 0.0 {
        Reason::BallDoesNotOrbit
    } else if first.load <= 0.0 {
        // The difference between `sin_contact_angle` and `friction_term` is the denominator of the
        // load formula (R17).
        let (sin_contact_angle, friction_term) = locking_terms(ball);
        if friction_term - sin_contact_angle < error * friction_term {
            return None;
        }
        self_locking(ball)
    } else if first.rate.abs() <= 2.0 * error {
        // The load ratio q_A' depends on the sign of P. If |P| is small (up to 0.13 |W| in tests),
        // inertia may reverse this sign.
        return None;
    } else if first.unloaded <= 0.0 {
        // The load ratio q_A' changes its sign through infinity, where the existence margin is -∞.
        unloaded_flank_would_pull(first)
    } else if -first.sliding_margin > margin_error(ball, first, error) {
        would_roll(first)
    } else {
        return None;
    };
    Some(SolveFailure::no_solution(Evidence::Bound, reason))
}

/// Returns the given verdict that no root exists, unless the first-order solution indicates a root
/// by a margin larger than its error. In that case, the function reports a failed search, because
/// rounding errors of large loads near self-locking can affect the sweeps and the continuation.
fn unless_first_order_contradicts(
    ball: &RigidBall<f64>,
    first: &FirstOrder,
    verdict: SolveFailure,
) -> SolveFailure {
    let loaded = first.inertia_scale / ball.friction() * first.load;
    let error = FIRST_ORDER_ERROR * loaded;
    let exists = loaded < SMALL_INERTIA
        && first.root_exists()
        && first.sliding_margin > margin_error(ball, first, error)
        && first.rate.abs() > 2.0 * error;
    if exists { SolveFailure::SEARCH_FAILED } else { verdict }
}

/// Refines a root by Newton's method with the weights (R44), which are necessary if the inertia
/// forces are large.
///
/// # Errors
///
/// Returns [`Reason::Newton`] if Newton's method does not converge.
pub(super) fn refined(
    ball: &RigidBall<f64>,
    motion: &RigidMotion<f64>,
    work: &mut RigidWorkspace,
) -> Result<BallRoot, SolveFailure> {
    let (equations, mut unknowns) = RigidEquations::at(ball, motion);
    let weights = ball.own_weights(motion, 1.0);
    let convergence = Convergence {
        // The inertia forces may exceed the load by many orders of magnitude, but the power balance
        // of the load must hold to 1e-9.
        residual_goal: f64::EPSILON,
        max_steps: MAX_REFINEMENT_STEPS,
        ..Convergence::default()
    };
    let options = Options { convergence, ..Options::default() };
    let scales = Scales { x: &[1.0; BALL_UNKNOWNS], f: &weights };
    let report = solve(&equations, &mut unknowns.data.0[0], &scales, &options, &mut work.0).report;
    if !report.converged() {
        return Err(SolveFailure::not_converged(Reason::from(report)));
    }
    let motion = equations.motion(&unknowns).expect("the residual was evaluated at the root");
    Ok(BallRoot {
        motion,
        steps: report.steps.len(),
        residual: report.residual,
        alternatives: None,
    })
}

/// Returns the reason why the final motion of the sweeps is inadmissible.
fn inadmissible(swept: &FixedPoint<f64>) -> Reason {
    let motion = &swept.motion;
    let ([nut, unloaded, screw], slip) = (motion.loads, motion.speeds[0]);
    if nut <= 0.0 || screw <= 0.0 {
        return Reason::LoadedContactWouldPull { nut_load_ratio: nut, screw_load_ratio: screw };
    }
    if unloaded <= 0.0 {
        return Reason::UnloadedFlankWouldPull { load_ratio: unloaded };
    }
    Reason::NutContactWouldRoll { slip, exact: swept.converged }
}

/// Returns the reason why a branch has no root at the actual inertia.
fn no_root_reason(ball: &RigidBall<f64>, first: &FirstOrder, nearest_ratio: Option<f64>) -> Reason {
    match nearest_ratio {
        Some(nearest_ratio) => {
            Reason::NoRootAtInertia { inertia_ratio: ball.inertia_ratio, nearest_ratio }
        }
        None if first.load <= 0.0 => self_locking(ball),
        None if first.unloaded <= 0.0 => unloaded_flank_would_pull(first),
        None => would_roll(first),
    }
}

/// Returns the error of the existence margin that is caused by a relative error of the first-order
/// solution.
fn margin_error(ball: &RigidBall<f64>, first: &FirstOrder, error: f64) -> f64 {
    error * first.precession.abs() * ball.sines.tan_a()
}

/// Returns both sides of Equation 16 of Lin et al., the condition for self-locking.
fn locking_terms(ball: &RigidBall<f64>) -> (f64, f64) {
    (ball.sines.sin_b, ball.friction() * ball.sines.slip_factor())
}

/// Creates [`Reason::SelfLocking`] with both sides of Equation 16 of Lin et al.
fn self_locking(ball: &RigidBall<f64>) -> Reason {
    let (sin_contact_angle, friction_term) = locking_terms(ball);
    Reason::SelfLocking { sin_contact_angle, friction_term }
}

/// Creates [`Reason::UnloadedFlankWouldPull`] for a contact on the unloaded flank that would act in
/// tension.
fn unloaded_flank_would_pull(first: &FirstOrder) -> Reason {
    Reason::UnloadedFlankWouldPull { load_ratio: first.unloaded * first.inertia }
}

/// Creates [`Reason::NutContactWouldRoll`] for a ball that rolls on the nut.
fn would_roll(first: &FirstOrder) -> Reason {
    Reason::NutContactWouldRoll { slip: first.slip, exact: false }
}

/// Searches upward from the lead angle of the operating point, and returns the lead angle \[rad\]
/// at which the slip at contact A (loaded flank of the nut) is no longer negative (R11).
///
/// The slip is taken from the result of the sweeps, which continue the equations beyond rolling.
/// The function returns `None` if the operating point itself has a root, if the first-order
/// solution has no root up to 80 degrees, or if the sweeps do not become stationary.
pub(crate) fn critical_lead_angle(ball: &RigidBall<f64>) -> Option<f64> {
    /// Step of the lead angle with which the first-order solution is evaluated \[rad\].
    const STEP: f64 = 0.02;
    /// Maximum lead angle that the search considers \[rad\].
    const MAX_LEAD_ANGLE: f64 = 1.4;

    let at = |lead_angle: f64| ball.with_lead_angle(lead_angle);
    // λ(α) = 0                                                            (R11)
    let slip = |lead_angle: f64| slip_at_nut(&at(lead_angle));
    let lead_angle = ball.sines.sin_a.atan2(ball.sines.cos_a);
    let above = successors(Some(lead_angle), |lead_angle| Some(lead_angle + STEP));
    let slides =
        above.take_while(|lead_angle| *lead_angle <= MAX_LEAD_ANGLE).find(|lead_angle| {
            at(*lead_angle).first_order().root_exists() && slip(*lead_angle) > 0.0
        })?;
    let ends = [lead_angle, slides];
    let bracket = Bracket { x_tol: 1e-9, ..Bracket::new(ends, ends.map(slip)) };
    bracket.root(slip).root().map(|root| root.x)
}

/// Returns the slip at contact A (loaded flank of the nut), divided by `$r_b|W|$`, at the end of
/// the sweeps. The result is minus infinity if a contact load would be negative in the first-order
/// solution, and NaN if the sweeps do not become stationary.
fn slip_at_nut(ball: &RigidBall<f64>) -> f64 {
    let first = ball.first_order();
    if !first.has_compressive_loads() {
        return f64::NEG_INFINITY;
    }
    let swept = ball.fixed_point(&first);
    if swept.stationary { swept.motion.speeds[0] } else { f64::NAN }
}
