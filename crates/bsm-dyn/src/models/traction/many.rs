//! Many points by lanes: Newton from a start, on the coarse quadrature and then on that of the accuracy.
//!
//! Points that are near their root on the coarse one make room for others. Unsolved points go to
//! the model, which searches further.
//!
//! Theory: `docs/theory/09-traction.md`, equations (T1) to (T5), (T24), (T25).

#![expect(
    clippy::inline_always,
    reason = "code takes the instruction set of its caller only inline"
)]
#![expect(clippy::needless_range_loop, reason = "places of vectors and matrices, as on paper")]

use std::sync::LazyLock;

use bsm_simd::{Arch, BLOCK, Compare, Lane, Mask, NullaryFnOnce, Simd, WithSimd};

use super::columns::{
    Angle, ContactTraction, Contacts, EquationValues, TractionPoint, contacts, evaluate, lever,
    sizes,
};
use super::root::{FASTEST, LEFT, LEVELS};
use super::slips::slid;
use super::{COARSE, OMEGA, ROOT, creep_effect};
use crate::ellipse::{Dry, ManyNodes, ManyQuadrature, Quadrature, SplitPoint};
use crate::models::ball::BALL;
use crate::models::ball::unknown::{NUT_LOAD, PRECESSION, SCREW_LOAD, TILT};

/// Residual from which the coarse quadrature is left for the one that is asked for.
const NEAR: f64 = 1e-4;

/// Sufficient decrease of (N5).
const ARMIJO: f64 = 1e-4;

/// Residual from which a last step leads to the root however slow the former ones, and the part to which the last one
/// has to lower it before [`ROOT`] does.
const GOAL: f64 = 1e-12;
const QUICK: f64 = 1e-2;

/// Evaluations at each creep speed with the coarse and with the fine quadrature before a point is left to the model.
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
#[derive(Debug, Clone, Copy)]
pub struct TractionStart<F = f64> {
    /// The point.
    pub point: TractionPoint<F>,
    /// The unknowns (T1).
    pub unknowns: [F; BALL],
}

/// A root.
#[derive(Debug, Clone, Copy)]
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

/// Numbers of a [`TractionRoot`].
pub const TRACTION_FOUND: usize = 13;

impl<F: Copy> TractionRoot<F> {
    /// The numbers one after the other.
    #[inline(always)]
    pub fn numbers(&self) -> [F; TRACTION_FOUND] {
        let Self { unknowns: [y_0, y_1, y_2, y_3, y_4, y_5, y_6], torque, power, .. } = *self;
        let Self { error, by_creep, steps, residual, .. } = *self;
        [y_0, y_1, y_2, y_3, y_4, y_5, y_6, torque, power, error, by_creep, steps, residual]
    }

    /// Of its numbers.
    #[inline(always)]
    pub fn of(numbers: [F; TRACTION_FOUND]) -> Self {
        let [unknowns @ .., torque, power, error, by_creep, steps, residual] = numbers;
        Self { unknowns, torque, power, error, by_creep, steps, residual }
    }
}

/// Numbers of a [`TractionStart`].
pub const TRACTION_START: usize = 27;

impl<F: Compare> TractionStart<F> {
    /// Where a step leads to.
    #[inline(always)]
    fn moved(&self, step: &[F; BALL]) -> Self {
        let (y, mut next) = (&self.unknowns, self.unknowns);
        for k in 0..BALL {
            next[k] = next[k] + step[k];
        }
        let tilts = [y[TILT].sin_cos_of_tilt(), next[TILT].sin_cos_of_tilt()];
        let (slid, exists) = slid(&self.point, y, step, tilts);
        for k in 0..BALL {
            next[k] = F::select(exists, slid[k], next[k]);
        }
        Self { unknowns: next, ..*self }
    }

