//! The lines across the ellipses at the nodes of their panels, and the nodes along them.
//!
//! Theory: `docs/theory/09-traction.md`, equations (T14), (T18), (T19).

use std::cell::OnceCell;

use bsm_simd::{BLOCK, Block, Lane, Simd};

use super::panels::{Nodes, Panels};
use super::quadrature::{Quadrature, UNRESOLVED};
use super::slip::{EllipseSlip, half_length};

/// Numbers of nodes that stay as they are while the slip changes: sums without steps, near where they were
/// taken.
#[derive(Debug, Clone)]
pub(crate) enum FrozenRule {
    /// Of an oil: so many blocks of angles on half a ring.
    Rings(usize),
    /// Which of the two poles split their panel, and the nodes of all lines.
    Lines([bool; 2], Vec<InnerNodes>),
}

/// The nodes along a few neighbouring lines.
#[derive(Debug, Clone, Copy)]
pub(crate) struct InnerNodes {
    /// How many each has, for places and weights; none where the spin poles of all are inside.
    pub(super) count: Option<usize>,
    /// 1 for each line whose spin pole is inside the ellipse, else 0; none if there is no such line.
    pub(super) inside: Option<Block>,
}

/// The nodes of a quadrature over an ellipse: by the slip, or as in a plan, which the first walk fills.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Placement<'a> {
    pub(crate) rule: &'a Quadrature,
    pub(crate) plan: Option<&'a OnceCell<FrozenRule>>,
    /// On the way to a root: sums to 1e-5, and spin poles inside are not resolved; of a constant coefficient.
    pub(crate) coarse: bool,
}

impl<'a> Placement<'a> {
    pub(super) fn frozen(&self) -> Option<&'a FrozenRule> {
        self.plan?.get()
    }

    /// Which poles split their panel, and the nodes of the lines, as far as they are known.
    pub(super) fn lines(&self) -> (Option<[bool; 2]>, &'a [InnerNodes]) {
        match self.frozen() {
            Some(FrozenRule::Lines(split, lines)) => (Some(*split), lines),
            _ => (None, &[]),
        }
    }

    /// True if the plan is to be filled.
    fn is_new(&self) -> bool {
        self.plan.is_some_and(|plan| plan.get().is_none())
    }

    /// The nodes of neighbouring lines with these `$\sinh^2\eta$`.
    #[inline(always)]
    fn along(&self, squares: &Block) -> InnerNodes {
        let rule = self.rule;
        let nearest = |squares: &Block| {
            squares.iter().fold(f64::INFINITY, |least, square| least.min(*square))
        };
        let least = nearest(squares);
        if self.coarse || rule.least() <= least {
            return InnerNodes { count: rule.count(least).or(Some(UNRESOLVED)), inside: None };
        }
        let (mut inside, mut outside) = ([0.0; BLOCK], *squares);
        for (inside, square) in inside.iter_mut().zip(&mut outside) {
            // One NaN makes every sum NaN.
            if *square < rule.least() {
                (*inside, *square) = (1.0, f64::INFINITY);
            }
        }
        let least = nearest(&outside);
        let count = (least < f64::INFINITY).then(|| rule.count(least)).flatten();
        InnerNodes { count, inside: Some(inside) }
    }

    /// Fills the plan if it is new.
    pub(super) fn freeze(&self, made: FrozenRule) {
        if let Some(plan) = self.plan {
            plan.get_or_init(|| made);
        }
    }

    /// Blocks of angles on half a ring; none where lines are taken.
    pub(super) fn blocks(&self, slip: &EllipseSlip<f64>) -> usize {
        match self.frozen() {
            Some(FrozenRule::Rings(blocks)) => *blocks,
            Some(FrozenRule::Lines(..)) => 0,
            None => self.rule.blocks(slip),
        }
    }
}

impl<'a> From<&'a Quadrature> for Placement<'a> {
    fn from(rule: &'a Quadrature) -> Self {
        Self { rule, plan: None, coarse: false }
    }
}

/// A few neighbouring lines across the ellipse.
#[derive(Clone, Copy)]
pub(super) struct Chords {
    /// Places over the long semi-axis, and their parts of the load.
    pub(super) xi: Block,
    pub(super) weight: Block,
    /// Half their lengths over the short semi-axis.
    pub(super) half_length: Block,
    pub(super) inner: InnerNodes,
}

impl Chords {
    const NONE: Self = Self {
        xi: [0.0; BLOCK],
        weight: [0.0; BLOCK],
        half_length: [0.0; BLOCK],
        inner: InnerNodes { count: None, inside: None },
    };

    /// The lines of a few nodes.
    ///
    /// * `frozen`: the nodes along them, if they are known.
    #[inline(always)]
    fn place<S: Simd>(
        &mut self,
        simd: S,
        nodes: &Nodes,
        slip: &EllipseSlip<Lane<S>>,
        (placement, frozen): (Placement<'_>, Option<&InnerNodes>),
    ) {
        let mut square = [0.0; BLOCK];
        for i in (0..BLOCK).step_by(S::F64_LANES) {
            let (xi, weight) = nodes.lines(simd, i);
            xi.store(&mut self.xi[i..]);
            weight.store(&mut self.weight[i..]);
            half_length(xi).store(&mut self.half_length[i..]);
            if frozen.is_none() {
                slip.analyticity(xi).store(&mut square[i..]);
            }
        }
        self.inner = match frozen {
            Some(frozen) => *frozen,
            None => placement.along(&square),
        };
    }
}

/// What is done with the lines of a few ellipses.
pub(super) trait Visitor<S: Simd> {
    /// A few lines of an ellipse.
    fn visit(&mut self, simd: S, ellipse: usize, lines: &Chords);
}

/// Lines of a few places on the way along the ellipse, so that the processor works on some while it waits for
/// others.
const AHEAD: usize = 2;

/// Goes through the lines across both ellipses, but for those that are done with.
#[inline(always)]
pub(super) fn each_chord<S: Simd>(
    simd: S,
    placements: &[Placement<'_>; 2],
    slips: &[EllipseSlip<f64>; 2],
    done: [bool; 2],
    visitor: &mut impl Visitor<S>,
) {
    let panels = Panels::of(simd, placements, slips, done);
    let mut walks = [panels.walk(0), panels.walk(1)];
    let mut frozen = [placements[0].lines().1.iter(), placements[1].lines().1.iter()];
    let mut made = [Vec::new(), Vec::new()];
    let mut ready = [(0, Chords::NONE); 2 * AHEAD];
    loop {
        let mut count = 0;
        for c in 0..2 {
            let slip = slips[c].splat(simd);
            for _ in 0..AHEAD {
                let Some(nodes) = walks[c].next() else { break };
                let (ellipse, lines) = &mut ready[count];
                *ellipse = c;
                lines.place(simd, &nodes, &slip, (placements[c], frozen[c].next()));
                if placements[c].is_new() {
                    made[c].push(lines.inner);
                }
                count += 1;
            }
        }
        if count == 0 {
            break;
        }
        for (ellipse, lines) in &ready[..count] {
            visitor.visit(simd, *ellipse, lines);
        }
    }
    for (c, lines) in made.into_iter().enumerate() {
        placements[c].freeze(FrozenRule::Lines(panels.split[c], lines));
    }
}
