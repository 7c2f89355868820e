//! Solves the rows of a chunk for a task.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use bsm_case::{
    AnalysisKind, Band, Case, CaseError, FEW_DRAWS, ModelChoice, MotionAnswer, Output, Quantity,
    Record, reason_of_choice,
};
use bsm_dyn::{Model, ModelWorkspace, Status};
use bsm_kernels::{InputColumns, OutputColumn, RowChoice, Rows, Selection};
use bsm_simd::Arch;
use rayon::prelude::*;

use crate::column_plan::ColumnPlan;
use crate::{Answers, Chunk, Columns, Task, Verdict};

/// Number of rows that a thread solves at a time if a kernel solves them. Handing rows to a thread
/// takes as long as solving many rows with a kernel.
const KERNEL_STRIDE: usize = 2048;

/// Number of rows that a thread solves at a time with `auto`.
const AUTO_STRIDE: usize = 256;

/// Number of rows that a thread solves at a time if each row is solved individually.
const MODEL_STRIDE: usize = 16;

/// Maximum number of rows that are solved on the calling thread, because waking other threads would
/// take as long as solving these rows.
const MAX_SERIAL_ROWS: usize = 256;

thread_local! {
    /// Work memory of the models, which each thread reuses for all its rows.
    static WORK: RefCell<ModelWorkspace> = RefCell::default();
}

/// Memory provided by the caller for the results of a chunk.
#[derive(Debug)]
pub struct Buffers<'a> {
    /// Status entries, one for each row.
    pub verdicts: &'a mut [Verdict],
    /// Output columns of the task, with one entry for each row, or `None` to return only existing
    /// values in [`RowReport::values`]. Most outputs have no value, because they belong to other
    /// models.
    pub columns: Vec<Option<&'a mut [f64]>>,
}

/// Messages of a chunk, and values of outputs for which the caller provided no memory.
#[derive(Debug, Default)]
pub struct RowReport {
    /// Row indices in ascending order, each with the reason why the row has no result or why `auto`
    /// chose its model.
    pub messages: Vec<(usize, String)>,
    /// Values of outputs without a column in [`Buffers::columns`]: index of the output, index of
    /// the first row, and values of consecutive rows. All other rows have no value.
    pub values: Vec<(usize, usize, Vec<f64>)>,
}

impl<'a> Buffers<'a> {
    /// Divides the memory into parts with `stride` rows each.
    fn parts(self, stride: usize) -> Vec<ChunkPart<'a>> {
        let columns = self.columns.into_iter();
        let mut columns: Vec<_> = columns.map(|c| Some(c?.chunks_mut(stride))).collect();
        let part = |(i, verdicts)| ChunkPart {
            first: i * stride,
            verdicts,
            columns: columns.iter_mut().map(|column| column.as_mut()?.next()).collect(),
        };
        self.verdicts.chunks_mut(stride).enumerate().map(part).collect()
    }
}

impl RowReport {
    fn and(mut self, other: Self) -> Self {
        self.messages.extend(other.messages);
        self.values.extend(other.values);
        self
    }
}

/// Consecutive rows of a chunk, with memory for their results.
struct ChunkPart<'a> {
    /// Index of the first row in the chunk.
    first: usize,
    verdicts: &'a mut [Verdict],
    columns: Vec<Option<&'a mut [f64]>>,
}

impl Task {
    /// Solves each row of a chunk and returns the results in the order of the rows. The case of a
    /// row is the base case with the values of the row.
    ///
    /// A row that is not a valid point has the status `invalid_input`, and its message states the
    /// reason. Results do not depend on how rows are divided into chunks, on the number of threads
    /// or on the instruction set. The widest instruction set of the machine is used.
    pub fn solve(&self, chunk: &Chunk, columns: &Columns) -> Answers {
        self.solve_on(Arch::new(), chunk, columns)
    }

    /// Same as [`solve`](Self::solve), but with the given instruction set.
    pub fn solve_on(&self, arch: Arch, chunk: &Chunk, columns: &Columns) -> Answers {
        Solver::new(self, columns).solve(arch, &AtomicBool::new(false), chunk)
    }

    /// Same as [`solve`](Self::solve), but writes the results into memory that the caller provides.
    ///
    /// * `stop`: stops the work when it becomes true; the results are then meaningless.
    /// * `done`: counter of solved rows, which is updated while the chunk is being solved.
    pub fn solve_into(
        &self,
        (chunk, columns): (&Chunk, &Columns),
        room: Buffers<'_>,
        stop: &AtomicBool,
        done: &AtomicU64,
    ) -> RowReport {
        Solver::new(self, columns).fill(Arch::new(), stop, done, chunk, room)
    }

