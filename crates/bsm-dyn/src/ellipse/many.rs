//! The sums of the friction over the ellipses of several contacts side by side, with derivatives.
//!
//! Nodes and sums are those of one contact in `panels.rs` and `kernel.rs`, up to rounding: eight neighbouring
//! lines share the largest of their numbers of inner nodes, at each contact by itself.

#![expect(
    clippy::inline_always,
    reason = "code takes the instruction set of its caller only inline"
)]

use std::ops::Range;

use bsm_simd::{BLOCK, Lane, Mask, Simd, WithSimd};

use super::Quadrature;
use super::panels::{EllipseSlip, MOST_INNER, chord, clamp, line};

/// Most contacts side by side.
const MANY: usize = 4 * BLOCK;

/// Most nodes of a panel: up to an accuracy of 1e-10.
const MOST_NODES: usize = 20;

/// Most groups of lines with the same number of inner nodes.
const GROUPS: usize = (2 * MOST_NODES).div_ceil(BLOCK);

/// A quadrature for several contacts side by side.
#[derive(Debug, Clone, PartialEq)]
pub struct ManyQuadrature {
    rule: Quadrature,
    segments: Vec<Segment>,
}

/// Neighbouring lines of a panel that share their inner nodes.
#[derive(Debug, Clone, PartialEq)]
struct Segment {
    panel: usize,
    lines: Range<usize>,
    /// Which of the numbers of inner nodes they have, where the first panel has a length and where not.
    groups: [usize; 2],
}

/// Numbers of inner nodes of several contacts.
#[derive(Debug, Clone, Copy)]
pub struct InnerNodes([[u8; MANY]; GROUPS]);

impl Default for InnerNodes {
    fn default() -> Self {
        Self([[0; MANY]; GROUPS])
    }
}

/// A loaded contact in its own axes, in units of ball radius, and the motion over it.
#[derive(Debug, Clone, Copy)]
pub struct ContactMotion<F> {
    /// Semi-axes across and along the groove.
    pub semi_axes: (F, F),
    /// Radius of the pressed surface (E2).
    pub pressed_radius: F,
    /// Speed of the centre along `$t$`.
    pub speed: F,
    /// Angular velocity about `$t$`, `$N$` and `$t \times N$`.
    pub omega: [F; 3],
    /// `$v_e$`.
    pub creep: F,
}

/// Friction over `$f Q$` of several contacts: force along `$t$` and `$t \times N$`, moment about the ball centre,
/// about `$t$`, `$N$` and `$t \times N$`, and their derivatives.
#[derive(Clone, Copy)]
pub struct ManyFrictions<F> {
    /// Force and moment.
    pub wrench: [F; 5],
    /// The power that they take.
    pub power: F,
    /// Derivatives of the wrench by the speed of the centre and the angular velocity.
    pub by_motion: [[F; 4]; 5],
    /// Derivatives of the wrench by the logarithm of the size of the ellipse.
    pub by_growth: [F; 5],
}

/// Sums over lines: wrench and power, then what the derivatives are made of.
const VALUES: usize = 6;
const SLOPES: usize = 19;

impl ManyQuadrature {
    /// That of an accuracy, [`Quadrature::of`]; none if it takes more nodes than there is room for.
    pub fn of(accuracy: f64) -> Option<Self> {
        Self::new(Quadrature::of(accuracy))
    }

    /// The one that its error is told from.
    pub fn check(accuracy: f64) -> Option<Self> {
        Self::new(Quadrature::check(accuracy))
    }

    fn new(rule: Quadrature) -> Option<Self> {
        let nodes = rule.panel.len();
        if nodes > MOST_NODES {
            return None;
        }
        let mut segments: Vec<Segment> = Vec::new();
        for line in 0..2 * nodes {
            let (panel, node) = (line / nodes, line % nodes);
            let groups = [line / BLOCK, node / BLOCK];
            match segments.last_mut() {
                Some(last) if last.panel == panel && last.groups == groups => last.lines.end += 1,
                _ => segments.push(Segment { panel, lines: node..node + 1, groups }),
            }
        }
        Some(Self { rule, segments })
    }

