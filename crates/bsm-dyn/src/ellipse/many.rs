//! The friction sums over the ellipses of several contacts side by side, with derivatives.
//!
//! Nodes and sums agree with those of a single contact in `chords.rs` and `kernel.rs`, up to
//! rounding. Eight neighboring lines of a contact use the largest of their numbers of inner nodes.

use std::cell::OnceCell;
use std::ops::Range;

use bsm_simd::{BLOCK, Lane, Mask, NullaryFnOnce, Simd};

use super::Quadrature;
use super::kernel::{ALL, Chord, Dry, Moments, NUMBERS, Patch, PointLaw, Resultants, VALUES, sums};
use super::panels::line_at;
use super::placement::{FrozenRule, Placement};
use super::quadrature::{MOST_INNER, UNRESOLVED};
use super::slip::{clamp, half_length};

/// Maximum number of nodes of a panel.
const MOST_NODES: usize = 16;

/// Maximum number of groups of lines with the same number of inner nodes.
const GROUPS: usize = 2 * MOST_NODES / BLOCK;

/// A quadrature for several contacts side by side.
#[derive(Debug, Clone)]
pub(crate) struct ManyQuadrature {
    rule: Quadrature,
    /// Nodes and weights along a line, by their number, padded with nodes of zero weight.
    inner: Vec<Vec<(f64, f64)>>,
    segments: Vec<Segment>,
    /// The number of nodes is determined for every n-th line.
    stride: usize,
}

/// Neighboring lines of a panel that share their inner nodes.
#[derive(Debug, Clone)]
struct Segment {
    panel: usize,
    lines: Range<usize>,
    /// Indices of the group of inner nodes, for contacts with and without a first panel.
    groups: [usize; 2],
}

/// Nodes of several contacts, and memory for the results along them, which is reused because
/// clearing it takes longer than filling it.
pub(crate) struct ManyNodes<S: Simd> {
    /// Positions and weights of the lines.
    lines: [[(Lane<S>, Lane<S>); MOST_NODES]; 2],
    /// True for contacts without a first panel.
    second_only: [bool; BLOCK],
    /// Numbers of nodes along groups of neighboring lines.
    inner: [[usize; BLOCK]; GROUPS],
    across: [(Lane<S>, Lane<S>); MOST_INNER + 2],
    found: [(Moments<S, 2>, Lane<S>); BLOCK],
}

/// A point whose panels may be split, with the numbers of nodes at both contacts once they are
/// known.
#[derive(Debug, Clone, Default)]
pub(crate) struct SplitPoint {
    frozen_rules: [OnceCell<FrozenRule>; 2],
    /// True if the point is no longer needed.
    pub(crate) done: bool,
}

impl<S: Simd> ManyNodes<S> {
    pub(crate) fn new(simd: S) -> Self {
        let zero = Lane::splat(simd, 0.0);
        Self {
            lines: [[(zero, zero); MOST_NODES]; 2],
            second_only: [false; BLOCK],
            inner: [[0; BLOCK]; GROUPS],
            across: [(zero, zero); MOST_INNER + 2],
            found: [(Moments::zero(simd), zero); BLOCK],
        }
    }

    /// Returns the approximate number of nodes at one of the contacts.
    pub(crate) fn size(&self, contact: usize) -> usize {
        self.inner.iter().map(|inner| inner[contact]).sum()
    }
}

impl ManyQuadrature {
    /// Creates the quadrature, or returns `None` if it has more nodes than there is memory for.
    ///
    /// * `stride`: the number of nodes is determined for every n-th line.
    pub(crate) fn new(rule: Quadrature, stride: usize) -> Option<Self> {
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
        let mut inner = rule.inner.clone();
        let most = inner.iter().map(Vec::len).max().unwrap_or_default();
        for nodes in &mut inner {
            nodes.resize(most, (0.0, 0.0));
        }
        Some(Self { rule, inner, segments, stride })
    }

