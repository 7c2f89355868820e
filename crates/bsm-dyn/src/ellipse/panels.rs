//! Where the nodes of an ellipse lie: panels about the two lines of pure rolling.
//!
//! Theory: `docs/theory/09-traction.md`, equations (T12) to (T19).

use std::cell::OnceCell;
use std::f64::consts::PI;
use std::num::NonZeroUsize;

use bsm_simd::{BLOCK, Block, Compare, Lane, Mask, Simd, WithSimd, for_few};
use gauss_quad::GaussLegendre;

/// Inner nodes of a line across the ellipse beyond which the spin pole counts as inside.
pub(super) const MOST_INNER: usize = 24;

/// Inner nodes of a line whose spin pole is inside, on the way to a root: few, as the root of such sums is only a start.
pub(super) const UNRESOLVED: usize = 8;

/// Poles farther from the centre than this, in semi-axes, and wider ones, grade nothing.
pub(super) const FAR: f64 = 8.0;

/// The same with an oil, whose nodes are not those of the slip.
const MOST_LUBRICATED: usize = 6;

/// Rings of an oil, and blocks of angles on half a ring, beyond which lines are better.
pub(super) const MOST_RINGS: usize = 2 * BLOCK;
const MOST_BLOCKS: usize = 4;

/// Part of a ring that belongs to a node.
#[expect(clippy::cast_precision_loss, reason = "a few angles")]
pub(super) fn part_of_a_node(blocks: usize) -> f64 {
    0.5 / (blocks * BLOCK) as f64
}

/// Cosines and sines in the middles of equal parts of half a circle.
#[expect(clippy::cast_precision_loss, reason = "a few angles")]
fn half_ring(parts: usize) -> [Vec<f64>; 2] {
    let angle = |k: usize| PI * (k as f64 + 0.5) / parts as f64;
    [(0..parts).map(|k| angle(k).cos()).collect(), (0..parts).map(|k| angle(k).sin()).collect()]
}

const TWO: NonZeroUsize = NonZeroUsize::new(2).expect("not zero");

/// Numbers below this are no divisors.
const TINY: f64 = 1e-150;

/// How finely friction is integrated over an ellipse.
#[derive(Debug, Clone, PartialEq)]
pub struct Quadrature {
    /// Gauss-Legendre of a panel, and of a part of a split one.
    pub(super) panel: Gauss,
    part: Gauss,
    /// Of each side of a spin pole inside, along a line; of half a line of an oil.
    pub(super) near: Gauss,
    pub(super) half: Gauss,
    /// For an oil: cosines and sines of angles on half a ring, [`BLOCK`] of them, twice as many, and so on.
    pub(super) angles: Vec<[Vec<f64>; 2]>,
    /// Least `$\cosh\eta$` of a pole for which as many of them are enough; falls with the number.
    resolved: Vec<f64>,
    /// Nodes and weights along a line, by their number (T19).
    pub(super) inner: Vec<Vec<(f64, f64)>>,
    /// Least `$\sinh^2\eta$` (T18) for which that number is enough; falls with the number.
    pub(super) pole_distance: Vec<f64>,
}

/// Quadratures of a few accuracies, and the coarser ones of their error estimates; each is made when it is first asked for.
#[derive(Debug, Default)]
pub(crate) struct Rules(Vec<(f64, [Quadrature; 2])>);

impl Rules {
    /// Those of a constant coefficient.
    pub(crate) fn dry<const N: usize>(&mut self, accuracies: [f64; N]) -> [&[Quadrature; 2]; N] {
        self.get(accuracies, |accuracy| [Quadrature::of(accuracy), Quadrature::check(accuracy)])
    }

    /// Those of an oil.
    pub(crate) fn of_oil<const N: usize>(&mut self, accuracies: [f64; N]) -> [&[Quadrature; 2]; N] {
        let make = |accuracy| [Quadrature::of_oil(accuracy), Quadrature::check_of_oil(accuracy)];
        self.get(accuracies, make)
    }

    fn get<const N: usize>(
        &mut self,
        accuracies: [f64; N],
        make: impl Fn(f64) -> [Quadrature; 2],
    ) -> [&[Quadrature; 2]; N] {
        let indices = accuracies.map(|accuracy| {
            let known = |(other, _): &(f64, _)| accuracy.total_cmp(other).is_eq();
            self.0.iter().position(known).unwrap_or_else(|| {
                self.0.push((accuracy, make(accuracy)));
                self.0.len() - 1
            })
        });
        indices.map(|index| &self.0[index].1)
    }
}

/// Nodes and weights of Gauss-Legendre on [0, 1].
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Gauss {
    abscissae: Vec<f64>,
    weights: Vec<f64>,
}

impl Gauss {
    fn of(nodes: NonZeroUsize) -> Self {
        let rule = GaussLegendre::new(nodes);
        let (abscissae, weights) = rule.iter().map(|(x, w)| (0.5 * (x + 1.0), 0.5 * w)).unzip();
        Self { abscissae, weights }
    }

