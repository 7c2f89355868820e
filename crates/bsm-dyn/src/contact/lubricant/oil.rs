//! Oil viscosity as a function of temperature and pressure.
//!
//! Theory: `docs/theory/17-lubricant.md`, equations (Y1) to (Y5).

use std::f64::consts::LN_10;

use bsm_kin::Real;

/// Kind of base oil, which determines default properties.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BaseOil {
    /// Mineral oil.
    Mineral,
    /// Polyalphaolefin.
    Pao,
    /// Ester.
    Ester,
    /// Polyglycol.
    Pag,
}

/// Typical properties of a kind of base oil.
struct Typical {
    /// Parameters `$s$` and `$t$` of the pressure-viscosity coefficient (Y4).
    pressure_viscosity: (f64, f64),
    limiting_shear: f64,
    density: f64,
    conductivity: f64,
}

impl BaseOil {
    fn typical(self) -> Typical {
        let of = |pressure_viscosity, limiting_shear, density, conductivity| Typical {
            pressure_viscosity,
            limiting_shear,
            density,
            conductivity,
        };
        match self {
            Self::Mineral => of((9.904, 0.139), 0.047, 880.0, 0.134),
            Self::Pao => of((7.382, 0.1335), 0.035, 840.0, 0.14),
            Self::Ester => of((6.605, 0.136), 0.030, 920.0, 0.15),
            Self::Pag => of((5.489, 0.1485), 0.044, 1050.0, 0.15),
        }
    }

    /// Returns the ratio `$\Lambda$` of the limiting shear stress to the pressure.
    pub fn limiting_shear(self) -> f64 {
        self.typical().limiting_shear
    }

    /// Returns the typical density of the base oil at 15 °C \[kg/m³\].
    pub fn density(self) -> f64 {
        self.typical().density
    }

    /// Returns the thermal conductivity of the base oil \[W/(m·K)\].
    pub fn conductivity(self) -> f64 {
        self.typical().conductivity
    }
}

/// ISO 3448 viscosity grades: kinematic viscosities at 40 °C \[mm²/s\].
pub const VISCOSITY_GRADES: [f64; 11] =
    [10.0, 15.0, 22.0, 32.0, 46.0, 68.0, 100.0, 150.0, 220.0, 320.0, 460.0];

/// Kinematic viscosities of the viscosity grades at 100 °C for a viscosity index of 95 \[mm²/s\].
const HOT_GRADES: [f64; 11] =
    [2.64, 3.38, 4.25, 5.29, 6.64, 8.53, 11.07, 14.54, 18.75, 23.95, 30.34];

/// Properties of an oil that are independent of its temperature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oil<D = f64> {
    /// Base oil, which determines default properties.
    pub base: BaseOil,
    /// Kinematic viscosities at 40 and 100 °C \[m²/s\]. The viscosity at 40 °C is larger.
    pub viscosities: [D; 2],
    /// Density at 15 °C \[kg/m³\].
    pub density: D,
    /// Pressure-viscosity coefficient `$\alpha$` \[1/Pa\]. If it is `None`, it is estimated from
    /// the base oil.
    pub pressure_viscosity: Option<D>,
    /// Ratio `$\Lambda$` of the limiting shear stress to the pressure, positive.
    pub limiting_shear: D,
}

/// Properties of an oil at a given temperature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OilState<D = f64> {
    /// Temperature \[K\].
    pub temperature: D,
    /// Kinematic viscosity `$\nu$` \[m²/s\].
    pub kinematic_viscosity: D,
    /// Density `$\rho$` \[kg/m³\].
    pub density: D,
    /// Dynamic viscosity `$\eta$` \[Pa·s\].
    pub viscosity: D,
    /// Relative decrease `$\beta$` of the dynamic viscosity per kelvin \[1/K\].
    pub temperature_coefficient: D,
    /// Pressure-viscosity coefficient `$\alpha$` \[1/Pa\].
    pub pressure_viscosity: D,
    /// Pressure parameter `$a_p$` of (Y5) \[Pa\].
    pub pressure_scale: D,
}

/// Thermal expansion coefficient of oil, relative to the density at 15 °C, `$-\rho_{15}^{-1}
/// d\rho/dT$` \[1/K\].
const EXPANSION: f64 = 6.5e-4;

/// Pressure parameter `$b_p$` of (Y5) (dimensionless).
pub(crate) const PRESSURE_SLOPE: f64 = 0.02;

impl Oil {
    /// Returns the kinematic viscosities at 40 and 100 °C \[m²/s\] of an ISO 3448 viscosity grade
    /// with a viscosity index of 95, or `None` if the grade does not exist.
    pub fn of_grade(grade: f64) -> Option<[f64; 2]> {
        let place = VISCOSITY_GRADES.iter().position(|known| known.total_cmp(&grade).is_eq())?;
        Some([VISCOSITY_GRADES[place], HOT_GRADES[place]].map(|viscosity| viscosity * 1e-6))
    }
}

impl<D: Real> Oil<D> {
    /// Calculates the properties of the oil at a temperature \[K\] (Y1) to (Y5).
    ///
    /// ```math
    /// \log_{10}\log_{10}(\nu + 0.7) = A - B\log_{10}\theta, \qquad \eta = \nu\rho
    /// ```
    ///
    /// Source: ASTM D341 (Walther equation) for the temperature dependence, and Gold et al. for the
    /// pressure dependence.
    #[inline(always)]
    pub fn at(&self, temperature: D) -> OilState<D> {
        let (warm, hot) = (40.0 + ZERO_CELSIUS, 100.0 + ZERO_CELSIUS);
        let [at_40, at_100] = self.viscosities;
        let at_40 = (at_40 * 1e6 + 0.7).ln() * LN_10.recip();
        let at_100 = (at_100 * 1e6 + 0.7).ln() * LN_10.recip();
        let exponent = (at_40 / at_100).ln() * (hot / warm).ln().recip();
        // log₁₀ log₁₀(ν + 0.7) = A − B log₁₀ θ                             (Y1)
        let z = at_40 * (exponent * (temperature.recip() * warm).ln()).exp();
        let shifted = (z * LN_10).exp();
        let nu = shifted - 0.7;
        // η = ν ρ,  ρ = ρ₁₅ [1 − 6.5·10⁻⁴ (T − 15 °C)]                    (Y2)
        let density = self.density * ((temperature - (ZERO_CELSIUS + 15.0)) * -EXPANSION + 1.0);
        let viscosity = nu * density * 1e-6;
        // β = (ν + 0.7)/ν ln(10) Z B/θ + 6.5·10⁻⁴ ρ₁₅/ρ                   (Y3)
        let temperature_coefficient =
            shifted / nu * z * exponent * LN_10 / temperature + self.density / density * EXPANSION;
        // α = s νᵗ 10⁻⁹                                                   (Y4)
        let (s, t) = self.base.typical().pressure_viscosity;
        let pressure_viscosity = match self.pressure_viscosity {
            Some(known) => known,
            None => nu.powf(t) * (s * 1e-9),
        };
        // η(p) = η exp[p/(a_p + b_p p)],  a_p = 1/α − 2·10⁸ b_p           (Y5)
        let pressure_scale = pressure_viscosity.recip() - 2e8 * PRESSURE_SLOPE;
        OilState {
            temperature,
            kinematic_viscosity: nu * 1e-6,
            density,
            viscosity,
            temperature_coefficient,
            pressure_viscosity,
            pressure_scale,
        }
    }
}

/// Temperature of 0 °C \[K\].
pub const ZERO_CELSIUS: f64 = 273.15;
