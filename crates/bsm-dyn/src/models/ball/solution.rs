//! Solution of a model in SI units.

use bsm_kin::Site;

use super::model::Model;
use super::state::{ContactState, SteadyState};
use crate::outcome::{Evidence, Reason, SolveFailure, Status};

/// Result of one model at one operating point.
#[derive(Debug, Clone, PartialEq)]
#[must_use = "a solution may report that the solve failed"]
pub struct Solution {
    /// The model that was solved.
    pub model: Model,
    /// The steady state, or the reason why there is none.
    pub result: Result<SteadyState, SolveFailure>,
    /// Reason why the model `auto` chose this model; `None` if the model was specified by the
    /// caller.
    pub choice: Option<Choice>,
}

impl Solution {
    /// Creates the solution of a specified model.
    pub fn new(model: Model, result: Result<SteadyState, SolveFailure>) -> Self {
        Self { model, result, choice: None }
    }

    /// Returns the status of the solve.
    pub fn status(&self) -> Status {
        self.result.as_ref().map_or_else(SolveFailure::status, |_| Status::Converged)
    }

    /// Returns the reason why there is no steady state; `None` if the solve converged.
    pub fn reason(&self) -> Option<&Reason> {
        self.result.as_ref().err().map(SolveFailure::reason)
    }

    /// Returns the evidence that no solution exists; `None` unless the status is
    /// [`Status::NoSolution`].
    pub fn evidence(&self) -> Option<Evidence> {
        self.result.as_ref().err()?.evidence()
    }

    /// Returns the steady state; `None` if the solve did not converge.
    pub fn steady_state(&self) -> Option<&SteadyState> {
        self.result.as_ref().ok()
    }

    /// Returns the contact at the given flank; `None` if the solve failed or the model does not
    /// include this contact.
    pub fn contact(&self, site: Site) -> Option<&ContactState> {
        self.steady_state()?.ball.contact(site)
    }

    /// Returns the efficiency; `None` if the solve did not converge.
    pub fn efficiency(&self) -> Option<f64> {
        Some(self.steady_state()?.transmission.efficiency)
    }

    /// Returns true if friction prevents motion in the given direction of the power flow; `None` if
    /// this is unknown.
    pub fn self_locking(&self) -> Option<bool> {
        match &self.result {
            Ok(solved) => Some(solved.transmission.self_locking),
            Err(failure) => match failure.reason() {
                Reason::SelfLocking { .. } | Reason::FrictionHoldsLoad { .. } => Some(true),
                _ => None,
            },
        }
    }
}

/// Reason why the model `auto` chose a particular model, based on error bounds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Choice {
    /// Slip regime or quadrature on which the error bound is based.
    pub basis: Basis,
    /// Requested error bound of the efficiency. If no model is accurate enough, the error bound of
    /// the result is larger than requested. The error bound of the result holds for 99 % of all
    /// points.
    pub tolerance: f64,
}

/// Slip regime or quadrature on which an error bound is based.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Basis {
    /// The ball rolls, so raceway control is accurate.
    Rolling {
        /// Onset number of the ball (W11).
        onset_number: f64,
    },
    /// The ball skids, so the gross-slip model is accurate.
    GrossSkid {
        /// Onset number of the ball (W11).
        onset_number: f64,
    },
    /// Friction is integrated over the contact ellipses, because the ball is between rolling and
    /// gross skid.
    Integrated {
        /// Accuracy of the quadrature over the contact ellipses.
        accuracy: f64,
    },
}

impl Basis {
    /// Returns the model that is used in this slip regime or with this quadrature.
    pub fn model(&self) -> Model {
        match self {
            Self::Rolling { .. } => Model::RacewayControl,
            Self::GrossSkid { .. } => Model::Elastic,
            Self::Integrated { .. } => Model::Traction,
        }
    }
}