    /// Frictions, and the contacts whose friction the rule resolves without splitting panels.
    ///
    /// * `inner`: the numbers of nodes along the lines, as they are if `planned`, by the slip otherwise.
    #[inline(always)]
    pub fn frictions<S: Simd, const N: usize, const SLOPED: bool>(
        &self,
        simd: S,
        contact: &ContactMotion<Lane<S, N>>,
        inner: &mut InnerNodes,
        planned: bool,
    ) -> (ManyFrictions<Lane<S, N>>, Mask<S, N>) {
        // A call of its own: the code is long.
        simd.vectorize(Call::<S, N, SLOPED> { quadrature: self, contact, inner, planned })
    }

    #[inline(always)]
    fn summed<S: Simd, const N: usize, const SLOPED: bool>(
        &self,
        contact: &ContactMotion<Lane<S, N>>,
        inner: &mut InnerNodes,
        planned: bool,
    ) -> (ManyFrictions<Lane<S, N>>, Mask<S, N>) {
        let zero = contact.creep.constant(0.0);
        let one = zero.constant(1.0);
        let radii = (contact.pressed_radius, one);
        let &ContactMotion { semi_axes, speed, omega, creep, .. } = contact;
        let slip = EllipseSlip::new(semi_axes, radii, speed, omega, creep);
        let poles = slip.poles();
        let middle = clamp((poles[0].at + poles[1].at) * 0.5, -1.0, 1.0);
        let ends = [-one, middle, one];
        let second_only = middle.le(-one);
        let mut lines = [[(zero, zero); MOST_NODES]; 2];
        let mut least = [zero.constant(f64::INFINITY); GROUPS];
        let narrow = one * self.rule.reach[MOST_INNER];
        let mut resolved = zero.le(zero);
        for panel in 0..2 {
            let (pole, low, high) = (poles[panel], ends[panel], ends[panel + 1]);
            // τ from arsinh((lo − ξ_j)/δ_j) to arsinh((hi − ξ_j)/δ_j)     (T17)
            let from = ((low - pole.at) / pole.width).arsinh();
            let length = ((high - pole.at) / pole.width).arsinh() - from;
            let nodes = self.rule.panel.len();
            for (node, known) in lines[panel].iter_mut().enumerate().take(nodes) {
                let (place, part) = self.rule.panel.at(node);
                *known = line(&pole, length * place + from, length * part);
            }
            if !planned {
                let within = low.lt(pole.at) & pole.at.lt(high);
                resolved = resolved & (!within | narrow.le(slip.analyticity(pole.at)));
                let empty = high.le(low);
                for (node, (xi, _)) in lines[panel].iter().enumerate().take(nodes) {
                    let square = slip.analyticity(*xi);
                    let square = empty.select(one * f64::INFINITY, square);
                    resolved = resolved & narrow.le(square);
                    let groups = [(panel * nodes + node) / BLOCK, node / BLOCK];
                    // Lines of the second panel begin a group where the first has no length.
                    let [first, second] = if panel == 0 { [groups[0]; 2] } else { groups };
                    if first == second {
                        least[first] = least[first].min(square);
                    } else {
                        let only = second_only.select(square, one * f64::INFINITY);
                        let after = second_only.select(one * f64::INFINITY, square);
                        least[second] = least[second].min(only);
                        least[first] = least[first].min(after);
                    }
                }
            }
        }
        if !planned {
            for (counts, least) in inner.0.iter_mut().zip(&least) {
                for (count, square) in counts.iter_mut().zip(least.as_slice()) {
                    *count = self.count(*square);
                }
            }
        }
        let mut second = [0.0; MANY];
        second_only.to_numbers().store(&mut second);
        let mut totals = [zero; VALUES + SLOPES];
        let mut nodes = [(zero, zero); MOST_INNER + 1];
        for segment in &self.segments {
            let (mut counts, mut most) = ([0; MANY], 0);
            for i in 0..Lane::<S, N>::LEN {
                let group = segment.groups[usize::from(second[i] > 0.5)];
                counts[i] = usize::from(inner.0[group][i]);
                most = most.max(self.rule.inner[counts[i]].len());
            }
            for (k, node) in nodes.iter_mut().enumerate().take(most) {
                let (mut places, mut parts) = ([0.0; MANY], [0.0; MANY]);
                for i in 0..Lane::<S, N>::LEN {
                    if let Some((place, part)) = self.rule.inner[counts[i]].get(k) {
                        (places[i], parts[i]) = (*place, *part);
                    }
                }
                *node = (zero.like(&places), zero.like(&parts));
            }
            for node in segment.lines.clone() {
                let (xi, weight) = lines[segment.panel][node];
                add_line::<S, N, SLOPED>(&mut totals, &slip, contact, (xi, weight), &nodes[..most]);
            }
        }
        (ManyFrictions::of(&totals), resolved)
    }

