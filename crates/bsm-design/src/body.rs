//! Dimensions and mass of the nut body.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::screw::STEEL;
use crate::thread::Profile;
use crate::{Nut, PreloadMethod, Screw, Thread};

/// Number of turns of the nut thread that hold no balls, because ball returns and nut ends take up
/// the space (Sobolewski 2002).
const IDLE_TURNS: f64 = 3.0;

/// Arrangement of one or two nuts on a screw, which determines the length of the nut set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NutSet {
    /// A single nut, in contrast to a nut pair.
    Single,
    /// Two nuts clamped against each other. The gap between them defaults to one pitch of the
    /// grooves.
    Pair {
        /// Gap between the nuts \[m\].
        gap: Option<f64>,
    },
    /// A single nut with a lead offset in the middle, so that one body contains two loaded
    /// sections.
    ShiftedLead,
}

impl NutSet {
    /// Returns the nut set for a preload method. Without preload, this is a single nut.
    ///
    /// * `gap`: gap between the nuts of a pair \[m\].
    pub fn of(method: Option<PreloadMethod>, gap: Option<f64>) -> Self {
        match method {
            None | Some(PreloadMethod::Oversize) => Self::Single,
            Some(PreloadMethod::DoubleNut) => Self::Pair { gap },
            Some(PreloadMethod::Offset) => Self::ShiftedLead,
        }
    }

    /// Returns the typical length of the nut set \[m\] (D10), (BB6).
    ///
    /// ```math
    /// L_n = P(i + 3), \qquad \text{pair: } 2P(i + 3) + g, \qquad \text{shifted lead: } P(2i + 4)
    /// ```
    ///
    /// * `pitch`: axial distance between neighboring grooves \[m\].
    /// * `turns`: number of loaded turns of one nut.
    pub fn usual_length(self, pitch: f64, turns: f64) -> f64 {
        // L_n = P (i + 3)                                                 (D10)
        let single = pitch * (turns + IDLE_TURNS);
        match self {
            Self::Single => single,
            // L_n = 2 P (i + 3) + g                                       (BB6)
            Self::Pair { gap } => 2.0 * single + gap.unwrap_or(pitch),
            // L_n = P (2 i + 4)                                           (BB6)
            Self::ShiftedLead => pitch * (2.0 * turns + IDLE_TURNS + 1.0),
        }
    }
}

/// Outer dimensions of a nut set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NutBody {
    /// Outer diameter `$D_1$` \[m\].
    pub outer: f64,
    /// Length `$L_n$` of the whole set \[m\].
    pub length: f64,
}

impl NutBody {
    /// Number of loaded turns that is assumed if only the load ratings of a nut are known.
    pub const TURNS_OF_RATINGS: f64 = 3.0;

    /// Returns the typical dimensions of a nut set (D10), (BB6).
    ///
    /// Source: Sobolewski (2002).
    pub fn usual(nut: &Nut, set: NutSet) -> Self {
        Self {
            // D₁ = D_pw + 4 D_w                                           (D10)
            outer: nut.pitch_diameter + 4.0 * nut.ball_diameter,
            length: set.usual_length(nut.pitch(), nut.turns),
        }
    }

    /// Returns the typical dimensions of a nut set for which only the load ratings are known. The
    /// number of loaded turns defaults to [`TURNS_OF_RATINGS`](Self::TURNS_OF_RATINGS).
    ///
    /// * `nominal`: nominal diameter \[m\].
    /// * `pitch`: axial distance between neighboring grooves \[m\].
    ///
    /// Source: (D10); the outer diameters of DIN 69051-5 are 1.4 to 1.8 times the nominal diameter.
    pub fn of_ratings(nominal: f64, pitch: f64, turns: Option<f64>, set: NutSet) -> Self {
        let turns = turns.unwrap_or(Self::TURNS_OF_RATINGS);
        Self { outer: 1.6 * nominal, length: set.usual_length(pitch, turns) }
    }

