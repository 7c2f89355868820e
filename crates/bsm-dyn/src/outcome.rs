//! How a solve ends: with a solution, or why there is none.

use std::fmt;

use bsm_newton::{EvalError, Report, Termination};

/// An enum whose variants have names in files and on the command line.
macro_rules! named {
    (
        $(#[$about:meta])*
        pub enum $kind:ident { $($(#[$of:meta])* $variant:ident = $name:literal,)* }
    ) => {
        $(#[$about])*
        pub enum $kind { $($(#[$of])* $variant,)* }

        impl $kind {
            /// All of them, in their order.
            pub const ALL: [Self; [$($name),*].len()] = [$(Self::$variant),*];

            /// Name in files and on the command line.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }

            /// The one of that name.
            pub fn from_name(name: &str) -> Option<Self> {
                Self::ALL.into_iter().find(|one| one.name() == name)
            }
        }
    };
}
pub(crate) use named;

named! {
    /// The raceway at which the ball does not spin.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Control {
        /// The nut.
        Nut = "nut",
        /// The screw.
        Screw = "screw",
    }
}

/// The part of a screw drive that the motor turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DrivenPart {
    /// The screw turns, and the nut travels.
    Screw,
    /// The nut turns and travels; the screw is at rest.
    Nut,
}

/// Which side drives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// The drive works against the axial load, `$W > 0$`.
    RotaryToLinear,
    /// The load drives (back-driving), `$W < 0$`.
    LinearToRotary,
}

impl Direction {
    /// Direction of the relative speed `$W = \Omega_s - \Omega_n$`; `None` if it is 0 or NaN.
    pub fn of(relative_speed: f64) -> Option<Self> {
        if relative_speed > 0.0 {
            Some(Self::RotaryToLinear)
        } else if relative_speed < 0.0 {
            Some(Self::LinearToRotary)
        } else {
            None
        }
    }

    /// Sign of the relative speed.
    pub fn sign(self) -> f64 {
        match self {
            Self::RotaryToLinear => 1.0,
            Self::LinearToRotary => -1.0,
        }
    }

    /// True if the load drives.
    pub fn is_back(self) -> bool {
        self == Self::LinearToRotary
    }
}

named! {
    /// How a solve ended.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Status {
        /// The outputs are the solution.
        Converged = "converged",
        /// None exists, as far as the [`Evidence`] goes.
        NoSolution = "no_solution",
        /// The iteration found none, and none is proven not to exist.
        NotConverged = "not_converged",
        /// The model does not take these inputs.
        InvalidInput = "invalid_input",
    }
}

/// Why there is no solution.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Reason {
    /// `$\sin\beta \le f D$`: friction holds any axial load, the drive cannot turn.
    SelfLocking {
        /// `$\sin\beta$`.
        sin_contact_angle: f64,
        /// `$f D$`, which it does not exceed.
        friction_term: f64,
    },
    /// The quasi-static balance needs a normal load that is not positive: friction holds any load.
    FrictionHoldsLoad {
        /// Normal load over axial load per ball.
        load_ratio: f64,
    },
    /// Saturated friction at the nut is more than the slip can use: the slip at A would have to
    /// be negative. The ball rolls on the nut instead, which these equations exclude.
    NutContactWouldRoll {
        /// Slip speed at A along its friction direction, over `$r_b|W|$`; not positive.
        slip: f64,
        /// True if `slip` is the exact one of the extended equations, false if it is the
        /// first-order bound.
        exact: bool,
        /// Smallest lead angle with a solution, the rest of the point kept \[rad\], if one was
        /// found.
        critical_lead_angle: Option<f64>,
    },
    /// Contact A' on the unloaded flank would have to act in tension.
    UnloadedFlankWouldPull {
        /// `$Q_{A'}/F_a$`, not positive.
        load_ratio: f64,
    },
    /// A loaded contact would have to act in tension.
    LoadedContactWouldPull {
        /// `$Q_A/F_a$`.
        nut_load_ratio: f64,
        /// `$Q_B/F_a$`.
        screw_load_ratio: f64,
    },
    /// No directions of slip balance the inertia forces of this speed and load.
    NoRootAtInertia {
        /// Their inertia ratio `$m r_m W^2/F_a$`.
        inertia_ratio: f64,
        /// The nearest one, the rest of the point kept, at which a steady motion was met.
        nearest: f64,
    },
    /// The contact angle of the root is not between 0 and 90 degrees; with `no_solution`, that of
    /// the first root or of the end of a path on which no root has both between them, and no other
    /// root is known.
    BallLeavesFlank {
        /// At the nut \[rad\].
        nut: f64,
        /// At the screw \[rad\].
        screw: f64,
    },
    /// The flanks cannot hold the centrifugal force of the rolling ball at any contact angles
    /// between 0 and 90 degrees.
    FlanksCannotHold {
        /// The raceway in control.
        control: Control,
        /// Centrifugal force that they hold over the axial load, with the screw's contact angle
        /// at 90 degrees.
        held: f64,
        /// Centrifugal force over the axial load there.
        centrifugal: f64,
    },
    /// With saturated friction a slip points along friction, not against it, wherever the forces
    /// balance.
    SlipAlongFriction {
        /// Slip speed at the nut without inertia, over `$r_b|W|$`.
        slip: f64,
    },
    /// A ball that slides against friction on both flanks has other inertia forces.
    NoSkidAtInertia {
        /// `$m r_m W^2/F_a$`.
        inertia: f64,
        /// Smallest one of such a ball.
        least: f64,
        /// Largest one.
        most: f64,
    },
    /// The search along all candidates failed: no root is found, and none excluded.
    SearchLost,
    /// The curvatures of ball and groove give no ellipse across the groove.
    CurvaturesNotHertzian {
        /// Along the track \[1/m\].
        longitudinal: f64,
        /// Across the groove \[1/m\].
        transverse: f64,
    },
    /// `$P = 0$`: a ball that does not circle has no gyroscopic moment to carry the friction couple.
    BallDoesNotCircle,
    /// The inertia ratio `$m r_m W^2/F_a$` is beyond what double precision can balance: below 1e-100 or
    /// above 1e28.
    InertiaOutOfRange {
        /// Its value.
        inertia_ratio: f64,
    },
    /// `$f = 0$`: nothing fixes the rotation of the ball.
    Frictionless,
    /// The nut and the screw do not turn against each other.
    NoRelativeSpeed,
    /// Only screw drive or nut drive is covered, not both turning.
    DualDrive,
    /// A root was found, but the powers do not balance: its rounding errors are too large.
    PowerDoesNotBalance {
        /// Relative violation.
        imbalance: f64,
    },
    /// The losses heat the lubricant more than its surroundings cool it, up to a temperature.
    LubricantRunsAway {
        /// That temperature \[K\].
        hottest: f64,
    },
    /// The model cannot be evaluated where it was asked.
    Refused {
        /// Quantity, value and requirement.
        error: EvalError,
    },
    /// The iteration ended early.
    Newton {
        /// How it ended.
        status: Termination,
        /// Its last scaled residual.
        residual: f64,
        /// The equation with the largest part of it, as text.
        worst_equation: String,
    },
}

impl From<Report> for Reason {
    /// How a solve that did not converge ended.
    fn from(report: Report) -> Self {
        Self::Newton {
            status: report.status,
            residual: report.residual,
            worst_equation: report.worst_equation_name,
        }
    }
}

/// Evidence that there is no solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Evidence {
    /// A proof from the equations of the model, up to rounding.
    Proof,
    /// What was measured of many points excludes it: the error of an expansion, or where there are several solutions.
    Bound,
    /// A curve with every solution on it was followed: two solutions in one step may be missed.
    Traced {
        /// Longest step, in the unit of the curve.
        resolution: f64,
    },
    /// So many random starts have led to no solution, besides a curve that was followed.
    Sampled {
        /// How many.
        starts: u32,
    },
}

impl Evidence {
    /// Names in files, the strongest first.
    pub const NAMES: [&str; 4] = ["proof", "bound", "traced", "sampled"];

    /// Place in [`Self::NAMES`].
    pub fn rank(self) -> u8 {
        match self {
            Self::Proof => 0,
            Self::Bound => 1,
            Self::Traced { .. } => 2,
            Self::Sampled { .. } => 3,
        }
    }

    /// Name in files.
    pub fn name(self) -> &'static str {
        Self::NAMES[usize::from(self.rank())]
    }
}

impl fmt::Display for Evidence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Proof => write!(f, "a proof"),
            Self::Bound => write!(f, "an error bound of the first-order solution"),
            Self::Traced { resolution } => {
                write!(
                    f,
                    "a curve that contains all solutions, followed in steps of at most {resolution:e}"
                )
            }
            Self::Sampled { starts } => {
                write!(f, "a curve followed to its end, and {starts} random starts")
            }
        }
    }
}