    /// Number of inner nodes, for places and weights, of lines with this square of `$\sinh\eta$`.
    #[inline(always)]
    fn count(&self, square: f64) -> u8 {
        let count = self.rule.count(square).unwrap_or(0);
        u8::try_from(count).unwrap_or(0)
    }
}

/// What [`ManyQuadrature::frictions`] is asked for.
struct Call<'a, S: Simd, const N: usize, const SLOPED: bool> {
    quadrature: &'a ManyQuadrature,
    contact: &'a ContactMotion<Lane<S, N>>,
    inner: &'a mut InnerNodes,
    planned: bool,
}

impl<S: Simd, const N: usize, const SLOPED: bool> WithSimd for Call<'_, S, N, SLOPED> {
    type Output = (ManyFrictions<Lane<S, N>>, Mask<S, N>);

    #[inline(always)]
    fn with_simd<Same: Simd>(self, _: Same) -> Self::Output {
        self.quadrature.summed::<S, N, SLOPED>(self.contact, self.inner, self.planned)
    }
}

/// Adds the friction of a line with these inner nodes.
#[inline(always)]
fn add_line<S: Simd, const N: usize, const SLOPED: bool>(
    totals: &mut [Lane<S, N>; VALUES + SLOPES],
    slip: &EllipseSlip<Lane<S, N>>,
    contact: &ContactMotion<Lane<S, N>>,
    (xi, weight): (Lane<S, N>, Lane<S, N>),
    nodes: &[(Lane<S, N>, Lane<S, N>)],
) {
    let (v_t, (b_0, b_1)) = (slip.along(xi), slip.across(xi));
    let square = v_t * v_t + slip.creep * slip.creep;
    let zero = xi.constant(0.0);
    let (mut j, mut k) = ([zero; 3], [zero; 3]);
    for (s, part) in nodes {
        let v_c = b_1.mul_add(*s, b_0);
        // q = (v_t² + v_e² + (b₀ + b₁ s)²)^{−1/2}
        let inverse = v_c.mul_add(v_c, square).recip();
        // J_k = Σ w sᵏ q,  K_k = Σ w sᵏ q³,  k = 0, 1, 2                 (T21)
        let q = *part * inverse.sqrt();
        let q_s = q * *s;
        j[0] = j[0] + q;
        j[1] = j[1] + q_s;
        j[2] = q_s.mul_add(*s, j[2]);
        if SLOPED {
            let cube = q * inverse;
            let cube_s = cube * *s;
            k[0] = k[0] + cube;
            k[1] = k[1] + cube_s;
            k[2] = cube_s.mul_add(*s, k[2]);
        }
    }
    for i in 0..3 {
        j[i] = j[i] * weight;
        k[i] = k[i] * weight;
    }
    // T = v_t J₀,  C = b₀ J₀ + b₁ J₁,  S = b₀ J₁ + b₁ J₂
    let (t, c, s) = (v_t * j[0], b_0 * j[0] + b_1 * j[1], b_0 * j[1] + b_1 * j[2]);
    let (a, b) = contact.semi_axes;
    let (x, y, h) = (xi * a, chord(xi) * b, slip.height(xi));
    // F_t = −T,  F_c = C,  M_t = −h C,  M_n = −(x T + Y S),  M_c = −h T,
    // P = v_t T + b₀ C + b₁ S                                             (T22)
    let m_n = -(x * t + y * s);
    let values = [-t, c, -(h * c), m_n, -(h * t), v_t * t + b_0 * c + b_1 * s];
    for i in 0..VALUES {
        totals[i] = totals[i] + values[i];
    }
    if !SLOPED {
        return;
    }
    let [w_t, w_n, w_c] = contact.omega;
    // T_v = J₀ − v_t² K₀,  T_b = −v_t (b₀ K₀ + b₁ K₁),  T_s = −v_t (b₀ K₁ + b₁ K₂)
    let t_v = j[0] - v_t * v_t * k[0];
    let t_b = -(v_t * (b_0 * k[0] + b_1 * k[1]));
    let t_s = -(v_t * (b_0 * k[1] + b_1 * k[2]));
    // (C_b, C_s, S_s) = (v_t² + v_e²) (K₀, K₁, K₂)                        (T23)
    let (c_b, c_s, s_s) = (square * k[0], square * k[1], square * k[2]);
    // By the growth of the ellipse: of h, of the slip, and of the sums.
    let dh = xi * xi * slip.sag * -2.0;
    let (g_v, g_b) = (x * w_n + dh * w_c, dh * w_t);
    let t_g = t_v * g_v + t_b * g_b + t_s * b_1;
    let c_g = t_b * g_v + c_b * g_b + c_s * b_1;
    let s_g = t_s * g_v + c_s * g_b + s_s * b_1;
    // By the spin; by the rest of the motion they are (1, h).
    let (t_n, c_n, s_n) = (t_v * x + t_s * y, t_b * x + c_s * y, t_s * x + s_s * y);
    let (t_vh, t_bh, c_bh) = (t_v * h, t_b * h, c_b * h);
    let slopes = [
        -t_v,
        -t_bh,
        -t_n,
        -t_vh,
        -(c_bh * h),
        -(c_n * h),
        -(t_bh * h),
        -(x * t_n + y * s_n),
        -(t_n * h),
        -(t_vh * h),
        t_b,
        c_bh,
        c_n,
        t_bh,
        -t_g,
        c_g,
        -(h * c_g + dh * c),
        m_n - (x * t_g + y * s_g),
        -(h * t_g + dh * t),
    ];
    for i in 0..SLOPES {
        totals[VALUES + i] = totals[VALUES + i] + slopes[i];
    }
}

