//! Sweeps from the first order to the root, for one point and for several side by side.
//!
//! Theory: `docs/theory/04-rigid.md`, equations (R24) to (R32).

use bsm_kin::Field;
use bsm_simd::Compare;

use super::ball::{RigidBall, RigidMotion, times};
use super::first_order::FirstOrder;
use super::sweep::SweepState;

/// Maximum number of sweeps; a point that needs more is left to the continuation.
const MAX_SWEEPS: usize = 64;

/// Maximum number of sweeps to a stationary state that tells something although it is no root: slower sweeps were seen to
/// pass by a root.
const MAX_SWEEPS_TO_NO_ROOT: f64 = 24.0;

/// Maximum ratio of inertia to friction at which converged sweeps are trusted: of 38 000 random points with ratios of 10 to
/// 1e4, each that converged had the first root of the branch of small inertia, or none where the branch had none.
/// `sweeps_find_the_root_of_the_continuation` repeats the comparison.
const MAX_INERTIA: f64 = 1e4;

/// Change of the directions that is left when the sweeps have converged.
const DIRECTION_TOL: f64 = 1e-12;

/// Maximum scaled residual of a root, as that of Newton's method.
const RESIDUAL_TOL: f64 = 1e-10;

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
        let guided = first.pushes() & inertia.lt(self.constant(MAX_INERTIA));
        let (mut directions, mut last) = (first.next, first.change);
        let mut moving = guided;
        let mut count = one + 1.0;
        for _ in 0..MAX_SWEEPS {
            let state = self.sweep(&directions);
            let change = directions.farthest(&state.next);
            directions = directions.onward(moving, &state.next);
            count = F::select(moving, count + 1.0, count);
            // Geometric series: c/(1 − c) times the last change is left, c = change/last.
            let converges = (change * change).lt((last - change) * DIRECTION_TOL);
            moving = moving & !(converges | change.lt(self.constant(f64::EPSILON)));
            last = change;
            if !F::any(moving) {
                break;
            }
        }
        let motion = self.swept(&self.sweep(&directions));
        let residual = self.scaled_residual(&motion);
        let ended = guided & !moving;
        let stationary = ended & count.lt(self.constant(MAX_SWEEPS_TO_NO_ROOT));
        let converged = ended & residual.lt(self.constant(RESIDUAL_TOL));
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
