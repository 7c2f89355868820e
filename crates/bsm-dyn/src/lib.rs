//! Steady motion of the balls of a ball screw: contact laws, balance and models.
//!
//! SI units and radians throughout; no files, no threads, no random numbers. A [`Problem`] is one
//! operating point with the inputs of one model; [`Problem::solve`] returns a [`Solution`], which
//! is data also when there is none.
//!
//! Theory: `docs/theory`, chapters 02 to 10 and 12 to 14.

mod auto;
pub mod balance;
mod ball_unknowns;
mod closed_form;
mod continuation;
mod cost;
mod coulomb;
mod elastic;
mod elastic_ball;
mod ellipse;
mod equations;
#[cfg(test)]
mod extreme;
mod hertz;
mod jam;
mod jones;
mod model;
mod permanent_set;
mod quasi_static;
mod raceway_control;
mod rigid;
mod sensitivity;
mod slip;
mod solution;
mod state;
mod traction;

pub use auto::{Auto, Basis, Choice, GRIPS_BELOW, SlipRegime};
pub use balance::{Ball, Load, POWER_BALANCE_TOL, Wrench};
pub use closed_form::{Angles, ClosedForm, Optimum, Size};
pub use coulomb::friction_force;
pub use elastic::{Elastic, ElasticWorkspace};
pub use elastic_ball::ElasticScrew;
pub use ellipse::{Ellipse, Quadrature, pressed_radius};
pub use hertz::{Curvatures, Groove, Hertz, Material, Member, contact_modulus};
pub use jam::{
    Wedge, apex_thrust, available_friction, centrifugal_force, flat_stiffness, impact_force,
    step_thrust, viscous_drag,
};
pub use jones::{Deformed, Displacement, Jones, Side};
pub use model::{Model, ModelWorkspace, Problem};
pub use permanent_set::{FIRST_YIELD, PermanentSet, yield_ratio};
pub use quasi_static::{Driven, QuasiStatic};
pub use raceway_control::{Control, RacewayControl, RacewayWorkspace};
pub use rigid::{
    FirstOrder, MODERATE_INERTIA, Rigid, RigidRoot, RigidSystem, RigidUnknowns, RigidWorkspace,
    SEARCHED_FROM, UNIQUE_BELOW,
};
pub use sensitivity::Transmitted;
pub use slip::{FrictionLaw, SlipPower, SteadyBall, Touch, rim_speed};
pub use solution::{Direction, Evidence, Reason, Solution, Status, Unsolved};
pub use state::{
    BallState, ContactState, Others, Pressed, RaceControl, SkidNumbers, Slip, SolveInfo, Solved,
    Transmission,
};
pub use traction::{Traction, TractionWorkspace};
