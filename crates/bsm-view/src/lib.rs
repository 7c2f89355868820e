//! The page of `bsm view`, which shows one screw in the browser: live from a server on this
//! machine, or as one file.
//!
//! [`Server`] provides the page with the same numbers and messages as the commands. [`saved`]
//! returns the same page with all results calculated in advance. The page itself is in `page/`: one
//! HTML file, plain JavaScript modules, and the libraries in `page/vendor`.

mod answer;
mod form;
mod http;
mod page;
mod running;
mod save;
mod server;

pub use answer::Refusal;
pub use save::saved;
pub use server::{Save, Server, ViewError};
