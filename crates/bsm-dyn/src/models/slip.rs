//! Slip at the contacts of a ball whose motion is known, calculated with published and with exact
//! formulas, and the friction power of each slip component.
//!
//! Theory: `docs/theory/13-slip.md`, equations (X1) to (X16).

use std::f64::consts::FRAC_PI_2;

use bsm_kin::{BallFrame, Contact, Drive, Helix, Motion, Scalar, Site};
use bsm_newton::EvalError;
use nalgebra::Vector3;

use crate::contact::{FrictionLaw, Wrench, friction_force, magnitude};
use crate::ellipse::{Ellipse, EllipseSlip, Quadrature, contact_motion};
use crate::models::ball::Control;
use crate::models::raceway_control::rolling;

/// A ball in steady motion between nut and screw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteadyBall<D> {
    /// Helix of the ball centers.
    pub helix: Helix<D>,
    /// Ball radius `$r_b$` \[m\].
    pub radius: D,
    /// Angular speeds of the screw and the nut.
    pub drive: Drive<D>,
    /// Absolute motion of the ball in the Frenet-Serret triad `(t, n, b)`.
    pub motion: Motion<D>,
}

/// A contact of the ball, given by its flank and its contact angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactSite<D> {
    /// Flank on which the contact lies: nut, unloaded flank of the nut, or screw.
    pub site: Site,
    /// Contact angle \[rad\].
    pub angle: D,
}

/// Friction power at a contact \[W\], divided among the slip components (X12).
///
/// The slip components add up to the total slip at every point, and their powers add up to the
/// total power. The power of a component may be negative, because friction opposes the total slip,
/// not each component.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlipPower<D> {
    /// Power dissipated by the slip at the contact center. This slip component is the same at all
    /// points of the contact.
    pub center: D,
    /// Power dissipated by spin about the contact normal.
    pub spin: D,
    /// Power dissipated by slip due to the curvature of the contact surface (Heathcote slip).
    pub curvature: D,
}

impl<D: Scalar> SlipPower<D> {
    /// Returns the sum of the powers of all slip components.
    pub fn total(&self) -> D {
        self.center + self.spin + self.curvature
    }
}

/// Region of a contact in which the ball slides.
#[derive(Debug, Clone, Copy)]
pub enum Sliding<'a, D> {
    /// The ball slides only at the contact center: point contact (F1).
    Point,
    /// The ball slides over the whole contact ellipse (E4).
    Ellipse {
        /// Semi-axes across and along the groove \[m\].
        semi_axes: (D, D),
        /// Radius of the contact surface (E2) \[m\].
        pressed_radius: f64,
        /// Creep speed `$v_e$` \[m/s\], positive.
        creep: f64,
        /// Quadrature rule for the integration over the ellipse.
        quadrature: &'a Quadrature,
    },
}

/// Returns the length of a vector.
fn norm<D: Scalar>(v: &Vector3<D>) -> D {
    v.dot(v).sqrt()
}

impl<D: Scalar> SteadyBall<D> {
    /// Creates a ball that rolls at both contacts and does not spin at the controlling raceway. The
    /// motion follows the hypothesis of raceway control without a force balance, for given contact
    /// angles \[rad\] at the nut and the screw (W3) to (W6).
    pub fn rolling(
        control: Control,
        helix: Helix<D>,
        radius: D,
        drive: Drive<D>,
        [nut, screw]: [D; 2],
    ) -> Self {
        let arc = helix.arc_length_per_radian() / radius;
        let angles = [nut.sin_cos(), screw.sin_cos()];
        let (p, omega) = rolling(control == Control::Nut, helix.lead_angle.sin_cos(), arc, angles);
        let speed = drive.relative_speed();
        let to_nut = Motion { precession: p * speed, omega: Vector3::from(omega) * speed };
        let frame = BallFrame::turned(helix.lead_angle, D::from(0.0));
        let motion = to_nut.relative_to(-drive.nut_speed, &frame);
        Self { helix, radius, drive, motion }
    }

