//! A lubricated ball that friction may press against the far flank of a gothic arch.
//!
//! Theory: `docs/theory/22-third-contact.md`, equations (AC11) and (AC12).

use bsm_kin::{Jet, Site};
use bsm_newton::EvalError;

use crate::contact::Coulomb;
use crate::models::ball::{
    FarFlank, Performance, Reason, Solution, SolveFailure, SteadyState, ThirdContact, Transmission,
};
use crate::models::gothic::{ArchFit, GothicBall};
use crate::models::lubricated::{LubricatedBall, LubricatedModel};
use crate::models::traction::Traction;
use crate::models::workspace::ModelWorkspace;

/// A lubricated ball in gothic arches with a given axial play, radial gap and oversize.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LubricatedArch<D = f64> {
    /// Lubricated ball that touches only the two loaded flanks.
    pub ball: LubricatedBall<D>,
    /// Axial play, radial gap and oversize of the ball in the gothic arches.
    pub fit: ArchFit<D>,
    /// Friction coefficient at the far flanks. Defaults to the mean friction coefficient of the
    /// loaded flanks.
    pub far_friction: Option<D>,
}

impl LubricatedArch {
    /// Solves for the lubricated ball with two contacts and, if friction presses the ball against a
    /// far flank, adds the power loss due to this third contact.
    ///
    /// The additional power loss is calculated with dry friction. The friction coefficient of the
    /// loaded contacts is the mean friction coefficient of the lubricated contacts; the third
    /// contact has the same coefficient unless [`far_friction`](Self::far_friction) is given. In
    /// the raceway-control model, friction does not move the ball, so there is no third contact.
    pub fn solve(&self, work: &mut ModelWorkspace) -> Solution {
        let solution = self.ball.solve(work);
        let LubricatedModel::Traction(case) = self.ball.model else { return solution };
        let result = solution.result.and_then(|two| self.with_third_contact(&case, &two, work));
        Solution { result, ..solution }
    }

    fn with_third_contact(
        &self,
        case: &Traction,
        two: &SteadyState,
        work: &mut ModelWorkspace,
    ) -> Result<SteadyState, SolveFailure> {
        let Some(film) = two.film else { return Ok(*two) };
        let mean = film.mean_friction();
        let mut dry = GothicBall {
            screw: case.screw,
            fit: self.fit,
            far_friction: Coulomb(self.far_friction.unwrap_or(mean)),
            accuracy: case.accuracy,
            creep: case.creep,
        };
        dry.screw.point.friction = Coulomb(mean);
        let found = dry.solution(&mut work.gothic).result?;
        let Some(FarFlank { gap, contact: Some(contact), two_contact_power }) = found.far_flank
        else {
            return Ok(SteadyState { far_flank: found.far_flank, ..*two });
        };
        let powers = found.transmission.power.zip(two_contact_power);
        let Some((dry_power, dry_two)) = powers else { return Err(SolveFailure::SEARCH_FAILED) };
        // ΔP = P(f̄) − P₂(f̄)                                               (AC12)
        let surplus = dry_power.dissipated - dry_two;
        let point = &case.screw.point;
        let speed = point.drive.relative_speed();
        let (torque, power) = (two.transmission.screw_torque, two.transmission.power);
        let Some((torque, power)) = torque.zip(power) else {
            return Err(SolveFailure::SEARCH_FAILED);
        };
        let transmission =
            Transmission::of(speed < 0.0, point.ideal_torque(), torque + surplus / speed, speed)
                .with_power_balance(power.dissipated + surplus)
                .balanced()?;
        let of_contact = contact.power_share * dry_power.dissipated;
        let power_share = of_contact / (power.dissipated + surplus);
        let contact = ThirdContact { power_share, ..contact };
        let body = usize::from(contact.site == Site::Screw);
        let contact_power = two.contact_power.map(|mut power| {
            power[body] += surplus;
            power
        });
        let mut film = film;
        film.sliding_power += surplus;
        Ok(SteadyState {
            transmission,
            film: Some(film),
            contact_power,
            far_flank: Some(FarFlank {
                gap,
                contact: Some(contact),
                two_contact_power: Some(power.dissipated),
            }),
            ..*two
        })
    }
}

impl<const M: usize> LubricatedArch<Jet<M>> {
    /// Returns the efficiency and the torque with their derivatives with respect to the inputs.
    /// Balls with a third contact are rejected.
    pub(crate) fn sensitivities(
        &self,
        work: &mut ModelWorkspace,
    ) -> Result<Performance<Jet<M>>, SolveFailure> {
        let found = self.values().solve(work).result?;
        if found.far_flank.is_some_and(|far| far.contact.is_some()) {
            return Err(SolveFailure::invalid(Reason::Refused {
                error: EvalError {
                    quantity: "axial play [m]",
                    value: self.fit.axial_play.re,
                    requirement: "must exceed the threshold play, because derivatives of lubricated balls with three contacts are not available",
                },
            }));
        }
        self.ball.sensitivities(work)
    }

    fn values(&self) -> LubricatedArch {
        LubricatedArch {
            ball: self.ball.values(),
            fit: self.fit.values(),
            far_friction: self.far_friction.map(|friction| friction.re),
        }
    }
}
