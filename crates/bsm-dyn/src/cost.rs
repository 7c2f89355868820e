//! Cost of solves: numbers of model evaluations, quadrature nodes and searches.

use std::array::from_fn;
use std::cell::Cell;

thread_local! {
    static EVALUATIONS: Cell<usize> = const { Cell::new(0) };
    static NODES: Cell<usize> = const { Cell::new(0) };
    static SEARCHES: Cell<usize> = const { Cell::new(0) };
}

/// Cost of one or more solves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Cost {
    /// Number of evaluations of model equations, summed over all models and including evaluations
    /// during searches.
    pub evaluations: usize,
    /// Number of quadrature nodes of contact ellipses at which friction was evaluated.
    pub nodes: usize,
    /// Number of continuations, scans for other roots, and searches from scattered starting values.
    pub searches: usize,
}

/// Runs `work` and returns its result together with the cost of its solves on this thread.
pub fn cost_of<R>(work: impl FnOnce() -> R) -> (R, Cost) {
    let counts = || [EVALUATIONS.get(), NODES.get(), SEARCHES.get()];
    let before = counts();
    let result = work();
    let after = counts();
    let [evaluations, nodes, searches] = from_fn(|i| after[i].wrapping_sub(before[i]));
    (result, Cost { evaluations, nodes, searches })
}

/// Counts one evaluation of the equations of a model, for any scalar type.
#[inline]
pub(crate) fn count_evaluation() {
    EVALUATIONS.set(EVALUATIONS.get().wrapping_add(1));
}

/// Adds `nodes` to the number of quadrature nodes at which friction was evaluated.
#[inline]
pub(crate) fn count_nodes(nodes: usize) {
    NODES.set(NODES.get().wrapping_add(nodes));
}

/// Counts one search: a continuation, a scan for other roots, or a search from scattered starting
/// values.
pub(crate) fn count_search() {
    SEARCHES.set(SEARCHES.get().wrapping_add(1));
}

/// Converts a number of steps to an integer. If several points are solved side by side, steps are
/// counted in floating point.
pub(crate) fn count_of(steps: f64) -> usize {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a small whole number"
    )]
    let count = steps as usize;
    count
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::cost_of;
    use crate::extreme::random_practical_screw;
    use crate::{
        ElasticPoint, Model, ModelWorkspace, Problem, Status,
        model::{Elastic, RacewayControl, Rigid, Traction},
    };

    fn problem_for(model: Model, screw: ElasticPoint) -> Problem {
        let (accuracy, creep) = (Traction::ACCURACY, Traction::CREEP);
        match model {
            Model::RacewayControl => {
                Problem::RacewayControl(RacewayControl { screw, control: None })
            }
            Model::Elastic => Problem::Elastic(Elastic { screw }),
            Model::Traction => Problem::Traction(Traction { screw, accuracy, creep }),
            _ => Problem::Rigid(Rigid { point: screw.point }),
        }
    }

    /// Returns the median and the 99 % quantile of the number of evaluations at random practical
    /// points with a fixed seed.
    fn median_and_quantile(model: Model) -> [usize; 2] {
        const POINTS: usize = 300;
        let mut rng = ChaCha8Rng::seed_from_u64(1994);
        let mut work = ModelWorkspace::default();
        let mut counts = Vec::new();
        while counts.len() < POINTS {
            let screw = random_practical_screw(&mut rng);
            let mut count = |model| {
                let (solution, cost) = cost_of(|| problem_for(model, screw).solve(&mut work));
                (solution.status() == Status::Converged).then_some(cost.evaluations)
            };
            // As in the benchmarks, a random point is used only if the rigid model has a root at
            // this point.
            if count(Model::Rigid).is_some() {
                counts.push(count(model).expect("a practical point"));
            }
        }
        counts.sort_unstable();
        [counts[POINTS / 2], counts[POINTS * 99 / 100]]
    }

    /// This test detects changes that make a model slower without changing its results, for example
    /// if continuation is tried before Newton's method. The bounds are 1.5 times the measured
    /// median and the measured 99 % quantile, which the comments state in brackets.
    #[test]
    fn numbers_of_function_evaluations_of_each_model_stay_within_bounds() {
        let mut violations = Vec::new();
        for (model, bounds) in [
            // Model `rigid`: the solve consists of sweeps, and the last sweep calculates the
            // solution. Measured numbers of evaluations (median and 99 % quantile): [4, 7].
            (Model::Rigid, [6, 10]),
            // Model `raceway-control`: Newton's method has two unknowns, and every evaluation
            // calculates both contacts. Measured numbers of evaluations: [24, 28].
            (Model::RacewayControl, [36, 42]),
            // Model `elastic`: a solve calculates the beginning of the solution curve, applies
            // Newton's method to three unknowns, and checks the result with the seven equations.
            // Measured numbers of evaluations: [12, 13].
            (Model::Elastic, [18, 20]),
            // Model `traction`: Newton's method starts from the solution for a rolling ball and
            // uses first a coarse and then a fine quadrature. Measured numbers of evaluations: [34,
            // 39].
            (Model::Traction, [51, 60]),
        ] {
            let counted = median_and_quantile(model);
            let exceeds = counted[0] > bounds[0] || counted[1] > bounds[1];
            // A lower bound is checked as well, because the upper bounds would not reveal that
            // evaluations are no longer counted.
            if exceeds || counted[0] * 2 < bounds[0] {
                violations.push((model, counted, bounds));
            }
        }
        assert!(violations.is_empty(), "{violations:?}");
    }
}
