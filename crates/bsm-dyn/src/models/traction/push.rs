//! Forces on a ball from its two neighbors in the ball train.
//!
//! Theory: `docs/theory/20-ball-train.md`, equations (O2) and (O3).

use bsm_kin::{BallFrame, Motion, Over, Scalar};

use crate::contact::Wrench;
use crate::models::ball::{BALL_UNKNOWNS, BallLoads, ElasticContacts};

/// Normal forces of both neighboring balls, divided by the axial load of the ball.
#[derive(Debug, Clone, Copy)]
pub(super) struct Push {
    /// Force of the ball in front (in the direction of travel), divided by the axial load.
    pub(super) front: f64,
    /// Force of the ball behind, divided by the axial load.
    pub(super) back: f64,
    /// Friction coefficient between balls.
    pub(super) friction: f64,
}

impl Push {
    /// Returns the force and the moment of the two neighbors on the ball, in scaled units.
    pub(super) fn wrench<P: Scalar, D: Over<P>>(
        &self,
        contacts: &ElasticContacts<P>,
        frame: &BallFrame<D>,
        to_nut: &Motion<D>,
    ) -> Wrench<D> {
        let rolling = to_nut.across_groove(&frame.k);
        let speed = rolling.dot(&rolling).sqrt();
        let normal = D::from(self.front + self.back);
        // M_b = −f_b r_b (N_f + N_b) e                                    (O2)
        let moment = rolling * -contacts.signed(normal * self.friction / speed);
        // F_b = [s (N_b − N_f) − (M_b·k)/d] t                             (O3)
        let along = contacts.signed(D::from(self.back - self.front))
            - moment.dot(&frame.k) / D::from(contacts.scaled.arc);
        Wrench { force: BallFrame::tangent() * along, moment }
    }

    /// Adds the force and the moment of the two neighbors to the residuals of the force and moment
    /// balance.
    pub(super) fn add_to<P: Scalar, D: Over<P>>(
        &self,
        residual: &mut [D; BALL_UNKNOWNS],
        contacts: &ElasticContacts<P>,
        (loaded, to_nut): (&BallLoads<D>, &Motion<D>),
    ) {
        let Wrench { force, moment } = self.wrench(contacts, &loaded.frame, to_nut);
        for (residual, term) in residual.iter_mut().zip(force.iter().chain(moment.iter())) {
            *residual += *term;
        }
    }
}
