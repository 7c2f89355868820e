//! Fuzzing of everything that reads what a user gives, and of the solve path behind it.
//!
//! A [`Target`] takes any bytes and must neither panic nor take long nor much memory. `tests/smoke.rs`
//! replays the corpus and seeded mutations of it in the ordinary test run; `run.sh` lets libFuzzer
//! follow the coverage for as long as one likes.

mod mutate;
mod solve;
mod target;

pub use mutate::mutate;
pub use target::{TARGETS, Target};
