//! Contact points between the ball and the flanks of the grooves.
//!
//! Theory: `docs/theory/01-kinematics.md`, equations (K9) to (K11), (K15).

use nalgebra::Vector3;

use crate::{BallFrame, Scalar};

/// Groove flank on which a contact lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Site {
    /// A: loaded flank of the nut groove.
    Nut,
    /// A': unloaded flank of the nut's gothic arch.
    NutUnloaded,
    /// B: loaded flank of the screw groove.
    Screw,
}

/// Unit vectors at one contact, with components in the triad of a [`BallFrame`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact<D> {
    /// Groove flank on which the contact lies.
    pub site: Site,
    /// Unit normal `$N$`, pointing from the raceway into the ball.
    pub normal: Vector3<D>,
    /// Slip axis `$e_x$`, across the groove in the normal plane of the helix. The second slip axis
    /// is `$e_y = t$`.
    pub transverse: Vector3<D>,
}

impl<D: Scalar> Contact<D> {
    /// Returns the contact at `site` with the given contact angle \[rad\], which is 0 for a radial
    /// and π/2 for an axial normal (K9), (K10).
    ///
    /// ```math
    /// \begin{aligned}
    /// A:&\; N = (0, \cos\beta, \sin\beta), & e_x &= (0, -\sin\beta, \cos\beta) \\
    /// A':&\; N = (0, \cos\beta, -\sin\beta), & e_x &= (0, \sin\beta, \cos\beta) \\
    /// B:&\; N = (0, -\cos\beta, -\sin\beta), & e_x &= (0, -\sin\beta, \cos\beta)
    /// \end{aligned}
    /// ```
    ///
    /// The equations give the components in the triad `(t, n, b)`. In a rotated triad, contact
    /// angles are measured from its second axis.
    pub fn new(site: Site, contact_angle: D, frame: &BallFrame<D>) -> Self {
        let angle = if site == Site::NutUnloaded { -contact_angle } else { contact_angle };
        Self::tilted(site, angle - frame.rotation_angle)
    }

    /// Returns the contact at `site` whose contact angle exceeds the rotation angle of the triad by
    /// `tilt` \[rad\] (K9), (K10).
    ///
    /// The result is accurate for small tilts. Subtracting two nearly equal contact angles would
    /// lose significant digits.
    pub fn tilted(site: Site, tilt: D) -> Self {
        let side = if site == Site::Screw { -1.0 } else { 1.0 };
        let (s, c) = tilt.sin_cos();
        let zero = D::from(0.0);
        Self {
            site,
            // N = ±(0, cos(β − ζ), sin(β − ζ))                            (K9)
            normal: Vector3::new(zero, c * side, s * side),
            // e_x = (0, −sin(β − ζ), cos(β − ζ))                          (K10)
            transverse: Vector3::new(zero, -s, c),
        }
    }

    /// Returns the slip angle `$\psi$` \[rad\] (K15). This is the direction of the friction force
    /// on the ball, measured from `$e_x$` toward `$t$`. The friction force is opposite to the slip
    /// velocity `slip`.
    pub fn slip_angle(&self, slip: &Vector3<D>) -> D {
        // ψ = atan2(−V_y, −V_x)                                           (K15)
        (-slip.dot(&BallFrame::tangent())).atan2(-slip.dot(&self.transverse))
    }

    /// Returns the position of the contact point relative to the ball center, `$r = -r_b N$`, in
    /// the unit of `ball_radius` (K11).
    pub fn point(&self, ball_radius: D) -> Vector3<D> {
        // r = −r_b N                                                      (K11)
        self.normal * -ball_radius
    }
}
