//! Quadrature rules for the friction integrals over a contact ellipse: nodes and weights on [0, 1]
//! and on [-1, 1].
//!
//! Theory: `docs/theory/09-traction.md`, equation (T19).

use std::f64::consts::PI;
use std::num::NonZeroUsize;
use std::sync::LazyLock;

use bsm_simd::{BLOCK, Block};
use gauss_quad::GaussLegendre;

use super::slip::{EllipseSlip, Pole};

/// Maximum number of nodes along a chord. If a chord needs more nodes, its spin pole counts as
/// inside the ellipse.
pub(super) const MAX_INNER_NODES: usize = 24;

/// Number of nodes along a chord whose spin pole is inside the ellipse, for evaluations that only
/// provide a starting value.
pub(super) const UNRESOLVED: usize = 8;

/// Maximum number of nodes along a chord of a lubricated contact. If a chord needs more nodes, its
/// spin pole counts as inside the ellipse, and the number of nodes does not depend on the slip.
const MAX_LUBRICATED_NODES: usize = 6;

/// Maximum number of rings of equal pressure. If more rings were needed for an oil, integration
/// along chords would be more efficient.
pub(super) const MAX_RINGS: usize = 2 * BLOCK;

/// Maximum number of blocks of angles on half a ring. If more blocks were needed for an oil,
/// integration along chords would be more efficient.
const MAX_BLOCKS: usize = 4;

/// Returns the fraction of a ring that each node represents.
#[expect(clippy::cast_precision_loss, reason = "a few angles")]
pub(super) fn part_of_a_node(blocks: usize) -> f64 {
    0.5 / (blocks * BLOCK) as f64
}

/// Returns the cosines and sines of the midpoints of equal parts of half a circle.
#[expect(clippy::cast_precision_loss, reason = "a few angles")]
fn half_ring(parts: usize) -> [Vec<f64>; 2] {
    let angle = |k: usize| PI * (k as f64 + 0.5) / parts as f64;
    [(0..parts).map(|k| angle(k).cos()).collect(), (0..parts).map(|k| angle(k).sin()).collect()]
}

/// Quadrature rule for the friction integrals over a contact ellipse.
#[derive(Debug, Clone, PartialEq)]
pub struct Quadrature {
    /// Gauss-Legendre nodes of a whole panel, and of each part of a split panel.
    pub(super) panel: Gauss,
    pub(super) part: Gauss,
    /// Nodes along a chord on each side of a spin pole inside the ellipse, and nodes along half a
    /// chord for an oil.
    pub(super) near: Gauss,
    pub(super) half: Gauss,
    /// Cosines and sines of the angles on half a ring, for an oil. The first entry has one block of
    /// [`BLOCK`] angles, the second entry has two blocks, and so on.
    pub(super) angles: Vec<[Vec<f64>; 2]>,
    /// For each number of angles, the minimum `$\cosh\eta$` of a pole for which this number of
    /// angles is sufficient. The minimum decreases with the number of angles.
    ring_pole_distance: Vec<f64>,
    /// Nodes and weights along a chord, indexed by the number of nodes (T19).
    pub(super) inner: &'static [Vec<(f64, f64)>],
    /// For each number of nodes, the minimum `$\sinh^2\eta$` (T18) for which this number of nodes
    /// is sufficient. The minimum decreases with the number of nodes.
    pub(super) pole_distance: Vec<f64>,
}

/// A quadrature rule with the coarser rule for its error estimate.
#[derive(Debug)]
pub(crate) struct RulePair {
    /// Rule with which friction is integrated.
    pub(crate) rule: Quadrature,
    /// Coarser rule. The difference between the results of both rules estimates the error.
    pub(crate) check: Quadrature,
}

/// Friction law for which a quadrature rule is intended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Law {
    /// Constant friction coefficient.
    Dry,
    /// Friction coefficient of an oil.
    Oil,
}

impl Law {
    /// Creates the quadrature rules with the given accuracy.
    fn rules(self, accuracy: f64) -> RulePair {
        match self {
            Self::Dry => {
                RulePair { rule: Quadrature::of(accuracy), check: Quadrature::coarser(accuracy) }
            }
            Self::Oil => RulePair {
                rule: Quadrature::of_oil(accuracy),
                check: Quadrature::coarser_of_oil(accuracy),
            },
        }
    }
}

/// Quadrature rules for several friction laws and accuracies. Each rule is created on first use.
#[derive(Debug, Default)]
pub(crate) struct Rules(Vec<(Law, f64, RulePair)>);

impl Rules {
    /// Returns the quadrature rules for a constant friction coefficient.
    pub(crate) fn dry<const N: usize>(&mut self, accuracies: [f64; N]) -> [&RulePair; N] {
        self.get(accuracies.map(|accuracy| (Law::Dry, accuracy)))
    }

