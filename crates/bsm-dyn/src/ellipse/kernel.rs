//! The sums of the friction over an ellipse, with derivatives, for several nodes at once.
//!
//! The law is that of [`Ellipse::integrate`](super::Ellipse::integrate), which tests this.

#![expect(
    clippy::inline_always,
    reason = "code takes the instruction set of its caller only inline"
)]

use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI};

use bsm_simd::{Arch, BLOCK, Block, Compare, Lane, NullaryFnOnce, Simd, WithSimd};

use super::Quadrature;
use super::oil::{Bend, Half, Node, Rings};
use super::panels::{EllipseSlip, FAR, Lines, Nodes, Visit, chord, walk, walk_along};

/// What the sums depend on: a contact with numbers in its own axes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Point<F = f64> {
    /// Semi-axes across and along the groove.
    pub(crate) semi_axes: (F, F),
    /// Radius of the pressed surface.
    pub(crate) pressed_radius: F,
    /// Ball radius.
    pub(crate) ball_radius: F,
    /// Speed of the centre along t; angular velocity about t, N, t × N.
    pub(crate) motion: [F; MOTION],
    /// Creep speed.
    pub(crate) creep: F,
}

/// Friction over `$f Q$` of a contact.
#[derive(Clone, Copy)]
pub(crate) struct Sums<F = f64> {
    /// Force along t and t × N; moment about t, N, t × N.
    pub(crate) values: [F; SUMS],
    /// The power that it takes.
    pub(crate) power: F,
    /// Their derivatives, but not that of the power: by the motion, and by the logarithm of the size of the
    /// ellipse.
    pub(crate) slopes: [[F; SLOPES]; SUMS],
}

/// Numbers of the motion, sums, and derivatives: by the motion and by the growth of both semi-axes.
pub(crate) const MOTION: usize = 4;
pub(crate) const SUMS: usize = 5;
pub(crate) const SLOPES: usize = MOTION + 1;

/// Sums and power; the same with what the derivatives are made of.
pub(super) const VALUES: usize = SUMS + 1;
pub(super) const ALL: usize = VALUES + 14;

impl<F: Compare> Point<F> {
    /// Slip along the long axis.
    #[inline(always)]
    pub(super) fn slip(&self) -> EllipseSlip<F> {
        let ([speed, w_t, w_n, w_c], radii) =
            (self.motion, (self.pressed_radius, self.ball_radius));
        EllipseSlip::new(self.semi_axes, radii, speed, [w_t, w_n, w_c], self.creep)
    }
}

/// The nodes of a line whose spin pole is inside the ellipse.
pub(super) struct Near {
    /// The angle of the pole, and its width.
    at: f64,
    width: f64,
    /// Beginnings and lengths of both sides in the variable of the sinh transformation.
    sides: [(f64, f64); 2],
}

impl Near {
    pub(super) fn of(slip: &EllipseSlip<f64>, xi: f64) -> Self {
        let sinh = slip.analyticity(xi).sqrt();
        let (b_0, b_1) = slip.across(xi);
        // s = cos φ, about φ₀ with cos φ₀ = −Re z/cosh η and the width η: η ≈ sinh η  (T20)
        let cos = -(b_0 / b_1) / sinh.mul_add(sinh, 1.0).sqrt();
        let at = if cos.is_nan() { FRAC_PI_2 } else { cos.clamp(-1.0, 1.0).acos() };
        let width = sinh.clamp(1e-100, FAR);
        let below = (-at / width).asinh();
        Self { at, width, sides: [(below, -below), (0.0, ((PI - at) / width).asinh())] }
    }

    /// How many nodes.
    pub(super) fn len(rule: &Quadrature) -> usize {
        2 * rule.near.len()
    }

