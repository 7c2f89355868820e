//! Functions that search for roots and for minima (with argmin). The searched function returns NaN
//! where it is not defined.

use std::marker::PhantomData;

use argmin::core::{CostFunction, Executor};
use argmin::solver::brent::BrentOpt;
use argmin::solver::neldermead::NelderMead;
use bsm_newton::{Bracket, RootResult};

use crate::Range;

pub use argmin::core::Error as SearchError;

/// Adapter that implements the cost function interface of argmin for a closure.
struct Cost<P, F>(F, PhantomData<P>);

impl<P, E: Into<SearchError>, F: Fn(&P) -> Result<f64, E>> CostFunction for Cost<P, F> {
    type Param = P;
    type Output = f64;

    fn cost(&self, x: &P) -> Result<f64, SearchError> {
        self.0(x).map_err(Into::into)
    }
}

/// Returns the root of `function` between two points at which its values have opposite signs.
///
/// # Errors
///
/// Returns [`SearchError`] if the values at both points have the same sign, or if `function` fails
/// or returns NaN.
pub fn root_of<E: Into<SearchError>>(
    function: impl Fn(f64) -> Result<f64, E>,
    low: f64,
    high: f64,
) -> Result<f64, SearchError> {
    let (ends, mut failure) = ([low, high], None);
    let mut value = |x: f64| {
        function(x).unwrap_or_else(|error| {
            failure = Some(error.into());
            f64::NAN
        })
    };
    let bracket = Bracket { x_tol: 1e-12, ..Bracket::new(ends, ends.map(&mut value)) };
    match bracket.root(value) {
        RootResult::Root(root) => Ok(root.x),
        none => Err(failure.unwrap_or_else(|| SearchError::msg(format!("no root: {none:?}")))),
    }
}

/// Returns the location of the minimum of `function` between two points.
///
/// # Errors
///
/// Returns [`SearchError`] if `function` fails.
pub fn minimum_of<E: Into<SearchError>>(
    function: impl Fn(f64) -> Result<f64, E>,
    low: f64,
    high: f64,
) -> Result<f64, SearchError> {
    let (cost, solver) = (Cost(|x: &f64| function(*x), PhantomData), BrentOpt::new(low, high));
    let search = Executor::new(cost, solver.set_tolerance(1e-9, 1e-12));
    let found = search.configure(|state| state.max_iters(200)).run()?;
    Ok(found.state.best_param.unwrap_or(f64::NAN))
}

/// Number of intervals into which [`sign_changes`] divides the searched range.
const CROSSING_STEPS: u32 = 200;

/// Number of intervals into which [`minimum_inside`] divides the searched range.
const MINIMUM_STEPS: u32 = 40;

/// Threshold that distinguishes a jump from a root. The change of the function in the immediate
/// vicinity of the sign change is compared with its change between neighboring grid points.
const JUMP: f64 = 1e-3;

/// A root of a function, and the derivative of the function at this root.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SignChange {
    /// Location of the root.
    pub at: f64,
    /// Derivative of the function at the root.
    pub slope: f64,
}

/// Roots of a function in a range, together with the range of its values.
#[derive(Debug, Clone, PartialEq)]
pub struct SignChanges {
    /// Roots, in ascending order.
    pub roots: Vec<SignChange>,
    /// Locations at which the function jumps from one sign to the other, in ascending order.
    pub jumps: Vec<f64>,
    /// Range of the values at the grid points; `None` if the function is not defined at any grid
    /// point.
    pub values: Option<Range>,
    /// Fraction of the grid points at which the function is defined.
    pub share: f64,
}

