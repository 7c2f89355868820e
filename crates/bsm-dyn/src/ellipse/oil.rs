//! The sums of the friction of a lubricated ellipse, with derivatives, for several lines at once.
//!
//! The law is that of [`MixedFriction`](crate::MixedFriction), which tests this. Theory:
//! `docs/theory/17-lubricant.md`, equations (Y11) to (Y13) and (Y33) to (Y35).

#![expect(
    clippy::inline_always,
    reason = "code takes the instruction set of its caller only inline"
)]

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};

use bsm_simd::{Arch, BLOCK, Block, Lane, Simd, WithSimd};

use super::Quadrature;
use super::kernel::{ALL, Line, Near, Point, SUMS, Shape, Sums, VALUES, add_to, fold, some};
use super::panels::{EllipseSlip, Lines, MOST_RINGS, Nodes, Plan, Visit, walk};
use crate::MixedFriction;
use crate::lubricant::PRESSURE_SLOPE;

/// Below this the inverse hyperbolic sine is its series, whose next term is of the size of rounding.
const SMALL: f64 = 5e-3;

/// Numbers below this are no divisors.
const TINY: f64 = 1e-300;

/// Where a coefficient bends along a line: at the pressure at which the oil turns from thin to stiff.
#[derive(Debug, Clone, Copy)]
pub struct Bend {
    /// Twice the shear of (Y11) for a slip of one.
    shear: f64,
    /// `$a_p$` over the largest pressure.
    scale: f64,
}

impl Bend {
    /// Of a coefficient that changes slowly with the pressure.
    pub(crate) const SMOOTH: Self = Self { shear: 1.0, scale: 1.0 };

    pub(crate) fn of(law: &MixedFriction) -> Self {
        Self { shear: 2.0 * law.shear, scale: law.pressure_scale / law.max_pressure }
    }

    /// Where it is at a slip, and how far its poles are off, over a part of the largest pressure.
    ///
    /// * `square`: of the slip.
    #[inline(always)]
    fn place<S: Simd>(&self, square: Lane<S>, part: Lane<S>) -> (Lane<S>, Lane<S>) {
        let one = square.constant(1.0);
        // p* = a_p l/(1 − b_p l),  l = −ln[2 η s/(h τ_E)]                 (Y34)
        let log = (square * (self.shear * self.shear)).max(one.constant(TINY)).ln() * -0.5;
        let log = log.max(one.constant(0.0)).min(one.constant(40.0));
        let room = (-(log * PRESSURE_SLOPE) + 1.0).recip();
        let largest = part.max(one.constant(1e-4)).recip() * self.scale;
        // Its poles are π/2 off in l: dp*/dl = a_p/(1 − b_p l)²
        (log * room * largest, room * room * largest * FRAC_PI_2)
    }
}

/// The nodes of rings of equal pressure over the whole ellipse: on each of them the coefficient changes with the
/// slip alone.
pub(super) struct Rings {
    count: usize,
    /// Pressure over the largest, radius over the semi-axes, and part of the load.
    pressure: [f64; MOST_RINGS],
    radius: [f64; MOST_RINGS],
    weight: [f64; MOST_RINGS],
}

