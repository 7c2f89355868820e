//! Static balance of the rolling ball with two unknowns, solved by Newton's method for one
//! operating point or for several points side by side in a SIMD vector.
//!
//! Theory: `docs/theory/07-raceway-control.md`, equations (W2), (W12), (W13).

use bsm_kin::{Real, RealOver};
use bsm_newton::{LaneEquations, LaneIterate, LaneNewton, LaneStep};
use bsm_simd::{Lane, Simd, WithSimd};

use super::ball::RacewayBall;
use super::rolling::rolling_precession;
use crate::cost;
use crate::models::ball::{LoadedContact, ScaledBall};

/// Number of unknowns of the static balance: the difference of the cotangents of the contact
/// angles, and the cotangent at the screw (W12).
pub(crate) const STATIC_UNKNOWNS: usize = 2;

/// Limits of Newton's method for the static balance. Step lengths are changes of the contact angles
/// \[rad\]. After a step of 1e-9, the error is of the order of the square of the step. Points that
/// need more steps are solved by bracketing.
const NEWTON: LaneNewton = LaneNewton { step_tol: 1e-9, max_length: f64::INFINITY, max_steps: 6 };

/// Maximum number of steps in the solution of (W13) for the cotangent at the screw. Even if every
/// step were a bisection, the interval would shrink to the size of a rounding error.
const MAX_CLOSURE_STEPS: usize = 60;

/// Tolerance of the cotangent in the solution of (W13), relative to the cotangent of the unloaded
/// contact angle (dimensionless). The tolerance corresponds to a few rounding errors.
const CLOSURE_TOL: f64 = 4.0 * f64::EPSILON;

/// Maximum number of steps for calculating the upper bound (W18). Most points need two or three
/// steps. Points that need more steps are scanned for roots.
const MAX_UPPER_BOUND_STEPS: usize = 4;

/// Tolerance of the cotangent in the solution of (W13) for an upper bound, relative to the
/// cotangent of the unloaded contact angle (dimensionless). The bound is shifted by the tolerance,
/// so it remains an upper bound.
const BOUND_CLOSURE_TOL: f64 = 1e-3;

/// Static force balance of a ball with a given controlling raceway.
#[derive(Clone, Copy)]
pub(super) struct StaticBalance<P: Real> {
    /// True if the nut is the controlling raceway.
    pub(super) by_nut: P::Mask,
    /// Ratio `$1/\cos\alpha$` of the load component along the binormal to the axial load.
    pub(super) axial: P,
    /// Inertia coefficient `$\mu\cos\alpha$` of (W12).
    pub(super) inertia: P,
    /// Ratio `$(r_b/d)\cos\alpha$`.
    pub(super) lever: P,
    /// Ratio of nut speed to relative speed `$\Omega_n/W$`.
    pub(super) nut_speed: P,
    /// Radial distance `$A_2$` between the groove arc centers.
    pub(super) radial_distance: P,
    /// Distances `$l_0$` between the arc center and the ball center, and approaches under a normal
    /// load that equals the axial load per ball, at the nut and the screw.
    pub(super) contacts: [(P, P); 2],
    /// Cotangent of the unloaded contact angle.
    pub(super) unloaded_cot: P,
}

impl<P: Real> StaticBalance<P> {
    /// Creates the static balance of a ball.
    ///
    /// * `by_nut`: true if the nut is the controlling raceway.
    #[inline(always)]
    pub(super) fn of(ball: &RacewayBall<P>, by_nut: P::Mask) -> Self {
        let RacewayBall { scaled, unloaded_cot, .. } = *ball;
        let ScaledBall { lead: (_, cos), radius, nut_speed, radial_distance, .. } = scaled;
        let ([l_a, l_b], [d_a, d_b]) = (scaled.offsets, scaled.approaches);
        Self {
            by_nut,
            axial: cos.recip(),
            inertia: scaled.inertia_ratio() * cos,
            lever: cos * cos / radius,
            nut_speed,
            radial_distance,
            contacts: [(l_a, d_a), (l_b, d_b)],
            unloaded_cot,
        }
    }

    /// Returns the contact at the nut (0) or the screw (1) for a given cotangent of the contact
    /// angle.
    #[inline(always)]
    pub(super) fn contact<D: RealOver<P>>(&self, i: usize, cot: D) -> LoadedContact<D> {
        cost::count_evaluation();
        LoadedContact::without_friction(self.contacts[i], self.axial, cot)
    }