impl<F: Copy> ManyFrictions<F> {
    #[inline(always)]
    fn of(totals: &[F; VALUES + SLOPES]) -> Self {
        let [
            f_t,
            f_c,
            m_t,
            m_n,
            m_c,
            power,
            // Upper triangle of the symmetric part: friction has a potential in the motion.
            aa,
            at,
            an,
            ac,
            tt,
            tn,
            tc,
            nn,
            nc,
            cc,
            // Force across, by the motion.
            ea,
            et,
            en,
            ec,
            // All of them, by the growth of the ellipse.
            ga,
            ge,
            gt,
            gn,
            gc,
        ] = *totals;
        Self {
            wrench: [f_t, f_c, m_t, m_n, m_c],
            power,
            by_motion: [
                [aa, at, an, ac],
                [ea, et, en, ec],
                [at, tt, tn, tc],
                [an, tn, nn, nc],
                [ac, tc, nc, cc],
            ],
            by_growth: [ga, ge, gt, gn, gc],
        }
    }
}

#[cfg(test)]
mod tests {
    use bsm_sample::Sample;
    use bsm_simd::{Arch, Block};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::super::kernel::{self, Point};
    use super::*;

    /// Semi-axes, pressed radius, motion and creep speed of contacts.
    type Contacts = [Block; 8];

    /// Wrench, derivatives by motion and growth, power, and whether the rule resolves the friction.
    const FOUND: usize = 5 + 25 + 2;

