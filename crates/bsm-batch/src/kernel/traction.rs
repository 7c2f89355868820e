//! Friction over both contact ellipses by lanes: Newton from the gripping or from the skidding ball,
//! Eqs (T1) to (T5), (T24), (T25).
//!
//! The points of a call are solved in three rounds. The first finds where they start. The second brings them
//! near their roots by a coarse quadrature; those that have arrived make room for others. The third refines the
//! roots and tells their errors. What is left over goes to the model, which searches on.

mod balance;
mod pool;

use std::sync::LazyLock;

use bsm_case::{InputKey, OutputKey, Settings};
use bsm_dyn::{InnerNodes, ManyQuadrature, Model, POWER_BALANCE_TOL};
use bsm_simd::{Simd, WithSimd};

use self::balance::{
    BALL, Balls, Evaluated, Factors, NUT_LOAD, OMEGA, PRECESSION, SCREW_LOAD, TILT, Vector,
};
use self::pool::{Known, Pool, Together};
use super::closed_form::{power_balance, transmit_torque};
use super::elastic::Skid;
use super::pair::{Pair, contacts};
use super::raceway::{Grip, Motion, regime};
use super::rigid::slip_angle;
use super::units::Units;
use super::{Out, Rows};
use crate::operand::{Given, Lane, Mask};

/// Skid number from which the skidding ball is the nearer start.
const SKIDS: f64 = 0.3;

/// Residual from which the coarse quadrature is left for the one that is asked for.
const NEAR: f64 = 1e-3;

/// Residual that is small enough for a root, and the one that is aimed at.
const ROOT: f64 = 1e-10;
const GOAL: f64 = 1e-12;

/// Sufficient decrease of (N5), and the shortest part of a step.
const ARMIJO: f64 = 1e-4;
const SHORTEST: f64 = 1e-3;

/// Evaluations with the coarse and with the fine quadrature before a point is left to the model, which takes
/// as long as tens of them.
const MOST_COARSE: usize = 14;
const MOST_FINE: usize = 8;

/// Friction below this is none.
const LEAST_FRICTION: f64 = 1e-12;

static COARSE: LazyLock<Option<ManyQuadrature>> = LazyLock::new(|| ManyQuadrature::of(1e-4));

/// The solves of the rows of a call.
pub(super) struct Run<'a, 'b> {
    pub(super) settings: &'a Settings,
    pub(super) rows: Rows<'a, 'b>,
}

impl WithSimd for Run<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { settings, rows } = self;
        let accuracy = settings.accuracy;
        let (Some(coarse), Some(rule), Some(check)) =
            (&*COARSE, ManyQuadrature::of(accuracy), ManyQuadrature::check(accuracy))
        else {
            return;
        };
        let Rows { operands, wanted, first, columns, done } = rows;
        let given = |row: usize| Given { simd, operands, row: first + row };
        let mut solve = Solve { pool: Pool::new(done.len()), next: Vec::new() };
        let mut started = vec![false; done.len()];
        for row in (0..done.len()).step_by(Lane::<S>::LEN) {
            let mut out = Out { wanted, columns: &mut *columns, row };
            let begun = solve.start(&given(row), settings.creep, &mut out);
            begun.store(&mut started[row..]);
        }
        let mut points: Vec<usize> = (0..done.len()).filter(|row| started[*row]).collect();
        let mut near = Vec::new();
        for _ in 0..MOST_COARSE {
            if points.is_empty() {
                break;
            }
            for some in points.chunks(Lane::<S>::LEN) {
                solve.approach(simd, coarse, &Together::of(some), &mut near);
            }
            points.clear();
            points.append(&mut solve.next);
        }
        let mut found = vec![false; done.len()];
        for some in near.chunks(Lane::<S>::LEN) {
            solve.refine(simd, [&rule, &check], &Together::of(some), &mut found);
        }
        for row in (0..done.len()).step_by(Lane::<S>::LEN) {
            if !found[row..].iter().take(Lane::<S>::LEN).any(|found| *found) {
                continue;
            }
            let given = given(row);
            let mut out = Out { wanted, columns: &mut *columns, row };
            let solved = solve.outputs(&given, row, &mut out) & given.lawful(Model::Traction);
            let mut answered = [false; pool::MANY];
            solved.store(&mut answered);
            for (i, done) in done[row..].iter_mut().enumerate().take(Lane::<S>::LEN) {
                *done = answered[i] && found[row + i];
            }
        }
    }
}

