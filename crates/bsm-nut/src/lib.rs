//! Calculations that include every ball of a ball nut: load sharing, stiffness, remaining preload
//! and life (all static and without friction), friction torques, ball trains, and the temperatures
//! in the warm steady state.
//!
//! Theory: `docs/theory/16-nut.md`, equations (U1) to (U35).
//!
//! The modules [`friction`], [`train`] and [`thermal`] calculate friction, ball trains and the warm
//! state. Theory of ball trains: `docs/theory/20-ball-train.md`. Theory of the warm state:
//! `docs/theory/19-warm-state.md`.
//!
//! A [`BallNut`] describes the geometry: circuits of balls on the helix, elastic bodies and
//! manufacturing errors. [`BallNut::solve`] calculates the equilibrium for a [`Support`], which
//! contains the load and the constraints by the guides.
//!
//! In this example, a rigid, guided nut has 70 balls, which share a load of 8 kN equally:
//!
//! ```
//! use std::f64::consts::PI;
//!
//! use bsm_dyn::{Ball, Conformities, Material, Materials};
//! use bsm_kin::Helix;
//! use bsm_nut::{BallNut, Circuit, Errors, Flanks, Support};
//!
//! let (radius, lead) = (20.75e-3, 20e-3);
//! let steel = Material { youngs_modulus: 207e9, poisson_ratio: 0.3 };
//! let nut = BallNut {
//!     helix: Helix { radius, lead_angle: f64::atan2(lead, 2.0 * PI * radius) },
//!     starts: 1,
//!     ball: Ball::of_density(3.175e-3, 7800.0),
//!     contact_angle: PI / 4.0,
//!     conformity: Conformities::alike(0.53),
//!     material: Materials::alike(steel),
//!     circuits: vec![Circuit {
//!         start: 0.0,
//!         arc: 7.0 * PI,
//!         balls: 70,
//!         thread: 0,
//!         body: 0,
//!         flanks: Flanks::Both,
//!         offset: 0.0,
//!     }],
//!     errors: Errors::default(),
//!     nut_bar: None,
//!     screw_bar: None,
//!     ring: None,
//!     reference: None,
//!     precession: 0.0,
//! };
//! let found = nut.solve(&Support::guided(8000.0))?;
//! let share = nut.equal(8000.0)?;
//! // Both solutions satisfy the balance of forces to 1e-12.
//! assert!(found.balls.iter().all(|ball| (ball.max_load() / share.load - 1.0).abs() < 1e-11));
//! // Z Q sin(beta) cos(alpha) = F at the contact angle under load.
//! let axial = 70.0 * share.load * share.angle.sin() * nut.helix.lead_angle.cos();
//! assert!((axial / 8000.0 - 1.0).abs() < 1e-11);
//! # Ok::<(), bsm_nut::NutError>(())
//! ```

mod assembly;
mod ball;
mod bodies;
mod equilibrium;
pub mod friction;
mod geometry;
mod interpolation;
mod life;
mod preload;
mod search;
mod sharing;
mod stiffness;
pub mod thermal;
pub mod train;

pub use ball::{BallInGrooves, Flanks, FourContacts};
pub use bodies::{Bar, Ring};
pub use equilibrium::{Equilibrium, Freedom, NutError, Support};
pub use geometry::{BallNut, BallPosition, Circuit, Errors, LeadError};
pub use life::TurnRatings;
pub use preload::PreloadKind;
pub use sharing::EqualShare;
