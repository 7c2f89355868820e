//! Loads and contact angles of a ball after a small permanent deformation. The elastic and
//! permanent approaches change the distances between the groove arc centers.
//!
//! Theory: `docs/theory/14-jamming.md`, equations (M1) to (M4).

use std::f64::consts::FRAC_PI_2;

use bsm_kin::Scalar;
use bsm_newton::{Convergence, EvalError, Options, Scales, solve};

use crate::contact::{Curvatures, Hertz};
use crate::models::ball::{ElasticPoint, Reason, SolveFailure, Workspace, domain_error, equations};

/// Loads and contact angles that include permanent deformation. Arrays with two elements contain
/// the values at the nut and the screw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PermanentSet {
    /// Normal loads \[N\].
    pub loads: [f64; 2],
    /// Contact angles \[rad\].
    pub angles: [f64; 2],
    /// Elastic approaches (H9) \[m\].
    pub elastic: [f64; 2],
    /// Permanent approaches (H12) \[m\].
    pub permanent: [f64; 2],
}

/// Ratio of maximum pressure to yield strength (dimensionless) at which steel first yields below
/// the surface (M4). The ratio is 1.60 for a circular contact and up to 1.79 for an elongated
/// contact.
///
/// Source: Johnson, *Contact Mechanics*, §6.2, Poisson's ratio 0.3.
const FIRST_YIELD: f64 = 1.60;

impl ElasticPoint {
    /// Calculates the loads and contact angles that result if the permanent approach (H12) is added
    /// to the elastic approach; see (M1) to (M3).
    ///
    /// * `loads`, `angles`: normal loads \[N\] and contact angles \[rad\] at the nut and the screw,
    ///   from a model without permanent deformation.
    ///
    /// Assumes: friction and inertia forces on the ball remain unchanged.
    ///
    /// # Errors
    ///
    /// Returns [`Reason::CurvaturesNotHertzian`] if a contact ellipse is not longer across the
    /// groove than along it, [`Reason::Newton`] if Newton's method fails, [`Reason::Refused`] if a
    /// contact is lost, and [`Reason::BallLeavesFlank`] if a contact angle is beyond its flank.
    pub fn permanent_set(
        &self,
        loads: [f64; 2],
        angles: [f64; 2],
    ) -> Result<PermanentSet, SolveFailure> {
        let invalid = SolveFailure::invalid;
        let hertz = self.hertz().map_err(invalid)?;
        let curvatures = self.curvatures();
        let [nut_offset, screw_offset] = self.grooves().map(|g| g.offset(self.point.ball.radius));
        // Q sinβ = S and Q_A cosβ_A − Q_B cosβ_B = C remain unchanged     (M1)
        let axial = [0, 1].map(|i| loads[i] * angles[i].sin());
        let radial = loads[0] * angles[0].cos() - loads[1] * angles[1].cos();
        let closure = RadialClosure {
            axial,
            radial,
            offsets: [nut_offset, screw_offset],
            radial_distance: (nut_offset + screw_offset) * self.point.contact_angle.cos(),
            ball_radius: self.point.ball.radius,
            hertz,
            curvatures,
        };
        let mut x = [angles[1].tan().recip()];
        let scales = Scales { x: &[1.0], f: &[1.0] };
        let convergence = Convergence { residual_goal: 1e-14, ..Convergence::default() };
        let options = Options { convergence, ..Options::default() };
        let report = solve(&closure, &mut x, &scales, &options, &mut Workspace::default()).report;
        if !report.converged() {
            return Err(SolveFailure::not_converged(Reason::from(report)));
        }
        let (loads, cotangents) = closure.forces(x[0]).map_err(domain_error)?;
        let [nut, screw] = cotangents.map(|c| FRAC_PI_2 - c.atan());
        if ![nut, screw].iter().all(|angle| (0.0..FRAC_PI_2).contains(angle)) {
            return Err(SolveFailure::not_converged(Reason::BallLeavesFlank { nut, screw }));
        }
        let [elastic, permanent] = closure.approaches(loads);
        Ok(PermanentSet { loads, angles: [nut, screw], elastic, permanent })
    }
}

/// Number of unknowns of [`RadialClosure`].
const CLOSURE_UNKNOWNS: usize = 1;

/// Radial closure condition for the triangle that is formed by the ball center and the two arc
/// centers. The unknown is the cotangent of the contact angle at the screw.
struct RadialClosure {
    axial: [f64; 2],
    radial: f64,
    offsets: [f64; 2],
    radial_distance: f64,
    ball_radius: f64,
    hertz: [Hertz; 2],
    curvatures: [Curvatures; 2],
}

