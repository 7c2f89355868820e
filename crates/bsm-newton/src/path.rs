//! Pseudo-arclength continuation of N equations in N + 1 unknowns.

use std::array::from_fn;

use crate::{
    Bracket, Convergence, Equations, EvalError, JacobianUpdate, Linearized, Options, Scales,
    Workspace, solve,
};

/// Returns the direction at `z` of the curve that is defined by the first `N − 1` equations (N8).
///
/// The last equation must define a plane that intersects the curve.
///
/// ```math
/// J\,t = \operatorname{sgn}(\det J)\,e_N
/// ```
///
/// The orientation of the direction is consistent along the whole curve, including folds, and does
/// not depend on the choice of the plane. The length of the returned vector is arbitrary.
///
/// * `f_scale`: reciprocals of the typical magnitudes of the residuals, as in
///   [`Scales::f`](crate::Scales::f).
///
/// Returns `None` if the equations cannot be evaluated at `z`, or if the Jacobian is singular
/// because the curve branches or is tangent to the plane.
pub fn path_direction<const N: usize, E: Equations<N> + ?Sized>(
    equations: &E,
    z: &[f64; N],
    f_scale: &[f64; N],
    work: &mut Workspace<N>,
) -> Option<[f64; N]> {
    work.linearize(equations, z, f_scale).ok()?;
    work.direction()
}

/// A curve, defined by a system of `N` equations in `M = N + 1` unknowns.
pub trait CurveEquations<const N: usize, const M: usize> {
    /// Returns the residual at `z`.
    ///
    /// # Errors
    ///
    /// Returns [`EvalError`] if `z` is outside the domain of the equations.
    fn residual(&self, z: &[f64; M]) -> Result<[f64; N], EvalError>;

    /// Returns the residual and the rows of the Jacobian at `z`.
    ///
    /// # Errors
    ///
    /// Returns the same errors as [`residual`](Self::residual).
    fn linearize(&self, z: &[f64; M]) -> Result<([f64; N], [[f64; M]; N]), EvalError>;

    /// Returns the weights of the equations near `z`, which are the reciprocals of the typical
    /// magnitudes of their residuals. All weights default to 1.
    fn weights(&self, _z: &[f64; M]) -> [f64; N] {
        [1.0; N]
    }

    /// Returns the typical magnitudes of the unknowns near `z`. A step of length 1 along an unknown
    /// changes it by its typical magnitude.
    fn sizes(&self, z: &[f64; M]) -> [f64; M] {
        z.map(|z| 1.0 + z.abs())
    }
}

/// Starting point of a continuation and the direction in which the curve is followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seed<const M: usize> {
    /// Point near the curve. The continuation first corrects it onto the curve, within the plane
    /// perpendicular to `towards`.
    pub z: [f64; M],
    /// Vector that selects one of the two directions along the curve. The scalar product of this
    /// vector and the initial direction of the path is positive.
    pub towards: [f64; M],
}

/// Step lengths, tolerances and limits of a continuation. Lengths are scaled by the typical
/// magnitudes of the unknowns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepControl {
    /// Length of the first step, positive. Defaults to 0.1.
    pub first_step: f64,
    /// Maximum step length. Defaults to 0.5.
    pub max_step: f64,
    /// Minimum step length. The path is lost if a shorter step would be needed. Defaults to 1e-7.
    pub min_step: f64,
    /// Step length below which a step is accepted even if it may hide a pair of sign changes.
    /// Defaults to 1e-3.
    pub pair_resolution: f64,
    /// Maximum number of points on the path. Defaults to 1000.
    pub max_points: usize,
    /// Scaled residual to which the points of the path are refined, as in
    /// [`Convergence::residual_goal`]. If it exceeds the default of [`Convergence::residual_tol`],
    /// it is also the residual tolerance. Defaults to 1e-10.
    pub residual_goal: f64,
    /// Relative tolerance for the location of a crossing within a step. Defaults to 1e-14.
    pub root_tolerance: f64,
    /// Rule that decides when the Jacobian is evaluated during a correction, as in
    /// [`Options::jacobian`]. Defaults to [`JacobianUpdate::EveryStep`].
    pub jacobian: JacobianUpdate,
}

