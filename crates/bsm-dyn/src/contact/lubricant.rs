//! Friction of a lubricant: oil properties, film between ball and raceway, friction at a point,
//! rolling resistance, and losses outside the contacts.
//!
//! Theory: `docs/theory/17-lubricant.md`, equations (Y1) to (Y32).

pub(super) mod film_state;
pub(super) mod losses;
pub(super) mod mixed;
pub(super) mod oil;

use self::losses::Losses;
use self::oil::Oil;

/// A lubricant, the roughness of the surfaces that it separates, and the losses outside the
/// contacts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lubricant<D = f64> {
    /// Properties of the oil. For a grease, these are the properties of the base oil.
    pub oil: Oil<D>,
    /// Lubricant temperature at the inlet of the contacts.
    pub temperature: Temperature<D>,
    /// Friction coefficient of asperity contact `$\mu_b$`, positive.
    pub boundary_friction: D,
    /// Roughness of the balls and grooves.
    pub roughness: Roughness<D>,
    /// Ratio `$\varphi_s$` of the actual film thickness to the film thickness with a sufficient oil
    /// supply, positive.
    pub film_factor: D,
    /// Ratio `$c_R \ge 0$` of the actual rolling force to the rolling force with fully flooded
    /// inlets.
    pub rolling_factor: D,
    /// Fraction `$c_h \ge 0$` of the elastic energy that is lost by hysteresis during rolling.
    pub hysteresis_loss: D,
    /// Parameters of the power losses outside the contacts.
    pub losses: Losses<D>,
}

impl<D: Copy> Lubricant<D> {
    /// Applies a function to every number in the struct.
    #[inline(always)]
    #[must_use]
    #[expect(
        clippy::manual_map,
        reason = "a closure would not be compiled for the instruction set of its caller"
    )]
    pub fn map<E>(&self, f: impl Fn(D) -> E) -> Lubricant<E> {
        let Self { oil, roughness, losses, .. } = self;
        let [at_40, at_100] = oil.viscosities;
        Lubricant {
            oil: Oil {
                base: oil.base,
                viscosities: [f(at_40), f(at_100)],
                density: f(oil.density),
                pressure_viscosity: match oil.pressure_viscosity {
                    Some(known) => Some(f(known)),
                    None => None,
                },
                limiting_shear: f(oil.limiting_shear),
            },
            temperature: match self.temperature {
                Temperature::Known(kelvin) => Temperature::Known(f(kelvin)),
                Temperature::Balance { heat_transfer, ambient } => {
                    Temperature::Balance { heat_transfer: f(heat_transfer), ambient: f(ambient) }
                }
            },
            boundary_friction: f(self.boundary_friction),
            roughness: Roughness {
                ball: f(roughness.ball),
                nut: f(roughness.nut),
                screw: f(roughness.screw),
            },
            film_factor: f(self.film_factor),
            rolling_factor: f(self.rolling_factor),
            hysteresis_loss: f(self.hysteresis_loss),
            losses: Losses {
                seal_torque: f(losses.seal_torque),
                ball_contact_force: f(losses.ball_contact_force),
                ball_contact_friction: f(losses.ball_contact_friction),
                return_circuits: f(losses.return_circuits),
                return_loss: f(losses.return_loss),
                drag_coefficient: f(losses.drag_coefficient),
            },
        }
    }
}

/// Temperature of the lubricant, given or calculated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Temperature<D = f64> {
    /// A given temperature \[K\].
    Known(D),
    /// The temperature at which the heat transfer to the surroundings equals all power losses.
    Balance {
        /// Heat transfer to the surroundings per kelvin `$hA$` \[W/K\], positive.
        heat_transfer: D,
        /// Temperature of the surroundings \[K\].
        ambient: D,
    },
}

/// Root mean square (RMS) roughness of the surfaces \[m\], positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Roughness<D = f64> {
    /// Roughness of the balls.
    pub ball: D,
    /// Roughness of the nut groove.
    pub nut: D,
    /// Roughness of the screw groove.
    pub screw: D,
}