    /// Places and weights from node `first` on, without weight beyond the last.
    #[inline(always)]
    pub(super) fn nodes<S: Simd>(
        &self,
        simd: S,
        rule: &Quadrature,
        first: usize,
    ) -> (Block, Block) {
        let (mut places, mut weights) = ([0.0; BLOCK], [0.0; BLOCK]);
        for i in 0..BLOCK {
            let node = first + i;
            let (side, node) =
                if node < rule.near.len() { (0, node) } else { (1, node - rule.near.len()) };
            if node < rule.near.len() {
                let ((from, length), (place, part)) = (self.sides[side], rule.near.at(node));
                (places[i], weights[i]) = (from + length * place, length * part);
            }
        }
        for i in (0..BLOCK).step_by(S::F64_LANES) {
            let grow = Lane::<S>::load(simd, &places[i..]).exp();
            let fall = grow.recip();
            let half = grow.constant(0.5 * self.width);
            let phi =
                (half * (grow - fall) + self.at).max(half.constant(0.0)).min(half.constant(PI));
            let left = phi.gt(phi.constant(FRAC_PI_2));
            let (sin, cos) = left.select(-phi + PI, phi).sin_cos_first_quadrant();
            let weight = Lane::load(simd, &weights[i..]) * half * (grow + fall);
            left.select(-cos, cos).store(&mut places[i..]);
            (weight * (sin * sin) * (2.0 * FRAC_1_PI)).store(&mut weights[i..]);
        }
        (places, weights)
    }
}

/// Sums along lines across the ellipse (T21).
#[derive(Clone, Copy)]
pub(super) struct Inner<S: Simd> {
    pub(super) j: [Lane<S>; 3],
    pub(super) k: [Lane<S>; 3],
}

impl<S: Simd> Inner<S> {
    #[inline(always)]
    pub(super) fn zero(simd: S) -> Self {
        let zero = Lane::splat(simd, 0.0);
        Self { j: [zero; 3], k: [zero; 3] }
    }

    /// Adds nodes of the same places on all lines.
    #[inline(always)]
    fn add_all<const SLOPED: bool, const ROUGH: bool>(
        &mut self,
        simd: S,
        square: Lane<S>,
        across: (Lane<S>, Lane<S>),
        nodes: &[(f64, f64)],
    ) {
        for (s, weight) in nodes {
            let node = (Lane::splat(simd, *s), Lane::splat(simd, *weight));
            self.add::<SLOPED, ROUGH>(square, across, node);
        }
    }

    /// Adds a node, to rounding or, if `ROUGH`, to the error of a rough root.
    ///
    /// * `square`: of the slip along the groove and the creep speed.
    #[inline(always)]
    pub(super) fn add<const SLOPED: bool, const ROUGH: bool>(
        &mut self,
        square: Lane<S>,
        (b_0, b_1): (Lane<S>, Lane<S>),
        (s, weight): (Lane<S>, Lane<S>),
    ) {
        let v_c = b_1.mul_add(s, b_0);
        // q = (v_t² + v_e² + (b₀ + b₁ s)²)^{−1/2}
        let all = v_c.mul_add(v_c, square);
        let per_speed = if ROUGH { all.rough_recip_sqrt() } else { all.recip_sqrt() };
        // J_k = Σ w sᵏ q,  K_k = Σ w sᵏ q³,  k = 0, 1, 2                 (T21)
        let q = weight * per_speed;
        let q_s = q * s;
        self.j[0] = self.j[0] + q;
        self.j[1] = self.j[1] + q_s;
        self.j[2] = q_s.mul_add(s, self.j[2]);
        if SLOPED {
            let cube = q * (per_speed * per_speed);
            let cube_s = cube * s;
            self.k[0] = self.k[0] + cube;
            self.k[1] = self.k[1] + cube_s;
            self.k[2] = cube_s.mul_add(s, self.k[2]);
        }
    }
}

/// Sums over all lines; those of the slopes only if `SLOPED`.
struct Gather<'a, const N: usize, const SLOPED: bool> {
    nodes: &'a [Nodes<'a>; N],
    points: &'a [Point; N],
    slips: &'a [EllipseSlip<f64>; N],
    totals: [[Block; ALL]; N],
}

impl<const N: usize, const SLOPED: bool> Gather<'_, N, SLOPED> {
    /// The sums (T21) of a line whose spin pole is inside: rare, so that its code is out of the way.
    #[inline(always)]
    fn near<S: Simd>(&self, simd: S, ellipse: usize, xi: f64) -> [f64; 6] {
        let (slip, rule) = (&self.slips[ellipse], self.nodes[ellipse].rule);
        simd.vectorize(NearLine::<S, SLOPED> { simd, rule, slip, xi })
    }
}