/// Evaluates `function` on a grid and refines every sign change. If two roots lie between
/// neighboring grid points, both are missed. A jump across zero does not count as a root.
///
/// # Errors
/// Returns the first error that `function` returns.
pub fn sign_changes<E: Into<SearchError>>(
    function: impl Fn(f64) -> Result<f64, E>,
    range: Range,
) -> Result<SignChanges, E> {
    let points: Vec<_> =
        (0..=CROSSING_STEPS).map(|i| grid_point(range, i, CROSSING_STEPS)).collect();
    let values = points.iter().map(|x| function(*x)).collect::<Result<Vec<_>, _>>()?;
    let (mut roots, mut jumps) = (Vec::new(), Vec::new());
    if values[0] == 0.0 {
        let (at, width) = (points[0], points[1] - points[0]);
        roots.push(SignChange { at, slope: slope_at(&function, at, width, range)? });
    }
    for (x, v) in points.windows(2).zip(values.windows(2)) {
        // A root at the common end point of two intervals belongs to the first interval.
        let root = if v[1] == 0.0 {
            Some(x[1])
        } else if v[0] * v[1] < 0.0 {
            root_of(&function, x[0], x[1]).ok()
        } else {
            None
        };
        let Some(at) = root else { continue };
        // Near a root, a continuous function changes only slightly over the tolerance of the root
        // finder. A larger change indicates a jump.
        let near = 1e-9 * at.abs().max(x[1] - x[0]);
        let change = function(at + near)? - function(at - near)?;
        if change.abs() > JUMP * (v[1] - v[0]).abs() && v[1] != 0.0 {
            jumps.push(at);
            continue;
        }
        roots.push(SignChange { at, slope: slope_at(&function, at, x[1] - x[0], range)? });
    }
    let known: Vec<_> = values.iter().copied().filter(|v| v.is_finite()).collect();
    let values = known
        .iter()
        .map(|value| Range { low: *value, high: *value })
        .reduce(|all, one| Range { low: all.low.min(one.low), high: all.high.max(one.high) });
    #[expect(clippy::cast_precision_loss, reason = "a few points")]
    let share = known.len() as f64 / points.len() as f64;
    Ok(SignChanges { roots, jumps, values, share })
}

/// Returns the derivative of a function at a root, calculated as a difference quotient. At an end
/// of the range, the difference is one-sided, because the function may be undefined beyond the end.
///
/// * `width`: distance between the grid points next to the root. It determines the step of the
///   difference quotient if the root is zero or close to zero.
fn slope_at<E>(
    function: impl Fn(f64) -> Result<f64, E>,
    at: f64,
    width: f64,
    range: Range,
) -> Result<f64, E> {
    let step = 1e-4 * at.abs().max(width);
    let ends = [(at - step).max(range.low), (at + step).min(range.high)];
    Ok((function(ends[1])? - function(ends[0])?) / (ends[1] - ends[0]))
}

/// Returns grid point `i` of `steps`. If the range is positive, the grid points form a geometric
/// progression; otherwise, they are equidistant.
pub fn grid_point(range: Range, i: u32, steps: u32) -> f64 {
    let share = f64::from(i) / f64::from(steps);
    if i == steps {
        range.high
    } else if range.low > 0.0 {
        range.low * (range.high / range.low).powf(share)
    } else {
        range.at(share)
    }
}

/// Location and value of a minimum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Minimum {
    /// Location of the minimum.
    pub at: f64,
    /// Value of the function at the minimum.
    pub value: f64,
}

/// Evaluates `function` on a grid and refines the smallest value. Returns `None` if the function is
/// not defined at any grid point, or if the smallest value is at an end of the range.
///
/// # Errors
///
/// Returns the first error of `function`.
pub fn minimum_inside<E: Into<SearchError>>(
    function: impl Fn(f64) -> Result<f64, E>,
    range: Range,
) -> Result<Option<Minimum>, E> {
    let value = |x: f64| function(x).map(|v| if v.is_nan() { f64::MAX } else { v });
    let step = (range.high - range.low) / f64::from(MINIMUM_STEPS);
    let points: Vec<_> = (0..=MINIMUM_STEPS).map(|i| range.low + step * f64::from(i)).collect();
    let values = points.iter().map(|x| value(*x)).collect::<Result<Vec<_>, _>>()?;
    let least = (0..points.len()).min_by(|i, j| values[*i].total_cmp(&values[*j]));
    let inside = least.filter(|i| (1..points.len() - 1).contains(i) && values[*i] < f64::MAX);
    let found = inside.and_then(|i| minimum_of(value, points[i - 1], points[i + 1]).ok());
    found.map(|at| Ok(Minimum { at, value: value(at)? })).transpose()
}

