//! Equal load sharing among all balls of a nut.
//!
//! Theory: `docs/theory/16-nut.md`, equations (U26) and (U27).

use bsm_dyn::model::StaticBall;

use crate::geometry::count;
use crate::{BallNut, BallPosition, Bar, Circuit, Errors, Freedom, NutError, Support};

/// State of a nut in which all balls carry equal loads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EqualShare {
    /// Normal load on each ball \[N\].
    pub load: f64,
    /// Contact angle \[rad\].
    pub angle: f64,
    /// Axial displacement of the nut \[m\].
    pub displacement: f64,
    /// Axial stiffness of the nut \[N/m\].
    pub stiffness: f64,
}

impl BallNut {
    /// Returns the state of the nut if all balls carry equal shares of a nonzero axial load \[N\].
    /// This state is exact for rigid bodies without manufacturing errors on stiff guides.
    ///
    /// # Errors
    /// Returns [`NutError::Contact`] if the contacts are not Hertzian, [`NutError::NoBalls`] if the
    /// nut has no balls, or [`NutError::NothingCarries`] if no ball can carry the load.
    pub fn equal(&self, axial: f64) -> Result<EqualShare, NutError> {
        if self.balls() == 0 {
            return Err(NutError::NoBalls);
        }
        self.equal_of(&self.ball_in_grooves().map_err(NutError::Contact)?.series, axial)
    }

    /// Returns the state of the nut with equal load sharing, calculated from given contact data of
    /// the ball.
    pub(crate) fn equal_of(&self, ball: &StaticBall, axial: f64) -> Result<EqualShare, NutError> {
        let balls = count(self.balls());
        let alpha = self.helix.lead_angle;
        // Z Q m_b cosα = F                                                (U26)
        let (displacement, pressing) = ball
            .under_axial_load(axial.abs() / balls, alpha)
            .map_err(|_| NutError::NothingCarries { moved: f64::NAN })?;
        let stiffness = balls * pressing.slope[0][0] * alpha.cos().powi(2);
        let displacement = displacement * axial.signum();
        Ok(EqualShare { load: pressing.load, angle: pressing.angle, displacement, stiffness })
    }

    /// Returns true if equal load sharing is exact. This requires rigid bodies on stiff guides,
    /// balls that are loaded on one flank only, and no manufacturing errors or offsets.
    pub fn shares_equally(&self, support: &Support) -> bool {
        let held = support.0[1..].iter().all(|freedom| *freedom == Freedom::Held(0.0));
        let rigid = self.nut_bar.is_none() && self.screw_bar.is_none() && self.ring.is_none();
        let first = &self.circuits[0];
        let alike =
            |c: &Circuit| (c.offset - first.offset).abs() <= 0.0 && c.flanks == first.flanks;
        let level = self.circuits.iter().all(alike);
        held && rigid && level && self.errors == Errors::default()
    }

    /// Returns an upper bound on the normal load on any ball under an axial load \[N\] (U27). The
    /// bound applies to a guided nut without a radial gap if the balls can carry load only on the
    /// flank that supports the axial load. At least one ball carries no more than the mean load,
    /// and the differences between the approaches of all balls are limited by the manufacturing
    /// errors and the strain of the bodies.
    ///
    /// # Errors
    ///
    /// Returns the same errors as [`equal`](Self::equal).
    pub fn load_bound(&self, axial: f64) -> Result<f64, NutError> {
        let equal = self.equal(axial)?;
        let ball = self.ball_in_grooves().map_err(NutError::Contact)?.series;
        let (sin, alpha) = (self.contact_angle.sin(), self.helix.lead_angle);
        let positions = self.positions();
        let shift = |(number, position): (usize, &BallPosition)| {
            let ([along, _], oversize) = self.error_at(number, position);
            (along + 2.0 * oversize / sin) / alpha.cos()
        };
        let shifts: Vec<f64> = positions.iter().enumerate().map(shift).collect();
        let span = |all: &mut dyn Iterator<Item = f64>| {
            let (least, most) =
                all.fold((f64::MAX, f64::MIN), |(a, b), x| (f64::min(a, x), f64::max(b, x)));
            most - least
        };
        let length = span(&mut positions.iter().map(|position| position.z));
        let compliance = |bar: Option<Bar>| bar.map_or(0.0, |bar| bar.stiffness.recip());
        // D is the difference between the maximum and the minimum of o + e + 2Δr/(sinβ₀ cosα), and
        // D_bars ≤ F l (1/EA_n + 1/EA_s)                                  (U27)
        let bars = compliance(self.nut_bar) + compliance(self.screw_bar);
        let spread = span(&mut shifts.into_iter()) + axial.abs() * length * bars;
        let along = (equal.displacement.abs() + spread) * alpha.cos();
        Ok(ball.forces_at([along, 0.0], 0.0).load)
    }
}
