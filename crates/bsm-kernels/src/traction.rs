//! Friction over both contact ellipses for lanes, starting from the rolling or the skidding ball,
//! Eqs (T1) to (T5), (T25).

use std::cell::RefCell;
use std::rc::Rc;

use bsm_case::{InputKey, OutputKey};
use bsm_dyn::internals::{
    ElasticMotion, FAST_NUT, MAX_LOSS_ERROR, NumberRows, Plane, SKID_ONSET, TractionMany,
    TractionPoint, TractionRoot, TractionStart, efficiency, ideal_torque, integrated_error,
    is_in_range, loss_error, quadrature_error, slip_scale,
};
use bsm_dyn::{ErrorBound, Model, Traction};
use bsm_kin::Field;
use bsm_simd::{Arch, BLOCK, Simd, WithSimd};

use crate::contacts::{Contacts, ElasticAnswer, UnitsCall};
use crate::elastic::GrossSlipCall;
use crate::kernel::{Rows, Selection, Sink};
use crate::operand::{Lane, LaneInputs, Mask, ValidCall};
use crate::raceway::{RollingCall, RollingMotion, regime};
use crate::rigid::slip_angles;
use crate::units::Units;

/// Maximum number of points in a lane.
pub(super) const MANY: usize = 4 * BLOCK;

/// Largest friction coefficient, and largest ratio of the long semi-axis of the rolling ball to its
/// radius, for solved rows. Points beyond these limits may have several roots, and the model may
/// find another root from its own starting points.
const MOST_FRICTION: f64 = 0.2;
const LONGEST_AXIS: f64 = 1.0;

/// Number of quadratures that are kept: those of the choice by error bounds, and one of a given
/// accuracy.
const REMEMBERED: usize = Traction::ACCURACIES.len() + 1;

thread_local! {
    /// Quadratures of the last accuracies. There are many chunks, some of which may have a single
    /// row.
    static LAST: RefCell<Vec<(f64, Rc<TractionMany>)>> = const { RefCell::new(Vec::new()) };
}

/// Returns the quadratures for an accuracy, if they fit into the kernel.
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

/// Solves the rows for which one of two starting points leads to the root, and returns their error
/// bounds (A6).
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
        let Rows { inputs, wanted, first, columns, done } = rows;
        let (mut lanes, mut points) = (Vec::new(), Vec::new());
        let mut starts = TractionStart::rows(done.len());
        for row in (0..done.len()).step_by(Lane::<S>::LEN) {
            let given = LaneInputs { simd, inputs, row: first + row };
            let lane = LanePoints::of(&given, creep);
            let mut out = Sink { wanted, columns: &mut *columns, row };
            let rows = row..done.len().min(row + Lane::<S>::LEN);
            begin((&given, &lane), true, &rows, &mut out, (&mut starts, &mut points));
            lanes.push((given, lane));
        }
        // Lanes are loaded as a whole.
        let rows = done.len() + MANY;
        let mut roots = (TractionRoot::rows(rows), vec![false; rows]);
        let left = many.solve(arch, &starts, points, &mut roots);
        if !left.is_empty() {
            let of_chunk: Vec<_> = left.iter().map(|row| first + row).collect();
            let (inputs, wanted) = (&inputs.select(&of_chunk), &Selection::of(&[]));
            let mut points = Vec::new();
            for row in (0..left.len()).step_by(Lane::<S>::LEN) {
                let given = LaneInputs { simd, inputs, row };
                let lane = LanePoints::of(&given, creep);
                let mut out = Sink { wanted, columns: &mut [], row };
                let rows = left[row..].iter().copied().take(Lane::<S>::LEN);
                begin((&given, &lane), false, &rows, &mut out, (&mut starts, &mut points));
            }
            many.solve(arch, &starts, points, &mut roots);
        }
        let (roots, found) = roots;
        let mut bounds = vec![0.0; lanes.len() * Lane::<S>::LEN];
        for (given, lane) in &lanes {
            let row = given.row - first;
            let root = TractionRoot::of_columns(&roots.load(simd, &(row..row + Lane::<S>::LEN)));
            let mut out = Sink { wanted, columns: &mut *columns, row };
            let (solved, bound) = outputs(simd, lane, &root, accuracy, &mut out);
            bound.store(&mut bounds[row..]);
            let mut answered = [false; MANY];
            let valid = simd.vectorize(ValidCall { given, model: Model::Traction });
            (solved & valid).store(&mut answered);
            for (i, done) in done[row..].iter_mut().enumerate().take(Lane::<S>::LEN) {
                *done = answered[i] && found[row + i];
            }
        }
        bounds
    }
}

/// A lane of points.
struct LanePoints<S: Simd> {
    units: Units<S>,
    contacts: Contacts<S>,
    scaled: TractionPoint<Lane<S>>,
}

impl<S: Simd> LanePoints<S> {
    #[inline(always)]
    fn of(given: &LaneInputs<'_, S>, creep: f64) -> Self {
        let (units, contacts) = given.simd.vectorize(UnitsCall(given));
        let (zero, one) = (contacts.constant(0.0), contacts.constant(1.0));
        let friction = given.get(InputKey::friction_coefficient);
        let scaled = contacts.scaled;
        let [(nut, _), (screw, _)] = scaled.semi_axes;
        let scale = slip_scale([nut, screw], scaled.pressed_radius);
        let fast = scaled.nut_speed.abs().gt(one * FAST_NUT);
        let scaled = TractionPoint {
            scaled,
            friction: units.speed.lt(zero).select(-friction, friction),
            offset: fast.select(scaled.nut_speed, zero),
            creep: scale * creep,
            nut_chart: false,
        };
        Self { units, contacts, scaled }
    }
}