impl Rings {
    /// About the bend of an ellipse.
    #[inline(always)]
    pub(super) fn of<S: Simd>(
        simd: S,
        bend: &Bend,
        slip: &EllipseSlip<f64>,
        rule: &Quadrature,
    ) -> Self {
        let [q_0, q_1, q_2] = slip.along;
        // The load sees ξ² = 1/5 in the mean.
        let (middle, b_0) = (q_0 + 0.2 * q_2, slip.across(0.0).0);
        let spread = 0.2 * (q_1 * q_1 + slip.turn * slip.turn);
        let square = middle * middle + b_0 * b_0 + spread + slip.creep * slip.creep;
        let (at, depth) = bend.place(Lane::<S>::splat(simd, square), Lane::splat(simd, 1.0));
        let width = (depth * 2.0).min(depth.constant(8.0));
        let from = (-at / width).arsinh();
        let length = ((-at + 1.0) / width).arsinh() - from;
        let mut rings = Self {
            count: rule.half.len(),
            pressure: [0.0; MOST_RINGS],
            radius: [0.0; MOST_RINGS],
            weight: [0.0; MOST_RINGS],
        };
        for (i, (place, part)) in rule.half.iter().enumerate() {
            (rings.pressure[i], rings.weight[i]) = (place, part);
        }
        for i in (0..MOST_RINGS).step_by(S::F64_LANES) {
            let place = Lane::load(simd, &rings.pressure[i..]);
            // ζ = ζ* + 2 δ sinh τ                                         (Y35)
            let grow = (length * place + from).exp();
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

    /// Coordinates over the semi-axes and part of the load of all nodes.
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

/// Part of a ring that belongs to a node.
#[expect(clippy::cast_precision_loss, reason = "a few angles")]
pub(super) fn part_of_a_node(blocks: usize) -> f64 {
    0.5 / (blocks * BLOCK) as f64
}

/// The nodes of one half of a few lines, in `$t = \sqrt{1 - |s|}$`, in which pressure is smooth at both ends.
pub(super) struct Half<S: Simd> {
    at: Lane<S>,
    width: Lane<S>,
    from: Lane<S>,
    length: Lane<S>,
}

/// A node of the half line with positive s; the other half has the same with -s.
pub(super) struct Node<S: Simd> {
    /// Place along the line, and pressure over the largest of the line.
    pub(super) s: Lane<S>,
    pub(super) pressure: Lane<S>,
    /// Part of the load of the line.
    pub(super) weight: Lane<S>,
}

impl<S: Simd> Half<S> {
    /// About the bend of lines at `xi`.
    #[inline(always)]
    pub(super) fn of(bend: &Bend, slip: &EllipseSlip<Lane<S>>, xi: Lane<S>) -> Self {
        let chord = super::panels::chord(xi);
        let (v_t, (b_0, b_1)) = (slip.along(xi), slip.across_at(xi, chord));
        let square = v_t * v_t + b_0 * b_0 + b_1 * b_1 * 0.25 + slip.creep * slip.creep;
        let one = xi.constant(1.0);
        let (at, depth) = bend.place(square, chord);
        // ζ = t √(2 − t²): t* and the width there, √(depth)/2 at the middle of the line.
        let inside = at.min(one);
        let rest = (-(inside * inside) + 1.0).max(one.constant(0.0)).sqrt();
        let at_t = inside / (rest + 1.0).sqrt();
        let slope = rest * rest * 4.0 / (rest + 1.0);
        let beyond = (at - 1.0).max(one.constant(0.0)) * 0.5;
        let width =
            ((depth * depth / (slope + depth * 4.0) + beyond).sqrt() * 2.0).min(one.constant(8.0));
        let from = (-at_t / width).arsinh();
        let length = ((-at_t + 1.0) / width).arsinh() - from;
        Self { at: at_t, width, from, length }
    }

    /// The node of a place and a weight on [0, 1].
    #[inline(always)]
    pub(super) fn node(&self, (place, part): (f64, f64)) -> Node<S> {
        // As on rings, about t*.
        let grow = (self.length * place + self.from).exp();
        let fall = grow.recip();
        let half = self.width * 0.5;
        let one = grow.constant(1.0);
        let t = (half * (grow - fall) + self.at).max(one.constant(0.0)).min(one);
        let square = t * t;
        let pressure = t * (-square + 2.0).sqrt();
        // (2/π) √(1 − s²) ds,  s = 1 − t²
        let weight =
            t * pressure * (half * (grow + fall)) * (self.length * (part * 2.0 * FRAC_2_PI));
        Node { s: -square + 1.0, pressure, weight }
    }
}

/// Sums of an oil over `$Q$`.
#[derive(Clone, Copy)]
pub(crate) struct OiledSums {
    /// As those of a constant coefficient, over `$Q$`.
    pub(crate) sums: Sums,
    /// Derivatives of force and moment by the logarithm of the film.
    pub(crate) by_film: [f64; SUMS],
}

/// Those of one contact; slopes only if `SLOPED`, else zero.
pub(super) fn sums<const SLOPED: bool>(
    point: &Point,
    law: &MixedFriction,
    nodes: Nodes<'_>,
) -> OiledSums {
    Arch::new().dispatch(Total::<SLOPED>(point, law, nodes))
}

struct Total<'a, const SLOPED: bool>(&'a Point, &'a MixedFriction, Nodes<'a>);

impl<const SLOPED: bool> WithSimd for Total<'_, SLOPED> {
    type Output = OiledSums;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> OiledSums {
        let Self(point, law, nodes) = self;
        let [sums] = OiledSums::along::<S, 1, SLOPED>(simd, &[*point], &[*law], &[nodes]);
        sums
    }
}

/// What is the same at all points of a contact.
#[derive(Clone, Copy)]
struct Law {
    mixed: MixedFriction,
    /// `$\xi\mu_b$`, `$(1 - \xi)\Lambda$`, and `$-d\xi/d\ln h$`.
    boundary: f64,
    film: f64,
    falling: f64,
}

impl Law {
    fn of(law: MixedFriction) -> Self {
        let MixedFriction { share, boundary, limit, .. } = law;
        // ξ = e^{−1.4λ}: dξ/d ln h = ξ ln ξ
        let falling = if share > 0.0 { -share * share.ln() } else { 0.0 };
        Self { mixed: law, boundary: share * boundary, film: (1.0 - share) * limit, falling }
    }
}

/// A pressure, and what the coefficient at any slip needs of it.
#[derive(Clone, Copy)]
struct Pressed<S: Simd> {
    /// `$\eta(p)/(h\tau_E)$`, and `$(\Lambda p/\tau_E)^4$`.
    shear: Lane<S>,
    fourth: Lane<S>,
}

impl<S: Simd> Pressed<S> {
    /// * `pressure`: over the largest of the contact.
    #[inline(always)]
    fn of(law: &MixedFriction, pressure: Lane<S>) -> Self {
        let p = pressure * law.max_pressure;
        let room = p.mul_add(p.constant(PRESSURE_SLOPE), p.constant(law.pressure_scale));
        let ratio = p * (law.limit / law.eyring_stress);
        let square = ratio * ratio;
        Self { shear: (p / room).exp() * law.shear, fourth: square * square }
    }
}

/// Sums along lines across the ellipse: J and K of (T21), those by the slip across, and J by the film.
#[derive(Clone, Copy)]
struct Inner<S: Simd> {
    j: [Lane<S>; 3],
    k: [Lane<S>; 3],
    across: [Lane<S>; 3],
    film: [Lane<S>; 3],
}

impl<S: Simd> Inner<S> {
    #[inline(always)]
    fn zero(simd: S) -> Self {
        let zero = Lane::splat(simd, 0.0);
        Self { j: [zero; 3], k: [zero; 3], across: [zero; 3], film: [zero; 3] }
    }

