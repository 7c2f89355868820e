//! Units of a point: ball radius, axial load per ball, relative speed.

use bsm_case::InputKey;
use bsm_case::units::MM;
use bsm_dyn::Ball;
use bsm_simd::Simd;

use crate::operand::{Given, Lane};

/// Sizes in SI units, and the mass of the ball in its own.
pub(super) struct Units<S: Simd> {
    /// `$r_b$`.
    pub(super) ball: Lane<S>,
    /// `$r_m$`.
    pub(super) pitch: Lane<S>,
    /// Of all balls.
    pub(super) axial: Lane<S>,
    /// Of a ball, `$F_a$`.
    pub(super) load: Lane<S>,
    /// `$W$`.
    pub(super) speed: Lane<S>,
    pub(super) nut_speed: Lane<S>,
    /// `$m r_b W^2/F_a$`.
    pub(super) mass: Lane<S>,
}

impl<S: Simd> Units<S> {
    #[inline(always)]
    pub(super) fn of(given: &Given<'_, S>) -> Self {
        let ball = given.get(InputKey::ball_diameter_mm) * (0.5 * MM);
        let axial = given.get(InputKey::axial_load_N);
        let load = axial / given.get(InputKey::loaded_balls);
        let zero = ball.constant(0.0);
        let (screw_speed, nut_speed) = given.speeds().unwrap_or((zero, zero));
        let speed = screw_speed - nut_speed;
        let density = given.get(InputKey::density_kg_m3);
        Self {
            ball,
            pitch: given.get(InputKey::pitch_circle_diameter_mm) * (0.5 * MM),
            axial,
            load,
            speed,
            nut_speed,
            mass: Ball::of_density(ball, density).scaled_mass(speed, load),
        }
    }
}
