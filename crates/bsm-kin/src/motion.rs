//! Motion of the ball, and slip and spin at its contacts.
//!
//! Theory: `docs/theory/01-kinematics.md`, equations (K12) to (K14).

use nalgebra::Vector3;

use crate::{BallFrame, Contact, Field, FieldOver, Scalar, Site};

/// Speeds of screw and nut about the screw axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive<D> {
    /// Screw speed `$\Omega_s$` \[rad/s\].
    pub screw_speed: D,
    /// Nut speed `$\Omega_n$` \[rad/s\].
    pub nut_speed: D,
}

impl<D: Field> Drive<D> {
    /// Returns the relative speed `$W = \Omega_s - \Omega_n$` \[rad/s\].
    ///
    /// If it is positive, the drive works against the axial load (rotary to linear). If it is
    /// negative, the load drives (linear to rotary).
    #[inline(always)]
    pub fn relative_speed(&self) -> D {
        self.screw_speed - self.nut_speed
    }
}

/// Steady motion of the ball, absolute or relative to a body that rotates about the axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion<D> {
    /// Precession `$P$` of the ball center about the screw axis \[rad/s\].
    pub precession: D,
    /// Angular velocity `$\omega$` of the ball \[rad/s\], components in the triad of a
    /// [`BallFrame`].
    pub omega: Vector3<D>,
}

impl<D> Motion<D> {
    /// Returns the motion with a precession and the components of an angular velocity.
    #[inline(always)]
    pub fn new(precession: D, [t, n, b]: [D; 3]) -> Self {
        Self { precession, omega: Vector3::new(t, n, b) }
    }
}

impl<D: Scalar> Motion<D> {
    /// Returns the motion relative to a body that rotates at `body_speed` about the axis (K12).
    #[must_use]
    pub fn relative_to(&self, body_speed: D, frame: &BallFrame<D>) -> Self {
        // P_rel = P − Ω,  ω_rel = ω − Ω k                                 (K12)
        Self { precession: self.precession - body_speed, omega: self.omega - frame.k * body_speed }
    }

    /// Returns the velocity of the ball's surface at `point` relative to the body to which `self`
    /// is relative \[m/s\] (K13). At a contact center this velocity is tangential.
    ///
    /// ```math
    /// v_i(r) = d\,(P - \Omega_i)\,t + (\omega - \Omega_i k) \times r
    /// ```
    ///
    /// * `arc_length_per_radian`: `$d = r_m/\cos\alpha$` of the helix \[m\].
    /// * `point`: `$r$`, relative to the ball center \[m\].
    ///
    /// Source: Lin, Ravani and Velinsky, *Kinematics of the Ball Screw Mechanism*, ASME J. Mech.
    /// Des. 116 (1994); with the nut at rest the components are Eqs 7-8 of their *Design of the
    /// Ball Screw Mechanism for Optimal Efficiency*.
    pub fn slip_velocity(&self, arc_length_per_radian: D, point: &Vector3<D>) -> Vector3<D> {
        // v = d (P − Ω) t + (ω − Ω k) × r                                 (K13)
        BallFrame::tangent() * (arc_length_per_radian * self.precession) + self.omega.cross(point)
    }

    /// Returns the component across the groove of the rotation relative to the neighbors in the
    /// train \[rad/s\] (O1), as seen from the frame that goes around the axis with the ball.
    ///
    /// * `axis`: `$k$` in the triad of the angular velocity.
    pub fn across_groove(&self, axis: &Vector3<D>) -> Vector3<D> {
        // w = ω' − (ω'·t) t,  ω' = ω − P k                                (O1)
        let mut transverse = self.omega - axis * self.precession;
        transverse.x = D::from(0.0);
        transverse
    }

    /// Returns the spin about the contact normal \[rad/s\] (K14). `self` is relative to the body of
    /// this contact.
    pub fn spin(&self, contact: &Contact<D>) -> D {
        // ω_spin = (ω − Ω k)·N                                            (K14)
        self.omega.dot(&contact.normal)
    }
}

/// Motion of the ball relative to the body of a contact, in the axes `$t$`, `$N$` and `$t \times N$` of the contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactMotion<D> {
    /// Velocity of the ball center along `$t$` \[m/s\].
    pub speed: D,
    /// Angular velocity about `$t$`, `$N$` and `$t \times N$` \[rad/s\].
    pub omega: [D; 3],
}

impl<D: Field> ContactMotion<D> {
    /// Resolves an angular velocity in `$(t, n, b)$` into the axes of a contact.
    ///
    /// * `speed`: velocity of the ball center along `$t$`; `omega`: both relative to the body of the contact.
    /// * `angle`: sine and cosine of the contact angle.
    #[inline(always)]
    pub fn at_angle(site: Site, speed: D, omega: [D; 3], angle: (D, D)) -> Self {
        let ([t, n, b], (sin, cos)) = (omega, angle);
        // N = ±(cosβ n + sinβ b),  t × N = ±(cosβ b − sinβ n)             (K9)
        let (about_normal, across) = (n * cos + b * sin, b * cos - n * sin);
        let omega = match site {
            Site::Screw => [t, -about_normal, -across],
            Site::Nut | Site::NutUnloaded => [t, about_normal, across],
        };
        Self { speed, omega }
    }

    /// Returns the motion divided by a speed.
    #[must_use]
    pub fn over(&self, speed: D) -> Self {
        let unit = speed.recip();
        Self { speed: self.speed * unit, omega: self.omega.map(|omega| omega * unit) }
    }

    /// Returns the slip at the contact center along `$t$` and along `$t \times N$` (K13).
    #[inline(always)]
    pub fn slip(&self, ball_radius: D) -> [D; 2] {
        // v = d (P − Ω) t + (ω − Ω k) × (−r_b N)                          (K13)
        [self.speed + self.omega[2] * ball_radius, -(self.omega[0] * ball_radius)]
    }
}

/// Returns the angular velocity in the Frenet-Serret triad `$(t, n, b)$` relative to a body that
/// rotates at `body_speed` about the axis, as [`Motion::relative_to`] does (K12).
///
/// * `lead`: sine and cosine of the lead angle.
#[inline(always)]
pub fn relative_rotation<P: Field, D: FieldOver<P>>(
    [t, n, b]: [D; 3],
    body_speed: P,
    lead: (P, P),
) -> [D; 3] {
    // ω_rel = ω − Ω k                                                     (K12)
    [t - body_speed * lead.0, n, b - body_speed * lead.1]
}

/// Returns the spin of an angular velocity in `$(t, n, b)$`, relative to the nut, about the normal
/// of a contact with the loaded flank of the nut (K14). The loaded flank of the screw has the
/// opposite normal.
///
/// * `angle`: sine and cosine of the contact angle.
#[inline(always)]
pub fn spin_at_nut<F: Field>([_, n, b]: [F; 3], angle: (F, F)) -> F {
    // ω_spin = (ω − Ω k)·N                                                (K14)
    n * angle.1 + b * angle.0
}
