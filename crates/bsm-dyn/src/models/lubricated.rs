//! Lubricated contacts in the raceway-control model and in the traction model.
//!
//! Theory: `docs/theory/17-lubricant.md`, equations (Y1) to (Y32).

mod band;
mod sensitivities;
mod solve;

pub use self::band::LossInterval;
pub use self::solve::{LubricatedBall, LubricatedModel, RacewayFriction};

#[cfg(test)]
mod tests;
