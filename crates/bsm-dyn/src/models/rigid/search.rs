//! Search for roots of the rigid equations along the curve of all inertias.
//!
//! Theory: `docs/theory/04-rigid.md`, section on fast balls.

use std::iter;

use bsm_newton::Bracket;
use bsm_simd::BLOCK;

use super::curve::{Curve, CurvePoint, CurveSample};
use crate::cost;

/// The search begins at this turn of the slip at B over the inertia of the first order, and there at
/// the latest and earliest \[rad\]: no root is that near to no inertia.
const BEGIN: f64 = 1e-6;
const LATEST: f64 = 1e-7;
const EARLIEST: f64 = 1e-16;

/// Growth of its steps, and the longest one \[rad\].
const GROWTH: f64 = 3.0;
pub(super) const LONGEST: f64 = 0.04;

/// Steps to an end of a window, where slips turn fast and loads grow, are this part of the one before, as many
/// at most; they end at this part of [friction over inertia](Curve::friction_over_inertia).
const APPROACH: f64 = 0.35;
const APPROACHES: usize = 20;
const NEAREST: f64 = 1e-4;

/// Turns of a walk are at most so many: growing steps, long ones and two approaches.
const MOST_TURNS: usize = 200;

/// A direction moves less than this in a step, as the square of its distance on the unit circle:
/// it distinguishes the branches.
const BRANCH_DISTANCE: f64 = 0.04;

/// Below this excess at both ends of a step, two roots may be in it.
const CLOSE: f64 = 0.2;

/// Where a demand breaks, inertia that is this far off at both ends of a step has no root in it.
const FAR: f64 = 0.99;

/// Most halvings of a step where a branch that may have a root ends or moves far; and where a demand breaks or two
/// roots may be close: those that take as long as one.
const LOST: u32 = 45;
const PAIR: u32 = 3;

/// Halves no step any more after so many samples, ten times what was ever needed.
const MOST_SAMPLES: usize = 10_000;

/// Newton on the full equations goes on from this excess.
const ENOUGH: f64 = 1e-9;

/// The search, with what is done with a root that it finds.
pub(super) struct CurveSearch<'a, F> {
    curve: &'a Curve,
    accept: F,
    /// The inertia ratio nearest to that of the point at which an admissible state was met.
    nearest: Option<(f64, f64)>,
    samples: usize,
}

/// Turns of a walk through a window above zero: steps that grow up to the longest, and ever shorter ones
/// towards its ends, down to `nearest`.
fn turns(first: f64, [low, high]: [f64; 2], nearest: f64) -> Vec<f64> {
    let step = LONGEST.min(0.5 * (high - low));
    if step <= 0.0 {
        // Half of the smallest number is none: nothing is between the ends.
        return vec![high];
    }
    let shorter = |step: &f64| (*step > nearest).then_some(step * APPROACH);
    let approach: Vec<_> = iter::successors(Some(step), shorter).take(APPROACHES + 1).collect();
    let longer = |slip_turn: f64| (slip_turn * GROWTH).min(slip_turn + LONGEST);
    let mut turns = Vec::with_capacity(MOST_TURNS);
    let mut slip_turn = if low > 0.0 {
        turns.extend(approach.iter().rev().map(|step| low + step));
        longer(low + step)
    } else {
        first.min(step)
    };
    while slip_turn < high - step {
        turns.push(slip_turn);
        slip_turn = longer(slip_turn);
    }
    turns.extend(approach.iter().map(|step| high - step));
    turns.push(high);
    turns
}

/// The turns that halve a step three times, which take as long as one.
fn eighths(from: f64, to: f64) -> [f64; BLOCK - 1] {
    let half = |from: f64, to: f64| 0.5 * (from + to);
    let middle = half(from, to);
    let [low, high] = [half(from, middle), half(middle, to)];
    [half(from, low), low, half(low, middle), middle, half(middle, high), high, half(high, to)]
}

/// Place of the least of four values.
fn least(value: impl Fn(usize) -> f64) -> usize {
    (1..4).fold(0, |least, i| if value(i) < value(least) { i } else { least })
}