    /// The same nodes, closer to both ends.
    fn crowded(&self) -> Self {
        // x² (3 − 2x), and its slope
        let abscissae = self.abscissae.iter().map(|x| x * x * (3.0 - 2.0 * x)).collect();
        let weights = self.abscissae.iter().zip(&self.weights);
        Self { abscissae, weights: weights.map(|(x, w)| w * 6.0 * x * (1.0 - x)).collect() }
    }

    /// How many nodes.
    pub(super) fn len(&self) -> usize {
        self.abscissae.len()
    }

    /// The next nodes and weights, if they are as many as are worked on together.
    fn block(&self, first: usize) -> Option<(&Block, &Block)> {
        let abscissae = self.abscissae[first..].first_chunk()?;
        Some((abscissae, self.weights[first..].first_chunk()?))
    }

    /// All nodes and weights.
    pub(super) fn iter(&self) -> impl Iterator<Item = (f64, f64)> {
        self.abscissae.iter().copied().zip(self.weights.iter().copied())
    }

    /// A node and its weight.
    pub(super) fn at(&self, node: usize) -> (f64, f64) {
        (self.abscissae[node], self.weights[node])
    }
}

/// Gauss-Chebyshev of the second kind: `nodes` places and weights, which sum to one.
fn chebyshev(nodes: u32) -> Vec<(f64, f64)> {
    let steps = f64::from(nodes + 1);
    (1..=nodes)
        .map(|k| {
            let (sin, cos) = (PI * f64::from(k) / steps).sin_cos();
            (cos, 2.0 / steps * sin * sin)
        })
        .collect()
}

impl Quadrature {
    /// The rule whose wrench errs by about `accuracy` of the friction: `$n = -2\log_{10}$` of it nodes a
    /// panel.
    pub fn of(accuracy: f64) -> Self {
        Self::with(Self::nodes(accuracy), accuracy, 0)
    }

    /// The same for an oil, whose coefficient bends along a line: nodes of their own on each half of it, and
    /// many on lines whose spin pole is near.
    pub(crate) fn of_oil(accuracy: f64) -> Self {
        let nodes = Self::nodes(accuracy);
        Self::lubricated(nodes.saturating_mul(TWO), 3 * nodes.get() / 4, accuracy)
    }

    pub(super) fn lubricated(nodes: NonZeroUsize, half: usize, accuracy: f64) -> Self {
        let rule = Self::with(nodes, accuracy, 0);
        let of = |nodes: usize| Gauss::of(NonZeroUsize::new(nodes).unwrap_or(NonZeroUsize::MIN));
        Self {
            panel: rule.panel.crowded(),
            part: of(2 * rule.part.len()),
            near: of(4 * rule.part.len()),
            half: of(half.min(MOST_RINGS)),
            angles: (1..=MOST_BLOCKS).map(|blocks| half_ring(blocks * BLOCK)).collect(),
            // e^{−2 N η}, N angles on half a ring
            resolved: (1..=MOST_BLOCKS)
                .map(|blocks| (-accuracy.ln() * part_of_a_node(blocks)).cosh())
                .collect(),
            inner: rule.inner[..=MOST_LUBRICATED].to_vec(),
            pole_distance: rule.pole_distance[..=MOST_LUBRICATED].to_vec(),
        }
    }

    /// The coarser rule of the error estimate of [`Self::of_oil`]: fewer nodes both ways.
    pub(crate) fn check_of_oil(accuracy: f64) -> Self {
        let nodes = Self::nodes(accuracy);
        Self::lubricated(nodes, (3 * nodes.get() / 4).saturating_sub(2).max(1), 10.0 * accuracy)
    }

    /// How many blocks of angles on half a ring resolve a slip; none where its poles are so near that lines about
    /// them are better.
    pub(super) fn blocks(&self, slip: &EllipseSlip<f64>) -> usize {
        let pole_distance = slip.poles().map(|Pole { at, width }| {
            // |z − 1| + |z + 1| = 2 cosh η of a pole z
            let square = width * width;
            0.5 * (((at - 1.0).powi(2) + square).sqrt() + ((at + 1.0).powi(2) + square).sqrt())
        });
        let pole_distance = pole_distance[0].min(pole_distance[1]);
        self.resolved.iter().position(|least| pole_distance >= *least).map_or(0, |index| index + 1)
    }

    /// Least `$\sinh^2\eta$` of a spin pole that does not count as inside.
    fn least(&self) -> f64 {
        self.pole_distance.last().copied().unwrap_or(f64::INFINITY)
    }

