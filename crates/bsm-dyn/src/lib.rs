//! Steady motion of the balls of a ball screw: contact laws, balance and models.
//!
//! SI units and radians throughout; no files, no threads, no random numbers. A [`Problem`] is one
//! operating point with the inputs of one model; [`Problem::solve`] returns a [`Solution`], which
//! is data also when there is none.
//!
//! Theory: `docs/theory`, chapters 02 to 10, 12 to 14 and 17.
//!
//! The feed drive of `examples/feed_drive.json`, whose balls roll: 98.6 % efficiency.
//!
//! ```
//! use std::f64::consts::PI;
//!
//! use bsm_dyn::{
//!     Ball, Coulomb, ElasticPoint, Load, Material, ModelWorkspace, OperatingPoint, Problem,
//!     RacewayControl,
//! };
//! use bsm_kin::{Drive, Helix, Site};
//!
//! let (radius, lead) = (20.75e-3, 20e-3);
//! let steel = Material { youngs_modulus: 207e9, poisson_ratio: 0.3 };
//! let point = OperatingPoint {
//!     helix: Helix { radius, lead_angle: f64::atan2(lead, 2.0 * PI * radius) },
//!     contact_angle: PI / 4.0,
//!     ball: Ball::of_density(3.175e-3, 7800.0),
//!     friction: Coulomb(0.06),
//!     drive: Drive { screw_speed: 50.0 * PI, nut_speed: 0.0 },
//!     load: Load { axial: 8000.0, balls: 70.0 },
//! };
//! let at = ElasticPoint { point, conformity: (0.53, 0.53), material: (steel, steel) };
//! let problem = Problem::RacewayControl(RacewayControl { at, control: None });
//! let solution = problem.solve(&mut ModelWorkspace::default());
//!
//! let nut = solution.contact(Site::Nut).expect("a solution");
//! assert!((solution.efficiency().expect("a solution") - 0.98592).abs() < 1e-5);
//! assert!((nut.load.expect("a load") - 160.36).abs() < 0.01);
//! ```

pub mod contact;
mod cost;
pub mod ellipse;
#[cfg(test)]
#[path = "tests/extreme.rs"]
mod extreme;
pub mod models;
mod outcome;

pub use self::contact::*;
pub use self::cost::evaluations;
pub use self::ellipse::*;
pub use self::models::*;
