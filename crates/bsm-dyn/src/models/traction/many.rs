//! Newton's method for many points by lanes, first with the coarse quadrature and then with the
//! requested accuracy.
//!
//! When the coarse quadrature is near the root of a point, another point takes its place in the
//! lane. Points that are not solved are left to the model, which searches further.
//!
//! Theory: `docs/theory/09-traction.md`, equations (T1) to (T5), (T24), (T25).

#![expect(clippy::needless_range_loop, reason = "places of vectors and matrices, as on paper")]

use std::ops::{Index, IndexMut};
use std::sync::LazyLock;

use bsm_kin::{FieldOver, Jet};
use bsm_newton::ARMIJO;
use bsm_simd::{Arch, BLOCK, Compare, Lane, Mask, NullaryFnOnce, Simd, WithSimd};

use super::equations::{
    COARSE, ContactGeometry, Evaluation, OMEGA, ROOT, TractionPoint, balance, contact_geometry,
    lever, sizes,
};
use super::root::{FASTEST, LEFT, LEVEL};
use super::slips::{first_part, slid};
use crate::ellipse::{
    FromSums, ManyNodes, ManyQuadrature, Patch, Quadrature, Resultants, SplitPoint,
};
use crate::models::ball::unknown::{NUT_LOAD, PRECESSION, SCREW_LOAD, TILT};
use crate::models::ball::{BALL, ScaledBall, creep_effect};

/// Residual from which the first try is left to the quadrature that is asked for: less than of a single point, as the steps
/// there are not damped here.
const COARSE_RESIDUAL_BY_LANES: f64 = 1e-4;

/// Residual from which a last step leads to the root however slow the former ones, and the part to which the last one
/// has to lower it before [`ROOT`] does.
const GOAL: f64 = 1e-12;
const QUICK: f64 = 1e-2;

/// Evaluations at each creep speed with the coarse quadrature before a start is given up, and with the fine one before a point is
/// left to the model.
const MOST_COARSE: f64 = 12.0;
const MOST_FINE: usize = 8;

/// Which equation each unknown is eliminated with: friction is a convex potential of the motion, so that no
/// exchange of rows is needed.
const PIVOT_ROWS: [usize; BALL] = [6, 1, 2, 0, 3, 4, 5];

/// More nodes than any point has: of one whose panels are split.
const SPLIT: usize = usize::MAX;

static NEARBY: LazyLock<Option<ManyQuadrature>> =
    LazyLock::new(|| ManyQuadrature::new(Quadrature::of(COARSE), 3));

/// A point and the state to start from.
#[derive(Debug, Clone, Copy, Default)]
pub struct TractionStart<F = f64> {
    /// The point.
    pub point: TractionPoint<F>,
    /// The unknowns (T1).
    pub unknowns: [F; BALL],
}

/// A root.
#[derive(Debug, Clone, Copy, Default)]
pub struct TractionRoot<F = f64> {
    /// The unknowns (T1).
    pub unknowns: [F; BALL],
    /// Torque on the screw.
    pub torque: F,
    /// The power that friction takes.
    pub power: F,
    /// What the torque of another quadrature differs.
    pub error: F,
    /// What the creep speed may leave in the friction power, relative (A8).
    pub by_creep: F,
    /// Evaluations.
    pub steps: F,
    /// Scaled residual.
    pub residual: F,
}

/// Structs of numbers, one after the other: those of a point are near each other in memory.
#[derive(Debug)]
pub struct NumberRows {
    columns: usize,
    numbers: Vec<f64>,
}

impl NumberRows {
    /// Number of structs.
    fn len(&self) -> usize {
        self.numbers.len() / self.columns
    }

    /// The numbers of a struct.
    fn row<const N: usize>(&self, row: usize) -> [f64; N] {
        std::array::from_fn(|column| self[(row, column)])
    }

    fn row_mut(&mut self, row: usize) -> &mut [f64] {
        &mut self.numbers[row * self.columns..][..self.columns]
    }

    /// Stores lanes of structs, a number of each in every column.
    #[inline(always)]
    pub fn store<S: Simd, const N: usize, const COLUMNS: usize>(
        &mut self,
        rows: &(impl Iterator<Item = usize> + Clone),
        columns: [Lane<S, N>; COLUMNS],
    ) {
        for (column, numbers) in columns.into_iter().enumerate() {
            for (row, number) in rows.clone().zip(numbers.as_slice()) {
                self[(row, column)] = *number;
            }
        }
    }

