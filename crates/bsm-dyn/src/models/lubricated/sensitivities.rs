//! Derivatives of efficiency and torque of a lubricated ball.
//!
//! Theory: `docs/theory/12-sensitivities.md`, and `docs/theory/17-lubricant.md`, equation (Y28).

use bsm_kin::{Jet, Scalar};

use super::solve::{Lubricated, LubricatedModel, lost};
use crate::contact::{Losses, Lubricant, Oil, Roughness, Temperature, efficiency};
use crate::models::ball::{EhlPoint, Performance, Steady, Unsolved};
use crate::models::raceway_control::RacewayControl;
use crate::models::workspace::ModelWorkspace;

/// Temperature step of a finite difference \[K\]: the losses bend over tens of kelvins.
const APART: f64 = 1e-3;

impl<D: Scalar> Lubricant<D> {
    /// The same without derivatives.
    fn values(&self) -> Lubricant {
        let Oil { base, viscosities, density, pressure_viscosity, limiting_shear } = &self.oil;
        let Roughness { ball, nut, screw } = &self.roughness;
        let losses = &self.losses;
        Lubricant {
            oil: Oil {
                base: *base,
                viscosities: [viscosities[0].re(), viscosities[1].re()],
                density: density.re(),
                pressure_viscosity: pressure_viscosity.as_ref().map(D::re),
                limiting_shear: limiting_shear.re(),
            },
            temperature: match &self.temperature {
                Temperature::Known(kelvin) => Temperature::Known(kelvin.re()),
                Temperature::Balance { heat_transfer, ambient } => Temperature::Balance {
                    heat_transfer: heat_transfer.re(),
                    ambient: ambient.re(),
                },
            },
            boundary_friction: self.boundary_friction.re(),
            roughness: Roughness { ball: ball.re(), nut: nut.re(), screw: screw.re() },
            film_factor: self.film_factor.re(),
            rolling_factor: self.rolling_factor.re(),
            hysteresis_loss: self.hysteresis_loss.re(),
            losses: Losses {
                seal_torque: losses.seal_torque.re(),
                ball_contact_force: losses.ball_contact_force.re(),
                ball_contact_friction: losses.ball_contact_friction.re(),
                return_circuits: losses.return_circuits.re(),
                return_loss: losses.return_loss.re(),
                drag_coefficient: losses.drag_coefficient.re(),
            },
        }
    }
}

impl<const M: usize> Lubricated<Jet<M>> {
    /// Efficiency and torque with their derivatives.
    pub(crate) fn sensitivities(
        &self,
        work: &mut ModelWorkspace,
    ) -> Result<Performance<Jet<M>>, Unsolved> {
        let (heat_transfer, ambient) = match self.lubricant.temperature {
            Temperature::Known(kelvin) => return Ok(self.slopes(kelvin, work)?.0),
            Temperature::Balance { heat_transfer, ambient } => (heat_transfer, ambient),
        };
        let solved = self.values().solve(work).answer?;
        let settled = solved.film.map_or(f64::NAN, |film| film.temperature);
        let mut excess = |kelvin: f64| {
            let (_, heat) = self.slopes(Jet::from(kelvin), work)?;
            // hA (T − T₀) − Σ P(T)                                        (Y28)
            Ok((-ambient + kelvin) * heat_transfer - heat)
        };
        let here = excess(settled)?;
        let slope = (excess(settled + APART)?.re - here.re) / APART;
        let kelvin = Jet { re: settled, eps: here.eps.map(|eps| -eps / slope) };
        Ok(self.slopes(kelvin, work)?.0)
    }

    /// The same without derivatives.
    fn values(&self) -> Lubricated {
        let model = match &self.model {
            LubricatedModel::RacewayControl(case, friction) => {
                let (screw, control) = (case.at.values(), case.control);
                LubricatedModel::RacewayControl(RacewayControl { at: screw, control }, *friction)
            }
            LubricatedModel::Traction(case) => LubricatedModel::Traction(case.values()),
        };
        Lubricated { lubricant: self.lubricant.values(), model }
    }

    /// Efficiency and torque at a temperature \[K\], and all that is lost \[W\].
    fn slopes(
        &self,
        kelvin: Jet<M>,
        work: &mut ModelWorkspace,
    ) -> Result<(Performance<Jet<M>>, Jet<M>), Unsolved> {
        let screw = self.screw();
        let ehl = EhlPoint::new(screw, &self.lubricant, kelvin)?;
        let (pair, steady) = match &self.model {
            LubricatedModel::RacewayControl(case, friction) => {
                let (pair, loaded, to_nut) = case.rolling_ball(&mut work.raceway)?;
                let rules = work.lubricated.both(friction.accuracy());
                let (_, losses) = friction.losses(&ehl, &pair, (&loaded, &to_nut), rules);
                let torque = screw.rolling_torques(lost(&losses)).1;
                (pair, Steady { loaded, to_nut, losses, torque })
            }
            LubricatedModel::Traction(case) => {
                let values = EhlPoint::new(&screw.values(), &self.lubricant.values(), kelvin.re)?;
                case.lubricated_slopes(&ehl, &values, work)?
            }
        };
        let outside = self.outside(&pair, &steady);
        let (ideal, speed) = (screw.point.ideal_torque(), screw.point.drive.relative_speed());
        let torque = steady.torque + outside.of_balls() / speed;
        let efficiency = efficiency(pair.direction.is_back(), ideal, torque);
        let transmitted = Performance { efficiency, screw_torque: Some(torque) };
        Ok((transmitted, (torque - ideal) * speed + outside.seal))
    }
}
