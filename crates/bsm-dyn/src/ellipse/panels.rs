//! Where the nodes of an ellipse lie: panels about the two lines of pure rolling.
//!
//! Theory: `docs/theory/09-traction.md`, equations (T12) to (T19).

#![expect(
    clippy::inline_always,
    reason = "code takes the instruction set of its caller only inline"
)]

use std::f64::consts::PI;
use std::num::NonZeroUsize;

use bsm_simd::{BLOCK, Block, Compare, Lane, Mask, Simd};
use gauss_quad::GaussLegendre;

/// Inner nodes of a line across the ellipse beyond which the spin pole counts as inside.
pub(super) const MOST_INNER: usize = 24;

/// Poles farther from the centre than this, in semi-axes, and wider ones, grade nothing.
pub(super) const FAR: f64 = 8.0;

/// Numbers below this are no divisors.
const TINY: f64 = 1e-150;

/// How finely friction is integrated over an ellipse.
#[derive(Debug, Clone, PartialEq)]
pub struct Quadrature {
    /// Nodes and weights of Gauss-Legendre on [0, 1]: of a panel, and of a part of a split one.
    pub(super) panel: Vec<(f64, f64)>,
    pub(super) part: Vec<(f64, f64)>,
    /// Nodes and weights along a line, by their number (T19).
    pub(super) inner: Vec<Vec<(f64, f64)>>,
    /// Least `$\sinh\eta$` (T18) for which that number is enough; falls with the number.
    pub(super) reach: Vec<f64>,
}

/// Gauss-Legendre on [0, 1].
fn gauss_legendre(nodes: NonZeroUsize) -> Vec<(f64, f64)> {
    GaussLegendre::new(nodes).iter().map(|(x, w)| (0.5 * (x + 1.0), 0.5 * w)).collect()
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
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a few digits, and one node at least"
        )]
        // Powers of ten are taken for what they are meant to be.
        let nodes = (-2.0 * accuracy.log10() - 1e-9).ceil() as usize;
        Self::with(NonZeroUsize::new(nodes).unwrap_or(NonZeroUsize::MIN), accuracy, 0)
    }

    /// The rule that the error of this one is told from: fewer nodes a panel, one more along each line.
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
        let reach = |m: u32| {
            if m < 2 { f64::INFINITY } else { (-tolerance.ln() / (2.0 * f64::from(m + 1))).sinh() }
        };
        Self {
            panel: gauss_legendre(nodes),
            part: gauss_legendre(part),
            inner: (0..=most).map(|m| chebyshev(m + more)).collect(),
            reach: (0..=most).map(reach).collect(),
        }
    }

    /// Number of inner nodes, for places and weights, of a line with this `$\sinh\eta$`; none if the
    /// spin pole is so near that they do not suffice.
    pub(super) fn count(&self, sinh: f64) -> Option<usize> {
        self.reach.iter().position(|reach| sinh >= *reach)
    }
}

/// Slip of the points of an ellipse, by the place on its long axis over the semi-axis (T12), (T13).
#[derive(Debug, Clone, Copy)]
pub struct EllipseSlip<F> {
    /// Coefficients of the slip along the groove.
    along: [F; 3],
    /// Ball radius, and how far the surface falls off at the end of the ellipse.
    pub(super) radius: F,
    pub(super) sag: F,
    /// Angular velocity about the groove, and that of spin by the short semi-axis.
    roll: F,
    turn: F,
    pub(super) creep: F,
}

#[inline(always)]
fn larger<F: Compare>(x: F, y: F) -> F {
    F::select(x.lt(y), y, x)
}

#[inline(always)]
pub(super) fn clamp<F: Compare>(x: F, low: f64, high: f64) -> F {
    let (low, high) = (x.constant(low), x.constant(high));
    F::select(x.lt(low), low, F::select(high.lt(x), high, x))
}