impl RadialClosure {
    /// Returns the normal loads \[N\] and the cotangents of the contact angles at the nut and the
    /// screw.
    ///
    /// # Errors
    ///
    /// Returns [`EvalError`] if a contact is lost.
    fn forces<D: Scalar>(&self, screw: D) -> Result<([D; 2], [D; 2]), EvalError> {
        let [s_a, s_b] = self.axial;
        let nut = (screw * s_b + self.radial) * s_a.recip();
        let cotangents = [nut, screw];
        let load = |i: usize| (cotangents[i].square() + 1.0).sqrt() * self.axial[i];
        let loads = [load(0), load(1)];
        let least = loads[0].re().min(loads[1].re());
        if least > 0.0 && least.is_finite() {
            return Ok((loads, cotangents));
        }
        Err(EvalError {
            quantity: "normal load of a contact [N]",
            value: least,
            requirement: "must be positive; otherwise the contact is lost",
        })
    }

    /// Returns the elastic and the permanent approaches at the nut and the screw \[m\].
    fn approaches<D: Scalar>(&self, loads: [D; 2]) -> [[D; 2]; 2] {
        let elastic = |i: usize| self.hertz[i].approach(loads[i]);
        let unit = |i: usize| self.curvatures[i].permanent_approach(1.0, self.ball_radius);
        let permanent = |i: usize| loads[i].square() * unit(i);
        [[elastic(0), elastic(1)], [permanent(0), permanent(1)]]
    }

    fn residual<D: Scalar>(
        &self,
        &[screw]: &[D; CLOSURE_UNKNOWNS],
    ) -> Result<[D; CLOSURE_UNKNOWNS], EvalError> {
        let (loads, cotangents) = self.forces(screw)?;
        let [elastic, permanent] = self.approaches(loads);
        let part = |i: usize| {
            // l = l₀ + δ + δ_p                                            (M2)
            let length = elastic[i] + permanent[i] + self.offsets[i];
            length * cotangents[i] * (cotangents[i].square() + 1.0).sqrt().recip()
        };
        // l_A cosβ_A + l_B cosβ_B = (l_A0 + l_B0) cosβ₀                   (M3)
        Ok([(part(0) + part(1)) * self.radial_distance.recip() - 1.0])
    }
}

equations!(
    RadialClosure,
    CLOSURE_UNKNOWNS,
    RadialClosure::residual,
    ["radial closure of the groove arcs"]
);

