//! Solves the rows of a chunk according to a task.

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
use crate::{Answers, Chunk, Columns, RowOutcome, Task};

/// Number of rows that a thread takes at a time if a kernel solves the rows. The number is large,
/// because handing rows to a thread takes as long as solving many rows with a kernel.
const KERNEL_STRIDE: usize = 2048;

/// Number of rows that a thread takes at a time if the model is `auto`.
const AUTO_STRIDE: usize = 256;

/// Number of rows that a thread takes at a time if the rows are solved one by one.
const MODEL_STRIDE: usize = 16;

/// Maximum number of rows that are solved on the calling thread. Waking other threads would take
/// about as long as solving this number of rows.
const MAX_SERIAL_ROWS: usize = 256;

thread_local! {
    /// Workspace of the models. Each thread uses the same workspace for all its rows.
    static WORK: RefCell<ModelWorkspace> = RefCell::default();
}

/// Buffers that the caller provides for the results of a chunk.
#[derive(Debug)]
pub struct Buffers<'a> {
    /// Status of each row.
    pub outcomes: &'a mut [RowOutcome],
    /// For each output of the task, a buffer with one value per row, or `None` if the caller
    /// provides no buffer. Without a buffer, the values of the output are returned in
    /// [`RowReport::values`]. In most cases there are no values, because the model does not
    /// calculate the output.
    pub columns: Vec<Option<&'a mut [f64]>>,
}

/// Messages about the rows of a chunk, and values of outputs for which the caller provided no
/// buffer.
#[derive(Debug, Default)]
pub struct RowReport {
    /// Row index and message, in ascending order of the row index. A message states the reason why
    /// the row has no result or why `auto` chose its model.
    pub messages: Vec<(usize, String)>,
    /// Values of outputs without a buffer in [`Buffers::columns`]. An entry contains the index of
    /// the output, the index of the first row, and the values of consecutive rows. No other row has
    /// a value for this output.
    pub values: Vec<(usize, usize, Vec<f64>)>,
}

impl<'a> Buffers<'a> {
    /// Divides the buffers into parts for `stride` rows each.
    fn parts(self, stride: usize) -> Vec<ChunkPart<'a>> {
        let columns = self.columns.into_iter();
        let mut columns: Vec<_> = columns.map(|c| Some(c?.chunks_mut(stride))).collect();
        let part = |(i, outcomes)| ChunkPart {
            first: i * stride,
            outcomes,
            columns: columns.iter_mut().map(|column| column.as_mut()?.next()).collect(),
        };
        self.outcomes.chunks_mut(stride).enumerate().map(part).collect()
    }
}

impl RowReport {
    fn and(mut self, other: Self) -> Self {
        self.messages.extend(other.messages);
        self.values.extend(other.values);
        self
    }
}

/// Consecutive rows of a chunk, and buffers for their results.
struct ChunkPart<'a> {
    /// Index, within the chunk, of the first row.
    first: usize,
    outcomes: &'a mut [RowOutcome],
    columns: Vec<Option<&'a mut [f64]>>,
}

impl Task {
    /// Solves all rows of a chunk, and returns their results in the order of the rows. The case of
    /// a row is a copy of the base case in which the cells of the row replace the values of their
    /// inputs.
    ///
    /// If a row is not a valid operating point, its status is `invalid_input`, and its message
    /// states the reason. The widest instruction set of the machine is used. The results do not
    /// depend on the instruction set, on the number of threads, or on the division of the rows into
    /// chunks.
    pub fn solve(&self, chunk: &Chunk, columns: &Columns) -> Answers {
        self.solve_on(Arch::new(), chunk, columns)
    }

    /// Solves a chunk like [`solve`](Self::solve), but with the given instruction set.
    pub fn solve_on(&self, arch: Arch, chunk: &Chunk, columns: &Columns) -> Answers {
        Solver::new(self, columns).solve(arch, &AtomicBool::new(false), chunk)
    }

