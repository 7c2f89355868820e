//! The thermal data of an axis: its surfaces, its screw, its surroundings and its heat sources.
//!
//! Theory: `docs/theory/19-warm-state.md`, equations (I14) and (I21).

use bsm_dyn::DrivenPart;

use super::band::interval;
use super::{
    BallLink, Guess, NODES, Network, NoSteadyState, ScrewBar, Sinks, StateInterval, Surfaces,
};

/// Heat sources, as torques \[N·m\] or as mean powers over the cycle \[W\].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct HeatSources {
    /// Friction of the contacts at nut and screw.
    pub contacts: [f64; 2],
    /// Losses of the balls outside these contacts: drag of the preload, returns, lubricant.
    pub balls: f64,
    /// Seals.
    pub seals: f64,
    /// All support bearings together.
    pub bearings: f64,
    /// The motor, which heats the first end of the screw.
    pub motor: f64,
}

impl HeatSources {
    /// Adds the torques of a phase.
    ///
    /// * `weight`: time share of the phase times its absolute speed \[rad/s\].
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

    /// Returns the heat of contacts, drag and seals \[W\].
    pub fn of_nut(&self) -> f64 {
        self.contacts.iter().sum::<f64>() + self.balls + self.seals
    }

    /// Returns the total heat \[W\].
    pub fn total(&self) -> f64 {
        self.of_nut() + self.bearings + self.motor
    }
}

/// The thermal model of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThermalAxis {
    /// Surfaces and contacts that determine the conductances.
    pub surfaces: Surfaces,
    /// An estimated quantity that is changed by a factor; `None` if all quantities have their
    /// calculated values.
    pub off: Option<(Guess, f64)>,
    /// The screw.
    pub screw: ScrewBar,
    /// The surroundings.
    pub sinks: Sinks,
}

impl ThermalAxis {
    /// Returns the network.
    ///
    /// * `phases`: time and absolute relative speed of screw and nut \[rad/s\] of each phase,
    ///   including standstill.
    pub fn network(&self, phases: &[(f64, f64)]) -> Network {
        let conductivity = self.screw.conductivity;
        let conductances = self.surfaces.conductances(conductivity, phases, self.off);
        Network { conductances, screw: self.screw, sinks: self.sinks }
    }

    /// Returns the heat of each node \[W\] (I14). If the nut is driven, seals and bearings also
    /// heat the nut. If the balls are not a node, nut and screw each take half of the heat of
    /// contacts and drag.
    ///
    /// * `powers`: means over the cycle \[W\].
    pub fn heats(&self, powers: &HeatSources) -> [f64; NODES] {
        let HeatSources { contacts: [at_nut, at_screw], balls, seals, bearings, motor } = *powers;
        let factor = Guess::Heat.factor(self.off);
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

    /// Returns the steady temperature rises of the nodes above the assembly temperature \[K\] for a
    /// heat that does not depend on them.
    ///
    /// * `phases`: see [`network`](Self::network).
    /// * `powers`: means over the cycle \[W\].
    ///
    /// # Errors
    ///
    /// [`NoSteadyState::NotFound`] if the network is singular.
    pub fn rises(
        &self,
        phases: &[(f64, f64)],
        powers: &HeatSources,
    ) -> Result<[f64; NODES], NoSteadyState> {
        self.network(phases).rises(&self.heats(powers))
    }

    /// Returns the uncertainty band of results that follow from the steady temperature rises, due
    /// to estimated quantities (I21).
    ///
    /// * `phases`, `powers`: see [`rises`](Self::rises).
    /// * `missing`: powers of sources that are not given, with usual values.
    /// * `numbers`: calculates the results from a network and its temperature rises; the count of
    ///   results is constant.
    ///
    /// # Errors
    ///
    /// The errors of [`rises`](Self::rises).
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
        let guesses = Guess::ALL.into_iter().filter(|guess| !guess.is_given(&self.surfaces));
        let guessed = |off| at(&Self { off: Some(off), ..*self }, powers);
        Ok(interval(at(self, powers)?, guesses, guessed, || at(self, &complete)))
    }
}
