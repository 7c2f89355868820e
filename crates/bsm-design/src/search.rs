//! Searches for roots, and for minima by argmin.

use argmin::core::{CostFunction, Executor};
use argmin::solver::brent::BrentOpt;
use argmin::solver::neldermead::NelderMead;
use bsm_newton::{Bracket, Found};

pub use argmin::core::Error as SearchError;

/// A function of one variable for argmin.
struct OneVariable<F>(F);

impl<E: Into<SearchError>, F: Fn(f64) -> Result<f64, E>> CostFunction for OneVariable<F> {
    type Param = f64;
    type Output = f64;

    fn cost(&self, x: &f64) -> Result<f64, SearchError> {
        self.0(*x).map_err(Into::into)
    }
}

/// Root of `function` between two points of different sign.
///
/// # Errors
///
/// [`SearchError`] if the signs are equal, or `function` fails or returns NaN.
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
    let bracket = Bracket { x_tol: 1e-10, ..Bracket::new(ends, ends.map(&mut value)) };
    match bracket.root(value) {
        Found::Root(root) => Ok(root.x),
        none => Err(failure.unwrap_or_else(|| SearchError::msg(format!("no root: {none:?}")))),
    }
}

/// Minimum of `function` between two points.
///
/// # Errors
///
/// [`SearchError`] if `function` fails.
pub fn minimum_of<E: Into<SearchError>>(
    function: impl Fn(f64) -> Result<f64, E>,
    low: f64,
    high: f64,
) -> Result<f64, SearchError> {
    let found =
        Executor::new(OneVariable(function), BrentOpt::new(low, high).set_tolerance(1e-9, 1e-12))
            .configure(|state| state.max_iters(200))
            .run()?;
    Ok(found.state.best_param.unwrap_or(f64::NAN))
}

/// Objective and constraints at a point.
#[derive(Debug, Clone, PartialEq)]
pub struct Value {
    /// What is to be small.
    pub objective: f64,
    /// What must not be positive.
    pub excess: Vec<f64>,
}

/// Excess that counts as none.
pub const SLACK: f64 = 1e-4;

impl Value {
    /// True if all constraints hold within [`SLACK`].
    pub fn is_feasible(&self) -> bool {
        self.worst() <= SLACK
    }

    /// The largest excess, or 0.
    pub fn worst(&self) -> f64 {
        self.excess.iter().copied().fold(0.0, f64::max)
    }
}

/// Rounds of multipliers, and steps of the simplex in each for every corner of it.
const ROUNDS: usize = 7;
const STEPS: u64 = 25;

/// A minimum of the objective under the constraints near `start`, in the unit cube.
///
/// The augmented Lagrangian of Powell, Hestenes and Rockafellar, minimised by Nelder and Mead's
/// simplices of shrinking size: needs no derivatives, and forgives points that cannot be evaluated.
/// Source: Nocedal and Wright, *Numerical Optimization*, ch. 17.
pub fn minimise(function: impl Fn(&[f64]) -> Value, start: &[f64]) -> Vec<f64> {
    let mut best = start.to_vec();
    if start.is_empty() {
        return best;
    }
    let mut multipliers = vec![0.0; function(&inside(start)).excess.len()];
    let (mut weight, mut size) = (10.0, 0.25);
    let mut worst = f64::INFINITY;
    for _ in 0..ROUNDS {
        let lagrangian = |x: &[f64]| {
            let Value { objective, excess } = function(&inside(x));
            // f + Σ max(0, Λ + w g)² / 2w, and a wall around the cube
            let pull = |(g, m): (&f64, &f64)| (m + weight * finite(*g)).max(0.0).powi(2);
            let outside: f64 = x.iter().map(|x| (x - x.clamp(0.0, 1.0)).powi(2)).sum();
            let constraints: f64 = excess.iter().zip(&multipliers).map(pull).sum();
            finite(objective) + constraints / (2.0 * weight) + 1e3 * outside
        };
        best = inside(&simplex(&lagrangian, &best, size));
        let Value { excess, .. } = function(&best);
        for (multiplier, excess) in multipliers.iter_mut().zip(&excess) {
            *multiplier = (*multiplier + weight * finite(*excess)).max(0.0);
        }
        let now = excess.iter().map(|g| finite(*g)).fold(0.0, f64::max);
        if now > 0.3 * worst {
            weight *= 4.0;
        }
        (worst, size) = (now, (0.5 * size).max(0.01));
    }
    best
}

