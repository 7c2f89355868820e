//! The thermal network: five nodes, the surroundings, and the screw as a fin outside of its travel.
//!
//! Theory: `docs/theory/19-warm-state.md`, equations (I6) to (I8), (I16) and (I17).

use std::f64::consts::PI;

use bsm_newton::Dense;

use super::{Conductances, NODES, NoSteadyState};

/// The screw between its bearings, as heat and strain see it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScrewBar {
    /// Pitch circle diameter, of the cylinder that air cools \[m\].
    pub diameter: f64,
    /// Between the bearings \[m\].
    pub length: f64,
    /// That the nut covers: stroke and nut \[m\], less than `length`.
    pub travel: f64,
    /// Section of its steel \[m²\].
    pub section: f64,
    /// Conductivity of steel \[W/(m·K)\].
    pub conductivity: f64,
    /// Thermal expansion of nut, screw and balls \[1/K\].
    pub expansion: f64,
    /// Ends that have a bearing; the others give no heat to the structure.
    pub bearings: [bool; 2],
    /// What two fixed bearings do along the axis; `None`: it may grow.
    pub hold: Option<AxialHold>,
}

impl ScrewBar {
    /// Strain along the axis by a tension \[N\] (I5); none unless both bearings are fixed.
    pub fn strain(&self, tension: f64) -> f64 {
        // s = F_t/(E A_s)                                                 (I5)
        self.hold.map_or(0.0, |hold| tension / (hold.youngs_modulus * self.section))
    }
}

/// A screw between two fixed bearings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxialHold {
    /// Of screw and both bearings in series \[N/m\].
    pub stiffness: f64,
    /// Tension at the temperature of setting \[N\].
    pub pretension: f64,
    /// Young's modulus of the screw \[Pa\].
    pub youngs_modulus: f64,
    /// Its Poisson's ratio.
    pub poisson_ratio: f64,
}

/// Temperatures of the surroundings over that of setting \[K\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sinks {
    /// Of the air.
    pub air: f64,
    /// Of what carries the bearings.
    pub structure: f64,
    /// Of the coolant.
    pub coolant: f64,
}

/// The network; temperatures are rises over that of setting \[K\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Network {
    /// What carries heat.
    pub conductances: Conductances,
    /// The screw.
    pub screw: ScrewBar,
    /// The surroundings.
    pub sinks: Sinks,
}

/// The screw outside the travel on one side: a fin between two temperatures (I7).
struct Fin {
    /// `$Y_d$` and `$Y_o$` \[W/K\].
    near: f64,
    far: f64,
    /// `$\tanh(m l_e/2)/m$` \[m\].
    end_length: f64,
    /// `$l_e$` \[m\].
    length: f64,
}

impl Network {
    /// What a metre of the screw gives away \[W/(m·K)\], and the mean temperature it gives it to (I6).
    fn along(&self) -> (f64, f64) {
        let film = self.conductances.screw_film * PI * self.screw.diameter;
        let coolant = self.conductances.coolant / self.screw.length;
        let all = film + coolant;
        // T_f = (h_s π D T₀ + (G_c/l) T_c)/g                              (I6)
        (all, (film * self.sinks.air + coolant * self.sinks.coolant) / all)
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

    /// What leaves the nodes for each kelvin \[W/K\], and what reaches them from the surroundings \[W\]: `$M$` and
    /// `$r$` of (I8).
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
            (0, of.nut, self.sinks.air),
            (0, of.nut_coolant, self.sinks.coolant),
            (1, given * self.screw.travel + 2.0 * lost, around),
            (3, lost, around),
            (4, lost, around),
            (3, first, self.sinks.structure),
            (4, second, self.sinks.structure),
        ] {
            // M T = r + P(T)                                              (I8)
            matrix[i][i] += conductance;
            received[i] += conductance * sink;
        }
        (matrix, received)
    }

    /// Returns the rises at which the heat of the nodes leaves them \[K\] (I8).
    ///
    /// * `heat`: of each node \[W\].
    ///
    /// # Errors
    ///
    /// [`NoSteadyState::NotFound`] if the network is singular.
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

    /// Free growth of the screw \[m\] (I16).
    pub fn growth(&self, &[_, screw, _, first, second]: &[f64; NODES]) -> f64 {
        let (fin, (_, around)) = (self.fin(), self.along());
        let outside =
            |end: f64| fin.end_length * (screw + end - 2.0 * around) + fin.length * around;
        // D_l = α_T {L_t T_s + Σ [tanh(m l_e/2)/m (T_s + T_i − 2 T_f) + l_e T_f]}  (I16)
        self.screw.expansion * (self.screw.travel * screw + outside(first) + outside(second))
    }

    /// Tension of the screw \[N\], below zero a compression (I17); none unless both its bearings are fixed.
    pub fn tension(&self, rises: &[f64; NODES]) -> f64 {
        self.screw.hold.map_or(0.0, |hold| {
            let of_the_structure = self.screw.expansion * self.screw.length * self.sinks.structure;
            // F_t = F_t0 − K_ax [D_l − α_T l (T_h − T_set)]               (I17)
            hold.pretension - hold.stiffness * (self.growth(rises) - of_the_structure)
        })
    }
}
