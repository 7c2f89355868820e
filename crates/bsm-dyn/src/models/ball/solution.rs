//! Solution of a model in SI units.

use bsm_kin::Site;

use super::model::Model;
use super::state::{ContactState, SteadyState};
use crate::outcome::{Evidence, NoAnswer, Reason, Status};

/// Result of one model at one operating point.
#[derive(Debug, Clone, PartialEq)]
#[must_use = "a solution may say that there is none"]
pub struct Solution {
    /// The model.
    pub model: Model,
    /// The steady state, or the reason why there is none.
    pub answer: Result<SteadyState, NoAnswer>,
    /// Reason for the choice of the model; `None` if the model was given.
    pub choice: Option<Choice>,
}

impl Solution {
    /// Creates the solution of a given model.
    pub fn new(model: Model, answer: Result<SteadyState, NoAnswer>) -> Self {
        Self { model, answer, choice: None }
    }

    /// Returns how the solve ended.
    pub fn status(&self) -> Status {
        self.answer.as_ref().map_or_else(NoAnswer::status, |_| Status::Converged)
    }

    /// Returns why there is no steady state; `None` if the solve converged.
    pub fn reason(&self) -> Option<&Reason> {
        self.answer.as_ref().err().map(NoAnswer::reason)
    }

    /// Returns the evidence that no solution exists; `None` unless the status is [`Status::NoSolution`].
    pub fn evidence(&self) -> Option<Evidence> {
        self.answer.as_ref().err()?.evidence()
    }

    /// Returns the steady state, if the solve converged.
    pub fn solved(&self) -> Option<&SteadyState> {
        self.answer.as_ref().ok()
    }

    /// Returns the contact at a site, if the solve converged and the model has this contact.
    pub fn contact(&self, site: Site) -> Option<&ContactState> {
        self.solved()?.ball.contact(site)
    }

    /// Returns the efficiency, if the solve converged.
    pub fn efficiency(&self) -> Option<f64> {
        Some(self.solved()?.transmission.efficiency)
    }

    /// Returns whether friction prevents the motion in this direction; `None` if this is unknown.
    pub fn self_locking(&self) -> Option<bool> {
        match &self.answer {
            Ok(solved) => Some(solved.transmission.self_locking),
            Err(none) => match none.reason() {
                Reason::SelfLocking { .. } | Reason::FrictionHoldsLoad { .. } => Some(true),
                _ => None,
            },
        }
    }
}

/// Reason for the choice of a model by error bounds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Choice {
    /// Basis of the error bound.
    pub basis: Basis,
    /// Requested error bound of the efficiency. The stated bound, which holds at 99 % of all points, is larger if no model is
    /// accurate enough.
    pub tolerance: f64,
}

/// Basis of an error bound.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Basis {
    /// The ball rolls.
    Rolling {
        /// Onset number (W11).
        onset_number: f64,
    },
    /// The ball skids.
    GrossSkid {
        /// Onset number (W11).
        onset_number: f64,
    },
    /// Friction is integrated over the contact ellipses, because the ball neither rolls nor skids clearly.
    Integrated {
        /// Accuracy of the quadrature.
        accuracy: f64,
    },
}

impl Basis {
    /// Returns the model with this basis.
    pub fn model(&self) -> Model {
        match self {
            Self::Rolling { .. } => Model::RacewayControl,
            Self::GrossSkid { .. } => Model::Elastic,
            Self::Integrated { .. } => Model::Traction,
        }
    }
}
