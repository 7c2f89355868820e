//! Cleanup after an interruption. It ensures that no file with a final name is incomplete and that
//! no temporary file remains.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::NamedTempFile;

/// List of temporary files that are still being written.
#[derive(Debug)]
pub(crate) struct Unfinished {
    files: Vec<PathBuf>,
    /// True after the interrupt handler has been started.
    listening: bool,
}

/// True after a write has failed because the file would have exceeded the size limit (`ulimit -f`).
pub(crate) static FILE_TOO_LARGE: AtomicBool = AtomicBool::new(false);

static UNFINISHED: Mutex<Unfinished> =
    Mutex::new(Unfinished { files: Vec::new(), listening: false });

/// Locks the list of temporary files. Interrupts are delayed until the guard is dropped.
pub(crate) fn block_interrupts() -> MutexGuard<'static, Unfinished> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Unfinished {
    /// Removes a file from the list after it has been renamed to its final name.
    pub(crate) fn finished(&mut self, temporary: &Path) {
        self.files.retain(|file| file != temporary);
    }
}

/// Creates a temporary file and registers it, so that an interrupt removes it.
pub(crate) fn create_temporary(
    file: &mut dyn FnMut() -> io::Result<NamedTempFile>,
) -> io::Result<NamedTempFile> {
    let mut held = block_interrupts();
    if !held.listening {
        signals::listen()?;
        held.listening = true;
    }
    let file = file()?;
    held.files.push(file.path().to_owned());
    Ok(file)
}

pub(crate) use signals::install_handlers;

#[cfg(unix)]
mod signals {
    use std::process::exit;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::time::Duration;
    use std::{fs, io, thread};

    use signal_hook::consts::{
        SIGABRT, SIGALRM, SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGUSR1, SIGUSR2, SIGXCPU, SIGXFSZ,
    };
    use signal_hook::{flag, iterator::Signals};

    use super::FILE_TOO_LARGE;
    use crate::console::print_message;

    /// Handled signals, including the signals that job schedulers send before a time limit expires.
    /// Each signal ends the program with the exit code 128 + signal number.
    const INTERRUPTS: [i32; 9] =
        [SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGXFSZ, SIGXCPU, SIGUSR1, SIGUSR2, SIGALRM];

    /// Time to wait after the signal SIGXFSZ, so that a failed write of this program can report its
    /// error.
    const WRITE_ERROR_DELAY: Duration = Duration::from_millis(200);

    /// Ensures that the program ends with exit code 1 if memory runs out or a file exceeds the size
    /// limit.
    pub(crate) fn install_handlers() -> io::Result<()> {
        // With this handler, a write beyond the limit of `ulimit -f` returns an error instead of
        // terminating the program.
        flag::register(SIGXFSZ, Arc::default())?;
        // If memory runs out, Rust prints an error and aborts. With this handler, the program ends
        // with exit code 1 instead of the exit code of an abort.
        flag::register_conditional_shutdown(SIGABRT, 1, Arc::new(AtomicBool::new(true)))?;
        Ok(())
    }

    /// Handles interrupts on a separate thread. An interrupt is delayed only while other code holds
    /// the lock on the list of temporary files.
    pub(super) fn listen() -> io::Result<()> {
        let ignored = ignored();
        let heard = INTERRUPTS.into_iter().filter(|signal| ignored >> (signal - 1) & 1 == 0);
        let mut signals = Signals::new(heard)?;
        thread::Builder::new().name("interrupts".to_owned()).spawn(move || {
            for signal in &mut signals {
                if signal != SIGXFSZ || !write_failed() {
                    interrupted(signal);
                }
            }
        })?;
        Ok(())
    }

    /// Returns true if SIGXFSZ was caused by a write of this program. In this case, the failed
    /// write reports the error.
    fn write_failed() -> bool {
        thread::sleep(WRITE_ERROR_DELAY);
        FILE_TOO_LARGE.load(Ordering::Relaxed)
    }

    fn interrupted(signal: i32) {
        let held = super::block_interrupts();
        for file in &held.files {
            let _ = fs::remove_file(file);
        }
        print_message(
            "error",
            "interrupted; incomplete files were removed (to continue a run that writes a folder, use --resume)",
        );
        exit(128 + signal);
    }

    /// Returns the signals that were ignored when the program was started, as a bit mask whose
    /// lowest bit is SIGHUP. Signals ignored by `nohup` or in background jobs of scripts must stay
    /// ignored. The mask is only available on Linux.
    fn ignored() -> u64 {
        let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
        let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
        mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
    }
}

#[cfg(not(unix))]
mod signals {
    use std::io;

    /// Does nothing on this operating system.
    #[expect(clippy::unnecessary_wraps, reason = "fails on Unix")]
    pub(crate) fn install_handlers() -> io::Result<()> {
        Ok(())
    }

    /// Does nothing on this operating system, where an interrupt ends the program immediately:
    /// existing output files remain intact, but a temporary file may be left behind.
    #[expect(clippy::unnecessary_wraps, reason = "fails on Unix")]
    pub(super) fn listen() -> io::Result<()> {
        Ok(())
    }
}
