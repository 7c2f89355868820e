//! Design of ball screws, in SI units. The crate calculates ratings, stiffness, mass and life of a
//! nut, generates a catalog of all nuts with standard sizes, selects a screw that meets a
//! requirement, checks the design rules of an axis, and estimates the groove from a catalog row.
//!
//! The types of a nut, its screw and its axis, and the types of a selection are at the root of the
//! crate. The modules contain the parts of a calculation: [`drive`], [`motion`], [`life`], [`shaft`],
//! [`groove`], [`catalog`], [`search`] and [`statistics`].
//!
//! Theory: `docs/theory/11-ratings.md`, `15-design.md`, `18-axis.md` and
//! `21-groove-from-ratings.md`.
//!
//! This example uses a nut from the tables of Sobolewski (2002), which state a dynamic load rating
//! of 103 546 N:
//!
//! ```
//! use std::f64::consts::PI;
//!
//! use bsm_design::Nut;
//! use bsm_dyn::{Conformities, Material, Materials};
//!
//! let steel = Material { youngs_modulus: 206e9, poisson_ratio: 0.3 };
//! let nut = Nut {
//!     ball_diameter: 10e-3,
//!     pitch_diameter: 63.35e-3,
//!     lead: 20e-3,
//!     contact_angle: PI / 4.0,
//!     conformity: Conformities::alike(0.55),
//!     material: Materials::alike(steel),
//!     starts: 1.0,
//!     balls_per_turn: 16.0,
//!     turns: 6.0,
//! };
//! assert!((nut.dynamic_rating().rating - 103_546.0).abs() < 1.0);
//! ```

mod axis;
mod body;
mod bounds;
pub mod catalog;
pub mod drive;
mod grade;
pub mod groove;
mod least_squares;
pub mod life;
mod make;
mod modified;
pub mod motion;
mod nut;
mod phase_point;
mod preload;
mod procedure;
mod requirement;
mod runs;
mod screw;
pub mod search;
pub mod shaft;
mod standard;
pub mod statistics;
mod stiffness;
mod thread;

pub use axis::{Axis, Mount};
pub use body::{NutBody, NutSet};
pub use bounds::{Bounds, Range};
pub use grade::Grade;
pub use make::Make;
pub use nut::{DynamicRating, Nut, StaticRating, turn_length};
pub use preload::{PRELOAD_CLASSES, PreloadClass, PreloadMethod, PreloadSize, least_preload};
pub use procedure::{ActiveLimit, BindingLimit, Infeasibility, Outcome, RejectedDesigns};
pub use requirement::{
    AcceptedBy, Check, Design, DesignQuantity, EfficiencyOf, FixedValues, LoadCase, MotorLimit,
    Objective, Pitch, Ranges, Rejection, Requirement, Travel,
};
pub use screw::{Efficiency, Screw, StiffnessAt};
pub use stiffness::{Elasticity, in_series};
pub use thread::{Profile, Thread};

/// Default preload of a nut pair, divided by the dynamic load rating (Sobolewski 2002, eq. 6). A
/// larger preload causes a warning (D22).
pub const PRELOAD: f64 = 0.15;

/// Largest permitted load on a preloaded pair, divided by its preload (D23) (Sobolewski 2002, eq.
/// 8).
pub const LIMIT_LOAD: f64 = 3.0;

/// Default lever arm of the rolling resistance \[m\] (Sobolewski 2002).
pub const ROLLING_LEVER: f64 = 5e-6;