    /// Returns true if the given number of rows is solved on the calling thread. This is the case
    /// for a small number of rows and a task without analyses, which may take long.
    pub fn is_quick(&self, rows: usize) -> bool {
        rows <= MAX_SERIAL_ROWS
            && self.outputs.iter().chain(&self.watched).all(|o| o.analysis().is_none())
    }
}

/// Solves the rows of one table: the task together with the settings that apply to every row.
pub(crate) struct Solver<'a> {
    task: &'a Task,
    columns: &'a Columns,
    /// Kernel that solves the rows; `None` if each row is solved individually.
    plan: Option<ColumnPlan<'a>>,
    /// Outputs to write, then outputs that fill in missing inputs, then the watched output.
    outputs: Vec<&'static Output>,
    /// Analyses that calculate these outputs.
    analyses: Vec<AnalysisKind>,
}

impl<'a> Solver<'a> {
    pub(crate) fn new(task: &'a Task, columns: &'a Columns) -> Self {
        let outputs = task.outputs.iter().chain(&task.filled).copied().chain(task.watched);
        let outputs: Vec<_> = outputs.collect();
        let asked = |kind: &AnalysisKind| outputs.iter().any(|o| o.analysis() == Some(*kind));
        let mut analyses: Vec<_> = AnalysisKind::ALL.into_iter().filter(asked).collect();
        if analyses.contains(&AnalysisKind::Warm) && task.base.asks_warm() {
            // The warm analysis also returns the results of the warm nut. If it covers all
            // requested nut results, the nut analysis is omitted so that the warm state is
            // calculated only once.
            let has = |o: &Output| AnalysisKind::Warm.columns().any(|column| column.name == o.name);
            let of_nut = |o: &&&Output| o.analysis() == Some(AnalysisKind::Nut);
            if outputs.iter().filter(of_nut).all(|o| has(o)) {
                analyses.retain(|kind| *kind != AnalysisKind::Nut);
            }
        }
        let plan = || ColumnPlan::new(&task.base, &task.settings, columns);
        // Kernels cannot estimate grooves and cannot solve a point for several possible grooves.
        let by_kernel = task.solves()
            && !task.estimates_rows
            && outputs.iter().all(|output| output.interval().is_none());
        let plan = if by_kernel { plan() } else { None };
        Self { task, columns, plan, outputs, analyses }
    }

    /// Returns the results, which are incomplete if `stop` has become true. `stop` is checked
    /// before every row that is solved individually and before every group of rows that a kernel
    /// solves.
    pub(crate) fn solve(&self, arch: Arch, stop: &AtomicBool, chunk: &Chunk) -> Answers {
        let mut answers = Answers::room(chunk.len, self.outputs.len());
        let room = Buffers {
            verdicts: &mut answers.verdicts,
            columns: answers.columns.iter_mut().map(|column| Some(&mut column[..])).collect(),
        };
        answers.messages = self.fill(arch, stop, &AtomicU64::new(0), chunk, room).messages;
        answers
    }

    fn fill(
        &self,
        arch: Arch,
        stop: &AtomicBool,
        count: &AtomicU64,
        chunk: &Chunk,
        room: Buffers<'_>,
    ) -> RowReport {
        // The caller may provide fewer columns than there are outputs. Outputs that fill in missing
        // inputs are last in the list and are then not calculated.
        let outputs = &self.outputs[..room.columns.len()];
        let stride = match self.plan.as_ref().map(|plan| plan.model) {
            Some(ModelChoice::Auto) => AUTO_STRIDE,
            None | Some(ModelChoice::Fixed(Model::Traction)) => MODEL_STRIDE,
            Some(_) => KERNEL_STRIDE,
        };
        let model = self.plan.as_ref().map(|plan| (plan.inputs(chunk), plan.model));
        let wanted = Selection::of(outputs);
        let run = ChunkSolve { solver: self, chunk, kernel: model, outputs, wanted, arch, stop };
        let solve = |part: ChunkPart<'_>| {
            if stop.load(Ordering::Relaxed) {
                return RowReport::default();
            }
            let rows = part.verdicts.len();
            let report = run.solve(part);
            count.fetch_add(rows as u64, Ordering::Relaxed);
            report
        };
        let parts = room.parts(stride);
        let reports: Vec<_> = if self.task.is_quick(chunk.len) {
            parts.into_iter().map(solve).collect()
        } else {
            parts.into_par_iter().map(solve).collect()
        };
        reports.into_iter().fold(RowReport::default(), RowReport::and)
    }
}

