//! Slip over a contact ellipse, and the points at which the slip is zero.
//!
//! Theory: `docs/theory/09-traction.md`, equations (T9), (T12), (T13), (T15), (T16), (T18).

use bsm_kin::Real;
use bsm_simd::{Lane, Simd};

/// Upper limit of the distance of a pole from the center of the ellipse, and of the width of a
/// pole, both divided by the semi-axis. A pole beyond this limit hardly affects the positions of
/// the nodes.
pub(super) const FAR_LIMIT: f64 = 8.0;

/// Lower limit of the magnitude of divisors, which prevents division by zero.
const TINY: f64 = 1e-150;

/// Slip over a contact ellipse, as a function of the position on the long axis divided by the
/// semi-axis (T12), (T13).
#[derive(Debug, Clone, Copy)]
pub struct EllipseSlip<F> {
    /// Coefficients of the polynomial that gives the slip along the groove as a function of the
    /// position.
    pub(super) longitudinal: [F; 3],
    /// Ball radius, and the depth by which the contact surface drops from the center of the ellipse
    /// to its end.
    pub(super) radius: F,
    pub(super) sagitta: F,
    /// Angular velocity about the tangent, and spin multiplied by the short semi-axis.
    rolling_rate: F,
    pub(super) spin_speed: F,
    pub(super) creep: F,
}

/// Returns the depth by which a deformed contact surface drops at a distance `across` from its
/// center.
#[inline(always)]
pub(crate) fn surface_drop<F: Real>(across: F, pressed_radius: F) -> F {
    across * across * 0.5 / pressed_radius
}

#[inline(always)]
pub(super) fn clamp<F: Real>(x: F, low: f64, high: f64) -> F {
    let (low, high) = (x.constant(low), x.constant(high));
    F::select(x.lt(low), low, F::select(high.lt(x), high, x))
}

/// Returns half the length of the chord of the ellipse at a position on the long axis, divided by
/// the short semi-axis.
#[inline(always)]
pub(super) fn half_length<F: Real>(xi: F) -> F {
    ((-xi + 1.0) * (xi + 1.0)).larger(xi.constant(0.0)).sqrt()
}

/// Returns `x` or, if its magnitude is too small for a divisor, a small nonzero number.
#[inline(always)]
fn divisor<F: Real>(x: F) -> F {
    let tiny = x.constant(TINY);
    F::select(x.abs().lt(tiny), tiny, x)
}

/// A complex pole of the integrand along the long axis, given by the real part of its position and
/// by its distance from the real axis.
#[derive(Clone, Copy)]
pub(super) struct Pole<F> {
    pub(super) at: F,
    pub(super) width: F,
}

impl<F: Real> Pole<F> {
    /// Returns the pole `other` where the mask is true, and the pole `self` elsewhere.
    #[inline(always)]
    fn or(self, mask: F::Mask, other: Self) -> Self {
        let width = F::select(mask, other.width, self.width);
        Self { at: F::select(mask, other.at, self.at), width }
    }
}

impl<F: Real> EllipseSlip<F> {
    /// Creates the slip over a contact ellipse from a motion in contact coordinates.
    ///
    /// * `semi_axes`: semi-axes across and along the groove.
    /// * `radii`: radius of the contact surface (E2), and ball radius.
    /// * `speed`: speed of the ball center along `$t$`.
    /// * `omega`: angular velocity about `$t$`, `$N$` and `$t \times N$`.
    #[inline(always)]
    pub fn new(
        semi_axes: (F, F),
        (pressed_radius, radius): (F, F),
        speed: F,
        [rolling_rate, spin, across]: [F; 3],
        creep: F,
    ) -> Self {
        let (a, b) = semi_axes;
        let sagitta = surface_drop(a, pressed_radius);
        // q₀ = A + ω_c r_b,  q₁ = ω_N a,  q₂ = −ω_c a²/(2 R_c)           (T12)
        let longitudinal = [speed + across * radius, spin * a, -(across * sagitta)];
        Self { longitudinal, radius, sagitta, rolling_rate, spin_speed: spin * b, creep }
    }

    /// Returns the slip along the groove at a position on the long axis.
    #[inline(always)]
    pub(super) fn along(&self, xi: F) -> F {
        // v_t = q₀ + q₁ ξ + q₂ ξ²                                        (T12)
        (self.longitudinal[2] * xi + self.longitudinal[1]) * xi + self.longitudinal[0]
    }

    /// Returns the coefficients `b_0` and `b_1` of the slip across the groove, `$-(b_0 + b_1 s)$`.
    #[inline(always)]
    pub(super) fn across(&self, xi: F) -> (F, F) {
        self.across_at(xi, half_length(xi))
    }

    /// Returns the same coefficients as [`across`](Self::across) for a chord whose [`half_length`]
    /// is already known.
    #[inline(always)]
    pub(super) fn across_at(&self, xi: F, half_length: F) -> (F, F) {
        // b₀ = ω_t h,  b₁ = ω_N Y                                        (T13)
        (self.rolling_rate * self.height(xi), self.spin_speed * half_length)
    }

    /// Returns the distance between contact surface and ball center, measured along the contact
    /// normal.
    #[inline(always)]
    pub(super) fn height(&self, xi: F) -> F {
        self.radius - self.sagitta * (xi * xi)
    }

