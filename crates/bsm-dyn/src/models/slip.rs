//! Slip of a solved ball at its contacts, by published and by exact formulas, and the power of each
//! kind of slip.
//!
//! Theory: `docs/theory/13-slip.md`, equations (X1) to (X16).

use std::f64::consts::FRAC_PI_2;

use bsm_kin::{BallFrame, Contact, Drive, Helix, Motion, Scalar, Site};
use bsm_newton::EvalError;
use nalgebra::Vector3;

use crate::contact::{FrictionLaw, Wrench, friction_force, magnitude};
use crate::ellipse::{ContactMotion, Ellipse, EllipseSlip, Quadrature};
use crate::models::ball::Control;
use crate::models::raceway_control::rolling;

/// A ball in steady motion between the members of a screw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteadyBall<D> {
    /// Helix of the ball centres.
    pub helix: Helix<D>,
    /// Ball radius `$r_b$` \[m\].
    pub radius: D,
    /// Speeds of screw and nut.
    pub drive: Drive<D>,
    /// Absolute motion, components in the Frenet-Serret triad `(t, n, b)`.
    pub motion: Motion<D>,
}

/// A contact of the ball.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactSite<D> {
    /// Where it sits.
    pub site: Site,
    /// Contact angle \[rad\].
    pub angle: D,
}

/// Power that friction takes at a contact, by the part of the slip that it works on \[W\] (X12).
///
/// The parts of the slip add up to the whole, point by point, and so do the powers. A part may be
/// negative: friction is against the whole slip, not against each of its parts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlipPower<D> {
    /// Of the slip at the contact centre, which all points share.
    pub centre: D,
    /// Of the spin about the contact normal.
    pub spin: D,
    /// Of the curvature of the pressed surface under a rolling ball (Heathcote).
    pub curvature: D,
}

impl<D: Scalar> SlipPower<D> {
    /// The whole.
    pub fn total(&self) -> D {
        self.centre + self.spin + self.curvature
    }
}

/// Where at a contact the ball slides.
#[derive(Debug, Clone, Copy)]
pub enum Sliding<'a, D> {
    /// At the contact centre only (F1).
    Point,
    /// Over the contact ellipse (E4).
    Ellipse {
        /// Semi-axes across and along the groove \[m\].
        semi_axes: (D, D),
        /// Radius of the pressed surface (E2) \[m\].
        pressed_radius: f64,
        /// Creep speed `$v_e$` \[m/s\], positive.
        creep: f64,
        /// Nodes over the ellipse.
        quadrature: &'a Quadrature,
    },
}

fn norm<D: Scalar>(v: &Vector3<D>) -> D {
    v.dot(v).sqrt()
}

impl<D: Scalar> SteadyBall<D> {
    /// A ball that rolls at both contacts and does not spin at the controlling raceway: raceway
    /// control at given contact angles at nut and screw \[rad\], without a balance of forces
    /// (W3) to (W6).
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

    fn frame(&self) -> BallFrame<D> {
        BallFrame::turned(self.helix.lead_angle, D::from(0.0))
    }

    fn body_speed(&self, site: Site) -> D {
        match site {
            Site::Nut | Site::NutUnloaded => self.drive.nut_speed,
            Site::Screw => self.drive.screw_speed,
        }
    }

    /// The unit vectors of a contact, components in `(t, n, b)`.
    pub fn contact(&self, touch: &ContactSite<D>) -> Contact<D> {
        Contact::new(touch.site, touch.angle, &self.frame())
    }

    /// Motion relative to the body of a contact.
    pub fn relative_to(&self, site: Site) -> Motion<D> {
        self.motion.relative_to(self.body_speed(site), &self.frame())
    }

    /// Motion relative to the nut, as the published forms take it: `$\omega_m = P - \Omega_n$` and
    /// `$\omega' = \omega - \Omega_n k$`.
    fn against_nut(&self) -> Motion<D> {
        self.relative_to(Site::Nut)
    }

