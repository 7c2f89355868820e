//! Friction sums over a contact ellipse, with derivatives, for several nodes at once.
//!
//! The friction law is the same as in [`Patch::integrate`]. Tests compare both implementations.

#![expect(
    clippy::needless_range_loop,
    reason = "indices of vectors and matrices are written as in the equations"
)]

use bsm_kin::Real;
use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI};

use bsm_simd::{Arch, BLOCK, Block, Lane, Mask, NullaryFnOnce, Simd, WithSimd, polynomial};

use super::Quadrature;
use super::chords::{AddChords, Chords, for_each_chord};
use super::placement::Placement;
use super::slip::{EllipseSlip, FAR_LIMIT, clamp};
use crate::cost;

/// Dimensions and motion of a contact, in contact coordinates, from which friction is integrated.
#[derive(Debug, Clone, Copy)]
pub struct Patch<F = f64> {
    /// Semi-axes across and along the groove.
    pub semi_axes: (F, F),
    /// Radius of the deformed contact surface across the groove.
    pub pressed_radius: F,
    /// Ball radius.
    pub ball_radius: F,
    /// Speed of the ball center along t, and angular velocity about t, N and t × N, relative to the
    /// nut or the screw.
    pub motion: [F; MOTION],
    /// Creep speed.
    pub creep: F,
}

/// Integrated friction of a contact, divided by `$Q$` or, for a constant friction coefficient, by
/// `$f Q$`.
#[derive(Clone, Copy)]
pub(crate) struct Resultants<F = f64> {
    /// Friction force along t and t × N, and friction moment about t, N and t × N.
    pub(crate) values: [F; SUMS],
    /// Friction power of the contact.
    pub(crate) power: F,
    /// Derivatives of force and moment with respect to the motion and to the logarithm of the size
    /// of the ellipse.
    pub(crate) slopes: [[F; SLOPES]; SUMS],
    /// Derivatives of force and moment with respect to the logarithm of the film thickness; zero
    /// without a lubricant.
    pub(crate) by_film: [F; SUMS],
}

/// Number of components of the motion of the ball.
pub(crate) const MOTION: usize = 4;
/// Number of sums for the components of force and moment.
pub(crate) const SUMS: usize = 5;
/// Number of derivatives, which are taken with respect to the components of the motion and the size
/// of the ellipse.
pub(crate) const SLOPES: usize = MOTION + 1;

/// Number of sums for force, moment and power.
pub(super) const VALUES: usize = SUMS + 1;
/// Total number of sums, including the sums for the derivatives.
pub(super) const ALL: usize = VALUES + 14;

impl<F: Real> Patch<F> {
    /// Returns the slip over the ellipse as a function of the position.
    #[inline(always)]
    pub fn slip(&self) -> EllipseSlip<F> {
        let ([speed, w_t, w_n, w_c], radii) =
            (self.motion, (self.pressed_radius, self.ball_radius));
        EllipseSlip::new(self.semi_axes, radii, speed, [w_t, w_n, w_c], self.creep)
    }
}

impl<S: Simd, const N: usize> Patch<Lane<S, N>> {
    /// Returns one of several contacts that are stored side by side.
    #[inline(always)]
    pub(super) fn at(&self, index: usize) -> Patch {
        let number = |lane: &Lane<S, N>| lane.as_slice()[index];
        let Self { semi_axes: (a, b), pressed_radius, ball_radius, motion, creep } = self;
        Patch {
            semi_axes: (number(a), number(b)),
            pressed_radius: number(pressed_radius),
            ball_radius: number(ball_radius),
            motion: motion.each_ref().map(number),
            creep: number(creep),
        }
    }
}

/// Nodes along a block of chords whose spin poles (the points without slip) are inside the contact
/// ellipse.
pub(super) struct NearPole<S: Simd> {
    /// Angular position and angular width of the spin pole.
    at: Lane<S>,
    width: Lane<S>,
    sides: [NearSide<S>; 2],
}

/// One side of a spin pole: its length in the variable of the sinh transformation, the exponentials
/// of this variable at both ends of the side, and the reciprocals of these exponentials.
type NearSide<S> = (Lane<S>, [Lane<S>; 2], [Lane<S>; 2]);

