//! The panels of the long axis around the two lines of pure rolling, and the nodes in these panels.
//!
//! Theory: `docs/theory/09-traction.md`, equations (T14) to (T17).

use std::ops::Range;

use bsm_simd::{BLOCK, Block, Compare, Lane, Simd, WithSimd, for_few};

use super::placement::Placement;
use super::quadrature::Gauss;
use super::slip::{EllipseSlip, Pole, clamp};

/// Most panels of two ellipses: both sides of two poles of each. Their ends are whole vectors.
const MOST: usize = BLOCK;

/// The parts of the long axes of both ellipses, those of the first one first.
pub(super) struct Panels<'a> {
    /// Where each begins and ends: from the pole over its width, and then in the variable of (T17).
    ends: [[f64; 2]; MOST],
    /// The pole that it is graded to, and its nodes.
    parts: [(Pole<f64>, &'a Gauss); MOST],
    /// Those of each ellipse.
    of: [Range<usize>; 2],
    /// Which poles split theirs.
    pub(super) split: [[bool; 2]; 2],
}

/// Nodes on the long axis that are worked on together: places and weights on [0, 1], where their panels begin in the
/// variable of (T17), their lengths, and their poles.
#[derive(Default)]
pub(super) struct Nodes {
    abscissa: Block,
    part: Block,
    from: Block,
    length: Block,
    at: Block,
    width: Block,
}

/// The poles of both contacts and, if asked how near they are, their `$\sinh^2\eta$`.
struct PolesOfBoth<'a> {
    slips: &'a [EllipseSlip<f64>; 2],
    near: bool,
}

impl WithSimd for PolesOfBoth<'_> {
    /// The first one of both contacts, and the second one.
    type Output = [(Pole<Block>, Block); 2];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self { slips: [nut, screw], near } = self;
        let both = nut.zip(
            screw,
            #[inline(always)]
            |nut, screw| [nut, screw, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        );
        let none = [0.0; BLOCK];
        let mut found = [(Pole { at: none, width: none }, none); 2];
        for first in (0..2).step_by(S::F64_LANES) {
            let slip = both.zip(
                &both,
                #[inline(always)]
                |numbers, _| Lane::<S>::load(simd, &numbers[first..]),
            );
            for ((to, square), pole) in found.iter_mut().zip(slip.poles()) {
                pole.at.store(&mut to.at[first..]);
                pole.width.store(&mut to.width[first..]);
                if near {
                    slip.analyticity(pole.at).store(&mut square[first..]);
                }
            }
        }
        found
    }
}

impl<'a> Panels<'a> {
    /// Of both contacts, worked on side by side; none of those that are done with.
    #[inline(always)]
    pub(super) fn of<S: Simd>(
        simd: S,
        nodes: &[Placement<'a>; 2],
        slips: &[EllipseSlip<f64>; 2],
        done: [bool; 2],
    ) -> Self {
        // Where panels are split is known on the way to a root, and where the rule is frozen.
        let may_split = |nodes: &Placement<'_>| !nodes.coarse && nodes.frozen().is_none();
        let near = nodes.iter().any(may_split);
        let poles = for_few(simd, PolesOfBoth { slips, near });
        let none = (Pole { at: 0.0, width: 1.0 }, &nodes[0].rule.panel);
        let mut all = Self {
            ends: [[0.0; 2]; MOST],
            parts: [none; MOST],
            of: [0..0, 0..0],
            split: [[false; 2]; 2],
        };
        for c in 0..2 {
            all.of[c] = all.of[0].end..all.of[0].end;
            let here = |(Pole { at, width }, square): (Pole<Block>, Block)| {
                (Pole { at: at[c], width: width[c] }, square[c])
            };
            if !done[c] {
                all.add(c, nodes[c], poles.map(here));
            }
        }
        // τ from arsinh((lo − ξ_j)/δ_j) to arsinh((hi − ξ_j)/δ_j)        (T17)
        let ends = all.ends[..all.of[1].end].as_flattened_mut();
        for at in (0..ends.len()).step_by(S::F64_LANES) {
            Lane::<S>::load(simd, &ends[at..]).arsinh().store(&mut ends[at..]);
        }
        all
    }

    /// Adds those of an ellipse around two poles with these `$\sinh^2\eta$`, split where the poles are inside.
    #[inline(always)]
    fn add(&mut self, ellipse: usize, nodes: Placement<'a>, poles: [(Pole<f64>, f64); 2]) {
        let (rule, (frozen, _)) = (nodes.rule, nodes.lines());
        let middle = clamp(0.5 * (poles[0].0.at + poles[1].0.at), -1.0, 1.0);
        for (i, (low, high)) in [(-1.0, middle), (middle, 1.0)].into_iter().enumerate() {
            let (pole, square) = poles[i];
            let inside = frozen.map_or(square < rule.least(), |split| split[i]);
            let split = inside && !nodes.coarse && low < pole.at && pole.at < high;
            self.split[ellipse][i] = split;
            let (cut, nodes) = if split { (pole.at, &rule.part) } else { (high, &rule.panel) };
            for (low, high) in [(low, cut), (cut, high)] {
                if low < high {
                    let panel = self.of[ellipse].end;
                    self.ends[panel] = [low, high].map(|end| (end - pole.at) / pole.width);
                    self.parts[panel] = (pole, nodes);
                    self.of[ellipse].end += 1;
                }
            }
        }
    }

    /// Those of an ellipse.
    pub(super) fn nodes(&self, ellipse: usize) -> PanelNodes<'_> {
        PanelNodes { all: self, left: self.of[ellipse].clone(), node: 0 }
    }
}

