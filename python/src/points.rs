//! Solves many points and keeps the results in memory.

use std::cell::OnceCell;
use std::io;
use std::num::NonZeroUsize;
use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use arrow_array::{Array, ArrayRef, Float64Array};
use arrow_buffer::{Buffer, NullBuffer, ScalarBuffer};
use bsm_batch::{
    AnswerSink, Answers, Buffers, Chunk, Columns, Distribution, Format, GridSource, ROWS_PER_CHUNK,
    RandomInput, RandomPoints, RowOutcome, RowReport, Source, TableError, TableFormat, TableSink,
    Task, Workers,
};
use bsm_case::{AxisValues, CaseError, Grid, GridAxis, ModelChoice, OUTPUTS, Output};
use bsm_dyn::Status;
use pyo3::prelude::*;
use pyo3_arrow::buffer::PyArrowBuffer;
use tempfile::NamedTempFile;

use crate::case::{Case, How};
use crate::errors::{Error, Result};
use crate::table::{KeptColumn, NumberArray, shared};

/// Interval at which the calling thread checks for signals and updates the progress.
const LOOK: Duration = Duration::from_millis(50);

/// A row source that reads the rows of a table in memory.
#[derive(Clone)]
pub(crate) struct Memory {
    columns: Columns,
    names: Vec<String>,
    inputs: Vec<Float64Array>,
    kept: Vec<ArrayRef>,
    len: usize,
    at: usize,
}

impl Source for Memory {
    fn columns(&self) -> &Columns {
        &self.columns
    }

    fn len_hint(&self) -> Option<u64> {
        Some(self.len as u64)
    }

    fn next(&mut self, rows: usize) -> Result<Option<Chunk>, TableError> {
        let len = rows.min(self.len - self.at);
        if len == 0 {
            return Ok(None);
        }
        let first = self.at;
        self.at += len;
        Ok(Some(Chunk {
            first: first as u64 + 1,
            len,
            inputs: self.inputs.iter().map(|column| column.slice(first, len)).collect(),
            kept: self.kept.iter().map(|column| column.slice(first, len)).collect(),
            ..Chunk::default()
        }))
    }
}

/// Origin of the input rows, from which the rows can be read more than once.
#[derive(Clone)]
enum Origin {
    Grid(Grid),
    Memory(Box<Memory>),
}

impl Origin {
    fn source(&self) -> Box<dyn Source> {
        match self {
            Self::Grid(grid) => Box::new(GridSource::new(grid.clone())),
            Self::Memory(memory) => memory.clone(),
        }
    }
}

/// Input rows together with their results.
#[pyclass(frozen, module = "ballscrew._core")]
pub(crate) struct Rows {
    origin: Origin,
    outputs: Vec<&'static Output>,
    outcomes: Vec<RowOutcome>,
    messages: Vec<(usize, String)>,
    columns: Vec<ScalarBuffer<f64>>,
}

