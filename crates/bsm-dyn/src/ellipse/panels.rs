//! Panels (intervals) of the long axis around the two lines of pure rolling, and the quadrature
//! nodes in these panels.
//!
//! Theory: `docs/theory/09-traction.md`, equations (T14) to (T17).

use bsm_kin::Real;
use std::ops::Range;

use bsm_simd::{BLOCK, Block, Lane, Simd, WithSimd, for_few};

use super::placement::Placement;
use super::quadrature::Gauss;
use super::slip::{EllipseSlip, Pole, clamp};

/// Maximum number of panels of two ellipses. Each ellipse has two poles of the integrand, and each
/// pole has a panel on either side. With this number of panels, the panel ends fill whole SIMD
/// vectors.
const MAX_PANELS: usize = BLOCK;

/// Panels on the long axes of two ellipses. The panels of the first ellipse come first.
pub(super) struct Panels<'a> {
    /// Ends of each panel. They are first stored as distances from the pole of the integrand,
    /// divided by the pole width, and then in the variable of (T17).
    ends: [[f64; 2]; MAX_PANELS],
    /// For each panel: the pole of the integrand around which the nodes are concentrated, and the
    /// quadrature nodes.
    parts: [(Pole<f64>, &'a Gauss); MAX_PANELS],
    /// Index range of the panels of each ellipse.
    of: [Range<usize>; 2],
    /// Flags for the two poles of each ellipse: true if the panel that contains the pole is split
    /// at the pole.
    pub(super) split: [[bool; 2]; 2],
}

/// A block of quadrature nodes on the long axis. For each node, the fields contain its position and
/// weight on [0, 1], the start and length of its panel in the variable of (T17), and the position
/// and width of the pole of this panel.
#[derive(Default)]
pub(super) struct Nodes {
    abscissa: Block,
    part: Block,
    from: Block,
    length: Block,
    at: Block,
    width: Block,
}

/// Function object that calculates the poles of both contacts and, if `near` is true, the values of
/// `$\sinh^2\eta$` at these poles.
struct PolesOfBoth<'a> {
    slips: &'a [EllipseSlip<f64>; 2],
    near: bool,
}

impl WithSimd for PolesOfBoth<'_> {
    /// First pole of each contact, and second pole of each contact.
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
    /// Creates the panels of two contacts side by side. No panels are created for contacts for
    /// which `done` is true.
    #[inline(always)]
    pub(super) fn of<S: Simd>(
        simd: S,
        nodes: &[Placement<'a>; 2],
        slips: &[EllipseSlip<f64>; 2],
        done: [bool; 2],
    ) -> Self {
        // Panels are not split at poles if the nodes are frozen, or if the coarse nodes are used
        // because the solver has not converged yet.
        let may_split = |nodes: &Placement<'_>| !nodes.coarse && nodes.frozen().is_none();
        let near = nodes.iter().any(may_split);
        let poles = for_few(simd, PolesOfBoth { slips, near });
        let none = (Pole { at: 0.0, width: 1.0 }, &nodes[0].rule.panel);
        let mut all = Self {
            ends: [[0.0; 2]; MAX_PANELS],
            parts: [none; MAX_PANELS],
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
        // The variable τ extends from arsinh((lo − ξ_j)/δ_j) to arsinh((hi − ξ_j)/δ_j) (T17)
        let ends = all.ends[..all.of[1].end].as_flattened_mut();
        for at in (0..ends.len()).step_by(S::F64_LANES) {
            Lane::<S>::load(simd, &ends[at..]).arsinh().store(&mut ends[at..]);
        }
        all
    }

    /// Adds the panels of an ellipse around two poles with the given `$\sinh^2\eta$`. A panel is
    /// split at its pole if the pole is within the panel and counts as inside the ellipse.
    #[inline(always)]
    fn add(&mut self, ellipse: usize, nodes: Placement<'a>, poles: [(Pole<f64>, f64); 2]) {
        let (rule, (frozen, _)) = (nodes.rule, nodes.chords());
        let middle = clamp(0.5 * (poles[0].0.at + poles[1].0.at), -1.0, 1.0);
        for (i, (low, high)) in [(-1.0, middle), (middle, 1.0)].into_iter().enumerate() {
            let (pole, square) = poles[i];
            let inside = frozen.map_or(square < rule.min_outside_distance(), |split| split[i]);
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

    /// Returns an iterator over the nodes of an ellipse.
    pub(super) fn nodes(&self, ellipse: usize) -> PanelNodes<'_> {
        PanelNodes { all: self, left: self.of[ellipse].clone(), node: 0 }
    }
}

/// Iterator over the quadrature nodes of an ellipse. It stores the remaining panels, and the index
/// of the next node in the first remaining panel.
pub(super) struct PanelNodes<'a> {
    all: &'a Panels<'a>,
    left: Range<usize>,
    node: usize,
}

impl<'a> PanelNodes<'a> {
    /// Returns the next block of nodes. The last block is padded with copies of the last node that
    /// have zero weight.
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

    /// Returns the next block of nodes if the current panel ends within the block.
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

    /// Returns the ends, the pole and the nodes of the first remaining panel.
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
    /// Returns the positions of a block of chords on the long axis, starting with chord `i`, and
    /// the fraction of the load that each chord carries.
    #[inline(always)]
    pub(super) fn chords<S: Simd>(&self, simd: S, i: usize) -> (Lane<S>, Lane<S>) {
        let Self { abscissa, part, from, length, at, width } = self;
        let (at, width) = (Lane::load(simd, &at[i..]), Lane::load(simd, &width[i..]));
        let (from, length) = (Lane::load(simd, &from[i..]), Lane::load(simd, &length[i..]));
        let (abscissa, part) = (Lane::load(simd, &abscissa[i..]), Lane::load(simd, &part[i..]));
        chord(&Pole { at, width }, from + length * abscissa, length * part)
    }
}

/// Returns the position of a chord on the long axis and the fraction of the load that this chord
/// carries. The arguments are a node in the variable of (T17) and the weight of this node.
#[inline(always)]
pub(super) fn chord<S: Simd, const N: usize>(
    pole: &Pole<Lane<S, N>>,
    tau: Lane<S, N>,
    weight: Lane<S, N>,
) -> (Lane<S, N>, Lane<S, N>) {
    let grow = tau.exp();
    chord_at(pole, (grow, grow.recip()), weight)
}

/// Returns the same values as [`chord`], calculated from the exponential of the variable in (T17)
/// and the reciprocal of this exponential.
#[inline(always)]
pub(super) fn chord_at<S: Simd, const N: usize>(
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
