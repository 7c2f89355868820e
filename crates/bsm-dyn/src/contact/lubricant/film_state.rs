//! Results for a lubricated ball.

use super::losses::OutsidePower;
use super::mixed::MixedFriction;
use crate::outcome::named;

named! {
    /// How the surfaces of a contact are separated; no equation uses it.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Regime {
        /// Asperities carry most of the load.
        Boundary = "boundary",
        /// Asperities and film carry it.
        Mixed = "mixed",
        /// The film carries it.
        FullFilm = "full film",
    }
}

impl Regime {
    /// Of a film over the roughness.
    pub fn of(film_ratio: f64) -> Self {
        match film_ratio {
            ..0.3 => Self::Boundary,
            ..2.0 => Self::Mixed,
            _ => Self::FullFilm,
        }
    }
}

/// The film of a contact, and what it costs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactFilm<F = f64> {
    /// Thickness \[m\].
    pub thickness: F,
    /// Thickness over the roughness of both surfaces `$\lambda$`.
    pub ratio: F,
    /// The same of the least thickness, at the edge of the contact (Y36).
    pub least_ratio: F,
    /// Share of the load that asperities carry `$\xi$`.
    pub asperity_share: F,
    /// Mean friction coefficient: sliding power over that of a coefficient of one (Y22).
    pub friction: F,
    /// Couple against rolling \[N·m\].
    pub rolling_moment: F,
    /// Mean speed of both surfaces along the track, with the creep speed \[m/s\].
    pub entrainment: F,
    /// How far the load deforms the inlet `$M$` (Y17): below some 10 the film of (Y7) is too thin.
    pub elasticity: F,
    /// Friction at its points, of slip speeds in m/s.
    pub law: MixedFriction<F>,
}

/// Oil, films and losses of a steady ball; powers of all balls together \[W\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilmState<F = f64> {
    /// Temperature of the oil \[K\].
    pub temperature: F,
    /// Its dynamic viscosity \[Pa·s\].
    pub viscosity: F,
    /// Its pressure-viscosity coefficient \[1/Pa\].
    pub pressure_viscosity: F,
    /// At the nut.
    pub nut: ContactFilm<F>,
    /// At the screw.
    pub screw: ContactFilm<F>,
    /// Lost by sliding at the contacts.
    pub sliding_power: F,
    /// Lost by rolling.
    pub rolling_power: F,
    /// Lost outside the contacts.
    pub outside: OutsidePower<F>,
    /// By how much the hotter film is above the temperature of the oil \[K\] (Y29).
    pub heating: F,
    /// The constant coefficient with the same loss at the contacts (Y30).
    pub equivalent_friction: F,
    /// The coefficient of a plain thread of the same efficiency (Y31).
    pub catalogue_friction: F,
}
