//! The screw as a shaft between its bearings: critical speed, buckling, yield, stiffness, thermal
//! expansion and pretension.
//!
//! Theory: `docs/theory/18-axis.md`, equations (Z1) to (Z6) and (AA5).

use std::f64::consts::PI;

use crate::screw::STEEL;

/// Specific heat capacity of steel \[J/(kg K)\].
const HEAT_CAPACITY: f64 = 460.0;

/// Permissible axial stress of the screw \[Pa\] (Z3). THK, PMI and other manufacturers state 147
/// N/mm².
pub const PERMITTED_STRESS: f64 = 147e6;

/// Default upper limit of the ratio of speed to critical speed, as stated by all manufacturers.
pub const CRITICAL_SPEED_RATIO: f64 = 0.8;

/// Default lower limit of the ratio of buckling load to axial load, as stated by all manufacturers.
pub const BUCKLING_SAFETY: f64 = 2.0;

/// End supports of a screw. Fixed ends carry axial load.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EndFixity {
    /// One end is fixed, and the other end is free.
    FixedFree,
    /// Both ends of the screw can tilt.
    SupportedSupported,
    /// One end is fixed, and the other end can tilt.
    FixedSupported,
    /// Neither end can tilt, and both ends carry axial load.
    FixedFixed,
}

impl EndFixity {
    /// Returns the smallest positive root `$\lambda$` of the frequency equation of a beam (Z1).
    ///
    /// The frequency equation is `$\cos\lambda\cosh\lambda = -1$` if one end is free, `$\sin\lambda
    /// = 0$` if both ends can tilt, `$\tan\lambda = \tanh\lambda$` if one end can tilt, and
    /// `$\cos\lambda\cosh\lambda = 1$` if both ends are fixed.
    pub fn frequency_root(self) -> f64 {
        match self {
            Self::FixedFree => 1.875_104_068_711_961_2,
            Self::SupportedSupported => PI,
            Self::FixedSupported => 3.926_602_312_047_919,
            Self::FixedFixed => 4.730_040_744_862_704,
        }
    }

    /// Returns the end supports of the section between a bearing and the nut, if the nut is clamped
    /// in a guided table.
    ///
    /// Source: THK, A-726 and A-739: "the section between nut and bearing is fixed-fixed".
    #[must_use]
    pub fn of_buckling(self) -> Self {
        match self {
            Self::SupportedSupported => self,
            Self::FixedFree | Self::FixedSupported | Self::FixedFixed => Self::FixedFixed,
        }
    }

    /// Returns the ratio `$\kappa$` of the buckling load to the buckling load of the same bar with
    /// pinned ends (Z2). The ratios are the factors of the Euler buckling cases.
    pub fn buckling_factor(self) -> f64 {
        match self {
            Self::FixedFree => 0.25,
            Self::SupportedSupported => 1.0,
            // The value is (x/π)², where x is the smallest positive root of tan x = x.
            Self::FixedSupported => 2.045_748_515_938_295_8,
            Self::FixedFixed => 4.0,
        }
    }
}

/// Bore of a hollow screw, with the material that fills the bore.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bore {
    /// Bore diameter `$d_b$` \[m\], smaller than the shaft diameter; 0 for a solid screw.
    pub diameter: f64,
    /// Density `$\rho_c$` of the material that fills the bore, such as coolant \[kg/m³\]; 0 for an
    /// empty bore.
    pub filling_density: f64,
}

impl Bore {
    /// Bore of a solid screw.
    pub const NONE: Self = Self { diameter: 0.0, filling_density: 0.0 };
}

/// Section of a screw that may buckle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BucklingSection {
    /// End supports of the section.
    pub support: EndFixity,
    /// Length of the section \[m\], positive.
    pub length: f64,
}