    /// Lanes of structs of up to two blocks, a number of each in every column.
    #[inline(always)]
    pub fn load<S: Simd, const N: usize, const COLUMNS: usize>(
        &self,
        simd: S,
        rows: &(impl Iterator<Item = usize> + Clone),
    ) -> [Lane<S, N>; COLUMNS] {
        let mut columns = [Lane::splat(simd, 0.0); COLUMNS];
        for (column, numbers) in columns.iter_mut().enumerate() {
            let mut block = [0.0; 2 * BLOCK];
            for (number, row) in block.iter_mut().zip(rows.clone()) {
                *number = self[(row, column)];
            }
            *numbers = Lane::load(simd, &block);
        }
        columns
    }
}

impl Index<(usize, usize)> for NumberRows {
    type Output = f64;

    #[inline(always)]
    fn index(&self, (row, column): (usize, usize)) -> &f64 {
        &self.numbers[row * self.columns + column]
    }
}

impl IndexMut<(usize, usize)> for NumberRows {
    #[inline(always)]
    fn index_mut(&mut self, (row, column): (usize, usize)) -> &mut f64 {
        &mut self.numbers[row * self.columns + column]
    }
}

impl<F> TractionRoot<F> {
    /// The same of other numbers, which are made of these one after the other.
    #[inline(always)]
    pub fn map<G>(self, mut f: impl FnMut(F) -> G) -> TractionRoot<G> {
        let Self { unknowns: [y_0, y_1, y_2, y_3, y_4, y_5, y_6], .. } = self;
        TractionRoot {
            unknowns: [f(y_0), f(y_1), f(y_2), f(y_3), f(y_4), f(y_5), f(y_6)],
            torque: f(self.torque),
            power: f(self.power),
            error: f(self.error),
            by_creep: f(self.by_creep),
            steps: f(self.steps),
            residual: f(self.residual),
        }
    }
}

impl<F> TractionStart<F> {
    /// The same of other numbers, which are made of these one after the other.
    #[inline(always)]
    pub fn map<G>(self, mut f: impl FnMut(F) -> G) -> TractionStart<G> {
        let Self { point, unknowns: [y_0, y_1, y_2, y_3, y_4, y_5, y_6] } = self;
        let ScaledBall { lead: (sin, cos), offsets: [l_a, l_b], semi_axes: [nut, screw], .. } =
            point.scaled;
        let ScaledBall { approaches: [d_a, d_b], pressed_radius: [r_a, r_b], .. } = point.scaled;
        TractionStart {
            unknowns: [f(y_0), f(y_1), f(y_2), f(y_3), f(y_4), f(y_5), f(y_6)],
            point: TractionPoint {
                scaled: ScaledBall {
                    lead: (f(sin), f(cos)),
                    radius: f(point.scaled.radius),
                    arc: f(point.scaled.arc),
                    mass: f(point.scaled.mass),
                    nut_speed: f(point.scaled.nut_speed),
                    radial_distance: f(point.scaled.radial_distance),
                    offsets: [f(l_a), f(l_b)],
                    approaches: [f(d_a), f(d_b)],
                    semi_axes: [(f(nut.0), f(nut.1)), (f(screw.0), f(screw.1))],
                    pressed_radius: [f(r_a), f(r_b)],
                },
                friction: f(point.friction),
                offset: f(point.offset),
                creep: f(point.creep),
                nut_chart: point.nut_chart,
            },
        }
    }
}

impl<F: Compare> TractionStart<F> {
    /// Of loads, tilt and motion of a ball.
    ///
    /// * `p`: precession relative to the nut. * `omega`: rotation relative to the nut along t, n and b.
    #[inline(always)]
    pub fn of(
        point: TractionPoint<F>,
        [nut, screw]: [F; 2],
        tilt: F,
        p: F,
        [omega_t, omega_n, omega_b]: [F; 3],
    ) -> Self {
        let (sin, cos) = point.scaled.lead;
        // ω' = ω'_k k + ω'_n n + ω'_c k × n                               (T4)
        let along = sin * omega_t + cos * omega_b;
        let around = sin * omega_b - cos * omega_t;
        let rate = p + point.scaled.nut_speed - point.offset;
        Self { point, unknowns: [nut, tilt, screw, rate, along, omega_n, around] }
    }

