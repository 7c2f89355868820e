//! The solution of a model, in SI units.

use bsm_kin::Site;

use super::model::Model;
use super::state::{ContactState, SteadyState};
use crate::outcome::{Evidence, NoAnswer, Reason, Status};

/// The result of one model at one operating point.
#[derive(Debug, Clone, PartialEq)]
#[must_use = "a solution may say that there is none"]
pub struct Solution {
    /// The model.
    pub model: Model,
    /// The numbers, or why there are none.
    pub answer: Result<SteadyState, NoAnswer>,
    /// Why the model was chosen, if it was chosen by the bound of its error.
    pub choice: Option<Choice>,
}

impl Solution {
    /// The answer of a model that was asked for.
    pub fn new(model: Model, answer: Result<SteadyState, NoAnswer>) -> Self {
        Self { model, answer, choice: None }
    }

    /// How the solve ended.
    pub fn status(&self) -> Status {
        self.answer.as_ref().map_or_else(NoAnswer::status, |_| Status::Converged)
    }

    /// Why there is no answer.
    pub fn reason(&self) -> Option<&Reason> {
        self.answer.as_ref().err().map(NoAnswer::reason)
    }

    /// What says that there is no solution, if there is none.
    pub fn evidence(&self) -> Option<Evidence> {
        self.answer.as_ref().err()?.evidence()
    }

    /// The numbers, if it converged.
    pub fn solved(&self) -> Option<&SteadyState> {
        self.answer.as_ref().ok()
    }

    /// The contact at a site, if it converged and the model has it.
    pub fn contact(&self, site: Site) -> Option<&ContactState> {
        self.solved()?.ball.contact(site)
    }

    /// Efficiency, if it converged.
    pub fn efficiency(&self) -> Option<f64> {
        Some(self.solved()?.transmission.efficiency)
    }

    /// True or false if it is known that friction holds the screw in this direction.
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

/// Why a model was chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Choice {
    /// What the bound of its error comes from.
    pub basis: Basis,
    /// What was asked of the error of the efficiency; its bound, which 99 % of all points keep, may be
    /// larger where no model is that exact.
    pub tolerance: f64,
}

/// What an error bound comes from.
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
    /// In between; friction was integrated over the ellipses.
    Integrated {
        /// Accuracy of the quadrature.
        accuracy: f64,
    },
}

impl Basis {
    /// The model that has it.
    pub fn model(&self) -> Model {
        match self {
            Self::Rolling { .. } => Model::RacewayControl,
            Self::GrossSkid { .. } => Model::Elastic,
            Self::Integrated { .. } => Model::Traction,
        }
    }
}
