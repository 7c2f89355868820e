//! The page of `bsm view`, which shows a screw in the browser. The page either requests its data
//! from a server on this machine or is saved as a single file that contains the solver.
//!
//! [`Server`] provides the page with the same numbers and messages as the commands. [`saved`]
//! returns the same page as a single file, in which the solver runs as WebAssembly. The sources of
//! the page are in `page/`: an HTML file, plain JavaScript modules, and the libraries in
//! `page/vendor`.
//!
//! Start with [`saved`], which creates the page of a case.

mod answer;
mod form;
#[cfg(feature = "server")]
mod http;
#[cfg(feature = "server")]
mod page;
#[cfg(feature = "server")]
mod running;
#[cfg(feature = "server")]
mod save;
#[cfg(feature = "server")]
mod server;

pub use answer::{Refusal, answer};
#[cfg(feature = "server")]
pub use save::{PageSolver, saved};
#[cfg(feature = "server")]
pub use server::{Save, Server, ViewError};