/// A column of texts: for each row, the index of its text, and the list of all texts.
type Words = (PyArrowBuffer, Vec<&'static str>);

#[pymethods]
impl Rows {
    fn __len__(&self) -> usize {
        self.outcomes.len()
    }

    /// Returns the names of the input columns, spelled as in the table.
    fn inputs(&self) -> Vec<String> {
        match &self.origin {
            Origin::Grid(_) => Vec::new(),
            Origin::Memory(memory) => memory.names.clone(),
        }
    }

    /// Returns the index of the model for each row, together with the list of model names.
    fn models(&self) -> Words {
        let names: Vec<_> = ModelChoice::names().collect();
        let place = |outcome: &RowOutcome| match outcome.model {
            ModelChoice::Auto => 0,
            ModelChoice::Fixed(model) => 1 + model as u8,
        };
        (codes(self.outcomes.iter().map(place).collect()), names)
    }

    /// Returns the index of the status for each row, together with the list of status names.
    fn statuses(&self) -> Words {
        let names = Status::ALL.map(Status::name).to_vec();
        (codes(self.outcomes.iter().map(|outcome| outcome.status as u8).collect()), names)
    }

    /// Returns the messages of rows: why a row has no result, or why `auto` chose the model of the
    /// row.
    fn messages(&self) -> Vec<(usize, &str)> {
        self.messages.iter().map(|(row, text)| (*row, text.as_str())).collect()
    }

    /// Returns the names and values of the output columns.
    fn outputs(&self) -> Vec<(&'static str, PyArrowBuffer)> {
        let buffer = |values: &ScalarBuffer<f64>| PyArrowBuffer::new(values.inner().clone());
        self.outputs.iter().zip(&self.columns).map(|(o, values)| (o.name, buffer(values))).collect()
    }

    /// Writes the table in the same form as the program does. The file extension determines the
    /// format.
    fn write(&self, py: Python<'_>, path: PathBuf) -> Result<()> {
        let format = format_of(&path)?;
        Ok(py.detach(|| self.write_to(&path, format))?)
    }
}

impl Rows {
    fn write_to(&self, path: &Path, format: Format) -> Result<(), TableError> {
        let file = beside(path)?;
        let mut source = self.origin.source();
        let (columns, table_format) = (source.columns(), TableFormat::default());
        let mut sink = TableSink::new(format, file, columns, &self.outputs, &table_format)?;
        let mut messages = self.messages.iter().peekable();
        let mut first = 0;
        while let Some(chunk) = source.next(ROWS_PER_CHUNK)? {
            let rows = first..first + chunk.len;
            let mut of_chunk = Vec::new();
            while let Some((row, text)) = messages.next_if(|(row, _)| rows.contains(row)) {
                of_chunk.push((row - first, text.clone()));
            }
            let answers = Answers {
                outcomes: self.outcomes[rows.clone()].to_vec(),
                messages: of_chunk,
                columns: self.columns.iter().map(|column| column[rows.clone()].to_vec()).collect(),
            };
            sink.write(chunk, answers)?;
            first = rows.end;
        }
        let file = sink.finish(None)?;
        file.persist(path).map_err(|e| TableError::Io(e.error))?;
        Ok(())
    }
}

/// Returns the table format that corresponds to the file extension.
pub(crate) fn format_of(path: &Path) -> Result<Format> {
    let words = || format!("{}: the name must end with .csv, .jsonl or .parquet", path.display());
    Format::of(path).ok_or_else(|| words().into())
}

/// Creates a temporary file in the folder of `path`. The complete file later replaces `path`.
pub(crate) fn beside(path: &Path) -> io::Result<NamedTempFile> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    NamedTempFile::new_in(folder.unwrap_or(Path::new(".")))
}

/// Converts small integers to a buffer for Python.
fn codes(places: Vec<u8>) -> PyArrowBuffer {
    PyArrowBuffer::new(Buffer::from_vec(places))
}

/// Returns the outputs with the given names. By default, returns all outputs of a solution.
pub(crate) fn selected(names: Option<Vec<String>>) -> Result<Vec<&'static Output>> {
    Ok(Answers::select(names.as_deref())?)
}

/// Creates a table from numeric columns and copied columns. Each numeric column has a name, values,
/// and the indices of rows without a value.
pub(crate) fn table_of(
    columns: Vec<(String, NumberArray, Vec<usize>)>,
    kept: Vec<(String, Py<KeptColumn>)>,
    len: usize,
) -> Result<Memory> {
    let (keep, kept): (Vec<_>, Vec<_>) =
        kept.into_iter().map(|(name, column)| (name, column.get().0.clone())).unzip();
    let names = columns.iter().map(|(name, ..)| name).chain(&keep).map(String::as_str);
    let named = Columns::sort(names, &keep, &TableFormat::default())?;
    let input = |(input, place): (usize, &usize)| {
        let (_, values, missing) = &columns[*place];
        let mut given = vec![true; if missing.is_empty() { 0 } else { len }];
        for row in missing {
            given[*row] = false;
        }
        let given = (!given.is_empty()).then(|| NullBuffer::from(given));
        named.in_unit(input, Float64Array::new(values.0.clone(), given))
    };
    let inputs = named.input_places().iter().enumerate().map(input).collect();
    let names = named.input_places().iter().map(|place| columns[*place].0.clone()).collect();
    if let Some(place) = kept.iter().position(|column| column.data_type().is_nested()) {
        return Err(TableError::nested_column(&keep[place]).into());
    }
    let named =
        named.with_kept_types(kept.iter().map(|column| column.data_type().clone()).collect());
    Ok(Memory { columns: named, names, inputs, kept, len, at: 0 })
}

