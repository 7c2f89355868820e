//! Choice of the model by error bounds for lanes, Eqs (A2) to (A5). Rows that skid are collected and
//! solved side by side. Rows that need traction are left to the model.

use bsm_case::{InputKey, OutputKey};
use bsm_dyn::internals::{ModelErrors, SlidingBall};
use bsm_dyn::{Basis, Choice, Direction, ErrorBound};
use bsm_simd::{Arch, Simd, WithSimd};

use crate::contacts::UnitsCall;
use crate::elastic::ElasticKernel;
use crate::kernel::{Kernel, RowChoice, RowKernel, Rows, Selection, Sink};
use crate::operand::{Lane, LaneInputs, MANY, ValidCall};
use crate::raceway::{RacewayKernel, RacewayRow};

/// Outputs of a kernel that the choice needs.
const ASKED: [OutputKey; 1] = [OutputKey::efficiency];

/// Outputs of raceway control that are kept in a result of gross slip.
const OF_ROLLING: [OutputKey; 2] = [OutputKey::skid_number, OutputKey::onset_number];

/// Solves the rows for which the kernel of raceway control or gross slip meets the tolerance, and
/// returns the reasons for the choice. All other rows are left to the model.
pub(super) fn solve(arch: Arch, mut rows: Rows<'_, '_>, tolerance: f64) -> Vec<RowChoice> {
    let rolling = arch.dispatch(RollingRows(&mut rows));
    let asked = rows.wanted.with(&ASKED, rows.columns.len());
    let mut auto = AutoRows { rows, asked, tolerance, chosen: Vec::new() };
    let mut skidding = Vec::new();
    for ball in rolling {
        match ball.errors.basis(tolerance) {
            Some(basis @ Basis::Rolling { .. }) => {
                // Only the model searches for other solutions.
                if ball.is_unique {
                    auto.choose(&ball, ball.efficiency, ball.errors.rolling, basis);
                }
            }
            Some(basis) => skidding.push((ball, basis)),
            None => {}
        }
    }
    let group = auto.ask(skidding.iter().map(|(ball, _)| ball), |rows| {
        arch.dispatch(RowKernel { kernel: ElasticKernel, rows });
    });
    for (i, (ball, basis)) in skidding.into_iter().enumerate().filter(|(i, _)| group.done[*i]) {
        let efficiency = group.efficiency(i);
        let bound = ball.errors.skid_bound((ball.efficiency - efficiency).abs());
        if bound <= tolerance {
            auto.take(&ball, (&group, i), &OF_ROLLING);
            auto.choose(&ball, efficiency, bound, basis);
        }
    }
    auto.chosen
}

/// Rows for which the model is chosen.
struct AutoRows<'a, 'b> {
    rows: Rows<'a, 'b>,
    /// The requested outputs, and the outputs that the choice needs.
    asked: Selection,
    tolerance: f64,
    chosen: Vec<RowChoice>,
}

/// Results of a kernel for rows side by side.
struct Group {
    columns: Vec<Vec<f64>>,
    /// Index of the column with the efficiency.
    efficiency: usize,
    done: Vec<bool>,
}

impl Group {
    /// Returns the efficiency of a row.
    fn efficiency(&self, row: usize) -> f64 {
        self.columns[self.efficiency][row]
    }
}

