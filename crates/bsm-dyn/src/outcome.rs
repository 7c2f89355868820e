//! Outcome of a solve: a solution, or the reason why there is none.

use std::error::Error;
use std::fmt;

use bsm_newton::{EvalError, Report, Termination};

/// Declares an enum whose variants have names that are used in files and on the command line.
macro_rules! named {
    (
        $(#[$about:meta])*
        pub enum $kind:ident { $($(#[$of:meta])* $variant:ident = $name:literal,)* }
    ) => {
        $(#[$about])*
        pub enum $kind { $($(#[$of])* $variant,)* }

        impl $kind {
            /// All variants in declaration order.
            pub const ALL: [Self; [$($name),*].len()] = [$(Self::$variant),*];

            /// Returns the name that is used in files and on the command line.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }

            /// Returns the variant with the given name, or `None` if no variant has this name.
            pub fn from_name(name: &str) -> Option<Self> {
                Self::ALL.into_iter().find(|variant| variant.name() == name)
            }
        }
    };
}
pub(crate) use named;

named! {
    /// The controlling raceway, on which the ball does not spin.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Control {
        /// The raceway on the nut.
        Nut = "nut",
        /// The raceway on the screw.
        Screw = "screw",
    }
}

/// The part of a screw drive that the motor rotates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DrivenPart {
    /// The screw rotates, and the nut travels.
    Screw,
    /// The nut rotates and travels; the screw is at rest.
    Nut,
}

/// Direction of the power flow: the side (rotary or linear) that drives the other side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// The drive moves the load, `$W > 0$`.
    RotaryToLinear,
    /// The load drives the screw or the nut (back-driving), `$W < 0$`.
    LinearToRotary,
}

impl Direction {
    /// Returns the direction of the power flow for a relative speed `$W = \Omega_s - \Omega_n$`, or
    /// `None` if the speed is 0 or NaN.
    pub fn of(relative_speed: f64) -> Option<Self> {
        if relative_speed > 0.0 {
            Some(Self::RotaryToLinear)
        } else if relative_speed < 0.0 {
            Some(Self::LinearToRotary)
        } else {
            None
        }
    }

    /// Returns the sign of the relative speed, 1 or -1.
    pub fn sign(self) -> f64 {
        match self {
            Self::RotaryToLinear => 1.0,
            Self::LinearToRotary => -1.0,
        }
    }

    /// Returns true if the load back-drives the screw.
    pub fn is_back(self) -> bool {
        self == Self::LinearToRotary
    }
}

named! {
    /// Status of a solve.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Status {
        /// The solve converged, and the outputs are valid.
        Converged = "converged",
        /// No solution exists; [`Evidence`] states how certain this is.
        NoSolution = "no_solution",
        /// The solver found no solution, but a solution may exist.
        NotConverged = "not_converged",
        /// The model does not accept these inputs.
        InvalidInput = "invalid_input",
    }
}

/// Reason why a model has no solution.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Reason {
    /// `$\sin\beta \le f D$`: friction alone can hold any axial load, so the drive cannot turn.
    SelfLocking {
        /// Sine of the contact angle, `$\sin\beta$`.
        sin_contact_angle: f64,
        /// Friction term `$f D$`, which is at least `$\sin\beta$`.
        friction_term: f64,
    },
    /// The quasi-static force balance requires a normal load that is zero or negative, because
    /// friction alone can hold any axial load.
    FrictionHoldsLoad {
        /// Ratio of the normal load to the axial load per ball.
        load_ratio: f64,
    },
    /// With saturated friction, the slip at contact A (loaded flank of the nut) would have to be
    /// negative. The ball rolls on the nut instead, which the equations of the model do not cover.
    NutContactWouldRoll {
        /// Slip speed at contact A along the friction direction of this contact, divided by
        /// `$r_b|W|$`; zero or negative.
        slip: f64,
        /// True if `slip` satisfies the sliding equations, which are continued beyond the point at
        /// which the ball rolls. False if `slip` is the first-order value.
        exact: bool,
    },
    /// The contact on the unloaded flank of the nut (A') would have to act in tension.
    UnloadedFlankWouldPull {
        /// Load ratio `$Q_{A'}/F_a$`; zero or negative.
        load_ratio: f64,
    },
    /// A loaded contact would have to act in tension.
    LoadedContactWouldPull {
        /// Load ratio `$Q_A/F_a$` at the nut.
        nut_load_ratio: f64,
        /// Load ratio `$Q_B/F_a$` at the screw.
        screw_load_ratio: f64,
    },
    /// The branch of steady motions that begins at zero inertia does not reach the inertia ratio of
    /// this operating point.
    NoRootAtInertia {
        /// Inertia ratio `$m r_m W^2/F_a$`.
        inertia_ratio: f64,
        /// Nearest inertia ratio at which there is a steady motion on the branch, with all other
        /// inputs unchanged.
        nearest_ratio: f64,
    },
    /// A contact angle is not between 0 and 90 degrees. With the status `no_solution`, the angles
    /// belong either to the first root or to the end of a path on which no root has both angles in
    /// this range. No other root is known.
    BallLeavesFlank {
        /// Contact angle at the nut \[rad\].
        nut: f64,
        /// Contact angle at the screw \[rad\].
        screw: f64,
    },
    /// The flanks cannot hold the centrifugal force of the rolling ball for any contact angles
    /// between 0 and 90 degrees.
    FlanksCannotHold {
        /// The controlling raceway.
        control: Control,
        /// Ratio of the centrifugal force that the flanks can hold to the axial load. The force is
        /// evaluated at a contact angle of 90 degrees at the screw.
        max_force_ratio: f64,
        /// Ratio of the centrifugal force to the axial load. The force is evaluated at a contact
        /// angle of 90 degrees at the screw.
        force_ratio: f64,
    },
    /// Wherever the forces are in equilibrium with saturated friction, friction would act in the
    /// direction of the slip instead of against it.
    SlipAlongFriction {
        /// Slip speed at the nut without inertia, divided by `$r_b|W|$`.
        slip: f64,
    },
    /// The inertia ratio is outside the range in which the ball slides on both flanks with friction
    /// opposing the slip.
    NoSkidAtInertia {
        /// Inertia ratio `$m r_m W^2/F_a$`.
        inertia_ratio: f64,
        /// Smallest inertia ratio at which the ball slides on both flanks.
        min: f64,
        /// Largest inertia ratio at which the ball slides on both flanks.
        max: f64,
    },
    /// The search failed: it found no root, but could not rule out that a root exists.
    SearchFailed,
    /// The curvatures of ball and groove do not result in a contact ellipse with its long axis
    /// across the groove.
    CurvaturesNotHertzian {
        /// Curvature along the track \[1/m\].
        longitudinal: f64,
        /// Curvature across the groove \[1/m\].
        transverse: f64,
    },
    /// The ball does not orbit around the axis (`$P = 0$`), so no gyroscopic moment balances the
    /// friction couple.
    BallDoesNotOrbit,
    /// The inertia ratio `$m r_m W^2/F_a$` is too small or too large to balance the forces in
    /// double precision. This reason is always given below 1e-100 and above 1e28.
    InertiaOutOfRange {
        /// Inertia ratio at the operating point.
        inertia_ratio: f64,
    },
    /// Without friction (`$f = 0$`), the rotation of the ball is undetermined.
    Frictionless,
    /// Nut and screw do not rotate relative to each other.
    NoRelativeSpeed,
    /// The model is valid if either the screw or the nut rotates, but not if both rotate.
    DualDrive,
    /// The root violates the power balance because of rounding errors.
    PowerDoesNotBalance {
        /// Relative error of the power balance.
        imbalance: f64,
    },
    /// At all temperatures up to a limit, the power losses exceed the heat that the lubricant
    /// transfers to its surroundings.
    LubricantRunsAway {
        /// Maximum temperature that the search considered \[K\].
        max_temperature: f64,
    },
    /// The model equations cannot be evaluated at a point where their values are needed.
    Refused {
        /// Quantity with its value, and the requirement that it violates.
        error: EvalError,
    },
    /// The Jacobian is singular at the root, so the root has no derivatives with respect to the
    /// inputs.
    SingularRoot,
    /// Newton's method did not converge.
    Newton {
        /// Reason why Newton's method ended.
        status: Termination,
        /// Scaled residual at the end of the iteration.
        residual: f64,
        /// Name of the equation with the largest residual. It is empty if the equations could not
        /// be evaluated at the starting point.
        worst_equation: String,
    },
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::SelfLocking { sin_contact_angle, friction_term } => write!(
                f,
                "the screw is self-locking: the sine of the contact angle, {sin_contact_angle:.4}, does not exceed the \
                 friction term {friction_term:.4}"
            ),
            Self::FrictionHoldsLoad { load_ratio } => write!(
                f,
                "friction holds any axial load: the normal load would be {load_ratio:.3} times the axial load per ball"
            ),
            Self::NutContactWouldRoll { slip, .. } => write!(
                f,
                "the ball would roll on the nut: the slip speed there would be {slip:.3e} times ball radius times relative speed"
            ),
            Self::UnloadedFlankWouldPull { load_ratio } => write!(
                f,
                "the contact on the far flank would have to act in tension: its normal load would be {load_ratio:.3e} \
                 times the axial load per ball"
            ),
            Self::LoadedContactWouldPull { nut_load_ratio, screw_load_ratio } => write!(
                f,
                "a loaded contact would have to act in tension: the normal loads at nut and screw would be \
                 {nut_load_ratio:.3e} and {screw_load_ratio:.3e} times the axial load per ball"
            ),
            Self::NoRootAtInertia { inertia_ratio, nearest_ratio } => write!(
                f,
                "there is no steady motion at the inertia ratio {inertia_ratio:.3e}; the nearest inertia ratio with a steady \
                 motion is {nearest_ratio:.3e}"
            ),
            Self::BallLeavesFlank { nut, screw } => write!(
                f,
                "the ball leaves its flanks: the contact angles would be {nut:.4} rad at the nut and {screw:.4} rad at the \
                 screw"
            ),
            Self::FlanksCannotHold { control, max_force_ratio, force_ratio } => write!(
                f,
                "under {} control, the flanks can hold a centrifugal force of {max_force_ratio:.3e} times the axial load, but the \
                 centrifugal force is {force_ratio:.3e} times the axial load",
                control.name()
            ),
            Self::SlipAlongFriction { slip } => write!(
                f,
                "wherever the forces balance, friction would act in the direction of slip instead of against it; the slip \
                 speed at the nut would be {slip:.3e} times ball radius times relative speed"
            ),
            Self::NoSkidAtInertia { inertia_ratio, min, max } => write!(
                f,
                "the ball slides only at inertia ratios from {min:.3e} to {max:.3e}, but the inertia ratio is \
                 {inertia_ratio:.3e}"
            ),
            Self::SearchFailed => {
                write!(f, "the search found no root, but could not rule out that a root exists")
            }
            Self::CurvaturesNotHertzian { longitudinal, transverse } => write!(
                f,
                "the curvatures {longitudinal:e} and {transverse:e} 1/m do not give a contact ellipse with its long axis \
                 across the groove"
            ),
            Self::BallDoesNotOrbit => {
                write!(f, "the ball does not orbit: its precession rate is zero")
            }
            Self::InertiaOutOfRange { inertia_ratio } => write!(
                f,
                "the inertia ratio {inertia_ratio:e} is too small or too large to balance the forces in double precision"
            ),
            Self::Frictionless => {
                write!(f, "friction is zero, so the rotation of the ball is undetermined")
            }
            Self::NoRelativeSpeed => write!(f, "nut and screw do not turn relative to each other"),
            Self::DualDrive => {
                write!(f, "both nut and screw turn, but only one of them may turn in this model")
            }
            Self::PowerDoesNotBalance { imbalance } => write!(
                f,
                "the root violates the power balance: the relative error is {imbalance:.3e}"
            ),
            Self::LubricantRunsAway { max_temperature } => {
                write!(
                    f,
                    "the lubricant heats up to more than {max_temperature:.1} K, because the power losses \
                     exceed the cooling at all temperatures up to this limit"
                )
            }
            Self::Refused { error } => error.fmt(f),
            Self::SingularRoot => write!(
                f,
                "the Jacobian is singular at the solution, so the derivatives with respect to the inputs do not exist"
            ),
            Self::Newton { status, worst_equation, .. } if worst_equation.is_empty() => {
                write!(f, "Newton's method failed: {status}")
            }
            Self::Newton { status, residual, worst_equation } => write!(
                f,
                "Newton's method failed: {status}; the residual is {residual:.3e}, and its largest component belongs to \
                 the equation {worst_equation:?}"
            ),
        }
    }
}

impl Error for Reason {}

impl From<Report> for Reason {
    /// Creates the reason from the report of a Newton solve that did not converge.
    fn from(report: Report) -> Self {
        Self::Newton {
            status: report.status,
            residual: report.residual,
            worst_equation: report.worst.map_or_else(String::new, |worst| worst.name),
        }
    }
}

/// Evidence that there is no solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Evidence {
    /// Proof from the equations of the model, up to rounding errors.
    Proof,
    /// A solution is excluded by a limit that was determined in tests at many points. This limit is
    /// either the error of the first-order solution or the boundary of the range in which several
    /// solutions exist.
    Bound,
    /// The curve of states that begins at zero inertia was followed to its end. The search may have
    /// missed two solutions within one step, or solutions on other curves.
    Traced {
        /// Longest step length along the curve, in scaled units.
        resolution: f64,
    },
    /// All lubricant temperatures up to a limit were searched in equal steps. The search may have
    /// missed two solutions within one step.
    Scanned {
        /// Step of the lubricant temperature \[K\].
        step: f64,
    },
}

