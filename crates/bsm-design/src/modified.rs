//! Modified load ratings of a nut, and its life with lubrication and contamination taken into
//! account.
//!
//! Theory: `docs/theory/18-axis.md`, equations (Z36) to (Z39).

use std::f64::consts::TAU;

use crate::{Grade, Nut};

/// Factors by which the load ratings of a nut are modified (Z36).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RatingFactors {
    /// Factor `$f_h f_{ac} f_m$` for the dynamic load rating.
    pub dynamic_rating: f64,
    /// Factor `$f_{h0} f_{ac}$` for the static load rating.
    pub static_rating: f64,
}

/// Hardness of the raceways.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Hardness {
    /// Rockwell hardness HRC.
    Rockwell(f64),
    /// Vickers hardness HV 10.
    Vickers(f64),
}

impl RatingFactors {
    /// Returns the rating factors for hardness, accuracy and steel (Z36).
    ///
    /// ```math
    /// C_{am} = f_h f_{ac} f_m\,C_a, \qquad C_{0am} = f_{h0} f_{ac}\,C_{0a}
    /// ```
    ///
    /// * `accuracy`, `steel`: factors `$f_{ac}$` and `$f_m$`.
    ///
    /// Source: ISO 3408-5, 6.1 and 6.2; for hardness HIWIN BS-08-2, F 3.37 and F 3.38, with typical
    /// values for Vickers hardness.
    pub fn of(hardness: Option<Hardness>, accuracy: f64, steel: f64) -> Self {
        let over_full = hardness.map_or(1.0, |hardness| match hardness {
            Hardness::Rockwell(hardness) => hardness / 60.0,
            Hardness::Vickers(hardness) => hardness / 654.0,
        });
        // f_h = min[1, (HRC/60)²],  f_h0 = min[1, (HRC/60)³]              (Z36)
        let (soft, soft_at_rest) = (over_full.powi(2).min(1.0), over_full.powi(3).min(1.0));
        Self { dynamic_rating: soft * accuracy * steel, static_rating: soft_at_rest * accuracy }
    }
}

impl Grade {
    /// Returns the accuracy factor `$f_{ac}$` of the load rating. Typical values from ISO 3408-5
    /// are 1 up to grade 5, 0.9 for grades 7 and 8, and 0.7 for grade 10.
    pub fn rating_factor(&self) -> f64 {
        match self.name.trim_start_matches(char::is_alphabetic) {
            "7" | "8" => 0.9,
            "10" => 0.7,
            _ => 1.0,
        }
    }
}

/// Maximum contact pressure at the fatigue load limit \[Pa\].
const FATIGUE_PRESSURE: f64 = 1500e6;

impl Nut {
    /// Returns the fatigue load limit `$C_u$` \[N\] (Z39). This is the axial load at which the
    /// maximum contact pressure is 1500 MPa if all balls carry equal loads. Returns `None` if the
    /// groove geometry does not permit an elliptical contact.
    ///
    /// Source: ISO 281 as in NTN, Ball and Roller Bearings, 3.4.
    pub fn fatigue_limit(&self) -> Option<f64> {
        let balls = self.balls_per_turn * self.turns;
        let share = balls * self.contact_angle.sin() * self.lead_angle().cos();
        let of_one = self.hertz().ok()?.map(|contact| contact.max_pressure(1.0));
        // C_u = F [1500 MPa/p_max(F)]³                                    (Z39)
        Some(share * (FATIGUE_PRESSURE / of_one[0].max(of_one[1])).powi(3))
    }
}

/// Returns the fatigue load limit \[N\] of a nut for which only the load ratings are known. The
/// typical value is 1/22 of the static load rating, which is defined at 4200 MPa. For pitch circle
/// diameters above 100 mm, the value is smaller.
///
/// * `pitch_diameter`: pitch circle diameter \[m\].
pub fn usual_fatigue_limit(static_rating: f64, pitch_diameter: f64) -> f64 {
    static_rating / 22.0 * (0.1 / pitch_diameter).sqrt().min(1.0)
}

/// Returns the viscosity ratio `$\kappa$` at a given speed (Z38).
///
/// ```math
/// \kappa = \frac{\nu}{\nu_1}, \qquad \nu_1 = 45\,000\,n^{-0.83}D_{pw}^{-1/2}\ (n < 1000), \quad 4500\,n^{-1/2}D_{pw}^{-1/2}
/// ```
/// Here, `$\nu$` is in mm²/s, `$n$` in rpm and `$D_{pw}$` in mm.
///
/// * `viscosity`: kinematic viscosity of the lubricant at operating temperature \[m²/s\].
/// * `speed`: speed of the screw relative to the nut \[rad/s\], nonzero.
/// * `pitch_diameter`: pitch circle diameter \[m\].
///
/// Source: ISO 281 as in NTN, Ball and Roller Bearings, 3.9 to 3.11.
pub fn viscosity_ratio(viscosity: f64, speed: f64, pitch_diameter: f64) -> f64 {
    let (rpm, mm) = (60.0 / TAU * speed.abs(), 1e3 * pitch_diameter);
    // ν₁ = 45000 n^−0.83 D_pw^−½ below 1000 rpm,  4500 n^−½ D_pw^−½       (Z38)
    let needed = mm.powf(-0.5)
        * if rpm < 1000.0 { 45_000.0 * rpm.powf(-0.83) } else { 4500.0 * rpm.powf(-0.5) };
    1e6 * viscosity / needed
}

