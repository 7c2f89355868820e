//! Thermal data of an axis: surfaces, screw, surroundings and heat sources.
//!
//! Theory: `docs/theory/19-warm-state.md`, equations (I14) and (I21).

use bsm_dyn::DrivenPart;

use super::band::interval;
use super::{
    BallLink, Estimate, NODES, Network, NoSteadyState, ScrewBar, StateInterval, Surfaces,
    Surroundings,
};

/// Heat sources of an axis, either as friction torques \[N·m\] or as powers averaged over the duty
/// cycle \[W\].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct HeatSources {
    /// Friction in the contacts between balls and nut, and between balls and screw.
    pub contacts: [f64; 2],
    /// Losses of the balls other than contact friction: drag due to preload, losses in the ball
    /// returns, and lubricant losses.
    pub balls: f64,
    /// Friction of the nut seals.
    pub seals: f64,
    /// Friction of all support bearings.
    pub bearings: f64,
    /// Heat that flows from the motor into the first end of the screw.
    pub motor: f64,
}

impl HeatSources {
    /// Adds the friction torques of a phase, multiplied by a weight that converts torques to
    /// average powers.
    ///
    /// * `weight`: time fraction of the phase multiplied by its absolute speed \[rad/s\].
    pub fn add(&mut self, torques: &Self, weight: f64) {
        let sum = |power: f64, torque: f64| power + weight * torque;
        *self = Self {
            contacts: [0, 1].map(|side| sum(self.contacts[side], torques.contacts[side])),
            balls: sum(self.balls, torques.balls),
            seals: sum(self.seals, torques.seals),
            bearings: sum(self.bearings, torques.bearings),
            motor: sum(self.motor, torques.motor),
        };
    }

    /// Returns the heat that contacts, drag and seals of the nut generate \[W\].
    pub fn of_nut(&self) -> f64 {
        self.contacts.iter().sum::<f64>() + self.balls + self.seals
    }

    /// Returns the heat that all sources together generate \[W\].
    pub fn total(&self) -> f64 {
        self.of_nut() + self.bearings + self.motor
    }
}

/// Thermal model of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThermalAxis {
    /// Surfaces and ball contacts, from which the conductances are calculated.
    pub surfaces: Surfaces,
    /// An estimated quantity and the factor by which it is multiplied; `None` if all estimates are
    /// unchanged.
    pub changed_estimate: Option<(Estimate, f64)>,
    /// Part of the screw between its bearings.
    pub screw: ScrewBar,
    /// Temperatures of the surroundings.
    pub surroundings: Surroundings,
}

impl ThermalAxis {
    /// Returns the thermal network. Its conductances are averages over the given phases.
    ///
    /// * `phases`: duration and absolute relative speed between screw and nut \[rad/s\] of every
    ///   phase, including standstill.
    pub fn network(&self, phases: &[(f64, f64)]) -> Network {
        let conductivity = self.screw.conductivity;
        let conductances = self.surfaces.conductances(conductivity, phases, self.changed_estimate);
        Network { conductances, screw: self.screw, surroundings: self.surroundings }
    }

    /// Returns the heat that is generated at each node \[W\] (I14). If the motor drives the nut,
    /// seals and bearings heat the nut. If the balls are not a separate node, the heat from
    /// contacts and drag is divided equally between nut and screw.
    ///
    /// * `powers`: heat sources, as powers averaged over the duty cycle \[W\].
    pub fn heats(&self, powers: &HeatSources) -> [f64; NODES] {
        let HeatSources { contacts: [at_nut, at_screw], balls, seals, bearings, motor } = *powers;
        let factor = Estimate::Heat.factor(self.changed_estimate);
        // P_n = Σ q P_A/2,  P_s = Σ q (P_B/2 + T_seal |W|),  P_b = Σ q ((P_A + P_B)/2 + T_x |W| + …)  (I14)
        let [mut nut, mut screw, at_balls] = match self.surfaces.link {
            BallLink::Contacts { .. } => {
                [0.5 * at_nut, 0.5 * at_screw, 0.5 * (at_nut + at_screw) + balls]
            }
            BallLink::Usual => {
                let half = 0.5 * (at_nut + at_screw + balls);
                [half, half, 0.0]
            }
        }
        .map(|heat| factor * heat);
        let mut ends = [motor, 0.0];
        match self.surfaces.driven {
            DrivenPart::Screw => {
                screw += seals;
                let held = self.screw.bearings.map(|held| f64::from(u8::from(held)));
                let all = (held[0] + held[1]).max(1.0);
                ends = [0, 1].map(|end| ends[end] + bearings * held[end] / all);
            }
            DrivenPart::Nut => nut += seals + bearings,
        }
        [nut, screw, at_balls, ends[0], ends[1]]
    }

    /// Returns the temperature rises of the nodes above the assembly temperature in the steady
    /// state \[K\]. The generated heat must not depend on the temperatures.
    ///
    /// * `phases`: duration and speed of every phase, as in [`network`](Self::network).
    /// * `powers`: heat sources, as powers averaged over the duty cycle \[W\].
    ///
    /// # Errors
    ///
    /// Returns [`NoSteadyState::NotFound`] if the equations of the network are singular.
    pub fn rises(
        &self,
        phases: &[(f64, f64)],
        powers: &HeatSources,
    ) -> Result<[f64; NODES], NoSteadyState> {
        self.network(phases).rises(&self.heats(powers))
    }

    /// Returns the uncertainty band of results that are calculated from steady-state temperature
    /// rises (I21). The band results from the uncertainty of estimated quantities.
    ///
    /// * `phases`, `powers`: duration and speed of every phase, and average powers of the heat
    ///   sources, as in [`rises`](Self::rises).
    /// * `missing`: typical powers of the heat sources that the case does not specify \[W\].
    /// * `numbers`: function that calculates the results from a network and its temperature rises.
    ///   It must always return the same number of results.
    ///
    /// # Errors
    ///
    /// Returns the same errors as [`rises`](Self::rises).
    pub fn band(
        &self,
        phases: &[(f64, f64)],
        (powers, missing): (&HeatSources, &HeatSources),
        numbers: impl Fn(&Network, &[f64; NODES]) -> Vec<f64>,
    ) -> Result<StateInterval, NoSteadyState> {
        let at = |axis: &Self, powers: &HeatSources| {
            let rises = axis.rises(phases, powers)?;
            Ok(numbers(&axis.network(phases), &rises))
        };
        let mut complete = *powers;
        complete.add(missing, 1.0);
        let estimates =
            Estimate::ALL.into_iter().filter(|estimate| !estimate.is_given(&self.surfaces));
        let with_estimate = |changed_estimate| {
            at(&Self { changed_estimate: Some(changed_estimate), ..*self }, powers)
        };
        Ok(interval(at(self, powers)?, estimates, with_estimate, || at(self, &complete)))
    }
}
