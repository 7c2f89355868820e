//! Elliptical Hertz contact between the ball and a helical groove.
//!
//! Theory: `docs/theory/06-elastic-contact.md`, equations (H1) to (H12).

use std::array::from_fn;
use std::f64::consts::PI;

use bsm_kin::{Over, Real, Scalar};
use bsm_simd::{Arch, BLOCK, Lane, Simd, WithSimd};

use crate::outcome::Reason;

/// Elastic constants of the material of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material<D = f64> {
    /// Young's modulus \[Pa\], positive.
    pub youngs_modulus: D,
    /// Poisson's ratio, in (-1, 1/2).
    pub poisson_ratio: D,
}

/// Returns the contact modulus `$E^*$` of two bodies \[Pa\] (H1).
#[inline(always)]
pub fn contact_modulus<D: Real>(one: &Material<D>, other: &Material<D>) -> D {
    // 1/E* = (1−ν₁²)/E₁ + (1−ν₂²)/E₂                                      (H1)
    (one.compliance() + other.compliance()).recip()
}

/// Elastic constants of the raceways and of the balls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Materials<D = f64> {
    /// Material of the raceways on nut and screw.
    pub raceways: Material<D>,
    /// Material of the balls.
    pub ball: Material<D>,
}

impl<D: Real> Materials<D> {
    /// Returns the materials of a ball screw whose raceways and balls are made of the same steel.
    pub const fn alike(steel: Material<D>) -> Self {
        Self { raceways: steel, ball: steel }
    }

    /// Returns the contact modulus `$E^*$` of raceway and ball \[Pa\] (H1).
    #[inline(always)]
    pub fn contact_modulus(&self) -> D {
        contact_modulus(&self.raceways, &self.ball)
    }
}

/// Conformities of the nut and the screw: ratios of groove radius to ball diameter
/// (dimensionless), above 1/2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conformities<D = f64> {
    /// Conformity of the nut.
    pub nut: D,
    /// Conformity of the screw.
    pub screw: D,
}

impl<D: Copy> Conformities<D> {
    /// Returns the conformities of a nut and a screw with equal groove radii.
    pub const fn alike(conformity: D) -> Self {
        Self { nut: conformity, screw: conformity }
    }
}

impl<D: Real> Conformities<D> {
    /// Returns the sum of both conformities, which is the sum of the groove radii divided by the
    /// ball diameter.
    #[inline(always)]
    pub fn sum(&self) -> D {
        self.nut + self.screw
    }
}

impl<D: Real> Material<D> {
    /// Returns the compliance `$(1-\nu^2)/E$` \[1/Pa\].
    #[inline(always)]
    fn compliance(&self) -> D {
        (-self.poisson_ratio.square() + 1.0) / self.youngs_modulus
    }
}

/// A groove of the nut or the screw in which the ball runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Groove<D = f64> {
    /// Body that contains the groove.
    pub member: Raceway,
    /// Groove radius divided by ball diameter `$f_g > 1/2$`.
    pub conformity: D,
}

/// The body that contains a groove.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Raceway {
    /// The nut, whose groove is outside the balls.
    Nut,
    /// The screw, whose groove is inside the balls.
    Screw,
}

/// Relative curvatures of ball and groove at a contact \[1/m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curvatures<D = f64> {
    /// Relative curvature along the track `$\rho_t$`.
    pub longitudinal: D,
    /// Relative curvature across the groove `$\rho_x$`.
    pub transverse: D,
}

impl<D: Real> Curvatures<D> {
    /// Returns both curvatures multiplied by a factor.
    #[inline(always)]
    #[must_use]
    pub fn times(self, factor: D) -> Self {
        Self { longitudinal: self.longitudinal * factor, transverse: self.transverse * factor }
    }
}

