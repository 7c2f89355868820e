//! The rigid model for inertia forces that are small against the load: the first sweep, and what it says
//! of existence.
//!
//! Theory: `docs/theory/04-rigid.md`, equations (R13) to (R20), (R23), (R45).

use bsm_simd::Compare;

use super::ball::RigidBall;
use super::sweep::Directions;

/// Multiplicity (R45) up to which no point was seen to have a second root: the least of those that have one
/// is 1.8.
const UNIQUE_MULTIPLICITY: f64 = 1.0;

/// Friction from which that is so: at a coefficient of 6e-6 a ball was seen to have a second root at a multiplicity of 0.08,
/// on an arc as short as friction is small.
pub(super) const UNIQUE_FROM: f64 = 1e-3;

/// Multiplicity (R45) from which second roots are looked for: below, one point in 10 000 has any.
pub(super) const SEARCHED_FROM: f64 = 300.0;

/// First-order solution in the inertia ratio.
///
/// Loads are exact to first order in `$\varepsilon = m r_m P^2/F_a$`, the motion to zeroth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstOrder<F = f64> {
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
    /// Coulomb coefficient `$f$`.
    pub friction: F,
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
            // C = q ι / (f (P/W)²)                                        (R45)
            multiplicity: load.abs() * inertia_scale / (self.friction() * rate.square()),
            friction: self.friction(),
            next: state.next,
            change: start.farthest(&state.next),
        }
    }
}

impl<F: Compare> FirstOrder<F> {
    /// Where second roots are looked for, and the sweeps do not say which root is meant.
    #[inline(always)]
    pub(super) fn has_high_multiplicity(&self) -> F::Mask {
        self.multiplicity.constant(SEARCHED_FROM).le(self.multiplicity)
    }

    /// Where the point is known to have no second root.
    #[inline(always)]
    pub fn is_unique(&self) -> F::Mask {
        self.multiplicity.lt(self.multiplicity.constant(UNIQUE_MULTIPLICITY))
            & self.friction.gt(self.multiplicity.constant(UNIQUE_FROM))
    }

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