    /// Returns the contacts at the nut and the screw for given unknowns.
    #[inline(always)]
    pub(super) fn loaded<D: RealOver<P>>(
        &self,
        [c, screw]: [D; STATIC_UNKNOWNS],
    ) -> [LoadedContact<D>; 2] {
        [self.contact(0, screw + c), self.contact(1, screw)]
    }

    /// Returns the precession rate `$p$` of the rolling ball relative to the nut, divided by the
    /// relative speed.
    #[inline(always)]
    fn precession<D>(&self, [nut, screw]: &[LoadedContact<D>; 2]) -> D
    where
        D: RealOver<P> + Real<Mask = P::Mask>,
    {
        let between = nut.cos * screw.cos + nut.sin * screw.sin;
        rolling_precession(self.by_nut, self.lever, [nut.cos, screw.cos], between)
    }

    /// Returns the absolute precession rate `$P/W$` of the rolling ball.
    #[inline(always)]
    fn rate<D>(&self, contacts: &[LoadedContact<D>; 2]) -> D
    where
        D: RealOver<P> + Real<Mask = P::Mask>,
    {
        self.precession(contacts) + self.nut_speed
    }

    /// Returns the residuals of the radial force balance (W12) and of the radial closure of the
    /// groove arcs (W13).
    #[inline(always)]
    pub(super) fn residual<D>(&self, c: D, contacts: &[LoadedContact<D>; 2]) -> [D; STATIC_UNKNOWNS]
    where
        D: RealOver<P> + Real<Mask = P::Mask>,
    {
        let [nut, screw] = contacts;
        [
            // c − μ cosα (P/W)² = 0,  c = cotβ_A − cotβ_B                  (W12)
            c - self.rate(contacts).square() * self.inertia,
            // l_A cosβ_A + l_B cosβ_B = A₂, Eq (J7)                       (W13)
            (nut.radial_component() + screw.radial_component()) * self.radial_distance.recip()
                - 1.0,
        ]
    }
}

impl<F: Real> StaticBalance<F> {
    /// Maximum scaled residual of a root (dimensionless).
    pub(super) const RESIDUAL_TOL: f64 = 1e-12;

    /// Maximum inertia term (W17) (dimensionless) at which no ball has a second root. The smallest
    /// known value with a second root is 3.8, and (W15) proves uniqueness below 0.25.
    const UNIQUE_INERTIA: f64 = 2.0;

    /// Returns the starting value: contact angles that are equal except for the effect of the
    /// centrifugal force. If the centrifugal force is too large, its effect is ignored.
    ///
    /// * `requested`: mask of the points to iterate.
    #[inline(always)]
    pub(super) fn start(&self, requested: F::Mask) -> LaneIterate<F, STATIC_UNKNOWNS> {
        let zero = self.unloaded_cot.constant(0.0);
        let [nut, screw] = self.loaded([zero, self.unloaded_cot]);
        // The starting contact angle is calculated from the loads at the unloaded contact angle.
        let cos = self.radial_distance / (nut.length + screw.length);
        let cot = cos / ((-cos + 1.0) * (cos + 1.0)).sqrt();
        let rate = self.rate(&self.loaded([zero, cot]));
        let c = self.inertia * rate.square();
        let c = F::select(c.lt(cot), c, zero);
        LaneIterate::starting_at([c, cot - c * 0.5], requested)
    }

    /// Runs Newton's method until it converges or reaches its limits.
    #[inline(always)]
    pub(super) fn iterate(&self, at: &mut LaneIterate<F, STATIC_UNKNOWNS>) {
        NEWTON.iterate(self, at);
    }

    /// Returns the derivatives of the precession rate `$p$` with respect to the cotangents at the
    /// nut and the screw.
    #[inline(always)]
    fn precession_slopes(&self, p: F, [a, b]: &[LoadedContact<F>; 2]) -> [F; 2] {
        let (zero, one) = (p.constant(0.0), p.constant(1.0));
        let scale = (a.cos * b.cos + a.sin * b.sin + 1.0).recip();
        let sin_of_difference = b.sin * a.cos - b.cos * a.sin;
        // d cosβ = sin³β d cotβ,  d cos(β_A − β_B) = ∓sin²β sin(β_B − β_A) d cotβ
        let follow = F::select(self.by_nut, -p, one - p) * sin_of_difference;
        let (lift_a, lift_b) = (self.lever * a.sin, self.lever * b.sin);
        [
            -(a.sin.square() * (follow + F::select(self.by_nut, zero, lift_a)) * scale),
            b.sin.square() * (follow - F::select(self.by_nut, lift_b, zero)) * scale,
        ]
    }

