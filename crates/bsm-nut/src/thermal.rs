//! The warm steady state: what friction heats, what heat does to the preload, and where that ends.
//!
//! Theory: `docs/theory/19-warm-state.md`, equations (I5) to (I21).
//!
//! A [`ThermalAxis`] has a [`Network`] that carries heat between five nodes. A [`WarmNut`] makes it, with grooves as warm as the nodes;
//! [`WarmNut::steady`] finds where both agree, and [`WarmNut::fold`] the speed above which they never do.

mod axis;
mod band;
mod conductances;
mod coupling;
mod network;
mod states;

pub use axis::{HeatSources, ThermalAxis};
pub use band::StateInterval;
pub use conductances::{BallLink, Conductances, Coolant, Guess, Surfaces, coolant_conductance};
pub use coupling::{
    BETWEEN_LOADS, HeldFriction, NutAtTemperature, PhaseState, WarmNut, WarmPhase,
    drag_beyond_contacts,
};
pub use network::{AxialHold, Network, ScrewBar, Sinks};
pub use states::{Fold, NoSteadyState, OnBranch, Steady};

/// Nodes: nut, screw along the travel, balls, both ends of the screw.
pub const NODES: usize = 5;

/// Temperatures of the nodes \[°C\].
///
/// * `set`: temperature of setting \[K\]. * `rises`: over it.
pub fn celsius(set: f64, rises: &[f64; NODES]) -> [f64; NODES] {
    rises.map(|rise| set + rise - bsm_dyn::ZERO_CELSIUS)
}