impl Evidence {
    /// Names that are used in files, starting with the strongest evidence. The name `traced` also
    /// covers [`Scanned`](Self::Scanned).
    pub const NAMES: [&str; 3] = ["proof", "bound", "traced"];

    /// Returns the index of this evidence in [`Self::NAMES`]; 0 is the strongest evidence.
    pub fn rank(self) -> u8 {
        match self {
            Self::Proof => 0,
            Self::Bound => 1,
            Self::Traced { .. } | Self::Scanned { .. } => 2,
        }
    }

    /// Returns the name that is used in files.
    pub fn name(self) -> &'static str {
        Self::NAMES[usize::from(self.rank())]
    }
}

impl fmt::Display for Evidence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Proof => write!(f, "a proof"),
            Self::Bound => write!(f, "limits that were determined in tests at many points"),
            Self::Traced { resolution } => {
                write!(
                    f,
                    "the solution curve was followed from small inertia to its end in steps of at most {resolution:e}"
                )
            }
            Self::Scanned { step } => {
                write!(f, "a search of the lubricant temperature in steps of {step} K")
            }
        }
    }
}

/// Status and reason of a solve without a solution, with the evidence (if any) that no solution
/// exists.
#[derive(Debug, Clone, PartialEq)]
pub struct SolveFailure {
    status: Status,
    reason: Reason,
    evidence: Option<Evidence>,
}

