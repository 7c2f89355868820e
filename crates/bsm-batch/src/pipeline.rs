//! Solves the rows of a source and writes the results to a sink. One thread reads chunks in
//! advance, while all cores solve and write other chunks.

use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::{self, available_parallelism};

use bsm_case::Output;
use bsm_dyn::Status;
use bsm_simd::Arch;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::rows::ROWS_PER_CHUNK;
use crate::solve::Solver;
use crate::{AnswerSink, Answers, Chunk, Format, Source, TableError, TableFormat, TableSink, Task};

/// Stack size of a thread \[B\]. In unoptimized builds, the kernels keep all their intermediate
/// results on the stack, which takes about 4 MB.
const STACK: usize = if cfg!(debug_assertions) { 16 << 20 } else { 2 << 20 };

/// Counts of the rows that a run has written.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub struct Count {
    /// Number of all rows, with and without a result.
    pub rows: u64,
    /// Number of rows without a result.
    pub failed: u64,
    /// Number of rows whose operating points are known to have further solutions.
    pub with_other_solutions: u64,
}

/// A thread pool that solves points, together with a stop flag.
#[derive(Debug)]
pub struct Workers<'a> {
    pub(crate) pool: ThreadPool,
    pub(crate) stop: &'a AtomicBool,
}

/// Memory that must be available before another thread is started \[B\]. If a thread cannot
/// allocate memory, the whole program is aborted.
const MEMORY_RESERVE: usize = 16 << 20;

impl<'a> Workers<'a> {
    /// Starts the threads, by default one per core. If the operating system does not permit that
    /// many threads, the pool has fewer threads.
    ///
    /// * `stop`: stop flag. After the flag becomes true, each thread finishes the point that it is
    ///   solving, and the run ends with [`RunError::Stopped`].
    ///
    /// # Errors
    ///
    /// Returns [`io::Error`] if no thread can be started.
    pub fn start(threads: Option<NonZeroUsize>, stop: &'a AtomicBool) -> io::Result<Self> {
        let wanted = threads.or_else(|| available_parallelism().ok()).map_or(1, NonZeroUsize::get);
        // The threads are started before the pool is created. If the pool started its threads
        // itself and one of them failed to start, the pool could not be created at all.
        let mut idle = Vec::new();
        while idle.len() < wanted {
            let (give, work) = sync_channel(1);
            let (running, runs) = sync_channel(1);
            let run = move || {
                running.send(()).unwrap_or_default();
                work.recv().into_iter().for_each(rayon::ThreadBuilder::run);
            };
            let mut reserve = Vec::<u8>::new();
            let started = match reserve.try_reserve_exact(MEMORY_RESERVE) {
                Ok(()) => {
                    drop(reserve);
                    thread::Builder::new().stack_size(STACK).spawn(run)
                }
                Err(error) => Err(io::Error::other(error)),
            };
            match started {
                Ok(thread) => {
                    // Each thread is started only after the previous thread has allocated its
                    // memory.
                    runs.recv().unwrap_or_default();
                    idle.push((give, thread));
                }
                Err(error) if idle.is_empty() => {
                    // WebAssembly has no threads, so the calling thread does the work.
                    if error.kind() != io::ErrorKind::Unsupported {
                        return Err(error);
                    }
                    let pool = ThreadPoolBuilder::new().num_threads(1).use_current_thread();
                    return Ok(Self { pool: pool.build().map_err(io::Error::other)?, stop });
                }
                Err(_) => {
                    // Half of the started threads are terminated to free memory and other resources
                    // for reading the table.
                    for (give, thread) in idle.split_off(idle.len().div_ceil(2)) {
                        drop(give);
                        thread.join().unwrap_or_else(|panic| resume_unwind(panic));
                    }
                    break;
                }
            }
        }
        let pool = ThreadPoolBuilder::new().num_threads(idle.len()).spawn_handler(|worker| {
            let given = idle.pop().is_some_and(|(give, _)| give.send(worker).is_ok());
            given.then_some(()).ok_or_else(|| io::Error::other("the thread has ended"))
        });
        Ok(Self { pool: pool.build().map_err(io::Error::other)?, stop })
    }

    /// Returns the number of threads in the pool.
    pub fn threads(&self) -> usize {
        self.pool.current_num_threads()
    }

    /// Runs `work` on the threads of the pool.
    pub fn install<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        self.pool.install(work)
    }

    pub(crate) fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// Reason why a run ended before all rows of the table were solved.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The source could not read the remaining rows.
    #[error(transparent)]
    Read(TableError),
    /// The sink could not write the results.
    #[error(transparent)]
    Write(TableError),
    /// The operating system did not start a thread.
    #[error("cannot start a thread: {0}")]
    Thread(io::Error),
    /// The run was stopped through the stop flag of the workers.
    #[error("stopped")]
    Stopped,
}

