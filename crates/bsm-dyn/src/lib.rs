//! Steady motion of the balls in a ball screw: contact laws, force balance and models.
//!
//! The crate uses SI units and radians throughout. It does not use files, threads or random
//! numbers. A [`Problem`] is one operating point with the inputs of one model. [`Problem::solve`]
//! always returns a [`Solution`]. If there is no steady motion, the solution contains the reason.
//!
//! Theory: `docs/theory`, chapters 02 to 10, 12 to 14 and 17.
//!
//! In the feed drive of `examples/feed_drive.json`, the balls roll, and the efficiency is 98.6 %:
//!
//! ```
//! use std::f64::consts::PI;
//!
//! use bsm_dyn::{
//!     Ball, Conformities, Coulomb, ElasticPoint, Load, Material, Materials, ModelWorkspace,
//!     OperatingPoint, Problem, model::RacewayControl,
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
//! let (conformity, material) = (Conformities::alike(0.53), Materials::alike(steel));
//! let screw = ElasticPoint { point, conformity, material };
//! let problem = Problem::RacewayControl(RacewayControl { screw, control: None });
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

pub use self::contact::{Ball, Conformities, Coulomb, Load, Material, Materials};
pub use self::cost::{Cost, cost_of};
pub use self::models::{
    ElasticPoint, Model, ModelWorkspace, OperatingPoint, Problem, Solution, SteadyState,
};
pub use self::outcome::{Control, Direction, DrivenPart, Evidence, Reason, SolveFailure, Status};

/// Closed-form relations between lead angle, contact angle, friction and efficiency.
pub mod angles {
    pub use crate::contact::{Angles, Optimum, Sines};
}

/// Hertz contacts between ball and groove, and the slip in the contact ellipses.
pub mod hertz {
    pub use crate::contact::{
        Axes, Curvatures, Groove, Hertz, Raceway, contact_modulus, flat_stiffness,
    };
    pub use crate::ellipse::{EllipseSlip, Quadrature, pressed_radius};
    pub use crate::models::{HertzContact, yield_ratio};
}

/// Friction of lubricated contacts with an oil or a grease: viscosity, films, mixed friction and
/// temperature.
pub mod lubrication {
    pub use crate::contact::{
        BaseOil, ContactFilm, FilmState, FrictionLaw, Losses, Lubricant, MixedFriction, Oil,
        OilState, OutsidePower, Regime, Roughness, Temperature, Transition, VISCOSITY_GRADES,
        ZERO_CELSIUS, viscous_drag,
    };
    pub use crate::models::{LubricatedArch, LubricatedBall, LubricatedModel};
}

/// The models of a ball, each with its inputs and its reusable buffers. A [`Problem`] selects one
/// of the models at run time.
pub mod model {
    pub use crate::contact::centrifugal_force;
    pub use crate::models::{
        Auto, Basis, Choice, ClosedForm, Elastic, ElasticWorkspace, ErrorBound, LossInterval,
        MAX_ROLLING_ONSET, PermanentSet, QuasiStatic, RacewayControl, RacewayFriction,
        RacewayWorkspace, Rigid, RigidRoot, RigidSystem, RigidWorkspace, Sliding, StaticBall,
        Traction, TractionWorkspace, Unknowns as RigidUnknowns,
    };
}

/// Balls in gothic arches, which may touch two, three or four flanks.
pub mod gothic {
    pub use crate::models::{
        ArchFit, AxialCondition, FLANKS, FarFlank, FlankApproach, FlankContact, GothicBall,
        GothicPair, GothicState, GothicWorkspace, GrooveForces, Grooves, RunningPair, ThirdContact,
        TwoContacts,
    };
}

/// Components of a [`Solution`]: motion and contacts of the ball, transmission, skid numbers and
/// slip.
pub mod solution {
    pub use crate::contact::Power;
    pub use crate::models::{
        Alternatives, BallState, ContactSite, ContactState, ControllingRaceway, DrivenBody,
        Performance, ScrewSize, SkidNumbers, Slip, SlipPower, SlipRegime, SolveInfo, SteadyBall,
        Transmission, rim_speed, rolling_tangent,
    };
}

/// Balls in a ball train that push against each other, and their motion into the ball return.
pub mod train {
    pub use crate::contact::{
        EntryStep, Wedge, apex_thrust, impact_force, linear_impact_force, step_thrust,
        track_friction,
    };
    pub use crate::models::{TrainBall, TrainMotion};
}

/// Balls in scaled units, for one operating point or for several points side by side in a SIMD
/// vector.
///
/// These types are generic over [`Real`](bsm_kin::Real). The models use them for a single point, and
/// numerical kernels use them to solve many points at once. Lengths are divided by the ball radius,
/// forces by the axial load per ball, and speeds by the relative speed, unless the documentation
/// states a unit.
pub mod lanes {
    pub use crate::contact::{BallOrbit, ideal_torque};
    pub use crate::ellipse::{Patch, lubricated_powers, power_of_many};
    pub use crate::models::{
        BallContacts, EhlPoint, EhlUnits, ElasticMotion, FilmLoss, FirstOrder, FixedPoint,
        GrooveContact, LoadedContact, LubricatedScrew, ModelErrors, Plane, RacewayBall,
        ResultUnits, RigidBall, RigidMotion, RollingMotion, RollingRoot, ScaledBall, ScaledFilm,
        ScaledSize, SlidingBall, SlidingMotion, SlidingRoot, SlidingState, friction_angle,
        friction_power, onset_number, rolling_torque, transmitted,
    };
}