/// A chunk that is being solved.
struct ChunkSolve<'a> {
    solver: &'a Solver<'a>,
    chunk: &'a Chunk,
    /// Kernel inputs and model; `None` if each row is solved individually.
    kernel: Option<(InputColumns<'a>, ModelChoice)>,
    outputs: &'a [&'static Output],
    wanted: Selection,
    arch: Arch,
    stop: &'a AtomicBool,
}

impl ChunkSolve<'_> {
    /// Solves some rows of the chunk.
    fn solve(&self, ChunkPart { first, verdicts, columns }: ChunkPart<'_>) -> RowReport {
        let column = |column: Option<_>| match column {
            Some(values) => {
                let values: &mut [f64] = values;
                values.fill(f64::NAN);
                OutputColumn::Given(values)
            }
            None => OutputColumn::on_demand(verdicts.len()),
        };
        let mut outputs: Vec<_> = columns.into_iter().map(column).collect();
        let messages = self.rows(first, verdicts, &mut outputs);
        let mut values = Vec::new();
        for (index, column) in outputs.into_iter().enumerate() {
            // Columns without any value are left out: a kernel may have stored values only for rows
            // that it did not solve completely.
            if let OutputColumn::OnDemand { values: column, .. } = column
                && column.iter().any(|value| !value.is_nan())
            {
                values.push((index, first, column));
            }
        }
        RowReport { messages, values }
    }

    /// Solves rows, first with a kernel if possible, then the remaining rows individually. Returns
    /// the messages of the rows.
    ///
    /// * `outputs`: output columns, filled with NaN.
    fn rows(
        &self,
        first: usize,
        verdicts: &mut [Verdict],
        outputs: &mut [OutputColumn<'_>],
    ) -> Vec<(usize, String)> {
        let solver = self.solver;
        let settings = &solver.task.settings;
        let model = self.kernel.as_ref().map_or(settings.model, |(_, model)| *model);
        verdicts.fill(Verdict { model, status: Status::Converged, has_others: false });
        let (mut done, mut messages) = (vec![false; verdicts.len()], BTreeMap::new());
        if let Some((inputs, model)) = &self.kernel {
            let (wanted, columns) = (&self.wanted, &mut *outputs);
            let rows = Rows { inputs, wanted, first, columns, done: &mut done };
            for RowChoice { row, choice, bound } in rows.solve(self.arch, *model, settings) {
                verdicts[row].model = choice.basis.model().into();
                messages.insert(row, reason_of_choice(&choice, Some(bound)));
            }
        }
        let is_left = |done: &bool| !(*done && solver.analyses.is_empty());
        for (i, done) in done.iter().enumerate().filter(|(_, done)| is_left(done)) {
            if self.stop.load(Ordering::Relaxed) {
                break;
            }
            if !done {
                // The kernel may have written some outputs of this row before it gave up.
                for column in outputs.iter_mut() {
                    column.set(i, f64::NAN);
                }
            }
            let put = |index: usize, value| outputs[index].set(i, value);
            let words = messages.remove(&i).into_iter().collect();
            let (verdict, message) = self.row(first + i, *done, words, put);
            verdicts[i] = verdict.unwrap_or(verdicts[i]);
            messages.extend(message.map(|message| (i, message)));
        }
        messages.into_iter().map(|(row, message)| (first + row, message)).collect()
    }

    /// Solves a single row. Returns its message and its status. The status is `None` if a kernel
    /// has already solved the row and only its analyses were calculated here.
    ///
    /// * `words`: message that the kernel has returned for the row.
    /// * `put`: stores the value of the output with the given index.
    fn row(
        &self,
        row: usize,
        by_kernel: bool,
        words: Vec<String>,
        mut put: impl FnMut(usize, f64),
    ) -> (Option<Verdict>, Option<String>) {
        let task = self.solver.task;
        let given = self.chunk.case(self.solver.columns, &task.base, row);
        // A case takes several kilobytes, so references are used instead of moving it.
        let estimated = match &given {
            Ok(case) if task.estimates_rows => Some(task.groove_of(case)),
            _ => None,
        };
        match estimated.as_ref().unwrap_or(&given) {
            Ok(case) => {
                let partial = self.intervals(case, &mut put);
                let words = words.into_iter().chain(partial).collect();
                self.results(case, self.outputs, by_kernel, words, put)
            }
            Err(error) => self.invalid(error),
        }
    }

    /// Returns the status and message for a case that cannot be solved.
    fn invalid(&self, error: &CaseError) -> (Option<Verdict>, Option<String>) {
        let status = match error {
            CaseError::NoWarmState(_) => Status::NoSolution,
            _ => Status::InvalidInput,
        };
        let model = self.solver.task.settings.model;
        let verdict = Verdict { model, status, has_others: false };
        (Some(verdict), Some(error.to_string()))
    }

    /// Calculates the ends of intervals over the possible grooves of a case. A case without an
    /// estimated groove has no intervals. Returns a message on each output that only some of the
    /// possible grooves have.
    fn intervals(&self, case: &Case, put: &mut impl FnMut(usize, f64)) -> Vec<String> {
        let ends = || self.outputs.iter().map(|output| output.interval()).enumerate();
        let ends = ends().filter_map(|(index, end)| Some((index, end?)));
        let ends: Vec<_> = ends.collect();
        if ends.is_empty() {
            return Vec::new();
        }
        let of: Vec<_> = ends.iter().map(|(_, (of, _))| *of).collect();
        let mut values = vec![Vec::new(); of.len()];
        let possible_cases = case.possible_cases(FEW_DRAWS);
        let count = possible_cases.len();
        for possible in possible_cases {
            self.results(&possible, &of, false, Vec::new(), |place, value: f64| {
                values[place].extend(Some(value).filter(|value| value.is_finite()));
            });
        }
        let mut partial: Vec<String> = Vec::new();
        for ((index, (of, is_high)), values) in ends.into_iter().zip(values) {
            if values.len() < count {
                let name = of.name;
                let message =
                    format!("{} of {count} possible grooves have a value of {name}", values.len());
                if !partial.contains(&message) {
                    partial.push(message);
                }
            }
            if let Some(Band { low, high }) = Band::of(values) {
                put(index, if is_high { high } else { low });
            }
        }
        partial
    }

    /// Calculates the given outputs of a case. Returns status and message as [`row`](Self::row)
    /// does.
    fn results(
        &self,
        case: &Case,
        outputs: &[&'static Output],
        by_kernel: bool,
        mut words: Vec<String>,
        mut put: impl FnMut(usize, f64),
    ) -> (Option<Verdict>, Option<String>) {
        let settings = &self.solver.task.settings;
        let (mut verdict, mut motion) = (None, None);
        let solves = self.solver.task.solves();
        let moves = self.solver.analyses.iter().any(|kind| kind.needs_solution());
        if solves && (moves || !by_kernel) {
            let record = match case.problem(settings) {
                Ok(problem) => Record::new(WORK.with_borrow_mut(|work| problem.solve(work))),
                Err(error) => return self.invalid(&error),
            };
            if !by_kernel {
                verdict = Some(Verdict {
                    model: record.model(),
                    status: record.status(),
                    has_others: record.has_others(),
                });
                words.extend(record.message().map(str::to_owned).or_else(|| record.choice()));
                for (index, output) in outputs.iter().enumerate() {
                    // The bounds of intervals have already been stored.
                    if output.interval().is_none() {
                        put(index, record.value(output).unwrap_or(f64::NAN));
                    }
                }
            }
            let solution = record.into_solution().filter(|s| moves && s.solved().is_some());
            motion = solution.map(|solution| MotionAnswer { settings: *settings, solution });
        }
        for kind in
            self.solver.analyses.iter().filter(|kind| motion.is_some() || !kind.needs_solution())
        {
            let wanted = |quantity: &Quantity| {
                let of_it = |column: &Output| outputs.iter().any(|o| o.name == column.name);
                quantity.columns.iter().any(of_it)
            };
            let numbers = WORK.with_borrow_mut(|work| {
                kind.numbers(case, settings, motion.as_ref(), wanted, work)
            });
            match numbers {
                Ok(numbers) => {
                    let indices = outputs.iter().enumerate();
                    let values =
                        indices.filter_map(|(index, output)| Some((index, numbers.value(output)?)));
                    values.for_each(|(index, value)| put(index, value));
                    words.extend(numbers.why().map(|why| format!("{}: {why}", kind.name())));
                }
                Err(error) if !solves => return self.invalid(&error),
                Err(error) => words.push(format!("{}: {error}", kind.name())),
            }
        }
        (verdict, (!words.is_empty()).then(|| words.join("; ")))
    }
}
