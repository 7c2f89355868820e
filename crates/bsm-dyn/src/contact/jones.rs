//! Jones geometry: how the contact angles follow the ball centre and the load.
//!
//! Theory: `docs/theory/06-elastic-contact.md`, equations (J1) to (J9).

use bsm_kin::{Field, FieldOver, Scalar};
use bsm_newton::EvalError;

/// Distances from the groove-arc centres to the ball centre at first touch, and the unloaded
/// contact angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jones<D> {
    /// `$l_{A0}$` at the nut \[m\].
    pub nut_offset: D,
    /// `$l_{B0}$` at the screw \[m\].
    pub screw_offset: D,
    /// `$\beta_0$` \[rad\].
    pub contact_angle: D,
}

/// Position of the ball centre and of the nut, from the unloaded state, in the normal plane \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Displacement<D> {
    /// `$X$`: ball centre along the binormal, away from the nut's arc centre.
    pub axial: D,
    /// `$R$`: ball centre along the normal, away from the nut's arc centre.
    pub radial: D,
    /// `$\delta_a$`: displacement of the screw's arc centre from the nut's, along the binormal.
    pub nut: D,
}

/// The deformed state: mean contact angle and the displacements that go with it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeformedState<D> {
    /// `$\beta = (\beta_A + \beta_B)/2$` \[rad\].
    pub mean_angle: D,
    /// Of ball centre and nut \[m\].
    pub displacement: Displacement<D>,
}

/// One contact of the deformed state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JonesContact<D> {
    /// Contact angle \[rad\].
    pub angle: D,
    /// Elastic approach \[m\]; negative if the contact is lost.
    pub approach: D,
}

impl<D: Scalar> Jones<D> {
    /// Contact angles and approaches at nut and screw (J1) to (J5).
    ///
    /// ```math
    /// \beta_A = \mathrm{atan2}(z, r), \quad \delta_A = |(z, r)| - l_{A0}, \qquad
    /// \beta_B = \mathrm{atan2}(A_1 - z, A_2 - r), \quad \delta_B = |(A_1 - z, A_2 - r)| - l_{B0}
    /// ```
    ///
    /// Source: Jones, *A General Theory for Elastically Constrained Ball and Radial Roller
    /// Bearings*, ASME J. Basic Eng. 82 (1960), with the groove arcs of a screw and a nut.
    ///
    /// # Errors
    ///
    /// [`EvalError`] if the ball centre meets an arc centre: the contact has no direction there.
    pub fn sides(
        &self,
        at: &Displacement<D>,
    ) -> Result<(JonesContact<D>, JonesContact<D>), EvalError> {
        let (sin, cos) = self.contact_angle.sin_cos();
        // (z, r) = (l_A0 sinβ₀ + X, l_A0 cosβ₀ + R)                       (J1)
        let (z, r) = (self.nut_offset * sin + at.axial, self.nut_offset * cos + at.radial);
        // (A₁, A₂) = ((l_A0 + l_B0) sinβ₀ + δ_a, (l_A0 + l_B0) cosβ₀)     (J2)
        let both = self.nut_offset + self.screw_offset;
        let (z_b, r_b) = (both * sin + at.nut - z, both * cos - r);
        Ok((side(z, r, self.nut_offset)?, side(z_b, r_b, self.screw_offset)?))
    }

    /// The deformed state of two approaches \[m\] and a tilt `$\nu = (\beta_B - \beta_A)/2$`
    /// \[rad\] (J7), (J8): [`sides`](Self::sides) the other way round, in closed form.
    ///
    /// The loads then are unknowns themselves, and a tilt of the size of the inertia forces keeps
    /// all its digits.
    ///
    /// # Errors
    ///
    /// [`EvalError`] if no contact angles between 0 and π/2 have this tilt.
    pub fn deformed(&self, [nut, screw]: [D; 2], tilt: D) -> Result<DeformedState<D>, EvalError> {
        let both = self.nut_offset + self.screw_offset;
        let (l_a, l_b) = (self.nut_offset + nut, self.screw_offset + screw);
        let (sin, cos) = tilt.sin_cos();
        // l_A cos(β − ν) + l_B cos(β + ν) = A₂ = S cosβ + D sinβ          (J7)
        let (s, d, a_2) = ((l_a + l_b) * cos, (l_a - l_b) * sin, both * self.contact_angle.cos());
        let square = s.square() + d.square() - a_2.square();
        if square.re() <= 0.0 || s.re() <= 0.0 {
            return Err(EvalError {
                quantity: "square of the axial distance of the groove-arc centres",
                value: square.re(),
                requirement: "positive: no contact angles have this difference",
            });
        }
        // β = atan2(D, S) + acos(A₂/√(S² + D²))
        let a_1 = square.sqrt();
        let mean_angle = (a_1 * s + a_2 * d).atan2(a_2 * s - a_1 * d);
        let displacement = self.displacement([l_a, l_b], [mean_angle - tilt, mean_angle + tilt]);
        Ok(DeformedState { mean_angle, displacement })
    }

