//! Tests of slip velocities: published components, rigid-body identities, and invariance under
//! rotations.

use approx::assert_relative_eq;
use bsm_kin::{BallFrame, Contact, Drive, Helix, Motion, Site};
use nalgebra::Vector3;
use proptest::prelude::*;

const SITES: [Site; 3] = [Site::Nut, Site::NutUnloaded, Site::Screw];

fn body_speed(site: Site, drive: &Drive<f64>) -> f64 {
    if site == Site::Screw { drive.screw_speed } else { drive.nut_speed }
}

/// Returns the components of the slip velocity at a contact, across and along the groove.
fn slip_components(
    site: Site,
    beta: f64,
    helix: &Helix<f64>,
    ball_radius: f64,
    drive: &Drive<f64>,
    motion: &Motion<f64>,
) -> (f64, f64) {
    let frame = BallFrame::turned(helix.lead_angle, 0.0);
    let contact = Contact::new(site, beta, &frame);
    let v = motion
        .relative_to(body_speed(site, drive), &frame)
        .slip_velocity(helix.arc_length_per_radian(), &contact.point(ball_radius));
    (v.dot(&contact.transverse), v.dot(&BallFrame::tangent()))
}

/// The expected components are Equations 7 and 8 of Lin et al. for a nut at rest.
#[test]
fn slip_matches_the_published_components() {
    let (alpha, beta, r_m, r_b) = (0.1745_f64, 0.81_f64, 24.3e-3, 4.37e-3);
    let helix = Helix { radius: r_m, lead_angle: alpha };
    let drive = Drive { screw_speed: 209.4, nut_speed: 0.0 };
    let (rate, wt, wn, wb) = (-118.0, 37.0, -411.0, 93.0);
    // Lin et al. write the precession rate as theta_dot + Omega.
    let motion = Motion { precession: rate + drive.screw_speed, omega: Vector3::new(wt, wn, wb) };
    let d = r_m / alpha.cos();
    let omega = drive.screw_speed;

    let (x, y) = slip_components(Site::Nut, beta, &helix, r_b, &drive, &motion);
    assert_relative_eq!(x, -r_b * wt, max_relative = 1e-13);
    let expected = d * (rate + omega) + r_b * (wb * beta.cos() - wn * beta.sin());
    assert_relative_eq!(y, expected, max_relative = 1e-13);

    let (x, y) = slip_components(Site::Screw, beta, &helix, r_b, &drive, &motion);
    assert_relative_eq!(x, r_b * (wt - omega * alpha.sin()), max_relative = 1e-13);
    let expected = d * rate - r_b * ((wb - omega * alpha.cos()) * beta.cos() - wn * beta.sin());
    assert_relative_eq!(y, expected, max_relative = 1e-12);
}

/// A ball that moves rigidly with a body does not slip on this body.
#[test]
fn a_ball_fixed_to_a_body_does_not_slip_on_it() {
    let helix = Helix { radius: 20e-3, lead_angle: 0.2 };
    let frame = BallFrame::turned(0.2, 0.0);
    let drive = Drive { screw_speed: 17.0, nut_speed: -5.0 };
    for site in SITES {
        let speed = body_speed(site, &drive);
        let frozen = Motion { precession: speed, omega: frame.k * speed };
        let (x, y) = slip_components(site, 0.7, &helix, 3e-3, &drive, &frozen);
        assert_relative_eq!(x, 0.0, epsilon = 1e-16);
        assert_relative_eq!(y, 0.0, epsilon = 1e-16);
    }
}

proptest! {
    /// The slip does not depend on the rotation of the triad, and it does not change if the angular
    /// speeds of ball, nut and screw all increase by the same amount.
    #[test]
    fn slip_does_not_depend_on_the_axes_or_on_a_common_rotation(
        alpha in 0.02..1.2_f64, beta in 0.1..1.4_f64, rotation_angle in -2.0..2.0_f64,
        p in -300.0..300.0_f64, wt in -900.0..900.0_f64, wn in -900.0..900.0_f64,
        wb in -900.0..900.0_f64, together in -500.0..500.0_f64,
    ) {
        let helix = Helix { radius: 24.3e-3, lead_angle: alpha };
        let d = helix.arc_length_per_radian();
        let straight = BallFrame::turned(alpha, 0.0);
        let turned = BallFrame::turned(alpha, rotation_angle);
        let (s, c) = rotation_angle.sin_cos();
        let drive = Drive { screw_speed: 211.0, nut_speed: -37.0 };
        let omega = Vector3::new(wt, wn, wb);
        let motion = Motion { precession: p, omega };
        // The angular velocity is converted into components of the rotated triad.
        let in_turned = Motion { precession: p, omega: Vector3::new(wt, c * wn + s * wb, c * wb - s * wn) };
        // The angular speeds of ball, nut and screw all increase by the same amount.
        let shifted = Motion { precession: p + together, omega: omega + straight.k * together };

        for site in SITES {
            let speed = body_speed(site, &drive);
            let contact = Contact::new(site, beta, &straight);
            let relative = motion.relative_to(speed, &straight);
            let v = relative.slip_velocity(d, &contact.point(4.37e-3));
            let scale = 1.0 + v.norm() + 24.3e-3 * p.abs();

            let turned_contact = Contact::new(site, beta, &turned);
            let v_turned = in_turned.relative_to(speed, &turned)
                .slip_velocity(d, &turned_contact.point(4.37e-3));
            prop_assert!((turned.to_frenet(&v_turned) - v).norm() <= 1e-13 * scale);
            let spin = in_turned.relative_to(speed, &turned).spin(&turned_contact);
            prop_assert!((spin - relative.spin(&contact)).abs() <= 1e-12 * (1.0 + omega.norm()));

            let v_shifted = shifted.relative_to(speed + together, &straight)
                .slip_velocity(d, &contact.point(4.37e-3));
            prop_assert!((v_shifted - v).norm() <= 1e-12 * scale);

            // The slip velocity is tangential at the contact, because the contact normal N is
            // perpendicular to the tangent t of the helix.
            prop_assert!(v.dot(&contact.normal).abs() <= 1e-13 * scale);
        }
    }
}
