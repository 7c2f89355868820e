//! Jones geometry: contact angles as functions of the loads and the position of the ball center.
//!
//! Theory: `docs/theory/06-elastic-contact.md`, equations (J1) to (J9).

use bsm_kin::{Real, RealOver, Scalar};
use bsm_newton::EvalError;

/// Distances between groove arc centers and ball center at first contact, and unloaded contact
/// angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Jones<D> {
    /// Distance `$l_{A0}$` between the arc center of the nut groove and the ball center \[m\].
    pub nut_offset: D,
    /// Distance `$l_{B0}$` between the arc center of the screw groove and the ball center \[m\].
    pub screw_offset: D,
    /// Unloaded contact angle `$\beta_0$` \[rad\].
    pub contact_angle: D,
}

impl<D: Scalar> Jones<D> {
    /// Returns the mean contact angle `$\beta = (\beta_A + \beta_B)/2$` \[rad\] and the axial
    /// displacement of the nut \[m\] for two approaches \[m\] and a tilt
    /// `$\nu = (\beta_B - \beta_A)/2$` \[rad\] (J7), (J8).
    /// The function is the closed-form inverse of (J1) to (J5). With this inverse, the loads can
    /// serve as unknowns, and a small tilt due to the inertia forces keeps all its significant
    /// digits.
    ///
    /// Source: Jones, *A General Theory for Elastically Constrained Ball and Radial Roller
    /// Bearings*, ASME J. Basic Eng. 82 (1960), applied to the groove arcs of a screw and a nut.
    ///
    /// # Errors
    /// Returns [`EvalError`] if no contact angles between 0 and π/2 have the given tilt.
    pub(crate) fn deformed(&self, [nut, screw]: [D; 2], tilt: D) -> Result<(D, D), EvalError> {
        let both = self.nut_offset + self.screw_offset;
        let (l_a, l_b) = (self.nut_offset + nut, self.screw_offset + screw);
        let (sin, cos) = tilt.sin_cos();
        // l_A cos(β − ν) + l_B cos(β + ν) = A₂ = S cosβ + D sinβ          (J7)
        let (s, d, a_2) = ((l_a + l_b) * cos, (l_a - l_b) * sin, both * self.contact_angle.cos());
        let square = s.square() + d.square() - a_2.square();
        if square.re().is_nan() || square.re() <= 0.0 {
            return Err(EvalError {
                quantity: "square of the axial distance between the groove arc centers",
                value: square.re(),
                requirement: "must be positive; otherwise no contact angles have the given difference",
            });
        }
        if s.re() <= 0.0 {
            return Err(EvalError {
                quantity: "sum of the distances between ball center and groove arc centers, times the cosine of the tilt",
                value: s.re(),
                requirement: "must be positive; otherwise no contact angles between 0 and 90 degrees have the given difference",
            });
        }
        // β = atan2(D, S) + acos(A₂/√(S² + D²))
        let a_1 = square.sqrt();
        let mean_angle = (a_1 * s + a_2 * d).atan2(a_2 * s - a_1 * d);
        let displacement = self.displacement([l_a, l_b], [mean_angle - tilt, mean_angle + tilt]);
        Ok((mean_angle, displacement))
    }

    /// Returns the contact angle at the screw \[rad\] and the axial displacement of the nut \[m\]
    /// for two approaches \[m\] and a contact angle at the nut \[rad\] (J9). This function is used
    /// under high centrifugal loads. The contact angle at the nut is then small, and calculating it
    /// as mean angle minus tilt would lose significant digits.
    ///
    /// # Errors
    ///
    /// Returns [`EvalError`] if no contact angle at the screw corresponds to the contact angle at
    /// the nut.
    pub(crate) fn screw_angle(
        &self,
        [nut, screw]: [D; 2],
        nut_angle: D,
    ) -> Result<(D, D), EvalError> {
        let both = self.nut_offset + self.screw_offset;
        let (l_a, l_b) = (self.nut_offset + nut, self.screw_offset + screw);
        // cosβ_B = (A₂ − l_A cosβ_A)/l_B                                  (J9)
        let cos = (both * self.contact_angle.cos() - l_a * nut_angle.cos()) / l_b;
        let square = (-cos + 1.0) * (cos + 1.0);
        if square.re().is_nan() || square.re() <= 0.0 {
            return Err(EvalError {
                quantity: "cosine of the contact angle at the screw",
                value: cos.re(),
                requirement: "must be between -1 and 1; otherwise the ball cannot touch both grooves",
            });
        }
        let screw_angle = square.sqrt().atan2(cos);
        Ok((screw_angle, self.displacement([l_a, l_b], [nut_angle, screw_angle])))
    }