    /// Velocity of the ball's surface against the body at the contact centre (K13) \[m/s\].
    pub fn slip_velocity(&self, touch: &ContactSite<D>) -> Vector3<D> {
        let point = self.contact(touch).point(self.radius);
        self.relative_to(touch.site).slip_velocity(self.helix.arc_length_per_radian(), &point)
    }

    /// Differential slip: slip speed at the contact centre (X1) \[m/s\].
    ///
    /// Source: Xu and Tang (2015), Eqs 1-2; published and exact form are the same.
    pub fn differential_slip(&self, touch: &ContactSite<D>) -> D {
        // |V_i|, V_i = v_i(−r_b N)                                        (X1)
        norm(&self.slip_velocity(touch))
    }

    /// Slip speed at the contact centre of a ball that stands still in the nut \[m/s\].
    pub fn stopped_slip(&self, touch: &ContactSite<D>) -> D {
        let speed = self.drive.nut_speed;
        let motion = Motion { precession: speed, omega: self.frame().k * speed };
        Self { motion, ..*self }.differential_slip(touch)
    }

    /// Gyroscopic angles of the axis about which the ball turns relative to the nut \[rad\]: from the
    /// plane of `$t$` and `$b$` towards `$-n$`, and in that plane from `$-b$` towards `$t$` (X4), (X14).
    ///
    /// Source: Xu and Tang (2015), `$\beta$` and `$\beta'$`; raceway control of bearings has the same angles.
    pub fn gyroscopic_angles(&self) -> [D; 2] {
        let omega = self.against_nut().omega;
        // sinγ = −ω'_n/|ω'|                                               (X4)
        let sin = -omega.y / norm(&omega);
        let angle = sin.atan2((-sin.square() + 1.0).sqrt());
        // tanγ' = −ω'_t/ω'_b                                              (X14)
        [angle, omega.x.atan2(-omega.z)]
    }

    /// Moment about the tangent that turns the rotation of the ball along with the triad \[N·m\]: the
    /// friction of all contacts gives it (X16).
    ///
    /// * `inertia`: of the ball about a diameter \[kg·m²\].
    ///
    /// Source: Dong et al. (2020), Eq 12, `$M_t$`.
    pub fn gyroscopic_moment(&self, inertia: D) -> D {
        let Motion { precession, omega } = self.motion;
        // M_t = I P (k × ω)·t                                             (X16)
        self.frame().k.cross(&omega).x * (inertia * precession)
    }

    /// Slip between neighbouring balls as published (X2) \[m/s\].
    ///
    /// Source: Xu and Tang (2015), Eq 4.
    pub fn ball_slip_published(&self) -> D {
        let Motion { precession, omega } = self.against_nut();
        // V_b = r_b | |ω'| − ω_m |                                        (X2)
        self.radius * magnitude(norm(&omega) - precession)
    }

    /// Relative speed of the surfaces of neighbouring balls where they touch (X3) \[m/s\].
    ///
    /// Assumes: the neighbour stands along the tangent and spins alike; its triad is turned by
    /// `$2 r_b/d$`, which changes the second order of that angle.
    pub fn ball_slip(&self) -> D {
        let Motion { precession, omega } = self.motion;
        let in_carrier = omega - self.frame().k * precession;
        // V_b = 2 r_b |(ω − P k) × t|                                     (X3)
        self.radius * 2.0 * norm(&in_carrier.cross(&BallFrame::tangent()))
    }

    /// Spin (gyroscopic) slip as published (X5) \[m/s\].
    ///
    /// * `angle`: contact angle \[rad\]: as printed that of the other contact, as corrected that of the
    ///   contact in question.
    ///
    /// Source: Xu and Tang (2015), Eqs 5-6. It takes the motion relative to the nut at both contacts.
    pub fn spin_slip_published(&self, angle: D) -> D {
        let rate = norm(&self.against_nut().omega);
        let [gamma, _] = self.gyroscopic_angles();
        let turned = (-(gamma + angle) + FRAC_PI_2) * 0.5;
        // V_s = r_b |sin((π/2 − γ − β)/2) |ω'| sinγ / cosβ|               (X5)
        self.radius * magnitude(turned.sin() * rate * gamma.sin() / angle.cos())
    }

