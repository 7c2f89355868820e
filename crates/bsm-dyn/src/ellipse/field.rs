//! Slip and friction at individual points of a contact ellipse, for plots and tables.
//!
//! Coordinates are divided by the semi-axes: `xi` is along `$t \times N$` (across the groove), and
//! `upsilon` is along `$t$`.

use super::EllipseSlip;
use crate::contact::FrictionLaw;

impl EllipseSlip<f64> {
    /// Returns the slip along and across the groove at a point. The slip has the unit of the speeds
    /// from which `self` was created.
    pub fn at(&self, xi: f64, upsilon: f64) -> [f64; 2] {
        let (b_0, spin) = (self.across_at(xi, 0.0).0, self.spin_speed);
        // v_t = q₀ + q₁ ξ + q₂ ξ²                                        (T12)
        [self.along(xi), -(b_0 + spin * upsilon)]
    }

    /// Returns the friction stress along and across the groove at a point, divided by the pressure.
    /// Its magnitude equals the friction coefficient if the slip speed is large compared with the
    /// creep speed.
    pub fn friction(&self, xi: f64, upsilon: f64, law: &impl FrictionLaw<f64>) -> [f64; 2] {
        let pressure = (1.0 - xi * xi - upsilon * upsilon).max(0.0).sqrt();
        let slip = self.at(xi, upsilon);
        // dF = −f dQ v/√(v² + v_e²)                                           (E4)
        let speed = slip[0].hypot(slip[1]).hypot(self.creep);
        let pull = law.coefficient(pressure, speed) / speed;
        slip.map(|v| -pull * v)
    }

    /// Returns true if the slip speed is below the creep speed, so that the surfaces almost stick.
    pub fn creeps(&self, xi: f64, upsilon: f64) -> bool {
        let [along, across] = self.at(xi, upsilon);
        along.hypot(across) < self.creep
    }

    /// Returns the positions on the long axis at which there is no slip along the groove (lines of
    /// pure rolling), in ascending order. There are at most two such lines.
    pub fn rolling_lines(&self) -> Vec<f64> {
        let [q_0, q_1, q_2] = self.longitudinal;
        // The root with the larger magnitude is calculated without cancellation. The other root
        // follows from the product of both roots.
        let sum = -0.5 * (q_1 + (q_1 * q_1 - 4.0 * q_0 * q_2).sqrt().copysign(q_1));
        let mut lines: Vec<_> =
            [q_0 / sum, sum / q_2].into_iter().filter(|xi| xi.abs() < 1.0).collect();
        lines.sort_by(f64::total_cmp);
        lines
    }

    /// Returns the spin poles, which are the points of the ellipse at which the slip is zero.
    pub fn spin_poles(&self) -> Vec<[f64; 2]> {
        let pole = |xi: f64| {
            let upsilon = -self.across_at(xi, 0.0).0 / self.spin_speed;
            (xi.hypot(upsilon) < 1.0).then_some([xi, upsilon])
        };
        self.rolling_lines().into_iter().filter_map(pole).collect()
    }
}

#[cfg(test)]
mod tests {
    use bsm_kin::{BallFrame, Contact, Motion, Site};
    use nalgebra::Vector3;

    use super::*;
    use crate::ellipse::Ellipse;
    use crate::ellipse::contact_motion;
    use crate::{Coulomb, hertz::Quadrature};

    const ARC: f64 = 0.02;
    const CREEP: f64 = 1e-5;

    fn ellipse() -> (Ellipse<f64>, Motion<f64>, EllipseSlip<f64>) {
        let contact = Contact::new(Site::Nut, 0.8, &BallFrame::turned(0.17, 0.0));
        let ellipse = Ellipse {
            contact,
            load: 130.0,
            semi_axes: (0.5e-3, 0.1e-3),
            pressed_radius: 4.2e-3,
            ball_radius: 4e-3,
        };
        let across = BallFrame::tangent().cross(&contact.normal);
        // The ball rolls along the groove, with spin and with a small slip across the groove.
        let omega = across * -50.0 + contact.normal * 40.0 + BallFrame::tangent() * 0.3;
        let motion = Motion { precession: 50.0 * 3.99e-3 / ARC, omega };
        let local = contact_motion(&motion, &contact, ARC);
        let radii = (ellipse.pressed_radius, ellipse.ball_radius);
        let slip = EllipseSlip::new(ellipse.semi_axes, radii, local.speed, local.omega, CREEP);
        (ellipse, motion, slip)
    }

    /// The sum of the local friction over a fine grid equals the friction force that the quadrature
    /// gives.
    #[test]
    fn local_friction_adds_up_to_the_friction_of_the_ellipse() {
        const STEPS: u32 = 600;
        let (ellipse, motion, slip) = ellipse();
        let law = Coulomb(0.08);
        let (wrench, _) = ellipse.friction(&motion, ARC, &law, CREEP, &Quadrature::of(1e-8));
        let (mut force, mut load) = ([0.0; 2], 0.0);
        let place = |i: u32| 2.0 * (f64::from(i) + 0.5) / f64::from(STEPS) - 1.0;
        for (xi, upsilon) in (0..STEPS).flat_map(|i| (0..STEPS).map(move |j| (place(i), place(j))))
        {
            let pressure = (1.0 - xi * xi - upsilon * upsilon).max(0.0).sqrt();
            let part = slip.friction(xi, upsilon, &law).map(|f| f * pressure);
            (force, load) = ([force[0] + part[0], force[1] + part[1]], load + pressure);
        }
        let across = BallFrame::tangent().cross(&ellipse.contact.normal);
        let expected: [f64; 2] = [wrench.force.x, wrench.force.dot(&across)];
        for (sum, expected) in force.into_iter().zip(expected) {
            // Integration over a grid of squares has an error of a few times 1e-4 f Q, because the
            // friction direction changes abruptly at the spin pole.
            let error: f64 = sum / load * ellipse.load - expected;
            assert!(error.abs() < 1e-3 * 0.08 * ellipse.load, "{sum} {expected}");
        }
    }

    /// At a spin pole, the slip is zero; on a line of pure rolling, the slip along the groove is
    /// zero.
    #[test]
    fn slip_is_zero_at_spin_poles() {
        let (_, _, slip) = ellipse();
        let (lines, poles) = (slip.rolling_lines(), slip.spin_poles());
        assert!(!lines.is_empty() && !poles.is_empty(), "{lines:?} {poles:?}");
        let [fastest, _] = slip.at(1.0, 0.0);
        for xi in lines {
            // The tolerance allows for rounding errors in the solution of the quadratic equation.
            assert!(slip.at(xi, 0.3)[0].abs() < 1e-12 * fastest.abs());
        }
        for [xi, upsilon] in poles {
            let v = slip.at(xi, upsilon);
            assert!(Vector3::new(v[0], v[1], 0.0).norm() < 1e-12 * fastest.abs(), "{v:?}");
        }
    }
}
