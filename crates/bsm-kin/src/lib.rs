//! Kinematics of the ball in a ball screw: helix, frames, contact points, slip and spin.
//!
//! All quantities are in SI units and radians. Every formula is generic over [`Scalar`], so that
//! the same code calculates values and exact derivatives. The crate knows nothing about forces,
//! iterations and files. The formulas hold in any consistent system of units: the models of
//! `bsm-dyn` use lengths divided by the ball radius and speeds divided by the relative speed.
//!
//! Theory: `docs/theory/01-kinematics.md`, equations (K1) to (K15).

mod contact;
mod field;
mod frame;
mod helix;
mod jet;
mod motion;
mod root;
mod scalar;

pub use contact::{Contact, Site};
pub use field::{Field, FieldOver};
pub use frame::BallFrame;
pub use helix::{FrenetFrame, Helix};
pub use jet::Jet;
pub use motion::{ContactMotion, Drive, Motion, relative_rotation, spin_at_nut};
pub use scalar::{Over, Scalar};
