//! Friction powers of several contact ellipses, calculated side by side.
//!
//! Theory: `docs/theory/09-traction.md`, equations (T14) to (T20).

use bsm_kin::Real;
use bsm_simd::{BLOCK, Lane, Mask, Simd};

use super::Quadrature;
use super::kernel::{Dry, Patch, sums};
use super::oil::OilLaw;
use super::panels::chord;
use super::placement::Placement;
use super::slip::{EllipseSlip, clamp};
use crate::contact::MixedFriction;

/// Returns the friction power, divided by `$f Q$`, of several contacts side by side. Also returns a
/// mask that is true for contacts where the quadrature is accurate without splitting panels. The
/// results equal those of `Ellipse::friction`.
/// The quadrature must have [`BLOCK`] nodes per panel, because only then does `Ellipse::friction`
/// also process the chords of a panel together.
#[inline(always)]
pub fn power_of_many<S: Simd, const N: usize>(
    rule: &Quadrature,
    slip: &EllipseSlip<Lane<S, N>>,
) -> (Lane<S, N>, Mask<S, N>) {
    debug_assert_eq!(rule.panel.len(), BLOCK, "each panel must have one block of nodes");
    let zero = slip.creep.constant(0.0);
    let poles = slip.poles();
    let middle = clamp((poles[0].at + poles[1].at) * 0.5, -1.0, 1.0);
    let ends = [[zero.constant(-1.0), middle], [middle, zero.constant(1.0)]];
    let (mut power, mut resolved, least) =
        (zero, zero.mask(true), zero.constant(rule.min_outside_distance()));
    for (pole, [low, high]) in poles.iter().zip(ends) {
        let from = ((low - pole.at) / pole.width).arsinh();
        let length = ((high - pole.at) / pole.width).arsinh() - from;
        let (mut chords, mut square) = ([(zero, zero); BLOCK], zero.constant(f64::INFINITY));
        for (node, of_node) in chords.iter_mut().enumerate() {
            let (abscissa, part) = rule.panel.at(node);
            *of_node = chord(pole, length * abscissa + from, length * part);
            square = square.min(slip.analyticity(of_node.0));
        }
        // Panels of zero length contribute nothing, and a pole at the end of a panel does not split
        // it.
        let within = low.lt(pole.at) & pole.at.lt(high);
        resolved = resolved & (!within | least.le(slip.analyticity(pole.at))) & least.le(square);
        power = add_power(rule, slip, &chords, square, power);
    }
    (power, resolved)
}

/// Maximum number of contacts that are processed side by side.
const MAX_CONTACTS: usize = 4 * BLOCK;

/// Adds the friction power along the chords of one panel.
///
/// * `chords`: positions of the chords on the long axis, and fractions of the load that the chords
///   carry.
/// * `square`: smallest `$\sinh^2\eta$` of the chords (T18).
#[inline(always)]
fn add_power<S: Simd, const N: usize>(
    rule: &Quadrature,
    slip: &EllipseSlip<Lane<S, N>>,
    chords: &[(Lane<S, N>, Lane<S, N>); BLOCK],
    square: Lane<S, N>,
    mut power: Lane<S, N>,
) -> Lane<S, N> {
    let (mut inner, mut most) = ([&[][..]; MAX_CONTACTS], 0);
    for (inner, square) in inner.iter_mut().zip(square.as_slice()) {
        *inner = rule.count(*square).map_or(&[][..], |count| &rule.inner[count]);
        most = most.max(inner.len());
    }
    for k in 0..most {
        // Each contact has its own nodes along the chords. Unused nodes have zero weights.
        let (mut abscissae, mut parts) = ([0.0; MAX_CONTACTS], [0.0; MAX_CONTACTS]);
        for (i, inner) in inner[..Lane::<S, N>::LEN].iter().enumerate() {
            if let Some((abscissa, part)) = inner.get(k) {
                (abscissae[i], parts[i]) = (*abscissa, *part);
            }
        }
        let (s, part) = (power.load_like(&abscissae), power.load_like(&parts));
        for (xi, weight) in *chords {
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

/// Returns the friction powers at nut and screw, divided by `$Q$`, for several points. The powers
/// are calculated twice: with the oil films, and with a friction coefficient of one. The nodes of
/// one point already fill the SIMD vectors, so the points are processed one after the other.
///
/// * `laws`: friction laws of the oil films at nut and screw.
/// * `wanted`: mask of the points to calculate. The results for other points are NaN.
/// * `rules`: quadrature rules for an oil and for a constant friction coefficient.
#[inline(always)]
pub fn lubricated_powers<S: Simd, const N: usize>(
    simd: S,
    patches: &[Patch<Lane<S, N>>; 2],
    laws: [&MixedFriction<Lane<S, N>>; 2],
    wanted: Mask<S, N>,
    rules: [&Quadrature; 2],
) -> [[Lane<S, N>; 2]; 2] {
    let ([oil, dry], mut is_wanted) =
        (rules.map(|rule| [Placement::from(rule); 2]), [false; MAX_CONTACTS]);
    wanted.store(&mut is_wanted);
    let mut powers = [[[f64::NAN; MAX_CONTACTS]; 2]; 2];
    for row in (0..Lane::<S, N>::LEN).filter(|row| is_wanted[*row]) {
        let points = patches.each_ref().map(|patch| patch.at(row));
        let laws = laws.map(|law| OilLaw::of(&law.map(|lane| lane.as_slice()[row])));
        let found = [
            sums::<S, _, 4, false>(simd, &points, &laws, &oil, [false; 2]),
            sums::<S, _, 2, false>(simd, &points, &[Dry; 2], &dry, [false; 2]),
        ];
        for (powers, found) in powers.iter_mut().flatten().zip(found.iter().flatten()) {
            powers[row] = found.power;
        }
    }
    powers.map(|powers| powers.map(|powers| patches[0].creep.load_like(&powers)))
}
