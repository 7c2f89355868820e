//! The page: one screw in the browser, live from a server on this machine, or as one file.
//!
//! [`Server`] answers the page with the numbers and messages of the commands; [`saved`] is the same page with
//! all that it shows worked out beforehand. The page itself is in `page/`: one HTML file, plain modules, and
//! the libraries in `page/vendor`.

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