    /// Adds a node; `square`: of the slip along the groove and the creep speed.
    #[inline(always)]
    fn add<const SLOPED: bool>(
        &mut self,
        of: &Law,
        pressed: Pressed<S>,
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
        let arsinh = z.lt(z.constant(SMALL)).select(series, above.mul_add(per_root, z).ln());
        // τ_y = τ_E arsinh[η(p) s/(h τ_E)]                                (Y11)
        let a_2 = arsinh * arsinh;
        let per_both = (a_2.mul_add(a_2, pressed.fourth) + TINY).recip_fourth_root();
        // μ_f = Λ [1 + (Λ p/τ_y)⁴]^{−1/4}                                 (Y12)
        let reduced = per_both * of.film;
        let fluid = arsinh * reduced;
        // μ = ξ μ_b + (1 − ξ) μ_f                                         (Y13)
        let mu = fluid + of.boundary;
        let part = weight * per_speed;
        add_powers(&mut self.j, part * mu, s);
        if SLOPED {
            let inverse = per_speed * per_speed;
            // ∂μ/∂ln s = (1 − ξ) μ_f X⁴/(1 + X⁴) z/(√(1 + z²) arsinh z)   (Y33)
            let squared = per_both * per_both;
            let by_slip = reduced * (pressed.fourth * (squared * squared)) * (z * per_root);
            let cube = part * inverse;
            // d(μ v/s) = (μ/s) dv + (s μ' − μ)/s³ v (v·dv)                (Y33)
            add_powers(&mut self.k, cube * (mu - by_slip), s);
            add_powers(&mut self.across, cube * (mu * square + by_slip * cross), s);
            // ∂μ/∂ln h = (μ_b − μ_f/(1 − ξ)) dξ/d ln h − ∂μ/∂ln s
            let thinner = fluid * (of.falling / (1.0 - of.mixed.share).max(TINY));
            let film = thinner - of.falling * of.mixed.boundary - by_slip;
            add_powers(&mut self.film, part * film, s);
        }
    }

