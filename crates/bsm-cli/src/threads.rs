//! Threads of a command, as many as the system provides.

use std::num::NonZeroUsize;
use std::sync::atomic::AtomicBool;
use std::thread::available_parallelism;

use bsm_batch::Workers;

use crate::failure::{Failure, warn};

/// Interrupts end the program at once, after its unfinished files: no code has to check for them.
static STOP: AtomicBool = AtomicBool::new(false);

/// Runs a command on a number of threads, all cores unless given; on fewer, with a note, if the
/// system starts no more.
pub(crate) fn on_threads(
    wanted: Option<NonZeroUsize>,
    command: impl FnOnce(&Workers<'_>) -> Result<(), Failure> + Send,
) -> Result<(), Failure> {
    let wanted = wanted.or_else(|| available_parallelism().ok());
    let workers = Workers::start(wanted, &STOP).map_err(|e| Failure::no_thread(&e))?;
    let (threads, wanted) = (workers.threads(), wanted.map_or(1, NonZeroUsize::get));
    if threads < wanted {
        warn("note", &format!("{threads} of {wanted} threads: the system starts no more"));
    }
    workers.install(|| command(&workers))
}