    /// Solves a chunk like [`solve`](Self::solve), but writes the results into buffers that the
    /// caller provides.
    ///
    /// * `stop`: stop flag. If it becomes true, the calculation ends early, and the results must
    ///   not be used.
    /// * `done`: number of solved rows, which is updated during the calculation.
    pub fn solve_into(
        &self,
        (chunk, columns): (&Chunk, &Columns),
        buffers: Buffers<'_>,
        stop: &AtomicBool,
        done: &AtomicU64,
    ) -> RowReport {
        Solver::new(self, columns).fill(Arch::new(), stop, done, chunk, buffers)
    }

    /// Returns true if the given number of rows is small enough to be solved on the calling thread,
    /// and if no output needs an analysis, which may take a long time.
    pub fn is_quick(&self, rows: usize) -> bool {
        rows <= MAX_SERIAL_ROWS
            && self.outputs.iter().chain(&self.watched).all(|o| o.analysis().is_none())
    }
}

/// Solver for the rows of a table. It contains the task and the data that all rows share.
pub(crate) struct Solver<'a> {
    task: &'a Task,
    columns: &'a Columns,
    /// Kernel that solves the rows; `None` if the rows are solved one by one.
    plan: Option<ColumnPlan<'a>>,
    /// Outputs in three groups: outputs that are written, outputs that replace missing inputs, and
    /// the output that is displayed.
    outputs: Vec<&'static Output>,
    /// Analyses that are needed to calculate the outputs.
    analyses: Vec<AnalysisKind>,
}

impl<'a> Solver<'a> {
    pub(crate) fn new(task: &'a Task, columns: &'a Columns) -> Self {
        let mut outputs = [&task.outputs[..], &task.filled].concat();
        // A watched output that is also a column of the result must not be requested twice, because
        // a kernel writes only one column for each output.
        let only_watched = task.watched_index().is_some_and(|index| index == outputs.len());
        outputs.extend(task.watched.filter(|_| only_watched));
        let asked = |kind: &AnalysisKind| outputs.iter().any(|o| o.analysis() == Some(*kind));
        let mut analyses: Vec<_> = AnalysisKind::ALL.into_iter().filter(asked).collect();
        if analyses.contains(&AnalysisKind::Warm) && task.base.requests_warm_state() {
            // The warm-state analysis also returns some results of the warm nut. If these results
            // include all requested results of the nut, the nut analysis is omitted, so that the
            // warm state is calculated only once.
            let has = |o: &Output| AnalysisKind::Warm.columns().any(|column| column.name == o.name);
            let of_nut = |o: &&&Output| o.analysis() == Some(AnalysisKind::Nut);
            if outputs.iter().filter(of_nut).all(|o| has(o)) {
                analyses.retain(|kind| *kind != AnalysisKind::Nut);
            }
        }
        let plan = || ColumnPlan::new(&task.base, &task.settings, columns);
        // Kernels cannot estimate grooves, and cannot solve a row for several possible grooves.
        let by_kernel = task.solves()
            && !task.estimates_rows
            && outputs.iter().all(|output| output.interval().is_none());
        let plan = if by_kernel { plan() } else { None };
        Self { task, columns, plan, outputs, analyses }
    }

    /// Solves a chunk and returns its results, which are incomplete if the flag `stop` has become
    /// true. The flag is checked before each row or, if a kernel is used, before each group of
    /// rows.
    pub(crate) fn solve(&self, arch: Arch, stop: &AtomicBool, chunk: &Chunk) -> Answers {
        let mut answers = Answers::allocate(chunk.len, self.outputs.len());
        let buffers = Buffers {
            outcomes: &mut answers.outcomes,
            columns: answers.columns.iter_mut().map(|column| Some(&mut column[..])).collect(),
        };
        answers.messages = self.fill(arch, stop, &AtomicU64::new(0), chunk, buffers).messages;
        answers
    }