impl Curvatures {
    /// Returns the permanent approach \[m\] that remains after a load is removed (H12). Under load,
    /// it is added to the elastic approach.
    ///
    /// * `load`: normal load `$Q$` \[N\].
    /// * `ball_radius`: ball radius `$r_b$` \[m\].
    ///
    /// Source: Dong et al. (2020), an empirical formula for hardened bearing steel with lengths in
    /// millimeters.
    pub fn permanent_approach(&self, load: f64, ball_radius: f64) -> f64 {
        // δ_p [mm] = 1.3·10⁻⁷ ρ_t ρ_x Q² / (2 r_b), lengths in mm          (H12)
        1.3e-19 * self.longitudinal * self.transverse * load * load / (2.0 * ball_radius)
    }
}

impl<D: Real> Groove<D> {
    /// Returns the distance from the groove's arc center to the ball center at first contact,
    /// `$(f_g - \tfrac12)\,2 r_b$` \[m\] (H2).
    #[inline(always)]
    pub fn offset(&self, ball_radius: D) -> D {
        // l₀ = (f_g − 1/2) 2 r_b                                          (H2)
        (self.conformity * 2.0 - 1.0) * ball_radius
    }

    /// Returns the relative curvatures of ball and groove at first contact (H3) to (H6). Unlike
    /// [`Self::curvatures`], this function takes the tangent of the lead angle and the cosine of
    /// the contact angle instead of the angles.
    #[inline(always)]
    pub fn curvatures_at(
        &self,
        pitch_radius: D,
        ball_radius: D,
        tan_lead: D,
        cos_contact: D,
    ) -> Curvatures<D> {
        let side = match self.member {
            Raceway::Nut => 1.0,
            Raceway::Screw => -1.0,
        };
        let advance = pitch_radius * tan_lead;
        // r_c = r_m ∓ l₀ cosβ₀                                            (H3)
        let center_radius = pitch_radius - self.offset(ball_radius) * side * cos_contact;
        // ρ_c = r_c / (r_c² + h²)                                         (H4)
        let curvature = center_radius / (center_radius.square() + advance.square());
        let bent = curvature * side * cos_contact;
        let groove_radius = self.conformity * 2.0 * ball_radius;
        Curvatures {
            // ρ_t = 1/r_b ∓ ρ_c cosβ₀ / (1 ± r_g ρ_c cosβ₀)               (H5)
            longitudinal: ball_radius.recip() - bent / (groove_radius * bent + 1.0),
            // ρ_x = 1/r_b − 1/r_g                                         (H6)
            transverse: ball_radius.recip() - groove_radius.recip(),
        }
    }
}

impl<D: Scalar> Groove<D> {
    /// Returns the relative curvatures of ball and groove at first contact (H3) to (H6).
    ///
    /// The groove is the surface that a circle of radius `$2 f_g r_b$` sweeps when its center moves
    /// along a helix.
    ///
    /// * `pitch_radius`, `ball_radius`: pitch circle radius `$r_m$` and ball radius `$r_b$` \[m\].
    /// * `lead_angle`, `contact_angle`: lead angle `$\alpha$` and unloaded contact angle
    ///   `$\beta_0$` \[rad\].
    ///
    /// Difference from bearing formulas: the helix is not treated as a circle, which would
    /// overestimate its curvature by the factor `$1/\cos^2\alpha$`.
    pub fn curvatures(
        &self,
        pitch_radius: D,
        ball_radius: D,
        lead_angle: D,
        contact_angle: D,
    ) -> Curvatures<D> {
        self.curvatures_at(pitch_radius, ball_radius, lead_angle.tan(), contact_angle.cos())
    }
}

/// Quantities of an elliptical Hertz contact that do not depend on the load.
///
/// Source: Johnson, *Contact Mechanics*, §4.2, with complete elliptic integrals instead of
/// empirical formulas.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hertz<D = f64> {
    /// Ratio of the semi-axes `$1/\kappa = b/a \le 1$`. The longer semi-axis is across the groove.
    pub flatness: D,
    /// Semi-axis across the groove, divided by the cube root of the load \[m/N^(1/3)\].
    pub semi_axis: D,
    /// Approach under unit load: the factor `$c$` in `$\delta = c\,Q^{2/3}$` \[m/N^(2/3)\].
    pub compliance: D,
    /// Complete elliptic integral of the second kind `$E(m)$`, `$m = 1 - 1/\kappa^2$`.
    pub second_integral: D,
}