/// A screw as a shaft between its bearings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shaft {
    /// End supports of the screw.
    pub support: EndFixity,
    /// Unsupported length `$l$` \[m\], positive.
    pub length: f64,
    /// Shaft diameter `$d_3$` for bending and buckling \[m\], positive. It is usually the core
    /// diameter of the thread.
    pub diameter: f64,
    /// Bore of the screw.
    pub bore: Bore,
    /// Section of the screw that may buckle.
    pub buckling: BucklingSection,
    /// Young's modulus \[Pa\].
    pub youngs_modulus: f64,
}

impl Shaft {
    /// Returns the critical speed \[rad/s\] (Z1).
    ///
    /// ```math
    /// \omega_c = \frac{\lambda^2}{l^2}\sqrt{\frac{EI}{m'}}, \qquad I = \frac\pi{64}(d_3^4 - d_b^4), \quad m' = \rho A + \rho_c\frac\pi4d_b^2
    /// ```
    ///
    /// Assumes a slender beam without axial load and neglects the support by the nut. Source: Euler
    /// and Bernoulli; catalogs of manufacturers such as THK 513-1E, A15-32, eq. 7.
    pub fn critical_speed(&self) -> f64 {
        let root = self.support.frequency_root();
        let Bore { diameter, filling_density } = self.bore;
        let mass = STEEL * self.section() + filling_density * 0.25 * PI * diameter.powi(2);
        // ω_c = λ²/l² √(E I/m')                                           (Z1)
        (root / self.length).powi(2) * (self.youngs_modulus * self.second_moment() / mass).sqrt()
    }

    /// Returns the critical speed under an axial tension \[rad/s\] (BB11). The tension \[N\] is
    /// negative for compression. The result is zero if the compression exceeds the buckling load.
    ///
    /// ```math
    /// \omega_c(F_v) = \omega_c\sqrt{1 + F_v/F_k}
    /// ```
    /// Here, `$F_k$` is the buckling load of the whole screw with its own end supports. The formula
    /// is exact if both ends can tilt.
    pub fn critical_speed_under(&self, tension: f64) -> f64 {
        let buckles = self.euler_load(self.support, self.length);
        // ω_c(F_v) = ω_c √(1 + F_v/F_k)                                   (BB11)
        self.critical_speed() * (1.0 + tension / buckles).max(0.0).sqrt()
    }

    /// Returns the buckling load \[N\] (Z2).
    ///
    /// ```math
    /// F_k = \frac{\kappa\pi^2 EI}{l_k^2}
    /// ```
    ///
    /// Assumes a slender bar. For a short bar, [`yield_load`](Self::yield_load) is smaller. Source:
    /// Euler; catalogs of manufacturers such as HIWIN BS-08-2, F 3.25, which uses a factor of 2
    /// instead of 2.046.
    pub fn buckling_load(&self) -> f64 {
        self.euler_load(self.buckling.support, self.buckling.length)
    }

    /// Returns the buckling load of a section of the screw \[N\] (Z2).
    ///
    /// * `length`: length of the section \[m\].
    pub fn euler_load(&self, support: EndFixity, length: f64) -> f64 {
        // F_k = κ π² E I/l_k²                                             (Z2)
        support.buckling_factor() * PI.powi(2) * self.youngs_modulus * self.second_moment()
            / length.powi(2)
    }

    /// Returns a copy of the shaft in which the section that may buckle has the end supports of the
    /// whole screw.
    #[must_use]
    pub fn with_buckling_of_support(&self) -> Self {
        let buckling = BucklingSection { support: self.support, ..self.buckling };
        Self { buckling, ..*self }
    }

    /// Returns the axial load at which the stress in the core reaches a given value \[N\] (Z3).
    ///
    /// Source: THK 513-1E, A15-30, eq. 6.
    pub fn yield_load(&self, stress: f64) -> f64 {
        // F_σ = σ A                                                       (Z3)
        stress * self.section()
    }