struct NearLine<'a, S, const SLOPED: bool> {
    simd: S,
    rule: &'a Quadrature,
    slip: &'a EllipseSlip<f64>,
    xi: f64,
}

impl<S: Simd, const SLOPED: bool> NullaryFnOnce for NearLine<'_, S, SLOPED> {
    type Output = [f64; 6];

    #[inline(always)]
    fn call(self) -> [f64; 6] {
        let Self { simd, rule, slip, xi } = self;
        let (v_t, (b_0, b_1)) = (slip.along(xi), slip.across(xi));
        let s = (Lane::splat(simd, b_0), Lane::splat(simd, b_1));
        let square = Lane::splat(simd, v_t * v_t + slip.creep * slip.creep);
        let near = Near::of(slip, xi);
        let mut sums = [[0.0; BLOCK]; 6];
        for first in (0..Near::len(rule)).step_by(BLOCK) {
            let (places, weights) = near.nodes(simd, rule, first);
            for i in (0..BLOCK).step_by(S::F64_LANES) {
                let mut inner = Inner::load(simd, &sums, i);
                let node = (Lane::load(simd, &places[i..]), Lane::load(simd, &weights[i..]));
                inner.add::<SLOPED, false>(square, s, node);
                inner.store(&mut sums, i);
            }
        }
        let mut folded = [0.0; 6];
        fold(simd, &sums, &mut folded);
        folded
    }
}

impl<S: Simd> Inner<S> {
    #[inline(always)]
    fn load(simd: S, from: &[Block; 6], i: usize) -> Self {
        let mut inner = Self::zero(simd);
        for k in 0..3 {
            inner.j[k] = Lane::load(simd, &from[k][i..]);
            inner.k[k] = Lane::load(simd, &from[k + 3][i..]);
        }
        inner
    }

    #[inline(always)]
    fn store(self, to: &mut [Block; 6], i: usize) {
        for k in 0..3 {
            self.j[k].store(&mut to[k][i..]);
            self.k[k].store(&mut to[k + 3][i..]);
        }
    }
}

/// Sums over blocks, in the same order for all widths.
#[inline(always)]
pub(super) fn fold<S: Simd>(simd: S, blocks: &[Block], sums: &mut [f64]) {
    for (sum, block) in sums.iter_mut().zip(blocks) {
        // One of them is as long as a block.
        *sum = match S::F64_LANES {
            1 => Lane::<S, 8>::load(simd, block).sum(),
            2 => Lane::<S, 4>::load(simd, block).sum(),
            4 => Lane::<S, 2>::load(simd, block).sum(),
            _ => Lane::<S, 1>::load(simd, block).sum(),
        };
    }
}

impl<S: Simd, const N: usize, const SLOPED: bool> Visit<S> for Gather<'_, N, SLOPED> {
    #[inline(always)]
    fn visit(&mut self, simd: S, ellipse: usize, lines: &Lines) {
        let slip = self.slips[ellipse].splat(simd);
        let axes = self.points[ellipse].axes(simd);
        let rule = self.nodes[ellipse].rule;
        for at in (0..BLOCK).step_by(S::F64_LANES) {
            let xi = Lane::<S>::load(simd, &lines.xi[at..]);
            let weight = Lane::<S>::load(simd, &lines.weight[at..]);
            let chord = Lane::<S>::load(simd, &lines.chord[at..]);
            let (v_t, (b_0, b_1)) = (slip.along(xi), slip.across_at(xi, chord));
            let square = v_t * v_t + slip.creep * slip.creep;
            let mut inner = Inner::zero(simd);
            let across = lines.inner.map_or(&[][..], |count| &rule.inner[count]);
            if self.nodes[ellipse].rough {
                inner.add_all::<SLOPED, true>(simd, square, (b_0, b_1), across);
            } else {
                inner.add_all::<SLOPED, false>(simd, square, (b_0, b_1), across);
            }
            if lines.any_inside {
                let mut sums = [[0.0; BLOCK]; 6];
                inner.store(&mut sums, at);
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
            let terms = line.terms::<SLOPED>((axes, &slip), inner.with_across(square));
            add_to(simd, &mut self.totals[ellipse], at, &terms[..some::<SLOPED>()]);
        }
    }
}

