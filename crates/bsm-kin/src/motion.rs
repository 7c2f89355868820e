//! Motion of the ball, with slip and spin at its contacts.
//!
//! Theory: `docs/theory/01-kinematics.md`, equations (K12) to (K14).

use nalgebra::Vector3;

use crate::{BallFrame, Contact, Real, RealOver, Scalar, Site};

/// Angular speeds of screw and nut about the screw axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive<D> {
    /// Screw speed `$\Omega_s$` \[rad/s\].
    pub screw_speed: D,
    /// Nut speed `$\Omega_n$` \[rad/s\].
    pub nut_speed: D,
}

impl<D: Real> Drive<D> {
    /// Returns the relative speed `$W = \Omega_s - \Omega_n$` \[rad/s\].
    ///
    /// If the relative speed is positive, the drive moves the axial load (rotary to linear). If it
    /// is negative, the load back-drives the screw (linear to rotary).
    #[inline(always)]
    pub fn relative_speed(&self) -> D {
        self.screw_speed - self.nut_speed
    }
}

/// Steady motion of the ball, either absolute or relative to a body that rotates about the screw
/// axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion<D> {
    /// Precession rate `$P$` of the ball center about the screw axis \[rad/s\].
    pub precession: D,
    /// Angular velocity `$\omega$` of the ball \[rad/s\], with components in the triad of a
    /// [`BallFrame`].
    pub omega: Vector3<D>,
}

impl<D> Motion<D> {
    /// Creates a motion from the precession rate and the components of the angular velocity.
    #[inline(always)]
    pub fn new(precession: D, [t, n, b]: [D; 3]) -> Self {
        Self { precession, omega: Vector3::new(t, n, b) }
    }
}

impl<D: Scalar> Motion<D> {
    /// Returns the motion relative to a body that rotates about the screw axis at `body_speed`
    /// (K12).
    #[must_use]
    pub fn relative_to(&self, body_speed: D, frame: &BallFrame<D>) -> Self {
        // P_rel = P − Ω,  ω_rel = ω − Ω k                                 (K12)
        Self { precession: self.precession - body_speed, omega: self.omega - frame.k * body_speed }
    }

    /// Returns the velocity of the ball surface at `point`, relative to the body to which `self`
    /// refers \[m/s\] (K13). At a contact center, this velocity is tangential.
    ///
    /// ```math
    /// v_i(r) = d\,(P - \Omega_i)\,t + (\omega - \Omega_i k) \times r
    /// ```
    ///
    /// * `arc_length_per_radian`: arc length of the helix per radian, `$d = r_m/\cos\alpha$` \[m\].
    /// * `point`: position `$r$` relative to the ball center \[m\].
    ///
    /// Source: Lin, Ravani and Velinsky, *Kinematics of the Ball Screw Mechanism*, ASME J. Mech.
    /// Des. 116 (1994). For a nut at rest, the components are Eqs 7-8 of *Design of the Ball Screw
    /// Mechanism for Optimal Efficiency* by the same authors.
    pub fn slip_velocity(&self, arc_length_per_radian: D, point: &Vector3<D>) -> Vector3<D> {
        // v = d (P − Ω) t + (ω − Ω k) × r                                 (K13)
        BallFrame::tangent() * (arc_length_per_radian * self.precession) + self.omega.cross(point)
    }

    /// Returns the rotation relative to the neighboring balls in the ball train, without its
    /// component along the groove \[rad/s\] (O1). It is the rotation seen from the frame that
    /// orbits the screw axis with the ball.
    ///
    /// * `axis`: screw axis `$k$`, in the triad in which the angular velocity is given.
    pub fn across_groove(&self, axis: &Vector3<D>) -> Vector3<D> {
        // w = ω' − (ω'·t) t,  ω' = ω − P k                                (O1)
        let mut transverse = self.omega - axis * self.precession;
        transverse.x = D::from(0.0);
        transverse
    }

    /// Returns the spin about the contact normal \[rad/s\] (K14). `self` must be the motion
    /// relative to the raceway of this contact.
    pub fn spin(&self, contact: &Contact<D>) -> D {
        // ω_spin = (ω − Ω k)·N                                            (K14)
        self.omega.dot(&contact.normal)
    }
}

/// Motion of the ball relative to the raceway of a contact, resolved along the axes `$t$`, `$N$`
/// and `$t \times N$` of the contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactMotion<D> {
    /// Velocity of the ball center along `$t$` \[m/s\].
    pub speed: D,
    /// Angular velocities about `$t$`, `$N$` and `$t \times N$` \[rad/s\].
    pub omega: [D; 3],
}

impl<D: Real> ContactMotion<D> {
    /// Resolves an angular velocity with components in `$(t, n, b)$` along the axes of a contact.
    ///
    /// * `speed`, `omega`: velocity of the ball center along `$t$`, and angular velocity, both
    ///   relative to the raceway of the contact.
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

    /// Returns the motion divided by a reference speed.
    #[must_use]
    pub fn over(&self, speed: D) -> Self {
        let unit = speed.recip();
        Self { speed: self.speed * unit, omega: self.omega.map(|omega| omega * unit) }
    }

    /// Returns the slip velocity at the contact center along `$t$` and along `$t \times N$` (K13).
    #[inline(always)]
    pub fn slip(&self, ball_radius: D) -> [D; 2] {
        // v = d (P − Ω) t + (ω − Ω k) × (−r_b N)                          (K13)
        [self.speed + self.omega[2] * ball_radius, -(self.omega[0] * ball_radius)]
    }
}

/// Returns the angular velocity relative to a body that rotates about the screw axis at
/// `body_speed`, with components in the Frenet-Serret triad `$(t, n, b)$` (K12). It corresponds to
/// [`Motion::relative_to`].
///
/// * `lead`: sine and cosine of the lead angle.
#[inline(always)]
pub fn relative_rotation<P: Real, D: RealOver<P>>(
    [t, n, b]: [D; 3],
    body_speed: P,
    lead: (P, P),
) -> [D; 3] {
    // ω_rel = ω − Ω k                                                     (K12)
    [t - body_speed * lead.0, n, b - body_speed * lead.1]
}

/// Returns the spin about the normal of the contact with the loaded flank of the nut (K14). The
/// argument is the angular velocity relative to the nut, with components in `$(t, n, b)$`. The
/// normal at the loaded flank of the screw has the opposite direction.
///
/// * `angle`: sine and cosine of the contact angle.
#[inline(always)]
pub fn spin_at_nut<F: Real>([_, n, b]: [F; 3], angle: (F, F)) -> F {
    // ω_spin = (ω − Ω k)·N                                                (K14)
    n * angle.1 + b * angle.0
}
