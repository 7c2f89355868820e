//! Frenet-Serret frame of the helix through the ball centers.
//!
//! Theory: `docs/theory/01-kinematics.md`, equations (K1) to (K6).
#![expect(non_snake_case, reason = "monogram notation, docs/theory/00-notation.md")]

use std::f64::consts::TAU;

use nalgebra::Vector3;

use crate::Scalar;

/// Right-handed helix through the ball centers, about the screw axis `Wz`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Helix<D> {
    /// Pitch-circle radius `$r_m$` \[m\], positive.
    pub radius: D,
    /// Lead angle `$\alpha$` \[rad\], in (0, π/2). Lin et al. call it the helix angle.
    pub lead_angle: D,
}

/// Frenet-Serret triad at a point C of the helix, with components in the ground frame W.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrenetFrame<D> {
    /// Position of C relative to the origin of W \[m\].
    pub p_WC: Vector3<D>,
    /// Unit tangent, in the direction of increasing azimuth.
    pub t_W: Vector3<D>,
    /// Unit principal normal, which points toward the axis.
    pub n_W: Vector3<D>,
    /// Unit binormal, `$b = t \times n$`.
    pub b_W: Vector3<D>,
}

impl<D: Scalar> Helix<D> {
    /// Returns the Frenet-Serret triad at the point C whose azimuth about `Wz` is `theta` \[rad\],
    /// which may be any real number (K1).
    ///
    /// ```math
    /// t = (-\cos\alpha\sin\theta,\; \cos\alpha\cos\theta,\; \sin\alpha), \qquad
    /// n = (-\cos\theta, -\sin\theta, 0), \qquad b = t \times n
    /// ```
    ///
    /// Source: do Carmo, *Differential Geometry of Curves and Surfaces*, §1-5, with the circular
    /// helix expressed by its lead angle.
    pub fn frame(&self, theta: D) -> FrenetFrame<D> {
        let (sin_a, cos_a) = self.lead_angle.sin_cos();
        let (s, c) = theta.sin_cos();
        let r = self.radius;

        // p_WC = (r cosθ, r sinθ, r tanα θ)                               (K1)
        let p_WC = Vector3::new(c * r, s * r, theta * r * sin_a / cos_a);

        // t = (−cosα sinθ, cosα cosθ, sinα)                               (K2)
        let t_W = Vector3::new(-s * cos_a, c * cos_a, sin_a);

        // n = (−cosθ, −sinθ, 0),  b = t × n                               (K3)
        let n_W = Vector3::new(-c, -s, D::from(0.0));
        let b_W = t_W.cross(&n_W);

        FrenetFrame { p_WC, t_W, n_W, b_W }
    }

    /// Returns the arc length per radian of azimuth, `$d = r_m/\cos\alpha$` \[m\] (K4).
    pub fn arc_length_per_radian(&self) -> D {
        // d = r_m / cosα                                                  (K4)
        self.radius / self.lead_angle.cos()
    }

    /// Returns the curvature of the helix, `$\rho_h = \cos^2\alpha/r_m$` \[1/m\] (K5).
    pub fn curvature(&self) -> D {
        // ρ_h = cos²α / r_m                                               (K5)
        self.lead_angle.cos().square() / self.radius
    }

    /// Returns the lead, which is the axial advance per turn, `$2\pi r_m\tan\alpha$` \[m\].
    pub fn lead(&self) -> D {
        self.radius * self.lead_angle.tan() * TAU
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use num_dual::Dual64;

    use super::*;

    const SCREW: Helix<f64> = Helix { radius: 16.5e-3, lead_angle: 0.173 };

    /// The triad satisfies the Frenet-Serret formulas. Dual numbers provide exact derivatives.
    #[test]
    fn frame_satisfies_the_frenet_serret_formulas() {
        let (sin_a, cos_a) = SCREW.lead_angle.sin_cos();
        // τ = sinα cosα / r_m                                             (K6)
        let (kappa, tau) = (SCREW.curvature(), sin_a * cos_a / SCREW.radius);
        let dual = Helix {
            radius: Dual64::from(SCREW.radius),
            lead_angle: Dual64::from(SCREW.lead_angle),
        };
        for k in 0..16 {
            let f = dual.frame(Dual64::from(f64::from(k) * 0.7 - 3.0).derivative());
            let per_arc = |v: Vector3<Dual64>| v.map(|d| d.eps) / SCREW.arc_length_per_radian();
            let re = |v: Vector3<Dual64>| v.map(|d| d.re);

            // The tolerances allow for rounding errors of unit vectors and of a curvature of about
            // 60 1/m.
            assert_relative_eq!(per_arc(f.p_WC), re(f.t_W), epsilon = 1e-15);
            assert_relative_eq!(per_arc(f.t_W), re(f.n_W) * kappa, epsilon = 1e-12);
            assert_relative_eq!(
                per_arc(f.n_W),
                re(f.b_W) * tau - re(f.t_W) * kappa,
                epsilon = 1e-12
            );
            assert_relative_eq!(per_arc(f.b_W), re(f.n_W) * -tau, epsilon = 1e-12);
        }
    }

    /// With zero lead, the helix is a circle in the plane Wz = 0.
    #[test]
    fn helix_with_zero_lead_is_a_circle() {
        let circle = Helix { lead_angle: 0.0, ..SCREW };
        assert_relative_eq!(circle.curvature(), 1.0 / circle.radius);
        assert_relative_eq!(circle.lead(), 0.0);
        assert_relative_eq!(circle.frame(1.3).b_W, Vector3::z(), epsilon = 1e-15);
    }

    /// The axial advance per turn equals the lead.
    #[test]
    fn helix_advances_by_the_lead_in_one_turn() {
        let rise = SCREW.frame(0.4 + TAU).p_WC - SCREW.frame(0.4).p_WC;
        assert_relative_eq!(rise, Vector3::new(0.0, 0.0, SCREW.lead()), epsilon = 1e-16);
    }
}