impl Default for StepControl {
    fn default() -> Self {
        Self {
            first_step: 0.1,
            max_step: 0.5,
            min_step: 1e-7,
            pair_resolution: 1e-3,
            max_points: 1000,
            residual_goal: Convergence::default().residual_goal,
            root_tolerance: 1e-14,
            jacobian: JacobianUpdate::default(),
        }
    }
}

/// A crossing, which is a point of the curve at which an event function changes sign.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EventRoot<const M: usize> {
    /// Index of the event function.
    pub event: usize,
    /// Location of the crossing on the curve.
    pub z: [f64; M],
    /// Value of the event function at this point. It is not small if the function jumps.
    pub value: f64,
}

/// Reason why the continuation ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PathEnd {
    /// The curve is closed and was traced completely. The result contains the crossings of the
    /// whole curve.
    Closed,
    /// The caller ended the continuation.
    Ended,
    /// The path reached the maximum number of points.
    MaxPoints,
    /// No step of at least the minimum length led to another point on the curve.
    Lost,
    /// No point on the curve was found near the seed.
    NoCurve,
}

/// Result of a continuation.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace<const M: usize> {
    /// Crossings, in the order in which the path passes them.
    pub crossings: Vec<EventRoot<M>>,
    /// Last point on the path.
    pub last: [f64; M],
    /// Reason why the continuation ended.
    pub end: PathEnd,
    /// Number of points on the path.
    pub points: usize,
    /// Number of accepted steps that may hide a pair of sign changes (N14). If it is zero, the
    /// values and slopes of the event functions give no indication of a missed pair.
    pub unresolved: usize,
    /// Total number of Newton steps in all corrections.
    pub steps: usize,
}

/// Minimum cosine of the angle between the tangents at the two ends of a step, and of the angle
/// between the step and its initial tangent. This limit prevents steps from jumping to another
/// curve.
const MIN_COSINE: f64 = 0.9;

/// Safety factor r ≥ 1 of (N14) for the slopes of event functions, which may deviate from a cubic
/// polynomial (dimensionless).
const SAFETY: f64 = 2.0;

/// Maximum number of Newton steps in a correction.
const MAX_CORRECTOR_STEPS: usize = 10;

/// Largest number of Newton steps in a correction after which the step length is still increased.
const MAX_EASY_STEPS: usize = 4;

/// Follows a curve from a seed, through folds, and locates the points at which event functions
/// change sign.
///
/// Each point is predicted along the tangent and then corrected with [`solve`] in the plane
/// perpendicular to the tangent. A step is shortened if the correction fails, if the direction
/// changes too much, or if an event function may have two more zeros within the step than the signs
/// of its values indicate (N14). The step length increases if the correction requires only a few
/// Newton steps.
///
/// * `events`: function that returns the values of the event functions at a point and their slopes
///   along a direction: `|z, direction| [(value, slope); K]`. Points at which a value or a slope is
///   NaN are rejected.
/// * `on`: function that is called after each new point with all results so far. The continuation
///   stops if the function returns false.
///
/// Memory is allocated only for crossings and for the reports of corrections.
///
/// Source: Allgower and Georg, *Introduction to Numerical Continuation Methods*, ch. 2 and 6. The
/// guard (N14) is our own.
pub fn trace<const N: usize, const M: usize, const K: usize, F: CurveEquations<N, M>>(
    equations: &F,
    seed: &Seed<M>,
    events: impl FnMut(&[f64; M], &[f64; M]) -> [(f64, f64); K],
    on: impl FnMut(&Trace<M>) -> bool,
    control: &StepControl,
) -> Trace<M> {
    const { assert!(M == N + 1, "a curve needs one more unknown than equations") };
    let (crossings, end) = (Vec::new(), PathEnd::MaxPoints);
    let trace = Trace { crossings, last: seed.z, end, points: 0, unresolved: 0, steps: 0 };
    Tracer { equations, events, on, control, work: Workspace::default(), trace }.run(seed)
}