impl<D: Real> Hertz<D> {
    /// Creates the contact for a given shape of the ellipse, given curvatures and a given contact
    /// modulus \[Pa\] (H8), (H9).
    #[inline(always)]
    pub fn with_axes(axes: &Axes<D>, curvatures: &Curvatures<D>, modulus: D) -> Self {
        let Axes { flatness, k, e } = *axes;
        let sum = curvatures.longitudinal + curvatures.transverse;
        // a = (3 κ² E Q / (π S E*))^{1/3}                                 (H8)
        let semi_axis = (e * 3.0 / (flatness.square() * sum * modulus * PI)).cbrt();
        // δ = 3 Q K / (2 π a E*) = c Q^{2/3}                              (H9)
        let compliance = k * 3.0 / (semi_axis * modulus * (2.0 * PI));
        Self { flatness, semi_axis, compliance, second_integral: e }
    }
}

impl<D: Scalar> Hertz<D> {
    /// Creates the contact from the curvatures and the contact modulus \[Pa\] (H7) to (H9).
    ///
    /// ```math
    /// \frac{\rho_t}{\rho_x} = \frac{\kappa^2 E - K}{K - E}, \qquad
    /// a = \Big(\frac{3\kappa^2 E\,Q}{\pi S E^*}\Big)^{1/3}, \qquad
    /// \delta = \frac{3 Q K}{2\pi a E^*}
    /// ```
    ///
    /// # Errors
    ///
    /// Returns [`Reason::CurvaturesNotHertzian`] unless `$\rho_t \ge \rho_x > 0$`. Otherwise, the
    /// ellipse would be longer along the groove than across it, or the surfaces would conform
    /// without a gap.
    pub fn of(curvatures: &Curvatures<D>, modulus: D) -> Result<Self, Reason> {
        let [hertz] = Self::side_by_side(&[*curvatures], modulus)?;
        Ok(hertz)
    }

    /// Creates several contacts side by side, in about the time that a single contact takes.
    ///
    /// # Errors
    ///
    /// Returns the error of [`Self::of`] for the first contact that cannot be created.
    pub fn side_by_side<const N: usize>(
        curvatures: &[Curvatures<D>; N],
        modulus: D,
    ) -> Result<[Self; N], Reason> {
        let targets = curvatures.map(|of| of.longitudinal / of.transverse);
        for (&Curvatures { longitudinal, transverse }, target) in curvatures.iter().zip(targets) {
            if !(transverse.re() > 0.0 && target.re() >= 1.0 && target.re().is_finite()) {
                let (longitudinal, transverse) = (longitudinal.re(), transverse.re());
                return Err(Reason::CurvaturesNotHertzian { longitudinal, transverse });
            }
        }
        let axes = Axes::of(targets);
        Ok(from_fn(|i| Self::with_axes(&axes[i], &curvatures[i], modulus)))
    }

    /// Returns the elastic approach \[m\] under the load `load` \[N\] (H9).
    pub fn approach<L: Over<D>>(&self, load: L) -> L {
        // δ = c Q^{2/3}                                                   (H9)
        load.cbrt().square() * self.compliance
    }

    /// Returns the semi-axes across and along the groove \[m\] under the load `load` \[N\].
    pub fn semi_axes(&self, load: D) -> (D, D) {
        let a = self.semi_axis * load.cbrt();
        (a, a * self.flatness)
    }

    /// Returns the stiffness `$K_H$` in `$Q = K_H\,\delta^{3/2}$` \[N/m^1.5\] (H9).
    pub fn stiffness(&self) -> D {
        // K_H = c^{−3/2}                                                  (H9)
        self.compliance.powf(-1.5)
    }
}

