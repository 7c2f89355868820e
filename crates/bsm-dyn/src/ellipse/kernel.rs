//! The sums of the friction over an ellipse, with derivatives, for several nodes at once.
//!
//! The law is that of [`Ellipse::integrate`](super::Ellipse::integrate), which tests this.

#![expect(
    clippy::inline_always,
    reason = "code takes the instruction set of its caller only inline"
)]

use bsm_simd::{Arch, BLOCK, Lane, Simd, WithSimd};

use super::Quadrature;

/// Nodes of the quadrature by coordinate, filled up to whole groups with nodes without weight.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Nodes([Vec<f64>; 3]);

impl Nodes {
    pub(super) fn of(nodes: &[(f64, f64, f64)]) -> Self {
        let part = |f: fn(&(f64, f64, f64)) -> f64| {
            let mut part: Vec<f64> = nodes.iter().map(f).collect();
            part.resize(nodes.len().next_multiple_of(BLOCK), 0.0);
            part
        };
        Self([part(|n| n.0), part(|n| n.1), part(|n| n.2)])
    }

    /// Sums of `N` terms over all nodes, in [`BLOCK`] parts that are added in the same order for all
    /// widths.
    #[inline(always)]
    fn total<S: Simd, const N: usize>(
        &self,
        simd: S,
        terms: impl Fn([Lane<S>; 3]) -> [Lane<S>; N],
    ) -> [f64; N] {
        let [x, y, weight] = [&self.0[0], &self.0[1], &self.0[2]].map(|v| S::as_simd_f64s(v).0);
        let parts = BLOCK / S::F64_LANES;
        let mut totals = [0.0; N];
        for part in 0..parts {
            let mut sums = [Lane::splat(simd, 0.0); N];
            for i in (part..x.len()).step_by(parts) {
                let node =
                    [Lane::of(simd, [x[i]]), Lane::of(simd, [y[i]]), Lane::of(simd, [weight[i]])];
                for (sum, term) in sums.iter_mut().zip(terms(node)) {
                    *sum = *sum + term;
                }
            }
            for (total, sum) in totals.iter_mut().zip(&sums) {
                for lane in sum.as_slice() {
                    *total += lane;
                }
            }
        }
        totals
    }
}

/// What the sums depend on: a contact with numbers in its own axes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    /// Semi-axes across and along the groove.
    pub(super) semi_axes: (f64, f64),
    /// Radius of the pressed surface.
    pub(super) pressed_radius: f64,
    /// Ball radius.
    pub(super) ball_radius: f64,
    /// Speed of the centre along t; angular velocity about t, N, t × N.
    pub(super) motion: [f64; MOTION],
    /// Creep speed.
    pub(super) creep: f64,
}

/// Numbers of the motion, sums, and derivatives: by the motion and by the growth of both semi-axes.
pub(super) const MOTION: usize = 4;
pub(super) const SUMS: usize = 5;
pub(super) const SLOPES: usize = MOTION + 1;

/// Slip of a few nodes and what it takes to compute with it.
struct Slip<S: Simd> {
    x: Lane<S>,
    y: Lane<S>,
    /// Height over the ball centre, and its change with the growth of the ellipse.
    h: Lane<S>,
    dh: Lane<S>,
    v: [Lane<S>; 2],
    /// Weight over regularized speed.
    pull: Lane<S>,
    /// One over its square.
    inverse_square: Lane<S>,
}

impl<S: Simd> Slip<S> {
    #[inline(always)]
    fn at(point: &Point, simd: S, [x, y, weight]: [Lane<S>; 3]) -> Self {
        let s = |x| Lane::splat(simd, x);
        let [along, w_t, w_n, w_c] = point.motion.map(s);
        let (x, y) = (x * s(point.semi_axes.0), y * s(point.semi_axes.1));
        let dh = x * x * s(-point.pressed_radius.recip());
        let h = dh * s(0.5) + s(point.ball_radius);
        let v = [along + w_n * x + w_c * h, -(w_t * h) - w_n * y];
        let square = v[0] * v[0] + v[1] * v[1] + s(point.creep * point.creep);
        let inverse_square = square.recip();
        let pull = weight * inverse_square.sqrt();
        Self { x, y, h, dh, v, pull, inverse_square }
    }