    fn nodes(accuracy: f64) -> NonZeroUsize {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a few digits, and one node at least"
        )]
        // Powers of ten are taken for what they are meant to be.
        let nodes = (-2.0 * accuracy.log10() - 1e-9).ceil() as usize;
        NonZeroUsize::new(nodes).unwrap_or(NonZeroUsize::MIN)
    }

    /// The coarser rule of the error estimate: fewer nodes a panel, one more along each line.
    /// With the same number along the lines it would not see what they miss.
    pub(crate) fn check(accuracy: f64) -> Self {
        let Self { part, .. } = Self::of(accuracy);
        Self::with(NonZeroUsize::new(part.len()).unwrap_or(NonZeroUsize::MIN), accuracy, 1)
    }

    /// `nodes` a panel, and along a line as many as leave an error of `tolerance`, and `more`.
    pub(crate) fn with(nodes: NonZeroUsize, tolerance: f64, more: u32) -> Self {
        let part = NonZeroUsize::new((3 * nodes.get()).div_ceil(4)).unwrap_or(nodes);
        let most = u32::try_from(MOST_INNER).expect("few");
        // m = max(2, ⌈−ln ε/(2η)⌉ − 1): η from which m nodes are enough  (T19)
        let pole_distance = |m: u32| {
            let eta = -tolerance.ln() / (2.0 * f64::from(m + 1));
            if m < 2 { f64::INFINITY } else { eta.sinh().powi(2) }
        };
        Self {
            panel: Gauss::of(nodes),
            near: Gauss::of(part),
            half: Gauss::of(part),
            part: Gauss::of(part),
            angles: Vec::new(),
            resolved: Vec::new(),
            inner: (0..=most).map(|m| chebyshev(m + more)).collect(),
            pole_distance: (0..=most).map(pole_distance).collect(),
        }
    }

    /// Number of inner nodes, for places and weights, of a line with this `$\sinh^2\eta$`; none if the
    /// spin pole is so near that they do not suffice.
    pub(super) fn count(&self, square: f64) -> Option<usize> {
        // It falls with the number: a count without branches.
        let number =
            self.pole_distance.iter().filter(|pole_distance| square < **pole_distance).count();
        (number < self.pole_distance.len()).then_some(number)
    }

    /// The same for several lines.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "counted one by one"
    )]
    #[inline(always)]
    pub(super) fn counts<S: Simd>(&self, square: Lane<S>) -> [Option<usize>; BLOCK] {
        let mut number = square.constant(0.0);
        for pole_distance in &self.pole_distance {
            number = number + square.lt(square.constant(*pole_distance)).to_numbers();
        }
        let mut counts = [None; BLOCK];
        for (count, number) in counts.iter_mut().zip(number.as_slice()) {
            let number = *number as usize;
            *count = (number < self.pole_distance.len()).then_some(number);
        }
        counts
    }
}

/// Slip of the points of an ellipse, by the place on its long axis over the semi-axis (T12), (T13).
#[derive(Debug, Clone, Copy)]
pub struct EllipseSlip<F> {
    /// Coefficients of the slip along the groove.
    pub(super) longitudinal: [F; 3],
    /// Ball radius, and how far the surface falls off at the end of the ellipse.
    pub(super) radius: F,
    pub(super) sagitta: F,
    /// Angular velocity about the groove, and that of spin by the short semi-axis.
    rolling_rate: F,
    pub(super) spin_speed: F,
    pub(super) creep: F,
}

/// How far a pressed surface falls off at a distance across the groove.
#[inline(always)]
pub(crate) fn surface_drop<F: Compare>(across: F, pressed_radius: F) -> F {
    across * across * 0.5 / pressed_radius
}

#[inline(always)]
pub(super) fn clamp<F: Compare>(x: F, low: f64, high: f64) -> F {
    let (low, high) = (x.constant(low), x.constant(high));
    F::select(x.lt(low), low, F::select(high.lt(x), high, x))
}

/// Half the length of the line at a place on the long axis, over the short semi-axis.
#[inline(always)]
pub(super) fn half_length<F: Compare>(xi: F) -> F {
    ((-xi + 1.0) * (xi + 1.0)).larger(xi.constant(0.0)).sqrt()
}

/// The number, or one that divides.
#[inline(always)]
fn divisor<F: Compare>(x: F) -> F {
    let tiny = x.constant(TINY);
    F::select(x.abs().lt(tiny), tiny, x)
}

/// A pole of what is integrated along the long axis: its real part, and its distance from the axis.
#[derive(Clone, Copy)]
pub(super) struct Pole<F> {
    pub(super) at: F,
    pub(super) width: F,
}

impl<F: Compare> Pole<F> {
    /// The other one where the mask says so.
    #[inline(always)]
    fn or(self, mask: F::Mask, other: Self) -> Self {
        let width = F::select(mask, other.width, self.width);
        Self { at: F::select(mask, other.at, self.at), width }
    }
}

impl<F: Compare> EllipseSlip<F> {
    /// Of a contact in its own axes.
    ///
    /// * `semi_axes`: across and along the groove. * `radii`: of the pressed surface (E2) and of the ball.
    /// * `speed`: of the ball centre along `$t$`; `omega`: about `$t$`, `$N$` and `$t \times N$`.
    #[inline(always)]
    pub fn new(
        semi_axes: (F, F),
        (pressed_radius, radius): (F, F),
        speed: F,
        [rolling_rate, spin, across]: [F; 3],
        creep: F,
    ) -> Self {
        let (a, b) = semi_axes;
        let sagitta = surface_drop(a, pressed_radius);
        // q₀ = A + ω_c r_b,  q₁ = ω_N a,  q₂ = −ω_c a²/(2 R_c)           (T12)
        let longitudinal = [speed + across * radius, spin * a, -(across * sagitta)];
        Self { longitudinal, radius, sagitta, rolling_rate, spin_speed: spin * b, creep }
    }

