//! Elliptical Hertz contact between the ball and a helical groove.
//!
//! Theory: `docs/theory/06-elastic-contact.md`, equations (H1) to (H12).

use std::f64::consts::PI;

use bsm_kin::{Over, Scalar};
use ellip::ellipke;

use crate::Reason;

/// Elastic constants of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material<D = f64> {
    /// Young's modulus \[Pa\], positive.
    pub youngs_modulus: D,
    /// Poisson's ratio, in (-1, 1/2).
    pub poisson_ratio: D,
}

/// Contact modulus `$E^*$` of two bodies \[Pa\] (H1).
pub fn contact_modulus<D: Scalar>(one: &Material<D>, other: &Material<D>) -> D {
    // 1/E* = (1−ν₁²)/E₁ + (1−ν₂²)/E₂                                      (H1)
    let compliance = |m: &Material<D>| (-m.poisson_ratio.square() + 1.0) / m.youngs_modulus;
    (compliance(one) + compliance(other)).recip()
}

/// The groove that the ball touches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Groove<D = f64> {
    /// Which side of the ball centres its arc centres lie on.
    pub member: Member,
    /// Groove radius over ball diameter `$f_g > 1/2$`.
    pub conformity: D,
}

/// The member that has a groove.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Member {
    /// The nut, around the balls.
    Nut,
    /// The screw, inside them.
    Screw,
}

/// Relative curvatures of a contact \[1/m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curvatures<D = f64> {
    /// Along the track `$\rho_t$`.
    pub along: D,
    /// Across the groove `$\rho_x$`.
    pub across: D,
}

impl Curvatures {
    /// Permanent approach that a load leaves \[m\] (H12), to be added to the elastic one.
    ///
    /// * `load`: `$Q$` \[N\]; `ball_radius`: `$r_b$` \[m\].
    ///
    /// Source: Dong et al. (2020), an empirical fit for hardened bearing steel in millimetres.
    pub fn permanent_approach(&self, load: f64, ball_radius: f64) -> f64 {
        // δ_p [mm] = 1.3·10⁻⁷ ρ_t ρ_x Q² / (2 r_b), lengths in mm          (H12)
        1.3e-19 * self.along * self.across * load * load / (2.0 * ball_radius)
    }
}

impl<D: Scalar> Groove<D> {
    /// Distance from the groove's arc centre to the ball centre at first touch
    /// `$(f_g - \tfrac12)\,2 r_b$` \[m\] (H2).
    pub fn offset(&self, ball_radius: D) -> D {
        // l₀ = (f_g − 1/2) 2 r_b                                          (H2)
        (self.conformity * 2.0 - 1.0) * ball_radius
    }

    /// Curvatures of ball and groove relative to each other at the unloaded contact (H3) to (H6).
    ///
    /// The groove is the surface that a circle of radius `$2 f_g r_b$` sweeps along the helix of
    /// its centre.
    ///
    /// * `pitch_radius`, `ball_radius`: `$r_m$`, `$r_b$` \[m\]; `lead_angle`, `contact_angle`:
    ///   `$\alpha$`, `$\beta_0$` \[rad\].
    ///
    /// Difference from bearing formulas: those take the helix as a circle, and overstate its
    /// curvature by `$1/\cos^2\alpha$`.
    pub fn curvatures(
        &self,
        pitch_radius: D,
        ball_radius: D,
        lead_angle: D,
        contact_angle: D,
    ) -> Curvatures<D> {
        let side = match self.member {
            Member::Nut => 1.0,
            Member::Screw => -1.0,
        };
        let (cos_b, advance) = (contact_angle.cos(), pitch_radius * lead_angle.tan());
        // r_c = r_m ∓ l₀ cosβ₀                                            (H3)
        let centre_radius = pitch_radius - self.offset(ball_radius) * side * cos_b;
        // ρ_c = r_c / (r_c² + h²)                                         (H4)
        let curvature = centre_radius / (centre_radius.square() + advance.square());
        let groove_radius = self.conformity * 2.0 * ball_radius;
        Curvatures {
            // ρ_t = 1/r_b ∓ ρ_c cosβ₀ / (1 ± r_g ρ_c cosβ₀)               (H5)
            along: ball_radius.recip()
                - curvature * side * cos_b / (groove_radius * side * curvature * cos_b + 1.0),
            // ρ_x = 1/r_b − 1/r_g                                         (H6)
            across: ball_radius.recip() - groove_radius.recip(),
        }
    }
}

