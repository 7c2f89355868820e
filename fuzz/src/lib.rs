//! Fuzz tests for all parsers of user input, and for the solvers that use this input.
//! A [`Target`] is called with arbitrary bytes. The target must not panic or exceed the limits for
//! time and memory. `tests/smoke.rs` runs all targets with the corpus and with random mutations of
//! the corpus in every test run, and `run.sh` runs coverage-guided fuzzing with libFuzzer.

mod mutate;
mod solve;
mod target;

pub use mutate::mutate;
pub use target::{TARGETS, Target};
