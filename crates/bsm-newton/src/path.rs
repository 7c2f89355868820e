//! Curves that are one equation short of a point.

use std::array::from_fn;

use crate::{Bracket, Equations, EvalError, JacobianUpdate, Options, Scales, Workspace, solve};

/// Direction of the curve of the first `N − 1` equations at `z`, where the last equation is a plane
/// across it (N8).
///
/// ```math
/// J\,t = \operatorname{sgn}(\det J)\,e_N
/// ```
///
/// The sense is the same all along a curve, through folds too, whatever the planes. The length is
/// arbitrary.
///
/// * `f_scale`: what counts as one unit of each equation, as in [`Scales::f`](crate::Scales::f).
///
/// `None` outside the domain, and where there is no direction: where the curve branches or the plane touches it.
pub fn path_direction<const N: usize, E: Equations<N> + ?Sized>(
    equations: &E,
    z: &[f64; N],
    f_scale: &[f64; N],
    work: &mut Workspace<N>,
) -> Option<[f64; N]> {
    work.linearize(equations, z, f_scale).ok()?;
    work.factorize().ok()?;
    // D_F J t = sgn(det J) e_N                                            (N8)
    let mut direction = [0.0; N];
    if let Some(last) = direction.last_mut() {
        *last = work.linear.determinant_sign();
    }
    work.linear.solve(&mut direction);
    direction.iter().all(|t| t.is_finite()).then_some(direction)
}

/// `N` equations of `M = N + 1` unknowns: a curve.
pub trait Homotopy<const N: usize, const M: usize> {
    /// What the equations leave over at `z`.
    ///
    /// # Errors
    ///
    /// [`EvalError`] if `z` is outside the domain of the equations; the curve ends there.
    fn residual(&self, z: &[f64; M]) -> Result<[f64; N], EvalError>;

    /// The same, and the rows of the derivatives.
    ///
    /// # Errors
    ///
    /// As [`residual`](Self::residual).
    fn linearize(&self, z: &[f64; M]) -> Result<([f64; N], [[f64; M]; N]), EvalError>;

    /// What counts as one unit of each equation near `z`: one over its size.
    fn weights(&self, _z: &[f64; M]) -> [f64; N] {
        [1.0; N]
    }

    /// Size of each unknown near `z`. A step of length one moves one unknown by its size.
    fn sizes(&self, z: &[f64; M]) -> [f64; M] {
        z.map(|z| 1.0 + z.abs())
    }
}

/// A point next to the curve, and the sense in which the curve is followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seed<const M: usize> {
    /// The point; it is moved onto the curve first, across `towards`.
    pub z: [f64; M],
    /// Which of the two ways: the one that has a positive product with this. Not across the curve.
    pub towards: [f64; M],
}

/// Lengths of the steps, in the sizes of the unknowns, and bounds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepControl {
    /// Length of the first step. Default 0.1.
    pub first: f64,
    /// The longest step. Default 0.5.
    pub longest: f64,
    /// The shortest one before the path counts as lost. Default 1e-7.
    pub shortest: f64,
    /// A step this short is accepted even if it may hide a pair of crossings. Default 1e-3.
    pub pair_resolution: f64,
    /// Points before the path is given up. Default 1000.
    pub most_points: usize,
    /// Residual of the points that is aimed at, as [`Options::residual_goal`]; a coarser one than the
    /// tolerance is the tolerance too. Default 1e-10.
    pub goal: f64,
    /// How exactly a crossing is wanted, in parts of its step. Default 1e-14.
    pub root_tolerance: f64,
    /// When a correction evaluates the Jacobian, as [`Options::jacobian`]. Default [`JacobianUpdate::EveryStep`].
    pub jacobian: JacobianUpdate,
}

impl Default for StepControl {
    fn default() -> Self {
        let Options { residual_goal: goal, jacobian, .. } = Options::default();
        let (most_points, root_tolerance) = (1000, 1e-14);
        Self {
            first: 0.1,
            longest: 0.5,
            shortest: 1e-7,
            pair_resolution: 1e-3,
            most_points,
            goal,
            root_tolerance,
            jacobian,
        }
    }
}

/// A point of the curve at which the value of an event changes its sign.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EventRoot<const M: usize> {
    /// Number of the event.
    pub event: usize,
    /// The point.
    pub z: [f64; M],
    /// Residual value of the event; not small where the event jumps.
    pub value: f64,
}

/// Why a path ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PathEnd {
    /// It came back to the seed: the crossings are those of the whole curve.
    Closed,
    /// It was not to go on.
    Ended,
    /// Cut short after as many points as are allowed.
    MostPoints,
    /// Cut short: the shortest step led to no point of the curve.
    Lost,
    /// There is no curve at the seed.
    NoCurve,
}