/// Solves rows whose inputs are given as columns, and keeps the results in memory.
///
/// * `columns`: name and values of each column, and the indices of the rows in which the column has
///   no value.
/// * `kept`: columns that are copied to the results.
/// * `progress`: function that is called with the number of finished rows and the total number of
///   rows.
/// * `text`: true to keep the reasons why `auto` chose a model, in addition to the reasons for
///   missing results.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the arguments are keywords in Python")]
pub(crate) fn solve_many(
    py: Python<'_>,
    base: &Bound<'_, Case>,
    columns: Vec<(String, NumberArray, Vec<usize>)>,
    kept: Vec<(String, Py<KeptColumn>)>,
    len: usize,
    how: How,
    outputs: Option<Vec<String>>,
    threads: Option<NonZeroUsize>,
    progress: Option<Py<PyAny>>,
    text: bool,
) -> Result<Rows> {
    let memory = table_of(columns, kept, len)?;
    let base = base.get().0.clone();
    let task = Task::over_table(base, how.0, selected(outputs)?, &memory.columns)?;
    drive(py, &task, Origin::Memory(Box::new(memory)), len, (threads, progress, text))
}

/// Values of an axis: a `Linspace`, or a list.
#[derive(FromPyObject)]
pub(crate) enum AxisRange {
    Linspace { start: f64, stop: f64, number: i64 },
    List(Vec<f64>),
}

/// Creates a grid from the names and values of its axes.
pub(crate) fn grid_of(axes: Vec<(String, AxisRange)>) -> Result<Grid> {
    let axis = |(name, values): (String, AxisRange)| -> Result<GridAxis> {
        let values = match values {
            AxisRange::Linspace { start, stop, number } => {
                let count = usize::try_from(number).map_err(|_| {
                    format!("`{name}` has a range of {number} values, but must have at least 2")
                })?;
                AxisValues::Range { start, stop, count, log: false }
            }
            AxisRange::List(values) => AxisValues::List(values),
        };
        Ok(GridAxis::new(&name, values)?)
    };
    Ok(Grid::new(axes.into_iter().map(axis).collect::<Result<_>>()?)?)
}

/// Distribution of an input: `Uniform` or `Normal`.
#[derive(FromPyObject)]
pub(crate) enum Law {
    Uniform { low: f64, high: f64 },
    Normal { mean: f64, deviation: f64 },
}

/// Creates random points from the names and distributions of the inputs.
pub(crate) fn draws_of(
    seed: u64,
    count: u64,
    of: Vec<(String, Law)>,
) -> Result<RandomPoints, CaseError> {
    let draw = |(name, law): (String, Law)| {
        let distribution = match law {
            Law::Uniform { low, high } => Distribution::Uniform { low, high },
            Law::Normal { mean, deviation } => Distribution::Normal { mean, deviation },
        };
        RandomInput::new(&name, distribution)
    };
    RandomPoints::new(seed, count, of.into_iter().map(draw).collect::<Result<_, _>>()?)
}

/// Returns the values of each random input. The values are identical to the values of `bsm sweep
/// --draw`.
#[pyfunction]
pub(crate) fn draws(
    seed: u64,
    count: u64,
    of: Vec<(String, Law)>,
) -> Result<Vec<(&'static str, PyArrowBuffer)>> {
    let draws = draws_of(seed, count, of)?;
    Ok(draws.columns().map(|(key, values)| (key.name(), shared(values))).collect())
}

