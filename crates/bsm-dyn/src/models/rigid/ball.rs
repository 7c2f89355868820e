//! A ball between rigid contacts in scaled units, its motion, and the residuals of its equations,
//! for one operating point or for several points side by side in a SIMD vector.
//!
//! Theory: `docs/theory/04-rigid.md`, equations (R1) to (R10), (R12), (R21), (R23).

use bsm_kin::{Real, RealOver};

use crate::contact::{Sines, ideal_torque};
use crate::models::ball::{BALL_UNKNOWNS, is_in_range};

/// A vector in the tangent plane of a contact, with components along `$e_x$` (across the groove)
/// and `$t$` (along the helix).
pub type Plane<D> = [D; 2];

/// An operating point in scaled units, which are based on the ball radius, the axial load per ball
/// and the relative speed (R1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidBall<P = f64> {
    /// Sines and cosines of lead angle `$\alpha$` and contact angle `$\beta$`.
    pub(super) sines: Sines<P>,
    /// Cotangent of the contact angle, `$\cot\beta$`.
    pub(super) cot_b: P,
    /// Sine of twice the contact angle, `$\sin 2\beta$`.
    pub(super) sin_2b: P,
    /// Cosine of twice the contact angle, `$\cos 2\beta$`.
    pub(super) cos_2b: P,
    /// Component `$\cos\alpha\sin\beta$` of the screw axis along N.
    pub(super) k_n: P,
    /// Component `$\cos\alpha\cos\beta$` of the screw axis along `$e_x$`.
    pub(super) k_e: P,
    /// Friction coefficient `$F$` with the sign of `$W$`, so that friction opposes the slip divided
    /// by `$W$`.
    pub(super) signed: P,
    /// Ratio of pitch circle radius to ball radius `$r_m/r_b$`.
    pub(super) radius: P,
    /// Arc length of the helix per radian, divided by the ball radius, `$d/r_b$`.
    pub(super) arc: P,
    /// Inertia ratio `$\mu = m r_m W^2/F_a$`.
    pub(super) inertia_ratio: P,
    /// Moment of inertia `$I$`, divided by `$F_a r_b/W^2$`.
    pub(super) inertia: P,
    /// Ratio of nut speed to relative speed `$\Omega_n/W$`.
    pub(super) nut_speed: P,
    /// Length `$h$` of the projection of the screw axis onto the plane of `$e_x$` and `$t$`.
    pub(super) h: P,
    /// Reciprocal of the length `$h$`.
    pub(super) per_h: P,
    /// Cosine `$\cos\psi$` of the direction `$\psi$` of the screw axis in the plane of `$e_x$` and
    /// `$t$`.
    pub(super) cos_psi: P,
    /// Sine `$\sin\psi$` of the direction `$\psi$` of the screw axis in the plane of `$e_x$` and
    /// `$t$`.
    pub(super) sin_psi: P,
}

/// Motion and loads of a [`RigidBall`] in scaled units. Arrays with three elements contain the
/// values at the contacts A, A' and B.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidMotion<D = f64> {
    /// Load ratios `$Q/F_a$`.
    pub loads: [D; 3],
    /// Slip speeds divided by `$r_b|W|$`. A negative slip speed at contact A means that the
    /// equations were continued beyond rolling.
    pub speeds: [D; 3],
    /// Unit vectors in the slip directions, where each slip is divided by `$W$`. The friction force
    /// with the signed friction coefficient acts in the opposite direction.
    pub directions: [Plane<D>; 3],
    /// Precession rate relative to the nut `$p = (P - \Omega_n)/W$`.
    pub precession: D,
    /// Absolute precession rate `$P/W$`.
    pub rate: D,
    /// Angular velocity relative to the nut `$(u, \sigma/W, \tau)$` in the triad `$(t, N, e_x)$`.
    pub omega: [D; 3],
    /// Spin moment `$s = I P\sigma/(r_b F_a)$`.
    pub spin_moment: D,
}