    /// Force along t and t × N, moment about t, N and t × N.
    #[inline(always)]
    fn terms(&self) -> [Lane<S>; SUMS] {
        let (f_t, f_c) = (-(self.pull * self.v[0]), -(self.pull * self.v[1]));
        [f_t, f_c, -(self.h * f_c), self.x * f_t - self.y * f_c, self.h * f_t]
    }
}

/// Force and moment over `$f Q$`, and the power that they take.
pub(super) fn sums(point: &Point, quadrature: &Quadrature) -> ([f64; SUMS], f64) {
    let [f_t, f_c, m_t, m_n, m_c, power] = Arch::new().dispatch(Sums(point, &quadrature.lanes));
    ([f_t, f_c, m_t, m_n, m_c], power)
}

/// Force and moment over `$f Q$`, and their derivatives: by the speed of the centre, the angular
/// velocity, and the logarithm of the size of the ellipse.
pub(super) fn slopes(
    point: &Point,
    quadrature: &Quadrature,
) -> ([f64; SUMS], [[f64; SLOPES]; SUMS]) {
    let [
        // Force and moment.
        f_t,
        f_c,
        m_t,
        m_n,
        m_c,
        // Upper triangle of the symmetric part: friction has a potential in the motion.
        aa,
        at,
        an,
        ac,
        tt,
        tn,
        tc,
        nn,
        nc,
        cc,
        // Force across, by the motion.
        ea,
        et,
        en,
        ec,
        // All of them, by the growth of the ellipse.
        ga,
        ge,
        gt,
        gn,
        gc,
    ] = Arch::new().dispatch(Slopes(point, &quadrature.lanes));
    let slopes = [
        [aa, at, an, ac, ga],
        [ea, et, en, ec, ge],
        [at, tt, tn, tc, gt],
        [an, tn, nn, nc, gn],
        [ac, tc, nc, cc, gc],
    ];
    ([f_t, f_c, m_t, m_n, m_c], slopes)
}

struct Sums<'a>(&'a Point, &'a Nodes);

impl WithSimd for Sums<'_> {
    type Output = [f64; 6];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self(point, nodes) = self;
        nodes.total(
            simd,
            #[inline(always)]
            |node| {
                let slip = Slip::at(point, simd, node);
                let [f_t, f_c, m_t, m_n, m_c] = slip.terms();
                let [v_t, v_c] = slip.v;
                [f_t, f_c, m_t, m_n, m_c, slip.pull * (v_t * v_t + v_c * v_c)]
            },
        )
    }
}

struct Slopes<'a>(&'a Point, &'a Nodes);

impl WithSimd for Slopes<'_> {
    type Output = [f64; 24];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self(point, nodes) = self;
        let [_, w_t, w_n, w_c] = point.motion.map(|x| Lane::splat(simd, x));
        nodes.total(
            simd,
            #[inline(always)]
            |node| {
                let slip = Slip::at(point, simd, node);
                let [f_t, f_c, m_t, m_n, m_c] = slip.terms();
                let Slip { x, y, h, dh, v, pull, inverse_square } = slip;
                // d(v/√(v² + v_e²)) = (1 − v v/(v² + v_e²)) dv / √(v² + v_e²)     (E7)
                let scaled = pull * inverse_square;
                let tt = scaled * v[0] * v[0] - pull;
                let tc = scaled * v[0] * v[1];
                let cc = scaled * v[1] * v[1] - pull;
                // Change of the force with the spin; with the rest of the motion it is (1, h).
                let (n_t, n_c) = (tt * x - tc * y, tc * x - cc * y);
                let (tth, tch, cch) = (tt * h, tc * h, cc * h);
                // Change of the slip, then of the force, with the growth of the ellipse.
                let (e_t, e_c) = (w_n * x + w_c * dh, -(w_t * dh) - w_n * y);
                let (g_t, g_c) = (tt * e_t + tc * e_c, tc * e_t + cc * e_c);
                [
                    f_t,
                    f_c,
                    m_t,
                    m_n,
                    m_c,
                    tt,
                    -tch,
                    n_t,
                    tth,
                    cch * h,
                    -(n_c * h),
                    -(tch * h),
                    x * n_t - y * n_c,
                    n_t * h,
                    tth * h,
                    tc,
                    -cch,
                    n_c,
                    tch,
                    g_t,
                    g_c,
                    -(dh * f_c + h * g_c),
                    m_n + x * g_t - y * g_c,
                    dh * f_t + h * g_t,
                ]
            },
        )
    }
}