    /// Slip along the groove.
    #[inline(always)]
    pub(super) fn along(&self, xi: F) -> F {
        // v_t = q₀ + q₁ ξ + q₂ ξ²                                        (T12)
        (self.longitudinal[2] * xi + self.longitudinal[1]) * xi + self.longitudinal[0]
    }

    /// Slip across it, `$-(b_0 + b_1 s)$`.
    #[inline(always)]
    pub(super) fn across(&self, xi: F) -> (F, F) {
        self.across_at(xi, half_length(xi))
    }

    /// The same of a line with this [`half_length`].
    #[inline(always)]
    pub(super) fn across_at(&self, xi: F, half_length: F) -> (F, F) {
        // b₀ = ω_t h,  b₁ = ω_N Y                                        (T13)
        (self.rolling_rate * self.height(xi), self.spin_speed * half_length)
    }

    /// Height over the ball centre.
    #[inline(always)]
    pub(super) fn height(&self, xi: F) -> F {
        self.radius - self.sagitta * (xi * xi)
    }

    /// `$\sinh^2\eta$` of the ellipse of analyticity of the line at `xi`.
    #[inline(always)]
    pub(super) fn analyticity(&self, xi: F) -> F {
        let v_t = self.along(xi);
        let (b_0, b_1) = self.across(xi);
        // z = (b₀ + i √(v_t² + v_e²))/b₁                                 (T18)
        let (square, spin) = (v_t * v_t + self.creep * self.creep, b_1 * b_1);
        let far = (b_0.abs() - b_1.abs()) * (b_0.abs() + b_1.abs()) + square;
        // sinh²η = [A + √(A² + 4 b₁² r²)]/(2 b₁²),  r² = v_t² + v_e²,  A = b₀² − b₁² + r²
        let (both, near) =
            ((far * far + spin * square * 4.0).sqrt() + far.abs(), far.lt(far.constant(0.0)));
        let (up, down) = (F::select(near, square * 2.0, both), F::select(near, both, spin * 2.0));
        up / divisor(down)
    }

    /// The poles that belong to the two lines of pure rolling, from left to right.
    #[inline(always)]
    pub(super) fn poles(&self) -> [Pole<F>; 2] {
        let [q_0, q_1, q_2] = self.longitudinal;
        let (zero, one) = (q_0.constant(0.0), q_0.constant(1.0));
        let (s_1, s_2) = (F::select(q_1.lt(zero), -one, one), F::select(q_2.lt(zero), -one, one));
        let (q_2, d) = (divisor(q_2), q_1 * q_1 - q_0 * q_2 * 4.0);
        let complex = d.lt(zero);
        let t = divisor(-(q_1 + s_1 * d.larger(zero).sqrt()) * 0.5);
        let middle = -(q_1 / q_2) * 0.5;
        let lines = [F::select(complex, middle, t / q_2), F::select(complex, middle, q_0 / t)];
        let mut poles = [Pole { at: zero, width: one }; 2];
        for i in 0..2 {
            let (b_0, b_1) = self.across(clamp(lines[i], -1.0, 1.0));
            let (b_0, b_1) = (b_0.abs(), b_1.abs());
            // m = √(max(|b₀| − |b₁|, |b₁|/10)² + v_e²)                   (T15)
            let rest = (b_0 - b_1).larger(b_1 * 0.1);
            let m = (rest * rest + self.creep * self.creep).sqrt();
            // v_t(ξ_j ± i δ_j) = ±i m,  t = −(q₁ + sign(q₁)(u + i w))/2  (T16)
            let bend = q_2.abs() * m * 2.0;
            let g = (d * d + bend * bend * 4.0).sqrt();
            let long = ((g + d.abs()) * 0.5).larger(zero).sqrt();
            let long = divisor(long);
            let short = bend / long;
            let (u, w) = (F::select(complex, short, long), F::select(complex, long, short) * s_2);
            let (re, im) = (-(q_1 + s_1 * u) * 0.5, -(s_1 * w) * 0.5);
            let (at, width) = if i == 0 {
                (re / q_2, F::select(complex, long * 0.5 / q_2.abs(), m / long))
            } else {
                let square = divisor(re * re + im * im);
                ((q_0 * re - m * im) / square, (m * re + q_0 * im).abs() / square)
            };
            poles[i] = Pole { at: clamp(at, -FAR, FAR), width: clamp(width, 1e-100, FAR) };
        }
        let [one, two] = poles;
        let swap = two.at.lt(one.at);
        [one.or(swap, two), two.or(swap, one)]
    }
}

/// Numbers of nodes that stay as they are while the slip changes: sums without steps, near where they were
/// taken.
#[derive(Debug, Clone, Default)]
pub(crate) struct FrozenRule {
    /// Of an oil: blocks of angles on half a ring; none where lines are taken.
    pub(super) blocks: usize,
    /// Which of the two panels are split.
    pub(super) split: [bool; 2],
    pub(super) lines: Vec<FrozenChords>,
}

