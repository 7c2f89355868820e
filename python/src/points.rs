//! Many points in memory.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use arrow_buffer::{Buffer, ScalarBuffer};
use bsm_batch::{
    Answers, Cell, Chunk, Column, Columns, Format, GridSource, ROWS, RunError, Sink, Source,
    TableError, TableSink, Task, Verdict, Workers,
};
use bsm_case::{Axis, Grid, ModelChoice, Output};
use bsm_dyn::Status;
use pyo3::prelude::*;
use pyo3_arrow::buffer::PyArrowBuffer;

use crate::errors;
use crate::scene::{How, Scene};
use crate::table::Numbers;

/// How often the thread that called looks at signals and shows progress.
const LOOK: Duration = Duration::from_millis(50);

/// Rows that are solved without further threads.
const AT_ONCE: usize = 256;

/// The rows of a table in memory.
#[derive(Clone)]
struct Memory {
    columns: Columns,
    inputs: Vec<Numbers>,
    /// Rows without a value, for each input.
    gaps: Vec<Vec<usize>>,
    kept: Vec<Vec<String>>,
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
        let end = self.len.min(self.at.saturating_add(rows));
        if end == self.at {
            return Ok(None);
        }
        let range = self.at..end;
        let column = |(numbers, gaps): (&Numbers, &Vec<usize>)| {
            let mut column = Column::with_capacity(range.len());
            let mut gaps = gaps.iter().skip_while(|row| **row < range.start).peekable();
            for row in range.clone() {
                let missing = gaps.next_if(|gap| **gap == row).is_some();
                column.push(if missing { Cell::Missing } else { Cell::Number(numbers.0[row]) });
            }
            column
        };
        let chunk = Chunk {
            first: self.at as u64 + 1,
            len: range.len(),
            inputs: self.inputs.iter().zip(&self.gaps).map(column).collect(),
            kept: self.kept.iter().map(|texts| texts[range.clone()].to_vec()).collect(),
        };
        self.at = end;
        Ok(Some(chunk))
    }
}

/// Answers of all chunks, one after another.
#[derive(Default)]
struct Gathered {
    verdicts: Vec<Verdict>,
    messages: Vec<(usize, String)>,
    columns: Vec<Vec<f64>>,
}

impl Gathered {
    /// Room for the answers of some rows.
    fn with_room(rows: usize, outputs: usize) -> Self {
        Self {
            verdicts: Vec::with_capacity(rows),
            messages: Vec::new(),
            columns: (0..outputs).map(|_| Vec::with_capacity(rows)).collect(),
        }
    }
}

impl Sink for Gathered {
    fn write(&mut self, _: Chunk, answers: Answers) -> Result<(), TableError> {
        let first = self.verdicts.len();
        self.messages.extend(answers.messages.into_iter().map(|(row, text)| (first + row, text)));
        self.verdicts.extend(answers.verdicts);
        for (all, column) in self.columns.iter_mut().zip(answers.columns) {
            all.extend_from_slice(&column);
        }
        Ok(())
    }
}

/// Where the rows came from, to read them again.
#[derive(Clone)]
enum Origin {
    Grid(Grid),
    Memory(Memory),
}

impl Origin {
    fn source(&self) -> Box<dyn Source> {
        match self {
            Self::Grid(grid) => Box::new(GridSource::new(grid.clone())),
            Self::Memory(memory) => Box::new(memory.clone()),
        }
    }
}

/// Rows and their answers.
#[pyclass(frozen, module = "ballscrew._core")]
pub(crate) struct Rows {
    origin: Origin,
    outputs: Vec<&'static Output>,
    verdicts: Vec<Verdict>,
    messages: Vec<(usize, String)>,
    columns: Vec<ScalarBuffer<f64>>,
}

/// Places of words in a list: the words, and one place a row.
type Words = (PyArrowBuffer, Vec<&'static str>);

#[pymethods]
impl Rows {
    fn __len__(&self) -> usize {
        self.verdicts.len()
    }

    /// Models, as places in their names.
    fn models(&self) -> Words {
        let names: Vec<_> = ModelChoice::names().collect();
        let place = |verdict: &Verdict| match verdict.model {
            ModelChoice::Auto => 0,
            ModelChoice::Fixed(model) => 1 + model as u8,
        };
        (codes(self.verdicts.iter().map(place).collect()), names)
    }

    /// Statuses, as places in their names.
    fn statuses(&self) -> Words {
        let names = Status::ALL.map(Status::name).to_vec();
        (codes(self.verdicts.iter().map(|verdict| verdict.status as u8).collect()), names)
    }

    /// Why rows have no result, or why auto chose their model.
    fn messages(&self) -> Vec<(usize, &str)> {
        self.messages.iter().map(|(row, text)| (*row, text.as_str())).collect()
    }

    /// The outputs: name and values.
    fn outputs(&self) -> Vec<(&'static str, PyArrowBuffer)> {
        let buffer = |values: &ScalarBuffer<f64>| PyArrowBuffer::new(values.inner().clone());
        self.outputs.iter().zip(&self.columns).map(|(o, values)| (o.name, buffer(values))).collect()
    }

    /// Writes the table as the program does, by the ending of the path.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let format = Format::of(&path).ok_or_else(|| {
            errors::words(&format!("{}: must end in .csv, .jsonl or .parquet", path.display()))
        })?;
        py.detach(|| self.write_to(&path, format)).map_err(|e| errors::table(&e))
    }
}

