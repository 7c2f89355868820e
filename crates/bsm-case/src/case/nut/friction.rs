//! The inputs for the friction of the balls of a nut.

use bsm_dyn::{Lubricant, Temperature};

use crate::case::problem::Needs;
use crate::vocabulary::error::bad;
use crate::{Case, CaseError};

/// Source of the friction of the balls.
#[derive(Debug, Clone, Copy)]
pub(crate) enum FrictionSource {
    /// One coefficient.
    Coefficient(f64),
    /// The film of each ball, and what the ball returns lose, without the seals.
    Lubricant(Lubricant),
}

impl FrictionSource {
    /// The friction coefficient, if it is one.
    pub(crate) fn coefficient(&self) -> Option<f64> {
        match self {
            Self::Coefficient(coefficient) => Some(*coefficient),
            Self::Lubricant(_) => None,
        }
    }

    /// As given by a case.
    pub(super) fn of(case: &Case) -> Result<Option<Self>, CaseError> {
        let given = case.given();
        given.check_friction()?;
        if !given.is_lubricated() {
            return Ok(case.friction_coefficient.map(Self::Coefficient));
        }
        let missing = Needs::LUBRICANT.missing(given);
        let read = || case.reader().lubricant();
        let Some(mut lubricant) = missing.is_empty().then(read).flatten() else {
            return Err(CaseError::missing(&missing, &case.given().purpose("for a nut")));
        };
        if let Temperature::Balance { .. } = lubricant.temperature {
            let what = "the temperature of the lubricant follows from the heat of one ball in `solve`, not from \
                        that of a nut; give lubricant_temperature_C";
            return Err(bad("heat_transfer_W_K", what));
        }
        // The seals have a line of their own.
        lubricant.losses.seal_torque = 0.0;
        Ok(Some(Self::Lubricant(lubricant)))
    }
}