/// Returns the viscosity ratio for a known film thickness, `$\kappa = \Lambda^{1.3}$` (Z41).
///
/// * `film_ratio`: smallest film thickness divided by the combined roughness of both surfaces.
///
/// Source: ISO 281.
pub fn viscosity_ratio_by_film(film_ratio: f64) -> f64 {
    // κ = Λ^1.3                                                           (Z41)
    film_ratio.powf(1.3)
}

/// Upper limit of the life modification factor.
const MAX_LIFE_FACTOR: f64 = 50.0;

/// Returns the life modification factor `$a_{ISO}$` (Z37). Returns `None` for a viscosity ratio
/// below 0.1, for which ISO 281 does not define the factor.
///
/// ```math
/// a_{ISO} = 0.1\Big[1 - \Big(2.5671 - \frac{a}{\kappa^{b}}\Big)^{0.83}\Big(\frac{e_C C_u}{3P}\Big)^{1/3}\Big]^{-9.3} \le 50
/// ```
///
/// * `clean_limit`: `$e_C C_u/P$`, the product of contamination factor and fatigue load limit
///   divided by the load on the nut.
///
/// Assumes the formula for thrust ball bearings, in which all balls carry load (factor 3 instead of
/// 1 for radial bearings). Source: ISO 281, 31 to 33.
pub fn life_factor(viscosity_ratio: f64, clean_limit: f64) -> Option<f64> {
    let kappa = if viscosity_ratio > 4.0 { 4.0 } else { viscosity_ratio };
    let (a, b) = match kappa {
        0.1..0.4 => (2.2649, 0.054_381),
        0.4..1.0 => (1.9987, 0.190_87),
        1.0..=4.0 => (1.9987, 0.071_739),
        _ => return None,
    };
    // a_ISO = 0.1 [1 − (2.5671 − a/κ^b)^0.83 (e_C C_u/3P)^⅓]^−9.3         (Z37)
    let left = 1.0 - (2.5671 - a / kappa.powf(b)).powf(0.83) * (clean_limit / 3.0).cbrt();
    let factor = if left > 0.0 { 0.1 * left.powf(-9.3) } else { MAX_LIFE_FACTOR };
    Some(factor.min(MAX_LIFE_FACTOR))
}

/// Contamination class of the lubricant according to ISO 281.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "the variants are terms from ISO 281")]
pub enum Contamination {
    ExtremeCleanliness,
    High,
    Normal,
    Slight,
    Typical,
    Severe,
    VerySevere,
}

