//! Friction inputs for the balls of a nut.

use bsm_dyn::lubrication::{Lubricant, Temperature};

use crate::case::problem::Needs;
use crate::vocabulary::error::invalid_input;
use crate::{Case, CaseError};

/// Data from which the friction of the balls is calculated.
#[derive(Debug, Clone, Copy)]
pub(crate) enum FrictionSource {
    /// Constant friction coefficient.
    Coefficient(f64),
    /// Lubricant film of each ball, and losses in the ball returns. Seal losses are not included.
    Lubricant(Lubricant),
}

impl FrictionSource {
    /// Returns the friction coefficient, if it is constant.
    pub(crate) fn coefficient(&self) -> Option<f64> {
        match self {
            Self::Coefficient(coefficient) => Some(*coefficient),
            Self::Lubricant(_) => None,
        }
    }

    /// Returns the friction data that a case specifies, or `None` if it specifies none.
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
            let what = "determines the temperature of the lubricant from the heat of one ball in `solve`, but not from \
                        the heat of a nut; give lubricant_temperature_C";
            return Err(invalid_input("heat_transfer_W_K", what));
        }
        // The seal torque is not part of the ball friction. It is added to the torque of the nut
        // later.
        lubricant.losses.seal_torque = 0.0;
        Ok(Some(Self::Lubricant(lubricant)))
    }
}
