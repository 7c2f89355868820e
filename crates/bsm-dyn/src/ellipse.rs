//! Friction integrated over the contact ellipse.
//!
//! Theory: `docs/theory/07-raceway-control.md`, equations (E1) to (E6).

use std::f64::consts::{PI, TAU};
use std::num::NonZeroUsize;

use bsm_kin::{BallFrame, Contact, Motion, Scalar};
use gauss_quad::GaussLegendre;
use nalgebra::Vector3;

use crate::Wrench;

/// Nodes and weights over the unit disc for a Hertz pressure of unit load.
#[derive(Debug, Clone, PartialEq)]
pub struct Quadrature {
    /// Coordinates over the semi-axes, and weight; the weights sum to one.
    nodes: Vec<(f64, f64, f64)>,
}

impl Quadrature {
    /// Gauss-Legendre with `order` points in `$u$`, `2 order` equal steps in `$\phi$` (E1).
    ///
    /// With `$u = \sqrt{1 - (x/a)^2 - (y/b)^2}$` the pressure is `$p_{max}\,u$` and a point carries
    /// the load `$dQ = Q\,\frac{3}{2\pi}\,u^2\,du\,d\phi$`: smooth in both variables.
    pub fn new(order: NonZeroUsize) -> Self {
        let steps = 2 * order.get();
        let mut nodes = Vec::with_capacity(order.get() * steps);
        for (node, weight) in &GaussLegendre::new(order) {
            // From [-1, 1] to [0, 1].
            let (u, du) = (0.5 * (node + 1.0), 0.5 * weight);
            let radius = (1.0 - u * u).sqrt();
            for step in 0..steps {
                #[expect(clippy::cast_precision_loss, reason = "small counts")]
                let (phi, d_phi) = (TAU * (step as f64 + 0.5) / steps as f64, TAU / steps as f64);
                // dQ/Q = 3/(2π) u² du dφ                                  (E1)
                nodes.push((
                    radius * phi.cos(),
                    radius * phi.sin(),
                    3.0 / (2.0 * PI) * u * u * du * d_phi,
                ));
            }
        }
        Self { nodes }
    }
}

/// A loaded contact ellipse on the ball.
#[derive(Debug, Clone, Copy)]
pub struct Ellipse<D> {
    /// Where it sits.
    pub contact: Contact<D>,
    /// Normal load `$Q$` \[N\].
    pub load: D,
    /// Semi-axes across and along the groove \[m\].
    pub semi_axes: (D, D),
    /// Radius of the pressed surface across the groove `$R_c$` \[m\] (E2).
    pub pressed_radius: f64,
    /// Ball radius `$r_b$` \[m\].
    pub ball_radius: f64,
}

/// Radius of the surface that ball and groove press each other to \[m\] (E2).
///
/// Source: Harris and Kotzalas, *Advanced Concepts of Bearing Technology*, the harmonic mean of
/// ball and groove.
pub fn pressed_radius(conformity: f64, ball_radius: f64) -> f64 {
    // R_c = 2 f_c (2 r_b) / (2 f_c + 1)                                   (E2)
    4.0 * conformity * ball_radius / (2.0 * conformity + 1.0)
}

