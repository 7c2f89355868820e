//! Dimensions of a screw, and estimates of dimensions that catalogs do not print.
//!
//! Theory: `docs/theory/18-axis.md`, equations (Z30) to (Z33).

use std::f64::consts::PI;

/// Density of the steel of nuts and screws \[kg/m³\].
pub(crate) const STEEL: f64 = 7850.0;

/// Dimensions and material data of a screw that determine its behavior in the axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Screw {
    /// Lead \[m\].
    pub lead: f64,
    /// Pitch circle diameter \[m\].
    pub pitch_diameter: f64,
    /// Core diameter of the thread \[m\].
    pub core: f64,
    /// Outer diameter \[m\].
    pub outer: f64,
    /// Mass per meter \[kg/m\], without a bore.
    pub mass_per_length: f64,
    /// Moment of inertia per meter about the axis \[kg·m\], without a bore.
    pub inertia_per_length: f64,
    /// Young's modulus \[Pa\].
    pub youngs_modulus: f64,
}

impl Screw {
    /// Returns the lead angle at the pitch circle \[rad\].
    pub fn lead_angle(&self) -> f64 {
        (self.lead / (PI * self.pitch_diameter)).atan()
    }

    /// Returns the mass \[kg\] of a screw with the given bore diameter and length \[m\].
    pub fn mass(&self, bore: f64, length: f64) -> f64 {
        (self.mass_per_length - bore_mass_per_length(bore)) * length
    }

    /// Returns the moment of inertia about the axis \[kg·m²\] of a screw with the given bore
    /// diameter and length \[m\].
    pub fn inertia(&self, bore: f64, length: f64) -> f64 {
        let missing = bore_mass_per_length(bore) * bore.powi(2) / 8.0;
        (self.inertia_per_length - missing) * length
    }

    /// Returns the typical core diameter \[m\] of a screw if the catalog does not state the core
    /// diameter (Z30).
    ///
    /// * `nominal`, `lead`: nominal diameter \[m\] and lead \[m\].
    /// * `ball`: ball diameter \[m\], or `None` if it is not known.
    ///
    /// Source: HIWIN BS-08-2, tables 6.4 to 6.9, in which nominal and core diameter differ by 0.79
    /// to 0.84 ball diameters. If the ball diameter is not known, typical values apply.
    pub fn usual_core(nominal: f64, lead: f64, ball: Option<f64>) -> f64 {
        // d₃ = d₀ − 0.84 D_w,  max(d₀ − P_h/2, 0.84 d₀)                   (Z30)
        ball.map_or((nominal - 0.5 * lead).max(0.84 * nominal), |ball| nominal - 0.84 * ball)
    }

    /// Returns the typical mass per meter \[kg/m\] of a screw if the catalog does not state the
    /// mass (Z31). The value is accurate to about 20 %.
    ///
    /// * `nominal`, `core`: nominal and core diameter \[m\].
    ///
    /// Source: median of 175 screws in the general catalog of THK whose core diameter and mass are
    /// printed.
    pub fn usual_mass_per_length(nominal: f64, core: f64) -> f64 {
        // m′ = ρ π/4 d_m²,  d_m = d₃ + 0.46 (d₀ − d₃)                     (Z31)
        0.25 * STEEL * PI * (core + 0.46 * (nominal - core)).powi(2)
    }
}

/// Returns the mass per meter \[kg/m\] that a bore of the given diameter \[m\] removes.
fn bore_mass_per_length(bore: f64) -> f64 {
    0.25 * PI * STEEL * bore.powi(2)
}

/// Efficiencies that a catalog states for all screw sizes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Efficiency {
    /// Efficiency in forward driving.
    pub forward: f64,
    /// Efficiency in back-driving.
    pub back: f64,
}

impl Efficiency {
    /// Returns the friction torque of the ball contacts \[N·m\] (Z32), which is positive.
    ///
    /// ```math
    /// T_f = |F|\,h\,(1/\eta - 1) \quad\text{or}\quad |F|\,h\,(1 - \eta')
    /// ```
    ///
    /// * `ideal`: load torque without friction \[N·m\].
    /// * `drives`: true if the load back-drives the screw.
    ///
    /// Source: HIWIN BS-08-2, F 3.15 and F 3.16.
    pub fn friction(&self, ideal: f64, drives: bool) -> f64 {
        // T_f = |F| h (1/η − 1),  |F| h (1 − η′)                          (Z32)
        ideal.abs() * if drives { 1.0 - self.back } else { self.forward.recip() - 1.0 }
    }
}

