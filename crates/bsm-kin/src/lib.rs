//! Kinematics of the balls in a ball screw: helix, reference frames, contact points, slip and spin.
//!
//! Inputs and results are in SI units and radians, but the formulas hold in any consistent system
//! of units. For example, the models of `bsm-dyn` divide lengths by the ball radius and speeds by
//! the relative speed. Every formula is generic over [`Scalar`], so that the same code calculates
//! values and exact derivatives. The crate does not deal with forces, iterations or files.
//!
//! Theory: `docs/theory/01-kinematics.md`, equations (K1) to (K15).

mod contact;
mod frame;
mod helix;
mod jet;
mod motion;
mod real;
mod root;
mod scalar;

pub use contact::{Contact, Site};
pub use frame::BallFrame;
pub use helix::{FrenetFrame, Helix};
pub use jet::Jet;
pub use motion::{ContactMotion, Drive, Motion, relative_rotation, spin_at_nut};
pub use real::{Real, RealOver};
pub use scalar::{Over, Scalar};
