//! Force and moment balance of the ball in steady motion, and the torque and power that the ball
//! transmits.
//!
//! Theory: `docs/theory/02-balance.md`, equations (B1) to (B10).

use std::f64::consts::PI;
use std::ops::{Add, Mul};

use bsm_kin::{BallFrame, Motion, Real, RealOver, Scalar};
use bsm_newton::EvalError;
use nalgebra::Vector3;

/// Maximum relative error of the power balance (B10) of a result. For an exact root, only rounding
/// errors remain. A larger error means that rounding errors have corrupted the result, which
/// happens if the inertia forces exceed the load by many orders of magnitude.
pub(crate) const POWER_BALANCE_TOL: f64 = 1e-9;

/// Error that is returned if the ball does not orbit the screw axis. For such a ball, the spin
/// moment would be an additional unknown.
pub(crate) const DOES_NOT_ORBIT: EvalError = EvalError {
    quantity: "ratio of precession rate P to relative speed W",
    value: 0.0,
    requirement: "must not be zero, because a ball that does not orbit has no gyroscopic moment",
};

/// A solid ball of uniform density.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ball<D> {
    /// Ball radius `$r_b$` \[m\], positive.
    pub radius: D,
    /// Ball mass `$m$` \[kg\], not negative.
    pub mass: D,
}

impl<D: Real> Ball<D> {
    /// Creates a ball with a given density \[kg/m³\] (B1).
    #[inline(always)]
    pub fn of_density(radius: D, density: D) -> Self {
        // m = (4/3) π r_b³ ρ                                              (B1)
        Self { radius, mass: radius.square() * radius * (4.0 / 3.0 * PI) * density }
    }

    /// Returns the moment of inertia of the ball about a diameter \[kg·m²\] (B2).
    #[inline(always)]
    pub fn inertia(&self) -> D {
        // I = (2/5) m r_b²                                                (B2)
        self.mass * self.radius.square() * 0.4
    }

    /// Returns the mass of the ball in scaled units. Lengths are divided by the ball radius, forces
    /// by the axial load per ball, and speeds by the relative speed `$W$` (R1).
    #[inline(always)]
    pub fn scaled_mass(&self, relative_speed: D, load_per_ball: D) -> D {
        // Scaled mass: m r_b W²/F_a (R1)
        self.mass * self.radius * relative_speed * relative_speed / load_per_ball
    }
}

/// Force and moment that act on the ball; the moment is about the ball center.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wrench<D> {
    /// Force on the ball \[N\].
    pub force: Vector3<D>,
    /// Moment about the ball center \[N·m\].
    pub moment: Vector3<D>,
}

impl<D: Scalar> Wrench<D> {
    /// Creates the wrench of a contact: the normal load `$Q$` along `normal`, and the friction
    /// force. Both act at `point`, which is given relative to the ball center (B3).
    pub fn at_contact(
        normal: &Vector3<D>,
        point: &Vector3<D>,
        load: D,
        friction: &Vector3<D>,
    ) -> Self {
        // F = Q N + F_f,  M = r × F; r ∥ N, so only friction causes a moment  (B3)
        Self { force: normal * load + friction, moment: point.cross(friction) }
    }

    /// Creates a wrench whose force and moment are zero.
    pub(crate) fn zero() -> Self {
        let zero = Vector3::repeat(D::from(0.0));
        Self { force: zero, moment: zero }
    }
}

impl<D: Scalar> Mul<D> for Wrench<D> {
    type Output = Self;

    fn mul(self, factor: D) -> Self {
        Self { force: self.force * factor, moment: self.moment * factor }
    }
}

impl<D: Scalar> Add for Wrench<D> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { force: self.force + other.force, moment: self.moment + other.moment }
    }
}

