//! Static balance of the rolling ball in two unknowns, solved by Newton's method, for one point or
//! for several points side by side.
//!
//! Theory: `docs/theory/07-raceway-control.md`, equations (W2), (W12), (W13).

use bsm_kin::{Field, FieldOver};
use bsm_simd::{Compare, Lane, Simd, WithSimd};

use super::rolling::rolling_precession;
use crate::cost;
use crate::models::ball::{LoadedContact, ScaledBall};

/// Unknowns: the difference of the cotangents of the contact angles, and that at the screw (W12).
pub(crate) const STATIC: usize = 2;

/// Newton steps before a root is looked for in another way.
const MOST_STATIC_STEPS: usize = 6;

/// Steps to a closed triangle: as many halvings lead to rounding, and what that is.
const MOST_CLOSING: usize = 60;
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Passes of the falling bound (W18) before roots are counted by a scan: most need two or three.
const MOST_FALLING: usize = 4;

/// How exactly the triangle is closed at a bound, which is a bound with this error too.
const BOUNDED: f64 = 1e-3;

/// Last step of an angle \[rad\]: the error behind it is of the order of its square.
const LAST_STEP: f64 = 1e-9;

/// Static balance of a ball with a raceway in control.
#[derive(Clone, Copy)]
pub struct StaticBalance<P: Field> {
    /// Where the nut controls.
    pub by_nut: P::Mask,
    /// `$1/\cos\alpha$`.
    pub(super) axial: P,
    /// `$\mu\cos\alpha$`.
    pub(super) inertia: P,
    /// `$(r_b/d)\cos\alpha$`.
    pub(super) lever: P,
    /// `$\Omega_n/W$`.
    pub(super) nut_speed: P,
    /// `$A_2$`.
    pub(super) radial_distance: P,
    /// `$l_0$` and `$\delta$` of the axial load, at nut and screw.
    pub(super) contacts: [(P, P); 2],
}

/// An iterate: the difference of the cotangents of the contact angles, and that at the screw.
#[derive(Clone, Copy)]
pub struct StaticState<F: Field> {
    /// The unknowns.
    pub unknowns: [F; STATIC],
    /// Newton steps.
    pub steps: F,
    /// Where no step is left to take.
    pub converged: F::Mask,
}

impl<P: Field> StaticBalance<P> {
    /// Of a ball and the raceway in control.
    #[inline(always)]
    pub fn of(ball: &ScaledBall<P>, by_nut: P::Mask) -> Self {
        let &ScaledBall { lead: (_, cos), radius, nut_speed, radial_distance, .. } = ball;
        let ([l_a, l_b], [d_a, d_b]) = (ball.offsets, ball.approaches);
        Self {
            by_nut,
            axial: cos.recip(),
            inertia: ball.inertia_ratio() * cos,
            lever: cos * cos / radius,
            nut_speed,
            radial_distance,
            contacts: [(l_a, d_a), (l_b, d_b)],
        }
    }

    /// The contact at nut (0) or screw (1) with this cotangent of its angle.
    #[inline(always)]
    pub(super) fn contact<D: FieldOver<P>>(&self, i: usize, cot: D) -> LoadedContact<D> {
        cost::evaluated();
        LoadedContact::without_friction(self.contacts[i], self.axial, cot)
    }

    /// Both contacts.
    #[inline(always)]
    pub fn loaded<D: FieldOver<P>>(&self, [c, screw]: [D; STATIC]) -> [LoadedContact<D>; 2] {
        [self.contact(0, screw + c), self.contact(1, screw)]
    }

    /// `$p$` of the rolling ball.
    #[inline(always)]
    pub fn precession<D>(&self, [nut, screw]: &[LoadedContact<D>; 2]) -> D
    where
        D: FieldOver<P> + Field<Mask = P::Mask>,
    {
        let between = nut.cos * screw.cos + nut.sin * screw.sin;
        rolling_precession(self.by_nut, self.lever, [nut.cos, screw.cos], between)
    }

    /// `$P/W$` of the rolling ball.
    #[inline(always)]
    pub(super) fn rate<D>(&self, contacts: &[LoadedContact<D>; 2]) -> D
    where
        D: FieldOver<P> + Field<Mask = P::Mask>,
    {
        self.precession(contacts) + self.nut_speed
    }

    /// What contacts leave of the radial balance and of the triangle of the arc centres (W12), (W13).
    #[inline(always)]
    pub(super) fn residual<D>(&self, c: D, contacts: &[LoadedContact<D>; 2]) -> [D; STATIC]
    where
        D: FieldOver<P> + Field<Mask = P::Mask>,
    {
        let [nut, screw] = contacts;
        [
            // c − μ cosα (P/W)² = 0,  c = cotβ_A − cotβ_B                  (W12)
            c - self.rate(contacts).square() * self.inertia,
            // l_A cosβ_A + l_B cosβ_B = A₂, Eq (J7)                       (W13)
            (nut.radial_distance() + screw.radial_distance()) * self.radial_distance.recip() - 1.0,
        ]
    }
}