    /// The numbers one after the other, the unknowns last.
    #[inline(always)]
    pub fn numbers(&self) -> [F; TRACTION_START] {
        let Self { point, unknowns: [y_0, y_1, y_2, y_3, y_4, y_5, y_6] } = *self;
        let TractionPoint { lead: (sin, cos), radius, arc, reach, .. } = point;
        let TractionPoint { offsets: [l_a, l_b], approach: [d_a, d_b], .. } = point;
        let TractionPoint { semi_axes: [(a, b), (c, d)], pressed_radius: [r_a, r_b], .. } = point;
        let TractionPoint { friction, mass, nut_speed, offset, creep, .. } = point;
        [
            sin, cos, radius, arc, reach, l_a, l_b, d_a, d_b, a, b, c, d, r_a, r_b, friction, mass,
            nut_speed, offset, creep, y_0, y_1, y_2, y_3, y_4, y_5, y_6,
        ]
    }

    /// Of its numbers.
    #[inline(always)]
    pub fn of(numbers: [F; TRACTION_START]) -> Self {
        let [sin, cos, radius, arc, reach, l_a, l_b, d_a, d_b, numbers @ ..] = numbers;
        let [a, b, c, d, r_a, r_b, friction, mass, nut_speed, numbers @ ..] = numbers;
        let [offset, creep, unknowns @ ..] = numbers;
        let point = TractionPoint {
            lead: (sin, cos),
            radius,
            arc,
            reach,
            offsets: [l_a, l_b],
            approach: [d_a, d_b],
            semi_axes: [(a, b), (c, d)],
            pressed_radius: [r_a, r_b],
            friction,
            mass,
            nut_speed,
            offset,
            creep,
            at_nut: false,
        };
        Self { point, unknowns }
    }

    /// Sines and cosines of the contact angles, and the motion over the contacts: speed of the centre along t,
    /// angular velocity about t, N and t × N.
    #[inline(always)]
    pub fn contacts(&self) -> ([(F, F); 2], [[F; 4]; 2]) {
        let Contacts { angles: [nut, screw], points: [over_nut, over_screw], .. } =
            contacts(&self.point, &self.unknowns, self.unknowns[TILT].sin_cos_of_tilt()).0;
        let angles = [(nut.sin, nut.cos), (screw.sin, screw.cos)];
        (angles, [over_nut.motion, over_screw.motion])
    }
}

/// Numbers of a point on the way to its root.
const NUMBERS: usize = TRACTION_START + BALL + 7;

/// A point on the way to its root.
struct Iterate<F> {
    at: TractionStart<F>,
    /// The step from there, and the part of it to try.
    step: [F; BALL],
    part: F,
    /// Scaled residual there, infinite where there is none yet, and weights of forces and moments.
    before: F,
    weights: (F, F),
    /// Evaluations, and those with the present creep speed.
    steps: F,
    tries: F,
    /// The present creep speed.
    creep: F,
}

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

    /// The roots that the starts lead to.
    pub fn solve(&self, arch: Arch, starts: &[TractionStart]) -> Vec<Option<TractionRoot>> {
        arch.dispatch(Solve { rules: self, starts })
    }
}

struct Solve<'a> {
    rules: &'a TractionMany,
    starts: &'a [TractionStart],
}

impl WithSimd for Solve<'_> {
    type Output = Vec<Option<TractionRoot>>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self { rules, starts } = self;
        let mut roots = vec![None; starts.len()];
        let Some(coarse) = &*NEARBY else { return roots };
        let mut walks = vec![[0.0; NUMBERS]; starts.len()];
        let mut points: Vec<usize> = (0..starts.len()).collect();
        let (mut next, mut near, mut arrived) = (Vec::new(), Vec::new(), vec![false; starts.len()]);
        let work = &mut Work::new(simd);
        for levels in LEVELS {
            for point in &points {
                let (walk, start) = (&mut walks[*point], &starts[*point]);
                let steps = walk[NUMBERS - 3];
                *walk = [0.0; NUMBERS];
                walk[..TRACTION_START].copy_from_slice(&start.numbers());
                walk[TRACTION_START + BALL + 1] = f64::INFINITY;
                walk[NUMBERS - 3] = steps;
                walk[NUMBERS - 1] = start.point.creep.max(levels[0]);
            }
            while !points.is_empty() {
                for some in points.chunks(Lane::<S>::LEN) {
                    let waiting = [&mut next, &mut near];
                    approach(simd, (coarse, levels), work, &mut walks, some, waiting);
                }
                // Neighbours share the largest of their numbers of nodes.
                next.sort_unstable();
                points.clear();
                points.extend(next.drain(..).map(|(_, point)| point));
            }
            near.sort_unstable();
            let resolved = near.partition_point(|(size, _)| *size < SPLIT);
            let mut some: Vec<_> = near.drain(..).map(|(_, point)| point).collect();
            // What is not refined needs no other start.
            for point in &some {
                arrived[*point] = true;
            }
            let mut split = some.split_off(resolved);
            for some in some.chunks(Lane::<S>::LEN) {
                let left = refine::<_, false>(simd, rules, work, &walks, some, &mut roots);
                split.extend(left);
            }
            for some in split.chunks(Lane::<S>::LEN) {
                refine::<_, true>(simd, rules, work, &walks, some, &mut roots);
            }
            points.extend((0..starts.len()).filter(|point| !arrived[*point]));
        }
        roots
    }
}