impl<D: Scalar> Ellipse<D> {
    /// Friction of the whole ellipse on the ball, and the power that it takes (E3) to (E6).
    ///
    /// * `motion`: of the ball, relative to the body of this contact.
    /// * `arc_length_per_radian`: `$d$` \[m\].
    /// * `friction`: `$f$`; `creep`: `$v_e$` \[m/s\], below which friction is nearly proportional to
    ///   the slip, positive.
    ///
    /// Source: Coulomb traction over the Hertz ellipse with spin and Heathcote slip, as in Jones
    /// and Harris.
    pub fn friction(
        &self,
        motion: &Motion<D>,
        arc_length_per_radian: D,
        friction: D,
        creep: f64,
        quadrature: &Quadrature,
    ) -> (Wrench<D>, D) {
        let zero = Vector3::repeat(D::from(0.0));
        let (mut wrench, mut power) = (Wrench { force: zero, moment: zero }, D::from(0.0));
        let (across, along) = (self.contact.across, BallFrame::tangent());
        for (x, y, weight) in &quadrature.nodes {
            let (x, y) = (self.semi_axes.0 * *x, self.semi_axes.1 * *y);
            // r = −N (r_b − x²/(2 R_c)) + x e_x + y t                     (E3)
            let depth = x.square() * (0.5 / self.pressed_radius) - self.ball_radius;
            let r = self.contact.normal * depth + across * x + along * y;
            let v = motion.slip_velocity(arc_length_per_radian, &r);
            let (v_x, v_y) = (v.dot(&across), v.dot(&along));
            // dF = −f dQ v/√(v² + v_e²)                                   (E4)
            let speed = (v_x.square() + v_y.square() + creep * creep).sqrt();
            let pull = friction * self.load * *weight / speed;
            let force = across * (-pull * v_x) + along * (-pull * v_y);
            // dM = r × dF                                                 (E5)
            wrench = wrench + Wrench { force, moment: r.cross(&force) };
            // dP = −dF·v                                                  (E6)
            power += pull * (v_x.square() + v_y.square());
        }
        (wrench, power)
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use bsm_kin::Site;

    use super::*;

    fn ellipse() -> (Ellipse<f64>, Quadrature) {
        let frame = BallFrame::turned(0.17, 0.0);
        let contact = Contact::new(Site::Nut, 0.8, &frame);
        // A flat contact far from the centre: no Heathcote slip, no difference of lever arms.
        let ellipse = Ellipse {
            contact,
            load: 130.0,
            semi_axes: (0.5e-3, 0.1e-3),
            pressed_radius: 1e9,
            ball_radius: 4e-3,
        };
        (ellipse, Quadrature::new(NonZeroUsize::new(24).expect("24")))
    }

    #[test]
    fn the_weights_are_the_load() {
        for order in [1, 4, 12] {
            let quadrature = Quadrature::new(NonZeroUsize::new(order).expect("positive"));
            let sum: f64 = quadrature.nodes.iter().map(|(.., w)| w).sum();
            // u² is integrated exactly from two points on; one point gives 3/4.
            let expected = if order == 1 { 0.75 } else { 1.0 };
            assert_relative_eq!(sum, expected, max_relative = 1e-14);
        }
    }

    /// Limit: all points slide alike, the force is f Q against the slip and the power f Q |v|.
    #[test]
    fn gross_slip_is_coulomb_at_a_point() {
        let (ellipse, quadrature) = ellipse();
        let motion = Motion { precession: 3.0, omega: Vector3::zeros() };
        let (wrench, power) = ellipse.friction(&motion, 0.02, 0.08, 1e-9, &quadrature);
        let full = 0.08 * 130.0;
        assert_relative_eq!(wrench.force, Vector3::new(-full, 0.0, 0.0), epsilon = 1e-10);
        assert_relative_eq!(power, full * 0.06, max_relative = 1e-10);
    }

    /// Limit: pure spin; the moment is the known 3/8 f Q a E(m).
    #[test]
    fn pure_spin_has_the_known_moment() {
        let (ellipse, quadrature) = ellipse();
        let motion = Motion { precession: 0.0, omega: ellipse.contact.normal * 50.0 };
        let (wrench, power) = ellipse.friction(&motion, 0.02, 0.08, 1e-9, &quadrature);
        let (_, e) = ellip::ellipke(1.0 - 0.04).expect("parameter below 1");
        let expected = 3.0 / 8.0 * 0.08 * 130.0 * 0.5e-3 * e;
        // Kink of the direction at the centre: the quadrature converges like 1/order³.
        let spin_moment = -wrench.moment.dot(&ellipse.contact.normal);
        assert_relative_eq!(spin_moment, expected, max_relative = 1e-4);
        assert_relative_eq!(power, spin_moment * 50.0, max_relative = 1e-10);
        assert!(wrench.force.norm() <= 1e-10 * 0.08 * 130.0, "{}", wrench.force);
    }

    /// Identity: power is what force and moment do on the motion.
    #[test]
    fn power_is_force_times_motion() {
        let (ellipse, quadrature) = ellipse();
        let ellipse = Ellipse { pressed_radius: 4.2e-3, ..ellipse };
        let omega = Vector3::new(3.0, -57.0, 21.0);
        let motion = Motion { precession: 1.7, omega };
        let (wrench, power) = ellipse.friction(&motion, 0.02, 0.08, 1e-4, &quadrature);
        let done = wrench.force.x * 0.02 * 1.7 + wrench.moment.dot(&omega);
        assert_relative_eq!(power, -done, max_relative = 1e-12);
    }
}