    /// Contact angle at the screw \[rad\] and displacements of two approaches \[m\] and a contact
    /// angle at the nut \[rad\] (J9), for a ball that is thrown against the nut: the angle there is
    /// small, and the difference of mean angle and tilt has lost its digits.
    ///
    /// # Errors
    ///
    /// [`EvalError`] if no contact angle at the screw goes with it.
    pub fn opposite(
        &self,
        [nut, screw]: [D; 2],
        nut_angle: D,
    ) -> Result<(D, Displacement<D>), EvalError> {
        let both = self.nut_offset + self.screw_offset;
        let (l_a, l_b) = (self.nut_offset + nut, self.screw_offset + screw);
        // cosβ_B = (A₂ − l_A cosβ_A)/l_B                                  (J9)
        let cos = (both * self.contact_angle.cos() - l_a * nut_angle.cos()) / l_b;
        let square = (-cos + 1.0) * (cos + 1.0);
        if square.re().is_nan() || square.re() <= 0.0 {
            return Err(EvalError {
                quantity: "cosine of the contact angle at the screw",
                value: cos.re(),
                requirement: "between -1 and 1: the groove arcs do not meet",
            });
        }
        let screw_angle = square.sqrt().atan2(cos);
        Ok((screw_angle, self.displacement([l_a, l_b], [nut_angle, screw_angle])))
    }

    /// Of the distances of the arc centres from the ball centre, and the contact angles.
    fn displacement(&self, [l_a, l_b]: [D; 2], [nut, screw]: [D; 2]) -> Displacement<D> {
        let (sin_0, cos_0) = self.contact_angle.sin_cos();
        let (sin_a, cos_a) = nut.sin_cos();
        Displacement {
            axial: l_a * sin_a - self.nut_offset * sin_0,
            radial: l_a * cos_a - self.nut_offset * cos_0,
            nut: axial_displacement(
                [l_a, l_b],
                [sin_a, screw.sin()],
                (self.nut_offset + self.screw_offset) * sin_0,
            ),
        }
    }
}

fn side<D: Scalar>(z: D, r: D, offset: D) -> Result<JonesContact<D>, EvalError> {
    // l = |(z, r)|                                                        (J3)
    let length = (z.square() + r.square()).sqrt();
    if length.re() > 1e-3 * offset.re() {
        // β = atan2(z, r)                                                 (J4)
        // δ = l − l₀                                                      (J5)
        Ok(JonesContact { angle: z.atan2(r), approach: length - offset })
    } else {
        Err(EvalError {
            quantity: "distance of the ball centre from a groove-arc centre [m]",
            value: length.re(),
            requirement: "at least a thousandth of the groove offset",
        })
    }
}