/// Semi-axes of an ellipse, and the slip over it.
pub(super) type Shape<'a, S> = ((Lane<S>, Lane<S>), &'a EllipseSlip<Lane<S>>);

/// A few lines across an ellipse.
pub(super) struct Line<S: Simd> {
    /// Place on the long axis, part of the load, and half the length.
    pub(super) xi: Lane<S>,
    pub(super) weight: Lane<S>,
    pub(super) chord: Lane<S>,
    /// Slip along the groove, and across it (T13).
    pub(super) v_t: Lane<S>,
    pub(super) across: (Lane<S>, Lane<S>),
}

impl<S: Simd> Line<S> {
    /// Force, moment and power of sums J (T21).
    ///
    /// * `axes`: semi-axes.
    #[inline(always)]
    pub(super) fn values(
        &self,
        ((a, b), slip): Shape<'_, S>,
        j: [Lane<S>; 3],
    ) -> [Lane<S>; VALUES] {
        let &Self { xi, chord, v_t, across: (b_0, b_1), .. } = self;
        // T = v_t J₀,  C = b₀ J₀ + b₁ J₁,  S = b₀ J₁ + b₁ J₂
        let (t, c, s) = (v_t * j[0], b_0 * j[0] + b_1 * j[1], b_0 * j[1] + b_1 * j[2]);
        let (x, y, h) = (xi * a, chord * b, slip.height(xi));
        // F_t = −T,  F_c = C,  M_t = −h C,  M_n = −(x T + Y S),  M_c = −h T,
        // P = v_t T + b₀ C + b₁ S                                         (T22)
        [-t, c, -(h * c), -(x * t + y * s), -(h * t), v_t * t + b_0 * c + b_1 * s]
    }

    /// Values and, if `SLOPED`, what the derivatives are made of, by the sums J along the lines, K, and those by
    /// the slip across (T23).
    #[inline(always)]
    pub(super) fn terms<const SLOPED: bool>(
        &self,
        of: Shape<'_, S>,
        [j, k, across]: [[Lane<S>; 3]; 3],
    ) -> [Lane<S>; ALL] {
        let &Self { xi, weight, chord, v_t, across: (b_0, b_1) } = self;
        let j = [j[0] * weight, j[1] * weight, j[2] * weight];
        let [f_t, f_c, m_t, m_n, m_c, power] = self.values(of, j);
        if !SLOPED {
            let mut terms = [weight.constant(0.0); ALL];
            (terms[0], terms[1], terms[2]) = (f_t, f_c, m_t);
            (terms[3], terms[4], terms[5]) = (m_n, m_c, power);
            return terms;
        }
        let ((a, b), slip) = of;
        let (x, y, h) = (xi * a, chord * b, slip.height(xi));
        let k = [k[0] * weight, k[1] * weight, k[2] * weight];
        // T_v = J₀ − v_t² K₀,  T_b = −v_t (b₀ K₀ + b₁ K₁),  T_s = −v_t (b₀ K₁ + b₁ K₂)  (T23)
        let t_v = j[0] - v_t * v_t * k[0];
        let t_b = -(v_t * (b_0 * k[0] + b_1 * k[1]));
        let t_s = -(v_t * (b_0 * k[1] + b_1 * k[2]));
        let (c_b, c_s, s_s) = (across[0] * weight, across[1] * weight, across[2] * weight);
        let (t_n, c_n) = (t_v * x + t_s * y, t_b * x + c_s * y);
        let n_n = x * t_n + y * (t_s * x + s_s * y);
        let (t_vh, t_bh, c_bh) = (t_v * h, t_b * h, c_b * h);
        [
            f_t,
            f_c,
            m_t,
            m_n,
            m_c,
            power,
            t_v,
            t_vh,
            t_vh * h,
            t_b,
            t_bh,
            t_bh * h,
            c_b,
            c_bh,
            c_bh * h,
            t_n,
            t_n * h,
            c_n,
            c_n * h,
            n_n,
        ]
    }
}

/// How many of the terms are not zero.
#[inline(always)]
pub(super) const fn some<const SLOPED: bool>() -> usize {
    if SLOPED { ALL } else { VALUES }
}

