//! List of all quadrature nodes of an ellipse.

use bsm_simd::{Arch, Lane, Simd, WithSimd};

use super::Quadrature;
use super::chords::{AddChords, Chords, for_each_chord};
use super::kernel::{NearPole, Patch};
use super::oil::{HalfChord, HalfNode, PolarRule};
use super::placement::Placement;
use super::slip::{EllipseSlip, half_length};
use crate::contact::Transition;
use crate::cost;

/// Returns all quadrature nodes of an ellipse: for each node, the coordinates divided by the
/// semi-axes, and the fraction of the load that the node represents. `bend` is the transition of
/// the friction coefficient; `None` stands for a constant coefficient.
pub(super) fn nodes(
    point: &Patch,
    nodes: Placement<'_>,
    bend: Option<&Transition>,
) -> Vec<(f64, f64, f64)> {
    let list = Arch::new().dispatch(ListNodes(point, nodes, bend));
    cost::count_nodes(list.len());
    list
}

struct ListNodes<'a>(&'a Patch, Placement<'a>, Option<&'a Transition>);

/// A collector of the quadrature nodes on all chords of the ellipse.
struct NodeCollector<'a> {
    rule: &'a Quadrature,
    slip: EllipseSlip<f64>,
    bend: Option<&'a Transition>,
    nodes: Vec<(f64, f64, f64)>,
}

impl<S: Simd> AddChords<S> for NodeCollector<'_> {
    #[inline(always)]
    fn add_chords(&mut self, simd: S, _ellipse: usize, chords: &Chords) {
        for (i, (xi, weight)) in chords.xi.into_iter().zip(chords.weight).enumerate() {
            let half_length = half_length(xi);
            let mut add = |s: f64, part: f64| self.nodes.push((xi, half_length * s, weight * part));
            if chords.inner.inside.is_some_and(|inside| inside[i] > 0.0) {
                let near = NearPole::of(&self.slip.splat(simd), Lane::<S>::splat(simd, xi));
                for (s, part) in
                    (0..NearPole::<S>::pairs(self.rule)).flat_map(|pair| near.pair(self.rule, pair))
                {
                    add(s.as_slice()[0], part.as_slice()[0]);
                }
            } else if let Some(bend) = self.bend {
                let slip = self.slip.splat(simd);
                let half = HalfChord::of(bend, &slip, Lane::<S>::splat(simd, xi));
                for k in 0..self.rule.half.len() {
                    let HalfNode { s, weight, .. } = half.node(self.rule.half.at(k));
                    let (s, part) = (s.as_slice()[0], weight.as_slice()[0]);
                    add(s, part);
                    add(-s, part);
                }
            } else if let Some(count) = chords.inner.count {
                self.rule.inner[count].iter().for_each(|(s, part)| add(*s, *part));
            }
        }
        self.nodes.retain(|(_, _, weight)| *weight != 0.0);
    }
}

impl WithSimd for ListNodes<'_> {
    type Output = Vec<(f64, f64, f64)>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self(point, nodes, bend) = self;
        if let (Some(bend), blocks @ 1..) = (bend, nodes.angle_blocks(&point.slip())) {
            return PolarRule::of(simd, bend, &point.slip(), nodes.rule).nodes(nodes.rule, blocks);
        }
        let mut list =
            NodeCollector { rule: nodes.rule, slip: point.slip(), bend, nodes: Vec::new() };
        for_each_chord(simd, &[nodes; 2], &[point.slip(); 2], [false, true], &mut list);
        list.nodes
    }
}