/// Solves a grid. The last axis varies fastest.
///
/// * `axes`: names and values of the varied inputs.
/// * `text`: see [`solve_many`].
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the arguments are keywords in Python")]
pub(crate) fn sweep(
    py: Python<'_>,
    base: &Bound<'_, Case>,
    axes: Vec<(String, AxisRange)>,
    how: How,
    outputs: Option<Vec<String>>,
    threads: Option<NonZeroUsize>,
    progress: Option<Py<PyAny>>,
    text: bool,
) -> Result<(Rows, Vec<(String, Vec<f64>)>)> {
    let grid = grid_of(axes)?;
    let task = Task::over_grid(base.get().0.clone(), how.0, selected(outputs)?, None, &grid)?;
    let axis = |axis: &GridAxis| {
        (axis.key.name().to_owned(), (0..axis.len()).map(|place| axis.value(place)).collect())
    };
    let axes = grid.axes().iter().map(axis).collect();
    let len = grid.len();
    Ok((drive(py, &task, Origin::Grid(grid), len, (threads, progress, text))?, axes))
}

/// A set of worker threads, with the id of the process that owns the set and the requested number
/// of threads.
type ThreadSet = (u32, Option<NonZeroUsize>, Arc<Workers<'static>>);

/// The sets of threads of this process, one set for each requested number of threads. A forked
/// process does not inherit the threads of its parent.
static HELD: Mutex<Vec<ThreadSet>> = Mutex::new(Vec::new());

/// Stop flag with which worker threads are created. It is never set, because each run has its own
/// stop flag.
static NEVER: AtomicBool = AtomicBool::new(false);

/// Returns the thread pool with the requested number of threads. The pool is started when it is
/// first requested.
fn workers(threads: Option<NonZeroUsize>) -> Result<Arc<Workers<'static>>> {
    let threads = threads.or_else(|| std::env::var("RAYON_NUM_THREADS").ok()?.parse().ok());
    let process = std::process::id();
    let mut held = HELD.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((.., workers)) = held.iter().find(|(p, t, _)| (*p, *t) == (process, threads)) {
        return Ok(workers.clone());
    }
    // After a fork, the threads of the parent process do not exist and cannot be joined.
    held.extract_if(.., |(p, ..)| *p != process).for_each(std::mem::forget);
    let workers = Arc::new(Workers::start(threads, &NEVER)?);
    held.push((process, threads, workers.clone()));
    Ok(workers)
}

/// Solves a batch task and collects the results of all rows.
///
/// * `how`: number of threads, progress function, and whether rows with a result keep their
///   messages.
fn drive(
    py: Python<'_>,
    task: &Task,
    origin: Origin,
    len: usize,
    (threads, progress, text): (Option<NonZeroUsize>, Option<Py<PyAny>>, bool),
) -> Result<Rows> {
    let mut gathered = RowAnswers::of(len, task.outputs.len(), text);
    watched(py, task.is_quick(len), len, threads, progress, |stop, done| {
        gathered.fill(task, origin.source().as_mut(), stop, done)
    })?;
    let RowAnswers { outcomes, messages, columns, .. } = gathered;
    let nothing = OnceCell::new();
    let column = |column: Option<Vec<f64>>| match column {
        Some(values) => ScalarBuffer::from(values),
        None => nothing.get_or_init(|| ScalarBuffer::from(vec![f64::NAN; len])).clone(),
    };
    let columns = columns.into_iter().map(column).collect();
    Ok(Rows { origin, outputs: task.outputs.clone(), outcomes, messages, columns })
}

/// Results of all rows of a table.
struct RowAnswers {
    outcomes: Vec<RowOutcome>,
    messages: Vec<(usize, String)>,
    /// Output columns. A column is `None` as long as no row has a value.
    columns: Vec<Option<Vec<f64>>>,
    len: usize,
    /// True if messages are also kept for rows that have a result.
    text: bool,
}

impl RowAnswers {
    fn of(len: usize, outputs: usize, text: bool) -> Self {
        // Requested outputs are written directly to their columns, and so are all outputs of a
        // table that fits into a single chunk. If all outputs are requested for a longer table,
        // most of them belong to models that were not used, so only existing values are returned.
        let own = if len <= ROWS_PER_CHUNK || outputs < OUTPUTS.len() { outputs } else { 0 };
        let Answers { outcomes, messages, columns } = Answers::allocate(len, own);
        let mut columns: Vec<_> = columns.into_iter().map(Some).collect();
        columns.resize(outputs, None);
        Self { outcomes, messages, columns, len, text }
    }