impl<S: Simd> NearPole<S> {
    #[inline(always)]
    pub(super) fn of(slip: &EllipseSlip<Lane<S>>, xi: Lane<S>) -> Self {
        let sinh = slip.analyticity(xi).sqrt();
        let ((b_0, b_1), one) = (slip.across(xi), xi.constant(1.0));
        // The nodes s = cos φ are concentrated around φ₀, where cos φ₀ = −Re z/cosh η, within the
        // width η ≈ sinh η (T20).
        let cos = -(b_0 / b_1) / sinh.mul_add(sinh, one).sqrt();
        let (at, width) = (angle(cos), clamp(sinh, 1e-100, FAR_LIMIT));
        let (below, above) = ((at / width).arsinh(), ((-at + PI) / width).arsinh());
        let [low, high] = [below.exp(), above.exp()];
        let [low, high] = [[low.recip(), low], [high, high.recip()]];
        let sides =
            [(below, [low[0], one], [low[1], one]), (above, [one, high[0]], [one, high[1]])];
        Self { at, width, sides }
    }

    /// Returns the number of pairs of nodes around a spin pole.
    pub(super) fn pairs(rule: &Quadrature) -> usize {
        2 * rule.near.len().div_ceil(2)
    }

    /// Returns positions and weights of two nodes at equal distances from the two ends of a side.
    /// Both nodes are calculated from one exponential. If the middle node is paired with itself,
    /// the second weight is zero.
    #[inline(always)]
    pub(super) fn pair(&self, rule: &Quadrature, pair: usize) -> [(Lane<S>, Lane<S>); 2] {
        let ((length, grow, fall), node) = (self.sides[pair % 2], pair / 2);
        let (abscissa, part) = rule.near.at(node);
        let up = (length * abscissa).exp();
        let down = up.recip();
        let other = if 2 * node + 1 == rule.near.len() { 0.0 } else { part };
        [
            self.node((grow[0] * up, fall[0] * down), length * part),
            self.node((grow[1] * down, fall[1] * up), length * other),
        ]
    }

    /// Creates a node from `exp(t)` and `exp(-t)`, where `t` is the variable of the sinh
    /// transformation.
    #[inline(always)]
    fn node(&self, (grow, fall): (Lane<S>, Lane<S>), weight: Lane<S>) -> (Lane<S>, Lane<S>) {
        let half = self.width * 0.5;
        let phi = (half * (grow - fall) + self.at).max(half.constant(0.0)).min(half.constant(PI));
        let left = phi.above(FRAC_PI_2);
        let (sin, cos) = left.select(-phi + PI, phi).sin_cos_first_quadrant();
        let weight = weight * half * (grow + fall) * (sin * sin) * (2.0 * FRAC_1_PI);
        (left.select(-cos, cos), weight)
    }
}

/// Returns the arccosine, accurate to 2e-8, which is sufficient for the positions of nodes. For
/// NaN, the result is the middle of the range.
///
/// Source: Abramowitz and Stegun, *Handbook of Mathematical Functions*, 4.4.46.
#[inline(always)]
fn angle<S: Simd>(cos: Lane<S>) -> Lane<S> {
    const RATIO: [f64; 8] = [
        1.570_796_305_0,
        -0.214_598_801_6,
        0.088_978_987_4,
        -0.050_174_304_6,
        0.030_891_881_0,
        -0.017_088_125_6,
        0.006_670_090_1,
        -0.001_262_491_1,
    ];
    let (zero, one) = (cos.constant(0.0), cos.constant(1.0));
    let size = cos.abs();
    let size = size.at_most(1.0).select(size, size.above(1.0).select(one, zero));
    let angle = (one - size).sqrt() * polynomial(&RATIO, size);
    cos.below(0.0).select(-angle + PI, angle)
}

/// Sums along a block of chords of the ellipse: J and K of (T21). With a lubricant, the sums also
/// include derivatives with respect to the slip across the groove and to the film thickness.
#[derive(Clone, Copy)]
pub(crate) struct Moments<S: Simd, const N: usize>(pub(super) [[Lane<S>; 3]; N]);

