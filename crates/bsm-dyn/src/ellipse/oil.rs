//! The sums of the friction of a lubricated ellipse, with derivatives, for several nodes at once.
//!
//! The law is that of [`MixedFriction`](crate::MixedFriction), which tests this. Theory:
//! `docs/theory/17-lubricant.md`, equations (Y11) to (Y13) and (Y33).

#![expect(
    clippy::inline_always,
    reason = "code takes the instruction set of its caller only inline"
)]

use bsm_simd::{Arch, BLOCK, Block, Lane, Simd, WithSimd};

use super::kernel::{self, Point, SLOPES, SUMS, fold};
use super::panels::Nodes;
use crate::MixedFriction;
use crate::lubricant::PRESSURE_SLOPE;

/// What the law of a contact depends on besides its slip: share, shear, Eyring stress, largest pressure.
pub(super) const NUMBERS: usize = 4;

/// Derivatives: by motion and growth, and by the numbers of the law.
pub(super) const BY: usize = SLOPES + NUMBERS;

/// Force, moment and power, and their derivatives.
const VALUES: usize = SUMS + 1;
const ALL: usize = VALUES + SUMS * BY;

/// Below this the inverse hyperbolic sine is its series, whose next term is of the size of rounding.
const SMALL: f64 = 5e-3;

/// Force and moment over `$Q$`, and the power that they take.
pub(super) fn sums(point: &Point, law: &MixedFriction, nodes: Nodes<'_>) -> ([f64; SUMS], f64) {
    let (values, _) = totals::<false>(point, law, nodes);
    let [f_t, f_c, m_t, m_n, m_c, power] = values;
    ([f_t, f_c, m_t, m_n, m_c], power)
}

/// The same, and the derivatives of force and moment: by the speed of the centre, the angular velocity, the
/// logarithm of the size of the ellipse, and share, shear, Eyring stress and largest pressure.
pub(super) fn slopes(
    point: &Point,
    law: &MixedFriction,
    nodes: Nodes<'_>,
) -> ([f64; SUMS], f64, [[f64; BY]; SUMS]) {
    let (values, slopes) = totals::<true>(point, law, nodes);
    let [f_t, f_c, m_t, m_n, m_c, power] = values;
    ([f_t, f_c, m_t, m_n, m_c], power, slopes)
}

fn totals<const SLOPED: bool>(
    point: &Point,
    law: &MixedFriction,
    nodes: Nodes<'_>,
) -> ([f64; VALUES], [[f64; BY]; SUMS]) {
    let list = kernel::nodes(point, nodes, false);
    let padded = list.len().next_multiple_of(BLOCK);
    let column = |read: fn(&(f64, f64, f64)) -> f64| {
        let mut column: Vec<_> = list.iter().map(read).collect();
        column.resize(padded, 0.0);
        column
    };
    let places = [column(|node| node.0), column(|node| node.1)];
    let weights = column(|node| node.2);
    let all =
        Arch::new().dispatch(Total::<SLOPED> { point, law, places: &places, weights: &weights });
    let slopes = std::array::from_fn(|i| std::array::from_fn(|k| all[VALUES + i * BY + k]));
    (std::array::from_fn(|i| all[i]), slopes)
}

struct Total<'a, const SLOPED: bool> {
    point: &'a Point,
    law: &'a MixedFriction,
    /// Places over the semi-axes.
    places: &'a [Vec<f64>; 2],
    weights: &'a [f64],
}

/// The coefficient at a node, and its derivatives by the logarithms of slip, Eyring stress and pressure, and
/// by the share.
struct Coefficient<S: Simd> {
    value: Lane<S>,
    by_slip: Lane<S>,
    by_stress: Lane<S>,
    by_pressure: Lane<S>,
    by_share: Lane<S>,
}

impl<S: Simd> Coefficient<S> {
    #[inline(always)]
    fn of(law: &MixedFriction, pressure: Lane<S>, speed: Lane<S>) -> Self {
        let one = speed.constant(1.0);
        let p = pressure * law.max_pressure;
        let room = p.mul_add(p.constant(PRESSURE_SLOPE), p.constant(law.pressure_scale));
        let z = (p / room).exp() * speed * law.shear;
        let square = z * z;
        let root = (square + one).sqrt();
        // arsinh z = z − z³/6 + 3 z⁵/40
        let series = z * (square * (square * 0.075 - 1.0 / 6.0) + one);
        let arsinh = z.lt(z.constant(SMALL)).select(series, (z + root).ln());
        // τ_y = τ_E arsinh[η(p) s/(h τ_E)]                                (Y11)
        let stress = arsinh * law.eyring_stress;
        let excess = p * law.limit / stress;
        let fourth = excess * excess * (excess * excess);
        let bound = fourth + one;
        // μ_f = Λ [1 + (Λ p/τ_y)⁴]^{−1/4}                                 (Y12)
        let fluid = one.constant(law.limit) / bound.sqrt().sqrt();
        let film = 1.0 - law.share;
        // ∂μ/∂ln τ_y = (1 − ξ) μ_f X⁴/(1 + X⁴),  ∂ln τ_y/∂ln s = z/(√(1 + z²) arsinh z)  (Y33)
        let by_stress = fluid * fourth / bound * film;
        let bend = z / (root * arsinh);
        let by_slip = by_stress * bend;
        let stiffening = p * law.pressure_scale / (room * room);
        Self {
            // μ = ξ μ_b + (1 − ξ) μ_f                                     (Y13)
            value: fluid * film + law.share * law.boundary,
            by_slip,
            by_stress,
            by_pressure: by_slip * stiffening - by_stress,
            by_share: -fluid + law.boundary,
        }
    }
}

