//! Inputs that all single-ball models share: geometry, friction, speeds and load.
//!
//! Theory: `docs/theory/04-rigid.md`, equation (R1).

use bsm_kin::{Drive, Helix, Real, Scalar};

use super::state::Transmission;
use crate::contact::{Ball, Coulomb, Load, ideal_torque};
use crate::outcome::{Direction, Reason, SolveFailure};

/// Minimum inertia ratio (dimensionless). Above this limit, the square of the inertia ratio and the
/// ratios of inertia forces to loads are representable in double precision. Even extreme operating
/// points have inertia ratios above 1e-45.
const MIN_INERTIA_RATIO: f64 = 1e-100;

/// Maximum inertia ratio (dimensionless) at which the balance of inertia forces and loads can be
/// solved in double precision. Even extreme operating points have inertia ratios below 1e20.
const MAX_INERTIA_RATIO: f64 = 1e28;

/// Minimum friction coefficient (dimensionless). With a smaller coefficient, the friction forces
/// would be lost in the rounding errors of the loads.
const MIN_FRICTION: f64 = 1e-12;

/// Returns true if friction and inertia are within the range of the models whose force balance
/// includes friction, for one operating point or for several points side by side in a SIMD vector.
///
/// * `inertia_ratio`: ratio of inertia force to axial load, `$\mu = m r_m W^2/F_a$`.
#[inline(always)]
pub(crate) fn is_in_range<F: Real>(friction: F, inertia_ratio: F) -> F::Mask {
    is_friction_in_range(friction) & is_inertia_in_range(inertia_ratio)
}

#[inline(always)]
fn is_friction_in_range<F: Real>(friction: F) -> F::Mask {
    friction.at_least(MIN_FRICTION)
}

#[inline(always)]
fn is_inertia_in_range<F: Real>(ratio: F) -> F::Mask {
    ratio.at_least(MIN_INERTIA_RATIO) & ratio.at_most(MAX_INERTIA_RATIO)
}

/// A ball screw at an operating point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OperatingPoint<D = f64> {
    /// Helix of the ball centers.
    pub helix: Helix<D>,
    /// Unloaded contact angle \[rad\], in (0, π/2).
    pub contact_angle: D,
    /// Dimensions and mass of a ball.
    pub ball: Ball<D>,
    /// Friction coefficient, which must be positive for models whose force balance includes
    /// friction.
    pub friction: Coulomb<D>,
    /// Angular speeds of the screw and the nut.
    pub drive: Drive<D>,
    /// External load on the balls.
    pub load: Load<D>,
}

/// An operating point in scaled units, which are based on the ball radius, the axial load per ball
/// and the relative speed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ScaledPoint<D> {
    /// Helix of the ball centers, whose radius is the ratio `$r_m/r_b$` in scaled units.
    pub(crate) helix: Helix<D>,
    /// Dimensionless mass of the ball `$m r_b W^2/F_a$`.
    pub(crate) mass: D,
    /// Ratio of nut speed to relative speed `$\Omega_n/W$`.
    pub(crate) nut_speed: D,
    /// Direction of the drive, which is the sign of `$W$`.
    pub(crate) direction: Direction,
}

/// Factors that convert a scaled result to SI units.
#[derive(Debug, Clone, Copy)]
pub struct ResultUnits<F = f64> {
    /// Ball radius `$r_b$` \[m\].
    pub length: F,
    /// Axial load per ball `$F_a$` \[N\].
    pub load: F,
    /// Torque unit for all balls together, `$r_b F_a Z$` \[N·m\].
    pub torque: F,
    /// Relative speed `$W$` \[rad/s\].
    pub speed: F,
}

impl<F: Real> ResultUnits<F> {
    /// Returns true if the load back-drives the screw.
    #[inline(always)]
    pub fn back(&self) -> F::Mask {
        self.speed.below(0.0)
    }

    /// Returns the efficiency, the torque and the powers, together with the relative error of the
    /// power balance.
    ///
    /// * `ideal`: torque of the frictionless screw \[N·m\].
    /// * `torque`: scaled torque on the screw.
    /// * `friction_power`: scaled friction power divided by `$W$`.
    #[inline(always)]
    pub fn transmission(&self, ideal: F, torque: F, friction_power: F) -> Transmission<F> {
        Transmission::of(self.back(), ideal, torque * self.torque, self.speed)
            .with_power_balance(friction_power * self.torque * self.speed)
    }
}

impl<D: Scalar> OperatingPoint<D> {
    /// Returns the factors that convert a scaled result to SI units.
    pub(crate) fn units(&self) -> ResultUnits<D> {
        let (length, load) = (self.ball.radius, self.load);
        let speed = self.drive.relative_speed();
        ResultUnits { length, load: load.per_ball(), torque: length * load.axial, speed }
    }

    /// Returns the operating point without derivatives.
    pub(crate) fn values(&self) -> OperatingPoint {
        let Self { helix, ball, drive, load, .. } = self;
        OperatingPoint {
            helix: Helix { radius: helix.radius.re(), lead_angle: helix.lead_angle.re() },
            contact_angle: self.contact_angle.re(),
            ball: Ball { radius: ball.radius.re(), mass: ball.mass.re() },
            friction: Coulomb(self.friction.0.re()),
            drive: Drive { screw_speed: drive.screw_speed.re(), nut_speed: drive.nut_speed.re() },
            load: Load { axial: load.axial.re(), balls: load.balls.re() },
        }
    }

    /// Checks that the friction is large enough for models whose force balance includes friction.
    ///
    /// # Errors
    ///
    /// Returns [`Reason::Frictionless`] if the friction coefficient is too small.
    pub(crate) fn require_friction(&self) -> Result<(), SolveFailure> {
        if !is_friction_in_range(self.friction.0.re()) {
            return Err(SolveFailure::invalid(Reason::Frictionless));
        }
        Ok(())
    }

    /// Returns the operating point in scaled units, which are based on the ball radius, the axial
    /// load per ball and the relative speed (R1).
    ///
    /// # Errors
    ///
    /// Returns [`Reason::NoRelativeSpeed`] if the nut and the screw turn at the same speed, and
    /// [`Reason::InertiaOutOfRange`] if the inertia ratio is too small or too large.
    pub(crate) fn scaled(&self) -> Result<ScaledPoint<D>, SolveFailure> {
        let Self { helix, ball, drive, load, .. } = self;
        let w = drive.relative_speed();
        let direction =
            Direction::of(w.re()).ok_or(SolveFailure::invalid(Reason::NoRelativeSpeed))?;
        let helix = Helix { radius: helix.radius / ball.radius, ..*helix };
        let mass = ball.scaled_mass(w, load.per_ball());
        let nut_speed = drive.nut_speed / w;
        let inertia_ratio = (mass * helix.radius).re();
        if !is_inertia_in_range(inertia_ratio) || !nut_speed.re().is_finite() {
            return Err(SolveFailure::invalid(Reason::InertiaOutOfRange { inertia_ratio }));
        }
        Ok(ScaledPoint { helix, mass, nut_speed, direction })
    }

    /// Returns the torque of the frictionless screw \[N·m\].
    pub(crate) fn ideal_torque(&self) -> D {
        ideal_torque(self.load.axial, self.helix.radius, self.helix.lead_angle.tan())
    }
}