impl Point {
    /// The semi-axes.
    #[inline(always)]
    pub(super) fn axes<S: Simd>(&self, simd: S) -> (Lane<S>, Lane<S>) {
        (Lane::splat(simd, self.semi_axes.0), Lane::splat(simd, self.semi_axes.1))
    }
}

impl<S: Simd> Inner<S> {
    /// J, K, and those by the slip across.
    #[inline(always)]
    pub(super) fn with_across(self, square: Lane<S>) -> [[Lane<S>; 3]; 3] {
        let Self { j, k } = self;
        // (C_b, C_s, S_s) = (v_t² + v_e²) (K₀, K₁, K₂)                    (T23)
        [j, k, [square * k[0], square * k[1], square * k[2]]]
    }
}

/// Adds to totals.
#[inline(always)]
pub(super) fn add_to<S: Simd>(simd: S, totals: &mut [Block], at: usize, values: &[Lane<S>]) {
    for (total, value) in totals.iter_mut().zip(values) {
        (Lane::load(simd, &total[at..]) + *value).store(&mut total[at..]);
    }
}

impl<F: Compare> Sums<F> {
    #[inline(always)]
    pub(crate) fn none(zero: F) -> Self {
        Self { values: [zero; SUMS], power: zero, slopes: [[zero; SLOPES]; SUMS] }
    }

    /// Of the sums of all terms at a point.
    #[inline(always)]
    pub(super) fn of(all: [F; ALL], point: &Point<F>) -> Self {
        let [
            f_t,
            f_c,
            m_t,
            m_n,
            m_c,
            power,
            // T_v, T_b and C_b, and the same times h and h².
            t_v,
            t_vh,
            t_vhh,
            t_b,
            t_bh,
            t_bhh,
            c_b,
            c_bh,
            c_bhh,
            // T, the same times h, C and the moment by the spin.
            t_n,
            t_nh,
            c_n,
            c_nh,
            n_n,
        ] = all;
        let ([_, w_t, w_n, w_c], r) = (point.motion, point.ball_radius);
        // With the growth of the ellipse x and Y grow alike, and h by dh = 2 (h − r_b).
        let (by_t, by_c) = (w_t * 2.0, w_c * 2.0);
        let t_g = w_n * t_n + by_c * (t_vh - r * t_v) + by_t * (t_bh - r * t_b);
        let c_g = w_n * c_n + by_c * (t_bh - r * t_b) + by_t * (c_bh - r * c_b);
        let t_gh = w_n * t_nh + by_c * (t_vhh - r * t_vh) + by_t * (t_bhh - r * t_bh);
        let c_gh = w_n * c_nh + by_c * (t_bhh - r * t_bh) + by_t * (c_bhh - r * c_bh);
        let n_g = w_n * n_n + by_c * (t_nh - r * t_n) + by_t * (c_nh - r * c_n);
        // Friction has a potential in the motion.
        let slopes = [
            [-t_v, -t_bh, -t_n, -t_vh, -t_g],
            [t_b, c_bh, c_n, t_bh, c_g],
            [-t_bh, -c_bhh, -c_nh, -t_bhh, (m_t + r * f_c) * 2.0 - c_gh],
            [-t_n, -c_nh, -n_n, -t_nh, m_n - n_g],
            [-t_vh, -t_bhh, -t_nh, -t_vhh, (m_c - r * f_t) * 2.0 - t_gh],
        ];
        Self { values: [f_t, f_c, m_t, m_n, m_c], power, slopes }
    }
}

