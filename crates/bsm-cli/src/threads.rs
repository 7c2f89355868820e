//! Threads for a command, as many as the system gives.

use std::io;
use std::num::NonZeroUsize;
use std::thread::available_parallelism;

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

use crate::failure::{Failure, warn};

/// Runs a command on so many threads, on all cores unless given; on fewer, with a note, if the
/// system starts no more.
pub(crate) fn on_threads(
    wanted: Option<NonZeroUsize>,
    command: impl FnOnce() -> Result<(), Failure> + Send,
) -> Result<(), Failure> {
    let wanted = wanted.or_else(|| available_parallelism().ok()).map_or(1, NonZeroUsize::get);
    let mut threads = wanted;
    let pool = loop {
        match pool(threads) {
            Ok(pool) => break pool,
            Err(_) if threads > 1 => threads /= 2,
            Err(error) => return Err(Failure::no_thread(&io::Error::other(error))),
        }
    };
    if threads < wanted {
        warn("note", &format!("{threads} of {wanted} threads: the system starts no more"));
    }
    pool.install(command)
}

/// A single thread is the one that is there, so that it always starts.
fn pool(threads: usize) -> Result<ThreadPool, ThreadPoolBuildError> {
    let builder = ThreadPoolBuilder::new().num_threads(threads);
    if threads == 1 { builder.use_current_thread().build() } else { builder.build() }
}
