//! What an interrupt leaves behind: nothing under a final name, and no temporary file.

use std::fs;
use std::io;
use std::path::PathBuf;
use std::process::exit;
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::NamedTempFile;

use crate::failure::warn;

/// Temporary files that were made; those that are complete have another name by now.
static FILES: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Who holds it is not interrupted.
pub(crate) fn hold() -> MutexGuard<'static, Vec<PathBuf>> {
    FILES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Makes a temporary file that is removed if the program is interrupted, from its first moment on.
pub(crate) fn make(file: impl FnOnce() -> io::Result<NamedTempFile>) -> io::Result<NamedTempFile> {
    // Fails from the second file on. It also fails where signals are ignored, as under nohup: that stays.
    let _ = ctrlc::try_set_handler(interrupted);
    let mut files = hold();
    let file = file()?;
    files.push(file.path().to_owned());
    Ok(file)
}

/// Runs on a thread of its own, so that it waits for nobody but those who hold the files.
fn interrupted() {
    let files = hold();
    for file in files.iter() {
        let _ = fs::remove_file(file);
    }
    warn("error", "interrupted; nothing unfinished was kept (a folder goes on with --resume)");
    exit(130);
}
