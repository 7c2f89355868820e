//! Sweeps from the first order to the root, for one point and for several side by side.
//!
//! Theory: `docs/theory/04-rigid.md`, equations (R24) to (R32).

use bsm_kin::Field;
use bsm_simd::Compare;

use super::ball::{RigidBall, RigidMotion, times};
use super::first_order::FirstOrder;
use super::sweep::SweepState;

/// Sweeps before a point is left to the search, and those after which an end at no root tells nothing: slow ones were
/// seen to pass by a root.
const MOST_SWEEPS: usize = 64;
const MOST_SWEEPS_TO_NO_ROOT: f64 = 24.0;

/// Largest ratio of inertia to friction. Up to there the sweeps found the root of the search at every one of 10 000
/// seeded points, in `sweeps_and_the_search_find_the_same_root`.
const MOST_INERTIA: f64 = 100.0;

/// What the directions may still change.
const CONVERGED: f64 = 1e-12;

/// Largest scaled residual of an answer, as that of Newton.
const RESIDUAL: f64 = 1e-10;

/// Nearer to a ball that does not circle, inertia may turn its way, and the search looks closer: this much,
/// or this much of twice the ratio of inertia to friction.
const LEAST_RATE: f64 = 0.1;

/// Where the sweeps of a point have ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sweeps<F: Field> {
    /// The motion, with loads and slip of any sign.
    pub motion: RigidMotion<F>,
    /// Scaled residual of the equations.
    pub residual: F,
    /// How many sweeps.
    pub count: F,
    /// Where directions of slip soon lead to themselves.
    pub stationary: F::Mask,
    /// Where it solves the equations, and is the root that the branch of small inertia meets.
    pub converged: F::Mask,
}

impl<F: Compare> RigidBall<F> {
    /// Sweeps from the first order on, as many as it takes.
    ///
    /// * `first`: of the same point.
    #[inline(always)]
    pub fn sweeps(&self, first: &FirstOrder<F>) -> Sweeps<F> {
        let one = self.constant(1.0);
        let inertia = first.inertia_scale / self.friction();
        let guided = first.pushes()
            & !first.has_high_multiplicity()
            & inertia.lt(self.constant(MOST_INERTIA));
        let (mut directions, mut last) = (first.next, first.change);
        let mut moving = guided;
        let mut count = one + 1.0;
        for _ in 0..MOST_SWEEPS {
            let state = self.sweep(&directions);
            let change = directions.farthest(&state.next);
            directions = directions.onward(moving, &state.next);
            count = F::select(moving, count + 1.0, count);
            // Geometric series: c/(1 − c) times the last change is left, c = change/last.
            let converges = (change * change).lt((last - change) * CONVERGED);
            moving = moving & !(converges | change.lt(self.constant(f64::EPSILON)));
            last = change;
            if !F::any(moving) {
                break;
            }
        }
        let motion = self.swept(&self.sweep(&directions));
        let residual = self.scaled_residual(&motion);
        let least_rate = F::select(inertia.lt(self.constant(0.5)), inertia * 2.0, one) * LEAST_RATE;
        let circles = motion.rate.abs().gt(least_rate);
        let ended = guided & !moving;
        let stationary = ended & count.lt(self.constant(MOST_SWEEPS_TO_NO_ROOT));
        let converged = ended & circles & residual.lt(self.constant(RESIDUAL));
        Sweeps { motion, residual, count, stationary, converged }
    }

    /// The motion of the last state.
    #[inline(always)]
    fn swept(&self, state: &SweepState<F>) -> RigidMotion<F> {
        let [norm_a, norm_b] = state.norms;
        let [pull_a, pull_b] = state.pulls;
        let twice = self.signed * 2.0;
        let loads = [
            -(pull_a * norm_a) / twice,
            state.unloaded * state.centrifugal,
            pull_b * norm_b / twice,
        ];
        let slip = (state.slip * norm_a, times(norm_a.recip(), state.nut));
        self.motion(loads, [state.p, state.rate], slip, state.s)
    }
}

impl<F: Compare> RigidMotion<F> {
    /// Where all contacts push and the slip at A is against its friction.
    #[inline(always)]
    pub fn is_admissible(&self) -> F::Mask {
        let zero = self.rate.constant(0.0);
        let [a, unloaded, b] = self.loads;
        a.gt(zero) & unloaded.gt(zero) & b.gt(zero) & self.speeds[0].gt(zero)
    }
}
