//! Friction sums over a lubricated contact ellipse, with derivatives, for several chords at once.
//!
//! The friction law is the same as in [`MixedFriction`](crate::lubrication::MixedFriction). Tests
//! compare both implementations. Theory: `docs/theory/17-lubricant.md`, equations (Y11) to (Y13)
//! and (Y33) to (Y35).

use std::f64::consts::FRAC_2_PI;

use bsm_kin::Real;
use bsm_simd::{BLOCK, Lane, Simd};

use super::Quadrature;
use super::kernel::{Accumulator, Chord, Moments, PointLaw, add_powers};
use super::placement::{FrozenRule, Placement};
use super::quadrature::{MAX_RINGS, part_of_a_node};
use super::slip::{EllipseSlip, half_length};
use crate::contact::{MixedFriction, PRESSURE_SLOPE, Transition};

/// Argument below which the inverse hyperbolic sine is calculated from its power series. The first
/// omitted term is of the order of rounding errors.
const SMALL: f64 = 5e-3;

/// Small number that is used to prevent division by zero.
const TINY: f64 = 1e-300;

/// Quadrature nodes on rings of equal pressure over the whole ellipse. On each ring, the friction
/// coefficient depends only on the slip speed.
pub(super) struct PolarRule {
    count: usize,
    /// For each ring: pressure divided by the maximum pressure, radius divided by the semi-axes,
    /// and fraction of the load.
    pressure: [f64; MAX_RINGS],
    radius: [f64; MAX_RINGS],
    weight: [f64; MAX_RINGS],
}

impl PolarRule {
    /// Places the rings so that they are concentrated at the pressure at which the friction
    /// coefficient changes its slope.
    #[inline(always)]
    pub(super) fn of<S: Simd>(
        simd: S,
        bend: &Transition,
        slip: &EllipseSlip<f64>,
        rule: &Quadrature,
    ) -> Self {
        let [q_0, q_1, q_2] = slip.longitudinal;
        // The load-weighted mean of ξ² is 1/5.
        let (middle, b_0) = (q_0 + 0.2 * q_2, slip.across(0.0).0);
        let spread = 0.2 * (q_1 * q_1 + slip.spin_speed * slip.spin_speed);
        let square = middle * middle + b_0 * b_0 + spread + slip.creep * slip.creep;
        let (at, pole_distance) =
            bend.line_pressure(Lane::<S>::splat(simd, square), Lane::splat(simd, 1.0));
        let width = (pole_distance * 2.0).min(pole_distance.constant(8.0));
        let from = (-at / width).arsinh();
        let length = ((-at + 1.0) / width).arsinh() - from;
        let mut rings = Self {
            count: rule.half.len(),
            pressure: [0.0; MAX_RINGS],
            radius: [0.0; MAX_RINGS],
            weight: [0.0; MAX_RINGS],
        };
        for (i, (abscissa, part)) in rule.half.iter().enumerate() {
            (rings.pressure[i], rings.weight[i]) = (abscissa, part);
        }
        for i in (0..MAX_RINGS).step_by(S::F64_LANES) {
            let abscissa = Lane::load(simd, &rings.pressure[i..]);
            // ζ = ζ* + 2 δ sinh τ                                         (Y35)
            let grow = (length * abscissa + from).exp();
            let fall = grow.recip();
            let half = width * 0.5;
            let zeta = (half * (grow - fall) + at).max(at.constant(0.0)).min(at.constant(1.0));
            // dQ/Q = 3 ζ² dζ dθ/(2π)
            let square = zeta * zeta;
            let part = Lane::load(simd, &rings.weight[i..]) * length * half * (grow + fall);
            (square * part * 3.0).store(&mut rings.weight[i..]);
            (-square + 1.0).sqrt().store(&mut rings.radius[i..]);
            zeta.store(&mut rings.pressure[i..]);
        }
        rings
    }