    /// Returns `$\sinh^2\eta$`, where `$\eta$` describes the ellipse of analyticity of the
    /// integrand along the chord at `xi`.
    #[inline(always)]
    pub(super) fn analyticity(&self, xi: F) -> F {
        let v_t = self.along(xi);
        let (b_0, b_1) = self.across(xi);
        // z = (b₀ + i √(v_t² + v_e²))/b₁                                 (T18)
        let (square, spin) = (v_t * v_t + self.creep * self.creep, b_1 * b_1);
        let far = (b_0.abs() - b_1.abs()) * (b_0.abs() + b_1.abs()) + square;
        // sinh²η = [A + √(A² + 4 b₁² r²)]/(2 b₁²),  r² = v_t² + v_e²,  A = b₀² − b₁² + r²
        let (both, near) = ((far * far + spin * square * 4.0).sqrt() + far.abs(), far.below(0.0));
        let (up, down) = (F::select(near, square * 2.0, both), F::select(near, both, spin * 2.0));
        up / divisor(down)
    }

    /// Returns the complex poles near the two lines of pure rolling, from left to right.
    #[inline(always)]
    pub(super) fn poles(&self) -> [Pole<F>; 2] {
        let [q_0, q_1, q_2] = self.longitudinal;
        let (zero, one) = (q_0.constant(0.0), q_0.constant(1.0));
        let (s_1, s_2) =
            (F::select(q_1.below(0.0), -one, one), F::select(q_2.below(0.0), -one, one));
        let (q_2, d) = (divisor(q_2), q_1 * q_1 - q_0 * q_2 * 4.0);
        let complex = d.below(0.0);
        let t = divisor(-(q_1 + s_1 * d.larger(zero).sqrt()) * 0.5);
        let middle = -(q_1 / q_2) * 0.5;
        let lines = [F::select(complex, middle, t / q_2), F::select(complex, middle, q_0 / t)];
        let mut poles = [Pole { at: zero, width: one }; 2];
        for i in 0..2 {
            let (b_0, b_1) = self.across(clamp(lines[i], -1.0, 1.0));
            let (b_0, b_1) = (b_0.abs(), b_1.abs());
            // m = √(max(|b₀| − |b₁|, |b₁|/10)² + v_e²)                   (T15)
            let rest = (b_0 - b_1).larger(b_1 * 0.1);
            let m = (rest * rest + self.creep * self.creep).sqrt();
            // v_t(ξ_j ± i δ_j) = ±i m,  t = −(q₁ + sign(q₁)(u + i w))/2  (T16)
            let bend = q_2.abs() * m * 2.0;
            let g = (d * d + bend * bend * 4.0).sqrt();
            let long = ((g + d.abs()) * 0.5).larger(zero).sqrt();
            let long = divisor(long);
            let short = bend / long;
            let (u, w) = (F::select(complex, short, long), F::select(complex, long, short) * s_2);
            let (re, im) = (-(q_1 + s_1 * u) * 0.5, -(s_1 * w) * 0.5);
            let (at, width) = if i == 0 {
                (re / q_2, F::select(complex, long * 0.5 / q_2.abs(), m / long))
            } else {
                let square = divisor(re * re + im * im);
                ((q_0 * re - m * im) / square, (m * re + q_0 * im).abs() / square)
            };
            poles[i] = Pole {
                at: clamp(at, -FAR_LIMIT, FAR_LIMIT),
                width: clamp(width, 1e-100, FAR_LIMIT),
            };
        }
        let [one, two] = poles;
        let swap = two.at.lt(one.at);
        [one.or(swap, two), two.or(swap, one)]
    }
}

impl<F: Copy> EllipseSlip<F> {
    /// Combines corresponding fields of two [`EllipseSlip`] values with a function.
    #[inline(always)]
    pub(super) fn zip<G: Copy, H>(
        &self,
        other: &EllipseSlip<G>,
        f: impl Fn(F, G) -> H,
    ) -> EllipseSlip<H> {
        let ([q_0, q_1, q_2], [p_0, p_1, p_2]) = (self.longitudinal, other.longitudinal);
        EllipseSlip {
            longitudinal: [f(q_0, p_0), f(q_1, p_1), f(q_2, p_2)],
            radius: f(self.radius, other.radius),
            sagitta: f(self.sagitta, other.sagitta),
            rolling_rate: f(self.rolling_rate, other.rolling_rate),
            spin_speed: f(self.spin_speed, other.spin_speed),
            creep: f(self.creep, other.creep),
        }
    }
}

impl EllipseSlip<f64> {
    #[inline(always)]
    pub(super) fn splat<S: Simd>(&self, simd: S) -> EllipseSlip<Lane<S>> {
        self.zip(
            self,
            #[inline(always)]
            |number, _| Lane::splat(simd, number),
        )
    }
}

/// Returns the slip speed at the ends of the longer ellipse, divided by `$r_b W$`, for a ball that
/// rotates at `$W$` relative to a raceway. The result is at least 1 (T9).
///
/// * `semi_axes`, `pressed_radius`: semi-axes of the ellipses and radii of the contact surfaces
///   across the grooves of nut and screw, divided by the ball radius.
pub(crate) fn slip_scale(semi_axes: [f64; 2], pressed_radius: [f64; 2]) -> f64 {
    // Scale: max(1, a²/2R_c)                                              (T9)
    let drops = [0, 1].map(|i| surface_drop(semi_axes[i], pressed_radius[i]));
    drops.into_iter().fold(1.0, f64::max)
}
