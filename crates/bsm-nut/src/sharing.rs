//! A nut whose balls share the load equally.
//!
//! Theory: `docs/theory/16-nut.md`, equation (U28).

use crate::geometry::count;
use crate::{BallNut, NutError};

/// The ball of a nut that shares its load equally.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Equal {
    /// Normal load of each ball \[N\].
    pub load: f64,
    /// Contact angle \[rad\].
    pub angle: f64,
    /// Displacement of the nut along the axis \[m\].
    pub displacement: f64,
    /// Stiffness of the nut along the axis \[N/m\].
    pub stiffness: f64,
}

impl BallNut {
    /// The nut with rigid bodies, no errors and guides: every ball carries its equal share of an axial
    /// load \[N\], not zero.
    ///
    /// # Errors
    ///
    /// [`NutError::Contact`], [`NutError::NoBalls`], [`NutError::NothingCarries`].
    pub fn equal(&self, axial: f64) -> Result<Equal, NutError> {
        let balls = count(self.balls());
        if balls == 0.0 {
            return Err(NutError::NoBalls);
        }
        let ball = self.ball_in_grooves().map_err(NutError::Contact)?.series;
        let alpha = self.helix.lead_angle;
        // Z Q m_b cosα = F                                                (U28)
        let (displacement, pressing) = ball
            .under(axial.abs() / balls, alpha)
            .map_err(|_| NutError::NothingCarries { moved: f64::NAN })?;
        let stiffness = balls * pressing.slope[0][0] * alpha.cos().powi(2);
        let displacement = displacement * axial.signum();
        Ok(Equal { load: pressing.load, angle: pressing.angle, displacement, stiffness })
    }

    /// Where to begin the search of a nut.
    pub(crate) fn equal_displacement(&self, axial: f64) -> Option<f64> {
        (axial != 0.0).then(|| self.equal(axial).ok()).flatten().map(|equal| equal.displacement)
    }
}