/// Objective and constraints of an optimization problem at one point.
#[derive(Debug, Clone, PartialEq)]
pub struct Value {
    /// Value of the objective, which is minimized.
    pub objective: f64,
    /// Values of the constraints. A constraint is met if its value is at most 0.
    pub violations: Vec<f64>,
}

/// Largest constraint violation that is accepted.
pub const SLACK: f64 = 1e-4;

impl Value {
    /// Returns true if all constraints are met within the tolerance [`SLACK`].
    pub fn is_feasible(&self) -> bool {
        self.largest_violation() <= SLACK
    }

    /// Returns the largest violation of a constraint, or 0 if all constraints are met.
    pub fn largest_violation(&self) -> f64 {
        self.violations.iter().copied().fold(0.0, f64::max)
    }
}

/// Number of updates of the Lagrange multipliers.
const ROUNDS: usize = 7;
/// Maximum number of simplex iterations per vertex in each multiplier update.
const STEPS: u64 = 25;

/// Minimizes the objective under the constraints, starting from `start`. All variables are limited
/// to the unit cube.
///
/// The augmented Lagrangian of Powell, Hestenes and Rockafellar is minimized by the Nelder-Mead
/// method, with a smaller initial simplex in each round. The method does not require derivatives
/// and tolerates points at which the function is not defined. Source: Nocedal and Wright,
/// *Numerical Optimization*, ch. 17.
pub fn minimize(function: impl Fn(&[f64]) -> Value, start: &[f64]) -> Vec<f64> {
    let mut best = start.to_vec();
    if start.is_empty() {
        return best;
    }
    let mut multipliers = vec![0.0; function(&inside(start)).violations.len()];
    let (mut weight, mut size) = (10.0, 0.25);
    let mut largest_violation = f64::INFINITY;
    for _ in 0..ROUNDS {
        let lagrangian = |x: &[f64]| {
            let Value { objective, violations } = function(&inside(x));
            // f + Σ max(0, Λ + w g)² / 2w, plus a penalty outside the cube
            let pull = |(g, m): (&f64, &f64)| (m + weight * finite(*g)).max(0.0).powi(2);
            let outside: f64 = x.iter().map(|x| (x - x.clamp(0.0, 1.0)).powi(2)).sum();
            let constraints: f64 = violations.iter().zip(&multipliers).map(pull).sum();
            finite(objective) + constraints / (2.0 * weight) + 1e3 * outside
        };
        best = inside(&simplex(&lagrangian, &best, size));
        let Value { violations, .. } = function(&best);
        for (multiplier, violation) in multipliers.iter_mut().zip(&violations) {
            *multiplier = (*multiplier + weight * finite(*violation)).max(0.0);
        }
        let now = violations.iter().map(|g| finite(*g)).fold(0.0, f64::max);
        if now > 0.3 * largest_violation {
            weight *= 4.0;
        }
        (largest_violation, size) = (now, (0.5 * size).max(0.01));
    }
    best
}

/// Limits a value to a large but finite number and replaces NaN by this number.
fn finite(x: f64) -> f64 {
    const VERY_BAD: f64 = 1e3;
    if x.is_nan() { VERY_BAD } else { x.clamp(-VERY_BAD, VERY_BAD) }
}

fn inside(x: &[f64]) -> Vec<f64> {
    x.iter().map(|x| x.clamp(0.0, 1.0)).collect()
}

