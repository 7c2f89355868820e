//! The thermal data of an axis: its surfaces, its screw, its surroundings and its heat sources.
//!
//! Theory: `docs/theory/19-warm-state.md`, equations (I14) and (I21).

use bsm_dyn::DrivenPart;

use super::band::interval;
use super::{
    BallLink, Guess, NODES, Network, NoSteadyState, ScrewBar, Sinks, StateInterval, Surfaces,
};

/// Sources of heat: torques \[N·m\], or powers as means over the cycle \[W\].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct HeatSources {
    /// Friction of the contacts with nut and screw.
    pub contacts: [f64; 2],
    /// Losses of the balls beyond these contacts: drag of the preload, returns, lubricant.
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
    /// * `weight`: share of the time of the phase times its absolute speed \[rad/s\].
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

    /// Returns all heat \[W\].
    pub fn total(&self) -> f64 {
        self.of_nut() + self.bearings + self.motor
    }
}

/// An axis through which heat flows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThermalAxis {
    /// Surfaces and contacts from which the conductances follow.
    pub surfaces: Surfaces,
    /// A guess that is off, and its factor; `None`: all quantities are as computed.
    pub off: Option<(Guess, f64)>,
    /// The screw.
    pub screw: ScrewBar,
    /// The surroundings.
    pub sinks: Sinks,
}

impl ThermalAxis {
    /// Returns the network.
    ///
    /// * `phases`: time and absolute relative speed of screw and nut \[rad/s\] of each, standstill included.
    pub fn network(&self, phases: &[(f64, f64)]) -> Network {
        let conductivity = self.screw.conductivity;
        let conductances = self.surfaces.conductances(conductivity, phases, self.off);
        Network { conductances, screw: self.screw, sinks: self.sinks }
    }

    /// Returns the heat of each node \[W\] (I14): with a driven nut the nut also takes the heat of seals and bearings. Where the
    /// balls are no node, nut and screw take half of contacts and drag each.
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

    /// Returns the steady rises of the nodes over the temperature of setting \[K\] at a heat that does not depend on them.
    ///
    /// * `phases`: see [`network`](Self::network). * `powers`: means over the cycle \[W\].
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

    /// Returns the band of numbers of the steady rises by what is guessed (I21).
    ///
    /// * `phases`, `powers`: see [`rises`](Self::rises). * `missing`: powers of sources that are not given, at usual values. *
    ///   `numbers`: of a network and its rises, always as many.
    ///
    /// # Errors
    ///
    /// As [`rises`](Self::rises).
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