/// Returns the ratio of the maximum pressure to the pressure at which the softer of the two bodies
/// first yields (M4).
///
/// * `max_pressure`: maximum pressure `$p_{max}$`.
/// * `strengths`: yield strengths of both bodies, in the unit of `max_pressure`.
pub fn yield_ratio(max_pressure: f64, strengths: (f64, f64)) -> f64 {
    // p_max / (1.60 min(σ₁, σ₂))                                          (M4)
    max_pressure / (FIRST_YIELD * strengths.0.min(strengths.1))
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use bsm_kin::{Drive, Helix, Site};

    use super::*;
    use crate::{
        Ball, Conformities, Coulomb, Load, Material, Materials, OperatingPoint, Solution,
        model::{RacewayControl, RacewayWorkspace, Traction},
    };

    /// Returns the screw of Dong et al. (2020) with 44 balls at 2500 rpm.
    fn screw_of_dong(axial: f64) -> ElasticPoint {
        let raceways = Material { youngs_modulus: 200e9, poisson_ratio: 0.3 };
        let balls = Material { youngs_modulus: 207e9, poisson_ratio: 0.3 };
        ElasticPoint {
            point: OperatingPoint {
                helix: Helix { radius: 8e-3, lead_angle: 6.807_f64.to_radians() },
                contact_angle: 45.0_f64.to_radians(),
                ball: Ball::of_density(1.75e-3, 7800.0),
                friction: Coulomb(0.1),
                drive: Drive { screw_speed: 262.0, nut_speed: 0.0 },
                load: Load { axial, balls: 44.0 },
            },
            conformity: Conformities::alike(0.535),
            material: Materials { raceways, ball: balls },
        }
    }

    fn loads_and_angles(solution: &Solution) -> ([f64; 2], [f64; 2]) {
        let ball = solution.steady_state().expect("converged").ball;
        let contacts = [ball.nut, ball.screw];
        (contacts.map(|c| c.load.expect("a load")), contacts.map(|c| c.angle))
    }

    /// Under a light load, the permanent approach is negligible. The test covers models with and
    /// without friction in the force balance.
    #[test]
    fn permanent_deformation_under_a_light_load_is_negligible() {
        let screw = screw_of_dong(44.0);
        let raceway = RacewayControl { screw, control: None };
        let traction = Traction { screw, accuracy: Traction::ACCURACY, creep: Traction::CREEP };
        for o in [
            raceway.solve(&mut RacewayWorkspace::default()),
            traction.solve(&mut crate::model::TractionWorkspace::default()),
        ] {
            let (loads, angles) = loads_and_angles(&o);
            let deformed = screw.permanent_set(loads, angles).unwrap();
            // In this test, the permanent approach is 1e-5 times the elastic approach and 1e-8
            // times the distance between the arc centers, which determines the contact angles.
            for i in 0..2 {
                assert!(deformed.permanent[i] < 2e-5 * deformed.elastic[i], "{deformed:?}");
                assert_relative_eq!(deformed.loads[i], loads[i], max_relative = 1e-7);
                assert_relative_eq!(deformed.angles[i], angles[i], max_relative = 1e-7);
            }
            assert_relative_eq!(
                deformed.elastic[0],
                o.contact(Site::Nut).unwrap().pressed.unwrap().approach,
                max_relative = 1e-7
            );
        }
    }

    #[test]
    fn permanent_deformation_increases_contact_angles_and_preserves_the_force_balance() {
        let screw = screw_of_dong(24e3);
        let raceway = RacewayControl { screw, control: None };
        let (loads, angles) = loads_and_angles(&raceway.solve(&mut RacewayWorkspace::default()));
        let deformed = screw.permanent_set(loads, angles).unwrap();
        for i in 0..2 {
            assert!(deformed.angles[i] > angles[i] + 1e-3, "{deformed:?}");
            let axial = deformed.loads[i] * deformed.angles[i].sin();
            assert_relative_eq!(axial, loads[i] * angles[i].sin(), max_relative = 1e-13);
        }
        let radial = |q: [f64; 2], b: [f64; 2]| q[0] * b[0].cos() - q[1] * b[1].cos();
        // Each load is about 700 N and has a rounding error of about 1e-13 N.
        let change = radial(deformed.loads, deformed.angles) - radial(loads, angles);
        assert!(change.abs() < 1e-11, "{change}");
    }

    /// Equation 17 of Dong et al. (2020), with the corrected radical (J6), holds for a ball whose
    /// contact angles differ by half a degree due to inertia.
    #[test]
    fn eq_17_of_dong_with_corrected_radical_gives_the_contact_angle_difference() {
        let screw = screw_of_dong(44.0);
        let raceway = RacewayControl { screw, control: None };
        let (loads, angles) = loads_and_angles(&raceway.solve(&mut RacewayWorkspace::default()));
        let deformed = screw.permanent_set(loads, angles).unwrap();
        let [nut, screw_offset] = screw.grooves().map(|g| g.offset(screw.point.ball.radius));
        let length = |i: usize, l: f64| l + deformed.elastic[i] + deformed.permanent[i];
        let (l_a, l_b) = (length(0, nut), length(1, screw_offset));
        let [(sin_a, cos_a), (sin_b, cos_b)] = deformed.angles.map(f64::sin_cos);
        let square = (l_a * sin_a + l_b * sin_b).powi(2) + (l_a * cos_a + l_b * cos_b).powi(2);
        let radical = ((l_a + l_b).powi(2) - square) / (square - (l_a - l_b).powi(2));
        let difference = deformed.angles[1] - deformed.angles[0];
        assert!(difference > 8e-3, "{difference}");
        assert_relative_eq!(2.0 * radical.sqrt().atan(), difference, epsilon = 1e-12);
        // The radial components of the distances from the ball center to the two arc centers add up
        // to the radial distance between the arc centers, which follows from the unloaded contact
        // angle.
        let radial_distance = (nut + screw_offset) * screw.point.contact_angle.cos();
        assert_relative_eq!(l_a * cos_a + l_b * cos_b, radial_distance, max_relative = 1e-14);
    }

    #[test]
    fn yield_ratio_refers_to_the_softer_body() {
        assert_relative_eq!(yield_ratio(3.2e9, (1e9, 2e9)), 2.0, max_relative = 1e-15);
    }
}