    /// Places the nodes of several contacts, and returns the mask of the contacts whose friction is
    /// resolved without splitting panels.
    ///
    /// * `frozen`: keeps the numbers of nodes along the lines. The mask is then meaningless.
    #[inline(always)]
    pub(crate) fn place_nodes<S: Simd>(
        &self,
        simd: S,
        point: &Patch<Lane<S>>,
        nodes: &mut ManyNodes<S>,
        frozen: bool,
    ) -> Mask<S> {
        // This is a separate call because the code is long.
        simd.vectorize(PlaceNodes { rule: self, point, nodes, frozen })
    }

    /// Returns the friction at placed nodes, with derivatives if `JACOBIAN` is true, and with an
    /// accuracy of 1e-5 if `ROUGH` is true.
    #[inline(always)]
    pub(crate) fn sums<S: Simd, const JACOBIAN: bool, const ROUGH: bool>(
        &self,
        simd: S,
        point: &Patch<Lane<S>>,
        nodes: &mut ManyNodes<S>,
    ) -> Resultants<Lane<S>> {
        simd.vectorize(ManySumsCall::<S, JACOBIAN, ROUGH> { simd, rule: self, point, nodes })
    }

    /// Returns the friction at both contacts of points whose panels may be split, point by point.
    #[inline(always)]
    pub(crate) fn split_sums<S: Simd, const JACOBIAN: bool>(
        &self,
        simd: S,
        patches: &[Patch<Lane<S>>; 2],
        points: &[SplitPoint],
    ) -> [Resultants<Lane<S>>; 2] {
        let mut blocks = [[[0.0; BLOCK]; NUMBERS]; 2];
        for (i, SplitPoint { frozen_rules, .. }) in
            points.iter().enumerate().filter(|(_, p)| !p.done)
        {
            let patches = [patches[0].at(i), patches[1].at(i)];
            let nodes =
                |frozen| Placement { rule: &self.rule, frozen_rule: Some(frozen), coarse: false };
            let nodes = [nodes(&frozen_rules[0]), nodes(&frozen_rules[1])];
            let mut found = [Resultants::none(0.0); 2];
            let (laws, all) = ([Dry; 2], [false; 2]);
            sums::<S, _, 2, JACOBIAN>(simd, &patches, &laws, &nodes, all, found.each_mut());
            for c in 0..2 {
                for (block, number) in blocks[c].iter_mut().zip(found[c].numbers()) {
                    block[i] = number;
                }
            }
        }
        let mut lanes = [[patches[0].creep; NUMBERS]; 2];
        for c in 0..2 {
            for k in 0..NUMBERS {
                lanes[c][k] = Lane::load(simd, &blocks[c][k]);
            }
        }
        [Resultants::of_numbers(&lanes[0]), Resultants::of_numbers(&lanes[1])]
    }
}

/// Arguments of [`ManyQuadrature::place_nodes`].
struct PlaceNodes<'a, S: Simd> {
    rule: &'a ManyQuadrature,
    point: &'a Patch<Lane<S>>,
    nodes: &'a mut ManyNodes<S>,
    frozen: bool,
}