    /// Returns all quadrature nodes: for each node, the coordinates divided by the semi-axes, and
    /// the fraction of the load that the node represents.
    pub(super) fn nodes(&self, rule: &Quadrature, blocks: usize) -> Vec<(f64, f64, f64)> {
        let [cos, sin] = &rule.angles[blocks - 1];
        let part = part_of_a_node(blocks);
        let rings = (0..self.count).flat_map(|i| {
            let (r, weight) = (self.radius[i], self.weight[i] * part);
            let one = move |(cos, sin): (&f64, &f64)| {
                [(r * cos, r * sin, weight), (r * cos, -r * sin, weight)]
            };
            cos.iter().zip(sin).flat_map(one)
        });
        rings.collect()
    }
}

/// Nodes on one half of each chord, in the variable `$t = \sqrt{1 - |s|}$`. As a function of this
/// variable, the pressure is smooth at both ends.
pub(super) struct HalfChord<S: Simd> {
    at: Lane<S>,
    width: Lane<S>,
    from: Lane<S>,
    length: Lane<S>,
}

/// A quadrature node on the half of a chord with positive s. The other half has a corresponding
/// node at -s.
pub(super) struct HalfNode<S: Simd> {
    /// Position of the node along the chord, and pressure divided by the maximum pressure on the
    /// chord.
    pub(super) s: Lane<S>,
    pub(super) pressure: Lane<S>,
    /// Fraction of the chord's load that is assigned to this node.
    pub(super) weight: Lane<S>,
}

impl<S: Simd> HalfChord<S> {
    /// Places the nodes on the chords at `xi` so that they are concentrated at the transition of
    /// the friction coefficient.
    #[inline(always)]
    pub(super) fn of(bend: &Transition, slip: &EllipseSlip<Lane<S>>, xi: Lane<S>) -> Self {
        let half_length = half_length(xi);
        let (v_t, (b_0, b_1)) = (slip.along(xi), slip.across_at(xi, half_length));
        let square = v_t * v_t + b_0 * b_0 + b_1 * b_1 * 0.25 + slip.creep * slip.creep;
        let one = xi.constant(1.0);
        let (at, pole_distance) = bend.line_pressure(square, half_length);
        // ζ = t √(2 − t²) gives the position t* and the width of the transition. In the middle of
        // the chord, the width is √(pole distance)/2.
        let inside = at.min(one);
        let rest = (-(inside * inside) + 1.0).max(one.constant(0.0)).sqrt();
        let at_t = inside / (rest + 1.0).sqrt();
        let slope = rest * rest * 4.0 / (rest + 1.0);
        let beyond = (at - 1.0).max(one.constant(0.0)) * 0.5;
        let width =
            ((pole_distance * pole_distance / (slope + pole_distance * 4.0) + beyond).sqrt() * 2.0)
                .min(one.constant(8.0));
        let from = (-at_t / width).arsinh();
        let length = ((-at_t + 1.0) / width).arsinh() - from;
        Self { at: at_t, width, from, length }
    }

    /// Returns the node for a position and a weight on [0, 1].
    #[inline(always)]
    pub(super) fn node(&self, (abscissa, part): (f64, f64)) -> HalfNode<S> {
        // A sinh transformation concentrates the nodes around t* (Y35), like the transformation for
        // rings.
        let grow = (self.length * abscissa + self.from).exp();
        let fall = grow.recip();
        let half = self.width * 0.5;
        let one = grow.constant(1.0);
        let t = (half * (grow - fall) + self.at).max(one.constant(0.0)).min(one);
        let square = t * t;
        let pressure = t * (-square + 2.0).sqrt();
        // Weight: (2/π) √(1 − s²) ds with s = 1 − t²
        let weight =
            t * pressure * (half * (grow + fall)) * (self.length * (part * 2.0 * FRAC_2_PI));
        HalfNode { s: -square + 1.0, pressure, weight }
    }
}

/// Constants of the friction law of a lubricated contact.
#[derive(Clone, Copy)]
pub(crate) struct OilLaw {
    mixed: MixedFriction,
    bend: Transition,
    /// Constants `$\xi\mu_b$`, `$(1 - \xi)\Lambda$` and `$-d\xi/d\ln h$` of the friction law.
    boundary: f64,
    film: f64,
    falling: f64,
}

