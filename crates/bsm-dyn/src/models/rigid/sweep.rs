//! One sweep of the fixed-point iteration, for one operating point or for several points side by
//! side in a SIMD vector. From given friction directions, a sweep calculates all unknowns and then
//! the friction directions for the next sweep.
//!
//! Theory: `docs/theory/04-rigid.md`, equations (R24) to (R32).

use bsm_kin::Real;

use super::ball::{Plane, RigidBall, times};
use crate::contact::Sines;
use crate::cost;

/// Friction directions, which are the unknowns of the fixed-point iteration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Directions<F> {
    /// Tangent of the angle between the slip at A (loaded flank of the nut) and the direction
    /// `$\psi$`.
    nut: F,
    /// Tangent of the angle between the slip at B (loaded flank of the screw) and the direction
    /// `$\psi$`.
    screw: F,
    /// Direction of the friction at A' (unloaded flank of the nut), with components along `$(e_x,
    /// t)$`.
    unloaded: Plane<F>,
    /// Correction of the force balance along the contact normal (R32).
    correction: F,
    /// Norms `$|A|$` and `$|B|$` of the slip directions at A and B before normalization.
    norms: [F; 2],
}

/// Values of the unknowns of the rigid model for given friction directions.
pub(super) struct SweepState<F> {
    /// Ratio of the load at A' (unloaded flank of the nut) to the centrifugal force, `$\kappa =
    /// Q_{A'}/M$`.
    pub(super) unloaded: F,
    /// Centrifugal force `$M = \mu (P/W)^2$`.
    pub(super) centrifugal: F,
    /// Precession rate relative to the nut `$p$`.
    pub(super) p: F,
    /// Absolute precession rate `$P/W$`.
    pub(super) rate: F,
    /// Slip speed at A (loaded flank of the nut), divided by the norm of `nut`.
    pub(super) slip: F,
    /// Spin moment `$s$` (R20).
    pub(super) s: F,
    /// Direction of the slip at A (loaded flank of the nut), not normalized.
    pub(super) nut: Plane<F>,
    /// Norms of the given slip directions at A and B.
    pub(super) norms: [F; 2],
    /// Friction forces `$G = -2 F Q_A/|A|$` and `$H = 2 F Q_B/|B|$` at A and B.
    pub(super) friction_forces: [F; 2],
    /// Friction directions of the next sweep.
    pub(super) next: Directions<F>,
}

/// Returns the scalar product of two vectors.
#[inline(always)]
fn dot<F: Real>(a: Plane<F>, b: Plane<F>) -> F {
    a[0].mul_add(b[0], a[1] * b[1])
}

/// Returns the cross product of two vectors. If `a` is a unit vector, this is the component of `b`
/// perpendicular to `a`.
#[inline(always)]
fn cross<F: Real>(a: Plane<F>, b: Plane<F>) -> F {
    a[1].neg_mul_add(b[0], a[0] * b[1])
}

/// Returns `a` where the mask is true and `b` elsewhere.
#[inline(always)]
fn pick<F: Real>(first: F::Mask, a: Plane<F>, b: Plane<F>) -> Plane<F> {
    [F::select(first, a[0], b[0]), F::select(first, a[1], b[1])]
}

impl<F: Real> RigidBall<F> {
    /// Returns the friction directions from which the iteration starts: slip along `$\psi$` at A
    /// and B, and slip due to the spin at A'.
    #[inline(always)]
    pub(super) fn start(&self) -> Directions<F> {
        let (zero, one) = (self.constant(0.0), self.constant(1.0));
        // The sign of the spin is the sign of p in (R13).
        let p = self.precession(zero, zero, [self.cos_psi, self.sin_psi], zero);
        let along = F::select((p + self.nut_speed).above(0.0), one, -one);
        let along = F::select(self.signed.below(0.0), -along, along);
        Directions {
            nut: zero,
            screw: zero,
            unloaded: [zero, along],
            correction: zero,
            norms: [one; 2],
        }
    }

    /// Returns the precession rate `$p$` relative to the nut (R26).
    ///
    /// * `e_1`, `e_2`: coefficients of the slip at A (R27).
    /// * `screw`: direction opposite to the slip at B.
    /// * `difference`: difference between the tangents at A and B, `$X = t_A - t_B$`.
    #[inline(always)]
    fn precession(&self, e_1: F, e_2: F, screw: Plane<F>, difference: F) -> F {
        // p = [(d − cosα cosβ) x_B − sinα y_B − e₂ ω X] / [2 d x_B − (e₁ − e₂) X]  (R26)
        let above = self.sines.sin_a.neg_mul_add(screw[1], (self.arc - self.k_e) * screw[0]);
        (e_2 * difference).neg_mul_add(self.nut_speed, above)
            / (e_1 - e_2).neg_mul_add(difference, (self.arc * 2.0) * screw[0])
    }