impl Sums {
    /// Those of a few contacts; slopes only if `SLOPED`, else zero.
    #[inline(always)]
    pub(crate) fn along<S: Simd, const N: usize, const SLOPED: bool>(
        simd: S,
        points: &[Point; N],
        nodes: &[Nodes<'_>; N],
    ) -> [Self; N] {
        let mut sums = [Self::none(0.0); N];
        let all = all::<S, N, SLOPED>(simd, points, nodes);
        for (i, sums) in sums.iter_mut().enumerate() {
            *sums = Self::of(all[i], &points[i]);
        }
        sums
    }
}

#[inline(always)]
fn all<S: Simd, const N: usize, const SLOPED: bool>(
    simd: S,
    points: &[Point; N],
    nodes: &[Nodes<'_>; N],
) -> [[f64; ALL]; N] {
    let mut slips = [points[0].slip(); N];
    for (slip, point) in slips.iter_mut().zip(points) {
        *slip = point.slip();
    }
    let totals = [[[0.0; BLOCK]; ALL]; N];
    let mut gathered = Gather::<N, SLOPED> { nodes, points, slips: &slips, totals };
    walk_along(simd, nodes, &slips, &mut gathered);
    let mut sums = [[0.0; ALL]; N];
    for (sums, totals) in sums.iter_mut().zip(&gathered.totals) {
        let some = some::<SLOPED>();
        fold(simd, &totals[..some], &mut sums[..some]);
    }
    sums
}

/// Sums of one contact.
pub(super) fn sums<const SLOPED: bool>(point: &Point, nodes: Nodes<'_>) -> Sums {
    Sums::of(Arch::new().dispatch(Total::<SLOPED>(point, nodes)), point)
}

/// All sums on an instruction set.
#[cfg(test)]
pub(super) fn all_on(arch: Arch, point: &Point, rule: &Quadrature) -> [f64; ALL] {
    arch.dispatch(Total::<true>(point, rule.into()))
}

struct Total<'a, const SLOPED: bool>(&'a Point, Nodes<'a>);

impl<const SLOPED: bool> WithSimd for Total<'_, SLOPED> {
    type Output = [f64; ALL];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let [sums] = all::<S, 1, SLOPED>(simd, &[*self.0], &[self.1]);
        sums
    }
}

/// Coordinates over the semi-axes and part of the load of all nodes: those of the sums of a constant
/// coefficient, or of one that bends.
pub(super) fn nodes(point: &Point, nodes: Nodes<'_>, bend: Option<&Bend>) -> Vec<(f64, f64, f64)> {
    Arch::new().dispatch(List(point, nodes, bend))
}

struct List<'a>(&'a Point, Nodes<'a>, Option<&'a Bend>);

/// The nodes of all lines, one by one.
struct Collect<'a> {
    rule: &'a Quadrature,
    slip: EllipseSlip<f64>,
    bend: Option<&'a Bend>,
    nodes: Vec<(f64, f64, f64)>,
}

impl<S: Simd> Visit<S> for Collect<'_> {
    #[inline(always)]
    fn visit(&mut self, simd: S, _ellipse: usize, lines: &Lines) {
        for (i, (xi, weight)) in lines.xi.into_iter().zip(lines.weight).enumerate() {
            let chord = chord(xi);
            let mut add = |s: f64, part: f64| self.nodes.push((xi, chord * s, weight * part));
            if lines.inside[i] {
                let near = Near::of(&self.slip, xi);
                for first in (0..Near::len(self.rule)).step_by(BLOCK) {
                    let (places, parts) = near.nodes(simd, self.rule, first);
                    places.into_iter().zip(parts).for_each(|(s, part)| add(s, part));
                }
            } else if let Some(bend) = self.bend {
                let slip = self.slip.splat(simd);
                let half = Half::of(bend, &slip, Lane::<S>::splat(simd, xi));
                for k in 0..self.rule.half.len() {
                    let Node { s, weight, .. } = half.node(self.rule.half.at(k));
                    let (s, part) = (s.as_slice()[0], weight.as_slice()[0]);
                    add(s, part);
                    add(-s, part);
                }
            } else if let Some(count) = lines.inner {
                self.rule.inner[count].iter().for_each(|(s, part)| add(*s, *part));
            }
        }
        self.nodes.retain(|(_, _, weight)| *weight != 0.0);
    }
}

impl WithSimd for List<'_> {
    type Output = Vec<(f64, f64, f64)>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self(point, nodes, bend) = self;
        if let (Some(bend), blocks @ 1..) = (bend, nodes.blocks(&point.slip())) {
            return Rings::of(simd, bend, &point.slip(), nodes.rule).nodes(nodes.rule, blocks);
        }
        let mut list = Collect { rule: nodes.rule, slip: point.slip(), bend, nodes: Vec::new() };
        walk(simd, nodes, &point.slip(), &mut list);
        list.nodes
    }
}