impl Rows {
    fn write_to(&self, path: &Path, format: Format) -> Result<(), TableError> {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let file = tempfile::NamedTempFile::new_in(folder.unwrap_or(Path::new(".")))?;
        let mut source = self.origin.source();
        let mut sink = TableSink::new(format, file, source.columns(), &self.outputs)?;
        let mut messages = self.messages.iter().peekable();
        while let Some(chunk) = source.next(ROWS)? {
            let first = usize::try_from(chunk.first - 1).unwrap_or(0);
            let rows = first..first + chunk.len;
            let mut of_chunk = Vec::new();
            while let Some((row, text)) = messages.next_if(|(row, _)| rows.contains(row)) {
                of_chunk.push((row - first, text.clone()));
            }
            let answers = Answers {
                verdicts: self.verdicts[rows.clone()].to_vec(),
                messages: of_chunk,
                columns: self.columns.iter().map(|column| column[rows.clone()].to_vec()).collect(),
            };
            sink.write(chunk, answers)?;
        }
        let file = sink.finish()?;
        file.persist(path).map_err(|e| TableError::Io(e.error))?;
        Ok(())
    }
}

/// Small numbers for Python.
fn codes(places: Vec<u8>) -> PyArrowBuffer {
    PyArrowBuffer::new(Buffer::from_vec(places))
}

/// The outputs of these names, or all of a solution.
fn selected(names: Option<Vec<String>>) -> PyResult<Vec<&'static Output>> {
    Answers::select(names.as_deref()).map_err(|e| errors::table(&e))
}

