//! Derivatives of the efficiency and the torque of a lubricated ball.
//!
//! Theory: `docs/theory/12-sensitivities.md`, and `docs/theory/17-lubricant.md`, equation (Y28).

use bsm_kin::Jet;

use super::solve::{LubricatedBall, LubricatedModel, contact_power_loss};
use crate::contact::{Temperature, efficiency};
use crate::models::ball::{EhlPoint, LubricatedState, Performance, SolveFailure};
use crate::models::raceway_control::RacewayControl;
use crate::models::workspace::ModelWorkspace;

/// Temperature step of a finite difference \[K\]. The step is much smaller than the range of tens
/// of kelvins over which the temperature derivative of the losses changes noticeably.
const DIFFERENCE_STEP: f64 = 1e-3;

impl<const M: usize> LubricatedBall<Jet<M>> {
    /// Returns the efficiency and the torque with their derivatives with respect to the inputs.
    pub(crate) fn sensitivities(
        &self,
        work: &mut ModelWorkspace,
    ) -> Result<Performance<Jet<M>>, SolveFailure> {
        let (heat_transfer, ambient) = match self.lubricant.temperature {
            Temperature::Known(kelvin) => return Ok(self.slopes(kelvin, work)?.0),
            Temperature::Balance { heat_transfer, ambient } => (heat_transfer, ambient),
        };
        let solved = self.values().solve(work).result?;
        let temperature = solved.film.map_or(f64::NAN, |film| film.temperature);
        let mut surplus_cooling = |kelvin: f64| {
            let (_, heat) = self.slopes(Jet::from(kelvin), work)?;
            // hA (T − T₀) − Σ P(T)                                        (Y28)
            Ok((-ambient + kelvin) * heat_transfer - heat)
        };
        let here = surplus_cooling(temperature)?;
        let slope =
            (surplus_cooling(temperature + DIFFERENCE_STEP)?.re - here.re) / DIFFERENCE_STEP;
        let kelvin = Jet { re: temperature, eps: here.eps.map(|eps| -eps / slope) };
        Ok(self.slopes(kelvin, work)?.0)
    }

    /// Returns the inputs without derivatives.
    pub(crate) fn values(&self) -> LubricatedBall {
        let model = match &self.model {
            LubricatedModel::RacewayControl(case, friction) => {
                let (screw, control) = (case.screw.values(), case.control);
                LubricatedModel::RacewayControl(RacewayControl { screw, control }, *friction)
            }
            LubricatedModel::Traction(case) => LubricatedModel::Traction(case.values()),
        };
        LubricatedBall { lubricant: self.lubricant.map(|x| x.re), model }
    }

    /// Returns the efficiency and the torque with their derivatives with respect to the inputs at a
    /// lubricant temperature \[K\], and the total power loss \[W\].
    fn slopes(
        &self,
        kelvin: Jet<M>,
        work: &mut ModelWorkspace,
    ) -> Result<(Performance<Jet<M>>, Jet<M>), SolveFailure> {
        let screw = self.screw();
        let ehl = EhlPoint::new(screw, &self.lubricant, kelvin)?;
        let (contacts, steady) = match &self.model {
            LubricatedModel::RacewayControl(case, friction) => {
                let (contacts, loaded, to_nut) = case.rolling_ball(&mut work.raceway)?;
                let rules = work.lubricated.rules.oil_and_dry(friction.accuracy());
                let (_, losses) = friction.losses(&ehl, &contacts, (&loaded, &to_nut), rules);
                let torque = screw.rolling_torques(contact_power_loss(&losses)).1;
                (contacts, LubricatedState { loaded, to_nut, losses, torque })
            }
            LubricatedModel::Traction(case) => {
                let values =
                    EhlPoint::new(&screw.values(), &self.lubricant.map(|x| x.re), kelvin.re)?;
                case.lubricated_slopes(&ehl, &values, work)?
            }
        };
        let outside = self.outside(&contacts, &steady);
        let (ideal, speed) = (screw.point.ideal_torque(), screw.point.drive.relative_speed());
        let torque = steady.torque + outside.of_balls() / speed;
        let efficiency = efficiency(contacts.direction.is_back(), ideal, torque);
        let transmitted = Performance { efficiency, screw_torque: Some(torque) };
        Ok((transmitted, (torque - ideal) * speed + outside.seal))
    }
}
