//! Continuation of a root from zero inertia to the actual inertia, along the branch that begins at
//! zero inertia.
//!
//! Theory: `docs/theory/04-rigid.md`, section on continuation in inertia, equations (R51) to (R54).

use std::array::from_fn;

use bsm_kin::{Jet, Over};
use bsm_newton::{
    CurveEquations, EvalError, JacobianUpdate, PathEnd, Seed, StepControl, Trace, trace,
};

use super::ball::{RigidBall, RigidCoordinates, RigidMotion};
use super::equations::{MIN_INERTIA, RigidEquations, Unknowns};
use super::first_order::FirstOrder;
use crate::cost::{self, count_search};
use crate::models::ball::unknown::{
    NUT_LOAD, PRECESSION, SCREW_LOAD, SLIP, SLIP_ANGLE, SPIN, UNLOADED_FLANK_LOAD,
};
use crate::models::ball::{BALL_UNKNOWNS, linear};

/// Number of unknowns at a point of the branch (R51).
const BRANCH_UNKNOWNS: usize = BALL_UNKNOWNS + 1;

/// Index of the unknown `$\ln\mu_B$`, which replaces the load at contact B.
const LOG_INERTIA: usize = SCREW_LOAD;

/// Index of the unknown `$\operatorname{arsinh}(V'/v_0)$`, which replaces the spin moment.
const UNLOADED_SLIP: usize = SPIN;

/// Index of the additional unknown `$a$`, the ratio of the axial load per ball to the load at
/// contact B.
const AXIAL: usize = BALL_UNKNOWNS;

/// Unit `$v_0$` of the slips in the unknowns, divided by `$r_b |W|$`. If a slip is much larger than
/// `$v_0$`, its unknown is practically the logarithm of the slip.
const SLIP_UNIT: f64 = 1e-12;

/// Minimum ratio of the first-order slip at contact A to the slip `$e_1 p$` of a ball that rolls at
/// contact B (dimensionless). Above this ratio, the slip at A does not change its sign near the
/// beginning of the branch, so the logarithm of the slip can be used as an unknown.
const MIN_CLEAR_SLIP: f64 = 0.01;

/// Ratio of centrifugal force to friction force (dimensionless) at which the branch begins.
/// Newton's method converges from the first-order solution to the branch at all but one of 1084
/// extreme points (with a ratio of 0.01, at all but nine). With a smaller ratio, the load at the
/// unloaded flank would be lost in rounding errors if the ball orbits very slowly.
const START: f64 = 1e-4;

/// Maximum ratio of inertia force to friction force (dimensionless) at which the branch begins. The
/// relative error of the first-order solution is one fifth of this ratio.
const MAX_START: f64 = 0.01;

/// Maximum ratio of the inertia at the beginning of the branch to the actual inertia
/// (dimensionless). This limit ensures that the branch begins before the root.
const MAX_START_PART: f64 = 0.1;

/// Maximum logarithm of the ratio of the inertia on the branch to the actual inertia. The
/// continuation stops at this ratio, because no known branch returns from larger inertia to the
/// actual inertia.
const MAX_LOG_EXCESS: f64 = 3.0;

/// Minimum slip at the contacts A' and B, divided by `$r_b |P - \Omega_n|$`, on the branch. Below
/// this slip, the branch ends because the slip would reverse. At roots of nut drives with large
/// inertia, the slips are 1e-5 or less.
const MIN_SLIP: f64 = 1e-8;

/// Maximum slip at the contact A' or B, divided by `$r_b |P - \Omega_n|$`, at which a failed step
/// counts as the end of the branch. At such small slips, the direction of friction changes too fast
/// for any step.
const MAX_END_SLIP: f64 = 1e-3;

/// Minimum ratio of nut speed to relative speed (dimensionless) at which the rate `$p$` is used as
/// the precession unknown. Below this ratio, cancellation may occur in the sum `$p + \Omega_n/W$`;
/// above this ratio, it may occur in the difference `$P/W - \Omega_n/W$`.
const FAST_NUT_RATIO: f64 = 10.0;

/// Maximum step length along the branch, in units of the scales of the unknowns.
pub(super) const MAX_BRANCH_STEP: f64 = 4.0;