/// Elliptical Hertz contact: everything that does not depend on the load.
///
/// Source: Johnson, *Contact Mechanics*, §4.2, with complete elliptic integrals, no fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hertz<D = f64> {
    /// Ratio of the semi-axes `$\kappa = a/b \ge 1$`, the long one across the groove.
    pub ratio: D,
    /// Semi-axis across the groove over the cube root of the load \[m/N^(1/3)\].
    pub semi_axis: D,
    /// Stiffness `$K_H$` of `$Q = K_H\,\delta^{3/2}$` \[N/m^1.5\].
    pub stiffness: D,
    /// Complete elliptic integral of the second kind `$E(m)$`, `$m = 1 - 1/\kappa^2$`.
    pub second_integral: D,
}

impl<D: Scalar> Hertz<D> {
    /// Contact of these curvatures and contact modulus \[Pa\] (H7) to (H9).
    ///
    /// ```math
    /// \frac{\rho_t}{\rho_x} = \frac{\kappa^2 E - K}{K - E}, \qquad
    /// a = \Big(\frac{3\kappa^2 E\,Q}{\pi S E^*}\Big)^{1/3}, \qquad
    /// \delta = \frac{3 Q K}{2\pi a E^*}
    /// ```
    ///
    /// # Errors
    ///
    /// [`Reason::CurvaturesNotHertzian`] unless `$\rho_t \ge \rho_x > 0$`: the ellipse would lie
    /// along the groove, or the bodies would fit without a gap.
    pub fn of(curvatures: &Curvatures<D>, modulus: D) -> Result<Self, Reason> {
        let Curvatures { along, across } = *curvatures;
        let target = along / across;
        if !(across.re() > 0.0 && target.re() >= 1.0 && target.re().is_finite()) {
            let (along, across) = (along.re(), across.re());
            return Err(Reason::CurvaturesNotHertzian { along, across });
        }
        let Axes { ratio, k, e } = Axes::of(target);
        let sum = along + across;
        // a = (3 κ² E Q / (π S E*))^{1/3}                                 (H8)
        let semi_axis = (ratio.square() * 3.0 * e / (sum * PI * modulus)).cbrt();
        // δ = 3 Q K / (2 π a E*) = c Q^{2/3},  K_H = c^{−3/2}             (H9)
        let compliance = k * 3.0 / (semi_axis * (2.0 * PI) * modulus);
        Ok(Self { ratio, semi_axis, stiffness: compliance.powf(-1.5), second_integral: e })
    }

    /// Elastic approach under the load `load` \[N\], in m (H9).
    pub fn approach<L: Over<D>>(&self, load: L) -> L {
        // δ = (Q/K_H)^⅔                                                   (H9)
        (load / L::from(self.stiffness)).cbrt().square()
    }

    /// Semi-axes across and along the groove under the load `load` \[N\], in m.
    pub fn semi_axes(&self, load: D) -> (D, D) {
        let a = self.semi_axis * load.cbrt();
        (a, a / self.ratio)
    }
}

impl Hertz {
    /// Largest pressure under the load `load` \[N\], in Pa (H10).
    pub fn max_pressure(&self, load: f64) -> f64 {
        // p_max = 3 Q / (2 π a b)                                         (H10)
        let (a, b) = self.semi_axes(load);
        if load > 0.0 { 1.5 * load / (PI * a * b) } else { 0.0 }
    }
}

/// A root of (H7): `$\kappa$`, `$K(m)$` and `$E(m)$`.
struct Axes<D> {
    ratio: D,
    k: D,
    e: D,
}

/// The relation (H7) at a `$\kappa$`.
struct Relation {
    /// The integrals, and their derivatives by `$\kappa$`.
    k: f64,
    e: f64,
    dk: f64,
    de: f64,
    /// Logarithm of the ratio of curvatures, and its derivative by that of `$\kappa$`.
    log: f64,
    slope: f64,
}

impl Relation {
    fn at(kappa: f64) -> Self {
        let (m, rest) = (1.0 - kappa.powi(-2), kappa.powi(-2));
        let (k, e) = ellipke(m).unwrap_or((f64::NAN, f64::NAN));
        let dm = 2.0 * kappa.powi(-3);
        if m < CIRCLE {
            // Close to a circle the relation is ln(ρ_t/ρ_x) = (3/2) ln κ, and cancels to nothing.
            let (dk, de) = (0.125 * PI * dm, -0.125 * PI * dm);
            return Self { k, e, dk, de, log: 1.5 * kappa.ln(), slope: 1.5 };
        }
        // ρ_t/ρ_x = (κ² E − K) / (K − E)                                  (H7)
        let (above, below) = (kappa.powi(2) * e - k, k - e);
        // dK/dm = (E − (1−m) K) / (2m(1−m)),  dE/dm = (E − K)/(2m)        (H11)
        let dk = (e - rest * k) / (2.0 * m * rest) * dm;
        let de = (e - k) / (2.0 * m) * dm;
        let slope = (2.0 * kappa * e + kappa.powi(2) * de - dk) / above - (dk - de) / below;
        Self { k, e, dk, de, log: (above / below).ln(), slope: kappa * slope }
    }
}