    fn fill(
        &self,
        arch: Arch,
        stop: &AtomicBool,
        count: &AtomicU64,
        chunk: &Chunk,
        buffers: Buffers<'_>,
    ) -> RowReport {
        // The caller may provide fewer columns than there are outputs. Outputs that replace missing
        // inputs are at the end of the list, and are not calculated in this case.
        let outputs = &self.outputs[..buffers.columns.len()];
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
            let rows = part.outcomes.len();
            let report = run.solve(part);
            count.fetch_add(rows as u64, Ordering::Relaxed);
            report
        };
        let parts = buffers.parts(stride);
        let reports: Vec<_> = if self.task.is_quick(chunk.len) {
            parts.into_iter().map(solve).collect()
        } else {
            parts.into_par_iter().map(solve).collect()
        };
        reports.into_iter().fold(RowReport::default(), RowReport::and)
    }
}

/// Data needed to solve the rows of a chunk.
struct ChunkSolve<'a> {
    solver: &'a Solver<'a>,
    chunk: &'a Chunk,
    /// Model and inputs of the kernel; `None` if the rows are solved one by one.
    kernel: Option<(InputColumns<'a>, ModelChoice)>,
    outputs: &'a [&'static Output],
    wanted: Selection,
    arch: Arch,
    stop: &'a AtomicBool,
}

