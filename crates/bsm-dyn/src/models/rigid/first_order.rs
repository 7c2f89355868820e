//! First-order solution of the rigid model for inertia forces that are small compared with the
//! load, and criteria for the existence and uniqueness of a root.
//!
//! Theory: `docs/theory/04-rigid.md`, equations (R13) to (R20), (R23), (R45).

use bsm_kin::Real;

use super::ball::RigidBall;
use super::sweep::Directions;

/// Largest ratio of inertia to the square of friction (dimensionless) at which a second root is
/// considered impossible. Among 4 million random points, the smallest ratio with a second root is
/// 23.
pub(super) const UNIQUE_INERTIA: f64 = 10.0;

/// Largest friction coefficient (dimensionless) in the random tests that determined
/// [`UNIQUE_INERTIA`].
pub(super) const UNIQUE_MAX_FRICTION: f64 = 0.15;

/// Largest multiplicity (dimensionless, R45) at which a second root is considered impossible for
/// steep contact angles. Among 4 million random points, the smallest multiplicity with a second
/// root is 142.
pub(super) const UNIQUE_MULTIPLICITY: f64 = 30.0;

/// Smallest friction coefficient (dimensionless) in the random tests that determined
/// [`UNIQUE_MULTIPLICITY`].
const UNIQUE_MIN_FRICTION: f64 = 1e-3;

/// Sine of the smallest contact angle that counts as steep (dimensionless). The angle is 44.4
/// degrees.
pub(super) const MIN_STEEP_SINE: f64 = 0.7;

/// Maximum ratio of normal load to axial load (dimensionless). Up to this ratio, rounding errors of
/// the loads do not affect whether the sweeps end at an admissible motion.
const MAX_SWEEP_LOAD_RATIO: f64 = 1e4;

/// Smallest precession rate `$|P/W|$` (dimensionless) in the random tests that determined
/// [`UNIQUE_INERTIA`] and [`UNIQUE_MULTIPLICITY`].
pub(super) const UNIQUE_MIN_RATE: f64 = 0.1;

/// First-order solution of the rigid model, valid for small inertia ratios.
///
/// The loads are exact to first order in `$\varepsilon = m r_m P^2/F_a$`, and the motion is exact
/// to zeroth order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstOrder<F: Real = f64> {
    /// Load ratio `$Q_A/F_a = Q_B/F_a$`; negative if the screw is self-locking.
    pub load: F,
    /// Load ratio `$q_{A'} = Q_{A'}/(\varepsilon F_a)$`; negative if the contact on the unloaded
    /// flank would have to act in tension.
    pub unloaded: F,
    /// Ratio of centrifugal force to axial load per ball `$\varepsilon = m r_m P^2/F_a$`.
    pub inertia: F,
    /// Magnitude of the inertia forces relative to the load `$\iota = \mu\max(1, (P/W)^2)$`. The
    /// relative error of the first-order solution is of the order of `$\iota/f$`.
    pub inertia_scale: F,
    /// Absolute precession rate `$P/W$`.
    pub rate: F,
    /// Precession rate relative to the nut `$p = (P - \Omega_n)/W$`.
    pub precession: F,
    /// Existence margin, which is positive if a root exists (to first order).
    pub sliding_margin: F,
    /// Slip speed at contact A, divided by `$r_b|W|$`, with the sign of `sliding_margin`.
    pub slip: F,
    /// Spin moment `$s = I P\sigma/(r_b F_a)$`.
    pub spin: F,
    /// Multiplicity number (R45). Several roots can exist only if this number is large.
    pub multiplicity: F,
    /// True if a second root is excluded by the limits found in random tests.
    pub is_unique: F::Mask,
    /// Friction directions that result from the first sweep.
    pub(super) next: Directions<F>,
    /// Largest change of the friction directions in the first sweep.
    pub(super) change: F,
}

impl<F: Real> RigidBall<F> {
    /// Returns the result of the first sweep. The sweep starts with slip along the screw axis at
    /// the contacts A and B, and with slip due to spin at the contact A'.
    #[inline(always)]
    pub fn first_order(&self) -> FirstOrder<F> {
        let start = self.start();
        // With |A| = |B| = 1, (R25), (R26) and (R27) reduce to (R15), (R13) and (R16); θ = ψ  (R19)
        let state = self.sweep(&start);
        // Q/F_a = 1/[cosα (sinβ − F D)], Eq (C4)                          (R17)
        let load = self.axial_load_ratio().recip();
        // P/W = p + Ω_n/W,  ε = μ (P/W)²                                  (R14)
        let (rate, inertia) = (state.rate, state.centrifugal);
        let inertia_scale = self.inertia_size(rate);
        let friction = self.friction();
        // C = q ι / (f (P/W)²)                                            (R45)
        let multiplicity = load.abs() * inertia_scale / (friction * rate.square());
        let little = inertia_scale.lt(friction * friction * UNIQUE_INERTIA)
            & friction.below(UNIQUE_MAX_FRICTION);
        let steep = self.sines.sin_b.above(MIN_STEEP_SINE)
            & friction.above(UNIQUE_MIN_FRICTION)
            & multiplicity.below(UNIQUE_MULTIPLICITY);
        let circles = rate.abs().above(UNIQUE_MIN_RATE);
        FirstOrder {
            load,
            unloaded: state.unloaded,
            inertia,
            inertia_scale,
            rate,
            precession: state.p,
            // λ = margin / [(r_b/r_m)(cosα cosβ + sinα T) cosψ]           (R18)
            sliding_margin: state.slip * self.h / self.radius,
            slip: state.slip,
            // s = −2 F q cosψ / (cosα cosβ)                               (R20)
            spin: load * self.signed * self.per_h * -2.0,
            multiplicity,
            is_unique: circles & (little | steep),
            next: state.next,
            change: start.max_change(&state.next),
        }
    }
}

impl<F: Real> FirstOrder<F> {
    /// Returns true if all contact loads in the first-order solution are positive (compressive).
    #[inline(always)]
    pub(super) fn has_compressive_loads(&self) -> F::Mask {
        self.load.above(0.0) & self.unloaded.above(0.0)
    }

    /// Returns true if the normal load is so small that rounding errors of the load do not affect
    /// the sweeps. The normal load is large near self-locking.
    #[inline(always)]
    pub fn is_accurate(&self) -> F::Mask {
        self.load.abs().below(MAX_SWEEP_LOAD_RATIO)
    }

    /// Returns true if a root exists according to the first-order solution: all contact loads are
    /// positive and the ball slides on the nut.
    #[inline(always)]
    pub fn root_exists(&self) -> F::Mask {
        self.has_compressive_loads() & self.slip.above(0.0)
    }
}