    /// Solves all rows of a source and stores their results.
    fn fill(
        &mut self,
        task: &Task,
        source: &mut dyn Source,
        stop: &AtomicBool,
        done: &AtomicU64,
    ) -> Result<(), TableError> {
        let named = source.columns().clone();
        let mut outcomes = &mut self.outcomes[..];
        let mut first = 0;
        while !stop.load(Ordering::Relaxed) {
            let Some(chunk) = source.next(ROWS_PER_CHUNK)? else { break };
            let rows = first..first + chunk.len;
            let here = outcomes.split_off_mut(..chunk.len).unwrap_or_default();
            let columns = self.columns.iter_mut();
            let columns = columns.map(|column| Some(&mut column.as_mut()?[rows.clone()])).collect();
            let buffers = Buffers { outcomes: &mut *here, columns };
            let RowReport { messages, values } =
                task.solve_into((&chunk, &named), buffers, stop, done);
            let wanted = |row: usize| self.text || here[row].status != Status::Converged;
            let words = messages.into_iter().filter(|(row, _)| wanted(*row));
            self.messages.extend(words.map(|(row, text)| (first + row, text)));
            for (place, row, values) in values {
                let column = self.columns[place].get_or_insert_with(|| {
                    // The operating system allocates zeroed memory only when it is first written,
                    // so unused rows occupy no memory.
                    let mut column = vec![0.0; self.len];
                    column[..rows.end].fill(f64::NAN);
                    column
                });
                column[first + row..][..values.len()].copy_from_slice(&values);
            }
            first = rows.end;
        }
        Ok(())
    }
}

/// Runs `work` on the worker threads, while the calling thread handles signals and shows the
/// progress. Short work is done by the calling thread itself.
///
/// * `work`: function that must end when its first argument becomes true, and that counts the
///   finished rows in its second argument.
pub(crate) fn watched<R: Send, E: Send>(
    py: Python<'_>,
    quick: bool,
    len: usize,
    threads: Option<NonZeroUsize>,
    progress: Option<Py<PyAny>>,
    work: impl FnOnce(&AtomicBool, &AtomicU64) -> Result<R, E> + Send,
) -> Result<R>
where
    Error: From<E>,
{
    let (stop, done) = (AtomicBool::new(false), AtomicU64::new(0));
    if quick {
        let result = py.detach(|| work(&stop, &done));
        look(progress.as_ref(), len as u64, len)?;
        return Ok(result?);
    }
    let workers = workers(threads)?;
    let mut interrupted = None;
    let result = py.detach(|| {
        thread::scope(|scope| {
            let (tell, told) = sync_channel(1);
            let (stop, done) = (&stop, &done);
            let run = move || {
                let result = workers.install(|| work(stop, done));
                tell.send(result).unwrap_or_default();
            };
            let running = thread::Builder::new().spawn_scoped(scope, run)?;
            loop {
                match told.recv_timeout(LOOK) {
                    Ok(result) => break Ok(result),
                    // A disconnected channel means that the worker thread has panicked.
                    Err(RecvTimeoutError::Disconnected) => match running.join() {
                        Err(panic) => resume_unwind(panic),
                        Ok(()) => break Err(io::Error::other("the threads returned no result")),
                    },
                    Err(RecvTimeoutError::Timeout) if interrupted.is_none() => {
                        let count = done.load(Ordering::Relaxed);
                        interrupted = look(progress.as_ref(), count, len).err();
                        stop.store(interrupted.is_some(), Ordering::Relaxed);
                    }
                    Err(RecvTimeoutError::Timeout) => {}
                }
            }
        })
    });
    if let Some(error) = interrupted {
        return Err(error.into());
    }
    look(progress.as_ref(), len as u64, len)?;
    Ok(result??)
}

/// Checks for signals and shows the progress.
fn look(progress: Option<&Py<PyAny>>, done: u64, len: usize) -> PyResult<()> {
    Python::attach(|py| {
        py.check_signals()?;
        progress.map_or(Ok(()), |progress| progress.call1(py, (done, len)).map(|_| ()))
    })
}