    /// Returns the Frenet-Serret triad of the helix.
    fn frame(&self) -> BallFrame<D> {
        BallFrame::turned(self.helix.lead_angle, D::from(0.0))
    }

    /// Returns the angular speed of the body (nut or screw) that the ball touches at the contact
    /// \[rad/s\].
    fn body_speed(&self, site: Site) -> D {
        match site {
            Site::Nut | Site::NutUnloaded => self.drive.nut_speed,
            Site::Screw => self.drive.screw_speed,
        }
    }

    /// Returns the unit vectors of a contact with components in `(t, n, b)`.
    pub fn contact(&self, touch: &ContactSite<D>) -> Contact<D> {
        Contact::new(touch.site, touch.angle, &self.frame())
    }

    /// Returns the motion of the ball relative to the body (nut or screw) that it touches at the
    /// contact.
    pub fn relative_to(&self, site: Site) -> Motion<D> {
        self.motion.relative_to(self.body_speed(site), &self.frame())
    }

    /// Returns the motion relative to the nut, which the published formulas use: `$\omega_m = P -
    /// \Omega_n$` and `$\omega' = \omega - \Omega_n k$`.
    fn against_nut(&self) -> Motion<D> {
        self.relative_to(Site::Nut)
    }

    /// Returns the velocity of the ball surface at the contact center, relative to the nut or the
    /// screw (K13) \[m/s\].
    pub fn slip_velocity(&self, touch: &ContactSite<D>) -> Vector3<D> {
        let point = self.contact(touch).point(self.radius);
        self.relative_to(touch.site).slip_velocity(self.helix.arc_length_per_radian(), &point)
    }

    /// Returns the differential slip, which is the slip speed at the contact center (X1) \[m/s\].
    ///
    /// Source: Xu and Tang (2015), Equations 1 and 2. The published formula equals the exact
    /// formula.
    pub fn differential_slip(&self, touch: &ContactSite<D>) -> D {
        // |V_i|, V_i = v_i(−r_b N)                                        (X1)
        norm(&self.slip_velocity(touch))
    }

    /// Returns the slip speed at the contact center for a ball at rest relative to the nut \[m/s\].
    pub fn stopped_slip(&self, touch: &ContactSite<D>) -> D {
        let speed = self.drive.nut_speed;
        let motion = Motion { precession: speed, omega: self.frame().k * speed };
        Self { motion, ..*self }.differential_slip(touch)
    }

    /// Returns the gyroscopic angles \[rad\] of the axis about which the ball rotates relative to
    /// the nut. The first angle is measured from the plane of `$t$` and `$b$` toward `$-n$`, the
    /// second angle within this plane from `$-b$` toward `$t$` (X4), (X14).
    ///
    /// Source: Xu and Tang (2015), `$\beta$` and `$\beta'$`. The same angles are used in the
    /// raceway-control theory of bearings.
    pub fn gyroscopic_angles(&self) -> [D; 2] {
        let omega = self.against_nut().omega;
        // sinγ = −ω'_n/|ω'|                                               (X4)
        let sin = -omega.y / norm(&omega);
        let angle = sin.atan2((-sin.square() + 1.0).sqrt());
        // tanγ' = −ω'_t/ω'_b                                              (X14)
        [angle, omega.x.atan2(-omega.z)]
    }

    /// Returns the moment about the tangent \[N·m\] that is needed to make the angular velocity
    /// vector of the ball rotate together with the triad. This moment is provided by the friction
    /// of all contacts (X16).
    ///
    /// * `inertia`: moment of inertia of the ball about a diameter \[kg·m²\].
    ///
    /// Source: Dong et al. (2020), Eq 12, `$M_t$`.
    pub fn gyroscopic_moment(&self, inertia: D) -> D {
        let Motion { precession, omega } = self.motion;
        // M_t = I P (k × ω)·t                                             (X16)
        self.frame().k.cross(&omega).x * (inertia * precession)
    }

