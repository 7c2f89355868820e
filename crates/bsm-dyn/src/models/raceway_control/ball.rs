//! The ball in the raceway-control model, and the criterion that selects its controlling raceway.
//!
//! Theory: `docs/theory/07-raceway-control.md`, equations (W7), (W16).

use bsm_kin::{Real, Scalar};

use super::rolling::rolling;
use crate::models::ball::{BallContacts, ElasticContacts, LoadedContact, ScaledBall};

/// Minimum ratio of the relative difference of the spin moments to `$\Delta c$` (W16)
/// (dimensionless). Above this ratio, (W7) selects the same controlling raceway for the
/// nut-controlled and for the screw-controlled ball. The limit exceeds one because (W16) neglects
/// terms of higher order.
const CONTROL_MARGIN: f64 = 4.0;

/// A ball between elastic raceways with the inputs of the raceway-control model, for one operating
/// point or for several points side by side in a SIMD vector.
#[derive(Debug, Clone, Copy)]
pub struct RacewayBall<P> {
    /// The ball in scaled units.
    pub scaled: ScaledBall<P>,
    /// Cotangent of the unloaded contact angle.
    pub unloaded_cot: P,
    /// Complete elliptic integrals of the second kind `$E$` of the contacts at the nut and the
    /// screw.
    pub second_integrals: [P; 2],
}

impl<F: Real> From<&BallContacts<F>> for RacewayBall<F> {
    #[inline(always)]
    fn from(contacts: &BallContacts<F>) -> Self {
        let [nut, screw] = &contacts.pressed;
        Self {
            scaled: contacts.scaled,
            unloaded_cot: contacts.cos_b / contacts.sin_b,
            second_integrals: [nut.hertz.second_integral, screw.hertz.second_integral],
        }
    }
}

impl<P: Scalar> From<&ElasticContacts<P>> for RacewayBall<P> {
    fn from(contacts: &ElasticContacts<P>) -> Self {
        let angle = contacts.contact_angle;
        Self {
            scaled: contacts.scaled,
            unloaded_cot: angle.cos() / angle.sin(),
            second_integrals: contacts.hertz.map(|hertz| hertz.second_integral),
        }
    }
}

impl<F: Real> RacewayBall<F> {
    /// Returns the relative excess of the spin friction moment at the nut over the spin friction
    /// moment at the screw. For the comparison, the moment at the nut is multiplied by the cosine
    /// of the difference between the contact angles (W7). The nut is the controlling raceway if the
    /// excess is positive.
    ///
    /// Source: Harris and Kotzalas, *Advanced Concepts of Bearing Technology*, outer raceway
    /// control.
    #[inline(always)]
    pub(super) fn nut_excess(&self, [a, b]: &[LoadedContact<F>; 2]) -> F {
        let [(nut_axis, _), (screw_axis, _)] = self.scaled.semi_axes;
        let [nut_integral, screw_integral] = self.second_integrals;
        let at_nut = a.load * a.cbrt_load * nut_axis * nut_integral;
        let at_screw = b.load * b.cbrt_load * screw_axis * screw_integral;
        // Q_A a_A E_A cos(β_A − β_B) > Q_B a_B E_B                        (W7)
        at_nut * (a.cos * b.cos + a.sin * b.sin) / at_screw - 1.0
    }

    /// Returns true if (W7) selects the same raceway for the nut-controlled ball and for the
    /// screw-controlled ball.
    /// The centrifugal forces of the nut-controlled and the screw-controlled ball differ, so the
    /// cotangents of their contact angles differ by `$\Delta c$` (W16). To first order, this
    /// difference changes the ratio of the spin moments by at most `$\Delta c$`.
    ///
    /// * `excess`: relative excess of the spin moment (W7) for the given contacts.
    #[inline(always)]
    pub(super) fn is_control_unambiguous(
        &self,
        [a, b]: &[LoadedContact<F>; 2],
        excess: F,
    ) -> F::Mask {
        let ScaledBall { lead, arc, nut_speed, .. } = self.scaled;
        let angles = [(a.sin, a.cos), (b.sin, b.cos)];
        let (nut, _) = rolling(arc.mask(true), lead, arc, angles);
        let (screw, _) = rolling(arc.mask(false), lead, arc, angles);
        let (difference, sum) = (screw - nut, screw + nut + nut_speed * 2.0);
        // Δc = μ cosα |P_A² − P_B²|/W²                                    (W16)
        let spread = (self.scaled.inertia_ratio() * lead.1 * difference * sum).abs();
        excess.abs().gt(spread * CONTROL_MARGIN)
    }
}