/// Returns the maximum pressure under a load in a contact ellipse with given semi-axes (H10).
#[inline(always)]
pub(crate) fn max_pressure<F: Real>(load: F, (a, b): (F, F)) -> F {
    // p_max = 3 Q / (2 π a b)                                             (H10)
    load * 1.5 / (a * PI * b)
}

impl Hertz {
    /// Returns the maximum pressure \[Pa\] under the load `load` \[N\] (H10). The pressure is zero
    /// if the load is zero or negative, and NaN if the load is NaN.
    pub fn max_pressure(&self, load: f64) -> f64 {
        if load <= 0.0 { 0.0 } else { max_pressure(load, self.semi_axes(load)) }
    }
}

/// Shape of a contact ellipse, calculated as the root of (H7).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axes<D> {
    /// Ratio of the semi-axes `$q = 1/\kappa = b/a$`.
    flatness: D,
    /// Complete elliptic integral of the first kind `$K(m)$`.
    k: D,
    /// Complete elliptic integral of the second kind `$E(m)$`.
    e: D,
}

/// Numbers of iterations for finding a root of (H7).
#[derive(Debug, Clone, Copy, PartialEq)]
struct Iterations {
    /// Number of Newton steps.
    steps: usize,
    /// Number of arithmetic-geometric mean steps.
    agm_steps: usize,
}

/// Numbers of iterations for curvature ratios up to [`Axes::MAX_PRACTICAL_RATIO`]. The error of the
/// starting value is at most 0.3. The errors after the first two Newton steps are at most 4e-3 and
/// 2e-7, and the error after the third step is a rounding error. For `$\kappa \le 700$`, the errors
/// of the arithmetic-geometric means are below rounding errors.
const PRACTICAL_ITERATIONS: Iterations = Iterations { steps: 3, agm_steps: 6 };

/// Iteration counts for curvature ratios up to 1e30. No groove that can be represented in double
/// precision has a larger curvature ratio.
const EXTREME_ITERATIONS: Iterations = Iterations { steps: 12, agm_steps: 12 };

impl<D: Real> Axes<D> {
    /// Maximum curvature ratio `$\rho_t/\rho_x$` for [`Self::of_practical_ratio`].
    pub const MAX_PRACTICAL_RATIO: f64 = 1e4;

    /// Solves (H7) for curvature ratios from 1 to [`Self::MAX_PRACTICAL_RATIO`], accurate to
    /// rounding errors.
    #[inline(always)]
    pub fn of_practical_ratio(target: D) -> Self {
        Self::solve(target, PRACTICAL_ITERATIONS).0
    }

    /// Solves (H7) for a curvature ratio. Also returns the equation evaluated at the root.
    #[inline(always)]
    fn solve(target: D, effort: Iterations) -> (Self, CurvatureEquation<D>) {
        // The starting value is κ ≈ (ρ_t/ρ_x)^{5/8}, which is similar to the formula of Brewe and
        // Hamrock. For a circular contact, the starting value is exact: κ = 1.
        let mut q = (target * target.sqrt().sqrt()).sqrt().recip();
        for _ in 0..effort.steps {
            let at = CurvatureEquation::at(q, effort.agm_steps);
            let [found, wanted] = [at.below(), target * q.square() * at.above()];
            // Newton's method is applied to the logarithms of both sides of (H7). The logarithm ln
            // x is approximated by 2 (x−1)/(x+1), and the step uses the inverse of this
            // approximation.
            let up = (found - wanted) * (at.above() * at.below());
            let down = (found + wanted) * at.slope();
            q = q * ((down + up) / (down - up));
        }
        let at = CurvatureEquation::at(q, effort.agm_steps);
        (Self { flatness: q, k: at.k, e: at.e() }, at)
    }
}