impl AutoRows<'_, '_> {
    /// Returns the results of a kernel for some of the rows.
    fn ask<'c>(
        &self,
        balls: impl Iterator<Item = &'c RollingRow>,
        kernel: impl FnOnce(Rows<'_, '_>),
    ) -> Group {
        let points: Vec<_> = balls.map(|ball| self.rows.first + ball.row).collect();
        let mut columns = vec![vec![f64::NAN; points.len()]; self.rows.columns.len() + ASKED.len()];
        let mut done = vec![false; points.len()];
        if !points.is_empty() {
            let mut indices: Vec<_> = columns.iter_mut().map(|column| &mut column[..]).collect();
            let (inputs, wanted) = (&self.rows.inputs.select(&points), &self.asked);
            kernel(Rows { inputs, wanted, first: 0, columns: &mut indices, done: &mut done });
        }
        let efficiency = self.asked.index(ASKED[0]).expect("it was asked for");
        Group { columns, efficiency, done }
    }

    /// Copies the results of a kernel, except for some outputs.
    fn take(&mut self, ball: &RollingRow, (group, i): (&Group, usize), but: &[OutputKey]) {
        let kept = but.iter().filter_map(|key| self.rows.wanted.index(*key));
        let kept: Vec<_> = kept.collect();
        for (index, column) in self.rows.columns.iter_mut().enumerate() {
            if !kept.contains(&index) {
                column[ball.row] = group.columns[index][i];
            }
        }
    }

    /// Completes a result by its error bound.
    fn choose(&mut self, ball: &RollingRow, efficiency: f64, bound: f64, basis: Basis) {
        let Some(direction) = Direction::of(ball.speed) else { return };
        let error = ErrorBound::of(direction, efficiency, bound);
        for (key, value) in [
            (OutputKey::efficiency_error_bound, error.efficiency),
            (OutputKey::loss_error_bound, error.loss.unwrap_or(f64::NAN)),
        ] {
            if let Some(index) = self.rows.wanted.index(key) {
                self.rows.columns[index][ball.row] = value;
            }
        }
        self.rows.done[ball.row] = true;
        let choice = Choice { basis, tolerance: self.tolerance };
        self.chosen.push(RowChoice { row: ball.row, choice, bound });
    }
}

/// A row whose ball rolls by raceway control.
struct RollingRow {
    row: usize,
    /// Relative speed `$W$`.
    speed: f64,
    efficiency: f64,
    errors: ModelErrors,
    /// True if no other rolling motion exists.
    is_unique: bool,
}

/// Solves rows with raceway control, and returns the solved rows with their error bounds.
struct RollingRows<'a, 'b, 'c>(&'c mut Rows<'a, 'b>);

impl WithSimd for RollingRows<'_, '_, '_> {
    type Output = Vec<RollingRow>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Rows { inputs, wanted, first, columns, done } = self.0;
        let mut rolling = Vec::with_capacity(done.len());
        for row in (0..done.len()).step_by(Lane::<S>::LEN) {
            let given = LaneInputs { simd, inputs, row: *first + row };
            let (units, contacts) = simd.vectorize(UnitsCall(&given));
            let mut out = Sink { wanted, columns, row };
            let ball = simd.vectorize(RacewayRow {
                given: &given,
                units: &units,
                contacts: &contacts,
                control: None,
                out: &mut out,
            });
            let friction = given.get(InputKey::friction_coefficient);
            let back = units.speed.lt(friction.constant(0.0));
            let sliding = SlidingBall::of(&contacts.scaled, back.select(-friction, friction));
            let errors =
                ModelErrors::of(&sliding, back, ball.efficiency, ball.skid, ball.cotangents);
            let known = errors.onset_number.lt(friction.constant(f64::INFINITY));
            let valid = simd.vectorize(ValidCall { given: &given, model: RacewayKernel::MODEL });
            let [mut found, mut unique] = [[false; MANY]; 2];
            (ball.found & known & valid).store(&mut found);
            ball.unique.store(&mut unique);
            let lanes = [
                units.speed,
                ball.efficiency,
                errors.onset_number,
                errors.rolling,
                errors.skidding,
                errors.range,
            ];
            let mut blocks = [[0.0; MANY]; 6];
            for (block, lane) in blocks.iter_mut().zip(lanes) {
                lane.store(block);
            }
            for i in 0..Lane::<S>::LEN.min(done.len() - row) {
                if found[i] {
                    let [speed, efficiency, onset_number, rolls, skidding, range] =
                        blocks.each_ref().map(|block| block[i]);
                    let errors = ModelErrors { onset_number, rolling: rolls, skidding, range };
                    let (row, is_unique) = (row + i, unique[i]);
                    rolling.push(RollingRow { row, speed, efficiency, errors, is_unique });
                }
            }
        }
        rolling
    }
}
