//! The pipeline from a source of rows to a sink. Chunks are read ahead, then solved and written on
//! all cores.

use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::{self, available_parallelism};

use bsm_dyn::Status;
use bsm_simd::Arch;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::solve::Solver;
use crate::{AnswerSink, Answers, Chunk, Format, Source, TableError, TableFormat, TableSink, Task};

/// Stack size of a thread \[B\]. If the code is not optimized, the kernels keep every intermediate
/// result, about 4 MB.
const STACK: usize = if cfg!(debug_assertions) { 16 << 20 } else { 2 << 20 };

/// Number of rows that are in memory at a time. The pages of a Parquet table end where chunks end,
/// so that its bytes depend on this number.
pub const ROWS: usize = 1 << 16;

/// Number of all rows, of rows without a result, and of rows with several results.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub struct Count {
    /// All rows.
    pub rows: u64,
    /// Rows that did not converge.
    pub failed: u64,
    /// Rows that are known to have other solutions.
    pub several: u64,
}

/// Threads that solve points, with their interrupt flag.
#[derive(Debug)]
pub struct Workers<'a> {
    pub(crate) pool: ThreadPool,
    pub(crate) stop: &'a AtomicBool,
}

/// Free memory that is required before another thread is started. A thread that cannot allocate
/// memory would end the program.
const MEMORY_RESERVE: usize = 16 << 20;

impl<'a> Workers<'a> {
    /// Starts threads. Their number defaults to one per core and is smaller if the system refuses
    /// more.
    ///
    /// * `stop`: when it becomes true, the work of the threads ends with [`RunError::Stopped`], at
    ///   the latest after the points that are being solved, one on each thread.
    ///
    /// # Errors
    ///
    /// [`io::Error`] if no thread can be started.
    pub fn start(threads: Option<NonZeroUsize>, stop: &'a AtomicBool) -> io::Result<Self> {
        let wanted = threads.or_else(|| available_parallelism().ok()).map_or(1, NonZeroUsize::get);
        // The threads are started before the pool is created, because the pool would lose its
        // threads if one more thread could not be started.
        let mut idle = Vec::new();
        while idle.len() < wanted {
            let (give, work) = sync_channel(1);
            let (running, runs) = sync_channel(1);
            let run = move || {
                running.send(()).unwrap_or_default();
                work.recv().into_iter().for_each(rayon::ThreadBuilder::run);
            };
            let mut room = Vec::<u8>::new();
            let started = match room.try_reserve_exact(MEMORY_RESERVE) {
                Ok(()) => {
                    drop(room);
                    thread::Builder::new().stack_size(STACK).spawn(run)
                }
                Err(error) => Err(io::Error::other(error)),
            };
            match started {
                Ok(thread) => {
                    // A thread must have allocated its memory before the next thread may do so.
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
                    // Half of the threads end, so that resources remain for reading and for memory.
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
            given.then_some(()).ok_or_else(|| io::Error::other("it has ended"))
        });
        Ok(Self { pool: pool.build().map_err(io::Error::other)?, stop })
    }

    /// Returns the number of threads that were started.
    pub fn threads(&self) -> usize {
        self.pool.current_num_threads()
    }

    /// Runs `work` on these threads.
    pub fn install<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        self.pool.install(work)
    }

    pub(crate) fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// The reason why a table was not solved to its end.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The remaining rows cannot be read.
    #[error(transparent)]
    Read(TableError),
    /// The results cannot be written.
    #[error(transparent)]
    Write(TableError),
    /// A thread cannot be started.
    #[error("cannot start a thread: {0}")]
    Thread(io::Error),
    /// The run was stopped.
    #[error("stopped")]
    Stopped,
}

impl Task {
    /// Solves all rows of `source`, writes them as a table, and returns the writer.
    ///
    /// * `seen`: is called with every solved chunk.
    ///
    /// # Errors
    ///
    /// [`RunError`].
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

    /// Solves the next rows of `source`, at most `max_rows`, writes them to `sink`, and returns
    /// the sink.
    ///
    /// One thread reads ahead. The workers write each chunk while they solve the next chunk.
    ///
    /// * `seen`: is called with every solved chunk.
    ///
    /// # Errors
    ///
    /// [`RunError`]. The sink is lost in this case.
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
                for (output, values) in
                    self.filled.iter().zip(&answers.columns[self.outputs.len()..])
                {
                    let index = columns.inputs.iter().position(|key| key.name() == output.name);
                    if let Some(index) = index {
                        chunk.complete(index, values);
                    }
                }
                behind = Some((chunk, answers));
            }
            workers.install(|| write(&mut sink, &mut count, behind))?;
            Ok((sink, count))
        })
    }
}

/// Sends the rows of a source, at most `max_rows`, until the source ends or fails, or until the
/// receiver is closed.
fn read_ahead(source: &mut dyn Source, max_rows: u64, to: &SyncSender<Result<Chunk, TableError>>) {
    let mut left = max_rows;
    while left > 0 {
        let rows = usize::try_from(left).unwrap_or(ROWS).min(ROWS);
        let Some(chunk) = source.next(rows).transpose() else { break };
        left = chunk.as_ref().map_or(0, |chunk| left - chunk.len as u64);
        if to.send(chunk).is_err() {
            break;
        }
    }
}

/// Counts and writes a solved chunk, if there is one.
fn write<S: AnswerSink>(
    sink: &mut S,
    count: &mut Count,
    solved: Option<(Chunk, Answers)>,
) -> Result<(), RunError> {
    let Some((chunk, answers)) = solved else { return Ok(()) };
    let verdicts = &answers.verdicts;
    count.rows += verdicts.len() as u64;
    count.several += verdicts.iter().filter(|v| v.has_others).count() as u64;
    count.failed += verdicts.iter().filter(|v| v.status != Status::Converged).count() as u64;
    sink.write(chunk, answers).map_err(RunError::Write)
}
