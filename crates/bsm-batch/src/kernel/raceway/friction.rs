//! Friction power of rolling ellipses by lanes, Eqs (E1) to (E6), (P7).
//!
//! Both contact centres roll along the groove, so that the slip along it is that of the spin and of
//! the curved ellipse only: the four nodes that differ in signs share all products, and at the race
//! without spin they are one.

use std::sync::LazyLock;

use bsm_dyn::{Quadrature, RacewayControl};
use bsm_simd::Simd;

use crate::operand::{Lane, Mask};

/// Nodes of a ring in a quadrant.
const NODES: usize = RacewayControl::ORDER.get() / 2;

/// A ring of nodes of equal weight, by its first quadrant.
struct Ring {
    /// Coordinates over the semi-axes.
    nodes: [[f64; 2]; NODES],
    /// Of one node.
    weight: f64,
}

static RINGS: LazyLock<Vec<Ring>> = LazyLock::new(|| {
    let all = Quadrature::new(RacewayControl::ORDER);
    let quadrant: Vec<_> =
        all.nodes().iter().copied().filter(|(x, y, _)| *x > 0.0 && *y > 0.0).collect();
    let (rings, _) = quadrant.as_chunks::<NODES>();
    rings
        .iter()
        .map(|ring| Ring { nodes: ring.map(|(x, y, _)| [x, y]), weight: ring[0].2 })
        .collect()
});

/// A rolling ellipse in units of ball radius and relative speed.
pub(super) struct Ellipse<S: Simd> {
    /// `$Q/F_a$`.
    pub(super) load: Lane<S>,
    /// Across and along the groove.
    pub(super) semi_axes: [Lane<S>; 2],
    pub(super) pressed_radius: Lane<S>,
    /// Angular velocity about `$t \times N$`, and about `$N$`.
    pub(super) roll: Lane<S>,
    pub(super) spin: Lane<S>,
}

/// `$\sum v^2/\sqrt{v^2 + v_e^2}$` of four squares of the slip, by one division.
#[inline(always)]
fn four<S: Simd>([a, b, c, d]: [Lane<S>; 4]) -> Lane<S> {
    // dP = −dF·v,  dF = −f dQ v/√(v² + v_e²)                              (E4), (E6)
    let creep = RacewayControl::CREEP * RacewayControl::CREEP;
    let (r_a, r_b) = ((a + creep).sqrt(), (b + creep).sqrt());
    let (r_c, r_d) = ((c + creep).sqrt(), (d + creep).sqrt());
    let (r_ab, r_cd) = (r_a * r_b, r_c * r_d);
    ((a * r_b + b * r_a) * r_cd + (c * r_d + d * r_c) * r_ab) / (r_ab * r_cd)
}

impl<S: Simd> Ellipse<S> {
    /// This ellipse where the mask says so, another elsewhere.
    #[inline(always)]
    pub(super) fn or(&self, this: Mask<S>, other: &Self) -> Self {
        let ([a, b], [c, d]) = (self.semi_axes, other.semi_axes);
        Self {
            load: this.select(self.load, other.load),
            semi_axes: [this.select(a, c), this.select(b, d)],
            pressed_radius: this.select(self.pressed_radius, other.pressed_radius),
            roll: this.select(self.roll, other.roll),
            spin: this.select(self.spin, other.spin),
        }
    }

    /// `$a^2/(2 R_c)$`, the sag of the ellipse at its end.
    #[inline(always)]
    fn sag(&self) -> Lane<S> {
        let a = self.semi_axes[0];
        a * a * 0.5 / self.pressed_radius
    }

    /// Power over `$f Q$` without spin; `across`: slip across the groove at the centre.
    #[inline(always)]
    pub(super) fn power_without_spin(&self, across: Lane<S>) -> Lane<S> {
        let sag = self.sag();
        let (along, less) = (self.roll * sag, across * sag);
        let mut sum = sag.constant(0.0);
        for ring in RINGS.iter() {
            let mut squares = [sum; NODES];
            for ([x, _], square) in ring.nodes.iter().zip(&mut squares) {
                // v = (ω_c (h − r_b), −ω_t h),  h = r_b − x²/(2 R_c)      (E3)
                let (v_t, v_c) = (along * (x * x), across - less * (x * x));
                *square = v_t * v_t + v_c * v_c;
            }
            sum = sum + four(squares) * (4.0 * ring.weight);
        }
        sum
    }

    /// Power over `$f Q$`; `across`: slip across the groove at the centre.
    #[inline(always)]
    pub(super) fn power(&self, across: Lane<S>) -> Lane<S> {
        let sag = self.sag();
        let (along, less) = (self.roll * sag, across * sag);
        let [a, b] = self.semi_axes;
        let (turn_t, turn_c) = (self.spin * a, self.spin * b);
        let mut sum = sag.constant(0.0);
        for ring in RINGS.iter() {
            let mut losses = sag.constant(0.0);
            for [x, y] in ring.nodes {
                // v = (ω_N x + ω_c (h − r_b), −ω_t h − ω_N y)             (E3)
                let (v_t, d_t) = (along * (x * x), turn_t * x);
                let (v_c, d_c) = (across - less * (x * x), turn_c * y);
                let (t_0, t_1, c_0, c_1) = (v_t - d_t, v_t + d_t, v_c - d_c, v_c + d_c);
                let (t_0, t_1, c_0, c_1) = (t_0 * t_0, t_1 * t_1, c_0 * c_0, c_1 * c_1);
                losses = losses + four([t_0 + c_0, t_0 + c_1, t_1 + c_0, t_1 + c_1]);
            }
            sum = sum + losses * ring.weight;
        }
        sum
    }
}