impl<D: Scalar> Axes<D> {
    /// Solves (H7) with derivatives, using the implicit function theorem.
    fn of<const N: usize>(targets: [D; N]) -> [Self; N] {
        let found = Arch::new().dispatch(SideBySide(targets.map(|target| target.re())));
        from_fn(|i| {
            let (Axes { flatness, k, e }, at) = found[i];
            // d ln κ = d ln t / s, which is exact to first order for any scalar type (V4)
            let t = targets[i].re();
            let moved = (targets[i] - D::from(t)) * (at.above() * at.below() / (at.slope() * t));
            // dK/d ln κ = K (1 − r)/2,  dE/d ln κ = −K q² (1 + r)/2       (H11)
            let (dk, de) = (0.5 * k * at.below(), -0.5 * k * flatness * flatness * at.above());
            let with_derivatives = |value: f64, slope: f64| moved * slope + value;
            Self {
                flatness: with_derivatives(flatness, -flatness),
                k: with_derivatives(k, dk),
                e: with_derivatives(e, de),
            }
        })
    }
}

/// Curvature ratios of several contact ellipses that are calculated in parallel.
struct SideBySide<const N: usize>([f64; N]);

impl<const N: usize> WithSimd for SideBySide<N> {
    type Output = [(Axes<f64>, CurvatureEquation<f64>); N];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        const { assert!(N <= BLOCK, "the number of contacts must not exceed the block size") };
        let mut targets = [1.0; BLOCK];
        targets[..N].copy_from_slice(&self.0);
        let is_practical = self.0.iter().all(|ratio| *ratio <= Axes::<f64>::MAX_PRACTICAL_RATIO);
        let effort = if is_practical { PRACTICAL_ITERATIONS } else { EXTREME_ITERATIONS };
        let mut all = [(Axes { flatness: 1.0, k: 1.0, e: 1.0 }, CurvatureEquation::at(1.0, 1)); N];
        for first in (0..N).step_by(S::F64_LANES) {
            let (axes, at) = Axes::solve(Lane::<S>::load(simd, &targets[first..]), effort);
            for (i, found) in all[first..].iter_mut().enumerate().take(S::F64_LANES) {
                let number = |lane: Lane<S>| lane.as_slice()[i];
                let [flatness, k, e] = [axes.flatness, axes.k, axes.e].map(number);
                let [half, r, w] = [at.half, at.r, at.w].map(number);
                *found = (Axes { flatness, k, e }, CurvatureEquation { k, half, r, w });
            }
        }
        all
    }
}

/// Equation (H7) at a given axis ratio, evaluated with arithmetic-geometric means. The evaluation
/// never subtracts nearly equal numbers.
///
/// ```math
/// \frac{K - E}{K} = \frac{m}{2}(1 + r), \qquad \frac{\rho_t}{\rho_x} = \frac{1 - r}{q^2 (1 + r)}
/// ```
#[derive(Debug, Clone, Copy)]
struct CurvatureEquation<D> {
    k: D,
    /// Half of the parameter of the elliptic integrals, `$m/2$`.
    half: D,
    /// Terms `$r = w m/2$` and `$w$` of (H7). For a circular contact, `$w = 1/4$`.
    r: D,
    w: D,
}

impl<D: Real> CurvatureEquation<D> {
    #[inline(always)]
    fn at(q: D, agm_steps: usize) -> Self {
        let one = q.constant(1.0);
        let (below, above) = (one - q, one + q);
        let (mut a, mut g, mut weight) = (above * 0.5, q.sqrt(), 2.0);
        let mut sum = q.constant(0.0);
        for _ in 1..agm_steps {
            let c = (a - g) * 0.5;
            sum = sum + c.square() * weight;
            weight *= 2.0;
            (a, g) = ((a + g) * 0.5, (a * g).sqrt());
        }
        // (K − E)/K = m/2 + Σ 2^{i−1} c_i², c₁ = (1 − q)/2. Near a circle, all terms after c₁² are
        // of order c₁⁴ or of the order of the squared rounding error, 1e-33. Adding 1e-16 to c₁²
        // keeps these terms from affecting the result.
        let first = below.square() * 0.25 + 1e-16;
        let half = below * above * 0.5;
        let w = (sum + first) / (first * above.square());
        Self { k: q.constant(0.5 * PI) / a, half, r: w * half, w }
    }