    /// Returns the axial stiffness at the nut position `position` \[N/m\] (Z4).
    ///
    /// ```math
    /// K_s = \frac{EA}{x} \quad\text{or}\quad EA\Big(\frac1x + \frac1{l - x}\Big)
    /// ```
    /// The first formula applies if one end carries axial load, and the second formula applies if
    /// both ends carry axial load.
    ///
    /// * `position`: distance `$x$` between the nut and the end that carries the load \[m\],
    ///   between 0 and the unsupported length.
    ///
    /// Source: HIWIN BS-08-2, F 3.31 and F 3.32.
    pub fn stiffness_at(&self, position: f64) -> f64 {
        let strained = self.youngs_modulus * self.section();
        match self.support {
            // K_s = E A/x                                                 (Z4)
            EndFixity::FixedFree | EndFixity::SupportedSupported | EndFixity::FixedSupported => {
                strained / position
            }
            // K_s = E A [1/x + 1/(l − x)]                                 (Z4)
            EndFixity::FixedFixed => {
                strained * (position.recip() + (self.length - position).recip())
            }
        }
    }

    /// Returns the smallest axial stiffness \[N/m\] (Z4). It occurs when the nut is at the far end
    /// or, if both ends carry axial load, in the middle.
    pub fn least_stiffness(&self) -> f64 {
        let share = if self.support == EndFixity::FixedFixed { 0.5 } else { 1.0 };
        self.stiffness_at(share * self.length)
    }

    /// Returns the smallest axial stiffness at the nut that results from torsion of the screw
    /// \[N/m\] (BB9). Half of the length is twisted between two fixed bearings; otherwise, the
    /// whole length is twisted.
    ///
    /// * `advance`: travel per radian of screw rotation \[m\].
    /// * `poisson`: Poisson's ratio of the screw.
    pub fn torsional_stiffness(&self, advance: f64, poisson: f64) -> f64 {
        let share = if self.support == EndFixity::FixedFixed { 0.5 } else { 1.0 };
        let shear_modulus = self.youngs_modulus / (2.0 * (1.0 + poisson));
        let polar = PI * (self.diameter.powi(4) - self.bore.diameter.powi(4)) / 32.0;
        // K_t = G π (d₃⁴ − d_b⁴)/(32 x h²)                                (BB9)
        shear_modulus * polar / (share * self.length * advance.powi(2))
    }

    /// Returns the free thermal expansion \[m\] (Z5).
    ///
    /// * `expansion`: coefficient of thermal expansion \[1/K\].
    /// * `rise`: temperature rise \[K\].
    pub fn growth(&self, expansion: f64, rise: f64) -> f64 {
        // Δl = α_T l ΔT                                                   (Z5)
        expansion * self.length * rise
    }

    /// Returns the cross-sectional area of the core \[m²\].
    pub fn section(&self) -> f64 {
        0.25 * PI * (self.diameter.powi(2) - self.bore.diameter.powi(2))
    }

    /// Returns the second moment of area of the core \[m⁴\].
    fn second_moment(&self) -> f64 {
        PI / 64.0 * (self.diameter.powi(4) - self.bore.diameter.powi(4))
    }

    /// Returns the ratio of the axial force between two fixed bearings to the thermal expansion
    /// that they constrain \[N/m\] (AA5).
    ///
    /// * `bearing`: axial stiffness of each bearing \[N/m\], infinite for a rigid bearing.
    pub fn constraint_stiffness(&self, bearing: f64) -> f64 {
        // C = l/EA + 2/K_b                                                (AA5)
        (self.length / (self.youngs_modulus * self.section()) + 2.0 / bearing).recip()
    }