/// How many nodes each of a few neighbouring lines has, for places and weights, none where the spin poles of
/// all are inside; and 1 for each whose pole is.
type FrozenChords = (Option<usize>, Option<Block>);

/// The nodes of a quadrature over an ellipse: by the slip, or as in a plan, which the first walk fills.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Placement<'a> {
    pub(crate) rule: &'a Quadrature,
    pub(crate) plan: Option<&'a OnceCell<FrozenRule>>,
    /// On the way to a root: sums to 1e-5, and spin poles inside are not resolved; of a constant coefficient.
    pub(crate) coarse: bool,
}

impl<'a> Placement<'a> {
    fn frozen(&self) -> Option<&'a FrozenRule> {
        self.plan?.get()
    }

    /// True if the plan is to be filled.
    fn is_new(&self) -> bool {
        self.plan.is_some_and(|plan| plan.get().is_none())
    }

    /// The nodes of neighbouring lines with these `$\sinh^2\eta$`.
    #[inline(always)]
    fn along(&self, squares: &Block) -> FrozenChords {
        let rule = self.rule;
        let mut least = *squares;
        let mut half = BLOCK / 2;
        while half > 0 {
            for i in 0..half {
                least[i] = if least[i + half] < least[i] { least[i + half] } else { least[i] };
            }
            half /= 2;
        }
        if self.coarse || rule.least() <= least[0] {
            return (rule.count(least[0]).or(Some(UNRESOLVED)), None);
        }
        let mut inside = [0.0; BLOCK];
        let mut least = f64::INFINITY;
        for (inside, square) in inside.iter_mut().zip(squares) {
            // One NaN makes every sum NaN.
            if *square < rule.least() {
                *inside = 1.0;
            } else {
                least = least.min(*square);
            }
        }
        ((least < f64::INFINITY).then(|| rule.count(least)).flatten(), Some(inside))
    }

    /// Fills the plan if it is new.
    pub(super) fn freeze(&self, made: FrozenRule) {
        if let Some(plan) = self.plan {
            plan.get_or_init(|| made);
        }
    }

    /// Blocks of angles on half a ring; none where lines are taken.
    pub(super) fn blocks(&self, slip: &EllipseSlip<f64>) -> usize {
        self.frozen().map_or_else(|| self.rule.blocks(slip), |plan| plan.blocks)
    }
}

impl<'a> From<&'a Quadrature> for Placement<'a> {
    fn from(rule: &'a Quadrature) -> Self {
        Self { rule, plan: None, coarse: false }
    }
}

/// A few neighbouring lines across the ellipse.
#[derive(Clone, Copy)]
pub(super) struct Chords {
    /// Places over the long semi-axis, and their parts of the load.
    pub(super) xi: Block,
    pub(super) weight: Block,
    /// Half their lengths over the short semi-axis.
    pub(super) half_length: Block,
    /// How many inner nodes, for places and weights; none where all poles are inside.
    pub(super) inner: Option<usize>,
    /// 1 for each line whose spin pole is inside the ellipse, else 0; none if there is no such line.
    pub(super) inside: Option<Block>,
}

/// A part of the long axis with its nodes.
#[derive(Clone, Copy)]
struct Panel<'a> {
    pole: Pole<f64>,
    /// Where it begins and ends: from the pole over its width, and then in the variable of (T17).
    ends: [f64; 2],
    nodes: &'a Gauss,
}

/// The parts of the long axis of an ellipse.
#[derive(Clone, Copy)]
pub(super) struct Panels<'a> {
    parts: [Panel<'a>; 4],
    count: usize,
    split: [bool; 2],
}

impl Chords {
    const NONE: Self = Self {
        xi: [0.0; BLOCK],
        weight: [0.0; BLOCK],
        half_length: [0.0; BLOCK],
        inner: None,
        inside: None,
    };

    /// The lines of a few nodes.
    ///
    /// * `of_panel`: where a panel begins, its length, and its pole, of the nodes from a number on.
    #[inline(always)]
    fn place_nodes<S: Simd>(
        &mut self,
        simd: S,
        (nodes, frozen): (Placement<'_>, Option<&FrozenChords>),
        slip: &EllipseSlip<Lane<S>>,
        (abscissae, parts): (&Block, &Block),
        of_panel: &[Block; 4],
    ) {
        let mut square = [0.0; BLOCK];
        for i in (0..BLOCK).step_by(S::F64_LANES) {
            let (from, length) =
                (Lane::load(simd, &of_panel[0][i..]), Lane::load(simd, &of_panel[1][i..]));
            let (at, width) =
                (Lane::load(simd, &of_panel[2][i..]), Lane::load(simd, &of_panel[3][i..]));
            let abscissa = Lane::load(simd, &abscissae[i..]);
            let part = Lane::load(simd, &parts[i..]);
            let (x, part) = line(&Pole { at, width }, from + length * abscissa, length * part);
            x.store(&mut self.xi[i..]);
            part.store(&mut self.weight[i..]);
            half_length(x).store(&mut self.half_length[i..]);
            if frozen.is_none() {
                slip.analyticity(x).store(&mut square[i..]);
            }
        }
        (self.inner, self.inside) = match frozen {
            Some(frozen) => *frozen,
            None => nodes.along(&square),
        };
    }
}

/// What is done with the lines of a few ellipses.
pub(super) trait Visitor<S: Simd> {
    /// A few lines of an ellipse.
    fn visit(&mut self, simd: S, ellipse: usize, lines: &Chords);
}

/// The poles of both contacts: places, widths and, if asked how near they are, `$\sinh^2\eta$`, of the first ones of both
/// and of the second ones.
struct PolesOfBoth<'a> {
    slips: &'a [EllipseSlip<f64>; 2],
    near: bool,
}