/// Half the length of the line at a place on the long axis, over the short semi-axis.
#[inline(always)]
pub(super) fn chord<F: Compare>(xi: F) -> F {
    larger((-xi + 1.0) * (xi + 1.0), xi.constant(0.0)).sqrt()
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
        [roll, spin, across]: [F; 3],
        creep: F,
    ) -> Self {
        let (a, b) = semi_axes;
        let sag = a * a * 0.5 / pressed_radius;
        // q₀ = A + ω_c r_b,  q₁ = ω_N a,  q₂ = −ω_c a²/(2 R_c)           (T12)
        let along = [speed + across * radius, spin * a, -(across * sag)];
        Self { along, radius, sag, roll, turn: spin * b, creep }
    }

    /// Slip along the groove.
    #[inline(always)]
    pub(super) fn along(&self, xi: F) -> F {
        // v_t = q₀ + q₁ ξ + q₂ ξ²                                        (T12)
        (self.along[2] * xi + self.along[1]) * xi + self.along[0]
    }

    /// Slip across it, `$-(b_0 + b_1 s)$`.
    #[inline(always)]
    pub(super) fn across(&self, xi: F) -> (F, F) {
        // b₀ = ω_t h,  b₁ = ω_N Y                                        (T13)
        (self.roll * self.height(xi), self.turn * chord(xi))
    }

    /// Height over the ball centre.
    #[inline(always)]
    pub(super) fn height(&self, xi: F) -> F {
        self.radius - self.sag * (xi * xi)
    }

    /// `$\sinh\eta$` of the ellipse of analyticity of the line at `xi`.
    #[inline(always)]
    pub(super) fn analyticity(&self, xi: F) -> F {
        self.analyticity_square(xi).sqrt()
    }

    /// `$\sinh^2\eta$`.
    #[inline(always)]
    pub(super) fn analyticity_square(&self, xi: F) -> F {
        let v_t = self.along(xi);
        let (b_0, b_1) = self.across(xi);
        // z = (b₀ + i √(v_t² + v_e²))/b₁                                 (T18)
        let (square, spin) = (v_t * v_t + self.creep * self.creep, b_1 * b_1);
        let far = (b_0.abs() - b_1.abs()) * (b_0.abs() + b_1.abs()) + square;
        // sinh²η = [A + √(A² + 4 b₁² r²)]/(2 b₁²),  r² = v_t² + v_e²,  A = b₀² − b₁² + r²
        let both = (far * far + spin * square * 4.0).sqrt() + far.abs();
        let (up, down) = (both / divisor(spin * 2.0), square * 2.0 / divisor(both));
        F::select(far.lt(far.constant(0.0)), down, up)
    }

    /// The poles that belong to the two lines of pure rolling, from left to right.
    #[inline(always)]
    pub(super) fn poles(&self) -> [Pole<F>; 2] {
        let [q_0, q_1, q_2] = self.along;
        let (zero, one) = (q_0.constant(0.0), q_0.constant(1.0));
        let (s_1, s_2) = (F::select(q_1.lt(zero), -one, one), F::select(q_2.lt(zero), -one, one));
        let (q_2, d) = (divisor(q_2), q_1 * q_1 - q_0 * q_2 * 4.0);
        let complex = d.lt(zero);
        let t = divisor(-(q_1 + s_1 * larger(d, zero).sqrt()) * 0.5);
        let middle = -(q_1 / q_2) * 0.5;
        let lines = [F::select(complex, middle, t / q_2), F::select(complex, middle, q_0 / t)];
        let mut poles = [Pole { at: zero, width: one }; 2];
        for i in 0..2 {
            let (b_0, b_1) = self.across(clamp(lines[i], -1.0, 1.0));
            let (b_0, b_1) = (b_0.abs(), b_1.abs());
            // m = √(max(|b₀| − |b₁|, |b₁|/10)² + v_e²)                   (T15)
            let rest = larger(b_0 - b_1, b_1 * 0.1);
            let m = (rest * rest + self.creep * self.creep).sqrt();
            // v_t(ξ_j ± i δ_j) = ±i m,  t = −(q₁ + sign(q₁)(u + i w))/2  (T16)
            let bend = q_2.abs() * m * 2.0;
            let g = (d * d + bend * bend * 4.0).sqrt();
            let long = larger((g + d.abs()) * 0.5, zero).sqrt();
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
pub(crate) struct Plan {
    pub(super) split: [bool; 2],
    pub(super) lines: Vec<(Option<usize>, [bool; BLOCK])>,
}

/// The nodes of a quadrature over an ellipse: by the slip, or as in a plan.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Nodes<'a> {
    pub(crate) rule: &'a Quadrature,
    pub(crate) plan: Option<&'a Plan>,
}

impl<'a> From<&'a Quadrature> for Nodes<'a> {
    fn from(rule: &'a Quadrature) -> Self {
        Self { rule, plan: None }
    }
}

/// A few neighbouring lines across the ellipse.
pub(super) struct Lines {
    /// Places over the long semi-axis, and their parts of the load.
    pub(super) xi: Block,
    pub(super) weight: Block,
    /// How many inner nodes, for places and weights; none where all poles are inside.
    pub(super) inner: Option<usize>,
    /// Of each line, whether the spin pole is inside the ellipse.
    pub(super) inside: [bool; BLOCK],
    pub(super) any_inside: bool,
    /// Which of the two panels are split.
    pub(super) split: [bool; 2],
}

