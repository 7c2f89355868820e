//! Running preload and drag torque of two nuts that are preloaded against each other by an offset.
//! Each nut is represented by one ball.
//!
//! Theory: `docs/theory/22-third-contact.md`, equations (AC8) and (AC9).

use bsm_newton::{Bracket, EvalError, FunctionValue};

use super::{AxialCondition, GothicBall, GothicState, GothicWorkspace};
use crate::models::ball::{SolveFailure, domain_error};

/// Two nuts that are preloaded against each other by an offset of their grooves. Each nut is
/// represented by one ball.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GothicPair {
    /// Ball of the nut that moves against its axial force. The other nut is driven by its axial
    /// force, and its ball is the mirror image of this ball.
    pub driving: GothicBall,
    /// Offset of the nuts relative to each other, measured from first contact of both balls \[m\],
    /// positive.
    pub offset: f64,
}

/// Two preloaded nuts in steady motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunningPair {
    /// Ball of the nut that moves against its axial force.
    pub driving: GothicState,
    /// Ball of the nut that is driven by its axial force, mirrored onto the + flanks with reversed
    /// speeds.
    pub back_driven: GothicState,
    /// Friction torque of both balls \[N·m\].
    pub friction_torque: f64,
}

/// Relative tolerance of the nut displacement. The resulting relative error of the forces is 3/2
/// times as large.
const DISPLACEMENT_TOL: f64 = 1e-11;

/// Relative tolerance of the force balance between the two nuts.
const FORCE_TOL: f64 = 1e-6;

impl GothicPair {
    /// Returns the force between the nuts without friction and external load \[N\].
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`] if the offset does not load the balls.
    pub fn force_at_rest(&self, work: &mut GothicWorkspace) -> Result<f64, SolveFailure> {
        self.driving.force_at_rest(0.5 * self.offset, work)
    }

    /// Creates a pair of nuts with a given preload \[N\], which is the force between the nuts
    /// without friction and external load.
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`] if the grooves cannot carry the preload.
    pub fn of_preload(
        driving: GothicBall,
        preload: f64,
        work: &mut GothicWorkspace,
    ) -> Result<Self, SolveFailure> {
        let offset = 2.0 * driving.deflection_at_rest(preload, work)?;
        Ok(Self { driving, offset })
    }

    /// Solves for the steady motion of both nuts under an external load \[N\] on the nut that moves
    /// against its axial force (AC8).
    ///
    /// # Errors
    ///
    /// Returns [`SolveFailure`] if the external load unloads the other nut, or if a ball has no
    /// steady motion.
    pub fn solve(
        &self,
        external: f64,
        work: &mut GothicWorkspace,
    ) -> Result<RunningPair, SolveFailure> {
        let touch = self.driving.first_touch()?;
        let back = self.driving.back_driven();
        let at = |u: f64, near: Option<&[GothicState; 2]>, work: &mut GothicWorkspace| {
            let [there, other] =
                [u, self.offset - u].map(|u| AxialCondition::Displacement(touch + u));
            let driving = self.driving.solve(there, near.map(|near| &near[0]), work)?;
            let back_driven = back.solve(other, near.map(|near| &near[1]), work)?;
            Ok::<_, SolveFailure>([driving, back_driven])
        };
        // Displacement, excess force and its derivative at the last solved displacement.
        let mut last: Option<(f64, f64, f64)> = None;
        let mut balls: Option<[GothicState; 2]> = None;
        let mut failure: Option<SolveFailure> = None;
        let bracket = Bracket {
            start: Some(0.5 * self.offset),
            x_tol: DISPLACEMENT_TOL,
            ..Bracket::new([0.0, self.offset], [f64::NEG_INFINITY, f64::INFINITY])
        };
        let found = bracket.root(|u| {
            let found = match at(u, balls.as_ref(), work) {
                Ok(found) => *balls.insert(found),
                Err(error) => {
                    failure = Some(error);
                    // If the search takes a very long step, a ball may have no solution there. Only
                    // the sign of the excess force is then needed, and the tangent at the last
                    // solved displacement predicts this sign. The balance of the forces at the root
                    // is checked below, so a wrong sign is detected.
                    let expected = last.map(|(before, value, slope)| value + slope * (u - before));
                    let sign = expected.map_or(f64::NAN, f64::signum);
                    return FunctionValue::from(sign * f64::INFINITY);
                }
            };
            // (w − w_t)_drive + (w − w_t)_back = O cosα,  F_d − F_b = F   (AC8)
            let [driving, back_driven] = found.map(|ball| ball.axial_force);
            let excess = driving - back_driven - external;
            // Each force is approximately proportional to the deflection to the power 3/2.
            let rough = 1.5 * (driving / u + back_driven / (self.offset - u));
            let secant = last.map(|(before, value, _)| (excess - value) / (u - before));
            let slope = secant.filter(|slope| *slope > 0.0).unwrap_or(rough);
            last = Some((u, excess, slope));
            FunctionValue::from((excess, slope))
        });
        let unbalanced = failure.unwrap_or_else(|| {
            domain_error(EvalError {
                quantity: "external load on a preloaded pair [N]",
                value: external,
                requirement: "must be small enough for both nuts to stay loaded",
            })
        });
        let Some(root) = found.root() else { return Err(unbalanced) };
        let [driving, back_driven] = at(root.x, balls.as_ref(), work)?;
        let force = driving.axial_force.max(external.abs());
        if (driving.axial_force - back_driven.axial_force - external).abs() > FORCE_TOL * force {
            return Err(unbalanced);
        }
        let speed = self.driving.screw.point.drive.relative_speed().abs();
        // T_f = (P_d + P_b)/|W|                                           (AC9)
        let friction_torque = (driving.friction_power() + back_driven.friction_power()) / speed;
        Ok(RunningPair { driving, back_driven, friction_torque })
    }
}

impl RunningPair {
    /// Returns the mean force on both nuts \[N\]. Without external load, this is the running
    /// preload.
    pub fn force(&self) -> f64 {
        0.5 * (self.driving.axial_force + self.back_driven.axial_force)
    }

    /// Returns the drag coefficient `$K_p$` for a given preload \[N\] and lead \[m\].
    pub fn drag_coefficient(&self, preload: f64, lead: f64) -> f64 {
        // K_p = T_f/(F_p h)                                               (AC9)
        self.friction_torque / (preload * lead / std::f64::consts::TAU)
    }
}