/// Axial displacement of the nut against the screw (J8).
///
/// * `lengths`: of the arc centres from the ball centre, at nut and screw. * `sines`: of the contact angles.
/// * `unloaded`: `$(l_{A0} + l_{B0})\sin\beta_0$`.
#[inline(always)]
pub fn axial_displacement<P: Field, D: FieldOver<P>>(
    lengths: [D; 2],
    sines: [D; 2],
    unloaded: P,
) -> D {
    // δ_a = l_A sinβ_A + l_B sinβ_B − (l_A0 + l_B0) sinβ₀                 (J8)
    lengths[0] * sines[0] + lengths[1] * sines[1] - unloaded
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use bsm_kin::Jet;
    use proptest::prelude::*;

    use super::*;

    const SCREW: Jones<f64> =
        Jones { nut_offset: 0.262e-3, screw_offset: 0.31e-3, contact_angle: 0.78 };

    #[test]
    fn the_unloaded_state_has_the_unloaded_angle() {
        let at = Displacement { axial: 0.0, radial: 0.0, nut: 0.0 };
        let (nut, screw) = SCREW.sides(&at).unwrap();
        for side in [nut, screw] {
            assert_relative_eq!(side.angle, 0.78, max_relative = 1e-15);
            assert_relative_eq!(side.approach, 0.0, epsilon = 1e-18);
        }
    }

    proptest! {
        /// Identity: the angle at the nut says as much as the tilt.
        #[test]
        fn opposite_is_deformed_by_the_angle_at_the_nut(
            nut in 0.0..1e-4_f64, screw in 0.0..1e-4_f64, tilt in -0.3..0.3_f64,
        ) {
            let deformed = SCREW.deformed([nut, screw], tilt).unwrap();
            let angle = deformed.mean_angle - tilt;
            let (opposite, displacement) = SCREW.opposite([nut, screw], angle).unwrap();
            // Rounding, larger where the angle is small and its cosine flat.
            assert_relative_eq!(opposite, deformed.mean_angle + tilt, max_relative = 1e-13);
            assert_relative_eq!(displacement.nut, deformed.displacement.nut, epsilon = 1e-16);
        }
    }

    /// Expected failure: an approach so deep that the arcs no longer meet.
    #[test]
    fn a_ball_pressed_through_its_groove_is_refused() {
        assert!(SCREW.opposite([1e-3, 0.0], 0.0).is_err());
    }

    #[test]
    fn a_ball_on_an_arc_centre_is_refused() {
        let (sin, cos) = 0.78_f64.sin_cos();
        let at = Displacement { axial: -0.262e-3 * sin, radial: -0.262e-3 * cos, nut: 0.0 };
        assert!(SCREW.sides(&at).is_err());
    }

    proptest! {
        /// The law of cosines in the triangle of the arc centres and the ball centre (J6): the
        /// corrected radical of Dong et al., Eq 17.
        #[test]
        fn the_angle_difference_follows_from_the_sides(
            axial in -1e-4..1e-4_f64, radial in -1e-4..1e-4_f64, nut in -1e-4..1e-4_f64,
        ) {
            let at = Displacement { axial, radial, nut };
            let (a, b) = SCREW.sides(&at).unwrap();
            let (l_a, l_b) = (SCREW.nut_offset + a.approach, SCREW.screw_offset + b.approach);
            let both = SCREW.nut_offset + SCREW.screw_offset;
            let square = (both * 0.78_f64.sin() + nut).powi(2) + (both * 0.78_f64.cos()).powi(2);
            // tan²(D/2) = [(l_A + l_B)² − A²] / [A² − (l_A − l_B)²]      (J6)
            let half = ((l_a + l_b).powi(2) - square) / (square - (l_a - l_b).powi(2));
            let direct = (0.5 * (b.angle - a.angle)).tan().powi(2);
            // The numerator is a difference of squares of lengths, 1e-16 of which is its rounding.
            prop_assert!((half - direct).abs() <= 1e-12 * (1.0 + direct), "{half} {direct}");
        }

        /// Identity: `sides` of the deformed state gives its approaches and tilt back.
        #[test]
        fn deformed_is_the_inverse_of_sides(
            nut in 0.0..5e-5_f64, screw in 0.0..5e-5_f64, tilt in -0.3..0.3_f64,
        ) {
            let (sin, cos) = tilt.sin_cos();
            let both = SCREW.nut_offset + SCREW.screw_offset;
            let sum = f64::hypot((both + nut + screw) * cos, (nut - screw - 0.048e-3) * sin);
            prop_assume!(sum > 1.001 * both * 0.78_f64.cos());
            let state = SCREW.deformed([nut, screw], tilt).unwrap();
            let (a, b) = SCREW.sides(&state.displacement).unwrap();
            // Rounding of lengths of 3e-4 m, and of angles times their slope of at most 50.
            prop_assert!((a.approach - nut).abs() <= 1e-17 && (b.approach - screw).abs() <= 1e-17);
            prop_assert!((0.5 * (b.angle - a.angle) - tilt).abs() <= 1e-13);
            prop_assert!((0.5 * (b.angle + a.angle) - state.mean_angle).abs() <= 1e-13);
        }

        /// Jets against central differences: the shared check of derivatives.
        #[test]
        fn derivatives_match_differences(axial in -1e-4..1e-4_f64, nut in -1e-4..1e-4_f64) {
            let lift = |x: f64| Jet::<2>::from(x);
            let jones = Jones {
                nut_offset: lift(SCREW.nut_offset),
                screw_offset: lift(SCREW.screw_offset),
                contact_angle: lift(SCREW.contact_angle),
            };
            let at = Displacement {
                axial: Jet::variable(axial, 0),
                radial: lift(3e-5),
                nut: Jet::variable(nut, 1),
            };
            let (_, exact) = jones.sides(&at).unwrap();
            let value = |axial, nut| {
                SCREW.sides(&Displacement { axial, radial: 3e-5, nut }).unwrap().1
            };
            // Truncation (h/l)² of 1e-8, relative to slopes of 1/l and 1.
            let h = 3e-8;
            let angle = (value(axial + h, nut).angle - value(axial - h, nut).angle) / (2.0 * h);
            let approach = (value(axial, nut + h).approach - value(axial, nut - h).approach) / (2.0 * h);
            prop_assert!((angle - exact.angle.eps[0]).abs() <= 1e-6 / SCREW.screw_offset);
            prop_assert!((approach - exact.approach.eps[1]).abs() <= 1e-6);
        }
    }
}
