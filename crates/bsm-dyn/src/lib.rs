//! Steady motion of the balls of a ball screw: contact laws, balance and models.
//!
//! SI units and radians throughout; no files, no threads, no random numbers. A [`Problem`] is one
//! operating point with the inputs of one model; [`Problem::solve`] returns a [`Solution`], which
//! is data also when there is none.
//!
//! Theory: `docs/theory`, chapters 02 to 10, 12 to 14 and 17.
//!
//! The feed drive of `examples/feed_drive.json`, whose balls grip: 98.6 % efficiency.
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

mod auto;
pub mod balance;
mod ball_contacts;
mod ball_unknowns;
mod closed_form;
mod cost;
mod elastic;
mod elastic_ball;
mod ellipse;
mod equations;
#[cfg(test)]
mod extreme;
mod friction;
mod held_ball;
mod hertz;
mod jam;
mod jones;
mod lubricant;
mod model;
mod operating_point;
mod permanent_set;
mod pressed_ball;
mod quasi_static;
mod raceway_control;
mod rigid;
mod sensitivity;
mod slip;
mod solution;
mod state;
mod traction;

pub use auto::{Auto, Basis, Choice, GRIPS_BELOW, SlipRegime};
pub use balance::{Ball, Load, POWER_BALANCE_TOL, Wrench, friction_torque};
pub use ball_contacts::{BallContacts, GrooveContact, LoadedContact, ScaledSize, friction_power};
pub use closed_form::{Angles, ClosedForm, Optimum, Sines, Size};
pub use elastic::{
    Elastic, ElasticWorkspace, SlidingBall, SlidingMotion, SlidingRoot, SlidingRotation,
    SlidingState,
};
pub use elastic_ball::ElasticPoint;
pub use ellipse::{Bend, Ellipse, EllipseSlip, Quadrature, power_of_many, pressed_radius};
pub use friction::{Coulomb, FrictionLaw, friction_force};
pub use held_ball::{HeldBall, HeldContact, HeldMotion};
pub use hertz::{Axes, Curvatures, Groove, Hertz, Material, Member, contact_modulus, max_pressure};
pub use jam::{
    EntryStep, Wedge, apex_thrust, centrifugal_force, flat_stiffness, impact_force,
    linear_impact_force, step_thrust, track_friction, viscous_drag,
};
pub use jones::{Deformed, Displacement, Jones, Side, axial_displacement};
pub use lubricant::{
    Band, BaseOil, Circling, ContactFilm, FilmState, Losses, Lubricant, Lubricated,
    LubricatedModel, LubricatedWorkspace, MixedFriction, Oil, OutsidePower, RacewayFriction,
    Regime, Roughness, ScaledFilm, Temperature, VISCOSITY_GRADES, WarmOil, Wetted, WettedUnits,
    ZERO_CELSIUS, catalogue_friction, film_heating,
};
pub use model::{Model, ModelWorkspace, Problem};
pub use operating_point::{OperatingPoint, takes};
pub use permanent_set::{PermanentSet, yield_ratio};
pub use pressed_ball::{PressedBall, Pressing};
pub use quasi_static::{Driven, QuasiStatic, TwoContacts, rolling_tangent};
pub use raceway_control::{
    Control, RacewayControl, RacewayWorkspace, StaticBalance, StaticState, cross_slip,
    excess_of_nut, rolling, rolling_torque, skid_number, spread_of_control,
};
pub use rigid::{
    FirstOrder, Plane, Rigid, RigidBall, RigidMotion, RigidRoot, RigidWorkspace, Sweeps,
};
pub use sensitivity::Transmitted;
pub use slip::{Sliding, SlipPower, SteadyBall, Touch, rim_speed};
pub use solution::{Direction, Evidence, Reason, Solution, Status, Unsolved};
pub use state::{
    BallState, ContactState, ErrorBound, MOST_LOSS_ERROR, Others, Pressed, RaceControl,
    SkidNumbers, Slip, SolveInfo, Solved, Transmission, friction_angle, loss_error, onset_number,
    quadrature_error,
};
pub use traction::{
    FAST_NUT, FOUND as TRACTION_FOUND, SKIDS, START as TRACTION_START, Scaled, Traction,
    TractionMany, TractionRoot, TractionStart, TractionWorkspace, slip_scale,
};

/// Equations that are timed and compared from outside, by `benches` and by its peers in other
/// languages. No part of the API: another way to solve would not have them.
#[doc(hidden)]
pub mod inside {
    pub use crate::rigid::{RigidSystem, Unknowns as RigidUnknowns};
}