/// Runs the Nelder-Mead method with an initial simplex of the given size.
fn simplex(function: &dyn Fn(&[f64]) -> f64, start: &[f64], size: f64) -> Vec<f64> {
    let cost = Cost(|x: &Vec<f64>| Ok::<_, SearchError>(function(x)), PhantomData);
    let mut corners = vec![start.to_vec()];
    for i in 0..start.len() {
        let mut corner = start.to_vec();
        // The vertex is shifted toward the interior of the cube.
        corner[i] += if corner[i] > 0.5 { -size } else { size };
        corners.push(corner);
    }
    let steps = STEPS * corners.len() as u64;
    let found = NelderMead::new(corners)
        .with_sd_tolerance(1e-9)
        .and_then(|solver| {
            Executor::new(cost, solver).configure(|state| state.max_iters(steps)).run()
        })
        .ok()
        .and_then(|found| found.state.best_param);
    found.unwrap_or_else(|| start.to_vec())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// The sine has three known roots between -1 and 7. If the function is not defined beyond 4,
    /// only one root remains between 1 and 7. One of the roots coincides with a grid point.
    #[test]
    fn root_search_finds_all_sign_changes() {
        let sine = |x: f64| Ok::<_, SearchError>(x.sin());
        let all = sign_changes(sine, Range { low: -1.0, high: 7.0 }).expect("a sine");
        // Roots are refined to 1e-10 of the interval. The error of the derivative is of the order
        // of the squared step.
        let near = |root: &SignChange, at: f64, slope: f64| {
            (root.at - at).abs() < 1e-9 && (root.slope - slope).abs() < 1e-6
        };
        let expected = [(0.0, 1.0), (PI, -1.0), (2.0 * PI, 1.0)];
        assert!(all.roots.len() == 3, "{all:?}");
        assert!(all.roots.iter().zip(expected).all(|(r, (x, s))| near(r, x, s)), "{all:?}");
        assert!(
            all.share >= 1.0
                && all.values.is_some_and(|range| range.low < -0.99 && range.high > 0.99)
        );
        let part = |x: f64| sine(if x > 4.0 { f64::NAN } else { x });
        let part = sign_changes(part, Range { low: 1.0, high: 7.0 }).expect("a sine");
        assert!(part.roots.len() == 1 && near(&part.roots[0], PI, -1.0), "{part:?}");
        assert!((0.5..0.8).contains(&part.share), "{part:?}");
        let none =
            sign_changes(|_| sine(f64::NAN), Range { low: 1.0, high: 7.0 }).expect("no value");
        assert_eq!(
            none,
            SignChanges { roots: Vec::new(), jumps: Vec::new(), values: None, share: 0.0 }
        );
    }

    /// The parabola has its roots at both ends of the range, and is undefined outside the range.
    #[test]
    fn roots_at_both_ends_of_the_range_are_found() {
        let parabola = |x: f64| {
            let inside = (1.0..=4.0).contains(&x);
            Ok::<_, SearchError>(if inside { (x - 1.0) * (4.0 - x) } else { f64::NAN })
        };
        let found = sign_changes(parabola, Range { low: 1.0, high: 4.0 }).expect("a parabola");
        let expected = [(1.0, 3.0), (4.0, -3.0)];
        assert!(found.roots.len() == 2 && found.jumps.is_empty(), "{found:?}");
        for (root, (at, slope)) in found.roots.iter().zip(expected) {
            // The error of the one-sided difference is the step times half the second derivative.
            // The step is 1e-4 times the root, and half the second derivative is -1.
            assert!((root.at - at).abs() < 1e-12, "{found:?}");
            assert!((root.slope - slope).abs() < 1.1e-4 * at, "{found:?}");
        }
        let line = |x: f64| Ok::<_, SearchError>(2.0 * x);
        let found = sign_changes(line, Range { low: 0.0, high: 4.0 }).expect("a line");
        assert!(found.roots.len() == 1 && found.roots[0].at == 0.0, "{found:?}");
        assert!((found.roots[0].slope - 2.0).abs() < 1e-12, "{found:?}");
    }

    /// A jump from -1 to 2 does not count as a root, whether it occurs at 3 or at zero. A steep
    /// ramp at 3 has a root.
    #[test]
    fn a_jump_across_zero_does_not_count_as_a_root() {
        let step = |x: f64| Ok::<_, SearchError>(if x < 3.0 { -1.0 } else { 2.0 });
        let found = sign_changes(step, Range { low: 1.0, high: 7.0 }).expect("values");
        assert!(found.roots.is_empty(), "{found:?}");
        // The jump is located to the tolerance of the root finder.
        assert!(found.jumps.len() == 1 && (found.jumps[0] - 3.0).abs() < 1e-9, "{found:?}");
        let sign = |x: f64| Ok::<_, SearchError>(if x < 0.0 { -1.0 } else { 2.0 });
        let found = sign_changes(sign, Range { low: -1.0, high: 7.1 }).expect("values");
        assert!(found.roots.is_empty() && found.jumps.len() == 1, "{found:?}");
        let ramp = |x: f64| Ok::<_, SearchError>((1e3 * (x - 3.0)).clamp(-1.0, 2.0));
        let found = sign_changes(ramp, Range { low: 1.0, high: 7.0 }).expect("values");
        assert!(found.jumps.is_empty() && found.roots.len() == 1, "{found:?}");
    }

    /// The function is a parabola, which is undefined in part of the range. If the smallest value
    /// is at an end of the range, there is no minimum inside.
    #[test]
    fn a_smallest_value_at_an_end_of_the_range_is_not_a_minimum() {
        let parabola = |x: f64| Ok::<_, SearchError>((x - 2.0).powi(2) + 1.0);
        let Minimum { at: x, value } = minimum_inside(parabola, Range { low: 0.0, high: 5.0 })
            .expect("a parabola")
            .expect("a minimum");
        // A minimum can be located only to about the square root of the relative rounding error of
        // the function value.
        assert!((x - 2.0).abs() < 1e-7 && (value - 1.0).abs() < 1e-14, "{x} {value}");
        assert_eq!(
            minimum_inside(parabola, Range { low: 2.0, high: 5.0 }).expect("a parabola"),
            None
        );
        let hole = |x: f64| parabola(if x > 1.5 { f64::NAN } else { x });
        let Minimum { at: x, .. } = minimum_inside(hole, Range { low: 0.0, high: 5.0 })
            .expect("a parabola")
            .expect("next to a hole");
        assert!((x - 1.5).abs() < 1e-6, "{x}");
        assert_eq!(
            minimum_inside(|_| parabola(f64::NAN), Range { low: 0.0, high: 5.0 })
                .expect("no value"),
            None
        );
    }

    /// The expected minimum is the point nearest to (0.9, 0.9) on a disc of radius 0.3 around (0.5,
    /// 0.5). With the additional constraint x ≤ 0.6, the expected minimum is the intersection of
    /// both constraint boundaries.
    #[test]
    fn a_constrained_minimum_is_found() {
        let disc = |x: &[f64]| (x[0] - 0.5_f64).hypot(x[1] - 0.5) / 0.3 - 1.0;
        let distance = |x: &[f64]| (x[0] - 0.9).powi(2) + (x[1] - 0.9).powi(2);
        let one =
            minimize(|x| Value { objective: distance(x), violations: vec![disc(x)] }, &[0.1, 0.8]);
        let expected = 0.5 + 0.3 / 2.0_f64.sqrt();
        // The tolerance is the permitted constraint violation divided by the gradient of the
        // constraint.
        assert!(one.iter().all(|x| (x - expected).abs() < 1e-4), "{one:?}");
        let two = minimize(
            |x| Value { objective: distance(x), violations: vec![disc(x), x[0] - 0.6] },
            &[0.1, 0.8],
        );
        let expected = 0.5 + (0.09_f64 - 0.01).sqrt();
        assert!((two[0] - 0.6).abs() < 1e-4 && (two[1] - expected).abs() < 1e-4, "{two:?}");
    }

    /// The minimum is in a corner of the unit cube. The function is undefined in a region between
    /// the start and this corner.
    #[test]
    fn the_search_stays_in_the_unit_cube_and_avoids_undefined_points() {
        let found = minimize(
            |x| {
                let hole = x[0] > 0.3 && x[0] < 0.4 && x[1] < 0.5;
                let objective = if hole { f64::NAN } else { x[0] - x[1] };
                Value { objective, violations: Vec::new() }
            },
            &[0.7, 0.8],
        );
        assert!(found[0] < 1e-6 && found[1] > 1.0 - 1e-6, "{found:?}");
    }
}
