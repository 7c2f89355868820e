//! A ball at rest without friction, for a given displacement of the nut groove relative to the
//! screw groove.
//!
//! Theory: `docs/theory/06-elastic-contact.md`, equations (J10) to (J14).

use bsm_kin::Scalar;
use bsm_newton::{Bracket, EvalError};

use crate::models::ball::{ElasticPoint, Reason};

/// A ball at rest between one flank of the nut and one flank of the screw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StaticBall<D = f64> {
    /// Distance `$l_{A0} + l_{B0}$` between the groove arc centers at first contact \[m\].
    pub distance: D,
    /// Sine and cosine of the unloaded contact angle `$\beta_0$`.
    pub unloaded: [D; 2],
    /// Hertz stiffness `$K$` of both contacts in series \[N/m^1.5\].
    pub stiffness: D,
}

/// Load, energy and forces of a ball between displaced grooves. Arrays with two elements contain
/// the components along the binormal and along the principal normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GrooveForces<D = f64> {
    /// Normal load at both contacts \[N\]; zero if the ball has clearance.
    pub load: D,
    /// Contact angle at both contacts \[rad\]; zero if the ball has clearance.
    pub angle: D,
    /// Elastic energy `$V$` \[J\].
    pub energy: D,
    /// Force that maintains the displacement, `$\partial V/\partial w$` \[N\]. The force acts on
    /// the groove of the nut.
    pub force: [D; 2],
    /// Stiffness, which is the derivative of the force with respect to the displacement,
    /// `$\partial^2 V/\partial w^2$` \[N/m\].
    pub slope: [[D; 2]; 2],
}

impl<D: Scalar> ElasticPoint<D> {
    /// Returns the ball at rest between the grooves at this operating point.
    ///
    /// # Errors
    ///
    /// Returns [`Reason::CurvaturesNotHertzian`] if a contact ellipse is not longer across the
    /// groove than along it.
    pub fn pressed_ball(&self) -> Result<StaticBall<D>, Reason> {
        let [nut, screw] = self.hertz()?.map(|hertz| hertz.compliance);
        let [l_a, l_b] = self.grooves().map(|groove| groove.offset(self.point.ball.radius));
        // K^(−2/3) = K_A^(−2/3) + K_B^(−2/3)                              (J11)
        let stiffness = (nut + screw).powf(-1.5);
        let (sin, cos) = self.point.contact_angle.sin_cos();
        Ok(StaticBall { distance: l_a + l_b, unloaded: [sin, cos], stiffness })
    }
}

impl<D: Scalar> StaticBall<D> {
    /// Returns the load, the energy and the forces for a displacement of the nut groove relative to
    /// the screw groove (J10) to (J13).
    ///
    /// The elastic energy is a convex function of the displacement.
    ///
    /// * `displacement`: components along the binormal and along the principal normal \[m\].
    /// * `oversize`: excess of the ball radius over the nominal radius \[m\].
    ///
    /// Assumes: no inertia, and no contact at the far flanks of gothic arches.
    pub fn forces_at(&self, [along_b, along_n]: [D; 2], oversize: D) -> GrooveForces<D> {
        let [sin, cos] = self.unloaded;
        let (l, zero) = (self.distance, D::from(0.0));
        // G = (l_A0 + l_B0)(sinβ₀, cosβ₀) + w                             (J10)
        let (g_b, g_n) = (l * sin + along_b, l * cos + along_n);
        let length = (g_b.square() + g_n.square()).sqrt();
        // |G| − (l_A0 + l_B0) + 2 Δr, without cancellation                (J10)
        let moved = (sin * along_b + cos * along_n) * l * 2.0 + along_b.square() + along_n.square();
        let approach = moved / (length + l) + oversize * 2.0;
        if approach.re() <= 0.0 {
            let (force, slope) = ([zero; 2], [[zero; 2]; 2]);
            return GrooveForces { load: zero, angle: zero, energy: zero, force, slope };
        }
        let root = approach.sqrt();
        // Q = K (|G| − L)^(3/2),  V = ⅖ K (|G| − L)^(5/2)                 (J11)
        let load = self.stiffness * approach * root;
        let energy = load * approach * 0.4;
        // ∂V/∂w = Q m,  m = G/|G|                                         (J12)
        let m = [g_b / length, g_n / length];
        let force = m.map(|m| load * m);
        // ∂²V/∂w² = 3/2 K √(|G| − L) m mᵀ + (Q/|G|)(1 − m mᵀ)             (J13)
        let (along, turning) = (self.stiffness * root * 1.5, load / length);
        let entry = |i: usize, k: usize| {
            let both = m[i] * m[k];
            let unit = if i == k { 1.0 } else { 0.0 };
            along * both + turning * (-both + unit)
        };
        let slope = [[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]];
        GrooveForces { load, angle: g_b.atan2(g_n), energy, force, slope }
    }
}