impl CurveSample {
    /// True if a branch keeps all demands, or one of each sample together do: else no root is between them.
    fn may_meet(&self, other: &Self) -> bool {
        let violated = |point: &CurvePoint| point.violated;
        let two = || other.branches.iter().flatten().map(violated);
        let met = |i: u16| i == 0 || two().any(|j| i & j == 0);
        self.branches.iter().flatten().map(violated).any(met) || two().any(|j| j == 0)
    }

    /// The branches of both samples that are nearest to each other.
    fn pairs(&self, other: &Self) -> [Option<(usize, usize)>; 4] {
        let distance = self.branches.each_ref().map(|one| {
            other.branches.each_ref().map(|two| match (one, two) {
                (Some(one), Some(two)) => one.distance(two).min(f64::INFINITY),
                _ => f64::INFINITY,
            })
        });
        std::array::from_fn(|i| {
            let j = least(|j| distance[i][j]);
            let are = self.branches[i].is_some() && other.branches[j].is_some();
            (are && least(|i| distance[i][j]) == i).then_some((i, j))
        })
    }
}

impl<'a, F: FnMut(&CurvePoint) -> bool> CurveSearch<'a, F> {
    pub(super) fn new(curve: &'a Curve, accept: F) -> Self {
        Self { curve, accept, nearest: None, samples: 0 }
    }

    /// Visits the roots in the order of the turn upwards from zero, then downwards, until a visit
    /// says that it is enough; returns whether one did. `inertia`: `$\varepsilon$` of the first order.
    pub(super) fn run(&mut self, inertia: f64) -> bool {
        let first = (BEGIN * inertia).clamp(EARLIEST, LATEST);
        let [below, above] = self.curve.windows();
        if below.or(above).is_some() {
            cost::searched();
        }
        let nearest = NEAREST * self.curve.friction_over_inertia();
        let above = above.map(|window| turns(first, window, nearest));
        let below = below.map(|[low, high]| turns(first, [-high, -low], nearest));
        let below = below.map(|turns| turns.into_iter().map(|slip_turn| -slip_turn).collect());
        [above, below].into_iter().flatten().any(|turns: Vec<f64>| {
            let mut before: Option<CurveSample> = None;
            turns.chunks(BLOCK).any(|turns| {
                let mut samples = [None; BLOCK];
                self.samples(turns, &mut samples);
                let mut one = before.as_ref();
                for sample in samples.iter().flatten() {
                    if one.is_some_and(|one| self.between(one, sample, 0, &[])) {
                        return true;
                    }
                    one = Some(sample);
                }
                before = one.copied();
                false
            })
        })
    }

    /// The inertia ratio nearest to that of the point at which an admissible state was met.
    pub(super) fn nearest_inertia(&self) -> Option<f64> {
        self.nearest.map(|(_, inertia_ratio)| inertia_ratio)
    }

    /// True if steps were left that should have been halved further.
    pub(super) fn is_cut_short(&self) -> bool {
        self.samples >= MOST_SAMPLES
    }

    /// Samples at some turns, at most [`BLOCK`], which take as long as one, in place of none.
    fn samples(&mut self, turns: &[f64], samples: &mut [Option<CurveSample>; BLOCK]) {
        self.curve.samples(turns, samples);
        for sample in samples.iter().flatten() {
            self.record(sample);
        }
    }

    /// Counts a sample, and notes its admissible states.
    fn record(&mut self, sample: &CurveSample) {
        self.samples += 1;
        for point in sample.branches.iter().flatten().filter(|point| point.violated == 0) {
            // It grows with the ratio of both inertias, either way.
            let far = point.inertia_residual.abs();
            if self.nearest.is_none_or(|(nearest, _)| far < nearest) {
                self.nearest = Some((far, point.inertia_ratio()));
            }
        }
    }

