//! Messages on standard error.

use std::io::{self, Write};

use bsm_case::printable;

/// Prints one message to standard error. A failed write is ignored because it cannot be reported.
pub(crate) fn print_message(kind: &str, text: &str) {
    let _ = writeln!(io::stderr(), "{kind}: {}", printable(text));
}
