//! The rigid model for inertia forces that are small against the load: the first sweep, and what it says
//! of existence.
//!
//! Theory: `docs/theory/04-rigid.md`, equations (R13) to (R20), (R23), (R45).

use bsm_kin::Field;
use bsm_simd::Compare;

use super::ball::RigidBall;
use super::sweep::Directions;

/// Maximum ratio of inertia to the square of friction at which no point has a second root; the smallest ratio of 4 million
/// points with a second root is 23.
pub(super) const UNIQUE_INERTIA: f64 = 10.0;

/// Maximum friction coefficient up to which [`UNIQUE_INERTIA`] was measured.
pub(super) const UNIQUE_MAX_FRICTION: f64 = 0.15;

/// Maximum multiplicity (R45) at which no point has a second root if the contact angle is steep; the smallest multiplicity
/// of 4 million points with a second root is 142.
pub(super) const UNIQUE_MULTIPLICITY: f64 = 30.0;

/// Minimum friction coefficient from which [`UNIQUE_MULTIPLICITY`] was measured.
const UNIQUE_MIN_FRICTION: f64 = 1e-3;

/// Sine of the contact angle, 44.4 deg, above which it is steep.
pub(super) const STEEP: f64 = 0.7;

/// Minimum precession `$|P/W|$` for which both limits were measured.
pub(super) const UNIQUE_MIN_RATE: f64 = 0.1;

/// First-order solution in the inertia ratio.
///
/// Loads are exact to first order in `$\varepsilon = m r_m P^2/F_a$`, the motion to zeroth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstOrder<F: Field = f64> {
    /// `$Q_A/F_a = Q_B/F_a$`; negative means self-locking.
    pub load: F,
    /// `$q_{A'} = Q_{A'}/(\varepsilon F_a)$`; negative means that A' would have to act in tension.
    pub unloaded: F,
    /// `$\varepsilon = m r_m P^2/F_a$`, the centrifugal force over the load.
    pub inertia: F,
    /// `$\iota = \mu\max(1, (P/W)^2)$`, the size of the inertia forces over the load; over `$f$`
    /// it is the relative error of the first order.
    pub inertia_scale: F,
    /// Absolute precession over relative speed, `$P/W$`.
    pub rate: F,
    /// Precession relative to the nut over relative speed, `$p$`.
    pub precession: F,
    /// Existence margin: a finite root needs it positive.
    pub sliding_margin: F,
    /// Slip at A over `$r_b|W|$`, of the sign of `sliding_margin`.
    pub slip: F,
    /// Spin moment `$s = I P\sigma/(r_b F_a)$`.
    pub spin: F,
    /// Inertia forces times the load of a contact, over friction and over `$(P/W)^2$`: what roots have to
    /// exceed to be several.
    pub multiplicity: F,
    /// Where the point is known to have no second root.
    pub is_unique: F::Mask,
    /// The directions that the first sweep leads to, and how far they are from those that it began with.
    pub(super) next: Directions<F>,
    pub(super) change: F,
}

impl<F: Compare> RigidBall<F> {
    /// The first sweep: that of a ball that slides along the axis at A and B and spins at A'.
    #[inline(always)]
    pub fn first_order(&self) -> FirstOrder<F> {
        let start = self.start();
        // (R25), (R26) and (R27) are (R15), (R13) and (R16) here, over |A| = |B| = 1; θ = ψ  (R19)
        let state = self.sweep(&start);
        // Q/F_a = 1/[cosα (sinβ − F D)], Eq (C4)                          (R17)
        let load = self.held_load().recip();
        // P/W = p + Ω_n/W,  ε = μ (P/W)²                                  (R14)
        let (rate, inertia) = (state.rate, state.centrifugal);
        let inertia_scale = self.inertia_size(rate);
        let friction = self.friction();
        // C = q ι / (f (P/W)²)                                            (R45)
        let multiplicity = load.abs() * inertia_scale / (friction * rate.square());
        let little = inertia_scale.lt(friction * friction * UNIQUE_INERTIA)
            & friction.lt(self.constant(UNIQUE_MAX_FRICTION));
        let steep = self.sines.sin_b.gt(self.constant(STEEP))
            & friction.gt(self.constant(UNIQUE_MIN_FRICTION))
            & multiplicity.lt(self.constant(UNIQUE_MULTIPLICITY));
        let circles = rate.abs().gt(self.constant(UNIQUE_MIN_RATE));
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
            change: start.farthest(&state.next),
        }
    }
}

impl<F: Compare> FirstOrder<F> {
    /// Where the contacts push to first order.
    #[inline(always)]
    pub(super) fn pushes(&self) -> F::Mask {
        let zero = self.load.constant(0.0);
        self.load.gt(zero) & self.unloaded.gt(zero)
    }

    /// Where a finite root exists, to first order: the contacts push and the ball slides on the nut.
    #[inline(always)]
    pub fn exists(&self) -> F::Mask {
        self.pushes() & self.slip.gt(self.slip.constant(0.0))
    }
}
