//! Answers for a chunk of rows.

use bsm_case::{CaseError, Record, Scene, Settings};
use bsm_dyn::ModelWorkspace;
use rayon::prelude::*;

use crate::rows::{Cell, Chunk, Columns};

/// Rows that one thread takes at a time.
const STRIDE: usize = 64;

/// One answer for each row, in order: `base` with the values of the row.
///
/// A row that cannot be asked keeps its place with the status `invalid_input` and says why.
pub fn solve(chunk: &Chunk, columns: &Columns, base: &Scene, settings: &Settings) -> Vec<Record> {
    (0..chunk.len)
        .into_par_iter()
        .with_min_len(STRIDE)
        .map_init(ModelWorkspace::default, |work, row| {
            let problem =
                scene(chunk, columns, base, row).and_then(|scene| scene.problem(settings));
            match problem {
                Ok(problem) => Record::new(problem.solve(work)),
                Err(error) => Record::invalid(settings.model, &error),
            }
        })
        .collect()
}

/// The scene of a row.
fn scene(chunk: &Chunk, columns: &Columns, base: &Scene, row: usize) -> Result<Scene, CaseError> {
    let mut scene = base.clone();
    for (name, cells) in columns.inputs.iter().zip(&chunk.inputs) {
        match &cells[row] {
            Cell::Missing => {}
            Cell::Number(value) => scene.set(name, *value)?,
            Cell::Text(text) => return Err(CaseError::not_a_number(name, text)),
        }
    }
    Ok(scene)
}
