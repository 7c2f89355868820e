//! Steady motion of the balls of a ball screw: contact laws, balance and models.
//!
//! The crate uses SI units and radians throughout. It contains no files, threads or random numbers.
//! A [`Problem`] is one operating point with the inputs of one model. [`Problem::solve`] returns a
//! [`Solution`], even if the point has no solution.
//!
//! Theory: `docs/theory`, chapters 02 to 10, 12 to 14 and 17.
//!
//! The feed drive of `examples/feed_drive.json` has rolling balls and an efficiency of 98.6 %:
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

mod contact;
mod cost;
mod ellipse;
#[cfg(test)]
#[path = "tests/extreme.rs"]
mod extreme;
mod models;
mod outcome;

pub use self::contact::{
    Angles, Axes, Ball, BaseOil, ContactFilm, Coulomb, Curvatures, EntryStep, FilmState,
    FrictionLaw, Groove, Hertz, Load, Losses, Lubricant, Material, MixedFriction, Oil, OilState,
    Optimum, OutsidePower, Power, Raceway, Regime, Roughness, Sines, Temperature, Transition,
    VISCOSITY_GRADES, Wedge, ZERO_CELSIUS, apex_thrust, centrifugal_force, contact_modulus,
    flat_stiffness, impact_force, linear_impact_force, step_thrust, track_friction, viscous_drag,
};
pub use self::cost::{Cost, cost_of};
pub use self::ellipse::{EllipseSlip, Quadrature, pressed_radius};
pub use self::models::{
    Alternatives, ArchFit, Auto, AxialCondition, BallState, Basis, Choice, ClosedForm, ContactSite,
    ContactState, ControllingRaceway, DrivenBody, Elastic, ElasticPoint, ElasticWorkspace,
    ErrorBound, FLANKS, FarFlank, FlankApproach, FlankContact, GothicBall, GothicPair, GothicState,
    GothicWorkspace, GrooveForces, Grooves, HertzContact, LossInterval, LubricatedArch,
    LubricatedBall, LubricatedModel, Model, ModelWorkspace, OperatingPoint, Performance,
    PermanentSet, Problem, QuasiStatic, ROLLING_BELOW, RacewayControl, RacewayFriction,
    RacewayWorkspace, Rigid, RigidRoot, RigidWorkspace, RunningPair, ScrewSize, SkidNumbers,
    Sliding, Slip, SlipPower, SlipRegime, Solution, SolveInfo, StaticBall, SteadyBall, SteadyState,
    ThirdContact, Traction, TractionWorkspace, TrainBall, TrainMotion, Transmission, TwoContacts,
    rim_speed, rolling_tangent, yield_ratio,
};
pub use self::outcome::{Control, Direction, DrivenPart, Evidence, NoAnswer, Reason, Status};

/// Equations that kernels use to solve the same models for many points, and that benchmarks and
/// validation time and compare. They are not part of the API, because another implementation would
/// not have them.
#[doc(hidden)]
pub mod internals {
    pub use crate::contact::{BallOrbit, efficiency, ideal_torque, torque_of};
    pub use crate::ellipse::{Patch, lubricated_powers, power_of_many};
    pub use crate::models::{
        AnswerUnits, BallContacts, EhlPoint, EhlUnits, ElasticMotion, FilmLoss, FirstOrder,
        GrooveContact, LoadedContact, LubricatedWorkspace, ModelErrors, Plane, RigidBall,
        RigidMotion, ScaledBall, ScaledFilm, ScaledSize, SlidingBall, SlidingMotion, SlidingRoot,
        SlidingState, StaticBalance, StaticState, Sweeps, cross_slip, friction_angle,
        friction_power, onset_number, rolling, rolling_torque, skid_number, spread_of_control,
        takes, transmitted, turns,
    };
    pub use crate::models::{RigidSystem, Unknowns as RigidUnknowns};
}