/// Loads, precession rates, slip at contact A and spin moment, from which the motion of a
/// [`RigidBall`] is calculated. All quantities are in scaled units.
#[derive(Clone, Copy)]
pub(super) struct RigidCoordinates<D> {
    /// Normal loads at the contacts A, A' and B.
    pub(super) loads: [D; 3],
    /// Precession rate relative to the nut `$p$`.
    pub(super) precession: D,
    /// Absolute precession rate `$P/W$`.
    pub(super) rate: D,
    /// Slip speed at contact A.
    pub(super) slip: D,
    /// Unit vector in the direction of the slip at contact A.
    pub(super) slip_direction: Plane<D>,
    /// Spin moment `$s$`.
    pub(super) spin_moment: D,
}

/// Returns the product of a scalar and a vector.
#[inline(always)]
pub(super) fn times<D: Real>(factor: D, a: Plane<D>) -> Plane<D> {
    [factor * a[0], factor * a[1]]
}

/// Returns the length and the direction of a vector.
#[inline(always)]
fn polar<D: Real>(a: Plane<D>) -> (D, Plane<D>) {
    let size = (a[0].square() + a[1].square()).sqrt();
    (size, times(size.recip(), a))
}

impl<P: Real> RigidBall<P> {
    /// Creates a ball in scaled units.
    ///
    /// * `sines`: sines and cosines of the lead angle and the contact angle.
    /// * `radius`: ratio of pitch circle radius to ball radius `$r_m/r_b$`.
    /// * `mass`: dimensionless mass of the ball `$m\,r_b W^2/F_a$`.
    /// * `nut_speed`: ratio of nut speed to relative speed `$\Omega_n/W$`.
    /// * `signed`: friction coefficient `$F$` with the sign of `$W$`.
    #[inline(always)]
    pub fn new(sines: Sines<P>, radius: P, mass: P, nut_speed: P, signed: P) -> Self {
        let Sines { sin_a, cos_a, sin_b, cos_b } = sines;
        let (k_n, k_e) = (cos_a * sin_b, cos_a * cos_b);
        let h = (sin_a.square() + k_e.square()).sqrt();
        let per_h = h.recip();
        Self {
            sines,
            cot_b: cos_b / sin_b,
            sin_2b: sin_b * cos_b * 2.0,
            cos_2b: (cos_b - sin_b) * (cos_b + sin_b),
            k_n,
            k_e,
            signed,
            radius,
            arc: radius / cos_a,
            // μ = m r_m W² / F_a                                              (R9)
            inertia_ratio: mass * radius,
            inertia: mass * 0.4,
            nut_speed,
            h,
            per_h,
            // tanψ = tanα / cosβ                                              (R12)
            cos_psi: k_e * per_h,
            sin_psi: sin_a * per_h,
        }
    }

    /// Returns the ball with its inertia multiplied by `factor`.
    #[must_use]
    pub(super) fn with_inertia(&self, factor: f64) -> Self {
        let (inertia_ratio, inertia) = (self.inertia_ratio * factor, self.inertia * factor);
        Self { inertia_ratio, inertia, ..*self }
    }

    /// Returns the motion of the ball for given coordinates.
    #[inline(always)]
    pub(super) fn motion<D: RealOver<P>>(&self, at: RigidCoordinates<D>) -> RigidMotion<D> {
        let RigidCoordinates { loads, precession, rate, slip, slip_direction, spin_moment } = at;
        let nut = times(slip, slip_direction);
        // u = −λ cosθ,  τ = λ sinθ − p d/r_b                              (R4)
        let (u, tau) = (-nut[0], nut[1] - precession * self.arc);
        // σ = s r_b F_a / (I P)                                           (R5)
        let sigma = spin_moment / (rate * self.inertia);
        // V_A′ = (−u, p d + τ cos2β + σ sin2β)
        let unloaded = [nut[0], precession * self.arc + tau * self.cos_2b + sigma * self.sin_2b];
        // −V_B/(W r_b) = λ A + (sinα, d (1 − 2p) − cosα cosβ)             (R26)
        let screw = [
            -(nut[0] + self.sines.sin_a),
            precession * (self.arc * 2.0) - (nut[1] + (self.arc - self.k_e)),
        ];
        let (unloaded, screw) = (polar(unloaded), polar(screw));
        RigidMotion {
            loads,
            speeds: [slip, unloaded.0, screw.0],
            directions: [slip_direction, unloaded.1, screw.1],
            precession,
            rate,
            omega: [u, sigma, tau],
            spin_moment,
        }
    }