/// Step control along the branch. Step lengths are in units of the scales of the unknowns.
const STEPS: StepControl = StepControl {
    first_step: 1.0,
    max_step: MAX_BRANCH_STEP,
    min_step: 1e-6,
    pair_resolution: 1e-3,
    max_points: 400,
    residual_goal: 1e-9,
    root_tolerance: 1e-6,
    jacobian: JacobianUpdate::EveryTrial { chord_below: 1e-3 },
};

/// The equations of a ball with variable inertia. Forces are divided by `$m r_m W^2$`.
struct Branch<'a> {
    /// The ball at its operating point, with its actual inertia.
    ball: &'a RigidBall<f64>,
    /// The equations of the ball with an inertia ratio of one.
    unit: RigidEquations<f64>,
    /// Unit `$v_0$` of the slip at contact A.
    slip_unit: f64,
}

/// Result of following a branch of roots.
pub(super) struct BranchRoots {
    /// Admissible motions at the actual inertia, in their order along the branch.
    pub(super) motions: Vec<RigidMotion<f64>>,
    /// Inertia ratio on the branch that is nearest to the actual inertia ratio and has an
    /// admissible motion.
    pub(super) nearest_inertia: Option<f64>,
    /// True if the branch was followed to its end or far enough beyond the actual inertia, or if
    /// the motion at the beginning of the branch is not admissible.
    pub(super) is_complete: bool,
}

impl CurveEquations<BALL_UNKNOWNS, BRANCH_UNKNOWNS> for Branch<'_> {
    fn residual(&self, z: &[f64; BRANCH_UNKNOWNS]) -> Result<[f64; BALL_UNKNOWNS], EvalError> {
        self.residual_at(z)
    }

    fn linearize(
        &self,
        z: &[f64; BRANCH_UNKNOWNS],
    ) -> Result<([f64; BALL_UNKNOWNS], [[f64; BRANCH_UNKNOWNS]; BALL_UNKNOWNS]), EvalError> {
        linear(z, |z: &[Jet<BRANCH_UNKNOWNS>; BRANCH_UNKNOWNS]| self.residual_at(z))
    }

    fn weights(&self, z: &[f64; BRANCH_UNKNOWNS]) -> [f64; BALL_UNKNOWNS] {
        let motion = self.unit.motion(&self.unknowns(z));
        motion.map_or([1.0; BALL_UNKNOWNS], |motion| {
            self.unit.ball.own_weights(&motion, (-z[LOG_INERTIA]).exp())
        })
    }

    fn sizes(&self, z: &[f64; BRANCH_UNKNOWNS]) -> [f64; BRANCH_UNKNOWNS] {
        let ball = &self.unit.ball;
        let [p, rate] = self.unit.rates(z[PRECESSION]);
        let mut sizes = [1.0; BRANCH_UNKNOWNS];
        sizes[UNLOADED_FLANK_LOAD] = rate * rate + z[UNLOADED_FLANK_LOAD].abs();
        // With increasing inertia, either the ball stops orbiting or it comes to rest relative to
        // the nut. Accordingly, either the absolute precession rate or the precession rate relative
        // to the nut approaches zero.
        sizes[PRECESSION] = p.abs().min(rate.abs());
        sizes[AXIAL] = ball.k_n + z[AXIAL].abs();
        sizes
    }
}

/// Returns the hyperbolic sine.
fn sinh<D: Over<f64>>(x: D) -> D {
    let exp = x.exp();
    (exp - exp.recip()) * 0.5
}

impl<'a> Branch<'a> {
    /// Creates the branch equations of a ball.
    fn of(ball: &'a RigidBall<f64>, first: &FirstOrder) -> Self {
        let uses_absolute_rate = ball.nut_speed.abs() < FAST_NUT_RATIO;
        let unit = ball.with_inertia(ball.inertia_ratio.recip());
        // The variable `rolling` is the slip e₁ p of (R27).
        let rolling = ball.sines.sin_a * ball.arc * ball.per_h * first.precession.abs();
        let slip_unit = if first.slip > MIN_CLEAR_SLIP * rolling { SLIP_UNIT } else { rolling };
        Self { ball, unit: RigidEquations { ball: unit, uses_absolute_rate }, slip_unit }
    }

