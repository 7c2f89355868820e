//! The rigid model for inertia forces that are small against the load: the first sweep, and what it says
//! of existence.
//!
//! Theory: `docs/theory/04-rigid.md`, equations (R13) to (R20), (R23), (R45).

use bsm_kin::Field;
use bsm_simd::Compare;

use super::ball::RigidBall;
use super::sweep::Directions;

/// Ratio of inertia to the square of friction, for friction up to a limit, up to which no point was seen to have a
/// second root: the least of those that have one is 23.
pub(super) const UNIQUE_INERTIA: f64 = 10.0;
pub(super) const UNIQUE_MOST_FRICTION: f64 = 0.15;

/// The same of the multiplicity (R45) for friction from a limit and contact angles of more than 44.4 deg, by their sine:
/// the least is 142.
const UNIQUE_LEAST_FRICTION: f64 = 1e-3;
pub(super) const UNIQUE_MULTIPLICITY: f64 = 30.0;
pub(super) const STEEP: f64 = 0.7;

/// Both for a ball that circles faster than this.
pub(super) const UNIQUE_LEAST_RATE: f64 = 0.1;

/// Multiplicity (R45) from which second roots are looked for: below, three to six points in 10 000 have any.
pub(super) const SEARCHED_FROM: f64 = 300.0;

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
            & friction.lt(self.constant(UNIQUE_MOST_FRICTION));
        let steep = self.sines.sin_b.gt(self.constant(STEEP))
            & friction.gt(self.constant(UNIQUE_LEAST_FRICTION))
            & multiplicity.lt(self.constant(UNIQUE_MULTIPLICITY));
        let circles = rate.abs().gt(self.constant(UNIQUE_LEAST_RATE));
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
    /// Where second roots are looked for, and the sweeps do not say which root is meant.
    #[inline(always)]
    pub(super) fn has_high_multiplicity(&self) -> F::Mask {
        self.multiplicity.constant(SEARCHED_FROM).le(self.multiplicity)
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