    /// Returns the friction forces on the ball at all three contacts, divided by `$F_a$`.
    #[inline(always)]
    fn friction_forces<D: RealOver<P>>(&self, m: &RigidMotion<D>) -> [Plane<D>; 3] {
        let [a, unloaded, b] = m.directions;
        let [q_a, q_m, q_b] = m.loads;
        [
            times(-(q_a * self.signed), a),
            times(-(q_m * self.signed), unloaded),
            times(-(q_b * self.signed), b),
        ]
    }

    /// Returns the residuals of the seven equations (R8): force and moment balance in `$(t, N,
    /// e_x)$`, and axial load.
    #[inline(always)]
    pub fn residual<D: RealOver<P>>(&self, m: &RigidMotion<D>) -> [D; BALL_UNKNOWNS] {
        self.residual_under(m, m.rate.constant(1.0))
    }

    /// Returns the residuals (R8) for a given axial load per ball, divided by the unit of force.
    #[inline(always)]
    pub(super) fn residual_under<D: RealOver<P>>(
        &self,
        m: &RigidMotion<D>,
        axial_load: D,
    ) -> [D; BALL_UNKNOWNS] {
        let Sines { sin_a, sin_b, cos_b, .. } = self.sines;
        let [q_a, q_m, q_b] = m.loads;
        let ([a, unloaded, b], [u, _, tau], s) = (self.friction_forces(m), m.omega, m.spin_moment);
        let (gyro, centrifugal) = (m.rate * self.inertia, m.rate.square() * self.inertia_ratio);
        // Σ F − m r_m P² n = 0,  Σ M − P k × Iω = 0,  F_nut·k − F_a = 0   (R8)
        [
            a[1] + unloaded[1] + b[1],
            q_a - q_b + q_m * self.cos_2b + unloaded[0] * self.sin_2b - centrifugal * cos_b,
            a[0] + b[0] - q_m * self.sin_2b + unloaded[0] * self.cos_2b + centrifugal * sin_b,
            b[0] - a[0] - unloaded[0] - gyro * tau * self.k_n + s * self.k_e,
            unloaded[1] * self.sin_2b - gyro * (u * self.k_e - tau * sin_a),
            a[1] - b[1] + unloaded[1] * self.cos_2b - s * sin_a + gyro * u * self.k_n,
            (q_a - q_m) * self.k_n + (a[0] + unloaded[0]) * self.k_e + (a[1] + unloaded[1]) * sin_a
                - axial_load,
        ]
    }

    /// Returns the torque on the screw per ball, divided by `$r_b F_a$`.
    #[inline(always)]
    pub fn torque<D: RealOver<P>>(&self, m: &RigidMotion<D>) -> D {
        let Sines { sin_a, cos_a, sin_b, cos_b } = self.sines;
        let (q, [x, y]) = (m.loads[2], self.friction_forces(m)[2]);
        // T = [(−r_m n) × F + M]·k, where the screw exerts F and M  (B7)
        let force = y * cos_a + (q * sin_b - x * cos_b) * sin_a;
        force * self.radius + x * sin_a - y * self.k_e
    }

    /// Returns the torque of the frictionless screw per ball, divided by `$r_b F_a$`.
    #[inline(always)]
    pub fn ideal_torque(&self) -> P {
        let one = self.radius.constant(1.0);
        ideal_torque(one, self.radius, self.sines.tan_a())
    }