    /// Returns the unknowns (R2) at a point of the branch. Forces are divided by `$m r_m W^2$`.
    fn unknowns<D: Over<f64>>(&self, z: &[D; BRANCH_UNKNOWNS]) -> Unknowns<D> {
        let ball = &self.unit.ball;
        let [p, rate] = self.unit.rates(z[PRECESSION]);
        // Q_B/(m r_m W²) = 1/μ_B                                          (R51)
        let load = (-z[LOG_INERTIA]).exp();
        let (slip, unloaded_slip) =
            (sinh(z[SLIP]) * self.slip_unit, sinh(z[UNLOADED_SLIP]) * SLIP_UNIT);
        // s = I (P/W) [V' − p d/r_b − τ cos2β]/sin2β                      (R54)
        let tau = slip * z[SLIP_ANGLE].sin() - p * ball.arc;
        let spin = (unloaded_slip - p * ball.arc - tau * ball.cos_2b) * ball.sin_2b.recip();
        let mut y = Unknowns::from_fn(|i, _| z[i]);
        (y[NUT_LOAD], y[SCREW_LOAD]) = (sinh(z[NUT_LOAD]) * load, load);
        (y[SLIP], y[SPIN]) = (slip, rate * spin * ball.inertia);
        y
    }

    /// Returns the residuals (R52) at a point of the branch.
    ///
    /// # Errors
    ///
    /// Returns [`EvalError`] if the direction of friction or of the gyroscopic moment is undefined.
    fn residual_at<D: Over<f64>>(
        &self,
        z: &[D; BRANCH_UNKNOWNS],
    ) -> Result<[D; BALL_UNKNOWNS], EvalError> {
        cost::count_evaluation();
        let motion = self.unit.motion(&self.unknowns(z));
        let motion = motion.as_ref().map_err(|error| *error)?;
        // F_nut·k − a Q_B = 0                                             (R52)
        Ok(self.unit.ball.residual_under(motion, z[AXIAL] * (-z[LOG_INERTIA]).exp()))
    }

    /// Returns the beginning of the branch, which is calculated from the first-order solution.
    fn start(&self, first: &FirstOrder) -> [f64; BRANCH_UNKNOWNS] {
        let ball = self.ball;
        let square = first.rate * first.rate;
        let axial = ball.axial_load_ratio();
        let ratio = (START / square)
            .clamp(START, MAX_START)
            .min(MAX_START_PART * first.inertia_scale / ball.friction())
            .max(MIN_INERTIA);
        let inertia = ratio * ball.friction() / square.max(1.0) * axial.abs();
        // The spin moment s of (R20), divided by Q_B, is converted to a spin divided by W.
        let spin =
            -2.0 * ball.signed * ball.per_h / (inertia * first.rate * self.unit.ball.inertia);
        let tau = first.slip * ball.sin_psi - first.precession * ball.arc;
        let unloaded_slip = first.precession * ball.arc + tau * ball.cos_2b + spin * ball.sin_2b;
        let mut z = [0.0; BRANCH_UNKNOWNS];
        (z[NUT_LOAD], z[UNLOADED_FLANK_LOAD]) = (1.0_f64.asinh(), first.unloaded * square);
        (z[LOG_INERTIA], z[AXIAL]) = (inertia.ln(), axial);
        z[PRECESSION] = if self.unit.uses_absolute_rate { first.rate } else { first.precession };
        z[SLIP] = (first.slip / self.slip_unit).asinh();
        z[SLIP_ANGLE] = ball.sin_psi.atan2(ball.cos_psi);
        z[UNLOADED_SLIP] = (unloaded_slip / SLIP_UNIT).asinh();
        z
    }

    /// Returns the difference between the inertia at a point of the branch and the actual inertia,
    /// scaled to the range from -1 to 1. The second value is the derivative of this difference
    /// along the direction `way`.
    fn excess(&self, z: &[f64; BRANCH_UNKNOWNS], way: &[f64; BRANCH_UNKNOWNS]) -> (f64, f64) {
        let per_load = self.ball.inertia_ratio * (-z[LOG_INERTIA]).exp();
        // x = μ a/μ_B,  g = (1 − x)/(1 + |x|)                             (R53)
        let x = per_load * z[AXIAL];
        if x <= 0.0 {
            return (1.0, 0.0);
        }
        let slope = per_load * (way[AXIAL] - z[AXIAL] * way[LOG_INERTIA]);
        ((1.0 - x) / (1.0 + x), -2.0 * slope / (1.0 + x).powi(2))
    }