impl WithSimd for PolesOfBoth<'_> {
    type Output = [[Block; 2]; 3];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self { slips, near } = self;
        let mut found = [[[0.0; BLOCK]; 2]; 3];
        for first in (0..slips.len()).step_by(S::F64_LANES) {
            let slip = EllipseSlip::side_by_side(simd, &slips[first..]);
            for (i, pole) in slip.poles().into_iter().enumerate() {
                pole.at.store(&mut found[0][i][first..]);
                pole.width.store(&mut found[1][i][first..]);
                if near {
                    slip.analyticity(pole.at).store(&mut found[2][i][first..]);
                }
            }
        }
        found
    }
}

impl<'a> Panels<'a> {
    /// Of both contacts, worked on side by side; none of those that are done with.
    #[inline(always)]
    fn of<S: Simd>(
        simd: S,
        nodes: &[Placement<'a>; 2],
        slips: &[EllipseSlip<f64>; 2],
        done: [bool; 2],
    ) -> [Self; 2] {
        const { assert!(2 * 8 <= 2 * BLOCK, "four panels with two ends each") };
        // Where panels are split is known on the way to a root, and from a plan.
        let may_split = |nodes: &Placement<'_>| !nodes.coarse && nodes.frozen().is_none();
        let [at, width, square] =
            for_few(simd, PolesOfBoth { slips, near: nodes.iter().any(may_split) });
        let mut all = [Self::none(nodes[0].rule); 2];
        for c in 0..2 {
            if done[c] {
                continue;
            }
            let pole = |i: usize| Pole { at: at[i][c], width: width[i][c] };
            all[c] = Self::between(nodes[c], [pole(0), pole(1)], [square[0][c], square[1][c]]);
        }
        // τ from arsinh((lo − ξ_j)/δ_j) to arsinh((hi − ξ_j)/δ_j)        (T17)
        let mut ends = [0.0; 2 * BLOCK];
        let mut found = 0;
        for Self { parts, count, .. } in &all {
            for panel in &parts[..*count] {
                ends[2 * found..2 * found + 2].copy_from_slice(&panel.ends);
                found += 1;
            }
        }
        for at in (0..2 * found).step_by(S::F64_LANES) {
            Lane::<S>::load(simd, &ends[at..]).arsinh().store(&mut ends[at..]);
        }
        found = 0;
        for Self { parts, count, .. } in &mut all {
            for panel in &mut parts[..*count] {
                panel.ends.copy_from_slice(&ends[2 * found..2 * found + 2]);
                found += 1;
            }
        }
        all
    }

    #[inline(always)]
    fn none(rule: &'a Quadrature) -> Self {
        let pole = Pole { at: 0.0, width: 1.0 };
        let none = Panel { pole, ends: [0.0; 2], nodes: &rule.panel };
        Self { parts: [none; 4], count: 0, split: [false; 2] }
    }

    /// Around two poles with these `$\sinh^2\eta$`, split where they are inside.
    #[inline(always)]
    fn between(nodes: Placement<'a>, poles: [Pole<f64>; 2], square: [f64; 2]) -> Self {
        let (rule, plan) = (nodes.rule, nodes.frozen());
        let mut all = Self::none(rule);
        let middle = clamp(0.5 * (poles[0].at + poles[1].at), -1.0, 1.0);
        for (i, (low, high)) in [(-1.0, middle), (middle, 1.0)].into_iter().enumerate() {
            let pole = poles[i];
            let inside = plan.map_or(square[i] < rule.least(), |plan| plan.split[i]);
            all.split[i] = inside && !nodes.coarse && low < pole.at && pole.at < high;
            let (cut, nodes) =
                if all.split[i] { (pole.at, &rule.part) } else { (high, &rule.panel) };
            for (low, high) in [(low, cut), (cut, high)] {
                if low < high {
                    let ends = [(low - pole.at) / pole.width, (high - pole.at) / pole.width];
                    all.parts[all.count] = Panel { pole, ends, nodes };
                    all.count += 1;
                }
            }
        }
        all
    }

    /// The next nodes from node `node` of a panel on, and where they end; unused places repeat the last
    /// one without weight.
    fn gather(&self, mut panel: usize, mut node: usize, block: &mut LineNodes) -> (usize, usize) {
        let LineNodes { abscissae, parts, of_panel } = block;
        for i in 0..BLOCK {
            if panel == self.count {
                abscissae[i] = abscissae[i - 1];
                for block in &mut *of_panel {
                    block[i] = block[i - 1];
                }
                continue;
            }
            let Panel { pole, ends: [begin, end], nodes } = self.parts[panel];
            (abscissae[i], parts[i]) = nodes.at(node);
            for (block, x) in of_panel.iter_mut().zip([begin, end - begin, pole.at, pole.width]) {
                block[i] = x;
            }
            node += 1;
            if node == nodes.len() {
                (panel, node) = (panel + 1, 0);
            }
        }
        (panel, node)
    }

    /// The next few lines across the ellipse from a place on (T14) to (T19).
    #[inline(always)]
    fn next<S: Simd>(
        &self,
        simd: S,
        at: &mut ChordCursor,
        of: Placement<'_>,
        slip: &EllipseSlip<Lane<S>>,
        lines: &mut Chords,
    ) {
        let frozen = of.frozen().and_then(|plan| plan.lines.get(at.number));
        at.number += 1;
        let Panel { pole, ends: [begin, end], nodes } = self.parts[at.panel];
        if let Some((abscissae, parts)) = nodes.block(at.node) {
            let of_panel =
                [[begin; BLOCK], [end - begin; BLOCK], [pole.at; BLOCK], [pole.width; BLOCK]];
            lines.place_nodes(simd, (of, frozen), slip, (abscissae, parts), &of_panel);
            at.node += BLOCK;
            if at.node == nodes.len() {
                (at.panel, at.node) = (at.panel + 1, 0);
            }
        } else {
            let mut block = LineNodes::default();
            (at.panel, at.node) = self.gather(at.panel, at.node, &mut block);
            let LineNodes { abscissae, parts, of_panel } = &block;
            lines.place_nodes(simd, (of, frozen), slip, (abscissae, parts), of_panel);
        }
    }
}

/// Where a walk along an ellipse is: a panel, a node of it, and a number of lines.
#[derive(Clone, Copy, Default)]
struct ChordCursor {
    panel: usize,
    node: usize,
    number: usize,
}

/// Lines of a few places on the way along the ellipse, so that the processor works on some while it waits for
/// others.
const AHEAD: usize = 2;

/// Goes through the lines across both ellipses, but for those that are done with.
#[inline(always)]
pub(super) fn each_chord<S: Simd>(
    simd: S,
    nodes: &[Placement<'_>; 2],
    slips: &[EllipseSlip<f64>; 2],
    done: [bool; 2],
    visitor: &mut impl Visitor<S>,
) {
    let all = Panels::of(simd, nodes, slips, done);
    let mut at = [ChordCursor::default(); 2];
    let mut frozen_chords = [Vec::new(), Vec::new()];
    let mut lines = [[Chords::NONE; AHEAD]; 2];
    loop {
        let mut found = [0; 2];
        for c in 0..2 {
            let slip = slips[c].splat(simd);
            while found[c] < AHEAD && at[c].panel < all[c].count {
                let next = &mut lines[c][found[c]];
                all[c].next(simd, &mut at[c], nodes[c], &slip, next);
                if nodes[c].is_new() {
                    frozen_chords[c].push((next.inner, next.inside));
                }
                found[c] += 1;
            }
        }
        if found == [0; 2] {
            break;
        }
        for c in 0..2 {
            for lines in &lines[c][..found[c]] {
                visitor.visit(simd, c, lines);
            }
        }
    }
    for (c, lines) in frozen_chords.into_iter().enumerate() {
        nodes[c].freeze(FrozenRule { blocks: 0, split: all[c].split, lines });
    }
}

/// Place of a line on the long axis and its part of the load, from a node in the variable of (T17) and its
/// weight.
#[inline(always)]
fn line<S: Simd, const N: usize>(
    pole: &Pole<Lane<S, N>>,
    tau: Lane<S, N>,
    weight: Lane<S, N>,
) -> (Lane<S, N>, Lane<S, N>) {
    let grow = tau.exp();
    line_at(pole, (grow, grow.recip()), weight)
}

/// The same from the exponentials of the variable and of its opposite.
#[inline(always)]
pub(super) fn line_at<S: Simd, const N: usize>(
    pole: &Pole<Lane<S, N>>,
    (grow, fall): (Lane<S, N>, Lane<S, N>),
    weight: Lane<S, N>,
) -> (Lane<S, N>, Lane<S, N>) {
    // ξ = ξ_j + δ_j sinh τ                                               (T17)
    let xi = pole.at + pole.width * (grow - fall) * 0.5;
    // dQ/Q = (3/4)(1 − ξ²) dξ × (2/π) √(1 − s²) ds                       (T14)
    let shape = ((-xi + 1.0) * (xi + 1.0)).larger(xi.constant(0.0)) * 0.75;
    (xi, weight * pole.width * (grow + fall) * 0.5 * shape)
}

/// Nodes of Gauss-Legendre on parts of the long axis: places and weights there, and of the part where it begins,
/// its length, and its pole.
#[derive(Default)]
struct LineNodes {
    abscissae: Block,
    parts: Block,
    of_panel: [Block; 4],
}

impl<F: Copy> EllipseSlip<F> {
    #[inline(always)]
    fn numbers(&self) -> [F; 8] {
        let Self {
            longitudinal: [q_0, q_1, q_2],
            radius,
            sagitta,
            rolling_rate,
            spin_speed,
            creep,
        } = *self;
        [q_0, q_1, q_2, radius, sagitta, rolling_rate, spin_speed, creep]
    }

    #[inline(always)]
    fn of([q_0, q_1, q_2, radius, sagitta, rolling_rate, spin_speed, creep]: [F; 8]) -> Self {
        Self { longitudinal: [q_0, q_1, q_2], radius, sagitta, rolling_rate, spin_speed, creep }
    }
}

impl EllipseSlip<f64> {
    /// The first few slips.
    #[inline(always)]
    fn side_by_side<S: Simd>(simd: S, slips: &[Self]) -> EllipseSlip<Lane<S>> {
        let mut blocks = [[0.0; BLOCK]; 8];
        for (i, slip) in slips.iter().enumerate() {
            for (block, number) in blocks.iter_mut().zip(slip.numbers()) {
                block[i] = number;
            }
        }
        let mut lanes = [Lane::splat(simd, 0.0); 8];
        for (lane, block) in lanes.iter_mut().zip(&blocks) {
            *lane = Lane::load(simd, block);
        }
        EllipseSlip::of(lanes)
    }

    #[inline(always)]
    pub(super) fn splat<S: Simd>(&self, simd: S) -> EllipseSlip<Lane<S>> {
        let mut lanes = [Lane::splat(simd, 0.0); 8];
        for (lane, number) in lanes.iter_mut().zip(self.numbers()) {
            *lane = Lane::splat(simd, number);
        }
        EllipseSlip::of(lanes)
    }
}

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
    let (mut power, mut resolved) = (zero, zero.le(zero));
    for i in 0..2 {
        let panel = PanelLines::of(rule, slip, &poles[i], ends[i]);
        power = panel.add_power(rule, slip, power);
        resolved = resolved & panel.resolved;
    }
    (power, resolved)
}

/// Most contacts side by side.
const MANY: usize = 4 * BLOCK;

/// The lines across the panel of a pole, of several contacts side by side.
struct PanelLines<S: Simd, const N: usize> {
    /// Places on the long axis, and parts of the load.
    lines: [(Lane<S, N>, Lane<S, N>); BLOCK],
    /// Which rule of the inner nodes each contact takes.
    counts: [usize; MANY],
    /// Where the rule resolves them.
    resolved: Mask<S, N>,
}

impl<S: Simd, const N: usize> PanelLines<S, N> {
    #[inline(always)]
    fn of(
        rule: &Quadrature,
        slip: &EllipseSlip<Lane<S, N>>,
        pole: &Pole<Lane<S, N>>,
        [low, high]: [Lane<S, N>; 2],
    ) -> Self {
        let zero = low.constant(0.0);
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
        let least = zero.constant(rule.least());
        let resolved = (!within | least.le(slip.analyticity(pole.at))) & least.le(square);
        let mut counts = [0; MANY];
        for (count, square) in counts.iter_mut().zip(square.as_slice()) {
            *count = rule.count(*square).unwrap_or(0);
        }
        Self { lines, counts, resolved }
    }