struct Solve {
    pool: Pool,
    /// Points that have not arrived.
    next: Vec<usize>,
}

/// Square root of the sum of the squares of the weighted equations.
#[inline(always)]
fn norm<S: Simd>(residual: &Vector<S>, (force, moment): (Lane<S>, Lane<S>)) -> Lane<S> {
    let mut sum = force.constant(0.0);
    for (k, left) in residual.iter().enumerate() {
        let part = *left * if (3..6).contains(&k) { moment } else { force };
        sum = sum + part * part;
    }
    sum.sqrt()
}

/// The unknowns a part of a step on.
#[inline(always)]
fn ahead<S: Simd>(at: &Vector<S>, step: &Vector<S>, part: Lane<S>) -> Vector<S> {
    let mut trial = *at;
    for k in 0..BALL {
        trial[k] = at[k] + step[k] * part;
    }
    trial
}

/// One vector where the mask is true, another elsewhere.
#[inline(always)]
fn either<S: Simd>(mask: Mask<S>, yes: &Vector<S>, no: &Vector<S>) -> Vector<S> {
    let mut vector = *no;
    for k in 0..BALL {
        vector[k] = mask.select(yes[k], no[k]);
    }
    vector
}

/// Where a trial decreases the residual enough, and its residual, infinite where there is none.
#[inline(always)]
fn judged<S: Simd>(
    balls: &Balls<S>,
    at: &Evaluated<S>,
    weights: (Lane<S>, Lane<S>),
    (before, part): (Lane<S>, Lane<S>),
) -> (Mask<S>, Lane<S>) {
    let infinity = balls.arc.constant(f64::INFINITY);
    let size = norm(&at.residual, weights);
    let size = (at.exists & size.lt(infinity)).select(size, infinity);
    let first = infinity.le(before);
    // φ(λ) ≤ (1 − 2 γ λ) φ(0)                                             (N5)
    let decrease = infinity.constant(1.0) - part * (2.0 * ARMIJO);
    let enough = (size * size).le(decrease * before * before);
    (size.lt(infinity) & (first | enough), size)
}