    /// Returns the motion at a point of the branch. Forces are divided by `$m r_m W^2$`.
    fn motion(&self, z: &[f64; BRANCH_UNKNOWNS]) -> Option<RigidMotion<f64>> {
        self.unit.motion(&self.unknowns(z)).ok()
    }

    /// Returns the motion at a root in the scaled units of the ball.
    fn at_root(&self, z: &[f64; BRANCH_UNKNOWNS]) -> Option<RigidMotion<f64>> {
        let RigidMotion { loads, speeds, directions, precession, rate, spin_moment, .. } =
            self.motion(z)?;
        let load = self.ball.inertia_ratio;
        Some(self.ball.motion(RigidCoordinates {
            loads: loads.map(|q| q * load),
            precession,
            rate,
            slip: speeds[0],
            slip_direction: directions[0],
            spin_moment: spin_moment * load,
        }))
    }
}

/// Returns the smaller of the slips at the contacts A' and B, divided by `$r_b |P - \Omega_n|$`.
fn least_slip(motion: &RigidMotion<f64>) -> f64 {
    motion.speeds[1].min(motion.speeds[2]) / motion.precession.abs()
}

impl RigidBall<f64> {
    /// Returns true if, in the first-order solution, the slip at contact B is opposite to the
    /// friction at this contact. Otherwise, no branch begins at zero inertia.
    fn has_branch(&self, first: &FirstOrder) -> bool {
        // −V_B/(W r_b) = λ A + (sinα, d (1 − 2p) − cosα cosβ), projected onto ψ  (R26)
        let along = self.arc * (1.0 - 2.0 * first.precession) - self.k_e;
        first.slip + self.sines.sin_a * self.cos_psi + along * self.sin_psi > 0.0
    }

    /// Follows the branch of roots that begins at zero inertia.
    pub(super) fn follow_branch(&self, first: &FirstOrder) -> BranchRoots {
        if !self.has_branch(first) {
            return BranchRoots { motions: Vec::new(), nearest_inertia: None, is_complete: true };
        }
        count_search();
        let branch = Branch::of(self, first);
        let log = self.inertia_ratio.ln();
        let (mut motions, mut known) = (Vec::new(), 0);
        let (mut nearest, mut was_admissible) = (None::<(f64, f64)>, first.root_exists());
        let towards = from_fn(|i| if i == LOG_INERTIA { 1.0 } else { 0.0 });
        let Trace { end, last, .. } = trace(
            &branch,
            &Seed { z: branch.start(first), towards },
            |z, way| [branch.excess(z, way)],
            |Trace { crossings, last: z, .. }| {
                let found = crossings[known..].iter().filter_map(|at| branch.at_root(&at.z));
                motions.extend(found.filter(RigidMotion::is_admissible));
                known = crossings.len();
                let motion = branch.motion(z).filter(RigidMotion::is_admissible);
                let admissible = z[AXIAL] > 0.0 && motion.is_some();
                if admissible {
                    let log_inertia = z[LOG_INERTIA] - z[AXIAL].ln();
                    let distance = (log_inertia - log).abs();
                    if nearest.is_none_or(|(least, _)| distance < least) {
                        nearest = Some((distance, log_inertia.exp()));
                    }
                }
                // The branch ends where the ball would roll, a contact load would become negative,
                // or a slip would reverse. If the branch begins beyond the point at which the ball
                // rolls, the first point of the branch at the actual inertia decides whether a root
                // exists.
                let slides = motion.is_some_and(|motion| least_slip(&motion) > MIN_SLIP);
                let has_ended = if was_admissible {
                    !(admissible && slides)
                } else {
                    known > 0 && motions.is_empty()
                };
                was_admissible |= admissible;
                !has_ended && z[LOG_INERTIA] < log + (1.0 + z[AXIAL].abs()).ln() + MAX_LOG_EXCESS
            },
            &STEPS,
        );
        let reverses = || branch.motion(&last).is_some_and(|end| least_slip(&end) < MAX_END_SLIP);
        let has_ended = end == PathEnd::Ended || (end == PathEnd::Lost && reverses());
        BranchRoots {
            motions,
            nearest_inertia: nearest.map(|(_, inertia)| inertia),
            is_complete: has_ended || !was_admissible,
        }
    }
}