    /// Sines and cosines of the contact angles, and the motion over the contacts: speed of the centre along t,
    /// angular velocity about t, N and t × N.
    #[inline(always)]
    pub fn angles_and_motions(&self) -> ([(F, F); 2], [[F; 4]; 2]) {
        let ContactGeometry { angles, patches: [nut, screw], .. } =
            contact_geometry(&self.point, &self.unknowns, self.unknowns[TILT].sin_cos_of_tilt()).0;
        (angles, [nut.motion, screw.motion])
    }
}

/// A point on the way to its root.
#[derive(Default)]
struct Iterate<F = f64> {
    at: TractionStart<F>,
    /// The step from there, and the part of it to try.
    step: [F; BALL],
    fraction: F,
    /// Scaled residual there, infinite where there is none yet, and weights of forces and moments.
    before: F,
    weights: (F, F),
    /// Evaluations, and those with the present creep speed.
    steps: F,
    tries: F,
    /// The present creep speed.
    creep: F,
}

impl<F> Iterate<F> {
    /// The same of other numbers.
    #[inline(always)]
    fn map<G>(self, mut f: impl FnMut(F) -> G) -> Iterate<G> {
        let Self { step: [d_0, d_1, d_2, d_3, d_4, d_5, d_6], weights: (force, moment), .. } = self;
        Iterate {
            at: self.at.map(&mut f),
            step: [f(d_0), f(d_1), f(d_2), f(d_3), f(d_4), f(d_5), f(d_6)],
            fraction: f(self.fraction),
            before: f(self.before),
            weights: (f(force), f(moment)),
            steps: f(self.steps),
            tries: f(self.tries),
            creep: f(self.creep),
        }
    }
}

/// Numbers of a struct in columns.
macro_rules! in_columns {
    ($vis:vis $name:ident) => {
        impl $name {
            /// How many numbers.
            $vis const COLUMNS: usize = size_of::<Self>() / size_of::<f64>();

            /// Structs of zeros.
            $vis fn rows(rows: usize) -> NumberRows {
                NumberRows { columns: Self::COLUMNS, numbers: vec![0.0; Self::COLUMNS * rows] }
            }
        }

        impl<F: Copy> $name<F> {
            /// Of its numbers, by their columns.
            #[inline(always)]
            $vis fn of_columns(numbers: &[F; $name::<f64>::COLUMNS]) -> Self {
                let mut next = 0;
                $name::<()>::default().map(|()| {
                    next += 1;
                    numbers[next - 1]
                })
            }

            /// Its numbers, by their columns.
            ///
            /// * `zero`: any number.
            #[inline(always)]
            $vis fn columns(self, zero: F) -> [F; $name::<f64>::COLUMNS] {
                let (mut numbers, mut next) = ([zero; $name::<f64>::COLUMNS], 0);
                self.map(|x| {
                    numbers[next] = x;
                    next += 1;
                });
                numbers
            }
        }
    };
}

in_columns!(pub TractionStart);
in_columns!(pub TractionRoot);
in_columns!(Iterate);

/// Quadratures of the solves of an accuracy.
#[derive(Debug)]
pub struct TractionMany {
    rule: ManyQuadrature,
    check: ManyQuadrature,
}

impl TractionMany {
    /// None if it takes more nodes than there is room for.
    pub fn of(accuracy: f64) -> Option<Self> {
        let rule = ManyQuadrature::new(Quadrature::of(accuracy), 1)?;
        Some(Self { rule, check: ManyQuadrature::new(Quadrature::check(accuracy), 1)? })
    }

    /// Finds the roots that some starts lead to; returns the places of those that come near none.
    ///
    /// * `starts`: columns of [`TractionStart`]. * `points`: the places to start from. * `roots`: columns of [`TractionRoot`], and at
    ///   which places there is one.
    pub fn solve(
        &self,
        arch: Arch,
        starts: &NumberRows,
        points: Vec<usize>,
        roots: &mut (NumberRows, Vec<bool>),
    ) -> Vec<usize> {
        arch.dispatch(SolveMany { rules: self, starts, points, roots })
    }
}