    /// Returns the quadrature rules for an oil.
    pub(crate) fn of_oil<const N: usize>(&mut self, accuracies: [f64; N]) -> [&RulePair; N] {
        self.get(accuracies.map(|accuracy| (Law::Oil, accuracy)))
    }

    /// Returns two quadrature rules with the given accuracy: one for an oil, and one for a constant
    /// friction coefficient.
    pub(crate) fn oil_and_dry(&mut self, accuracy: f64) -> [&Quadrature; 2] {
        self.get([Law::Oil, Law::Dry].map(|law| (law, accuracy))).map(|pair| &pair.rule)
    }

    fn get<const N: usize>(&mut self, requested: [(Law, f64); N]) -> [&RulePair; N] {
        let indices = requested.map(|(law, accuracy)| {
            let is_known = |(known_law, known_accuracy, _): &(Law, f64, RulePair)| {
                law == *known_law && accuracy.total_cmp(known_accuracy).is_eq()
            };
            self.0.iter().position(is_known).unwrap_or_else(|| {
                self.0.push((law, accuracy, law.rules(accuracy)));
                self.0.len() - 1
            })
        });
        indices.map(|index| &self.0[index].2)
    }
}

/// Gauss-Legendre nodes and weights on [0, 1].
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Gauss {
    abscissae: Vec<f64>,
    weights: Vec<f64>,
}

impl Gauss {
    /// Creates the rule with the given number of nodes (at least one).
    fn of(nodes: usize) -> Self {
        let rule = GaussLegendre::new(NonZeroUsize::new(nodes).unwrap_or(NonZeroUsize::MIN));
        let (abscissae, weights) = rule.iter().map(|(x, w)| (0.5 * (x + 1.0), 0.5 * w)).unzip();
        Self { abscissae, weights }
    }

    /// Returns a rule with the same number of nodes, which are concentrated at both ends of the
    /// interval.
    fn graded(&self) -> Self {
        // The nodes are mapped by x² (3 − 2x). The weights are multiplied by the slope 6x (1 − x)
        // of this function.
        let abscissae = self.abscissae.iter().map(|x| x * x * (3.0 - 2.0 * x)).collect();
        let weights = self.abscissae.iter().zip(&self.weights);
        Self { abscissae, weights: weights.map(|(x, w)| w * 6.0 * x * (1.0 - x)).collect() }
    }

    /// Returns the number of nodes.
    pub(super) fn len(&self) -> usize {
        self.abscissae.len()
    }

    /// Returns the nodes and weights of the block that starts at `first`, if it is complete.
    pub(super) fn block(&self, first: usize) -> Option<(&Block, &Block)> {
        let abscissae = self.abscissae[first..].first_chunk()?;
        Some((abscissae, self.weights[first..].first_chunk()?))
    }

    /// Returns an iterator over all nodes and weights.
    pub(super) fn iter(&self) -> impl Iterator<Item = (f64, f64)> {
        self.abscissae.iter().copied().zip(self.weights.iter().copied())
    }

    /// Returns the node with the given index, and its weight.
    pub(super) fn at(&self, node: usize) -> (f64, f64) {
        (self.abscissae[node], self.weights[node])
    }
}

/// Returns the positions and weights of the Gauss-Chebyshev rule of the second kind. The weights
/// add up to one.
fn chebyshev(nodes: u32) -> Vec<(f64, f64)> {
    let steps = f64::from(nodes + 1);
    (1..=nodes)
        .map(|k| {
            let (sin, cos) = (PI * f64::from(k) / steps).sin_cos();
            (cos, 2.0 / steps * sin * sin)
        })
        .collect()
}

/// Maximum number of additional nodes along a chord, beyond the number that the accuracy requires.
const MAX_EXTRA_NODES: usize = 1;

/// Results of [`chebyshev`], indexed by the number of nodes. All quadrature rules share this table,
/// because creating it takes seven times as long as creating the rest of a rule.
static CHEBYSHEV: LazyLock<Vec<Vec<(f64, f64)>>> =
    LazyLock::new(|| (0..).take(MAX_INNER_NODES + MAX_EXTRA_NODES + 1).map(chebyshev).collect());

/// Returns the number of nodes for each part of a split panel, from the number of nodes of a whole
/// panel.
fn part_of_panel(nodes: usize) -> usize {
    (3 * nodes).div_ceil(4)
}

impl Quadrature {
    /// Returns a quadrature rule for a constant friction coefficient. The errors of friction force
    /// and moment, relative to the friction force, are about `accuracy`. The number of nodes per
    /// panel is `$-2\log_{10}\epsilon$`, where `$\epsilon$` is the accuracy.
    pub fn of(accuracy: f64) -> Self {
        Self::with(Self::nodes(accuracy), accuracy, 0)
    }

    /// Returns a quadrature rule for an oil. Because the friction coefficient of an oil has a
    /// transition along each chord, each half of a chord has its own nodes, and chords with a
    /// nearby spin pole have many nodes.
    pub fn of_oil(accuracy: f64) -> Self {
        let nodes = Self::nodes(accuracy);
        Self::lubricated(2 * nodes, 3 * nodes / 4, accuracy)
    }