    /// Returns the factor `$1 + r$` in (H7).
    #[inline(always)]
    fn above(&self) -> D {
        self.r + 1.0
    }

    /// Returns the factor `$1 - r$` in (H7).
    #[inline(always)]
    fn below(&self) -> D {
        -self.r + 1.0
    }

    /// Returns the derivative of the logarithm of the curvature ratio with respect to the logarithm
    /// of `$\kappa$`, multiplied by `$(1 + r)(1 - r)$`.
    #[inline(always)]
    fn slope(&self) -> D {
        // Slope: (1 + r)(1 − 3r) + 2w, from the derivatives of K and E    (H11)
        self.above() * (self.r * -3.0 + 1.0) + self.w * 2.0
    }

    /// Returns the complete elliptic integral of the second kind `$E(m)$`.
    #[inline(always)]
    fn e(&self) -> D {
        self.k * (-(self.half * self.above()) + 1.0)
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use bsm_kin::Jet;
    use ellip::ellipke;
    use proptest::prelude::*;

    use super::*;

    const STEEL: Material = Material { youngs_modulus: 207e9, poisson_ratio: 0.3 };

    fn lin_contact(member: Raceway) -> Hertz {
        let groove = Groove { member, conformity: 0.53 };
        let angle = f64::to_radians;
        let curvatures = groove.curvatures(24.3e-3, 4.37e-3, angle(10.0), angle(45.0));
        Hertz::of(&curvatures, contact_modulus(&STEEL, &STEEL)).unwrap()
    }

    /// The constants of Lin's screw with conformities of 0.53 agree with independent values, which
    /// are stated with eight to eleven digits.
    #[test]
    fn hertz_constants_of_the_screw_of_lin_match_the_reference() {
        let nut = lin_contact(Raceway::Nut);
        assert_relative_eq!(nut.flatness.recip(), 5.972_732_4, max_relative = 1e-8);
        assert_relative_eq!(nut.semi_axis, 1.127_830_59e-4, max_relative = 1e-8);
        // The reference states 1.88829920e-5 for this semi-axis. The quotient a/κ of the reference
        // values differs from this number by a relative amount of 2e-8, so the test uses the
        // quotient.
        assert_relative_eq!(nut.semi_axes(1.0).1, 1.888_299_23e-5, max_relative = 1e-8);
        assert_relative_eq!(nut.stiffness(), 2.445_283_496_7e10, max_relative = 1e-10);
        let screw = lin_contact(Raceway::Screw);
        assert_relative_eq!(screw.flatness.recip(), 6.961_155_4, max_relative = 1e-8);
        assert_relative_eq!(screw.semi_axis, 1.151_921_66e-4, max_relative = 1e-8);
        assert_relative_eq!(screw.semi_axes(1.0).1, 1.654_785_16e-5, max_relative = 1e-8);
        assert_relative_eq!(screw.stiffness(), 2.356_080_636_3e10, max_relative = 1e-10);
    }

    /// Hand calculation in millimeters: for ρ_t = 0.25 1/mm, ρ_x = 0.02 1/mm and a load of 3 kN on
    /// an 8 mm ball, the permanent approach is 1.3e-7 × 0.25 × 0.02 × 9e6 / 8 = 7.3125e-4 mm.
    #[test]
    fn permanent_deformation_of_a_hertz_contact_matches_a_hand_calculation() {
        let curvatures = Curvatures { longitudinal: 250.0, transverse: 20.0 };
        let approach = curvatures.permanent_approach(3e3, 4e-3);
        assert_relative_eq!(approach, 7.3125e-7, max_relative = 1e-12);
    }

    /// For a sphere on a plane, the closed-form solution is a³ = 3QR/(4E*), δ = a²/R.
    #[test]
    fn circular_contact_matches_a_sphere_on_a_plane() {
        let radius = 5e-3_f64;
        let curvatures = Curvatures { longitudinal: radius.recip(), transverse: radius.recip() };
        let hertz = Hertz::of(&curvatures, 1.1e11).unwrap();
        let a = (3.0 * radius / (4.0 * 1.1e11)).cbrt();
        assert_relative_eq!(hertz.flatness.recip(), 1.0, max_relative = 1e-15);
        assert_relative_eq!(hertz.semi_axis, a, max_relative = 1e-14);
        assert_relative_eq!(hertz.approach(1.0), a * a / radius, max_relative = 1e-14);
        // Near a circle, (3/2) d ln κ = d ln ρ_t, and the integrals are smooth functions of κ.
        let jets = Curvatures {
            longitudinal: Jet::variable(radius.recip(), 0),
            transverse: Jet::<1>::from(radius.recip()),
        };
        let moved = Hertz::of(&jets, Jet::from(1.1e11)).unwrap();
        assert_relative_eq!(
            moved.flatness.recip().eps[0],
            2.0 / 3.0 * radius,
            max_relative = 1e-14
        );
    }

    #[test]
    fn max_pressure_is_zero_without_load_and_nan_for_an_undefined_load() {
        let nut = lin_contact(Raceway::Nut);
        assert!(nut.max_pressure(1.0) > 0.0);
        assert!([0.0, -1.0].iter().all(|load| nut.max_pressure(*load) == 0.0));
        assert!(nut.max_pressure(f64::NAN).is_nan());
    }

    /// For zero lead angle, the curvatures equal those of a ball bearing.
    #[test]
    fn curvatures_at_zero_lead_match_a_bearing() {
        let (r_m, r_b, beta) = (24.3e-3, 4.37e-3, 0.8_f64);
        let gamma = r_b * beta.cos() / r_m;
        for (member, sign) in [(Raceway::Nut, 1.0), (Raceway::Screw, -1.0)] {
            let c = Groove { member, conformity: 0.52 }.curvatures(r_m, r_b, 0.0, beta);
            let bearing = 1.0 / r_b - sign * (gamma / r_b) / (1.0 + sign * gamma);
            assert_relative_eq!(c.longitudinal, bearing, max_relative = 1e-14);
        }
    }

    #[test]
    fn curvatures_that_give_no_ellipse_are_rejected() {
        for (longitudinal, transverse) in [(1.0, 2.0), (1.0, 0.0), (1.0, -1.0), (f64::NAN, 1.0)] {
            let domain_error = Hertz::of(&Curvatures { longitudinal, transverse }, 1e11);
            assert!(
                matches!(domain_error, Err(Reason::CurvaturesNotHertzian { .. })),
                "{domain_error:?}"
            );
        }
    }

    /// Curvature ratios with 1/κ, K(m) and E(m). The values were calculated by solving (H7) with
    /// Newton's method and sixty digits (mpmath).
    const AXES: [(f64, f64, f64, f64); 11] = [
        (1.000_000_001, 0.999_999_999_333_333_3, 1.570_796_327_318_495_5, 1.570_796_326_271_297_8),
        (1.0001, 0.999_933_338_888_398_2, 1.570_848_684_490_918_4, 1.570_743_971_716_548_8),
        (1.1, 0.938_438_975_363_747_5, 1.621_090_617_117_651_6, 1.522_830_309_964_981),
        (3.0, 0.482_627_781_123_252_33, 2.188_272_132_706_440_5, 1.200_180_553_352_487_6),
        (50.0, 0.082_842_170_517_519_09, 3.882_066_718_215_382_7, 1.011_613_039_689_313_3),
        (1e3, 0.014_733_513_154_946_719, 5.604_174_814_956_239, 1.000_554_010_797_12),
        (1e4, 0.004_124_857_358_385_621_5, 6.877_043_199_486_527, 1.000_054_251_037_491_7),
        (1.0001e4, 0.004_124_631_968_033_284, 6.877_097_840_454_869, 1.000_054_245_573_668),
        (1e6, 0.000_345_950_038_447_738_7, 9.355_510_802_002_536, 1.000_000_529_920_101_4),
        (1e9, 9.132_529_697_563_359e-6, 12.989_962_187_797_417, 1.000_000_000_520_850_7),
        (1e15, 7.229_815_750_105_263e-9, 20.131_346_646_299_846, 1.000_000_000_000_000_4),
    ];

    #[test]
    fn ellipse_axes_match_reference_values_from_circle_to_needle() {
        for (target, flatness, k, e) in AXES {
            let [axes] = Axes::of([target]);
            // Each value may differ from its reference by a few rounding errors.
            assert_relative_eq!(axes.flatness, flatness, max_relative = 1e-15);
            assert_relative_eq!(axes.k, k, max_relative = 1e-15);
            assert_relative_eq!(axes.e, e, max_relative = 1e-15);
        }
    }

    proptest! {
        /// Derivatives with respect to the curvature along the track and the contact modulus agree
        /// with finite differences.
        #[test]
        fn hertz_derivatives_match_finite_differences(log_ratio in 1e-3..9.0_f64) {
            let (transverse, modulus) = (13.0, 1.1e11);
            let longitudinal = transverse * log_ratio.exp();
            let jets = Curvatures { longitudinal: Jet::variable(longitudinal, 0), transverse: Jet::from(transverse) };
            let exact = Hertz::of(&jets, Jet::<2>::variable(modulus, 1)).unwrap();
            let at = |a: f64, e: f64| {
                Hertz::of(&Curvatures { longitudinal: longitudinal * a, transverse }, modulus * e).unwrap()
            };
            // The tolerance allows for the truncation error, which is of order h², and for the
            // rounding error of (H7). In the difference quotient, the rounding error is 1e-16/h
            // divided by the logarithm of the curvature ratio, which is small near a circle.
            let h = 1e-4;
            let tol = 1e-6 + 1e-11 / log_ratio;
            let read: [fn(&Hertz) -> f64; 4] =
                [|x| x.flatness, |x| x.semi_axis, |x| x.compliance, |x| x.second_integral];
            let jets = [exact.flatness, exact.semi_axis, exact.compliance, exact.second_integral];
            for (read, jet) in read.into_iter().zip(jets) {
                let scale = 2.0 * h * jet.re;
                let by_curvature = (read(&at(1.0 + h, 1.0)) - read(&at(1.0 - h, 1.0))) / scale;
                let by_modulus = (read(&at(1.0, 1.0 + h)) - read(&at(1.0, 1.0 - h))) / scale;
                prop_assert!((by_curvature - jet.eps[0] * longitudinal / jet.re).abs() <= tol);
                prop_assert!((by_modulus - jet.eps[1] * modulus / jet.re).abs() <= tol);
            }
        }

        /// The contact ellipse satisfies the curvature equation (H7), and approach and pressure
        /// scale correctly with the load.
        #[test]
        fn contact_ellipse_satisfies_the_curvature_equation(log_ratio in 0.01..9.0_f64, load in 1e-3..1e6_f64) {
            let transverse = 13.0;
            let longitudinal = transverse * log_ratio.exp();
            let hertz = Hertz::of(&Curvatures { longitudinal, transverse }, 1.1e11).unwrap();
            let (k, e) = ellipke(1.0 - hertz.flatness.powi(2)).unwrap();
            let relation = (hertz.flatness.recip().powi(2) * e - k) / (k - e);
            // Near a circle, the differences κ² E − K and K − E suffer from cancellation.
            prop_assert!((relation.ln() - log_ratio).abs() <= 1e-11 / log_ratio.min(1.0));
            let (a, b) = hertz.semi_axes(8.0 * load);
            prop_assert!((a / hertz.semi_axes(load).0 - 2.0).abs() <= 1e-14);
            prop_assert!((a / b / hertz.flatness.recip() - 1.0).abs() <= 1e-14);
            let mean = load / (PI * hertz.semi_axes(load).0 * hertz.semi_axes(load).1);
            prop_assert!((hertz.max_pressure(load) / mean - 1.5).abs() <= 1e-13);
        }
    }
}