/// Numbers of some points side by side, the last one repeated.
#[inline(always)]
fn gather<S: Simd>(simd: S, walks: &[[f64; NUMBERS]], some: &[usize]) -> Iterate<Lane<S>> {
    let mut blocks = [[0.0; BLOCK]; NUMBERS];
    for i in 0..Lane::<S>::LEN {
        let numbers = &walks[some[i.min(some.len() - 1)]];
        for k in 0..NUMBERS {
            blocks[k][i] = numbers[k];
        }
    }
    let mut lanes = [Lane::splat(simd, 0.0); TRACTION_START];
    for k in 0..TRACTION_START {
        lanes[k] = Lane::load(simd, &blocks[k]);
    }
    let mut step = [lanes[0]; BALL];
    for k in 0..BALL {
        step[k] = Lane::load(simd, &blocks[TRACTION_START + k]);
    }
    let [.., part, before, force, moment, steps, tries, creep] = &blocks;
    Iterate {
        at: TractionStart::of(lanes),
        step,
        part: Lane::load(simd, part),
        before: Lane::load(simd, before),
        weights: (Lane::load(simd, force), Lane::load(simd, moment)),
        steps: Lane::load(simd, steps),
        tries: Lane::load(simd, tries),
        creep: Lane::load(simd, creep),
    }
}

/// Puts what changes of some points back.
#[inline(always)]
fn scatter<S: Simd>(walk: &Iterate<Lane<S>>, walks: &mut [[f64; NUMBERS]], some: &[usize]) {
    let [y_0, y_1, y_2, y_3, y_4, y_5, y_6] = walk.at.unknowns;
    let [d_0, d_1, d_2, d_3, d_4, d_5, d_6] = walk.step;
    let &Iterate { part, before, weights: (force, moment), steps, tries, creep, .. } = walk;
    let lanes = [
        y_0, y_1, y_2, y_3, y_4, y_5, y_6, d_0, d_1, d_2, d_3, d_4, d_5, d_6, part, before, force,
        moment, steps, tries, creep,
    ];
    let mut blocks = [[0.0; BLOCK]; NUMBERS - TRACTION_START + BALL];
    for (block, lane) in blocks.iter_mut().zip(lanes) {
        lane.store(block);
    }
    for (i, point) in some.iter().enumerate() {
        for (number, block) in walks[*point][TRACTION_START - BALL..].iter_mut().zip(&blocks) {
            *number = block[i];
        }
    }
}

/// Memory of the evaluations.
struct Work<S: Simd> {
    found: EquationValues<Lane<S>>,
    nodes: [ManyNodes<S>; 2],
    rubbed: [ContactTraction<Lane<S>>; 2],
}

impl<S: Simd> Work<S> {
    fn new(simd: S) -> Self {
        let zero = Lane::splat(simd, 0.0);
        Self {
            found: EquationValues::zero(zero),
            nodes: [ManyNodes::new(simd), ManyNodes::new(simd)],
            rubbed: [ContactTraction::none(zero); 2],
        }
    }
}

