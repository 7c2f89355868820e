//! Starting values for the solves of a pair of contacts.
//!
//! Theory: `docs/theory/06-elastic-contact.md`, equation (P4).

use std::f64::consts::PI;

use bsm_newton::Bracket;

use super::ElasticContacts;

impl ElasticContacts {
    /// Returns loads and tilt of the frictionless balance for the centrifugal force of a precession
    /// rate divided by `$W$`, accurate to two digits. The result is a starting point.
    ///
    /// For given axial and centrifugal forces, the force triangle leaves one unknown, `$\beta_B$`,
    /// which is at least the unloaded angle. The radial distance in (J7) decreases with
    /// `$\beta_B$`.
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
        let bracket = Bracket { f_tol: 1e-3, ..Bracket::new(ends, [too_far, -2.0 / target]) };
        bracket.root(|screw| {
            let (found, excess) = at(screw);
            state = found;
            excess
        });
        state
    }
}