    /// Returns the slip between neighboring balls according to the published formula (X2) \[m/s\].
    ///
    /// Source: Xu and Tang (2015), Eq 4.
    pub fn ball_slip_published(&self) -> D {
        let Motion { precession, omega } = self.against_nut();
        // V_b = r_b | |ω'| − ω_m |                                        (X2)
        self.radius * magnitude(norm(&omega) - precession)
    }

    /// Returns the relative speed of the surfaces of neighboring balls at their contact point (X3)
    /// \[m/s\].
    ///
    /// Assumes: the neighboring ball is in the direction of the tangent and has the same angular
    /// velocity. The rotation of the triad by `$2 r_b/d$` has only a second-order effect.
    pub fn ball_slip(&self) -> D {
        let Motion { precession, omega } = self.motion;
        let in_carrier = omega - self.frame().k * precession;
        // V_b = 2 r_b |(ω − P k) × t|                                     (X3)
        self.radius * 2.0 * norm(&in_carrier.cross(&BallFrame::tangent()))
    }

    /// Returns the spin (gyroscopic) slip according to the published formula (X5) \[m/s\].
    ///
    /// * `angle`: contact angle \[rad\]. The printed formula uses the angle of the opposite
    ///   contact; the corrected formula uses the angle of the contact itself.
    ///
    /// Source: Xu and Tang (2015), Equations 5 and 6. At both contacts, the formula uses the motion
    /// relative to the nut.
    pub fn spin_slip_published(&self, angle: D) -> D {
        let rate = norm(&self.against_nut().omega);
        let [gamma, _] = self.gyroscopic_angles();
        let turned = (-(gamma + angle) + FRAC_PI_2) * 0.5;
        // V_s = r_b |sin((π/2 − γ − β)/2) |ω'| sinγ / cosβ|               (X5)
        self.radius * magnitude(turned.sin() * rate * gamma.sin() / angle.cos())
    }

    /// Returns the spin about the contact normal (K14) \[rad/s\].
    pub fn spin(&self, touch: &ContactSite<D>) -> D {
        self.relative_to(touch.site).spin(&self.contact(touch))
    }

    /// Returns the orbit slip according to the published formula (X7), (X8) \[m/s\].
    ///
    /// * `angle`: contact angle \[rad\]. The printed formula uses the angle of the opposite
    ///   contact; the corrected formula uses the angle of the contact itself.
    ///
    /// Source: Xu and Tang (2015), Equations 7 and 8. Difference from the source: the printed lever
    /// arms contain an additional square root, so that the result is not a speed.
    pub fn orbit_slip_published(&self, site: Site, angle: D) -> D {
        let (sin, cos) = angle.sin_cos();
        let (r_b, r_m) = (self.radius, self.helix.radius);
        let side = if site == Site::Screw { -2.0 } else { 2.0 };
        // l² = r_b² + r_m² ± 2 r_b r_m cosβ                               (X7)
        let lever = (r_b.square() + r_m.square() + r_b * r_m * cos * side).sqrt();
        let rate = self.relative_to(site).precession;
        // V_o = l |(P − Ω_i) cosα sinβ|                                   (X8)
        lever * magnitude(rate * self.helix.lead_angle.cos() * sin)
    }

    /// Returns the component of the spin that is due to the orbit of the ball (X9) \[rad/s\]. The
    /// remaining component is due to the rotation of the ball relative to the triad that travels
    /// with it.
    pub fn orbit_spin(&self, touch: &ContactSite<D>) -> D {
        let rate = self.relative_to(touch.site).precession;
        // (ω − Ω_i k)·N = (ω − P k)·N + (P − Ω_i) k·N                     (X9)
        rate * self.frame().k.dot(&self.contact(touch).normal)
    }

    /// Returns the mean speed at which both surfaces move through the contact (X10) \[m/s\].
    pub fn rolling_speed(&self, touch: &ContactSite<D>) -> D {
        let Motion { precession, omega } = self.motion;
        let point = self.contact(touch).point(self.radius);
        let ball = (omega - self.frame().k * precession).cross(&point);
        // u = |(ω − P k) × r − V/2|                                       (X10)
        norm(&(ball - self.slip_velocity(touch) * D::from(0.5)))
    }