impl Solve {
    /// Where the solves of some rows start, and the rows that have a start.
    #[inline(always)]
    fn start<S: Simd>(
        &mut self,
        given: &Given<'_, S>,
        creep: f64,
        out: &mut Out<'_, '_>,
    ) -> Mask<S> {
        let units = Units::of(given);
        let pair = Pair::of(given, &units);
        let (row, zero, one) = (out.row, pair.constant(0.0), pair.constant(1.0));
        let friction = given.get(InputKey::friction_coefficient);
        let back = units.speed.lt(zero);
        let sign = back.select(-one, one);
        let grip = Grip::of(&pair, None);
        let mut found = grip.found & one.constant(LEAST_FRICTION).le(friction);
        let motion = Motion::of(&pair, &grip);
        let skid_number = regime(out, given, (&units, &pair), (&grip, &motion));
        let [a, b] = &grip.sides;
        let mut loads = [a.load, b.load];
        // sin 2ν = sin(β_B − β_A)
        let between = a.cos * b.cos + a.sin * b.sin;
        let mut tilt = grip.rolling.twist.zip(between, f64::atan2) * 0.5;
        let mut p = motion.p;
        // Along t, n and b.
        let mut omega = [pair.sin_a * 0.5, motion.omega[0], motion.omega[1]];
        let mut steps = grip.steps;
        let skids = skid_number.gt(one * SKIDS);
        if (found & skids).any() {
            let skid = Skid::of(given.simd, &pair, sign * friction);
            found = found & (skid.found | !skids);
            let turns = skid.turns(&pair);
            let [(q_a, ..), (q_b, ..)] = skid.contacts();
            loads = [skids.select(q_a, loads[0]), skids.select(q_b, loads[1])];
            let (s, c) = skid.tilt;
            tilt = skids.select(s.zip(c, f64::atan2), tilt);
            p = skids.select(skid.rate - pair.nut_speed, p);
            let ([along, normal, across], (sin, cos)) = (turns.omega, turns.mean);
            omega = [
                skids.select(along, omega[0]),
                skids.select(cos * normal - sin * across, omega[1]),
                skids.select(sin * normal + cos * across, omega[2]),
            ];
            steps = steps + skids.select(skid.steps, zero);
        }
        let mut scale = one;
        for race in &pair.pressed {
            // max(1, a²/2R_c)                                             (T9)
            let a = race.hertz.semi_axis;
            scale = scale.max(a * a * 0.5 / race.pressed_radius);
        }
        let pool = &mut self.pool;
        pool.put(Known::Arc, 0, row, pair.arc);
        pool.put(Known::SinLead, 0, row, pair.sin_a);
        pool.put(Known::CosLead, 0, row, pair.cos_a);
        pool.put(Known::NutSpeed, 0, row, pair.nut_speed * sign);
        pool.put(Known::Sign, 0, row, sign);
        pool.put(Known::InertiaRatio, 0, row, pair.inertia_ratio);
        pool.put(Known::Friction, 0, row, friction);
        pool.put(Known::Reach, 0, row, pair.reach());
        pool.put(Known::Creep, 0, row, scale * creep);
        for (i, race) in pair.pressed.iter().enumerate() {
            pool.put(Known::Offset, i, row, race.offset);
            pool.put(Known::Compliance, i, row, race.hertz.compliance);
            pool.put(Known::SemiAxis, i, row, race.hertz.semi_axis);
            pool.put(Known::Flatness, i, row, race.hertz.flatness);
            pool.put(Known::PressedRadius, i, row, race.pressed_radius);
        }
        let [omega_t, omega_n, omega_b] = omega;
        // ω' = ω'_k k + ω'_n n + ω'_c k × n                               (T4)
        let along = pair.sin_a * omega_t + pair.cos_a * omega_b;
        let around = pair.sin_a * omega_b - pair.cos_a * omega_t;
        let unknowns = [
            (NUT_LOAD, loads[0]),
            (TILT, tilt),
            (SCREW_LOAD, loads[1]),
            (PRECESSION, p * sign),
            (OMEGA, along * sign),
            (OMEGA + 1, omega_n * sign),
            (OMEGA + 2, around * sign),
        ];
        for (place, x) in unknowns {
            pool.put(Known::At, place, row, x);
            pool.put(Known::Step, place, row, zero);
        }
        pool.put(Known::Part, 0, row, one);
        pool.put(Known::Residual, 0, row, one.constant(f64::INFINITY));
        pool.put(Known::Steps, 0, row, steps);
        found
    }

    /// One evaluation with the coarse quadrature, and a step from it; `near` takes the points that are near their
    /// root.
    #[inline(always)]
    fn approach<S: Simd>(
        &mut self,
        simd: S,
        rule: &ManyQuadrature,
        points: &Together,
        near: &mut Vec<usize>,
    ) {
        let pool = &mut self.pool;
        let balls = pool.balls(simd, points);
        let (at, step) =
            (pool.take_all(simd, Known::At, points), pool.take_all(simd, Known::Step, points));
        let part = pool.take(simd, Known::Part, 0, points);
        let before = pool.take(simd, Known::Residual, 0, points);
        let one = part.constant(1.0);
        let first = one.constant(f64::INFINITY).le(before);
        let (force, moment) = balls.weights(&at);
        let force = first.select(force, pool.take(simd, Known::ForceWeight, 0, points));
        let moment = first.select(moment, pool.take(simd, Known::MomentWeight, 0, points));
        let trial = ahead(&at, &step, part);
        let inner = &mut Default::default();
        let found = balls.evaluated::<true>(simd, &trial, rule, inner, false);
        let (accepted, size) = judged(&balls, &found, (force, moment), (before, part));
        let arrived = accepted & size.le(one * NEAR);
        let factors = Factors::of(&found);
        let next = balls.step(&factors, &found.residual);
        let shorter = part * 0.5;
        let alive = accepted | shorter.gt(one * SHORTEST);
        let held = found.resolved | !found.exists;
        let on_flanks = balls.is_admissible(&trial) & balls.is_moderate(&trial);
        pool.keep_all(Known::At, points, &either(accepted, &trial, &at));
        pool.keep_all(Known::Step, points, &either(accepted, &next, &step));
        pool.keep(Known::Part, 0, points, accepted.select(one, shorter));
        pool.keep(Known::Residual, 0, points, accepted.select(size, before));
        pool.keep(Known::ForceWeight, 0, points, force);
        pool.keep(Known::MomentWeight, 0, points, moment);
        let steps = pool.take(simd, Known::Steps, 0, points);
        pool.keep(Known::Steps, 0, points, first.select(steps, steps + 1.0));
        let [mut ends, mut goes_on] = [[false; pool::MANY]; 2];
        (arrived & held & on_flanks).store(&mut ends);
        (alive & held & !arrived).store(&mut goes_on);
        for (i, point) in points.points().iter().enumerate() {
            if ends[i] {
                near.push(*point);
            } else if goes_on[i] {
                self.next.push(*point);
            }
        }
    }

