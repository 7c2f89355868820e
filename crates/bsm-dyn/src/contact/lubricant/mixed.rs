//! Friction at a point of a lubricated contact.
//!
//! Theory: `docs/theory/17-lubricant.md`, equations (Y10) to (Y13).

use bsm_kin::{Real, RealOver, Scalar};

use super::oil::{OilState, PRESSURE_SLOPE};
use crate::contact::friction::FrictionLaw;
use crate::contact::transition::Transition;

/// Mixed friction: the friction of asperities in contact, together with the friction of the oil
/// that is sheared between the surfaces.
///
/// ```math
/// \mu = \xi\mu_b + (1-\xi)\,\Lambda\Big[1 + \Big(\frac{\Lambda p}{\tau_y}\Big)^4\Big]^{-1/4},
/// \qquad \tau_y = \tau_E\,\mathrm{arsinh}\frac{\eta(p)\,s}{h\,\tau_E}
/// ```
///
/// Source: Eyring's law with the limiting shear stress of Bair and Winer (1979). The two friction
/// coefficients are averaged with their load fractions as weights, as in Zhou and Hoeprich (1991).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MixedFriction<D = f64> {
    /// Asperity load share `$\xi$`: fraction of the load that asperities carry.
    pub asperity_share: D,
    /// Friction coefficient of asperities in contact `$\mu_b$`.
    pub boundary: D,
    /// Ratio `$\Lambda$` of the limiting shear stress of the oil to the pressure.
    pub limiting_shear: D,
    /// Eyring stress `$\tau_E$` \[Pa\].
    pub eyring_stress: D,
    /// Maximum pressure in the contact \[Pa\].
    pub max_pressure: D,
    /// Pressure parameter `$a_p$` of (Y5) \[Pa\].
    pub pressure_scale: D,
    /// Factor `$\eta/(h\,\tau_E)$` by which the slip speed is multiplied in (Y11). Its unit is the
    /// reciprocal of the unit in which slip speeds are given.
    pub shear: D,
}

impl<D> MixedFriction<D> {
    /// Applies a function to every number in the struct.
    #[inline(always)]
    pub(crate) fn map<E>(&self, f: impl Fn(&D) -> E) -> MixedFriction<E> {
        MixedFriction {
            asperity_share: f(&self.asperity_share),
            boundary: f(&self.boundary),
            limiting_shear: f(&self.limiting_shear),
            eyring_stress: f(&self.eyring_stress),
            max_pressure: f(&self.max_pressure),
            pressure_scale: f(&self.pressure_scale),
            shear: f(&self.shear),
        }
    }
}

/// Friction properties of an oil at its temperature.
pub(crate) struct OilFriction<'a, D> {
    /// Viscosity and pressure parameters of the oil.
    pub(crate) state: &'a OilState<D>,
    /// Limiting shear stress divided by the pressure, `$\Lambda$`.
    pub(crate) limiting_shear: D,
    /// Friction coefficient of the asperity contacts, `$\mu_b$`.
    pub(crate) boundary: D,
}

/// Oil film of a loaded contact.
pub(crate) struct LoadedFilm<D> {
    /// Central film thickness \[m\].
    pub(crate) thickness: D,
    /// Share of the load that asperities carry, `$\xi$`.
    pub(crate) asperity_share: D,
    /// Maximum pressure in the contact \[Pa\].
    pub(crate) max_pressure: D,
}

impl<D: Real> MixedFriction<D> {
    /// Creates the friction law of an oil film.
    ///
    /// * `speed_unit`: unit in which slip speeds are given \[m/s\].
    #[inline(always)]
    pub(crate) fn of<P: Real>(oil: &OilFriction<'_, P>, film: &LoadedFilm<D>, speed_unit: P) -> Self
    where
        D: RealOver<P>,
    {
        let OilFriction { state, limiting_shear, boundary } = oil;
        let &LoadedFilm { thickness, asperity_share, max_pressure } = film;
        let zero = thickness.constant(0.0);
        let (limiting_shear, boundary) = (zero + *limiting_shear, zero + *boundary);
        // τ_E = 2 Λ (a_p + b_p p_max)                                     (Y10)
        let pressure_scale = zero + state.pressure_scale;
        let eyring_stress = (max_pressure * PRESSURE_SLOPE + pressure_scale) * limiting_shear * 2.0;
        let shear = (thickness * eyring_stress).recip() * (state.viscosity * speed_unit);
        Self {
            asperity_share,
            boundary,
            limiting_shear,
            eyring_stress,
            max_pressure,
            pressure_scale,
            shear,
        }
    }

    /// Converts the friction law to a different unit of speed. The argument is the old unit of
    /// speed, expressed in the new unit.
    #[inline(always)]
    pub(crate) fn in_unit(self, speed_unit: D) -> Self {
        Self { shear: self.shear / speed_unit, ..self }
    }

    /// Returns the friction coefficient at a point of the contact. The arguments are the pressure,
    /// divided by the maximum pressure, and the slip speed.
    #[inline(always)]
    pub(crate) fn at(&self, pressure: D, speed: D) -> D {
        let p = self.max_pressure * pressure;
        let thickened = (p / (p * PRESSURE_SLOPE + self.pressure_scale)).exp();
        // τ_y = τ_E arsinh[η(p) s/(h τ_E)]                                (Y11)
        let stress = self.eyring_stress * (thickened * self.shear * speed).asinh();
        // μ_f = Λ [1 + (Λ p/τ_y)⁴]^{−1/4}                                 (Y12)
        let fourth = (self.limiting_shear * p / stress).square().square();
        let fluid = self.limiting_shear / (fourth + 1.0).sqrt().sqrt();
        // μ = ξ μ_b + (1 − ξ) μ_f                                         (Y13)
        self.asperity_share * self.boundary + (-self.asperity_share + 1.0) * fluid
    }

    /// Returns the friction coefficient that would result if the oil reached its limiting shear
    /// stress everywhere in the contact.
    #[inline(always)]
    pub fn max_friction(&self) -> D {
        self.asperity_share * self.boundary + (-self.asperity_share + 1.0) * self.limiting_shear
    }
}

impl<D: Scalar> MixedFriction<D> {
    /// Returns a copy of the friction law in plain numbers, without derivatives.
    pub(crate) fn values(&self) -> MixedFriction {
        MixedFriction {
            asperity_share: self.asperity_share.re(),
            boundary: self.boundary.re(),
            limiting_shear: self.limiting_shear.re(),
            eyring_stress: self.eyring_stress.re(),
            max_pressure: self.max_pressure.re(),
            pressure_scale: self.pressure_scale.re(),
            shear: self.shear.re(),
        }
    }
}

impl<D: Scalar> FrictionLaw<D> for MixedFriction<D> {
    fn coefficient(&self, pressure: D, speed: D) -> D {
        self.at(pressure, speed)
    }

    fn bend(&self) -> Option<Transition> {
        Some(Transition::of(&self.values()))
    }
}

impl Transition {
    /// Returns the transition of the friction coefficient along a chord for a given friction law.
    pub(crate) fn of(law: &MixedFriction) -> Self {
        Self { shear: 2.0 * law.shear, scale: law.pressure_scale / law.max_pressure }
    }
}
