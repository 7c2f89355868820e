//! Nut and screw as elastic bodies: bars along the axis, and rings that widen.
//!
//! Theory: `docs/theory/16-nut.md`, equations (U13), (U14) and (U28).

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
    /// Outer diameter \[m\], above the inner one.
    pub outer: f64,
    /// Inner diameter \[m\], positive.
    pub inner: f64,
    /// Young's modulus \[Pa\], positive.
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
    ///
    /// * `twists`: the screw is held against rotation at its anchor too, so that the torque of each ball twists
    ///   it, which moves its groove along the axis.
    pub fn screw_stiffness(&self, twists: bool) -> f64 {
        let [screw, _] = self.groove_diameters();
        let steel = self.material.0;
        // EA = E π/4 D_s²                                                 (U13)
        let axial = steel.youngs_modulus * 0.25 * PI * screw * screw;
        if !twists {
            return axial;
        }
        let per_radian = self.helix.lead() / std::f64::consts::TAU;
        // G = E/(2 (1 + ν)),  J = π/32 D_s⁴,  1/EA + h²/GJ                (U28)
        let shear = 0.5 * steel.youngs_modulus / (1.0 + steel.poisson_ratio);
        let torsional = shear * PI / 32.0 * screw.powi(4);
        (axial.recip() + per_radian * per_radian / torsional).recip()
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

/// A node, the next one or the anchor, and the stiffness between them \[N/m\].
type BarSpring = (usize, Option<usize>, f64);

impl Bar {
    /// The springs between places in ascending order, each from a node to another one or to the anchor, with
    /// its stiffness; and the node at the anchor, if there is one.
    pub(crate) fn springs(&self, nodes: &[f64]) -> (Vec<BarSpring>, Option<usize>) {
        let mut springs = Vec::new();
        // Places nearer than this are one: rounding of the helix angle.
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
