//! The page of `bsm view`, which shows a screw in the browser. The page is either connected to a
//! server on this machine or saved as a single file.
//!
//! [`Server`] provides the page with the same numbers and messages as the commands. [`saved`]
//! returns the same page with all results calculated in advance. The sources of the page are in
//! `page/`: an HTML file, plain JavaScript modules, and the libraries in `page/vendor`.

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
