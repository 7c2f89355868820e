//! Friction over both contact ellipses by lanes, from the rolling or from the skidding ball, Eqs (T1) to (T5),
//! (T25).

use std::cell::RefCell;
use std::rc::Rc;

use bsm_case::{InputKey, OutputKey};
use bsm_dyn::balance::ideal_torque;
use bsm_dyn::{
    FAST_NUT, MOST_LOSS_ERROR, Model, POWER_BALANCE_TOL, SKID_ONSET, TRACTION_FOUND,
    TRACTION_START, Traction, TractionMany, TractionPoint, TractionRoot, TractionStart,
    integrated_error, loss_error, quadrature_error, slip_scale, takes,
};
use bsm_kin::relative_rotation;
use bsm_simd::{Arch, BLOCK, Simd, WithSimd};

use crate::closed_form::{power_balance, transmit_torque};
use crate::elastic::GrossSlip;
use crate::operand::{Lane, LaneInputs, Mask, Valid};
use crate::pair::{Balls, ContactRow, InUnits};
use crate::raceway::{BalanceCall, Motion, regime};
use crate::rigid::slip_angle;
use crate::units::Units;
use crate::{Rows, Sink};

/// Most points in a lane.
pub(super) const MANY: usize = 4 * BLOCK;

/// Accuracies that are remembered: those of the choice by error bounds, and one of one's own.
const REMEMBERED: usize = Traction::ACCURACIES.len() + 1;

thread_local! {
    /// Those of the last accuracies: chunks are many, and may be of one row.
    static LAST: RefCell<Vec<(f64, Rc<TractionMany>)>> = const { RefCell::new(Vec::new()) };
}

/// Quadratures of an accuracy, if the kernel has room for them.
fn quadratures(accuracy: f64) -> Option<Rc<TractionMany>> {
    LAST.with_borrow_mut(|last| {
        if let Some((_, many)) = last.iter().find(|known| known.0.total_cmp(&accuracy).is_eq()) {
            return Some(Rc::clone(many));
        }
        let many = Rc::new(TractionMany::of(accuracy)?);
        last.truncate(REMEMBERED - 1);
        last.insert(0, (accuracy, Rc::clone(&many)));
        Some(many)
    })
}

/// Answers the rows that its start leads to the root of, and returns the bounds of their errors (A6).
pub(super) fn solve(arch: Arch, rows: Rows<'_, '_>, accuracy: f64, creep: f64) -> Vec<f64> {
    quadratures(accuracy).map_or_else(Vec::new, |many| {
        arch.dispatch(Solve { arch, rows, accuracy, creep, many: &many })
    })
}

struct Solve<'a, 'b> {
    arch: Arch,
    rows: Rows<'a, 'b>,
    accuracy: f64,
    creep: f64,
    many: &'a TractionMany,
}

impl WithSimd for Solve<'_, '_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Vec<f64> {
        let Self { arch, rows, accuracy, creep, many } = self;
        let Rows { operands, wanted, first, columns, done } = rows;
        let (mut lanes, mut points, mut starts) = (Vec::new(), Vec::new(), Vec::new());
        for row in (0..done.len()).step_by(Lane::<S>::LEN) {
            let given = LaneInputs { simd, operands, row: first + row };
            let (units, pair) = simd.vectorize(InUnits(&given));
            let scaled = scaled(&given, (&units, &pair), creep);
            let lane = Points { units, pair, scaled };
            let mut out = Sink { wanted, columns: &mut *columns, row };
            let (start, found) = start(&given, &lane, &mut out);
            lanes.push((given, lane));
            let mut blocks = [[0.0; MANY]; TRACTION_START];
            for (block, lane) in blocks.iter_mut().zip(start.numbers()) {
                lane.store(block);
            }
            let mut begun = [false; MANY];
            found.store(&mut begun);
            for i in 0..Lane::<S>::LEN.min(done.len() - row) {
                if begun[i] {
                    let mut numbers = [0.0; TRACTION_START];
                    for k in 0..TRACTION_START {
                        numbers[k] = blocks[k][i];
                    }
                    points.push(row + i);
                    starts.push(TractionStart::of(numbers));
                }
            }
        }
        let mut roots = vec![None; done.len()];
        for (row, root) in points.into_iter().zip(many.solve(arch, &starts)) {
            roots[row] = root;
        }
        let mut bounds = vec![0.0; lanes.len() * Lane::<S>::LEN];
        for (given, lane) in &lanes {
            let row = given.row - first;
            let mut blocks = [[0.0; MANY]; TRACTION_FOUND];
            let mut found = [false; MANY];
            for (i, root) in roots[row..].iter().enumerate().take(Lane::<S>::LEN) {
                if let Some(root) = root {
                    found[i] = true;
                    for (block, number) in blocks.iter_mut().zip(root.numbers()) {
                        block[i] = number;
                    }
                }
            }
            let mut root = [Lane::splat(simd, 0.0); TRACTION_FOUND];
            for k in 0..TRACTION_FOUND {
                root[k] = Lane::load(simd, &blocks[k]);
            }
            let mut out = Sink { wanted, columns: &mut *columns, row };
            let (solved, bound) = outputs(simd, lane, &TractionRoot::of(root), accuracy, &mut out);
            bound.store(&mut bounds[row..]);
            let mut answered = [false; MANY];
            let valid = simd.vectorize(Valid { given, model: Model::Traction });
            (solved & valid).store(&mut answered);
            for (i, done) in done[row..].iter_mut().enumerate().take(Lane::<S>::LEN) {
                *done = answered[i] && found[i];
            }
        }
        bounds
    }
}

