//! Steady motions along the solution branch with increasing inertia, as table columns.

use bsm_dyn::{ModelWorkspace, SteadyState};

use crate::answers::record::message;
use crate::vocabulary::number::count;
use crate::vocabulary::quantity::quantities;
use crate::{Case, CaseError, Numbers, Settings};

quantities! { pub(crate) QUANTITIES, read(&Efficiencies) of Branch;
    "branch of increasing inertia" {
        branch_solutions [""] Scalar(|branch| Some(count(branch.0.len()))),
            "number of steady motions on the branch that begins at a ball without inertia, for the models rigid and traction; tracing the branch takes as long as solving many operating points";
        branch_efficiency_low [""] Scalar(|branch| branch.0.iter().copied().reduce(f64::min)),
            "lowest efficiency of the steady motions on the branch";
        branch_efficiency_high [""] Scalar(|branch| branch.0.iter().copied().reduce(f64::max)),
            "highest efficiency of the steady motions on the branch";
    }
}

/// Reason why a model has no branch.
const NO_BRANCH: &str = "the branch of increasing inertia can be followed only with the model rigid or traction (not auto), without a lubricant and without axial_play_um";

/// Efficiencies of the steady motions on a solution branch.
struct Efficiencies(Vec<f64>);

/// Follows the solution branch at the operating point of a case and calculates its steady motions.
/// If the model does not support this, or if the branch is lost, the numbers are missing and a text
/// states the reason.
///
/// # Errors
///
/// Returns [`CaseError`] if the inputs are invalid for the model.
pub(crate) fn numbers(
    case: &Case,
    settings: &Settings,
    work: &mut ModelWorkspace,
) -> Result<Numbers, CaseError> {
    let none = |why: String| Numbers::none(QUANTITIES).with_reason(Some(why));
    Ok(match case.problem(settings)?.branch(work) {
        None => none(NO_BRANCH.to_owned()),
        Some(Err(no_answer)) => none(message(no_answer.reason())),
        Some(Ok(states)) => {
            let efficiency = |state: &SteadyState| state.transmission.efficiency;
            read(&Efficiencies(states.iter().map(efficiency).collect()), |_| true)
        }
    })
}
