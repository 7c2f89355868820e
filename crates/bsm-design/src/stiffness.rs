//! Axial displacement and stiffness of the ball contacts and the body of a nut.
//!
//! Assumes that all balls carry equal loads, and that the contact angles do not change under load.

use std::f64::consts::PI;

use bsm_dyn::{
    Reason,
    hertz::{Hertz, Raceway},
};

use crate::{LIMIT_LOAD, Nut, NutBody};

/// Elastic properties of one nut that do not depend on the load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elasticity {
    /// Hertzian contacts of the ball with nut and screw.
    pub hertz: [Hertz; 2],
    /// Stiffness constant `$k$` of one turn \[N/m^1.5\] (D6).
    pub turn_constant: f64,
    /// Stiffness constant `$k\,i$` of all turns \[N/m^1.5\].
    pub constant: f64,
    /// Stiffness of the nut body \[N/m\] (D8).
    pub body: f64,
}

/// Returns the stiffness of two springs in series (D21).
///
/// Source: Sobolewski (2002), eq. 11.
pub fn in_series(one: f64, other: f64) -> f64 {
    // 1/j_u = 1/j_1 + 1/j_2                                               (D21)
    (one.recip() + other.recip()).recip()
}

impl Elasticity {
    /// Returns the axial displacement \[m\] that results from the contacts of one nut under an
    /// axial force \[N\] (D7).
    ///
    /// Source: Sobolewski (2002), eqs. 4 and 7.
    pub fn displacement(&self, force: f64) -> f64 {
        // δ_a = (F/(k i))^⅔                                               (D7)
        (force / self.constant).cbrt().powi(2)
    }

    /// Returns the secant stiffness of the contacts of one nut \[N/m\] (D19), which is the force
    /// divided by the displacement.
    ///
    /// Source: Sobolewski (2002), eq. 5.
    pub fn secant(&self, force: f64) -> f64 {
        // j_sec = [F (k i)²]^⅓                                            (D19)
        (force * self.constant.powi(2)).cbrt()
    }

    /// Returns the tangent stiffness of the contacts of one nut \[N/m\] (D19), which is the
    /// derivative of the force with respect to the displacement.
    pub fn tangent(&self, force: f64) -> f64 {
        // j_tan = 3/2 j_sec                                               (D19)
        1.5 * self.secant(force)
    }

    /// Returns the contact stiffness \[N/m\] of two nuts that are clamped against each other with a
    /// preload \[N\] (D20). The stiffness is valid for loads that do not unload either nut.
    ///
    /// Source: Sobolewski (2002), eqs. 9 and 10. The displacement `$w_o$` is the load divided by
    /// this stiffness.
    pub fn preloaded(&self, preload: f64) -> f64 {
        // j_w = 3 k i √δ_w                                                (D20)
        3.0 * self.constant * self.displacement(preload).sqrt()
    }

    /// Returns the contact displacement of a preloaded nut pair under a load \[m\] (D20). Beyond
    /// the limit load (D23), one nut alone carries the load, and the result is the displacement of
    /// this nut.
    pub fn preloaded_displacement(&self, preload: f64, load: f64) -> f64 {
        if load > LIMIT_LOAD * preload {
            return self.displacement(load) - self.displacement(preload);
        }
        // w = F_m / j_w                                                   (D20)
        load / self.preloaded(preload)
    }

    /// Returns the stiffness of the preloaded contacts ([`preloaded`](Self::preloaded)) in series
    /// with the bodies of both nuts \[N/m\].
    pub fn preloaded_pair(&self, preload: f64) -> f64 {
        in_series(self.preloaded(preload), 2.0 * self.body)
    }
}

impl Nut {
    /// Returns the Hertzian contacts of the ball with nut and screw.
    ///
    /// # Errors
    ///
    /// Returns [`Reason::CurvaturesNotHertzian`] if the groove geometry does not permit an
    /// elliptical contact.
    pub fn hertz(&self) -> Result<[Hertz; 2], Reason> {
        let modulus = self.material.contact_modulus();
        let of = |member| Hertz::of(&self.curvatures(member, self.lead_angle()), modulus);
        Ok([of(Raceway::Nut)?, of(Raceway::Screw)?])
    }

