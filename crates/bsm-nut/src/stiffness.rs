//! Axial stiffness of a nut and of its elastic bodies, and the displacements that cause a preload.
//!
//! Theory: `docs/theory/16-nut.md`, equations (U13), (U18) and (U28).

use std::f64::consts::{PI, TAU};

use crate::equilibrium::FREEDOMS;
use crate::{BallNut, Equilibrium, Freedom, PreloadKind, Support};

impl Equilibrium {
    /// Returns the axial stiffness, which is the derivative of the axial load with respect to the
    /// axial displacement \[N/m\]. The nut can move freely in all directions in which the guides do
    /// not hold it.
    pub fn axial_stiffness(&self, support: &Support) -> f64 {
        let mut k = self.stiffness;
        for i in 1..FREEDOMS {
            k[i][i] += support.0[i].spring();
            let usual = self.stiffness[i][i].abs();
            if matches!(support.0[i], Freedom::Held(_)) || k[i][i] <= 1e-12 * usual {
                continue;
            }
            // The entries k_ab of the stiffness matrix are replaced by k_ab − k_ai k_ib/k_ii, which
            // eliminates degree of freedom i.
            let (row, pivot) = (k[i], k[i][i]);
            for line in &mut k {
                let share = line[i] / pivot;
                for (entry, of_row) in line.iter_mut().zip(row) {
                    *entry -= share * of_row;
                }
            }
        }
        k[0][0]
    }
}

impl BallNut {
    /// Returns the diameters of screw and nut at their contacts with the balls \[m\].
    pub fn groove_diameters(&self) -> [f64; 2] {
        let (middle, ball) = (2.0 * self.helix.radius, 2.0 * self.ball.radius);
        let across = ball * self.contact_angle.cos();
        // D_t = 2 r_m ± 2 r_b cosβ₀                                       (U13)
        [middle - across, middle + across]
    }

    /// Returns the axial rigidity of the screw \[N\], which is Young's modulus times
    /// cross-sectional area. The screw is treated as a shaft without grooves.
    ///
    /// * `twists`: true if the screw is fixed against rotation at its anchor. The torque of each
    ///   ball then twists the screw, and the twist moves the groove in the axial direction.
    pub fn screw_stiffness(&self, twists: bool) -> f64 {
        let [screw, _] = self.groove_diameters();
        let steel = self.material.raceways;
        // EA = E π/4 D_s²                                                 (U13)
        let axial = steel.youngs_modulus * 0.25 * PI * screw * screw;
        if !twists {
            return axial;
        }
        let per_radian = self.helix.lead() / TAU;
        // G = E/(2 (1 + ν)),  J = π/32 D_s⁴,  1/EA + h²/GJ                (U28)
        let shear = 0.5 * steel.youngs_modulus / (1.0 + steel.poisson_ratio);
        let torsional = shear * PI / 32.0 * screw.powi(4);
        (axial.recip() + per_radian * per_radian / torsional).recip()
    }

    /// Returns the axial rigidity \[N\], which is Young's modulus times cross-sectional area, of a
    /// nut with the given outer diameter \[m\]. The nut is treated as a tube without grooves.
    pub fn nut_stiffness(&self, outer: f64) -> f64 {
        let [_, inner] = self.groove_diameters();
        // EA = E π/4 (D₁² − D_t²)                                         (U13)
        self.material.raceways.youngs_modulus * 0.25 * PI * (outer * outer - inner * inner)
    }

    /// Returns the displacement that preloads the nut \[m\] (U18), which is the offset between the
    /// bodies or the excess of the ball diameter over the nominal diameter.
    pub fn preload_offset(&self, by: PreloadKind) -> f64 {
        match by {
            PreloadKind::Offset => {
                let offset = |body: usize| {
                    let of_body = self.circuits.iter().find(|circuit| circuit.body == body);
                    of_body.map_or(0.0, |circuit| circuit.offset)
                };
                offset(0) - offset(1)
            }
            PreloadKind::Oversize => 2.0 * self.errors.oversize,
        }
    }

    /// Returns the axial displacement that the preload causes in the contacts of one body or one
    /// flank \[m\].
    pub fn preload_approach(&self, by: PreloadKind) -> f64 {
        let offset = self.preload_offset(by).abs();
        match by {
            // If the preload results from an offset between two bodies, δ_p = |O|/2.
            PreloadKind::Offset => 0.5 * offset,
            // If the preload results from oversize balls, δ_p = 2Δr/(sinβ₀ cosα).
            PreloadKind::Oversize => offset / self.axial_fraction(),
        }
    }
}