/// The equations at a state.
struct Here<S: Simd> {
    turn: Angle<Lane<S>>,
    weights: (Lane<S>, Lane<S>),
    /// Where there are contacts, and on their flanks; and where the quadrature resolves their friction.
    exists: Mask<S>,
    resolved: Mask<S>,
}

/// What [`Here`] is made of.
struct Evaluate<'a, S: Simd, const SLOPED: bool, const ROUGH: bool> {
    simd: S,
    rule: &'a ManyQuadrature,
    at: &'a TractionStart<Lane<S>>,
    /// The numbers of inner nodes stay as they are.
    counted: bool,
    /// The points, if their panels may be split.
    split: &'a [SplitPoint],
    /// Where it goes.
    work: &'a mut Work<S>,
}

impl<S: Simd, const SLOPED: bool, const ROUGH: bool> NullaryFnOnce
    for Evaluate<'_, S, SLOPED, ROUGH>
{
    type Output = Here<S>;

    #[inline(always)]
    fn call(self) -> Here<S> {
        let Self { simd, rule, at, counted, split, work: Work { found, nodes, rubbed } } = self;
        let TractionStart { point, unknowns: y } = at;
        let (zero, one) = (Lane::splat(simd, 0.0), Lane::splat(simd, 1.0));
        let (contacts, mut exists) = contacts(point, y, y[TILT].sin_cos_of_tilt());
        for angle in &contacts.angles {
            exists = exists & zero.le(angle.sin) & angle.cos.gt(zero);
        }
        for place in OMEGA {
            exists = exists & y[place].abs().lt(one * FASTEST);
        }
        let rate = y[PRECESSION] + point.offset;
        let thrown = point.mass * point.radius * rate * rate;
        let [a, b] = &contacts.points;
        let arm = lever([a.semi_axes.0, b.semi_axes.0], point.pressed_radius);
        let (force, moment) = sizes(thrown, point.friction.abs(), arm);
        let mut resolved = zero.le(zero);
        if ROUGH || split.is_empty() {
            for i in 0..2 {
                let (point, nodes) = (&contacts.points[i], &mut nodes[i]);
                resolved = resolved & rule.place(simd, point, nodes, counted);
                rubbed[i].sums = rule.sums::<S, SLOPED, ROUGH>(simd, point, nodes);
            }
        } else {
            let sums = rule.split_sums::<S, SLOPED>(simd, &contacts.points, split);
            (rubbed[0].sums, rubbed[1].sums) = (sums[0], sums[1]);
            let mut there = [0.0; BLOCK];
            there[..split.len()].fill(1.0);
            resolved = zero.lt(zero.like(&there));
        }
        rubbed[0].coefficient = at.point.friction;
        rubbed[1].coefficient = at.point.friction;
        (found.left, found.transmitted.power) = ([zero; BALL], zero);
        if SLOPED {
            found.rows = [[zero; BLOCK]; BALL];
        }
        evaluate::<_, Dry, SLOPED>(point, y, &contacts, rubbed, found);
        let weights = (force.recip(), moment.recip());
        Here { turn: contacts.turn, weights, exists, resolved }
    }
}

