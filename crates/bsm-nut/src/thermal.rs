//! The warm steady state: the heat of friction, its effect on the preload, and the fold.
//!
//! Theory: `docs/theory/19-warm-state.md`, equations (I5) to (I21).
//!
//! A [`ThermalAxis`] has a [`Network`], which conducts heat between five nodes. A [`WarmNut`]
//! produces the heat, with grooves at the temperatures of the nodes. [`WarmNut::steady`] finds the
//! temperatures at which both agree, and [`WarmNut::fold`] finds the speed above which there are
//! none.

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

/// Number of nodes: nut, screw along the travel, balls, and both ends of the screw.
pub const NODES: usize = 5;

/// Returns the temperatures of the nodes \[°C\].
///
/// * `set`: assembly temperature \[K\].
/// * `rises`: temperature rises above the assembly temperature.
pub fn celsius(set: f64, rises: &[f64; NODES]) -> [f64; NODES] {
    rises.map(|rise| set + rise - bsm_dyn::lubrication::ZERO_CELSIUS)
}