    /// Returns the cotangent of the contact angle at the screw that satisfies (W13) for a given
    /// difference `c` of the cotangents.
    #[inline(always)]
    pub(super) fn screw_cotangent(&self, c: F) -> F {
        self.screw_cotangent_to(CLOSURE_TOL, c)
    }

    /// Solves (W13) by Newton's method with bisection, between zero and the cotangent of the
    /// unloaded contact angle. The left side of (W13) increases with the cotangent.
    ///
    /// * `tolerance`: tolerance relative to the cotangent of the unloaded contact angle.
    #[inline(always)]
    fn screw_cotangent_to(&self, tolerance: f64, c: F) -> F {
        let (zero, unloaded) = (c.constant(0.0), self.unloaded_cot);
        let (mut low, mut high, mut cot) = (zero, unloaded, unloaded * 0.5);
        let mut converged = zero.mask(false);
        for _ in 0..MAX_CLOSURE_STEPS {
            let [a, b] = self.loaded([c, cot]);
            let excess = a.radial_component() + b.radial_component() - self.radial_distance;
            let slope = a.radial_slope() + b.radial_slope();
            let beyond = excess.above(0.0);
            (low, high) = (F::select(beyond, low, cot), F::select(beyond, cot, high));
            let newton = cot - excess / slope;
            let inside = low.le(newton) & newton.le(high);
            let next = F::select(inside, newton, (low + high) * 0.5);
            let step = (next - cot).abs();
            cot = F::select(converged, cot, next);
            converged = converged | step.le(unloaded * tolerance);
            if !F::any(!converged) {
                break;
            }
        }
        cot
    }

    /// Returns the precession rate `$P/W$` for a given difference `c` of the cotangents.
    #[inline(always)]
    pub(super) fn rate_at(&self, c: F) -> F {
        self.rate(&self.loaded([c, self.screw_cotangent(c)]))
    }

    /// Returns true if a second root is excluded, either by (W17) or by (W15) evaluated at an upper
    /// bound (W18) of all roots.
    ///
    /// * `requested`: mask of the points for which a result is requested.
    #[inline(always)]
    pub(super) fn is_unique(&self, requested: F::Mask) -> F::Mask {
        let (nut, unloaded) = (self.nut_speed, self.unloaded_cot);
        let outwards = F::select(self.by_nut, nut + 1.0, self.lever - nut);
        // μ cosα ρ < 2, where ρ is an upper bound of |P|/W if |P| increases with c        (W17)
        let mut unique = (self.inertia * outwards).below(Self::UNIQUE_INERTIA);
        let mut bound = self.inertia * outwards.square();
        for _ in 0..MAX_UPPER_BOUND_STEPS {
            if !F::any(requested & !unique) {
                break;
            }
            let screw =
                self.screw_cotangent_to(BOUND_CLOSURE_TOL, bound) - unloaded * BOUND_CLOSURE_TOL;
            // A smaller cotangent at the screw gives a larger |P|. If the bound on c corresponds to
            // contact angles beyond the flanks, the cotangent is set to a small positive value.
            let at = [bound, screw.larger(unloaded * f64::EPSILON)];
            unique = unique | self.is_first(at);
            // c ← μ cosα (P(c)/W)²                                        (W18)
            bound = self.inertia * self.rate(&self.loaded(at)).square();
        }
        unique
    }

