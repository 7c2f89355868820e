//! Elliptical Hertz contacts of ball and grooves by lanes, Eqs (H1) to (H9), (E2).

use std::f64::consts::PI;

use bsm_case::InputKey;
use bsm_case::units::GPA;
use bsm_simd::Simd;

use crate::kernel::units::Units;
use crate::operand::{Given, Lane, Mask};

/// Newton steps on the ratio of the semi-axes: errors of at most 10 %, 3e-4, 2e-9, rounding.
const STEPS: usize = 3;

/// Arithmetic-geometric means: differences of squares below rounding for `$\kappa \le 70$`.
const MEANS: usize = 6;

/// Ratios of the curvatures `$\rho_t/\rho_x$` for which these numbers hold; nearer to a circle the
/// model itself cancels.
const RATIOS: (f64, f64) = (1.5, 1e3);

/// A contact in units of ball radius and axial load per ball.
pub(super) struct Hertz<S: Simd> {
    /// `$l_0$` of (H2).
    pub(super) offset: Lane<S>,
    /// Radius of the pressed surface.
    pub(super) pressed_radius: Lane<S>,
    /// `$b/a$`.
    pub(super) flatness: Lane<S>,
    /// Semi-axis across the groove and approach under the axial load.
    pub(super) semi_axis: Lane<S>,
    pub(super) approach: Lane<S>,
    /// `$E(m)$`.
    pub(super) second_integral: Lane<S>,
    /// Where all this holds.
    pub(super) regular: Mask<S>,
}

/// The screw that a groove belongs to.
pub(super) struct Screw<S: Simd> {
    /// `$r_m/r_b$`.
    pub(super) radius: Lane<S>,
    pub(super) tan_a: Lane<S>,
    /// Of the unloaded contact angle.
    pub(super) cos_b: Lane<S>,
}

/// `$E^* r_b^2/F_a$` of the materials, those of the races unless given for the ball.
#[inline(always)]
pub(super) fn modulus<S: Simd>(given: &Given<'_, S>, units: &Units<S>) -> Lane<S> {
    let young = given.get(InputKey::youngs_modulus_GPa);
    let poisson = given.get(InputKey::poisson_ratio);
    let ball_young = given.try_get(InputKey::ball_youngs_modulus_GPa).unwrap_or(young);
    let ball_poisson = given.try_get(InputKey::ball_poisson_ratio).unwrap_or(poisson);
    let one = young.constant(1.0);
    // 1/E* = (1−ν₁²)/E₁ + (1−ν₂²)/E₂                                      (H1)
    let compliance =
        (one - poisson * poisson) / young + (one - ball_poisson * ball_poisson) / ball_young;
    units.ball * units.ball * GPA / (compliance * units.load)
}

impl<S: Simd> Hertz<S> {
    /// The contact of a groove; `side` is 1 at the nut, -1 at the screw.
    #[inline(always)]
    pub(super) fn of(side: f64, conformity: Lane<S>, modulus: Lane<S>, screw: &Screw<S>) -> Self {
        let one = conformity.constant(1.0);
        let twice = conformity * 2.0;
        // l₀ = (f_c − 1/2) 2 r_b                                          (H2)
        let offset = twice - one;
        // r_c = r_m ∓ l₀ cosβ₀                                            (H3)
        let centre_radius = screw.radius - offset * screw.cos_b * side;
        let advance = screw.radius * screw.tan_a;
        // κ_c = r_c / (r_c² + h²)                                         (H4)
        let curvature = centre_radius / (centre_radius * centre_radius + advance * advance);
        let bent = curvature * screw.cos_b * side;
        // ρ_t = 1/r_b ∓ κ_c cosβ₀ / (1 ± r_g κ_c cosβ₀)                   (H5)
        let along = one - bent / (twice * bent + one);
        // ρ_x = 1/r_b − 1/r_g                                             (H6)
        let across = one - twice.recip();
        let target = along / across;
        let (least, most) = (one.constant(RATIOS.0), one.constant(RATIOS.1));
        let (flatness, first, second) = axis_ratio(target);
        // a = (3 κ² E Q / (π S E*))^{1/3}                                 (H8)
        let size = second * 3.0 / (flatness * flatness * (along + across) * modulus * PI);
        let semi_axis = size.cbrt_positive();
        Self {
            offset,
            // R_c = 2 f_c (2 r_b) / (2 f_c + 1)                           (E2)
            pressed_radius: twice * 2.0 / (twice + one),
            flatness,
            semi_axis,
            // δ = 3 Q K / (2 π a E*)                                      (H9)
            approach: first * 3.0 / (semi_axis * modulus * (2.0 * PI)),
            second_integral: second,
            regular: target.gt(least) & target.lt(most) & across.gt(one.constant(0.0)),
        }
    }
}

/// Solves (H7) for `$q = 1/\kappa$`; returns it with `$K(m)$` and `$E(m)$`.
#[inline(always)]
fn axis_ratio<S: Simd>(target: Lane<S>) -> (Lane<S>, Lane<S>, Lane<S>) {
    let one = target.constant(1.0);
    // Start: κ ≈ (ρ_t/ρ_x)^{5/8}, near Brewe and Hamrock's fit.
    let mut q = (target * target.sqrt().sqrt()).sqrt().recip();
    for _ in 0..STEPS {
        let (_, s, d) = integrals(q);
        // (κ² E − K) / (K − E) = d/(q² s)                                 (H7)
        let square = q * q;
        let wanted = target * square * s;
        // d ln(d/(q² s)) / d ln κ by the derivatives of K and E           (H11)
        let slope = (s + s) * d + square * s - (one - s) * d;
        // Newton on the logarithms, with ln x ≈ 2 (x−1)/(x+1) and its inverse for the step.
        let (above, below) = ((d - wanted) * (s * d), (d + wanted) * slope);
        q = q * ((below + above) / (below - above));
    }
    let (first, s, _) = integrals(q);
    (q, first, first * (one - s))
}

/// `$K(m)$`, `$s = (K - E)/K$` and `$m - s$` for `$m = 1 - q^2$`, by the arithmetic-geometric mean:
/// no differences of nearly equal numbers.
#[inline(always)]
fn integrals<S: Simd>(q: Lane<S>) -> (Lane<S>, Lane<S>, Lane<S>) {
    let one = q.constant(1.0);
    let (mut a, mut g, mut weight) = (one, q, 1.0);
    let half = (one - q) * (one + q) * 0.5;
    let mut sum = one.constant(0.0);
    for _ in 0..MEANS {
        let c = (a - g) * 0.5;
        sum = sum + c * c * weight;
        weight *= 2.0;
        (a, g) = ((a + g) * 0.5, (a * g).sqrt());
    }
    (a.constant(0.5 * PI) / a, half + sum, half - sum)
}
