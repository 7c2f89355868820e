//! The body of a nut: its size and mass.

use std::f64::consts::PI;

use crate::Nut;

/// Density of the steel of nuts \[kg/m³\].
const STEEL: f64 = 7850.0;

/// Gap between the bore of a nut and its screw, on the diameter \[m\] (Sobolewski 2002).
const GAP: f64 = 1.5e-3;

/// Turns of a nut that carry no balls: returns and ends (Sobolewski 2002).
const IDLE_TURNS: f64 = 3.0;

/// Body of a nut: a tube with the groove of the balls in its bore.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// Outer diameter `$D$` \[m\].
    pub outer: f64,
    /// Diameter of the bore \[m\].
    pub bore: f64,
    /// Length `$L_n$` \[m\].
    pub length: f64,
}

impl Body {
    /// The usual body of a nut on a screw of outer diameter `screw_diameter` \[m\] (D10).
    ///
    /// Source: Sobolewski (2002).
    pub fn usual(nut: &Nut, screw_diameter: f64) -> Self {
        Self {
            // D₁ = D_pw + 4 D_w,  L_n = P_h (i + 3)                       (D10)
            outer: nut.pitch_diameter + 4.0 * nut.ball_diameter,
            bore: screw_diameter + GAP,
            length: nut.lead * (nut.turns + IDLE_TURNS),
        }
    }

    /// Mass of a shaft of this diameter and length \[m\], in kg.
    pub(crate) fn mass_of_shaft(diameter: f64, length: f64) -> f64 {
        STEEL * 0.25 * PI * diameter.powi(2) * length
    }

    /// Mass \[kg\] without balls and returns: the tube less its groove (D11).
    ///
    /// The groove is the part beyond the bore of a circle of the nut's groove radius around the
    /// ball centres, along the whole nut.
    pub fn mass(&self, nut: &Nut) -> f64 {
        let radius = nut.conformity.0 * nut.ball_diameter;
        let depth = (0.5 * (self.bore - nut.pitch_diameter)).clamp(-radius, radius);
        // A_g = r² arccos(h/r) − h √(r² − h²)                             (D11)
        let groove = radius.powi(2) * (depth / radius).acos()
            - depth * (radius.powi(2) - depth.powi(2)).sqrt();
        // m = ρ [π/4 (D₁² − D_b²) L_n − A_g (L_n/P_h) L]                  (D11)
        let tube = 0.25 * PI * (self.outer.powi(2) - self.bore.powi(2)) * self.length;
        STEEL * (tube - groove * self.length / nut.lead * nut.turn_length())
    }
}