impl<S: Simd> NullaryFnOnce for PlaceNodes<'_, S> {
    type Output = Mask<S>;

    #[inline(always)]
    fn call(self) -> Mask<S> {
        let Self { rule: ManyQuadrature { rule, stride, .. }, point, nodes: to, frozen } = self;
        let slip = point.slip();
        let (zero, one) = (slip.creep.constant(0.0), slip.creep.constant(1.0));
        let infinity = one.constant(f64::INFINITY);
        let poles = slip.poles();
        let middle = clamp((poles[0].at + poles[1].at) * 0.5, -1.0, 1.0);
        let (ends, second_only) = ([-one, middle, one], middle.le(-one));
        let nodes = rule.panel.len();
        let mut least = [infinity; GROUPS];
        let (narrow, mut resolved) = (one * rule.pole_distance[MOST_INNER], zero.le(zero));
        for panel in 0..2 {
            let (pole, low, high) = (poles[panel], ends[panel], ends[panel + 1]);
            // τ from arsinh((lo − ξ_j)/δ_j) to arsinh((hi − ξ_j)/δ_j)     (T17)
            let from = ((low - pole.at) / pole.width).arsinh();
            let length = ((high - pole.at) / pole.width).arsinh() - from;
            // Positions p and 1 − p from one exponential, and the middle position.
            let grow = [from.exp(), (from + length).exp()];
            let fall = [grow[0].recip(), grow[1].recip()];
            let lines = &mut to.lines[panel];
            for node in 0..nodes.div_ceil(2) {
                let (place, part) = rule.panel.at(node);
                let (up, weight) = ((length * place).exp(), length * part);
                let down = up.recip();
                lines[node] = line_at(&pole, (grow[0] * up, fall[0] * down), weight);
                lines[nodes - 1 - node] = line_at(&pole, (grow[1] * down, fall[1] * up), weight);
            }
            if frozen {
                continue;
            }
            let within = low.lt(pole.at) & pole.at.lt(high);
            resolved = resolved & (!within | narrow.le(slip.analyticity(pole.at)));
            let empty = high.le(low);
            for node in (0..nodes).step_by(*stride) {
                let square = slip.analyticity(lines[node].0);
                let square = empty.select(infinity, square);
                resolved = resolved & narrow.le(square);
                let groups = [(panel * nodes + node) / BLOCK, node / BLOCK];
                // In contacts without a first panel, the lines of the second panel begin a group.
                let [first, second] = if panel == 0 { [groups[0]; 2] } else { groups };
                if first == second {
                    least[first] = least[first].min(square);
                } else {
                    least[second] = least[second].min(second_only.select(square, infinity));
                    least[first] = least[first].min(second_only.select(infinity, square));
                }
            }
        }
        if !frozen {
            for (counts, least) in to.inner.iter_mut().zip(&least) {
                *counts = rule.counts(*least).map(|count| count.unwrap_or(UNRESOLVED));
            }
        }
        second_only.store(&mut to.second_only);
        resolved
    }
}

/// Arguments of [`ManyQuadrature::sums`].
struct ManySumsCall<'a, S: Simd, const JACOBIAN: bool, const ROUGH: bool> {
    simd: S,
    rule: &'a ManyQuadrature,
    point: &'a Patch<Lane<S>>,
    nodes: &'a mut ManyNodes<S>,
}

impl<S: Simd, const JACOBIAN: bool, const ROUGH: bool> NullaryFnOnce
    for ManySumsCall<'_, S, JACOBIAN, ROUGH>
{
    type Output = Resultants<Lane<S>>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        let Self { simd, rule: ManyQuadrature { rule, inner, segments, .. }, point, nodes } = self;
        let ManyNodes { lines, second_only, inner: counts, across, found } = nodes;
        let slip = point.slip();
        let zero = slip.creep.constant(0.0);
        let mut totals = [zero; ALL];
        for segment in segments {
            let (mut tables, mut most) = ([&inner[0]; BLOCK], 0);
            for i in 0..Lane::<S>::LEN {
                let count = counts[segment.groups[usize::from(second_only[i])]][i];
                tables[i] = &inner[count];
                most = most.max(rule.inner[count].len());
            }
            for k in 0..most {
                let (mut places, mut parts) = ([0.0; BLOCK], [0.0; BLOCK]);
                for i in 0..Lane::<S>::LEN {
                    (places[i], parts[i]) = tables[i][k];
                }
                across[k] = (zero.like(&places), zero.like(&parts));
            }
            let lines = &lines[segment.panel][segment.lines.clone()];
            for ((inner, chord_here), (xi, _)) in found.iter_mut().zip(lines) {
                *chord_here = half_length(*xi);
                let (v_t, (b_0, b_1)) = (slip.along(*xi), slip.across_at(*xi, *chord_here));
                let square = v_t * v_t + slip.creep * slip.creep;
                let mut sums = Moments::zero(simd);
                for (s, weight) in &across[..most] {
                    let v_c = b_1.mul_add(*s, b_0);
                    Dry::add::<S, JACOBIAN, ROUGH>(&mut sums, square, v_c, (*s, *weight));
                }
                *inner = sums;
            }
            for ((inner, half_length), (xi, weight)) in found.iter().zip(lines) {
                let line = Chord::new(&slip, *xi, *weight, *half_length);
                let [j, k, across, _] = Dry::kinds(*inner, line.square(&slip));
                let terms = line.terms::<JACOBIAN>((point.semi_axes, &slip), [j, k, across]);
                for i in 0..(if JACOBIAN { ALL } else { VALUES }) {
                    totals[i] = totals[i] + terms[i];
                }
            }
        }
        Resultants::of(totals, point)
    }
}

