//! 90 % intervals of efficiency and torque due to uncertain lubricant friction, as columns of
//! tables.

use bsm_dyn::{ModelWorkspace, Solution, model::LossInterval};

use crate::case::problem::Needs;
use crate::vocabulary::quantity::quantities;
use crate::{Case, CaseError, Numbers, Settings};

quantities! { pub(crate) QUANTITIES, read(&LossInterval) of Band;
    "90 % interval of lubricated friction" {
        band_loss_ratio_low [""] Scalar(|band| Some(low(band.loss))),
            "lower end of the 90 % interval of the contact loss, divided by the contact loss of this solution";
        band_loss_ratio_high [""] Scalar(|band| Some(high(band.loss))),
            "upper end of the 90 % interval of the contact loss, divided by the contact loss of this solution";
        band_ball_torque_low_Nm ["N m"] Scalar(|band| Some(low(band.screw_torque))),
            "torque of the balls: lower end of its 90 % interval";
        band_ball_torque_high_Nm ["N m"] Scalar(|band| Some(high(band.screw_torque))),
            "torque of the balls: upper end of its 90 % interval";
        band_efficiency_low [""] Scalar(|band| Some(low(band.efficiency))),
            "efficiency: lower end of its 90 % interval due to uncertain friction";
        band_efficiency_high [""] Scalar(|band| Some(high(band.efficiency))),
            "efficiency: upper end of its 90 % interval due to uncertain friction";
    }
}

/// Inputs of a lubricated ball that are required to calculate the intervals.
pub(crate) const NEEDS: Needs = Needs::LUBRICATED;

/// Note that explains why a lubricated operating point has no uncertainty interval.
pub(crate) const NO_INTERVAL: &str = "No 90 % interval of the friction is calculated, because most random samples of the uncertain inputs have no steady state.";

/// Calculates the uncertainty intervals for a solved operating point.
///
/// # Errors
///
/// Returns [`CaseError`] if the inputs are invalid for the model.
pub(crate) fn numbers(
    case: &Case,
    settings: &Settings,
    solution: &Solution,
    work: &mut ModelWorkspace,
) -> Result<Numbers, CaseError> {
    let problem = case.problem(settings)?;
    let band = solution.steady_state().and_then(|solved| problem.loss_interval(solved, work));
    Ok(match band {
        Some(band) => read(&band, |_| true),
        None => Numbers::none(QUANTITIES).with_reason(Some(NO_INTERVAL.to_owned())),
    })
}

/// Returns the lower end of an interval.
pub(crate) fn low([one, other]: [f64; 2]) -> f64 {
    one.min(other)
}

/// Returns the upper end of an interval.
pub(crate) fn high([one, other]: [f64; 2]) -> f64 {
    one.max(other)
}
