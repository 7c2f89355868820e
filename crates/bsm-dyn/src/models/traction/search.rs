//! The search for the root of a point, and the criterion for `no_solution`.
//!
//! Theory: `docs/theory/09-traction.md`, sections "Starting values" and "Existence".

use bsm_kin::Motion;
use nalgebra::Vector3;

use super::equations::SlipBall;
use super::path::{PathResult, STEP_CONTROL};
use super::root::{START_LIMITS, SlipRoot};
use crate::models::ball::{Evidence, NoAnswer, Reason, Workspace};
use crate::models::elastic::GrossSlip;
use crate::models::raceway_control::RollingBall;

/// Onset number above which the skidding ball is the nearer starting value.
const SKID_ONSET: f64 = 0.5;

/// A ball from which Newton's method starts.
#[derive(Clone, Copy)]
enum StartingBall {
    Rolling,
    /// Its slips are nearly those of the root.
    Skidding,
    AtRestInNut,
}

impl SlipBall<'_> {
    /// Returns the root that Newton's method finds from the rolling or the skidding ball, the nearer
    /// one first, or from a ball at rest in the nut, where large inertia holds it.
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
        let ball = SlipBall { limits: START_LIMITS, ..*self };
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
            ball.solved(y, newton, steps).ok()
        })
    }

    /// Returns the root: directly, or else by continuation in inertia.
    ///
    /// If the contact angles leave the flanks along the continuation, there is no root on this
    /// branch.
    pub(super) fn search(
        &self,
        rolling_ball: &RollingBall,
        newton: &mut Workspace,
        steps: &mut usize,
    ) -> Result<SlipRoot, NoAnswer> {
        if let Some(root) = self.direct(rolling_ball, newton, steps) {
            return Ok(root);
        }
        let mut path = self.followed(newton, steps);
        if matches!(path, PathResult::Nothing) {
            // Under a high centrifugal load, the unknowns (T1) lose their digits.
            path = SlipBall { nut_chart: true, ..*self }.followed(newton, steps);
        }
        match path {
            PathResult::SlipRoot(root) => Ok(root),
            PathResult::OffFlank([nut, screw]) => {
                let evidence = Evidence::Traced { resolution: STEP_CONTROL.longest };
                Err(NoAnswer::none(evidence, Reason::BallLeavesFlank { nut, screw }))
            }
            PathResult::Nothing => Err(NoAnswer::LOST),
        }
    }
}
