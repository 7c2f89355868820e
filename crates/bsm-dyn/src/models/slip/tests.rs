//! Tests of the slip formulas: limiting cases and identities.

use approx::assert_relative_eq;
use bsm_kin::Jet;
use proptest::prelude::*;

use super::*;
use crate::Coulomb;

const SITES: [Site; 2] = [Site::Nut, Site::Screw];

fn ball(motion: Motion<f64>, lead_angle: f64) -> SteadyBall<f64> {
    SteadyBall {
        helix: Helix { radius: 20e-3, lead_angle },
        radius: 3e-3,
        drive: Drive { screw_speed: 523.0, nut_speed: -71.0 },
        motion,
    }
}

fn rolling_ball(control: Control, lead: f64, angles: [f64; 2], forward: bool) -> SteadyBall<f64> {
    let speed = if forward { 523.0 } else { -523.0 };
    let drive = Drive { screw_speed: speed, nut_speed: 0.0 };
    let helix = Helix { radius: 20e-3, lead_angle: lead };
    SteadyBall::rolling(control, helix, 3e-3, drive, angles)
}

proptest! {
    /// At the contact center, the differential slip equals the value of the slip velocity field,
    /// and the spin equals the curl of this field.
    #[test]
    fn differential_slip_and_spin_match_the_slip_velocity_field(
        lead in 0.02..1.2_f64, beta in 0.05..1.5_f64, p in -300.0..300.0_f64,
        omega in proptest::array::uniform3(-3000.0..3000.0_f64), curved in 1.01..3.0_f64,
    ) {
        let ball = ball(Motion { precession: p, omega: omega.into() }, lead);
        for site in SITES {
            let touch = ContactSite { site, angle: beta };
            let contact = ball.contact(&touch);
            let lift = |v: Vector3<f64>| v.map(Jet::<2>::from);
            let tangent = BallFrame::<f64>::tangent();
            let transverse = tangent.cross(&contact.normal);
            let [x, y] = [0, 1].map(|i| Jet::<2>::variable(0.0, i));
            let height = x * x * (-0.5 / curved) + ball.radius;
            let point = lift(contact.normal) * -height + lift(transverse) * x + lift(tangent) * y;
            let relative = ball.relative_to(site);
            let motion =
                Motion { precession: relative.precession.into(), omega: lift(relative.omega) };
            let v = motion.slip_velocity(ball.helix.arc_length_per_radian().into(), &point);
            let (along, aside) = (v.dot(&lift(tangent)), v.dot(&lift(transverse)));
            // The tolerances allow for rounding errors of speeds up to 10 m/s and rotation rates up
            // to 5e3 rad/s.
            let speed = along.re.hypot(aside.re);
            prop_assert!((ball.differential_slip(&touch) - speed).abs() <= 1e-13);
            let spin = ball.spin(&touch);
            prop_assert!((along.eps[0] - spin).abs() <= 1e-11, "{along:?} {spin}");
            prop_assert!((aside.eps[1] + spin).abs() <= 1e-11, "{aside:?} {spin}");
        }
    }

    /// For all contact angles and pitch circles, a rolling ball slides only across the groove, at a
    /// speed of `r_b W sinα/2` at both contacts (X13).
    #[test]
    fn each_contact_of_a_rolling_ball_has_half_of_the_slip_due_to_the_lead(
        lead in 0.01..1.5_f64, a in 0.02..1.55_f64, b in 0.02..1.55_f64, forward: bool,
    ) {
        for (control, raceway) in [(Control::Nut, Site::Nut), (Control::Screw, Site::Screw)] {
            let ball = rolling_ball(control, lead, [a, b], forward);
            // |V_A| = |V_B| = r_b |W| sinα / 2                        (X13)
            let half = 3e-3 * 523.0 * lead.sin() / 2.0;
            for (site, angle) in [(Site::Nut, a), (Site::Screw, b)] {
                let touch = ContactSite { site, angle };
                // The tolerance is the rounding error of speeds of the order of d W, up to 150 m/s
                // at a lead angle of 1.5 rad.
                prop_assert!((ball.differential_slip(&touch) - half).abs() <= 1e-13 / lead.cos());
                prop_assert!(ball.rolling_speed(&touch) > 0.0);
                if site == raceway {
                    let scale = ball.relative_to(site).omega.norm();
                    prop_assert!(ball.spin(&touch).abs() <= 1e-14 * scale);
                }
            }
        }
    }

    /// The spin is the sum of its orbital component and the rotation relative to the traveling
    /// triad.
    #[test]
    fn spin_is_the_sum_of_orbital_spin_and_spin_relative_to_the_traveling_triad(
        lead in 0.02..1.2_f64, beta in 0.05..1.5_f64, p in -300.0..300.0_f64,
        omega in proptest::array::uniform3(-3000.0..3000.0_f64),
    ) {
        let ball = ball(Motion { precession: p, omega: omega.into() }, lead);
        for site in SITES {
            let touch = ContactSite { site, angle: beta };
            let in_carrier = ball.motion.omega - ball.frame().k * p;
            let rest = in_carrier.dot(&ball.contact(&touch).normal);
            prop_assert!((ball.orbit_spin(&touch) + rest - ball.spin(&touch)).abs() <= 1e-11);
            // The published orbit slip is the product of the orbit spin and the distance from the
            // axis.
            let to_contact = ball.contact(&touch).point(3e-3) - Vector3::y() * 20e-3;
            let published = ball.orbit_slip_published(site, beta);
            let lever = to_contact.norm();
            prop_assert!((published - lever * ball.orbit_spin(&touch).abs()).abs() <= 1e-11);
        }
    }

    /// For any motion, the powers of all components of the slip add up to the friction power.
    #[test]
    fn powers_of_the_slip_components_add_up_to_the_friction_power(
        beta in 0.05..1.5_f64, p in -300.0..300.0_f64,
        omega in proptest::array::uniform3(-3000.0..3000.0_f64),
    ) {
        let ball = ball(Motion { precession: p, omega: omega.into() }, 0.15);
        let quadrature = Quadrature::of(1e-4);
        let touch = ContactSite { site: Site::Screw, angle: beta };
        let ellipse = Ellipse {
            contact: ball.contact(&touch),
            load: 210.0,
            semi_axes: (0.4e-3, 0.06e-3),
            pressed_radius: 3.1e-3,
            ball_radius: 3e-3,
        };
        let arc = ball.helix.arc_length_per_radian();
        let motion = ball.relative_to(Site::Screw);
        let (_, power) = ellipse.friction(&motion, arc, &Coulomb(0.07), 1e-4, &quadrature);
        let Ellipse { semi_axes, pressed_radius, .. } = ellipse;
        let quadrature = &quadrature;
        let sliding = Sliding::Ellipse { semi_axes, pressed_radius, creep: 1e-4, quadrature };
        let wrench = ball.friction(&touch, 210.0, &Coulomb(0.07), sliding).unwrap();
        let parts = ball.power(&touch, &wrench);
        // The tolerance is the rounding error of a power of 15 N times 20 m/s.
        prop_assert!((parts.total() - power).abs() <= 1e-11, "{parts:?} {power}");
        let wrench = ball.friction(&touch, 210.0, &Coulomb(0.07), Sliding::Point).unwrap();
        let parts = ball.power(&touch, &wrench);
        let expected = 0.07 * 210.0 * ball.differential_slip(&touch);
        prop_assert!((parts.center - expected).abs() <= 1e-11);
        prop_assert!(parts.spin.abs() + parts.curvature.abs() <= 1e-10, "{parts:?}");
    }
}