/// What was seen of a curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace<const M: usize> {
    /// The crossings in their order.
    pub crossings: Vec<EventRoot<M>>,
    /// The last point.
    pub last: [f64; M],
    /// Why it ended.
    pub end: PathEnd,
    /// Points.
    pub points: usize,
    /// Steps of length [`StepControl::pair_resolution`] or less that may hide a pair of crossings (N14). Zero: no pair
    /// is missed but one that the values and slopes of the events at both ends of a step do not show.
    pub unresolved: usize,
    /// Newton steps of all corrections.
    pub steps: usize,
}

/// Least cosine between the directions at both ends of a step, and between the step and its tangent: no step goes to
/// another curve.
const LEAST_COSINE: f64 = 0.9;

/// Room for what an event is besides a cubic, in parts of its slopes.
const SAFETY: f64 = 2.0;

/// Newton steps of a correction, and up to which a step was easy.
const MOST_CORRECTOR_STEPS: usize = 10;
const EASY: usize = 4;

/// Follows a curve from a seed on, through folds, and finds where events change their sign.
///
/// Each point is predicted along the tangent and corrected in the plane across it by [`solve`]. A step
/// is shortened where the correction fails, the direction turns or an event may have two zeros more
/// than it shows (N14), and grows where the correction is easy.
///
/// * `events`: value and slope along a direction, at a point: `|z, direction| [(value, slope); K]`. A
///   NaN is no point of the curve.
/// * `on`: asked at each point, with what was seen up to it; true if the path is to go on.
///
/// Nothing but the list of crossings is allocated besides the reports of the corrections.
///
/// Source: Allgower and Georg, *Introduction to Numerical Continuation Methods*, ch. 2 and 6; the guard
/// (N14) is ours.
pub fn trace<const N: usize, const M: usize, const K: usize, F: Homotopy<N, M>>(
    homotopy: &F,
    seed: &Seed<M>,
    events: impl FnMut(&[f64; M], &[f64; M]) -> [(f64, f64); K],
    on: impl FnMut(&Trace<M>) -> bool,
    control: &StepControl,
) -> Trace<M> {
    const { assert!(M == N + 1, "a curve has one unknown more than equations") };
    let (crossings, end) = (Vec::new(), PathEnd::MostPoints);
    let trace = Trace { crossings, last: seed.z, end, points: 0, unresolved: 0, steps: 0 };
    Tracer { homotopy, events, on, control, work: Workspace::default(), trace }.run(seed)
}

/// The equations of a curve and a plane across it.
struct OnPlane<'a, const N: usize, const M: usize, F> {
    homotopy: &'a F,
    foot: [f64; M],
    normal: [f64; M],
}

impl<const N: usize, const M: usize, F> OnPlane<'_, N, M, F> {
    /// Residuals of the family, and the distance from the plane.
    fn values(&self, z: &[f64; M], residual: &[f64; N]) -> [f64; M] {
        let way: [f64; M] = from_fn(|i| z[i] - self.foot[i]);
        from_fn(|i| if i < N { residual[i] } else { dot(&way, &self.normal) })
    }
}

impl<const N: usize, const M: usize, F: Homotopy<N, M>> Equations<M> for OnPlane<'_, N, M, F> {
    fn residual(&self, z: &[f64; M]) -> Result<[f64; M], EvalError> {
        Ok(self.values(z, &self.homotopy.residual(z)?))
    }

    fn linearize(&self, z: &[f64; M], rows: &mut [[f64; M]; M]) -> Result<[f64; M], EvalError> {
        let (residual, known) = self.homotopy.linearize(z)?;
        rows[..N].copy_from_slice(&known);
        rows[N] = self.normal;
        Ok(self.values(z, &residual))
    }
}

/// A point of the curve with its direction, of length one, and the events there.
#[derive(Clone, Copy)]
struct Node<const M: usize, const K: usize> {
    z: [f64; M],
    direction: [f64; M],
    sizes: [f64; M],
    events: [(f64, f64); K],
}

struct Tracer<'a, const N: usize, const M: usize, F, E, D> {
    homotopy: &'a F,
    events: E,
    on: D,
    control: &'a StepControl,
    work: Workspace<M>,
    trace: Trace<M>,
}