    /// Returns the axial tension between two fixed bearings \[N\] (AA5), which is negative for
    /// compression.
    ///
    /// ```math
    /// F_v(\Delta T) = \frac{\alpha_T\,l\,(\Delta T_v - \Delta T)}{C}
    /// ```
    ///
    /// * `growth`: free expansion of the screw per kelvin \[m/K\].
    /// * `bearing`: axial stiffness of each bearing, as in [`constraint_stiffness`](Self::constraint_stiffness).
    /// * `stretched`: pretension, expressed as a temperature difference \[K\].
    /// * `rise`: temperature difference between screw and bed \[K\].
    ///
    /// Source: GY Ballscrew, "The influence of ball screw pretension"; THK, A-715.
    pub fn tension(&self, growth: f64, bearing: f64, stretched: f64, rise: f64) -> f64 {
        // F_v = α_T l (ΔT_v − ΔT)/C                                       (AA5)
        growth * (stretched - rise) * self.constraint_stiffness(bearing)
    }

    /// Returns the pretension as a temperature difference \[K\] for a given tension \[N\]. It is
    /// the inverse of [`tension`](Self::tension).
    pub fn stretched_by(&self, growth: f64, bearing: f64, tension: f64) -> f64 {
        // ΔT_v = F_v C/(α_T l)                                            (AA5)
        tension / (growth * self.constraint_stiffness(bearing))
    }

    /// Returns the fraction of the thermal expansion that remains between two fixed bearings
    /// because of their compliance.
    ///
    /// * `bearing`: axial stiffness of each bearing, as in [`constraint_stiffness`](Self::constraint_stiffness).
    pub fn growth_left(&self, bearing: f64) -> f64 {
        // 1 − (l/EA)/C                                                    (AA5)
        1.0 - self.constraint_stiffness(bearing) * self.length
            / (self.youngs_modulus * self.section())
    }
}

/// Returns the steady-state temperature difference between an axis and its surroundings \[K\]
/// (Z17).
///
/// * `heat`: heat generated in the axis \[W\].
/// * `transfer`: heat transferred to the surroundings per kelvin \[W/K\], positive.
pub fn steady_rise(heat: f64, transfer: f64) -> f64 {
    // ΔT = Q̇/H                                                           (Z17)
    heat / transfer
}

/// Returns the time constant \[s\] with which the temperature approaches the steady state of
/// [`steady_rise`]. It is `$mc/H$`, with 460 J/(kg K) for steel.
///
/// * `mass`: mass of the axis \[kg\].
/// * `transfer`: heat transferred to the surroundings per kelvin \[W/K\], positive.
pub fn warming_time(mass: f64, transfer: f64) -> f64 {
    mass * HEAT_CAPACITY / transfer
}

/// Returns the natural frequency of a mass on a spring \[Hz\] (BB9).
///
/// * `stiffness`: spring stiffness \[N/m\].
/// * `mass`: moving mass \[kg\].
pub fn natural_frequency(stiffness: f64, mass: f64) -> f64 {
    // f = √(K/m)/2π                                                       (BB9)
    (stiffness / mass).sqrt() / (2.0 * PI)
}

