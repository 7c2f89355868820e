//! Continuation that increases the inertia forces, for operating points at which Newton's method
//! does not converge directly.
//!
//! Theory: `docs/theory/09-traction.md`, equations (T6) to (T8).

use std::array::from_fn;
use std::f64::consts::FRAC_PI_2;

use bsm_newton::{
    Continuation, CurveEquations, EvalError, EventRoot, JacobianUpdate, PathEnd, Seed, StepControl,
    Trace, follow, trace,
};

use super::equations::SlipBall;
use super::root::{SlipRoot, are_on_flanks};
use crate::cost::count_search;
use crate::ellipse::Integrate;
use crate::models::ball::unknown::PRECESSION;
use crate::models::ball::{BALL_UNKNOWNS, Workspace, linear};
use crate::models::raceway_control::RollingBall;

/// Number of unknowns of a path: seven unknowns of the ball plus the path parameter.
const PATH_UNKNOWNS: usize = BALL_UNKNOWNS + 1;

/// Maximum friction coefficient at the start of a path. With such small friction, the contact
/// angles hardly differ from the contact angles without friction.
const SMALL_FRICTION: f64 = 1e-3;

/// Step control for following paths. A step of length 1 changes the quantity that varies along the
/// path by about a factor of e. Points on a path need only eight digits, because they are starting
/// values for roots. Few paths have more than a hundred points.
pub(super) const STEP_CONTROL: StepControl = StepControl {
    first_step: 0.5,
    max_step: 1.0,
    min_step: 1e-7,
    pair_resolution: 1e-3,
    max_points: 1000,
    residual_goal: 1e-8,
    root_tolerance: 1e-4,
    jacobian: JacobianUpdate::EveryStep,
};

/// Direction in the space of the path unknowns in which only the path parameter increases.
const INCREASING: [f64; PATH_UNKNOWNS] = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];

/// Angle \[rad\] by which a contact angle may exceed the limit of its flank and still count as
/// being on the flank. The tolerance allows for rounding errors under large loads.
const FLANK_ANGLE_TOL: f64 = 1e-6;

/// Result of following a path of increasing inertia forces.
pub(super) enum PathResult {
    /// A root with both contacts on their flanks was found on the path. The power balance of this
    /// root is not checked.
    SlipRoot(SlipRoot),
    /// All roots on the path have contact angles beyond the flanks, or the ball leaves its flanks
    /// along the path. The angles are the contact angles at the first root or at the end of the
    /// path.
    OffFlank([f64; 2]),
    /// Path tracking failed before the end of the path.
    Lost,
}

/// A path of increasing inertia forces that begins at a ball without inertia.
struct InertiaPath {
    /// Roots for which both contacts are on their flanks, in the order in which they occur along
    /// the path.
    roots: Vec<SlipRoot>,
    /// Contact angles at the first root at which a contact is beyond its flank.
    off_flank: Option<[f64; 2]>,
    /// Unknowns at the last point of the path.
    end: [f64; BALL_UNKNOWNS],
    /// True if the path was followed to its end or was deliberately stopped at a root.
    is_complete: bool,
}

/// Quantity that varies along a path.
#[derive(Debug, Clone, Copy)]
enum PathParameter {
    /// Friction coefficient of a ball without inertia.
    Friction,
    /// Precession rate from which the inertia forces are calculated: `unit` times sinh u (T7).
    Rate { unit: f64 },
}

impl PathParameter {
    /// Returns the friction coefficient and the precession rate for the path parameter `u`, each
    /// with its derivative with respect to `u`.
    fn at(self, friction: f64, u: f64) -> [(f64, f64); 2] {
        match self {
            // f = eᵘ                                                      (T6)
            Self::Friction => [(u.exp(), u.exp()), (0.0, 0.0)],
            // P̂ = P₀ sinh u                                               (T7)
            Self::Rate { unit } => [(friction, 0.0), (unit * u.sinh(), unit * u.cosh())],
        }
    }
}

/// The equations of one ball, with the path parameter as an additional unknown.
struct PathEquations<'a> {
    ball: &'a SlipBall<'a>,
    along: PathParameter,
}

impl PathEquations<'_> {
    fn residual_of<D: Integrate<f64>>(
        &self,
        z: &[D; PATH_UNKNOWNS],
    ) -> Result<[D; BALL_UNKNOWNS], EvalError> {
        let (Self { ball, along }, y) = (self, from_fn(|i| z[i]));
        let du = z[BALL_UNKNOWNS] - z[BALL_UNKNOWNS].re();
        let [friction, rate] = along
            .at(ball.contacts.friction, z[BALL_UNKNOWNS].re())
            .map(|(value, slope)| du * slope + value);
        Ok(ball.evaluated_at(&y, friction, rate)?.residual)
    }
}