/// A number for what cannot be evaluated: bad, but no worse than very bad.
fn finite(x: f64) -> f64 {
    const VERY_BAD: f64 = 1e3;
    if x.is_nan() { VERY_BAD } else { x.clamp(-VERY_BAD, VERY_BAD) }
}

fn inside(x: &[f64]) -> Vec<f64> {
    x.iter().map(|x| x.clamp(0.0, 1.0)).collect()
}

/// Nelder and Mead's search from a simplex of this size.
fn simplex(function: &dyn Fn(&[f64]) -> f64, start: &[f64], size: f64) -> Vec<f64> {
    struct Cost<'a>(&'a dyn Fn(&[f64]) -> f64);

    impl CostFunction for Cost<'_> {
        type Param = Vec<f64>;
        type Output = f64;

        fn cost(&self, x: &Vec<f64>) -> Result<f64, SearchError> {
            Ok(self.0(x))
        }
    }

    let mut corners = vec![start.to_vec()];
    for i in 0..start.len() {
        let mut corner = start.to_vec();
        // Inwards, where there is room.
        corner[i] += if corner[i] > 0.5 { -size } else { size };
        corners.push(corner);
    }
    let steps = STEPS * corners.len() as u64;
    let found = NelderMead::new(corners)
        .with_sd_tolerance(1e-9)
        .and_then(|solver| {
            Executor::new(Cost(function), solver).configure(|state| state.max_iters(steps)).run()
        })
        .ok()
        .and_then(|found| found.state.best_param);
    found.unwrap_or_else(|| start.to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: the point of the disc of radius 0.3 about (0.5, 0.5) that is nearest to (0.9, 0.9), and
    /// with x ≤ 0.6 besides, the corner of both.
    #[test]
    fn a_constrained_minimum_is_found() {
        let disc = |x: &[f64]| (x[0] - 0.5_f64).hypot(x[1] - 0.5) / 0.3 - 1.0;
        let distance = |x: &[f64]| (x[0] - 0.9).powi(2) + (x[1] - 0.9).powi(2);
        let one =
            minimise(|x| Value { objective: distance(x), excess: vec![disc(x)] }, &[0.1, 0.8]);
        let expected = 0.5 + 0.3 / 2.0_f64.sqrt();
        // Slack of the constraints over their slope.
        assert!(one.iter().all(|x| (x - expected).abs() < 1e-4), "{one:?}");
        let two = minimise(
            |x| Value { objective: distance(x), excess: vec![disc(x), x[0] - 0.6] },
            &[0.1, 0.8],
        );
        let expected = 0.5 + (0.09_f64 - 0.01).sqrt();
        assert!((two[0] - 0.6).abs() < 1e-4 && (two[1] - expected).abs() < 1e-4, "{two:?}");
    }

    /// A minimum in a corner of the cube, next to points that cannot be evaluated.
    #[test]
    fn the_cube_and_holes_are_kept() {
        let found = minimise(
            |x| {
                let hole = x[0] > 0.3 && x[0] < 0.4 && x[1] < 0.5;
                let objective = if hole { f64::NAN } else { x[0] - x[1] };
                Value { objective, excess: Vec::new() }
            },
            &[0.7, 0.8],
        );
        assert!(found[0] < 1e-6 && found[1] > 1.0 - 1e-6, "{found:?}");
    }
}
