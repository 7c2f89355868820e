//! Fixed-point iteration from the first-order solution to the root, for one operating point or for
//! several points side by side in a SIMD vector.
//!
//! Theory: `docs/theory/04-rigid.md`, equations (R24) to (R32).

use bsm_kin::Real;
use bsm_newton::Convergence;

use super::ball::{RigidBall, RigidCoordinates, RigidMotion, times};
use super::first_order::FirstOrder;
use super::sweep::SweepState;

/// Maximum number of sweeps of the fixed-point iteration. Points that need more sweeps are solved
/// by continuation.
const MAX_SWEEPS: usize = 64;

/// If the sweeps become stationary after fewer than this number of sweeps, but not at a root, this
/// is evidence that there is no root. Iterations that need more sweeps can miss a root.
///
/// The limit is supported by 34 665 random points at which an independent search for all roots
/// found none (`docs/theory/04-rigid.md`, section on direct sweeps).
const MAX_SWEEPS_WITHOUT_ROOT: f64 = 24.0;

/// Maximum ratio of inertia force to friction force at which converged sweeps are accepted. The
/// limit was tested with 38 000 random points with ratios of 10 to 1e4. At all points where the
/// sweeps converged, they agreed with the branch that begins at zero inertia: they found its first
/// root, or no root if the branch has none. The test
/// `sweeps_that_converge_find_the_same_root_as_continuation` repeats the comparison.
const MAX_INERTIA: f64 = 1e4;

/// Tolerance of the friction directions (dimensionless). The sweeps stop if the estimated remaining
/// change is below the tolerance.
const DIRECTION_TOL: f64 = 1e-12;

/// Result of the fixed-point iteration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FixedPoint<F: Real> {
    /// Motion after the last sweep. Loads and slip may be positive or negative.
    pub motion: RigidMotion<F>,
    /// Largest scaled residual of the equations.
    pub residual: F,
    /// Number of sweeps of the fixed-point iteration.
    pub count: F,
    /// True if the friction directions became stationary within a few sweeps.
    pub stationary: F::Mask,
    /// True if the motion satisfies the equations. In this case, the motion is on the branch that
    /// begins at zero inertia.
    pub converged: F::Mask,
}

impl<F: Real> RigidBall<F> {
    /// Repeats sweeps, starting from the first-order solution of this ball, until the friction
    /// directions are stationary.
    #[inline(always)]
    pub fn fixed_point(&self, first: &FirstOrder<F>) -> FixedPoint<F> {
        let inertia = first.inertia_scale / self.friction();
        let guided = first.has_compressive_loads() & inertia.below(MAX_INERTIA);
        let (mut directions, mut last) = (first.next, first.change);
        let mut moving = guided;
        let mut count = self.constant(2.0);
        for _ in 0..MAX_SWEEPS {
            let state = self.sweep(&directions);
            let change = directions.max_change(&state.next);
            directions = directions.updated(moving, &state.next);
            count = F::select(moving, count + 1.0, count);
            // The changes approximately form a geometric series, so the remaining change is c/(1 −
            // c) times the last change, where c = change/last.
            let converges = (change * change).lt((last - change) * DIRECTION_TOL);
            moving = moving & !(converges | change.below(f64::EPSILON));
            last = change;
            if !F::any(moving) {
                break;
            }
        }
        let motion = self.motion_after(&self.sweep(&directions));
        let residual = self.scaled_residual(&motion);
        let ended = guided & !moving;
        let stationary = ended & count.below(MAX_SWEEPS_WITHOUT_ROOT);
        let converged = ended & residual.below(Convergence::RESIDUAL_TOL);
        FixedPoint { motion, residual, count, stationary, converged }
    }

    /// Returns the motion of the ball that corresponds to the state of a sweep.
    #[inline(always)]
    fn motion_after(&self, state: &SweepState<F>) -> RigidMotion<F> {
        let [norm_a, norm_b] = state.norms;
        let [friction_a, friction_b] = state.friction_forces;
        let twice = self.signed * 2.0;
        let loads = [
            -(friction_a * norm_a) / twice,
            state.unloaded * state.centrifugal,
            friction_b * norm_b / twice,
        ];
        self.motion(RigidCoordinates {
            loads,
            precession: state.p,
            rate: state.rate,
            slip: state.slip * norm_a,
            slip_direction: times(norm_a.recip(), state.nut),
            spin_moment: state.s,
        })
    }
}

impl<F: Real> FixedPoint<F> {
    /// Returns true if the sweeps have found a root, that is, converged to an admissible motion.
    #[inline(always)]
    pub fn is_root(&self) -> F::Mask {
        self.converged & self.motion.is_admissible()
    }
}

impl<F: Real> RigidMotion<F> {
    /// Returns true if all contact loads are positive and the slip at A is opposite to the friction
    /// at A.
    #[inline(always)]
    pub fn is_admissible(&self) -> F::Mask {
        let [a, unloaded, b] = self.loads;
        a.above(0.0) & unloaded.above(0.0) & b.above(0.0) & self.speeds[0].above(0.0)
    }
}
