//! The inputs of every model of one ball: geometry, friction, speeds and load.
//!
//! Theory: `docs/theory/04-rigid.md`, equation (R1).

use bsm_kin::{Drive, Helix, Scalar};
use bsm_simd::Compare;

use super::state::Transmission;
use crate::contact::{Ball, Coulomb, Load, ideal_torque};
use crate::outcome::{Direction, NoAnswer, Reason};

/// Inertia ratios whose squares and ratios to loads double precision has room for. The extremes of
/// practice and far beyond are between 1e-45 and 1e20.
const INERTIA: [f64; 2] = [1e-100, 1e28];

/// Friction below this is none: it would drown in the rounding of the loads.
const LEAST_FRICTION: f64 = 1e-12;

/// Where a model of friction and inertia takes these, for one point or for several side by side.
///
/// * `inertia_ratio`: `$\mu = m r_m W^2/F_a$`.
#[inline(always)]
pub fn takes<F: Compare>(friction: F, inertia_ratio: F) -> F::Mask {
    takes_friction(friction) & takes_inertia(inertia_ratio)
}

#[inline(always)]
fn takes_friction<F: Compare>(friction: F) -> F::Mask {
    friction.constant(LEAST_FRICTION).le(friction)
}

#[inline(always)]
fn takes_inertia<F: Compare>(ratio: F) -> F::Mask {
    let [least, most] = INERTIA;
    ratio.constant(least).le(ratio) & ratio.le(ratio.constant(most))
}

/// A ball screw at an operating point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OperatingPoint<D = f64> {
    /// Helix of the ball centres.
    pub helix: Helix<D>,
    /// Unloaded contact angle \[rad\], in (0, π/2).
    pub contact_angle: D,
    /// The ball.
    pub ball: Ball<D>,
    /// Friction, positive where it takes part in the balance.
    pub friction: Coulomb<D>,
    /// Speeds of screw and nut.
    pub drive: Drive<D>,
    /// Load on the balls.
    pub load: Load<D>,
}

/// An operating point in units of ball radius, axial load per ball and relative speed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BallUnits<D> {
    /// Helix with radius `$r_m/r_b$`.
    pub(crate) helix: Helix<D>,
    /// Mass of the ball `$m r_b W^2/F_a$`.
    pub(crate) mass: D,
    /// Nut speed over `$W$`.
    pub(crate) nut_speed: D,
    /// Which side drives: the sign of `$W$`.
    pub(crate) direction: Direction,
}

/// What the numbers of a scaled answer are multiplied with.
#[derive(Debug, Clone, Copy)]
pub struct AnswerUnits<F = f64> {
    /// Ball radius `$r_b$` \[m\].
    pub length: F,
    /// Axial load per ball `$F_a$` \[N\].
    pub load: F,
    /// `$r_b F_a Z$`, of all balls together \[N·m\].
    pub torque: F,
    /// Relative speed `$W$` \[rad/s\].
    pub speed: F,
}

impl<F: Compare> AnswerUnits<F> {
    /// Where the load drives.
    #[inline(always)]
    pub fn back(&self) -> F::Mask {
        self.speed.lt(self.speed.constant(0.0))
    }

    /// What the screw transmits, and the violation of its power balance.
    ///
    /// * `ideal`: torque of the frictionless screw \[N·m\]. * `torque`: on the screw, scaled.
    /// * `lost`: friction power over `$W$`, scaled.
    #[inline(always)]
    pub fn transmission(&self, ideal: F, torque: F, lost: F) -> Transmission<F> {
        Transmission::of(self.back(), ideal, torque * self.torque, self.speed)
            .against(lost * self.torque * self.speed)
    }
}

impl<D: Scalar> OperatingPoint<D> {
    /// What the numbers of a scaled answer are multiplied with.
    pub(crate) fn units(&self) -> AnswerUnits<D> {
        let (length, load) = (self.ball.radius, self.load);
        let speed = self.drive.relative_speed();
        AnswerUnits { length, load: load.per_ball(), torque: length * load.axial, speed }
    }

    /// The same point without derivatives.
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

    /// Refuses a point without friction, for models in which friction takes part in the balance.
    pub(crate) fn require_friction(&self) -> Result<(), NoAnswer> {
        if !takes_friction(self.friction.0.re()) {
            return Err(NoAnswer::invalid(Reason::Frictionless));
        }
        Ok(())
    }

    /// The point in its own units (R1).
    ///
    /// # Errors
    ///
    /// [`Reason::NoRelativeSpeed`], [`Reason::InertiaOutOfRange`].
    pub(crate) fn in_own_units(&self) -> Result<BallUnits<D>, NoAnswer> {
        let Self { helix, ball, drive, load, .. } = self;
        let w = drive.relative_speed();
        let direction = Direction::of(w.re()).ok_or(NoAnswer::invalid(Reason::NoRelativeSpeed))?;
        let helix = Helix { radius: helix.radius / ball.radius, ..*helix };
        let mass = ball.scaled_mass(w, load.per_ball());
        let nut_speed = drive.nut_speed / w;
        let inertia_ratio = (mass * helix.radius).re();
        if !takes_inertia(inertia_ratio) || !nut_speed.re().is_finite() {
            return Err(NoAnswer::invalid(Reason::InertiaOutOfRange { inertia_ratio }));
        }
        Ok(BallUnits { helix, mass, nut_speed, direction })
    }

    /// Torque of the frictionless screw.
    pub(crate) fn ideal_torque(&self) -> D {
        ideal_torque(self.load.axial, self.helix.radius, self.helix.lead_angle.tan())
    }
}