/// A part of the long axis with its nodes.
struct Panel<'a> {
    pole: Pole<f64>,
    /// Where it begins, and its length, in the variable of (T17).
    from: f64,
    length: f64,
    nodes: &'a [(f64, f64)],
}

/// What is done with the lines of an ellipse.
pub(super) trait Visit<S: Simd> {
    /// A few lines.
    fn visit(&mut self, simd: S, lines: &Lines);
}

/// Goes through the lines across the ellipse (T14) to (T19).
#[inline(always)]
pub(super) fn walk<S: Simd>(
    simd: S,
    Nodes { rule, plan }: Nodes<'_>,
    slip: &EllipseSlip<f64>,
    visitor: &mut impl Visit<S>,
) {
    let poles = slip.poles();
    let middle = clamp(0.5 * (poles[0].at + poles[1].at), -1.0, 1.0);
    // Ends of panels, left and right, split at poles inside.
    let mut ends = [[0.0; BLOCK]; 2];
    let mut panels: [Panel<'_>; 4] = [const {
        Panel { pole: Pole { at: 0.0, width: 1.0 }, from: 0.0, length: 0.0, nodes: &[] }
    }; 4];
    let (mut count, mut split) = (0, [false; 2]);
    for i in 0..2 {
        let pole = poles[i];
        let (low, high) = if i == 0 { (-1.0, middle) } else { (middle, 1.0) };
        let inside = match plan {
            Some(plan) => plan.split[i],
            None => rule.count(slip.analyticity(pole.at)).is_none(),
        };
        split[i] = inside && low < pole.at && pole.at < high;
        let (cut, nodes) = if split[i] { (pole.at, &rule.part) } else { (high, &rule.panel) };
        for (low, high) in [(low, cut), (cut, high)] {
            if low < high {
                (panels[count].pole, panels[count].nodes) = (pole, nodes);
                // τ from arsinh((lo − ξ_j)/δ_j) to arsinh((hi − ξ_j)/δ_j) (T17)
                ends[0][count] = (low - pole.at) / pole.width;
                ends[1][count] = (high - pole.at) / pole.width;
                count += 1;
            }
        }
    }
    for end in &mut ends {
        for at in (0..BLOCK).step_by(S::F64_LANES) {
            Lane::<S>::load(simd, &end[at..]).arsinh().store(&mut end[at..]);
        }
    }
    for i in 0..count {
        (panels[i].from, panels[i].length) = (ends[0][i], ends[1][i] - ends[0][i]);
    }
    let (mut panel, mut node, mut number) = (0, 0, 0);
    while panel < count {
        let (mut tau, mut weight) = ([0.0; BLOCK], [0.0; BLOCK]);
        let (mut at, mut width) = ([0.0; BLOCK], [1.0; BLOCK]);
        let mut found = 0;
        while found < BLOCK && panel < count {
            let Panel { pole, from, length, nodes } = &panels[panel];
            let (place, part) = nodes[node];
            (tau[found], weight[found]) = (from + length * place, length * part);
            (at[found], width[found]) = (pole.at, pole.width);
            found += 1;
            node += 1;
            if node == nodes.len() {
                (panel, node) = (panel + 1, 0);
            }
        }
        // What is left over repeats a node without weight.
        for i in found..BLOCK {
            (tau[i], at[i], width[i]) = (tau[found - 1], at[found - 1], width[found - 1]);
        }
        let mut lines = lines(simd, rule, slip, (&tau, &weight), (&at, &width));
        lines.split = split;
        if let Some((inner, inside)) = plan.and_then(|plan| plan.lines.get(number)) {
            (lines.inner, lines.inside, lines.any_inside) =
                (*inner, *inside, *inside != [false; BLOCK]);
        }
        number += 1;
        visitor.visit(simd, &lines);
    }
}

/// Place of a line on the long axis and its part of the load, from a node in the variable of (T17) and its
/// weight.
#[inline(always)]
pub(super) fn line<S: Simd, const N: usize>(
    pole: &Pole<Lane<S, N>>,
    tau: Lane<S, N>,
    weight: Lane<S, N>,
) -> (Lane<S, N>, Lane<S, N>) {
    let grow = tau.exp();
    let fall = grow.recip();
    // ξ = ξ_j + δ_j sinh τ                                               (T17)
    let xi = pole.at + pole.width * (grow - fall) * 0.5;
    // dQ/Q = (3/4)(1 − ξ²) dξ × (2/π) √(1 − s²) ds                       (T14)
    let shape = larger((-xi + 1.0) * (xi + 1.0), xi.constant(0.0)) * 0.75;
    (xi, weight * pole.width * (grow + fall) * 0.5 * shape)
}