impl<F: Compare> StaticBalance<F> {
    /// Largest scaled residual of a root.
    pub const CLOSED: f64 = 1e-12;

    /// Inertia (W17) up to which no ball was seen to have a second root: the least of those that have one is
    /// 3.8, and (W15) excludes one below 0.25.
    const UNIQUE_INERTIA: f64 = 2.0;

    /// Equal angles, turned apart by their centrifugal force unless that is too much.
    ///
    /// * `unloaded`: cotangent of the unloaded contact angle. * `expected`: where a root is looked for.
    #[inline(always)]
    pub fn start(&self, unloaded: F, expected: F::Mask) -> StaticState<F> {
        let zero = unloaded.constant(0.0);
        let [nut, screw] = self.loaded([zero, unloaded]);
        // The angle that the loads of the unloaded angle lead to.
        let cos = self.radial_distance / (nut.length + screw.length);
        let cot = cos / ((-cos + 1.0) * (cos + 1.0)).sqrt();
        let rate = self.rate(&self.loaded([zero, cot]));
        let c = self.inertia * rate.square();
        let c = F::select(c.lt(cot), c, zero);
        StaticState { unknowns: [c, cot - c * 0.5], steps: zero, converged: !expected }
    }

    /// Newton steps where none has been the last.
    #[inline(always)]
    pub fn iterate(&self, at: &mut StaticState<F>) {
        for _ in 0..MOST_STATIC_STEPS {
            if !F::any(!at.converged) {
                break;
            }
            let contacts = self.loaded(at.unknowns);
            let [nut, screw] = &contacts;
            let [radial, radial_distance] = self.residual(at.unknowns[0], &contacts);
            let p = self.precession(&contacts);
            let [by_nut, by_screw] = self.precession_slopes(p, &contacts);
            let drift = self.inertia * (p + self.nut_speed) * -2.0;
            // By c, of which the cotangent at the nut is a sum, and by the cotangent at the screw.
            let (r_c, r_s) = (drift * by_nut + 1.0, drift * (by_nut + by_screw));
            let (l_c, l_b) = (
                nut.radial_slope() / self.radial_distance,
                screw.radial_slope() / self.radial_distance,
            );
            let l_s = l_c + l_b;
            let scale = (r_c * l_s - r_s * l_c).recip();
            let step_c = (radial * l_s - radial_distance * r_s) * scale;
            let step_s = (radial_distance * r_c - radial * l_c) * scale;
            // dβ = −sin²β d cotβ
            let angle_step = ((step_c + step_s) * nut.sin.square()).abs();
            let angle_step = angle_step.larger((step_s * screw.sin.square()).abs());
            let [c, s] = at.unknowns;
            at.unknowns =
                [F::select(at.converged, c, c - step_c), F::select(at.converged, s, s - step_s)];
            at.steps = F::select(at.converged, at.steps, at.steps + 1.0);
            at.converged = at.converged | angle_step.lt(angle_step.constant(LAST_STEP));
        }
    }

    /// Derivatives of `$p$` by the cotangents at nut and screw.
    #[inline(always)]
    fn precession_slopes(&self, p: F, [a, b]: &[LoadedContact<F>; 2]) -> [F; 2] {
        let (zero, one) = (p.constant(0.0), p.constant(1.0));
        let scale = (a.cos * b.cos + a.sin * b.sin + 1.0).recip();
        let twist = b.sin * a.cos - b.cos * a.sin;
        // d cosβ = sin³β d cotβ,  d cos(β_A − β_B) = ∓sin²β sin(β_B − β_A) d cotβ
        let follow = F::select(self.by_nut, -p, one - p) * twist;
        let (lift_a, lift_b) = (self.lever * a.sin, self.lever * b.sin);
        [
            -(a.sin.square() * (follow + F::select(self.by_nut, zero, lift_a)) * scale),
            b.sin.square() * (follow - F::select(self.by_nut, lift_b, zero)) * scale,
        ]
    }

    /// Cotangent of the screw's contact angle that closes the triangle at a difference `c`.
    #[inline(always)]
    pub(super) fn closed(&self, c: F, unloaded: F) -> F {
        self.closed_to(ROUNDING, c, unloaded)
    }

    /// The same to a part of the cotangent of the unloaded angle, by Newton within zero and that: (W13) rises with it.
    #[inline(always)]
    fn closed_to(&self, part: f64, c: F, unloaded: F) -> F {
        let zero = c.constant(0.0);
        let (mut low, mut high, mut cot) = (zero, unloaded, unloaded * 0.5);
        let mut converged = zero.lt(zero);
        for _ in 0..MOST_CLOSING {
            let [a, b] = self.loaded([c, cot]);
            let excess = a.radial_distance() + b.radial_distance() - self.radial_distance;
            let slope = a.radial_slope() + b.radial_slope();
            let beyond = excess.gt(zero);
            (low, high) = (F::select(beyond, low, cot), F::select(beyond, cot, high));
            let newton = cot - excess / slope;
            let inside = low.le(newton) & newton.le(high);
            let next = F::select(inside, newton, (low + high) * 0.5);
            let step = (next - cot).abs();
            cot = F::select(converged, cot, next);
            converged = converged | step.le(unloaded * part);
            if !F::any(!converged) {
                break;
            }
        }
        cot
    }

