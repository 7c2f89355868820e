//! Uncertainty of the power loss in lubricated contacts.
//!
//! Theory: `docs/theory/17-lubricant.md`, section "Uncertainty".

use super::solve::{LubricatedBall, LubricatedModel, RacewayFriction};
use crate::contact::{Conformities, Oil, Roughness, Temperature};
use crate::models::ball::{Direction, Model, SlipRegime, SteadyState, weyl_point};
use crate::models::raceway_control::RacewayControl;
use crate::models::traction::Traction;
use crate::models::workspace::ModelWorkspace;

/// 90 % interval of the power loss, calculated from random draws of the uncertain inputs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LossInterval {
    /// Lower and upper limit of the power loss of the contacts, divided by the nominal power loss.
    pub loss: [f64; 2],
    /// Torque on the screw \[N·m\], for the lower and the upper limit of the power loss.
    pub screw_torque: [f64; 2],
    /// Efficiency, for the lower and the upper limit of the power loss.
    pub efficiency: [f64; 2],
    /// Model that was solved for each random draw.
    pub model: Model,
}

/// Number of random draws per operating point.
const DRAWS: u32 = 250;

/// Accuracy of the friction integrals in each draw. A higher accuracy would not improve the result,
/// because the limited number of [`DRAWS`] causes an error of about one percent in each quantile.
const ACCURACY: f64 = 1e-4;

/// Ranges of the twelve uncertain inputs of the lubricant model.
const UNCERTAIN: [(f64, f64); 12] = [
    // Factors for the boundary friction, for the rolling force, and for the film ratio λ in the
    // formula ξ = e^{−1.4λ} for the asperity load share.
    (0.75, 1.25),
    (0.5 / 0.85, 1.2 / 0.85),
    (0.8 / 1.4, 2.3 / 1.4),
    // Factors for the roughness, the oil supply and the limiting shear stress.
    (0.6, 1.4),
    (0.6, 1.0),
    (0.8, 1.2),
    // Factors for film thickness, pressure-viscosity coefficient, viscosity and hysteresis.
    (0.8, 1.2),
    (0.85, 1.15),
    (0.9, 1.1),
    (0.3, 3.4),
    // Offsets of the oil temperature [K] and of the conformity.
    (-5.0, 5.0),
    (-0.005, 0.005),
];

impl LubricatedBall {
    /// Returns the uncertainty interval at a solved operating point, or `None` if too few random
    /// draws have a solution.
    ///
    /// The draws are uniform over the ranges of the inputs, and the same draws are used for every
    /// point. If the ball rolls, the power losses of the draws are calculated with the
    /// raceway-control model and one friction coefficient per contact; otherwise, they are
    /// calculated with the traction model.
    pub fn loss_interval(
        &self,
        solved: &SteadyState,
        work: &mut ModelWorkspace,
    ) -> Option<LossInterval> {
        let film = solved.film?;
        let rolls = solved.skid.and_then(|skid| skid.regime()) == Some(SlipRegime::Rolling);
        let model = if rolls { Model::RacewayControl } else { Model::Traction };
        let loss = |number: Option<u32>, work: &mut ModelWorkspace| {
            let solution = self.sample(number, film.temperature, model).solve(work);
            let film = solution.steady_state()?.film?;
            Some(film.sliding_power + film.rolling_power)
        };
        let nominal = loss(None, work)?;
        let mut losses: Vec<_> = (1..=DRAWS).filter_map(|n| loss(Some(n), work)).collect();
        losses.sort_by(f64::total_cmp);
        let last = losses.len().checked_sub(1).filter(|last| 2 * last > DRAWS as usize)?;
        let [low, high] = [last / 20, last - last / 20].map(|i| losses[i] / nominal);
        let speed = self.screw().point.drive.relative_speed();
        let (torque, ideal) =
            (solved.transmission.screw_torque?, self.screw().point.ideal_torque());
        let contacts = (film.sliding_power + film.rolling_power) / speed;
        let direction = Direction::of(speed)?;
        let torques = [low, high].map(|ratio| torque + (ratio - 1.0) * contacts);
        Some(LossInterval {
            loss: [low, high],
            screw_torque: torques,
            model,
            efficiency: torques
                .map(|torque| crate::contact::efficiency(direction.is_back(), ideal, torque)),
        })
    }

    /// Returns the lubricated ball for the given model and oil temperature \[K\], with the
    /// uncertain inputs of draw `number`. If `number` is `None`, the inputs keep their nominal
    /// values.
    fn sample(&self, number: Option<u32>, kelvin: f64, model: Model) -> Self {
        let parts: Option<[f64; UNCERTAIN.len()]> = number.map(weyl_point);
        let draw = |i: usize| {
            let (low, high) = UNCERTAIN[i];
            parts.map(|parts| low + parts[i] * (high - low))
        };
        let factor = |i| draw(i).unwrap_or(1.0);
        let offset = |i| draw(i).unwrap_or(0.0);
        let mut screw = *self.screw();
        let least = |conformity: f64| (conformity + offset(11)).max(0.5 + 0.5 * (conformity - 0.5));
        screw.conformity =
            Conformities { nut: least(screw.conformity.nut), screw: least(screw.conformity.screw) };
        let mut lubricant = self.lubricant;
        let kelvin = kelvin + offset(10);
        lubricant.temperature = Temperature::Known(kelvin);
        lubricant.boundary_friction *= factor(0);
        let film = factor(6);
        lubricant.film_factor *= factor(4) * film;
        // The rolling force must not depend on the uncertainty factor of the film thickness.
        lubricant.rolling_factor *= factor(1) / film;
        // In the formula for the asperity load share, a larger exponent has the same effect as
        // smoother surfaces.
        let rough = factor(3) / factor(2);
        let Roughness { ball, nut, screw: raceway } = lubricant.roughness;
        lubricant.roughness =
            Roughness { ball: ball * rough, nut: nut * rough, screw: raceway * rough };
        lubricant.hysteresis_loss *= factor(9);
        let Oil { viscosities, limiting_shear, .. } = lubricant.oil;
        lubricant.oil.viscosities = viscosities.map(|viscosity| viscosity * factor(8));
        lubricant.oil.limiting_shear = limiting_shear * factor(5);
        let alpha = lubricant.oil.at(kelvin).pressure_viscosity;
        lubricant.oil.pressure_viscosity = Some(alpha * factor(7));
        let model = if model == Model::Traction {
            let (accuracy, creep) = (ACCURACY, Traction::<f64>::CREEP);
            LubricatedModel::Traction(Traction { screw, accuracy, creep })
        } else {
            let case = RacewayControl { screw, control: None };
            LubricatedModel::RacewayControl(case, RacewayFriction::PerContact)
        };
        Self { lubricant, model }
    }
}
