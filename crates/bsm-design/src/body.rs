//! The body of a nut: its size and mass.

use std::f64::consts::PI;

use crate::thread::Profile;
use crate::{Nut, Screw, Thread};

/// Density of the steel of nuts and screws \[kg/m³\].
pub(crate) const STEEL: f64 = 7850.0;

/// Turns of a nut that carry no balls: returns and ends (Sobolewski 2002).
const IDLE_TURNS: f64 = 3.0;

/// Outside of a nut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NutBody {
    /// Outer diameter `$D_1$` \[m\].
    pub outer: f64,
    /// Length `$L_n$` \[m\].
    pub length: f64,
}

impl NutBody {
    /// The usual body of a nut (D10).
    ///
    /// Source: Sobolewski (2002).
    pub fn usual(nut: &Nut) -> Self {
        Self {
            // D₁ = D_pw + 4 D_w                                           (D10)
            outer: nut.pitch_diameter + 4.0 * nut.ball_diameter,
            length: Self::usual_length(nut.lead, nut.turns),
        }
    }

    /// The usual body of a nut of which only the ratings are known (D10), with three loaded turns unless they are known.
    ///
    /// * `nominal`, `lead` \[m\].
    ///
    /// Source: (D10); the outer diameters of DIN 69051-5, 1.4 to 1.8 nominal diameters.
    pub fn of_ratings(nominal: f64, lead: f64, turns: Option<f64>) -> Self {
        Self { outer: 1.6 * nominal, length: Self::usual_length(lead, turns.unwrap_or(3.0)) }
    }

    /// Usual length of a nut \[m\] (D10).
    fn usual_length(lead: f64, turns: f64) -> f64 {
        // L_n = P_h (i + 3)                                               (D10)
        lead * (turns + IDLE_TURNS)
    }

    /// Mass \[kg\] without balls, returns and flange (D11).
    pub fn mass(&self, nut: &Nut, thread: &Thread) -> f64 {
        let tube = self.outer.powi(2) - thread.nut.land.powi(2);
        threaded(nut, &thread.nut, tube, self.length)
    }
}

impl Nut {
    /// The screw of a thread.
    pub fn screw(&self, thread: &Thread) -> Screw {
        let profile = &thread.screw;
        Screw {
            lead: self.lead,
            pitch_diameter: self.pitch_diameter,
            core: profile.core,
            outer: profile.land,
            mass_per_length: threaded(self, profile, profile.land.powi(2), 1.0),
            youngs_modulus: self.material.0.youngs_modulus,
        }
    }
}

/// Mass \[kg\] of a tube or rod with a groove along its whole length; `square`: difference of the squares of
/// its diameters \[m²\].
fn threaded(nut: &Nut, profile: &Profile, square: f64, length: f64) -> f64 {
    // m = ρ [π/4 (D₁² − D_b²) − A_g L/P_h] L_n                            (D11)
    STEEL * (0.25 * PI * square - profile.section() * nut.turn_length() / nut.lead) * length
}