/// Returns the elastic lost motion \[m\] (Z6), which is the travel that an axis loses when its
/// friction reverses.
///
/// * `friction`: friction force that changes sign \[N\].
/// * `stiffness`: stiffness of the axis \[N/m\].
pub fn lost_motion(friction: f64, stiffness: f64) -> f64 {
    // u_0 = 2 F_r/K                                                       (Z6)
    2.0 * friction / stiffness
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    const RPM: f64 = PI / 30.0;

    /// Returns all types of end supports in the order of increasing stiffness.
    fn all() -> [EndFixity; 4] {
        use EndFixity::{FixedFixed, FixedFree, FixedSupported, SupportedSupported};
        [FixedFree, SupportedSupported, FixedSupported, FixedFixed]
    }

    fn shaft(support: EndFixity, length: f64, diameter: f64) -> Shaft {
        Shaft {
            support,
            length,
            diameter,
            bore: Bore::NONE,
            buckling: BucklingSection { support, length },
            youngs_modulus: 206e9,
        }
    }

    /// The roots satisfy their frequency equations, which are rewritten so that all terms are of
    /// order one.
    #[test]
    fn tabulated_roots_of_beam_frequency_equations_satisfy_these_equations() {
        let [free, tilting, one, fixed] = all().map(EndFixity::frequency_root);
        for residual in [
            free.cos() + free.cosh().recip(),
            tilting.sin(),
            one.tan() - one.tanh(),
            fixed.cos() - fixed.cosh().recip(),
        ] {
            assert!(residual.abs() < 1e-14, "{residual}");
        }
        let x = PI * EndFixity::FixedSupported.buckling_factor().sqrt();
        // At the root, tan x = x, so the error of tan x is the rounding error of x multiplied by 1
        // + tan² x = 1 + x² = 21.
        assert!((x.tan() - x).abs() < 1e-13, "{}", x.tan() - x);
    }

    /// The results match the factors printed in catalogs: THK 513-1E (0.8 times the critical speed,
    /// divided by 10⁷ d/l²) to half a unit in the last digit, HIWIN BS-08-2 (2.71e8 f_n d/l²), and
    /// HSK.
    #[test]
    fn catalog_factors_are_reproduced() {
        let thk = [3.4, 9.7, 15.1, 21.9];
        let hiwin = [0.147, 0.446, 0.692, 1.0];
        for ((support, thk), hiwin) in all().into_iter().zip(thk).zip(hiwin) {
            // For a diameter of 1 mm and a length of 1 m, d/l² is 1e-6/mm.
            let speed = shaft(support, 1.0, 1e-3).critical_speed() / RPM;
            assert!((0.8 * speed / 10.0 - thk).abs() < 0.05, "{support:?} {speed}");
            // The HIWIN factors deviate from the exact values. For a screw with a free end, the
            // HIWIN factor is 0.010 too low. For all other supports, the HIWIN factor is at most
            // 0.005 too high.
            let of_fixed = shaft(EndFixity::FixedFixed, 1.0, 1e-3).critical_speed() / RPM;
            let off = speed / of_fixed - hiwin;
            assert!((-0.0055..0.0105).contains(&off), "{support:?} {off}");
            // The exact factor is 273.6, and HIWIN uses 271.
            assert!((of_fixed / 271.0 - 1.0).abs() < 0.01);
        }
        // HSK states half of the buckling load as m d⁴/l² 10³ kgf for a Young's modulus of 21 000
        // kgf/mm².
        for (support, m) in all().into_iter().zip([1.3, 5.1, 10.2, 20.3]) {
            let load = 0.5 * shaft(support, 1.0, 1e-3).buckling_load() * (21_000.0 * 9.806_65)
                / 206e3
                / 9.806_65;
            // For a diameter of 1 mm and a length of 1 m, the factor d⁴/l² 10³ is 10⁻³. The printed
            // value of 10.2 results from a factor of 2 instead of Euler's 2.046.
            let near = if support == EndFixity::FixedSupported { 0.025 * m } else { 0.05 };
            assert!((load / 1e-3 - m).abs() < near, "{support:?} {load}");
        }
    }

    /// MISUMI economy series, "Selection of ball screws": a permissible load of 3630 N for a root
    /// diameter of 12.5 mm and a length of 820 mm (fixed-supported), with m = 10 for 0.5 · 2.046 π³
    /// E/64, and a permissible speed of 15.1 d/l² 10⁷ = 3024 rpm for a length of 790 mm. White
    /// paper by Machine Design: a rod of 1 inch diameter and 100 inches length has a natural
    /// frequency of 18 Hz if both ends are fixed, and of 8 Hz if both ends are supported.
    #[test]
    fn worked_examples_of_catalogs_are_reproduced() {
        let example = shaft(EndFixity::FixedSupported, 0.82, 12.5e-3);
        // MISUMI rounds the exact factor of 10.21 to m = 10.
        let permitted = example.buckling_load() / BUCKLING_SAFETY;
        assert!((permitted / 3630.0 - 1.021).abs() < 2e-3, "{permitted}");
        let example = shaft(EndFixity::FixedSupported, 0.79, 12.5e-3);
        let permitted = CRITICAL_SPEED_RATIO * example.critical_speed() / RPM;
        // The factor 15.1 has only three digits.
        assert!((permitted / 3024.0 - 1.0).abs() < 3.5e-3, "{permitted}");
        let inch = 25.4e-3;
        let turns = |support| shaft(support, 100.0 * inch, inch).critical_speed() / (2.0 * PI);
        assert!((turns(EndFixity::FixedFixed) - 18.0).abs() < 0.5);
        assert!((turns(EndFixity::SupportedSupported) - 8.0).abs() < 0.5);
    }

    /// Hand calculation for a solid fixed-supported screw with a diameter of 34 mm and a length of
    /// 1 m: I = 6.5597e-8 m⁴, E I = 13 513 N m².
    #[test]
    fn speed_and_load_limits_of_a_solid_screw_match_hand_calculations() {
        let screw = shaft(EndFixity::FixedSupported, 1.0, 34e-3);
        // The hand calculation is accurate to four digits.
        assert!((screw.critical_speed() / RPM - 6411.0).abs() < 0.5);
        assert!((screw.buckling_load() / 1e3 - 272.8).abs() < 0.05);
        // The cross section of 907.92 mm² carries 147 N/mm².
        assert!((screw.yield_load(PERMITTED_STRESS) - 133_464.0).abs() < 1.0);
        // The stiffness is 206e9 · 9.0792e-4 N divided by a length of 1 m.
        assert!((screw.least_stiffness() * 1e-6 - 187.03).abs() < 0.005);
        // A temperature rise of 1 K extends a length of 1 m by 11.5 µm.
        assert_relative_eq!(screw.growth(11.5e-6, 1.0), 11.5e-6, max_relative = 1e-14);
    }

    /// The screw has a bore of 17 mm that is empty or filled with water. In the limit of a very
    /// small bore, the results equal the results for a solid screw.
    #[test]
    fn speed_and_load_limits_of_a_hollow_screw_match_hand_calculations() {
        let solid = shaft(EndFixity::FixedSupported, 1.0, 34e-3);
        let with_bore =
            |diameter, filling_density| Shaft { bore: Bore { diameter, filling_density }, ..solid };
        let hollow = with_bore(17e-3, 0.0);
        // The hand calculation is accurate to five digits.
        assert_relative_eq!(hollow.critical_speed() / RPM, 7167.7, max_relative = 1e-5);
        assert_relative_eq!(hollow.buckling_load(), 255_790.0, max_relative = 2e-5);
        assert_relative_eq!(solid.buckling_load(), 272_840.0, max_relative = 2e-5);
        assert_relative_eq!(hollow.section(), 680.94e-6, max_relative = 1e-5);
        let wet = with_bore(17e-3, 1000.0);
        // The mass of the steel is 5.34538 kg, and the mass of the water in the bore is 0.22698 kg.
        let slower = (5.345_38_f64 / (5.345_38 + 0.226_98)).sqrt();
        assert_relative_eq!(
            wet.critical_speed() / hollow.critical_speed(),
            slower,
            max_relative = 1e-5
        );
        let nearly = with_bore(1e-9, 0.0);
        assert_relative_eq!(nearly.critical_speed(), solid.critical_speed(), max_relative = 1e-12);
    }

    /// Examples by THK: a screw with a core diameter of 17.5 mm and a length of 1100 mm, clamped by
    /// bearing and nut, carries 15 500 N (A-726). A screw with a core diameter of 12.5 mm and a
    /// length of 700 mm carries 9960 N (A-739).
    #[test]
    fn buckling_loads_between_bearing_and_nut_match_thk() {
        for (length, diameter, printed, ours) in
            [(1.1, 17.5e-3, 15_500.0, 15_471.5), (0.7, 12.5e-3, 9960.0, 9945.1)]
        {
            let screw = shaft(EndFixity::FixedSupported.of_buckling(), length, diameter);
            let permitted = screw.buckling_load() / BUCKLING_SAFETY;
            assert_relative_eq!(permitted, ours, max_relative = 1e-5);
            // THK rounds the factor of 20.33, which includes E I, to 20.
            assert_relative_eq!(permitted, printed, max_relative = 2e-3);
        }
        let tilts = EndFixity::SupportedSupported;
        assert_eq!(tilts.of_buckling(), tilts);
    }

    /// Hand calculation for a core of 34.4 mm and a length of 1450 mm with a pretension of 3 K.
    /// Rigid bearings give 6605.3 N and 50.025 um, and two bearings of 750 N/um give 4885.2 N and
    /// 36.998 um. If the screw is 8 K warmer than the bed, the force is -11 008.8 N with rigid
    /// bearings. Without a pretension, thermal expansion compresses the screw, and rigid bearings
    /// do not permit any expansion.
    #[test]
    fn pretension_matches_hand_calculations() {
        let screw = shaft(EndFixity::FixedFixed, 1.45, 34.4e-3);
        let growth = 11.5e-6 * screw.length;
        let stretch = |tension: f64| tension * screw.length / (206e9 * screw.section());
        for (bearing, tension, micrometers) in
            [(f64::INFINITY, 6605.3, 50.025), (750e6, 4885.2, 36.998)]
        {
            let found = screw.tension(growth, bearing, 3.0, 0.0);
            assert_relative_eq!(found, tension, max_relative = 1e-5);
            assert_relative_eq!(1e6 * stretch(found), micrometers, max_relative = 2e-5);
            assert_relative_eq!(
                screw.stretched_by(growth, bearing, found),
                3.0,
                max_relative = 1e-14
            );
        }
        let rigid = f64::INFINITY;
        let warm = screw.tension(growth, rigid, 3.0, 8.0);
        assert_relative_eq!(warm, -11_008.8, max_relative = 1e-5);
        // For a screw with a core diameter of 34 mm and no pretension, the thermal force at a
        // temperature rise of 10 K is 21.5 kN.
        let plain = shaft(EndFixity::FixedFixed, 1.45, 34e-3).tension(growth, rigid, 0.0, 10.0);
        assert_relative_eq!(plain, -21.5e3, max_relative = 2e-3);
        assert!(screw.growth_left(rigid).abs() < 1e-14);
        // The compliance l/EA of the screw is 75.7 % of the total compliance C.
        assert_relative_eq!(screw.growth_left(750e6), 1.0 - 4885.2 / 6605.3, max_relative = 1e-4);
    }

    /// The minimum stiffness of a screw fixed at both ends is four times the minimum stiffness of a
    /// screw fixed at one end, and it occurs in the middle. If the nut is near one end, the bearing
    /// at the other end has almost no effect.
    #[test]
    fn screw_fixed_at_both_ends_has_four_times_the_minimum_stiffness() {
        let (one, two) = (
            shaft(EndFixity::FixedSupported, 1.2, 30e-3),
            shaft(EndFixity::FixedFixed, 1.2, 30e-3),
        );
        assert_relative_eq!(
            two.least_stiffness(),
            4.0 * one.least_stiffness(),
            max_relative = 1e-14
        );
        for position in [0.1, 0.3, 0.59, 0.61, 1.1] {
            assert!(two.stiffness_at(position) > two.least_stiffness());
            assert!(one.stiffness_at(position) > one.least_stiffness());
        }
        // If the other end is also held, the stiffness is larger by a factor of 1 + x/(l − x).
        let share = two.stiffness_at(1e-6) / one.stiffness_at(1e-6);
        assert_relative_eq!(share, 1.0 + 1e-6 / (1.2 - 1e-6), max_relative = 1e-14);
    }

    /// A friction force of 100 N in each direction causes a lost motion of 2 µm at 100 N/µm.
    #[test]
    fn lost_motion_matches_a_hand_calculation() {
        assert_relative_eq!(lost_motion(100.0, 1e8), 2e-6, max_relative = 1e-14);
    }
}
