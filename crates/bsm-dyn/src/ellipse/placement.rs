//! Number and positions of the quadrature nodes over an ellipse. The nodes either depend on the
//! current slip or are kept from an evaluation with a previous slip.
//!
//! Theory: `docs/theory/09-traction.md`, equations (T18), (T19).

use std::cell::OnceCell;

use bsm_simd::{BLOCK, Block};

use super::quadrature::{Quadrature, UNRESOLVED};
use super::slip::EllipseSlip;

/// Node counts that are kept while the slip changes, so that the friction sums change smoothly. The
/// sums are accurate for slips close to the slip from which the node counts were determined.
#[derive(Debug, Clone)]
pub(crate) enum FrozenRule {
    /// Number of blocks of angles on half a ring, for integration on rings.
    Rings(usize),
    /// Flags that mark the poles at which a panel is split, and the nodes of all chords.
    Chords([bool; 2], Vec<InnerNodes>),
}

/// Numbers of nodes along a block of neighboring chords.
#[derive(Debug, Clone, Copy)]
pub(crate) struct InnerNodes {
    /// Number of nodes on each chord; `None` if the spin poles of all chords in the block are
    /// inside the contact ellipse.
    pub(super) count: Option<usize>,
    /// Mask that is 1 for each chord whose spin pole is inside the contact ellipse, and 0 for other
    /// chords; `None` if there is no such chord.
    pub(super) inside: Option<Block>,
}

/// Choice of the quadrature nodes over an ellipse, which either depend on the slip or come from a
/// frozen rule. The first evaluation of the friction sums creates the frozen rule.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Placement<'a> {
    pub(crate) rule: &'a Quadrature,
    pub(crate) frozen_rule: Option<&'a OnceCell<FrozenRule>>,
    /// True for evaluations that only provide a starting value, with a constant friction
    /// coefficient. The sums then have an accuracy of 1e-5, and spin poles inside the ellipse are
    /// not resolved.
    pub(crate) coarse: bool,
}

impl<'a> Placement<'a> {
    pub(super) fn frozen(&self) -> Option<&'a FrozenRule> {
        self.frozen_rule?.get()
    }

    /// Returns the node counts that an earlier evaluation has fixed: flags that mark the poles at
    /// which a panel is split, and the nodes of each chord. If no node counts are fixed for chords,
    /// the flags are `None` and the list is empty.
    pub(super) fn chords(&self) -> (Option<[bool; 2]>, &'a [InnerNodes]) {
        match self.frozen() {
            Some(FrozenRule::Chords(split, chords)) => (Some(*split), chords),
            _ => (None, &[]),
        }
    }

    /// Returns true if a frozen rule is requested but does not exist yet.
    pub(super) fn is_new(&self) -> bool {
        self.frozen_rule.is_some_and(|rule| rule.get().is_none())
    }

    /// Returns the numbers of nodes along neighboring chords with the given `$\sinh^2\eta$`.
    #[inline(always)]
    pub(super) fn along(&self, squares: &Block) -> InnerNodes {
        let rule = self.rule;
        let nearest = |squares: &Block| {
            squares.iter().fold(f64::INFINITY, |least, square| least.min(*square))
        };
        let least = nearest(squares);
        if self.coarse || rule.min_outside_distance() <= least {
            return InnerNodes { count: rule.count(least).or(Some(UNRESOLVED)), inside: None };
        }
        if rule.is_dry() {
            // Nodes that are concentrated at a spin pole are also accurate for chords without a spin
            // pole, so they are used for the whole block.
            return InnerNodes { count: None, inside: Some([1.0; BLOCK]) };
        }
        let (mut inside, mut outside) = ([0.0; BLOCK], *squares);
        for (inside, square) in inside.iter_mut().zip(&mut outside) {
            // A NaN needs no special treatment in this comparison, because a single NaN makes every
            // sum NaN.
            if *square < rule.min_outside_distance() {
                (*inside, *square) = (1.0, f64::INFINITY);
            }
        }
        let least = nearest(&outside);
        let count = (least < f64::INFINITY).then(|| rule.count(least)).flatten();
        InnerNodes { count, inside: Some(inside) }
    }

    /// Stores the node counts that are kept while the slip changes, unless node counts are already
    /// stored.
    pub(super) fn freeze(&self, made: FrozenRule) {
        if let Some(rule) = self.frozen_rule {
            rule.get_or_init(|| made);
        }
    }

    /// Returns the number of blocks of angles on half a ring, or zero if friction is integrated
    /// along chords.
    pub(super) fn angle_blocks(&self, slip: &EllipseSlip<f64>) -> usize {
        match self.frozen() {
            Some(FrozenRule::Rings(blocks)) => *blocks,
            Some(FrozenRule::Chords(..)) => 0,
            None => self.rule.angle_blocks(slip),
        }
    }
}

impl<'a> From<&'a Quadrature> for Placement<'a> {
    fn from(rule: &'a Quadrature) -> Self {
        Self { rule, frozen_rule: None, coarse: false }
    }
}