    /// The roots with the quadrature that is asked for, and their errors; marks those that are found.
    #[inline(always)]
    fn refine<S: Simd>(
        &mut self,
        simd: S,
        [rule, check]: [&ManyQuadrature; 2],
        points: &Together,
        found: &mut [bool],
    ) {
        let pool = &mut self.pool;
        let balls = pool.balls(simd, points);
        let mut at = pool.take_all(simd, Known::At, points);
        let mut steps = pool.take(simd, Known::Steps, 0, points);
        let one = steps.constant(1.0);
        let weights = balls.weights(&at);
        let (none, all) = (one.lt(one), one.le(one));
        let (mut trial, mut step) = (at, at);
        let (mut before, mut part) = (one.constant(f64::INFINITY), one);
        let (mut resolved, mut settled) = (all, none);
        // Where the last evaluation is one at the root.
        let mut there = none;
        let mut evaluated = None;
        let mut inner = <[InnerNodes; 2]>::default();
        for round in 0..MOST_FINE {
            // The numbers of nodes stay as they are where the coarse quadrature has led to.
            let here = balls.evaluated::<true>(simd, &trial, rule, &mut inner, round > 0);
            resolved = resolved & here.resolved;
            let (enough, size) = judged(&balls, &here, weights, (before, part));
            let (accepted, rejected) = (!settled & enough, !settled & !enough);
            // ‖D_F F‖ ≤ 10⁻¹⁰, and ≤ 10⁻¹² or no longer halved            (N1), (N2)
            let refined = size.le(one * GOAL) | size.gt(before * 0.5);
            // A root that no step betters is one.
            let last = rejected & before.le(one * ROOT);
            settled = settled | (accepted & size.le(one * ROOT) & refined) | last;
            at = either(accepted, &trial, &at);
            before = accepted.select(size, before);
            let factors = Factors::of(&here);
            step = either(accepted, &balls.step(&factors, &here.residual), &step);
            part = accepted.select(one, part * 0.5);
            steps = settled.select(steps, steps + 1.0);
            trial = either(settled, &at, &ahead(&at, &step, part));
            there = settled & !last;
            evaluated = Some((here.torque, here.power, factors));
            if !(!there).any() {
                break;
            }
        }
        let Some((torque, power, factors)) = evaluated else { return };
        let eta = balls.efficiency(torque);
        let other = balls.evaluated::<false>(simd, &at, check, &mut inner, false);
        // y' = y − J⁻¹ F'(y)                                              (T24)
        let moved = ahead(&at, &balls.step(&factors, &other.residual), one);
        let (torque_there, held) = balls.torque(simd, &moved, check, &mut inner[1]);
        // δη = max(10 |η'(y') − η(y)|, 10⁻⁹)                              (T25)
        let error = (balls.efficiency(torque_there) - eta).abs() * 10.0;
        let finite = error.lt(one * f64::INFINITY);
        pool.keep_all(Known::At, points, &at);
        pool.keep(Known::Torque, 0, points, torque);
        pool.keep(Known::Power, 0, points, power);
        pool.keep(Known::Error, 0, points, error.max(one * 1e-9));
        pool.keep(Known::Residual, 0, points, before);
        pool.keep(Known::Steps, 0, points, steps);
        let answered = there
            & resolved
            & other.resolved
            & held
            & finite
            & balls.is_admissible(&at)
            & balls.is_moderate(&at);
        let mut solved = [false; pool::MANY];
        answered.store(&mut solved);
        for (i, point) in points.points().iter().enumerate() {
            found[*point] = solved[i];
        }
    }

