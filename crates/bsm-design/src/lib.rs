//! Design of ball screws, in SI units. The crate calculates ratings, stiffness, mass and life of a
//! nut, generates a catalog of all nuts with standard sizes, selects a screw that meets a
//! requirement, checks the design rules of an axis, and estimates the groove from a catalog row.
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
mod catalog;
mod drive;
mod grade;
mod groove_estimate;
mod least_squares;
mod life;
mod make;
mod modified;
mod motion;
mod nut;
mod preload;
mod procedure;
mod requirement;
mod runs;
mod screw;
pub mod search;
mod shaft;
mod standard;
mod statistics;
mod stiffness;
mod thread;

pub use axis::{Axis, Mount};
pub use body::{NutBody, NutSet};
pub use bounds::{Bounds, Range};
pub use catalog::{BALL_GAP, Candidate, Limits, Lists, OfferedSize, Size, front, loaded_balls};
pub use drive::{
    BRAKE_SAFETY, BackDrivenScrew, BackDriving, DriveTrain, MachineTable, MotorCurve, MotorPoint,
    drag_torque, least_acceleration_time, rod_inertia, rod_mass_per_length, stopping_distance,
};
pub use grade::Grade;
pub use groove_estimate::{
    BallProbability, BallReturn, Band, CatalogLine, CatalogMistake, DRAWS, EstimatedGroove,
    FEW_DRAWS, GrooveEstimate, Hypothesis, KnownGroove, MIN_EVIDENCE, Prior, RejectedRow,
    UNUSUAL_EVIDENCE, on_all_cores, quasi_random_besides_groove,
};
pub use least_squares::{LeastSquares, least_squares};
pub use life::{
    Duty, Life, RatingBasis, RequiredLife, UNLOADING_RATIO, life, modified_life, pair_loads,
    reliability_factor,
};
pub use make::Make;
pub use modified::{
    Contamination, Hardness, RatingFactors, life_factor, usual_fatigue_limit, viscosity_ratio,
    viscosity_ratio_by_film,
};
pub use motion::{
    CycleTravel, DutySpeed, Move, Phase, PhaseMeans, PhasePoint, ProfileSegment, phases,
    speed_jumps,
};
pub use nut::{DynamicRating, Nut, StaticRating, turn_length};
pub use preload::{PRELOAD_CLASSES, PreloadClass, PreloadMethod, PreloadSize, least_preload};
pub use procedure::{ActiveLimit, BindingLimit, Infeasibility, Outcome, RejectedDesigns};
pub use requirement::{
    AcceptedBy, Check, Design, DesignQuantity, EfficiencyOf, FixedValues, LoadCase, MotorLimit,
    Objective, Pitch, Ranges, Rejection, Requirement, Travel,
};
pub use runs::SignRuns;
pub use screw::{Efficiency, Screw, StiffnessAt};
pub use shaft::{
    BUCKLING_SAFETY, Bore, BucklingSection, CRITICAL_SPEED_RATIO, EndFixity, PERMITTED_STRESS,
    Shaft, lost_motion, natural_frequency, steady_rise, warming_time,
};
pub use statistics::quantile;
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
