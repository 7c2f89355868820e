//! Model selection by error bounds, vectorized over the points of a block, Eqs (A2) to (A5). Rows
//! with skidding balls are collected and solved together. Rows that require the traction model are
//! left to the scalar solver.

use std::iter::repeat_with;

use bsm_case::{InputKey, SolutionOutput};
use bsm_dyn::lanes::{ModelErrors, SlidingBall};
use bsm_dyn::{
    Direction,
    model::{Basis, Choice, ErrorBound},
};
use bsm_kin::Real;
use bsm_simd::{Arch, Simd, WithSimd};

use crate::contacts::UnitsCall;
use crate::elastic::ElasticKernel;
use crate::inputs::{Lane, LaneInputs, MAX_BLOCK, ValidCall};
use crate::kernel::{Kernel, OutputColumn, RowChoice, RowKernel, Rows, Selection, Sink};
use crate::raceway::{RacewayKernel, RacewayRow};

/// Outputs that the model selection requires in addition to the requested outputs.
const REQUIRED: [SolutionOutput; 1] = [SolutionOutput::efficiency];

/// Outputs that keep the values from the raceway-control model if all other results come from the
/// gross-slip model.
const RETAINED: [SolutionOutput; 2] = [SolutionOutput::skid_number, SolutionOutput::onset_number];

/// Solves all rows for which the raceway-control kernel or the gross-slip kernel meets the
/// tolerance. Returns the selected model of each of these rows, with the reason for its selection.
/// All other rows are left to the scalar solver.
pub(super) fn solve(arch: Arch, mut rows: Rows<'_, '_>, tolerance: f64) -> Vec<RowChoice> {
    let rolling = arch.dispatch(RollingRows(&mut rows));
    let selection = rows.wanted.with(&REQUIRED, rows.columns.len());
    let mut auto = AutoRows { rows, selection, tolerance, chosen: Vec::new() };
    let mut skidding = Vec::new();
    for ball in rolling {
        match ball.errors.basis(tolerance) {
            Some(basis @ Basis::Rolling { .. }) if ball.is_unique => {
                auto.choose(&ball, ball.efficiency, ball.errors.rolling, basis);
            }
            // Further solutions may exist, and only the scalar solver can search for them.
            Some(Basis::Rolling { .. }) | None => {}
            Some(basis) => skidding.push((ball, basis)),
        }
    }
    let group = auto.solve_group(skidding.iter().map(|(ball, _)| ball), |rows| {
        arch.dispatch(RowKernel { kernel: ElasticKernel, rows });
    });
    for (i, (ball, basis)) in skidding.into_iter().enumerate().filter(|(i, _)| group.done[*i]) {
        let efficiency = group.efficiency(i);
        let bound = ball.errors.skid_bound((ball.efficiency - efficiency).abs());
        if bound <= tolerance {
            auto.copy(&ball, (&group, i), &RETAINED);
            auto.choose(&ball, efficiency, bound, basis);
        }
    }
    auto.chosen
}

/// Table rows for which `auto` selects a model.
struct AutoRows<'a, 'b> {
    rows: Rows<'a, 'b>,
    /// Requested outputs, and outputs that the model selection requires.
    selection: Selection,
    /// Largest permitted error of the efficiency.
    tolerance: f64,
    /// Selected model of each solved row.
    chosen: Vec<RowChoice>,
}

/// Results that a kernel calculated for some of the rows.
struct Group {
    columns: Vec<OutputColumn<'static>>,
    /// Index of the efficiency column.
    efficiency: usize,
    /// True for each row that the kernel has solved.
    done: Vec<bool>,
}

impl Group {
    /// Returns the efficiency of a row.
    fn efficiency(&self, row: usize) -> f64 {
        self.columns[self.efficiency].value(row)
    }
}

