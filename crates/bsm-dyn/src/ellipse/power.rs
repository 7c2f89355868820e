//! The power of friction over the ellipses of several contacts side by side.
//!
//! Theory: `docs/theory/09-traction.md`, equations (T14) to (T20).

use bsm_simd::{BLOCK, Lane, Mask, Simd};

use super::Quadrature;
use super::panels::line;
use super::slip::{EllipseSlip, clamp};

/// Power of friction over `$f Q$` of several contacts side by side, and at which of them the rule
/// resolves it without splitting panels: the sums of `Ellipse::friction`.
///
/// For rules of [`BLOCK`] nodes a panel, so that the lines of a panel are worked on together there too.
#[inline(always)]
pub fn power_of_many<S: Simd, const N: usize>(
    rule: &Quadrature,
    slip: &EllipseSlip<Lane<S, N>>,
) -> (Lane<S, N>, Mask<S, N>) {
    debug_assert_eq!(rule.panel.len(), BLOCK, "lines of two panels would share their inner nodes");
    let zero = slip.creep.constant(0.0);
    let poles = slip.poles();
    let middle = clamp((poles[0].at + poles[1].at) * 0.5, -1.0, 1.0);
    let ends = [[zero.constant(-1.0), middle], [middle, zero.constant(1.0)]];
    let (mut power, mut resolved, least) = (zero, zero.le(zero), zero.constant(rule.least()));
    for (pole, [low, high]) in poles.iter().zip(ends) {
        let from = ((low - pole.at) / pole.width).arsinh();
        let length = ((high - pole.at) / pole.width).arsinh() - from;
        let (mut lines, mut square) = ([(zero, zero); BLOCK], zero.constant(f64::INFINITY));
        for (node, of_node) in lines.iter_mut().enumerate() {
            let (abscissa, part) = rule.panel.at(node);
            *of_node = line(pole, length * abscissa + from, length * part);
            square = square.min(slip.analyticity(of_node.0));
        }
        // Panels of no length have no weight, and poles on their ends do not split them.
        let within = low.lt(pole.at) & pole.at.lt(high);
        resolved = resolved & (!within | least.le(slip.analyticity(pole.at))) & least.le(square);
        power = add_power(rule, slip, &lines, square, power);
    }
    (power, resolved)
}

/// Most contacts side by side.
const MANY: usize = 4 * BLOCK;

/// Adds what friction takes along the lines of a panel.
///
/// * `lines`: places on the long axis, and parts of the load. * `square`: the least `$\sinh^2\eta$` of the lines.
#[inline(always)]
fn add_power<S: Simd, const N: usize>(
    rule: &Quadrature,
    slip: &EllipseSlip<Lane<S, N>>,
    lines: &[(Lane<S, N>, Lane<S, N>); BLOCK],
    square: Lane<S, N>,
    mut power: Lane<S, N>,
) -> Lane<S, N> {
    let (mut inner, mut most) = ([&[][..]; MANY], 0);
    for (inner, square) in inner.iter_mut().zip(square.as_slice()) {
        *inner = rule.count(*square).map_or(&[][..], |count| &rule.inner[count]);
        most = most.max(inner.len());
    }
    for k in 0..most {
        // Each contact has its own nodes along the lines, and none beyond its last.
        let (mut abscissae, mut parts) = ([0.0; MANY], [0.0; MANY]);
        for (i, inner) in inner[..Lane::<S, N>::LEN].iter().enumerate() {
            if let Some((abscissa, part)) = inner.get(k) {
                (abscissae[i], parts[i]) = (*abscissa, *part);
            }
        }
        let (s, part) = (power.like(&abscissae), power.like(&parts));
        for (xi, weight) in *lines {
            let (v_t, (b_0, b_1)) = (slip.along(xi), slip.across(xi));
            let v_c = b_0 + b_1 * s;
            let square = v_t * v_t + v_c * v_c;
            // dP = −dF·v                                                  (E6)
            let pull = (square + slip.creep * slip.creep).sqrt();
            power = power + square * (weight * part) / pull;
        }
    }
    power
}