    /// Adds what friction takes along the lines.
    #[inline(always)]
    fn add_power(
        &self,
        rule: &Quadrature,
        slip: &EllipseSlip<Lane<S, N>>,
        mut power: Lane<S, N>,
    ) -> Lane<S, N> {
        let counts = &self.counts[..Lane::<S, N>::LEN];
        let mut most = 0;
        for count in counts {
            most = most.max(rule.inner[*count].len());
        }
        for k in 0..most {
            // Each contact has its own nodes along the lines, and none beyond its last.
            let (mut abscissae, mut parts) = ([0.0; MANY], [0.0; MANY]);
            for (i, count) in counts.iter().enumerate() {
                if let Some((abscissa, part)) = rule.inner[*count].get(k) {
                    (abscissae[i], parts[i]) = (*abscissa, *part);
                }
            }
            let (s, part) = (power.like(&abscissae), power.like(&parts));
            for (xi, weight) in self.lines {
                let (v_t, (b_0, b_1)) = (slip.along(xi), slip.across(xi));
                let v_c = b_0 + b_1 * s;
                let square = v_t * v_t + v_c * v_c;
                // dP = −dF·v                                              (E6)
                let pull = (square + slip.creep * slip.creep).sqrt();
                power = power + square * (weight * part) / pull;
            }
        }
        power
    }
}

/// Speed over `$r_b W$` of the ends of the longer ellipse when the ball turns against a raceway at `$W$`; 1 for
/// ellipses shorter than the ball (T9).
///
/// * `semi_axes`, `pressed_radius`: across the grooves of nut and screw, over the ball radius.
#[inline(always)]
pub fn slip_scale<F: Compare>(semi_axes: [F; 2], pressed_radius: [F; 2]) -> F {
    // max(1, a²/2R_c)                                                     (T9)
    let mut scale = semi_axes[0].constant(1.0);
    for i in 0..2 {
        scale = scale.larger(surface_drop(semi_axes[i], pressed_radius[i]));
    }
    scale
}
