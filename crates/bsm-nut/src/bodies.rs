//! Elastic bodies of nut and screw: bars along the axis, and rings that expand radially.
//!
//! Theory: `docs/theory/16-nut.md`, equations (U13) and (U14).

use std::f64::consts::TAU;

/// An axially elastic body (nut or screw).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bar {
    /// Axial rigidity `$EA$`, Young's modulus times cross-sectional area \[N\], positive.
    pub stiffness: f64,
    /// Axial position of the anchor, where the axial force leaves the body \[m\].
    pub anchor: f64,
}

/// The part of the nut that surrounds the balls, modeled as a tube.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ring {
    /// Outer diameter \[m\], larger than the inner diameter.
    pub outer_diameter: f64,
    /// Inner diameter \[m\], positive.
    pub inner_diameter: f64,
    /// Young's modulus \[Pa\], positive.
    pub youngs_modulus: f64,
}

impl Ring {
    /// Returns the radial stiffness of the tube around one circuit \[N/m\] (U14).
    ///
    /// * `lead`: lead of the screw \[m\].
    /// * `arc`: angle of the loaded part of the circuit \[rad\].
    pub fn stiffness(&self, lead: f64, arc: f64) -> f64 {
        let (outer, inner) =
            (self.outer_diameter * self.outer_diameter, self.inner_diameter * self.inner_diameter);
        let height = lead / TAU;
        // k_r = E h Θ_c 2π / [(D² + D_t²)/(D² − D_t²) + 1]                (U14)
        self.youngs_modulus * height * arc * TAU / ((outer + inner) / (outer - inner) + 1.0)
    }
}

/// A spring that represents a section of a bar. It consists of the index of a node, the index of
/// the second node (or `None` for the anchor), and the stiffness \[N/m\].
type BarSpring = (usize, Option<usize>, f64);

impl Bar {
    /// Returns the springs that represent the bar, and the index of the node at the anchor, if
    /// there is one. Nodes are given by their axial positions in ascending order. Each spring
    /// connects two nodes, or a node and the anchor.
    pub(crate) fn springs(&self, nodes: &[f64]) -> (Vec<BarSpring>, Option<usize>) {
        let mut springs = Vec::new();
        // Two positions count as equal if their difference is within the rounding error of the
        // helix angle.
        let near = 1e-12 * nodes.iter().fold(self.anchor.abs(), |most, z| most.max(z.abs()));
        let at = nodes.iter().position(|z| (z - self.anchor).abs() <= near);
        let held = |node: usize| (node, None, self.stiffness / (nodes[node] - self.anchor).abs());
        // E_chain = ½ Σ EA/Δz (n_(i+1) − n_i)²,  n(z_F) = 0               (U13)
        for i in 0..nodes.len().saturating_sub(1) {
            let split = at.is_none() && nodes[i] < self.anchor && self.anchor < nodes[i + 1];
            if split {
                springs.extend([held(i), held(i + 1)]);
            } else {
                springs.push((i, Some(i + 1), self.stiffness / (nodes[i + 1] - nodes[i])));
            }
        }
        if let (None, Some(first), Some(last)) = (at, nodes.first(), nodes.last()) {
            if self.anchor < *first {
                springs.push(held(0));
            } else if self.anchor > *last {
                springs.push(held(nodes.len() - 1));
            }
        }
        (springs, at)
    }
}