    fn lubricated(nodes: usize, half: usize, accuracy: f64) -> Self {
        let rule = Self::with(nodes, accuracy, 0);
        Self {
            panel: rule.panel.graded(),
            part: Gauss::of(2 * rule.part.len()),
            near: Gauss::of(4 * rule.part.len()),
            half: Gauss::of(half.min(MAX_RINGS)),
            angles: (1..=MAX_BLOCKS).map(|blocks| half_ring(blocks * BLOCK)).collect(),
            // With N angles on half a ring, the error is e^{−2 N η}.
            ring_pole_distance: (1..=MAX_BLOCKS)
                .map(|blocks| (-accuracy.ln() * part_of_a_node(blocks)).cosh())
                .collect(),
            inner: &rule.inner[..=MAX_LUBRICATED_NODES],
            pole_distance: rule.pole_distance[..=MAX_LUBRICATED_NODES].to_vec(),
        }
    }

    /// Returns the coarser rule for estimating the error of [`Self::of_oil`]. It has fewer nodes in
    /// both directions.
    pub(crate) fn coarser_of_oil(accuracy: f64) -> Self {
        let nodes = Self::nodes(accuracy);
        Self::lubricated(nodes, (3 * nodes / 4).saturating_sub(2), 10.0 * accuracy)
    }

    /// Returns a sufficient number of blocks of angles on half a ring for a given slip. The result
    /// is zero if the poles are so close that integration along chords is more efficient.
    pub(super) fn angle_blocks(&self, slip: &EllipseSlip<f64>) -> usize {
        let pole_distance = slip.poles().map(|Pole { at, width }| {
            // |z − 1| + |z + 1| = 2 cosh η for a pole z
            let square = width * width;
            0.5 * (((at - 1.0).powi(2) + square).sqrt() + ((at + 1.0).powi(2) + square).sqrt())
        });
        let pole_distance = pole_distance[0].min(pole_distance[1]);
        self.ring_pole_distance
            .iter()
            .position(|least| pole_distance >= *least)
            .map_or(0, |index| index + 1)
    }

    /// Returns the minimum `$\sinh^2\eta$` for which a spin pole counts as outside the ellipse.
    pub(super) fn min_outside_distance(&self) -> f64 {
        self.pole_distance.last().copied().unwrap_or(f64::INFINITY)
    }

    /// Returns true if the rule is intended for a constant friction coefficient.
    pub(super) fn is_dry(&self) -> bool {
        self.angles.is_empty()
    }

    /// Returns the number of nodes per panel for a given accuracy.
    fn nodes(accuracy: f64) -> usize {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "the number of nodes is small and positive"
        )]
        // Subtracting 1e-9 prevents a rounding error from adding a node if the accuracy is a power
        // of ten.
        let nodes = (-2.0 * accuracy.log10() - 1e-9).ceil() as usize;
        nodes.max(1)
    }

    /// Returns the coarser rule for the error estimate. It has fewer nodes per panel, but one more
    /// node along each chord. With equal numbers of nodes along the chords, both rules would have
    /// equal errors along the chords, and the estimate would not detect these errors.
    pub(crate) fn coarser(accuracy: f64) -> Self {
        Self::with(part_of_panel(Self::nodes(accuracy)), accuracy, 1)
    }

    /// Creates a rule with `nodes` nodes per panel. Along each chord, it has as many nodes as an
    /// error of `tolerance` requires, plus `more` nodes (at most [`MAX_EXTRA_NODES`]).
    pub(crate) fn with(nodes: usize, tolerance: f64, more: usize) -> Self {
        let part = Gauss::of(part_of_panel(nodes));
        // The sufficient number of nodes at η is m = max(2, ⌈−ln ε/(2η)⌉ − 1)       (T19)
        let pole_distance = |m: u32| {
            let eta = -tolerance.ln() / (2.0 * f64::from(m + 1));
            if m < 2 { f64::INFINITY } else { eta.sinh().powi(2) }
        };
        Self {
            panel: Gauss::of(nodes),
            near: part.clone(),
            half: part.clone(),
            part,
            angles: Vec::new(),
            ring_pole_distance: Vec::new(),
            inner: &CHEBYSHEV[more..=more + MAX_INNER_NODES],
            pole_distance: (0..).take(MAX_INNER_NODES + 1).map(pole_distance).collect(),
        }
    }

    /// Returns the number of nodes for a chord with the given `$\sinh^2\eta$`, or `None` if the
    /// spin pole is so close that the maximum number is not sufficient.
    pub(super) fn count(&self, square: f64) -> Option<usize> {
        // The limits decrease with the number of nodes, so the number is found without branches by
        // counting the limits that are exceeded.
        let number =
            self.pole_distance.iter().filter(|pole_distance| square < **pole_distance).count();
        (number < self.pole_distance.len()).then_some(number)
    }
}
