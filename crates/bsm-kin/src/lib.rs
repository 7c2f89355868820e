//! Kinematics of the balls in a ball screw: helix, reference frames, contact points, slip and spin.
//!
//! Inputs and results are in SI units and radians, but the formulas hold in any consistent system
//! of units. For example, the models of `bsm-dyn` divide lengths by the ball radius and speeds by
//! the relative speed. Every formula is generic over [`Scalar`], so that the same code calculates
//! values and exact derivatives. The crate does not deal with forces, iterations or files.
//!
//! Theory: `docs/theory/01-kinematics.md`, equations (K1) to (K15). To solve for the motion of the
//! balls at an operating point, see [`bsm_dyn`](../bsm_dyn/index.html).
//!
//! In this example, the screw turns at 100 rad/s and the nut stands still. A ball that precesses at
//! half the speed of the screw moves against the nut as fast as the screw moves against the ball:
//!
//! ```
//! use bsm_kin::{BallFrame, Drive, Helix, Motion};
//!
//! let helix = Helix { radius: 20.75e-3, lead_angle: 0.15 };
//! let drive = Drive { screw_speed: 100.0, nut_speed: 0.0 };
//! let frame = BallFrame::turned(helix.lead_angle, 0.0);
//!
//! // Precession rate and angular velocity along t, n and b [rad/s].
//! let ball = Motion::new(0.5 * drive.relative_speed(), [0.0, 0.0, -300.0]);
//! let to_nut = ball.relative_to(drive.nut_speed, &frame);
//! let to_screw = ball.relative_to(drive.screw_speed, &frame);
//! assert_eq!(to_nut.precession, -to_screw.precession);
//!
//! // Speed of the ball center along the helix, relative to the nut [m/s].
//! let speed: f64 = to_nut.precession * helix.arc_length_per_radian();
//! assert!((speed - 1.0493).abs() < 1e-4);
//! ```

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
