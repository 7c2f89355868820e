//! Rigidity of the contacts and of the body of a nut.

use std::f64::consts::PI;

use bsm_dyn::{Hertz, Member, Reason, contact_modulus};

use crate::{Body, Nut};

/// Displacement and rigidity under an axial force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rigidity {
    /// Hertz approaches over `$Q^{2/3}$` at nut and screw \[m/N^(2/3)\].
    pub approaches: [f64; 2],
    /// Characteristic `$k$` of one turn \[N/m^1.5\] (D6).
    pub turn: f64,
    /// Displacement of the contacts of a nut along the axis \[m\] (D7).
    pub displacement: f64,
    /// Of the contacts of all nuts \[N/m\] (D7).
    pub contacts: f64,
    /// Of the bodies of all nuts \[N/m\] (D8).
    pub bodies: f64,
    /// Of both together \[N/m\].
    pub total: f64,
}

impl Nut {
    /// Rigidity of one nut under an axial force \[N\], or of two nuts that press against each
    /// other with it (D6) to (D8).
    ///
    /// ```math
    /// k = \frac{n\,(\sin\beta\cos\alpha)^{5/2}}{(\delta_n + \delta_s)^{3/2}}
    /// ```
    ///
    /// `$\delta$` the Hertz approach at unit load. Source: ISO/DP 9784 as in Sobolewski (2002), with
    /// exact Hertz contacts of helical grooves in place of its fits.
    ///
    /// # Errors
    ///
    /// [`Reason::CurvaturesNotHertzian`] if the grooves leave no ellipse across them.
    pub fn rigidity(&self, body: &Body, force: f64, pair: bool) -> Result<Rigidity, Reason> {
        let modulus = contact_modulus(&self.material.0, &self.material.1);
        let lead = self.lead_angle();
        let approach = |member| -> Result<f64, Reason> {
            Ok(Hertz::of(&self.curvatures(member, lead), modulus)?.compliance)
        };
        let approaches = [approach(Member::Nut)?, approach(Member::Screw)?];
        let direction = self.contact_angle.sin() * lead.cos();
        // k = n (sinβ cosα)^5/2 / (δ_n + δ_s)^3/2                         (D6)
        let turn = self.balls_per_turn
            * (direction / (approaches[0] + approaches[1])).powf(1.5)
            * direction;
        let k = turn * self.turns;
        // δ = (F/(k i))^⅔,  dF/dδ = 3/2 k i √δ                            (D7)
        let displacement = (force / k).cbrt().powi(2);
        let nuts = if pair { 2.0 } else { 1.0 };
        let contacts = nuts * 1.5 * k * displacement.sqrt();
        let bodies = nuts * body.rigidity(self);
        let total = (contacts.recip() + bodies.recip()).recip();
        Ok(Rigidity { approaches, turn, displacement, contacts, bodies, total })
    }
}

impl Body {
    /// Rigidity along the loaded turns \[N/m\] (D8).
    ///
    /// Source: Sobolewski (2002).
    pub fn rigidity(&self, nut: &Nut) -> f64 {
        let inner = nut.pitch_diameter + nut.ball_diameter * nut.contact_angle.cos();
        let (outer, inner) = (self.outer * self.outer, inner * inner);
        // j = 2π i P_h E tan²β / [(D₁² + D_t²)/(D₁² − D_t²) + 1]          (D8)
        2.0 * PI
            * nut.turns
            * nut.lead
            * nut.material.0.youngs_modulus
            * nut.contact_angle.tan().powi(2)
            / ((outer + inner) / (outer - inner) + 1.0)
    }
}
