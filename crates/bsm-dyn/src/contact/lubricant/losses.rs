//! Power losses outside the contacts of balls and raceways.
//!
//! Theory: `docs/theory/17-lubricant.md`, equations (Y24) to (Y27).

use bsm_kin::Real;

use crate::contact::jam::viscous_drag;

/// Parameters of the power losses outside the contacts. If all parameters are zero, there are no
/// such losses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Losses<D = f64> {
    /// Torque of the seals \[N·m\].
    pub seal_torque: D,
    /// Normal force between neighboring balls \[N\].
    pub ball_contact_force: D,
    /// Friction coefficient between balls.
    pub ball_contact_friction: D,
    /// Number of ball returns.
    pub return_circuits: D,
    /// Fraction `$\zeta$` of its kinetic energy that a ball loses in a ball return.
    pub return_loss: D,
    /// Drag coefficient of a ball that moves through the lubricant.
    pub drag_coefficient: D,
}

/// Power losses outside the contacts of balls and raceways \[W\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutsidePower<D = f64> {
    /// Power loss in the seals.
    pub seal: D,
    /// Power loss at the contacts between balls.
    pub ball_contact: D,
    /// Power loss in the ball returns.
    pub ball_return: D,
    /// Power loss due to the drag of the lubricant on the balls.
    pub drag: D,
}

impl<D: Real> OutsidePower<D> {
    /// Returns the sum of the power losses due to the balls. The seal loss is excluded: it also
    /// heats the lubricant, but the seal torque acts on the whole screw instead of a single ball.
    #[inline(always)]
    pub fn of_balls(&self) -> D {
        self.ball_contact + self.ball_return + self.drag
    }

    /// Returns the additional torque on the screw \[N·m\] due to the power losses of the balls, for
    /// a relative speed \[rad/s\].
    #[inline(always)]
    pub fn torque(&self, relative_speed: D) -> D {
        // T = Z T_ball + Σ P/W                                            (Y27)
        self.of_balls() / relative_speed
    }
}

/// Motion of a ball that orbits the screw axis.
#[derive(Debug, Clone, Copy)]
pub struct BallOrbit<D> {
    /// Angular speed with which neighboring balls slide on each other, `$|(\omega - P k) \times
    /// t|$` \[rad/s\].
    pub sliding_speed: D,
    /// Precession rate relative to the nut `$|P - \Omega_n|$` \[rad/s\].
    pub rate: D,
    /// Relative speed `$|W|$` \[rad/s\].
    pub relative_speed: D,
    /// Ball radius \[m\].
    pub radius: D,
    /// Ball mass \[kg\].
    pub mass: D,
    /// Radius of the helix of the ball centers \[m\].
    pub pitch_radius: D,
    /// Length of the helix per radian `$d$` \[m\].
    pub arc: D,
    /// Number of balls.
    pub balls: D,
}

impl<D: Real> Losses<D> {
    /// Returns the power losses for a given motion of the balls.
    ///
    /// * `density`: density of the lubricant \[kg/m³\].
    #[inline(always)]
    pub fn power(&self, ball: &BallOrbit<D>, density: D) -> OutsidePower<D> {
        let BallOrbit { sliding_speed, rate, relative_speed, radius, mass, .. } = *ball;
        let travel = ball.arc * rate;
        // P = Z μ_bb F_bb 2 r_b |(ω − P k) × t|                           (Y25)
        let ball_contact = ball.balls
            * self.ball_contact_friction
            * self.ball_contact_force
            * radius
            * sliding_speed
            * 2.0;
        // P = n_c ζ (m v²/2) v/(2 r_b),  v = d |P − Ω_n|                  (Y26)
        let ball_return = self.return_circuits * self.return_loss * mass * travel.square() * travel
            / (radius * 4.0);
        // P = Z F_v v                                                     (Y27)
        let around = ball.pitch_radius * rate * 2.0;
        let drag = viscous_drag(self.drag_coefficient, density, radius * 2.0, around);
        OutsidePower {
            // P = T_seal |W|                                              (Y24)
            seal: self.seal_torque * relative_speed,
            ball_contact,
            ball_return,
            drag: ball.balls * drag * travel,
        }
    }
}
