//! The equilibrium of a nut under load: its inputs and its results.

use bsm_dyn::{Reason, Status};

use crate::{BallInGrooves, BallPosition};

/// Degrees of freedom of a rigid body without rotation about the axis: `$u_z, u_x, u_y$` \[m\] and
/// `$\varphi_x, \varphi_y$` \[rad\] of the nut relative to the screw.
pub(crate) const FREEDOMS: usize = 5;

/// The condition for one degree of freedom of the nut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Freedom {
    /// A given load \[N\] or \[N·m\]. The displacement follows.
    Loaded(f64),
    /// A given displacement \[m\] or \[rad\]. The guides carry the required load.
    Held(f64),
    /// A spring \[N/m\] or \[N·m/rad\] to the guides, and a load.
    Sprung {
        /// Stiffness of the spring.
        stiffness: f64,
        /// External load.
        load: f64,
    },
}

impl Freedom {
    /// Returns the external load, which is zero if the displacement is given.
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

/// Load and guidance of a nut: along the axis, across it (x, y), and about x and y, all at the
/// reference point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Support(pub [Freedom; FREEDOMS]);

impl Support {
    /// Returns an axial load \[N\] with all other degrees of freedom fixed, as for a table on stiff
    /// guides.
    pub fn guided(axial: f64) -> Self {
        Self([Freedom::Held(0.0); FREEDOMS]).with_axial(axial)
    }

    /// Returns an axial load \[N\] with all other degrees of freedom free.
    pub fn free(axial: f64) -> Self {
        Self([Freedom::Loaded(0.0); FREEDOMS]).with_axial(axial)
    }

    /// Returns the same support with another axial load \[N\].
    #[must_use]
    pub fn with_axial(mut self, axial: f64) -> Self {
        self.0[0] = Freedom::Loaded(axial);
        self
    }
}

/// Equilibrium of a nut under a load.
#[derive(Debug, Clone, PartialEq)]
pub struct Equilibrium {
    /// Displacements `$u_z, u_x, u_y, \varphi_x, \varphi_y$` of the nut's anchor section relative
    /// to the screw's anchor section.
    pub displacement: [f64; FREEDOMS],
    /// Force and moment of the nut on its balls, by degree of freedom \[N\] and \[N·m\].
    pub carried: [f64; FREEDOMS],
    /// Stiffness matrix of the nut with its bodies, for all degrees of freedom (U17).
    pub stiffness: [[f64; FREEDOMS]; FREEDOMS],
    /// Positions of the balls.
    pub positions: Vec<BallPosition>,
    /// Loads of the balls.
    pub balls: Vec<BallInGrooves>,
    /// The groove displacement of each ball along binormal and principal normal \[m\].
    pub grooves: Vec<[f64; 2]>,
    /// Axial force of each body on its balls \[N\].
    pub bodies: Vec<f64>,
    /// Widening of the nut at each circuit \[m\]; empty for a rigid nut.
    pub widening: Vec<f64>,
    /// Number of Newton steps.
    pub steps: usize,
    /// Residual force divided by the sum of the magnitudes of all forces.
    pub residual: f64,
}

/// The reason why a nut has no equilibrium under a load.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NutError {
    /// The contacts are not Hertzian.
    #[error("the curvatures of ball and grooves do not form a Hertzian contact")]
    Contact(Reason),
    /// No ball carries the load, so that the nut moves without limit.
    #[error(
        "no ball can carry the load, because the nut has moved by {moved:e} m out of its grooves"
    )]
    NothingCarries {
        /// Displacement at which the search ended \[m\].
        moved: f64,
    },
    /// The iteration ended before the forces were balanced.
    #[error(
        "the forces of the balls do not balance: {residual:e} of their sum is left after {steps} steps"
    )]
    NotConverged {
        /// Residual divided by the sum of the magnitudes of all forces.
        residual: f64,
        /// Number of Newton steps.
        steps: usize,
    },
    /// A ball has no position in its grooves at which its forces are balanced.
    #[error("the forces on ball {ball} are not in balance in its grooves")]
    BallNotBalanced {
        /// Index of the ball, from 0.
        ball: usize,
    },
    /// A ball is larger than a groove.
    #[error("ball {ball} is larger than its groove and does not touch the groove")]
    BallTooLarge {
        /// Index of the ball, from 0.
        ball: usize,
    },
    /// A contact angle is outside 0 to 90 deg.
    #[error(
        "ball {ball} leaves its flank: its contact angle is {:.2} deg, outside 0 to 90 deg",
        .angle.to_degrees()
    )]
    BallLeavesFlank {
        /// Index of the ball, from 0.
        ball: usize,
        /// The angle \[rad\].
        angle: f64,
    },
    /// The nut has no balls.
    #[error("a nut without loaded balls cannot carry a load")]
    NoBalls,
    /// No preload of this size is possible.
    #[error("no offset of the bodies gives a preload of {force} N")]
    NoPreload {
        /// The requested preload \[N\].
        force: f64,
    },
}

impl NutError {
    /// Returns how an answer reports the error: as invalid input, as no solution, or as not
    /// converged.
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