    /// Returns the moment of inertia about the axis of a steel tube that extends from the pitch
    /// circle to the outer diameter \[kg·m²\] (BB10). The result is an estimate of the moment of
    /// inertia of a rotating nut.
    ///
    /// * `pitch_diameter`: pitch circle diameter \[m\].
    pub fn tube_inertia(&self, pitch_diameter: f64) -> f64 {
        // J_n = π ρ/32 (D₁⁴ − D_pw⁴) L_n                                  (BB10)
        PI / 32.0 * STEEL * (self.outer.powi(4) - pitch_diameter.powi(4)) * self.length
    }

    /// Returns the mass of the nut set \[kg\] without balls, ball returns and flange (D11). The gap
    /// of a pair is treated as a spacer.
    pub fn mass(&self, nut: &Nut, thread: &Thread) -> f64 {
        let tube = self.outer.powi(2) - thread.nut.land.powi(2);
        // m = ρ [π/4 (D₁² − D_b²) − A_g L/P] L_n                          (D11)
        STEEL
            * (0.25 * PI * tube - thread.nut.section() * nut.turn_length() / nut.pitch())
            * self.length
    }
}

impl Nut {
    /// Returns the mass per meter of a screw \[kg/m\] and its moment of inertia about the axis per
    /// meter \[kg·m\] (AA9).
    ///
    /// ```math
    /// J_s = \frac{\pi\rho d_s^4}{32}l - \frac{2\pi\rho\,z\,l}{P_h}\int_{r_r}^{d_s/2} r^3 w\,dr, \qquad w = \frac{2}{\cos\alpha}\big[\sqrt{R^2 - y^2} - k\big]
    /// ```
    /// For the mass, the integral contains `$r$` instead of `$r^3$`.
    fn screw_mass_and_inertia(&self, thread: &Thread) -> (f64, f64) {
        let Profile { radius, offset, height, land, .. } = thread.screw;
        let [meet, edge] = thread.screw.ends();
        let edge = edge.min(FRAC_PI_2);
        let middle = 0.5 * self.pitch_diameter + height;
        let width = 2.0 / self.lead_angle().cos();
        // ∫ r^p w dr over the angle of the flank, r = D_pw/2 + h − R cosθ, w = (2/cosα) (R sinθ − k)
        let removed = |power: i32| {
            let at = |i: u32| {
                let angle = meet + (edge - meet) * f64::from(i) / f64::from(STEPS);
                let (sin, cos) = angle.sin_cos();
                let weight = if i == 0 || i == STEPS { 1 } else { 2 + 2 * (i % 2) };
                let r = middle - radius * cos;
                f64::from(weight) * r.powi(power) * width * (radius * sin - offset) * radius * sin
            };
            (0..=STEPS).map(at).sum::<f64>() * (edge - meet) / (3.0 * f64::from(STEPS))
        };
        let turns = TAU * STEEL / self.pitch();
        // m_s = π/4 ρ l d_s² − 2πρ z l/P_h ∫ r w dr                       (AA9)
        let mass = 0.25 * PI * STEEL * land.powi(2) - turns * removed(1);
        // J_s = π/32 ρ l d_s⁴ − 2πρ z l/P_h ∫ r³ w dr                     (AA9)
        let inertia = PI / 32.0 * STEEL * land.powi(4) - turns * removed(3);
        (mass, inertia)
    }

    /// Returns the dimensions of the screw that belongs to a thread.
    pub fn screw(&self, thread: &Thread) -> Screw {
        let (mass_per_length, inertia_per_length) = self.screw_mass_and_inertia(thread);
        Screw {
            lead: self.lead,
            pitch_diameter: self.pitch_diameter,
            core: thread.screw.core,
            outer: thread.screw.land,
            mass_per_length,
            inertia_per_length,
            youngs_modulus: self.material.raceways.youngs_modulus,
        }
    }
}

