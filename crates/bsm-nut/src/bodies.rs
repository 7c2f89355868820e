//! Nut and screw as elastic bodies: bars along the axis, and rings that widen.
//!
//! Theory: `docs/theory/16-nut.md`, equations (U13) and (U14).

use std::f64::consts::PI;

use crate::{BallNut, Circuit};

/// A body that strains along the axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bar {
    /// Young's modulus times cross section `$EA$` \[N\], positive.
    pub stiffness: f64,
    /// Where its force leaves, a place along the axis \[m\].
    pub anchor: f64,
}

/// The tube around the balls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ring {
    /// Outer diameter \[m\].
    pub outer: f64,
    /// Inner diameter \[m\].
    pub inner: f64,
    /// Young's modulus \[Pa\].
    pub youngs_modulus: f64,
}

impl BallNut {
    /// Diameters to which the grooves of screw and nut reach at the contacts \[m\].
    pub fn groove_diameters(&self) -> [f64; 2] {
        let (middle, ball) = (2.0 * self.helix.radius, 2.0 * self.ball.radius);
        let across = ball * self.contact_angle.cos();
        // D_t = 2 r_m ± 2 r_b cosβ₀                                       (U13)
        [middle - across, middle + across]
    }

    /// Young's modulus times cross section of the screw \[N\]: a shaft as thick as its groove is deep.
    pub fn screw_stiffness(&self) -> f64 {
        let [screw, _] = self.groove_diameters();
        // EA = E π/4 D_s²                                                 (U13)
        self.material.0.youngs_modulus * 0.25 * PI * screw * screw
    }

    /// Young's modulus times cross section \[N\] of a nut of this outer diameter \[m\]: a tube to its groove.
    pub fn nut_stiffness(&self, outer: f64) -> f64 {
        let [_, inner] = self.groove_diameters();
        // EA = E π/4 (D₁² − D_t²)                                         (U13)
        self.material.0.youngs_modulus * 0.25 * PI * (outer * outer - inner * inner)
    }
}

impl Ring {
    /// Stiffness of the tube around a circuit against its widening \[N/m\] (U14).
    pub fn stiffness(&self, nut: &BallNut, circuit: &Circuit) -> f64 {
        let (outer, inner) = (self.outer * self.outer, self.inner * self.inner);
        let height = nut.helix.lead() / std::f64::consts::TAU;
        // k_r = E h Θ_c 2π / [(D² + D_t²)/(D² − D_t²) + 1]                (U14)
        self.youngs_modulus * height * circuit.arc * std::f64::consts::TAU
            / ((outer + inner) / (outer - inner) + 1.0)
    }
}

/// A spring of a chain: between a node and the next one, or between a node and the anchor.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Spring {
    Between(usize, f64),
    Held(usize, f64),
}

impl Bar {
    /// The springs between places in ascending order, and the node at the anchor, if there is one.
    pub(crate) fn springs(&self, nodes: &[f64]) -> (Vec<Spring>, Option<usize>) {
        let mut springs = Vec::new();
        // Places nearer than this are one: rounding of the helix angle.
        let near = 1e-12 * nodes.iter().fold(self.anchor.abs(), |most, z| most.max(z.abs()));
        let at = nodes.iter().position(|z| (z - self.anchor).abs() <= near);
        let held =
            |node: usize| Spring::Held(node, self.stiffness / (nodes[node] - self.anchor).abs());
        // E_chain = ½ Σ EA/Δz (n_(i+1) − n_i)²,  n(z_F) = 0               (U13)
        for i in 0..nodes.len().saturating_sub(1) {
            let split = at.is_none() && nodes[i] < self.anchor && self.anchor < nodes[i + 1];
            if split {
                springs.extend([held(i), held(i + 1)]);
            } else {
                springs.push(Spring::Between(i, self.stiffness / (nodes[i + 1] - nodes[i])));
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