impl OilLaw {
    pub(crate) fn of(law: &MixedFriction) -> Self {
        let MixedFriction { asperity_share: share, boundary, limiting_shear, .. } = *law;
        // ξ = e^{−1.4λ}: dξ/d ln h = ξ ln ξ
        let falling = if share > 0.0 { -share * share.ln() } else { 0.0 };
        let (boundary, film) = (share * boundary, (1.0 - share) * limiting_shear);
        Self { mixed: *law, bend: Transition::of(law), boundary, film, falling }
    }
}

/// Quantities that depend only on the pressure at a node. They are calculated once and then used to
/// calculate the friction coefficient for any slip speed.
#[derive(Clone, Copy)]
pub(crate) struct NodePressure<S: Simd> {
    /// Factor `$\eta(p)/(h\tau_E)$` that multiplies the slip speed, and `$(\Lambda p/\tau_E)^4$`.
    shear: Lane<S>,
    fourth: Lane<S>,
}

impl PointLaw<4> for OilLaw {
    const FILM: bool = true;

    type NodePressure<S: Simd> = NodePressure<S>;

    #[inline(always)]
    fn pressed<S: Simd>(&self, pressure: Lane<S>) -> NodePressure<S> {
        let law = &self.mixed;
        let p = pressure * law.max_pressure;
        let room = p.mul_add(p.constant(PRESSURE_SLOPE), p.constant(law.pressure_scale));
        let ratio = p * (law.limiting_shear / law.eyring_stress);
        let square = ratio * ratio;
        NodePressure { shear: (p / room).exp() * law.shear, fourth: square * square }
    }

    #[inline(always)]
    fn add<S: Simd, const JACOBIAN: bool>(
        &self,
        Moments([j, k, across, film]): &mut Moments<S, 4>,
        pressed: NodePressure<S>,
        square: Lane<S>,
        v_c: Lane<S>,
        (s, weight): (Lane<S>, Lane<S>),
    ) {
        let cross = v_c * v_c;
        let all = square + cross;
        let per_speed = all.recip_sqrt();
        let z = pressed.shear * (all * per_speed);
        let z_square = z * z;
        let above = z_square + 1.0;
        let per_root = above.recip_sqrt();
        // arsinh z = z − z³/6 + 3 z⁵/40
        let series = z * (z_square * (z_square * 0.075 - 1.0 / 6.0) + 1.0);
        let arsinh = z.below(SMALL).select(series, above.mul_add(per_root, z).ln());
        // τ_y = τ_E arsinh[η(p) s/(h τ_E)]                                (Y11)
        let a_2 = arsinh * arsinh;
        let per_both = (a_2.mul_add(a_2, pressed.fourth) + TINY).recip_fourth_root();
        // μ_f = Λ [1 + (Λ p/τ_y)⁴]^{−1/4}                                 (Y12)
        let reduced = per_both * self.film;
        let fluid = arsinh * reduced;
        // μ = ξ μ_b + (1 − ξ) μ_f                                         (Y13)
        let mu = fluid + self.boundary;
        let part = weight * per_speed;
        add_powers(j, part * mu, s);
        if JACOBIAN {
            let inverse = per_speed * per_speed;
            // ∂μ/∂ln s = (1 − ξ) μ_f X⁴/(1 + X⁴) z/(√(1 + z²) arsinh z)   (Y33)
            let squared = per_both * per_both;
            let by_slip = reduced * (pressed.fourth * (squared * squared)) * (z * per_root);
            let cube = part * inverse;
            // d(μ v/s) = (μ/s) dv + (s μ' − μ)/s³ v (v·dv)                (Y33)
            add_powers(k, cube * (mu - by_slip), s);
            add_powers(across, cube * (mu * square + by_slip * cross), s);
            // ∂μ/∂ln h = (μ_b − μ_f/(1 − ξ)) dξ/d ln h − ∂μ/∂ln s
            let thinner = fluid * (self.falling / (1.0 - self.mixed.asperity_share).max(TINY));
            let by_film = thinner - self.falling * self.mixed.boundary - by_slip;
            add_powers(film, part * by_film, s);
        }
    }