/// Number of intervals per flank for Simpson's rule. The number is even and gives a relative error
/// of 1e-8.
const STEPS: u32 = 32;

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use bsm_dyn::{Conformities, Material, Materials};

    use super::*;

    /// End-cap nuts (TBI, SFY) have two circuits, each on its own thread. The length that (D10)
    /// gives is sufficient for their turns, and is at most 1.45 times the catalog length, because
    /// end caps are short. An earlier version counted all turns on a single thread, so that the
    /// calculated length was too long by a factor of up to 2.8.
    #[test]
    fn usual_length_is_sufficient_for_multi_start_nuts() {
        for (lead, of_a_circuit, printed) in [
            (16e-3, 1.8, 45e-3),
            (16e-3, 2.8, 61e-3),
            (25e-3, 1.8, 64e-3),
            (32e-3, 2.8, 110e-3),
            (50e-3, 1.8, 117e-3),
            (50e-3, 2.8, 167e-3),
        ] {
            let usual =
                NutBody::of_ratings(lead, lead / 2.0, Some(2.0 * of_a_circuit), NutSet::Single)
                    .length;
            assert!(lead * of_a_circuit < printed && printed < usual, "{lead} {usual}");
            assert!(usual < 1.45 * printed, "{lead} {usual}");
        }
    }

    /// The moment of inertia used to be calculated from the pitch circle diameter, which made it
    /// more than 40 % too large. The expected values for a length of one meter were calculated to
    /// six digits with a different quadrature. A bore reduces mass and inertia by the mass and
    /// inertia of a rod with the bore diameter.
    #[test]
    fn mass_and_inertia_of_a_screw_exclude_the_groove() {
        let steel = Material { youngs_modulus: 206e9, poisson_ratio: 0.3 };
        for (pitch, ball, lead, land, mass, inertia) in [
            (50.53e-3, 10e-3, 20e-3, 49.03e-3, 13.012, 3.512_53e-3),
            (41.75e-3, 6.35e-3, 10e-3, 40e-3, 8.882_66, 1.615_95e-3),
        ] {
            let nut = Nut {
                ball_diameter: ball,
                pitch_diameter: pitch,
                lead,
                contact_angle: PI / 4.0,
                conformity: Conformities::alike(0.52),
                material: Materials::alike(steel),
                balls_per_turn: 10.0,
                turns: 3.0,
                starts: 1.0,
            };
            let thread = nut.thread(0.0, (pitch + 2e-3, land));
            let screw = nut.screw(&thread);
            let (m, j) = (screw.mass(0.0, 1.0), screw.inertia(0.0, 1.0));
            assert_relative_eq!(m, mass, max_relative = 1e-6);
            assert_relative_eq!(j, inertia, max_relative = 3e-6);
            let (hollow, turned) = (screw.mass(10e-3, 1.0), screw.inertia(10e-3, 1.0));
            let rod = STEEL * 0.25 * PI * 1e-4;
            assert_relative_eq!(m - hollow, rod, max_relative = 1e-12);
            assert_relative_eq!(j - turned, rod * 1e-4 / 8.0, max_relative = 1e-9);
            // The groove of each thread start removes the same amount of material.
            let two = Nut { starts: 2.0, ..nut }.screw(&thread).mass(0.0, 1.0);
            let whole = STEEL * 0.25 * PI * land * land;
            assert_relative_eq!(whole - two, 2.0 * (whole - m), max_relative = 1e-12);
            // If the land is at the root diameter, the groove has zero depth, and the screw is a
            // rod.
            let rod = nut.thread(0.0, (pitch + 2e-3, thread.screw.root));
            let screw = nut.screw(&rod);
            let (m, j) = (screw.mass(0.0, 1.0), screw.inertia(0.0, 1.0));
            assert_relative_eq!(j, m * thread.screw.root.powi(2) / 8.0, max_relative = 1e-12);
        }
    }
}