/// Solves the rows of columns in memory.
///
/// * `columns`: name, values, rows without one. * `kept`: columns of texts that are carried through.
/// * `progress`: is called with the rows that are done and their number.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the keywords of a public function")]
pub(crate) fn solve_many(
    py: Python<'_>,
    base: &Bound<'_, Scene>,
    columns: Vec<(String, Numbers, Vec<usize>)>,
    kept: Vec<(String, Vec<String>)>,
    len: usize,
    how: How,
    outputs: Option<Vec<String>>,
    threads: Option<NonZeroUsize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Rows> {
    let keep: Vec<_> = kept.iter().map(|(name, _)| name.clone()).collect();
    let names = columns.iter().map(|(name, ..)| name).chain(&keep).map(String::as_str);
    let named = Columns::sort(names, &keep).map_err(|e| errors::table(&e))?;
    // Columns of an earlier answer are passed over.
    let inputs =
        columns.into_iter().filter(|(name, ..)| named.inputs.iter().any(|k| k.name() == name));
    let (inputs, gaps) = inputs.map(|(_, numbers, gaps)| (numbers, gaps)).unzip();
    let kept = kept.into_iter().map(|(_, texts)| texts).collect();
    let base = base.get().0.clone();
    let task = Task::over_table(base, how.settings()?, selected(outputs)?, &named);
    let task = task.map_err(|e| errors::input(&e))?;
    let memory = Memory { columns: named, inputs, gaps, kept, len, at: 0 };
    drive(py, &task, Origin::Memory(memory), len, threads, progress)
}

/// Solves a grid; the last axis runs fastest.
///
/// * `axes`: as `--vary` has them.
#[pyfunction]
pub(crate) fn sweep(
    py: Python<'_>,
    base: &Bound<'_, Scene>,
    axes: Vec<String>,
    how: How,
    outputs: Option<Vec<String>>,
    threads: Option<NonZeroUsize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Rows, Vec<(String, Vec<f64>)>)> {
    let axes: Result<Vec<_>, _> = axes.iter().map(|text| Axis::parse(text)).collect();
    let grid = axes.and_then(Grid::new).map_err(|e| errors::input(&e))?;
    let settings = how.settings()?;
    let task = Task::over_grid(base.get().0.clone(), settings, selected(outputs)?, None, &grid);
    let task = task.map_err(|e| errors::input(&e))?;
    let axis = |axis: &Axis| {
        (axis.key.name().to_owned(), (0..axis.len()).map(|place| axis.value(place)).collect())
    };
    let axes = grid.axes().iter().map(axis).collect();
    let len = grid.len();
    Ok((drive(py, &task, Origin::Grid(grid), len, threads, progress)?, axes))
}

/// Threads of this process: a fork has none of those that its parent started.
static HELD: Mutex<Vec<(u32, Option<NonZeroUsize>, Workers<'static>)>> = Mutex::new(Vec::new());

/// What the held threads look at, which no one sets.
static NEVER: AtomicBool = AtomicBool::new(false);

/// The threads of this process, started once for each number of them.
fn workers(threads: Option<NonZeroUsize>, stop: &AtomicBool) -> Result<Workers<'_>, RunError> {
    let process = std::process::id();
    let mut held = HELD.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((.., workers)) = held.iter().find(|(p, t, _)| (*p, *t) == (process, threads)) {
        return Ok(workers.with(stop));
    }
    // Threads of a parent are not there to be joined.
    held.drain(..).filter(|(p, ..)| *p != process).for_each(std::mem::forget);
    let started = Workers::start(threads, &NEVER).map_err(RunError::Thread)?;
    let workers = started.with(stop);
    held.push((process, threads, started));
    Ok(workers)
}

/// Solves a task while the calling thread looks at signals and shows progress.
fn drive(
    py: Python<'_>,
    task: &Task,
    origin: Origin,
    len: usize,
    threads: Option<NonZeroUsize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Rows> {
    let (stop, done) = (AtomicBool::new(false), AtomicU64::new(0));
    let outputs = task.outputs.clone();
    let mut source = origin.source();
    let sink = Gathered::with_room(len, outputs.len());
    let threads = threads.or_else(allowed);
    let mut interrupted = None;
    let solved = py.detach(|| {
        let workers = workers(threads, &stop)?;
        if len <= AT_ONCE {
            return at_once(task, source.as_mut(), sink, &workers);
        }
        thread::scope(|scope| {
            let (tell, told) = sync_channel(1);
            let (workers, done) = (&workers, &done);
            let run = move || {
                let mut count = |chunk: &Chunk, _: &Answers| {
                    done.fetch_add(chunk.len as u64, Ordering::Relaxed);
                };
                let run = task.run(source.as_mut(), sink, u64::MAX, workers, &mut count);
                tell.send(run).unwrap_or_default();
            };
            thread::Builder::new().spawn_scoped(scope, run).map_err(RunError::Thread)?;
            loop {
                match told.recv_timeout(LOOK) {
                    Ok(run) => break run.map(|(sink, _)| sink),
                    Err(RecvTimeoutError::Disconnected) => break Err(RunError::Stopped),
                    Err(RecvTimeoutError::Timeout) if interrupted.is_none() => {
                        let looked = look(progress.as_ref(), done.load(Ordering::Relaxed), len);
                        stop.store(looked.is_err(), Ordering::Relaxed);
                        interrupted = looked.err();
                    }
                    Err(RecvTimeoutError::Timeout) => {}
                }
            }
        })
    });
    if let Some(error) = interrupted {
        return Err(error);
    }
    let Gathered { verdicts, messages, columns } = solved.map_err(|e| errors::run(&e))?;
    look(progress.as_ref(), len as u64, len)?;
    let columns = columns.into_iter().map(ScalarBuffer::from).collect();
    Ok(Rows { origin, outputs, verdicts, messages, columns })
}

/// Few rows, without further threads.
fn at_once(
    task: &Task,
    source: &mut dyn Source,
    mut sink: Gathered,
    workers: &Workers<'_>,
) -> Result<Gathered, RunError> {
    let columns = source.columns().clone();
    while let Some(chunk) = source.next(AT_ONCE).map_err(RunError::Read)? {
        let answers = workers.install(|| task.solve(&chunk, &columns));
        sink.write(chunk, answers).map_err(RunError::Write)?;
    }
    Ok(sink)
}

/// Looks at signals, and shows progress.
fn look(progress: Option<&Py<PyAny>>, done: u64, len: usize) -> PyResult<()> {
    Python::attach(|py| {
        py.check_signals()?;
        progress.map_or(Ok(()), |progress| progress.call1(py, (done, len)).map(|_| ()))
    })
}

/// Threads that the environment asks for.
fn allowed() -> Option<NonZeroUsize> {
    std::env::var("RAYON_NUM_THREADS").ok()?.parse().ok()
}