impl AutoRows<'_, '_> {
    /// Solves the rows of the given balls with a kernel, and returns the results.
    fn solve_group<'c>(
        &self,
        balls: impl Iterator<Item = &'c RollingRow>,
        kernel: impl FnOnce(Rows<'_, '_>),
    ) -> Group {
        let points: Vec<_> = balls.map(|ball| self.rows.first + ball.row).collect();
        let count = self.rows.columns.len() + REQUIRED.len();
        let mut columns: Vec<_> =
            repeat_with(|| OutputColumn::on_demand(points.len())).take(count).collect();
        let mut done = vec![false; points.len()];
        if !points.is_empty() {
            let (inputs, wanted) = (&self.rows.inputs.select(&points), &self.selection);
            kernel(Rows { inputs, wanted, first: 0, columns: &mut columns, done: &mut done });
        }
        let efficiency = self.selection.index(REQUIRED[0]).expect("the efficiency is required");
        Group { columns, efficiency, done }
    }

    /// Copies the results of a kernel for one row into the output columns. Outputs in `retained`
    /// are not overwritten.
    fn copy(
        &mut self,
        ball: &RollingRow,
        (group, i): (&Group, usize),
        retained: &[SolutionOutput],
    ) {
        let retained = retained.iter().filter_map(|key| self.rows.wanted.index(*key));
        let retained: Vec<_> = retained.collect();
        for (index, column) in self.rows.columns.iter_mut().enumerate() {
            if !retained.contains(&index) {
                column.set(ball.row, group.columns[index].value(i));
            }
        }
    }

    /// Stores the error bounds and the selected model of a row, and marks the row as solved.
    fn choose(&mut self, ball: &RollingRow, efficiency: f64, bound: f64, basis: Basis) {
        let Some(direction) = Direction::of(ball.speed) else { return };
        let error = ErrorBound::of(direction, efficiency, bound);
        for (key, value) in [
            (SolutionOutput::efficiency_error_bound, error.efficiency),
            (SolutionOutput::loss_error_bound, error.loss.unwrap_or(f64::NAN)),
        ] {
            if let Some(index) = self.rows.wanted.index(key) {
                self.rows.columns[index].set(ball.row, value);
            }
        }
        self.rows.done[ball.row] = true;
        let choice = Choice { basis, tolerance: self.tolerance };
        self.chosen.push(RowChoice { row: ball.row, choice, bound });
    }
}

/// A row that has been solved with the raceway-control model, which assumes rolling balls.
struct RollingRow {
    row: usize,
    /// Relative speed between screw and nut, `$W$`.
    speed: f64,
    efficiency: f64,
    errors: ModelErrors,
    /// True if the rolling motion is known to be the only solution.
    is_unique: bool,
}

/// Function object that solves rows with the raceway-control model and returns the solved rows with
/// their error bounds.
struct RollingRows<'a, 'b, 'c>(&'c mut Rows<'a, 'b>);

impl WithSimd for RollingRows<'_, '_, '_> {
    type Output = Vec<RollingRow>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Rows { inputs, wanted, first, columns, done } = self.0;
        let mut solved = Vec::with_capacity(done.len());
        for row in (0..done.len()).step_by(Lane::<S>::LEN) {
            let given = LaneInputs { simd, columns: inputs, row: *first + row };
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
            let back = units.speed.below(0.0);
            let sliding = SlidingBall::of(&contacts.scaled, back.select(-friction, friction));
            let errors =
                ModelErrors::of(&sliding, back, ball.efficiency, ball.skid, ball.cotangents);
            let known = errors.onset_number.below(f64::INFINITY);
            let valid = simd.vectorize(ValidCall { given: &given, model: RacewayKernel::MODEL });
            let [mut found, mut unique] = [[false; MAX_BLOCK]; 2];
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
            let mut blocks = [[0.0; MAX_BLOCK]; 6];
            for (block, lane) in blocks.iter_mut().zip(lanes) {
                lane.store(block);
            }
            for i in 0..Lane::<S>::LEN.min(done.len() - row) {
                if found[i] {
                    let [speed, efficiency, onset_number, rolling, skidding, range] =
                        blocks.each_ref().map(|block| block[i]);
                    let errors = ModelErrors { onset_number, rolling, skidding, range };
                    let (row, is_unique) = (row + i, unique[i]);
                    solved.push(RollingRow { row, speed, efficiency, errors, is_unique });
                }
            }
        }
        solved
    }
}