impl Task {
    /// Solves all rows of `source`, writes them as a table, and returns the writer.
    ///
    /// * `seen`: function that is called after each chunk has been solved.
    ///
    /// # Errors
    ///
    /// Returns [`RunError`] if reading or writing fails, a thread cannot be started, or the run is
    /// stopped.
    pub fn write<W: Write + Send>(
        &self,
        source: &mut dyn Source,
        format: Format,
        to: W,
        workers: &Workers<'_>,
        seen: &mut dyn FnMut(&Chunk, &Answers),
    ) -> Result<(W, Count), RunError> {
        let (columns, table_format) = (source.columns(), TableFormat::default());
        let sink = TableSink::new(format, to, columns, &self.outputs, &table_format);
        let sink = sink.map_err(RunError::Write)?;
        let (sink, count) = self.run(source, sink, u64::MAX, workers, seen)?;
        Ok((sink.finish(None).map_err(RunError::Write)?, count))
    }

    /// Solves up to `max_rows` rows of `source`, writes them to `sink`, and returns the sink.
    ///
    /// One thread reads chunks in advance. The threads of the pool write each chunk while they
    /// solve the next one.
    ///
    /// * `seen`: function that is called after each chunk has been solved.
    ///
    /// # Errors
    ///
    /// Returns [`RunError`] if reading or writing fails, a thread cannot be started, or the run is
    /// stopped. The sink is then dropped.
    ///
    /// # Panics
    ///
    /// Panics if [`filled`](Self::filled) contains an output that is not an input column of the
    /// source.
    pub fn run<S: AnswerSink + Send>(
        &self,
        source: &mut dyn Source,
        mut sink: S,
        max_rows: u64,
        workers: &Workers<'_>,
        seen: &mut dyn FnMut(&Chunk, &Answers),
    ) -> Result<(S, Count), RunError> {
        let columns = source.columns().clone();
        let solver = Solver::new(self, &columns);
        // Indices of the input columns whose missing values are filled with results.
        let column_of = |output: &&Output| {
            let place = columns.inputs.iter().position(|key| key.name() == output.name);
            place.expect("only columns of the table are filled")
        };
        let filled: Vec<_> = self.filled.iter().map(column_of).collect();
        let (read, chunks) = sync_channel(1);
        thread::scope(|scope| {
            thread::Builder::new()
                .spawn_scoped(scope, move || read_ahead(source, max_rows, &read))
                .map_err(RunError::Thread)?;
            let mut count = Count::default();
            let mut behind = None;
            for chunk in chunks {
                let mut chunk = chunk.map_err(RunError::Read)?;
                let solve = || solver.solve(Arch::new(), workers.stop, &chunk);
                let write = || write(&mut sink, &mut count, behind.take());
                let (answers, written) = workers.install(|| rayon::join(solve, write));
                if workers.stopped() {
                    return Err(RunError::Stopped);
                }
                written?;
                seen(&chunk, &answers);
                for (index, values) in filled.iter().zip(&answers.columns[self.outputs.len()..]) {
                    chunk.complete(*index, values);
                }
                behind = Some((chunk, answers));
            }
            workers.install(|| write(&mut sink, &mut count, behind))?;
            Ok((sink, count))
        })
    }
}

/// Reads up to `max_rows` rows of a source and sends them to a channel. Reading ends early if the
/// source ends or fails, or if the receiver is closed.
fn read_ahead(source: &mut dyn Source, max_rows: u64, to: &SyncSender<Result<Chunk, TableError>>) {
    let mut left = max_rows;
    while left > 0 {
        let rows = usize::try_from(left).unwrap_or(ROWS_PER_CHUNK).min(ROWS_PER_CHUNK);
        let Some(chunk) = source.next(rows).transpose() else { break };
        left = chunk.as_ref().map_or(0, |chunk| left - chunk.len as u64);
        if to.send(chunk).is_err() {
            break;
        }
    }
}

/// Writes the rows of a solved chunk and adds them to the counts. Does nothing if there is no
/// chunk.
fn write<S: AnswerSink>(
    sink: &mut S,
    count: &mut Count,
    solved: Option<(Chunk, Answers)>,
) -> Result<(), RunError> {
    let Some((chunk, answers)) = solved else { return Ok(()) };
    let outcomes = &answers.outcomes;
    count.rows += outcomes.len() as u64;
    count.with_other_solutions += outcomes.iter().filter(|v| v.has_others).count() as u64;
    count.failed += outcomes.iter().filter(|v| v.status != Status::Converged).count() as u64;
    sink.write(chunk, answers).map_err(RunError::Write)
}