/// Operating point for which a catalog states the stiffness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StiffnessAt {
    /// Load on a nut without preload, as a fraction of the dynamic load rating.
    Load(f64),
    /// Preload of a preloaded nut, as a fraction of the dynamic load rating.
    Preload(f64),
}

impl StiffnessAt {
    /// Converts a stiffness from a catalog to another load or preload (Z33). The result has the
    /// unit of the given stiffness. Returns `None` if only one of the two operating points has a
    /// preload.
    ///
    /// ```math
    /// R_{nu} = 0.8\,K\Big(\frac{F}{\epsilon\,C_a}\Big)^{1/3}
    /// ```
    ///
    /// * `stated`: stiffness `$K$` that the catalog states.
    /// * `load`: load on a nut without preload \[N\].
    /// * `rating`: dynamic load rating \[N\].
    ///
    /// Source: THK general catalog, equations 35 and 36; HIWIN BS-08-2, F 3.34 and F 3.35.
    pub fn stiffness(
        self,
        stated: f64,
        load: f64,
        preload: Option<f64>,
        rating: f64,
    ) -> Option<f64> {
        let (force, at) = match (self, preload) {
            (Self::Load(at), None) => (load, at),
            (Self::Preload(at), Some(preload)) => (preload, at),
            _ => return None,
        };
        // R_nu = 0.8 K [F/(ε C_a)]^⅓                                      (Z33)
        Some(0.8 * stated * (force / (at * rating)).cbrt())
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    /// The hand calculations are for a 40 mm x 10 mm screw, with 6.35 mm balls and with an unknown
    /// ball diameter. For a lead of 20 mm, the rule without a lower limit would give a core
    /// diameter of 30 mm.
    #[test]
    fn typical_core_diameters_match_hand_calculations() {
        let core = |lead: f64, ball| Screw::usual_core(0.04, lead, ball) * 1e3;
        for (lead, ball, expected) in
            [(0.01, Some(6.35e-3), 34.666), (0.01, None, 35.0), (0.02, None, 33.6)]
        {
            assert_relative_eq!(core(lead, ball), expected, max_relative = 1e-12);
        }
    }

    /// A thread without depth has the mass of a rod. The vertical reference axis has a screw with a
    /// mean diameter of 30.164 mm.
    #[test]
    fn mass_of_a_thread_without_depth_equals_mass_of_a_rod() {
        let rod = |diameter: f64| 0.25 * STEEL * PI * diameter.powi(2);
        let of = Screw::usual_mass_per_length;
        assert_relative_eq!(of(0.04, 0.04), rod(0.04), max_relative = 1e-14);
        assert_relative_eq!(of(0.032, 0.0286), rod(0.030_164), max_relative = 1e-14);
    }

    /// Without losses, the friction torque is zero. Hand calculation: at an efficiency of 0.9, an
    /// output torque of 9 N m requires an input torque of 10 N m. In back-driving, 10 N m give 8 N
    /// m at an efficiency of 0.8.
    #[test]
    fn friction_follows_from_the_efficiency() {
        let of = |forward, back| Efficiency { forward, back };
        assert_relative_eq!(of(0.9, 0.8).friction(-9.0, false), 1.0, max_relative = 1e-14);
        assert_relative_eq!(of(0.9, 0.8).friction(10.0, true), 2.0, max_relative = 1e-14);
        for drives in [false, true] {
            assert!(of(1.0, 1.0).friction(9.0, drives).abs() < 1e-300);
        }
    }

    /// At the load or preload for which the catalog states the stiffness, the result is 0.8 times
    /// the stated stiffness. At eight times this load, the result is twice as large.
    #[test]
    fn stiffness_is_proportional_to_the_cube_root_of_the_load() {
        let (light, heavy) = (StiffnessAt::Load(0.3), StiffnessAt::Preload(0.1));
        let of = |load| light.stiffness(500.0, load, None, 50e3).expect("no preload");
        assert_relative_eq!(of(15e3), 400.0, max_relative = 1e-14);
        assert_relative_eq!(of(8.0 * 15e3), 800.0, max_relative = 1e-14);
        let of = heavy.stiffness(500.0, 1.0, Some(5e3), 50e3).expect("a preload");
        assert_relative_eq!(of, 400.0, max_relative = 1e-14);
        assert_eq!(light.stiffness(500.0, 1.0, Some(5e3), 50e3), None);
        assert_eq!(heavy.stiffness(500.0, 1.0, None, 50e3), None);
    }
}