/// The nodes of an ellipse one after the other: the panels that are left, and the next node of the first of them.
pub(super) struct PanelNodes<'a> {
    all: &'a Panels<'a>,
    left: Range<usize>,
    node: usize,
}

impl<'a> PanelNodes<'a> {
    /// The next few nodes; places behind the last one repeat it without weight.
    #[inline(always)]
    pub(super) fn next(&mut self) -> Option<Nodes> {
        if self.left.is_empty() {
            return None;
        }
        let ([begin, end], (pole, nodes)) = self.panel();
        let Some((abscissa, part)) = nodes.block(self.node) else {
            return Some(self.of_several_panels());
        };
        self.pass(BLOCK);
        Some(Nodes {
            abscissa: *abscissa,
            part: *part,
            from: [begin; BLOCK],
            length: [end - begin; BLOCK],
            at: [pole.at; BLOCK],
            width: [pole.width; BLOCK],
        })
    }

    /// The next few nodes where a panel ends among them.
    fn of_several_panels(&mut self) -> Nodes {
        let mut all = Nodes::default();
        let (mut panel, mut abscissa) = (self.panel(), 0.0);
        for i in 0..BLOCK {
            if !self.left.is_empty() {
                panel = self.panel();
                (abscissa, all.part[i]) = panel.1.1.at(self.node);
                self.pass(1);
            }
            let ([begin, end], (pole, _)) = panel;
            (all.abscissa[i], all.from[i], all.length[i]) = (abscissa, begin, end - begin);
            (all.at[i], all.width[i]) = (pole.at, pole.width);
        }
        all
    }

    /// Ends, pole and nodes of the first panel that is left.
    fn panel(&self) -> ([f64; 2], (Pole<f64>, &'a Gauss)) {
        (self.all.ends[self.left.start], self.all.parts[self.left.start])
    }

    fn pass(&mut self, nodes: usize) {
        self.node += nodes;
        if self.node == self.panel().1.1.len() {
            (self.left.start, self.node) = (self.left.start + 1, 0);
        }
    }
}

impl Nodes {
    /// Places of a few lines on the long axis from a number on, and their parts of the load.
    #[inline(always)]
    pub(super) fn lines<S: Simd>(&self, simd: S, i: usize) -> (Lane<S>, Lane<S>) {
        let Self { abscissa, part, from, length, at, width } = self;
        let (at, width) = (Lane::load(simd, &at[i..]), Lane::load(simd, &width[i..]));
        let (from, length) = (Lane::load(simd, &from[i..]), Lane::load(simd, &length[i..]));
        let (abscissa, part) = (Lane::load(simd, &abscissa[i..]), Lane::load(simd, &part[i..]));
        line(&Pole { at, width }, from + length * abscissa, length * part)
    }
}

/// Place of a line on the long axis and its part of the load, from a node in the variable of (T17) and its
/// weight.
#[inline(always)]
pub(super) fn line<S: Simd, const N: usize>(
    pole: &Pole<Lane<S, N>>,
    tau: Lane<S, N>,
    weight: Lane<S, N>,
) -> (Lane<S, N>, Lane<S, N>) {
    let grow = tau.exp();
    line_at(pole, (grow, grow.recip()), weight)
}

/// The same from the exponentials of the variable and of its opposite.
#[inline(always)]
pub(super) fn line_at<S: Simd, const N: usize>(
    pole: &Pole<Lane<S, N>>,
    (grow, fall): (Lane<S, N>, Lane<S, N>),
    weight: Lane<S, N>,
) -> (Lane<S, N>, Lane<S, N>) {
    // ξ = ξ_j + δ_j sinh τ                                               (T17)
    let xi = pole.at + pole.width * (grow - fall) * 0.5;
    // dQ/Q = (3/4)(1 − ξ²) dξ × (2/π) √(1 − s²) ds                       (T14)
    let shape = ((-xi + 1.0) * (xi + 1.0)).larger(xi.constant(0.0)) * 0.75;
    (xi, weight * pole.width * (grow + fall) * 0.5 * shape)
}