impl CurveEquations<BALL_UNKNOWNS, PATH_UNKNOWNS> for PathEquations<'_> {
    fn residual(&self, z: &[f64; PATH_UNKNOWNS]) -> Result<[f64; BALL_UNKNOWNS], EvalError> {
        self.residual_of(z)
    }

    fn linearize(
        &self,
        z: &[f64; PATH_UNKNOWNS],
    ) -> Result<([f64; BALL_UNKNOWNS], [[f64; PATH_UNKNOWNS]; BALL_UNKNOWNS]), EvalError> {
        linear(z, |z| self.residual_of(z))
    }

    fn weights(&self, z: &[f64; PATH_UNKNOWNS]) -> [f64; BALL_UNKNOWNS] {
        let [(friction, _), (rate, _)] =
            self.along.at(self.ball.contacts.friction, z[BALL_UNKNOWNS]);
        self.ball.weights_of(&ball(z), friction, rate)
    }
}

/// Returns the unknowns of the ball at a point of a path.
fn ball(z: &[f64; PATH_UNKNOWNS]) -> [f64; BALL_UNKNOWNS] {
    from_fn(|i| z[i])
}

/// Creates the starting point of a path from the unknowns `y` of the ball and the path parameter
/// `u`.
fn seed(y: &[f64; BALL_UNKNOWNS], u: f64) -> Seed<PATH_UNKNOWNS> {
    Seed { z: from_fn(|i| if i < BALL_UNKNOWNS { y[i] } else { u }), towards: INCREASING }
}