impl fmt::Display for SolveFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.status.name(), self.reason)?;
        match self.evidence {
            Some(evidence) => write!(f, " (evidence: {evidence})"),
            None => Ok(()),
        }
    }
}

impl Error for SolveFailure {}

impl SolveFailure {
    /// Outcome of a failed search: no root was found, but a root may exist.
    pub(crate) const SEARCH_FAILED: Self = Self::not_converged(Reason::SearchFailed);

    /// Creates an outcome with the status `no_solution` and with evidence that no solution exists.
    pub(crate) fn no_solution(evidence: Evidence, reason: Reason) -> Self {
        Self { status: Status::NoSolution, reason, evidence: Some(evidence) }
    }

    /// Creates an outcome with the status `not_converged`: the solver found no solution, although a
    /// solution may exist.
    pub(crate) const fn not_converged(reason: Reason) -> Self {
        Self { status: Status::NotConverged, reason, evidence: None }
    }

    /// Creates an outcome with the status `invalid_input`: the model does not accept the inputs.
    pub(crate) fn invalid(reason: Reason) -> Self {
        Self { status: Status::InvalidInput, reason, evidence: None }
    }

    /// Returns the status of the solve.
    pub fn status(&self) -> Status {
        self.status
    }

    /// Returns the reason why there is no solution.
    pub fn reason(&self) -> &Reason {
        &self.reason
    }

    /// Returns the evidence that no solution exists; `None` if there is no such evidence.
    pub fn evidence(&self) -> Option<Evidence> {
        self.evidence
    }
}

/// Creates the outcome of a model whose equations cannot be evaluated.
pub(crate) fn domain_error(error: EvalError) -> SolveFailure {
    SolveFailure::not_converged(Reason::Refused { error })
}
