//! Warm steady state of a nut: frictional heat, its effect on the preload, and the fold.
//!
//! Theory: `docs/theory/19-warm-state.md`, equations (I5) to (I21).
//!
//! A [`ThermalAxis`] has a [`Network`] that conducts heat between five nodes. A [`WarmNut`]
//! generates heat, which depends on the node temperatures. [`WarmNut::steady`] calculates the
//! temperatures at which generated and conducted heat are equal. [`WarmNut::fold`] calculates the
//! speed above which no such temperatures exist.

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

/// Number of thermal nodes: nut, screw along the travel, balls, and both ends of the screw.
pub const NODES: usize = 5;

/// Returns the temperatures of the nodes \[°C\].
///
/// * `set`: assembly temperature \[K\].
/// * `rises`: temperature rises above the assembly temperature.
pub fn celsius(set: f64, rises: &[f64; NODES]) -> [f64; NODES] {
    rises.map(|rise| set + rise - bsm_dyn::lubrication::ZERO_CELSIUS)
}