/// Stores the starting points for a lane of rows, and appends the rows that have one to the points.
///
/// * `likely`: true to start from the nearer one of the rolling and the skidding ball.
#[inline(always)]
fn begin<S: Simd>(
    (given, lane): (&LaneInputs<'_, S>, &LanePoints<S>),
    likely: bool,
    rows: &(impl Iterator<Item = usize> + Clone),
    out: &mut Sink<'_, '_>,
    (starts, points): (&mut NumberRows, &mut Vec<usize>),
) {
    let (start, found) = start(given, lane, likely, out);
    starts.store(rows, start.columns(Lane::splat(given.simd, 0.0)));
    let mut begun = [false; MANY];
    found.store(&mut begun);
    points.extend(rows.clone().zip(begun).filter(|(_, begun)| *begun).map(|(row, _)| row));
}

/// Returns the starting points for some rows, and the mask of the rows that have one.
#[inline(always)]
fn start<S: Simd>(
    given: &LaneInputs<'_, S>,
    LanePoints { contacts, scaled: point, .. }: &LanePoints<S>,
    likely: bool,
    out: &mut Sink<'_, '_>,
) -> (TractionStart<Lane<S>>, Mask<S>) {
    let one = contacts.constant(1.0);
    let friction = point.friction.abs();
    let rolling = given.simd.vectorize(RollingCall { contacts, control: None });
    let mut found = rolling.found & is_in_range(friction, contacts.scaled.inertia_ratio());
    found = found & friction.le(one * MOST_FRICTION);
    let motion = RollingMotion::of(&contacts.scaled, rolling.by_nut, &rolling.sides);
    let [onset, _] = regime(out, friction, contacts, (&rolling, &motion));
    let [a, b] = &rolling.sides;
    let mut loads = [a.load, b.load];
    for (load, (longest, _)) in loads.iter().zip(point.scaled.semi_axes) {
        found = found & (longest * Field::cbrt(*load)).le(one * LONGEST_AXIS);
    }
    let mut tilt = rolling.tilt();
    let mut p = motion.p;
    // Components along t, n and b.
    let mut omega = motion.omega;
    let skidding = onset.gt(one * SKID_ONSET) & onset.lt(one.constant(f64::INFINITY));
    let skidding = if likely { skidding } else { !skidding };
    if (found & skidding).any() {
        let skid =
            given.simd.vectorize(GrossSlipCall { contacts, friction: point.friction, any: true });
        found = found & (skid.steady | !skidding);
        let [q_a, q_b] = skid.at.state.loads;
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
    (TractionStart::of(*point, loads, tilt, p, omega), found)
}

/// Stores the requested outputs of some rows, and returns the mask of the rows with balanced power,
/// with their error bounds.
#[inline(always)]
fn outputs<S: Simd>(
    simd: S,
    LanePoints { units, contacts, scaled: point }: &LanePoints<S>,
    root: &TractionRoot<Lane<S>>,
    accuracy: f64,
    out: &mut Sink<'_, '_>,
) -> (Mask<S>, Lane<S>) {
    let (y, zero) = (root.unknowns, units.speed.constant(0.0));
    let at = TractionStart { point: *point, unknowns: y };
    let ([nut, screw], motions) = at.angles_and_motions();
    let sides = [contacts.loaded(0, y[0], nut), contacts.loaded(1, y[2], screw)];
    let lead = contacts.scaled.lead;
    let ideal = ideal_torque(units.axial, units.pitch, lead.0 / lead.1);
    let scale = units.answer();
    let (back, transmission) = (scale.back(), &scale.transmission(ideal, root.torque, root.power));
    let sign = back.select(zero - 1.0, zero + 1.0);
    // Slip at the contact center along t × N, which is e_x at the nut and −e_x at the screw, and
    // along t.
    let [[v_a, t_a, n_a, c_a], [v_b, t_b, n_b, c_b]] = motions;
    let (slip_a, slip_b) = ([-t_a, v_a + c_a], [-t_b, v_b + c_b]);
    let other = efficiency(back, ideal, (root.torque + root.error) * scale.torque);
    let error = quadrature_error(other - transmission.efficiency, accuracy);
    let loss = loss_error(back, transmission.efficiency, error);
    let stated = loss.le(zero.constant(MAX_LOSS_ERROR));
    let loss = Some(stated.select(loss, zero.constant(f64::NAN)));
    let friction =
        [[-(slip_a[0] * sign), -(slip_a[1] * sign)], [slip_b[0] * sign, -(slip_b[1] * sign)]];
    let slip_angles = slip_angles(out, friction);
    let motion = ElasticMotion {
        slip: [length(slip_a), length(slip_b)],
        spin: [n_a, n_b],
        slip_angles,
        rate: y[3] + at.point.offset,
        to_nut: [lead.0 * y[4] - lead.1 * y[6], y[5], lead.1 * y[4] + lead.0 * y[6]],
        friction_in_balance: true,
    };
    simd.vectorize(ElasticAnswer {
        out: &mut *out,
        units,
        contacts,
        sides: &sides,
        motion,
        transmission,
        error: Some(ErrorBound { efficiency: error, loss }),
        film: None,
    });
    out.set_all(OutputKey::iterations, [root.steps, root.residual]);
    let solved = transmission.is_balanced() & error.lt(zero.constant(f64::INFINITY));
    (solved, integrated_error(error, transmission.efficiency, root.by_creep))
}

#[inline(always)]
fn length<S: Simd>([across, along]: Plane<Lane<S>>) -> Lane<S> {
    (across * across + along * along).sqrt()
}