    /// Stores what is wanted of some rows, and says where their powers balance.
    #[inline(always)]
    fn outputs<S: Simd>(&self, given: &Given<'_, S>, row: usize, out: &mut Out<'_, '_>) -> Mask<S> {
        let simd = given.simd;
        let pool = &self.pool;
        let points = pool.row::<S>(row);
        let balls = pool.balls(simd, &points);
        let y = pool.take_all(simd, Known::At, &points);
        let units = Units::of(given);
        let pair = Pair::of(given, &units);
        let loaded = balls.loaded(&y);
        let [nut, screw] = loaded.angles;
        let sides = [pair.loaded(0, y[NUT_LOAD], nut), pair.loaded(1, y[SCREW_LOAD], screw)];
        contacts(out, &units, &pair, &sides);
        let (w, zero) = (units.speed.abs(), units.speed.constant(0.0));
        let [at_nut, at_screw] = [balls.local(0, &y, &loaded), balls.local(1, &y, &loaded)];
        out.set(OutputKey::nut_slip_velocity_m_s, at_nut.slip_speed() * w * units.ball);
        out.set(OutputKey::screw_slip_velocity_m_s, at_screw.slip_speed() * w * units.ball);
        // e_x is t × N at the nut, and against it at the screw.
        let [across, along] = at_nut.slip();
        slip_angle(out, OutputKey::nut_slip_angle_deg, [-across, -along]);
        let [across, along] = at_screw.slip();
        slip_angle(out, OutputKey::screw_slip_angle_deg, [across, -along]);
        out.set(OutputKey::nut_spin_rad_s, at_nut.omega[1] * w);
        out.set(OutputKey::screw_spin_rad_s, at_screw.omega[1] * w);
        // ω = Ω_n k + ω'                                                  (K12)
        let [along, radial, around] =
            [y[OMEGA] * w + units.nut_speed, y[OMEGA + 1] * w, y[OMEGA + 2] * w];
        out.set(OutputKey::ball_precession_rad_s, y[PRECESSION] * w + units.nut_speed);
        out.set(OutputKey::ball_omega_t_rad_s, pair.sin_a * along - pair.cos_a * around);
        out.set(OutputKey::ball_omega_n_rad_s, radial);
        out.set(OutputKey::ball_omega_b_rad_s, pair.cos_a * along + pair.sin_a * around);
        let torque = pool.take(simd, Known::Torque, 0, &points);
        let (back, ideal) = (units.speed.lt(zero), balls.ideal());
        transmit_torque(out, back, (torque, ideal), units.ball * units.axial, units.speed);
        let power = pool.take(simd, Known::Power, 0, &points);
        let imbalance = power_balance(out, back, (torque, ideal), power);
        let (eta, error) = (balls.efficiency(torque), pool.take(simd, Known::Error, 0, &points));
        out.set(OutputKey::efficiency_error_bound, error);
        // δP_f/P_f = δη/[(η − δη) (1 − η)] or δη/(1 − η)                  (A7)
        let least = back.select(zero + 1.0, (eta - error).max(zero));
        let loss = error / (least * (-eta + 1.0).abs());
        let finite = loss.lt(zero.constant(f64::INFINITY));
        out.set(OutputKey::loss_error_bound, finite.select(loss, zero.constant(f64::NAN)));
        out.set(OutputKey::iterations, pool.take(simd, Known::Steps, 0, &points));
        out.set(OutputKey::residual_norm, pool.take(simd, Known::Residual, 0, &points));
        imbalance.abs().le(zero.constant(POWER_BALANCE_TOL))
    }
}
