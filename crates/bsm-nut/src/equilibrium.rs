//! The equilibrium of a nut under load: its inputs and its results.

use bsm_dyn::{Reason, Status};

use crate::{BallInGrooves, BallPosition};

/// Displacements of a rigid body but the rotation about the axis: `$u_z, u_x, u_y$` \[m\] and
/// `$\varphi_x, \varphi_y$` \[rad\] of the nut against the screw.
pub(crate) const FREEDOMS: usize = 5;

/// What is given of a freedom of the nut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Freedom {
    /// Its load \[N\] or \[N·m\]; the displacement follows.
    Loaded(f64),
    /// Its displacement \[m\] or \[rad\]; the guides carry what it takes.
    Held(f64),
    /// A spring \[N/m\] or \[N·m/rad\] to the guides, and a load.
    Sprung {
        /// Its stiffness.
        stiffness: f64,
        /// The load.
        load: f64,
    },
}

impl Freedom {
    /// The load from outside; none where the displacement is given.
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
/// reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Support(pub [Freedom; FREEDOMS]);

impl Support {
    /// Loaded along the axis \[N\], and held otherwise: a table on stiff guides.
    pub fn guided(axial: f64) -> Self {
        Self([Freedom::Held(0.0); FREEDOMS]).with_axial(axial)
    }

    /// Loaded along the axis \[N\], and free otherwise.
    pub fn free(axial: f64) -> Self {
        Self([Freedom::Loaded(0.0); FREEDOMS]).with_axial(axial)
    }

    /// The same with another load along the axis \[N\].
    #[must_use]
    pub fn with_axial(mut self, axial: f64) -> Self {
        self.0[0] = Freedom::Loaded(axial);
        self
    }
}

/// How a nut carries its load.
#[derive(Debug, Clone, PartialEq)]
pub struct Equilibrium {
    /// `$u_z, u_x, u_y, \varphi_x, \varphi_y$` of the nut's anchor section against the screw's.
    pub displacement: [f64; FREEDOMS],
    /// Force and moment of the nut on its balls, by freedom \[N\] and \[N·m\].
    pub carried: [f64; FREEDOMS],
    /// Stiffness of the nut, all freedoms against each other, with its bodies (U17).
    pub stiffness: [[f64; FREEDOMS]; FREEDOMS],
    /// Where the balls are.
    pub positions: Vec<BallPosition>,
    /// What they carry.
    pub balls: Vec<BallInGrooves>,
    /// The groove displacement of each ball along binormal and principal normal \[m\].
    pub grooves: Vec<[f64; 2]>,
    /// Axial force of each body on its balls \[N\].
    pub bodies: Vec<f64>,
    /// Widening of the nut at each circuit \[m\]; empty for a rigid nut.
    pub widening: Vec<f64>,
    /// Newton steps.
    pub steps: usize,
    /// Largest force that is left over, over the sum of all forces.
    pub residual: f64,
}

/// Why a nut has no state under a load.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NutError {
    /// The contacts are no Hertzian ones.
    #[error("the curvatures of ball and grooves make no Hertzian contact")]
    Contact(Reason),
    /// No ball takes the load: the nut moves without end.
    #[error("nothing carries the load: the nut has moved by {moved:e} m, out of its grooves")]
    NothingCarries {
        /// Displacement at which the search ended \[m\].
        moved: f64,
    },
    /// The iteration has ended before the forces were in balance.
    #[error(
        "the forces of the balls do not balance: {residual:e} of their sum is left after {steps} steps"
    )]
    NotConverged {
        /// Residual of the sum of all forces.
        residual: f64,
        /// Newton steps.
        steps: usize,
    },
    /// A ball has no place in its grooves where its forces balance.
    #[error("the forces of ball {ball} do not balance in its grooves")]
    BallNotBalanced {
        /// Its number, from 0.
        ball: usize,
    },
    /// A ball is larger than a groove.
    #[error("ball {ball} is larger than its groove, which has no contact with it")]
    BallTooLarge {
        /// Its number, from 0.
        ball: usize,
    },
    /// A contact angle is outside 0 to 90 deg.
    #[error(
        "ball {ball} leaves its flank: its contact angle is {:.2} deg, outside 0 to 90 deg",
        .angle.to_degrees()
    )]
    BallLeavesFlank {
        /// Its number, from 0.
        ball: usize,
        /// The angle \[rad\].
        angle: f64,
    },
    /// The nut has no balls.
    #[error("a nut without loaded balls carries nothing")]
    NoBalls,
    /// No preload of that size can be set.
    #[error("no offset of the bodies gives a preload of {force} N")]
    NoPreload {
        /// The preload asked for \[N\].
        force: f64,
    },
}

impl NutError {
    /// What it means for an answer: refused, without a solution, or not found.
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
