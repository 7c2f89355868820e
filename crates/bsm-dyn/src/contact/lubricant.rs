//! Friction from the lubricant: the oil, the film between ball and raceway, friction at a point, rolling
//! resistance, and what is lost outside the contacts.
//!
//! Theory: `docs/theory/17-lubricant.md`, equations (Y1) to (Y32).

pub(super) mod film_state;
pub(super) mod losses;
pub(super) mod mixed;
pub(super) mod oil;

use self::losses::Losses;
use self::oil::Oil;

/// A lubricant, the surfaces that it separates, and what it loses outside the contacts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lubricant<D = f64> {
    /// The oil; of a grease its base oil.
    pub oil: Oil<D>,
    /// Temperature at the inlet of the contacts.
    pub temperature: Temperature<D>,
    /// Friction coefficient where asperities touch `$\mu_b$`, positive.
    pub boundary_friction: D,
    /// Of the surfaces.
    pub roughness: Roughness<D>,
    /// Film over that of plenty of oil `$\varphi_s$`, positive.
    pub film_factor: D,
    /// Rolling force over that of flooded inlets `$c_R \ge 0$`.
    pub rolling_factor: D,
    /// Part of the elastic energy that rolling loses `$c_h \ge 0$`.
    pub hysteresis_loss: D,
    /// Outside the contacts.
    pub losses: Losses<D>,
}

/// Temperature of the lubricant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Temperature<D = f64> {
    /// It is known \[K\].
    Known(D),
    /// All that is lost heats it.
    Balance {
        /// Heat that leaves for each kelvin above the surroundings `$hA$` \[W/K\], positive.
        heat_transfer: D,
        /// Temperature of the surroundings \[K\].
        ambient: D,
    },
}

/// Root mean square roughness of the surfaces \[m\], positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Roughness<D = f64> {
    /// Of the balls.
    pub ball: D,
    /// Of the groove of the nut.
    pub nut: D,
    /// Of the groove of the screw.
    pub screw: D,
}