#[cfg(test)]
mod tests {
    use bsm_sample::Sample;
    use bsm_simd::{Arch, Block, WithSimd};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::super::kernel;
    use super::*;

    /// Semi-axes, radius of the contact surface, motion and creep speed of contacts.
    type Contacts = [Block; 8];

    /// Number of results: wrench, derivatives, power, and whether the quadrature resolves the
    /// friction.
    const FOUND: usize = 5 + 25 + 2;

    struct AllSums<'a>(&'a ManyQuadrature, &'a Contacts);

    impl WithSimd for AllSums<'_> {
        type Output = [Block; FOUND];

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
            let mut found = [[0.0; BLOCK]; FOUND];
            for at in (0..BLOCK).step_by(S::F64_LANES) {
                let [a, b, pressed_radius, speed, w_t, w_n, w_c, creep] =
                    self.1.map(|x| Lane::<S>::load(simd, &x[at..]));
                let (motion, ball_radius) = ([speed, w_t, w_n, w_c], creep.constant(1.0));
                let point = Patch { semi_axes: (a, b), pressed_radius, ball_radius, motion, creep };
                let nodes = &mut ManyNodes::new(simd);
                let resolved = self.0.place_nodes(simd, &point, nodes, false);
                let sums = self.0.sums::<S, true, false>(simd, &point, nodes);
                let all = sums.values.into_iter().chain(sums.slopes.into_iter().flatten());
                let all = all.chain([sums.power, resolved.to_numbers()]);
                for (found, x) in found.iter_mut().zip(all) {
                    x.store(&mut found[at..]);
                }
            }
            found
        }
    }

    /// For random contacts, the sums of several contacts side by side equal those of each contact,
    /// at accuracies whose panels fill the groups of lines and at one whose panels do not, on every
    /// instruction set.
    #[test]
    fn contacts_side_by_side_match_single_contacts() {
        let mut rng = ChaCha8Rng::seed_from_u64(12);
        let mut compared = 0;
        for round in 0..300 {
            let single = Quadrature::of([1e-4, 1e-6, 1e-8][round % 3]);
            let many = ManyQuadrature::new(single.clone(), 1).expect("few nodes");
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
            let found = Arch::new().dispatch(AllSums(&many, &contacts));
            for arch in bsm_simd::instruction_sets() {
                let same = arch.dispatch(AllSums(&many, &contacts));
                assert!(same.map(|b| b.map(f64::to_bits)) == found.map(|b| b.map(f64::to_bits)));
            }
            for i in 0..BLOCK {
                let [a, b, pressed_radius, speed, w_t, w_n, w_c, creep] = contacts.map(|x| x[i]);
                let (semi_axes, motion) = ((a, b), [speed, w_t, w_n, w_c]);
                let point = Patch { semi_axes, pressed_radius, ball_radius: 1.0, motion, creep };
                if found[FOUND - 1][i] < 0.5 {
                    continue;
                }
                let nodes = (&single).into();
                let Resultants { values, power, slopes, .. } =
                    kernel::sums_on::<_, 2, true>(Arch::new(), &point, Dry, nodes);
                let expected = values.into_iter().chain(slopes.into_iter().flatten());
                for (number, expected) in expected.chain([power]).enumerate() {
                    // Rounding of sums of terms of at most one, and of derivatives of at most
                    // 1/v_e.
                    let room = if (5..30).contains(&number) { 1e-12 / creep } else { 1e-12 };
                    let error = (found[number][i] - expected).abs();
                    assert!(error <= room, "{number}: {} {expected}", found[number][i]);
                }
                compared += 1;
            }
        }
        // The spin pole is inside the ellipse at a fifth of the contacts.
        assert!(compared > 1500, "{compared}");
    }
}