/// Equations of a curve, together with a plane that intersects it.
struct OnPlane<'a, const N: usize, const M: usize, F> {
    equations: &'a F,
    foot: [f64; M],
    normal: [f64; M],
}

impl<const N: usize, const M: usize, F> OnPlane<'_, N, M, F> {
    /// Returns the residuals of the curve equations, followed by the distance from the plane.
    fn values(&self, z: &[f64; M], residual: &[f64; N]) -> [f64; M] {
        let way: [f64; M] = from_fn(|i| z[i] - self.foot[i]);
        from_fn(|i| if i < N { residual[i] } else { dot(&way, &self.normal) })
    }
}

impl<const N: usize, const M: usize, F: CurveEquations<N, M>> Equations<M>
    for OnPlane<'_, N, M, F>
{
    type Details = ();
    type Slopes = ();

    fn residual(&self, z: &[f64; M]) -> Result<([f64; M], ()), EvalError> {
        Ok((self.values(z, &self.equations.residual(z)?), ()))
    }

    fn linearize(&self, z: &[f64; M], rows: &mut [[f64; M]; M]) -> Linearized<M, Self> {
        let (residual, known) = self.equations.linearize(z)?;
        rows[..N].copy_from_slice(&known);
        rows[N] = self.normal;
        Ok((self.values(z, &residual), (), ()))
    }
}

/// A point of the curve, with its unit tangent and the values and slopes of the event functions.
#[derive(Clone, Copy)]
struct Node<const M: usize, const K: usize> {
    z: [f64; M],
    direction: [f64; M],
    sizes: [f64; M],
    events: [(f64, f64); K],
}

struct Tracer<'a, const N: usize, const M: usize, F, E, D> {
    equations: &'a F,
    events: E,
    on: D,
    control: &'a StepControl,
    work: Workspace<M>,
    trace: Trace<M>,
}