impl<S: Simd, const N: usize> Moments<S, N> {
    #[inline(always)]
    pub(super) fn zero(simd: S) -> Self {
        Self([[Lane::splat(simd, 0.0); 3]; N])
    }

    /// Returns the sums of `other` where the mask is true, and the sums of `self` elsewhere.
    #[inline(always)]
    fn or(mut self, mask: Mask<S>, other: Self) -> Self {
        for k in 0..N {
            for i in 0..3 {
                self.0[k][i] = mask.select(other.0[k][i], self.0[k][i]);
            }
        }
        self
    }
}

/// A friction law that is evaluated at the points of an ellipse. It needs `N` kinds of sums along
/// each chord.
pub(crate) trait PointLaw<const N: usize>: Copy {
    /// True if the friction coefficient depends on the film thickness.
    const FILM: bool;

    /// Quantities that depend only on the pressure at a node. They are calculated once and then
    /// used to calculate the friction coefficient for any slip speed.
    type NodePressure<S: Simd>: Copy;

    /// Calculates the quantities that depend on the pressure at a node.
    ///
    /// * `pressure`: pressure divided by the maximum pressure in the contact.
    fn pressed<S: Simd>(&self, pressure: Lane<S>) -> Self::NodePressure<S>;

    /// Adds the contribution of a node to the sums.
    ///
    /// * `square`: square of the slip along the groove plus square of the creep speed.
    /// * `v_c`: slip across the groove.
    fn add<S: Simd, const JACOBIAN: bool>(
        &self,
        to: &mut Moments<S, N>,
        pressed: Self::NodePressure<S>,
        square: Lane<S>,
        v_c: Lane<S>,
        node: (Lane<S>, Lane<S>),
    );

    /// Returns the sums along a block of chords whose spin poles are all outside the ellipse, and
    /// the number of nodes per chord.
    ///
    /// * `inner`: number of nodes that each chord needs for a constant friction coefficient.
    fn along<S: Simd, const JACOBIAN: bool>(
        &self,
        simd: S,
        of: (Placement<'_>, Option<usize>),
        slip: &EllipseSlip<Lane<S>>,
        chord: &Chord<S>,
    ) -> (Moments<S, N>, usize);

    /// Returns four groups of sums: J, K, the sums for derivatives with respect to the slip across
    /// the groove, and the sums J for derivatives with respect to the film thickness.
    fn variants<S: Simd>(inner: Moments<S, N>, square: Lane<S>) -> [[Lane<S>; 3]; 4];

    /// Integrates friction over the whole ellipse at once if this is more efficient than
    /// integrating along chords. Returns false if friction must be integrated along chords.
    #[inline(always)]
    fn all_over<S: Simd, const JACOBIAN: bool>(
        _simd: S,
        _gather: &mut Accumulator<'_, Self, N, JACOBIAN>,
        _ellipse: usize,
    ) -> bool {
        false
    }
}

/// Friction law with a constant friction coefficient.
#[derive(Clone, Copy)]
pub(crate) struct Dry;

impl Dry {
    /// Adds the contribution of a node. The contribution is accurate to rounding errors unless
    /// `COARSE` is true; in this case, an approximate square root limits the accuracy.
    #[inline(always)]
    pub(super) fn add<S: Simd, const JACOBIAN: bool, const COARSE: bool>(
        Moments([j, k]): &mut Moments<S, 2>,
        square: Lane<S>,
        v_c: Lane<S>,
        (s, weight): (Lane<S>, Lane<S>),
    ) {
        // q = (v_t² + v_e² + (b₀ + b₁ s)²)^{−1/2}
        let all = v_c.mul_add(v_c, square);
        let per_speed = if COARSE { all.rough_recip_sqrt() } else { all.recip_sqrt() };
        // J_k = Σ w sᵏ q,  K_k = Σ w sᵏ q³,  k = 0, 1, 2                 (T21)
        let q = weight * per_speed;
        add_powers(j, q, s);
        if JACOBIAN {
            add_powers(k, q * (per_speed * per_speed), s);
        }
    }

