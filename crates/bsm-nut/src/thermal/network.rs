//! Thermal network that consists of five nodes and the surroundings. The parts of the screw outside
//! the travel are modeled as fins.
//!
//! Theory: `docs/theory/19-warm-state.md`, equations (I6) to (I8), (I16) and (I17).

use std::f64::consts::PI;

use bsm_newton::Dense;

use super::{Conductances, NODES, NoSteadyState};

/// Thermal and mechanical data of the part of the screw between its bearings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScrewBar {
    /// Pitch circle diameter \[m\]. The cooling by air is calculated for a cylinder of this
    /// diameter.
    pub diameter: f64,
    /// Length between the bearings \[m\].
    pub length: f64,
    /// Length of the travel \[m\], which is the sum of stroke and nut length. It must be less than
    /// `length`.
    pub travel: f64,
    /// Cross-sectional area of the steel \[m²\].
    pub section: f64,
    /// Thermal conductivity of steel \[W/(m·K)\].
    pub conductivity: f64,
    /// Coefficient of thermal expansion of nut, screw and balls \[1/K\].
    pub expansion: f64,
    /// For each end of the screw, true if it has a support bearing. An end without a bearing does
    /// not transfer heat to the structure.
    pub bearings: [bool; 2],
    /// Axial constraint by two fixed bearings; `None` if the screw can expand freely.
    pub constraint: Option<AxialConstraint>,
}

impl ScrewBar {
    /// Returns the axial strain of the screw due to a tension \[N\] (I5). The strain is zero unless
    /// both bearings are fixed.
    pub fn strain(&self, tension: f64) -> f64 {
        // s = F_t/(E A_s)                                                 (I5)
        self.constraint
            .map_or(0.0, |constraint| tension / (constraint.youngs_modulus * self.section))
    }
}

/// Axial constraint of a screw by two fixed bearings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxialConstraint {
    /// Stiffness of the screw in series with both bearings \[N/m\].
    pub stiffness: f64,
    /// Axial tension of the screw at the assembly temperature \[N\].
    pub pretension: f64,
    /// Young's modulus of the screw \[Pa\].
    pub youngs_modulus: f64,
    /// Poisson's ratio of the screw.
    pub poisson_ratio: f64,
}

/// Temperatures of the surroundings relative to the assembly temperature \[K\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surroundings {
    /// Temperature of the air.
    pub air: f64,
    /// Temperature of the structure that carries the bearings.
    pub structure: f64,
    /// Temperature of the coolant.
    pub coolant: f64,
}

/// Thermal network of an axis. All temperatures in the network are relative to the assembly
/// temperature \[K\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Network {
    /// Conductances between the nodes and to the surroundings.
    pub conductances: Conductances,
    /// Part of the screw between its bearings.
    pub screw: ScrewBar,
    /// Temperatures of the surroundings.
    pub surroundings: Surroundings,
}

/// Part of the screw on one side of the travel, modeled as a fin whose two ends have given
/// temperatures (I7).
struct Fin {
    /// Conductances `$Y_d$` and `$Y_o$` of the fin \[W/K\].
    near: f64,
    far: f64,
    /// Effective length of the fin for thermal expansion, `$\tanh(m l_e/2)/m$` \[m\].
    end_length: f64,
    /// Fin length `$l_e$` \[m\].
    length: f64,
}

impl Network {
    /// Returns the conductance per unit length between the screw and its surroundings \[W/(m·K)\],
    /// and the temperature of the surroundings, which is a weighted mean of air and coolant
    /// temperature (I6).
    fn along(&self) -> (f64, f64) {
        let film = self.conductances.screw_film * PI * self.screw.diameter;
        let coolant = self.conductances.coolant / self.screw.length;
        let all = film + coolant;
        // T_f = (h_s π D T₀ + (G_c/l) T_c)/g                              (I6)
        (all, (film * self.surroundings.air + coolant * self.surroundings.coolant) / all)
    }

