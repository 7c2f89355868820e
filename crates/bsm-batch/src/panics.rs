//! Panics of libraries as errors.

use std::cell;
use std::panic::{self, AssertUnwindSafe, catch_unwind};

thread_local! {
    /// True while this thread is within [`catch_panic`].
    static CATCHES: cell::Cell<bool> = const { cell::Cell::new(false) };
}

/// Hides panics within [`catch_panic`] from the panic hook, because they become errors. A program
/// calls this function at its start. Other panics still reach the previous hook.
pub fn silence_caught_panics() {
    let print = panic::take_hook();
    panic::set_hook(Box::new(move |panic| {
        if !CATCHES.get() {
            print(panic);
        }
    }));
}

/// Returns the result of `work`, or `None` if it panics. This is for libraries that panic instead
/// of returning an error.
pub fn catch_panic<T>(work: impl FnOnce() -> T) -> Option<T> {
    let outer = CATCHES.replace(true);
    let result = catch_unwind(AssertUnwindSafe(work));
    CATCHES.set(outer);
    result.ok()
}
