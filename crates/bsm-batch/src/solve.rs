//! Answers of a task for a chunk of rows.

use std::cell::{Cell, RefCell};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use bsm_case::{AnalysisKind, CaseError, Cell as Answer, Moving, Output, Quantity, Record, Scene};
use bsm_dyn::{Model, ModelWorkspace, Status};
use bsm_kernels::{Rows, Wanted};
use bsm_simd::Arch;
use rayon::prelude::*;

use crate::Task;
use crate::operand::operands;
use crate::rows::{APART, Answers, Chunk, Columns, Verdict};

/// Rows that one thread takes at a time: a kernel answers many in the time that it takes to hand
/// them over, the one of traction some, a model few.
const KERNEL_STRIDE: usize = 2048;
const TRACTION_STRIDE: usize = 256;
const MODEL_STRIDE: usize = 16;

/// Rows that the thread that asks solves itself: others take as long to wake up.
const FEW: usize = 256;

thread_local! {
    /// Memory of the models; chunks are many and threads are few.
    static WORK: RefCell<ModelWorkspace> = RefCell::default();

    /// NaN, for a stride of the outputs that have no place: it stays in the cache.
    static SPARE: Cell<Vec<f64>> = const { Cell::new(Vec::new()) };
}

/// Where the answers of a chunk go.
#[derive(Debug)]
pub struct Room<'a> {
    /// A place for each row.
    pub verdicts: &'a mut [Verdict],
    /// The outputs of the task, a place for each row. Of an output without a place only the values come back: most
    /// outputs are of other models.
    pub columns: Vec<Option<&'a mut [f64]>>,
}

/// What there is to say of a chunk besides.
#[derive(Debug, Default)]
pub struct Told {
    /// Why there is no result, or why auto chose its model: rows in their order.
    pub messages: Vec<(usize, String)>,
    /// Values of outputs without a place: the output, the first row, and some rows, in which the others have none.
    pub values: Vec<(usize, usize, Vec<f64>)>,
}

/// Some rows of a chunk.
struct Part<'a> {
    /// The first of them in the chunk.
    first: usize,
    verdicts: &'a mut [Verdict],
    columns: Vec<Option<&'a mut [f64]>>,
}