    fn fin(&self) -> Fin {
        let ScrewBar { length, travel, section, conductivity, .. } = self.screw;
        let (length, conducted) = (0.5 * (length - travel), conductivity * section);
        let m = (self.along().0 / conducted).sqrt();
        Fin {
            // Y_d = k A_s m coth(m l_e),  Y_o = k A_s m/sinh(m l_e),  m = √(g/(k A_s))  (I7)
            near: conducted * m / (m * length).tanh(),
            far: conducted * m / (m * length).sinh(),
            end_length: (0.5 * m * length).tanh() / m,
            length,
        }
    }

    /// Returns the matrix `$M$`, whose product with the temperatures gives the heat flows out of
    /// the nodes \[W/K\], and the vector `$r$` of heat flows from the surroundings to the nodes
    /// \[W\] (I8).
    pub fn balance(&self) -> ([[f64; NODES]; NODES], [f64; NODES]) {
        let (of, fin, (given, around)) = (&self.conductances, self.fin(), self.along());
        let mut matrix = [[0.0; NODES]; NODES];
        let mut received = [0.0; NODES];
        for (i, k, conductance) in [
            (0, 1, of.gap),
            (0, 2, of.ball_nut),
            (1, 2, of.ball_screw),
            (1, 3, fin.far),
            (1, 4, fin.far),
        ] {
            matrix[i][i] += conductance;
            matrix[k][k] += conductance;
            matrix[i][k] -= conductance;
            matrix[k][i] -= conductance;
        }
        let lost = fin.near - fin.far;
        let [first, second] = self.screw.bearings.map(|held| if held { of.end } else { 0.0 });
        for (i, conductance, sink) in [
            (0, of.nut, self.surroundings.air),
            (0, of.nut_coolant, self.surroundings.coolant),
            (1, given * self.screw.travel + 2.0 * lost, around),
            (3, lost, around),
            (4, lost, around),
            (3, first, self.surroundings.structure),
            (4, second, self.surroundings.structure),
        ] {
            // M T = r + P(T)                                              (I8)
            matrix[i][i] += conductance;
            received[i] += conductance * sink;
        }
        (matrix, received)
    }

    /// Returns the temperature rises at which every node loses as much heat as it receives \[K\]
    /// (I8).
    ///
    /// * `heat`: heat generated at each node \[W\].
    ///
    /// # Errors
    ///
    /// Returns [`NoSteadyState::NotFound`] if the equations of the network are singular.
    pub fn rises(&self, heat: &[f64; NODES]) -> Result<[f64; NODES], NoSteadyState> {
        let (matrix, mut rises) = self.balance();
        let mut linear = Dense::<NODES>::default();
        *linear.rows_mut() = matrix;
        linear.factorize().map_err(|_| NoSteadyState::NotFound)?;
        for (rise, heat) in rises.iter_mut().zip(heat) {
            *rise += heat;
        }
        linear.solve(&mut rises);
        Ok(rises)
    }

    /// Returns the thermal expansion of the screw if it can expand freely \[m\] (I16).
    pub fn thermal_expansion(&self, &[_, screw, _, first, second]: &[f64; NODES]) -> f64 {
        let (fin, (_, around)) = (self.fin(), self.along());
        let outside =
            |end: f64| fin.end_length * (screw + end - 2.0 * around) + fin.length * around;
        // D_l = α_T {L_t T_s + Σ [tanh(m l_e/2)/m (T_s + T_i − 2 T_f) + l_e T_f]}  (I16)
        self.screw.expansion * (self.screw.travel * screw + outside(first) + outside(second))
    }

    /// Returns the axial tension of the screw \[N\] (I17). It is negative for compression, and zero
    /// unless both bearings are fixed.
    pub fn tension(&self, rises: &[f64; NODES]) -> f64 {
        self.screw.constraint.map_or(0.0, |constraint| {
            let of_the_structure =
                self.screw.expansion * self.screw.length * self.surroundings.structure;
            // F_t = F_t0 − K_ax [D_l − α_T l (T_h − T_set)]               (I17)
            constraint.pretension
                - constraint.stiffness * (self.thermal_expansion(rises) - of_the_structure)
        })
    }
}
