//! Balance of the ball in steady motion, and the torque and power that it transmits.
//!
//! Theory: `docs/theory/02-balance.md`, equations (B1) to (B10).

use std::f64::consts::PI;
use std::ops::{Add, Mul};

use bsm_kin::{BallFrame, Field, FieldOver, Motion, Scalar};
use bsm_newton::EvalError;
use bsm_simd::Compare;
use nalgebra::Vector3;

/// Largest relative violation of the power balance (B10) of a result that is returned. An exact
/// root has rounding only; more means that rounding errors have spoilt the result, as they do when the
/// inertia forces are many orders above the load.
pub(crate) const POWER_BALANCE_TOL: f64 = 1e-9;

/// The refusal of a ball that stands still in space, where the moment of its spin is an unknown.
pub(crate) const DOES_NOT_CIRCLE: EvalError = EvalError {
    quantity: "precession rate P of the ball over W",
    value: 0.0,
    requirement: "not zero: a ball that does not circle has no gyroscopic moment",
};

/// A homogeneous ball.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ball<D> {
    /// Radius `$r_b$` \[m\], positive.
    pub radius: D,
    /// Mass `$m$` \[kg\], not negative.
    pub mass: D,
}

impl<D: Field> Ball<D> {
    /// Ball of a given density \[kg/m³\] (B1).
    #[inline(always)]
    pub fn of_density(radius: D, density: D) -> Self {
        // m = (4/3) π r_b³ ρ                                              (B1)
        Self { radius, mass: radius.square() * radius * (4.0 / 3.0 * PI) * density }
    }

    /// Moment of inertia about a diameter \[kg·m²\] (B2).
    #[inline(always)]
    pub fn inertia(&self) -> D {
        // I = (2/5) m r_b²                                                (B2)
        self.mass * self.radius.square() * 0.4
    }

    /// Mass in units of ball radius, axial load per ball and relative speed `$W$` (R1).
    #[inline(always)]
    pub fn scaled_mass(&self, relative_speed: D, load_per_ball: D) -> D {
        // Lengths in r_b, forces in F_a, speeds in W: m r_b W²/F_a        (R1)
        self.mass * self.radius * relative_speed * relative_speed / load_per_ball
    }
}

/// Force and moment about the ball centre, on the ball.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wrench<D> {
    /// Force \[N\].
    pub force: Vector3<D>,
    /// Moment about the ball centre \[N·m\].
    pub moment: Vector3<D>,
}

impl<D: Scalar> Wrench<D> {
    /// Normal load `$Q$` along `normal` and friction, both at `point` from the centre (B3).
    pub fn at_contact(
        normal: &Vector3<D>,
        point: &Vector3<D>,
        load: D,
        friction: &Vector3<D>,
    ) -> Self {
        // F = Q N + F_f,  M = r × F; r ∥ N, so that only friction turns the ball  (B3)
        Self { force: normal * load + friction, moment: point.cross(friction) }
    }