/// Below this parameter `$m$` an ellipse is a circle to the rounding of (H7).
const CIRCLE: f64 = 1e-6;

impl<D: Scalar> Axes<D> {
    /// Solves (H7) for `$\kappa$`.
    ///
    /// Newton on the logarithms, in which the relation is nearly a straight line: three or four
    /// steps from the known power law to rounding. The derivatives are those of the implicit function.
    fn of(target: D) -> Self {
        let wanted = target.re().ln();
        // Start: Brewe and Hamrock's fit κ ≈ (ρ_t/ρ_x)^0.636; a circle has κ = 1 exactly.
        let mut log = 0.636 * wanted;
        for _ in 0..30 {
            let Relation { log: found, slope, .. } = Relation::at(log.exp());
            let step = (found - wanted) / slope;
            log -= step;
            // A step leaves an error of about its square.
            if step.abs() < 1e-8 {
                break;
            }
        }
        let kappa = log.exp();
        let Relation { k, e, dk, de, slope, .. } = Relation::at(kappa);
        // dκ = κ dt / (s t): to first order exact in any scalar           (V4)
        let moved = (target - D::from(target.re())) * (kappa / (slope * target.re()));
        let along = |value: f64, slope: f64| moved * slope + value;
        Self { ratio: along(kappa, 1.0), k: along(k, dk), e: along(e, de) }
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use bsm_kin::Jet;
    use proptest::prelude::*;

    use super::*;

    const STEEL: Material = Material { youngs_modulus: 207e9, poisson_ratio: 0.3 };

    fn lin(member: Member) -> Hertz {
        let groove = Groove { member, conformity: 0.53 };
        let angle = f64::to_radians;
        let curvatures = groove.curvatures(24.3e-3, 4.37e-3, angle(10.0), angle(45.0));
        Hertz::of(&curvatures, contact_modulus(&STEEL, &STEEL)).unwrap()
    }

    /// Lin's screw with conformities of 0.53: independent values, eight to eleven digits.
    #[test]
    fn lin_screw_has_the_reference_constants() {
        let nut = lin(Member::Nut);
        assert_relative_eq!(nut.ratio, 5.972_732_4, max_relative = 1e-8);
        assert_relative_eq!(nut.semi_axis, 1.127_830_59e-4, max_relative = 1e-8);
        // Listed as 1.88829920e-5, which differs from its own a/κ by 2e-8.
        assert_relative_eq!(nut.semi_axes(1.0).1, 1.888_299_23e-5, max_relative = 1e-8);
        assert_relative_eq!(nut.stiffness, 2.445_283_496_7e10, max_relative = 1e-10);
        let screw = lin(Member::Screw);
        assert_relative_eq!(screw.ratio, 6.961_155_4, max_relative = 1e-8);
        assert_relative_eq!(screw.semi_axis, 1.151_921_66e-4, max_relative = 1e-8);
        assert_relative_eq!(screw.semi_axes(1.0).1, 1.654_785_16e-5, max_relative = 1e-8);
        assert_relative_eq!(screw.stiffness, 2.356_080_636_3e10, max_relative = 1e-10);
    }

    /// By hand in millimetres: ρ_t = 0.25, ρ_x = 0.02, 3 kN on a ball of 8 mm give
    /// 1.3e-7 × 0.25 × 0.02 × 9e6 / 8 = 7.3125e-4 mm.
    #[test]
    fn permanent_approach_is_that_of_the_fit() {
        let curvatures = Curvatures { along: 250.0, across: 20.0 };
        let approach = curvatures.permanent_approach(3e3, 4e-3);
        assert_relative_eq!(approach, 7.3125e-7, max_relative = 1e-12);
    }

    /// Limit: a sphere on a plane, in closed form: a³ = 3QR/(4E*), δ = a²/R.
    #[test]
    fn circular_contact_is_the_sphere() {
        let radius = 5e-3_f64;
        let curvatures = Curvatures { along: radius.recip(), across: radius.recip() };
        let hertz = Hertz::of(&curvatures, 1.1e11).unwrap();
        let a = (3.0 * radius / (4.0 * 1.1e11)).cbrt();
        assert_relative_eq!(hertz.ratio, 1.0, max_relative = 1e-15);
        assert_relative_eq!(hertz.semi_axis, a, max_relative = 1e-14);
        let approach = hertz.stiffness.powf(-2.0 / 3.0);
        assert_relative_eq!(approach, a * a / radius, max_relative = 1e-14);
        // On the circle itself (3/2) d ln κ = d ln ρ_t, in which the integrals are smooth.
        let jets = Curvatures {
            along: Jet::variable(radius.recip(), 0),
            across: Jet::<1>::from(radius.recip()),
        };
        let moved = Hertz::of(&jets, Jet::from(1.1e11)).unwrap();
        assert_relative_eq!(moved.ratio.eps[0], 2.0 / 3.0 * radius, max_relative = 1e-14);
        // Continuous where the special case of the circle ends, κ = 1 + 5e-7.
        let near = |x: f64| Curvatures { along: (1.0 + x) / radius, across: radius.recip() };
        let [below, above] = [7.0e-7, 8.0e-7].map(|x| Hertz::of(&near(x), 1.1e11).unwrap());
        assert_relative_eq!(above.ratio - below.ratio, 2.0 / 3.0 * 1e-7, max_relative = 1e-2);
    }

    /// Limit: at zero lead angle the curvatures are those of a bearing.
    #[test]
    fn zero_lead_is_a_bearing() {
        let (r_m, r_b, beta) = (24.3e-3, 4.37e-3, 0.8_f64);
        let gamma = r_b * beta.cos() / r_m;
        for (member, sign) in [(Member::Nut, 1.0), (Member::Screw, -1.0)] {
            let c = Groove { member, conformity: 0.52 }.curvatures(r_m, r_b, 0.0, beta);
            let bearing = 1.0 / r_b - sign * (gamma / r_b) / (1.0 + sign * gamma);
            assert_relative_eq!(c.along, bearing, max_relative = 1e-14);
        }
    }

    #[test]
    fn what_is_not_hertzian_is_refused() {
        for (along, across) in [(1.0, 2.0), (1.0, 0.0), (1.0, -1.0), (f64::NAN, 1.0)] {
            let refused = Hertz::of(&Curvatures { along, across }, 1e11);
            assert!(matches!(refused, Err(Reason::CurvaturesNotHertzian { .. })), "{refused:?}");
        }
    }

    proptest! {
        /// Derivatives by the curvature along the track and the modulus, against differences.
        #[test]
        fn derivatives_match_differences(log_ratio in 1e-3..9.0_f64) {
            let (across, modulus) = (13.0, 1.1e11);
            let along = across * log_ratio.exp();
            let jets = Curvatures { along: Jet::variable(along, 0), across: Jet::from(across) };
            let exact = Hertz::of(&jets, Jet::<2>::variable(modulus, 1)).unwrap();
            let at = |a: f64, e: f64| {
                Hertz::of(&Curvatures { along: along * a, across }, modulus * e).unwrap()
            };
            // Truncation h²; rounding of (H7), 1e-16 over the distance from the circle, over h.
            let h = 1e-4;
            let tol = 1e-6 + 1e-11 / log_ratio;
            let read: [fn(&Hertz) -> f64; 4] =
                [|x| x.ratio, |x| x.semi_axis, |x| x.stiffness, |x| x.second_integral];
            let jets = [exact.ratio, exact.semi_axis, exact.stiffness, exact.second_integral];
            for (read, jet) in read.into_iter().zip(jets) {
                let scale = 2.0 * h * jet.re;
                let by_curvature = (read(&at(1.0 + h, 1.0)) - read(&at(1.0 - h, 1.0))) / scale;
                let by_modulus = (read(&at(1.0, 1.0 + h)) - read(&at(1.0, 1.0 - h))) / scale;
                prop_assert!((by_curvature - jet.eps[0] * along / jet.re).abs() <= tol);
                prop_assert!((by_modulus - jet.eps[1] * modulus / jet.re).abs() <= tol);
            }
        }

        /// The relation of the curvatures holds, and load, approach and pressure scale as they must.
        #[test]
        fn the_ellipse_satisfies_its_equation(log_ratio in 0.01..9.0_f64, load in 1e-3..1e6_f64) {
            let across = 13.0;
            let along = across * log_ratio.exp();
            let hertz = Hertz::of(&Curvatures { along, across }, 1.1e11).unwrap();
            let (k, e) = ellipke(1.0 - hertz.ratio.powi(-2)).unwrap();
            let relation = (hertz.ratio.powi(2) * e - k) / (k - e);
            // κ² E − K and K − E cancel near the circle.
            prop_assert!((relation.ln() - log_ratio).abs() <= 1e-11 / log_ratio.min(1.0));
            let (a, b) = hertz.semi_axes(8.0 * load);
            prop_assert!((a / hertz.semi_axes(load).0 - 2.0).abs() <= 1e-14);
            prop_assert!((a / b / hertz.ratio - 1.0).abs() <= 1e-14);
            let mean = load / (PI * hertz.semi_axes(load).0 * hertz.semi_axes(load).1);
            prop_assert!((hertz.max_pressure(load) / mean - 1.5).abs() <= 1e-13);
        }
    }
}