    /// Spin about the contact normal (K14) \[rad/s\].
    pub fn spin(&self, touch: &ContactSite<D>) -> D {
        self.relative_to(touch.site).spin(&self.contact(touch))
    }

    /// Orbit slip as published (X7), (X8) \[m/s\].
    ///
    /// * `angle`: contact angle \[rad\]: as printed that of the other contact, as corrected that of the
    ///   contact in question.
    ///
    /// Source: Xu and Tang (2015), Eqs 7-8. Difference from the source: its levers have one root too
    /// many, with which the result is no speed.
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

    /// The part of the spin that the orbit has (X9) \[rad/s\]; the rest is the rotation of the ball
    /// against the triad that travels with it.
    pub fn orbit_spin(&self, touch: &ContactSite<D>) -> D {
        let rate = self.relative_to(touch.site).precession;
        // (ω − Ω_i k)·N = (ω − P k)·N + (P − Ω_i) k·N                     (X9)
        rate * self.frame().k.dot(&self.contact(touch).normal)
    }

    /// Mean speed at which the two surfaces run through the contact (X10) \[m/s\].
    pub fn rolling_speed(&self, touch: &ContactSite<D>) -> D {
        let Motion { precession, omega } = self.motion;
        let point = self.contact(touch).point(self.radius);
        let ball = (omega - self.frame().k * precession).cross(&point);
        // u = |(ω − P k) × r − V/2|                                       (X10)
        norm(&(ball - self.slip_velocity(touch) * D::from(0.5)))
    }

    /// Slip speed at the contact centre over the rolling speed; 2 if one surface stands still.
    pub fn slide_roll_ratio(&self, touch: &ContactSite<D>) -> D {
        self.differential_slip(touch) / self.rolling_speed(touch)
    }

    /// What friction takes at a contact, by the parts of the slip (X11), (X12).
    ///
    /// * `friction`: wrench of friction on the ball about its centre, in `(t, n, b)`.
    pub fn power(&self, touch: &ContactSite<D>, friction: &Wrench<D>) -> SlipPower<D> {
        let contact = self.contact(touch);
        let omega = self.relative_to(touch.site).omega;
        // M_C = M − r × F                                                 (X11)
        let moment = friction.moment - contact.point(self.radius).cross(&friction.force);
        let about_normal = moment.dot(&contact.normal);
        // P_f = −F·V − (M_C·N)(ω_i·N) − [M_C·ω_i − (M_C·N)(ω_i·N)]        (X12)
        let spin = -about_normal * omega.dot(&contact.normal);
        SlipPower {
            centre: -friction.force.dot(&self.slip_velocity(touch)),
            spin,
            curvature: -moment.dot(&omega) - spin,
        }
    }

    /// Friction on the ball at a contact, about its centre, in `(t, n, b)`.
    ///
    /// * `load`: normal load \[N\].
    ///
    /// # Errors
    ///
    /// [`EvalError`] if friction at a point has no direction.
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
    /// Slip of the points of a contact ellipse \[m/s\].
    ///
    /// * `semi_axes`: across and along the groove \[m\]. * `pressed_radius`: (E2) \[m\]. * `creep`: `$v_e$` \[m/s\].
    pub fn ellipse_slip(
        &self,
        touch: &ContactSite<f64>,
        semi_axes: (f64, f64),
        pressed_radius: f64,
        creep: f64,
    ) -> EllipseSlip<f64> {
        let (motion, arc) = (self.relative_to(touch.site), self.helix.arc_length_per_radian());
        let ContactMotion { along, omega } = ContactMotion::of(&motion, &self.contact(touch), arc);
        EllipseSlip::new(semi_axes, (pressed_radius, self.radius), along, omega, creep)
    }
}

/// Speed of the spin at the end of the contact ellipse, its fastest point (X6) \[m/s\].
pub fn rim_speed<D: Scalar>(spin: D, semi_axis: D) -> D {
    // V_s = |ω_spin| a                                                    (X6)
    magnitude(spin) * semi_axis
}

#[cfg(test)]
mod tests;