/// Square root of the sum of the squares of the weighted equations.
#[inline(always)]
fn norm<S: Simd>(left: &[Lane<S>; BALL], (force, moment): (Lane<S>, Lane<S>)) -> Lane<S> {
    let mut sum = force.constant(0.0);
    for (k, left) in left.iter().enumerate() {
        let part = *left * if (3..6).contains(&k) { moment } else { force };
        sum = sum + part * part;
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
    fn of(found: &EquationValues<Lane<S>>, here: &Here<S>, lead: (Lane<S>, Lane<S>)) -> Self {
        let ((sin_a, cos_a), Angle { sin, cos, .. }) = (lead, here.turn);
        let mut rows = [[sin; BALL]; BALL];
        for k in 0..BALL {
            let by = &found.rows[PIVOT_ROWS[k]];
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
    fn step(&self, left: &[Lane<S>; BALL]) -> [Lane<S>; BALL] {
        let mut x = *left;
        for k in 0..BALL {
            let mut part = -left[PIVOT_ROWS[k]];
            for j in 0..k {
                part = self.rows[k][j].neg_mul_add(x[j], part);
            }
            x[k] = part;
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
    (rule, levels): (&ManyQuadrature, &[f64]),
    work: &mut Work<S>,
    walks: &mut [[f64; NUMBERS]],
    some: &[usize],
    [next, near]: [&mut Vec<(usize, usize)>; 2],
) {
    let mut walk = gather(simd, walks, some);
    let mut step = walk.step;
    for k in 0..BALL {
        step[k] = step[k] * walk.part;
    }
    let mut trial = walk.at.moved(&step);
    trial.point.creep = walk.creep;
    let here = {
        let (at, counted, split, work) = (&trial, false, &[][..], &mut *work);
        simd.vectorize(Evaluate::<S, true, true> { simd, rule, at, counted, split, work })
    };
    let found = &work.found;
    let infinity = walk.before.constant(f64::INFINITY);
    let first = infinity.le(walk.before);
    let weights = (
        first.select(here.weights.0, walk.weights.0),
        first.select(here.weights.1, walk.weights.1),
    );
    let size = norm(&found.left, weights);
    // φ(λ) ≤ (1 − 2 γ λ) φ(0)                                             (N5)
    let decrease = walk.part.mul_add(walk.part.constant(-2.0 * ARMIJO), walk.part.constant(1.0));
    let enough = (size * size).le(decrease * walk.before * walk.before);
    let accepted = here.exists & size.lt(infinity) & (first | enough);
    let above = walk.at.point.creep.lt(walk.creep);
    let arrived = accepted & !above & size.le(size.constant(NEAR));
    let left = accepted & above & size.le(size.constant(LEFT));
    let step = Factors::of(found, &here, walk.at.point.lead).step(&found.left);
    // The last step of those that have arrived is taken.
    let last = trial.moved(&step);
    let zero = size.constant(0.0);
    for k in 0..BALL {
        let y = &mut walk.at.unknowns[k];
        *y = accepted.select(arrived.select(last.unknowns[k], trial.unknowns[k]), *y);
        walk.step[k] = left.select(zero, accepted.select(step[k], walk.step[k]));
    }
    walk.part = accepted.select(size.constant(1.0), walk.part * 0.5);
    // The next creep speed begins anew.
    walk.before = left.select(infinity, accepted.select(size, walk.before));
    let mut lower = walk.at.point.creep;
    for level in levels {
        let level = lower.constant(*level);
        lower = level.lt(walk.creep).select(lower.larger(level), lower);
    }
    walk.creep = left.select(lower, walk.creep);
    walk.tries = left.select(zero, walk.tries + 1.0);
    (walk.weights, walk.steps) = (weights, walk.steps + 1.0);
    let alive = accepted | !first;
    let waits = alive & walk.tries.lt(size.constant(MOST_COARSE));
    scatter(&walk, walks, some);
    let [mut ends, mut goes_on, mut resolved] = [[false; BLOCK]; 3];
    here.resolved.store(&mut resolved);
    (alive & arrived).store(&mut ends);
    (waits & !arrived).store(&mut goes_on);
    for (i, point) in some.iter().enumerate() {
        let size = work.nodes[0].size(i) + work.nodes[1].size(i);
        if ends[i] {
            near.push((if resolved[i] { size } else { SPLIT }, *point));
        } else if goes_on[i] {
            next.push((size, *point));
        }
    }
}

/// The roots with the quadrature that is asked for, and their errors; returns the points that it does not resolve. If
/// `SPLIT`, panels are split where they have to be, and sums taken one point after the other.
#[inline(always)]
fn refine<S: Simd, const SPLIT: bool>(
    simd: S,
    rules: &TractionMany,
    work: &mut Work<S>,
    walks: &[[f64; NUMBERS]],
    some: &[usize],
    roots: &mut [Option<TractionRoot>],
) -> Vec<usize> {
    let Iterate { mut at, mut steps, .. } = gather(simd, walks, some);
    let (rule, check) = (&rules.rule, &rules.check);
    let mut points = vec![SplitPoint::default(); if SPLIT { some.len() } else { 0 }];
    let one = steps.constant(1.0);
    let linearized = |at: &TractionStart<Lane<S>>, points: &[SplitPoint], work: &mut Work<S>| {
        let (counted, split) = (false, points);
        simd.vectorize(Evaluate::<S, true, false> { simd, rule, at, counted, split, work })
    };
    let mut here = linearized(&at, &points, work);
    let mut factors = Factors::of(&work.found, &here, at.point.lead);
    if SPLIT {
        // On the way here spin poles inside were not resolved: a Newton step more, with the numbers of nodes of the first, as in
        // the model.
        at = at.moved(&factors.step(&work.found.left));
        here = linearized(&at, &points, work);
        factors = Factors::of(&work.found, &here, at.point.lead);
        steps = steps + one;
    }
    let found = &work.found;
    let (weights, slope) = (here.weights, found.slope);
    let held = here.exists & here.resolved;
    let (mut left, mut before) = (found.left, norm(&found.left, weights));
    let (mut torque, mut power, mut by_creep, mut settled) = (one, one, one, !held);
    for _ in 0..MOST_FINE {
        if SPLIT {
            let mut done = [false; BLOCK];
            settled.store(&mut done);
            points.iter_mut().zip(done).for_each(|(point, done)| point.done = done);
        }
        let next = at.moved(&factors.step(&left));
        for k in 0..BALL {
            at.unknowns[k] = settled.select(at.unknowns[k], next.unknowns[k]);
        }
        {
            let (at, counted, split, work) = (&at, true, &points[..], &mut *work);
            simd.vectorize(Evaluate::<S, false, false> { simd, rule, at, counted, split, work });
        }
        let found = &work.found;
        let size = norm(&found.left, weights);
        let enough = size.le(one * GOAL) | size.le((before * QUICK).min(one * ROOT));
        for k in 0..BALL {
            left[k] = settled.select(left[k], found.left[k]);
        }
        torque = settled.select(torque, found.transmitted.torque);
        power = settled.select(power, found.transmitted.power);
        let pulls = [NUT_LOAD, SCREW_LOAD].map(|load| at.point.friction * at.unknowns[load]);
        let effect = creep_effect(at.point.creep, pulls, found.transmitted.sliding);
        by_creep = settled.select(by_creep, effect);
        before = settled.select(before, size);
        steps = settled.select(steps, steps + 1.0);
        settled = settled | enough;
        if !(!settled).any() {
            break;
        }
    }
    points.fill(SplitPoint::default());
    // The step from there is far below what a torque has as digits beyond its first order.
    let step = factors.step(&left);
    for k in 0..BALL {
        at.unknowns[k] = at.unknowns[k] + step[k];
        torque = torque + step[k] * slope[k];
    }
    let other = {
        let (rule, at, counted, split, work) = (check, &at, false, &points[..], &mut *work);
        simd.vectorize(Evaluate::<S, false, false> { simd, rule, at, counted, split, work })
    };
    let found = &work.found;
    // y' = y − J⁻¹ F'(y)                                                  (T24)
    let step = factors.step(&found.left);
    let mut error = found.transmitted.torque - torque;
    for k in 0..BALL {
        error = error + step[k] * slope[k];
    }
    let there = held & settled & other.exists & other.resolved;
    let [mut solved, mut unresolved] = [[false; BLOCK]; 2];
    there.store(&mut solved);
    (here.exists & !here.resolved).store(&mut unresolved);
    let (unknowns, residual) = (at.unknowns, before);
    let root = TractionRoot { unknowns, torque, power, error, by_creep, steps, residual };
    let mut blocks = [[0.0; BLOCK]; TRACTION_FOUND];
    for (block, lane) in blocks.iter_mut().zip(root.numbers()) {
        lane.store(block);
    }
    for (i, point) in some.iter().enumerate() {
        let mut numbers = [0.0; TRACTION_FOUND];
        for k in 0..TRACTION_FOUND {
            numbers[k] = blocks[k][i];
        }
        roots[*point] = solved[i].then_some(TractionRoot::of(numbers));
    }
    let split = some.iter().zip(unresolved).filter(|(_, unresolved)| *unresolved);
    split.map(|(point, _)| *point).collect()
}
