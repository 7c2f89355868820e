//! Two nuts that are preloaded by an offset, one ball in each: the running preload and the drag.
//!
//! Theory: `docs/theory/22-third-contact.md`, equations (AC8) and (AC9).

use bsm_newton::{Bracket, EvalError};

use super::{AxialCondition, GothicBall, GothicState, GothicWorkspace};
use crate::models::ball::{NoAnswer, domain_error};

/// A pair of nuts with one ball in each that an offset of their grooves presses against each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GothicPair {
    /// The ball that moves its load against its force; the ball of the other nut is its mirror image, and driven by its
    /// force.
    pub driving: GothicBall,
    /// Offset of the nuts against each other, counted from first touch of both \[m\], positive.
    pub offset: f64,
}

/// A running pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunningPair {
    /// The ball that moves its load.
    pub driving: GothicState,
    /// The ball that its load drives, mirrored onto the flanks +: its speeds are reversed.
    pub back_driven: GothicState,
    /// Friction torque of both balls \[N·m\].
    pub friction_torque: f64,
}

/// Relative accuracy of the displacement of the nuts, whose forces grow as its power of 3/2.
const DISPLACEMENT: f64 = 1e-11;

impl GothicPair {
    /// Force between the nuts without friction and external load \[N\].
    ///
    /// # Errors
    ///
    /// [`NoAnswer`] if the offset does not press the balls.
    pub fn force_at_rest(&self, work: &mut GothicWorkspace) -> Result<f64, NoAnswer> {
        self.driving.force_at_rest(0.5 * self.offset, work)
    }

    /// The pair whose force without friction and external load is `preload` \[N\].
    ///
    /// # Errors
    ///
    /// [`NoAnswer`] if the grooves cannot carry that force.
    pub fn of_preload(
        driving: GothicBall,
        preload: f64,
        work: &mut GothicWorkspace,
    ) -> Result<Self, NoAnswer> {
        let offset = 2.0 * driving.deflection_at_rest(preload, work)?;
        Ok(Self { driving, offset })
    }

    /// Solves for the running pair under an external load \[N\] that the driving ball carries (AC8).
    ///
    /// # Errors
    ///
    /// [`NoAnswer`] if the external load lifts the other nut off, or a ball has no steady motion.
    pub fn solve(
        &self,
        external: f64,
        work: &mut GothicWorkspace,
    ) -> Result<RunningPair, NoAnswer> {
        let touch = self.driving.first_touch()?;
        let back = self.driving.back_driven();
        let at = |u: f64, near: Option<&[GothicState; 2]>, work: &mut GothicWorkspace| {
            let [there, other] =
                [u, self.offset - u].map(|u| AxialCondition::Displacement(touch + u));
            let driving = self.driving.solve(there, near.map(|near| &near[0]), work)?;
            let back_driven = back.solve(other, near.map(|near| &near[1]), work)?;
            Ok::<_, NoAnswer>([driving, back_driven])
        };
        let mut last: Option<(f64, f64)> = None;
        let mut balls: Option<[GothicState; 2]> = None;
        let mut failure: Option<NoAnswer> = None;
        let bracket = Bracket {
            start: Some(0.5 * self.offset),
            x_tol: DISPLACEMENT,
            ..Bracket::new([0.0, self.offset], [f64::NEG_INFINITY, f64::INFINITY])
        };
        let found = bracket.root(|u| {
            let found = match at(u, balls.as_ref(), work) {
                Ok(found) => *balls.insert(found),
                Err(why) => {
                    failure = Some(why);
                    return (f64::NAN, f64::NAN);
                }
            };
            // (w − w_t)_drive + (w − w_t)_back = O cosα,  F_d − F_b = F   (AC8)
            let [driving, back_driven] = found.map(|ball| ball.axial_force);
            let excess = driving - back_driven - external;
            // Each force grows about as its deflection to the power 3/2.
            let rough = 1.5 * (driving / u + back_driven / (self.offset - u));
            let secant =
                last.replace((u, excess)).map(|(before, value)| (excess - value) / (u - before));
            (excess, secant.filter(|slope| *slope > 0.0).unwrap_or(rough))
        });
        if let Some(why) = failure {
            return Err(why);
        }
        let lifted = domain_error(EvalError {
            quantity: "external load on a preloaded pair [N]",
            value: external,
            requirement: "so small that both nuts stay loaded",
        });
        let root = found.root().ok_or_else(|| lifted.clone())?;
        let [driving, back_driven] = at(root.x, balls.as_ref(), work)?;
        let force = driving.axial_force.max(external.abs());
        if (driving.axial_force - back_driven.axial_force - external).abs() > 1e-6 * force {
            return Err(lifted);
        }
        let speed = self.driving.at.point.drive.relative_speed().abs();
        // T_f = (P_d + P_b)/|W|                                           (AC9)
        let friction_torque = (driving.friction_power() + back_driven.friction_power()) / speed;
        Ok(RunningPair { driving, back_driven, friction_torque })
    }
}

impl RunningPair {
    /// Mean of the forces of both nuts \[N\]: the running preload of a pair without external load.
    pub fn force(&self) -> f64 {
        0.5 * (self.driving.axial_force + self.back_driven.axial_force)
    }

    /// Drag coefficient `$K_p$` over a preload \[N\], of a lead \[m\].
    pub fn drag_coefficient(&self, preload: f64, lead: f64) -> f64 {
        // K_p = T_f/(F_p h)                                               (AC9)
        self.friction_torque / (preload * lead / std::f64::consts::TAU)
    }
}