impl SlipBall<'_> {
    /// Returns the contact angles at the nut and the screw \[rad\], which are NaN if a contact is
    /// lost.
    pub(super) fn angles(&self, y: &[f64; BALL_UNKNOWNS]) -> [f64; 2] {
        self.loaded(y).map_or([f64::NAN; 2], |loaded| loaded.angles)
    }

    /// Returns true if a contact angle is more than `margin` \[rad\] beyond its flank.
    pub(super) fn is_off_flank(&self, y: &[f64; BALL_UNKNOWNS], margin: f64) -> bool {
        !are_on_flanks(self.angles(y), margin)
    }

    /// Returns true if a contact angle is more than π/2 beyond its flank. It is then unlikely that
    /// the path returns to the flanks.
    fn is_far(&self, z: &[f64; PATH_UNKNOWNS]) -> bool {
        self.is_off_flank(&ball(z), FRAC_PI_2)
    }

    /// Follows the path of increasing inertia forces to the first root with both contacts on their
    /// flanks.
    pub(super) fn followed(&self, newton: &mut Workspace, steps: &mut usize) -> PathResult {
        count_search();
        let at_rest = match self.without_inertia(newton, steps) {
            Ok(at_rest) => at_rest,
            Err(failure) => return failure,
        };
        let is_balanced = |root: &SlipRoot| self.is_balanced(root);
        let forward = self.beginning_at_rest(&at_rest, 1.0, is_balanced, newton, steps);
        if forward.roots.last().is_some_and(is_balanced) {
            return self.outcome_of(&forward);
        }
        let backward = self.beginning_at_rest(&at_rest, -1.0, is_balanced, newton, steps);
        self.outcome_of(if backward.roots.is_empty() { &forward } else { &backward })
    }

    /// Returns all roots on the path of increasing inertia forces at which both contacts are on
    /// their flanks, or `None` if path tracking fails. The first root is the root that
    /// [`followed`](Self::followed) returns.
    pub(super) fn all_roots(&self, newton: &mut Workspace) -> Option<Vec<SlipRoot>> {
        let steps = &mut 0;
        let at_rest = self.without_inertia(newton, steps).ok()?;
        let mut roots = Vec::new();
        for sense in [1.0, -1.0] {
            let path = self.beginning_at_rest(&at_rest, sense, |_| false, newton, steps);
            if !path.is_complete {
                return None;
            }
            roots.extend(path.roots.into_iter().filter(|root| self.is_balanced(root)));
        }
        Some(roots)
    }

    /// Returns the unknowns of a ball without inertia.
    /// The calculation follows a path that starts from a ball with small friction. First, the creep
    /// speed is lowered; then, friction is increased to its actual value.
    ///
    /// # Errors
    /// Returns [`PathResult::OffFlank`] if the ball leaves its flanks along the path, and
    /// [`PathResult::Lost`] if path tracking fails.
    fn without_inertia(
        &self,
        newton: &mut Workspace,
        steps: &mut usize,
    ) -> Result<[f64; BALL_UNKNOWNS], PathResult> {
        let still = self.contacts.with_inertia(0.0);
        let slippery = still.with_friction(self.contacts.friction.min(SMALL_FRICTION));
        let guess = RollingBall::guess(&still).map_err(|_| PathResult::Lost)?;
        let mut y = self.unknowns(&guess.loaded, &guess.to_nut);
        // At the initial creep speed, friction is nearly proportional to the slip.
        let begin = (10.0 * self.lever(&y)).ln();
        let control = Continuation { first_step: 2.0, min_step: 1e-3 };
        let arrived = follow(&mut y, (begin, self.creep.ln()), control, |log, y| {
            let slippery = SlipBall { contacts: &slippery, creep: log.exp(), ..*self };
            let report = slippery.run(y, newton).report;
            *steps += report.steps.len();
            report.converged()
        });
        arrived.map_err(|_| PathResult::Lost)?;
        if slippery.friction >= self.contacts.friction {
            return Ok(y);
        }
        let resting = SlipBall { contacts: &still, ..*self };
        let goal = self.contacts.friction.ln();
        let seen = trace(
            &PathEquations { ball: &resting, along: PathParameter::Friction },
            &seed(&y, slippery.friction.ln()),
            |z, way| [(z[BALL_UNKNOWNS] - goal, way[BALL_UNKNOWNS])],
            |Trace { crossings, last, .. }| {
                let over = resting.is_far(last) || last[BALL_UNKNOWNS] < 2.0 * SMALL_FRICTION.ln();
                crossings.is_empty() && !over
            },
            &STEP_CONTROL,
        );
        *steps += seen.steps;
        let has_landed = seen.crossings.first().is_some_and(|EventRoot { z, .. }| {
            y = ball(z);
            resting.run(&mut y, newton).converged()
        });
        if has_landed {
            return Ok(y);
        }
        let end = ball(&seen.last);
        Err(if self.is_off_flank(&end, FLANK_ANGLE_TOL) {
            PathResult::OffFlank(self.angles(&end))
        } else {
            PathResult::Lost
        })
    }

    /// Returns the last root on a path or, if the path has no root, the reason.
    fn outcome_of(&self, path: &InertiaPath) -> PathResult {
        let InertiaPath { roots, off_flank, end, is_complete } = path;
        if let Some(root) = roots.last() {
            return PathResult::SlipRoot(*root);
        }
        let is_off = self.is_off_flank(end, FLANK_ANGLE_TOL);
        match off_flank {
            _ if !is_complete && !is_off => PathResult::Lost,
            Some(angles) => PathResult::OffFlank(*angles),
            None if is_off => PathResult::OffFlank(self.angles(end)),
            None => PathResult::Lost,
        }
    }

    /// Follows the path of increasing inertia forces from a ball without inertia.
    ///
    /// * `sense`: 1 if the precession rate that determines the inertia forces moves toward the
    ///   precession rate of the ball without inertia, and -1 if it moves away from that rate.
    /// * `is_last`: function that returns true if the path is to end at the given root.
    fn beginning_at_rest(
        &self,
        y: &[f64; BALL_UNKNOWNS],
        sense: f64,
        is_last: impl Fn(&SlipRoot) -> bool,
        newton: &mut Workspace,
        steps: &mut usize,
    ) -> InertiaPath {
        let (at_rest, mu) = (self.rate(y), self.contacts.inertia_ratio());
        // At the precession rate `small`, the inertia forces are small compared with load and
        // friction.
        let small = at_rest.abs().min((0.1 / mu).sqrt()).min(self.contacts.friction / mu);
        let unit = sense * small.copysign(at_rest);
        // No ball has a precession rate above twice the sum of relative speed and nut speed.
        let most = 2.0 * (1.0 + self.contacts.scaled.nut_speed.abs());
        let event_rate = |z: &[f64; PATH_UNKNOWNS]| unit * z[BALL_UNKNOWNS].sinh();
        let (mut roots, mut off_flank, mut known, mut more) = (Vec::new(), None, 0, 0);
        let seen = trace(
            &PathEquations { ball: self, along: PathParameter::Rate { unit } },
            &seed(y, 0.0),
            |z, way| {
                let slope = way[PRECESSION] - unit * z[BALL_UNKNOWNS].cosh() * way[BALL_UNKNOWNS];
                [(self.rate(&ball(z)) - event_rate(z), slope)]
            },
            |Trace { crossings, last, .. }| {
                for EventRoot { z, .. } in &crossings[known..] {
                    let mut y = ball(z);
                    let report = self.run(&mut y, newton).report;
                    more += report.steps.len();
                    if !report.converged() {
                        continue;
                    }
                    let root = self.with_nut_angle(y, report.residual, newton, &mut more);
                    if self.is_admissible(&root) {
                        roots.push(root);
                        if is_last(&root) {
                            return false;
                        }
                    } else {
                        off_flank = off_flank.or(Some(self.of(&root).angles(&root.unknowns)));
                    }
                }
                known = crossings.len();
                !(self.is_far(last) || event_rate(last).abs() > most)
            },
            &STEP_CONTROL,
        );
        *steps += seen.steps + more;
        let is_complete = seen.end == PathEnd::Ended;
        InertiaPath { roots, off_flank, end: ball(&seen.last), is_complete }
    }
}