struct SolveMany<'a> {
    rules: &'a TractionMany,
    starts: &'a NumberRows,
    points: Vec<usize>,
    roots: &'a mut (NumberRows, Vec<bool>),
}

impl WithSimd for SolveMany<'_> {
    type Output = Vec<usize>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self { rules, starts, mut points, roots } = self;
        let Some(coarse) = &*NEARBY else { return points };
        let mut iterates = Iterate::rows(starts.len());
        for point in &points {
            let at = TractionStart::of_columns(&starts.row(*point));
            let (creep, before) = (at.point.creep.max(LEVEL), f64::INFINITY);
            let steps = TractionRoot::of_columns(&roots.0.row(*point)).steps;
            let begin = Iterate { at, before, steps, creep, ..Iterate::default() };
            iterates.row_mut(*point).copy_from_slice(&begin.columns(0.0));
        }
        let (mut next, mut near, mut left) = (Vec::new(), Vec::new(), Vec::new());
        let work = &mut NodeMemory([ManyNodes::new(simd), ManyNodes::new(simd)]);
        while !points.is_empty() {
            for group in points.chunks(Lane::<S>::LEN) {
                approach(
                    simd,
                    coarse,
                    work,
                    &mut iterates,
                    group,
                    [&mut next, &mut near, &mut left],
                );
            }
            // Neighbours share the largest of their numbers of nodes.
            next.sort_unstable();
            points.clear();
            points.extend(next.drain(..).map(|(_, point)| point));
        }
        near.sort_unstable();
        let resolved = near.partition_point(|(size, _)| *size < SPLIT);
        let mut group: Vec<_> = near.into_iter().map(|(_, point)| point).collect();
        let mut split = group.split_off(resolved);
        for group in group.chunks(Lane::<S>::LEN) {
            split.extend(refine::<_, false>(simd, rules, work, &iterates, group, roots));
        }
        for group in split.chunks(Lane::<S>::LEN) {
            refine::<_, true>(simd, rules, work, &iterates, group, roots);
        }
        for (_, point) in &left {
            let steps = Iterate::of_columns(&iterates.row(*point)).steps;
            let none = TractionRoot { steps, ..TractionRoot::default() };
            roots.0.row_mut(*point).copy_from_slice(&none.columns(0.0));
        }
        left.into_iter().map(|(_, point)| point).collect()
    }
}

/// Some points side by side, the last one repeated.
#[inline(always)]
fn load_iterates<S: Simd>(simd: S, iterates: &NumberRows, group: &[usize]) -> Iterate<Lane<S>> {
    let last = group[group.len() - 1];
    let rows = group.iter().copied().chain(std::iter::repeat(last));
    Iterate::of_columns(&iterates.load(simd, &rows.take(Lane::<S>::LEN)))
}

/// Nodes of the evaluations.
struct NodeMemory<S: Simd>([ManyNodes<S>; 2]);

/// Equations with their derivatives.
type Linearized<S> = Evaluation<Jet<BALL, Lane<S>>>;

/// The equations at a state.
struct ManyState<S: Simd> {
    /// Sine and cosine of the turn of the triad.
    rotation: (Lane<S>, Lane<S>),
    weights: (Lane<S>, Lane<S>),
    /// Where there are contacts, and on their flanks; and where the quadrature resolves their friction.
    exists: Mask<S>,
    resolved: Mask<S>,
}

/// Arguments of an evaluation.
struct EvaluateMany<'a, S: Simd, D, const ROUGH: bool> {
    simd: S,
    rule: &'a ManyQuadrature,
    at: &'a TractionStart<Lane<S>>,
    /// The unknowns of `at`, as variables if derivatives are asked for.
    unknowns: &'a [D; BALL],
    /// The numbers of inner nodes stay as they are.
    frozen: bool,
    /// The points, if their panels may be split.
    split: &'a [SplitPoint],
    nodes: &'a mut NodeMemory<S>,
}