    struct All<'a>(&'a ManyQuadrature, &'a Contacts);

    impl WithSimd for All<'_> {
        type Output = [Block; FOUND];

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
            let mut found = [[0.0; BLOCK]; FOUND];
            for at in (0..BLOCK).step_by(S::F64_LANES) {
                let [a, b, pressed_radius, speed, w_t, w_n, w_c, creep] =
                    self.1.map(|x| Lane::<S>::load(simd, &x[at..]));
                let omega = [w_t, w_n, w_c];
                let contact =
                    ContactMotion { semi_axes: (a, b), pressed_radius, speed, omega, creep };
                let mut inner = InnerNodes::default();
                let (sums, resolved) =
                    self.0.frictions::<S, 1, true>(simd, &contact, &mut inner, false);
                let slopes = (0..5).flat_map(|i| {
                    let [a, t, n, c] = sums.by_motion[i];
                    [a, t, n, c, sums.by_growth[i]]
                });
                let all = sums.wrench.into_iter().chain(slopes);
                let all = all.chain([sums.power, resolved.to_numbers()]);
                for (found, x) in found.iter_mut().zip(all) {
                    x.store(&mut found[at..]);
                }
            }
            found
        }
    }

    /// Random contacts: the sums of several side by side are those of each, at accuracies whose panels fill the
    /// groups of lines and at one whose do not, on every instruction set.
    #[test]
    fn contacts_side_by_side_are_those_one_by_one() {
        let mut rng = ChaCha8Rng::seed_from_u64(12);
        let mut compared = 0;
        for round in 0..300 {
            let accuracy = [1e-4, 1e-6, 1e-8][round % 3];
            let single = Quadrature::of(accuracy);
            let many = ManyQuadrature::of(accuracy).expect("few nodes");
            let mut contacts = [[0.0; BLOCK]; 8];
            for i in 0..BLOCK {
                let mut log = |low: f64, high: f64| rng.log_uniform(low, high);
                let (a, ratio) = (log(1e-3, 0.3), log(2.0, 30.0));
                let (slip, roll, turn) = (log(1e-4, 1.0), log(1e-3, 1.0), log(1e-2, 3.0));
                let (bend, shift) = (log(1e-2, 3.0), log(1e-3, 1.0));
                let side = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
                let along = side * slip * shift - bend;
                let contact = [a, a / ratio, 1.03, along, roll, turn, bend, 1e-4];
                for (column, x) in contacts.iter_mut().zip(contact) {
                    column[i] = x;
                }
            }
            let found = Arch::new().dispatch(All(&many, &contacts));
            for arch in bsm_simd::instruction_sets() {
                let same = arch.dispatch(All(&many, &contacts));
                assert!(same.map(|b| b.map(f64::to_bits)) == found.map(|b| b.map(f64::to_bits)));
            }
            for i in 0..BLOCK {
                let [a, b, pressed_radius, speed, w_t, w_n, w_c, creep] = contacts.map(|x| x[i]);
                let (semi_axes, motion) = ((a, b), [speed, w_t, w_n, w_c]);
                let point = Point { semi_axes, pressed_radius, ball_radius: 1.0, motion, creep };
                if found[FOUND - 1][i] < 0.5 {
                    continue;
                }
                let kernel::Sums { values, power, slopes } =
                    kernel::sums::<true>(&point, (&single).into());
                let expected = values.into_iter().chain(slopes.into_iter().flatten());
                for (number, expected) in expected.chain([power]).enumerate() {
                    // Rounding of sums of terms of at most one, and of slopes of at most 1/v_e.
                    let room = if (5..30).contains(&number) { 1e-12 / creep } else { 1e-12 };
                    let error = (found[number][i] - expected).abs();
                    assert!(error <= room, "{accuracy} {number}: {} {expected}", found[number][i]);
                }
                compared += 1;
            }
        }
        // The spin pole is inside at a fifth of them.
        assert!(compared > 1500, "{compared}");
    }
}
