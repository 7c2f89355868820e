//! Answers of a task for a chunk of rows.

use std::cell::RefCell;
use std::sync::atomic::{AtomicBool, Ordering};

use bsm_case::{Cell as Answer, Record};
use bsm_dyn::ModelWorkspace;
use bsm_simd::Arch;
use rayon::prelude::*;

use crate::Task;
use crate::kernel::{Rows, Wanted};
use crate::operand::Operands;
use crate::rows::{Answers, Chunk, Columns, Verdict};

/// Rows that one thread takes at a time: a kernel answers many in the time that it takes to hand
/// them over, a model few.
const KERNEL_STRIDE: usize = 2048;
const MODEL_STRIDE: usize = 16;

thread_local! {
    /// Memory of the models; chunks are many and threads are few.
    static WORK: RefCell<ModelWorkspace> = RefCell::default();
}

/// Some rows of a chunk.
struct Part<'a> {
    /// The first of them in the chunk.
    first: usize,
    verdicts: &'a mut [Verdict],
    columns: Vec<&'a mut [f64]>,
}

impl Task {
    /// One answer for each row of a chunk, in order: `base` with the values of the row.
    ///
    /// A row that cannot be asked keeps its place with the status `invalid_input` and says why.
    /// Results do not depend on chunk, thread or instruction set, which is the widest of the machine.
    pub fn solve(&self, chunk: &Chunk, columns: &Columns) -> Answers {
        self.solve_on(Arch::new(), chunk, columns)
    }

    /// [`solve`](Self::solve) on an instruction set of one's choice.
    pub fn solve_on(&self, arch: Arch, chunk: &Chunk, columns: &Columns) -> Answers {
        self.answer(arch, &AtomicBool::new(false), chunk, columns)
    }

    /// [`solve`](Self::solve) unless `stop` becomes true before the end: that is looked at before every
    /// row of a model, and before every stride of a kernel.
    pub(crate) fn solve_until(
        &self,
        stop: &AtomicBool,
        chunk: &Chunk,
        columns: &Columns,
    ) -> Option<Answers> {
        let answers = self.answer(Arch::new(), stop, chunk, columns);
        (!stop.load(Ordering::Relaxed)).then_some(answers)
    }

    /// The answers, complete unless `stop` has become true.
    fn answer(&self, arch: Arch, stop: &AtomicBool, chunk: &Chunk, columns: &Columns) -> Answers {
        let Self { base, settings, outputs, watched } = self;
        let outputs: Vec<_> = outputs.iter().copied().chain(*watched).collect();
        let wanted = Wanted::of(&outputs);
        let operands = Operands::of(chunk, columns, base, settings);
        let model = operands.as_ref().map_or(settings.model, |(_, model)| (*model).into());
        let mut answers = Answers::empty(chunk.len, outputs.len(), model);

        let stride = if operands.is_some() { KERNEL_STRIDE } else { MODEL_STRIDE };
        let mut pieces: Vec<_> = answers.columns.iter_mut().map(|c| c.chunks_mut(stride)).collect();
        let parts: Vec<_> = answers
            .verdicts
            .chunks_mut(stride)
            .enumerate()
            .map(|(i, verdicts)| Part {
                first: i * stride,
                verdicts,
                columns: pieces.iter_mut().filter_map(Iterator::next).collect(),
            })
            .collect();
        let messages: Vec<Vec<_>> = parts
            .into_par_iter()
            .map(|mut part| {
                let mut done = vec![false; part.verdicts.len()];
                if stop.load(Ordering::Relaxed) {
                    return Vec::new();
                }
                if let Some((operands, model)) = &operands {
                    let (wanted, columns) = (&wanted, &mut part.columns[..]);
                    let rows =
                        Rows { operands, wanted, first: part.first, columns, done: &mut done };
                    rows.solve(arch, *model, settings);
                }
                let mut messages = Vec::new();
                for (i, _) in done.iter().enumerate().filter(|(_, done)| !**done) {
                    if stop.load(Ordering::Relaxed) {
                        break;
                    }
                    let row = part.first + i;
                    let problem = chunk.scene(columns, base, row).and_then(|s| s.problem(settings));
                    let record = match problem {
                        Ok(problem) => {
                            Record::new(WORK.with_borrow_mut(|work| problem.solve(work)))
                        }
                        Err(error) => Record::invalid(settings.model, &error),
                    };
                    part.verdicts[i] = Verdict {
                        model: record.model(),
                        status: record.status(),
                        has_others: record.has_others(),
                    };
                    let message = record.message().map(str::to_owned).or_else(|| record.choice());
                    messages.extend(message.map(|message| (row, message)));
                    for (output, column) in outputs.iter().zip(&mut part.columns) {
                        column[i] = record.cell(output).map_or(f64::NAN, Answer::number);
                    }
                }
                messages
            })
            .collect();
        answers.messages = messages.into_iter().flatten().collect();
        answers
    }
}
