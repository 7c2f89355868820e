//! Lubricated contacts in the raceway-control model and in the traction model.
//!
//! Theory: `docs/theory/17-lubricant.md`, equations (Y1) to (Y32).

mod sensitivities;
mod solve;
mod uncertainty;

pub use self::solve::{LubricatedBall, LubricatedModel, RacewayFriction};
pub use self::uncertainty::LossInterval;

#[cfg(test)]
mod tests;