    /// Sums over lanes, in each of them.
    #[inline(always)]
    fn put(&self, to: &mut [Block; 12], at: usize) {
        let all = [self.j, self.k, self.across, self.film];
        for (i, sum) in all.as_flattened().iter().enumerate() {
            sum.store(&mut to[i][at..]);
        }
    }

    #[inline(always)]
    fn load(simd: S, from: &[Block; 12], at: usize) -> Self {
        let mut inner = Self::zero(simd);
        for i in 0..3 {
            inner.j[i] = Lane::load(simd, &from[i][at..]);
            inner.k[i] = Lane::load(simd, &from[i + 3][at..]);
            inner.across[i] = Lane::load(simd, &from[i + 6][at..]);
            inner.film[i] = Lane::load(simd, &from[i + 9][at..]);
        }
        inner
    }
}

/// Adds `$x s^k$`.
#[inline(always)]
fn add_powers<S: Simd>(sums: &mut [Lane<S>; 3], x: Lane<S>, s: Lane<S>) {
    let first = x * s;
    sums[0] = sums[0] + x;
    sums[1] = sums[1] + first;
    sums[2] = first.mul_add(s, sums[2]);
}

/// Sums over all lines; those of the slopes only if `SLOPED`.
struct Gather<'a, const N: usize, const SLOPED: bool> {
    nodes: &'a [Nodes<'a>; N],
    points: &'a [Point; N],
    slips: &'a [EllipseSlip<f64>; N],
    laws: [Law; N],
    bends: [Bend; N],
    totals: [[Block; ALL]; N],
    by_film: [[Block; VALUES]; N],
}

impl<const N: usize, const SLOPED: bool> Gather<'_, N, SLOPED> {
    /// The sums of a line whose spin pole is near.
    #[inline(always)]
    fn near<S: Simd>(&self, simd: S, ellipse: usize, xi: f64) -> [f64; 12] {
        let (slip, rule) = (&self.slips[ellipse], self.nodes[ellipse].rule);
        let law = &self.laws[ellipse];
        let (v_t, (b_0, b_1)) = (slip.along(xi), slip.across(xi));
        let square = Lane::<S>::splat(simd, v_t * v_t + slip.creep * slip.creep);
        let chord = super::panels::chord(xi);
        let near = Near::of(slip, xi);
        let mut sums = [[0.0; BLOCK]; 12];
        for first in (0..Near::len(rule)).step_by(BLOCK) {
            let (places, weights) = near.nodes(simd, rule, first);
            for at in (0..BLOCK).step_by(S::F64_LANES) {
                let mut inner = Inner::load(simd, &sums, at);
                let s = Lane::<S>::load(simd, &places[at..]);
                let weight = Lane::load(simd, &weights[at..]);
                let inside = (-(s * s) + 1.0).max(s.constant(0.0)).sqrt();
                let pressed = Pressed::of(&law.mixed, inside * chord);
                inner.add::<SLOPED>(law, pressed, square, s * b_1 + b_0, (s, weight));
                inner.put(&mut sums, at);
            }
        }
        let mut folded = [0.0; 12];
        fold(simd, &sums, &mut folded);
        folded
    }
}

