//! Columns of a chunk and values of the base scene as the inputs of a kernel.

use std::borrow::Cow;

use bsm_case::{INPUTS, Input, InputKey, InputSet, ModelChoice, Scene, Settings, following};
use bsm_dyn::{Model, RacewayFriction};
use bsm_kernels::{Operand, Operands, is_plain};

use crate::rows::{Chunk, Columns};

/// The inputs, and the model that answers ordinary rows, which have a value in every column;
/// `None` if the model depends on the row, or if something is wrong that every
/// row must tell.
pub(crate) fn operands<'a>(
    chunk: &'a Chunk,
    columns: &Columns,
    base: &Scene,
    settings: &Settings,
) -> Option<(Operands<'a>, Model)> {
    settings.check().ok()?;
    let in_row = |cells: InputSet| base.stated().overridden_by(cells);
    let cells = columns.set();
    let ordinary = in_row(cells);
    ordinary.check_forms().ok()?;
    // Rows that a model does not cover are not ordinary either.
    let choice = settings.model.resolve(ordinary, |_| Ok(())).ok()?;
    let ModelChoice::Fixed(model) = choice else { return None };
    let lubricant = if ordinary.is_lubricated() {
        if model != Model::RacewayControl || settings.friction != RacewayFriction::PerContact {
            return None;
        }
        Some(base.lubricant_but_for_temperature(cells)?)
    } else {
        None
    };
    let mut operands = [const { Operand::Absent }; INPUTS.len()];
    for (key, operand) in InputKey::ALL.into_iter().zip(&mut operands) {
        let Input { rule, default, .. } = *key.input();
        if let Some(place) = columns.inputs.iter().position(|column| *column == key) {
            // A row without this cell is ordinary if its other cells leave the value to the base.
            let has_same =
                |set: InputSet| set | InputSet::WITH_DEFAULT == ordinary | InputSet::WITH_DEFAULT;
            let filled = has_same(in_row(cells - InputSet::of(&[key])));
            let value = base.value_or_default(key).filter(|_| filled);
            *operand = Operand::Column(rule, chunk.inputs[place].filled(value));
        } else if let Some(value) = follows(key, chunk, columns, base, ordinary) {
            *operand = Operand::Column(rule, Cow::Owned(value));
        } else if let Some(value) =
            base.value_or_default(key).filter(|_| ordinary.completed().contains(key))
        {
            if !rule.holds(value) || !is_plain(value) {
                return None;
            }
            *operand = Operand::Constant(value);
        } else if let Some(value) = default {
            *operand = Operand::Constant(value);
        }
    }
    Some((Operands::new(operands, lubricant), model))
}

/// The values of an input that follows from columns where it is not given.
fn follows(
    key: InputKey,
    chunk: &Chunk,
    columns: &Columns,
    base: &Scene,
    ordinary: InputSet,
) -> Option<Vec<f64>> {
    if ordinary.contains(key) || !ordinary.completed().contains(key) {
        return None;
    }
    let place = |key| columns.inputs.iter().position(|column| *column == key);
    let value = |row: usize| {
        following(key, |from| match place(from) {
            Some(place) => Some(chunk.inputs[place].values()[row]),
            None => base[from].filter(|_| ordinary.contains(from)),
        })
    };
    (0..chunk.len).map(value).collect()
}