    /// The roots between two turns, a step that was halved so many times.
    ///
    /// * `halves`: samples at its halves, quarters and so on, in their order, as far as they are known.
    fn between(
        &mut self,
        a: &CurveSample,
        b: &CurveSample,
        halved: u32,
        halves: &[Option<CurveSample>],
    ) -> bool {
        if !a.may_meet(b) {
            return false;
        }
        let pairs = a.pairs(b);
        // A branch that may have a root and has no partner.
        let branch_lost = (0..4).any(|i| {
            let alone = |branch: &Option<CurvePoint>, paired: bool| {
                !paired && branch.as_ref().is_some_and(|point| point.violated == 0)
            };
            alone(&a.branches[i], pairs[i].is_some())
                || alone(&b.branches[i], pairs.iter().flatten().any(|(_, j)| *j == i))
        });
        // Pairs that may have one: no demand is broken at both ends.
        let live = pairs.map(|pair| {
            let (one, other) =
                pair.and_then(|(i, j)| a.branches[i].as_ref().zip(b.branches[j].as_ref()))?;
            (one.violated & other.violated == 0).then_some((one, other))
        });
        let any = |test: fn(&CurvePoint, &CurvePoint) -> bool| {
            live.iter().flatten().any(|(one, other)| test(one, other))
        };
        let most = if branch_lost || any(|one, other| one.distance(other) > BRANCH_DISTANCE) {
            LOST
        } else if any(breaks) || any(is_close) {
            PAIR
        } else {
            0
        };
        if halved < most && !self.is_cut_short() {
            let mut ahead = [None; BLOCK];
            let halves = if halves.is_empty() {
                self.curve.samples(&eighths(a.slip_turn, b.slip_turn), &mut ahead);
                &ahead[..BLOCK - 1]
            } else {
                halves
            };
            let (below, rest) = halves.split_at(halves.len() / 2);
            let Some((Some(middle), above)) = rest.split_first() else { return false };
            self.record(middle);
            return self.between(a, middle, halved + 1, below)
                || self.between(middle, b, halved + 1, above);
        }
        live.iter().flatten().any(|(one, other)| {
            let [x, y] = [one, other].map(|point| point.rate_sign_above());
            if (x <= 0.0 || y >= 0.0) && (x >= 0.0 || y <= 0.0) {
                return self.crossing(one, other);
            }
            // P = 0 between them, and a root on either side of it.
            let still = self.bracketed(one, other, CurvePoint::rate_sign_above, 0.0);
            self.crossing(one, &still) || self.crossing(&still, other)
        })
    }

    /// Visits the root between two points of one branch if there is one.
    fn crossing(&mut self, one: &CurvePoint, other: &CurvePoint) -> bool {
        if (one.inertia_residual > 0.0) == (other.inertia_residual > 0.0) {
            return false;
        }
        let root = self.bracketed(one, other, |point| point.inertia_residual, ENOUGH);
        // Where two branches are mistaken for one, rounding ends up between them instead.
        root.violated == 0 && root.inertia_residual.abs() < CLOSE && (self.accept)(&root)
    }

    /// The point between two points of one branch where `value` changes sign.
    fn bracketed(
        &mut self,
        one: &CurvePoint,
        other: &CurvePoint,
        value: impl Fn(&CurvePoint) -> f64,
        enough: f64,
    ) -> CurvePoint {
        let mut ends = [*one, *other];
        let values = ends.map(|end| value(&end));
        let rises = values[1] > 0.0;
        let bracket =
            Bracket { f_tol: enough, ..Bracket::new(ends.map(|end| end.slip_turn), values) };
        bracket.root(|slip_turn| {
            let mut samples = [None; BLOCK];
            self.samples(&[slip_turn], &mut samples);
            let near = |point: &CurvePoint| point.distance(&ends[0]).min(point.distance(&ends[1]));
            let points = samples.iter().flatten().flat_map(|sample| &sample.branches).flatten();
            points.min_by(|x, y| near(x).total_cmp(&near(y))).map_or(f64::NAN, |point| {
                let value = value(point);
                ends[usize::from((value > 0.0) == rises)] = *point;
                value
            })
        });
        let [low, high] = ends;
        if value(&low).abs() < value(&high).abs() { low } else { high }
    }
}

/// True if a demand breaks between two points that may have a root between them.
fn breaks(one: &CurvePoint, other: &CurvePoint) -> bool {
    one.violated != other.violated
        && one.inertia_residual.abs().min(other.inertia_residual.abs()) < FAR
}

/// True if two points on the same side of a root are so near to it that two may be between them.
fn is_close(one: &CurvePoint, other: &CurvePoint) -> bool {
    let (x, y) = (one.inertia_residual, other.inertia_residual);
    x * y > 0.0 && x.abs().max(y.abs()) < CLOSE
}