impl<const N: usize, const M: usize, const K: usize, F, E, D> Tracer<'_, N, M, F, E, D>
where
    F: CurveEquations<N, M>,
    E: FnMut(&[f64; M], &[f64; M]) -> [(f64, f64); K],
    D: FnMut(&Trace<M>) -> bool,
{
    fn run(mut self, seed: &Seed<M>) -> Trace<M> {
        self.trace.end = match self.begin(seed) {
            Some((begin, orientation)) => self.follow_curve(&begin, orientation),
            None => PathEnd::NoCurve,
        };
        self.trace
    }

    /// Returns the first point of the path and the orientation of the path relative to the
    /// direction of (N8), which is 1 or -1.
    fn begin(&mut self, seed: &Seed<M>) -> Option<(Node<M, K>, f64)> {
        let sizes = self.equations.sizes(&seed.z);
        let across = unit(&seed.towards, &sizes);
        let (z, _) = self.corrected(&seed.z, &across, &sizes)?;
        let along = dot(&self.work.direction()?, &normal(&across, &sizes));
        let orientation = if along < 0.0 { -1.0 } else { 1.0 };
        Some((self.node(&z, orientation)?, orientation))
    }

    /// Returns the point of the curve in the plane through `foot` perpendicular to `direction`, and
    /// the number of Newton steps. Returns `None` if the correction fails.
    fn corrected(
        &mut self,
        foot: &[f64; M],
        direction: &[f64; M],
        sizes: &[f64; M],
    ) -> Option<([f64; M], usize)> {
        let plane =
            OnPlane { equations: self.equations, foot: *foot, normal: normal(direction, sizes) };
        let scales = Scales { x: &sizes.map(f64::recip), f: &self.weights(foot) };
        let residual_goal = self.control.residual_goal;
        let convergence = Convergence {
            residual_tol: Convergence::RESIDUAL_TOL.max(residual_goal),
            residual_goal,
            max_steps: MAX_CORRECTOR_STEPS,
        };
        let jacobian = self.control.jacobian;
        let options = Options { convergence, jacobian, ..Options::default() };
        let mut z = *foot;
        let report = solve(&plane, &mut z, &scales, &options, &mut self.work).report;
        self.trace.steps += report.steps.len();
        if report.steps.is_empty() {
            // The tangent requires a Jacobian, but the correction did not evaluate one.
            self.work.linearize(&plane, &z, scales.f).ok()?;
        }
        report.converged().then_some((z, report.steps.len()))
    }

    fn weights(&self, z: &[f64; M]) -> [f64; M] {
        let weights = self.equations.weights(z);
        from_fn(|i| if i < N { weights[i] } else { 1.0 })
    }

    /// Adds the tangent and the event functions to the point found by the last correction. Returns
    /// `None` if the tangent does not exist or an event function is NaN.
    /// The tangent is calculated from the last Jacobian of the correction, which was evaluated at
    /// the returned point or at a nearby iterate.
    fn node(&mut self, z: &[f64; M], orientation: f64) -> Option<Node<M, K>> {
        let sizes = self.equations.sizes(z);
        let direction = self.work.direction()?;
        let direction = unit(&direction.map(|t| t * orientation), &sizes);
        let events = (self.events)(z, &direction);
        let known = events.iter().all(|(value, slope)| !value.is_nan() && !slope.is_nan());
        known.then_some(Node { z: *z, direction, sizes, events })
    }

    fn follow_curve(&mut self, begin: &Node<M, K>, orientation: f64) -> PathEnd {
        let (mut at, mut length) = (*begin, self.control.first_step);
        for point in 0..self.control.max_points {
            self.trace.points = point + 1;
            let Some((next, easy)) = self.next(&at, begin, &mut length, orientation, point) else {
                return PathEnd::Lost;
            };
            let closed = next.z.iter().zip(&begin.z).all(|(a, b)| a.total_cmp(b).is_eq());
            self.trace.last = next.z;
            if !(self.on)(&self.trace) {
                return PathEnd::Ended;
            }
            if closed {
                return PathEnd::Closed;
            }
            at = next;
            length = (length * if easy { 1.6 } else { 1.0 }).min(self.control.max_step);
        }
        PathEnd::MaxPoints
    }

    /// Takes the next step and stores its crossings. Returns the next point, and whether its
    /// correction required only a few Newton steps.
    fn next(
        &mut self,
        at: &Node<M, K>,
        begin: &Node<M, K>,
        length: &mut f64,
        orientation: f64,
        point: usize,
    ) -> Option<(Node<M, K>, bool)> {
        while *length >= self.control.min_step {
            if let Some((mut next, easy)) = self.step(at, *length, orientation) {
                let mut moved = distance(&at.z, &next.z, &at.sizes);
                if point > 1 && passes(begin, at, &next, moved) {
                    (next, moved) = (*begin, distance(&at.z, &begin.z, &at.sizes));
                }
                let hides = (0..K).any(|k| may_miss_pair([at.events[k], next.events[k]], moved));
                if (!hides || moved <= self.control.pair_resolution)
                    && self.store_crossings(at, &next)
                {
                    self.trace.unresolved += usize::from(hides);
                    return Some((next, easy));
                }
            }
            *length *= 0.4;
        }
        None
    }

    fn step(
        &mut self,
        at: &Node<M, K>,
        length: f64,
        orientation: f64,
    ) -> Option<(Node<M, K>, bool)> {
        let foot: [f64; M] = from_fn(|i| at.z[i] + length * at.direction[i]);
        let (z, steps) = self.corrected(&foot, &at.direction, &at.sizes)?;
        let next = self.node(&z, orientation)?;
        let arriving = unit(&next.direction, &at.sizes);
        // A step that deviates far from its tangent may end on another curve, even if this curve
        // has a similar tangent.
        let straight = dot(&arriving, &normal(&at.direction, &at.sizes)) > MIN_COSINE
            && length > MIN_COSINE * distance(&at.z, &z, &at.sizes);
        straight.then_some((next, steps <= MAX_EASY_STEPS))
    }

    /// Stores the crossings between two points. Returns false if a crossing cannot be located.
    fn store_crossings(&mut self, at: &Node<M, K>, next: &Node<M, K>) -> bool {
        let mut crossings = Vec::new();
        let way: [f64; M] = from_fn(|i| next.z[i] - at.z[i]);
        for event in 0..K {
            let values = [at.events[event].0, next.events[event].0];
            if (values[0] > 0.0) == (values[1] > 0.0) {
                continue;
            }
            let across = unit(&way, &at.sizes);
            let mut event_point = at.z;
            let bracket =
                Bracket { x_tol: self.control.root_tolerance, ..Bracket::new([0.0, 1.0], values) };
            let found = bracket.root(|part| {
                let foot = from_fn(|i| at.z[i] + part * way[i]);
                match self.corrected(&foot, &across, &at.sizes) {
                    Some((z, _)) => {
                        event_point = z;
                        (self.events)(&z, &across)[event].0
                    }
                    None => f64::NAN,
                }
            });
            let Some(root) = found.root() else { return false };
            if root.x >= 1.0 {
                event_point = next.z;
            } else if root.x <= 0.0 {
                event_point = at.z;
            } else {
                let foot = from_fn(|i| at.z[i] + root.x * way[i]);
                event_point =
                    self.corrected(&foot, &across, &at.sizes).map_or(event_point, |(z, _)| z);
            }
            crossings.push((root.x, EventRoot { event, z: event_point, value: root.value }));
        }
        crossings.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        self.trace.crossings.extend(crossings.into_iter().map(|(_, crossing)| crossing));
        true
    }
}