impl<const N: usize, const SLOPED: bool> Gather<'_, N, SLOPED> {
    /// Adds the sums of an ellipse on rings.
    #[inline(always)]
    fn add_rings<S: Simd>(&mut self, simd: S, ellipse: usize, blocks: usize) {
        let slip = self.slips[ellipse].splat(simd);
        let axes = self.points[ellipse].axes(simd);
        let (rule, law) = (self.nodes[ellipse].rule, self.laws[ellipse]);
        let rings = Rings::of(simd, &self.bends[ellipse], &self.slips[ellipse], rule);
        let mut shear = [0.0; MOST_RINGS];
        let mut fourth = [0.0; MOST_RINGS];
        for i in (0..MOST_RINGS).step_by(S::F64_LANES) {
            let pressed = Pressed::of(&law.mixed, Lane::<S>::load(simd, &rings.pressure[i..]));
            pressed.shear.store(&mut shear[i..]);
            pressed.fourth.store(&mut fourth[i..]);
        }
        let [cos, sin] = &rule.angles[blocks - 1];
        let (one, part) = (slip.creep.constant(1.0), part_of_a_node(blocks));
        for i in 0..rings.count {
            let radius = Lane::splat(simd, rings.radius[i]);
            let weight = Lane::splat(simd, rings.weight[i] * part);
            let pressed = Pressed {
                shear: Lane::splat(simd, shear[i]),
                fourth: Lane::splat(simd, fourth[i]),
            };
            for first in (0..cos.len()).step_by(S::F64_LANES) {
                let xi = radius * Lane::load(simd, &cos[first..]);
                // A line with a node at each end.
                let chord = radius * Lane::load(simd, &sin[first..]);
                let (v_t, (b_0, b_1)) = (slip.along(xi), slip.across_at(xi, chord));
                let square = v_t * v_t + slip.creep * slip.creep;
                let mut inner = Inner::zero(simd);
                inner.add::<SLOPED>(&law, pressed, square, b_0 + b_1, (one, weight));
                inner.add::<SLOPED>(&law, pressed, square, b_0 - b_1, (-one, weight));
                let line = Line { xi, weight: one, chord, v_t, across: (b_0, b_1) };
                self.add_line(simd, ellipse, first % BLOCK, (&line, inner), (axes, &slip));
            }
        }
    }

    /// Adds the sums of a few lines.
    #[inline(always)]
    fn add_line<S: Simd>(
        &mut self,
        simd: S,
        ellipse: usize,
        at: usize,
        (line, Inner { j, k, across, film }): (&Line<S>, Inner<S>),
        of: Shape<'_, S>,
    ) {
        let terms = line.terms::<SLOPED>(of, [j, k, across]);
        add_to(simd, &mut self.totals[ellipse], at, &terms[..some::<SLOPED>()]);
        if SLOPED {
            let weight = line.weight;
            let film = [film[0] * weight, film[1] * weight, film[2] * weight];
            add_to(simd, &mut self.by_film[ellipse], at, &line.values(of, film));
        }
    }
}