impl<S, D, const ROUGH: bool> NullaryFnOnce for EvaluateMany<'_, S, D, ROUGH>
where
    S: Simd,
    D: FieldOver<Lane<S>> + FromSums<Lane<S>> + Compare<Mask = Mask<S>>,
{
    type Output = (ManyState<S>, Evaluation<D>);

    #[inline(always)]
    fn call(self) -> Self::Output {
        let Self { simd, rule, at, unknowns, frozen, split, nodes: NodeMemory(nodes) } = self;
        let TractionStart { point, unknowns: y } = at;
        let (zero, one) = (Lane::splat(simd, 0.0), Lane::splat(simd, 1.0));
        let (geometry, mut exists) =
            contact_geometry(point, unknowns, unknowns[TILT].sin_cos_of_tilt());
        for (sin, cos) in &geometry.angles {
            exists = exists & zero.le(sin.value()) & cos.value().gt(zero);
        }
        for unknown in OMEGA {
            exists = exists & y[unknown].abs().lt(one * FASTEST);
        }
        let rate = unknowns[PRECESSION] + point.offset;
        let centrifugal = point.scaled.inertia_ratio() * rate.value() * rate.value();
        let patches = [values(&geometry.patches[0]), values(&geometry.patches[1])];
        let lever_arm =
            lever([patches[0].semi_axes.0, patches[1].semi_axes.0], point.scaled.pressed_radius);
        let (force, moment) = sizes(centrifugal, point.friction.abs(), lever_arm);
        let mut resolved = zero.le(zero);
        let mut sums = [Resultants::none(zero); 2];
        if ROUGH || split.is_empty() {
            for i in 0..2 {
                let (patch, nodes) = (&patches[i], &mut nodes[i]);
                resolved = resolved & rule.place_nodes(simd, patch, nodes, frozen);
                sums[i] = if D::JACOBIAN {
                    rule.sums::<S, true, ROUGH>(simd, patch, nodes)
                } else {
                    rule.sums::<S, false, ROUGH>(simd, patch, nodes)
                };
            }
        } else {
            sums = if D::JACOBIAN {
                rule.split_sums::<S, true>(simd, &patches, split)
            } else {
                rule.split_sums::<S, false>(simd, &patches, split)
            };
            let mut ready = [0.0; BLOCK];
            ready[..split.len()].fill(1.0);
            resolved = zero.lt(zero.like(&ready));
        }
        let loads = [unknowns[NUT_LOAD], unknowns[SCREW_LOAD]];
        let pulls = [loads[0] * point.friction, loads[1] * point.friction];
        let friction = [
            D::integral(&sums[0], &geometry.patches[0]).times(pulls[0]),
            D::integral(&sums[1], &geometry.patches[1]).times(pulls[1]),
        ];
        let (residual, torque) = balance(point, unknowns, &geometry, &friction, rate);
        let none = unknowns[0].constant(0.0);
        let sliding = [
            D::fixed(pulls[0].value() * sums[0].power),
            D::fixed(pulls[1].value() * sums[1].power),
        ];
        let (sin, cos) = geometry.rotation;
        let weights = (force.recip(), moment.recip());
        let state = ManyState { rotation: (sin.value(), cos.value()), weights, exists, resolved };
        (state, Evaluation { residual, torque, sliding, rolling: [none; 2] })
    }
}

/// A patch without derivatives.
#[inline(always)]
fn values<F: Compare, D: FromSums<F>>(patch: &Patch<D>) -> Patch<F> {
    let [speed, t, n, c] = &patch.motion;
    Patch {
        semi_axes: (patch.semi_axes.0.value(), patch.semi_axes.1.value()),
        pressed_radius: patch.pressed_radius.value(),
        ball_radius: patch.ball_radius.value(),
        motion: [speed.value(), t.value(), n.value(), c.value()],
        creep: patch.creep.value(),
    }
}

impl<S: Simd> TractionStart<Lane<S>> {
    /// Where a step leads to.
    #[inline(always)]
    fn moved(&self, step: &[Lane<S>; BALL]) -> Self {
        let (y, mut next) = (&self.unknowns, self.unknowns);
        for k in 0..BALL {
            next[k] = next[k] + step[k];
        }
        let tilts = [y[TILT].sin_cos_of_tilt(), next[TILT].sin_cos_of_tilt()];
        let (slid, exists) = slid(&self.point, y, step, tilts);
        for k in 0..BALL {
            next[k] = exists.select(slid[k], next[k]);
        }
        Self { unknowns: next, ..*self }
    }