    /// Returns the slip speed at the contact center divided by the rolling speed. The ratio is 2 if
    /// one surface is at rest.
    pub fn slide_roll_ratio(&self, touch: &ContactSite<D>) -> D {
        self.differential_slip(touch) / self.rolling_speed(touch)
    }

    /// Returns the friction power at a contact, divided among the slip components (X11), (X12).
    ///
    /// * `friction`: force and moment (about the ball center) of friction on the ball, with
    ///   components in `(t, n, b)`.
    pub fn power(&self, touch: &ContactSite<D>, friction: &Wrench<D>) -> SlipPower<D> {
        let contact = self.contact(touch);
        let omega = self.relative_to(touch.site).omega;
        // M_C = M − r × F                                                 (X11)
        let moment = friction.moment - contact.point(self.radius).cross(&friction.force);
        let about_normal = moment.dot(&contact.normal);
        // P_f = −F·V − (M_C·N)(ω_i·N) − [M_C·ω_i − (M_C·N)(ω_i·N)]        (X12)
        let spin = -about_normal * omega.dot(&contact.normal);
        SlipPower {
            center: -friction.force.dot(&self.slip_velocity(touch)),
            spin,
            curvature: -moment.dot(&omega) - spin,
        }
    }

    /// Returns the force and the moment (about the ball center) of friction on the ball at a
    /// contact, with components in `(t, n, b)`.
    ///
    /// * `load`: normal load \[N\].
    ///
    /// # Errors
    ///
    /// Returns [`EvalError`] if the direction of friction is undefined at a point of the contact.
    pub fn friction(
        &self,
        touch: &ContactSite<D>,
        load: D,
        law: &impl FrictionLaw<D>,
        sliding: Sliding<'_, D>,
    ) -> Result<Wrench<D>, EvalError> {
        let contact = self.contact(touch);
        match sliding {
            Sliding::Ellipse { semi_axes, pressed_radius, creep, quadrature } => {
                let ball_radius = self.radius.re();
                let ellipse = Ellipse { contact, load, semi_axes, pressed_radius, ball_radius };
                let arc = self.helix.arc_length_per_radian();
                let motion = self.relative_to(touch.site);
                Ok(ellipse.friction(&motion, arc, law, creep, quadrature).0)
            }
            Sliding::Point => {
                let force = friction_force(law, load, &self.slip_velocity(touch))?;
                let point = contact.point(self.radius);
                Ok(Wrench::at_contact(&contact.normal, &point, D::from(0.0), &force))
            }
        }
    }
}

impl SteadyBall<f64> {
    /// Returns the distribution of the slip velocity over a contact ellipse \[m/s\].
    ///
    /// * `semi_axes`: semi-axes across and along the groove \[m\].
    /// * `pressed_radius`: radius of the contact surface (E2) \[m\].
    /// * `creep`: creep speed `$v_e$` \[m/s\].
    pub fn ellipse_slip(
        &self,
        touch: &ContactSite<f64>,
        semi_axes: (f64, f64),
        pressed_radius: f64,
        creep: f64,
    ) -> EllipseSlip<f64> {
        let (motion, arc) = (self.relative_to(touch.site), self.helix.arc_length_per_radian());
        let bsm_kin::ContactMotion { speed, omega } =
            contact_motion(&motion, &self.contact(touch), arc);
        EllipseSlip::new(semi_axes, (pressed_radius, self.radius), speed, omega, creep)
    }
}

/// Returns the maximum slip speed due to spin, which occurs at the ends of the contact ellipse (X6)
/// \[m/s\].
pub fn rim_speed<D: Scalar>(spin: D, semi_axis: D) -> D {
    // V_s = |ω_spin| a                                                    (X6)
    magnitude(spin) * semi_axis
}

#[cfg(test)]
mod tests;
