//! Film thickness, friction and losses of a lubricated ball.

use super::losses::OutsidePower;
use super::mixed::MixedFriction;
use crate::outcome::named;

named! {
    /// Lubrication regime of a contact. It is only a label and does not affect the calculation.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Regime {
        /// Asperities carry most of the load.
        Boundary = "boundary",
        /// Asperities and the oil film both carry significant parts of the load.
        Mixed = "mixed",
        /// The oil film carries nearly the whole load.
        FullFilm = "full film",
    }
}

impl Regime {
    /// Returns the lubrication regime for a film ratio.
    pub fn of(film_ratio: f64) -> Self {
        match film_ratio {
            ..0.3 => Self::Boundary,
            ..2.0 => Self::Mixed,
            _ => Self::FullFilm,
        }
    }
}

/// The oil film of one contact, with its friction and rolling resistance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactFilm<F = f64> {
    /// Thickness of the oil film \[m\].
    pub thickness: F,
    /// Film ratio `$\lambda$`: film thickness divided by the combined roughness of both surfaces.
    pub ratio: F,
    /// Film ratio at the minimum film thickness, which occurs at the edge of the contact (Y36).
    pub min_ratio: F,
    /// Asperity load share `$\xi$`: fraction of the load that asperities carry.
    pub asperity_share: F,
    /// Mean friction coefficient: sliding power divided by the sliding power that a friction
    /// coefficient of one would cause (Y22).
    pub friction: F,
    /// Moment that resists rolling \[N·m\].
    pub rolling_moment: F,
    /// Entrainment speed along the track, smoothed by the creep speed \[m/s\].
    pub entrainment: F,
    /// Dimensionless load parameter `$M$` in the formula for the rolling force (Y17). If `$M$` is
    /// below about 10, (Y7) underestimates the film thickness.
    pub load_parameter: F,
    /// Local friction law of the contact, for slip speeds in m/s.
    pub law: MixedFriction<F>,
}

/// Oil, films and losses of a ball in steady motion. All powers are for all balls together \[W\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilmState<F = f64> {
    /// Temperature of the oil \[K\].
    pub temperature: F,
    /// Dynamic viscosity of the oil \[Pa·s\].
    pub viscosity: F,
    /// Pressure-viscosity coefficient of the oil \[1/Pa\].
    pub pressure_viscosity: F,
    /// Oil film at the nut contact.
    pub nut: ContactFilm<F>,
    /// Oil film at the screw contact.
    pub screw: ContactFilm<F>,
    /// Power loss of all balls due to sliding in the contacts.
    pub sliding_power: F,
    /// Power loss of all balls due to rolling resistance.
    pub rolling_power: F,
    /// Power losses outside the contacts of balls and raceways.
    pub outside: OutsidePower<F>,
    /// Temperature rise of the hotter film above the oil temperature due to sliding \[K\] (Y29).
    pub heating: F,
    /// Constant friction coefficient that would cause the same power loss in the contacts as the
    /// lubricant (Y30).
    pub equivalent_friction: F,
    /// Friction coefficient of a plain thread that has the same efficiency as the ball screw (Y31).
    pub catalog_friction: F,
}

impl FilmState {
    /// Returns the mean of the friction coefficients at nut and screw (AC11).
    pub fn mean_friction(&self) -> f64 {
        // f̄ = (μ_A + μ_B)/2                                               (AC11)
        0.5 * (self.nut.friction + self.screw.friction)
    }
}