/// Returns the residuals of the Newton-Euler equations of the ball, which are zero for a steady
/// motion (B4), (B5).
///
/// ```math
/// \sum F_c = m\,r_m P^2 n, \qquad \sum M_c = P\,k \times (I\,\omega)
/// ```
///
/// * `contacts`: sum of all contact wrenches on the ball.
/// * `pitch_radius`: pitch circle radius `$r_m$` \[m\].
/// * `motion`: absolute motion of the ball.
///
/// Source: Lin, Velinsky and Ravani, ASME J. Mech. Des. 116 (1994), Equations 5a to 5f.
pub(crate) fn newton_euler<D: Scalar>(
    contacts: &Wrench<D>,
    ball: &Ball<D>,
    pitch_radius: D,
    motion: &Motion<D>,
    frame: &BallFrame<D>,
) -> Wrench<D> {
    let rate = motion.precession;
    Wrench {
        // Residual force: Σ F − m r_m P² n                                (B4)
        force: contacts.force - frame.n * (ball.mass * pitch_radius * rate.square()),
        // Residual moment: Σ M − P k × (I ω)                              (B5)
        moment: contacts.moment - frame.k.cross(&motion.omega) * (ball.inertia() * rate),
    }
}

/// Returns the axial force of the nut on the ball \[N\]. In steady motion, it equals the axial load
/// per ball (B6).
///
/// Source: Lin, Velinsky and Ravani, Equation 9 (force equation).
pub(crate) fn axial_force<D: Scalar>(nut_force: &Vector3<D>, frame: &BallFrame<D>) -> D {
    // F_a = (Σ_nut F_c)·k                                                 (B6)
    nut_force.dot(&frame.k)
}

/// Returns the steady torque per ball \[N·m\] on the body (screw or nut) whose contacts exert the
/// wrench `contact` on the ball (B7).
///
/// The torque on the screw maintains the motion. The torque on the nut is equal and opposite,
/// because the net moment about the screw axis on a ball in steady motion is zero.
///
/// Source: Lin, Velinsky and Ravani, Equation 9 (moment equation).
pub(crate) fn torque<D: Scalar>(contact: &Wrench<D>, pitch_radius: D, frame: &BallFrame<D>) -> D {
    // T = [(−r_m n) × F + M]·k                                            (B7)
    (contact.moment - frame.n.cross(&contact.force) * pitch_radius).dot(&frame.k)
}

/// Returns the [`torque`] due to normal load and friction at the screw for a ball of radius one
/// (B7).
///
/// * `load`: normal load, followed by the friction forces across and along the groove.
/// * `lead`, `angle`: sines and cosines of lead angle and contact angle.
/// * `radius`: ratio of pitch circle radius to ball radius `$r_m/r_b$`.
#[inline(always)]
pub(crate) fn unit_ball_torque<P: Real, D: RealOver<P>>(
    (load, [across, along]): (D, [D; 2]),
    lead: (P, P),
    (sin, cos): (D, D),
    radius: P,
) -> D {
    // T = [(−r_m n) × F + M]·k                                            (B7)
    let force = along * lead.1 + (load * sin - across * cos) * lead.0;
    force * radius + across * lead.0 - along * cos * lead.1
}

/// External load on the balls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Load<D = f64> {
    /// Axial load on the nut for all balls together \[N\], positive.
    pub axial: D,
    /// Number of loaded balls `$Z \ge 1$`. All balls carry equal loads.
    pub balls: D,
}

impl<D: Real> Load<D> {
    /// Returns the axial load per ball `$F_a$` \[N\].
    #[inline(always)]
    pub fn per_ball(&self) -> D {
        self.axial / self.balls
    }
}

/// Returns the efficiency for a given torque on the screw (B8). `ideal` is the torque of the screw
/// without friction.
///
/// A negative efficiency means that the screw is self-locking in the given direction of the power
/// flow.
///
/// * `back`: true if the load back-drives the screw.
#[inline(always)]
pub(crate) fn efficiency<F: Real>(back: F::Mask, ideal: F, torque: F) -> F {
    // η = F_a r_m tanα / T, or T / (F_a r_m tanα) for back-driving        (B8)
    F::select(back, torque, ideal) / F::select(back, ideal, torque)
}

/// Returns the torque on the screw for a given efficiency (B8). This function is the inverse of
/// [`efficiency`].
///
/// * `back`: true if the load back-drives the screw.
#[inline(always)]
pub(crate) fn torque_of<F: Real>(back: F::Mask, ideal: F, efficiency: F) -> F {
    F::select(back, ideal * efficiency, ideal / efficiency)
}

