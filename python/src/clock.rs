//! Measures computing times for `benches/overhead.py`, which compares them with the times of the
//! Python functions.

use std::hint::black_box;
use std::num::NonZeroUsize;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use bsm_batch::{Answers, Source, Task, Workers};
use bsm_dyn::ModelWorkspace;
use pyo3::prelude::*;

use crate::case::{Case, How};
use crate::errors::Result;
use crate::points::table_of;
use crate::table::NumberArray;

/// Returns the time that the batch solver needs to solve the rows on one thread and to keep all
/// results in memory \[s\].
#[pyfunction]
pub(crate) fn batch_seconds(
    py: Python<'_>,
    base: &Bound<'_, Case>,
    columns: Vec<(String, NumberArray)>,
    len: usize,
    how: How,
    outputs: Option<Vec<String>>,
) -> Result<f64> {
    let columns = columns.into_iter().map(|(name, values)| (name, values, Vec::new())).collect();
    let outputs = Answers::select(outputs.as_deref())?;
    let mut memory = table_of(columns, Vec::new(), len)?;
    let task = Task::over_table(base.get().0.clone(), how.0, outputs, memory.columns())?;
    let stop = AtomicBool::new(false);
    let workers = Workers::start(Some(NonZeroUsize::MIN), &stop)?;
    py.detach(|| {
        let names = memory.columns().clone();
        let Some(chunk) = memory.next(len)? else { return Ok(0.0) };
        let start = Instant::now();
        drop(black_box(workers.install(|| task.solve(&chunk, &names))));
        Ok(start.elapsed().as_secs_f64())
    })
}

/// Returns the time that a model needs to solve a case `times` times \[s\].
#[pyfunction]
pub(crate) fn solve_seconds(case: &Bound<'_, Case>, how: How, times: u64) -> Result<f64> {
    let case = &case.get().0;
    let mut work = ModelWorkspace::default();
    let start = Instant::now();
    for _ in 0..times {
        let problem = black_box(case).problem(&how.0)?;
        let _ = black_box(problem.solve(&mut work));
    }
    Ok(start.elapsed().as_secs_f64())
}