/// True if not all are NaN.
fn has_value(values: &[f64]) -> bool {
    // Without a branch for each value.
    let some = |part: &[f64]| part.iter().fold(false, |some, value| some | !value.is_nan());
    values.chunks(512).any(some)
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
        let outputs = self.outputs.len() + self.filled.len() + usize::from(self.watched.is_some());
        let mut answers = Answers::room(chunk.len, outputs);
        let room = Room {
            verdicts: &mut answers.verdicts,
            columns: answers.columns.iter_mut().map(|column| Some(&mut column[..])).collect(),
        };
        answers.messages =
            self.fill(arch, stop, &AtomicU64::new(0), (chunk, columns), room).messages;
        answers
    }

    /// [`solve`](Self::solve) into memory of the caller.
    ///
    /// * `stop`: what was written is of no use once it has become true. * `done`: counts the rows that are
    ///   answered, while others are being solved.
    pub fn solve_into(
        &self,
        (chunk, columns): (&Chunk, &Columns),
        room: Room<'_>,
        stop: &AtomicBool,
        done: &AtomicU64,
    ) -> Told {
        self.fill(Arch::new(), stop, done, (chunk, columns), room)
    }

    fn fill(
        &self,
        arch: Arch,
        stop: &AtomicBool,
        count: &AtomicU64,
        (chunk, columns): (&Chunk, &Columns),
        mut room: Room<'_>,
    ) -> Told {
        let Self { base, settings, .. } = self;
        let mut asked = Asked::of(self);
        // Who has no places for what fills gaps does not ask for it.
        asked.outputs.truncate(room.columns.len());
        let wanted = Wanted::of(&asked.outputs);
        let operands = if asked.solves { operands(chunk, columns, base, settings) } else { None };
        let model = operands.as_ref().map_or(settings.model, |(_, model)| (*model).into());
        let verdict = Verdict { model, status: Status::Converged, has_others: false };

        let stride = match operands {
            Some((_, Model::Traction)) => TRACTION_STRIDE,
            Some(_) => KERNEL_STRIDE,
            None => MODEL_STRIDE,
        };
        let columns_of = room.columns.iter_mut();
        let mut pieces: Vec<_> = columns_of.map(|c| Some(c.as_mut()?.chunks_mut(stride))).collect();
        let parts: Vec<_> = room
            .verdicts
            .chunks_mut(stride)
            .enumerate()
            .map(|(i, verdicts)| Part {
                first: i * stride,
                verdicts,
                columns: pieces.iter_mut().map(|piece| piece.as_mut()?.next()).collect(),
            })
            .collect();
        let solve = |Part { first, verdicts, columns: given }: Part<'_>| {
            if stop.load(Ordering::Relaxed) {
                return Told::default();
            }
            let len = verdicts.len();
            verdicts.fill(verdict);
            let without: Vec<_> = given.iter().map(Option::is_none).collect();
            // Given back when it is NaN again: after a panic it is not.
            let mut spare = SPARE.take();
            let needed = without.iter().filter(|none| **none).count() * (stride + APART);
            spare.resize(needed.max(spare.len()), f64::NAN);
            let mut places = spare.chunks_exact_mut(stride + APART);
            let place = |column: Option<_>| column.or_else(|| Some(&mut places.next()?[..len]));
            let mut outputs: Vec<&mut [f64]> = given.into_iter().filter_map(place).collect();
            for (column, without) in outputs.iter_mut().zip(&without) {
                if !without {
                    column.fill(f64::NAN);
                }
            }
            let mut done = vec![false; len];
            if let Some((operands, model)) = &operands {
                let (wanted, columns) = (&wanted, &mut outputs[..]);
                let rows = Rows { operands, wanted, first, columns, done: &mut done };
                rows.solve(arch, *model, settings);
            }
            if asked.analyses.is_empty() && !done.contains(&false) {
                // Nothing is left of any row.
                done.clear();
            }
            let mut messages = Vec::new();
            for (i, done) in done.into_iter().enumerate() {
                if done && asked.analyses.is_empty() {
                    continue;
                }
                if stop.load(Ordering::Relaxed) {
                    break;
                }
                let row = first + i;
                if !done {
                    // A kernel may have begun the row.
                    for column in &mut outputs {
                        column[i] = f64::NAN;
                    }
                }
                let put = |place: usize, value| outputs[place][i] = value;
                let scene = chunk.scene(columns, base, row);
                let (verdict, message) = self.answer_row(&asked, scene, done, put);
                verdicts[i] = verdict.unwrap_or(verdicts[i]);
                messages.extend(message.map(|message| (row, message)));
            }
            let mut values = Vec::new();
            for (place, column) in outputs.into_iter().enumerate() {
                if without[place] && has_value(column) {
                    values.push((place, first, column.to_vec()));
                    column.fill(f64::NAN);
                }
            }
            SPARE.set(spare);
            count.fetch_add(len as u64, Ordering::Relaxed);
            Told { messages, values }
        };
        let told: Vec<_> = if self.is_quick(chunk.len) {
            parts.into_iter().map(solve).collect()
        } else {
            parts.into_par_iter().map(solve).collect()
        };
        let mut all = Told::default();
        for part in told {
            all.messages.extend(part.messages);
            all.values.extend(part.values);
        }
        all
    }

    /// True if the thread that asks solves so many rows itself: few, and none with an analysis, which may
    /// take long.
    pub fn is_quick(&self, rows: usize) -> bool {
        rows <= FEW && self.outputs.iter().chain(&self.watched).all(|o| o.analysis().is_none())
    }

    /// Answers a row: its verdict unless a kernel has answered all but its analyses, and its words.
    ///
    /// * `put`: takes the value of an output, by place.
    fn answer_row(
        &self,
        asked: &Asked,
        scene: Result<Scene, CaseError>,
        by_kernel: bool,
        mut put: impl FnMut(usize, f64),
    ) -> (Option<Verdict>, Option<String>) {
        let settings = &self.settings;
        let invalid = |error: &CaseError| {
            let status = Status::InvalidInput;
            let verdict = Verdict { model: settings.model, status, has_others: false };
            (Some(verdict), Some(error.to_string()))
        };
        let scene = match scene {
            Ok(scene) => scene,
            Err(error) => return invalid(&error),
        };
        let (mut verdict, mut words, mut motion) = (None, Vec::new(), None);
        if asked.solves && (asked.moves || !by_kernel) {
            let record = match scene.problem(settings) {
                Ok(problem) => Record::new(WORK.with_borrow_mut(|work| problem.solve(work))),
                Err(error) => return invalid(&error),
            };
            if !by_kernel {
                verdict = Some(Verdict {
                    model: record.model(),
                    status: record.status(),
                    has_others: record.has_others(),
                });
                words.extend(record.message().map(str::to_owned).or_else(|| record.choice()));
                for (place, output) in asked.outputs.iter().enumerate() {
                    put(place, record.cell(output).map_or(f64::NAN, Answer::number));
                }
            }
            let solution = record.into_solution().filter(|s| asked.moves && s.solved().is_some());
            motion = solution.map(|solution| Moving { settings: *settings, solution });
        }
        for kind in asked.analyses.iter().filter(|kind| motion.is_some() || !kind.needs_motion()) {
            let wanted = |quantity: &Quantity| {
                let of_it = |column: &Output| asked.outputs.iter().any(|o| o.name == column.name);
                quantity.columns.iter().any(of_it)
            };
            match kind.numbers(&scene, settings, motion.as_ref(), wanted) {
                Ok(numbers) => {
                    let places = asked.outputs.iter().enumerate();
                    let values =
                        places.filter_map(|(place, output)| Some((place, numbers.value(output)?)));
                    values.for_each(|(place, value)| put(place, value));
                }
                Err(error) if !asked.solves => return invalid(&error),
                Err(error) => words.push(format!("{}: {error}", kind.name())),
            }
        }
        (verdict, (!words.is_empty()).then(|| words.join("; ")))
    }
}

/// What is asked of every row.
struct Asked {
    /// Outputs to write, then the one that is watched.
    outputs: Vec<&'static Output>,
    /// The analyses that they are numbers of.
    analyses: Vec<AnalysisKind>,
    /// True if the points must be solved, and not only the inputs be read.
    solves: bool,
    /// True if the motion of the ball is analysed.
    moves: bool,
}

impl Asked {
    fn of(task: &Task) -> Self {
        let outputs = task.outputs.iter().chain(&task.filled).copied().chain(task.watched);
        let outputs: Vec<_> = outputs.collect();
        let asked = |kind: &AnalysisKind| outputs.iter().any(|o| o.analysis() == Some(*kind));
        let analyses: Vec<_> = AnalysisKind::ALL.into_iter().filter(asked).collect();
        let moves = analyses.iter().any(|kind| kind.needs_motion());
        Self { analyses, solves: task.solves(), moves, outputs }
    }
}