    /// `$P/W$` at a difference of the cotangents.
    #[inline(always)]
    pub(super) fn rate_at(&self, c: F, unloaded: F) -> F {
        self.rate(&self.loaded([c, self.closed(c, unloaded)]))
    }

    /// Where (W17) leaves no second root, or bounds (W18) of all roots fall to where (W15) leaves one.
    ///
    /// * `unloaded`: cotangent of the unloaded contact angle. * `expected`: where it is asked.
    #[inline(always)]
    pub fn is_unique(&self, unloaded: F, expected: F::Mask) -> F::Mask {
        let nut = self.nut_speed;
        let outwards = F::select(self.by_nut, nut + 1.0, self.lever - nut);
        // μ cosα |P|/W < 2, with the largest |P| that may still rise      (W17)
        let mut unique = (self.inertia * outwards).lt(nut.constant(Self::UNIQUE_INERTIA));
        let mut bound = self.inertia * outwards.square();
        for _ in 0..MOST_FALLING {
            if !F::any(expected & !unique) {
                break;
            }
            let screw = self.closed_to(BOUNDED, bound, unloaded) - unloaded * BOUNDED;
            // A flatter angle has a larger |P|, and there is one where the bound is beyond the flanks.
            let at = [bound, screw.larger(unloaded * f64::EPSILON)];
            unique = unique | self.is_first(at);
            // c ← μ cosα (P(c)/W)²                                        (W18)
            bound = self.inertia * self.rate(&self.loaded(at)).square();
        }
        unique
    }

    /// Where (W15) shows that no other root on the flanks has a smaller difference of the angles.
    #[inline(always)]
    pub fn is_first(&self, [c, screw]: [F; STATIC]) -> F::Mask {
        let (zero, one) = (c.constant(0.0), c.constant(1.0));
        let contacts = self.loaded([c, screw]);
        let p = self.precession(&contacts);
        let ([a, b], rate) = (&contacts, p + self.nut_speed);
        let outwards = F::select(self.by_nut, rate, -rate);
        let part = F::select(self.by_nut, p, one - p);
        let half = (a.cos * b.cos + a.sin * b.sin + 1.0).recip();
        let twist = b.sin * a.cos - b.cos * a.sin;
        // |∂p/∂cotβ| ≤ sin²β_B [π tan(D/2) + (r_b/d) cosα sinβ_B/(1 + cosD)]  (W15)
        let slope = b.sin.square() * (part * twist + self.lever * b.sin) * half;
        let falls = outwards.le(zero);
        zero.le(c) & screw.gt(zero) & (falls | (self.inertia * outwards * slope * 2.0).lt(one))
    }

    /// Scaled residual of a state.
    #[inline(always)]
    pub fn scaled_residual(&self, [c, screw]: [F; STATIC]) -> F {
        let [radial, radial_distance] = self.residual(c, &self.loaded([c, screw]));
        (radial / self.inertia.larger(c.constant(1.0))).abs().larger(radial_distance.abs())
    }
}

/// `$P/W$` of a balance at several differences of the cotangents that grow; zero where the flanks hold more than any ball
/// pulls.
///
/// * `unloaded`: cotangent of the unloaded contact angle.
pub(super) struct Rates<'a, const N: usize> {
    pub(super) balance: &'a StaticBalance<f64>,
    pub(super) differences: &'a [f64; N],
    pub(super) unloaded: f64,
}

impl<const N: usize> WithSimd for Rates<'_, N> {
    type Output = [f64; N];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [f64; N] {
        let Self { balance: one, differences, unloaded } = self;
        let lane = Lane::<S>::splat(simd, unloaded);
        let [nut, screw] = one.contacts;
        let balance = StaticBalance {
            by_nut: if one.by_nut { lane.le(lane) } else { lane.lt(lane) },
            axial: lane.constant(one.axial),
            inertia: lane.constant(one.inertia),
            lever: lane.constant(one.lever),
            nut_speed: lane.constant(one.nut_speed),
            radial_distance: lane.constant(one.radial_distance),
            contacts: [
                (lane.constant(nut.0), lane.constant(nut.1)),
                (lane.constant(screw.0), lane.constant(screw.1)),
            ],
        };
        // |P|/W ≤ max(|1 + ω|, |ω − (r_b/d) cosα|): the line c is above all that it can be beyond the square of that.
        let fastest = (one.nut_speed + 1.0).abs().max((one.nut_speed - one.lever).abs());
        let mut rates = [0.0; N];
        for first in (0..N).step_by(Lane::<S>::LEN) {
            if differences[first] > one.inertia * fastest * fastest {
                break;
            }
            let c = Lane::load(simd, &differences[first..]);
            balance.rate_at(c, lane).store(&mut rates[first..]);
        }
        rates
    }
}