/// A node on the pressed surface.
struct Place<S: Simd> {
    x: Lane<S>,
    y: Lane<S>,
    h: Lane<S>,
}

impl<S: Simd> Place<S> {
    /// Force and moment of a force along t and t × N.
    #[inline(always)]
    fn moment(&self, [f_t, f_c]: [Lane<S>; 2]) -> [Lane<S>; SUMS] {
        let &Self { x, y, h } = self;
        [f_t, f_c, -(h * f_c), x * f_t - y * f_c, h * f_t]
    }
}

/// Slopes of friction by the slip, along t and t × N.
struct Bend<S: Simd> {
    tt: Lane<S>,
    tc: Lane<S>,
    cc: Lane<S>,
}

impl<S: Simd> Bend<S> {
    /// Change of the force on the ball by a change of slip.
    #[inline(always)]
    fn force(&self, [dv_t, dv_c]: [Lane<S>; 2]) -> [Lane<S>; 2] {
        let &Self { tt, tc, cc } = self;
        [-(tt * dv_t + tc * dv_c), -(tc * dv_t + cc * dv_c)]
    }
}

/// Adds to every `step`-th total from `first` on.
#[inline(always)]
fn add<S: Simd, const N: usize>(
    simd: S,
    totals: &mut [Block; ALL],
    first: usize,
    step: usize,
    at: usize,
    values: [Lane<S>; N],
) {
    for (i, value) in values.into_iter().enumerate() {
        let total = &mut totals[first + i * step][at..];
        (Lane::load(simd, total) + value).store(total);
    }
}

impl<const SLOPED: bool> WithSimd for Total<'_, SLOPED> {
    type Output = [f64; ALL];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self { point, law, places: [xs, ys], weights } = self;
        let ((a, b), [along, w_t, w_n, w_c]) = (point.semi_axes, point.motion);
        let mut totals: [Block; ALL] = [[0.0; BLOCK]; ALL];
        for first in (0..weights.len()).step_by(BLOCK) {
            for at in (0..BLOCK).step_by(S::F64_LANES) {
                let here = first + at;
                let (xi, upsilon) =
                    (Lane::<S>::load(simd, &xs[here..]), Lane::load(simd, &ys[here..]));
                let weight = Lane::<S>::load(simd, &weights[here..]);
                let one = xi.constant(1.0);
                let inside = one - xi * xi - upsilon * upsilon;
                let pressure = inside.max(one.constant(0.0)).sqrt();
                let (x, y) = (xi * a, upsilon * b);
                let dh = x * x * -point.pressed_radius.recip();
                let h = dh * 0.5 + point.ball_radius;
                let v_t = x * w_n + h * w_c + along;
                let v_c = -(h * w_t) - y * w_n;
                let square = v_t * v_t + v_c * v_c;
                let speed = (square + point.creep * point.creep).sqrt();
                let mu = Coefficient::of(law, pressure, speed);
                let part = weight / speed;
                let pull = part * mu.value;
                let (f_t, f_c) = (-(pull * v_t), -(pull * v_c));
                let place = Place { x, y, h };
                let values = place.moment([f_t, f_c]);
                add(simd, &mut totals, 0, 1, at, values);
                add(simd, &mut totals, SUMS, 1, at, [pull * square]);
                if SLOPED {
                    // d(μ v/s) = (μ/s) dv + (s μ' − μ)/s³ v (v·dv)         (Y33)
                    let bend = part * (mu.by_slip - mu.value) / (speed * speed);
                    let (tt, tc, cc) =
                        (bend * v_t * v_t + pull, bend * v_t * v_c, bend * v_c * v_c + pull);
                    let bend = Bend { tt, tc, cc };
                    let zero = one.constant(0.0);
                    let ways = [[one, zero], [zero, -h], [x, -y], [h, zero]];
                    for (k, way) in ways.into_iter().enumerate() {
                        let slopes = place.moment(bend.force(way));
                        add(simd, &mut totals, VALUES + k, BY, at, slopes);
                    }
                    // Of place and slip by the growth of the ellipse.
                    let mut grown =
                        place.moment(bend.force([x * w_n + dh * w_c, -(dh * w_t) - y * w_n]));
                    grown[2] = grown[2] - dh * f_c;
                    grown[3] = grown[3] + values[3];
                    grown[4] = grown[4] + dh * f_t;
                    add(simd, &mut totals, VALUES + SLOPES - 1, BY, at, grown);
                    let by = [
                        mu.by_share,
                        mu.by_slip * law.shear.recip(),
                        mu.by_stress * law.eyring_stress.recip(),
                        mu.by_pressure * law.max_pressure.recip(),
                    ];
                    for (k, by) in by.into_iter().enumerate() {
                        let pull = -(part * by);
                        let slopes = place.moment([pull * v_t, pull * v_c]);
                        add(simd, &mut totals, VALUES + SLOPES + k, BY, at, slopes);
                    }
                }
            }
        }
        let mut sums = [0.0; ALL];
        fold(simd, &totals, &mut sums);
        sums
    }
}