impl ChunkSolve<'_> {
    /// Solves consecutive rows of the chunk.
    fn solve(&self, ChunkPart { first, outcomes, columns }: ChunkPart<'_>) -> RowReport {
        let column = |column: Option<_>| match column {
            Some(values) => {
                let values: &mut [f64] = values;
                values.fill(f64::NAN);
                OutputColumn::Given(values)
            }
            None => OutputColumn::on_demand(outcomes.len()),
        };
        let mut outputs: Vec<_> = columns.into_iter().map(column).collect();
        let messages = self.rows(first, outcomes, &mut outputs);
        let mut values = Vec::new();
        for (index, column) in outputs.into_iter().enumerate() {
            // A column may be empty even if the kernel has stored values in it, because values of
            // rows that the kernel could not solve are erased. Empty columns are not returned.
            if let OutputColumn::OnDemand { values: column, .. } = column
                && column.iter().any(|value| !value.is_nan())
            {
                values.push((index, first, column));
            }
        }
        RowReport { messages, values }
    }

    /// Solves consecutive rows, if possible with a kernel. Rows that the kernel cannot solve are
    /// solved one by one. Returns the messages of the rows.
    ///
    /// * `outputs`: output columns, which are filled with NaN at the beginning.
    fn rows(
        &self,
        first: usize,
        outcomes: &mut [RowOutcome],
        outputs: &mut [OutputColumn<'_>],
    ) -> Vec<(usize, String)> {
        let solver = self.solver;
        let settings = &solver.task.settings;
        let model = self.kernel.as_ref().map_or(settings.model, |(_, model)| *model);
        outcomes.fill(RowOutcome { model, status: Status::Converged, has_others: false });
        let (mut done, mut messages) = (vec![false; outcomes.len()], BTreeMap::new());
        if let Some((inputs, model)) = &self.kernel {
            let (wanted, columns) = (&self.wanted, &mut *outputs);
            let rows = Rows { inputs, wanted, first, columns, done: &mut done };
            for RowChoice { row, choice, bound } in rows.solve(self.arch, *model, settings) {
                outcomes[row].model = choice.basis.model().into();
                messages.insert(row, reason_of_choice(&choice, Some(bound)));
            }
        }
        let is_left = |done: &bool| !(*done && solver.analyses.is_empty());
        for (i, done) in done.iter().enumerate().filter(|(_, done)| is_left(done)) {
            if self.stop.load(Ordering::Relaxed) {
                break;
            }
            if !done {
                // The kernel may have stored some outputs of this row, although it could not solve
                // the row.
                for column in outputs.iter_mut() {
                    column.set(i, f64::NAN);
                }
            }
            let store = |index: usize, value| outputs[index].set(i, value);
            let row_messages = messages.remove(&i).into_iter().collect();
            let (outcome, message) = self.row(first + i, *done, row_messages, store);
            outcomes[i] = outcome.unwrap_or(outcomes[i]);
            messages.extend(message.map(|message| (i, message)));
        }
        messages.into_iter().map(|(row, message)| (first + row, message)).collect()
    }

    /// Solves a single row, and returns its status and its message. The status is `None` if a
    /// kernel has already solved the row, so that only the analyses are calculated here.
    ///
    /// * `messages`: messages from the kernel about the row.
    /// * `store`: function that stores the value of the output with the given index.
    fn row(
        &self,
        row: usize,
        by_kernel: bool,
        messages: Vec<String>,
        mut store: impl FnMut(usize, f64),
    ) -> (Option<RowOutcome>, Option<String>) {
        let task = self.solver.task;
        let given = self.chunk.case(self.solver.columns, &task.base, row);
        // A case occupies several kilobytes, so it is passed by reference.
        let estimated = match &given {
            Ok(case) if task.estimates_rows => Some(task.groove_of(case)),
            _ => None,
        };
        match estimated.as_ref().unwrap_or(&given) {
            Ok(case) => {
                let partial = self.intervals(case, &mut store);
                let messages = messages.into_iter().chain(partial).collect();
                self.results(case, self.outputs, by_kernel, messages, store)
            }
            Err(error) => self.invalid(error),
        }
    }

    /// Returns the status and the message of a case that cannot be solved.
    fn invalid(&self, error: &CaseError) -> (Option<RowOutcome>, Option<String>) {
        let status = match error {
            CaseError::NoWarmState(_) => Status::NoSolution,
            _ => Status::InvalidInput,
        };
        let model = self.solver.task.settings.model;
        let outcome = RowOutcome { model, status, has_others: false };
        (Some(outcome), Some(error.to_string()))
    }

    /// Calculates the 90 % intervals of the outputs over the possible grooves of a case, and stores
    /// their limits. Without an estimated groove, there are no intervals. Returns a message for
    /// each output that has a value for only some of the possible grooves.
    fn intervals(&self, case: &Case, store: &mut impl FnMut(usize, f64)) -> Vec<String> {
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
                let message = format!(
                    "only {} of {count} possible grooves have a value of {name}",
                    values.len()
                );
                if !partial.contains(&message) {
                    partial.push(message);
                }
            }
            if let Some(Band { low, high }) = Band::of(values) {
                store(index, if is_high { high } else { low });
            }
        }
        partial
    }

    /// Calculates the given outputs of a case. Returns the status and the message, as
    /// [`row`](Self::row) does.
    fn results(
        &self,
        case: &Case,
        outputs: &[&'static Output],
        by_kernel: bool,
        mut messages: Vec<String>,
        mut store: impl FnMut(usize, f64),
    ) -> (Option<RowOutcome>, Option<String>) {
        let settings = &self.solver.task.settings;
        let (mut outcome, mut motion) = (None, None);
        let solves = self.solver.task.solves();
        let moves = self.solver.analyses.iter().any(|kind| kind.needs_solution());
        if solves && (moves || !by_kernel) {
            let record = match case.problem(settings) {
                Ok(problem) => Record::new(WORK.with_borrow_mut(|work| problem.solve(work))),
                Err(error) => return self.invalid(&error),
            };
            if !by_kernel {
                outcome = Some(RowOutcome {
                    model: record.model(),
                    status: record.status(),
                    has_others: record.has_others(),
                });
                messages.extend(record.message().map(str::to_owned).or_else(|| record.choice()));
                for (index, output) in outputs.iter().enumerate() {
                    // The interval limits have already been stored by `intervals`.
                    if output.interval().is_none() {
                        store(index, record.value(output).unwrap_or(f64::NAN));
                    }
                }
            }
            let solution = record.into_solution().filter(|s| moves && s.steady_state().is_some());
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
                    values.for_each(|(index, value)| store(index, value));
                    messages.extend(numbers.reason().map(|why| format!("{}: {why}", kind.name())));
                }
                Err(error) if !solves => return self.invalid(&error),
                Err(error) => messages.push(format!("{}: {error}", kind.name())),
            }
        }
        (outcome, (!messages.is_empty()).then(|| messages.join("; ")))
    }
}
