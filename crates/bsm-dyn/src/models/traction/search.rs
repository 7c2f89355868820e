//! Search for a root of the traction equations, and criterion for the status `no_solution`.
//!
//! Theory: `docs/theory/09-traction.md`, sections "Starting values" and "Existence".

use bsm_kin::Motion;
use nalgebra::Vector3;

use super::equations::SlipBall;
use super::path::{PathResult, STEP_CONTROL};
use super::root::SlipRoot;
use crate::models::ball::{Evidence, Reason, SolveFailure, Workspace};
use crate::models::elastic::GrossSlip;
use crate::models::raceway_control::RollingBall;

/// Onset number (dimensionless) above which Newton's method starts first from the skidding ball and
/// then from the rolling ball.
const SKID_ONSET: f64 = 0.5;

/// Starting values of Newton's method.
#[derive(Clone, Copy)]
enum StartingBall {
    /// Start from the solution for a rolling ball.
    Rolling,
    /// Start from the solution with gross slip in both contacts, which is close to a root with
    /// gross skid.
    Skidding,
    /// Start from a ball that is at rest relative to the nut.
    AtRestInNut,
}

impl SlipBall<'_> {
    /// Tries three starting values and returns the first root to which Newton's method converges,
    /// or `None`.
    ///
    /// The solutions for a rolling ball and for a skidding ball are tried first, in an order that
    /// depends on the onset number. The third starting value is a ball at rest relative to the nut,
    /// which is close to the root under large inertia forces.
    pub(super) fn direct(
        &self,
        rolling_ball: &RollingBall,
        newton: &mut Workspace,
        steps: &mut usize,
    ) -> Option<SlipRoot> {
        let onset = rolling_ball.skid(self.contacts).onset_number();
        let starts = if onset.is_some_and(|onset| onset > SKID_ONSET) {
            [StartingBall::Skidding, StartingBall::Rolling, StartingBall::AtRestInNut]
        } else {
            [StartingBall::Rolling, StartingBall::Skidding, StartingBall::AtRestInNut]
        };
        starts.into_iter().find_map(|start| {
            let y = match start {
                StartingBall::Rolling => {
                    let y = self.unknowns(&rolling_ball.loaded, &rolling_ball.to_nut);
                    self.first_slips(&y, newton, steps)?
                }
                StartingBall::Skidding => {
                    let skid = GrossSlip::start(self.contacts).ok()?;
                    *steps += skid.steps();
                    let (loaded, to_nut) = skid.state();
                    self.unknowns(loaded, to_nut)
                }
                StartingBall::AtRestInNut => {
                    let [nut, screw, tilt] =
                        self.contacts.static_balance(self.contacts.scaled.nut_speed);
                    let loaded = self.contacts.loaded([nut, screw], tilt).ok()?;
                    let still = Motion { precession: 0.0, omega: Vector3::zeros() };
                    self.first_slips(&self.unknowns(&loaded, &still), newton, steps)?
                }
            };
            self.solved(y, newton, steps).ok()
        })
    }

    /// Finds a root by Newton's method or, if this fails, by continuation in inertia.
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`] with [`Reason::BallLeavesFlank`] if a contact leaves its flank
    /// during the continuation, so that this branch has no root, and
    /// [`SolveFailure::SEARCH_FAILED`] if the continuation fails.
    pub(super) fn search(
        &self,
        rolling_ball: &RollingBall,
        newton: &mut Workspace,
        steps: &mut usize,
    ) -> Result<SlipRoot, SolveFailure> {
        if let Some(root) = self.direct(rolling_ball, newton, steps) {
            return Ok(root);
        }
        let mut path = self.followed(newton, steps);
        if matches!(path, PathResult::Lost) {
            // Under a high centrifugal load, the equations in the unknowns (T1) suffer from
            // cancellation.
            path = SlipBall { uses_nut_angle: true, ..*self }.followed(newton, steps);
        }
        match path {
            PathResult::SlipRoot(root) => Ok(root),
            PathResult::OffFlank([nut, screw]) => {
                let evidence = Evidence::Traced { resolution: STEP_CONTROL.max_step };
                Err(SolveFailure::no_solution(evidence, Reason::BallLeavesFlank { nut, screw }))
            }
            PathResult::Lost => Err(SolveFailure::SEARCH_FAILED),
        }
    }
}
