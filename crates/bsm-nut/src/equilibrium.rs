//! Inputs and results of the equilibrium of a nut under load.

use bsm_dyn::{Reason, Status};

use crate::{BallInGrooves, BallPosition};

/// Number of degrees of freedom of the nut relative to the screw: `$u_z, u_x, u_y$` \[m\] and
/// `$\varphi_x, \varphi_y$` \[rad\]. Rotation about the screw axis is not included.
pub(crate) const FREEDOMS: usize = 5;

/// Boundary condition for one degree of freedom of the nut: a given load, a given displacement, or
/// a spring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Freedom {
    /// The load \[N\] or moment \[N·m\] is given, and the displacement is calculated.
    Loaded(f64),
    /// The displacement \[m\] or rotation \[rad\] is given, and the load on the guides is
    /// calculated.
    Held(f64),
    /// A spring connects the nut to the guides, and an external load acts on the nut.
    Sprung {
        /// Stiffness of the spring \[N/m\] or \[N·m/rad\].
        stiffness: f64,
        /// External load \[N\] or moment \[N·m\].
        load: f64,
    },
}

impl Freedom {
    /// Returns the external load, or zero if the displacement is given.
    pub(crate) fn load(self) -> f64 {
        match self {
            Self::Loaded(load) | Self::Sprung { load, .. } => load,
            Self::Held(_) => 0.0,
        }
    }

    pub(crate) fn spring(self) -> f64 {
        if let Self::Sprung { stiffness, .. } = self { stiffness } else { 0.0 }
    }
}

/// Boundary conditions for the five degrees of freedom of a nut: displacements along z, x and y,
/// and rotations about x and y. All displacements refer to the reference point of the nut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Support(pub [Freedom; FREEDOMS]);

impl Support {
    /// Returns the support of a nut on stiff guides, such as the nut of a machine table: an axial
    /// load \[N\] acts on the nut, and all other degrees of freedom are fixed.
    pub fn guided(axial: f64) -> Self {
        Self([Freedom::Held(0.0); FREEDOMS]).with_axial(axial)
    }

    /// Returns the support of a free nut: an axial load \[N\] acts on the nut, and no guide holds
    /// the nut in any direction.
    pub fn free(axial: f64) -> Self {
        Self([Freedom::Loaded(0.0); FREEDOMS]).with_axial(axial)
    }

    /// Returns a copy of this support with another axial load \[N\].
    #[must_use]
    pub fn with_axial(mut self, axial: f64) -> Self {
        self.0[0] = Freedom::Loaded(axial);
        self
    }
}

/// Equilibrium of a nut under a load.
#[derive(Debug, Clone, PartialEq)]
pub struct Equilibrium {
    /// Displacement of the nut relative to the screw, `$u_z, u_x, u_y$` \[m\] and `$\varphi_x,
    /// \varphi_y$` \[rad\]. If nut and screw are elastic, the displacement is measured between
    /// their anchors.
    pub displacement: [f64; FREEDOMS],
    /// Forces and moments that the nut exerts on its balls, one for each degree of freedom \[N\]
    /// and \[N·m\].
    pub carried: [f64; FREEDOMS],
    /// Stiffness matrix of the nut, including its elastic bodies, for the five degrees of freedom
    /// (U17).
    pub stiffness: [[f64; FREEDOMS]; FREEDOMS],
    /// Positions of the balls.
    pub positions: Vec<BallPosition>,
    /// Loads and contact angles of the balls.
    pub balls: Vec<BallInGrooves>,
    /// Displacement of the groove at each ball, along binormal and principal normal \[m\].
    pub grooves: Vec<[f64; 2]>,
    /// Axial force that each nut body exerts on its balls \[N\].
    pub bodies: Vec<f64>,
    /// Radial expansion of the nut at each circuit \[m\]. The list is empty if the nut is rigid.
    pub radial_expansions: Vec<f64>,
    /// Number of Newton steps.
    pub steps: usize,
    /// Largest residual force divided by the sum of the absolute values of all forces.
    pub residual: f64,
}

/// Reason why the equilibrium of a nut under load does not exist or was not found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NutError {
    /// The curvatures of ball and grooves do not form a Hertzian contact.
    #[error("the curvatures of ball and grooves do not form a Hertzian contact")]
    Contact(Reason),
    /// No ball can carry the load, so the nut moves without limit.
    #[error(
        "no ball can carry the load, because the nut has moved by {moved:e} m and the balls are out of their grooves"
    )]
    NothingCarries {
        /// Displacement of the nut at which the search ended \[m\].
        moved: f64,
    },
    /// The iteration ended before the forces were balanced.
    #[error(
        "the ball forces are not balanced: the relative residual is {residual:e} after {steps} steps"
    )]
    NotConverged {
        /// Residual force divided by the sum of the absolute values of all forces.
        residual: f64,
        /// Number of Newton steps taken.
        steps: usize,
    },
    /// The solver found no position of a ball at which the forces on the ball are balanced.
    #[error("no position in the grooves was found at which the forces on ball {ball} are balanced")]
    BallNotBalanced {
        /// Index of the ball, from 0.
        ball: usize,
    },
    /// A ball is too large for its groove.
    #[error("ball {ball} is larger than its groove and does not fit into it")]
    BallTooLarge {
        /// Index of the ball, from 0.
        ball: usize,
    },
    /// A ball has left its flank, because its contact angle is outside the range from 0 to 90 deg.
    #[error(
        "ball {ball} leaves its flank: its contact angle is {:.2} deg, outside the range from 0 to 90 deg",
        .angle.to_degrees()
    )]
    BallLeavesFlank {
        /// Index of the ball, from 0.
        ball: usize,
        /// Contact angle \[rad\].
        angle: f64,
    },
    /// The nut has no balls.
    #[error("a nut without loaded balls cannot carry a load")]
    NoBalls,
    /// The requested preload cannot be reached.
    #[error("no offset between the nut bodies gives a preload of {force} N")]
    NoPreload {
        /// Requested preload \[N\].
        force: f64,
    },
}

impl NutError {
    /// Returns the status that is reported to the user for this error: invalid input, no solution,
    /// or not converged.
    pub fn status(&self) -> Status {
        match self {
            Self::Contact(_) | Self::NoBalls => Status::InvalidInput,
            Self::NothingCarries { .. }
            | Self::NoPreload { .. }
            | Self::BallTooLarge { .. }
            | Self::BallLeavesFlank { .. } => Status::NoSolution,
            Self::NotConverged { .. } | Self::BallNotBalanced { .. } => Status::NotConverged,
        }
    }
}