/// Why a model has no answer.
#[derive(Debug, Clone, PartialEq)]
pub struct NoAnswer {
    status: Status,
    reason: Reason,
    evidence: Option<Evidence>,
}

impl NoAnswer {
    /// A failed search: no root is found, and none is excluded.
    pub(crate) const LOST: Self = Self::not_converged(Reason::SearchLost);

    /// There is none, and what says so.
    pub(crate) fn none(evidence: Evidence, reason: Reason) -> Self {
        Self { status: Status::NoSolution, reason, evidence: Some(evidence) }
    }

    /// The iteration found none, and none is shown not to exist.
    pub(crate) const fn not_converged(reason: Reason) -> Self {
        Self { status: Status::NotConverged, reason, evidence: None }
    }

    /// The model does not take these inputs.
    pub(crate) fn invalid(reason: Reason) -> Self {
        Self { status: Status::InvalidInput, reason, evidence: None }
    }

    /// How the solve ended.
    pub fn status(&self) -> Status {
        self.status
    }

    /// Why.
    pub fn reason(&self) -> &Reason {
        &self.reason
    }

    /// What says that there is none, if there is none.
    pub fn evidence(&self) -> Option<Evidence> {
        self.evidence
    }
}

/// What a strategy of a search says: a root, or why there is none; `None` where it leaves that open.
pub(crate) type Attempt<R> = Option<Result<R, NoAnswer>>;

/// The first answer of strategies that are asked in their order.
pub(crate) fn first_answer<S, R>(
    search: &mut S,
    strategies: &[fn(&mut S) -> Attempt<R>],
) -> Result<R, NoAnswer> {
    strategies.iter().find_map(|strategy| strategy(search)).unwrap_or(Err(NoAnswer::LOST))
}

/// The answer where the model cannot be evaluated.
pub(crate) fn domain_error(error: EvalError) -> NoAnswer {
    NoAnswer::not_converged(Reason::Refused { error })
}