    /// The unknowns as variables.
    #[inline(always)]
    fn variables(&self) -> [Jet<BALL, Lane<S>>; BALL] {
        let mut all = self.unknowns.map(Jet::fixed);
        for (i, variable) in all.iter_mut().enumerate() {
            variable.eps[i] = variable.re.constant(1.0);
        }
        all
    }
}

/// Values of the residual.
#[inline(always)]
fn residual_of<S: Simd>(found: &Linearized<S>) -> [Lane<S>; BALL] {
    found.residual.map(|row| row.re)
}

/// Square root of the sum of the squares of the weighted equations.
#[inline(always)]
fn norm<S: Simd>(residual: &[Lane<S>; BALL], (force, moment): (Lane<S>, Lane<S>)) -> Lane<S> {
    let mut sum = force.constant(0.0);
    for (k, residual) in residual.iter().enumerate() {
        let term = *residual * if (3..6).contains(&k) { moment } else { force };
        sum = sum + term * term;
    }
    sum.sqrt()
}

/// Triangular factors of the derivatives, whose diagonal is inverted.
struct Factors<S: Simd> {
    rows: [[Lane<S>; BALL]; BALL],
    lead: (Lane<S>, Lane<S>),
    mean: (Lane<S>, Lane<S>),
}

impl<S: Simd> Factors<S> {
    /// The rotation is eliminated along t, N and `$e_x$`, so that the derivatives of the moments are about symmetric.
    #[inline(always)]
    fn of(found: &Linearized<S>, here: &ManyState<S>, lead: (Lane<S>, Lane<S>)) -> Self {
        let ((sin_a, cos_a), (sin, cos)) = (lead, here.rotation);
        let mut rows = [[sin; BALL]; BALL];
        for k in 0..BALL {
            let by = &found.residual[PIVOT_ROWS[k]].eps;
            let [along, radial, around] = [by[OMEGA[0]], by[OMEGA[1]], by[OMEGA[2]]];
            let (t, b) = (sin_a * along - cos_a * around, cos_a * along + sin_a * around);
            let (v, w) = (cos * radial + sin * b, cos * b - sin * radial);
            rows[k] = [by[NUT_LOAD], by[SCREW_LOAD], by[TILT], by[PRECESSION], t, v, w];
        }
        for k in 0..BALL {
            let pivot = rows[k][k].recip();
            rows[k][k] = pivot;
            for i in k + 1..BALL {
                let factor = rows[i][k] * pivot;
                rows[i][k] = factor;
                for j in k + 1..BALL {
                    rows[i][j] = factor.neg_mul_add(rows[k][j], rows[i][j]);
                }
            }
        }
        Self { rows, lead, mean: (sin, cos) }
    }

    /// The step that a residual asks for.
    #[inline(always)]
    fn step(&self, residual: &[Lane<S>; BALL]) -> [Lane<S>; BALL] {
        let mut x = *residual;
        for k in 0..BALL {
            let mut entry = -residual[PIVOT_ROWS[k]];
            for j in 0..k {
                entry = self.rows[k][j].neg_mul_add(x[j], entry);
            }
            x[k] = entry;
        }
        for k in (0..BALL).rev() {
            for j in k + 1..BALL {
                x[k] = self.rows[k][j].neg_mul_add(x[j], x[k]);
            }
            x[k] = x[k] * self.rows[k][k];
        }
        let ((sin_a, cos_a), (sin, cos), [nut, screw, tilt, rate, u, v, w]) =
            (self.lead, self.mean, x);
        let b = sin * v + cos * w;
        let mut step = x;
        (step[NUT_LOAD], step[SCREW_LOAD], step[TILT]) = (nut, screw, tilt);
        step[PRECESSION] = rate;
        step[OMEGA[0]] = sin_a * u + cos_a * b;
        step[OMEGA[1]] = cos * v - sin * w;
        step[OMEGA[2]] = sin_a * b - cos_a * u;
        step
    }
}