/// A lane of points.
struct Points<S: Simd> {
    units: Units<S>,
    pair: Balls<S>,
    scaled: TractionPoint<Lane<S>>,
}

#[inline(always)]
fn scaled<S: Simd>(
    given: &LaneInputs<'_, S>,
    (units, pair): (&Units<S>, &Balls<S>),
    creep: f64,
) -> TractionPoint<Lane<S>> {
    let (zero, one) = (pair.constant(0.0), pair.constant(1.0));
    let friction = given.get(InputKey::friction_coefficient);
    let [nut, screw] = &pair.pressed;
    let pressed_radius = [nut.pressed_radius, screw.pressed_radius];
    let scale = slip_scale([nut.hertz.semi_axis, screw.hertz.semi_axis], pressed_radius);
    let fast = pair.nut_speed.abs().gt(one * FAST_NUT);
    TractionPoint {
        lead: (pair.sin_a, pair.cos_a),
        radius: units.pitch / units.ball,
        arc: pair.arc,
        reach: pair.reach(),
        offsets: [nut.offset, screw.offset],
        approach: [nut.hertz.compliance, screw.hertz.compliance],
        semi_axes: [
            (nut.hertz.semi_axis, nut.hertz.semi_axis * nut.hertz.flatness),
            (screw.hertz.semi_axis, screw.hertz.semi_axis * screw.hertz.flatness),
        ],
        pressed_radius,
        friction: units.speed.lt(zero).select(-friction, friction),
        mass: units.mass,
        nut_speed: pair.nut_speed,
        offset: fast.select(pair.nut_speed, zero),
        creep: scale * creep,
        at_nut: false,
    }
}

/// Where the solves of some rows start, and the rows that have a start.
#[inline(always)]
fn start<S: Simd>(
    given: &LaneInputs<'_, S>,
    Points { units, pair, scaled: point }: &Points<S>,
    out: &mut Sink<'_, '_>,
) -> (TractionStart<Lane<S>>, Mask<S>) {
    let one = pair.constant(1.0);
    let friction = point.friction.abs();
    let roll = given.simd.vectorize(BalanceCall { pair, control: None });
    let mut found = roll.found & takes(friction, pair.inertia_ratio);
    let motion = Motion::of(pair, &roll);
    let [onset, _] = regime(out, friction, (units, pair), (&roll, &motion));
    let [a, b] = &roll.sides;
    let mut loads = [a.load, b.load];
    // sin 2ν = sin(β_B − β_A)
    let between = a.cos * b.cos + a.sin * b.sin;
    let mut tilt = roll.twist.zip(between, f64::atan2) * 0.5;
    let mut p = motion.p;
    // Along t, n and b.
    let mut omega = [pair.sin_a * 0.5, motion.omega[0], motion.omega[1]];
    let skidding = onset.gt(one * SKID_ONSET) & onset.lt(one.constant(f64::INFINITY));
    if (found & skidding).any() {
        let skid = given.simd.vectorize(GrossSlip { pair, friction: point.friction, any: true });
        found = found & (skid.steady | !skidding);
        let [q_a, q_b] = skid.state.loads;
        loads = [skidding.select(q_a, loads[0]), skidding.select(q_b, loads[1])];
        let (s, c) = skid.tilt;
        tilt = skidding.select(s.zip(c, f64::atan2), tilt);
        p = skidding.select(skid.precession(), p);
        let [t, n, b] = skid.rotation();
        omega = [
            skidding.select(t, omega[0]),
            skidding.select(n, omega[1]),
            skidding.select(b, omega[2]),
        ];
    }
    let [omega_t, omega_n, omega_b] = omega;
    // ω' = ω'_k k + ω'_n n + ω'_c k × n                                   (T4)
    let along = pair.sin_a * omega_t + pair.cos_a * omega_b;
    let around = pair.sin_a * omega_b - pair.cos_a * omega_t;
    let rate = p + pair.nut_speed - point.offset;
    let unknowns = [loads[0], tilt, loads[1], rate, along, omega_n, around];
    (TractionStart { point: *point, unknowns }, found)
}

