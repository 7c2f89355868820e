//! Converts panics in libraries to errors.

use std::cell;
use std::panic::{self, AssertUnwindSafe, catch_unwind};

thread_local! {
    /// True while this thread is inside [`catch_panic`].
    static IS_CATCHING: cell::Cell<bool> = const { cell::Cell::new(false) };
}

/// Installs a panic hook that prints nothing for panics inside [`catch_panic`], because these
/// panics become errors. Other panics still reach the previous hook. Programs should call this
/// function once at startup.
pub fn silence_caught_panics() {
    let print = panic::take_hook();
    panic::set_hook(Box::new(move |panic| {
        if !IS_CATCHING.get() {
            print(panic);
        }
    }));
}

/// Returns the result of `work`, or `None` if `work` panics. Use this function to call libraries
/// that panic instead of returning an error.
pub fn catch_panic<T>(work: impl FnOnce() -> T) -> Option<T> {
    let outer = IS_CATCHING.replace(true);
    let result = catch_unwind(AssertUnwindSafe(work));
    IS_CATCHING.set(outer);
    result.ok()
}
