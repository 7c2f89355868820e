//! Selects the kernel that solves all rows of a table, and determines the source of each kernel
//! input.

use std::borrow::Cow;

use arrow_array::Array;
use bsm_case::{
    Case, INPUTS, InputKey, InputSet, ModelChoice, PLAY, Quantity, Settings, derived_input,
};
use bsm_dyn::{Model, lubrication::Lubricant, model::RacewayFriction};
use bsm_kernels::{InputColumn, InputColumns, is_plain};

use crate::{Cell, Chunk, Columns};

/// Source of the values of a kernel input. The first row of the following table in which the
/// condition is true determines the source.
///
/// | the input | source | value in a row |
/// |---|---|---|
/// | is a column | `Column`: index of the column, and value of an empty cell | cell; if it is empty, base case or default, unless other cells prevent this |
/// | is calculated from other inputs by [`derived_input`] | `OtherInputs` | calculated from the cells and the base case |
/// | is in the base case | `Constant` | the same in every row |
/// | has a default | `Constant` | the default |
/// | otherwise | `Absent` | none |
#[derive(Debug, Clone, Copy)]
enum Origin {
    Column(usize, Option<f64>),
    OtherInputs,
    Constant(f64),
    Absent,
}

/// Plan that determines how a kernel solves the rows without empty cells. The plan is created once
/// per table.
#[derive(Debug)]
pub(crate) struct ColumnPlan<'a> {
    pub(crate) model: ModelChoice,
    base: &'a Case,
    columns: &'a Columns,
    /// Inputs that have a value in every row without empty cells.
    given: InputSet,
    lubricant: Option<(Lubricant, RacewayFriction)>,
    origins: [Origin; INPUTS.len()],
}

impl<'a> ColumnPlan<'a> {
    /// Creates the plan for a table. Returns `None` if different rows need different models, or if
    /// every row has an error that must be reported.
    pub(crate) fn new(base: &'a Case, settings: &Settings, columns: &'a Columns) -> Option<Self> {
        settings.check().ok()?;
        if base.requests_warm_state() {
            return None;
        }
        let cells = columns.set();
        let in_row = |cells: InputSet| base.stated().overridden_by(cells);
        let given = in_row(cells);
        given.check_forms().ok()?;
        // The validity range of the model is not checked here, because rows outside this range are
        // also passed to the model.
        let model = settings.model.resolve(given, |_| Ok(())).ok()?;
        let is_third_contact = model == Model::Traction.into() && given.intersects(PLAY);
        if is_third_contact || given.contains(InputKey::radial_gap_um) {
            // The kernels support only balls with two contacts at the nominal contact angle.
            return None;
        }
        let lubricant = if given.is_lubricated() {
            if model != Model::RacewayControl.into() {
                return None;
            }
            Some((base.lubricant_but_for_temperature(cells)?, settings.friction))
        } else {
            None
        };
        let mut plan = Self {
            model,
            base,
            columns,
            given,
            lubricant,
            origins: [Origin::Absent; INPUTS.len()],
        };
        for (index, key) in InputKey::ALL.into_iter().enumerate() {
            let Quantity { rule, default, .. } = *key.input();
            let completed = given.completed().contains(key);
            let of_base = base.value_or_default(key);
            plan.origins[index] = if let Some(column) = plan.column(key) {
                let without =
                    in_row(cells.without(InputSet::of(&[key]))).union(InputSet::WITH_DEFAULT);
                let leaves = without == given.union(InputSet::WITH_DEFAULT);
                Origin::Column(column, of_base.filter(|_| leaves))
            } else if completed
                && !given.contains(key)
                && plan.dependent_value(key, |_| 0.0).is_some()
            {
                Origin::OtherInputs
            } else if let Some(value) = of_base.filter(|_| completed) {
                if !rule.holds(value) || !is_plain(value) {
                    return None;
                }
                Origin::Constant(value)
            } else {
                default.map_or(Origin::Absent, Origin::Constant)
            };
        }
        Some(plan)
    }

    fn column(&self, key: InputKey) -> Option<usize> {
        self.columns.inputs.iter().position(|column| *column == key)
    }

    /// Returns the value of an input that is calculated from other inputs.
    ///
    /// * `cell`: function that returns the value of the column with the given index.
    fn dependent_value(&self, key: InputKey, cell: impl Fn(usize) -> f64) -> Option<f64> {
        derived_input(key, |from| match self.column(from) {
            Some(index) => Some(cell(index)),
            None => self.base[from].filter(|_| self.given.contains(from)),
        })
    }

    /// Returns the values of all kernel inputs for a chunk.
    pub(crate) fn inputs<'c>(&self, chunk: &'c Chunk) -> InputColumns<'c> {
        let mut inputs = [const { InputColumn::Absent }; INPUTS.len()];
        for ((key, operand), origin) in
            InputKey::ALL.into_iter().zip(&mut inputs).zip(&self.origins)
        {
            let rule = key.input().rule;
            *operand = match *origin {
                Origin::Absent => InputColumn::Absent,
                Origin::Constant(value) => InputColumn::Constant(value),
                Origin::Column(index, or) => InputColumn::Column(rule, numbers(chunk, index, or)),
                Origin::OtherInputs => {
                    let cell = |row, index| match chunk.cell(row, index) {
                        Cell::Number(value) => value,
                        _ => f64::NAN,
                    };
                    let value = |row| self.dependent_value(key, |index| cell(row, index));
                    let values = (0..chunk.len).map(|row| value(row).unwrap_or(f64::NAN));
                    InputColumn::Column(rule, values.collect())
                }
            };
        }
        InputColumns::new(inputs, self.lubricant)
    }
}

/// Returns the values of a column. Missing values are replaced by `or`, or by NaN if `or` is
/// `None`.
fn numbers(chunk: &Chunk, index: usize, or: Option<f64>) -> Cow<'_, [f64]> {
    let input = &chunk.inputs[index];
    if input.null_count() == 0 {
        return Cow::Borrowed(input.values());
    }
    let or = or.unwrap_or(f64::NAN);
    let mut values: Vec<_> = input.iter().map(|x| x.unwrap_or(or)).collect();
    for (row, _) in chunk.texts.keys().filter(|(_, column)| *column == index) {
        values[*row] = f64::NAN;
    }
    values.into()
}