    /// Returns true if (W15) proves that no other root on the flanks has a smaller difference
    /// between the contact angles.
    #[inline(always)]
    pub(super) fn is_first(&self, [c, screw]: [F; STATIC_UNKNOWNS]) -> F::Mask {
        let one = c.constant(1.0);
        let contacts = self.loaded([c, screw]);
        let p = self.precession(&contacts);
        let ([a, b], rate) = (&contacts, p + self.nut_speed);
        let outwards = F::select(self.by_nut, rate, -rate);
        let part = F::select(self.by_nut, p, one - p);
        let half = (a.cos * b.cos + a.sin * b.sin + 1.0).recip();
        let sin_of_difference = b.sin * a.cos - b.cos * a.sin;
        // |∂p/∂cotβ| ≤ sin²β_B [ϖ tan(D/2) + (r_b/d) cosα sinβ_B/(1 + cosD)]  (W15)
        let slope = b.sin.square() * (part * sin_of_difference + self.lever * b.sin) * half;
        let falls = outwards.at_most(0.0);
        c.at_least(0.0)
            & screw.above(0.0)
            & (falls | (self.inertia * outwards * slope * 2.0).below(1.0))
    }

    /// Returns the scaled residual of the static balance for given unknowns.
    #[inline(always)]
    pub(super) fn scaled_residual(&self, [c, screw]: [F; STATIC_UNKNOWNS]) -> F {
        let [balance, closure] = self.residual(c, &self.loaded([c, screw]));
        (balance / self.inertia.larger(c.constant(1.0))).abs().larger(closure.abs())
    }
}

impl<F: Real> LaneEquations<F, STATIC_UNKNOWNS> for StaticBalance<F> {
    #[inline(always)]
    fn newton_step(&self, x: &[F; STATIC_UNKNOWNS]) -> LaneStep<F, STATIC_UNKNOWNS> {
        let contacts = self.loaded(*x);
        let [nut, screw] = &contacts;
        let [balance, closure] = self.residual(x[0], &contacts);
        let p = self.precession(&contacts);
        let [by_nut, by_screw] = self.precession_slopes(p, &contacts);
        let drift = self.inertia * (p + self.nut_speed) * -2.0;
        // The unknowns are c and the cotangent at the screw. Their sum is the cotangent at the nut.
        let (r_c, r_s) = (drift * by_nut + 1.0, drift * (by_nut + by_screw));
        let (l_c, l_b) = (
            nut.radial_slope() / self.radial_distance,
            screw.radial_slope() / self.radial_distance,
        );
        let l_s = l_c + l_b;
        let scale = (r_c * l_s - r_s * l_c).recip();
        let step_c = (closure * r_s - balance * l_s) * scale;
        let step_s = (balance * l_c - closure * r_c) * scale;
        // dβ = −sin²β d cotβ
        let at_nut = ((step_c + step_s) * nut.sin.square()).abs();
        let length = at_nut.larger((step_s * screw.sin.square()).abs());
        LaneStep { step: [step_c, step_s], length, is_defined: length.mask(true) }
    }
}

/// Evaluation of the precession rate `$P/W$` for increasing differences between the cotangents of
/// the contact angles. Above the largest difference that any root can have, the rate is not
/// evaluated but set to zero.
pub(super) struct Rates<'a, const N: usize> {
    pub(super) balance: &'a StaticBalance<f64>,
    /// Differences between the cotangents of the contact angles, in ascending order.
    pub(super) differences: &'a [f64; N],
}

impl<const N: usize> WithSimd for Rates<'_, N> {
    type Output = [f64; N];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [f64; N] {
        let Self { balance: one, differences } = self;
        let lane = Lane::<S>::splat(simd, one.unloaded_cot);
        let [nut, screw] = one.contacts;
        let balance = StaticBalance {
            by_nut: lane.mask(one.by_nut),
            axial: lane.constant(one.axial),
            inertia: lane.constant(one.inertia),
            lever: lane.constant(one.lever),
            nut_speed: lane.constant(one.nut_speed),
            radial_distance: lane.constant(one.radial_distance),
            contacts: [
                (lane.constant(nut.0), lane.constant(nut.1)),
                (lane.constant(screw.0), lane.constant(screw.1)),
            ],
            unloaded_cot: lane,
        };
        // The ratio |P|/W is at most max(|1 + ω|, |ω − (r_b/d) cosα|), so no root has a difference
        // of the cotangents above μ cosα times the square of this maximum.
        let fastest = (one.nut_speed + 1.0).abs().max((one.nut_speed - one.lever).abs());
        let mut rates = [0.0; N];
        for first in (0..N).step_by(Lane::<S>::LEN) {
            if differences[first] > one.inertia * fastest * fastest {
                break;
            }
            let c = Lane::load(simd, &differences[first..]);
            balance.rate_at(c).store(&mut rates[first..]);
        }
        rates
    }
}
