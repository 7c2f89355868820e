//! Load ratings and rigidity of ball screw nuts, SI units.
//!
//! Theory: `docs/theory/11-ratings.md`.

mod nut;

pub use nut::{Body, Nut};
