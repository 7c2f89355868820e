//! All balls of a nut in the vocabulary: from a scene to its state under load.

mod bodies;
mod circuits;
mod loading;
mod problem;
mod report;
mod samples;
mod words;

pub(crate) use circuits::balls_and_turns;
pub use problem::NutProblem;
pub(crate) use problem::{OF_A_NUT, count};
pub use report::{BALL_COLUMNS, CURVE_COLUMNS, LISTED, NutReport};
pub(crate) use report::{QUANTITIES, preload_note};
pub use samples::Samples;
pub use words::NutWords;
pub(crate) use words::SupportWord;
