//! Units that make the vectorized equations dimensionless: ball radius, axial load per ball, and
//! relative speed.

use bsm_case::InputKey;
use bsm_case::units::{GPA, MM};
use bsm_dyn::lanes::ResultUnits;
use bsm_dyn::{Ball, Material, hertz::contact_modulus};
use bsm_kin::Drive;
use bsm_simd::Simd;

use crate::inputs::{Lane, LaneInputs};

/// Inputs in SI units, from which the dimensionless quantities are calculated, and the
/// dimensionless ball mass.
pub(super) struct Units<S: Simd> {
    /// Ball radius `$r_b$` \[m\].
    pub(super) ball: Lane<S>,
    /// Pitch circle radius `$r_m$` \[m\].
    pub(super) pitch: Lane<S>,
    /// Total axial load of all balls \[N\].
    pub(super) axial: Lane<S>,
    /// Axial load per ball `$F_a$` \[N\].
    pub(super) load: Lane<S>,
    /// Relative speed between screw and nut, `$W$` \[rad/s\].
    pub(super) speed: Lane<S>,
    /// Nut speed `$\Omega_n$` \[rad/s\].
    pub(super) nut_speed: Lane<S>,
    /// Dimensionless ball mass, `$m r_b W^2/F_a$`.
    pub(super) mass: Lane<S>,
}

impl<S: Simd> Units<S> {
    /// Converts the inputs of a block of points to SI units.
    #[inline(always)]
    pub(super) fn of(given: &LaneInputs<'_, S>) -> Self {
        let ball = given.get(InputKey::ball_diameter_mm) * (0.5 * MM);
        let axial = given.get(InputKey::axial_load_N);
        let load = axial / given.get(InputKey::loaded_balls);
        let zero = ball.constant(0.0);
        let drive = given.drive().unwrap_or(Drive { screw_speed: zero, nut_speed: zero });
        let speed = drive.relative_speed();
        let density = given.get(InputKey::density_kg_m3);
        Self {
            ball,
            pitch: given.get(InputKey::pitch_circle_diameter_mm) * (0.5 * MM),
            axial,
            load,
            speed,
            nut_speed: drive.nut_speed,
            mass: Ball::of_density(ball, density).scaled_mass(speed, load),
        }
    }

    /// Returns the factors that convert dimensionless results to SI units.
    #[inline(always)]
    pub(super) fn result_units(&self) -> ResultUnits<Lane<S>> {
        let Self { ball, axial, load, speed, .. } = *self;
        ResultUnits { length: ball, load, torque: ball * axial, speed }
    }
}

/// Returns the dimensionless contact modulus `$E^* r_b^2/F_a$`. If no material is given for the
/// balls, they have the material of the raceways.
#[inline(always)]
pub(super) fn modulus<S: Simd>(given: &LaneInputs<'_, S>, units: &Units<S>) -> Lane<S> {
    let youngs_modulus = given.get(InputKey::youngs_modulus_GPa);
    let poisson_ratio = given.get(InputKey::poisson_ratio);
    let raceways = Material { youngs_modulus, poisson_ratio };
    let ball = Material {
        youngs_modulus: given.try_get(InputKey::ball_youngs_modulus_GPa).unwrap_or(youngs_modulus),
        poisson_ratio: given.try_get(InputKey::ball_poisson_ratio).unwrap_or(poisson_ratio),
    };
    contact_modulus(&raceways, &ball) * GPA * (units.ball * units.ball) / units.load
}