/// Returns true if an event function may have two more zeros within a step than the signs of its
/// values indicate (N14). The arguments are the values and slopes at both ends of the step.
fn may_miss_pair([from, to]: [(f64, f64); 2], length: f64) -> bool {
    // The sequence g₀, g₀ + r h g₀'/3, g₁ − r h g₁'/3, g₁ changes sign at most once (N14)
    let inner =
        |(value, slope): (f64, f64), sign: f64| value + sign * SAFETY * length * slope / 3.0;
    let corners = [from.0, inner(from, 1.0), inner(to, -1.0), to.0];
    corners.windows(2).filter(|pair| (pair[0] > 0.0) != (pair[1] > 0.0)).count() > 1
}

/// Returns true if a step passes the first point of the path in the same direction as at the start.
fn passes<const M: usize, const K: usize>(
    begin: &Node<M, K>,
    at: &Node<M, K>,
    next: &Node<M, K>,
    moved: f64,
) -> bool {
    let ahead = |z: &[f64; M]| {
        let way: [f64; M] = from_fn(|i| z[i] - begin.z[i]);
        dot(&way, &normal(&begin.direction, &begin.sizes))
    };
    let near = distance(&at.z, &begin.z, &at.sizes) <= 1.1 * moved;
    near && ahead(&at.z) < 0.0 && ahead(&next.z) >= 0.0
}

/// Scales a direction to unit length, measured in the typical magnitudes of the unknowns.
fn unit<const M: usize>(direction: &[f64; M], sizes: &[f64; M]) -> [f64; M] {
    let length = distance(direction, &[0.0; M], sizes);
    direction.map(|d| d / length)
}

/// Returns the vector whose scalar product with a displacement gives the component of this
/// displacement along a unit direction.
fn normal<const M: usize>(direction: &[f64; M], sizes: &[f64; M]) -> [f64; M] {
    from_fn(|i| direction[i] / (sizes[i] * sizes[i]))
}

fn distance<const M: usize>(a: &[f64; M], b: &[f64; M], sizes: &[f64; M]) -> f64 {
    (0..M).map(|i| ((a[i] - b[i]) / sizes[i]).powi(2)).sum::<f64>().sqrt()
}

fn dot<const M: usize>(a: &[f64; M], b: &[f64; M]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
