//! Runs commands on as many threads as the operating system provides.

use std::num::NonZeroUsize;
use std::sync::atomic::AtomicBool;
use std::thread::available_parallelism;

use bsm_batch::Workers;

use crate::console::print_message;
use crate::failure::Failure;

/// Stop flag of the worker threads, which is never set. An interrupt removes unfinished files and
/// ends the program immediately instead.
static STOP: AtomicBool = AtomicBool::new(false);

/// Runs a command on the given number of threads, which defaults to the number of cores. If the
/// operating system starts fewer threads, the command uses only these threads, and a note is
/// printed.
pub(crate) fn on_threads(
    wanted: Option<NonZeroUsize>,
    command: impl FnOnce(&Workers<'_>) -> Result<(), Failure> + Send,
) -> Result<(), Failure> {
    let wanted = wanted.or_else(|| available_parallelism().ok());
    let workers = Workers::start(wanted, &STOP).map_err(|e| Failure::no_thread(&e))?;
    let (threads, wanted) = (workers.threads(), wanted.map_or(1, NonZeroUsize::get));
    if threads < wanted {
        print_message(
            "note",
            &format!(
                "only {threads} of {wanted} threads are used, because the operating system did not start more"
            ),
        );
    }
    workers.install(|| command(&workers))
}