    /// Adds the contributions of nodes that have the same positions on all chords.
    #[inline(always)]
    fn add_all<S: Simd, const JACOBIAN: bool, const COARSE: bool>(
        to: &mut Moments<S, 2>,
        square: Lane<S>,
        (b_0, b_1): (Lane<S>, Lane<S>),
        nodes: &[(f64, f64)],
    ) {
        for (s, weight) in nodes {
            let (s, weight) = (square.constant(*s), square.constant(*weight));
            Self::add::<S, JACOBIAN, COARSE>(to, square, b_1.mul_add(s, b_0), (s, weight));
        }
    }
}

impl PointLaw<2> for Dry {
    const FILM: bool = false;

    type NodePressure<S: Simd> = ();

    #[inline(always)]
    fn pressed<S: Simd>(&self, _pressure: Lane<S>) {}

    #[inline(always)]
    fn add<S: Simd, const JACOBIAN: bool>(
        &self,
        to: &mut Moments<S, 2>,
        (): (),
        square: Lane<S>,
        v_c: Lane<S>,
        node: (Lane<S>, Lane<S>),
    ) {
        Self::add::<S, JACOBIAN, false>(to, square, v_c, node);
    }

    #[inline(always)]
    fn along<S: Simd, const JACOBIAN: bool>(
        &self,
        simd: S,
        (nodes, inner): (Placement<'_>, Option<usize>),
        slip: &EllipseSlip<Lane<S>>,
        chord: &Chord<S>,
    ) -> (Moments<S, 2>, usize) {
        let (mut sums, square) = (Moments::zero(simd), chord.square(slip));
        let places = inner.map_or(&[][..], |count| &nodes.rule.inner[count]);
        if nodes.coarse {
            Self::add_all::<S, JACOBIAN, true>(&mut sums, square, chord.across, places);
        } else {
            Self::add_all::<S, JACOBIAN, false>(&mut sums, square, chord.across, places);
        }
        (sums, places.len())
    }

    #[inline(always)]
    fn variants<S: Simd>(Moments([j, k]): Moments<S, 2>, square: Lane<S>) -> [[Lane<S>; 3]; 4] {
        // (C_b, C_s, S_s) = (v_t² + v_e²) (K₀, K₁, K₂)                    (T23)
        [j, k, [square * k[0], square * k[1], square * k[2]], [square.constant(0.0); 3]]
    }
}

/// Adds `$x s^k$` to the sums for the powers k = 0, 1 and 2.
#[inline(always)]
pub(super) fn add_powers<S: Simd>(sums: &mut [Lane<S>; 3], x: Lane<S>, s: Lane<S>) {
    let first = x * s;
    sums[0] = sums[0] + x;
    sums[1] = sums[1] + first;
    sums[2] = first.mul_add(s, sums[2]);
}

/// An accumulator for the sums over all chords of two contacts. The sums for the derivatives are
/// accumulated only if `JACOBIAN` is true.
pub(crate) struct Accumulator<'a, L, const N: usize, const JACOBIAN: bool> {
    pub(super) nodes: &'a [Placement<'a>; 2],
    pub(super) points: &'a [Patch; 2],
    pub(super) slips: &'a [EllipseSlip<f64>; 2],
    pub(super) laws: &'a [L; 2],
    /// Sums for force, moment and power, sums for their derivatives (if requested), and derivatives
    /// with respect to the film thickness (with a lubricant).
    values: [[Block; VALUES]; 2],
    slopes: &'a mut [[Block; ALL - VALUES]],
    by_film: &'a mut [[Block; SUMS]],
    /// Number of nodes on all chords. Nodes that are processed together in one SIMD vector count as
    /// one node.
    pub(super) count: usize,
}

/// Function object that calculates the sums along a block of chords whose spin poles are inside the
/// ellipse. Such chords are rare, so their code is separate.
struct NearChords<'a, S: Simd, L, const N: usize, const JACOBIAN: bool> {
    simd: S,
    rule: &'a Quadrature,
    slip: &'a EllipseSlip<Lane<S>>,
    law: &'a L,
    chord: &'a Chord<S>,
}

