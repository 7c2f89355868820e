//! On every instruction set, formulas evaluated with SIMD vectors give the same results as formulas
//! evaluated with single numbers, except for rounding errors.

use bsm_dyn::{
    Material,
    angles::Sines,
    gothic::TwoContacts,
    hertz::{Axes, Groove, Hertz, Raceway, contact_modulus, pressed_radius},
};
use bsm_kin::Real;
use bsm_simd::{BLOCK, Block, Lane, Simd, WithSimd};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Number of inputs per point: pitch circle radius, lead angle, contact angle, conformity, two
/// Young's moduli, Poisson's ratio, friction coefficient, and rolling ratio.
const INPUTS: usize = 9;
/// Number of results for each point.
const OUTPUTS: usize = 13;

/// Evaluates all formulas for a point with a ball radius of 1. `flags` states whether the load
/// back-drives the screw and whether the nut rotates.
#[inline(always)]
fn formulas<D: Real>(
    x: [D; INPUTS],
    sines: Sines<D>,
    member: Raceway,
    flags: [D::Mask; 2],
) -> [D; OUTPUTS] {
    let [pitch, _, _, conformity, young, ball_young, poisson, friction, rolling] = x;
    let [back, nut_turns] = flags;
    let one = pitch.constant(1.0);
    let material = |youngs_modulus| Material { youngs_modulus, poisson_ratio: poisson };
    let modulus = contact_modulus(&material(young), &material(ball_young));
    let groove = Groove { member, conformity };
    let curvatures = groove.curvatures_at(pitch, one, sines.tan_a(), sines.cos_b);
    let axes = Axes::of_practical_ratio(curvatures.longitudinal / curvatures.transverse);
    let hertz = Hertz::with_axes(&axes, &curvatures, modulus);
    let contacts = TwoContacts {
        sines,
        friction,
        rolling_ratio: rolling,
        size_ratio: pitch.recip(),
        nut_turns,
    };
    [
        modulus,
        groove.offset(one),
        curvatures.longitudinal,
        curvatures.transverse,
        pressed_radius(conformity, one),
        hertz.flatness,
        hertz.semi_axis,
        hertz.compliance,
        hertz.second_integral,
        sines.efficiency(back, friction),
        sines.load_ratio(back, friction),
        contacts.efficiency(back),
        contacts.load_ratio(),
    ]
}

#[derive(Clone, Copy)]
struct Points {
    inputs: [Block; INPUTS],
    /// Sines and cosines of lead angle and contact angle.
    sines: [Block; 4],
    member: Raceway,
    flags: [bool; 2],
}

impl WithSimd for Points {
    type Output = [Block; OUTPUTS];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let mut outputs = [[0.0; BLOCK]; OUTPUTS];
        for at in (0..BLOCK).step_by(S::F64_LANES) {
            let zero = Lane::<S>::splat(simd, 0.0);
            let mask = |yes: bool| if yes { zero.le(zero) } else { zero.lt(zero) };
            let [sin_a, cos_a, sin_b, cos_b] = self.sines.map(|x| Lane::load(simd, &x[at..]));
            let found = formulas(
                self.inputs.map(|x| Lane::<S>::load(simd, &x[at..])),
                Sines { sin_a, cos_a, sin_b, cos_b },
                self.member,
                self.flags.map(mask),
            );
            for (output, found) in outputs.iter_mut().zip(found) {
                found.store(&mut output[at..]);
            }
        }
        outputs
    }
}

#[test]
fn simd_formulas_match_scalar_formulas() {
    let mut rng = ChaCha8Rng::seed_from_u64(18);
    for round in 0..500 {
        let mut points = Points {
            inputs: [[0.0; BLOCK]; INPUTS],
            sines: [[0.0; BLOCK]; 4],
            member: if round % 2 == 0 { Raceway::Nut } else { Raceway::Screw },
            flags: [round % 4 < 2, round % 8 < 4],
        };
        for i in 0..BLOCK {
            let (lead, contact) = (rng.random_range(0.02..0.8_f64), rng.random_range(0.3..1.3_f64));
            let point = [
                rng.random_range(3.0..20.0),
                lead,
                contact,
                0.5 + 10.0_f64.powf(rng.random_range(-3.0..-0.5)),
                rng.random_range(1e11..3e11),
                rng.random_range(1e11..3e11),
                rng.random_range(0.2..0.4),
                10.0_f64.powf(rng.random_range(-3.0..-1.0)),
                rng.random_range(0.0..1e-3),
            ];
            for (input, x) in points.inputs.iter_mut().zip(point) {
                input[i] = x;
            }
            let sines = [lead.sin(), lead.cos(), contact.sin(), contact.cos()];
            for (sine, x) in points.sines.iter_mut().zip(sines) {
                sine[i] = x;
            }
        }
        let Points { inputs, sines, member, flags } = points;
        for arch in bsm_simd::instruction_sets() {
            let found = arch.dispatch(points);
            for i in 0..BLOCK {
                let [sin_a, cos_a, sin_b, cos_b] = sines.map(|x| x[i]);
                let sines = Sines { sin_a, cos_a, sin_b, cos_b };
                let expected = formulas(inputs.map(|x| x[i]), sines, member, flags);
                for (number, (found, expected)) in found.iter().zip(expected).enumerate() {
                    // The cube root of a SIMD vector differs from the cube root of a single number
                    // by at most four units in the last place (9e-16), and the compliance adds
                    // three rounding errors. All other arithmetic is identical.
                    let close = (found[i] - expected).abs() <= 1.5e-15 * expected.abs();
                    assert!(close, "{arch:?}: {number}: {} {expected}", found[i]);
                }
            }
        }
    }
}
