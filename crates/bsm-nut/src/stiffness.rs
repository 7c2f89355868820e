//! Stiffness of a nut along its axis, and of a preloaded nut as manufacturers state it.

use crate::equilibrium::FREEDOMS;
use crate::{BallNut, Equilibrium, Freedom, Preload, Support};

impl Equilibrium {
    /// Stiffness along the axis \[N/m\]: the slope of the axial load over the displacement, where
    /// what the guides do not hold gives way.
    pub fn axial_stiffness(&self, support: &Support) -> f64 {
        let mut k = self.stiffness;
        for i in 1..FREEDOMS {
            k[i][i] += support.0[i].spring();
            let usual = self.stiffness[i][i].abs();
            if matches!(support.0[i], Freedom::Held(_)) || k[i][i] <= 1e-12 * usual {
                continue;
            }
            // k_ab − k_ai k_ib/k_ii
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
    /// What preloads the nut \[m\]: the offset of the bodies against each other, or the excess of the
    /// balls' diameter (U18).
    pub fn preload_setting(&self, by: Preload) -> f64 {
        match by {
            Preload::Offset => {
                let offset = |body: usize| {
                    let of_body = self.circuits.iter().find(|circuit| circuit.body == body);
                    of_body.map_or(0.0, |circuit| circuit.offset)
                };
                offset(0) - offset(1)
            }
            Preload::Oversize => 2.0 * self.errors.oversize,
        }
    }

    /// Displacement of the contacts of one side along the axis by a preload \[m\].
    pub fn preload_approach(&self, by: Preload) -> f64 {
        let setting = self.preload_setting(by).abs();
        match by {
            // δ_p = |O|/2
            Preload::Offset => 0.5 * setting,
            // δ_p = 2Δr/(sinβ₀ cosα)
            Preload::Oversize => setting / self.inclination(),
        }
    }
}