    /// Nothing.
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

/// What the Newton-Euler equations leave over: zero for a steady motion (B4), (B5).
///
/// ```math
/// \sum F_c = m\,r_m P^2 n, \qquad \sum M_c = P\,k \times (I\,\omega)
/// ```
///
/// * `contacts`: sum of all contact wrenches on the ball.
/// * `pitch_radius`: `$r_m$` \[m\]; `motion` is absolute.
///
/// Source: Lin, Velinsky and Ravani, ASME J. Mech. Des. 116 (1994), Eqs 5a-f.
pub(crate) fn newton_euler<D: Scalar>(
    contacts: &Wrench<D>,
    ball: &Ball<D>,
    pitch_radius: D,
    motion: &Motion<D>,
    frame: &BallFrame<D>,
) -> Wrench<D> {
    let rate = motion.precession;
    Wrench {
        // Σ F − m r_m P² n                                                (B4)
        force: contacts.force - frame.n * (ball.mass * pitch_radius * rate.square()),
        // Σ M − P k × (I ω)                                               (B5)
        moment: contacts.moment - frame.k.cross(&motion.omega) * (ball.inertia() * rate),
    }
}

/// Axial force that the nut puts on the ball \[N\]; equals the axial load per ball (B6).
///
/// Source: Lin, Velinsky and Ravani, Eq 9, force row.
pub(crate) fn axial_force<D: Scalar>(nut_force: &Vector3<D>, frame: &BallFrame<D>) -> D {
    // F_a = (Σ_nut F_c)·k                                                 (B6)
    nut_force.dot(&frame.k)
}

/// Torque on the member whose contact wrenches on the ball are `contact`, in the steady state
/// \[N·m\] per ball (B7).
///
/// On the screw it is the torque that holds the motion; the nut's is its opposite, because a
/// steady ball takes no net moment about the axis.
///
/// Source: Lin, Velinsky and Ravani, Eq 9, moment row.
pub(crate) fn torque<D: Scalar>(contact: &Wrench<D>, pitch_radius: D, frame: &BallFrame<D>) -> D {
    // T = [(−r_m n) × F + M]·k                                            (B7)
    (contact.moment - frame.n.cross(&contact.force) * pitch_radius).dot(&frame.k)
}

/// [`torque`] of the screw's normal load and friction on a ball of radius one (B7).
///
/// * `load`: with the friction across the groove and along it. * `lead`, `angle`: sines and cosines of lead
///   angle and contact angle. * `radius`: `$r_m/r_b$`.
#[inline(always)]
pub(crate) fn friction_torque<P: Field, D: FieldOver<P>>(
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
    /// Axial load on the nut, all balls together \[N\], positive.
    pub axial: D,
    /// Number of loaded balls `$Z \ge 1$` that share it equally.
    pub balls: D,
}

impl<D: Field> Load<D> {
    /// Axial load per ball `$F_a$` \[N\].
    #[inline(always)]
    pub fn per_ball(&self) -> D {
        self.axial / self.balls
    }
}

/// Efficiency from the torque on the screw `torque` and the torque `ideal` that a frictionless
/// screw needs or gives (B8).
///
/// Negative: self-locking in that direction.
///
/// * `back`: where the load drives.
#[inline(always)]
pub fn efficiency<F: Field>(back: F::Mask, ideal: F, torque: F) -> F {
    // η = F_a r_m tanα / T  or  T / (F_a r_m tanα)                        (B8)
    F::select(back, torque, ideal) / F::select(back, ideal, torque)
}

/// The torque on the screw of an efficiency, [`efficiency`] the other way (B8).
///
/// * `back`: where the load drives.
#[inline(always)]
pub fn torque_of<F: Field>(back: F::Mask, ideal: F, efficiency: F) -> F {
    F::select(back, ideal * efficiency, ideal / efficiency)
}

/// Torque of the frictionless screw `$F_a r_m \tan\alpha$` \[N·m\] (B9).
#[inline(always)]
pub fn ideal_torque<F: Field>(axial_load: F, pitch_radius: F, tan_lead_angle: F) -> F {
    // T₀ = F_a r_m tanα                                                   (B9)
    axial_load * pitch_radius * tan_lead_angle
}

/// Power that goes in, comes out and is lost \[W\], for a relative speed \[rad/s\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Power<F = f64> {
    /// Power put in.
    pub input: F,
    /// Power got out; negative if both sides must be driven.
    pub output: F,
    /// `input` minus `output`.
    pub dissipated: F,
}

impl<F: Compare> Power<F> {
    /// From the torque on the screw and the torque of the frictionless screw, both \[N·m\].
    #[inline(always)]
    pub fn transmitted(torque: F, ideal: F, relative_speed: F) -> Self {
        let (screw, load) = (torque * relative_speed, ideal * relative_speed);
        let drives = relative_speed.gt(relative_speed.constant(0.0));
        Self {
            input: F::select(drives, screw, -load),
            output: F::select(drives, load, -screw),
            dissipated: screw - load,
        }
    }

    /// Violation of the power balance, relative to the larger of input and friction power (B10).
    ///
    /// ```math
    /// T W - F_a r_m \tan\alpha\, W = \sum_c P_c
    /// ```
    ///
    /// `friction`: sum of the friction powers of all contacts \[W\]. An identity at any exact
    /// root: it checks kinematics and balance against each other.
    #[inline(always)]
    pub fn imbalance(&self, friction: F) -> F {
        // (T W − T₀ W − Σ P_c) / max(|T₀ W|, |T W|, Σ P_c)                (B10)
        let scale = self.input.abs().larger(self.output.abs()).larger(friction);
        (self.dissipated - friction) / scale
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    /// Limit: frictionless contacts at rest; the torque is the ideal one for any contact angle.
    #[test]
    fn frictionless_torque_is_ideal() {
        let (alpha, beta, r_m, r_b) = (0.21_f64, 0.83_f64, 17e-3, 2.5e-3);
        let frame = BallFrame::turned(alpha, 0.0);
        let normal = Vector3::new(0.0, -beta.cos(), -beta.sin());
        let load = 140.0 / (alpha.cos() * beta.sin());
        let screw = Wrench::at_contact(&normal, &(normal * -r_b), load, &Vector3::zeros());
        // The nut carries the opposite force.
        assert_relative_eq!(axial_force(&-screw.force, &frame), 140.0, max_relative = 1e-14);
        let t = torque(&screw, r_m, &frame);
        assert_relative_eq!(t, ideal_torque(140.0, r_m, alpha.tan()), max_relative = 1e-14);
    }

    /// Both directions, both signs of the screw torque.
    #[test]
    fn power_is_positive_where_it_goes_in() {
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

    /// A steel ball, by hand: 4/3 π 4³ mm³ × 7.8 mg/mm³ = 2.09 g.
    #[test]
    fn ball_mass_and_inertia() {
        let ball = Ball::of_density(4e-3, 7800.0);
        assert_relative_eq!(ball.mass, 2.091_044e-3, max_relative = 1e-6);
        assert_relative_eq!(ball.inertia(), 0.4 * ball.mass * 16e-6, max_relative = 1e-15);
    }
}