/// One evaluation with the coarse quadrature, and a step from it.
#[inline(always)]
fn approach<S: Simd>(
    simd: S,
    rule: &ManyQuadrature,
    nodes: &mut NodeMemory<S>,
    iterates: &mut NumberRows,
    group: &[usize],
    [next, near, left]: [&mut Vec<(usize, usize)>; 3],
) {
    let mut iterate = load_iterates(simd, iterates, group);
    let mut step = iterate.step;
    for k in 0..BALL {
        step[k] = step[k] * iterate.fraction;
    }
    let mut trial = iterate.at.moved(&step);
    trial.point.creep = iterate.creep;
    let (here, found) = {
        let (at, unknowns, frozen, split, nodes) =
            (&trial, &trial.variables(), false, &[][..], &mut *nodes);
        simd.vectorize(EvaluateMany::<_, _, true> {
            simd,
            rule,
            at,
            unknowns,
            frozen,
            split,
            nodes,
        })
    };
    let residual = residual_of(&found);
    let infinity = iterate.before.constant(f64::INFINITY);
    let first = infinity.le(iterate.before);
    let weights = (
        first.select(here.weights.0, iterate.weights.0),
        first.select(here.weights.1, iterate.weights.1),
    );
    let size = norm(&residual, weights);
    // φ(λ) ≤ (1 − 2 γ λ) φ(0)                                             (N5)
    let decrease = iterate
        .fraction
        .mul_add(iterate.fraction.constant(-2.0 * ARMIJO), iterate.fraction.constant(1.0));
    let enough = (size * size).le(decrease * iterate.before * iterate.before);
    let accepted = here.exists & size.lt(infinity) & (first | enough);
    let above = iterate.at.point.creep.lt(iterate.creep);
    let arrived = accepted & !above & size.le(size.constant(COARSE_RESIDUAL_BY_LANES));
    let lowers = accepted & above & size.le(size.constant(LEFT));
    let step = Factors::of(&found, &here, iterate.at.point.scaled.lead).step(&residual);
    // The last step of those that have arrived is taken.
    let last = trial.moved(&step);
    let zero = size.constant(0.0);
    for k in 0..BALL {
        let y = &mut iterate.at.unknowns[k];
        *y = accepted.select(arrived.select(last.unknowns[k], trial.unknowns[k]), *y);
        iterate.step[k] = lowers.select(zero, accepted.select(step[k], iterate.step[k]));
    }
    let part = first_part(trial.point.scaled.lead, &trial.unknowns, &step);
    iterate.fraction = accepted.select(part, iterate.fraction * 0.5);
    // The next creep speed begins anew.
    iterate.before = lowers.select(infinity, accepted.select(size, iterate.before));
    iterate.creep = lowers.select(iterate.at.point.creep, iterate.creep);
    iterate.tries = lowers.select(zero, iterate.tries + 1.0);
    (iterate.weights, iterate.steps) = (weights, iterate.steps + 1.0);
    let alive = accepted | !first;
    let waits = alive & iterate.tries.lt(size.constant(MOST_COARSE));
    iterates.store(&group.iter().copied(), iterate.columns(zero));
    let [mut ends, mut goes_on, mut resolved] = [[false; BLOCK]; 3];
    here.resolved.store(&mut resolved);
    (alive & arrived).store(&mut ends);
    (waits & !arrived).store(&mut goes_on);
    for (i, point) in group.iter().enumerate() {
        let size = nodes.0[0].size(i) + nodes.0[1].size(i);
        if ends[i] {
            near.push((if resolved[i] { size } else { SPLIT }, *point));
        } else if goes_on[i] {
            next.push((size, *point));
        } else {
            left.push((size, *point));
        }
    }
}