impl<S: Simd, const N: usize, const SLOPED: bool> Visit<S> for Gather<'_, N, SLOPED> {
    #[inline(always)]
    fn visit(&mut self, simd: S, ellipse: usize, lines: &Lines) {
        let slip = self.slips[ellipse].splat(simd);
        let axes = self.points[ellipse].axes(simd);
        let (rule, law) = (self.nodes[ellipse].rule, self.laws[ellipse]);
        for at in (0..BLOCK).step_by(S::F64_LANES) {
            let xi = Lane::<S>::load(simd, &lines.xi[at..]);
            let weight = Lane::<S>::load(simd, &lines.weight[at..]);
            let chord = Lane::<S>::load(simd, &lines.chord[at..]);
            let (v_t, (b_0, b_1)) = (slip.along(xi), slip.across_at(xi, chord));
            let square = v_t * v_t + slip.creep * slip.creep;
            let mut inner = Inner::zero(simd);
            let half = Half::of(&self.bends[ellipse], &slip, xi);
            for k in 0..rule.half.len() {
                let Node { s, pressure, weight } = half.node(rule.half.at(k));
                let pressed = Pressed::of(&law.mixed, pressure * chord);
                let turned = b_1 * s;
                inner.add::<SLOPED>(&law, pressed, square, b_0 + turned, (s, weight));
                inner.add::<SLOPED>(&law, pressed, square, b_0 - turned, (-s, weight));
            }
            if lines.any_inside {
                let mut sums = [[0.0; BLOCK]; 12];
                inner.put(&mut sums, at);
                for i in at..(at + S::F64_LANES) {
                    if lines.inside[i] {
                        let near = self.near(simd, ellipse, lines.xi[i]);
                        for (sum, near) in sums.iter_mut().zip(near) {
                            sum[i] = near;
                        }
                    }
                }
                inner = Inner::load(simd, &sums, at);
            }
            let line = Line { xi, weight, chord, v_t, across: (b_0, b_1) };
            self.add_line(simd, ellipse, at, (&line, inner), (axes, &slip));
        }
    }
}

/// One of the ellipses.
struct Only<'a, G>(&'a mut G, usize);

impl<S: Simd, G: Visit<S>> Visit<S> for Only<'_, G> {
    #[inline(always)]
    fn visit(&mut self, simd: S, _ellipse: usize, lines: &Lines) {
        self.0.visit(simd, self.1, lines);
    }
}

impl OiledSums {
    /// Those of a few contacts; slopes only if `SLOPED`, else zero.
    #[inline(always)]
    pub(crate) fn along<S: Simd, const N: usize, const SLOPED: bool>(
        simd: S,
        points: &[Point; N],
        laws: &[MixedFriction; N],
        nodes: &[Nodes<'_>; N],
    ) -> [Self; N] {
        let mut slips = [points[0].slip(); N];
        let mut bends = [Bend::of(&laws[0]); N];
        let mut known = [Law::of(laws[0]); N];
        for i in 0..N {
            slips[i] = points[i].slip();
            bends[i] = Bend::of(&laws[i]);
            known[i] = Law::of(laws[i]);
        }
        let mut gathered = Gather::<N, SLOPED> {
            nodes,
            points,
            slips: &slips,
            laws: known,
            bends,
            totals: [[[0.0; BLOCK]; ALL]; N],
            by_film: [[[0.0; BLOCK]; VALUES]; N],
        };
        for i in 0..N {
            match nodes[i].blocks(&slips[i]) {
                0 => walk(simd, nodes[i], &slips[i], &mut Only(&mut gathered, i)),
                blocks => {
                    gathered.add_rings(simd, i, blocks);
                    nodes[i].keep(Plan { blocks, ..Plan::default() });
                }
            }
        }
        let mut all = [Self { sums: Sums::none(0.0), by_film: [0.0; SUMS] }; N];
        for (i, found) in all.iter_mut().enumerate() {
            let mut sums = [0.0; ALL];
            let some = some::<SLOPED>();
            fold(simd, &gathered.totals[i][..some], &mut sums[..some]);
            found.sums = Sums::of(sums, &points[i]);
            if SLOPED {
                fold(simd, &gathered.by_film[i][..SUMS], &mut found.by_film);
            }
        }
        all
    }
}