impl<S: Simd, L: PointLaw<N>, const N: usize, const JACOBIAN: bool> NullaryFnOnce
    for NearChords<'_, S, L, N, JACOBIAN>
{
    type Output = Moments<S, N>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        let Self { simd, rule, slip, law, chord } = self;
        let (near, square, (b_0, b_1)) =
            (NearPole::of(slip, chord.xi), chord.square(slip), chord.across);
        let mut sums = Moments::zero(simd);
        for pair in 0..NearPole::<S>::pairs(rule) {
            for (s, weight) in near.pair(rule, pair) {
                let inside = (-(s * s) + 1.0).max(s.constant(0.0)).sqrt();
                let (pressed, v_c) = (law.pressed(inside * chord.half_length), b_1.mul_add(s, b_0));
                law.add::<S, JACOBIAN>(&mut sums, pressed, square, v_c, (s, weight));
            }
        }
        sums
    }
}

/// Adds up the numbers of each block. The order of summation does not depend on the vector width.
#[inline(always)]
pub(super) fn reduce<S: Simd>(simd: S, blocks: &[Block], sums: &mut [f64]) {
    for (sum, block) in sums.iter_mut().zip(blocks) {
        // For every vector width, the number of vectors is chosen so that together they hold one
        // block.
        *sum = match S::F64_LANES {
            1 => Lane::<S, 8>::load(simd, block).sum(),
            2 => Lane::<S, 4>::load(simd, block).sum(),
            4 => Lane::<S, 2>::load(simd, block).sum(),
            _ => Lane::<S, 1>::load(simd, block).sum(),
        };
    }
}

impl<S: Simd, L: PointLaw<N>, const N: usize, const JACOBIAN: bool> AddChords<S>
    for Accumulator<'_, L, N, JACOBIAN>
{
    #[inline(always)]
    fn add_chords(&mut self, simd: S, ellipse: usize, chords: &Chords) {
        let (law, nodes) = (&self.laws[ellipse], self.nodes[ellipse]);
        let slip = self.slips[ellipse].splat(simd);
        for at in (0..BLOCK).step_by(S::F64_LANES) {
            let xi = Lane::load(simd, &chords.xi[at..]);
            let weight = Lane::load(simd, &chords.weight[at..]);
            let chord = Chord::new(&slip, xi, weight, Lane::load(simd, &chords.half_length[at..]));
            let (mut inner, count) =
                law.along::<S, JACOBIAN>(simd, (nodes, chords.inner.count), &slip, &chord);
            self.count += count;
            if let Some(inside) = &chords.inner.inside {
                let (rule, slip, chord) = (nodes.rule, &slip, &chord);
                let near = NearChords::<_, _, N, JACOBIAN> { simd, rule, slip, law, chord };
                let is_near = Lane::load(simd, &inside[at..]).above(0.0);
                inner = inner.or(is_near, simd.vectorize(near));
                self.count += 2 * NearPole::<S>::pairs(rule);
            }
            self.add_chord(simd, ellipse, at, &slip, (&chord, inner));
        }
    }
}

impl<L: PointLaw<N>, const N: usize, const JACOBIAN: bool> Accumulator<'_, L, N, JACOBIAN> {
    /// Adds the sums along a block of chords to the totals.
    #[inline(always)]
    pub(super) fn add_chord<S: Simd>(
        &mut self,
        simd: S,
        ellipse: usize,
        at: usize,
        slip: &EllipseSlip<Lane<S>>,
        (chord, inner): (&Chord<S>, Moments<S, N>),
    ) {
        let (a, b) = self.points[ellipse].semi_axes;
        let of = ((Lane::splat(simd, a), Lane::splat(simd, b)), slip);
        let [j, k, across, film] = L::variants(inner, chord.square(slip));
        let terms = chord.terms::<JACOBIAN>(of, [j, k, across]);
        add_to(simd, &mut self.values[ellipse], at, &terms[..VALUES]);
        if JACOBIAN {
            add_to(simd, &mut self.slopes[ellipse], at, &terms[VALUES..]);
        }
        if JACOBIAN && L::FILM {
            let weight = chord.weight;
            let film = [film[0] * weight, film[1] * weight, film[2] * weight];
            add_to(simd, &mut self.by_film[ellipse], at, &chord.values(of, film)[..SUMS]);
        }
    }
}