    /// Returns the axial displacement of the nut, calculated from the contact angles and from the
    /// distances between arc centers and ball center.
    fn displacement(&self, lengths: [D; 2], [nut, screw]: [D; 2]) -> D {
        let unloaded = (self.nut_offset + self.screw_offset) * self.contact_angle.sin();
        binormal_displacement(lengths, [nut.sin(), screw.sin()], unloaded)
    }
}

/// Returns the displacement of the nut relative to the screw along the binormal (J8).
///
/// * `lengths`: distances between arc centers and ball center, at nut and screw.
/// * `sines`: sines of the contact angles.
/// * `unloaded`: distance between the arc centers along the binormal at first contact, `$(l_{A0} +
///   l_{B0})\sin\beta_0$`.
#[inline(always)]
pub(crate) fn binormal_displacement<P: Real, D: RealOver<P>>(
    lengths: [D; 2],
    sines: [D; 2],
    unloaded: P,
) -> D {
    // δ_b = l_A sinβ_A + l_B sinβ_B − (l_A0 + l_B0) sinβ₀                 (J8)
    lengths[0] * sines[0] + lengths[1] * sines[1] - unloaded
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use approx::assert_relative_eq;
    use proptest::prelude::*;

    use super::*;

    const SCREW: Jones<f64> =
        Jones { nut_offset: 0.262e-3, screw_offset: 0.31e-3, contact_angle: 0.78 };

    /// Returns the contact angles and approaches at nut and screw. The arguments are the
    /// displacement of the ball center along binormal and principal normal \[m\], and the
    /// displacement of the nut along the binormal \[m\].
    fn contact_angles_and_approaches([axial, radial]: [f64; 2], nut: f64) -> ([f64; 2], [f64; 2]) {
        let (sin, cos) = SCREW.contact_angle.sin_cos();
        // (z, r) = (l_A0 sinβ₀ + X, l_A0 cosβ₀ + R)                       (J1)
        let (z, r) = (SCREW.nut_offset * sin + axial, SCREW.nut_offset * cos + radial);
        // (A₁, A₂) = ((l_A0 + l_B0) sinβ₀ + δ_b, (l_A0 + l_B0) cosβ₀)     (J2)
        let both = SCREW.nut_offset + SCREW.screw_offset;
        let center = [(z, r), (both * sin + nut - z, both * cos - r)];
        // l = |(z, r)|                                                    (J3)
        let [l_a, l_b] = center.map(|(z, r)| z.hypot(r));
        // β = atan2(z, r)                                                 (J4)
        // δ = l − l₀                                                      (J5)
        let approaches = [l_a - SCREW.nut_offset, l_b - SCREW.screw_offset];
        (center.map(|(z, r)| z.atan2(r)), approaches)
    }

    /// Without load and displacement, both contacts have the unloaded contact angle and zero
    /// approach.
    #[test]
    fn contacts_without_load_have_the_unloaded_contact_angle() {
        let (mean, nut) = SCREW.deformed([0.0; 2], 0.0).unwrap();
        assert_relative_eq!(mean, 0.78, max_relative = 1e-15);
        assert_relative_eq!(nut, 0.0, epsilon = 1e-18);
    }

    proptest! {
        /// The contact angle at the screw does not depend on whether it is calculated from the
        /// contact angle at the nut or from the tilt.
        #[test]
        fn screw_angle_from_nut_angle_agrees_with_screw_angle_from_tilt(
            nut in 0.0..1e-4_f64, screw in 0.0..1e-4_f64, tilt in -0.3..0.3_f64,
        ) {
            let (mean, displacement) = SCREW.deformed([nut, screw], tilt).unwrap();
            let (opposite, same) = SCREW.screw_angle([nut, screw], mean - tilt).unwrap();
            // The tolerance exceeds the usual rounding errors, because the cosine of a small angle
            // hardly depends on the angle, so the angle is calculated inaccurately.
            assert_relative_eq!(opposite, mean + tilt, max_relative = 1e-13);
            assert_relative_eq!(same, displacement, epsilon = 1e-16);
        }
    }

    /// For a tilt of 180 degrees, the square of the axial distance is positive, but the projected
    /// sum of the distances is negative. The error states the negative number.
    #[test]
    fn error_of_an_impossible_tilt_states_the_number_that_is_not_positive() {
        let error = SCREW.deformed([0.0; 2], PI).expect_err("the tilt is too large");
        assert!(error.value < 0.0, "{error:?}");
        let error = SCREW.deformed([-1e-3; 2], 1.0).expect_err("the grooves do not reach the ball");
        assert!(error.value < 0.0, "{error:?}");
    }

    #[test]
    fn undefined_approaches_and_tilts_are_rejected() {
        for (approaches, tilt) in [([f64::NAN, 0.0], 0.1), ([0.0; 2], f64::NAN)] {
            assert!(SCREW.deformed(approaches, tilt).is_err());
        }
    }

    /// No contact angle at the screw corresponds to the given contact angle at the nut, so the
    /// calculation returns an error.
    #[test]
    fn nut_contact_angle_for_which_no_screw_contact_angle_exists_is_rejected() {
        assert!(SCREW.screw_angle([1e-3, 0.0], 0.0).is_err());
    }

    proptest! {
        /// The closed-form formula for the difference between the contact angles agrees with the
        /// directly calculated difference.
        #[test]
        fn closed_form_angle_difference_agrees_with_direct_calculation(
            axial in -1e-4..1e-4_f64, radial in -1e-4..1e-4_f64, nut in -1e-4..1e-4_f64,
        ) {
            let ([a, b], approaches) = contact_angles_and_approaches([axial, radial], nut);
            let (l_a, l_b) = (SCREW.nut_offset + approaches[0], SCREW.screw_offset + approaches[1]);
            let both = SCREW.nut_offset + SCREW.screw_offset;
            let square = (both * 0.78_f64.sin() + nut).powi(2) + (both * 0.78_f64.cos()).powi(2);
            // tan²(D/2) = [(l_A + l_B)² − A²] / [A² − (l_A − l_B)²]      (J6)
            let half = ((l_a + l_b).powi(2) - square) / (square - (l_a - l_b).powi(2));
            let direct = (0.5 * (b - a)).tan().powi(2);
            // The numerator is a difference of squared lengths, so its rounding error is 1e-16
            // times these squares.
            prop_assert!((half - direct).abs() <= 1e-12 * (1.0 + direct), "{half} {direct}");
        }

        /// Approaches and contact angles from the closed form agree with the values calculated from
        /// the position of the ball center between the groove arcs.
        #[test]
        fn closed_form_contact_angles_and_approaches_agree_with_the_ball_position_in_the_grooves(
            nut in 0.0..5e-5_f64, screw in 0.0..5e-5_f64, tilt in -0.3..0.3_f64,
        ) {
            let (sin, cos) = tilt.sin_cos();
            let both = SCREW.nut_offset + SCREW.screw_offset;
            let sum = f64::hypot((both + nut + screw) * cos, (nut - screw - 0.048e-3) * sin);
            prop_assume!(sum > 1.001 * both * 0.78_f64.cos());
            let (mean, displacement) = SCREW.deformed([nut, screw], tilt).unwrap();
            let ((sin, cos), (sin_0, cos_0)) = ((mean - tilt).sin_cos(), 0.78_f64.sin_cos());
            let center = [(sin, sin_0), (cos, cos_0)]
                .map(|(is, was)| (SCREW.nut_offset + nut) * is - SCREW.nut_offset * was);
            let ([a, b], approaches) = contact_angles_and_approaches(center, displacement);
            // The tolerance allows for rounding errors of lengths of 3e-4 m, and for rounding
            // errors of angles multiplied by a slope of at most 50.
            prop_assert!((approaches[0] - nut).abs() <= 1e-17 && (approaches[1] - screw).abs() <= 1e-17);
            prop_assert!((0.5 * (b - a) - tilt).abs() <= 1e-13);
            prop_assert!((0.5 * (b + a) - mean).abs() <= 1e-13);
        }
    }
}