/// The roots with the quadrature that is asked for, and their errors; returns the points that it does not resolve. If
/// `SPLIT`, panels are split where they have to be, and sums taken one point after the other.
#[inline(always)]
fn refine<S: Simd, const SPLIT: bool>(
    simd: S,
    rules: &TractionMany,
    nodes: &mut NodeMemory<S>,
    iterates: &NumberRows,
    group: &[usize],
    (roots, are_roots): &mut (NumberRows, Vec<bool>),
) -> Vec<usize> {
    let Iterate { mut at, mut steps, .. } = load_iterates(simd, iterates, group);
    let (rule, check) = (&rules.rule, &rules.check);
    let mut points = vec![SplitPoint::default(); if SPLIT { group.len() } else { 0 }];
    let one = steps.constant(1.0);
    let mut linearized = |at: &TractionStart<Lane<S>>, split: &[SplitPoint]| {
        let (unknowns, frozen, nodes) = (&at.variables(), false, &mut *nodes);
        simd.vectorize(EvaluateMany::<_, _, false> {
            simd,
            rule,
            at,
            unknowns,
            frozen,
            split,
            nodes,
        })
    };
    let (mut here, mut found) = linearized(&at, &points);
    let mut factors = Factors::of(&found, &here, at.point.scaled.lead);
    if SPLIT {
        // On the way here spin poles inside were not resolved: a Newton step more, with the numbers of nodes of the first, as in
        // the model.
        at = at.moved(&factors.step(&residual_of(&found)));
        (here, found) = linearized(&at, &points);
        factors = Factors::of(&found, &here, at.point.scaled.lead);
        steps = steps + one;
    }
    let (weights, slope) = (here.weights, found.torque.eps);
    let resolved = here.exists & here.resolved;
    let mut residual = residual_of(&found);
    let mut before = norm(&residual, weights);
    let (mut torque, mut power, mut by_creep, mut converged) = (one, one, one, !resolved);
    for _ in 0..MOST_FINE {
        if SPLIT {
            let mut done = [false; BLOCK];
            converged.store(&mut done);
            points.iter_mut().zip(done).for_each(|(point, done)| point.done = done);
        }
        let next = at.moved(&factors.step(&residual));
        for k in 0..BALL {
            at.unknowns[k] = converged.select(at.unknowns[k], next.unknowns[k]);
        }
        let (_, found) = {
            let (at, unknowns, frozen, split, nodes) =
                (&at, &at.unknowns, true, &points[..], &mut *nodes);
            simd.vectorize(EvaluateMany::<_, _, false> {
                simd,
                rule,
                at,
                unknowns,
                frozen,
                split,
                nodes,
            })
        };
        let size = norm(&found.residual, weights);
        let enough = size.le(one * GOAL) | size.le((before * QUICK).min(one * ROOT));
        for k in 0..BALL {
            residual[k] = converged.select(residual[k], found.residual[k]);
        }
        torque = converged.select(torque, found.torque);
        power = converged.select(power, found.sliding[0] + found.sliding[1]);
        let pulls = [NUT_LOAD, SCREW_LOAD].map(|load| at.point.friction * at.unknowns[load]);
        let effect = creep_effect(at.point.creep, pulls, found.sliding);
        by_creep = converged.select(by_creep, effect);
        before = converged.select(before, size);
        steps = converged.select(steps, steps + 1.0);
        converged = converged | enough;
        if !(!converged).any() {
            break;
        }
    }
    points.fill(SplitPoint::default());
    // The step from there is far below what a torque has as digits beyond its first order.
    let step = factors.step(&residual);
    for k in 0..BALL {
        at.unknowns[k] = at.unknowns[k] + step[k];
        torque = torque + step[k] * slope[k];
    }
    let (other, found) = {
        let (rule, at, unknowns) = (check, &at, &at.unknowns);
        let (frozen, split, nodes) = (false, &points[..], &mut *nodes);
        simd.vectorize(EvaluateMany::<_, _, false> {
            simd,
            rule,
            at,
            unknowns,
            frozen,
            split,
            nodes,
        })
    };
    // y' = y − J⁻¹ F'(y)                                                  (T24)
    let step = factors.step(&found.residual);
    let mut error = found.torque - torque;
    for k in 0..BALL {
        error = error + step[k] * slope[k];
    }
    let ready = resolved & converged & other.exists & other.resolved;
    let [mut solved, mut unresolved] = [[false; BLOCK]; 2];
    ready.store(&mut solved);
    let resolved = here.resolved & (other.resolved | !converged);
    (here.exists & !resolved).store(&mut unresolved);
    let (unknowns, residual) = (at.unknowns, before);
    let root = TractionRoot { unknowns, torque, power, error, by_creep, steps, residual };
    roots.store(&group.iter().copied(), root.columns(residual));
    for (point, solved) in group.iter().zip(solved) {
        are_roots[*point] = solved;
    }
    let split = group.iter().zip(unresolved).filter(|(_, unresolved)| *unresolved);
    split.map(|(point, _)| *point).collect()
}
