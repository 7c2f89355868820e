//! Chords of the contact ellipses at the quadrature nodes on the long axis, and the nodes along
//! these chords.
//!
//! Theory: `docs/theory/09-traction.md`, equations (T14), (T18), (T19).

use bsm_simd::{BLOCK, Block, Lane, Simd};

use super::panels::{Nodes, Panels};
use super::placement::{FrozenRule, InnerNodes, Placement};
use super::slip::{EllipseSlip, half_length};

/// A block of neighboring chords of a contact ellipse.
#[derive(Clone, Copy)]
pub(super) struct Chords {
    /// Positions of the chords on the long axis, divided by the semi-axis, and the fraction of the
    /// load that each chord carries.
    pub(super) xi: Block,
    pub(super) weight: Block,
    /// Half lengths of the chords, divided by the short semi-axis of the ellipse.
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

    /// Calculates the positions, load fractions and half lengths of the chords at a block of
    /// quadrature nodes, and the numbers of nodes along the chords.
    ///
    /// * `frozen`: numbers of nodes along the chords, if they are already fixed.
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
            let (xi, weight) = nodes.chords(simd, i);
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

/// Accumulates the contributions of the chords of the contact ellipses.
pub(super) trait AddChords<S: Simd> {
    /// Adds the contributions of a block of chords to the sums of an ellipse.
    fn add_chords(&mut self, simd: S, ellipse: usize, chords: &Chords);
}

/// Number of blocks of chords that are calculated before the first block is summed. The processor
/// can then work on one block while it waits for the results of another.
const BLOCKS_AHEAD: usize = 2;

/// Passes the chords of the two contact ellipses to `sums`. Contacts for which `done` is true are
/// skipped.
#[inline(always)]
pub(super) fn for_each_chord<S: Simd>(
    simd: S,
    placements: &[Placement<'_>; 2],
    slips: &[EllipseSlip<f64>; 2],
    done: [bool; 2],
    sums: &mut impl AddChords<S>,
) {
    let panels = Panels::of(simd, placements, slips, done);
    let mut nodes = [panels.nodes(0), panels.nodes(1)];
    let mut frozen = [placements[0].chords().1.iter(), placements[1].chords().1.iter()];
    let mut made = [Vec::new(), Vec::new()];
    let mut ready = [(0, Chords::NONE); 2 * BLOCKS_AHEAD];
    loop {
        let mut count = 0;
        for c in 0..2 {
            let slip = slips[c].splat(simd);
            for _ in 0..BLOCKS_AHEAD {
                let Some(nodes) = nodes[c].next() else { break };
                let (ellipse, chords) = &mut ready[count];
                *ellipse = c;
                chords.place(simd, &nodes, &slip, (placements[c], frozen[c].next()));
                if placements[c].is_new() {
                    made[c].push(chords.inner);
                }
                count += 1;
            }
        }
        if count == 0 {
            break;
        }
        for (ellipse, chords) in &ready[..count] {
            sums.add_chords(simd, *ellipse, chords);
        }
    }
    for (c, chords) in made.into_iter().enumerate() {
        placements[c].freeze(FrozenRule::Chords(panels.split[c], chords));
    }
}
