//! Starting values for models of a ball with two elastic contacts.
//!
//! Theory: `docs/theory/07-raceway-control.md`, equation (W12), with the geometry (J7) of chapter
//! 06.

use std::f64::consts::PI;

use bsm_newton::Bracket;

use super::ElasticContacts;

impl ElasticContacts {
    /// Returns the loads and the tilt that balance axial force and centrifugal force without
    /// friction. `rate` is the precession rate divided by `$W$`. The result is a starting value
    /// with an accuracy of two digits.
    ///
    /// For given axial and centrifugal forces, the force triangle leaves only one unknown: the
    /// contact angle `$\beta_B$` at the screw. This angle is at least the unloaded contact angle.
    /// The radial distance in (J7) decreases with `$\beta_B$`.
    pub(crate) fn static_balance(&self, rate: f64) -> [f64; 3] {
        let axial = self.helix.lead_angle.cos().recip();
        let centrifugal = self.inertia_ratio() * rate * rate / axial;
        let ([nut_offset, screw_offset], target) =
            (self.scaled.offsets, self.scaled.radial_distance);
        let at = |screw: f64| {
            // cotβ_A − cotβ_B = m r_m P² cosα / F_a
            let nut = 1.0_f64.atan2(centrifugal + screw.cos() / screw.sin());
            let loads = [axial / nut.sin(), axial / screw.sin()];
            let [a, b] = self.approaches(loads);
            let radial_distance = (nut_offset + a) * nut.cos() + (screw_offset + b) * screw.cos();
            ([loads[0], loads[1], 0.5 * (screw - nut)], radial_distance / target - 1.0)
        };
        let (mut state, too_far) = at(self.contact_angle);
        let ends = [self.contact_angle, PI];
        // If the contact angle at the screw is π, both radial distances are negative, and the
        // residual of (J7) is below -1. Any negative number serves as the residual at this end of
        // the bracket.
        let bracket = Bracket { f_tol: 1e-3, ..Bracket::new(ends, [too_far, -2.0 / target]) };
        // Even if the search fails, the last evaluated state is good enough as a starting value.
        let _ = bracket.root(|screw| {
            let (found, excess) = at(screw);
            state = found;
            excess
        });
        state
    }
}