impl Contamination {
    /// Returns the typical, the smallest and the largest value of the contamination factor `$e_C$`.
    ///
    /// * `pitch_diameter`: pitch circle diameter \[m\].
    ///
    /// Source: ISO 281 as in NTN, Ball and Roller Bearings, table 3.4. The values for extreme
    /// cleanliness are typical values.
    pub fn factor(self, pitch_diameter: f64) -> [f64; 3] {
        let [small, large] = match self {
            Self::ExtremeCleanliness => [[1.0; 3]; 2],
            Self::High => [[0.7, 0.6, 0.8], [0.85, 0.8, 0.9]],
            Self::Normal => [[0.55, 0.5, 0.6], [0.7, 0.6, 0.8]],
            Self::Slight => [[0.4, 0.3, 0.5], [0.5, 0.4, 0.6]],
            Self::Typical => [[0.2, 0.1, 0.3], [0.3, 0.2, 0.4]],
            Self::Severe => [[0.05, 0.0, 0.1]; 2],
            Self::VerySevere => [[0.0; 3]; 2],
        };
        if pitch_diameter < 0.1 { small } else { large }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_4;

    use approx::assert_relative_eq;
    use bsm_dyn::{Conformities, Material, Materials};

    use super::*;

    const RPM: f64 = TAU / 60.0;

    /// Screws of high accuracy and full hardness keep their ratings. With a calculated rating, the
    /// life is multiplied by 0.343 for grade 10 and by 0.729 for grade 7.
    #[test]
    fn ratings_are_modified_by_hardness_and_grade() {
        let full = RatingFactors::of(Some(Hardness::Rockwell(62.0)), 1.0, 1.0);
        assert_eq!(full, RatingFactors { dynamic_rating: 1.0, static_rating: 1.0 });
        assert_eq!(RatingFactors::of(None, 1.0, 1.0), full);
        // Hand calculation: (50/60)² · 0.9 · 1.44 and (50/60)³ · 0.9. A hardness of 545 HV is
        // 0.83333 times the full hardness of 654 HV.
        for hardness in [Hardness::Rockwell(50.0), Hardness::Vickers(545.0)] {
            let soft = RatingFactors::of(Some(hardness), 0.9, 1.44);
            assert_relative_eq!(soft.dynamic_rating, 0.9, max_relative = 1e-12);
            assert_relative_eq!(soft.static_rating, 0.520_833_333_333, max_relative = 1e-11);
        }
        let cube = |name: &str| Grade::named(name).expect("a grade").rating_factor().powi(3);
        for (name, life) in
            [("P5", 1.0), ("C0", 1.0), ("T7", 0.729), ("C8", 0.729), ("P10", 0.343), ("T10", 0.343)]
        {
            assert_relative_eq!(cube(name), life, max_relative = 1e-12);
        }
    }

    /// The factors match independently calculated values to four digits. The factor is 0.1 if
    /// `clean_limit` is zero, and at most 50. No factor is defined for viscosity ratios below 0.1.
    /// For ratios above 4, the factor at 4 applies.
    #[test]
    fn life_factors_match_the_standard() {
        for (kappa, expected) in [
            (0.2, [0.1220, 0.1544, 0.2618]),
            (1.0, [0.2491, 0.8094, 19.843]),
            (4.0, [0.3236, 1.5567, 50.0]),
        ] {
            for (limit, expected) in [0.01, 0.1, 1.0].into_iter().zip(expected) {
                let ours = life_factor(kappa, limit).expect("within the standard");
                assert_relative_eq!(ours, expected, max_relative = 5e-4);
            }
            assert_eq!(life_factor(kappa, 0.0), Some(0.1));
        }
        assert_eq!(life_factor(0.099, 1.0), None);
        assert_eq!(life_factor(f64::NAN, 1.0), None);
        assert_eq!(life_factor(7.0, 0.1), life_factor(4.0, 0.1));
        // Neighboring sections of the formula agree to 1 % at their boundaries.
        for edge in [0.4, 1.0] {
            let at = |kappa: f64| life_factor(kappa, 0.3).expect("within the standard");
            assert_relative_eq!(at(edge * (1.0 - 1e-12)), at(edge), max_relative = 1e-2);
        }
    }

    /// The viscosity ratios of a feed axis (pitch circle 41.75 mm, oil with 35.36 mm²/s) match an
    /// independent calculation.
    #[test]
    fn viscosity_ratios_match_independent_values() {
        for (rpm, needed, kappa) in
            [(100.0, 152.365, 0.232_075), (300.0, 61.2172, 0.577_615), (-2000.0, 15.5729, 2.270_61)]
        {
            let ratio = viscosity_ratio(35.36e-6, rpm * RPM, 41.75e-3);
            // The reference values have six digits.
            assert_relative_eq!(ratio, kappa, max_relative = 1e-5);
            assert_relative_eq!(35.36 / ratio, needed, max_relative = 1e-5);
        }
        assert_relative_eq!(usual_fatigue_limit(141_100.0, 0.041_75), 6413.6, max_relative = 1e-5);
        // For a diameter of 400 mm, the factor √(100/400) is 1/2, so the fatigue load limit is half
        // of 1/22 of the static load rating.
        assert_relative_eq!(usual_fatigue_limit(22.0, 0.4), 0.5, max_relative = 1e-14);
    }

    /// At the fatigue load limit, the contact with the higher pressure reaches 1500 MPa.
    #[test]
    fn contact_pressure_is_1500_mpa_at_the_fatigue_load_limit() {
        let steel = Material { youngs_modulus: 206e9, poisson_ratio: 0.3 };
        let nut = Nut {
            ball_diameter: 6.35e-3,
            pitch_diameter: 41.75e-3,
            lead: 10e-3,
            contact_angle: FRAC_PI_4,
            conformity: Conformities { nut: 0.53, screw: 0.52 },
            material: Materials::alike(steel),
            starts: 1.0,
            balls_per_turn: 18.0,
            turns: 5.0,
        };
        let limit = nut.fatigue_limit().expect("ellipses");
        let share =
            nut.balls_per_turn * nut.turns * nut.contact_angle.sin() * nut.lead_angle().cos();
        let pressure = |contact: &bsm_dyn::hertz::Hertz| contact.max_pressure(limit / share);
        let [at_nut, at_screw] = nut.hertz().expect("ellipses").each_ref().map(pressure);
        assert_relative_eq!(at_nut.max(at_screw), 1500e6, max_relative = 1e-12);
    }
}