/// The lines of nodes in the variable of (T17).
#[inline(always)]
fn lines<S: Simd>(
    simd: S,
    rule: &Quadrature,
    slip: &EllipseSlip<f64>,
    (tau, weight): (&Block, &Block),
    (at, width): (&Block, &Block),
) -> Lines {
    let slip = slip.splat(simd);
    let (mut xi, mut load, mut sinh) = ([0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK]);
    for i in (0..BLOCK).step_by(S::F64_LANES) {
        let (at, width) = (Lane::<S>::load(simd, &at[i..]), Lane::load(simd, &width[i..]));
        let (tau, weight) = (Lane::load(simd, &tau[i..]), Lane::load(simd, &weight[i..]));
        let (x, part) = line(&Pole { at, width }, tau, weight);
        x.store(&mut xi[i..]);
        part.store(&mut load[i..]);
        slip.analyticity(x).store(&mut sinh[i..]);
    }
    let (mut inside, mut any_inside) = ([false; BLOCK], false);
    let mut least = f64::INFINITY;
    for (inside, sinh) in inside.iter_mut().zip(sinh) {
        // One that is no number makes sums that are none.
        *inside = sinh < rule.reach[MOST_INNER];
        any_inside |= *inside;
        if !*inside {
            least = least.min(sinh);
        }
    }
    let inner = (least < f64::INFINITY).then(|| rule.count(least)).flatten();
    Lines { xi, weight: load, inner, inside, any_inside, split: [false; 2] }
}

impl EllipseSlip<f64> {
    #[inline(always)]
    pub(super) fn splat<S: Simd>(&self, simd: S) -> EllipseSlip<Lane<S>> {
        let [q_0, q_1, q_2] = self.along;
        EllipseSlip {
            along: [Lane::splat(simd, q_0), Lane::splat(simd, q_1), Lane::splat(simd, q_2)],
            radius: Lane::splat(simd, self.radius),
            sag: Lane::splat(simd, self.sag),
            roll: Lane::splat(simd, self.roll),
            turn: Lane::splat(simd, self.turn),
            creep: Lane::splat(simd, self.creep),
        }
    }
}

/// Power of friction over `$f Q$` of several contacts side by side, and at which of them the rule
/// resolves it without splitting panels: the sums of [`Ellipse::friction`](super::Ellipse::friction).
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
    let (mut power, mut resolved) = (zero, zero.le(zero));
    for (pole, low, high) in
        [(poles[0], zero.constant(-1.0), middle), (poles[1], middle, zero.constant(1.0))]
    {
        // Panels of no length have no weight, and poles on their ends do not split them.
        let within = low.lt(pole.at) & pole.at.lt(high);
        let least = zero.constant(rule.reach[MOST_INNER]);
        resolved = resolved & (!within | least.le(slip.analyticity(pole.at)));
        let from = ((low - pole.at) / pole.width).arsinh();
        let length = ((high - pole.at) / pole.width).arsinh() - from;
        let mut lines = [(zero, zero); BLOCK];
        let mut sinh = zero.constant(f64::INFINITY);
        for (known, (place, part)) in lines.iter_mut().zip(&rule.panel) {
            *known = line(&pole, length * *place + from, length * *part);
            sinh = sinh.min(slip.analyticity(known.0));
        }
        resolved = resolved & least.le(sinh);
        // Each contact has its own nodes along the lines, and none beyond its last.
        let (mut counts, mut most) = ([0; MANY], 0);
        for (count, sinh) in counts.iter_mut().zip(sinh.as_slice()) {
            *count = rule.count(*sinh).unwrap_or(0);
            most = most.max(rule.inner[*count].len());
        }
        for k in 0..most {
            let (mut places, mut parts) = ([0.0; MANY], [0.0; MANY]);
            for i in 0..Lane::<S, N>::LEN {
                if let Some((place, part)) = rule.inner[counts[i]].get(k) {
                    (places[i], parts[i]) = (*place, *part);
                }
            }
            let (s, part) = (zero.like(&places), zero.like(&parts));
            for (xi, weight) in lines {
                let (v_t, (b_0, b_1)) = (slip.along(xi), slip.across(xi));
                let v_c = b_0 + b_1 * s;
                let square = v_t * v_t + v_c * v_c;
                // dP = −dF·v                                              (E6)
                let pull = (square + slip.creep * slip.creep).sqrt();
                power = power + square * (weight * part) / pull;
            }
        }
    }
    (power, resolved)
}

/// Most contacts side by side.
const MANY: usize = 4 * BLOCK;
