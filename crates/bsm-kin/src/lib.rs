//! Kinematics of the ball in a ball screw: helix, frames, contact points, slip and spin.
//!
//! SI units and radians; every formula is generic over [`Scalar`], so that the same code gives
//! values and exact derivatives. The crate knows no forces, no iteration and no files. The
//! formulas hold in any consistent set of units: the models of `bsm-dyn` call them with lengths
//! in ball radii and speeds in units of the relative speed.
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