/// Calculates the friction sums of two contacts. The derivatives are calculated only if `JACOBIAN`
/// is true; otherwise they are zero.
///
/// * `laws`, `nodes`: friction law and quadrature nodes of each contact.
/// * `done`: flags that are true for contacts that are not calculated.
#[inline(always)]
pub(crate) fn sums<S: Simd, L: PointLaw<N>, const N: usize, const JACOBIAN: bool>(
    simd: S,
    points: &[Patch; 2],
    laws: &[L; 2],
    nodes: &[Placement<'_>; 2],
    done: [bool; 2],
) -> [Resultants; 2] {
    // The code is long, so it is compiled as a single separate function that is used for one or two
    // contacts.
    simd.vectorize(SumsCall::<S, L, N, JACOBIAN> { simd, points, laws, nodes, done })
}

/// Function object for [`sums`]. It is compiled as a separate function because its code is long.
struct SumsCall<'a, S, L, const N: usize, const JACOBIAN: bool> {
    simd: S,
    points: &'a [Patch; 2],
    laws: &'a [L; 2],
    nodes: &'a [Placement<'a>; 2],
    done: [bool; 2],
}

impl<S: Simd, L: PointLaw<N>, const N: usize, const JACOBIAN: bool> NullaryFnOnce
    for SumsCall<'_, S, L, N, JACOBIAN>
{
    type Output = [Resultants; 2];

    #[inline(always)]
    fn call(self) -> Self::Output {
        let Self { simd, points, laws, nodes, mut done } = self;
        let slips = &[points[0].slip(), points[1].slip()];
        let (mut slopes, mut by_film) =
            ([[[0.0; BLOCK]; ALL - VALUES]; 2], [[[0.0; BLOCK]; SUMS]; 2]);
        let mut sums = Accumulator::<L, N, JACOBIAN> {
            nodes,
            points,
            slips,
            laws,
            values: [[[0.0; BLOCK]; VALUES]; 2],
            slopes: if JACOBIAN { &mut slopes } else { &mut [] },
            by_film: if JACOBIAN && L::FILM { &mut by_film } else { &mut [] },
            count: 0,
        };
        for i in 0..2 {
            done[i] = done[i] || L::all_over(simd, &mut sums, i);
        }
        for_each_chord(simd, nodes, slips, done, &mut sums);
        cost::count_nodes(S::F64_LANES * sums.count);
        let mut found = [Resultants::none(0.0); 2];
        for (i, found) in found.iter_mut().enumerate() {
            let mut terms = [0.0; ALL];
            reduce(simd, &sums.values[i], &mut terms[..VALUES]);
            if JACOBIAN {
                reduce(simd, &sums.slopes[i], &mut terms[VALUES..]);
                *found = Resultants::of(terms, &points[i]);
            } else {
                found.values.copy_from_slice(&terms[..SUMS]);
                found.power = terms[SUMS];
            }
            if JACOBIAN && L::FILM {
                reduce(simd, &sums.by_film[i], &mut found.by_film);
            }
        }
        found
    }
}

/// Semi-axes of an ellipse, and the slip over this ellipse.
pub(super) type Shape<'a, S> = ((Lane<S>, Lane<S>), &'a EllipseSlip<Lane<S>>);

/// A block of chords of a contact ellipse.
pub(crate) struct Chord<S: Simd> {
    /// Positions of the chords on the long axis, fractions of the load that the chords carry, and
    /// half lengths of the chords.
    pub(super) xi: Lane<S>,
    pub(super) weight: Lane<S>,
    pub(super) half_length: Lane<S>,
    /// Slip along the groove and slip across the groove (T13).
    pub(super) v_t: Lane<S>,
    pub(super) across: (Lane<S>, Lane<S>),
}

impl<S: Simd> Chord<S> {
    #[inline(always)]
    pub(super) fn new(
        slip: &EllipseSlip<Lane<S>>,
        xi: Lane<S>,
        weight: Lane<S>,
        half_length: Lane<S>,
    ) -> Self {
        let (v_t, across) = (slip.along(xi), slip.across_at(xi, half_length));
        Self { xi, weight, half_length, v_t, across }
    }