    #[inline(always)]
    fn along<S: Simd, const JACOBIAN: bool>(
        &self,
        simd: S,
        (nodes, _): (Placement<'_>, Option<usize>),
        slip: &EllipseSlip<Lane<S>>,
        chord: &Chord<S>,
    ) -> (Moments<S, 4>, usize) {
        let (mut sums, square) = (Moments::zero(simd), chord.square(slip));
        let (half, (b_0, b_1)) = (HalfChord::of(&self.bend, slip, chord.xi), chord.across);
        for k in 0..nodes.rule.half.len() {
            let HalfNode { s, pressure, weight } = half.node(nodes.rule.half.at(k));
            let pressed = self.pressed(pressure * chord.half_length);
            let turned = b_1 * s;
            self.add::<S, JACOBIAN>(&mut sums, pressed, square, b_0 + turned, (s, weight));
            self.add::<S, JACOBIAN>(&mut sums, pressed, square, b_0 - turned, (-s, weight));
        }
        (sums, 2 * nodes.rule.half.len())
    }

    #[inline(always)]
    fn variants<S: Simd>(Moments(kinds): Moments<S, 4>, _square: Lane<S>) -> [[Lane<S>; 3]; 4] {
        kinds
    }

    /// Integrates friction on rings of equal pressure if rings need fewer nodes than chords.
    /// Returns false if friction must be integrated along chords.
    #[inline(always)]
    fn all_over<S: Simd, const JACOBIAN: bool>(
        simd: S,
        sums: &mut Accumulator<'_, Self, 4, JACOBIAN>,
        ellipse: usize,
    ) -> bool {
        let (law, nodes) = (sums.laws[ellipse], sums.nodes[ellipse]);
        let blocks = nodes.angle_blocks(&sums.slips[ellipse]);
        if blocks == 0 {
            return false;
        }
        let (rule, slip) = (nodes.rule, sums.slips[ellipse].splat(simd));
        let rings = PolarRule::of(simd, &law.bend, &sums.slips[ellipse], rule);
        let mut shear = [0.0; MAX_RINGS];
        let mut fourth = [0.0; MAX_RINGS];
        for i in (0..MAX_RINGS).step_by(S::F64_LANES) {
            let pressed = law.pressed(Lane::<S>::load(simd, &rings.pressure[i..]));
            pressed.shear.store(&mut shear[i..]);
            pressed.fourth.store(&mut fourth[i..]);
        }
        let [cos, sin] = &rule.angles[blocks - 1];
        let (one, part) = (slip.creep.constant(1.0), part_of_a_node(blocks));
        for i in 0..rings.count {
            let radius = Lane::splat(simd, rings.radius[i]);
            let weight = Lane::splat(simd, rings.weight[i] * part);
            let pressed = NodePressure {
                shear: Lane::splat(simd, shear[i]),
                fourth: Lane::splat(simd, fourth[i]),
            };
            for first in (0..cos.len()).step_by(S::F64_LANES) {
                let xi = radius * Lane::load(simd, &cos[first..]);
                // The ring intersects the chord at two nodes, which are treated as the ends of the
                // chord.
                let half_length = radius * Lane::load(simd, &sin[first..]);
                let chord = Chord::new(&slip, xi, one, half_length);
                let ((b_0, b_1), square) = (chord.across, chord.square(&slip));
                let mut inner = Moments::zero(simd);
                law.add::<S, JACOBIAN>(&mut inner, pressed, square, b_0 + b_1, (one, weight));
                law.add::<S, JACOBIAN>(&mut inner, pressed, square, b_0 - b_1, (-one, weight));
                sums.add_chord(simd, ellipse, first % BLOCK, &slip, (&chord, inner));
            }
        }
        sums.count += 2 * rings.count * cos.len() / S::F64_LANES;
        nodes.freeze(FrozenRule::Rings(blocks));
        true
    }
}