impl<const N: usize, const M: usize, const K: usize, F, E, D> Tracer<'_, N, M, F, E, D>
where
    F: Homotopy<N, M>,
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

    /// The first point, and the sense of the way against that of (N8).
    fn begin(&mut self, seed: &Seed<M>) -> Option<(Node<M, K>, f64)> {
        let sizes = self.homotopy.sizes(&seed.z);
        let across = unit(&seed.towards, &sizes);
        let (z, _) = self.corrected(&seed.z, &across, &sizes)?;
        let free = self.node(&z, &across, 1.0)?;
        let along = dot(&free.direction, &normal(&across, &sizes));
        let orientation = if along < 0.0 { -1.0 } else { 1.0 };
        Some((self.node(&z, &across, orientation)?, orientation))
    }

    /// The point of the curve in the plane through `foot` across a direction, and Newton steps.
    fn corrected(
        &mut self,
        foot: &[f64; M],
        direction: &[f64; M],
        sizes: &[f64; M],
    ) -> Option<([f64; M], usize)> {
        let plane =
            OnPlane { homotopy: self.homotopy, foot: *foot, normal: normal(direction, sizes) };
        let scales = Scales { x: &sizes.map(f64::recip), f: &self.weights(foot) };
        let residual_goal = self.control.goal;
        let residual_tol = Options::default().residual_tol.max(residual_goal);
        let options = Options {
            residual_tol,
            residual_goal,
            max_steps: MOST_CORRECTOR_STEPS,
            jacobian: self.control.jacobian,
            ..Options::default()
        };
        let mut z = *foot;
        let report = solve(&plane, &mut z, &scales, &options, &mut self.work);
        self.trace.steps += report.steps.len();
        report.converged().then_some((z, report.steps.len()))
    }

    fn weights(&self, z: &[f64; M]) -> [f64; M] {
        let weights = self.homotopy.weights(z);
        from_fn(|i| if i < N { weights[i] } else { 1.0 })
    }

    /// The point with its direction and events.
    fn node(&mut self, z: &[f64; M], across: &[f64; M], orientation: f64) -> Option<Node<M, K>> {
        let sizes = self.homotopy.sizes(z);
        let plane = OnPlane { homotopy: self.homotopy, foot: *z, normal: normal(across, &sizes) };
        let direction = path_direction(&plane, z, &self.weights(z), &mut self.work)?;
        let direction = unit(&direction.map(|t| t * orientation), &sizes);
        let events = (self.events)(z, &direction);
        let known = events.iter().all(|(value, slope)| !value.is_nan() && !slope.is_nan());
        known.then_some(Node { z: *z, direction, sizes, events })
    }

    fn follow_curve(&mut self, begin: &Node<M, K>, orientation: f64) -> PathEnd {
        let (mut at, mut length) = (*begin, self.control.first);
        for point in 0..self.control.most_points {
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
            length = (length * if easy { 1.6 } else { 1.0 }).min(self.control.longest);
        }
        PathEnd::MostPoints
    }

    /// The next point, and whether the step was easy; crossings are noted.
    fn next(
        &mut self,
        at: &Node<M, K>,
        begin: &Node<M, K>,
        length: &mut f64,
        orientation: f64,
        point: usize,
    ) -> Option<(Node<M, K>, bool)> {
        while *length >= self.control.shortest {
            if let Some((mut next, easy)) = self.step(at, *length, orientation) {
                let mut moved = distance(&at.z, &next.z, &at.sizes);
                if point > 1 && passes(begin, at, &next, moved) {
                    (next, moved) = (*begin, distance(&at.z, &begin.z, &at.sizes));
                }
                let hides = (0..K).any(|k| may_miss_pair([at.events[k], next.events[k]], moved));
                if (!hides || moved <= self.control.pair_resolution) && self.cross(at, &next) {
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
        let next = self.node(&z, &at.direction, orientation)?;
        let arriving = unit(&next.direction, &at.sizes);
        // A step far off its tangent may end on another curve, whatever the direction of that.
        let straight = dot(&arriving, &normal(&at.direction, &at.sizes)) > LEAST_COSINE
            && length > LEAST_COSINE * distance(&at.z, &z, &at.sizes);
        straight.then_some((next, steps <= EASY))
    }

    /// Notes the crossings between two points; false if one is not found.
    fn cross(&mut self, at: &Node<M, K>, next: &Node<M, K>) -> bool {
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

/// True if an event with these values and slopes at both ends of a step of this length may have two
/// zeros more than the values show (N14).
fn may_miss_pair([from, to]: [(f64, f64); 2], length: f64) -> bool {
    // g₀, g₀ + r h g₀'/3, g₁ − r h g₁'/3, g₁ change their sign at most once  (N14)
    let inner =
        |(value, slope): (f64, f64), sign: f64| value + sign * SAFETY * length * slope / 3.0;
    let corners = [from.0, inner(from, 1.0), inner(to, -1.0), to.0];
    corners.windows(2).filter(|pair| (pair[0] > 0.0) != (pair[1] > 0.0)).count() > 1
}

/// True if a step passes the point at which the path began, in the sense in which it began.
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

/// The direction with length one in the sizes of the unknowns.
fn unit<const M: usize>(direction: &[f64; M], sizes: &[f64; M]) -> [f64; M] {
    let length = distance(direction, &[0.0; M], sizes);
    direction.map(|d| d / length)
}

/// What a way is multiplied with for its part along a direction of length one.
fn normal<const M: usize>(direction: &[f64; M], sizes: &[f64; M]) -> [f64; M] {
    from_fn(|i| direction[i] / (sizes[i] * sizes[i]))
}

fn distance<const M: usize>(a: &[f64; M], b: &[f64; M], sizes: &[f64; M]) -> f64 {
    (0..M).map(|i| ((a[i] - b[i]) / sizes[i]).powi(2)).sum::<f64>().sqrt()
}

fn dot<const M: usize>(a: &[f64; M], b: &[f64; M]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