    /// Returns the elastic properties of one nut (D6), (D8).
    ///
    /// ```math
    /// k = \frac{n\,(\sin\beta\cos\alpha)^{5/2}}{(\delta_n + \delta_s)^{3/2}}
    /// ```
    /// Here, `$\delta$` is the Hertzian approach at unit load. Source: ISO/DP 9783 as in Sobolewski
    /// (2002), with exact Hertzian contacts in helical grooves instead of empirical formulas.
    ///
    /// # Errors
    ///
    /// Returns [`Reason::CurvaturesNotHertzian`] if the groove geometry does not permit an
    /// elliptical contact.
    pub fn elasticity(&self, body: &NutBody) -> Result<Elasticity, Reason> {
        let hertz = self.hertz()?;
        let direction = self.contact_angle.sin() * self.lead_angle().cos();
        // k = n (sinβ cosα)^5/2 / (δ_n + δ_s)^3/2                         (D6)
        let turn_constant = self.balls_per_turn
            * (direction / (hertz[0].compliance + hertz[1].compliance)).powf(1.5)
            * direction;
        let constant = turn_constant * self.turns;
        Ok(Elasticity { hertz, turn_constant, constant, body: body.stiffness(self) })
    }
}

impl NutBody {
    /// Returns the stiffness of the nut body along the loaded turns \[N/m\] (D8).
    ///
    /// Source: Sobolewski (2002), eq. 2.
    pub fn stiffness(&self, nut: &Nut) -> f64 {
        let inner = nut.pitch_diameter + nut.ball_diameter * nut.contact_angle.cos();
        let (outer, inner) = (self.outer * self.outer, inner * inner);
        // j = 2π i P E tan²β / [(D₁² + D_t²)/(D₁² − D_t²) + 1]            (D8)
        2.0 * PI
            * nut.turns
            * nut.pitch()
            * nut.material.raceways.youngs_modulus
            * nut.contact_angle.tan().powi(2)
            / ((outer + inner) / (outer - inner) + 1.0)
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use bsm_dyn::{Conformities, Material, Materials};

    use super::*;

    const STEEL: Material = Material { youngs_modulus: 206e9, poisson_ratio: 0.3 };

    fn elasticity() -> Elasticity {
        let nut = Nut {
            ball_diameter: 10e-3,
            pitch_diameter: 63.35e-3,
            lead: 20e-3,
            contact_angle: PI / 4.0,
            conformity: Conformities::alike(0.55),
            material: Materials::alike(STEEL),
            starts: 1.0,
            balls_per_turn: 16.0,
            turns: 6.0,
        };
        nut.elasticity(&NutBody::usual(&nut, crate::NutSet::Single)).expect("ellipses")
    }

    /// Equation 5 of Sobolewski (2002) is a secant stiffness. An earlier version printed the
    /// tangent stiffness as the secant stiffness.
    #[test]
    fn secant_stiffness_and_tangent_stiffness_have_different_values() {
        let nut = elasticity();
        let load = 1e4;
        assert_relative_eq!(nut.secant(load), load / nut.displacement(load), max_relative = 1e-14);
        let step = 1.0;
        let slope = 2.0 * step / (nut.displacement(load + step) - nut.displacement(load - step));
        // The relative truncation error of the central difference is (step/load)². The relative
        // rounding error is 1e-16 times 1e4, the ratio of load to step.
        assert_relative_eq!(nut.tangent(load), slope, max_relative = 1e-8);
    }

    /// The pair stiffness (D20) is compared with an exact calculation of both nuts. The linear and
    /// the exact displacement have equal slopes at zero load. At the limit load of Sobolewski
    /// (2002), eq. 8, which is three times the preload, the linear displacement is 0.926 times the
    /// exact displacement.
    #[test]
    fn pair_stiffness_matches_two_separate_nuts() {
        let nut = elasticity();
        let preload: f64 = 15e3;
        let approach = nut.displacement(preload);
        let carried = |x: f64| nut.constant * x.max(0.0).powf(1.5);
        let load = |w: f64| carried(approach + w) - carried(approach - w);
        let small = 1e-6 * approach;
        // The first neglected term of the power series is of the order of (w/δ)².
        assert_relative_eq!(load(small) / small, nut.preloaded(preload), max_relative = 1e-9);
        let limit = 3.0 * preload;
        let linear = limit / nut.preloaded(preload);
        let exact = nut.displacement(limit) - approach;
        assert!(exact > approach, "one nut is unloaded");
        assert_relative_eq!(
            linear / exact,
            1.0 / (3.0_f64.cbrt().powi(2) - 1.0),
            max_relative = 1e-12
        );
    }
}