    /// Returns the angular velocity of the ball, divided by `$W$`, in the Frenet-Serret triad `$(t,
    /// n, b)$`.
    #[inline(always)]
    pub fn angular_velocity<D: RealOver<P>>(&self, m: &RigidMotion<D>) -> [D; 3] {
        let Sines { sin_a, cos_a, sin_b, cos_b } = self.sines;
        let [u, sigma, tau] = m.omega;
        // ω = Ω_n k + W u t + σ N + W τ e_x                               (R6)
        [
            u + self.nut_speed * sin_a,
            sigma * cos_b - tau * sin_b,
            sigma * sin_b + tau * cos_b + self.nut_speed * cos_a,
        ]
    }

    /// Returns the spins about the contact normals relative to the nut and the screw, divided by
    /// `$W$`.
    #[inline(always)]
    pub fn spins<D: RealOver<P>>(&self, m: &RigidMotion<D>) -> [D; 3] {
        let [_, sigma, tau] = m.omega;
        [sigma, sigma * self.cos_2b - tau * self.sin_2b, -sigma + self.k_n]
    }
}

impl<F: Real> RigidBall<F> {
    /// Converts the number `x` to the scalar type `F`, with the same value at all points.
    #[inline(always)]
    pub(super) fn constant(&self, x: f64) -> F {
        self.signed.constant(x)
    }

    /// Returns true if friction coefficient and inertia ratio are within the valid range of the
    /// model.
    #[inline(always)]
    pub fn is_covered(&self) -> F::Mask {
        is_in_range(self.friction(), self.inertia_ratio)
    }

    /// Returns the friction coefficient `$f$`.
    #[inline(always)]
    pub fn friction(&self) -> F {
        self.signed.abs()
    }

    /// Returns the ratio of axial load to normal load for a ball without inertia. The ratio is not
    /// positive if friction alone can hold any axial load.
    #[inline(always)]
    pub(super) fn axial_load_ratio(&self) -> F {
        self.k_n - self.signed * self.h
    }

    /// Returns the magnitude `$\iota$` of the inertia forces at a precession rate `$P/W$`.
    #[inline(always)]
    pub(super) fn inertia_size(&self, rate: F) -> F {
        // ι = μ max(1, (P/W)²)                                            (R23)
        self.inertia_ratio * rate.square().larger(self.constant(1.0))
    }

    /// Returns the typical magnitudes of the residuals. The first value applies to all equations
    /// except the moment balance about the contact normal, and the second value applies to this
    /// moment balance.
    ///
    /// The first magnitude is the larger of axial load and inertia force. In the moment balance
    /// about the contact normal, all terms are as small as the inertia forces, and only this
    /// equation determines the slip at contact A.
    #[inline(always)]
    pub(super) fn units(&self, rate: F) -> [F; 2] {
        let one = self.constant(1.0);
        let size = self.inertia_size(rate);
        // D_F = diag(w, w, w, w, 1/M_N, w, w),  w = 1/max(1, μ)           (R10)
        // M_N = ι min(1, |P/W|)                                           (R23)
        [self.inertia_ratio.larger(one), F::select(rate.abs().below(1.0), size * rate.abs(), size)]
    }

    /// Returns the largest residual of the equations, each divided by the magnitude of its terms.
    #[inline(always)]
    pub fn scaled_residual(&self, m: &RigidMotion<F>) -> F {
        let [unit, normal_unit] = self.units(m.rate);
        let [t, n, e, moment_t, normal, moment_e, axial] = self.residual(m);
        let largest = (t.abs().larger(n.abs())).larger(e.abs().larger(axial.abs()));
        let largest = largest.larger(moment_t.abs().larger(moment_e.abs()));
        (largest / unit).larger(normal.abs() / normal_unit)
    }

    /// Returns the friction power, divided by `$r_b F_a |W|$`.
    #[inline(always)]
    pub fn friction_power(&self, m: &RigidMotion<F>) -> F {
        let ([q_a, q_m, q_b], [v_a, v_m, v_b]) = (m.loads, m.speeds);
        // P_f = Σ f Q_c |V_c|                                             (R21)
        self.friction() * (q_a * v_a + q_m * v_m + q_b * v_b)
    }
}