/// Returns the torque of the frictionless screw, `$F_a r_m \tan\alpha$` \[N·m\] (B9).
#[inline(always)]
pub fn ideal_torque<F: Real>(axial_load: F, pitch_radius: F, tan_lead_angle: F) -> F {
    // T₀ = F_a r_m tanα                                                   (B9)
    axial_load * pitch_radius * tan_lead_angle
}

/// Input power, output power and power loss \[W\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Power<F = f64> {
    /// Power that is supplied at the driving side.
    pub input: F,
    /// Power at the driven side; negative if power must be supplied to both sides.
    pub output: F,
    /// Power loss, which is `input` minus `output`.
    pub dissipated: F,
}

impl<F: Real> Power<F> {
    /// Calculates the powers from the torque on the screw \[N·m\], the torque of the frictionless
    /// screw \[N·m\] and the relative speed \[rad/s\].
    #[inline(always)]
    pub fn transmitted(torque: F, ideal: F, relative_speed: F) -> Self {
        let (screw, load) = (torque * relative_speed, ideal * relative_speed);
        let drives = relative_speed.above(0.0);
        Self {
            input: F::select(drives, screw, -load),
            output: F::select(drives, load, -screw),
            dissipated: screw - load,
        }
    }

    /// Returns the error of the power balance, divided by the larger of input power and friction
    /// power (B10).
    ///
    /// ```math
    /// T W - F_a r_m \tan\alpha\, W = \sum_c P_c
    /// ```
    ///
    /// `friction` is the sum of the friction powers of all contacts \[W\]. An exact root satisfies
    /// the power balance identically, so an error of the power balance reveals inconsistencies
    /// between kinematics and force balance.
    #[inline(always)]
    pub fn imbalance(&self, friction: F) -> F {
        // Imbalance: (T W − T₀ W − Σ P_c) / max(|T₀ W|, |T W|, Σ P_c)     (B10)
        let scale = self.input.abs().larger(self.output.abs()).larger(friction);
        (self.dissipated - friction) / scale
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    /// For frictionless contacts at rest, the torque equals the torque of the ideal screw for any
    /// contact angle.
    #[test]
    fn torque_without_friction_is_the_ideal_torque() {
        let (alpha, beta, r_m, r_b) = (0.21_f64, 0.83_f64, 17e-3, 2.5e-3);
        let frame = BallFrame::turned(alpha, 0.0);
        let normal = Vector3::new(0.0, -beta.cos(), -beta.sin());
        let load = 140.0 / (alpha.cos() * beta.sin());
        let screw = Wrench::at_contact(&normal, &(normal * -r_b), load, &Vector3::zeros());
        // The force of the nut is opposite to the force of the screw.
        assert_relative_eq!(axial_force(&-screw.force, &frame), 140.0, max_relative = 1e-14);
        let t = torque(&screw, r_m, &frame);
        assert_relative_eq!(t, ideal_torque(140.0, r_m, alpha.tan()), max_relative = 1e-14);
    }

    /// Input and output powers are positive for both directions of the power flow, which correspond
    /// to positive and negative relative speeds.
    #[test]
    fn input_and_output_powers_are_positive() {
        let driving = Power::transmitted(1.2_f64, 1.0, 3.0);
        assert_relative_eq!(driving.input, 3.6);
        assert_relative_eq!(driving.output, 3.0);
        let driven = Power::transmitted(0.8_f64, 1.0, -3.0);
        assert_relative_eq!(driven.input, 3.0);
        assert_relative_eq!(driven.output, 2.4, max_relative = 1e-15);
        assert_relative_eq!(driven.dissipated, 0.6, max_relative = 1e-15);
        assert_relative_eq!(driven.imbalance(0.6), 0.0, epsilon = 1e-15);
        assert_relative_eq!(driven.imbalance(0.3), 0.1, max_relative = 1e-14);
    }

    /// A hand calculation for a steel ball gives a mass of 4/3 π 4³ mm³ × 7.8 mg/mm³ = 2.09 g.
    #[test]
    fn mass_and_inertia_match_a_hand_calculation() {
        let ball = Ball::of_density(4e-3, 7800.0);
        assert_relative_eq!(ball.mass, 2.091_044e-3, max_relative = 1e-6);
        assert_relative_eq!(ball.inertia(), 0.4 * ball.mass * 16e-6, max_relative = 1e-15);
    }
}