/// Balls that rotate with the triad have no relative slip. Balls that roll on a plane slide on each
/// other at twice their rim speed.
#[test]
fn neighboring_rolling_balls_slide_at_twice_their_rim_speed() {
    let frame = BallFrame::turned(0.2, 0.0);
    let frozen = ball(Motion { precession: 91.0, omega: frame.k * 91.0 }, 0.2);
    assert!(frozen.ball_slip() < 1e-14);
    let rolling = Motion { precession: 0.0, omega: Vector3::new(5.0, 0.0, 100.0) };
    assert_relative_eq!(ball(rolling, 0.2).ball_slip(), 0.6, max_relative = 1e-14);
}

/// In contrast to the spin, the published spin slip depends on the direction of rotation and does
/// not vanish at the controlling raceway.
#[test]
fn published_spin_slip_depends_on_rotation_direction_while_calculated_spin_does_not() {
    let lead = 1e-9;
    let at = |forward| {
        let ball = rolling_ball(Control::Nut, lead, [0.7, 0.7], forward);
        let touch = ContactSite { site: Site::Nut, angle: 0.7 };
        (ball.spin_slip_published(touch.angle), ball.spin(&touch), ball.relative_to(Site::Nut))
    };
    let ((there, spin, motion), (back, other, _)) = (at(true), at(false));
    let rate = motion.omega.norm();
    // For zero lead, γ = ∓β. The slip is r_b |ω'| tanβ, multiplied by sin(π/4) for forward drive
    // and by sin(π/4 − β) for backward drive.
    let tangent = 3e-3 * rate * 0.7_f64.tan();
    assert_relative_eq!(there, (FRAC_PI_2 / 2.0).sin() * tangent, max_relative = 1e-8);
    let opposite = (FRAC_PI_2 / 2.0 - 0.7).sin() * tangent;
    assert_relative_eq!(back, opposite, max_relative = 1e-8);
    assert!(spin.abs() + other.abs() < 1e-12 * rate);
}

/// The equations of Xu and Tang reproduce the components of the angular velocity from the
/// gyroscopic angles.
#[test]
fn gyroscopic_angles_agree_with_xu_and_tang() {
    let omega = Vector3::new(310.0, -420.0, -1700.0);
    let nut = ball(Motion { precession: 0.0, omega }, 0.2).drive.nut_speed;
    let absolute = omega + BallFrame::turned(0.2, 0.0).k * nut;
    let [pitch, yaw] = ball(Motion { precession: 0.0, omega: absolute }, 0.2).gyroscopic_angles();
    let rate = omega.norm();
    // ω_t = ω_R cosβ sinβ', ω_n = −ω_R sinβ, ω_b = −ω_R cosβ cosβ'
    let paper =
        Vector3::new(pitch.cos() * yaw.sin(), -pitch.sin(), -pitch.cos() * yaw.cos()) * rate;
    assert_relative_eq!(paper, omega, max_relative = 1e-13);
}

/// If one of the two surfaces is at rest, the slide-roll ratio is 2.
#[test]
fn slide_roll_ratio_of_a_locked_ball_is_two() {
    // The ball is locked to the nut: its surface is at rest in the contact while the screw slides.
    let drive = Drive { screw_speed: 523.0, nut_speed: -71.0 };
    let frame = BallFrame::turned(0.2, 0.0);
    let frozen = Motion { precession: drive.nut_speed, omega: frame.k * drive.nut_speed };
    let ball = ball(frozen, 0.2);
    let touch = ContactSite { site: Site::Screw, angle: 0.8 };
    assert_relative_eq!(ball.slide_roll_ratio(&touch), 2.0, max_relative = 1e-13);
    let touch = ContactSite { site: Site::Nut, angle: 0.8 };
    assert!(ball.differential_slip(&touch) < 1e-14);
}
