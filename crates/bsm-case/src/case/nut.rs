//! Conversion of the inputs for a nut with all its balls to a problem in SI units.

mod bodies;
mod circuits;
mod draw;
mod friction;
mod loading;
mod problem;
mod train;

pub(crate) use circuits::NutTurns;
pub(crate) use friction::FrictionSource;
pub use problem::NutProblem;
pub(crate) use problem::{NUT_ONLY_INPUTS, NutAtRest, NutPreload};
pub(crate) use train::room_message;
