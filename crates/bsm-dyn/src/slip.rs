//! Slip of a solved ball: what slides at its contacts, in published and in exact form, and the
//! power that each part of it takes.
//!
//! Theory: `docs/theory/13-slip.md`, equations (X1) to (X13).

use std::f64::consts::FRAC_PI_2;

use bsm_kin::{BallFrame, Contact, Drive, Helix, Motion, Scalar, Site};
use bsm_newton::EvalError;
use nalgebra::Vector3;

use crate::raceway_control::rolling;
use crate::{Control, Ellipse, Outputs, Quadrature, Wrench, friction_force};

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
pub struct Touch<D> {
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
    /// Of what is left: the curvature of the pressed surface under a rolling ball (Heathcote).
    pub curvature: D,
}

impl<D: Scalar> SlipPower<D> {
    /// The whole.
    pub fn total(&self) -> D {
        self.centre + self.spin + self.curvature
    }
}

/// How friction at a contact follows from slip.
#[derive(Debug, Clone, Copy)]
pub enum FrictionLaw<'a, D> {
    /// Coulomb friction at the contact centre (F1).
    Saturated,
    /// Integrated over the contact ellipse (E4).
    Integrated {
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

fn magnitude<D: Scalar>(x: D) -> D {
    if x.re() < 0.0 { -x } else { x }
}

fn norm<D: Scalar>(v: &Vector3<D>) -> D {
    v.dot(v).sqrt()
}

impl<D: Scalar> SteadyBall<D> {
    /// A ball that rolls at both contacts and does not spin at the controlling race: raceway
    /// control at given contact angles at nut and screw \[rad\], without a balance of forces
    /// (W3) to (W6).
    pub fn rolling(
        control: Control,
        helix: Helix<D>,
        radius: D,
        drive: Drive<D>,
        [nut, screw]: [D; 2],
    ) -> Self {
        let (p, omega) = rolling(control, helix.lead_angle, radius / helix.radius, nut, screw);
        let speed = drive.relative_speed();
        let to_nut = Motion { precession: p * speed, omega: omega * speed };
        let frame = BallFrame::turned(helix.lead_angle, D::from(0.0));
        let motion = to_nut.relative_to(-drive.nut_speed, &frame);
        Self { helix, radius, drive, motion }
    }

    fn frame(&self) -> BallFrame<D> {
        BallFrame::turned(self.helix.lead_angle, D::from(0.0))
    }

    fn body_speed(&self, site: Site) -> D {
        match site {
            Site::Nut | Site::NutMinor => self.drive.nut_speed,
            Site::Screw => self.drive.screw_speed,
        }
    }

    /// The unit vectors of a contact, components in `(t, n, b)`.
    pub fn contact(&self, touch: &Touch<D>) -> Contact<D> {
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
    pub fn slip_velocity(&self, touch: &Touch<D>) -> Vector3<D> {
        let point = self.contact(touch).point(self.radius);
        self.relative_to(touch.site).slip_velocity(self.helix.arc_length_per_radian(), &point)
    }

    /// Differential slip: slip speed at the contact centre (X1) \[m/s\].
    ///
    /// Source: Xu and Tang (2015), Eqs 1-2; published and exact form are the same.
    pub fn differential_slip(&self, touch: &Touch<D>) -> D {
        // |V_i|, V_i = v_i(−r_b N)                                        (X1)
        norm(&self.slip_velocity(touch))
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

    /// Spin (gyroscopic) slip as published (X4), (X5) \[m/s\].
    ///
    /// Source: Xu and Tang (2015), Eqs 5-6, with the contact angle of the contact in question; the
    /// indices of the source are crossed. It takes the motion relative to the nut at both.
    pub fn spin_slip_published(&self, touch: &Touch<D>) -> D {
        let omega = self.against_nut().omega;
        let rate = norm(&omega);
        // sinγ = −ω'_n/|ω'|                                               (X4)
        let sin = -omega.y / rate;
        let gamma = sin.atan2((-sin.square() + 1.0).sqrt());
        let turned = (-(gamma + touch.angle) + FRAC_PI_2) * 0.5;
        // V_s = r_b |sin((π/2 − γ − β)/2) |ω'| sinγ / cosβ|               (X5)
        self.radius * magnitude(turned.sin() * rate * sin / touch.angle.cos())
    }

    /// Spin about the contact normal (K14) \[rad/s\].
    pub fn spin(&self, touch: &Touch<D>) -> D {
        self.relative_to(touch.site).spin(&self.contact(touch))
    }

    /// Orbit slip as published, with the levers that belong to it (X7), (X8) \[m/s\].
    ///
    /// Source: Xu and Tang (2015), Eqs 7-8, whose levers have one root too many.
    pub fn orbit_slip_published(&self, touch: &Touch<D>) -> D {
        let (sin, cos) = touch.angle.sin_cos();
        let (r_b, r_m) = (self.radius, self.helix.radius);
        let side = if touch.site == Site::Screw { -2.0 } else { 2.0 };
        // l² = r_b² + r_m² ± 2 r_b r_m cosβ                               (X7)
        let lever = (r_b.square() + r_m.square() + r_b * r_m * cos * side).sqrt();
        let rate = self.relative_to(touch.site).precession;
        // V_o = l |(P − Ω_i) cosα sinβ|                                   (X8)
        lever * magnitude(rate * self.helix.lead_angle.cos() * sin)
    }

    /// The part of the spin that the orbit has (X9) \[rad/s\]; the rest is the rotation of the ball
    /// against the triad that travels with it.
    pub fn orbit_spin(&self, touch: &Touch<D>) -> D {
        let rate = self.relative_to(touch.site).precession;
        // (ω − Ω_i k)·N = (ω − P k)·N + (P − Ω_i) k·N                     (X9)
        rate * self.frame().k.dot(&self.contact(touch).normal)
    }

    /// Mean speed at which the two surfaces run through the contact (X10) \[m/s\].
    pub fn rolling_speed(&self, touch: &Touch<D>) -> D {
        let Motion { precession, omega } = self.motion;
        let point = self.contact(touch).point(self.radius);
        let ball = (omega - self.frame().k * precession).cross(&point);
        // u = |(ω − P k) × r − V/2|                                       (X10)
        norm(&(ball - self.slip_velocity(touch) * D::from(0.5)))
    }

    /// Slip speed at the contact centre over the rolling speed; 2 if one surface stands still.
    pub fn slide_roll_ratio(&self, touch: &Touch<D>) -> D {
        self.differential_slip(touch) / self.rolling_speed(touch)
    }

    /// What friction takes at a contact, by the parts of the slip (X11), (X12).
    ///
    /// * `friction`: wrench of friction on the ball about its centre, in `(t, n, b)`.
    pub fn power(&self, touch: &Touch<D>, friction: &Wrench<D>) -> SlipPower<D> {
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
    /// * `load`: normal load \[N\]; `friction`: Coulomb coefficient.
    ///
    /// # Errors
    ///
    /// [`EvalError`] if saturated friction has no direction.
    pub fn friction(
        &self,
        touch: &Touch<D>,
        load: D,
        friction: D,
        law: FrictionLaw<'_, D>,
    ) -> Result<Wrench<D>, EvalError> {
        let contact = self.contact(touch);
        match law {
            FrictionLaw::Integrated { semi_axes, pressed_radius, creep, quadrature } => {
                let ball_radius = self.radius.re();
                let ellipse = Ellipse { contact, load, semi_axes, pressed_radius, ball_radius };
                let arc = self.helix.arc_length_per_radian();
                let motion = self.relative_to(touch.site);
                Ok(ellipse.friction(&motion, arc, friction, creep, quadrature).0)
            }
            FrictionLaw::Saturated => {
                let force = friction_force(friction, load, &self.slip_velocity(touch))?;
                let point = contact.point(self.radius);
                Ok(Wrench::at_contact(&contact.normal, &point, D::from(0.0), &force))
            }
        }
    }
}

impl Outputs {
    /// Absolute motion of the ball in the Frenet-Serret triad, if the model has one.
    pub fn motion(&self) -> Option<Motion<f64>> {
        let omega = Vector3::new(self.omega_t?, self.omega_n?, self.omega_b?);
        Some(Motion { precession: self.precession?, omega })
    }
}

/// Speed of the spin at the end of the contact ellipse, its fastest point (X6) \[m/s\].
pub fn rim_speed<D: Scalar>(spin: D, semi_axis: D) -> D {
    // V_s = |ω_spin| a                                                    (X6)
    magnitude(spin) * semi_axis
}

#[cfg(test)]
mod tests {
    use std::num::NonZeroUsize;

    use approx::assert_relative_eq;
    use bsm_kin::Jet;
    use proptest::prelude::*;

    use super::*;

    const SITES: [Site; 2] = [Site::Nut, Site::Screw];

    fn ball(motion: Motion<f64>, lead_angle: f64) -> SteadyBall<f64> {
        SteadyBall {
            helix: Helix { radius: 20e-3, lead_angle },
            radius: 3e-3,
            drive: Drive { screw_speed: 523.0, nut_speed: -71.0 },
            motion,
        }
    }

    fn rolls(control: Control, lead: f64, angles: [f64; 2], forward: bool) -> SteadyBall<f64> {
        let speed = if forward { 523.0 } else { -523.0 };
        let drive = Drive { screw_speed: speed, nut_speed: 0.0 };
        let helix = Helix { radius: 20e-3, lead_angle: lead };
        SteadyBall::rolling(control, helix, 3e-3, drive, angles)
    }

    proptest! {
        /// Differential slip and spin are the value and the derivatives of the field of slip
        /// velocities at the contact centre.
        #[test]
        fn slips_are_value_and_slope_of_the_field(
            lead in 0.02..1.2_f64, beta in 0.05..1.5_f64, p in -300.0..300.0_f64,
            omega in proptest::array::uniform3(-3000.0..3000.0_f64), curved in 1.01..3.0_f64,
        ) {
            let ball = ball(Motion { precession: p, omega: omega.into() }, lead);
            for site in SITES {
                let touch = Touch { site, angle: beta };
                let contact = ball.contact(&touch);
                let lift = |v: Vector3<f64>| v.map(Jet::<2>::from);
                let tangent = BallFrame::<f64>::tangent();
                let across = tangent.cross(&contact.normal);
                let [x, y] = [0, 1].map(|i| Jet::<2>::variable(0.0, i));
                let height = x.square() * (-0.5 / curved) + ball.radius;
                let point = lift(contact.normal) * -height + lift(across) * x + lift(tangent) * y;
                let relative = ball.relative_to(site);
                let motion =
                    Motion { precession: relative.precession.into(), omega: lift(relative.omega) };
                let v = motion.slip_velocity(ball.helix.arc_length_per_radian().into(), &point);
                let (along, aside) = (v.dot(&lift(tangent)), v.dot(&lift(across)));
                // Rounding of speeds of up to 10 m/s, and of rates of 5e3 rad/s.
                let speed = along.re.hypot(aside.re);
                prop_assert!((ball.differential_slip(&touch) - speed).abs() <= 1e-13);
                let spin = ball.spin(&touch);
                prop_assert!((along.eps[0] - spin).abs() <= 1e-11, "{along:?} {spin}");
                prop_assert!((aside.eps[1] + spin).abs() <= 1e-11, "{aside:?} {spin}");
            }
        }

        /// A rolling ball slides across the groove only, at `r_b W sinα/2` at both contacts,
        /// whatever the contact angles and the pitch circle (X13).
        #[test]
        fn a_rolling_ball_slides_by_half_the_lead(
            lead in 0.01..1.5_f64, a in 0.02..1.55_f64, b in 0.02..1.55_f64, forward: bool,
        ) {
            for (control, race) in [(Control::Nut, Site::Nut), (Control::Screw, Site::Screw)] {
                let ball = rolls(control, lead, [a, b], forward);
                // |V_A| = |V_B| = r_b |W| sinα / 2                        (X13)
                let half = 3e-3 * 523.0 * lead.sin() / 2.0;
                for (site, angle) in [(Site::Nut, a), (Site::Screw, b)] {
                    let touch = Touch { site, angle };
                    // Rounding of speeds of the order of d W, up to 150 m/s at 1.5 rad.
                    prop_assert!((ball.differential_slip(&touch) - half).abs() <= 1e-13 / lead.cos());
                    prop_assert!(ball.rolling_speed(&touch) > 0.0);
                    if site == race {
                        let scale = ball.relative_to(site).omega.norm();
                        prop_assert!(ball.spin(&touch).abs() <= 1e-14 * scale);
                    }
                }
            }
        }

        /// The orbit and the rotation in the travelling triad make up the spin.
        #[test]
        fn orbit_is_a_part_of_the_spin(
            lead in 0.02..1.2_f64, beta in 0.05..1.5_f64, p in -300.0..300.0_f64,
            omega in proptest::array::uniform3(-3000.0..3000.0_f64),
        ) {
            let ball = ball(Motion { precession: p, omega: omega.into() }, lead);
            for site in SITES {
                let touch = Touch { site, angle: beta };
                let in_carrier = ball.motion.omega - ball.frame().k * p;
                let rest = in_carrier.dot(&ball.contact(&touch).normal);
                prop_assert!((ball.orbit_spin(&touch) + rest - ball.spin(&touch)).abs() <= 1e-11);
                // The published orbit slip is this rate at the distance from the axis.
                let to_contact = ball.contact(&touch).point(3e-3) - Vector3::y() * 20e-3;
                let published = ball.orbit_slip_published(&touch);
                let lever = to_contact.norm();
                prop_assert!((published - lever * ball.orbit_spin(&touch).abs()).abs() <= 1e-11);
            }
        }

        /// The powers of the parts add up to what friction takes, whatever the motion.
        #[test]
        fn powers_of_the_parts_add_up(
            beta in 0.05..1.5_f64, p in -300.0..300.0_f64,
            omega in proptest::array::uniform3(-3000.0..3000.0_f64),
        ) {
            let ball = ball(Motion { precession: p, omega: omega.into() }, 0.15);
            let quadrature = Quadrature::new(NonZeroUsize::new(6).expect("positive"));
            let touch = Touch { site: Site::Screw, angle: beta };
            let ellipse = Ellipse {
                contact: ball.contact(&touch),
                load: 210.0,
                semi_axes: (0.4e-3, 0.06e-3),
                pressed_radius: 3.1e-3,
                ball_radius: 3e-3,
            };
            let arc = ball.helix.arc_length_per_radian();
            let motion = ball.relative_to(Site::Screw);
            let (_, power) = ellipse.friction(&motion, arc, 0.07, 1e-4, &quadrature);
            let Ellipse { semi_axes, pressed_radius, .. } = ellipse;
            let quadrature = &quadrature;
            let law = FrictionLaw::Integrated { semi_axes, pressed_radius, creep: 1e-4, quadrature };
            let wrench = ball.friction(&touch, 210.0, 0.07, law).unwrap();
            let parts = ball.power(&touch, &wrench);
            // Rounding of powers of up to 15 N times 20 m/s.
            prop_assert!((parts.total() - power).abs() <= 1e-11, "{parts:?} {power}");
            let wrench = ball.friction(&touch, 210.0, 0.07, FrictionLaw::Saturated).unwrap();
            let parts = ball.power(&touch, &wrench);
            let expected = 0.07 * 210.0 * ball.differential_slip(&touch);
            prop_assert!((parts.centre - expected).abs() <= 1e-11);
            prop_assert!(parts.spin.abs() + parts.curvature.abs() <= 1e-10, "{parts:?}");
        }
    }

    /// Two balls that turn with the cage do not rub; one that rolls on a plane rubs its neighbour
    /// with twice its rim speed.
    #[test]
    fn neighbours_rub_with_both_rims() {
        let frame = BallFrame::turned(0.2, 0.0);
        let frozen = ball(Motion { precession: 91.0, omega: frame.k * 91.0 }, 0.2);
        assert!(frozen.ball_slip() < 1e-14);
        let rolling = Motion { precession: 0.0, omega: Vector3::new(5.0, 0.0, 100.0) };
        assert_relative_eq!(ball(rolling, 0.2).ball_slip(), 0.6, max_relative = 1e-14);
    }

    /// The published spin slip depends on the direction of the drive, and does not vanish at the
    /// race that controls; the spin does neither.
    #[test]
    fn published_spin_slip_is_not_the_spin() {
        let lead = 1e-9;
        let at = |forward| {
            let ball = rolls(Control::Nut, lead, [0.7, 0.7], forward);
            let touch = Touch { site: Site::Nut, angle: 0.7 };
            (ball.spin_slip_published(&touch), ball.spin(&touch), ball.relative_to(Site::Nut))
        };
        let ((there, spin, motion), (back, other, _)) = (at(true), at(false));
        let rate = motion.omega.norm();
        // Without lead γ = ∓β: sin(π/4) forwards, sin(π/4 − β) backwards, times r_b |ω'| tanβ.
        let tangent = 3e-3 * rate * 0.7_f64.tan();
        assert_relative_eq!(there, (FRAC_PI_2 / 2.0).sin() * tangent, max_relative = 1e-8);
        let opposite = (FRAC_PI_2 / 2.0 - 0.7).sin() * tangent;
        assert_relative_eq!(back, opposite, max_relative = 1e-8);
        assert!(spin.abs() + other.abs() < 1e-12 * rate);
    }

    /// A surface that stands still has a slide-roll ratio of two.
    #[test]
    fn slide_roll_ratio_of_a_locked_ball_is_two() {
        // The ball is frozen to the nut, and so is what touches it there; the screw slides past.
        let drive = Drive { screw_speed: 523.0, nut_speed: -71.0 };
        let frame = BallFrame::turned(0.2, 0.0);
        let frozen = Motion { precession: drive.nut_speed, omega: frame.k * drive.nut_speed };
        let ball = ball(frozen, 0.2);
        let touch = Touch { site: Site::Screw, angle: 0.8 };
        assert_relative_eq!(ball.slide_roll_ratio(&touch), 2.0, max_relative = 1e-13);
        let touch = Touch { site: Site::Nut, angle: 0.8 };
        assert!(ball.differential_slip(&touch) < 1e-14);
    }
}
