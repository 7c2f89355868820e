//! Fuzzing of all parsers of user input, and of the solvers behind them.
//!
//! A [`Target`] accepts arbitrary bytes. It must not panic, and its time and memory are limited.
//! `tests/smoke.rs` replays the corpus and random mutations of it in every test run, and `run.sh`
//! runs coverage-guided fuzzing with libFuzzer.

mod mutate;
mod solve;
mod target;

pub use mutate::mutate;
pub use target::{TARGETS, Target};