    /// Returns the square of the slip along the groove plus the square of the creep speed.
    #[inline(always)]
    pub(super) fn square(&self, slip: &EllipseSlip<Lane<S>>) -> Lane<S> {
        self.v_t * self.v_t + slip.creep * slip.creep
    }

    /// Calculates friction force, moment and power from the sums J (T21).
    ///
    /// * `axes`: semi-axes of the ellipse, and the slip.
    #[inline(always)]
    pub(super) fn values(
        &self,
        ((a, b), slip): Shape<'_, S>,
        j: [Lane<S>; 3],
    ) -> [Lane<S>; VALUES] {
        let &Self { xi, half_length, v_t, across: (b_0, b_1), .. } = self;
        // T = v_t J₀,  C = b₀ J₀ + b₁ J₁,  S = b₀ J₁ + b₁ J₂
        let (t, c, s) = (v_t * j[0], b_0 * j[0] + b_1 * j[1], b_0 * j[1] + b_1 * j[2]);
        let (x, y, h) = (xi * a, half_length * b, slip.height(xi));
        // F_t = −T,  F_c = C,  M_t = −h C,  M_n = −(x T + Y S),  M_c = −h T,
        // P = v_t T + b₀ C + b₁ S                                         (T22)
        [-t, c, -(h * c), -(x * t + y * s), -(h * t), v_t * t + b_0 * c + b_1 * s]
    }

    /// Calculates the contributions to friction force, moment and power and, if `JACOBIAN` is true,
    /// the contributions to their derivatives. The arguments are the sums J and K along the chords,
    /// and the sums for derivatives with respect to the slip across the groove (T23).
    #[inline(always)]
    pub(super) fn terms<const JACOBIAN: bool>(
        &self,
        of: Shape<'_, S>,
        [j, k, across]: [[Lane<S>; 3]; 3],
    ) -> [Lane<S>; ALL] {
        let &Self { xi, weight, half_length, v_t, across: (b_0, b_1) } = self;
        let j = [j[0] * weight, j[1] * weight, j[2] * weight];
        let [f_t, f_c, m_t, m_n, m_c, power] = self.values(of, j);
        if !JACOBIAN {
            let mut terms = [weight.constant(0.0); ALL];
            (terms[0], terms[1], terms[2]) = (f_t, f_c, m_t);
            (terms[3], terms[4], terms[5]) = (m_n, m_c, power);
            return terms;
        }
        let ((a, b), slip) = of;
        let (x, y, h) = (xi * a, half_length * b, slip.height(xi));
        let k = [k[0] * weight, k[1] * weight, k[2] * weight];
        // T_v = J₀ − v_t² K₀,  T_b = −v_t (b₀ K₀ + b₁ K₁),  T_s = −v_t (b₀ K₁ + b₁ K₂)  (T23)
        let t_v = j[0] - v_t * v_t * k[0];
        let t_b = -(v_t * (b_0 * k[0] + b_1 * k[1]));
        let t_s = -(v_t * (b_0 * k[1] + b_1 * k[2]));
        let (c_b, c_s, s_s) = (across[0] * weight, across[1] * weight, across[2] * weight);
        let (t_n, c_n) = (t_v * x + t_s * y, t_b * x + c_s * y);
        let n_n = x * t_n + y * (t_s * x + s_s * y);
        let (t_vh, t_bh, c_bh) = (t_v * h, t_b * h, c_b * h);
        let (t_vhh, t_bhh, c_bhh, t_nh, c_nh) = (t_vh * h, t_bh * h, c_bh * h, t_n * h, c_n * h);
        [
            f_t, f_c, m_t, m_n, m_c, power, t_v, t_vh, t_vhh, t_b, t_bh, t_bhh, c_b, c_bh, c_bhh,
            t_n, t_nh, c_n, c_nh, n_n,
        ]
    }
}

/// Adds each SIMD vector of values to its block of totals, starting at index `at` of the block.
#[inline(always)]
fn add_to<S: Simd>(simd: S, totals: &mut [Block], at: usize, values: &[Lane<S>]) {
    for (total, value) in totals.iter_mut().zip(values) {
        (Lane::load(simd, &total[at..]) + *value).store(&mut total[at..]);
    }
}

