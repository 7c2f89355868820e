//! Losses outside the contacts between balls and raceways.
//!
//! Theory: `docs/theory/17-lubricant.md`, equations (Y24) to (Y27).

use bsm_kin::Real;

use crate::contact::jam::viscous_drag;

/// Parameters of the losses outside the contacts. By default there are no such losses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Losses<D = f64> {
    /// Torque of the seals \[N·m\].
    pub seal_torque: D,
    /// Force between neighboring balls \[N\].
    pub ball_contact_force: D,
    /// Friction coefficient between balls.
    pub ball_contact_friction: D,
    /// Number of ball returns.
    pub return_circuits: D,
    /// Kinetic energy lost in a return, divided by the kinetic energy of the ball, `$\zeta$`.
    pub return_loss: D,
    /// Drag coefficient of a ball in the lubricant.
    pub drag_coefficient: D,
}

/// Power lost outside the contacts \[W\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutsidePower<D = f64> {
    /// Power lost in the seals.
    pub seal: D,
    /// Power lost in ball-to-ball contact.
    pub ball_contact: D,
    /// Power lost in the ball returns.
    pub ball_return: D,
    /// Power lost by drag of the lubricant on the balls.
    pub drag: D,
}

impl<D: Real> OutsidePower<D> {
    /// Returns the power lost by the balls. The seals heat the lubricant, but are part of the
    /// torque of the whole screw.
    #[inline(always)]
    pub fn of_balls(&self) -> D {
        self.ball_contact + self.ball_return + self.drag
    }

    /// Returns the torque on the screw \[N·m\] that the losses of the balls add, for a relative
    /// speed \[rad/s\].
    #[inline(always)]
    pub fn torque(&self, relative_speed: D) -> D {
        // T = Z T_ball + Σ P/W                                            (Y27)
        self.of_balls() / relative_speed
    }
}

/// A ball that travels around the screw.
#[derive(Debug, Clone, Copy)]
pub struct BallOrbit<D> {
    /// `$|(\omega - P k) \times t|$` \[rad/s\].
    pub sliding_speed: D,
    /// `$|P - \Omega_n|$` \[rad/s\].
    pub rate: D,
    /// `$|W|$` \[rad/s\].
    pub relative_speed: D,
    /// Radius \[m\].
    pub radius: D,
    /// Mass \[kg\].
    pub mass: D,
    /// Radius of the helix of the ball centers \[m\].
    pub pitch_radius: D,
    /// Length of the helix per radian `$d$` \[m\].
    pub arc: D,
    /// Number of balls.
    pub balls: D,
}

impl<D: Real> Losses<D> {
    /// Returns the powers for a motion.
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