    /// Calculates all unknowns for given friction directions, and also the friction directions for
    /// the next sweep.
    #[inline(always)]
    pub(super) fn sweep(&self, given: &Directions<F>) -> SweepState<F> {
        cost::count_evaluation();
        let Sines { sin_a, cos_a, sin_b, cos_b } = self.sines;
        let (f, one) = (self.signed, self.constant(1.0));
        let (c, s_psi, h) = (self.cos_psi, self.sin_psi, self.h);
        let [cos_m, sin_m] = given.unloaded;
        // x_A = cosψ − t_A sinψ,  y_A = sinψ + t_A cosψ                   (R24)
        let nut = [given.nut.neg_mul_add(s_psi, c), given.nut.mul_add(c, s_psi)];
        let screw = [given.screw.neg_mul_add(s_psi, c), given.screw.mul_add(c, s_psi)];
        // κ = Q_A′/M follows from the force balance along N and along ψ   (R25)
        let below = (f * (c * self.cos_2b + f * self.sin_2b))
            .neg_mul_add(cos_m, (f * s_psi).neg_mul_add(sin_m, c * self.sin_2b - f * self.cos_2b));
        let unloaded = ((c * sin_b - f * cos_b) - given.correction) / below;
        // λ = e₁ p − e₂ P/W follows from the moment balance about N       (R27)
        let e_1 = sin_a * self.arc * self.per_h;
        let e_2 = (f * self.sin_2b * self.radius * self.per_h * 2.5) * (unloaded * sin_m);
        // X = t_A − t_B
        let difference = given.nut - given.screw;
        let p = self.precession(e_1, e_2, screw, difference);
        let rate = p + self.nut_speed;
        let slip = e_2.neg_mul_add(rate, e_1 * p);
        let (u, tau) = (-(slip * nut[0]), p.neg_mul_add(self.arc, slip * nut[1]));
        let centrifugal = self.inertia_ratio * rate * rate;
        let load = unloaded * centrifugal;
        let gyro = self.inertia * rate;
        // G = −2 F Q_A/|A| follows from the axial load                    (R28)
        let [norm_a, _] = given.norms;
        let carried = (f * h * s_psi).neg_mul_add(sin_m, (f * h * c).neg_mul_add(cos_m, self.k_n));
        let friction_a =
            (f * -2.0) * load.mul_add(carried, one) / norm_a.mul_add(self.k_n, -(f * h));
        // G x_A and H x_B follow from the force and moment balance across N  (R29), (R30)
        let common = centrifugal.neg_mul_add(sin_b, load * self.sin_2b);
        let (turning, rolling) = (gyro * tau, gyro * u);
        let friction = load * cos_m;
        let e_a = [
            (f * 2.0 * cos_b * cos_b).neg_mul_add(friction, turning.neg_mul_add(self.k_n, common)),
            rolling.neg_mul_add(cos_a / sin_b, turning * (sin_a * self.cot_b)),
        ];
        let e_b = [
            (f * 2.0 * sin_b * sin_b).mul_add(friction, turning.mul_add(self.k_n, common)),
            turning * (sin_a / self.cot_b),
        ];
        let psi = [c, s_psi];
        let along_a = dot(psi, e_a);
        let s = (friction_a - along_a) * self.per_h;
        let friction_b = dot(psi, e_b) + along_a - friction_a;
        // Friction directions for the next sweep                          (R31)
        let inverse = (friction_a * friction_b).recip();
        let tan_a = cross(psi, e_a) * (inverse * friction_b);
        let tan_b = cross(psi, e_b) * (inverse * friction_a);
        let across = rolling;
        let along = -s.mul_add(self.sin_2b, gyro.mul_add(self.arc * p, turning * self.cos_2b));
        let norm = dot([across, along], [across, along]).sqrt();
        let sign = F::select(rate.above(0.0), norm, -norm).recip();
        // [(|A| − 1) G + (|B| − 1) H]/(2 M)                               (R32)
        let (square_a, square_b) = (tan_a * tan_a, tan_b * tan_b);
        let norms = [(square_a + one).sqrt(), (square_b + one).sqrt()];
        let (one_a, one_b) = (norms[0] + one, norms[1] + one);
        let correction = dot([friction_a * square_a, friction_b * square_b], [one_b, one_a])
            / ((centrifugal * 2.0) * (one_a * one_b));
        SweepState {
            unloaded,
            centrifugal,
            p,
            rate,
            slip,
            s,
            nut,
            norms: given.norms,
            friction_forces: [friction_a, friction_b],
            next: Directions {
                nut: tan_a,
                screw: tan_b,
                unloaded: times(sign, [across, along]),
                correction,
                norms,
            },
        }
    }
}

impl<F: Real> Directions<F> {
    /// Returns the largest difference between corresponding components of two sets of friction
    /// directions.
    #[inline(always)]
    pub(super) fn max_change(&self, other: &Self) -> F {
        let turns = (self.nut - other.nut).abs().larger((self.screw - other.screw).abs());
        let x = (self.unloaded[0] - other.unloaded[0]).abs();
        let y = (self.unloaded[1] - other.unloaded[1]).abs();
        turns.larger(x.larger(y))
    }

    /// Returns the friction directions of `other` where `moving` is true, and the directions of
    /// `self` elsewhere.
    #[inline(always)]
    pub(super) fn updated(&self, moving: F::Mask, other: &Self) -> Self {
        Self {
            nut: F::select(moving, other.nut, self.nut),
            screw: F::select(moving, other.screw, self.screw),
            unloaded: pick(moving, other.unloaded, self.unloaded),
            correction: F::select(moving, other.correction, self.correction),
            norms: pick(moving, other.norms, self.norms),
        }
    }
}
