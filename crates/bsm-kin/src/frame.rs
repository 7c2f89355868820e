//! Triad of unit vectors for the force and moment balance of the ball.
//!
//! Theory: `docs/theory/01-kinematics.md`, equations (K7) and (K8).

use nalgebra::Vector3;

use crate::Scalar;

/// Right-handed triad `(t, n', b')` at the ball center. It is the Frenet-Serret triad, rotated
/// about the tangent `t` by the angle `$\zeta$`.
///
/// For `$\zeta = 0$`, the rotated triad is the triad `(t, n, b)` itself. If `$\zeta$` equals a
/// contact angle, the normals of the loaded contacts are parallel to the second axis, so the cross
/// products of the normals are exactly zero, without rounding errors. Small terms of the force and
/// moment balance are then not lost among large terms. All vectors in a calculation must have
/// components in the same triad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BallFrame<D> {
    /// Angle `$\zeta$` between `n` and the second axis, positive from `n` toward `b` \[rad\].
    pub rotation_angle: D,
    /// Direction `$k$` of the screw axis, with components in this triad.
    pub k: Vector3<D>,
    /// Principal normal `$n$` of the helix, which points toward the axis, with components in this
    /// triad.
    pub n: Vector3<D>,
}

impl<D: Scalar> BallFrame<D> {
    /// Returns the triad for a helix with the given lead angle \[rad\], rotated by `rotation_angle`
    /// \[rad\] (K7), (K8).
    ///
    /// ```math
    /// k = (\sin\alpha,\; \cos\alpha\sin\zeta,\; \cos\alpha\cos\zeta), \qquad
    /// n = (0,\; \cos\zeta,\; -\sin\zeta)
    /// ```
    pub fn turned(lead_angle: D, rotation_angle: D) -> Self {
        let (sin_a, cos_a) = lead_angle.sin_cos();
        let (sin_c, cos_c) = rotation_angle.sin_cos();
        Self {
            rotation_angle,
            // k = sinα t + cosα b                                         (K7)
            k: Vector3::new(sin_a, cos_a * sin_c, cos_a * cos_c),
            // n = cosζ n' − sinζ b'                                       (K8)
            n: Vector3::new(D::from(0.0), cos_c, -sin_c),
        }
    }

    /// Returns the tangent `$t$`, which is the first axis of the triad for any rotation angle.
    pub fn tangent() -> Vector3<D> {
        Vector3::new(D::from(1.0), D::from(0.0), D::from(0.0))
    }

    /// Returns the components of `v` in the Frenet-Serret triad `(t, n, b)`.
    pub fn to_frenet(&self, v: &Vector3<D>) -> Vector3<D> {
        let (s, c) = self.rotation_angle.sin_cos();
        Vector3::new(v.x, c * v.y - s * v.z, s * v.y + c * v.z)
    }

    /// Converts the Frenet-Serret components `(t, n, b)` of a vector into components in the triad
    /// `self`.
    pub fn from_frenet(&self, v: &Vector3<D>) -> Vector3<D> {
        let (s, c) = self.rotation_angle.sin_cos();
        Vector3::new(v.x, c * v.y + s * v.z, c * v.z - s * v.y)
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::Helix;

    /// The components of the screw axis in the Frenet-Serret triad do not depend on the rotation of
    /// the triad from which they are converted.
    #[test]
    fn screw_axis_components_match_the_helix() {
        let helix = Helix { radius: 0.02, lead_angle: 0.31 };
        let f = helix.frame(0.7);
        let k = Vector3::z();
        let expected = Vector3::new(f.t_W.dot(&k), f.n_W.dot(&k), f.b_W.dot(&k));
        for rotation_angle in [0.0, 0.8, -1.1] {
            let frame = BallFrame::turned(0.31, rotation_angle);
            assert_relative_eq!(frame.to_frenet(&frame.k), expected, epsilon = 1e-15);
            assert_relative_eq!(frame.from_frenet(&expected), frame.k, epsilon = 1e-15);
            assert_relative_eq!(frame.to_frenet(&frame.n), Vector3::y(), epsilon = 1e-15);
        }
    }
}