impl<F: Real> Resultants<F> {
    #[inline(always)]
    pub(crate) fn none(zero: F) -> Self {
        let slopes = [[zero; SLOPES]; SUMS];
        Self { values: [zero; SUMS], power: zero, slopes, by_film: [zero; SUMS] }
    }

    /// Creates the integrated friction and its derivatives from the accumulated sums.
    #[inline(always)]
    pub(super) fn of(all: [F; ALL], point: &Patch<F>) -> Self {
        let [f_t, f_c, m_t, m_n, m_c, power, all @ ..] = all;
        // The next nine elements are the sums of T_v, T_b and C_b, and of their products with h and
        // h².
        let [t_v, t_vh, t_vhh, t_b, t_bh, t_bhh, c_b, c_bh, c_bhh, all @ ..] = all;
        // The last five elements are the sums of T_n and C_n, of their products with h, and of the
        // moment due to spin.
        let [t_n, t_nh, c_n, c_nh, n_n] = all;
        let ([_, w_t, w_n, w_c], r) = (point.motion, point.ball_radius);
        // If the ellipse grows, x and Y grow by the same factor, and the distance h changes by dh =
        // 2 (h − r_b).
        let (by_t, by_c) = (w_t * 2.0, w_c * 2.0);
        let t_g = w_n * t_n + by_c * (t_vh - r * t_v) + by_t * (t_bh - r * t_b);
        let c_g = w_n * c_n + by_c * (t_bh - r * t_b) + by_t * (c_bh - r * c_b);
        let t_gh = w_n * t_nh + by_c * (t_vhh - r * t_vh) + by_t * (t_bhh - r * t_bh);
        let c_gh = w_n * c_nh + by_c * (t_bhh - r * t_bh) + by_t * (c_bhh - r * c_bh);
        let n_g = w_n * n_n + by_c * (t_nh - r * t_n) + by_t * (c_nh - r * c_n);
        // Friction is the gradient of a potential with respect to the motion, so the matrix of its
        // derivatives is symmetric.
        let slopes = [
            [-t_v, -t_bh, -t_n, -t_vh, -t_g],
            [t_b, c_bh, c_n, t_bh, c_g],
            [-t_bh, -c_bhh, -c_nh, -t_bhh, (m_t + r * f_c) * 2.0 - c_gh],
            [-t_n, -c_nh, -n_n, -t_nh, m_n - n_g],
            [-t_vh, -t_bhh, -t_nh, -t_vhh, (m_c - r * f_t) * 2.0 - t_gh],
        ];
        let by_film = [r.constant(0.0); SUMS];
        Self { values: [f_t, f_c, m_t, m_n, m_c], power, slopes, by_film }
    }
}

/// Returns the friction sums of one contact. The derivatives are zero unless `JACOBIAN` is true.
#[cfg(test)]
pub(super) fn sums_on<L: PointLaw<N>, const N: usize, const JACOBIAN: bool>(
    arch: Arch,
    point: &Patch,
    law: L,
    nodes: Placement<'_>,
) -> Resultants {
    let [sums, _] = arch.dispatch(BothSums::<L, N, JACOBIAN>(&[*point; 2], law, [nodes; 2], true));
    sums
}

/// Returns the friction powers of two contacts with a constant friction coefficient.
pub(super) fn powers_on(arch: Arch, points: &[Patch; 2], nodes: [Placement<'_>; 2]) -> [f64; 2] {
    arch.dispatch(BothSums::<_, 2, false>(points, Dry, nodes, false)).map(|sums| sums.power)
}

/// Arguments for calculating the friction sums of both contacts or of the first contact alone.
struct BothSums<'a, L, const N: usize, const JACOBIAN: bool>(
    &'a [Patch; 2],
    L,
    [Placement<'a>; 2],
    bool,
);

impl<L: PointLaw<N>, const N: usize, const JACOBIAN: bool> WithSimd
    for BothSums<'_, L, N, JACOBIAN>
{
    type Output = [Resultants; 2];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self(points, law, nodes, alone) = self;
        sums::<S, L, N, JACOBIAN>(simd, points, &[law; 2], &nodes, [false, alone])
    }
}