impl StaticBall {
    /// Returns the displacement of the nut along the screw axis \[m\] and the forces under an axial
    /// load (J14), for a nut whose balls share the load equally.
    ///
    /// * `axial`: axial load per ball \[N\].
    /// * `lead_angle`: lead angle \[rad\].
    ///
    /// # Errors
    ///
    /// Returns [`EvalError`] if the ball cannot carry the load at any displacement.
    pub fn under_axial_load(
        &self,
        axial: f64,
        lead_angle: f64,
    ) -> Result<(f64, GrooveForces), EvalError> {
        let domain_error = EvalError {
            quantity: "axial load of a ball [N]",
            value: axial,
            requirement: "must be positive and small enough for the groove flanks to carry it",
        };
        if axial.is_nan() || axial <= 0.0 {
            return Err(domain_error);
        }
        let cos_a = lead_angle.cos();
        let at = |u: f64| self.forces_at([u * cos_a, 0.0], 0.0);
        // The displacement at which the ball would carry the load at the unloaded contact angle is
        // an upper limit.
        let max_displacement =
            (axial / self.stiffness).cbrt().powi(2) / (self.unloaded[0] * cos_a).powf(5.0 / 3.0);
        let signs = [f64::NEG_INFINITY, f64::INFINITY];
        // After a Newton step of 1e-9, the relative error is of the order of the square of the
        // step.
        let bracket = Bracket {
            start: Some(max_displacement),
            x_tol: 1e-9,
            ..Bracket::new([0.0, 2.0 * max_displacement], signs)
        };
        let found = bracket.root(|u| {
            let ball = at(u);
            // F_a = Q m_b cosα, w = (u cosα, 0); F_a^(2/3) is nearly linear in u      (J14)
            let force = ball.force[0] * cos_a;
            let excess = 1.5 * force * (1.0 - (axial / force).cbrt().powi(2));
            (excess, ball.slope[0][0] * cos_a * cos_a)
        });
        found.root().map(|root| (root.x, at(root.x))).ok_or(domain_error)
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use bsm_kin::Jet;
    use proptest::prelude::*;

    use super::*;
    use crate::extreme::nut_operating_point;
    use crate::model::{RacewayControl, RacewayWorkspace};

    fn screw(axial: f64, speed: f64) -> ElasticPoint {
        nut_operating_point(axial, 98.0, speed)
    }

    /// The reference values are stated with all digits of an independent solution, for a nut with
    /// 98 equally loaded balls under 6340 N (case P01).
    #[test]
    fn displacement_and_load_of_an_equally_loaded_ball_match_the_reference() {
        let screw = screw(6340.0, 1.0);
        let ball = screw.pressed_ball().unwrap();
        let (u, pressing) =
            ball.under_axial_load(6340.0 / 98.0, screw.point.helix.lead_angle).unwrap();
        assert_relative_eq!(u, 6.937_390_322_458_6e-6, max_relative = 1e-9);
        assert_relative_eq!(pressing.load, 90.100_228_3, max_relative = 1e-9);
        let cos_a = screw.point.helix.lead_angle.cos();
        let along = 98.0 * pressing.slope[0][0] * cos_a * cos_a;
        assert_relative_eq!(along, 1.399_319_430_252_6e9, max_relative = 1e-9);
    }

    /// In the limit of low speed, a rolling ball has the same loads and contact angles as a ball at
    /// rest.
    #[test]
    fn static_ball_agrees_with_raceway_control_at_low_speed() {
        for axial in [10.0, 6340.0, 90e3] {
            let screw = screw(axial, 1e-4);
            let solved = RacewayControl { screw, control: None }
                .solve(&mut RacewayWorkspace::default())
                .result
                .expect("a slow ball");
            let ball = screw.pressed_ball().unwrap();
            let lead = screw.point.helix.lead_angle;
            let (u, pressing) = ball.under_axial_load(screw.point.load.per_ball(), lead).unwrap();
            // The static balance of the rolling ball is solved to a residual of 1e-13.
            let nut = solved.ball.nut;
            assert_relative_eq!(pressing.angle, nut.angle, max_relative = 1e-12);
            assert_relative_eq!(pressing.load, nut.load.unwrap(), max_relative = 1e-12);
            let displacement = solved.ball.axial_displacement.unwrap();
            assert_relative_eq!(u, displacement, max_relative = 1e-10);
        }
    }

    #[test]
    fn ball_with_clearance_carries_no_load_and_tensile_ball_load_is_rejected() {
        let ball = screw(6340.0, 1.0).pressed_ball().unwrap();
        let loose = ball.forces_at([-1e-6, -1e-6], 0.0);
        assert_eq!((loose.load, loose.energy, loose.force), (0.0, 0.0, [0.0; 2]));
        // If the radius of the ball is 1 µm larger, the ball has no gap and carries a load.
        assert!(ball.forces_at([-1e-6, -1e-6], 1e-6).load > 0.0);
        assert!(ball.under_axial_load(-1.0, 0.1).is_err());
    }

    proptest! {
        /// The reference derivatives are calculated with jets.
        #[test]
        fn force_and_stiffness_are_derivatives_of_the_energy(
            along_b in -1e-5..5e-5_f64, along_n in -1e-5..5e-5_f64, oversize in 0.0..5e-6_f64,
        ) {
            let ball = screw(6340.0, 1.0).pressed_ball().unwrap();
            let exact = ball.forces_at([along_b, along_n], oversize);
            prop_assume!(exact.load > 0.0);
            let lift = |x: f64| Jet::<2>::from(x);
            let jets = StaticBall {
                distance: lift(ball.distance),
                unloaded: ball.unloaded.map(lift),
                stiffness: lift(ball.stiffness),
            };
            let w = [Jet::variable(along_b, 0), Jet::variable(along_n, 1)];
            let moved = jets.forces_at(w, lift(oversize));
            let size = exact.force[0].hypot(exact.force[1]);
            let stiff = exact.slope[0][0] + exact.slope[1][1];
            for i in 0..2 {
                // Both calculations perform the same operations and differ only by rounding errors.
                prop_assert!((moved.energy.eps[i] - exact.force[i]).abs() <= 1e-12 * size);
                for k in 0..2 {
                    let error = moved.force[i].eps[k] - exact.slope[i][k];
                    prop_assert!(error.abs() <= 1e-11 * stiff, "{error}");
                }
            }
            // The energy is convex, so the stiffness matrix is positive semidefinite.
            let [[a, b], [_, c]] = exact.slope;
            prop_assert!(a > 0.0 && a * c - b * b >= -1e-12 * a * c);
        }
    }
}
