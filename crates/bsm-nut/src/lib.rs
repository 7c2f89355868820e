//! All balls of a ball nut: how they share the load, how stiff the nut is, how much preload is left
//! and how long it lives, static and without friction; and how warm it gets.
//!
//! Theory: `docs/theory/16-nut.md`, equations (U1) to (U32).
//!
//! Warm: `docs/theory/19-warm-state.md`, module [`thermal`].
//!
//! A [`BallNut`] is geometry: circuits of balls on the helix, the bodies that strain, and the errors of
//! making. [`BallNut::solve`] finds how it carries a [`Support`]: the load, and what the guides hold.

mod assembly;
mod ball;
mod bodies;
mod equilibrium;
mod friction;
mod geometry;
mod interpolation;
mod life;
mod preload;
mod search;
mod sharing;
mod stiffness;
pub mod thermal;
mod train;

pub use ball::{BallInGrooves, Flanks, FourContacts};
pub use bodies::{Bar, Ring};
pub use equilibrium::{Equilibrium, Freedom, NutError, Support};
pub use friction::{FreeMotion, FrictionSum, NutFriction};
pub use geometry::{BallNut, BallPosition, Circuit, Errors, LeadError};
pub use life::TurnRatings;
pub use preload::Preload;
pub use sharing::Equal;
pub use train::{
    Advance, BallAdvance, BallOfTrain, CircuitAdvance, CircuitTrain, Exit, ExitPush, LARGEST_PUSH,
    Rolling, Train, TrainError, TrainInputs,
};