/// Stores what is wanted of some rows, and says where their powers balance, with the bounds of their errors.
#[inline(always)]
fn outputs<S: Simd>(
    simd: S,
    Points { units, pair, scaled: point }: &Points<S>,
    root: &TractionRoot<Lane<S>>,
    accuracy: f64,
    out: &mut Sink<'_, '_>,
) -> (Mask<S>, Lane<S>) {
    let (y, w, zero) = (root.unknowns, units.speed, units.speed.constant(0.0));
    let at = TractionStart { point: *point, unknowns: y };
    let ([nut, screw], motions) = at.contacts();
    let sides = [pair.loaded(0, y[0], nut), pair.loaded(1, y[2], screw)];
    simd.vectorize(ContactRow { out: &mut *out, units, pair, sides: &sides });
    let keys = [
        [
            OutputKey::nut_slip_velocity_m_s,
            OutputKey::nut_slip_angle_deg,
            OutputKey::nut_spin_rad_s,
        ],
        [
            OutputKey::screw_slip_velocity_m_s,
            OutputKey::screw_slip_angle_deg,
            OutputKey::screw_spin_rad_s,
        ],
    ];
    let back = w.lt(zero);
    let sign = back.select(zero - 1.0, zero + 1.0);
    for ([slip, angle, spin], ([speed, w_t, w_n, w_c], side)) in
        keys.into_iter().zip(motions.into_iter().zip([sign, -sign]))
    {
        // Slip at the contact centre along t × N, which is e_x at the nut and against it at the screw, and along t.
        let (across, along) = (-w_t, speed + w_c);
        out.set(slip, (across * across + along * along).sqrt() * w.abs() * units.ball);
        slip_angle(out, angle, [-(across * side), -(along * sign)]);
        out.set(spin, w_n * w);
    }
    let lead = (pair.sin_a, pair.cos_a);
    let to_nut = [lead.0 * y[4] - lead.1 * y[6], y[5], lead.1 * y[4] + lead.0 * y[6]];
    let [t, n, b] = relative_rotation(to_nut, -pair.nut_speed, lead);
    out.set(OutputKey::ball_precession_rad_s, (y[3] + at.point.offset) * w);
    out.set(OutputKey::ball_omega_t_rad_s, t * w);
    out.set(OutputKey::ball_omega_n_rad_s, n * w);
    out.set(OutputKey::ball_omega_b_rad_s, b * w);
    let ideal = ideal_torque(pair.constant(1.0), at.point.radius, pair.sin_a / pair.cos_a);
    let eta = transmit_torque(out, back, (root.torque, ideal), units.ball * units.axial, w);
    let power = back.select(-root.power, root.power);
    let imbalance = power_balance(out, w, (root.torque, ideal), power);
    let torque = root.torque + root.error;
    let other = back.select(torque, ideal) / back.select(ideal, torque);
    let error = quadrature_error(other - eta, accuracy);
    out.set(OutputKey::efficiency_error_bound, error);
    let loss = loss_error(back, eta, error);
    let stated = loss.le(zero.constant(MOST_LOSS_ERROR));
    out.set(OutputKey::loss_error_bound, stated.select(loss, zero.constant(f64::NAN)));
    out.set(OutputKey::iterations, root.steps);
    out.set(OutputKey::residual_norm, root.residual);
    let solved = imbalance.abs().le(zero.constant(POWER_BALANCE_TOL))
        & error.lt(zero.constant(f64::INFINITY));
    (solved, integrated_error(error, eta, root.by_creep))
}
