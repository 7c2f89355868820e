//! Number and position of the nodes for the sums over an ellipse. They follow from the slip, or are
//! kept from another slip.
//!
//! Theory: `docs/theory/09-traction.md`, equations (T18), (T19).

use std::cell::OnceCell;

use bsm_simd::{BLOCK, Block};

use super::quadrature::{Quadrature, UNRESOLVED};
use super::slip::EllipseSlip;

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

/// The nodes of a quadrature over an ellipse: by the slip, or by a frozen rule, which the first sums make.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Placement<'a> {
    pub(crate) rule: &'a Quadrature,
    pub(crate) frozen_rule: Option<&'a OnceCell<FrozenRule>>,
    /// On the way to a root: sums to 1e-5, and spin poles inside are not resolved; of a constant coefficient.
    pub(crate) coarse: bool,
}

impl<'a> Placement<'a> {
    pub(super) fn frozen(&self) -> Option<&'a FrozenRule> {
        self.frozen_rule?.get()
    }

    /// Which poles split their panel, and the nodes of the lines, as far as they are known.
    pub(super) fn lines(&self) -> (Option<[bool; 2]>, &'a [InnerNodes]) {
        match self.frozen() {
            Some(FrozenRule::Lines(split, lines)) => (Some(*split), lines),
            _ => (None, &[]),
        }
    }

    /// True if the frozen rule is to be made.
    pub(super) fn is_new(&self) -> bool {
        self.frozen_rule.is_some_and(|rule| rule.get().is_none())
    }

    /// The nodes of neighbouring lines with these `$\sinh^2\eta$`.
    #[inline(always)]
    pub(super) fn along(&self, squares: &Block) -> InnerNodes {
        let rule = self.rule;
        let nearest = |squares: &Block| {
            squares.iter().fold(f64::INFINITY, |least, square| least.min(*square))
        };
        let least = nearest(squares);
        if self.coarse || rule.least() <= least {
            return InnerNodes { count: rule.count(least).or(Some(UNRESOLVED)), inside: None };
        }
        if rule.is_dry() {
            // Nodes about a pole resolve lines without one too, and are computed for all neighbours.
            return InnerNodes { count: None, inside: Some([1.0; BLOCK]) };
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

    /// Makes the frozen rule if there is none.
    pub(super) fn freeze(&self, made: FrozenRule) {
        if let Some(rule) = self.frozen_rule {
            rule.get_or_init(|| made);
        }
    }

    /// Blocks of angles on half a ring; none where lines are taken.
    pub(super) fn angle_blocks(&self, slip: &EllipseSlip<f64>) -> usize {
        match self.frozen() {
            Some(FrozenRule::Rings(blocks)) => *blocks,
            Some(FrozenRule::Lines(..)) => 0,
            None => self.rule.angle_blocks(slip),
        }
    }
}

impl<'a> From<&'a Quadrature> for Placement<'a> {
    fn from(rule: &'a Quadrature) -> Self {
        Self { rule, frozen_rule: None, coarse: false }
    }
}
